//! Positions that satisfy equations: the position equations of a model, and at an impact the gap.
//!
//! Modulo a prime, the equations are solved one after the other for a coordinate each, in which they are polynomials of
//! degree 1 or 2. Real positions are found by Newton's method, and enclosed by Krawczyk's test: with `J` the Jacobian
//! in as many coordinates as there are equations, `x` a position and `X` the ranges `x + r`, a solution lies in `X` if
//!
//! ```text
//! |J(x)^{-1} F(x)| + |1 - J(x)^{-1} J(X)| r < r        in each component
//! ```

use dalembert_expr::{
    Arithmetic, Ball, BallPoint, ExpansionPoint, ExprId, JetSpace, Jets, ModularPoint, Pool,
    Rational, SymbolId, Verdict as Zero,
};

use super::dynamics::Number;
use super::evidence::in_arguments;
use super::linear::{Matrix, solve};
use super::sample::Sample;
use crate::model::Model;

/// Largest number of steps from a sample to a position.
const LONGEST_SEARCH: usize = 60;
/// Relative step after which a search ends, and relative last step of a search that succeeds.
const STEP: [f64; 2] = [1e-15, 1e-13];
/// Newton steps from 16 digits to 76, and one more.
const STEPS: usize = 4;
/// Relative accuracy of their result, with a margin.
const CLOSE: f64 = 1e-60;
/// Largest number of ways to solve the equations.
const WAYS: usize = 8;
/// Largest number of equations that are solved.
const EQUATIONS: usize = 4;

/// A choice of roots: bit `i` is 1 for the second root of the polynomial number `i` of degree 2. `None` leaves a point
/// where it is.
pub(super) type Choice = Option<usize>;

/// The positions at which equations hold. Without equations these are all positions.
#[derive(Debug, Clone, Default)]
pub(super) struct Locus {
    equations: Vec<Equation>,
    coordinates: Vec<SymbolId>,
    /// Ways to solve the equations, each for one coordinate. The coordinate of a polynomial does not occur in those
    /// before it.
    ways: Vec<Vec<Polynomial>>,
}

/// An equation `value = 0` with the derivatives by the coordinates.
#[derive(Debug, Clone)]
struct Equation {
    value: ExprId,
    slopes: Vec<ExprId>,
}

impl Locus {
    /// The positions that satisfy the position equations of a model.
    pub(super) fn of_model(model: &mut Model) -> Self {
        Self::new(model, position_equations(model))
    }

    /// The positions of a model on a surface.
    pub(super) fn on_surface(model: &mut Model, gap: ExprId) -> Self {
        let mut values = position_equations(model);
        values.push(gap);
        Self::new(model, values)
    }

    fn new(model: &mut Model, values: Vec<ExprId>) -> Self {
        let coordinates = coordinates(model);
        let equation = |value| Equation {
            value,
            slopes: (coordinates.iter())
                .map(|symbol| model.pool.diff(value, *symbol))
                .collect(),
        };
        let equations: Vec<Equation> = values.iter().copied().map(equation).collect();
        let mut ways = Vec::new();
        if !values.is_empty() && values.len() <= EQUATIONS {
            let all: Vec<_> = values
                .iter()
                .map(|value| polynomials(model, *value, &coordinates))
                .collect();
            let left = (0..values.len()).collect();
            find_ways(&model.pool, (&values, &all), left, Vec::new(), &mut ways);
        }
        Self {
            equations,
            coordinates,
            ways,
        }
    }

    /// True if there are no equations.
    pub(super) fn is_everything(&self) -> bool {
        self.equations.is_empty()
    }

    /// True if points modulo primes reach every component of the solutions.
    pub(super) fn is_solved(&self) -> bool {
        self.is_everything() || !self.ways.is_empty()
    }

    /// Choices of roots for [`Locus::settle`] that reach every component of the solutions. Equations that are not solved
    /// leave points where they are.
    pub(super) fn choices(&self) -> Vec<Choice> {
        if self.ways.is_empty() {
            return vec![None];
        }
        let squares = |way: &Vec<Polynomial>| way.iter().filter(|part| !part.is_linear).count();
        let most = self.ways.iter().map(squares).max().unwrap_or(0);
        (0..1 << most).map(Some).collect()
    }

    /// The equations.
    pub(super) fn roots(&self) -> impl Iterator<Item = ExprId> {
        self.equations.iter().map(|equation| equation.value)
    }

    /// The equations with symbols replaced.
    pub(super) fn substituted(&self, pool: &mut Pool, replacements: &[(SymbolId, ExprId)]) -> Self {
        let mut locus = self.clone();
        for equation in &mut locus.equations {
            equation.value = pool.substitute(equation.value, replacements);
            equation.slopes = pool.substitute_all(&equation.slopes, replacements);
        }
        for polynomial in locus.ways.iter_mut().flatten() {
            let replaced = polynomial
                .coefficients
                .map(|part| pool.substitute(part, replacements));
            polynomial.coefficients = replaced;
        }
        locus
    }

    /// True if a coordinate for which the equations are solved occurs in the argument of a function. The residue of the
    /// function is drawn at random for an argument that is not a solution. An expression that vanishes for any argument
    /// vanishes at the solutions; the residues of other expressions prove nothing.
    pub(super) fn hides(&self, pool: &Pool, roots: &[ExprId]) -> bool {
        let solved = self.ways.iter().flatten();
        let solved: Vec<SymbolId> = solved.map(|polynomial| polynomial.symbol).collect();
        in_arguments(pool, roots, &solved)
    }

    /// Moves a point to a solution; `None` if there is none with these values of the other coordinates.
    pub(super) fn settle(
        &self,
        pool: &Pool,
        point: &mut ModularPoint,
        choice: Choice,
    ) -> Option<()> {
        let Some(choice) = choice else {
            return Some(());
        };
        *point = self.ways.iter().find_map(|way| {
            let mut trial = point.clone();
            let mut choice = choice;
            for polynomial in way {
                polynomial.settle(pool, &mut trial, choice & 1 == 1)?;
                choice >>= u32::from(!polynomial.is_linear);
            }
            Some(trial)
        })?;
        Some(())
    }

    /// Moves a real sample to a solution by Newton's method, in the coordinates in which the equations are steepest.
    pub(super) fn settle_sample(&self, model: &Model, sample: &mut Sample) -> Option<()> {
        if self.is_everything() {
            return Some(());
        }
        let mut last = f64::INFINITY;
        for _ in 0..LONGEST_SEARCH {
            let mut point = sample.point();
            let columns = self.steepest(model, &mut point, |value| value)?;
            let steps = self.newton(model, &mut point, &columns)?;
            last = 0.0;
            for (column, step) in columns.iter().zip(steps) {
                let symbol = self.coordinates[*column];
                let value = point.value(symbol);
                let unit = 1.0 + value.abs();
                last = f64::max(last, step.abs() / unit);
                sample.set(symbol, value - step.clamp(-0.5 * unit, 0.5 * unit));
            }
            if last <= STEP[0] {
                return Some(());
            }
        }
        (last <= STEP[1]).then_some(())
    }

    /// Replaces coordinates of a point near a solution by ranges that contain a solution. `None` if that is not certain.
    pub(super) fn enclose(&self, model: &Model, point: &mut BallPoint) -> Option<()> {
        if self.is_everything() {
            return Some(());
        }
        let columns = self.steepest(model, point, Ball::nearest)?;
        let symbols: Vec<SymbolId> = columns.iter().map(|i| self.coordinates[*i]).collect();
        let field = point.field();
        for _ in 0..STEPS {
            let steps = self.newton(model, point, &columns)?;
            for (symbol, step) in symbols.iter().zip(steps) {
                let moved = field.sub(point.symbol(&model.pool, *symbol), step);
                point.set_symbol(*symbol, moved.midpoint());
            }
        }
        let steps = self.newton(model, point, &columns)?;
        let [_, there] = self.at(model, point, &columns)?;
        let places = symbols
            .iter()
            .map(|symbol| point.symbol(&model.pool, *symbol));
        let places: Vec<Ball> = places.collect();
        let radii = places.iter().map(|place| CLOSE * (1.0 + place.magnitude()));
        let radii: Vec<f64> = radii.collect();
        for ((symbol, place), radius) in symbols.iter().zip(&places).zip(&radii) {
            point.set_symbol(*symbol, place.widened(*radius));
        }
        let [_, around] = self.at(model, point, &columns)?;
        let space = JetSpace::new(0, 0, 1)?;
        let jets = Jets::new(field, &space);
        let turned = solve(&jets, there, around)?.unknowns;
        let is_within = |i: usize| {
            let spread = |j: usize| {
                let unit = field.integer(i64::from(i == j));
                field.sub(unit, jets.value(&turned[i][j])).magnitude() * radii[j]
            };
            let reach = steps[i].magnitude() + (0..columns.len()).map(spread).sum::<f64>();
            // Far above the rounding errors of these sums.
            reach < 0.99 * radii[i]
        };
        (0..columns.len()).all(is_within).then_some(())
    }

    /// The values of the equations as a column, and their derivatives by the coordinates `columns`.
    fn at<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        columns: &[usize],
    ) -> Option<[Matrix<P::Field>; 2]> {
        let values = self.values(model, point)?;
        let space = JetSpace::new(0, 0, 1)?;
        let jets = Jets::new(point.field(), &space);
        let entry = |id: &ExprId| jets.constant(values[id.index()]);
        let column = |equation: &Equation| vec![entry(&equation.value)];
        let row = |equation: &Equation| {
            columns
                .iter()
                .map(|i| entry(&equation.slopes[*i]))
                .collect()
        };
        let equations = self.equations.iter();
        Some([
            equations.clone().map(column).collect(),
            equations.map(row).collect(),
        ])
    }

    fn values<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
        let slopes = self.equations.iter().flat_map(|equation| &equation.slopes);
        let roots: Vec<ExprId> = self.roots().chain(slopes.copied()).collect();
        point.values(&model.pool, &model.pool.reachable(&roots))
    }

    /// The step of Newton's method in the coordinates `columns`: the change with the opposite sign.
    fn newton<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        columns: &[usize],
    ) -> Option<Vec<Number<P>>> {
        let [values, slopes] = self.at(model, point, columns)?;
        let space = JetSpace::new(0, 0, 1)?;
        let jets = Jets::new(point.field(), &space);
        let steps = solve(&jets, slopes, values)?.unknowns;
        Some(steps.iter().map(|row| jets.value(&row[0])).collect())
    }

    /// Coordinates in which the equations are steepest, one for each, by elimination with complete pivoting.
    fn steepest<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        nearest: impl Fn(Number<P>) -> f64,
    ) -> Option<Vec<usize>> {
        let values = self.values(model, point)?;
        let row = |equation: &Equation| -> Vec<f64> {
            let slopes = equation.slopes.iter();
            slopes.map(|slope| nearest(values[slope.index()])).collect()
        };
        let mut rows: Vec<Vec<f64>> = self.equations.iter().map(row).collect();
        let mut columns = Vec::new();
        while !rows.is_empty() {
            let entries = rows.iter().enumerate();
            let entries = entries.flat_map(|(i, row)| (0..row.len()).map(move |j| (i, j, row[j])));
            let (i, j, pivot) = entries.max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()))?;
            if pivot == 0.0 {
                return None;
            }
            let chosen = rows.swap_remove(i);
            for row in &mut rows {
                let share = row[j] / pivot;
                row.iter_mut()
                    .zip(&chosen)
                    .for_each(|(entry, other)| *entry -= share * other);
                row[j] = 0.0;
            }
            columns.push(j);
        }
        Some(columns)
    }
}

/// Left sides of the position equations of a model.
fn position_equations(model: &Model) -> Vec<ExprId> {
    let constraints = model
        .constraints
        .iter()
        .filter(|constraint| constraint.is_of_positions);
    constraints
        .filter_map(|constraint| constraint.level)
        .collect()
}

fn coordinates(model: &Model) -> Vec<SymbolId> {
    model
        .coordinates
        .iter()
        .map(|coordinate| coordinate.q)
        .collect()
}

/// Extends a way from its end: the coordinate of the last polynomial occurs in no other equation, that of the last but
/// one in no other equation but the last, and so on.
fn find_ways(
    pool: &Pool,
    given: (&[ExprId], &[Vec<Polynomial>]),
    left: Vec<usize>,
    end: Vec<Polynomial>,
    ways: &mut Vec<Vec<Polynomial>>,
) {
    if left.is_empty() {
        ways.push(end);
        return;
    }
    let (values, polynomials) = given;
    for equation in &left {
        let others: Vec<usize> = left
            .iter()
            .filter(|other| *other != equation)
            .copied()
            .collect();
        for polynomial in &polynomials[*equation] {
            let occurs = |other: &usize| pool.depends_on(values[*other], polynomial.symbol);
            if ways.len() == WAYS {
                return;
            }
            if !others.iter().any(occurs) {
                let mut end = end.clone();
                end.insert(0, polynomial.clone());
                find_ways(pool, given, others.clone(), end, ways);
            }
        }
    }
}

/// A coordinate in which an equation is `c + b s + a s^2 = 0`, with the expressions whose values at s = 0 are c, b, a.
#[derive(Debug, Clone)]
struct Polynomial {
    symbol: SymbolId,
    coefficients: [ExprId; 3],
    is_linear: bool,
}

impl Polynomial {
    /// Sets the coordinate to a root; `None` if there is none.
    fn settle(&self, pool: &Pool, point: &mut ModularPoint, is_second: bool) -> Option<()> {
        let field = point.modulus();
        let mut trial = point.clone();
        trial.set(self.symbol, 0);
        let values = pool.modular_eval(&self.coefficients, &mut trial).ok()?;
        let [c, b, a] = values.as_slice() else {
            return None;
        };
        let solution = if *a == 0 {
            field.mul(field.neg(*c), field.inv(*b)?)
        } else {
            let four = field.integer(4);
            let square = field.sub(field.mul(*b, *b), field.mul(four, field.mul(*a, *c)));
            let root = field.sqrt(square)?;
            let root = if is_second { field.neg(root) } else { root };
            let twice = field.inv(field.mul(field.integer(2), *a))?;
            field.mul(field.sub(root, *b), twice)
        };
        point.set(self.symbol, solution);
        Some(())
    }
}

/// A coordinate in which an equation is linear, with its value at the solutions.
pub(super) fn solution(model: &mut Model, equation: ExprId) -> Option<(SymbolId, ExprId)> {
    let all = polynomials(model, equation, &coordinates(model));
    let found = all.iter().find(|polynomial| polynomial.is_linear)?;
    let [_, slope, _] = found.coefficients;
    let zero = model.pool.zero();
    let constant = model.pool.substitute(equation, &[(found.symbol, zero)]);
    let quotient = model.pool.div(constant, slope);
    Some((found.symbol, model.pool.neg(quotient)))
}

/// The coordinates in which an equation is a polynomial of degree 1 or 2 whose leading coefficient is 0 nowhere, or whose
/// constant term is 0 nowhere.
///
/// NOTE: every component of the solutions is then reached by solving for the coordinate: one that is missed consists of
/// all places at which every coefficient is 0. `x*y` has no such coordinate: solving for `x` misses the component
/// `y = 0`.
fn polynomials(model: &mut Model, equation: ExprId, coordinates: &[SymbolId]) -> Vec<Polynomial> {
    let mut found = Vec::new();
    let mut moving = coordinates.to_vec();
    moving.push(model.time);
    for symbol in coordinates {
        let pool = &mut model.pool;
        let first = pool.diff(equation, *symbol);
        let second = pool.diff(first, *symbol);
        let third = pool.diff(second, *symbol);
        let is_zero = |id: ExprId, pool: &Pool| pool.zero_test(id) == Zero::Proved;
        let is_linear = is_zero(second, pool);
        let leading = if is_linear { first } else { second };
        // A factor that contains only parameters vanishes on no component.
        let is_unit = !pool.depends_on_any(leading, &moving)
            || (pool.sign(leading).is_nonzero() && pool.is_finite(leading));
        let zero = pool.zero();
        let constant = pool.substitute(equation, &[(*symbol, zero)]);
        let is_complete = is_unit || pool.sign(constant).is_nonzero();
        if is_zero(third, pool) && !is_zero(leading, pool) && is_complete {
            found.push(Polynomial {
                symbol: *symbol,
                coefficients: [equation, first, pool.scale(&Rational::HALF, second)],
                is_linear,
            });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use dalembert_expr::{RangePoint, RealPoint};

    use super::*;

    /// Midpoint and radius of the range of `x` that encloses a point of the unit circle next to `(x, 0.3)`.
    fn enclosed(x: f64) -> Option<(f64, f64)> {
        let declaration = "pub Sample { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2;
            constraints { circle: x^2 + y^2 = 1; } }";
        let (mut model, _) = crate::claims::derived(declaration);
        let circle = Locus::of_model(&mut model);
        let [first, second] = [0, 1].map(|i| model.coordinates[i].q);
        let mut point = RealPoint::default();
        point.set(first, x);
        point.set(second, 0.3);
        let mut point = BallPoint::of(&point);
        circle.enclose(&model, &mut point)?;
        let range = point.symbol(&model.pool, first);
        Some((range.nearest(), range.radius()))
    }

    #[test]
    fn a_position_on_the_surface_is_enclosed() {
        let root = 0.91_f64.sqrt();
        let (place, radius) = enclosed(root).expect("a range");
        assert!(
            (place - root).abs() < 1e-15 && radius < 1e-59,
            "{place} within {radius:e}"
        );
    }

    #[test]
    fn a_position_off_the_surface_is_not() {
        // Far from the circle, a step of Newton's method only halves the distance.
        assert_eq!(enclosed(5e5), None);
    }
}
