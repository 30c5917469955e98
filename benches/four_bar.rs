//! What the paper's cases cost: `cargo bench`.
//!
//! Times are the best of several, CPU unless they are called wall time. The solution alone is a
//! run that records two samples and keeps nothing; the whole command is the program itself, from
//! its start to the published file.

use freeplay::case::{Case, Changes};
use freeplay::dae::{Count, Engine};
use freeplay::engine::explicit::Explicit;
use freeplay::engine::ida::{Ida, Norm, Options};
use freeplay::mechanism::{Mechanism, Observation};
use freeplay::model::Model;
use freeplay::run::{self, Contact, Event, Peak, Progress, Recorder, Schedule};
use freeplay::simulate::{explicit_options, ida_options};
use nix::sys::resource::{Usage, UsageWho, getrusage};
use nix::sys::time::TimeValLike;
use std::convert::Infallible;
use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// Runs of which the best counts.
const RUNS: usize = 9;

/// Revolutions of the crank a second in the paper's cases.
const REVOLUTIONS_PER_SECOND: f64 = 5000.0 / 60.0;

/// Keeps nothing.
struct Nothing;

impl Recorder for Nothing {
    type Error = Infallible;

    fn sample(&mut self, _: &Observation) -> Result<(), Infallible> {
        Ok(())
    }

    fn event(&mut self, _: Event) -> Result<(), Infallible> {
        Ok(())
    }

    fn contact(&mut self, _: Contact) -> Result<(), Infallible> {
        Ok(())
    }

    fn peak(&mut self, _: Peak) -> Result<(), Infallible> {
        Ok(())
    }
}

/// CPU and wall time (s) of a piece of work.
#[derive(Clone, Copy)]
struct Cost {
    cpu: f64,
    wall: f64,
}

impl Cost {
    const NONE: Cost = Cost { cpu: f64::INFINITY, wall: f64::INFINITY };

    fn least(self, other: Cost) -> Cost {
        Cost { cpu: self.cpu.min(other.cpu), wall: self.wall.min(other.wall) }
    }
}

type Outcome<T> = Result<T, Box<dyn Error>>;

/// What a piece of work costs this process, or the processes that it starts.
fn measure(who: UsageWho, work: impl FnOnce() -> Outcome<()>) -> Outcome<Cost> {
    let cpu =
        |usage: &Usage| (usage.user_time() + usage.system_time()).num_microseconds() as f64 * 1e-6;
    let (before, begun) = (getrusage(who)?, Instant::now());
    work()?;
    let wall = begun.elapsed().as_secs_f64();
    Ok(Cost { cpu: cpu(&getrusage(who)?) - cpu(&before), wall })
}

/// A solution alone: what it cost at best, and what the engine counted.
struct Solution {
    cost: Cost,
    counts: Vec<Count>,
    contacts: u64,
}

impl Solution {
    fn count(&self, name: &str) -> u64 {
        self.counts.iter().find(|count| count.name == name).map_or(0, |count| count.value)
    }

    fn step_microseconds(&self) -> f64 {
        self.cost.cpu * 1e6 / self.count("steps") as f64
    }
}

/// A solution by IDA.
fn solve(case: &Case, options: Options) -> Outcome<Solution> {
    solve_by(case, options.relative_tolerance, |mechanism| Ida::new(mechanism, options))
}

fn solve_by<E: Engine<f64, System = Mechanism<f64>>>(
    case: &Case,
    tolerance: f64,
    engine_for: impl Fn(Mechanism<f64>) -> Result<E, E::Error>,
) -> Outcome<Solution> {
    let schedule = Schedule::new(&case.plan.duration, &case.plan.duration);
    let mut solution = Solution { cost: Cost::NONE, counts: Vec::new(), contacts: 0 };
    for _ in 0..RUNS {
        let model = Model::new(&case.description).map_err(|complaints| case.reject(complaints))?;
        let mechanism = Mechanism::new(model).map_err(|complaints| case.reject(complaints))?;
        let cost = measure(UsageWho::RUSAGE_SELF, || {
            let mut watch = |progress: &Progress| {
                solution.contacts = progress.contacts;
                ControlFlow::Continue(())
            };
            let mut engine = engine_for(mechanism)?;
            run::run(&mut engine, &schedule, tolerance, &mut Nothing, &mut watch)?;
            solution.counts = engine.counts();
            Ok(())
        })?;
        solution.cost = solution.cost.least(cost);
    }
    Ok(solution)
}

/// The program itself, with a case's own samples.
fn command(case: &Path, output: &Path) -> Outcome<Cost> {
    let mut best = Cost::NONE;
    for _ in 0..RUNS {
        let cost = measure(UsageWho::RUSAGE_CHILDREN, || {
            let mut command = Command::new(env!("CARGO_BIN_EXE_freeplay"));
            command.arg("run").arg(case).arg("-o").arg(output).args(["--force", "--quiet"]);
            let ran = command.output()?;
            if ran.status.success() {
                return Ok(());
            }
            Err(String::from_utf8_lossy(&ran.stderr).into())
        })?;
        best = best.least(cost);
    }
    Ok(best)
}

fn read(path: &Path) -> Outcome<Case> {
    Ok(Case::read(path, &Changes::default())?)
}

fn main() -> Outcome<()> {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases");
    let paths = ["ideal", "a", "b", "c"].map(|name| cases.join(format!("four-bar-{name}.toml")));
    println!("The solution alone, 60 ms:");
    println!(
        "{:<12}{:<8}{:>9}{:>10}{:>10}{:>10}{:>9}{:>9}{:>9}{:>12}",
        "case",
        "norm",
        "steps",
        "residuals",
        "Jacobians",
        "contacts",
        "CPU (s)",
        "us/step",
        "rev/s",
        "stock/own"
    );
    let mut alone = vec![None];
    for path in &paths[1..] {
        let case = read(path)?;
        for (name, norm) in [("ode15s", Norm::Ode15s), ("wrms", Norm::Wrms)] {
            let options = Options { norm, ..ida_options(&case.plan.solver) };
            let own = solve(&case, options)?;
            let stock = solve(&case, Options { stock_vector_operations: true, ..options })?;
            let duration = case.plan.duration.to_f64();
            println!(
                "{:<12}{:<8}{:>9}{:>10}{:>10}{:>10}{:>9.3}{:>9.2}{:>9.1}{:>12.2}",
                case.name,
                name,
                own.count("steps"),
                own.count("residual_evaluations"),
                own.count("jacobian_evaluations"),
                own.contacts,
                own.cost.cpu,
                own.step_microseconds(),
                duration * REVOLUTIONS_PER_SECOND / own.cost.cpu,
                stock.step_microseconds() / own.step_microseconds()
            );
            if norm == ida_options(&case.plan.solver).norm {
                alone.push(Some(own.cost));
            }
        }
    }
    println!("\nThe explicit engine alone, 60 ms:");
    println!("{:<16}{:>12}{:>9}{:>9}", "case", "tolerance", "steps", "CPU (s)");
    for path in &paths[1..] {
        let case = read(path)?;
        for tolerance in [1e-12, 1e-14] {
            let options = explicit_options(&case.plan.solver, tolerance);
            let own = solve_by(&case, tolerance, |mechanism| Explicit::new(mechanism, options))?;
            let steps = own.count("steps");
            println!("{:<16}{tolerance:>12e}{steps:>9}{:>9.4}", case.name, own.cost.cpu);
        }
    }
    println!("\nThe whole command, 6001 samples:");
    println!(
        "{:<16}{:>9}{:>10}{:>22}{:>23}",
        "case", "CPU (s)", "wall (s)", "CPU/solution alone", "wall/solution alone"
    );
    let folder = tempfile::tempdir()?;
    for (path, alone) in paths.iter().zip(alone) {
        let whole = command(path, &folder.path().join("result.h5"))?;
        let over = |whole: f64, alone: Option<f64>| {
            alone.map_or("-".to_owned(), |alone| format!("{:.2}", whole / alone))
        };
        println!(
            "{:<16}{:>9.3}{:>10.3}{:>22}{:>23}",
            read(path)?.name,
            whole.cpu,
            whole.wall,
            over(whole.cpu, alone.map(|cost| cost.cpu)),
            over(whole.wall, alone.map(|cost| cost.wall))
        );
    }
    Ok(())
}
