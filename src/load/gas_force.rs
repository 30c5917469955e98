//! Gas force on a slider: a pressure that depends on where it stands.
//! ```text
//! F = A p(x)   (N, along the axis on the second body of the guide, −F on the first)
//! ```
//! with the travel x of a prismatic joint and the spline p through given pressures (gauge, against
//! what is on the other side of the piston); before the first position and behind the last they keep
//! the first and the last. A positive pressure pushes towards larger x; a negative area turns that
//! round. Where x passes a knot of the spline its fifth derivative jumps, and engines are not told:
//! many digits take many steps there.
//!
//! What it does counts as work of loads.

use super::{Acts, Ends, Powers};
use crate::course::{Spline, points};
use crate::joint::{PRISMATIC, Prismatic, Relation};
use crate::parameter::{Key, Kind, Range, Takes, Values};
use crate::plane::{Motion, Pose, Wrench};
use crate::scalar::{Lift, Scalar};

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "gas-force",
    title: "a gas pushes a slider, with a pressure that depends on its travel",
    source: "",
    example: r#"[loads.gas]
kind = "gas-force"
joint = "guide"
area = 5e-3
positions = [0.07, 0.08, 0.09, 0.1, 0.12, 0.14, 0.17]   # or file = "pressure.csv"
pressures = [0.0, 0.2e5, 0.5e5, 1.0e5, 2.6e5, 6.5e5, 20e5]"#,
    keys: &[
        Key::new("positions", Takes::Numbers, "m", "travels of the slider, which increase").optional(),
        Key::new("pressures", Takes::Numbers, "Pa", "pressures there").optional(),
        Key::new("file", Takes::File, "", "in place of both: a file beside the case, a travel and a pressure a line").optional(),
        Key::new("joint", Takes::Joint(&[PRISMATIC]), "", "the prismatic joint that the slider moves in"),
        Key::new("area", Takes::Number(Range::NotZero), "m²", "A; negative where the gas pushes towards smaller travels"),
    ],
    also: Some(points),
};

/// The gas: pressure (Pa) by travel (m), area (m²), and the guide.
#[derive(Debug, Clone)]
pub struct GasForce<S> {
    pressure: Spline<S>,
    area: S,
    guide: Option<Prismatic<S>>,
}

impl<S: Scalar> GasForce<S> {
    /// The gas that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let guide = match ends.joint {
            Some((_, Relation::Prismatic(guide))) => Some(guide),
            _ => None,
        };
        GasForce { pressure: Spline::of(values), area: values.number("area"), guide }
    }

    /// The force (N) along the axis of a guide.
    fn force<T: Lift<S>>(&self, guide: &Prismatic<S>, [i, j]: &[Pose<T>; 2]) -> T {
        T::lift(self.area) * self.pressure.at(guide.travel(&[*i, *j, Pose::fixed()]))[0]
    }
}

impl<S: Scalar> Acts<S> for GasForce<S> {
    fn wrenches<T: Lift<S>>(
        &self,
        _: S,
        poses: &[Pose<T>; 2],
        _: &[Motion<T>; 2],
    ) -> [Wrench<T>; 2] {
        match &self.guide {
            Some(guide) => guide.pushed(self.force(guide, poses), poses),
            None => [Wrench::none(); 2],
        }
    }

    fn powers(&self, _: S, poses: &[Pose<S>; 2], motions: &[Motion<S>; 2]) -> Powers<S> {
        let work = |guide: &Prismatic<S>| self.force(guide, poses) * guide.rate(poses, motions);
        let work = self.guide.as_ref().map_or(S::zero(), work);
        Powers { work, dissipation: S::zero() }
    }

    fn pace(&self, mass: f64, _: f64) -> f64 {
        let knots = self.pressure.knots();
        let steep = |x: &S| self.pressure.at(*x)[1].abs().to_f64();
        let steepest = knots.iter().map(steep).fold(0.0, f64::max);
        (self.area.to_f64().abs() * steepest / mass).sqrt()
    }
}
