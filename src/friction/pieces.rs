//! Pieces of a law that go by the slip alone, parted by edges at which the law has a kink.
//!
//! A slip that decays onto an edge must not cross it again and again on rounding errors: on its way
//! towards zero, and across it, an edge lies further on by the hysteresis. Neighbours differ there by
//! the order of the hysteresis, for a time of the same order, so the trajectory is changed by its
//! square.

use super::Branch;
use crate::scalar::Scalar;

/// N edges in rising order, and N + 1 pieces between and beyond them.
#[derive(Debug, Clone, Copy)]
pub struct Pieces<S, const N: usize> {
    edges: [S; N],
    hysteresis: S,
}

impl<S: Scalar, const N: usize> Pieces<S, N> {
    /// Pieces between these slips (m/s), which do not fall; the hysteresis is a slip too.
    pub fn new(edges: [S; N], hysteresis: S) -> Self {
        Pieces { edges, hysteresis }
    }

    /// The slips (m/s) at which a piece is left, below and above; infinite where it has no edge.
    #[inline(always)]
    pub fn edges(&self, Branch(piece): Branch) -> (S, S) {
        let (far, zero) = (S::from_f64(f64::INFINITY), S::zero());
        let piece = usize::from(piece);
        let below = piece.checked_sub(1).map(|edge| self.edges[edge]);
        let above = self.edges.get(piece).copied();
        let lower = below.map_or(-far, |edge| match edge >= zero && above != Some(edge) {
            true => edge - self.hysteresis,
            false => edge,
        });
        let upper = above.map_or(far, |edge| match edge <= zero && below != Some(edge) {
            true => edge + self.hysteresis,
            false => edge,
        });
        (lower, upper)
    }

    /// Whether a piece holds no more than one slip.
    fn is_empty(&self, piece: usize) -> bool {
        piece > 0 && piece < N && self.edges[piece - 1] == self.edges[piece]
    }

    /// The piece of a slip (m/s) about whose past nothing is known. Neighbours overlap by the
    /// hysteresis; there it is the one that the slip's acceleration (m/s²) leads into, for an
    /// event function that is zero at a restart never passes zero.
    pub fn branch(&self, slip: S, acceleration: S) -> Branch {
        let holds = |piece: &usize| {
            let (lower, upper) = self.edges(Branch(*piece as u8));
            lower <= slip && slip <= upper && !self.is_empty(*piece)
        };
        // without an acceleration, the one on this side of zero
        let upward = match acceleration == S::zero() {
            true => slip < S::zero(),
            false => acceleration > S::zero(),
        };
        let mut pieces = 0..=N;
        let piece = if upward { pieces.rfind(holds) } else { pieces.find(holds) };
        Branch(piece.unwrap_or(N) as u8)
    }

    /// The piece after `branch` was left at `slip` (m/s) through its upper or its lower edge, or
    /// one further that way. Never back: an edge that was met counts as passed, on whichever side
    /// of it the errors of the slip have left it.
    pub fn beyond(&self, Branch(piece): Branch, upward: bool, slip: S) -> Branch {
        let mut piece = usize::from(piece);
        let edges = |piece: usize| self.edges(Branch(piece as u8));
        if upward {
            piece = (piece + 1).min(N);
            while piece < N && (self.is_empty(piece) || slip > edges(piece).1) {
                piece += 1;
            }
        } else {
            piece = piece.saturating_sub(1);
            while piece > 0 && (self.is_empty(piece) || slip < edges(piece).0) {
                piece -= 1;
            }
        }
        Branch(piece as u8)
    }
}
