//! Vectors, poses and motions in the plane.

use crate::scalar::{Lift, Scalar};
use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

/// A vector in the plane; in the fixed frame unless its owner says otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vector<S> {
    /// Component along the fixed x axis.
    pub x: S,
    /// Component along the fixed y axis.
    pub y: S,
}

impl<S: Scalar> Vector<S> {
    /// The vector (x, y).
    #[inline(always)]
    pub fn new(x: S, y: S) -> Self {
        Vector { x, y }
    }

    /// The vector without length.
    #[inline(always)]
    pub fn zero() -> Self {
        Vector::new(S::zero(), S::zero())
    }

    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> S {
        self.x * other.x + self.y * other.y
    }

    /// The out-of-plane component of the vector product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> S {
        self.x * other.y - self.y * other.x
    }

    /// The vector turned by +90°; times an angular rate, the velocity of a turning arm.
    #[inline(always)]
    pub fn turned(self) -> Self {
        Vector::new(-self.y, self.x)
    }

    /// Length.
    #[inline(always)]
    pub fn norm(self) -> S {
        self.dot(self).sqrt()
    }
}

impl<S: Scalar> Add for Vector<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Vector::new(self.x + other.x, self.y + other.y)
    }
}

impl<S: Scalar> Sub for Vector<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Vector::new(self.x - other.x, self.y - other.y)
    }
}

impl<S: Scalar> Neg for Vector<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Vector::new(-self.x, -self.y)
    }
}

impl<S: Scalar> Mul<S> for Vector<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: S) -> Self {
        Vector::new(self.x * factor, self.y * factor)
    }
}

impl<S: Scalar> AddAssign for Vector<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Scalar> SubAssign for Vector<S> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

/// Where a body is: its mass centre (m), its angle (rad), and the angle's cosine and sine, which
/// an engine may integrate instead of calling them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose<S> {
    /// Mass centre (m).
    pub position: Vector<S>,
    /// Angle of the body's frame (rad).
    pub angle: S,
    /// Cosine of the angle.
    pub cos: S,
    /// Sine of the angle.
    pub sin: S,
}

impl<S: Scalar> Pose<S> {
    /// The pose with this mass centre (m) and angle (rad).
    #[inline(always)]
    pub fn new(position: Vector<S>, angle: S) -> Self {
        let (sin, cos) = angle.sin_cos();
        Pose { position, angle, cos, sin }
    }

    /// The fixed frame.
    pub fn fixed() -> Self {
        Pose { position: Vector::zero(), angle: S::zero(), cos: S::one(), sin: S::zero() }
    }

    /// A vector of the body's frame, seen in the fixed frame.
    #[inline(always)]
    pub fn rotate(&self, v: Vector<S>) -> Vector<S> {
        Vector::new(self.cos * v.x - self.sin * v.y, self.sin * v.x + self.cos * v.y)
    }

    /// The same of a vector of parameters, in a poorer arithmetic.
    #[inline(always)]
    pub fn carry<P: Scalar>(&self, v: Vector<P>) -> Vector<S>
    where
        S: Lift<P>,
    {
        let (cos, sin) = (self.cos, self.sin);
        Vector::new(cos.times(v.x) - sin.times(v.y), sin.times(v.x) + cos.times(v.y))
    }
}

/// How a body moves: velocity of its mass centre (m/s) and angular rate (rad/s); or, in the same
/// shape, its accelerations (m/s², rad/s²).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion<S> {
    /// Of the mass centre.
    pub linear: Vector<S>,
    /// Of the angle.
    pub angular: S,
}

impl<S: Scalar> Motion<S> {
    /// No motion.
    pub fn rest() -> Self {
        Motion { linear: Vector::zero(), angular: S::zero() }
    }

    /// Velocity (m/s) of the point at the end of `arm` (fixed frame, from the mass centre).
    #[inline(always)]
    pub fn at(&self, arm: Vector<S>) -> Vector<S> {
        self.linear + arm.turned() * self.angular
    }
}

/// A force (N) and its moment (N m) about a body's mass centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrench<S> {
    /// Force (N).
    pub force: Vector<S>,
    /// Moment about the mass centre (N m), counter-clockwise.
    pub moment: S,
}

impl<S: Scalar> Wrench<S> {
    /// No load.
    pub fn none() -> Self {
        Wrench { force: Vector::zero(), moment: S::zero() }
    }

    /// The wrench of a force (N) at the end of `arm` (fixed frame, from the mass centre).
    #[inline(always)]
    pub fn at(arm: Vector<S>, force: Vector<S>) -> Self {
        Wrench { force, moment: arm.cross(force) }
    }
}

impl<S: Scalar> AddAssign for Wrench<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.force += other.force;
        self.moment += other.moment;
    }
}
