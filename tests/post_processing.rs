//! The worked examples in `scripts/post`, as they stand: each draws the clearance vector of a joint
//! and finds the largest eccentricity.
//!
//! Needs the packages of `scripts/requirements.txt` in the Python that `FREEPLAY_PYTHON` names, or
//! else in `.venv`; and `octave-cli` with its package netcdf, gnuplot, ghostscript and FreeFont.

mod written;

use std::path::{Path, PathBuf};
use std::process::Command;
use written::{Run, freeplay, python, root, said_by};

fn run() -> Run {
    Run::of("four-bar-c", &["run.duration=0.003"])
}

fn examples() -> PathBuf {
    root().join("scripts/post")
}

/// An example has found the largest eccentricity in B, to the last bit, and has drawn something.
fn check(run: &Run, said: &str, picture: &Path) {
    let largest = run.file().column("eccentricity.B").unwrap().into_iter().fold(0.0, f64::max);
    let found = said.trim().strip_prefix("B: largest eccentricity ");
    let found = found.and_then(|rest| rest.strip_suffix(" m")).map(str::parse::<f64>);
    assert_eq!(found, Some(Ok(largest)), "{said}");
    let bytes = std::fs::read(picture).unwrap();
    assert!(bytes.starts_with(b"\x89PNG") && bytes.len() > 5000, "{} bytes", bytes.len());
}

#[test]
fn the_examples_in_python_draw_the_clearance_vector() {
    let run = run();
    for script in ["with_xarray.py", "with_h5py.py", "with_pandas.py"] {
        let picture = run.beside(script).with_extension("png");
        let mut command = Command::new(python());
        command.arg(examples().join(script)).arg(&run.path).arg("B").arg(&picture);
        // a screen is not needed, nor a folder for settings
        command.env("MPLBACKEND", "Agg").env("MPLCONFIGDIR", run.folder.path());
        check(&run, &said_by(&mut command), &picture);
    }
}

/// Octave's answer to a line of code, with the examples on its path.
fn octave(code: &str) -> String {
    let mut command = Command::new("octave-cli");
    said_by(command.args(["--no-init-file", "--path"]).arg(examples()).args(["--eval", code]))
}

#[test]
fn the_example_in_octave_draws_the_clearance_vector() {
    let run = run();
    let picture = run.beside("octave.png");
    let (path, drawn) = (run.path.display(), picture.display());
    let said = octave(&format!("clearance_vector ('{path}', 'B', '{drawn}')"));
    check(&run, &said, &picture);
}

#[test]
fn load_run_puts_samples_in_rows_and_names_the_columns() {
    let run = run();
    let file = run.file();
    let code = format!(
        "run = load_run ('{}');
         printf ('%d ', size (run.position_x), size (run.time), size (run.normal_force));
         printf ('%s ', run.names.body{{:}}, run.names.clearance{{:}}, run.names.drive{{:}});
         printf ('%.17g ', run.position_x(end, :), run.contact_begin(2));",
        run.path.display()
    );
    let said = octave(&code);
    let last = |column: &str| *file.column(column).unwrap().last().unwrap();
    let numbers = [
        last("position_x.crank"),
        last("position_x.coupler"),
        last("position_x.follower"),
        file.contacts().unwrap()[1].begin,
    ];
    let words: Vec<&str> = said.split_whitespace().collect();
    let names = ["crank", "coupler", "follower", "A", "B", "B0", "crank"];
    assert_eq!(words[..6], ["301", "3", "301", "1", "301", "3"], "{said}");
    assert_eq!(words[6..13], names, "{said}");
    let found: Vec<f64> = words[13..].iter().map(|word| word.parse().unwrap()).collect();
    assert_eq!(found, numbers);
}

#[test]
fn load_run_opens_runs_without_clearance_and_without_drive() {
    for (case, size) in [("four-bar-ideal", "101 0 1"), ("pendulum", "11 0 0")] {
        let set = if case == "pendulum" { "run.duration=0.01" } else { "run.duration=0.001" };
        let run = Run::of(case, &[set]);
        let said = octave(&format!(
            "run = load_run ('{}'); printf ('%d ', rows (run.time), numel (run.names.clearance), \
             numel (run.names.drive))",
            run.path.display()
        ));
        assert_eq!(said.trim(), size, "{case}");
    }
}

#[test]
fn pandas_reads_the_exports_and_finds_the_units() {
    let run = run();
    let mut exported = Vec::new();
    for format in ["csv", "parquet"] {
        let path = run.beside("run").with_extension(format);
        let (from, to) = (run.path.to_str().unwrap(), path.to_str().unwrap());
        assert!(freeplay(&["export", from, "--to", format, "-o", to]).status.success());
        exported.push(path);
    }
    let code = "\
import sys, h5py, pandas
csv, parquet = pandas.read_csv(sys.argv[1]), pandas.read_parquet(sys.argv[2])
assert csv.shape == parquet.shape == (301, 75), csv.shape
assert (csv.to_numpy() == parquet.to_numpy()).all()
with h5py.File(sys.argv[3]) as run:
    assert (parquet['time'] == run['time'][:]).all()
    assert (parquet['angle.follower'] == run['angle'][:, 2]).all()
    assert (parquet['in_contact.B'] == run['in_contact'][:, 1]).all()
assert parquet.attrs['units']['drive_torque.crank'] == 'N m'
";
    let mut command = Command::new(python());
    said_by(command.args(["-c", code]).args(&exported).arg(&run.path));
}
