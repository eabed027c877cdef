//! A model whose inputs are held, as a first-order model for dynamic programming:
//!
//! ```text
//! xdot = f(t, x, u),  udot = 0,  Jdot = l(t, x, u)            x+ = Delta(t, x)
//! ```
//!
//! `x` is the state of the model, `u` are its inputs, `J` is the running cost so far, and `Delta` is the map of an
//! impact.

use dalembert_expr::ExprId;

use super::model::{Entry, Parts, changes, cost, item_of, plain, topologies};
use super::system::{self, System};
use super::{TERMINAL, Uncontrolled};
use crate::model::{Cost, Model, Output, Topology};

/// A model whose inputs are constant components, between the state and the cost so far. Its only output is the terminal
/// cost.
#[derive(Debug)]
pub struct Held {
    /// The first-order model.
    pub model: Model,
    /// Number of inputs.
    pub inputs: usize,
    /// True if motion, impacts and running cost do not depend on time. The terminal cost may.
    pub is_autonomous: bool,
}

/// Makes the first-order model of a checked model with a cost.
///
/// # Errors
/// The first declaration that prevents it.
pub fn held_model(mut model: Model) -> Result<Held, Uncontrolled> {
    let Some(cost_of) = model.cost else {
        return Err(Uncontrolled::without_cost(&model));
    };
    let system = system::of(&mut model)?;
    let is_autonomous = is_autonomous(&model, &system, cost_of);
    let resets: Vec<Vec<Option<ExprId>>> = (system.impacts.iter())
        .map(|impact| {
            let mut after = changes(&mut model, &system.states, &impact.map);
            after.resize(system.states.len() + system.inputs.len() + 1, None);
            after
        })
        .collect();
    let zero = model.pool.zero();
    let mut rates = system.rates.clone();
    rates.extend(system.inputs.iter().map(|_| zero));
    rates.push(cost_of.running);
    let terminal = Output {
        name: plain(TERMINAL.to_owned()),
        documentation: Vec::new(),
        value: cost_of.terminal,
        is_integral: false,
        item: item_of(&model),
    };
    let parts = Parts {
        components: entries(&mut model, &system),
        rates,
        resets,
        outputs: vec![terminal],
    };
    Ok(Held {
        model: parts.assembled(model),
        inputs: system.inputs.len(),
        is_autonomous,
    })
}

/// State, inputs and cost so far.
fn entries(model: &mut Model, system: &System) -> Vec<Entry> {
    let states = system.names.iter().cloned().zip(&system.states);
    let states = states.zip(topologies(model));
    let mut entries: Vec<Entry> = states
        .map(|((name, symbol), topology)| (name, *symbol, topology))
        .collect();
    let inputs = model.inputs();
    entries.extend(inputs.map(|(_, it)| (it.name.display.clone(), it.symbol, Topology::Line)));
    entries.push(cost(model));
    entries
}

fn is_autonomous(model: &Model, system: &System, cost: Cost) -> bool {
    let depends = |id: &ExprId| model.pool.depends_on(*id, model.time);
    let maps = system.impacts.iter().flat_map(|impact| &impact.map);
    let gaps = model.surfaces.iter().map(|surface| &surface.gap);
    let conditions = model
        .surfaces
        .iter()
        .flat_map(|surface| &surface.conditions);
    let mut all = system.rates.iter().chain(maps).chain(gaps);
    !(all.any(depends) || depends(&cost.running) || conditions.map(|it| &it.margin).any(depends))
}
