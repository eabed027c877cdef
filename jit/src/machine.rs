//! A register machine, which evaluates functions over any kind of number.

use std::sync::Arc;

use dalembert::__private::lanes as guards;
use dalembert::Fault;
use dalembert::kernels::At;
use dalembert::numbers::{Numbers, PI};
use dalembert_codegen::program::interpret::elementary;
use dalembert_codegen::program::{Function, Guard, Input, Op, Value};
use dalembert_expr::{Function as Elementary, Rational};
use dalembert_numbers::Kernel;
use dalembert_numbers::kernel::Second;

/// A function as instructions. Registers are reused after the last use of their values.
#[derive(Debug)]
pub(crate) struct Code {
    /// The instructions, each with its target register.
    pub(crate) instructions: Vec<(Instruction, usize)>,
    pub(crate) outputs: Vec<usize>,
    pub(crate) registers: usize,
    /// Code and number of the velocities, if the function needs velocities computed from the state.
    pub(crate) velocity: Option<(Arc<Code>, usize)>,
}

/// Source of an argument.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Place {
    Time,
    First(usize),
    Second(usize),
    Velocity(usize),
    Parameter(usize),
}

/// An operation on registers.
#[derive(Debug, Clone)]
pub(crate) enum Instruction {
    Input(Place),
    Number(Constant),
    Neg(usize),
    Add(usize, usize),
    Sub(usize, usize),
    Mul(usize, usize),
    Square(usize),
    Div(usize, usize),
    Sqrt(usize),
    Power(usize, Constant),
    Call(Elementary, usize),
    Atan2(usize, usize),
    Guard(Condition),
}

/// A constant: a double, or the sum of four doubles.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Constant {
    Double(f64),
    Parts([f64; 4]),
}

impl Constant {
    pub(crate) fn of(exact: &Rational) -> Self {
        let parts = exact.to_parts();
        match parts[1] == 0.0 {
            true => Self::Double(parts[0]),
            false => Self::Parts(parts),
        }
    }

    #[inline]
    pub(crate) fn value<L: Numbers>(self) -> L {
        match self {
            Self::Double(number) => L::of(number),
            Self::Parts(parts) => L::constant(parts),
        }
    }
}

/// A condition on registers.
#[derive(Debug, Clone)]
pub(crate) enum Condition {
    Pivot(usize, usize),
    Constraint(usize, usize, Option<usize>),
    Mass(usize, usize, usize),
    Frame(usize, usize, Option<usize>),
    Surface(usize, usize, Option<usize>),
}

impl Code {
    /// Code of a kernel with `n` coordinates. `velocity` computes the velocities of a state.
    pub(crate) fn of_kernel(
        function: &Function,
        kernel: Kernel,
        n: usize,
        velocity: Option<&Arc<Self>>,
    ) -> Self {
        let place = |input| match (input, kernel.second()) {
            (Input::Time, _) => Place::Time,
            (Input::Parameter(k), _) => Place::Parameter(k),
            (Input::Velocity(i), Second::Velocities) => Place::Second(i),
            (Input::Velocity(i), _) => Place::Velocity(i),
            (Input::Momentum(i), Second::Momenta) => Place::Second(i),
            (Input::Excess(k) | Input::MotionRate(k) | Input::Multiplier(k), _) => Place::Second(k),
            (Input::Coordinate(i), _) => Place::First(i),
            (Input::Momentum(i) | Input::Quasi(i), _) => Place::First(n + i),
        };
        let mut code = Self::of(function, &function.outputs, place);
        let takes_velocities = code
            .instructions
            .iter()
            .any(|(instruction, _)| matches!(instruction, Instruction::Input(Place::Velocity(_))));
        if takes_velocities {
            code.velocity = velocity.map(|code| (Arc::clone(code), n));
        }
        code
    }

    /// Code for the values `outputs` of a function of time, state and parameters, with `n` coordinates.
    pub(crate) fn of_state(function: &Function, outputs: &[Value], n: usize) -> Self {
        Self::of(function, outputs, |input| match input {
            Input::Time => Place::Time,
            Input::Parameter(k) => Place::Parameter(k),
            other => Place::First(other.component(n).unwrap_or(usize::MAX)),
        })
    }

    fn of(function: &Function, outputs: &[Value], place: impl Fn(Input) -> Place) -> Self {
        let mut last = vec![0; function.ops.len()];
        for (index, op) in function.ops.iter().enumerate() {
            for operand in op.operands() {
                last[operand.index()] = index;
            }
        }
        for output in outputs {
            last[output.index()] = usize::MAX;
        }
        let mut registers = Registers::default();
        let mut of_value: Vec<usize> = Vec::with_capacity(function.ops.len());
        let mut instructions = Vec::new();
        for (index, op) in function.ops.iter().enumerate() {
            let at = |value: &Value| of_value[value.index()];
            let instruction = instruction(op, &at, &place);
            for operand in op.operands() {
                if last[operand.index()] == index {
                    registers.give_back(of_value[operand.index()]);
                }
            }
            let target = registers.take();
            // An instruction without readers is executed because it may fail. Its value is dropped.
            if last[index] == 0 {
                registers.give_back(target);
            }
            of_value.push(target);
            instructions.push((instruction, target));
        }
        Self {
            instructions,
            outputs: outputs
                .iter()
                .map(|output| of_value[output.index()])
                .collect(),
            registers: registers.count,
            velocity: None,
        }
    }

    /// Writes the values of the outputs.
    ///
    /// # Errors
    /// The fault of the first guard that does not hold.
    pub(crate) fn run<L: Numbers>(&self, at: At<'_, L>, values: &mut [L]) -> Result<(), Fault> {
        match &self.velocity {
            None => self.run_with(at, &[], values),
            Some((velocity, n)) => with_room(*n, |qdot| {
                velocity.run(at, qdot)?;
                self.run_with(at, qdot, values)
            }),
        }
    }

    fn run_with<L: Numbers>(
        &self,
        at: At<'_, L>,
        qdot: &[L],
        values: &mut [L],
    ) -> Result<(), Fault> {
        with_room(self.registers, |registers| {
            for (instruction, target) in &self.instructions {
                registers[*target] = execute(instruction, registers, at, qdot)?;
            }
            for (value, register) in values.iter_mut().zip(&self.outputs) {
                *value = registers[*register];
            }
            Ok(())
        })
    }
}

/// Free registers, and the number of registers created so far.
#[derive(Default)]
struct Registers {
    free: Vec<usize>,
    count: usize,
}

impl Registers {
    fn take(&mut self) -> usize {
        self.free.pop().unwrap_or_else(|| {
            self.count += 1;
            self.count - 1
        })
    }

    fn give_back(&mut self, register: usize) {
        if !self.free.contains(&register) {
            self.free.push(register);
        }
    }
}

/// Calls `then` with room for `count` numbers, on the stack if they are few.
pub(crate) fn with_room<L: Numbers, T>(count: usize, then: impl FnOnce(&mut [L]) -> T) -> T {
    match count {
        // NOTE: numbers of some kinds are long, and all elements are initialised. The arrays are therefore not much
        // larger than necessary.
        0..=8 => then(&mut [L::ZERO; 8][..count]),
        9..=24 => then(&mut [L::ZERO; 24][..count]),
        25..=64 => then(&mut [L::ZERO; 64][..count]),
        _ => then(&mut vec![L::ZERO; count]),
    }
}

fn instruction(
    op: &Op,
    at: &impl Fn(&Value) -> usize,
    place: &impl Fn(Input) -> Place,
) -> Instruction {
    match op {
        Op::Input(input) => Instruction::Input(place(*input)),
        Op::Number(number) => Instruction::Number(Constant::of(number)),
        Op::Pi => Instruction::Number(Constant::Parts(PI)),
        Op::Neg(a) => Instruction::Neg(at(a)),
        Op::Add(a, b) => Instruction::Add(at(a), at(b)),
        Op::Sub(a, b) => Instruction::Sub(at(a), at(b)),
        Op::Mul(a, b) if a == b => Instruction::Square(at(a)),
        Op::Mul(a, b) => Instruction::Mul(at(a), at(b)),
        Op::Div(a, b) => Instruction::Div(at(a), at(b)),
        Op::Sqrt(a) => Instruction::Sqrt(at(a)),
        Op::Power(a, exponent) => Instruction::Power(at(a), Constant::of(exponent)),
        Op::Call(function, a) => Instruction::Call(*function, at(a)),
        Op::Atan2(y, x) => Instruction::Atan2(at(y), at(x)),
        Op::Guard(guard) => Instruction::Guard(condition(guard, at)),
    }
}

fn condition(guard: &Guard, at: &impl Fn(&Value) -> usize) -> Condition {
    match guard {
        Guard::Pivot { pivot, value } => Condition::Pivot(*pivot, at(value)),
        Guard::Constraint {
            constraint,
            squared,
            reference,
        } => Condition::Constraint(*constraint, at(squared), reference.as_ref().map(at)),
        Guard::Mass {
            constraint,
            pivot,
            diagonal,
        } => Condition::Mass(*constraint, at(pivot), at(diagonal)),
        Guard::Frame {
            quasi,
            squared,
            reference,
        } => Condition::Frame(*quasi, at(squared), reference.as_ref().map(at)),
        Guard::Surface {
            surface,
            squared,
            reference,
        } => Condition::Surface(*surface, at(squared), reference.as_ref().map(at)),
    }
}

#[inline]
fn execute<L: Numbers>(
    instruction: &Instruction,
    registers: &[L],
    at: At<'_, L>,
    qdot: &[L],
) -> Result<L, Fault> {
    let value = |register: &usize| registers[*register];
    Ok(match instruction {
        Instruction::Input(place) => match *place {
            Place::Time => at.t,
            Place::First(i) => at.first[i],
            Place::Second(i) => at.second[i],
            Place::Velocity(i) => qdot[i],
            Place::Parameter(k) => at.parameters[k],
        },
        Instruction::Number(constant) => constant.value(),
        Instruction::Neg(a) => -value(a),
        Instruction::Add(a, b) => value(a) + value(b),
        Instruction::Sub(a, b) => value(a) - value(b),
        Instruction::Mul(a, b) => value(a) * value(b),
        Instruction::Square(a) => value(a).square(),
        Instruction::Div(a, b) => value(a) / value(b),
        Instruction::Sqrt(a) => value(a).sqrt(),
        Instruction::Power(a, Constant::Double(exponent)) => value(a).powf(*exponent),
        Instruction::Power(a, exponent) => value(a).power(exponent.value()),
        Instruction::Call(function, a) => elementary(*function, value(a)),
        Instruction::Atan2(y, x) => value(y).atan2(value(x)),
        Instruction::Guard(condition) => {
            check(condition, registers)?;
            L::ZERO
        }
    })
}

fn check<L: Numbers>(condition: &Condition, registers: &[L]) -> Result<(), Fault> {
    let value = |register: usize| registers[register];
    let or_zero = |register: Option<usize>| register.map_or(L::ZERO, value);
    match *condition {
        Condition::Pivot(pivot, register) => guards::positive_pivot(pivot, value(register)),
        Condition::Constraint(constraint, squared, reference) => {
            guards::independent_constraint(constraint, value(squared), or_zero(reference))
        }
        Condition::Mass(constraint, pivot, diagonal) => {
            guards::regular_mass(constraint, value(pivot), value(diagonal))
        }
        Condition::Frame(quasi, squared, reference) => {
            guards::independent_form(quasi, value(squared), or_zero(reference))
        }
        Condition::Surface(surface, squared, None) => {
            guards::regular_surface(surface, value(squared))
        }
        Condition::Surface(surface, squared, Some(reference)) => {
            guards::independent_at(surface, value(squared), value(reference))
        }
    }
}
