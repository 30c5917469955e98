//! Fewer points for the same picture.
//!
//! A curve over time keeps, in each column of the picture, its first, lowest, highest and last
//! point, so that no extremum goes. A path keeps as many points as it takes to stay within a
//! tolerance of all the others. Points that are not finite break a line, and stay as breaks.

/// A point: x and y, in any unit.
pub(super) type Point = [f64; 2];

/// A break in a line.
pub(super) const BREAK: Point = [f64::NAN, f64::NAN];

fn is_finite(point: &Point) -> bool {
    point[0].is_finite() && point[1].is_finite()
}

/// Keeps of each column of x its first, lowest, highest and last point.
pub(super) fn by_columns(points: &[Point], width: f64) -> Vec<Point> {
    let mut kept = Vec::new();
    let mut column: Option<Column> = None;
    for (index, point) in points.iter().enumerate() {
        if !is_finite(point) {
            flush(&mut kept, column.take());
            kept.push(BREAK);
            continue;
        }
        let number = (point[0] / width).floor();
        match &mut column {
            Some(column) if column.number == number => column.add(index, *point),
            _ => flush(&mut kept, column.replace(Column::new(number, index, *point))),
        }
    }
    flush(&mut kept, column);
    kept
}

fn flush(kept: &mut Vec<Point>, column: Option<Column>) {
    let Some(column) = column else { return };
    let mut chosen = column.chosen;
    chosen.sort_by_key(|(index, _)| *index);
    let mut last = None;
    for (index, point) in chosen {
        if last != Some(index) {
            kept.push(point);
        }
        last = Some(index);
    }
}

/// What is kept of a column: first, lowest, highest, last, each with its place in the curve.
struct Column {
    number: f64,
    chosen: [(usize, Point); 4],
}

impl Column {
    fn new(number: f64, index: usize, point: Point) -> Self {
        Column { number, chosen: [(index, point); 4] }
    }

    fn add(&mut self, index: usize, point: Point) {
        let [_, lowest, highest, last] = &mut self.chosen;
        if point[1] < lowest.1[1] {
            *lowest = (index, point);
        }
        if point[1] > highest.1[1] {
            *highest = (index, point);
        }
        *last = (index, point);
    }
}

/// Drops points as long as the line through the others passes all of them within a tolerance, in
/// one pass: from each point kept, a cone of directions is narrowed until the next point lies
/// outside it, or turns back.
pub(super) fn by_distance(points: &[Point], tolerance: f64) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    let mut leg: Option<Leg> = None;
    for point in points {
        if !is_finite(point) {
            kept.extend(leg.take().and_then(|leg| leg.end));
            kept.push(BREAK);
            continue;
        }
        let Some(current) = &mut leg else {
            kept.push(*point);
            leg = Some(Leg::from(*point));
            continue;
        };
        if current.reaches(*point, tolerance) {
            continue;
        }
        let turn = current.end.unwrap_or(current.start);
        kept.push(turn);
        let mut next = Leg::from(turn);
        next.reaches(*point, tolerance);
        leg = Some(next);
    }
    kept.extend(leg.and_then(|leg| leg.end));
    kept
}

/// A straight piece of a simplified path that is still growing.
struct Leg {
    start: Point,
    end: Option<Point>,
    /// Distance of the end from the start.
    length: f64,
    /// None while all points lie about the start.
    cone: Option<Cone>,
}

/// Directions in which a leg passes all of its points.
struct Cone {
    /// Direction about which the cone lies (rad).
    axis: f64,
    /// Its edges, as angles from the axis (rad).
    edges: [f64; 2],
}

impl Leg {
    fn from(start: Point) -> Self {
        Leg { start, end: None, length: 0.0, cone: None }
    }

    /// Takes a point in if the straight line to it passes all points so far.
    fn reaches(&mut self, point: Point, tolerance: f64) -> bool {
        let offset = [point[0] - self.start[0], point[1] - self.start[1]];
        let distance = offset[0].hypot(offset[1]);
        let about_the_start = distance <= tolerance && self.cone.is_none();
        if !about_the_start {
            if distance < self.length {
                return false;
            }
            let direction = offset[1].atan2(offset[0]);
            let half = (tolerance / distance).min(1.0).asin();
            let cone = self.cone.get_or_insert(Cone { axis: direction, edges: [-1.5, 1.5] });
            let turn = wrap(direction - cone.axis);
            if turn < cone.edges[0] || turn > cone.edges[1] {
                return false;
            }
            cone.edges = [cone.edges[0].max(turn - half), cone.edges[1].min(turn + half)];
            self.length = distance;
        }
        self.end = Some(point);
        true
    }
}

/// An angle as one in −π to π (rad).
fn wrap(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    (angle + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn distance_to(point: Point, [a, b]: [Point; 2]) -> f64 {
        let (along, to) = ([b[0] - a[0], b[1] - a[1]], [point[0] - a[0], point[1] - a[1]]);
        let square = along[0].powi(2) + along[1].powi(2);
        let share = if square > 0.0 {
            ((along[0] * to[0] + along[1] * to[1]) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (to[0] - share * along[0]).hypot(to[1] - share * along[1])
    }

    /// Largest distance of a path's points from another path.
    fn farthest(points: &[Point], path: &[Point]) -> f64 {
        let pieces: Vec<[Point; 2]> = path.windows(2).map(|piece| [piece[0], piece[1]]).collect();
        let nearest = |point: &Point| {
            let distances = pieces.iter().map(|piece| distance_to(*point, *piece));
            distances.fold(f64::INFINITY, f64::min)
        };
        points.iter().map(nearest).fold(0.0, f64::max)
    }

    fn wave(count: usize) -> Vec<Point> {
        let point = |k: usize| {
            let x = k as f64 / count as f64;
            let spike = if k % 99_991 == 5 { 7.0 + x } else { 0.0 };
            [500.0 * x, (40.0 * x).sin() + spike]
        };
        (0..count).map(point).collect()
    }

    #[test]
    fn a_million_points_become_four_a_column_and_every_spike_stays() {
        let points = wave(1_000_000);
        let kept = by_columns(&points, 0.5);
        assert!(kept.len() <= 4 * 1000, "{}", kept.len());
        let spikes = |points: &[Point]| -> Vec<Point> {
            points.iter().filter(|point| point[1] > 5.0).copied().collect()
        };
        assert_eq!(spikes(&points).len(), 11);
        assert_eq!(spikes(&kept), spikes(&points));
        assert_eq!((kept[0], kept.last()), (points[0], points.last()));
        assert!(kept.windows(2).all(|pair| pair[0][0] <= pair[1][0]));
    }

    #[test]
    fn a_point_that_is_no_number_breaks_the_line() {
        let points = [[0.0, 1.0], [0.1, f64::NAN], [0.2, f64::INFINITY], [0.3, 2.0], [0.35, 2.0]];
        for kept in [by_columns(&points, 1.0), by_distance(&points, 0.01)] {
            let finite: Vec<bool> = kept.iter().map(is_finite).collect();
            assert_eq!(finite, [true, false, false, true, true], "{kept:?}");
        }
    }

    #[test]
    fn of_nothing_nothing_is_kept_and_of_one_point_one() {
        assert!(by_columns(&[], 0.5).is_empty() && by_distance(&[], 0.5).is_empty());
        let one = [[1.0, 2.0]];
        assert_eq!((by_columns(&one, 0.5), by_distance(&one, 0.5)), (one.to_vec(), one.to_vec()));
    }

    #[test]
    fn a_straight_line_becomes_its_ends_and_a_spike_its_tip() {
        let line: Vec<Point> = (0..1000).map(|k| [f64::from(k), 2.0 * f64::from(k)]).collect();
        assert_eq!(by_distance(&line, 0.01), [line[0], line[999]]);
        let heights = (0..=100).chain((0..100).rev());
        let spike: Vec<Point> = heights.map(|height| [1.0, f64::from(height)]).collect();
        assert_eq!(by_distance(&spike, 0.01), [[1.0, 0.0], [1.0, 100.0], [1.0, 0.0]]);
    }

    #[test]
    fn a_circle_of_many_turns_needs_few_points_a_turn() {
        let angle = |k: u32| f64::from(k) * 1e-3;
        let points: Vec<Point> =
            (0..100_000).map(|k| [60.0 * angle(k).cos(), 60.0 * angle(k).sin()]).collect();
        let kept = by_distance(&points, 0.02);
        // A chord that leaves its arc by 0.02 pt spans at least √(8 · 0.02/60) rad.
        let turns = 100.0 / std::f64::consts::TAU;
        assert!((kept.len() as f64) < turns * 130.0, "{}", kept.len());
    }

    proptest! {
        #[test]
        fn no_point_is_farther_from_the_kept_path_than_the_tolerance(
            steps in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64), 1..200),
            scale in prop::sample::select(vec![0.003, 0.02, 0.3, 5.0]),
        ) {
            let mut points = vec![[0.0, 0.0]];
            for (x, y) in steps {
                let last = points[points.len() - 1];
                points.push([last[0] + scale * x, last[1] + scale * y]);
            }
            let kept = by_distance(&points, 0.02);
            prop_assert_eq!((kept[0], kept.last()), (points[0], points.last()));
            if kept.len() > 1 {
                prop_assert!(farthest(&points, &kept) <= 0.02 * (1.0 + 1e-9));
            }
        }

        #[test]
        fn the_range_of_a_curve_is_the_range_of_what_is_kept(
            values in prop::collection::vec(-1e6..1e6_f64, 1..500),
            width in 0.1..50.0_f64,
        ) {
            let points: Vec<Point> =
                values.iter().enumerate().map(|(k, value)| [k as f64, *value]).collect();
            let range = |points: &[Point]| points.iter().fold(
                [f64::INFINITY, f64::NEG_INFINITY],
                |[low, high], point| [low.min(point[1]), high.max(point[1])],
            );
            prop_assert_eq!(range(&by_columns(&points, width)), range(&points));
        }
    }
}
