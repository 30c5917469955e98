//! A page of panels: columns, rows, margins, words.

use super::panel::{Frame, LABEL_GAP, Panel, SMALL_TYPE, TYPE, Words};
use super::svg::{Anchor, POINTS_PER_MM, Svg};
use super::text::Text;

/// Width of one column of a journal (mm).
pub const SINGLE_COLUMN: f64 = 90.0;
/// Width of two columns of a journal (mm).
pub const DOUBLE_COLUMN: f64 = 190.0;

/// Margin of the page on every side (pt).
const MARGIN: f64 = 2.0;
/// Least room right of a frame (pt).
const RIGHT: f64 = 6.0;
/// Line of words over a frame (pt).
const HEADER: f64 = 12.0;
/// Distance of a header's words from the frame (pt).
const HEADER_GAP: f64 = 3.5;
/// Room for the labels of horizontal ticks (pt).
const X_LABELS: f64 = LABEL_GAP + SMALL_TYPE;
/// Room for the title of a horizontal axis (pt).
const X_TITLE: f64 = 1.4 * TYPE;
/// How far the baseline of an upward title lies from the margin (pt).
const TITLE_DROP: f64 = 0.85 * TYPE;
/// Room for an upward title (pt).
const Y_TITLE: f64 = 1.35 * TYPE;
/// Room between rows whose upper one has no labels (pt).
const ROW_GAP: f64 = 6.0;

/// Panels in rows and columns, as wide as a page.
#[derive(Debug, Clone)]
pub(super) struct Sheet {
    /// Width of the page (mm).
    pub width: f64,
    /// Rows of panels; a place may be empty.
    pub rows: Vec<Vec<Option<Panel>>>,
    /// Height of each row's frames.
    pub heights: Vec<Height>,
    /// Whether all panels of a column have one horizontal axis, labelled at the lowest.
    pub shared_x: bool,
}

/// Height of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Height {
    /// So many points.
    Points(f64),
    /// So many times the width.
    OfWidth(f64),
}

/// Lengths of a sheet (pt).
struct Layout {
    /// Room left of each column's frames.
    left: Vec<f64>,
    /// Room right of all frames, for half a label of the horizontal axis.
    right: f64,
    /// Width of all frames.
    frame: f64,
    /// Height of each row's frames.
    heights: Vec<f64>,
    /// Header lines of each row.
    headers: Vec<usize>,
}

impl Sheet {
    /// Draws the sheet as an SVG file, its letters as text or by their outlines. Returns it with
    /// its size (mm).
    pub fn draw(&self, title: &str, description: &str, outlines: bool) -> (String, [f64; 2]) {
        let layout = self.layout();
        let mut top = MARGIN;
        let mut frames = Vec::new();
        for row in 0..self.rows.len() {
            top += HEADER * layout.headers[row] as f64;
            frames.push(top);
            top += layout.heights[row] + self.below(row);
        }
        let size = [self.width, ((top + MARGIN) / POINTS_PER_MM * 100.0).ceil() / 100.0];
        let mut svg = Svg::new(size, title, description).outlined(outlines);
        for (row, top) in frames.iter().enumerate() {
            self.draw_row(&mut svg, &layout, row, *top);
        }
        if let (Some(title), Some(first), Some(last)) =
            (self.common_title(), frames.first(), frames.last())
        {
            let bottom = last + layout.heights.last().unwrap_or(&0.0);
            let at = [MARGIN + TITLE_DROP, 0.5 * (first + bottom)];
            svg.text_upwards(at, Anchor::Middle, TYPE, &title);
        }
        (svg.finish(), size)
    }

    fn draw_row(&self, svg: &mut Svg, layout: &Layout, row: usize, top: f64) {
        let mut x = MARGIN;
        for (column, panel) in self.rows[row].iter().enumerate() {
            x += layout.left[column];
            if let Some(panel) = panel {
                let frame = Frame { corner: [x, top], size: [layout.frame, layout.heights[row]] };
                panel.draw(svg, frame, self.words(row, column), layout.left[column] - TITLE_DROP);
                let line = top - HEADER_GAP;
                panel.draw_label(svg, [x, line], layout.frame);
                let first = line - HEADER * layout.headers[row].saturating_sub(1) as f64;
                panel.draw_legend(svg, [x + layout.frame, first], layout.frame, HEADER);
            }
            x += layout.frame + layout.right;
        }
    }

    fn layout(&self) -> Layout {
        let columns = self.columns();
        let width = self.width * POINTS_PER_MM - 2.0 * MARGIN;
        // Widths of labels depend on heights, and heights on widths: a first guess will do, since
        // taller frames only have more ticks of the same kind.
        let guess = width / columns.max(1) as f64 - 40.0;
        let heights = |frame: f64| -> Vec<f64> {
            let height = |height: &Height| match height {
                Height::Points(points) => *points,
                Height::OfWidth(share) => share * frame,
            };
            self.heights.iter().map(height).collect()
        };
        let guessed = heights(guess);
        let left: Vec<f64> =
            (0..columns).map(|column| self.room_left_of(column, &guessed)).collect();
        let panels = self.rows.iter().flatten().flatten();
        let right = panels.map(|panel| 0.5 * panel.x_label_width(guess)).fold(RIGHT, f64::max);
        let frame = (width - left.iter().sum::<f64>()) / columns.max(1) as f64 - right;
        let lines = |row: &Vec<Option<Panel>>| {
            let lines = row.iter().flatten().map(|panel| panel.header_lines(frame));
            lines.max().unwrap_or(0)
        };
        let headers = self.rows.iter().map(lines).collect();
        Layout { left, right, frame, heights: heights(frame), headers }
    }

    fn columns(&self) -> usize {
        self.rows.iter().map(Vec::len).max().unwrap_or(0)
    }

    fn panel(&self, row: usize, column: usize) -> Option<&Panel> {
        self.rows.get(row)?.get(column)?.as_ref()
    }

    fn room_left_of(&self, column: usize, heights: &[f64]) -> f64 {
        let room = |row: usize| {
            let panel = self.panel(row, column)?;
            let common = column == 0 && self.common_title().is_some();
            let titled = self.words(row, column).y_title || common;
            let title = if titled { Y_TITLE } else { 0.0 };
            Some(panel.y_label_width(heights[row]) + LABEL_GAP + title)
        };
        (0..self.rows.len()).filter_map(room).fold(0.0, f64::max)
    }

    /// A title stands where no other panel of the same row or column has it for this one.
    fn words(&self, row: usize, column: usize) -> Words {
        let below = self.panel(row + 1, column);
        let left = column.checked_sub(1).and_then(|left| self.panel(row, left));
        let here = self.panel(row, column);
        let same = |other: Option<&Panel>, title: fn(&Panel) -> Text| {
            here.zip(other).is_some_and(|(here, other)| title(here) == title(other))
        };
        let x_title = !same(below, |panel| panel.x.full_title());
        Words {
            x_labels: !self.shared_x || x_title,
            x_title,
            y_title: self.common_title().is_none() && !same(left, |panel| panel.y.full_title()),
        }
    }

    /// The title of the vertical axis that all panels of a single column share.
    fn common_title(&self) -> Option<Text> {
        let mut titles = self.rows.iter().flatten().flatten().map(|panel| panel.y.full_title());
        let first = titles.next().filter(|_| self.shared_x && self.rows.len() > 1)?;
        titles.all(|title| title == first).then_some(first)
    }

    /// Room below a row's frames (pt).
    fn below(&self, row: usize) -> f64 {
        let words: Vec<Words> = (0..self.columns())
            .filter(|column| self.panel(row, *column).is_some())
            .map(|column| self.words(row, column))
            .collect();
        let labels = if words.iter().any(|words| words.x_labels) { X_LABELS } else { ROW_GAP };
        labels + if words.iter().any(|words| words.x_title) { X_TITLE } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::panel::Axis;

    fn panel(title: &str) -> Option<Panel> {
        Some(Panel {
            label: Text::roman("a run"),
            legend: Vec::new(),
            x: Axis::fitting(Text::roman("Across"), "s", [0.0, 1.0]),
            y: Axis::fitting(Text::roman(title), "N", [0.0, 1000.0]),
            marks: Vec::new(),
        })
    }

    fn draw(rows: Vec<Vec<Option<Panel>>>, shared_x: bool) -> String {
        let heights = vec![Height::Points(80.0); rows.len()];
        let sheet = Sheet { width: SINGLE_COLUMN, rows, heights, shared_x };
        let (svg, size) = sheet.draw("Title", "Description", false);
        assert_eq!(size[0], SINGLE_COLUMN);
        svg
    }

    fn count(svg: &str, words: &str) -> usize {
        svg.matches(words).count()
    }

    #[test]
    fn a_stack_has_its_titles_once_and_labels_below() {
        let svg = draw(vec![vec![panel("Up")], vec![panel("Up")], vec![panel("Up")]], true);
        assert_eq!((count(&svg, ">Across (s)<"), count(&svg, ">Up (kN)<")), (1, 1));
        assert_eq!((count(&svg, ">0.2<"), count(&svg, ">0.5<")), (1, 3));
        let svg = draw(vec![vec![panel("Up")], vec![panel("Other")]], true);
        assert_eq!((count(&svg, ">Up (kN)<"), count(&svg, ">Other (kN)<")), (1, 1));
    }

    #[test]
    fn long_words_of_narrow_panels_are_set_smaller() {
        let mut narrow = panel("Up").unwrap();
        narrow.label = Text::roman("a run whose name is long");
        narrow.x.title = Text::roman("A quantity whose name is long");
        let svg = draw(vec![vec![Some(narrow.clone()), Some(narrow.clone()), Some(narrow)]], false);
        for (words, size) in [("a run whose name is long", 8.0), ("A quantity", 9.0)] {
            let (before, _) = svg.split_once(words).unwrap();
            let (_, attribute) = before.rsplit_once("font-size=\"").unwrap();
            let drawn: f64 = attribute.split('"').next().unwrap().parse().unwrap();
            assert!(drawn < size, "{words}: {drawn}");
            assert_eq!(count(&svg, words), 3);
        }
    }

    #[test]
    fn a_grid_with_gaps_titles_every_row_and_column() {
        let svg = draw(vec![vec![panel("Up"), None], vec![panel("Up"), panel("Up")]], false);
        assert_eq!((count(&svg, ">Across (s)<"), count(&svg, ">Up (kN)<")), (2, 2));
    }

    #[test]
    fn a_sheet_without_panels_is_still_a_picture() {
        assert!(draw(Vec::new(), true).ends_with("</svg>\n"));
    }
}
