//! `flank view --serve`: a page on this machine that follows the spec.

mod http;
mod pages;
mod watch;

use std::hash::{BuildHasher, Hasher, RandomState};
use std::io;
use std::net::{Ipv4Addr, TcpListener};
use std::sync::Arc;

use flank::{JobSelection, Project};

use crate::arguments::View;
use crate::failure::Failure;
use crate::{Ending, eprint, print};

use pages::{Pages, Wish};

/// A page that is served on this machine until the program ends.
#[derive(Clone, Debug)]
pub(crate) struct Live {
    /// Where a browser finds it: a loopback port and a path that nobody guesses.
    pub(crate) url: String,
    pages: Arc<Pages>,
}

impl Live {
    /// Starts to serve a page without a picture.
    ///
    /// # Errors
    /// If the system gives no port, or lets no thread start.
    pub(crate) fn start(evaluator: flank::EvaluatorOptions) -> io::Result<Live> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
        let port = listener.local_addr()?.port();
        let secret = secret();
        let pages = Pages::start(evaluator)?;
        let served = Arc::clone(&pages);
        let own = secret.clone();
        std::thread::Builder::new()
            .name("live page".to_string())
            .spawn(move || http::serve(&listener, &own, &served))?;
        Ok(Live { url: format!("http://127.0.0.1:{port}/{secret}/"), pages })
    }

    /// Shows a job of a spec, or its first, as it is now; what was asked for before and is not shown yet is given up.
    pub(crate) fn show(&self, project: Project, job: Option<String>, set: &[(String, String)]) {
        self.pages.wish(Wish { selection: JobSelection { project, job: None, set: set.to_vec() }, job });
    }
}

/// 128 bits that the system's own random keys give.
fn secret() -> String {
    let bits = || RandomState::new().build_hasher().finish();
    format!("{:016x}{:016x}", bits(), bits())
}

/// Serves the page of a spec on the disk and follows what is saved.
///
/// # Errors
/// If the spec comes from the standard input, which cannot be followed, or the system gives no port.
pub(crate) fn run(arguments: &View) -> Result<Ending, Failure> {
    if crate::spec::is_stdin(&arguments.which.file) {
        let reason = "--serve follows a file: the standard input is read once".to_string();
        return Err(Failure::of_usage(reason));
    }
    let live = Live::start(arguments.evaluator.evaluator()).map_err(|error| format!("cannot serve a page: {error}"))?;
    print(&format!("{}\n", live.url));
    eprint("the page follows what is saved; Ctrl-C ends it\n");
    watch::follow(&arguments.which.file, |project| {
        live.show(project, arguments.which.job.clone(), &arguments.which.set);
    });
    Ok(Ending::Done)
}
