//! What something belongs to.

use super::{KeyPath, Names};

/// A part of a model that constraints, events and forces belong to, by its index among those of its
/// sort.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Owner {
    /// A clearance.
    Clearance(usize),
    /// A drive.
    Drive(usize),
    /// A load.
    Load(usize),
    /// A joint.
    Joint(usize),
}

impl Default for Owner {
    fn default() -> Self {
        Owner::Clearance(0)
    }
}

impl Owner {
    /// The sorts as result files number them.
    pub const WORDS: [(i8, &'static str); 4] =
        [(0, "clearance"), (1, "drive"), (2, "load"), (3, "joint")];

    /// One of a sort, by its number in result files; clearances where there is no such sort.
    pub fn of(sort: i8, index: usize) -> Owner {
        match sort {
            1 => Owner::Drive(index),
            2 => Owner::Load(index),
            3 => Owner::Joint(index),
            _ => Owner::Clearance(index),
        }
    }

    /// Number of its sort in result files.
    pub fn sort(self) -> i8 {
        match self {
            Owner::Clearance(_) => 0,
            Owner::Drive(_) => 1,
            Owner::Load(_) => 2,
            Owner::Joint(_) => 3,
        }
    }

    /// Index among those of its sort.
    pub fn index(self) -> usize {
        let (Owner::Clearance(k) | Owner::Drive(k) | Owner::Load(k) | Owner::Joint(k)) = self;
        k
    }

    /// Index of the clearance, if it is one.
    pub fn clearance(self) -> Option<usize> {
        if let Owner::Clearance(k) = self { Some(k) } else { None }
    }

    /// Its key in a case file.
    pub(crate) fn key(self, names: &Names) -> KeyPath {
        let table = match self {
            // a corner or a flank has no keys of its own
            Owner::Clearance(k) => match names.loose.get(k) {
                Some(joint) => return Owner::Joint(*joint).key(names),
                None => "joints",
            },
            Owner::Joint(_) => "joints",
            Owner::Drive(_) => "drives",
            Owner::Load(_) => "loads",
        };
        KeyPath::new([table.to_owned(), self.name(names)])
    }

    /// Its name; loads have none in result files, and are counted.
    pub fn name(self, names: &Names) -> String {
        let list = match self {
            Owner::Clearance(_) => &names.clearances,
            Owner::Drive(_) => &names.drives,
            Owner::Load(k) => return format!("load {}", k + 1),
            Owner::Joint(_) => &names.joints,
        };
        list.get(self.index()).cloned().unwrap_or_else(|| "?".to_owned())
    }
}
