//! Force over penetration in each contact that begins or ends: the area of a loop is what the
//! contact dissipates.

use super::decimate::{BREAK, Point};
use super::grid::{by_run_and_joint, tell_once};
use super::over_time::beyond_path;
use super::palette::{BEYOND_PATH, SKY, VERMILLION};
use super::panel::{Axis, Mark, Panel, Sample, zero_line};
use super::runs::{Run, Runs};
use super::svg::Stroke;
use super::text::Text;
use super::touching::{began_before, contacts, history};
use super::{Error, Figures};
use crate::run::Contact;

/// All contacts.
const ALL: Stroke = Stroke::solid(SKY, 0.3);
/// Contacts beyond the horizon of the run.
const BEYOND: Stroke = Stroke::solid(BEYOND_PATH, 0.3);
/// The one with the largest force of those before it.
const HARDEST: Stroke = Stroke::solid(VERMILLION, 0.9);

/// Draws one figure with a panel for each joint of each run.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let mut sheets = by_run_and_joint(runs, 0.8, |run, joint, index| {
        let [known, beyond] = loops(run, index)?;
        let drawn = !known.is_empty() || !beyond.is_empty();
        Ok(drawn.then(|| panel(run, joint, &known, &beyond)))
    })?;
    tell_once(&mut sheets);
    for sheet in &mut sheets {
        if let Some(first) = sheet.rows.iter_mut().flatten().flatten().next() {
            first.legend.insert(0, (Sample::Line(HARDEST), Text::roman("hardest")));
        }
    }
    let title = "Normal force over penetration in each contact, the hardest drawn thicker";
    figures.add("contact-loops", None, title, sheets);
    Ok(())
}

/// Loops of contacts that end before the horizon, and of those that do not.
fn loops(run: &Run, clearance: usize) -> Result<[Vec<Vec<Point>>; 2], Error> {
    let moments = history(run, clearance)?;
    let of = |contact: Contact| {
        let end = if contact.end.is_nan() { f64::INFINITY } else { contact.end };
        let from = moments.partition_point(|moment| moment.time < contact.begin);
        let until = moments.partition_point(|moment| moment.time <= end);
        moments[from..until.max(from)].iter().map(|moment| [moment.depth, moment.force]).collect()
    };
    let contacts = contacts(run, clearance).into_iter();
    let comes_or_goes = |contact: &Contact| run.shows(contact.end) || !began_before(run, contact);
    let ends = run.forces_end().unwrap_or(f64::INFINITY);
    let is_known = |contact: &Contact| !(contact.end > ends) && contact.peak_time <= ends;
    let (known, beyond): (Vec<Contact>, Vec<Contact>) =
        contacts.filter(comes_or_goes).partition(is_known);
    Ok([known, beyond].map(|contacts| {
        contacts.into_iter().map(of).filter(|points: &Vec<Point>| points.len() > 1).collect()
    }))
}

fn panel(run: &Run, joint: &str, known: &[Vec<Point>], beyond: &[Vec<Point>]) -> Panel {
    let all = [known, beyond].concat().join(&BREAK);
    let axis = |title: Text, unit: &str, index: usize| {
        Axis::fitting(title, unit, all.iter().map(|point| point[index]))
    };
    let x = axis(Text::roman("Penetration, ").and_italic("δ"), "m", 0);
    let y = axis(Text::roman("Normal force, ").and_italic("F").and_subscript("N"), "N", 1);
    let force = |points: &[Point]| points.iter().map(|point| point[1]).fold(f64::MIN, f64::max);
    let hardest = known.iter().max_by(|a, b| force(a).total_cmp(&force(b))).cloned();
    let mut marks: Vec<Mark> = zero_line(y.range).into_iter().collect();
    marks.push(Mark::Path(beyond.join(&BREAK), BEYOND));
    marks.push(Mark::Path(known.join(&BREAK), ALL));
    marks.push(Mark::Path(hardest.unwrap_or_default(), HARDEST));
    let legend = (!beyond.is_empty()).then(beyond_path).into_iter().collect();
    Panel { label: Text::roman(format!("{}, {joint}", run.name)), legend, x, y, marks }
}
