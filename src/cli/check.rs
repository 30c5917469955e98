//! `freeplay check CASE`

use super::{CaseArguments, Failure};
use crate::case::{AbsoluteTolerance, Case, EngineName, NormName, Precision, SolverPlan};
use crate::contact;
use crate::dae::System;
use crate::mechanism::Mechanism;
use crate::simulate::Simulation;
use std::fmt::{self, Display, Write};

/// Arguments of `check`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    case: CaseArguments,
}

/// Says what a case describes; writes nothing.
pub(super) fn check(arguments: &Arguments) -> Result<(), Failure> {
    let case = arguments.case.read()?;
    let simulation = Simulation::new(&case).map_err(Failure::input)?;
    super::print(Checked { case: &case, simulation: &simulation })
}

/// A case in words.
struct Checked<'a> {
    case: &'a Case,
    simulation: &'a Simulation<'a>,
}

impl Display for Checked<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mechanism = self.simulation.mechanism();
        let title = &self.case.title;
        let colon = if title.is_empty() { "" } else { ": " };
        writeln!(f, "{}{colon}{title}", self.case.name)?;
        mechanism_lines(mechanism, f)?;
        for k in 0..mechanism.modes().len() {
            clearance_lines(mechanism, k, f)?;
        }
        let schedule = self.simulation.schedule();
        let (duration, samples): (f64, u64) = (schedule.duration(), schedule.len());
        writeln!(f, "  run          {duration} s, {samples} samples")?;
        solver_line(&self.case.plan.solver, f)?;
        if !self.case.defaults.is_empty() {
            writeln!(f, "  defaults taken")?;
        }
        for default in &self.case.defaults {
            writeln!(f, "    {} = {}", default.key, default.value)?;
        }
        writeln!(
            f,
            "  units        SI throughout: m, kg, s, rad, N; speed_rpm in revolutions a minute"
        )
    }
}

fn solver_line(solver: &SolverPlan, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(f, "  solver       ")?;
    match (solver.engine, solver.precision) {
        (EngineName::Ida, _) => {
            let norm = NormName::ALL.iter().find(|(_, norm)| *norm == solver.norm);
            let absolute = match solver.absolute_tolerance {
                AbsoluteTolerance::Scalar(tolerance) => format!("{tolerance:e}"),
                AbsoluteTolerance::Scaled => "scaled".to_owned(),
            };
            writeln!(
                f,
                "ida, relative tolerance {:e}, absolute {absolute}, initial step {:e} s, norm {}",
                solver.relative_tolerance,
                solver.initial_step,
                norm.map_or("", |(name, _)| name)
            )
        }
        (EngineName::Explicit, Precision::Double) => {
            writeln!(f, "explicit, relative tolerance {:e}", solver.relative_tolerance)
        }
        (EngineName::Explicit, _) => {
            writeln!(f, "explicit, in 71 digits, tolerance {:e}", solver.reference_tolerance)
        }
    }
}

/// A number without the rounding in its last places.
fn tidy(value: f64) -> f64 {
    format!("{value:.12e}").parse().unwrap_or(value)
}

fn mechanism_lines(mechanism: &Mechanism<f64>, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let names = mechanism.model().names();
    let driven = (0..names.bodies.len()).filter(|body| mechanism.is_driven(*body));
    let driven: Vec<&str> = driven.map(|body| names.bodies[body].as_str()).collect();
    writeln!(f, "  bodies       {}", names.bodies.join(", "))?;
    if !driven.is_empty() {
        writeln!(f, "  driven       {}: prescribed by the drives, no unknowns", driven.join(", "))?;
    }
    let ideal = names.joints.iter().filter(|joint| !names.clearances.contains(joint));
    let ideal: Vec<&str> = ideal.map(String::as_str).collect();
    writeln!(
        f,
        "  ideal joints {}",
        if ideal.is_empty() { "none".into() } else { ideal.join(", ") }
    )?;
    let (coordinates, rows) = (mechanism.coordinates(), mechanism.multipliers());
    let freedoms = mechanism.freedoms();
    writeln!(
        f,
        "  freedoms     {freedoms}: {coordinates} coordinates, {rows} constraints{}",
        if freedoms == 0 { "; assembled at each time, nothing is integrated" } else { "" }
    )
}

fn clearance_lines(
    mechanism: &Mechanism<f64>,
    k: usize,
    f: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    let model = mechanism.model();
    let clearance = &model.clearances()[k];
    let pair = &clearance.pair;
    let (bearing, journal) = (model.body_name(pair.i), model.body_name(pair.j));
    writeln!(
        f,
        "  clearance    {}: journal on {journal} in bearing on {bearing}",
        model.names().clearances[k]
    )?;
    let mut line = String::new();
    write!(
        line,
        "radial clearance {:e} m, bearing {:e} m, journal {:e} m",
        tidy(clearance.radial),
        tidy(clearance.bearing_radius),
        tidy(clearance.journal_radius)
    )?;
    writeln!(f, "    {line}")?;
    let law = &clearance.normal;
    writeln!(
        f,
        "    K = {:.9e} N/m^{}, damping weight a = {}",
        law.stiffness(),
        tidy(law.exponent()),
        tidy(law.damping_weight())
    )?;
    let rebound = contact::rebound(law.damping_weight());
    writeln!(f, "    one impact by itself rebounds at {rebound:.6} of its speed")?;
    let friction = if clearance.friction.is_some() { "with friction" } else { "no friction" };
    let tension = if clearance.cut_tension { "cut to zero" } else { "kept, as the law is printed" };
    writeln!(f, "    {friction}; tension is {tension}")?;
    writeln!(
        f,
        "    approaches slower than {:e} m/s count as that fast",
        clearance.minimum_impact_rate
    )?;
    let start = mechanism.observe(0.0, &mechanism.start().integrals);
    let offset = start.clearances[k].eccentricity;
    let touching = mechanism.modes()[k] != crate::clearance::Mode::Flight;
    let mode = if touching { "contact" } else { "flight" };
    writeln!(f, "    starts in {mode}, eccentricity {offset:.6e} m")
}
