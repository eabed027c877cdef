//! Symmetries: does the flow of a vector field keep the Lagrangian and the constraints, and what of its momentum?
//!
//! ```text
//! lift      xi^i d_i L + (d_j xi^i qdot^j + d_t xi^i) dL/dqdot^i = 0
//! D         L_xi eta^a in the span of the eta^b
//! momentum  J = xi^i dL/dqdot^i,   dJ/dt = lambda_a eta^a(xi) + F(xi)
//! ```
//!
//! The momentum of a horizontal symmetry, `eta^a(xi) = 0`, is conserved (W. Clark, thesis, 3.3.4 and 5.2).

use dalembert_expr::{ExprId, Pool, SymbolId, Verdict as Zero};

use super::conserved::state_on_d;
use super::continuity::possible_jump;
use super::dynamics::Dynamics;
use super::finding::{Certificate, Verdict, Witness, seed_of};
use super::sample::{Sample, sample, uses};
use crate::model::Model;

/// The verdict on a symmetry, with remarks.
pub(super) fn check_symmetry(
    model: &mut Model,
    dynamics: &Dynamics,
    field: &[ExprId],
) -> (Verdict, Vec<String>) {
    let directions = lifted(model, field);
    let whole = model.lagrangian.whole;
    let lift = model.pool.derivative_along(whole, &directions);
    let verdict = match model.pool.zero_test(lift) {
        Zero::Refuted => return (refuted_lift(model, lift), Vec::new()),
        Zero::Undecided => Some("whether it keeps the Lagrangian is not decided"),
        Zero::Proved => None,
    };
    let distribution = keeps_distribution(model, field);
    let verdict = match (verdict, distribution) {
        (_, Some(false)) => {
            let verdict = refuted_distribution(model, dynamics, &directions);
            return (verdict, Vec::new());
        }
        (Some(reason), _) => Verdict::Undecided(reason.to_owned()),
        (None, None) => {
            Verdict::Undecided("whether it keeps the constraints is not decided".to_owned())
        }
        (None, Some(true)) => Verdict::Proved(Certificate {
            shown: "its flow keeps the Lagrangian and the constraints, by zero tests with a chance of error below 1e-18".to_owned(),
            points: 0,
            primes: Vec::new(),
            error: 1e-18,
            seed: seed_of(&model.snake_name),
        }),
    };
    let jump = field
        .iter()
        .find_map(|own| possible_jump(model, *own, &[], &mut |_, _| false));
    if let (Verdict::Proved(_), Some(place)) = (&verdict, jump) {
        let text = format!("where it is smooth it is one, but it may jump {place}");
        return (Verdict::Undecided(text), Vec::new());
    }
    let remarks = vec![momentum_equation(model, field)];
    (verdict, remarks)
}

/// The field, lifted to velocities.
fn lifted(model: &mut Model, field: &[ExprId]) -> Vec<(SymbolId, ExprId)> {
    let motion = motion(model);
    let mut directions = Vec::new();
    for (i, component) in field.iter().enumerate() {
        let (q, qdot) = (model.coordinates[i].q, model.coordinates[i].qdot);
        directions.push((q, *component));
        let rate = model.pool.derivative_along(*component, &motion);
        directions.push((qdot, rate));
    }
    directions
}

/// `qdot` for q, 1 for t.
fn motion(model: &mut Model) -> Vec<(SymbolId, ExprId)> {
    let mut motion = Vec::new();
    for coordinate in &model.coordinates {
        motion.push((coordinate.q, model.pool.variable(coordinate.qdot)));
    }
    motion.push((model.time, model.pool.one()));
    motion
}

fn refuted_lift(model: &Model, lift: ExprId) -> Verdict {
    let found = (0..12).find_map(|attempt| {
        let sample = with_velocities(model, attempt, &[lift]);
        let (value, magnitude) = model
            .pool
            .eval_magnitude(lift, &|symbol| sample.value(symbol).unwrap_or(0.0));
        (value.is_finite() && value.abs() > 1e-6 * magnitude).then_some((sample, value))
    });
    let (sample, values) = match found {
        Some((sample, value)) => (
            Some(sample),
            vec![("rate of L along its flow".to_owned(), value)],
        ),
        None => (None, Vec::new()),
    };
    Verdict::Refuted(Witness {
        reason: "its flow changes the Lagrangian".to_owned(),
        sample,
        values,
        help: "leave it out, or correct the field".to_owned(),
    })
}

/// A velocity in D that the flow takes out of D.
fn refuted_distribution(
    model: &mut Model,
    dynamics: &Dynamics,
    directions: &[(SymbolId, ExprId)],
) -> Verdict {
    let mut rates = Vec::new();
    for a in 0..model.constraints.len() {
        let mut terms = vec![model.constraints[a].affine];
        for i in 0..model.coordinates.len() {
            let velocity = model.pool.variable(model.coordinates[i].qdot);
            let form = model.constraints[a].form[i];
            terms.push(model.pool.mul(form, velocity));
        }
        let left = model.pool.sum(&terms);
        let rate = model.pool.derivative_along(left, directions);
        let name = model.constraints[a].name.display.clone();
        rates.push((
            format!("rate of the left side of {name} along its flow"),
            rate,
        ));
    }
    let mut roots = dynamics.roots();
    roots.extend(rates.iter().map(|(_, rate)| *rate));
    let found = (0..12).find_map(|attempt| {
        let (sample, point) = state_on_d(model, dynamics, &roots, attempt)?;
        rates.iter().find_map(|(name, rate)| {
            let (value, magnitude) = model.pool.eval_magnitude(*rate, &|s| point.value(s));
            let is_clear = value.is_finite() && value.abs() > 1e-6 * magnitude;
            is_clear.then(|| (sample.clone(), vec![(name.clone(), value)]))
        })
    });
    let (sample, values) = found.unzip();
    Verdict::Refuted(Witness {
        reason: "its flow takes allowed velocities to others".to_owned(),
        sample,
        values: values.unwrap_or_default(),
        help: "leave it out, or add the motion of the coordinates that the constraints lack"
            .to_owned(),
    })
}

/// A sample with free velocities.
fn with_velocities(model: &Model, attempt: usize, roots: &[ExprId]) -> Sample {
    let mut sample = sample(model, attempt, uses(&model.pool, roots));
    for (i, coordinate) in model.coordinates.iter().enumerate() {
        if roots
            .iter()
            .any(|root| model.pool.depends_on(*root, coordinate.qdot))
        {
            let value = [0.5, -0.75, 1.25, 0.25, -1.5][(i + attempt) % 5];
            let name = format!("dot({})", coordinate.name.display);
            sample.push(name, coordinate.qdot, value);
        }
    }
    sample
}

/// Whether the Lie derivatives of the forms, affine parts included, are combinations of them; `None` if undecided.
fn keeps_distribution(model: &mut Model, field: &[ExprId]) -> Option<bool> {
    let count = model.constraints.len();
    if count == 0 {
        return Some(true);
    }
    let symbols: Vec<SymbolId> = model.coordinates.iter().map(|own| own.q).collect();
    let along: Vec<_> = symbols.iter().copied().zip(field.iter().copied()).collect();
    let mut rows: Vec<Vec<ExprId>> = Vec::new();
    for constraint in &model.constraints {
        let mut row = constraint.form.clone();
        row.push(constraint.affine);
        rows.push(row);
    }
    let mut by = symbols;
    by.push(model.time);
    for a in 0..count {
        let lie = by.iter().enumerate().map(|(k, symbol)| {
            let mut entry = model.pool.derivative_along(rows[a][k], &along);
            for (j, component) in field.iter().enumerate() {
                let slope = model.pool.diff(*component, *symbol);
                let term = model.pool.mul(rows[a][j], slope);
                entry = model.pool.add(entry, term);
            }
            entry
        });
        let lie: Vec<ExprId> = lie.collect();
        rows.push(lie);
    }
    let report = model.pool.rank(&rows);
    match report.rank == count {
        true => Some(true),
        false => report.decided.then_some(false),
    }
}

/// What the momentum of the field does, as a sentence.
fn momentum_equation(model: &mut Model, field: &[ExprId]) -> String {
    let whole = model.lagrangian.whole;
    let mut momentum = Vec::new();
    for (i, component) in field.iter().enumerate() {
        let own = model.pool.diff(whole, model.coordinates[i].qdot);
        momentum.push(model.pool.mul(*component, own));
    }
    let momentum = model.pool.sum(&momentum);
    let momentum = readable(&mut model.pool, momentum);
    let mut terms = Vec::new();
    for a in 0..model.constraints.len() {
        let form = model.constraints[a].form.clone();
        let value = contract(&mut model.pool, &form, field);
        if model.pool.zero_test(value) != Zero::Proved {
            let multiplier = model.pool.variable(model.derived.multipliers[a]);
            terms.push(model.pool.mul(multiplier, value));
        }
    }
    let is_horizontal = terms.is_empty();
    for force in 0..model.forces.len() {
        let form = model.forces[force].form.clone();
        let value = contract(&mut model.pool, &form, field);
        if model.pool.zero_test(value) != Zero::Proved {
            terms.push(value);
        }
    }
    let torque = model.pool.sum(&terms);
    let torque = readable(&mut model.pool, torque);
    let kind = match (model.constraints.is_empty(), is_horizontal) {
        (true, _) => "",
        (false, true) => "horizontal; ",
        (false, false) => "not horizontal; ",
    };
    if terms.is_empty() {
        format!("{kind}its momentum {momentum} is conserved")
    } else {
        format!("{kind}its momentum {momentum} has the rate {torque}")
    }
}

fn contract(pool: &mut Pool, form: &[ExprId], field: &[ExprId]) -> ExprId {
    let terms: Vec<ExprId> = form
        .iter()
        .zip(field)
        .map(|(form, field)| pool.mul(*form, *field))
        .collect();
    pool.sum(&terms)
}

fn readable(pool: &mut Pool, expression: ExprId) -> String {
    let tidy = pool.simplify(expression);
    pool.text(tidy)
}
