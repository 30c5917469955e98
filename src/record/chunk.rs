//! Chunks of datasets as they stand in a file.
//!
//! A chunk is shuffled and deflated here and handed over as it is to stand, past the library's filters
//! and cache; it is read back the same way. So what has arrived is known without inflating it, and the
//! library's lock is held while bytes are copied only. Any reader undoes both by the filters that the
//! dataset names: shuffle, deflate (HDF5 File Format Specification 3.0, IV.A.2.l).

use flate2::Compression;
use flate2::write::ZlibEncoder;
use hdf5::{Dataset, Error, H5Type, Result};
use std::ffi::{c_int, c_void};
use std::io::Write;

/// HDF5's `hid_t` and `hsize_t`, since 1.10.
type Identifier = i64;
type Size = u64;

/// Dimensions that a dataset has at most.
const MOST_DIMENSIONS: usize = 2;

// SAFETY: the signatures are those of H5Dpublic.h, HDF5 1.10.3.
#[link(name = "hdf5")]
unsafe extern "C" {
    fn H5Dwrite_chunk(
        dataset: Identifier,
        transfer: Identifier,
        filters_left_out: u32,
        offset: *const Size,
        bytes: usize,
        buffer: *const c_void,
    ) -> c_int;
    fn H5Dget_chunk_storage_size(
        dataset: Identifier,
        offset: *const Size,
        bytes: *mut Size,
    ) -> c_int;
    fn H5Dread_chunk(
        dataset: Identifier,
        transfer: Identifier,
        offset: *const Size,
        filters_left_out: *mut u32,
        buffer: *mut c_void,
    ) -> c_int;
}

/// HDF5's `H5P_DEFAULT`.
const AS_USUAL: Identifier = 0;

/// Numbers that datasets are made of.
pub(super) trait Number: H5Type + Into<f64> + Copy {
    /// Its bytes, the least first.
    fn bytes(self) -> impl AsRef<[u8]>;
}

impl Number for f64 {
    fn bytes(self) -> impl AsRef<[u8]> {
        self.to_le_bytes()
    }
}

impl Number for i32 {
    fn bytes(self) -> impl AsRef<[u8]> {
        self.to_le_bytes()
    }
}

impl Number for i8 {
    fn bytes(self) -> impl AsRef<[u8]> {
        self.to_le_bytes()
    }
}

/// A chunk of `count` values as it stands in a file: these values and zeros behind them, first bytes
/// first, deflated with an effort of 0 to 9.
pub(super) fn pack<T: Number>(values: &[T], count: usize, effort: u8) -> Result<Vec<u8>> {
    let size = size_of::<T>();
    let mut shuffled = vec![0; count * size];
    for (k, value) in values.iter().enumerate() {
        for (place, byte) in value.bytes().as_ref().iter().enumerate() {
            shuffled[place * count + k] = *byte;
        }
    }
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::new(effort.into()));
    let written = packed.write_all(&shuffled).and_then(|()| packed.finish());
    written.map_err(|error| error.to_string().into())
}

/// Writes a chunk that begins at a row.
pub(super) fn write(dataset: &Dataset, row: usize, packed: &[u8]) -> Result<()> {
    let offset = offset(dataset, row)?;
    hdf5::sync::sync(|| {
        // SAFETY: it is an open dataset of at most two dimensions for the length of the call; `offset`
        // has an entry for each, `packed` as many bytes as are told; both are only read; the library's
        // lock is held.
        let status = unsafe {
            H5Dwrite_chunk(
                dataset.id(),
                AS_USUAL,
                0,
                offset.as_ptr(),
                packed.len(),
                packed.as_ptr().cast(),
            )
        };
        told(status)
    })
}

/// Reads the chunk of so many bytes that begins at a row, which all filters of the dataset have passed.
pub(super) fn read(dataset: &Dataset, row: usize, bytes: usize) -> Result<Vec<u8>> {
    let offset = offset(dataset, row)?;
    hdf5::sync::sync(|| {
        let mut size = 0;
        // SAFETY: it is an open dataset of at most two dimensions for the length of the call; `offset`
        // has an entry for each and is only read, `size` is written; the library's lock is held.
        told(unsafe { H5Dget_chunk_storage_size(dataset.id(), offset.as_ptr(), &mut size) })?;
        if size != bytes as Size {
            return Err(format!("a chunk of {size} bytes in place of {bytes}").into());
        }
        let mut packed = vec![0; bytes];
        let mut left_out = 0;
        // SAFETY: as above; the library writes the `bytes` bytes of the chunk, which `packed` has, and
        // `left_out`.
        told(unsafe {
            H5Dread_chunk(
                dataset.id(),
                AS_USUAL,
                offset.as_ptr(),
                &mut left_out,
                packed.as_mut_ptr().cast(),
            )
        })?;
        if left_out != 0 {
            return Err("a chunk that filters were left out of".into());
        }
        Ok(packed)
    })
}

/// Where a chunk that begins at a row lies, an entry for each dimension.
fn offset(dataset: &Dataset, row: usize) -> Result<[Size; MOST_DIMENSIONS]> {
    match dataset.ndim() {
        1..=MOST_DIMENSIONS => Ok([row as Size, 0]),
        count => Err(format!("a dataset of {count} dimensions").into()),
    }
}

/// A negative status is the library's error.
fn told(status: c_int) -> Result<()> {
    if status < 0 { Err(Error::query()?) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hdf5::{Extent, File, SimpleExtents};

    #[test]
    fn the_library_reads_what_is_packed_here() {
        let folder = tempfile::tempdir().unwrap();
        let file = File::create(folder.path().join("a.h5")).unwrap();
        let values: Vec<f64> = (0..12).map(|k| f64::from(k).sin()).collect();
        let make = |name: &str| {
            let shape = [Extent::resizable(4), Extent::fixed(3)].to_vec();
            let dataset = file.new_dataset::<f64>().shuffle().deflate(4).chunk((3, 3));
            dataset.shape(SimpleExtents::from_vec(shape)).create(name).unwrap()
        };
        let dataset = make("ours");
        for (row, values) in (0..).step_by(3).zip(values.chunks(9)) {
            write(&dataset, row, &pack(values, 9, 4).unwrap()).unwrap();
        }
        assert_eq!(dataset.read_raw::<f64>().unwrap(), values);
        let last = pack(&values[9..], 9, 4).unwrap();
        assert_eq!(read(&dataset, 3, last.len()).unwrap(), last);
        assert!(read(&dataset, 3, last.len() + 1).is_err());
        assert!(read(&dataset, 6, last.len()).is_err());
    }

    #[test]
    fn indices_and_flags_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let file = File::create(folder.path().join("a.h5")).unwrap();
        let dataset = file.new_dataset::<i32>().shuffle().deflate(4).chunk(4).shape(4);
        let dataset = dataset.create("index").unwrap();
        write(&dataset, 0, &pack(&[-1, 2, i32::MAX], 4, 4).unwrap()).unwrap();
        assert_eq!(dataset.read_raw::<i32>().unwrap(), [-1, 2, i32::MAX, 0]);
        let dataset = file.new_dataset::<i8>().shuffle().deflate(4).chunk(2).shape(2);
        let dataset = dataset.create("flag").unwrap();
        write(&dataset, 0, &pack(&[1_i8, -1], 2, 4).unwrap()).unwrap();
        assert_eq!(dataset.read_raw::<i8>().unwrap(), [1, -1]);
    }
}
