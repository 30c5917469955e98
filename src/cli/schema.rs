//! `freeplay schema`

use super::Failure;
use crate::case::{schema, tables};

/// Arguments of `schema`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Print tables of the keys in place of the schema, in Markdown.
    #[arg(long)]
    markdown: bool,
}

/// Prints the JSON Schema of case files.
pub(super) fn schema_of_cases(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.markdown {
        return super::print(tables());
    }
    super::print(format!("{:#}\n", schema()))
}
