//! Stage `fits`: fits the 3D head to every labelled photograph and drops those it does not explain.

use super::stage::Stage;
use super::store::{Output, Store};
use crate::fit::{FitSettings, Fits, fit_photographs};
use crate::head::Head;
use anyhow::Result;
use std::path::Path;

/// The stage's file.
pub const FILE: &str = "fits.json";

/// Makes the fits.
pub fn make(store: &Store, data: &Path) -> Result<Output> {
    let settings = FitSettings::default();
    let path = |name: &str| data.join(name);
    let mut stage = Stage::new("fits", 1).options(&settings)?;
    for name in ["facekit.npz", "faces68/train.csv", "faces68/train"] {
        stage = stage.input(name, store.data(&path(name))?);
    }
    store.make(&stage, &[FILE], |folder| {
        let head = Head::load(&path("facekit.npz"))?;
        let (csv, images) = (path("faces68/train.csv"), path("faces68/train"));
        let fits = fit_photographs(&head, &csv, &images, &settings)?;
        println!(
            "3D head fitted to {} photographs, {} dropped",
            fits.fits.len(),
            fits.dropped.len()
        );
        Ok(std::fs::write(
            folder.join(FILE),
            serde_json::to_vec(&fits)?,
        )?)
    })
}

/// Reads them.
pub fn read(output: &Output) -> Result<Fits> {
    Ok(serde_json::from_slice(&output.read(FILE)?)?)
}
