//! `freeplay impact [LAW…]`

use super::{Failure, laws, plot, signals};
use crate::case::{Case, Changes};
use crate::contact::{Damping, Impact, NormalLaw, elastic, force_loop, viscous};
use crate::figure::{self, Format, Options};
use crate::model::Model;
use crate::parameter::Kind;
use crate::post::table;
use crate::run::{Progress, Trajectory};
use crate::simulate::Simulation;
use serde_json::{Value, json};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use toml_edit::DocumentMut;

/// Arguments of `impact`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Laws of the damping by their names in case files; default: all.
    #[arg(value_name = "LAW")]
    laws: Vec<String>,
    /// Elastic laws, names with commas between, or `all`. Laws with a damping of their own take none.
    #[arg(long, value_name = "NAME", value_delimiter = ',', default_value = "power")]
    elastic: Vec<String>,
    /// Nominal restitution.
    #[arg(long, value_name = "E", default_value = "0.7")]
    restitution: f64,
    /// Speed (m/s).
    #[arg(long, value_name = "V", value_parser = positive, default_value = "1")]
    speed: f64,
    /// Mass (kg).
    #[arg(long, value_name = "M", value_parser = positive, default_value = "0.05")]
    mass: f64,
    /// How far beside the middle of its bearing the journal falls, as a share of the clearance: 0 is
    /// a fall on a wall, for which alone the closed form is exact.
    #[arg(long, value_name = "SHARE", value_parser = share, default_value = "0")]
    aside: f64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    /// Draw the loops of force over penetration, too: folder for the figure; made if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace a figure that exists.
    #[arg(long)]
    force: bool,
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if f64::is_finite(value) && value > 0.0 => Ok(value),
        _ => Err("it must be a number greater than 0".to_owned()),
    }
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if (0.0..1.0).contains(&value) => Ok(value),
        _ => Err("it must be a number from 0 to less than 1".to_owned()),
    }
}

/// Both engines, as case files name them.
const ENGINES: [&str; 2] = ["ida", "explicit"];
/// Moments of a loop in closed form.
const MOMENTS: usize = 401;
/// Samples of an impact.
const SAMPLES: f64 = 60.0;
/// Radius of the bearing, radial clearance and length of the contact (m).
const JOINT: [f64; 3] = [0.010, 0.0005, 0.015];

/// Why there is nothing to compare.
#[derive(Debug, thiserror::Error)]
enum Wrong {
    #[error(
        "an impact with law {law:?} and elastic law {elastic:?} has no end within twice its time"
    )]
    NoEnd { law: String, elastic: String },
    #[error(
        "a mass of {mass} kg at {speed} m/s does not come back with law {law:?}: nothing is to be compared"
    )]
    StaysThere { law: String, mass: f64, speed: f64 },
}

/// What a mass does in the bench's joint.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fall {
    /// Nominal restitution.
    pub restitution: f64,
    /// Mass (kg).
    pub mass: f64,
    /// Speed (m/s).
    pub speed: f64,
    /// How far beside the middle it falls, as a share of the clearance.
    pub aside: f64,
}

/// A law of the damping.
#[derive(Debug, Clone, Copy)]
pub(super) enum Law {
    /// A weight.
    Weight(Damping),
    /// One of its own.
    Viscous(&'static Kind),
}

impl Law {
    /// Every law.
    pub fn all() -> impl Iterator<Item = Law> {
        let weights = Damping::ALL.iter().map(|(_, law)| Law::Weight(*law));
        weights.chain(viscous::KINDS.iter().map(|kind| Law::Viscous(kind)))
    }

    /// Its name in case files.
    pub fn word(self) -> &'static str {
        match self {
            Law::Weight(law) => law.about().word,
            Law::Viscous(kind) => kind.word,
        }
    }
}

/// The table of a normal force in the bench's joint: values of the example of its elastic law, or of
/// the law itself where it has a damping of its own, but for what the fall gives.
fn normal(law: Law, elastic: &Kind, fall: &Fall) -> String {
    let example = match law {
        Law::Weight(_) => elastic.example,
        Law::Viscous(kind) => kind.example,
    };
    // examples are read by a test
    let mut document: DocumentMut = example.parse().unwrap_or_default();
    let table = &mut document["joints"]["A"]["clearance"]["normal"];
    if let Law::Weight(damping) = law {
        table["law"] = toml_edit::value(law.word());
        let takes = damping.about().restitution;
        table["restitution"] = toml_edit::value(fall.restitution);
        if !takes && let Some(table) = table.as_table_like_mut() {
            table.remove("restitution");
        }
    } else if let Law::Viscous(kind) = law {
        for (key, value) in [("restitution", fall.restitution), ("mass", fall.mass)] {
            if kind.keys.iter().any(|known| known.name == key) {
                table[key] = toml_edit::value(value);
            }
        }
    }
    table.to_string()
}

/// The case of a fall: a journal that flies against the wall of its bearing.
fn case(
    law: Law,
    elastic: &Kind,
    fall: &Fall,
    engine: &str,
    [span, interval]: [f64; 2],
) -> Result<Case, Failure> {
    let [bearing, radial, _] = JOINT;
    let Fall { mass, speed, aside, .. } = fall;
    let text = format!(
        "[ground]\npoints = {{ O = [0.0, 0.0] }}\n\
         [bodies.journal]\nmass = {mass:?}\ninertia = {:?}\npoints = {{ C = [0.0, 0.0] }}\n\
         [joints.O]\nkind = \"revolute\"\nbetween = [\"ground.O\", \"journal.C\"]\n\
         [joints.O.clearance]\nbearing_radius = {bearing:?}\nradial = {radial:?}\nnormal = {}\n\
         [start.journal]\nx = 0.0\ny = {:?}\nangle = 0.0\nvelocity_x = {speed:?}\nvelocity_y = 0.0\n\
         angular_velocity = 0.0\nfixed = true\n\
         [run]\nduration = {span:?}\nsample_interval = {interval:?}\n\
         [solver]\nengine = {engine:?}\nabsolute_tolerance = \"scaled\"\n",
        0.5 * mass * (bearing - radial).powi(2),
        normal(law, elastic, fall),
        aside * radial,
    );
    Case::from_text(Path::new("impact.toml"), &text, &Changes::default()).map_err(Failure::input)
}

/// One impact by a run.
struct Simulated {
    impact: Impact,
    points: Vec<[f64; 2]>,
}

/// A law with its closed form and what both engines make of it.
struct Compared {
    law: &'static str,
    elastic: &'static str,
    exact: Impact,
    simulated: Vec<Simulated>,
    exact_loop: Vec<[f64; 2]>,
}

impl Compared {
    /// The largest relative difference of a run from the closed form.
    fn off(&self, engine: usize) -> f64 {
        let (a, b) = (&self.simulated[engine].impact, &self.exact);
        let pairs = [
            (a.rebound, b.rebound),
            (a.depth, b.depth),
            (a.force, b.force),
            (a.duration, b.duration),
        ];
        pairs.iter().map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max)
    }
}

/// Lets a mass fall with one law after another, and holds the runs against closed forms.
pub(super) fn impact(arguments: &Arguments) -> Result<(), Failure> {
    signals::end_at_once()?;
    laws::check_restitution(arguments.restitution)?;
    let chosen: Vec<Law> = match arguments.laws.is_empty() {
        true => Law::all().collect(),
        false => laws_of_names(&arguments.laws)?,
    };
    let elastics = elastics_of_names(&arguments.elastic)?;
    let fall = Fall {
        restitution: arguments.restitution,
        mass: arguments.mass,
        speed: arguments.speed,
        aside: arguments.aside,
    };
    let mut compared = Vec::new();
    for law in chosen {
        let elastics = match law {
            Law::Weight(_) => &elastics[..],
            Law::Viscous(_) => &[elastic::POWER],
        };
        for elastic in elastics {
            compared.push(compare(law, elastic, &fall)?);
        }
    }
    if let Some(folder) = &arguments.output {
        let loops: Vec<figure::ImpactLoop> = compared.iter().map(drawn).collect();
        let figures = figure::draw_impacts(&loops, &Options::default());
        plot::write(&figures, &[Format::Svg], folder, arguments.force, &[])?;
    }
    match arguments.json {
        true => super::print_json(format_args!("{:#}\n", told(&compared, &fall))),
        false => super::print(in_words(&compared, &fall)),
    }
}

fn laws_of_names(names: &[String]) -> Result<Vec<Law>, Failure> {
    let of_name = |name: &String| {
        let found = Law::all().find(|law| law.word() == name);
        found.ok_or_else(|| laws::unknown(name, Law::all().map(Law::word)))
    };
    names.iter().map(of_name).collect()
}

fn elastics_of_names(names: &[String]) -> Result<Vec<&'static Kind>, Failure> {
    if names == ["all"] {
        return Ok(elastic::KINDS.to_vec());
    }
    let of_name = |name: &String| {
        let found = elastic::KINDS.iter().find(|kind| kind.word == name).copied();
        found.ok_or_else(|| laws::unknown(name, elastic::KINDS.iter().map(|kind| kind.word)))
    };
    names.iter().map(of_name).collect()
}

/// Runs one law on both engines.
fn compare(law: Law, elastic: &'static Kind, fall: &Fall) -> Result<Compared, Failure> {
    let (word, radial) = (law.word(), JOINT[1]);
    // what it strikes at, and how far it flies until then
    let along = (1.0 - fall.aside * fall.aside).sqrt();
    let (speed, flight) = (fall.speed * along, radial * along / fall.speed);
    let normal = normal_law(law, elastic, fall)?;
    let exact = Impact::of(&normal, fall.mass, speed);
    if !(exact.duration.is_finite() && exact.rebound > 0.0) {
        let (law, mass, speed) = (word.to_owned(), fall.mass, fall.speed);
        return Err(Failure::input(Wrong::StaysThere { law, mass, speed }));
    }
    let simulated = ENGINES.iter().map(|engine| {
        let (interval, span) = (exact.duration / SAMPLES, flight + 2.0 * exact.duration);
        let case = case(law, elastic, fall, engine, [span, interval])?;
        let mut kept = Trajectory::default();
        let mut go_on = |_: &Progress| ControlFlow::Continue(());
        let simulation = Simulation::new(&case).map_err(Failure::input)?;
        simulation.run(&mut kept, &mut go_on).1.map_err(|error| Failure::with(1, error))?;
        simulated(&kept).ok_or_else(|| {
            let (law, elastic) = (word.to_owned(), elastic.word.to_owned());
            Failure::input(Wrong::NoEnd { law, elastic })
        })
    });
    Ok(Compared {
        law: word,
        elastic: elastic.word,
        exact,
        simulated: simulated.collect::<Result<_, Failure>>()?,
        exact_loop: force_loop(&normal, fall.mass, speed, MOMENTS),
    })
}

/// The law of the normal force in the bench's joint.
pub(super) fn normal_law(law: Law, elastic: &Kind, fall: &Fall) -> Result<NormalLaw<f64>, Failure> {
    let case = case(law, elastic, fall, ENGINES[0], [1.0, 1.0])?;
    let model = Model::<f64>::new(&case.description);
    let model = model.map_err(|complaints| Failure::input(case.reject(complaints)))?;
    Ok(model.clearances()[0].normal)
}

/// What the first contact of a run did; `None` where it has no end.
fn simulated(kept: &Trajectory) -> Option<Simulated> {
    let contact = kept.contacts.first().filter(|contact| contact.end.is_finite())?;
    let last = kept.samples.last()?;
    // back along the straight flight to the end of the contact
    let (velocity, gone) = (last.bodies[0].velocity, last.time - contact.end);
    let offset = last.clearances[0].offset;
    let at = [0, 1].map(|axis| offset[axis] - velocity[axis] * gone);
    let outward = (at[0] * velocity[0] + at[1] * velocity[1]) / at[0].hypot(at[1]);
    let touching = kept.samples.iter().map(|sample| &sample.clearances[0]);
    let touching = touching.filter(|clearance| clearance.in_contact);
    Some(Simulated {
        impact: Impact {
            rebound: -outward / contact.impact_rate,
            depth: contact.peak_penetration,
            force: contact.peak_force,
            duration: contact.end - contact.begin,
        },
        points: touching.map(|seen| [seen.penetration, seen.normal_force]).collect(),
    })
}

/// The loop of a law with the samples of the explicit engine's run.
fn drawn(compared: &Compared) -> figure::ImpactLoop {
    let word = match compared.elastic == elastic::POWER.word {
        true => compared.law.to_owned(),
        false => format!("{}, {}", compared.law, compared.elastic),
    };
    let points = compared.simulated[1].points.clone();
    figure::ImpactLoop { word, exact: compared.exact_loop.clone(), points }
}

fn told(compared: &[Compared], fall: &Fall) -> Value {
    let numbers = |impact: &Impact| {
        json!({
            "rebound": impact.rebound,
            "depth": impact.depth,
            "force": impact.force,
            "duration": impact.duration,
        })
    };
    let row = |compared: &Compared| {
        let engines = ENGINES.iter().enumerate().map(|(k, engine)| {
            let mut told = numbers(&compared.simulated[k].impact);
            told["off"] = json!(compared.off(k));
            ((*engine).to_owned(), told)
        });
        json!({
            "law": compared.law,
            "elastic": compared.elastic,
            "closed_form": numbers(&compared.exact),
            "engines": Value::Object(engines.collect()),
        })
    };
    let [bearing, radial, length] = JOINT;
    json!({
        "restitution": fall.restitution,
        "mass": fall.mass,
        "speed": fall.speed,
        "aside": fall.aside,
        "bearing_radius": bearing,
        "radial": radial,
        "length": length,
        "impacts": compared.iter().map(row).collect::<Vec<_>>(),
    })
}

fn in_words(compared: &[Compared], fall: &Fall) -> String {
    let heads = ["law", "elastic", "rebound", "depth (m)", "force (N)", "duration (s)"];
    let mut heads: Vec<String> = heads.map(str::to_owned).to_vec();
    heads.extend(ENGINES.iter().map(|engine| format!("{engine} is off by")));
    let row = |compared: &Compared| {
        let Impact { rebound, depth, force, duration } = compared.exact;
        let mut row = vec![compared.law.to_owned(), compared.elastic.to_owned()];
        row.push(format!("{rebound:.9}"));
        row.extend([depth, force, duration].map(|number| format!("{number:.6e}")));
        row.extend((0..ENGINES.len()).map(|k| format!("{:.1e}", compared.off(k))));
        row
    };
    let rows = compared.iter().map(row).collect();
    let [bearing, radial, length] = JOINT.map(|length| 1e3 * length);
    let where_to = match fall.aside > 0.0 {
        true => format!(
            "its bearing, {} of the clearance beside the middle; closed forms\nare those of the speed along \
             the normal, without what it swings",
            fall.aside
        ),
        false => "the wall of its bearing".to_owned(),
    };
    format!(
        "A mass of {} kg at {} m/s against {where_to}\nBearing {bearing} mm, clearance {radial} mm, length \
         {length} mm; nominal restitution {}\nClosed forms, and the most that a run is off:\n\n{}\n",
        fall.mass,
        fall.speed,
        fall.restitution,
        table(heads, rows, 2)
    )
}
