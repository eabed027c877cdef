//! Instructions of x86-64 with AVX. Functions have the System V calling convention.

// NOTE: the macro of the assembler converts the numbers of registers.
#![allow(clippy::useless_conversion)]

use std::collections::BTreeMap;
use std::ops::Range;

use dynasmrt::x64::Assembler;
use dynasmrt::{AssemblyOffset, DynamicLabel, DynasmApi, DynasmLabelApi, ExecutableBuffer, dynasm};

use super::layout::{Group, LAST, WEIGHT};
use super::registers::{Allocated, Instruction, Operand, Register, SCRATCH};
use super::series::Expansion;
use super::straight::{Base, Binary, Place, Unary, bytes};

/// A function, or a type of functions, with the calling convention of machine code.
macro_rules! convention {
    (unsafe fn $($function:tt)+) => { unsafe extern "sysv64" fn $($function)+ };
    ($(#[$meta:meta])* fn $($function:tt)+) => { $(#[$meta])* extern "sysv64" fn $($function)+ };
}
pub(super) use convention;

/// Number of doubles in a vector.
pub(super) const LANES: usize = 4;

/// Largest number of vectors of sums in one loop.
pub(super) const SIDE_BY_SIDE: usize = 4;

/// Registers of a loop over sums: vectors of sums come first, then those of the following order, then the latest second
/// factors, then factors. Halves have the last.
const FOLLOWING: Register = SIDE_BY_SIDE as Register;
const LATEST: Register = 2 * FOLLOWING;
const FACTORS: Register = 3 * FOLLOWING;
const HALVES: Register = 15;

/// General registers by their numbers.
const RAX: u8 = 0;
const RCX: u8 = 1;
const RDX: u8 = 2;
const RBX: u8 = 3;
const RSP: u8 = 4;
const RBP: u8 = 5;
const RSI: u8 = 6;
const RDI: u8 = 7;
const R12: u8 = 12;
const R13: u8 = 13;
const R14: u8 = 14;
const R15: u8 = 15;

/// The current order of a series.
const ORDER: u8 = R14;

/// Machine code under construction.
pub(super) struct Assembly {
    ops: Assembler,
    /// The registers of the base pointers of places.
    bases: &'static [u8],
    numbers: BTreeMap<u64, DynamicLabel>,
    sign: DynamicLabel,
    magnitude: DynamicLabel,
    /// Label of the end of the current function after a guard that fails.
    stopped: DynamicLabel,
}

/// Vectors of sums, and the places of their factors.
struct Products {
    vectors: Register,
    /// Places of the first and the second factors, in a row.
    places: [i32; 2],
    /// Bytes from one row to the next.
    kept: i32,
}

impl Products {
    fn place(&self, which: usize, sum: Register) -> i32 {
        self.places[which] + self.of_vector(sum)
    }

    /// Offset of a vector among the vectors of a block.
    fn of_vector(&self, sum: Register) -> i32 {
        bytes(LANES * usize::from(sum))
    }
}

/// Base registers of a function without calls, and of a function with calls.
const OF_LEAF: [u8; 4] = [RDI, RSI, RDX, RCX];
const OF_CALLER: [u8; 4] = [RBX, R12, R13, R14];

/// The bases of a series: parameters, values known at order 0, the row of coefficients, kept rows, the newest of them.
const OF_SERIES: [u8; 5] = [RBX, RBP, R15, R12, R13];

/// An instruction with a target, a register and an operand.
macro_rules! with_operand {
    ($self:ident, $name:ident $to:ident $from:ident $operand:expr) => {
        match $operand {
            Operand::Register(other) => {
                dynasm!($self.ops ; .arch x64 ; $name Rx($to), Rx($from), Rx(other));
            }
            Operand::Memory(place) => {
                let (base, offset) = $self.address(place);
                dynasm!($self.ops ; .arch x64 ; $name Rx($to), Rx($from), QWORD [Rq(base) + offset]);
            }
            Operand::Number(bits) => {
                let label = $self.number(bits);
                dynasm!($self.ops ; .arch x64 ; $name Rx($to), Rx($from), QWORD [=>label]);
            }
        }
    };
}

impl Assembly {
    /// `None` on a processor without AVX, or without memory for the code.
    pub(super) fn new() -> Option<Self> {
        if !std::arch::is_x86_feature_detected!("avx") {
            return None;
        }
        let mut ops = Assembler::new().ok()?;
        let [sign, magnitude, stopped] = core::array::from_fn(|_| ops.new_dynamic_label());
        Some(Self {
            ops,
            bases: &OF_LEAF,
            numbers: BTreeMap::new(),
            sign,
            magnitude,
            stopped,
        })
    }

    /// A function of a pointer, a number and three pointers. It returns 0, or 1 if a guard fails.
    pub(super) fn function(&mut self, code: &Allocated) -> AssemblyOffset {
        let entry = self.ops.offset();
        self.stopped = self.ops.new_dynamic_label();
        let has_calls = code.has_calls();
        self.bases = if has_calls { &OF_CALLER } else { &OF_LEAF };
        let frame = bytes(code.frame.next_multiple_of(2)) + if has_calls { 8 } else { 0 };
        if has_calls {
            dynasm!(self.ops ; .arch x64
                ; push rbx ; push r12 ; push r13 ; push r14
                ; mov rbx, rdi ; mov r12, rsi ; mov r13, rdx ; mov r14, rcx);
        }
        if frame > 0 {
            dynasm!(self.ops ; .arch x64 ; sub rsp, frame);
        }
        self.instructions(&code.instructions);
        for status in [0, 1] {
            if status == 1 {
                dynasm!(self.ops ; .arch x64 ; =>self.stopped);
            }
            dynasm!(self.ops ; .arch x64 ; mov eax, status);
            if frame > 0 {
                dynasm!(self.ops ; .arch x64 ; add rsp, frame);
            }
            if has_calls {
                dynasm!(self.ops ; .arch x64 ; pop r14 ; pop r13 ; pop r12 ; pop rbx);
            }
            dynasm!(self.ops ; .arch x64 ; ret);
        }
        entry
    }

    /// A function of the parameters, the values known at order 0, the unit, the last order, the coefficients from order
    /// 1 on, and memory for kept rows.
    pub(super) fn series(&mut self, expansion: &Expansion<'_>) -> AssemblyOffset {
        let entry = self.ops.offset();
        self.bases = &OF_SERIES;
        let frame = bytes(expansion.frame().next_multiple_of(2) + 1);
        let [last, weight] = [LAST, WEIGHT].map(bytes);
        let [head, end] = core::array::from_fn(|_| self.ops.new_dynamic_label());
        let (row, kept) = (expansion.row, expansion.kept);
        let less = i32::from(!expansion.takes_last);
        dynasm!(self.ops ; .arch x64
            ; push rbx ; push rbp ; push r12 ; push r13 ; push r14 ; push r15
            ; sub rsp, frame
            ; mov rbx, rdi ; mov rbp, rsi ; mov r15, rcx ; mov r12, r8
            ; sub rdx, less
            ; mov [rsp + last], rdx);
        self.instructions(&expansion.before.instructions);
        dynasm!(self.ops ; .arch x64
            ; lea r13, [r12 + kept]
            ; mov r14, 1
            ; =>head
            ; cmp r14, [rsp + last]
            ; jg =>end
            ; vxorpd xmm0, xmm0, xmm0
            ; vcvtsi2sd xmm0, xmm0, r14
            ; vmovsd QWORD [rsp + weight], xmm0);
        for group in expansion.groups {
            self.sums(group, kept);
        }
        self.instructions(&expansion.order.instructions);
        dynasm!(self.ops ; .arch x64
            ; inc r14
            ; add r13, kept
            ; add r15, row
            ; jmp =>head
            ; =>end
            ; vzeroupper
            ; add rsp, frame
            ; pop r15 ; pop r14 ; pop r13 ; pop r12 ; pop rbp ; pop rbx
            ; ret);
        entry
    }

    /// Computes the sums of a group, in the order of additions of `jet::middles` and `jet::halves`.
    fn sums(&mut self, group: &Group, kept: i32) {
        let next = self.ops.new_dynamic_label();
        let products = Products {
            vectors: (group.width() / LANES) as Register,
            places: group.places.map(bytes),
            kept,
        };
        let place = bytes(group.results);
        dynasm!(self.ops ; .arch x64
            ; mov rsi, r12
            ; mov rdi, r13
            ; lea r8, [rsp + place]
            ; mov r9, i32::try_from(group.blocks.len()).unwrap_or(i32::MAX)
            ; =>next);
        match group.following {
            None => self.half_block(&products),
            Some(following) => self.block(&products, bytes(following - group.results)),
        }
        for sum in 0..products.vectors {
            let place = products.of_vector(sum);
            dynasm!(self.ops ; .arch x64 ; vmovupd YWORD [r8 + place], Ry(sum));
        }
        if group.blocks.len() > 1 {
            let [in_row, in_frame] = group.distances().map(bytes);
            dynasm!(self.ops ; .arch x64
                ; add rsi, in_row
                ; add rdi, in_row
                ; add r8, in_frame
                ; dec r9
                ; jnz =>next);
        }
    }

    fn half_block(&mut self, products: &Products) {
        let done = self.ops.new_dynamic_label();
        self.clear(0..products.vectors);
        dynasm!(self.ops ; .arch x64 ; cmp Rq(ORDER), 2 ; jl =>done);
        self.halves(products, done);
        dynasm!(self.ops ; .arch x64 ; =>done);
    }

    /// At even orders, adds the products of this order and those of the following order that are known; at odd orders,
    /// those that were missing.
    fn block(&mut self, products: &Products, following: i32) {
        let vectors = products.vectors;
        let [odd, done] = core::array::from_fn(|_| self.ops.new_dynamic_label());
        self.clear(0..vectors);
        dynasm!(self.ops ; .arch x64 ; test Rq(ORDER), 1 ; jnz =>odd);
        self.clear(FOLLOWING..FOLLOWING + vectors);
        self.middles(products);
        for sum in 0..vectors {
            let place = following + products.of_vector(sum);
            dynasm!(self.ops ; .arch x64 ; vmovupd YWORD [r8 + place], Ry(FOLLOWING + sum));
        }
        dynasm!(self.ops ; .arch x64 ; jmp =>done ; =>odd ; cmp Rq(ORDER), 2 ; jl =>done);
        for sum in 0..vectors {
            let place = following + products.of_vector(sum);
            dynasm!(self.ops ; .arch x64 ; vmovupd Ry(sum), YWORD [r8 + place]);
        }
        self.add_ends(products);
        self.add_products(products, [RCX, RAX]);
        dynasm!(self.ops ; .arch x64 ; =>done);
    }

    fn clear(&mut self, registers: Range<Register>) {
        for register in registers {
            dynasm!(self.ops ; .arch x64 ; vxorpd Ry(register), Ry(register), Ry(register));
        }
    }

    /// Adds the products of an even order, and those of the following order without its ends.
    ///
    /// The products `a_j b_(k-j)` and `a_j b_(k+1-j)` have the first factor in common, and the second factor of the latter
    /// is that of the former for `j - 1`. So two rows are read for two products.
    fn middles(&mut self, products: &Products) {
        let kept = products.kept;
        let [head, end, done] = core::array::from_fn(|_| self.ops.new_dynamic_label());
        dynasm!(self.ops ; .arch x64
            ; lea rax, [rsi + 2 * kept]
            ; lea rcx, [rdi - kept]
            ; lea rdx, [Rq(ORDER) - 3]
            ; test rdx, rdx
            ; jle =>end);
        for sum in 0..products.vectors {
            let y = products.place(1, sum);
            dynasm!(self.ops ; .arch x64 ; vmovupd Ry(LATEST + sum), YWORD [rcx + y]);
        }
        dynasm!(self.ops ; .arch x64 ; =>head ; sub rcx, kept);
        for sum in 0..products.vectors {
            let [x, y] = [0, 1].map(|which| products.place(which, sum));
            let factor = FACTORS + 2 * (sum % 2);
            dynasm!(self.ops ; .arch x64 ; vmovupd Ry(factor), YWORD [rax + x]);
            self.add_product(FOLLOWING + sum, [factor, LATEST + sum], factor + 1);
            dynasm!(self.ops ; .arch x64 ; vmovupd Ry(LATEST + sum), YWORD [rcx + y]);
            self.add_product(sum, [LATEST + sum, factor], factor);
        }
        dynasm!(self.ops ; .arch x64 ; add rax, kept ; dec rdx ; jnz =>head);
        for sum in 0..products.vectors {
            let x = products.place(0, sum);
            let factor = FACTORS + 2 * (sum % 2);
            dynasm!(self.ops ; .arch x64 ; vmovupd Ry(factor), YWORD [rax + x]);
            self.add_product(FOLLOWING + sum, [factor, LATEST + sum], factor);
        }
        dynasm!(self.ops ; .arch x64 ; =>end);
        self.add_ends(products);
        dynasm!(self.ops ; .arch x64 ; cmp Rq(ORDER), 2 ; jle =>done);
        self.add_products(products, [RCX, RAX]);
        dynasm!(self.ops ; .arch x64 ; =>done);
    }

    /// Adds a product to a register. `scratch` may be one of the factors.
    fn add_product(&mut self, sum: Register, [x, y]: [Register; 2], scratch: Register) {
        if super::IS_FUSED {
            dynasm!(self.ops ; .arch x64 ; vfmadd231pd Ry(sum), Ry(x), Ry(y));
        } else {
            dynasm!(self.ops ; .arch x64
                ; vmulpd Ry(scratch), Ry(x), Ry(y)
                ; vaddpd Ry(sum), Ry(sum), Ry(scratch));
        }
    }

    fn halves(&mut self, products: &Products, done: DynamicLabel) {
        let kept = products.kept;
        let odd = self.ops.new_dynamic_label();
        let half = self.number(0.5_f64.to_bits());
        dynasm!(self.ops ; .arch x64
            ; test Rq(ORDER), 1
            ; jnz =>odd
            ; mov rax, Rq(ORDER)
            ; shr rax, 1
            ; imul rax, rax, kept
            ; add rax, rsi
            ; vbroadcastsd Ry(HALVES), QWORD [=>half]);
        for sum in 0..products.vectors {
            let place = products.place(0, sum);
            dynasm!(self.ops ; .arch x64
                ; vmovupd Ry(FACTORS), YWORD [rax + place]
                ; vmulpd Ry(sum), Ry(HALVES), Ry(FACTORS)
                ; vmulpd Ry(sum), Ry(sum), Ry(FACTORS));
        }
        dynasm!(self.ops ; .arch x64
            ; =>odd
            ; cmp Rq(ORDER), 2
            ; jle =>done
            ; lea rdx, [Rq(ORDER) - 1]
            ; shr rdx, 1
            ; imul rax, rdx, kept
            ; mov rcx, rdi
            ; sub rcx, rax
            ; add rax, rsi
            ; dec rdx);
        self.add_range(products, -kept);
        self.add_ends(products);
    }

    /// Adds `rdx` products of the rows at `rax` and `rcx`. The rows move towards each other or apart.
    fn add_range(&mut self, products: &Products, step: i32) {
        let [head, end] = core::array::from_fn(|_| self.ops.new_dynamic_label());
        dynasm!(self.ops ; .arch x64 ; test rdx, rdx ; jle =>end ; =>head);
        self.add_products(products, [RAX, RCX]);
        dynasm!(self.ops ; .arch x64
            ; add rax, step
            ; sub rcx, step
            ; dec rdx
            ; jnz =>head
            ; =>end);
    }

    /// Adds the products of order 1 and the newest order. Afterwards `rax` and `rcx` point to their rows.
    fn add_ends(&mut self, products: &Products) {
        let kept = products.kept;
        dynasm!(self.ops ; .arch x64 ; lea rax, [rsi + kept] ; lea rcx, [rdi - kept]);
        self.add_products(products, [RAX, RCX]);
    }

    /// Adds the products of the first factors of one row and the second factors of another.
    fn add_products(&mut self, products: &Products, [a, b]: [u8; 2]) {
        for sum in 0..products.vectors {
            // NOTE: a few registers are used in turn, so that products of one pass do not wait for each other.
            let factor = FACTORS + sum % (HALVES - FACTORS);
            let [x, y] = [0, 1].map(|which| products.place(which, sum));
            dynasm!(self.ops ; .arch x64 ; vmovupd Ry(factor), YWORD [Rq(a) + x]);
            if super::IS_FUSED {
                dynasm!(self.ops ; .arch x64 ; vfmadd231pd Ry(sum), Ry(factor), YWORD [Rq(b) + y]);
            } else {
                dynasm!(self.ops ; .arch x64
                    ; vmulpd Ry(factor), Ry(factor), YWORD [Rq(b) + y]
                    ; vaddpd Ry(sum), Ry(sum), Ry(factor));
            }
        }
    }

    /// The executable code of all functions.
    pub(super) fn finish(mut self) -> Option<ExecutableBuffer> {
        for (bits, label) in core::mem::take(&mut self.numbers) {
            let bits = i64::from_ne_bytes(bits.to_ne_bytes());
            dynasm!(self.ops ; .arch x64 ; .align 8 ; =>label ; .i64 bits);
        }
        dynasm!(self.ops ; .arch x64
            ; .align 16 ; =>self.sign ; .i64 i64::MIN ; .i64 i64::MIN
            ; =>self.magnitude ; .i64 i64::MAX ; .i64 i64::MAX);
        self.ops.finalize().ok()
    }

    /// The base register and the offset of a place.
    fn address(&self, place: Place) -> (u8, i32) {
        match place.base {
            Base::Frame => (RSP, place.offset),
            Base::Argument(index) => (self.bases[usize::from(index)], place.offset),
        }
    }

    fn number(&mut self, bits: u64) -> DynamicLabel {
        let ops = &mut self.ops;
        *self
            .numbers
            .entry(bits)
            .or_insert_with(|| ops.new_dynamic_label())
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
                let (base, offset) = self.address(place);
                dynasm!(self.ops ; .arch x64 ; vmovsd QWORD [Rq(base) + offset], Rx(from));
            }
            Instruction::Unary(unary, to, from) => self.unary(unary, to, from),
            Instruction::Binary(binary, to, from, operand) => match binary {
                Binary::Add => with_operand!(self, vaddsd to from operand),
                Binary::Sub => with_operand!(self, vsubsd to from operand),
                Binary::Mul => with_operand!(self, vmulsd to from operand),
                Binary::Div => with_operand!(self, vdivsd to from operand),
            },
            Instruction::MulAdd(sum, from, operand) => {
                with_operand!(self, vfmadd231sd sum from operand);
            }
            Instruction::Turned(to, [from, by]) => {
                dynasm!(self.ops ; .arch x64
                    ; vxorpd Rx(SCRATCH), Rx(SCRATCH), Rx(SCRATCH)
                    ; vcmpltsd Rx(SCRATCH), Rx(by), Rx(SCRATCH)
                    ; vandpd Rx(SCRATCH), Rx(SCRATCH), OWORD [=>self.sign]
                    ; vxorpd Rx(to), Rx(from), Rx(SCRATCH));
            }
            Instruction::AtFirst(to, from) => {
                let behind = self.ops.new_dynamic_label();
                dynasm!(self.ops ; .arch x64
                    ; vxorpd Rx(to), Rx(to), Rx(to)
                    ; cmp Rq(ORDER), 1
                    ; jne =>behind);
                self.load(to, from);
                dynasm!(self.ops ; .arch x64 ; =>behind);
            }
            Instruction::AddFrom(sum, order, factors) => self.add_from(sum, order, factors),
            Instruction::Call(address, place) => {
                if let Some(place) = place {
                    let (base, offset) = self.address(place);
                    dynasm!(self.ops ; .arch x64 ; lea Rq(RDI), [Rq(base) + offset]);
                }
                self.call(address);
            }
            Instruction::Guard(from, bound) => self.guard(from, bound),
        }
    }

    fn load(&mut self, to: Register, from: Operand) {
        match from {
            Operand::Register(from) if from == to => {}
            Operand::Register(from) => {
                dynasm!(self.ops ; .arch x64 ; vmovapd Rx(to), Rx(from));
            }
            Operand::Memory(place) => {
                let (base, offset) = self.address(place);
                dynasm!(self.ops ; .arch x64 ; vmovsd Rx(to), QWORD [Rq(base) + offset]);
            }
            Operand::Number(bits) => {
                let label = self.number(bits);
                dynasm!(self.ops ; .arch x64 ; vmovsd Rx(to), QWORD [=>label]);
            }
        }
    }

    fn unary(&mut self, unary: Unary, to: Register, from: Register) {
        match unary {
            Unary::Neg => {
                dynasm!(self.ops ; .arch x64 ; vxorpd Rx(to), Rx(from), OWORD [=>self.sign]);
            }
            Unary::Abs => {
                dynasm!(self.ops ; .arch x64 ; vandpd Rx(to), Rx(from), OWORD [=>self.magnitude]);
            }
            Unary::Sqrt => dynasm!(self.ops ; .arch x64 ; vsqrtsd Rx(to), Rx(from), Rx(from)),
        }
    }

    fn add_from(&mut self, sum: Register, order: i32, [a, b]: [Place; 2]) {
        let behind = self.ops.new_dynamic_label();
        let (base, offset) = self.address(b);
        dynasm!(self.ops ; .arch x64 ; cmp Rq(ORDER), order ; jl =>behind);
        self.load(SCRATCH, Operand::Memory(a));
        dynasm!(self.ops ; .arch x64
            ; vmulsd Rx(SCRATCH), Rx(SCRATCH), QWORD [Rq(base) + offset]
            ; vaddsd Rx(sum), Rx(sum), Rx(SCRATCH)
            ; =>behind);
    }

    fn guard(&mut self, from: Register, bound: Operand) {
        match bound {
            Operand::Register(bound) => {
                dynasm!(self.ops ; .arch x64 ; vucomisd Rx(from), Rx(bound));
            }
            Operand::Memory(place) => {
                let (base, offset) = self.address(place);
                dynasm!(self.ops ; .arch x64 ; vucomisd Rx(from), QWORD [Rq(base) + offset]);
            }
            Operand::Number(bits) => {
                let label = self.number(bits);
                dynasm!(self.ops ; .arch x64 ; vucomisd Rx(from), QWORD [=>label]);
            }
        }
        // NOTE: with NaN the comparison sets the flags of "below or equal", so the guard fails.
        dynasm!(self.ops ; .arch x64 ; jbe =>self.stopped);
    }

    fn call(&mut self, address: usize) {
        let address = i64::from_ne_bytes((address as u64).to_ne_bytes());
        dynasm!(self.ops ; .arch x64 ; mov rax, QWORD address ; call rax);
    }
}
