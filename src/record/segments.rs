//! Long runs: the result file, and beside it a file for each segment from checkpoint to checkpoint.
//!
//! A segment, `NAME.segments/000001.h5` and so on, is a result file like any other, whole and on the
//! disk once the run has passed its checkpoint. It has the rows told since the checkpoint before and,
//! in the attribute `checkpoint`, all that the run goes on from. A run that is taken up copies the rows
//! of the segments to a new result file, in the order in which they stood in the old one: so both are
//! the same to the byte. A result file that is complete has the last checkpoint too, so that it can be
//! made longer.

use super::header::{Ending, Header, Outcome, utc};
use super::publish::{folder_of, make_names_durable, remove_left_behind};
use super::reader::ResultFile;
use super::schema::Dimension;
use super::store::{Purpose, hdf5_version};
use super::writer::Writer;
use super::{Attribute, Error};
use crate::halt;
use crate::mechanism::Observation;
use crate::run::{Contact, Event, Kept, Peak, Recorder, Revolution};
use crate::scalar::bits;
use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::fs;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The attribute that a checkpoint is kept in.
pub(super) const CHECKPOINT: &str = "checkpoint";

/// Dimensions that grow.
const GROWING: [Dimension; 5] =
    [Dimension::Time, Dimension::Event, Dimension::Contact, Dimension::Peak, Dimension::Revolution];

/// Rows that are read at once.
const ROWS: usize = 4096;

/// A checkpoint as files keep it.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Mark {
    /// Who wrote it.
    program: String,
    /// Time (s).
    #[serde(with = "bits")]
    time: f64,
    /// Rows that the run had told by then, of each dimension of [`GROWING`].
    rows: [usize; GROWING.len()],
    /// The full blocks of the result file by then, in their order, each by its place in [`GROWING`].
    blocks: String,
    /// What the run goes on from.
    run: String,
}

impl Mark {
    /// Of a file; its program is this one.
    fn of(file: &ResultFile) -> Result<Mark, Error> {
        let path = || file.path().to_owned();
        let Some(text) = file.text(CHECKPOINT) else {
            return Err(Error::NoCheckpoint { path: path() });
        };
        let mark: Mark = serde_json::from_str(text).map_err(|error| Error::Damaged {
            path: path(),
            what: format!("its checkpoint cannot be read: {error}"),
        })?;
        if mark.program != program() {
            let (theirs, ours) = (mark.program, program());
            return Err(Error::OtherProgram { path: path(), theirs, ours });
        }
        Ok(mark)
    }

    /// The attribute that keeps it.
    fn attribute(&self) -> (String, Attribute) {
        // numbers are written by their bits, so that there is nothing that JSON has not
        (CHECKPOINT.to_owned(), serde_json::to_string(self).unwrap_or_default().into())
    }
}

/// This program, as far as another would go on otherwise.
pub(crate) fn program() -> String {
    let (version, commit) = (env!("CARGO_PKG_VERSION"), env!("FREEPLAY_COMMIT"));
    let commit = if commit.is_empty() { "unknown" } else { commit };
    let (sundials, hdf5) = (crate::engine::ida::sundials_version(), hdf5_version());
    format!("freeplay {version} (commit {commit}) with SUNDIALS {sundials} and HDF5 {hdf5}")
}

/// Writes a result file and, where a run has checkpoints, its segments.
#[derive(Debug)]
pub struct Segmented {
    whole: Writer,
    parts: Option<Parts>,
}

/// The segments of a run.
#[derive(Debug)]
struct Parts {
    folder: PathBuf,
    header: Header,
    /// How many are on the disk.
    kept: usize,
    /// The one that is being written, once it has a row.
    open: Option<Writer>,
    mark: Option<Mark>,
}

/// What a run goes on from.
#[derive(Debug)]
pub struct Resumed {
    /// Time of the checkpoint (s).
    pub time: f64,
    /// The text that [`Kept::text`] was.
    pub run: String,
    segments: Vec<PathBuf>,
}

impl Resumed {
    /// Tells all samples and contacts so far once more.
    ///
    /// # Errors
    /// What reading meets.
    pub fn recall(&self, told: &mut impl Recorder<Error = Error>) -> Result<(), Error> {
        for path in &self.segments {
            let file = ResultFile::open(path)?;
            let samples = file.length(Dimension::Time);
            for begin in (0..samples).step_by(ROWS) {
                go_on(path)?;
                for sample in file.observations(begin..samples.min(begin + ROWS))? {
                    told.sample(&sample)?;
                }
            }
            file.events()?.into_iter().try_for_each(|event| told.event(event))?;
            file.contacts()?.into_iter().try_for_each(|contact| told.contact(contact))?;
        }
        Ok(())
    }
}

impl Segmented {
    /// Begins a result file as [`Writer::create_from`] does, of a run with or without checkpoints.
    ///
    /// # Errors
    /// Those of [`Writer::create_from`], and [`Error::SegmentsLeft`] without `force`.
    pub fn begin(
        output: &Path,
        header: Header,
        force: bool,
        inputs: &[&Path],
        checkpoints: bool,
    ) -> Result<Segmented, Error> {
        let whole = Writer::create_from(output, header.clone(), force, inputs)?;
        let parts = match checkpoints {
            true => Some(Parts::begin(output, header, force)?),
            false => None,
        };
        Ok(Segmented { whole, parts })
    }

    /// Goes on where the segments of the output end, with the same case and program; begins where there
    /// are none.
    ///
    /// # Errors
    /// Those of [`begin`](Segmented::begin), [`Error::OtherCase`], [`Error::OtherProgram`], and what
    /// reading the segments meets.
    pub fn resume(
        output: &Path,
        mut header: Header,
        force: bool,
        inputs: &[&Path],
    ) -> Result<(Segmented, Option<Resumed>), Error> {
        let folder = folder_for(output);
        let Some(first) = segments_in(&folder)?.into_iter().next() else {
            return Ok((Segmented::begin(output, header, force, inputs, true)?, None));
        };
        let first = ResultFile::open(&first)?;
        same_case(&first, &header)?;
        header.started_utc = first.text("started_utc").unwrap_or(&header.started_utc).to_owned();
        let mut whole = Writer::create_from(output, header.clone(), force, inputs)?;
        // from now on nobody else writes any
        let segments = segments_in(&folder)?;
        let last = segments.last().map(|last| ResultFile::open(last)).transpose()?;
        let mark = Mark::of(last.as_ref().unwrap_or(&first))?;
        Rows::of(&segments, &header)?.copy(&mark, &mut whole)?;
        let resumed = Resumed { time: mark.time, run: mark.run.clone(), segments };
        let kept = resumed.segments.len();
        let parts = Parts { folder, header, kept, open: None, mark: Some(mark) };
        Ok((Segmented { whole, parts: Some(parts) }, Some(resumed)))
    }

    /// Makes the rows of a complete result file, up to its last checkpoint, the first segment of a run
    /// that is to be longer: its header is that of the longer run.
    ///
    /// # Errors
    /// [`Error::NoCheckpoint`], [`Error::OtherProgram`], or what writing meets.
    pub fn extend(finished: &ResultFile, mut header: Header) -> Result<(), Error> {
        let mark = Mark::of(finished)?;
        header.started_utc = finished.text("started_utc").unwrap_or_default().to_owned();
        let mut parts = Parts::begin(finished.path(), header, false)?;
        for (dimension, count) in GROWING.into_iter().zip(mark.rows) {
            copy(finished, dimension, 0..count, parts.part()?)?;
        }
        parts.close(mark)
    }

    /// How many segments are on the disk, and where; `None` without checkpoints.
    pub fn segments(&self) -> Option<(usize, &Path)> {
        self.parts.as_ref().map(|parts| (parts.kept, parts.folder.as_path()))
    }

    /// Finishes the result file, see [`Writer::finish`]. The segments of a run that is complete go; those
    /// of another stay.
    ///
    /// # Errors
    /// Those of [`Writer::finish`].
    pub fn finish(self, mut ending: Ending) -> Result<PathBuf, Error> {
        let Segmented { whole, parts } = self;
        let complete = ending.outcome == Outcome::Complete;
        let mark = parts.as_ref().and_then(|parts| parts.mark.as_ref());
        ending.attributes.extend(mark.filter(|_| complete).map(Mark::attribute));
        let published = whole.finish(ending)?;
        if let Some(parts) = parts.filter(|_| complete) {
            let folder = parts.folder.clone();
            drop(parts);
            clear(&folder);
        }
        Ok(published)
    }

    /// Tells the present segment something, too.
    fn part(&mut self, tell: impl FnOnce(&mut Writer) -> Result<(), Error>) -> Result<(), Error> {
        self.parts.as_mut().map_or(Ok(()), |parts| tell(parts.part()?))
    }
}

/// Whether a result file is the whole of the run of a case by this program.
pub fn is_whole(file: &ResultFile, case_text: &str) -> bool {
    let ours = !matches!(Mark::of(file), Err(Error::OtherProgram { .. }));
    ours && file.is_complete() && file.text("case_toml") == Some(case_text)
}

/// Removes what a run that was killed behind its end has left beside its output.
pub fn tidy(output: &Path) {
    clear(&folder_for(output));
    remove_left_behind(folder_of(output));
}

/// Whether there are segments of an output.
pub fn has_segments(output: &Path) -> bool {
    segments_in(&folder_for(output)).is_ok_and(|segments| !segments.is_empty())
}

impl Recorder for Segmented {
    type Error = Error;

    fn sample(&mut self, observation: &Observation) -> Result<(), Error> {
        self.part(|part| part.sample(observation))?;
        self.whole.sample(observation)
    }

    fn event(&mut self, event: Event) -> Result<(), Error> {
        self.part(|part| part.event(event))?;
        self.whole.event(event)
    }

    fn contact(&mut self, contact: Contact) -> Result<(), Error> {
        self.part(|part| part.contact(contact))?;
        self.whole.contact(contact)
    }

    fn peak(&mut self, peak: Peak) -> Result<(), Error> {
        self.part(|part| part.peak(peak))?;
        self.whole.peak(peak)
    }

    fn keeps_revolutions(&self) -> bool {
        true
    }

    fn revolution(&mut self, revolution: &Revolution) -> Result<(), Error> {
        self.part(|part| part.revolution(revolution))?;
        self.whole.revolution(revolution)
    }

    /// Has all rows so far on the disk, whatever happens then.
    fn checkpoint(&mut self, kept: &Kept) -> Result<std::ops::ControlFlow<()>, Error> {
        let Segmented { whole, parts } = self;
        if let Some(parts) = parts {
            let place = |dimension| GROWING.iter().position(|known| *known == dimension);
            let places = whole.order().iter().filter_map(|dimension| place(*dimension));
            parts.close(Mark {
                program: program(),
                time: kept.time,
                rows: GROWING.map(|dimension| whole.rows()[dimension as usize]),
                blocks: places.map(|place| place.to_string()).collect(),
                run: kept.text.clone(),
            })?;
        }
        Ok(std::ops::ControlFlow::Continue(()))
    }
}

impl Parts {
    /// Makes the folder; with `force` segments that are there go.
    fn begin(output: &Path, header: Header, force: bool) -> Result<Self, Error> {
        let folder = folder_for(output);
        let count = segments_in(&folder)?.len();
        if count > 0 && !force {
            return Err(Error::SegmentsLeft { folder, count });
        }
        clear(&folder);
        let failed = |attempt: &'static str| {
            let path = folder.clone();
            move |source| Error::System { attempt, path, source }
        };
        match fs::create_dir(&folder) {
            // what others put there stays
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && folder.is_dir() => {}
            made => made.map_err(failed("make"))?,
        }
        make_names_durable(folder_of(&folder)).map_err(failed("make durable the name of"))?;
        Ok(Parts { folder, header, kept: 0, open: None, mark: None })
    }

    /// The segment that is being written.
    fn part(&mut self) -> Result<&mut Writer, Error> {
        if self.open.is_none() {
            let path = self.folder.join(segment_name(self.kept + 1));
            let header = self.header.clone();
            self.open = Some(Writer::make(&path, header, false, &[], Purpose::Segment)?);
        }
        self.open.as_mut().ok_or_else(|| Error::Failed { path: self.folder.clone() })
    }

    /// Ends the segment at a checkpoint; it is on the disk then.
    fn close(&mut self, mark: Mark) -> Result<(), Error> {
        self.part()?;
        let Some(part) = self.open.take() else { return Ok(()) };
        part.finish_or_drop(Ending {
            outcome: Outcome::Running,
            counts: Vec::new(),
            rulings: Vec::new(),
            finished_utc: utc(SystemTime::now()),
            series: Vec::new(),
            attributes: vec![mark.attribute()],
        })?;
        self.kept += 1;
        self.mark = Some(mark);
        Ok(())
    }
}

/// The folder for the segments of an output.
fn folder_for(output: &Path) -> PathBuf {
    let mut name = output.file_name().map_or_else(OsString::new, OsString::from);
    name.push(".segments");
    output.with_file_name(name)
}

fn segment_name(number: usize) -> String {
    format!("{number:06}.h5")
}

/// The segments in a folder, in their order: from the first on, without a gap.
fn segments_in(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let failed = |source| Error::System { attempt: "look into", path: folder.to_owned(), source };
    let mut count = 0;
    match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => {
            for entry in entries.map_err(failed)? {
                let name = entry.map_err(failed)?.file_name();
                count += usize::from(number_of(&name).is_some());
            }
        }
    }
    let all: Vec<PathBuf> = (1..=count).map(|number| folder.join(segment_name(number))).collect();
    match all.iter().find(|path| !path.is_file()) {
        Some(lost) => {
            let what = format!("segment {} is missing", lost.display());
            Err(Error::Damaged { path: folder.to_owned(), what })
        }
        None => Ok(all),
    }
}

/// The number of a segment by its name.
fn number_of(name: &std::ffi::OsStr) -> Option<usize> {
    let name = name.to_str()?;
    let number = name.strip_suffix(".h5")?.parse().ok()?;
    (segment_name(number) == name).then_some(number)
}

/// Removes the segments in a folder, the last first, what was begun of one, and the folder if nothing
/// else is in it.
fn clear(folder: &Path) {
    remove_left_behind(folder);
    for path in segments_in(folder).unwrap_or_default().iter().rev() {
        let _ = fs::remove_file(path);
    }
    let _ = fs::remove_dir(folder);
}

/// Refuses a file of another case.
fn same_case(file: &ResultFile, header: &Header) -> Result<(), Error> {
    let theirs = file.text("case_toml").unwrap_or_default();
    if theirs == header.case_text {
        return Ok(());
    }
    Err(Error::OtherCase {
        path: file.path().to_owned(),
        difference: first_difference(theirs, &header.case_text),
    })
}

/// The first line in which a case is no longer what it was.
pub fn first_difference(before: &str, now: &str) -> String {
    let shown = |line: Option<&str>| match line {
        Some(line) => format!("`{}`", crate::model::shortened(line.trim())),
        None => "missing".to_owned(),
    };
    let (mut before, mut now) = (before.lines(), now.lines());
    for number in 1.. {
        match (before.next(), now.next()) {
            (None, None) => break,
            (was, is) if was == is => {}
            (was, is) => {
                return format!("line {number} is {}, and was {}", shown(is), shown(was));
            }
        }
    }
    "its last line ends otherwise".to_owned()
}

/// Whether nobody has asked to stop while a file is read.
fn go_on(path: &Path) -> Result<(), Error> {
    match halt::is_asked() {
        true => Err(Error::Interrupted { path: path.to_owned() }),
        false => Ok(()),
    }
}

/// Copies rows of a file.
fn copy(
    file: &ResultFile,
    dimension: Dimension,
    mut rows: Range<usize>,
    to: &mut Writer,
) -> Result<(), Error> {
    while !rows.is_empty() {
        go_on(file.path())?;
        let part = rows.start..rows.end.min(rows.start + to.room(dimension));
        rows.start = part.end;
        to.copy(file, dimension, part)?;
    }
    Ok(())
}

/// The rows of all segments, one behind another.
struct Rows<'a> {
    segments: &'a [PathBuf],
    /// Rows of each segment, by dimension.
    lengths: Vec<[usize; GROWING.len()]>,
    /// How many of each dimension have been copied.
    copied: [usize; GROWING.len()],
    open: Option<(usize, ResultFile)>,
}

impl<'a> Rows<'a> {
    fn of(segments: &'a [PathBuf], header: &Header) -> Result<Self, Error> {
        let lengths = segments.iter().map(|path| {
            let file = ResultFile::open(path)?;
            same_case(&file, header)?;
            Ok(GROWING.map(|dimension| file.length(dimension)))
        });
        let lengths = lengths.collect::<Result<_, Error>>()?;
        Ok(Rows { segments, lengths, copied: [0; GROWING.len()], open: None })
    }

    /// Copies all, each full block where it stood.
    fn copy(mut self, mark: &Mark, to: &mut Writer) -> Result<(), Error> {
        for block in mark.blocks.bytes().map(|digit| usize::from(digit.wrapping_sub(b'0'))) {
            match GROWING.get(block) {
                Some(dimension) => self.copy_rows(block, to.room(*dimension), to)?,
                None => return Err(self.damaged()),
            }
        }
        for (place, rows) in mark.rows.into_iter().enumerate() {
            let Some(left) = rows.checked_sub(self.copied[place]) else {
                return Err(self.damaged());
            };
            self.copy_rows(place, left, to)?;
        }
        Ok(())
    }

    /// Copies the next rows of a dimension.
    fn copy_rows(&mut self, place: usize, mut count: usize, to: &mut Writer) -> Result<(), Error> {
        while count > 0 {
            let (segment, begin) = self.next(place).ok_or_else(|| self.damaged())?;
            let rows = begin..self.lengths[segment][place].min(begin + count);
            (self.copied[place], count) = (self.copied[place] + rows.len(), count - rows.len());
            copy(self.open(segment)?, GROWING[place], rows, to)?;
        }
        Ok(())
    }

    /// The segment that the next row of a dimension is in, and which of its rows that is.
    fn next(&self, place: usize) -> Option<(usize, usize)> {
        let mut row = self.copied[place];
        self.lengths.iter().enumerate().find_map(|(segment, lengths)| {
            match row.checked_sub(lengths[place]) {
                None => Some((segment, row)),
                Some(behind) => {
                    row = behind;
                    None
                }
            }
        })
    }

    fn open(&mut self, segment: usize) -> Result<&ResultFile, Error> {
        let known = self.open.take().filter(|(number, _)| *number == segment);
        let open = match known {
            Some(open) => open,
            None => (segment, ResultFile::open(&self.segments[segment])?),
        };
        Ok(&self.open.insert(open).1)
    }

    fn damaged(&self) -> Error {
        let folder = self.segments.first().and_then(|path| path.parent());
        Error::Damaged {
            path: folder.unwrap_or(Path::new(".")).to_owned(),
            what: "its segments do not have the rows that the last of them tells of".to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_known_by_their_names_and_none_may_be_missing() {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("a.h5");
        assert!(!has_segments(&output));
        let segments = folder_for(&output);
        fs::create_dir(&segments).unwrap();
        for name in ["000001.h5", "000002.h5", "2.h5", "notes.txt", "+00003.h5"] {
            fs::write(segments.join(name), "").unwrap();
        }
        assert_eq!(segments_in(&segments).unwrap().len(), 2);
        fs::write(segments.join("000004.h5"), "").unwrap();
        let lost = segments_in(&segments).unwrap_err();
        assert!(lost.to_string().contains("000003.h5 is missing"), "{lost}");
        fs::remove_file(segments.join("000004.h5")).unwrap();
        tidy(&output);
        let left = fs::read_dir(&segments).unwrap().count();
        assert_eq!(left, 3);
    }

    #[test]
    fn the_first_line_that_differs_is_told() {
        let told = first_difference("a = 1\nb = 2\n", "a = 1\nb = 3\nc = 4\n");
        assert_eq!(told, "line 2 is `b = 3`, and was `b = 2`");
        assert_eq!(
            first_difference("a = 1\n", "a = 1\nb = 2"),
            "line 2 is `b = 2`, and was missing"
        );
    }
}
