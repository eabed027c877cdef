//! The code of a series: one loop over the orders, as `model!` writes it.
//!
//! Row `k` of the room holds coefficient `k` of what is kept: first what is read one coefficient at a time, then the factors of sums that
//! are taken side by side, two in a vector. Of an expansion that is large each series lies in one piece, and sums are calls.

use std::collections::BTreeMap;

use cranelift_codegen::ir::condcodes::{FloatCC, IntCC};
use cranelift_codegen::ir::{InstBuilder, MemFlagsData, Type, Value, types};
use cranelift_frontend::FunctionBuilder;
use cranelift_module::{FuncId, Module};
use dalembert::numbers::{INVERSES, LENGTH};
use dalembert_codegen::program::Value as Place;
use dalembert_codegen::program::jet::History;
use dalembert_codegen::program::jet::terms::Term;

use super::compiler::Compiler;
use super::function::offset;
use super::layout::{Layout, Sum};
use crate::machine::Constant;
use crate::series::{First, Series, Step};

/// Defines the code of a series: parameters, what is known at first, unit of time, order, coefficients, gaps, room.
pub(super) fn define(compiler: &mut Compiler, series: &Series, layout: &Layout) -> Option<FuncId> {
    compiler.define_with(
        |compiler| {
            let pointer = compiler.pointer();
            let parameters = [
                pointer,
                pointer,
                types::F64,
                types::I64,
                pointer,
                pointer,
                pointer,
            ];
            (parameters.to_vec(), Vec::new())
        },
        |compiler, builder| Body::begin(compiler, builder, series, layout).write(),
    )
}

pub(super) struct Body<'a> {
    pub(super) compiler: &'a mut Compiler,
    pub(super) builder: FunctionBuilder<'a>,
    series: &'a Series,
    pub(super) layout: &'a Layout,
    pointer: Type,
    pub(super) flags: MemFlagsData,
    parameters: Value,
    firsts: Value,
    unit: Value,
    order: Value,
    coefficients: Value,
    gaps: Value,
    pub(super) rows: Value,
    /// The order, in the loop.
    pub(super) k: Value,
    pub(super) weight: Value,
    inverse_order: Value,
    first: BTreeMap<Place, Value>,
    inverse: BTreeMap<Place, Value>,
    next: BTreeMap<Place, Value>,
    pub(super) sums: Vec<(Sum, Value)>,
}

impl<'a> Body<'a> {
    fn begin(
        compiler: &'a mut Compiler,
        mut builder: FunctionBuilder<'a>,
        series: &'a Series,
        layout: &'a Layout,
    ) -> Self {
        let entry = builder.create_block();
        builder.append_block_params_for_function_params(entry);
        builder.switch_to_block(entry);
        let arguments: [Value; 7] = core::array::from_fn(|i| builder.block_params(entry)[i]);
        let [parameters, firsts, unit, order, coefficients, gaps, rows] = arguments;
        Self {
            pointer: compiler.pointer(),
            compiler,
            builder,
            series,
            layout,
            // NOTE: vectors may lie at any multiple of eight bytes.
            flags: MemFlagsData::new().with_notrap(),
            parameters,
            firsts,
            unit,
            order,
            coefficients,
            gaps,
            rows,
            k: order,
            weight: unit,
            inverse_order: unit,
            first: BTreeMap::new(),
            inverse: BTreeMap::new(),
            next: BTreeMap::new(),
            sums: Vec::new(),
        }
    }

    fn write(mut self) {
        let series = self.series;
        self.read_firsts();
        self.keep_firsts();
        let (components, gaps) = (series.components, series.outputs.len() - series.components);
        for i in 0..components {
            let rate = self.load(self.firsts, i);
            let coefficient = self.builder.ins().fmul(self.unit, rate);
            self.store(coefficient, self.coefficients, components + i);
        }
        for i in 0..gaps {
            let gap = self.load(self.firsts, components + i);
            self.store(gap, self.gaps, i);
        }
        // Gaps are taken at the last order too.
        let last = match gaps {
            0 => self.builder.ins().iadd_imm_s(self.order, -1),
            _ => self.order,
        };
        let one = self.builder.ins().iconst(types::I64, 1);
        let [head, body, end] = core::array::from_fn(|_| self.builder.create_block());
        self.k = self.builder.append_block_param(head, types::I64);
        self.builder.ins().jump(head, &[one.into()]);
        self.builder.switch_to_block(head);
        let goes_on = self
            .builder
            .ins()
            .icmp(IntCC::SignedLessThanOrEqual, self.k, last);
        self.builder.ins().brif(goes_on, body, &[], end, &[]);
        self.builder.switch_to_block(body);
        self.write_order(components, gaps);
        let next = self.builder.ins().iadd_imm_s(self.k, 1);
        self.builder.ins().jump(head, &[next.into()]);
        self.builder.switch_to_block(end);
        self.builder.ins().return_(&[]);
        self.builder.seal_all_blocks();
        let target = self.compiler.module.target_config();
        self.builder.finalize(target);
    }

    /// Order `k` of everything.
    fn write_order(&mut self, components: usize, gaps: usize) {
        self.weight = self.builder.ins().fcvt_from_sint(types::F64, self.k);
        let inverses = self.address(INVERSES_OF_ORDERS.as_ptr().addr());
        self.inverse_order = self.load_at(inverses, self.k);
        self.next.clear();
        for group in &self.layout.groups {
            self.take_sums(group);
        }
        let row = self.row(self.coefficients, self.k, components);
        for (value, step) in &self.series.steps {
            let next = match step {
                Step::Component(i) => self.load(row, *i),
                Step::Term(term) => self.value(term),
            };
            self.next.insert(*value, next);
            self.keep_alone(*value, next);
        }
        let outputs = self.series.outputs.iter();
        let next: Vec<Value> = outputs.map(|output| self.next_of(*output)).collect();
        let of_gaps = self.row(self.gaps, self.k, gaps);
        for (i, gap) in next[components..].iter().enumerate() {
            self.store(*gap, of_gaps, i);
        }
        let [further, behind] = core::array::from_fn(|_| self.builder.create_block());
        let is_below = self
            .builder
            .ins()
            .icmp(IntCC::SignedLessThan, self.k, self.order);
        self.builder.ins().brif(is_below, further, &[], behind, &[]);
        self.builder.switch_to_block(further);
        let following = self.builder.ins().iadd_imm_s(self.k, 1);
        let inverse = self.load_at(inverses, following);
        let step = self.builder.ins().fmul(self.unit, inverse);
        for (i, rate) in next[..components].iter().enumerate() {
            let coefficient = self.builder.ins().fmul(step, *rate);
            self.store(coefficient, row, components + i);
        }
        self.builder.ins().jump(behind, &[]);
        self.builder.switch_to_block(behind);
        for group in &self.layout.groups {
            self.keep_factors(group);
        }
    }

    fn address(&mut self, address: usize) -> Value {
        // NOTE: addresses are at most as wide as numbers of this kind.
        let address = i64::from_ne_bytes((address as u64).to_ne_bytes());
        self.builder.ins().iconst(self.pointer, address)
    }

    fn load(&mut self, base: Value, index: usize) -> Value {
        self.builder
            .ins()
            .load(types::F64, self.flags, base, offset(index))
    }

    pub(super) fn store(&mut self, value: Value, base: Value, index: usize) {
        self.builder
            .ins()
            .store(self.flags, value, base, offset(index));
    }

    /// The number of this index behind a pointer.
    fn load_at(&mut self, base: Value, index: Value) -> Value {
        let bytes = self.builder.ins().ishl_imm_s(index, 3);
        let place = self.builder.ins().iadd(base, bytes);
        self.load(place, 0)
    }

    /// Where a row of so many numbers begins.
    pub(super) fn row(&mut self, base: Value, index: Value, width: usize) -> Value {
        let bytes = self
            .builder
            .ins()
            .imul_imm_s(index, i64::from(offset(width)));
        self.builder.ins().iadd(base, bytes)
    }

    /// Order 0 of what is read, and reciprocals.
    fn read_firsts(&mut self) {
        for (_, step) in &self.series.steps {
            if let Step::Term(term) = step {
                self.read(term);
            }
        }
    }

    fn read(&mut self, term: &Term) {
        term.walk(&mut |term| match term {
            Term::First(value) => {
                self.first_of(*value);
            }
            Term::Inverse(value) => {
                let first = self.first_of(*value);
                if !self.inverse.contains_key(value) {
                    let one = self.builder.ins().f64const(1.0);
                    let inverse = self.builder.ins().fdiv(one, first);
                    self.inverse.insert(*value, inverse);
                }
            }
            _ => {}
        });
    }

    fn first_of(&mut self, value: Place) -> Value {
        if let Some(first) = self.first.get(&value) {
            return *first;
        }
        let first = match self.series.firsts[value.index()] {
            First::Unknown => self.builder.ins().f64const(0.0),
            First::Known(place) => self.load(self.firsts, place),
            First::Number(constant) => self.number(constant),
            First::Parameter(k) => self.load(self.parameters, k),
        };
        self.first.insert(value, first);
        first
    }

    fn number(&mut self, constant: Constant) -> Value {
        self.builder.ins().f64const(constant.value::<f64>())
    }

    /// Keeps order 0 of what is read one coefficient at a time.
    fn keep_firsts(&mut self) {
        for (history, place) in &self.layout.alone {
            let first = match history.weighted {
                true => self.builder.ins().f64const(0.0),
                false => self.first_of(history.value),
            };
            let place = self.place(*place);
            self.store(first, self.rows, place);
        }
    }

    /// The index of order 0 of a history that is kept alone.
    fn place(&self, place: usize) -> usize {
        match self.series.is_large {
            true => place * LENGTH,
            false => place,
        }
    }

    /// Where coefficient `order` of what is kept alone lies, but for its place.
    fn order_of_alone(&mut self, order: Value) -> Value {
        let width = match self.series.is_large {
            true => 1,
            false => self.layout.width,
        };
        self.row(self.rows, order, width)
    }

    fn keep_alone(&mut self, value: Place, next: Value) {
        for weighted in [false, true] {
            let history = History { value, weighted };
            let Some(&place) = self.layout.alone.get(&history) else {
                continue;
            };
            let coefficient = match weighted {
                true => self.builder.ins().fmul(self.weight, next),
                false => next,
            };
            let row = self.order_of_alone(self.k);
            let place = self.place(place);
            self.store(coefficient, row, place);
        }
    }

    pub(super) fn next_of(&mut self, value: Place) -> Value {
        match self.next.get(&value) {
            Some(next) => *next,
            // What does not vary.
            None => self.builder.ins().f64const(0.0),
        }
    }

    /// `a b + c`
    pub(super) fn mul_add(&mut self, a: Value, b: Value, c: Value) -> Value {
        // NOTE: as `math::mul_add` does, which is compiled with the same features.
        if cfg!(all(target_feature = "fma", not(feature = "strict"))) {
            return self.builder.ins().fma(a, b, c);
        }
        let product = self.builder.ins().fmul(a, b);
        self.builder.ins().fadd(product, c)
    }

    fn value(&mut self, term: &Term) -> Value {
        match term {
            Term::Zero => self.builder.ins().f64const(0.0),
            Term::Time => {
                let is_first = self.builder.ins().icmp_imm_s(IntCC::Equal, self.k, 1);
                let zero = self.builder.ins().f64const(0.0);
                self.builder.ins().select(is_first, self.unit, zero)
            }
            Term::Number(number) => self.number(Constant::of(number)),
            Term::Order => self.weight,
            Term::InverseOrder => self.inverse_order,
            Term::Next(value) => self.next_of(*value),
            Term::First(value) => self.first_of(*value),
            Term::Inverse(value) => self.inverse[value],
            Term::Neg(a) => {
                let a = self.value(a);
                self.builder.ins().fneg(a)
            }
            Term::Add(operands) => {
                let [a, b] = operands.each_ref().map(|operand| self.value(operand));
                self.builder.ins().fadd(a, b)
            }
            Term::Sub(operands) => {
                let [a, b] = operands.each_ref().map(|operand| self.value(operand));
                self.builder.ins().fsub(a, b)
            }
            Term::Mul(operands) => {
                let [a, b] = operands.each_ref().map(|operand| self.value(operand));
                self.builder.ins().fmul(a, b)
            }
            Term::MulAdd(operands) => {
                let [a, b, c] = operands.each_ref().map(|operand| self.value(operand));
                self.mul_add(a, b, c)
            }
            Term::Turned(operands) => {
                let [a, b] = operands.each_ref().map(|operand| self.value(operand));
                let zero = self.builder.ins().f64const(0.0);
                let is_negative = self.builder.ins().fcmp(FloatCC::LessThan, b, zero);
                let turned = self.builder.ins().fneg(a);
                self.builder.ins().select(is_negative, turned, a)
            }
            Term::Middle(a, b) => self.sum(Sum::Middle(*a, *b)),
            Term::Half(a) => self.sum(Sum::Half(*a)),
            Term::Short(a, b, degree) => self.short([*a, *b], *degree),
            Term::Steady(a, b) => {
                let [a, b] = [a, b].map(|value| self.layout.alone[&History::plain(*value)]);
                let one = self.builder.ins().iconst(types::I64, 1);
                self.product_of_alone([a, b], one)
            }
        }
    }

    fn sum(&mut self, sum: Sum) -> Value {
        if self.series.is_large {
            let [a, b] = sum
                .factors()
                .map(|history| self.place(self.layout.alone[&history]));
            let [a, b] = [a, b].map(|place| {
                self.builder
                    .ins()
                    .iadd_imm_s(self.rows, i64::from(offset(place)))
            });
            return match sum.is_half() {
                true => self.call("jet_half", &[a, self.k]),
                false => self.call("jet_middle", &[a, b, self.k]),
            };
        }
        let found = self.sums.iter().find(|(known, _)| *known == sum);
        match found {
            Some((_, value)) => *value,
            None => self.builder.ins().f64const(f64::NAN),
        }
    }

    fn call(&mut self, name: &'static str, arguments: &[Value]) -> Value {
        let id = self.compiler.helper(name, arguments.len());
        let Some(id) = id else {
            return self.builder.ins().f64const(f64::NAN);
        };
        let function = self
            .compiler
            .module
            .declare_func_in_func(id, self.builder.func);
        let call = self.builder.ins().call(function, arguments);
        self.builder.inst_results(call)[0]
    }

    /// `a_j b_(k-j)` of what is kept alone.
    fn product_of_alone(&mut self, places: [usize; 2], j: Value) -> Value {
        let other = self.builder.ins().isub(self.k, j);
        let rows = [j, other].map(|order| self.order_of_alone(order));
        let places = places.map(|place| self.place(place));
        let [a, b] = core::array::from_fn(|i| self.load(rows[i], places[i]));
        self.builder.ins().fmul(a, b)
    }

    fn short(&mut self, factors: [History; 2], degree: usize) -> Value {
        let places = factors.map(|history| self.layout.alone[&history]);
        let one = self.builder.ins().iconst(types::I64, 1);
        let first = self.product_of_alone(places, one);
        let sum = self.builder.declare_var(types::F64);
        let start = match self.series.is_large {
            // As `jet::shared_short` begins.
            true => {
                let zero = self.builder.ins().f64const(0.0);
                self.builder.ins().fadd(zero, first)
            }
            false => first,
        };
        self.builder.def_var(sum, start);
        for j in 2..=degree {
            let j = self.builder.ins().iconst(types::I64, j as i64);
            let is_within = self
                .builder
                .ins()
                .icmp(IntCC::SignedLessThanOrEqual, j, self.k);
            let [within, behind] = core::array::from_fn(|_| self.builder.create_block());
            self.builder.ins().brif(is_within, within, &[], behind, &[]);
            self.builder.switch_to_block(within);
            let product = self.product_of_alone(places, j);
            let before = self.builder.use_var(sum);
            let added = self.builder.ins().fadd(before, product);
            self.builder.def_var(sum, added);
            self.builder.ins().jump(behind, &[]);
            self.builder.switch_to_block(behind);
        }
        self.builder.use_var(sum)
    }
}

/// Reciprocals where code finds them.
static INVERSES_OF_ORDERS: [f64; LENGTH] = INVERSES;
