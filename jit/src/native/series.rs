//! The code of a series: one loop over the orders, as `model!` writes it.
//!
//! Row `k` of the room holds coefficient `k` of what is kept: first what is read one coefficient at a time, then the factors of sums that
//! are taken side by side, two in a vector. Of an expansion that is large each series lies in one piece, and sums are calls.

use std::collections::BTreeMap;

use cranelift_codegen::ir::condcodes::{FloatCC, IntCC};
use cranelift_codegen::ir::{Block, InstBuilder, MemFlagsData, Type, Value, types};
use cranelift_frontend::{FunctionBuilder, Variable};
use cranelift_module::{FuncId, Module};
use dalembert::numbers::{INVERSES, LENGTH};
use dalembert_codegen::program::Value as Place;
use dalembert_codegen::program::jet::History;
use dalembert_codegen::program::jet::terms::Term;

use super::compiler::Compiler;
use super::function::offset;
use crate::machine::Constant;
use crate::series::{First, Series, Step};

/// Vectors of sums that one loop takes.
const SIDE_BY_SIDE: usize = 8;

/// Where coefficients are kept.
#[derive(Debug)]
pub(super) struct Layout {
    /// Histories that are read one coefficient at a time, and their places in a row; of a large expansion all of them.
    alone: BTreeMap<History, usize>,
    groups: Vec<Group>,
    /// Places of a row.
    width: usize,
}

/// Sums that are taken together.
#[derive(Debug)]
struct Group {
    sums: Vec<Sum>,
    /// Where the first factors lie in a row, and the second ones; of halves both are the same.
    places: [usize; 2],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sum {
    Half(Place),
    Middle(History, History),
}

impl Sum {
    fn factors(self) -> [History; 2] {
        match self {
            Self::Half(a) => [History::plain(a); 2],
            Self::Middle(a, b) => [a, b],
        }
    }

    fn is_half(self) -> bool {
        matches!(self, Self::Half(_))
    }
}

impl Layout {
    pub(super) fn of(series: &Series) -> Self {
        if series.is_large {
            return Self {
                alone: series.histories.clone(),
                groups: Vec::new(),
                width: 0,
            };
        }
        let mut alone = BTreeMap::new();
        let mut sums: Vec<Sum> = Vec::new();
        for (_, step) in &series.steps {
            if let Step::Term(term) = step {
                visit(term, &mut sums, &mut alone);
            }
        }
        let mut width = alone.len().next_multiple_of(2);
        let mut groups = Vec::new();
        for is_half in [true, false] {
            let kind: Vec<Sum> = sums
                .iter()
                .copied()
                .filter(|sum| sum.is_half() == is_half)
                .collect();
            for sums in kind.chunks(2 * SIDE_BY_SIDE) {
                let count = sums.len().next_multiple_of(2);
                let second = if is_half { width } else { width + count };
                groups.push(Group {
                    sums: sums.to_vec(),
                    places: [width, second],
                });
                width = second + count;
            }
        }
        Self {
            alone,
            groups,
            width,
        }
    }

    /// Numbers of the room.
    pub(super) fn room(&self) -> usize {
        match self.width {
            0 => self.alone.len() * LENGTH,
            width => width * LENGTH,
        }
    }
}

fn visit(term: &Term, sums: &mut Vec<Sum>, alone: &mut BTreeMap<History, usize>) {
    let mut keep = |history: History| {
        let place = alone.len();
        alone.entry(history).or_insert(place);
    };
    match term {
        Term::Neg(a) => visit(a, sums, alone),
        Term::Add(operands)
        | Term::Sub(operands)
        | Term::Mul(operands)
        | Term::Turned(operands) => {
            operands
                .iter()
                .for_each(|operand| visit(operand, sums, alone));
        }
        Term::MulAdd(operands) => operands
            .iter()
            .for_each(|operand| visit(operand, sums, alone)),
        Term::Middle(a, b) if !sums.contains(&Sum::Middle(*a, *b)) => {
            sums.push(Sum::Middle(*a, *b));
        }
        Term::Half(a) if !sums.contains(&Sum::Half(*a)) => sums.push(Sum::Half(*a)),
        Term::Short(a, b, _) => {
            keep(*a);
            keep(*b);
        }
        Term::Steady(a, b) => {
            keep(History::plain(*a));
            keep(History::plain(*b));
        }
        _ => {}
    }
}

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

struct Body<'a> {
    compiler: &'a mut Compiler,
    builder: FunctionBuilder<'a>,
    series: &'a Series,
    layout: &'a Layout,
    pointer: Type,
    flags: MemFlagsData,
    parameters: Value,
    firsts: Value,
    unit: Value,
    order: Value,
    coefficients: Value,
    gaps: Value,
    rows: Value,
    /// The order, in the loop.
    k: Value,
    weight: Value,
    inverse_order: Value,
    first: BTreeMap<Place, Value>,
    inverse: BTreeMap<Place, Value>,
    next: BTreeMap<Place, Value>,
    sums: Vec<(Sum, Value)>,
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

    fn store(&mut self, value: Value, base: Value, index: usize) {
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
    fn row(&mut self, base: Value, index: Value, width: usize) -> Value {
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
        match term {
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
            Term::Neg(a) => self.read(a),
            Term::Add(operands)
            | Term::Sub(operands)
            | Term::Mul(operands)
            | Term::Turned(operands) => {
                operands.iter().for_each(|operand| self.read(operand));
            }
            Term::MulAdd(operands) => operands.iter().for_each(|operand| self.read(operand)),
            _ => {}
        }
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

    fn next_of(&mut self, value: Place) -> Value {
        match self.next.get(&value) {
            Some(next) => *next,
            // What does not vary.
            None => self.builder.ins().f64const(0.0),
        }
    }

    /// `a b + c`
    fn mul_add(&mut self, a: Value, b: Value, c: Value) -> Value {
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

/// Sums that are taken side by side.
impl Body<'_> {
    /// Vector `i` of factors in a row.
    fn factors(&mut self, row: Value, place: usize, i: usize) -> Value {
        self.builder
            .ins()
            .load(types::F64X2, self.flags, row, offset(place + 2 * i))
    }

    fn branch(&mut self, condition: Value) -> [Block; 2] {
        let [then, otherwise] = core::array::from_fn(|_| self.builder.create_block());
        self.builder
            .ins()
            .brif(condition, then, &[], otherwise, &[]);
        self.builder.switch_to_block(then);
        [then, otherwise]
    }

    /// Takes the sums of a group at order `k`, in the order of additions of `jet::middles` and `jet::halves`.
    fn take_sums(&mut self, group: &Group) {
        let vectors = group.sums.len().div_ceil(2);
        let zero = self.builder.ins().f64const(0.0);
        let zeros = self.builder.ins().splat(types::F64X2, zero);
        let sums: Vec<Variable> = (0..vectors)
            .map(|_| {
                let sum = self.builder.declare_var(types::F64X2);
                self.builder.def_var(sum, zeros);
                sum
            })
            .collect();
        let has_terms = self
            .builder
            .ins()
            .icmp_imm_s(IntCC::SignedGreaterThanOrEqual, self.k, 2);
        let [_, behind] = self.branch(has_terms);
        if group.sums[0].is_half() {
            self.take_halves(group, &sums, behind);
        } else {
            self.take_middles(group, &sums, behind);
        }
        self.builder.switch_to_block(behind);
        for (i, sum) in group.sums.iter().enumerate() {
            let vector = self.builder.use_var(sums[i / 2]);
            let lane = u8::from(i % 2 == 1);
            let value = self.builder.ins().extractlane(vector, lane);
            self.set_sum(*sum, value);
        }
    }

    fn set_sum(&mut self, sum: Sum, value: Value) {
        match self.sums.iter_mut().find(|(known, _)| *known == sum) {
            Some((_, known)) => *known = value,
            None => self.sums.push((sum, value)),
        }
    }

    /// Adds the products of row `a` and row `b`.
    fn add_products(&mut self, group: &Group, sums: &[Variable], [a, b]: [Value; 2]) {
        for (i, &sum) in sums.iter().enumerate() {
            let x = self.factors(a, group.places[0], i);
            let y = self.factors(b, group.places[1], i);
            let before = self.builder.use_var(sum);
            let after = self.mul_add(x, y, before);
            self.builder.def_var(sum, after);
        }
    }

    /// A loop over `j` from a number on, up or down, while it is not past another.
    fn add_range(&mut self, group: &Group, sums: &[Variable], (from, to, by): (Value, Value, i64)) {
        let width = self.layout.width;
        let [head, body, end] = core::array::from_fn(|_| self.builder.create_block());
        let j = self.builder.append_block_param(head, types::I64);
        self.builder.ins().jump(head, &[from.into()]);
        self.builder.switch_to_block(head);
        let within = match by > 0 {
            true => IntCC::SignedLessThanOrEqual,
            false => IntCC::SignedGreaterThanOrEqual,
        };
        let goes_on = self.builder.ins().icmp(within, j, to);
        self.builder.ins().brif(goes_on, body, &[], end, &[]);
        self.builder.switch_to_block(body);
        let other = self.builder.ins().isub(self.k, j);
        let rows = [j, other].map(|order| self.row(self.rows, order, width));
        self.add_products(group, sums, rows);
        let next = self.builder.ins().iadd_imm_s(j, by);
        self.builder.ins().jump(head, &[next.into()]);
        self.builder.switch_to_block(end);
    }

    /// The first row and the newest.
    fn ends(&mut self) -> [Value; 2] {
        let width = self.layout.width;
        let one = self.builder.ins().iconst(types::I64, 1);
        let newest = self.builder.ins().iadd_imm_s(self.k, -1);
        [one, newest].map(|order| self.row(self.rows, order, width))
    }

    fn take_middles(&mut self, group: &Group, sums: &[Variable], behind: Block) {
        let two = self.builder.ins().iconst(types::I64, 2);
        let to = self.builder.ins().iadd_imm_s(self.k, -2);
        self.add_range(group, sums, (two, to, 1));
        let [first, newest] = self.ends();
        self.add_products(group, sums, [first, newest]);
        let are_two = self
            .builder
            .ins()
            .icmp_imm_s(IntCC::SignedGreaterThan, self.k, 2);
        let [_, otherwise] = self.branch(are_two);
        self.add_products(group, sums, [newest, first]);
        self.builder.ins().jump(otherwise, &[]);
        self.builder.switch_to_block(otherwise);
        self.builder.ins().jump(behind, &[]);
    }

    fn take_halves(&mut self, group: &Group, sums: &[Variable], behind: Block) {
        let odd = self.builder.ins().band_imm_s(self.k, 1);
        let is_even = self.builder.ins().icmp_imm_s(IntCC::Equal, odd, 0);
        let [_, otherwise] = self.branch(is_even);
        let middle = self.builder.ins().sshr_imm_s(self.k, 1);
        let centre = self.row(self.rows, middle, self.layout.width);
        let half = self.builder.ins().f64const(0.5);
        let half = self.builder.ins().splat(types::F64X2, half);
        for (i, &sum) in sums.iter().enumerate() {
            let factors = self.factors(centre, group.places[0], i);
            let halved = self.builder.ins().fmul(half, factors);
            let square = self.builder.ins().fmul(halved, factors);
            self.builder.def_var(sum, square);
        }
        self.builder.ins().jump(otherwise, &[]);
        self.builder.switch_to_block(otherwise);
        let are_pairs = self
            .builder
            .ins()
            .icmp_imm_s(IntCC::SignedGreaterThan, self.k, 2);
        let [_, none] = self.branch(are_pairs);
        let below = self.builder.ins().iadd_imm_s(self.k, -1);
        let pairs = self.builder.ins().sshr_imm_s(below, 1);
        let two = self.builder.ins().iconst(types::I64, 2);
        self.add_range(group, sums, (pairs, two, -1));
        let ends = self.ends();
        self.add_products(group, sums, ends);
        self.builder.ins().jump(none, &[]);
        self.builder.switch_to_block(none);
        self.builder.ins().jump(behind, &[]);
    }

    /// Keeps coefficient `k` of the factors of a group.
    fn keep_factors(&mut self, group: &Group) {
        let row = self.row(self.rows, self.k, self.layout.width);
        let count = if group.sums[0].is_half() { 1 } else { 2 };
        for factor in 0..count {
            for (i, pair) in group.sums.chunks(2).enumerate() {
                let mut vector = None;
                for (lane, sum) in pair.iter().enumerate() {
                    let history = sum.factors()[factor];
                    let next = self.next_of(history.value);
                    let coefficient = match history.weighted {
                        true => self.builder.ins().fmul(self.weight, next),
                        false => next,
                    };
                    vector = Some(match vector {
                        None => self.builder.ins().splat(types::F64X2, coefficient),
                        Some(first) => {
                            let lane = u8::from(lane == 1);
                            self.builder.ins().insertlane(first, coefficient, lane)
                        }
                    });
                }
                if let Some(vector) = vector {
                    self.store(vector, row, group.places[factor] + 2 * i);
                }
            }
        }
    }
}
