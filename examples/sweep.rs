//! A loop over a parameter: the largest contact force of the paper's case a over its clearance.
//!
//! ```sh
//! cargo run --release --example sweep
//! ```

use freeplay::case::{Case, Changes};
use freeplay::run::{Progress, Trajectory};
use freeplay::simulate::Simulation;
use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    println!("c (mm)   largest force (kN)   contacts");
    for tenths in 1..=10 {
        let clearance = f64::from(tenths) * 1e-4;
        let set = [
            format!("joints.A.clearance.radial={clearance:e}"),
            "solver.engine=explicit".to_owned(),
            "solver.relative_tolerance=1e-9".to_owned(),
            "run.duration=0.012".to_owned(),
        ];
        let set = set.iter().map(|change| change.parse()).collect::<Result<_, _>>()?;
        let case = Case::read(Path::new("cases/four-bar-a.toml"), &Changes { set, ideal: false })?;
        let mut kept = Trajectory::default();
        let mut go_on = |_: &Progress| ControlFlow::Continue(());
        Simulation::new(&case)?.run(&mut kept, &mut go_on).1?;
        let largest = kept.contacts.iter().map(|contact| contact.peak_force).fold(0.0, f64::max);
        println!("{:6.1} {:20.3} {:10}", clearance * 1e3, largest * 1e-3, kept.contacts.len());
    }
    Ok(())
}
