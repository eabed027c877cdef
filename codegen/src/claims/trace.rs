//! Recorded arithmetic: the decision at a random point as a list of operations that can be lowered to code.
//!
//! Every step has its residue at the point. A residue of 0 means that the value vanishes identically, up to the
//! probability of error of all claims. Such a value is dropped, and pivots are chosen among the other values. The list
//! is therefore valid at almost all points, and as sparse as the problem.

use std::cell::RefCell;
use std::collections::HashMap;

use dalembert_expr::{
    Arithmetic, ExpansionPoint, ExprId, Function, ModularPoint, Modulus, Pool, Rational, SymbolId,
    WordHash,
};

/// The position of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Step(u32);

impl Step {
    const ZERO: Self = Self(0);

    /// The position in the list.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Operation of a step; operands are earlier steps.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Operation {
    /// A number.
    Number(Rational),
    /// A symbol.
    Symbol(SymbolId),
    /// The value of an expression.
    Expression(ExprId),
    /// A function of an expression's value.
    Call(Function, ExprId),
    /// A power.
    Power(Step, Rational),
    /// `a + b`
    Add(Step, Step),
    /// `a - b`
    Sub(Step, Step),
    /// `a b`
    Mul(Step, Step),
    /// `1 / a`
    Inverse(Step),
}

/// A list of steps.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Trace {
    /// The operations. Operands come before the operations that use them.
    pub operations: Vec<Operation>,
    residues: Vec<u64>,
    known: HashMap<Operation, Step, WordHash>,
}

impl Trace {
    /// A list whose only step is 0.
    fn new() -> Self {
        let mut trace = Self::default();
        trace.operations.push(Operation::Number(Rational::ZERO));
        trace.residues.push(0);
        trace
    }

    fn step(&mut self, operation: Operation, residue: u64) -> Step {
        if residue == 0 {
            return Step::ZERO;
        }
        if let Some(step) = self.known.get(&operation) {
            return *step;
        }
        let step = Step(self.operations.len() as u32);
        self.operations.push(operation.clone());
        self.residues.push(residue);
        self.known.insert(operation, step);
        step
    }

    fn residue(&self, step: Step) -> u64 {
        self.residues[step.index()]
    }

    fn is_one(&self, step: Step) -> bool {
        matches!(&self.operations[step.index()], Operation::Number(number) if number.is_one())
    }
}

/// Arithmetic that records every operation as a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tracer<'t> {
    trace: &'t RefCell<Trace>,
    field: Modulus,
}

impl Tracer<'_> {
    fn residue(self, step: Step) -> u64 {
        self.trace.borrow().residue(step)
    }

    fn step(self, operation: Operation, residue: u64) -> Step {
        self.trace.borrow_mut().step(operation, residue)
    }

    fn is_one(self, step: Step) -> bool {
        self.trace.borrow().is_one(step)
    }
}

impl Arithmetic for Tracer<'_> {
    type Scalar = Step;
    type Sum = Step;

    fn integer(self, value: i64) -> Step {
        let number = Operation::Number(Rational::from(value));
        self.step(number, self.field.integer(value))
    }

    fn rational(self, value: &Rational) -> Option<Step> {
        let residue = self.field.rational(value)?;
        Some(self.step(Operation::Number(value.clone()), residue))
    }

    fn add(self, a: Step, b: Step) -> Step {
        match (a, b) {
            (Step::ZERO, other) | (other, Step::ZERO) => other,
            _ => {
                let residue = self.field.add(self.residue(a), self.residue(b));
                let (a, b) = if a.0 < b.0 { (a, b) } else { (b, a) };
                self.step(Operation::Add(a, b), residue)
            }
        }
    }

    fn sub(self, a: Step, b: Step) -> Step {
        if b == Step::ZERO {
            return a;
        }
        let residue = self.field.sub(self.residue(a), self.residue(b));
        self.step(Operation::Sub(a, b), residue)
    }

    fn mul(self, a: Step, b: Step) -> Step {
        match (self.is_one(a), self.is_one(b)) {
            (true, _) => b,
            (_, true) => a,
            _ => {
                let residue = self.field.mul(self.residue(a), self.residue(b));
                let (a, b) = if a.0 < b.0 { (a, b) } else { (b, a) };
                self.step(Operation::Mul(a, b), residue)
            }
        }
    }

    fn inv(self, a: Step) -> Option<Step> {
        if self.is_one(a) {
            return Some(a);
        }
        let residue = self.field.inv(self.residue(a))?;
        Some(self.step(Operation::Inverse(a), residue))
    }

    fn size(self, a: Step) -> f64 {
        if a == Step::ZERO { 0.0 } else { 1.0 }
    }

    fn empty(self) -> Step {
        Step::ZERO
    }

    fn settle(self, sum: Step) -> Step {
        sum
    }

    fn scatter(self, sums: &mut [Step], row: &[u32], factor: Step, terms: &[(u32, Step)]) {
        for (j, b) in terms {
            let Some(k) = row.get(*j as usize) else {
                return;
            };
            let sum = &mut sums[*k as usize];
            *sum = self.add(*sum, self.mul(factor, *b));
        }
    }
}

/// A random point at which every value is a step.
pub(super) struct TracedPoint<'t> {
    point: ModularPoint,
    tracer: Tracer<'t>,
    set: HashMap<SymbolId, Step, WordHash>,
}

impl<'t> TracedPoint<'t> {
    /// Starts an empty `trace`, which records the steps at this point.
    pub(super) fn new(point: ModularPoint, trace: &'t RefCell<Trace>) -> Self {
        let field = point.modulus();
        *trace.borrow_mut() = Trace::new();
        Self {
            point,
            tracer: Tracer { trace, field },
            set: HashMap::default(),
        }
    }
}

impl<'t> ExpansionPoint for TracedPoint<'t> {
    type Field = Tracer<'t>;

    fn field(&self) -> Tracer<'t> {
        self.tracer
    }

    fn symbol(&self, pool: &Pool, symbol: SymbolId) -> Step {
        let known = self.set.get(&symbol).copied();
        known.unwrap_or_else(|| {
            let residue = self.point.value(symbol, pool.symbol_assumption(symbol));
            self.tracer.step(Operation::Symbol(symbol), residue)
        })
    }

    fn set_symbol(&mut self, symbol: SymbolId, value: Step) {
        self.set.insert(symbol, value);
    }

    fn values(&mut self, pool: &Pool, order: &[ExprId]) -> Option<Vec<Step>> {
        let residues = self.point.values(pool, order)?;
        let mut steps = vec![Step::ZERO; residues.len()];
        for id in order {
            let operation = match pool.as_number(*id) {
                Some(number) => Operation::Number(number.clone()),
                None => Operation::Expression(*id),
            };
            steps[id.index()] = self.tracer.step(operation, residues[id.index()]);
        }
        Some(steps)
    }

    fn pair(
        &mut self,
        pool: &Pool,
        function: Function,
        argument: ExprId,
        values: &[Step],
    ) -> Option<(Step, Step)> {
        let residues: Vec<u64> = values
            .iter()
            .map(|value| self.tracer.residue(*value))
            .collect();
        let (first, second) = self.point.pair(pool, function, argument, &residues)?;
        let functions = match function {
            Function::Sinh | Function::Cosh => [Function::Sinh, Function::Cosh],
            _ => [Function::Sin, Function::Cos],
        };
        let call = |function, residue| {
            self.tracer
                .step(Operation::Call(function, argument), residue)
        };
        Some((call(functions[0], first), call(functions[1], second)))
    }

    fn power(&self, value: Step, exponent: &Rational) -> Option<Step> {
        let residue = self.point.power(self.tracer.residue(value), exponent)?;
        Some(
            self.tracer
                .step(Operation::Power(value, exponent.clone()), residue),
        )
    }
}
