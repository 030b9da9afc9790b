//! Lists of columns, of which names, units, documentation and values all come.

use posewise::{ANIMATION_NAMES, LANDMARKS};

/// The names of a group of columns.
#[derive(Clone, Copy)]
pub enum Names {
    /// One column.
    One(&'static str),
    /// `name_0` … `name_67`.
    PerLandmark(&'static str),
    /// ARKit's blendshape names.
    Animations,
    /// Several columns.
    List(&'static [&'static str]),
}

impl Names {
    /// How many there are.
    pub fn count(self) -> usize {
        match self {
            Names::One(_) => 1,
            Names::PerLandmark(_) => LANDMARKS,
            Names::Animations => ANIMATION_NAMES.len(),
            Names::List(names) => names.len(),
        }
    }

    fn all(self) -> Vec<String> {
        match self {
            Names::One(name) => vec![name.to_string()],
            Names::PerLandmark(name) => (0..LANDMARKS).map(|i| format!("{name}_{i}")).collect(),
            Names::Animations => ANIMATION_NAMES.map(String::from).to_vec(),
            Names::List(names) => names.iter().map(|name| name.to_string()).collect(),
        }
    }
}

/// One value of a row.
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

/// A number and its decimals.
pub fn num(value: f32, decimals: usize) -> Cell {
    Cell::Number(f64::from(value), decimals)
}

/// A group of columns.
pub struct Column<F> {
    /// Names.
    pub names: Names,
    /// Unit, for the docs.
    pub unit: &'static str,
    /// Meaning, for the docs.
    pub meaning: &'static str,
    /// The value of the group's n-th column in a row.
    pub value: F,
}

/// A list of columns: names, unit, meaning => value.
macro_rules! columns {
    (
        $(#[$attribute:meta])*
        $visibility:vis const $list:ident: $value_of:ty = |$row:ident, $i:ident|;
        $($names:expr, $unit:expr, $meaning:expr => $value:expr;)*
    ) => {
        $(#[$attribute])*
        #[allow(unused_variables)] // most groups are of one column
        $visibility const $list: &[Column<$value_of>] = &[$(Column {
            names: $names,
            unit: $unit,
            meaning: $meaning,
            value: |$row, $i| $value,
        }),*];
    };
}
pub(crate) use columns;

/// All names, in order.
pub fn names<F>(columns: &[Column<F>]) -> Vec<String> {
    let names = columns.iter().flat_map(|column| column.names.all());
    names.collect()
}

/// A Markdown table.
pub fn table<F>(columns: &[Column<F>]) -> String {
    let mut out = String::from("| column | unit | meaning |\n|---|---|---|\n");
    for column in columns {
        let all = column.names.all();
        let names = match &all[..] {
            [first, .., last] if all.len() > 3 => format!("`{first}` … `{last}`"),
            all => all
                .iter()
                .map(|name| format!("`{name}`"))
                .collect::<Vec<_>>()
                .join(", "),
        };
        out += &format!("| {names} | {} | {} |\n", column.unit, column.meaning);
    }
    out
}
