//! What should be known about two files beside their digits.

use super::comparison::Read;
use super::quantity::{Parts, Quantity};
use super::series::{Aligned, Series};
use crate::certify::{ONE_DRAW, ms};

/// Columns written with fewer significant digits are told.
const FEW_DIGITS: usize = 12;

/// How near the ratio of two angles must be to 180/π for one to be in degrees.
const LIKE_DEGREES: f64 = 0.02;

/// Everything to be noted.
pub fn notes(
    theirs: &Read<'_>,
    reference: &Read<'_>,
    values: &Aligned,
    series: &Series,
    parts: &Parts,
) -> Vec<String> {
    let mut notes = Vec::new();
    for read in [theirs, reference] {
        notes.extend(notes_on(read));
        notes.extend(beyond(read, values));
    }
    notes.extend(repeated(theirs));
    notes.extend(turned(values, series, parts));
    notes.extend(degrees(theirs, values, parts));
    notes
}

/// What a table's own writing makes doubtful.
fn notes_on(read: &Read<'_>) -> Vec<String> {
    let Some((table, mapping)) = read.foreign() else { return Vec::new() };
    let path = read.path().display();
    let mut notes: Vec<String> =
        mapping.notes.iter().map(|note| format!("{path}: {note}")).collect();
    if table.ends_within_a_line {
        notes.push(format!("{path} ends within a line: its last number may be cut short"));
    }
    let used = mapping.columns.iter().map(|mapped| &table.columns[mapped.theirs]);
    let written = used.filter_map(|column| column.written_digits);
    if let Some(most) = written.max().filter(|most| (1..FEW_DIGITS).contains(most)) {
        notes.push(format!("{path} is written with {most} significant digits: no more can agree"));
    }
    notes
}

/// A result that is looked at beyond its horizon.
fn beyond(read: &Read<'_>, values: &Aligned) -> Option<String> {
    let horizon = read.horizon()?;
    let last = values.times.last()?;
    let until = horizon.state.min(horizon.forces);
    (*last > until && until < horizon.end).then(|| {
        format!(
            "{} means something until {} only, its forces until {}; behind that (*) its numbers \
             are each {ONE_DRAW}, and so is how far they agree",
            read.path().display(),
            ms(horizon.state),
            ms(horizon.forces)
        )
    })
}

/// Times that stand twice.
fn repeated(theirs: &Read<'_>) -> Option<String> {
    let twice = theirs.trajectory.times.windows(2).filter(|pair| pair[0] == pair[1]).count();
    (twice > 0).then(|| {
        format!("{} has {twice} times more than once; each row is graded", theirs.path().display())
    })
}

/// Angles that are off by whole turns.
fn turned(values: &Aligned, series: &Series, parts: &Parts) -> Option<String> {
    let name = |index: &usize| parts.name(&values.columns[*index]);
    let names: Vec<String> = series.turned.iter().map(name).collect();
    let is = if names.len() == 1 { "is" } else { "are" };
    (!names.is_empty())
        .then(|| format!("{} {is} off by whole turns, which are not counted", names.join(", ")))
}

/// Angles that look like degrees.
fn degrees(theirs: &Read<'_>, values: &Aligned, parts: &Parts) -> Option<String> {
    theirs.foreign()?;
    let like_degrees = |index: &usize| {
        let ratio = values.theirs[*index][0] / values.reference[*index][0];
        let degrees = ratio.to_radians();
        values.columns[*index].quantity() == Some(Quantity::Angle)
            && (degrees - 1.0).abs() < LIKE_DEGREES
    };
    let index = (0..values.columns.len()).find(like_degrees)?;
    Some(format!(
        "{} begins as it would in degrees; a name like \"phi [deg]\", or --map 'THEIRS[deg]={0}', \
         would say so",
        parts.name(&values.columns[index])
    ))
}
