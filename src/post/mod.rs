//! What a result file says: peaks, ratios to the ideal mechanism, contacts, energy balance.

mod contacts;
mod energy;
mod extremes;
mod json;
mod quantity;
mod refine;
mod revolutions;
mod summary;
mod table;
mod tally;

pub use contacts::{At, Contacts, RevolutionContacts, Stretch};
pub use energy::EnergyBalance;
pub use extremes::{RunExtremes, Wanted, case_of};
pub use quantity::Quantity;
pub use revolutions::Revolutions;
pub use summary::{InMemory, Reference, Summary, Turning};
pub(crate) use table::table;
pub use tally::{Basis, Extreme, Extremes, Tally, ratio};

use crate::case;
use crate::dae::Fault;
use crate::{record, simulate};
use std::convert::Infallible;
use std::path::PathBuf;

/// Complaints in one line.
fn what_is_wrong(error: &case::Error) -> String {
    match error {
        case::Error::NotAMechanism { complaints, .. } => {
            complaints.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
        }
        other => other.to_string(),
    }
}

/// Why a run could not be summarised.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file could not be read.
    #[error(transparent)]
    Record(#[from] record::Error),
    /// A file holds no case.
    #[error("{} does not hold the text of its case", path.display())]
    NoCase {
        /// The file.
        path: PathBuf,
    },
    /// The case in a file, with its clearances removed or not, describes no mechanism.
    #[error(transparent)]
    Case(case::Error),
    /// The case, as it was run, is sound; without its clearances it does not go together.
    #[error(
        "without its clearances the mechanism cannot be assembled as it starts: {}",
        what_is_wrong(why)
    )]
    NoIdeal {
        /// What is wrong with the ideal mechanism.
        why: Box<case::Error>,
    },
    /// A run on the spot failed.
    #[error(transparent)]
    Simulation(simulate::Error<Infallible>),
    /// A mechanism without freedom could not be placed.
    #[error("the mechanism could not be evaluated at t = {time:e} s")]
    System {
        /// Where (s).
        time: f64,
        /// What the mechanism says.
        source: Fault,
    },
    /// Two runs have no joint, drive or body of the same name.
    #[error("{} and {} have nothing in common", file.display(), against.display())]
    NothingInCommon {
        /// The file.
        file: PathBuf,
        /// The file it was to be compared with.
        against: PathBuf,
    },
}
