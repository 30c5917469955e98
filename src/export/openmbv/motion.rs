//! The motion: an HDF5 file with a matrix for each thing of the scene.

use super::super::WriteError;
use super::scene::{Arrow, Body, Load, PointOnBody, Scene, Spring};
use crate::record::{LibraryError, ResultFile, Written};
use hdf5::file::LibraryVersion;
use hdf5::types::VarLenAscii;
use hdf5::{Extent, File, Group, SimpleExtents};
use ndarray::Array2;
use std::path::Path;

/// Rows of a chunk: the viewer reads row by row and keeps one chunk.
const CHUNK_ROWS: usize = 128;
const DEFLATE: u8 = 4;

const OF_BODY: [&str; 8] = ["Time", "x", "y", "z", "alpha", "beta", "gamma", "color"];
const OF_ARROW: [&str; 8] =
    ["Time", "toPoint x", "toPoint y", "toPoint z", "delta x", "delta y", "delta z", "color"];

const OF_SPRING: [&str; 8] = [
    "Time",
    "fromPoint x",
    "fromPoint y",
    "fromPoint z",
    "toPoint x",
    "toPoint y",
    "toPoint z",
    "color",
];

/// The columns of the result file that move the scene.
struct Track<'a> {
    file: &'a ResultFile,
    rows: &'a [usize],
    times: Vec<f64>,
}

/// Writes the motion of the rows to an empty file.
pub(super) fn write(
    file: &ResultFile,
    scene: &Scene,
    rows: &[usize],
    path: &Path,
) -> Result<(), WriteError> {
    let output = create(path).map_err(library)?;
    let mut written = Written::default();
    let track = Track { file, rows, times: file.times()? };
    let top = scene.top();
    let bodies = scene.bodies.iter().map(|body| (&body.name, track.of_body(body)));
    put_group(&output, &mut written, "bodies", &OF_BODY, bodies)?;
    if !scene.springs.is_empty() {
        let springs = scene.springs.iter().map(|one| (&one.name, track.of_spring(one, top)));
        put_group(&output, &mut written, "springs", &OF_SPRING, springs)?;
    }
    let forces = scene.arrows.iter().map(|arrow| (&arrow.name, track.of_arrow(arrow, top)));
    put_group(&output, &mut written, "forces", &OF_ARROW, forces)?;
    if !scene.loads.is_empty() {
        let loads = scene.loads.iter().map(|load| (&load.name, track.of_load(load, top)));
        put_group(&output, &mut written, "loads", &OF_ARROW, loads)?;
    }
    output.flush().map_err(library)?;
    output.close().map_err(library)?;
    match written.missing(path).or_else(|| unlabelled(path, scene)) {
        Some(what) => Err(WriteError::write(NotAsWritten { what })),
        None => Ok(()),
    }
}

/// The first thing whose columns have lost their labels in a closed file.
fn unlabelled(path: &Path, scene: &Scene) -> Option<String> {
    let bodies = scene.bodies.iter().map(|body| (format!("bodies/{}/data", body.name), OF_BODY));
    let arrows = scene.arrows.iter();
    let arrows = arrows.map(|arrow| (format!("forces/{}/data", arrow.name), OF_ARROW));
    let loads = scene.loads.iter().map(|load| (format!("loads/{}/data", load.name), OF_ARROW));
    let springs = scene.springs.iter();
    let springs = springs.map(|spring| (format!("springs/{}/data", spring.name), OF_SPRING));
    let file = File::with_options().with_fapl(|access| access.file_locking(false)).open(path);
    let has = |name: &str, labels: [&str; 8]| {
        let data = file.as_ref().map_err(Clone::clone)?.dataset(name)?;
        let read = data.attr("Column Label")?.read_raw::<VarLenAscii>()?;
        Ok::<_, hdf5::Error>(read.iter().map(VarLenAscii::as_str).eq(labels))
    };
    let mut all = bodies.chain(arrows).chain(loads).chain(springs);
    all.find(|(name, labels)| !has(name, *labels).unwrap_or(false)).map(|(name, _)| name)
}

/// What was read back is not what was written.
#[derive(Debug, thiserror::Error)]
#[error("{what} came back from the disk otherwise than it was written")]
struct NotAsWritten {
    what: String,
}

fn flat(motion: &Array2<f64>) -> Vec<f64> {
    motion.iter().copied().collect()
}

fn library(error: hdf5::Error) -> WriteError {
    WriteError::write(LibraryError::from(error))
}

/// The viewer opens files for reading while another program writes, for which HDF5 wants the
/// layout of its release 1.10.
fn create(path: &Path) -> hdf5::Result<File> {
    File::with_options()
        .with_fapl(|access| {
            let access = access.libver_bounds(LibraryVersion::V110, LibraryVersion::V110);
            access.file_locking(false) // its name is known to nobody yet
        })
        .with_fcpl(|creation| creation.obj_track_times(false))
        .create(path)
}

/// Writes a group of things, one after the other, each by its name and its motion.
fn put_group<'a>(
    output: &File,
    written: &mut Written,
    name: &str,
    labels: &[&str; 8],
    motions: impl Iterator<Item = (&'a String, Result<Array2<f64>, WriteError>)>,
) -> Result<(), WriteError> {
    let group = output.create_group(name).map_err(library)?;
    for (thing, motion) in motions {
        let motion = motion?;
        put(&group, thing, labels, &motion).map_err(library)?;
        written.values(&format!("{name}/{thing}/data"), &flat(&motion));
    }
    Ok(())
}

fn put(group: &Group, name: &str, labels: &[&str; 8], motion: &Array2<f64>) -> hdf5::Result<()> {
    let extents = vec![Extent::resizable(motion.nrows()), Extent::fixed(8)];
    let dataset = group
        .create_group(name)?
        .new_dataset::<f64>()
        .shuffle()
        .deflate(DEFLATE)
        .chunk(vec![CHUNK_ROWS, 8])
        .obj_track_times(false)
        .shape(SimpleExtents::from_vec(extents))
        .create("data")?;
    if motion.nrows() > 0 {
        dataset.write(motion)?;
    }
    let labels: Result<Vec<VarLenAscii>, _> = labels.iter().map(VarLenAscii::from_ascii).collect();
    let labels = labels.map_err(|error| hdf5::Error::from(error.to_string()))?;
    dataset.new_attr::<VarLenAscii>().shape(8).create("Column Label")?.write(&labels)
}

impl Track<'_> {
    fn column(&self, dataset: &str, item: usize) -> Result<Vec<f64>, WriteError> {
        Ok(self.file.table(dataset)?.column(item))
    }

    /// A matrix whose rows are made from rows of the file.
    fn matrix(&self, of: impl Fn(usize) -> [f64; 6]) -> Array2<f64> {
        let mut matrix = Array2::zeros((self.rows.len(), 8));
        for (mut line, &row) in matrix.rows_mut().into_iter().zip(self.rows) {
            line[0] = self.times[row];
            for (place, value) in of(row).into_iter().enumerate() {
                line[1 + place] = value;
            }
        }
        matrix
    }

    /// x, y and angle of a body; the ground stands still.
    fn pose(&self, body: Option<usize>) -> Result<impl Fn(usize) -> [f64; 3] + use<>, WriteError> {
        let columns = match body {
            None => None,
            Some(body) => Some([
                self.column("position_x", body)?,
                self.column("position_y", body)?,
                self.column("angle", body)?,
            ]),
        };
        Ok(move |row: usize| {
            columns.as_ref().map_or([0.0; 3], |c| [c[0][row], c[1][row], c[2][row]])
        })
    }

    fn of_body(&self, body: &Body) -> Result<Array2<f64>, WriteError> {
        let pose = self.pose(body.index)?;
        Ok(self.matrix(|row| {
            let [x, y, angle] = pose(row);
            [x, y, 0.0, 0.0, 0.0, angle]
        }))
    }

    fn of_arrow(&self, arrow: &Arrow, height: f64) -> Result<Array2<f64>, WriteError> {
        let at = self.point(arrow.at)?;
        let force_x = self.column("joint_force_x", arrow.joint)?;
        let force_y = self.column("joint_force_y", arrow.joint)?;
        Ok(self.matrix(|row| {
            let [x, y] = at(row);
            [x, y, height, force_x[row], force_y[row], 0.0]
        }))
    }

    fn of_load(&self, load: &Load, height: f64) -> Result<Array2<f64>, WriteError> {
        let (at, frame) = (self.point(load.at)?, self.pose(load.frame)?);
        let [u, v, along] = load.arrow;
        Ok(self.matrix(|row| {
            let ([x, y], [_, _, angle]) = (at(row), frame(row));
            let (sin, cos) = angle.sin_cos();
            [x, y, height, cos * u - sin * v, sin * u + cos * v, along]
        }))
    }

    fn of_spring(&self, spring: &Spring, height: f64) -> Result<Array2<f64>, WriteError> {
        let [from, to] = spring.between;
        let (from, to) = (self.point(from)?, self.point(to)?);
        Ok(self.matrix(|row| {
            let ([x, y], [u, v]) = (from(row), to(row));
            [x, y, height, u, v, height]
        }))
    }

    /// Where a point is (m).
    fn point(&self, at: PointOnBody) -> Result<impl Fn(usize) -> [f64; 2] + use<>, WriteError> {
        let pose = self.pose(at.body)?;
        let [u, v] = at.point;
        Ok(move |row: usize| {
            let [x, y, angle] = pose(row);
            let (sin, cos) = angle.sin_cos();
            [x + cos * u - sin * v, y + sin * u + cos * v]
        })
    }
}
