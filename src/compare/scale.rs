//! The scales of a comparison, by column. They are taken from the reference by the rule of
//! [`digits`](crate::digits); a certified one carries its own, in the attributes `scale_angle`,
//! `scale_angular_velocity`, `scale_velocity`, `scale_force`, `scale_torque` and, for each
//! clearance by its index, `scale_clearance_0`.

use super::quantity::{Column, Quantity};
use crate::digits::{Largest, Scales, Sizes};
use crate::record::ResultFile;

/// The scales that the values of a reference give, column by column over all its samples.
pub fn measure(columns: &[Column], values: &[Vec<f64>], sizes: &Sizes) -> Scales {
    let of = |quantity: Quantity| {
        columns.iter().zip(values).filter(move |(column, _)| column.quantity() == Some(quantity))
    };
    let largest = Largest {
        angular_velocity: largest_magnitude(of(Quantity::AngularRate)),
        velocity: largest_magnitude(of(Quantity::Velocity)),
        position: largest_extent(of(Quantity::Position)),
        force: largest_magnitude(of(Quantity::Force)),
        torque: largest_magnitude(of(Quantity::Torque)),
        moment: largest_magnitude(of(Quantity::Moment)),
        point_position: largest_extent(of(Quantity::PointPosition)),
        point_velocity: largest_magnitude(of(Quantity::PointVelocity)),
    };
    Scales::new(sizes, &largest)
}

/// The scales that a result file carries in place of those measured.
pub fn carried(mut scales: Scales, file: &ResultFile) -> Scales {
    for quantity in Quantity::ALL {
        if let (Some(scale), Some(carried)) =
            (scale_of(&mut scales, quantity), file.number(&format!("scale_{}", quantity.name())))
        {
            *scale = carried;
        }
    }
    for (k, scale) in scales.clearances.iter_mut().enumerate() {
        *scale = file.number(&format!("scale_clearance_{k}")).unwrap_or(*scale);
    }
    scales
}

/// The one scale of a quantity; `None` for clearances, which have one each.
fn scale_of(scales: &mut Scales, quantity: Quantity) -> Option<&mut f64> {
    match quantity {
        Quantity::Angle => Some(&mut scales.angle),
        Quantity::AngularRate => Some(&mut scales.angular_velocity),
        Quantity::Velocity => Some(&mut scales.velocity),
        Quantity::Clearance => None,
        Quantity::Position => Some(&mut scales.position),
        Quantity::Force => Some(&mut scales.force),
        Quantity::Torque => Some(&mut scales.torque),
        Quantity::Moment => Some(&mut scales.moment),
        Quantity::PointPosition => Some(&mut scales.point_position),
        Quantity::PointVelocity => Some(&mut scales.point_velocity),
    }
}

impl Scales {
    /// The scale of a column, in its unit.
    pub fn of_column(&self, column: &Column) -> f64 {
        match column.quantity() {
            Some(Quantity::Angle) => self.angle,
            Some(Quantity::AngularRate) => self.angular_velocity,
            Some(Quantity::Velocity) => self.velocity,
            Some(Quantity::Clearance) => self.clearances[column.item],
            Some(Quantity::Position) => self.position,
            Some(Quantity::Force) => self.force,
            Some(Quantity::Torque) => self.torque,
            Some(Quantity::Moment) => self.moment,
            Some(Quantity::PointPosition) => self.point_position,
            Some(Quantity::PointVelocity) => self.point_velocity,
            None => f64::NAN,
        }
    }
}

/// The largest extent of any column.
fn largest_extent<'a>(columns: impl Iterator<Item = (&'a Column, &'a Vec<f64>)>) -> f64 {
    columns.map(|(_, values)| extent(values)).fold(0.0, f64::max)
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
        let sizes = Sizes { mass: 0.4, length: 0.1, rate: 100.0, clearances: vec![1e-3] };
        let scales = measure(&columns, &values, &sizes);
        let scale = |name: &str| {
            scales.of_column(columns.iter().find(|column| parts.name(column) == name).unwrap())
        };
        assert_eq!(scale("angle.crank"), 1.0);
        assert_eq!(scale("angular_velocity.follower"), 523.6);
        assert_eq!(scale("velocity_y.crank"), 13.0);
        assert_eq!(scale("clearance_y.A"), 1e-3);
        assert_eq!(scale("position_y.crank"), 0.75);
        assert_eq!(scale("joint_force_x.B"), 13e3);
        // no moment is carried: a thousandth of m l² ω², with the fastest rate seen
        let moment = 1e-3 * 0.4 * 0.1 * 0.1 * 523.6 * 523.6;
        assert!((scale("joint_moment.A") / moment - 1.0).abs() < 1e-12);
    }
}
