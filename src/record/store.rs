//! The HDF5 file as it is being written: made with all its datasets, then grown by blocks of rows.

use super::arrival::{Rows, Sum, Written, crc_of};
use super::chunk::{self, Number};
use super::dimension_scale::set_scale;
use super::header::{Ending, Header, Outcome, Series};
use super::schema::{DATASETS, Dataset, Dimension, SCHEMA_VERSION, Values};
use super::seal::{CERTIFICATE, SEAL, seal_of, sha256};
use super::{Attribute, Error};
use hdf5::file::{AttrCreationOrder, LibraryVersion, LinkCreationOrder};
use hdf5::{Extent, File, H5Type, SimpleExtents};
use ndarray::ArrayView2;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Rows of a chunk along revolutions: most runs have few.
const CHUNK_REVOLUTIONS: usize = 64;

/// Rows of a chunk of a segment at most, for rows that are soon copied.
const CHUNK_ROWS_OF_SEGMENTS: usize = 512;

/// Effort of the compression, 0 to 9.
const DEFLATE: u8 = 4;

/// Rows on their way to the file: for each dataset of a growing dimension, in the order of
/// [`DATASETS`], its values row by row.
#[derive(Debug)]
pub(super) struct Block {
    /// The dimension that grows.
    pub dimension: Dimension,
    /// Number of rows.
    pub rows: usize,
    /// Values of each dataset.
    pub columns: Vec<Vec<f64>>,
}

impl Block {
    /// A block without rows.
    pub fn new(dimension: Dimension) -> Self {
        Block { dimension, rows: 0, columns: vec![Vec::new(); datasets_of(dimension).count()] }
    }
}

/// What a file is for, which says how its rows are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// To be kept: compressed.
    Result,
    /// To be there for a while: quickly written.
    Segment,
}

/// How a dataset grows: so many rows at once, compressed or not.
#[derive(Debug, Clone, Copy)]
struct Chunks {
    rows: usize,
    compressed: bool,
}

impl Purpose {
    /// Chunks along a dimension that grows.
    fn chunks(self, dimension: Dimension, block_rows: usize) -> Chunks {
        match (self, dimension) {
            // compressing a few numbers takes longer than writing them
            (_, Dimension::Revolution) => Chunks { rows: CHUNK_REVOLUTIONS, compressed: false },
            (Purpose::Result, _) => Chunks { rows: block_rows, compressed: true },
            (Purpose::Segment, _) => {
                Chunks { rows: block_rows.min(CHUNK_ROWS_OF_SEGMENTS), compressed: false }
            }
        }
    }
}

/// The datasets that grow with a dimension.
pub(super) fn datasets_of(dimension: Dimension) -> impl Iterator<Item = &'static Dataset> {
    DATASETS.iter().filter(move |dataset| dataset.rows() == dimension)
}

/// A dataset of the open file.
struct Open {
    dataset: &'static Dataset,
    /// Values in a row.
    width: usize,
    handle: hdf5::Dataset,
}

/// The open file. `handles` and `scales` must be dropped before the file is closed: otherwise
/// closing says it went well and writes nothing.
pub(super) struct Store {
    handles: Vec<Open>,
    scales: Vec<(Dimension, hdf5::Dataset)>,
    rows: [usize; Dimension::ALL.len()],
    file: File,
    written: Written,
    purpose: Purpose,
    block_rows: usize,
    /// Where the file is, and what it will be called.
    at: PathBuf,
    path: PathBuf,
}

impl Store {
    /// Makes the file at `at` with all its attributes and empty datasets; errors name `path`.
    pub fn create(
        at: &Path,
        path: &Path,
        header: &Header,
        purpose: Purpose,
    ) -> Result<Self, Error> {
        let file = create_file(at).map_err(failed("create", path))?;
        let mut written = Written::default();
        write_header(&file, &mut written, header)
            .map_err(failed("write the attributes of", path))?;
        let mut store = Store {
            handles: Vec::new(),
            scales: Vec::new(),
            rows: [0; Dimension::ALL.len()],
            file,
            written,
            purpose,
            block_rows: header.block_rows(),
            at: at.to_owned(),
            path: path.to_owned(),
        };
        store.create_scales(header).map_err(failed("make the dimensions of", path))?;
        store.create_datasets(header).map_err(failed("make the datasets of", path))?;
        Ok(store)
    }

    fn create_scales(&mut self, header: &Header) -> hdf5::Result<()> {
        for (id, dimension) in Dimension::ALL.into_iter().enumerate() {
            let optional = matches!(dimension, Dimension::Point | Dimension::Memory);
            if optional && names(header, dimension).is_some_and(<[String]>::is_empty) {
                continue;
            }
            let handle = match names(header, dimension) {
                Some(names) => named_scale(&self.file, &mut self.written, dimension, names)?,
                None if dimension == Dimension::Time => {
                    let chunks = self.chunks(dimension);
                    let written = &mut self.written;
                    create_growing::<f64>(&self.file, written, dimension.name(), chunks, None)?
                }
                None => {
                    let chunks = self.chunks(dimension);
                    let written = &mut self.written;
                    create_growing::<i32>(&self.file, written, dimension.name(), chunks, None)?
                }
            };
            set_scale(&handle, dimension.name())?;
            handle.new_attr::<i32>().create("_Netcdf4Dimid")?.write_scalar(&(id as i32))?;
            let unit = if dimension == Dimension::Time { "s" } else { "1" };
            self.written.attribute(&handle, "units", unit)?;
            self.written.attribute(&handle, "long_name", dimension.long_name())?;
            self.scales.push((dimension, handle));
        }
        Ok(())
    }

    fn chunks(&self, dimension: Dimension) -> Chunks {
        self.purpose.chunks(dimension, self.block_rows)
    }

    fn create_datasets(&mut self, header: &Header) -> hdf5::Result<()> {
        let left_out = |dataset: &Dataset| {
            let items = dataset.items().and_then(|items| names(header, items));
            dataset.is_optional() && items.is_some_and(<[String]>::is_empty)
        };
        for dataset in DATASETS.iter().filter(|dataset| !left_out(dataset)) {
            let width =
                dataset.items().map(|items| names(header, items).map_or(0, <[String]>::len));
            let handle = if dataset.name == Dimension::Time.name() {
                scale_of(&self.scales, Dimension::Time).clone()
            } else {
                let Dataset { name, unit, long_name, values, .. } = *dataset;
                let chunks = self.chunks(dataset.rows());
                let handle = create_dataset(
                    &self.file,
                    &mut self.written,
                    name,
                    unit,
                    long_name,
                    values,
                    (chunks, width),
                )?;
                let dimensions = [dataset.rows()].into_iter().chain(dataset.items());
                for (place, dimension) in (0..).zip(dimensions) {
                    let scale = scale_of(&self.scales, dimension);
                    self.written.scale(&handle, scale, place)?;
                }
                handle
            };
            self.handles.push(Open { dataset, width: width.unwrap_or(1), handle });
        }
        Ok(())
    }

    /// Writes a block behind the rows that are there.
    pub fn append(&mut self, block: &Block) -> Result<(), Error> {
        let begin = self.rows[block.dimension as usize];
        let rows = begin..begin + block.rows;
        let chunks = self.chunks(block.dimension);
        let mut all = Vec::new();
        let scale = (block.dimension != Dimension::Time).then(|| block.dimension.name());
        if let Some(name) = scale {
            let indices: Vec<i32> = rows.clone().map(|row| row as i32).collect();
            let scale = scale_of(&self.scales, block.dimension);
            let written = append_rows(scale, (chunks, None), rows.clone(), &indices);
            all.push((name, written.map_err(failed(format!("write {name} to"), &self.path))?));
        }
        let open = self.handles.iter().filter(|open| open.dataset.rows() == block.dimension);
        // what is left out of this file has no values
        let is_there =
            |dataset: &Dataset| open.clone().any(|open| open.dataset.name == dataset.name);
        let told = datasets_of(block.dimension).zip(&block.columns);
        let told: Vec<&Vec<f64>> =
            told.filter(|(dataset, _)| is_there(dataset)).map(|(_, values)| values).collect();
        for (open, values) in open.zip(told) {
            let Dataset { name, values: stored, .. } = *open.dataset;
            let width = open.dataset.items().map(|_| open.width);
            let written = write_values(&open.handle, stored, (chunks, width), rows.clone(), values)
                .map_err(failed(format!("write {name} to"), &self.path))?;
            all.push((name, written));
        }
        self.rows[block.dimension as usize] = rows.end;
        // only what all datasets have counts
        for (name, written) in all {
            self.written.rows(name, written, rows.end);
        }
        Ok(())
    }

    /// Goes back to the rows that all datasets of a dimension have, after a block that failed, and
    /// closes the file with them.
    pub fn retreat(self, ending: &Ending) -> Result<(), Error> {
        let rows = |dimension: Dimension| self.rows[dimension as usize];
        let shorten = || -> hdf5::Result<()> {
            let growing = |dimension: &Dimension| {
                datasets_of(*dimension).next().is_some() && *dimension != Dimension::Time
            };
            for (dimension, scale) in self.scales.iter().filter(|(of, _)| growing(of)) {
                scale.resize(rows(*dimension))?;
            }
            for Open { dataset, width, handle } in &self.handles {
                match dataset.items() {
                    None => handle.resize(rows(dataset.rows()))?,
                    Some(_) => handle.resize((rows(dataset.rows()), *width))?,
                }
            }
            Ok(())
        };
        shorten().map_err(failed("shorten", &self.path))?;
        self.close(ending)
    }

    /// Makes a dataset of values that are known as a whole.
    fn add(&mut self, series: &Series) -> hdf5::Result<()> {
        let rows = self.rows[series.along as usize];
        if series.values.len() != rows {
            let (name, length) = (series.name, series.values.len());
            return Err(format!("{name} has {length} values for {rows} rows").into());
        }
        let Series { name, unit, long_name, stored, .. } = *series;
        let chunks = self.chunks(series.along);
        let handle = create_dataset(
            &self.file,
            &mut self.written,
            name,
            unit,
            long_name,
            stored,
            (chunks, None),
        )?;
        self.written.scale(&handle, scale_of(&self.scales, series.along), 0)?;
        let written = write_values(&handle, stored, (chunks, None), 0..rows, &series.values)?;
        self.written.rows(name, written, rows);
        Ok(())
    }

    /// Writes how the run ended, seals a certificate, closes the file, and reads it back.
    pub fn close(mut self, ending: &Ending) -> Result<(), Error> {
        for series in &ending.series {
            self.add(series).map_err(failed(format!("write {} to", series.name), &self.path))?;
        }
        let Store { handles, scales, file, mut written, at, path, .. } = self;
        drop((handles, scales));
        write_ending(&file, &mut written, ending).map_err(failed("write the ending of", &path))?;
        if ending.series.iter().any(|series| series.name == CERTIFICATE) {
            let sealed = seal_of(&file).and_then(|seal| written.attribute(&file, SEAL, seal));
            sealed.map_err(failed("seal", &path))?;
        }
        file.flush().map_err(failed("write", &path))?;
        file.close().map_err(failed("close", &path))?;
        match written.missing(&at) {
            Some(what) => Err(Error::NotAsWritten { path, what }),
            None => Ok(()),
        }
    }
}

/// An error of the library while attempting something on a file.
fn failed(attempt: impl Into<String>, path: &Path) -> impl FnOnce(hdf5::Error) -> Error {
    move |error| Error::Library {
        attempt: attempt.into(),
        path: path.to_owned(),
        source: error.into(),
    }
}

/// The scale of a dimension that the file has.
fn scale_of(scales: &[(Dimension, hdf5::Dataset)], dimension: Dimension) -> &hdf5::Dataset {
    let found = scales.iter().find(|(of, _)| *of == dimension);
    &found.expect("a dimension has its scale before what stands along it").1
}

/// Names of the items of a dimension that does not grow.
fn names(header: &Header, dimension: Dimension) -> Option<&[String]> {
    match dimension {
        Dimension::Body => Some(&header.bodies),
        Dimension::Joint => Some(&header.joints),
        Dimension::Clearance => Some(&header.clearances),
        Dimension::Drive => Some(&header.drives),
        Dimension::Point => Some(&header.points),
        Dimension::Memory => Some(&header.memories),
        _ => None,
    }
}

/// Makes an empty file that any HDF5 from 1.8 reads. Chunks are written whole and once, so that
/// caching them would only cost memory. The file's name is known to nobody yet, so that it needs
/// no lock: some network file systems have none, and a process started meanwhile would inherit it
/// and keep the file shut after it was published.
fn create_file(at: &Path) -> hdf5::Result<File> {
    File::with_options()
        .with_fapl(|access| {
            access
                .libver_bounds(LibraryVersion::V18, LibraryVersion::V110)
                .chunk_cache(1, 0, 0.0)
                .file_locking(false)
        })
        .with_fcpl(|creation| {
            creation
                .link_creation_order(LinkCreationOrder::Indexed)
                .attr_creation_order(AttrCreationOrder::Indexed)
                .obj_track_times(false)
        })
        .create(at)
}

/// The scale of a dimension whose items have names, which flags tell.
fn named_scale(
    file: &File,
    written: &mut Written,
    dimension: Dimension,
    names: &[String],
) -> hdf5::Result<hdf5::Dataset> {
    let indices: Vec<i32> = (0..names.len() as i32).collect();
    let scale = file
        .new_dataset::<i32>()
        .obj_track_times(false)
        .attr_creation_order(AttrCreationOrder::Indexed)
        .shape(names.len())
        .create(dimension.name())?;
    scale.write(&indices)?;
    written.values(dimension.name(), &indices);
    if !names.is_empty() {
        written.list(&scale, "flag_values", &indices)?;
        written.attribute(&scale, "flag_meanings", names.join(" "))?;
    }
    Ok(scale)
}

/// Makes a dataset without rows; `width` is the number of values in a row, `None` where the dataset has
/// one dimension.
fn create_growing<T: H5Type>(
    file: &File,
    written: &mut Written,
    name: &str,
    chunks: Chunks,
    width: Option<usize>,
) -> hdf5::Result<hdf5::Dataset> {
    let extents: Vec<Extent> =
        [Extent::resizable(0)].into_iter().chain(width.map(Extent::fixed)).collect();
    let chunk: Vec<usize> =
        [chunks.rows].into_iter().chain(width.map(|width| width.max(1))).collect();
    let dataset = file.new_dataset::<T>();
    let dataset = if chunks.compressed { dataset.shuffle().deflate(DEFLATE) } else { dataset };
    let dataset = dataset
        .chunk(chunk)
        .obj_track_times(false)
        .attr_creation_order(AttrCreationOrder::Indexed)
        .shape(SimpleExtents::from_vec(extents))
        .create(name)?;
    if chunks.compressed {
        written.compressed(&dataset)?;
    }
    Ok(dataset)
}

fn create_dataset(
    file: &File,
    written: &mut Written,
    name: &str,
    unit: &str,
    long_name: &str,
    stored: Values,
    (chunks, width): (Chunks, Option<usize>),
) -> hdf5::Result<hdf5::Dataset> {
    let handle = match stored {
        Values::Real => create_growing::<f64>(file, written, name, chunks, width),
        Values::Index => create_growing::<i32>(file, written, name, chunks, width),
        Values::Flag(_) => create_growing::<i8>(file, written, name, chunks, width),
    }?;
    written.attribute(&handle, "units", unit)?;
    written.attribute(&handle, "long_name", long_name)?;
    if let Values::Flag(meanings) = stored {
        let (values, words): (Vec<i8>, Vec<&str>) = meanings.iter().copied().unzip();
        written.list(&handle, "flag_values", &values)?;
        written.attribute(&handle, "flag_meanings", words.join(" "))?;
    }
    Ok(handle)
}

/// Converts values to those stored and appends them; `width` as in [`create_growing`].
fn write_values(
    handle: &hdf5::Dataset,
    stored: Values,
    form: (Chunks, Option<usize>),
    rows: Range<usize>,
    values: &[f64],
) -> hdf5::Result<Rows> {
    match stored {
        Values::Real => append_rows(handle, form, rows, values),
        Values::Index => {
            let indices: Vec<i32> = values.iter().map(|&value| value as i32).collect();
            append_rows(handle, form, rows, &indices)
        }
        Values::Flag(_) => {
            let flags: Vec<i8> = values.iter().map(|&value| value as i8).collect();
            append_rows(handle, form, rows, &flags)
        }
    }
}

/// Grows a dataset to the end of `rows` and writes these rows, which begin a chunk where chunks are
/// compressed.
fn append_rows<T: Number>(
    handle: &hdf5::Dataset,
    (chunks, width): (Chunks, Option<usize>),
    rows: Range<usize>,
    values: &[T],
) -> hdf5::Result<Rows> {
    match width {
        None => handle.resize(rows.end)?,
        Some(width) => handle.resize((rows.end, width))?,
    }
    let full = chunks.rows * width.unwrap_or(1);
    if chunks.compressed {
        if !rows.start.is_multiple_of(chunks.rows) {
            return Err("rows that begin within a chunk".into());
        }
        let begins = rows.step_by(chunks.rows);
        let packed = begins.zip(values.chunks(full.max(1))).map(|(row, values)| {
            let packed = chunk::pack(values, full, DEFLATE)?;
            chunk::write(handle, row, &packed)?;
            Ok((crc_of(&packed), packed.len()))
        });
        return packed.collect::<hdf5::Result<_>>().map(Rows::Packed);
    }
    match width {
        None => handle.write_slice(values, rows)?,
        Some(width) => {
            let view = ArrayView2::from_shape((rows.len(), width), values)
                .map_err(|error| hdf5::Error::from(error.to_string()))?;
            handle.write_slice(view, ndarray::s![rows, ..])?;
        }
    }
    Ok(Rows::Plain(Sum::of(values)))
}

/// Version of the HDF5 library that the program runs with, as "1.10.8".
pub fn hdf5_version() -> String {
    let (major, minor, patch) = hdf5::library_version();
    format!("{major}.{minor}.{patch}")
}

/// Writes the attributes of the root that are known before the run.
fn write_header(file: &File, written: &mut Written, header: &Header) -> hdf5::Result<()> {
    let own = [
        ("Conventions", Attribute::from("CF-1.11")),
        ("title", Attribute::from(&*header.title)),
        ("schema_version", Attribute::from(SCHEMA_VERSION)),
        ("source", Attribute::from(concat!("freeplay ", env!("CARGO_PKG_VERSION")))),
        ("hdf5_version", Attribute::from(hdf5_version())),
        ("sundials_version", Attribute::from(&*header.sundials_version)),
        ("case_name", Attribute::from(&*header.name)),
        ("case_toml", Attribute::from(&*header.case_text)),
        ("case_sha256", Attribute::from(sha256(&header.case_text))),
    ];
    for (name, attribute) in own {
        written.attribute(file, name, attribute)?;
    }
    for (name, attribute) in &header.attributes {
        written.attribute(file, name, attribute.clone())?;
    }
    written.attribute(file, "started_utc", &*header.started_utc)?;
    written.attribute(file, "run_status", "running")
}

/// Writes the attributes of the root that the end of the run brings.
fn write_ending(file: &File, written: &mut Written, ending: &Ending) -> hdf5::Result<()> {
    for count in &ending.rulings {
        let name = format!("ruling_{}_count", count.name);
        written.attribute(file, &name, count.value as i64)?;
    }
    for count in &ending.counts {
        let name = format!("solver_{}", count.name);
        written.attribute(file, &name, count.value as i64)?;
    }
    for (name, value) in &ending.attributes {
        written.attribute(file, name, value.clone())?;
    }
    written.attribute(file, "finished_utc", &*ending.finished_utc)?;
    file.delete_attr("run_status")?;
    match &ending.outcome {
        Outcome::Complete => written.attribute(file, "run_status", "complete"),
        Outcome::Running => written.attribute(file, "run_status", "running"),
        Outcome::Failed { reason } => {
            written.attribute(file, "run_status", "failed")?;
            written.attribute(file, "run_failure", &**reason)
        }
    }
}
