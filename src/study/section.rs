//! Section points: the mechanism whenever a drive passes an angle.

use super::plan::SectionPlan;
use crate::compare::{Column, Part, Parts};
use crate::course::Course;
use crate::mechanism::Mechanism;
use crate::model::{Model, did_you_mean};
use std::f64::consts::TAU;

/// What of section points is kept, and where they lie.
#[derive(Debug, Clone)]
pub(super) struct Section {
    /// Columns, by their names in result files.
    pub columns: Vec<SectionColumn>,
    drive: usize,
    angle: f64,
}

/// A column, and its name in result files.
#[derive(Debug, Clone)]
pub(super) struct SectionColumn {
    /// Its name.
    pub name: String,
    /// The column.
    pub column: Column,
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
            None => all.into_iter().filter(|column| is_state(&column.column)).collect(),
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

/// Whether a column is one of the state.
fn is_state(column: &Column) -> bool {
    column.quantity().is_some_and(|quantity| quantity.part() != Part::Forces)
}

/// Columns that a sample has.
fn columns(model: &Model<f64>) -> Vec<SectionColumn> {
    let parts = Parts(model.names().clone());
    let named = |column: Column| SectionColumn { name: parts.name(&column), column };
    parts.columns().into_iter().map(named).collect()
}

/// Times from 0 to `end` (s) at which a course passes an angle (rad) or the same a number of turns
/// off, each bracketed and halved to the last place.
fn crossings(course: &Course<f64>, angle: f64, end: f64) -> Vec<f64> {
    let turns = |time: f64| (course.at(time)[0] - angle) / TAU;
    // no more than an eighth of a turn, so that none is passed twice unseen but at a reversal
    // or near one, of which a swing has two in a period
    let period = course.period().unwrap_or(f64::INFINITY);
    let step = (TAU / 8.0 / course.fastest().max(1e-300)).min(end / 64.0).min(period / 16.0);
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
