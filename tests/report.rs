//! The report page in a real browser: headless Chromium opens it from the disk, and what it shows
//! must be what is in the result files.
//!
//! Needs `/usr/bin/chromium`, Node 18 or later, and `npm ci` done in `tests/browser`. Pictures stay
//! in `target/tmp/report`.

#[expect(dead_code, reason = "the page is compared with files, not with what was recorded")]
mod recorded;

use freeplay::record::{Ending, Outcome, ResultFile, Writer};
use freeplay::report::Report;
use recorded::{Recorded, complete};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

/// The moment that the browser is sent to (s); a sample of every run.
const MOMENT: f64 = 12.53e-3;

/// Digits that the page shows.
const SHOWN: f64 = 5e-6;

/// Share of a column's largest value that the page rounds to.
const QUANTUM: f64 = 1e-6;

fn freeplay(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_freeplay")).args(arguments).output().unwrap()
}

/// Runs a command that must end well, and gives its standard output.
fn said_by(command: &mut Command) -> String {
    let output = command
        .output()
        .unwrap_or_else(|error| panic!("cannot start {:?}: {error}", command.get_program()));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?} failed: {errors}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Where the runs, pages and pictures of these tests are.
fn folder() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report");
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Runs a case of `cases/` into a result file of this name.
fn simulate(case: &str, name: &str, changes: &[&str]) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let result = folder().join(format!("{name}.h5"));
    let case = root.join(format!("cases/{case}.toml"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_freeplay"));
    command.arg("run").arg(case).arg("-o").arg(&result).args(["--force", "--quiet"]);
    for change in changes {
        command.args(["--set", change]);
    }
    said_by(&mut command);
    result
}

/// Writes the page on these result files.
fn page_on(name: &str, results: &[PathBuf]) -> PathBuf {
    let page = folder().join(format!("{name}.html"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_freeplay"));
    command.arg("report").args(results).arg("-o").arg(&page).arg("--force");
    said_by(&mut command);
    page
}

/// Says what is missing, if a browser cannot be driven here.
fn check_browser() {
    let advice = "the report is tested in a browser. It needs Chromium and Node 18 or later \
        (Debian: `apt install chromium nodejs npm`), and `npm ci --prefix tests/browser`";
    assert!(Path::new("/usr/bin/chromium").exists(), "there is no /usr/bin/chromium: {advice}");
    let node = Command::new("node").arg("--version").output();
    assert!(node.is_ok_and(|said| said.status.success()), "there is no node: {advice}");
    let modules = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser/node_modules");
    assert!(modules.join("playwright-core").exists(), "there is no playwright-core: {advice}");
}

/// What the browser saw, and the files that the main page is on.
struct Seen {
    told: Value,
    files: Vec<(String, ResultFile)>,
    page: PathBuf,
}

impl Seen {
    fn file(&self, run: &str) -> &ResultFile {
        &self.files.iter().find(|(label, _)| label == run).unwrap().1
    }
}

/// The browser's one journey through all pages.
fn seen() -> &'static Seen {
    static SEEN: OnceLock<Seen> = OnceLock::new();
    SEEN.get_or_init(|| {
        check_browser();
        let labels = ["four-bar-ideal", "four-bar-a", "four-bar-b", "four-bar-c"];
        let results = labels.map(|label| simulate(label, label, &[]));
        let page = page_on("paper", &results);
        let files: Vec<(String, ResultFile)> = labels
            .iter()
            .zip(&results)
            .map(|(label, path)| ((*label).to_owned(), ResultFile::open(path).unwrap()))
            .collect();
        let (time, _) = largest_peak(&files[3].1, 0);
        let told = said_by(
            Command::new("node")
                .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser/drive.mjs"))
                .arg(folder())
                .arg(format!("#t={:.6}", time * 1e3))
                .arg(&page)
                .args(other_pages(&results)),
        );
        Seen { told: serde_json::from_str(&told).unwrap(), files, page }
    })
}

/// Pages on runs that are unlike the paper's.
fn other_pages(paper: &[PathBuf]) -> Vec<PathBuf> {
    let results = folder();
    let short = simulate("four-bar-a", "short", &["run.duration=0.004"]);
    let mut one_sample = Recorded::new(&["A"], 1, 3);
    one_sample.header.case_text = std::fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/four-bar-a.toml"),
    )
    .unwrap();
    one_sample.header.title = "</script><script>document.title = 1</script> {{runs}} & 'δ'".into();
    let mut uneven = Recorded::new(&["A", "B"], 300, 40);
    for observation in uneven.observations.iter_mut().skip(7).step_by(11) {
        observation.bodies[1].angular_acceleration = f64::NAN;
        observation.clearances[0].normal_force = f64::INFINITY;
    }
    let (one, odd) = (results.join("one-sample.h5"), results.join("uneven.h5"));
    vec![
        page_on("pendulum", &[simulate("pendulum", "pendulum", &[])]),
        page_on("ideal", &paper[..1]),
        page_on("friction", &[simulate("four-bar-a-friction", "friction", &[])]),
        page_on("journal", &[simulate("journal-in-bearing", "journal", &[])]),
        page_on("adaptive", &[simulate("four-bar-c", "adaptive", &["run.sampling=adaptive"])]),
        page_on("same-names", &[paper[1].clone(), short]),
        page_on("one-sample", &[one_sample.write(&one, true)]),
        page_on("uneven", &[uneven.write(&odd, true)]),
        page_on("failed", &[failed_run(&results)]),
    ]
}

/// A run that failed before its first sample.
fn failed_run(folder: &Path) -> PathBuf {
    let run = Recorded::new(&["A"], 0, 0);
    let path = folder.join("failed.h5");
    let _ = std::fs::remove_file(&path);
    let writer = Writer::create(&path, run.header, false).unwrap();
    let outcome = Outcome::Failed { reason: "IDA gave up <here>".into() };
    writer.finish(Ending { outcome, ..complete() }).unwrap()
}

/// Time (s) and force (N) of the largest peak of a clearance.
fn largest_peak(file: &ResultFile, clearance: usize) -> (f64, f64) {
    let peaks = file.peaks().unwrap();
    let own = peaks.iter().filter(|peak| peak.clearance == clearance);
    let largest = own.max_by(|one, other| one.force.total_cmp(&other.force)).unwrap();
    (largest.time, largest.force)
}

/// A number as the page shows it, in its base unit: `−1914.21 × 10³ rad/s²`.
fn value_of(text: &str) -> f64 {
    let (number, unit) = text.split_once(' ').unwrap_or((text, ""));
    let number: f64 = number.replace('−', "-").parse().unwrap_or(f64::NAN);
    let prefixes = [("× 10³ ", 1e3), ("k", 1e3), ("m", 1e-3), ("µ", 1e-6), ("n", 1e-9)];
    let base = ["N", "N m", "m", "J", "rad/s", "rad/s²"];
    if base.contains(&unit) {
        return number;
    }
    let size =
        prefixes.iter().find(|(p, _)| unit.strip_prefix(p).is_some_and(|u| base.contains(&u)));
    number * size.unwrap_or_else(|| panic!("what unit is {unit:?}?")).1
}

/// The column that a chart draws.
fn column_of(file: &ResultFile, quantity: &str, item: &str) -> Vec<f64> {
    let column = |name: &str| file.column(&format!("{name}.{item}")).unwrap();
    let length = |x: &str, y: &str| {
        column(x).iter().zip(column(y)).map(|(x, y)| x.hypot(y)).collect::<Vec<f64>>()
    };
    match quantity {
        "chart-force" if file.clearances().iter().any(|name| name == item) => {
            length("normal_force", "tangential_force")
        }
        "chart-force" => length("joint_force_x", "joint_force_y"),
        "chart-eccentricity" => column("eccentricity"),
        "chart-torque" => column("drive_torque"),
        "chart-acceleration" => column("angular_acceleration"),
        "chart-energy" => file.column(&format!("energy_{item}")).unwrap(),
        other => panic!("no test knows the chart {other}"),
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_else(|| panic!("{value} is no text"))
}

#[track_caller]
fn assert_near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} ± {tolerance}");
}

#[test]
fn the_page_loads_without_complaints_and_asks_for_nothing_but_itself() {
    let Seen { told, page, .. } = seen();
    let own = format!("file://{}", page.display());
    assert_eq!(told["requests"], serde_json::json!([own]));
    assert_eq!(told["troubles"], serde_json::json!([]));
    for picture in told["pictures"].as_array().unwrap() {
        assert_eq!(picture["troubles"], serde_json::json!([]), "{picture}");
    }
    let size = std::fs::metadata(page).unwrap().len();
    assert!(size < 10_000_000, "the paper's cases take {size} bytes");
}

#[test]
fn the_cursor_reads_the_values_that_are_in_the_files() {
    let Seen { told, .. } = seen();
    let link = &told["link"];
    assert_eq!(number(&link["time"]), 12.53);
    let readings = link["readings"].as_array().unwrap();
    let (mut own, mut ideal) = (0, 0);
    for reading in readings {
        let (quantity, item) = (text(&reading["quantity"]), text(&reading["item"]));
        let dashed = reading["dashed"] == true;
        let run = if dashed { "four-bar-ideal" } else { text(&reading["run"]) };
        let item = item.strip_suffix(", four-bar-ideal").unwrap_or(item);
        let file = seen().file(run);
        let row = file.times().unwrap().iter().position(|t| (t - MOMENT).abs() < 1e-12).unwrap();
        let column = column_of(file, quantity, item);
        let largest = column.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let tolerance = SHOWN * column[row].abs() + QUANTUM * largest;
        assert_near(value_of(text(&reading["text"])), column[row], tolerance);
        if dashed { ideal += 1 } else { own += 1 }
    }
    // Force, eccentricity, torque, acceleration and two energies of three runs; the ideal one has
    // no eccentricity, and stays away from the energies.
    assert_eq!((own, ideal), (18, 9));
}

#[test]
fn peaks_between_the_samples_are_drawn_and_told() {
    let Seen { told, .. } = seen();
    let file = seen().file("four-bar-c");
    let (time, force) = largest_peak(file, 0);
    assert!(file.times().unwrap().iter().all(|sample| (sample - time).abs() > 1e-9));
    let readings = told["peak"]["readings"].as_array().unwrap();
    let of_force = |reading: &&Value| {
        reading["quantity"] == "chart-force"
            && reading["run"] == "four-bar-c"
            && reading["dashed"] == false
    };
    let reading = readings.iter().find(of_force).unwrap();
    // The link is to the nanosecond; a contact takes some ten microseconds.
    assert_near(value_of(text(&reading["text"])), force, 1e-4 * force);
}

#[test]
fn under_the_pointer_stands_a_point_of_the_file() {
    let Seen { told, .. } = seen();
    let file = seen().file("four-bar-a");
    let (times, forces) = (file.times().unwrap(), column_of(file, "chart-force", "A"));
    let mut known: Vec<(f64, f64)> = times.into_iter().zip(forces).collect();
    known.extend(file.peaks().unwrap().iter().map(|peak| (peak.time, peak.force)));
    for contact in file.contacts().unwrap() {
        known.extend([
            (contact.begin, 0.0),
            (contact.peak_time, contact.peak_force),
            (contact.end, 0.0),
        ]);
    }
    let largest = largest_peak(file, 0).1;
    for hovered in told["drag"]["hovered"].as_array().unwrap() {
        let pointer = text(&hovered["pointer"]);
        let time = pointer.split(' ').find_map(|word| word.parse::<f64>().ok()).unwrap() * 1e-3;
        let reading = &hovered["readings"][1];
        assert_eq!((text(&reading["run"]), text(&reading["item"])), ("four-bar-a", "A"));
        let value = value_of(text(&reading["text"]));
        // Times are told to 0.1 µs.
        let is_it = |(at, force): &&(f64, f64)| {
            (at - time).abs() < 0.6e-7 && (force - value).abs() <= SHOWN * force + QUANTUM * largest
        };
        assert!(known.iter().any(|point| is_it(&point)), "{pointer}: {value} N is no point");
    }
}

#[test]
fn one_time_cursor_goes_through_all_charts() {
    let Seen { told, .. } = seen();
    let cursors = numbers(&told["link"]["cursors"]);
    assert_eq!(cursors.len(), 15, "five charts of three runs");
    for cursor in cursors {
        assert_near(cursor, 12.53, number(&told["click"]["pixel"]));
    }
    for picture in told["pictures"].as_array().unwrap() {
        for cursor in numbers(&picture["cursors"]) {
            assert_near(cursor, 12.53, 0.5); // half a millisecond is a pixel or two of a phone
        }
    }
}

#[test]
fn a_link_leads_to_its_moment_and_its_run() {
    let link = &seen().told["link"];
    assert_eq!(text(&link["shown"]), "four-bar-c");
    assert_eq!(text(&link["address"]), "#t=12.53&run=four-bar-c");
    let moment = text(&link["moment"]);
    assert!(moment.contains("contact") && moment.contains("kN"), "{moment}");
    assert!(moment.contains("four-bar-c at 12.53"), "{moment}");
}

#[test]
fn play_moves_the_drawing_and_pause_stops_it() {
    let play = &seen().told["play"];
    assert_eq!(text(&play["pressed"]), "true");
    assert!(number(&play["after"]["time"]) > number(&play["before"]["time"]));
    assert_ne!(play["after"]["stage"], play["before"]["stage"]);
    assert_ne!(play["after"]["dials"], play["before"]["dials"]);
    assert_eq!(play["later"], play["after"]["time"]);
}

#[test]
fn slow_motion_is_as_slow_as_it_says() {
    let slow = &seen().told["slowMotion"];
    let passed = number(&slow["passed"]);
    assert!(passed > 0.0 && passed <= number(&slow["wall"]) / 20_000.0, "{slow}");
}

#[test]
fn the_factor_of_the_reader_changes_the_drawing() {
    let factor = &seen().told["factor"];
    assert_ne!(factor["before"], factor["after"]);
    assert_eq!(text(&factor["told"]), "× 1.0");
}

#[test]
fn a_click_sets_the_time_of_everything() {
    let click = &seen().told["click"];
    let pixel = number(&click["pixel"]);
    assert_near(number(&click["time"]), number(&click["expected"]), 1.5 * pixel);
    for cursor in numbers(&click["cursors"]) {
        assert_near(cursor, number(&click["time"]), pixel);
    }
}

#[test]
fn a_link_carries_the_zoom_and_the_axis_of_the_charts() {
    let zoom = &seen().told["zoomLink"];
    for stretch in zoom["stretches"].as_array().unwrap() {
        assert_eq!(numbers(stretch), [10.0, 20.0]);
    }
    assert_eq!(text(&zoom["address"]), "#t=12.53&run=four-bar-c&from=10&to=20");
    assert_eq!(text(&zoom["told"]), "10.00 to 20.00 ms");
    let angle = &seen().told["overAngle"];
    assert_eq!(text(&angle["address"]), "#t=12.53&run=four-bar-c&from=10&to=20&over=angle");
    assert_eq!(angle["followed"], angle["stretches"], "a link leads to the axis");
}

#[test]
fn over_the_crank_angle_charts_show_the_same_moments() {
    let angle = &seen().told["overAngle"];
    // 5000 rpm: 30° a millisecond.
    let about = |stretch: &Value, ends: [f64; 2]| {
        for (end, expected) in numbers(stretch).into_iter().zip(ends) {
            assert_near(end, expected, 1e-3);
        }
    };
    for stretch in angle["stretches"].as_array().unwrap() {
        about(stretch, [300.0, 600.0]);
    }
    let pixel = number(&angle["pixel"]);
    for cursor in numbers(&angle["cursors"]) {
        assert_near(cursor, 30.0 * 12.53, pixel);
    }
    assert_near(number(&angle["clicked"]), 12.5, pixel / 30.0 * 1.5);
    assert_eq!(angle["readings"], seen().told["link"]["readings"]);
    about(&angle["whole"], [0.0, 1800.0]);
    let others = &seen().told["others"];
    assert_eq!(others["friction"]["overAngle"], true);
    assert_eq!(others["pendulum"]["overAngle"], false, "nothing drives it");
}

#[test]
fn arrows_end_at_the_border_of_the_stage_with_their_values() {
    let arrows = &seen().told["arrows"];
    let within = |place: &Value, size: &Value| {
        let (low, high) = (number(&place[0]), number(&place[1]));
        low >= -3.0 && high <= number(size) + 3.0
    };
    assert!(within(&arrows["across"], &arrows["width"]), "{arrows}");
    assert!(within(&arrows["down"], &arrows["height"]), "{arrows}");
    let values = |name: &str| -> Vec<f64> {
        let all = arrows[name].as_array().unwrap().iter();
        all.map(|label| value_of(text(&label["text"]))).collect()
    };
    assert!(values("before").is_empty(), "arrows that end inside have no values");
    let file = seen().file("four-bar-c");
    let row = file.times().unwrap().iter().position(|t| (t - MOMENT).abs() < 1e-12).unwrap();
    let force = column_of(file, "chart-force", "A")[row];
    let near = |value: &f64| (value - force).abs() < 0.01 * force;
    assert!(values("after").iter().any(near), "{arrows} has no {force}");
    for label in arrows["after"].as_array().unwrap() {
        let half = 0.5 * number(&label["width"]);
        let [x, y] = ["x", "y"].map(|name| number(&label[name]));
        assert!(x - half >= 0.0 && x + half <= number(&arrows["width"]), "{label}");
        assert!(y >= 5.0 && y <= number(&arrows["height"]) - 5.0, "{label}");
    }
}

#[test]
fn the_paths_of_the_journals_follow_the_zoom_and_the_time() {
    let paths = &seen().told["paths"];
    assert_ne!(paths["whole"], paths["zoomed"]);
    assert_ne!(paths["zoomed"], paths["moved"]);
    assert!(text(&paths["words"]).contains("In the stretch that the charts show"));
    assert_eq!(seen().told["others"]["pendulum"]["paths"], false, "it has no journal");
    assert_eq!(seen().told["others"]["journal"]["paths"], true);
}

#[test]
fn the_motion_is_saved_as_a_picture_and_as_a_film() {
    let saved = &seen().told["saved"];
    assert_eq!(text(&saved["picture"]["name"]), "four-bar-c-12.0000-ms.png");
    assert!(text(&saved["picture"]["head"]).starts_with("89504e470d0a1a0a"));
    assert_eq!(text(&saved["film"]["name"]), "four-bar-c-12.0000-to-13.0000-ms.webm");
    assert!(text(&saved["film"]["head"]).starts_with("1a45dfa3"), "{saved}");
    // The last moment of the film is another than the first, and both are pictures.
    let played = &saved["played"];
    assert_eq!(played["width"], saved["picture"]["width"]);
    assert_ne!(played["first"], played["last"]);
    assert!(number(&played["seconds"]) > 0.5, "{played}");
    assert_eq!(text(&saved["button"]), "Film (WebM)");
}

#[test]
fn what_fingers_press_is_large_enough() {
    let touch = &seen().told["touch"];
    assert!(number(&touch["count"]) > 40.0, "{touch}");
    assert_eq!(touch["small"], serde_json::json!([]));
    assert!(number(&touch["overflow"]) <= 0.0, "{touch}");
}

#[test]
fn powers_of_ten_are_written_as_print_has_them() {
    let powers = &seen().told["powers"];
    assert_eq!(powers["computers"], serde_json::json!([]));
    let words = text(&powers["words"]);
    assert!(words.contains("× 10³ rad/s²") && words.contains("10−12"), "{words}");
}

#[test]
fn runs_have_the_names_that_they_are_given_or_their_folders() {
    let folder = tempfile::tempdir().unwrap();
    let result = simulate("four-bar-a", "labelled", &["run.duration=0.001"]);
    let results = ["soft", "stiff"].map(|name| {
        std::fs::create_dir(folder.path().join(name)).unwrap();
        let copy = folder.path().join(name).join("run.h5");
        std::fs::copy(&result, &copy).unwrap();
        copy.to_str().unwrap().to_owned()
    });
    let page = folder.path().join("page.html");
    let report = |more: &[&str]| {
        let mut arguments = vec!["report", &results[0], &results[1], "--force"];
        arguments.extend(["-o", page.to_str().unwrap()]);
        arguments.extend(more);
        freeplay(&arguments)
    };
    assert!(report(&[]).status.success());
    let html = std::fs::read_to_string(&page).unwrap();
    assert!(html.contains("<h1>soft/run, stiff/run</h1>"));
    assert!(report(&["--label", "c = 1 mm", "--label", "<c>"]).status.success());
    let html = std::fs::read_to_string(&page).unwrap();
    assert!(html.contains("<h1>c = 1 mm, &lt;c&gt;</h1>"));
    for (labels, words) in [
        (&["--label", "one"][..], "labels 1, files 2"),
        (&["--label", "one", "--label", "one"], "two files have the label \"one\""),
    ] {
        let refused = report(labels);
        assert_eq!(refused.status.code(), Some(2), "{refused:?}");
        assert!(String::from_utf8_lossy(&refused.stderr).contains(words), "{refused:?}");
    }
}

#[test]
fn a_drag_zooms_all_charts_and_a_double_click_shows_the_whole_run() {
    let drag = &seen().told["drag"];
    let (pixel, expected) = (number(&drag["pixel"]), numbers(&drag["expected"]));
    let zoomed = drag["zoomed"].as_array().unwrap();
    assert_eq!(zoomed.len(), 15);
    for stretch in zoomed {
        assert_eq!(stretch, &zoomed[0]);
        for (side, expected) in numbers(stretch).iter().zip(&expected) {
            assert_near(*side, *expected, 2.0 * pixel);
        }
    }
    for stretch in drag["back"].as_array().unwrap() {
        assert_eq!(numbers(stretch), [0.0, 60.0]);
    }
}

#[test]
fn keys_play_step_and_jump_from_impact_to_impact() {
    let keys = &seen().told["keys"];
    let time = |name: &str| number(&keys["times"][name]);
    assert_eq!(
        (time("home"), time("right"), time("shiftRight"), time("left")),
        (0.0, 0.01, 0.21, 0.2)
    );
    // The run on the stage is case c.
    let mut peaks: Vec<f64> =
        seen().file("four-bar-c").contacts().unwrap().iter().map(|c| c.peak_time * 1e3).collect();
    peaks.sort_by(f64::total_cmp);
    let mut ahead = peaks.into_iter().filter(|peak| *peak > 0.2);
    let (first, second) = (ahead.next().unwrap(), ahead.next().unwrap());
    for (name, expected) in [("next", first), ("afterNext", second), ("previous", first)] {
        assert_near(time(name), expected, 0.51e-4); // told to 0.1 µs
    }
    assert_eq!(time("end"), 60.0);
    assert_eq!((text(&keys["playing"]), text(&keys["stopped"])), ("true", "false"));
}

#[test]
fn keys_of_a_focused_chart_and_of_the_slider_are_their_own() {
    let keys = &seen().told["keys"];
    let chart = &keys["chart"];
    // One point on and back, not two: the page does not hear the key as well.
    let (right, left) = (number(&chart["right"]), number(&chart["left"]));
    assert!(right > 5.0 && right <= 5.01, "{right}");
    assert_eq!(left, 5.0);
    let length = |stretch: &Value| numbers(stretch)[1] - numbers(stretch)[0];
    assert!(chart["zoomed"].as_array().unwrap().iter().all(|stretch| length(stretch) == 30.0));
    assert!(chart["back"].as_array().unwrap().iter().all(|stretch| length(stretch) == 60.0));
    assert_eq!(number(&keys["slider"]["notches"]), 1.0);
    assert!(text(&keys["slider"]["told"]).ends_with(" ms"));
}

#[test]
fn everything_has_a_name_and_what_is_drawn_is_told_in_tables() {
    let names = &seen().told["names"];
    assert_eq!(names["nameless"], serde_json::json!([]));
    let contacts = seen().files.iter().map(|(_, file)| file.contacts().unwrap().len());
    assert_eq!(number(&names["rows"]), contacts.sum::<usize>() as f64);
}

#[test]
fn the_page_fits_desktop_and_phone_in_light_and_dark_and_prints() {
    let pictures = seen().told["pictures"].as_array().unwrap();
    assert_eq!(pictures.len(), 4);
    for picture in pictures {
        assert!(number(&picture["overflow"]) <= 0.0, "it is wider than its window: {picture}");
        let light = picture["colorScheme"] == "light";
        assert_eq!(text(&picture["paper"]) == "rgb(255, 255, 255)", light, "{picture}");
        assert!(number(&picture["bytes"]) > 20_000.0, "an empty picture: {picture}");
    }
    let printed = pictures.iter().find_map(|picture| picture["pdf"].as_f64()).unwrap();
    assert!(printed > 100_000.0, "an empty print of {printed} bytes");
}

#[test]
fn unlike_runs_are_shown_too() {
    let others = seen().told["others"].as_object().unwrap();
    assert_eq!(others.len(), 9);
    for (name, page) in others {
        assert_eq!(page["ready"], true, "{name}");
        assert_eq!(page["troubles"], serde_json::json!([]), "{name}");
        assert_eq!(page["requests"].as_array().unwrap().len(), 1, "{name}");
        let samples = !["failed"].contains(&name.as_str());
        assert_eq!(number(&page["charts"]) > 0.0, samples, "{name}");
        let plays = !["failed", "one-sample"].contains(&name.as_str());
        assert_eq!(page["playable"], plays, "{name}");
        assert_eq!(number(&page["end"]) > number(&page["begin"]), plays, "{name}");
    }
    let failed = text(&others["failed"]["text"]);
    assert!(failed.contains("did not come to its end: failed: IDA gave up <here>. Nothing was"));
    assert!(text(&others["pendulum"]["text"]).contains("No joint has a clearance."));
    let same = text(&others["same-names"]["text"]);
    assert!(same.contains("short") && !same.contains("1. "), "files tell equal cases apart");
}

#[test]
fn text_of_a_case_stays_text() {
    let page = &seen().told["others"]["one-sample"];
    let title = "</script><script>document.title = 1</script> {{runs}} & 'δ'";
    assert_eq!((text(&page["title"]), text(&page["heading"])), (title, title));
}

#[test]
fn the_summary_has_the_known_maxima_of_the_ideal_mechanism() {
    let html = std::fs::read_to_string(&seen().page).unwrap();
    // Exact: 892.919148, 270.866700, 221.253366 N, 8.546034 and −10.728744 N m.
    for known in ["892.919", "270.867", "221.253", "8.54603", "−10.7287"] {
        assert!(html.contains(&format!("<td>{known}")), "{known} is not in the summary");
    }
}

#[test]
fn the_same_files_give_the_same_page_to_the_byte() {
    let path = simulate("four-bar-a", "twice", &["run.duration=0.002"]);
    let page = || Report::new(&[ResultFile::open(&path).unwrap()], &[]).unwrap();
    assert_eq!(page(), page());
}

#[test]
fn a_page_is_replaced_only_with_force() {
    let folder = tempfile::tempdir().unwrap();
    let path = simulate("four-bar-a", "forced", &["run.duration=0.001"]);
    let page = folder.path().join("page.html");
    std::fs::write(&page, "old").unwrap();
    let arguments = ["report", path.to_str().unwrap(), "-o", page.to_str().unwrap()];
    let refused = freeplay(&arguments);
    assert_eq!(refused.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--force replaces it"));
    assert_eq!(std::fs::read_to_string(&page).unwrap(), "old");
    let done = freeplay(&[&arguments[..], &["--force"]].concat());
    assert_eq!(done.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&done.stdout).contains("page.html: 1 run, "));
    assert!(std::fs::read_to_string(&page).unwrap().starts_with("<!doctype html>"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside it");
}

#[test]
fn what_is_no_result_and_where_nothing_can_be_written_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let text = folder.path().join("text.h5");
    std::fs::write(&text, "no result").unwrap();
    let page = folder.path().join("page.html");
    let (text, page) = (text.to_str().unwrap(), page.to_str().unwrap());
    assert_eq!(freeplay(&["report", text, "-o", page]).status.code(), Some(2));
    assert_eq!(freeplay(&["report", "-o", page]).status.code(), Some(2));
    let path = simulate("four-bar-a", "nowhere", &["run.duration=0.001"]);
    let nowhere = folder.path().join("missing/page.html");
    let told = freeplay(&["report", path.to_str().unwrap(), "-o", nowhere.to_str().unwrap()]);
    assert_eq!(told.status.code(), Some(3));
}
