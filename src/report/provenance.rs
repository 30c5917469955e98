//! What was run, and how: the tables at the end of the page.

use super::html::escape;
use super::number::{exactly, milliseconds, significant};
use super::run::Run;
use super::tables::Matrix;
use crate::contact::elastic::ElasticLaw;
use crate::model::Model;
use crate::record::Attribute;

/// Attributes told as they are, with the name they get on the page.
const TOLD: [(&str, &str); 13] = [
    ("engine", "engine"),
    ("relative_tolerance", "relative tolerance"),
    ("absolute_tolerance", "absolute tolerance"),
    ("initial_step", "initial step (s)"),
    ("max_step", "longest step (s)"),
    ("norm", "norm of the error"),
    ("solver_steps", "steps taken"),
    ("source", "made by"),
    ("sundials_version", "SUNDIALS"),
    ("hdf5_version", "HDF5"),
    ("started_utc", "started"),
    ("finished_utc", "finished"),
    ("case_sha256", "SHA-256 of the case"),
];

/// What was run: a column a run.
pub(super) fn what_was_run(runs: &[Run<'_>], samples_in_page: &[usize]) -> String {
    let mut table = Matrix::new(runs.iter().map(|run| run.label.as_str()));
    let text = |name| move |run: &Run<'_>| escape(run.file.text(name).unwrap_or("–"));
    table.row("title", runs.iter().map(text("title")));
    let file = |run: &Run<'_>| run.file.path().file_name().map(|n| n.to_string_lossy().into());
    table.row("file", runs.iter().map(|run| escape(&file(run).unwrap_or_else(String::new))));
    let outcome = |run: &Run<'_>| match run.failure() {
        None => "complete".to_owned(),
        Some(failure) => format!("<strong class=\"failure\">{}</strong>", escape(&failure)),
    };
    table.row("outcome", runs.iter().map(outcome));
    table.row("simulated time (ms)", runs.iter().map(span));
    let samples = runs.iter().zip(samples_in_page).map(|(run, shown)| samples(run, *shown));
    table.row("samples", samples);
    let clearances = runs.iter().map(clearances);
    table.row("clearances", clearances);
    table.row("decisions", runs.iter().map(rulings));
    for (attribute, name) in TOLD {
        if runs.iter().any(|run| run.file.attribute(attribute).is_some()) {
            table.row(name, runs.iter().map(|run| told(run, attribute)));
        }
    }
    table.finish("provenance")
}

/// A paragraph for each run that did not come to its end.
pub(super) fn failures(runs: &[Run<'_>]) -> String {
    let failed = runs.iter().filter_map(|run| Some((run, run.failure()?)));
    let paragraph = |(run, failure): (&Run<'_>, String)| {
        let until = match run.times.last() {
            Some(last) => format!("Shown is what was simulated until {} ms.", milliseconds(*last)),
            None => "Nothing was simulated.".to_owned(),
        };
        let (label, failure) = (escape(&run.label), escape(&failure));
        format!("<p class=\"failure\">{label} did not come to its end: {failure}. {until}</p>")
    };
    failed.map(paragraph).collect()
}

fn told(run: &Run<'_>, attribute: &str) -> String {
    match run.file.attribute(attribute) {
        None => "–".to_owned(),
        Some(Attribute::Number(value)) => exactly(*value),
        Some(other) if attribute == "case_sha256" => {
            format!("<code class=\"long\">{}</code>", escape(&other.to_string()))
        }
        Some(other) => escape(&other.to_string()),
    }
}

fn span(run: &Run<'_>) -> String {
    match run.times.first().zip(run.times.last()) {
        Some((first, last)) => format!("{} to {}", milliseconds(*first), milliseconds(*last)),
        None => "no samples".to_owned(),
    }
}

fn samples(run: &Run<'_>, shown: usize) -> String {
    let all = run.times.len();
    if shown == all {
        return all.to_string();
    }
    format!("{all}, of which the page draws {shown}: the extremes of each stretch, true rows all")
}

/// Sizes and laws of the clearances, with the stiffness that the case comes to.
fn clearances(run: &Run<'_>) -> String {
    let Some(case) = &run.case else {
        return escape(&run.file.clearances().join(", "));
    };
    let Ok(model) = Model::<f64>::new(&case.description) else {
        return escape(&run.file.clearances().join(", "));
    };
    let clearances = model.names().clearances.iter().zip(model.clearances());
    let described = clearances.map(|(name, clearance)| {
        let law = &clearance.normal;
        let friction = if clearance.friction.is_some() { "with" } else { "no" };
        let word = case.description.clearance(name).map(|c| c.normal.elastic.kind().word);
        let damping = match law.damping_weight() {
            Some(a) => format!("damping weight {}", significant(a, 4)),
            None => {
                let described = case.description.clearance(name);
                format!("law {}", described.map(|c| c.normal.law.word()).unwrap_or_default())
            }
        };
        let elastic = match law.elastic().power() {
            Some((k, n)) => format!("K = {} N/m<sup>{n}</sup>", significant(k, 6)),
            None => format!("elastic law {}", word.unwrap_or_default()),
        };
        let description = format!(
            "c = {} mm in a bearing of {} mm, {elastic}, {damping}, {friction} friction",
            significant(clearance.radial * 1e3, 4),
            significant(clearance.bearing_radius * 1e3, 4),
        );
        (name.as_str(), description)
    });
    let lines = grouped(described);
    if lines.is_empty() { "none: ideal joints".to_owned() } else { lines.join("<br>") }
}

/// What was decided for each clearance where laws are silent, and how often each was applied.
fn rulings(run: &Run<'_>) -> String {
    let all: Vec<(&str, String)> = run
        .file
        .attributes()
        .iter()
        .filter_map(|(name, value)| Some((name.strip_prefix("ruling_")?, value.to_string())))
        .collect();
    let words = |name: &str| escape(&name.replace('_', " "));
    let of_clearance = |clearance: &String| {
        let own = all.iter().filter_map(|(name, value)| {
            let ruling = name.strip_suffix(clearance.as_str())?.strip_suffix('_')?;
            Some(format!("{} = {}", words(ruling), escape(value)))
        });
        own.collect::<Vec<_>>().join(", ")
    };
    let clearances = run.file.clearances().iter();
    let mut lines = grouped(clearances.map(|name| (name.as_str(), of_clearance(name))));
    let counts = all.iter().filter_map(|(name, value)| {
        Some(format!("{} {} times", words(name.strip_suffix("_count")?), escape(value)))
    });
    let counts: Vec<String> = counts.collect();
    if !counts.is_empty() && !run.file.clearances().is_empty() {
        lines.push(format!("applied: {}", counts.join(", ")));
    }
    if lines.is_empty() { "–".to_owned() } else { lines.join("<br>") }
}

/// Descriptions (HTML), each with the names that it holds for.
fn grouped<'n>(described: impl Iterator<Item = (&'n str, String)>) -> Vec<String> {
    let mut groups: Vec<(Vec<String>, String)> = Vec::new();
    for (name, description) in described {
        match groups.iter_mut().find(|(_, known)| *known == description) {
            Some((names, _)) => names.push(escape(name)),
            None => groups.push((vec![escape(name)], description)),
        }
    }
    let line =
        |(names, text): (Vec<String>, String)| format!("<b>{}</b>: {text}", names.join(", "));
    groups.into_iter().map(line).collect()
}

/// Every attribute and the case's text, folded away.
pub(super) fn everything(runs: &[Run<'_>]) -> String {
    runs.iter().map(everything_of).collect()
}

fn everything_of(run: &Run<'_>) -> String {
    let hidden = ["case_toml", "Conventions", "checkpoint"];
    let attributes = run.file.attributes().iter();
    let rows: String = attributes
        .filter(|(name, _)| !hidden.contains(&name.as_str()))
        .map(|(name, value)| {
            let value = match value {
                Attribute::Number(number) => exactly(*number),
                other => escape(&other.to_string()),
            };
            format!("<tr><th scope=\"row\"><code>{}</code></th><td>{value}</td></tr>", escape(name))
        })
        .collect();
    format!(
        "<details><summary>{label}: the case file as run, and every attribute of the result \
         file</summary><pre tabindex=\"0\">{case}</pre><div class=\"scroll\">\
         <table class=\"attributes\"><tbody>{rows}</tbody></table></div></details>",
        label = escape(&run.label),
        case = escape(run.file.text("case_toml").unwrap_or_default()),
    )
}
