//! One stage of the pipeline as data, and the manifest of what it made.
//!
//! A stage's key is the hash of its name, version, options and the content hashes of its inputs.
//! The rules that follow from this:
//!
//! * Another data set, another output of an earlier stage or another value of an option: the stage
//!   and those that use what it makes run again, no others.
//! * Code that makes something else of the same inputs: raise the stage's `version`.
//! * Options count by the names and values that serde writes. A field that is renamed keeps its
//!   name there by `#[serde(rename = "old")]`; a field that is added is left out while it has the
//!   value that the stage had without it (`#[serde(skip_serializing_if = …)]`). Neither trains
//!   anything again.

use super::hash::Hash;
use anyhow::Result;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// A stage that can be made.
#[derive(Clone, Debug)]
pub struct Stage {
    name: &'static str,
    version: u32,
    inputs: BTreeMap<String, Hash>,
    options: Value,
}

impl Stage {
    /// A stage without inputs and options.
    pub fn new(name: &'static str, version: u32) -> Stage {
        Stage {
            name,
            version,
            inputs: BTreeMap::new(),
            options: Value::Null,
        }
    }

    /// Adds an input: a data set or an output of an earlier stage.
    pub fn input(mut self, name: &str, hash: Hash) -> Stage {
        self.inputs.insert(name.to_string(), hash);
        self
    }

    /// Sets the options.
    pub fn options(self, options: &impl Serialize) -> Result<Stage> {
        Ok(Stage {
            options: serde_json::to_value(options)?,
            ..self
        })
    }

    /// Its name, which is also that of its file in this folder.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// What its output depends on, as one hash.
    pub fn key(&self) -> Hash {
        Hash::of_json(&json!({
            "stage": self.name,
            "version": self.version,
            "inputs": self.inputs,
            "options": self.options,
        }))
    }

    /// Folder of its output.
    pub fn folder(&self) -> String {
        format!("{}-{}", self.name, self.key().short())
    }

    /// The manifest of these output files.
    pub fn manifest(&self, outputs: BTreeMap<String, Hash>) -> Manifest {
        Manifest {
            stage: self.name.to_string(),
            version: self.version,
            inputs: self.inputs.clone(),
            options: self.options.clone(),
            key: self.key(),
            outputs,
        }
    }
}

/// Says of what and how an output was made; written last, so that its presence means completion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Name of the stage.
    pub stage: String,
    /// Version of its code.
    pub version: u32,
    /// Content hashes of the inputs by name.
    pub inputs: BTreeMap<String, Hash>,
    /// Options as serde writes them.
    pub options: Value,
    /// Hash of all of the above.
    pub key: Hash,
    /// Content hashes of the files made, by file name.
    pub outputs: BTreeMap<String, Hash>,
}
