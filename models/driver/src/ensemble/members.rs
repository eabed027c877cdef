//! The members of an ensemble, with the values of their varied quantities.

use super::values::{Draw, Quantity, Values};

/// All members of the ensemble.
#[derive(Debug, Clone)]
pub struct Members {
    names: Vec<String>,
    quantities: Vec<Quantity>,
    source: Source,
    count: u64,
}

/// Source of the values of members.
#[derive(Debug, Clone)]
pub enum Source {
    /// Cartesian product of the values of all quantities. The last quantity runs fastest.
    Product {
        /// The values of each quantity.
        values: Vec<Values>,
        /// The seed of random values.
        seed: Option<u64>,
    },
    /// Values row by row.
    Listed {
        /// The rows.
        rows: Vec<f64>,
        /// The member of the first row.
        first: u64,
    },
}

impl Members {
    /// `count` members with random values, or with the combinations of the listed values.
    pub fn product(varied: Vec<(String, Quantity, Values)>, seed: Option<u64>, count: u64) -> Self {
        let (mut names, mut quantities, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for (name, quantity, its_values) in varied {
            names.push(name);
            quantities.push(quantity);
            values.push(its_values);
        }
        Self {
            names,
            quantities,
            source: Source::Product { values, seed },
            count,
        }
    }

    /// Members from a list with one row of values per member. The first row belongs to the member `first`.
    pub fn listed(named: Vec<(String, Quantity)>, rows: Vec<f64>, first: u64) -> Self {
        let count = first + (rows.len() / named.len().max(1)) as u64;
        let (names, quantities) = named.into_iter().unzip();
        Self {
            names,
            quantities,
            source: Source::Listed { rows, first },
            count,
        }
    }

    /// Number of members of the ensemble. For a list that is read in part, it counts the members up to its last row.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The names of the varied quantities.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The varied quantities.
    pub fn quantities(&self) -> &[Quantity] {
        &self.quantities
    }

    /// The source of the values.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// The values of a member, in the order of the quantities.
    ///
    /// # Panics
    /// If the members come from a list and the member has no row.
    pub fn values(&self, member: u64) -> Vec<f64> {
        let width = self.quantities.len();
        match &self.source {
            Source::Listed { rows, first } => {
                let begin = (member - first) as usize * width;
                rows[begin..begin + width].to_vec()
            }
            Source::Product { values, seed } => {
                let mut rest = member;
                let mut row: Vec<f64> = (0..width)
                    .rev()
                    .map(|quantity| {
                        let count = values[quantity].count();
                        let index = rest % count;
                        rest /= count;
                        let draw = Draw {
                            seed: seed.unwrap_or(0),
                            member,
                            quantity: quantity as u32,
                        };
                        values[quantity].value(index, draw)
                    })
                    .collect();
                row.reverse();
                row
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_run_through_the_last_first() {
        let spaced = Values::Spaced {
            ends: [0.0, 1.0],
            count: 3,
        };
        let varied = vec![
            ("x".to_owned(), Quantity::Position(0), spaced),
            (
                "e".to_owned(),
                Quantity::Parameter(2),
                Values::List(vec![5.0, 7.0]),
            ),
        ];
        let members = Members::product(varied, None, 6);
        let rows: Vec<_> = (0..6).map(|member| members.values(member)).collect();
        assert_eq!(
            rows,
            [
                [0.0, 5.0],
                [0.0, 7.0],
                [0.5, 5.0],
                [0.5, 7.0],
                [1.0, 5.0],
                [1.0, 7.0]
            ]
        );
    }

    #[test]
    fn rows_of_a_part_of_a_list_belong_to_its_members() {
        let named = vec![("x".to_owned(), Quantity::Position(0))];
        let members = Members::listed(named, vec![0.5, 0.25], 7);
        assert_eq!([members.values(7), members.values(8)], [[0.5], [0.25]]);
        assert_eq!(members.count(), 9);
    }
}
