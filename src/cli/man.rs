//! `freeplay man -o DIR`

use super::{CommandLine, Failure, signals};
use crate::record::{self, Draft};
use clap::{Command, CommandFactory};
use clap_mangen::Man;
use std::io;
use std::path::PathBuf;

/// Arguments of `man`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Folder for the pages; made if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Replace pages that exist.
    #[arg(long)]
    force: bool,
}

/// Why pages could not be written.
#[derive(Debug, thiserror::Error)]
enum ManError {
    #[error("cannot make the folder {}", path.display())]
    Folder { path: PathBuf, source: io::Error },
    #[error(transparent)]
    Output(#[from] record::Error),
    #[error("cannot write the page {name}")]
    Page { name: String, source: io::Error },
}

/// Writes a manual page of the program, and one of each command.
pub(super) fn man(arguments: &Arguments) -> Result<(), Failure> {
    signals::end_at_once()?;
    let pages = write(arguments).map_err(Failure::output)?;
    let folder = arguments.output.display();
    super::print(format_args!("{folder}: {pages} pages; man -l {folder}/freeplay.1 shows one\n"))
}

/// Writes the pages; says how many. Nothing is written if one that must stay is in the way.
fn write(arguments: &Arguments) -> Result<usize, ManError> {
    let folder = &arguments.output;
    std::fs::create_dir_all(folder)
        .map_err(|source| ManError::Folder { path: folder.clone(), source })?;
    let mut program = CommandLine::command().disable_help_subcommand(true);
    program.build();
    let commands = program.get_subcommands().cloned().map(|command| {
        let name = format!("freeplay-{}", command.get_name());
        command.display_name(name.clone()).bin_name(name.replacen('-', " ", 1))
    });
    let pages: Vec<Command> = std::iter::once(program.clone()).chain(commands).collect();
    let drafts = pages.iter().map(|page| {
        let name = format!("{}.1", page.get_display_name().unwrap_or("freeplay"));
        Draft::create(&folder.join(name), arguments.force)
    });
    let drafts = drafts.collect::<Result<Vec<_>, _>>()?;
    for (page, draft) in pages.iter().zip(drafts) {
        let mut text = Vec::new();
        Man::new(page.clone()).render(&mut text).map_err(|source| {
            let name = page.get_name().to_owned();
            ManError::Page { name, source }
        })?;
        draft.publish_bytes(&text)?;
    }
    Ok(pages.len())
}
