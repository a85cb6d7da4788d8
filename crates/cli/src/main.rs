//! `flank`: tooth surfaces of any machine, from the command line.

mod arguments;
mod commands;
mod console;
mod document;
mod failure;
mod memory;
mod progress;
mod requests;
mod spec;
mod spelling;
mod threads;

use std::process::ExitCode;

use clap::Parser;

use arguments::{Arguments, Command};
use commands::{check, editor, explain, fmt, import, new, operations, schema, shell, sweep, test};
use console::{eprint, print};
use failure::Failure;

/// How a command ended, as the exit codes say it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ending {
    /// 0
    Done,
    /// 1: what was read is wrong or has not what is asked of it, or a file cannot be read or written.
    Wrong,
    /// 2: the command line is wrong, whatever the files say: also a name that only the program knows.
    Usage,
    /// 3: done, but something asked for could not be solved, and it is listed.
    Unsolved,
    /// 4: the system has not the memory that it takes.
    OutOfMemory,
    /// 141: done, but who read what was printed has gone away; as shells count a program that the signal of a broken pipe ends.
    Unread,
}

impl Ending {
    fn code(self) -> u8 {
        match self {
            Ending::Done => 0,
            Ending::Wrong => 1,
            Ending::Usage => 2,
            Ending::Unsolved => 3,
            Ending::OutOfMemory => 4,
            Ending::Unread => 141,
        }
    }
}

fn main() -> ExitCode {
    let command = match Arguments::try_parse() {
        Ok(arguments) => arguments.command,
        Err(error) if error.use_stderr() => {
            let is_json = std::env::args_os().any(|argument| argument == "--json");
            return ExitCode::from(Failure::of_parser(&error).tell(is_json).code());
        }
        Err(asked) => {
            print(&asked.render().ansi().to_string());
            return ended(Ending::Done);
        }
    };
    if command.is_json() {
        memory::tell_as_document();
    }
    if let Some(evaluator) = command.evaluator() {
        threads::start(evaluator.threads());
    }
    ended(run(&command).unwrap_or_else(|failure| failure.tell(command.is_json())))
}

/// What the caller reads at the end: most of all what went wrong.
fn ended(ending: Ending) -> ExitCode {
    let is_lost = ending == Ending::Done && console::is_unread();
    ExitCode::from(if is_lost { Ending::Unread } else { ending }.code())
}

fn run(command: &Command) -> Result<Ending, Failure> {
    match command {
        Command::Solve(arguments) => operations::solve(arguments),
        Command::Check(arguments) => check::run(arguments),
        Command::Test(arguments) => test::run(arguments),
        Command::Convert(arguments) => operations::convert(arguments),
        Command::Derive(arguments) => operations::derive(arguments),
        Command::Report(arguments) => operations::report(arguments),
        Command::Deviation(arguments) => operations::deviation(arguments),
        Command::Fit(arguments) => operations::fit(arguments),
        Command::Tolerance(arguments) => operations::tolerance(arguments),
        Command::Sweep(arguments) => sweep::run(arguments),
        Command::Contact(arguments) => operations::contact(arguments),
        Command::Mill(arguments) => operations::mill(arguments),
        Command::Measure(arguments) => operations::measure(arguments),
        Command::Mesh(arguments) => operations::mesh(arguments),
        Command::Plot(arguments) => operations::plot(arguments),
        Command::Explain(arguments) => Ok(explain::run(arguments)),
        Command::Import(arguments) => import::run(arguments),
        Command::Fmt(arguments) => Ok(fmt::run(arguments)),
        Command::View(arguments) => operations::view(arguments),
        Command::Lsp(_) => editor::lsp(),
        Command::New(arguments) => new::run(arguments),
        Command::Schema(arguments) => schema::run(arguments),
        Command::Completions(arguments) => Ok(shell::completions(arguments)),
        Command::Man(arguments) => shell::man(arguments),
    }
}
