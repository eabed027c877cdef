//! Times in two parts, with more digits than one double has.

/// A time and its rounding error.
///
/// Late in a run, or where impacts accumulate, steps and flights may be shorter than a unit in the last place of the
/// time. The sum of two parts is accurate to about 32 digits, and even the shortest step moves the time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Instant {
    /// The time, in units of time.
    pub t: f64,
    /// The low part, to be added to `t`: at most half a unit in its last place.
    pub rest: f64,
}

impl Instant {
    /// An instant without rounding error.
    #[inline(always)]
    pub const fn new(t: f64) -> Self {
        Self { t, rest: 0.0 }
    }

    /// The moment `length` later (Knuth's two-sum).
    #[inline(always)]
    #[must_use]
    pub fn after(self, length: f64) -> Self {
        let change = length + self.rest;
        let t = self.t + change;
        let moved = t - self.t;
        Self {
            t,
            rest: (self.t - (t - moved)) + (change - moved),
        }
    }

    /// The time since another moment.
    #[inline(always)]
    pub fn since(self, other: Self) -> f64 {
        (self.t - other.t) + (self.rest - other.rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_shorter_than_the_last_place_add_up() {
        let start = Instant::new(1e9);
        let step = 1.0 / f64::from(1_u32 << 31);
        let mut now = start;
        for _ in 0..1000 {
            now = now.after(step);
        }
        assert_eq!(now.since(start), 1000.0 * step);
        assert_eq!(1e9 + step, 1e9);
    }
}
