//! Stopping rule of a fixed-point iteration that is solved to rounding.
//!
//! The iteration goes on while its changes decrease (E. Hairer, R. McLachlan, A. Razakarivony, *Achieving Brouwer's
//! law with implicit Runge-Kutta methods*, 2008). When they no longer decrease, either only rounding errors are
//! left, or the iteration does not contract.

/// Maximum number of iterations: enough to reach rounding if each halves the error.
const LIMIT: u32 = 60;

/// Size of changes, relative to the largest component, below which they may be rounding.
const ROUNDING: f64 = 1.0 / (1_u64 << 36) as f64;

/// Conclusion from the changes so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Make another iteration.
    GoOn,
    /// Only rounding errors are left.
    Solved,
    /// The iteration does not contract, or too slowly.
    Diverges,
}

/// State of an iteration.
#[derive(Debug, Clone, Copy)]
pub(super) struct Iteration {
    made: u32,
    /// The last change; `None` before the first.
    last: Option<f64>,
    /// Number of changes that were not smaller than their predecessor.
    grown: u32,
}

impl Iteration {
    /// State before the first iteration.
    pub(super) const fn new() -> Self {
        Self {
            made: 0,
            last: None,
            grown: 0,
        }
    }

    /// Judges an iteration from the size of its change and of the changed value.
    pub(super) fn judge(&mut self, change: f64, size: f64) -> Verdict {
        self.made += 1;
        if change == 0.0 {
            return Verdict::Solved;
        }
        if !(change.is_finite() && size.is_finite()) {
            return Verdict::Diverges;
        }
        if self.last.is_some_and(|last| change >= last) {
            if change <= ROUNDING * size {
                return Verdict::Solved;
            }
            // NOTE: one growth is accepted, because the first change may be small by chance.
            self.grown += 1;
        }
        self.last = Some(change);
        if self.grown > 1 || self.made >= LIMIT {
            Verdict::Diverges
        } else {
            Verdict::GoOn
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn end(changes: impl Iterator<Item = f64>) -> (Verdict, usize) {
        let mut iteration = Iteration::new();
        for (k, change) in changes.enumerate() {
            match iteration.judge(change, 1.0) {
                Verdict::GoOn => {}
                verdict => return (verdict, k + 1),
            }
        }
        (Verdict::GoOn, 0)
    }

    #[test]
    fn contractions_end_at_rounding() {
        let to_rounding = (1..).map(|k| 0.1_f64.powi(k).max(1.5e-16));
        assert_eq!(end(to_rounding), (Verdict::Solved, 17));
        let to_zero = [1e-3, 1e-9, 0.0].into_iter();
        assert_eq!(end(to_zero), (Verdict::Solved, 3));
    }

    #[test]
    fn growth_and_slowness_are_told() {
        assert_eq!(end((1..).map(|k| 2.0_f64.powi(k))), (Verdict::Diverges, 3));
        assert_eq!(end((1..).map(|k| 0.9_f64.powi(k))), (Verdict::Diverges, 60));
        assert_eq!(end([f64::NAN].into_iter()), (Verdict::Diverges, 1));
    }
}
