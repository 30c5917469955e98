//! freeplay: reference simulation of planar mechanisms whose revolute joints have clearance.
//!
//! The modules stand in the order of DESIGN.md: each uses those above it, none below.

pub mod halt;
pub mod scalar;
pub mod plane;
pub mod linear;
pub mod parameter;
pub mod dae;
pub mod contact;
pub mod friction;
pub mod course;
pub mod joint;
pub mod clearance;
pub mod load;
pub mod model;
pub mod mechanism;
pub mod engine;
pub mod run;
pub mod digits;
pub mod record;
pub mod case;
pub mod simulate;
pub mod advice;
pub mod certify;
pub mod post;
pub mod export;
pub mod compare;
pub mod figure;
pub mod report;
pub mod cli;

#[cfg(test)]
mod scratch;
