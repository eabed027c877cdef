//! Symmetries: decides whether the flow of a vector field keeps the Lagrangian and the constraints, and derives the
//! equation of its momentum.
//!
//! ```text
//! lift      xi^i d_i L + (d_j xi^i qdot^j + d_t xi^i) dL/dqdot^i = df/dt
//! D         the lift keeps eta^a(qdot) + eta^a_0 = 0 at all qdot that satisfy it
//! momentum  J = xi^i dL/dqdot^i,   d(J - f)/dt = lambda_a eta^a(xi) + F(xi)
//! ```
//!
//! The momentum of a horizontal symmetry, `eta^a(xi) = 0`, is conserved (W. Clark, thesis, 3.3.4 and 5.2). If the flow
//! keeps the Lagrangian itself, `f(q, t)` is 0; otherwise see [`super::gauge`].

use dalembert_expr::{ExpansionPoint, ExprId, Pool, RealPoint, SymbolId, Verdict as Zero};

use super::conserved::magnitude;
use super::continuity::possible_jump;
use super::dynamics::{Dynamics, Number};
use super::evidence::{Vanishing, Wording, evidence};
use super::finding::{Certificate, Verdict};
use super::gauge;
use super::sample::{Sample, sample, state_on_d, uses};
use crate::model::Model;

/// True if the flow of a field is proved to keep the Lagrangian itself.
pub(crate) fn keeps_lagrangian(model: &mut Model, field: &[ExprId], seed: u64) -> bool {
    let kept = kept(model, field);
    evidence(model, &kept, seed).shows_that_it_vanishes()
}

/// The rate of the Lagrangian along the flow of a field.
fn kept(model: &mut Model, field: &[ExprId]) -> Change<'static> {
    let directions = lifted(model, field);
    let whole = model.lagrangian.whole;
    let rate = model.pool.derivative_along(whole, &directions);
    Change::of_lagrangian("rate of L along its flow".to_owned(), rate)
}

/// The function whose total derivative the Lagrangian gains along the flow of a symmetry, as in a boost; `None` if it
/// gains nothing. The momentum less this function is conserved between impacts.
pub(super) fn gain(model: &mut Model, field: &[ExprId]) -> Option<ExprId> {
    let has_positions = (model.constraints.iter()).any(|constraint| constraint.is_of_positions);
    let rate = kept(model, field).rate;
    let is_kept = has_positions || model.pool.zero_test(rate) == Zero::Proved;
    match is_kept {
        true => None,
        false => gauge::antiderivative(model, rate),
    }
}

/// The verdict on a symmetry, with remarks.
pub(crate) fn check_symmetry(
    model: &mut Model,
    dynamics: &Dynamics,
    field: &[ExprId],
    seed: u64,
) -> (Verdict, Vec<String>) {
    if let Some(rates) = model.field.clone() {
        return check_commuting(model, dynamics, field, &rates, seed);
    }
    let directions = lifted(model, field);
    let are_positions = model
        .constraints
        .iter()
        .all(|constraint| constraint.is_of_positions);
    let kept = Change {
        on_d: (are_positions && !model.constraints.is_empty()).then_some(dynamics),
        ..kept(model, field)
    };
    let (rate, on_d) = (kept.rate, kept.on_d);
    let is_kept = evidence(model, &kept, seed).shows_that_it_vanishes();
    if let (false, Some(dynamics)) = (is_kept, on_d) {
        for (name, value) in gauge::conditions_along_equations(model, rate) {
            let change = Change {
                on_d: Some(dynamics),
                ..Change::of_lagrangian(name.to_owned(), value)
            };
            let refuted = evidence(model, &change, seed).verdict(true, change.wording(), seed);
            if let Verdict::Refuted(_) = refuted {
                return (refuted, Vec::new());
            }
        }
    }
    let mut changes = match is_kept {
        true => vec![kept],
        false => gauge::conditions(model, rate)
            .into_iter()
            .map(|(name, value)| Change::of_lagrangian(name, value))
            .collect(),
    };
    changes.extend(of_constraints(model, dynamics, &directions));
    changes.extend(of_positions(model, dynamics, &directions));
    let mut certificate = match proved_together(model, &changes, seed) {
        Ok(certificate) => certificate,
        Err(verdict) => return (verdict, Vec::new()),
    };
    if !is_kept {
        certificate.shown = GAUGE.to_owned();
    }
    if let Some(open) = jump(model, field) {
        return (open, Vec::new());
    }
    let gauge = (!is_kept).then_some(rate);
    let remarks = vec![momentum_equation(model, field, gauge)];
    (Verdict::Proved(certificate), remarks)
}

/// The verdict on several changes: their common proof, or the verdict on the first change that is not proved to vanish.
fn verdict(together: Result<Certificate, Verdict>) -> Verdict {
    match together {
        Ok(certificate) => Verdict::Proved(certificate),
        Err(verdict) => verdict,
    }
}

/// The verdict on the claim that a flow keeps the constraints.
pub(super) fn check_constraints(
    model: &mut Model,
    dynamics: &Dynamics,
    field: &[ExprId],
    seed: u64,
) -> Verdict {
    let directions = lifted(model, field);
    let mut changes = of_constraints(model, dynamics, &directions);
    changes.extend(of_positions(model, dynamics, &directions));
    verdict(proved_together(model, &changes, seed))
}

/// The verdict on the claim that a flow keeps the forces.
pub(super) fn check_forces(
    model: &mut Model,
    dynamics: &Dynamics,
    field: &[ExprId],
    seed: u64,
) -> Verdict {
    let directions = lifted(model, field);
    let changes = of_forces(model, dynamics, field, &directions);
    verdict(proved_together(model, &changes, seed))
}

/// The verdict on a symmetry of a first-order system: its flow maps motions to motions if both fields commute.
fn check_commuting(
    model: &mut Model,
    dynamics: &Dynamics,
    field: &[ExprId],
    rates: &[ExprId],
    seed: u64,
) -> (Verdict, Vec<String>) {
    let symbols: Vec<SymbolId> = (model.coordinates.iter())
        .map(|coordinate| coordinate.q)
        .collect();
    let along = |values: &[ExprId]| -> Vec<(SymbolId, ExprId)> {
        let pairs = symbols.iter().zip(values);
        pairs.map(|(q, value)| (*q, *value)).collect()
    };
    let mut motion = along(rates);
    let one = model.pool.one();
    motion.push((model.time, one));
    let directions = along(field);
    let mut changes = Vec::new();
    for (i, (component, rate)) in field.iter().zip(rates).enumerate() {
        let of_rate = model.pool.derivative_along(*rate, &directions);
        let of_field = model.pool.derivative_along(*component, &motion);
        let name = &model.coordinates[i].name.display;
        changes.push(Change {
            name: format!("rate of dot({name}) along its flow, less that of its component"),
            rate: model.pool.sub(of_rate, of_field),
            subject: Subject::Rates,
            on_d: Some(dynamics),
        });
    }
    let verdict = match proved_together(model, &changes, seed) {
        Ok(certificate) => jump(model, field).unwrap_or(Verdict::Proved(certificate)),
        Err(verdict) => verdict,
    };
    (verdict, Vec::new())
}

/// An open verdict on a field that may jump.
fn jump(model: &mut Model, field: &[ExprId]) -> Option<Verdict> {
    let place = field
        .iter()
        .find_map(|expr| possible_jump(model, *expr, None, &mut |_, _| false))?;
    let text = format!("it is a symmetry where it is smooth, but it may jump {place}");
    Some(Verdict::Undecided(text))
}

fn has_position_equations(model: &Model) -> bool {
    model
        .constraints
        .iter()
        .any(|constraint| constraint.is_of_positions)
}

/// The certificate that all changes vanish, or the verdict on the first change that is not proved to vanish.
fn proved_together(
    model: &Model,
    changes: &[Change<'_>],
    seed: u64,
) -> Result<Certificate, Verdict> {
    let mut whole: Option<Certificate> = None;
    for change in changes {
        match evidence(model, change, seed).verdict(true, change.wording(), seed) {
            Verdict::Proved(certificate) => whole = Some(joined(whole, certificate)),
            Verdict::Undecided(reason) => {
                let reason = format!("{}: {reason}", change.question());
                return Err(Verdict::Undecided(reason));
            }
            // The changes were sought at any position.
            Verdict::Refuted(_) if change.on_d.is_none() && has_position_equations(model) => {
                let reason = format!("{}: {ELSEWHERE}", change.question());
                return Err(Verdict::Undecided(reason));
            }
            refuted => return Err(refuted),
        }
    }
    Ok(whole.unwrap_or_else(|| Certificate::without_chance(KEPT.to_owned(), seed)))
}

/// Joins two certificates. Both statements were tested at no fewer points than the smaller number.
fn joined(first: Option<Certificate>, second: Certificate) -> Certificate {
    let Some(mut whole) = first else {
        return second;
    };
    whole.points = whole.points.min(second.points);
    whole.primes.extend(second.primes);
    whole.primes.sort_unstable();
    whole.primes.dedup();
    whole.error += second.error;
    whole
}

/// The change of the left side of each constraint at velocities in D.
fn of_constraints<'d>(
    model: &mut Model,
    dynamics: &'d Dynamics,
    directions: &[(SymbolId, ExprId)],
) -> Vec<Change<'d>> {
    let mut changes = Vec::new();
    for a in 0..model.constraints.len() {
        let mut terms = vec![model.constraints[a].affine];
        for i in 0..model.coordinates.len() {
            let velocity = model.pool.variable(model.coordinates[i].qdot);
            let form = model.constraints[a].form[i];
            terms.push(model.pool.mul(form, velocity));
        }
        let left = model.pool.sum(&terms);
        let name = &model.constraints[a].name.display;
        changes.push(Change {
            name: format!("rate of the left side of {name} along its flow"),
            rate: model.pool.derivative_along(left, directions),
            subject: Subject::Constraints,
            on_d: Some(dynamics),
        });
    }
    changes
}

/// The change of the left side of each position equation, which is 0 if the flow maps its solutions to solutions.
fn of_positions<'d>(
    model: &mut Model,
    dynamics: &'d Dynamics,
    directions: &[(SymbolId, ExprId)],
) -> Vec<Change<'d>> {
    let equations = model
        .constraints
        .iter()
        .filter(|constraint| constraint.is_of_positions);
    let levels = equations.filter_map(|it| Some((it.name.display.clone(), it.level?)));
    let levels: Vec<(String, ExprId)> = levels.collect();
    let change = |(name, level)| Change {
        name: format!("rate of the left side of {name} along its flow"),
        rate: model.pool.derivative_along(level, directions),
        subject: Subject::Constraints,
        on_d: Some(dynamics),
    };
    levels.into_iter().map(change).collect()
}

/// The change of each force at velocities in D, without components that vanish.
fn of_forces<'d>(
    model: &mut Model,
    dynamics: &'d Dynamics,
    field: &[ExprId],
    directions: &[(SymbolId, ExprId)],
) -> Vec<Change<'d>> {
    let mut changes = Vec::new();
    for force in 0..model.forces.len() {
        let form = model.forces[force].form.clone();
        for i in 0..form.len() {
            let mut terms = vec![model.pool.derivative_along(form[i], directions)];
            for (component, along) in field.iter().zip(&form) {
                let slope = model.pool.diff(*component, model.coordinates[i].q);
                terms.push(model.pool.mul(*along, slope));
            }
            let rate = model.pool.sum(&terms);
            if model.pool.zero_test(rate) == Zero::Proved {
                continue;
            }
            let names = [&model.forces[force].name, &model.coordinates[i].name];
            let [force, coordinate] = names.map(|name| name.display.clone());
            changes.push(Change {
                name: format!("rate of the force {force} on {coordinate} along its flow"),
                rate,
                subject: Subject::Forces,
                on_d: Some(dynamics),
            });
        }
    }
    changes
}

/// Reason that keeps a change open under position equations.
const ELSEWHERE: &str = "it does not at positions that break the position equations";
/// Proved statement on a symmetry of the Lagrangian itself.
const KEPT: &str = "its flow keeps the Lagrangian and the constraints";
/// Proved statement on a symmetry of a first-order system.
const RATES: &str = "its flow keeps the rates";
/// Proved statement on a symmetry up to a total derivative.
const GAUGE: &str =
    "its flow changes the Lagrangian by a total time derivative and keeps the constraints";

/// Quantities that a symmetry keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Subject {
    Lagrangian,
    Constraints,
    Forces,
    Rates,
}

/// The rate of a quantity along a flow.
struct Change<'d> {
    rate: ExprId,
    name: String,
    subject: Subject,
    /// The motion, if velocities are those in D.
    on_d: Option<&'d Dynamics>,
}

impl Change<'_> {
    /// A change at all velocities.
    fn of_lagrangian(name: String, rate: ExprId) -> Self {
        Change {
            name,
            rate,
            subject: Subject::Lagrangian,
            on_d: None,
        }
    }

    fn question(&self) -> &'static str {
        match self.subject {
            Subject::Lagrangian => {
                "whether its flow keeps the Lagrangian up to a total time derivative"
            }
            Subject::Constraints => "whether its flow keeps the constraints",
            Subject::Forces => "whether its flow keeps the forces",
            Subject::Rates => "whether its flow keeps the rates",
        }
    }

    fn wording(&self) -> Wording {
        let corrected = "leave it out, or correct the field";
        let (differs, help) = match self.subject {
            Subject::Lagrangian => (
                "its flow changes the Lagrangian by more than a total time derivative",
                corrected,
            ),
            Subject::Constraints => (
                "its flow maps allowed velocities to velocities that are not allowed",
                "leave it out, or add the motion of the coordinates that the constraints lack",
            ),
            Subject::Forces => ("its flow changes the forces", corrected),
            Subject::Rates => ("its flow changes the rates", corrected),
        };
        Wording {
            vanishes: match self.subject {
                Subject::Rates => RATES.to_owned(),
                _ => KEPT.to_owned(),
            },
            differs: differs.to_owned(),
            help: [help.to_owned(), String::new()],
        }
    }
}

impl Vanishing for Change<'_> {
    fn roots(&self) -> Vec<ExprId> {
        let mut roots = self.on_d.map_or(Vec::new(), Dynamics::roots);
        roots.push(self.rate);
        roots
    }

    fn dynamics(&self) -> Option<&Dynamics> {
        self.on_d
    }

    fn sample(&self, model: &Model, attempt: usize) -> Option<(Sample, RealPoint)> {
        match self.on_d {
            None => {
                let sample = with_velocities(model, attempt, &[self.rate]);
                let point = sample.point();
                Some((sample, point))
            }
            Some(dynamics) => state_on_d(model, dynamics, &self.roots(), attempt),
        }
    }

    fn terms<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
        let values = point.values(&model.pool, &model.pool.reachable(&[self.rate]))?;
        Some(vec![values[self.rate.index()]])
    }

    fn scale(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        Some(magnitude(model, point, self.rate))
    }

    fn shown(&self, _: &Model, _: &[f64], sum: f64) -> Vec<(String, f64)> {
        vec![(self.name.clone(), sum)]
    }
}

/// The field, lifted to velocities.
pub(super) fn lifted(model: &mut Model, field: &[ExprId]) -> Vec<(SymbolId, ExprId)> {
    let motion = gauge::motion(model);
    let mut directions = Vec::new();
    for (i, component) in field.iter().enumerate() {
        let (q, qdot) = (model.coordinates[i].q, model.coordinates[i].qdot);
        directions.push((q, *component));
        let rate = model.pool.derivative_along(*component, &motion);
        directions.push((qdot, rate));
    }
    directions
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

/// Equation of the momentum of the field, as a sentence. `gauge` is the rate of the Lagrangian along the flow, a total
/// derivative.
fn momentum_equation(model: &mut Model, field: &[ExprId], gauge: Option<ExprId>) -> String {
    let whole = model.lagrangian.whole;
    let mut momentum = Vec::new();
    for (i, component) in field.iter().enumerate() {
        // The product of 0 with an expression that is not defined everywhere would be kept.
        if !model.pool.is_syntactic_zero(*component) {
            let derivative = model.pool.diff(whole, model.coordinates[i].qdot);
            momentum.push(model.pool.mul(*component, derivative));
        }
    }
    let mut momentum = model.pool.sum(&momentum);
    let lost = gauge.and_then(|rate| gauge::antiderivative(model, rate));
    if let Some(lost) = lost {
        momentum = model.pool.sub(momentum, lost);
    }
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
    if lost.is_none() {
        terms.extend(gauge);
    }
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
    let name = match lost {
        Some(_) => "its momentum, less the gain of the Lagrangian,",
        None => "its momentum",
    };
    if terms.is_empty() {
        format!("{kind}{name} {momentum} is conserved")
    } else {
        format!("{kind}{name} {momentum} has the rate {torque}")
    }
}

fn contract(pool: &mut Pool, form: &[ExprId], field: &[ExprId]) -> ExprId {
    let mut terms = Vec::new();
    for (form, field) in form.iter().zip(field) {
        if !pool.is_syntactic_zero(*field) {
            terms.push(pool.mul(*form, *field));
        }
    }
    pool.sum(&terms)
}

fn readable(pool: &mut Pool, expression: ExprId) -> String {
    let tidy = pool.simplify(expression);
    pool.text(tidy)
}
