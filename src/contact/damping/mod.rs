//! Damping weights of normal-force laws, one file a law: `a` in `F_N = F_el(δ) [1 + a δ̇/δ̇⁽⁻⁾]`.
//!
//! A nominal restitution e goes in. What one isolated impact rebounds at is another number for most
//! laws ([`rebound`](super::rebound)).

use super::rebound;
use crate::scalar::Scalar;

/// What a law says of itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct About {
    /// Its name in case files.
    pub word: &'static str,
    /// The damping weight as a formula in the restitution e.
    pub formula: &'static str,
    /// Where it is from.
    pub source: &'static str,
    /// For which restitutions it was meant, and what becomes of it elsewhere.
    pub valid: &'static str,
    /// Whether it takes a restitution.
    pub restitution: bool,
}

macro_rules! laws {
    ($($(#[$when:meta])? $name:ident in $file:ident,)+) => {
        $($(#[$when])? mod $file;)+

        /// A law of the damping.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Damping {
            $($(#[$when])? #[doc = concat!("`", stringify!($file), "`")] $name,)+
        }

        impl Damping {
            /// Every law, by its name in case files.
            pub const ALL: &[(&'static str, Damping)] =
                &[$($(#[$when])? ($file::ABOUT.word, Damping::$name)),+];

            /// What the law says of itself.
            pub fn about(self) -> &'static About {
                match self { $($(#[$when])? Damping::$name => &$file::ABOUT,)+ }
            }

            /// The damping weight a for a restitution e in (0, 1].
            pub fn weight<S: Scalar>(self, restitution: S) -> S {
                match self { $($(#[$when])? Damping::$name => $file::weight(restitution),)+ }
            }
        }
    };
}

laws! {
    LankaraniNikravesh in lankarani_nikravesh,
    Hertz in hertz,
    HuntCrossley in hunt_crossley,
    HerbertMcWhannell in herbert_mcwhannell,
    LeeWang in lee_wang,
    Gonthier in gonthier,
    ZhiyingQishao in zhiying_qishao,
    Flores in flores,
    HuGuo in hu_guo,
    CarvalhoMartins in carvalho_martins,
    Exact in exact,
    #[cfg(test)]
    Scratch in scratch,
}

/// A restitution smaller than any that is meant.
const NEXT_TO_NONE: f64 = 1e-9;

impl Damping {
    /// What an impact rebounds at, over its speed, with the smallest nominal restitution.
    pub fn least_rebound(self) -> f64 {
        rebound(self.weight(NEXT_TO_NONE))
    }

    /// The nominal restitution with which one impact by itself rebounds at `achieved` of its speed;
    /// `None` where no restitution does.
    pub fn nominal(self, achieved: f64) -> Option<f64> {
        let wanted: f64 = Damping::Exact.weight(achieved);
        // a larger restitution has a smaller weight
        let (mut low, mut high) = (NEXT_TO_NONE, 1.0);
        if !(wanted <= self.weight(low) && wanted >= self.weight(high)) {
            return None;
        }
        for _ in 0..100 {
            let middle = f64::midpoint(low, high);
            if self.weight(middle) > wanted { low = middle } else { high = middle }
        }
        Some(f64::midpoint(low, high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_with_its_nominal_restitution_rebounds_at_what_was_asked_for() {
        for (word, law) in Damping::ALL.iter().filter(|(_, law)| law.about().restitution) {
            for achieved in [0.05, 0.3, 0.6, 0.7, 0.9, 0.99, 1.0] {
                match law.nominal(achieved) {
                    Some(nominal) => {
                        let found = rebound(law.weight(nominal));
                        assert!((found - achieved).abs() < 1e-12, "{word}: {found} of {achieved}");
                    }
                    None => assert!(achieved < law.least_rebound(), "{word}, {achieved}"),
                }
            }
        }
        assert!(
            (Damping::LankaraniNikravesh.nominal(0.725_241_114_010_197).unwrap() - 0.5).abs()
                < 1e-12
        );
        assert_eq!(Damping::LankaraniNikravesh.nominal(0.5), None);
    }
}
