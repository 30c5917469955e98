//! `freeplay plot FILE… -o DIR`

use super::{Failure, laws, signals};
use crate::figure::{self, Figure, Format, Options, Over};
use crate::model::did_you_mean;
use crate::record::{self, Draft, ResultFile};
use crate::study::Recorded;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Arguments of `plot`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Result files (HDF5); one without clearances is drawn dashed beside the others. Or the folder of
    /// a study.
    #[arg(value_name = "FILE", required_unless_present = "law", conflicts_with = "law")]
    files: Vec<PathBuf>,
    /// Draw force over penetration in one impact by these laws of the normal force, names with commas
    /// between, or `all`; needs no files.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    law: Vec<String>,
    /// Nominal restitution of these laws.
    #[arg(long, value_name = "E", default_value = "0.5", requires = "law")]
    restitution: f64,
    /// Folder for the figures; made if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Kind of files; several with commas between.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "svg")]
    format: Vec<FormatName>,
    /// Write these figures only: names with commas between, "force-A" or all of a kind, "force".
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    only: Vec<String>,
    /// What histories are drawn over.
    #[arg(long, value_enum, default_value = "time")]
    over: OverName,
    /// The drive whose angle counts; default: the first.
    #[arg(long, value_name = "NAME")]
    drive: Option<String>,
    /// Draw from this time on (s).
    #[arg(long, value_name = "T", value_parser = finite, allow_negative_numbers = true)]
    from: Option<f64>,
    /// Draw until this time (s).
    #[arg(long, value_name = "T", value_parser = finite, allow_negative_numbers = true)]
    until: Option<f64>,
    /// Drive angle of the Poincaré section (degrees).
    #[arg(long, value_name = "ANGLE", value_parser = finite, default_value = "0", allow_negative_numbers = true)]
    section: f64,
    /// Width of the figures (mm); default: 90, the width of a journal's column, or 190, of both.
    #[arg(long, value_name = "MM", value_parser = width)]
    width: Option<f64>,
    /// How letters are drawn: as text, or by their outlines, which look alike in every viewer.
    #[arg(long, value_enum, default_value = "text")]
    text: TextName,
    /// What a run is called; once for each file, in their order.
    #[arg(long, value_name = "NAME")]
    label: Vec<String>,
    /// Draw forces, torques and accelerations of all runs in one panel.
    #[arg(long)]
    overlay: bool,
    /// Replace figures that exist.
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum FormatName {
    /// Scalable Vector Graphics.
    Svg,
    /// Portable Network Graphics, 300 dots per inch.
    Png,
    /// Portable Document Format.
    Pdf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum OverName {
    /// Time.
    Time,
    /// The angle of a drive.
    Angle,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum TextName {
    /// Text, in Liberation Sans or a font as wide.
    Text,
    /// Outlines.
    Outlines,
}

fn finite(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if f64::is_finite(value) => Ok(value),
        _ => Err("it must be a number".to_owned()),
    }
}

fn width(text: &str) -> Result<f64, String> {
    match finite(text) {
        Ok(width) if (40.0..=1000.0).contains(&width) => Ok(width),
        _ => Err("it must be a number from 40 to 1000 (mm)".to_owned()),
    }
}

/// A figure was asked for that the files do not give.
#[derive(Debug, thiserror::Error)]
#[error("there is no figure \"{name}\"{hint}; there are {known}")]
struct NoFigure {
    name: String,
    hint: String,
    known: String,
}

/// Why figures could not be written.
#[derive(Debug, thiserror::Error)]
enum PlotError {
    #[error("cannot make the folder {}", path.display())]
    Folder { path: PathBuf, source: io::Error },
    #[error(transparent)]
    Output(#[from] record::Error),
    #[error("cannot draw {}", path.display())]
    Encode { path: PathBuf, source: figure::EncodeError },
}

/// Draws the figures of result files.
pub(super) fn plot(arguments: &Arguments) -> Result<(), Failure> {
    signals::end_at_once()?;
    let figures = if let Some(folder) = study_folder(&arguments.files).map_err(Failure::input)? {
        let recorded = Recorded::open(folder).map_err(Failure::input)?;
        figure::draw_study(&recorded, &options(arguments)).map_err(Failure::input)?
    } else if arguments.law.is_empty() {
        let files = arguments.files.iter().map(|path| ResultFile::open(path));
        let files = files.collect::<Result<Vec<_>, _>>().map_err(Failure::input)?;
        figure::draw(files, &options(arguments)).map_err(Failure::input)?
    } else {
        let laws = laws::of_names(&arguments.law)?;
        laws::check_restitution(arguments.restitution)?;
        figure::draw_laws(&laws, arguments.restitution, &options(arguments))
    };
    let figures = chosen(figures, &arguments.only).map_err(Failure::input)?;
    let formats = formats(arguments);
    let inputs: Vec<&Path> = arguments.files.iter().map(PathBuf::as_path).collect();
    let written = write(&figures, &formats, &arguments.output, arguments.force, &inputs)?;
    let (count, folder) = (figures.len(), arguments.output.display());
    super::print(format_args!("{folder}: {count} figures, {written} files\n"))
}

/// Something was asked for together with the folder of a study.
#[derive(Debug, thiserror::Error)]
#[error("{} is a folder: a study is drawn by itself", path.display())]
pub(super) struct NotByItself {
    path: PathBuf,
}

/// The folder of the study that is to be drawn, if it is one.
pub(super) fn study_folder(files: &[PathBuf]) -> Result<Option<&Path>, NotByItself> {
    match (files, files.iter().find(|path| path.is_dir())) {
        (_, None) => Ok(None),
        ([folder], Some(_)) => Ok(Some(folder)),
        (_, Some(path)) => Err(NotByItself { path: path.clone() }),
    }
}

/// The figures that are asked for by name or kind; all if none is.
fn chosen(figures: Vec<Figure>, only: &[String]) -> Result<Vec<Figure>, NoFigure> {
    let is = |figure: &Figure, name: &String| figure.name == *name || figure.kind == name;
    if let Some(name) = only.iter().find(|name| !figures.iter().any(|figure| is(figure, name))) {
        let known: Vec<&str> = figures.iter().map(|figure| figure.name.as_str()).collect();
        let hint = did_you_mean(name, known.iter().copied());
        return Err(NoFigure { name: name.clone(), hint, known: known.join(", ") });
    }
    let wanted = |figure: &Figure| only.is_empty() || only.iter().any(|name| is(figure, name));
    Ok(figures.into_iter().filter(wanted).collect())
}

fn options(arguments: &Arguments) -> Options {
    Options {
        over: match arguments.over {
            OverName::Time => Over::Time,
            OverName::Angle => Over::Angle,
        },
        drive: arguments.drive.clone(),
        from: arguments.from,
        until: arguments.until,
        section: arguments.section.to_radians(),
        width: arguments.width,
        outlines: arguments.text == TextName::Outlines,
        labels: arguments.label.clone(),
        overlay: arguments.overlay,
    }
}

/// The formats asked for, each once.
fn formats(arguments: &Arguments) -> Vec<Format> {
    let asked = |name| arguments.format.contains(&name);
    let all = [
        (FormatName::Svg, Format::Svg),
        (FormatName::Png, Format::Png),
        (FormatName::Pdf, Format::Pdf),
    ];
    all.into_iter().filter(|(name, _)| asked(*name)).map(|(_, format)| format).collect()
}

/// Writes every figure in every format; says how many files that were. Nothing is written if a
/// file that must stay is in the way.
pub(super) fn write(
    figures: &[Figure],
    formats: &[Format],
    folder: &Path,
    force: bool,
    inputs: &[&Path],
) -> Result<usize, Failure> {
    write_files(figures, formats, folder, force, inputs).map_err(Failure::output)
}

fn write_files(
    figures: &[Figure],
    formats: &[Format],
    folder: &Path,
    force: bool,
    inputs: &[&Path],
) -> Result<usize, PlotError> {
    fs::create_dir_all(folder).map_err(|source| {
        let path = folder.to_owned();
        PlotError::Folder { path, source }
    })?;
    let path = |figure: &Figure, format: Format| {
        folder.join(format!("{}.{}", figure.name, format.ending()))
    };
    let files: Vec<(&Figure, Format, PathBuf)> = figures
        .iter()
        .flat_map(|figure| formats.iter().map(move |format| (figure, *format)))
        .map(|(figure, format)| (figure, format, path(figure, format)))
        .collect();
    let draft = |(_, _, path): &(_, _, PathBuf)| Draft::create_from(path, force, inputs);
    let drafts: Vec<Draft> = files.iter().map(draft).collect::<Result<_, _>>()?;
    for ((figure, format, path), draft) in files.iter().zip(drafts) {
        let encoded = figure.encode(*format);
        let bytes = encoded.map_err(|source| PlotError::Encode { path: path.clone(), source })?;
        draft.publish_bytes(&bytes)?;
    }
    Ok(files.len())
}
