//! Memory layout of an expansion: places of the coefficients, and groups of sums that are computed together.

use std::collections::{BTreeMap, BTreeSet};

use dalembert::numbers::LENGTH;
use dalembert_codegen::program::Value as Place;
use dalembert_codegen::program::jet::History;
use dalembert_codegen::program::jet::terms::Term;

use super::assembly::{LANES, SIDE_BY_SIDE};
use crate::series::{Series, Step};

/// Frame slot of the last order of the loop, an integer.
pub(super) const LAST: usize = 0;
/// Frame slot of the current order, a double.
pub(super) const WEIGHT: usize = 1;
/// Frame slot of the unit of time.
pub(super) const UNIT: usize = 2;
const FIXED: usize = 3;

/// Number of doubles in a line of the cache.
const LINE: usize = 8;
/// Distance between rows, in numbers, at whose multiples a series of many orders exceeds the lines of the cache that its rows
/// share.
const CROWDED: usize = 256;

/// Places of coefficients in the room.
#[derive(Debug)]
pub(super) struct Layout {
    /// Place of the order-0 coefficient of each history that is read one coefficient at a time.
    pub(super) alone: BTreeMap<History, usize>,
    pub(super) groups: Vec<Group>,
    /// Frame slots of the sums.
    results: BTreeMap<Sum, usize>,
    /// Distance between consecutive orders, in numbers.
    pub(super) stride: usize,
    /// Length of the frame, in numbers.
    pub(super) frame: usize,
    /// Length of the room, in numbers.
    pub(super) room: usize,
}

/// Sums that are computed together, in SIMD lanes.
#[derive(Debug)]
pub(super) struct Group {
    pub(super) sums: Vec<Sum>,
    /// Places of the order-0 coefficients of the first and of the second factors. For half sums both are the same.
    pub(super) places: [usize; 2],
    /// First frame slot of the results.
    pub(super) results: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Sum {
    Half(Place),
    Middle(History, History),
}

impl Sum {
    pub(super) fn factors(self) -> [History; 2] {
        match self {
            Self::Half(a) => [History::plain(a); 2],
            Self::Middle(a, b) => [a, b],
        }
    }

    pub(super) fn is_half(self) -> bool {
        matches!(self, Self::Half(_))
    }
}

impl Layout {
    pub(super) fn of(series: &Series) -> Self {
        let mut alone = BTreeMap::new();
        let mut sums = BTreeSet::new();
        for (_, step) in &series.steps {
            if let Step::Term(term) = step {
                collect(term, &mut sums, &mut alone);
            }
        }
        let mut width = alone.len().next_multiple_of(LANES);
        let mut frame = FIXED;
        let mut groups = Vec::new();
        let mut results = BTreeMap::new();
        for is_half in [true, false] {
            let kind: Vec<Sum> = sums
                .iter()
                .copied()
                .filter(|sum| sum.is_half() == is_half)
                .collect();
            for sums in kind.chunks(LANES * SIDE_BY_SIDE) {
                let count = sums.len().next_multiple_of(LANES);
                let second = if is_half { width } else { width + count };
                results.extend(sums.iter().copied().zip(frame..));
                groups.push(Group {
                    sums: sums.to_vec(),
                    places: [width, second],
                    results: frame,
                });
                width = second + count;
                frame += count;
            }
        }
        // Rows at distances that are multiples of a large power of two compete for the same lines of the cache.
        if width.is_multiple_of(CROWDED) {
            width += LINE;
        }
        Self {
            alone,
            groups,
            results,
            stride: width,
            frame,
            room: width * LENGTH,
        }
    }

    /// Frame slot of a sum.
    pub(super) fn result(&self, sum: Sum) -> usize {
        self.results[&sum]
    }
}

/// Collects the sums of a term, and the histories that it reads one coefficient at a time.
fn collect(term: &Term, sums: &mut BTreeSet<Sum>, alone: &mut BTreeMap<History, usize>) {
    let mut keep = |history: History| {
        let place = alone.len();
        alone.entry(history).or_insert(place);
    };
    term.walk(&mut |term| match term {
        Term::Middle(a, b) => {
            sums.insert(Sum::Middle(*a, *b));
        }
        Term::Half(a) => {
            sums.insert(Sum::Half(*a));
        }
        Term::Short(a, b, _) => {
            keep(*a);
            keep(*b);
        }
        Term::Steady(a, b) => {
            keep(History::plain(*a));
            keep(History::plain(*b));
        }
        _ => {}
    });
}
