//! The folders for Android and iOS, packed.

use super::{Outcome, Packer, VERSION, exists};
use crate::mobile::{self, ABIS, PLATFORMS};
use crate::zip::zip;
use anyhow::{Context, Result};
use std::path::Path;

impl Packer {
    /// An AAR.
    pub fn android(&self) -> Result<Outcome> {
        if !exists("javac") {
            return Ok(Outcome::Skipped("no javac".into()));
        }
        let missing = mobile::missing(ABIS.iter().map(|abi| abi.1), &self.target_dir);
        if !missing.is_empty() {
            return Ok(Outcome::Skipped(format!("no Rust for {missing:?}")));
        }
        let folder = mobile::android(&self.target_dir)?;
        self.zipped(&folder, &format!("posewise-android-{VERSION}.aar"))
    }

    /// An XCFramework, packed with its own folder as Swift packages want it.
    pub fn ios(&self) -> Result<Outcome> {
        let missing = mobile::missing(PLATFORMS.iter().map(|each| each.1), &self.target_dir);
        if !missing.is_empty() {
            return Ok(Outcome::Skipped(format!("no Rust for {missing:?}")));
        }
        let framework = mobile::ios(&self.target_dir)?;
        let above = framework.parent().context("no folder")?;
        self.zipped(above, &format!("posewise-{VERSION}.xcframework.zip"))
    }

    fn zipped(&self, folder: &Path, name: &str) -> Result<Outcome> {
        let archive = self.folder.join(name);
        zip(folder, &archive)?;
        Ok(Outcome::Made(vec![archive]))
    }
}
