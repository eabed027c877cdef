//! A path of least cost: a motion whose input minimises, in each step, the cost of the step plus the least cost after it.

use dalembert_driver::{Extremal, Hit, Landing, Layer, choose};

use super::problem::{Problem, moved};
use super::solution::Solution;
use crate::args::ControlArgs;
use crate::entry::Entry;
use crate::error::CliError;

/// A moment of a path.
#[derive(Debug, Clone, Copy)]
pub struct Moment {
    /// The time.
    pub t: f64,
    /// The state.
    pub state: [f64; 2],
    /// The input.
    pub input: f64,
    /// The cost so far.
    pub cost: f64,
}

/// The cheapest extremal from the start of a path.
pub enum Compared {
    /// Not compared yet.
    Not,
    /// The extremal.
    Best(Box<Extremal>),
    /// None was found, for this reason.
    None(String),
}

/// A path.
pub struct Path {
    /// The least cost from its start, interpolated on the grid.
    pub expected: f64,
    /// Both ends of each step.
    pub moments: Vec<Moment>,
    /// The impacts.
    pub hits: Vec<Hit>,
    /// Its cost; NaN if it leaves the grid.
    pub cost: f64,
    /// The time at which it leaves the grid.
    pub left: Option<f64>,
    /// The comparison with extremals.
    pub compared: Compared,
}

impl Path {
    /// Follows the path from a state.
    ///
    /// # Errors
    /// A model that refuses to run.
    pub fn follow(
        problem: &Problem,
        solution: &Solution,
        from: [f64; 2],
    ) -> Result<Self, CliError> {
        let mut path = Self {
            expected: solution.layers[0].cost_at(&problem.lattice, from),
            moments: Vec::new(),
            hits: Vec::new(),
            cost: 0.0,
            left: None,
            compared: Compared::Not,
        };
        if path.expected.is_nan() {
            return Ok(path.leaving(problem.at(0)));
        }
        let mut state = from;
        for k in 0..problem.steps {
            let Some((input, landing)) = step(problem, &solution.layers[k + 1], k, state)? else {
                return Ok(path.leaving(problem.at(k)));
            };
            let moment = |t, state, cost| Moment {
                t,
                state,
                input,
                cost,
            };
            path.moments.push(moment(problem.at(k), state, path.cost));
            path.cost += landing.cost;
            state = landing.state;
            path.moments
                .push(moment(problem.at(k + 1), state, path.cost));
            path.hits.extend(landing.hits);
        }
        path.cost += problem.terminal(state);
        Ok(path)
    }

    fn leaving(self, t: f64) -> Self {
        Self {
            cost: f64::NAN,
            left: Some(t),
            ..self
        }
    }

    /// Searches for the cheapest extremal from the same start.
    ///
    /// # Errors
    /// Invalid flags of the search.
    pub fn compare(&mut self, models: &[Entry], args: &ControlArgs) -> Result<(), CliError> {
        let Some(first) = self.moments.first() else {
            return Ok(());
        };
        self.compared = match super::super::cheapest(models, args, first.state)? {
            Ok(extremal) => Compared::Best(Box::new(extremal)),
            Err(reason) => Compared::None(reason),
        };
        Ok(())
    }

    /// The last state.
    pub fn end(&self) -> Option<[f64; 2]> {
        self.moments.last().map(|it| it.state)
    }
}

/// The best input at a state, with its motion over the step: the interpolated input, or the best input of the grid if
/// that costs less. `None` if both motions leave the grid.
///
/// Interpolated margins have errors: a motion along an edge of the grid may have a negative margin and still stay on
/// the grid. Therefore the states decide, not the margins.
fn step(
    problem: &Problem,
    after: &Layer,
    k: usize,
    state: [f64; 2],
) -> Result<Option<(f64, Landing)>, CliError> {
    let values = problem.input_values();
    let run = |inputs: &[f64]| {
        let landings = problem.model.legs(&problem.leg(k, inputs), &[state]);
        let landings = landings.map_err(|it| CliError::refused(problem.model.as_ref(), &it));
        landings.map(Option::unwrap_or_default)
    };
    let mut landings = run(&values)?;
    let moves: Vec<_> = landings.iter().map(|it| moved(it.as_ref())).collect();
    let chosen = choose(&moves, &problem.lattice, after);
    let Some(nearest) = chosen.nearest() else {
        return Ok(None);
    };
    let input = problem.input(chosen.place);
    let between = run(&[input])?.pop().and_then(Result::ok);
    let of_grid = landings.swap_remove(nearest).ok();
    let pair = [(input, between), (values[nearest], of_grid)];
    let pair = pair
        .into_iter()
        .filter_map(|(input, it)| Some((input, it?)))
        .filter(|(_, it)| problem.lattice.contains(it.state));
    let sum =
        |landing: &Landing| landing.cost + problem.lattice.between(&after.costs, landing.state);
    Ok(pair.min_by(|(_, left), (_, right)| sum(left).total_cmp(&sum(right))))
}
