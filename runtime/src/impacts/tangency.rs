//! Gaps that are zero at gap rate zero: tests whether the motion presses into the surface or crosses it.

use super::held::second_rates;
use super::search::gap_at;
use crate::contract::Impacting;
use crate::effects::StepView;
use crate::error::Fault;
use crate::integrate::Stepper;
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Least fraction of a step over which the decrease of a gap rate is compared with the second rate. It keeps half of
/// the digits, so that rounding is not taken for a second rate.
const LEAST_PART: f64 = 1.0 / (1 << 26) as f64;

/// True if the second rate of a gap accounts for at least half of the decrease of its rate over some small part of the
/// step. Gap and gap rate are 0 at the start of the step.
pub(super) fn is_accelerated<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
) -> Result<bool, Outcome> {
    let (t, start, [rate, _]) = (step.t_start(), step.start(), step.rates());
    let Some(accelerations) = second_rates(step.system, t, start, rate)? else {
        return Ok(false);
    };
    let acceleration = accelerations.as_slice()[surface];
    let first = step.system.gap_rates(t, start)?.as_slice()[surface];
    let mut part = 0.125;
    while acceleration < 0.0 && part > LEAST_PART {
        let rates = step.system.gap_rates(step.time(part), &step.state(part))?;
        let fall = rates.as_slice()[surface] - first;
        if fall < 0.0 && fall > 2.0 * acceleration * part * step.length() {
            return Ok(true);
        }
        part *= 0.125;
    }
    Ok(false)
}

/// True if the second rate of a gap accounts for its negative value at `part`, or its rate if it has no second one. Gap and
/// gap rate are 0 at the start of the step, and the second rate may be.
///
/// NOTE: the error of a long step's dense output may sink as well. It changes these rates by less than that.
pub(super) fn sinks_by_its_second_rate<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
    part: f64,
) -> Result<bool, Outcome> {
    let elapsed = part * step.length();
    let second = second_rate_at(surface, step, part)?;
    let change = match second.is_nan() {
        true => {
            let rates = step.system.gap_rates(step.time(part), &step.state(part))?;
            rates.as_slice()[surface] * elapsed
        }
        false => second * elapsed * elapsed,
    };
    Ok(change < gap_at(surface, step, part))
}

/// The second rate of a gap at a fraction of the step; NaN for a system that does not provide it.
pub(super) fn second_rate_at<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
    part: f64,
) -> Result<f64, Fault> {
    let (t, state) = (step.time(part), step.state(part));
    let mut rate = step.system.zero_state();
    step.system.rate(t, &state, &mut rate)?;
    let second = second_rates(step.system, t, &state, &rate)?;
    Ok(second.map_or(f64::NAN, |second| second.as_slice()[surface]))
}

/// True if a gap that is 0 at this fraction of a step, with gap rate 0, continues like the cube of time. If it
/// continues like the square of time, the motion has a grazing impact or begins a contact. The changes of the rate over
/// an eighth and a quarter of the remaining step distinguish the two cases.
pub(super) fn crosses_at_rest<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
    part: f64,
) -> Result<bool, Outcome> {
    let rate = |share: f64| {
        let part = part + share * (1.0 - part);
        let rates = step.system.gap_rates(step.time(part), &step.state(part));
        rates.map(|rates| rates.as_slice()[surface])
    };
    let (first, eighth, quarter) = (rate(0.0)?, rate(0.125)?, rate(0.25)?);
    // The ratio of the changes is a quarter for the cube, a half for the square.
    Ok(quarter < first && eighth - first > 0.375 * (quarter - first))
}
