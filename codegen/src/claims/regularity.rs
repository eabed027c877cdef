//! Regularity of a density on all of Q. It is decided at real points, because residues say nothing about it.
//!
//! The model may be undefined at all real points. A closed form may be 0 or infinite where metric and constraints are
//! regular. For `dx = x dy` the density `1/|x|` is invariant on both sides of the leaf `x = 0`, but it is not a density
//! on the leaf. A circle may leave the domain in which the constraints are independent. The system ends there.

use std::f64::consts::TAU;

use dalembert_expr::{
    Domain, ExprId, Function, Interval, JetSpace, Jets, Node, Pool, Rational, Reals, SymbolId,
    Zeros,
};

use super::exactness::Local;
use super::geometry::geometry_at;
use super::global::Global;
use super::linear::{dot, solve, transpose};
use super::potential::{Potential, Term};
use super::problem::Problem;
use super::sample::{ATTEMPTS, sample, uses};
use crate::model::{Assumption, Model, Topology};

/// Reason why a singular density leaves the question open.
pub(super) const SINGULAR: &str =
    "the density found is 0 or infinite at configurations where metric and constraints are regular";
/// Reason why a circle that leaves the regular domain leaves the question open.
pub(super) const LEAVES: &str = "a circle leaves the domain where the constraints are regular and forces and Lagrangian have values";

/// Number of points on a circle.
const POINTS: usize = 64;
/// Number of golden-section steps. They shrink an interval by the factor `3e-13`.
const BISECTIONS: usize = 60;
/// Fraction of the largest determinant on a circle below which a value counts as 0.
const SMALL: f64 = 1e-9;
/// Fraction of the largest determinant on a circle below which a minimum near a point is sought. If the determinant
/// vanishes like the square of a sine, the point next to the zero is below it.
const LOW: f64 = 0.1;

/// Values of coordinates, time and parameters.
type Values = Vec<(SymbolId, f64)>;

/// True if the model is regular at one of the real points tried. Roots and logarithms have residues even where they
/// have no real values.
pub(super) fn is_real(model: &Model, problem: &Problem) -> bool {
    let roots = problem.roots();
    (0..ATTEMPTS).any(|attempt| {
        let values = sample(model, attempt, uses(&model.pool, &roots)).point_values();
        let geometry = geometry_at(&model.pool, problem, &values, None);
        geometry.is_some_and(|geometry| geometry.demands.iter().all(|demand| demand.is_finite()))
    })
}

/// True if a density has neither zeros nor poles where the model is defined: every term in its logarithms is proved to
/// be nonzero for all values of coordinates and parameters.
pub(super) fn is_regular(
    model: &mut Model,
    problem: &Problem,
    local: &Local,
    found: &Potential,
) -> bool {
    logarithms(model, problem, local, found)
        .is_some_and(|terms| terms.into_iter().all(|term| is_never_zero(model, term)))
}

/// Factors of a density in closed form that may be 0.
pub(super) fn factors_with_zeros(
    model: &mut Model,
    problem: &Problem,
    local: &Local,
    found: &Potential,
) -> Vec<ExprId> {
    let terms = logarithms(model, problem, local, found).unwrap_or_default();
    let mut factors: Vec<ExprId> = terms
        .into_iter()
        .flat_map(|term| numerators(model, term))
        .collect();
    factors.retain(|factor| !is_never_zero(model, *factor));
    factors
}

/// Terms in logarithms of a density that may be 0; `None` if one of them is too large to be written out.
fn logarithms(
    model: &mut Model,
    problem: &Problem,
    local: &Local,
    found: &Potential,
) -> Option<Vec<ExprId>> {
    let mut logarithms = Vec::new();
    for (_, term) in &found.terms {
        match term {
            Term::Logarithm(f) => logarithms.push(*f),
            Term::DependentDeterminant => {
                logarithms.push(determinant(model, &problem.forms, local.dependent())?);
            }
            Term::MassDeterminant | Term::MetricDeterminant | Term::Plain(_) => {}
        }
    }
    Some(logarithms)
}

/// The factors of a product outside its denominator.
fn numerators(model: &Model, id: ExprId) -> Vec<ExprId> {
    let (_, product) = model.pool.as_multiple(id);
    match model.pool.node(product) {
        Node::Product(factors) => {
            let above = factors.iter().filter(|(_, power)| !power.is_negative());
            above.map(|(base, _)| *base).collect()
        }
        _ => vec![id],
    }
}

/// Largest number of constraints whose minor is written out.
const LARGEST_MINOR: usize = 4;

/// Determinant of some columns of the constraint forms, written out; `None` for too many constraints.
pub(super) fn determinant(
    model: &mut Model,
    forms: &[Vec<ExprId>],
    columns: &[usize],
) -> Option<ExprId> {
    let Some((first, rest)) = forms.split_first() else {
        return Some(model.pool.one());
    };
    if forms.len() > LARGEST_MINOR {
        return None;
    }
    let mut terms = Vec::new();
    for (k, column) in columns.iter().enumerate() {
        let others: Vec<usize> = columns
            .iter()
            .copied()
            .filter(|other| other != column)
            .collect();
        let minor = determinant(model, rest, &others)?;
        let term = model.pool.mul(first[*column], minor);
        terms.push(match k % 2 {
            0 => term,
            _ => model.pool.neg(term),
        });
    }
    Some(model.pool.sum(&terms))
}

/// True if an expression is proved to be nonzero wherever it is defined.
pub(super) fn is_never_zero(model: &mut Model, id: ExprId) -> bool {
    if model.pool.sign(id).is_nonzero() || is_positive_on_chart(model, id) {
        return true;
    }
    let factors = numerators(model, id);
    if factors != [id] {
        return factors.into_iter().all(|base| is_never_zero(model, base));
    }
    let domain = domain(model, id);
    let slopes: Vec<ExprId> = domain
        .iter()
        .map(|(symbol, _)| model.pool.diff(id, *symbol))
        .collect();
    if model.pool.zeros_on(id, &slopes, &domain) == Zeros::None {
        return true;
    }
    // At a zero of the expression, its product with the conjugate is 0 as well.
    conjugate_product(model, id).is_some_and(|product| is_never_zero(model, product))
}

/// The product `a^2 - b^2 r` of a sum `a + b sqrt(r)` with its conjugate, which has one root less.
fn conjugate_product(model: &mut Model, id: ExprId) -> Option<ExprId> {
    let (constant, terms) = model.pool.linear_form(id);
    let root = |term: ExprId| {
        let Node::Product(factors) = model.pool.node(term) else {
            return None;
        };
        let half = factors.iter().find(|(_, power)| *power == Rational::HALF)?;
        Some(half.0)
    };
    let radicand = terms.iter().find_map(|(_, term)| root(*term))?;
    let has_root = |term: ExprId| root(term) == Some(radicand);
    let (with, without): (Vec<_>, Vec<_>) = terms.into_iter().partition(|(_, t)| has_root(*t));
    let pool = &mut model.pool;
    let mut sum = |terms: Vec<(Rational, ExprId)>, constant: Rational| {
        let mut parts = vec![pool.number(constant)];
        for (coefficient, term) in terms {
            parts.push(pool.scale(&coefficient, term));
        }
        let sum = pool.sum(&parts);
        let square = pool.pow(sum, Rational::from(2));
        pool.multiply_out(square)
    };
    let squares = [sum(without, constant), sum(with, Rational::ZERO)];
    let product = model.pool.sub(squares[0], squares[1]);
    let product = model.pool.multiply_out(product);
    let product = model.pool.simplify(product);
    // NOTE: without this condition the recursion might not terminate.
    let count = |id: ExprId| {
        model
            .pool
            .reachable(&[id])
            .iter()
            .filter(|part| root_below(&model.pool, **part))
            .count()
    };
    (count(product) < count(id)).then_some(product)
}

fn root_below(pool: &Pool, id: ExprId) -> bool {
    let Node::Product(factors) = pool.node(id) else {
        return false;
    };
    factors.iter().any(|(_, power)| !power.is_integer())
}

/// True for the sine or cosine of a coordinate that is positive on its chart.
fn is_positive_on_chart(model: &Model, id: ExprId) -> bool {
    let Node::Call(function, argument) = model.pool.node(id) else {
        return false;
    };
    let Node::Symbol(symbol) = model.pool.node(*argument) else {
        return false;
    };
    let mut coordinates = model.coordinates.iter();
    let chart = coordinates.find(|coordinate| coordinate.q == *symbol);
    let Some(Topology::Interval { low, high }) = chart.map(|coordinate| coordinate.topology) else {
        return false;
    };
    let multiple = |end: ExprId| {
        let (number, rest) = model.pool.as_multiple(end);
        match model.pool.as_number(end) {
            Some(number) if number.is_zero() => Some(Rational::ZERO),
            _ => (rest == model.pool.pi()).then_some(number),
        }
    };
    let (Some(low), Some(high)) = (multiple(low), multiple(high)) else {
        return false;
    };
    let half = Rational::HALF;
    match function {
        Function::Sin => low >= Rational::ZERO && high <= Rational::ONE,
        Function::Cos => low >= -&half && high <= half,
        _ => false,
    }
}

/// Ranges of the symbols that occur in an expression.
pub(super) fn domain(model: &Model, id: ExprId) -> Domain {
    let pool = &model.pool;
    // Parts of a declaration may have a longer period than the whole if they contain fractions of angles.
    let turns = pool.profile_of(&[id]).denominator.unwrap_or(1) as f64;
    let mut domain = Domain::new();
    let ends = |low: ExprId, high: ExprId| {
        let ranges = pool.enclose(&pool.reachable(&[low, high]), &Domain::new());
        let [low, high] = [low, high].map(|end| ranges[end.index()].unwrap_or(Interval::WHOLE));
        Interval::new(low.lo, high.hi)
    };
    for coordinate in &model.coordinates {
        let range = match coordinate.topology {
            Topology::Line => Interval::WHOLE,
            Topology::Angle => Interval::new(0.0, (2.0 * turns * Interval::pi().hi).next_up()),
            Topology::Interval { low, high } => ends(low, high),
        };
        domain.push((coordinate.q, range));
    }
    domain.push((model.time, Interval::WHOLE));
    for parameter in &model.parameters {
        let range = match &parameter.assumption {
            Assumption::Finite | Assumption::NonZero => Interval::WHOLE,
            Assumption::Positive | Assumption::NonNegative => Interval::new(0.0, f64::INFINITY),
            Assumption::Within { low, high } => {
                Interval::new(Interval::rational(low).lo, Interval::rational(high).hi)
            }
        };
        domain.push((parameter.symbol, range));
    }
    domain.retain(|(symbol, _)| pool.depends_on(id, *symbol));
    domain
}

/// Replaces `Global::Exists` by an open answer if a circle leaves the domain where the constraints are regular.
pub(super) fn restrict(model: &Model, problem: &Problem, global: Global) -> Global {
    let leaves = |i: usize| {
        model.coordinates[i].topology == Topology::Angle && leaves_domain(model, problem, i)
    };
    let variables = problem.variables.iter().copied();
    let mut circles = variables.filter(|i| *i < problem.coordinates);
    match global {
        Global::Exists if circles.any(leaves) => Global::Undecided(LEAVES),
        other => other,
    }
}

fn numbers(model: &Model, ids: &[ExprId], values: &Values) -> Vec<f64> {
    let value = |symbol: SymbolId| {
        let found = values.iter().find(|(known, _)| *known == symbol);
        found.map_or(0.0, |(_, value)| *value)
    };
    model.pool.eval(ids, &value)
}

/// True if the constraint mass matrix becomes singular along a circle. Its determinant is never negative, so its
/// minimum is sought.
fn leaves_domain(model: &Model, problem: &Problem, i: usize) -> bool {
    if problem.forms.is_empty() {
        return false;
    }
    let sample = sample(model, 0, uses(&model.pool, &problem.roots()));
    let mass = |angle: f64| {
        let mut values = sample.point_values();
        let found = values
            .iter_mut()
            .find(|(symbol, _)| *symbol == model.coordinates[i].q);
        if let Some((_, value)) = found {
            *value = angle;
        }
        mass_determinant(model, problem, &values).map_or(0.0, f64::abs)
    };
    let step = TAU / POINTS as f64;
    let values: Vec<f64> = (0..POINTS).map(|k| mass(k as f64 * step)).collect();
    let largest = values.iter().fold(0.0_f64, |size, value| size.max(*value));
    (0..POINTS).any(|k| {
        let [before, here, after] = [POINTS - 1, 0, 1].map(|d| values[(k + d) % POINTS]);
        let is_low = here <= LOW * largest && here <= before && here <= after;
        is_low && least(&mass, k as f64 * step, step) < SMALL * largest
    })
}

/// `det m^{ab}`; `None` where the metric or the constraint mass matrix is singular.
fn mass_determinant(model: &Model, problem: &Problem, values: &Values) -> Option<f64> {
    let space = JetSpace::new(0, 0, 1)?;
    let jets = Jets::new(Reals, &space);
    let matrix = |rows: &[Vec<ExprId>]| -> Vec<Vec<Vec<f64>>> {
        let row = |row: &Vec<ExprId>| {
            let numbers = numbers(model, row, values).into_iter();
            numbers.map(|number| jets.constant(number)).collect()
        };
        rows.iter().map(row).collect()
    };
    let forms = matrix(&problem.forms);
    let duals = solve(&jets, matrix(&problem.metric), transpose(&forms))?.unknowns;
    let duals = transpose(&duals);
    let mass = forms
        .iter()
        .map(|form| duals.iter().map(|dual| dot(&jets, form, dual)).collect())
        .collect();
    let none = vec![Vec::new(); forms.len()];
    Some(jets.value(&solve(&jets, mass, none)?.determinant))
}

/// Smallest value of `f` within `step` of a point, by golden-section search.
fn least(f: &dyn Fn(f64) -> f64, center: f64, step: f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let (mut low, mut high) = (center - step, center + step);
    for _ in 0..BISECTIONS {
        let [a, b] = [high - RATIO * (high - low), low + RATIO * (high - low)];
        match f(a) < f(b) {
            true => high = b,
            false => low = a,
        }
    }
    f(f64::midpoint(low, high))
}
