//! `flank`: tooth surfaces of any machine, from the command line.

mod arguments;
mod branches;
mod certify;
mod check;
mod convert;
mod cost;
mod cut;
mod derive;
mod deviation;
mod explain;
mod fields;
mod files;
mod fmt;
mod geometry;
mod import;
mod limits;
mod new;
mod plot;
mod reach;
mod reasons;
mod required;
mod sensitivity;
mod shell;
mod solve;
mod spec;
mod step;
mod table;
mod travel;
mod trims;
mod units;
mod view;

use std::process::ExitCode;

use clap::Parser;

use arguments::{Arguments, Command};

/// How a command ended, as the exit codes say it; 2, a wrong command line, is told by the argument parser.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ending {
    /// 0
    Done,
    /// 1: the spec is wrong, or a file cannot be read or written.
    Wrong,
    /// 3: done, but something asked for could not be solved, and it is listed.
    Unsolved,
}

fn main() -> ExitCode {
    let ending = match Arguments::parse().command {
        Command::Solve(arguments) => solve::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Convert(arguments) => convert::run(&arguments),
        Command::Derive(arguments) => derive::run(&arguments),
        Command::Deviation(arguments) => deviation::run(&arguments),
        Command::Plot(arguments) => plot::run(&arguments),
        Command::Explain(arguments) => explain::run(&arguments),
        Command::Import(arguments) => import::run(&arguments),
        Command::Fmt(arguments) => fmt::run(&arguments),
        Command::View(arguments) => view::run(&arguments),
        Command::New(arguments) => new::run(&arguments),
        Command::Completions(arguments) => shell::completions(&arguments),
        Command::Man(arguments) => shell::man(&arguments),
    };
    ExitCode::from(match ending {
        Ending::Done => 0,
        Ending::Wrong => 1,
        Ending::Unsolved => 3,
    })
}

/// Writes to stdout; a reader that has gone away is not an error.
fn print(text: &str) {
    use std::io::Write;
    let _ = anstream::stdout().write_all(text.as_bytes());
}
