//! What is read of a file from a stranger: nothing outside it, and no more than it can hold.
//!
//! HDF5 lets a file name others: links to objects in them, datasets whose values lie in them, or are
//! put together from theirs, even from themselves. None of these is followed. And it lets a dataset
//! claim any size: before memory is asked for, the claim is held against the file's.

use hdf5::plist::dataset_create::Layout;
use hdf5::{Dataset, Group, LinkType, LocationToken, LocationType};

/// How many bytes a byte of a compressed dataset may stand for: deflate reaches 1032, and
/// fill values of what was never written are few.
const MOST_EXPANSION: u64 = 2000;
/// A dataset may be that large (bytes) whatever is stored of it.
const SMALL: u64 = 1 << 20;
/// Largest chunk (bytes): one is in memory as a whole.
const LARGEST_CHUNK: u64 = 1 << 28;
/// Members of a group that are looked at.
const MOST_MEMBERS: usize = 10_000;

/// What a name in a group leads to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Member {
    /// A dataset of this file.
    Dataset(LocationToken),
    /// A group of this file.
    Group(LocationToken),
    /// A type, or what a newer library may know.
    Other,
    /// Nothing, or something elsewhere: a link that is not followed.
    Link,
}

/// The members of a group with their names, in the order of these. No link is followed.
///
/// # Errors
/// What reading meets, or too many members.
pub(crate) fn members(group: &Group) -> hdf5::Result<Vec<(String, Member)>> {
    let mut members = Vec::new();
    group.iter_visit_default(|name, info| {
        if members.len() == MOST_MEMBERS {
            return Err(format!("there are more than {MOST_MEMBERS} members in a group").into());
        }
        let hard = info.link_type == LinkType::Hard;
        members.push((name.to_owned(), if hard { Member::Other } else { Member::Link }));
        Ok(())
    })?;
    for (name, member) in members.iter_mut().filter(|(_, member)| *member != Member::Link) {
        let info = group.loc_info_by_name(name)?;
        *member = match info.loc_type {
            LocationType::Dataset => Member::Dataset(info.token),
            LocationType::Group => Member::Group(info.token),
            _ => Member::Other,
        };
    }
    members.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(members)
}

/// What is left of a file's bytes for datasets to claim as theirs.
#[derive(Debug)]
pub(crate) struct Ration {
    size: u64,
    left: u64,
}

impl Ration {
    /// Of a file of so many bytes.
    pub fn new(size: u64) -> Self {
        Ration { size, left: size }
    }

    /// Says what keeps a dataset from being read, if anything does. Its shape is not asked for
    /// before it is known that all of it lies in this file.
    ///
    /// # Errors
    /// What asking meets.
    pub fn refuses(&mut self, dataset: &Dataset) -> hdf5::Result<Option<String>> {
        let plan = dataset.dcpl()?;
        if plan.get_layout()? == Layout::Virtual {
            return Ok(Some("is put together from other datasets, which is not followed".into()));
        }
        if !plan.get_external()?.is_empty() {
            return Ok(Some("has its values in another file, which is not followed".into()));
        }
        let shape = dataset.shape();
        let item = dataset.dtype()?.size() as u64;
        let bytes = |sides: &[usize]| {
            sides.iter().try_fold(item, |all, side| all.checked_mul(*side as u64))
        };
        let stored = dataset.storage_size();
        let claimed = bytes(&shape).unwrap_or(u64::MAX);
        if stored > self.left {
            let size = self.size;
            return Ok(Some(format!("has more stored than there is in a file of {size} bytes")));
        }
        self.left -= stored;
        if claimed > SMALL && claimed / MOST_EXPANSION > stored {
            return Ok(Some(format!(
                "claims the shape {shape:?}, of which {stored} bytes are there"
            )));
        }
        match plan.get_chunk()? {
            Some(chunk) if bytes(&chunk).is_none_or(|bytes| bytes > LARGEST_CHUNK) => {
                Ok(Some(format!("is in chunks of {chunk:?}, which are too large")))
            }
            _ => Ok(None),
        }
    }
}
