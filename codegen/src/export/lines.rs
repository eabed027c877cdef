//! The operations of a function as a list of lines. The texts in all other languages are written from these lines.

use dalembert_expr::Function as Elementary;

use crate::program::{Function, Guard, Input, Op, Value};

/// An operand of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Operand {
    /// The value of an earlier line.
    Value(usize),
    /// A number.
    Number(f64),
    /// The time.
    Time,
    /// A component of the state, or a position in a function of positions and velocities.
    State(usize),
    /// A velocity.
    Velocity(usize),
    /// A parameter or an input; inputs follow all parameters.
    Parameter(usize),
}

/// A fault of a function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// The metric is not positive definite.
    Metric,
    /// Constraints depend on each other.
    Constraint,
    /// Quasi-velocities depend on each other.
    Frame,
    /// A surface is singular, or tangent to the constraints.
    Surface,
}

/// A line.
#[derive(Debug, Clone, PartialEq)]
pub enum Line {
    /// A numbered value: a sign between two operands (`+`, `-`, `*`, `/`), or a function by its name in C. `neg`
    /// changes the sign of its operand.
    Let {
        /// Number of the value.
        value: usize,
        /// Sign or name.
        operation: &'static str,
        /// The operands, in order.
        operands: Vec<Operand>,
    },
    /// `value > factor*reference`, or else the function ends with a fault.
    Demand {
        /// The side that must be greater.
        value: Operand,
        /// The factor of the reference.
        factor: f64,
        /// The quantity that is multiplied by the factor; `None` for 0.
        reference: Option<Operand>,
        /// The fault.
        fault: Fault,
    },
}

/// A function as lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Lines {
    /// The lines, in order.
    pub lines: Vec<Line>,
    /// The results.
    pub outputs: Vec<Operand>,
    /// The number of the next value.
    next: usize,
}

impl Lines {
    /// The lines of a function of a model with `n` coordinates; `None` if it reads rates, excesses or multipliers.
    pub fn of(function: &Function, n: usize) -> Option<Self> {
        let mut known: Vec<Operand> = Vec::with_capacity(function.ops.len());
        let mut lines = Self {
            lines: Vec::new(),
            outputs: Vec::new(),
            next: function.ops.len(),
        };
        for (value, op) in function.ops.iter().enumerate() {
            let at = |value: &Value| known[value.index()];
            let operand = match op {
                Op::Input(input) => place(*input, n)?,
                Op::Number(number) => Operand::Number(number.to_f64()),
                Op::Pi => Operand::Number(core::f64::consts::PI),
                Op::Guard(guard) => {
                    lines.lines.push(demand(guard, &at));
                    Operand::Value(value)
                }
                _ => {
                    let (operation, mut operands) = operation(op, &at);
                    match op {
                        Op::Power(_, exponent) => {
                            operands.push(Operand::Number(exponent.to_f64()));
                        }
                        // A zero of either sign counts as 0, so that the angle on the cut is `pi`.
                        Op::Atan2(..) => {
                            for operand in &mut operands {
                                *operand = lines.add("+", vec![*operand, Operand::Number(0.0)]);
                            }
                        }
                        _ => {}
                    }
                    lines.lines.push(Line::Let {
                        value,
                        operation,
                        operands,
                    });
                    Operand::Value(value)
                }
            };
            known.push(operand);
        }
        let outputs = function.outputs.iter();
        lines.outputs = outputs.map(|output| known[output.index()]).collect();
        Some(lines)
    }

    /// Adds a line and returns its value.
    pub(super) fn add(&mut self, operation: &'static str, operands: Vec<Operand>) -> Operand {
        let value = self.next;
        self.next += 1;
        self.lines.push(Line::Let {
            value,
            operation,
            operands,
        });
        Operand::Value(value)
    }

    /// Leaves out the values that neither a result nor a demand needs.
    pub(super) fn drop_unused(&mut self) {
        let mut is_used = vec![false; self.next];
        fn mark<'a>(is_used: &mut [bool], operands: impl IntoIterator<Item = &'a Operand>) {
            for operand in operands {
                if let Operand::Value(value) = operand {
                    is_used[*value] = true;
                }
            }
        }
        mark(&mut is_used, &self.outputs);
        for line in self.lines.iter().rev() {
            match line {
                Line::Demand {
                    value, reference, ..
                } => mark(&mut is_used, [value].into_iter().chain(reference)),
                Line::Let {
                    value, operands, ..
                } if is_used[*value] => mark(&mut is_used, operands),
                Line::Let { .. } => {}
            }
        }
        self.lines.retain(|line| match line {
            Line::Let { value, .. } => is_used[*value],
            Line::Demand { .. } => true,
        });
    }

    /// True if the function reads velocities.
    pub fn reads_velocity(&self) -> bool {
        let is_velocity = |operand: &Operand| matches!(operand, Operand::Velocity(_));
        let in_line = |line: &Line| match line {
            Line::Let { operands, .. } => operands.iter().any(is_velocity),
            Line::Demand { .. } => false,
        };
        self.lines.iter().any(in_line) || self.outputs.iter().any(is_velocity)
    }
}

/// The operand that stands for an input; `None` for rates, excesses and multipliers.
fn place(input: Input, n: usize) -> Option<Operand> {
    match input {
        Input::Time => Some(Operand::Time),
        Input::Coordinate(_) | Input::Momentum(_) | Input::Quasi(_) => {
            input.component(n).map(Operand::State)
        }
        Input::Velocity(i) => Some(Operand::Velocity(i)),
        Input::Parameter(k) => Some(Operand::Parameter(k)),
        Input::Excess(_) | Input::MotionRate(_) | Input::Multiplier(_) => None,
    }
}

/// The sign or the name of an operation, and its operands.
fn operation(op: &Op, at: &dyn Fn(&Value) -> Operand) -> (&'static str, Vec<Operand>) {
    let name = match op {
        Op::Neg(_) => "neg",
        Op::Add(..) => "+",
        Op::Sub(..) => "-",
        Op::Mul(..) => "*",
        Op::Div(..) => "/",
        Op::Sqrt(_) => "sqrt",
        Op::Power(..) => "pow",
        Op::Atan2(..) => "atan2",
        Op::Call(Elementary::Ln, _) => "log",
        Op::Call(Elementary::Abs, _) => "fabs",
        Op::Call(function, _) => function.name(),
        Op::Input(_) | Op::Number(_) | Op::Pi | Op::Guard(_) => "",
    };
    (name, op.operands().iter().map(at).collect())
}

fn demand(guard: &Guard, at: &dyn Fn(&Value) -> Operand) -> Line {
    let (fault, factor) = match guard {
        Guard::Pivot { .. } => (Fault::Metric, 0.0),
        Guard::Constraint { .. } => (Fault::Constraint, Guard::LEAST_SQUARED_RATIO),
        Guard::Mass { .. } => (Fault::Constraint, Guard::LEAST_PIVOT_RATIO),
        Guard::Frame { .. } => (Fault::Frame, Guard::LEAST_SQUARED_RATIO),
        Guard::Surface { .. } => (Fault::Surface, Guard::LEAST_SQUARED_RATIO),
    };
    let mut operands = guard.operands().map(|value| at(&value));
    Line::Demand {
        value: operands.next().unwrap_or(Operand::Number(f64::NAN)),
        factor,
        reference: operands.next(),
        fault,
    }
}
