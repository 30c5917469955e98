//! `freeplay check CASE`

use super::{CaseArguments, Failure};
use crate::advice::{self, Note, Touch, Turn};
use crate::case::{AbsoluteTolerance, Case, EngineName, NormName, Precision, SolverPlan};
use crate::clearance::Clearance;
use crate::contact::elastic::ElasticLaw;
use crate::contact::{self, depth_under};
use crate::dae::System;
use crate::joint::REVOLUTE;
use crate::mechanism::{Mechanism, Observation};
use crate::model::Description;
use crate::model::{KeyPath, one_line};
use crate::parameter::Values;
use crate::post::table;
use crate::scalar::Decimal;
use crate::simulate::Simulation;
use serde_json::{Map, Value, json};
use std::fmt::{self, Display, Write};

/// Arguments of `check`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    case: CaseArguments,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Force (N) that an elastic law without a stiffness of its own is told by.
const PRESSING: f64 = 1000.0;

/// Says what a case describes; writes nothing.
pub(super) fn check(arguments: &Arguments) -> Result<(), Failure> {
    let case = arguments.case.read()?;
    let simulation = Simulation::new(&case).map_err(Failure::input)?;
    let mechanism = simulation.mechanism();
    let turn = advice::turn(&case);
    let touches = advice::touches(mechanism, &turn);
    let notes = advice::notes(&case, mechanism, &turn, &touches);
    let start = mechanism.observe(0.0, &mechanism.start().integrals);
    let checked = Checked { case: &case, simulation: &simulation, start, turn, touches, notes };
    match arguments.json {
        true => super::print_json(format_args!("{:#}\n", checked.json())),
        false => super::print(checked),
    }
}

/// A case in words.
struct Checked<'a> {
    case: &'a Case,
    simulation: &'a Simulation<'a>,
    /// The mechanism at the start.
    start: Observation,
    turn: Turn,
    touches: Vec<Touch>,
    notes: Vec<Note>,
}

impl Display for Checked<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mechanism = self.simulation.mechanism();
        let title = one_line(&self.case.title);
        let colon = if title.is_empty() { "" } else { ": " };
        writeln!(f, "{}{colon}{title}", self.case.name)?;
        mechanism_lines(&self.case.description, mechanism, f)?;
        turn_line(&self.turn, f)?;
        self.clearance_lines(f)?;
        self.start_lines(f)?;
        let schedule = self.simulation.schedule();
        let (duration, samples): (f64, u64) = (schedule.duration(), schedule.len());
        let checkpoints = match &self.case.plan.checkpoint_interval {
            Some(interval) => format!(", a checkpoint every {interval} s"),
            None => String::new(),
        };
        writeln!(f, "  run          {duration} s, {samples} samples{checkpoints}")?;
        solver_line(&self.case.plan.solver, f)?;
        if !self.case.defaults.is_empty() {
            writeln!(f, "  defaults taken")?;
        }
        for default in defaults(self.case) {
            writeln!(f, "    {default}")?;
        }
        writeln!(
            f,
            "  units        SI throughout: m, kg, s, rad, N; speed_rpm in revolutions a minute"
        )?;
        for Note { key, text } in &self.notes {
            writeln!(f, "  note         {key}: {text}")?;
        }
        Ok(())
    }
}

impl Checked<'_> {
    /// The clearances: what is alike in several is said once, below all that have it.
    fn clearance_lines(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mechanism = self.simulation.mechanism();
        let told: Vec<String> = (0..mechanism.modes().len())
            .map(|k| law_lines(&self.case.description, mechanism, k))
            .collect();
        for (k, law) in told.iter().enumerate() {
            if told[..k].contains(law) {
                continue;
            }
            let alike: Vec<usize> = (k..told.len()).filter(|other| told[*other] == *law).collect();
            for k in &alike {
                self.clearance_line(*k, f)?;
            }
            if alike.len() > 1 {
                writeln!(f, "    alike in these {}:", alike.len())?;
            }
            f.write_str(law)?;
        }
        Ok(())
    }

    /// Where a clearance is, and how it starts.
    fn clearance_line(&self, k: usize, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mechanism = self.simulation.mechanism();
        let model = mechanism.model();
        let pair = &model.clearances()[k].pair;
        let (bearing, journal) = (model.body_name(pair.i), model.body_name(pair.j));
        let offset = self.start.clearances[k].eccentricity;
        let mode = self.start_mode(k);
        let name = &model.names().clearances[k];
        let [inner, outer] = model.clearances()[k].surfaces();
        writeln!(f, "  clearance    {name}: {inner} on {journal} in {outer} on {bearing}")?;
        writeln!(f, "    starts in {mode}, eccentricity {offset:.6e} m")?;
        let touch = self.touches.iter().find(|touch| touch.clearance == k);
        match touch {
            Some(touch) => write!(
                f,
                "    an impact at {:.2e} m/s lasts about {:.1e} s and goes {:.1e} m deep ({:.3} kg)",
                touch.speed, touch.duration, touch.depth, touch.mass
            )?,
            None => return Ok(()),
        }
        // else the law tells it, whatever speed and mass
        match (model.clearances()[k].normal.damping_weight(), touch) {
            (None, Some(touch)) => {
                writeln!(f, ", and rebounds at {:.6} of its speed", touch.rebound)
            }
            _ => writeln!(f),
        }
    }

    fn start_mode(&self, k: usize) -> &'static str {
        let touching = self.simulation.mechanism().modes()[k] != crate::clearance::Mode::Flight;
        if touching { "contact" } else { "flight" }
    }

    /// Where each body starts, as it was assembled.
    fn start_lines(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let heads = ["start", "x (m)", "y (m)", "angle (rad)", "(deg)"];
        let rates = ["x' (m/s)", "y' (m/s)", "angle' (rad/s)"];
        let heads = heads.iter().chain(&rates).map(|head| (*head).to_owned()).collect();
        let names = &self.simulation.mechanism().model().names().bodies;
        let rows = names.iter().zip(&self.start.bodies).map(|(name, body)| {
            let ([x, y], [vx, vy]) = (body.position, body.velocity);
            let numbers =
                [x, y, body.angle, body.angle.to_degrees(), vx, vy, body.angular_velocity];
            let numbers = numbers.into_iter().map(|number| plain(number, 7));
            std::iter::once(name.clone()).chain(numbers).collect()
        });
        for line in table(heads, rows.collect(), 1).trim_fmt().lines() {
            writeln!(f, "  {}", line.trim_end())?;
        }
        Ok(())
    }

    /// The same for programs.
    fn json(&self) -> Value {
        let mechanism = self.simulation.mechanism();
        let names = mechanism.model().names();
        let start = names.bodies.iter().zip(&self.start.bodies).map(|(name, body)| {
            let told = json!({
                "x": body.position[0],
                "y": body.position[1],
                "angle": body.angle,
                "velocity_x": body.velocity[0],
                "velocity_y": body.velocity[1],
                "angular_velocity": body.angular_velocity,
            });
            (name.clone(), told)
        });
        let clearances = (0..names.clearances.len())
            .map(|k| (names.clearances[k].clone(), self.clearance_json(k)));
        let driven = (0..names.bodies.len()).filter(|body| mechanism.is_driven(*body));
        let description = &self.case.description;
        let defaults = self.case.defaults.iter();
        let defaults = defaults.map(|default| (default.key.to_string(), json!(default.value)));
        let schedule = self.simulation.schedule();
        let notes = self.notes.iter().map(|note| json!({ "key": note.key, "text": note.text }));
        json!({
            "case_name": self.case.name,
            "title": self.case.title,
            "units": "m, kg, s, rad, N",
            "bodies": names.bodies,
            "driven": driven.map(|body| &names.bodies[body]).collect::<Vec<_>>(),
            "joints": names.joints,
            "joint_kinds": kinds_of(description.joints.iter().map(|j| (&j.name, &j.part))),
            "loads": kinds_of(description.loads.iter().map(|load| (&load.name, &load.part))),
            "drives": names.drives,
            "freedoms": mechanism.freedoms(),
            "coordinates": mechanism.coordinates(),
            "constraints": mechanism.multipliers(),
            "redundant": mechanism.redundant(),
            "redundantly_held": redundant_names(mechanism),
            "start": Map::from_iter(start),
            "clearances": Map::from_iter(clearances),
            "turn": turn_json(&self.turn),
            "duration": schedule.duration::<f64>(),
            "samples": schedule.len(),
            "checkpoint_interval": self.case.plan.checkpoint_interval.as_ref().map(Decimal::to_f64),
            "defaults": Map::from_iter(defaults),
            "notes": notes.collect::<Vec<_>>(),
        })
    }

    fn clearance_json(&self, k: usize) -> Value {
        let clearance = &self.simulation.mechanism().model().clearances()[k];
        let touch = self.touches.iter().find(|touch| touch.clearance == k);
        let power = clearance.normal.elastic().power();
        let weight = clearance.normal.damping_weight();
        let name = &self.simulation.mechanism().model().names().clearances[k];
        let described = self.case.description.clearance(name);
        let described = described.and_then(|clearance| clearance.friction.as_ref());
        json!({
            "touches": clearance.surfaces()[0],
            "radial": clearance.radial,
            "bearing_radius": clearance.wall.is_none().then_some(clearance.bearing_radius),
            "journal_radius": clearance.journal_radius,
            "elastic": elastic_word(&self.case.description, self.simulation.mechanism(), k),
            "stiffness": power.map(|(stiffness, _)| stiffness),
            "exponent": power.map(|(_, exponent)| exponent),
            "damping_weight": weight,
            "damping": word_of_damping(&self.case.description, self.simulation.mechanism(), k),
            "rebound": weight.map(contact::rebound).or(touch.map(|touch| touch.rebound)),
            "nominal_restitution": nominal_restitution(&self.case.description, self.simulation.mechanism(), k),
            "friction": clearance.friction.is_some(),
            "friction_law": described.map(|values| values.kind().word),
            "holds_at_rest": clearance.friction.map(|law| law.remembers()),
            "creep_under_half": described.zip(clearance.friction).and_then(|(values, law)| {
                law.creep(0.5 * friction_of_rest(values))
            }),
            "tension": if clearance.cut_tension { "cut" } else { "keep" },
            "minimum_impact_rate": clearance.minimum_impact_rate,
            "maximum_penetration": clearance.maximum_penetration,
            "starts_in": self.start_mode(k),
            "eccentricity": self.start.clearances[k].eccentricity,
            "impact": touch.map(|touch| json!({
                "speed": touch.speed,
                "mass": touch.mass,
                "duration": touch.duration,
                "depth": touch.depth,
            })),
        })
    }
}

/// The defaults taken; those that several joints share are told once.
fn defaults(case: &Case) -> Vec<String> {
    let mut told: Vec<(Vec<String>, String)> = Vec::new();
    for default in &case.defaults {
        let keys = default.key.keys();
        let (joint, rest) = match keys {
            [list, joint, rest @ ..] if list == "joints" => (vec![joint.clone()], rest),
            _ => (Vec::new(), keys),
        };
        let rest = format!("{} = {}", KeyPath::new(rest.iter().map(String::as_str)), default.value);
        match told.iter_mut().find(|(joints, known)| !joints.is_empty() && *known == rest) {
            Some((joints, _)) => joints.extend(joint),
            None => told.push((joint, rest)),
        }
    }
    let line = |(joints, rest): (Vec<String>, String)| match &joints[..] {
        [] => rest,
        [joint] => format!("joints.{joint}.{rest}"),
        joints => format!("joints.{{{}}}.{rest}", joints.join(", ")),
    };
    told.into_iter().map(line).collect()
}

/// Whether the ideal mechanism turns.
fn turn_line(turn: &Turn, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(f, "  turning      ")?;
    match turn {
        Turn::Whole { span, .. } => {
            writeln!(f, "the ideal mechanism goes round, {} ms", tidy(span * 1e3))
        }
        Turn::Locks { time, .. } => {
            writeln!(f, "the ideal mechanism LOCKS at {:.4} ms: see the note below", time * 1e3)
        }
        Turn::Free { freedoms } => writeln!(
            f,
            "not tried: the ideal mechanism has {freedoms} freedom{} that no drive prescribes",
            if *freedoms == 1 { "" } else { "s" }
        ),
        Turn::Still => writeln!(f, "no drive turns"),
        Turn::NotAssembled { .. } => {
            writeln!(f, "not tried: without its clearances the mechanism does not go together")
        }
    }
}

fn turn_json(turn: &Turn) -> Value {
    match turn {
        Turn::Whole { span, forces } => json!({
            "goes_round": true, "span": span, "largest_forces": forces_json(forces),
        }),
        Turn::Locks { time, drives, why, forces } => json!({
            "goes_round": false,
            "locks_at": time,
            "drive_angles": forces_json(drives),
            "why": why,
            "largest_forces": forces_json(forces),
        }),
        Turn::Free { freedoms } => json!({ "goes_round": null, "freedoms": freedoms }),
        Turn::Still => json!({ "goes_round": null, "drives_turn": false }),
        Turn::NotAssembled { why } => json!({ "goes_round": null, "why": why }),
    }
}

/// Numbers by their names.
fn forces_json(named: &[(String, f64)]) -> Value {
    Map::from_iter(named.iter().map(|(name, value)| (name.clone(), json!(value)))).into()
}

/// A number to so many significant digits, zero where it is rounding.
fn plain(number: f64, digits: usize) -> String {
    if number.abs() < 1e-12 {
        return "0".to_owned();
    }
    let exponent = number.abs().log10().floor() as i32;
    if !(-4..7).contains(&exponent) {
        return format!("{number:.*e}", digits - 1);
    }
    format!("{number:.*}", (digits as i32 - 1 - exponent).max(0) as usize)
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

fn mechanism_lines(
    description: &Description,
    mechanism: &Mechanism<f64>,
    f: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    let names = mechanism.model().names();
    let driven = (0..names.bodies.len()).filter(|body| mechanism.is_driven(*body));
    let driven: Vec<&str> = driven.map(|body| names.bodies[body].as_str()).collect();
    writeln!(f, "  bodies       {}", names.bodies.join(", "))?;
    if !driven.is_empty() {
        writeln!(f, "  driven       {}: prescribed by the drives, no unknowns", driven.join(", "))?;
    }
    let of_kind = |name: &str, kind: &str| format!("{name} ({kind})");
    let ideal = description.joints.iter().filter(|joint| joint.clearance.is_none());
    let ideal: Vec<String> = ideal
        .map(|joint| match joint.part.kind().word {
            REVOLUTE => joint.name.clone(),
            kind => of_kind(&joint.name, kind),
        })
        .collect();
    writeln!(
        f,
        "  ideal joints {}",
        if ideal.is_empty() { "none".into() } else { ideal.join(", ") }
    )?;
    let loads = description.loads.iter();
    let loads: Vec<String> = loads.map(|load| of_kind(&load.name, load.part.kind().word)).collect();
    if !loads.is_empty() {
        writeln!(f, "  loads        {}", loads.join(", "))?;
    }
    let (coordinates, rows) = (mechanism.coordinates(), mechanism.multipliers());
    let freedoms = mechanism.freedoms();
    writeln!(
        f,
        "  freedoms     {freedoms}: {coordinates} coordinates, {rows} constraints{}",
        if freedoms == 0 && mechanism.modes().is_empty() {
            "; assembled at each time, nothing is integrated"
        } else {
            ""
        }
    )?;
    let held = redundant_names(mechanism);
    match mechanism.redundant() {
        0 => Ok(()),
        count => writeln!(
            f,
            "  redundant    {count} of the constraints: {} hold each other, their forces are those of \
             least norm",
            held.join(", ")
        ),
    }
}

/// The kind of each part, by its name.
fn kinds_of<'a>(parts: impl Iterator<Item = (&'a String, &'a Values)>) -> Value {
    let kinds = parts.map(|(name, part)| (name.clone(), json!(part.kind().word)));
    Value::Object(kinds.collect())
}

/// The nominal restitution of a clearance whose achieved one is given.
fn nominal_restitution(
    description: &Description,
    mechanism: &Mechanism<f64>,
    k: usize,
) -> Option<f64> {
    let name = &mechanism.model().names().clearances[k];
    description.clearance(name)?.normal.nominal_restitution()
}

/// The joints and drives that hold each other, by name.
fn redundant_names(mechanism: &Mechanism<f64>) -> Vec<String> {
    let names = mechanism.model().names();
    mechanism.redundantly_held().iter().map(|owner| owner.name(names)).collect()
}

/// The word of the elastic law of a clearance.
fn elastic_word(
    description: &Description,
    mechanism: &Mechanism<f64>,
    k: usize,
) -> Option<&'static str> {
    let name = &mechanism.model().names().clearances[k];
    Some(description.clearance(name)?.normal.elastic.kind().word)
}

/// The word of the damping of a clearance.
fn word_of_damping(
    description: &Description,
    mechanism: &Mechanism<f64>,
    k: usize,
) -> Option<&'static str> {
    let name = &mechanism.model().names().clearances[k];
    Some(description.clearance(name)?.normal.law.word())
}

/// What a clearance is, without where it is.
fn law_lines(description: &Description, mechanism: &Mechanism<f64>, k: usize) -> String {
    let mut lines = String::new();
    // writing to a string cannot fail
    let _ = write_law(description, mechanism, k, &mut lines);
    lines
}

fn write_law(
    description: &Description,
    mechanism: &Mechanism<f64>,
    k: usize,
    f: &mut String,
) -> fmt::Result {
    let clearance = &mechanism.model().clearances()[k];
    let radial = tidy(clearance.radial);
    let [bearing, journal] = [clearance.bearing_radius, clearance.journal_radius].map(tidy);
    match clearance.surfaces()[0] {
        "corner" => {
            let height = 2.0 * clearance.wall.map_or(0.0, |wall| wall.nominal);
            writeln!(f, "    play {radial:e} m on each side of a block {:e} m high", tidy(height))?;
        }
        "pin" => writeln!(f, "    play {radial:e} m on each side of a pin of {journal:e} m")?,
        _ => writeln!(
            f,
            "    radial clearance {radial:e} m, bearing {bearing:e} m, journal {journal:e} m"
        )?,
    }
    let law = &clearance.normal;
    match law.elastic().power() {
        Some((k, n)) => write!(f, "    K = {k:.9e} N/m^{}", tidy(n))?,
        None => write!(
            f,
            "    elastic law {}: {PRESSING} N press it {:.4e} m deep",
            elastic_word(description, mechanism, k).unwrap_or_default(),
            depth_under(law.elastic(), PRESSING)
        )?,
    }
    match law.damping_weight() {
        Some(a) => writeln!(f, ", damping weight a = {}", tidy(a))?,
        None => writeln!(
            f,
            ", damping of law {}",
            word_of_damping(description, mechanism, k).unwrap_or_default()
        )?,
    }
    let described = description.clearance(&mechanism.model().names().clearances[k]);
    let friction = described.and_then(|clearance| clearance.friction.as_ref());
    let Some(a) = law.damping_weight() else { return write_rest(friction, clearance, f) };
    let rebound = contact::rebound(a);
    let asked = match nominal_restitution(description, mechanism, k) {
        Some(nominal) => format!(", as asked for: a nominal restitution of {nominal:.6}"),
        None => String::new(),
    };
    writeln!(f, "    one impact by itself rebounds at {rebound:.6} of its speed{asked}")?;
    write_rest(friction, clearance, f)
}

/// Friction of rest over the normal force: the key `static`, or the one coefficient there is.
fn friction_of_rest(friction: &Values) -> f64 {
    let key = if friction.get("static").is_some() { "static" } else { "coefficient" };
    friction.number(key)
}

/// The friction of a clearance, and what becomes of a load that rests on it.
fn friction_at_rest(described: Option<&Values>, clearance: &Clearance<f64>) -> String {
    let (Some(values), Some(law)) = (described, &clearance.friction) else {
        return "no friction".to_owned();
    };
    let word = values.kind().word;
    if law.remembers() {
        return format!("friction {word}, which holds a load at rest");
    }
    let half = 0.5 * friction_of_rest(values);
    match law.creep(half) {
        Some(slip) => format!(
            "friction {word}, which CREEPS under a load at rest: at {slip:.1e} m/s under {half} of the\n    \
             normal force, half of what it can bear"
        ),
        None => format!("friction {word}"),
    }
}

/// What was decided for a clearance where laws are silent.
fn write_rest(
    described: Option<&Values>,
    clearance: &Clearance<f64>,
    f: &mut String,
) -> fmt::Result {
    let friction = friction_at_rest(described, clearance);
    let tension = if clearance.cut_tension { "cut to zero" } else { "kept, as the law is printed" };
    writeln!(f, "    {friction}; tension is {tension}")?;
    writeln!(
        f,
        "    approaches slower than {:e} m/s count as that fast",
        clearance.minimum_impact_rate
    )?;
    writeln!(
        f,
        "    a run stops where the {} is deeper than {:e} m, {}",
        clearance.surfaces()[0],
        tidy(clearance.believed_depth()),
        match clearance.normal.elastic().deepest() > clearance.believed_depth() {
            true if clearance.wall.is_none() =>
                format!("{} of its radius", clearance.maximum_penetration),
            _ => clearance.believed_because(),
        }
    )
}
