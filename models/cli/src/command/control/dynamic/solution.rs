//! The least cost at all nodes, computed backwards in time. Threads share the nodes.

use std::convert::Infallible;
use std::ops::Range;

use dalembert_driver::{AnyModel, Choice, Layer, Move, choose};

use super::problem::{Problem, moved};
use crate::ensemble::pool::{Division, in_order};
use crate::error::CliError;
use crate::progress::Stages;

/// Largest number of nodes that a thread takes at once.
const BLOCK: u64 = 64;

/// The least cost at all times, and the best inputs and impacts at one of them.
pub struct Solution {
    /// The least costs at the start of each step, and at the end.
    pub layers: Vec<Layer>,
    /// The step whose nodes are shown.
    pub step: usize,
    /// The best input at each node at the start of this step.
    pub inputs: Vec<f64>,
    /// The number of impacts of the best motion from each node at the start of this step, interpolated.
    pub impacts: Vec<f64>,
    /// Number of computed motions over a step, and number of those among them that do not reach its end.
    pub motions: [usize; 2],
}

impl Solution {
    /// Solves a problem. Inputs and impacts are kept for the step nearest to the time `shown`; default 0.
    ///
    /// # Errors
    /// A time outside of the steps.
    pub fn of(problem: &Problem, shown: Option<f64>, terminal: bool) -> Result<Self, CliError> {
        let step = shown_step(problem, shown)?;
        let count = problem.lattice.count();
        let mut layers = vec![Layer::default(); problem.steps + 1];
        layers[problem.steps] = Layer::last(&problem.lattice, |state| problem.terminal(state));
        let mut solution = Self {
            layers,
            step,
            inputs: vec![f64::NAN; count],
            impacts: vec![0.0; count],
            motions: [0; 2],
        };
        let mut stages = Stages::new(terminal);
        let (mut moves, mut impacts) = (Vec::new(), vec![0.0; count]);
        for k in (0..problem.steps).rev() {
            let done = problem.steps - 1 - k;
            stages.at(done, problem.steps, &format!("t = {:.4}", problem.at(k)));
            if moves.is_empty() || !problem.is_autonomous {
                moves = motions(problem, k);
                let lost = moves.iter().filter(|it| !it.cost.is_finite()).count();
                solution.motions[0] += moves.len();
                solution.motions[1] += lost;
            }
            let after = &solution.layers[k + 1];
            let (chosen, numbers) = backwards(problem, &moves, after, &impacts);
            impacts = numbers;
            if k == step {
                solution.impacts.clone_from(&impacts);
                let inputs = chosen.iter().map(|it| match it.place.is_nan() {
                    true => f64::NAN,
                    false => problem.input(it.place),
                });
                solution.inputs = inputs.collect();
            }
            solution.layers[k] = Layer {
                costs: chosen.iter().map(|it| it.cost).collect(),
                margins: chosen.iter().map(|it| it.margin).collect(),
            };
        }
        stages.finish();
        Ok(solution)
    }

    /// Number of nodes from which some motion stays on the grid from the start to the end.
    pub fn known(&self) -> usize {
        let layer = &self.layers[0];
        let nodes = 0..layer.costs.len();
        nodes.filter(|node| !layer.cost(*node).is_nan()).count()
    }

    /// Least cost, best input and number of impacts of a node at the time that is shown; NaN where every motion leaves
    /// the grid.
    pub fn shown(&self, node: usize) -> [f64; 3] {
        let layer = &self.layers[self.step];
        let cost = layer.cost(node);
        match cost.is_nan() {
            true => [f64::NAN; 3],
            false => [cost, self.inputs[node], self.impacts[node]],
        }
    }
}

fn shown_step(problem: &Problem, shown: Option<f64>) -> Result<usize, CliError> {
    let time = shown.unwrap_or(0.0);
    match (0.0..=problem.time).contains(&time) {
        true => Ok((time / problem.time * problem.steps as f64).round() as usize),
        false => Err(CliError::value(
            "--at",
            time.to_string(),
            format!("a time from 0 to {}", problem.time),
        )),
    }
}

/// The motions over a step from all nodes, with all inputs.
fn motions(problem: &Problem, step: usize) -> Vec<Move> {
    let inputs = problem.input_values();
    let leg = problem.leg(step, &inputs);
    let (builder, lattice) = (&problem.builder, problem.lattice);
    let work = |model: &mut Option<Box<dyn AnyModel>>, nodes: Range<u64>| {
        let from: Vec<[f64; 2]> = nodes.map(|node| lattice.node(node as usize)).collect();
        let landings = model
            .as_ref()
            .and_then(|model| model.legs(&leg, &from).ok()?);
        match landings {
            Some(landings) => landings
                .chunks(inputs.len())
                .map(|of_node| of_node.iter().map(|it| moved(it.as_ref())).collect())
                .collect(),
            None => vec![vec![Move::NOWHERE; inputs.len()]; from.len()],
        }
    };
    shared(problem, || builder.built().ok(), work).concat()
}

/// A step backwards: the choices at the nodes, and the numbers of impacts from the start of the step on.
fn backwards(
    problem: &Problem,
    moves: &[Move],
    after: &Layer,
    impacts: &[f64],
) -> (Vec<Choice>, Vec<f64>) {
    let (inputs, lattice) = (problem.inputs.count, problem.lattice);
    let work = |(): &mut (), nodes: Range<u64>| {
        let chosen = nodes.map(|node| {
            let first = node as usize * inputs;
            let moves = &moves[first..first + inputs];
            let choice = choose(moves, &lattice, after);
            let best = choice.nearest().map(|index| moves[index]);
            let number = best.map_or(f64::NAN, |best| {
                f64::from(best.impacts) + lattice.linear(impacts, best.state)
            });
            (choice, number)
        });
        chosen.collect()
    };
    shared(problem, || (), work).into_iter().unzip()
}

/// The results of all nodes, in their order.
fn shared<W, T: Send>(
    problem: &Problem,
    prepare: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, Range<u64>) -> Vec<T> + Sync,
) -> Vec<T> {
    let nodes = problem.lattice.count() as u64;
    let mut all = Vec::with_capacity(nodes as usize);
    let division = Division::new(nodes, problem.threads, BLOCK);
    let done = in_order(0..nodes, division, prepare, work, |_, some| {
        all.extend(some);
        Ok::<(), Infallible>(())
    });
    match done {
        Ok(()) => all,
    }
}
