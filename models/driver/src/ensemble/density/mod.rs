//! Long-run densities: states at equally spaced times, counted on a grid of cells over two quantities.
//!
//! The densities of Clark and Bloch (Figures 7 and 8) are those of `x,y:100` and `x,y:200` with `--every 1 --until
//! 1e6`.

mod convergence;
mod counts;
mod sampler;

pub use convergence::{Checkpoint, convergence};
pub use counts::{Counts, Visits};
pub use sampler::Sampler;

use std::f64::consts::{PI, TAU};

use dalembert::describe::{Description, Topology};

use crate::model::Point;
use crate::names::{self, Unknown};

/// Quantity of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// A coordinate, by index.
    Position(usize),
    /// A velocity.
    Velocity(usize),
    /// A declared output.
    Output(usize),
    /// The energy.
    Energy,
}

impl Shown {
    /// The value of the quantity at a point.
    pub fn value(self, point: &Point) -> f64 {
        match self {
            Self::Position(index) => point.q[index],
            Self::Velocity(index) => point.qdot[index],
            Self::Output(index) => point.outputs[index],
            Self::Energy => point.energy,
        }
    }
}

/// Largest number of cells along an axis.
pub const MOST_BINS: usize = 1000;

/// Axis of the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The name of the quantity.
    pub name: String,
    /// The quantity.
    pub shown: Shown,
    /// True if values that differ by a full turn are the same.
    pub is_circle: bool,
    /// The ends of the axis. The upper end belongs to no cell.
    pub range: [f64; 2],
    /// The number of cells along the axis.
    pub bins: usize,
}

impl Axis {
    /// The axis of a coordinate, a velocity, an output or `energy`. The default range is a full turn for an angle, else
    /// the finite chart of the coordinate, else NaN for an unknown range.
    ///
    /// # Errors
    /// [`Unknown`] if no quantity has this name.
    pub fn named(
        name: &str,
        range: Option<[f64; 2]>,
        bins: usize,
        description: &Description,
    ) -> Result<Self, Unknown> {
        let mut all = shown(description);
        let accepted = all.iter().map(|(name, _)| name.as_str());
        let index = names::find("coordinate, velocity or output", name, accepted)?;
        let (name, shown) = all.swap_remove(index);
        let topology = match shown {
            Shown::Position(index) => description.coordinates[index].topology,
            _ => Topology::Line,
        };
        let known = match topology {
            Topology::Circle => [-PI, PI],
            Topology::Interval { low, high } if low.is_finite() && high.is_finite() => [low, high],
            _ => [f64::NAN; 2],
        };
        Ok(Self {
            name,
            shown,
            is_circle: topology == Topology::Circle,
            range: range.unwrap_or(known),
            bins,
        })
    }

    /// The cell along the axis that contains a value.
    fn bin(&self, value: f64) -> Option<usize> {
        let [low, high] = self.range;
        let value = match self.is_circle {
            true => low + (value - low).rem_euclid(TAU),
            false => value,
        };
        let part = (value - low) / (high - low);
        // Rounding must not give an index after the last cell.
        (0.0..1.0)
            .contains(&part)
            .then(|| ((part * self.bins as f64) as usize).min(self.bins - 1))
    }

    /// The lower end of a cell; for `bins` the upper end of the last cell.
    pub fn edge(&self, bin: usize) -> f64 {
        let [low, high] = self.range;
        let part = bin as f64 / self.bins as f64;
        low * (1.0 - part) + high * part
    }
}

/// A grid, and the times at which the state of a member is counted.
#[derive(Debug, Clone, PartialEq)]
pub struct Density {
    /// The axes.
    pub axes: [Axis; 2],
    /// Time between two states.
    pub every: f64,
    /// Time before the first counted state.
    pub discard: f64,
    /// Number of states of a member whose run reaches its end.
    pub samples: u64,
}

impl Density {
    /// The number of cells.
    pub fn cells(&self) -> usize {
        self.axes[0].bins * self.axes[1].bins
    }

    /// The index of the cell of a state. The first axis runs fastest. A state outside the grid has the index one past
    /// the last cell.
    pub fn cell(&self, point: &Point) -> usize {
        let [x, y] = &self.axes;
        let bins = x.bin(x.shown.value(point)).zip(y.bin(y.shown.value(point)));
        bins.map_or(self.cells(), |(i, j)| j * x.bins + i)
    }

    /// The area of a cell.
    pub fn cell_area(&self) -> f64 {
        let sides = self.axes.each_ref();
        let sides = sides.map(|axis| (axis.range[1] - axis.range[0]) / axis.bins as f64);
        sides[0] * sides[1]
    }
}

/// The number of states at `discard + every`, `discard + 2 every`, .. up to `until`. A quotient within rounding of an
/// integer counts as that integer.
pub fn count_samples(discard: f64, every: f64, until: f64) -> u64 {
    let count = (until - discard) / every;
    (count * (1.0 + 4.0 * f64::EPSILON)).floor().max(0.0) as u64
}

/// Quantities of axes, by name. Of two quantities with the same name the first is used.
fn shown(description: &Description) -> Vec<(String, Shown)> {
    let coordinates = names::coordinates(description).enumerate();
    let positions = coordinates
        .clone()
        .map(|(index, name)| (name.to_owned(), Shown::Position(index)));
    let velocities =
        coordinates.map(|(index, name)| (names::velocity(name), Shown::Velocity(index)));
    let outputs = description.outputs.iter().enumerate();
    let outputs = outputs.map(|(index, name)| ((*name).to_owned(), Shown::Output(index)));
    positions
        .chain(velocities)
        .chain(outputs)
        .chain([("energy".to_owned(), Shown::Energy)])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(range: [f64; 2], is_circle: bool) -> Axis {
        Axis {
            name: "x".to_owned(),
            shown: Shown::Position(0),
            is_circle,
            range,
            bins: 4,
        }
    }

    #[test]
    fn values_lie_in_the_cell_they_lie_in() {
        let line = axis([-1.0, 1.0], false);
        let cases = [
            (-1.0, Some(0)),
            (-0.5, Some(1)),
            (0.999, Some(3)),
            (1.0, None),
            (-1.1, None),
            (f64::NAN, None),
        ];
        for (value, bin) in cases {
            assert_eq!(line.bin(value), bin, "{value}");
        }
        assert_eq!([line.edge(0), line.edge(2), line.edge(4)], [-1.0, 0.0, 1.0]);
        let half = TAU / 2.0;
        let circle = axis([-half, half], true);
        assert_eq!(circle.bin(-0.1), circle.bin(TAU - 0.1));
        assert_eq!(circle.bin(half), Some(0));
        for turn in -20..20 {
            assert!(circle.bin(f64::from(turn) * half).is_some());
        }
    }

    #[test]
    fn whole_numbers_of_samples_survive_rounding() {
        assert_eq!(count_samples(0.0, 0.1, 0.3), 3);
        assert_eq!(count_samples(0.5, 1.0, 10.0), 9);
        assert_eq!(count_samples(5.0, 1.0, 2.0), 0);
    }
}
