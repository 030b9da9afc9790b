//! Stage `fits`: fits the 3D head to the labelled photographs that show whole heads, and drops
//! those it does not explain.

use super::stage::Stage;
use super::store::{Output, Store};
use crate::fit::{FitSettings, Fits, fit_photographs};
use crate::head::Head;
use crate::photographs::Set;
use anyhow::Result;
use std::path::Path;

/// The stage's file.
pub const FILE: &str = "fits.json";

/// Makes the fits of these sets.
pub fn make(store: &Store, data: &Path, sets: &[Set]) -> Result<Output> {
    let settings = FitSettings::default();
    let path = |name: &str| data.join(name);
    let mut stage = Stage::new("fits", 3).options(&settings)?;
    let names = sets.iter().flat_map(|set| [set.table, set.images]);
    for name in names.chain(["facekit.npz"]) {
        stage = stage.input(name, store.data(&path(name))?);
    }
    store.make(&stage, &[FILE], |folder| {
        let head = Head::load(&path("facekit.npz"))?;
        let fits = fit_photographs(&head, sets, data, &settings)?;
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
