//! Gas force on a slider: a pressure that depends on where it stands.
//! ```text
//! F = A p(x)   (N, along the axis on the second body of the guide, −F on the first)
//! ```
//! with the travel x of a prismatic joint and the spline p through given pressures (gauge, against
//! what is on the other side of the piston); before the first position and behind the last they keep
//! the first and the last. A positive pressure pushes towards larger x; a negative area turns that
//! round. Where x passes a knot of the spline its fifth derivative jumps, at the first and the last the
//! first does: the engines begin anew there, and until then the polynomial of the span goes on.
//!
//! What it does counts as work of loads.

use super::{Acts, Ends, Gate, Powers};
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

/// Roundings by which a travel may be off a knot that it is on.
const ON_THE_KNOT: f64 = 8.0;

/// The gas: pressure (Pa) by travel (m), area (m²), and the guide.
#[derive(Debug, Clone)]
pub struct GasForce<S> {
    pressure: Spline<S>,
    area: S,
    guide: Option<Prismatic<S>>,
    /// The span of the spline that an engine is in; `None` for that of the travel.
    span: Option<usize>,
}

impl<S: Scalar> GasForce<S> {
    /// The gas that these values describe.
    pub fn new(values: &Values, ends: &Ends<S>) -> Self {
        let guide = match ends.joint {
            Some((_, Relation::Prismatic(guide))) => Some(guide),
            _ => None,
        };
        GasForce { pressure: Spline::of(values), area: values.number("area"), guide, span: None }
    }

    /// The force (N) along the axis of a guide.
    fn force<T: Lift<S>>(&self, guide: &Prismatic<S>, [i, j]: &[Pose<T>; 2]) -> T {
        let travel = guide.travel(&[*i, *j, Pose::fixed()]);
        let pressure = match self.span {
            Some(span) => self.pressure.at_span(span, travel),
            None => self.pressure.at(travel)[0],
        };
        T::lift(self.area) * pressure
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

    fn has_gate(&self) -> bool {
        self.guide.is_some()
    }

    fn gate(&self, poses: &[Pose<S>; 2], motions: &[Motion<S>; 2]) -> Option<Gate<S>> {
        let (guide, span) = (self.guide.as_ref()?, self.span?);
        let travel = guide.travel(&[poses[0], poses[1], Pose::fixed()]);
        let knots = self.pressure.knots();
        let size = knots[knots.len() - 1] - knots[0];
        let [below, above] = self.pressure.ends(span);
        Some(Gate {
            above: below.map(|knot| (travel - knot) / size),
            below: above.map(|knot| (knot - travel) / size),
            rate: guide.rate(poses, motions) / size,
            reach: (poses[0].position.norm() + poses[1].position.norm()) / size,
        })
    }

    fn pass(&mut self, poses: &[Pose<S>; 2], motions: &[Motion<S>; 2]) {
        let Some(guide) = &self.guide else { return };
        let travel = guide.travel(&[poses[0], poses[1], Pose::fixed()]);
        let span = self.pressure.span(travel);
        let [behind, _] = self.pressure.ends(span);
        // on a knot it is on the side that it goes to
        let size = poses[0].position.norm() + poses[1].position.norm();
        let rounding = S::from_f64(ON_THE_KNOT * S::EPSILON) * size;
        let leaves = behind.is_some_and(|knot| travel - knot <= rounding)
            && guide.rate(poses, motions) < S::zero();
        self.span = Some(if leaves { span - 1 } else { span });
    }

    fn pass_one(&mut self, ahead: bool) {
        self.span = self.span.map(|span| if ahead { span + 1 } else { span.saturating_sub(1) });
    }

    fn pace(&self, mass: f64, _: f64) -> f64 {
        let knots = self.pressure.knots();
        let steep = |x: &S| self.pressure.at(*x)[1].abs().to_f64();
        let steepest = knots.iter().map(steep).fold(0.0, f64::max);
        (self.area.to_f64().abs() * steepest / mass).sqrt()
    }
}
