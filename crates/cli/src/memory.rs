//! What happens where the system gives no more memory: the program ends with words and an exit code of its own.
//!
//! What jobs ask for is estimated before ([`flank::solve`]); this is for what the estimate misses, and for systems
//! that have less. A system that promises memory which it has not (as Linux does by default) ends a program by itself instead.
#![allow(unsafe_code)] // an allocator is unsafe to write; this one hands everything to the system's

use std::alloc::{GlobalAlloc, Layout, System};
use std::fmt::Arguments;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::Ending;

#[global_allocator]
static MEMORY: Telling = Telling;

/// The system's allocator, but that a request which fails does not come back.
struct Telling;

// SAFETY: each call goes to the system's allocator as it came, so that its contract holds; a null pointer ends the process.
unsafe impl GlobalAlloc for Telling {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the contract
        granted(unsafe { System.alloc(layout) }, layout.size())
    }

    #[inline]
    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as above
        unsafe { System.dealloc(memory, layout) }
    }

    #[inline]
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above
        granted(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    #[inline]
    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above
        granted(unsafe { System.realloc(memory, layout, size) }, size)
    }
}

#[inline]
fn granted(memory: *mut u8, bytes: usize) -> *mut u8 {
    if memory.is_null() {
        refused(bytes);
    }
    memory
}

/// Whether what ends the program goes to stdout as a document, too.
static AS_DOCUMENT: AtomicBool = AtomicBool::new(false);

/// Makes it so.
pub(crate) fn tell_as_document() {
    AS_DOCUMENT.store(true, Ordering::Relaxed);
}

/// Says so without any memory, and ends. Files that are not whole have no names yet.
#[cold]
fn refused(bytes: usize) -> ! {
    let code = Ending::OutOfMemory.code();
    let reason = format_args!(
        "out of memory: the system gave none of {bytes} bytes more; ask for fewer points, or give the program more"
    );
    let _ = written(format_args!("error: {reason}\n"), |text| std::io::stderr().write_all(text));
    // of several threads one tells it
    if AS_DOCUMENT.swap(false, Ordering::Relaxed) {
        let document = format_args!(
            "{{\"schema\": \"flank.failure/1\", \"exit_code\": {code}, \"message\": \"{reason}\", \"findings\": [], \"not_done\": []}}\n"
        );
        let _ = written(document, to_stdout);
    }
    std::process::exit(code.into())
}

/// Writes a text that is put together in memory which is there; what does not fit is left out.
fn written(text: Arguments<'_>, write: impl FnOnce(&[u8]) -> std::io::Result<()>) -> std::io::Result<()> {
    let mut room = [0; 320];
    let size = room.len();
    let mut left = &mut room[..];
    let _ = left.write_fmt(text);
    let used = size - left.len();
    write(&room[..used])
}

/// Past the standard library's stdout, which takes memory when it is used first and may be in use.
#[cfg(target_os = "linux")]
fn to_stdout(mut text: &[u8]) -> std::io::Result<()> {
    while !text.is_empty() {
        text = &text[rustix::io::write(rustix::stdio::stdout(), text)?..];
    }
    Ok(())
}

#[cfg(not(target_os = "linux"))]
fn to_stdout(text: &[u8]) -> std::io::Result<()> {
    std::io::stdout().write_all(text)
}
