//! Effects: all actions on a run besides its smooth motion. Tuples compose them at the type level; `()` compiles to
//! nothing.
//!
//! In every step each effect proposes the earliest crossing inside it. The step is cut at the earliest of all
//! proposals, every effect may act there, and integration starts again from the resulting state.

use crate::audit::Auditor;
use crate::contract::System;
use crate::error::Fault;
use crate::forces::{Forces, NoForces};
use crate::integrate::{Counters, Stepper};
use crate::jet::LENGTH;
use crate::law::Law;
use crate::outcome::Outcome;
use crate::policy::Policies;
use crate::record::{Interpolant, Observer};

/// Read access of effects to an accepted step.
pub struct StepView<'a, Sys: System, Step> {
    /// The system.
    pub system: &'a Sys,
    /// Work done so far.
    pub counters: &'a mut Counters,
    pub(crate) stepper: &'a mut Step,
}

impl<Sys: System, Step: Stepper<Sys>> StepView<'_, Sys, Step> {
    /// Time at the start.
    #[inline(always)]
    pub fn t_start(&self) -> f64 {
        self.stepper.t_start()
    }

    /// Time at the end.
    #[inline(always)]
    pub fn t_end(&self) -> f64 {
        self.stepper.t_end()
    }

    /// Length of the step.
    #[inline(always)]
    pub fn length(&self) -> f64 {
        self.stepper.length()
    }

    /// Time at a fraction `theta` of the step, exact at both ends.
    #[inline(always)]
    pub fn time(&self, theta: f64) -> f64 {
        if theta >= 1.0 {
            self.t_end()
        } else {
            self.t_start() + theta * self.length()
        }
    }

    /// State at the start.
    #[inline(always)]
    pub fn start(&self) -> &Sys::State {
        self.stepper.start_state()
    }

    /// State at the end.
    #[inline(always)]
    pub fn end(&self) -> &Sys::State {
        self.stepper.end_state()
    }

    /// Rates at both ends.
    #[inline(always)]
    pub fn rates(&self) -> [&Sys::State; 2] {
        self.stepper.end_rates()
    }

    /// Prepares the dense output for [`StepView::state`].
    ///
    /// # Errors
    /// The [`Fault`] of an extra stage.
    #[inline]
    pub fn prepare(&mut self) -> Result<(), Fault> {
        self.stepper.prepare_dense(self.system, self.counters)
    }

    /// State at a fraction `theta` of the step. At the end it is exactly [`StepView::end`]. Inside the step, call
    /// [`StepView::prepare`] first.
    #[inline(always)]
    pub fn state(&self, theta: f64) -> Sys::State {
        if theta >= 1.0 {
            *self.end()
        } else {
            self.stepper.interpolate(theta)
        }
    }
}

impl<Sys: System, Step: Stepper<Sys>> Interpolant<Sys::State> for StepView<'_, Sys, Step> {
    fn start(&self) -> &Sys::State {
        self.stepper.start_state()
    }

    fn at(&mut self, theta: f64) -> Result<Sys::State, Fault> {
        self.prepare()?;
        Ok(self.state(theta))
    }

    fn powers(&mut self, coefficients: &mut [Sys::State; LENGTH]) -> Result<usize, Fault> {
        self.prepare()?;
        Ok(self.stepper.powers(coefficients))
    }
}

/// A moment of a run at which effects may change the state.
pub struct Moment<'a, Sys: System> {
    /// The system.
    pub system: &'a Sys,
    /// The time.
    pub t: f64,
    /// The state. The run continues from the value that the effects leave here.
    pub state: &'a mut Sys::State,
    /// Work done so far.
    pub counters: &'a mut Counters,
}

/// Result of an effect on the state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// The state is unchanged.
    Kept,
    /// The state was changed.
    Changed,
}

impl Change {
    /// [`Change::Changed`] if either is.
    #[inline(always)]
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        if self == Self::Changed { self } else { other }
    }
}

/// An action on a run besides its smooth motion. An `Err` from any method ends the run with that outcome.
///
/// # Examples
///
/// ```
/// use dalembert::effects::{Change, Moment};
/// use dalembert::{Dop853, Effect, NoForces, Outcome, Simulation, System, Tolerance};
///
/// # dalembert::model! {
/// #     pub Pendulum {
/// #         coordinates { theta: angle; }
/// #         lagrangian = dot(theta)^2/2 + cos(theta);
/// #     }
/// # }
///
/// /// Counts the steps at whose end the pendulum stands above its pivot.
/// struct Above(u32);
///
/// impl Effect<Pendulum> for Above {
///     type Forces = NoForces;
///
///     fn settle(&mut self, now: &mut Moment<'_, Pendulum>, _cut: bool) -> Result<Change, Outcome> {
///         let theta = now.system.position(now.state)[0];
///         self.0 += u32::from(theta.cos() < 0.0);
///         Ok(Change::Kept)
///     }
/// }
///
/// let pendulum = Pendulum::default();
/// let state = pendulum.state(0.0, &[0.0].into(), &[3.0].into())?;
/// let mut simulation = Simulation::new(&pendulum, Dop853::new(Tolerance::new(1e-9)?), Above(0));
/// simulation.run(0.0, state, 10.0, &mut ())?;
/// assert!(simulation.effects().0 > 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Effect<Sys: System> {
    /// Type of the forces that it adds to the motion; [`NoForces`] if it adds none.
    type Forces: Forces<Sys>;

    /// Forces that the effect adds to the motion from now on. The driver asks for them after every cut, and restarts
    /// the integrator if they have changed.
    fn forces(&self) -> Option<Self::Forces> {
        None
    }

    /// Called at the first instant of a run, before the first step.
    ///
    /// # Errors
    /// The [`Outcome`] that ends the run.
    fn begin<O: Observer<Sys>>(
        &mut self,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        let _ = (now, observer);
        Ok(())
    }

    /// The fraction of a step under the effect's forces up to which the forces vary so little that the step shows it; 1
    /// for the whole step. A step that does not show them is repeated with a shorter length.
    ///
    /// # Errors
    /// The [`Outcome`] that ends the run, at the start of the step.
    fn shown<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<f64, Outcome> {
        let _ = step;
        Ok(1.0)
    }

    /// Proposes the earliest crossing in the step, as a fraction in \[0, 1\] of it. 0 discards the step. `None`
    /// accepts the step to its end.
    ///
    /// # Errors
    /// The [`Outcome`] that ends the run, at the start of the step.
    fn propose<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<Option<f64>, Outcome> {
        let _ = step;
        Ok(None)
    }

    /// Called where smooth motion has arrived: at the end of a step, or with `cut` at the crossing that cut the step.
    ///
    /// # Errors
    /// The [`Outcome`] that ends the run here.
    fn settle(&mut self, now: &mut Moment<'_, Sys>, cut: bool) -> Result<Change, Outcome> {
        let _ = (now, cut);
        Ok(Change::Kept)
    }

    /// Called where a step was cut at `theta`, after settling moved the state. Gives the time until the settled motion meets
    /// what this effect proposed, which may be negative; `None` if it does so here, or if another effect proposed the cut.
    ///
    /// # Errors
    /// The [`Outcome`] that ends the run here.
    fn aim(&mut self, theta: f64, now: &mut Moment<'_, Sys>) -> Result<Option<f64>, Outcome> {
        let _ = (theta, now);
        Ok(None)
    }

    /// Acts where the step was cut, at the fraction `theta` proposed by this effect or by another.
    ///
    /// # Errors
    /// The [`Outcome`] that ends the run here.
    fn act<O: Observer<Sys>>(
        &mut self,
        theta: f64,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        let _ = (theta, now, observer);
        Ok(())
    }
}

/// Settings of a scene's effects that a caller may choose at run time. An effect ignores settings that do not concern
/// it.
///
/// # Examples
///
/// ```
/// use dalembert::{Dop853, Law, Policies, Rest, Scene, SceneEffects, Simulation, System, Tolerance};
///
/// dalembert::model! {
///     pub Ball {
///         coordinates { x; }
///         lagrangian = dot(x)^2/2 - x;
///         impacts { floor: x >= 0; }
///         initial { x = 1; }
///     }
/// }
///
/// let ball = Ball::default();
/// let mut effects = ball.effects();
/// effects.set_law(0, Law::Restitution(0.5));
/// effects.set_policies(Policies { rest: Rest::Contact, ..Policies::default() });
///
/// let state = ball.state(0.0, &[1.0].into(), &[0.0].into())?;
/// let run = Simulation::new(&ball, Dop853::new(Tolerance::new(1e-10)?), effects).run(0.0, state, 20.0, &mut ())?;
/// assert!(ball.position(&run.state)[0].abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait SceneEffects<Sys: System>: Effect<Sys> {
    /// Replaces the law of a surface.
    fn set_law(&mut self, surface: usize, law: Law) {
        let _ = (surface, law);
    }

    /// The law in force on a surface; `None` if there are no impacts.
    fn law(&self, system: &Sys, surface: usize) -> Option<Law> {
        let _ = (system, surface);
        None
    }

    /// Sets the number of impacts after which a run ends; `None` restores the default.
    fn set_impact_budget(&mut self, budget: Option<u64>) {
        let _ = budget;
    }

    /// Switches the projection to the constraints on or off.
    fn set_projection(&mut self, on: bool) {
        let _ = on;
    }

    /// Sets the policies for impacts whose law alone does not determine how the run continues.
    fn set_policies(&mut self, policies: Policies) {
        let _ = policies;
    }

    /// Makes an audit of the surfaces in force, and passes it to `work`. Returns false if there are no surfaces, or if
    /// no audit is independent of the event location of these effects.
    fn audit(&self, system: &Sys, work: &mut dyn FnMut(&mut dyn Auditor<Sys>)) -> bool {
        let _ = (system, work);
        false
    }
}

/// A system with the effects of its declaration.
///
/// # Examples
///
/// ```
/// use dalembert::{Dop853, Scene, Simulation, System, Tolerance};
///
/// dalembert::model! {
///     pub Ball {
///         coordinates { x; }
///         lagrangian = dot(x)^2/2 - x;
///         impacts { floor: x >= 0; }
///         initial { x = 1; }
///     }
/// }
///
/// // The effects of the model itself: impacts on its floor.
/// let ball = Ball::default();
/// let state = ball.state(0.0, &[0.5].into(), &[0.0].into())?;
/// let integrator = Dop853::new(Tolerance::new(1e-12)?);
/// let run = Simulation::new(&ball, integrator, ball.effects()).run(0.0, state, 2.0, &mut ())?;
/// assert_eq!(run.counters.impacts, 1);
/// assert!((ball.position(&run.state)[0] - 0.5).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Scene: System + Sized {
    /// Type of the effects.
    type Effects: SceneEffects<Self>;

    /// The declared effects.
    fn effects(&self) -> Self::Effects;
}

impl<Sys: System> Effect<Sys> for () {
    type Forces = NoForces;
}

impl<Sys: System> SceneEffects<Sys> for () {}

/// An optional effect, chosen at run time.
impl<Sys: System, E: Effect<Sys>> Effect<Sys> for Option<E> {
    type Forces = E::Forces;

    #[inline(always)]
    fn forces(&self) -> Option<E::Forces> {
        self.as_ref()?.forces()
    }

    fn begin<O: Observer<Sys>>(
        &mut self,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        match self {
            Some(effect) => effect.begin(now, observer),
            None => Ok(()),
        }
    }

    fn shown<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<f64, Outcome> {
        match self {
            Some(effect) => effect.shown(step),
            None => Ok(1.0),
        }
    }

    #[inline(always)]
    fn propose<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<Option<f64>, Outcome> {
        match self {
            Some(effect) => effect.propose(step),
            None => Ok(None),
        }
    }

    #[inline(always)]
    fn settle(&mut self, now: &mut Moment<'_, Sys>, cut: bool) -> Result<Change, Outcome> {
        match self {
            Some(effect) => effect.settle(now, cut),
            None => Ok(Change::Kept),
        }
    }

    fn aim(&mut self, theta: f64, now: &mut Moment<'_, Sys>) -> Result<Option<f64>, Outcome> {
        match self {
            Some(effect) => effect.aim(theta, now),
            None => Ok(None),
        }
    }

    fn act<O: Observer<Sys>>(
        &mut self,
        theta: f64,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        match self {
            Some(effect) => effect.act(theta, now, observer),
            None => Ok(()),
        }
    }
}

impl<Sys: System, E: SceneEffects<Sys>> SceneEffects<Sys> for Option<E> {
    fn set_law(&mut self, surface: usize, law: Law) {
        if let Some(effects) = self {
            effects.set_law(surface, law);
        }
    }

    fn law(&self, system: &Sys, surface: usize) -> Option<Law> {
        self.as_ref()?.law(system, surface)
    }

    fn set_impact_budget(&mut self, budget: Option<u64>) {
        if let Some(effects) = self {
            effects.set_impact_budget(budget);
        }
    }

    fn set_projection(&mut self, on: bool) {
        if let Some(effects) = self {
            effects.set_projection(on);
        }
    }

    fn set_policies(&mut self, policies: Policies) {
        if let Some(effects) = self {
            effects.set_policies(policies);
        }
    }

    fn audit(&self, system: &Sys, work: &mut dyn FnMut(&mut dyn Auditor<Sys>)) -> bool {
        self.as_ref()
            .is_some_and(|effects| effects.audit(system, work))
    }
}

/// The earlier of two proposals.
#[inline(always)]
fn earlier(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

macro_rules! compose {
    ($($effect:ident $index:tt),+) => {
        impl<Sys: System, $($effect: Forces<Sys>),+> Forces<Sys> for ($($effect,)+) {
            #[inline(always)]
            fn add(
                &self,
                system: &Sys,
                t: f64,
                state: &Sys::State,
                rate: &mut Sys::State,
            ) -> Result<(), Fault> {
                $(self.$index.add(system, t, state, rate)?;)+
                Ok(())
            }
        }

        impl<Sys: System, $($effect: Effect<Sys>),+> Effect<Sys> for ($($effect,)+) {
            type Forces = ($(Option<$effect::Forces>,)+);

            #[inline(always)]
            fn forces(&self) -> Option<Self::Forces> {
                let forces = ($(self.$index.forces(),)+);
                ($(forces.$index.is_some())||+).then_some(forces)
            }

            fn begin<O: Observer<Sys>>(
                &mut self,
                now: &mut Moment<'_, Sys>,
                observer: &mut O,
            ) -> Result<(), Outcome> {
                $(self.$index.begin(now, observer)?;)+
                Ok(())
            }

            fn shown<Step: Stepper<Sys>>(
                &mut self,
                step: &mut StepView<'_, Sys, Step>,
            ) -> Result<f64, Outcome> {
                let mut least = 1.0_f64;
                $(least = least.min(self.$index.shown(step)?);)+
                Ok(least)
            }

            #[inline(always)]
            fn propose<Step: Stepper<Sys>>(
                &mut self,
                step: &mut StepView<'_, Sys, Step>,
            ) -> Result<Option<f64>, Outcome> {
                let mut earliest = None;
                $(earliest = earlier(earliest, self.$index.propose(step)?);)+
                Ok(earliest)
            }

            #[inline(always)]
            fn settle(&mut self, now: &mut Moment<'_, Sys>, cut: bool) -> Result<Change, Outcome> {
                let mut change = Change::Kept;
                $(change = change.or(self.$index.settle(now, cut)?);)+
                Ok(change)
            }

            fn aim(
                &mut self,
                theta: f64,
                now: &mut Moment<'_, Sys>,
            ) -> Result<Option<f64>, Outcome> {
                let mut aimed = None;
                $(aimed = aimed.or(self.$index.aim(theta, now)?);)+
                Ok(aimed)
            }

            #[inline]
            fn act<O: Observer<Sys>>(
                &mut self,
                theta: f64,
                now: &mut Moment<'_, Sys>,
                observer: &mut O,
            ) -> Result<(), Outcome> {
                $(self.$index.act(theta, now, observer)?;)+
                Ok(())
            }
        }

        impl<Sys: System, $($effect: SceneEffects<Sys>),+> SceneEffects<Sys> for ($($effect,)+) {
            fn set_law(&mut self, surface: usize, law: Law) {
                $(self.$index.set_law(surface, law);)+
            }

            fn law(&self, system: &Sys, surface: usize) -> Option<Law> {
                None$(.or(self.$index.law(system, surface)))+
            }

            fn set_impact_budget(&mut self, budget: Option<u64>) {
                $(self.$index.set_impact_budget(budget);)+
            }

            fn set_projection(&mut self, on: bool) {
                $(self.$index.set_projection(on);)+
            }

            fn set_policies(&mut self, policies: Policies) {
                $(self.$index.set_policies(policies);)+
            }

            fn audit(&self, system: &Sys, work: &mut dyn FnMut(&mut dyn Auditor<Sys>)) -> bool {
                false $(|| self.$index.audit(system, work))+
            }
        }
    };
}

compose!(A 0);
compose!(A 0, B 1);
compose!(A 0, B 1, C 2);
compose!(A 0, B 1, C 2, D 3);
