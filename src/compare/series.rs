//! Digits of agreement over time: by quantity, and the gate, which is the worst of them.

use super::Error;
use super::quantity::{Column, Part, Quantity};
use crate::digits::Scales;
use crate::digits::{Grade, whole_turns};
use crate::record::{Dimension, ResultFile, Seal};

/// Digits to which a reference is certified, over its own samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    times: Vec<f64>,
    state: Vec<f64>,
    forces: Option<Vec<f64>>,
    torque: Option<Vec<f64>>,
    /// Whether it is sealed.
    pub sealed: bool,
}

impl Certificate {
    /// The certificate that a result carries in `reference_digits`, `reference_digits_forces` and
    /// `reference_digits_torque`; `None` where it has no `reference_digits`.
    ///
    /// # Errors
    /// The file was changed after it was sealed, or what reading meets.
    pub fn of(file: &ResultFile) -> Result<Option<Certificate>, Error> {
        let Some(state) = file.along(Dimension::Time, "reference_digits")? else { return Ok(None) };
        let seal = file.seal()?;
        if seal == Seal::Broken {
            return Err(Error::BrokenSeal { path: file.path().to_owned() });
        }
        Ok(Some(Certificate {
            times: file.times()?,
            state,
            forces: file.along(Dimension::Time, "reference_digits_forces")?,
            torque: file.along(Dimension::Time, "reference_digits_torque")?,
            sealed: seal == Seal::Whole,
        }))
    }

    /// Digits to which a quantity is certified at a time (s): the fewer of those at the samples on
    /// either side. Forces without digits of their own have those of the state.
    pub fn at(&self, quantity: Quantity, time: f64) -> f64 {
        let digits = match quantity {
            Quantity::Force => self.forces.as_ref(),
            Quantity::Torque | Quantity::Moment => self.torque.as_ref(),
            _ => None,
        };
        let digits = digits.unwrap_or(&self.state);
        let behind = self.times.partition_point(|known| *known < time).min(digits.len() - 1);
        let before = match self.times[behind] > time {
            true => behind.saturating_sub(1),
            false => behind,
        };
        // NaN certifies nothing, whichever side it stands on
        match digits[before..=behind].iter().any(|digits| digits.is_nan()) {
            true => f64::NEG_INFINITY,
            false => digits[before].min(digits[behind]),
        }
    }
}

/// Digits of one quantity over time.
#[derive(Debug, Clone, PartialEq)]
pub struct QuantityGrades {
    /// The quantity.
    pub quantity: Quantity,
    /// Indices of its columns among those compared.
    pub columns: Vec<usize>,
    /// Whether it counts for the gate.
    pub in_gate: bool,
    /// The worst of its columns at each sample.
    pub grades: Vec<Grade>,
}

/// Digits over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Times compared (s).
    pub times: Vec<f64>,
    /// By quantity, those in common.
    pub quantities: Vec<QuantityGrades>,
    /// The worst of those that count, at each sample.
    pub gate: Vec<Grade>,
    /// Indices of columns that are off by whole turns, which were not counted.
    pub turned: Vec<usize>,
}

/// Two trajectories at the same times.
#[derive(Debug, Clone, PartialEq)]
pub struct Aligned {
    /// Times (s), never going back.
    pub times: Vec<f64>,
    /// What the columns are, in the order of the quantities.
    pub columns: Vec<Column>,
    /// Values of the first, by column.
    pub theirs: Vec<Vec<f64>>,
    /// Values of the reference, by column.
    pub reference: Vec<Vec<f64>>,
}

impl Aligned {
    /// Whether all numbers are the same.
    pub fn is_identical(&self) -> bool {
        self.theirs == self.reference
    }

    /// Grades every sample. `turns` says whether whole turns of an angle are left out.
    pub fn grade(&self, scales: &Scales, certificate: Option<&Certificate>, turns: bool) -> Series {
        let mut quantities: Vec<QuantityGrades> = Quantity::ALL
            .into_iter()
            .filter_map(|quantity| self.grade_quantity(quantity, scales, certificate, turns))
            .collect();
        let counts = |part: Part| part != Part::Derived;
        let derived_only = quantities.iter().all(|q| !counts(q.quantity.part()));
        for graded in &mut quantities {
            graded.in_gate = derived_only || counts(graded.quantity.part());
        }
        let gate = (0..self.times.len())
            .filter_map(|row| {
                let counting = quantities.iter().filter(|graded| graded.in_gate);
                counting.map(|graded| graded.grades[row]).reduce(Grade::worse)
            })
            .collect();
        let turned = if turns { self.turned() } else { Vec::new() };
        Series { times: self.times.clone(), quantities, gate, turned }
    }

    fn grade_quantity(
        &self,
        quantity: Quantity,
        scales: &Scales,
        certificate: Option<&Certificate>,
        turns: bool,
    ) -> Option<QuantityGrades> {
        let of_it = |index: &usize| self.columns[*index].quantity() == Some(quantity);
        let columns: Vec<usize> = (0..self.columns.len()).filter(of_it).collect();
        let turns = turns && quantity == Quantity::Angle;
        let grade = |row: usize, index: usize| {
            let (theirs, reference) = (self.theirs[index][row], self.reference[index][row]);
            let scale = scales.of_column(&self.columns[index]);
            match turns {
                true => Grade::of_angle(theirs, reference, scale, index),
                false => Grade::new(theirs, reference, scale, index),
            }
        };
        let worst = |row: usize| {
            let worst = columns.iter().map(|index| grade(row, *index)).reduce(Grade::worse)?;
            Some(match certificate {
                Some(certificate) => worst.limited(certificate.at(quantity, self.times[row])),
                None => worst,
            })
        };
        let grades: Vec<Grade> = (0..self.times.len()).filter_map(worst).collect();
        (!columns.is_empty()).then_some(QuantityGrades {
            quantity,
            columns,
            in_gate: false,
            grades,
        })
    }

    /// Columns of angles that are off by whole turns anywhere.
    fn turned(&self) -> Vec<usize> {
        let is_off = |turns: f64| turns != 0.0 && turns.is_finite();
        let off = |index: &usize| {
            let pairs = self.theirs[*index].iter().zip(&self.reference[*index]);
            self.columns[*index].quantity() == Some(Quantity::Angle)
                && pairs.map(|(theirs, reference)| whole_turns(*theirs, *reference)).any(is_off)
        };
        (0..self.columns.len()).filter(off).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::quantity::tests::four_bar;
    use super::super::scale;
    use super::*;
    use crate::digits::Sizes;

    fn certificate() -> Certificate {
        Certificate {
            times: vec![0.0, 1.0, 2.0],
            state: vec![20.0, 10.0, f64::NAN],
            forces: Some(vec![17.0, 7.0, 3.0]),
            torque: None,
            sealed: true,
        }
    }

    #[test]
    fn between_two_samples_the_worse_of_both_is_certified() {
        let certificate = certificate();
        for (time, digits) in [(0.0, 20.0), (0.5, 10.0), (1.0, 10.0), (1.5, f64::NEG_INFINITY)] {
            assert_eq!(certificate.at(Quantity::Angle, time), digits, "{time}");
        }
        assert_eq!(certificate.at(Quantity::Force, 1.5), 3.0);
        assert_eq!(certificate.at(Quantity::Torque, 0.2), 10.0);
    }

    /// The four-bar at two samples, everything 1 in the reference and off by `error` in `off`.
    fn aligned(names: &[&str], off: &str, error: f64) -> Aligned {
        let parts = four_bar();
        let named = |column: &Column| names.contains(&parts.name(column).as_str());
        let columns: Vec<Column> = parts.compared(true).into_iter().filter(named).collect();
        let reference = vec![vec![1.0; 2]; columns.len()];
        let mut theirs = reference.clone();
        for (column, values) in columns.iter().zip(&mut theirs) {
            if parts.name(column) == off {
                values[1] += error;
            }
        }
        Aligned { times: vec![0.0, 0.5], columns, theirs, reference }
    }

    fn measured(aligned: &Aligned) -> Scales {
        let sizes = Sizes { mass: 1.0, length: 1.0, rate: 1.0, clearances: vec![1e-3] };
        scale::measure(&aligned.columns, &aligned.reference, &sizes)
    }

    fn gate(aligned: &Aligned, certificate: Option<&Certificate>) -> Vec<Grade> {
        let scales = measured(aligned);
        aligned.grade(&scales, certificate, false).gate
    }

    #[test]
    fn the_gate_is_the_worst_of_the_state_and_tells_the_column() {
        let names = ["angle.coupler", "clearance_x.A", "position_x.coupler"];
        let aligned = aligned(&names, "clearance_x.A", 1e-9);
        let gate = gate(&aligned, None);
        assert!((gate[1].digits - 6.0).abs() < 1e-3 && gate[1].column == 1, "{gate:?}");
        assert!(gate[0].at_least && !gate[1].at_least);
    }

    #[test]
    fn positions_count_only_where_nothing_else_is_in_common() {
        let far_off = aligned(&["angle.coupler", "position_x.coupler"], "position_x.coupler", 9.0);
        assert!(gate(&far_off, None)[1].digits > 15.0);
        let alone = aligned(&["position_x.coupler"], "position_x.coupler", 9.0);
        assert!(gate(&alone, None)[1].digits < 0.0);
    }

    #[test]
    fn no_grade_exceeds_what_the_reference_is_certified_to() {
        let same = aligned(&["angle.coupler"], "", 0.0);
        let gate = gate(&same, Some(&certificate()));
        assert!(gate[0].digits > 15.0);
        assert!(gate[1].digits == 10.0 && gate[1].at_least);
    }

    #[test]
    fn columns_off_by_whole_turns_are_told() {
        let turned =
            aligned(&["angle.crank", "angle.coupler"], "angle.crank", -std::f64::consts::TAU);
        let scales = measured(&turned);
        let series = turned.grade(&scales, None, true);
        assert_eq!(series.turned, [0]);
        assert!(series.gate[1].digits > 14.0);
        assert!(turned.grade(&scales, None, false).gate[1].digits < 0.0);
        for no_turn in [f64::INFINITY, f64::NAN] {
            let spoilt = aligned(&["angle.crank"], "angle.crank", no_turn);
            let series = spoilt.grade(&scales, None, true);
            assert!(series.turned.is_empty() && series.gate[1].digits == f64::NEG_INFINITY);
        }
    }
}
