//! A model as a first-order system: `xdot = f(t, x, u)` and `x+ = Delta(t, x)`. The state of a Lagrangian model is
//! `(q, qdot)`, with `qddot = g^{-1}(force - drift)` (`mechanics/field.rs`).

use dalembert_expr::{ExprId, Pool, SymbolId, Verdict};

use super::Uncontrolled;
use crate::mechanics::inverse::{self, Matrix};
use crate::mechanics::{Derivation, derive};
use crate::model::{Law, Model, Reset, Surface};

/// A first-order system with impacts.
pub(super) struct System {
    /// Names of the state's components.
    pub names: Vec<String>,
    /// Symbols of the state.
    pub states: Vec<SymbolId>,
    /// Symbols of the inputs.
    pub inputs: Vec<SymbolId>,
    /// Rates of the state.
    pub rates: Vec<ExprId>,
    /// One for each surface.
    pub impacts: Vec<Impact>,
}

/// An impact.
pub(super) struct Impact {
    /// `dh`, one entry for each component of the state.
    pub form: Vec<ExprId>,
    /// `d_t h`
    pub form_rate: ExprId,
    /// `Delta`
    pub map: Vec<ExprId>,
    /// The map `w -> w . Delta_*^{-1}` of covectors.
    pub back: Back,
}

/// Inverse of the derivative of an impact map, acting on covectors from the right.
pub(super) enum Back {
    /// The matrix.
    Matrix(Matrix),
    /// Impulse `qdot+ = R qdot + ..` with `q` kept: `w_v R^{-1} = w_v - factor*(w_v.direction)*dh`.
    Impulse {
        /// `(1 + e)/(e dh(grad h))`
        factor: ExprId,
        /// `grad h`
        direction: Vec<ExprId>,
        /// `d(qdot+)/dq`, a row for each velocity.
        turned: Matrix,
    },
}

/// The first-order system of a model.
pub(super) fn of(model: &mut Model) -> Result<System, Uncontrolled> {
    if let Some(constraint) = model.constraints.first() {
        let text = format!(
            "no maximum principle is derived for a model with constraints, such as `{}`",
            constraint.name.display
        );
        let help = "use coordinates in which there is none";
        return Err(Uncontrolled::at(constraint.item, text, help));
    }
    match model.field.clone() {
        Some(rates) => of_field(model, rates),
        None => of_lagrangian(model),
    }
}

fn inputs(model: &Model) -> Vec<SymbolId> {
    model.inputs().map(|(_, input)| input.symbol).collect()
}

fn of_field(model: &mut Model, rates: Vec<ExprId>) -> Result<System, Uncontrolled> {
    let states: Vec<SymbolId> = model.coordinates.iter().map(|it| it.q).collect();
    let mut impacts = Vec::new();
    for surface in model.surfaces.clone() {
        let reset = surface.reset.as_ref().ok_or_else(|| refused(&surface))?;
        impacts.push(of_reset(model, &surface, reset, &states)?);
    }
    let names = model.coordinates.iter();
    Ok(System {
        names: names.map(|it| it.name.display.clone()).collect(),
        inputs: inputs(model),
        states,
        rates,
        impacts,
    })
}

fn of_lagrangian(model: &mut Model) -> Result<System, Uncontrolled> {
    let derivation = derive(model);
    let metric = model.lagrangian.metric.clone();
    let Some(cometric) = inverse::inverse_in_factors(&mut model.pool, &metric) else {
        let text = "the inverse of the metric is too large to be written out";
        let help = "the maximum principle needs a metric of blocks of at most 4 coordinates";
        return Err(Uncontrolled::at(model.lagrangian.item, text, help));
    };
    let [positions, velocities]: [Vec<SymbolId>; 2] = [
        model.coordinates.iter().map(|it| it.q).collect(),
        model.coordinates.iter().map(|it| it.qdot).collect(),
    ];
    let states = [positions, velocities.clone()].concat();
    let mut rates: Vec<ExprId> = velocities.iter().map(|v| model.pool.variable(*v)).collect();
    rates.extend(accelerations(model, &derivation, &cometric));
    let mut impacts = Vec::new();
    for surface in model.surfaces.clone() {
        impacts.push(match &surface.reset {
            Some(reset) => of_reset(model, &surface, reset, &states)?,
            None => of_impulse(model, &surface, &cometric)?,
        });
    }
    let names = model.coordinates.iter().map(|it| it.name.display.clone());
    let velocities = model.coordinates.iter().map(|it| it.name.velocity());
    Ok(System {
        names: names.chain(velocities).collect(),
        inputs: inputs(model),
        states,
        rates,
        impacts,
    })
}

/// `g^{-1}(force - drift)`
fn accelerations(model: &mut Model, derivation: &Derivation, cometric: &Matrix) -> Vec<ExprId> {
    let field = &derivation.field;
    let pool = &mut model.pool;
    let difference = |k: usize| match field.cancels[k] {
        true => pool.zero(),
        false => pool.sub(field.force[k], field.drift[k]),
    };
    let total: Vec<ExprId> = (0..field.force.len()).map(difference).collect();
    cometric.iter().map(|row| dot(pool, row, &total)).collect()
}

/// `qdot+ = qdot - (1 + e) (dh(qdot) + d_t h)/dh(grad h) grad h`
fn of_impulse(
    model: &mut Model,
    surface: &Surface,
    cometric: &Matrix,
) -> Result<Impact, Uncontrolled> {
    let coefficient = match surface.law {
        Law::Elastic => model.pool.one(),
        Law::Restitution(e) | Law::Newton(e) => e,
        _ => return Err(refused(surface)),
    };
    let is_plastic = model.pool.zero_test(coefficient) == Verdict::Proved;
    if is_plastic || !surface.instantaneous.is_empty() {
        return Err(refused(surface));
    }
    let coordinates = model.coordinates.clone();
    let pool = &mut model.pool;
    let form: Vec<ExprId> = coordinates
        .iter()
        .map(|it| pool.diff(surface.gap, it.q))
        .collect();
    let form_rate = pool.diff(surface.gap, model.time);
    let velocity: Vec<ExprId> = coordinates
        .iter()
        .map(|it| pool.variable(it.qdot))
        .collect();
    let direction: Vec<ExprId> = cometric.iter().map(|row| dot(pool, row, &form)).collect();
    let compliance = dot(pool, &form, &direction);
    let compliance = pool.simplify(compliance);
    let standing = dot(pool, &form, &velocity);
    let gap_rate = pool.sum(&[standing, form_rate]);
    let one = pool.one();
    let more = pool.sum(&[one, coefficient]);
    let strength = pool.mul(more, gap_rate);
    let strength = pool.div(strength, compliance);
    let after: Vec<ExprId> = (velocity.iter().zip(&direction))
        .map(|(velocity, direction)| {
            let change = pool.mul(strength, *direction);
            pool.sub(*velocity, change)
        })
        .collect();
    let divisor = pool.mul(coefficient, compliance);
    let factor = pool.div(more, divisor);
    let turned = after.iter().map(|after| {
        coordinates
            .iter()
            .map(|it| pool.diff(*after, it.q))
            .collect()
    });
    let turned = turned.collect();
    let mut map: Vec<ExprId> = coordinates.iter().map(|it| pool.variable(it.q)).collect();
    map.extend(after);
    let zero = pool.zero();
    let still = vec![zero; coordinates.len()];
    Ok(Impact {
        form: [form, still].concat(),
        form_rate,
        map,
        back: Back::Impulse {
            factor,
            direction,
            turned,
        },
    })
}

fn of_reset(
    model: &mut Model,
    surface: &Surface,
    reset: &Reset,
    states: &[SymbolId],
) -> Result<Impact, Uncontrolled> {
    let set = reset.replacements(&model.coordinates);
    let pool = &mut model.pool;
    let value = |symbol: &SymbolId| {
        let found = set.iter().find(|(target, _)| target == symbol);
        found.map_or_else(|| pool.variable(*symbol), |(_, value)| *value)
    };
    let map: Vec<ExprId> = states.iter().map(value).collect();
    let derivative: Matrix = map
        .iter()
        .map(|entry| states.iter().map(|x| pool.diff(*entry, *x)).collect())
        .collect();
    let report = pool.rank(&derivative);
    if report.decided && report.rank < states.len() {
        return Err(refused(surface));
    }
    let Some(inverse) = inverse::inverse_in_factors(pool, &derivative) else {
        let name = &surface.name.display;
        let text =
            format!("the inverse of the derivative of `{name}` is too large to be written out");
        return Err(Uncontrolled::at(
            surface.item,
            text,
            "leave the surface out, by a scene",
        ));
    };
    Ok(Impact {
        form: states.iter().map(|x| pool.diff(surface.gap, *x)).collect(),
        form_rate: pool.diff(surface.gap, model.time),
        map,
        back: Back::Matrix(inverse),
    })
}

/// The refusal of a law that is not invertible.
fn refused(surface: &Surface) -> Uncontrolled {
    if surface.law == Law::Stop {
        let text = format!("the motion ends at `{}`", surface.name.display);
        let help = "leave the surface out: a control that avoids it is not searched";
        return Uncontrolled::at(surface.item, text, help);
    }
    let text = format!(
        "the law of `{}` is not invertible: the costate after the impact does not follow from the costate before",
        surface.name.display
    );
    let help = "use `elastic`, `restitution(e)` or `newton(e)` with e > 0, or an invertible reset";
    Uncontrolled::at(surface.item, text, help)
}

/// `a.b`; products with 0 are left out.
pub(super) fn dot(pool: &mut Pool, a: &[ExprId], b: &[ExprId]) -> ExprId {
    let mut products = Vec::new();
    for (a, b) in a.iter().zip(b) {
        if ![a, b].iter().any(|factor| pool.is_syntactic_zero(**factor)) {
            products.push(pool.mul(*a, *b));
        }
    }
    pool.sum(&products)
}
