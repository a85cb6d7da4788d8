//! `flank lsp` and `flank view --serve`: what follows a text while it is typed and saved.

use flank_lsp::Live;

use crate::arguments::View;
use crate::failure::Failure;
use crate::spelling::with_flags;
use crate::{Ending, eprint, print};

/// Serves an editor on stdin and stdout until it ends the conversation or goes away.
///
/// # Errors
/// If the system lets no thread start.
pub(crate) fn lsp() -> Result<Ending, Failure> {
    let is_clean = flank_lsp::serve(std::io::stdin(), std::io::stdout(), with_flags);
    Ok(if is_clean.map_err(|error| format!("cannot serve: {error}"))? { Ending::Done } else { Ending::Wrong })
}

/// Serves the page of a spec on the disk and follows what is saved.
///
/// # Errors
/// If the spec comes from the standard input, which cannot be followed, has no job of the name that is asked for, or the system gives no port.
pub(crate) fn view(arguments: &View) -> Result<Ending, Failure> {
    if crate::spec::is_stdin(&arguments.which.file) {
        let reason = "--serve follows a file: the standard input is read once".to_string();
        return Err(Failure::of_usage(reason));
    }
    has_job(arguments)?;
    let live = Live::start(arguments.evaluator.evaluator(), with_flags);
    let live = live.map_err(|error| format!("cannot serve a page: {error}"))?;
    print(&format!("{}\n", live.url));
    eprint("the page follows what is saved; Ctrl-C ends it\n");
    flank_lsp::follow(&arguments.which.file, |project| {
        live.show(project, arguments.which.job.clone(), &arguments.which.set);
    });
    Ok(Ending::Done)
}

/// # Errors
/// If the spec is right and has not the job that is asked for. One that is wrong may get it yet.
fn has_job(arguments: &View) -> Result<(), Failure> {
    let (Some(name), set) = (&arguments.which.job, &arguments.which.set) else { return Ok(()) };
    let project = crate::spec::project(&arguments.which.file)?;
    if project.jobs(set).is_ok() {
        project.job(name, set)?;
    }
    Ok(())
}
