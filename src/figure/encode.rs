//! From SVG to PNG and PDF, with the fonts in the program and no others.

use super::fonts;
use krilla::Document;
use krilla::geom::Size;
use krilla::metadata::Metadata;
use krilla::page::PageSettings;
use krilla_svg::{SurfaceExt, SvgSettings};
use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree};

/// Dots per inch of PNG files.
const DOTS_PER_INCH: f64 = 300.0;
/// Points per inch of PDF files.
const POINTS_PER_INCH: f32 = 72.0;
/// Pixels per inch of SVG files, by definition.
const PIXELS_PER_INCH: f32 = 96.0;

/// Why a picture could not be made of an SVG file.
#[derive(Debug, thiserror::Error)]
pub enum EncodeError {
    /// The SVG file cannot be understood.
    #[error("cannot read the SVG")]
    Svg(#[source] resvg::usvg::Error),
    /// The picture has no or too much area.
    #[error("cannot make a picture of {width} by {height} pixels")]
    Size {
        /// Width (pixels).
        width: u32,
        /// Height (pixels).
        height: u32,
    },
    /// The PNG could not be written.
    #[error("cannot write the PNG")]
    Png(#[from] png::EncodingError),
    /// The PDF could not be written.
    #[error("cannot write the PDF: {0}")]
    Pdf(String),
}

fn tree(svg: &str) -> Result<Tree, EncodeError> {
    let options = Options {
        fontdb: fonts::database(),
        font_family: fonts::ROMAN.name.to_owned(),
        dpi: PIXELS_PER_INCH,
        ..Options::default()
    };
    Tree::from_str(svg, &options).map_err(EncodeError::Svg)
}

/// Draws an SVG file as a PNG of 300 dots per inch, which it says in the file.
pub(super) fn png(svg: &str) -> Result<Vec<u8>, EncodeError> {
    let tree = tree(svg)?;
    let scale = DOTS_PER_INCH as f32 / PIXELS_PER_INCH;
    let [width, height] =
        [tree.size().width(), tree.size().height()].map(|side| (side * scale).round() as u32);
    let mut pixels = Pixmap::new(width, height).ok_or(EncodeError::Size { width, height })?;
    pixels.fill(Color::WHITE);
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    let opaque: Vec<u8> =
        pixels.data().chunks(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let per_metre = (DOTS_PER_INCH / 0.0254).round() as u32;
    encoder.set_pixel_dims(Some(png::PixelDimensions {
        xppu: per_metre,
        yppu: per_metre,
        unit: png::Unit::Meter,
    }));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&opaque)?;
    writer.finish()?;
    Ok(file)
}

/// Draws an SVG file as a PDF page of its size, with text as text.
pub(super) fn pdf(svg: &str, title: &str) -> Result<Vec<u8>, EncodeError> {
    let tree = tree(svg)?;
    let scale = POINTS_PER_INCH / PIXELS_PER_INCH;
    let [width, height] = [tree.size().width() * scale, tree.size().height() * scale];
    let failed = |reason: &str| EncodeError::Pdf(reason.to_owned());
    let settings = PageSettings::from_wh(width, height).ok_or_else(|| failed("it has no area"))?;
    let size = Size::from_wh(width, height).ok_or_else(|| failed("it has no area"))?;
    let mut document = Document::new();
    document.set_metadata(Metadata::new().title(title.to_owned()));
    let mut page = document.start_page_with(settings);
    let mut surface = page.surface();
    surface
        .draw_svg(&tree, size, SvgSettings::default())
        .ok_or_else(|| failed("its drawing cannot be converted"))?;
    surface.finish();
    page.finish();
    document.finish().map_err(|error| EncodeError::Pdf(format!("{error:?}")))
}

#[cfg(test)]
mod tests {
    use super::super::svg::{Anchor, Svg};
    use super::super::text::Text;
    use super::*;

    fn picture(words: &str) -> String {
        let mut svg = Svg::new([30.0, 10.0], "Title", "Description");
        let text = Text::roman(words).and_italic("δ").and_subscript("N").and(" −1 µm");
        svg.text([5.0, 15.0], Anchor::Start, 9.0, &text);
        svg.finish()
    }

    /// Pixels of a PNG that are not white, and its width and height.
    fn dark_pixels(file: &[u8]) -> (usize, [u32; 2]) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        let dark = pixels.chunks(3).filter(|pixel| pixel.iter().any(|value| *value < 255)).count();
        (dark, [info.width, info.height])
    }

    #[test]
    fn no_fonts_but_those_in_the_program_are_known() {
        let names: Vec<String> = tree(&picture("a"))
            .unwrap()
            .fontdb()
            .faces()
            .map(|face| face.families[0].0.clone())
            .collect();
        assert_eq!(names, ["Liberation Sans", "Liberation Sans"]);
    }

    #[test]
    fn a_png_has_text_and_300_dots_an_inch() {
        let file = png(&picture("Force")).unwrap();
        let (dark, size) = dark_pixels(&file);
        assert_eq!(size, [354, 118]); // 30 mm by 10 mm
        let (less, _) = dark_pixels(&png(&picture("")).unwrap());
        assert!(less > 100 && dark > less + 100, "{dark} {less}");
        let reader = png::Decoder::new(std::io::Cursor::new(&file)).read_info().unwrap();
        let dots = reader.info().pixel_dims.unwrap();
        assert_eq!((dots.xppu, dots.yppu), (11811, 11811));
    }

    #[test]
    fn a_pdf_has_the_fonts_it_needs_in_it() {
        let file = pdf(&picture("Force"), "Title").unwrap();
        let text = String::from_utf8_lossy(&file);
        assert!(text.starts_with("%PDF-"));
        for font in ["LiberationSans", "LiberationSans-Italic"] {
            assert!(text.contains(font), "{font}");
        }
        assert!(!text.contains("CreationDate"));
    }

    #[test]
    fn the_same_picture_gives_the_same_bytes() {
        let picture = picture("Force");
        assert!(png(&picture).unwrap() == png(&picture).unwrap());
        assert!(pdf(&picture, "Title").unwrap() == pdf(&picture, "Title").unwrap());
    }

    #[test]
    fn what_is_no_svg_is_refused() {
        assert!(matches!(png("<svg"), Err(EncodeError::Svg(_))));
        assert!(matches!(pdf("nothing", ""), Err(EncodeError::Svg(_))));
    }
}
