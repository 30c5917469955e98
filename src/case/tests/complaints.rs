//! Each kind of bad input gives its complaint, at its line.

use super::*;
use crate::contact::Damping;

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
        "joints.B0.kind: must be {joints}, is \"revolut\" (did you mean \"revolute\"?)",
    ),
    (
        "[joints.B0]\nkind    = \"revolute\"",
        "[joints.B0]\nkind = \"ball\"\naxis = [1, 0]",
        "joints.B0.kind: must be {joints}, is \"ball\"",
    ),
    (
        "[joints.B0]\nkind    = \"revolute\"",
        "[joints.B0]",
        "joints.B0.kind: is missing; it must be {joints}",
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
        "joints.A.clearance.normal.law: must be {laws}, is \"lankarani\" (did you mean \"lankarani-nikravesh\"?)",
    ),
    (
        "restitution = 0.9, ",
        "",
        "joints.A.clearance.normal.restitution: is missing; law \"lankarani-nikravesh\" needs it, or achieved_restitution",
    ),
    (
        "restitution = 0.9",
        "achieved_restitution = 0.5",
        "joints.A.clearance.normal.achieved_restitution: is 0.5, but law \"lankarani-nikravesh\" rebounds at 0.6630 of the speed or more; `freeplay laws` has others",
    ),
    (
        "restitution = 0.9",
        "restitution = 0.9, achieved_restitution = 0.9",
        "joints.A.clearance.normal.achieved_restitution: the restitution is given too: one of the two determines the law",
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
        "young = 207e9",
        "young = [207e9, -110e9]",
        "joints.A.clearance.normal.young: must be positive (Pa), is -110e9",
    ),
    (
        "young = 207e9",
        "young = [207e9, 110e9, 70e9]",
        "joints.A.clearance.normal.young: must be a number or two [bearing, journal] (Pa), is an array of 3",
    ),
    (
        "poisson = 0.3",
        "poisson = [0.6, 0.3]",
        "joints.A.clearance.normal.poisson: must be greater than -1 and at most 0.5, is 0.6",
    ),
    (
        "stiffness = \"hertz-printed\"",
        "elastic = \"jonson\"",
        "joints.A.clearance.normal.elastic: must be {elastics}, is \"jonson\" (did you mean \"johnson\"?)",
    ),
    (
        "stiffness = \"hertz-printed\"",
        "elastic = \"johnson\"",
        "joints.A.clearance.normal.length: is missing; it must be a number (m)",
    ),
    (
        "stiffness = \"hertz-printed\"",
        "elastic = \"johnson\", length = 0.0",
        "joints.A.clearance.normal.length: must be positive (m), is 0.0",
    ),
    (
        "stiffness = \"hertz-printed\"",
        "elastic = \"liu\", length = 0.015, stiffness = 1e10",
        "joints.A.clearance.normal.stiffness: unknown key; known here: law, restitution, achieved_restitution, elastic, young, poisson, length",
    ),
    (
        "\"lankarani-nikravesh\", restitution = 0.9",
        "\"kelvin-voigt\", damping = 100.0",
        "joints.A.clearance.normal.exponent: law \"kelvin-voigt\" goes with the power law and exponent 1, this is 1.5",
    ),
    (
        "\"lankarani-nikravesh\", restitution = 0.9, stiffness = \"hertz-printed\"",
        "\"kuwabara-kono\", damping = 100.0, elastic = \"johnson\", length = 0.01",
        "joints.A.clearance.normal.elastic: law \"kuwabara-kono\" goes with the power law and exponent 1.5",
    ),
    (
        "\"lankarani-nikravesh\", restitution = 0.9",
        "\"tsuji\", restitution = 0.0, mass = 0.05",
        "joints.A.clearance.normal.restitution: must be greater than 0 and at most 1, is 0.0",
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
        "joints.A.clearance.friction.law: must be {frictions}, is \"coulomb\"",
    ),
    (
        "\"ambrosio\", coefficient = 0.0, v0 = 1e-3, v1 = 1e-2",
        "\"dahl\", coefficient = 0.1, stiffness = 0.0",
        "joints.A.clearance.friction.stiffness: must be positive (1/m), is 0.0",
    ),
    (
        "\"ambrosio\", coefficient = 0.0, v0 = 1e-3, v1 = 1e-2",
        "\"dahl\", coefficient = 0.1",
        "joints.A.clearance.friction.stiffness: is missing; it must be a number (1/m)",
    ),
    // drives, loads, start
    (
        "joint     = \"A0\"",
        "joint = \"A1\"",
        "drives.crank.joint: there is no joint \"A1\" (did you mean \"A\"?)",
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
        "loads.g.kind: must be {loads}, is \"wind\"",
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
    (
        "sample_interval = 1e-5",
        "sample_interval = 1e-5\nwindow = 3",
        "run.window: must be a list of tables [[run.window]], is a number",
    ),
    (
        "sample_interval = 1e-5",
        "sample_interval = 1e-5\nwindow = [{ from = 0.01, too = 0.02, to = 0.02, interval = 1e-7 }]",
        "run.window.1.too: unknown key (did you mean \"to\"?)",
    ),
    (
        "sample_interval = 1e-5",
        "sample_interval = 1e-5\nwindow = [{ from = 0.02, to = 0.02, interval = 1e-7 }]",
        "run.window.1.to: must be greater than from, 0.02 (s), is 0.02",
    ),
    (
        "sample_interval = 1e-5",
        "sample_interval = 1e-5\nwindow = [{ from = 0.01, to = 0.02, interval = 1e-4 }]",
        "run.window.1.interval: must be at most run.sample_interval, 1e-5 (s), is 1e-4",
    ),
    (
        "sample_interval = 1e-5",
        "sample_interval = 1e-5\nwindow = [{ from = 0.01, to = 0.02, interval = 1e-13 }]",
        "run.window: have 1.000e11 rows of samples together, at most 1e8 are written",
    ),
    ("duration        = 0.060", "revolutions = 0", "run.revolutions: must be positive, is 0"),
    (
        "duration        = 0.060",
        "duration = 0.06\nrevolutions = 5",
        "run.revolutions: the duration is given too: one of the two says how long the run is",
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
        assert_eq!(message, with_words(expected));
    }
}

/// What is expected, with the words of all kinds in place of the name of a list.
fn with_words(expected: &str) -> String {
    let words = |words: Vec<&str>| format!("one of {}", quoted(&words).join(", "));
    let of = |kinds: &[&crate::parameter::Kind]| words(kinds.iter().map(|k| k.word).collect());
    let viscous = crate::contact::viscous::KINDS.iter().map(|kind| kind.word);
    let laws = Damping::ALL.iter().map(|(word, _)| *word).chain(viscous).collect();
    let expected = expected.replace("{joints}", &of(crate::joint::KINDS));
    let expected = expected.replace("{elastics}", &of(crate::contact::elastic::KINDS));
    let expected = expected.replace("{frictions}", &of(crate::friction::KINDS));
    expected.replace("{loads}", &of(crate::load::KINDS)).replace("{laws}", &words(laws))
}

fn quoted(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| format!("{word:?}")).collect()
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
fn later_complaints_find_their_lines() {
    let case = read(FOUR_BAR_A).unwrap();
    let key = KeyPath::new(["drives", "crank", "speed_rpm"]);
    let complaint = Complaint { key, message: "does not fit".into() };
    let error = case.reject(vec![complaint]).to_string();
    let line = line_of("speed_rpm");
    assert!(error.ends_with(&format!("  line {line}, drives.crank.speed_rpm: does not fit")));
}

#[test]
fn complaints_about_windows_tell_the_line_of_theirs() {
    let window = |from: &str, to: &str| {
        format!("[[run.window]]\nfrom = {from}\nto = {to}\ninterval = 1e-7\n")
    };
    let windows = format!("{}{}[solver]", window("0.01", "0.02"), window("0.015", "-1"));
    let line = line_of("[solver]");
    assert_eq!(
        complaints_after("[solver]", &windows),
        [format!(
            "line {}, run.window.2.to: must be greater than from, 0.015 (s), is -1",
            line + 6
        )]
    );
    let windows = format!("{}{}[solver]", window("0.01", "0.02"), window("0.015", "0.03"));
    let apart = "overlaps window 1 (from 0.01 to 0.02 s): windows must be apart";
    let told = complaints_after("[solver]", &windows);
    assert_eq!(told.len(), 1);
    assert!(told[0].ends_with(&format!("run.window.2: {apart}")), "{told:?}");
}
