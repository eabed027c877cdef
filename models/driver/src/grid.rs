//! Equally spaced times.

/// `count` equally spaced times from 0 to `end`, both included; the time 0 alone if `count` is 1.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    /// The last time.
    pub end: f64,
    /// The number of times.
    pub count: u64,
}

impl Grid {
    /// The time of this index; `None` past the last.
    pub fn time(&self, index: u64) -> Option<f64> {
        let last = self.count.checked_sub(1)?;
        match index {
            0 => Some(0.0),
            _ if index < last => Some(self.end * (index as f64 / last as f64)),
            _ => (index == last).then_some(self.end),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(grid: Grid) -> Vec<f64> {
        (0..).map_while(|index| grid.time(index)).collect()
    }

    #[test]
    fn a_grid_holds_both_ends_exactly() {
        assert_eq!(times(Grid { end: 0.3, count: 4 }).len(), 4);
        assert_eq!(times(Grid { end: 0.3, count: 4 }).last(), Some(&0.3));
        assert_eq!(times(Grid { end: 2.0, count: 3 }), [0.0, 1.0, 2.0]);
    }

    #[test]
    fn short_grids() {
        assert!(times(Grid { end: 2.0, count: 0 }).is_empty());
        assert_eq!(times(Grid { end: 2.0, count: 1 }), [0.0]);
        assert_eq!(times(Grid { end: 2.0, count: 2 }), [0.0, 2.0]);
    }
}
