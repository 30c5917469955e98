//! Packs: what runs came to, on the disk as soon as it is known.
//!
//! A pack is a line that says what is in it, and behind it a record for each run: its length, a
//! checksum, what was kept. A process writes a pack of its own, at the end only, and each record by
//! one write; so whatever is killed leaves whole records, and at most one that is torn, which counts
//! for nothing. Several processes may read and write the packs of a folder at once: the same run gives
//! the same record, and the first that is found counts.

use super::Error;
use flate2::Crc;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Write};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// SHA-256 of a resolved case.
pub type Identity = [u8; 32];

/// What a run came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Record {
    /// Of which case.
    pub identity: Identity,
    /// Its rows, or why it failed.
    pub outcome: Result<Rows, String>,
}

/// The rows of a run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Rows {
    /// Its row.
    pub run: Vec<f64>,
    /// Rows of its revolutions, one behind the other.
    pub revolutions: Vec<f64>,
    /// Rows of its section points, likewise.
    pub sections: Vec<f64>,
}

/// Where a record is.
#[derive(Debug, Clone, Copy)]
struct Place {
    pack: u32,
    length: u32,
    offset: u64,
}

/// The folder of the packs in that of a study.
const FOLDER: &str = "packs";
/// Bytes before a record: its length and its checksum.
const HEAD: usize = 8;
/// A record that says it is longer is none (bytes).
const LONGEST: u32 = 1 << 30;
/// How long records may be in the system's memory alone.
const SYNC_EVERY: Duration = Duration::from_secs(2);

/// The packs of a study's folder.
#[derive(Debug)]
pub(super) struct Packs {
    folder: PathBuf,
    /// What the name of an own pack begins with.
    prefix: String,
    head: String,
    packs: Vec<File>,
    places: HashMap<Identity, Place>,
    /// The pack that is being written, once it has a record.
    own: Option<Own>,
}

#[derive(Debug)]
struct Own {
    path: PathBuf,
    file: File,
    number: u32,
    length: u64,
    synced: Instant,
}

impl Packs {
    /// The packs in a study's folder whose records are of this kind: `kind` names the program and all
    /// that is kept, in one line. The name of an own one begins with `prefix`.
    pub fn open(study: &Path, kind: &str, prefix: String) -> Result<Self, Error> {
        let folder = study.join(FOLDER);
        fs::create_dir_all(&folder)
            .map_err(|source| Error::Folder { path: folder.clone(), source })?;
        let head = format!("freeplay pack {kind}\n");
        let mut packs =
            Packs { folder, prefix, head, packs: Vec::new(), places: HashMap::new(), own: None };
        packs.read()?;
        Ok(packs)
    }

    /// Whether it is known what a case came to.
    pub fn has(&self, identity: &Identity) -> bool {
        self.places.contains_key(identity)
    }

    /// What a case came to, if that is known.
    pub fn get(&self, identity: &Identity) -> Result<Option<Record>, Error> {
        let Some(place) = self.places.get(identity) else { return Ok(None) };
        let mut bytes = vec![0; place.length as usize];
        let read = self.packs[place.pack as usize].read_exact_at(&mut bytes, place.offset);
        read.map_err(|source| Error::Pack { path: self.folder.clone(), source })?;
        let record = postcard::from_bytes(&bytes).map_err(|error| Error::Pack {
            path: self.folder.clone(),
            source: io::Error::new(ErrorKind::InvalidData, error.to_string()),
        })?;
        Ok(Some(record))
    }

    /// Keeps what a run came to. What does not fit on the disk leaves nothing.
    pub fn add(&mut self, record: &Record) -> Result<(), Error> {
        if self.has(&record.identity) {
            return Ok(());
        }
        if self.own.is_none() {
            self.own = Some(self.begin()?);
        }
        let Some(own) = &mut self.own else { return Ok(()) };
        let failed = |source| Error::Pack { path: own.path.clone(), source };
        let invalid =
            |error: postcard::Error| io::Error::new(ErrorKind::InvalidData, error.to_string());
        let body = postcard::to_allocvec(record).map_err(|error| failed(invalid(error)))?;
        let mut bytes = Vec::with_capacity(HEAD + body.len());
        bytes.extend((body.len() as u32).to_le_bytes());
        bytes.extend(checksum(&body).to_le_bytes());
        bytes.extend(&body);
        if let Err(source) = own.file.write_all(&bytes) {
            let _ = own.file.set_len(own.length);
            return Err(failed(source));
        }
        let offset = own.length + HEAD as u64;
        own.length += bytes.len() as u64;
        if own.synced.elapsed() > SYNC_EVERY {
            own.file.sync_data().map_err(failed)?;
            own.synced = Instant::now();
        }
        let place = Place { pack: own.number, length: body.len() as u32, offset };
        self.places.insert(record.identity, place);
        Ok(())
    }

    /// Has all records on the disk.
    pub fn sync(&mut self) -> Result<(), Error> {
        let Some(own) = &self.own else { return Ok(()) };
        own.file.sync_all().map_err(|source| Error::Pack { path: own.path.clone(), source })
    }

    /// Begins a pack under a name that nobody has.
    fn begin(&mut self) -> Result<Own, Error> {
        let mut number = self.packs.len() + 1;
        loop {
            let path = self.folder.join(format!("{}{number:06}.pack", self.prefix));
            let failed = |source| Error::Pack { path: path.clone(), source };
            let made = OpenOptions::new().read(true).append(true).create_new(true).open(&path);
            let mut file = match made {
                Ok(file) => file,
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                    number += 1;
                    continue;
                }
                Err(source) => return Err(failed(source)),
            };
            if let Err(source) = file.write_all(self.head.as_bytes()) {
                let _ = fs::remove_file(&path);
                return Err(failed(source));
            }
            let reader = file.try_clone().map_err(failed)?;
            self.packs.push(reader);
            let number = (self.packs.len() - 1) as u32;
            let length = self.head.len() as u64;
            return Ok(Own { path, file, number, length, synced: Instant::now() });
        }
    }

    /// Finds the records of all packs.
    fn read(&mut self) -> Result<(), Error> {
        let failed = |source| Error::Pack { path: self.folder.clone(), source };
        let entries = fs::read_dir(&self.folder).map_err(failed)?;
        let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        paths.retain(|path| path.extension().is_some_and(|end| end == "pack"));
        paths.sort();
        for path in paths {
            let failed = |source| Error::Pack { path: path.clone(), source };
            let file = File::open(&path).map_err(failed)?;
            let mut reader = BufReader::with_capacity(1 << 16, file);
            let mut head = String::new();
            match reader.by_ref().take(4096).read_line(&mut head) {
                Ok(_) if head == self.head => {}
                // of another program or another study; or torn before it had anything
                Ok(_) => continue,
                Err(error) if error.kind() == ErrorKind::InvalidData => continue,
                Err(source) => return Err(failed(source)),
            }
            let pack = self.packs.len() as u32;
            let mut offset = head.len() as u64;
            while let Some((identity, length)) = next(&mut reader).map_err(failed)? {
                let place = Place { pack, length, offset: offset + HEAD as u64 };
                self.places.entry(identity).or_insert(place);
                offset += HEAD as u64 + u64::from(length);
            }
            self.packs.push(reader.into_inner());
        }
        Ok(())
    }
}

/// The next whole record of a pack: its identity and the length of its body.
fn next(reader: &mut impl Read) -> io::Result<Option<(Identity, u32)>> {
    let mut head = [0; HEAD];
    if !filled(reader, &mut head)? {
        return Ok(None);
    }
    let [length, sum] = [&head[..4], &head[4..]]
        .map(|bytes| bytes.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte)));
    if !(32..=LONGEST).contains(&length) {
        return Ok(None);
    }
    let mut body = Vec::new();
    reader.take(u64::from(length)).read_to_end(&mut body)?;
    if body.len() != length as usize || checksum(&body) != sum {
        return Ok(None);
    }
    let identity = body.first_chunk().copied();
    Ok(identity.map(|identity| (identity, length)))
}

/// Fills a buffer; false where the file ends before.
fn filled(reader: &mut impl Read, buffer: &mut [u8]) -> io::Result<bool> {
    match reader.read_exact(buffer) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(error),
    }
}

fn checksum(bytes: &[u8]) -> u32 {
    let mut crc = Crc::new();
    crc.update(bytes);
    crc.sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(number: u8) -> Record {
        let rows = Rows {
            run: vec![f64::from(number), f64::NAN],
            revolutions: vec![0.5; usize::from(number)],
            sections: Vec::new(),
        };
        let outcome = if number == 3 { Err("it failed".to_owned()) } else { Ok(rows) };
        Record { identity: [number; 32], outcome }
    }

    fn same(a: &Record, b: &Record) -> bool {
        // NaN is no number like another
        postcard::to_allocvec(a).unwrap() == postcard::to_allocvec(b).unwrap()
    }

    #[test]
    fn records_are_found_again_wherever_a_pack_is_torn() {
        let folder = tempfile::tempdir().unwrap();
        let mut packs = Packs::open(folder.path(), "kind", String::new()).unwrap();
        (1..=5).for_each(|number| packs.add(&record(number)).unwrap());
        drop(packs);
        let path = folder.path().join("packs/000001.pack");
        let whole = fs::read(&path).unwrap();
        let mut before = 0;
        for length in 0..=whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            let packs = Packs::open(folder.path(), "kind", String::new()).unwrap();
            let found = (1..=5).filter(|number| packs.has(&[*number; 32])).count();
            assert!(found >= before, "{length} of {} bytes", whole.len());
            for number in 1..=found as u8 {
                let read = packs.get(&[number; 32]).unwrap().unwrap();
                assert!(same(&read, &record(number)));
            }
            before = found;
        }
        assert_eq!(before, 5);
    }

    #[test]
    fn packs_of_another_kind_tell_nothing() {
        let folder = tempfile::tempdir().unwrap();
        Packs::open(folder.path(), "one", String::new()).unwrap().add(&record(1)).unwrap();
        assert!(!Packs::open(folder.path(), "two", String::new()).unwrap().has(&[1; 32]));
        assert!(Packs::open(folder.path(), "one", String::new()).unwrap().has(&[1; 32]));
    }

    #[test]
    fn two_writers_do_not_get_in_each_others_way() {
        let folder = tempfile::tempdir().unwrap();
        let mut one = Packs::open(folder.path(), "kind", String::new()).unwrap();
        let mut two = Packs::open(folder.path(), "kind", String::new()).unwrap();
        for number in 1..=4 {
            one.add(&record(number)).unwrap();
            two.add(&record(number)).unwrap();
        }
        let both = Packs::open(folder.path(), "kind", String::new()).unwrap();
        assert!(
            (1..=4).all(|number| same(&both.get(&[number; 32]).unwrap().unwrap(), &record(number)))
        );
    }
}
