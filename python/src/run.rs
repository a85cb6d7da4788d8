//! Operations beside the interpreter: other Python threads go on meanwhile, and Ctrl-C ends them.

use std::any::Any;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::Duration;

use flank::{Failure, Monitor, Remark};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::failure;

/// Signals wait for so long at the most.
const LOOK: Duration = Duration::from_millis(50);
/// As much as the main thread of a program has: operations are written for that.
pub(crate) const STACK: usize = 8 << 20;

/// Threads of an operation; 0 for those that all operations share, one for each processor.
static THREADS: AtomicUsize = AtomicUsize::new(0);
/// The process that these run in: a fork has none of them.
static PROCESS: OnceLock<u32> = OnceLock::new();

thread_local! {
    /// The threads of the operations of one Python thread, with their number and their process.
    static OWN: RefCell<Option<(usize, u32, Arc<ThreadPool>)>> = const { RefCell::new(None) };
}

/// Sets the number of threads that an operation works on, 0 for all together one for each processor; says what it was.
#[pyfunction]
#[pyo3(signature = (count=None))]
pub(crate) fn threads(count: Option<usize>) -> usize {
    match count {
        Some(count) => THREADS.swap(count, Ordering::Relaxed),
        None => THREADS.load(Ordering::Relaxed),
    }
}

/// Follows an operation.
#[derive(Default)]
struct Watch {
    is_cancelled: AtomicBool,
    remarks: Mutex<Vec<String>>,
}

impl Monitor for Watch {
    fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }

    fn remark(&self, remark: &Remark) {
        self.remarks.lock().unwrap_or_else(PoisonError::into_inner).push(remark.to_string());
    }
}

/// Runs an operation on a thread of its own, without the interpreter. What it remarks beside its results becomes a warning.
///
/// # Errors
/// Why it did not do what it was asked for; a signal that came meanwhile; that it panicked.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&dyn Monitor) -> Result<T, Failure> + Send + 'static,
) -> PyResult<T> {
    let watch = Arc::new(Watch::default());
    let watching = Arc::clone(&watch);
    let pool = own_pool()?;
    let (tell, mut hear) = mpsc::channel();
    let worker = thread::Builder::new().name("flank".to_string()).stack_size(STACK);
    worker.spawn(move || {
        let working = || match pool {
            Some(pool) => pool.install(|| work(&*watching)),
            None => work(&*watching),
        };
        // nobody hears it if a signal has ended the wait
        let _ = tell.send(catch_unwind(AssertUnwindSafe(working)));
    })?;
    loop {
        let (back, heard) = py.detach(move || {
            let heard = hear.recv_timeout(LOOK);
            (hear, heard)
        });
        hear = back;
        match heard {
            Ok(Ok(result)) => {
                failure::warn(py, &watch.remarks.lock().unwrap_or_else(PoisonError::into_inner))?;
                return result.map_err(|failure| failure::raised(py, failure));
            }
            Ok(Err(panic)) => return Err(failure::internal(py, &words(&*panic))),
            Err(RecvTimeoutError::Disconnected) => return Err(failure::internal(py, "a thread ended without a word")),
            Err(RecvTimeoutError::Timeout) => {
                if let Err(signal) = py.check_signals() {
                    watch.is_cancelled.store(true, Ordering::Relaxed);
                    return Err(signal);
                }
            }
        }
    }
}

/// The threads of this Python thread's operations, where these are not to share those of all.
fn own_pool() -> PyResult<Option<Arc<ThreadPool>>> {
    let (wanted, process) = (THREADS.load(Ordering::Relaxed), std::process::id());
    let is_fork = *PROCESS.get_or_init(|| process) != process;
    if wanted == 0 && !is_fork {
        return Ok(None);
    }
    let count = if wanted == 0 { thread::available_parallelism().map_or(1, usize::from) } else { wanted };
    OWN.with_borrow_mut(|own| {
        let known = own.take().filter(|(threads, of, _)| (*threads, *of) == (count, process));
        let pool = match known {
            Some((_, _, pool)) => pool,
            None => {
                let made = ThreadPoolBuilder::new().num_threads(count).stack_size(STACK).build();
                Arc::new(made.map_err(|error| pyo3::exceptions::PyRuntimeError::new_err(error.to_string()))?)
            }
        };
        *own = Some((count, process, Arc::clone(&pool)));
        Ok(Some(pool))
    })
}

fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default()
}
