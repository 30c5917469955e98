//! Damping weights of normal-force laws, one file a law: `a` in `F_N = F_el(δ) [1 + a δ̇/δ̇⁽⁻⁾]`.
//!
//! A nominal restitution e goes in. What one isolated impact rebounds at is another number for most
//! laws ([`rebound`](super::rebound)).

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
