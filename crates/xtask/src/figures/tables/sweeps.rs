//! Tables of the clips of `posewise-lab sweeps`.

use anyhow::{Context, Result};

use super::table::{Model, Render, Row, by_model, fill, table};

/// The section of these clips; nothing unless all models were measured on them.
pub fn sweeps(models: &[Model]) -> Result<String> {
    if !models.iter().all(|m| m.has("/sweeps")) {
        return Ok(String::new());
    }
    let tables: [(&str, Render); 2] = [("heads", heads), ("covers", covers)];
    fill(include_str!("../sweeps.md"), &tables, models)
}

fn heads(models: &[Model]) -> Result<String> {
    let mut items = vec![
        (
            "heads to 60°".to_string(),
            "heads/yaw_steps/0-60".to_string(),
        ),
        ("heads from 60°".into(), "heads/yaw_steps/60-95".into()),
        ("Candide-3 to 60°".into(), "candide/yaw_steps/0-60".into()),
        (
            "Candide-3 from 60°".into(),
            "candide/yaw_steps/60-95".into(),
        ),
    ];
    for from in (0..100).step_by(10) {
        let step = format!("heads/yaw_steps/{from}-{}", from + 10);
        items.push((format!("heads, {from}° to {}°", from + 10), step));
    }
    let items: Vec<(&str, &str)> = items.iter().map(|(a, b)| (&**a, &**b)).collect();
    let rows = by_model(models, &items, |model, pointer| {
        let at = |key: &str| model.at(&format!("/sweeps/{pointer}/{key}"));
        Ok(vec![
            at("counted")?.count(),
            at("p_s")?.percent(1),
            at("e_yaw_deg")?.fixed(1),
            at("shrinkage_deg")?.fixed(1),
            at("e_pitch_deg")?.fixed(1),
            at("e_roll_deg")?.fixed(1),
            at("off")?.percent(1),
        ])
    })?;
    let columns = "\\|yaw\\|,model,frames,tracked %,yaw °,short °,pitch °,roll °,above 20° %";
    Ok(table(&columns.split(',').collect::<Vec<_>>(), &rows))
}

fn covers(models: &[Model]) -> Result<String> {
    let first = models.first().context("no models")?;
    let kinds = first.keys("/sweeps")?;
    let open = ["heads", "yaw", "pitch", "candide", "covered"];
    let mut items: Vec<(&str, &str)> = vec![("all covers", "covered")];
    let covers = kinds.iter().filter(|kind| !open.contains(&kind.as_str()));
    items.extend(covers.map(|kind| (kind.as_str(), kind.as_str())));
    let rows = by_model(models, &items, |model, kind| -> Result<Row> {
        let at = |key: &str| model.at(&format!("/sweeps/{kind}/occluded/{key}"));
        Ok(vec![
            at("counted")?.count(),
            at("p_s")?.percent(1),
            at("e_m_deg")?.fixed(1),
            at("covered_auc")?.fixed(3),
        ])
    })?;
    let header = [
        "cover",
        "model",
        "frames",
        "tracked %",
        "mean angle error °",
        "ROC",
    ];
    Ok(table(&header, &rows))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn sweeps_are_shown_once_they_are_measured() {
        let numbers = json!({"counted": 120, "p_s": 0.9, "e_yaw_deg": 4.0, "shrinkage_deg": 2.04,
            "e_pitch_deg": 3.0, "e_roll_deg": 1.0, "off": 0.01, "e_m_deg": 2.6,
            "covered_auc": 0.95});
        let names = (0..10).map(|k| format!("{}-{}", 10 * k, 10 * k + 10));
        let names = names.chain(["0-60".into(), "60-95".into()]);
        let steps: serde_json::Map<_, _> = names.map(|n| (n, numbers.clone())).collect();
        let of = json!({"yaw_steps": steps, "occluded": numbers});
        let measured = json!({"sweeps": {"heads": of, "candide": of, "covered": of, "scarf": of}});
        let model = |figures| Model::new("default", figures);
        assert_eq!(sweeps(&[model(json!({}))]).unwrap(), "");
        let text = sweeps(&[model(measured)]).unwrap();
        assert!(text.contains("| heads, 90° to 100° | default | 120 | 90.0 | 4.0 | 2.0 |"));
        assert!(
            text.contains("| scarf | default | 120 | 90.0 | 2.6 | 0.950 |"),
            "{text}"
        );
    }
}
