//! Section points: the mechanism whenever a drive passes an angle.

use super::plan::SectionPlan;
use crate::course::Course;
use crate::mechanism::{Mechanism, Observation};
use crate::model::{Model, did_you_mean};
use crate::record::{DATASETS, Dataset, Source, column_name};
use std::f64::consts::TAU;

/// Datasets whose columns are the state, for bodies and for joints with clearance.
const STATE: [&str; 8] = [
    "position_x",
    "position_y",
    "angle",
    "velocity_x",
    "velocity_y",
    "angular_velocity",
    "clearance_x",
    "clearance_y",
];

/// What of section points is kept, and where they lie.
#[derive(Debug, Clone)]
pub(super) struct Section {
    /// Columns, by their names in result files.
    pub columns: Vec<SectionColumn>,
    drive: usize,
    angle: f64,
}

/// A column.
#[derive(Debug, Clone)]
pub(super) struct SectionColumn {
    /// Its name.
    pub name: String,
    /// What it is in a result file.
    pub dataset: &'static Dataset,
    item: usize,
}

impl SectionColumn {
    /// Its value.
    pub fn of(&self, observation: &Observation) -> f64 {
        let k = self.item;
        match self.dataset.source {
            Source::Sample(of) => of(observation),
            Source::Body(of) => of(&observation.bodies[k]),
            Source::Clearance(of) => of(&observation.clearances[k]),
            Source::Joint(of) => of(&observation.joints[k]),
            Source::Drive => observation.drive_torques[k],
            _ => f64::NAN,
        }
    }
}

impl Section {
    /// The section of a plan through a mechanism.
    ///
    /// # Errors
    /// What is wrong with the plan, and its key.
    pub fn of(plan: &SectionPlan, model: &Model<f64>) -> Result<Section, (&'static str, String)> {
        if !plan.angle.is_finite() {
            return Err(("section.angle", "must be a number (rad)".to_owned()));
        }
        let drives = &model.names().drives;
        let drive = match &plan.drive {
            None if drives.is_empty() => {
                return Err(("section", "the mechanism has no drive".to_owned()));
            }
            None => 0,
            Some(name) => drives.iter().position(|drive| drive == name).ok_or_else(|| {
                let hint = did_you_mean(name, drives.iter().map(String::as_str));
                ("section.drive", format!("there is no drive {name:?}{hint}"))
            })?,
        };
        let all = columns(model);
        let columns = match &plan.columns {
            None => {
                let state = |column: &SectionColumn| STATE.contains(&column.dataset.name);
                all.into_iter().filter(state).collect()
            }
            Some(names) => names
                .iter()
                .map(|name| {
                    let found = all.iter().find(|column| column.name == *name).cloned();
                    found.ok_or_else(|| {
                        let hint = did_you_mean(name, all.iter().map(|c| c.name.as_str()));
                        let like = "columns are named as in result files, clearance_x.A";
                        ("section.columns", format!("there is no column {name:?}{hint}; {like}"))
                    })
                })
                .collect::<Result<Vec<_>, _>>()?,
        };
        Ok(Section { columns, drive, angle: plan.angle })
    }

    /// When the drive passes the angle, from 0 to `end` (s).
    pub fn times(&self, mechanism: &Mechanism<f64>, end: f64) -> Vec<f64> {
        let course = &mechanism.model().drives()[self.drive].course;
        if course.accelerates() {
            return crossings(course, self.angle, end);
        }
        let [start, rate, _] = course.at(0.0);
        if rate == 0.0 {
            return Vec::new();
        }
        // the first passage lies within the first turn, whichever way it goes
        let turn = TAU * rate.signum();
        let ahead = (self.angle - start) / turn;
        // an angle that is that of the start but for its rounding is passed at the start
        let part = ahead - (ahead + 1e-12).floor();
        let period = TAU / rate.abs();
        let times = (0..).map(|k| (f64::from(k) + part.max(0.0)) * period);
        // the end counts, though its rounding be another
        times.take_while(|time| *time <= end * (1.0 + 1e-12)).map(|time| time.min(end)).collect()
    }
}

/// Columns that a sample has.
fn columns(model: &Model<f64>) -> Vec<SectionColumn> {
    let names = model.names();
    let mut all = Vec::new();
    for dataset in &DATASETS {
        let items: &[String] = match dataset.source {
            Source::Sample(_) if dataset.name != "time" => &[],
            Source::Body(_) => &names.bodies,
            Source::Clearance(_) => &names.clearances,
            Source::Joint(_) => &names.joints,
            Source::Drive => &names.drives,
            _ => continue,
        };
        let column = |item: Option<&String>, k| SectionColumn {
            name: column_name(dataset.name, item.map(String::as_str)),
            dataset,
            item: k,
        };
        match dataset.source {
            Source::Sample(_) => all.push(column(None, 0)),
            _ => all.extend(items.iter().enumerate().map(|(k, item)| column(Some(item), k))),
        }
    }
    all
}

/// Times from 0 to `end` (s) at which a course passes an angle (rad) or the same a number of turns
/// off, each bracketed and halved to the last place.
fn crossings(course: &Course<f64>, angle: f64, end: f64) -> Vec<f64> {
    let turns = |time: f64| (course.at(time)[0] - angle) / TAU;
    // no more than an eighth of a turn, so that none is passed twice unseen but at a reversal
    let step = (TAU / 8.0 / course.fastest().max(1e-300)).min(end / 64.0);
    let steps = (end / step).ceil().min(1e8) as u64;
    let mut times = Vec::new();
    let mut before = (0.0, turns(0.0));
    if before.1 == before.1.round() {
        times.push(0.0);
    }
    for k in 1..=steps {
        let time = (k as f64 * step).min(end);
        let here = (time, turns(time));
        let passed = before.1.floor().max(here.1.floor());
        if before.1.floor() != here.1.floor() && before.1 != passed {
            let (mut low, mut high) = (before.0, here.0);
            while high - low > f64::EPSILON * high {
                let middle = 0.5 * (low + high);
                if (turns(middle) >= passed) == (here.1 >= passed) {
                    high = middle
                } else {
                    low = middle
                }
                if middle == low && middle == high {
                    break;
                }
            }
            if times.last().is_none_or(|last| *last < high) {
                times.push(high);
            }
        }
        before = here;
    }
    times
}
