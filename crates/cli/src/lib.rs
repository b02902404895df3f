//! The `granule` command, as a function: a program that links laws of its own calls it, and is the same command with them.

mod args;
mod commands;
mod progress;
mod terminal;
mod text;

use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use args::{Arguments, Command, LawCommand};
use commands::Exit;

/// Reads the command line of this process and does what it says.
pub fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let allowance = arguments.bounds.allowance();
    let exit = match arguments.command {
        Command::Run(arguments) => commands::run::run(&arguments, &allowance),
        Command::Resume(arguments) => commands::resume::resume(&arguments, &allowance),
        Command::Explain { scene } => commands::explain::explain(&scene, &allowance),
        Command::Check { scenes } => commands::check::check(&scenes, &allowance),
        Command::Trade(arguments) => commands::trade::trade(&arguments, &allowance),
        Command::Advise(arguments) => commands::advise::advise(&arguments, &allowance),
        Command::CompareModels(arguments) => commands::compare_models::compare(&arguments, &allowance),
        Command::Law { command: LawCommand::Check { scene, speed } } => {
            commands::law::check(&scene, speed, &allowance)
        }
        Command::Calibrate(arguments) => commands::calibrate::calibrate(&arguments),
        Command::Selftest(arguments) => commands::selftest::selftest(&arguments),
        Command::Laws { name, example } => commands::laws::laws(name.as_deref(), example),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "granule", &mut script);
            terminal::out(&String::from_utf8_lossy(&script));
            Exit::Success
        }
    };
    exit.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }
}
