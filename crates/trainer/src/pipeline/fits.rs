//! Stage `fits`: fits the 3D head to the labelled photographs that are no tight crops, and
//! drops those it does not explain.

use super::stage::Stage;
use super::store::{Output, Store};
use crate::fit::{FitSettings, Fits, fit_photographs};
use crate::head::Head;
use crate::photographs::{self, UNCROPPED};
use anyhow::Result;
use std::path::Path;

/// The stage's file.
pub const FILE: &str = "fits.json";

/// Makes the fits.
pub fn make(store: &Store, data: &Path) -> Result<Output> {
    let settings = FitSettings::default();
    let path = |name: &str| data.join(name);
    let mut stage = Stage::new("fits", 2).options(&settings)?;
    let sets = UNCROPPED.iter().flat_map(|set| [set.table, set.images]);
    for name in sets.chain(["facekit.npz"]) {
        stage = stage.input(name, store.data(&path(name))?);
    }
    store.make(&stage, &[FILE], |folder| {
        let head = Head::load(&path("facekit.npz"))?;
        let labels = photographs::labels(data, &UNCROPPED)?;
        let fits = fit_photographs(&head, labels, data, &settings)?;
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
