//! What an error is measured with.
//!
//! ```text
//! angles            1 rad
//! angular rates     the largest of any body
//! velocities        the largest speed of any mass centre
//! clearance vectors their radial clearance
//! positions         the largest extent of the path of any mass centre
//! forces            the largest of any joint or clearance
//! torques, moments  the largest
//! ```
//! All are taken from the reference. One that was certified carries its own, in the attributes
//! `scale_angle`, `scale_angular_velocity`, `scale_velocity`, `scale_force` and so on, and
//! `scale_clearance_<name>` for each clearance.

use super::quantity::{Column, Parts, Quantity};
use crate::record::{Attribute, ResultFile};

/// The scale of every quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Scales {
    /// By quantity, in the order of [`Quantity::ALL`]; that of clearances is unused.
    values: [f64; Quantity::ALL.len()],
    /// By clearance (m).
    clearances: Vec<f64>,
}

impl Scales {
    /// Takes the scales from the values of a reference, column by column over all its samples.
    /// `radial` are the radial clearances (m).
    pub fn measure(columns: &[Column], values: &[Vec<f64>], radial: Vec<f64>) -> Scales {
        let of = |quantity: Quantity| {
            columns
                .iter()
                .zip(values)
                .filter(move |(column, _)| column.quantity() == Some(quantity))
        };
        let measured = |quantity: Quantity| match quantity {
            Quantity::Angle => 1.0,
            Quantity::Clearance => f64::NAN,
            Quantity::Velocity => largest_speed(of(quantity)),
            Quantity::Position => {
                of(quantity).map(|(_, values)| extent(values)).fold(0.0, f64::max)
            }
            _ => of(quantity).map(|(_, values)| largest(values)).fold(0.0, f64::max),
        };
        Scales { values: Quantity::ALL.map(measured), clearances: radial }
    }

    /// Puts the scales that a result file carries in place of those measured.
    pub fn with_those_of(mut self, file: &ResultFile, parts: &Parts) -> Scales {
        for (scale, quantity) in self.values.iter_mut().zip(Quantity::ALL) {
            if let Some(carried) = file.number(&attribute(quantity)) {
                *scale = carried;
            }
        }
        for (scale, name) in self.clearances.iter_mut().zip(&parts.0.clearances) {
            if let Some(carried) = file.number(&clearance_attribute(name)) {
                *scale = carried;
            }
        }
        self
    }

    /// The scales as attributes of a result file, those of quantities that were not looked at (0)
    /// left out.
    pub fn attributes(&self, parts: &Parts) -> Vec<(String, Attribute)> {
        let values = Quantity::ALL.into_iter().zip(self.values);
        let plain = values
            .filter(|(_, scale)| *scale > 0.0)
            .map(|(quantity, scale)| (attribute(quantity), Attribute::from(scale)));
        let clearances = parts.0.clearances.iter().zip(&self.clearances);
        let clearances =
            clearances.map(|(name, scale)| (clearance_attribute(name), Attribute::from(*scale)));
        plain.chain(clearances).collect()
    }

    /// The scale of a column, in its unit; 0 where the reference has nothing but zeros.
    pub fn of(&self, column: &Column) -> f64 {
        match column.quantity() {
            Some(Quantity::Clearance) => self.clearances[column.item],
            Some(quantity) => self.values[quantity as usize],
            None => f64::NAN,
        }
    }
}

fn attribute(quantity: Quantity) -> String {
    format!("scale_{}", quantity.name())
}

fn clearance_attribute(name: &str) -> String {
    format!("scale_clearance_{name}")
}

/// Largest magnitude, what is no number left out.
fn largest(values: &[f64]) -> f64 {
    values.iter().map(|value| value.abs()).fold(0.0, f64::max)
}

/// Distance of the largest from the smallest value, what is no number left out.
fn extent(values: &[f64]) -> f64 {
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
    (highest - lowest).max(0.0)
}

/// Largest speed of any body, from its components; from one where the other is missing.
fn largest_speed<'a>(columns: impl Iterator<Item = (&'a Column, &'a Vec<f64>)>) -> f64 {
    let mut squares: Vec<(usize, Vec<f64>)> = Vec::new();
    for (column, values) in columns {
        match squares.iter_mut().find(|(body, _)| *body == column.item) {
            Some((_, sums)) => {
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value * value);
            }
            None => squares.push((column.item, values.iter().map(|value| value * value).collect())),
        }
    }
    squares.iter().map(|(_, sums)| largest(sums)).fold(0.0, f64::max).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::quantity::tests::four_bar;
    use super::*;

    #[test]
    fn each_quantity_is_measured_as_its_rule_says() {
        let parts = four_bar();
        let columns = parts.compared(true);
        let values: Vec<Vec<f64>> = columns
            .iter()
            .map(|column| match parts.name(column).as_str() {
                "angular_velocity.crank" => vec![-523.6, f64::NAN],
                "velocity_x.coupler" => vec![3.0, 12.0],
                "velocity_y.coupler" => vec![-4.0, 5.0],
                "velocity_x.follower" => vec![-12.5, 0.0],
                "position_x.follower" => vec![-0.25, 0.5],
                "normal_force.A" => vec![0.0, 13e3],
                "joint_force_y.B0" => vec![-2e3, 0.0],
                _ => vec![0.0, 0.0],
            })
            .collect();
        let scales = Scales::measure(&columns, &values, vec![1e-3]);
        let scale = |name: &str| {
            scales.of(columns.iter().find(|column| parts.name(column) == name).unwrap())
        };
        assert_eq!(scale("angle.crank"), 1.0);
        assert_eq!(scale("angular_velocity.follower"), 523.6);
        assert_eq!(scale("velocity_y.crank"), 13.0);
        assert_eq!(scale("clearance_y.A"), 1e-3);
        assert_eq!(scale("position_y.crank"), 0.75);
        assert_eq!(scale("joint_force_x.B"), 13e3);
        assert_eq!(scale("joint_moment.A"), 0.0);
    }
}
