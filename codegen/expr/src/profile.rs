//! Properties of a set of expressions that decide how much a modular evaluation proves.

use crate::function::{Function, Residue};
use crate::node::{ExprId, Node};
use crate::pool::Pool;
use crate::rational::Rational;
use crate::squares::Squares;

/// The properties of the expressions below some roots.
#[derive(Clone, Debug)]
pub struct Profile {
    /// Roots or absolute values occur: their branches modulo a prime are not the real ones.
    pub branches: bool,
    /// Atoms occur that may be related in ways the residues do not show, as `ln(x y)` to `ln x` and `ln y`.
    pub hidden_relations: bool,
    /// Common denominator of the coefficients inside sin, cos and exp; `None` if there is no small one.
    pub denominator: Option<i64>,
    /// Bound for the degrees of numerators and denominators as polynomials in the drawn residues, times
    /// `Squares::odds`. Divided by the prime, it bounds the probability of an accidental zero.
    pub degree: f64,
}

impl Profile {
    /// True if a value other than 0 modulo a prime proves that an expression is not 0.
    pub fn is_exact(&self) -> bool {
        !self.branches && !self.hidden_relations
    }
}

/// Largest common denominator of the multiples of base angles; larger ones are refused.
const MAX_DENOMINATOR: i64 = 1 << 40;

impl Pool {
    /// The profile of some expressions.
    pub fn profile_of(&self, roots: &[ExprId]) -> Profile {
        self.profile(&self.reachable(roots))
    }

    /// The profile of the expressions in `order`, which is [`Pool::reachable`] of some roots.
    pub(crate) fn profile(&self, order: &[ExprId]) -> Profile {
        let mut profile = Profile {
            branches: false,
            hidden_relations: false,
            denominator: Some(1),
            degree: 0.0,
        };
        for id in order {
            match self.node(*id) {
                Node::Product(factors) => {
                    profile.branches |= factors.iter().any(|(_, exponent)| !exponent.is_integer());
                }
                Node::Call(function, argument) => self.add_call(&mut profile, *function, *argument),
                Node::Atan2(..) => profile.hidden_relations = true,
                _ => {}
            }
        }
        profile.degree = self.degree_bound(order, profile.denominator.unwrap_or(1));
        profile.degree *= Squares::odds(self, order);
        profile
    }

    fn add_call(&self, profile: &mut Profile, function: Function, argument: ExprId) {
        let residue = function.residue();
        match residue {
            Residue::Branch => profile.branches = true,
            Residue::Atom => profile.hidden_relations = true,
            Residue::Circular | Residue::Exponential => {}
        }
        if !residue.has_base() {
            return;
        }
        let (constant, terms) = self.linear_form(argument);
        let common = |denominator: Option<i64>, coefficient: &Rational| {
            least_common_multiple(denominator?, coefficient.to_small()?.1)
        };
        profile.denominator = common(profile.denominator, &constant);
        profile.hidden_relations |= !constant.is_zero();
        for (coefficient, term) in &terms {
            let exact_turn =
                (coefficient * &Rational::from(12)).is_integer() && residue == Residue::Circular;
            if *term == self.pi() && exact_turn {
                // NOTE: only sqrt(2) and sqrt(3) enter. Field automorphisms change their signs independently of each
                // other, so either choice of each root is right.
                continue;
            }
            profile.denominator = common(profile.denominator, coefficient);
            profile.hidden_relations |= !matches!(self.node(*term), Node::Symbol(_));
        }
    }

    /// Degrees of numerator and denominator are carried through all nodes; the largest is returned.
    fn degree_bound(&self, order: &[ExprId], denominator: i64) -> f64 {
        let mut degrees = vec![(0.0f64, 0.0f64); order.last().map_or(0, |id| id.index() + 1)];
        let mut largest = 0.0f64;
        for id in order {
            let degree = self.degree_of_node(*id, denominator as f64, &degrees);
            degrees[id.index()] = degree;
            largest = largest.max(degree.0).max(degree.1);
        }
        largest
    }

    fn degree_of_node(&self, id: ExprId, denominator: f64, degrees: &[(f64, f64)]) -> (f64, f64) {
        let of = |id: ExprId| degrees[id.index()];
        match self.node(id) {
            Node::Number(_) => (0.0, 0.0),
            // A symbol known to be positive is drawn as a square.
            Node::Pi | Node::Symbol(_) => (2.0, 0.0),
            Node::Sum { terms, .. } => {
                let below: f64 = terms.iter().map(|(_, term)| of(*term).1).sum();
                let above = terms
                    .iter()
                    .map(|(_, term)| of(*term).0 - of(*term).1 + below);
                (above.fold(below, f64::max), below)
            }
            Node::Product(factors) => {
                factors
                    .iter()
                    .fold((0.0, 0.0), |(above, below), (base, e)| {
                        let (size, (n, d)) = (e.to_f64().abs(), of(*base));
                        let (n, d) = if e.is_negative() { (d, n) } else { (n, d) };
                        (above + size * n, below + size * d)
                    })
            }
            Node::Call(function, argument) => {
                self.degree_of_call(*function, *argument, denominator)
            }
            Node::Atan2(..) => (1.0, 0.0),
        }
    }

    /// The functions of `n` times a base angle or base exponential have degrees up to `2 n` in numerator and
    /// denominator; quotients such as `tan` have up to twice that.
    fn degree_of_call(&self, function: Function, argument: ExprId, denominator: f64) -> (f64, f64) {
        if !function.residue().has_base() {
            return (1.0, 0.0);
        }
        let (constant, terms) = self.linear_form(argument);
        let sizes = terms
            .iter()
            .map(|(coefficient, _)| coefficient.to_f64().abs());
        let degree = 4.0 * denominator * (sizes.sum::<f64>() + constant.to_f64().abs());
        (degree, degree)
    }
}

fn least_common_multiple(a: i64, b: i64) -> Option<i64> {
    let (mut common, mut rest) = (a, b);
    while rest != 0 {
        (common, rest) = (rest, common % rest);
    }
    (a / common)
        .checked_mul(b)
        .filter(|multiple| *multiple <= MAX_DENOMINATOR)
}
