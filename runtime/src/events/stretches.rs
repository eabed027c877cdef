//! The stretches of a step in the order of a search: cut near an expected fall, and halved where they are undecided.

/// Ends of stretches before and behind an expected fall, as fractions of the way to it.
const BEFORE: f64 = 0.875;
const BEHIND: f64 = 1.125;

/// An expected fall closer to the start than this fraction of the searched part gets no cuts, because halving reaches
/// it.
const NEAR: f64 = 1.0 / (1_u64 << 36) as f64;

/// Number of halvings from a region to the next smaller ones.
const HALVINGS: u32 = 8;

/// A part of the step that contains neighbouring stretches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Region {
    chosen: usize,
    depth: u32,
    index: u64,
}

/// The stretches of a search: a few between cuts, each divided into `2^depth` parts.
#[derive(Debug)]
pub(super) struct Stretches {
    cuts: [f64; 4],
    /// Index of the stretch between cuts.
    chosen: usize,
    /// Index of the present part of this stretch.
    index: u64,
    depth: u32,
}

impl Stretches {
    /// Stretches of a part of the step, with cuts near an expected fall.
    pub(super) fn of([from, until]: [f64; 2], expected: Option<f64>) -> Self {
        let at = |part: f64| match expected {
            Some(fall) if fall - from > NEAR * (until - from) => {
                (from + part * (fall - from)).min(until)
            }
            _ => until,
        };
        Self {
            cuts: [from, at(BEFORE), at(BEHIND), until],
            chosen: 0,
            index: 0,
            depth: 0,
        }
    }

    /// Number of halvings of the present stretch.
    pub(super) fn depth(&self) -> u32 {
        self.depth
    }

    /// The region of the present stretch. Regions become smaller after every [`HALVINGS`] halvings.
    pub(super) fn region(&self) -> Region {
        let halvings = self.depth % HALVINGS;
        Region {
            chosen: self.chosen,
            depth: self.depth - halvings,
            index: self.index >> halvings,
        }
    }

    /// The ends of the present stretch.
    pub(super) fn ends(&self) -> [f64; 2] {
        let [from, until] = [self.cuts[self.chosen], self.cuts[self.chosen + 1]];
        let count = (1_u64 << self.depth) as f64;
        let end = |index: u64| {
            if index as f64 == count {
                until
            } else {
                from + (until - from) * (index as f64 / count)
            }
        };
        [end(self.index), end(self.index + 1)]
    }

    /// Halves the stretch; its first half comes next.
    pub(super) fn halve(&mut self) {
        (self.index, self.depth) = (2 * self.index, self.depth + 1);
    }

    /// Advances to the next stretch. Returns false at the end.
    pub(super) fn advance(&mut self) -> bool {
        self.index += 1;
        while self.index.is_multiple_of(2) && self.depth > 0 {
            (self.index, self.depth) = (self.index / 2, self.depth - 1);
        }
        if self.depth > 0 {
            return true;
        }
        self.index = 0;
        loop {
            self.chosen += 1;
            match self.cuts.get(self.chosen..self.chosen + 2) {
                None => return false,
                Some(&[from, until]) if until > from => return true,
                Some(_) => {}
            }
        }
    }
}
