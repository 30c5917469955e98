//! `freeplay laws [NAME]`

use super::Failure;
use super::impact::{self, Fall, Law};
use crate::contact::elastic::{Elastic, Power};
use crate::contact::{Damping, Impact, NormalLaw, elastic, viscous};
use crate::friction;
use crate::parameter::{Kind, Otherwise};
use crate::post::table;
use serde_json::{Value, json};

/// Arguments of `laws`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// One law, by its name in case files.
    name: Option<String>,
    /// Nominal restitutions, separated by commas.
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_values_t = [0.9, 0.5, 0.3])]
    restitution: Vec<f64>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// The impact that laws are told by which have no number without one.
const BENCH: Fall = Fall { restitution: 0.8, mass: 0.05, speed: 1.0, aside: 0.0 };

/// The exponent that penetrations and durations are told for.
const EXPONENT: f64 = 1.5;

#[derive(Debug, thiserror::Error)]
enum Wrong {
    #[error("there is no law {name:?}{near}; `freeplay laws` lists them")]
    Name { name: String, near: String },
    #[error("a restitution must be greater than 0 and at most 1, is {0}")]
    Restitution(f64),
}

/// Refuses what is no restitution.
pub(super) fn check_restitution(e: f64) -> Result<(), Failure> {
    if e > 0.0 && e <= 1.0 { Ok(()) } else { Err(Failure::input(Wrong::Restitution(e))) }
}

/// The laws of the normal force with these names, or all where that is the name.
pub(super) fn of_names(names: &[String]) -> Result<Vec<Damping>, Failure> {
    if names == ["all"] {
        return Ok(Damping::ALL.iter().map(|(_, law)| *law).collect());
    }
    let of_name = |name: &String| match Damping::ALL.iter().find(|(word, _)| word == name) {
        Some((_, law)) => Ok(*law),
        None => Err(unknown(name, Damping::ALL.iter().map(|(word, _)| *word))),
    };
    names.iter().map(of_name).collect()
}

/// Says that a name is none of those known.
pub(super) fn unknown<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Failure {
    let near = crate::model::did_you_mean(name, known);
    Failure::input(Wrong::Name { name: name.to_owned(), near })
}

/// Prints the laws of normal force and friction, and what each really gives.
pub(super) fn laws(arguments: &Arguments) -> Result<(), Failure> {
    arguments.restitution.iter().try_for_each(|e| check_restitution(*e))?;
    let laws = Damping::ALL.iter().copied();
    let laws: Vec<Damping> = match &arguments.name {
        None => laws.map(|(_, law)| law).collect(),
        Some(name) => laws.filter(|(word, _)| word == name).map(|(_, law)| law).collect(),
    };
    let is_asked = |kind: &&&Kind| arguments.name.as_ref().is_none_or(|name| kind.word == name);
    let of = |kinds: &[&'static Kind]| kinds.iter().filter(is_asked).copied().collect::<Vec<_>>();
    let (elastics, own) = (of(elastic::KINDS), of(viscous::KINDS));
    let frictions = of(friction::KINDS);
    let kinds = [&elastics[..], &own, &frictions].concat();
    if let (Some(name), true) = (&arguments.name, laws.is_empty() && kinds.is_empty()) {
        let words = Damping::ALL.iter().map(|(word, _)| *word);
        let all = [elastic::KINDS, viscous::KINDS, friction::KINDS].concat();
        return Err(unknown(name, words.chain(all.iter().map(|kind| kind.word))));
    }
    let hertz = Law::Weight(Damping::Hertz);
    let elastics = elastics.iter().map(|kind| Ok((*kind, impact_of(hertz, kind)?)));
    let own = own.iter().map(|kind| Ok((*kind, impact_of(Law::Viscous(kind), elastic::POWER)?)));
    let elastics = elastics.collect::<Result<Vec<_>, Failure>>()?;
    let own = own.collect::<Result<Vec<_>, Failure>>()?;
    if arguments.json {
        let normal = laws.iter().map(|law| told(*law, &arguments.restitution));
        let with_impact = |(kind, impact): &(&Kind, Impact)| told_kind(kind, Some(impact));
        let friction = frictions.iter().map(|kind| told_kind(kind, None));
        let all = json!({
            "normal": normal.collect::<Vec<_>>(),
            "elastic": elastics.iter().map(with_impact).collect::<Vec<_>>(),
            "own_damping": own.iter().map(with_impact).collect::<Vec<_>>(),
            "friction": friction.collect::<Vec<_>>(),
        });
        return super::print_json(format_args!("{all:#}\n"));
    }
    if arguments.name.is_none() {
        return super::print(menu(&laws, &elastics, &own, &frictions, &arguments.restitution));
    }
    // a normal and a friction law may share their author's name
    let normal = laws.iter().map(|law| in_full(*law, &arguments.restitution));
    let all: Vec<String> = normal.chain(kinds.iter().map(|kind| kind_in_full(kind))).collect();
    super::print(all.join("\n"))
}

/// What the bench's impact does with a law.
fn impact_of(law: Law, elastic: &'static Kind) -> Result<Impact, Failure> {
    let normal = impact::normal_law(law, elastic, &BENCH)?;
    Ok(Impact::of(&normal, BENCH.mass, BENCH.speed))
}

/// An impact with a damping weight, over what the elastic one with the same stiffness, mass and speed
/// does.
fn relative(damping_weight: f64) -> Impact {
    let law = |a: f64| NormalLaw::new(Elastic::Power(Power::with(1.0, EXPONENT)), a);
    let [impact, elastic] = [damping_weight, 0.0].map(|a| Impact::of(&law(a), 1.0, 1.0));
    Impact {
        rebound: impact.rebound,
        depth: impact.depth / elastic.depth,
        force: impact.force / elastic.force,
        duration: impact.duration / elastic.duration,
    }
}

fn told(law: Damping, restitutions: &[f64]) -> Value {
    let about = law.about();
    let impact = |e: &f64| {
        let weight: f64 = law.weight(*e);
        let Impact { rebound, depth, duration, .. } = relative(weight);
        json!({
            "nominal": e,
            "damping_weight": weight,
            "achieved": rebound,
            "depth_over_elastic": depth,
            "duration_over_elastic": duration,
        })
    };
    json!({
        "law": about.word,
        "formula": about.formula,
        "source": about.source,
        "valid": about.valid,
        "takes_restitution": about.restitution,
        "impacts": restitutions.iter().map(impact).collect::<Vec<_>>(),
    })
}

fn told_kind(kind: &Kind, impact: Option<&Impact>) -> Value {
    let keys = kind
        .keys
        .iter()
        .map(|key| json!({ "key": key.name, "unit": key.unit, "about": key.about }));
    let mut told = json!({
        "law": kind.word,
        "title": kind.title,
        "source": kind.source,
        "keys": keys.collect::<Vec<_>>(),
        "example": kind.example,
    });
    if let Some(Impact { rebound, depth, force, duration }) = impact {
        told["impact"] = json!({
            "mass": BENCH.mass,
            "speed": BENCH.speed,
            "rebound": rebound,
            "depth": depth,
            "force": force,
            "duration": duration,
        });
    }
    told
}

/// One law that has keys, with all that it says of itself.
fn kind_in_full(kind: &Kind) -> String {
    let heads = ["key", "unit", "meaning", "if left out"].map(str::to_owned).to_vec();
    let row = |key: &crate::parameter::Key| {
        let otherwise = match key.otherwise {
            Otherwise::Required => "an error",
            Otherwise::Default(value) => value,
            Otherwise::Absent => "",
        };
        [key.name, key.unit, key.about, otherwise].map(str::to_owned).to_vec()
    };
    let rows = kind.keys.iter().map(row).collect();
    let source = if kind.source.is_empty() { String::new() } else { format!("{}\n", kind.source) };
    let (word, title, table) = (kind.word, kind.title, table(heads, rows, 4));
    format!("{word}: {title}\n{source}\n{table}\n\n{}\n", kind.example)
}

/// Laws with what the bench's impact does with each.
fn impacts(heads: [&str; 2], laws: &[(&Kind, Impact)], rebounds: bool) -> String {
    let mut heads = heads.map(str::to_owned).to_vec();
    heads.extend(rebounds.then(|| "rebound".to_owned()));
    heads.extend(["depth (m)", "force (N)", "duration (s)"].map(str::to_owned));
    let row = |(kind, impact): &(&Kind, Impact)| {
        let mut row = vec![kind.word.to_owned(), kind.title.to_owned()];
        row.extend(rebounds.then(|| format!("{:.6}", impact.rebound)));
        let numbers = [impact.depth, impact.force, impact.duration];
        row.extend(numbers.map(|number| format!("{number:.3e}")));
        row
    };
    table(heads, laws.iter().map(row).collect(), 2).to_string()
}

/// The laws in tables: the rebound of each at each restitution, what others do, and the friction laws.
fn menu(
    laws: &[Damping],
    elastics: &[(&Kind, Impact)],
    own: &[(&Kind, Impact)],
    frictions: &[&Kind],
    restitutions: &[f64],
) -> String {
    let mut heads = vec!["law".to_owned(), "damping weight".to_owned()];
    heads.extend(restitutions.iter().map(|e| format!("e = {e}")));
    let row = |law: &Damping| {
        let about = law.about();
        let mut row = vec![about.word.to_owned(), about.formula.to_owned()];
        let achieved = |e: &f64| format!("{:.6}", crate::contact::rebound(law.weight(*e)));
        row.extend(restitutions.iter().map(achieved));
        row
    };
    let rows = laws.iter().map(row).collect();
    let friction_heads = vec!["law".to_owned(), "friction".to_owned()];
    let friction_rows =
        frictions.iter().map(|kind| vec![kind.word.to_owned(), kind.title.to_owned()]);
    let frictions = table(friction_heads, friction_rows.collect(), 2);
    let elastics = impacts(["elastic", "elastic force"], elastics, false);
    let own = impacts(["law", "normal force"], own, true);
    let (mass, speed) = (BENCH.mass, BENCH.speed);
    format!(
        "Normal force F = F_e(δ) [1 + a δ̇/δ̇⁽⁻⁾]: what one impact really rebounds at, over its speed, for a\n\
         nominal restitution e, whatever elastic law, mass and speed\n\n{}\n\nElastic laws F_e, any with any of \
         these: an elastic impact of {mass} kg at {speed} m/s, steel, 9.5 mm in\n10 mm, 15 mm long\n\n{elastics}\n\n\
         Laws with a damping of their own, as their examples have it: the same impact\n\n{own}\n\nFriction, any \
         with any normal force\n\n{frictions}\n\nfreeplay laws NAME shows one in full; freeplay impact holds \
         runs against these numbers\n",
        table(heads, rows, 2)
    )
}

/// One law with all that it says of itself.
fn in_full(law: Damping, restitutions: &[f64]) -> String {
    let about = law.about();
    let heads = ["e", "a", "rebound", "depth", "duration", "pulls where the rate is below"];
    let row = |e: &f64| {
        let weight: f64 = law.weight(*e);
        let impact = relative(weight);
        let pulls = match weight > 0.0 {
            true => format!("{:.4} δ̇⁽⁻⁾", -1.0 / weight),
            false => "never".into(),
        };
        let numbers = [weight, impact.rebound, impact.depth, impact.duration];
        let mut row = vec![e.to_string()];
        row.extend(numbers.map(|number| format!("{number:.6}")));
        row.push(pulls);
        row
    };
    let rows = restitutions.iter().map(row).collect();
    format!(
        "{}: F = K δⁿ [1 + a δ̇/δ̇⁽⁻⁾], {}\n{}\n{}\n\nOne impact, n = 1.5; depth and duration over those of \
         an elastic one with the same K, mass and speed:\n\n{}\n",
        about.word,
        about.formula,
        about.valid,
        about.source,
        table(heads.map(str::to_owned).to_vec(), rows, 1)
    )
}
