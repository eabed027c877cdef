//! Variations along a field without power series: extrapolation of the midpoint rule.
//!
//! Reference: E. Hairer, S. Norsett, G. Wanner, *Solving Ordinary Differential Equations I* (1993), section II.9.

use super::flow::{Flow, dual_parameters, dual_state, take_slopes};
use super::held::{Holder, sum};
use super::{DIRECTIONS, Dual, Tangent, Undefined};
use crate::contract::Variational;
use crate::integrate::controller::least_step;
use crate::numbers::Row;
use crate::state::StateVector;

/// Midpoint rules of 2, 4, 6, .. parts that are combined.
const RULES: usize = 8;

/// Rules before this one are not asked whether they agree: they may by accident.
const LEAST: usize = 3;

/// What the last two combinations may differ by, in units of what varies: well above the rounding errors of the sums.
const LAST: f64 = 512.0 * f64::EPSILON;

/// How far the end of a stretch may be from where the run has come, in units of its largest component: what an integrator errs
/// by in a step is smaller at any useful tolerance, what a force that is not known does is not.
const KNOWN: f64 = 1e-2;

impl<Sys: Variational> Flow<Sys> {
    /// Carries some directions along held motion, from a state at the first of two times to the other, where it is `end`.
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
            .fold(0.0, |size: f64, own| size.max(own.abs()));
        let mut pairs = state.as_slice().iter().zip(end.as_slice());
        // Something else holds it as well.
        if !pairs.all(|(own, end)| (own.value - end).abs() <= KNOWN * size) {
            return Err(holder.undefined(until));
        }
        take_slopes(&state, tangents);
        Ok(())
    }

    /// What the state changes by over a step, unless that is too long.
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
            // Aitken and Neville, in the square of the length of a part.
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

    /// Whether two changes of a state are the same within what is allowed, each direction in units of its own size.
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
                // Not a maximum, which loses NaN.
                *error += (difference / scale).abs();
            }
        }
        let mut pairs = sizes.iter().zip(&errors);
        pairs.all(|(size, error)| *error <= LAST * size)
    }
}
