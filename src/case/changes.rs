//! What the command line changes in a case: `--set KEY=VALUE` and `--ideal`.

use crate::model::{Complaint, KeyPath};
use std::fmt;
use std::str::FromStr;
use toml_edit::{DocumentMut, InlineTable, Item, Key, TableLike, Value};

/// What the command line changes in a case.
#[derive(Debug, Clone, Default)]
pub struct Changes {
    /// Keys to set, in this order.
    pub set: Vec<Override>,
    /// Whether every clearance is removed, after that.
    pub ideal: bool,
}

impl Changes {
    /// Whether they change nothing.
    pub(super) fn is_empty(&self) -> bool {
        self.set.is_empty() && !self.ideal
    }

    /// The file that they set the start from.
    pub(super) fn start_from(&self) -> Option<&str> {
        let set = self.set.iter().rev().find(|set| set.key.keys() == ["start", "from"])?;
        set.value.as_str()
    }

    /// Whether they set the time of a start from another run, and not that run.
    pub(super) fn move_start(&self) -> bool {
        let sets = |key: &str| self.set.iter().any(|set| set.key.keys() == ["start", key]);
        sets("at") && !sets("from")
    }

    /// Changes a document; comments and layout of the rest stay. Gives what could not be set.
    pub(super) fn apply(&self, document: &mut DocumentMut) -> Vec<Complaint> {
        let set = |change: &Override| {
            let key = change.key.clone();
            if key.keys() == ["start", "from"] && change.value.is_str() {
                // what is started from another run has no other start
                let start = document.get_mut("start").and_then(Item::as_table_like_mut);
                start.into_iter().for_each(TableLike::clear);
            }
            let message = set(document.as_table_mut(), key.keys(), &change.value).err()?;
            Some(Complaint { key, message })
        };
        let complaints = self.set.iter().filter_map(set).collect();
        if self.ideal {
            remove_clearances(document);
        }
        complaints
    }
}

/// One key to set, written `KEY=VALUE`.
#[derive(Debug, Clone)]
pub struct Override {
    key: KeyPath,
    value: Value,
}

impl Override {
    /// The key.
    pub fn key(&self) -> &KeyPath {
        &self.key
    }
}

impl fmt::Display for Override {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.key, self.value.to_string().trim())
    }
}

/// A text is not `KEY=VALUE`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NotAnOverride {
    /// There is no `=`.
    #[error("{0:?} is not KEY=VALUE, as in joints.A.clearance.radial=0.00015")]
    NoValue(String),
    /// The part before `=` is not a dotted key.
    #[error("{key:?} is not a dotted key, as joints.A.clearance.radial is: {message}")]
    Key {
        /// What was given.
        key: String,
        /// What the parser says.
        message: String,
    },
    /// The part after `=` is not a value.
    #[error("{value:?} is neither a TOML value nor a word: {message}")]
    Value {
        /// What was given.
        value: String,
        /// What the parser says.
        message: String,
    },
}

impl FromStr for Override {
    type Err = NotAnOverride;

    /// Reads a dotted key, `=` and a TOML value; a value that begins with a letter or underscore
    /// and is no TOML counts as a string.
    fn from_str(text: &str) -> Result<Override, NotAnOverride> {
        let Some((key, value)) = text.split_once('=') else {
            return Err(NotAnOverride::NoValue(text.to_owned()));
        };
        let (key, value) = (key.trim(), value.trim());
        let keys = Key::parse(key).map_err(|error| NotAnOverride::Key {
            key: key.to_owned(),
            message: error.message().to_owned(),
        })?;
        let key = KeyPath::new(keys.iter().map(Key::get));
        let value = match value.parse::<Value>() {
            Ok(value) => value,
            Err(_) if value.starts_with(|c: char| c.is_alphabetic() || c == '_') => value.into(),
            Err(error) => {
                let message = error.message().to_owned();
                return Err(NotAnOverride::Value { value: value.to_owned(), message });
            }
        };
        Ok(Override { key, value })
    }
}

/// Keys of which one stands in the place of the other.
const INSTEAD: [[&str; 2]; 6] = [
    ["duration", "revolutions"],
    ["restitution", "achieved_restitution"],
    ["file", "times"],
    ["file", "values"],
    ["file", "positions"],
    ["file", "pressures"],
];

/// Sets a key below a table; tables on the way that are not there are made. Gives what stands in
/// the way.
fn set(table: &mut dyn TableLike, keys: &[String], value: &Value) -> Result<(), String> {
    let Some((key, rest)) = keys.split_first() else { return Ok(()) };
    if rest.is_empty() {
        // what is set takes the place of what would say the same otherwise
        let pairs = INSTEAD.iter().filter(|pair| pair.contains(&key.as_str()));
        pairs.flatten().filter(|other| *other != key).for_each(|other| {
            table.remove(other);
        });
        replace(table, key, value.clone());
        return Ok(());
    }
    // An inline table may stand wherever a value may: below headers, dotted keys, inline tables.
    let made = || Item::Value(Value::InlineTable(InlineTable::new()));
    let below = table.entry(key).or_insert_with(made);
    let kind = below.type_name();
    let (below, rest): (Option<&mut dyn TableLike>, _) = match (below, rest) {
        (Item::ArrayOfTables(list), [key, rest @ ..]) if !rest.is_empty() => {
            let table = place(key).and_then(|place| list.get_mut(place));
            (table.map(|table| table as &mut dyn TableLike), rest)
        }
        (Item::Value(Value::Array(list)), [key, rest @ ..]) if !rest.is_empty() => {
            let table = place(key).and_then(|place| list.get_mut(place)?.as_inline_table_mut());
            (table.map(|table| table as &mut dyn TableLike), rest)
        }
        (below, rest) => (below.as_table_like_mut(), rest),
    };
    match below {
        Some(below) => set(below, rest, value),
        None => Err(format!("cannot be set: {key:?} is no table but a value ({kind})")),
    }
}

/// Place of a table in a list, where they count from 1.
fn place(key: &str) -> Option<usize> {
    key.parse::<usize>().ok()?.checked_sub(1)
}

/// Puts a value in the place of what a key had; the layout and a comment behind it stay.
fn replace(table: &mut dyn TableLike, key: &str, mut value: Value) {
    if let Some(Item::Value(old)) = table.get_mut(key) {
        *value.decor_mut() = old.decor().clone();
        *old = value;
    } else {
        table.insert(key, Item::Value(value));
    }
}

fn remove_clearances(document: &mut DocumentMut) {
    let joints = document.get_mut("joints").and_then(Item::as_table_like_mut);
    for (_, joint) in joints.into_iter().flat_map(|joints| joints.iter_mut()) {
        if let Some(joint) = joint.as_table_like_mut() {
            joint.remove("clearance");
        }
    }
    // a body of that name would have a table
    let mut start = document.get_mut("start").and_then(Item::as_table_like_mut);
    if let Some(start) = &mut start
        && start.get("contact").is_some_and(|contact| !contact.is_table_like())
    {
        start.remove("contact");
    }
    // loads go on remembering
    let of_load = |name: Option<&str>| name.is_some_and(|name| name.ends_with(".memory"));
    match start.and_then(|start| start.get_mut("memory")) {
        Some(Item::Value(Value::Array(all))) => {
            all.retain(|one| of_load(one.as_inline_table().and_then(|one| one.get("of")?.as_str())))
        }
        Some(Item::ArrayOfTables(all)) => {
            all.retain(|one| of_load(one.get("of").and_then(Item::as_str)));
        }
        _ => {}
    }
}
