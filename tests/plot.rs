//! `freeplay plot` as a user meets it, and figures of files that no simulation would make.

#[expect(dead_code, reason = "what a file must hold is tested beside the reader")]
mod recorded;

use freeplay::figure::{Error, Format, Options, Over, draw};
use freeplay::record::ResultFile;
use recorded::Recorded;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn files_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn freeplay(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_freeplay")).args(arguments).output().unwrap()
}

/// A short run of a case of the project.
fn run(folder: &Path, case: &str) -> PathBuf {
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases").join(format!("{case}.toml"));
    let file = folder.join(case.with_extension("h5").file_name().unwrap());
    let [case, output] = [&case, &file].map(|path| path.to_str().unwrap());
    let ran = freeplay(&["run", case, "-o", output, "--set", "run.duration=0.002", "--quiet"]);
    assert!(ran.status.success(), "{ran:?}");
    file
}

fn plot(files: &[&Path], output: &Path, more: &[&str]) -> Output {
    let mut arguments = vec!["plot"];
    arguments.extend(files.iter().map(|file| file.to_str().unwrap()));
    arguments.extend(["-o", output.to_str().unwrap()]);
    arguments.extend(more);
    freeplay(&arguments)
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn figures_are_written_in_the_formats_asked_for_and_nothing_else_is() {
    let folder = folder();
    let file = run(folder.path(), "four-bar-a");
    let figures = folder.path().join("deep/figures");
    let plotted = plot(&[&file], &figures, &["--format", "svg,png,pdf,svg"]);
    assert!(plotted.status.success(), "{plotted:?}");
    let names = files_in(&figures);
    assert_eq!(names.len() % 3, 0);
    assert!(names.iter().all(|name| !name.starts_with('.')));
    let text = String::from_utf8(plotted.stdout).unwrap();
    assert_eq!(
        text,
        format!("{}: {} figures, {} files\n", figures.display(), names.len() / 3, names.len())
    );
    for (name, begin) in
        [("force-A.svg", &b"<svg "[..]), ("force-A.png", b"\x89PNG"), ("force-A.pdf", b"%PDF")]
    {
        assert!(std::fs::read(figures.join(name)).unwrap().starts_with(begin), "{name}");
    }
}

#[test]
fn what_exists_stays_without_force_and_then_nothing_is_written() {
    let folder = folder();
    let file = run(folder.path(), "four-bar-a");
    let figures = folder.path().join("figures");
    std::fs::create_dir(&figures).unwrap();
    let taken = figures.join("torque-crank.svg");
    std::fs::write(&taken, "mine").unwrap();
    let refused = plot(&[&file], &figures, &[]);
    assert_eq!(refused.status.code(), Some(3), "{refused:?}");
    assert!(told(&refused).contains("torque-crank.svg exists; --force replaces it"));
    assert_eq!(files_in(&figures), ["torque-crank.svg"]);
    assert_eq!(std::fs::read_to_string(&taken).unwrap(), "mine");
    assert!(plot(&[&file], &figures, &["--force"]).status.success());
    assert!(std::fs::read_to_string(&taken).unwrap().starts_with("<svg "));
}

#[test]
fn laws_are_drawn_without_a_run() {
    let folder = folder();
    let [figures, other] = ["figures", "other"].map(|name| folder.path().join(name));
    let law = ["--law", "flores,exact,lankarani-nikravesh", "--restitution", "0.7"];
    assert!(plot(&[], &figures, &law).status.success());
    assert_eq!(files_in(&figures), ["law-loops.svg"]);
    let svg = std::fs::read_to_string(figures.join("law-loops.svg")).unwrap();
    for words in ["flores", "exact", "lankarani-nikravesh", "elastic", " = 0.7"] {
        assert!(svg.contains(words), "{words}");
    }
    assert!(plot(&[], &other, &["--law", "all"]).status.success());
    for (wrong, words) in [
        (&["--law", "flors"][..], "did you mean \"flores\"?"),
        (&["--law", "flores", "--restitution", "1.5"], "greater than 0 and at most 1, is 1.5"),
        (&["--restitution", "0.5"], "required"),
        (&[], "required"),
    ] {
        let refused = plot(&[], &other, wrong);
        assert_eq!(refused.status.code(), Some(2), "{refused:?}");
        assert!(told(&refused).contains(words), "{refused:?}");
    }
    let result = run(folder.path(), "four-bar-a");
    assert_eq!(plot(&[&result], &other, &["--law", "all"]).status.code(), Some(2));
}

/// What a command prints in JSON.
fn json(arguments: &[&str]) -> serde_json::Value {
    let printed = freeplay(arguments);
    assert!(printed.status.success(), "{printed:?}");
    serde_json::from_slice(&printed.stdout).unwrap()
}

#[test]
fn every_law_falls_as_its_closed_form_says_on_both_engines() {
    let folder = folder();
    let output = folder.path().join("figures");
    let bench = ["impact", "--elastic", "all", "--json", "-o", output.to_str().unwrap()];
    let told = json(&bench);
    let impacts = told["impacts"].as_array().unwrap();
    let menu = json(&["laws", "--restitution", "0.7", "--json"]);
    let laws = |list: &str| menu[list].as_array().unwrap().clone();
    let all = laws("normal").len() * laws("elastic").len() + laws("own_damping").len();
    assert!(all >= 80 && impacts.len() == all, "{} impacts of {all}", impacts.len());
    for impact in impacts {
        for engine in ["ida", "explicit"] {
            let off = impact["engines"][engine]["off"].as_f64().unwrap();
            assert!(off < 1e-9, "{impact:#}");
        }
        let nominal = laws("normal").into_iter().find(|law| law["law"] == impact["law"]);
        let achieved = nominal.map(|law| law["impacts"][0]["achieved"].as_f64().unwrap());
        let rebound = impact["closed_form"]["rebound"].as_f64().unwrap();
        assert!(achieved.is_none_or(|achieved| (achieved - rebound).abs() < 1e-12), "{impact:#}");
    }
    assert_eq!(files_in(&output), ["impact-loops.svg"]);
    let svg = std::fs::read_to_string(output.join("impact-loops.svg")).unwrap();
    assert!(svg.contains("kelvin-voigt") && svg.contains("exact, johnson"));
    // figures stay unless told otherwise
    assert_eq!(freeplay(&bench).status.code(), Some(3));
    // hard to come by where nearly all is lost: the damping then all but cancels the spring
    let slow = json(&["impact", "--restitution", "0.2", "--json"]);
    for impact in slow["impacts"].as_array().unwrap() {
        let off = impact["engines"]["explicit"]["off"].as_f64().unwrap();
        assert!(off < 1e-9, "{impact:#}");
    }
    // beside the middle the closed form is no longer exact
    let aside = json(&["impact", "flores", "--aside", "0.5", "--json"]);
    let off = aside["impacts"][0]["engines"]["explicit"]["off"].as_f64().unwrap();
    assert!(off > 1e-3 && off < 0.1, "{off}");
    for (wrong, words) in [
        (&["flors"][..], "did you mean \"flores\"?"),
        (&["flores", "--elastic", "jonson"], "did you mean \"johnson\"?"),
        (&["--speed", "0"], "greater than 0"),
        (&["--aside", "1"], "less than 1"),
        (&["--restitution", "1.5"], "greater than 0 and at most 1, is 1.5"),
    ] {
        let refused = freeplay(&[&["impact"], wrong].concat());
        assert_eq!(refused.status.code(), Some(2), "{refused:?}");
        assert!(crate::told(&refused).contains(words), "{refused:?}");
    }
}

#[test]
fn figures_can_be_chosen_by_name_and_by_kind() {
    let folder = folder();
    let file = run(folder.path(), "four-bar-a");
    let figures = folder.path().join("figures");
    assert!(plot(&[&file], &figures, &["--only", "journal-path,force"]).status.success());
    let expected =
        ["force-A.svg", "force-A0.svg", "force-B.svg", "force-B0.svg", "journal-path.svg"];
    assert_eq!(files_in(&figures), expected);
    let refused = plot(&[&file], &figures, &["--only", "force-C", "--force"]);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    assert!(told(&refused).contains("there is no figure \"force-C\" (did you mean \"force-"));
}

#[test]
fn the_same_files_give_the_same_bytes_in_every_format() {
    let folder = folder();
    let file = run(folder.path(), "four-bar-c");
    let [once, again] = ["once", "again"].map(|name| folder.path().join(name));
    for figures in [&once, &again] {
        assert!(plot(&[&file], figures, &["--format", "svg,png,pdf"]).status.success());
    }
    for name in files_in(&once) {
        let [once, again] =
            [&once, &again].map(|figures| std::fs::read(figures.join(&name)).unwrap());
        assert!(once == again, "{name}");
    }
}

#[test]
fn bad_input_ends_with_2_and_a_bad_output_with_3() {
    let folder = folder();
    let file = run(folder.path(), "pendulum");
    let text = folder.path().join("text.h5");
    std::fs::write(&text, "no result").unwrap();
    let missing = folder.path().join("missing.h5");
    let figures = folder.path().join("figures");
    for (file, more, words) in [
        (&missing, &[][..], "missing.h5"),
        (&text, &[], "text.h5"),
        (&file, &["--over", "angle"], "tells no angle of a drive: it has none"),
        (&file, &["--drive", "crank"], "it has no drive \"crank\""),
        (&file, &["--from", "1"], "has no samples from 1 s"),
        (&file, &["--format", "bmp"], "bmp"),
        (&file, &["--width", "3"], "number from 40 to 1000"),
        (&file, &["--section", "NaN"], "must be a number"),
    ] {
        let refused = plot(&[file.as_path()], &figures, more);
        assert_eq!(refused.status.code(), Some(2), "{refused:?}");
        assert!(told(&refused).contains(words), "{}", told(&refused));
        assert!(!figures.exists());
    }
    let in_the_way = plot(&[&file], &text, &[]);
    assert_eq!(in_the_way.status.code(), Some(3), "{in_the_way:?}");
}

/// Opens what a writer makes of a recording.
fn opened(folder: &Path, name: &str, recorded: &Recorded) -> ResultFile {
    ResultFile::open(&recorded.write(&folder.join(name), false)).unwrap()
}

/// Encodes every figure in every format.
fn encode_all(files: Vec<ResultFile>) -> Vec<String> {
    let figures = draw(files, &Options::default()).unwrap();
    for figure in &figures {
        for format in [Format::Svg, Format::Png, Format::Pdf] {
            assert!(!figure.encode(format).unwrap().is_empty(), "{}", figure.name);
        }
        assert!(!figure.svg.contains("NaN") && !figure.svg.contains("inf"), "{}", figure.name);
    }
    figures.into_iter().map(|figure| figure.name).collect()
}

#[test]
fn files_of_arbitrary_numbers_one_sample_or_no_events_are_drawn() {
    let folder = folder();
    let shapes: [(&[&str], usize, usize); 4] =
        [(&["A", "B"], 300, 50), (&["A"], 40, 0), (&["B0"], 1, 3), (&[], 20, 0)];
    for (k, (clearances, samples, events)) in shapes.into_iter().enumerate() {
        let recorded = Recorded::new(clearances, samples, events);
        let names = encode_all(vec![opened(folder.path(), &format!("{k}.h5"), &recorded)]);
        assert!(names.iter().any(|name| name == "energy"));
        assert_eq!(names.iter().any(|name| name == "journal-path"), !clearances.is_empty());
    }
}

#[test]
fn values_that_are_no_numbers_leave_gaps() {
    let folder = folder();
    let mut recorded = Recorded::new(&["A"], 50, 6);
    for (row, observation) in recorded.observations.iter_mut().enumerate() {
        let spoilt = if row % 3 == 0 { f64::NAN } else { f64::INFINITY };
        if row % 2 == 0 {
            observation.clearances[0].offset = [spoilt; 2];
            observation.clearances[0].normal_force = spoilt;
            observation.clearances[0].penetration = spoilt;
            observation.joints[0].force = [spoilt, 1.0];
            observation.bodies[1].angular_acceleration = spoilt;
        }
        observation.drive_torques[0] = f64::NAN;
        observation.energy.residual = f64::NEG_INFINITY;
    }
    for contact in &mut recorded.contacts {
        (contact.peak_time, contact.peak_force) = (f64::NAN, f64::NAN);
    }
    encode_all(vec![opened(folder.path(), "nan.h5", &recorded)]);
}

#[test]
fn a_file_without_samples_or_without_a_readable_case_says_so() {
    let folder = folder();
    let empty = opened(folder.path(), "empty.h5", &Recorded::new(&[], 0, 0));
    assert!(matches!(draw(vec![empty], &Options::default()), Err(Error::NoSamples { .. })));
    let file = opened(folder.path(), "a.h5", &Recorded::new(&["A"], 9, 0));
    let over_angle = Options { over: Over::Angle, ..Options::default() };
    let Err(error @ Error::NoDrive { .. }) = draw(vec![file], &over_angle) else {
        panic!("the case is no case");
    };
    assert!(error.to_string().contains("the case in it cannot be read"), "{error}");
}

#[test]
fn runs_of_one_name_are_told_apart_by_their_files() {
    let folder = folder();
    let files = ["first", "second"]
        .map(|name| opened(folder.path(), &format!("{name}.h5"), &Recorded::new(&["A"], 9, 0)));
    let figures = draw(files.into(), &Options::default()).unwrap();
    let force = figures.iter().find(|figure| figure.name == "force-A").unwrap();
    assert!(force.svg.contains("(a)  first, A") && force.svg.contains("(b)  second, A"));
}

#[test]
fn certified_digits_are_drawn_where_a_file_has_them() {
    let folder = folder();
    let path = Recorded::new(&["A"], 30, 0).write(&folder.path().join("a.h5"), false);
    let digits: Vec<f64> = (0..30).map(|k| 16.0 - 0.5 * f64::from(k)).collect();
    for name in ["reference_digits", "run_digits"] {
        let file = hdf5::File::append(&path).unwrap();
        file.new_dataset_builder().with_data(&digits).create(name).unwrap();
    }
    let figures = draw(vec![ResultFile::open(&path).unwrap()], &Options::default()).unwrap();
    let figure = figures.iter().find(|figure| figure.name == "digits").unwrap();
    assert!(figure.svg.contains(">reference<") && figure.svg.contains(">run<"));
    assert!(!figure.svg.contains("left to double precision"));
}

#[test]
fn digits_that_doubles_have_left_are_drawn_and_none_below_zero() {
    let folder = folder();
    let path = Recorded::new(&["A"], 30, 0).write(&folder.path().join("a.h5"), false);
    let digits: Vec<f64> = (0..30).map(|k| 16.0 - f64::from(k)).collect();
    let file = hdf5::File::append(&path).unwrap();
    file.new_dataset_builder().with_data(&digits).create("digits_left").unwrap();
    drop(file);
    let figures = draw(vec![ResultFile::open(&path).unwrap()], &Options::default()).unwrap();
    let figure = figures.iter().find(|figure| figure.name == "digits").unwrap();
    assert!(figure.svg.contains(">left to double precision<"));
    assert!(figure.svg.contains(">0<") && !figure.svg.contains('−'), "no axis below zero");
}

#[test]
fn outlined_figures_hold_no_text_and_look_the_same() {
    let folder = folder();
    let file = || opened(folder.path(), "a.h5", &Recorded::new(&["A"], 40, 5));
    let force = |outlines| {
        let options = Options { outlines, ..Options::default() };
        let _ = std::fs::remove_file(folder.path().join("a.h5"));
        let figures = draw(vec![file()], &options).unwrap();
        figures.into_iter().find(|figure| figure.name == "force-A").unwrap()
    };
    let [text, outlines] = [false, true].map(force);
    assert!(text.svg.contains("<text ") && !outlines.svg.contains("<text "));
    assert!(outlines.svg.contains("aria-label=\"Time, t ("));
    let pixels = |figure: &freeplay::figure::Figure| {
        let file = figure.encode(Format::Png).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        pixels
    };
    let (text, outlines) = (pixels(&text), pixels(&outlines));
    assert_eq!(text.len(), outlines.len());
    // kerning, and coordinates of a hundredth of a point, move the edges of letters
    let differ = text.iter().zip(&outlines).filter(|(a, b)| a.abs_diff(**b) > 128).count();
    let dark = text.iter().filter(|value| **value < 128).count();
    assert!(differ * 10 < dark, "{differ} of {dark}");
}

#[test]
fn runs_are_called_by_their_labels_and_share_a_panel_if_asked_to() {
    let folder = folder();
    let [first, second] = ["first", "second"].map(|name| {
        Recorded::new(&["A"], 9, 0).write(&folder.path().join(format!("{name}.h5")), false)
    });
    let figures = folder.path().join("figures");
    let labels = ["--only", "force-A", "--overlay", "--label", "c = 1 mm", "--label", "<c>"];
    let plotted = plot(&[&first, &second], &figures, &labels);
    assert!(plotted.status.success(), "{plotted:?}");
    let svg = std::fs::read_to_string(figures.join("force-A.svg")).unwrap();
    for words in [">c = 1 mm<", ">&lt;c&gt;<", ">A<"] {
        assert_eq!(svg.matches(words).count(), 1, "{words}");
    }
    assert!(!svg.contains("(a)"), "one panel");
    let refused = plot(&[&first, &second], &figures, &["--label", "one", "--force"]);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    assert!(told(&refused).contains("labels 1, files 2"), "{}", told(&refused));
}

#[test]
fn torques_that_a_peak_would_flatten_have_a_logarithmic_axis_that_says_so() {
    let folder = folder();
    let svg = |peak: f64| {
        let mut recorded = Recorded::new(&["A"], 200, 0);
        for (row, observation) in recorded.observations.iter_mut().enumerate() {
            observation.drive_torques[0] = (0.1 * row as f64).sin();
        }
        recorded.observations[120].drive_torques[0] = peak;
        let file = opened(folder.path(), &format!("{peak}.h5"), &recorded);
        let figures = draw(vec![file], &Options::default()).unwrap();
        figures.into_iter().find(|figure| figure.name == "torque-crank").unwrap().svg
    };
    let (even, peaked) = (svg(15.0), svg(-400.0));
    assert!(!even.contains("logarithmic"));
    for words in [">logarithmic beyond ±1 N\u{a0}m<", ">−100<", ">−10<", ">−1<", ">0<", ">1<"]
    {
        assert_eq!(peaked.matches(words).count(), 1, "{words}");
    }
}

#[test]
fn a_path_along_the_wall_is_enlarged_and_others_are_not() {
    let folder = folder();
    let figures = folder.path().join("figures");
    let path = |case: &str| {
        let file = run(folder.path(), case);
        let plotted = plot(&[&file], &figures, &["--only", "journal-path", "--force"]);
        assert!(plotted.status.success(), "{plotted:?}");
        std::fs::read_to_string(figures.join("journal-path.svg")).unwrap()
    };
    // 1.2 µm beyond a wall of 1 mm
    let wall = path("journal-in-bearing");
    for words in [">× 100<", ">2 µm<", "overflow=\"hidden\""] {
        assert_eq!(wall.matches(words).count(), 1, "{words}");
    }
    let free = path("four-bar-a");
    assert!(!free.contains(">× ") && !free.contains("overflow"));
}

#[test]
fn figures_of_many_runs_or_joints_break_over_columns_and_are_no_taller_than_a_page() {
    let folder = folder();
    let names: Vec<String> = (1..=40).map(|k| format!("J{k}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let many = opened(folder.path(), "many.h5", &Recorded::new(&names, 5, 80));
    let runs = (0..8)
        .map(|k| opened(folder.path(), &format!("run{k}.h5"), &Recorded::new(&["A"], 30, 10)));
    for (files, pages) in [(vec![many], [1, 3]), (runs.collect(), [1, 1])] {
        let figures = draw(files, &Options::default()).unwrap();
        for figure in &figures {
            assert!(figure.size[1] <= 230.0, "{} is {} mm tall", figure.name, figure.size[1]);
        }
        let count = |kind| figures.iter().filter(|figure| figure.kind == kind).count();
        assert_eq!([count("contact-timeline"), count("journal-path")], pages);
        let torques: Vec<_> = figures.iter().filter(|figure| figure.kind == "torque").collect();
        assert_eq!(torques.len(), 1, "runs stand in two columns of one page");
    }
}

#[test]
fn files_of_one_name_are_told_apart_by_their_folders() {
    let folder = folder();
    let files = ["soft", "stiff"].map(|name| {
        std::fs::create_dir(folder.path().join(name)).unwrap();
        opened(&folder.path().join(name), "run.h5", &Recorded::new(&["A"], 9, 0))
    });
    let figures = draw(files.into(), &Options::default()).unwrap();
    let force = figures.iter().find(|figure| figure.name == "force-A").unwrap();
    assert!(force.svg.contains("soft/run, A") && force.svg.contains("stiff/run, A"));
}

#[test]
fn a_section_of_a_few_turns_says_that_it_shows_no_pattern() {
    let folder = folder();
    let file = run(folder.path(), "four-bar-a");
    let figures = folder.path().join("figures");
    assert!(plot(&[&file], &figures, &["--only", "poincare"]).status.success());
    let svg = std::fs::read_to_string(figures.join("poincare.svg")).unwrap();
    assert!(svg.contains("1 passage, no pattern yet"), "{svg}");
}
