//! Mean, standard deviation and extremes over the members that are not behind a surface, from exact sums. They do not depend on the division of the
//! members among threads and shards.

use dalembert_driver::ensemble::exact::ExactSum;
use dalembert_driver::ensemble::row::{Columns, Field, OUTPUT, Row, is_behind};

/// Exact sums of the energy and of the outputs at the ends of the runs.
pub struct Statistics {
    /// Names and positions of the columns.
    columns: Vec<(String, usize)>,
    sums: Vec<ExactSum>,
}

impl Statistics {
    /// Statistics without members, for rows with these columns.
    pub fn new(columns: &Columns) -> Self {
        let named = columns.iter().enumerate();
        let is_summed = |name: &str| name == "energy" || name.starts_with(OUTPUT);
        let columns: Vec<(String, usize)> = named
            .filter(|(_, (name, _))| is_summed(name))
            .map(|(place, (name, _))| (name.to_owned(), place))
            .collect();
        Self {
            sums: vec![ExactSum::default(); columns.len()],
            columns,
        }
    }

    /// Adds a row. Members behind a surface do not count, nor do numbers that are not finite, as of members
    /// that are refused.
    pub fn add(&mut self, row: &Row) {
        if is_behind(row) {
            return;
        }
        for ((_, place), sum) in self.columns.iter().zip(&mut self.sums) {
            if let Some(Field::Number(value)) = row.get(*place) {
                sum.add(*value);
            }
        }
    }

    /// Names of the columns, with their sums.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &ExactSum)> {
        let names = self.columns.iter().map(|(name, _)| name.as_str());
        names.zip(&self.sums)
    }
}
