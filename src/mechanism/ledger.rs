//! Where each integral of a run stands in the list that engines carry along.

use crate::model::Model;
use crate::scalar::Scalar;
use std::ops::Range;

/// Places of the integrals (J): work of all drives, what each clearance has dissipated, and, where
/// there are loads other than fields, their work and what they have dissipated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ledger {
    clearances: usize,
    loads: bool,
}

impl Ledger {
    /// That of a model.
    pub(super) fn of<S: Scalar>(model: &Model<S>) -> Self {
        Ledger {
            clearances: model.clearances().len(),
            loads: model.loads().iter().any(|load| load.bodies().is_some()),
        }
    }

    /// Number of integrals.
    pub fn len(&self) -> usize {
        let loads = if self.loads { 2 } else { 0 };
        self.clearances().end + loads
    }

    /// Whether there are none: there is always one.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Work of the drives.
    pub fn drives(&self) -> usize {
        0
    }

    /// What each clearance has dissipated.
    pub fn clearances(&self) -> Range<usize> {
        1..1 + self.clearances
    }

    /// What a clearance has dissipated.
    pub fn clearance(&self, k: usize) -> usize {
        self.clearances().start + k
    }

    /// Work of the loads, and what they have dissipated.
    pub fn loads(&self) -> Option<[usize; 2]> {
        let first = self.clearances().end;
        self.loads.then_some([first, first + 1])
    }
}
