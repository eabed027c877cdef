//! Constructors of sums: `constant + sum of coefficient * term` in the normal form of [`Node::Sum`].

use crate::node::{ExprId, Node};
use crate::pool::Pool;
use crate::rational::Rational;

/// Sums up to this length are spliced into an enclosing sum.
///
/// NOTE: splicing finds cancellation. Without the limit, a chain of `n` sums, each one term longer than the last, would
/// take memory of order `n^2`.
const SPLICE_LIMIT: usize = 256;

/// A sum under construction. Its terms are in any order and may be repeated.
struct Linear {
    constant: Rational,
    terms: Vec<(Rational, ExprId)>,
}

impl Pool {
    /// `a + b`
    pub fn add(&mut self, a: ExprId, b: ExprId) -> ExprId {
        self.combine(&[(Rational::ONE, a), (Rational::ONE, b)])
    }

    /// `a - b`
    pub fn sub(&mut self, a: ExprId, b: ExprId) -> ExprId {
        self.combine(&[(Rational::ONE, a), (Rational::MINUS_ONE, b)])
    }

    /// `-a`
    pub fn neg(&mut self, a: ExprId) -> ExprId {
        self.scale(&Rational::MINUS_ONE, a)
    }

    /// The sum of all; 0 if there is none.
    pub fn sum(&mut self, summands: &[ExprId]) -> ExprId {
        let summands: Vec<_> = summands.iter().map(|id| (Rational::ONE, *id)).collect();
        self.combine(&summands)
    }

    /// The sum of `coefficient * expression`.
    pub fn combine(&mut self, summands: &[(Rational, ExprId)]) -> ExprId {
        let mut proper = summands
            .iter()
            .filter(|(_, id)| !self.is_syntactic_zero(*id));
        match (proper.next(), proper.next()) {
            (None, _) => self.zero(),
            (Some((coefficient, id)), None) => self.scale(coefficient, *id),
            _ => {
                let mut linear = Linear {
                    constant: Rational::ZERO,
                    terms: Vec::new(),
                };
                for (coefficient, id) in summands {
                    self.splice(&mut linear, coefficient, *id);
                }
                self.collect_like_terms(&mut linear);
                self.build_sum(linear)
            }
        }
    }

    /// `coefficient * id`, without distributing over a sum.
    pub fn scale(&mut self, coefficient: &Rational, id: ExprId) -> ExprId {
        if coefficient.is_one() {
            return id;
        }
        if coefficient.is_zero() {
            return self.vanishing(id);
        }
        if let Node::Number(value) = self.node(id) {
            let value = coefficient * value;
            return self.number(value);
        }
        let (inner, term) = self.as_multiple(id);
        let coefficient = coefficient * &inner;
        self.build_sum(Linear {
            constant: Rational::ZERO,
            terms: vec![(coefficient, term)],
        })
    }

    /// `0 * id`: 0, or the terms that limit the domain, each with coefficient 0.
    fn vanishing(&mut self, id: ExprId) -> ExprId {
        let mut linear = Linear {
            constant: Rational::ZERO,
            terms: Vec::new(),
        };
        self.splice(&mut linear, &Rational::ZERO, id);
        self.collect_like_terms(&mut linear);
        self.build_sum(linear)
    }

    /// Adds `scale * id` to `linear`; if `id` is a sum, adds its summands one by one.
    fn splice(&self, linear: &mut Linear, scale: &Rational, id: ExprId) {
        match self.node(id) {
            Node::Number(value) => linear.constant = &linear.constant + &(scale * value),
            Node::Sum { constant, terms } if terms.len() <= SPLICE_LIMIT => {
                linear.constant = &linear.constant + &(scale * constant);
                for (coefficient, term) in terms {
                    // A term that is itself a sum is primitive, so the recursion is two levels deep.
                    self.splice(linear, &(scale * coefficient), *term);
                }
            }
            _ => linear.terms.push((scale.clone(), id)),
        }
    }

    fn collect_like_terms(&self, linear: &mut Linear) {
        linear.terms.sort_by_key(|(_, term)| *term);
        linear.terms.dedup_by(|(coefficient, term), (total, kept)| {
            let same = term == kept;
            if same {
                *total = &*total + &*coefficient;
            }
            same
        });
        linear
            .terms
            .retain(|(coefficient, term)| !coefficient.is_zero() || !self.is_finite(*term));
    }

    /// The node of a sum with ordered, distinct terms.
    fn build_sum(&mut self, linear: Linear) -> ExprId {
        let Linear {
            constant,
            mut terms,
        } = linear;
        if terms.is_empty() {
            return self.number(constant);
        }
        if terms.len() == 1 && constant.is_zero() {
            return match &terms[0] {
                (coefficient, term) if coefficient.is_one() => *term,
                _ => self.intern(Node::Sum {
                    constant,
                    terms: terms.into(),
                }),
            };
        }
        let content = content(&constant, &terms);
        let Some(inverse) = content.recip().filter(|inverse| !inverse.is_one()) else {
            return self.intern(Node::Sum {
                constant,
                terms: terms.into(),
            });
        };
        terms
            .iter_mut()
            .for_each(|(coefficient, _)| *coefficient = &*coefficient * &inverse);
        let constant = &constant * &inverse;
        let primitive = self.intern(Node::Sum {
            constant,
            terms: terms.into(),
        });
        self.intern(Node::Sum {
            constant: Rational::ZERO,
            terms: [(content, primitive)].into(),
        })
    }
}

/// The common factor of all coefficients, with the sign of the first that is not 0. It is 1 if it does not fit machine
/// words: multiples of such sums are not shared.
fn content(constant: &Rational, terms: &[(Rational, ExprId)]) -> Rational {
    let coefficients = terms.iter().map(|(coefficient, _)| coefficient);
    let mut proper = coefficients
        .chain([constant])
        .filter(|coefficient| !coefficient.is_zero());
    let Some(first) = proper.next() else {
        return Rational::ONE;
    };
    match proper.try_fold(first.abs(), |common, coefficient| {
        common.small_gcd(coefficient)
    }) {
        Some(common) if first.is_negative() => -common,
        Some(common) => common,
        None => Rational::ONE,
    }
}
