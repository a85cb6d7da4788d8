//! Fuzzes the conversation with an editor.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| flank_fuzz::conversation::fuzz_lsp(data));
