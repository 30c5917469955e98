//! Cases run into result files, and the program run on them.

#![allow(dead_code, reason = "each file of tests uses its own part")]

use freeplay::case::{Case, Changes};
use freeplay::record::{Ending, Outcome, ResultFile, Writer};
use freeplay::simulate::{self, Simulation};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Held while this process writes a result file or starts another process: the child would
/// inherit the open file, and with it the lock that keeps readers away.
static ALONE: Mutex<()> = Mutex::new(());

/// Keeps other tests of this process from starting processes and from writing files.
pub fn alone() -> MutexGuard<'static, ()> {
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A case as run, in a folder that goes with this.
pub struct Run {
    pub folder: tempfile::TempDir,
    pub path: PathBuf,
}

impl Run {
    /// Runs a case file of the project, with keys set as `--set` does.
    pub fn of(case: &str, set: &[&str]) -> Run {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.h5");
        let case = root().join("cases").join(format!("{case}.toml"));
        let set = set.iter().map(|change| change.parse().unwrap()).collect();
        let case = Case::read(&case, &Changes { set, ideal: false }).unwrap();
        let simulation = Simulation::new(&case).unwrap();
        let header = simulate::header(&case, simulation.mechanism(), String::new());
        let _alone = alone();
        let mut writer = Writer::create(&path, header, false).unwrap();
        let (statistics, ran) = simulation.run(&mut writer, &mut |_| ControlFlow::Continue(()));
        ran.unwrap();
        let (counts, rulings) = (statistics.engine, statistics.rulings);
        let (outcome, finished_utc) = (Outcome::Complete, String::new());
        let (series, attributes) = (Vec::new(), Vec::new());
        let ending = Ending { outcome, counts, rulings, finished_utc, series, attributes };
        writer.finish(ending).unwrap();
        Run { folder, path }
    }

    /// The result file.
    pub fn file(&self) -> ResultFile {
        ResultFile::open(&self.path).unwrap()
    }

    /// A path in the folder.
    pub fn beside(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
}

/// The folder of the project.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// What a command says, started while nothing is being written.
pub fn output(command: &mut Command) -> Output {
    let _alone = alone();
    command
        .output()
        .unwrap_or_else(|error| panic!("cannot start {:?}: {error}", command.get_program()))
}

/// The program with these arguments.
pub fn freeplay<S: AsRef<std::ffi::OsStr>>(arguments: &[S]) -> Output {
    output(Command::new(env!("CARGO_BIN_EXE_freeplay")).args(arguments))
}

/// The Python that has the packages of `scripts/requirements.txt`.
pub fn python() -> PathBuf {
    let named = std::env::var_os("FREEPLAY_PYTHON").map(PathBuf::from);
    let python = named.unwrap_or_else(|| root().join(".venv/bin/python"));
    assert!(
        python.is_file(),
        "there is no {}: make a virtual environment .venv with the packages of \
         scripts/requirements.txt, or name a Python that has them in FREEPLAY_PYTHON",
        python.display()
    );
    python
}

/// Standard output of a command, which must end well.
pub fn said_by(command: &mut Command) -> String {
    let done = output(command);
    let errors = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{command:?} failed: {errors}");
    String::from_utf8(done.stdout).unwrap()
}
