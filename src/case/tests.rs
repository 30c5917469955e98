use super::*;
use crate::model::{JointKind, NormalLawName, StiffnessDescription, Tension};
use crate::scalar::Decimal;
use std::fs;
use std::path::PathBuf;

const FOUR_BAR_A: &str = include_str!("../../cases/four-bar-a.toml");

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
    let JointKind::Revolute { clearance } = &d.joints[1].kind;
    let clearance = clearance.as_ref().unwrap();
    assert_eq!(clearance.normal.law, NormalLawName::LankaraniNikravesh);
    assert_eq!(clearance.normal.stiffness, StiffnessDescription::HertzPrinted);
    assert_eq!(clearance.normal.exponent.to_string(), "1.5");
    assert_eq!(clearance.tension, Tension::Keep);
    assert_eq!(clearance.minimum_impact_rate.to_string(), "1e-3");
    assert_eq!(d.joints[0].kind, JointKind::Revolute { clearance: None });
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
fn a_complaint_tells_line_key_unit_and_value() {
    let line = line_of("bearing_radius");
    assert_eq!(
        complaints_after("bearing_radius = 0.010", "bearing_radius = -0.01"),
        [format!("line {line}, joints.A.clearance.bearing_radius: must be positive (m), is -0.01")]
    );
}

#[test]
fn the_error_names_the_file_first() {
    let error = read(&FOUR_BAR_A.replacen("0.0737", "0.0", 1)).unwrap_err().to_string();
    assert!(error.starts_with("cases/x.toml does not describe a mechanism\n  line "), "{error}");
}

#[test]
fn all_complaints_come_at_once_in_the_order_of_the_file() {
    let text = FOUR_BAR_A
        .replacen("duration        = 0.060", "duration = 0", 1)
        .replacen("mass    = 0.0737", "mass = \"light\"", 1)
        .replacen("radial         = 0.001", "radail = 0.001", 1)
        .replacen("\"coupler.B\", \"follower.B\"", "\"coupler.B\", \"folower.B\"", 1)
        .replacen("angle     = 0.0", "angle = nan", 1);
    let error = read(&text).unwrap_err().to_string();
    let lines: Vec<&str> = error.lines().skip(1).map(str::trim).collect();
    let clearance = line_of("[joints.A.clearance]");
    let between = line_of("between = [\"coupler.B\"");
    assert_eq!(
        lines,
        [
            format!(
                "line {}, bodies.coupler.mass: must be a number (kg), is a string",
                line_of("mass    = 0.0737")
            ),
            format!(
                "line {clearance}, joints.A.clearance.radial: is missing; it must be a number (m)"
            ),
            format!(
                "line {}, joints.A.clearance.radail: unknown key (did you mean \"radial\"?)",
                line_of("radial ")
            ),
            format!(
                "line {between}, joints.B.between: connects \"coupler.B\" to \"folower.B\"; there is no body \"folower\" (did you mean \"follower\"?)"
            ),
            format!(
                "line {}, drives.crank.angle: must be finite (rad), is nan",
                line_of("angle  ")
            ),
            format!("line {}, run.duration: must be positive (s), is 0", line_of("duration")),
        ]
    );
}

/// Each bad input: what is replaced in four-bar-a, by what, and the one complaint it gives.
const BAD: &[(&str, &str, &str)] = &[
    // names
    (
        "name  = \"four-bar-a\"",
        "name = \"a/b\"",
        "name: must be of letters, digits, \"-\", \"_\" and \".\", beginning with a letter, digit or \"_\", is \"a/b\"; the default is the file's name without its ending",
    ),
    ("name  = \"four-bar-a\"", "name = 3", "name: must be a string, is a number"),
    (
        "[drives.crank]",
        "[drives.\"my crank\"]",
        "drives.\"my crank\": the name \"my crank\" must be a letter or underscore, then letters, digits and underscores",
    ),
    (
        "[ground]\n",
        "[bodies.ground]\nmass = 1\ninertia = 1\n[ground]\n",
        "bodies.ground: no body may be called \"ground\": that is the fixed frame",
    ),
    // bodies
    ("mass    = 0.3 ", "mass = -1e-400 ", "bodies.crank.mass: must be positive (kg), is -1e-400"),
    ("mass    = 0.3 ", "mass = inf ", "bodies.crank.mass: must be finite (kg), is inf"),
    (
        "mass    = 0.3 ",
        "mass = true ",
        "bodies.crank.mass: must be a number (kg), is true or false",
    ),
    (
        "mass    = 0.3 ",
        "mass = [0.3] ",
        "bodies.crank.mass: must be a number (kg), is an array of 1",
    ),
    (
        "mass    = 0.3 ",
        "mass = 2024-01-01 ",
        "bodies.crank.mass: must be a number (kg), is a date or time",
    ),
    ("mass    = 0.3 ", "", "bodies.crank.mass: is missing; it must be a number (kg)"),
    ("inertia = 1.82e-4", "inertia = 0", "bodies.crank.inertia: must be positive (kg m²), is 0"),
    (
        "inertia = 1.82e-4",
        "inertia = 1.82e-4\ncolour = \"red\"",
        "bodies.crank.colour: unknown key; known here: mass, inertia, points",
    ),
    (
        "A = [0.015, 0.0] }",
        "A = [0.015, nan] }",
        "bodies.crank.points.A: must be finite (m), is nan",
    ),
    (
        "A = [0.015, 0.0] }",
        "A = [0.015] }",
        "bodies.crank.points.A: must be two numbers [x, y] (m), is an array of 1",
    ),
    (
        "A = [0.015, 0.0] }",
        "A = [0.015, \"0\"] }",
        "bodies.crank.points.A: must be two numbers [x, y] (m), is an array of 2",
    ),
    (
        "A = [-0.09, 0.0], B",
        "A = [-0.09, 0.0], 2A = [0, 0], B",
        "bodies.coupler.points.2A: the name \"2A\" must be a letter or underscore, then letters, digits and underscores",
    ),
    // joints
    (
        "[joints.B0]\nkind    = \"revolute\"",
        "[joints.B0]\nkind = \"revolut\"",
        "joints.B0.kind: must be \"revolute\", is \"revolut\" (did you mean \"revolute\"?)",
    ),
    (
        "[joints.B0]\nkind    = \"revolute\"",
        "[joints.B0]\nkind = \"pin-slot\"\naxis = [1, 0]",
        "joints.B0.kind: must be \"revolute\", is \"pin-slot\"",
    ),
    (
        "[joints.B0]\nkind    = \"revolute\"",
        "[joints.B0]",
        "joints.B0.kind: is missing; it must be \"revolute\"",
    ),
    (
        "\"coupler.B\", \"follower.B\"",
        "\"coupler.B\", \"coupler.A\"",
        "joints.B.between: connects \"coupler.B\" to \"coupler.A\"; a joint cannot join a body to itself",
    ),
    (
        "\"coupler.B\", \"follower.B\"",
        "\"coupler.B\", \"follower.C\"",
        "joints.B.between: connects \"coupler.B\" to \"follower.C\"; body \"follower\" has no point \"C\"",
    ),
    (
        "\"ground.B0\", \"follower.B0\"",
        "\"ground.B\", \"follower.B0\"",
        "joints.B0.between: connects \"ground.B\" to \"follower.B0\"; the ground has no point \"B\" (did you mean \"B0\"?)",
    ),
    (
        "\"coupler.B\", \"follower.B\"",
        "\"coupler\", \"follower.B\"",
        "joints.B.between: connects \"coupler\" to \"follower.B\"; \"coupler\" is not written body.point",
    ),
    (
        "\"coupler.B\", \"follower.B\"",
        "\"coupler.B\"",
        "joints.B.between: must be two points [\"body.point\", \"body.point\"], is an array of 1",
    ),
    // clearance and laws
    (
        "radial         = 0.001",
        "radial = 0.01",
        "joints.A.clearance.radial: must be less than bearing_radius, 0.010 (m), is 0.01",
    ),
    (
        "radial         = 0.001",
        "radial = 0.001\ntension = \"pull\"",
        "joints.A.clearance.tension: must be \"keep\" or \"cut\", is \"pull\"",
    ),
    (
        "radial         = 0.001",
        "radial = 0.001\nminimum_impact_rate = 0",
        "joints.A.clearance.minimum_impact_rate: must be positive (m/s), is 0",
    ),
    (
        "\"lankarani-nikravesh\"",
        "\"hertz\"",
        "joints.A.clearance.normal.restitution: law \"hertz\" takes no restitution",
    ),
    (
        "\"lankarani-nikravesh\"",
        "\"lankarani\"",
        "joints.A.clearance.normal.law: must be \"lankarani-nikravesh\" or \"hertz\", is \"lankarani\" (did you mean \"lankarani-nikravesh\"?)",
    ),
    (
        "restitution = 0.9, ",
        "",
        "joints.A.clearance.normal.restitution: is missing; law \"lankarani-nikravesh\" needs it",
    ),
    (
        "restitution = 0.9",
        "restitution = 1.1",
        "joints.A.clearance.normal.restitution: must be greater than 0 and at most 1, is 1.1",
    ),
    (
        "\"hertz-printed\"",
        "\"hertz\"",
        "joints.A.clearance.normal.stiffness: must be a number (N/mⁿ) or \"hertz-printed\" or \"hertz-internal\", is \"hertz\" (did you mean \"hertz-printed\"?)",
    ),
    (
        "\"hertz-printed\", young = 207e9, poisson = 0.3",
        "-1",
        "joints.A.clearance.normal.stiffness: must be positive (N/mⁿ), is -1",
    ),
    (
        "\"hertz-printed\", young = 207e9, poisson = 0.3",
        "1e10, young = 1",
        "joints.A.clearance.normal.young: is not used where stiffness is a number",
    ),
    (
        ", young = 207e9",
        "",
        "joints.A.clearance.normal.young: is missing (Pa); stiffness \"hertz-printed\" needs it",
    ),
    ("young = 207e9", "young = 0", "joints.A.clearance.normal.young: must be positive (Pa), is 0"),
    (
        "poisson = 0.3",
        "poisson = 0.6",
        "joints.A.clearance.normal.poisson: must be greater than -1 and at most 0.5, is 0.6",
    ),
    (
        "poisson = 0.3",
        "poisson = 0.3, exponent = 0.5",
        "joints.A.clearance.normal.exponent: must be at least 1, is 0.5",
    ),
    (
        "coefficient = 0.0",
        "coefficient = -0.1",
        "joints.A.clearance.friction.coefficient: must be zero or positive, is -0.1",
    ),
    (
        "v0 = 1e-3",
        "v0 = 1e-2",
        "joints.A.clearance.friction.v1: must be greater than v0, 1e-2 (m/s), is 1e-2",
    ),
    (
        "v0 = 1e-3",
        "v0 = -1e-3",
        "joints.A.clearance.friction.v0: must be zero or positive (m/s), is -1e-3",
    ),
    (
        "\"ambrosio\"",
        "\"coulomb\"",
        "joints.A.clearance.friction.law: must be \"ambrosio\", is \"coulomb\"",
    ),
    // drives, loads, start
    (
        "joint     = \"A0\"",
        "joint = \"A1\"",
        "drives.crank.joint: there is no joint \"A1\" (did you mean \"A0\"?)",
    ),
    (
        "[start]",
        "[drives.other]\njoint = \"A0\"\nspeed_rpm = 1\n[start]",
        "drives.other.joint: drive \"crank\" drives joint \"A0\" already",
    ),
    (
        "speed_rpm = 5000.0",
        "speed_rpm = inf",
        "drives.crank.speed_rpm: must be finite (revolutions a minute), is inf",
    ),
    (
        "[start]",
        "[loads.g]\nkind = \"gravity\"\nacceleration = [0, -inf]\n[start]",
        "loads.g.acceleration: must be finite (m/s²), is -inf",
    ),
    (
        "[start]",
        "[loads.g]\nkind = \"wind\"\nspeed = 3\n[start]",
        "loads.g.kind: must be \"gravity\", is \"wind\"",
    ),
    (
        "follower = { angle",
        "folower = { angle",
        "start.folower: there is no body \"folower\" (did you mean \"follower\"?)",
    ),
    (
        "follower = { angle = 1.84 }",
        "follower = { angle = inf }",
        "start.follower.angle: must be finite (rad), is inf",
    ),
    (
        "follower = { angle = 1.84 }",
        "follower = { fixed = true }",
        "start.follower.fixed: holds nothing: name a coordinate or a velocity beside it",
    ),
    (
        "follower = { angle = 1.84 }",
        "follower = 1.84",
        "start.follower: must be a table, is a number",
    ),
    // run and solver
    (
        "sample_interval = 1e-5",
        "sample_interval = 1e-12",
        "run.sample_interval: is too small (s), 1e-12: a run of 0.060 s would write 6.000e10 rows of samples, at most 1e8 are written",
    ),
    (
        "sample_interval = 1e-5",
        "sample_interval = -1",
        "run.sample_interval: must be positive (s), is -1",
    ),
    ("duration        = 0.060", "duration = inf", "run.duration: must be finite (s), is inf"),
    (
        "sample_interval = 1e-5",
        "sample_interval = 1e-5\nsampling = \"dense\"",
        "run.sampling: must be \"uniform\" or \"adaptive\", is \"dense\"",
    ),
    (
        "engine             = \"ida\"",
        "engine = \"idas\"",
        "solver.engine: must be \"ida\" or \"explicit\", is \"idas\" (did you mean \"ida\"?)",
    ),
    (
        "relative_tolerance = 1e-12",
        "relative_tolerance = 1e-16",
        "solver.relative_tolerance: must be at least 1e-15 and less than 1, is 1e-16",
    ),
    (
        "absolute_tolerance = 1e-20",
        "absolute_tolerance = 0",
        "solver.absolute_tolerance: must be greater than 0 and less than 1, is 0.0",
    ),
    (
        "absolute_tolerance = 1e-20",
        "absolute_tolerance = \"scald\"",
        "solver.absolute_tolerance: must be a number or \"scaled\", is \"scald\" (did you mean \"scaled\"?)",
    ),
    (
        "initial_step       = 1e-10",
        "initial_step = 0",
        "solver.initial_step: must be positive (s), is 0.0",
    ),
    (
        "initial_step       = 1e-10",
        "max_step = -inf",
        "solver.max_step: must be finite (s), is -inf",
    ),
    (
        "initial_step       = 1e-10",
        "precision = 34",
        "solver.precision: must be 16 or 71 (digits), is 34",
    ),
    (
        "initial_step       = 1e-10",
        "precision = 71",
        "solver.precision: 71 digits need engine \"explicit\"",
    ),
    (
        "initial_step       = 1e-10",
        "norm = \"max\"",
        "solver.norm: must be \"ode15s\" or \"wrms\", is \"max\"",
    ),
    ("[solver]", "[solvr]", "solvr: unknown key (did you mean \"solver\"?)"),
];

#[test]
fn each_bad_input_gives_its_one_complaint() {
    for (old, new, expected) in BAD {
        let complaints = complaints_after(old, new);
        let [complaint] = complaints.as_slice() else { panic!("{new:?} gives {complaints:#?}") };
        let (line, message) = complaint.split_once(", ").expect("a complaint tells its line");
        assert!(line.strip_prefix("line ").unwrap().parse::<usize>().is_ok(), "{complaint}");
        assert_eq!(message, *expected);
    }
}

#[test]
fn the_line_is_that_of_the_replaced_text() {
    for (old, new, _) in BAD.iter().filter(|(_, new, _)| !new.is_empty() && !new.contains('\n')) {
        let at = FOUR_BAR_A.find(old).unwrap();
        let (before, inside) = (FOUR_BAR_A[..at].lines().count(), old.lines().count());
        let complaints = complaints_after(old, new);
        let line = complaints[0].split([' ', ',']).nth(1).unwrap().parse::<usize>().unwrap();
        assert!((before..=before + inside).contains(&line), "{new:?}: {line} is not {before}");
    }
}

#[test]
fn an_empty_file_lacks_bodies_and_run() {
    let error = read("").unwrap_err().to_string();
    assert_eq!(
        error,
        "cases/x.toml does not describe a mechanism\n  \
         run: is missing; it must be a table\n  \
         bodies: there must be at least one body"
    );
}

#[test]
fn a_file_s_stem_that_is_no_name_asks_for_a_name() {
    let text = FOUR_BAR_A.replacen("name  = \"four-bar-a\"\n", "", 1);
    let named = |path: &str| Case::from_text(Path::new(path), &text, &Changes::default());
    assert_eq!(named("runs/case-7.toml").unwrap().name, "case-7");
    let error = named("runs/my case.toml").unwrap_err().to_string();
    assert!(
        error.contains("\n  name: must be of letters") && error.contains("\"my case\""),
        "{error}"
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
    assert!(matches!(read(&write("huge", &vec![b'#'; 2 << 20])), Error::TooLarge { .. }));
    assert!(matches!(read(&write("zeros", &[0; 64])), Error::Syntax { line: 1, .. }));
}

#[test]
fn a_set_key_is_read_and_stands_in_the_text_as_run() {
    let set =
        ["joints.A.clearance.radial=0.00015", "solver.engine=explicit", "solver.precision=71"];
    let case = Case::from_text(Path::new("a.toml"), FOUR_BAR_A, &changes(&set, false)).unwrap();
    let JointKind::Revolute { clearance } = &case.description.joints[1].kind;
    assert_eq!(clearance.as_ref().unwrap().radial.to_string(), "0.00015");
    assert_eq!(case.plan.solver.engine, EngineName::Explicit);
    assert_eq!(case.plan.solver.precision, Precision::Octuple);
    let radial = format!("radial         = 0.00015{}# m, radial clearance c\n", " ".repeat(34));
    assert!(case.text.contains(&radial), "the comment stays:\n{}", case.text);
    assert_eq!(case.text.lines().count(), FOUR_BAR_A.lines().count() + 1);
    let again = read(&case.text).unwrap();
    assert_eq!((again.description, again.plan), (case.description, case.plan));
}

#[test]
fn tables_that_a_set_key_needs_are_made() {
    let text = &FOUR_BAR_A[..FOUR_BAR_A.find("[run]").unwrap()];
    let set = [
        "run.duration=1e-3",
        "run.sample_interval=1e-5",
        "joints.B.clearance={bearing_radius=0.01,radial=0.001,normal={law=\"hertz\",stiffness=1e9}}",
        "bodies.coupler.points.C=[0, 0.1]",
        "loads.g.kind=gravity",
        "loads.g.acceleration=[0, -9.81]",
    ];
    let case = Case::from_text(Path::new("a.toml"), text, &changes(&set, false)).unwrap();
    assert_eq!(case.plan.duration.to_string(), "1e-3");
    assert_eq!(case.description.bodies[1].points[2].name, "C");
    assert_eq!(case.description.loads.len(), 1);
    assert!(matches!(case.description.joints[2].kind, JointKind::Revolute { clearance: Some(_) }));
}

#[test]
fn complaints_about_set_keys_name_the_option() {
    for (set, expected) in [
        (
            "joints.A.clearance.radial=-1",
            "--set joints.A.clearance.radial: must be positive (m), is -1",
        ),
        (
            "joints.A.clearance.radial=small",
            "--set joints.A.clearance.radial: must be a number (m), is a string",
        ),
        ("solver.tolerance=1", "--set solver.tolerance: unknown key"),
        (
            "bodies.rod.mass=1",
            "--set bodies.rod.mass, bodies.rod.inertia: is missing; it must be a number (kg m²)",
        ),
        (
            "drives.crank={}",
            "--set drives.crank, drives.crank.joint: is missing; it must be a string",
        ),
        (
            "name.first=1",
            "--set name.first: cannot be set: \"name\" is no table but a value (string)",
        ),
    ] {
        let complaints = complaints_with(&[set]);
        assert!(complaints[0].starts_with(expected), "{set} gives {complaints:#?}");
    }
}

#[test]
fn what_is_no_override_is_refused() {
    for (text, expected) in [
        ("radial", "\"radial\" is not KEY=VALUE"),
        ("=1", "\"\" is not a dotted key"),
        ("a..b=1", "\"a..b\" is not a dotted key"),
        ("run.duration=", "\"\" is neither a TOML value nor a word"),
        ("run.duration=[1", "\"[1\" is neither"),
        ("run.duration=1\nb=2", "is neither"),
    ] {
        let error = text.parse::<Override>().unwrap_err().to_string();
        assert!(error.contains(expected), "{text}: {error}");
    }
}

#[test]
fn ideal_removes_every_clearance_and_nothing_else() {
    let ideal = changes(&[], true);
    for file in case_files() {
        let case = Case::read(&file, &ideal).unwrap();
        assert!(!case.text.contains("clearance]"), "{}", case.text);
        let mut expected = Case::read(&file, &Changes::default()).unwrap().description;
        for joint in &mut expected.joints {
            joint.kind = JointKind::Revolute { clearance: None };
        }
        assert_eq!(case.description, expected);
    }
}

#[test]
fn later_complaints_find_their_lines() {
    let case = read(FOUR_BAR_A).unwrap();
    let key = KeyPath::new(["drives", "crank", "speed_rpm"]);
    let complaint = Complaint { key, message: "does not fit".into() };
    let error = case.reject(vec![complaint]).to_string();
    let line = line_of("speed_rpm");
    assert!(error.ends_with(&format!("  line {line}, drives.crank.speed_rpm: does not fit")));
}

mod whatever_is_read {
    use super::*;
    use proptest::prelude::*;

    fn read_bytes(bytes: &[u8]) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.toml");
        fs::write(&path, bytes).unwrap();
        if let Err(error) = Case::read(&path, &Changes::default()) {
            assert!(!error.to_string().is_empty());
        }
    }

    /// A piece of text that a case may hold, sensible or not.
    fn piece() -> impl Strategy<Value = String> {
        const KNOWN: &[&str] = &[
            "[",
            "]",
            "{}",
            "=",
            ".",
            ",",
            "\"",
            "\n",
            "#",
            "nan",
            "inf",
            "-1",
            "1e-400",
            "0x7f",
            "true",
            "\r\n",
            "é",
            "\u{feff}",
            "ground",
            "crank.A",
            "[[bodies]]\n",
            "'''",
        ];
        prop_oneof![prop::sample::select(KNOWN).prop_map(str::to_owned), ".{0,3}"]
    }

    proptest! {
        #[test]
        fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            read_bytes(&bytes);
        }

        #[test]
        fn a_mutated_case_never_panics(
            edits in prop::collection::vec((any::<prop::sample::Index>(), 0..30usize, piece()), 1..4)
        ) {
            let mut text: Vec<char> = FOUR_BAR_A.chars().collect();
            for (at, removed, piece) in edits {
                let at = at.index(text.len());
                let end = (at + removed).min(text.len());
                text.splice(at..end, piece.chars());
            }
            let text: String = text.into_iter().collect();
            if let Err(error) = read(&text) {
                prop_assert!(error.to_string().lines().count() > 1);
            }
        }

        #[test]
        fn any_key_can_be_set_and_the_text_as_run_says_the_same(
            key in prop::sample::select(vec![
                "name", "title", "ground", "ground.points", "ground.points.C", "bodies", "bodies.rod",
                "bodies.crank.mass", "joints", "joints.A", "joints.A.clearance", "joints.B.clearance.radial",
                "joints.A.clearance.normal.law", "drives.crank.angle", "loads.g.kind", "start.crank.angle",
                "run", "run.sampling", "solver.norm", "new", "new.table.key", "\"odd key\".x",
            ]),
            value in prop::sample::select(vec![
                "1", "0.5", "word", "[0, 1]", "{}", "{a = 1}", "\"\"\"two\nlines\"\"\"", "true", "inf",
            ]),
            dotted in any::<bool>(),
            ideal in any::<bool>(),
        ) {
            let text = if dotted {
                FOUR_BAR_A.replace("[bodies.crank]\nmass ", "[bodies]\ncrank.mass ").replace(
                    "inertia = 1.82e-4 ", "crank.inertia = 1.82e-4 ",
                )
            } else {
                FOUR_BAR_A.to_owned()
            };
            let text = if dotted { text.replacen("\npoints  = { A0 = [-", "\ncrank.points = { A0 = [-", 1) } else { text };
            let changes = changes(&[&format!("{key}={value}")], ideal);
            match Case::from_text(Path::new("x.toml"), &text, &changes) {
                Ok(case) => {
                    let again = read(&case.text).unwrap();
                    prop_assert_eq!(again.description, case.description);
                    prop_assert_eq!(again.plan, case.plan);
                }
                Err(Error::NotAMechanism { .. }) => {}
                Err(other) => prop_assert!(false, "{}", other),
            }
        }
    }
}
