//! Fuzzes parse → check → derive.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| flank_fuzz::targets::fuzz_meaning(data));
