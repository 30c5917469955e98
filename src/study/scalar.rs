//! Numbers of a run by their paths in `freeplay summary --json`.

use crate::case::Case;
use crate::certify::{Digits, Horizon};
use crate::mechanism::{EnergyObservation, Mechanism};
use crate::model::did_you_mean;
use crate::post::{self, InMemory, RunExtremes, Summary, Wanted};
use crate::run::{Contact, Extremum, Revolution};
use serde_json::Value;

/// A number of a summary.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scalar {
    /// Its path, which is the name of its column.
    pub name: String,
    /// Its unit; `1` where there is none.
    pub unit: String,
    steps: Vec<String>,
}

/// What a summary of a case says at most, with some number in every place.
pub(super) fn skeleton(case: &Case, mechanism: &Mechanism<f64>) -> Result<Value, post::Error> {
    let (measures, model) = (mechanism.measures(), mechanism.model());
    let end = mechanism.revolution().unwrap_or(1.0);
    let extremum = Extremum { value: 1.0, time: 0.5 * end };
    let revolution = Revolution {
        begin: 0.0,
        end,
        measures,
        largest: vec![extremum; measures.len()],
        smallest: vec![extremum; measures.signed()],
    };
    let contact = |clearance| Contact {
        clearance,
        begin: 0.25 * end,
        end: f64::NAN,
        impact_rate: 1.0,
        peak_penetration: 1.0,
        peak_penetration_time: 0.5 * end,
        peak_force: 1.0,
        peak_time: 0.5 * end,
        dissipated: 0.0,
    };
    let contacts: Vec<Contact> = (0..model.clearances().len()).map(contact).collect();
    let energy = EnergyObservation::default();
    let horizon = Horizon {
        state: end,
        forces: end,
        doubles: Some(end),
        at_end: Some(Digits { state: 1.0, forces: 1.0 }),
        end,
        certified: false,
        stopped: None,
    };
    let run = InMemory {
        case,
        mechanism,
        begin: 0.0,
        end,
        contacts: &contacts,
        revolutions: &[revolution],
        energies: &[(0.0, energy), (end, energy)],
        horizon: Some(&horizon),
    };
    let names = model.names().clone();
    let revolutions = std::slice::from_ref(&run.revolutions[0]);
    let reference =
        RunExtremes::of_revolutions(&names, (revolutions, 0.0), 1e-9, None, Wanted::All);
    Ok(Summary::of_run(&run, Some(reference), Wanted::All)?.to_json())
}

impl Scalar {
    /// The number that a path leads to in a summary like this one.
    ///
    /// # Errors
    /// What is wrong with the path.
    pub fn of(path: &str, skeleton: &Value) -> Result<Scalar, String> {
        let mut steps = Vec::new();
        let mut here = follow(skeleton, path, &mut steps)?;
        if let Some(value) = here.get("value") {
            steps.push("value".to_owned());
            here = value;
        }
        match here {
            Value::Number(_) | Value::Bool(_) | Value::Null => {}
            Value::String(_) => return Err(format!("{path:?} is a word, not a number")),
            Value::Array(_) => return Err(format!("{path:?} is a list, not a number")),
            Value::Object(below) => {
                let keys: Vec<&str> = below.keys().map(String::as_str).collect();
                return Err(format!("{path:?} is no number; below it are {}", keys.join(", ")));
            }
        }
        let unit = unit(skeleton, &steps);
        Ok(Scalar { name: steps.join("."), unit, steps })
    }

    /// The same where it must be a number of each revolution, too.
    ///
    /// # Errors
    /// What is wrong with the path.
    pub fn of_each_revolution(path: &str, skeleton: &Value) -> Result<Scalar, String> {
        let scalar = Scalar::of(path, skeleton)?;
        match scalar.in_revolution(skeleton, 0) {
            Some(_) => Ok(scalar),
            None => Err(format!("{path:?} is not known of each revolution")),
        }
    }

    /// Its value in a summary; NaN where there is none.
    pub fn value(&self, summary: &Value) -> f64 {
        let found = self.steps.iter().try_fold(summary, |here, step| here.get(step));
        found.map_or(f64::NAN, number)
    }

    /// Its value in revolution `k` of a summary; NaN where there is none.
    pub fn value_in_revolution(&self, summary: &Value, k: usize) -> f64 {
        self.in_revolution(summary, k).map_or(f64::NAN, number)
    }

    fn in_revolution<'v>(&self, summary: &'v Value, k: usize) -> Option<&'v Value> {
        let (part, below) = self.steps.split_at_checked(2)?;
        let part = part.iter().try_fold(summary, |here, step| here.get(step))?;
        let revolution = part.get("revolutions")?.get(k)?;
        below.iter().try_fold(revolution, |here, step| here.get(step))
    }

    /// The quantity whose extremes it tells of, if it does.
    pub fn quantity(&self) -> Option<&String> {
        self.steps.get(1).filter(|_| self.steps[0] == "columns")
    }

    /// Whether it holds the run against the ideal mechanism.
    pub fn needs_reference(&self) -> bool {
        self.steps.iter().any(|step| step == "ratio" || step == "reference")
    }

    /// Whether it depends on when samples are taken.
    pub fn needs_samples(&self) -> bool {
        let first = self.steps[0].as_str();
        let largest = self.steps.get(1).is_some_and(|step| step.starts_with("largest"));
        first == "samples" || first.starts_with("contacts_with") || (first == "energy" && largest)
    }

    /// Whether it tells how far the run is true.
    pub fn needs_horizon(&self) -> bool {
        self.steps[0] == "horizon" || self.steps.iter().any(|step| step == "within_horizon")
    }
}

fn number(value: &Value) -> f64 {
    match value {
        Value::Bool(flag) => f64::from(u8::from(*flag)),
        value => value.as_f64().unwrap_or(f64::NAN),
    }
}

/// Goes down a path of keys with dots between; keys may have dots in them.
fn follow<'v>(from: &'v Value, path: &str, steps: &mut Vec<String>) -> Result<&'v Value, String> {
    let Value::Object(below) = from else {
        return Err(format!("there is nothing below {:?}", steps.join(".")));
    };
    let mut nearest = None;
    for (key, value) in below {
        let Some(rest) = path.strip_prefix(key.as_str()) else { continue };
        let rest = match (rest, rest.strip_prefix('.')) {
            ("", _) => None,
            (_, Some(rest)) => Some(rest),
            _ => continue,
        };
        steps.push(key.clone());
        match rest.map_or(Ok(value), |rest| follow(value, rest, steps)) {
            Ok(found) => return Ok(found),
            Err(why) => nearest = Some(why),
        }
        steps.pop();
    }
    let above = steps.join(".");
    let above = if above.is_empty() { "a summary".to_owned() } else { above };
    let known: Vec<&str> = below.keys().map(String::as_str).collect();
    Err(nearest.unwrap_or_else(|| {
        let hint = did_you_mean(path, known.iter().copied());
        format!("{above} has no {path:?}{hint}; it has {}", known.join(", "))
    }))
}

/// The unit of a number: what the summary says of its name, else of what it belongs to.
fn unit(summary: &Value, steps: &[String]) -> String {
    let of_name =
        |name: &String| summary["units"][name].as_str().filter(|unit| *unit != "unit of the value");
    if let Some(unit) = steps.iter().rev().find_map(of_name) {
        return unit.to_owned();
    }
    let counts = ["contacts", "count", "within_horizon", "open", "certified"];
    if steps.last().is_some_and(|last| counts.contains(&last.as_str())) || steps.len() == 1 {
        return "1".to_owned();
    }
    let mut unit = "1";
    let mut here = summary;
    for step in steps {
        unit = here["unit"].as_str().unwrap_or(unit);
        here = &here[step];
    }
    unit.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn summary() -> Value {
        json!({
            "units": { "time": "s", "ratio": "1", "uncertainty": "unit of the value" },
            "end": 1.0,
            "columns": { "joint_force.A": {
                "largest": { "value": 3.0, "time": 0.5, "basis": "peak", "uncertainty": 1e-3 },
                "ratio": { "largest": 1.5 },
                "unit": "N",
                "revolutions": [{ "largest": { "value": 2.0, "time": 0.25 } }],
            }},
            "clearances": { "A": { "contacts": 4, "share_in_contact": { "value": 0.5, "unit": "1" },
                                   "largest_penetration": { "value": 1e-6, "unit": "m", "time": 0.1 },
                                   "revolutions": [{ "contacts": 2 }] } },
        })
    }

    #[test]
    fn paths_lead_through_names_with_dots_and_find_their_units() {
        for (path, name, unit, value) in [
            ("columns.joint_force.A.largest", "columns.joint_force.A.largest.value", "N", 3.0),
            ("columns.joint_force.A.largest.time", "columns.joint_force.A.largest.time", "s", 0.5),
            (
                "columns.joint_force.A.largest.uncertainty",
                "columns.joint_force.A.largest.uncertainty",
                "N",
                1e-3,
            ),
            (
                "columns.joint_force.A.ratio.largest",
                "columns.joint_force.A.ratio.largest",
                "1",
                1.5,
            ),
            ("clearances.A.contacts", "clearances.A.contacts", "1", 4.0),
            (
                "clearances.A.largest_penetration",
                "clearances.A.largest_penetration.value",
                "m",
                1e-6,
            ),
            ("end", "end", "1", 1.0),
        ] {
            let scalar = Scalar::of(path, &summary()).unwrap();
            assert_eq!((scalar.name.as_str(), scalar.value(&summary())), (name, value));
            assert_eq!(scalar.unit, if path == "end" { "1" } else { unit }, "{path}");
        }
    }

    #[test]
    fn the_same_path_leads_to_the_number_of_a_revolution() {
        for (path, value) in
            [("columns.joint_force.A.largest", 2.0), ("clearances.A.contacts", 2.0)]
        {
            let scalar = Scalar::of_each_revolution(path, &summary()).unwrap();
            assert_eq!(scalar.value_in_revolution(&summary(), 0), value);
            assert!(scalar.value_in_revolution(&summary(), 1).is_nan());
        }
        let why = Scalar::of_each_revolution("clearances.A.largest_penetration", &summary());
        assert!(why.unwrap_err().contains("not known of each revolution"));
    }

    #[test]
    fn a_path_that_leads_nowhere_is_told_with_what_there_is() {
        for (path, part) in [
            ("columns.joint_force.B.largest", "columns has no \"joint_force.B.largest\""),
            ("columns.joint_force.A.larges", "did you mean"),
            ("columns.joint_force.A", "below it are largest, ratio"),
            ("columns.joint_force.A.largest.basis", "is a word"),
            ("clearances.A.revolutions", "is a list"),
            ("end.value", "nothing below \"end\""),
        ] {
            let why = Scalar::of(path, &summary()).unwrap_err();
            assert!(why.contains(part), "{path}: {why}");
        }
    }
}
