//! The effect of impacts: finds them in a step, and carries them out.

use core::ops::ControlFlow;

use super::accumulation::Accumulation;
use super::hits::Hits;
use super::law::Law;
use super::override_table::Overrides;
use super::reset::after_reset;
use super::watch::Watch;
use crate::contract::Impacting;
use crate::effects::{Effect, Moment, SceneEffects, StepView};
use crate::integrate::Stepper;
use crate::outcome::Outcome;
use crate::record::{Event, Observer};
use crate::state::StateVector;

/// Impacts a run may have unless told otherwise.
pub const IMPACT_BUDGET: u64 = 10_000_000;

/// A gap rate after an impact that is this small a part of the one before it counts as 0: `2^-36`, what rounding
/// leaves of a plastic impact in a metric of condition `1e4`.
const STILL: f64 = 1.0 / (1_u64 << 36) as f64;

/// Impacts of a system on its surfaces, each by its declared law unless another was chosen.
///
/// Hits at the same time (within rounding) are carried out in order of index, again and again until no surface at
/// hand is approached. A law that leaves the state approaching ends the run with
/// [`Outcome::StillPenetrating`], with the state after the impact.
///
/// A surface with the law [`Law::Reset`] has no side that is not allowed: it counts whenever its gap falls through 0 from
/// above, and where the reset leaves it falling it is crossed. At the first instant of a run, and where a reset has moved
/// the position, a surface at hand counts if it is approached.
#[derive(Debug, Clone)]
pub struct Impacts<Sys: Impacting> {
    overrides: Overrides<Sys::Gaps>,
    budget: u64,
    watch: Watch<Sys>,
    accumulation: Accumulation<Sys::Gaps>,
}

impl<Sys: Impacting> Impacts<Sys> {
    /// The declared laws.
    pub fn declared(system: &Sys) -> Self {
        let _ = system;
        Self {
            overrides: Overrides::none(),
            budget: IMPACT_BUDGET,
            watch: Watch::new(),
            accumulation: Accumulation::none(),
        }
    }

    /// With another law on a surface. A surface past the end changes nothing.
    #[must_use]
    pub fn with_law(mut self, surface: usize, law: Law) -> Self {
        self.overrides.set(surface, law);
        self
    }

    /// Ends runs after this many impacts instead of [`IMPACT_BUDGET`].
    #[must_use]
    pub fn with_budget(mut self, budget: u64) -> Self {
        self.budget = budget;
        self
    }

    /// The law in force on a surface.
    pub fn law_of(&self, system: &Sys, surface: usize) -> Law {
        self.overrides
            .get(surface)
            .unwrap_or_else(|| system.law(surface))
    }

    /// Carries out impacts until none of the surfaces at hand is approached.
    fn strike<O: Observer<Sys>>(
        &mut self,
        mut hits: Hits<Sys::Gaps>,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        let mut rates = now.system.gap_rates(now.t, now.state)?;
        let mut several = hits.approached(&rates) > 1;
        while let Some(surface) = hits.first_approached(&rates) {
            if now.counters.impacts >= self.budget {
                return Err(Outcome::ImpactBudget);
            }
            let before = rates.as_slice()[surface];
            if self.law_of(now.system, surface) == Law::Reset {
                let position = now.system.position(now.state);
                rates = self.impact(surface, several, before, now, observer)?;
                hits.set_done(surface);
                if now.system.position(now.state) != position {
                    self.watch.relocate(&mut hits, &rates, now)?;
                }
            } else {
                if self.watch.is_tangential_crossing(surface) {
                    return Err(Outcome::TangentialCrossing { surface });
                }
                hits.set_still(surface, STILL * before.abs());
                rates = self.impact(surface, several, before, now, observer)?;
                // What still approaches here does so within rounding.
                hits.set_still(surface, -rates.as_slice()[surface]);
            }
            several = several || hits.approached(&rates) > 0;
        }
        self.watch.leave(&hits, now, rates)
    }

    /// One impact; returns the gap rates after it.
    fn impact<O: Observer<Sys>>(
        &mut self,
        surface: usize,
        simultaneous: bool,
        rate: f64,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<Sys::Gaps, Outcome> {
        let (system, t, before) = (now.system, now.t, *now.state);
        let law = self.law_of(system, surface);
        let (after, rho) = match law {
            Law::Reset => (after_reset(system, surface, t, &before)?, None),
            _ => {
                let (after, rho) = kicked(system, surface, law, t, &before)?;
                (after, Some(rho))
            }
        };
        let rates = system.gap_rates(t, &after)?;
        if let Some(component) = after.as_slice().iter().position(|value| !value.is_finite()) {
            return Err(Outcome::NonFinite { component });
        }
        *now.state = after;
        now.counters.impacts += 1;
        let graze = self.watch.is_graze(surface);
        let event = Event {
            t,
            surface,
            law,
            before,
            after,
            simultaneous,
            graze,
        };
        if let ControlFlow::Break(()) = observer.event(&event) {
            return Err(Outcome::Stopped);
        }
        let rate_after = rates.as_slice()[surface];
        // The sign of the rate after a slow impact may be made of rounding errors, which the impact has multiplied.
        let watch = &self.watch;
        let is_approaching = rate_after < -STILL * rate.abs()
            && !watch.is_slow(surface, 0.25 * rate_after, || watch.rounding(surface, now));
        if let Some(rho) = rho
            && is_approaching
        {
            return Err(Outcome::StillPenetrating { surface, rho });
        }
        if now.counters.impacts >= self.budget {
            return Err(Outcome::ImpactBudget);
        }
        let rounding = || watch.rounding(surface, now);
        // A reset sets its rate to the last digit; an impulse leaves rounding errors of the rate it takes.
        let still = if law == Law::Reset {
            0.0
        } else {
            STILL * rate.abs()
        };
        let accumulated = if is_approaching {
            self.accumulation.pass(surface, t)
        } else {
            let bounce = if rate_after > still { rate_after } else { 0.0 };
            self.accumulation.add(surface, t, bounce, rounding)
        };
        match accumulated {
            Some(t) => Err(Outcome::Zeno { t, surface }),
            None => Ok(rates),
        }
    }
}

/// The state after the impulse of a law, and `rho`.
fn kicked<Sys: Impacting>(
    system: &Sys,
    surface: usize,
    law: Law,
    t: f64,
    before: &Sys::State,
) -> Result<(Sys::State, f64), Outcome> {
    let contact = system.contact(surface, t, before)?;
    let mut after = *before;
    system.kick(&mut after, contact.impulse(law), &contact.direction);
    // NOTE: `dh(pi_D grad h)` is rounded, for a constant metric always in the same direction; without this the
    // energy would drift like the number of impacts instead of its root.
    let missed = contact.gap_rate
        - contact.rate_taken(law)
        - system.gap_rates(t, &after)?.as_slice()[surface];
    let correction = missed / contact.constrained_compliance;
    if correction.is_finite() {
        system.kick(&mut after, correction, &contact.direction);
    }
    Ok((after, contact.rho()))
}

impl<Sys: Impacting> Effect<Sys> for Impacts<Sys> {
    fn begin<O: Observer<Sys>>(
        &mut self,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        self.accumulation = Accumulation::none();
        for surface in 0..Sys::Gaps::LEN {
            let resets = self.law_of(now.system, surface) == Law::Reset;
            if resets && now.system.law(surface) != Law::Reset {
                return Err(Outcome::NoReset { surface });
            }
            self.watch.set_passable(surface, resets);
        }
        let hits = self.watch.begin(now)?;
        self.strike(hits, now, observer)
    }

    #[inline]
    fn propose<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<Option<f64>, Outcome> {
        self.watch.look(step).map_err(|outcome| match outcome {
            // Hops have become too small to rise from the surface at all.
            Outcome::Contact { surface } => {
                match self.accumulation.ends_at(surface, step.t_start()) {
                    Some(t) => Outcome::Zeno { t, surface },
                    None => outcome,
                }
            }
            outcome => outcome,
        })
    }

    fn act<O: Observer<Sys>>(
        &mut self,
        theta: f64,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        let hits = self.watch.hits(theta, now)?;
        self.strike(hits, now, observer)
    }
}

impl<Sys: Impacting> SceneEffects<Sys> for Impacts<Sys> {
    fn set_law(&mut self, surface: usize, law: Law) {
        self.overrides.set(surface, law);
    }

    fn law(&self, system: &Sys, surface: usize) -> Option<Law> {
        (surface < Sys::Gaps::LEN).then(|| self.law_of(system, surface))
    }

    fn set_impact_budget(&mut self, budget: Option<u64>) {
        self.budget = budget.unwrap_or(IMPACT_BUDGET);
    }
}
