//! One panel of a figure: a frame, two axes, and what is drawn between them.

use super::cloud::merged;
use super::decimate::{Point, by_columns, by_distance};
use super::ink::without_covered;
use super::inset::Inset;
use super::palette::{BEYOND, FRAME};
use super::quantity::Unit;
use super::svg::{Anchor, Stroke, Svg};
use super::text::Text;
use super::ticks::Ticks;

/// Size of the labels of ticks, and of legends (pt).
pub(super) const SMALL_TYPE: f64 = 8.0;
/// Size of titles (pt).
pub(super) const TYPE: f64 = 9.0;
/// Length of a major tick (pt).
const MAJOR: f64 = 3.6;
/// Length of a minor tick (pt).
const MINOR: f64 = 2.0;
/// How far words may reach beyond the end of a frame's side; longer ones are set smaller (pt).
const OVERHANG: f64 = 5.0;
/// Distance of labels from the frame (pt).
pub(super) const LABEL_GAP: f64 = 3.0;
/// Columns of the picture in a point of width.
const COLUMNS_PER_POINT: f64 = 2.0;
/// How far a drawn path may be from the true one (pt).
const TOLERANCE: f64 = 0.02;
/// How far the baseline lies below the middle of a digit (em).
pub(super) const MIDDLE: f64 = 0.35;

/// An axis.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    /// What it shows, without the unit.
    pub title: Text,
    /// The unit of its labels.
    pub unit: Unit,
    /// Its ends, in SI units.
    pub range: [f64; 2],
    /// How its ticks are chosen.
    pub ticks: Choice,
}

/// How the ticks of an axis are chosen.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Choice {
    /// Round numbers.
    Decimal,
    /// Angles that people count in.
    Degrees,
    /// Whole numbers only have labels: names at 0, 1, 2 …, from the top down.
    Names(Vec<String>),
    /// Powers of ten of both signs: logarithmic beyond this value (in SI units), linear between it
    /// and its negative, as high as a decade each.
    Bent(f64),
}

impl Axis {
    /// The title with its unit.
    pub fn full_title(&self) -> Text {
        self.unit.behind(self.title.clone())
    }

    /// An axis of round numbers with room for all values, in the unit that suits them. `unit` is
    /// written as in result files.
    pub fn fitting(title: Text, unit: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let range = with_room(range_of(values));
        let unit = Unit::fitting(unit, range[0].abs().max(range[1].abs()));
        Axis { title, unit, range, ticks: Choice::Decimal }
    }

    /// An axis that is logarithmic beyond a value, with room for all values.
    pub fn bent(
        title: Text,
        unit: &str,
        values: impl IntoIterator<Item = f64>,
        beyond: f64,
    ) -> Self {
        let ends = range_of(values).map(|ends| ends.map(|end| bent(end / beyond)));
        let range = with_room(ends).map(|end| beyond * straight(end));
        let unit = Unit::fitting(unit, range[0].abs().max(range[1].abs()));
        Axis { title, unit, range, ticks: Choice::Bent(beyond) }
    }

    /// Where a value is on the axis, from 0 at its low end to 1 at its high one.
    fn share(&self, value: f64) -> f64 {
        let place = |value: f64| match &self.ticks {
            Choice::Bent(beyond) => bent(value / beyond),
            _ => value,
        };
        let [low, high] = self.range.map(place);
        (place(value) - low) / (high - low)
    }

    /// Ticks that suit a length on the page (pt), `spacing` apart at least.
    pub fn ticks(&self, length: f64, spacing: f64) -> Ticks {
        let range = self.range.map(|end| end / self.unit.size);
        let most = (length / spacing) as usize + 1;
        match &self.ticks {
            Choice::Decimal => Ticks::decimal(range, most),
            Choice::Degrees => Ticks::degrees(range, most),
            Choice::Names(_) => Ticks::default(),
            Choice::Bent(beyond) => {
                let decade = (self.share(10.0 * beyond) - self.share(*beyond)) * length;
                Ticks::bent(range, beyond / self.unit.size, DECADE_SPACING / decade)
            }
        }
    }
}

/// Place of a value on an axis that is linear as far as ±1, and logarithmic beyond.
fn bent(value: f64) -> f64 {
    if value.abs() > 1.0 { value.signum() * (1.0 + value.abs().log10()) } else { value }
}

/// The value at a place on such an axis.
fn straight(place: f64) -> f64 {
    if place.abs() > 1.0 { place.signum() * 10_f64.powf(place.abs() - 1.0) } else { place }
}

/// Something drawn in a panel, in SI units of its axes.
#[derive(Debug, Clone)]
pub(super) enum Mark {
    /// A curve over the horizontal axis.
    Curve(Vec<Point>, Stroke),
    /// A path that may go anywhere.
    Path(Vec<Point>, Stroke),
    /// Separate points.
    Dots(Vec<Point>, Dot),
    /// Many points, of which those that cover each other are drawn once.
    Cloud(Vec<Point>, Dot),
    /// The ground between two curves: x, the lower and the upper y.
    Band(Vec<[f64; 3]>, &'static str),
    /// Filled rectangles, each from its left upper to its right lower corner.
    Field(Vec<[Point; 2]>, &'static str),
    /// A circle about the origin.
    Circle(f64, Stroke),
    /// Bars from one place on the horizontal axis to another, in a row of names.
    Bars(Vec<[f64; 2]>, usize, &'static str),
    /// A line at a height.
    Level(f64, Stroke),
    /// A line at a place on the horizontal axis.
    Upright(f64, Stroke),
    /// The ground between two places on the horizontal axis: a run's numbers there mean nothing.
    Beyond([f64; 2]),
    /// A square piece of the panel enlarged.
    Inset(Inset),
}

impl Mark {
    /// Values on the vertical axis of a curve or a level.
    pub fn heights(&self) -> Vec<f64> {
        match self {
            Mark::Curve(points, _) => points.iter().map(|point| point[1]).collect(),
            Mark::Level(height, _) => vec![*height],
            _ => Vec::new(),
        }
    }
}

/// How a point is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dot {
    /// Radius (pt).
    pub radius: f64,
    /// Colour.
    pub colour: &'static str,
}

/// What an entry of a legend shows beside its words.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sample {
    /// A line.
    Line(Stroke),
    /// A bar.
    Bar(&'static str),
    /// A point.
    Dot(Dot),
}

/// A panel.
#[derive(Debug, Clone)]
pub(super) struct Panel {
    /// What it shows, over its upper left corner.
    pub label: Text,
    /// Entries of the legend, over its upper right corner.
    pub legend: Vec<(Sample, Text)>,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// What is drawn.
    pub marks: Vec<Mark>,
}

/// Where a panel's frame is on the page (pt).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    /// Left upper corner.
    pub corner: Point,
    /// Width and height.
    pub size: [f64; 2],
}

/// Which words stand beside a panel's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Words {
    /// Labels of the horizontal ticks.
    pub x_labels: bool,
    /// Title of the horizontal axis.
    pub x_title: bool,
    /// Title of the vertical axis.
    pub y_title: bool,
}

/// Distances of major ticks that leave room for labels: across and down (pt).
const SPACING: [f64; 2] = [38.0, 19.0];
/// Distance of labelled powers of ten (pt).
const DECADE_SPACING: f64 = 12.0;
/// That of major ticks where both axes are alike (pt).
const EQUAL_SPACING: f64 = 30.0;

impl Panel {
    fn spacing(&self) -> [f64; 2] {
        let alike = self.x.range == self.y.range && self.x.unit == self.y.unit;
        if alike { [EQUAL_SPACING; 2] } else { SPACING }
    }

    /// Width of the vertical axis' labels for a frame of this height (pt).
    pub fn y_label_width(&self, height: f64) -> f64 {
        match &self.y.ticks {
            Choice::Names(names) => widest(names),
            _ => widest(&self.y.ticks(height, self.spacing()[1]).labels),
        }
    }

    /// Width of the horizontal axis' labels for a frame of this width (pt).
    pub fn x_label_width(&self, width: f64) -> f64 {
        widest(&self.x.ticks(width, self.spacing()[0]).labels)
    }

    /// Lines over the frame that label and legend need, on a page with so much room for them (pt):
    /// one if they fit beside each other, else the legend's own and one for the label.
    pub fn header_lines(&self, room: f64) -> usize {
        let legend = self.legend_lines(room);
        let beside =
            self.label.width(SMALL_TYPE) + self.legend.iter().map(entry_width).sum::<f64>();
        match (legend.len(), self.label.is_empty()) {
            (0, true) => 0,
            (lines, false) if beside > room => lines + 1,
            (lines, _) => lines.max(1),
        }
    }

    /// Entries of the legend in lines that fit the room (pt).
    fn legend_lines(&self, room: f64) -> Vec<&[(Sample, Text)]> {
        let mut lines = Vec::new();
        let mut rest = self.legend.as_slice();
        while !rest.is_empty() {
            let mut width = 0.0;
            let fits = |entry: &&(Sample, Text)| {
                width += entry_width(entry);
                width <= room
            };
            let (line, others) = rest.split_at(rest.iter().take_while(fits).count().max(1));
            lines.push(line);
            rest = others;
        }
        lines
    }

    /// Draws the panel. `title_at` is how far left of the frame the vertical axis' title stands.
    pub fn draw(&self, svg: &mut Svg, frame: Frame, words: Words, title_at: f64) {
        for mark in &self.marks {
            self.draw_mark(svg, frame, mark);
        }
        let [left, top] = frame.corner;
        let [right, bottom] = [left + frame.size[0], top + frame.size[1]];
        svg.frame([left, top], [right, bottom], &FRAME);
        self.draw_x(svg, frame, words);
        self.draw_y(svg, frame);
        let (middle, down) = (0.5 * (left + right), 0.5 * (top + bottom));
        if words.x_title {
            let line = bottom + LABEL_GAP + SMALL_TYPE + 0.35 * TYPE + 0.75 * TYPE;
            let title = self.x.full_title();
            let size = title.fitting(TYPE, frame.size[0] + 2.0 * OVERHANG);
            svg.text([middle, line], Anchor::Middle, size, &title);
        }
        if words.y_title {
            let title = self.y.full_title();
            let size = title.fitting(TYPE, frame.size[1] + 2.0 * OVERHANG);
            svg.text_upwards([left - title_at, down], Anchor::Middle, size, &title);
        }
    }

    fn draw_x(&self, svg: &mut Svg, frame: Frame, words: Words) {
        let ticks = self.x.ticks(frame.size[0], self.spacing()[0]);
        let [top, bottom] = [frame.corner[1], frame.corner[1] + frame.size[1]];
        let place = |tick: &f64| self.across(frame, tick * self.x.unit.size);
        let both = |places: &[f64], length: f64| -> Vec<[Point; 2]> {
            let lines = places
                .iter()
                .map(place)
                .flat_map(|x| [[[x, bottom], [x, bottom - length]], [[x, top], [x, top + length]]]);
            lines.collect()
        };
        svg.lines(both(&ticks.major, MAJOR).into_iter().chain(both(&ticks.minor, MINOR)), &FRAME);
        if words.x_labels {
            let line = bottom + LABEL_GAP + 0.75 * SMALL_TYPE;
            for (tick, label) in ticks.major.iter().zip(&ticks.labels) {
                svg.text([place(tick), line], Anchor::Middle, SMALL_TYPE, &Text::roman(label));
            }
        }
    }

    fn draw_y(&self, svg: &mut Svg, frame: Frame) {
        let [left, right] = [frame.corner[0], frame.corner[0] + frame.size[0]];
        let mut label = |y: f64, label: &String| {
            let at = [left - LABEL_GAP, y + MIDDLE * SMALL_TYPE];
            svg.text(at, Anchor::End, SMALL_TYPE, &Text::roman(label));
        };
        if let Choice::Names(names) = &self.y.ticks {
            for (row, name) in names.iter().enumerate() {
                label(self.down(frame, row as f64), name);
            }
            return;
        }
        let ticks = self.y.ticks(frame.size[1], self.spacing()[1]);
        let place = |tick: &f64| self.down(frame, tick * self.y.unit.size);
        for (tick, words) in ticks.major.iter().zip(&ticks.labels) {
            label(place(tick), words);
        }
        let both = |places: &[f64], length: f64| -> Vec<[Point; 2]> {
            let lines = places
                .iter()
                .map(place)
                .flat_map(|y| [[[left, y], [left + length, y]], [[right, y], [right - length, y]]]);
            lines.collect()
        };
        svg.lines(both(&ticks.major, MAJOR).into_iter().chain(both(&ticks.minor, MINOR)), &FRAME);
    }

    /// Draws a mark in the panel's frame.
    pub fn draw_mark(&self, svg: &mut Svg, frame: Frame, mark: &Mark) {
        let [left, top] = frame.corner;
        let [right, bottom] = [left + frame.size[0], top + frame.size[1]];
        let place = |[x, y]: &Point| [self.across(frame, *x), self.down(frame, *y)];
        let placed = |points: &[Point]| -> Vec<Point> { points.iter().map(place).collect() };
        match mark {
            Mark::Curve(points, stroke) => {
                let columns = by_columns(&placed(points), 1.0 / COLUMNS_PER_POINT);
                svg.path(&by_distance(&columns, TOLERANCE), stroke);
            }
            Mark::Path(points, stroke) => {
                let path = by_distance(&placed(points), TOLERANCE);
                svg.path(&without_covered(path, stroke.width), stroke);
            }
            Mark::Dots(points, dot) => {
                let finite = placed(points).into_iter().filter(|[x, y]| (x + y).is_finite());
                svg.discs(finite, dot.radius, dot.colour);
            }
            Mark::Cloud(points, dot) => {
                svg.path(&merged(&placed(points)), &Stroke::solid(dot.colour, 2.0 * dot.radius));
            }
            Mark::Band(band, colour) => {
                let upper = band.iter().map(|[x, _, high]| place(&[*x, *high]));
                let lower = band.iter().rev().map(|[x, low, _]| place(&[*x, *low]));
                svg.area(&upper.chain(lower).collect::<Vec<_>>(), colour);
            }
            Mark::Field(fields, colour) => {
                // a hair over each other, so that no ground is seen between them
                let wide = |[from, to]: &[Point; 2]| {
                    let [[left, top], [right, bottom]] = [place(from), place(to)];
                    [[left, top], [right + 0.2, bottom + 0.2]]
                };
                svg.rectangles(fields.iter().map(wide), colour);
            }
            Mark::Circle(radius, stroke) => {
                let edge = self.across(frame, *radius) - self.across(frame, 0.0);
                svg.circle(place(&[0.0, 0.0]), edge, stroke);
            }
            Mark::Bars(bars, row, colour) => self.draw_bars(svg, frame, bars, *row, colour),
            Mark::Level(height, stroke) => {
                let y = self.down(frame, *height);
                svg.lines([[[left, y], [right, y]]], stroke);
            }
            Mark::Upright(place, stroke) => {
                let x = self.across(frame, *place);
                svg.lines([[[x, top], [x, bottom]]], stroke);
            }
            Mark::Beyond(places) => {
                let [from, to] = places.map(|place| self.across(frame, place).clamp(left, right));
                svg.rectangles([[[from.min(to), top], [from.max(to), bottom]]], BEYOND);
            }
            Mark::Inset(inset) => inset.draw(svg, frame, self),
        }
    }

    /// Bars that touch on the page become one; none is narrower than a hair, so that none is lost.
    fn draw_bars(
        &self,
        svg: &mut Svg,
        frame: Frame,
        bars: &[[f64; 2]],
        row: usize,
        colour: &'static str,
    ) {
        const HAIR: f64 = 0.2;
        const HALF: f64 = 0.32;
        let [top, bottom] = [row as f64 - HALF, row as f64 + HALF].map(|y| self.down(frame, y));
        let mut drawn: Vec<[f64; 2]> = Vec::new();
        for bar in bars {
            let [from, to] = bar.map(|x| self.across(frame, x));
            let to = to.max(from + HAIR);
            match drawn.last_mut() {
                Some(last) if from <= last[1] + 0.02 => last[1] = last[1].max(to),
                _ => drawn.push([from, to]),
            }
        }
        svg.rectangles(drawn.into_iter().map(|[from, to]| [[from, top], [to, bottom]]), colour);
    }

    /// Where a value of the horizontal axis is on the page (pt).
    pub fn across(&self, frame: Frame, x: f64) -> f64 {
        frame.corner[0] + frame.size[0] * self.x.share(x)
    }

    /// Where a value of the vertical axis is on the page (pt).
    pub fn down(&self, frame: Frame, y: f64) -> f64 {
        frame.corner[1] + frame.size[1] * (1.0 - self.y.share(y))
    }

    /// Draws the legend in its lines, `line_height` (pt) apart, the first of which ends at a point.
    pub fn draw_legend(&self, svg: &mut Svg, [end, top]: Point, room: f64, line_height: f64) {
        for (number, entries) in self.legend_lines(room).into_iter().enumerate() {
            let line = top + line_height * number as f64;
            let mut x = end - entries.iter().map(entry_width).sum::<f64>();
            for entry in entries {
                draw_entry(svg, [x + LEGEND_GAP, line], entry);
                x += entry_width(entry);
            }
        }
    }

    /// Draws the label so that it begins at a point, over a frame of this width (pt).
    pub fn draw_label(&self, svg: &mut Svg, at: Point, width: f64) {
        let size = self.label.fitting(SMALL_TYPE, width + OVERHANG);
        svg.text(at, Anchor::Start, size, &self.label);
    }
}

/// Width of the widest label (pt).
fn widest(labels: &[String]) -> f64 {
    labels.iter().map(|label| Text::roman(label).width(SMALL_TYPE)).fold(0.0, f64::max)
}

/// Length of a line beside the words of a legend (pt).
const SAMPLE: f64 = 15.0;
/// Distance of the words from it (pt).
const SAMPLE_GAP: f64 = 3.0;
/// Distance between entries (pt).
const LEGEND_GAP: f64 = 9.0;

fn entry_width((_, words): &(Sample, Text)) -> f64 {
    LEGEND_GAP + SAMPLE + SAMPLE_GAP + words.width(SMALL_TYPE)
}

fn draw_entry(svg: &mut Svg, [from, line]: Point, (sample, words): &(Sample, Text)) {
    let (y, to) = (line - MIDDLE * SMALL_TYPE, from + SAMPLE);
    match sample {
        Sample::Line(stroke) => svg.lines([[[from, y], [to, y]]], stroke),
        Sample::Dot(dot) => svg.discs([[to - dot.radius, y]], dot.radius, dot.colour),
        Sample::Bar(colour) => svg.rectangles([[[from, y - 2.5], [to, y + 2.5]]], colour),
    }
    svg.text([to + SAMPLE_GAP, line], Anchor::Start, SMALL_TYPE, words);
}

/// The line at zero, where an axis has both signs.
pub(super) fn zero_line([low, high]: [f64; 2]) -> Option<Mark> {
    (low < 0.0 && high > 0.0).then_some(Mark::Level(0.0, Stroke::solid("#bbb", 0.4)))
}

/// The range of values, those that are not finite left out; `None` if nothing is left.
pub(super) fn range_of(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    values.into_iter().filter(|value| value.is_finite()).fold(None, |range, value| {
        let [low, high] = range.unwrap_or([value, value]);
        Some([low.min(value), high.max(value)])
    })
}

/// Least width of an axis that shows more than the last digits of its values, in units of these.
const LEAST_SPAN: f64 = 0.01;

/// Share of a range within which an end counts as zero: nobody could see the difference.
const AT_ZERO: f64 = 1e-6;

/// A range with room about it, a twentieth of it each side; an end at zero stays there, and a range
/// so narrow that only digits far behind the point would tell its ends apart is widened.
pub(super) fn with_room(range: Option<[f64; 2]>) -> [f64; 2] {
    let [low, high] = range.unwrap_or_default();
    let largest = low.abs().max(high.abs());
    if largest == 0.0 {
        return [0.0, 1.0];
    }
    if high - low < LEAST_SPAN * largest {
        let middle = 0.5 * (low + high);
        return [middle - 0.5 * LEAST_SPAN * largest, middle + 0.5 * LEAST_SPAN * largest];
    }
    let (room, nothing) = (0.05 * (high - low), AT_ZERO * (high - low));
    [
        if low.abs() <= nothing { 0.0 } else { low - room },
        if high.abs() <= nothing { 0.0 } else { high + room },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::palette::RUN;

    fn panel(label: &str, legend: &[&str]) -> Panel {
        let axis = Axis::fitting(Text::roman("Time"), "s", [0.0, 1.0]);
        Panel {
            label: Text::roman(label),
            legend: legend.iter().map(|words| (Sample::Line(RUN), Text::roman(*words))).collect(),
            x: axis.clone(),
            y: axis,
            marks: Vec::new(),
        }
    }

    #[test]
    fn an_axis_has_room_but_not_below_zero() {
        assert_eq!(with_room(Some([0.0, 2.0])), [0.0, 2.1]);
        assert_eq!(with_room(Some([-2.0, 0.0])), [-2.1, 0.0]);
        assert_eq!(with_room(Some([-1.0, 1.0])), [-1.1, 1.1]);
        assert_eq!(with_room(Some([-1e-9, 2.0]))[0], 0.0);
        assert_eq!(with_room(Some([0.0, 0.0])), [0.0, 1.0]);
        assert_eq!(with_room(None), [0.0, 1.0]);
        let [low, high] = with_room(Some([13.7, 13.7 + 1e-9]));
        assert!(low < 13.7 && high > 13.7 && high - low > 0.1, "{low} {high}");
    }

    #[test]
    fn a_bent_axis_is_linear_about_zero_and_logarithmic_beyond() {
        let axis = Axis::bent(Text::roman("Torque"), "N m", [-50.0, 900.0], 10.0);
        let share = |value: f64| axis.share(value);
        let decade = share(100.0) - share(10.0);
        for (value, decades) in [(0.0, -1.0), (5.0, -0.5), (-10.0, -2.0), (1000.0, 2.0)] {
            let found = (share(value) - share(10.0)) / decade;
            assert!((found - decades).abs() < 1e-12, "{value}: {found}");
        }
        for end in [-50.0, 900.0] {
            assert!(share(end) > 0.01 && share(end) < 0.99, "{end} has room");
        }
        let ticks = axis.ticks(100.0, 19.0);
        assert_eq!(ticks.labels, ["−0.01", "0", "0.01", "0.1", "1"], "in kN m");
    }

    #[test]
    fn what_is_not_finite_has_no_part_in_a_range() {
        assert_eq!(range_of([f64::NAN, 3.0, f64::INFINITY, -1.0]), Some([-1.0, 3.0]));
        assert_eq!(range_of([f64::NAN]), None);
    }

    #[test]
    fn a_legend_has_as_many_lines_as_it_needs() {
        let words = ["kinetic", "potential", "elastic", "dissipated", "drive work", "load work"];
        let panel = panel("a run", &words);
        for (room, lines) in [(1000.0, 1), (360.0, 2), (215.0, 3), (10.0, 7)] {
            assert_eq!(panel.header_lines(room), lines, "{room}");
        }
        for line in panel.legend_lines(215.0) {
            assert!(line.iter().map(entry_width).sum::<f64>() <= 215.0);
        }
        assert_eq!(self::panel("", &[]).header_lines(100.0), 0);
        assert_eq!(self::panel("", &["kinetic"]).header_lines(100.0), 1);
        assert_eq!(self::panel("a run", &[]).header_lines(1.0), 1);
    }

    #[test]
    fn bars_that_touch_become_one_and_none_is_lost() {
        let mut panel = panel("", &[]);
        (panel.x.range, panel.y.range) = ([0.0, 100.0], [0.5, -0.5]);
        // A frame of 100 pt: a second is a point.
        let frame = Frame { corner: [0.0, 0.0], size: [100.0, 10.0] };
        let bars = vec![[10.0, 10.0], [20.0, 25.0], [25.0, 30.0], [40.0, 40.001]];
        panel.marks = vec![Mark::Bars(bars, 0, "#000")];
        let mut svg = Svg::new([40.0, 5.0], "", "");
        panel.draw_mark(&mut svg, frame, &panel.marks[0]);
        let text = svg.finish();
        for part in ["M10,1.8H10.2V", "M20,1.8H30V", "M40,1.8H40.2V"] {
            assert!(text.contains(part), "{text}");
        }
        assert_eq!(text.matches('Z').count(), 3);
    }
}
