//! What `scripts/paper.sh` is made of: the table of the force in joint A, and the start with closed
//! joints. Known in advance: the force on the journal in A of the ideal four-bar at t = 0, and that
//! a clearance of 0.15 mm gives case a 1.40 from its second revolution on.
//!
//! Needs the Python of `tests/post_processing.rs`.

mod written;

use std::path::Path;
use std::process::Command;
use written::{Run, freeplay, python, root, said_by};

/// What a script of the project prints.
fn script(name: &str, arguments: &[&str]) -> String {
    said_by(Command::new(python()).arg(root().join("scripts").join(name)).args(arguments))
}

/// Summaries of cases a, b and c, five revolutions each, in a folder. `set` is done to each joint
/// with clearance.
fn summarise(ideal: &Run, set: Option<&str>, folder: &Path) {
    std::fs::create_dir_all(folder).unwrap();
    for (case, joints) in [("a", &["A"][..]), ("b", &["A", "B"]), ("c", &["A", "B", "B0"])] {
        let case = format!("four-bar-{case}");
        let set = set.iter().flat_map(|change| {
            joints.iter().map(move |joint| format!("joints.{joint}.clearance.{change}"))
        });
        let mut set: Vec<String> = set.collect();
        set.push("run.sample_interval=1e-3".into());
        let run = Run::of(&case, &set.iter().map(String::as_str).collect::<Vec<_>>());
        let [ideal, run] = [ideal, &run].map(|run| run.path.to_str().unwrap());
        let summary = freeplay(&["summary", run, "--against", ideal, "--json"]);
        assert!(summary.status.success());
        std::fs::write(folder.join(case).with_extension("json"), summary.stdout).unwrap();
    }
}

/// Ratios of the force in A by revolution, from a summary.
fn ratios(folder: &Path, case: &str) -> Vec<f64> {
    let text = std::fs::read(folder.join(format!("four-bar-{case}.json"))).unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&text).unwrap();
    let revolutions = summary["columns"]["joint_force.A"]["revolutions"].as_array().unwrap();
    revolutions.iter().map(|part| part["ratio"]["largest"].as_f64().unwrap()).collect()
}

#[test]
fn the_table_says_of_each_revolution_what_the_summary_says() {
    let ideal = Run::of("four-bar-ideal", &["run.sample_interval=1e-3"]);
    let folder = tempfile::tempdir().unwrap();
    let reading = folder.path().join("readings/small");
    summarise(&ideal, None, folder.path());
    summarise(&ideal, Some("radial=1.5e-4"), &reading);
    let arguments = [folder.path().to_str().unwrap(), "small|a small clearance|radial=1.5e-4|"];
    let table = script("paper_table.py", &arguments);
    assert!(table.contains("over that of the ideal mechanism, 892.92 N"), "{table}");

    let mut rows = table.lines().skip_while(|line| !line.starts_with('─')).skip(1);
    for (folder, words) in [(folder.path(), "as printed"), (&reading, "a small clearance")] {
        for (case, claimed) in [("a", "1.4"), ("b", "3.7"), ("c", "5.2")] {
            let row = rows.next().unwrap();
            assert_eq!(row.starts_with(words), case == "a", "{row}");
            let fields: Vec<&str> = row.split_whitespace().rev().collect();
            let mut expected = ratios(folder, case);
            assert_eq!(expected.len(), 5);
            expected.push(expected.iter().copied().fold(0.0, f64::max));
            let expected: Vec<String> = expected.iter().rev().map(|x| format!("{x:.2}")).collect();
            assert_eq!(fields[1..7], expected, "{row}");
            assert_eq!(fields[7..9], [claimed, case], "{row}");
        }
    }
    assert!(ratios(&reading, "a")[1..].iter().all(|ratio| (ratio - 1.40).abs() < 0.01));
    let verdict = table.lines().filter(|line| line.starts_with("a small clearance")).nth(1);
    assert!(verdict.unwrap().ends_with("  nearer"), "{table}");
}

#[test]
fn a_closed_start_carries_the_ideal_force_on_the_loaded_side() {
    let ideal = Run::of("four-bar-ideal", &["run.duration=0.0001"]);
    let case = root().join("cases/four-bar-c.toml");
    let arguments = [ideal.path.to_str().unwrap(), case.to_str().unwrap()];
    for how in ["touching", "pressed"] {
        let poses = script("closed_start.py", &[arguments[0], arguments[1], how]);
        let mut set: Vec<&str> = poses.lines().collect();
        set.push("run.duration=0.0001");
        let run = Run::of("four-bar-c", &set);
        let (run, ideal) = (run.file(), ideal.file());
        for joint in ["A", "B", "B0"] {
            let first = |file: &freeplay::record::ResultFile, column: &str| {
                file.column(&format!("{column}.{joint}")).unwrap()[0]
            };
            let [e_x, e_y] = ["clearance_x", "clearance_y"].map(|column| first(&run, column));
            let [f_x, f_y] = ["joint_force_x", "joint_force_y"].map(|name| first(&ideal, name));
            let (e, f) = (e_x.hypot(e_y), f_x.hypot(f_y));
            assert!((e_x * f_x + e_y * f_y + e * f).abs() < 1e-9 * e * f, "{how} {joint}");
            let expected = if how == "pressed" { f } else { 0.0 };
            // a rounding of the poses (1e-17 m) is 1e-12 of the depth
            let force = first(&run, "normal_force");
            assert!((force - expected).abs() < 1e-9 * f, "{how} {joint}: {force}, not {expected}");
            assert!((e - 1e-3 < 1e-15) == (how == "touching"), "{how} {joint}: {e}");
        }
    }
    let known = 659.250_046_286_129_9_f64.hypot(343.766_091_505_429_6); // N, in A, exact
    let [x, y] = ["joint_force_x.A", "joint_force_y.A"].map(|c| ideal.file().column(c).unwrap()[0]);
    assert!((x.hypot(y) - known).abs() < 1e-12 * known);
}
