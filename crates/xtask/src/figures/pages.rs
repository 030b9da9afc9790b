//! `cargo xtask accuracy`: the pages that show the figures.

use std::path::PathBuf;

use anyhow::{Context, Result};
use serde_json::Value;

use super::tables::{self, Model};
use super::{MODELS, figures_of};
use crate::root;

/// Around the table of figures in `README.md`.
const BEGIN: &str = "<!-- figures: written by `cargo xtask accuracy` -->\n";
const END: &str = "<!-- end of figures -->";

/// Writes both pages.
pub fn write() -> Result<()> {
    for (path, text) in pages()? {
        std::fs::write(&path, text).with_context(|| path.display().to_string())?;
    }
    Ok(())
}

/// The pages as the committed figures make them.
fn pages() -> Result<Vec<(PathBuf, String)>> {
    let models = MODELS
        .iter()
        .map(|name| read(name))
        .collect::<Result<Vec<_>>>()?;
    let readme = root().join("README.md");
    let text = std::fs::read_to_string(&readme)?;
    let text = between_marks(&text, &tables::readme(&models)?)?;
    let accuracy = root().join("docs/accuracy.md");
    Ok(vec![(readme, text), (accuracy, tables::accuracy(&models)?)])
}

fn read(name: &str) -> Result<Model> {
    let path = figures_of(name);
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let figures = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
    Ok(Model::new(name, figures))
}

/// Those of a model's figures that the pages show.
pub fn shown(name: &str, figures: Value) -> Result<Value> {
    let models = [Model::new(name, figures)];
    tables::readme(&models)?;
    tables::accuracy(&models)?;
    Ok(models[0].shown())
}

/// The text with this table between its marks.
fn between_marks(text: &str, table: &str) -> Result<String> {
    let (before, rest) = text
        .split_once(BEGIN)
        .context("README.md: no begin of figures")?;
    let (_, after) = rest
        .split_once(END)
        .context("README.md: no end of figures")?;
    Ok(format!("{before}{BEGIN}\n{table}\n{END}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::value::{checksum, lines};

    #[test]
    fn committed_pages_show_the_committed_figures() {
        for (path, text) in pages().unwrap() {
            let committed = std::fs::read_to_string(&path).unwrap();
            let same = committed == text;
            assert!(same, "{}: run `cargo xtask accuracy`", path.display());
            for (number, line) in text.lines().enumerate() {
                let columns = line.chars().count();
                assert!(
                    columns <= 100,
                    "{}:{}: {columns} columns",
                    path.display(),
                    number + 1
                );
            }
        }
    }

    /// What nothing shows, and every other form, is left out of the repository.
    #[test]
    fn committed_figures_are_those_that_the_pages_show() {
        for name in MODELS {
            let path = figures_of(name);
            let text = std::fs::read_to_string(&path).unwrap();
            let figures = shown(name, serde_json::from_str(&text).unwrap()).unwrap();
            let same = text == lines(&figures);
            assert!(same, "{}: run `cargo xtask measure`", path.display());
        }
    }

    #[test]
    fn figures_are_of_the_committed_models() {
        for name in MODELS {
            let model = std::fs::read(root().join(format!("models/{name}.posewise"))).unwrap();
            let measured = read(name).unwrap().word("/model/crc32").unwrap();
            let is = checksum(&model).unwrap();
            assert!(
                measured == is,
                "models/{name}.posewise changed: run `cargo xtask measure`"
            );
        }
    }
}
