//! Extremals as a first-order model with resets. It passes through the same stages as a declared model.

use dalembert_expr::{Assumption as Known, ExprId, SymbolId};

use super::Extremals;
use crate::model::{
    Coordinate, DerivedSymbols, Extras, Initial, Lagrangian, Law, Model, Name, Output, Reset,
    Surface, Topology,
};
use crate::spec::ItemId;

/// Name of the output with `H*`.
pub const ENERGY: &str = "hamiltonian";

/// Name of the output with the terminal cost.
pub const TERMINAL: &str = "terminal";

/// Name of the component with the cost so far.
pub(super) const COST: &str = "cost";

/// The first-order model of the extremals of `model`, whose pool holds their expressions. Its coordinates are the
/// state, the costate and the cost so far; its surfaces are those of the model. Its outputs are the optimal inputs,
/// `H*`, the terminal cost, its gradient with respect to the state, the rows of its second derivative, and the minors
/// that are positive where the optimal inputs are a minimum.
pub fn extremal_model(mut model: Model, extremals: &Extremals) -> Model {
    let item = item_of(&model);
    let components = extremals.components.iter();
    let mut rates: Vec<ExprId> = components.clone().map(|it| it.rate).collect();
    rates.extend(components.map(|it| it.costate_rate));
    rates.push(extremals.running);
    let components = entries(&mut model, extremals);
    let resets = resets(&mut model, extremals);
    let outputs = outputs(&mut model, extremals, item);
    Parts {
        components,
        rates,
        resets,
        outputs,
    }
    .assembled(model)
}

/// Declaration to which the derived items refer: the cost.
pub(super) fn item_of(model: &Model) -> ItemId {
    model.cost.map_or(model.lagrangian.item, |cost| cost.item)
}

/// A component of a first-order model: its name, symbol and topology.
pub(super) type Entry = (String, SymbolId, Topology);

/// The component with the cost so far.
pub(super) fn cost(model: &mut Model) -> Entry {
    let symbol = model.pool.symbol(COST, "J", Known::None);
    (COST.to_owned(), symbol, Topology::Line)
}

/// The parts of a first-order model that is derived from another model.
pub(super) struct Parts {
    /// The components of the state.
    pub components: Vec<Entry>,
    /// Their rates.
    pub rates: Vec<ExprId>,
    /// For each surface, the components after an impact; `None` for those that stay.
    pub resets: Vec<Vec<Option<ExprId>>>,
    /// The outputs.
    pub outputs: Vec<Output>,
}

impl Parts {
    /// The first-order model. It takes over the pool of `model`, which holds its expressions.
    pub fn assembled(self, mut model: Model) -> Model {
        let item = item_of(&model);
        let coordinates = coordinates(&mut model, self.components, item);
        let count = coordinates.len();
        let derived = DerivedSymbols {
            momenta: momenta(&mut model, &coordinates),
            multipliers: Vec::new(),
            ..model.derived
        };
        let parameters = model.parameters.iter().filter(|it| !it.is_input);
        Model {
            parameters: parameters.cloned().collect(),
            extras: Extras {
                variations: true,
                ..Extras::default()
            },
            lagrangian: euclidean(&model, count, item),
            initial: initial(&model, count),
            surfaces: surfaces(&model, self.resets, count, item),
            coordinates,
            derived,
            field: Some(self.rates),
            constraints: Vec::new(),
            cost: None,
            forces: Vec::new(),
            frame: Vec::new(),
            outputs: self.outputs,
            scenes: Vec::new(),
            claims: Vec::new(),
            notes: Vec::new(),
            ..model
        }
    }
}

/// The name of the costate of a component.
pub(super) fn costate_name(component: &str) -> String {
    format!("costate_{component}")
}

/// State, costate and cost so far.
fn entries(model: &mut Model, extremals: &Extremals) -> Vec<Entry> {
    let components = extremals.components.iter();
    let states = components.clone().zip(topologies(model));
    let states = states.map(|(it, topology)| (it.name.clone(), it.state, topology));
    let costates = components.map(|it| (costate_name(&it.name), it.costate, Topology::Line));
    let mut entries: Vec<Entry> = states.chain(costates).collect();
    entries.push(cost(model));
    entries
}

/// The topologies of the coordinates, followed by lines.
pub(super) fn topologies(model: &Model) -> impl Iterator<Item = Topology> {
    let declared = model.coordinates.iter().map(|it| it.topology);
    declared.chain(core::iter::repeat(Topology::Line))
}

fn coordinates(model: &mut Model, entries: Vec<Entry>, item: ItemId) -> Vec<Coordinate> {
    let coordinate = |(display, q, topology): Entry| {
        let rate = format!("dot({display})");
        let latex = format!("\\dot{{{}}}", model.pool.symbol_latex(q));
        Coordinate {
            qdot: model.pool.symbol(&rate, &latex, Known::None),
            name: plain(display),
            documentation: Vec::new(),
            topology,
            q,
            item,
        }
    };
    entries.into_iter().map(coordinate).collect()
}

/// Symbols of momenta. A first-order model needs only their number.
fn momenta(model: &mut Model, coordinates: &[Coordinate]) -> Vec<SymbolId> {
    let names = coordinates
        .iter()
        .map(|it| format!("momentum({})", it.name.display));
    let names: Vec<String> = names.collect();
    let symbol = |name: &String| model.pool.symbol(name, name, Known::None);
    names.iter().map(symbol).collect()
}

/// The name of a coordinate or output that belongs to no family.
pub(super) fn plain(display: String) -> Name {
    Name {
        field: display.replace('.', "_"),
        display,
        member: None,
    }
}

/// State and costate after the impacts.
fn resets(model: &mut Model, extremals: &Extremals) -> Vec<Vec<Option<ExprId>>> {
    let states: Vec<SymbolId> = extremals.components.iter().map(|it| it.state).collect();
    let mut resets = Vec::new();
    for jump in &extremals.jumps {
        let multiplier = [(jump.multiplier, jump.epsilon)];
        let costate = model.pool.substitute_all(&jump.costate, &multiplier);
        let mut after = changes(model, &states, &jump.state);
        after.extend(costate.into_iter().map(Some));
        after.push(None);
        resets.push(after);
    }
    resets
}

/// The components after an impact, `None` for those that stay.
pub(super) fn changes(
    model: &mut Model,
    states: &[SymbolId],
    after: &[ExprId],
) -> Vec<Option<ExprId>> {
    let pairs = states.iter().zip(after);
    pairs
        .map(|(state, value)| (*value != model.pool.variable(*state)).then_some(*value))
        .collect()
}

/// The surfaces of the model, each with a reset.
fn surfaces(
    model: &Model,
    resets: Vec<Vec<Option<ExprId>>>,
    count: usize,
    item: ItemId,
) -> Vec<Surface> {
    let declared = model.surfaces.iter().cloned();
    let reset = |(surface, after): (Surface, Vec<Option<ExprId>>)| Surface {
        law: Law::Reset,
        reset: Some(Reset {
            q: after,
            qdot: vec![None; count],
            item,
        }),
        instantaneous: Vec::new(),
        ..surface
    };
    declared.zip(resets).map(reset).collect()
}

fn outputs(model: &mut Model, extremals: &Extremals, item: ItemId) -> Vec<Output> {
    let inputs = model.inputs().map(|(_, input)| input.name.display.clone());
    let inputs: Vec<String> = inputs.collect();
    let mut values: Vec<(String, ExprId)> = inputs
        .into_iter()
        .zip(extremals.optimal.iter().copied())
        .collect();
    values.push((ENERGY.to_owned(), extremals.hamiltonian));
    values.push((TERMINAL.to_owned(), extremals.terminal));
    let states = extremals.components.iter();
    let pool = &mut model.pool;
    let gradient = states
        .clone()
        .map(|it| (&it.name, pool.diff(extremals.terminal, it.state)));
    let gradient: Vec<(&String, ExprId)> = gradient.collect();
    values.extend(
        gradient
            .iter()
            .map(|(name, value)| (format!("{TERMINAL}_{name}"), *value)),
    );
    for (row, first) in &gradient {
        for column in states.clone() {
            let name = format!("{TERMINAL}_{row}_{}", column.name);
            values.push((name, pool.diff(*first, column.state)));
        }
    }
    let minors = extremals.minors.iter().enumerate();
    values.extend(minors.map(|(index, minor)| (format!("convexity_{}", index + 1), *minor)));
    let output = |(display, value)| Output {
        name: plain(display),
        documentation: Vec::new(),
        value,
        is_integral: false,
        item,
    };
    values.into_iter().map(output).collect()
}

/// The initial state of the model; costate and cost are 0.
fn initial(model: &Model, count: usize) -> Initial {
    let Initial { q, qdot, until } = model.initial.clone();
    let mut values = q;
    if !model.is_first_order() {
        values.extend(qdot);
    }
    values.resize(count, None);
    Initial {
        q: values,
        qdot: vec![None; count],
        until,
    }
}

/// The placeholder Lagrangian of a first-order model.
fn euclidean(model: &Model, count: usize, item: ItemId) -> Lagrangian {
    let [zero, one] = [model.pool.zero(), model.pool.one()];
    let row = |i: usize| {
        (0..count)
            .map(|j| if i == j { one } else { zero })
            .collect()
    };
    Lagrangian {
        whole: zero,
        metric: (0..count).map(row).collect(),
        linear: vec![zero; count],
        potential: zero,
        item,
    }
}
