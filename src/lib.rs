//! freeplay: reference simulation of planar mechanisms whose revolute joints have clearance.
//!
//! A case is read, assembled and run in memory like this; `examples/` has longer ones:
//!
//! ```
//! use freeplay::case::{Case, Changes};
//! use freeplay::run::{Progress, Trajectory};
//! use freeplay::simulate::Simulation;
//! use std::{ops::ControlFlow, path::Path};
//!
//! let set = vec!["run.duration=1e-3".parse()?];
//! let case = Case::read(Path::new("cases/four-bar-a.toml"), &Changes { set, ideal: false })?;
//! let mut kept = Trajectory::default();
//! let mut go_on = |_: &Progress| ControlFlow::Continue(());
//! Simulation::new(&case)?.run(&mut kept, &mut go_on).1?;
//! assert!(kept.contacts[0].peak_force > 1e3); // N
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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
pub mod chaos;
pub mod post;
pub mod export;
pub mod study;
pub mod compare;
pub mod figure;
pub mod report;
pub mod cli;

#[cfg(test)]
mod scratch;
