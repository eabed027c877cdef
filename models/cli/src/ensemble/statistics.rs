//! Mean, standard deviation and extremes over all members, from exact sums. They do not depend on how members are divided.

use dalembert_driver::ensemble::exact::ExactSum;
use dalembert_driver::ensemble::row::{Columns, Field, OUTPUT, Row};

/// Exact sums of the energy and of the outputs at the ends of the runs.
pub struct Statistics {
    /// Names and positions of the columns.
    columns: Vec<(String, usize)>,
    sums: Vec<ExactSum>,
}

impl Statistics {
    /// No members, with rows of these columns.
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

    /// Adds a row. Numbers that are not finite, as of a member that was refused, do not count.
    pub fn add(&mut self, row: &Row) {
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
