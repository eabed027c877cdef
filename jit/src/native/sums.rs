//! Sums that are taken side by side, two in a vector.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{Block, InstBuilder, Value, types};
use cranelift_frontend::Variable;

use super::function::offset;
use super::layout::{Group, Sum};
use super::series::Body;

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
    pub(super) fn take_sums(&mut self, group: &Group) {
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
    pub(super) fn keep_factors(&mut self, group: &Group) {
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
