//! Force over penetration in each contact that begins or ends: the area of a loop is what the
//! contact dissipates.

use super::decimate::{BREAK, Point};
use super::grid::by_run_and_joint;
use super::palette::{SKY, VERMILLION};
use super::panel::{Axis, Mark, Panel, Sample, zero_line};
use super::runs::{Run, Runs};
use super::svg::Stroke;
use super::text::Text;
use super::touching::{began_before, contacts, history};
use super::{Error, Figures};
use crate::run::Contact;

/// All contacts.
const ALL: Stroke = Stroke::solid(SKY, 0.3);
/// The one with the largest force.
const HARDEST: Stroke = Stroke::solid(VERMILLION, 0.9);

/// Draws one figure with a panel for each joint of each run.
pub(super) fn draw(runs: &Runs, figures: &mut Figures<'_>) -> Result<(), Error> {
    let mut sheets = by_run_and_joint(runs, 0.8, |run, joint, index| {
        let loops = loops(run, index)?;
        Ok((!loops.is_empty()).then(|| panel(run, joint, &loops)))
    })?;
    for sheet in &mut sheets {
        if let Some(first) = sheet.rows.iter_mut().flatten().flatten().next() {
            first.legend = vec![(Sample::Line(HARDEST), Text::roman("hardest"))];
        }
    }
    let title = "Normal force over penetration in each contact, the hardest drawn thicker";
    figures.add("contact-loops", None, title, sheets);
    Ok(())
}

fn loops(run: &Run, clearance: usize) -> Result<Vec<Vec<Point>>, Error> {
    let moments = history(run, clearance)?;
    let of = |contact: Contact| {
        let end = if contact.end.is_nan() { f64::INFINITY } else { contact.end };
        let from = moments.partition_point(|moment| moment.time < contact.begin);
        let until = moments.partition_point(|moment| moment.time <= end);
        moments[from..until.max(from)].iter().map(|moment| [moment.depth, moment.force]).collect()
    };
    let contacts = contacts(run, clearance).into_iter();
    let comes_or_goes = |contact: &Contact| run.shows(contact.end) || !began_before(run, contact);
    let loops: Vec<Vec<Point>> = contacts.filter(comes_or_goes).map(of).collect();
    Ok(loops.into_iter().filter(|points| points.len() > 1).collect())
}

fn panel(run: &Run, joint: &str, loops: &[Vec<Point>]) -> Panel {
    let all = loops.join(&BREAK);
    let axis = |title: Text, unit: &str, index: usize| {
        Axis::fitting(title, unit, all.iter().map(|point| point[index]))
    };
    let x = axis(Text::roman("Penetration, ").and_italic("δ"), "m", 0);
    let y = axis(Text::roman("Normal force, ").and_italic("F").and_subscript("N"), "N", 1);
    let force = |points: &[Point]| points.iter().map(|point| point[1]).fold(f64::MIN, f64::max);
    let hardest = loops.iter().max_by(|a, b| force(a).total_cmp(&force(b))).cloned();
    let mut marks: Vec<Mark> = zero_line(y.range).into_iter().collect();
    marks.push(Mark::Path(all.clone(), ALL));
    marks.push(Mark::Path(hardest.unwrap_or_default(), HARDEST));
    Panel { label: Text::roman(format!("{}, {joint}", run.name)), legend: Vec::new(), x, y, marks }
}
