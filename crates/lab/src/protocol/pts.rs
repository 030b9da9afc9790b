//! `.pts` files: `version: 1`, `n_points: N`, then one `x y` a line between braces.

use super::text::Text;
use anyhow::{Result, ensure};

/// The points, as the file has them.
pub fn parse(text: &Text) -> Result<Vec<[f64; 2]>> {
    let mut lines = text.lines();
    let mut stated = None;
    loop {
        let Some((number, line)) = lines.next() else {
            return Err(text.cut_off("no {"));
        };
        if line == "{" {
            break;
        }
        let Some((key, value)) = line.split_once(':') else {
            return Err(text.error(number, "neither `name: value` nor {"));
        };
        if key.trim() == "n_points" {
            let count: Option<usize> = value.trim().parse().ok();
            let wrong = || text.error(number, "n_points is not a count");
            stated = Some(count.ok_or_else(wrong)?);
        }
    }
    let mut points = Vec::new();
    loop {
        let Some((number, line)) = lines.next() else {
            return Err(text.cut_off("no }"));
        };
        if line == "}" {
            let count = points.len();
            let differs = || text.error(number, format_args!("{count} points, not n_points"));
            ensure!(stated.is_none_or(|s| s == count), differs());
            return Ok(points);
        }
        points.push(text.numbers(number, line)?);
    }
}

/// The 68 points.
pub fn parse68(text: &Text) -> Result<[[f64; 2]; 68]> {
    let points = parse(text)?;
    let count = points.len();
    let wrong = |_| text.cut_off(format_args!("{count} points in place of 68"));
    points.try_into().map_err(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_and_errors() {
        let read = |s: &str| parse(&Text::parse("f.pts", s.as_bytes().to_vec()).unwrap());
        let good = "version: 1\nn_points: 2\n{\n1 2\n3.5 4\n}\n";
        assert_eq!(read(good).unwrap(), [[1.0, 2.0], [3.5, 4.0]]);
        let fails = |s: &str, message: &str| {
            assert_eq!(read(s).unwrap_err().to_string(), message);
        };
        fails("version: 1\n", "f.pts, line 1: no {");
        fails(
            "n_points: x\n{\n}",
            "f.pts, line 1: n_points is not a count",
        );
        fails("{\n1 2\n", "f.pts, line 2: no }");
        fails("{\n1 2 3\n}", "f.pts, line 2: 3 numbers in place of 2");
        fails(
            "n_points: 3\n{\n1 2\n}",
            "f.pts, line 4: 1 points, not n_points",
        );
    }
}
