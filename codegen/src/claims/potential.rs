//! Logarithm of a density in closed form: its possible terms, and its notation.

use dalembert_expr::{ExprId, Function, Node, Pool, Rational, SymbolId, Verdict};

use super::problem::Problem;
use crate::model::{Coordinate, Topology};

/// Largest number of candidates of each kind.
const CANDIDATES: usize = 40;

/// A summand of the logarithm of a density, without its coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Term {
    /// `ln det m^{ab}`
    MassDeterminant,
    /// `ln det g`
    MetricDeterminant,
    /// `ln |det A_dep|`
    DependentDeterminant,
    /// `ln |f|`
    Logarithm(ExprId),
    /// `f`
    Plain(ExprId),
}

impl Term {
    /// The term with parameters replaced.
    pub(super) fn substituted(self, pool: &mut Pool, replacements: &[(SymbolId, ExprId)]) -> Self {
        match self {
            Self::Logarithm(f) => Self::Logarithm(pool.substitute(f, replacements)),
            Self::Plain(f) => Self::Plain(pool.substitute(f, replacements)),
            determinant => determinant,
        }
    }
}

/// The logarithm of a density: a linear combination of terms with coefficients free of coordinates.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Potential {
    /// Coefficients and their terms; empty for the density 1.
    pub terms: Vec<(ExprId, Term)>,
}

/// Terms that may occur.
#[derive(Debug)]
pub(super) struct Candidates {
    /// Terms that are single-valued, and finite wherever metric and constraints are regular.
    regular: Vec<Term>,
    /// Angles. They are not single-valued on Q.
    angles: Vec<Term>,
    /// Single-valued terms that may be infinite where the model is regular.
    singular: Vec<Term>,
}

/// Set of terms that are allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Allowed {
    /// Regular terms.
    Regular,
    /// Single-valued terms.
    SingleValued,
    /// All terms, angles included.
    All,
}

impl Candidates {
    /// The candidates of a problem.
    pub(super) fn of(pool: &mut Pool, problem: &Problem, coordinates: &[Coordinate]) -> Self {
        let mut regular = vec![Term::MassDeterminant, Term::MetricDeterminant];
        let mut singular = vec![Term::DependentDeterminant];
        let symbols = problem.symbols.clone();
        let is_angle = |symbol: &SymbolId| {
            coordinates
                .iter()
                .any(|coordinate| coordinate.q == *symbol && coordinate.topology == Topology::Angle)
        };
        let (angles, lines): (Vec<_>, Vec<_>) = symbols.iter().partition(|s| is_angle(s));
        let [angles, lines] = [angles, lines].map(|symbols| {
            symbols
                .into_iter()
                .map(|s| pool.variable(s))
                .collect::<Vec<_>>()
        });
        let parts: Vec<ExprId> = pool
            .reachable(&problem.roots())
            .into_iter()
            .filter(|id| pool.depends_on_any(*id, &symbols))
            .collect();
        let chosen = |kind: fn(&Node) -> bool| -> Vec<ExprId> {
            let of_kind = parts.iter().filter(|id| kind(pool.node(**id)));
            of_kind.copied().take(CANDIDATES).collect()
        };
        let calls = chosen(|node| matches!(node, Node::Call(..)));
        let sums = chosen(|node| matches!(node, Node::Sum { .. }));
        // Exponentials get no logarithm: `ln exp(f)` is `f`, and the plain terms contain function calls and monomials
        // of degree at most 2.
        let is_exponential = |id: &ExprId| matches!(pool.node(*id), Node::Call(Function::Exp, _));
        let arguments = calls.iter().filter(|id| !is_exponential(id)).chain(&sums);
        // A sum may cancel. Its logarithm would have no value anywhere, so no point would remain for the other terms.
        let is_zero = |id: &ExprId| pool.zero_test(*id) == Verdict::Proved;
        for id in arguments.chain(&lines).filter(|id| !is_zero(id)) {
            let kind = match pool.sign(*id).is_nonzero() {
                true => &mut regular,
                false => &mut singular,
            };
            kind.push(Term::Logarithm(*id));
        }
        regular.extend(lines.iter().copied().map(Term::Plain));
        for (i, a) in lines.iter().enumerate() {
            for b in &lines[i..] {
                regular.push(Term::Plain(pool.mul(*a, *b)));
            }
        }
        regular.extend(calls.into_iter().map(Term::Plain));
        Self {
            regular,
            angles: angles.into_iter().map(Term::Plain).collect(),
            singular,
        }
    }

    /// The terms that are allowed.
    pub(super) fn allowed(&self, allowed: Allowed) -> Vec<Term> {
        let lists: &[&Vec<Term>] = match allowed {
            Allowed::Regular => &[&self.regular],
            Allowed::SingleValued => &[&self.regular, &self.singular],
            Allowed::All => &[&self.regular, &self.angles, &self.singular],
        };
        lists.iter().copied().flatten().copied().collect()
    }
}

impl Term {
    pub(super) fn expression(self) -> Option<ExprId> {
        match self {
            Self::Logarithm(f) | Self::Plain(f) => Some(f),
            _ => None,
        }
    }
}

/// `1/2*ln(det m) - z`; `0` for the density 1.
pub fn potential_text(pool: &Pool, potential: &Potential) -> String {
    let mut text = String::new();
    for (coefficient, term) in &potential.terms {
        let (number, rest) = number_and_rest(pool, *coefficient);
        text += match (text.is_empty(), number.is_negative()) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        let mut factors = Vec::new();
        if !number.abs().is_one() {
            factors.push(number.abs().to_string());
        }
        factors.extend(rest.map(|rest| factor_text(pool, rest)));
        factors.push(term_text(pool, *term));
        text += &factors.join("*");
    }
    match text.is_empty() {
        true => "0".to_owned(),
        false => text,
    }
}

/// Product of a number and the remaining factors, if there are any.
fn number_and_rest(pool: &Pool, id: ExprId) -> (Rational, Option<ExprId>) {
    match pool.as_number(id) {
        Some(number) => (number.clone(), None),
        None => {
            let (number, rest) = pool.as_multiple(id);
            (number, Some(rest))
        }
    }
}

/// An expression as a factor: sums and fractions in parentheses.
pub(super) fn factor_text(pool: &Pool, id: ExprId) -> String {
    match pool.node(id) {
        Node::Sum { .. } => format!("({})", pool.text(id)),
        Node::Number(number) if !number.is_integer() => format!("({number})"),
        _ => pool.text(id),
    }
}

fn term_text(pool: &Pool, term: Term) -> String {
    match term {
        Term::MassDeterminant => "ln(det m)".to_owned(),
        Term::MetricDeterminant => "ln(det g)".to_owned(),
        Term::DependentDeterminant => "ln|det A_dep|".to_owned(),
        Term::Logarithm(f) => {
            let (number, rest) = pool.as_multiple(f);
            let size = if number == Rational::MINUS_ONE {
                rest
            } else {
                f
            };
            format!("ln|{}|", pool.text(size))
        }
        Term::Plain(f) => factor_text(pool, f),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::fit::has_points;
    use dalembert_expr::Assumption;

    #[test]
    fn signs_stand_once() {
        let mut pool = Pool::new();
        let [z, k] = ["z", "k"].map(|name| {
            let symbol = pool.symbol(name, name, Assumption::None);
            pool.variable(symbol)
        });
        let (minus, half, minus_z) = (pool.int(-1), pool.number(Rational::HALF), pool.neg(z));
        let minus_k = pool.neg(k);
        let potential = Potential {
            terms: vec![
                (half, Term::MassDeterminant),
                (minus, Term::Plain(z)),
                (minus_k, Term::Plain(z)),
                (minus, Term::Logarithm(minus_z)),
            ],
        };
        let text = potential_text(&pool, &potential);
        assert_eq!(text, "1/2*ln(det m) - z - k*z - ln|z|");
    }

    /// The logarithm of a sum that cancels has no value anywhere: the search would find no point.
    #[test]
    fn a_sum_that_cancels_is_no_candidate() {
        let source = "Pair { coordinates { x; y; z; }
            let hidden = sin(x)*(sin(x)*y + cos(x)*z) + cos(x)*(cos(x)*y - sin(x)*z) - y;
            lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
            constraints { c: (2 + hidden*z)*dot(z) = (x + y)*dot(x); } }";
        let (mut model, derivation) = crate::claims::derived(source);
        let problem = Problem::of(&mut model, &derivation);
        let is_zero = |pool: &Pool, id: ExprId| pool.zero_test(id) == Verdict::Proved;
        let parts = model.pool.reachable(&problem.roots());
        let is_hidden = |id: &ExprId| {
            matches!(model.pool.node(*id), Node::Sum { .. }) && is_zero(&model.pool, *id)
        };
        assert!(parts.iter().any(is_hidden), "a sum that cancels");
        let candidates = Candidates::of(&mut model.pool, &problem, &model.coordinates);
        let terms = candidates.allowed(Allowed::All);
        let mut logarithms = 0;
        for term in terms {
            if let Term::Logarithm(f) = term {
                assert!(!is_zero(&model.pool, f), "{}", model.pool.text(f));
                logarithms += 1;
            }
        }
        assert!(logarithms > 1);
        assert!(has_points(
            &model.pool,
            &problem,
            &candidates,
            Allowed::All,
            1
        ));
    }
}
