//! Configurations left out of Q because the metric, the constraints or an expression is singular there. If none is left
//! out, the loops of Q are those of the declared circles. The origin of a plane, left out by `1/(x^2 + y^2)`, has
//! further loops around it, and `1/x` divides Q.

use dalembert_expr::{ExprId, Function, JetSpace, Jets, Node, Pool, Rational, Singularity};

use super::exactness::{branches_of, sample_points};
use super::frame::frame;
use super::problem::Problem;
use super::regularity::{determinant, is_never_zero};
use crate::model::Model;

/// Reason to leave the answer open for a declaration that is not smooth: `G` may not be single-valued.
pub(super) const HOLES: &str = "G was found in no closed form, and G may grow along loops around configurations where the declaration is singular";

/// Number of points of each branch.
const SAMPLES: usize = 3;
/// Largest number of minors of the constraint forms that are written out.
const MOST_MINORS: usize = 64;

/// Components of which certain values may be left out of Q; `None` if other configurations may be left out. Expressions
/// of several components are certified to be regular everywhere. Lines and circles without some of their points have no
/// loops other than whole circles.
pub(super) fn cuts(model: &mut Model, problem: &Problem, seed: u64) -> Option<Vec<usize>> {
    let mut divisors = divisors(&mut model.pool, problem)?;
    let dependence = determinants_by_component(&model.pool, problem, seed)?;
    let mut cuts = Vec::new();
    for (components, write) in dependence.into_iter().zip([blocks_of_metric, gramian]) {
        match components.as_slice() {
            [] => {}
            [only] => cuts.push(*only),
            _ => divisors.extend(write(model, problem)?),
        }
    }
    divisors.sort_unstable();
    divisors.dedup();
    for divisor in divisors {
        let symbols = problem.symbols.iter().enumerate();
        let depends = symbols.filter(|(_, symbol)| model.pool.depends_on(divisor, **symbol));
        let components: Vec<usize> = depends.map(|(component, _)| component).collect();
        if components.is_empty() || is_never_zero(model, divisor) {
            continue;
        }
        let [only] = components.as_slice() else {
            return None;
        };
        cuts.push(*only);
    }
    Some(cuts)
}

/// The components on which `det g` and `det m^{ab}` depend; `None` if it is not known.
fn determinants_by_component(pool: &Pool, problem: &Problem, seed: u64) -> Option<[Vec<usize>; 2]> {
    let roots = problem.roots();
    let profile = pool.profile_of(&roots);
    let mut points = sample_points(pool, &roots, &profile, seed).ok()?;
    let branches = branches_of(pool, &roots, &profile, &points)?;
    let count = problem.variables.len();
    let space = JetSpace::new(count, 1, usize::MAX)?;
    let mut depends = vec![[false; 2]; count];
    points.cover(pool, &branches, SAMPLES, |point| {
        let jets = Jets::new(point.modulus(), &space);
        let frame = frame(pool, problem, &jets, point, None)?;
        for (v, depends) in depends.iter_mut().enumerate() {
            let determinants = [&frame.metric_determinant, &frame.mass_determinant];
            for (depends, determinant) in depends.iter_mut().zip(determinants) {
                *depends |= jets.value(&jets.derivative(determinant, v)) != 0;
            }
        }
        Some(true)
    })?;
    let components = problem.variables.iter().zip(&depends);
    Some([0, 1].map(|k| {
        let of_this = components.clone().filter(|(_, depends)| depends[k]);
        of_this.map(|(component, _)| *component).collect()
    }))
}

/// Expressions that must be nonzero so that all others are smooth; `None` if one of them jumps.
fn divisors(pool: &mut Pool, problem: &Problem) -> Option<Vec<ExprId>> {
    let mut divisors = Vec::new();
    for id in pool.reachable(&problem.roots()) {
        match pool.node(id).clone() {
            Node::Product(factors) => {
                let is_singular = |power: &Rational| power.is_negative() || !power.is_integer();
                let singular = factors.iter().filter(|(_, power)| is_singular(power));
                divisors.extend(singular.map(|(base, _)| *base));
            }
            Node::Call(function, argument) => match function.singularity() {
                Singularity::None | Singularity::Kink => {}
                Singularity::Logarithm { shift } => divisors.push(pool.shifted(argument, shift)),
                Singularity::Poles => divisors.push(pool.call(Function::Cos, argument)),
                Singularity::Ends => {
                    let square = pool.mul(argument, argument);
                    let one = pool.one();
                    divisors.push(pool.sub(one, square));
                }
            },
            Node::Atan2(..) => return None,
            Node::Number(_) | Node::Pi | Node::Symbol(_) | Node::Sum { .. } => {}
        }
    }
    Some(divisors)
}

/// The determinants of the blocks of the metric; `None` where one is too large to be written out.
fn blocks_of_metric(model: &mut Model, problem: &Problem) -> Option<Vec<ExprId>> {
    let mut determinants = Vec::new();
    for block in blocks(&model.pool, &problem.metric) {
        let rows: Vec<_> = block.iter().map(|i| problem.metric[*i].clone()).collect();
        determinants.push(determinant(model, &rows, &block)?);
    }
    Some(determinants)
}

/// Sets of coordinates that a symmetric matrix connects.
fn blocks(pool: &Pool, matrix: &[Vec<ExprId>]) -> Vec<Vec<usize>> {
    let mut blocks: Vec<Vec<usize>> = Vec::new();
    for i in 0..matrix.len() {
        let is_connected =
            |block: &Vec<usize>| block.iter().any(|j| !pool.is_syntactic_zero(matrix[i][*j]));
        let (joined, mut others): (Vec<_>, Vec<_>) = blocks.into_iter().partition(is_connected);
        let mut block = joined.concat();
        block.push(i);
        block.sort_unstable();
        others.push(block);
        blocks = others;
    }
    blocks
}

/// Sum of the squares of all minors of the constraint forms. It is 0 where they are dependent; `None` if there are too
/// many minors.
fn gramian(model: &mut Model, problem: &Problem) -> Option<Vec<ExprId>> {
    let mut squares = Vec::new();
    for columns in choices(problem.coordinates, problem.forms.len())? {
        let minor = determinant(model, &problem.forms, &columns)?;
        squares.push(model.pool.mul(minor, minor));
    }
    Some(vec![model.pool.sum(&squares)])
}

/// All choices of `count` columns; `None` if there are too many.
fn choices(columns: usize, count: usize) -> Option<Vec<Vec<usize>>> {
    let mut choices = vec![Vec::new()];
    for _ in 0..count {
        let mut longer = Vec::new();
        for choice in &choices {
            let first = choice.last().map_or(0, |last| last + 1);
            longer.extend((first..columns).map(|column| [choice.as_slice(), &[column]].concat()));
        }
        choices = longer;
        // Not every partial choice can be completed. Their limit is therefore larger by the factor `columns`.
        if choices.len() > MOST_MINORS * columns {
            return None;
        }
    }
    (choices.len() <= MOST_MINORS).then_some(choices)
}
