//! Register allocation for straight-line code.
//!
//! Operations are processed in their order. A value with a place in memory (a constant, a number behind a pointer
//! argument, a value in the frame) is read from there if one read is left, and loaded into a register if several are left. If no register is
//! free, the value with the latest next read is evicted. It is stored in the frame unless it has a place in memory.
//! Calls preserve no register.

use super::helpers;
use super::straight::{Base, Binary, Operation, Place, Straight, Unary, Value};

/// A register for doubles, by its number.
pub(super) type Register = u8;

/// Number of registers for values. The two registers behind them are scratch registers of single instructions.
const COUNT: usize = 14;

/// The first scratch register.
pub(super) const SCRATCH: Register = COUNT as Register;

/// Operand of an instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Operand {
    Register(Register),
    Memory(Place),
    /// A constant, by its bits.
    Number(u64),
}

/// An operation with registers. The register that it sets, if any, comes first.
#[derive(Debug, Clone)]
pub(super) enum Instruction {
    Move(Register, Operand),
    Store(Register, Place),
    Unary(Unary, Register, Register),
    Binary(Binary, Register, Register, Operand),
    /// Adds a product.
    MulAdd(Register, Register, Operand),
    Turned(Register, [Register; 2]),
    AtFirst(Register, Operand),
    /// Adds a product of two numbers in memory if the current order of the series is at least this one.
    AddFrom(Register, i32, [Place; 2]),
    /// Calls the function at an address, with arguments in the first registers and this place.
    Call(usize, Option<Place>),
    Guard(Register, Operand),
}

/// Straight-line code with registers.
#[derive(Debug)]
pub(super) struct Allocated {
    pub(super) instructions: Vec<Instruction>,
    /// Length of the frame, in numbers.
    pub(super) frame: usize,
}

impl Allocated {
    pub(super) fn has_calls(&self) -> bool {
        let mut instructions = self.instructions.iter();
        instructions.any(|instruction| matches!(instruction, Instruction::Call(..)))
    }
}

/// Places from which a value can be read again.
#[derive(Debug, Clone, Copy)]
enum Home {
    Fixed(Operand),
    /// A place of the frame that is free once the value is no longer needed.
    Spilled(Place),
}

struct Allocation {
    instructions: Vec<Instruction>,
    /// Reads of each value, the next one last.
    reads: Vec<Vec<u32>>,
    registers: Vec<Option<Register>>,
    homes: Vec<Option<Home>>,
    /// The values of the registers.
    held: [Option<Value>; COUNT],
    /// Registers that the current instruction reads, as bits.
    locked: u16,
    frame: usize,
    free: Vec<Place>,
    /// Places that become free once the current instruction has read them.
    released: Vec<Place>,
}

/// Assigns registers to the values of straight-line code.
pub(super) fn allocate(code: &Straight) -> Allocated {
    let count = code.operations.len();
    let mut allocation = Allocation {
        instructions: Vec::with_capacity(count),
        reads: reads(code),
        registers: vec![None; count],
        homes: vec![None; count],
        held: [None; COUNT],
        locked: 0,
        frame: code.frame,
        free: Vec::new(),
        released: Vec::new(),
    };
    for (value, operation) in code.values() {
        if operation.has_effect() || allocation.is_needed(value) {
            allocation.place(value, operation);
            allocation.locked = 0;
            allocation.free.append(&mut allocation.released);
        }
    }
    Allocated {
        instructions: allocation.instructions,
        frame: allocation.frame,
    }
}

/// Positions of the reads of each value, the last read first. Operations without effect that nothing reads are left
/// out.
fn reads(code: &Straight) -> Vec<Vec<u32>> {
    let mut reads = vec![Vec::new(); code.operations.len()];
    for (place, operation) in code.operations.iter().enumerate().rev() {
        if operation.has_effect() || !reads[place].is_empty() {
            let place = u32::try_from(place).unwrap_or(u32::MAX);
            operation.read(|value| reads[value.index()].push(place));
        }
    }
    reads
}

impl Allocation {
    fn place(&mut self, value: Value, operation: &Operation) {
        match operation {
            Operation::Argument => self.hold(value, 0),
            Operation::Number(bits) => self.fix(value, Operand::Number(*bits)),
            Operation::Load(place) => self.fix(value, Operand::Memory(*place)),
            Operation::Unary(unary, a) => {
                let from = self.register(*a);
                self.done(*a);
                let to = self.take_for(value);
                self.instructions.push(Instruction::Unary(*unary, to, from));
            }
            Operation::Binary(binary, operands) => self.binary(value, *binary, *operands),
            Operation::MulAdd([a, b, sum]) => {
                let factor = self.register(*a);
                let other = self.operand(*b);
                let from = self.register(*sum);
                self.done(*a);
                self.done(*b);
                let to = self.take_over(value, *sum, from);
                self.instructions
                    .push(Instruction::MulAdd(to, factor, other));
            }
            Operation::Turned(operands) => {
                let from = operands.map(|operand| self.register(operand));
                operands.iter().for_each(|operand| self.done(*operand));
                let to = self.take_for(value);
                self.instructions.push(Instruction::Turned(to, from));
            }
            Operation::AtFirst(a) => {
                let from = self.operand(*a);
                let to = self.take_for(value);
                self.done(*a);
                self.instructions.push(Instruction::AtFirst(to, from));
            }
            Operation::AddFrom {
                order,
                sum,
                factors,
            } => {
                let from = self.register(*sum);
                let to = self.take_over(value, *sum, from);
                self.instructions
                    .push(Instruction::AddFrom(to, *order, *factors));
            }
            Operation::Call(..) | Operation::SineAndCosine(..) => {
                self.call(value, operation);
            }
            Operation::Store(a, place) => {
                let from = self.register(*a);
                self.instructions.push(Instruction::Store(from, *place));
                if self.homes[a.index()].is_none() {
                    self.fix(*a, Operand::Memory(*place));
                }
                self.done(*a);
            }
            Operation::Guard([a, bound]) => {
                let from = self.register(*a);
                let bound_from = self.operand(*bound);
                self.done(*a);
                self.done(*bound);
                self.instructions.push(Instruction::Guard(from, bound_from));
            }
        }
    }

    fn call(&mut self, value: Value, operation: &Operation) {
        match operation {
            Operation::Call(function, a, b) => {
                self.give_arguments(*a, *b);
                self.instructions
                    .push(Instruction::Call(function.address(), None));
                self.hold(value, 0);
            }
            Operation::SineAndCosine(a, place) => {
                self.give_arguments(*a, None);
                let address = helpers::address_of_sine_and_cosine();
                self.instructions
                    .push(Instruction::Call(address, Some(*place)));
            }
            _ => unreachable!("only calls come here"),
        }
    }

    fn binary(&mut self, value: Value, binary: Binary, [a, b]: [Value; 2]) {
        let is_in_register = |value: Value| self.registers[value.index()].is_some();
        let is_turned =
            matches!(binary, Binary::Add | Binary::Mul) && !is_in_register(a) && is_in_register(b);
        let [a, b] = if is_turned { [b, a] } else { [a, b] };
        let first = self.register(a);
        let second = self.operand(b);
        self.done(a);
        self.done(b);
        let to = self.take_for(value);
        self.instructions
            .push(Instruction::Binary(binary, to, first, second));
    }

    fn is_needed(&self, value: Value) -> bool {
        !self.reads[value.index()].is_empty()
    }

    fn fix(&mut self, value: Value, operand: Operand) {
        self.homes[value.index()] = Some(Home::Fixed(operand));
    }

    fn hold(&mut self, value: Value, register: Register) {
        self.held[usize::from(register)] = Some(value);
        self.registers[value.index()] = Some(register);
        self.locked |= 1 << register;
    }

    /// Operand from which a value is read now.
    fn found(&self, value: Value) -> Operand {
        match (self.registers[value.index()], self.homes[value.index()]) {
            (Some(register), _) => Operand::Register(register),
            (None, Some(Home::Fixed(operand))) => operand,
            (None, Some(Home::Spilled(place))) => Operand::Memory(place),
            (None, None) => unreachable!("a needed value has a register or a place"),
        }
    }

    /// A register with the value, locked for the current instruction.
    fn register(&mut self, value: Value) -> Register {
        let found = self.found(value);
        if let Operand::Register(register) = found {
            self.locked |= 1 << register;
            return register;
        }
        let register = self.take();
        self.instructions.push(Instruction::Move(register, found));
        self.hold(value, register);
        register
    }

    /// Same as [`Self::register`], but a value in memory is read from there if this is its last read.
    fn operand(&mut self, value: Value) -> Operand {
        match (self.found(value), self.reads[value.index()].len()) {
            (Operand::Register(_), _) | (_, 2..) => Operand::Register(self.register(value)),
            (memory, _) => memory,
        }
    }

    /// Counts one read of a value as done. After the last read, its register and its place in the frame are free.
    fn done(&mut self, value: Value) {
        self.reads[value.index()].pop();
        if self.is_needed(value) {
            return;
        }
        if let Some(register) = self.registers[value.index()].take() {
            self.held[usize::from(register)] = None;
        }
        if let Some(Home::Spilled(place)) = self.homes[value.index()].take() {
            self.released.push(place);
        }
    }

    /// A register for a result: it may be one that the instruction reads, unless its value is needed later.
    fn take_for(&mut self, value: Value) -> Register {
        for register in 0..COUNT {
            if self.held[register].is_none() {
                self.locked &= !(1 << register);
            }
        }
        let register = self.take();
        self.hold(value, register);
        register
    }

    /// The register of a sum for its new value, or a copy if the old value is needed later.
    fn take_over(&mut self, value: Value, sum: Value, from: Register) -> Register {
        self.done(sum);
        if !self.is_needed(sum) {
            self.hold(value, from);
            return from;
        }
        let to = self.take();
        self.instructions
            .push(Instruction::Move(to, Operand::Register(from)));
        self.hold(value, to);
        to
    }

    /// A register that is not locked.
    fn take(&mut self) -> Register {
        let open = (0..COUNT).filter(|register| self.locked & (1 << register) == 0);
        let next_read = |register: usize| match self.held[register] {
            None => u32::MAX,
            Some(value) => self.reads[value.index()]
                .last()
                .copied()
                .unwrap_or(u32::MAX),
        };
        // NOTE: the first of the best registers, so that few registers are used.
        let register = open
            .rev()
            .max_by_key(|register| next_read(*register))
            .expect("an instruction reads fewer registers than there are");
        if let Some(value) = self.held[register].take() {
            self.spill(value);
            self.registers[value.index()] = None;
        }
        register as Register
    }

    /// Puts a value without a place in memory into the frame.
    fn spill(&mut self, value: Value) {
        let (Some(register), None) = (self.registers[value.index()], self.homes[value.index()])
        else {
            return;
        };
        let place = self.free.pop().unwrap_or_else(|| {
            self.frame += 1;
            Place::of(Base::Frame, self.frame - 1)
        });
        self.instructions.push(Instruction::Store(register, place));
        self.homes[value.index()] = Some(Home::Spilled(place));
    }

    /// Puts arguments of a call into the first registers.
    fn give_arguments(&mut self, a: Value, b: Option<Value>) {
        let mut first = self.found(a);
        let second = b.map(|b| self.found(b));
        self.done(a);
        if let Some(b) = b {
            self.done(b);
        }
        self.keep_no_register();
        if let Some(second) = second {
            if first == Operand::Register(1) {
                self.instructions.push(Instruction::Move(SCRATCH, first));
                first = Operand::Register(SCRATCH);
            }
            self.instructions.push(Instruction::Move(1, second));
        }
        self.instructions.push(Instruction::Move(0, first));
    }

    /// Puts values that are needed later into the frame.
    fn keep_no_register(&mut self) {
        for register in 0..COUNT {
            if let Some(value) = self.held[register].take() {
                self.spill(value);
                self.registers[value.index()] = None;
            }
        }
    }
}
