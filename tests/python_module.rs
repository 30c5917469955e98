//! The Python module in `python`: its own tests, and that pip installs it from the checkout.
//!
//! Needs the packages of `scripts/requirements.txt`, as the tests in `post_processing.rs` do.

mod written;

use std::path::Path;
use std::process::Command;
use written::{python, root, said_by};

#[test]
fn the_tests_of_the_module_pass() {
    let mut command = Command::new(python());
    command.args(["-m", "unittest", "discover", "-s"]).arg(root().join("python/tests"));
    command.env("PYTHONPATH", root().join("python")).env("PYTHONDONTWRITEBYTECODE", "1");
    command.env("FREEPLAY", env!("CARGO_BIN_EXE_freeplay"));
    said_by(&mut command);
}

#[test]
fn pip_installs_the_module_without_the_network() {
    let folder = tempfile::tempdir().unwrap();
    // what is built is built in a copy: the checkout stays clean
    let copy = folder.path().join("python");
    for part in ["pyproject.toml", "README.md", "freeplay"] {
        copy_tree(&root().join("python").join(part), &copy.join(part));
    }
    let installed = folder.path().join("installed");
    let mut pip = Command::new(python());
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-index"]);
    pip.args(["--no-deps", "--no-build-isolation", "--target"]).arg(&installed).arg(&copy);
    said_by(&mut pip);
    let mut ask = Command::new(python());
    ask.args([
        "-c",
        "import freeplay, importlib.metadata as m; print(m.version('freeplay'), freeplay.__file__)",
    ]);
    ask.env("PYTHONPATH", &installed).current_dir(folder.path());
    let said = said_by(&mut ask);
    let expected = format!("{} {}", env!("CARGO_PKG_VERSION"), installed.display());
    assert!(said.starts_with(&expected), "{said}");
}

/// Copies a file, or a folder with what is in it, but for what Python leaves there.
fn copy_tree(from: &Path, to: &Path) {
    if from.is_dir() {
        for entry in std::fs::read_dir(from).unwrap() {
            let name = entry.unwrap().file_name();
            if name != "__pycache__" {
                copy_tree(&from.join(&name), &to.join(&name));
            }
        }
    } else {
        std::fs::create_dir_all(to.parent().unwrap()).unwrap();
        std::fs::copy(from, to).unwrap();
    }
}
