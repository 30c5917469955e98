//! What IDA's callbacks work on, and what they leave behind when they stop it.

use super::Error;
use super::matrix::{Columns, Sparse};
use super::tolerance::Weights;
use crate::dae::{Dae, Entries, Fault};
use std::any::Any;
use std::ffi::c_int;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

/// Why a callback made IDA stop.
enum Stop {
    Fault { time: f64, fault: Fault },
    Panic(Box<dyn Any + Send>),
}

/// How often IDA called back.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Calls {
    pub(super) residuals: u64,
    pub(super) jacobians: u64,
}

/// The system, and all else that the callbacks need.
pub(super) struct Shared<Y> {
    pub(super) system: Y,
    pub(super) weights: Weights,
    /// The Newton matrix of a large system.
    pub(super) sparse: Sparse,
    pub(super) calls: Calls,
    /// What IDA said last.
    pub(super) words: String,
    /// The last complaint that a shorter step might mend.
    pub(super) setback: Option<Fault>,
    stop: Option<Stop>,
}

impl<Y: Dae> Shared<Y> {
    pub(super) fn new(system: Y, weights: Weights) -> Self {
        Shared {
            system,
            weights,
            sparse: Sparse::default(),
            calls: Calls::default(),
            words: String::new(),
            setback: None,
            stop: None,
        }
    }

    /// Runs `f` for a callback: 0 done, 1 try a shorter step, −1 give up.
    #[inline(always)]
    pub(super) fn guard(
        &mut self,
        time: f64,
        f: impl FnOnce(&mut Self) -> Result<(), Fault>,
    ) -> c_int {
        let stop = match catch_unwind(AssertUnwindSafe(|| f(self))) {
            Ok(Ok(())) => return 0,
            Ok(Err(fault @ Fault::TryShorterStep(_))) => {
                self.setback = Some(fault);
                return 1;
            }
            Ok(Err(fault)) => Stop::Fault { time, fault },
            Err(payload) => Stop::Panic(payload),
        };
        self.stop = Some(stop);
        -1
    }

    /// The error that stopped IDA, if one did.
    ///
    /// # Panics
    /// With the system's own panic, if that stopped IDA.
    pub(super) fn stopped(&mut self) -> Result<(), Error> {
        match self.stop.take() {
            None => Ok(()),
            Some(Stop::Fault { time, fault }) => Err(Error::System { time, source: fault }),
            Some(Stop::Panic(payload)) => resume_unwind(payload),
        }
    }

    #[inline(always)]
    pub(super) fn residual(
        &mut self,
        time: f64,
        y: &[f64],
        yp: &[f64],
        residual: &mut [f64],
    ) -> Result<(), Fault> {
        self.calls.residuals += 1;
        self.system.residual(time, y, yp, residual)?;
        finite(residual, "the equations of motion")
    }

    /// The Jacobian, into a matrix of zeros.
    pub(super) fn jacobian(
        &mut self,
        time: f64,
        y: &[f64],
        yp: &[f64],
        cj: f64,
        matrix: &mut (impl Entries + Columns),
    ) -> Result<(), Fault> {
        self.calls.jacobians += 1;
        self.system.jacobian(time, y, yp, cj, matrix)?;
        matrix.settle();
        self.weights.know_rounding(time, y, cj, matrix);
        Ok(())
    }
}

/// A complaint if one of these numbers is not finite.
#[inline(always)]
fn finite(numbers: &[f64], what: &str) -> Result<(), Fault> {
    if numbers.iter().fold(true, |finite, x| finite & x.is_finite()) {
        return Ok(());
    }
    Err(Fault::TryShorterStep(format!("{what} gave a number that is not finite")))
}
