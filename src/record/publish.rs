//! Files that come to be whole: written under a temporary name beside the output, then published
//! under the name asked for.

use super::Error;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// The output asked for, and the temporary file beside it, which goes with this unless it is
/// published.
#[derive(Debug)]
pub(crate) struct Draft {
    target: PathBuf,
    temporary: PathBuf,
    force: bool,
}

impl Draft {
    /// Makes an empty temporary file beside the output. With `force` the output may be there.
    pub fn create(path: &Path, force: bool) -> Result<Self, Error> {
        let target = check_target(path, force)?;
        let folder = folder_of(&target);
        if !folder.is_dir() {
            return Err(Error::NoFolder { path: path.to_owned(), folder: folder.to_owned() });
        }
        let Some(name) = target.file_name() else {
            return Err(Error::NotPlain { path: path.to_owned() });
        };
        let mut number = 0;
        loop {
            let temporary = folder.join(temporary_name(name, number));
            match OpenOptions::new().write(true).create_new(true).open(&temporary) {
                Ok(_) => return Ok(Draft { target, temporary, force }),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => number += 1,
                Err(source) => {
                    let path = path.to_owned();
                    return Err(Error::System { attempt: "create", path, source });
                }
            }
        }
    }

    /// Where to write.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// Writes and publishes a file that is known as a whole.
    pub fn publish_bytes(self, bytes: &[u8]) -> Result<(), Error> {
        fs::write(&self.temporary, bytes).map_err(|source| self.error("write", source))?;
        self.publish().map(drop)
    }

    /// Publishes a complete file. Returns its path.
    pub fn publish(self) -> Result<PathBuf, Error> {
        self.sync()?;
        if self.force {
            self.rename(&self.target)?;
        } else if !self.claim(&self.target)? {
            let kept = self.keep(&beside(&self.target, &std::process::id().to_string()))?;
            return Err(Error::Taken { path: self.target.clone(), kept });
        }
        self.sync_folder();
        Ok(self.target.clone())
    }

    /// Publishes what a failed run has: under the name asked for if nothing is there, else as
    /// `NAME.failed.h5` beside it. Returns its path.
    pub fn publish_failed(self) -> Result<PathBuf, Error> {
        self.sync()?;
        let published = if self.claim(&self.target)? {
            self.target.clone()
        } else {
            self.keep(&beside(&self.target, "failed"))?
        };
        self.sync_folder();
        Ok(published)
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
            Ok(_) => self.rename(name).map(|()| true),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => Ok(false),
            Err(source) => Err(self.error("publish", source)),
        }
    }

    fn sync(&self) -> Result<(), Error> {
        File::open(&self.temporary)
            .and_then(|file| file.sync_all())
            .map_err(|source| self.error("write", source))
    }

    /// Makes the new name durable; some file systems cannot, and then it is as durable as they are.
    fn sync_folder(&self) {
        if let Ok(folder) = File::open(folder_of(&self.target)) {
            let _ = folder.sync_all();
        }
    }

    fn error(&self, attempt: &'static str, source: io::Error) -> Error {
        Error::System { attempt, path: self.target.clone(), source }
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.temporary);
    }
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
fn folder_of(path: &Path) -> &Path {
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

/// `.NAME.partial-PROCESS`, with a number behind it if that is taken.
fn temporary_name(name: &OsStr, number: u32) -> OsString {
    let mut temporary = OsString::from(".");
    temporary.push(shortened(name));
    temporary.push(format!(".partial-{}", std::process::id()));
    if number > 0 {
        temporary.push(format!("-{number}"));
    }
    temporary
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
    fn a_name_beside_another_keeps_its_ending() {
        assert_eq!(beside(Path::new("x/a.csv"), "17"), Path::new("x/a.17.csv"));
        assert_eq!(beside(Path::new("x/a.h5"), "failed"), Path::new("x/a.failed.h5"));
        assert_eq!(beside(Path::new("a.b"), "failed"), Path::new("a.b.failed.h5"));
    }
}
