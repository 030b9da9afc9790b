//! Values of a result as tables and JSON have them, whatever their type.

use posewise::eyes::{EyeUnknown, Gaze};
use posewise::{Loss, State, TrackResult};
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

/// A number of a row.
pub fn num(value: f32, decimals: usize) -> Cell {
    Cell::Number(f64::from(value), decimals)
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

/// A share that may be unknown: −1 then, and 0 as everything else while there is no face.
pub fn share(result: &TrackResult, share: Option<f32>) -> f32 {
    share.unwrap_or(match result.state {
        State::Searching => 0.0,
        State::Tracking | State::Coasting => -1.0,
    })
}

/// A gaze, or why it is unknown.
pub type MaybeGaze = Result<Gaze, EyeUnknown>;

/// The gaze of the left eye, the right eye and both.
pub fn gazes(result: &TrackResult) -> [MaybeGaze; 3] {
    let [left, right] = result.eyes.each;
    [left.gaze, right.gaze, result.eyes.gaze]
}

/// Direction of a gaze in the camera frame; zeros where it is unknown.
pub fn camera(gaze: MaybeGaze) -> [f32; 3] {
    gaze.map_or([0.0; 3], |gaze| gaze.camera)
}

/// Direction of a gaze in the head frame; zeros where it is unknown.
pub fn head(gaze: MaybeGaze) -> [f32; 3] {
    gaze.map_or([0.0; 3], |gaze| gaze.head)
}

/// Standard deviation of a gaze \[deg\]; 0 where it is unknown.
pub fn sigma_deg(gaze: MaybeGaze) -> f32 {
    gaze.map_or(0.0, |gaze| gaze.sigma_deg)
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

impl From<Option<Loss>> for Value {
    fn from(value: Option<Loss>) -> Self {
        Value::Word(Loss::name_of(value))
    }
}

impl<T, const N: usize> From<[Result<T, EyeUnknown>; N]> for Value {
    fn from(values: [Result<T, EyeUnknown>; N]) -> Self {
        Value::Words(values.map(EyeUnknown::name_of).to_vec())
    }
}
