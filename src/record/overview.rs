//! What a result file holds and how it was made, in words.

use super::segments::CHECKPOINT;
use super::{Attribute, Dimension, Error, ResultFile};
use crate::model::one_line;
use serde_json::{Map, Value, json};
use std::fmt;
use std::path::PathBuf;

/// What a result file holds and how it was made; its `Display` is for people to read.
#[derive(Debug, Clone, PartialEq)]
pub struct Overview {
    /// The file.
    pub path: PathBuf,
    /// Name of the case.
    pub case_name: String,
    /// Title of the case.
    pub title: String,
    /// `complete`, `failed` or `running`.
    pub status: String,
    /// Times of the first and the last sample (s); `None` without samples.
    pub span: Option<[f64; 2]>,
    /// Length of each dimension, with the names of its items where they have names.
    pub dimensions: Vec<(Dimension, usize, Vec<String>)>,
    /// All other attributes but the case file's text, in the order of the file.
    pub attributes: Vec<(String, Attribute)>,
}

impl Overview {
    /// Reads the overview of a file.
    pub fn of(file: &ResultFile) -> Result<Self, Error> {
        let text = |name| file.text(name).unwrap_or_default().to_owned();
        let times = file.times()?;
        let told = ["Conventions", "title", "case_name", "case_toml", "run_status", CHECKPOINT];
        let rest = file.attributes().iter().filter(|(name, _)| !told.contains(&name.as_str()));
        let dimensions = Dimension::ALL
            .into_iter()
            .filter(|dimension| match dimension {
                Dimension::Point | Dimension::Memory => file.length(*dimension) > 0,
                _ => true,
            })
            .map(|dimension| (dimension, file.length(dimension), file.names(dimension).to_vec()));
        Ok(Overview {
            path: file.path().to_owned(),
            case_name: text("case_name"),
            title: text("title"),
            status: text("run_status"),
            span: times.first().zip(times.last()).map(|(first, last)| [*first, *last]),
            dimensions: dimensions.collect(),
            attributes: rest.cloned().collect(),
        })
    }
}

impl Overview {
    /// The same for programs; times in s.
    pub fn to_json(&self) -> Value {
        let dimensions = self.dimensions.iter().map(|(dimension, length, names)| {
            let told = match names.is_empty() {
                true => json!({ "length": length }),
                false => json!({ "length": length, "names": names }),
            };
            (dimension.name().to_owned(), told)
        });
        let attributes = self.attributes.iter().map(|(name, attribute)| {
            let value = match attribute {
                Attribute::Text(text) => json!(text),
                // infinite is no number of JSON's, and null would hide it
                Attribute::Number(value) if !value.is_finite() => json!(value.to_string()),
                Attribute::Number(value) => json!(value),
                Attribute::Integer(value) => json!(value),
            };
            (name.clone(), value)
        });
        json!({
            "file": self.path.to_string_lossy(),
            "case_name": self.case_name,
            "title": self.title,
            "run_status": self.status,
            "span": self.span,
            "dimensions": Map::from_iter(dimensions),
            "attributes": Map::from_iter(attributes),
        })
    }
}

impl fmt::Display for Overview {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.path.display())?;
        let [name, title, status] =
            [&self.case_name, &self.title, &self.status].map(|text| one_line(text));
        writeln!(f, "  case       {name}: {title}")?;
        writeln!(f, "  run        {status}")?;
        for (dimension, length, names) in &self.dimensions {
            write!(f, "  {:<9}  {length}", dimension.name())?;
            match (dimension, self.span) {
                (Dimension::Time, Some([first, last])) => {
                    writeln!(f, " samples, {first} s to {last} s")?;
                }
                _ if names.is_empty() => writeln!(f)?,
                _ => writeln!(f, ": {}", names.join(", "))?,
            }
        }
        writeln!(f, "  made with")?;
        for (name, attribute) in &self.attributes {
            let told = attribute.to_string();
            writeln!(f, "    {} = {}", one_line(name), one_line(&told))?;
        }
        Ok(())
    }
}
