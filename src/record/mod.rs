//! The result file: what is in it, how it is written and read.
//!
//! One table, [`DATASETS`], says what a file holds; the writer and the reader both go by it.
//! Everything lies flat in the root, in numbers of fixed size and text in attributes, so that
//! h5py, xarray, `ncdump`, Octave and MATLAB open it without a line of ours.

mod arrival;
mod attribute;
mod chunk;
mod dimension_scale;
mod error;
mod header;
mod names;
mod overview;
mod publish;
mod reader;
mod schema;
mod seal;
mod segments;
mod sound;
mod store;
mod writer;

pub(crate) use arrival::Written;
pub use attribute::Attribute;
pub use error::{Error, LibraryError};
pub use header::{Ending, Header, Outcome, Series, utc};
pub use names::names_of_runs;
pub use overview::Overview;
pub(crate) use publish::{Draft, abandon_drafts};
pub use reader::{ResultFile, Table};
pub use schema::{
    DATASETS, Dataset, Dimension, Drawn, Place, Quantity, SCHEMA_VERSION, Source, Values,
    column_name,
};
pub use seal::{Seal, sha256};
pub(crate) use segments::program;
pub use segments::{Resumed, Segmented, first_difference, has_segments, is_whole, tidy};
pub(crate) use sound::{Member, Ration, members};
pub use store::hdf5_version;
pub use writer::Writer;
