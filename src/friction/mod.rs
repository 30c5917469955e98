//! Tangential-force laws, one file a law.
//!
//! A law gives F_T/F_N by branch: a piece of it that goes on smoothly beyond its edges, so that an
//! engine which restarts where the slip passes an edge meets no kink. A law may remember something:
//! an inner state z, with a rate of its own. Signs are the same everywhere: F_T acts on the journal
//! along t, and opposes a positive slip where it is negative.
//!
//! A new law is a file here, a `mod` line, and its name in the list of [`Friction`].

mod ambrosio;
mod dahl;

pub use ambrosio::{Ambrosio, Ramp};
pub use dahl::Dahl;

use crate::scalar::Scalar;

/// A branch of a law: its number in the order of the slip, backward first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Branch(pub u8);

/// A function of slip and inner state, with its partial derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sloped<S> {
    /// Its value.
    pub value: S,
    /// Its derivative by the slip (over m/s).
    pub d_slip: S,
    /// Its derivative by the inner state (over the state's unit).
    pub d_inner: S,
}

impl<S: Scalar> Sloped<S> {
    /// Zero, whatever slip and inner state are.
    pub fn none() -> Self {
        Sloped { value: S::zero(), d_slip: S::zero(), d_inner: S::zero() }
    }
}

/// What a friction law tells.
pub trait FrictionLaw<S: Scalar> {
    /// F_T/F_N of a branch, at a slip (m/s) and an inner state.
    fn ratio(&self, branch: Branch, slip: S, inner: S) -> Sloped<S>;

    /// The branch of a slip (m/s) about whose past nothing is known; on an edge the one that the
    /// slip's acceleration (m/s²) leads into.
    fn branch(&self, slip: S, acceleration: S) -> Branch;

    /// The slips (m/s) at which a branch is left, below and above; infinite where it has no edge.
    fn edges(&self, branch: Branch) -> (S, S);

    /// The branch after `branch` was left at `slip` (m/s) through its upper or its lower edge.
    fn beyond(&self, branch: Branch, upward: bool, slip: S) -> Branch;

    /// A slip (m/s) that is of order one: edges are watched in units of it.
    fn slip_scale(&self) -> S;

    /// Typical size of the inner state; `None` where the law remembers nothing.
    fn inner_scale(&self) -> Option<f64> {
        None
    }

    /// ż of a branch, at a slip (m/s) and an inner state.
    fn inner_rate(&self, branch: Branch, slip: S, inner: S) -> Sloped<S> {
        let _ = (branch, slip, inner);
        Sloped::none()
    }

    /// F_T/F_N as a function of the slip alone; `None` where there is no such function.
    fn ramp(&self) -> Option<Ramp> {
        None
    }

    /// The largest |F_T/F_N| there can be.
    fn limit(&self) -> S;
}

/// The laws, and which of them answers.
macro_rules! laws {
    ($($law:ident),+) => {
        /// A friction law and its parameters.
        #[derive(Debug, Clone, Copy)]
        pub enum Friction<S> {
            $(#[doc = concat!("See [`", stringify!($law), "`].")] $law($law<S>)),+
        }

        $(impl<S> From<$law<S>> for Friction<S> {
            fn from(law: $law<S>) -> Self {
                Friction::$law(law)
            }
        })+

        impl<S: Scalar> FrictionLaw<S> for Friction<S> {
            #[inline(always)]
            fn ratio(&self, branch: Branch, slip: S, inner: S) -> Sloped<S> {
                match self { $(Friction::$law(law) => law.ratio(branch, slip, inner)),+ }
            }

            fn branch(&self, slip: S, acceleration: S) -> Branch {
                match self { $(Friction::$law(law) => law.branch(slip, acceleration)),+ }
            }

            #[inline(always)]
            fn edges(&self, branch: Branch) -> (S, S) {
                match self { $(Friction::$law(law) => law.edges(branch)),+ }
            }

            fn beyond(&self, branch: Branch, upward: bool, slip: S) -> Branch {
                match self { $(Friction::$law(law) => law.beyond(branch, upward, slip)),+ }
            }

            #[inline(always)]
            fn slip_scale(&self) -> S {
                match self { $(Friction::$law(law) => law.slip_scale()),+ }
            }

            fn inner_scale(&self) -> Option<f64> {
                match self { $(Friction::$law(law) => law.inner_scale()),+ }
            }

            #[inline(always)]
            fn inner_rate(&self, branch: Branch, slip: S, inner: S) -> Sloped<S> {
                match self { $(Friction::$law(law) => law.inner_rate(branch, slip, inner)),+ }
            }

            fn ramp(&self) -> Option<Ramp> {
                match self { $(Friction::$law(law) => law.ramp()),+ }
            }

            fn limit(&self) -> S {
                match self { $(Friction::$law(law) => law.limit()),+ }
            }
        }
    };
}

laws! { Ambrosio, Dahl }
