//! `freeplay sweep STUDY -o DIR`

use super::signals::Signals;
use super::{Failure, TRY_AGAIN};
use crate::case::Override;
use crate::study::{self, Done, Error, Options, Shard, Study, Told};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::fmt::Write as _;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Arguments of `sweep`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Study file (TOML); with --vary the case file.
    #[arg(value_name = "STUDY")]
    path: PathBuf,
    /// Vary a key of the case; several times for a grid. The values are FROM:TO:COUNT,
    /// FROM:TO:COUNT:log or a list with commas; keys with + between are alike.
    #[arg(long, value_name = "KEY=VALUES")]
    vary: Vec<Vary>,
    /// Change a key of the case in all runs (with --vary).
    #[arg(long, value_name = "KEY=VALUE", requires = "vary")]
    set: Vec<Override>,
    /// Revolutions of the first drive that each run lasts (with --vary); default: what the case says.
    #[arg(long, value_name = "N", requires = "vary")]
    revolutions: Option<f64>,
    /// Revolutions left out at the begin of each run (with --vary): of them no rows are kept.
    #[arg(long, value_name = "N", requires = "vary")]
    discard: Option<u64>,
    /// Keep this number of each run, by its path in `summary --json` (with --vary); default: forces,
    /// contacts, penetrations.
    #[arg(long, value_name = "PATH", requires = "vary")]
    keep: Vec<String>,
    /// Keep this number of each revolution (with --vary).
    #[arg(long, value_name = "PATH", requires = "vary")]
    keep_revolutions: Vec<String>,
    /// Keep the state whenever the first drive passes this angle (degrees; with --vary).
    #[arg(long, value_name = "ANGLE", requires = "vary", allow_negative_numbers = true)]
    section: Option<f64>,
    /// Keep the K largest Lyapunov exponents of each run (with --vary); takes longer.
    #[arg(long, value_name = "K", requires = "vary")]
    exponents: Option<usize>,
    /// Keep after how many revolutions each motion repeats itself, to this tolerance (with --vary).
    #[arg(long, value_name = "TOLERANCE", requires = "vary", num_args = 0..=1, default_missing_value = "1e-3")]
    attractor: Option<f64>,
    /// Keep how far each run is true (with --vary); takes longer.
    #[arg(long, requires = "vary")]
    horizon: bool,
    /// Folder for the tables; default: the study's name without its ending, in this folder.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Runs at a time; default: one for each core.
    #[arg(short, long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
    /// Make this part of the runs only, and no tables; exit code 75 if it can be tried again.
    #[arg(long, value_name = "I/N", value_parser = shard, conflicts_with = "gather")]
    shard: Option<Shard>,
    /// Make no runs, but the tables of what the shards in this folder have made.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["output", "jobs"])]
    gather: Option<PathBuf>,
    /// Write the tables as CSV, too.
    #[arg(long)]
    csv: bool,
    /// Replace the tables of another study; runs that both have are not made again.
    #[arg(long)]
    force: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    /// No progress on stderr.
    #[arg(short, long)]
    quiet: bool,
}

/// Keys that are alike, and their values.
#[derive(Debug, Clone)]
struct Vary {
    keys: Vec<String>,
    values: String,
}

impl std::str::FromStr for Vary {
    type Err = String;

    fn from_str(text: &str) -> Result<Vary, String> {
        let like =
            "as in joints.A.clearance.radial=5e-5:1e-3:20:log or drives.crank.speed_rpm=1000,2000";
        let Some((keys, values)) = text.split_once('=') else {
            return Err(format!("it must be KEY=VALUES, {like}"));
        };
        let keys: Vec<String> = keys.split('+').map(|key| key.trim().to_owned()).collect();
        let parts: Vec<&str> = values.split(':').map(str::trim).collect();
        let number = |text: &str| text.parse::<f64>().is_ok();
        let toml = match parts[..] {
            [_] => {
                let literal = |value: &str| match toml_value(value) {
                    Some(literal) => literal,
                    None => toml_edit::Value::from(value).to_string(),
                };
                let values: Vec<String> = values.split(',').map(|v| literal(v.trim())).collect();
                format!("values = [{}]", values.join(", "))
            }
            [from, to, count] | [from, to, count, "log"]
                if number(from) && number(to) && count.parse::<u64>().is_ok() =>
            {
                let spacing = if parts.len() == 4 { "\nspacing = \"log\"" } else { "" };
                let [from, to] =
                    [from, to].map(|end| format!("{:?}", end.parse().unwrap_or(f64::NAN)));
                format!("from = {from}\nto = {to}\ncount = {count}{spacing}")
            }
            _ => {
                return Err(format!(
                    "values must be FROM:TO:COUNT, FROM:TO:COUNT:log or a list, {like}"
                ));
            }
        };
        Ok(Vary { keys, values: toml })
    }
}

/// A value that is TOML as it stands.
fn toml_value(text: &str) -> Option<String> {
    let value = text.parse::<toml_edit::Value>().ok()?;
    (!value.is_datetime()).then(|| value.to_string())
}

fn shard(text: &str) -> Result<Shard, String> {
    let parts = text.split_once('/');
    let numbers = parts.and_then(|(number, count)| number.parse().ok().zip(count.parse().ok()));
    match numbers {
        Some((number, count)) if (1..=count).contains(&number) => Ok(Shard { number, count }),
        _ => Err("it must be I/N, from 1/N to N/N".to_owned()),
    }
}

/// Some runs of a study failed.
#[derive(Debug, thiserror::Error)]
#[error("{failed} of {runs} runs failed{where_why}")]
struct SomeFailed {
    failed: u64,
    runs: u64,
    where_why: String,
}

/// Makes a study.
pub(super) fn sweep(arguments: &Arguments) -> Result<(), Failure> {
    let begun = Instant::now();
    let signals = Signals::new().map_err(Failure::output)?;
    let study = match arguments.vary.is_empty() {
        true => Study::read(&arguments.path),
        false => Study::from_text(Path::new("--vary"), &study_text(arguments)),
    };
    let study = study.map_err(Failure::input)?;
    let options = Options {
        jobs: arguments
            .jobs
            .or(std::thread::available_parallelism().ok())
            .unwrap_or(NonZeroUsize::MIN),
        shard: arguments.shard,
        csv: arguments.csv,
        force: arguments.force,
    };
    let folder = match (&arguments.gather, &arguments.output) {
        (Some(folder), _) | (None, Some(folder)) => folder.clone(),
        (None, None) => {
            let stem = arguments.path.file_stem().unwrap_or_default();
            let made = if arguments.vary.is_empty() { "" } else { "-sweep" };
            PathBuf::from(format!("{}{made}", stem.to_string_lossy()))
        }
    };
    let bar = progress_bar(&study, arguments.quiet);
    let done = match arguments.gather {
        Some(_) => study::gather(&study, &folder, &options),
        None => study::sweep(&study, &folder, &options, &|told| tell(&bar, &study, told, begun)),
    };
    bar.finish_and_clear();
    let done = done.map_err(|error| failure(error, arguments, &signals, &folder))?;
    let seconds = begun.elapsed().as_secs_f64();
    match arguments.json {
        true => {
            super::print_json(format_args!("{:#}\n", to_json(&done, &study, &folder, seconds)))?
        }
        false => super::print(words(&done, &study, &folder, seconds))?,
    }
    if done.failed > 0 {
        let told = folder.join("failures.parquet");
        let where_why = match arguments.shard {
            Some(_) => String::new(),
            None => format!("; why is told in {}", told.display()),
        };
        return Err(Failure::with(
            4,
            SomeFailed { failed: done.failed, runs: study.runs, where_why },
        ));
    }
    Ok(())
}

/// What a command line with --vary says, as a study file has it.
fn study_text(arguments: &Arguments) -> String {
    let quoted = |text: &str| toml_edit::Value::from(text).to_string();
    let list = |texts: &[String]| {
        let texts: Vec<String> = texts.iter().map(|text| quoted(text)).collect();
        format!("[{}]", texts.join(", "))
    };
    let mut text = format!("case = {}\n", quoted(&arguments.path.to_string_lossy()));
    if !arguments.set.is_empty() {
        let set: Vec<String> = arguments.set.iter().map(ToString::to_string).collect();
        let _ = writeln!(text, "set = {}", list(&set));
    }
    for Vary { keys, values } in &arguments.vary {
        let _ = writeln!(text, "\n[[vary]]\nkeys = {}\n{values}", list(keys));
    }
    if arguments.revolutions.is_some() || arguments.discard.is_some() {
        let _ = writeln!(text, "\n[span]");
        let _ = arguments.revolutions.map(|count| writeln!(text, "revolutions = {count:?}"));
        let _ = arguments.discard.map(|count| writeln!(text, "discard = {count}"));
    }
    let (runs, revolutions) = (&arguments.keep, &arguments.keep_revolutions);
    let exponents = arguments.exponents;
    if exponents.is_some() || arguments.horizon || !runs.is_empty() || !revolutions.is_empty() {
        let _ = writeln!(text, "\n[keep]");
        if !runs.is_empty() {
            let _ = writeln!(text, "runs = {}", list(runs));
        }
        if !revolutions.is_empty() {
            let _ = writeln!(text, "revolutions = {}", list(revolutions));
        }
        if arguments.horizon {
            let _ = writeln!(text, "horizon = true");
        }
        let _ = exponents.map(|count| writeln!(text, "exponents = {count}"));
    }
    if let Some(angle) = arguments.section {
        let _ = writeln!(text, "\n[section]\nangle = {:?}", angle.to_radians());
    }
    if let Some(tolerance) = arguments.attractor {
        let _ = writeln!(text, "\n[attractor]\ntolerance = {tolerance:?}");
    }
    text
}

/// Why there is no study, and what became of what was done.
fn failure(error: Error, arguments: &Arguments, signals: &Signals, folder: &Path) -> Failure {
    let rest = format!(
        "what was done until then is kept in {}; the same command goes on",
        folder.display()
    );
    let code = match &error {
        Error::Folder { .. }
        | Error::Pack { .. }
        | Error::Output(_)
        | Error::Table(_)
        | Error::OtherStudy { .. } => 3,
        Error::Missing { .. } => 1,
        // what fails once a signal has come fails for that
        error => match (signals.exit_code(), error) {
            (Some(code), _) => code,
            (None, Error::Interrupted) => 130,
            (None, _) => 2,
        },
    };
    let lasting = matches!(error, Error::OtherStudy { .. } | Error::Folder { .. });
    let again = code > 2 && !lasting;
    let code = if arguments.shard.is_some() && again { TRY_AGAIN } else { code };
    Failure { rest: again.then_some(rest), ..Failure::with(code, error) }
}

fn words(done: &Done, study: &Study, folder: &Path, seconds: f64) -> String {
    let rate = done.revolutions as f64 / seconds.max(1e-9);
    let mut words = format!("{}: {} runs", folder.display(), study.runs);
    if done.made < study.runs {
        let _ = write!(words, ", {} of them made now", done.made);
    }
    if done.revolutions > 0 {
        let _ = write!(words, ", {} revolutions in {seconds:.2} s ({rate:.0}/s)", done.revolutions);
    }
    words.push('\n');
    let names: Vec<String> = (done.tables.iter())
        .filter_map(|path| path.file_name().map(|name| name.to_string_lossy().into_owned()))
        .collect();
    if !names.is_empty() {
        let _ = writeln!(words, "  tables       {}", names.join(", "));
    }
    words
}

fn to_json(done: &Done, study: &Study, folder: &Path, seconds: f64) -> serde_json::Value {
    let tables: Vec<String> =
        done.tables.iter().map(|path| path.to_string_lossy().into_owned()).collect();
    json!({
        "folder": folder.to_string_lossy(),
        "runs": study.runs,
        "made": done.made,
        "failed": done.failed,
        "revolutions": done.revolutions,
        "seconds": seconds,
        "tables": tables,
    })
}

fn progress_bar(study: &Study, quiet: bool) -> ProgressBar {
    let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(Some(study.runs), target);
    let style = ProgressStyle::with_template("{bar:40} {msg}, {eta} left");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

fn tell(bar: &ProgressBar, study: &Study, told: Told, begun: Instant) {
    if bar.is_hidden() {
        return;
    }
    let rate = told.revolutions as f64 / begun.elapsed().as_secs_f64().max(1e-3);
    bar.set_position(told.runs);
    bar.set_message(format!("{} of {} runs, {rate:.0} revolutions/s", told.runs, study.runs));
}
