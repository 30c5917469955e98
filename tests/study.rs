//! Studies. Known in advance: a run of a study is the run that `freeplay run` makes with the same
//! changes, to the last bit; a section point is the sample at its time; and nobody can see from the
//! tables of a study how many threads or processes made it, or how often they were killed.

mod written;

use freeplay::post::Summary;
use freeplay::study::{Options, Study, sweep};
use parquet::file::reader::FileReader;
use parquet::file::serialized_reader::SerializedFileReader;
use serde_json::Value;
use std::fs::{self, File};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;
use written::{Run, alone, root};

const FAST: [&str; 2] = ["solver.engine=explicit", "solver.relative_tolerance=1e-9"];
const TABLES: [&str; 4] = ["runs", "revolutions", "sections", "failures"];

/// A folder with a study in it.
struct Desk(tempfile::TempDir);

impl Desk {
    /// A study of a case of the project, on the explicit engine; `more` is what it says besides.
    fn new(case: &str, more: &str) -> Desk {
        let folder = tempfile::tempdir().unwrap();
        let case = root().join("cases").join(format!("{case}.toml"));
        let set = FAST.map(|change| format!("{change:?}")).join(", ");
        let text = format!("case = {:?}\nset = [{set}]\n{more}", case.to_str().unwrap());
        fs::write(folder.path().join("study.toml"), text).unwrap();
        Desk(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_freeplay"));
        command.args(["sweep", "study.toml", "--quiet"]).args(line.split_whitespace());
        command.current_dir(self.0.path());
        command
    }

    fn sweep(&self, line: &str) -> Output {
        let _alone = alone();
        self.command(line).output().unwrap()
    }

    /// The tables in a folder.
    fn tables(&self, folder: &str) -> Vec<Vec<u8>> {
        let read = |name| fs::read(self.path(folder).join(format!("{name}.parquet"))).unwrap();
        TABLES.iter().map(read).collect()
    }

    /// A table in a folder: its heads, and its rows.
    fn csv(&self, folder: &str, name: &str) -> (Vec<String>, Vec<Vec<String>>) {
        let path = self.path(folder).join(format!("{name}.csv"));
        let mut reader = csv::Reader::from_path(path).unwrap();
        let heads = reader.headers().unwrap().iter().map(str::to_owned).collect();
        let rows = reader.records().map(|row| row.unwrap().iter().map(str::to_owned).collect());
        (heads, rows.collect())
    }
}

fn assert_code(said: &Output, code: i32) {
    assert_eq!(said.status.code(), Some(code), "{}", String::from_utf8_lossy(&said.stderr));
}

fn errors(said: &Output) -> String {
    String::from_utf8_lossy(&said.stderr).into_owned()
}

fn number(text: &str) -> f64 {
    text.parse().unwrap()
}

#[test]
fn a_run_of_a_study_is_the_run_by_itself_to_the_last_bit() {
    let paths = [
        "columns.joint_force.A.largest.value",
        "columns.joint_force.A.largest.time",
        "columns.joint_force.A.ratio.largest",
        "columns.drive_torque.crank.smallest.value",
        "columns.drive_torque.crank.largest.within_horizon",
        "clearances.A.contacts",
        "clearances.A.share_in_contact.value",
        "clearances.A.longest_flight.value",
        "clearances.A.dissipated.value",
        "energy.energy_residual",
        "energy.drive_work",
        "energy.largest_residual.value",
        "samples",
        "horizon.forces",
    ];
    let of_revolutions = ["columns.joint_force.A.largest.value", "clearances.A.contacts"];
    let more = format!(
        "[[vary]]\nkey = \"joints.A.clearance.radial\"\nvalues = [1e-4, 5e-4]\n\
         [span]\nrevolutions = 3.5\n\
         [keep]\nruns = {paths:?}\nrevolutions = {of_revolutions:?}\nhorizon = true\nfiles = true\n\
         [section]\nangle = 1.0\ncolumns = [\"clearance_x.A\", \"joint_force_y.B0\", \"energy_kinetic\"]\n"
    );
    let desk = Desk::new("four-bar-a", &more);
    assert_code(&desk.sweep("--csv -o made"), 0);
    let (heads, rows) = desk.csv("made", "runs");
    assert_eq!(heads[..3], ["run", "joints.A.clearance.radial", "case_sha256"]);
    let (_, revolutions) = desk.csv("made", "revolutions");
    assert_eq!(revolutions.len(), 2 * 4);
    for (run, radial) in ["0.0001", "0.0005"].into_iter().enumerate() {
        let radial = format!("joints.A.clearance.radial={radial}");
        let set = [FAST[0], FAST[1], "run.revolutions=3.5", &radial];
        // through the program, whose file knows its horizon
        let file = desk.path("own.h5");
        let mut own = Command::new(env!("CARGO_BIN_EXE_freeplay"));
        own.args(["run", "--quiet", "--force", "-o"]).arg(&file);
        own.arg(root().join("cases/four-bar-a.toml"));
        own.args(set.iter().flat_map(|change| ["--set", change]));
        let ran = {
            let _alone = alone();
            own.output().unwrap()
        };
        assert_code(&ran, 0);
        let own = freeplay::record::ResultFile::open(&file).unwrap();
        let summary = Summary::of(&own, None).unwrap().to_json();
        for path in paths {
            let column = heads.iter().position(|head| head == path).unwrap();
            let told = number(&rows[run][column]);
            let expected = at(&summary, path);
            assert_eq!(told.to_bits(), expected.to_bits(), "{path}: {told} {expected}");
        }
        assert_eq!(Some(rows[run][2].as_str()), own.text("case_sha256"));
        for row in revolutions.iter().filter(|row| row[0] == run.to_string()) {
            let k: usize = row[2].parse().unwrap();
            assert!((0..4).contains(&k));
            let force = &summary["columns"]["joint_force.A"]["revolutions"][k]["largest"]["value"];
            let contacts = &summary["clearances"]["A"]["revolutions"][k]["contacts"];
            assert_eq!(number(&row[5]), force.as_f64().unwrap());
            assert_eq!(number(&row[6]), contacts.as_f64().unwrap());
        }
        // the file that was asked for has the same samples as one's own
        let kept = desk.path("made/files").join(format!("{}.h5", &rows[run][2][..16]));
        let kept = freeplay::record::ResultFile::open(&kept).unwrap();
        assert!(kept.is_complete());
        assert_eq!(kept.column("energy_kinetic").unwrap(), own.column("energy_kinetic").unwrap());
    }
}

#[test]
fn numbers_of_a_run_are_those_behind_what_is_left_out() {
    let more = |discard: u64| {
        format!(
            "[[vary]]\nkey = \"joints.A.clearance.radial\"\nvalues = [2e-4, 1e-3]\n\
             [span]\nrevolutions = 5\ndiscard = {discard}\n\
             [keep]\nruns = [\"columns.joint_force.A.largest\", \"clearances.A.contacts\", \
             \"clearances.A.share_in_contact\", \"energy.energy_dissipated\", \"energy.drive_work\"]\n\
             revolutions = [\"columns.joint_force.A.largest\", \"clearances.A.contacts\", \
             \"clearances.A.share_in_contact\"]\n"
        )
    };
    let [whole, behind, two] = [0, 2, 0].map(|discard| Desk::new("four-bar-a", &more(discard)));
    let text = fs::read_to_string(two.path("study.toml")).unwrap();
    fs::write(two.path("study.toml"), text.replace("revolutions = 5", "revolutions = 2")).unwrap();
    for desk in [&whole, &behind, &two] {
        assert_code(&desk.sweep("--csv -o made"), 0);
    }
    let rows = |desk: &Desk| desk.csv("made", "runs").1;
    let (_, revolutions) = whole.csv("made", "revolutions");
    for run in 0..2 {
        let [whole, behind, two] = [&whole, &behind, &two].map(|desk| rows(desk)[run].clone());
        let its = revolutions.iter().filter(|row| row[0] == run.to_string()).skip(2);
        let its: Vec<[f64; 3]> = its.map(|row| [5, 6, 7].map(|k| number(&row[k]))).collect();
        assert_eq!(its.len(), 3);
        let largest = its.iter().map(|row| row[0]).fold(0.0, f64::max);
        let contacts: f64 = its.iter().map(|row| row[1]).sum();
        let share = its.iter().map(|row| row[2]).sum::<f64>() / 3.0;
        assert_eq!([number(&behind[3]), number(&behind[4])], [largest, contacts]);
        let share_behind = number(&behind[5]);
        assert!((share_behind - share).abs() < 1e-12, "{share_behind} {share}");
        // works add up
        for column in [6, 7] {
            let [all, late, early] = [&whole, &behind, &two].map(|row| number(&row[column]));
            assert!((all - late - early).abs() < 1e-9 * all.abs(), "{all} {late} {early}");
        }
    }
}

/// A number of a summary.
fn at(summary: &Value, path: &str) -> f64 {
    let columns = path.strip_prefix("columns.").and_then(|path| {
        let dot = path.match_indices('.').nth(1)?.0;
        Some(vec!["columns", &path[..dot], &path[dot + 1..]])
    });
    let steps = columns.unwrap_or_else(|| vec![path]);
    let steps = steps.iter().enumerate().flat_map(|(k, step)| match (steps.len(), k) {
        (3, 0 | 1) => vec![*step],
        _ => step.split('.').collect(),
    });
    match steps.fold(summary, |here, step| &here[step]) {
        Value::Bool(flag) => f64::from(u8::from(*flag)),
        value => value.as_f64().unwrap_or(f64::NAN),
    }
}

#[test]
fn section_points_are_the_samples_at_their_times() {
    let more = "[[vary]]\nkey = \"joints.A.clearance.radial\"\nvalues = [4e-4]\n\
                [span]\nrevolutions = 4\ndiscard = 1\n\
                [section]\nangle = 0.5\ncolumns = [\"clearance_x.A\", \"angle.crank\", \"joint_force_y.B0\"]\n";
    let desk = Desk::new("four-bar-a", more);
    assert_code(&desk.sweep("--csv -o made"), 0);
    let (heads, rows) = desk.csv("made", "sections");
    assert_eq!(
        heads[2..],
        ["revolution", "time", "clearance_x.A", "angle.crank", "joint_force_y.B0"]
    );
    let turn = std::f64::consts::TAU;
    assert_eq!(rows.len(), 3);
    // another run of the same trajectory, sampled often
    let set = [FAST[0], FAST[1], "run.revolutions=4", "joints.A.clearance.radial=4e-4"];
    let own = Run::of("four-bar-a", &[&set[..], &["run.sample_interval=1e-6"]].concat());
    let file = own.file();
    let times = file.times().unwrap();
    let [x, force] = ["clearance_x", "joint_force_y"].map(|name| file.table(name).unwrap());
    let b0 = file.joints().iter().position(|joint| joint == "B0").unwrap();
    for (row, k) in rows.iter().zip(1..) {
        let [revolution, time, here, angle, there] = [2, 3, 4, 5, 6].map(|c| number(&row[c]));
        assert_eq!(revolution, f64::from(k));
        assert!((angle - 0.5 - turn * f64::from(k)).abs() < 1e-13 * angle, "{angle}");
        let after = times.partition_point(|sample| *sample < time);
        let share = (time - times[after - 1]) / (times[after] - times[after - 1]);
        let between = |column: &[f64]| {
            let [a, b] = [column[after - 1], column[after]];
            (a + share * (b - a), (b - a).abs())
        };
        for (value, column) in [(here, x.column(0)), (there, force.column(b0))] {
            // on the straight line between two samples, but for its bend
            let (line, step) = between(&column);
            assert!(
                (value - line).abs() < 0.02 * step + 1e-12 * value.abs(),
                "{value} {line} {step}"
            );
        }
    }
}

#[test]
fn sections_of_a_drive_that_swings_lie_where_its_course_passes_the_angle() {
    let more = "[[vary]]\nkey = \"drives.crank.amplitude\"\nvalues = [0.4, 0.9]\n\
                [keep]\nruns = [\"end\"]\nrevolutions = []\n\
                [section]\nangle = 0.3\ncolumns = [\"angle.crank\"]\n";
    let desk = Desk::new("four-bar-ideal", more);
    let study = fs::read_to_string(desk.path("study.toml")).unwrap();
    let swing = "drives.crank={ kind = 'harmonic', joint = 'A0', amplitude = 0.5, angular_frequency = 125.0 }";
    let study = study.replace("set = [", &format!("set = [{swing:?}, \"run.duration=0.1\", "));
    fs::write(desk.path("study.toml"), study).unwrap();
    assert_code(&desk.sweep("--csv -o made"), 0);
    let (_, rows) = desk.csv("made", "sections");
    for (run, amplitude) in [0.4, 0.9].into_iter().enumerate() {
        let its: Vec<&Vec<String>> = rows.iter().filter(|row| row[0] == run.to_string()).collect();
        // a swing up and one down in each of two periods
        assert_eq!(its.len(), 4, "{its:?}");
        for row in its {
            let (time, angle) = (number(&row[3]), number(&row[4]));
            let course = amplitude * (125.0 * time).cos();
            assert!((angle - 0.3).abs() < 1e-12 && (course - 0.3).abs() < 1e-12, "{row:?}");
        }
    }
}

const GRID: &str = "[[vary]]\nname = \"speed\"\nkey = \"drives.crank.speed_rpm\"\n\
                    from = 2000\nto = 5000\ncount = 6\n\
                    [[vary]]\nkeys = [\"joints.A.clearance.radial\"]\nfrom = 1e-4\nto = 2e-2\ncount = 5\n\
                    spacing = \"log\"\n\
                    [span]\nrevolutions = 2\n[section]\n";

#[test]
fn tables_do_not_tell_how_many_jobs_there_were_nor_how_often_they_were_killed() {
    let desk = Desk::new("four-bar-a", GRID);
    // the largest clearance is no clearance: a row of failures for each speed
    assert_code(&desk.sweep("--jobs 1 -o one"), 4);
    assert_code(&desk.sweep("--jobs 2 -o two"), 4);
    let expected = desk.tables("one");
    assert!(desk.tables("two") == expected);
    let mut killed = 0;
    for k in 0..12 {
        let _alone = alone();
        let mut child = desk.command("--jobs 2 -o three").stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(15 + fastrand::u64(0..60)));
        killed += i32::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
        if k >= 2 && desk.path("three/runs.parquet").exists() {
            break;
        }
    }
    assert!(killed > 0);
    let said = desk.sweep("--jobs 2 -o three --json");
    assert_code(&said, 4);
    assert!(desk.tables("three") == expected);
    // and once more: nothing is left to be done
    let said = desk.sweep("-o three --json");
    let told: Value = serde_json::from_slice(&said.stdout).unwrap();
    assert_eq!((&told["made"], &told["runs"], &told["failed"]), (&0.into(), &30.into(), &6.into()));
    assert!(desk.tables("three") == expected);
}

#[test]
fn shards_come_together_to_the_same_tables() {
    let desk = Desk::new("four-bar-a", GRID);
    assert_code(&desk.sweep("--jobs 1 -o one"), 4);
    let mut made = 0;
    for shard in ["1/3", "2/3"] {
        let said = desk.sweep(&format!("--shard {shard} -o parts --json"));
        let told: Value = serde_json::from_slice(&said.stdout).unwrap();
        made += told["made"].as_u64().unwrap();
        assert_code(&said, if told["failed"].as_u64() > Some(0) { 4 } else { 0 });
    }
    let said = desk.sweep("--gather parts");
    assert_code(&said, 1);
    assert!(errors(&said).contains("of 30 runs are missing"), "{}", errors(&said));
    assert!(!desk.path("parts/runs.parquet").exists());
    // the last one twice at once, where neither knows of the other
    let _alone = alone();
    let both: Vec<_> = (0..2)
        .map(|_| {
            desk.command("--shard 3/3 -o parts --json")
                .stdout(Stdio::piped())
                .stderr(Stdio::null())
                .spawn()
                .unwrap()
        })
        .collect();
    let mut most = 0;
    for child in both {
        let said = child.wait_with_output().unwrap();
        let told: Value = serde_json::from_slice(&said.stdout).unwrap();
        most = most.max(told["made"].as_u64().unwrap());
    }
    drop(_alone);
    assert!(made + most == 30, "{made} {most}");
    assert_code(&desk.sweep("--gather parts"), 4);
    assert!(desk.tables("parts") == desk.tables("one"));
    // what was gathered goes on as a whole, too
    assert_code(&desk.sweep("-o parts"), 4);
}

#[test]
fn what_can_be_tried_again_says_so() {
    let desk = Desk::new("four-bar-a", GRID);
    let _alone = alone();
    for (line, code) in [("-o full", 3), ("--shard 1/1 -o full", 75)] {
        let program = env!("CARGO_BIN_EXE_freeplay");
        // two blocks of 512 bytes are soon full
        let shell = format!("ulimit -f 2; exec {program} sweep study.toml --quiet --jobs 2 {line}");
        let said =
            Command::new("sh").args(["-c", &shell]).current_dir(desk.0.path()).output().unwrap();
        assert_code(&said, code);
        assert!(errors(&said).contains("the same command goes on"), "{}", errors(&said));
    }
    for (folder, more, code) in [("stopped", "", 143), ("shard", "--shard 1/1", 75)] {
        let line = format!("-o {folder} {more}");
        let mut child = desk.command(&line).stderr(Stdio::null()).spawn().unwrap();
        // by then it listens
        while !desk.path(folder).join("packs").exists() {
            std::thread::sleep(Duration::from_millis(1));
        }
        let pid = nix::unistd::Pid::from_raw(child.id() as i32);
        nix::sys::signal::kill(pid, nix::sys::signal::Signal::SIGTERM).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(code));
    }
    drop(_alone);
    assert_code(&desk.sweep("-o whole --jobs 1"), 4);
    for folder in ["full", "stopped", "shard"] {
        assert_code(&desk.sweep(&format!("-o {folder}")), 4);
        assert!(desk.tables(folder) == desk.tables("whole"), "{folder}");
    }
}

#[test]
fn a_run_that_fails_is_a_row_with_why() {
    let desk = Desk::new("four-bar-a", GRID);
    assert_code(&desk.sweep("--csv -o made"), 4);
    let (heads, rows) = desk.csv("made", "failures");
    assert_eq!(heads, ["run", "speed", "joints.A.clearance.radial", "case_sha256", "reason"]);
    assert_eq!(rows.len(), 6);
    for (row, speed) in
        rows.iter().zip(["2000.0", "2600.0", "3200.0", "3800.0", "4400.0", "5000.0"])
    {
        assert_eq!((row[1].as_str(), row[2].as_str()), (speed, "0.02"));
        assert!(row[4].contains("must be less than bearing_radius"), "{}", row[4]);
    }
    let (_, runs) = desk.csv("made", "runs");
    assert_eq!(runs.len(), 24);
    assert!(runs.iter().all(|row| row[2] != "0.02"));
}

#[test]
fn tables_tell_their_units_and_their_study() {
    let desk = Desk::new(
        "four-bar-a",
        "[[vary]]\nkey = \"drives.crank.speed_rpm\"\nvalues = [4000]\n[span]\nrevolutions = 1\n[section]\n",
    );
    assert_code(&desk.sweep("-o made"), 0);
    let text = fs::read_to_string(desk.path("study.toml")).unwrap();
    for name in TABLES {
        let file = File::open(desk.path("made").join(format!("{name}.parquet"))).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        let metadata = reader.metadata().file_metadata().key_value_metadata().unwrap().clone();
        let of = |key: &str| {
            let found = metadata.iter().find(|entry| entry.key == key).unwrap();
            found.value.clone().unwrap()
        };
        assert_eq!((of("study_toml"), of("table")), (text.clone(), name.to_owned()));
        let units: Value = serde_json::from_str(&of("units")).unwrap();
        assert_eq!(units["drives.crank.speed_rpm"], "rpm");
        match name {
            "runs" => {
                assert_eq!(units["columns.joint_force.A.largest.value"], "N");
                assert_eq!(units["clearances.A.contacts"], "1");
                assert_eq!(units["clearances.A.dissipated.value"], "J");
            }
            "sections" => assert_eq!(units["angular_velocity.coupler"], "rad/s"),
            "revolutions" => assert_eq!(units["begin"], "s"),
            _ => {}
        }
    }
    // another study does not go over these tables unasked
    fs::write(desk.path("study.toml"), format!("{text}\n# changed\n")).unwrap();
    let said = desk.sweep("-o made");
    assert_code(&said, 3);
    assert!(errors(&said).contains("another study"), "{}", errors(&said));
    let said = desk.sweep("-o made --force --json");
    assert_code(&said, 0);
    // ... and what both have is not made again
    let told: Value = serde_json::from_slice(&said.stdout).unwrap();
    assert_eq!(told["made"], 0);
}

#[test]
fn samples_are_those_of_their_distributions_and_keys_go_together() {
    let more = "[[vary]]\nname = \"c\"\nkeys = [\"joints.A.clearance.radial\", \"joints.B.clearance.radial\"]\n\
                log_uniform = [1e-5, 1e-3]\n\
                [[vary]]\nkey = \"bodies.coupler.mass\"\nnormal = [0.07, 0.01]\n\
                [[vary]]\nkey = \"drives.crank.speed_rpm\"\nvalues = [100, 200]\n\
                [samples]\nmethod = \"latin-hypercube\"\ncount = 500\nseed = 4\n";
    let desk = Desk::new("four-bar-b", more);
    let study = Study::read(&desk.path("study.toml")).unwrap();
    assert_eq!(study.runs, 1000);
    let number = |run: u64, k: usize| study.point(run)[k].number.unwrap();
    let mean = |k, of: fn(f64) -> f64| (0..500).map(|run| of(number(run, k))).sum::<f64>() / 500.0;
    assert!((mean(0, f64::log10) + 4.0).abs() < 1e-3, "{}", mean(0, f64::log10));
    assert!((mean(1, |m| m) - 0.07).abs() < 1e-4);
    assert!((mean(1, |m| (m - 0.07).powi(2)).sqrt() - 0.01).abs() < 1e-4);
    assert_eq!((number(499, 2), number(500, 2)), (100.0, 200.0));
    assert_eq!(number(3, 0), number(503, 0));
    let options = study.options(3);
    let c = study.point(3)[0].text.clone();
    for joint in ["A", "B"] {
        assert!(options.contains(&format!("joints.{joint}.clearance.radial={c}")), "{options:?}");
    }
}

/// A mass in a slot of 2 · 10 mm, with walls that it rebounds at, which a harmonic drive shakes along x.
const SLOT: &str = "[ground]\npoints = { P = [0.0, 0.0] }\n\
    [bodies.slot]\nmass = 1.0\ninertia = 0.01\npoints = { C = [0.0, 0.0] }\n\
    [bodies.mass]\nmass = 0.05\ninertia = 1e-4\npoints = { C = [0.0, 0.0] }\n\
    [joints.rail]\nkind = \"prismatic\"\nbetween = [\"ground.P\", \"slot.C\"]\naxis = [1.0, 0.0]\n\
    [joints.guide]\nkind = \"prismatic\"\nbetween = [\"slot.C\", \"mass.C\"]\naxis = [1.0, 0.0]\n\
    [joints.walls]\nkind = \"revolute\"\nbetween = [\"slot.C\", \"mass.C\"]\n\
    [joints.walls.clearance]\nbearing_radius = 0.1\nradial = 0.01\n\
    normal = { law = \"lankarani-nikravesh\", restitution = 0.5, stiffness = 1e10 }\n\
    [drives.shake]\njoint = \"rail\"\nkind = \"harmonic\"\namplitude = 0.02\nangular_frequency = 40.0\n\
    phase = -1.5707963267948966\n\
    [start]\nmass = { x = 0.0, velocity_x = 0.3, fixed = true }\n\
    [run]\nduration = 9.4247779608\nsample_interval = 0.1\n";

#[test]
fn periods_and_exponents_of_a_study_are_those_of_single_runs() {
    let more = "[[vary]]\nkey = \"drives.shake.amplitude\"\nvalues = [0.006, 0.01, 0.02, 0.03]\n\
                [span]\ndiscard = 30\n\
                [keep]\nruns = [\"clearances.walls.contacts\"]\nrevolutions = []\nexponents = 2\n\
                [attractor]\ntolerance = 1e-4\nlongest = 4\n\
                [section]\ncolumns = [\"clearance_x.walls\", \"velocity_x.mass\"]\n";
    let desk = Desk::new("pendulum", more);
    fs::write(desk.path("slot.toml"), SLOT).unwrap();
    let text = fs::read_to_string(desk.path("study.toml")).unwrap();
    let (_, rest) = text.split_once("set = ").unwrap();
    fs::write(desk.path("study.toml"), format!("case = \"slot.toml\"\nset = {rest}")).unwrap();
    assert_code(&desk.sweep("--csv -o made"), 0);
    let (heads, rows) = desk.csv("made", "runs");
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let (_, sections) = desk.csv("made", "sections");
    let mut periodic = 0;
    for (run, row) in rows.iter().enumerate() {
        let of = |name: &str| number(&row[column(name)]);
        // what the section points themselves say of the period
        let its: Vec<[f64; 2]> = sections
            .iter()
            .filter(|point| point[0] == run.to_string())
            // the drive passes zero at the ends of its periods, and half way
            .filter(|point| (number(&point[3]) * 40.0).cos() > 0.0)
            .map(|point| [number(&point[4]) / 0.01, number(&point[5]) / 4.0])
            .collect();
        let last = &its[its.len() - 4..];
        let comes_back = |period: usize| {
            let before = &its[its.len() - 4 - period..its.len() - period];
            let pairs = last.iter().zip(before);
            pairs.map(|(a, b)| (a[0] - b[0]).abs().max((a[1] - b[1]).abs())).fold(0.0, f64::max)
        };
        let period = (1..=4).find(|period| comes_back(*period) < 1e-4);
        assert_eq!(of("attractor.revolutions"), period.unwrap_or(0) as f64, "run {run}: {row:?}");
        assert_eq!(of("attractor.always_in_contact.walls"), 0.0);
        // each impact shrinks an area by the square of the restitution, so that the sum tells how many
        // there were
        let sum = of("lyapunov.sum.value");
        let impacts = 30.0 * sum / (2.0 * 0.725_241_114_010_197_f64.ln());
        let contacts = of("clearances.walls.contacts");
        if period.is_some() {
            assert!(
                (impacts - contacts).abs() < 2e-3 * contacts,
                "run {run}: {impacts} {contacts}"
            );
        } else {
            // exponents are those of a trajectory of their own: where a motion is chaotic it is another one,
            // as often in contact in the long run only
            assert!((impacts - contacts).abs() < 0.2 * contacts, "run {run}: {impacts} {contacts}");
        }
        let [first, second] = [1, 2].map(|k| of(&format!("lyapunov.{k}.value")));
        assert!(first >= second && (first + second - sum).abs() < 1e-9 * sum.abs());
        // a motion that comes back is stable, one that is chaotic does not come back
        if period.is_some() {
            periodic += 1;
            assert!(first < 0.0, "run {run}: {row:?}");
            assert_eq!(of("lyapunov.kaplan_yorke.value"), 0.0);
        } else {
            assert!(first > 0.5, "run {run}: {row:?}");
        }
        // as the command by itself has it
        let case = desk.path("slot.toml");
        let amplitude = format!("drives.shake.amplitude={}", row[1]);
        let mut own = Command::new(env!("CARGO_BIN_EXE_freeplay"));
        own.arg("lyapunov").arg(&case).args(["--exponents", "all", "--json", "-q"]);
        own.args(["--revolutions", "60", "--discard", "30", "--set", &amplitude]);
        own.args(FAST.iter().flat_map(|change| ["--set", change]));
        let said = {
            let _alone = alone();
            own.output().unwrap()
        };
        assert_code(&said, 0);
        let told: Value = serde_json::from_slice(&said.stdout).unwrap();
        // the reader of JSON may be off in the last place
        let same = |told: &Value, known: f64| {
            let told = told.as_f64().unwrap();
            assert!((told - known).abs() <= 4.0 * f64::EPSILON * known.abs(), "{told} {known}");
        };
        same(&told["exponents"][0]["per_revolution"], first);
        same(&told["exponents"][1]["half_width"], of("lyapunov.2.half_width"));
        assert_eq!(told["zero"]["autonomous"], false);
    }
    // the first three as hard walls have it: a fixed point, its period doubled, chaos
    let periods: Vec<f64> =
        rows.iter().map(|row| number(&row[column("attractor.revolutions")])).collect();
    assert_eq!(periods[..3], [1.0, 2.0, 0.0]);
    assert!(periodic >= 2);
    // ... and drawn
    let _alone = alone();
    let mut plot = Command::new(env!("CARGO_BIN_EXE_freeplay"));
    plot.args(["plot", "made", "-o", "figures"]).current_dir(desk.0.path());
    assert_code(&plot.output().unwrap(), 0);
    let svg = fs::read_to_string(desk.path("figures/exponents.svg")).unwrap();
    assert!(svg.contains("e-folds per revolution") && svg.contains("95 % intervals"));
    assert!(desk.path("figures/response-attractor.revolutions.svg").exists());
    assert!(!desk.path("figures/response-lyapunov.1.svg").exists());
}

#[test]
fn basins_are_a_study_of_two_keys_by_period() {
    let more = "[[vary]]\nkey = \"start.mass.velocity_x\"\nfrom = -1.0\nto = 1.0\ncount = 4\n\
                [[vary]]\nkey = \"start.mass.x\"\nfrom = -0.008\nto = 0.008\ncount = 3\n\
                [span]\ndiscard = 12\n[keep]\nruns = [\"end\"]\n\
                [attractor]\ntolerance = 1e-2\nlongest = 4\n";
    let desk = Desk::new("pendulum", more);
    fs::write(desk.path("slot.toml"), SLOT).unwrap();
    let text = fs::read_to_string(desk.path("study.toml")).unwrap();
    let (_, rest) = text.split_once("set = [").unwrap();
    let set = "set = [\"run.duration=3.77\", ";
    fs::write(desk.path("study.toml"), format!("case = \"slot.toml\"\n{set}{rest}")).unwrap();
    assert_code(&desk.sweep("-o made"), 0);
    let _alone = alone();
    let mut plot = Command::new(env!("CARGO_BIN_EXE_freeplay"));
    plot.args(["plot", "made", "-o", "figures"]).current_dir(desk.0.path());
    assert_code(&plot.output().unwrap(), 0);
    let path = desk.path("figures/heat-map-attractor.revolutions.svg");
    assert!(fs::read_to_string(path).unwrap().contains("Period"));
}

#[test]
fn an_ensemble_comes_to_the_distribution_of_a_long_run() {
    let more = "[span]\nrevolutions = 16\n\
                [keep]\nruns = [\"clearances.A.contacts\"]\n\
                revolutions = [\"clearances.A.contacts\", \"clearances.A.share_in_contact\"]\n\
                [ensemble]\ncopies = 60\nspread = 1e-9\nlong = 200\nseed = 2\n";
    let desk = Desk::new("four-bar-a", more);
    assert_code(&desk.sweep("--jobs 2 --csv -o made"), 0);
    let (heads, rows) = desk.csv("made", "ensemble");
    let column = |name: &str| {
        let name = format!("clearances.A.share_in_contact.value.{name}");
        heads.iter().position(|head| *head == name).unwrap()
    };
    assert_eq!(heads[..2], ["run", "revolution"]);
    assert_eq!(rows.len(), 16);
    let of = |k: usize, name: &str| number(&rows[k][column(name)]);
    // one of the copies is the run that the case with its disturbance is
    let (_, runs) = desk.csv("made", "runs");
    assert_eq!((runs.len(), runs[0][1].as_str()), (61, "0.0"));
    let (_, revolutions) = desk.csv("made", "revolutions");
    assert_eq!(revolutions.len(), 200 + 60 * 16);
    let spread: Vec<f64> = runs[1..].iter().map(|row| number(&row[1])).collect();
    let deviation = (spread.iter().map(|x| x * x).sum::<f64>() / 60.0).sqrt();
    assert!((deviation / 1e-9 - 1.0).abs() < 0.3, "{deviation:e}");
    // means are those of the rows of the copies
    for k in [0, 7, 15] {
        let its: Vec<f64> = revolutions[200..]
            .iter()
            .filter(|row| row[2] == k.to_string())
            .map(|row| number(&row[6]))
            .collect();
        assert_eq!(its.len(), 60);
        assert!((of(k, "mean") - its.iter().sum::<f64>() / 60.0).abs() < 1e-14);
        assert!(of(k, "q05") <= of(k, "q50") && of(k, "q50") <= of(k, "q95"));
    }
    // they begin as one; 4.3 e-folds a revolution later there is nothing left of that
    assert!(of(0, "q95") - of(0, "q05") < 1e-3 && of(0, "mean_high") - of(0, "mean_low") < 1e-3);
    let from = of(0, "agrees_from");
    assert!((2.0..14.0).contains(&from), "{from}");
    assert!(of(0, "distance") > 0.3 && of(15, "distance") < 0.3);
    let late = (from as usize..16).filter(|k| {
        of(*k, "mean_low") < of(*k, "long_high") && of(*k, "mean_high") > of(*k, "long_low")
    });
    assert!(late.count() as f64 >= 0.7 * (16.0 - from));
    // ... and drawn
    let _alone = alone();
    let mut plot = Command::new(env!("CARGO_BIN_EXE_freeplay"));
    plot.args(["plot", "made", "-o", "figures"]).current_dir(desk.0.path());
    assert_code(&plot.output().unwrap(), 0);
    let path = desk.path("figures/convergence-clearances.A.share_in_contact.svg");
    let svg = fs::read_to_string(path).unwrap();
    assert!(svg.contains("mean of the long run") && !svg.contains("NaN"));
}

#[test]
fn the_page_of_a_study_leads_from_each_point_to_its_command() {
    let desk = Desk::new("four-bar-a", GRID);
    let text = fs::read_to_string(desk.path("study.toml")).unwrap();
    fs::write(desk.path("study.toml"), format!("title = \"Speed & <clearance>\"\n{text}")).unwrap();
    assert_code(&desk.sweep("-o made"), 4);
    let _alone = alone();
    let mut command = Command::new(env!("CARGO_BIN_EXE_freeplay"));
    command.args(["report", "made", "-o", "page.html"]).current_dir(desk.0.path());
    assert_code(&command.output().unwrap(), 0);
    let page = fs::read_to_string(desk.path("page.html")).unwrap();
    assert!(page.contains("<title>Speed &amp; &lt;clearance&gt;</title>"));
    for run in 0..30 {
        assert_eq!(page.matches(&format!("id=\"run-{run}\"")).count(), 1, "run {run}");
    }
    let points = page.matches("<a href=\"#run-7\">").count();
    assert!(points >= 5, "run 7 has {points} points");
    assert!(page.contains("must be less than bearing_radius"));
    assert!(page.contains("data:image/svg+xml;base64,") && !page.contains("NaN"));
    // the command of a row makes the run
    let (_, behind) = page.split_once("id=\"run-7\"").unwrap();
    let (command, _) = behind.split_once("<code>").unwrap().1.split_once("</code>").unwrap();
    let command = command.replace("&#39;", "'").replace("&quot;", "\"").replacen(
        "freeplay",
        env!("CARGO_BIN_EXE_freeplay"),
        1,
    );
    let line = format!("{command} -o run.h5 --quiet");
    let said = Command::new("sh").args(["-c", &line]).current_dir(desk.0.path()).output().unwrap();
    assert_code(&said, 0);
    let own = freeplay::record::ResultFile::open(&desk.path("run.h5")).unwrap();
    assert!(page.contains(&format!("--set drives.crank.speed_rpm={:?}", 2600.0)));
    assert_eq!(own.text("run_status"), Some("complete"));
    // it does not go over another page unasked
    let mut again = Command::new(env!("CARGO_BIN_EXE_freeplay"));
    again.args(["report", "made", "-o", "page.html"]).current_dir(desk.0.path());
    assert_code(&again.output().unwrap(), 3);
}

#[test]
fn a_study_that_is_wrong_is_told_with_its_line() {
    let vary = "[[vary]]\nkey = \"joints.A.clearance.radial\"\n";
    for (more, line, part) in [
        ("[[vary]]\nkey = \"a\"\nfrom = 1\n", "", "a range needs `from`, `to` and `count`"),
        ("[[vary]]\nvalues = [1]\n", "line 3", "needs `key`"),
        (&format!("{vary}values = [1e-4]\nuniform = [1, 2]\n"), "line 3", "needs one of"),
        (&format!("{vary}uniform = [2, 1]\n"), "line 3", "the first less"),
        (&format!("{vary}uniform = [1, 2]\n"), "line 3", "needs [samples]"),
        (&format!("{vary}from = -1\nto = 1\ncount = 3\nspacing = \"log\"\n"), "line 3", "positive"),
        (
            &format!("{vary}values = [1e-4]\n[samples]\nmethod = \"sobol\"\ncount = 3\n"),
            "",
            "nothing is sampled",
        ),
        (&format!("{vary}values = [1e-4]\n{vary}values = [1e-4]\n"), "line 6", "varies already"),
        (&format!("{vary}values = [1e-4]\nform = 2\n"), "line 6", "unknown field `form`"),
        (
            &format!("{vary}values = [1e-4]\n[span]\nrevolutions = 0\n"),
            "line 7",
            "must be positive",
        ),
        (
            &format!("{vary}values = [1e-4]\n[keep]\nruns = [\"clearances.B.contacts\"]\n"),
            "keep.runs",
            "it has A",
        ),
        (
            &format!("{vary}values = [1e-4]\n[section]\ndrive = \"crnk\"\n"),
            "section.drive",
            "did you mean \"crank\"",
        ),
        (
            &format!("{vary}values = [1e-4]\n[section]\ncolumns = [\"angle.crnk\"]\n"),
            "section.columns",
            "angle.crank",
        ),
        (&format!("{vary}values = [1e-4]\n[attractor]\n"), "attractor.longest", "there are 5"),
        (
            &format!("{vary}values = [1e-4]\n[attractor]\ntolerance = 0\n"),
            "line 6",
            "attractor.tolerance: must be positive",
        ),
        (
            &format!("{vary}values = [1e-4]\n[keep]\nexponents = 5\n"),
            "keep.exponents",
            "there are 4, twice the freedoms",
        ),
        (
            "[ensemble]\ncopies = 20\nspread = 1e-6\nlong = 100\n",
            "line 3",
            "needs span.revolutions",
        ),
        (
            "[span]\nrevolutions = 5\n[ensemble]\ncopies = 2\nspread = 1e-6\nlong = 100\n",
            "line 5",
            "ensemble.copies: must be from 10",
        ),
        (
            &format!("{vary}values = [1e-4]\n[span]\ndiscard = 5\n"),
            "span.discard",
            "nothing would be left",
        ),
        (
            "[[vary]]\nkey = \"joints.A.clearance.radail\"\nvalues = [1e-4]\n",
            "radail",
            "did you mean \"radial\"",
        ),
    ] {
        let desk = Desk::new("four-bar-a", more);
        let said = desk.sweep("-o made");
        assert_code(&said, 2);
        let said = errors(&said);
        assert!(said.contains(line) && said.contains(part), "{more}: {said}");
        assert!(!desk.path("made").exists(), "{more}");
    }
}

#[test]
fn the_command_line_makes_the_study_that_a_file_would() {
    let desk = Desk::new(
        "four-bar-a",
        "[[vary]]\nkeys = [\"joints.A.clearance.radial\"]\nfrom = 1e-4\nto = 4e-4\ncount = 3\nspacing = \"log\"\n[span]\nrevolutions = 2.0\ndiscard = 1\n[section]\n",
    );
    assert_code(&desk.sweep("-o file --csv"), 0);
    let _alone = alone();
    let mut command = Command::new(env!("CARGO_BIN_EXE_freeplay"));
    command.arg("sweep").arg(root().join("cases/four-bar-a.toml")).current_dir(desk.0.path());
    command.args(FAST.iter().flat_map(|change| ["--set", change]));
    command.args(["--vary", "joints.A.clearance.radial=1e-4:4e-4:3:log", "--revolutions", "2"]);
    command.args(["--discard", "1", "--section", "0", "--csv", "-q", "-o", "line"]);
    assert_code(&command.output().unwrap(), 0);
    for name in TABLES {
        assert_eq!(desk.csv("file", name), desk.csv("line", name), "{name}");
    }
    let (_, rows) = desk.csv("line", "runs");
    let values: Vec<&str> = rows.iter().map(|row| row[1].as_str()).collect();
    assert_eq!(values, ["0.0001", "0.0002", "0.0004"]);
}

/// As a library, in this process.
#[test]
fn a_study_can_be_made_without_the_program() {
    let desk = Desk::new(
        "pendulum",
        "[[vary]]\nkey = \"run.sample_interval\"\nvalues = [0.01, 0.02]\n[keep]\nruns = [\"energy.energy_residual\", \"end\"]\n",
    );
    let study = Study::read(&desk.path("study.toml")).unwrap();
    let options = Options { jobs: NonZeroUsize::MIN, shard: None, csv: true, force: false };
    let _alone = alone();
    let done = sweep(&study, &desk.path("made"), &options, &|_| ()).unwrap();
    assert_eq!((done.made, done.failed, done.tables.len()), (2, 0, 8));
    let (_, rows) = desk.csv("made", "runs");
    assert_eq!(rows[0][3..], rows[1][3..], "the trajectory does not depend on the samples");
    assert!(Path::new(&done.tables[0]).exists());
}

#[test]
fn a_study_is_drawn() {
    let one = "[[vary]]\nkey = \"joints.A.clearance.radial\"\nfrom = 1e-4\nto = 1e-3\ncount = 4\nspacing = \"log\"\n\
               [span]\nrevolutions = 33\ndiscard = 2\n[section]\n\
               [keep]\nrevolutions = [\"columns.joint_force.A.largest\", \"clearances.A.contacts\"]\n\
               runs = [\"clearances.A.dissipated\"]\n";
    let desk = Desk::new("four-bar-a", one);
    assert_code(&desk.sweep("-o one"), 0);
    fs::write(
        desk.path("study.toml"),
        fs::read_to_string(desk.path("study.toml")).unwrap().replace(one, GRID),
    )
    .unwrap();
    assert_code(&desk.sweep("-o grid"), 4);
    let _alone = alone();
    let plot = |line: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_freeplay"));
        command
            .arg("plot")
            .args(line.split_whitespace())
            .current_dir(desk.0.path())
            .output()
            .unwrap()
    };
    assert_code(&plot("one -o figures"), 0);
    assert_code(&plot("grid -o figures --only heat-map --format svg,png,pdf"), 0);
    for (name, words) in [
        ("response-columns.joint_force.A.largest", "9 of 10 revolutions"),
        ("response-clearances.A.contacts", "Contacts in A"),
        ("response-clearances.A.dissipated", "Dissipated in A (J)"),
        ("bifurcation-clearance_x.A", "Radial clearance of A (mm)"),
        ("bifurcation-columns.joint_force.A.largest", "Largest force in A (kN)"),
        ("histogram-columns.joint_force.A.largest", "Share of revolutions"),
        ("poincare-A", "0.1 mm"),
        ("heat-map-columns.joint_force.A.largest", "Speed (rpm)"),
    ] {
        let svg = fs::read_to_string(desk.path("figures").join(format!("{name}.svg"))).unwrap();
        let svg = svg.replace("</tspan>", "");
        let plain: String =
            svg.split('<').map(|part| part.split_once('>').map_or("", |p| p.1)).collect();
        assert!(plain.contains(words), "{name}: {plain}");
        assert!(!svg.contains("NaN"), "{name}");
    }
    assert!(desk.path("figures/heat-map-clearances.A.contacts.pdf").exists());
    assert!(!desk.path("figures/response-run.svg").exists());
    let said = plot("one grid -o more");
    assert_code(&said, 2);
    assert!(errors(&said).contains("a study is drawn by itself"), "{}", errors(&said));
    fs::create_dir(desk.path("empty")).unwrap();
    let said = plot("empty -o more");
    assert_code(&said, 2);
    assert!(errors(&said).contains("empty/runs.parquet"), "{}", errors(&said));
    // what is no table of a study is said to be none
    fs::write(desk.path("one/runs.parquet"), "PAR1 nothing").unwrap();
    assert_code(&plot("one -o more"), 2);
    assert!(!desk.path("more").exists());
}
