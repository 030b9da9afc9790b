//! Whose results are compared: trackers that run here, and tables of other programs.

use super::settings::Method;
use anyhow::{Context, Result, ensure};
use std::path::PathBuf;
use std::str::FromStr;

/// A row of the table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum System {
    /// Runs here.
    Method(Method),
    /// Ran elsewhere.
    Tables(Tables),
}

/// `NAME=FOLDER`: a folder with a table per clip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tables {
    /// Name of the row.
    pub name: String,
    /// `FOLDER/CLIP.csv` has columns of `posewise track --csv`.
    pub folder: PathBuf,
}

impl FromStr for Tables {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Tables> {
        let (name, folder) = text
            .split_once('=')
            .context("not of the form NAME=FOLDER")?;
        let is_plain = !name.is_empty() && !name.contains(['/', '|', '\n']);
        ensure!(is_plain, "{name:?} is no name");
        ensure!(!folder.is_empty(), "no folder");
        Ok(Tables {
            name: name.into(),
            folder: folder.into(),
        })
    }
}

impl System {
    /// As in the table.
    pub fn name(&self) -> &str {
        match self {
            System::Method(method) => method.name(),
            System::Tables(tables) => &tables.name,
        }
    }
}
