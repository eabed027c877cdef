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
    /// Places of the order-0 coefficients of each history: one for each sum that it is a factor of.
    pub(super) places: BTreeMap<History, Vec<usize>>,
    /// The histories that are read one coefficient at a time, from their first places.
    pub(super) alone: BTreeSet<History>,
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

/// Blocks of sums. Those of a block are computed together, in SIMD lanes; the blocks have the same number of vectors.
#[derive(Debug)]
pub(super) struct Group {
    pub(super) blocks: Vec<Vec<Sum>>,
    /// Places of the order-0 coefficients of the first and of the second factors of the first block. For half sums both
    /// are the same.
    pub(super) places: [usize; 2],
    /// First frame slot of the results of the first block.
    pub(super) results: usize,
    /// First frame slot of the sums of the following order, without their ends, of the first block. `None` for half sums.
    pub(super) following: Option<usize>,
}

impl Group {
    /// Number of sums of a block, a multiple of [`LANES`].
    pub(super) fn width(&self) -> usize {
        self.blocks[0].len().next_multiple_of(LANES)
    }

    /// Distances between consecutive blocks: in a row, and in the frame.
    pub(super) fn distances(&self) -> [usize; 2] {
        let width = self.width();
        match self.following {
            None => [width; 2],
            Some(_) => [2 * width; 2],
        }
    }

    pub(super) fn is_half(&self) -> bool {
        self.following.is_none()
    }

    /// The sums, with the places of the order-0 coefficients of their factors, and with the frame slots of their results.
    fn places_of_sums(&self) -> impl Iterator<Item = (Sum, Vec<(History, usize)>, usize)> {
        let [in_row, in_frame] = self.distances();
        let count = if self.is_half() { 1 } else { 2 };
        let blocks = self.blocks.iter().enumerate();
        blocks.flat_map(move |(block, sums)| {
            sums.iter().enumerate().map(move |(i, sum)| {
                let places = self.places.map(|place| place + block * in_row + i);
                let factors = sum.factors().into_iter().zip(places).take(count);
                (*sum, factors.collect(), self.results + block * in_frame + i)
            })
        })
    }
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

    fn is_half(self) -> bool {
        matches!(self, Self::Half(_))
    }
}

impl Layout {
    pub(super) fn of(series: &Series) -> Self {
        let (mut sums, mut alone) = (BTreeSet::new(), BTreeSet::new());
        for (_, step) in &series.steps {
            if let Step::Term(term) = step {
                collect(term, &mut sums, &mut alone);
            }
        }
        let (mut width, mut frame) = (0, FIXED);
        let mut groups = Vec::new();
        for is_half in [true, false] {
            let kind = sums.iter().copied();
            let kind: Vec<Sum> = kind.filter(|sum| sum.is_half() == is_half).collect();
            let most = LANES * SIDE_BY_SIDE;
            let (full, rest) = kind.split_at(kind.len() / most * most);
            for sums in [full, rest].into_iter().filter(|sums| !sums.is_empty()) {
                let count = sums.len().min(most).next_multiple_of(LANES);
                let group = Group {
                    blocks: sums.chunks(most).map(<[Sum]>::to_vec).collect(),
                    places: [width, if is_half { width } else { width + count }],
                    results: frame,
                    following: (!is_half).then_some(frame + count),
                };
                let [in_row, in_frame] = group.distances();
                width += group.blocks.len() * in_row;
                frame += group.blocks.len() * in_frame;
                groups.push(group);
            }
        }
        let mut places = BTreeMap::<History, Vec<usize>>::new();
        let mut results = BTreeMap::new();
        for group in &groups {
            for (sum, factors, result) in group.places_of_sums() {
                results.insert(sum, result);
                for (history, place) in factors {
                    places.entry(history).or_default().push(place);
                }
            }
        }
        for history in &alone {
            places.entry(*history).or_insert_with(|| {
                width += 1;
                vec![width - 1]
            });
        }
        let mut width = width.next_multiple_of(LANES);
        // Rows at distances that are multiples of a large power of two compete for the same lines of the cache.
        if width.is_multiple_of(CROWDED) {
            width += LINE;
        }
        Self {
            places,
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
fn collect(term: &Term, sums: &mut BTreeSet<Sum>, alone: &mut BTreeSet<History>) {
    term.walk(&mut |term| match term {
        Term::Middle(a, b) => {
            sums.insert(Sum::Middle(*a, *b));
        }
        Term::Half(a) => {
            sums.insert(Sum::Half(*a));
        }
        Term::Short(a, b, _) => {
            alone.extend([*a, *b]);
        }
        Term::Steady(a, b) => {
            alone.extend([a, b].map(|value| History::plain(*value)));
        }
        _ => {}
    });
}
