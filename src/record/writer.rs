//! The recorder that writes a result file while the run goes on.
//!
//! Rows gather in blocks of one chunk. A thread compresses and writes each full block, while the
//! run fills the next; the run waits where it is a whole block ahead, so that no more than two
//! blocks are ever in memory.

use super::Error;
use super::header::{Ending, Header, Outcome, utc};
use super::publish::Draft;
use super::reader::ResultFile;
use super::schema::{Dataset, Dimension, Part, Side, Source};
use super::store::{Block, Purpose, Store, datasets_of};
use crate::mechanism::Observation;
use crate::run::{Contact, Event, Extremum, Peak, Recorder, Revolution};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::SystemTime;

/// What the writing thread is told.
enum Message {
    Block(Block),
    Finish(Ending),
}

/// Writes a result file. Errors of the writing thread come back from the next call. A writer that
/// is dropped before [`finish`](Writer::finish) leaves no file.
#[derive(Debug)]
pub struct Writer {
    sender: Option<SyncSender<Message>>,
    thread: Option<JoinHandle<Result<(), Stopped>>>,
    /// Whether the thread has closed a file of what there was before an error.
    kept: bool,
    samples: Block,
    events: Block,
    contacts: Block,
    peaks: Block,
    revolutions: Block,
    /// Rows of a full block.
    block_rows: usize,
    /// Rows so far, by dimension.
    rows: [usize; Dimension::ALL.len()],
    /// The dimensions of the full blocks so far, in the order in which they were written.
    order: Vec<Dimension>,
    widths: Widths,
    draft: Option<Draft>,
    path: PathBuf,
}

/// Lengths of the lists of an observation.
#[derive(Debug, PartialEq, Eq)]
struct Widths {
    bodies: usize,
    joints: usize,
    clearances: usize,
    drives: usize,
    points: usize,
    memories: usize,
}

impl Writer {
    /// Begins a result file at `path`; with `force` a complete one will replace an old file.
    ///
    /// # Errors
    /// [`Error::Exists`], [`Error::NoFolder`], [`Error::NotPlain`], [`Error::Busy`], or what the
    /// operating system or the HDF5 library says.
    pub fn create(path: &Path, header: Header, force: bool) -> Result<Writer, Error> {
        Writer::create_from(path, header, force, &[])
    }

    /// The same for a result that is made from files: none of these may be its output, with `force`
    /// neither.
    ///
    /// # Errors
    /// Those of [`create`](Writer::create), and [`Error::IsInput`].
    pub fn create_from(
        path: &Path,
        header: Header,
        force: bool,
        inputs: &[&Path],
    ) -> Result<Writer, Error> {
        Writer::make(path, header, force, inputs, Purpose::Result)
    }

    /// The same for a file of a purpose.
    pub(super) fn make(
        path: &Path,
        header: Header,
        force: bool,
        inputs: &[&Path],
        purpose: Purpose,
    ) -> Result<Writer, Error> {
        let mut draft = Draft::create_from(path, force, inputs)?;
        let room = draft.take_room(ROOM)?;
        let store = Store::create(draft.temporary(), path, &header, purpose)?;
        let (sender, receiver) = sync_channel(0);
        let thread = std::thread::Builder::new()
            .name("result file".to_owned())
            .spawn(move || write(store, &receiver, &room))
            .map_err(|source| {
                let path = path.to_owned();
                Error::System { attempt: "start the thread that writes", path, source }
            })?;
        Ok(Writer {
            sender: Some(sender),
            thread: Some(thread),
            kept: false,
            samples: Block::new(Dimension::Time),
            events: Block::new(Dimension::Event),
            contacts: Block::new(Dimension::Contact),
            peaks: Block::new(Dimension::Peak),
            revolutions: Block::new(Dimension::Revolution),
            block_rows: header.block_rows(),
            rows: [0; Dimension::ALL.len()],
            order: Vec::new(),
            widths: Widths {
                bodies: header.bodies.len(),
                joints: header.joints.len(),
                clearances: header.clearances.len(),
                drives: header.drives.len(),
                points: header.points.len(),
                memories: header.memories.len(),
            },
            draft: Some(draft),
            path: path.to_owned(),
        })
    }

    /// Writes what is left and the ending, and publishes the file: a complete one under the name
    /// asked for, a failed one there only if nothing is there, else as `NAME.failed.h5` beside
    /// it. Returns the path of the published file. After an error of writing that is one with the
    /// blocks before it, as far as the disk had room for an ending.
    ///
    /// # Errors
    /// What the writing thread met, [`Error::Incomplete`] if that was in the last blocks and the
    /// others are kept, or [`Error::Taken`], or what the operating system says.
    pub fn finish(mut self, ending: Ending) -> Result<PathBuf, Error> {
        if !self.kept {
            match self.finish_whole(ending) {
                Err(error) if self.kept => {
                    let kept = self.publish_kept()?;
                    let path = self.path.clone();
                    return Err(Error::Incomplete { path, kept, source: Box::new(error) });
                }
                finished => return finished,
            }
        }
        self.publish_kept()
    }

    /// The same for a file that is of no use but whole: after an error there is none.
    pub(super) fn finish_or_drop(mut self, ending: Ending) -> Result<PathBuf, Error> {
        self.finish_whole(ending)
    }

    fn publish_kept(&mut self) -> Result<PathBuf, Error> {
        match self.draft.take() {
            Some(draft) => draft.publish_failed(),
            None => Err(Error::Failed { path: self.path.clone() }),
        }
    }

    fn finish_whole(&mut self, ending: Ending) -> Result<PathBuf, Error> {
        for block in [
            std::mem::replace(&mut self.samples, Block::new(Dimension::Time)),
            std::mem::replace(&mut self.events, Block::new(Dimension::Event)),
            std::mem::replace(&mut self.contacts, Block::new(Dimension::Contact)),
            std::mem::replace(&mut self.peaks, Block::new(Dimension::Peak)),
            std::mem::replace(&mut self.revolutions, Block::new(Dimension::Revolution)),
        ] {
            self.send(Message::Block(block))?;
        }
        let complete = matches!(ending.outcome, Outcome::Complete | Outcome::Running);
        self.send(Message::Finish(ending))?;
        self.join()?;
        let Some(draft) = self.draft.take() else {
            return Err(Error::Failed { path: self.path.clone() });
        };
        if complete { draft.publish() } else { draft.publish_failed() }
    }

    /// Gives the thread a message; its error if it has ended.
    fn send(&mut self, message: Message) -> Result<(), Error> {
        match &self.sender {
            Some(sender) if sender.send(message).is_ok() => Ok(()),
            _ => Err(self.failure()),
        }
    }

    /// Waits for the thread to end.
    fn join(&mut self) -> Result<(), Error> {
        self.sender = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(Ok(()))) => Ok(()),
            Some(Ok(Err(Stopped { error, kept }))) => {
                self.kept = kept;
                Err(error)
            }
            Some(Err(panic)) => std::panic::resume_unwind(panic),
            None => Err(Error::Failed { path: self.path.clone() }),
        }
    }

    /// Why the thread ended early.
    fn failure(&mut self) -> Error {
        match self.join() {
            Err(error) => error,
            Ok(()) => Error::Failed { path: self.path.clone() },
        }
    }

    /// The thread's error, if it has ended.
    fn check(&mut self) -> Result<(), Error> {
        match &self.thread {
            Some(thread) if !thread.is_finished() => Ok(()),
            _ => Err(self.failure()),
        }
    }

    /// Counts rows of a block and sends the block if it is full.
    fn count(&mut self, dimension: Dimension, rows: usize) -> Result<(), Error> {
        self.check()?;
        self.rows[dimension as usize] += rows;
        let full_at = self.block_rows;
        let block = self.block(dimension);
        block.rows += rows;
        if block.rows < full_at {
            return Ok(());
        }
        let full = std::mem::replace(block, Block::new(dimension));
        self.order.push(dimension);
        self.send(Message::Block(full))
    }

    /// The block that gathers the rows of a dimension that grows.
    fn block(&mut self, dimension: Dimension) -> &mut Block {
        match dimension {
            Dimension::Event => &mut self.events,
            Dimension::Contact => &mut self.contacts,
            Dimension::Peak => &mut self.peaks,
            Dimension::Revolution => &mut self.revolutions,
            _ => &mut self.samples,
        }
    }

    /// Rows so far, by dimension.
    pub(super) fn rows(&self) -> &[usize; Dimension::ALL.len()] {
        &self.rows
    }

    /// The dimensions of the full blocks so far, in the order in which they were written: it decides
    /// where in the file each stands.
    pub(super) fn order(&self) -> &[Dimension] {
        &self.order
    }

    /// Takes over rows of another file of the same case, no more than are left of the present block.
    pub(super) fn copy(
        &mut self,
        file: &ResultFile,
        dimension: Dimension,
        rows: Range<usize>,
    ) -> Result<(), Error> {
        let count = rows.len();
        let block = self.block(dimension);
        let is_there = |dataset: &Dataset| file.has(dataset);
        let columns = datasets_of(dimension).zip(&mut block.columns);
        for (dataset, column) in columns.filter(|(dataset, _)| is_there(dataset)) {
            column.extend(file.table_rows(dataset, rows.clone())?.values);
        }
        self.count(dimension, count)
    }

    /// How many rows of a dimension make its block full.
    pub(super) fn room(&mut self, dimension: Dimension) -> usize {
        self.block_rows - self.block(dimension).rows
    }
}

impl Recorder for Writer {
    type Error = Error;

    fn sample(&mut self, observation: &Observation) -> Result<(), Error> {
        let widths = Widths {
            bodies: observation.bodies.len(),
            joints: observation.joints.len(),
            clearances: observation.clearances.len(),
            drives: observation.drive_torques.len(),
            points: observation.points.len(),
            memories: observation.memories.len(),
        };
        assert!(widths == self.widths, "an observation has the lists that the header names");
        for (dataset, column) in datasets_of(Dimension::Time).zip(&mut self.samples.columns) {
            match dataset.source {
                Source::Sample(place) => column.push((place.get)(observation)),
                Source::Body(place) => column.extend(observation.bodies.iter().map(place.get)),
                Source::Clearance(place) => {
                    column.extend(observation.clearances.iter().map(place.get))
                }
                Source::Joint(place) => column.extend(observation.joints.iter().map(place.get)),
                Source::Drive => column.extend(&observation.drive_torques),
                Source::Point(place) => column.extend(observation.points.iter().map(place.get)),
                Source::Memory => column.extend(&observation.memories),
                Source::Event(_)
                | Source::Contact(_)
                | Source::Peak(_)
                | Source::Revolution(_)
                | Source::Extreme(..) => {}
            }
        }
        self.count(Dimension::Time, 1)
    }

    fn event(&mut self, event: Event) -> Result<(), Error> {
        for (dataset, column) in datasets_of(Dimension::Event).zip(&mut self.events.columns) {
            if let Source::Event(place) = dataset.source {
                column.push((place.get)(&event));
            }
        }
        self.count(Dimension::Event, 1)
    }

    fn contact(&mut self, contact: Contact) -> Result<(), Error> {
        for (dataset, column) in datasets_of(Dimension::Contact).zip(&mut self.contacts.columns) {
            if let Source::Contact(place) = dataset.source {
                column.push((place.get)(&contact));
            }
        }
        self.count(Dimension::Contact, 1)
    }

    fn peak(&mut self, peak: Peak) -> Result<(), Error> {
        for (dataset, column) in datasets_of(Dimension::Peak).zip(&mut self.peaks.columns) {
            if let Source::Peak(place) = dataset.source {
                column.push((place.get)(&peak));
            }
        }
        self.count(Dimension::Peak, 1)
    }

    fn keeps_revolutions(&self) -> bool {
        true
    }

    fn revolution(&mut self, revolution: &Revolution) -> Result<(), Error> {
        let datasets = datasets_of(Dimension::Revolution);
        for (dataset, column) in datasets.zip(&mut self.revolutions.columns) {
            let part = |part| match part {
                Part::Value => |extremum: Extremum| extremum.value,
                Part::Time => |extremum: Extremum| extremum.time,
            };
            match dataset.source {
                Source::Revolution(place) => column.push((place.get)(revolution)),
                Source::Extreme(measure, Side::Largest, of) => {
                    column.extend(revolution.largest(measure).map(part(of)));
                }
                Source::Extreme(measure, Side::Smallest, of) => {
                    column.extend(revolution.smallest(measure).map(part(of)));
                }
                _ => {}
            }
        }
        self.count(Dimension::Revolution, 1)
    }
}

impl Drop for Writer {
    /// Waits for the thread, so that nothing is written once the temporary file is gone.
    fn drop(&mut self) {
        self.sender = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Room (bytes) that is kept for the ending of a file on a full disk: what HDF5 has in its caches.
const ROOM: usize = 1 << 20;

/// Why the thread ended early.
#[derive(Debug)]
struct Stopped {
    error: Error,
    /// Whether the file was closed with what there was before.
    kept: bool,
}

/// Writes blocks until the ending comes, or the writer is gone. A block that fails ends the file;
/// `room` is removed then.
fn write(mut store: Store, messages: &Receiver<Message>, room: &Path) -> Result<(), Stopped> {
    for message in messages {
        match message {
            Message::Block(block) => {
                let Err(error) = store.append(&block) else { continue };
                let _ = std::fs::remove_file(room);
                let kept = store.retreat(&Ending {
                    outcome: Outcome::Failed { reason: error.to_string() },
                    counts: Vec::new(),
                    rulings: Vec::new(),
                    finished_utc: utc(SystemTime::now()),
                    series: Vec::new(),
                    attributes: Vec::new(),
                });
                return Err(Stopped { error, kept: kept.is_ok() });
            }
            Message::Finish(ending) => {
                let closed = store.close(&ending);
                return closed.map_err(|error| Stopped { error, kept: false });
            }
        }
    }
    Ok(())
}
