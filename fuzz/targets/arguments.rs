//! Any text as the flags of `simulate`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| dalembert_fuzz::arguments(bytes));
