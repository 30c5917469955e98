//! Tangential-force laws, one file a law.
//!
//! A law gives F_T/F_N by branch: a piece of it that goes on smoothly beyond its edges, so that an
//! engine which restarts where the slip passes an edge meets no kink. A law may remember something:
//! inner states z, with rates of their own, which may have a say in where a branch ends. Signs are the same everywhere: F_T acts on the journal
//! along t, and opposes a positive slip where it is negative.
//!
//! A new law is a file here and its line in the list of kinds.

use crate::parameter::{Key, Range, Takes, Values, kinds};
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

mod pieces;

pub use ambrosio::Ramp;

kinds! { $
    /// A friction law of any kind.
    #[derive(Copy)]
    Friction, each_friction:
    Ambrosio in ambrosio,
    Dahl in dahl,
    LuGre in lugre,
    ElastoPlastic in elasto_plastic,
    Gonthier in gonthier,
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

/// Inner states that a law may have.
pub const MOST_INNER: usize = 2;

/// The inner states of a law, each in its own unit; those that it has not are zero. The first is a
/// deflection (m).
pub type Inner<S> = [S; MOST_INNER];

/// A function of slip and inner states, with its partial derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sloped<S> {
    /// Its value.
    pub value: S,
    /// Its derivative by the slip (over m/s).
    pub d_slip: S,
    /// Its derivatives by the inner states (over each state's unit).
    pub d_inner: Inner<S>,
}

impl<S: Scalar> Sloped<S> {
    /// Zero, whatever slip and inner states are.
    pub fn none() -> Self {
        Sloped { value: S::zero(), d_slip: S::zero(), d_inner: [S::zero(); MOST_INNER] }
    }

    /// A function of the slip alone.
    pub fn by_slip(value: S, d_slip: S) -> Self {
        Sloped { value, d_slip, ..Sloped::none() }
    }

    /// A function of the slip and the first inner state.
    pub fn by_deflection(value: S, d_slip: S, d_deflection: S) -> Self {
        Sloped { value, d_slip, d_inner: [d_deflection, S::zero()] }
    }

    /// Of the other sign.
    pub fn negative(self) -> Self {
        Sloped {
            value: -self.value,
            d_slip: -self.d_slip,
            d_inner: self.d_inner.map(|slope| -slope),
        }
    }

    /// Its rate in time, from those of slip (m/s²) and inner states.
    pub fn rate(&self, slip: S, inner: Inner<S>) -> S {
        let remembered = self.d_inner.iter().zip(inner);
        remembered.fold(self.d_slip * slip, |sum, (slope, rate)| sum + *slope * rate)
    }
}

/// What a friction law tells.
pub trait FrictionLaw<S: Scalar> {
    /// F_T/F_N of a branch, at a slip (m/s) and inner states.
    fn ratio(&self, branch: Branch, slip: S, inner: Inner<S>) -> Sloped<S>;

    /// The branch of a slip (m/s) with inner states of zero, about whose past nothing is known; on
    /// an edge the one that the slip's acceleration (m/s²) leads into.
    fn branch(&self, slip: S, acceleration: S) -> Branch;

    /// The slips (m/s) at which a branch is left, below and above; infinite where it has no edge.
    fn edges(&self, branch: Branch) -> (S, S);

    /// Number of edges in which inner states have a say.
    fn inner_edges(&self) -> u8 {
        0
    }

    /// How far a branch is from one of these, of order one; negative beyond it. `None` where the
    /// branch has no such edge, whatever slip and inner states are.
    fn inner_edge(&self, branch: Branch, edge: u8, slip: S, inner: Inner<S>) -> Option<Sloped<S>> {
        let _ = (branch, edge, slip, inner);
        None
    }

    /// The branch after `branch` was left through one of these.
    fn across(&self, branch: Branch, edge: u8) -> Branch {
        let _ = edge;
        branch
    }

    /// The branch after `branch` was left at `slip` (m/s) through its upper or its lower edge.
    fn beyond(&self, branch: Branch, upward: bool, slip: S) -> Branch;

    /// A slip (m/s) that is of order one: edges are watched in units of it.
    fn slip_scale(&self) -> S;

    /// Typical sizes of the inner states, [`MOST_INNER`] at most; none where the law remembers
    /// nothing.
    fn inner_scales(&self) -> Vec<f64> {
        Vec::new()
    }

    /// ż of a branch, at a slip (m/s) and inner states.
    fn inner_rates(&self, branch: Branch, slip: S, inner: Inner<S>) -> [Sloped<S>; MOST_INNER] {
        let _ = (branch, slip, inner);
        [Sloped::none(); MOST_INNER]
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
    fn ratio(&self, branch: Branch, slip: S, inner: Inner<S>) -> Sloped<S> {
        each_friction!(self, law => law.ratio(branch, slip, inner))
    }

    fn branch(&self, slip: S, acceleration: S) -> Branch {
        each_friction!(self, law => law.branch(slip, acceleration))
    }

    #[inline(always)]
    fn edges(&self, branch: Branch) -> (S, S) {
        each_friction!(self, law => law.edges(branch))
    }

    fn inner_edges(&self) -> u8 {
        each_friction!(self, law => law.inner_edges())
    }

    fn inner_edge(&self, branch: Branch, edge: u8, slip: S, inner: Inner<S>) -> Option<Sloped<S>> {
        each_friction!(self, law => law.inner_edge(branch, edge, slip, inner))
    }

    fn across(&self, branch: Branch, edge: u8) -> Branch {
        each_friction!(self, law => law.across(branch, edge))
    }

    fn beyond(&self, branch: Branch, upward: bool, slip: S) -> Branch {
        each_friction!(self, law => law.beyond(branch, upward, slip))
    }

    #[inline(always)]
    fn slip_scale(&self) -> S {
        each_friction!(self, law => law.slip_scale())
    }

    fn inner_scales(&self) -> Vec<f64> {
        each_friction!(self, law => law.inner_scales())
    }

    #[inline(always)]
    fn inner_rates(&self, branch: Branch, slip: S, inner: Inner<S>) -> [Sloped<S>; MOST_INNER] {
        each_friction!(self, law => law.inner_rates(branch, slip, inner))
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

impl<S: Scalar> Friction<S> {
    /// Whether the law holds a load at rest, by what it remembers.
    pub fn remembers(&self) -> bool {
        !self.inner_scales().is_empty()
    }
}

impl Friction<f64> {
    /// The slip (m/s) at which a joint creeps under a tangential load of so much of the normal force:
    /// the slowest with that much friction. `None` where the law holds the load by what it remembers,
    /// and where it cannot bear it at any slip.
    pub fn creep(&self, load: f64) -> Option<f64> {
        if self.remembers() {
            return None;
        }
        let force = |slip: f64| self.ratio(self.branch(slip, 0.0), slip, [0.0; MOST_INNER]).value;
        let bears = |slip: f64| force(slip).abs() >= load;
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

/// F_T/F_N and ż of a law with one inner state.
#[cfg(test)]
fn bristle<S: Scalar>(law: &impl FrictionLaw<S>, at: (Branch, S, S)) -> [Sloped<S>; 2] {
    let (branch, slip, z) = at;
    let inner = [z, S::zero()];
    [law.ratio(branch, slip, inner), law.inner_rates(branch, slip, inner)[0]]
}

/// The key that all laws have.
const COEFFICIENT: Key = Key::new(
    "coefficient",
    Takes::Number(Range::NotNegative),
    "",
    "friction coefficient c_f of sliding; zero means no friction",
);

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
    use crate::parameter::{Kind, Otherwise, Value};
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
            "dahl" | "lugre" | "elasto-plastic" | "gonthier" => None,
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
