//! Result files through the public interface: what is written is what is read, a file is whole or
//! not there, and neither disk nor memory is trusted to be endless.

mod recorded;

use freeplay::record::{
    Attribute, DATASETS, Dimension, Error, Outcome, Overview, ResultFile, Writer,
};
use freeplay::run::Recorder;
use recorded::{Recorded, complete};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Set in a child process that a test starts: the folder it works in.
const CHILD: &str = "FREEPLAY_TEST_CHILD";

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn files_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn failed(reason: &str) -> freeplay::record::Ending {
    let outcome = Outcome::Failed { reason: reason.to_owned() };
    freeplay::record::Ending { outcome, ..complete() }
}

/// Equal to the last bit, NaN to NaN.
fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}

fn assert_holds(file: &ResultFile, run: &Recorded) {
    let expected = run.expected();
    // nothing is observed
    let datasets = DATASETS.iter().filter(|dataset| !dataset.is_optional());
    assert_eq!(expected.len(), datasets.clone().count());
    for (expected, dataset) in expected.iter().zip(datasets) {
        assert_eq!((dataset.name, dataset.unit), (expected.name, expected.unit));
        let dimensions = [dataset.rows()].into_iter().chain(dataset.items()).map(Dimension::name);
        assert_eq!(dimensions.collect::<Vec<_>>(), expected.dimensions, "{}", expected.name);
        let table = file.table(expected.name).unwrap();
        assert_eq!(table.rows, expected.shape[0], "{}", expected.name);
        assert_eq!(table.width, expected.shape.get(1).copied().unwrap_or(1), "{}", expected.name);
        assert!(same(&table.values, &expected.values), "{}", expected.name);
    }
}

#[test]
fn what_is_written_is_what_is_read() {
    let folder = folder();
    let shapes: [(&[&str], usize, usize); 5] = [
        (&["A", "B"], 9000, 5000),
        (&["A"], 4096, 0),
        (&["A"], 1, 4096),
        (&[], 20, 0),
        (&[], 0, 0),
    ];
    for (k, (clearances, samples, events)) in shapes.into_iter().enumerate() {
        let run = Recorded::new(clearances, samples, events);
        let path = run.write(&folder.path().join(format!("{k}.h5")), false);
        let file = ResultFile::open(&path).unwrap();
        assert_holds(&file, &run);
        assert_eq!(file.bodies(), run.header.bodies);
        assert_eq!(file.joints(), run.header.joints);
        assert_eq!(file.clearances(), run.header.clearances);
        assert_eq!(file.drives(), run.header.drives);
        assert_eq!(file.length(Dimension::Contact), events);
        assert_eq!(file.events().unwrap(), run.events);
        assert_eq!(file.peaks().unwrap(), run.peaks);
        // Debug, since the last contact's NaN is unequal to itself.
        assert_eq!(format!("{:?}", file.contacts().unwrap()), format!("{:?}", run.contacts));
    }
}

#[test]
fn a_column_is_found_by_its_name_and_a_wrong_name_is_told_the_nearest() {
    let folder = folder();
    let run = Recorded::new(&["A", "B"], 50, 4);
    let file = ResultFile::open(&run.write(&folder.path().join("a.h5"), false)).unwrap();
    let coupler: Vec<f64> = run.observations.iter().map(|o| o.bodies[1].angle).collect();
    assert!(same(&file.column("angle.coupler").unwrap(), &coupler));
    let b: Vec<f64> = run.observations.iter().map(|o| o.clearances[1].normal_force).collect();
    assert!(same(&file.column("normal_force.B").unwrap(), &b));
    let residual: Vec<f64> = run.observations.iter().map(|o| o.energy.residual).collect();
    assert!(same(&file.column("energy_residual").unwrap(), &residual));
    assert!(file.columns().contains(&"drive_torque.crank".to_owned()));
    assert_eq!(file.columns().len(), 1 + 3 * 9 + 2 * 9 + 4 * 3 + 1 + 7);
    let missing = file.column("angle.cupler").unwrap_err();
    assert!(
        missing
            .to_string()
            .ends_with("has no column \"angle.cupler\" (did you mean \"angle.coupler\"?)")
    );
    for wrong in ["angle", "time.crank", "angle.ground"] {
        assert!(matches!(file.column(wrong), Err(Error::Missing { .. })), "{wrong}");
    }
}

#[test]
fn the_attributes_tell_how_the_file_was_made() {
    let folder = folder();
    let mut run = Recorded::new(&["A"], 3, 1);
    run.header.case_text = "# δ\n".repeat(50_000);
    let file = ResultFile::open(&run.write(&folder.path().join("a.h5"), false)).unwrap();
    assert_eq!(file.text("Conventions"), Some("CF-1.11"));
    assert_eq!(file.text("case_toml"), Some(&*run.header.case_text));
    // python3 -c "import hashlib; print(hashlib.sha256('# δ\n'.encode() * 50000).hexdigest())"
    let sha256 = "dc42ae2cd113d7334d2a89471bbc625c2f09c40703990e2a71f85efff92e5570";
    assert_eq!(file.text("case_sha256"), Some(sha256));
    assert_eq!(file.text("title"), Some("Four-bar linkage, δ ≤ c"));
    assert_eq!(file.text("source"), Some(concat!("freeplay ", env!("CARGO_PKG_VERSION"))));
    assert_eq!(file.number("solver_relative_tolerance"), Some(1e-12));
    assert_eq!(file.attribute("solver_steps"), Some(&Attribute::Integer(123_456)));
    assert_eq!(file.attribute("ruling_tension_count"), Some(&Attribute::Integer(7)));
    assert_eq!(file.text("started_utc"), Some("2026-03-01T12:00:00Z"));
    assert_eq!(file.text("finished_utc"), Some("2026-03-01T12:00:01Z"));
    assert!(file.is_complete());
    assert_eq!(file.attributes()[0].0, "Conventions");
}

#[test]
fn an_overview_names_what_is_in_the_file() {
    let folder = folder();
    let run = Recorded::new(&["A", "B"], 50, 4);
    let file = ResultFile::open(&run.write(&folder.path().join("a.h5"), false)).unwrap();
    let overview = Overview::of(&file).unwrap();
    assert_eq!(overview.span, Some([0.0, run.observations[49].time]));
    let text = overview.to_string();
    for line in [
        "  case       four-bar: Four-bar linkage, δ ≤ c",
        "  run        complete",
        "  clearance  2: A, B",
        "  event      4",
        "    solver_relative_tolerance = 1e-12",
    ] {
        assert!(text.lines().any(|found| found == line), "no line {line:?} in\n{text}");
    }
}

#[test]
fn the_same_run_gives_the_same_bytes() {
    let folder = folder();
    let run = Recorded::new(&["A", "B"], 9000, 5000);
    let first = run.write(&folder.path().join("first.h5"), false);
    let second = run.write(&folder.path().join("second.h5"), false);
    assert!(std::fs::read(first).unwrap() == std::fs::read(second).unwrap());
}

#[test]
fn a_file_that_exists_is_refused_before_any_work_and_replaced_with_force() {
    let folder = folder();
    let run = Recorded::new(&["A"], 5, 1);
    let path = run.write(&folder.path().join("a.h5"), false);
    let refused = Writer::create(&path, run.header.clone(), false).unwrap_err();
    assert!(matches!(refused, Error::Exists { .. }), "{refused}");
    let longer = Recorded::new(&["A"], 6, 1);
    assert_eq!(longer.write(&path, true), path);
    assert_eq!(ResultFile::open(&path).unwrap().length(Dimension::Time), 6);
    assert_eq!(files_in(folder.path()), ["a.h5"]);
}

#[test]
fn a_failed_run_keeps_what_it_has_and_says_why() {
    let folder = folder();
    let run = Recorded::new(&["A"], 5000, 3);
    let path = folder.path().join("a.h5");
    let mut writer = Writer::create(&path, run.header.clone(), false).unwrap();
    run.tell(&mut writer);
    let published = writer.finish(failed("IDA gave up at t = 3.2e-2 s")).unwrap();
    assert_eq!(published, path);
    let file = ResultFile::open(&path).unwrap();
    assert_eq!(file.text("run_status"), Some("failed"));
    assert_eq!(file.text("run_failure"), Some("IDA gave up at t = 3.2e-2 s"));
    assert!(!file.is_complete());
    assert_holds(&file, &run);
}

#[test]
fn a_failed_run_never_replaces_an_old_file() {
    let folder = folder();
    let run = Recorded::new(&["A"], 5, 1);
    let path = run.write(&folder.path().join("a.h5"), false);
    let old = std::fs::read(&path).unwrap();
    let writer = Writer::create(&path, run.header.clone(), true).unwrap();
    let published = writer.finish(failed("interrupted")).unwrap();
    assert_eq!(published, folder.path().join("a.failed.h5"));
    assert!(std::fs::read(&path).unwrap() == old);
    assert_eq!(files_in(folder.path()), ["a.failed.h5", "a.h5"]);
}

#[test]
fn nothing_is_left_of_a_run_that_panics() {
    let folder = folder();
    let path = folder.path().join("a.h5");
    let run = Recorded::new(&["A"], 5000, 1);
    let unwound = std::panic::catch_unwind(|| {
        let mut writer = Writer::create(&path, run.header.clone(), false).unwrap();
        run.tell(&mut writer);
        std::panic::resume_unwind(Box::new("a bug"));
    });
    assert!(unwound.is_err());
    assert!(files_in(folder.path()).is_empty());
}

#[test]
fn an_output_that_cannot_be_made_says_so() {
    let header = Recorded::new(&[], 0, 0).header;
    for path in ["/proc/a.h5", "/no/such/folder/a.h5"] {
        let error = Writer::create(Path::new(path), header.clone(), false).unwrap_err();
        assert!(error.to_string().contains(path), "{error}");
    }
}

#[test]
fn files_of_other_kinds_are_told_apart() {
    let folder = folder();
    let put = |name: &str, bytes: &[u8]| -> PathBuf {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let open = |path: &Path| ResultFile::open(path).unwrap_err();
    let whole = Recorded::new(&["A"], 100, 1).write(&folder.path().join("a.h5"), false);
    let bytes = std::fs::read(whole).unwrap();
    let cut = put("cut.h5", &bytes[..bytes.len() / 2]);
    assert!(matches!(open(&cut), Error::Truncated { .. }), "{}", open(&cut));
    let text = put("case.toml", b"name = \"four-bar\"\n");
    assert!(matches!(open(&text), Error::NotHdf5 { .. }), "{}", open(&text));
    let empty = put("empty.h5", b"");
    assert!(matches!(open(&empty), Error::NotHdf5 { .. }), "{}", open(&empty));
    assert!(matches!(open(folder.path()), Error::NotPlain { .. }));
    assert!(matches!(open(&folder.path().join("none.h5")), Error::System { .. }));
    let other = folder.path().join("other.h5");
    hdf5::File::create(&other).unwrap().close().unwrap();
    assert!(matches!(open(&other), Error::NotAResult { .. }), "{}", open(&other));
}

#[test]
fn a_file_of_a_newer_layout_is_refused_by_its_number() {
    let folder = folder();
    let path = Recorded::new(&["A"], 10, 1).write(&folder.path().join("a.h5"), false);
    let file = hdf5::File::open_rw(&path).unwrap();
    file.attr("schema_version").unwrap().write_scalar(&2_i64).unwrap();
    file.close().unwrap();
    let error = ResultFile::open(&path).unwrap_err();
    assert!(matches!(error, Error::Newer { found: 2, .. }), "{error}");
}

#[test]
fn a_damaged_chunk_is_an_error_and_not_numbers() {
    let folder = folder();
    let path = Recorded::new(&["A"], 4096, 0).write(&folder.path().join("a.h5"), false);
    let offset = {
        let file = hdf5::File::open(&path).unwrap();
        let angle = file.dataset("angle").unwrap();
        angle.chunk_info(0).unwrap().addr as usize
    };
    let mut bytes = std::fs::read(&path).unwrap();
    bytes[offset..offset + 64].fill(0xff);
    std::fs::write(&path, bytes).unwrap();
    let error = ResultFile::open(&path).unwrap().column("angle.crank").unwrap_err();
    assert!(matches!(error, Error::Library { .. }), "{error}");
}

/// Runs one test of this file again in a process of its own, which `command` starts. Returns
/// whether it went well, and what it said.
fn run_in_child(mut command: Command, test: &str, folder: &Path) -> (bool, String) {
    let output = command
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", test, "--nocapture", "--test-threads=1"])
        .env(CHILD, folder)
        .output()
        .unwrap();
    let said = [output.stdout, output.stderr].concat();
    (output.status.success(), String::from_utf8_lossy(&said).into_owned())
}

#[test]
fn a_full_disk_is_reported_and_leaves_nothing() {
    if let Some(folder) = std::env::var_os(CHILD) {
        return write_until_full(Path::new(&folder));
    }
    let folder = folder();
    let mut command = Command::new("sh");
    // A limit on the length of files (512 bytes each) stands for a full disk.
    command.args(["-c", "trap '' XFSZ; ulimit -f 4096; exec \"$@\"", "sh"]);
    let (success, said) =
        run_in_child(command, "a_full_disk_is_reported_and_leaves_nothing", folder.path());
    assert!(success && said.contains("File too large"), "{said}");
    assert!(!said.contains("HDF5-DIAG"), "{said}");
    assert!(files_in(folder.path()).is_empty(), "{:?}", files_in(folder.path()));
}

/// In the child process: more samples than the limit holds.
fn write_until_full(folder: &Path) {
    let run = Recorded::new(&["A", "B"], 4096, 0);
    let mut writer = Writer::create(&folder.join("a.h5"), run.header.clone(), false).unwrap();
    let told = (0..20).try_for_each(|_| {
        run.observations.iter().try_for_each(|observation| writer.sample(observation))
    });
    let error = told.and_then(|()| writer.finish(complete()).map(drop)).unwrap_err();
    println!("{error}: {}", std::error::Error::source(&error).unwrap());
}

#[test]
fn a_long_run_needs_little_memory() {
    if let Some(folder) = std::env::var_os(CHILD) {
        return write_a_long_run(Path::new(&folder));
    }
    let folder = folder();
    let (success, said) =
        run_in_child(Command::new("env"), "a_long_run_needs_little_memory", folder.path());
    assert!(success, "{said}");
    let (_, rest) = said.split_once("VmHWM:").expect("the child says what it needed");
    let kilobytes: u64 = rest.split_whitespace().next().unwrap().parse().unwrap();
    assert!(kilobytes < 64 * 1024, "{kilobytes} kB");
}

/// In the child process: 1 s sampled each 1e-5 s, then the most memory the process ever had.
fn write_a_long_run(folder: &Path) {
    let run = Recorded::new(&["A", "B"], 1000, 0);
    let mut writer = Writer::create(&folder.join("a.h5"), run.header.clone(), false).unwrap();
    for observation in run.observations.iter().cycle().take(100_001) {
        writer.sample(observation).unwrap();
    }
    writer.finish(complete()).unwrap();
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    println!("{}", status.lines().find(|line| line.starts_with("VmHWM:")).unwrap());
}
