//! Text of figures: upright words, italic symbols, subscripts and superscripts.

use super::fonts::{Font, ITALIC, ROMAN};
use std::fmt::Write;

/// Size of subscripts and superscripts, in units of the size of their text.
const SMALL: f64 = 0.72;
/// How far a subscript hangs (em).
const SUBSCRIPT_DROP: f64 = 0.22;
/// How far a superscript stands up (em).
const SUPERSCRIPT_RISE: f64 = 0.36;

/// A line of text.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Text(Vec<Span>);

#[derive(Debug, Clone, PartialEq)]
struct Span {
    text: String,
    italic: bool,
    level: Level,
}

impl Span {
    fn font(&self) -> &'static Font {
        if self.italic { &ITALIC } else { &ROMAN }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Level {
    Base,
    Subscript,
    Superscript,
}

impl Level {
    /// Size, in units of the size of the text.
    fn size(self) -> f64 {
        if self == Level::Base { 1.0 } else { SMALL }
    }

    /// How far below the line it stands (em).
    fn drop(self) -> f64 {
        match self {
            Level::Base => 0.0,
            Level::Subscript => SUBSCRIPT_DROP,
            Level::Superscript => -SUPERSCRIPT_RISE,
        }
    }
}

impl Text {
    /// Upright words.
    pub fn roman(words: impl Into<String>) -> Self {
        Text::default().and(words)
    }

    /// An italic symbol.
    pub fn italic(symbol: impl Into<String>) -> Self {
        Text::default().and_italic(symbol)
    }

    /// Adds upright words.
    pub fn and(self, words: impl Into<String>) -> Self {
        self.with(words, false, Level::Base)
    }

    /// Adds an italic symbol.
    pub fn and_italic(self, symbol: impl Into<String>) -> Self {
        self.with(symbol, true, Level::Base)
    }

    /// Adds an upright subscript.
    pub fn and_subscript(self, words: impl Into<String>) -> Self {
        self.with(words, false, Level::Subscript)
    }

    /// Adds an upright superscript.
    pub fn and_superscript(self, words: impl Into<String>) -> Self {
        self.with(words, false, Level::Superscript)
    }

    /// Adds another text.
    pub fn and_text(mut self, text: &Text) -> Self {
        self.0.extend_from_slice(&text.0);
        self
    }

    fn with(mut self, text: impl Into<String>, italic: bool, level: Level) -> Self {
        self.0.push(Span { text: text.into(), italic, level });
        self
    }

    /// Whether there is nothing to read.
    pub fn is_empty(&self) -> bool {
        self.0.iter().all(|span| span.text.is_empty())
    }

    /// The words without their style.
    pub fn plain(&self) -> String {
        self.0.iter().map(|span| span.text.as_str()).collect()
    }

    /// Width at a size, in the unit of the size.
    pub fn width(&self, size: f64) -> f64 {
        self.0.iter().map(|span| size * span.level.size() * span.font().width(&span.text)).sum()
    }

    /// The outlines of the letters as the data of an SVG path, from a place on the line on.
    pub fn outlines(&self, begin: f64, size: f64) -> String {
        let mut data = String::new();
        let mut x = begin;
        for span in &self.0 {
            let (font, small) = (span.font(), size * span.level.size());
            font.outline(&span.text, [x, size * span.level.drop()], small, &mut data);
            x += small * font.width(&span.text);
        }
        data
    }

    /// The size at which it is no wider than the room, and no larger than `most`.
    pub fn fitting(&self, most: f64, room: f64) -> f64 {
        let width = self.width(most);
        if width > room { most * room / width } else { most }
    }

    /// What stands inside an SVG `text` element of this size.
    pub fn to_svg(&self, size: f64) -> String {
        let mut svg = String::new();
        let mut drop = 0.0;
        for span in self.0.iter().filter(|span| !span.text.is_empty()) {
            let mut attributes = String::new();
            let move_by = size * span.level.drop() - drop;
            if move_by.abs() > 1e-9 {
                let _ = write!(attributes, " dy=\"{move_by:.2}\"");
            }
            drop += move_by;
            if span.level != Level::Base {
                let _ = write!(attributes, " font-size=\"{:.2}\"", size * SMALL);
            }
            if span.italic {
                attributes.push_str(" font-style=\"italic\"");
            }
            let text = escape(&span.text);
            let _ = match attributes.is_empty() {
                true => write!(svg, "{text}"),
                false => write!(svg, "<tspan{attributes}>{text}</tspan>"),
            };
        }
        svg
    }
}

/// Text as XML may hold it, in elements and in attributes. What XML cannot hold at all becomes
/// the replacement character.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\u{0}'..='\u{1f}' | '\u{7f}'..='\u{9f}' | '\u{fffe}' | '\u{ffff}' => {
                escaped.push('\u{fffd}');
            }
            letter => escaped.push(letter),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_shrinks_into_its_room_and_never_grows() {
        let text = Text::roman("Penetration, ").and_italic("δ").and(" (mm)");
        let width = text.width(9.0);
        assert_eq!(text.fitting(9.0, width), 9.0);
        assert_eq!(text.fitting(9.0, 10.0 * width), 9.0);
        assert!((text.width(text.fitting(9.0, 0.6 * width)) - 0.6 * width).abs() < 1e-9 * width);
    }

    #[test]
    fn names_cannot_break_out_of_the_text() {
        let text = Text::roman("a<b>&\"'").and_italic("</text>\u{1}").to_svg(9.0);
        assert_eq!(
            text,
            "a&lt;b&gt;&amp;&quot;&#39;\
             <tspan font-style=\"italic\">&lt;/text&gt;\u{fffd}</tspan>"
        );
    }

    #[test]
    fn outlines_go_from_letter_to_letter_as_wide_as_the_text() {
        let text = Text::italic("F").and_subscript("N").and(" lI");
        let data = text.outlines(3.0, 2048.0);
        assert_eq!(data.matches('Z').count(), 4, "{data}");
        // the first stroke of each letter; the last one stands before the end of the text
        let begins: Vec<f64> = data
            .split('M')
            .skip(1)
            .map(|rest| rest.split(' ').next().unwrap().parse().unwrap())
            .collect();
        assert!(begins.is_sorted(), "{begins:?}");
        let end = 3.0 + text.width(2048.0);
        assert!(begins[0] > 3.0 && end - 569.0 < begins[3] && begins[3] < end, "{begins:?}");
        assert_eq!(Text::roman(" ").outlines(0.0, 9.0), "");
    }

    #[test]
    fn the_line_is_found_again_after_a_subscript() {
        let text = Text::italic("F").and_subscript("N").and(" (kN)").to_svg(10.0);
        assert_eq!(
            text,
            "<tspan font-style=\"italic\">F</tspan>\
             <tspan dy=\"2.20\" font-size=\"7.20\">N</tspan>\
             <tspan dy=\"-2.20\"> (kN)</tspan>"
        );
    }

    #[test]
    fn a_width_is_the_sum_of_the_widths_of_its_letters() {
        // Advances of Liberation Sans in 1/2048 em: F 1251, t 569, N 1479.
        let width = Text::italic("F").and_subscript("N").and("t").width(2048.0);
        assert!((width - (1251.0 + SMALL * 1479.0 + 569.0)).abs() < 1e-9, "{width}");
    }
}
