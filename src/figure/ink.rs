//! Lines over lines: what lies wholly on ink that is there already need not be drawn again.

use super::decimate::{BREAK, Point};

/// Width of the squares in which ink is remembered (pt).
const CELL: f64 = 0.1;
/// Distance of the places at which ink is laid and looked for (pt).
const DENSE: f64 = 0.5 * CELL;
/// Paths of fewer points are not worth the trouble.
const FEW: usize = 4000;

/// Drops the pieces of a path that earlier pieces of it have covered, as wide as the line is (pt).
/// What is left draws the same picture to a tenth of a point, and its length is bounded by the area
/// that it fills instead of by that of the path.
pub(super) fn without_covered(points: Vec<Point>, width: f64) -> Vec<Point> {
    if points.len() < FEW {
        return points;
    }
    let mut ink = Ink::about(&points, width);
    let mut kept: Vec<Point> = Vec::new();
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        if !(from[0] + from[1] + to[0] + to[1]).is_finite() || ink.covers(from, to) {
            continue;
        }
        if kept.last() != Some(&from) {
            kept.extend([BREAK, from]);
        }
        kept.push(to);
        ink.lay(from, to);
    }
    kept
}

/// The ink laid so far: a bit for each square.
struct Ink {
    /// Half of the line's width (pt).
    half: f64,
    /// Left upper corner (pt).
    corner: Point,
    /// Squares across and down.
    size: [usize; 2],
    bits: Vec<u64>,
}

impl Ink {
    /// No ink yet, and room for lines through these points.
    fn about(points: &[Point], width: f64) -> Self {
        let half = 0.5 * width;
        let mut ends = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for point in points.iter().filter(|point| point.iter().all(|value| value.is_finite())) {
            for axis in 0..2 {
                ends[0][axis] = ends[0][axis].min(point[axis] - half);
                ends[1][axis] = ends[1][axis].max(point[axis] + half);
            }
        }
        let across = |axis: usize| ((ends[1][axis] - ends[0][axis]) / CELL).ceil().max(0.0) + 1.0;
        let size = [across(0) as usize, across(1) as usize];
        let bits = vec![0; (size[0] * size[1]).div_ceil(64)];
        Ink { half, corner: ends[0], size, bits }
    }

    /// Whether a piece of line, both edges included, is on ink everywhere.
    fn covers(&self, from: Point, to: Point) -> bool {
        let inset = self.half - DENSE;
        [0.0, inset, -inset].iter().all(|aside| {
            along(from, to, *aside).all(|place| {
                let cell = self.cell(place);
                self.bits[cell / 64] >> (cell % 64) & 1 == 1
            })
        })
    }

    fn lay(&mut self, from: Point, to: Point) {
        let lines = (self.half / DENSE).floor() as i32;
        for line in -lines..=lines {
            for place in along(from, to, DENSE * f64::from(line)) {
                let cell = self.cell(place);
                self.bits[cell / 64] |= 1 << (cell % 64);
            }
        }
    }

    fn cell(&self, place: Point) -> usize {
        let [x, y] = [0, 1].map(|axis| {
            let cell = ((place[axis] - self.corner[axis]) / CELL) as usize;
            cell.min(self.size[axis] - 1)
        });
        y * self.size[0] + x
    }
}

/// Places on a line beside another one, half a square apart at most.
fn along(from: Point, to: Point, aside: f64) -> impl Iterator<Item = Point> {
    let [x, y] = [to[0] - from[0], to[1] - from[1]];
    let length = x.hypot(y);
    let normal =
        if length > 0.0 { [-y / length * aside, x / length * aside] } else { [aside, 0.0] };
    let steps = (length / DENSE).ceil().max(1.0);
    (0..=steps as usize).map(move |step| {
        let share = step as f64 / steps;
        [from[0] + share * x + normal[0], from[1] + share * y + normal[1]]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle of 60 pt run through many times, each time a little farther in.
    fn turns(count: u32, drift: f64) -> Vec<Point> {
        let points = (0..count * 100).map(|k| {
            let angle = f64::from(k) / 100.0 * std::f64::consts::TAU;
            let radius = 60.0 - drift * f64::from(k);
            [radius * angle.cos(), radius * angle.sin()]
        });
        points.collect()
    }

    #[test]
    fn a_circle_drawn_a_hundred_times_is_drawn_once() {
        let kept = without_covered(turns(100, 0.0), 0.4);
        assert!((101..150).contains(&kept.len()), "{}", kept.len());
    }

    #[test]
    fn lines_beside_each_other_all_stay() {
        let points = turns(60, 0.005);
        assert_eq!(without_covered(points.clone(), 0.4)[1..], points);
    }

    #[test]
    fn what_is_kept_fills_an_area_and_does_not_grow_with_the_path() {
        // A ring of 4 pt, filled by 400 turns and by 4000.
        let [few, many] = [(400, 1e-4), (4000, 1e-5)].map(|(count, drift)| turns(count, drift));
        let kept = without_covered(many.clone(), 0.4);
        assert!(kept.len() < 2 * without_covered(few, 0.4).len(), "{}", kept.len());
        for point in many.iter().step_by(97) {
            let near = |other: &Point| (other[0] - point[0]).hypot(other[1] - point[1]) < 0.4;
            assert!(kept.iter().any(near), "{point:?}");
        }
    }

    #[test]
    fn short_paths_are_left_alone() {
        let points = vec![[0.0, 0.0], [1.0, 1.0], [0.0, 0.0], BREAK, [1.0, 1.0]];
        let same = without_covered(points.clone(), 0.4);
        assert_eq!(format!("{same:?}"), format!("{points:?}"));
    }
}
