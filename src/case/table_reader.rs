//! Reads the keys of one TOML table, and notes what is missing, of the wrong type or unknown.

use super::{DefaultTaken, source};
use crate::model::{Complaint, KeyPath, MOST_TOLD, did_you_mean, in_brackets, shortened};
use crate::parameter::{self, Key, Kind, Otherwise, Takes, Values};
use crate::scalar::Decimal;
use crate::{course, friction};
use std::collections::HashSet;
use toml_edit::{Item, Table, TableLike, Value};

/// What reading a case brought to light.
#[derive(Debug, Default)]
pub(super) struct Findings {
    complaints: Vec<Complaint>,
    /// Tables whose checks would mislead.
    unchecked: Vec<KeyPath>,
    defaults: Vec<DefaultTaken>,
}

impl Findings {
    fn add(&mut self, key: KeyPath, message: String) {
        self.complaints.push(Complaint { key, message });
    }

    /// Adds complaints from checks of the values read. What could not be read has a placeholder
    /// for a value: a check's complaint about a key that has one already, or about anything below
    /// it, says nothing new and is dropped.
    pub fn add_checks(&mut self, checks: Vec<Complaint>) {
        let read = self.complaints.iter().map(|known| known.key.keys());
        let read: HashSet<&[String]> =
            read.chain(self.unchecked.iter().map(KeyPath::keys)).collect();
        let known = |key: &[String]| (0..=key.len()).any(|depth| read.contains(&key[..depth]));
        let new: Vec<Complaint> =
            checks.into_iter().filter(|check| !known(check.key.keys())).collect();
        self.complaints.extend(new);
    }

    /// The complaints and the defaults taken, each in the order of finding.
    pub fn into_parts(self) -> (Vec<Complaint>, Vec<DefaultTaken>) {
        (self.complaints, self.defaults)
    }
}

/// What a value of a case file can be read as.
pub(super) trait FromItem: Sized {
    /// In words, before the unit.
    const EXPECTED: &'static str;

    /// The value, if the item is one.
    fn from_item(item: &Item) -> Option<Self>;

    /// What stands for a value that could not be read, until the complaint is heard.
    fn placeholder() -> Self;
}

impl FromItem for Decimal {
    const EXPECTED: &'static str = "a number";

    fn from_item(item: &Item) -> Option<Self> {
        number(item.as_value()?)
    }

    fn placeholder() -> Self {
        Decimal::from(f64::NAN)
    }
}

impl FromItem for [Decimal; 2] {
    const EXPECTED: &'static str = "two numbers [x, y]";

    fn from_item(item: &Item) -> Option<Self> {
        pair(item, number)
    }

    fn placeholder() -> Self {
        [Decimal::placeholder(), Decimal::placeholder()]
    }
}

/// A constant of the bearing's and of the journal's material.
struct OfMaterials([Decimal; 2]);

impl FromItem for OfMaterials {
    const EXPECTED: &'static str = "a number or two [bearing, journal]";

    fn from_item(item: &Item) -> Option<Self> {
        let both = || Decimal::from_item(item).map(|both| [both.clone(), both]);
        pair(item, number).or_else(both).map(OfMaterials)
    }

    fn placeholder() -> Self {
        OfMaterials([Decimal::placeholder(), Decimal::placeholder()])
    }
}

impl FromItem for Vec<Decimal> {
    const EXPECTED: &'static str = "an array of numbers";

    fn from_item(item: &Item) -> Option<Self> {
        item.as_array()?.iter().map(number).collect()
    }

    fn placeholder() -> Self {
        Vec::new()
    }
}

impl FromItem for String {
    const EXPECTED: &'static str = "a string";

    fn from_item(item: &Item) -> Option<Self> {
        item.as_str().map(str::to_owned)
    }

    fn placeholder() -> Self {
        String::new()
    }
}

impl FromItem for Vec<String> {
    const EXPECTED: &'static str = "an array of strings";

    fn from_item(item: &Item) -> Option<Self> {
        item.as_array()?.iter().map(|each| each.as_str().map(str::to_owned)).collect()
    }

    fn placeholder() -> Self {
        Vec::new()
    }
}

impl FromItem for [String; 2] {
    const EXPECTED: &'static str = "two points [\"body.point\", \"body.point\"]";

    fn from_item(item: &Item) -> Option<Self> {
        pair(item, |value| value.as_str().map(str::to_owned))
    }

    fn placeholder() -> Self {
        [String::new(), String::new()]
    }
}

/// A point, written `body.point`.
struct Point(String);

impl FromItem for Point {
    const EXPECTED: &'static str = "a point \"body.point\"";

    fn from_item(item: &Item) -> Option<Self> {
        item.as_str().map(|point| Point(point.to_owned()))
    }

    fn placeholder() -> Self {
        Point(String::new())
    }
}

/// The name of a body, or `ground`.
struct Body(String);

impl FromItem for Body {
    const EXPECTED: &'static str = "the name of a body, or \"ground\"";

    fn from_item(item: &Item) -> Option<Self> {
        item.as_str().map(|body| Body(body.to_owned()))
    }

    fn placeholder() -> Self {
        Body(String::new())
    }
}

/// The name of a joint.
struct Joint(String);

impl FromItem for Joint {
    const EXPECTED: &'static str = "the name of a joint";

    fn from_item(item: &Item) -> Option<Self> {
        item.as_str().map(|joint| Joint(joint.to_owned()))
    }

    fn placeholder() -> Self {
        Joint(String::new())
    }
}

/// Names of two bodies.
struct TwoBodies([String; 2]);

impl FromItem for TwoBodies {
    const EXPECTED: &'static str = "two bodies [\"body\", \"body\"]";

    fn from_item(item: &Item) -> Option<Self> {
        pair(item, |value| value.as_str().map(str::to_owned)).map(TwoBodies)
    }

    fn placeholder() -> Self {
        TwoBodies([String::new(), String::new()])
    }
}

impl FromItem for bool {
    const EXPECTED: &'static str = "true or false";

    fn from_item(item: &Item) -> Option<Self> {
        item.as_bool()
    }

    fn placeholder() -> Self {
        false
    }
}

/// A number as written; an integer in decimal, whatever its base.
fn number(value: &Value) -> Option<Decimal> {
    match value {
        Value::Float(float) => Decimal::new(&float.display_repr()).ok(),
        Value::Integer(integer) => Decimal::new(&integer.value().to_string()).ok(),
        _ => None,
    }
}

fn pair<T>(item: &Item, read: impl Fn(&Value) -> Option<T>) -> Option<[T; 2]> {
    let values = item.as_array().filter(|values| values.len() == 2)?;
    Some([read(values.get(0)?)?, read(values.get(1)?)?])
}

/// Reads the keys of one table. A key that cannot be read gives a complaint and a placeholder, so
/// that one reading finds every complaint; keys never asked for are complained of at the end.
pub(super) struct TableReader<'d, 'f> {
    path: KeyPath,
    /// `None` for a table that is not there: each key reads as a placeholder, without a word.
    table: Option<&'d dyn TableLike>,
    asked: Vec<&'static str>,
    any_key: bool,
    findings: &'f mut Findings,
}

impl<'d> TableReader<'d, '_> {
    /// Reads a case from its root.
    pub fn root<T>(
        root: &'d dyn TableLike,
        findings: &mut Findings,
        read: impl FnOnce(&mut TableReader) -> T,
    ) -> T {
        let path = KeyPath::new::<String>([]);
        Self::read(path, Some(root), findings, read)
    }

    fn read<T>(
        path: KeyPath,
        table: Option<&'d dyn TableLike>,
        findings: &mut Findings,
        read: impl FnOnce(&mut TableReader) -> T,
    ) -> T {
        let mut reader = TableReader { path, table, asked: Vec::new(), any_key: false, findings };
        let value = read(&mut reader);
        reader.complain_of_unknown_keys();
        value
    }

    fn complain_of_unknown_keys(&mut self) {
        let Some(table) = self.table.filter(|_| !self.any_key) else { return };
        for (key, _) in table.iter().filter(|(key, _)| !self.asked.contains(key)) {
            let known = match self.findings.complaints.len() < MOST_TOLD {
                true => nearest_or_all(key, &self.asked),
                false => String::new(),
            };
            self.findings.add(self.path.key(key), format!("unknown key{known}"));
        }
    }

    /// The item of a key, which from now on is a known one.
    fn item(&mut self, key: &'static str) -> Option<&'d Item> {
        self.asked.push(key);
        self.table?.get(key)
    }

    /// Complains about a key of this table.
    pub fn complain(&mut self, key: &str, message: String) {
        if self.table.is_some() {
            self.findings.add(self.path.key(key), message);
        }
    }

    fn convert<T: FromItem>(&mut self, key: &str, item: &Item, unit: &str) -> T {
        T::from_item(item).unwrap_or_else(|| {
            let (unit, found) = (in_brackets(unit), describe(item));
            self.complain(key, format!("must be {}{unit}, is {found}", T::EXPECTED));
            T::placeholder()
        })
    }

    /// The value of a key that must be there. `unit` is for the complaint, and may be empty.
    pub fn required<T: FromItem>(&mut self, key: &'static str, unit: &str) -> T {
        match self.item(key) {
            Some(item) => self.convert(key, item, unit),
            None => {
                let unit = in_brackets(unit);
                self.complain(key, format!("is missing; it must be {}{unit}", T::EXPECTED));
                T::placeholder()
            }
        }
    }

    /// The value of a key that may be left out.
    pub fn optional<T: FromItem>(&mut self, key: &'static str, unit: &str) -> Option<T> {
        let item = self.item(key)?;
        Some(self.convert(key, item, unit))
    }

    /// A number, or where none is given the default, which is noted.
    pub fn number_or(&mut self, key: &'static str, unit: &str, default: &str) -> Decimal {
        self.optional(key, unit).unwrap_or_else(|| {
            self.note_default(key, default);
            Decimal::new(default).unwrap_or_else(|_| Decimal::placeholder())
        })
    }

    fn note_default(&mut self, key: &str, value: &str) {
        if self.table.is_some() {
            let key = self.path.key(key);
            self.findings.defaults.push(DefaultTaken { key, value: value.to_owned() });
        }
    }

    /// What one of several words stands for; `None` after a complaint.
    pub fn choice<T: Clone>(
        &mut self,
        key: &'static str,
        choices: &[(&'static str, T)],
        default: Option<&'static str>,
    ) -> Option<T> {
        let words: Vec<&str> = choices.iter().map(|(word, _)| *word).collect();
        let word = match (self.item(key), default) {
            (Some(item), _) => match item.as_str() {
                Some(word) => word,
                None => {
                    let (expected, found) = (one_of(&words), describe(item));
                    self.complain(key, format!("must be {expected}, is {found}"));
                    return None;
                }
            },
            (None, Some(default)) => {
                self.note_default(key, &format!("{default:?}"));
                default
            }
            (None, None) => {
                self.complain(key, format!("is missing; it must be {}", one_of(&words)));
                return None;
            }
        };
        let found = choices.iter().find(|(known, _)| *known == word);
        if found.is_none() {
            let near = did_you_mean(word, words.iter().copied());
            let word = shortened(word);
            self.complain(key, format!("must be {}, is {word:?}{near}", one_of(&words)));
        }
        found.map(|(_, value)| value.clone())
    }

    /// A number or what one of several words stands for; `None` after a complaint.
    pub fn number_or_choice<T: Clone>(
        &mut self,
        key: &'static str,
        unit: &str,
        choices: &[(&'static str, T)],
        default: Option<&str>,
        from_number: impl FnOnce(Decimal) -> T,
    ) -> Option<T> {
        let words: Vec<&str> = choices.iter().map(|(word, _)| *word).collect();
        let expected = format!("a number{} or {}", in_brackets(unit), one_of(&words));
        let Some(item) = self.item(key) else {
            let default = default.and_then(|number| Decimal::new(number).ok());
            match &default {
                Some(number) => self.note_default(key, &number.to_string()),
                None => self.complain(key, format!("is missing; it must be {expected}")),
            }
            return default.map(from_number);
        };
        if let Some(number) = Decimal::from_item(item) {
            return Some(from_number(number));
        }
        let word = item.as_str();
        let found = choices.iter().find(|(known, _)| Some(*known) == word);
        if found.is_none() {
            let near = word.map_or(String::new(), |word| did_you_mean(word, words));
            let found = word.map_or(describe(item), |word| format!("{:?}", shortened(word)));
            self.complain(key, format!("must be {expected}, is {found}{near}"));
        }
        found.map(|(_, value)| value.clone())
    }

    /// The part whose kind a word chooses, with the values of the keys that its kind takes; `None`
    /// after a complaint about the word.
    pub fn part(
        &mut self,
        key: &'static str,
        kinds: &[&'static Kind],
        default: Option<&'static str>,
    ) -> Option<Values> {
        let words: Vec<(&str, &Kind)> = kinds.iter().map(|kind| (kind.word, *kind)).collect();
        let chosen = self.choice(key, &words, default);
        self.any_key |= chosen.is_none(); // which keys an unknown kind takes is not known
        chosen.map(|kind| self.values(kind))
    }

    /// The values of the keys of a kind.
    pub fn values(&mut self, kind: &'static Kind) -> Values {
        let mut values = Values::new(kind);
        for key in kind.keys {
            if let Some(value) = self.value(key) {
                values = values.with(key.name, value);
            }
        }
        values
    }

    /// The value of a key of a kind; what cannot be read has a placeholder.
    fn value(&mut self, key: &'static Key) -> Option<parameter::Value> {
        let Key { name, takes, unit, otherwise, .. } = key;
        let there = self.table.is_some_and(|table| table.get(name).is_some());
        match otherwise {
            Otherwise::Absent if !there => {
                self.asked.push(name);
                return None;
            }
            Otherwise::Default(default) if !there => {
                self.asked.push(name);
                self.note_default(name, default);
                let word = default.trim_matches('"');
                return Some(match takes {
                    Takes::Number(_) => parameter::Value::Number(Decimal::new(default).ok()?),
                    _ => parameter::Value::Text(word.to_owned()),
                });
            }
            _ => {}
        }
        Some(match takes {
            Takes::Number(_) => parameter::Value::Number(self.required(name, unit)),
            Takes::Vector(_) => parameter::Value::Vector(self.required(name, unit)),
            Takes::Points => parameter::Value::Pair(self.required(name, "")),
            Takes::Bodies => parameter::Value::Pair(self.required::<TwoBodies>(name, "").0),
            Takes::Point => parameter::Value::Text(self.required::<Point>(name, "").0),
            Takes::Body => parameter::Value::Text(self.required::<Body>(name, "").0),
            Takes::Word(words) => {
                let words: Vec<(&str, &str)> = words.iter().map(|word| (*word, *word)).collect();
                parameter::Value::Text(
                    self.choice(name, &words, None).unwrap_or_default().to_owned(),
                )
            }
            Takes::Course => parameter::Value::Part(Box::new(self.course(name, unit))),
            Takes::NumberOr(_, words) => {
                let words: Vec<_> = words
                    .iter()
                    .map(|word| (*word, parameter::Value::Text((*word).to_owned())))
                    .collect();
                let number = parameter::Value::Number;
                let read = self.number_or_choice(name, unit, &words, None, number);
                read.unwrap_or_else(|| parameter::Value::Text(String::new()))
            }
            Takes::Joint(_) => parameter::Value::Text(self.required::<Joint>(name, "").0),
            Takes::Friction => parameter::Value::Part(Box::new(self.friction(name)?)),
            Takes::Numbers => parameter::Value::Numbers(self.required(name, unit)),
            Takes::File => parameter::Value::Text(self.required(name, "")),
            Takes::OfMaterials(_) => {
                parameter::Value::Materials(self.required::<OfMaterials>(name, unit).0)
            }
        })
    }

    /// A course of time: a number, or a table with its kind.
    fn course(&mut self, name: &'static str, unit: &str) -> Values {
        let always =
            |value| Values::new(course::CONSTANT).with("value", parameter::Value::Number(value));
        match self.item(name) {
            Some(item) if item.is_table_like() => {
                let table = self.as_table(name, item);
                let read = |keys: &mut TableReader| keys.part("kind", course::KINDS, None);
                Self::read(self.path.key(name), table, self.findings, read)
                    .unwrap_or_else(|| always(Decimal::placeholder()))
            }
            Some(item) => always(match Decimal::from_item(item) {
                Some(number) => number,
                None => {
                    let (unit, found) = (in_brackets(unit), describe(item));
                    let expected = "a number, or a table with the kind of a course";
                    self.complain(name, format!("must be {expected}{unit}, is {found}"));
                    Decimal::placeholder()
                }
            }),
            None => always(self.required(name, unit)),
        }
    }

    /// A law of friction: a table with the word of its kind.
    fn friction(&mut self, name: &'static str) -> Option<Values> {
        self.table(name, |keys| keys.part("law", friction::KINDS, None))
    }

    /// Says that checks of what stands in this table would mislead.
    pub fn leave_unchecked(&mut self) {
        self.findings.unchecked.push(self.path.clone());
    }

    /// What `read` makes of the table below a key, or of an empty one where there is none.
    pub fn table<T>(&mut self, key: &'static str, read: impl FnOnce(&mut TableReader) -> T) -> T {
        let table = match self.item(key) {
            Some(item) => self.as_table(key, item),
            None => {
                self.complain(key, "is missing; it must be a table".to_owned());
                None
            }
        };
        Self::read(self.path.key(key), table, self.findings, read)
    }

    /// What `read` makes of the table below a key that may be left out.
    pub fn optional_table<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(&mut TableReader) -> T,
    ) -> Option<T> {
        let item = self.item(key)?;
        let table = self.as_table(key, item);
        Some(Self::read(self.path.key(key), table, self.findings, read))
    }

    /// What `read` makes of the table below a key, all of whose keys have defaults.
    pub fn table_of_defaults<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(&mut TableReader) -> T,
    ) -> T {
        let empty = Table::new();
        let table = match self.item(key) {
            Some(item) => self.as_table(key, item),
            None => Some(&empty as &dyn TableLike),
        };
        TableReader::read(self.path.key(key), table, self.findings, read)
    }

    /// What `read` makes of every table below a key, each with its name, in the file's order.
    pub fn named_tables<T>(
        &mut self,
        key: &'static str,
        read: impl FnMut(&str, &mut TableReader) -> T,
    ) -> Vec<T> {
        self.optional_table(key, |reader| reader.other_tables(read)).unwrap_or_default()
    }

    /// What `read` makes of every table of this one that was not asked for, each with its name, in the
    /// file's order.
    pub fn other_tables<T>(&mut self, mut read: impl FnMut(&str, &mut TableReader) -> T) -> Vec<T> {
        let Some(list) = self.table else { return Vec::new() };
        self.any_key = true;
        let mut values = Vec::new();
        let asked = self.asked.clone();
        for (name, item) in list.iter().filter(|(name, _)| !asked.contains(name)) {
            let table = self.as_table(name, item);
            let path = self.path.key(name);
            values.push(TableReader::read(path, table, self.findings, |r| read(name, r)));
        }
        values
    }

    /// Whether a key has a table.
    pub fn has_table(&self, key: &str) -> bool {
        self.table.and_then(|table| table.get(key)).is_some_and(Item::is_table_like)
    }

    /// What `true` or `false` or one of several words stands for, of a key that may be left out; `None`
    /// after a complaint too.
    pub fn flag_or_choice<T: Clone>(
        &mut self,
        key: &'static str,
        choices: &[(&'static str, T)],
        from_flag: impl FnOnce(bool) -> T,
    ) -> Option<T> {
        let item = self.item(key)?;
        if let Some(flag) = item.as_bool() {
            return Some(from_flag(flag));
        }
        let word = item.as_str();
        let found = choices.iter().find(|(known, _)| Some(*known) == word);
        if found.is_none() {
            let words: Vec<&str> = choices.iter().map(|(word, _)| *word).collect();
            let found = word.map_or(describe(item), |word| format!("{:?}", shortened(word)));
            self.complain(key, format!("must be true, false or {}, is {found}", one_of(&words)));
        }
        found.map(|(_, value)| value.clone())
    }

    /// What `read` makes of every table of a list below a key that may be left out; in complaints
    /// they count from 1.
    pub fn list_of_tables<T>(
        &mut self,
        key: &'static str,
        mut read: impl FnMut(&mut TableReader) -> T,
    ) -> Vec<T> {
        let Some(item) = self.item(key) else { return Vec::new() };
        let Some(list) = source::list_of_tables(item) else {
            let (path, found) = (self.path.key(key), describe(item));
            self.complain(key, format!("must be a list of tables [[{path}]], is {found}"));
            return Vec::new();
        };
        let path = self.path.key(key);
        let each = list.into_iter().enumerate();
        each.map(|(k, table)| {
            let path = path.key((k + 1).to_string());
            TableReader::read(path, Some(table), self.findings, &mut read)
        })
        .collect()
    }

    /// Every value below a key, each with its name, in the file's order.
    pub fn named_values<T: FromItem>(&mut self, key: &'static str, unit: &str) -> Vec<(String, T)> {
        let each = |reader: &mut TableReader| {
            let Some(list) = reader.table else { return Vec::new() };
            reader.any_key = true;
            let mut values = Vec::new();
            for (name, item) in list.iter() {
                values.push((name.to_owned(), reader.convert(name, item, unit)));
            }
            values
        };
        self.optional_table(key, each).unwrap_or_default()
    }

    fn as_table<'i>(&mut self, key: &str, item: &'i Item) -> Option<&'i dyn TableLike> {
        let table = item.as_table_like();
        if table.is_none() {
            self.complain(key, format!("must be a table, is {}", describe(item)));
        }
        table
    }
}

/// `"a"`, or `"a" or "b"`, or `one of "a", "b", "c"`.
fn one_of(words: &[&str]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| format!("{word:?}")).collect();
    match quoted.len() {
        0..=2 => quoted.join(" or "),
        _ => format!("one of {}", quoted.join(", ")),
    }
}

/// ` (did you mean "radial"?)`, or if no key is near, the known ones.
fn nearest_or_all(key: &str, known: &[&'static str]) -> String {
    let near = did_you_mean(key, known.iter().copied());
    if near.is_empty() { format!("; known here: {}", known.join(", ")) } else { near }
}

/// What an item is, in words.
fn describe(item: &Item) -> String {
    match item {
        Item::None => "nothing".into(),
        Item::Table(_) | Item::Value(Value::InlineTable(_)) => "a table".into(),
        Item::ArrayOfTables(_) => "an array of tables".into(),
        Item::Value(Value::String(_)) => "a string".into(),
        Item::Value(Value::Integer(_) | Value::Float(_)) => "a number".into(),
        Item::Value(Value::Boolean(_)) => "true or false".into(),
        Item::Value(Value::Datetime(_)) => "a date or time".into(),
        Item::Value(Value::Array(values)) => format!("an array of {}", values.len()),
    }
}
