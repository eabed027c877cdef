//! `H = p.f + l` is quadratic in the inputs, so `u* = -R^{-1}(d_u l + p.d_u f)`, with the derivatives at `u = 0` and
//! `R = d_u^2 l`.

use dalembert_expr::{Assumption, ExprId, Pool, SymbolId, Verdict};

use super::system::{System, dot};
use super::{Component, Extremals, Jump, Uncontrolled};
use crate::mechanics::inverse::{self, Matrix};
use crate::model::{Cost, Model};

/// The maximum principle between impacts.
pub(super) struct Principle {
    /// Symbols of the costate.
    pub costates: Vec<SymbolId>,
    /// Rates of the state at inputs 0.
    pub drift: Vec<ExprId>,
    /// `df/du`, a row for each input.
    pub actuation: Vec<Vec<ExprId>>,
    /// `H*`
    pub hamiltonian: ExprId,
    optimal: Vec<ExprId>,
    minors: Vec<ExprId>,
    running: ExprId,
    rates: Vec<ExprId>,
    costate_rates: Vec<ExprId>,
}

/// Derives the optimal input and the fields of state and costate.
pub(super) fn derive(
    model: &mut Model,
    system: &System,
    cost: Cost,
) -> Result<Principle, Uncontrolled> {
    let costates = costates(model, system);
    let pool = &mut model.pool;
    let actuation = actuation(pool, system, cost)?;
    let covector: Vec<ExprId> = costates.iter().map(|p| pool.variable(*p)).collect();
    let zero = pool.zero();
    let still: Vec<(SymbolId, ExprId)> = system.inputs.iter().map(|u| (*u, zero)).collect();
    let mut slopes = Vec::new();
    for (input, column) in system.inputs.iter().zip(&actuation) {
        let of_cost = pool.diff(cost.running, *input);
        let of_cost = pool.substitute(of_cost, &still);
        let of_work = dot(pool, &covector, column);
        slopes.push(pool.sum(&[of_cost, of_work]));
    }
    let curvature = curvature(pool, system, cost);
    let optimal = optimal(pool, cost, &curvature, &slopes)?;
    let chosen = system.inputs.iter().copied().zip(optimal.iter().copied());
    let chosen: Vec<(SymbolId, ExprId)> = chosen.collect();
    let work = dot(pool, &covector, &system.rates);
    let whole = pool.sum(&[work, cost.running]);
    // `dH/du` is 0 at the optimum, so the optimum is substituted after the differentiation with respect to the state.
    let costate_rates: Vec<ExprId> = system
        .states
        .iter()
        .map(|x| {
            let slope = pool.diff(whole, *x);
            pool.neg(slope)
        })
        .collect();
    Ok(Principle {
        drift: pool.substitute_all(&system.rates, &still),
        hamiltonian: pool.substitute(whole, &chosen),
        running: pool.substitute(cost.running, &chosen),
        rates: pool.substitute_all(&system.rates, &chosen),
        costate_rates: pool.substitute_all(&costate_rates, &chosen),
        minors: minors(pool, &curvature),
        costates,
        actuation,
        optimal,
    })
}

/// New symbols of the costate, printed `p_x`; `p_dot(x)` belongs to a velocity.
fn costates(model: &mut Model, system: &System) -> Vec<SymbolId> {
    let pool = &mut model.pool;
    let states = system.states.iter();
    states
        .map(|state| {
            let name = format!("p_{}", pool.symbol_name(*state));
            let latex = format!("p_{{{}}}", pool.symbol_latex(*state));
            pool.symbol(&name, &latex, Assumption::None)
        })
        .collect()
}

/// `df/du`, for rates that are affine in the inputs.
fn actuation(
    pool: &mut Pool,
    system: &System,
    cost: Cost,
) -> Result<Vec<Vec<ExprId>>, Uncontrolled> {
    let mut columns = Vec::new();
    for input in &system.inputs {
        let column: Vec<ExprId> = system.rates.iter().map(|f| pool.diff(*f, *input)).collect();
        let curved = column.iter().position(|entry| {
            pool.depends_on_any(*entry, &system.inputs) && pool.zero_test(*entry) != Verdict::Proved
        });
        if let Some(index) = curved {
            let text = format!(
                "the rate of `{}` is not affine in `{}`: the optimal input is not known in closed form",
                system.names[index],
                pool.symbol_name(*input)
            );
            let help = "let inputs enter forces and rates linearly";
            return Err(Uncontrolled::at(cost.item, text, help));
        }
        columns.push(column);
    }
    Ok(columns)
}

/// `R = d_u^2 l`
fn curvature(pool: &mut Pool, system: &System, cost: Cost) -> Matrix {
    let mut rows = Vec::new();
    for left in &system.inputs {
        let first = pool.diff(cost.running, *left);
        let row = system.inputs.iter().map(|right| pool.diff(first, *right));
        rows.push(row.collect());
    }
    rows
}

/// `-R^{-1} slopes`
fn optimal(
    pool: &mut Pool,
    cost: Cost,
    curvature: &Matrix,
    slopes: &[ExprId],
) -> Result<Vec<ExprId>, Uncontrolled> {
    let Some(inverse) = inverse::inverse_in_factors(pool, curvature) else {
        let text = "the second derivative of the running cost is too large to be inverted";
        let help = "let at most 4 inputs be multiplied with each other";
        return Err(Uncontrolled::at(cost.item, text, help));
    };
    let optimal = inverse.iter().map(|row| {
        let step = dot(pool, row, slopes);
        pool.neg(step)
    });
    Ok(optimal.collect())
}

/// Leading principal minors.
fn minors(pool: &mut Pool, matrix: &Matrix) -> Vec<ExprId> {
    let indices: Vec<usize> = (0..matrix.len()).collect();
    (1..=matrix.len())
        .map(|size| inverse::minor(pool, matrix, &indices[..size], &indices[..size]))
        .collect()
}

impl Principle {
    /// The whole maximum principle.
    pub fn extremals(self, system: &System, terminal: ExprId, jumps: Vec<Jump>) -> Extremals {
        let components = (0..system.states.len()).map(|index| Component {
            name: system.names[index].clone(),
            state: system.states[index],
            costate: self.costates[index],
            rate: self.rates[index],
            costate_rate: self.costate_rates[index],
        });
        Extremals {
            components: components.collect(),
            optimal: self.optimal,
            minors: self.minors,
            hamiltonian: self.hamiltonian,
            running: self.running,
            terminal,
            jumps,
        }
    }
}
