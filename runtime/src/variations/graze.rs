//! Detection of grazing impacts along power series, where the rounding of doubles decides if a surface is met.

use super::Undefined;
use crate::contract::Variational;
use crate::integrate::taylor::expansion::Expansion;
use crate::numbers::{Numbers, Row};
use crate::state::StateVector;

/// Number of parts of a step at whose ends the rate of a gap is evaluated. The test assumes that a gap has at most one
/// minimum in a part.
const PLACES: usize = 16;

/// Rounding errors of a gap, in units of the sum of the absolute values of its terms.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A step and its series.
pub(crate) struct Seen<'a, Sys: Variational, L: Numbers> {
    pub(crate) system: &'a Sys,
    pub(crate) expansion: &'a Expansion<Sys, L>,
    pub(crate) order: usize,
    /// The unit of time of the series.
    pub(crate) unit: f64,
}

impl<Sys: Variational, L: Numbers> Seen<'_, Sys, L> {
    /// Refuses a step from `t` over `theta` units in which the gap of a surface falls to 0 within rounding and rises
    /// again.
    pub(crate) fn look_for_grazes(&self, t: f64, theta: f64) -> Result<(), Undefined> {
        for surface in 0..self.system.series_gap_count() {
            let mut falls_from = None;
            for place in 0..=PLACES {
                let part = theta * place as f64 / PLACES as f64;
                let [_, rate, _] = self.gap(surface, part);
                if rate < 0.0 {
                    falls_from = Some(part);
                } else if let Some(low) = falls_from.take()
                    && let Some(part) = self.touch(surface, [low, part])
                {
                    let t = t + part * self.unit;
                    if self.system.counts(surface, t, &self.state_at(part)) {
                        return Err(Undefined::Graze { t, surface });
                    }
                }
            }
        }
        Ok(())
    }

    /// The place of the minimum of the gap between two places, if the minimum is 0 within rounding. Places are in units
    /// of time.
    fn touch(&self, surface: usize, [mut low, mut high]: [f64; 2]) -> Option<f64> {
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            match self.gap(surface, middle)[1] < 0.0 {
                true => low = middle,
                false => high = middle,
            }
        }
        let [gap, _, size] = self.gap(surface, low);
        (gap.abs() <= ROUNDING * size).then_some(low)
    }

    /// A gap after `part` units of time, its rate, and the sum of the absolute values of its terms.
    fn gap(&self, surface: usize, part: f64) -> [f64; 3] {
        let (mut gap, mut rate, mut size) = (0.0, 0.0, 0.0);
        for row in self.expansion.gaps[..=self.order].iter().rev() {
            let term = row.as_slice()[surface].lane(0);
            rate = rate * part + gap;
            gap = gap * part + term;
            size = size * part + term.abs();
        }
        [gap, rate, size]
    }

    fn state_at(&self, part: f64) -> Sys::State {
        let mut state = self.system.zero_state();
        for row in self.expansion.coefficients[..=self.order].iter().rev() {
            for (sum, entry) in state.as_mut_slice().iter_mut().zip(row.as_slice()) {
                *sum = *sum * part + entry.lane(0);
            }
        }
        state
    }
}
