//! The room of an expansion: where coefficients are kept, and which sums are taken together.

use std::collections::BTreeMap;

use dalembert::numbers::LENGTH;
use dalembert_codegen::program::Value as Place;
use dalembert_codegen::program::jet::History;
use dalembert_codegen::program::jet::terms::Term;

use crate::series::{Series, Step};

/// Vectors of sums that one loop takes.
const SIDE_BY_SIDE: usize = 8;

/// Where coefficients are kept.
#[derive(Debug)]
pub(super) struct Layout {
    /// Histories that are read one coefficient at a time, and their places in a row; of a large expansion all of them.
    pub(super) alone: BTreeMap<History, usize>,
    pub(super) groups: Vec<Group>,
    /// Places of a row.
    pub(super) width: usize,
}

/// Sums that are taken together.
#[derive(Debug)]
pub(super) struct Group {
    pub(super) sums: Vec<Sum>,
    /// Where the first factors lie in a row, and the second ones; of halves both are the same.
    pub(super) places: [usize; 2],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
        if series.is_large {
            return Self {
                alone: series.histories.clone(),
                groups: Vec::new(),
                width: 0,
            };
        }
        let mut alone = BTreeMap::new();
        let mut sums: Vec<Sum> = Vec::new();
        for (_, step) in &series.steps {
            if let Step::Term(term) = step {
                collect(term, &mut sums, &mut alone);
            }
        }
        let mut width = alone.len().next_multiple_of(2);
        let mut groups = Vec::new();
        for is_half in [true, false] {
            let kind: Vec<Sum> = sums
                .iter()
                .copied()
                .filter(|sum| sum.is_half() == is_half)
                .collect();
            for sums in kind.chunks(2 * SIDE_BY_SIDE) {
                let count = sums.len().next_multiple_of(2);
                let second = if is_half { width } else { width + count };
                groups.push(Group {
                    sums: sums.to_vec(),
                    places: [width, second],
                });
                width = second + count;
            }
        }
        Self {
            alone,
            groups,
            width,
        }
    }

    /// Numbers of the room.
    pub(super) fn room(&self) -> usize {
        match self.width {
            0 => self.alone.len() * LENGTH,
            width => width * LENGTH,
        }
    }
}

/// Adds the sums of a term, and what it reads one coefficient at a time.
fn collect(term: &Term, sums: &mut Vec<Sum>, alone: &mut BTreeMap<History, usize>) {
    let mut keep = |history: History| {
        let place = alone.len();
        alone.entry(history).or_insert(place);
    };
    term.walk(&mut |term| match term {
        Term::Middle(a, b) if !sums.contains(&Sum::Middle(*a, *b)) => {
            sums.push(Sum::Middle(*a, *b));
        }
        Term::Half(a) if !sums.contains(&Sum::Half(*a)) => sums.push(Sum::Half(*a)),
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
