//! Lyapunov exponents of the runs over what varies, with their intervals and the line of zero: above it
//! motions are chaotic.

use super::{Drawn, Over, Series, axis};
use crate::figure::Figures;
use crate::figure::cloud::dot;
use crate::figure::palette::{BAND, GUIDE, OVERLAID};
use crate::figure::panel::{Mark, Panel, Sample};
use crate::figure::sheet::{Height, SINGLE_COLUMN, Sheet};
use crate::figure::text::Text;
use crate::study::Error;

/// Whether a column tells of one exponent.
pub(super) fn is_of_one(name: &str) -> bool {
    let rest = name.strip_prefix("lyapunov.");
    let rest = rest.and_then(|rest| rest.split_once('.'));
    rest.is_some_and(|(number, _)| number.parse::<usize>().is_ok())
}

/// Draws a figure of all exponents, with a panel for each variable; of two variables on a grid there are
/// heat maps instead.
pub(super) fn draw(study: &Drawn<'_>, figures: &mut Figures<'_>) -> Result<(), Error> {
    if study.variables.is_empty() || super::heat_map::is_for(study) {
        return Ok(());
    }
    let all = study.series_of(&study.recorded.runs, "case_sha256", false)?;
    let of = |k: usize, what: &str| {
        all.iter().find(|series| series.name == format!("lyapunov.{k}.{what}"))
    };
    let exponents: Vec<(&Series, Option<&Series>)> = (1..)
        .map_while(|k| Some((of(k, "value")?, of(k, "half_width"))))
        .take(OVERLAID.len())
        .filter(|(series, _)| !series.runs.is_empty())
        .collect();
    if exponents.is_empty() {
        return Ok(());
    }
    let panels = study.variables.iter().map(|variable| panel(study, &exponents, variable));
    let mut panels: Vec<Panel> = panels.collect();
    crate::figure::over_time::letter(panels.iter_mut());
    let sheet = Sheet {
        width: SINGLE_COLUMN,
        heights: vec![Height::OfWidth(0.7); panels.len()],
        rows: panels.into_iter().map(|panel| vec![Some(panel)]).collect(),
        shared_x: false,
    };
    let over: Vec<String> = (study.variables.iter())
        .map(|variable| super::words::in_a_sentence(&variable.name))
        .collect();
    let title = format!("Lyapunov exponents over {}", over.join(", "));
    figures.add("exponents", None, &title, vec![sheet]);
    Ok(())
}

fn panel(study: &Drawn<'_>, exponents: &[(&Series, Option<&Series>)], variable: &Over) -> Panel {
    let curves: Vec<Vec<[f64; 3]>> = (exponents.iter())
        .map(|(values, widths)| {
            let width = |run: u64| {
                let widths = widths.and_then(|widths| {
                    let place = widths.runs.binary_search_by_key(&run, |(run, _)| *run).ok()?;
                    widths.runs[place].1.first().copied()
                });
                widths.unwrap_or(0.0)
            };
            let mut places: Vec<[f64; 3]> = (values.runs.iter())
                .filter_map(|(run, values)| {
                    Some([study.value(variable, *run), *values.first()?, width(*run)])
                })
                .collect();
            places.sort_by(|a, b| a[0].total_cmp(&b[0]));
            places
        })
        .collect();
    let ends = curves.iter().flatten().flat_map(|[_, value, width]| [value - width, value + width]);
    let y = axis(Text::roman("Exponent (e-folds per revolution)"), "1", ends.chain([0.0]));
    let x = variable.axis();
    let mut marks = vec![Mark::Path(vec![[x.range[0], 0.0], [x.range[1], 0.0]], GUIDE)];
    let single = study.variables.len() == 1;
    if single {
        marks.extend(curves.iter().map(|curve| {
            let band = curve.iter().map(|[x, value, width]| [*x, value - width, value + width]);
            Mark::Band(band.collect(), BAND)
        }));
    }
    let mut legend = Vec::new();
    for (number, (curve, stroke)) in curves.iter().zip(OVERLAID).enumerate() {
        let points: Vec<[f64; 2]> = curve.iter().map(|[x, value, _]| [*x, *value]).collect();
        if single {
            marks.push(Mark::Path(points, stroke));
            let name = Text::italic("λ").and_subscript((number + 1).to_string());
            legend.push((Sample::Line(stroke), name));
        } else {
            let dot = dot(points.len());
            marks.push(Mark::Cloud(points, dot));
        }
    }
    if single {
        legend.push((Sample::Bar(BAND), Text::roman("95 % intervals")));
    }
    Panel { label: Text::default(), legend, x, y, marks }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sum_and_dimension_are_no_single_exponents() {
        let of_one = |name: &str| is_of_one(name);
        assert!(of_one("lyapunov.1.value") && of_one("lyapunov.12.half_width"));
        assert!(!of_one("lyapunov.sum.value") && !of_one("lyapunov.kaplan_yorke.value"));
        assert!(!of_one("attractor.revolutions") && !of_one("clearances.1.contacts"));
    }
}
