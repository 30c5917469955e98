//! What strangers, full disks and signals do. Known in advance: no input is ever destroyed; what was
//! damaged on its way to the disk is never called complete; nothing outside a file is read because
//! the file says so; whoever asks to stop is heard.

#[path = "survive/desk.rs"]
mod desk;
#[path = "survive/segments.rs"]
mod segments;

use desk::{Desk, Said, case, ran, signal, wait_for};
use freeplay::record::{DATASETS, Dimension};
use hdf5::types::{VarLenAscii, VarLenUnicode};
use hdf5::{Extent, File, SimpleExtents};
use nix::sys::signal::Signal;
use std::fmt::Write;
use std::os::unix::fs::{MetadataExt, symlink};
use std::process::{Command, Stdio};
use std::time::Duration;

/// `--set` for a run that takes no time.
const SHORT: [&str; 4] = ["--set", "run.duration=1e-3", "--set", "run.sample_interval=1e-4"];
/// `--set` for a run that would take for ever.
const LONG: [&str; 4] = ["--set", "run.duration=900", "--set", "run.sample_interval=1e-5"];

/// A desk with a short run of a four-bar with clearance, `run.h5`.
fn with_a_run() -> Desk {
    let desk = Desk::new();
    let a = case("four-bar-a");
    desk.run(&[&["run", &a, "-o", "run.h5", "--quiet"], &SHORT[..]].concat()).assert_code(0);
    desk
}

// Inputs

#[test]
fn no_command_writes_over_what_it_reads() {
    let desk = with_a_run();
    let text = std::fs::read_to_string(case("pendulum")).unwrap();
    desk.file("case.toml", text);
    std::fs::copy(desk.path("run.h5"), desk.path("force-A.svg")).unwrap();
    std::fs::copy(desk.path("run.h5"), desk.path("run.ombvx")).unwrap();
    std::fs::copy(desk.path("run.h5"), desk.path("page.ombvh5")).unwrap();
    symlink("run.h5", desk.path("link.h5")).unwrap();
    std::fs::hard_link(desk.path("run.h5"), desk.path("second.h5")).unwrap();
    let before: Vec<(String, Vec<u8>)> =
        desk.files().into_iter().map(|name| (name.clone(), desk.bytes(&name))).collect();
    let reference = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/certified/pendulum.h5");
    std::fs::copy(reference, desk.path("reference.h5")).unwrap();
    for line in [
        "run case.toml -o case.toml",
        "run ./case.toml -o case.toml",
        "run case.toml --set run.duration=0.01 -o ../$(basename $PWD)/case.toml",
        "certify case.toml -o case.toml",
        "certify case.toml --reference reference.h5 -o reference.h5",
        "export run.h5 --to csv -o run.h5",
        "export run.h5 --to parquet -o link.h5",
        "export link.h5 --to csv -o run.h5",
        "export run.h5 --to csv -o second.h5",
        "export run.ombvx --to openmbv -o run.ombvx",
        "export page.ombvh5 --to openmbv -o page.ombvx",
        "plot force-A.svg -o .",
        "report run.h5 -o run.h5",
        "report case.toml run.h5 -o run.h5 2>&1 || $FREEPLAY report force-A.svg run.h5 -o link.h5",
    ] {
        let said = desk.shell(&format!("$FREEPLAY {line} --force"));
        said.assert_code(3);
        assert!(said.errors.contains("is an input of this command"), "{line}: {said:#?}");
    }
    for (name, bytes) in before {
        assert_eq!(desk.bytes(&name), bytes, "{name}");
    }
    assert_eq!(desk.bytes("reference.h5"), std::fs::read(reference).unwrap());
    assert!(!desk.files().iter().any(|name| name.contains("partial")), "{:?}", desk.files());
}

// Writes

/// A library of faults, made of `survive/faults.c`.
fn faults(desk: &Desk) -> String {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/survive/faults.c");
    let made = desk.path("faults.so");
    let mut gcc = Command::new("gcc");
    gcc.args(["-shared", "-fPIC", "-O1", "-o"]).arg(&made).arg(source).arg("-ldl");
    let output = gcc.output().expect("gcc, which builds need as well");
    assert!(output.status.success(), "{output:?}");
    made.into_os_string().into_string().unwrap()
}

/// Attributes in words, and datasets bit by bit.
type Contents = (Vec<(String, String)>, Vec<(&'static str, Vec<u64>)>);

/// What is in a result file but for the times of day.
fn contents(desk: &Desk, name: &str) -> Contents {
    let file = desk.open(name);
    let attributes = file.attributes().iter().filter(|(name, _)| !name.ends_with("_utc"));
    let attributes = attributes.map(|(name, value)| (name.clone(), format!("{value:?}")));
    let tables = DATASETS.iter().filter_map(|dataset| file.table(dataset.name).ok());
    let bits = |table: freeplay::record::Table| {
        (table.dataset.name, table.values.iter().map(|value| value.to_bits()).collect())
    };
    (attributes.collect(), tables.map(bits).collect())
}

const EIO: i32 = 5;
const ENOSPC: i32 = 28;

/// Has every call that writes fail, one after another: for each the command says so with exit
/// code 3 and leaves the old file, or has what it would have had without. Gives the number of calls.
fn fail_each_call(
    desk: &Desk,
    library: &str,
    arguments: &[&str],
    outputs: &[&str],
    (errno, lasts): (i32, bool),
    whole: impl Fn() -> bool,
) -> usize {
    let old: Vec<Vec<u8>> = outputs.iter().map(|name| desk.bytes(name)).collect();
    let quiet: Vec<String> = desk.files();
    for call in 1..=400 {
        let mark = desk.path("mark");
        let mut command = desk.command(arguments);
        command
            .env("LD_PRELOAD", library)
            .env("FAULT_AT", call.to_string())
            .env("FAULT_ERRNO", errno.to_string())
            .env("FAULT_LASTS", if lasts { "1" } else { "0" })
            .env("FAULT_MARK", &mark);
        let said = ran(&mut command);
        let failed = mark.exists();
        let _ = std::fs::remove_file(&mark);
        let told = format!("{arguments:?}, call {call}, errno {errno}: {said:#?}");
        if !failed {
            said.assert_code(0);
            assert!(whole(), "{told}");
            return call - 1;
        }
        if said.code == Some(0) {
            assert!(whole(), "called complete: {told}");
        } else {
            said.assert_code(3);
            let names = said.errors.lines().any(|line| {
                line.starts_with("error: ") && outputs.iter().any(|name| line.contains(name))
            });
            assert!(names, "{told}");
        }
        // what was there before is there again, for the next; a result that could not be put in its
        // place may lie beside it
        // once they stand there, names may be whole and yet not be durable
        let named = said.errors.contains("cannot make durable") && whole();
        // where no name can be changed any more, the old file is said to be elsewhere, and is there
        let aside = |name: &str, bytes: &[u8]| {
            let mut words = said.errors.split_whitespace();
            let at = words.find(|word| word.contains(".old-")).unwrap_or_default();
            let found = !at.is_empty() && at.starts_with(name.split('.').next().unwrap());
            found && desk.bytes(at) == bytes
        };
        for (name, bytes) in outputs.iter().zip(&old) {
            let kept = desk.bytes(name) == *bytes || aside(name, bytes);
            assert!(said.code == Some(0) || kept || named, "{name} is lost: {told}");
            std::fs::write(desk.path(name), bytes).unwrap();
        }
        for name in desk.files().iter().filter(|name| !quiet.contains(name)) {
            if name.contains(".old-") && said.errors.contains(name.as_str()) {
                std::fs::remove_file(desk.path(name)).unwrap();
                continue;
            }
            assert!(name.contains("failed"), "{name} is left: {told}");
            // what there was is kept, and says what it is
            assert_eq!(desk.open(name).text("run_status"), Some("failed"), "{told}");
            std::fs::remove_file(desk.path(name)).unwrap();
        }
    }
    panic!("{arguments:?} has more than 400 calls that write");
}

#[test]
fn a_run_is_complete_only_if_every_write_has_arrived() {
    let desk = with_a_run();
    let library = faults(&desk);
    desk.file("old.h5", "old");
    let a = case("four-bar-a");
    let run = ["run", &a, "-o", "old.h5", "--force", "--quiet", "--no-tangent"];
    let run = [&run[..], &SHORT].concat();
    desk.run(&run).assert_code(0);
    let good = contents(&desk, "old.h5");
    for fault in [(EIO, false), (ENOSPC, true)] {
        desk.file("old.h5", "old");
        let calls = fail_each_call(&desk, &library, &run, &["old.h5"], fault, || {
            contents(&desk, "old.h5") == good
        });
        assert!(calls > 20, "{calls}");
    }
}

#[test]
fn a_certificate_is_whole_or_not_there() {
    let desk = Desk::new();
    let library = faults(&desk);
    let reference = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/certified/pendulum.h5");
    let pendulum = case("pendulum");
    let certify = ["certify", &pendulum, "--reference", reference, "--until", "0.1", "--quiet"];
    let certify = [&certify[..], &["-o", "a.h5", "--force"]].concat();
    desk.run(&certify).assert_code(0);
    let good = contents(&desk, "a.h5");
    for fault in [(EIO, false), (ENOSPC, true)] {
        desk.file("a.h5", "old");
        let calls = fail_each_call(&desk, &library, &certify, &["a.h5"], fault, || {
            // the seal is over what the table of datasets has not, too
            let sealed = desk.open("a.h5").seal().unwrap() == freeplay::record::Seal::Whole;
            sealed && contents(&desk, "a.h5") == good
        });
        assert!(calls > 20, "{calls}");
    }
}

/// What is in a file, but for the times that HDF5 keeps of groups.
fn gist(desk: &Desk, name: &str) -> Vec<u8> {
    if !name.ends_with(".ombvh5") {
        return desk.bytes(name);
    }
    let file = File::open(desk.path(name)).unwrap();
    let mut gist = Vec::new();
    for group in ["bodies", "forces"].map(|name| file.group(name).unwrap()) {
        for thing in group.groups().unwrap() {
            let data = thing.dataset("data").unwrap();
            gist.extend(data.name().into_bytes());
            gist.extend(data.read_raw::<f64>().unwrap().into_iter().flat_map(f64::to_le_bytes));
            let labels = data.attr("Column Label").unwrap().read_raw::<VarLenAscii>().unwrap();
            gist.extend(labels.iter().flat_map(|label| label.as_bytes().to_vec()));
        }
    }
    gist
}

#[test]
fn exports_pages_and_figures_are_whole_or_not_there() {
    let desk = with_a_run();
    let library = faults(&desk);
    let commands: [(&[&str], &[&str]); 6] = [
        (&["export", "run.h5", "--to", "csv", "-o", "a.csv"], &["a.csv"]),
        (&["export", "run.h5", "--to", "parquet", "-o", "a.parquet"], &["a.parquet"]),
        (&["export", "run.h5", "--to", "openmbv", "-o", "a.ombvx"], &["a.ombvx", "a.ombvh5"]),
        (&["report", "run.h5", "-o", "a.html"], &["a.html"]),
        (&["plot", "run.h5", "-o", ".", "--only", "force-A"], &["force-A.svg"]),
        (&["new", "pendulum", "-o", "a.toml"], &["a.toml"]),
    ];
    for (command, outputs) in commands {
        desk.run(command).assert_code(0);
        let good: Vec<Vec<u8>> = outputs.iter().map(|name| gist(&desk, name)).collect();
        for fault in [(EIO, false), (ENOSPC, true)] {
            for name in outputs {
                desk.file(name, "old");
            }
            let forced = [command, &["--force"]].concat();
            let calls = fail_each_call(&desk, &library, &forced, outputs, fault, || {
                outputs.iter().zip(&good).all(|(name, good)| gist(&desk, name) == *good)
            });
            assert!(calls >= 3, "{command:?}: {calls}");
        }
        outputs.iter().for_each(|name| std::fs::remove_file(desk.path(name)).unwrap());
    }
}

#[test]
fn a_file_that_may_not_grow_is_an_error_of_writing() {
    let desk = Desk::new();
    let line = format!("ulimit -f 64; exec $FREEPLAY run {} -o a.h5 --quiet", case("four-bar-a"));
    let said = desk.shell(&line);
    said.assert_code(3);
    assert!(said.errors.contains("a.h5") && said.errors.contains("File too large"), "{said:#?}");
    assert!(desk.files().is_empty(), "{:?}", desk.files());
}

#[test]
fn memory_that_runs_out_is_a_clear_end() {
    let desk = with_a_run();
    desk.file("theirs.csv", format!("time,x\n{}", "1e-4,1.0000000000000\n".repeat(5_000_000)));
    let said = desk.shell("ulimit -v 180000; exec $FREEPLAY compare theirs.csv run.h5");
    said.assert_code(4);
    assert!(said.errors.contains("memory allocation of"), "{said:#?}");
}

// Signals

#[test]
fn a_dropped_connection_and_spent_time_stop_a_run_as_a_request_does() {
    for (sent, code) in [(Signal::SIGHUP, 129), (Signal::SIGXCPU, 152)] {
        let desk = Desk::new();
        let a = case("four-bar-a");
        let run = [&["run", &a, "-o", "long.h5"], &LONG[..]].concat();
        let child = desk.long_run(&mut desk.command(&run));
        signal(&child, sent);
        let said = Said::of(child.wait_with_output().unwrap(), Duration::ZERO);
        said.assert_code(code);
        assert_eq!(desk.files(), ["long.h5"]);
        let file = desk.open("long.h5");
        assert_eq!(file.text("run_status"), Some("failed"));
        assert!(file.length(Dimension::Time) > 1000);
    }
}

#[test]
fn what_was_ignored_at_the_begin_stays_ignored() {
    let desk = Desk::new();
    let line = format!(
        "trap '' HUP; exec $FREEPLAY run {} -o long.h5 {}",
        case("four-bar-a"),
        LONG.join(" ")
    );
    let mut command = Command::new("sh");
    command.args(["-c", &line]).current_dir(&desk.folder).stdin(Stdio::null());
    let child = desk.long_run(command.env("FREEPLAY", env!("CARGO_BIN_EXE_freeplay")));
    signal(&child, Signal::SIGHUP);
    std::thread::sleep(Duration::from_millis(300));
    signal(&child, Signal::SIGTERM);
    Said::of(child.wait_with_output().unwrap(), Duration::ZERO).assert_code(143);
    assert_eq!(desk.files(), ["long.h5"]);
}

#[test]
fn what_a_killed_run_leaves_the_next_one_removes() {
    let desk = Desk::new();
    let a = case("four-bar-a");
    let mut child =
        desk.long_run(&mut desk.command(&[&["run", &a, "-o", "long.h5"], &LONG[..]].concat()));
    let second = desk.run(&[&["run", &a, "-o", "long.h5"], &SHORT[..]].concat());
    second.assert_code(3);
    let told = format!("is being written by process {}", child.id());
    assert!(second.errors.contains(&told), "{second:#?}");
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(desk.files().iter().all(|name| name.starts_with(".long.h5.partial-")));
    desk.run(&[&["run", &a, "-o", "other.h5"], &SHORT[..]].concat()).assert_code(0);
    assert_eq!(desk.files(), ["other.h5"]);
}

#[test]
fn commands_that_write_leave_nothing_when_they_are_stopped() {
    let desk = Desk::new();
    let pendulum = case("pendulum");
    let many = ["--set", "run.duration=2", "--set", "run.sample_interval=4e-6"];
    desk.run(&[&["run", &pendulum, "-o", "run.h5", "--quiet", "--no-tangent"], &many[..]].concat())
        .assert_code(0);
    for line in [
        "export run.h5 --to csv -o out.csv",
        "export run.h5 --to parquet -o out.parquet",
        "export run.h5 --to openmbv -o out.ombvx",
    ] {
        let arguments: Vec<&str> = line.split(' ').collect();
        let mut command = desk.command(&arguments);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        wait_for(|| desk.files().iter().any(|name| name.contains("partial")));
        signal(&child, Signal::SIGTERM);
        let said = Said::of(child.wait_with_output().unwrap(), Duration::ZERO);
        assert_eq!(said.code, Some(143), "{line}: {said:#?}");
        assert_eq!(desk.files(), ["run.h5"], "{line}");
    }
}

#[test]
fn a_run_hears_a_request_however_long_its_steps_and_however_many_its_samples() {
    let fast = ["--set", "drives.crank.speed_rpm=1e30"];
    let dense =
        ["--no-tangent", "--set", "run.duration=1e-2", "--set", "run.sample_interval=1.4e-10"];
    for (name, more) in [("four-bar-ideal", &fast[..]), ("four-bar-a", &dense[..])] {
        let desk = Desk::new();
        let a = case(name);
        let mut command = desk.command(&[&["run", &a, "-o", "a.h5"], more].concat());
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(1500));
        assert!(child.try_wait().unwrap().is_none(), "{name} ended by itself");
        let begun = std::time::Instant::now();
        signal(&child, Signal::SIGTERM);
        let said = Said::of(child.wait_with_output().unwrap(), begun.elapsed());
        said.assert_code(143);
        // two seconds, on a machine that does much else besides
        assert!(said.took < Duration::from_secs(20), "{name} took {:?}", said.took);
    }
}

// Hostile result files

/// Changes a copy of a result file.
fn changed(desk: &Desk, name: &str, change: impl FnOnce(&File) -> hdf5::Result<()>) {
    std::fs::copy(desk.path("run.h5"), desk.path(name)).unwrap();
    let file = File::open_rw(desk.path(name)).unwrap();
    change(&file).unwrap();
    file.close().unwrap();
}

/// Every command that reads a result.
fn readers(file: &str) -> [Vec<&str>; 8] {
    [
        vec!["info", file],
        vec!["summary", file],
        vec!["summary", "run.h5", "--against", file],
        vec!["plot", file, "-o", "figures", "--force"],
        vec!["report", file, "-o", "page.html", "--force"],
        vec!["export", file, "--to", "csv", "-o", "a.csv", "--force"],
        vec!["compare", file, "run.h5"],
        vec!["compare", "run.h5", file],
    ]
}

fn assert_refused(desk: &Desk, file: &str, why: &str) {
    for arguments in readers(file) {
        let said = desk.run_within(2, &arguments);
        said.assert_code(2);
        assert!(
            said.errors.contains(why) && said.errors.contains(file),
            "{arguments:?}: {said:#?}"
        );
    }
}

/// A dataset without numbers of its own is none of a result: virtual ones, external ones.
#[test]
fn nothing_outside_a_result_file_is_read() {
    let desk = with_a_run();
    let secret = desk.path("secret");
    std::fs::write(&secret, [0_u8; 4096]).unwrap();
    let fifo = desk.path("fifo");
    assert!(Command::new("mkfifo").arg(&fifo).status().unwrap().success());
    for (name, at) in [("external.h5", &secret), ("fifo.h5", &fifo)] {
        changed(&desk, name, |file| {
            file.unlink("energy_kinetic")?;
            let at = at.to_str().unwrap();
            let plan = file.new_dataset::<f64>().external(at, 0, 88);
            plan.shape(11).create("energy_kinetic").map(drop)
        });
        assert_refused(&desk, name, "has its values in another file");
    }
    changed(&desk, "self.h5", |file| {
        file.unlink("energy_kinetic")?;
        let plan = file.new_dataset::<f64>();
        let plan = plan.virtual_map("self.h5", "energy_kinetic", 11, .., 11, ..);
        plan.shape(11).create("energy_kinetic").map(drop)
    });
    assert_refused(&desk, "self.h5", "is put together from other datasets");
    changed(&desk, "link.h5", |file| {
        file.unlink("energy_kinetic")?;
        file.link_external("run.h5", "energy_kinetic", "energy_kinetic")
    });
    assert_refused(&desk, "link.h5", "is a link to elsewhere");
    changed(&desk, "soft.h5", |file| {
        file.unlink("energy_kinetic")?;
        file.link_soft("/energy_kinetic", "energy_kinetic")
    });
    assert_refused(&desk, "soft.h5", "is a link to elsewhere");
}

#[test]
fn a_claim_beyond_the_file_is_refused_before_memory_is_asked_for() {
    let desk = with_a_run();
    changed(&desk, "claims.h5", |file| {
        let along = DATASETS.iter().filter(|dataset| dataset.rows() == Dimension::Time);
        for dataset in along.filter(|dataset| !dataset.is_optional()) {
            let handle = file.dataset(dataset.name)?;
            let mut shape = handle.shape();
            shape[0] = 10_000_000_000;
            handle.resize(shape)?;
        }
        Ok(())
    });
    assert_refused(&desk, "claims.h5", "claims the shape [10000000000");
    changed(&desk, "chunk.h5", |file| {
        file.unlink("energy_kinetic")?;
        let extents = SimpleExtents::from_vec(vec![Extent::resizable(11)]);
        let plan = file.new_dataset::<f64>().deflate(4).chunk(400_000_000).shape(extents);
        plan.create("energy_kinetic").map(drop)
    });
    assert_refused(&desk, "chunk.h5", "is in chunks of [400000000]");
}

#[test]
fn arrays_of_others_are_read_where_they_are_and_once() {
    let desk = with_a_run();
    std::fs::write(desk.path("secret"), [0_u8; 800]).unwrap();
    let file = File::create(desk.path("theirs.h5")).unwrap();
    let times: Vec<f64> = (0..11).map(|k| f64::from(k) * 1e-4).collect();
    file.new_dataset_builder().with_data(&times).create("time").unwrap();
    file.new_dataset_builder().with_data(&times).create("angle_coupler").unwrap();
    let group = file.create_group("group").unwrap();
    // round and round, in many ways: 40^8 without a memory of where one has been
    for k in 0..40 {
        group.link_hard("/group", &format!("again{k}")).unwrap();
    }
    file.link_external("run.h5", "angle", "outside").unwrap();
    let secret = desk.path("secret");
    let plan = file.new_dataset::<f64>().external(secret.to_str().unwrap(), 0, 88);
    plan.shape(11).create("stolen").unwrap();
    let extents = SimpleExtents::from_vec(vec![Extent::resizable(10_000_000_000_usize)]);
    file.new_dataset::<f64>().chunk(1024).shape(extents).create("vast").unwrap();
    drop(group);
    file.close().unwrap();
    let said = desk.run_within(2, &["compare", "theirs.h5", "run.h5", "--map", "x=angle.coupler"]);
    said.assert_code(2);
    for part in [
        "outside\" (left out: it is a link to elsewhere",
        "stolen\" (left out: it has its values in another file",
        "vast\" (left out: it claims the shape",
    ] {
        assert!(said.errors.contains(part), "no {part} in {said:#?}");
    }
}

// Text

/// Whether a text would give a terminal an order, or fake a message.
fn is_raw(text: &str) -> bool {
    text.contains(|c: char| c.is_control() && c != '\n' && c != '\t' || c == '\u{202e}')
        || text.lines().any(|line| line.starts_with("error: all is lost"))
}

const NASTY: &str = "a\x1b[31mb\x07\r\u{9b}2J\u{202e}\nerror: all is lost";

#[test]
fn titles_and_names_give_a_terminal_no_orders() {
    let desk = with_a_run();
    let text = std::fs::read_to_string(case("four-bar-a")).unwrap();
    let title = format!("title = {:?}", "").replace("\"\"", &toml_string(NASTY));
    let text: Vec<&str> =
        text.lines().map(|line| if line.starts_with("title") { &*title } else { line }).collect();
    desk.file("nasty.toml", text.join("\n"));
    let run = [&["run", "nasty.toml", "-o", "nasty.h5", "--quiet"], &SHORT[..]].concat();
    let figures = ["plot", "nasty.h5", "-o", "figures"];
    for arguments in [
        &run[..],
        &["check", "nasty.toml"],
        &["check", "nasty.toml", "--json"],
        &["info", "nasty.h5"],
        &["info", "nasty.h5", "--json"],
        &["summary", "nasty.h5"],
        &["summary", "nasty.h5", "--json"],
        &["summary", "run.h5", "--against", "nasty.h5"],
        &["compare", "run.h5", "nasty.h5"],
        &["report", "nasty.h5", "-o", "page.html"],
        &figures,
    ] {
        let said = desk.run(arguments);
        said.assert_code(0);
        assert!(!is_raw(&said.out) && !is_raw(&said.errors), "{arguments:?}: {said:#?}");
        if arguments.contains(&"--json") {
            let told: serde_json::Value = serde_json::from_str(&said.out).unwrap();
            assert_eq!(told["title"], NASTY, "{arguments:?}");
        }
    }
    let page = std::fs::read_to_string(desk.path("page.html")).unwrap();
    assert!(!page.contains("\x1b"), "the page has it raw");
    // what is complained of is shown, too
    let bad = format!("[bodies.{}]\nmass = {}\n", toml_string(NASTY), toml_string(NASTY));
    let said = desk.run(&["check", desk.file("bad.toml", bad)]);
    said.assert_code(2);
    assert!(!is_raw(&said.errors), "{said:#?}");
    let said = desk.run(&["check", NASTY]);
    assert!(!is_raw(&said.assert_code(2).errors), "{said:#?}");
}

fn toml_string(text: &str) -> String {
    let escaped = text.chars().map(|c| match c.is_control() || c == '\u{202e}' {
        true => format!("\\u{:04x}", c as u32),
        false => c.to_string(),
    });
    format!("\"{}\"", escaped.collect::<String>())
}

#[test]
fn names_in_result_files_are_names_as_cases_have_them() {
    let desk = with_a_run();
    for name in ["=1+2", "\x1b[2J", "a-b", "", "follower", "<b>"] {
        changed(&desk, "names.h5", |file| {
            let scale = file.dataset("body")?;
            scale.delete_attr("flag_meanings")?;
            let names: VarLenUnicode = format!("{name} coupler follower").parse().unwrap();
            scale.new_attr::<VarLenUnicode>().create("flag_meanings")?.write_scalar(&names)
        });
        for arguments in readers("names.h5") {
            let said = desk.run(&arguments);
            said.assert_code(2);
            assert!(said.errors.contains("is damaged: body"), "{arguments:?}: {said:#?}");
            assert!(!is_raw(&said.errors), "{said:#?}");
        }
    }
}

#[test]
fn a_name_of_100_megabytes_is_told_by_its_begin() {
    let desk = with_a_run();
    let long = "x".repeat(100_000_000);
    desk.file("theirs.csv", format!("time,{long}\n0,1\n1e-4,1\n"));
    let said = desk.run(&["compare", "theirs.csv", "run.h5"]);
    said.assert_code(2);
    assert!(said.errors.len() < 10_000 && said.out.is_empty(), "{}", said.errors.len());
    let key = "x".repeat(900_000);
    let said = desk.run_within(2, &["check", desk.file("long.toml", format!("{key} = 1\n"))]);
    said.assert_code(2);
    assert!(said.errors.len() < 10_000, "{}", said.errors.len());
}

// Hostile cases

#[test]
fn whatever_is_refused_is_refused_at_once_and_in_a_hundred_lines() {
    let text = std::fs::read_to_string(case("four-bar-a")).unwrap();
    let many = |line: &dyn Fn(usize) -> String, count: usize| {
        (0..count).fold(String::new(), |mut all, k| {
            let _ = writeln!(all, "{}", line(k));
            all
        })
    };
    let keys = many(&|k| format!("key{k} = 1"), 60_000);
    let bodies = many(&|k| format!("[bodies.b{k}]"), 40_000);
    let joints = many(&|k| format!("joints.j{k}.between = [\"c{k}.P\", \"d{k}.P\"]"), 15_000);
    let starts = many(&|k| format!("start.b{k} = {{ x = 1, y = true }}"), 25_000);
    let names = many(&|k| format!("bodies.\"-{k}\" = {{ mass = 0, inertia = 0 }}"), 15_000);
    let digits = text.replacen("mass    = 0.3 ", &format!("mass = 0.{} ", "3".repeat(900_000)), 1);
    let power = text.replacen("mass    = 0.3 ", &format!("mass = 1e{} ", "9".repeat(900_000)), 1);
    let deep = format!("a = {}{}", "[".repeat(400_000), "]".repeat(400_000));
    let dotted = format!("{}a = 1", "a.".repeat(400_000));
    let cases = [
        ("keys", format!("{keys}{text}"), Some(60_000)),
        ("bodies", format!("{text}\n{bodies}"), Some(80_000)),
        ("joints", format!("{joints}{text}"), None),
        ("starts", starts, None),
        ("names", names, None),
        ("digits", digits, None),
        ("power", power, None),
        ("deep", deep, None),
        ("dotted", dotted, None),
        ("large", format!("{text}\n#{}", "x".repeat(17 << 20)), None),
    ];
    let desk = Desk::new();
    for (what, text, complaints) in cases {
        desk.file("case.toml", text);
        let said = desk.run_within(2, &["check", "case.toml"]);
        assert!(said.code.is_some(), "{what} took more than two seconds");
        if said.code != Some(0) {
            said.assert_code(2);
            assert!(said.errors.lines().count() <= 102, "{what}: {}", said.errors.lines().count());
            assert!(said.errors.contains("case.toml"), "{what}: {}", said.errors);
        }
        if let Some(complaints) = complaints {
            let rest = format!("  and {} more", complaints - 100);
            assert_eq!(said.errors.lines().last(), Some(&*rest), "{what}");
        }
    }
}

#[test]
fn check_refuses_what_run_could_not_begin_with() {
    let desk = Desk::new();
    let a = case("four-bar-a");
    let clearance = "joints.A.clearance";
    let outside = ["start.journal={x=1.0,y=0.0,fixed=true}"];
    let explicit = ["solver.engine=explicit", "solver.relative_tolerance=0.1"];
    let radius = format!("{clearance}.bearing_radius=1e308");
    let cases: [(&str, &[&str], &str); 7] = [
        (&a, &["solver.initial_step=5e-324"], "solver.initial_step: is too small (s), 5e-324"),
        (&a, &["solver.max_step=1e-25"], "solver.max_step: is too small (s), 1e-25"),
        (&a, &explicit, "solver.relative_tolerance: must be at most 1e-2"),
        (&a, &[&radius], "joints.A.clearance.normal.stiffness: comes to"),
        (&case("journal-in-bearing"), &outside, "starts 9.9900e-1 m deep in the bearing"),
        (&a, &["bodies.coupler.mass=1e308"], "energies are not finite"),
        (&a, &["drives.crank.speed_rpm=1e300"], "accelerations are not finite"),
    ];
    for (case, set, why) in cases {
        let set: Vec<&str> = set.iter().flat_map(|change| ["--set", change]).collect();
        for command in ["check", "run"] {
            let said = desk.run_within(2, &[&[command, case][..], &set].concat());
            said.assert_code(2);
            assert!(said.errors.contains(why), "{command} {set:?}: {said:#?}");
        }
    }
    assert!(desk.files().is_empty());
}

#[test]
fn times_of_1e30_come_to_an_end() {
    let desk = Desk::new();
    let ideal = ["run", &case("four-bar-ideal"), "-o", "run.h5", "--quiet"];
    desk.run(&[&ideal[..], &SHORT].concat()).assert_code(0);
    let clearance = ["run", &case("four-bar-a"), "-o", "loose.h5", "--quiet"];
    desk.run(&[&clearance[..], &SHORT].concat()).assert_code(0);
    for name in ["run.h5", "loose.h5"] {
        let file = File::open_rw(desk.path(name)).unwrap();
        {
            let time = file.dataset("time").unwrap();
            let times: Vec<f64> = (0..11).map(|k| f64::from(k) * 1e29).collect();
            time.write_slice(&times, 0..11).unwrap();
        }
        file.close().unwrap();
        for command in [&["summary", name][..], &["report", name, "-o", "page.html", "--force"]] {
            let said = desk.run_within(4, command);
            assert!(said.code.is_some_and(|code| code < 101), "{said:#?}");
        }
    }
}

#[test]
fn the_permissions_of_a_file_that_is_replaced_stay() {
    let desk = with_a_run();
    desk.shell("chmod 640 run.h5").assert_code(0);
    let a = case("four-bar-a");
    desk.run(&[&["run", &a, "-o", "run.h5", "--force", "--quiet"], &SHORT[..]].concat())
        .assert_code(0);
    assert_eq!(std::fs::metadata(desk.path("run.h5")).unwrap().mode() & 0o777, 0o640);
}
