//! Until when a run is true, as the program tells it. Known in advance: certified references of
//! the paper's cases (`tests/data/certified`), which say how many digits each sample of a run
//! really has; that case c loses all digits of doubles at about 18 ms; the angle at which a crank
//! that is too long locks, by the law of cosines; that nothing is deeper in a bearing than its
//! contact law can mean.

mod simulated;
mod written;

use freeplay::case::{Case, Changes};
use freeplay::certify::{self, Companion, Horizon, Reach, Until, Witness};
use freeplay::digits::Sizes;
use freeplay::post::case_of;
use freeplay::record::{Dimension, ResultFile};
use freeplay::run::{Progress, Watcher};
use freeplay::simulate::Simulation;
use serde_json::Value;
use simulated::told;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::Output;
use written::{freeplay, root};

fn go_on(_: &Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// A run and its companion, as `freeplay run` has them.
fn followed(case: &Case, times: Option<Vec<f64>>) -> Companion {
    let reach = Reach { to_the_end: false, run_steps: 1_000_000 };
    followed_to(case, times, reach)
}

fn followed_to(case: &Case, times: Option<Vec<f64>>, reach: Reach) -> Companion {
    followed_while(case, times, reach, &mut go_on)
}

fn followed_while(
    case: &Case,
    times: Option<Vec<f64>>,
    reach: Reach,
    watch: Watcher<'_>,
) -> Companion {
    let simulation = told(Simulation::new(case));
    let simulation = match times {
        Some(times) => simulation.sampled_at(times),
        None => simulation,
    };
    let mut witness = Witness::new(Sizes::of(simulation.mechanism()));
    let schedule = simulation.schedule().clone();
    let mut run = freeplay::run::Trajectory::default();
    let (_, ran) = simulation.run(&mut run, &mut go_on);
    told(ran);
    run.samples.iter().for_each(|sample| witness.take(sample));
    run.contacts.iter().for_each(|contact| witness.take_contact(*contact));
    certify::companion(case, &schedule, &witness, reach, watch)
}

/// The estimate of a run's digits against what they are. It may not be far above the truth, and
/// should not be far below.
#[test]
fn estimated_digits_are_those_that_a_certified_reference_finds() {
    for name in ["four-bar-a", "four-bar-b", "four-bar-c", "four-bar-a-friction"] {
        let path = root().join(format!("tests/data/certified/{name}.h5"));
        let file = told(ResultFile::open(&path));
        for set in [&[][..], &["solver.engine=explicit"], &["solver.relative_tolerance=1e-9"]] {
            let set = set.iter().map(|change| told(change.parse())).collect();
            let case = told(case_of(&file, &Changes { set, ideal: false }));
            let reference = told(certify::stored(&case, &file));
            let times: Vec<f64> = reference.trajectory.samples.iter().map(|s| s.time).collect();
            let simulation = told(Simulation::new(&case)).sampled_at(times.clone());
            let certificate = told(certify::certify(simulation, reference, &mut go_on));
            let companion = followed(&case, Some(times));
            let mut least = [16.0_f64; 2];
            for (claim, digits) in certificate.claims.iter().zip(&companion.digits) {
                let run = claim.run;
                least[0] = least[0].min(run.state);
                least[1] = least[1].min(run.forces).min(run.torque);
                if claim.reference.forces.min(claim.reference.torque) < least[1] + 1.0 {
                    break;
                }
                for (what, claimed, truth) in
                    [("state", digits.state, least[0]), ("forces", digits.forces, least[1])]
                {
                    let truth = truth.max(0.0);
                    assert!(claimed <= truth + 1.0, "{name}, {what}: {claimed:.1} of {truth:.1}");
                    assert!(claimed >= truth - 3.0, "{name}, {what}: {claimed:.1} of {truth:.1}");
                }
            }
        }
    }
}

fn case(name: &str) -> String {
    root().join(format!("cases/{name}.toml")).to_str().unwrap().to_owned()
}

fn said(output: &Output) -> String {
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// A short run of case c into a folder, beyond its horizon.
fn run_c(folder: &Path, more: &[&str]) -> (PathBuf, String) {
    let path = folder.join("c.h5");
    let output = path.to_str().unwrap();
    let set = ["--set", "run.duration=0.024", "--set", "run.sample_interval=2e-5"];
    let c = case("four-bar-c");
    let words = said(&freeplay(
        &[&["run", &c, "-o", output, "--force", "--quiet"], &set[..], more].concat(),
    ));
    (path, words)
}

#[test]
fn a_run_says_until_when_it_means_something_and_writes_it() {
    let folder = tempfile::tempdir().unwrap();
    let (path, words) = run_c(folder.path(), &[]);
    for part in
        ["  true         until 1", "  beyond       a number is one draw", "errors       grow"]
    {
        assert!(words.contains(part), "no {part:?} in {words}");
    }
    for wrong in ["until 0.000", " -", "−", "NaN", "inf"] {
        assert!(!words.contains(wrong), "{wrong:?} in {words}");
    }
    let file = ResultFile::open(&path).unwrap();
    let horizon = Horizon::of(&file).unwrap().unwrap();
    assert!((0.012..0.018).contains(&horizon.state), "{horizon:?}");
    assert!(horizon.forces <= horizon.state && horizon.forces > 0.010, "{horizon:?}");
    assert!((0.016..0.020).contains(&horizon.doubles.unwrap()), "{horizon:?}");
    let samples = file.times().unwrap().len();
    for name in ["error_growth", "digits_left", "estimated_digits", "estimated_digits_forces"] {
        let values = file.along(Dimension::Time, name).unwrap().unwrap();
        assert_eq!(values.len(), samples);
        let digits = name != "error_growth";
        assert!(!digits || values.iter().all(|digits| (0.0..=16.0).contains(digits)), "{name}");
        assert!(!digits || values.windows(2).all(|pair| pair[1] <= pair[0]), "{name}");
    }
    let sha = file.text("case_sha256").unwrap();
    let version = concat!("freeplay ", env!("CARGO_PKG_VERSION"));
    let quoted = words.lines().find(|line| line.contains("to quote")).unwrap();
    assert!(quoted.contains(sha) && quoted.contains(version), "{quoted}");

    let (_, json) = run_c(folder.path(), &["--json"]);
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["horizon"]["state"].as_f64(), Some(horizon.state));
    assert!(quoted.contains(json["horizon"]["sentence"].as_str().unwrap()));
}

#[test]
fn whoever_reads_a_file_marks_what_lies_beyond_its_horizon() {
    let folder = tempfile::tempdir().unwrap();
    let (path, _) = run_c(folder.path(), &[]);
    let path = path.to_str().unwrap();
    let table = said(&freeplay(&["summary", path]));
    for part in ["2 *", "beyond the horizon, *: behind", "one draw from the distribution"] {
        assert!(table.contains(part), "no {part:?} in {table}");
    }
    assert!(!table.contains("1 *"), "{table}");
    let json: Value = serde_json::from_str(&said(&freeplay(&["summary", "--json", path]))).unwrap();
    assert_eq!(json["horizon"]["revolutions_within"], serde_json::json!([true, false]));
    let largest = &json["columns"]["joint_force.A"]["largest"];
    let within = largest["time"].as_f64().unwrap() <= json["horizon"]["forces"].as_f64().unwrap();
    assert_eq!(largest["within_horizon"], within);
    assert!(json["columns"]["joint_force.A"]["reference"]["largest"]["within_horizon"].is_null());

    let page = folder.path().join("c.html");
    said(&freeplay(&["report", path, "-o", page.to_str().unwrap()]));
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("\"horizon\":[0.01") && page.contains("class=\"beyond\""));
    let figures = folder.path().join("figures");
    said(&freeplay(&["plot", path, "-o", figures.to_str().unwrap()]));
    for name in ["force-A", "journal-path", "phase-portrait", "contact-timeline", "eccentricity-B"]
    {
        let svg = std::fs::read_to_string(figures.join(format!("{name}.svg"))).unwrap();
        assert!(svg.contains("beyond the horizon"), "{name}");
    }

    let other = folder.path().join("d.h5");
    std::fs::copy(path, &other).unwrap();
    let compared = said(&freeplay(&["compare", other.to_str().unwrap(), path]));
    assert!(compared.contains("means something until") && compared.contains(" *"), "{compared}");
}

#[test]
fn without_a_tangent_nobody_claims_to_know() {
    let folder = tempfile::tempdir().unwrap();
    let (path, words) = run_c(folder.path(), &["--no-tangent"]);
    assert_eq!(words.lines().count(), 1, "{words}");
    let file = ResultFile::open(&path).unwrap();
    assert_eq!(Horizon::of(&file).unwrap(), None);
    let table = said(&freeplay(&["summary", path.to_str().unwrap()]));
    assert!(table.contains("how far this run is true is not known"), "{table}");
    assert!(!table.contains("as accurate as"), "{table}");
}

#[test]
fn what_has_no_contacts_is_not_followed_unless_asked() {
    let folder = tempfile::tempdir().unwrap();
    let run = |name: &str, more: &[&str]| {
        let path = folder.path().join("run.h5");
        let short = ["--set", "run.duration=0.01", "--force", "--quiet", "-o"];
        let run = ["run", &case(name)];
        let all = [&run[..], &short, &[path.to_str().unwrap()], more].concat();
        said(&freeplay(&all))
    };
    assert_eq!(run("pendulum", &[]).lines().count(), 1);
    assert_eq!(run("four-bar-a", &["--ideal"]).lines().count(), 1);
    assert!(run("pendulum", &["--tangent"]).contains("true         to the end"));
}

#[test]
fn a_run_in_its_horizon_holds_to_the_end() {
    let path = format!("{}/cases/four-bar-a.toml", root().display());
    let set = ["run.duration=0.005", "run.sample_interval=1e-4"];
    let set = set.iter().map(|change| told(change.parse())).collect();
    let case = told(Case::read(Path::new(&path), &Changes { set, ideal: false }));
    let companion = followed(&case, None);
    assert_eq!(companion.state_until(6.0), Until::End);
    assert!(companion.horizon().is_whole() && companion.horizon().at_end.unwrap().state > 6.0);
}

/// What the companion could not follow is not known, and neither true nor gone.
/// Bristles that slip relax so fast that an explicit step may be at the edge of its stability: what the
/// derivative then grows by is no growth of errors. Known in advance: that both engines agree.
#[test]
fn bristles_that_slip_do_not_end_a_horizon() {
    for friction in [
        "{ law = \"dahl\", coefficient = 0.1, stiffness = 1e4 }",
        "{ law = \"lugre\", coefficient = 0.1, static = 0.15, stiffness = 1e4, damping = 10.0, stribeck = 1e-2 }",
    ] {
        let friction = format!("joints.A.clearance.friction={friction}");
        let normal = "joints.A.clearance.normal.restitution=0.7";
        let of = |engine: &str| {
            let set = [friction.as_str(), normal, "run.duration=0.012", engine];
            simulated::case("cases/four-bar-a-friction.toml", &set)
        };
        let [ida, explicit] = ["solver.engine=ida", "solver.engine=explicit"].map(of);
        let ends =
            [&ida, &explicit].map(|case| *simulated::simulate(case).last().bodies.last().unwrap());
        let [a, b] = ends.map(|body| body.angular_velocity);
        assert!((a / b - 1.0).abs() < 1e-6, "{friction}: {a} {b}");
        let told = followed(&ida, None).digits.last().unwrap().state;
        assert!(told > 5.0, "{friction}: {told} digits are told of");
    }
}

#[test]
fn a_companion_that_is_lost_says_so() {
    let path = format!("{}/cases/four-bar-c.toml", root().display());
    let case = told(Case::read(Path::new(&path), &Changes::default()));
    let companion = followed_to(&case, None, Reach { to_the_end: false, run_steps: 0 });
    assert!(companion.stopped.as_ref().unwrap().contains("steps"), "{companion:?}");
    let horizon = companion.horizon();
    assert!(!horizon.is_whole() && horizon.state > 1e-3, "{horizon:?}");
    assert!(horizon.holds().contains("is not known"), "{}", horizon.holds());
    let digits = &companion.series()[2];
    assert!(digits.values.last().unwrap().is_nan(), "{}", digits.name);
}

#[test]
fn a_companion_that_is_interrupted_tells_what_it_knows() {
    let path = format!("{}/cases/four-bar-a.toml", root().display());
    let set = vec![told("run.duration=0.012".parse())];
    let case = told(Case::read(Path::new(&path), &Changes { set, ideal: false }));
    let reach = Reach { to_the_end: false, run_steps: 1_000_000 };
    let mut looks = 0;
    let companion = followed_while(&case, None, reach, &mut |_| {
        looks += 1;
        if looks > 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!(companion.stopped.as_deref(), Some("it was interrupted"));
    let horizon = companion.horizon();
    assert!(horizon.state > 0.0 && horizon.state < 0.012, "{horizon:?}");
    assert!(horizon.holds().contains("is not known"), "{}", horizon.holds());
}

/// Many samples are thinned, and told of all the same.
#[test]
fn of_a_long_run_the_companion_looks_at_some_samples_and_tells_of_all() {
    let path = format!("{}/cases/four-bar-a.toml", root().display());
    let set = ["run.duration=0.003", "run.sample_interval=1e-7"];
    let set = set.iter().map(|change| told(change.parse())).collect();
    let case = told(Case::read(Path::new(&path), &Changes { set, ideal: false }));
    let companion = followed(&case, None);
    assert!(companion.tangent.times.len() < 8193, "{}", companion.tangent.times.len());
    for series in companion.series() {
        assert_eq!(series.values.len(), 30_001);
        assert!(series.values.iter().all(|value| value.is_finite()), "{}", series.name);
    }
    assert_eq!(companion.state_until(1.0), Until::End);
}

/// A four-bar whose crank is too long to go round: crank and ground are longer together than
/// coupler and follower. It locks where the two lie in a line, `cos φ = (0.12² + 0.2² − 0.3²) / (2
/// · 0.12 · 0.2)`.
fn too_long(folder: &Path) -> String {
    let text = std::fs::read_to_string(case("four-bar-c")).unwrap();
    let text = text
        .replace("A0 = [-0.015, 0.0], A = [0.015, 0.0]", "A0 = [-0.06, 0.0], A = [0.06, 0.0]")
        .replace("coupler  = { angle = 0.7 }", "coupler = { angle = 0.56 }")
        .replace("follower = { angle = 1.84 }", "follower = { angle = 0.92 }");
    assert!(text.contains("[-0.06, 0.0], A = [0.06") && text.contains("0.56"), "{text}");
    let path = folder.join("too-long.toml");
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn check_says_where_a_linkage_locks() {
    let folder = tempfile::tempdir().unwrap();
    let json = said(&freeplay(&["check", "--json", &too_long(folder.path())]));
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["turn"]["goes_round"], false);
    let angle = json["turn"]["drive_angles"]["crank"].as_f64().unwrap();
    let locks = f64::acos((0.0144 + 0.04 - 0.09) / (2.0 * 0.12 * 0.2));
    assert!((angle - locks).abs() < 1e-4, "{angle} {locks}");
    let words = said(&freeplay(&["check", &too_long(folder.path())]));
    assert!(words.contains("LOCKS") && words.contains("drive crank at 137.8"), "{words}");
    let words = said(&freeplay(&["check", &case("four-bar-c")]));
    assert!(words.contains("goes round, 12 ms") && !words.contains("note "), "{words}");
}

#[test]
fn a_run_stops_where_a_journal_is_deeper_than_its_law_can_mean() {
    let folder = tempfile::tempdir().unwrap();
    let too_long = too_long(folder.path());
    let soft = "joints.A.clearance.normal={law=\"hertz\", stiffness=3.3e5}";
    for (name, arguments) in [
        ("locks", vec![too_long.as_str()]),
        ("soft", vec![&case("four-bar-a"), "--set", soft]),
        ("explicit", vec![&too_long, "--set", "solver.engine=explicit"]),
    ] {
        let path = folder.path().join(format!("{name}.h5"));
        let output = path.to_str().unwrap();
        let ran = freeplay(&[&["run", "-o", output, "--quiet"], &arguments[..]].concat());
        let errors = String::from_utf8_lossy(&ran.stderr);
        assert_eq!(ran.status.code(), Some(4), "{name}: {errors}");
        assert!(errors.contains("m deep in its bearing at t ="), "{name}: {errors}");
        let file = ResultFile::open(&path).unwrap();
        assert_eq!(file.text("run_status"), Some("failed"));
        let depths = file.table("penetration").unwrap().values;
        let deepest = depths.iter().copied().fold(0.0, f64::max);
        assert!(depths.len() > 1 && deepest < 6e-3, "{name}: {deepest}");
    }
    // and a note says so beforehand
    let words = said(&freeplay(&["check", &case("four-bar-a"), "--set", soft]));
    assert!(words.contains("is K in N/m^n?"), "{words}");
}

#[test]
fn check_notes_what_looks_like_a_slip_of_units() {
    let clearance = "joints.A.clearance.";
    for (change, key) in [
        (format!("{clearance}bearing_radius=12"), "bearing_radius"),
        (format!("{clearance}normal.young=144.5"), "normal.young"),
        ("start.coupler.angle=95".to_owned(), "start.coupler.angle"),
        ("run.sample_interval=1.0".to_owned(), "run.duration"),
        (format!("{clearance}radial=0.0099"), "radial"),
        ("bodies.coupler.inertia=202.0".to_owned(), "bodies.coupler.inertia"),
        ("run.sample_interval=1e-3".to_owned(), "run.sample_interval"),
        ("drives.crank.angle=90".to_owned(), "drives.crank.angle"),
    ] {
        let output = freeplay(&["check", "--json", &case("four-bar-a"), "--set", &change]);
        let json: Value = serde_json::from_str(&said(&output)).unwrap();
        let notes = json["notes"].as_array().unwrap();
        let found = notes.iter().any(|note| note["key"].as_str().unwrap().ends_with(key));
        assert!(found, "{change}: {notes:#?}");
    }
    let shipped = std::fs::read_dir(root().join("cases")).unwrap();
    for case in shipped.map(|entry| entry.unwrap().path()) {
        let json = said(&freeplay(&["check", "--json", case.to_str().unwrap()]));
        let json: Value = serde_json::from_str(&json).unwrap();
        assert_eq!(json["notes"], serde_json::json!([]), "{}", case.display());
    }
}

#[test]
fn check_prints_the_assembled_start_and_says_once_what_is_alike() {
    let words = said(&freeplay(&["check", &case("four-bar-c")]));
    // REFERENCES: the ideal four-bar at angle 0
    for part in ["coupler", "0.6976720", "-92.39978", "alike in these 3:"] {
        assert!(words.contains(part), "no {part:?} in {words}");
    }
    assert_eq!(words.matches("K = ").count(), 1, "{words}");
    let json = said(&freeplay(&["check", "--json", &case("four-bar-c")]));
    let json: Value = serde_json::from_str(&json).unwrap();
    let angle = json["start"]["follower"]["angle"].as_f64().unwrap();
    assert!((angle - 1.841_237_772_019_259_4).abs() < 1e-12, "{angle}");
    assert_eq!(json["clearances"].as_object().unwrap().len(), 3);
}

#[test]
fn info_tells_programs_what_it_tells_people() {
    let folder = tempfile::tempdir().unwrap();
    let (path, _) = run_c(folder.path(), &[]);
    let json = said(&freeplay(&["info", "--json", path.to_str().unwrap()]));
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["dimensions"]["clearance"]["names"], serde_json::json!(["A", "B", "B0"]));
    assert_eq!(json["attributes"]["relative_tolerance"], 1e-12);
    assert_eq!(json["run_status"], "complete");
}

/// A start that only the clearances allow: the ideal mechanism is that of the same branch.
#[test]
fn a_fixed_start_off_the_ideal_mechanism_still_has_ratios() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fixed.h5");
    let ran = freeplay(&[
        "run",
        &case("four-bar-c"),
        "-o",
        path.to_str().unwrap(),
        "--quiet",
        "--set",
        "run.duration=0.002",
        "--set",
        "start.coupler={ angle = 0.7, x = 0.0990, y = 0.0579, fixed = true }",
    ]);
    said(&ran);
    let summary = freeplay(&["summary", path.to_str().unwrap()]);
    assert!(summary.stderr.is_empty(), "{}", String::from_utf8_lossy(&summary.stderr));
    assert!(said(&summary).contains("ratios to the ideal mechanism"));
}
