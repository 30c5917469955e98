//! The fonts in the program: figures need none of the system's.

use resvg::usvg::fontdb::{Database, Source};
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
