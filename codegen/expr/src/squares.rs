//! Random points at which many roots and logarithms have values.
//!
//! A root or a logarithm has a value modulo a prime where its argument is a square, as half of the residues are: with `k`
//! independent arguments one point of `2^k` will do. So symbols are drawn again a few at a time: first those of the
//! argument with the fewest, until it and all others that are known by then are squares, and so on with the rest.

use crate::field::mix;
use crate::node::{ExprId, Function, Node, SymbolId};
use crate::point::ModularPoint;
use crate::pool::Pool;

/// So many arguments are left to chance.
const BY_CHANCE: usize = 4;
/// Draws of the symbols of a step.
const DRAWS: u64 = 256;

/// The arguments of roots and logarithms in some expressions, in steps.
#[derive(Clone, Debug, Default)]
pub(crate) struct Squares {
    steps: Vec<Step>,
}

/// Symbols that are drawn together, and the arguments of roots and logarithms that are known with them and not before.
#[derive(Clone, Debug)]
struct Step {
    symbols: Vec<SymbolId>,
    positives: Vec<ExprId>,
    /// Everything below them.
    order: Vec<ExprId>,
}

/// An argument with the symbols that it needs and that are not known yet.
type Open = (ExprId, Vec<SymbolId>);

impl Pool {
    /// The arguments of roots in `order`, each once.
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

    /// The expressions in `order` that must be squares: arguments of roots and of logarithms, each once.
    pub(crate) fn positives(&self, order: &[ExprId]) -> Vec<ExprId> {
        let mut positives = self.radicands(order);
        positives.extend(order.iter().filter_map(|id| match self.node(*id) {
            Node::Call(Function::Ln, argument) => Some(*argument),
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
    /// The steps for the expressions in `order`.
    pub(crate) fn of(pool: &Pool, order: &[ExprId]) -> Self {
        let positives = pool.positives(order);
        if positives.len() <= BY_CHANCE {
            return Self::default();
        }
        let mut open: Vec<Open> = positives
            .into_iter()
            .map(|positive| (positive, pool.symbols_below(positive)))
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
            let positives: Vec<ExprId> = known.into_iter().map(|(positive, _)| positive).collect();
            let order = pool.reachable(&positives);
            steps.push(Step {
                symbols,
                positives,
                order,
            });
        }
        Self { steps }
    }

    /// Draws the symbols of a point that were not set until all arguments are squares; `None` if those of a step are not at any of its
    /// draws.
    pub(crate) fn settle(&self, pool: &Pool, point: &mut ModularPoint, seed: u64) -> Option<()> {
        for step in &self.steps {
            let mut free = step.symbols.clone();
            free.retain(|symbol| !point.is_set(*symbol));
            (0..DRAWS).find(|draw| {
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
        pool.modular_eval_ordered(&self.order, &self.positives, point)
            .is_ok_and(|values| values.iter().all(|value| field.is_square(*value)))
    }
}
