//! `freeplay compare`, on whole runs. Known in advance: 25 digits of the first 24 ms of the
//! paper's case a and of the first millisecond of b and c (`tests/data/truth`), computed by another
//! program in high precision; and that a run compared with itself, sampled otherwise, is the same.
//!
//! Needs `octave-cli`.

mod compared;

use compared::{Outcome, Trial, data, number};
use std::path::Path;
use std::process::Command;

/// Shipped cases with certified references, until when they are held against these (s), and the
/// digits that they must have with their own settings: what they had, less one to three for luck,
/// the more the more chaotic.
const SHIPPED: [(&str, &str, &str); 7] = [
    ("four-bar-ideal", "0.012", "13"),
    ("four-bar-a", "0.024", "6"),
    ("four-bar-a-friction", "0.012", "4"),
    ("four-bar-b", "0.012", "3"),
    ("four-bar-c", "0.012", "2"),
    ("journal-in-bearing", "0.06", "6.5"),
    ("pendulum", "2", "9.5"),
];

#[test]
fn every_shipped_case_has_the_digits_it_should_have() {
    let trial = Trial::new();
    for (case, until, digits) in SHIPPED {
        let run = trial.run(case, "theirs.h5", &[&format!("run.duration={until}")]);
        let reference = data(&format!("certified/{case}.h5"));
        let gate = ["--common-times", "--until", until, "--require-digits", digits];
        let outcome = trial.compare(&run, &reference, &gate);
        assert_eq!(outcome.code, 0, "{case}: {}{}", outcome.out, outcome.err);
    }
}

#[test]
fn certified_references_agree_with_the_truth_that_another_program_computed() {
    let trial = Trial::new();
    for (case, until) in [("four-bar-a", "0.024"), ("four-bar-b", "0.001"), ("four-bar-c", "0.001")]
    {
        let certified = data(&format!("certified/{case}.h5"));
        let truth = data(&format!("truth/{case}.csv"));
        // angles of 2 rad are written to 2.2e-16
        let outcome =
            trial.compare(&certified, &truth, &["--until", until, "--require-digits", "15"]);
        assert_eq!(outcome.code, 0, "{case}: {}{}", outcome.out, outcome.err);
    }
}

#[test]
fn a_certified_reference_is_run_again_in_its_own_arithmetic() {
    let trial = Trial::new();
    let sampled = ["run.duration=0.001", "run.sample_interval=1.3e-5"];
    let run = trial.run("four-bar-c", "theirs.h5", &sampled);
    let gate = ["--until", "0.001", "--require-digits", "8"];
    let outcome = trial.compare(&run, &data("certified/four-bar-c.h5"), &gate);
    assert_eq!(outcome.code, 0, "{}{}", outcome.out, outcome.err);
    assert!(outcome.out.contains("11 of its own samples came out"), "{}", outcome.out);
    assert!(outcome.out.contains("certified  the reference, to 15."), "{}", outcome.out);
}

#[test]
fn a_run_that_falls_short_is_told_where() {
    let trial = Trial::new();
    let run = trial.run("four-bar-a", "theirs.h5", &["run.duration=0.003"]);
    let truth = data("truth/four-bar-a.csv");
    let outcome = trial.compare(&run, &truth, &["--until", "0.003", "--require-digits", "12"]);
    assert_eq!(outcome.code, 1);
    // 1e-12 holds 12 digits for some steps only: the first sample of the truth behind 0 is at 0.1 ms
    assert!(outcome.err.contains("from 0.0001 s on, where "), "{}", outcome.err);
    let json = trial.json(&run, &truth, &["--until", "0.003", "--require-digits", "12"]);
    assert_eq!(json["requirement"]["met"], false);
    assert_eq!(json["gate"]["holds"][0]["first_below"], 1e-4);
}

#[test]
fn the_digits_told_are_those_of_the_error_against_the_truth() {
    let trial = Trial::new();
    let run = trial.run("four-bar-a", "theirs.h5", &["run.duration=0.01"]);
    let truth = data("truth/four-bar-a.csv");
    let json = trial.json(&run, &truth, &["--common-times"]);
    let last = json["times"].as_array().unwrap().len() - 1;
    assert_eq!(json["times"][last], 0.01);
    // the last row of the truth up to 10 ms is row 100; column 3 is the coupler's angle
    let text = std::fs::read_to_string(&truth).unwrap();
    let line = text.lines().nth(101).unwrap();
    let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
    let file = freeplay::record::ResultFile::open(&run).unwrap();
    let of = |name: &str| *file.column(name).unwrap().last().unwrap();
    let angles = [("angle.coupler", cells[3]), ("angle.follower", cells[6])];
    let error = angles.map(|(name, truth)| (of(name) - truth).abs());
    let expected = -error[0].max(error[1]).log10();
    let angle = json["quantities"].as_array().unwrap().iter().find(|q| q["name"] == "angle");
    let told = number(&angle.unwrap()["digits"][last]);
    // half a unit in the last place of the truth, 5.6e-17, is counted as error
    assert!((told - expected).abs() < 1e-4, "{told} {expected}");
}

#[test]
fn the_same_run_sampled_otherwise_agrees_to_the_last_bit() {
    let trial = Trial::new();
    let short = "run.duration=0.002";
    for case in ["four-bar-b", "four-bar-a-friction", "pendulum", "journal-in-bearing"] {
        let reference = trial.run(case, "reference.h5", &[short]);
        let theirs = trial.run(case, "theirs.h5", &[short, "run.sample_interval=7.3e-6"]);
        let json = trial.json(&theirs, &reference, &["--forces"]);
        assert_eq!(json["reference_at"], "run_again", "{case}");
        assert_eq!(json["identical"], "compared", "{case}: {}", json["gate"]["fewest"]);
        assert_eq!(json["events"]["first_unmatched"], serde_json::Value::Null, "{case}");
    }
}

#[test]
fn a_mechanism_without_freedom_is_had_at_other_times_too() {
    let trial = Trial::new();
    let short = "run.duration=0.002";
    let reference = trial.run("four-bar-ideal", "reference.h5", &[short]);
    let theirs = trial.run("four-bar-ideal", "theirs.h5", &[short, "run.sample_interval=7.3e-6"]);
    // assembled from another neighbour, the last bits may differ
    let outcome = trial.compare(&theirs, &reference, &["--forces", "--require-digits", "13"]);
    assert_eq!(outcome.code, 0, "{}{}", outcome.out, outcome.err);
}

#[test]
fn a_file_and_its_copy_agree_in_everything() {
    let trial = Trial::new();
    let run = trial.run("four-bar-a", "run.h5", &["run.duration=0.002"]);
    let outcome = trial.compare(&run, &run, &[]);
    assert!(outcome.out.contains("agree to the last bit of every number."), "{}", outcome.out);
    let short = trial.run("four-bar-a", "short.h5", &["run.duration=0.001"]);
    let outcome = trial.compare(&short, &run, &[]);
    // a shorter run takes other steps at its very end, and has fewer numbers
    assert!(!outcome.out.contains("of every number."), "{}", outcome.out);
}

#[test]
fn a_run_that_ends_early_falls_short_unless_no_more_is_asked_for() {
    let trial = Trial::new();
    let reference = trial.run("four-bar-a", "run.h5", &["run.duration=0.002"]);
    let short = trial.run("four-bar-a", "short.h5", &["run.duration=0.001"]);
    let gate = |more: &[&str]| {
        let arguments = [&["--require-digits", "6"], more].concat();
        trial.compare(&short, &reference, &arguments)
    };
    let outcome = gate(&[]);
    assert_eq!(outcome.code, 1);
    assert!(outcome.err.contains("ends at 0.001 s"), "{}", outcome.err);
    assert_eq!(gate(&["--until", "0.0015"]).code, 1);
    assert_eq!(gate(&["--until", "0.001"]).code, 0);
    // nor may it go on behind the reference
    let outcome = trial.compare(&reference, &short, &[]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.err.contains("--until 0.001"), "{}", outcome.err);
    assert_eq!(trial.compare(&reference, &short, &["--until", "0.0011"]).code, 2);
    assert_eq!(trial.compare(&reference, &short, &["--until", "0.001"]).code, 0);
}

#[test]
fn a_reference_that_does_not_come_out_again_is_not_trusted() {
    let trial = Trial::new();
    let reference = trial.run("four-bar-a", "reference.h5", &["run.duration=0.001"]);
    let theirs =
        trial.run("four-bar-a", "theirs.h5", &["run.duration=0.001", "run.sample_interval=7e-6"]);
    assert_eq!(trial.compare(&theirs, &reference, &[]).code, 0);
    compared::change(&reference, "angle", |values| values[150] += 1e-13);
    let outcome = trial.compare(&theirs, &reference, &[]);
    assert_eq!(outcome.code, 4, "{}", outcome.out);
    assert!(outcome.err.contains("angle.crank at 0.0005 s"), "{}", outcome.err);
    assert!(outcome.err.contains("--common-times"), "{}", outcome.err);
    // 0, the 14 multiples of 7e-6 and 1e-5 within a millisecond, and its end
    let json = trial.json(&theirs, &reference, &["--common-times"]);
    assert_eq!(json["samples"], 16);
}

#[test]
fn what_is_no_number_agrees_with_nothing() {
    let trial = Trial::new();
    let reference = trial.run("four-bar-a", "reference.h5", &["run.duration=0.001"]);
    compared::change(&reference, "angular_velocity", |values| values[3 * 40 + 1] = f64::NAN);
    let outcome = trial.compare(&reference, &reference, &["--require-digits", "0.1"]);
    assert_eq!(outcome.code, 1, "{}", outcome.out);
    assert!(outcome.err.contains("4e-4 s") || outcome.err.contains("0.0004 s"), "{}", outcome.err);
    assert!(!outcome.out.contains("last bit"), "{}", outcome.out);
    let json = trial.json(&reference, &reference, &[]);
    assert_eq!(json["identical"], "no");
    assert_eq!(json["gate"]["fewest"]["digits"], serde_json::Value::Null);
}

#[test]
fn a_certified_reference_grants_no_more_than_its_certificate_and_brings_its_scales() {
    let trial = Trial::new();
    let reference = trial.run("four-bar-a", "reference.h5", &["run.duration=0.001"]);
    let copy = trial.path("copy.h5");
    std::fs::copy(&reference, &copy).unwrap();
    let digits: Vec<f64> = (0..=100).map(|k| if k < 50 { 22.0 } else { 5.25 }).collect();
    compared::add(&reference, "reference_digits", &digits);
    compared::add_attribute(&reference, "scale_angular_velocity", 1e3);
    compared::add_attribute(&reference, "scale_clearance_0", 2e-3);
    let json = trial.json(&copy, &reference, &[]);
    assert_eq!(json["certified_digits"], 5.25);
    assert_eq!(json["gate"]["fewest"]["digits"], 5.25);
    assert_eq!(json["gate"]["fewest"]["at_least"], true);
    assert_eq!(json["gate"]["holds"][2]["first_below"], 5e-4);
    let scale = |quantity: usize| &json["quantities"][quantity]["columns"][0]["scale"];
    assert_eq!((number(scale(1)), number(scale(3))), (1e3, 2e-3));
    let outcome = trial.compare(&copy, &reference, &["--require-digits", "6"]);
    assert_eq!(outcome.code, 1);
    let told = "at 0.0005 s the reference itself is certified to 5.2 digits only";
    assert!(outcome.err.contains(told), "{}", outcome.err);
    assert_eq!(trial.compare(&copy, &reference, &["--require-digits", "5.2"]).code, 0);
}

#[test]
fn forces_count_only_where_asked_for() {
    let trial = Trial::new();
    let reference = trial.run("four-bar-a", "reference.h5", &["run.duration=0.001"]);
    let copy = trial.path("copy.h5");
    std::fs::copy(&reference, &copy).unwrap();
    // 0.52 ms is within the first contact
    compared::change(&copy, "drive_torque", |values| values[52] *= 1.5);
    let gate = ["--require-digits", "12"];
    assert_eq!(trial.compare(&copy, &reference, &gate).code, 0);
    let outcome = trial.compare(&copy, &reference, &["--forces", "--require-digits", "12"]);
    assert_eq!(outcome.code, 1);
    assert!(outcome.err.contains("drive_torque.crank"), "{}", outcome.err);
}

#[test]
fn a_csv_file_has_the_digits_that_it_is_written_with() {
    let trial = Trial::new();
    let reference = trial.run("four-bar-a", "reference.h5", &["run.duration=0.001"]);
    let file = freeplay::record::ResultFile::open(&reference).unwrap();
    let (times, angles) = (file.times().unwrap(), file.column("angle.coupler").unwrap());
    let mut text = "t (ms);coupler_angle [deg];remark\n".to_owned();
    for (time, angle) in times.iter().zip(&angles) {
        text += &format!("{:.17e};{:.6};fine\n", time * 1e3, angle.to_degrees());
    }
    let theirs = trial.write("theirs.csv", &text);
    let json = trial.json(&theirs, &reference, &["--common-times"]);
    assert_eq!(json["samples"], 101);
    assert_eq!(json["theirs"]["mapping"][0]["how"], "guessed");
    // rounded to 5e-7 degrees, which is 8.7e-9 rad
    let fewest = number(&json["gate"]["fewest"]["digits"]);
    assert!((8.05..8.6).contains(&fewest), "{fewest}");
    let noted = json["notes"][0].as_str().unwrap();
    assert!(noted.contains("8 significant digits"), "{noted}");
}

#[test]
fn angles_that_look_like_degrees_and_times_that_stand_twice_are_told() {
    let trial = Trial::new();
    let reference = trial.run("four-bar-a", "reference.h5", &["run.duration=0.001"]);
    // the coupler starts at 0.698 rad
    let theirs = trial.write("theirs.csv", "t,angle.coupler\n0,39.97\n0,39.97\n1e-4,39.44\n");
    let json = trial.json(&theirs, &reference, &[]);
    let notes = json["notes"].to_string();
    assert!(notes.contains("in degrees") && notes.contains("1 times more than once"), "{notes}");
    let json = trial.json(&theirs, &reference, &["--map", "angle.coupler[deg]=angle.coupler"]);
    assert!(number(&json["gate"]["fewest"]["digits"]) > 3.0, "{}", json["gate"]);
    assert!(!json["notes"].to_string().contains("in degrees"));
}

#[test]
fn a_matlab_file_is_graded_at_its_own_times() {
    let trial = Trial::new();
    let reference = trial.run("four-bar-a", "reference.h5", &["run.duration=0.001"]);
    let sampled = ["run.duration=0.001", "run.sample_interval=1.7e-5"];
    let ours = trial.run("four-bar-a", "ours.h5", &sampled);
    let file = freeplay::record::ResultFile::open(&ours).unwrap();
    let names = ["angle.coupler", "angular_velocity.coupler", "clearance_x.A"];
    let columns = names.map(|name| file.column(name).unwrap());
    let theirs = trial.path("theirs.mat");
    compared::write_matlab(&theirs, &file.times().unwrap(), &columns);
    let maps = ["--map", "y(:,1)=angle.coupler", "--map", "y(:,2)=angular_velocity.coupler"];
    let more = ["--map", "y(:,3)=clearance_x.A", "--require-digits", "12"];
    let outcome = trial.compare(&theirs, &reference, &[&maps[..], &more[..]].concat());
    assert_eq!(outcome.code, 0, "{}{}", outcome.out, outcome.err);
    assert!(outcome.out.contains("MATLAB 7.3"), "{}", outcome.out);
    assert!(outcome.out.contains("was run again"), "{}", outcome.out);
}

#[test]
fn an_octave_script_of_case_a_has_two_digits_behind_its_first_contact() {
    let trial = Trial::new();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/examples/four_bar_a.m");
    let ran = Command::new("octave-cli").arg(script).current_dir(trial.folder()).output();
    let ran = ran.unwrap_or_else(|error| panic!("cannot start octave-cli: {error}"));
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let theirs = trial.path("four_bar_a.csv");
    let reference = data("certified/four-bar-a.h5");
    let maps = [
        "x3=position_x.coupler",
        "y3=position_y.coupler",
        "theta3=angle.coupler",
        "x4=position_x.follower",
        "y4=position_y.follower",
        "theta4=angle.follower",
        "vx3=velocity_x.coupler",
        "vy3=velocity_y.coupler",
        "omega3=angular_velocity.coupler",
        "vx4=velocity_x.follower",
        "vy4=velocity_y.follower",
        "omega4=angular_velocity.follower",
        "ex=clearance_x.A",
        "ey=clearance_y.A",
    ];
    let arguments: Vec<&str> = maps.iter().flat_map(|map| ["--map", map]).collect();
    let json = trial.json(&theirs, &reference, &arguments);
    assert_eq!(json["reference_at"], "run_again");

    // ode15s at 1e-10 is good for eight digits until the first contact, at 0.4798 ms; Octave finds
    // the event by a straight line, and three digits are all that is left within that contact
    let hold = |digits: f64| {
        let holds = json["gate"]["holds"].as_array().unwrap();
        holds.iter().find(|hold| hold["digits"] == digits).unwrap()
    };
    for digits in [6.0, 3.0] {
        let lost = number(&hold(digits)["first_below"]);
        assert!((4.797e-4..5.8e-4).contains(&lost), "{digits} digits: {lost}");
    }
    let free = flight_digits(&json);
    assert!(free > 7.5 && free < 9.5, "{free}");
    let fewest = number(&json["gate"]["fewest"]["digits"]);
    assert!(fewest < 1.5, "{fewest}");

    // what is told of the angle at the end is the error against the truth
    let last = json["times"].as_array().unwrap().len() - 1;
    let cell = |path: &Path, line: usize, column: usize| -> f64 {
        let text = std::fs::read_to_string(path).unwrap();
        text.lines().nth(line).unwrap().split(',').nth(column).unwrap().parse().unwrap()
    };
    let truth = data("truth/four-bar-a.csv");
    let error = |column: usize| (cell(&theirs, last + 1, column) - cell(&truth, 21, column)).abs();
    let expected = -error(3).max(error(6)).log10();
    let told = number(&json["quantities"][0]["digits"][last]);
    assert!((told - expected).abs() < 1e-3, "{told} {expected}");
}

/// Fewest digits of the gate before the first contact of case a.
fn flight_digits(json: &serde_json::Value) -> f64 {
    let times = json["times"].as_array().unwrap().iter().map(number);
    let digits = json["gate"]["digits"].as_array().unwrap().iter().map(number);
    let flight = times.zip(digits).filter(|(time, _)| *time < 4.797e-4);
    flight.map(|(_, digits)| digits).fold(f64::INFINITY, f64::min)
}

#[test]
fn bad_input_is_told_and_ends_with_two() {
    let trial = Trial::new();
    let reference = trial.run("four-bar-a", "reference.h5", &["run.duration=0.001"]);
    let row = "0.7,-92.4";
    for (text, word) in [
        ("t,x,y\n0,1,2\n", "known to be of ours"),
        ("angle.coupler,angular_velocity.coupler\n0.7,-92.4\n", "column of times"),
        (&format!("t,angle.coupler,coupler_omega\n0,{row}\n1e-4,0.7,fast\n"), "line 3: \"fast\""),
        (&format!("t,angle.coupler,coupler_omega\n0,{row}\n1e-4,0.7\n"), "line 3: 2 fields"),
        (&format!("t,angle.coupler,coupler_omega\n1e-4,{row}\n0,{row}\n"), "not sorted"),
        (&format!("t,angle.coupler,coupler_omega\n0,{row}\n2e-3,{row}\n"), "--until 0.001"),
        (&format!("t,angle.coupler,coupler_omega\n-1e-3,{row}\n"), "covers 0 s"),
        (&format!("t,angle.coupler,coupler_omega\nnan,{row}\n"), "time 1 is NaN"),
        ("t,angle.coupler\n", "no rows"),
        ("", "no rows"),
        ("0,0.7\n1,0.8\n", "no line of names"),
        ("t;angle.coupler\n0,0;0,7\n", "the decimal sign is a point"),
        ("t,angle.coupler [mm]\n0,0.7\n", "known to be of ours"),
    ] {
        let theirs = trial.write("theirs.csv", text);
        check_bad(&trial.compare(&theirs, &reference, &[]), word);
    }
    let theirs = trial.write("theirs.csv", "t,x\n0,0.7\n");
    for (map, word) in [
        ("x=angle.cuopler", "did you mean \"angle.coupler\""),
        ("phi=angle.coupler", "no column \"phi\""),
        ("x=normal_force.A", "--forces"),
        ("x[mm]=angle.coupler", "in mm"),
    ] {
        check_bad(&trial.compare(&theirs, &reference, &["--map", map]), word);
    }
    check_bad(&trial.compare(&theirs, &theirs, &[]), "neither");
    check_bad(&trial.compare(&reference, &reference, &["--map", "x=time"]), "--map");
    for arguments in [["--require-digits", "16"], ["--require-digits", "nan"], ["--until", "-1"]] {
        check_bad(&trial.compare(&reference, &reference, &arguments), arguments[0]);
    }
}

#[test]
fn damaged_and_foreign_files_are_told_and_end_with_two() {
    let trial = Trial::new();
    let reference = trial.run("four-bar-a", "reference.h5", &["run.duration=0.001"]);
    let bytes = std::fs::read(&reference).unwrap();
    for (length, word) in [(bytes.len() / 2, "cut short"), (60, "cut short"), (3, "neither")] {
        let theirs = trial.write_bytes("theirs.h5", &bytes[..length]);
        check_bad(&trial.compare(&theirs, &reference, &[]), word);
        check_bad(&trial.compare(&reference, &theirs, &[]), word);
    }
    let old = trial.write_bytes("old.mat", b"MATLAB 5.0 MAT-file, Platform: GLNXA64");
    check_bad(&trial.compare(&old, &reference, &[]), "-v7.3");
    check_bad(&trial.compare(&trial.path("none.csv"), &reference, &[]), "none.csv");
    let other = trial.run("four-bar-b", "b.h5", &["run.duration=0.001"]);
    check_bad(&trial.compare(&other, &reference, &[]), "clearances are A, B and A");
    let wider = ["run.duration=0.001", "joints.A.clearance.radial=0.0011"];
    let other = trial.run("four-bar-a", "wider.h5", &wider);
    check_bad(&trial.compare(&other, &reference, &[]), "radial is 0.0011 and 0.001");
}

fn check_bad(outcome: &Outcome, word: &str) {
    assert_eq!(outcome.code, 2, "{word}: {}{}", outcome.out, outcome.err);
    assert!(
        outcome.err.starts_with("error: ") && outcome.err.contains(word),
        "{word}: {}",
        outcome.err
    );
    assert!(outcome.out.is_empty(), "{}", outcome.out);
}

/// A table of our own columns at some of the times of a result.
fn table(result: &Path, columns: &[&str], keep: impl Fn(usize) -> bool) -> String {
    let file = freeplay::record::ResultFile::open(result).unwrap();
    let values: Vec<Vec<f64>> = columns.iter().map(|name| file.column(name).unwrap()).collect();
    let mut text = format!("time,{}\n", columns.join(","));
    for (row, time) in file.times().unwrap().iter().enumerate().filter(|(row, _)| keep(*row)) {
        let cells = values.iter().map(|column| format!(",{:e}", column[row]));
        text += &format!("{time:e}{}\n", cells.collect::<String>());
    }
    text
}

#[test]
fn rows_that_are_missing_are_told_and_can_be_required() {
    let trial = Trial::new();
    let reference = trial.run("four-bar-a", "reference.h5", &["run.duration=0.0009"]);
    let columns = ["angle.coupler", "angular_velocity.coupler", "clearance_x.A"];
    let all = trial.write("all.csv", &table(&reference, &columns, |_| true));
    let gate = ["--require-digits", "9"];
    let outcome = trial.compare(&all, &reference, &gate);
    assert_eq!((outcome.code, &*outcome.err), (0, ""), "{}", outcome.out);
    assert!(outcome.out.contains("coverage   all of the time; 3 of 10 columns"), "{}", outcome.out);
    for keep in [(|row| !(30..60).contains(&row)) as fn(usize) -> bool, |row| row % 3 != 1] {
        let some = trial.write("some.csv", &table(&reference, &columns, keep));
        let outcome = trial.compare(&some, &reference, &gate);
        assert_eq!(outcome.code, 0, "{}", outcome.err);
        assert!(outcome.err.contains("warning: ") && outcome.err.contains("nothing between"));
        assert!(outcome.out.contains("note: rows are missing"), "{}", outcome.out);
        let outcome =
            trial.compare(&some, &reference, &[&gate[..], &["--require-times", "0.9"]].concat());
        assert_eq!(outcome.code, 1, "{}", outcome.out);
        assert!(outcome.err.contains("falls short of 90.0 % of the time"), "{}", outcome.err);
        let json = trial.json(&some, &reference, &["--require-times", "0.6"]);
        assert_eq!(json["requirement"]["met"], true);
        let share = number(&json["coverage"]["time"]);
        assert!((0.63..0.70).contains(&share), "{share}");
    }
    let columns = |share| trial.compare(&all, &reference, &["--require-columns", share]);
    assert_eq!(columns("0.3").code, 0);
    let outcome = columns("0.31");
    assert_eq!(outcome.code, 1);
    assert!(outcome.err.contains("31.0 % of the columns: it covers all of the time; 3 of 10"));
    check_bad(&columns("1.1"), "--require-columns");
}

#[test]
fn digits_of_what_drives_prescribe_are_no_digits_of_the_motion() {
    let trial = Trial::new();
    let reference = trial.run("four-bar-a", "reference.h5", &["run.duration=0.001"]);
    let theirs = trial.write("theirs.csv", &table(&reference, &["angle.crank"], |_| true));
    let outcome = trial.compare(&theirs, &reference, &[]);
    assert_eq!(outcome.code, 0);
    assert!(outcome.out.contains("note: nothing of "), "{}", outcome.out);
    let outcome = trial.compare(&theirs, &reference, &["--require-digits", "6"]);
    assert_eq!(outcome.code, 1, "{}", outcome.out);
    assert!(outcome.err.contains("prescribed by drives"), "{}", outcome.err);
}

#[test]
fn the_same_number_written_otherwise_is_the_same_mechanism() {
    let trial = Trial::new();
    let reference = trial.run("four-bar-a", "reference.h5", &["run.duration=0.0005"]);
    let set = ["run.duration=0.0005", "drives.crank.speed_rpm=5e3", "bodies.coupler.mass=737e-4"];
    let theirs = trial.run("four-bar-a", "theirs.h5", &set);
    let json = trial.json(&theirs, &reference, &[]);
    assert_eq!(json["identical"], "everything");
}

/// The joint force at A is zero until the first contact, at 0.48 ms, and so is the torque.
#[test]
fn forces_that_are_zero_but_for_rounding_agree() {
    let trial = Trial::new();
    let short = ["run.duration=0.0004"];
    let run = trial.run("four-bar-a", "run.h5", &short);
    let explicit = ["run.duration=0.0004", "solver.engine=explicit", "solver.precision=71"];
    let truth = trial.run("four-bar-a", "truth.h5", &explicit);
    let json = trial.json(&run, &truth, &["--forces"]);
    let fewest = number(&json["gate"]["fewest"]["digits"]);
    assert!(fewest > 8.0, "{}", json["gate"]["fewest"]);
}

#[test]
fn a_certified_reference_that_was_changed_is_refused() {
    let trial = Trial::new();
    let certified = data("certified/four-bar-a.h5");
    let copy = trial.path("copy.h5");
    std::fs::copy(&certified, &copy).unwrap();
    let untouched = trial.compare(&certified, &copy, &["--common-times", "--until", "0.001"]);
    assert_eq!(untouched.code, 0, "{}", untouched.err);
    assert!(!untouched.out.contains("sealed"), "{}", untouched.out);
    compared::change(&copy, "angle", |values| values[50] += 1e-9);
    check_bad(&trial.compare(&certified, &copy, &[]), "changed after it was certified");
    compared::remove_attribute(&copy, "certificate_sha256");
    let outcome = trial.compare(&certified, &copy, &["--common-times"]);
    assert!(outcome.out.contains("its certificate is not sealed"), "{}", outcome.out);
}
