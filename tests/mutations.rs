//! Case files and result files as accidents and strangers make them. Known in advance: whatever
//! stands in a file, it is read or refused with a word; nothing panics, and nothing takes long.
//!
//! `FREEPLAY_MUTATIONS=1000000 cargo test --release --test mutations` tries a million of the first two
//! kinds, and a tenth as many result files.
//! What once failed is kept in `tests/mutations`, and tried first.

use freeplay::advice;
use freeplay::case::{Case, Changes, Override};
use freeplay::post::Summary;
use freeplay::record::{DATASETS, ResultFile};
use freeplay::simulate::Simulation;
use nix::sys::resource::{UsageWho, getrusage};
use nix::sys::time::TimeVal;
use std::path::{Path, PathBuf};
use std::time::Duration;

mod written;
use written::Run;

/// Longest processor time for one file, on a machine that does much else besides.
const LONGEST: Duration = Duration::from_secs(4);

/// Processor time of this thread.
fn processor_time() -> Duration {
    let used = getrusage(UsageWho::RUSAGE_THREAD).unwrap();
    let seconds = |time: TimeVal| time.tv_sec() as f64 + 1e-6 * time.tv_usec() as f64;
    Duration::from_secs_f64(seconds(used.user_time()) + seconds(used.system_time()))
}

/// How many of each kind are tried.
fn mutations(ordinary: u64) -> u64 {
    let asked = std::env::var("FREEPLAY_MUTATIONS").ok();
    asked.map_or(ordinary, |number| number.parse().expect("FREEPLAY_MUTATIONS is a number"))
}

/// Files of the project with this ending in a folder.
fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|found| found == ending)).collect();
    files.sort();
    files
}

/// Values that numbers are replaced by.
const VALUES: [&str; 26] = [
    "0",
    "-1",
    "1",
    "-0.0",
    "1e308",
    "-1e308",
    "5e-324",
    "1e-300",
    "1e300",
    "1e30",
    "1e-30",
    "nan",
    "inf",
    "-inf",
    "1e400",
    "9223372036854775807",
    "0x10",
    "true",
    "\"\"",
    "\"ground.A0\"",
    "[]",
    "{}",
    "[1, 2]",
    "1979-05-27",
    "[0.0, 0.0]",
    "0.5",
];

/// One accident.
fn mutate(text: &str, random: &mut fastrand::Rng) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    if !text.contains('=') {
        return text.to_owned();
    }
    let line = random.usize(..lines.len());
    match random.u8(..10) {
        // a number is another
        0..=3 => {
            let with_values: Vec<usize> =
                (0..lines.len()).filter(|k| lines[*k].contains('=')).collect();
            let line = &mut lines[with_values[random.usize(..with_values.len())]];
            let places: Vec<usize> = line
                .char_indices()
                .filter(|(at, c)| {
                    c.is_ascii_digit()
                        && !line[..*at].ends_with(|c: char| c.is_alphanumeric() || c == '.')
                })
                .map(|(at, _)| at)
                .collect();
            if let Some(begin) = random.choice(&places) {
                let is_of_it = |c: char| c.is_ascii_alphanumeric() || ".-+".contains(c);
                let rest = &line[*begin..];
                let length = rest.find(|c: char| !is_of_it(c)).unwrap_or(rest.len());
                let value = VALUES[random.usize(..VALUES.len())];
                line.replace_range(*begin..*begin + length, value);
            }
        }
        4 => drop(lines.remove(line)),
        5 => {
            let other = lines[random.usize(..lines.len())].clone();
            lines.insert(line, other);
        }
        6 => {
            let other = random.usize(..lines.len());
            lines.swap(line, other);
        }
        // a key, a word or a sign is another
        7 => {
            let words = [
                "name", "A", "B", "ground", "crank", "=", ".", "[", "]", "\"", "{", ",",
                "\u{202e}", "\\",
            ];
            let at = lines[line].char_indices().map(|(at, _)| at).collect::<Vec<_>>();
            let at = random.choice(&at).copied().unwrap_or(0);
            lines[line].insert_str(at, words[random.usize(..words.len())]);
        }
        8 => {
            let end = lines[line].char_indices().map(|(at, _)| at).collect::<Vec<_>>();
            let end = random.choice(&end).copied().unwrap_or(0);
            lines[line].truncate(end);
        }
        _ => lines.truncate(line),
    }
    lines.join("\n") + "\n"
}

/// Reads a case and does all that `check` does with it.
fn check(text: &str, changes: &Changes) -> Result<(), String> {
    let case = Case::from_text(Path::new("case.toml"), text, changes).map_err(|e| e.to_string())?;
    let simulation = Simulation::new(&case).map_err(|e| e.to_string())?;
    let mechanism = simulation.mechanism();
    let turn = advice::turn(&case);
    let touches = advice::touches(mechanism, &turn);
    advice::notes(&case, mechanism, &turn, &touches);
    Ok(())
}

/// What fell, each with where it is kept.
#[derive(Default)]
struct Falls(Vec<String>);

/// More are not looked for.
const MOST_FALLS: usize = 20;

impl Falls {
    /// Keeps what falls with these words.
    fn keep(&mut self, wrong: &str, bytes: &[u8], ending: &str) {
        let thread = std::thread::current();
        let test = thread.name().unwrap_or_default();
        let kept = format!("freeplay-{test}-{}.{ending}", self.0.len());
        let kept = std::env::temp_dir().join(kept);
        std::fs::write(&kept, bytes).unwrap();
        self.0.push(format!("{wrong}: {}", kept.display()));
        assert!(self.0.len() < MOST_FALLS, "{}", self.0.join("\n"));
    }

    fn tell(&self) {
        assert!(self.0.is_empty(), "{}", self.0.join("\n"));
    }
}

/// Tries a text, and tells whether it is sound.
fn try_case(text: &str, changes: &Changes, falls: &mut Falls) -> bool {
    let begun = processor_time();
    let told = std::panic::catch_unwind(|| check(text, changes));
    let took = processor_time().saturating_sub(begun);
    let wrong = match &told {
        Err(_) => Some("it panics".to_owned()),
        Ok(_) if took > LONGEST => Some(format!("it takes {took:?}")),
        Ok(Err(message)) if message.lines().count() > 102 => Some("it says too much".to_owned()),
        Ok(_) => None,
    };
    if let Some(wrong) = wrong {
        falls.keep(&format!("{wrong}, with {changes:?}"), text.as_bytes(), "toml");
    }
    matches!(told, Ok(Ok(())))
}

fn texts() -> Vec<String> {
    let folders = ["cases", "tests/cases", "tests/nothing_missed", "tests/mutations"];
    let files = folders.iter().flat_map(|folder| files(folder, "toml"));
    files.map(|path| std::fs::read_to_string(path).unwrap()).collect()
}

#[test]
fn no_case_file_is_too_much() {
    // changes of slow ones would take the time of all others
    let slow = files("tests/mutations/slow", "toml");
    let mut falls = Falls::default();
    for path in files("tests/mutations", "toml").into_iter().chain(slow) {
        try_case(&std::fs::read_to_string(path).unwrap(), &Changes::default(), &mut falls);
    }
    let texts = texts();
    let mut random = fastrand::Rng::with_seed(16);
    let (mut sound, all) = (0, mutations(14_000));
    for _ in 0..all {
        let mut text = texts[random.usize(..texts.len())].clone();
        for _ in 0..random.u8(1..4) {
            text = mutate(&text, &mut random);
        }
        sound += u64::from(try_case(&text, &Changes::default(), &mut falls));
    }
    falls.tell();
    // both kinds are tried
    assert!(sound > all / 20 && sound < all, "{sound} of {all}");
}

#[test]
fn no_change_from_the_command_line_is_too_much() {
    let (texts, mut falls) = (texts(), Falls::default());
    let mut random = fastrand::Rng::with_seed(17);
    for _ in 0..mutations(4500) {
        let text = &texts[random.usize(..texts.len())];
        let keyed: Vec<&str> = text.lines().filter(|line| line.contains('=')).collect();
        let line = keyed[random.usize(..keyed.len())];
        let key = line.split('=').next().unwrap_or_default().trim();
        let tables =
            ["run", "solver", "joints.A", "joints.A.clearance", "bodies.crank", "start", ""];
        let table = tables[random.usize(..tables.len())];
        let dot = if table.is_empty() { "" } else { "." };
        let value = VALUES[random.usize(..VALUES.len())];
        let written = mutate(&format!("{table}{dot}{key}={value}"), &mut random);
        let Ok(change) = written.trim_end().parse::<Override>() else { continue };
        let changes = Changes { set: vec![change], ideal: random.bool() };
        try_case(text, &changes, &mut falls);
    }
    falls.tell();
}

/// Reads all that there is in a file.
fn read(path: &Path) -> Result<(), String> {
    let file = ResultFile::open(path).map_err(|error| error.to_string())?;
    for dataset in &DATASETS {
        let _ = file.table(dataset.name);
    }
    let _ = (file.events(), file.contacts(), file.peaks(), file.revolutions(), file.seal());
    Summary::of(&file, None).map(drop).map_err(|error| error.to_string())
}

#[test]
fn no_result_file_is_too_much() {
    let set = ["run.duration=2e-3", "run.sample_interval=1e-4"];
    let run = Run::of("four-bar-b", &set);
    let whole = std::fs::read(&run.path).unwrap();
    assert_eq!(read(&run.path), Ok(()));
    let (path, mut falls) = (run.beside("mutation.h5"), Falls::default());
    let mut random = fastrand::Rng::with_seed(18);
    let (mut refused, all) = (0, mutations(15_000) / 10);
    for _ in 0..all {
        let mut bytes = whole.clone();
        match random.u8(..8) {
            0 => bytes.truncate(random.usize(..whole.len())),
            1 => bytes.extend((0..random.usize(..4096)).map(|_| random.u8(..))),
            2 => {
                let (from, to) = (random.usize(..whole.len()), random.usize(..whole.len()));
                let length = random.usize(..512).min(whole.len() - from.max(to));
                bytes.copy_within(from..from + length, to);
            }
            3 => {
                let from = random.usize(..whole.len());
                let to = whole.len().min(from + random.usize(..256));
                bytes[from..to].fill([0, 0xff][random.usize(..2)]);
            }
            _ => {
                for _ in 0..random.u8(1..16) {
                    // most of what decides stands at the begin
                    let reach = [whole.len(), whole.len().min(4096)][random.usize(..2)];
                    bytes[random.usize(..reach)] ^= 1 << random.u8(..8);
                }
            }
        }
        std::fs::write(&path, &bytes).unwrap();
        let begun = processor_time();
        let told = std::panic::catch_unwind(|| read(&path));
        let took = processor_time().saturating_sub(begun);
        if told.is_err() || took > LONGEST {
            falls.keep(&format!("it panics or takes {took:?}"), &bytes, "h5");
        }
        refused += u64::from(!matches!(told, Ok(Ok(()))));
    }
    falls.tell();
    assert!(refused > all / 10, "{refused} of {all}");
}
