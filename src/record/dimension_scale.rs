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

// SAFETY: the signatures are those of H5DSpublic.h, HDF5 1.10.
#[link(name = "hdf5_hl")]
unsafe extern "C" {
    fn H5DSset_scale(scale: Identifier, name: *const c_char) -> c_int;
    fn H5DSattach_scale(dataset: Identifier, scale: Identifier, dimension: c_uint) -> c_int;
    fn H5DSget_num_scales(dataset: Identifier, dimension: c_uint) -> c_int;
    fn H5DSis_attached(dataset: Identifier, scale: Identifier, dimension: c_uint) -> c_int;
}

// SAFETY: the signatures are those of H5Apublic.h, HDF5 1.10.
#[link(name = "hdf5")]
unsafe extern "C" {
    fn H5Awrite(attribute: Identifier, memory_type: Identifier, buffer: *const c_void) -> c_int;
    fn H5Aread(attribute: Identifier, memory_type: Identifier, buffer: *mut c_void) -> c_int;
}

/// Longest text that is read (bytes): no file of ours has one a tenth as long.
const LONGEST_TEXT: usize = 1 << 26;

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

/// Number of scales that a dimension of a dataset has.
pub(super) fn scales_of(dataset: &Dataset, dimension: u32) -> Result<usize> {
    let mut scales = 0;
    call(|| {
        // SAFETY: it is an open dataset for the length of the call, which takes numbers only and
        // itself checks that the dimension exists; the library's lock is held.
        scales = unsafe { H5DSget_num_scales(dataset.id(), dimension) };
        scales
    })?;
    Ok(scales as usize)
}

/// Whether a dimension of a dataset has this scale. That looks through all that have it.
pub(super) fn is_attached(dataset: &Dataset, scale: &Dataset, dimension: u32) -> Result<bool> {
    let mut attached = 0;
    call(|| {
        // SAFETY: both are open datasets for the length of the call, which takes numbers only and
        // itself checks that the dimension exists; the library's lock is held.
        attached = unsafe { H5DSis_attached(dataset.id(), scale.id(), dimension) };
        attached
    })?;
    Ok(attached > 0)
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
    if stored.size() > LONGEST_TEXT {
        return Err(format!("a text of {} bytes", stored.size()).into());
    }
    let mut bytes = vec![0_u8; stored.size()];
    // SAFETY: the attribute is one string of fixed length, so that `stored.size()` bytes are
    // written, which `bytes` has; the library's lock is held.
    call(|| unsafe { H5Aread(attribute.id(), stored.id(), bytes.as_mut_ptr().cast()) })?;
    let end = bytes.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    bytes.truncate(end);
    Ok(Some(String::from_utf8_lossy(&bytes).into_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use hdf5::File;

    fn with_file(test: impl FnOnce(&File)) {
        let folder = tempfile::tempdir().unwrap();
        let mut options = File::with_options();
        options.fapl().libver_v18();
        test(&options.create(folder.path().join("a.h5")).unwrap());
    }

    #[test]
    fn text_of_any_length_comes_back() {
        with_file(|file| {
            for (name, text) in [("empty", ""), ("short", "δ ≤ c"), ("long", &"δ".repeat(100_000))]
            {
                write_text(file, name, text).unwrap();
                let read = read_text(&file.attr(name).unwrap()).unwrap();
                assert_eq!(read.as_deref(), Some(text), "{name}");
            }
        });
    }

    #[test]
    fn what_is_no_text_of_fixed_length_is_not_read_as_text() {
        with_file(|file| {
            file.new_attr::<i64>().create("number").unwrap().write_scalar(&1_i64).unwrap();
            assert_eq!(read_text(&file.attr("number").unwrap()).unwrap(), None);
            file.new_attr::<hdf5::types::VarLenUnicode>().create("pointer").unwrap();
            assert_eq!(read_text(&file.attr("pointer").unwrap()).unwrap(), None);
        });
    }

    #[test]
    fn a_dimension_that_a_dataset_lacks_gets_no_scale() {
        with_file(|file| {
            let scale = file.new_dataset::<i32>().shape(3).create("scale").unwrap();
            let dataset = file.new_dataset::<f64>().shape(3).create("dataset").unwrap();
            set_scale(&scale, "scale").unwrap();
            attach_scale(&dataset, &scale, 0).unwrap();
            assert!(attach_scale(&dataset, &scale, 1).is_err());
        });
    }
}
