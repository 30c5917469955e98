//! Figures of result files, as journals print them: SVG, PNG and PDF.
//!
//! A figure shows one quantity of one part (a joint, a drive, a body) or of the whole mechanism,
//! for one run or several. What parts there are, and what they are called, comes from the files.
//! Samples are reduced to what the page can show, extremes kept; largest forces and the times of
//! events come from the tables of contacts and peaks, so that none is lost between samples. The
//! same files give the same bytes, on every machine: the fonts are in the program.

mod angular_acceleration;
mod clearance_vector;
mod cloud;
mod contact_loops;
mod contact_timeline;
mod decimate;
mod digits;
mod drive_torque;
mod encode;
mod energy;
mod flattened;
mod fonts;
mod force;
mod grid;
mod ink;
mod inset;
mod guide_path;
mod journal_path;
mod law_loops;
mod over_time;
mod palette;
mod panel;
mod phase_portrait;
mod poincare;
mod quantity;
mod runs;
mod sheet;
mod study;
mod svg;
mod text;
mod ticks;
mod touching;

pub use encode::EncodeError;
pub use fonts::{Font, ITALIC, ROMAN};
pub use law_loops::{ImpactLoop, draw_impacts, draw_laws};
pub use sheet::{DOUBLE_COLUMN, SINGLE_COLUMN};
pub use study::draw_study;

use crate::record::{self, ResultFile};
use runs::Runs;
use sheet::Sheet;
use std::path::PathBuf;

/// Why figures could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A result file cannot be read.
    #[error(transparent)]
    Record(#[from] record::Error),
    /// A file has nothing to draw.
    #[error("{} has no samples from {from} s until {until} s", path.display())]
    NoSamples {
        /// The file.
        path: PathBuf,
        /// Begin of what was to be drawn (s).
        from: f64,
        /// Its end (s).
        until: f64,
    },
    /// A drive's angle is asked for, and the file does not tell it.
    #[error("{} tells no angle of a drive: {what}", path.display())]
    NoDrive {
        /// The file.
        path: PathBuf,
        /// Why not.
        what: String,
    },
}

/// What the horizontal axis of a history shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Over {
    /// Time.
    #[default]
    Time,
    /// The angle of a drive.
    Angle,
}

/// What is drawn, and how.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Options {
    /// Horizontal axis of histories.
    pub over: Over,
    /// The drive whose angle counts; the first of a file if left out.
    pub drive: Option<String>,
    /// Begin of what is drawn (s).
    pub from: Option<f64>,
    /// End of what is drawn (s).
    pub until: Option<f64>,
    /// Angle of the drive at which the Poincaré section is taken (rad).
    pub section: f64,
    /// Width of the figures (mm); each has its own if left out.
    pub width: Option<f64>,
    /// Whether letters are drawn by their outlines, not set as text.
    pub outlines: bool,
    /// Names of the runs, in the order of the files; none: those of their cases or files.
    pub labels: Vec<String>,
    /// Whether the histories of all runs share one panel.
    pub overlay: bool,
}

/// Kinds of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Format {
    /// Scalable Vector Graphics.
    #[default]
    Svg,
    /// Portable Network Graphics, 300 dots per inch.
    Png,
    /// Portable Document Format.
    Pdf,
}

impl Format {
    /// The ending of file names.
    pub fn ending(self) -> &'static str {
        match self {
            Format::Svg => "svg",
            Format::Png => "png",
            Format::Pdf => "pdf",
        }
    }
}

/// A drawn figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name, fit for the stem of a file's name, and different from those of the others.
    pub name: String,
    /// Its kind: `force` for the forces of all joints.
    pub kind: &'static str,
    /// What it shows, in words.
    pub title: String,
    /// The picture.
    pub svg: String,
    /// Width and height (mm).
    pub size: [f64; 2],
}

impl Figure {
    /// The figure as a file.
    ///
    /// # Errors
    /// See [`EncodeError`]; SVG never fails.
    pub fn encode(&self, format: Format) -> Result<Vec<u8>, EncodeError> {
        match format {
            Format::Svg => Ok(self.svg.clone().into_bytes()),
            Format::Png => encode::png(&self.svg),
            Format::Pdf => encode::pdf(&self.svg, &self.title),
        }
    }
}

/// Draws all figures that some result files give, runs of one mechanism side by side.
///
/// # Errors
/// See [`Error`].
pub fn draw(files: Vec<ResultFile>, options: &Options) -> Result<Vec<Figure>, Error> {
    let runs = Runs::read(files, options)?;
    let mut figures = Figures { options, description: DESCRIPTION, drawn: Vec::new() };
    clearance_vector::draw(&runs, &mut figures)?;
    force::draw(&runs, &mut figures)?;
    drive_torque::draw(&runs, &mut figures)?;
    angular_acceleration::draw(&runs, &mut figures)?;
    journal_path::draw(&runs, &mut figures)?;
    guide_path::draw(&runs, &mut figures)?;
    phase_portrait::draw(&runs, &mut figures)?;
    poincare::draw(&runs, &mut figures)?;
    contact_loops::draw(&runs, &mut figures)?;
    contact_timeline::draw(&runs, &mut figures)?;
    energy::draw(&runs, &mut figures)?;
    digits::draw(&runs, &mut figures)?;
    Ok(figures.drawn)
}

/// The figures drawn so far.
struct Figures<'a> {
    options: &'a Options,
    /// What every figure says of itself.
    description: &'static str,
    drawn: Vec<Figure>,
}

impl Figures<'_> {
    /// Draws a figure on as many pages as it has sheets. `item` is the part it is about.
    fn add(&mut self, kind: &'static str, item: Option<&str>, title: &str, sheets: Vec<Sheet>) {
        let base = match item {
            Some(item) => format!("{kind}-{item}"),
            None => kind.to_owned(),
        };
        let base: String = base
            .chars()
            .map(|c| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' })
            .collect();
        let pages = sheets.len();
        for (page, mut sheet) in sheets.into_iter().enumerate() {
            sheet.width = self.options.width.unwrap_or(sheet.width);
            let wanted = if pages > 1 { format!("{base}-{}", page + 1) } else { base.clone() };
            let name = self.free_name(wanted);
            let (svg, size) = sheet.draw(title, self.description, self.options.outlines);
            self.drawn.push(Figure { name, kind, title: title.to_owned(), svg, size });
        }
    }

    fn free_name(&self, wanted: String) -> String {
        let taken = |name: &str| self.drawn.iter().any(|figure| figure.name == name);
        let mut name = wanted.clone();
        let mut number = 1;
        while taken(&name) {
            number += 1;
            name = format!("{wanted}_{number}");
        }
        name
    }
}

/// What every figure of result files says of itself.
const DESCRIPTION: &str = concat!(
    "Drawn by freeplay ",
    env!("CARGO_PKG_VERSION"),
    ". Curves go through the samples; largest normal forces, largest penetrations and the times of \
     events are the exact ones of the contact tables."
);

#[cfg(test)]
mod tests;
