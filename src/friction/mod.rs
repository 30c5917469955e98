//! Tangential-force laws, one file a law.

mod ambrosio;

pub use ambrosio::{Ambrosio, Ramp, SlipRegion};
