//! Series as two pieces of straight-line code: the code before the loop over the orders, and the body of the loop.
//!
//! The kept coefficients of one order are contiguous: those of a history stand once for each sum that it is a factor of.
//! Consecutive orders have a constant distance in memory. The sums of an order are computed in SIMD lanes, before
//! everything else of that order.

use std::collections::BTreeMap;

use dalembert_codegen::program::Value as Place;
use dalembert_codegen::program::jet::History;
use dalembert_codegen::program::jet::terms::Term;

use super::layout::{Group, Layout, Sum, UNIT, WEIGHT};
use super::registers::{self, Allocated};
use super::straight::{self, Base, Binary, Operation, Straight, Unary, Value, bytes};
use crate::machine::Constant;
use crate::series::{First, Series, Step};

/// Pointer arguments of an expansion.
const PARAMETERS: Base = Base::Argument(0);
const FIRSTS: Base = Base::Argument(1);
/// The results at the current order; before the loop, at order 1.
const ROW: Base = Base::Argument(2);
/// The kept coefficients at order 0.
const KEPT: Base = Base::Argument(3);
/// The kept coefficients at the current order.
const NEWEST: Base = Base::Argument(4);

/// An expansion after register allocation.
pub(super) struct Expansion<'a> {
    pub(super) before: Allocated,
    pub(super) order: Allocated,
    pub(super) groups: &'a [Group],
    /// Bytes from one order of results to the next.
    pub(super) row: i32,
    /// Bytes from one order of kept coefficients to the next.
    pub(super) kept: i32,
    /// True if the loop includes the last order, which only outputs other than the components need.
    pub(super) takes_last: bool,
}

impl<'a> Expansion<'a> {
    pub(super) fn of(series: &'a Series, layout: &'a Layout) -> Self {
        let mut before = Body::of(series, layout, layout.frame);
        before.begin();
        let mut order = Body::of(series, layout, before.frame);
        order.inverses = before.inverses;
        order.advance();
        Self {
            before: registers::allocate(&before.straight),
            order: registers::allocate(&order.straight),
            groups: &layout.groups,
            row: bytes(series.outputs.len()),
            kept: bytes(layout.stride),
            takes_last: series.outputs.len() > series.components,
        }
    }

    /// Length of the frame, in numbers.
    pub(super) fn frame(&self) -> usize {
        self.before.frame.max(self.order.frame)
    }
}

struct Body<'a> {
    series: &'a Series,
    layout: &'a Layout,
    straight: Straight,
    /// Number of frame slots that both pieces use.
    frame: usize,
    /// Frame slots of reciprocals.
    inverses: BTreeMap<Place, straight::Place>,
    next: BTreeMap<Place, Value>,
    inverse_order: Option<Value>,
}

impl<'a> Body<'a> {
    fn of(series: &'a Series, layout: &'a Layout, frame: usize) -> Self {
        Self {
            series,
            layout,
            straight: Straight::with_frame(frame),
            frame,
            inverses: BTreeMap::new(),
            next: BTreeMap::new(),
            inverse_order: None,
        }
    }

    /// Stores the unit of time, the reciprocals and the coefficients of order 0, and writes order 1 of the components.
    fn begin(&mut self) {
        let unit = self.straight.push(Operation::Argument);
        self.straight.store(unit, frame(UNIT));
        let series = self.series;
        for (_, step) in &series.steps {
            if let Step::Term(term) = step {
                term.walk(&mut |term| {
                    if let Term::Inverse(value) = term {
                        self.keep_inverse(*value);
                    }
                });
            }
        }
        for history in &self.layout.alone {
            let first = match history.weighted {
                true => self.straight.number(0.0),
                false => self.first(history.value),
            };
            let place = self.layout.places[history][0];
            self.straight.store(first, straight::Place::of(KEPT, place));
        }
        for i in 0..series.components {
            let rate = self.straight.load(straight::Place::of(FIRSTS, i));
            let coefficient = self.straight.mul(unit, rate);
            self.straight
                .store(coefficient, straight::Place::of(ROW, i));
        }
        // NOTE: slots that both pieces use come before those that only one piece uses.
        self.straight.frame = self.frame;
    }

    fn keep_inverse(&mut self, value: Place) {
        if self.inverses.contains_key(&value) {
            return;
        }
        let place = frame(self.frame);
        self.frame += 1;
        let one = self.straight.number(1.0);
        let first = self.first(value);
        let inverse = self.straight.binary(Binary::Div, [one, first]);
        self.straight.store(inverse, place);
        self.inverses.insert(value, place);
    }

    /// Computes the current order of all values, and the next order of the components.
    fn advance(&mut self) {
        let (series, layout) = (self.series, self.layout);
        let weight = self.weight();
        for (value, step) in &series.steps {
            let next = match step {
                Step::Component(i) => self.straight.load(straight::Place::of(ROW, *i)),
                Step::Term(term) => self.value(term),
            };
            self.next.insert(*value, next);
            for weighted in [false, true] {
                let history = History {
                    value: *value,
                    weighted,
                };
                let Some(places) = layout.places.get(&history) else {
                    continue;
                };
                let coefficient = self.coefficient(history);
                for place in places {
                    let place = straight::Place::of(NEWEST, *place);
                    self.straight.store(coefficient, place);
                }
            }
        }
        let outputs = series.outputs.iter();
        let next: Vec<Value> = outputs.map(|output| self.next_of(*output)).collect();
        let (rates, gaps) = next.split_at(series.components);
        for (i, gap) in gaps.iter().enumerate() {
            let place = straight::Place::of(ROW, series.components + i);
            self.straight.store(*gap, place);
        }
        let one = self.straight.number(1.0);
        let following = self.straight.add(weight, one);
        let inverse = self.straight.binary(Binary::Div, [one, following]);
        let unit = self.straight.load(frame(UNIT));
        let step = self.straight.mul(unit, inverse);
        for (i, rate) in rates.iter().enumerate() {
            let coefficient = self.straight.mul(step, *rate);
            let place = straight::Place::of(ROW, next.len() + i);
            self.straight.store(coefficient, place);
        }
    }

    fn coefficient(&mut self, history: History) -> Value {
        let next = self.next_of(history.value);
        match history.weighted {
            true => {
                let weight = self.weight();
                self.straight.mul(weight, next)
            }
            false => next,
        }
    }

    fn weight(&mut self) -> Value {
        self.straight.load(frame(WEIGHT))
    }

    fn inverse_order(&mut self) -> Value {
        if let Some(value) = self.inverse_order {
            return value;
        }
        let operands = [self.straight.number(1.0), self.weight()];
        let value = self.straight.binary(Binary::Div, operands);
        self.inverse_order = Some(value);
        value
    }

    /// The coefficient of order 0 of a value.
    fn first(&mut self, value: Place) -> Value {
        match self.series.firsts[value.index()] {
            First::Unknown => self.straight.number(0.0),
            First::Known(place) => self.straight.load(straight::Place::of(FIRSTS, place)),
            First::Number(constant) => self.straight.number(constant.value::<f64>()),
            First::Parameter(k) => self.straight.load(straight::Place::of(PARAMETERS, k)),
        }
    }

    fn next_of(&mut self, value: Place) -> Value {
        match self.next.get(&value) {
            Some(next) => *next,
            // A constant value: its higher coefficients are 0.
            None => self.straight.number(0.0),
        }
    }

    fn binary(&mut self, binary: Binary, operands: &[Term; 2]) -> Value {
        let operands = operands.each_ref().map(|operand| self.value(operand));
        self.straight.binary(binary, operands)
    }

    fn value(&mut self, term: &Term) -> Value {
        match term {
            Term::Zero => self.straight.number(0.0),
            Term::Time => {
                let unit = self.straight.load(frame(UNIT));
                self.straight.push(Operation::AtFirst(unit))
            }
            Term::Number(number) => {
                let number = Constant::of(number).value::<f64>();
                self.straight.number(number)
            }
            Term::Order => self.weight(),
            Term::InverseOrder => self.inverse_order(),
            Term::Next(value) => self.next_of(*value),
            Term::First(value) => self.first(*value),
            Term::Inverse(value) => self.straight.load(self.inverses[value]),
            Term::Neg(a) => {
                let a = self.value(a);
                self.straight.unary(Unary::Neg, a)
            }
            Term::Add(operands) => self.binary(Binary::Add, operands),
            Term::Sub(operands) => self.binary(Binary::Sub, operands),
            Term::Mul(operands) => self.binary(Binary::Mul, operands),
            Term::MulAdd(operands) => {
                let operands = operands.each_ref().map(|operand| self.value(operand));
                self.mul_add(operands)
            }
            Term::Turned(operands) => {
                let operands = operands.each_ref().map(|operand| self.value(operand));
                self.straight.push(Operation::Turned(operands))
            }
            Term::Middle(a, b) => self.sum(Sum::Middle(*a, *b)),
            Term::Half(a) => self.sum(Sum::Half(*a)),
            Term::Short(a, b, degree) => self.short([*a, *b], *degree),
            Term::Steady(a, b) => {
                let factors = [a, b].map(|value| History::plain(*value));
                let [a, b] = self.factors(factors, 1);
                let [a, b] = [a, b].map(|place| self.straight.load(place));
                self.straight.mul(a, b)
            }
        }
    }

    /// `a b + c`, with the rounding of the runtime: fused or not.
    fn mul_add(&mut self, [a, b, c]: [Value; 3]) -> Value {
        if super::IS_FUSED {
            return self.straight.push(Operation::MulAdd([a, b, c]));
        }
        let product = self.straight.mul(a, b);
        self.straight.add(product, c)
    }

    fn sum(&mut self, sum: Sum) -> Value {
        self.straight.load(frame(self.layout.result(sum)))
    }

    /// The places of `a_j` and `b_(k-j)`.
    fn factors(&self, factors: [History; 2], j: usize) -> [straight::Place; 2] {
        let [a, b] = factors.map(|history| self.layout.places[&history][0]);
        let distance = self.layout.stride * j;
        [
            straight::Place::of(KEPT, a + distance),
            straight::Place::of(NEWEST, b).shifted(-bytes(distance)),
        ]
    }

    fn short(&mut self, histories: [History; 2], degree: usize) -> Value {
        let [a, b] = self.factors(histories, 1);
        let [a, b] = [a, b].map(|place| self.straight.load(place));
        let mut sum = self.straight.mul(a, b);
        for j in 2..=degree {
            let factors = self.factors(histories, j);
            let order = i32::try_from(j).unwrap_or(i32::MAX);
            sum = self.straight.push(Operation::AddFrom {
                order,
                sum,
                factors,
            });
        }
        sum
    }
}

/// A frame slot.
fn frame(index: usize) -> straight::Place {
    straight::Place::of(Base::Frame, index)
}
