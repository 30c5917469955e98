//! Tangential-force laws, one file a law.
//!
//! A law gives F_T/F_N by branch: a piece of it that goes on smoothly beyond its edges, so that an
//! engine which restarts where the slip passes an edge meets no kink. A law may remember something:
//! an inner state z, with a rate of its own. Signs are the same everywhere: F_T acts on the journal
//! along t, and opposes a positive slip where it is negative.
//!
//! A new law is a file here and its line in the list of kinds.

use crate::parameter::{Key, Otherwise, Range, Takes, Values, kinds};
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

mod pieces;

pub use ambrosio::Ramp;

kinds! { $
    /// A friction law of any kind.
    Friction, each_friction:
    Ambrosio in ambrosio,
    Dahl in dahl,
    LuGre in lugre,
    ElastoPlastic in elasto_plastic,
    Tanh in tanh,
    BrownMcPhee in brown_mcphee,
    Threlfall in threlfall,
    BengisuAkay in bengisu_akay,
    Stribeck in stribeck,
    #[cfg(test)]
    Scratch in scratch,
}

/// What a law is made of beside its values.
#[derive(Debug, Clone, Copy)]
pub struct Ends<S> {
    /// A branch is left this much beyond its edge, over the slip that is of order one.
    pub hysteresis: S,
}

/// A branch of a law: its number in the order of the slip, backward first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
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

impl<S: Scalar> FrictionLaw<S> for Friction<S> {
    #[inline(always)]
    fn ratio(&self, branch: Branch, slip: S, inner: S) -> Sloped<S> {
        each_friction!(self, law => law.ratio(branch, slip, inner))
    }

    fn branch(&self, slip: S, acceleration: S) -> Branch {
        each_friction!(self, law => law.branch(slip, acceleration))
    }

    #[inline(always)]
    fn edges(&self, branch: Branch) -> (S, S) {
        each_friction!(self, law => law.edges(branch))
    }

    fn beyond(&self, branch: Branch, upward: bool, slip: S) -> Branch {
        each_friction!(self, law => law.beyond(branch, upward, slip))
    }

    #[inline(always)]
    fn slip_scale(&self) -> S {
        each_friction!(self, law => law.slip_scale())
    }

    fn inner_scale(&self) -> Option<f64> {
        each_friction!(self, law => law.inner_scale())
    }

    #[inline(always)]
    fn inner_rate(&self, branch: Branch, slip: S, inner: S) -> Sloped<S> {
        each_friction!(self, law => law.inner_rate(branch, slip, inner))
    }

    fn ramp(&self) -> Option<Ramp> {
        each_friction!(self, law => law.ramp())
    }

    fn limit(&self) -> S {
        each_friction!(self, law => law.limit())
    }
}

/// Steps of a decade in which the slip is looked for that bears a load.
const STEPS_OF_A_DECADE: i32 = 20;

impl Friction<f64> {
    /// The slip (m/s) at which a joint creeps under a tangential load of so much of the normal force:
    /// the slowest with that much friction. `None` where the law holds the load by what it remembers,
    /// and where it cannot bear it at any slip.
    pub fn creep(&self, load: f64) -> Option<f64> {
        if self.inner_scale().is_some() {
            return None;
        }
        let bears = |slip: f64| self.ratio(self.branch(slip, 0.0), slip, 0.0).value.abs() >= load;
        let scale = self.slip_scale();
        let at = |step: i32| scale * 10_f64.powf(f64::from(step) / f64::from(STEPS_OF_A_DECADE));
        let found =
            (-9 * STEPS_OF_A_DECADE..=4 * STEPS_OF_A_DECADE).find(|step| bears(at(*step)))?;
        let (mut slow, mut fast) = (at(found - 1), at(found));
        for _ in 0..60 {
            let middle = f64::midpoint(slow, fast);
            if bears(middle) { fast = middle } else { slow = middle }
        }
        Some(fast)
    }
}

/// The one branch of a law that has no edge.
const WHOLE: Branch = Branch(0);

/// The edges of a branch that has none (m/s).
fn endless<S: Scalar>() -> (S, S) {
    let far = S::from_f64(f64::INFINITY);
    (-far, far)
}

/// The key that all laws have.
const COEFFICIENT: Key = Key {
    name: "coefficient",
    takes: Takes::Number(Range::NotNegative),
    unit: "",
    otherwise: Otherwise::Required,
    about: "friction coefficient c_f of sliding; zero means no friction",
};

/// Friction of rest is no less than that of sliding.
fn rest_holds(values: &Values) -> Vec<(&'static str, String)> {
    let both = values.decimal("coefficient").zip(values.decimal("static"));
    let wrong = both.filter(|(sliding, rest)| rest.to_f64() < sliding.to_f64());
    let complaint = |(sliding, rest)| {
        ("static", format!("must be at least the coefficient, {sliding}, is {rest}"))
    };
    wrong.map(complaint).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameter::{Kind, Value};
    use crate::scalar::Decimal;
    use toml_edit::DocumentMut;

    /// The law of a kind's own example.
    fn example(kind: &'static Kind) -> Friction<f64> {
        let document: DocumentMut = kind.example.parse().unwrap();
        let table = &document["joints"]["A"]["clearance"]["friction"];
        let values = kind.keys.iter().fold(Values::new(kind), |values, key| {
            let given = table.get(key.name).map(|value| value.to_string());
            let text = match (given, key.otherwise) {
                (Some(text), _) => text,
                (None, Otherwise::Default(text)) => text.to_owned(),
                (None, _) => return values,
            };
            values.with(key.name, Value::Number(Decimal::new(text.trim()).unwrap()))
        });
        Friction::new(&values, &Ends { hysteresis: 1e-7 }).unwrap()
    }

    #[test]
    fn laws_that_remember_hold_and_others_creep_where_their_formulas_say() {
        // under half of μ = 0.1
        let known = |word: &str| match word {
            "dahl" | "lugre" | "elasto-plastic" => None,
            "ambrosio" => Some(1e-3 + 0.5 * 9e-3),
            "tanh" => Some(1e-3 * 0.5_f64.atanh()),
            "threlfall" => Some(1e-3 * 2_f64.ln() / 3.0),
            // 0.05 = 0.15 [1 − (1 − x)²]
            "bengisu-akay" => Some(1e-3 * (1.0 - (2.0_f64 / 3.0).sqrt())),
            _ => Some(f64::NAN),
        };
        for kind in KINDS.iter().filter(|kind| kind.word != "thick") {
            let (found, expected) = (example(kind).creep(0.05), known(kind.word));
            match (found, expected) {
                (Some(found), Some(expected)) if expected.is_finite() => {
                    assert!((found / expected - 1.0).abs() < 1e-6, "{}: {found}", kind.word);
                }
                _ => assert_eq!(found.is_some(), expected.is_some(), "{}", kind.word),
            }
            let unbearable = example(kind).creep(1e3);
            assert_eq!(unbearable, None, "{}", kind.word);
        }
    }
}
