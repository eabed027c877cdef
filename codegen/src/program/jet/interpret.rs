//! Computes Taylor coefficients without a compiler, as a reference for emitted code.

use super::{Jet, Recurrence};
use crate::program::interpret::values;
use crate::program::{Function, Guard, Input, Value};

/// Taylor coefficients `0..=order` in `s` of the results of a function, with time `unit * s`. The components of the
/// motion have the coefficients `component(i, k)`. `input` returns the arguments at order 0.
///
/// # Errors
/// The guard that did not hold at order 0.
pub fn along(
    jet: &Jet,
    input: &dyn Fn(Input) -> f64,
    (unit, order): (f64, usize),
    component: &dyn Fn(usize, usize) -> f64,
) -> Result<Vec<Vec<f64>>, Guard> {
    let mut series = Series::start(&jet.function, input)?;
    for k in 1..=order {
        series.advance(jet, k, unit, &|i| component(i, k));
    }
    Ok(series.results(&jet.function))
}

/// Taylor coefficients `0..=order` in `s` of the components of the motion from `state`, then of the gaps, with time
/// `unit * s`. `input` returns the arguments at `state`.
///
/// # Errors
/// The guard that does not hold at `state`.
pub fn motion(
    jet: &Jet,
    input: &dyn Fn(Input) -> f64,
    (unit, order): (f64, usize),
    state: &[f64],
) -> Result<Vec<Vec<f64>>, Guard> {
    let mut series = Series::start(&jet.function, input)?;
    let mut components: Vec<Vec<f64>> = state.iter().map(|&x| vec![x]).collect();
    for k in 0..order {
        if k > 0 {
            series.advance(jet, k, unit, &|i| components[i][k]);
        }
        for (component, output) in components.iter_mut().zip(&jet.function.outputs) {
            component.push(unit * series.at(*output)[k] / (k + 1) as f64);
        }
    }
    series.advance(jet, order, unit, &|i| components[i][order]);
    let gaps = &jet.function.outputs[components.len()..];
    let gaps: Vec<Vec<f64>> = gaps.iter().map(|gap| series.at(*gap).to_vec()).collect();
    components.extend(gaps);
    Ok(components)
}

/// The coefficients of every value.
struct Series(Vec<Vec<f64>>);

impl Series {
    fn start(function: &Function, input: &dyn Fn(Input) -> f64) -> Result<Self, Guard> {
        let first = values(function, input)?;
        Ok(Self(first.into_iter().map(|value| vec![value]).collect()))
    }

    fn at(&self, value: Value) -> &[f64] {
        &self.0[value.index()]
    }

    fn results(&self, function: &Function) -> Vec<Vec<f64>> {
        let outputs = function.outputs.iter();
        outputs.map(|output| self.at(*output).to_vec()).collect()
    }

    fn advance(&mut self, jet: &Jet, k: usize, unit: f64, component: &dyn Fn(usize) -> f64) {
        for (i, recurrence) in jet.recurrences.iter().enumerate() {
            let next = match recurrence {
                Recurrence::Time if k == 1 => unit,
                Recurrence::Constant | Recurrence::Time => 0.0,
                Recurrence::Component(i) => component(*i),
                other => self.next(other, Value::new(i), k),
            };
            self.0[i].push(next);
        }
    }

    /// Coefficient `k` of `value`.
    fn next(&self, recurrence: &Recurrence, value: Value, k: usize) -> f64 {
        let at = |value: &Value, j: usize| self.at(*value)[j];
        let weighted = |value: &Value, j: usize| j as f64 * at(value, j);
        let sum = |from: usize, to: usize, term: &dyn Fn(usize) -> f64| -> f64 {
            (from..=to).map(term).sum()
        };
        let signed = |negative: bool, x: f64| if negative { -x } else { x };
        match recurrence {
            Recurrence::Constant | Recurrence::Time | Recurrence::Component(_) => 0.0,
            Recurrence::Same(a) => at(a, k),
            Recurrence::Neg(a) => -at(a, k),
            Recurrence::Add(a, b) => at(a, k) + at(b, k),
            Recurrence::Sub(a, b) => at(a, k) - at(b, k),
            Recurrence::Scaled(a, b) => at(a, 0) * at(b, k),
            Recurrence::Divided(a, b) => at(a, k) / at(b, 0),
            Recurrence::Product(a, b) => sum(0, k, &|j| at(a, j) * at(b, k - j)),
            Recurrence::Square(a) => sum(0, k, &|j| at(a, j) * at(a, k - j)),
            Recurrence::Quotient(a, b) => {
                let numerator = a.as_ref().map_or(0.0, |a| at(a, k));
                (numerator - sum(1, k, &|j| at(b, j) * at(&value, k - j))) / at(b, 0)
            }
            Recurrence::Root(a) => {
                let known = sum(1, k - 1, &|j| at(&value, j) * at(&value, k - j));
                (at(a, k) - known) / (2.0 * at(&value, 0))
            }
            Recurrence::Power(a, exponent) => {
                let rising = sum(1, k, &|j| weighted(a, j) * at(&value, k - j));
                let known = sum(1, k - 1, &|j| weighted(&value, j) * at(a, k - j));
                (exponent.to_f64() * rising - known) / (k as f64 * at(a, 0))
            }
            Recurrence::Integral { of, by, negative } => {
                let rate = sum(1, k, &|j| weighted(of, j) * at(by, k - j));
                signed(*negative, rate) / k as f64
            }
            Recurrence::IntegralQuotient { of, by, negative } => {
                let known = sum(1, k - 1, &|j| weighted(&value, j) * at(by, k - j));
                (signed(*negative, weighted(of, k)) - known) / (k as f64 * at(by, 0))
            }
            Recurrence::Angle { y, x, squared } => {
                let turn = sum(1, k, &|j| {
                    weighted(y, j) * at(x, k - j) - weighted(x, j) * at(y, k - j)
                });
                let known = sum(1, k - 1, &|j| weighted(&value, j) * at(squared, k - j));
                (turn - known) / (k as f64 * at(squared, 0))
            }
            Recurrence::Absolute(a) => signed(at(a, 0) < 0.0, at(a, k)),
        }
    }
}
