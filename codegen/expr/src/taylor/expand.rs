//! Taylor series of expressions at a point, in some of their symbols.

use super::arithmetic::{Arithmetic, Reals};
use super::jet::{self, Jets, Pair};
use crate::field::Modulus;
use crate::function::Function;
use crate::node::{ExprId, Node, SymbolId};
use crate::point::ModularPoint;
use crate::pool::Pool;
use crate::rational::Rational;

/// A point at which expressions are expanded. It gives values to symbols, and thereby to expressions.
pub trait ExpansionPoint {
    /// The field of the coefficients.
    type Field: Arithmetic;

    /// Arithmetic of the coefficients.
    fn field(&self) -> Self::Field;

    /// The value of a symbol.
    fn symbol(&self, pool: &Pool, symbol: SymbolId) -> Scalar<Self>;

    /// Gives a symbol a value.
    fn set_symbol(&mut self, symbol: SymbolId, value: Scalar<Self>);

    /// The values of the expressions in `order`, indexed by id; `None` if one has no value at the point.
    fn values(&mut self, pool: &Pool, order: &[ExprId]) -> Option<Vec<Scalar<Self>>>;

    /// `(sin, cos)` or `(sinh, cosh)` of an argument, as `function` is circular or hyperbolic. `values` are indexed by
    /// id.
    fn pair(
        &mut self,
        pool: &Pool,
        function: Function,
        argument: ExprId,
        values: &[Scalar<Self>],
    ) -> Option<(Scalar<Self>, Scalar<Self>)>;

    /// `value^exponent`; `None` if there is none.
    fn power(&self, value: Scalar<Self>, exponent: &Rational) -> Option<Scalar<Self>>;
}

type Scalar<P> = <<P as ExpansionPoint>::Field as Arithmetic>::Scalar;
type Series<P> = jet::Series<<P as ExpansionPoint>::Field>;

impl ExpansionPoint for ModularPoint {
    type Field = Modulus;

    fn field(&self) -> Modulus {
        self.modulus()
    }

    fn symbol(&self, pool: &Pool, symbol: SymbolId) -> u64 {
        self.value(symbol, pool.symbol_assumption(symbol))
    }

    fn set_symbol(&mut self, symbol: SymbolId, value: u64) {
        self.set(symbol, value);
    }

    fn values(&mut self, pool: &Pool, order: &[ExprId]) -> Option<Vec<u64>> {
        pool.residues(order, self).ok()
    }

    fn pair(
        &mut self,
        pool: &Pool,
        function: Function,
        argument: ExprId,
        values: &[u64],
    ) -> Option<(u64, u64)> {
        let pair = match function {
            Function::Sinh | Function::Cosh => pool.hyperbolic(argument, values, self),
            _ => pool.sine_cosine(argument, values, self),
        };
        pair.ok()
    }

    fn power(&self, value: u64, exponent: &Rational) -> Option<u64> {
        ModularPoint::power(self, value, exponent).ok()
    }
}

/// A point with real coordinates.
#[derive(Clone, Debug, Default)]
pub struct RealPoint {
    values: Vec<f64>,
}

impl RealPoint {
    /// The point with these values, one for each symbol in order of creation.
    pub fn new(values: Vec<f64>) -> Self {
        Self { values }
    }

    /// Sets the value of a symbol.
    pub fn set(&mut self, symbol: SymbolId, value: f64) {
        if self.values.len() <= symbol.index() {
            self.values.resize(symbol.index() + 1, 0.0);
        }
        self.values[symbol.index()] = value;
    }

    /// The values that were set, by symbol in order of creation.
    pub(crate) fn coordinates(&self) -> &[f64] {
        &self.values
    }

    /// The value of a symbol; 0 if none was set.
    pub fn value(&self, symbol: SymbolId) -> f64 {
        self.values.get(symbol.index()).copied().unwrap_or(0.0)
    }
}

impl ExpansionPoint for RealPoint {
    type Field = Reals;

    fn field(&self) -> Reals {
        Reals
    }

    fn symbol(&self, _: &Pool, symbol: SymbolId) -> f64 {
        self.value(symbol)
    }

    fn set_symbol(&mut self, symbol: SymbolId, value: f64) {
        self.set(symbol, value);
    }

    fn values(&mut self, pool: &Pool, order: &[ExprId]) -> Option<Vec<f64>> {
        let values = pool.eval_ordered(order, &|symbol| self.value(symbol));
        let finite = order.iter().all(|id| values[id.index()].is_finite());
        finite.then_some(values)
    }

    fn pair(
        &mut self,
        _: &Pool,
        function: Function,
        argument: ExprId,
        values: &[f64],
    ) -> Option<(f64, f64)> {
        let x = values[argument.index()];
        Some(match function {
            Function::Sinh | Function::Cosh => (x.sinh(), x.cosh()),
            _ => x.sin_cos(),
        })
    }

    fn power(&self, value: f64, exponent: &Rational) -> Option<f64> {
        Some(crate::eval::power(value, exponent)).filter(|power| power.is_finite())
    }
}

impl Pool {
    /// The Taylor series of `roots` in `variables` at a point, in the order of `roots`. `None` if one of `roots` has no
    /// series there.
    ///
    /// An expression may have a value but no series, as `sqrt(x)` at 0, the end of its domain.
    pub fn taylor<P: ExpansionPoint>(
        &self,
        roots: &[ExprId],
        variables: &[SymbolId],
        jets: &Jets<'_, P::Field>,
        point: &mut P,
    ) -> Option<Vec<Series<P>>> {
        let order = self.reachable(roots);
        let values = point.values(self, &order)?;
        let mut expansion = Expansion {
            pool: self,
            jets,
            point,
            values: &values,
            series: vec![Vec::new(); values.len()],
        };
        for id in order {
            expansion.series[id.index()] = if self.depends_on_any(id, variables) {
                expansion.node(id, variables)?
            } else {
                jets.constant(values[id.index()])
            };
        }
        let series = expansion.series;
        Some(roots.iter().map(|id| series[id.index()].clone()).collect())
    }
}

struct Expansion<'e, 's, P: ExpansionPoint> {
    pool: &'e Pool,
    jets: &'e Jets<'s, P::Field>,
    point: &'e mut P,
    values: &'e [Scalar<P>],
    /// Series known so far, indexed by id.
    series: Vec<Series<P>>,
}

impl<P: ExpansionPoint> Expansion<'_, '_, P> {
    fn of(&self, id: ExprId) -> &[Scalar<P>] {
        &self.series[id.index()]
    }

    fn node(&mut self, id: ExprId, variables: &[SymbolId]) -> Option<Series<P>> {
        let value = self.values[id.index()];
        match self.pool.node(id) {
            Node::Number(_) | Node::Pi => Some(self.jets.constant(value)),
            Node::Symbol(symbol) => {
                let v = variables.iter().position(|variable| variable == symbol)?;
                Some(self.jets.variable(v, value))
            }
            Node::Sum { constant, terms } => {
                let field = self.jets.field;
                let mut sum = self.jets.constant(field.rational(constant)?);
                for (coefficient, term) in terms {
                    let factor = field.rational(coefficient)?;
                    sum = self.jets.add_multiple(&sum, factor, self.of(*term));
                }
                Some(sum)
            }
            Node::Product(factors) => {
                let mut product = self.jets.constant(self.jets.field.integer(1));
                for (base, exponent) in factors {
                    let power = self.power(self.of(*base), exponent)?;
                    product = self.jets.mul(&product, &power);
                }
                Some(product)
            }
            Node::Call(function, argument) => self.call(*function, *argument, value),
            Node::Atan2(y, x) => {
                // With the Euler operator E: (x^2 + y^2) E(angle) = x E(y) - y E(x).
                let (jets, y, x) = (self.jets, self.of(*y), self.of(*x));
                let radius = jets.inverse(&jets.dot([(x, x), (y, y)]))?;
                let left = jets.mul(x, &jets.euler(y));
                let turned = jets.sub(&left, &jets.mul(y, &jets.euler(x)));
                jets.undo_euler(jets.mul(&radius, &turned), value)
            }
        }
    }

    fn power(&self, base: &[Scalar<P>], exponent: &Rational) -> Option<Series<P>> {
        let whole = exponent.to_small().filter(|(_, d)| *d == 1);
        match whole {
            Some((1, _)) => Some(base.to_vec()),
            Some((2, _)) => Some(self.jets.mul(base, base)),
            // The recurrence divides by the base. If the base may vanish, a natural power is multiplied out.
            Some((n @ 3.., _)) if self.jets.field.size(self.jets.value(base)) == 0.0 => {
                let mut power = base.to_vec();
                for _ in 1..n {
                    power = self.jets.mul(&power, base);
                }
                Some(power)
            }
            _ => {
                let value = self.point.power(self.jets.value(base), exponent)?;
                self.jets.power(base, exponent, value)
            }
        }
    }

    fn call(
        &mut self,
        function: Function,
        argument: ExprId,
        value: Scalar<P>,
    ) -> Option<Series<P>> {
        use Function::{
            Abs, Acos, Asin, Asinh, Atan, Cos, Cosh, Exp, Ln, Log1p, Sin, Sinh, Tan, Tanh,
        };
        let jets = self.jets;
        match function {
            Sin | Cos | Tan | Sinh | Cosh | Tanh => self.pair(function, argument),
            Exp => jets.exponential(self.of(argument), value),
            Ln => {
                let u = self.of(argument);
                jets.integral(&jets.inverse(u)?, u, value)
            }
            Log1p => {
                let u = self.of(argument);
                let rate = jets.inverse(&jets.add(&self.one(), u))?;
                jets.integral(&rate, u, value)
            }
            Atan => {
                let u = self.of(argument);
                let rate = jets.inverse(&jets.add(&self.one(), &jets.mul(u, u)))?;
                jets.integral(&rate, u, value)
            }
            Asinh => {
                let u = self.of(argument);
                let below = jets.add(&self.one(), &jets.mul(u, u));
                let rate = self.power(&below, &Rational::new(-1, 2))?;
                jets.integral(&rate, u, value)
            }
            Asin | Acos => {
                let u = self.of(argument);
                let below = jets.sub(&self.one(), &jets.mul(u, u));
                let rate = self.power(&below, &Rational::new(-1, 2))?;
                let sign = jets.field.integer(if function == Asin { 1 } else { -1 });
                jets.integral(&jets.scale(sign, &rate), u, value)
            }
            Abs => {
                let u = self.of(argument);
                let inverse = jets.field.inv(jets.value(u))?;
                Some(jets.scale(jets.field.mul(inverse, value), u))
            }
        }
    }

    fn one(&self) -> Series<P> {
        self.jets.constant(self.jets.field.integer(1))
    }

    fn pair(&mut self, function: Function, argument: ExprId) -> Option<Series<P>> {
        use Function::{Cos, Cosh, Sin, Sinh, Tanh};
        let (kind, partner) = match function {
            Sinh | Cosh | Tanh => (Pair::Hyperbolic, Sinh),
            _ => (Pair::Circular, Sin),
        };
        let values = self.point.pair(self.pool, partner, argument, self.values)?;
        let (sine, cosine) = self.jets.pair(kind, self.of(argument), values)?;
        match function {
            Sin | Sinh => Some(sine),
            Cos | Cosh => Some(cosine),
            _ => Some(self.jets.mul(&sine, &self.jets.inverse(&cosine)?)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;
    use crate::taylor::JetSpace;

    const TEXTS: [&str; 8] = [
        "(x^2 - 3*y)/(1 + x*y)^2",
        "sqrt(m + x^2)*sin(x/2 - y) + cos(x)^3",
        "tan(x)*exp(x*y) + sinh(x) - cosh(2*x)*tanh(y)",
        "x^7*y + pi*x",
        "ln(m + x) + atan(x*y) + (x^2 + 2)^(1/3)",
        "asin(x/4) - acos(y/4)",
        "abs(x)*abs(x*y)",
        "atan2(y, x) + x^(-3)",
    ];

    /// Asserts that the coefficient of `x^a y^b` is the derivative by differentiation rules, divided by `a! b!`.
    fn agree<P: ExpansionPoint>(
        make: impl Fn(&Fixture) -> P,
        near: impl Fn(Scalar<P>, Scalar<P>) -> bool,
    ) {
        let space = JetSpace::new(2, 4, 100).unwrap();
        for text in TEXTS {
            let mut fixture = Fixture::new();
            let id = fixture.read(text);
            let variables = [fixture.symbol("x"), fixture.symbol("y")];
            let mut point = make(&fixture);
            let jets = Jets::new(point.field(), &space);
            let field = point.field();
            let series = fixture.pool.taylor(&[id], &variables, &jets, &mut point);
            let series = series.unwrap().remove(0);
            let mut wanted = vec![(id, 1i64)];
            for k in 1..space.len() {
                let below = (0..k).rev().find_map(|i| {
                    (0..2).find_map(|v| {
                        (i < space.size(3) && space.raise(i, v) == k).then_some((i, v))
                    })
                });
                let (parent, v) = below.unwrap();
                let derivative = fixture.pool.diff(wanted[parent].0, variables[v]);
                let factorial = wanted[parent].1 * i64::from(space.exponent(k, v));
                wanted.push((derivative, factorial));
            }
            for (k, (derivative, factorial)) in wanted.into_iter().enumerate() {
                let order = fixture.pool.reachable(&[derivative]);
                let value = point.values(&fixture.pool, &order).unwrap()[derivative.index()];
                let coefficient = series.get(k).copied().unwrap_or(field.integer(0));
                let coefficient = field.mul(coefficient, field.integer(factorial));
                assert!(
                    near(coefficient, value),
                    "{text}, monomial {k}: {coefficient:?} is not {value:?}"
                );
            }
        }
    }

    #[test]
    fn coefficients_are_derivatives_modulo_a_prime() {
        // A seed of a point at which every root and logarithm in the table exists.
        let exists = |seed: &u64| {
            TEXTS.iter().all(|text| {
                let mut fixture = Fixture::new();
                let id = fixture.read(text);
                let mut point = ModularPoint::new(Modulus::drawn(0)[0], *seed);
                let [x, y] = ["x", "y"].map(|name| fixture.symbol(name));
                let [by_x, by_y] = [x, y].map(|symbol| fixture.pool.diff(id, symbol));
                let values = fixture.pool.modular_eval(&[id, by_x, by_y], &mut point);
                values.is_ok()
            })
        };
        let seed = (0..1 << 16).find(exists).unwrap();
        agree(
            |_| ModularPoint::new(Modulus::drawn(0)[0], seed),
            |a, b| a == b,
        );
    }

    #[test]
    fn coefficients_are_derivatives_in_double_precision() {
        let make = |fixture: &Fixture| {
            let mut point = RealPoint::default();
            for (name, value) in [("x", 0.7), ("y", 0.4), ("m", 1.3)] {
                point.set(fixture.symbol(name), value);
            }
            point
        };
        agree(make, |a, b| (a - b).abs() < 1e-11 * (1.0 + a.abs()));
    }

    #[test]
    fn natural_powers_exist_where_the_base_vanishes() {
        let mut fixture = Fixture::new();
        let id = fixture.read("x^3 + (x*y)^2");
        let variables = [fixture.symbol("x"), fixture.symbol("y")];
        let space = JetSpace::new(2, 4, 100).unwrap();
        let jets = Jets::new(Reals, &space);
        let mut point = RealPoint::default();
        let series = fixture
            .pool
            .taylor(&[id], &variables, &jets, &mut point)
            .unwrap();
        assert_eq!(series[0].iter().filter(|c| **c != 0.0).count(), 2);
    }

    #[test]
    fn there_is_no_series_at_a_pole_or_a_branch_point() {
        let mut fixture = Fixture::new();
        let x = fixture.symbol("x");
        let space = JetSpace::new(1, 2, 100).unwrap();
        let jets = Jets::new(Reals, &space);
        for text in ["1/x", "sqrt(x)", "ln(x)", "abs(x)"] {
            let id = fixture.read(text);
            let mut point = RealPoint::default();
            assert_eq!(fixture.pool.taylor(&[id], &[x], &jets, &mut point), None);
        }
    }
}
