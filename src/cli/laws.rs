//! `freeplay laws [NAME]`

use super::Failure;
use crate::contact::elastic::{Elastic, Power};
use crate::contact::{Damping, Impact, NormalLaw};
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
        None => {
            let near = crate::model::did_you_mean(name, Damping::ALL.iter().map(|(word, _)| *word));
            Err(Failure::input(Wrong::Name { name: name.clone(), near }))
        }
    };
    names.iter().map(of_name).collect()
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
    let frictions: Vec<&Kind> = friction::KINDS.iter().filter(is_asked).copied().collect();
    if let (Some(name), true) = (&arguments.name, laws.is_empty() && frictions.is_empty()) {
        let words = Damping::ALL.iter().map(|(word, _)| *word);
        let words = words.chain(friction::KINDS.iter().map(|kind| kind.word));
        let near = crate::model::did_you_mean(name, words);
        return Err(Failure::input(Wrong::Name { name: name.clone(), near }));
    }
    if arguments.json {
        let normal = laws.iter().map(|law| told(*law, &arguments.restitution));
        let friction = frictions.iter().map(|kind| told_friction(kind));
        let all = json!({
            "normal": normal.collect::<Vec<_>>(),
            "friction": friction.collect::<Vec<_>>(),
        });
        return super::print_json(format_args!("{all:#}\n"));
    }
    match (&laws[..], &frictions[..]) {
        ([law], []) => super::print(in_full(*law, &arguments.restitution)),
        ([], [friction]) => super::print(friction_in_full(friction)),
        _ => super::print(menu(&laws, &frictions, &arguments.restitution)),
    }
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

fn told_friction(kind: &Kind) -> Value {
    let keys = kind
        .keys
        .iter()
        .map(|key| json!({ "key": key.name, "unit": key.unit, "about": key.about }));
    json!({
        "law": kind.word,
        "title": kind.title,
        "source": kind.source,
        "keys": keys.collect::<Vec<_>>(),
    })
}

/// One friction law with all that it says of itself.
fn friction_in_full(kind: &Kind) -> String {
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

/// The laws in tables: the rebound of each at each restitution, and the friction laws.
fn menu(laws: &[Damping], frictions: &[&Kind], restitutions: &[f64]) -> String {
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
    format!(
        "Normal force F = K δⁿ [1 + a δ̇/δ̇⁽⁻⁾]: what one impact really rebounds at, over its speed, for a\n\
         nominal restitution e, whatever stiffness, exponent, mass and speed\n\n{}\n\nFriction, any with any normal \
         force\n\n{frictions}\n\nfreeplay laws NAME shows one in full\n",
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
