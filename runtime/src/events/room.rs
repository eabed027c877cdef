//! A box of times and positions around a step. It may contain later steps as well.

use super::path::Path;
use crate::numbers::Interval;
use crate::state::StateVector;

/// The box; empty at first.
#[derive(Debug, Clone)]
pub(crate) struct Room<S> {
    lowest: S,
    highest: S,
    times: Interval,
    /// Number of components that are positions. Gaps depend on no other components.
    positions: usize,
    /// Bounded positions, as a bit mask.
    kept: u64,
    is_known: bool,
}

/// Bit of a component in a mask. All components from 63 on share the last bit.
#[inline]
pub(crate) fn place(i: usize) -> u64 {
    1 << i.min(63)
}

impl<S: StateVector> Room<S> {
    /// No box yet, for systems with `positions` positions, and states with as many components as `like`.
    pub(crate) fn new(positions: usize, like: &S) -> Self {
        Self {
            lowest: like.zeroed(),
            highest: like.zeroed(),
            times: Interval::point(0.0),
            positions: positions.min(like.count()),
            kept: u64::MAX,
            is_known: false,
        }
    }

    /// Discards the box.
    pub(crate) fn forget(&mut self) {
        self.is_known = false;
    }

    /// True if there is a box.
    pub(crate) fn is_known(&self) -> bool {
        self.is_known
    }

    /// True if a step lies in the box.
    #[inline]
    pub(crate) fn holds(&self, path: &Path<S>) -> bool {
        self.holds_box(|i| path.range(i), path.time([0.0, 1.0]).value)
    }

    /// True if the positions in these ranges, at these times, lie in the box.
    #[inline(always)]
    pub(crate) fn holds_box(&self, range: impl Fn(usize) -> Interval, times: Interval) -> bool {
        if !(self.is_known && self.times.contains(times)) {
            return false;
        }
        // NOTE: a loop is inlined here; an iterator may not be.
        for i in 0..self.positions {
            if self.keeps(i) && !self.range(i).contains(range(i)) {
                return false;
            }
        }
        true
    }

    /// Range of component `i` in the box.
    #[inline]
    pub(crate) fn range(&self, i: usize) -> Interval {
        Interval::new(self.lowest.as_slice()[i], self.highest.as_slice()[i])
    }

    /// Range of the times in the box.
    #[inline]
    pub(crate) fn times(&self) -> Interval {
        self.times
    }

    /// Number of components that are positions.
    #[inline]
    pub(crate) fn positions(&self) -> usize {
        self.positions
    }

    /// Restricts the box to these components, given by their [`place`]s. Gaps depend on no others.
    pub(crate) fn keep(&mut self, components: u64) {
        self.kept = components;
    }

    /// True if a component is bounded.
    #[inline]
    pub(crate) fn keeps(&self, i: usize) -> bool {
        self.kept & place(i) != 0
    }

    /// Sets the box to that of a step. The margin on every side is `margin` times the width covered in the step.
    pub(crate) fn surround(&mut self, path: &Path<S>, margin: f64) {
        let widened = |range: Interval| range.widened(margin * range.width());
        self.surround_box(
            |i| widened(path.range(i)),
            widened(path.time([0.0, 1.0]).value),
        );
    }

    /// Sets the box to these ranges and times.
    pub(crate) fn surround_box(&mut self, range: impl Fn(usize) -> Interval, times: Interval) {
        for i in 0..self.positions {
            self.set(i, range(i));
        }
        self.times = times;
        self.is_known = true;
    }

    /// Extends the box to contain a step. On a side where the step leaves the box, the new bound is that of the step
    /// plus half the former width of the box.
    pub(crate) fn extend(&mut self, path: &Path<S>) {
        self.extend_box(|i| path.range(i), path.time([0.0, 1.0]).value);
    }

    /// Extends the box to contain these ranges and times, in the same way.
    pub(crate) fn extend_box(&mut self, range: impl Fn(usize) -> Interval, times: Interval) {
        for i in 0..self.positions {
            self.set(i, extended(self.range(i), range(i)));
        }
        self.times = extended(self.times, times);
    }

    fn set(&mut self, i: usize, range: Interval) {
        self.lowest.as_mut_slice()[i] = range.lo;
        self.highest.as_mut_slice()[i] = range.hi;
    }
}

fn extended(old: Interval, new: Interval) -> Interval {
    let room = 0.5 * old.width();
    Interval::new(
        if new.lo < old.lo {
            new.lo - room
        } else {
            old.lo
        },
        if new.hi > old.hi {
            new.hi + room
        } else {
            old.hi
        },
    )
}
