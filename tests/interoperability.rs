//! Result files in the hands of other tools: each must find the names, dimensions, units and text,
//! and every value to the last bit.
//!
//! Needs h5py, xarray, netCDF4 and h5netcdf in the Python that `FREEPLAY_PYTHON` names, or else in
//! `.venv`; and `ncdump`, `h5dump` and `octave-cli` with its package netcdf.

mod recorded;

use freeplay::record::{Attribute, ResultFile, SCHEMA_VERSION, Seal};
use recorded::{Expected, Recorded};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A result file and what it must hold.
struct Trial {
    folder: tempfile::TempDir,
    run: Recorded,
    result: PathBuf,
}

impl Trial {
    fn new(run: Recorded) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let result = run.write(&folder.path().join("result.h5"), false);
        let mut lines = String::new();
        for dataset in run.expected() {
            let shape: Vec<String> = dataset.shape.iter().map(usize::to_string).collect();
            let values: Vec<String> = dataset.values.iter().map(|x| format!("{x:?}")).collect();
            let (name, dimensions) = (dataset.name, dataset.dimensions.join(" "));
            let (shape, values) = (shape.join(" "), values.join(" "));
            writeln!(lines, "{name}\t{dimensions}\t{shape}\t{}\t{values}", dataset.unit).unwrap();
        }
        std::fs::write(folder.path().join("expected.txt"), lines).unwrap();
        std::fs::write(folder.path().join("case.toml"), &run.header.case_text).unwrap();
        Trial { folder, run, result }
    }

    /// Runs a script on the file; it must end well.
    fn script(&self, program: &Path, script: &str, more: &[&str]) {
        let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/interoperability");
        let mut command = Command::new(program);
        command
            .arg(scripts.join(script))
            .arg(&self.result)
            .arg(self.folder.path().join("expected.txt"))
            .arg(self.folder.path().join("case.toml"))
            .args(more)
            .env("PYTHONDONTWRITEBYTECODE", "1");
        said_by(command);
    }
}

/// Standard output of a command, which must end well.
fn said_by(mut command: Command) -> String {
    let output = command
        .output()
        .unwrap_or_else(|error| panic!("cannot start {:?}: {error}", command.get_program()));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?} failed: {errors}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The files that every tool is given: two clearances and more rows than a chunk has; no events;
/// no clearance; no rows at all; a case text beyond the 64 kB that HDF5 puts beside a group.
fn trials() -> Vec<Trial> {
    let mut long = Recorded::new(&["A"], 10, 3);
    long.header.case_text = "# δ is the depth\n".repeat(12_000);
    [
        Recorded::new(&["A", "B"], 4100, 4100),
        Recorded::new(&["A"], 30, 0),
        Recorded::new(&[], 30, 0),
        Recorded::new(&["A"], 0, 0),
        long,
    ]
    .into_iter()
    .map(Trial::new)
    .collect()
}

/// The Python that has the readers.
fn python() -> PathBuf {
    let named = std::env::var_os("FREEPLAY_PYTHON").map(PathBuf::from);
    let python =
        named.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join(".venv/bin/python"));
    assert!(
        python.is_file(),
        "there is no {}: make a virtual environment .venv with h5py, xarray, netCDF4 and \
         h5netcdf, or name a Python that has them in FREEPLAY_PYTHON",
        python.display()
    );
    python
}

#[test]
fn h5py_reads_everything() {
    for trial in trials() {
        trial.script(&python(), "with_h5py.py", &[]);
    }
}

#[test]
fn xarray_reads_everything_by_the_engine_netcdf4() {
    for trial in trials() {
        trial.script(&python(), "with_xarray.py", &["netcdf4"]);
    }
}

#[test]
fn xarray_reads_everything_by_the_engine_h5netcdf() {
    for trial in trials() {
        trial.script(&python(), "with_xarray.py", &["h5netcdf"]);
    }
}

/// Has xarray save a file again, by each of its engines.
fn saved_again(file: &Path, folder: &Path) -> Vec<PathBuf> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/interoperability/save_again.py");
    let save = |engine: &str| {
        let output = folder.join(format!("{engine}.h5"));
        let mut command = Command::new(python());
        command.arg(&script).arg(file).arg(&output).arg(engine);
        said_by(command);
        output
    };
    ["netcdf4", "h5netcdf"].map(save).to_vec()
}

#[test]
fn files_that_xarray_has_saved_again_are_read_as_they_were() {
    for trial in trials() {
        for path in saved_again(&trial.result, trial.folder.path()) {
            let file = ResultFile::open(&path).unwrap();
            assert_eq!(file.text("case_toml"), Some(&*trial.run.header.case_text));
            assert_eq!(file.attribute("schema_version"), Some(&Attribute::Integer(SCHEMA_VERSION)));
            assert!(file.is_complete());
            assert_eq!(file.bodies(), trial.run.header.bodies);
            assert_eq!(file.clearances(), trial.run.header.clearances);
            for Expected { name, values, .. } in trial.run.expected() {
                if freeplay::record::DATASETS.iter().any(|dataset| dataset.name == name) {
                    let found = file.table(name).unwrap().values;
                    let bits = |list: &[f64]| list.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                    assert_eq!(bits(&found), bits(&values), "{name} of {}", path.display());
                }
            }
        }
    }
}

#[test]
fn a_certificate_keeps_its_seal_where_xarray_saves_it_again() {
    let certified =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/certified/four-bar-a.h5");
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(ResultFile::open(&certified).unwrap().seal().unwrap(), Seal::Whole);
    for path in saved_again(&certified, folder.path()) {
        let seal = ResultFile::open(&path).unwrap().seal().unwrap();
        assert_eq!(seal, Seal::Whole, "{}", path.display());
    }
}

#[test]
fn octave_reads_everything_by_load_and_by_ncread() {
    for trial in trials() {
        trial.script(Path::new("octave-cli"), "with_octave.m", &[]);
    }
}

#[test]
fn ncdump_shows_the_dimensions_and_units_of_everything() {
    for trial in trials() {
        let mut command = Command::new("ncdump");
        let said = said_by({
            command.arg("-h").arg(&trial.result);
            command
        });
        for Expected { name, dimensions, unit, .. } in trial.run.expected() {
            let kind = match name {
                "in_contact" | "event_kind" | "event_owner" => "byte",
                "event_owner_index" => "int",
                _ if name.ends_with("_clearance") => "int",
                _ => "double",
            };
            for line in [
                format!("\t{kind} {name}({}) ;", dimensions.join(", ")),
                format!("\t\t{name}:units = \"{unit}\" ;"),
            ] {
                assert!(said.lines().any(|found| found == line), "no line {line:?} in\n{said}");
            }
        }
    }
}

#[test]
fn ncdump_gives_the_values_to_the_last_bit() {
    let trial = &trials()[1];
    for expected in trial.run.expected() {
        let mut command = Command::new("ncdump");
        command.args(["-p", "9,17", "-v", expected.name]).arg(&trial.result);
        let said = said_by(command);
        // Of a dataset without rows it gives none.
        let values =
            said.split_once(&format!("\n {} =", expected.name)).map_or("", |(_, rest)| rest);
        let values = values.split(';').next().unwrap_or_default();
        assert_numbers(&expected, values);
    }
}

#[test]
fn h5dump_gives_the_values_to_the_last_bit() {
    for trial in &trials()[1..] {
        for expected in trial.run.expected() {
            let mut command = Command::new("h5dump");
            command.args(["-y", "-m", "%.17g", "-d", expected.name]).arg(&trial.result);
            let said = said_by(command);
            let (_, values) = said.split_once("DATA {").unwrap();
            let (values, _) = values.split_once('}').unwrap();
            assert_numbers(&expected, values);
        }
    }
}

/// The numbers between the commas are those expected.
fn assert_numbers(expected: &Expected, numbers: &str) {
    let found: Vec<f64> = numbers
        .split(|c: char| c == ',' || c.is_whitespace())
        .filter(|word| !word.is_empty())
        .map(|word| word.parse().unwrap())
        .collect();
    let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&found), bits(&expected.values), "{}", expected.name);
}
