//! Force over penetration in one impact by itself, of several laws of the normal force: the area of a
//! loop is what an impact dissipates. Known in closed form; no run is needed.

use super::over_time::letter;
use super::palette::{IDEAL, OVERLAID};
use super::panel::{Axis, Choice, Dot, Mark, Panel, Sample, range_of, zero_line};
use super::quantity::Unit;
use super::sheet::{Height, SINGLE_COLUMN, Sheet};
use super::svg::Stroke;
use super::text::Text;
use super::{DESCRIPTION, Figure, Figures, Options};
use crate::contact::elastic::{Elastic, Power};
use crate::contact::{Damping, Impact, NormalLaw, force_loop};

/// Hertz's exponent.
const EXPONENT: f64 = 1.5;
/// Moments of a loop.
const MOMENTS: usize = 401;

/// Draws the loops of some laws at a nominal restitution, as many to a panel as have a line of their
/// own, beside the elastic one.
pub fn draw_laws(laws: &[Damping], restitution: f64, options: &Options) -> Vec<Figure> {
    let mut figures = Figures { options, description: DESCRIPTION, drawn: Vec::new() };
    let loops: Vec<(Damping, Vec<[f64; 2]>)> =
        (laws.iter()).map(|law| (*law, relative_loop(law.weight(restitution)))).collect();
    let elastic = relative_loop(0.0);
    let points = || loops.iter().flat_map(|(_, points)| points).chain(&elastic);
    let axis = |title: Text, index: usize| Axis {
        title,
        unit: Unit::one(),
        range: range_of(points().map(|point| point[index])).map_or([0.0, 1.0], |[low, high]| {
            [low - 0.04 * (high - low), high + 0.06 * (high - low)]
        }),
        ticks: Choice::Decimal,
    };
    let x = axis(Text::roman("Penetration over the elastic impact's, ").and_italic("δ"), 0);
    let y = axis(
        Text::roman("Force over the elastic impact's, ").and_italic("F").and_subscript("N"),
        1,
    );
    let mut panels: Vec<Panel> = (loops.chunks(OVERLAID.len()))
        .map(|loops| panel(loops, &elastic, restitution, &x, &y))
        .collect();
    letter(panels.iter_mut());
    let rows = panels.len();
    let sheet = Sheet {
        width: SINGLE_COLUMN,
        heights: vec![Height::OfWidth(0.8); rows],
        rows: panels.into_iter().map(|panel| vec![Some(panel)]).collect(),
        shared_x: true,
    };
    let title = "Normal force over penetration in one impact, by several laws";
    figures.add("law-loops", None, title, vec![sheet]);
    figures.drawn
}

/// Radius of a sample of a run (pt).
const SAMPLE: f64 = 1.1;

/// An impact in closed form, and the samples of a run of it.
#[derive(Debug, Clone)]
pub struct ImpactLoop {
    /// What it is called.
    pub word: String,
    /// Penetration (m) and force (N) in closed form.
    pub exact: Vec<[f64; 2]>,
    /// The same of samples.
    pub points: Vec<[f64; 2]>,
}

/// Draws impacts in closed form with the samples of runs over them, as many to a panel as have a line
/// of their own.
pub fn draw_impacts(impacts: &[ImpactLoop], options: &Options) -> Vec<Figure> {
    let mut figures = Figures { options, description: DESCRIPTION, drawn: Vec::new() };
    let values =
        |axis: usize| impacts.iter().flat_map(move |i| i.exact.iter().map(move |p| p[axis]));
    let x = Axis::fitting(Text::roman("Penetration ").and_italic("δ"), "m", values(0));
    let y = Axis::fitting(Text::roman("Force ").and_italic("F").and_subscript("N"), "N", values(1));
    let panel = |impacts: &[ImpactLoop]| {
        let mut panel = Panel {
            label: Text::default(),
            legend: Vec::new(),
            x: x.clone(),
            y: y.clone(),
            marks: zero_line(y.range).into_iter().collect(),
        };
        for (ImpactLoop { word, exact, points }, stroke) in impacts.iter().zip(OVERLAID) {
            let dot = Dot { radius: SAMPLE, colour: stroke.colour };
            panel.legend.push((Sample::Line(stroke), Text::roman(word.as_str())));
            panel.marks.push(Mark::Path(exact.clone(), stroke));
            panel.marks.push(Mark::Dots(points.clone(), dot));
        }
        panel
    };
    let mut panels: Vec<Panel> = impacts.chunks(OVERLAID.len()).map(panel).collect();
    letter(panels.iter_mut());
    let sheet = Sheet {
        width: SINGLE_COLUMN,
        heights: vec![Height::OfWidth(0.8); panels.len()],
        rows: panels.into_iter().map(|panel| vec![Some(panel)]).collect(),
        shared_x: true,
    };
    let title = "Normal force over penetration in one impact: closed forms, and samples of runs";
    figures.add("impact-loops", None, title, vec![sheet]);
    figures.drawn
}

/// Penetration and force in one impact, over the largest of the elastic one.
fn relative_loop(damping_weight: f64) -> Vec<[f64; 2]> {
    let law = |a: f64| NormalLaw::new(Elastic::Power(Power::with(1.0, EXPONENT)), a);
    let elastic = Impact::of(&law(0.0), 1.0, 1.0);
    let points = force_loop(&law(damping_weight), 1.0, 1.0, MOMENTS);
    points.iter().map(|[depth, force]| [depth / elastic.depth, force / elastic.force]).collect()
}

fn panel(
    loops: &[(Damping, Vec<[f64; 2]>)],
    elastic: &[[f64; 2]],
    restitution: f64,
    x: &Axis,
    y: &Axis,
) -> Panel {
    let line = |stroke: Stroke, word: &str| (Sample::Line(stroke), Text::roman(word));
    let mut legend = vec![line(IDEAL, "elastic")];
    let mut marks: Vec<Mark> = zero_line(y.range).into_iter().collect();
    marks.push(Mark::Path(elastic.to_vec(), IDEAL));
    for ((law, points), stroke) in loops.iter().zip(OVERLAID) {
        legend.push(line(stroke, law.about().word));
        marks.push(Mark::Path(points.clone(), stroke));
    }
    let label = Text::italic("e").and(format!(" = {restitution}"));
    Panel { label, legend, x: x.clone(), y: y.clone(), marks }
}
