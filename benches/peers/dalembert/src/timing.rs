//! Time that something takes.

use std::time::{Duration, Instant};

/// The time of some work, with its result.
pub fn timed<T>(work: impl FnOnce() -> T) -> (Duration, T) {
    let start = Instant::now();
    let result = work();
    (start.elapsed(), result)
}
