//! Runs a case in memory and prints the peaks of its contact forces.
//!
//! ```sh
//! cargo run --release --example peaks -- cases/four-bar-a.toml
//! ```

use freeplay::case::{Case, Changes};
use freeplay::run::{Progress, Trajectory};
use freeplay::simulate::Simulation;
use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).unwrap_or("cases/four-bar-a.toml".into());
    let case = Case::read(Path::new(&path), &Changes::default())?;
    let simulation = Simulation::new(&case)?;
    let names = simulation.mechanism().model().names().clearances.clone();

    // everything that the run tells is kept: samples, events, contacts, peaks
    let mut kept = Trajectory::default();
    let mut go_on = |_: &Progress| ControlFlow::Continue(());
    let (_, ran) = simulation.run(&mut kept, &mut go_on);
    ran?;

    let mut peaks = kept.peaks.clone();
    peaks.sort_by(|a, b| b.force.total_cmp(&a.force));
    for peak in peaks.iter().take(10) {
        println!(
            "{:>10.1} N in {} at {:.4} ms",
            peak.force,
            names[peak.clearance],
            peak.time * 1e3
        );
    }
    Ok(())
}
