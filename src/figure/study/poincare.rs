//! Poincaré sections: where the centre of a journal is at the section points of a run.

use super::{Drawn, chosen};
use crate::figure::Figures;
use crate::figure::cloud::dot;
use crate::figure::palette::BLACK;
use crate::figure::panel::{Axis, Choice, Mark, Panel};
use crate::figure::quantity::Unit;
use crate::figure::sheet::{DOUBLE_COLUMN, Height, SINGLE_COLUMN, Sheet};
use crate::figure::svg::Stroke;
use crate::figure::text::Text;
use crate::study::Error;

/// Runs that are drawn of each joint, evenly chosen, in so many columns.
const MOST: usize = 9;
const COLUMNS: usize = 3;

/// Draws a figure for each joint with clearance.
pub(super) fn draw(study: &Drawn<'_>, figures: &mut Figures<'_>) -> Result<(), Error> {
    let all = study.series_of(&study.recorded.sections, "time", false)?;
    for x in &all {
        let Some(joint) = x.name.strip_prefix("clearance_x.") else { continue };
        let Some(y) = all.iter().find(|y| y.name == format!("clearance_y.{joint}")) else {
            continue;
        };
        let runs = chosen(x.runs.len(), MOST);
        let panels = runs.into_iter().filter_map(|k| {
            let ((run, x), (_, y)) = (&x.runs[k], y.runs.get(k)?);
            let points: Vec<[f64; 2]> = x.iter().zip(y).map(|(x, y)| [*x, *y]).collect();
            Some(panel(study, *run, joint, points))
        });
        let mut panels: Vec<Panel> = panels.collect();
        if panels.is_empty() {
            continue;
        }
        crate::figure::over_time::letter(panels.iter_mut());
        let columns = panels.len().min(COLUMNS);
        let mut panels: Vec<Option<Panel>> = panels.into_iter().map(Some).collect();
        panels.resize(panels.len().next_multiple_of(columns), None);
        let rows: Vec<Vec<Option<Panel>>> = panels.chunks(columns).map(<[_]>::to_vec).collect();
        let sheet = Sheet {
            width: if columns == 1 { SINGLE_COLUMN } else { DOUBLE_COLUMN },
            heights: vec![Height::OfWidth(1.0); rows.len()],
            rows,
            shared_x: false,
        };
        let title = format!("Centre of the journal in {joint} at section points");
        figures.add("poincare", Some(joint), &title, vec![sheet]);
    }
    Ok(())
}

fn panel(study: &Drawn<'_>, run: u64, joint: &str, points: Vec<[f64; 2]>) -> Panel {
    let radial = study.recorded.radial_clearance(run, joint);
    let far = points.iter().map(|[x, y]| x.abs().max(y.abs()));
    let far = far.fold(radial.unwrap_or(0.0), f64::max);
    let far = if far > 0.0 { 1.08 * far } else { 1.0 };
    let axis = |letter: &str| Axis {
        title: Text::roman("Δ").and_italic(letter),
        unit: Unit::fitting("m", far),
        range: [-far, far],
        ticks: Choice::Decimal,
    };
    let dot = dot(points.len());
    let mut marks = vec![Mark::Cloud(points, dot)];
    marks.extend(radial.map(|radial| Mark::Circle(radial, Stroke::dashed(BLACK, 0.5))));
    let label = match &study.variables[..] {
        [variable] => variable.equals(study.value(variable, run)),
        _ => Text::roman(format!("Run {run}")),
    };
    Panel { label, legend: Vec::new(), x: axis("x"), y: axis("y"), marks }
}
