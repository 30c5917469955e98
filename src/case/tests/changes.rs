//! `--set` and `--ideal`.

use super::*;

#[test]
fn a_set_key_is_read_and_stands_in_the_text_as_run() {
    let set =
        ["joints.A.clearance.radial=0.00015", "solver.engine=explicit", "solver.precision=71"];
    let case = Case::from_text(Path::new("a.toml"), FOUR_BAR_A, &changes(&set, false)).unwrap();
    let clearance = &case.description.joints[1].clearance;
    assert_eq!(clearance.as_ref().unwrap().play().1.to_string(), "0.00015");
    assert_eq!(case.plan.solver.engine, EngineName::Explicit);
    assert_eq!(case.plan.solver.precision, Precision::Octuple);
    let radial = format!("radial         = 0.00015{}# m, radial clearance c\n", " ".repeat(34));
    assert!(case.text.contains(&radial), "the comment stays:\n{}", case.text);
    assert_eq!(case.text.lines().count(), FOUR_BAR_A.lines().count() + 1);
    let again = read(&case.text).unwrap();
    assert_eq!((again.description, again.plan), (case.description, case.plan));
}

#[test]
fn what_is_set_takes_the_place_of_what_would_say_the_same() {
    let normal = "joints.A.clearance.normal";
    let achieved = format!("{normal}.achieved_restitution=0.9");
    let set = ["run.revolutions=2.5", "drives.crank.speed_rpm=-7000", &achieved];
    let case = Case::from_text(Path::new("a.toml"), FOUR_BAR_A, &changes(&set, false)).unwrap();
    assert_eq!(case.plan.duration.to_f64(), 2.5 * 60.0 / 7000.0);
    assert!(
        !case.text.contains("duration") && !case.text.contains(" restitution"),
        "{}",
        case.text
    );
    let set = ["run.revolutions=2.5", "run.duration=0.01"];
    let case = Case::from_text(Path::new("a.toml"), FOUR_BAR_A, &changes(&set, false)).unwrap();
    assert_eq!(case.plan.duration.to_f64(), 0.01);
    // five turns of 12 ms are 60 ms to the last place
    let set = ["run.revolutions=5"];
    let case = Case::from_text(Path::new("a.toml"), FOUR_BAR_A, &changes(&set, false)).unwrap();
    assert_eq!(case.plan.duration.to_string(), "0.06");
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
    assert!(case.description.joints[2].clearance.is_some());
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
        let loose = |line: &str| line.starts_with('[') && line.contains("clearance]");
        assert!(!case.text.lines().any(loose), "{}", case.text);
        let mut expected = Case::read(&file, &Changes::default()).unwrap().description;
        for joint in &mut expected.joints {
            joint.clearance = None;
        }
        assert_eq!(case.description, expected);
    }
}

#[test]
fn windows_are_set_by_their_number() {
    let windows = "[[run.window]]\nfrom = 0.01\nto = 0.02\ninterval = 1e-6\n[solver]";
    let text = FOUR_BAR_A.replacen("[solver]", windows, 1);
    let set = ["run.window.1.interval=1e-7"];
    let case = Case::from_text(Path::new("a.toml"), &text, &changes(&set, false)).unwrap();
    assert_eq!(case.plan.windows[0].interval.to_string(), "1e-7");
    let inline = ["run.window=[{from=0.01,to=0.02,interval=1e-6}]", "run.window.1.to=0.03"];
    let case = Case::from_text(Path::new("a.toml"), FOUR_BAR_A, &changes(&inline, false)).unwrap();
    assert_eq!(case.plan.windows[0].to.to_string(), "0.03");
    for wrong in
        ["run.window.2.to=0.03", "run.window.0.to=0.03", "run.window.1=3", "run.window.x.to=3"]
    {
        let told = Case::from_text(Path::new("a.toml"), &text, &changes(&[wrong], false));
        let told = told.unwrap_err().to_string();
        assert!(told.contains("cannot be set: \"window\" is no table"), "{wrong}: {told}");
    }
}
