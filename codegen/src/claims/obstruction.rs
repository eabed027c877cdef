//! Obstruction to a density, in real numbers. The *demand* of a vector field is the derivative of `G` along it that a
//! density requires. An obstruction is a bracket that is, as a vector field, a combination of other elements of the
//! hull, while its demand differs from the same combination of the demands of these elements.

use dalembert_expr::{
    Arithmetic, BallPoint, EnclosedPoint, ExpansionPoint, JetSpace, Jets, Pool, RangePoint,
    SymbolId,
};

use super::admissible::is_admissible;
use super::closure::{Hull, Origin, bracket};
use super::dynamics::Number;
use super::exactness::Local;
use super::frame::{Demand, frame};
use super::problem::Problem;
use super::sample::{Sample, move_between_knots, sample, uses};
use crate::model::Model;

/// An obstruction at a real point.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstruction {
    /// The point of the obstruction.
    pub sample: Sample,
    /// The frame: name and components of each generator.
    pub frame: Vec<(String, Vec<f64>)>,
    /// The bracket, for example `[X2,[X1,X2]]`.
    pub bracket: String,
    /// Coefficients of the bracket, as a vector field, in the elements before it. Zeros are omitted.
    pub relation: Vec<(String, f64)>,
    /// Demand of the bracket on the derivative of `G`, minus that of the combination.
    pub delta: f64,
    /// Largest entry of the elements plus the sizes of the terms of `delta`, for comparison with rounding errors.
    pub scale: f64,
    /// True if the obstruction is proved, by an enclosure of `delta` or by residues alone.
    pub is_certain: bool,
}

/// Largest number of points that are tried.
const ATTEMPTS: usize = 64;
/// If series have more monomials than this, the obstruction is first evaluated in doubles, or in intervals of doubles
/// where residues are no proof. Both are faster than balls.
const LARGE: usize = 200;
/// Smallest ratio of `delta` to its scale at which doubles are used.
const CLEAR_IN_DOUBLES: f64 = 1e-4;
/// Largest relative radius at which the printed digits are certain.
const SHARP: f64 = 1e-9;
/// Largest remainder of a combination, relative to the elements: in doubles, and in balls.
const REMAINDER: f64 = 1e-9;
const REMAINDER_OF_BALLS: f64 = 1e-30;
/// Smallest pivot of an elimination. Vectors with a smaller pivot count as dependent.
const LEAST_PIVOT: f64 = 1e-9;

/// The obstruction at the first real point that shows one; `None` if no point tried shows one. If the hull does not
/// span all components, combinations of its elements are known only on the branches that were sampled modulo primes.
/// For a model with roots or absolute values, every point at which the bracket is such a combination must then show the
/// obstruction.
pub fn find_obstruction(model: &Model, problem: &Problem, local: &Local) -> Option<Obstruction> {
    let mut roots = problem.roots();
    roots.extend(problem.positions.roots());
    let spans = local.rank == problem.components();
    let has_branches = model.pool.profile_of(&roots).branches && !spans;
    let mut shown = None;
    for attempt in 0..ATTEMPTS {
        let mut sample = sample(model, attempt, uses(&model.pool, &roots));
        move_between_knots(model, &roots, attempt, &mut sample);
        if (problem.positions.settle_sample(model, &mut sample)).is_none() {
            continue;
        }
        let Some(found) = obstruction_at(model, problem, local, sample) else {
            continue;
        };
        match (
            found.is_certain
                && found.sample.is_allowed(model)
                && is_admissible(model, &found.sample),
            has_branches,
        ) {
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
    /// The obstruction for the given values of coordinates and parameters; `None` if there is none, or if the point is
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

    /// The obstruction with numbers rounded to eight digits, which are the same after printing and parsing.
    fn with_eight_digits(mut self) -> Self {
        self.delta = eight_digits(self.delta);
        for (_, value) in &mut self.relation {
            *value = eight_digits(*value);
        }
        for (_, components) in &mut self.frame {
            for value in components {
                *value = eight_digits(*value);
            }
        }
        self
    }
}

fn obstruction_at(
    model: &Model,
    problem: &Problem,
    local: &Local,
    sample: Sample,
) -> Option<Obstruction> {
    let question = Question {
        model,
        problem,
        local,
        sample,
    };
    let monomials =
        JetSpace::new(problem.variables.len(), local.hull.growth.len(), usize::MAX)?.len();
    let is_anywhere = problem.positions.is_everything();
    if monomials > LARGE && (is_anywhere || local.is_proof) {
        let found = match local.is_proof {
            true => question.in_doubles(),
            false => {
                let place = EnclosedPoint::of(&question.sample.point());
                question.enclosed(place, REMAINDER)
            }
        };
        if found.as_ref().is_some_and(|found| found.is_certain) {
            return found.map(Obstruction::with_eight_digits);
        }
    }
    let mut place = BallPoint::of(&question.sample.point());
    problem.positions.enclose(model, &mut place)?;
    question.enclosed(place, REMAINDER_OF_BALLS)
}

/// A hull with an obstruction, and the point at which the obstruction is computed.
struct Question<'q> {
    model: &'q Model,
    problem: &'q Problem,
    local: &'q Local,
    sample: Sample,
}

/// The ingredients of an obstruction.
struct Parts<S> {
    /// Elements of the hull. The demand is the last entry of each.
    elements: Vec<Vec<S>>,
    /// Indices of the elements of the hull's basis that come before the bracket, with their coefficients in the
    /// combination.
    relation: Vec<(usize, S)>,
    /// Remainder: the bracket minus the combination.
    rest: Vec<S>,
    /// Demands of the bracket and of the terms of the combination, and their difference `delta`.
    demands: Vec<S>,
    delta: S,
}

impl Question<'_> {
    /// The obstruction in doubles, for printing only: the residues are the proof.
    fn in_doubles(&self) -> Option<Obstruction> {
        let parts = self.parts(&mut self.sample.point())?;
        let size = |values: &[f64]| {
            values
                .iter()
                .fold(0.0, |size: f64, value| size.max(value.abs()))
        };
        let whole = parts.elements.iter().map(|element| size(element));
        if size(&parts.rest) > REMAINDER * whole.fold(0.0, f64::max) {
            return None;
        }
        let is_seen = |coefficient: f64| coefficient.abs() > REMAINDER;
        let found = self.obstruction(&parts, |value| value, is_seen);
        Some(Obstruction {
            is_certain: found.delta.abs() > CLEAR_IN_DOUBLES * found.scale,
            ..found
        })
    }

    /// The obstruction at a place in ranges. It is certain if `delta` excludes 0 and all printed values are sharp. `least` is the
    /// largest accepted remainder of the combination, relative to the elements.
    fn enclosed<P: RangePoint>(&self, mut place: P, least: f64) -> Option<Obstruction> {
        let parts = self.parts(&mut place)?;
        let sizes = |ranges: &[Number<P>]| {
            let sizes = ranges
                .iter()
                .map(|range| P::nearest(*range).abs() + P::radius(*range));
            sizes.fold(0.0, f64::max)
        };
        let whole = parts.elements.iter().map(|element| sizes(element));
        // NOTE: if roots are on other branches than modulo the primes, the bracket may not be a combination of the
        // elements before it.
        let may_vanish = |range: &Number<P>| P::sign(*range).is_none();
        let is_combination = parts.rest.iter().all(may_vanish)
            && sizes(&parts.rest) <= least * whole.fold(0.0, f64::max);
        if !is_combination {
            return None;
        }
        let is_seen = |coefficient| P::sign(coefficient).is_some();
        let is_sharp = |range| P::radius(range) <= SHARP * P::nearest(range).abs();
        let mut seen = parts
            .relation
            .iter()
            .filter(|(_, coefficient)| is_seen(*coefficient));
        Some(Obstruction {
            is_certain: is_seen(parts.delta)
                && is_sharp(parts.delta)
                && seen.all(|(_, coefficient)| is_sharp(*coefficient)),
            ..self.obstruction(&parts, P::nearest, is_seen)
        })
    }

    fn parts<P: ExpansionPoint>(&self, point: &mut P) -> Option<Parts<Number<P>>> {
        let hull = &self.local.hull;
        let field = point.field();
        let dependent = Some(self.local.dependent.as_slice());
        let elements = elements_at(&self.model.pool, self.problem, hull, dependent, point)?;
        let position = hull.obstruction?;
        let before = hull.basis.iter().copied();
        let before: Vec<usize> = before.filter(|element| *element < position).collect();
        let width = elements[position].len() - 1;
        let vector = |element: usize| &elements[element][..width];
        let others: Vec<&[Number<P>]> = before.iter().map(|e| vector(*e)).collect();
        let coefficients = combine(field, &others, vector(position))?;
        let rest = remainder(field, &others, &coefficients, vector(position));
        let mut delta = elements[position][width];
        let mut demands = vec![delta];
        for (coefficient, element) in coefficients.iter().zip(&before) {
            let part = field.mul(*coefficient, elements[*element][width]);
            delta = field.sub(delta, part);
            demands.push(part);
        }
        Some(Parts {
            relation: before.into_iter().zip(coefficients).collect(),
            elements,
            rest,
            demands,
            delta,
        })
    }

    /// The numbers to be printed.
    fn obstruction<S: Copy>(
        &self,
        parts: &Parts<S>,
        nearest: impl Fn(S) -> f64,
        is_seen: impl Fn(S) -> bool,
    ) -> Obstruction {
        let hull = &self.local.hull;
        let drift = drift(self.problem, &self.model.pool);
        let names = names(hull, hull.elements.len(), drift);
        let numbers = |values: &[S]| {
            values
                .iter()
                .map(|value| nearest(*value))
                .collect::<Vec<_>>()
        };
        let sizes = |values: &[S]| numbers(values).into_iter().map(f64::abs);
        let largest = parts.elements.iter().flat_map(|element| sizes(element));
        let seen = parts
            .relation
            .iter()
            .filter(|(_, coefficient)| is_seen(*coefficient));
        let generators = hull.elements.iter().enumerate();
        let generators = generators.filter(|(_, origin)| matches!(origin, Origin::Generator(_)));
        let frame = generators.map(|(element, _)| {
            let (_, vector) = parts.elements[element].split_last().unzip();
            (names[element].clone(), numbers(vector.unwrap_or_default()))
        });
        Obstruction {
            frame: frame.collect(),
            sample: self.sample.clone(),
            bracket: names[hull.obstruction.unwrap_or_default()].clone(),
            relation: seen
                .map(|(element, coefficient)| (names[*element].clone(), nearest(*coefficient)))
                .collect(),
            delta: nearest(parts.delta),
            scale: largest.fold(0.0, f64::max) + sizes(&parts.demands).sum::<f64>(),
            is_certain: false,
        }
    }
}

/// `target` minus a combination of vectors.
fn remainder<A: Arithmetic>(
    field: A,
    vectors: &[&[A::Scalar]],
    coefficients: &[A::Scalar],
    target: &[A::Scalar],
) -> Vec<A::Scalar> {
    let mut rest = target.to_vec();
    for (vector, coefficient) in vectors.iter().zip(coefficients) {
        for (entry_left, entry) in rest.iter_mut().zip(*vector) {
            *entry_left = field.sub(*entry_left, field.mul(*coefficient, *entry));
        }
    }
    rest
}

/// The number rounded to eight digits, which survive conversion from and to text.
fn eight_digits(value: f64) -> f64 {
    format!("{value:.7e}").parse().unwrap_or(value)
}

/// True if the first generator is the drift.
fn drift(problem: &Problem, pool: &Pool) -> bool {
    problem.has_drift(pool)
}

/// Values of the elements of a hull at a point. The demand is the last entry of each.
pub(super) fn elements_at<P: ExpansionPoint>(
    pool: &Pool,
    problem: &Problem,
    hull: &Hull,
    dependent: Option<&[usize]>,
    point: &mut P,
) -> Option<Vec<Vec<Number<P>>>> {
    let space = JetSpace::new(problem.variables.len(), hull.growth.len(), usize::MAX)?;
    let jets = Jets::new(point.field(), &space);
    let elements = elements_in(pool, problem, &jets, (hull, dependent), point)?;
    let values =
        |element: &Demand<P::Field>| element.iter().map(|entry| jets.value(entry)).collect();
    Some(elements.iter().map(values).collect())
}

/// Elements of a hull at a point, as series; the demand is the last entry of each. They are valid up to the order of
/// `jets` minus the depth of the hull.
pub(super) fn elements_in<P: ExpansionPoint>(
    pool: &Pool,
    problem: &Problem,
    jets: &Jets<'_, P::Field>,
    (hull, dependent): (&Hull, Option<&[usize]>),
    point: &mut P,
) -> Option<Vec<Demand<P::Field>>> {
    let frame = frame(pool, problem, jets, point, dependent)?;
    let mut elements: Vec<Demand<P::Field>> = Vec::new();
    for origin in &hull.elements {
        let element = match origin {
            Origin::Generator(i) => frame.demands[*i].clone(),
            // NOTE: brackets are not truncated to their valid order. Coefficients above it do not affect any value.
            Origin::Bracket(i, position) => bracket(
                jets,
                &problem.variables,
                &frame.demands[*i],
                &elements[*position],
            ),
        };
        elements.push(element);
    }
    Some(elements)
}

/// Names `X1`, `[X1,X2]`, .. of the first `count` elements of a hull. The drift is `X0`.
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

/// Coefficients of `target` in independent vectors that span it, by elimination with pivoting; `None` if the vectors
/// are dependent at the point.
pub(super) fn combine<A: Arithmetic>(
    field: A,
    vectors: &[&[A::Scalar]],
    target: &[A::Scalar],
) -> Option<Vec<A::Scalar>> {
    let mut rows: Vec<Vec<A::Scalar>> = (0..target.len())
        .map(|i| {
            let mut row: Vec<A::Scalar> = vectors.iter().map(|vector| vector[i]).collect();
            row.push(target[i]);
            row
        })
        .collect();
    let unknowns = vectors.len();
    for step in 0..unknowns {
        let size = |row: usize, rows: &[Vec<A::Scalar>]| field.size(rows[row][step]);
        let pivot =
            (step..rows.len()).max_by(|a, b| size(*a, &rows).total_cmp(&size(*b, &rows)))?;
        rows.swap(step, pivot);
        let pivot = rows[step].clone();
        if field.size(pivot[step]) < LEAST_PIVOT {
            return None;
        }
        let inverse = field.inv(pivot[step])?;
        for (position, row) in rows.iter_mut().enumerate() {
            if position != step {
                let factor = field.mul(row[step], inverse);
                for (entry, pivot) in row.iter_mut().zip(&pivot) {
                    *entry = field.sub(*entry, field.mul(factor, *pivot));
                }
            }
        }
    }
    let quotient = |step: usize| {
        let inverse = field.inv(rows[step][step])?;
        Some(field.mul(rows[step][unknowns], inverse))
    };
    (0..unknowns).map(quotient).collect()
}
