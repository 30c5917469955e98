//! The engine against closed forms, in both arithmetics.

mod contact;
mod events;
mod smooth;
mod systems;

use super::{Explicit, ExplicitError, Method, Options};
use crate::dae::{Advance, Engine, Snapshot, System};
use crate::scalar::Scalar;

/// An engine at a tolerance, started from a state at t = 0.
fn started<S: Scalar, Y: System<S>>(
    system: Y,
    options: Options,
    q: Vec<S>,
    v: Vec<S>,
) -> Explicit<S, Y> {
    let z = vec![S::zero(); system.inner_states()];
    let integrals = vec![S::zero(); system.integrals()];
    let mut engine = Explicit::new(system, options).unwrap();
    engine.restart(&Snapshot { time: S::zero(), q, v, z, integrals }).unwrap();
    engine
}

/// Options with a tolerance and a first step (s).
fn options(tolerance: f64, initial_step: f64) -> Options {
    Options { tolerance, initial_step, ..Options::default() }
}

/// Steps to the next event, or to `end`.
fn go<S: Scalar, Y: System<S>>(engine: &mut Explicit<S, Y>, end: S) -> Advance {
    loop {
        if engine.step(end).unwrap() == Advance::Event {
            return Advance::Event;
        }
        if engine.now().time == end {
            return Advance::Stepped;
        }
    }
}

/// |x/y − 1|.
fn apart<S: Scalar>(x: S, y: S) -> f64 {
    ((x - y) / y).to_f64().abs()
}

fn number<S: Scalar>(literal: &str) -> S {
    S::parse(literal).unwrap()
}
