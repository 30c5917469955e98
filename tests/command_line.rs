//! The program as it is used. Known in advance: the exit codes (0 done, 2 command line or case
//! file, 3 output, 4 the simulation failed, 130 and 143 interrupted), that nothing but a complete
//! run replaces a file, and that what a run has is kept.

use freeplay::record::{Dimension, ResultFile};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const FOUR_BAR_A: &str = include_str!("../cases/four-bar-a.toml");

/// How the program ended and what it said.
#[derive(Debug)]
struct Said {
    code: i32,
    out: String,
    errors: String,
    took: Duration,
}

impl Said {
    fn assert_code(&self, code: i32) -> &Said {
        assert_eq!(self.code, code, "{self:#?}");
        assert!(!self.errors.contains("panicked"), "{self:#?}");
        self
    }
}

/// A folder that the program is started in.
struct Desk {
    folder: TempDir,
}

impl Desk {
    fn new() -> Desk {
        Desk { folder: tempfile::tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file; gives its name back.
    fn file<'a>(&self, name: &'a str, content: impl AsRef<[u8]>) -> &'a str {
        std::fs::write(self.path(name), content).unwrap();
        name
    }

    fn command<A: AsRef<OsStr>>(&self, arguments: &[A]) -> Command {
        // tests that run in the background of a script would inherit that signals are ignored
        let mut command = Command::new("env");
        command.args(["--default-signal", env!("CARGO_BIN_EXE_freeplay")]);
        command.args(arguments).current_dir(&self.folder).stdin(Stdio::null());
        command
    }

    fn run<A: AsRef<OsStr>>(&self, arguments: &[A]) -> Said {
        let begun = Instant::now();
        let output = self.command(arguments).output().unwrap();
        let took = begun.elapsed();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        let code = output.status.code().expect("the program ends by itself");
        Said { code, out: text(output.stdout), errors: text(output.stderr), took }
    }

    /// Names of the files there, hidden ones too.
    fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn open(&self, name: &str) -> ResultFile {
        ResultFile::open(&self.path(name)).unwrap()
    }
}

/// A case file of the project.
fn case(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases").join(format!("{name}.toml"));
    path.into_os_string().into_string().unwrap()
}

/// `--set` for a run of case a that takes no time.
const SHORT: [&str; 4] = ["--set", "run.duration=1e-3", "--set", "run.sample_interval=1e-4"];

#[test]
fn every_command_explains_itself() {
    let desk = Desk::new();
    let help = desk.run(&["--help"]);
    help.assert_code(0);
    let commands = help.out.lines().skip_while(|line| *line != "Commands:").skip(1);
    let commands: Vec<&str> = commands
        .map_while(|line| line.strip_prefix("  "))
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    assert!(["run", "check", "info"].iter().all(|known| commands.contains(known)), "{commands:?}");
    for command in commands.into_iter().filter(|command| *command != "help") {
        let help = desk.run(&[command, "--help"]);
        help.assert_code(0);
        assert!(help.out.contains(&format!("Usage: freeplay {command}")), "{}", help.out);
        assert!(help.errors.is_empty());
        let lines: Vec<&str> = help.out.lines().collect();
        let is_option = |line: &str| {
            let line = line.trim_start();
            // "- csv: …" is a value that an option can have
            line.starts_with('-') && !line.starts_with("- ")
        };
        for option in lines.windows(2).filter(|pair| is_option(pair[0])) {
            // beside the option, or on the next line
            let beside = option[0].trim_start().split("  ").count() > 1;
            let below = option[1].starts_with("        ");
            assert!(beside || below, "{command} leaves {:?} unexplained", option[0]);
        }
    }
}

#[test]
fn the_version_tells_the_commit_and_the_libraries() {
    let desk = Desk::new();
    let lines = |argument: &str| -> Vec<String> {
        desk.run(&[argument]).assert_code(0).out.lines().map(str::to_owned).collect()
    };
    let [first, sundials, hdf5] = &lines("--version")[..] else { panic!("three lines") };
    let commit = first.strip_prefix(concat!("freeplay ", env!("CARGO_PKG_VERSION"), " (commit "));
    let commit = commit.and_then(|rest| rest.strip_suffix(')')).expect("a commit in brackets");
    let commit = commit.trim_end_matches(" and changes");
    let is_hash = commit.len() == 12 && commit.bytes().all(|c| c.is_ascii_hexdigit());
    assert!(is_hash || commit == "unknown: built without git", "{first}");
    assert!(sundials.starts_with("SUNDIALS 6.4."), "{sundials}");
    assert!(hdf5.starts_with("HDF5 1."), "{hdf5}");
    assert_eq!(lines("-V"), std::slice::from_ref(first));
}

#[test]
fn wrong_command_lines_end_with_2_and_words_on_stderr() {
    let desk = Desk::new();
    let a = case("four-bar-a");
    let wrong: [&[&str]; 11] = [
        &[],
        &["simulate"],
        &["run"],
        &["check"],
        &["info"],
        &["run", &a, &a],
        &["run", &a, "--fast"],
        &["run", &a, "-o"],
        &["run", &a, "--set"],
        &["run", &a, "--set", "run.duration"],
        &["run", &a, "--set", "=3"],
    ];
    for arguments in wrong {
        let said = desk.run(arguments);
        said.assert_code(2);
        assert!(said.out.is_empty() && !said.errors.is_empty(), "{arguments:?}: {said:#?}");
    }
    assert!(desk.files().is_empty());
}

/// Case files that are refused: their text, and what the message must say beside the file's name.
fn bad_cases() -> Vec<(String, Vec<String>)> {
    let line_of = |part: &str| {
        let lines = FOUR_BAR_A.lines().take_while(|line| !line.contains(part));
        format!("line {}, ", lines.count() + 1)
    };
    let changed = |old: &str, new: &str, key: &str| {
        assert!(FOUR_BAR_A.contains(old), "{old}");
        let said = vec![format!("{}{key}", line_of(old.trim_start_matches('\n')))];
        (FOUR_BAR_A.replacen(old, new, 1), said)
    };
    let say = |(text, mut said): (String, Vec<String>), more: &str| {
        said.push(more.to_owned());
        (text, said)
    };
    let plain = |text: &str, said: &str| (text.to_owned(), vec![said.to_owned()]);
    vec![
        say(
            changed("mass    = 0.0737", "masss = 0.0737", "bodies.coupler.masss"),
            "did you mean \"mass\"?",
        ),
        changed("mass    = 0.0737", "mass = \"light\"", "bodies.coupler.mass"),
        changed("mass    = 0.0737", "mass = 0", "bodies.coupler.mass"),
        changed("inertia = 6.19e-5", "inertia = -1e-5", "bodies.follower.inertia"),
        changed(
            "bearing_radius = 0.010",
            "bearing_radius = 0",
            "joints.A.clearance.bearing_radius",
        ),
        changed("radial         = 0.001", "radial = -0.001", "joints.A.clearance.radial"),
        changed("radial         = 0.001", "radial = 0.010", "joints.A.clearance.radial"),
        changed(
            "relative_tolerance = 1e-12",
            "relative_tolerance = 0",
            "solver.relative_tolerance",
        ),
        changed(
            "absolute_tolerance = 1e-20",
            "absolute_tolerance = -1",
            "solver.absolute_tolerance",
        ),
        changed("speed_rpm = 5000.0", "speed_rpm = nan", "drives.crank.speed_rpm"),
        changed("duration        = 0.060", "duration = inf", "run.duration"),
        say(
            changed(
                "between = [\"coupler.B\", \"follower.B\"]",
                "between = [\"coupler.B\", \"folower.B\"]",
                "joints.B.between",
            ),
            "did you mean \"follower\"?",
        ),
        changed(
            "between = [\"coupler.B\", \"follower.B\"]",
            "between = [\"coupler.C\", \"follower.B\"]",
            "joints.B.between",
        ),
        changed("joint     = \"A0\"", "joint = \"A9\"", "drives.crank.joint"),
        say(changed("[joints.B0]", "[joints.\"B 0\"]", "joints.\"B 0\""), "letters, digits"),
        changed("sample_interval = 1e-5", "sample_interval = 1e-14", "run.sample_interval"),
        // the same name twice is no TOML
        plain(&format!("{FOUR_BAR_A}\n[joints.A]\nkind = \"revolute\"\n"), "duplicate key"),
        // joints that do not close, and by how much
        say(
            changed(
                "points  = { A = [-0.09, 0.0], B = [0.09, 0.0] }",
                "points = { A = [-0.02, 0.0], B = [0.02, 0.0] }",
                "",
            ),
            "does not close: ",
        ),
        // a second joint between bodies that cannot move otherwise anyway
        plain(
            &FOUR_BAR_A.replacen(
                "[drives.crank]",
                "[joints.again]\nkind = \"revolute\"\nbetween = [\"ground.A0\", \"crank.A0\"]\n\
                 [drives.crank]",
                1,
            ),
            "joints.again",
        ),
        plain("", "bodies: there must be at least one body"),
        plain("just words", "is not TOML"),
        plain("\u{0}\u{1}\u{2}", "is not TOML"),
    ]
}

#[test]
fn bad_cases_end_with_2_within_a_second_and_name_file_line_and_key() {
    let desk = Desk::new();
    for (text, said_of_it) in bad_cases() {
        desk.file("bad.toml", text);
        for command in ["run", "check"] {
            let said = desk.run(&[command, "bad.toml"]);
            said.assert_code(2);
            // the file's line is not where a joint's neighbours do not close
            let closing = said_of_it.iter().any(|part| part.contains("does not close"));
            let parts = said_of_it.iter().filter(|part| !(closing && part.starts_with("line")));
            for part in parts.map(String::as_str).chain(["error: bad.toml "]) {
                assert!(said.errors.contains(part), "no {part:?} in {}", said.errors);
            }
            assert!(said.out.is_empty(), "{said:#?}");
            assert!(said.took < Duration::from_secs(1), "{said:#?}");
        }
    }
    assert_eq!(desk.files(), ["bad.toml"]);
}

#[test]
fn all_complaints_come_at_once() {
    let desk = Desk::new();
    let text = FOUR_BAR_A
        .replacen("mass    = 0.0737", "mass = 0", 1)
        .replacen("inertia = 6.19e-5", "inertia = \"small\"", 1)
        .replacen("[solver]", "[solver]\ncolour = \"red\"", 1);
    let said = desk.run(&["run", desk.file("bad.toml", text)]);
    said.assert_code(2);
    for key in ["bodies.coupler.mass: ", "bodies.follower.inertia: ", "solver.colour: "] {
        assert!(said.errors.contains(key), "{}", said.errors);
    }
}

#[test]
fn files_that_are_no_cases_and_no_results_end_with_2() {
    let desk = Desk::new();
    desk.file("binary.toml", [0xff, 0xfe, 0x00, 0x80]);
    desk.file("huge.toml", vec![b'#'; 8 << 20]);
    desk.file("empty.h5", "");
    desk.file("words.h5", "just words, and enough of them to look like something else");
    std::fs::create_dir(desk.path("folder")).unwrap();
    let wrong = [
        ["run", "binary.toml"],
        ["run", "huge.toml"],
        ["run", "folder"],
        ["check", "folder"],
        ["run", "nowhere.toml"],
        ["info", "nowhere.h5"],
        ["info", "folder"],
        ["info", "empty.h5"],
        ["info", "words.h5"],
    ];
    for arguments in wrong {
        let said = desk.run(&arguments);
        said.assert_code(2);
        assert!(said.errors.contains(arguments[1]), "{arguments:?}: {said:#?}");
        assert!(said.took < Duration::from_secs(1), "{said:#?}");
    }
}

#[test]
fn a_run_says_in_one_line_what_it_wrote_and_then_how_far_it_is_true() {
    let desk = Desk::new();
    let said = desk.run(&[&["run", &case("four-bar-a")], &SHORT[..]].concat());
    said.assert_code(0);
    assert!(said.out.starts_with("four-bar-a.h5: four-bar-a, 11 samples, 2 contacts, "));
    let rest: Vec<&str> = said.out.lines().skip(1).collect();
    assert!(rest[0].starts_with("  true  "), "{rest:?}");
    assert!(rest.iter().all(|line| line.starts_with("  ")), "{rest:?}");
    assert!(said.errors.is_empty(), "no progress where there is no terminal: {}", said.errors);
    assert_eq!(desk.files(), ["four-bar-a.h5"]);
    let file = desk.open("four-bar-a.h5");
    assert_eq!(file.text("run_status"), Some("complete"));
    assert_eq!(file.length(Dimension::Time), 11);

    let info = desk.run(&["info", "four-bar-a.h5"]);
    info.assert_code(0);
    for part in ["four-bar-a", "complete", "11 samples", "relative_tolerance"] {
        assert!(info.out.contains(part), "no {part} in {}", info.out);
    }
    let check = desk.run(&["check", &case("four-bar-a")]);
    check.assert_code(0);
    for part in
        ["crank: prescribed", "2: 6 coordinates, 4 constraints", "1.043715537e10", "0.913177"]
    {
        assert!(check.out.contains(part), "no {part} in {}", check.out);
    }
    assert_eq!(desk.files(), ["four-bar-a.h5"], "info and check write nothing");
}

#[test]
fn quiet_says_nothing_on_stderr_and_a_reader_that_has_gone_is_no_error() {
    let desk = Desk::new();
    let a = case("four-bar-a");
    let said = desk.run(&[&["run", &a, "--quiet"], &SHORT[..]].concat());
    assert!(said.assert_code(0).errors.is_empty());
    for arguments in [["info", "four-bar-a.h5"], ["check", &a]] {
        let mut command = desk.command(&arguments);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let ended = child.wait_with_output().unwrap();
        assert!(ended.status.success() && ended.stderr.is_empty(), "{ended:?}");
    }
}

#[test]
fn a_result_that_cannot_be_printed_ends_with_3() {
    let desk = Desk::new();
    let case = case("pendulum");
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let said = desk.command(&["check", &case]).stdout(full).output().unwrap();
    assert_eq!(said.status.code(), Some(3), "{said:?}");
    let errors = String::from_utf8(said.stderr).unwrap();
    assert!(errors.contains("cannot write the result to standard output"), "{errors}");
}

#[test]
fn an_error_that_nobody_hears_keeps_its_exit_code() {
    let desk = Desk::new();
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let status = desk.command(&["info", "missing.h5"]).stderr(writer).status().unwrap();
    assert_eq!(status.code(), Some(2));
}

#[test]
fn pages_and_figures_replace_plain_files_only() {
    let desk = Desk::new();
    desk.run(&["run", &case("pendulum"), "--set", "run.duration=0.01", "--quiet"]).assert_code(0);
    let device = desk.path("device");
    let _socket = std::os::unix::net::UnixListener::bind(&device).unwrap();
    std::fs::create_dir(desk.path("figures")).unwrap();
    for link in ["figures/energy.svg", "page.html"] {
        std::os::unix::fs::symlink(&device, desk.path(link)).unwrap();
    }
    let plot = ["plot", "pendulum.h5", "-o", "figures", "--force"];
    let report = |page| ["report", "pendulum.h5", "-o", page, "--force"];
    for command in [&plot, &report("page.html"), &report("device"), &report("figures")] {
        let said = desk.run(command);
        assert!(said.assert_code(3).errors.contains("is not a plain file"), "{said:?}");
    }
    assert!(!std::fs::metadata(&device).unwrap().is_file());
    let left = std::fs::read_dir(desk.path("figures")).unwrap().count();
    assert_eq!(left, 1, "nothing is written beside what is refused");
}

#[test]
fn an_output_that_exists_stays_unless_forced() {
    let desk = Desk::new();
    let a = case("four-bar-a");
    desk.file("kept.h5", "mine");
    let run = |more: &[&str]| desk.run(&[&["run", &a, "-o", "kept.h5"], &SHORT[..], more].concat());
    let said = run(&[]);
    said.assert_code(3);
    assert!(said.errors.contains("kept.h5") && said.errors.contains("--force"), "{said:#?}");
    assert_eq!(std::fs::read(desk.path("kept.h5")).unwrap(), b"mine");
    run(&["--force"]).assert_code(0);
    assert_eq!(desk.open("kept.h5").length(Dimension::Time), 11);
    assert_eq!(desk.files(), ["kept.h5"]);
}

#[test]
fn outputs_that_cannot_be_made_end_with_3_before_any_work() {
    let desk = Desk::new();
    desk.file("plain", "a file where a folder should be");
    std::fs::create_dir(desk.path("folder.h5")).unwrap();
    let long = ["--set", "run.duration=1000", "--set", "run.sample_interval=1e-2"];
    for output in ["nowhere/r.h5", "plain/r.h5", "folder.h5", "/proc/r.h5", "/dev/full"] {
        let said =
            desk.run(&[&["run", &case("four-bar-a"), "-o", output, "--force"], &long[..]].concat());
        said.assert_code(3);
        assert!(said.errors.contains(output), "{said:#?}");
        assert!(said.took < Duration::from_secs(1), "{said:#?}");
    }
    assert_eq!(desk.files(), ["folder.h5", "plain"]);
}

#[test]
fn set_changes_a_key_and_the_file_says_so() {
    let desk = Desk::new();
    let a = case("four-bar-a");
    let thin = ["--set", "joints.A.clearance.radial=0.00015", "--set", "solver.norm=wrms"];
    desk.run(&[&["run", &a], &SHORT[..], &thin].concat()).assert_code(0);
    let file = desk.open("four-bar-a.h5");
    let text = file.text("case_toml").unwrap();
    assert!(text.contains("0.00015") && text.contains("# The paper's four-bar"), "{text}");
    assert_eq!(file.text("norm"), Some("wrms"));
    let penetration = file.table("penetration").unwrap();
    assert!((penetration.values[0] + 0.00015).abs() < 1e-16, "{}", penetration.values[0]);

    for (change, part) in [
        ("joints.A.clearance.radail=1", "did you mean \"radial\"?"),
        ("bodies.crank.mass=heavy", "bodies.crank.mass"),
        ("bodies.crank.mass.more=1", "bodies.crank.mass"),
    ] {
        let said = desk.run(&["run", &a, "--set", change]);
        said.assert_code(2);
        assert!(said.errors.contains(part) && said.errors.contains("--set"), "{said:#?}");
    }
}

#[test]
fn ideal_removes_every_clearance() {
    let desk = Desk::new();
    let run = |name: &str, more: &[&str]| {
        let output = format!("{name}.h5");
        desk.run(&[&["run", &case(name), "-o", &output], &SHORT[..], more].concat()).assert_code(0);
        desk.open(&output)
    };
    let (ideal, stripped) = (run("four-bar-ideal", &[]), run("four-bar-c", &["--ideal"]));
    assert_eq!(stripped.length(Dimension::Clearance), 0);
    for dataset in ["angle", "joint_force_x", "drive_torque"] {
        assert_eq!(
            ideal.table(dataset).unwrap().values,
            stripped.table(dataset).unwrap().values,
            "{dataset}"
        );
    }
}

#[test]
fn the_same_case_gives_the_same_bytes() {
    let desk = Desk::new();
    let bytes = |output: &str| {
        let set = ["--set", "run.duration=0.005"];
        desk.run(&[&["run", &case("four-bar-b"), "-o", output], &set[..]].concat()).assert_code(0);
        let mut bytes = std::fs::read(desk.path(output)).unwrap();
        let file = desk.open(output);
        let times = ["started_utc", "finished_utc"].map(|name| file.text(name).unwrap().as_bytes());
        let is_time = |k: &usize| times.iter().any(|time| bytes[*k..].starts_with(time));
        let places: Vec<usize> = (0..bytes.len()).filter(is_time).collect();
        assert_eq!(places.len(), 2, "{times:?}");
        places.into_iter().for_each(|k| bytes[k..k + times[0].len()].fill(b'-'));
        bytes
    };
    let first = bytes("first.h5");
    // the times differ in their seconds
    std::thread::sleep(Duration::from_millis(1100));
    let second = bytes("second.h5");
    assert_eq!(first.len(), second.len());
    // two blocks hold the times, and each ends in a checksum of four bytes
    let differing = first.iter().zip(&second).filter(|(a, b)| a != b).count();
    assert!(differing <= 8, "{differing} bytes differ");
}

/// A four-bar whose coupler is too short for half of the crank's turn.
fn locking() -> String {
    FOUR_BAR_A
        .replacen(
            "points  = { A = [-0.09, 0.0], B = [0.09, 0.0] }",
            "points = { A = [-0.05, 0.0], B = [0.05, 0.0] }",
            1,
        )
        .replacen("coupler  = { angle = 0.7 }", "coupler = { angle = 0.77 }", 1)
        .replacen("follower = { angle = 1.84 }", "follower = { angle = 2.5 }", 1)
}

/// The same, and beside it a pendulum, so that there is something to integrate.
fn locking_with_a_pendulum() -> String {
    locking()
        .replacen(
            "[joints.A0]",
            "[bodies.bob]\nmass = 1\ninertia = 0.1\npoints = { P = [0.1, 0.1] }\n\
             [joints.P]\nkind = \"revolute\"\nbetween = [\"ground.A0\", \"bob.P\"]\n[joints.A0]",
            1,
        )
        .replacen("[start]", "[start]\nbob = { angular_velocity = 3.0 }", 1)
}

#[test]
fn a_run_that_fails_ends_with_4_and_keeps_what_it_has() {
    for text in [locking(), locking_with_a_pendulum()] {
        let desk = Desk::new();
        let said = desk.run(&["run", desk.file("locks.toml", text), "--ideal"]);
        said.assert_code(4);
        let kept = "what was simulated until then is in four-bar-a.h5";
        for part in ["case \"four-bar-a\" stopped", "caused by: ", "t = ", kept] {
            assert!(said.errors.contains(part), "no {part:?} in {}", said.errors);
        }
        assert!(said.out.is_empty());
        let file = desk.open("four-bar-a.h5");
        assert_eq!(file.text("run_status"), Some("failed"));
        let times = file.times().unwrap();
        assert!(times.len() > 100 && times.len() < 600, "{} samples", times.len());
        let last = *times.last().unwrap();
        let angles = file.table("angle").unwrap();
        assert!(last < 0.006 && angles.values.iter().all(|angle| angle.is_finite()), "{last}");
        let info = desk.run(&["info", "four-bar-a.h5"]);
        assert!(info.assert_code(0).out.contains("failed"), "{}", info.out);
    }
}

#[test]
fn a_failed_run_leaves_an_old_file_alone() {
    let desk = Desk::new();
    desk.file("locks.toml", locking());
    desk.file("old.h5", "old");
    let said = desk.run(&["run", "locks.toml", "--ideal", "--force", "-o", "old.h5"]);
    said.assert_code(4);
    assert_eq!(std::fs::read(desk.path("old.h5")).unwrap(), b"old");
    assert_eq!(desk.open("old.failed.h5").text("run_status"), Some("failed"));
    assert!(said.errors.contains("old.failed.h5"));
}

/// Starts a run that would take very long, and waits until it has written something.
fn long_run(desk: &Desk, case_name: &str, more: &[&str]) -> Child {
    let long = ["--set", "run.duration=900", "--set", "run.sample_interval=1e-5"];
    let case = case(case_name);
    let arguments = [&["run", &case, "-o", "long.h5"], &long[..], more].concat();
    let mut command = desk.command(&arguments);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let begun = Instant::now();
    let written = || {
        let partial = desk.files().into_iter().find(|name| name.contains("partial"));
        partial.is_some_and(|name| {
            std::fs::metadata(desk.path(&name)).is_ok_and(|found| found.len() > 300_000)
        })
    };
    while !written() {
        assert!(begun.elapsed() < Duration::from_secs(60), "{:?}", desk.files());
        std::thread::sleep(Duration::from_millis(10));
    }
    child
}

fn signal(child: &Child, signal: Signal) {
    kill(Pid::from_raw(i32::try_from(child.id()).unwrap()), signal).unwrap();
}

#[test]
fn an_interrupted_run_keeps_what_it_has_and_says_which_signal_came() {
    let runs = [
        (Signal::SIGINT, 130, "four-bar-a"),
        (Signal::SIGTERM, 143, "four-bar-a"),
        (Signal::SIGINT, 130, "four-bar-ideal"),
    ];
    for (sent, code, case_name) in runs {
        let desk = Desk::new();
        let child = long_run(&desk, case_name, &[]);
        signal(&child, sent);
        let ended = child.wait_with_output().unwrap();
        assert_eq!(ended.status.code(), Some(code), "{ended:?}");
        let errors = String::from_utf8(ended.stderr).unwrap();
        assert!(errors.contains("interrupted at t = ") && errors.contains("long.h5"), "{errors}");
        assert_eq!(desk.files(), ["long.h5"]);
        let file = desk.open("long.h5");
        assert_eq!(file.text("run_status"), Some("failed"));
        let times = file.times().unwrap();
        assert!(times.len() > 1000 && times.is_sorted(), "{} samples", times.len());
        assert_eq!(file.table("angle").unwrap().rows, times.len());
        if case_name == "four-bar-a" {
            let contacts = file.contacts().unwrap();
            assert!(contacts.len() > 10);
            // what is still open is told too, and only the last can be
            assert!(contacts[..contacts.len() - 1].iter().all(|contact| !contact.end.is_nan()));
        }
    }
}

/// A signal that comes while the errors of a run are followed, when the run is done. In 71 digits
/// they take more than twice as long as the run; how long that is depends on what else goes on.
#[test]
fn a_run_that_is_done_is_complete_whatever_interrupts_those_who_follow_its_errors() {
    let desk = Desk::new();
    let case = case("four-bar-c");
    let run = ["run", &case, "--force", "--quiet"];
    let slow = ["--set", "solver.engine=explicit", "--set", "solver.precision=71"];
    let short = ["--set", "run.duration=0.002", "--set", "run.sample_interval=1e-4"];
    let run = [&run[..], &slow, &short].concat();
    let begun = Instant::now();
    desk.run(&[&run[..], &["--no-tangent"]].concat()).assert_code(0);
    let mut wait = begun.elapsed().mul_f64(1.6);
    for _ in 0..12 {
        let mut command = desk.command(&[&run[..], &["--tangent"]].concat());
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(wait);
        signal(&child, Signal::SIGINT);
        let ended = child.wait_with_output().unwrap();
        let errors = String::from_utf8(ended.stderr).unwrap();
        match ended.status.code() {
            Some(0) => wait = wait.mul_f64(0.7),
            Some(130) if errors.contains("interrupted at t =") => wait = wait.mul_f64(1.2),
            code => {
                assert_eq!(code, Some(130), "{errors}");
                assert!(errors.contains("the run itself is complete"), "{errors}");
                let file = desk.open("four-bar-c.h5");
                assert_eq!(file.text("run_status"), Some("complete"));
                assert_eq!(file.times().unwrap().len(), 21);
                assert_eq!(file.text("horizon_stopped"), Some("it was interrupted"));
                return;
            }
        }
    }
    panic!("no signal came while errors were followed");
}

#[test]
fn an_interrupted_run_with_force_leaves_the_old_file_alone() {
    let desk = Desk::new();
    desk.file("long.h5", "old");
    let child = long_run(&desk, "four-bar-a", &["--force"]);
    signal(&child, Signal::SIGINT);
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(130));
    assert_eq!(desk.files(), ["long.failed.h5", "long.h5"]);
    assert_eq!(std::fs::read(desk.path("long.h5")).unwrap(), b"old");
    assert_eq!(desk.open("long.failed.h5").text("run_status"), Some("failed"));
}

/// Samples are written as they come: a run of a second, 100 001 samples, needs no more memory than
/// a short one.
#[test]
fn memory_is_bounded_whatever_the_length_of_the_run() {
    let desk = Desk::new();
    let second = ["--set", "run.duration=1"];
    let mut command = desk.command(&[&["run", &case("four-bar-a")], &second[..]].concat());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut kibibytes = 0;
    while child.try_wait().unwrap().is_none() {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
        let most = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let most = most.and_then(|most| most.trim().strip_suffix(" kB"));
        kibibytes = most.map_or(kibibytes, |most| most.parse::<u64>().unwrap());
        std::thread::sleep(Duration::from_millis(1));
    }
    let said = child.wait_with_output().unwrap();
    let out = String::from_utf8(said.stdout).unwrap();
    assert!(said.status.success() && out.contains("100001 samples"), "{out}");
    assert!(kibibytes > 8 * 1024, "{kibibytes} KiB");
    assert!(kibibytes < 64 * 1024, "{kibibytes} KiB");
}
