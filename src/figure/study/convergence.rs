//! Ensembles, revolution by revolution: mean and spread of the copies, and the mean of the long run that
//! they come to.

use super::{Drawn, chosen, figures as digits, words};
use crate::figure::Figures;
use crate::figure::palette::{BAND, GUIDE, IDEAL, RUN, VERMILLION};
use crate::figure::panel::{Axis, Mark, Panel, Sample};
use crate::figure::sheet::{Height, SINGLE_COLUMN, Sheet};
use crate::figure::svg::Stroke;
use crate::figure::text::Text;
use crate::study::{Error, Rows};

/// Points of the grid that have a panel each.
const MOST_PANELS: usize = 4;

/// Draws a figure for each number, with a panel for each point of the grid, or for some of many.
pub(super) fn draw(study: &Drawn<'_>, figures: &mut Figures<'_>) -> Result<(), Error> {
    let Some(rows) = study.recorded.ensemble.as_ref().filter(|rows| !rows.is_empty()) else {
        return Ok(());
    };
    let runs = rows.column("run")?;
    let mut points = runs.clone();
    points.dedup();
    let shown: Vec<f64> =
        chosen(points.len(), MOST_PANELS).into_iter().map(|k| points[k]).collect();
    let names: Vec<String> = rows
        .names()
        .iter()
        .filter_map(|name| name.strip_suffix(".q50"))
        .map(str::to_owned)
        .collect();
    for name in names {
        let mut panels = Vec::new();
        for run in &shown {
            panels.push(panel(study, rows, &name, (&runs, *run))?);
        }
        crate::figure::over_time::letter(panels.iter_mut());
        let sheet = Sheet {
            width: SINGLE_COLUMN,
            heights: vec![Height::OfWidth(0.6); panels.len()],
            rows: panels.into_iter().map(|panel| vec![Some(panel)]).collect(),
            shared_x: false,
        };
        let title = format!("{} of an ensemble over revolutions", words::of_number(&name).plain());
        let short = name.strip_suffix(".value").unwrap_or(&name);
        figures.add("convergence", Some(short), &title, vec![sheet]);
    }
    Ok(())
}

fn panel(
    study: &Drawn<'_>,
    rows: &Rows,
    name: &str,
    (runs, run): (&[f64], f64),
) -> Result<Panel, Error> {
    let of = |column: &str| -> Result<Vec<f64>, Error> {
        let all = rows.column(column)?;
        Ok(all
            .into_iter()
            .zip(runs)
            .filter(|(_, of)| **of == run)
            .map(|(value, _)| value)
            .collect())
    };
    let number = |end: &str| of(&format!("{name}.{end}"));
    let revolutions = of("revolution")?;
    let [mean, low, high] = [number("mean")?, number("mean_low")?, number("mean_high")?];
    let [q05, q95, long] = [number("q05")?, number("q95")?, number("long_mean")?];
    let over = |values: &[f64]| -> Vec<[f64; 2]> {
        revolutions.iter().zip(values).map(|(x, y)| [*x, *y]).collect()
    };
    let band = |low: &[f64], high: &[f64]| -> Vec<[f64; 3]> {
        let ends = revolutions.iter().zip(low).zip(high);
        ends.map(|((x, low), high)| [*x, *low, *high]).collect()
    };
    let errors = Stroke::solid(VERMILLION, 0.6);
    let mut marks = vec![
        Mark::Band(band(&q05, &q95), BAND),
        Mark::Path(over(&low), errors),
        Mark::Path(over(&high), errors),
        Mark::Path(over(&mean), RUN),
        Mark::Path(over(&long), IDEAL),
    ];
    let ends = q05.iter().chain(&q95).chain(&long).chain(&low).chain(&high).copied();
    let y = super::axis(words::of_number(name), rows.unit(&format!("{name}.mean")), ends);
    let x = Axis::fitting(Text::roman("Revolution"), "1", revolutions.iter().copied());
    let from = number("agrees_from")?.first().copied().filter(|from| from.is_finite());
    if let Some(from) = from {
        marks.insert(1, Mark::Path(vec![[from, y.range[0]], [from, y.range[1]]], GUIDE));
    }
    let values: Vec<String> = (study.variables.iter())
        .map(|variable| variable.equals(study.value(variable, run as u64)).plain())
        .collect();
    let agrees = match from {
        Some(from) => format!("one distribution from {} on", digits(from, 6)),
        None => "not yet one distribution".to_owned(),
    };
    let legend = vec![
        (Sample::Line(RUN), Text::roman("mean of the copies")),
        (Sample::Line(errors), Text::roman("its 95 % interval")),
        (Sample::Bar(BAND), Text::roman("9 of 10 copies")),
        (Sample::Line(IDEAL), Text::roman("mean of the long run")),
        (Sample::Line(GUIDE), Text::roman(agrees)),
    ];
    Ok(Panel { label: Text::roman(values.join(", ")), legend, x, y, marks })
}
