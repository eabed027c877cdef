//! Variations along the motion of a field that has no power series, by extrapolation of the midpoint rule.
//!
//! Reference: E. Hairer, S. Norsett, G. Wanner, *Solving Ordinary Differential Equations I* (1993), section II.9.

use super::flow::{Flow, dual_parameters, dual_state, take_slopes};
use super::held::{Holder, sum};
use super::{DIRECTIONS, Dual, Tangent, Undefined};
use crate::contract::Variational;
use crate::integrate::controller::least_step;
use crate::numbers::Row;
use crate::state::StateVector;

/// Number of combined midpoint rules. They divide a step into 2, 4, 6, .. parts.
const RULES: usize = 8;

/// Index of the first rule that is tested for convergence: earlier rules may agree by accident.
const LEAST: usize = 3;

/// Allowed difference of the last two extrapolated values, relative to the size of the state or of the direction. It is
/// well above the rounding errors of the sums.
const LAST: f64 = 512.0 * f64::EPSILON;

/// Allowed distance between the computed end state and the state of the run, relative to its largest component. The
/// local error of an integrator is smaller at any useful tolerance. The effect of a force that this field does not
/// include is larger.
const KNOWN: f64 = 1e-2;

impl<Sys: Variational> Flow<Sys> {
    /// Propagates some directions along held motion, from the state `start` at the first of two times to the second
    /// time. `end` is the state of the run at the second time.
    pub(super) fn follow_held(
        &mut self,
        system: &Sys,
        holder: Holder,
        [mut t, until]: [f64; 2],
        [start, end]: [&Sys::State; 2],
        tangents: &mut [Tangent<Sys>],
    ) -> Result<(), Undefined> {
        let parameters = dual_parameters(system, tangents);
        let mut state = dual_state(start, tangents);
        let mut length = until - t;
        while t < until {
            let made = length.min(until - t);
            match self.extrapolated(system, &parameters, holder, [t, made], &state) {
                Ok(Some(change)) => {
                    state = sum(&state, &change, 1.0);
                    t = if made >= until - t { until } else { t + made };
                    length = 2.0 * made;
                }
                trial => {
                    length = 0.5 * made;
                    if length < least_step(t) {
                        return Err(trial.err().unwrap_or(Undefined::NotFinite { t }));
                    }
                }
            }
        }
        let size = end
            .as_slice()
            .iter()
            .fold(0.0, |size: f64, component| size.max(component.abs()));
        let mut pairs = state.as_slice().iter().zip(end.as_slice());
        // A difference means that another force acts on the motion.
        if !pairs.all(|(component, end)| (component.value - end).abs() <= KNOWN * size) {
            return Err(holder.undefined(until));
        }
        take_slopes(&state, tangents);
        Ok(())
    }

    /// Change of the state over a step; `None` if the step is too long.
    fn extrapolated(
        &mut self,
        system: &Sys,
        parameters: &Sys::Parameters<Dual>,
        holder: Holder,
        [t, length]: [f64; 2],
        state: &Sys::Row<Dual>,
    ) -> Result<Option<Sys::Row<Dual>>, Undefined> {
        let first = self.rate(system, parameters, holder, t, state)?;
        let mut combined = [first.zeroed(); RULES];
        for rule in 0..RULES {
            let parts = 2 * (rule + 1);
            let h = length / parts as f64;
            let (mut before, mut now) = (first.zeroed(), sum(&first.zeroed(), &first, h));
            for part in 1..parts {
                let there = sum(state, &now, 1.0);
                let rate = self.rate(system, parameters, holder, t + part as f64 * h, &there)?;
                (before, now) = (now, sum(&before, &rate, 2.0 * h));
            }
            // Aitken-Neville scheme in the square of the length of a part.
            for (k, entry) in combined[..rule].iter_mut().enumerate() {
                let ratio = parts as f64 / (2 * (rule - k)) as f64;
                let next = sum(&now, &sum(&now, entry, -1.0), 1.0 / (ratio * ratio - 1.0));
                (*entry, now) = (now, next);
            }
            combined[rule] = now;
            if rule >= LEAST && self.is_near(state, &combined[rule - 1], &now) {
                return Ok(Some(now));
            }
        }
        Ok(None)
    }

    /// True if two changes of a state agree up to [`LAST`], each direction in units of its own size.
    fn is_near(
        &self,
        state: &Sys::Row<Dual>,
        one: &Sys::Row<Dual>,
        other: &Sys::Row<Dual>,
    ) -> bool {
        let mut sizes = [0.0_f64; DIRECTIONS + 1];
        let mut errors = sizes;
        let after = sum(state, other, 1.0);
        let differences = sum(one, other, -1.0);
        let rows = after.as_slice().iter().zip(differences.as_slice());
        for ((after, difference), scale) in rows.zip(self.scale.as_slice()) {
            let lanes = |entry: &Dual| entry.slopes().into_iter().chain([entry.value]);
            let parts = lanes(after).zip(lanes(difference));
            for ((size, error), (after, difference)) in sizes.iter_mut().zip(&mut errors).zip(parts)
            {
                *size = size.max((after / scale).abs());
                // A sum rather than a maximum, which would lose NaN.
                *error += (difference / scale).abs();
            }
        }
        let mut pairs = sizes.iter().zip(&errors);
        pairs.all(|(size, error)| *error <= LAST * size)
    }
}
