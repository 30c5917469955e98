//! The command line, one file a command.

mod certify;
mod check;
mod compare;
mod completions;
mod export;
mod impact;
mod info;
mod laws;
mod lyapunov;
mod man;
mod new;
mod plot;
mod report;
mod run;
mod schema;
mod shown;
mod signals;
mod summary;
mod sweep;
mod version;

use crate::case::{Case, Changes, Override};
use clap::{Args, Parser, Subcommand};
use std::error::Error as StdError;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// Reference simulation of planar mechanisms whose revolute joints have clearance.
#[derive(Debug, Parser)]
#[command(name = "freeplay", about, max_term_width = 100)]
#[command(version = version::short(), long_version = version::long())]
pub struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Write a commented case file to start from.
    New(new::Arguments),
    /// Run a case and write its trajectory.
    Run(run::Arguments),
    /// Say how many digits of a run are true, against references in 71-digit arithmetic.
    Certify(certify::Arguments),
    /// Say how fast small differences grow: Lyapunov exponents, in e-folds per revolution.
    Lyapunov(lyapunov::Arguments),
    /// Say what a case describes: freedoms, constraints, stiffnesses, defaults, decisions.
    Check(check::Arguments),
    /// Say what a result file holds and how it was made.
    Info(info::Arguments),
    /// Say what a result file shows: peaks, ratios to the ideal mechanism, contacts, energies.
    Summary(summary::Arguments),
    /// Run a case many times with some of its keys varied, into tables.
    Sweep(sweep::Arguments),
    /// Say how far a trajectory agrees with a reference, in digits over time.
    Compare(compare::Arguments),
    /// Draw the figures of result files, as journals print them.
    Plot(plot::Arguments),
    /// Write a result file for other tools: CSV, Parquet, OpenMBV.
    Export(export::Arguments),
    /// Write a page on one or several runs: summary, charts, the mechanism in motion.
    Report(report::Arguments),
    /// Print what has a shell complete commands and options.
    Completions(completions::Arguments),
    /// List the laws of the contact force, with what each really gives.
    Laws(laws::Arguments),
    /// Let a mass fall on a wall with laws of the contact force, and hold runs against closed forms.
    Impact(impact::Arguments),
    /// Print the JSON Schema of case files, for editors.
    Schema(schema::Arguments),
    /// Write manual pages.
    Man(man::Arguments),
}

/// A case file, and what the command line changes in it.
#[derive(Debug, Args)]
struct CaseArguments {
    /// Case file (TOML).
    #[arg(value_name = "CASE")]
    path: PathBuf,
    /// Change a key of the case, by its dotted path; the value is TOML, a bare word a string.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<Override>,
    /// Remove every clearance: the ideal mechanism.
    #[arg(long)]
    ideal: bool,
}

impl CaseArguments {
    fn read(&self) -> Result<Case, Failure> {
        self.read_with(&[])
    }

    /// The case with more changes, `KEY=VALUE`.
    fn read_with(&self, more: &[String]) -> Result<Case, Failure> {
        let mut set = self.set.clone();
        for change in more {
            set.push(change.parse().map_err(Failure::input)?);
        }
        Case::read(&self.path, &Changes { set, ideal: self.ideal }).map_err(Failure::input)
    }
}

/// Exit code of what did not come to its end and can be tried again (sysexits.h: EX_TEMPFAIL).
const TRY_AGAIN: u8 = 75;

/// Why a command fails, and the exit code that says so.
#[derive(Debug)]
struct Failure {
    code: u8,
    /// `None` where the command has ended as it was asked to, short of its end.
    error: Option<Box<dyn StdError>>,
    /// What became of the work done so far, if there is something to say.
    rest: Option<String>,
}

impl Failure {
    fn with(code: u8, error: impl StdError + 'static) -> Self {
        Failure { code, error: Some(Box::new(error)), rest: None }
    }

    /// An end that was asked for, and what became of the work done so far.
    fn stop(code: u8, rest: String) -> Self {
        Failure { code, error: None, rest: Some(rest) }
    }

    /// Command line or case file.
    fn input(error: impl StdError + 'static) -> Self {
        Failure::with(2, error)
    }

    /// Output: exists, no space, no permission.
    fn output(error: impl StdError + 'static) -> Self {
        Failure::with(3, error)
    }

    /// Tells the error and its causes on stderr.
    fn tell(&self) {
        if let Some(error) = &self.error {
            say(shown::message(&format!("error: {error}")));
        }
        let mut cause = self.error.as_ref().and_then(|error| error.source());
        while let Some(error) = cause {
            say(shown::message(&format!("  caused by: {error}")));
            cause = error.source();
        }
        if let Some(rest) = &self.rest {
            say(rest);
        }
    }
}

/// An error and its causes in one line.
fn chain(error: &(impl StdError + ?Sized)) -> String {
    let mut line = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        line = format!("{line}: {error}");
        cause = error.source();
    }
    line
}

/// A result could not be printed.
#[derive(Debug, thiserror::Error)]
#[error("cannot write the result to standard output")]
struct NotPrinted(#[source] io::Error);

/// Prints a result on stdout; a reader that has gone away is no error.
fn print(result: impl std::fmt::Display) -> Result<(), Failure> {
    print_shown(&shown::text(&result.to_string()))
}

/// Prints JSON on stdout.
fn print_json(result: impl std::fmt::Display) -> Result<(), Failure> {
    print_shown(&shown::json(&result.to_string()))
}

fn print_shown(result: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout();
    match stdout.write_all(result.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::output(NotPrinted(error)))
        }
        _ => Ok(()),
    }
}

/// Says something on stderr; nobody need listen.
fn say(words: impl std::fmt::Display) {
    let _ = writeln!(io::stderr(), "{}", shown::text(&words.to_string()));
}

/// Parses the command line and does what it says.
pub fn main() -> ExitCode {
    signals::let_long_writes_fail();
    signals::end_clearly_without_memory();
    let done = match CommandLine::parse().command {
        Command::New(arguments) => new::new(&arguments),
        Command::Run(arguments) => run::run(&arguments),
        Command::Certify(arguments) => certify::certify(&arguments),
        Command::Lyapunov(arguments) => lyapunov::lyapunov(&arguments),
        Command::Check(arguments) => check::check(&arguments),
        Command::Info(arguments) => info::info(&arguments),
        Command::Summary(arguments) => summary::summary(&arguments),
        Command::Sweep(arguments) => sweep::sweep(&arguments),
        Command::Compare(arguments) => compare::compare(&arguments),
        Command::Plot(arguments) => plot::plot(&arguments),
        Command::Export(arguments) => export::export(&arguments),
        Command::Report(arguments) => report::report(&arguments),
        Command::Completions(arguments) => completions::completions(&arguments),
        Command::Laws(arguments) => laws::laws(&arguments),
        Command::Impact(arguments) => impact::impact(&arguments),
        Command::Schema(arguments) => schema::schema_of_cases(&arguments),
        Command::Man(arguments) => man::man(&arguments),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.tell();
            // what fails once a signal has come fails for that, but for an output that is lost
            let code = signals::exit_code().filter(|_| ![3, TRY_AGAIN].contains(&failure.code));
            ExitCode::from(code.unwrap_or(failure.code))
        }
    }
}
