//! Counts of what happens again and again at one time.

/// Number of times that something has happened again at the time at which it happened last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Repeats {
    /// Time of the last occurrence; `None` before the first.
    last: Option<f64>,
    count: u32,
}

impl Repeats {
    /// Nothing has happened yet.
    pub(super) fn none() -> Self {
        Self {
            last: None,
            count: 0,
        }
    }

    /// Takes in an occurrence. Returns the number of those before it at the same time.
    pub(super) fn add(&mut self, t: f64) -> u32 {
        self.count = match self.last == Some(t) {
            true => self.count + 1,
            false => 0,
        };
        self.last = Some(t);
        self.count
    }

    /// Number of occurrences at the last time, the first not counted.
    pub(super) fn count(&self) -> u32 {
        self.count
    }
}
