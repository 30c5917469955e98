//! A certificate as JSON. Times in s, everything in SI; what is no number is `null`.

use super::report::TOLD;
use super::{Certificate, Told};
use crate::digits::Parts;
use serde_json::{Value, json};

impl Certificate {
    /// The whole certificate.
    pub fn json(&self, told: &Told<'_>) -> Value {
        let reference = &self.reference;
        let growth = &reference.growth;
        let parting = self.parting.as_ref().map(|parting| {
            json!({
                "time": parting.event.time,
                "clearance": parting.event.owner.name(told.names),
                "kind": parting.event.kind as u8,
                "only_in": if parting.in_reference { "reference" } else { "run" },
                "nearest_in_the_other": parting.nearest.map(|event| event.time),
            })
        });
        let counted = || self.events.iter().filter(|event| event.counts);
        let late = counted().filter_map(|event| event.late);
        json!({
            "case": told.case,
            "case_sha256": told.case_sha256,
            "sentence": self.sentence(told),
            "reference": {
                "tolerances": reference.tolerances,
                "digits": told.digits,
                "holds_until": self.reference_holds(told.digits),
                "holds_to_the_end": self.reference_holds_to_the_end(told.digits),
                "until": reference.until,
                "complete": reference.complete,
                "stopped": reference.stopped,
            },
            "run_failure": self.run_failure,
            "run_holds": TOLD.map(|digits| {
                json!({ "digits": digits, "until": self.run_holds(digits) })
            }),
            "times": reference.trajectory.samples.iter().map(|s| s.time).collect::<Vec<_>>(),
            "reference_digits": by_part(self.claims.iter().map(|claim| claim.reference)),
            "run_digits": by_part(self.claims.iter().map(|claim| claim.run)),
            "events": {
                "of": counted().count(),
                "found": late.clone().count(),
                "largest_time_error": late.map(f64::abs).reduce(f64::max),
                "true_times_known_to": reference.event_times_known_to(reference.followed_until()),
            },
            "peaks": {
                "of": self.peaks.of,
                "found": self.peaks.found,
                "largest_force_error": self.peaks.error * reference.scales.force,
            },
            "parting": parting,
            "decades_per_second": reference.growth_rate(),
            "growth_known_until": reference.growth_known_until(),
            "double_precision_ends": growth.double_precision_ends,
        })
    }
}

/// Digits of each part, over the samples.
fn by_part(digits: impl Iterator<Item = Parts<f64>> + Clone) -> Value {
    json!({
        "state": digits.clone().map(|digits| digits.state).collect::<Vec<_>>(),
        "forces": digits.clone().map(|digits| digits.forces).collect::<Vec<_>>(),
        "torque": digits.map(|digits| digits.torque).collect::<Vec<_>>(),
    })
}
