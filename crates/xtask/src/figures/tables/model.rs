//! The figures of one model, and which of them are read.

use std::cell::RefCell;
use std::collections::BTreeSet;

use anyhow::{Context, Result};
use serde_json::Value;

use super::super::value::Figure;

/// The figures of one model.
pub struct Model {
    /// The name of its file.
    pub name: String,
    figures: Value,
    /// Pointers of the figures that were read.
    read: RefCell<BTreeSet<String>>,
}

impl Model {
    /// The figures that `measure` wrote, or makes.
    pub fn new(name: &str, figures: Value) -> Self {
        Model {
            name: name.into(),
            figures,
            read: RefCell::default(),
        }
    }

    /// Whether there is anything at a JSON pointer.
    pub fn has(&self, pointer: &str) -> bool {
        self.figures.pointer(pointer).is_some()
    }

    /// The figure at a JSON pointer, which must be there; `null` is nothing.
    pub fn at(&self, pointer: &str) -> Result<Figure> {
        Ok(Figure::of(self.read(pointer)?))
    }

    /// Two counts of the object at a JSON pointer, as `3 of 5`.
    pub fn of(&self, pointer: &str, [part, all]: [&str; 2]) -> Result<String> {
        let at = |key: &str| self.at(&format!("{pointer}/{key}"));
        Ok(format!("{} of {}", at(part)?.count(), at(all)?.count()))
    }

    /// The word at a JSON pointer.
    pub fn word(&self, pointer: &str) -> Result<String> {
        let word = self.read(pointer)?.as_str();
        Ok(word
            .with_context(|| format!("model {}: no word {pointer}", self.name))?
            .into())
    }

    /// The names in the object at a JSON pointer.
    pub fn keys(&self, pointer: &str) -> Result<Vec<String>> {
        let object = self.figures.pointer(pointer).and_then(Value::as_object);
        let object = object.with_context(|| format!("model {}: no {pointer}", self.name))?;
        Ok(object.keys().cloned().collect())
    }

    /// The pointers of what is in the list at a JSON pointer.
    pub fn list(&self, pointer: &str) -> Result<Vec<String>> {
        let list = self.figures.pointer(pointer).and_then(Value::as_array);
        let list = list.with_context(|| format!("model {}: no list {pointer}", self.name))?;
        Ok((0..list.len())
            .map(|at| format!("{pointer}/{at}"))
            .collect())
    }

    /// The figures that were read, without all others.
    pub fn shown(&self) -> Value {
        pruned(&self.figures, "", &self.read.borrow()).unwrap_or_default()
    }

    fn read(&self, pointer: &str) -> Result<&Value> {
        let value = self.figures.pointer(pointer);
        let value = value.with_context(|| format!("model {}: no figure {pointer}", self.name))?;
        self.read.borrow_mut().insert(pointer.into());
        Ok(value)
    }
}

/// What is at these pointers and in the objects and lists on the way to them.
fn pruned(value: &Value, pointer: &str, read: &BTreeSet<String>) -> Option<Value> {
    match value {
        Value::Object(map) => {
            let entry = |(key, value): (&String, &Value)| {
                Some((
                    key.clone(),
                    pruned(value, &format!("{pointer}/{key}"), read)?,
                ))
            };
            let kept: serde_json::Map<_, _> = map.iter().filter_map(entry).collect();
            (!kept.is_empty()).then(|| kept.into())
        }
        Value::Array(list) => {
            let item = |(at, value)| pruned(value, &format!("{pointer}/{at}"), read);
            let kept: Vec<Value> = list.iter().enumerate().filter_map(item).collect();
            (!kept.is_empty()).then(|| kept.into())
        }
        plain => read.contains(pointer).then(|| plain.clone()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn only_what_is_read_is_kept() {
        let model = Model::new(
            "default",
            json!({"a": {"x": 1.5, "y": 2}, "b": [{"n": "w", "m": 3}, {"n": null}], "c": {}}),
        );
        assert_eq!(model.at("/a/x").unwrap().fixed(1), "1.5");
        assert_eq!(model.word("/b/0/n").unwrap(), "w");
        assert_eq!(model.at("/b/1/n").unwrap().fixed(1), "–");
        assert!(model.at("/a/z").is_err() && model.word("/a/y").is_err() && model.has("/c"));
        assert_eq!(model.list("/b").unwrap(), ["/b/0", "/b/1"]);
        let shown = json!({"a": {"x": 1.5, "y": 2}, "b": [{"n": "w"}, {"n": null}]});
        assert_eq!(model.shown(), shown);
    }
}
