//! Functions as straight-line code.

use std::collections::{BTreeMap, BTreeSet};

use dalembert_codegen::program::Guard;
use dalembert_expr::Function as Elementary;

use super::helpers::OfNumbers;
use super::straight::{Base, Binary, Operation, Place, Straight, Unary, Value};
use crate::machine::{self, Code, Condition, Constant, Instruction};

/// Pointer arguments of a function, in order.
const PARAMETERS: Base = Base::Argument(0);
const FIRST: Base = Base::Argument(1);
const SECOND: Base = Base::Argument(2);
const VALUES: Base = Base::Argument(3);

/// The code of a function: first the velocities, if it needs them, then its values.
pub(super) fn straight(code: &Code) -> Straight {
    let mut straight = Straight::default();
    let t = straight.push(Operation::Argument);
    let velocities = match &code.velocity {
        Some((velocity, _)) => Body::of(velocity, &mut straight, (t, &[])).values(),
        None => Vec::new(),
    };
    let values = Body::of(code, &mut straight, (t, &velocities)).values();
    for (k, value) in values.into_iter().enumerate() {
        straight.store(value, Place::of(VALUES, k));
    }
    straight
}

/// A function under construction.
struct Body<'a> {
    straight: &'a mut Straight,
    code: &'a Code,
    t: Value,
    velocities: &'a [Value],
    registers: Vec<Option<Value>>,
    /// Indices of the calls of sine and cosine whose argument needs both functions.
    paired: BTreeSet<usize>,
    /// Places of computed sines and cosines, by argument.
    taken: BTreeMap<Value, Place>,
}

impl<'a> Body<'a> {
    fn of(
        code: &'a Code,
        straight: &'a mut Straight,
        (t, velocities): (Value, &'a [Value]),
    ) -> Self {
        Self {
            straight,
            code,
            t,
            velocities,
            registers: vec![None; code.registers],
            paired: paired(code),
            taken: BTreeMap::new(),
        }
    }

    fn values(mut self) -> Vec<Value> {
        for (index, (instruction, target)) in self.code.instructions.iter().enumerate() {
            self.registers[*target] = self.value(index, instruction);
        }
        let outputs = self.code.outputs.iter();
        outputs.map(|output| self.register(*output)).collect()
    }

    fn register(&mut self, register: usize) -> Value {
        let value = self.registers[register];
        // NOTE: the NaN is never used, because every register is written before it is read.
        value.unwrap_or_else(|| self.straight.number(f64::NAN))
    }

    fn number(&mut self, constant: Constant) -> Value {
        self.straight.number(constant.value::<f64>())
    }

    fn input(&mut self, place: machine::Place) -> Value {
        let place = match place {
            machine::Place::Time => return self.t,
            machine::Place::Velocity(i) => return self.velocities[i],
            machine::Place::Parameter(k) => Place::of(PARAMETERS, k),
            machine::Place::First(i) => Place::of(FIRST, i),
            machine::Place::Second(i) => Place::of(SECOND, i),
        };
        self.straight.load(place)
    }

    fn binary(&mut self, binary: Binary, a: usize, b: usize) -> Value {
        let operands = [a, b].map(|register| self.register(register));
        self.straight.binary(binary, operands)
    }

    fn unary(&mut self, unary: Unary, a: usize) -> Value {
        let a = self.register(a);
        self.straight.unary(unary, a)
    }

    /// The value of an instruction; `None` for a guard.
    fn value(&mut self, index: usize, instruction: &Instruction) -> Option<Value> {
        Some(match *instruction {
            Instruction::Input(place) => self.input(place),
            Instruction::Number(constant) => self.number(constant),
            Instruction::Neg(a) => self.unary(Unary::Neg, a),
            Instruction::Sqrt(a) => self.unary(Unary::Sqrt, a),
            Instruction::Add(a, b) => self.binary(Binary::Add, a, b),
            Instruction::Sub(a, b) => self.binary(Binary::Sub, a, b),
            Instruction::Mul(a, b) => self.binary(Binary::Mul, a, b),
            Instruction::Div(a, b) => self.binary(Binary::Div, a, b),
            Instruction::Square(a) => self.binary(Binary::Mul, a, a),
            Instruction::Power(a, exponent) => {
                let (a, exponent) = (self.register(a), self.number(exponent));
                let call = Operation::Call(OfNumbers::Power, a, Some(exponent));
                self.straight.push(call)
            }
            Instruction::Call(Elementary::Abs, a) => self.unary(Unary::Abs, a),
            Instruction::Call(function @ (Elementary::Sin | Elementary::Cos), a)
                if self.paired.contains(&index) =>
            {
                let place = self.sine_and_cosine(a);
                self.straight.load(match function {
                    Elementary::Sin => place,
                    _ => place.behind(1),
                })
            }
            Instruction::Call(function, a) => {
                let a = self.register(a);
                let call = Operation::Call(OfNumbers::Elementary(function), a, None);
                self.straight.push(call)
            }
            Instruction::Atan2(y, x) => {
                let [y, x] = [y, x].map(|register| self.register(register));
                let call = Operation::Call(OfNumbers::Atan2, y, Some(x));
                self.straight.push(call)
            }
            Instruction::Guard(ref condition) => {
                let (value, reference) = bound(condition);
                self.guard(value, reference);
                return None;
            }
        })
    }

    fn guard(&mut self, value: usize, reference: Option<(f64, usize)>) {
        let value = self.register(value);
        let bound = match reference {
            None => self.straight.number(0.0),
            Some((ratio, reference)) => {
                let ratio = self.straight.number(ratio);
                let reference = self.register(reference);
                self.straight.mul(ratio, reference)
            }
        };
        self.straight.push(Operation::Guard([value, bound]));
    }

    fn sine_and_cosine(&mut self, a: usize) -> Place {
        let a = self.register(a);
        if let Some(place) = self.taken.get(&a) {
            return *place;
        }
        let place = self.straight.room(2);
        self.straight.push(Operation::SineAndCosine(a, place));
        self.taken.insert(a, place);
        place
    }
}

/// A register, and the lower bound of its value: a multiple of another register, or 0 if that is `None`.
fn bound(condition: &Condition) -> (usize, Option<(f64, usize)>) {
    match *condition {
        Condition::Pivot(_, value) => (value, None),
        Condition::Mass(_, pivot, diagonal) => (pivot, Some((Guard::LEAST_PIVOT_RATIO, diagonal))),
        Condition::Constraint(_, squared, reference)
        | Condition::Frame(_, squared, reference)
        | Condition::Surface(_, squared, reference) => (
            squared,
            reference.map(|register| (Guard::LEAST_SQUARED_RATIO, register)),
        ),
    }
}

/// Indices of the calls of sine and cosine whose argument needs both functions.
fn paired(code: &Code) -> BTreeSet<usize> {
    // Index of the last instruction that wrote each register.
    let mut written = vec![usize::MAX; code.registers];
    let mut of_argument: BTreeMap<usize, [Vec<usize>; 2]> = BTreeMap::new();
    for (index, (instruction, target)) in code.instructions.iter().enumerate() {
        if let Instruction::Call(function @ (Elementary::Sin | Elementary::Cos), a) = instruction {
            let is_cosine = usize::from(*function == Elementary::Cos);
            of_argument.entry(written[*a]).or_default()[is_cosine].push(index);
        }
        written[*target] = index;
    }
    let both = of_argument.into_values();
    let both = both.filter(|[sines, cosines]| !sines.is_empty() && !cosines.is_empty());
    both.flatten().flatten().collect()
}
