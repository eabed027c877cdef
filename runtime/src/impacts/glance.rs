//! The first look at a step: gaps and rates at its end, and one probe inside without dense output or the polynomials
//! that the gaps are.

use super::series::GapSeries;
use crate::contract::Impacting;
use crate::effects::StepView;
use crate::events::crossing::PROBE;
use crate::integrate::Stepper;
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Times closer than this many units in the last place are the same time.
pub(super) const SAME_TIME: f64 = 4.0 * f64::EPSILON;

/// What the cheap test of a step looks at: gaps and rates at its end, gaps at a probe inside.
pub(super) struct Glance<G> {
    pub(super) gaps: G,
    pub(super) rates: G,
    pub(super) probe: G,
    /// The gaps as polynomials, where the step is one; the probe is not taken then.
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

/// Gaps at the ends of the step and at the probe.
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
    let (rates, probe) = match &series {
        Some(series) => (series.last_rates(length), gaps),
        None => (step.system.gap_rates(t, step.end())?, probe(step)),
    };
    Ok(Glance {
        gaps,
        rates,
        probe,
        series,
        length,
        latest: t.abs().max(step.t_start().abs()),
    })
}

#[inline(always)]
fn probe<Sys: Impacting, Step: Stepper<Sys>>(step: &mut StepView<'_, Sys, Step>) -> Sys::Gaps {
    step.counters.event_evaluations += 1;
    let state = match step.stepper.dense_ready() {
        true => step.state(PROBE),
        false => hermite(step),
    };
    step.system.gaps(step.time(PROBE), &state)
}

/// The state at the probe by the cubic through the ends: good enough to measure how far the gap is from a cubic.
#[inline(always)]
fn hermite<Sys: Impacting, Step: Stepper<Sys>>(step: &StepView<'_, Sys, Step>) -> Sys::State {
    const P: f64 = PROBE;
    const Q: f64 = 1.0 - PROBE;
    let (start, end, [first, last]) = (step.start(), step.end(), step.rates());
    let length = step.length();
    let mut state = *start;
    for i in 0..Sys::State::LEN {
        state.as_mut_slice()[i] = Q * Q * (Q + 3.0 * P) * start.as_slice()[i]
            + P * P * (P + 3.0 * Q) * end.as_slice()[i]
            + length * (Q * Q * P * first.as_slice()[i] - Q * P * P * last.as_slice()[i]);
    }
    state
}
