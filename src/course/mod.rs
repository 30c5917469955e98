//! Courses: prescribed functions of time with two derivatives, in any arithmetic, one file a kind.
//! Drives prescribe angles and travels by them, loads torques and forces.

use crate::parameter::{Key, Kind, Range, Takes, Values, kinds};
use crate::scalar::{Decimal, F256, Scalar};

kinds! { $
    /// The function of a course of any kind.
    Shape, each_shape:
    Constant in constant,
    Speed in speed,
    Ramp in ramp,
    Harmonic in harmonic,
    Table in table,
    #[cfg(test)]
    Scratch in scratch,
}

mod spline;

pub use spline::Spline;
pub(crate) use spline::points;

/// The kind that a plain number stands for.
pub const CONSTANT: &Kind = &constant::KIND;

/// The word of the kind that goes through given values.
pub const TABLE: &str = table::KIND.word;

/// What a course is made of beside its values: nothing.
#[derive(Debug, Clone, Copy)]
pub struct Ends<S>(std::marker::PhantomData<S>);

/// A function of time f(t).
pub trait Law<S: Scalar>: Clone {
    /// f(t), ḟ(t) and f̈(t) (units of f, per s, per s²).
    fn at(&self, time: S) -> [S; 3];

    /// An angle f(t) (rad) less whole turns, to the last place of the arithmetic however long the
    /// run.
    fn wrapped(&self, time: S) -> S {
        self.at(time)[0]
    }

    /// Whether f̈ is anything but zero.
    fn accelerates(&self) -> bool {
        true
    }

    /// The largest |ḟ| (per s), or an estimate of it.
    fn fastest(&self) -> f64;

    /// Time (s) after which the motion repeats itself: a revolution, a period; `None` if it never
    /// does.
    fn period(&self) -> Option<f64>;

    /// Time (s) after which there is nothing new to be seen; `None` where nothing moves.
    fn all(&self) -> Option<f64> {
        self.period()
    }

    /// Times (s) at which a derivative of f jumps, in their order; the engines begin anew there.
    fn corners(&self) -> &[S] {
        &[]
    }

    /// The largest |f| of the first period, or of the first second.
    fn size(&self) -> f64 {
        let span = self.period().unwrap_or(1.0);
        let at = |k: i32| self.at(S::from_f64(span * f64::from(k) / 16.0))[0].to_f64().abs();
        (0..=16).map(at).fold(0.0, f64::max)
    }
}

/// A course: its function, and where that stands at t = 0.
#[derive(Debug, Clone)]
pub struct Course<S> {
    shape: Shape<S>,
    /// Time (s) of the function at t = 0.
    clock: S,
    corners: Vec<S>,
}

impl<S: Scalar> Course<S> {
    fn new(shape: Shape<S>) -> Self {
        let corners = each_shape!(&shape, law => law.corners()).to_vec();
        Course { shape, clock: S::zero(), corners }
    }

    /// The same course, `clock` (s) further on at t = 0: f(t + clock).
    pub fn ahead(self, clock: S) -> Self {
        let corners = self.corners.iter().map(|corner| *corner - clock);
        Course { corners: corners.collect(), clock: self.clock + clock, ..self }
    }

    /// The course that these values describe.
    pub fn of(values: &Values) -> Option<Self> {
        Shape::new(values, &Ends(std::marker::PhantomData)).map(Course::new)
    }

    /// The course of a key of other values.
    pub fn of_key(values: &Values, key: &str) -> Self {
        let course = values.part(key).and_then(Course::of);
        course.unwrap_or(Course::constant(S::from_f64(f64::NAN)))
    }

    /// The course that does not change.
    pub fn constant(value: S) -> Self {
        Course::new(Shape::Constant(Constant::always(value)))
    }

    /// The largest |f|, or an estimate of it.
    pub fn size(&self) -> f64 {
        each_shape!(&self.shape, law => law.size())
    }

    /// f(t), ḟ(t) and f̈(t).
    #[inline(always)]
    pub fn at(&self, time: S) -> [S; 3] {
        each_shape!(&self.shape, law => law.at(time + self.clock))
    }

    /// An angle f(t) (rad) less whole turns.
    #[inline(always)]
    pub fn wrapped(&self, time: S) -> S {
        each_shape!(&self.shape, law => law.wrapped(time + self.clock))
    }

    /// ḟ(t).
    #[inline(always)]
    pub fn rate(&self, time: S) -> S {
        self.at(time)[1]
    }

    /// Whether f̈ is anything but zero.
    pub fn accelerates(&self) -> bool {
        each_shape!(&self.shape, law => law.accelerates())
    }

    /// The largest |ḟ| (per s), or an estimate of it.
    pub fn fastest(&self) -> f64 {
        each_shape!(&self.shape, law => law.fastest())
    }

    /// Time (s) after which the motion repeats itself, if it does.
    pub fn period(&self) -> Option<f64> {
        each_shape!(&self.shape, law => law.period())
    }

    /// Time (s) after which there is nothing new to be seen; `None` where nothing moves.
    pub fn all(&self) -> Option<f64> {
        each_shape!(&self.shape, law => law.all())
    }

    /// Angular frequency (rad/s) of a course that swings; none of one that goes evenly.
    pub fn pace(&self) -> Option<f64> {
        self.accelerates().then(|| self.period().map(|period| std::f64::consts::TAU / period))?
    }

    /// Times (s) at which a derivative of f jumps, in their order; those behind a start that is ahead
    /// are negative.
    pub fn corners(&self) -> &[S] {
        &self.corners
    }
}

/// A rate as a case writes it, and what its arithmetic leaves of it, so that angles keep their
/// places however long the run.
#[derive(Debug, Clone, Copy)]
struct Rate<S> {
    rate: S,
    tail: f64,
}

impl<S: Scalar> Rate<S> {
    /// Revolutions a minute, in rad/s.
    fn of_rpm(rpm: &Decimal) -> Self {
        let rate = rpm.value::<S>() * (S::pi() / S::from_f64(30.0));
        Rate::new(rate, rpm.value::<F256>() * F256::pi() / F256::from(30))
    }

    /// A rate in the units of the course, per s.
    fn of(rate: &Decimal) -> Self {
        Rate::new(rate.value(), rate.value())
    }

    fn new(rate: S, exact: F256) -> Self {
        Rate { rate, tail: (exact - F256::from(rate.to_f64())).to_f64() }
    }

    /// The rate of keys that give it as `speed_rpm` or as `velocity`, and the value at t = 0.
    fn and_start(values: &Values) -> (Self, S) {
        let of = |key, rate: fn(&Decimal) -> Self| values.decimal(key).map(rate);
        let start = values.decimal("angle").or(values.decimal("position"));
        let rate = of("velocity", Rate::of).or_else(|| of("speed_rpm", Rate::of_rpm));
        let rate = rate.unwrap_or(Rate { rate: S::from_f64(f64::NAN), tail: 0.0 });
        (rate, start.map_or(S::zero(), Decimal::value))
    }

    /// Rate times time, less whole turns.
    #[inline(always)]
    fn phase(&self, time: S) -> S {
        S::phase(self.rate, self.tail, time)
    }
}

/// Time (s) of a turn at a rate (rad/s); `None` where nothing turns.
fn turn(rate: f64) -> Option<f64> {
    (rate != 0.0).then(|| std::f64::consts::TAU / rate.abs())
}

/// The keys of a course that goes at a speed: that of an angle, or that of a travel.
const SPEED_RPM: Key = Key::new(
    "speed_rpm",
    Takes::Number(Range::Any),
    "revolutions a minute",
    "speed of an angle; a travel has `velocity`",
)
.optional();
const ANGLE: Key = Key::new(
    "angle",
    Takes::Number(Range::Any),
    "rad",
    "angle at t = 0; zero where it is left out",
)
.optional();
const VELOCITY: Key =
    Key::new("velocity", Takes::Number(Range::Any), "m/s", "speed of a travel").optional();
const POSITION: Key = Key::new(
    "position",
    Takes::Number(Range::Any),
    "m",
    "travel at t = 0; zero where it is left out",
)
.optional();
