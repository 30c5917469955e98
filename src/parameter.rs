//! Kinds of parts and the keys that they take in case files: what joints, loads, drives and laws
//! say of themselves. Reading, checks, defaults, the schema and the tables of the documents follow
//! from here.

use crate::scalar::{Decimal, Scalar};

/// A kind of joint, load or course.
#[derive(Debug)]
pub struct Kind {
    /// The word in case files: `kind = "spring"`.
    pub word: &'static str,
    /// What it is, in one line.
    pub title: &'static str,
    /// Where the formula is from, or `""` where it is geometry.
    pub source: &'static str,
    /// A part of this kind, as a case has it.
    pub example: &'static str,
    /// Its keys, in the order of the documents.
    pub keys: &'static [Key],
    /// What holds for several keys together.
    pub also: Option<Rule>,
}

impl Kind {
    /// What kinds leave out that are geometry, and whose keys each hold by themselves.
    pub const PLAIN: Kind =
        Kind { word: "", title: "", source: "", example: "", keys: &[], also: None };
}

/// What must hold for several keys together: the keys that are wrong, and why.
pub type Rule = fn(&Values) -> Vec<(&'static str, String)>;

/// A key of a kind.
#[derive(Debug)]
pub struct Key {
    /// Name in case files.
    pub name: &'static str,
    /// What its value is.
    pub takes: Takes,
    /// Unit of its numbers; may be empty.
    pub unit: &'static str,
    /// What holds where the key is left out.
    pub otherwise: Otherwise,
    /// What it means, in one line.
    pub about: &'static str,
}

impl Key {
    /// A key that must be there: its name, what its value is, the unit of its numbers, and what it
    /// means.
    pub const fn new(
        name: &'static str,
        takes: Takes,
        unit: &'static str,
        about: &'static str,
    ) -> Key {
        Key { name, takes, unit, otherwise: Otherwise::Required, about }
    }

    /// The same, with a value, as TOML has it, that holds where it is left out.
    pub const fn or(self, value: &'static str) -> Key {
        Key { otherwise: Otherwise::Default(value), ..self }
    }

    /// The same, which may be left out.
    pub const fn optional(self) -> Key {
        Key { otherwise: Otherwise::Absent, ..self }
    }
}

/// What the value of a key is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Takes {
    /// A number.
    Number(Range),
    /// Two numbers.
    Vector(Range),
    /// A point, written `body.point`.
    Point,
    /// Two points of two bodies.
    Points,
    /// A body, or `ground`.
    Body,
    /// Two bodies, one of which may be the ground.
    Bodies,
    /// One of some words.
    Word(&'static [&'static str]),
    /// A number, or a table with the `kind` of a course of time and its keys.
    Course,
    /// A number, or one of some words.
    NumberOr(Range, &'static [&'static str]),
    /// A number for both materials that touch, or two, the bearing's first.
    OfMaterials(Range),
    /// A joint of one of these kinds.
    Joint(&'static [&'static str]),
    /// A table with the `law` of a friction and its keys.
    Friction,
    /// Numbers.
    Numbers,
    /// Name of a file beside the case, with a column for each key of the kind that takes numbers, in
    /// their order. What it holds stands in the case as run, in its place.
    File,
}

/// Numbers that a key takes; all of them are finite. Of a vector they are its length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Range {
    /// Every number.
    Any,
    /// Greater than zero.
    Positive,
    /// Zero or greater.
    NotNegative,
    /// Other than zero.
    NotZero,
    /// One or greater.
    AtLeastOne,
    /// What Poisson's ratio may be.
    PoissonRatio,
    /// What a restitution may be.
    Restitution,
}

impl Range {
    /// Whether a number is in it.
    pub fn holds(self, x: f64) -> bool {
        x.is_finite()
            && match self {
                Range::Any => true,
                Range::Positive => x > 0.0,
                Range::NotNegative => x >= 0.0,
                Range::NotZero => x != 0.0,
                Range::AtLeastOne => x >= 1.0,
                Range::PoissonRatio => x > -1.0 && x <= 0.5,
                Range::Restitution => x > 0.0 && x <= 1.0,
            }
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Range::Any => "finite",
            Range::Positive => "positive",
            Range::NotNegative => "zero or positive",
            Range::NotZero => "other than zero",
            Range::AtLeastOne => "at least 1",
            Range::PoissonRatio => "greater than -1 and at most 0.5",
            Range::Restitution => "greater than 0 and at most 1",
        }
    }
}

/// What holds where a key is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Otherwise {
    /// It must be there.
    Required,
    /// This value, as TOML has it.
    Default(&'static str),
    /// Nothing.
    Absent,
}

/// A value of a key, as a case has it.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number.
    Number(Decimal),
    /// Two numbers.
    Vector([Decimal; 2]),
    /// A word or a name.
    Text(String),
    /// Two names.
    Pair([String; 2]),
    /// A part of a part: a course of time, a law of friction.
    Part(Box<Values>),
    /// A constant of the bearing's and of the journal's material.
    Materials([Decimal; 2]),
    /// Any number of numbers.
    Numbers(Vec<Decimal>),
}

/// The kind of a part and the values of its keys.
#[derive(Debug, Clone)]
pub struct Values {
    kind: &'static Kind,
    list: Vec<(&'static str, Value)>,
}

impl PartialEq for Values {
    fn eq(&self, other: &Self) -> bool {
        self.kind.word == other.kind.word && self.list == other.list
    }
}

impl Values {
    /// Those of a kind, without any value yet.
    pub fn new(kind: &'static Kind) -> Self {
        Values { kind, list: Vec::new() }
    }

    /// The same with one more value.
    pub fn with(mut self, key: &'static str, value: Value) -> Self {
        self.list.push((key, value));
        self
    }

    /// The kind.
    pub fn kind(&self) -> &'static Kind {
        self.kind
    }

    /// Whether the kind has this word.
    pub fn is(&self, word: &str) -> bool {
        self.kind.word == word
    }

    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&Value> {
        self.list.iter().find(|(name, _)| *name == key).map(|(_, value)| value)
    }

    /// A number of a key, in an arithmetic; of a key that takes none, not a number.
    pub fn number<S: Scalar>(&self, key: &str) -> S {
        match self.get(key) {
            Some(Value::Number(number)) => number.value(),
            _ => S::from_f64(f64::NAN),
        }
    }

    /// A number of a key as it is written.
    pub fn decimal(&self, key: &str) -> Option<&Decimal> {
        match self.get(key) {
            Some(Value::Number(number)) => Some(number),
            _ => None,
        }
    }

    /// The constant of the bearing's and of the journal's material, of a key.
    pub fn of_materials<S: Scalar>(&self, key: &str) -> [S; 2] {
        match self.get(key) {
            Some(Value::Materials(constants)) => constants.each_ref().map(Decimal::value),
            _ => [S::from_f64(f64::NAN); 2],
        }
    }

    /// The two numbers of a key.
    pub fn vector<S: Scalar>(&self, key: &str) -> [S; 2] {
        match self.get(key) {
            Some(Value::Vector([x, y])) => [x.value(), y.value()],
            _ => [S::from_f64(f64::NAN); 2],
        }
    }

    /// The word or name of a key.
    pub fn text(&self, key: &str) -> &str {
        match self.get(key) {
            Some(Value::Text(text)) => text,
            _ => "",
        }
    }

    /// The two names of a key.
    pub fn pair(&self, key: &str) -> [&str; 2] {
        match self.get(key) {
            Some(Value::Pair(names)) => names.each_ref().map(String::as_str),
            _ => [""; 2],
        }
    }

    /// The numbers of a key; none of a key that takes none.
    pub fn numbers(&self, key: &str) -> &[Decimal] {
        match self.get(key) {
            Some(Value::Numbers(numbers)) => numbers,
            _ => &[],
        }
    }

    /// The part that is the value of a key: a course, a law of friction.
    pub fn part(&self, key: &str) -> Option<&Values> {
        match self.get(key) {
            Some(Value::Part(part)) => Some(part),
            _ => None,
        }
    }
}

/// ` (m)`, or nothing for a pure number.
pub fn in_brackets(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" ({unit})") }
}

/// The list of the kinds of a family of parts, one line a kind: the type that holds any of them,
/// the table of their keys, how each is made, and a macro that does the same with each. A line may
/// stand under an attribute (`#[cfg(test)]`); so may the whole (`#[derive(Copy)]`).
macro_rules! kinds {
    ($d:tt $(#[$about:meta])* $any:ident, $each:ident:
     $($(#[$when:meta])? $name:ident in $file:ident,)+) => {
        $($(#[$when])? mod $file; $(#[$when])? pub use $file::$name;)+

        $(#[$about])*
        #[derive(Debug, Clone)]
        pub enum $any<S> {
            $($(#[$when])? #[doc = concat!("See [`", stringify!($name), "`].")] $name($name<S>),)+
        }

        /// Every kind, with its keys.
        pub const KINDS: &[&$crate::parameter::Kind] = &[$($(#[$when])? &$file::KIND,)+];

        impl<S: Scalar> $any<S> {
            /// The part that these values describe, where it sits; `None` for a kind of another
            /// family.
            pub fn new(values: &Values, ends: &Ends<S>) -> Option<Self> {
                $($(#[$when])? if values.is($file::KIND.word) {
                    return Some($any::$name($name::new(values, ends)));
                })+
                None
            }
        }

        macro_rules! $each {
            ($d any:expr, $d part:ident => $d what:expr) => {
                match $d any { $($(#[$when])? $any::$name($d part) => $d what,)+ }
            };
        }
    };
}
pub(crate) use kinds;
