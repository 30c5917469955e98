//! The seal of a certificate: a checksum over all that it says, as it is read.
//!
//! ```text
//! SHA-256 of, for each dataset of the root in the order of their names: name, number of values,
//! values as doubles; then of each attribute that a certificate uses: name, value
//! ```
//! Numbers are taken as doubles, least byte first, every NaN as one; so a file that another tool
//! has saved again keeps its seal as long as it keeps its numbers. Dimension scales that only count
//! are left out.

use super::schema::Dimension;
use super::{Attribute, Error, ResultFile};
use hdf5::File;
use sha2::{Digest, Sha256};

/// The attribute that holds the seal.
pub(super) const SEAL: &str = "certificate_sha256";
/// The dataset that a certificate cannot be without.
pub(super) const CERTIFICATE: &str = "reference_digits";

/// Whether a file is as it was when its certificate was sealed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Seal {
    /// It is.
    Whole,
    /// Something was changed since.
    Broken,
    /// It has no seal.
    Missing,
}

/// SHA-256 of a text, in hexadecimal.
pub fn sha256(text: &str) -> String {
    hexadecimal(Sha256::digest(text))
}

fn hexadecimal(digest: impl IntoIterator<Item = u8>) -> String {
    digest.into_iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The seal that the contents of a file ask for.
pub(super) fn seal_of(file: &File) -> hdf5::Result<String> {
    let mut hash = Sha256::new();
    let mut names = file.member_names()?;
    names.sort_unstable();
    let counts = |name: &String| {
        Dimension::ALL.iter().any(|d| *d != Dimension::Time && d.name() == name.as_str())
    };
    for name in names.iter().filter(|name| !counts(name)) {
        let values = file.dataset(name)?.read_raw::<f64>()?;
        hash.update(name.as_bytes());
        hash.update((values.len() as u64).to_le_bytes());
        values.iter().for_each(|value| hash.update(bytes_of(*value)));
    }
    let mut attributes = file.attr_names()?;
    attributes.retain(|name| is_used(name));
    attributes.sort_unstable();
    for name in attributes {
        hash.update(name.as_bytes());
        match Attribute::read(file, &name)? {
            Some(Attribute::Text(text)) => hash.update(text.as_bytes()),
            Some(Attribute::Number(value)) => hash.update(bytes_of(value)),
            Some(Attribute::Integer(value)) => hash.update(bytes_of(value as f64)),
            None => {}
        }
    }
    Ok(hexadecimal(hash.finalize()))
}

/// Whether what a certificate says depends on an attribute.
fn is_used(name: &str) -> bool {
    let exact = ["case_toml", "double_precision_ends"];
    exact.contains(&name) || name.starts_with("reference_") || name.starts_with("scale_")
}

fn bytes_of(value: f64) -> [u8; 8] {
    if value.is_nan() { f64::NAN.to_le_bytes() } else { value.to_le_bytes() }
}

impl ResultFile {
    /// The seal that the contents of this file ask for, in hexadecimal.
    ///
    /// # Errors
    /// What reading meets.
    pub fn contents_sha256(&self) -> Result<String, Error> {
        seal_of(self.handle()).map_err(|error| self.failed("read", error))
    }

    /// Whether the file is as it was when its certificate was sealed.
    ///
    /// # Errors
    /// What reading meets.
    pub fn seal(&self) -> Result<Seal, Error> {
        let Some(sealed) = self.text(SEAL) else { return Ok(Seal::Missing) };
        let whole = self.contents_sha256()? == sealed;
        Ok(if whole { Seal::Whole } else { Seal::Broken })
    }
}
