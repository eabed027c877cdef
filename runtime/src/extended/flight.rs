//! Motion between transitions in extended numbers, and location of its impacts.

use super::{At, Impact};
use crate::contract::Variational;
use crate::error::Fault;
use crate::integrate::StepFailure;
use crate::integrate::controller::least_trial;
use crate::integrate::order::order;
use crate::integrate::rough::power_of_two;
use crate::integrate::taylor::expansion::Expansion;
use crate::integrate::taylor::reach::{LONGEST, reach};
use crate::jet::LENGTH;
use crate::numbers::Row;
use crate::record::Event;
use crate::state::StateVector;
use crate::variations::Undefined;
use crate::variations::graze::Seen;
use crate::variations::transition::{arrival, check_near, struck};
use dalembert_numbers::Extended;

/// Allowed difference between the rate at the end of a step and the slope of the series there, in rounding errors of
/// the state.
const DEFECT: f64 = 4096.0;

/// Allowed size of the last two terms of a series, in rounding errors of the first ones.
const LAST: f64 = 0.25;

/// Maximum number of chord steps to the root of a gap with a slope known in double precision. Each step adds the digits
/// of a double.
const CHORDS: u32 = 32;

/// State of a flight.
pub(super) struct Flight<'a, Sys: Variational, const PARTS: usize> {
    system: &'a Sys,
    parameters: Sys::Parameters<Extended<PARTS>>,
    pub(super) expansion: Expansion<Sys, Extended<PARTS>>,
    pub(super) order: usize,
    /// Unit of time of the coefficients, a power of two.
    pub(super) unit: f64,
    /// Unit of the next coefficients.
    pub(super) next_unit: f64,
    /// Length of the last step in this unit.
    pub(super) theta: f64,
    /// Place at which an event cuts the last step, in this unit; `None` if no event does.
    pub(super) cut: Option<f64>,
    /// Ends of the last step.
    pub(super) ends: [At<Sys, PARTS>; 2],
    /// True if the coefficients at the start of the last step are known.
    is_expanded: bool,
}

/// Doubles as a row of extended numbers.
pub(super) fn widened<const PARTS: usize, R: Row<Extended<PARTS>>>(values: &[f64]) -> R {
    let mut row = R::zeros(R::CAPACITY);
    for (entry, value) in row.as_mut_slice().iter_mut().zip(values) {
        *entry = Extended::from(*value);
    }
    row
}

impl<'a, Sys: Variational, const PARTS: usize> Flight<'a, Sys, PARTS> {
    /// A flight from a state, with an estimate of its duration.
    pub(super) fn new(system: &'a Sys, start: At<Sys, PARTS>, length: f64) -> Self {
        Self {
            system,
            parameters: widened(system.parameters().as_slice()),
            expansion: Expansion::of(system),
            order: order(Extended::<PARTS>::ROUNDING, system.work()),
            unit: power_of_two(length),
            next_unit: power_of_two(length),
            theta: 0.0,
            cut: None,
            ends: [start; 2],
            is_expanded: false,
        }
    }

    /// Evaluates the rate and the gaps at the end of the last step.
    pub(super) fn begin(&mut self) -> Result<(), StepFailure> {
        let At { t, state } = &self.ends[1];
        self.expansion
            .begin(self.system, &self.parameters, *t, state)?;
        let all = [state.as_slice(), self.expansion.rate()];
        for numbers in all {
            let is_finite = |number: &Extended<PARTS>| number.nearest().is_finite();
            if let Some(component) = numbers.iter().position(|number| !is_finite(number)) {
                return Err(StepFailure::NonFinite { component });
            }
        }
        Ok(())
    }

    /// Expands the motion from the end of the last step. Returns the reach of the series, at most `length`, in units of
    /// time.
    pub(super) fn expand(&mut self, length: f64) -> Result<f64, StepFailure> {
        self.ends[0] = self.ends[1];
        (self.unit, self.theta, self.cut) = (self.next_unit, 0.0, None);
        let At { t, state } = self.ends[0];
        loop {
            let unit = Extended::from(self.unit);
            self.expansion
                .advance(self.system, &self.parameters, unit, self.order, &state);
            if let Some(theta) = self.reach(length / self.unit) {
                self.is_expanded = true;
                return Ok(theta * self.unit);
            }
            self.unit *= 1.0 / LONGEST;
            if self.unit < least_trial(t.nearest()) {
                return Err(StepFailure::StepUnderflow { t: t.nearest() });
            }
        }
    }

    /// Reach of the series, at most `wished`, in units of the coefficients; `None` if a coefficient is not finite.
    fn reach(&self, wished: f64) -> Option<f64> {
        let scale = self.scale();
        let mut sizes = [[0.0]; LENGTH];
        let rows = &self.expansion.coefficients[..=self.order];
        for ([size], row) in sizes.iter_mut().zip(rows) {
            for (entry, scale) in row.as_slice().iter().zip(scale.as_slice()) {
                let relative = (entry.nearest() / scale).abs();
                if !relative.is_finite() {
                    return None;
                }
                *size = f64::max(*size, relative);
            }
        }
        reach(
            &sizes,
            self.order,
            wished,
            LAST * Extended::<PARTS>::ROUNDING,
        )
    }

    fn scale(&self) -> Sys::State {
        let At { t, .. } = &self.ends[0];
        self.system.scale(t.nearest(), &self.ends[0].rounded())
    }

    /// Time and state after `theta` units, and the slope of the series there.
    fn after(&self, theta: Extended<PARTS>) -> (At<Sys, PARTS>, Sys::Row<Extended<PARTS>>) {
        let [change, slope] = self.expansion.change(self.order, theta);
        let mut at = self.ends[0];
        at.t = at.t + theta * Extended::from(self.unit);
        for (entry, change) in at.state.as_mut_slice().iter_mut().zip(change.as_slice()) {
            *entry = *entry + *change;
        }
        (at, slope)
    }

    /// Makes a step of this length from the expansion. True if the motion at its end agrees with the series.
    pub(super) fn make(&mut self, length: Extended<PARTS>) -> Result<bool, StepFailure> {
        let theta = length / Extended::from(self.unit);
        let (end, slope) = self.after(theta);
        self.theta = theta.nearest();
        self.ends[1] = end;
        self.begin()?;
        Ok(self.is_motion(length.nearest(), &slope))
    }

    /// True if the slope of the series at the end of a step equals the rate there, within rounding.
    fn is_motion(&self, length: f64, slope: &Sys::Row<Extended<PARTS>>) -> bool {
        let scale = self.scale();
        let (rates, end) = (self.expansion.rate(), self.ends[1].state.as_slice());
        let component = |i: usize| {
            let change = (rates[i].nearest() * length).abs();
            (end[i].nearest().abs() + change) / scale.as_slice()[i]
        };
        let size = (0..rates.len()).map(component).fold(0.0, f64::max);
        let unit = Extended::from(self.unit);
        (0..rates.len()).all(|i| {
            let defect = (rates[i] - slope.as_slice()[i] / unit).nearest().abs() * length.abs();
            let allowed = DEFECT * Extended::<PARTS>::ROUNDING * size * scale.as_slice()[i];
            // Subnormal sizes have no digits to compare.
            defect <= allowed.max(f64::MIN_POSITIVE)
        })
    }

    /// Ends the last step at its cut if no transition happened there. `is_start` is true if the cut is the start of the
    /// step.
    pub(super) fn settle(&mut self, is_start: bool) -> Result<(), StepFailure> {
        if !self.is_expanded {
            // After a transition.
            return Ok(());
        }
        match self.cut.take() {
            Some(part) if part < self.theta => {
                let length = Extended::from(part) * Extended::from(self.unit);
                self.make(length).map(drop)
            }
            None if is_start => self.retract(),
            _ => Ok(()),
        }
    }

    /// Makes the remaining step to `t_end` after the rounded time has reached it.
    pub(super) fn land(&mut self, t_end: f64) -> Result<(), StepFailure> {
        let rest = Extended::from(t_end) - self.ends[1].t;
        if rest.nearest() == 0.0 {
            return Ok(());
        }
        self.begin()?;
        self.expand(rest.nearest().abs())?;
        self.make(rest).map(drop)
    }

    /// Sets the end of the last step to its start.
    pub(super) fn retract(&mut self) -> Result<(), StepFailure> {
        self.ends[1] = self.ends[0];
        self.theta = 0.0;
        self.begin()
    }

    /// Refuses the part of the last step up to its cut if a surface is grazed in it.
    pub(super) fn look_for_grazes(&self) -> Result<(), Undefined> {
        let seen = Seen {
            system: self.system,
            expansion: &self.expansion,
            order: self.order,
            unit: self.unit,
        };
        let t = self.ends[0].t.nearest();
        seen.look_for_grazes(t, self.cut.unwrap_or(self.theta))
    }

    /// Discards the last step, which could not be decided.
    pub(super) fn forget(&mut self) {
        self.ends[1] = self.ends[0];
    }

    /// Locates the impact on a surface, and carries out the transition that a run in doubles has found there.
    pub(super) fn cross(
        &mut self,
        event: &Event<Sys::State>,
    ) -> Result<Impact<Sys, PARTS>, Undefined> {
        let rate = arrival(self.system, event)?.gap_rate;
        let before = self.met(event, rate)?;
        check_near(event, &event.before, before.state.as_slice())?;
        let after = struck(
            self.system,
            &self.parameters,
            event,
            before.t,
            &before.state,
        )?;
        check_near(event, &event.after, after.as_slice())?;
        self.ends = [At {
            t: before.t,
            state: after,
        }; 2];
        (self.is_expanded, self.theta, self.cut) = (false, 0.0, None);
        self.begin()
            .map_err(|failure| undefined(failure, event.t))?;
        Ok(Impact {
            t: before.t,
            surface: event.surface,
            law: event.law,
            before: before.state,
            after,
        })
    }

    /// The root of a gap near an event. `rate` is the gap rate there.
    fn met(&mut self, event: &Event<Sys::State>, rate: f64) -> Result<At<Sys, PARTS>, Undefined> {
        let (t, surface) = (event.t, event.surface);
        if !self.is_expanded {
            // The first instant of a run.
            let expanded = self.begin().and_then(|()| self.expand(self.unit));
            self.theta = expanded.map_err(|failure| undefined(failure, t))? / self.unit;
        }
        let slope = Extended::from(rate * self.unit);
        let mut theta = Extended::from(self.cut.unwrap_or(0.0));
        let mut last = f64::INFINITY;
        for _ in 0..CHORDS {
            let at = self.after(theta).0;
            let gaps = self.system.clearances(&self.parameters, at.t, &at.state)?;
            let step = gaps.as_slice()[surface] / slope;
            theta = theta - step;
            let size = step.nearest().abs();
            // Written so that NaN fails the comparison.
            let is_less = size < 0.5 * last;
            last = size;
            if !is_less || size == 0.0 {
                break;
            }
        }
        // If there is a root, the last step has the size of rounding errors.
        let digits = crate::math::sqrt(Extended::<PARTS>::ROUNDING);
        let size = theta.nearest().abs().max(self.theta.abs());
        match last <= digits * size {
            true => Ok(self.after(theta).0),
            false => Err(Undefined::Graze { t, surface }),
        }
    }
}

/// Converts a step failure at a transition.
fn undefined(failure: StepFailure, t: f64) -> Undefined {
    match failure {
        StepFailure::Fault(fault) => fault.into(),
        StepFailure::NonFinite { component } => Fault::NonFinite { component }.into(),
        _ => Undefined::NotFinite { t },
    }
}

/// The state rounded to doubles.
pub(super) fn rounded<S: StateVector, const PARTS: usize>(row: &[Extended<PARTS>]) -> S {
    let mut values = S::zeros(S::CAPACITY);
    for (value, number) in values.as_mut_slice().iter_mut().zip(row) {
        *value = number.nearest();
    }
    values
}
