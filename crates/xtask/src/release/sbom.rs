//! Bills of materials in CycloneDX: what the library and the command are made of, by
//! cargo-cyclonedx, and from them what is in the wheel and in the JavaScript package. Models are
//! named with what the terms of their training data allow.

use super::{Outcome, Packer, VERSION, exists, sha256};
use crate::{notices, output_of, root};
use anyhow::{Context, Result};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// What cargo-cyclonedx writes beside each Cargo.toml of the workspace, without its ending.
const FILE: &str = "posewise-sbom";

/// Cargo names a crate of the workspace by the path of its folder, which differs between machines.
const ANY_ROOT: &str = "path+file:///posewise";

/// A package that holds the library: ending of the file's name, type and name in a package URL,
/// and what it needs beside the library.
const HOLDERS: [(&str, &str, &[&str]); 2] = [("wheel", "pypi", &["numpy"]), ("npm", "npm", &[])];

/// The model that is built into library and command.
const BUILT_IN: &str = "posewise";
/// How what a data sheet says of terms begins.
const TERMS: [&str; 2] = [
    "The terms of all of these",
    "Research terms on some of these",
];
/// The models that wheel and JavaScript package hold.
const MODELS: [&str; 2] = [BUILT_IN, "research"];

impl Packer {
    /// One file for the library, one for the command, one for each package that holds the library.
    pub fn sbom(&self) -> Result<Outcome> {
        if !exists("cargo-cyclonedx") {
            let why = "no cargo-cyclonedx (cargo install cargo-cyclonedx)";
            return Ok(Outcome::Skipped(why.into()));
        }
        let mut tool = self.program("cargo-cyclonedx");
        tool.args([
            "cyclonedx",
            "--quiet",
            "--format",
            "json",
            "--no-build-deps",
        ]);
        tool.args(["--spec-version", "1.5", "--override-filename", FILE]);
        let written = output_of(tool.current_dir(root()));
        let boms = take_boms()?;
        written?;
        let bom = |folder: PathBuf, linked: BTreeSet<String>| {
            let found = boms.iter().find(|(of, _)| *of == folder);
            let (_, bom) = found.with_context(|| format!("no bill of {folder:?}"))?;
            anyhow::Ok(pruned(bom.clone(), &linked))
        };
        let library = bom(root(), notices::linked("posewise", "ffi")?)?;
        let command = notices::linked("posewise-cli", "default")?;
        let command = bom(root().join("crates/cli"), command)?;
        let mut files = vec![
            (
                "posewise".into(),
                with_models(library.clone(), &[BUILT_IN])?,
            ),
            ("posewise-cli".into(), with_models(command, &[BUILT_IN])?),
        ];
        for (ending, kind, needs) in HOLDERS {
            let bom = with_models(holder(&library, kind, needs), &MODELS)?;
            files.push((format!("posewise-{ending}"), bom));
        }
        let write = |(name, bom): (String, Value)| {
            let path = self.folder.join(format!("{name}-{VERSION}.cdx.json"));
            std::fs::write(&path, serde_json::to_string_pretty(&bom)? + "\n")?;
            Ok(path)
        };
        Ok(Outcome::Made(
            files.into_iter().map(write).collect::<Result<_>>()?,
        ))
    }
}

/// Reads and removes what the tool wrote: the folder of each crate, and its bill.
fn take_boms() -> Result<Vec<(PathBuf, Value)>> {
    let mut folders = vec![root()];
    for entry in std::fs::read_dir(root().join("crates"))? {
        folders.push(entry?.path());
    }
    let own_root = format!("path+file://{}", root().display());
    let mut boms = Vec::new();
    for folder in folders {
        let path = folder.join(FILE).with_extension("json");
        if let Ok(text) = std::fs::read_to_string(&path) {
            std::fs::remove_file(&path)?;
            boms.push((
                folder,
                serde_json::from_str(&text.replace(&own_root, ANY_ROOT))?,
            ));
        }
    }
    Ok(boms)
}

/// A bill without what the tool lists because another crate of the workspace asks for it, and
/// without what runs only while the compiler does. The given crates, by name and version, stay.
fn pruned(mut bom: Value, linked: &BTreeSet<String>) -> Value {
    let text = |value: &Value, key: &str| value[key].as_str().unwrap_or_default().to_owned();
    let is_linked = |component: &Value| {
        let name = text(component, "name");
        let full = format!("{name} {}", text(component, "version"));
        name.starts_with("posewise") || linked.contains(&full)
    };
    let mut refs = BTreeSet::from([text(&bom["metadata"]["component"], "bom-ref")]);
    if let Some(components) = bom["components"].as_array_mut() {
        components.retain(is_linked);
        refs.extend(
            components
                .iter()
                .map(|component| text(component, "bom-ref")),
        );
    }
    let is_kept = |name: &Value| name.as_str().is_some_and(|name| refs.contains(name));
    for dependency in bom["dependencies"].as_array_mut().into_iter().flatten() {
        let names = dependency.get_mut("dependsOn");
        if let Some(names) = names.and_then(Value::as_array_mut) {
            names.retain(is_kept);
        }
    }
    if let Some(dependencies) = bom["dependencies"].as_array_mut() {
        dependencies.retain(|dependency| is_kept(&dependency["ref"]));
    }
    bom
}

/// The bill of a package of another language that holds the library.
fn holder(library: &Value, kind: &str, needs: &[&str]) -> Value {
    let own = format!("pkg:{kind}/posewise@{VERSION}");
    let mut bom = library.clone();
    let inside = library["metadata"]["component"].clone();
    let mut depends_on = vec![inside["bom-ref"].clone()];
    bom["metadata"]["component"] = json!({
        "type": "library", "bom-ref": own, "name": "posewise", "version": VERSION, "purl": own,
        "licenses": inside["licenses"],
    });
    let mut components = vec![inside];
    for name in needs {
        let needed = format!("pkg:{kind}/{name}");
        depends_on.push(json!(needed));
        components.push(json!({
            "type": "library", "bom-ref": needed, "name": name, "purl": needed, "scope": "required",
        }));
    }
    append(&mut bom["components"], components);
    let dependency = json!({ "ref": own, "dependsOn": depends_on });
    append(&mut bom["dependencies"], vec![dependency]);
    bom
}

/// A bill with these models of the repository, of which its component is made too.
fn with_models(mut bom: Value, names: &[&str]) -> Result<Value> {
    let of = bom["metadata"]["component"]["bom-ref"].clone();
    for name in names {
        let path = root().join("models").join(name);
        let bytes = std::fs::read(path.with_extension("posewise"))?;
        let sheet = std::fs::read_to_string(path.with_extension("md"))?;
        let mut paragraphs = sheet.split("\n\n");
        let terms = paragraphs.find(|text| TERMS.iter().any(|begin| text.starts_with(begin)));
        let terms = terms.with_context(|| format!("{name}.md says nothing of terms"))?;
        let own = format!("model:{name}");
        append(
            &mut bom["components"],
            vec![json!({
                "type": "machine-learning-model", "bom-ref": own,
                "name": format!("{name}.posewise"), "version": VERSION, "description": terms,
                "hashes": [{ "alg": "SHA-256", "content": sha256(&bytes) }],
            })],
        );
        for dependency in bom["dependencies"].as_array_mut().into_iter().flatten() {
            if dependency["ref"] == of {
                append(&mut dependency["dependsOn"], vec![json!(own)]);
            }
        }
    }
    Ok(bom)
}

fn append(list: &mut Value, more: Vec<Value>) {
    if let Some(list) = list.as_array_mut() {
        list.extend(more);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_are_named_with_their_terms() {
        let bom = json!({
            "metadata": { "component": { "bom-ref": "own" } },
            "components": [],
            "dependencies": [{ "ref": "own", "dependsOn": [] }, { "ref": "else", "dependsOn": [] }],
        });
        let bom = with_models(bom, &MODELS).unwrap();
        let names = ["posewise.posewise", "research.posewise"];
        for (component, name) in bom["components"].as_array().unwrap().iter().zip(names) {
            assert_eq!(component["name"], name);
            let terms = component["description"].as_str().unwrap();
            assert_eq!(terms.contains("any use"), name == names[0], "{terms}");
        }
        let depends_on = json!(["model:posewise", "model:research"]);
        assert_eq!(bom["dependencies"][0]["dependsOn"], depends_on);
        assert_eq!(bom["dependencies"][1]["dependsOn"], json!([]));
    }
}
