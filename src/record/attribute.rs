//! Attributes of a result file: one number or one text each.

use super::dimension_scale::{read_text, write_text};
use hdf5::Location;
use hdf5::types::{TypeDescriptor, VarLenAscii, VarLenUnicode};
use std::fmt;

/// The value of an attribute.
#[derive(Debug, Clone, PartialEq)]
pub enum Attribute {
    /// Text.
    Text(String),
    /// A number.
    Number(f64),
    /// A whole number.
    Integer(i64),
}

impl Attribute {
    /// Writes this as a new attribute.
    pub(super) fn write(&self, location: &Location, name: &str) -> hdf5::Result<()> {
        match self {
            Attribute::Text(text) => write_text(location, name, text),
            Attribute::Number(value) => {
                location.new_attr::<f64>().create(name)?.write_scalar(value)
            }
            Attribute::Integer(value) => {
                location.new_attr::<i64>().create(name)?.write_scalar(value)
            }
        }
    }

    /// Reads an attribute; `None` where it is neither one number nor one text. An array of one, as
    /// netCDF tools write it, is what it holds.
    pub(super) fn read(location: &Location, name: &str) -> hdf5::Result<Option<Self>> {
        let attribute = location.attr(name)?;
        if attribute.size() != 1 {
            return Ok(None);
        }
        Ok(match attribute.dtype()?.to_descriptor() {
            Ok(TypeDescriptor::Integer(_) | TypeDescriptor::Unsigned(_)) => {
                attribute.read_raw::<i64>()?.first().copied().map(Attribute::Integer)
            }
            Ok(TypeDescriptor::Float(_)) => {
                attribute.read_raw::<f64>()?.first().copied().map(Attribute::Number)
            }
            Ok(TypeDescriptor::VarLenUnicode) => {
                let texts = attribute.read_raw::<VarLenUnicode>()?;
                texts.first().map(|text| Attribute::from(text.as_str()))
            }
            Ok(TypeDescriptor::VarLenAscii) => {
                let texts = attribute.read_raw::<VarLenAscii>()?;
                texts.first().map(|text| Attribute::from(text.as_str()))
            }
            _ => read_text(&attribute)?.map(Attribute::Text),
        })
    }
}

impl From<&str> for Attribute {
    fn from(text: &str) -> Self {
        Attribute::Text(text.to_owned())
    }
}

impl From<String> for Attribute {
    fn from(text: String) -> Self {
        Attribute::Text(text)
    }
}

impl From<f64> for Attribute {
    fn from(value: f64) -> Self {
        Attribute::Number(value)
    }
}

impl From<i64> for Attribute {
    fn from(value: i64) -> Self {
        Attribute::Integer(value)
    }
}

impl fmt::Display for Attribute {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Attribute::Text(text) => f.write_str(text),
            Attribute::Number(value) => write!(f, "{value:?}"),
            Attribute::Integer(value) => write!(f, "{value}"),
        }
    }
}
