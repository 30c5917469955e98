//! How far one trajectory agrees with another: digits over time, and events one to one.
//!
//! The first of two files is judged by the second, the reference. Either may be a result of ours or
//! another program's table; one of them must be a result, for it says which mechanism it is.

mod comparison;
mod coverage;
mod error;
mod event;
mod foreign;
mod json;
mod mapping;
mod mechanism;
mod note;
mod quantity;
mod reference;
mod scale;
mod series;
mod shortfall;
mod source;
mod told;
mod unit;

pub use comparison::{Comparison, Identity, MappedName, Request, Side};
pub use coverage::Coverage;
pub use error::Error;
pub use event::{ContactPair, EventComparison, EventRow, Pair, Unmatched};
pub use mapping::{How, Map, NotAMap};
pub use quantity::{Column, Part, Parts, Quantity};
pub use reference::Way;
pub use series::{Certificate, QuantityGrades, Series};
pub use shortfall::{Requirement, Shortfall};
