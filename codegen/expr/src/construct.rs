//! Constructors of nodes, and the list of all their rewrites. There is no other way to build a node.
//!
//! A rewrite holds wherever both sides are defined and never enlarges the domain. A property is *known* if it follows
//! from the structure of the expression and the assumptions; see [`Pool::sign`] and [`Pool::is_finite`].
//!
//! **Sums** (`sum.rs`: [`Pool::add`], [`Pool::sub`], [`Pool::neg`], [`Pool::sum`])
//! - numbers are added; `c x + d x -> (c+d) x`; `0 x -> 0` only if `x` is known finite, else the term stays with
//!   coefficient 0;
//! - a sum or a multiple of a sum is merged into an enclosing sum of at least two summands, unless it has more than 256
//!   terms;
//! - terms are ordered by id;
//! - the common factor of the coefficients, with the sign of the first coefficient, is taken out:
//!   `2 a - 4 b -> 2 (a - 2 b)`, `-a - b -> -(a + b)`. A number times a sum is therefore a coefficient of the shared
//!   sum and is never distributed.
//!
//! **Products and powers** (`product.rs`: [`Pool::mul`], [`Pool::div`], [`Pool::product`], [`Pool::pow`],
//! [`Pool::sqrt`])
//! - numeric coefficients move out into a sum of one term; nested products are merged; factors are ordered by id of the
//!   base;
//! - `x^a x^b -> x^(a+b)` if this does not change the domain: exponents of one kind, a negative total, or a base known
//!   to be nonzero or nonnegative as the exponents require. Otherwise a factor that limits the domain is kept: `x^3/x`
//!   is `x^3 x^-1`, `x/x` is `x x^-1`, `sqrt(x)^2` is the square of `sqrt(x)`;
//! - `(x y)^n -> x^n y^n` for integers `n`; `(x^a)^b -> x^(a b)` for integers `b`, and for fractions `b` if `a` is an
//!   odd integer or a fraction, or `x` is known nonnegative. The domain of `x^a` is guarded as above;
//! - `(x^a y)^b -> x^(a b) y^b` for fractions `b` if `x` is known positive and `a b` is an integer;
//! - powers of numbers are computed up to [`MAX_BITS`](crate::MAX_BITS) bits; rational roots are taken,
//!   `2^(3/2) -> 2 sqrt(2)`; `(c x)^b -> c^b x^b` for fractions `b` if `c > 0` has a rational power;
//! - `sqrt(a + b sqrt(r)) -> sqrt((a + c)/2) + sqrt((a - c)/2)` if `c = sqrt(a^2 - b^2 r)` is rational, with a minus
//!   sign for a negative `b` (`constants.rs`); the reciprocal of such a root likewise;
//! - `x^0 -> 1` if `x` is known finite, else `1 + 0 x`.
//!
//! **Functions** (`call.rs`: [`Pool::call`], [`Pool::atan2`])
//! - `f(-x) -> -f(x)` for sin, tan, asin, atan, sinh, tanh, asinh; `f(-x) -> f(x)` for cos, cosh, abs;
//! - sin and cos of `x + k pi/2` become sin and cos of `x`, with a sign; sin and cos of rational multiples of `pi` if
//!   the values are rational, tan if its value is 0 or +-1;
//! - values at 0 of exp, cosh, abs, log1p and of all odd functions, and ln at 1;
//! - asin, acos and atan of numbers and of square roots, if the angle is in the tables of `constants.rs` (multiples of
//!   `pi/12`);
//! - `ln(exp x) -> x`; `abs(x)` is `x` or `-x` if the sign of `x` is known; `abs(c x) -> |c| abs(x)`;
//! - `atan2(0, x) -> 0` for `x` known positive and finite.

use crate::node::{ExprId, Node, SymbolId};
use crate::pool::Pool;
use crate::rational::Rational;

impl Pool {
    /// An exact number.
    pub fn number(&mut self, value: Rational) -> ExprId {
        self.intern(Node::Number(value))
    }

    /// An integer.
    pub fn int(&mut self, value: i64) -> ExprId {
        self.number(Rational::from(value))
    }

    /// A symbol as an expression.
    pub fn variable(&mut self, symbol: SymbolId) -> ExprId {
        self.intern(Node::Symbol(symbol))
    }

    /// Coefficient and term of an expression: `(c, x)` if it is `c x` with a number `c`, otherwise `(1, id)`.
    pub fn as_multiple(&self, id: ExprId) -> (Rational, ExprId) {
        match self.node(id) {
            Node::Sum { constant, terms } => match &**terms {
                [(coefficient, term)] if constant.is_zero() => (coefficient.clone(), *term),
                _ => (Rational::ONE, id),
            },
            _ => (Rational::ONE, id),
        }
    }

    /// An expression as `constant + sum of coefficient * term`. Multiples of sums are distributed, so no term is a
    /// number or a sum.
    pub fn linear_form(&self, id: ExprId) -> (Rational, Vec<(Rational, ExprId)>) {
        let mut constant = Rational::ZERO;
        let mut linear = Vec::new();
        let mut pending = vec![(Rational::ONE, id)];
        while let Some((scale, id)) = pending.pop() {
            match self.node(id) {
                Node::Number(value) => constant = &constant + &(&scale * value),
                Node::Sum {
                    constant: summand,
                    terms,
                } => {
                    constant = &constant + &(&scale * summand);
                    pending.extend(terms.iter().rev().map(|(c, term)| (&scale * c, *term)));
                }
                _ => linear.push((scale, id)),
            }
        }
        (constant, linear)
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::Fixture;
    use crate::{ExprId, Node, Pool, Rational};

    /// Asserts that both texts of each pair build the same node.
    fn same(pairs: &[(&str, &str)]) {
        let mut fixture = Fixture::new();
        for (left, right) in pairs {
            let ids = fixture.read_all([left, right]);
            assert_eq!(
                ids[0],
                ids[1],
                "{left} is {}, {right} is {}",
                fixture.pool.text(ids[0]),
                fixture.pool.text(ids[1])
            );
        }
    }

    /// Asserts that the texts of each pair build different nodes: the rewrite would enlarge the domain or is not made.
    fn different(pairs: &[(&str, &str)]) {
        let mut fixture = Fixture::new();
        for (left, right) in pairs {
            let ids = fixture.read_all([left, right]);
            assert_ne!(ids[0], ids[1], "{left} became {right}");
        }
    }

    /// The coefficient 1/2001 cannot leave these powers: its own would have more than `MAX_BITS` bits.
    #[test]
    fn a_multiple_keeps_a_coefficient_whose_power_is_too_long() {
        different(&[
            ("((2*x + y)/2001)^400", "(2*x + y)^400"),
            ("z*((2*x + y)/2001)^(-400)", "z*(2*x + y)^(-400)"),
        ]);
        same(&[("((2*x + y)/2001)^400", "((x + y/2)*2/2001)^400")]);
    }

    #[test]
    fn sums_collect_like_terms() {
        same(&[
            ("x + y", "y + x"),
            ("x + x", "2*x"),
            ("x - x", "0"),
            ("(x + y) - (y + x)", "0"),
            ("z - (x + y) + x + y", "z"),
            ("x*y + y*x", "2*x*y"),
            ("x/3 + x/6", "x/2"),
            ("1/2 + 1/3", "5/6"),
            ("0.1 + 0.2", "0.3"),
        ]);
    }

    #[test]
    fn multiples_of_a_sum_share_it() {
        same(&[
            ("2*x + 2*y", "2*(x + y)"),
            ("-x - y", "-(x + y)"),
            ("y - x", "-(x - y)"),
            ("(x - y)^2", "(y - x)^2"),
            ("(2*x + 4*y)*z", "2*((x + 2*y)*z)"),
            ("x/2 + y/3", "(3*x + 2*y)/6"),
            ("2*(x + y) - x - y", "x + y"),
        ]);
        let mut fixture = Fixture::new();
        let (scaled, sum) = (fixture.read("3*x - 3*y"), fixture.read("x - y"));
        assert_eq!(fixture.pool.as_multiple(scaled), (Rational::from(3), sum));
    }

    #[test]
    fn products_collect_powers_and_coefficients() {
        same(&[
            ("x*x", "x^2"),
            ("x^2*x^3", "x^5"),
            ("x^-1*x^-2", "x^-3"),
            ("x/x^3", "x^-2"),
            ("(2*x)*(3*y)", "6*(x*y)"),
            ("(x*y)^3", "x^3*y^3"),
            ("(x^2)^3", "x^6"),
            ("(-x)^2", "x^2"),
            ("(-x)^3", "-x^3"),
            ("x*y/y^2", "x/y"),
            ("sqrt(x)*x", "x^(3/2)"),
            ("sqrt(1/x)", "x^(-1/2)"),
        ]);
    }

    #[test]
    fn quotients_cancel_only_where_the_divisor_is_known_nonzero() {
        same(&[
            ("m/m", "1"),
            ("n/n", "1"),
            ("exp(x)/exp(x)", "1"),
            ("(x^2 + m)/(x^2 + m)", "1"),
            ("m^3/m", "m^2"),
            ("x^5/x^3", "x^3/x"),
            ("1/(1/x)", "x*x/x"),
        ]);
        different(&[
            ("x/x", "1"),
            ("w/w", "1"),
            ("x^3/x", "x^2"),
            ("1/(1/x)", "x"),
            ("cos(x)/cos(x)", "1"),
            ("(1/w)/(1/w)", "1"),
        ]);
    }

    #[test]
    fn roots_are_undone_only_where_the_radicand_is_known_nonnegative() {
        same(&[
            ("sqrt(m)^2", "m"),
            ("sqrt(w)*sqrt(w)", "w"),
            ("sqrt(m^2)", "m"),
            ("sqrt(x^2 + 1)^2", "x^2 + 1"),
            ("sqrt(m^2*x)", "m*sqrt(x)"),
            ("sqrt(x^2)^2", "x^2"),
            ("sqrt(x*y)*sqrt(x*y)*sqrt(z)", "sqrt(x*y)^2*sqrt(z)"),
            ("sqrt(x)^2*sqrt(x)", "x^(3/2)"),
        ]);
        different(&[
            ("sqrt(x)^2", "x"),
            ("sqrt(x)*sqrt(x)", "x"),
            ("sqrt(x^2)", "x"),
            ("sqrt(x)*x^(-1/2)", "1"),
            ("sqrt(-x)^2", "-x"),
            ("(x^3)^(1/3)", "x"),
            ("sqrt(-1)^2", "-1"),
        ]);
    }

    #[test]
    fn zero_times_a_partial_expression_keeps_its_domain() {
        same(&[
            ("0*x", "0"),
            ("0*exp(x)", "0"),
            ("0/m", "0"),
            ("0*(1/x)", "1/x - 1/x"),
        ]);
        different(&[
            ("0*(1/x)", "0"),
            ("ln(x) - ln(x)", "0"),
            ("tan(x) - tan(x)", "0"),
        ]);
        same(&[("0*ln(x) + ln(x)", "ln(x)"), ("y*(0*ln(x))", "0*(ln(x)*y)")]);
    }

    #[test]
    fn powers_of_numbers_are_exact_or_kept() {
        same(&[
            ("(2/3)^-2", "9/4"),
            ("sqrt(9/4)", "3/2"),
            ("8^(1/3)", "2"),
            ("sqrt(2)*sqrt(2)", "2"),
            ("2^(3/2)", "2*sqrt(2)"),
            ("1/sqrt(2)", "sqrt(2)/2"),
            ("sqrt(4*x)", "2*sqrt(x)"),
            ("sqrt(2)^4", "4"),
        ]);
        let mut fixture = Fixture::new();
        let huge = fixture.read("2^100000");
        assert!(matches!(fixture.pool.node(huge), Node::Product(_)));
        let ratio = fixture.read("2^100000/2^99998");
        assert_eq!(fixture.pool.as_number(ratio), Some(&Rational::from(4)));
    }

    #[test]
    fn undefined_constants_stay_and_are_reported() {
        let mut fixture = Fixture::new();
        for text in [
            "1/0",
            "x/0",
            "0/0",
            "0/(x - x)",
            "sqrt(-1)",
            "ln(0)",
            "ln(-2)",
            "asin(2)",
            "1/sqrt(0)",
        ] {
            let id = fixture.read(text);
            assert!(fixture.pool.is_undefined_constant(id), "{text}");
            assert!(!fixture.pool.is_finite(id), "{text}");
        }
        for text in ["1/x", "sqrt(x)", "ln(x)", "1/2", "asin(1)", "0^2"] {
            let id = fixture.read(text);
            assert!(!fixture.pool.is_undefined_constant(id), "{text}");
        }
    }

    #[test]
    fn functions_use_parity_and_exact_values() {
        same(&[
            ("sin(-x)", "-sin(x)"),
            ("cos(y - x)", "cos(x - y)"),
            ("tanh(-2*x)", "-tanh(2*x)"),
            ("sin(0)", "0"),
            ("cos(pi)", "-1"),
            ("sin(pi/6)", "1/2"),
            ("cos(-2*pi/3)", "-1/2"),
            ("tan(3*pi/4)", "-1"),
            ("sin(x + pi/2)", "cos(x)"),
            ("cos(pi/2 - x)", "sin(x)"),
            ("sin(x - pi)", "-sin(x)"),
            ("cos(x + 3*pi/2)", "sin(x)"),
            ("exp(0)", "1"),
            ("ln(1)", "0"),
            ("ln(exp(x))", "x"),
            ("atan(1)", "pi/4"),
            ("acos(0)", "pi/2"),
            ("abs(-3*x)", "3*abs(x)"),
            ("abs(m)", "m"),
            ("abs(-m*w)", "m*w"),
            ("atan2(0, m)", "0"),
        ]);
        different(&[
            ("exp(ln(x))", "x"),
            ("abs(x)", "x"),
            ("sqrt(x^2)", "abs(x)"),
        ]);
    }

    #[test]
    fn zeroth_power_keeps_the_domain() {
        same(&[("x^0", "1"), ("ln(x)^0", "1 + 0*ln(x)")]);
        different(&[("ln(x)^0", "1")]);
    }

    #[test]
    fn every_node_comes_after_its_operands_and_is_unique() {
        let mut fixture = Fixture::new();
        fixture.read(
            "sqrt(x^2*y)*sqrt(x^2*y)/(x - 2*y)^3 - 7*sin(2*x - y)*ln(x)/ln(x) + (a - b)*(b - a)",
        );
        let pool: &Pool = &fixture.pool;
        for index in 0..pool.len() {
            let node = pool.node(ExprId::from_index(index));
            node.for_each_operand(|operand| assert!(operand.index() < index));
        }
    }

    #[test]
    fn a_long_chain_of_sums_stays_linear() {
        let mut pool = Pool::new();
        let mut sum = pool.zero();
        for k in 0..2000 {
            let symbol = pool.symbol(&format!("x{k}"), "", crate::Assumption::None);
            let x = pool.variable(symbol);
            sum = pool.add(sum, x);
        }
        let summands = |id: ExprId| match pool.node(id) {
            Node::Sum { terms, .. } => terms.len(),
            _ => 0,
        };
        assert!(
            (0..pool.len())
                .map(|index| summands(ExprId::from_index(index)))
                .sum::<usize>()
                < 300_000
        );
        assert_eq!(pool.eval(&[sum], &|_| 1.0), [2000.0]);
    }
}
