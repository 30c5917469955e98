//! A comparison as JSON. Times in s, everything in SI; what is no number is `null`.

use super::comparison::{Comparison, Identity, MappedName, Side};
use super::event::{ContactPair, EventComparison, EventRow, Pair};
use super::mapping::How;
use super::quantity::Quantity;
use super::reference::Way;
use super::series::QuantityGrades;
use super::shortfall::{Requirement, Shortfall};
use super::told::HELD;
use crate::digits::{Grade, Hold};
use serde_json::{Value, json};

impl Comparison {
    /// The whole comparison; `required` is what was asked for, with where it falls short.
    pub fn json(&self, required: &Requirement) -> Value {
        let series = &self.series;
        let (way, checked) = match self.way {
            Way::Stored => ("stored", None),
            Way::RunAgain { checked } => ("run_again", Some(checked)),
            Way::CommonTimes => ("common_times", None),
        };
        json!({
            "theirs": side(&self.theirs),
            "reference": side(&self.reference),
            "certified_digits": self.certified_digits(),
            "identical": match self.identity {
                Identity::None => "no",
                Identity::Compared => "compared",
                Identity::Everything => "everything",
            },
            "samples": series.times.len(),
            "samples_left_out": self.left_out,
            "until": self.until,
            "reference_at": way,
            "reference_samples_reproduced": checked,
            "gate": self.graded(&series.gate),
            "quantities": series.quantities.iter().map(|q| self.quantity(q)).collect::<Vec<_>>(),
            "times": series.times,
            "events": self.events.as_ref().map(|events| self.events(events)),
            "notes": self.notes,
            "coverage": json!({
                "time": self.coverage.time,
                "gap": self.coverage.gap,
                "columns": self.coverage.columns,
                "of_columns": self.coverage.of_columns,
            }),
            "requirement": required.is_some().then(|| {
                let shortfall = self.shortfall(required);
                json!({
                    "digits": required.digits,
                    "times": required.times,
                    "columns": required.columns,
                    "met": shortfall.is_none(),
                    "shortfall": shortfall.as_ref().map(Shortfall::to_string),
                })
            }),
        })
    }

    /// A series of grades: the worst, how long digits hold, and every sample.
    fn graded(&self, grades: &[Grade]) -> Value {
        let times = &self.series.times;
        let worst = (0..grades.len())
            .min_by(|a, b| grades[*a].digits.total_cmp(&grades[*b].digits))
            .map(|row| {
                json!({
                    "digits": grades[row].digits,
                    "at_least": grades[row].at_least,
                    "time": times[row],
                    "column": self.column_name(grades[row].column),
                })
            });
        let holds = HELD.map(|digits| {
            let hold = Hold::new(digits, times, grades);
            json!({
                "digits": digits,
                "until": hold.until,
                "first_below": hold.first_below.map(|row| times[row]),
                "column": hold.first_below.map(|row| self.column_name(grades[row].column)),
            })
        });
        json!({
            "fewest": worst,
            "holds": holds,
            "digits": grades.iter().map(|grade| grade.digits).collect::<Vec<_>>(),
        })
    }

    fn quantity(&self, graded: &QuantityGrades) -> Value {
        let mut value = self.graded(&graded.grades);
        let columns: Vec<Value> = graded
            .columns
            .iter()
            .map(|index| {
                let scale = self.scales.of_column(&self.columns[*index]);
                json!({ "name": self.column_name(*index), "scale": scale })
            })
            .collect();
        value["name"] = json!(graded.quantity.name());
        value["unit"] = json!(Quantity::unit(graded.quantity));
        value["in_gate"] = json!(graded.in_gate);
        value["columns"] = json!(columns);
        value
    }

    fn events(&self, events: &EventComparison) -> Value {
        let name = |clearance: usize| &self.parts.0.clearances[clearance];
        let pair = |pair: &Pair| {
            json!({
                "time": pair.time,
                "later": pair.later(),
                "faster": pair.faster,
            })
        };
        let row = |row: &EventRow| {
            json!({
                "clearance": row.owner.name(&self.parts.0),
                "kind": row.kind,
                "in_both": row.pairs.iter().map(pair).collect::<Vec<_>>(),
                "only_theirs": row.only_theirs,
                "only_reference": row.only_reference,
            })
        };
        let contact = |contact: &ContactPair| {
            json!({
                "clearance": name(contact.clearance),
                "begin": contact.begin,
                "ends_later": contact.ends_later,
                "peak_force_ratio_less_one": contact.peak_force,
                "peak_later": contact.peak_later,
            })
        };
        let first = events.first_unmatched().map(|first| {
            json!({
                "time": first.time,
                "clearance": first.owner.name(&self.parts.0),
                "kind": first.kind,
                "only_in": if first.in_theirs { "theirs" } else { "reference" },
            })
        });
        json!({
            "first_unmatched": first,
            "rows": events.rows.iter().map(row).collect::<Vec<_>>(),
            "contacts": events.contacts.iter().map(contact).collect::<Vec<_>>(),
        })
    }
}

fn side(side: &Side) -> Value {
    let mapped = |MappedName { theirs, ours, how, unit }: &MappedName| {
        let how = match how {
            How::Given => "given",
            How::SameName => "same_name",
            How::Guessed => "guessed",
        };
        json!({ "theirs": theirs, "ours": ours, "how": how, "unit": unit })
    };
    json!({
        "path": side.path.display().to_string(),
        "description": side.description,
        "span": side.span,
        "mapping": side.mapping.iter().map(mapped).collect::<Vec<_>>(),
        "not_compared": side.unused,
        "horizon": side.horizon.as_ref().map(|horizon| json!({
            "state": horizon.state,
            "forces": horizon.forces,
            "end": horizon.end,
            "certified": horizon.certified,
        })),
    })
}
