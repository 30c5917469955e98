//! Course through given values: the interpolating spline of the fifth degree.
//! ```text
//! f(t_i) = f_i,   four derivatives continuous;   before the first time f_1, behind the last f_n
//! ```
//! Its knots are times at which the engines begin anew. What a drive prescribes must be given for the
//! whole run; a torque or a force keeps the first and the last value outside of the table.
//!
//! Source: see `spline.rs`.

use super::{Ends, Law, Spline};
use crate::parameter::{Key, Kind, Takes, Values};
use crate::scalar::Scalar;

/// The kind and its keys.
pub const KIND: Kind = Kind {
    word: "table",
    title: "goes through given values, by a spline of the fifth degree",
    source: "C. de Boor, A Practical Guide to Splines, Springer 2001",
    example: r#"[drives.crank]
joint = "A0"
kind = "table"
times = [0.0, 0.01, 0.02, 0.03, 0.04]    # or file = "motion.csv", with a column of times and one of values
values = [0.0, 0.1, 0.4, 0.9, 1.6]"#,
    keys: &[
        Key::new("times", Takes::Numbers, "s", "times, which increase; a drive's are from 0 or before to the end of the run").optional(),
        Key::new("values", Takes::Numbers, "", "values there, in the unit of what follows them (rad, m, N, N m)").optional(),
        Key::new("file", Takes::File, "", "in place of times and values: a file beside the case, a time and a value a line").optional(),
    ],
    also: Some(super::points),
};

/// The spline, and the first and the last of its times (s).
#[derive(Debug, Clone)]
pub struct Table<S>(Spline<S>);

impl<S: Scalar> Table<S> {
    /// The course that these values describe.
    pub fn new(values: &Values, _: &Ends<S>) -> Self {
        Table(Spline::of(values))
    }
}

impl<S: Scalar> Table<S> {
    /// The largest of something over the knots and the middles between them.
    fn largest(&self, of: impl Fn(S) -> S) -> f64 {
        let knots = self.0.knots();
        let middles = knots.windows(2).map(|pair| (pair[0] + pair[1]) * S::ratio(1, 2));
        middles.chain(knots.iter().copied()).map(|t| of(t).to_f64().abs()).fold(0.0, f64::max)
    }
}

impl<S: Scalar> Law<S> for Table<S> {
    fn at(&self, time: S) -> [S; 3] {
        let [value, rate, bend] = self.0.at(time);
        match self.0.covers(time) {
            true => [value, rate, bend],
            false => [value, S::zero(), S::zero()],
        }
    }

    fn fastest(&self) -> f64 {
        self.largest(|time| self.0.at(time)[1])
    }

    fn period(&self) -> Option<f64> {
        None
    }

    fn all(&self) -> Option<f64> {
        self.0.knots().last().map(|last| last.to_f64())
    }

    fn corners(&self) -> &[S] {
        self.0.knots()
    }

    fn size(&self) -> f64 {
        self.largest(|time| self.0.at(time)[0])
    }
}
