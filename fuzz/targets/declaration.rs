//! Any text as a declaration.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| dalembert_fuzz::declaration(bytes));
