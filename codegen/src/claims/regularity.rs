//! Is a density regular on all of Q? What residues do not show is looked for at real points.
//!
//! The model may have no real values. A closed form may be 0 or infinite where metric and constraints are regular: with `dx = x dy` the density `1/|x|` is
//! invariant on both sides of the leaf `x = 0` and no density on it. And a circle may leave the domain where the
//! constraints are independent, so that the system itself ends there.

use std::f64::consts::{PI, TAU};

use dalembert_expr::{ExprId, JetSpace, Jets, Reals, SymbolId};

use super::exactness::Local;
use super::geometry::{Geometry, geometry_at};
use super::global::Global;
use super::linear::{dot, solve, transpose};
use super::potential::{Potential, Term};
use super::problem::Problem;
use super::sample::{ATTEMPTS, sample, uses};
use crate::model::{Model, Topology};

/// Why a singular density leaves the question open.
pub(super) const SINGULAR: &str =
    "the density found is 0 or infinite at configurations where metric and constraints are regular";
/// Why a circle without a regular turn does.
pub(super) const LEAVES: &str = "a circle leaves the domain where the constraints are regular";

/// Segments between real points on which singularities are looked for, and points on each.
const SEGMENTS: usize = 12;
const POINTS: usize = 64;
/// Bisections: to the last digit of a number of order 1.
const BISECTIONS: usize = 60;
/// Distances from a zero, in units of a segment, between which `G` is compared; it grows by `k ln(NEAR/FAR)` if its
/// term does not cancel, with `|k|` at least [`CLEAR`]` / ln(1e5)` for the coefficients that are believed.
const DISTANCES: [f64; 2] = [1e-9, 1e-4];
const CLEAR: f64 = 0.1;
/// A determinant counts as 0 below this part of its largest value, and may become 0 near a point where it is below the
/// second one: squares of the sine are at a distance of half a step.
const SMALL: f64 = 1e-9;
const LOW: f64 = 0.1;

/// Points from which Newton's method looks for a zero, its steps, the part of the first value that counts as 0, the
/// relative step of differences, and how far out a zero may be.
const STARTS: usize = 24;
const NEWTON: usize = 80;
const ZERO: f64 = 1e-10;
const STEP: f64 = 1e-5;
const FAR: f64 = 1e6;
/// Distances from such a zero between which `G` is compared: differences place it to [`STEP`] only.
const AROUND: [f64; 2] = [1e-4, 1e-2];

/// Values of coordinates, time and parameters.
type Values = Vec<(SymbolId, f64)>;

/// Whether the model is regular at any real point; roots and logarithms have residues where they have no real values.
pub(super) fn is_real(model: &Model, problem: &Problem) -> bool {
    let roots = problem.roots();
    (0..ATTEMPTS).any(|attempt| {
        let values = sample(model, attempt, uses(&model.pool, &roots)).point_values();
        let geometry = geometry_at(&model.pool, problem, &values, None);
        geometry.is_some_and(|own| own.demands.iter().all(|own| own.is_finite()))
    })
}

/// Whether a density has no zero and no pole on the segments tried; terms that are never singular are not looked at.
pub(super) fn is_regular(
    model: &Model,
    problem: &Problem,
    local: &Local,
    found: &Potential,
) -> bool {
    let field = Field {
        model,
        problem,
        dependent: local.dependent(),
        found,
    };
    let suspects: Vec<Term> = found
        .terms
        .iter()
        .map(|(_, term)| *term)
        .filter(|term| match term {
            Term::Logarithm(f) => !model.pool.sign(*f).is_nonzero(),
            Term::DependentDeterminant => true,
            _ => false,
        })
        .collect();
    let is_regular_between = (0..SEGMENTS).all(|attempt| {
        let ends = [attempt, attempt + 1].map(|own| spread(model, problem, found, own));
        suspects
            .iter()
            .all(|term| !field.is_singular_between(*term, &ends))
    });
    is_regular_between
        && (0..STARTS).all(|attempt| {
            let start = spread(model, problem, found, attempt);
            suspects.iter().all(|term| {
                let zero = field.zero_from(*term, &start);
                zero.is_none_or(|zero| !field.is_singular_near(&zero))
            })
        })
}

/// `global`, unless a circle leaves the domain where the constraints are regular.
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

/// A real point that may lie anywhere on circles.
fn spread(model: &Model, problem: &Problem, found: &Potential, attempt: usize) -> Values {
    let mut roots = problem.roots();
    roots.extend(
        found
            .terms
            .iter()
            .flat_map(|(k, term)| [Some(*k), term.expression()])
            .flatten(),
    );
    let sample = sample(model, attempt, uses(&model.pool, &roots));
    let scale = |symbol: SymbolId| {
        let mut coordinates = model.coordinates.iter();
        match coordinates
            .find(|own| own.q == symbol)
            .map(|own| &own.topology)
        {
            Some(Topology::Angle) => PI,
            Some(Topology::Line) => 2.0,
            _ => 1.0,
        }
    };
    let values = sample.point_values();
    values
        .into_iter()
        .map(|(symbol, value)| (symbol, scale(symbol) * value))
        .collect()
}

struct Field<'f> {
    model: &'f Model,
    problem: &'f Problem,
    dependent: &'f [usize],
    found: &'f Potential,
}

impl Field<'_> {
    fn geometry(&self, values: &Values) -> Option<Geometry> {
        geometry_at(&self.model.pool, self.problem, values, Some(self.dependent))
    }

    fn number(&self, id: ExprId, values: &Values) -> f64 {
        numbers(self.model, &[id], values)[0]
    }

    /// What a term is the logarithm of.
    fn argument(&self, term: Term, values: &Values) -> Option<f64> {
        match term {
            Term::Logarithm(f) => Some(self.number(f, values)),
            _ => Some(self.geometry(values)?.dependent_determinant),
        }
    }

    /// `G`
    fn potential(&self, values: &Values) -> Option<f64> {
        let geometry = self.geometry(values)?;
        let term = |term: &Term| match term {
            Term::MassDeterminant => geometry.mass_determinant.abs().ln(),
            Term::MetricDeterminant => geometry.metric_determinant.abs().ln(),
            Term::DependentDeterminant => geometry.dependent_determinant.abs().ln(),
            Term::Logarithm(f) => self.number(*f, values).abs().ln(),
            Term::Plain(f) => self.number(*f, values),
        };
        let terms = self.found.terms.iter();
        Some(
            terms
                .map(|(k, own)| self.number(*k, values) * term(own))
                .sum(),
        )
    }

    /// Whether a term has a zero on a segment at which `G` is infinite and the model regular.
    fn is_singular_between(&self, term: Term, ends: &[Values; 2]) -> bool {
        let at = |s: f64| between(ends, s);
        let argument = |s: f64| self.argument(term, &at(s)).filter(|own| own.is_finite());
        let values: Vec<Option<f64>> = (0..=POINTS)
            .map(|k| argument(k as f64 / POINTS as f64))
            .collect();
        values.windows(2).enumerate().any(|(k, pair)| {
            let [Some(low), Some(high)] = *pair else {
                return false;
            };
            let is_change = (low > 0.0) != (high > 0.0);
            is_change && self.is_singular_at(bisect(&argument, k, low > 0.0), ends)
        })
    }

    /// A zero of a term's argument by Newton's method, `q -= f df/|df|^2`, which finds zeros without change of sign and of
    /// higher codimension too; `None` if it leads to none, or out of the chart.
    fn zero_from(&self, term: Term, start: &Values) -> Option<Values> {
        let mut values = start.clone();
        let first = self.argument(term, &values)?;
        let mut argument = first;
        for _ in 0..NEWTON {
            if !argument.is_finite() || !self.is_in_chart(&values) {
                return None;
            }
            if argument.abs() <= ZERO * first.abs() {
                return Some(values);
            }
            let slopes = self.slopes(term, &values)?;
            let steepness: f64 = slopes.iter().map(|(_, slope)| slope * slope).sum();
            for (i, slope) in slopes {
                values[i].1 -= argument * slope / steepness;
            }
            argument = self.argument(term, &values)?;
        }
        None
    }

    /// The positions of coordinates among the values, with the slope of a term's argument by each.
    fn slopes(&self, term: Term, values: &Values) -> Option<Vec<(usize, f64)>> {
        let mut slopes = Vec::new();
        for coordinate in &self.model.coordinates {
            let Some(i) = values.iter().position(|(own, _)| *own == coordinate.q) else {
                continue;
            };
            let step = STEP * (1.0 + values[i].1.abs());
            let shifted = |shift: f64| {
                let mut values = values.clone();
                values[i].1 += shift;
                self.argument(term, &values)
            };
            slopes.push((i, (shifted(step)? - shifted(-step)?) / (2.0 * step)));
        }
        Some(slopes)
    }

    fn is_in_chart(&self, values: &Values) -> bool {
        values.iter().all(|(symbol, value)| {
            let mut coordinates = self.model.coordinates.iter();
            let own = coordinates.find(|own| own.q == *symbol);
            match own.map(|own| own.topology) {
                Some(Topology::Interval { low, high }) => {
                    let ends = self.model.pool.eval(&[low, high], &|_| 0.0);
                    ends[0] < *value && *value < ends[1]
                }
                Some(Topology::Line) => value.abs() < FAR,
                _ => true,
            }
        })
    }

    /// Whether `G` grows without bound towards a point near which the model is regular.
    fn is_singular_near(&self, zero: &Values) -> bool {
        let near = |distance: f64| {
            let is_coordinate =
                |symbol: SymbolId| self.model.coordinates.iter().any(|own| own.q == symbol);
            let shifted = zero.iter().enumerate().map(|(i, (symbol, value))| {
                let direction = 1.0 + 0.3 * i as f64;
                let shift = if is_coordinate(*symbol) {
                    distance * direction
                } else {
                    0.0
                };
                (*symbol, value + shift)
            });
            let values: Values = shifted.collect();
            let mass = self.geometry(&values)?.mass_determinant;
            Some((self.potential(&values)?, mass))
        };
        let (Some(close), Some(far)) = (near(AROUND[0]), near(AROUND[1])) else {
            return false;
        };
        let growth = (close.0 - far.0).abs();
        close.1.abs() > LOW * far.1.abs() && (growth >= CLEAR || growth.is_nan())
    }

    fn is_singular_at(&self, s: f64, ends: &[Values; 2]) -> bool {
        let near = |distance: f64| {
            let values = between(ends, s + distance);
            let mass = self.geometry(&values)?.mass_determinant;
            Some((self.potential(&values)?, mass))
        };
        let (Some(close), Some(far)) = (near(DISTANCES[0]), near(DISTANCES[1])) else {
            return false;
        };
        let is_independent = close.1.abs() > SMALL * far.1.abs();
        let growth = (close.0 - far.0).abs();
        is_independent && (growth >= CLEAR || growth.is_nan())
    }
}

fn numbers(model: &Model, ids: &[ExprId], values: &Values) -> Vec<f64> {
    let value = |symbol: SymbolId| {
        let found = values.iter().find(|(own, _)| *own == symbol);
        found.map_or(0.0, |(_, value)| *value)
    };
    model.pool.eval(ids, &value)
}

fn between(ends: &[Values; 2], s: f64) -> Values {
    let [from, to] = ends;
    let value = |((symbol, from), (_, to)): (&(SymbolId, f64), &(SymbolId, f64))| {
        (*symbol, from + s * (to - from))
    };
    from.iter().zip(to).map(value).collect()
}

/// The zero of a function that changes its sign between two points of a segment.
fn bisect(f: &dyn Fn(f64) -> Option<f64>, k: usize, is_positive: bool) -> f64 {
    let (mut low, mut high) = (k as f64 / POINTS as f64, (k + 1) as f64 / POINTS as f64);
    for _ in 0..BISECTIONS {
        let middle = f64::midpoint(low, high);
        match f(middle) {
            Some(value) if (value > 0.0) == is_positive => low = middle,
            _ => high = middle,
        }
    }
    high
}

/// Whether the constraint mass matrix becomes singular on the way around a circle: its determinant is not negative, so
/// its least value is looked for.
fn leaves_domain(model: &Model, problem: &Problem, i: usize) -> bool {
    if problem.forms.is_empty() {
        return false;
    }
    let sample = sample(model, 0, uses(&model.pool, &problem.roots()));
    let mass = |angle: f64| {
        let mut values = sample.point_values();
        let own = values
            .iter_mut()
            .find(|(symbol, _)| *symbol == model.coordinates[i].q);
        if let Some((_, value)) = own {
            *value = angle;
        }
        mass_determinant(model, problem, &values).map_or(0.0, f64::abs)
    };
    let step = TAU / POINTS as f64;
    let values: Vec<f64> = (0..POINTS).map(|k| mass(k as f64 * step)).collect();
    let largest = values.iter().fold(0.0_f64, |size, own| size.max(*own));
    (0..POINTS).any(|k| {
        let [before, own, after] = [POINTS - 1, 0, 1].map(|d| values[(k + d) % POINTS]);
        let is_low = own <= LOW * largest && own <= before && own <= after;
        is_low && least(&mass, k as f64 * step, step) < SMALL * largest
    })
}

/// `det m^{ab}`; `None` where the metric or the matrix itself is singular.
fn mass_determinant(model: &Model, problem: &Problem, values: &Values) -> Option<f64> {
    let space = JetSpace::new(0, 0, 1)?;
    let jets = Jets::new(Reals, &space);
    let matrix = |rows: &[Vec<ExprId>]| -> Vec<Vec<Vec<f64>>> {
        let row = |row: &Vec<ExprId>| {
            let numbers = numbers(model, row, values).into_iter();
            numbers.map(|own| jets.constant(own)).collect()
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

/// The least value near a point, by golden sections.
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
