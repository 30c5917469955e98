//! Dimension scales and text of any length: the HDF5 calls that the crate lacks.
//!
//! A dimension scale names a dimension and gives its values (HDF5 High Level Library, "Dimension
//! Scales Specification and Design Notes"); netCDF-4 and xarray take their dimensions from it. The
//! crate writes text only of a length known when it is compiled; here a text attribute is as long
//! as its text.

use hdf5::types::TypeDescriptor;
use hdf5::{Attribute, Dataset, Error, Location, Result};
use std::ffi::{CString, c_char, c_int, c_uint, c_void};

/// HDF5's `hid_t`, since 1.10.
type Identifier = i64;

#[link(name = "hdf5_hl")]
unsafe extern "C" {
    fn H5DSset_scale(scale: Identifier, name: *const c_char) -> c_int;
    fn H5DSattach_scale(dataset: Identifier, scale: Identifier, dimension: c_uint) -> c_int;
}

#[link(name = "hdf5")]
unsafe extern "C" {
    fn H5Awrite(attribute: Identifier, memory_type: Identifier, buffer: *const c_void) -> c_int;
    fn H5Aread(attribute: Identifier, memory_type: Identifier, buffer: *mut c_void) -> c_int;
}

/// Runs a call under the library's lock; a negative status becomes the library's error.
fn call(f: impl FnOnce() -> c_int) -> Result<()> {
    hdf5::sync::sync(|| if f() < 0 { Err(Error::query()?) } else { Ok(()) })
}

/// Makes a one-dimensional dataset a dimension scale of this name.
pub(super) fn set_scale(scale: &Dataset, name: &str) -> Result<()> {
    let name = CString::new(name).map_err(|error| Error::from(error.to_string()))?;
    // SAFETY: `scale` is an open dataset for the length of the call, `name` ends with a NUL and is
    // only read; the library's lock is held.
    call(|| unsafe { H5DSset_scale(scale.id(), name.as_ptr()) })
}

/// Gives a dimension of a dataset its scale.
pub(super) fn attach_scale(dataset: &Dataset, scale: &Dataset, dimension: u32) -> Result<()> {
    // SAFETY: both are open datasets for the length of the call, which takes numbers only and
    // itself checks that the dimension exists; the library's lock is held.
    call(|| unsafe { H5DSattach_scale(dataset.id(), scale.id(), dimension) })
}

/// Writes a new attribute of fixed length: the text, or one NUL if there is none.
pub(super) fn write_text(location: &Location, name: &str, text: &str) -> Result<()> {
    let bytes = if text.is_empty() { &[0] } else { text.as_bytes() };
    let kind = TypeDescriptor::FixedUnicode(bytes.len());
    let attribute = location.new_attr_builder().empty_as(kind).create(name)?;
    let stored = attribute.dtype()?;
    assert!(stored.size() == bytes.len(), "an attribute is as long as its text");
    // SAFETY: the attribute is one string of `stored.size()` bytes, which `bytes` holds; it is
    // only read; the library's lock is held.
    call(|| unsafe { H5Awrite(attribute.id(), stored.id(), bytes.as_ptr().cast()) })
}

/// Reads an attribute that is one string of fixed length, without the NULs at its end; `None`
/// where it is something else.
pub(super) fn read_text(attribute: &Attribute) -> Result<Option<String>> {
    let stored = attribute.dtype()?;
    let fixed = matches!(
        stored.to_descriptor(),
        Ok(TypeDescriptor::FixedAscii(_) | TypeDescriptor::FixedUnicode(_))
    );
    if !fixed || attribute.size() != 1 {
        return Ok(None);
    }
    let mut bytes = vec![0_u8; stored.size()];
    // SAFETY: the attribute is one string of fixed length, so that `stored.size()` bytes are
    // written, which `bytes` has; the library's lock is held.
    call(|| unsafe { H5Aread(attribute.id(), stored.id(), bytes.as_mut_ptr().cast()) })?;
    let end = bytes.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    bytes.truncate(end);
    Ok(Some(String::from_utf8_lossy(&bytes).into_owned()))
}
