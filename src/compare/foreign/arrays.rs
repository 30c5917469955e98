//! MATLAB files of version 7.3, Octave's HDF5, and HDF5 of any layout.
//!
//! MATLAB and Octave keep a matrix column by column, so that its dimensions stand in the file in
//! reverse; a struct is a group. Octave makes a group of each variable, with its `value` inside.
//! Every array whose length, or one of whose two sides, is that of the time gives columns, named
//! as their own program would: `y(:,3)` from 1 in MATLAB and Octave, `y[:,2]` from 0 elsewhere.

use super::{ForeignColumn, ForeignTable, Format, TIME_NAMES, last_word};
use crate::compare::Error;
use crate::record::{LibraryError, Member, Ration, members};
use hdf5::types::{IntSize, TypeDescriptor};
use hdf5::{Dataset, File, Group, LocationToken, MinorErrorCode};
use std::path::Path;

/// Groups within groups that are looked into.
const DEEPEST: usize = 8;
/// Groups and datasets that are looked at.
const MOST_OBJECTS: usize = 10_000;

/// An array with one or two sides.
struct Array {
    name: String,
    /// Rows and columns, as its program sees them.
    rows: usize,
    columns: usize,
    /// Whether a column's values stand one after another.
    column_major: bool,
    values: Vec<f64>,
}

impl Array {
    fn is_vector(&self) -> bool {
        self.rows == 1 || self.columns == 1
    }

    fn at(&self, row: usize, column: usize) -> f64 {
        self.values[match self.column_major {
            true => column * self.rows + row,
            false => row * self.columns + column,
        }]
    }

    /// Its name for one of its columns or rows, as its program would write it.
    fn slice_name(&self, of_columns: bool, k: usize) -> String {
        let name = &self.name;
        match (self.column_major, of_columns) {
            (true, true) => format!("{name}(:,{})", k + 1),
            (true, false) => format!("{name}({},:)", k + 1),
            (false, true) => format!("{name}[:,{k}]"),
            (false, false) => format!("{name}[{k},:]"),
        }
    }

    /// What keeps it from giving columns to a table of so many rows; a single number is none.
    fn misfit(&self, length: usize) -> Option<String> {
        let Array { name, rows, columns, .. } = self;
        let fits = if self.is_vector() {
            [1, length].contains(&self.values.len())
        } else {
            [rows, columns].contains(&&length)
        };
        (!fits).then(|| {
            format!("\"{name}\" (left out: {rows} by {columns}, but there are {length} times)")
        })
    }

    /// The columns it gives to a table of so many rows.
    fn columns_of(&self, length: usize) -> Vec<ForeignColumn> {
        let column = |name: String, values: Vec<f64>| ForeignColumn {
            name,
            values,
            text: None,
            written_digits: None,
        };
        if self.is_vector() {
            let fits = self.values.len() == length;
            return fits
                .then(|| column(self.name.clone(), self.values.clone()))
                .into_iter()
                .collect();
        }
        if self.rows == length {
            let values = |k| (0..length).map(|row| self.at(row, k)).collect();
            return (0..self.columns)
                .map(|k| column(self.slice_name(true, k), values(k)))
                .collect();
        }
        if self.columns == length {
            let values = |k| (0..length).map(|at| self.at(k, at)).collect();
            return (0..self.rows).map(|k| column(self.slice_name(false, k), values(k))).collect();
        }
        Vec::new()
    }
}

/// Reads all arrays of numbers that go with a vector of times. Which vector that is, is settled by
/// its name where one has a usual one; else the length that most arrays share decides.
///
/// # Errors
/// The file cannot be read, or holds no arrays of numbers.
pub(super) fn read(path: &Path, format: Format) -> Result<ForeignTable, Error> {
    let failed = |error: hdf5::Error| {
        if error.contains_minor(MinorErrorCode::Truncated) {
            return Error::Truncated { path: path.to_owned() };
        }
        Error::Library { path: path.to_owned(), source: LibraryError::from(error) }
    };
    let file = File::open(path).map_err(failed)?;
    let size = std::fs::metadata(path);
    let size = size.map_err(|source| Error::Unreadable { path: path.to_owned(), source })?;
    let mut found = Found {
        format,
        ration: Ration::new(size.len()),
        seen: Vec::new(),
        arrays: Vec::new(),
        left_out: Vec::new(),
    };
    found.collect(&file, "", DEEPEST).map_err(failed)?;
    let Found { arrays, left_out, .. } = found;
    let Some(length) = length(&arrays) else {
        return Err(Error::Empty { path: path.to_owned() });
    };
    let columns = arrays.iter().flat_map(|array| array.columns_of(length)).collect();
    let misfits = arrays.iter().filter_map(|array| array.misfit(length)).chain(left_out).collect();
    Ok(ForeignTable { path: path.to_owned(), format, columns, misfits, ends_within_a_line: false })
}

/// Number of samples: the length of the vector with a usual name for times, or else of most
/// vectors.
fn length(arrays: &[Array]) -> Option<usize> {
    let vectors = || arrays.iter().filter(|array| array.is_vector() && !array.values.is_empty());
    let usual = TIME_NAMES
        .iter()
        .find_map(|name| vectors().find(|array| last_word(&array.name).to_lowercase() == *name))
        .map(|array| array.values.len());
    usual.or_else(|| {
        let lengths: Vec<usize> = vectors().map(|array| array.values.len()).collect();
        let count = |length: usize| lengths.iter().filter(|other| **other == length).count();
        lengths.iter().copied().max_by_key(|length| (count(*length), *length))
    })
}

/// What a file is found to hold.
struct Found {
    format: Format,
    ration: Ration,
    /// Groups and datasets that were looked at: a file may lead back to where one has been.
    seen: Vec<LocationToken>,
    arrays: Vec<Array>,
    /// What is not read, with the reason.
    left_out: Vec<String>,
}

impl Found {
    fn collect(&mut self, group: &Group, prefix: &str, depth: usize) -> hdf5::Result<()> {
        let members = members(group)?;
        // MATLAB keeps what is no plain array under names with #
        for (name, member) in members.iter().filter(|(name, _)| !name.starts_with('#')) {
            let full = if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
            // the fields of Octave's struct stand in its value
            let octave = name == "value" && members.iter().any(|(other, _)| other == "type");
            let full = if octave { prefix.to_owned() } else { full };
            match *member {
                Member::Dataset(token) if self.is_new(token) => {
                    let dataset = group.dataset(name)?;
                    let column_major = octave || self.format == Format::Matlab;
                    match self.ration.refuses(&dataset)? {
                        None => self.arrays.extend(array(&dataset, full, column_major)?),
                        Some(why) => self.left_out.push(format!("{full:?} (left out: it {why})")),
                    }
                }
                Member::Group(token) if depth > 0 && self.is_new(token) => {
                    self.collect(&group.group(name)?, &full, depth - 1)?;
                }
                Member::Link => {
                    let why = "it is a link to elsewhere, which is not followed";
                    self.left_out.push(format!("{full:?} (left out: {why})"));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Whether an object was not looked at yet, and few enough were.
    fn is_new(&mut self, token: LocationToken) -> bool {
        let new = self.seen.len() < MOST_OBJECTS && !self.seen.contains(&token);
        if new {
            self.seen.push(token);
        }
        new
    }
}

/// An array of numbers with one or two sides; `None` for anything else. Bytes and 16-bit integers
/// are flags and letters.
fn array(dataset: &Dataset, name: String, column_major: bool) -> hdf5::Result<Option<Array>> {
    let shape = dataset.shape();
    let numeric = match dataset.dtype()?.to_descriptor() {
        Ok(TypeDescriptor::Float(_)) => true,
        Ok(TypeDescriptor::Integer(size) | TypeDescriptor::Unsigned(size)) => {
            matches!(size, IntSize::U4 | IntSize::U8)
        }
        _ => false,
    };
    let (rows, columns) = match (shape.as_slice(), column_major) {
        _ if !numeric => return Ok(None),
        ([length], _) => (*length, 1),
        ([columns, rows], true) => (*rows, *columns),
        ([rows, columns], false) => (*rows, *columns),
        _ => return Ok(None),
    };
    let values = dataset.read_raw()?;
    Ok(Some(Array { name, rows, columns, column_major, values }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_made(userblock: bool, fill: impl FnOnce(&File)) -> ForeignTable {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("theirs.mat");
        let size = if userblock { 512 } else { 0 };
        let file =
            File::with_options().with_fcpl(|creation| creation.userblock(size)).create(&path);
        let file = file.unwrap();
        fill(&file);
        file.close().unwrap();
        if userblock {
            let mut bytes = std::fs::read(&path).unwrap();
            bytes[..22].copy_from_slice(b"MATLAB 7.3 MAT-file, P");
            std::fs::write(&path, bytes).unwrap();
        }
        ForeignTable::read(&path).unwrap()
    }

    fn column<'a>(table: &'a ForeignTable, name: &str) -> &'a [f64] {
        let found = table.columns.iter().find(|column| column.name == name);
        &found.unwrap_or_else(|| panic!("{name} among {}", table.names())).values
    }

    /// A 3 × 2 matrix as MATLAB keeps it: two rows of three in the file.
    const BY_COLUMNS: [[f64; 3]; 2] = [[1.0, 2.0, 3.0], [10.0, 20.0, 30.0]];

    #[test]
    fn matlab_matrices_give_their_columns_counted_from_one() {
        let table = read_made(true, |file| {
            let write = |name: &str, values: &ndarray::Array2<f64>| {
                file.new_dataset_builder().with_data(values).create(name).unwrap();
            };
            write("t", &ndarray::array![[0.0, 0.5, 1.0]]);
            write("y", &ndarray::arr2(&BY_COLUMNS));
            write("c", &ndarray::array![[1e-3]]);
            let note = ndarray::array![[104_u16], [105]];
            file.new_dataset_builder().with_data(&note).create("note").unwrap();
            let out = file.create_group("out").unwrap();
            let phi = ndarray::array![[7.0], [8.0], [9.0]];
            out.new_dataset_builder().with_data(&phi).create("phi").unwrap();
        });
        assert_eq!(table.format, Format::Matlab);
        assert_eq!(table.names(), r#""out.phi", "t", "y(:,1)", "y(:,2)""#);
        assert_eq!(column(&table, "y(:,2)"), [10.0, 20.0, 30.0]);
        assert_eq!(column(&table, "out.phi"), [7.0, 8.0, 9.0]);
        assert_eq!(table.usual_time(), Some(1));
    }

    #[test]
    fn a_struct_of_matlab_solvers_gives_its_rows() {
        let table = read_made(true, |file| {
            let sol = file.create_group("sol").unwrap();
            let x = ndarray::array![[0.0], [0.5], [1.0]];
            sol.new_dataset_builder().with_data(&x).create("x").unwrap();
            // 2 × 3 in MATLAB
            let y = ndarray::array![[1.0, 10.0], [2.0, 20.0], [3.0, 30.0]];
            sol.new_dataset_builder().with_data(&y).create("y").unwrap();
        });
        assert_eq!(column(&table, "sol.y(2,:)"), [10.0, 20.0, 30.0]);
    }

    #[test]
    fn hdf5_of_other_programs_counts_from_zero() {
        let table = read_made(false, |file| {
            file.new_dataset_builder().with_data(&[0.0, 0.5, 1.0]).create("time").unwrap();
            let y = ndarray::arr2(&BY_COLUMNS).reversed_axes();
            let y = y.as_standard_layout().into_owned();
            file.new_dataset_builder().with_data(&y).create("y").unwrap();
            file.new_dataset_builder().with_data(&[1_i8, 0, 1]).create("flag").unwrap();
        });
        assert_eq!(table.format, Format::Hdf5);
        assert_eq!(table.names(), r#""time", "y[:,0]", "y[:,1]""#);
        assert_eq!(column(&table, "y[:,1]"), [10.0, 20.0, 30.0]);
    }

    #[test]
    fn arrays_of_another_length_than_the_time_are_told() {
        let table = read_made(true, |file| {
            let t = ndarray::array![[0.0, 0.5]];
            file.new_dataset_builder().with_data(&t).create("t").unwrap();
            let phi = ndarray::array![[7.0, 8.0, 9.0]];
            file.new_dataset_builder().with_data(&phi).create("phi").unwrap();
            let c = ndarray::array![[1e-3]];
            file.new_dataset_builder().with_data(&c).create("c").unwrap();
        });
        assert_eq!(table.names(), r#""t", "phi" (left out: 3 by 1, but there are 2 times)"#);
    }

    #[test]
    fn octave_variables_are_groups_with_a_value() {
        let table = read_made(false, |file| {
            let y = file.create_group("y").unwrap();
            y.new_dataset_builder().with_data(&[1_i8]).create("type").unwrap();
            y.new_dataset_builder().with_data(&ndarray::arr2(&BY_COLUMNS)).create("value").unwrap();
            let t = file.create_group("t").unwrap();
            t.new_dataset_builder().with_data(&[1_i8]).create("type").unwrap();
            let times = ndarray::array![[0.0, 0.5, 1.0]];
            t.new_dataset_builder().with_data(&times).create("value").unwrap();
        });
        assert_eq!(table.names(), r#""t", "y(:,1)", "y(:,2)""#);
        assert_eq!(column(&table, "y(:,2)"), [10.0, 20.0, 30.0]);
    }
}
