//! freeplay: reference simulation of planar mechanisms whose revolute joints have clearance.
//!
//! The modules stand in the order of DESIGN.md: each uses those above it, none below.

pub mod scalar;
pub mod plane;
pub mod model;
pub mod dae;
pub mod mechanism;
pub mod run;
pub mod record;
