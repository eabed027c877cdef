//! Power series over any kind of number, evaluated by the terms of their coefficients.

use std::collections::BTreeMap;
use std::sync::Arc;

use dalembert::Fault;
use dalembert::erased::Expanded;
use dalembert::jet::{self, LENGTH};
use dalembert::kernels::At;
use dalembert::numbers::{Numbers, PI};
use dalembert_codegen::program::jet::terms::Term;
use dalembert_codegen::program::jet::{History, Jet, Recurrence};
use dalembert_codegen::program::{Input, Op, Value};
use dalembert_numbers::numbers::INVERSES;

use crate::machine::{Code, Constant};

/// The series of a motion and of gaps along it.
#[derive(Debug)]
pub(crate) struct Series {
    /// The function that gives order 0.
    pub(crate) begin: Arc<Code>,
    /// Sources of order 0, by value.
    pub(crate) firsts: Vec<First>,
    /// Values that vary, in an order in which they can be computed.
    pub(crate) steps: Vec<(Value, Step)>,
    /// The values of the results.
    pub(crate) outputs: Vec<Value>,
    pub(crate) components: usize,
    /// Indices of the coefficients that are kept.
    pub(crate) histories: BTreeMap<History, usize>,
    /// Number of values that are known at order 0.
    known: usize,
}

/// Source of order 0 of a value.
#[derive(Debug, Clone, Copy)]
pub(crate) enum First {
    /// Nothing reads it.
    Unknown,
    Known(usize),
    Number(Constant),
    Parameter(usize),
}

/// Source of coefficient `k` of a value.
#[derive(Debug)]
pub(crate) enum Step {
    Component(usize),
    Term(Term),
}

/// Coefficients under construction.
struct Course<'a, L> {
    series: &'a Series,
    unit: L,
    k: usize,
    first: Vec<L>,
    inverse: Vec<L>,
    next: Vec<L>,
    kept: Vec<[L; LENGTH]>,
}

impl Series {
    pub(crate) fn of(jet: &Jet, (n, components): (usize, usize)) -> Self {
        let steps = jet.varying().map(|value| {
            let step = match jet.recurrences[value.index()] {
                Recurrence::Component(i) => Step::Component(i),
                _ => Step::Term(jet.term(value)),
            };
            (value, step)
        });
        let steps: Vec<(Value, Step)> = steps.collect();
        let mut histories = Vec::new();
        let mut read = Vec::new();
        for (_, step) in &steps {
            if let Step::Term(term) = step {
                collect(term, &mut read, &mut histories);
            }
        }
        let mut known: Vec<Value> = jet.function.outputs.clone();
        let mut firsts = vec![First::Unknown; jet.recurrences.len()];
        for (place, output) in known.iter().enumerate() {
            firsts[output.index()] = First::Known(place);
        }
        for value in read {
            let first = match &jet.function.ops[value.index()] {
                Op::Number(number) => First::Number(Constant::of(number)),
                Op::Pi => First::Number(Constant::Parts(PI)),
                Op::Input(Input::Parameter(k)) => First::Parameter(*k),
                _ => match firsts[value.index()] {
                    First::Unknown => {
                        known.push(value);
                        First::Known(known.len() - 1)
                    }
                    known => known,
                },
            };
            firsts[value.index()] = first;
        }
        histories.sort_unstable();
        histories.dedup();
        Self {
            begin: Arc::new(Code::of_state(&jet.function, &known, n)),
            firsts,
            steps,
            outputs: jet.function.outputs.clone(),
            components,
            histories: histories
                .into_iter()
                .enumerate()
                .map(|(place, history)| (history, place))
                .collect(),
            known: known.len(),
        }
    }

    /// Number of values that are known at order 0.
    pub(crate) fn known(&self) -> usize {
        self.known
    }

    /// Writes the values that are known at order 0.
    pub(crate) fn begin<L: Numbers>(
        &self,
        parameters: &[L],
        t: L,
        state: &[L],
        firsts: &mut [L],
    ) -> Result<(), Fault> {
        let at = At {
            parameters,
            t,
            first: state,
            second: &[],
        };
        self.begin.run(at, firsts)
    }

    /// Computes the coefficients, order after order.
    pub(crate) fn advance<L: Numbers>(
        &self,
        [parameters, state, firsts]: [&[L]; 3],
        (unit, order): (L, usize),
        take: Expanded<'_, L>,
    ) {
        let order = order.min(LENGTH - 1);
        let (rates, gaps) = firsts[..self.outputs.len()].split_at(self.components);
        take(0, state, gaps);
        if order == 0 {
            return;
        }
        let mut course = Course::begin(self, parameters, firsts, unit);
        let mut coefficients: Vec<L> = rates.iter().map(|rate| unit * *rate).collect();
        let has_gaps = !gaps.is_empty();
        let mut of_gaps = gaps.to_vec();
        for k in 1..=order {
            if k < order || has_gaps {
                course.advance(k, &coefficients);
                for (gap, output) in of_gaps.iter_mut().zip(&self.outputs[self.components..]) {
                    *gap = course.next[output.index()];
                }
            }
            take(k, &coefficients, &of_gaps);
            if k < order {
                let step = unit * L::inverse(k + 1);
                for (coefficient, output) in coefficients.iter_mut().zip(&self.outputs) {
                    *coefficient = step * course.next[output.index()];
                }
            }
        }
    }
}

/// Adds the values at order 0 that a term reads, and the coefficients that are kept for it.
fn collect(term: &Term, read: &mut Vec<Value>, histories: &mut Vec<History>) {
    term.walk(&mut |term| match term {
        Term::First(value) | Term::Inverse(value) => read.push(*value),
        Term::Middle(a, b) => histories.extend([*a, *b]),
        Term::Half(a) => histories.push(History::plain(*a)),
        Term::Short(a, b, _) => {
            histories.extend([*a, *b]);
            read.extend([a.value, b.value]);
        }
        Term::Steady(a, b) => {
            histories.extend([a, b].map(|value| History::plain(*value)));
            read.push(*b);
        }
        _ => {}
    });
}

impl<'a, L: Numbers> Course<'a, L> {
    fn begin(series: &'a Series, parameters: &[L], firsts: &[L], unit: L) -> Self {
        let first: Vec<L> = series
            .firsts
            .iter()
            .map(|first| match *first {
                First::Unknown => L::ZERO,
                First::Known(place) => firsts[place],
                First::Number(constant) => constant.value(),
                First::Parameter(k) => parameters[k],
            })
            .collect();
        let kept = series.histories.keys().map(|history| {
            let mut coefficients = [L::ZERO; LENGTH];
            if !history.weighted {
                coefficients[0] = first[history.value.index()];
            }
            coefficients
        });
        Self {
            series,
            unit,
            k: 0,
            kept: kept.collect(),
            inverse: first.iter().map(|first| L::of(1.0) / *first).collect(),
            next: vec![L::ZERO; first.len()],
            first,
        }
    }

    /// Computes order `k` of all values, given order `k` of the components.
    fn advance(&mut self, k: usize, components: &[L]) {
        self.k = k;
        for (value, step) in &self.series.steps {
            self.next[value.index()] = match step {
                Step::Component(i) => components[*i],
                Step::Term(term) => self.value(term),
            };
            for weighted in [false, true] {
                let history = History {
                    value: *value,
                    weighted,
                };
                if let Some(place) = self.series.histories.get(&history) {
                    self.kept[*place][k] = match weighted {
                        true => L::of(k as f64) * self.next[value.index()],
                        false => self.next[value.index()],
                    };
                }
            }
        }
    }

    fn value(&self, term: &Term) -> L {
        let k = self.k;
        let pair = |operands: &[Term; 2]| operands.each_ref().map(|operand| self.value(operand));
        match term {
            Term::Zero => L::ZERO,
            Term::Time if k == 1 => self.unit,
            Term::Time => L::ZERO,
            Term::Number(number) => Constant::of(number).value(),
            Term::Order => L::of(k as f64),
            Term::InverseOrder => L::inverse(k.min(INVERSES.len() - 1)),
            Term::Next(value) => self.next[value.index()],
            Term::First(value) => self.first[value.index()],
            Term::Inverse(value) => self.inverse[value.index()],
            Term::Neg(a) => -self.value(a),
            Term::Add(operands) => {
                let [a, b] = pair(operands);
                a + b
            }
            Term::Sub(operands) => {
                let [a, b] = pair(operands);
                a - b
            }
            Term::Mul(operands) => {
                let [a, b] = pair(operands);
                a * b
            }
            Term::MulAdd(operands) => {
                let [a, b, c] = operands.each_ref().map(|operand| self.value(operand));
                a.mul_add(b, c)
            }
            Term::Turned(operands) => {
                let [a, b] = pair(operands);
                a.turned(b)
            }
            Term::Middle(a, b) => jet::shared_middle(self.kept(*a), self.kept(*b), k),
            Term::Half(a) => jet::half(self.kept(History::plain(*a)), k),
            Term::Short(a, b, degree) => {
                jet::shared_short(self.kept(*a), self.kept(*b), k, *degree)
            }
            Term::Steady(a, b) => {
                let [a, b] = [a, b].map(|value| self.kept(History::plain(*value)));
                a[1] * b[k - 1]
            }
        }
    }

    fn kept(&self, history: History) -> &[L; LENGTH] {
        &self.kept[self.series.histories[&history]]
    }
}
