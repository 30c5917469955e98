//! What can be compared: the columns of a result file that make up the state, and the forces.

use crate::mechanism::Observation;
use crate::model::Names;
use crate::record::{Dataset, Dimension, ResultFile, column_name};

pub use crate::record::Quantity;

/// What a quantity has to do with the gate, the number that a comparison is judged by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Always counts.
    State,
    /// Follows from the state; told, and counts only where nothing of the state is in common.
    Derived,
    /// Looked at where asked for, and counts then.
    Forces,
}

impl Quantity {
    /// All, in the order in which they are told.
    pub const ALL: [Quantity; 10] = [
        Quantity::Angle,
        Quantity::AngularRate,
        Quantity::Velocity,
        Quantity::Clearance,
        Quantity::Position,
        Quantity::PointPosition,
        Quantity::PointVelocity,
        Quantity::Force,
        Quantity::Torque,
        Quantity::Moment,
    ];

    /// Name in JSON, and in the attribute of a result file that holds its scale, `scale_<name>`.
    pub const fn name(self) -> &'static str {
        match self {
            Quantity::Angle => "angle",
            Quantity::AngularRate => "angular_velocity",
            Quantity::Velocity => "velocity",
            Quantity::Clearance => "clearance",
            Quantity::Position => "position",
            Quantity::Force => "force",
            Quantity::Torque => "torque",
            Quantity::Moment => "moment",
            Quantity::PointPosition => "point_position",
            Quantity::PointVelocity => "point_velocity",
        }
    }

    /// Name for people.
    pub const fn title(self) -> &'static str {
        match self {
            Quantity::AngularRate => "angular rate",
            Quantity::PointPosition => "position of point",
            Quantity::PointVelocity => "velocity of point",
            other => other.name(),
        }
    }

    /// Unit of its scale.
    pub const fn unit(self) -> &'static str {
        match self {
            Quantity::Angle => "rad",
            Quantity::AngularRate => "rad/s",
            Quantity::Velocity | Quantity::PointVelocity => "m/s",
            Quantity::Clearance | Quantity::Position | Quantity::PointPosition => "m",
            Quantity::Force => "N",
            Quantity::Torque | Quantity::Moment => "N m",
        }
    }

    /// Its part in the gate.
    pub const fn part(self) -> Part {
        match self {
            Quantity::Angle | Quantity::AngularRate | Quantity::Velocity | Quantity::Clearance => {
                Part::State
            }
            Quantity::Position | Quantity::PointPosition | Quantity::PointVelocity => Part::Derived,
            Quantity::Force | Quantity::Torque | Quantity::Moment => Part::Forces,
        }
    }
}

/// A column of a result file over time: a dataset, and which of its items.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    /// The dataset.
    pub dataset: &'static Dataset,
    /// Index of the item in the dataset's row; 0 where the row is one value.
    pub item: usize,
}

impl PartialEq for Column {
    fn eq(&self, other: &Column) -> bool {
        self.dataset.name == other.dataset.name && self.item == other.item
    }
}

impl Column {
    /// The quantity it belongs to; `None` where it is not compared.
    pub fn quantity(&self) -> Option<Quantity> {
        self.dataset.quantity
    }

    /// Its value in an observation, in the dataset's unit.
    pub fn value(&self, observation: &Observation) -> f64 {
        self.dataset.value(observation, self.item)
    }
}

/// The names of a mechanism's parts, and with them all columns over time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parts(pub Names);

impl Parts {
    /// The parts that a result file names.
    pub fn of(file: &ResultFile) -> Parts {
        Parts(Names {
            bodies: file.bodies().to_vec(),
            joints: file.joints().to_vec(),
            clearances: file.clearances().to_vec(),
            loose: Vec::new(),
            drives: file.drives().to_vec(),
            points: file.points().to_vec(),
            memories: file.memories().to_vec(),
        })
    }

    /// Names of the items of a dataset; `None` where a row of it is one value.
    pub fn items(&self, dataset: &Dataset) -> Option<&[String]> {
        match dataset.items()? {
            Dimension::Body => Some(&self.0.bodies),
            Dimension::Joint => Some(&self.0.joints),
            Dimension::Clearance => Some(&self.0.clearances),
            Dimension::Drive => Some(&self.0.drives),
            Dimension::Point => Some(&self.0.points),
            Dimension::Memory => Some(&self.0.memories),
            Dimension::Time
            | Dimension::Event
            | Dimension::Contact
            | Dimension::Peak
            | Dimension::Revolution => None,
        }
    }

    /// All columns over time but the time itself.
    pub fn columns(&self) -> Vec<Column> {
        let over_time = crate::record::DATASETS
            .iter()
            .filter(|dataset| dataset.rows() == Dimension::Time && dataset.name != "time");
        over_time
            .flat_map(|dataset| {
                let items = self.items(dataset).map_or(1, <[String]>::len);
                (0..items).map(move |item| Column { dataset, item })
            })
            .collect()
    }

    /// The columns that are compared, in the order of the quantities; those of the forces only
    /// where asked for.
    pub fn compared(&self, forces: bool) -> Vec<Column> {
        let wanted = |quantity: &Quantity| forces || quantity.part() != Part::Forces;
        let columns = self.columns();
        let of = |quantity: Quantity| {
            columns.iter().filter(move |column| column.quantity() == Some(quantity)).copied()
        };
        Quantity::ALL.into_iter().filter(wanted).flat_map(of).collect()
    }

    /// Names of columns, for a message.
    pub fn names_of(&self, columns: &[Column]) -> String {
        let names: Vec<String> = columns.iter().map(|column| self.name(column)).collect();
        names.join(", ")
    }

    /// Name of a column, `angle.coupler`.
    pub fn name(&self, column: &Column) -> String {
        let item = self.items(column.dataset).map(|items| items[column.item].as_str());
        column_name(column.dataset.name, item)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::record::DATASETS;

    /// The parts of the paper's four-bar with clearance in A.
    pub fn four_bar() -> Parts {
        let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        Parts(Names {
            bodies: names(&["crank", "coupler", "follower"]),
            joints: names(&["A0", "A", "B", "B0"]),
            clearances: names(&["A"]),
            loose: vec![1],
            drives: names(&["crank"]),
            points: Vec::new(),
            memories: Vec::new(),
        })
    }

    #[test]
    fn every_quantity_has_datasets_in_its_unit() {
        for quantity in Quantity::ALL {
            let of_it = || DATASETS.iter().filter(|dataset| dataset.quantity == Some(quantity));
            assert!(of_it().count() > 0, "{quantity:?}");
            assert!(of_it().all(|dataset| dataset.unit == quantity.unit()), "{quantity:?}");
        }
    }

    #[test]
    fn the_state_of_the_four_bar_has_fourteen_columns_and_positions_six() {
        let parts = four_bar();
        let columns = parts.compared(false);
        let of_part = |part: Part| {
            columns.iter().filter(|c| c.quantity().map(Quantity::part) == Some(part)).count()
        };
        assert_eq!((of_part(Part::State), of_part(Part::Derived)), (14, 6));
        assert_eq!(of_part(Part::Forces), 0);
        assert_eq!(parts.name(&columns[1]), "angle.coupler");
        assert_eq!(parts.compared(true).len(), 20 + 2 + 8 + 1 + 4);
    }
}
