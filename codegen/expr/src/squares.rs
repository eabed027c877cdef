//! Random points modulo a prime at which many roots and logarithms are defined.
//!
//! Modulo a prime a root or a logarithm is defined where its argument is a square, which holds for half of the
//! residues. For `k` independent arguments, one of `2^k` random points is suitable on average. Symbols are therefore
//! drawn in steps. The first step draws the symbols of the argument with the fewest symbols, until this argument and
//! all others in the same symbols are squares. The later steps proceed in the same way with the remaining symbols.

use crate::field::mix;
use crate::function::Singularity;
use crate::node::{ExprId, Node, SymbolId};
use crate::point::ModularPoint;
use crate::pool::Pool;

/// Largest number of arguments for which points are drawn without steps.
const BY_CHANCE: usize = 4;
/// Number of arguments in one step from which the degree is too large for a proof.
const MOST_ARGUMENTS: usize = 64;
/// Largest number of arguments in a step for which points are sought, and number of draws per expected success.
const MOST_IN_STEP: usize = 12;
const DRAWS: u64 = 8;

/// The arguments of roots and logarithms of some expressions, divided into steps.
#[derive(Clone, Debug, Default)]
pub(crate) struct Squares {
    steps: Vec<Step>,
}

/// Symbols drawn together, and the arguments of roots and logarithms that become known with them.
#[derive(Clone, Debug)]
struct Step {
    symbols: Vec<SymbolId>,
    positives: Vec<Positive>,
    /// The subexpressions of the arguments, operands first.
    order: Vec<ExprId>,
}

/// An expression plus `shift` that must be a square.
#[derive(Copy, Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
struct Positive {
    id: ExprId,
    shift: u8,
}

/// An argument, with its symbols that are not drawn yet.
type Open = (Positive, Vec<SymbolId>);

impl Pool {
    /// The arguments of roots among the expressions in `order`, without repetition.
    pub(crate) fn radicands(&self, order: &[ExprId]) -> Vec<ExprId> {
        let mut radicands = Vec::new();
        for id in order {
            if let Node::Product(factors) = self.node(*id) {
                let of_roots = factors.iter().filter(|(_, power)| !power.is_integer());
                radicands.extend(of_roots.map(|(base, _)| *base));
            }
        }
        radicands.sort_unstable();
        radicands.dedup();
        radicands
    }

    /// Values that must be squares: arguments of roots and logarithms in `order`, without repetition.
    fn positives(&self, order: &[ExprId]) -> Vec<Positive> {
        let positive = |id: ExprId, shift: u8| Positive { id, shift };
        let radicands = self.radicands(order).into_iter();
        let mut positives: Vec<Positive> = radicands.map(|id| positive(id, 0)).collect();
        positives.extend(order.iter().filter_map(|id| match self.node(*id) {
            Node::Call(function, argument) => match function.singularity() {
                Singularity::Logarithm { shift } => Some(positive(*argument, shift)),
                _ => None,
            },
            _ => None,
        }));
        positives.sort_unstable();
        positives.dedup();
        positives
    }

    fn symbols_below(&self, id: ExprId) -> Vec<SymbolId> {
        let below = self.reachable(&[id]).into_iter();
        let symbols = below.filter_map(|id| match self.node(id) {
            Node::Symbol(symbol) => Some(*symbol),
            _ => None,
        });
        symbols.collect()
    }
}

impl Squares {
    /// The steps for the expressions in `order`. No steps are made for up to [`BY_CHANCE`] arguments.
    pub(crate) fn of(pool: &Pool, order: &[ExprId]) -> Self {
        let positives = pool.positives(order);
        match positives.len() {
            0..=BY_CHANCE => Self::default(),
            _ => Self::in_steps(pool, positives),
        }
    }

    /// Factor by which the probability of an accidental zero exceeds `degree / p`. In a step of `k` arguments, the roots
    /// multiply the degree by `2^k` and divide the number of points by `2^k`. An expression that is not identically 0
    /// after one step may be so after the next, so the probabilities of all steps are added.
    pub(crate) fn odds(pool: &Pool, order: &[ExprId]) -> f64 {
        let positives = pool.positives(order);
        let of_step = |count: usize| 4f64.powi(count.min(MOST_ARGUMENTS) as i32);
        match positives.len() {
            count @ 0..=BY_CHANCE => of_step(count),
            _ => {
                let steps = Self::in_steps(pool, positives).steps;
                let each = steps.iter().map(|step| of_step(step.positives.len()));
                1.0 + each.sum::<f64>()
            }
        }
    }

    fn in_steps(pool: &Pool, positives: Vec<Positive>) -> Self {
        let mut open: Vec<Open> = positives
            .into_iter()
            .map(|positive| (positive, pool.symbols_below(positive.id)))
            .collect();
        let mut steps = Vec::new();
        while let Some((_, symbols)) = open.iter().min_by_key(|(_, symbols)| symbols.len()) {
            let symbols = symbols.clone();
            for (_, unknown) in &mut open {
                unknown.retain(|symbol| !symbols.contains(symbol));
            }
            let (known, rest): (Vec<Open>, Vec<Open>) = open
                .into_iter()
                .partition(|(_, unknown)| unknown.is_empty());
            open = rest;
            let positives: Vec<Positive> =
                known.into_iter().map(|(positive, _)| positive).collect();
            let ids: Vec<ExprId> = positives.iter().map(|positive| positive.id).collect();
            let order = pool.reachable(&ids);
            steps.push(Step {
                symbols,
                positives,
                order,
            });
        }
        Self { steps }
    }

    /// Draws the free symbols of a point until all arguments are squares. `None` if a step has no success within its
    /// draws.
    pub(crate) fn settle(&self, pool: &Pool, point: &mut ModularPoint, seed: u64) -> Option<()> {
        for step in &self.steps {
            let mut free = step.symbols.clone();
            free.retain(|symbol| !point.is_set(*symbol));
            if step.positives.len() > MOST_IN_STEP {
                return None;
            }
            (0..DRAWS << step.positives.len()).find(|draw| {
                let other = ModularPoint::new(point.modulus(), mix(seed ^ mix(*draw)));
                for symbol in &free {
                    let value = other.value(*symbol, pool.symbol_assumption(*symbol));
                    point.set(*symbol, value);
                }
                step.is_of_squares(pool, point)
            })?;
        }
        Some(())
    }
}

impl Step {
    fn is_of_squares(&self, pool: &Pool, point: &mut ModularPoint) -> bool {
        let field = point.modulus();
        pool.residues(&self.order, point).is_ok_and(|values| {
            let value = |it: &Positive| field.add(values[it.id.index()], u64::from(it.shift));
            self.positives.iter().all(|it| field.is_square(value(it)))
        })
    }
}
