//! The code of one function.

use std::collections::{BTreeMap, BTreeSet};

use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::{
    Block, FuncRef, InstBuilder, MemFlagsData, StackSlotData, StackSlotKind, Type, Value, types,
};
use cranelift_frontend::FunctionBuilder;
use cranelift_module::{FuncId, Module};
use dalembert_expr::Function as Elementary;

use super::compiler::Compiler;
use crate::machine::{Code, Constant, Instruction, Place};

/// A function on its way.
pub(super) struct Body<'a> {
    compiler: &'a mut Compiler,
    builder: FunctionBuilder<'a>,
    code: &'a Code,
    pointer: Type,
    flags: MemFlagsData,
    /// Parameters, time, first and second place, values.
    arguments: [Value; 5],
    /// Where velocities lie.
    qdot: Option<Value>,
    registers: Vec<Option<Value>>,
    /// Arguments of which both sine and cosine are taken, and those that were.
    paired: BTreeSet<usize>,
    taken: BTreeMap<Value, [Value; 2]>,
    functions: BTreeMap<&'static str, FuncRef>,
    inputs: BTreeMap<(usize, usize), Value>,
    /// Where the function ends that a guard stops.
    end: Block,
}

impl<'a> Body<'a> {
    pub(super) fn begin(
        compiler: &'a mut Compiler,
        mut builder: FunctionBuilder<'a>,
        code: &'a Code,
    ) -> Self {
        let entry = builder.create_block();
        builder.append_block_params_for_function_params(entry);
        builder.switch_to_block(entry);
        let arguments = core::array::from_fn(|i| builder.block_params(entry)[i]);
        let end = builder.create_block();
        Self {
            pointer: compiler.module.target_config().pointer_type(),
            compiler,
            builder,
            code,
            flags: MemFlagsData::trusted(),
            arguments,
            qdot: None,
            registers: vec![None; code.registers],
            paired: paired(code),
            taken: BTreeMap::new(),
            functions: BTreeMap::new(),
            inputs: BTreeMap::new(),
            end,
        }
    }

    pub(super) fn write(mut self, velocity: Option<FuncId>) {
        if let (Some(id), Some((_, n))) = (velocity, self.code.velocity) {
            self.call_velocity(id, n);
        }
        for (index, (instruction, target)) in self.code.instructions.iter().enumerate() {
            let value = self.value(index, instruction);
            self.registers[*target] = value;
        }
        let values = self.arguments[4];
        for (k, output) in self.code.outputs.iter().enumerate() {
            let value = self.register(*output);
            self.builder
                .ins()
                .store(self.flags, value, values, offset(k));
        }
        let done = self.builder.ins().iconst(types::I32, 0);
        self.builder.ins().return_(&[done]);
        self.builder.switch_to_block(self.end);
        let stopped = self.builder.ins().iconst(types::I32, 1);
        self.builder.ins().return_(&[stopped]);
        self.builder.seal_all_blocks();
        let target = self.compiler.module.target_config();
        self.builder.finalize(target);
    }

    /// Velocities follow from the state first; what stops them stops this.
    fn call_velocity(&mut self, id: FuncId, n: usize) {
        let size = u32::try_from(8 * n).unwrap_or(u32::MAX);
        let data = StackSlotData::new(StackSlotKind::ExplicitSlot, size, 3);
        let slot = self.builder.create_sized_stack_slot(data);
        let qdot = self.builder.ins().stack_addr(self.pointer, slot, 0);
        let function = self
            .compiler
            .module
            .declare_func_in_func(id, self.builder.func);
        let [parameters, t, first, second, _] = self.arguments;
        let call = self
            .builder
            .ins()
            .call(function, &[parameters, t, first, second, qdot]);
        let status = self.builder.inst_results(call)[0];
        let next = self.builder.create_block();
        self.builder.ins().brif(status, self.end, &[], next, &[]);
        self.builder.switch_to_block(next);
        self.qdot = Some(qdot);
    }

    fn register(&mut self, register: usize) -> Value {
        let value = self.registers[register];
        // NOTE: every register is written before it is read.
        value.unwrap_or_else(|| self.builder.ins().f64const(f64::NAN))
    }

    fn number(&mut self, constant: Constant) -> Value {
        let number = match constant {
            Constant::Double(number) => number,
            Constant::Parts(parts) => parts[0],
        };
        self.builder.ins().f64const(number)
    }

    fn input(&mut self, place: Place) -> Value {
        let [parameters, t, first, second, _] = self.arguments;
        let (kind, base, index) = match place {
            Place::Time => return t,
            Place::Parameter(k) => (0, parameters, k),
            Place::First(i) => (1, first, i),
            Place::Second(i) => (2, second, i),
            Place::Velocity(i) => (3, self.qdot.unwrap_or(first), i),
        };
        if let Some(value) = self.inputs.get(&(kind, index)) {
            return *value;
        }
        let value = self
            .builder
            .ins()
            .load(types::F64, self.flags, base, offset(index));
        // NOTE: what is read behind a guard holds only there: blocks follow each other, so that it holds in all that come after.
        self.inputs.insert((kind, index), value);
        value
    }

    /// The value of an instruction; `None` of a guard.
    fn value(&mut self, index: usize, instruction: &Instruction) -> Option<Value> {
        Some(match instruction {
            Instruction::Input(place) => self.input(*place),
            Instruction::Number(constant) => self.number(*constant),
            Instruction::Neg(a) => {
                let a = self.register(*a);
                self.builder.ins().fneg(a)
            }
            Instruction::Add(a, b) => {
                let [a, b] = [*a, *b].map(|register| self.register(register));
                self.builder.ins().fadd(a, b)
            }
            Instruction::Sub(a, b) => {
                let [a, b] = [*a, *b].map(|register| self.register(register));
                self.builder.ins().fsub(a, b)
            }
            Instruction::Mul(a, b) => {
                let [a, b] = [*a, *b].map(|register| self.register(register));
                self.builder.ins().fmul(a, b)
            }
            Instruction::Square(a) => {
                let a = self.register(*a);
                self.builder.ins().fmul(a, a)
            }
            Instruction::Div(a, b) => {
                let [a, b] = [*a, *b].map(|register| self.register(register));
                self.builder.ins().fdiv(a, b)
            }
            Instruction::Sqrt(a) => {
                let a = self.register(*a);
                self.builder.ins().sqrt(a)
            }
            Instruction::Power(a, exponent) => {
                let (a, exponent) = (self.register(*a), self.number(*exponent));
                self.call("powf", &[a, exponent])
            }
            Instruction::Call(Elementary::Abs, a) => {
                let a = self.register(*a);
                self.builder.ins().fabs(a)
            }
            Instruction::Call(function @ (Elementary::Sin | Elementary::Cos), a)
                if self.paired.contains(&index) =>
            {
                let a = self.register(*a);
                let [sine, cosine] = self.sine_and_cosine(a);
                match function {
                    Elementary::Sin => sine,
                    _ => cosine,
                }
            }
            Instruction::Call(function, a) => {
                let a = self.register(*a);
                self.call(function.name(), &[a])
            }
            Instruction::Atan2(y, x) => {
                let [y, x] = [*y, *x].map(|register| self.register(register));
                self.call("atan2", &[y, x])
            }
            Instruction::Guard(condition) => {
                let (value, reference) = condition.bound();
                self.guard(value, reference);
                return None;
            }
        })
    }

    fn guard(&mut self, value: usize, reference: Option<(f64, usize)>) {
        let value = self.register(value);
        let bound = match reference {
            None => self.builder.ins().f64const(0.0),
            Some((ratio, reference)) => {
                let ratio = self.builder.ins().f64const(ratio);
                let reference = self.register(reference);
                self.builder.ins().fmul(ratio, reference)
            }
        };
        let holds = self.builder.ins().fcmp(FloatCC::GreaterThan, value, bound);
        let next = self.builder.create_block();
        self.builder.ins().brif(holds, next, &[], self.end, &[]);
        self.builder.switch_to_block(next);
    }

    fn function(&mut self, name: &'static str, arguments: usize) -> Option<FuncRef> {
        if let Some(function) = self.functions.get(name) {
            return Some(*function);
        }
        let id = self.compiler.helper(name, arguments)?;
        let function = self
            .compiler
            .module
            .declare_func_in_func(id, self.builder.func);
        self.functions.insert(name, function);
        Some(function)
    }

    fn call(&mut self, name: &'static str, arguments: &[Value]) -> Value {
        match self.function(name, arguments.len()) {
            Some(function) => {
                let call = self.builder.ins().call(function, arguments);
                self.builder.inst_results(call)[0]
            }
            None => self.builder.ins().f64const(f64::NAN),
        }
    }

    fn sine_and_cosine(&mut self, a: Value) -> [Value; 2] {
        if let Some(both) = self.taken.get(&a) {
            return *both;
        }
        let data = StackSlotData::new(StackSlotKind::ExplicitSlot, 16, 3);
        let slot = self.builder.create_sized_stack_slot(data);
        let place = self.builder.ins().stack_addr(self.pointer, slot, 0);
        if let Some(function) = self.function("sin_cos", 2) {
            self.builder.ins().call(function, &[a, place]);
        }
        let both = [0, 8].map(|offset| {
            self.builder
                .ins()
                .load(types::F64, self.flags, place, offset)
        });
        self.taken.insert(a, both);
        both
    }
}

/// The distance of a number from the first, in bytes.
pub(super) fn offset(index: usize) -> i32 {
    i32::try_from(8 * index).unwrap_or(i32::MAX)
}

/// The places of sines and cosines whose argument has both taken of it.
fn paired(code: &Code) -> BTreeSet<usize> {
    // The instruction that wrote each register last.
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
