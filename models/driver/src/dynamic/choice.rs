//! The best input of a state: it minimises the sum of the cost of a step and the least cost after it.

use super::lattice::{Lattice, ROUNDING};

/// The margin of a motion that does not reach the end of its step.
const LOST: f64 = -1.0;

/// The end of a motion over a step, with one of the inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// The state after the step.
    pub state: [f64; 2],
    /// The cost of the step; infinite if the motion does not reach the end of the step, NaN if it has no initial state.
    pub cost: f64,
    /// Number of impacts in the step.
    pub impacts: u32,
}

impl Move {
    /// The value if there is no initial state.
    pub const NOWHERE: Self = Self::without_end(f64::NAN);

    /// The value for a motion that does not reach the end of the step.
    pub const LOST: Self = Self::without_end(f64::INFINITY);

    const fn without_end(cost: f64) -> Self {
        Self {
            state: [f64::NAN; 2],
            cost,
            impacts: 0,
        }
    }
}

/// Least costs and margins of all nodes at one time.
#[derive(Debug, Clone, Default)]
pub struct Layer {
    /// The least costs from this time on.
    pub costs: Vec<f64>,
    /// The margins: the largest distance to the edges of the grid that motions can keep from this time on, in steps of
    /// the axes. Where the margin is negative, every motion leaves the grid, and the cost is the cost of a motion along
    /// its edge.
    pub margins: Vec<f64>,
}

impl Layer {
    /// The last layer, with the terminal costs.
    pub fn last(lattice: &Lattice, terminal: impl Fn([f64; 2]) -> f64) -> Self {
        let nodes = || (0..lattice.count()).map(|node| lattice.node(node));
        Self {
            costs: nodes().map(terminal).collect(),
            margins: nodes().map(|it| lattice.margin(it)).collect(),
        }
    }

    /// The least cost of a node; NaN if every motion from it leaves the grid.
    pub fn cost(&self, node: usize) -> f64 {
        match is_kept(self.margins[node]) {
            true => self.costs[node],
            false => f64::NAN,
        }
    }

    /// The interpolated least cost at a state; NaN if every motion leaves the grid.
    pub fn cost_at(&self, lattice: &Lattice, at: [f64; 2]) -> f64 {
        match is_kept(self.margin_at(lattice, at)) {
            true => lattice.between(&self.costs, at),
            false => f64::NAN,
        }
    }

    /// The margin at a state. Outside the grid, motions are assumed to continue as from the edge.
    fn margin_at(&self, lattice: &Lattice, at: [f64; 2]) -> f64 {
        let here = lattice.margin(at);
        let later = lattice.linear(&self.margins, at);
        match here < 0.0 {
            true => here + later.min(0.0),
            false => here.min(later),
        }
    }

    /// The margin of a motion that begins with this step.
    fn margin_after(&self, lattice: &Lattice, next: &Move) -> f64 {
        match next.cost.is_finite() {
            true => self.margin_at(lattice, next.state),
            false if next.cost.is_nan() => f64::NAN,
            false => LOST,
        }
    }
}

/// True if a motion with this margin stays on the grid.
fn is_kept(margin: f64) -> bool {
    margin >= -ROUNDING
}

/// The best input of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// The least cost; if every motion leaves the grid, the cost of the motion with the largest margin. NaN if there is
    /// no motion.
    pub cost: f64,
    /// The largest margin of the motions; negative if all of them leave the grid, NaN if there is no initial state.
    pub margin: f64,
    /// The position of the input on its axis, in steps; NaN if there is no motion.
    pub place: f64,
}

impl Choice {
    /// The index of the input of the axis that is closest to the best one.
    pub fn nearest(&self) -> Option<usize> {
        (!self.place.is_nan()).then(|| self.place.round() as usize)
    }
}

/// Chooses among motions with equally spaced inputs. `after` is the layer after the step.
///
/// Only motions that stay on the grid count. If there are none, only motions with the largest margin count.
///
/// The sum of costs may have its minimum between two inputs. If the motions of the best input and of its neighbours
/// have the same number of impacts, an interpolated motion at the minimum of the parabola through their sums is tried
/// as well.
pub fn choose(moves: &[Move], lattice: &Lattice, after: &Layer) -> Choice {
    let margins = moves.iter().map(|it| after.margin_after(lattice, it));
    let margin = margins.fold(f64::NAN, f64::max);
    let least = match is_kept(margin) {
        true => -ROUNDING,
        false => margin,
    };
    let sum = |it: &Move| match it.cost.is_finite() && after.margin_after(lattice, it) >= least {
        true => it.cost + lattice.between(&after.costs, it.state),
        false => f64::NAN,
    };
    let Some(Best { index, sums }) = Best::of(moves.iter().map(sum)) else {
        return Choice {
            cost: f64::NAN,
            margin,
            place: f64::NAN,
        };
    };
    let best = &moves[index];
    let choice = |cost, place| Choice {
        cost,
        margin,
        place,
    };
    let around = index
        .checked_sub(1)
        .and_then(|from| moves.get(from..from + 3));
    let is_alike = |around: &&[Move]| around.iter().all(|it| it.impacts == best.impacts);
    let shift = vertex(sums);
    let between = around.filter(is_alike).map(|it| between(it, shift));
    match between.map(|it| sum(&it)).filter(|cost| *cost < sums[1]) {
        Some(cost) => choice(cost, index as f64 + shift),
        None => choice(sums[1], index as f64),
    }
}

/// The least of several numbers, with its neighbours.
struct Best {
    index: usize,
    sums: [f64; 3],
}

impl Best {
    /// `None` if all numbers are NaN.
    fn of(numbers: impl Iterator<Item = f64>) -> Option<Self> {
        let mut best: Option<Self> = None;
        let mut before = f64::NAN;
        for (index, number) in numbers.enumerate() {
            match &mut best {
                Some(best) if number >= best.sums[1] || number.is_nan() => {
                    if index == best.index + 1 {
                        best.sums[2] = number;
                    }
                }
                None if number.is_nan() => {}
                _ => {
                    best = Some(Self {
                        index,
                        sums: [before, number, f64::NAN],
                    });
                }
            }
            before = number;
        }
        best
    }
}

/// The place of the minimum of a parabola through three equally spaced values, relative to the middle one; 0 if it has
/// no minimum.
fn vertex([before, middle, after]: [f64; 3]) -> f64 {
    let bend = before - 2.0 * middle + after;
    match bend > 0.0 {
        true => 0.5 * (before - after) / bend,
        false => 0.0,
    }
}

/// A motion interpolated between three motions with equally spaced inputs.
fn between(moves: &[Move], shift: f64) -> Move {
    let at = |value: &dyn Fn(&Move) -> f64| {
        let [before, middle, after] = [0, 1, 2].map(|index| value(&moves[index]));
        let bend = before - 2.0 * middle + after;
        middle + 0.5 * shift * (after - before + shift * bend)
    };
    Move {
        state: [0, 1].map(|index| at(&|it| it.state[index])),
        cost: at(&|it| it.cost),
        impacts: moves[1].impacts,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamic::Axis;

    fn lattice() -> Lattice {
        let axis = Axis {
            ends: [-2.0, 2.0],
            count: 9,
        };
        Lattice { axes: [axis; 2] }
    }

    /// Inputs `u` of -2, -1, .., 2 move the first component by `u/2`, at the cost `u^2`.
    fn moves(from: f64) -> Vec<Move> {
        let to = |u: i32| Move {
            state: [from + 0.5 * f64::from(u), 0.0],
            cost: f64::from(u * u),
            impacts: 0,
        };
        (-2..=2).map(to).collect()
    }

    fn layer(cost: impl Fn([f64; 2]) -> f64) -> Layer {
        Layer::last(&lattice(), cost)
    }

    #[test]
    fn the_best_input_lies_between_two_others() {
        let lattice = lattice();
        let after = layer(|[x, _]| 4.0 * x * x);
        // u^2 + 4 (x + u/2)^2 has its minimum 2 x^2 at u = -x.
        for x in [0.3, 0.8, -0.55] {
            let chosen = choose(&moves(x), &lattice, &after);
            assert!((chosen.place - (2.0 - x)).abs() < 1e-12, "{chosen:?}");
            assert!((chosen.cost - 2.0 * x * x).abs() < 1e-12, "{chosen:?}");
        }
    }

    #[test]
    fn a_cost_that_is_flat_beside_a_steep_one_gives_nothing_below_it() {
        let lattice = lattice();
        let after = layer(|[x, _]| 1e6 * x.min(0.0).powi(2));
        let chosen = choose(&moves(0.0), &lattice, &after);
        assert_eq!((chosen.cost, chosen.place), (0.0, 2.0));
    }

    #[test]
    fn motions_that_are_lost_or_differ_in_impacts_give_no_parabola() {
        let lattice = lattice();
        let mut some = moves(0.3);
        some[1].impacts = 1;
        let chosen = choose(&some, &lattice, &layer(|[x, _]| 4.0 * x * x));
        assert_eq!(chosen.place, 2.0);
        let flat = layer(|_| 0.0);
        let chosen = choose(&some, &lattice, &flat);
        assert_eq!((chosen.place, chosen.cost), (2.0, 0.0));
        some[2] = Move::LOST;
        let chosen = choose(&some, &lattice, &flat);
        assert_eq!((chosen.place, chosen.cost), (1.0, 1.0));
    }

    #[test]
    fn without_a_motion_there_is_no_cost() {
        let lattice = lattice();
        let flat = layer(|_| 0.0);
        let none = choose(&[Move::NOWHERE; 3], &lattice, &flat);
        assert!(none.cost.is_nan() && none.place.is_nan() && none.margin.is_nan());
        let lost = choose(&[Move::LOST; 3], &lattice, &flat);
        assert!(lost.cost.is_nan() && lost.margin == LOST);
    }

    #[test]
    fn of_motions_that_all_leave_the_grid_the_one_of_the_largest_margin_goes_on_along_the_edge() {
        let lattice = lattice();
        let after = layer(|[x, _]| x);
        // The motions end at 2.25, 2.75, .., beyond the edge 2. Steps are 0.5.
        let chosen = choose(&moves(3.25), &lattice, &after);
        assert_eq!((chosen.place, chosen.margin), (0.0, -0.5));
        assert_eq!(chosen.cost, 4.0 + 2.0);
        // A motion that stays is chosen, although it costs more than those that leave.
        let chosen = choose(&moves(2.9), &lattice, &after);
        assert_eq!(chosen.place, 0.0);
        assert!(chosen.margin > 0.0);
        assert!((chosen.cost - 5.9).abs() < 1e-12, "{chosen:?}");
    }
}
