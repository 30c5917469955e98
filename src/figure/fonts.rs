//! The fonts in the program: figures need none of the system's.

use super::decimate::Point;
use super::svg::number;
use resvg::usvg::fontdb::{Database, Source};
use std::fmt::Write;
use std::sync::Arc;

/// Families of figures, most wanted first. The others have the same widths, for viewers of SVG
/// files without the first.
pub(super) const FAMILIES: &str = "Liberation Sans, Arial, Helvetica, sans-serif";

/// A font in the program.
#[derive(Debug, Clone, Copy)]
pub struct Font {
    /// Full name.
    pub name: &'static str,
    /// Version, as the font itself says.
    pub version: &'static str,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: &'static str,
    /// The file.
    pub file: &'static [u8],
}

/// Upright letters.
pub static ROMAN: Font = Font {
    name: "Liberation Sans",
    version: "2.1.5",
    sha256: "8d91388f1d3604b3b8ae0e3ee2d140e50cd6122f9214514f4aca772540a4076d",
    file: include_bytes!("../../assets/fonts/LiberationSans-Regular.ttf"),
};

/// Italic letters: symbols of quantities.
pub static ITALIC: Font = Font {
    name: "Liberation Sans Italic",
    version: "2.1.5",
    sha256: "01f559e5c501d3d5777647c6a92b3ff37a4523bcf4f3b6e97ae052af567618b1",
    file: include_bytes!("../../assets/fonts/LiberationSans-Italic.ttf"),
};

impl Font {
    /// Width of a text set in this font, in units of the font's size.
    pub(super) fn width(&self, text: &str) -> f64 {
        let Ok(face) = ttf_parser::Face::parse(self.file, 0) else { return 0.0 };
        let advance = |letter| {
            let glyph = face.glyph_index(letter).unwrap_or_default();
            face.glyph_hor_advance(glyph).map_or(0.0, f64::from)
        };
        text.chars().map(advance).sum::<f64>() / f64::from(face.units_per_em())
    }

    /// Adds the outlines of a text to the data of an SVG path: from a place on, at a size.
    pub(super) fn outline(&self, text: &str, at: Point, size: f64, data: &mut String) {
        let Ok(face) = ttf_parser::Face::parse(self.file, 0) else { return };
        let scale = size / f64::from(face.units_per_em());
        let mut pen = Pen { at, scale, data };
        for letter in text.chars() {
            let glyph = face.glyph_index(letter).unwrap_or_default();
            face.outline_glyph(glyph, &mut pen);
            pen.at[0] += scale * face.glyph_hor_advance(glyph).map_or(0.0, f64::from);
        }
    }
}

/// Writes the outline of a glyph as the data of an SVG path.
struct Pen<'a> {
    /// Where the glyph begins on its line.
    at: Point,
    /// Length of a unit of the font.
    scale: f64,
    data: &'a mut String,
}

impl Pen<'_> {
    fn write(&mut self, command: char, points: &[[f32; 2]]) {
        self.data.push(command);
        for (k, [x, y]) in points.iter().enumerate() {
            let x = number(self.at[0] + self.scale * f64::from(*x));
            let y = number(self.at[1] - self.scale * f64::from(*y));
            let space = if k == 0 { "" } else { " " };
            let _ = write!(self.data, "{space}{x} {y}");
        }
    }
}

impl ttf_parser::OutlineBuilder for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.write('M', &[[x, y]]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.write('L', &[[x, y]]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.write('Q', &[[x1, y1], [x, y]]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.write('C', &[[x1, y1], [x2, y2], [x, y]]);
    }

    fn close(&mut self) {
        self.data.push('Z');
    }
}

/// The fonts for whoever draws text; no others are there.
pub(super) fn database() -> Arc<Database> {
    let mut database = Database::new();
    for font in [&ROMAN, &ITALIC] {
        database.load_font_source(Source::Binary(Arc::new(font.file)));
    }
    database.set_sans_serif_family(ROMAN.name);
    Arc::new(database)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sha2::{Digest, Sha256};
    use ttf_parser::{Face, name_id};

    fn name_of(face: &Face, id: u16) -> String {
        let mut names = face.names().into_iter().filter(|name| name.name_id == id);
        names.find_map(|name| name.to_string()).unwrap()
    }

    #[test]
    fn the_fonts_are_the_files_that_the_record_names() {
        let record = include_str!("../../assets/fonts/README.md");
        for font in [ROMAN, ITALIC] {
            let found: String =
                Sha256::digest(font.file).iter().map(|byte| format!("{byte:02x}")).collect();
            assert_eq!(found, font.sha256);
            assert!(record.contains(font.sha256), "{}", font.name);
            let face = Face::parse(font.file, 0).unwrap();
            assert_eq!(name_of(&face, name_id::FULL_NAME), font.name);
            assert_eq!(name_of(&face, name_id::VERSION), format!("Version {}", font.version));
            assert!(name_of(&face, name_id::LICENSE).contains("SIL Open Font License"));
        }
    }

    #[test]
    fn the_licence_stands_beside_the_fonts() {
        let licence = include_str!("../../assets/fonts/LICENSE");
        assert!(licence.contains("SIL OPEN FONT LICENSE Version 1.1"));
        assert!(licence.contains("Reserved Font Name Liberation"));
    }

    #[test]
    fn every_sign_that_figures_use_has_a_glyph() {
        for font in [ROMAN, ITALIC] {
            let face = Face::parse(font.file, 0).unwrap();
            for sign in "−–°µ·×²³ΔαδφωεθRFTWEtexy,()/%\u{307}\u{a0}".chars() {
                assert!(face.glyph_index(sign).is_some(), "{sign:?} in {}", font.name);
            }
        }
    }

    #[test]
    fn digits_are_all_of_one_width() {
        let width = ROMAN.width("0");
        for digit in "123456789".chars() {
            assert_eq!(ROMAN.width(&digit.to_string()), width);
        }
        assert!((ROMAN.width("00") - 2.0 * width).abs() < 1e-12);
    }
}
