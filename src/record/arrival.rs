//! What has arrived: a file is read back once it is closed, and held against what was written.
//!
//! The HDF5 library writes most things when it pleases, and drops errors that it meets then: after
//! one failed write every later call may succeed, and the file hold zeros where numbers were. So
//! whoever writes keeps note of all attributes and scales, and of each dataset a checksum: CRC-32 of
//! its values as doubles, with their number; where it is compressed, of each chunk as it stands in the
//! file, with what says how to read it. A file is published only if all of it comes back.

use super::dimension_scale::{attach_scale, is_attached, scales_of};
use super::{Attribute, chunk};
use flate2::Crc;
use hdf5::filters::Filter;
use hdf5::types::TypeDescriptor;
use hdf5::{Dataset, File, H5Type, Location};
use ndarray::{Array2, s};
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// Values that are read back at a time.
const BLOCK: usize = 1 << 16;

/// Note of all that was written to a file.
#[derive(Debug, Default)]
pub(crate) struct Written {
    sums: BTreeMap<String, Sum>,
    packed: BTreeMap<String, Packed>,
    attributes: BTreeMap<(String, String), Noted>,
    /// Datasets, their scales, and the dimension that each is the scale of.
    scales: Vec<(String, String, u32)>,
}

/// Rows as they were handed to the library.
#[derive(Debug)]
pub(super) enum Rows {
    /// By their values.
    Plain(Sum),
    /// By chunks: checksum and number of bytes of each.
    Packed(Vec<(u32, usize)>),
}

/// A compressed dataset.
#[derive(Debug)]
struct Packed {
    form: Form,
    /// Checksum and number of bytes of each chunk, in their order along the rows.
    chunks: Vec<(u32, usize)>,
}

/// How the bytes of chunks are to be read.
#[derive(Debug, PartialEq)]
struct Form {
    shape: Vec<usize>,
    chunk: Option<Vec<usize>>,
    number: TypeDescriptor,
    filters: Vec<Filter>,
}

impl Form {
    fn of(dataset: &Dataset) -> hdf5::Result<Form> {
        Ok(Form {
            shape: dataset.shape(),
            chunk: dataset.chunk(),
            number: dataset.dtype()?.to_descriptor()?,
            filters: dataset.filters(),
        })
    }
}

/// Checksum and number of values.
#[derive(Debug, Default)]
pub(super) struct Sum {
    crc: Crc,
    values: u64,
}

impl Sum {
    /// Of these values.
    pub fn of<T: Into<f64> + Copy>(values: &[T]) -> Sum {
        let mut sum = Sum::default();
        sum.take(values.iter().map(|value| (*value).into()));
        sum
    }

    fn append(&mut self, behind: &Sum) {
        self.crc.combine(&behind.crc);
        self.values += behind.values;
    }

    fn take(&mut self, values: impl Iterator<Item = f64>) {
        let mut bytes = Vec::with_capacity(size_of::<f64>() * values.size_hint().0);
        values.for_each(|value| bytes.extend_from_slice(&value.to_le_bytes()));
        self.crc.update(&bytes);
        self.values += (bytes.len() / size_of::<f64>()) as u64;
    }

    fn told(&self) -> (u32, u64) {
        (self.crc.sum(), self.values)
    }
}

/// The value of an attribute.
#[derive(Debug)]
enum Noted {
    One(Attribute),
    Many(Vec<f64>),
}

impl Written {
    /// Takes note of values that are written behind those before, of a dataset by its path.
    pub fn values<T: Into<f64> + Copy>(&mut self, dataset: &str, values: &[T]) {
        let path = format!("/{}", dataset.trim_start_matches('/'));
        self.sums.entry(path).or_default().append(&Sum::of(values));
    }

    /// Takes note of a compressed dataset, before its first chunk.
    pub fn compressed(&mut self, dataset: &Dataset) -> hdf5::Result<()> {
        let packed = Packed { form: Form::of(dataset)?, chunks: Vec::new() };
        self.packed.insert(dataset.name(), packed);
        Ok(())
    }

    /// Takes note of rows that are written behind those before, of a dataset that has come to so many.
    pub(super) fn rows(&mut self, dataset: &str, written: Rows, rows: usize) {
        let path = format!("/{dataset}");
        match written {
            Rows::Plain(sum) => self.sums.entry(path).or_default().append(&sum),
            Rows::Packed(chunks) => {
                if let Some(packed) = self.packed.get_mut(&path) {
                    packed.form.shape[0] = rows;
                    packed.chunks.extend(chunks);
                }
            }
        }
    }

    /// Writes an attribute.
    pub fn attribute(
        &mut self,
        owner: &Location,
        name: &str,
        value: impl Into<Attribute>,
    ) -> hdf5::Result<()> {
        let value = value.into();
        value.write(owner, name)?;
        self.attributes.insert((owner.name(), name.to_owned()), Noted::One(value));
        Ok(())
    }

    /// Writes an attribute that is a list of numbers.
    pub fn list<T: H5Type + Into<f64> + Copy>(
        &mut self,
        owner: &Location,
        name: &str,
        values: &[T],
    ) -> hdf5::Result<()> {
        owner.new_attr::<T>().shape(values.len()).create(name)?.write(values)?;
        let values = values.iter().map(|value| (*value).into()).collect();
        self.attributes.insert((owner.name(), name.to_owned()), Noted::Many(values));
        Ok(())
    }

    /// Gives a dimension of a dataset its scale.
    pub fn scale(
        &mut self,
        dataset: &Dataset,
        scale: &Dataset,
        dimension: u32,
    ) -> hdf5::Result<()> {
        attach_scale(dataset, scale, dimension)?;
        self.scales.push((dataset.name(), scale.name(), dimension));
        Ok(())
    }

    /// Reads a closed file. Gives what of it is not as it was written, if anything is.
    pub fn missing(&self, at: &Path) -> Option<String> {
        let file = File::with_options().with_fapl(|access| access.file_locking(false)).open(at);
        let Ok(file) = file else { return Some("its structure".to_owned()) };
        let opened = Opened { file, datasets: RefCell::default() };
        let values = self.sums.iter().find(|(name, sum)| !has_values(&opened, name, sum));
        let chunks =
            || self.packed.iter().find(|(name, packed)| !has_chunks(&opened, name, packed));
        let values = values.map(|(name, _)| name).or_else(|| chunks().map(|(name, _)| name));
        let values = values.map(|name| name[1..].to_owned());
        let attribute = || {
            let mut all = self.attributes.iter();
            let changed = all.find(|((owner, name), noted)| !has(&opened, owner, name, noted));
            changed.map(|((owner, name), _)| format!("attribute {name} of {owner}"))
        };
        let scale = || {
            let mut all = self.scales.iter().enumerate();
            let lost = all.find(|(k, (dataset, scale, dimension))| {
                // looking for a dataset among all of a scale takes long; one tells that they are there
                let is_last = self.scales[k + 1..].iter().all(|(_, other, _)| other != scale);
                let attached = || {
                    let dataset = opened.dataset(dataset)?;
                    let scales = scales_of(&dataset, *dimension)?;
                    let known =
                        !is_last || is_attached(&dataset, &opened.dataset(scale)?, *dimension)?;
                    Ok::<_, hdf5::Error>(scales == 1 && known)
                };
                !attached().unwrap_or(false)
            });
            lost.map(|(_, (dataset, _, _))| format!("a dimension of {dataset}"))
        };
        values.or_else(attribute).or_else(scale)
    }
}

/// A file whose datasets are opened once.
struct Opened {
    file: File,
    datasets: RefCell<HashMap<String, Dataset>>,
}

impl Opened {
    fn dataset(&self, name: &str) -> hdf5::Result<Dataset> {
        let mut datasets = self.datasets.borrow_mut();
        if let Some(known) = datasets.get(name) {
            return Ok(known.clone());
        }
        let dataset = self.file.dataset(name)?;
        datasets.insert(name.to_owned(), dataset.clone());
        Ok(dataset)
    }
}

/// Whether a dataset holds the values that were written.
fn has_values(opened: &Opened, name: &str, written: &Sum) -> bool {
    let read = || -> hdf5::Result<Sum> {
        let dataset = opened.dataset(name)?;
        let shape = dataset.shape();
        let (rows, width) = match shape.as_slice() {
            [rows] => (*rows, None),
            [rows, width] => (*rows, Some(*width)),
            _ => return Err("it has lost its shape".into()),
        };
        let mut sum = Sum::default();
        let block = (BLOCK / width.unwrap_or(1).max(1)).max(1);
        for begin in (0..rows).step_by(block).filter(|_| width != Some(0)) {
            let rows = begin..rows.min(begin + block);
            if width.is_none() {
                sum.take(dataset.read_slice_1d::<f64, _>(s![rows])?.into_iter());
            } else {
                let values: Array2<f64> = dataset.read_slice_2d(s![rows, ..])?;
                sum.take(values.into_iter());
            }
        }
        Ok(sum)
    };
    read().is_ok_and(|read| read.told() == written.told())
}

/// Whether a dataset holds the chunks that were written.
fn has_chunks(opened: &Opened, name: &str, written: &Packed) -> bool {
    let read = || -> hdf5::Result<bool> {
        let dataset = opened.dataset(name)?;
        if Form::of(&dataset)? != written.form {
            return Ok(false);
        }
        let rows = written.form.chunk.as_ref().map_or(1, |chunk| chunk[0]);
        for (row, (crc, bytes)) in (0..).step_by(rows).zip(&written.chunks) {
            if crc_of(&chunk::read(&dataset, row, *bytes)?) != *crc {
                return Ok(false);
            }
        }
        Ok(true)
    };
    read().unwrap_or(false)
}

/// Checksum of a chunk as it stands in a file.
pub(super) fn crc_of(bytes: &[u8]) -> u32 {
    let mut crc = Crc::new();
    crc.update(bytes);
    crc.sum()
}

/// Whether an attribute has the value that was written.
fn has(opened: &Opened, owner: &str, name: &str, noted: &Noted) -> bool {
    let read = |owner: &Location| match noted {
        Noted::One(value) => Ok(match (Attribute::read(owner, name)?, value) {
            (Some(Attribute::Number(read)), Attribute::Number(value)) => {
                read.to_bits() == value.to_bits()
            }
            (read, value) => read.as_ref() == Some(value),
        }),
        Noted::Many(values) => Ok(owner.attr(name)?.read_raw::<f64>()? == *values),
    };
    let found = match owner {
        "/" => read(&opened.file),
        dataset => opened.dataset(dataset).and_then(|dataset| read(&dataset)),
    };
    found.unwrap_or(false)
}

#[cfg(test)]
mod tests {
    use super::super::dimension_scale::set_scale;
    use super::*;

    /// A file with a dataset, its scale and attributes, and the note of it.
    fn written(at: &Path) -> Written {
        let mut written = Written::default();
        let file = File::create(at).unwrap();
        {
            let scale = file.new_dataset::<i32>().shape(3).create("row").unwrap();
            scale.write(&[0, 1, 2]).unwrap();
            written.values("row", &[0, 1, 2]);
            set_scale(&scale, "row").unwrap();
            written.list(&scale, "flag_values", &[0, 1, 2]).unwrap();
            let values = file.new_dataset::<f64>().shape((3, 2)).create("angle").unwrap();
            let numbers = ndarray::array![[1.0, f64::NAN], [2.0, -0.0], [3.0, 5.0]];
            values.write(&numbers).unwrap();
            let numbers: Vec<f64> = numbers.into_iter().collect();
            written.values("angle", &numbers[..2]);
            written.values("angle", &numbers[2..]);
            written.attribute(&values, "units", "rad").unwrap();
            written.scale(&values, &scale, 0).unwrap();
            written.attribute(&file, "tolerance", f64::NAN).unwrap();
            written.attribute(&file, "title", "").unwrap();
        }
        file.close().unwrap();
        written
    }

    #[test]
    fn all_that_was_written_comes_back_and_what_is_changed_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path().join("a.h5");
        assert_eq!(written(&at).missing(&at), None);
        type Change = fn(&File) -> hdf5::Result<()>;
        let changes: [(&str, Change); 6] = [
            ("row", |file| file.dataset("row")?.write(&[0, 0, 0])),
            ("angle", |file| {
                file.dataset("angle")?.write_slice(&[2.0, 0.0], s![1, ..]) // the sign of zero
            }),
            ("attribute units of /angle", |file| file.dataset("angle")?.delete_attr("units")),
            ("attribute flag_values of /row", |file| {
                file.dataset("row")?.attr("flag_values")?.write(&[0, 1, 3])
            }),
            ("attribute title of /", |file| {
                file.delete_attr("title")?;
                Attribute::from("x").write(file, "title")
            }),
            ("a dimension of /angle", |file| file.dataset("angle")?.delete_attr("DIMENSION_LIST")),
        ];
        for (what, change) in changes {
            let written = written(&at);
            let file = File::open_rw(&at).unwrap();
            change(&file).unwrap();
            file.close().unwrap();
            assert_eq!(written.missing(&at).as_deref(), Some(what));
        }
        let written = written(&at);
        std::fs::File::options().write(true).open(&at).unwrap().set_len(500).unwrap();
        assert_eq!(written.missing(&at).as_deref(), Some("its structure"));
    }
}
