//! Sign patterns: branches of expressions with absolute values and roots. A zero test must sample every branch.
//!
//! Modulo a prime that is 3 mod 4, exactly one of a nonzero residue and its negative is a square. Squares therefore
//! stand for positive numbers. A random point realises one sign for the argument of every absolute value; an expression
//! is 0 if it is 0 under every pattern of signs. The patterns that occur form an affine space over GF(2), because signs
//! of products follow from those of their factors. All patterns are known once the space no longer grows.
//!
//! A root `sqrt(u)` of a `u` that is no square needs no cases: both roots are conjugate. If a product of radicands is a
//! square `w^2`, the product of their roots is `w` or `-w`, whichever is a square modulo the prime. This branch is
//! hidden: no sign pattern shows it. Every independent relation between the signs of the radicands doubles the number
//! of hidden branches. Each pattern is sampled often enough to meet all hidden branches, except with a stated
//! probability.

use std::collections::BTreeMap;

use crate::function::Function;
use crate::node::{Assumption, ExprId, Node};
use crate::point::ModularPoint;
use crate::pool::Pool;
use crate::zero::SamplePoints;

/// Largest number of absolute values with different arguments, and of hidden relations between radicands.
const MOST_ARGUMENTS: usize = 24;
const MOST_HIDDEN: usize = 5;
/// Largest number of radicands whose relations are sought.
const MOST_RADICANDS: usize = 64;
/// Probabilities below `2^-BITS` are neglected: of a false relation, of a missed pattern, of a missed hidden branch.
const BITS: usize = 60;
/// Largest number of points at which one question is evaluated.
const MOST_VISITS: usize = 1 << 15;

/// The branches of some expressions.
#[derive(Clone, Debug, Default)]
pub struct Branches {
    /// Arguments of absolute values.
    arguments: Vec<ExprId>,
    /// Number of independent relations between radicands.
    hidden: usize,
}

/// The answer of [`SamplePoints::cover`].
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub struct Covered {
    /// True if the answer was yes at all points.
    pub holds: bool,
    /// The number of points.
    pub points: usize,
    /// The least number of points of a pattern, if the answer was yes.
    pub each: usize,
    /// The number of sign patterns.
    pub patterns: usize,
}

impl Pool {
    /// The branches of the expressions in `roots` and of all their subexpressions. `points` are sample points of these
    /// expressions. `None` if there are too many branches, or if too few points have values.
    pub fn branches(&self, roots: &[ExprId], points: &SamplePoints) -> Option<Branches> {
        let order = self.reachable(roots);
        let arguments = order.iter().filter_map(|id| match self.node(*id) {
            Node::Call(Function::Abs, argument) => Some(*argument),
            _ => None,
        });
        let mut arguments: Vec<ExprId> = arguments.collect();
        arguments.sort_unstable();
        arguments.dedup();
        let radicands = self.radicands(&order);
        let hidden = self.hidden_relations(&radicands, points.clone().unsettled())?;
        let is_in_reach = arguments.len() <= MOST_ARGUMENTS && hidden <= MOST_HIDDEN;
        is_in_reach.then_some(Branches { arguments, hidden })
    }

    /// Upper bound of the number of independent products of radicands that are squares.
    fn hidden_relations(&self, radicands: &[ExprId], mut points: SamplePoints) -> Option<usize> {
        if radicands.is_empty() {
            return Some(0);
        }
        if radicands.len() > MOST_RADICANDS {
            return None;
        }
        let order = self.reachable(radicands);
        let symbols = order.iter().filter_map(|id| match self.node(*id) {
            Node::Symbol(symbol) => Some(*symbol),
            _ => None,
        });
        let symbols: Vec<_> = symbols.collect();
        let mut patterns = Echelon::default();
        for _ in 0..BITS + radicands.len() {
            let pattern = points.find(self, |point| {
                // NOTE: elsewhere a positive symbol takes squares as values. Here it takes any residue, because its
                // root is not one of its rational functions.
                for symbol in &symbols {
                    point.set(*symbol, point.value(*symbol, Assumption::None));
                }
                self.signs(radicands, point)
            })?;
            patterns.push(pattern);
        }
        Some(radicands.len() - patterns.rows.len())
    }

    /// A bit for each expression: bit `i` is 1 if the value of expression `i` at the point is not a square.
    fn signs(&self, ids: &[ExprId], point: &mut ModularPoint) -> Option<u64> {
        let values = self.modular_eval(ids, point).ok()?;
        let field = point.modulus();
        let bit = |(i, value): (usize, &u64)| u64::from(!field.is_square(*value)) << i;
        Some(values.iter().enumerate().map(bit).sum())
    }
}

impl Branches {
    /// True if there is one branch only.
    pub fn is_single(&self) -> bool {
        self.arguments.is_empty() && self.hidden == 0
    }

    /// Number of points for each branch: `alone` if there is one branch only, else `several`.
    pub fn points_of_each(&self, (alone, several): (usize, usize)) -> usize {
        if self.is_single() { alone } else { several }
    }

    /// The sign pattern at a point.
    pub fn pattern(&self, pool: &Pool, point: &mut ModularPoint) -> Option<u64> {
        match self.arguments.as_slice() {
            [] => Some(0),
            arguments => pool.signs(arguments, point),
        }
    }

    /// Number of points for each pattern, such that each hidden branch is missed with probability `2^-BITS` at most.
    fn points(&self) -> usize {
        match self.hidden {
            0 => 0,
            hidden => {
                let missed = 1.0 - 0.5f64.powi(hidden as i32);
                (BITS as f64 * 2f64.ln() / -missed.ln()).ceil() as usize
            }
        }
    }
}

impl Covered {
    /// Upper bound of the error probability of an answer about `branches`. `accident`: probability of a wrong yes at
    /// one point.
    pub fn error(&self, branches: &Branches, accident: f64) -> f64 {
        // A positive probability must not underflow to 0.
        let least = if accident > 0.0 {
            f64::MIN_POSITIVE
        } else {
            0.0
        };
        let accident = accident.powi(self.each.min(64) as i32).max(least);
        let accidents = self.patterns as f64 * accident;
        if branches.is_single() {
            return accidents;
        }
        let missed = self.patterns as f64 * 2f64.powi(branches.hidden as i32) + 1.0;
        accidents + missed * 0.5f64.powi(BITS as i32)
    }
}

impl SamplePoints {
    /// Asks the question `holds` at `each` points of every branch, and stops at the first no. The question may set
    /// values of the point, and answers `None` at a point without a value. The result is `None` if a branch cannot be
    /// reached.
    pub fn cover(
        &mut self,
        pool: &Pool,
        branches: &Branches,
        each: usize,
        mut holds: impl FnMut(&mut ModularPoint) -> Option<bool>,
    ) -> Option<Covered> {
        let each = each.max(branches.points()).max(1);
        let mut seen = Seen::default();
        let covered = |holds: bool, seen: &Seen| Covered {
            holds,
            points: seen.visits,
            each,
            patterns: seen.counts.len(),
        };
        while !seen.is_complete(branches, each) {
            if seen.visits == MOST_VISITS {
                return None;
            }
            let (is_so, pattern) = self.find(pool, |point| {
                if !branches.arguments.is_empty()
                    && seen.is_full(branches.pattern(pool, point)?, each)
                {
                    return None;
                }
                let is_so = holds(point)?;
                Some((is_so, branches.pattern(pool, point)?))
            })?;
            seen.add(pattern);
            if !is_so {
                return Some(covered(false, &seen));
            }
        }
        Some(covered(true, &seen))
    }
}

/// The patterns that were seen.
#[derive(Default)]
struct Seen {
    counts: BTreeMap<u64, usize>,
    /// Differences between patterns.
    differences: Echelon,
    visits: usize,
    /// Visits since the space of patterns grew.
    since: usize,
}

impl Seen {
    fn add(&mut self, pattern: u64) {
        let first = self
            .counts
            .first_key_value()
            .map_or(pattern, |(least, _)| *least);
        let grows = self.differences.push(pattern ^ first);
        *self.counts.entry(pattern).or_default() += 1;
        self.visits += 1;
        self.since = if grows { 0 } else { self.since + 1 };
    }

    /// True if a pattern needs no further point. No pattern is full before the space of patterns is known, so that
    /// unseen patterns stay as likely as others.
    fn is_full(&self, pattern: u64, each: usize) -> bool {
        self.since >= BITS
            && self
                .counts
                .get(&pattern)
                .is_some_and(|count| *count >= each)
    }

    fn is_complete(&self, branches: &Branches, each: usize) -> bool {
        let patterns = 1usize << self.differences.rows.len();
        let full = self.counts.values().filter(|count| **count >= each).count();
        let is_known = branches.arguments.is_empty() || self.since >= BITS;
        self.visits > 0 && full == patterns && is_known
    }
}

/// Vectors over GF(2) with different leading bits.
#[derive(Default)]
struct Echelon {
    rows: Vec<u64>,
}

impl Echelon {
    /// Adds a vector. True if it is independent of those before.
    fn push(&mut self, vector: u64) -> bool {
        let rest = self
            .rows
            .iter()
            .fold(vector, |rest, row| rest.min(rest ^ row));
        if rest != 0 {
            self.rows.push(rest);
            self.rows.sort_unstable_by(|a, b| b.cmp(a));
        }
        rest != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;

    /// Patterns and hidden relations of an expression.
    fn counted(text: &str) -> (usize, usize) {
        let mut fixture = Fixture::new();
        let id = fixture.read(text);
        let pool = &fixture.pool;
        let profile = pool.profile_of(&[id]);
        let mut points = SamplePoints::seeded(pool, &[id], &profile, 1).unwrap();
        let branches = pool.branches(&[id], &points).unwrap();
        let covered = points.cover(pool, &branches, 3, |_| Some(true)).unwrap();
        assert!(covered.points >= 3 * covered.patterns);
        (covered.patterns, branches.hidden)
    }

    #[test]
    fn every_sign_pattern_is_met_and_no_other() {
        for (text, patterns) in [
            ("x", 1),
            ("abs(x) + abs(-x)", 2),
            ("abs(x) + abs(y) + abs(x*y)", 4),
            (
                "abs(x - 5)*abs(6 - x)*abs(y - 5)*abs(6 - y)*abs(z)*abs(z - 1)",
                64,
            ),
        ] {
            assert_eq!(counted(text).0, patterns, "{text}");
        }
    }

    #[test]
    fn roots_hide_branches_where_products_of_radicands_are_squares() {
        for (text, hidden) in [
            ("sqrt(x) + sqrt(y)", 0),
            ("sqrt(x)*sqrt(y) - sqrt(x*y)", 1),
            ("sqrt(x^4 + 2*x^2 + 1)", 1),
            ("sqrt(x^2 + 1) + sqrt(y^2 + 1)", 0),
        ] {
            assert_eq!(counted(text).1, hidden, "{text}");
        }
    }
}
