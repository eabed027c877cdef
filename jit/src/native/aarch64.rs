//! Code generation for aarch64. Functions follow the procedure call standard.
//!
//! | registers | |
//! |---|---|
//! | `x0` to `x3`, constants in `x4` | bases of a function that calls nothing |
//! | `x19` to `x22`, constants in `x25` | bases of a function that calls others |
//! | `x19` to `x23`, constants in `x25` | bases of a series: parameters, values at order 0, row of coefficients, kept rows, newest of them |
//! | `x24` | the current order of a series |
//! | `x9` to `x12` | in a loop over sums: rows of both factors, number of products left, bytes of a row |
//! | `x16` | scratch: an address or an integer for one instruction |

// NOTE: the assembler's macro converts numbers of registers and constants.
#![allow(clippy::useless_conversion)]

use std::collections::BTreeMap;

use dynasmrt::aarch64::Assembler;
use dynasmrt::{AssemblyOffset, DynamicLabel, DynasmApi, DynasmLabelApi, ExecutableBuffer, dynasm};

use super::layout::{Group, LAST, WEIGHT};
use super::registers::{Allocated, Instruction, Operand, Register, SCRATCH};
use super::series::Expansion;
use super::straight::{Base, Binary, Place, Unary, bytes};

/// A function, or a type of functions, with the calling convention of machine code.
macro_rules! convention {
    (unsafe fn $($function:tt)+) => { unsafe extern "C" fn $($function)+ };
    ($(#[$meta:meta])* fn $($function:tt)+) => { $(#[$meta])* extern "C" fn $($function)+ };
}
pub(super) use convention;

/// Number of doubles in a vector.
pub(super) const LANES: usize = 2;

/// Number of vectors of sums in one loop.
pub(super) const SIDE_BY_SIDE: usize = 16;

/// Registers of a loop over sums: first the vectors of sums, then the factors.
const FACTORS: Register = SIDE_BY_SIDE as Register;
const END: Register = 24;

/// The hardware register of an allocated register. Registers that a function must preserve are left out.
fn v(register: Register) -> u8 {
    match register {
        0..8 => register,
        _ => register + 8,
    }
}

/// Numbers of general registers.
const ADDRESS: u8 = 16;
const POOL: u8 = 25;
const POOL_OF_LEAF: u8 = 4;
const SP: u8 = 31;
const ROWS: [u8; 2] = [9, 10];
const OF_LEAF: [u8; 4] = [0, 1, 2, 3];
const OF_CALLER: [u8; 4] = [19, 20, 21, 22];
const OF_SERIES: [u8; 5] = [19, 20, 21, 22, 23];

/// The immediate operand of an addition is below `PAGE`, or a multiple of it.
const PAGE: i32 = 4096;

/// Machine code under construction.
pub(super) struct Assembly {
    ops: Assembler,
    /// The registers of the base pointers of places.
    bases: &'static [u8],
    /// The register of the pointer to constants.
    pool: u8,
    constants: DynamicLabel,
    /// Constants by their bits, with their indices.
    numbers: BTreeMap<u64, usize>,
    /// Label of the exit of the current function after a failed guard.
    stopped: DynamicLabel,
}

/// Bytes of a stack frame. `saves` is true if registers are saved above it.
#[derive(Clone, Copy)]
struct Frame {
    length: i32,
    saves: bool,
}

impl Frame {
    fn of(numbers: usize, saves: bool) -> Self {
        Self {
            length: bytes(numbers.next_multiple_of(2)),
            saves,
        }
    }
}

/// Vectors of sums, and the offsets of their factors.
struct Products {
    vectors: Register,
    /// Offsets of the first and of the second factors in a row.
    places: [i32; 2],
    /// Bytes from one row to the next.
    kept: i32,
}

impl Products {
    fn place(&self, which: usize, sum: Register) -> i32 {
        self.places[which] + bytes(LANES * usize::from(sum))
    }
}

impl Assembly {
    /// `None` if there is no memory.
    pub(super) fn new() -> Option<Self> {
        let mut ops = Assembler::new().ok()?;
        let [constants, stopped] = core::array::from_fn(|_| ops.new_dynamic_label());
        Some(Self {
            ops,
            bases: &OF_LEAF,
            pool: POOL_OF_LEAF,
            constants,
            numbers: BTreeMap::new(),
            stopped,
        })
    }

    /// Emits a function of four pointers and, after the first of them, a number. It returns 0, or 1 after a failed
    /// guard.
    pub(super) fn function(&mut self, code: &Allocated) -> AssemblyOffset {
        self.stopped = self.ops.new_dynamic_label();
        let has_calls = code.has_calls();
        (self.bases, self.pool) = match has_calls {
            true => (&OF_CALLER, POOL),
            false => (&OF_LEAF, POOL_OF_LEAF),
        };
        let frame = Frame::of(code.frame, has_calls);
        let entry = self.enter(frame);
        if has_calls {
            dynasm!(self.ops ; .arch aarch64
                ; mov x19, x0 ; mov x20, x1 ; mov x21, x2 ; mov x22, x3);
        }
        self.instructions(&code.instructions);
        for status in [0, 1] {
            if status == 1 {
                dynasm!(self.ops ; .arch aarch64 ; =>self.stopped);
            }
            dynasm!(self.ops ; .arch aarch64 ; movz w0, status);
            self.leave(frame);
        }
        entry
    }

    /// Emits a function of parameters, values at order 0, unit, last order, coefficients from order 1 on, and room.
    pub(super) fn series(&mut self, expansion: &Expansion<'_>) -> AssemblyOffset {
        (self.bases, self.pool) = (&OF_SERIES, POOL);
        let frame = Frame::of(expansion.frame(), true);
        let [last, weight] = [LAST, WEIGHT].map(|place| bytes(place).unsigned_abs());
        let [head, end] = core::array::from_fn(|_| self.ops.new_dynamic_label());
        let (row, kept) = (expansion.row, expansion.kept);
        let less = u32::from(!expansion.takes_last);
        let entry = self.enter(frame);
        dynasm!(self.ops ; .arch aarch64
            ; mov x19, x0 ; mov x20, x1 ; mov x21, x3 ; mov x22, x4
            ; sub x2, x2, less
            ; str x2, [sp, last]);
        self.instructions(&expansion.before.instructions);
        self.add(23, 22, kept);
        dynasm!(self.ops ; .arch aarch64
            ; movz x24, 1
            ; =>head
            ; ldr X(ADDRESS), [sp, last]
            ; cmp x24, X(ADDRESS)
            ; b.le >next
            ; b =>end
            ; next:
            ; scvtf d0, x24
            ; str d0, [sp, weight]);
        for group in expansion.groups {
            self.sums(group, kept);
        }
        self.instructions(&expansion.order.instructions);
        self.add(23, 23, kept);
        self.add(21, 21, row);
        dynasm!(self.ops ; .arch aarch64
            ; add x24, x24, 1
            ; b =>head
            ; =>end);
        self.leave(frame);
        entry
    }

    /// Emits the prologue of a function.
    fn enter(&mut self, frame: Frame) -> AssemblyOffset {
        let distance = self.ops.new_dynamic_label();
        dynasm!(self.ops ; .arch aarch64 ; .align 8 ; =>distance ; .rel64 =>self.constants);
        let entry = self.ops.offset();
        if frame.saves {
            dynasm!(self.ops ; .arch aarch64
                ; stp x29, x30, [sp, -80]!
                ; mov x29, sp
                ; stp x19, x20, [sp, 16]
                ; stp x21, x22, [sp, 32]
                ; stp x23, x24, [sp, 48]
                ; str x25, [sp, 64]);
        }
        self.add(SP, SP, -frame.length);
        dynasm!(self.ops ; .arch aarch64
            ; adr X(ADDRESS), =>distance
            ; ldr X(self.pool), [X(ADDRESS)]
            ; add X(self.pool), X(self.pool), X(ADDRESS));
        entry
    }

    /// Emits the epilogue of a function.
    fn leave(&mut self, frame: Frame) {
        self.add(SP, SP, frame.length);
        if frame.saves {
            dynasm!(self.ops ; .arch aarch64
                ; ldr x25, [sp, 64]
                ; ldp x23, x24, [sp, 48]
                ; ldp x21, x22, [sp, 32]
                ; ldp x19, x20, [sp, 16]
                ; ldp x29, x30, [sp], 80);
        }
        dynasm!(self.ops ; .arch aarch64 ; ret);
    }

    /// Emits the sums of a group, with the order of additions of `jet::middles` and `jet::halves`.
    fn sums(&mut self, group: &Group, kept: i32) {
        let vectors = (group.width() / LANES) as Register;
        let [in_row, in_frame] = group.distances();
        for block in 0..group.blocks.len() {
            let done = self.ops.new_dynamic_label();
            for sum in 0..vectors {
                dynasm!(self.ops ; .arch aarch64 ; movi V(v(sum)).d2, 0);
            }
            let products = Products {
                vectors,
                places: group.places.map(|place| bytes(place + block * in_row)),
                kept,
            };
            dynasm!(self.ops ; .arch aarch64 ; cmp x24, 2 ; b.lt =>done);
            if group.is_half() {
                self.halves(&products, done);
            } else {
                self.middles(&products, done);
            }
            dynasm!(self.ops ; .arch aarch64 ; =>done);
            for sum in 0..vectors {
                let place = group.results + block * in_frame + LANES * usize::from(sum);
                let (base, offset) = self.reach((SP, bytes(place)), bytes(LANES));
                dynasm!(self.ops ; .arch aarch64 ; str Q(v(sum)), [XSP(base), offset]);
            }
        }
    }

    fn middles(&mut self, products: &Products, done: DynamicLabel) {
        let [a, b] = ROWS;
        self.add(a, 22, 2 * products.kept);
        self.add(b, 23, -2 * products.kept);
        dynasm!(self.ops ; .arch aarch64 ; sub x11, x24, 3);
        self.add_range(products, products.kept);
        self.add_ends(products);
        dynasm!(self.ops ; .arch aarch64 ; cmp x24, 2 ; b.le =>done);
        self.add_products(products, [b, a]);
    }

    fn halves(&mut self, products: &Products, done: DynamicLabel) {
        let [a, b] = ROWS;
        let (half, factor) = (FACTORS, FACTORS + 1);
        self.integer(12, products.kept.into());
        dynasm!(self.ops ; .arch aarch64
            ; tbnz x24, 0, >odd
            ; fmov V(v(half)).d2, 0.5
            ; lsr X(a), x24, 1
            ; madd X(a), X(a), x12, x22);
        for sum in 0..products.vectors {
            self.load_vector(factor, (a, products.place(0, sum)));
            dynasm!(self.ops ; .arch aarch64
                ; fmul V(v(sum)).d2, V(v(half)).d2, V(v(factor)).d2
                ; fmul V(v(sum)).d2, V(v(sum)).d2, V(v(factor)).d2);
        }
        dynasm!(self.ops ; .arch aarch64
            ; odd:
            ; cmp x24, 2
            ; b.le =>done
            ; sub x11, x24, 1
            ; lsr x11, x11, 1
            ; msub X(b), x11, x12, x23
            ; madd X(a), x11, x12, x22
            ; sub x11, x11, 1);
        self.add_range(products, -products.kept);
        self.add_ends(products);
    }

    /// Adds `x11` products. After each, the rows move by `step` in opposite directions.
    fn add_range(&mut self, products: &Products, step: i32) {
        let [head, end] = core::array::from_fn(|_| self.ops.new_dynamic_label());
        dynasm!(self.ops ; .arch aarch64 ; cmp x11, 0 ; b.le =>end ; =>head);
        self.add_products(products, ROWS);
        let [a, b] = ROWS;
        self.add(a, a, step);
        self.add(b, b, -step);
        dynasm!(self.ops ; .arch aarch64 ; subs x11, x11, 1 ; b.ne =>head ; =>end);
    }

    /// Adds the products of order 1 and the newest order. Afterwards the row registers hold the rows of these orders.
    fn add_ends(&mut self, products: &Products) {
        let [a, b] = ROWS;
        self.add(a, 22, products.kept);
        self.add(b, 23, -products.kept);
        self.add_products(products, ROWS);
    }

    /// Adds the products of the first factors of one row and the second factors of another.
    fn add_products(&mut self, products: &Products, rows: [u8; 2]) {
        for sum in 0..products.vectors {
            // NOTE: factors rotate through a few registers, so that products of one pass do not wait for each other.
            let [x, y] = [0, 1].map(|which| {
                let factor = FACTORS + (2 * sum + which) % (END - FACTORS);
                let which = usize::from(which);
                self.load_vector(factor, (rows[which], products.place(which, sum)));
                v(factor)
            });
            if super::IS_FUSED {
                dynasm!(self.ops ; .arch aarch64 ; fmla V(v(sum)).d2, V(x).d2, V(y).d2);
            } else {
                dynasm!(self.ops ; .arch aarch64
                    ; fmul V(x).d2, V(x).d2, V(y).d2
                    ; fadd V(v(sum)).d2, V(v(sum)).d2, V(x).d2);
            }
        }
    }

    /// The executable code of all functions.
    pub(super) fn finish(mut self) -> Option<ExecutableBuffer> {
        let mut numbers = vec![0; self.numbers.len()];
        for (bits, place) in self.numbers {
            numbers[place] = bits;
        }
        dynasm!(self.ops ; .arch aarch64 ; .align 8 ; =>self.constants);
        for bits in numbers {
            dynasm!(self.ops ; .arch aarch64 ; .u64 bits);
        }
        self.ops.commit().ok()?;
        self.ops.finalize().ok()
    }

    /// Base register and offset of a place.
    fn address(&self, place: Place) -> (u8, i32) {
        match place.base {
            Base::Frame => (SP, place.offset),
            Base::Argument(index) => (self.bases[usize::from(index)], place.offset),
        }
    }

    /// Base register and offset of a constant.
    fn number(&mut self, bits: u64) -> (u8, i32) {
        let next = self.numbers.len();
        (self.pool, bytes(*self.numbers.entry(bits).or_insert(next)))
    }

    /// Base register and offset for an instruction that accesses `length` bytes.
    fn reach(&mut self, (base, offset): (u8, i32), length: i32) -> (u8, u32) {
        let is_near = offset % length == 0 && (0..length * PAGE).contains(&offset);
        if is_near {
            return (base, offset.unsigned_abs());
        }
        let rest = offset.rem_euclid(PAGE);
        if rest % length == 0 {
            self.add(ADDRESS, base, offset - rest);
            return (ADDRESS, rest.unsigned_abs());
        }
        self.add(ADDRESS, base, offset);
        (ADDRESS, 0)
    }

    /// `to = from + offset`.
    fn add(&mut self, to: u8, from: u8, offset: i32) {
        let size = offset.unsigned_abs();
        let (pages, rest) = (offset.div_euclid(PAGE), offset.rem_euclid(PAGE));
        match offset {
            0 if to == from => {}
            0..PAGE => dynasm!(self.ops ; .arch aarch64 ; add XSP(to), XSP(from), size),
            -4095..0 => dynasm!(self.ops ; .arch aarch64 ; sub XSP(to), XSP(from), size),
            _ => {
                self.add_pages(to, from, pages);
                self.add(to, to, rest);
            }
        }
    }

    /// `to = from + pages * PAGE`.
    fn add_pages(&mut self, to: u8, from: u8, pages: i32) {
        let count = pages.unsigned_abs();
        match pages {
            0..PAGE => dynasm!(self.ops ; .arch aarch64 ; add XSP(to), XSP(from), count, LSL 12),
            -4095..0 => dynasm!(self.ops ; .arch aarch64 ; sub XSP(to), XSP(from), count, LSL 12),
            _ => {
                self.integer(ADDRESS, i64::from(pages) * i64::from(PAGE));
                dynasm!(self.ops ; .arch aarch64 ; add XSP(to), XSP(from), X(ADDRESS));
            }
        }
    }

    /// `to = value`.
    fn integer(&mut self, to: u8, value: i64) {
        let sixteen = |shift: u32, value: i64| u32::from((value >> shift) as u16);
        match value < 0 {
            true => dynasm!(self.ops ; .arch aarch64 ; movn X(to), sixteen(0, !value)),
            false => dynasm!(self.ops ; .arch aarch64 ; movz X(to), sixteen(0, value)),
        }
        for shift in [16, 32, 48] {
            let bits = sixteen(shift, value);
            if bits != sixteen(shift, value >> 63) {
                dynasm!(self.ops ; .arch aarch64 ; movk X(to), bits, LSL shift);
            }
        }
    }

    fn instructions(&mut self, instructions: &[Instruction]) {
        for instruction in instructions {
            self.instruction(instruction);
        }
    }

    fn instruction(&mut self, instruction: &Instruction) {
        match *instruction {
            Instruction::Move(to, from) => self.load(to, from),
            Instruction::Store(from, place) => {
                let (base, offset) = self.reach(self.address(place), bytes(1));
                dynasm!(self.ops ; .arch aarch64 ; str D(v(from)), [XSP(base), offset]);
            }
            Instruction::Unary(unary, to, from) => self.unary(unary, to, from),
            Instruction::Binary(binary, to, from, operand) => {
                self.binary(binary, to, from, operand);
            }
            Instruction::MulAdd(sum, from, operand) => {
                let other = v(self.register(operand, SCRATCH));
                let (sum, from) = (v(sum), v(from));
                dynasm!(self.ops ; .arch aarch64 ; fmadd D(sum), D(from), D(other), D(sum));
            }
            Instruction::Turned(to, [from, by]) => {
                let (to, from, by, sign) = (v(to), v(from), v(by), v(SCRATCH));
                dynasm!(self.ops ; .arch aarch64
                    ; fcmlt D(sign), D(by), 0.0
                    ; shl D(sign), D(sign), 63
                    ; eor V(to).b8, V(from).b8, V(sign).b8);
            }
            Instruction::AtFirst(to, from) => {
                let first = v(self.register(from, SCRATCH));
                let zero = v(SCRATCH + 1);
                dynasm!(self.ops ; .arch aarch64
                    ; movi D(zero), 0
                    ; cmp x24, 1
                    ; fcsel D(v(to)), D(first), D(zero), eq);
            }
            Instruction::AddFrom(sum, order, factors) => self.add_from(sum, order, factors),
            Instruction::Call(address, place) => {
                if let Some(place) = place {
                    self.point(0, place);
                }
                self.call(address);
            }
            Instruction::Guard(from, bound) => {
                let bound = self.register(bound, SCRATCH);
                // NOTE: a comparison with NaN is not "larger". The exit may be out of reach of a conditional branch.
                dynasm!(self.ops ; .arch aarch64
                    ; fcmp D(v(from)), D(v(bound))
                    ; b.gt >next
                    ; b =>self.stopped
                    ; next:);
            }
        }
    }

    fn load(&mut self, to: Register, from: Operand) {
        let place = match from {
            Operand::Register(from) if from == to => return,
            Operand::Register(from) => {
                dynasm!(self.ops ; .arch aarch64 ; fmov D(v(to)), D(v(from)));
                return;
            }
            Operand::Memory(place) => self.address(place),
            Operand::Number(bits) => self.number(bits),
        };
        let (base, offset) = self.reach(place, bytes(1));
        dynasm!(self.ops ; .arch aarch64 ; ldr D(v(to)), [XSP(base), offset]);
    }

    fn load_vector(&mut self, to: Register, place: (u8, i32)) {
        let (base, offset) = self.reach(place, bytes(LANES));
        dynasm!(self.ops ; .arch aarch64 ; ldr Q(v(to)), [XSP(base), offset]);
    }

    /// The register of an operand. An operand without one is loaded into `scratch`.
    fn register(&mut self, operand: Operand, scratch: Register) -> Register {
        match operand {
            Operand::Register(register) => register,
            memory => {
                self.load(scratch, memory);
                scratch
            }
        }
    }

    fn unary(&mut self, unary: Unary, to: Register, from: Register) {
        let (to, from) = (v(to), v(from));
        match unary {
            Unary::Neg => dynasm!(self.ops ; .arch aarch64 ; fneg D(to), D(from)),
            Unary::Abs => dynasm!(self.ops ; .arch aarch64 ; fabs D(to), D(from)),
            Unary::Sqrt => dynasm!(self.ops ; .arch aarch64 ; fsqrt D(to), D(from)),
        }
    }

    fn binary(&mut self, binary: Binary, to: Register, from: Register, operand: Operand) {
        let other = v(self.register(operand, SCRATCH));
        let (to, from) = (v(to), v(from));
        match binary {
            Binary::Add => dynasm!(self.ops ; .arch aarch64 ; fadd D(to), D(from), D(other)),
            Binary::Sub => dynasm!(self.ops ; .arch aarch64 ; fsub D(to), D(from), D(other)),
            Binary::Mul => dynasm!(self.ops ; .arch aarch64 ; fmul D(to), D(from), D(other)),
            Binary::Div => dynasm!(self.ops ; .arch aarch64 ; fdiv D(to), D(from), D(other)),
        }
    }

    fn add_from(&mut self, sum: Register, order: i32, [a, b]: [Place; 2]) {
        let behind = self.ops.new_dynamic_label();
        self.integer(ADDRESS, order.into());
        dynasm!(self.ops ; .arch aarch64 ; cmp x24, X(ADDRESS) ; b.lt =>behind);
        self.load(SCRATCH, Operand::Memory(a));
        self.load(SCRATCH + 1, Operand::Memory(b));
        let (sum, x, y) = (v(sum), v(SCRATCH), v(SCRATCH + 1));
        dynasm!(self.ops ; .arch aarch64
            ; fmul D(x), D(x), D(y)
            ; fadd D(sum), D(sum), D(x)
            ; =>behind);
    }

    /// Loads the address of a place into `to`.
    fn point(&mut self, to: u8, place: Place) {
        let (base, offset) = self.address(place);
        self.add(to, base, offset);
    }

    fn call(&mut self, address: usize) {
        let address = i64::from_ne_bytes((address as u64).to_ne_bytes());
        self.integer(ADDRESS, address);
        dynasm!(self.ops ; .arch aarch64 ; blr X(ADDRESS));
    }
}
