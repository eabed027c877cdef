//! Straight-line code over doubles in static single assignment form.

use std::collections::BTreeMap;

use super::helpers::OfNumbers;

/// A value: the index of its operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Value(u32);

impl Value {
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }
}

/// Base of an address.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Base {
    /// The frame of the function.
    Frame,
    /// A pointer argument, by its index. Functions and series have different arguments.
    Argument(u8),
}

/// Address of a number in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Place {
    pub(super) base: Base,
    /// The distance from the base, in bytes.
    pub(super) offset: i32,
}

impl Place {
    /// The address of number `index` from a base.
    pub(super) fn of(base: Base, index: usize) -> Self {
        Self {
            base,
            offset: bytes(index),
        }
    }

    /// The address `count` numbers further.
    pub(super) fn behind(self, count: usize) -> Self {
        self.shifted(bytes(count))
    }

    /// The address `bytes` bytes further.
    pub(super) fn shifted(self, bytes: i32) -> Self {
        Self {
            base: self.base,
            offset: self.offset.saturating_add(bytes),
        }
    }
}

/// The length of `count` numbers in bytes.
pub(super) fn bytes(count: usize) -> i32 {
    i32::try_from(8 * count).unwrap_or(i32::MAX)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Binary {
    Add,
    Sub,
    Mul,
    Div,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unary {
    Neg,
    Abs,
    Sqrt,
}

#[derive(Debug, Clone)]
pub(super) enum Operation {
    /// The floating-point argument.
    Argument,
    /// A constant, by its bits.
    Number(u64),
    /// A number in memory, which is constant while the value is read.
    Load(Place),
    Unary(Unary, Value),
    Binary(Binary, [Value; 2]),
    /// `a b + c`, rounded once.
    MulAdd([Value; 3]),
    /// The first value, negated if the second is negative.
    Turned([Value; 2]),
    /// The value at order 1 of a series, 0 at other orders.
    AtFirst(Value),
    /// `sum + a b` with factors in memory if the current order of a series is at least `order`, else `sum`.
    AddFrom {
        order: i32,
        sum: Value,
        factors: [Place; 2],
    },
    /// A call of a function of one or two numbers.
    Call(OfNumbers, Value, Option<Value>),
    /// Writes sine and cosine of a number to a place of the frame.
    SineAndCosine(Value, Place),
    /// Writes a value to a place that is not written again: the value may be read from there.
    Store(Value, Place),
    /// Leaves the function with status 1 unless the first value is larger than the second.
    Guard([Value; 2]),
}

impl Operation {
    /// Calls `see` with every value that the operation reads.
    pub(super) fn read(&self, mut see: impl FnMut(Value)) {
        match self {
            Self::Argument | Self::Number(_) | Self::Load(_) => {}
            Self::Unary(_, a)
            | Self::AtFirst(a)
            | Self::AddFrom { sum: a, .. }
            | Self::SineAndCosine(a, _)
            | Self::Store(a, _) => see(*a),
            Self::Binary(_, operands) | Self::Turned(operands) | Self::Guard(operands) => {
                operands.iter().copied().for_each(see);
            }
            Self::MulAdd(operands) => operands.iter().copied().for_each(see),
            Self::Call(_, a, b) => {
                see(*a);
                if let Some(b) = b {
                    see(*b);
                }
            }
        }
    }

    /// True if the operation is needed even if no operation reads its value.
    pub(super) fn has_effect(&self) -> bool {
        matches!(
            self,
            Self::Store(..) | Self::Guard(_) | Self::SineAndCosine(..)
        )
    }
}

/// Operations in order, and the size of the frame that they use.
#[derive(Debug, Default)]
pub(super) struct Straight {
    pub(super) operations: Vec<Operation>,
    /// Size of the frame, in numbers.
    pub(super) frame: usize,
    numbers: BTreeMap<u64, Value>,
    loads: BTreeMap<Place, Value>,
}

impl Straight {
    /// Code that follows other code and keeps the first `frame` numbers of the frame.
    pub(super) fn with_frame(frame: usize) -> Self {
        Self {
            frame,
            ..Self::default()
        }
    }

    /// The values in order, with their operations.
    pub(super) fn values(&self) -> impl Iterator<Item = (Value, &Operation)> {
        (0..).map(Value).zip(&self.operations)
    }

    pub(super) fn push(&mut self, operation: Operation) -> Value {
        let value = Value(u32::try_from(self.operations.len()).unwrap_or(u32::MAX));
        self.operations.push(operation);
        value
    }

    /// Reserves room for `count` numbers in the frame.
    pub(super) fn room(&mut self, count: usize) -> Place {
        let place = Place::of(Base::Frame, self.frame);
        self.frame += count;
        place
    }

    pub(super) fn number(&mut self, number: f64) -> Value {
        let bits = number.to_bits();
        if let Some(value) = self.numbers.get(&bits) {
            return *value;
        }
        let value = self.push(Operation::Number(bits));
        self.numbers.insert(bits, value);
        value
    }

    pub(super) fn load(&mut self, place: Place) -> Value {
        if let Some(value) = self.loads.get(&place) {
            return *value;
        }
        let value = self.push(Operation::Load(place));
        self.loads.insert(place, value);
        value
    }

    pub(super) fn unary(&mut self, operation: Unary, a: Value) -> Value {
        self.push(Operation::Unary(operation, a))
    }

    pub(super) fn binary(&mut self, operation: Binary, operands: [Value; 2]) -> Value {
        self.push(Operation::Binary(operation, operands))
    }

    pub(super) fn add(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Add, [a, b])
    }

    pub(super) fn mul(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Mul, [a, b])
    }

    pub(super) fn store(&mut self, value: Value, place: Place) {
        self.push(Operation::Store(value, place));
    }
}
