//! A square piece of a panel, drawn enlarged where the panel is empty.

use super::decimate::{BREAK, Point};
use super::palette::FRAME;
use super::panel::{Axis, Frame, LABEL_GAP, MIDDLE, Mark, Panel, SMALL_TYPE};
use super::quantity::Unit;
use super::svg::{Anchor, Stroke, Svg};
use super::text::Text;

/// Side of an enlarged piece, in widths of its panel.
pub(super) const INSET: f64 = 0.34;
/// Least side of the square about a piece that is enlarged (pt).
const LEAST_PIECE: f64 = 3.0;
/// Frames of the piece and of what is enlarged.
const INSET_FRAME: Stroke = Stroke::solid("#555", 0.5);

/// The largest of 1, 2, 5 times a power of ten that is no larger.
pub(super) fn round_down(value: f64) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    let lead = value / power * (1.0 + 1e-9);
    power * [5.0, 2.0].into_iter().find(|round| lead >= *round).unwrap_or(1.0)
}

/// How many times something is enlarged, to two digits.
fn magnification(times: f64) -> f64 {
    let digit = 10_f64.powf(times.log10().floor() - 1.0);
    if digit >= 1.0 { (times / digit).round() * digit } else { (times * 10.0).round() / 10.0 }
}

/// A square piece of a panel whose axes are alike, drawn enlarged where the panel is empty.
#[derive(Debug, Clone)]
pub(super) struct Inset {
    /// Centre of the piece.
    pub centre: Point,
    /// Half of its side.
    pub half: f64,
    /// Where the middle of the enlarged piece is.
    pub place: Point,
    /// What is drawn in it.
    pub marks: Vec<Mark>,
}

impl Inset {
    /// Draws a piece enlarged, with a line to where it is, and a bar that tells its scale.
    pub fn draw(&self, svg: &mut Svg, frame: Frame, panel: &Panel) {
        let place = |[x, y]: Point| [panel.across(frame, x), panel.down(frame, y)];
        let side = INSET * frame.size[0];
        let ([x, y], from) = (place(self.place), place(self.centre));
        let corner = [x - 0.5 * side, y - 0.5 * side];
        let piece = 2.0 * self.half * frame.size[0] / (panel.x.range[1] - panel.x.range[0]);
        let shown = 0.5 * piece.max(LEAST_PIECE);
        let ends = |[x, y]: Point, half: f64| [[x - half, y - half], [x + half, y + half]];
        let [low, high] = ends(from, shown);
        svg.frame(low, high, &INSET_FRAME);
        // from the edge of the piece on, so that the line hides nothing in it
        let [across, down] = [x - from[0], y - from[1]];
        let share = shown / across.abs().max(down.abs()).max(shown);
        let edge = [from[0] + share * across, from[1] + share * down];
        svg.lines([[edge, [x, y]]], &INSET_FRAME);
        let [low, high] = ends([x, y], 0.5 * side);
        svg.rectangles([[low, high]], "#fff");
        let axis = |axis: &Axis, middle: f64| Axis {
            range: [middle - self.half, middle + self.half],
            ..axis.clone()
        };
        let [middle_x, middle_y] = self.centre;
        let within = Frame { corner, size: [side; 2] };
        let enlarged = Panel {
            label: Text::default(),
            legend: Vec::new(),
            x: axis(&panel.x, middle_x),
            y: axis(&panel.y, middle_y),
            marks: Vec::new(),
        };
        svg.clipped([corner, high], |svg| {
            for mark in &self.marks {
                enlarged.draw_mark(svg, within, mark);
            }
        });
        svg.frame(low, high, &INSET_FRAME);
        // Half of the side at most, so that its words fit beside or below.
        let length = round_down(self.half);
        let unit = Unit::fitting("m", length);
        let words = unit.after(&((length / unit.size * 1e6).round() / 1e6).to_string());
        let (bar, line) = (side * length / (2.0 * self.half), high[1] + 2.0 * LABEL_GAP);
        svg.lines([[[low[0], line], [low[0] + bar, line]]], &Stroke::solid(FRAME.colour, 1.2));
        let size = words.fitting(SMALL_TYPE, side);
        let down = line + MIDDLE * SMALL_TYPE;
        match bar + LABEL_GAP + words.width(size) > side {
            true => svg.text([low[0], down + SMALL_TYPE], Anchor::Start, size, &words),
            false => svg.text([low[0] + bar + LABEL_GAP, down], Anchor::Start, size, &words),
        }
        let times = Text::roman(format!("× {}", magnification(side / piece)));
        svg.text([low[0], low[1] - LABEL_GAP], Anchor::Start, SMALL_TYPE, &times);
    }
}

/// What is seen of paths and circles of a panel, their lines twice as wide, in a square about a
/// point that reaches `half` to each side.
pub(super) fn pieces(marks: &[Mark], centre: Point, half: f64) -> Vec<Mark> {
    let piece = |mark: &Mark| match mark {
        Mark::Path(points, stroke) => {
            let stroke = Stroke { width: 2.0 * stroke.width, ..*stroke };
            Some(Mark::Path(near(points, centre, half), stroke))
        }
        Mark::Circle(radius, stroke) => Some(Mark::Path(arc(*radius, centre, half), *stroke)),
        _ => None,
    };
    marks.iter().filter_map(piece).collect()
}

/// The pieces of a path that lie about a point, a little farther than `half` to each side.
fn near(path: &[Point], centre: Point, half: f64) -> Vec<Point> {
    let mut pieces: Vec<Point> = Vec::new();
    for pair in path.windows(2) {
        let Some([from, to]) = part_within([pair[0], pair[1]], centre, 1.2 * half) else {
            continue;
        };
        if pieces.last() != Some(&from) {
            pieces.extend([BREAK, from]);
        }
        pieces.push(to);
    }
    pieces
}

/// The part of a line that lies in a square about a point.
fn part_within([from, to]: [Point; 2], centre: Point, half: f64) -> Option<[Point; 2]> {
    let (mut begin, mut end) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let (at, step) = (from[axis] - centre[axis], to[axis] - from[axis]);
        for (step, room) in [(-step, at + half), (step, half - at)] {
            match step {
                step if step > 0.0 => end = end.min(room / step),
                step if step < 0.0 => begin = begin.max(room / step),
                _ if room >= 0.0 => {}
                _ => return None,
            }
        }
    }
    let place = |share: f64| match share {
        0.0 => from,
        1.0 => to,
        share => [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis])),
    };
    (begin <= end).then(|| [place(begin), place(end)])
}

/// The part of a circle about the origin that lies in a square about a point on it.
fn arc(radius: f64, centre: Point, half: f64) -> Vec<Point> {
    const PARTS: i32 = 360;
    let middle = centre[1].atan2(centre[0]);
    let span = (2.0 * half / radius).min(std::f64::consts::PI);
    let angles = (-PARTS..=PARTS).map(|part| middle + span * f64::from(part) / f64::from(PARTS));
    angles.map(|angle| [radius * angle.cos(), radius * angle.sin()]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_path_that_is_enlarged_nothing_is_kept_far_from_the_piece() {
        let far = |x: f64, y: f64| [1e3 * x, 1e3 * y];
        let path = [far(-1.0, -1.0), [0.0, 0.0], [0.1, 0.2], far(1.0, 0.0), far(0.0, 5.0)];
        let kept = near(&path, [0.0, 0.0], 1.0);
        assert!(kept[0][0].is_nan() && kept.len() == 5, "{kept:?}");
        assert_eq!(kept[2..4], path[1..3]);
        for [x, y] in &kept[1..] {
            assert!(x.abs() <= 1.2 + 1e-9 && y.abs() <= 1.2 + 1e-9, "{kept:?}");
        }
        assert!(near(&[[f64::NAN; 2], [0.0, 0.0]], [0.0, 0.0], 1.0).is_empty());
    }

    #[test]
    fn bars_have_round_lengths() {
        for (value, round) in [(3.7e-6, 2e-6), (5.0, 5.0), (0.99, 0.5), (122.0, 100.0)] {
            assert!((round_down(value) - round).abs() < 1e-9 * round, "{value}");
        }
    }
}
