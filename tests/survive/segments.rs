//! Long runs in segments. Known in advance: however a run with checkpoints is stopped, and however
//! often, what it comes to in the end is the same to the byte; what it has passed stays.

use super::desk::{Desk, Said, case, ran, signal};
use super::{EIO, ENOSPC, faults};
use freeplay::record::{Dimension, ResultFile};
use hdf5::types::VarLenUnicode;
use nix::sys::signal::Signal;
use std::process::Stdio;
use std::time::Duration;

/// Cases that differ in what goes on over a checkpoint: engine, friction, adaptive sampling, open
/// contacts, arithmetic, no freedom, and more rows than a block has.
const CASES: [(&str, &[&str]); 8] = [
    ("four-bar-a", &["run.sample_interval=2e-6"]),
    (
        "four-bar-a",
        &[
            "run.sampling=adaptive",
            // checkpoints fall inside of the first and on ends of the second
            "run.window=[{from=2.5e-3,to=4.5e-3,interval=7e-7},{from=6e-3,to=7e-3,interval=1e-6}]",
        ],
    ),
    ("four-bar-a-friction", &["run.sampling=adaptive"]),
    ("four-bar-c", &["solver.engine=explicit", "run.sampling=adaptive"]),
    ("four-bar-b", &["solver.engine=explicit"]),
    ("four-bar-ideal", &["run.sample_interval=3e-5"]),
    ("journal-in-bearing", &["run.duration=0.05", "run.checkpoint_interval=7e-3"]),
    (
        "four-bar-a",
        &[
            "solver.engine=explicit",
            "solver.precision=71",
            "run.duration=2e-4",
            "run.checkpoint_interval=3e-5",
            "solver.reference_tolerance=1e-30",
        ],
    ),
];

/// `run CASE -o OUTPUT` with these keys, in segments of 1 ms.
fn run<'a>(case: &'a str, output: &'a str, keys: &[&'a str]) -> Vec<&'a str> {
    let set = ["run.duration=0.0125", "run.checkpoint_interval=1e-3"];
    let set = set.iter().chain(keys).flat_map(|change| ["--set", change]);
    ["run", case, "-o", output, "--quiet"].into_iter().chain(set).collect()
}

/// The bytes of a result file without the times of day; the checksums of the two blocks that hold
/// these go with them.
fn assert_same_bytes(desk: &Desk, one: &str, other: &str) {
    let masked = |name: &str| {
        let mut bytes = desk.bytes(name);
        let file = desk.open(name);
        for time in ["started_utc", "finished_utc"].map(|name| file.text(name).unwrap()) {
            let places: Vec<usize> = (0..bytes.len() - time.len())
                .filter(|place| bytes[*place..].starts_with(time.as_bytes()))
                .collect();
            places.into_iter().for_each(|place| bytes[place..place + time.len()].fill(b'-'));
        }
        bytes
    };
    let [one, other] = [one, other].map(masked);
    assert_eq!(one.len(), other.len());
    let differing = one.iter().zip(&other).filter(|(a, b)| a != b).count();
    assert!(differing <= 8, "{differing} of {} bytes differ", one.len());
}

/// The segments of an output, each opened.
fn segments(desk: &Desk, output: &str) -> Vec<ResultFile> {
    let folder = desk.path(&format!("{output}.segments"));
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let names = entries.map(|entry| entry.unwrap().path());
    let mut names: Vec<_> = names
        .filter(|path| !path.file_name().unwrap().to_str().unwrap().starts_with('.'))
        .collect();
    names.sort();
    names.iter().map(|path| ResultFile::open(path).unwrap()).collect()
}

fn rows(segments: &[ResultFile]) -> usize {
    segments.iter().map(|segment| segment.length(Dimension::Time)).sum()
}

/// Kills a run over and over after at most so many milliseconds, and takes it up each time; what was
/// there stays there. Gives how often it was killed.
fn kill_often(desk: &Desk, run: &[&str], output: &str, most: u64, times: usize) -> usize {
    let resume = [run, &["--resume"]].concat();
    let mut known = 0;
    for killed in 0..times {
        let mut command = desk.command(&resume);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(fastrand::u64(1..most)));
        child.kill().unwrap();
        if child.wait().unwrap().success() {
            return killed;
        }
        let now = rows(&segments(desk, output));
        assert!(now >= known || desk.path(output).exists(), "{now} rows of {known} are left");
        known = now;
    }
    desk.run(&resume).assert_code(0);
    times
}

#[test]
fn a_run_that_is_killed_at_any_moment_comes_to_the_same_bytes() {
    fastrand::seed(16);
    let asked = std::env::var("FREEPLAY_KILLS").ok();
    let all = asked.map_or(30, |number| number.parse().expect("FREEPLAY_KILLS is a number"));
    let mut kills = 0;
    // each case is killed eight times at most before it may come to its end
    while kills < all {
        kills += kill_each_case();
    }
    println!("{kills} kills");
}

/// Kills a run of each case eight times at most; what it comes to in the end is what it would have
/// been. Gives how often runs were killed.
fn kill_each_case() -> usize {
    let desk = Desk::new();
    let mut kills = 0;
    for (place, (name, keys)) in CASES.iter().enumerate() {
        let (case, whole, killed) =
            (case(name), format!("{place}.h5"), format!("{place}-killed.h5"));
        let took = desk.run(&run(&case, &whole, keys));
        took.assert_code(0);
        let most = took.took.as_millis() as u64 / 2 + 30;
        kills += kill_often(&desk, &run(&case, &killed, keys), &killed, most, 8);
        assert_same_bytes(&desk, &whole, &killed);
    }
    assert!(kills > 0);
    assert!(desk.files().iter().all(|name| name.ends_with(".h5")), "{:?}", desk.files());
    kills
}

#[test]
fn what_a_run_killed_behind_its_end_has_left_goes() {
    let desk = Desk::new();
    let (case, output) = (case("four-bar-a"), "whole.h5");
    let resume = [&run(&case, output, &["run.duration=0.0022"])[..], &["--resume"]].concat();
    desk.run(&resume).assert_code(0);
    // a process that is gone had begun a segment, and not yet removed the other name of its result
    let mut gone = std::process::Command::new("true").spawn().unwrap();
    gone.wait().unwrap();
    let process = gone.id();
    let folder = desk.path("whole.h5.segments");
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(folder.join(format!(".000003.h5.partial-{process}")), "begun").unwrap();
    let other_name = desk.path(&format!(".whole.h5.partial-{process}"));
    std::fs::hard_link(desk.path(output), &other_name).unwrap();
    assert!(desk.run(&resume).assert_code(0).out.contains("complete already"));
    assert!(!other_name.exists() && !folder.exists());
}

#[test]
fn a_run_that_stops_at_each_checkpoint_comes_to_the_same_bytes() {
    let desk = Desk::new();
    for (place, (name, keys)) in CASES.iter().enumerate() {
        let (case, whole, parts) = (case(name), format!("{place}.h5"), format!("{place}-parts.h5"));
        desk.run(&run(&case, &whole, keys)).assert_code(0);
        let stop = [&run(&case, &parts, keys)[..], &["--resume", "--stop-after", "0s"]].concat();
        let mut stops = 0;
        loop {
            let said = desk.run(&stop);
            if said.code == Some(0) {
                break;
            }
            said.assert_code(75);
            stops += 1;
            let told = format!("{stops} segment");
            assert!(said.errors.contains(&told) && said.errors.contains("--resume"), "{said:#?}");
            assert!(!said.errors.contains("error"), "{said:#?}");
            assert!(!desk.path(&parts).exists() && segments(&desk, &parts).len() == stops);
        }
        assert!(stops >= 6, "{name}: {stops} stops");
        assert_same_bytes(&desk, &whole, &parts);
        // and there is nothing left to do
        let again = desk.run(&stop);
        again.assert_code(0);
        assert!(again.out.contains("complete already"), "{again:#?}");
    }
    assert!(desk.files().iter().all(|name| name.ends_with(".h5")), "{:?}", desk.files());
}

#[test]
fn a_run_that_is_made_longer_is_the_longer_run() {
    let desk = Desk::new();
    for (place, (name, keys)) in CASES[..5].iter().enumerate() {
        let (case, longer) = (case(name), format!("{place}.h5"));
        desk.run(&run(&case, &longer, keys)).assert_code(0);
        // an end at a checkpoint, and one between two
        for until in ["0.005", "0.0062"] {
            let (short, shorter) = (format!("{place}-{until}.h5"), format!("run.duration={until}"));
            let keys = [keys, &[&*shorter][..]].concat();
            let short_run = run(&case, &short, &keys);
            desk.run(&short_run).assert_code(0);
            let extend = [&short_run[..], &["--extend", "0.0125"]].concat();
            // it stops on the way, and the shorter run is there until the longer is done
            desk.run(&[&extend[..], &["--stop-after", "0s"]].concat()).assert_code(75);
            assert!(desk.open(&short).is_complete());
            desk.run(&extend).assert_code(0);
            assert_same_bytes(&desk, &longer, &short);
            assert!(desk.run(&extend).assert_code(0).out.contains("complete already"));
        }
    }
    assert!(desk.files().iter().all(|name| name.ends_with(".h5")), "{:?}", desk.files());
}

#[test]
fn segments_are_result_files_for_every_tool() {
    let desk = Desk::new();
    let a = case("four-bar-a");
    let stop = [&run(&a, "a.h5", &[])[..], &["--stop-after", "0s"]].concat();
    desk.run(&stop).assert_code(75);
    desk.run(&[&stop[..], &["--resume"]].concat()).assert_code(75);
    for segment in ["a.h5.segments/000001.h5", "a.h5.segments/000002.h5"] {
        assert_eq!(desk.open(segment).text("run_status"), Some("running"));
        for line in [
            "info FILE",
            "summary FILE",
            "plot FILE -o figures --force",
            "report FILE -o page.html --force",
            "export FILE --to csv -o a.csv --force",
            "compare FILE FILE",
        ] {
            let said = desk.shell(&format!("$FREEPLAY {}", line.replace("FILE", segment)));
            said.assert_code(0);
            assert!(!said.out.contains("next_sample"), "the checkpoint is shown: {said:#?}");
        }
        for tool in ["ncdump", "h5dump"] {
            desk.shell(&format!("{tool} {segment} > dump && test -s dump")).assert_code(0);
        }
    }
    let ends: Vec<f64> =
        segments(&desk, "a.h5").iter().map(|s| *s.times().unwrap().last().unwrap()).collect();
    assert_eq!(ends, [1e-3, 2e-3]);
}

/// Puts another checkpoint into a file.
fn put(file: &hdf5::File, text: &str) {
    file.delete_attr("checkpoint").unwrap();
    let text: VarLenUnicode = text.parse().unwrap();
    let attribute = file.new_attr::<VarLenUnicode>().create("checkpoint").unwrap();
    attribute.write_scalar(&text).unwrap();
    file.flush().unwrap();
}

#[test]
fn a_run_is_not_gone_on_with_by_another_case_or_program() {
    let desk = Desk::new();
    let a = case("four-bar-a");
    let first = run(&a, "a.h5", &[]);
    desk.run(&[&first[..], &["--stop-after", "0s"]].concat()).assert_code(75);
    let kept = desk.bytes("a.h5.segments/000001.h5");
    // anew only if told
    let said = desk.run(&first);
    said.assert_code(3);
    assert!(
        said.errors.contains("a.h5.segments holds a run that has not come to its end"),
        "{said:#?}"
    );
    // a changed key, another case
    let key = "joints.A.clearance.radial=2e-3";
    for other in [run(&a, "a.h5", &[key]), run(&case("four-bar-b"), "a.h5", &[])] {
        let said = desk.run(&[&other[..], &["--resume"]].concat());
        said.assert_code(2);
        assert!(said.errors.contains("000001.h5 is of another case: line "), "{said:#?}");
    }
    // another program
    let file = hdf5::File::open_rw(desk.path("a.h5.segments/000001.h5")).unwrap();
    let mark = desk.open("a.h5.segments/000001.h5").text("checkpoint").unwrap().to_owned();
    let resume = [&first[..], &["--resume"]].concat();
    put(&file, &mark.replace("freeplay ", "freeplay 99."));
    let said = desk.run(&resume);
    said.assert_code(2);
    assert!(said.errors.contains("was written by freeplay 99."), "{said:#?}");
    // what cannot be: text that is none, states of another mechanism, rows that are not there
    let number =
        |text: &str| text.replacen("\\\"v\\\":[", "\\\"v\\\":[\\\"0000000000000000\\\",", 1);
    for (wrong, code) in [
        ("{}".to_owned(), 3),
        (mark.replace("\"rows\":[", "\"rows\":[7"), 3),
        (mark.replace("\"blocks\":\"", "\"blocks\":\"9"), 3),
        (number(&mark), 4),
        (mark.replace("next_sample", "next_simple"), 4),
    ] {
        assert_ne!(wrong, mark);
        put(&file, &wrong);
        let said = desk.run(&resume);
        assert!(said.code == Some(code) && !said.errors.contains("panicked"), "{said:#?}");
        let _ = std::fs::remove_file(desk.path("a.h5"));
    }
    drop(file);
    desk.file("a.h5.segments/000001.h5", &kept);
    desk.file("a.h5.segments/000003.h5", &kept);
    let said = desk.run(&resume);
    said.assert_code(3);
    assert!(said.errors.contains("000002.h5 is missing"), "{said:#?}");
    std::fs::remove_file(desk.path("a.h5.segments/000003.h5")).unwrap();
    // told so, it begins anew
    let anew = run(&a, "a.h5", &[key]);
    desk.run(&[&anew[..], &["--force"]].concat()).assert_code(0);
    assert_eq!(desk.files(), ["a.h5"]);
    // a result that another program has made is not the whole of it, and stays unless told
    let file = hdf5::File::open_rw(desk.path("a.h5")).unwrap();
    let mark = desk.open("a.h5").text("checkpoint").unwrap().replace("freeplay ", "freeplay 99.");
    put(&file, &mark);
    drop(file);
    let again = desk.run(&[&anew[..], &["--resume"]].concat());
    assert!(again.assert_code(3).errors.contains("a.h5 exists"), "{again:#?}");
    let again = desk.run(&[&anew[..], &["--resume", "--force"]].concat());
    assert!(!again.assert_code(0).out.contains("complete already"), "{again:#?}");
}

#[test]
fn what_needs_checkpoints_says_so() {
    let desk = Desk::new();
    let a = case("four-bar-a");
    let plain = ["run", &a, "-o", "a.h5", "--quiet", "--set", "run.duration=1e-3"];
    for option in [&["--resume"][..], &["--stop-after", "1h"], &["--extend", "0.1"]] {
        let said = desk.run(&[&plain[..], option].concat());
        said.assert_code(2);
        let told = format!("{} needs a case with run.checkpoint_interval", option[0]);
        assert!(said.errors.contains(&told), "{said:#?}");
    }
    let kept = run(&a, "a.h5", &["run.duration=2.5e-3"]);
    let longer = [&kept[..], &["--extend", "0.005"]].concat();
    assert!(desk.run(&longer).assert_code(2).errors.contains("a.h5 is not there"));
    desk.run(&kept).assert_code(0);
    let shorter = desk.run(&[&kept[..], &["--extend", "0.002"]].concat());
    assert!(shorter.assert_code(2).errors.contains("not shorter"), "{shorter:#?}");
    let other = run(&a, "a.h5", &["run.duration=2.5e-3", "joints.A.clearance.radial=2e-3"]);
    let other = desk.run(&[&other[..], &["--extend", "0.005"]].concat());
    assert!(other.assert_code(2).errors.contains("of another case: line "), "{other:#?}");
    desk.run(&[&plain[..], &["--force"]].concat()).assert_code(0);
    let said = desk.run(&longer);
    assert!(said.assert_code(2).errors.contains("of another case"), "{said:#?}");
    for (interval, why) in [("0", "must be positive"), ("1e-9", "is too small"), ("x", "a number")]
    {
        let set = format!("run.checkpoint_interval={interval}");
        let said = desk.run(&run(&a, "b.h5", &[&set]));
        said.assert_code(2);
        assert!(said.errors.contains("run.checkpoint_interval") && said.errors.contains(why));
    }
}

#[test]
fn a_run_that_is_asked_to_stop_can_be_taken_up() {
    let desk = Desk::new();
    let a = case("four-bar-a");
    desk.run(&run(&a, "whole.h5", &["run.duration=0.12"])).assert_code(0);
    let stopped = run(&a, "a.h5", &["run.duration=0.12"]);
    let mut command = desk.command(&stopped);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    super::desk::wait_for(|| desk.path("a.h5.segments/000002.h5").exists());
    // nobody else writes it meanwhile
    for option in ["--resume", "--force"] {
        let second = desk.run(&[&stopped[..], &[option]].concat());
        second.assert_code(3);
        assert!(second.errors.contains("a.h5 is being written by process"), "{second:#?}");
    }
    signal(&child, Signal::SIGTERM);
    let said = Said::of(child.wait_with_output().unwrap(), Duration::ZERO);
    said.assert_code(143);
    assert!(said.errors.contains("--resume goes on from checkpoint"), "{said:#?}");
    // what it had told since is there, too, and makes room for the rest
    assert_eq!(desk.open("a.h5").text("run_status"), Some("failed"));
    desk.run(&[&stopped[..], &["--resume"]].concat()).assert_code(0);
    assert_same_bytes(&desk, "whole.h5", "a.h5");
    assert_eq!(desk.files(), ["a.h5", "whole.h5"]);
}

#[test]
fn nothing_that_was_passed_is_lost_when_writes_fail() {
    let desk = Desk::new();
    let library = faults(&desk);
    let a = case("four-bar-a");
    let keys = ["run.duration=1.5e-3", "run.sample_interval=1e-4"];
    let whole = [&run(&a, "whole.h5", &keys)[..], &["--no-tangent"]].concat();
    desk.run(&whole).assert_code(0);
    let kept = [&run(&a, "a.h5", &keys)[..], &["--no-tangent"]].concat();
    let resume = [&kept[..], &["--resume"]].concat();
    for (errno, lasts, stride) in [(EIO, "0", 3), (ENOSPC, "1", 11)] {
        let mut failures = 0;
        for call in (1..).step_by(stride) {
            let mark = desk.path("mark");
            let mut command = desk.command(&kept);
            command
                .env("LD_PRELOAD", &library)
                .env("FAULT_AT", call.to_string())
                .env("FAULT_ERRNO", errno.to_string())
                .env("FAULT_LASTS", lasts)
                .env("FAULT_MARK", &mark);
            let said = ran(&mut command);
            let failed = mark.exists();
            let _ = std::fs::remove_file(&mark);
            let told = format!("call {call}, errno {errno}: {said:#?}");
            if said.code != Some(0) {
                said.assert_code(3);
                assert!(said.errors.contains("error: ") && said.errors.contains("a.h5"), "{told}");
                failures += 1;
                // each that is there is whole
                let segments = segments(&desk, "a.h5");
                assert!(segments.iter().all(|s| s.text("checkpoint").is_some()), "{told}");
                desk.run(&resume).assert_code(0);
            }
            assert_same_bytes(&desk, "whole.h5", "a.h5");
            let left = desk.files();
            let left: Vec<&String> =
                left.iter().filter(|name| !name.ends_with(".failed.h5")).collect();
            assert_eq!(left, ["a.h5", "faults.so", "whole.h5"], "{told}");
            std::fs::remove_file(desk.path("a.h5")).unwrap();
            let _ = std::fs::remove_file(desk.path("a.failed.h5"));
            if !failed {
                break;
            }
        }
        assert!(failures * stride > 100, "{failures}");
    }
}
