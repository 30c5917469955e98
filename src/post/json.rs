//! A summary as JSON: every number with its unit, columns by the names of result files.

use super::{At, Contacts, Extreme, Extremes, Quantity, Reference, Stretch, Summary};
use crate::certify::LEAST_DIGITS;
use serde_json::{Map, Value, json};

impl Summary {
    /// Everything, for programs. Times stand in seconds, angles in radians; what is not known is
    /// `null`.
    pub fn to_json(&self) -> Value {
        let columns = self.run.quantities.iter().map(|(quantity, tally)| {
            let name = quantity.name(&self.run.names);
            (name, self.column(*quantity, &tally.total, &tally.revolutions))
        });
        let clearances =
            self.contacts.iter().map(|contacts| (contacts.joint.clone(), clearance(contacts)));
        json!({
            "file": self.path.to_string_lossy(),
            "case_name": self.case_name,
            "title": self.title,
            "run_status": self.status,
            "samples": self.samples,
            "units": {
                "time": "s", "begin": "s", "end": "s", "period": "s", "bounds": "s",
                "drive_angle": "rad", "ratio": "1", "uncertainty": "unit of the value",
            },
            "end": self.end,
            "revolutions": self.revolutions(),
            "against": self.against(),
            "columns": Map::from_iter(columns),
            "clearances": Map::from_iter(clearances),
            "contacts_with_fewer_than_three_samples": self.unresolved_contacts,
            "energy": self.energy_balance(),
            "horizon": self.horizon_json(),
        })
    }

    fn revolutions(&self) -> Value {
        let Some(turning) = &self.turning else { return Value::Null };
        let parts = turning.revolutions;
        let bounds: Vec<[f64; 2]> = (0..parts.count()).map(|k| parts.bounds(k)).collect();
        json!({
            "drive": turning.drive,
            "period": parts.period(),
            "count": parts.count(),
            "bounds": bounds,
            "last_is_whole": parts.is_whole(parts.count() - 1),
        })
    }

    /// How far the run is true; what is not known is `null`.
    fn horizon_json(&self) -> Value {
        self.horizon.as_ref().map_or(Value::Null, |horizon| {
            let revolutions = self.turning.as_ref().map(|turning| {
                let all = 0..turning.revolutions.count();
                all.map(|k| !self.reaches_beyond(k)).collect::<Vec<_>>()
            });
            json!({
                "unit": "s",
                "least_digits": LEAST_DIGITS,
                "state": horizon.state,
                "forces": horizon.forces,
                "doubles": horizon.doubles,
                "end": horizon.end,
                "certified": horizon.certified,
                "stopped": horizon.stopped,
                "digits_at_end": horizon.at_end.map(|digits| {
                    json!({ "state": digits.state, "forces": digits.forces })
                }),
                "revolutions_within": revolutions,
                "sentence": self.sentence,
            })
        })
    }

    fn against(&self) -> Value {
        match &self.reference {
            Ok(Reference::Ideal(_)) => json!({ "kind": "ideal" }),
            Ok(Reference::Itself) => json!({ "kind": "itself" }),
            Ok(Reference::File { path, case_name, .. }) => json!({
                "kind": "file", "file": path.to_string_lossy(), "case_name": case_name,
            }),
            Err(_) => Value::Null,
        }
    }

    fn column(&self, quantity: Quantity, total: &Extremes, revolutions: &[Extremes]) -> Value {
        let reference = self.reference_of(quantity).unwrap_or_default();
        let mut column = self.extremes(quantity, total);
        column.insert("unit".into(), quantity.unit().into());
        column.insert("reference".into(), self.pair(quantity, &reference).into());
        let parts = revolutions.iter().map(|part| Value::from(self.extremes(quantity, part)));
        column.insert("revolutions".into(), parts.collect());
        column.into()
    }

    /// Extremes of a span with their ratios to the reference.
    fn extremes(&self, quantity: Quantity, extremes: &Extremes) -> Map<String, Value> {
        let mut all = self.pair(quantity, extremes);
        for (side, extreme) in [("largest", extremes.largest), ("smallest", extremes.smallest)] {
            let told = all.get_mut(side).and_then(Value::as_object_mut);
            if let (Some(told), Some(extreme), Some(_)) = (told, extreme, &self.horizon) {
                told.insert("within_horizon".into(), (!self.is_beyond(extreme.time)).into());
            }
        }
        let [largest, smallest] = self.ratios(quantity, extremes);
        let mut ratios = json!({ "largest": largest });
        if quantity.is_signed() {
            ratios["smallest"] = smallest.into();
        }
        all.insert("ratio".into(), ratios);
        all
    }

    fn pair(&self, quantity: Quantity, extremes: &Extremes) -> Map<String, Value> {
        let mut pair = Map::new();
        pair.insert("largest".into(), self.extreme(extremes.largest));
        if quantity.is_signed() {
            pair.insert("smallest".into(), self.extreme(extremes.smallest));
        }
        pair
    }

    fn extreme(&self, extreme: Option<Extreme>) -> Value {
        extreme.map_or(Value::Null, |extreme| {
            json!({
                "value": extreme.value,
                "time": extreme.time,
                "drive_angle": self.turning.as_ref().map(|turning| turning.angle(extreme.time)),
                "basis": extreme.basis.name(),
                "uncertainty": extreme.uncertainty,
            })
        })
    }

    fn energy_balance(&self) -> Value {
        self.energy.map_or(Value::Null, |energy| {
            json!({
                "unit": "J",
                "time": energy.time,
                "stored": energy.stored,
                "energy_dissipated": energy.dissipated,
                "drive_work": energy.drive_work,
                "load_work": energy.load_work,
                "energy_residual": energy.residual,
                "largest_residual": at(Some(energy.largest_residual), "J"),
                "largest_energy_kinetic": energy.largest_kinetic,
            })
        })
    }
}

fn clearance(contacts: &Contacts) -> Value {
    let revolutions: Vec<Value> = (contacts.revolutions.iter())
        .map(|part| {
            json!({
                "contacts": part.count,
                "share_in_contact": { "value": part.share, "unit": "1" },
                "largest_impact_rate": at(part.fastest, "m/s"),
            })
        })
        .collect();
    let permanent: Vec<Value> = (contacts.permanent.iter())
        .map(|phase| json!({ "begin": phase.begin, "end": phase.end, "open": phase.open }))
        .collect();
    json!({
        "contacts": contacts.count,
        "time_in_contact": { "value": contacts.duration, "unit": "s" },
        "share_in_contact": { "value": contacts.share, "unit": "1" },
        "longest_contact": stretch(contacts.longest_contact),
        "longest_flight": stretch(contacts.longest_flight),
        "largest_penetration": at(contacts.deepest, "m"),
        "largest_impact_rate": at(contacts.fastest, "m/s"),
        "dissipated": { "value": contacts.dissipated, "unit": "J" },
        "permanent_contact": permanent,
        "revolutions": revolutions,
    })
}

fn stretch(stretch: Option<Stretch>) -> Value {
    stretch.map_or(Value::Null, |stretch| {
        json!({
            "value": stretch.length(), "unit": "s",
            "begin": stretch.begin, "end": stretch.end, "open": stretch.open,
        })
    })
}

fn at(at: Option<At>, unit: &str) -> Value {
    at.map_or(Value::Null, |at| json!({ "value": at.value, "unit": unit, "time": at.time }))
}
