//! The invariant volume `exp(G) mu_C` of a model, in a form that can be lowered.
//!
//! `mu_C = det g / |det A_dep| dq dv_ind`: `A_dep` are the columns of the constraint forms that belong to the
//! dependent velocities. Another choice of dependent velocities changes the coordinates of `mu_C`, but not `mu_C`.

use dalembert_expr::{ExprId, Function, JetSpace, Jets, Node, Pool, Rational};

use super::exactness::{Exactness, decide_local_in, sample_points};
use super::frame::frame;
use super::global::Global;
use super::gradient::Integral;
use super::potential::{Potential, Term};
use super::problem::Problem;
use crate::mechanics::Derivation;
use crate::mechanics::constraint::regular_minor;
use crate::model::Model;

/// An invariant volume.
#[derive(Debug, Clone, PartialEq)]
pub struct Volume {
    /// `G`, without the integral.
    pub potential: Potential,
    /// Part of `G` without closed form.
    pub integral: Option<Integral>,
    /// The columns of the determinant in [`Term::DependentDeterminant`], one for each constraint.
    pub minor: Vec<usize>,
    /// The dependent velocities, one for each constraint, in increasing order. The other velocities are the
    /// coordinates of the volume besides the positions.
    pub dependent: Vec<usize>,
    /// True if `G` is a function on Q. Otherwise it is a function of the angles as stored, unwrapped.
    pub is_single_valued: bool,
}

impl Volume {
    /// The invariant volume that `exactness` established, in closed form or as an integral; `None` if the gradient of
    /// `G` cannot be solved for. `seed` determines the random points.
    pub fn found(
        model: &Model,
        derivation: &Derivation,
        problem: &Problem,
        exactness: &Exactness,
        seed: u64,
    ) -> Option<Self> {
        let regular = nowhere_singular(model, derivation);
        let minor = exactness.local.dependent.clone();
        let dependent = regular.unwrap_or_else(|| minor.clone());
        let (potential, integral) = match &exactness.density {
            Some((potential, _)) => (potential.clone(), None),
            None => {
                // The brackets of a frame that is nowhere singular are nowhere singular.
                let local = decide_local_in(&model.pool, problem, &dependent, seed).ok()?;
                let integral = Integral::of(model, problem, &local, seed)?;
                (Potential::default(), Some(integral))
            }
        };
        Some(Self {
            potential,
            integral,
            dependent,
            minor,
            is_single_valued: exactness.global == Some(Global::Exists),
        })
    }

    /// The volume of a proved density; `None` if the density depends on velocities. `seed` determines the random
    /// points.
    ///
    /// Stated densities are periodic in every angle: the language requires it.
    pub fn stated(
        model: &mut Model,
        derivation: &Derivation,
        problem: &Problem,
        density: ExprId,
        seed: u64,
    ) -> Option<Self> {
        let velocities: Vec<_> = model
            .coordinates
            .iter()
            .map(|coordinate| coordinate.qdot)
            .collect();
        if model.pool.depends_on_any(density, &velocities) {
            return None;
        }
        let dependent = nowhere_singular(model, derivation)
            .or_else(|| almost_nowhere_singular(&model.pool, problem, seed))?;
        Some(Self {
            potential: Potential {
                terms: logarithm(&mut model.pool, density),
            },
            integral: None,
            minor: dependent.clone(),
            dependent,
            is_single_valued: true,
        })
    }
}

/// Dependent velocities that are determined by the others at every state; `None` if the constraint forms show no such
/// choice. The coordinates of the volume may then be singular at some states: those of a rolling wheel are singular
/// where it rolls along an axis.
fn nowhere_singular(model: &Model, derivation: &Derivation) -> Option<Vec<usize>> {
    let pairs = regular_minor(&model.pool, &derivation.constraints)?;
    let mut dependent: Vec<usize> = pairs.into_iter().map(|(_, column)| column).collect();
    dependent.sort_unstable();
    Some(dependent)
}

/// Dependent velocities that are determined by the others at a random state, hence at almost all states.
fn almost_nowhere_singular(pool: &Pool, problem: &Problem, seed: u64) -> Option<Vec<usize>> {
    let roots = problem.roots();
    let mut points = sample_points(pool, &roots, &pool.profile_of(&roots), seed).ok()?;
    let space = JetSpace::new(problem.variables.len(), 1, usize::MAX)?;
    points.find(pool, |point| {
        let jets = Jets::new(point.modulus(), &space);
        frame(pool, problem, &jets, point, None).map(|frame| frame.dependent)
    })
}

/// `ln |f|` as a sum over the factors of `f`. The product may overflow where the sum does not.
fn logarithm(pool: &mut Pool, f: ExprId) -> Vec<(ExprId, Term)> {
    let mut terms = Vec::new();
    let mut factors = vec![(Rational::ONE, f)];
    while let Some((exponent, factor)) = factors.pop() {
        let (number, rest) = pool.as_multiple(factor);
        if rest != factor {
            let number = pool.number(number.abs());
            factors.extend([(exponent.clone(), rest), (exponent, number)]);
            continue;
        }
        let term = match pool.node(factor) {
            Node::Product(powers) => {
                let powers = powers.iter().rev();
                factors.extend(powers.map(|(base, power)| (power * &exponent, *base)));
                continue;
            }
            Node::Call(Function::Abs, inner) => {
                factors.push((exponent, *inner));
                continue;
            }
            Node::Call(Function::Exp, inner) => Term::Plain(*inner),
            Node::Number(number) if number.is_one() => continue,
            _ => Term::Logarithm(factor),
        };
        terms.push((pool.number(exponent), term));
    }
    terms
}

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert_expr::Assumption;

    #[test]
    fn logarithms_of_products_are_sums() {
        let mut pool = Pool::new();
        let symbols = ["x", "y"].map(|name| pool.symbol(name, name, Assumption::None));
        let [x, y] = symbols.map(|symbol| pool.variable(symbol));
        let area = pool.mul(x, y);
        let root = pool.pow(area, Rational::new(-1, 2));
        let y_ten = pool.scale(&Rational::from(10), y);
        let exponential = pool.call(Function::Exp, y_ten);
        let one = pool.one();
        let shifted = pool.sub(y, one);
        let size = pool.call(Function::Abs, shifted);
        let number = pool.int(-3);
        let f = pool.product(&[number, root, exponential, size]);
        let mut sum = 0.0;
        let terms = logarithm(&mut pool, f);
        assert_eq!(terms.len(), 5);
        for (coefficient, term) in terms {
            let (argument, is_plain) = match term {
                Term::Plain(argument) => (argument, true),
                Term::Logarithm(argument) => (argument, false),
                _ => panic!("{term:?}"),
            };
            // exp(10 y) overflows at y = 100.
            let value = |symbol| if symbol == symbols[0] { 0.7 } else { 100.0 };
            let values = pool.eval(&[coefficient, argument], &value);
            let term_value = if is_plain {
                values[1]
            } else {
                values[1].abs().ln()
            };
            sum += values[0] * term_value;
        }
        let expected = 3_f64.ln() - 70_f64.ln() / 2.0 + 1000.0 + 99_f64.ln();
        assert!((sum - expected).abs() < 1e-12, "{sum} for {expected}");
    }
}
