//! `flank completions`, `flank man`

use clap::CommandFactory;

use crate::arguments::{Arguments, Completions, Man};
use crate::files::Folder;
use crate::{Ending, print};

/// Prints what the shell has to read to complete the program's arguments.
pub(crate) fn completions(arguments: &Completions) -> Ending {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "flank", &mut script);
    print(&String::from_utf8_lossy(&script));
    Ending::Done
}

/// Writes a page for the program and one for each command.
pub(crate) fn man(arguments: &Man) -> Ending {
    let mut program = Arguments::command();
    program.build();
    let commands = program.get_subcommands().filter(|command| command.get_name() != "help");
    let pages: Vec<clap::Command> = std::iter::once(&program).chain(commands).cloned().collect();
    let written = Folder::at(&arguments.out).and_then(|mut folder| {
        for page in pages {
            let page = clap_mangen::Man::new(page).date("");
            let name = page.get_filename();
            let mut text = Vec::new();
            page.render(&mut text).map_err(|error| format!("the page {name} cannot be made: {error}"))?;
            folder.text(&name, &String::from_utf8_lossy(&text))?;
        }
        Ok(folder.written)
    });
    match written {
        Ok(files) => {
            print(&format!("wrote {}\n", files.join(", ")));
            Ending::Done
        }
        Err(reason) => {
            anstream::eprintln!("error: {reason}");
            Ending::Wrong
        }
    }
}
