//! The stretches of a step that a search looks at, one after the other: about where a fall is expected, halved where they do not tell.

/// Where stretches end, in parts of the way to where a fall is expected: before it, and behind.
const BEFORE: f64 = 0.875;
const BEHIND: f64 = 1.125;

/// No stretches are chosen about falls that are expected within this part of the step: halves get there.
const NEAR: f64 = 1.0 / (1_u64 << 36) as f64;

/// The stretches of a search: a few that are chosen, parted into `2^depth` each.
#[derive(Debug)]
pub(super) struct Stretches {
    cuts: [f64; 4],
    /// The chosen one, and the number of the part of it.
    chosen: usize,
    index: u64,
    depth: u32,
}

impl Stretches {
    /// Of a part of the step, with cuts about where a fall is expected.
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

    /// How often the chosen stretch is halved here.
    pub(super) fn depth(&self) -> u32 {
        self.depth
    }

    /// The ends of the stretch to look at.
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

    /// Goes on behind the stretch. Returns false at the end.
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
