//! The first look at a step: gaps and rates at its end, and the polynomials that the gaps are of a step that is a series.

use super::series::GapSeries;
use crate::contract::Impacting;
use crate::effects::StepView;
use crate::integrate::Stepper;
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Times closer than this many units in the last place are the same time.
pub(super) const SAME_TIME: f64 = 4.0 * f64::EPSILON;

/// Gaps and rates at the end of a step.
pub(super) struct Glance<G> {
    pub(super) gaps: G,
    pub(super) rates: G,
    /// The gaps as polynomials, where the step is one.
    pub(super) series: Option<GapSeries<G>>,
    /// Length of the step, and the larger of the absolute values of its times.
    pub(super) length: f64,
    pub(super) latest: f64,
}

impl<G: StateVector> Glance<G> {
    /// Whether both ends of the step are one moment as far as times can tell.
    pub(super) fn is_moment(&self) -> bool {
        self.length <= SAME_TIME * self.latest
    }

    /// The gap vanishes at the end of the step as far as times can tell.
    #[inline(always)]
    pub(super) fn is_due(&self, surface: usize) -> bool {
        let (gap, rate) = (
            self.gaps.as_slice()[surface],
            self.rates.as_slice()[surface],
        );
        rate < 0.0 && gap >= 0.0 && gap <= SAME_TIME * self.latest * -rate
    }
}

/// The gaps, if all are finite.
#[inline(always)]
pub(super) fn finite<Sys: Impacting>(gaps: Sys::Gaps) -> Result<Sys::Gaps, Outcome> {
    match gaps.as_slice().iter().position(|gap| !gap.is_finite()) {
        Some(surface) => Err(Outcome::NonFinite {
            component: Sys::State::LEN + surface,
        }),
        None => Ok(gaps),
    }
}

/// Gaps and rates at the end of the step.
#[inline(always)]
pub(super) fn glance<Sys: Impacting, Step: Stepper<Sys>>(
    step: &mut StepView<'_, Sys, Step>,
) -> Result<Glance<Sys::Gaps>, Outcome> {
    let (t, length) = (step.t_end(), step.length());
    let known = step.stepper.end_gaps();
    let has_series = known.len() == Sys::Gaps::LEN;
    let gaps = match has_series {
        true => {
            let mut gaps = Sys::Gaps::zeros();
            gaps.as_mut_slice().copy_from_slice(known);
            gaps
        }
        false => {
            step.counters.event_evaluations += 1;
            step.system.gaps(t, step.end())
        }
    };
    let gaps = finite::<Sys>(gaps)?;
    let series = has_series.then(|| GapSeries::of(step, &gaps)).flatten();
    let rates = match &series {
        Some(series) => series.last_rates(length),
        None => step.system.gap_rates(t, step.end())?,
    };
    Ok(Glance {
        gaps,
        rates,
        series,
        length,
        latest: t.abs().max(step.t_start().abs()),
    })
}
