//! Sliding mode along a surface at which two first-order modes meet and both lead into it.
//!
//! The motion is Filippov's: the convex combination of both fields that stays on the surface,
//!
//! ```text
//! f = f_b + s (f_a - f_b),   s = r_b/(r_a + r_b),
//! ```
//!
//! with the gap rates `r_b` and `r_a` of the transitions `back` and `across` ([`Slide`]), each in the mode that the
//! transition leaves. Both are negative. The sliding mode ends where one of them is 0, or where one of the transitions
//! no longer counts; the motion continues in the mode that this transition leaves.
//!
//! Reference: A. F. Filippov, *Differential Equations with Discontinuous Righthand Sides* (1988), section 4.

use crate::contract::Impacting;
use crate::effects::StepView;
use crate::error::Fault;
use crate::events::first::narrowed;
use crate::integrate::Stepper;
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Two transitions that lead into each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Slide {
    /// The transition out of the mode of the state.
    pub(super) back: usize,
    /// The transition out of the other mode.
    pub(super) across: usize,
}

/// Both fields at a state, and the gap rates with which they lead into the surface.
struct Sides<Sys: Impacting> {
    here: Sys::State,
    other: Sys::State,
    /// `[r_b, r_a]`
    rates: [f64; 2],
}

impl Slide {
    /// The state in the other mode.
    pub(super) fn across<Sys: Impacting>(
        self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
    ) -> Result<Sys::State, Outcome> {
        Ok(system.landing(self.back, t, state)?.state)
    }

    /// The first fraction of the step, up to `reach`, at which the transition out of the other mode does not count,
    /// if it does not count at `reach`.
    pub(super) fn end_across<Sys: Impacting, Step: Stepper<Sys>>(
        self,
        reach: f64,
        step: &StepView<'_, Sys, Step>,
    ) -> Option<f64> {
        let (system, across) = (step.system, self.across);
        let ceases = |part: f64| {
            let t = step.time(part);
            let other = self.across(system, t, &step.state(part));
            other.is_ok_and(|other| !system.surface_active(across, t, &other))
        };
        match (ceases(0.0), ceases(reach)) {
            (true, _) => Some(0.0),
            (false, true) => Some(narrowed([0.0, reach], ceases).after),
            (false, false) => None,
        }
    }

    fn sides<Sys: Impacting>(
        self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
    ) -> Result<Sides<Sys>, Fault> {
        let other = self
            .across(system, t, state)
            .map_err(|_| Fault::SingularSurface { surface: self.back })?;
        let mut rates = [system.zero_state(); 2];
        system.rate(t, state, &mut rates[0])?;
        system.rate(t, &other, &mut rates[1])?;
        let back = system.gap_rates(t, state)?.as_slice()[self.back];
        let across = system.gap_rates(t, &other)?.as_slice()[self.across];
        Ok(Sides {
            here: rates[0],
            other: rates[1],
            rates: [back, across],
        })
    }

    /// Speeds with which both modes lead into the surface, at the indices of their transitions; 0 elsewhere.
    pub(super) fn pressures<Sys: Impacting>(
        self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
    ) -> Result<Sys::Gaps, Fault> {
        let [back, across] = self.sides(system, t, state)?.rates;
        let mut pressures = system.zero_gaps();
        pressures.as_mut_slice()[self.back] = -back;
        pressures.as_mut_slice()[self.across] = -across;
        Ok(pressures)
    }

    /// Replaces the rate of the present mode by that of the sliding motion.
    pub(super) fn add<Sys: Impacting>(
        self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        rate: &mut Sys::State,
    ) -> Result<(), Fault> {
        let Sides { here, other, rates } = self.sides(system, t, state)?;
        let share = rates[0] / (rates[0] + rates[1]);
        let pairs = here.as_slice().iter().zip(other.as_slice());
        for (rate, (here, other)) in rate.as_mut_slice().iter_mut().zip(pairs) {
            *rate += share * (other - here);
        }
        Ok(())
    }

    /// Brings the state back to the surface, along the difference of both fields.
    pub(super) fn settle<Sys: Impacting>(
        self,
        system: &Sys,
        t: f64,
        state: &mut Sys::State,
    ) -> Result<(), Fault> {
        let gap = system.gaps(t, state).as_slice()[self.back];
        let Sides { here, other, rates } = self.sides(system, t, state)?;
        let step = gap / (rates[0] + rates[1]);
        if !step.is_finite() {
            return Ok(());
        }
        let pairs = here.as_slice().iter().zip(other.as_slice());
        for (value, (here, other)) in state.as_mut_slice().iter_mut().zip(pairs) {
            *value += step * (other - here);
        }
        Ok(())
    }
}
