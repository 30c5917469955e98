//! `[start] from = "run.h5"`: where another run of the same mechanism stood takes the place of the
//! file's name, so that the text of a case as run needs no file beside it.
//!
//! Written are the bodies' coordinates and velocities, all of them fixed, the time that courses of
//! time go on from (`clock`), of each contact that is open the rate at which it began
//! (`[[start.contact]]`), and what its friction and loads remember (`[[start.memory]]`). A result file has
//! all of that at each of its samples.

use super::table_reader::{Findings, TableReader};
use super::{files, mechanism};
use crate::mechanism::Observation;
use crate::model::{Complaint, Description, KeyPath, Model, members};
use crate::record::ResultFile;
use std::error::Error;
use std::path::{Path, PathBuf};
use toml_edit::{Array, DocumentMut, InlineTable, Item, TableLike, Value};

/// Puts where another run stood into a document that names its file; `path` is that of the case.
/// Gives the file, if there is one, or what is wrong with it.
pub(super) fn take_in(
    path: &Path,
    document: &mut DocumentMut,
) -> Result<Option<PathBuf>, Vec<Complaint>> {
    let Some(start) = document.get("start").and_then(Item::as_table_like) else { return Ok(None) };
    let key = KeyPath::new(["start"]);
    let complain = |at: &str, message: String| vec![Complaint { key: key.key(at), message }];
    // a table of that name is the start of a body
    let Some(from) = start.get("from").filter(|from| !from.is_table_like()) else {
        return match start.get("at").filter(|at| !at.is_table_like()) {
            None => Ok(None),
            Some(_) => Err(complain(
                "at",
                "is a time of the run that `from` names: give both, here or by --set".into(),
            )),
        };
    };
    let Some(name) = from.as_str().map(str::to_owned) else {
        return Err(complain("from", "must be a string, the name of a result file".into()));
    };
    let at = match start.get("at").map(|at| at.as_float().or(at.as_integer().map(|at| at as f64))) {
        None => None,
        Some(Some(at)) => Some(at),
        Some(None) => return Err(complain("at", "must be a number (s)".into())),
    };
    let mut others = start.iter().filter(|(other, _)| !["from", "at"].contains(other));
    let other = others.find(|(_, item)| !is_rough(item)).map(|(other, _)| other.to_owned());
    drop(others);
    if let Some(other) = other {
        let rule = "is given too: `from` says how everything starts";
        return Err(complain(&other, rule.into()));
    }
    let file = path.parent().unwrap_or(Path::new("")).join(&name);
    let wrong = |message: String| complain("from", message);
    let result = ResultFile::open(&file).map_err(|error| {
        let cause = error.source().map_or(String::new(), |cause| format!(": {cause}"));
        wrong(format!("{error}{cause}; it is looked for beside the case"))
    })?;
    if !result.is_complete() {
        let status = result.text("run_status").unwrap_or("of unknown status");
        return Err(wrong(format!("{name:?} is of a run that is not complete, but {status}")));
    }
    same_names(document, &result).map_err(|what| wrong(format!("{name:?} {what}")))?;
    let row = row_at(&result, at).map_err(|(key, what)| complain(key, what))?;
    let read = || -> Result<_, crate::record::Error> {
        Ok((result.observations(row..row + 1)?, result.contacts()?))
    };
    let (samples, contacts) = read().map_err(|error| wrong(error.to_string()))?;
    let Some(sample) = samples.into_iter().next() else {
        return Err(wrong(format!("{name:?} has no samples")));
    };
    let mut open = Vec::new();
    for (k, clearance) in result.clearances().iter().enumerate() {
        if !sample.clearances[k].in_contact {
            continue;
        }
        let lasts = |end: f64| end.is_nan() || end >= sample.time;
        let contact = contacts.iter().rev();
        let contact = contact
            .filter(|contact| contact.clearance == k)
            .find(|contact| contact.begin <= sample.time && lasts(contact.end));
        match contact {
            Some(contact) => open.push((clearance.clone(), contact.impact_rate)),
            None => {
                let what = "does not say how fast the contact began that is open there";
                return Err(wrong(format!("{name:?} {what}, in joint {clearance:?}")));
            }
        }
    }
    let clock = sample.time + clock_of(&result);
    let comment = format!("  # s; from {name} at its {:?} s", sample.time);
    write(document, &result, &sample, &open, (clock, comment))
        .ok_or_else(|| wrong(format!("{name:?} holds what is no number at {:?} s", sample.time)))?;
    let mut memories = Array::new();
    for memory in remembered(document, &open) {
        let place = result.memories().iter().position(|known| *known == memory);
        let value = place.and_then(|place| number(sample.memories[place]));
        let Some(value) = value else {
            return Err(wrong(format!(
                "{name:?} does not hold {memory:?}, which is remembered there"
            )));
        };
        let mut table = InlineTable::new();
        table.insert("of", memory.as_str().into());
        table.insert("value", value);
        memories.push(table);
    }
    let start = document.get_mut("start").and_then(Item::as_table_like_mut);
    if let Some(start) = start.filter(|_| !memories.is_empty()) {
        start.insert("memory", Item::Value(Value::Array(memories)));
    }
    Ok(Some(file))
}

/// A number as case files have it; nothing where it is none.
fn number(x: f64) -> Option<Value> {
    files::as_number(&format!("{x:?}")).filter(|_| x.is_finite())
}

/// Whether an entry of `[start]` is the rough pose of a body, which chooses a branch and no more.
fn is_rough(item: &Item) -> bool {
    let fixed = |body: &dyn TableLike| body.get("fixed").and_then(Item::as_bool) == Some(true);
    item.as_table_like().is_some_and(|body| !fixed(body))
}

/// Whether the file is of a mechanism with the same parts, whatever their order; in words if not.
fn same_names(document: &DocumentMut, result: &ResultFile) -> Result<(), String> {
    let names = |list: &str| -> Vec<String> {
        let parts = document.get(list).and_then(Item::as_table_like);
        parts.map_or(Vec::new(), |parts| parts.iter().map(|(name, _)| name.to_owned()).collect())
    };
    let joints = document.get("joints").and_then(Item::as_table_like);
    let loose = joints.into_iter().flat_map(|joints| joints.iter()).flat_map(|(name, joint)| {
        let joint = joint.as_table_like();
        let kind = joint.and_then(|joint| joint.get("kind")?.as_str()).unwrap_or_default();
        let loose = joint.is_some_and(|joint| joint.contains_key("clearance"));
        if loose { members(name, kind) } else { Vec::new() }
    });
    for (what, ours, theirs) in [
        ("body", names("bodies"), result.bodies()),
        ("joint", names("joints"), result.joints()),
        ("joint with clearance", loose.collect(), result.clearances()),
        ("drive", names("drives"), result.drives()),
    ] {
        if let Some(missing) = ours.iter().find(|name| !theirs.contains(name)) {
            return Err(format!("is of another mechanism: it has no {what} {missing:?}"));
        }
        if let Some(more) = theirs.iter().find(|name| !ours.contains(name)) {
            return Err(format!("is of another mechanism: it has a {what} {more:?}"));
        }
    }
    Ok(())
}

/// The row of a time (s), or the last; the key and what is wrong with it if there is none.
fn row_at(result: &ResultFile, at: Option<f64>) -> Result<usize, (&'static str, String)> {
    let times = result.times().map_err(|error| ("from", error.to_string()))?;
    let Some(last) = times.len().checked_sub(1) else {
        return Err(("from", "has no samples".to_owned()));
    };
    let Some(at) = at else { return Ok(last) };
    let near = |a: &&f64, b: &&f64| (**a - at).abs().total_cmp(&(**b - at).abs());
    match times.iter().position(|time| *time == at) {
        Some(row) => Ok(row),
        None => {
            let nearest = times.iter().min_by(near).copied().unwrap_or(f64::NAN);
            let told = format!("is no sample of that run (s), {at:?}: the nearest is {nearest:?}");
            Err(("at", told))
        }
    }
}

/// Time (s) of courses at t = 0 of the run that a file is of.
fn clock_of(result: &ResultFile) -> f64 {
    let document = result.text("case_toml").and_then(|text| text.parse::<DocumentMut>().ok());
    let clock = document.as_ref().and_then(|document| {
        let clock = document.get("start")?.as_table_like()?.get("clock")?;
        clock.as_float().or(clock.as_integer().map(|clock| clock as f64))
    });
    clock.unwrap_or(0.0)
}

/// Writes a start in place of the name of a file; nothing where a number is none.
fn write(
    document: &mut DocumentMut,
    result: &ResultFile,
    sample: &Observation,
    open: &[(String, f64)],
    (clock, comment): (f64, String),
) -> Option<()> {
    let mut bodies = Vec::new();
    for (name, body) in result.bodies().iter().zip(&sample.bodies) {
        let mut table = InlineTable::new();
        for (key, value) in [
            ("x", body.position[0]),
            ("y", body.position[1]),
            ("angle", body.angle),
            ("velocity_x", body.velocity[0]),
            ("velocity_y", body.velocity[1]),
            ("angular_velocity", body.angular_velocity),
        ] {
            table.insert(key, number(value)?);
        }
        table.insert("fixed", true.into());
        bodies.push((name, table));
    }
    let mut contacts = Array::new();
    for (joint, rate) in open {
        let mut table = InlineTable::new();
        table.insert("joint", joint.as_str().into());
        table.insert("impact_rate", number(*rate)?);
        contacts.push(table);
    }
    let mut clock = number(clock)?;
    clock.decor_mut().set_suffix(comment);
    let inline = document.get("start").is_some_and(Item::is_value);
    let start = document.get_mut("start")?.as_table_like_mut()?;
    start.remove("from");
    start.remove("at");
    if inline {
        // no room for a comment between braces
        clock.decor_mut().clear();
    }
    start.insert("clock", Item::Value(clock));
    if !contacts.is_empty() {
        start.insert("contact", Item::Value(Value::Array(contacts)));
    }
    for (name, table) in bodies {
        start.insert(name, Item::Value(Value::InlineTable(table)));
    }
    Some(())
}

/// Names of what a mechanism remembers where these contacts are open; nothing of a document that is no
/// case, which is told about later.
fn remembered(document: &DocumentMut, open: &[(String, f64)]) -> Vec<String> {
    let mut findings = Findings::default();
    let description = TableReader::root(document.as_table(), &mut findings, mechanism::description);
    // names alone are wanted, whatever the start is
    let description = Description { memories: Vec::new(), ..description };
    let Ok(model) = Model::<f64>::new(&description) else { return Vec::new() };
    let names = model.names();
    let rests = |memory: &String| {
        let owner = memory.split_once('.').map_or("", |(owner, _)| owner);
        let of_friction = !memory.ends_with(".memory");
        of_friction && !open.iter().any(|(joint, _)| joint == owner)
    };
    names.memories.iter().filter(|memory| !rests(memory)).cloned().collect()
}
