//! `flank completions`, `flank man`

use clap::CommandFactory;

use crate::arguments::{Arguments, Completions, Man};
use crate::document::{self, CompletionScript, ManualPages};
use crate::failure::Failure;
use crate::{Ending, print};

/// Prints what the shell has to read to complete the program's arguments.
pub(crate) fn completions(arguments: &Completions) -> Ending {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "flank", &mut script);
    let script = String::from_utf8_lossy(&script);
    if arguments.json {
        let shell = arguments.shell.to_string();
        print(&document::text(&CompletionScript { shell, script: script.into_owned() }));
    } else {
        print(&script);
    }
    Ending::Done
}

/// Writes a page for the program and one for each command.
pub(crate) fn man(arguments: &Man) -> Result<Ending, Failure> {
    // `flank help` has no page of its own for the program's page to name
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    let pages: Vec<clap::Command> = std::iter::once(&program).chain(program.get_subcommands()).cloned().collect();
    let mut texts = Vec::new();
    for page in pages {
        let page = clap_mangen::Man::new(page).date("");
        let name = page.get_filename();
        let mut text = Vec::new();
        page.render(&mut text).map_err(|error| format!("the page {name} cannot be made: {error}"))?;
        texts.push((name, String::from_utf8_lossy(&text).into_owned()));
    }
    let files = flank::write_texts(&arguments.out, &texts, &[])?;
    print(&if arguments.json {
        document::text(&ManualPages { files })
    } else {
        format!("wrote {}\n", files.join(", "))
    });
    Ok(Ending::Done)
}
