//! Any bytes as the states that `eval` reads.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| dalembert_fuzz::states(bytes));
