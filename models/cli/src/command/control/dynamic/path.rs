//! A path of least cost: a motion whose input is chosen in each step by the least cost after it.

use dalembert_driver::{Extremal, Hit, choose};

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
    /// There was no comparison yet.
    Not,
    /// The extremal.
    Best(Box<Extremal>),
    /// There is none, for this reason.
    None(String),
}

/// A path.
pub struct Path {
    /// The least cost of its start by the grid.
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
            expected: problem.lattice.between(&solution.costs[0], from),
            moments: Vec::new(),
            hits: Vec::new(),
            cost: 0.0,
            left: None,
            compared: Compared::Not,
        };
        let mut state = from;
        for k in 0..problem.steps {
            let Some((input, landing)) = step(problem, &solution.costs[k + 1], k, state)? else {
                path.left = Some(problem.at(k));
                path.cost = f64::NAN;
                return Ok(path);
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

    /// Searches the cheapest extremal from the same start.
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

/// The best input of a state and its motion: the one between the inputs of the grid, unless the best of those is better.
fn step(
    problem: &Problem,
    after: &[f64],
    k: usize,
    state: [f64; 2],
) -> Result<Option<(f64, dalembert_driver::Landing)>, CliError> {
    let values = problem.input_values();
    let run = |inputs: &[f64]| {
        let landings = problem.model.legs(&problem.leg(k, inputs), &[state]);
        let landings = landings.map_err(|it| CliError::refused(problem.model.as_ref(), &it));
        landings.map(Option::unwrap_or_default)
    };
    let mut landings = run(&values)?;
    let moves: Vec<_> = landings.iter().map(|it| moved(it.as_ref())).collect();
    let nothing = vec![0.0; after.len()];
    let chosen = choose(&moves, &problem.lattice, after, &nothing);
    if chosen.place.is_nan() {
        return Ok(None);
    }
    let nearest = chosen.place.round() as usize;
    let input = problem.input(chosen.place);
    let between = run(&[input])?.pop().flatten();
    let sum = |landing: &dalembert_driver::Landing| {
        landing.cost + problem.lattice.between(after, landing.state)
    };
    let of_grid = landings.swap_remove(nearest);
    let pair = [(input, between), (values[nearest], of_grid)];
    let pair = pair
        .into_iter()
        .filter_map(|(input, it)| Some((input, it?)));
    let pair = pair.filter(|(_, it)| !sum(it).is_nan());
    Ok(pair.min_by(|(_, left), (_, right)| sum(left).total_cmp(&sum(right))))
}
