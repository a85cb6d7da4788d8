//! The threads that work is shared out over. Results do not depend on how many there are.

use std::num::NonZero;
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::thread::{self, JoinHandle};

use rayon::{ThreadBuilder, ThreadPoolBuilder};

use crate::eprint;

/// Says how many threads are wanted, where the command line does not.
pub(crate) const VARIABLE: &str = "RAYON_NUM_THREADS";

/// Only one runs on a processor at a time: more than so many bring nothing, and searches that look ahead on all threads look too far.
const FOR_EACH_PROCESSOR: usize = 4;

/// Starts as many as are asked for on the command line or in the environment, otherwise one for each processor. Where these are too many,
/// or the system lets no more start, there are fewer, and a note.
pub(crate) fn start(asked: Option<NonZero<usize>>) {
    let processors = thread::available_parallelism().map_or(1, NonZero::get);
    let given = asked.map(|count| Ok(count.get())).or_else(of_environment).unwrap_or(Ok(processors));
    let wanted = given.unwrap_or_else(|text| {
        eprint(&format!(
            "note: {VARIABLE} is `{text}`, which is no number of threads: there is one for each processor\n"
        ));
        processors
    });
    let most = FOR_EACH_PROCESSOR * processors;
    if wanted > most {
        eprint(&format!(
            "note: {most} threads work instead of {wanted}: more than {FOR_EACH_PROCESSOR} for each processor bring nothing\n"
        ));
    }
    let wanted = wanted.min(most);
    let working = share_out(wanted, |work| thread::Builder::new().spawn(work));
    if working < wanted {
        let threads = if working == 1 { "1 thread works" } else { &format!("{working} threads work") };
        eprint(&format!("note: {threads} instead of {wanted}: the system lets no more start\n"));
    }
}

/// What the environment says: nothing, a number, or a text that is none.
fn of_environment() -> Option<Result<usize, String>> {
    let text = std::env::var_os(VARIABLE)?.to_string_lossy().trim().to_owned();
    match text.parse() {
        _ if text.is_empty() => None,
        Ok(0) => None,
        Ok(count) => Some(Ok(count)),
        // more than any number that is counted to here
        Err(_) if text.bytes().all(|digit| digit.is_ascii_digit()) => Some(Ok(usize::MAX)),
        Err(_) => Some(Err(text)),
    }
}

type Work = Box<dyn FnOnce() + Send>;

/// Starts so many threads, and says on how many work is shared out then. They are started before the pool is made, which would not be
/// made again with fewer.
fn share_out(wanted: usize, start: impl Fn(Work) -> std::io::Result<JoinHandle<()>>) -> usize {
    let (give, take) = mpsc::channel::<ThreadBuilder>();
    let take = Arc::new(Mutex::new(take));
    let waiting = |_| {
        let take = Arc::clone(&take);
        let work: Work = Box::new(move || {
            let given = take.lock().unwrap_or_else(PoisonError::into_inner).recv();
            given.into_iter().for_each(ThreadBuilder::run);
        });
        start(work).ok()
    };
    let started = (0..wanted).map_while(waiting).count();
    // what the last one could not get, memory or room among the processes, the work itself needs, too
    let kept = if started < wanted { started.div_ceil(2) } else { started };
    let pool = ThreadPoolBuilder::new().num_threads(kept.max(1));
    let made = if kept == 0 {
        pool.use_current_thread().build_global()
    } else {
        let hand_over = |worker| give.send(worker).map_err(|_| std::io::ErrorKind::BrokenPipe.into());
        pool.spawn_handler(hand_over).build_global()
    };
    made.expect("the threads are there, and nobody has made a pool before");
    kept.max(1)
}
