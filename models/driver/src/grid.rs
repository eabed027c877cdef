//! Equally spaced times, and ranges that contain values.

/// `count` equally spaced times from 0 to `end`, both included; the time 0 alone if `count` is 1.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    /// The last time.
    pub end: f64,
    /// The number of times.
    pub count: u64,
}

impl Grid {
    /// The time at this index; `None` past the last.
    pub fn time(&self, index: u64) -> Option<f64> {
        let last = self.count.checked_sub(1)?;
        match index {
            0 => Some(0.0),
            _ if index < last => Some(self.end * (index as f64 / last as f64)),
            _ => (index == last).then_some(self.end),
        }
    }
}

/// A range that contains the values with a margin of `room` times their range on both sides. The range of a constant
/// has the size of its absolute value, at least 1.
pub fn padded(values: impl Iterator<Item = f64>, room: f64) -> [f64; 2] {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
    let (middle, half) = (0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low);
    // A smaller range is the rounding error of a constant, or too small for ticks.
    let is_constant = half <= 1e-12 * middle.abs() || half < 1e-200;
    let half = if is_constant {
        0.5 * middle.abs().max(1.0)
    } else {
        half * (1.0 + 2.0 * room)
    };
    [middle - half, middle + half]
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

    #[test]
    fn ranges_are_never_empty() {
        for values in [
            vec![],
            vec![0.0],
            vec![3.0, 3.0],
            vec![1e300, -1e300],
            vec![5e-324, 0.0],
        ] {
            let [low, high] = padded(values.iter().copied(), 0.05);
            assert!(
                low < high && low.is_finite() && high.is_finite(),
                "{values:?}"
            );
        }
    }
}
