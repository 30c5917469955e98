//! Response curves: a number of the runs over what varies. Of what each revolution has, the median
//! and the band that nine tenths of the revolutions lie in.

use super::{Drawn, Over, Series, exponents, quantile, sorted};
use crate::figure::Figures;
use crate::figure::cloud::dot;
use crate::figure::palette::{BAND, RUN};
use crate::figure::panel::{Mark, Panel, Sample};
use crate::figure::sheet::{Height, SINGLE_COLUMN, Sheet};
use crate::figure::text::Text;
use crate::study::Error;

/// The band's lower and upper end, as shares of the revolutions.
const ENDS: [f64; 2] = [0.05, 0.95];
/// Runs of which each has its dot on the curve.
const FEW: usize = 60;
/// A value that varies from revolution to revolution by no more than this share varies by nothing
/// that could be seen.
const NARROW: f64 = 1e-3;

/// Draws a figure for each number, with a panel for each variable; of two variables on a grid there
/// are heat maps instead.
pub(super) fn draw(study: &Drawn<'_>, figures: &mut Figures<'_>) -> Result<(), Error> {
    if study.variables.is_empty() || super::heat_map::is_for(study) {
        return Ok(());
    }
    let series = study.series()?;
    // exponents have a figure of their own, intervals and all
    let drawn = series.iter().filter(|series| !exponents::is_of_one(&series.name));
    for series in drawn.filter(|series| !series.runs.is_empty()) {
        let panels = study.variables.iter().map(|variable| panel(study, series, variable));
        let mut panels: Vec<Panel> = panels.collect();
        crate::figure::over_time::letter(panels.iter_mut());
        let sheet = Sheet {
            width: SINGLE_COLUMN,
            heights: vec![Height::OfWidth(0.7); panels.len()],
            rows: panels.into_iter().map(|panel| vec![Some(panel)]).collect(),
            shared_x: false,
        };
        let words = super::words::of_number(&series.name).plain();
        let over: Vec<String> = (study.variables.iter())
            .map(|variable| super::words::in_a_sentence(&variable.name))
            .collect();
        let title = format!("{words} over {}", over.join(", "));
        let name = series.name.strip_suffix(".value").unwrap_or(&series.name);
        figures.add("response", Some(name), &title, vec![sheet]);
    }
    Ok(())
}

fn panel(study: &Drawn<'_>, series: &Series, variable: &Over) -> Panel {
    let mut places: Vec<(f64, [f64; 3])> = (series.runs.iter())
        .map(|(run, values)| {
            let values = sorted(values);
            let [low, high] = ENDS.map(|share| quantile(&values, share));
            (study.value(variable, *run), [low, quantile(&values, 0.5), high])
        })
        .collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all = || places.iter().flat_map(|(_, values)| *values);
    let y = series.axis(all().chain(zero_if_near(all())));
    let single = study.variables.len() == 1;
    let wide = |&(_, [low, middle, high]): &(f64, [f64; 3])| high - low > NARROW * middle.abs();
    let banded = series.of_revolutions && places.iter().any(wide);
    let medians: Vec<[f64; 2]> = places.iter().map(|(x, [_, middle, _])| [*x, *middle]).collect();
    let mut marks = Vec::new();
    let mut legend = Vec::new();
    if single && banded {
        let band = places.iter().map(|(x, [low, _, high])| [*x, *low, *high]);
        marks.push(Mark::Band(band.collect(), BAND));
        legend.push((Sample::Bar(BAND), Text::roman("9 of 10 revolutions")));
    }
    if single {
        marks.push(Mark::Path(medians.clone(), RUN));
        if banded {
            legend.insert(0, (Sample::Line(RUN), Text::roman("median")));
        }
    }
    if single && medians.len() <= FEW {
        marks.push(Mark::Dots(medians, dot(0)));
    } else if !single {
        let dot = dot(medians.len());
        marks.push(Mark::Cloud(medians, dot));
    }
    Panel { label: Text::default(), legend, x: variable.axis(), y, marks }
}

/// Zero, where it is no farther from values than they reach from each other.
fn zero_if_near(values: impl Iterator<Item = f64>) -> Option<f64> {
    let [low, high] = crate::figure::panel::range_of(values)?;
    (low > 0.0 && low < high - low).then_some(0.0)
}
