//! Clouds of points: what lies on ink that is there already is not drawn again, and points that
//! touch become a line.

use super::decimate::{BREAK, Point};
use super::palette::BLUE;
use super::panel::Dot;
use std::collections::BTreeMap;

/// How the points of a cloud of so many are drawn: few so that each is seen.
pub(super) fn dot(points: usize) -> Dot {
    let radius = match points {
        0..200 => 1.2,
        200..2000 => 0.8,
        _ => 0.4,
    };
    Dot { radius, colour: BLUE }
}

/// Lines that a cloud may have: about a megabyte of them.
const MOST_LINES: usize = 50_000;

/// Width of a cell (pt): no point is drawn farther than that from where it is.
const CELL: f64 = 0.2;

/// Gives the lines that draw some points (pt), lone ones as points, with breaks between: those of
/// [`lines`] for a narrow cell, or for a wider one where there would be too many.
pub(super) fn merged(points: &[Point]) -> Vec<Point> {
    let mut cell = CELL;
    loop {
        let lines = lines(points, cell);
        if lines.iter().filter(|point| point[0].is_nan()).count() <= MOST_LINES {
            return lines;
        }
        cell *= 1.25;
    }
}

/// Puts points (pt) into cells of this width and gives, for each upright row of cells that follow
/// each other, the line through them, a lone cell as a point. Each column of cells stands where its
/// first point does, so that points of the same x stay under each other exactly.
fn lines(points: &[Point], cell: f64) -> Vec<Point> {
    let mut columns: BTreeMap<i64, (f64, Vec<i64>)> = BTreeMap::new();
    for &[x, y] in points.iter().filter(|[x, y]| (x + y).is_finite()) {
        let column = columns.entry((x / cell).floor() as i64).or_insert((x, Vec::new()));
        column.1.push((y / cell).floor() as i64);
    }
    let mut lines = Vec::new();
    let height = |row: i64| (row as f64 + 0.5) * cell;
    for (x, mut rows) in columns.into_values() {
        rows.sort_unstable();
        rows.dedup();
        for line in rows.chunk_by(|a, b| b - a == 1) {
            lines.extend([BREAK, [x, height(line[0])]]);
            if let [_, .., last] = line {
                lines.push([x, height(*last)]);
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::svg::{Stroke, Svg};
    use proptest::prelude::*;

    #[test]
    fn points_that_touch_become_lines() {
        let points = [[1.02, 0.5], [1.03, 0.61], [1.02, 0.52], [1.02, 0.9], [f64::NAN, 1.0]];
        let drawn = super::lines(&points, 0.1);
        let lines: Vec<Vec<Point>> = (drawn.split(|point| point[0].is_nan()))
            .filter(|line| !line.is_empty())
            .map(<[Point]>::to_vec)
            .collect();
        assert_eq!(lines.len(), 2);
        assert_eq!((lines[0].len(), lines[1].len()), (2, 1));
        assert!(lines.iter().flatten().all(|point| point[0] == 1.02));
    }

    #[test]
    fn a_million_points_are_less_than_a_megabyte_however_they_lie() {
        fastrand::seed(12);
        for (across, columns) in [(480.0, 1e9), (480.0, 400.0), (255.0, 1e9)] {
            for share in [0.2, 1.0] {
                let random = || fastrand::f64();
                let x = || (random() * columns).floor() / columns * across;
                let count = (share * 1e6) as usize;
                let points: Vec<Point> = (0..count).map(|_| [x(), 250.0 * random()]).collect();
                let mut svg = Svg::new([190.0, 100.0], "", "");
                svg.path(&merged(&points), &Stroke::solid(BLUE, 0.8));
                let bytes = svg.finish().len();
                assert!(bytes < 1_000_000, "{across} {columns} {share}: {bytes}");
            }
        }
    }

    proptest! {
        #[test]
        fn every_point_lies_within_a_cell_of_what_is_drawn(
            points in prop::collection::vec([0.0..20.0_f64, 0.0..20.0], 1..300),
        ) {
            let drawn = super::lines(&points, 0.5);
            for [x, y] in points {
                let near = drawn.windows(2).any(|pair| {
                    let [a, b] = [pair[0], pair[1]];
                    let [low, high] = if a[0].is_nan() { [b[1], b[1]] } else { [a[1], b[1]] };
                    let [low, high] = if b[0].is_nan() { [a[1], a[1]] } else { [low, high] };
                    let at = if a[0].is_nan() { b[0] } else { a[0] };
                    (at - x).abs() <= 0.5 && y >= low - 0.2501 && y <= high + 0.2501
                });
                prop_assert!(near, "{x} {y}");
            }
        }
    }
}
