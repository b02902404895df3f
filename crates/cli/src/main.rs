//! The `granule` command with the laws that granule ships.

use std::process::ExitCode;

fn main() -> ExitCode {
    granule_cli::main()
}
