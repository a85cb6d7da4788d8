//! Fuzzes parse → format → parse.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| flank_fuzz::targets::fuzz_layout(data));
