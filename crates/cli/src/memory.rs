//! What happens where the system gives no more memory: the program ends with words and an exit code of its own.
//!
//! What jobs ask for is estimated before ([`check_kept`](crate::stream::check_kept)); this is for what that does not see, and for systems
//! that have less. A system that promises memory which it has not (as Linux does by default) ends a program by itself instead.
#![allow(unsafe_code)] // an allocator is unsafe to write; this one hands everything to the system's

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;

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

/// Says so without any memory, and ends. Files that are not whole have no names yet.
#[cold]
fn refused(bytes: usize) -> ! {
    let mut text = [0; 160];
    let room = text.len();
    let mut left = &mut text[..];
    // what does not fit is left out
    let _ = writeln!(
        left,
        "error: out of memory: the system gave none of {bytes} bytes more; ask for fewer points, or give the program more"
    );
    let written = room - left.len();
    let _ = std::io::stderr().write_all(&text[..written]);
    std::process::exit(Ending::OutOfMemory.code().into())
}
