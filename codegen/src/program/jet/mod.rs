//! Taylor coefficients in time of every value of a function, order by order.
//!
//! Along a motion every value `v` is a power series `v_0 + v_1 s + v_2 s^2 + ..` in time `s`. A [`Jet`] is a function
//! with one rule ([`Recurrence`]) per value. The rule computes coefficient `k` of the value from coefficients that are
//! already known. Sums are computed term by term, products are Cauchy products. All other functions satisfy a
//! differential equation that contains only products or quotients, such as `c' = -a' s`, `s' = a' c` for cosine and
//! sine. A further value that occurs in such an equation is called a companion, and is one more operation of the
//! function. Examples are the sine for a cosine (and conversely), and `1 + a^2` for the arc tangent.
//!
//! Values whose series end by structure are determined beforehand ([`degree`]). The Cauchy product with such a value
//! has only as many terms as the series of that value, and a constant has no recurrence.
//!
//! References: R. E. Moore, *Interval Analysis* (1966), chapter 11; A. Griewank and A. Walther, *Evaluating
//! Derivatives* (2008), section 13.2, tables 13.1 and 13.2.

pub mod degree;
mod factors;
pub mod interpret;
pub mod terms;

use dalembert_expr::{Function as Elementary, Rational};

use super::builder::Builder;
use super::{Function, Input, Op, Value};
use degree::Degree;

/// Rule for coefficient `k >= 1` of a value, from lower coefficients of all values and coefficients of order `k` of its
/// operands.
#[derive(Debug, Clone, PartialEq)]
pub enum Recurrence {
    /// A constant: all coefficients are 0.
    Constant,
    /// The time.
    Time,
    /// The component of the state with this index.
    Component(usize),
    /// Equal to the coefficient of another value.
    Same(Value),
    /// `-a`
    Neg(Value),
    /// `a + b`
    Add(Value, Value),
    /// `a - b`
    Sub(Value, Value),
    /// `a b` with constant `a`
    Scaled(Value, Value),
    /// `a / b` with constant `b`
    Divided(Value, Value),
    /// `a b`
    Product(Value, Value),
    /// `a^2`
    Square(Value),
    /// `a / b`; without `a` if it is constant.
    Quotient(Option<Value>, Value),
    /// `sqrt(a)`
    Root(Value),
    /// `a^e`, by `a c' = e a' c`
    Power(Value, Rational),
    /// `c' = a' b`, or `c' = -a' b`
    Integral {
        /// `a`
        of: Value,
        /// `b`
        by: Value,
        /// True if `c' = -a' b`.
        negative: bool,
    },
    /// `c' = a' / b`, or `c' = -a' / b`
    IntegralQuotient {
        /// `a`
        of: Value,
        /// `b`
        by: Value,
        /// True if `c' = -a' / b`.
        negative: bool,
    },
    /// The angle of `(x, y)`, by `r c' = x y' - y x'`
    Angle {
        /// `y`
        y: Value,
        /// `x`
        x: Value,
        /// `r = x^2 + y^2`
        squared: Value,
    },
    /// `|a|`, with the sign of `a` at order 0.
    Absolute(Value),
}

/// The coefficients of a value, kept for all orders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct History {
    /// The value.
    pub value: Value,
    /// True if coefficient `k` is kept multiplied by `k`: the coefficients of the derivative, shifted by one order.
    pub weighted: bool,
}

impl History {
    /// The coefficients themselves.
    pub fn plain(value: Value) -> Self {
        Self {
            value,
            weighted: false,
        }
    }

    /// The coefficients multiplied by their order.
    pub fn weighted(value: Value) -> Self {
        Self {
            value,
            weighted: true,
        }
    }
}

/// A function with recurrences for the Taylor coefficients of its values.
#[derive(Debug)]
pub struct Jet {
    /// Order 0: the operations of the original functions, with constant factors taken out of products, then the
    /// companions. The results are those of the original functions.
    pub function: Function,
    /// Recurrence of each value.
    pub recurrences: Vec<Recurrence>,
    /// Degree of the series of each value: the order after which it ends, if it ends.
    pub degrees: Vec<Degree>,
    /// For each value: true if a result depends on its coefficients above order 0.
    pub needed: Vec<bool>,
    /// Coefficients that are kept for later orders.
    pub histories: Vec<History>,
}

impl Jet {
    /// The jet of some functions, whose results are concatenated. `components` are the degrees of the components of the
    /// state along the motion. `component` maps an input to its component of the state.
    pub fn of(
        functions: &[&Function],
        components: &[Degree],
        component: impl Fn(Input) -> Option<usize>,
    ) -> Self {
        let degree_at = |input| component(input).map(|i| components[i]);
        let function = factors::take_out(&together(functions), degree_at);
        let mut builder = Builder::new();
        let outputs = builder.replay(&function);
        let (mut recurrences, mut degrees) = (Vec::new(), Vec::new());
        // Companions are appended at the end, so the loop reaches them later.
        while recurrences.len() < builder.len() {
            let value = Value::new(recurrences.len());
            let op = builder.op(value).clone();
            let degree = degree::of(&op, &degrees, degree_at);
            recurrences.push(match degree {
                Degree::AtMost(0) => Recurrence::Constant,
                _ => recurrence(&mut builder, value, &op, &degrees, &component),
            });
            degrees.push(degree);
        }
        let function = builder.finish_whole(outputs);
        let needed = needed(&function.outputs, &recurrences);
        let histories = histories(&recurrences, &needed);
        Self {
            function,
            recurrences,
            degrees,
            needed,
            histories,
        }
    }

    /// True if no result depends on an absolute value. The series then represent the results up to their radius of
    /// convergence.
    pub fn is_analytic(&self) -> bool {
        let absolute =
            |value: Value| matches!(self.recurrences[value.index()], Recurrence::Absolute(_));
        !self.varying().any(absolute)
    }

    /// True if coefficients of a value are kept.
    pub fn is_kept(&self, value: Value) -> bool {
        let histories = [History::plain(value), History::weighted(value)];
        let known = |history| self.histories.binary_search(history).is_ok();
        histories.iter().any(known)
    }

    /// For each value: number of reads of its coefficient `k`, by other values and as a result.
    pub fn uses(&self) -> Vec<usize> {
        let mut uses = vec![0; self.recurrences.len()];
        let operands = self
            .varying()
            .flat_map(|value| self.recurrences[value.index()].operands());
        for value in operands.chain(self.function.outputs.iter().copied()) {
            uses[value.index()] += 1;
        }
        uses
    }

    /// Number of sums over products of coefficients of all lower orders. The sum of a square counts as one half.
    pub fn sums(&self) -> f64 {
        let endless = |value: &Value| self.degrees[value.index()] == Degree::Endless;
        let sums = |value: Value| match self.recurrences[value.index()] {
            Recurrence::Square(_) | Recurrence::Root(_) => 0.5,
            Recurrence::Product(a, b) => f64::from(u8::from(endless(&a) && endless(&b))),
            Recurrence::Quotient(_, a) | Recurrence::Integral { of: a, .. } => {
                f64::from(u8::from(endless(&a)))
            }
            Recurrence::IntegralQuotient { .. } => 1.0,
            Recurrence::Power(..) => 2.0,
            Recurrence::Angle { .. } => 3.0,
            _ => 0.0,
        };
        self.varying().map(sums).sum()
    }

    /// Largest degree in time of the motion and of the results. The first `components` results are the rates of the
    /// motion, which has one degree more.
    pub fn degree(&self, components: usize) -> Degree {
        let degrees = self.function.outputs.iter().enumerate();
        let degrees = degrees.map(|(i, output)| {
            let degree = self.degrees[output.index()];
            match (i < components, degree) {
                (true, Degree::AtMost(degree)) => Degree::AtMost(degree + 1),
                _ => degree,
            }
        });
        degrees.max().unwrap_or(Degree::AtMost(0))
    }

    /// Values that are needed and not constant. Their coefficients of order `k` can be computed in this order.
    pub fn varying(&self) -> impl Iterator<Item = Value> + '_ {
        let varies = |i: &usize| self.needed[*i] && self.recurrences[*i] != Recurrence::Constant;
        (0..self.recurrences.len()).filter(varies).map(Value::new)
    }
}

/// The functions joined into one, with concatenated results.
fn together(functions: &[&Function]) -> Function {
    let mut builder = Builder::new();
    let outputs = functions.iter();
    let outputs = outputs.flat_map(|function| builder.replay(function));
    let outputs = outputs.collect();
    builder.finish_whole(outputs)
}

/// The recurrence of an operation. Adds the companions that it needs.
fn recurrence(
    builder: &mut Builder,
    value: Value,
    op: &Op,
    degrees: &[Degree],
    component: impl Fn(Input) -> Option<usize>,
) -> Recurrence {
    let constant = |value: Value| degrees[value.index()] == Degree::AtMost(0);
    match *op {
        Op::Input(Input::Time) => Recurrence::Time,
        Op::Input(input) => component(input).map_or(Recurrence::Constant, Recurrence::Component),
        Op::Number(_) | Op::Pi | Op::Guard(_) => Recurrence::Constant,
        Op::Neg(a) => Recurrence::Neg(a),
        Op::Add(a, b) if constant(a) => Recurrence::Same(b),
        Op::Add(a, b) | Op::Sub(a, b) if constant(b) => Recurrence::Same(a),
        Op::Add(a, b) => Recurrence::Add(a, b),
        Op::Sub(a, b) if constant(a) => Recurrence::Neg(b),
        Op::Sub(a, b) => Recurrence::Sub(a, b),
        Op::Mul(a, b) if constant(a) => Recurrence::Scaled(a, b),
        Op::Mul(a, b) if constant(b) => Recurrence::Scaled(b, a),
        Op::Mul(a, b) if a == b => Recurrence::Square(a),
        Op::Mul(a, b) => Recurrence::Product(a, b),
        Op::Div(a, b) if constant(b) => Recurrence::Divided(a, b),
        Op::Div(a, b) => Recurrence::Quotient((!constant(a)).then_some(a), b),
        Op::Sqrt(a) => Recurrence::Root(a),
        Op::Power(a, ref exponent) => Recurrence::Power(a, exponent.clone()),
        Op::Call(function, a) => call(builder, value, function, a),
        Op::Atan2(y, x) => {
            let (y_squared, x_squared) = (builder.mul(y, y), builder.mul(x, x));
            let squared = builder.add(y_squared, x_squared);
            Recurrence::Angle { y, x, squared }
        }
    }
}

/// The recurrence of an elementary function, from its differential equation.
fn call(builder: &mut Builder, value: Value, function: Elementary, a: Value) -> Recurrence {
    let integral = |by, negative| Recurrence::Integral {
        of: a,
        by,
        negative,
    };
    let quotient = |by, negative| Recurrence::IntegralQuotient {
        of: a,
        by,
        negative,
    };
    match function {
        Elementary::Sin => integral(builder.call(Elementary::Cos, a), false),
        Elementary::Cos => integral(builder.call(Elementary::Sin, a), true),
        Elementary::Sinh => integral(builder.call(Elementary::Cosh, a), false),
        Elementary::Cosh => integral(builder.call(Elementary::Sinh, a), false),
        Elementary::Exp => integral(value, false),
        Elementary::Tan => integral(one_plus_square(builder, value), false),
        Elementary::Tanh => integral(one_minus_square(builder, value), false),
        Elementary::Ln => quotient(a, false),
        Elementary::Log1p => {
            let one = builder.integer(1);
            quotient(builder.add(one, a), false)
        }
        Elementary::Atan => quotient(one_plus_square(builder, a), false),
        Elementary::Asinh => {
            let squared = one_plus_square(builder, a);
            quotient(builder.sqrt(squared), false)
        }
        Elementary::Asin | Elementary::Acos => {
            let squared = one_minus_square(builder, a);
            quotient(builder.sqrt(squared), function == Elementary::Acos)
        }
        Elementary::Abs => Recurrence::Absolute(a),
    }
}

fn one_plus_square(builder: &mut Builder, a: Value) -> Value {
    let (one, square) = (builder.integer(1), builder.mul(a, a));
    builder.add(one, square)
}

/// `1 - a^2` as a product, which keeps its relative accuracy for `a` near 1.
fn one_minus_square(builder: &mut Builder, a: Value) -> Value {
    let one = builder.integer(1);
    let (below, above) = (builder.sub(one, a), builder.add(one, a));
    builder.mul(below, above)
}

impl Recurrence {
    /// The values whose coefficients above order 0 are read.
    fn operands(&self) -> Vec<Value> {
        match *self {
            Self::Constant | Self::Time | Self::Component(_) => Vec::new(),
            Self::Same(a)
            | Self::Neg(a)
            | Self::Scaled(_, a)
            | Self::Divided(a, _)
            | Self::Square(a)
            | Self::Quotient(None, a)
            | Self::Root(a)
            | Self::Power(a, _)
            | Self::Absolute(a) => vec![a],
            Self::Add(a, b)
            | Self::Sub(a, b)
            | Self::Product(a, b)
            | Self::Quotient(Some(a), b)
            | Self::Integral { of: a, by: b, .. }
            | Self::IntegralQuotient { of: a, by: b, .. } => vec![a, b],
            Self::Angle { y, x, squared } => vec![y, x, squared],
        }
    }

    /// Histories that are read for the coefficients of `value`.
    fn histories(&self, value: Value) -> Vec<History> {
        let (plain, weighted) = (History::plain, History::weighted);
        match *self {
            Self::Product(a, b) => vec![plain(a), plain(b)],
            Self::Square(a) => vec![plain(a)],
            Self::Quotient(_, b) => vec![plain(b), plain(value)],
            Self::Root(_) => vec![plain(value)],
            Self::Power(a, _) => vec![plain(a), weighted(a), plain(value), weighted(value)],
            Self::Integral { of, by, .. } => vec![weighted(of), plain(by)],
            Self::IntegralQuotient { by, .. } => vec![weighted(value), plain(by)],
            Self::Angle { y, x, squared } => vec![
                plain(x),
                weighted(y),
                plain(y),
                weighted(x),
                plain(squared),
                weighted(value),
            ],
            _ => Vec::new(),
        }
    }
}

/// For each value: true if a result depends on its coefficients above order 0. Companions are included.
fn needed(outputs: &[Value], recurrences: &[Recurrence]) -> Vec<bool> {
    let mut needed = vec![false; recurrences.len()];
    let mut open = outputs.to_vec();
    while let Some(value) = open.pop() {
        if !core::mem::replace(&mut needed[value.index()], true) {
            open.extend(recurrences[value.index()].operands());
        }
    }
    needed
}

fn histories(recurrences: &[Recurrence], needed: &[bool]) -> Vec<History> {
    let kept = recurrences
        .iter()
        .enumerate()
        .filter(|(i, _)| needed[*i])
        .flat_map(|(i, recurrence)| recurrence.histories(Value::new(i)));
    let mut histories: Vec<History> = kept.collect();
    histories.sort_unstable();
    histories.dedup();
    histories
}
