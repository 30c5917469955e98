//! All runs of a study, on several threads, each as soon as one is free.

use super::pack::{Identity, Packs};
use super::runner::Runner;
use super::{Error, Study, tables};
use crate::halt;
use parquet::file::reader::FileReader;
use parquet::file::serialized_reader::SerializedFileReader;
use std::fs::{self, File};
use std::num::NonZeroUsize;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard};
use std::time::Duration;

/// How a study is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Threads.
    pub jobs: NonZeroUsize,
    /// The part of the runs that is made; no tables are written of a part.
    pub shard: Option<Shard>,
    /// Whether tables are written as CSV, too.
    pub csv: bool,
    /// Whether the tables of another study are replaced.
    pub force: bool,
}

/// A part of the runs of a study: number `number` of `count`, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Which part.
    pub number: u64,
    /// Of how many.
    pub count: u64,
}

impl Shard {
    /// Whether a run is in this part: by its identity, so that it does not matter which other runs
    /// there are.
    fn has(self, identity: &Identity) -> bool {
        let first = identity.first_chunk().map_or(0, |bytes| u64::from_be_bytes(*bytes));
        first % self.count == self.number - 1
    }
}

/// How far a study is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Told {
    /// Runs that are done, those of earlier processes and of other shards left aside among them.
    pub runs: u64,
    /// Of those, how many this process made.
    pub made: u64,
    /// Revolutions that this process has simulated.
    pub revolutions: u64,
}

/// What has been done.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Done {
    /// Runs that this process made.
    pub made: u64,
    /// Runs that failed, by this process or, where tables were written, in all of the study.
    pub failed: u64,
    /// Revolutions that this process has simulated.
    pub revolutions: u64,
    /// The tables.
    pub tables: Vec<PathBuf>,
}

/// How often progress is told.
const TELL_EVERY: Duration = Duration::from_millis(20);

/// Makes what is missing of a study's runs and, unless it is a shard, its tables.
///
/// # Errors
/// See [`Error`]. What was done until then is kept.
pub fn sweep(
    study: &Study,
    folder: &Path,
    options: &Options,
    tell: &(dyn Fn(Told) + Sync),
) -> Result<Done, Error> {
    let runner = Runner::new(study, folder)?;
    fs::create_dir_all(folder)
        .map_err(|source| Error::Folder { path: folder.to_owned(), source })?;
    if options.shard.is_none() && !options.force {
        is_of(study, folder)?;
    }
    // packs of shards are likely to be brought together from several machines
    let part = |shard: Shard| format!("shard-{}-of-{}-", shard.number, shard.count);
    let prefix = options.shard.map_or_else(String::new, part);
    let packs = Packs::open(folder, &runner.kind(), prefix)?;
    let (identities, packs, done) = make(&runner, study.runs, packs, Work::Make, options, tell)?;
    if options.shard.is_some() {
        return Ok(done);
    }
    let written = tables::write(study, &runner, &packs, &identities, folder, options.csv)?;
    let (tables, failed) = written;
    Ok(Done { tables, failed, ..done })
}

/// What is done with a run that is missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Work {
    /// It is made.
    Make,
    /// It is counted.
    Look,
}

/// Writes the tables of a study whose runs are all made, by shards for example.
///
/// # Errors
/// See [`Error`].
pub fn gather(study: &Study, folder: &Path, options: &Options) -> Result<Done, Error> {
    let runner = Runner::new(study, folder)?;
    if !options.force {
        is_of(study, folder)?;
    }
    let packs = Packs::open(folder, &runner.kind(), String::new())?;
    let (identities, packs, missing) =
        make(&runner, study.runs, packs, Work::Look, options, &|_| ())?;
    let missing = missing.made;
    if missing > 0 {
        return Err(Error::Missing { path: folder.to_owned(), missing, runs: study.runs });
    }
    let written = tables::write(study, &runner, &packs, &identities, folder, options.csv)?;
    let (tables, failed) = written;
    Ok(Done { tables, failed, ..Done::default() })
}

/// Whether the tables of a folder, if there are some, are of this study.
fn is_of(study: &Study, folder: &Path) -> Result<(), Error> {
    let path = folder.join("runs.parquet");
    let Ok(file) = File::open(&path) else { return Ok(()) };
    let other = || Error::OtherStudy { path: folder.to_owned() };
    let reader = SerializedFileReader::new(file).map_err(|_| other())?;
    let metadata = reader.metadata().file_metadata().key_value_metadata().cloned();
    let metadata = metadata.unwrap_or_default();
    let same = |(key, value): &(String, String)| {
        metadata.iter().any(|known| known.key == *key && known.value.as_ref() == Some(value))
    };
    if tables::identity_texts(study).iter().all(same) { Ok(()) } else { Err(other()) }
}

/// Identities of runs in their order, the packs, and what was done.
type Made = (Vec<Identity>, Packs, Done);

/// Makes what is missing of the runs.
fn make(
    runner: &Runner<'_>,
    runs: u64,
    packs: Packs,
    work: Work,
    options: &Options,
    tell: &(dyn Fn(Told) + Sync),
) -> Result<Made, Error> {
    let shared = Shared {
        runner,
        runs,
        work,
        shard: options.shard,
        packs: Mutex::new(packs),
        next: AtomicU64::new(0),
        done: AtomicU64::new(0),
        made: AtomicU64::new(0),
        failed: AtomicU64::new(0),
        stop: AtomicBool::new(false),
    };
    let mut identities: Vec<(u64, Identity)> = Vec::with_capacity(runs as usize);
    let mut error = None;
    std::thread::scope(|scope| {
        let workers: Vec<_> =
            (0..options.jobs.get()).map(|_| scope.spawn(|| shared.work())).collect();
        while workers.iter().any(|worker| !worker.is_finished()) {
            tell(shared.told());
            std::thread::park_timeout(TELL_EVERY);
        }
        for worker in workers {
            match worker.join().unwrap_or_else(|panic| resume_unwind(panic)) {
                Ok(its) => identities.extend(its),
                Err(failed) => error = error.take().or(Some(failed)),
            }
        }
    });
    tell(shared.told());
    let done = Done {
        made: shared.made.load(Ordering::Relaxed),
        failed: shared.failed.load(Ordering::Relaxed),
        revolutions: runner.revolutions.load(Ordering::Relaxed),
        tables: Vec::new(),
    };
    let mut packs = shared.packs.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    let synced = packs.sync();
    match error {
        Some(error) => Err(error),
        None if halt::is_asked() => Err(Error::Interrupted),
        None => synced.map(|()| {
            identities.sort_unstable_by_key(|(run, _)| *run);
            let in_order = identities.into_iter().map(|(_, identity)| identity);
            (in_order.collect(), packs, done)
        }),
    }
}

/// What the threads share.
struct Shared<'a> {
    runner: &'a Runner<'a>,
    runs: u64,
    work: Work,
    shard: Option<Shard>,
    packs: Mutex<Packs>,
    /// The run that is next.
    next: AtomicU64,
    done: AtomicU64,
    made: AtomicU64,
    failed: AtomicU64,
    /// Whether a thread has failed.
    stop: AtomicBool,
}

impl Shared<'_> {
    fn packs(&self) -> MutexGuard<'_, Packs> {
        self.packs.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    fn told(&self) -> Told {
        Told {
            runs: self.done.load(Ordering::Relaxed),
            made: self.made.load(Ordering::Relaxed),
            revolutions: self.runner.revolutions.load(Ordering::Relaxed),
        }
    }

    /// Makes runs as long as there are some; gives their identities.
    fn work(&self) -> Result<Vec<(u64, Identity)>, Error> {
        let mut identities = Vec::new();
        loop {
            let run = self.next.fetch_add(1, Ordering::Relaxed);
            if run >= self.runs || halt::is_asked() || self.stop.load(Ordering::Relaxed) {
                return Ok(identities);
            }
            let (identity, text) = self.runner.identify(run);
            identities.push((run, identity));
            let ours = self.shard.is_none_or(|shard| shard.has(&identity));
            let missing = ours && !self.packs().has(&identity);
            if missing && self.work == Work::Look {
                self.made.fetch_add(1, Ordering::Relaxed);
            } else if missing {
                let kept = self.runner.run(identity, text).and_then(|record| match record {
                    None => Ok(()),
                    Some(record) => {
                        self.made.fetch_add(1, Ordering::Relaxed);
                        let failed = u64::from(record.outcome.is_err());
                        self.failed.fetch_add(failed, Ordering::Relaxed);
                        self.packs().add(&record)
                    }
                });
                if let Err(error) = kept {
                    self.stop.store(true, Ordering::Relaxed);
                    return Err(error);
                }
            }
            self.done.fetch_add(1, Ordering::Relaxed);
        }
    }
}
