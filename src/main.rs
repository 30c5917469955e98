//! The `freeplay` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    freeplay::cli::main()
}
