//! Runs the program in a folder of its own, and makes the files that it is given.

#![allow(dead_code, reason = "each file of tests uses its own part")]

use hdf5::File;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder for one test.
pub struct Trial {
    folder: tempfile::TempDir,
}

/// What the program said and how it ended.
pub struct Outcome {
    pub code: i32,
    pub out: String,
    pub err: String,
}

/// A file under `tests/data`.
pub fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

/// A number in JSON.
pub fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

impl Trial {
    pub fn new() -> Self {
        Trial { folder: tempfile::tempdir().unwrap() }
    }

    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        self.write_bytes(name, text.as_bytes())
    }

    pub fn write_bytes(&self, name: &str, bytes: &[u8]) -> PathBuf {
        std::fs::write(self.path(name), bytes).unwrap();
        self.path(name)
    }

    /// Runs a shipped case with changes; it must end well.
    pub fn run(&self, case: &str, name: &str, set: &[&str]) -> PathBuf {
        let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases");
        let mut command = program();
        command.arg("run").arg(cases.join(format!("{case}.toml"))).args(["--quiet", "--force"]);
        command.arg("-o").arg(self.path(name));
        for set in set {
            command.args(["--set", set]);
        }
        let outcome = outcome(command);
        assert_eq!(outcome.code, 0, "{}", outcome.err);
        self.path(name)
    }

    pub fn compare(&self, theirs: &Path, reference: &Path, arguments: &[&str]) -> Outcome {
        let mut command = program();
        command.arg("compare").arg(theirs).arg(reference).args(arguments);
        outcome(command)
    }

    /// Runs a shipped case with changes, and has the other engine check it.
    pub fn checked(&self, case: &str, set: &[&str]) -> Outcome {
        let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases");
        let mut command = program();
        command.arg("run").arg(cases.join(format!("{case}.toml"))).args(["--quiet", "--check"]);
        command.arg("-o").arg(self.path("checked.h5"));
        for set in set {
            command.args(["--set", set]);
        }
        outcome(command)
    }

    /// Runs `freeplay certify` on a shipped case.
    pub fn certify(&self, case: &str, arguments: &[&str]) -> Outcome {
        let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases");
        let mut command = program();
        command.arg("certify").arg(cases.join(format!("{case}.toml"))).arg("--quiet");
        command.args(arguments).current_dir(self.folder());
        outcome(command)
    }

    /// The JSON of a comparison, which need not meet what it requires.
    pub fn json(&self, theirs: &Path, reference: &Path, more: &[&str]) -> serde_json::Value {
        let outcome = self.compare(theirs, reference, &[&["--json"], more].concat());
        assert!(outcome.code <= 1, "{}", outcome.err);
        serde_json::from_str(&outcome.out).unwrap()
    }
}

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_freeplay"))
}

fn outcome(mut command: Command) -> Outcome {
    let output = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    Outcome {
        code: output.status.code().unwrap_or(-1),
        out: text(&output.stdout),
        err: text(&output.stderr),
    }
}

/// Changes the values of a dataset, row by row.
pub fn change(path: &Path, name: &str, change: impl FnOnce(&mut [f64])) {
    let file = File::open_rw(path).unwrap();
    let dataset = file.dataset(name).unwrap();
    let mut values = dataset.read_dyn::<f64>().unwrap();
    change(values.as_slice_mut().unwrap());
    dataset.write(&values).unwrap();
}

/// Adds a dataset with one dimension.
pub fn add(path: &Path, name: &str, values: &[f64]) {
    let file = File::open_rw(path).unwrap();
    file.new_dataset_builder().with_data(values).create(name).unwrap();
}

/// Adds an attribute to the root.
pub fn add_attribute(path: &Path, name: &str, value: f64) {
    let file = File::open_rw(path).unwrap();
    file.new_attr::<f64>().create(name).unwrap().write_scalar(&value).unwrap();
}

/// Takes an attribute from the root.
pub fn remove_attribute(path: &Path, name: &str) {
    File::open_rw(path).unwrap().delete_attr(name).unwrap();
}

/// Writes a vector `t` and a matrix `y` as MATLAB's `save -v7.3` does: behind a block of 512 bytes
/// that names it, column by column.
pub fn write_matlab(path: &Path, times: &[f64], columns: &[Vec<f64>; 3]) {
    let file = File::with_options().with_fcpl(|creation| creation.userblock(512)).create(path);
    let file = file.unwrap();
    let times = ndarray::Array2::from_shape_vec((1, times.len()), times.to_vec()).unwrap();
    let shape = (columns.len(), times.len());
    let columns = ndarray::Array2::from_shape_vec(shape, columns.concat()).unwrap();
    file.new_dataset_builder().with_data(&times).create("t").unwrap();
    file.new_dataset_builder().with_data(&columns).create("y").unwrap();
    file.close().unwrap();
    let mut bytes = std::fs::read(path).unwrap();
    let head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .";
    bytes[..head.len()].copy_from_slice(head);
    std::fs::write(path, bytes).unwrap();
}
