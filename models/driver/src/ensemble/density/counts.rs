//! Counts of states in cells. They are integers, so that the order of additions does not matter.
//!
//! A density has converged if it agrees with the densities of half of the states, of a quarter and so on. For this
//! comparison, every state belongs to one class by its time and to another class by its member. Class 0 is the later
//! half of all states, class 1 the later half of the rest, and so on; the last class is the remainder. Members are
//! assigned to classes alternately, so that the halves of a grid of members are spread over the whole grid.

use std::io::{self, Read, Write};

use super::Density;

/// The number of classes.
pub const CLASSES: usize = 6;

/// Number of visits that are kept individually before equal ones are merged.
const LOOSE: usize = 1 << 16;

/// The class of the state with this index among `count` states.
fn class_of_time(index: u64, count: u64) -> usize {
    let doubled = |class: &usize| (index << (class + 1)) >= count;
    (0..CLASSES - 1).find(doubled).unwrap_or(CLASSES - 1)
}

/// The class of a member.
fn class_of_member(member: u64) -> usize {
    (member.trailing_zeros() as usize).min(CLASSES - 1)
}

/// Visits of one member.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Visits {
    samples: u64,
    /// Number of cells, including the one for states outside the grid.
    cells: usize,
    /// Class of time and cell as one number, and the number of visits.
    list: Vec<(usize, u64)>,
    /// Number of merged entries at the start of the list.
    folded: usize,
}

impl Visits {
    /// No visits.
    pub fn new(density: &Density) -> Self {
        Self {
            samples: density.samples,
            cells: density.cells() + 1,
            ..Self::default()
        }
    }

    /// Adds a visit of a cell by the state with this index.
    pub fn push(&mut self, index: u64, cell: usize) {
        let class = class_of_time(index, self.samples);
        self.list.push((class * self.cells + cell, 1));
        if self.list.len() >= self.folded + LOOSE {
            self.fold();
        }
    }

    /// Merges equal visits.
    pub fn fold(&mut self) {
        self.list.sort_unstable();
        self.list.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1 += next.1;
            }
            same
        });
        self.folded = self.list.len();
    }
}

/// Visits of all members, by class.
#[derive(Debug, Clone, PartialEq)]
pub struct Counts {
    /// Number of cells, including the one for states outside the grid.
    cells: usize,
    /// Counts of all cells for each class of time, then for each class of members.
    counts: Vec<u64>,
}

impl Counts {
    /// Counts of 0.
    pub fn new(density: &Density) -> Self {
        let cells = density.cells() + 1;
        Self {
            cells,
            counts: vec![0; 2 * CLASSES * cells],
        }
    }

    /// Adds the visits of a member.
    pub fn add(&mut self, member: u64, visits: &Visits) {
        let of_member = (CLASSES + class_of_member(member)) * self.cells;
        for &(place, count) in &visits.list {
            self.counts[place] += count;
            self.counts[of_member + place % self.cells] += count;
        }
    }

    /// Adds the counts of other members for the same density.
    pub fn merge(&mut self, others: &Self) {
        let pairs = self.counts.iter_mut().zip(&others.counts);
        pairs.for_each(|(sum, count)| *sum += count);
    }

    /// The counts of a class of time, one per cell; the last one counts states outside the grid.
    pub fn of_time(&self, class: usize) -> &[u64] {
        &self.counts[class * self.cells..][..self.cells]
    }

    /// The counts of a class of members.
    pub fn of_members(&self, class: usize) -> &[u64] {
        self.of_time(CLASSES + class)
    }

    /// The counts of all states inside the grid.
    pub fn total(&self) -> Vec<u64> {
        let mut total = vec![0; self.cells - 1];
        for class in 0..CLASSES {
            let counts = total.iter_mut().zip(self.of_time(class));
            counts.for_each(|(sum, count)| *sum += count);
        }
        total
    }

    /// Number of states outside the grid.
    pub fn outside(&self) -> u64 {
        (0..CLASSES)
            .map(|class| self.of_time(class)[self.cells - 1])
            .sum()
    }

    /// Writes the counts.
    ///
    /// # Errors
    /// An I/O error of the stream.
    pub fn write(&self, output: &mut dyn Write) -> io::Result<()> {
        let mut counts = self.counts.iter();
        counts.try_for_each(|count| output.write_all(&count.to_le_bytes()))
    }

    /// Replaces the counts by those that [`write`](Self::write) wrote for the same density.
    ///
    /// # Errors
    /// An I/O error of the stream.
    pub fn read(&mut self, input: &mut dyn Read) -> io::Result<()> {
        let mut bytes = [0; 8];
        for count in &mut self.counts {
            input.read_exact(&mut bytes)?;
            *count = u64::from_le_bytes(bytes);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_halve_what_remains() {
        let sizes = |class: fn(u64) -> usize| {
            let mut sizes = [0; CLASSES];
            (0..64).for_each(|index| sizes[class(index)] += 1);
            sizes
        };
        assert_eq!(
            sizes(|index| class_of_time(index, 64)),
            [32, 16, 8, 4, 2, 2]
        );
        assert_eq!(sizes(class_of_member), [32, 16, 8, 4, 2, 2]);
        assert_eq!(class_of_time(0, 1), CLASSES - 1);
    }

    #[test]
    fn putting_visits_together_loses_none() {
        let mut visits = Visits {
            samples: 200_000,
            cells: 3,
            ..Visits::default()
        };
        for index in 0..200_000 {
            visits.push(index, (index % 3) as usize);
        }
        assert!(visits.list.len() < LOOSE + 3 * CLASSES);
        visits.fold();
        assert_eq!(visits.list.len(), 3 * CLASSES);
        let mut counts = Counts {
            cells: 3,
            counts: vec![0; 6 * CLASSES],
        };
        counts.add(5, &visits);
        assert_eq!(counts.total(), [66_667, 66_667]);
        assert_eq!(counts.outside(), 66_666);
        assert_eq!(counts.of_members(0).iter().sum::<u64>(), 200_000);

        let mut bytes = Vec::new();
        counts.write(&mut bytes).expect("memory takes everything");
        let mut back = Counts {
            cells: 3,
            counts: vec![0; 6 * CLASSES],
        };
        back.read(&mut bytes.as_slice())
            .expect("as many as were written");
        assert_eq!(back, counts);
    }
}
