//! A table of measurements, printed with aligned columns or as CSV.

use std::fmt;

/// Rows of cells under a head.
#[derive(Debug, Clone)]
pub struct Table {
    head: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

/// Layout of a printed table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// Columns aligned to the right, two spaces between them.
    Aligned,
    /// Cells separated by commas.
    Csv,
}

impl Layout {
    /// CSV if `--csv` is among the arguments of the program.
    pub fn from_arguments() -> Self {
        match std::env::args().any(|argument| argument == "--csv") {
            true => Self::Csv,
            false => Self::Aligned,
        }
    }
}

impl Table {
    /// An empty table.
    pub fn new<const COLUMNS: usize>(head: [&'static str; COLUMNS]) -> Self {
        Self {
            head: head.to_vec(),
            rows: Vec::new(),
        }
    }

    /// Adds a row, one cell for each column.
    ///
    /// # Panics
    /// If the number of cells is not the number of columns.
    pub fn push<const COLUMNS: usize>(&mut self, row: [String; COLUMNS]) {
        assert_eq!(COLUMNS, self.head.len());
        self.rows.push(row.to_vec());
    }

    /// Prints the table.
    pub fn print(&self, layout: Layout) {
        print!("{}", Printed(self, layout));
    }

    /// All lines, the head first.
    fn lines(&self) -> impl Iterator<Item = Vec<&str>> {
        let rows = self
            .rows
            .iter()
            .map(|row| row.iter().map(String::as_str).collect());
        std::iter::once(self.head.clone()).chain(rows)
    }

    fn widths(&self) -> Vec<usize> {
        let mut widths = vec![0; self.head.len()];
        for line in self.lines() {
            for (width, cell) in widths.iter_mut().zip(line) {
                *width = cell.len().max(*width);
            }
        }
        widths
    }
}

struct Printed<'a>(&'a Table, Layout);

impl fmt::Display for Printed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(table, layout) = self;
        if *layout == Layout::Csv {
            return table
                .lines()
                .try_for_each(|line| writeln!(f, "{}", line.join(",")));
        }
        let widths = table.widths();
        for line in table.lines() {
            let cells = line.iter().zip(&widths);
            let aligned: Vec<String> = cells
                .map(|(cell, width)| format!("{cell:>width$}"))
                .collect();
            writeln!(f, "{}", aligned.join("  "))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_stand_under_their_heads() {
        let mut table = Table::new(["tol", "error"]);
        table.push(["1e-4".into(), "2e-6".into()]);
        assert_eq!(
            Printed(&table, Layout::Aligned).to_string(),
            " tol  error\n1e-4   2e-6\n"
        );
        assert_eq!(
            Printed(&table, Layout::Csv).to_string(),
            "tol,error\n1e-4,2e-6\n"
        );
    }
}
