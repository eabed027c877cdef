//! Any sequence of tokens as a declaration.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| dalembert_fuzz::tokens(bytes));
