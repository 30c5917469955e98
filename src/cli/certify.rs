//! `freeplay certify CASE`

use super::signals::Signals;
use super::{CaseArguments, Failure};
use crate::case::Case;
use crate::certify::{self, Certificate, Reference, Stage, Told};
use crate::record::{Ending, Outcome, ResultFile, Writer, sha256, utc};
use crate::run::{Recorder, Schedule};
use crate::simulate::{self, Simulation};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Arguments of `certify`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    case: CaseArguments,
    /// Certified reference to write (HDF5); without it nothing is written.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the output if it exists.
    #[arg(long)]
    force: bool,
    /// Digits to which the reference is to be certified; short of them the exit code is 1.
    #[arg(long, value_name = "N", value_parser = digits_in_range)]
    digits: Option<f64>,
    /// Simulated time (s), in place of the case's `run.duration`.
    #[arg(long, value_name = "T")]
    until: Option<String>,
    /// A certified reference made before, of the same mechanism.
    #[arg(long, value_name = "FILE")]
    reference: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    /// No progress on stderr.
    #[arg(short, long)]
    quiet: bool,
}

/// Digits without `--digits`.
const DIGITS: f64 = 10.0;

fn digits_in_range(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(digits) if (1.0..=14.0).contains(&digits) => Ok(digits),
        _ => Err("must be a number of digits from 1 to 14".into()),
    }
}

/// Certifies the digits of a run.
pub(super) fn certify(arguments: &Arguments) -> Result<(), Failure> {
    let case = read(arguments)?;
    let simulation = Simulation::new(&case).map_err(Failure::input)?;
    let header = simulate::header(&case, simulation.mechanism(), utc(SystemTime::now()));
    let signals = Signals::new().map_err(Failure::output)?;
    if let Some(output) = &arguments.output {
        // an output that cannot be written is told before the work, not after it
        let writer =
            Writer::create_from(output, header.clone(), arguments.force, &inputs(arguments, &case));
        drop(writer.map_err(Failure::output)?);
    }
    let digits = arguments.digits.unwrap_or(DIGITS);
    let reference = reference(arguments, &case, simulation.schedule(), digits, &signals)?;
    let names = simulation.mechanism().model().names().clone();
    let revolution = simulation.mechanism().revolution();
    let certificate = certify::certify(simulation, reference, &mut |_| signals.flow())
        .map_err(|error| signals.failure(error))?;
    let case_sha256 = sha256(&case.text);
    let told =
        Told { case: &case.name, case_sha256: &case_sha256, names: &names, digits, revolution };
    if let Some(output) = &arguments.output {
        write(&certificate, output, header, arguments, &case)?;
    }
    match arguments.json {
        true => super::print_json(format_args!("{}\n", certificate.json(&told)))?,
        false => super::print(format_args!("{}\n{}", case.name, certificate.words(&told)))?,
    }
    if arguments.digits.is_some() && !certificate.reference_holds_to_the_end(digits) {
        let (until, held) = (certificate.reference.until, certificate.reference_holds(digits));
        return Err(Failure::with(1, FellShort { digits, until, held }));
    }
    Ok(())
}

/// The reference could not be certified as asked.
#[derive(Debug, thiserror::Error)]
#[error("the reference cannot be certified to {digits} digits until {until} s, {}", as_far(.held))]
struct FellShort {
    digits: f64,
    /// End asked for (s).
    until: f64,
    /// Up to when it is (s).
    held: Option<f64>,
}

fn as_far(held: &Option<f64>) -> String {
    held.map_or("nor anywhere".to_owned(), |time| format!("only until {time} s"))
}

/// The case, sampled on its grid: certificates are told at the same times for every run.
fn read(arguments: &Arguments) -> Result<Case, Failure> {
    let mut case = arguments.case.read()?;
    if case.plan.sampling != crate::case::Sampling::Uniform || arguments.until.is_some() {
        let mut changed = vec!["run.sampling=uniform".to_owned()];
        changed.extend(arguments.until.iter().map(|until| format!("run.duration={until}")));
        case = arguments.case.read_with(&changed)?;
    }
    Ok(case)
}

fn reference(
    arguments: &Arguments,
    case: &Case,
    schedule: &Schedule,
    digits: f64,
    signals: &Signals,
) -> Result<Reference, Failure> {
    if let Some(path) = &arguments.reference {
        let file = ResultFile::open(path).map_err(Failure::input)?;
        return certify::stored(case, &file).map_err(Failure::input);
    }
    let duration: f64 = schedule.duration();
    let bar = progress_bar(arguments.quiet);
    let told = certify::reference(case, schedule, digits, &|stage: Stage| {
        if !bar.is_hidden() {
            bar.set_position((stage.time / duration * 1e4) as u64);
            bar.set_message(format!(
                "{:.2} of {:.2} ms at a tolerance of {:.0e}",
                stage.time * 1e3,
                duration * 1e3,
                stage.tolerance
            ));
        }
        signals.flow()
    });
    bar.finish_and_clear();
    told.map_err(|error| match error {
        certify::Error::Case(error) => Failure::input(error),
        error => signals.failure(error),
    })
}

fn progress_bar(quiet: bool) -> ProgressBar {
    let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(Some(10_000), target);
    let style = ProgressStyle::with_template("{bar:40} {msg}, {elapsed}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

/// The files that a certificate is made from.
fn inputs<'a>(arguments: &'a Arguments, case: &'a Case) -> Vec<&'a Path> {
    let path = std::iter::once(arguments.case.path.as_path());
    path.chain(arguments.reference.as_deref()).chain(case.started_from.as_deref()).collect()
}

/// Writes the reference with all that the certificate says.
fn write(
    certificate: &Certificate,
    output: &Path,
    mut header: crate::record::Header,
    arguments: &Arguments,
    case: &Case,
) -> Result<(), Failure> {
    header.attributes.extend(certificate.reference.attributes());
    let writer = Writer::create_from(output, header, arguments.force, &inputs(arguments, case));
    let mut writer = writer.map_err(Failure::output)?;
    let trajectory = &certificate.reference.trajectory;
    let mut record = || {
        trajectory.samples.iter().try_for_each(|sample| writer.sample(sample))?;
        trajectory.events.iter().try_for_each(|event| writer.event(*event))?;
        trajectory.contacts.iter().try_for_each(|contact| writer.contact(*contact))?;
        trajectory.peaks.iter().try_for_each(|peak| writer.peak(*peak))
    };
    record().map_err(Failure::output)?;
    let ending = Ending {
        outcome: Outcome::Complete,
        counts: certificate.statistics.engine.clone(),
        rulings: certificate.statistics.rulings.clone(),
        finished_utc: utc(SystemTime::now()),
        series: certificate.series(),
        attributes: Vec::new(),
    };
    writer.finish(ending).map_err(Failure::output)?;
    Ok(())
}
