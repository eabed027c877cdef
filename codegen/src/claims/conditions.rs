//! Conditions on parameters under which a density exists although none exists for indeterminate parameters.
//!
//! Within the declared assumptions, the scan tries these conditions: one parameter is 0; two are equal; two are 0; one
//! is a small fraction at which the obstruction has a root or a pole; one is 0 and two others are equal; a polynomial
//! of degree up to 3 in up to three parameters is 0. Every trial is the rank test of [`super::exactness`] with the
//! parameters fixed. The scan leaves out conditions at which the model is degenerate, and conditions that imply a
//! simpler one already found. Other conditions may exist: the answer holds for the conditions scanned.

use dalembert_expr::{ExprId, Rational, SamplePoints, SymbolId, Verdict as Zero};

use super::exactness::{Exactness, Fixed, decide, decide_local_where, sample_points, screen};
use super::exceptional::exceptional_values;
use super::global::Global;
use super::hypersurfaces::hypersurfaces;
use super::problem::Problem;
use super::regularity::is_never_zero;
use super::undecided::Undecided;
use crate::model::{Assumption, Model, Parameter};

/// A condition on parameters. Parameters are given by their positions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Condition {
    /// The equations. All of them hold.
    pub equations: Vec<Equation>,
    /// True if the density then exists on all of Q, not only locally.
    pub is_global: bool,
}

/// An equation between parameters.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Equation {
    /// The parameter is a number.
    Value(usize, Rational),
    /// Both parameters are equal.
    Equal(usize, usize),
    /// A polynomial in the parameters is 0.
    Zero(ExprId),
}

/// Result of a scan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scan {
    /// Conditions under which a density exists, simple ones first.
    pub found: Vec<Condition>,
    /// Number of rank tests made, plus the number of values of obstructions computed.
    pub trials: usize,
    /// True if all conditions were tried; else the scan was cut off.
    pub is_complete: bool,
}

/// Smallest and largest number of trials of a scan.
const TRIALS: (usize, usize) = (16, 400);
/// Number of products of coefficients that a scan may compute. They take about a second without optimisation.
const WORK: f64 = 1.5e8;
/// Number of trials of a scan for a density on all of Q. Each of them looks for the density.
const GLOBAL_TRIALS: usize = 48;
/// Number of singular points after which a model counts as degenerate: without roots in the model, and with roots, which
/// have no value at half of the points.
const ATTEMPTS: (usize, usize) = (4, 128);

/// Conditions on parameters for a density that does not exist for indeterminate parameters. For a model without a local
/// density, these are conditions under which a local density exists. For a model with a local density, they are
/// conditions under which a density exists on all of Q. `exactness` is the decision for indeterminate parameters. `seed`
/// determines the random points.
///
/// # Errors
/// [`Undecided`], if there are no sample points.
pub fn find_conditions(
    model: &mut Model,
    problem: &Problem,
    exactness: &Exactness,
    seed: u64,
) -> Result<Scan, Undecided> {
    let mut scan = Scan {
        found: Vec::new(),
        trials: 0,
        is_complete: true,
    };
    let is_local = exactness.local.exists;
    if is_local && !matches!(exactness.global, Some(Global::Many { .. })) {
        return Ok(scan);
    }
    let roots = problem.roots();
    let profile = model.pool.profile_of(&roots);
    let limit = match is_local {
        true => GLOBAL_TRIALS,
        false => trials(problem, exactness.local.growth.len()),
    };
    let mut scanner = Scanner {
        problem,
        points: sample_points(&model.pool, &roots, &profile, seed)?,
        attempts: if profile.branches {
            ATTEMPTS.1
        } else {
            ATTEMPTS.0
        },
        parameters: problem.parameters(model),
        wants_global: is_local,
        seed,
        left: limit,
    };
    let is_complete = scanner.scan(model, exactness, &mut scan.found).is_some();
    scan.is_complete = is_complete;
    scan.trials = limit - scanner.left;
    Ok(scan)
}

impl Condition {
    /// `I13 = 0 and I23 = 0`
    pub fn text(&self, model: &Model) -> String {
        let name = |position: &usize| &model.parameters[*position].name.display;
        let equation = |equation: &Equation| match equation {
            Equation::Value(p, value) => format!("{} = {value}", name(p)),
            Equation::Equal(p, q) => format!("{} = {}", name(p), name(q)),
            Equation::Zero(polynomial) => format!("{} = 0", model.pool.text(*polynomial)),
        };
        let equations: Vec<String> = self.equations.iter().map(equation).collect();
        equations.join(" and ")
    }
}

impl Scan {
    /// `a = 0, among the conditions scanned`
    pub fn text(&self, model: &Model) -> String {
        let texts: Vec<String> = self
            .found
            .iter()
            .map(|condition| match condition.is_global {
                true => condition.text(model),
                false => format!("{} (locally)", condition.text(model)),
            })
            .collect();
        format!("{}, among the conditions scanned", texts.join("; "))
    }
}

/// Number of affordable trials. One trial takes series for the inverse metric and for a bracket of each generator with
/// each element. Their order is the depth of the hull.
fn trials(problem: &Problem, depth: usize) -> usize {
    let (n, m) = (problem.coordinates as f64, problem.forms.len() as f64);
    let products = n.powi(3) + 2.0 * n * (n - m) * (n + 1.0).powi(2);
    // Number of pairs of monomials whose product is within the order: the number of monomials in twice as many
    // variables.
    let variables = 2 * problem.variables.len();
    let pairs: f64 = (1..=depth)
        .map(|k| (variables + k) as f64 / k as f64)
        .product();
    ((WORK / (products * pairs)) as usize).clamp(TRIALS.0, TRIALS.1)
}

struct Scanner<'s> {
    problem: &'s Problem,
    points: SamplePoints,
    attempts: usize,
    /// Positions of the parameters.
    parameters: Vec<usize>,
    wants_global: bool,
    seed: u64,
    /// Trials that are left.
    left: usize,
}

impl Scanner<'_> {
    /// Tries all conditions; `None` if the scan was cut off.
    fn scan(
        &mut self,
        model: &mut Model,
        exactness: &Exactness,
        found: &mut Vec<Condition>,
    ) -> Option<()> {
        let zeros = self.zeros();
        let equals = self.equals();
        for equation in zeros.iter().chain(&equals) {
            self.try_condition(model, vec![equation.clone()], found)?;
        }
        if self.wants_global {
            return Some(());
        }
        for (i, first) in zeros.iter().enumerate() {
            for second in &zeros[i + 1..] {
                self.try_condition(model, vec![first.clone(), second.clone()], found)?;
            }
        }
        for position in self.parameters.clone() {
            let symbol = model.parameters[position].symbol;
            let (problem, local) = (self.problem, &exactness.local);
            let (seed, left) = (self.seed, &mut self.left);
            let values = exceptional_values(&model.pool, problem, local, symbol, seed, left)?;
            for value in values.into_iter().filter(|value| !value.is_zero()) {
                self.try_condition(model, vec![Equation::Value(position, value)], found)?;
            }
        }
        for first in &zeros {
            for second in &equals {
                self.try_condition(model, vec![first.clone(), second.clone()], found)?;
            }
        }
        let parameters = self.parameters.clone();
        let (problem, local) = (self.problem, &exactness.local);
        let (seed, left) = (self.seed, &mut self.left);
        for polynomial in hypersurfaces(model, problem, local, &parameters, seed, left)? {
            if !is_never_zero(model, polynomial) {
                self.try_polynomial(model, polynomial, found);
            }
        }
        Some(())
    }

    fn zeros(&self) -> Vec<Equation> {
        let zero = |position: &usize| Equation::Value(*position, Rational::ZERO);
        self.parameters.iter().map(zero).collect()
    }

    fn equals(&self) -> Vec<Equation> {
        let mut equals = Vec::new();
        for (i, p) in self.parameters.iter().enumerate() {
            for q in &self.parameters[i + 1..] {
                equals.push(Equation::Equal(*p, *q));
            }
        }
        equals
    }

    /// Adds a condition to those found if a density exists under it; `None` if no trial is left.
    fn try_condition(
        &mut self,
        model: &mut Model,
        equations: Vec<Equation>,
        found: &mut Vec<Condition>,
    ) -> Option<()> {
        let is_known = found
            .iter()
            .any(|condition| implies(model, &equations, &condition.equations));
        if is_known || !is_admitted(&model.parameters, &equations) {
            return Some(());
        }
        self.left = self.left.checked_sub(1)?;
        let fixed: Option<Vec<_>> = equations
            .iter()
            .map(|equation| fixed(model, equation))
            .collect();
        let Some(fixed) = fixed else {
            return Some(());
        };
        let (pool, problem) = (&model.pool, self.problem);
        let screened = screen(pool, problem, &mut self.points, self.attempts, &fixed);
        if screened != Some(true) {
            return Some(());
        }
        let local = decide_local_where(pool, problem, self.seed, &fixed);
        if !local.is_ok_and(|local| local.exists) {
            return Some(());
        }
        let is_global = self.is_global(model, &equations);
        if is_global || !self.wants_global {
            found.push(Condition {
                equations,
                is_global,
            });
        }
        Some(())
    }

    /// Adds the condition that a polynomial vanishes, for a polynomial at whose random zeros the density exists. If the
    /// polynomial can be solved for a parameter and no density exists then, the condition is left out.
    fn try_polynomial(&self, model: &mut Model, polynomial: ExprId, found: &mut Vec<Condition>) {
        let equations = vec![Equation::Zero(polynomial)];
        let is_global = match self.solved(model, polynomial) {
            None => false,
            Some(replacement) => {
                let problem = self.problem.substituted(&mut model.pool, &[replacement]);
                match decide(model, &problem, self.seed) {
                    Ok(decided) if decided.local.exists => decided.global == Some(Global::Exists),
                    _ => return,
                }
            }
        };
        found.retain(|condition| !implies(model, &condition.equations, &equations));
        found.push(Condition {
            equations,
            is_global,
        });
    }

    /// A parameter in which a polynomial is linear, with the value at which the polynomial is 0.
    fn solved(&self, model: &mut Model, polynomial: ExprId) -> Option<(SymbolId, ExprId)> {
        self.parameters.iter().find_map(|position| {
            let symbol = model.parameters[*position].symbol;
            let pool = &mut model.pool;
            let slope = pool.diff(polynomial, symbol);
            if pool.is_syntactic_zero(slope) || pool.depends_on(slope, symbol) {
                return None;
            }
            let zero = pool.zero();
            let rest = pool.substitute(polynomial, &[(symbol, zero)]);
            let quotient = pool.div(rest, slope);
            Some((symbol, pool.neg(quotient)))
        })
    }

    /// True if the density exists on all of Q under a condition.
    fn is_global(&self, model: &mut Model, equations: &[Equation]) -> bool {
        let replacements = replacements(model, equations);
        let problem = self.problem.substituted(&mut model.pool, &replacements);
        let exactness = decide(model, &problem, self.seed);
        exactness.is_ok_and(|exactness| exactness.global == Some(Global::Exists))
    }
}

/// Replacements of parameters that are numbers or equal to others.
fn replacements(model: &mut Model, equations: &[Equation]) -> Vec<(SymbolId, ExprId)> {
    let mut replacements = Vec::new();
    for equation in equations {
        let (position, replacement) = match equation {
            Equation::Value(p, value) => (*p, model.pool.number(value.clone())),
            Equation::Equal(p, q) => (*p, model.pool.variable(model.parameters[*q].symbol)),
            Equation::Zero(_) => continue,
        };
        replacements.push((model.parameters[position].symbol, replacement));
    }
    replacements
}

/// Symbol and value of a fixed parameter; `None` for a polynomial, or a value with large numerator or denominator.
fn fixed(model: &Model, equation: &Equation) -> Option<(SymbolId, Fixed)> {
    let symbol = |position: usize| model.parameters[position].symbol;
    match equation {
        Equation::Value(p, value) => {
            let (n, d) = value.to_small()?;
            Some((symbol(*p), Fixed::Value(n, d)))
        }
        Equation::Equal(p, q) => Some((symbol(*p), Fixed::Same(symbol(*q)))),
        Equation::Zero(_) => None,
    }
}

/// True if `known` follows from `equations`. `false` if this is not shown.
fn implies(model: &mut Model, equations: &[Equation], known: &[Equation]) -> bool {
    if let [Equation::Zero(polynomial)] = known {
        let replacements = replacements(model, equations);
        let value = model.pool.substitute(*polynomial, &replacements);
        return model.pool.zero_test(value) == Zero::Proved;
    }
    let value = |position: usize| {
        equations.iter().find_map(|equation| match equation {
            Equation::Value(p, value) if *p == position => Some(value),
            _ => None,
        })
    };
    known.iter().all(|equation| {
        equations.contains(equation)
            || matches!(equation, Equation::Equal(p, q) if value(*p).is_some() && value(*p) == value(*q))
    })
}

/// True if the declared assumptions allow the equations.
fn is_admitted(parameters: &[Parameter], equations: &[Equation]) -> bool {
    let mut fixed = Vec::new();
    equations.iter().all(|equation| match equation {
        Equation::Value(p, value) => {
            fixed.push(*p);
            Range::of(&parameters[*p].assumption).contains(value)
        }
        // An equation with a parameter that has a value already adds nothing new.
        Equation::Equal(p, q) if fixed.contains(p) || fixed.contains(q) => false,
        Equation::Equal(p, q) => {
            let [p, q] = [p, q].map(|index| Range::of(&parameters[*index].assumption));
            p.meets(&q)
        }
        Equation::Zero(_) => true,
    })
}

/// The values that an assumption admits.
struct Range {
    low: Option<Rational>,
    high: Option<Rational>,
    without_zero: bool,
}

impl Range {
    fn of(assumption: &Assumption) -> Self {
        let (low, high) = match assumption {
            Assumption::Finite | Assumption::NonZero => (None, None),
            Assumption::Positive | Assumption::NonNegative => (Some(Rational::ZERO), None),
            Assumption::Within { low, high } => (Some(low.clone()), Some(high.clone())),
        };
        let without_zero = matches!(assumption, Assumption::Positive | Assumption::NonZero);
        Self {
            low,
            high,
            without_zero,
        }
    }

    fn contains(&self, value: &Rational) -> bool {
        self.low.as_ref().is_none_or(|low| low <= value)
            && self.high.as_ref().is_none_or(|high| value <= high)
            && !(self.without_zero && value.is_zero())
    }

    /// True if both sets have a common value.
    fn meets(&self, other: &Self) -> bool {
        let both = Self {
            low: self.low.clone().max(other.low.clone()),
            high: match (&self.high, &other.high) {
                (Some(a), Some(b)) => Some(a.min(b).clone()),
                (a, b) => a.clone().or(b.clone()),
            },
            without_zero: self.without_zero || other.without_zero,
        };
        match (&both.low, &both.high) {
            (Some(low), Some(high)) if low == high => both.contains(low),
            (Some(low), Some(high)) => low < high,
            _ => true,
        }
    }
}
