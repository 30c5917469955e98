//! `freeplay run CASE`

use super::{CaseArguments, Failure, chain};
use crate::record::{Ending, Outcome, Writer, utc};
use crate::run::Progress;
use crate::simulate::{self, Simulation, Statistics};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use signal_hook::consts::{SIGINT, SIGTERM};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Instant, SystemTime};

/// Ticks of the progress bar over a whole run.
const TICKS: u64 = 10_000;

/// Arguments of `run`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    case: CaseArguments,
    /// Trajectory to write (HDF5); default: the case's name with .h5, in this folder.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the output if it exists.
    #[arg(long)]
    force: bool,
    /// No progress on stderr.
    #[arg(short, long)]
    quiet: bool,
}

/// Simulates a case and writes its trajectory.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let begun = Instant::now();
    let case = arguments.case.read()?;
    let output = arguments.output.clone().unwrap_or_else(|| format!("{}.h5", case.name).into());
    let simulation = Simulation::new(&case).map_err(Failure::input)?;
    let header = simulate::header(&case, simulation.mechanism(), utc(SystemTime::now()));
    let writer = Writer::create(&output, header, arguments.force).map_err(Failure::output)?;
    let signals = Signals::new().map_err(Failure::output)?;
    let told = simulate_into(writer, simulation, &signals, arguments.quiet)?;
    super::print(format_args!(
        "{}: {}, {} samples, {} contacts, {} steps in {:.2} s\n",
        told.path.display(),
        case.name,
        told.progress.samples,
        told.progress.contacts,
        told.progress.steps,
        begun.elapsed().as_secs_f64()
    ));
    Ok(())
}

/// What a finished run tells in one line.
struct Told {
    path: PathBuf,
    progress: Progress,
}

/// Runs a simulation into a writer, and finishes the file however the run ends.
fn simulate_into(
    mut writer: Writer,
    simulation: Simulation<'_>,
    signals: &Signals,
    quiet: bool,
) -> Result<Told, Failure> {
    let duration: f64 = simulation.schedule().duration();
    let bar = progress_bar(quiet);
    let begun = Instant::now();
    let mut last = Progress::default();
    let mut watch = |progress: &Progress| {
        last = *progress;
        tell(&bar, progress, duration, begun);
        match signals.received() {
            Some(_) => ControlFlow::Break(()),
            None => ControlFlow::Continue(()),
        }
    };
    let (statistics, ran) = simulation.run(&mut writer, &mut watch);
    bar.finish_and_clear();
    let reason = ran.as_ref().err().map(chain);
    let finished = writer.finish(ending(statistics, reason));
    let Err(error) = ran else {
        let path = finished.map_err(Failure::output)?;
        return Ok(Told { path, progress: last });
    };
    let rest = match finished {
        Ok(path) => format!("what was simulated until then is in {}", path.display()),
        Err(error) => format!("what was simulated until then is lost: {}", chain(&error)),
    };
    let code = match (&error, signals.received()) {
        (simulate::Error::Interrupted { .. }, Some(signal)) => 128 + signal,
        (simulate::Error::Recorder(_), _) => 3,
        _ => 4,
    };
    Err(Failure { code, error: Box::new(error), rest: Some(rest) })
}

fn ending(statistics: Statistics, failure: Option<String>) -> Ending {
    let outcome = match failure {
        None => Outcome::Complete,
        Some(reason) => Outcome::Failed { reason },
    };
    let Statistics { engine: counts, rulings } = statistics;
    Ending { outcome, counts, rulings, finished_utc: utc(SystemTime::now()) }
}

fn progress_bar(quiet: bool) -> ProgressBar {
    let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(Some(TICKS), target);
    let style = ProgressStyle::with_template("{bar:40} {msg}, {eta} left");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

fn tell(bar: &ProgressBar, progress: &Progress, duration: f64, begun: Instant) {
    if bar.is_hidden() {
        return;
    }
    let rate = progress.events as f64 / begun.elapsed().as_secs_f64().max(1e-3);
    bar.set_position((progress.time / duration * TICKS as f64) as u64);
    bar.set_message(format!(
        "{:.3} of {:.3} ms, {} events ({rate:.0}/s), step {:.1e} s",
        progress.time * 1e3,
        duration * 1e3,
        progress.events,
        progress.step
    ));
}

/// Signals that ask a run to stop; a second one ends the program at once.
struct Signals {
    received: Arc<AtomicUsize>,
}

impl Signals {
    fn new() -> std::io::Result<Self> {
        let received = Arc::new(AtomicUsize::new(0));
        let again = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            let code = 128 + signal;
            signal_hook::flag::register_conditional_shutdown(signal, code, Arc::clone(&again))?;
            signal_hook::flag::register(signal, Arc::clone(&again))?;
            signal_hook::flag::register_usize(signal, Arc::clone(&received), signal as usize)?;
        }
        Ok(Signals { received })
    }

    /// The signal that came, if one did.
    fn received(&self) -> Option<u8> {
        u8::try_from(self.received.load(Ordering::Relaxed)).ok().filter(|signal| *signal != 0)
    }
}
