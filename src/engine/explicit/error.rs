//! What can stop the explicit engine.

use crate::dae::Fault;

/// Why the explicit engine cannot be made or cannot go on. Times are in seconds.
#[derive(Debug, thiserror::Error)]
pub enum ExplicitError {
    /// A tolerance that this arithmetic cannot meet, or that is no tolerance.
    #[error(
        "the explicit engine cannot step at a tolerance of {tolerance:e}; \
         this arithmetic allows {smallest:e} to 1e-2"
    )]
    Tolerance {
        /// The tolerance asked for.
        tolerance: f64,
        /// The smallest that would do.
        smallest: f64,
    },
    /// A step length that is not positive.
    #[error("the explicit engine needs positive initial and largest steps (s)")]
    StepLength,
    /// Eighth order was asked for in an arithmetic that its coefficients do not serve.
    #[error("the Runge-Kutta coefficients are good to double precision only; extrapolate instead")]
    Coefficients,
    /// The system could not be evaluated.
    #[error("the system cannot be evaluated at t = {time:e} s")]
    System {
        /// Where.
        time: f64,
        /// Why.
        #[source]
        source: Fault,
    },
    /// A start state that is not finite.
    #[error("the state to start from at t = {time:e} s is not finite")]
    NotFinite {
        /// Where.
        time: f64,
    },
    /// Ever shorter steps did not help.
    #[error(
        "no step from t = {time:e} s is short enough for a tolerance of {tolerance:e}; \
         the last one tried was {step:e} long"
    )]
    StepTooSmall {
        /// Begin of the step.
        time: f64,
        /// The tolerance.
        tolerance: f64,
        /// Length of the last attempt, in the independent variable (s without contact).
        step: f64,
        /// What the system said to it, if it did.
        #[source]
        source: Option<Fault>,
    },
    /// Steps or events follow each other at one time.
    #[error("the explicit engine does not get away from t = {time:e} s")]
    Stuck {
        /// Where.
        time: f64,
    },
    /// Steps are so short that the end is out of reach.
    #[error(
        "the explicit engine takes steps of {step:.1e} s at t = {time:e} s, {steps:.0e} to the end: \
         something in the case is stiff (a friction ramp v0 to v1 that is narrow, a contact that \
         begins very softly); solver.engine = \"ida\" is made for that"
    )]
    Crawl {
        /// Where (s).
        time: f64,
        /// Mean length of a step (s).
        step: f64,
        /// Steps that are left at that pace.
        steps: f64,
    },
    /// No bound tells whether a step holds an event.
    #[error(
        "it cannot be proven that the step from t = {time:e} s holds no event of function {function}"
    )]
    Unproven {
        /// Begin of the step (s).
        time: f64,
        /// Index of the event function.
        function: usize,
    },
    /// An event, or a time within a step, was not met by repeated steps.
    #[error("the explicit engine cannot land on {target} within the step from t = {time:e} s")]
    Landing {
        /// Begin of the step.
        time: f64,
        /// What was to be met.
        target: String,
    },
    /// A time was asked for that the last step does not cover.
    #[error("t = {time:e} s is not within the last step, {began:e} s to {now:e} s")]
    NotWithin {
        /// The time asked for.
        time: f64,
        /// Begin of the last step.
        began: f64,
        /// End of the last step.
        now: f64,
    },
}
