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
/// The sum may be least between two inputs. If the motions of the best one and its neighbours have the same number of impacts, the motion at
/// the least value of the parabola through their sums is tried too; it is interpolated.
pub fn choose(moves: &[Move], lattice: &Lattice, costs: &[f64], impacts: &[f64]) -> Choice {
    let sum = |it: &Move| match it.cost.is_nan() {
        true => f64::NAN,
        false => it.cost + lattice.between(costs, it.state),
    };
    let Some(Best { index, sums }) = Best::of(moves.iter().map(sum)) else {
        return Choice {
            cost: f64::NAN,
            place: f64::NAN,
            impacts: f64::NAN,
        };
    };
    let best = &moves[index];
    let choice = |cost, place| Choice {
        cost,
        place,
        impacts: f64::from(best.impacts) + lattice.linear(impacts, best.state),
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

/// The least of some numbers and those beside it.
struct Best {
    index: usize,
    sums: [f64; 3],
}

impl Best {
    /// `None` if all are unknown.
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

/// The place of the least value of a parabola through three equally spaced values, from the middle one; 0 if there is none.
fn vertex([before, middle, after]: [f64; 3]) -> f64 {
    let bend = before - 2.0 * middle + after;
    match bend > 0.0 {
        true => 0.5 * (before - after) / bend,
        false => 0.0,
    }
}

/// A motion between three with equally spaced inputs.
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
    fn a_cost_that_is_flat_beside_a_steep_one_gives_nothing_below_it() {
        let lattice = lattice();
        let costs: Vec<f64> = (0..lattice.count())
            .map(|it| 1e6 * lattice.node(it)[0].min(0.0).powi(2))
            .collect();
        let chosen = choose(&moves(0.0), &lattice, &costs, &costs);
        assert_eq!((chosen.cost, chosen.place), (0.0, 2.0));
    }

    #[test]
    fn motions_that_lead_nowhere_or_differ_in_impacts_give_no_parabola() {
        let lattice = lattice();
        let costs = vec![0.0; lattice.count()];
        let mut some = moves(0.3);
        some[1].impacts = 1;
        let parabola: Vec<f64> = (0..lattice.count())
            .map(|it| 4.0 * lattice.node(it)[0].powi(2))
            .collect();
        let chosen = choose(&some, &lattice, &parabola, &costs);
        assert_eq!(chosen.place, 2.0);
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
