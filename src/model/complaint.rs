//! What is wrong with a description, and where.

use crate::scalar::Decimal;
use std::borrow::Cow;
use std::fmt;

/// Complaints that are told; of the rest there is only the number. Nor is what might have been meant
/// looked for beyond them, so that a file with ten thousand mistakes is refused at once.
pub const MOST_TOLD: usize = 100;

/// Letters of a name that are told; a longer one is hardly a name, and not worth looking for.
const LONGEST_TOLD: usize = 100;

/// Whether a terminal takes a letter for an order (control characters), or it turns the words around
/// it about without being seen itself.
pub fn is_order(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}')
        || c == '\u{feff}'
}

/// A text that stays in its line and gives a terminal no orders: what would is shown by its number.
pub fn one_line(text: &str) -> Cow<'_, str> {
    if !text.contains(is_order) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| match is_order(c) {
        true => c.escape_default().to_string(),
        false => c.to_string(),
    };
    Cow::Owned(text.chars().map(shown).collect())
}

/// A name as it is told: if it is very long only its begin.
pub fn shortened(name: &str) -> Cow<'_, str> {
    match name.char_indices().nth(LONGEST_TOLD) {
        Some((end, _)) => Cow::Owned(format!("{}…", &name[..end])),
        None => Cow::Borrowed(name),
    }
}

/// The path of a key in a case file, `joints.A.clearance.radial`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct KeyPath(Vec<String>);

impl KeyPath {
    /// The path made of these keys.
    pub fn new<K: Into<String>>(keys: impl IntoIterator<Item = K>) -> Self {
        KeyPath(keys.into_iter().map(Into::into).collect())
    }

    /// The path of a key below this one.
    pub fn key(&self, key: impl Into<String>) -> Self {
        let mut keys = self.0.clone();
        keys.push(key.into());
        KeyPath(keys)
    }

    /// The keys, from the root.
    pub fn keys(&self) -> &[String] {
        &self.0
    }
}

impl fmt::Display for KeyPath {
    /// Keys joined by dots; one that TOML would want quoted stands in quotes, on one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        for (position, key) in self.0.iter().enumerate() {
            let dot = if position > 0 { "." } else { "" };
            let key = shortened(key);
            if !key.is_empty() && key.chars().all(bare) {
                write!(f, "{dot}{key}")?;
            } else {
                write!(f, "{dot}{key:?}")?;
            }
        }
        Ok(())
    }
}

/// One thing wrong with a case, and the key it stands at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Complaint {
    /// The key; where a key is missing, that of the missing key.
    pub key: KeyPath,
    /// What is wrong, and what would be right.
    pub message: String,
}

impl fmt::Display for Complaint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.key, self.message)
    }
}

/// Complaints as they are gathered.
#[derive(Debug, Clone, Default)]
pub struct Complaints(Vec<Complaint>);

impl Complaints {
    /// Adds a complaint about a key.
    pub fn add(&mut self, key: KeyPath, message: impl Into<String>) {
        self.0.push(Complaint { key, message: message.into() });
    }

    /// [`did_you_mean`], as long as complaints are told.
    pub fn near<'a>(&self, word: &str, known: impl IntoIterator<Item = &'a str>) -> String {
        if self.0.len() < MOST_TOLD { did_you_mean(word, known) } else { String::new() }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Complains unless the number is finite. `unit` may be empty; gives whether it is finite.
    pub fn require_finite(&mut self, key: KeyPath, number: &Decimal, unit: &str) -> bool {
        let finite = number.to_f64().is_finite();
        if !finite {
            self.add(key, format!("must be finite{}, is {number}", in_brackets(unit)));
        }
        finite
    }

    /// Complains unless the number is finite and `holds` for it; `what` says in words what must
    /// hold. Gives whether it does.
    pub fn require(
        &mut self,
        key: KeyPath,
        number: &Decimal,
        unit: &str,
        what: &str,
        holds: impl Fn(f64) -> bool,
    ) -> bool {
        if !self.require_finite(key.clone(), number, unit) {
            return false;
        }
        let right = holds(number.to_f64());
        if !right {
            self.add(key, format!("must be {what}{}, is {number}", in_brackets(unit)));
        }
        right
    }

    /// Complains unless the number is positive and finite. Gives whether it is.
    pub fn require_positive(&mut self, key: KeyPath, number: &Decimal, unit: &str) -> bool {
        self.require(key, number, unit, "positive", |x| x > 0.0)
    }

    /// The complaints, in the order of adding.
    pub fn into_vec(self) -> Vec<Complaint> {
        self.0
    }
}

pub use crate::parameter::in_brackets;

/// ` (did you mean "follower"?)` for the known word nearest to `word`, or nothing if none is near.
pub fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    if word.chars().nth(LONGEST_TOLD).is_some() {
        return String::new();
    }
    known
        .into_iter()
        .filter(|candidate| candidate.len() <= LONGEST_TOLD)
        .map(|candidate| (strsim::jaro_winkler(word, candidate), candidate))
        .filter(|(likeness, _)| *likeness > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(String::new(), |(_, nearest)| format!(" (did you mean \"{nearest}\"?)"))
}
