//! A rectangular grid of nodes, and interpolation between them.
//!
//! Values are interpolated by weighted parabolas (WENO of fourth order; Carlini, Ferretti, Russo 2005). Between two
//! nodes, one parabola uses the node before, the other the node after. For smooth values, the weights combine them into
//! a cubic. At a kink, they leave out the parabola across it. A least cost has kinks at states from which two different
//! motions cost the same.

/// Number added to the squares of second differences, as a fraction of their sum.
const FLOOR: f64 = 1e-6;

/// Distance outside the grid that counts as rounding, in steps.
pub(super) const ROUNDING: f64 = 1e-9;

/// Equally spaced values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// The first and the last value.
    pub ends: [f64; 2],
    /// Number of values, at least 2.
    pub count: usize,
}

impl Axis {
    /// The value at an index.
    pub fn value(&self, index: usize) -> f64 {
        let [first, last] = self.ends;
        match index + 1 == self.count {
            true => last,
            false => first + (last - first) * (index as f64 / (self.count - 1) as f64),
        }
    }

    /// The distance between two neighbouring values.
    pub fn step(&self) -> f64 {
        (self.ends[1] - self.ends[0]) / (self.count - 1) as f64
    }

    /// The index below a value, and the fraction of a step above it. A value outside is moved to the nearer end.
    fn place(&self, value: f64) -> (usize, f64) {
        let steps = ((value - self.ends[0]) / self.step()).clamp(0.0, (self.count - 1) as f64);
        let index = (steps as usize).min(self.count - 2);
        (index, steps - index as f64)
    }

    /// The distance of a value to the nearer end, in steps; negative outside.
    fn margin(&self, value: f64) -> f64 {
        let [first, last] = self.ends;
        (value - first).min(last - value) / self.step()
    }
}

/// The nodes of a rectangular grid. The index of the second axis runs fastest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    /// Both axes.
    pub axes: [Axis; 2],
}

impl Lattice {
    /// Number of nodes.
    pub fn count(&self) -> usize {
        self.axes[0].count * self.axes[1].count
    }

    /// The coordinates of a node.
    pub fn node(&self, index: usize) -> [f64; 2] {
        let rows = self.axes[1].count;
        [
            self.axes[0].value(index / rows),
            self.axes[1].value(index % rows),
        ]
    }

    /// The distance of a place to the nearest edge, in steps of the axis orthogonal to that edge; negative outside.
    pub fn margin(&self, at: [f64; 2]) -> f64 {
        let [x, y] = [0, 1].map(|index| self.axes[index].margin(at[index]));
        x.min(y)
    }

    /// True for a place on the grid, up to rounding.
    pub fn contains(&self, at: [f64; 2]) -> bool {
        self.margin(at) >= -ROUNDING
    }

    /// The value at a place, interpolated by parabolas. Outside the grid, it is the value at the nearest place of the
    /// edge.
    ///
    /// Nodes without a value are NaN. The values of other nodes are extrapolated linearly to them. The result is NaN if
    /// no corner of the cell has a value.
    pub fn between(&self, values: &[f64], at: [f64; 2]) -> f64 {
        self.combined(values, at, parabolas)
    }

    /// Same as [`between`](Self::between), with linear interpolation.
    pub fn linear(&self, values: &[f64], at: [f64; 2]) -> f64 {
        self.combined(values, at, line)
    }

    fn combined(&self, values: &[f64], at: [f64; 2], along: impl Fn([f64; 4], f64) -> f64) -> f64 {
        if at.iter().any(|it| it.is_nan()) {
            return f64::NAN;
        }
        let [(i, a), (j, b)] = [0, 1].map(|index| self.axes[index].place(at[index]));
        let [columns, rows] = self.axes.map(|axis| axis.count);
        // Indices are shifted by one, so that none is negative.
        let value = |i: usize, j: usize| match (1..=columns).contains(&i) && (1..=rows).contains(&j)
        {
            true => values[(i - 1) * rows + j - 1],
            false => f64::NAN,
        };
        let column = |i: usize| {
            let four = [0, 1, 2, 3].map(|k| value(i, j + k));
            along(four, b)
        };
        along([0, 1, 2, 3].map(|k| column(i + k)), a)
    }
}

/// The value at a fraction between the second and the third of four values. NaN stands for a missing value.
fn parabolas(values: [f64; 4], s: f64) -> f64 {
    let [before, first, last, after] = values;
    if first.is_nan() || last.is_nan() {
        return continued(values, s);
    }
    let bend = [before - 2.0 * first + last, first - 2.0 * last + after];
    let r = s - 1.0;
    let left = first + 0.5 * s * (last - before + s * bend[0]);
    let right = last + 0.5 * r * (after - first + r * bend[1]);
    match bend.map(f64::is_nan) {
        [true, true] => first + s * (last - first),
        [true, false] => right,
        [false, true] => left,
        [false, false] => {
            let squares = bend.map(|it| it * it);
            let floor = FLOOR * (squares[0] + squares[1]) + f64::MIN_POSITIVE;
            let [small, large] = squares.map(|it| {
                let it = it + floor;
                it * it
            });
            // The weights (2 - s)/small and (1 + s)/large, times `small large`.
            let weights = [(2.0 - s) * large, (1.0 + s) * small];
            let sum = weights[0] + weights[1];
            match sum > 0.0 {
                true => (weights[0] * left + weights[1] * right) / sum,
                // Both parabolas are lines.
                false => 0.5 * (left + right),
            }
        }
    }
}

fn line(values: [f64; 4], s: f64) -> f64 {
    let [_, first, last, _] = values;
    match first.is_nan() || last.is_nan() {
        true => continued(values, s),
        false => first + s * (last - first),
    }
}

/// Linear extrapolation from the known side if the second or the third of four values is missing.
fn continued([before, first, last, after]: [f64; 4], s: f64) -> f64 {
    let slope = |rise: f64| if rise.is_nan() { 0.0 } else { rise };
    match first.is_nan() {
        true => last + (s - 1.0) * slope(after - last),
        false => first + s * slope(first - before),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(count: usize) -> Lattice {
        let axis = |ends| Axis { ends, count };
        Lattice {
            axes: [axis([0.0, 2.0]), axis([-1.0, 1.0])],
        }
    }

    fn sampled(lattice: &Lattice, f: impl Fn([f64; 2]) -> f64) -> Vec<f64> {
        (0..lattice.count()).map(|it| f(lattice.node(it))).collect()
    }

    /// Largest error on a fine set of places within the lattice.
    fn error(count: usize, f: impl Fn([f64; 2]) -> f64 + Copy) -> f64 {
        let lattice = lattice(count);
        let values = sampled(&lattice, f);
        let places = (0..400).map(|k| {
            let t = f64::from(k) / 400.0;
            [0.3 + 1.4 * t, -0.7 + 1.4 * (7.3 * t).fract()]
        });
        places.fold(0.0, |most: f64, at| {
            most.max((lattice.between(&values, at) - f(at)).abs())
        })
    }

    #[test]
    fn parabolas_are_met_and_smooth_values_are_of_fourth_order() {
        let parabola = |[x, y]: [f64; 2]| 3.0 * x * x - x * y + 2.0 * y * y - 1.0;
        assert!(error(9, parabola) < 1e-13);
        let wave = |[x, y]: [f64; 2]| (1.0 + x).exp() * (0.5 * y).cos();
        let errors = [21, 41, 81].map(|count| error(count, wave));
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!(order > 3.5, "{errors:?}");
        }
    }

    #[test]
    fn an_edge_does_not_reach_further_than_its_cell() {
        let edge = |[x, _]: [f64; 2]| (1.03 - x).abs();
        let lattice = lattice(21);
        let values = sampled(&lattice, edge);
        for x in [0.85, 0.97, 0.995, 1.105, 1.19] {
            let found = lattice.between(&values, [x, 0.013]);
            assert!((found - edge([x, 0.0])).abs() < 1e-6, "{x}: {found}");
        }
    }

    #[test]
    fn known_values_are_continued_to_unknown_nodes() {
        let lattice = lattice(5);
        let plane = |[x, y]: [f64; 2]| 1.0 + 2.0 * x - y;
        let mut values = sampled(&lattice, plane);
        values[12] = f64::NAN;
        let [x, y] = lattice.node(12);
        for at in [[x + 0.1, y - 0.1], [x - 0.3, y], [x, y + 0.2], [x, y]] {
            for value in [lattice.between(&values, at), lattice.linear(&values, at)] {
                assert!((value - plane(at)).abs() < 1e-14, "{at:?}: {value}");
            }
        }
        assert!(lattice.between(&values, [f64::NAN, 0.0]).is_nan());
        values.fill(f64::NAN);
        assert!(lattice.linear(&values, [x, y]).is_nan());
    }

    #[test]
    fn places_outside_have_the_value_at_the_edge_and_a_negative_margin() {
        let lattice = lattice(5);
        let values = sampled(&lattice, |[x, y]| 3.0 * x + y);
        assert_eq!(lattice.linear(&values, [2.5, 0.25]), 6.25);
        assert_eq!(lattice.margin([2.5, 0.25]), -1.0);
        assert_eq!(lattice.margin([1.5, -0.75]), 0.5);
        assert_eq!(lattice.margin([2.0, 0.0]), 0.0);
    }
}
