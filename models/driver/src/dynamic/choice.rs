//! The best input of a state: the least of the sums of the cost of a step and the least cost after it.

use super::lattice::Lattice;

/// The end of a motion over a step, with one of the inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// The state after the step.
    pub state: [f64; 2],
    /// The cost of the step; NaN for a motion that does not get there.
    pub cost: f64,
    /// Number of impacts in it.
    pub impacts: u32,
}

impl Move {
    /// A motion that does not get to the end of the step.
    pub const NOWHERE: Self = Self {
        state: [f64::NAN; 2],
        cost: f64::NAN,
        impacts: 0,
    };
}

/// The best input of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// The least cost from here on; NaN if every motion leaves the grid.
    pub cost: f64,
    /// The place of the input, in steps of its axis.
    pub place: f64,
    /// Number of impacts of the motion from here on, interpolated.
    pub impacts: f64,
}

/// Chooses among motions with equally spaced inputs. `costs` and `impacts` are those after the step.
///
/// The sum is least at a place between two inputs: it is that of the parabola through the best input and its neighbours, if
/// their motions have the same number of impacts.
pub fn choose(moves: &[Move], lattice: &Lattice, costs: &[f64], impacts: &[f64]) -> Choice {
    let sum = |it: &Move| it.cost + lattice.between(costs, it.state);
    let mut best: Option<(usize, f64)> = None;
    let mut sums = [f64::NAN; 3];
    let mut before = f64::NAN;
    let mut is_next = false;
    for (index, it) in moves.iter().enumerate() {
        let value = match it.cost.is_nan() {
            true => f64::NAN,
            false => sum(it),
        };
        if is_next {
            sums[2] = value;
            is_next = false;
        }
        if !value.is_nan() && best.is_none_or(|(_, least)| value < least) {
            best = Some((index, value));
            sums = [before, value, f64::NAN];
            is_next = true;
        }
        before = value;
    }
    let Some((index, value)) = best else {
        return Choice {
            cost: f64::NAN,
            place: f64::NAN,
            impacts: f64::NAN,
        };
    };
    let around = index
        .checked_sub(1)
        .and_then(|from| moves.get(from..from + 3));
    let is_alike = around.is_some_and(|it| it.iter().all(|it| it.impacts == moves[index].impacts));
    let [shift, gain] = match is_alike {
        true => vertex(sums),
        false => [0.0, 0.0],
    };
    let after = lattice.linear(impacts, moves[index].state);
    Choice {
        cost: value - gain,
        place: index as f64 + shift,
        impacts: f64::from(moves[index].impacts) + after,
    }
}

/// The place of the least value of a parabola through three equally spaced values, of which the middle one is least, and how
/// much it lies below that.
fn vertex([before, middle, after]: [f64; 3]) -> [f64; 2] {
    let (bend, slope) = (before - 2.0 * middle + after, 0.5 * (after - before));
    match bend > 0.0 {
        true => [-slope / bend, 0.5 * slope * slope / bend],
        false => [0.0, 0.0],
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

    /// Inputs -2, -1, .., 2 move the first component by half of it, at the cost `u^2`.
    fn moves(from: f64) -> Vec<Move> {
        let to = |u: i32| Move {
            state: [from + 0.5 * f64::from(u), 0.0],
            cost: f64::from(u * u),
            impacts: 0,
        };
        (-2..=2).map(to).collect()
    }

    #[test]
    fn the_best_input_lies_between_two_others() {
        let lattice = lattice();
        let costs: Vec<f64> = (0..lattice.count())
            .map(|it| 4.0 * lattice.node(it)[0].powi(2))
            .collect();
        let impacts = vec![1.0; lattice.count()];
        // u^2 + 4 (x + u/2)^2 is least at u = -x, where it is 2 x^2.
        for x in [0.3, 0.8, -0.55] {
            let chosen = choose(&moves(x), &lattice, &costs, &impacts);
            assert!((chosen.place - (2.0 - x)).abs() < 1e-12, "{chosen:?}");
            assert!((chosen.cost - 2.0 * x * x).abs() < 1e-12, "{chosen:?}");
            assert_eq!(chosen.impacts, 1.0);
        }
    }

    #[test]
    fn motions_that_lead_nowhere_or_differ_in_impacts_give_no_parabola() {
        let lattice = lattice();
        let costs = vec![0.0; lattice.count()];
        let mut some = moves(0.3);
        some[1].impacts = 1;
        let chosen = choose(&some, &lattice, &costs, &costs);
        assert_eq!((chosen.place, chosen.cost), (2.0, 0.0));
        some[2] = Move::NOWHERE;
        let chosen = choose(&some, &lattice, &costs, &costs);
        assert_eq!((chosen.place, chosen.cost, chosen.impacts), (1.0, 1.0, 1.0));
        let none = choose(&[Move::NOWHERE; 3], &lattice, &costs, &costs);
        assert!(none.cost.is_nan() && none.place.is_nan());
        // All of these leave the grid.
        assert!(choose(&moves(9.0), &lattice, &costs, &costs).cost.is_nan());
    }
}
