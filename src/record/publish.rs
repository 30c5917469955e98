//! Files that come to be whole: written under a temporary name beside the output, then published
//! under the name asked for.

use super::Error;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File, OpenOptions, Permissions, TryLockError};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, ErrorKind};
use std::os::unix::fs::{MetadataExt, OpenOptionsExt, PermissionsExt};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};
use std::time::{Duration, Instant};

/// The output asked for, and the temporary file beside it, which goes with this unless it is
/// published.
///
/// The temporary file is locked as long as this lives. So another program that is to write the same
/// output is refused, and the next that writes into the folder knows which temporary files nobody
/// will finish: those it removes.
#[derive(Debug)]
pub(crate) struct Draft {
    target: PathBuf,
    temporary: PathBuf,
    force: bool,
    /// Holds the lock, and is told of every error in writing back what was written.
    file: File,
    inputs: Vec<Identity>,
    /// A file that only takes room, if there is one.
    room: Option<PathBuf>,
}

/// A file as the system knows it, whatever its names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Identity {
    device: u64,
    number: u64,
}

impl Identity {
    /// The file that a path leads to, if there is one.
    fn of(path: &Path) -> Option<Self> {
        fs::metadata(path).ok().map(|found| Identity { device: found.dev(), number: found.ino() })
    }
}

/// Temporary files that are not published yet.
static UNPUBLISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unpublished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNPUBLISHED.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// Removes every temporary file of this process, for one that is about to end. Nothing is published
/// after that: who tries waits for the end.
pub(crate) fn abandon_drafts() {
    let mut unpublished = unpublished();
    for temporary in unpublished.drain(..) {
        let _ = fs::remove_file(temporary);
    }
    std::mem::forget(unpublished);
}

impl Draft {
    /// Makes an empty temporary file beside the output. With `force` the output may be there.
    ///
    /// # Errors
    /// See [`Draft::create_from`].
    pub fn create(path: &Path, force: bool) -> Result<Self, Error> {
        Draft::create_from(path, force, &[])
    }

    /// The same for an output that is made from `inputs`, none of which it may be, under whatever
    /// name and with `force` too.
    ///
    /// # Errors
    /// [`Error::IsInput`], [`Error::Exists`], [`Error::NoFolder`], [`Error::NotPlain`],
    /// [`Error::Busy`], or what the operating system says.
    pub fn create_from(path: &Path, force: bool, inputs: &[&Path]) -> Result<Self, Error> {
        let inputs: Vec<Identity> = inputs.iter().filter_map(|path| Identity::of(path)).collect();
        if Identity::of(path).is_some_and(|output| inputs.contains(&output)) {
            return Err(Error::IsInput { path: path.to_owned() });
        }
        let target = check_target(path, force)?;
        let folder = folder_of(&target);
        if !folder.is_dir() {
            return Err(Error::NoFolder { path: path.to_owned(), folder: folder.to_owned() });
        }
        let Some(name) = target.file_name() else {
            return Err(Error::NotPlain { path: path.to_owned() });
        };
        let _one_at_a_time = lock_folder(folder);
        if let Some(process) = sweep(folder, &temporary_stem(name)) {
            return Err(Error::Busy { path: path.to_owned(), process });
        }
        let mode = fs::metadata(&target).map_or(0o666, |old| old.mode() & 0o666 | 0o600);
        let mut number = 0;
        loop {
            let temporary = folder.join(temporary_name(name, number));
            let made = OpenOptions::new()
                .read(true)
                .write(true)
                .create_new(true)
                .mode(mode)
                .open(&temporary);
            match made {
                Ok(file) => {
                    // where there are no locks nobody removes what is not locked either
                    let _ = file.try_lock();
                    unpublished().push(temporary.clone());
                    let room = None;
                    return Ok(Draft { target, temporary, force, file, inputs, room });
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => number += 1,
                Err(source) => {
                    let path = path.to_owned();
                    return Err(Error::System { attempt: "create", path, source });
                }
            }
        }
    }

    /// Takes room for what has to be written if the disk is full: who removes the file that is given
    /// has it.
    pub fn take_room(&mut self, bytes: usize) -> Result<PathBuf, Error> {
        let mut name = self.temporary.clone().into_os_string();
        name.push("-room");
        let room = PathBuf::from(name);
        unpublished().push(room.clone());
        self.room = Some(room.clone());
        fs::write(&room, vec![0; bytes]).map_err(|source| self.error("write", source))?;
        Ok(room)
    }

    /// Where to write.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// Writes and publishes a file that is known as a whole.
    pub fn publish_bytes(self, bytes: &[u8]) -> Result<(), Error> {
        self.write_bytes(bytes)?;
        self.publish().map(drop)
    }

    /// Writes a file that is known as a whole.
    pub fn write_bytes(&self, bytes: &[u8]) -> Result<(), Error> {
        fs::write(&self.temporary, bytes).map_err(|source| self.error("write", source))
    }

    /// Publishes a complete file. Returns its path.
    pub fn publish(self) -> Result<PathBuf, Error> {
        self.sync()?;
        if self.force {
            self.replace()?;
        } else if !self.claim(&self.target)? {
            let kept = self.keep(&beside(&self.target, &std::process::id().to_string()))?;
            return Err(Error::Taken { path: self.target.clone(), kept });
        }
        self.sync_folder()?;
        Ok(self.target.clone())
    }

    /// Publishes two complete files that are of no use without each other: both or neither.
    /// Returns their paths.
    pub fn publish_both(first: Draft, second: Draft) -> Result<[PathBuf; 2], Error> {
        first.sync()?;
        second.sync()?;
        let old = first.set_aside()?;
        let published = first.put().and_then(|()| {
            second.put().map_err(|error| match first.take_back(old.as_deref()) {
                Ok(()) => error,
                // the old file stays under its other name, which the error tells
                Err(lost) => lost,
            })
        });
        if let (Some(old), false) = (old, matches!(published, Err(Error::NotPutBack { .. }))) {
            let _ = fs::remove_file(old);
        }
        published?;
        second.sync_folder()?;
        Ok([first.target.clone(), second.target.clone()])
    }

    /// Publishes what a failed run has: under the name asked for if nothing is there, else as
    /// `NAME.failed.h5` beside it. Returns its path.
    pub fn publish_failed(self) -> Result<PathBuf, Error> {
        self.sync()?;
        let published = if self.claim(&self.target)? {
            self.target.clone()
        } else {
            let failed = beside(&self.target, "failed");
            let is_input = Identity::of(&failed).is_some_and(|file| self.inputs.contains(&file));
            let word = format!("failed-{}", std::process::id());
            self.keep(&if is_input { beside(&self.target, &word) } else { failed })?
        };
        self.sync_folder()?;
        Ok(published)
    }

    /// Gives the temporary the name asked for; the old file's place only with `force`.
    fn put(&self) -> Result<(), Error> {
        match self.force {
            true => self.replace(),
            false if self.claim(&self.target)? => Ok(()),
            false => Err(Error::Exists { path: self.target.clone() }),
        }
    }

    /// Has what stood there before stand there again.
    fn take_back(&self, old: Option<&Path>) -> Result<(), Error> {
        let Some(old) = old else {
            let gone = fs::remove_file(&self.target);
            return gone.map_err(|source| self.error("take back", source));
        };
        fs::rename(old, &self.target).map_err(|source| Error::NotPutBack {
            path: self.target.clone(),
            kept: old.to_owned(),
            source,
        })
    }

    /// Puts the temporary in the place of an old file, whose permissions it takes over.
    fn replace(&self) -> Result<(), Error> {
        if let Ok(old) = fs::metadata(&self.target) {
            let permissions = Permissions::from_mode(old.mode() & 0o7777);
            let set = self.file.set_permissions(permissions);
            set.map_err(|source| self.error("give the permissions of the old file to", source))?;
        }
        self.rename(&self.target)
    }

    /// Another name for the file that is there, so that it can be put back.
    fn set_aside(&self) -> Result<Option<PathBuf>, Error> {
        if !self.force || !self.target.exists() {
            return Ok(None);
        }
        let old = beside(&self.target, &format!("old-{}", std::process::id()));
        fs::hard_link(&self.target, &old)
            .or_else(|_| fs::copy(&self.target, &old).map(drop))
            .map_err(|source| self.error("set aside", source))?;
        Ok(Some(old))
    }

    /// Renames the temporary to a name of our own making, whose old file was our own too.
    fn keep(&self, name: &Path) -> Result<PathBuf, Error> {
        self.rename(name)?;
        Ok(name.to_owned())
    }

    fn rename(&self, name: &Path) -> Result<(), Error> {
        fs::rename(&self.temporary, name).map_err(|source| self.error("publish", source))
    }

    /// Gives the temporary the name unless it is taken; says whether that was so. A hard link
    /// does this in one step; where there are none, an empty file holds the place.
    fn claim(&self, name: &Path) -> Result<bool, Error> {
        match fs::hard_link(&self.temporary, name) {
            Ok(()) => return Ok(true),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => return Ok(false),
            Err(_) => {}
        }
        match OpenOptions::new().write(true).create_new(true).open(name) {
            Ok(_) => self.rename(name).map(|()| true).inspect_err(|_| {
                let _ = fs::remove_file(name);
            }),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => Ok(false),
            Err(source) => Err(self.error("publish", source)),
        }
    }

    fn sync(&self) -> Result<(), Error> {
        self.file.sync_all().map_err(|source| self.error("write", source))
    }

    fn sync_folder(&self) -> Result<(), Error> {
        let synced = make_names_durable(folder_of(&self.target));
        synced.map_err(|source| self.error("make durable the name of", source))
    }

    fn error(&self, attempt: &'static str, source: io::Error) -> Error {
        Error::System { attempt, path: self.target.clone(), source }
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        let mut unpublished = unpublished();
        for path in self.room.iter().chain([&self.temporary]) {
            let _ = fs::remove_file(path);
            unpublished.retain(|temporary| temporary != path);
        }
    }
}

/// Makes the names in a folder durable; some file systems cannot, and then they are as durable as these
/// have it.
pub(super) fn make_names_durable(folder: &Path) -> io::Result<()> {
    let Ok(folder) = File::open(folder) else { return Ok(()) };
    match folder.sync_all() {
        // EBADF, EINVAL, EOPNOTSUPP: there is no such thing here
        Err(error) if matches!(error.raw_os_error(), Some(9 | 22 | 95)) => Ok(()),
        done => done,
    }
}

/// How long another process may take to make its temporary file.
const PATIENCE: Duration = Duration::from_secs(2);

/// Holds off others that would make a temporary file in the folder at the same moment; nothing
/// where the file system has no locks.
fn lock_folder(folder: &Path) -> Option<File> {
    let folder = File::open(folder).ok()?;
    let begun = Instant::now();
    loop {
        match folder.try_lock() {
            Ok(()) => return Some(folder),
            Err(TryLockError::WouldBlock) if begun.elapsed() < PATIENCE => {
                std::thread::sleep(Duration::from_millis(5));
            }
            Err(_) => return None,
        }
    }
}

/// Removes the temporary files in a folder that processes which are gone have left.
pub(super) fn remove_left_behind(folder: &Path) {
    let _one_at_a_time = lock_folder(folder);
    sweep(folder, OsStr::new(""));
}

/// Removes the temporary files in a folder whose processes are gone. Gives the process that is
/// writing one of this stem, if one is.
fn sweep(folder: &Path, stem: &OsStr) -> Option<u32> {
    let mut busy = None;
    for entry in fs::read_dir(folder).ok()?.flatten() {
        let name = entry.file_name();
        let Some((of, process)) = parse_temporary(&name) else { continue };
        if !entry.file_type().is_ok_and(|kind| kind.is_file()) {
            continue;
        }
        let path = entry.path();
        let Ok(file) = OpenOptions::new().read(true).write(true).open(&path) else { continue };
        match file.try_lock() {
            Err(TryLockError::WouldBlock) if of == stem => busy = Some(process),
            // who has no lock may still be there, on a file system without any
            Ok(()) if !Path::new("/proc").join(process.to_string()).exists() => {
                let _ = fs::remove_file(&path);
            }
            _ => {}
        }
    }
    busy
}

/// Says no to an output that is there and must stay. A symbolic link is followed, so that it is
/// its file which is replaced.
fn check_target(path: &Path, force: bool) -> Result<PathBuf, Error> {
    let Ok(found) = fs::symlink_metadata(path) else {
        return Ok(path.to_owned());
    };
    let target = if found.is_symlink() { fs::canonicalize(path).ok() } else { None };
    let target = target.unwrap_or_else(|| path.to_owned());
    let plain = fs::metadata(&target).map_or(found.is_symlink(), |found| found.is_file());
    match (plain, force) {
        (false, _) => Err(Error::NotPlain { path: path.to_owned() }),
        (true, false) => Err(Error::Exists { path: path.to_owned() }),
        (true, true) => Ok(target),
    }
}

/// The folder that a path is in.
pub(super) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent.as_os_str().is_empty() => Path::new("."),
        Some(parent) => parent,
        None => path,
    }
}

/// Bytes that a file's name may have on most file systems.
const LONGEST_NAME: usize = 255;
/// Bytes that are left free for what is put before and behind a name.
const ROOM: usize = 40;

/// As much of the begin of a name as leaves room for more.
fn shortened(name: &OsStr) -> OsString {
    if name.len() + ROOM <= LONGEST_NAME {
        return name.to_owned();
    }
    let mut kept = String::new();
    for c in name.to_string_lossy().chars() {
        if kept.len() + c.len_utf8() + ROOM > LONGEST_NAME {
            break;
        }
        kept.push(c);
    }
    kept.into()
}

/// What stands before the process in a temporary name.
const PARTIAL: &str = ".partial-";

/// `.NAME.partial-`; of a name that is too long for that its begin, and what tells it from others.
fn temporary_stem(name: &OsStr) -> OsString {
    let mut stem = OsString::from(".");
    let begin = shortened(name);
    stem.push(&begin);
    if begin != name {
        let mut hasher = DefaultHasher::new();
        name.hash(&mut hasher);
        stem.push(format!("~{:08x}", hasher.finish() as u32));
    }
    stem.push(PARTIAL);
    stem
}

/// `.NAME.partial-PROCESS`, with a number behind it if that is taken.
fn temporary_name(name: &OsStr, number: u32) -> OsString {
    let mut temporary = temporary_stem(name);
    temporary.push(std::process::id().to_string());
    if number > 0 {
        temporary.push(format!("-{number}"));
    }
    temporary
}

/// Stem and process of a temporary name, or of what stands beside it for a while; `None` for other names.
fn parse_temporary(name: &OsStr) -> Option<(OsString, u32)> {
    let name = name.to_str().filter(|name| name.starts_with('.'))?;
    let (of, rest) = name.rsplit_once(PARTIAL)?;
    let mut words = rest.split('-');
    let process = words.next()?.parse().ok()?;
    let ours = |word: &str| word == "room" || word.parse::<u32>().is_ok();
    words.all(ours).then(|| (format!("{of}{PARTIAL}").into(), process))
}

/// Endings that stay at the end of a name.
const ENDINGS: [&str; 9] = ["h5", "csv", "parquet", "ombvx", "ombvh5", "html", "svg", "png", "pdf"];

/// `NAME.word.h5` beside `NAME.h5`, and beside a name without an ending of ours.
fn beside(path: &Path, word: &str) -> PathBuf {
    let ending = path.extension().and_then(OsStr::to_str);
    let ending = ending.filter(|ending| ENDINGS.contains(ending));
    let stem = if ending.is_some() { path.file_stem() } else { path.file_name() };
    let mut name = stem.map(shortened).unwrap_or_default();
    name.push(format!(".{word}.{}", ending.unwrap_or("h5")));
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text_of(path: &Path) -> String {
        fs::read_to_string(path).unwrap()
    }

    fn files_in(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn nothing_is_left_of_a_draft_that_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let draft = Draft::create(&folder.path().join("a.h5"), false).unwrap();
        assert!(draft.temporary().exists());
        drop(draft);
        assert!(files_in(folder.path()).is_empty());
    }

    #[test]
    fn an_output_made_meanwhile_stays_and_the_new_file_is_kept_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.h5");
        let draft = Draft::create(&path, false).unwrap();
        fs::write(draft.temporary(), "ours").unwrap();
        fs::write(&path, "theirs").unwrap();
        let Err(Error::Taken { kept, .. }) = draft.publish() else {
            panic!("the name is taken");
        };
        assert_eq!((text_of(&path), text_of(&kept)), ("theirs".into(), "ours".into()));
        assert_eq!(files_in(folder.path()).len(), 2);
    }

    #[test]
    fn with_force_a_complete_file_replaces_the_old_one_and_a_failed_one_does_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.h5");
        fs::write(&path, "old").unwrap();
        let draft = Draft::create(&path, true).unwrap();
        fs::write(draft.temporary(), "failed").unwrap();
        let failed = draft.publish_failed().unwrap();
        assert_eq!(failed, folder.path().join("a.failed.h5"));
        assert_eq!((text_of(&path), text_of(&failed)), ("old".into(), "failed".into()));
        let draft = Draft::create(&path, true).unwrap();
        fs::write(draft.temporary(), "complete").unwrap();
        assert_eq!(draft.publish().unwrap(), path);
        assert_eq!(text_of(&path), "complete");
        assert_eq!(files_in(folder.path()), ["a.failed.h5", "a.h5"]);
    }

    #[test]
    fn a_failed_file_takes_the_name_where_nothing_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.h5");
        let draft = Draft::create(&path, false).unwrap();
        assert_eq!(draft.publish_failed().unwrap(), path);
        assert_eq!(files_in(folder.path()), ["a.h5"]);
    }

    #[test]
    fn folders_devices_and_missing_folders_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        for force in [false, true] {
            let refused = Draft::create(folder.path(), force).unwrap_err();
            assert!(matches!(refused, Error::NotPlain { .. }), "{refused}");
            let refused = Draft::create(Path::new("/dev/null"), force).unwrap_err();
            assert!(matches!(refused, Error::NotPlain { .. }), "{refused}");
            let refused = Draft::create(&folder.path().join("b/a.h5"), force).unwrap_err();
            assert!(matches!(refused, Error::NoFolder { .. }), "{refused}");
        }
    }

    #[test]
    fn a_symbolic_link_stays_and_its_file_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("a.h5"), folder.path().join("link.h5"));
        fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        let refused = Draft::create(&link, false).unwrap_err();
        assert!(matches!(refused, Error::Exists { .. }), "{refused}");
        let draft = Draft::create(&link, true).unwrap();
        fs::write(draft.temporary(), "new").unwrap();
        draft.publish().unwrap();
        assert_eq!(text_of(&file), "new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }

    #[test]
    fn a_name_may_be_as_long_as_the_file_system_lets_it() {
        let folder = tempfile::tempdir().unwrap();
        for length in [240, 252] {
            let path = folder.path().join(format!("{}.h5", "ä".repeat(length / 2)));
            for (force, text) in [(false, "one"), (true, "two")] {
                let draft = Draft::create(&path, force).unwrap();
                fs::write(draft.temporary(), text).unwrap();
                draft.publish().unwrap();
                assert_eq!(text_of(&path), text);
            }
            let failed = Draft::create(&path, true).unwrap().publish_failed().unwrap();
            assert!(failed.to_str().unwrap().ends_with(".failed.h5"), "{failed:?}");
        }
    }

    #[test]
    fn an_output_that_is_an_input_is_refused_whatever_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let (input, link, second) = (at("a.toml"), at("link"), at("second"));
        fs::write(&input, "input").unwrap();
        std::os::unix::fs::symlink(&input, &link).unwrap();
        fs::hard_link(&input, &second).unwrap();
        for (output, force) in [(&input, true), (&input, false), (&link, true), (&second, true)] {
            let refused = Draft::create_from(output, force, &[&input]).unwrap_err();
            assert!(matches!(refused, Error::IsInput { .. }), "{refused}");
        }
        assert_eq!(text_of(&input), "input");
    }

    #[test]
    fn what_failed_does_not_go_where_an_input_is() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("a.h5"), "old").unwrap();
        fs::write(at("a.failed.h5"), "input").unwrap();
        let draft = Draft::create_from(&at("a.h5"), true, &[&at("a.failed.h5")]).unwrap();
        let kept = draft.publish_failed().unwrap();
        assert_eq!(text_of(&at("a.failed.h5")), "input");
        assert!(kept.to_str().unwrap().contains("a.failed-"), "{kept:?}");
    }

    #[test]
    fn a_second_writer_of_an_output_is_refused_and_others_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let long = "a".repeat(230);
        for name in ["a.h5", &*long] {
            let path = folder.path().join(name);
            let first = Draft::create(&path, true).unwrap();
            let refused = Draft::create(&path, true).unwrap_err();
            assert!(matches!(refused, Error::Busy { .. }), "{refused}");
            Draft::create(&folder.path().join(format!("{name}b")), false).unwrap();
            drop(first);
            Draft::create(&path, true).unwrap();
        }
        assert!(files_in(folder.path()).is_empty());
    }

    #[test]
    fn what_processes_that_are_gone_have_left_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let gone = u32::MAX; // beyond the largest that there can be
        let own = std::process::id();
        let litter = [
            format!(".x.h5.partial-{gone}"),
            format!(".y.csv.partial-{gone}-2"),
            format!(".x.h5.partial-{gone}-room"),
        ];
        let others = [
            format!(".x.h5.partial-{own}"),
            ".x.h5.partial-".into(),
            ".x.h5.partial-12-new".into(),
            format!("x.h5.partial-{gone}"),
            "z.failed.h5".into(),
        ];
        for name in litter.iter().chain(&others) {
            fs::write(folder.path().join(name), "").unwrap();
        }
        fs::create_dir(folder.path().join(format!(".d.partial-{gone}"))).unwrap();
        let held = format!(".held.h5.partial-{gone}-1");
        fs::write(folder.path().join(&held), "").unwrap();
        let holder = File::open(folder.path().join(&held)).unwrap();
        holder.lock().unwrap();
        Draft::create(&folder.path().join("a.h5"), false).unwrap();
        let mut expected = Vec::from(others);
        expected.extend([held, format!(".d.partial-{gone}")]);
        expected.sort();
        assert_eq!(files_in(folder.path()), expected);
    }

    #[test]
    fn the_permissions_of_a_file_that_is_replaced_stay() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.h5");
        for mode in [0o640, 0o600, 0o444] {
            let _ = fs::remove_file(&path);
            fs::write(&path, "old").unwrap();
            fs::set_permissions(&path, Permissions::from_mode(mode)).unwrap();
            let draft = Draft::create(&path, true).unwrap();
            let seen = fs::metadata(draft.temporary()).unwrap().mode() & 0o777;
            assert_eq!(seen & !(mode | 0o600), 0, "{seen:o}");
            draft.publish_bytes(b"new").unwrap();
            assert_eq!(fs::metadata(&path).unwrap().mode() & 0o7777, mode);
            assert_eq!(text_of(&path), "new");
        }
    }

    #[test]
    fn two_files_are_published_together_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let (one, two) = (folder.path().join("a.ombvh5"), folder.path().join("a.ombvx"));
        let drafts = |force| {
            let drafts = [&one, &two].map(|path| Draft::create(path, force).unwrap());
            drafts.iter().for_each(|draft| draft.write_bytes(b"new").unwrap());
            drafts
        };
        // with nothing there, the second name is taken meanwhile
        let [first, second] = drafts(false);
        fs::write(&two, "theirs").unwrap();
        assert!(Draft::publish_both(first, second).is_err());
        assert!(!one.exists() && text_of(&two) == "theirs");
        // with old files there, a folder takes the place of the second
        fs::write(&one, "old").unwrap();
        let [first, second] = drafts(true);
        fs::remove_file(&two).unwrap();
        fs::create_dir(&two).unwrap();
        assert!(Draft::publish_both(first, second).is_err());
        assert_eq!(text_of(&one), "old");
        fs::remove_dir(&two).unwrap();
        fs::write(&two, "old").unwrap();
        let [first, second] = drafts(true);
        Draft::publish_both(first, second).unwrap();
        assert_eq!((text_of(&one), text_of(&two)), ("new".into(), "new".into()));
        assert_eq!(files_in(folder.path()), ["a.ombvh5", "a.ombvx"]);
    }

    #[test]
    fn a_name_beside_another_keeps_its_ending() {
        assert_eq!(beside(Path::new("x/a.csv"), "17"), Path::new("x/a.17.csv"));
        assert_eq!(beside(Path::new("x/a.h5"), "failed"), Path::new("x/a.failed.h5"));
        assert_eq!(beside(Path::new("a.b"), "failed"), Path::new("a.b.failed.h5"));
    }
}
