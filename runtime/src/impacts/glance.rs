//! Data for the first test of a step for impacts: gaps and gap rates at its end.

use super::series::LastSeries;
use crate::contract::Impacting;
use crate::effects::StepView;
use crate::integrate::Stepper;
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Relative difference below which two times count as equal.
pub(super) const SAME_TIME: f64 = 4.0 * f64::EPSILON;

/// Gaps at the end of a step, with data that is computed only for some steps.
pub(super) struct Glance<G: StateVector> {
    pub(super) gaps: G,
    /// Gap rates at the end, once computed.
    rates: Option<G>,
    /// True if the step is a power series.
    has_series: bool,
    /// Length of the step, and the larger of the absolute values of its end times.
    pub(super) length: f64,
    pub(super) latest: f64,
}

impl<G: StateVector> Glance<G> {
    /// True if both ends of the step are at the same time up to rounding.
    pub(super) fn is_moment(&self) -> bool {
        self.length <= SAME_TIME * self.latest
    }

    /// Returns the gap rates at the end of the step. They are computed in the first call, from the polynomials of the gaps
    /// if the step is a power series.
    #[inline(always)]
    pub(super) fn look_closer<Sys: Impacting<Gaps = G>, Step: Stepper<Sys>>(
        &mut self,
        series: &mut LastSeries<G>,
        step: &StepView<'_, Sys, Step>,
    ) -> Result<G, Outcome> {
        if let Some(rates) = self.rates {
            return Ok(rates);
        }
        let series = match self.has_series {
            true => series.expand(step, &self.gaps),
            false => None,
        };
        let rates = match series.and_then(|series| series.last_rates(self.length)) {
            Some(rates) => rates,
            None => step.system.gap_rates(step.t_end(), step.end())?,
        };
        self.rates = Some(rates);
        Ok(rates)
    }

    /// True if the step is a power series.
    #[inline(always)]
    pub(super) fn has_series(&self) -> bool {
        self.has_series
    }

    /// The rates at the end; `None` before [`Glance::look_closer`].
    #[inline(always)]
    pub(super) fn rates(&self) -> Option<&G> {
        self.rates.as_ref()
    }

    /// The rate of a gap at the end; `None` before [`Glance::look_closer`].
    #[inline(always)]
    pub(super) fn rate(&self, surface: usize) -> Option<f64> {
        self.rates().map(|rates| rates.as_slice()[surface])
    }

    /// True if the surface is approached and its gap reaches 0 at the end of the step, within the rounding of times; also if the gap is
    /// 0 there and has no rate.
    #[inline(always)]
    pub(super) fn is_due(&self, surface: usize) -> bool {
        let gap = self.gaps.as_slice()[surface];
        self.rate(surface).is_some_and(|rate| match rate.is_nan() {
            true => gap == 0.0,
            false => rate < 0.0 && gap >= 0.0 && gap <= SAME_TIME * self.latest * -rate,
        })
    }
}

/// Returns the gaps if all are finite, or too large for a number. Otherwise the error has the first that is not.
#[inline(always)]
pub(super) fn finite<G: StateVector>(gaps: G) -> Result<G, Outcome> {
    let is_gap = |gap: &f64| gap.is_finite() || *gap == f64::INFINITY;
    match gaps.as_slice().iter().position(|gap| !is_gap(gap)) {
        Some(surface) => Err(Outcome::UndefinedGap { surface }),
        None => Ok(gaps),
    }
}

/// Computes the gaps at the end of the step. The integrator's gaps are used if it has them.
#[inline(always)]
pub(super) fn glance<Sys: Impacting, Step: Stepper<Sys>>(
    step: &mut StepView<'_, Sys, Step>,
) -> Result<Glance<Sys::Gaps>, Outcome> {
    let (t, length) = (step.t_end(), step.length());
    let known = step.stepper.end_gaps();
    let has_series = known.len() == step.system.surface_count();
    let gaps = match has_series {
        true => {
            let mut gaps = step.system.zero_gaps();
            gaps.as_mut_slice().copy_from_slice(known);
            gaps
        }
        false => {
            step.counters.event_evaluations += 1;
            step.system.gaps(t, step.end())
        }
    };
    Ok(Glance {
        gaps: finite(gaps)?,
        rates: None,
        has_series,
        length,
        latest: t.abs().max(step.t_start().abs()),
    })
}
