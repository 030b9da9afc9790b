//! Values of a result as tables and JSON have them, whatever their type.

use posewise::{EyeUnknown, Gaze, Loss, State, TrackResult};
use serde_json::Value as Json;

/// One value of a row of a table.
pub enum Cell {
    /// A number and its decimals.
    Number(f64, usize),
    /// A word.
    Word(&'static str),
}

impl Cell {
    /// As it stands in the table.
    pub fn text(&self) -> String {
        match *self {
            Cell::Number(value, decimals) => format!("{value:.decimals$}"),
            Cell::Word(word) => word.to_string(),
        }
    }
}

/// Shortest decimal form of an f32, so that 0.1 is not written as 0.10000000149011612.
pub fn number(value: f32) -> Json {
    value
        .to_string()
        .parse::<f64>()
        .map_or(Json::Null, Json::from)
}

/// A list of them.
pub fn numbers(values: &[f32]) -> Json {
    values.iter().copied().map(number).collect()
}

/// A field of a result; [`crate::fields`] has all.
pub struct Field {
    /// Its name in C.
    pub name: &'static str,
    /// Numbers or words of an array, else 1.
    pub count: usize,
    /// Its value.
    pub value: fn(&TrackResult) -> Value,
    /// Its column in the table, if the list of columns does not name it.
    pub column: Option<Column>,
}

/// The column of a field under its own name.
pub struct Column {
    /// Unit or range.
    pub unit: &'static str,
    /// Decimals.
    pub decimals: usize,
    /// What it is.
    pub meaning: &'static str,
}

/// What a field holds.
pub enum Value {
    /// A time or a count.
    Integer(i64),
    /// 0 or 1.
    Flag(bool),
    /// A number.
    Number(f32),
    /// Several numbers.
    Numbers(Vec<f32>),
    /// A word.
    Word(&'static str),
    /// Several words.
    Words(Vec<&'static str>),
}

impl Value {
    /// As JSON; flags are `true` or `false`.
    pub fn json(&self) -> Json {
        match self {
            Value::Integer(value) => (*value).into(),
            Value::Flag(value) => (*value).into(),
            Value::Number(value) => number(*value),
            Value::Numbers(values) => numbers(values),
            Value::Word(word) => (*word).into(),
            Value::Words(words) => words.clone().into(),
        }
    }

    /// The nth number or word, in a table.
    pub fn cell(&self, nth: usize, decimals: usize) -> Cell {
        let number = |value: f32| Cell::Number(f64::from(value), decimals);
        match self {
            Value::Integer(value) => Cell::Number(*value as f64, 0),
            Value::Flag(value) => Cell::Number(f64::from(u8::from(*value)), 0),
            Value::Number(value) => number(*value),
            Value::Numbers(values) => number(values.get(nth).copied().unwrap_or_default()),
            Value::Word(word) => Cell::Word(word),
            Value::Words(words) => Cell::Word(words.get(nth).copied().unwrap_or_default()),
        }
    }
}

/// The gaze of the left eye, the right eye and both.
pub fn gazes(result: &TrackResult) -> [Gaze; 3] {
    let [left, right] = result.eyes.each;
    [left.gaze, right.gaze, result.eyes.gaze]
}

impl From<i64> for Value {
    fn from(value: i64) -> Self {
        Value::Integer(value)
    }
}

impl From<bool> for Value {
    fn from(value: bool) -> Self {
        Value::Flag(value)
    }
}

impl From<f32> for Value {
    fn from(value: f32) -> Self {
        Value::Number(value)
    }
}

impl<const N: usize> From<[f32; N]> for Value {
    fn from(values: [f32; N]) -> Self {
        Value::Numbers(values.to_vec())
    }
}

impl From<State> for Value {
    fn from(value: State) -> Self {
        Value::Word(value.name())
    }
}

impl From<Loss> for Value {
    fn from(value: Loss) -> Self {
        Value::Word(value.name())
    }
}

impl<const N: usize> From<[Option<EyeUnknown>; N]> for Value {
    fn from(values: [Option<EyeUnknown>; N]) -> Self {
        Value::Words(values.map(EyeUnknown::name_of).to_vec())
    }
}
