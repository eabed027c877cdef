//! Why there is no density, in real numbers: a bracket that is a combination of others as a vector field, and the
//! demand that is not.

use dalembert_expr::{ExpansionPoint, JetSpace, Jets, Pool, SymbolId};

use super::closure::{Hull, Origin, bracket};
use super::dynamics::Number;
use super::exactness::Local;
use super::frame::{Demand, frame};
use super::problem::Problem;
use super::sample::{Sample, sample, uses};
use crate::model::Model;

/// An obstruction at a real point.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstruction {
    /// Where.
    pub sample: Sample,
    /// The frame: the name of each generator and its components.
    pub frame: Vec<(String, Vec<f64>)>,
    /// The bracket, `[X2,[X1,X2]]`.
    pub bracket: String,
    /// Its coefficients in the elements before it, as a vector field; those that are 0 are left out.
    pub relation: Vec<(String, f64)>,
    /// What the bracket demands of the derivative of `G` less what the combination demands.
    pub delta: f64,
    /// Sizes below which `delta` would be rounding.
    pub scale: f64,
}

/// Points that are tried.
const ATTEMPTS: usize = 12;
/// A delta counts from this part of its scale on.
const CLEAR: f64 = 1e-7;

/// The obstruction of a refuted density at the first real point where it shows; `None` if it shows at none, or, with
/// roots whose branches residues do not tell, not at all points that are tried.
pub fn find_obstruction(model: &Model, problem: &Problem, local: &Local) -> Option<Obstruction> {
    let roots = problem.roots();
    let has_branches = model.pool.profile_of(&roots).branches;
    let mut shown = None;
    for attempt in 0..ATTEMPTS {
        let sample = sample(model, attempt, uses(&model.pool, &roots));
        let Some(found) = obstruction_at(model, problem, local, sample) else {
            continue;
        };
        let is_clear = found.delta.abs() > CLEAR * found.scale;
        match (is_clear, has_branches) {
            (true, false) => return Some(found),
            (true, true) => {
                shown.get_or_insert(found);
            }
            (false, true) => return None,
            (false, false) => {}
        }
    }
    shown
}

impl Obstruction {
    /// The obstruction where coordinates and parameters have these values; `None` if there is none, or the point is
    /// singular.
    pub fn at(
        model: &Model,
        problem: &Problem,
        local: &Local,
        values: &[(SymbolId, f64)],
    ) -> Option<Self> {
        let mut sample = Sample::default();
        for (symbol, value) in values {
            let name = model.pool.symbol_name(*symbol).to_owned();
            sample.push(name, *symbol, *value);
        }
        obstruction_at(model, problem, local, sample)
    }
}

fn obstruction_at(
    model: &Model,
    problem: &Problem,
    local: &Local,
    sample: Sample,
) -> Option<Obstruction> {
    let mut point = sample.point();
    let elements = elements_at(
        &model.pool,
        problem,
        &local.hull,
        Some(&local.dependent),
        &mut point,
    )?;
    let names = names(
        &local.hull,
        local.hull.elements.len(),
        drift(problem, &model.pool),
    );
    let position = local.hull.obstruction?;
    let before: Vec<usize> = local
        .hull
        .basis
        .iter()
        .copied()
        .filter(|element| *element < position)
        .collect();
    let width = elements[position].len() - 1;
    let vector = |element: usize| &elements[element][..width];
    let others: Vec<&[f64]> = before.iter().map(|e| vector(*e)).collect();
    let coefficients = combine(&others, vector(position))?;
    let size = elements.iter().map(|own| largest(own)).fold(0.0, f64::max);
    // NOTE: with other branches of roots than modulo the primes, the bracket may be no combination of those before it.
    if largest(&remainder(&others, &coefficients, vector(position))) > CLEAR * size {
        return None;
    }
    let mut delta = elements[position][width];
    // Where atoms may be related, what cancels is rounding of the size of everything.
    let mut scale = match model.pool.profile_of(&problem.roots()).is_exact() {
        true => delta.abs(),
        false => size,
    };
    for (coefficient, element) in coefficients.iter().zip(&before) {
        delta -= coefficient * elements[*element][width];
        scale += (coefficient * elements[*element][width]).abs();
    }
    let relation = before
        .iter()
        .zip(&coefficients)
        .filter(|(_, coefficient)| coefficient.abs() > 1e-12)
        .map(|(element, coefficient)| (names[*element].clone(), *coefficient))
        .collect();
    let is_generator =
        |element: &usize| matches!(local.hull.elements[*element], Origin::Generator(_));
    Some(Obstruction {
        frame: (0..elements.len())
            .filter(is_generator)
            .map(|element| (names[element].clone(), vector(element).to_vec()))
            .collect(),
        sample,
        bracket: names[position].clone(),
        relation,
        delta,
        scale,
    })
}

fn largest(values: &[f64]) -> f64 {
    values
        .iter()
        .fold(0.0, |size: f64, own| size.max(own.abs()))
}

/// `target` less a combination of vectors.
fn remainder(vectors: &[&[f64]], coefficients: &[f64], target: &[f64]) -> Vec<f64> {
    let mut rest = target.to_vec();
    for (vector, coefficient) in vectors.iter().zip(coefficients) {
        for (own, entry) in rest.iter_mut().zip(*vector) {
            *own -= coefficient * entry;
        }
    }
    rest
}

/// Whether the first generator is the drift.
fn drift(problem: &Problem, pool: &Pool) -> bool {
    problem.has_drift(pool)
}

/// The values of a hull's elements at a point, the demand last.
pub(super) fn elements_at<P: ExpansionPoint>(
    pool: &Pool,
    problem: &Problem,
    hull: &Hull,
    dependent: Option<&[usize]>,
    point: &mut P,
) -> Option<Vec<Vec<Number<P>>>> {
    let order = hull.growth.len();
    let space = JetSpace::new(problem.variables.len(), order, usize::MAX)?;
    let jets = Jets::new(point.field(), &space);
    let frame = frame(pool, problem, &jets, point, dependent)?;
    let mut elements: Vec<Demand<P::Field>> = Vec::new();
    for origin in &hull.elements {
        let element = match origin {
            Origin::Generator(i) => frame.demands[*i].clone(),
            // NOTE: brackets are cut off by no order of their own; coefficients beyond their validity reach no value.
            Origin::Bracket(i, position) => bracket(
                &jets,
                &problem.variables,
                &frame.demands[*i],
                &elements[*position],
            ),
        };
        elements.push(element);
    }
    let values = |element: &Demand<P::Field>| element.iter().map(|own| jets.value(own)).collect();
    Some(elements.iter().map(values).collect())
}

/// `X1`, `[X1,X2]`, .. for the first elements of a hull; the drift is `X0`.
fn names(hull: &Hull, count: usize, has_drift: bool) -> Vec<String> {
    let generator = |i: usize| format!("X{}", if has_drift { i } else { i + 1 });
    let mut names: Vec<String> = Vec::new();
    for origin in &hull.elements[..count] {
        names.push(match origin {
            Origin::Generator(i) => generator(*i),
            Origin::Bracket(i, position) => format!("[{},{}]", generator(*i), names[*position]),
        });
    }
    names
}

/// The coefficients of `target` in independent vectors that span it, by elimination with pivots; `None` if they are
/// dependent here.
pub(super) fn combine(vectors: &[&[f64]], target: &[f64]) -> Option<Vec<f64>> {
    let mut rows: Vec<Vec<f64>> = (0..target.len())
        .map(|i| {
            let mut row: Vec<f64> = vectors.iter().map(|vector| vector[i]).collect();
            row.push(target[i]);
            row
        })
        .collect();
    let unknowns = vectors.len();
    for step in 0..unknowns {
        let pivot = (step..rows.len())
            .max_by(|a, b| rows[*a][step].abs().total_cmp(&rows[*b][step].abs()))?;
        rows.swap(step, pivot);
        let pivot = rows[step].clone();
        if pivot[step].abs() < 1e-9 {
            return None;
        }
        for (position, row) in rows.iter_mut().enumerate() {
            if position != step {
                let factor = row[step] / pivot[step];
                for (entry, pivot) in row.iter_mut().zip(&pivot) {
                    *entry -= factor * pivot;
                }
            }
        }
    }
    Some(
        (0..unknowns)
            .map(|step| rows[step][unknowns] / rows[step][step])
            .collect(),
    )
}
