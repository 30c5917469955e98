//! A scene and its motion for OpenMBV, the viewer of MBSim.
//!
//! `NAME.ombvx` is XML (schema `openmbv.xsd`, namespace `http://www.mbsim-env.de/OpenMBV`): groups,
//! rigid bodies of simple shapes, arrows. `NAME.ombvh5` beside it is HDF5: for each thing at
//! `/group/thing/data` a chunked matrix of doubles whose rows can grow, one row a time:
//!
//! | thing | columns |
//! |---|---|
//! | rigid body | time, x, y, z, Cardan angles α, β, γ, colour |
//! | arrow | time, x, y, z of its tip, vector x, y, z, colour |
//! | coil spring | time, x, y, z of one end, x, y, z of the other, colour |
//!
//! Here bodies move in the plane z = 0 and turn by γ. The bodies stand in layers, the clearances are
//! true to scale; guides, slots, racks, gear wheels and torsion springs stand on the bodies that have them.
//! An arrow shows the force of a joint on its second body, tip at that body's point; others, of one size
//! whatever their own, where loads act: forces, and with two heads along z torques.

mod motion;
mod scene;

use super::{Error, Written};
use crate::case::{Case, Changes};
use crate::post;
use crate::record::{Draft, ResultFile};
use crate::run::Schedule;
use scene::Scene;
use std::ffi::OsStr;
use std::path::Path;

/// Writes scene and motion.
pub(super) fn write(file: &ResultFile, output: &Path, force: bool) -> Result<Written, Error> {
    if output.extension() != Some(OsStr::new("ombvx")) {
        return Err(Error::Ending { path: output.to_owned() });
    }
    let case = post::case_of(file, &Changes::default())
        .map_err(|source| Error::NoShapes { path: file.path().to_owned(), source })?;
    let scene = Scene::of(&case.description, file)?;
    let rows = rows(&case, &file.times()?);
    let beside = output.with_extension("ombvh5");
    let draft = |path| Draft::create_from(path, force, &[file.path()]).map_err(Error::Output);
    let (text, data) = (draft(output)?, draft(&beside)?);
    motion::write(file, &scene, &rows, data.temporary()).map_err(|error| error.at(&beside))?;
    text.write_bytes(scene.to_xml(&case.name).as_bytes()).map_err(Error::Output)?;
    let [text, data] = Draft::publish_both(text, data).map_err(Error::Output)?;
    Ok(Written { paths: vec![text, data], rows: rows.len(), columns: scene.things() })
}

/// Rows of the even grid, at which a film runs evenly; all of them if they are not on one.
fn rows(case: &Case, times: &[f64]) -> Vec<usize> {
    let schedule = Schedule::new(&case.plan.duration, &case.plan.sample_interval);
    let mut next = 0;
    let mut rows = Vec::new();
    for (row, &time) in times.iter().enumerate() {
        while next < schedule.len() && schedule.time::<f64>(next) < time {
            next += 1;
        }
        if next < schedule.len() && schedule.time::<f64>(next) == time {
            rows.push(row);
        }
    }
    if rows.len() < 2 { (0..times.len()).collect() } else { rows }
}
