//! Where a block lies in its guide under a load: on one wall with both corners, or tilted, on both with
//! one corner each.
//!
//! With y how far the block's centre is off the guide's line and φ its tilt, a corner at x along and
//! s H/2 across has come towards its wall by
//! ```text
//! e = s (y + x sin φ) − (H/2) (1 − cos φ)
//! ```
//! A force F_n across the guide and a moment M on the block, from the guide, take from two corners of
//! one side |F_n|/2 ± sign(F_n) M/L, where neither is negative, else M/L ± F_n/2 from two across.

/// A block in its guide.
#[derive(Debug, Clone, Copy)]
pub struct Block {
    /// Length along the guide (m).
    pub length: f64,
    /// Height across it (m).
    pub height: f64,
    /// Play on each side (m).
    pub gap: f64,
}

impl Block {
    /// Offset y (m) and tilt φ (rad) where the guide puts a force (N) across itself and a moment (N m)
    /// on the block, and corners go as `deep` (m) as their force has it. A block that bears nothing is
    /// centred, and so is one that would turn over.
    pub fn lying(&self, force: f64, moment: f64, deep: impl Fn(f64) -> f64) -> [f64; 2] {
        let &Block { length, height, gap } = self;
        if force == 0.0 && moment == 0.0 {
            return [0.0; 2];
        }
        let couple = moment / length;
        if 0.5 * force.abs() >= couple.abs() {
            // the guide pushes up: the block lies below
            let side = -force.signum();
            let [ahead, behind] =
                [1.0, -1.0].map(|end| deep(0.5 * force.abs() - side * end * couple));
            let tilt = (side * (ahead - behind) / length).asin();
            let lifted = 0.5 * height * (1.0 - tilt.cos());
            return [side * (gap + 0.5 * (ahead + behind) + lifted), tilt];
        }
        let [above, below] = [-0.5, 0.5].map(|share| deep(couple.abs() + share * force));
        let across = 2.0 * gap + above + below;
        let root = length * length - across * (2.0 * height + across);
        if !(root >= 0.0) {
            return [0.0; 2];
        }
        let tilt = 2.0 * (across / (length + root.sqrt())).atan();
        [0.5 * (above - below), -moment.signum() * tilt]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLOCK: Block = Block { length: 0.1, height: 0.05, gap: 5e-4 };

    /// How far a corner has come towards its wall (m).
    fn towards([y, tilt]: [f64; 2], x_sign: f64, side: f64) -> f64 {
        let along = x_sign * 0.5 * BLOCK.length;
        side * (y + along * tilt.sin()) - 0.5 * BLOCK.height * (1.0 - tilt.cos())
    }

    #[test]
    fn corners_lie_as_deep_as_bears_the_load() {
        let deep = |force: f64| (force / 1e9).powf(2.0 / 3.0);
        for (force, moment) in
            [(30.0, 0.5), (-30.0, 0.5), (3.0, 4.0), (-3.0, 4.0), (3.0, -4.0), (0.0, 1.0)]
        {
            let place = BLOCK.lying(force, moment, deep);
            let (mut on_block, mut turning) = (0.0, 0.0);
            for x_sign in [1.0, -1.0] {
                for side in [1.0, -1.0] {
                    let depth = towards(place, x_sign, side) - BLOCK.gap;
                    if depth > 0.0 {
                        let pushed = -side * 1e9 * depth.powf(1.5);
                        on_block += pushed;
                        turning += x_sign * 0.5 * BLOCK.length * pushed;
                    }
                }
            }
            assert!((on_block - force).abs() < 1e-6, "{force} {moment}: {on_block}");
            assert!((turning - moment).abs() < 1e-6, "{force} {moment}: {turning}");
        }
        assert_eq!(BLOCK.lying(0.0, 0.0, deep), [0.0; 2]);
    }
}
