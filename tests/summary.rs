//! Summaries of whole runs. Known in advance: the extremes of the ideal four-bar (exact), the
//! largest contact forces of case a from a trajectory with 25 true digits, a journal that circles
//! in permanent contact, the force in the pivot of a pendulum.

#[expect(dead_code, reason = "what files must hold is another test's matter")]
mod recorded;
mod written;

use freeplay::post::{Basis, Extreme, Reference, Summary};
use recorded::Recorded;
use serde_json::Value;
use std::path::Path;
use std::process::Output;
use written::{Run, alone, root};

fn summary_of(run: &Run) -> Summary {
    Summary::of(&run.file(), None).unwrap()
}

fn largest(summary: &Summary, column: &str) -> Extreme {
    summary.run.of(column).unwrap().total.largest.unwrap()
}

fn smallest(summary: &Summary, column: &str) -> Extreme {
    summary.run.of(column).unwrap().total.smallest.unwrap()
}

/// Column, whether the largest, exact value, crank angle and how well that is known (deg). The
/// forces and the torque come from REFERENCES, the angles of the accelerations from the loop's
/// closed form.
const IDEAL: [(&str, bool, f64, f64, f64); 9] = [
    ("joint_force.A", true, 892.919_148_289_516_8, 25.553_105_473, 1e-5),
    ("joint_force.B", true, 270.866_700_169_031_97, 16.595_022_157, 1e-5),
    ("joint_force.B0", true, 221.253_366_195_472_56, 17.183_163_789, 1e-5),
    ("drive_torque.crank", true, 8.546_033_500_222_641, 67.811_635_886, 1e-5),
    ("drive_torque.crank", false, -10.728_744_092_094_293, 353.674_427_453, 1e-5),
    ("angular_acceleration.coupler", true, 34_341.781_235_740_41, 97.0253, 1e-3),
    ("angular_acceleration.coupler", false, -60_236.420_364_200_44, 307.240, 1e-3),
    ("angular_acceleration.follower", true, 86_935.319_530_799_12, 27.481, 1e-3),
    ("angular_acceleration.follower", false, -57_437.471_891_476_07, 211.783, 1e-3),
];

#[test]
fn the_ideal_extremes_are_true_however_coarse_the_samples() {
    for interval in ["1e-5", "3e-3", "0.0071"] {
        let run = Run::of("four-bar-ideal", &[&format!("run.sample_interval={interval}")]);
        let summary = summary_of(&run);
        let turning = summary.turning.as_ref().unwrap();
        for (column, is_largest, exact, angle, known) in IDEAL {
            let of = if is_largest { largest } else { smallest };
            let found = of(&summary, column);
            let error = (found.value / exact - 1.0).abs();
            assert!(error < 1e-12, "{column} at {interval}: {found:?} is off by {error:e}");
            assert_eq!(found.basis, Basis::Evaluated);
            let at = turning.angle(found.time).to_degrees();
            assert!((at - angle).abs() < known, "{column}: at {at}, not {angle} deg");
        }
    }
}

#[test]
fn every_whole_revolution_of_the_ideal_mechanism_is_like_the_first() {
    let summary = summary_of(&Run::of("four-bar-ideal", &["run.duration=0.0535"]));
    for (quantity, tally) in &summary.run.quantities {
        assert_eq!(tally.revolutions.len(), 5);
        let [first, .., last] = &tally.revolutions[..] else { panic!("five revolutions") };
        assert!(last.magnitude() <= first.magnitude().map(|x| x * (1.0 + 1e-12)));
        for revolution in &tally.revolutions[..4] {
            for (a, b) in
                [(first.largest, revolution.largest), (first.smallest, revolution.smallest)]
            {
                let (a, b) = (a.map(|x| x.value), b.map(|x| x.value));
                let Some((a, b)) = a.zip(b) else { continue };
                assert!((a - b).abs() <= 1e-12 * a.abs(), "{quantity:?}: {a} and {b}");
            }
        }
    }
}

/// Largest peak force (N) of case a in the first two revolutions, from the trajectory with 25
/// true digits.
const PEAKS_OF_A: [f64; 2] = [13_321.945_353_778_703, 7_106.440_236_066_858];

#[test]
fn the_force_of_a_joint_with_clearance_peaks_between_the_samples() {
    // every tenth of a millisecond, while the contacts take 40 µs or more
    let summary =
        summary_of(&Run::of("four-bar-a", &["run.duration=0.024", "run.sample_interval=1e-4"]));
    let force = summary.run.of("joint_force.A").unwrap();
    for (revolution, exact) in force.revolutions.iter().zip(PEAKS_OF_A) {
        let found = revolution.largest.unwrap();
        assert_eq!(found.basis, Basis::Peak);
        // 7.8 digits at 12 ms, 7.6 at 24 ms (docs/numerics.md)
        assert!((found.value / exact - 1.0).abs() < 1e-6, "{found:?}, not {exact}");
    }
    assert!(summary.unresolved_contacts > 0);
}

#[test]
fn the_largest_ratio_of_case_a_is_that_of_exact_arithmetic() {
    let summary = summary_of(&Run::of("four-bar-a", &[]));
    assert!(matches!(summary.reference, Ok(Reference::Ideal(_))));
    let (quantity, tally) = summary
        .run
        .quantities
        .iter()
        .find(|(of, _)| of.name(&summary.run.names) == "joint_force.A")
        .unwrap();
    let [ratio, _] = summary.ratios(*quantity, &tally.total);
    assert!((ratio.unwrap() - 15.2).abs() < 0.05, "{ratio:?}");
    // in the third revolution, where doubles still have seven digits
    let [third, _] = summary.ratios(*quantity, &tally.revolutions[2]);
    assert_eq!(third, ratio);
    let reference = summary.reference_of(*quantity).unwrap().largest.unwrap();
    assert!((reference.value / IDEAL[0].2 - 1.0).abs() < 1e-12);
}

#[test]
fn contacts_flights_and_dissipation_account_for_the_run() {
    let run = Run::of("four-bar-c", &["run.duration=0.018"]);
    let summary = summary_of(&run);
    let file = run.file();
    let contacts = file.contacts().unwrap();
    let mut dissipated = 0.0;
    for (k, joint) in summary.contacts.iter().enumerate() {
        let flags = file.table("in_contact").unwrap().column(k);
        let sampled = flags.iter().sum::<f64>() / flags.len() as f64;
        // a contact begins and ends up to a sample away from where the samples show it
        let slack = 2.0 * joint.count as f64 / flags.len() as f64;
        assert!((joint.share.unwrap() - sampled).abs() < slack, "{}: {sampled}", joint.joint);
        let by_revolution: usize = joint.revolutions.iter().map(|part| part.count).sum();
        assert_eq!(joint.count, contacts.iter().filter(|c| c.clearance == k).count());
        assert_eq!(by_revolution, joint.count);
        dissipated += joint.dissipated;
    }
    let energy = summary.energy.unwrap();
    assert!((dissipated / energy.dissipated - 1.0).abs() < 1e-12);
    let balance = energy.stored + energy.dissipated - energy.drive_work - energy.load_work;
    assert!((balance - energy.residual).abs() < 1e-12 * energy.largest_kinetic);
}

#[test]
fn extremes_do_not_depend_on_the_samples() {
    let short = "run.duration=0.006";
    let coarse = summary_of(&Run::of("four-bar-a-friction", &[short, "run.sample_interval=1e-3"]));
    let fine = Run::of("four-bar-a-friction", &[short, "run.sample_interval=1e-6"]);
    let fine = summary_of(&fine);
    let mut found = 0;
    for (quantity, tally) in &coarse.run.quantities {
        let name = quantity.name(&coarse.run.names);
        let finer = fine.run.of(&name).unwrap().total;
        for (a, b) in [(tally.total.largest, finer.largest), (tally.total.smallest, finer.smallest)]
        {
            let (Some(a), Some(b)) = (a, b) else { continue };
            assert_eq!((a.basis, b.basis), (Basis::Peak, Basis::Peak));
            let error = (a.value - b.value).abs();
            assert!(error <= a.uncertainty.unwrap(), "{name}: {a:?}, {b:?}");
            found += 1;
        }
    }
    // three accelerations of three bodies, two forces of a clearance and a torque, with a sign, and
    // the forces of four joints
    assert_eq!(found, 2 * (3 * 3 + 2 + 1) + 4);
}

#[test]
fn with_friction_a_joint_peaks_where_the_whole_of_its_force_does() {
    let friction =
        "joints.A.clearance.friction={law=\"ambrosio\", coefficient=0.5, v0=0.0, v1=8.0}";
    let set = [friction, "run.duration=0.006", "run.sample_interval=1e-7"];
    let run = Run::of("four-bar-a", &set);
    let summary = summary_of(&run);
    let [normal, tangential] =
        ["normal_force.A", "tangential_force.A"].map(|name| run.file().column(name).unwrap());
    let samples = normal.iter().zip(&tangential).map(|(n, t)| n.hypot(*t)).fold(0.0, f64::max);
    let found = largest(&summary, "joint_force.A").value;
    assert!(found >= samples && found < samples * (1.0 + 1e-3), "{found} N, sampled {samples} N");
    assert!(largest(&summary, "normal_force.A").value < found);
    assert!(summary.to_string().contains("tangential_force.A"));
}

#[test]
fn the_time_of_the_deepest_penetration_is_its_own() {
    let run = Run::of("four-bar-a", &["run.duration=0.006"]);
    let json = summary_of(&run).to_json();
    let deepest = &json["clearances"]["A"]["largest_penetration"];
    let contacts = run.file().contacts().unwrap();
    let depth = |contact: &&freeplay::run::Contact| contact.peak_penetration;
    let contact = contacts.iter().max_by(|a, b| depth(a).total_cmp(&depth(b))).unwrap();
    assert_eq!(deepest["value"], contact.peak_penetration);
    assert_eq!(deepest["time"], contact.peak_penetration_time);
    assert!(contact.begin < contact.peak_penetration_time);
    assert!(contact.peak_penetration_time < contact.end);
}

#[test]
fn a_journal_that_circles_is_in_permanent_contact_and_has_no_revolutions() {
    let summary = summary_of(&Run::of("journal-in-bearing", &[]));
    assert!(summary.turning.is_none());
    // its ideal mechanism cannot start where the case says
    assert!(summary.reference.is_err());
    let [contacts] = &summary.contacts[..] else { panic!("one clearance") };
    let [phase] = &contacts.permanent[..] else { panic!("one phase of permanent contact") };
    assert_eq!((phase.begin, phase.end, phase.open), (0.0, 0.060, true));
    assert_eq!((contacts.share, contacts.longest_flight), (Some(1.0), None));
    // the tolerance holds the eccentricity, of which the depth is a thousandth
    let force = largest(&summary, "joint_force.O").value;
    assert!((force / 13.724_236_619_547_414 - 1.0).abs() < 1e-6, "{force}");
    let depth = contacts.deepest.unwrap().value;
    assert!((depth / 1.200_247_193_643_541e-6 - 1.0).abs() < 1e-6, "{depth}");
    assert!(summary.to_json()["against"].is_null());
    assert!(summary.to_string().contains("no ideal run"));
}

#[test]
fn the_force_in_the_pivot_of_a_pendulum_is_true_however_coarse_the_samples() {
    // m g (1 + 2 m l²/J) at the bottom
    for interval in ["1e-3", "1e-2", "1.0"] {
        let summary =
            summary_of(&Run::of("pendulum", &[&format!("run.sample_interval={interval}")]));
        let found = largest(&summary, "joint_force.O");
        let error = (found.value - 12.2625).abs();
        assert_eq!(found.basis, Basis::Peak);
        assert!(error <= found.uncertainty.unwrap(), "{interval}: {found:?}");
        assert!(summary.turning.is_none());
        assert!(matches!(summary.reference, Ok(Reference::Itself)));
    }
}

#[test]
fn a_run_is_held_against_another_by_the_names_of_its_columns() {
    let short = "run.duration=0.003";
    let (c, a) = (Run::of("four-bar-c", &[short]), Run::of("four-bar-a", &[short]));
    let (c, a) = (c.file(), a.file());
    let summary = Summary::of(&c, Some(&a)).unwrap();
    let json = summary.to_json();
    assert_eq!(json["against"]["case_name"], "four-bar-a");
    let force = &json["columns"]["joint_force.B"];
    let [ours, theirs, ratio] = [
        &force["largest"]["value"],
        &force["reference"]["largest"]["value"],
        &force["ratio"]["largest"],
    ]
    .map(|value| value.as_f64().unwrap());
    assert!((ours / theirs - ratio).abs() < 1e-15 * ratio);
    assert_eq!(theirs, largest(&Summary::of(&a, None).unwrap(), "joint_force.B").value);
    let pendulum = Run::of("pendulum", &["run.duration=0.01"]);
    let pendulum = pendulum.file();
    let refused = Summary::of(&c, Some(&pendulum)).unwrap_err();
    assert!(refused.to_string().contains("nothing in common"), "{refused}");
}

fn freeplay(arguments: &[&str], file: &Path) -> Output {
    written::freeplay(&[arguments, &[file.to_str().unwrap()]].concat())
}

#[test]
fn the_command_prints_a_table_or_json_with_units() {
    let run = Run::of("four-bar-a", &["run.duration=0.014"]);
    let table = freeplay(&["summary"], &run.path);
    assert!(table.status.success() && table.stderr.is_empty());
    let table = String::from_utf8(table.stdout).unwrap();
    for words in ["force (N)", "drive_torque.crank", "2 (part)", "permanent contact (ms)", "peak:"]
    {
        assert!(table.contains(words), "no {words:?} in\n{table}");
    }
    let json = freeplay(&["summary", "--json"], &run.path);
    let json: Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(json["units"]["time"], "s");
    for (column, unit) in [
        ("joint_force.A0", "N"),
        ("joint_force.A", "N"),
        ("drive_torque.crank", "N m"),
        ("angular_acceleration.follower", "rad/s^2"),
    ] {
        let told = &json["columns"][column];
        assert_eq!(told["unit"], unit, "{column}");
        assert!(told["ratio"]["largest"].as_f64().unwrap() > 1.0, "{column}: {told}");
        assert_eq!(told["revolutions"].as_array().unwrap().len(), 2);
    }
    assert_eq!(json["clearances"]["A"]["dissipated"]["unit"], "J");
    assert_eq!(json["revolutions"]["last_is_whole"], false);
}

#[test]
fn what_is_no_result_file_is_refused_with_exit_code_2() {
    let run = Run::of("pendulum", &["run.duration=0.01"]);
    let text = run.beside("text.h5");
    std::fs::write(&text, "no HDF5").unwrap();
    let half = run.beside("half.h5");
    let whole = std::fs::read(&run.path).unwrap();
    std::fs::write(&half, &whole[..whole.len() / 2]).unwrap();
    let missing = run.beside("missing.h5");
    for (file, words) in [(&text, "not an HDF5 file"), (&half, "cut short"), (&missing, "open")] {
        let refused = freeplay(&["summary"], file);
        let told = String::from_utf8(refused.stderr).unwrap();
        assert_eq!(refused.status.code(), Some(2), "{told}");
        assert!(told.starts_with("error: ") && told.contains(words), "{told}");
        let refused = freeplay(&["summary", run.path.to_str().unwrap(), "--against"], file);
        assert_eq!(refused.status.code(), Some(2));
    }
}

#[test]
fn files_of_arbitrary_numbers_and_of_none_are_summarised_without_an_ideal_run() {
    let folder = tempfile::tempdir().unwrap();
    let mut holes = Recorded::new(&["A", "B"], 50, 5);
    for observation in holes.observations.iter_mut().step_by(3) {
        observation.drive_torques[0] = f64::NAN;
        observation.joints[0].force[1] = f64::INFINITY;
        observation.energy.residual = f64::NAN;
    }
    let runs = [
        Recorded::new(&["A", "B"], 50, 40),
        holes,
        Recorded::new(&["A"], 1, 0),
        Recorded::new(&["A"], 0, 0),
        Recorded::new(&[], 0, 0),
    ];
    for (k, run) in runs.iter().enumerate() {
        let path = {
            let _alone = alone();
            run.write(&folder.path().join(format!("{k}.h5")), false)
        };
        for arguments in [&["summary"][..], &["summary", "--json"]] {
            let told = freeplay(arguments, &path);
            let errors = String::from_utf8(told.stderr).unwrap();
            assert!(told.status.success(), "{k}: {errors}");
            let ideal = !run.header.clearances.is_empty();
            assert_eq!(errors.contains("no ideal run"), ideal, "{k}: {errors}");
        }
        let json = freeplay(&["summary", "--json"], &path);
        let json: Value = serde_json::from_slice(&json.stdout).unwrap();
        assert_eq!(json["samples"], run.observations.len());
        assert!(json["revolutions"].is_null());
    }
}

#[test]
fn a_certified_reference_says_why_it_has_no_extremes_by_revolution() {
    let path = root().join("tests/data/certified/four-bar-a.h5");
    let said = freeplay(&["summary"], &path);
    let said = String::from_utf8(said.stdout).unwrap();
    assert!(said.contains("A certified reference keeps no extremes by revolution"), "{said}");
}
