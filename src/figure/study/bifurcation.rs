//! Bifurcation diagrams: every section point of every run over what varies, and every revolution's
//! peak. A motion that repeats itself every revolution is a point there, one that repeats itself every
//! second revolution two, a chaotic one a band.

use super::{Drawn, Over, Series, axis, words};
use crate::figure::Figures;
use crate::figure::cloud::dot;
use crate::figure::panel::{Axis, Mark, Panel};
use crate::figure::sheet::{DOUBLE_COLUMN, Height, Sheet};
use crate::figure::text::Text;
use crate::study::Error;

/// Draws a figure for each column of the sections, that of clearances where there are some, and for
/// each peak of revolutions; where one thing varies.
pub(super) fn draw(study: &Drawn<'_>, figures: &mut Figures<'_>) -> Result<(), Error> {
    let [variable] = &study.variables[..] else { return Ok(()) };
    let over = words::in_a_sentence(&variable.name);
    for series in study.series_of(&study.recorded.sections, "time", false)? {
        if !is_drawn(&series.name, study) {
            continue;
        }
        let title = words::of_column(&series.name);
        let words = format!("{} at section points over {over}", title.plain());
        let values = series.runs.iter().flat_map(|(_, values)| values.iter().copied());
        let y = axis(title, &series.unit, values);
        let name = series.name.clone();
        figures.add("bifurcation", Some(&name), &words, vec![sheet(study, variable, &series, y)]);
    }
    let peaks = study.series()?;
    for series in peaks.iter().filter(|series| series.of_revolutions && is_peak(&series.name)) {
        let values = series.runs.iter().flat_map(|(_, values)| values.iter().copied());
        let y = series.axis(values.chain([0.0]));
        let words =
            format!("{} in each revolution over {over}", words::of_number(&series.name).plain());
        let name = series.name.strip_suffix(".value").unwrap_or(&series.name);
        figures.add("bifurcation", Some(name), &words, vec![sheet(study, variable, series, y)]);
    }
    Ok(())
}

/// Whether a number of revolutions is an extreme value.
pub(super) fn is_peak(name: &str) -> bool {
    name.starts_with("columns.")
        && [".largest.value", ".smallest.value"].iter().any(|end| name.ends_with(end))
}

/// Whether a column is drawn: those of clearances, where there are some.
fn is_drawn(name: &str, study: &Drawn<'_>) -> bool {
    let of_clearance = |name: &str| name.starts_with("clearance_");
    let any = study.recorded.sections.names().iter().any(|name| of_clearance(name));
    !any || of_clearance(name)
}

fn sheet(study: &Drawn<'_>, variable: &Over, series: &Series, y: Axis) -> Sheet {
    let points = series.runs.iter().flat_map(|(run, values)| {
        let x = study.value(variable, *run);
        values.iter().map(move |value| [x, *value])
    });
    let points: Vec<[f64; 2]> = points.collect();
    let dot = dot(points.len());
    let panel = Panel {
        label: Text::default(),
        legend: Vec::new(),
        x: variable.axis(),
        y,
        marks: vec![Mark::Cloud(points, dot)],
    };
    Sheet {
        width: DOUBLE_COLUMN,
        heights: vec![Height::OfWidth(0.5)],
        rows: vec![vec![Some(panel)]],
        shared_x: false,
    }
}
