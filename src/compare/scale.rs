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
//! All are taken from the reference, and are 1 where it has nothing but zeros. A certified one
//! carries its own, in the attributes `scale_angle`, `scale_angular_velocity`, `scale_velocity`,
//! `scale_force`, `scale_torque` and, for each clearance by its index, `scale_clearance_0`.

use super::quantity::{Column, Quantity};
use crate::record::ResultFile;

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
        let measured = |quantity: Quantity| {
            let largest = match quantity {
                Quantity::Angle | Quantity::Clearance => 1.0,
                Quantity::Position => {
                    of(quantity).map(|(_, values)| extent(values)).fold(0.0, f64::max)
                }
                _ => largest_magnitude(of(quantity)),
            };
            if largest > 0.0 { largest } else { 1.0 }
        };
        Scales { values: Quantity::ALL.map(measured), clearances: radial }
    }

    /// Puts the scales that a result file carries in place of those measured.
    pub fn with_those_of(mut self, file: &ResultFile) -> Scales {
        for (scale, quantity) in self.values.iter_mut().zip(Quantity::ALL) {
            *scale = file.number(&format!("scale_{}", quantity.name())).unwrap_or(*scale);
        }
        for (k, scale) in self.clearances.iter_mut().enumerate() {
            *scale = file.number(&format!("scale_clearance_{k}")).unwrap_or(*scale);
        }
        self
    }

    /// The scale of a column, in its unit.
    pub fn of(&self, column: &Column) -> f64 {
        match column.quantity() {
            Some(Quantity::Clearance) => self.clearances[column.item],
            Some(quantity) => self.values[quantity as usize],
            None => f64::NAN,
        }
    }
}

/// Distance of the largest from the smallest value, what is no number left out.
fn extent(values: &[f64]) -> f64 {
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
    (highest - lowest).max(0.0)
}

/// Largest magnitude of any item: of a vector where both components are there, else of the one;
/// what is no number is left out.
fn largest_magnitude<'a>(columns: impl Iterator<Item = (&'a Column, &'a Vec<f64>)>) -> f64 {
    let mut squares: Vec<((&str, usize), Vec<f64>)> = Vec::new();
    for (column, values) in columns {
        let name = column.dataset.name;
        let vector = name.strip_suffix("_x").or_else(|| name.strip_suffix("_y"));
        let what = (vector.unwrap_or(name), column.item);
        match squares.iter_mut().find(|(known, _)| *known == what) {
            Some((_, sums)) => {
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value * value);
            }
            None => squares.push((what, values.iter().map(|value| value * value).collect())),
        }
    }
    squares.iter().flat_map(|(_, sums)| sums).copied().fold(0.0, f64::max).sqrt()
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
                "normal_force.A" => vec![0.0, 9e3],
                "joint_force_x.B0" => vec![5e3, 9e3],
                "joint_force_y.B0" => vec![-12e3, 0.0],
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
        assert_eq!(scale("joint_moment.A"), 1.0);
    }
}
