//! Random straight-line code gives the values of its operations, to the bit, with any number of registers in use.

use super::helpers::OfNumbers;
use super::straight::{Base, Binary, Operation, Place, Straight, Unary, Value, bytes};
use super::{Entry, assembly::Assembly, registers};
use dalembert_expr::Function as Elementary;
use dalembert_numbers::math;

/// Pseudorandom numbers from a seed.
pub(super) struct Random(pub(super) u64);

impl Random {
    /// A number between two others.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.below(1 << 20) as f64 / f64::from(1 << 20)
    }

    fn below(&mut self, bound: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % bound
    }
}

/// The bits of numbers; `None` for NaN.
pub(super) fn bits(numbers: &[f64]) -> Vec<Option<u64>> {
    let numbers = numbers.iter();
    numbers
        .map(|number| (!number.is_nan()).then(|| number.to_bits()))
        .collect()
}

const INPUTS: usize = 12;

/// Code with the values of its operations at the inputs.
struct Written {
    straight: Straight,
    values: Vec<f64>,
    /// Numbers that the code stores.
    stored: Vec<f64>,
}

/// Code of `count` operations that read at most `reach` values back.
fn write(random: &mut Random, (count, reach): (usize, usize), inputs: &[f64; INPUTS]) -> Written {
    let mut code = Written {
        straight: Straight::default(),
        values: Vec::new(),
        stored: Vec::new(),
    };
    code.push(Operation::Argument, 0.75);
    for (i, input) in inputs.iter().enumerate() {
        code.push(Operation::Load(Place::of(Base::Argument(1), i)), *input);
    }
    for _ in 0..count {
        code.grow(random, reach);
    }
    for back in 0..reach {
        let (value, number) = code.back(back);
        let place = Place::of(Base::Argument(3), back);
        code.straight.store(value, place);
        code.values.push(f64::NAN);
        code.stored.push(number);
    }
    code
}

impl Written {
    fn push(&mut self, operation: Operation, number: f64) {
        self.straight.push(operation);
        self.values.push(number);
    }

    /// A value that may be read, and its number.
    fn back(&self, back: usize) -> (Value, f64) {
        let readable: Vec<(Value, f64)> = self
            .straight
            .values()
            .zip(&self.values)
            .filter(|((_, operation), _)| !operation.has_effect())
            .map(|((value, _), number)| (value, *number))
            .collect();
        readable[readable.len() - 1 - back % readable.len()]
    }

    fn any(&self, random: &mut Random, reach: usize) -> (Value, f64) {
        self.back(random.below(reach))
    }

    fn grow(&mut self, random: &mut Random, reach: usize) {
        let [(a, x), (b, y)] = [(); 2].map(|()| self.any(random, reach));
        let elementary = Operation::Call(OfNumbers::Elementary(Elementary::Atan), a, None);
        match random.below(12) {
            0 => self.push(Operation::Unary(Unary::Neg, a), -x),
            1 => self.push(Operation::Unary(Unary::Abs, a), x.abs()),
            2 => self.push(Operation::Number(1.5_f64.to_bits()), 1.5),
            3 => self.push(elementary, math::atan(x)),
            4 => self.push(
                Operation::Call(OfNumbers::Atan2, a, Some(b)),
                math::atan2(x, y),
            ),
            5 => {
                let turned = if y < 0.0 { -x } else { x };
                self.push(Operation::Turned([a, b]), turned);
            }
            6 => {
                let place = self.straight.room(2);
                self.push(Operation::SineAndCosine(a, place), f64::NAN);
                self.push(Operation::Load(place), math::sin(x));
                self.push(Operation::Load(place.behind(1)), math::cos(x));
            }
            7 | 8 => self.push(Operation::Binary(Binary::Mul, [a, b]), x * y),
            9 => self.push(Operation::Binary(Binary::Sub, [a, b]), x - y),
            10 => self.push(Operation::Binary(Binary::Div, [a, b]), x / y),
            _ => self.push(Operation::Binary(Binary::Add, [a, b]), x + y),
        }
    }
}

#[test]
fn random_code_gives_the_values_of_its_operations() {
    let mut random = Random(7);
    let inputs: [f64; INPUTS] = core::array::from_fn(|i| 0.3 + 0.17 * i as f64);
    for round in 0..2000 {
        let (count, reach) = (1 + random.below(120), 2 + random.below(40));
        let code = write(&mut random, (count, reach), &inputs);
        let allocated = registers::allocate(&code.straight);
        let mut assembly = Assembly::new().expect("machine code for this processor");
        let entry = assembly.function(&allocated);
        let memory = assembly.finish().expect("memory");
        // SAFETY: a function with this signature was written there.
        let entry = unsafe { core::mem::transmute::<*const u8, Entry>(memory.ptr(entry)) };
        let mut stored = vec![0.0; reach];
        let (none, first) = (core::ptr::null(), inputs.as_ptr());
        // SAFETY: the code reads the inputs and writes as many numbers as it reaches back.
        let status = unsafe { entry(none, 0.75, first, none, stored.as_mut_ptr()) };
        assert_eq!(status, 0);
        let [expected, found] = [&code.stored, &stored].map(|numbers| bits(numbers));
        assert_eq!(expected, found, "round {round}: {allocated:?}");
    }
}

#[test]
fn a_guard_that_does_not_hold_stops_a_function() {
    for (value, status) in [(1.0, 0), (0.5, 1), (f64::NAN, 1)] {
        let mut straight = Straight::default();
        let t = straight.push(Operation::Argument);
        let bound = straight.number(0.5);
        straight.push(Operation::Guard([t, bound]));
        straight.store(t, Place::of(Base::Argument(3), 0));
        let mut assembly = Assembly::new().expect("machine code for this processor");
        let entry = assembly.function(&registers::allocate(&straight));
        let memory = assembly.finish().expect("memory");
        // SAFETY: a function with this signature was written there.
        let entry = unsafe { core::mem::transmute::<*const u8, Entry>(memory.ptr(entry)) };
        let (none, mut stored) = (core::ptr::null(), 0.0);
        // SAFETY: the code writes one number.
        let found = unsafe { entry(none, value, none, none, &raw mut stored) };
        assert_eq!(found, status, "{value}");
    }
}

#[test]
fn places_are_reached_however_far_they_lie() {
    const FAR: usize = (1 << 21) + 9;
    let mut inputs = vec![0.0; 2 * FAR];
    let mut stored = vec![0.0; 2 * FAR];
    for distance in [8, 63, 64, 65, 513, 4095, 4096, 8191, 1 << 17, FAR - 4] {
        let [before, after] = [FAR - distance, FAR + distance];
        (inputs[before], inputs[after]) = (1.25, distance as f64);
        let [read, written] = [1, 3].map(|pointer| {
            let place = Place::of(Base::Argument(pointer), 0);
            [-1, 1].map(|sign| place.shifted(sign * bytes(distance)))
        });
        let mut straight = Straight::with_frame(distance.min(5000));
        let [a, b] = read.map(|place| straight.load(place));
        let room = straight.room(1);
        straight.store(b, room);
        let b = straight.load(room);
        let difference = straight.binary(Binary::Sub, [b, a]);
        straight.store(a, written[0]);
        straight.store(difference, written[0].shifted(bytes(1)));
        straight.store(b, written[1]);
        let mut assembly = Assembly::new().expect("machine code for this processor");
        let entry = assembly.function(&registers::allocate(&straight));
        let memory = assembly.finish().expect("memory");
        // SAFETY: a function with this signature was written there.
        let entry = unsafe { core::mem::transmute::<*const u8, Entry>(memory.ptr(entry)) };
        let (none, first) = (core::ptr::null(), inputs[FAR..].as_ptr());
        // SAFETY: all the places lie in the vectors.
        let status = unsafe { entry(none, 0.0, first, none, stored[FAR..].as_mut_ptr()) };
        let found = [stored[before], stored[before + 1], stored[after]];
        let distance = distance as f64;
        assert_eq!((status, found), (0, [1.25, distance - 1.25, distance]));
    }
}
