//! Tests of reading whole case files.

mod anything;
mod changes;
mod complaints;

use super::*;
use crate::contact::elastic::ElasticLaw;
use crate::model::{Model, Tension};
use crate::scalar::Decimal;
use std::fs;
use std::path::PathBuf;

const FOUR_BAR_A: &str = include_str!("../../../cases/four-bar-a.toml");

fn case_files() -> Vec<PathBuf> {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases");
    let mut files: Vec<PathBuf> =
        fs::read_dir(cases).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

fn changes(set: &[&str], ideal: bool) -> Changes {
    Changes { set: set.iter().map(|text| text.parse().unwrap()).collect(), ideal }
}

fn read(text: &str) -> Result<Case, Error> {
    Case::from_text(Path::new("cases/x.toml"), text, &Changes::default())
}

/// The lines of complaint about four-bar-a after one replacement.
fn complaints_after(old: &str, new: &str) -> Vec<String> {
    assert!(FOUR_BAR_A.contains(old), "the case has no {old:?}");
    let error = read(&FOUR_BAR_A.replacen(old, new, 1)).expect_err("the case is bad");
    error.to_string().lines().skip(1).map(|line| line.trim().to_owned()).collect()
}

/// The lines of complaint about four-bar-a with keys set.
fn complaints_with(set: &[&str]) -> Vec<String> {
    let path = Path::new("four-bar-a.toml");
    let error = Case::from_text(path, FOUR_BAR_A, &changes(set, false)).expect_err("it is bad");
    error.to_string().lines().skip(1).map(|line| line.trim().to_owned()).collect()
}

fn line_of(text: &str) -> usize {
    1 + FOUR_BAR_A.lines().position(|line| line.starts_with(text)).unwrap()
}

#[test]
fn every_case_file_reads_and_is_named_like_its_file() {
    let files = case_files();
    assert!(files.len() >= 7, "{files:?}");
    for file in files {
        let case = Case::read(&file, &Changes::default()).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(case.name, file.file_stem().unwrap().to_str().unwrap());
        assert_eq!(case.text, fs::read_to_string(&file).unwrap());
        assert!(!case.title.is_empty());
    }
}

#[test]
fn the_paper_s_case_a_is_read_as_it_is_written() {
    let case = read(FOUR_BAR_A).unwrap();
    let d = &case.description;
    let names: Vec<&str> = d.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["crank", "coupler", "follower"]);
    assert_eq!(d.bodies[1].mass.to_string(), "0.0737");
    assert_eq!(d.bodies[1].points[0].at[0].to_string(), "-0.09");
    let clearance = d.joints[1].clearance.as_ref().unwrap();
    assert_eq!(clearance.normal.law.word(), "lankarani-nikravesh");
    assert!(clearance.normal.elastic.is("power"));
    assert_eq!(clearance.normal.elastic.text("stiffness"), "hertz-printed");
    assert_eq!(clearance.normal.elastic.number::<f64>("exponent"), 1.5);
    assert_eq!(clearance.tension, Tension::Keep);
    assert_eq!(clearance.minimum_impact_rate.to_string(), "1e-3");
    assert!(d.joints[0].part.is("revolute") && d.joints[0].clearance.is_none());
    assert_eq!(case.plan.duration.to_string(), "0.060");
    assert_eq!(case.plan.solver.absolute_tolerance, AbsoluteTolerance::Scalar(1e-20));
    assert_eq!(case.plan.solver.max_step, f64::INFINITY);
    assert_eq!(case.plan.solver.precision, Precision::Double);
}

#[test]
fn defaults_taken_are_told() {
    let case = read(FOUR_BAR_A).unwrap();
    let told: Vec<String> =
        case.defaults.iter().map(|taken| format!("{} = {}", taken.key, taken.value)).collect();
    for expected in [
        "joints.A.clearance.tension = \"keep\"",
        "joints.A.clearance.minimum_impact_rate = 1e-3",
        "joints.A.clearance.maximum_penetration = 0.5",
        "joints.A.clearance.normal.elastic = \"power\"",
        "joints.A.clearance.normal.exponent = 1.5",
        "drives.crank.kind = \"speed\"",
        "solver.norm = \"ode15s\"",
        "run.sampling = \"uniform\"",
    ] {
        assert!(told.iter().any(|line| line == expected), "{expected} is not in {told:#?}");
    }
}

#[test]
fn a_case_without_solver_gets_the_documented_defaults() {
    let text = &FOUR_BAR_A[..FOUR_BAR_A.find("[solver]").unwrap()];
    let solver = read(text).unwrap().plan.solver;
    assert_eq!(solver, read(FOUR_BAR_A).unwrap().plan.solver);
    assert_eq!(solver.reference_tolerance, 1e-60);
}

#[test]
fn integers_are_numbers_whatever_their_base() {
    for (written, meant) in [("1", "1"), ("0x10", "16"), ("0b11", "3"), ("1_000", "1000")] {
        let text = FOUR_BAR_A.replacen("mass    = 0.3 ", &format!("mass = {written}"), 1);
        assert_eq!(read(&text).unwrap().description.bodies[0].mass, Decimal::new(meant).unwrap());
    }
}

#[test]
fn materials_are_one_or_two_with_the_bearing_s_first() {
    let stiffness = |materials: &str| {
        let text = FOUR_BAR_A.replacen("young = 207e9, poisson = 0.3", materials, 1);
        Model::<f64>::new(&read(&text).unwrap().description).unwrap().clearances()[0]
            .normal
            .elastic()
            .power()
            .unwrap()
            .0
    };
    let steel = stiffness("young = 207e9, poisson = 0.3");
    assert_eq!(stiffness("young = [207e9, 207e9], poisson = [0.3, 0.3]"), steel);
    assert_eq!(stiffness("young = [207e9, 207e9], poisson = 0.3"), steel);
    // (4/3) √(9/1900) / (0.91/207e9 + 0.8844/110e9), the contact of steel and bronze
    let mixed = 7.379_004_134_935_793e9;
    for materials in [
        "young = [207e9, 110e9], poisson = [0.3, 0.34]",
        "young = [110e9, 207e9], poisson = [0.34, 0.3]",
    ] {
        let found = stiffness(materials);
        assert!((found - mixed).abs() < 4.0 * f64::EPSILON * mixed, "{materials}: {found}");
    }
    assert!(
        stiffness("young = [207e9, 110e9], poisson = [0.34, 0.3]") < 0.992 * mixed,
        "each has its own ν"
    );
}

#[test]
fn what_is_no_toml_is_refused_with_its_line() {
    for (old, new, expected) in [
        ("mass    = 0.3 ", "mass = ", "is not TOML\n  line "),
        ("inertia = 1.82e-4", "mass = 0.4", "duplicate key"),
        ("mass    = 0.3 ", "mass = 1e999 ", "overflow"),
        ("mass    = 0.3 ", "mass = 99999999999999999999 ", "overflow"),
    ] {
        let error = read(&FOUR_BAR_A.replacen(old, new, 1)).unwrap_err();
        let Error::Syntax { line, .. } = &error else { panic!("{error}") };
        let at = FOUR_BAR_A[..FOUR_BAR_A.find(old).unwrap()].lines().count() + 1;
        assert_eq!(*line, at, "{error}");
        assert!(error.to_string().contains(expected), "{error}");
    }
}

#[test]
fn files_that_are_no_case_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let read = |path: &Path| Case::read(path, &Changes::default()).unwrap_err();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    };
    assert!(matches!(read(&folder.path().join("none.toml")), Error::Unreadable { .. }));
    assert!(matches!(read(folder.path()), Error::Unreadable { .. }));
    assert!(matches!(read(&write("b", b"a = 1\n\xff\xfe")), Error::NotText { line: 2, .. }));
    assert!(matches!(read(&write("huge", &vec![b'#'; 17 << 20])), Error::TooLarge { .. }));
    assert!(matches!(read(&write("zeros", &[0; 64])), Error::Syntax { line: 1, .. }));
}
