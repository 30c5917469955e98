use super::runs::Runs;
use super::touching::{contacts, history, normal_force};
use super::*;
use crate::case::{Case, Changes};
use crate::record::{Ending, Outcome, Writer};
use crate::simulate::{self, Simulation};
use std::ops::ControlFlow;
use std::path::Path;

/// Runs a case of the project with some keys changed, and opens its result file.
fn simulated(case: &str, changes: &[&str], ideal: bool) -> ResultFile {
    let set = changes.iter().map(|change| change.parse().unwrap()).collect();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases").join(format!("{case}.toml"));
    let case = Case::read(&path, &Changes { set, ideal }).unwrap();
    let simulation = Simulation::new(&case).unwrap();
    let header = simulate::header(&case, simulation.mechanism(), String::new());
    let folder = tempfile::tempdir().unwrap();
    let mut writer = Writer::create(&folder.path().join("run.h5"), header, false).unwrap();
    let (_, ran) = simulation.run(&mut writer, &mut |_| ControlFlow::Continue(()));
    ran.unwrap();
    let ending = Ending {
        outcome: Outcome::Complete,
        counts: Vec::new(),
        rulings: Vec::new(),
        finished_utc: String::new(),
        series: Vec::new(),
        attributes: Vec::new(),
    };
    // The file stays readable while it is open, though its folder goes.
    ResultFile::open(&writer.finish(ending).unwrap()).unwrap()
}

const COARSE: [&str; 2] = ["run.duration=0.006", "run.sample_interval=1e-4"];

fn names(figures: &[Figure]) -> Vec<&str> {
    figures.iter().map(|figure| figure.name.as_str()).collect()
}

#[test]
fn every_peak_is_in_the_curve_of_the_force_however_coarse_the_samples_are() {
    let file = simulated("four-bar-c", &COARSE, false);
    let runs = Runs::read(vec![file], &Options::default()).unwrap();
    let run = runs.shown().next().unwrap();
    assert!(run.peaks.len() > 20);
    let samples = run.samples("normal_force").unwrap();
    let mut lost_by_samples = 0;
    for clearance in 0..3 {
        let curve = normal_force(run, clearance).unwrap();
        let sampled = samples.column(clearance).into_iter().fold(0.0, f64::max);
        assert!(curve.windows(2).all(|pair| pair[0][0] <= pair[1][0]));
        for peak in run.peaks.iter().filter(|peak| peak.clearance == clearance) {
            assert!(curve.contains(&[peak.time, peak.force]), "{peak:?}");
            lost_by_samples += usize::from(peak.force > sampled);
        }
        for contact in contacts(run, clearance) {
            assert!(curve.contains(&[contact.peak_time, contact.peak_force]), "{contact:?}");
            assert!(curve.contains(&[contact.begin, 0.0]), "{contact:?}");
        }
    }
    assert!(lost_by_samples > 0);
}

#[test]
fn between_coarse_samples_a_contact_is_drawn_as_between_fine_ones() {
    let [coarse, fine] = ["1e-5", "1e-6"].map(|interval| {
        let interval = format!("run.sample_interval={interval}");
        let file = simulated("four-bar-a", &["run.duration=0.003", &interval], false);
        Runs::read(vec![file], &Options::default()).unwrap()
    });
    let run = |runs: &'_ Runs| history(runs.shown().next().unwrap(), 0).unwrap();
    let (coarse, fine) = (run(&coarse), run(&fine));
    let at = |time: f64, value: fn(&touching::Moment) -> f64| {
        let times: Vec<f64> = fine.iter().map(|moment| moment.time).collect();
        let values: Vec<f64> = fine.iter().map(value).collect();
        runs::interpolate(&times, &values, time)
    };
    // Largest values here: 1 mm, 4 m/s, 13 kN.
    for moment in coarse.iter().step_by(7) {
        let depth = moment.depth - at(moment.time, |moment| moment.depth);
        let rate = moment.rate - at(moment.time, |moment| moment.rate);
        let force = moment.force - at(moment.time, |moment| moment.force);
        assert!(depth.abs() < 2e-6 && rate.abs() < 0.1, "{moment:?} {depth} {rate}");
        assert!(force.abs() < 300.0, "{moment:?} {force}");
    }
}

#[test]
fn a_mechanism_without_clearances_has_figures_of_joints_drives_bodies_and_energy() {
    let figures = draw(vec![simulated("four-bar-c", &COARSE, true)], &Options::default()).unwrap();
    assert_eq!(
        names(&figures),
        [
            "force-A0",
            "force-A",
            "force-B",
            "force-B0",
            "torque-crank",
            "angular-acceleration-coupler",
            "angular-acceleration-follower",
            "energy",
        ]
    );
    assert!(
        figures
            .iter()
            .all(|figure| !figure.svg.contains("stroke-dasharray") || figure.name == "energy")
    );
}

#[test]
fn the_ideal_run_is_dashed_in_the_panels_of_the_others() {
    let files =
        vec![simulated("four-bar-a", &COARSE, false), simulated("four-bar-a", &COARSE, true)];
    let figures = draw(files, &Options::default()).unwrap();
    let force = figures.iter().find(|figure| figure.name == "force-A").unwrap();
    // One curve, and one sample of it in the legend.
    assert_eq!(force.svg.matches("stroke-dasharray").count(), 2);
    assert!(names(&figures).contains(&"journal-path"));
}

#[test]
fn over_the_angle_of_the_drive_histories_have_degrees() {
    let options = Options { over: Over::Angle, ..Options::default() };
    let figures = draw(vec![simulated("four-bar-a", &COARSE, false)], &options).unwrap();
    let torque = figures.iter().find(|figure| figure.name == "torque-crank").unwrap();
    // 5000 rpm for 6 ms are half a turn.
    for words in ["Angle of drive crank", "(°)", ">180<"] {
        assert!(torque.svg.contains(words), "{words}");
    }
    let undriven = draw(vec![simulated("pendulum", &[], false)], &options);
    assert!(matches!(undriven, Err(Error::NoDrive { .. })));
}

#[test]
fn a_window_of_time_leaves_out_the_rest() {
    let window =
        |from, until| Options { from: Some(from), until: Some(until), ..Options::default() };
    let file = || simulated("four-bar-a", &COARSE, false);
    let runs = Runs::read(vec![file()], &window(0.00105, 0.004)).unwrap();
    let run = runs.shown().next().unwrap();
    assert_eq!((run.times.first(), run.times.last()), (Some(&0.0011), Some(&0.004)));
    let curve = normal_force(run, 0).unwrap();
    assert!(curve.iter().all(|point| (0.0011..=0.004).contains(&point[0])));
    let empty = draw(vec![file()], &window(1.0, 2.0));
    assert!(matches!(empty, Err(Error::NoSamples { .. })));
}

#[test]
fn the_same_files_give_the_same_figures() {
    let options = Options::default();
    let [once, again] =
        [(); 2].map(|()| draw(vec![simulated("four-bar-c", &COARSE, false)], &options).unwrap());
    assert!(once == again);
    for figure in &once {
        assert!(figure.svg.len() < 200_000, "{}: {}", figure.name, figure.svg.len());
        assert!(!figure.svg.contains("NaN") && !figure.svg.contains("inf"), "{}", figure.name);
    }
}
