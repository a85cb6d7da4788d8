//! A page on this machine that follows a spec.

mod http;
mod pages;
mod watch;

use std::hash::{BuildHasher, Hasher, RandomState};
use std::io;
use std::net::{Ipv4Addr, TcpListener};
use std::sync::Arc;

use flank::{EvaluatorOptions, JobSelection, Project};

use crate::Spelling;
use pages::{Pages, Wish};

pub use watch::follow;

/// A page that is served on this machine until the program ends.
#[derive(Clone, Debug)]
pub struct Live {
    /// Where a browser finds it: a loopback port and a path that nobody guesses.
    pub url: String,
    pages: Arc<Pages>,
}

impl Live {
    /// Starts to serve a page without a picture.
    ///
    /// # Errors
    /// If the system gives no port, or lets no thread start.
    pub fn start(evaluator: EvaluatorOptions, spelled: Spelling) -> io::Result<Live> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
        let port = listener.local_addr()?.port();
        let secret = secret();
        let pages = Pages::start(evaluator, spelled)?;
        let served = Arc::clone(&pages);
        let own = secret.clone();
        std::thread::Builder::new()
            .name("live page".to_string())
            .spawn(move || http::serve(&listener, &own, &served))?;
        Ok(Live { url: format!("http://127.0.0.1:{port}/{secret}/"), pages })
    }

    /// Shows a job of a spec, or its first, as it is now; what was asked for before and is not shown yet is given up.
    pub fn show(&self, project: Project, job: Option<String>, set: &[(String, String)]) {
        self.pages.wish(Wish { selection: JobSelection { project, job: None, set: set.to_vec() }, job });
    }
}

/// 128 bits that the system's own random keys give.
fn secret() -> String {
    let bits = || RandomState::new().build_hasher().finish();
    format!("{:016x}{:016x}", bits(), bits())
}
