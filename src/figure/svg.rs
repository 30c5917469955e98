//! Writing SVG: lines, paths, circles and text, lengths in points (1/72 in).

use super::decimate::Point;
use super::fonts::FAMILIES;
use super::text::{Text, escape};
use std::fmt::Write;

/// Points in a millimetre.
pub(super) const POINTS_PER_MM: f64 = 72.0 / 25.4;

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stroke {
    /// Colour, as SVG has it.
    pub colour: &'static str,
    /// Width (pt).
    pub width: f64,
    /// Lengths of dash and gap (pt); none for a solid line.
    pub dashes: Option<[f64; 2]>,
}

impl Stroke {
    /// A solid line.
    pub const fn solid(colour: &'static str, width: f64) -> Self {
        Stroke { colour, width, dashes: None }
    }

    /// A dashed line.
    pub const fn dashed(colour: &'static str, width: f64) -> Self {
        Stroke { colour, width, dashes: Some([4.0, 2.2]) }
    }

    fn attributes(&self) -> String {
        let Stroke { colour, width, .. } = self;
        let mut attributes =
            format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"{}\"", number(*width));
        if let Some([dash, gap]) = self.dashes {
            let _ = write!(attributes, " stroke-dasharray=\"{},{}\"", number(dash), number(gap));
        }
        attributes
    }
}

/// Where a text stands about its point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Anchor {
    /// It begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// An SVG file being written.
#[derive(Debug)]
pub(super) struct Svg {
    text: String,
    /// Whether letters are drawn by their outlines, so that they look alike where the fonts are
    /// not there.
    outlines: bool,
}

impl Svg {
    /// Begins a picture of this size (mm), with a white ground. The title and the description are
    /// for readers who cannot see it.
    pub fn new([width, height]: [f64; 2], title: &str, description: &str) -> Self {
        let [across, down] = [width, height].map(|length| number(length * POINTS_PER_MM));
        let (width, height) = (number(width), number(height));
        let (title, description) = (escape(title), escape(description));
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" \
             viewBox=\"0 0 {across} {down}\" font-family=\"{FAMILIES}\" \
             stroke-linejoin=\"round\" role=\"img\">\n<title>{title}</title>\n\
             <desc>{description}</desc>\n<rect width=\"{across}\" height=\"{down}\" \
             fill=\"#fff\"/>\n"
        );
        Svg { text, outlines: false }
    }

    /// Draws letters by their outlines, or sets them as text.
    pub fn outlined(self, outlines: bool) -> Self {
        Svg { outlines, ..self }
    }

    /// The finished file.
    pub fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }

    /// A line through points; points that are not finite break it, and a lone point is a dot as
    /// wide as the line.
    pub fn path(&mut self, points: &[Point], stroke: &Stroke) {
        let mut data = String::new();
        for piece in points.split(|point| !point.iter().all(|value| value.is_finite())) {
            write_piece(&mut data, piece);
        }
        if !data.is_empty() {
            let attributes = stroke.attributes();
            let _ =
                writeln!(self.text, "<path {attributes} stroke-linecap=\"round\" d=\"{data}\"/>");
        }
    }

    /// Many separate straight lines of one stroke.
    pub fn lines(&mut self, lines: impl IntoIterator<Item = [Point; 2]>, stroke: &Stroke) {
        let mut data = String::new();
        for line in lines {
            write_piece(&mut data, &line);
        }
        if !data.is_empty() {
            let _ = writeln!(self.text, "<path {} d=\"{data}\"/>", stroke.attributes());
        }
    }

    /// Filled rectangles of one colour, each from its left upper to its right lower corner.
    pub fn rectangles(
        &mut self,
        corners: impl IntoIterator<Item = [Point; 2]>,
        colour: &'static str,
    ) {
        let mut data = String::new();
        for [[left, top], [right, bottom]] in corners {
            let [left, top, right, bottom] = [left, top, right, bottom].map(number);
            let _ = write!(data, "M{left},{top}H{right}V{bottom}H{left}Z");
        }
        if !data.is_empty() {
            let _ = writeln!(self.text, "<path fill=\"{colour}\" d=\"{data}\"/>");
        }
    }

    /// A filled area within a closed line.
    pub fn area(&mut self, corners: &[Point], colour: &'static str) {
        let mut data = String::new();
        write_piece(&mut data, corners);
        if !data.is_empty() {
            let _ = writeln!(self.text, "<path fill=\"{colour}\" d=\"{data}Z\"/>");
        }
    }

    /// The outline of a rectangle.
    pub fn frame(&mut self, [left, top]: Point, [right, bottom]: Point, stroke: &Stroke) {
        let [left, top, right, bottom] = [left, top, right, bottom].map(number);
        let attributes = stroke.attributes();
        let _ = writeln!(
            self.text,
            "<path {attributes} stroke-linejoin=\"miter\" d=\"M{left},{top}H{right}V{bottom}H{left}Z\"/>"
        );
    }

    /// What is drawn within is seen between two corners only.
    pub fn clipped(&mut self, [from, to]: [Point; 2], draw: impl FnOnce(&mut Self)) {
        let [x, y, width, height] =
            [from[0], from[1], to[0] - from[0], to[1] - from[1]].map(number);
        let _ = writeln!(
            self.text,
            "<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"{x} {y} {width} {height}\" overflow=\"hidden\">"
        );
        draw(self);
        self.text.push_str("</svg>\n");
    }

    /// The outline of a circle.
    pub fn circle(&mut self, [x, y]: Point, radius: f64, stroke: &Stroke) {
        let [x, y, radius] = [x, y, radius].map(number);
        let attributes = stroke.attributes();
        let _ = writeln!(self.text, "<circle {attributes} cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"/>");
    }

    /// Filled discs of one radius and colour.
    pub fn discs(
        &mut self,
        centres: impl IntoIterator<Item = Point>,
        radius: f64,
        colour: &'static str,
    ) {
        let mut data = String::new();
        for [x, y] in centres {
            let _ = write!(data, "M{},{}h0", number(x), number(y));
        }
        if !data.is_empty() {
            let width = number(2.0 * radius);
            let _ = writeln!(
                self.text,
                "<path fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" \
                 stroke-linecap=\"round\" d=\"{data}\"/>"
            );
        }
    }

    /// A text whose line runs through a point.
    pub fn text(&mut self, [x, y]: Point, anchor: Anchor, size: f64, text: &Text) {
        let [x, y] = [number(x), number(y)];
        let place = match self.outlines {
            true => format!("transform=\"translate({x} {y})\""),
            false => format!("x=\"{x}\" y=\"{y}\""),
        };
        self.place_text(&place, anchor, size, text);
    }

    /// A text that reads upwards.
    pub fn text_upwards(&mut self, [x, y]: Point, anchor: Anchor, size: f64, text: &Text) {
        let place = format!("transform=\"translate({} {}) rotate(-90)\"", number(x), number(y));
        self.place_text(&place, anchor, size, text);
    }

    fn place_text(&mut self, place: &str, anchor: Anchor, size: f64, text: &Text) {
        if text.is_empty() {
            return;
        }
        if self.outlines {
            return self.place_outlines(place, anchor, size, text);
        }
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let (size_written, words) = (number(size), text.to_svg(size));
        let _ = writeln!(
            self.text,
            "<text {place} font-size=\"{size_written}\"{anchor} xml:space=\"preserve\">{words}</text>"
        );
    }
    fn place_outlines(&mut self, place: &str, anchor: Anchor, size: f64, text: &Text) {
        let begin = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * text.width(size),
            Anchor::End => -text.width(size),
        };
        let (words, data) = (escape(&text.plain()), text.outlines(begin, size));
        let _ = writeln!(self.text, "<path {place} aria-label=\"{words}\" d=\"{data}\"/>");
    }
}

/// A length to a hundredth of a point, as short as can be.
pub(super) fn number(value: f64) -> String {
    hundredths((value * 100.0).round() as i64)
}

fn hundredths(value: i64) -> String {
    let sign = if value < 0 { "-" } else { "" };
    let (whole, part) = (value.unsigned_abs() / 100, value.unsigned_abs() % 100);
    match (whole, part) {
        (whole, 0) => format!("{sign}{whole}"),
        (0, part) if part % 10 == 0 => format!("{sign}.{}", part / 10),
        (0, part) => format!("{sign}.{part:02}"),
        (whole, part) if part % 10 == 0 => format!("{sign}{whole}.{}", part / 10),
        (whole, part) => format!("{sign}{whole}.{part:02}"),
    }
}

/// Writes one unbroken line: its start, then steps, rounded so that errors do not add up.
fn write_piece(data: &mut String, points: &[Point]) {
    let mut at = [0_i64; 2];
    for (index, point) in points.iter().enumerate() {
        let to = point.map(|value| (value * 100.0).round() as i64);
        let step = [to[0] - at[0], to[1] - at[1]];
        if index == 0 {
            let _ = write!(data, "M{},{}", hundredths(to[0]), hundredths(to[1]));
        } else if step != [0, 0] || points.len() == 2 {
            let comma = if step[1] < 0 { "" } else { "," };
            let _ = write!(data, "l{}{comma}{}", hundredths(step[0]), hundredths(step[1]));
        }
        at = to;
    }
    if points.len() == 1 {
        data.push_str("h0");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_short_as_a_hundredth_of_a_point_allows() {
        for (value, text) in [
            (0.0, "0"),
            (-0.001, "0"),
            (0.5, ".5"),
            (-0.25, "-.25"),
            (0.07, ".07"),
            (12.3, "12.3"),
            (-12.345, "-12.35"),
            (100.0, "100"),
            (-1.05, "-1.05"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn a_line_is_written_in_steps_whose_rounding_does_not_add_up() {
        let points: Vec<Point> = (0..1000).map(|k| [f64::from(k) * 0.1234, 1.0]).collect();
        let mut data = String::new();
        write_piece(&mut data, &points);
        let end: f64 = data
            .split(['M', 'l'])
            .filter(|step| !step.is_empty())
            .map(|step| step.split_once(',').unwrap().0.parse::<f64>().unwrap())
            .sum();
        assert!((end - 999.0 * 0.1234).abs() <= 0.005 + 1e-9, "{end}");
    }

    #[test]
    fn what_is_not_finite_breaks_a_line_and_is_never_written() {
        let mut svg = Svg::new([90.0, 50.0], "a & b", "c < d");
        let gap = [f64::NAN, 1.0];
        svg.path(&[gap, [1.0, 2.0], [3.0, 1.0], gap, gap, [5.0, 6.0]], &Stroke::solid("#000", 0.5));
        svg.path(&[gap], &Stroke::solid("#000", 0.5));
        let text = svg.finish();
        assert!(text.contains("d=\"M1,2l2-1M5,6h0\""), "{text}");
        assert!(!text.contains("NaN") && text.matches("<path").count() == 1);
        assert!(text.contains("<title>a &amp; b</title>") && text.contains("c &lt; d"));
    }
}
