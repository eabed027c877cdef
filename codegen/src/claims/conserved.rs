//! Conserved quantities: the rate of an expression along the motion on D, `d_i e qdot^i + de/dqdot^i qddot^i + d_t e`.

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, RealPoint, SymbolId};

use super::continuity::{discontinuity, possible_jump};
use super::defaults::Defaults;
use super::dynamics::{Dynamics, Motion, Number};
use super::evidence::{Evidence, Vanishing, Wording, evidence, in_arguments};
use super::finding::Verdict;
use super::sample::{ATTEMPTS, state_on_d};
use super::undecided::Undecided;
use crate::model::Model;

/// Fraction of the largest term below which a sum counts as cancelled.
const CANCELLED: f64 = 1e-9;

/// The verdict on `conserved: value` or `not conserved: value`. `written`: the source text of `value`. `parts`: the
/// motion on each part of D. `holds`: false for `not conserved`.
pub(super) fn check_conserved(
    model: &mut Model,
    parts: &[Dynamics],
    (value, written): (ExprId, &str),
    holds: bool,
    seed: u64,
) -> Verdict {
    let motion = match model.surfaces.is_empty() {
        true => "the motion on D",
        false => "the motion on D between impacts",
    };
    let wording = Wording {
        vanishes: format!("the rate of `{written}` along {motion} is 0"),
        differs: format!("`{written}` changes along the motion"),
        help: [
            format!("write `not conserved: {written};`"),
            format!("write `conserved: {written};`"),
        ],
    };
    let mut found: Option<Evidence> = None;
    for dynamics in parts {
        let rate = Rate {
            quantity: Quantity::of(model, value),
            dynamics,
            written,
        };
        let part = evidence(model, &rate, seed);
        found = Some(match found {
            Some(others) => others.and(part),
            None => part,
        });
    }
    let Some(found) = found else {
        return Verdict::Undecided(Undecided::Nonlinear.to_string());
    };
    let verdict = found.verdict(holds, wording, seed);
    let mut jumps = parts
        .iter()
        .map(|dynamics| jump(model, dynamics, value, seed));
    if holds
        && matches!(verdict, Verdict::Proved(_))
        && let Some(place) = jumps.find_map(|place| place)
    {
        let text = format!("its rate is 0 wherever it exists, but it may jump {place}");
        return Verdict::Undecided(text);
    }
    match (holds, &verdict) {
        (true, Verdict::Refuted(_)) | (false, Verdict::Proved(_)) => {
            change_at_defaults(model, parts, (value, written), verdict, seed)
        }
        _ => verdict,
    }
}

/// Adds a remark to `generic`, the verdict that a quantity changes for indeterminate parameters, if the quantity is
/// conserved at the declared defaults.
fn change_at_defaults(
    model: &mut Model,
    parts: &[Dynamics],
    (value, written): (ExprId, &str),
    generic: Verdict,
    seed: u64,
) -> Verdict {
    let roots = parts.iter().flat_map(Dynamics::roots).chain([value]);
    let defaults = Defaults::of(model, &roots.collect::<Vec<_>>());
    if defaults.is_empty() {
        return generic;
    }
    let value = model.pool.substitute(value, defaults.replacements());
    let is_conserved = parts.iter().all(|dynamics| {
        let dynamics = dynamics.substituted(&mut model.pool, defaults.replacements());
        let rate = Rate {
            quantity: Quantity::of(model, value),
            dynamics: &dynamics,
            written,
        };
        evidence(model, &rate, seed).shows_that_it_vanishes()
            && jump(model, &dynamics, value, seed).is_none()
    });
    match is_conserved {
        true => defaults.without_change(generic),
        false => generic,
    }
}

/// Description of places where a quantity may jump along a motion; `None` if it cannot jump.
pub(super) fn jump(
    model: &mut Model,
    dynamics: &Dynamics,
    value: ExprId,
    seed: u64,
) -> Option<String> {
    let equations = dynamics.roots();
    possible_jump(model, value, Some(&equations), &mut |model, part| {
        is_constant(model, dynamics, part, seed)
    })
}

/// Description of places where a term of the equations of motion may jump, apart from those where an expression that
/// `is_harmless` is 0.
pub(super) fn jump_unless(
    model: &mut Model,
    dynamics: &Dynamics,
    term: ExprId,
    seed: u64,
    is_harmless: &dyn Fn(&mut Model, ExprId) -> bool,
) -> Option<String> {
    let equations = dynamics.roots();
    discontinuity(model, term, &equations, &mut |model, part| {
        is_harmless(model, part) || is_constant(model, dynamics, part, seed)
    })
}

/// True if an expression is proved to be constant along every motion.
pub(super) fn is_constant(model: &mut Model, dynamics: &Dynamics, part: ExprId, seed: u64) -> bool {
    let rate = Rate {
        quantity: Quantity::of(model, part),
        dynamics,
        written: "",
    };
    evidence(model, &rate, seed).shows_that_it_vanishes()
}

/// A quantity with its derivatives by coordinates, velocities and time.
#[derive(Debug)]
pub(super) struct Quantity {
    /// Its value.
    pub(super) value: ExprId,
    slopes: Vec<ExprId>,
}

impl Quantity {
    /// Differentiates a function of coordinates, velocities and time.
    pub(super) fn of(model: &mut Model, value: ExprId) -> Self {
        let positions = model.coordinates.iter().map(|coordinate| coordinate.q);
        let velocities = model.coordinates.iter().map(|coordinate| coordinate.qdot);
        let mut symbols: Vec<SymbolId> = positions.chain(velocities).collect();
        symbols.push(model.time);
        let slopes = symbols
            .into_iter()
            .map(|symbol| model.pool.diff(value, symbol));
        Self {
            value,
            slopes: slopes.collect(),
        }
    }

    /// The expressions that are evaluated.
    pub(super) fn roots(&self) -> Vec<ExprId> {
        let mut roots = self.slopes.clone();
        roots.push(self.value);
        roots
    }

    /// Value of the quantity, and terms of its rate along a motion; `None` at a point where one has no value.
    pub(super) fn terms<P: ExpansionPoint>(
        &self,
        model: &Model,
        motion: &Motion<Number<P>>,
        point: &mut P,
    ) -> Option<(Number<P>, Vec<Number<P>>)> {
        let field = point.field();
        let order = model.pool.reachable(&self.roots());
        let values = point.values(&model.pool, &order)?;
        let mut direction = motion.qdot.clone();
        direction.extend(&motion.qddot);
        direction.push(field.integer(1));
        let term = |(slope, rate): (&ExprId, &Number<P>)| field.mul(values[slope.index()], *rate);
        let terms = self.slopes.iter().zip(&direction).map(term).collect();
        Some((values[self.value.index()], terms))
    }
}

/// Size of the terms of a rate if every velocity and every acceleration were as large as the largest. A small
/// acceleration may be the difference of large terms.
pub(super) fn rate_scale(
    quantity: &Quantity,
    model: &Model,
    motion: &Motion<f64>,
    point: &RealPoint,
) -> f64 {
    let largest = |values: &[f64]| {
        values
            .iter()
            .fold(0.0, |size: f64, value| size.max(value.abs()))
    };
    let velocity = largest(&motion.qdot);
    let acceleration = largest(&motion.qddot).max(velocity * velocity);
    let n = motion.qdot.len();
    let rate = |i: usize| match i {
        i if i < n => velocity,
        i if i < 2 * n => acceleration,
        _ => 1.0,
    };
    let slopes = quantity.slopes.iter().enumerate();
    slopes
        .map(|(i, slope)| rate(i) * magnitude(model, point, *slope))
        .sum()
}

/// Size of the terms that an expression adds up at a point.
pub(super) fn magnitude(model: &Model, point: &RealPoint, id: ExprId) -> f64 {
    let (_, magnitude) = model.pool.eval_magnitude(id, &|symbol| point.value(symbol));
    magnitude
}

/// The rate of a quantity.
struct Rate<'r> {
    quantity: Quantity,
    dynamics: &'r Dynamics,
    written: &'r str,
}

impl Vanishing for Rate<'_> {
    fn roots(&self) -> Vec<ExprId> {
        let mut roots = self.dynamics.roots();
        roots.extend(self.quantity.roots());
        roots
    }

    fn hides_relations(&self, model: &Model) -> bool {
        let solved: Vec<SymbolId> = self.dynamics.roots_of_branches().collect();
        in_arguments(&model.pool, &self.roots(), &solved)
    }

    fn dynamics(&self) -> Option<&Dynamics> {
        Some(self.dynamics)
    }

    fn terms<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
        let motion = self.dynamics.motion(&model.pool, point, None)?;
        self.quantity
            .terms(model, &motion, point)
            .map(|(_, terms)| terms)
    }

    fn scale(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        let motion = self.dynamics.motion(&model.pool, point, None)?;
        Some(rate_scale(&self.quantity, model, &motion, point))
    }

    fn balance(&self, model: &Model, terms: &[f64]) -> Vec<(String, f64)> {
        let names = model
            .coordinates
            .iter()
            .map(|coordinate| &coordinate.name.display);
        let positions = names.clone().map(ToString::to_string);
        let velocities = names.map(|name| format!("dot({name})"));
        let all = positions.chain(velocities).chain(["t".to_owned()]);
        let seen = all.zip(terms).filter(|(_, term)| **term != 0.0);
        let sum: f64 = terms.iter().sum();
        let largest = terms
            .iter()
            .fold(0.0, |size: f64, term| size.max(term.abs()));
        // The parts are shown only where they cancel.
        if sum.abs() > CANCELLED * largest {
            return Vec::new();
        }
        seen.map(|(name, term)| (format!("part by {name}"), *term))
            .collect()
    }

    fn shown(&self, _: &Model, _: &[f64], sum: f64) -> Vec<(String, f64)> {
        vec![(format!("d/dt({})", self.written), sum)]
    }
}

/// True if there is a real state on D at which Lagrangian and motion have values.
pub(super) fn has_states(model: &Model, dynamics: &Dynamics) -> bool {
    let whole = model.lagrangian.whole;
    let mut roots = dynamics.roots();
    roots.push(whole);
    (0..ATTEMPTS).any(|attempt| {
        let found = state_on_d(model, dynamics, &roots, attempt);
        found.is_some_and(|(_, point)| {
            model.pool.eval(&[whole], &|symbol| point.value(symbol))[0].is_finite()
        })
    })
}
