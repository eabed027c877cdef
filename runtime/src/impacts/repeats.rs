//! Counts of repeated events at one time.

/// Counter of the repetitions of an event at the time of its last occurrence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Repeats {
    /// Time of the last occurrence; `None` before the first.
    last: Option<f64>,
    count: u32,
}

impl Repeats {
    /// No occurrence yet.
    pub(super) fn none() -> Self {
        Self {
            last: None,
            count: 0,
        }
    }

    /// Records an occurrence. Returns the number of earlier ones at the same time.
    pub(super) fn add(&mut self, t: f64) -> u32 {
        self.count = match self.last == Some(t) {
            true => self.count + 1,
            false => 0,
        };
        self.last = Some(t);
        self.count
    }

    /// Time of the last occurrence.
    pub(super) fn last(&self) -> Option<f64> {
        self.last
    }

    /// Number of occurrences at the last time, without the first.
    pub(super) fn count(&self) -> u32 {
        self.count
    }
}
