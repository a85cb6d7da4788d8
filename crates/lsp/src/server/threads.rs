//! Threads that work beside the loop.

use std::sync::OnceLock;

use rayon::{ThreadPool, ThreadPoolBuilder};

/// Bytes of stack of a thread that compiles: as many as the main thread of a program has.
const STACK: usize = 16 << 20;

/// Threads that work beside the loop, once there is something to do.
pub(super) struct Threads {
    name: &'static str,
    count: usize,
    pool: OnceLock<Option<ThreadPool>>,
}

impl Threads {
    pub(super) const fn new(name: &'static str, count: usize) -> Threads {
        Threads { name, count, pool: OnceLock::new() }
    }

    /// Does work on one of them; on this thread, where the system lets none start.
    pub(super) fn spawn(&self, work: impl FnOnce() + Send + 'static) {
        let pool = self.pool.get_or_init(|| {
            let name = self.name;
            let named = move |number| format!("lsp {name} {number}");
            ThreadPoolBuilder::new().num_threads(self.count).stack_size(STACK).thread_name(named).build().ok()
        });
        match pool {
            Some(pool) => pool.spawn(work),
            None => work(),
        }
    }
}
