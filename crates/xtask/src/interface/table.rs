//! The table of the interface: the constants, structs and functions of `src/ffi`, with what their
//! comments state.

use super::facts::Facts;
use crate::root;
use anyhow::{Context, Result, bail, ensure};
use syn::{Attribute, Expr, Item, Lit, Type, UnOp};

/// The files that describe the interface, in the order of the header.
pub const SOURCES: [&str; 9] = [
    "src/ffi/types.rs",
    "src/ffi/weights.rs",
    "src/ffi/monitor_types.rs",
    "src/ffi/api.rs",
    "src/ffi/identity.rs",
    "src/ffi/names.rs",
    "src/ffi/group.rs",
    "src/ffi/mesh.rs",
    "src/ffi/monitor.rs",
];

/// The type of a field, or of the elements of an array.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// `uint32_t`.
    U32,
    /// `int64_t`.
    I64,
    /// `float`.
    F32,
    /// `size_t`.
    Size,
    /// Any pointer.
    Pointer,
    /// A struct, without `posewise_`.
    Struct(String),
}

/// A field of a struct.
#[derive(Clone)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// Its type.
    pub kind: Kind,
    /// Elements of an array.
    pub count: Option<usize>,
    /// Its comment, or that of the group of fields before it.
    pub comment: String,
    /// What the comment has in brackets.
    pub facts: Facts,
}

/// A struct whose fields the header shows.
pub struct Struct {
    /// Its name without `posewise_`.
    pub name: String,
    /// Its comment.
    pub comment: String,
    /// Its fields, in order.
    pub fields: Vec<Field>,
}

impl Struct {
    /// Whether it starts with its size, and so may grow.
    pub fn grows(&self) -> bool {
        self.fields.first().is_some_and(|f| f.name == "struct_size")
    }
}

/// A constant.
pub struct Constant {
    /// Its name without `POSEWISE_`.
    pub name: String,
    /// Its value.
    pub value: i64,
    /// Its comment.
    pub comment: String,
    /// Constants without an empty line between them are one family.
    pub family: usize,
}

/// A function.
pub struct Function {
    /// Its name.
    pub name: String,
    /// Its comment.
    pub comment: String,
}

/// The interface.
#[derive(Default)]
pub struct Table {
    /// Constants.
    pub constants: Vec<Constant>,
    /// Structs, those within others before them.
    pub structs: Vec<Struct>,
    /// Functions.
    pub functions: Vec<Function>,
}

/// What the constants of words begin with, of which each counts from 0.
pub const WORDS: [&str; 18] = [
    "STATE",
    "LOSS",
    "EVENT",
    "EYE",
    "LENS",
    "TERMS",
    "GAZE",
    "LIKENESS",
    "MONITOR_PRESET",
    "MONITOR_EYES",
    "MONITOR_REASON",
    "MONITOR_DROWSINESS",
    "MONITOR_EVENT",
    "MONITOR_BY",
    "MONITOR_PLACE",
    "MONITOR_ZONE",
    "MESH_SPACE",
    "MESH_LINE",
];

/// Words that have no such beginning.
const STATES: [&str; 3] = ["SEARCHING", "TRACKING", "COASTING"];

/// Constants that begin like words: indices of weights, a flag, and what an index may be else.
const NO_WORDS: [&str; 4] = [
    "EYE_LOOK",
    "MONITOR_ZONE_ROAD",
    "MONITOR_ZONE_OUTSIDE",
    "MONITOR_ZONE_UNKNOWN",
];

impl Table {
    /// Reads the sources of the repository.
    ///
    /// # Errors
    /// If they have what the interface cannot have.
    pub fn read() -> Result<Table> {
        let mut table = Table::default();
        for path in SOURCES {
            let text = std::fs::read_to_string(root().join(path)).context(path)?;
            table.add(&text).context(path)?;
        }
        Ok(table)
    }

    fn add(&mut self, text: &str) -> Result<()> {
        for item in syn::parse_file(text)?.items {
            match item {
                Item::Const(item) => {
                    let name = item.ident.to_string();
                    if let Some(name) = name.strip_prefix("POSEWISE_") {
                        self.constants.push(Constant {
                            name: name.to_owned(),
                            value: number(&item.expr).context(name.to_owned())?,
                            comment: comment_of(&item.attrs),
                            family: 0,
                        });
                    }
                }
                Item::Struct(item) => self.add_struct(&item)?,
                Item::Fn(item) if item.sig.abi.is_some() => self.functions.push(Function {
                    name: item.sig.ident.to_string(),
                    comment: comment_of(&item.attrs),
                }),
                _ => {}
            }
        }
        self.find_families(text);
        Ok(())
    }

    fn add_struct(&mut self, item: &syn::ItemStruct) -> Result<()> {
        let name = item.ident.to_string();
        let fields = item.fields.iter();
        let named = name.strip_prefix("posewise_");
        let (Some(name), true) = (named, fields.clone().all(|f| is_public(&f.vis))) else {
            return Ok(());
        };
        let mut found: Vec<Field> = Vec::new();
        let (mut comment, mut nth) = (String::new(), 0);
        for field in fields {
            let ident = field.ident.as_ref().context("a field has a name")?;
            let own = comment_of(&field.attrs);
            (comment, nth) = match own.is_empty() {
                true => (comment, nth + 1),
                false => (own, 0),
            };
            let (kind, count) = kind_of(&field.ty)?;
            let facts = Facts::of(&comment, nth).with_context(|| format!("{name}.{ident}"))?;
            let ident = ident.to_string();
            let is_free = matches!(
                kind,
                Kind::U32 | Kind::Size | Kind::Pointer | Kind::Struct(_)
            );
            facts.check(&ident, is_free).context(name.to_owned())?;
            found.push(Field {
                name: ident,
                kind,
                count,
                comment: comment.clone(),
                facts,
            });
        }
        self.structs.push(Struct {
            name: name.to_owned(),
            comment: comment_of(&item.attrs),
            fields: found,
        });
        Ok(())
    }

    /// Numbers the families of the constants in a text.
    fn find_families(&mut self, text: &str) {
        let mut family = self.constants.iter().map(|c| c.family).max().unwrap_or(0) + 1;
        for line in text.lines() {
            if line.is_empty() {
                family += 1;
            }
            let name = line.strip_prefix("pub const POSEWISE_");
            let name = name.and_then(|rest| rest.split(':').next());
            let mut constants = self.constants.iter_mut();
            if let Some(found) = constants.find(|c| Some(&*c.name) == name) {
                found.family = family;
            }
        }
    }

    /// A struct by its name without `posewise_`.
    ///
    /// # Errors
    /// If there is none.
    pub fn get(&self, name: &str) -> Result<&Struct> {
        let found = self.structs.iter().find(|item| item.name == name);
        found.with_context(|| format!("no struct {name}"))
    }

    /// The value of a constant by its name without `POSEWISE_`.
    ///
    /// # Errors
    /// If there is none.
    pub fn value(&self, name: &str) -> Result<i64> {
        let found = self.constants.iter().find(|known| known.name == name);
        Ok(found.with_context(|| format!("no POSEWISE_{name}"))?.value)
    }

    /// Constants whose names begin so, without that beginning.
    pub fn with_prefix<'a>(&'a self, prefix: &str) -> Vec<(&'a str, i64)> {
        let named = self.constants.iter();
        named
            .filter_map(|c| Some((c.name.strip_prefix(prefix)?, c.value)))
            .collect()
    }

    /// The words of one of [`WORDS`], by number.
    ///
    /// # Errors
    /// If the constants do not count from 0.
    pub fn words(&self, kind: &str) -> Result<Vec<String>> {
        let found = match kind {
            "STATE" => {
                let states = STATES.iter().map(|name| Ok((*name, self.value(name)?)));
                states.collect::<Result<Vec<_>>>()?
            }
            _ => self.with_prefix(&format!("{kind}_")),
        };
        let is_word = |name: &str| {
            let full = format!("{kind}_{name}");
            !NO_WORDS.iter().any(|other| full.starts_with(other))
        };
        let found = found.iter().filter(|(name, _)| is_word(name));
        let words = found.zip(0..).map(|((name, value), i)| match *value == i {
            true => Ok(word(name)),
            false => bail!("POSEWISE_{kind}_{name} is not {i}"),
        });
        words.collect()
    }
}

/// Which of [`WORDS`] a field's values are.
pub fn words_of(field: &Field) -> Option<&'static str> {
    let first = field.facts.values.first()?;
    let kind = match STATES.contains(&&**first) {
        true => "STATE",
        // All of them, or the first of a list.
        false => match first.rsplit_once('_') {
            Some((family, _)) if field.facts.values.len() > 1 => family,
            _ => first,
        },
    };
    WORDS.into_iter().find(|word| *word == kind)
}

/// A constant's name as a word, as the library's functions give it: `low-confidence`.
pub fn word(name: &str) -> String {
    name.to_lowercase().replace('_', "-")
}

fn is_public(visibility: &syn::Visibility) -> bool {
    matches!(visibility, syn::Visibility::Public(_))
}

/// The lines of a comment as one text, as the C reader sees it.
fn comment_of(attributes: &[Attribute]) -> String {
    let lines = attributes.iter().filter_map(|attribute| {
        let meta = attribute.meta.require_name_value().ok()?;
        match &meta.value {
            Expr::Lit(text) if meta.path.is_ident("doc") => match &text.lit {
                Lit::Str(text) => Some(text.value().trim().to_owned()),
                _ => None,
            },
            _ => None,
        }
    });
    let lines: Vec<String> = lines.collect();
    lines.join(" ").replace("\\[", "[").replace("\\]", "]")
}

fn number(expression: &Expr) -> Result<i64> {
    Ok(match expression {
        Expr::Lit(literal) => match &literal.lit {
            Lit::Int(number) => number.base10_parse()?,
            _ => bail!("no integer"),
        },
        Expr::Unary(unary) if matches!(unary.op, UnOp::Neg(_)) => -number(&unary.expr)?,
        Expr::Binary(product) if matches!(product.op, syn::BinOp::Mul(_)) => {
            number(&product.left)? * number(&product.right)?
        }
        _ => bail!("no integer"),
    })
}

fn kind_of(kind: &Type) -> Result<(Kind, Option<usize>)> {
    match kind {
        Type::Array(array) => {
            let (kind, inner) = kind_of(&array.elem)?;
            ensure!(inner.is_none(), "an array of arrays");
            Ok((kind, Some(usize::try_from(number(&array.len)?)?)))
        }
        Type::Ptr(_) => Ok((Kind::Pointer, None)),
        Type::Path(path) => {
            let name = path.path.require_ident()?.to_string();
            let kind = match &*name {
                "u32" => Kind::U32,
                "i64" => Kind::I64,
                "f32" => Kind::F32,
                "usize" => Kind::Size,
                _ => match name.strip_prefix("posewise_") {
                    Some(inner) => Kind::Struct(inner.to_owned()),
                    None => bail!("a field cannot be {name}"),
                },
            };
            Ok((kind, None))
        }
        _ => bail!("a field cannot have this type"),
    }
}
