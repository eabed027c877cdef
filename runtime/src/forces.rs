//! Forces that an effect adds to the motion for a time, for example the contact force of a surface in contact with the
//! motion.

use crate::contract::{System, VectorField};
use crate::error::Fault;
use crate::integrate::{Counters, Instant, Series, StepFailure, Stepper, Tolerance};
use crate::jet::LENGTH;

/// Forces on a system.
///
/// # Examples
///
/// ```
/// use dalembert::{Fault, Forces, VectorField, System};
///
/// # dalembert::model! {
/// #     pub Pendulum {
/// #         coordinates { theta: angle; }
/// #         lagrangian = dot(theta)^2/2 + cos(theta);
/// #     }
/// # }
///
/// /// A torque about the pivot.
/// #[derive(Clone, Copy, PartialEq)]
/// struct Torque(f64);
///
/// impl Forces<Pendulum> for Torque {
///     fn add(
///         &self,
///         system: &Pendulum,
///         _t: f64,
///         _state: &<Pendulum as VectorField>::State,
///         rate: &mut <Pendulum as VectorField>::State,
///     ) -> Result<(), Fault> {
///         system.kick(rate, self.0, &[1.0].into());
///         Ok(())
///     }
/// }
///
/// let pendulum = Pendulum::default();
/// let state = pendulum.state(0.0, &[0.0].into(), &[0.0].into())?;
/// let mut rate = pendulum.zero_state();
/// pendulum.rate(0.0, &state, &mut rate)?;
/// Torque(0.5).add(&pendulum, 0.0, &state, &mut rate)?;
/// assert_eq!(rate[1], 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Forces<Sys: System>: Copy + PartialEq {
    /// Adds the forces to `rate`, the rate of `state` without them.
    ///
    /// # Errors
    /// A [`Fault`] where the forces do not exist; `rate` is unspecified then.
    fn add(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        rate: &mut Sys::State,
    ) -> Result<(), Fault>;
}

/// The forces of an effect that never adds any.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoForces {}

impl<Sys: System> Forces<Sys> for NoForces {
    fn add(&self, _: &Sys, _: f64, _: &Sys::State, _: &mut Sys::State) -> Result<(), Fault> {
        match *self {}
    }
}

impl<Sys: System, F: Forces<Sys>> Forces<Sys> for Option<F> {
    #[inline(always)]
    fn add(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        rate: &mut Sys::State,
    ) -> Result<(), Fault> {
        match self {
            Some(forces) => forces.add(system, t, state, rate),
            None => Ok(()),
        }
    }
}

/// A system under forces.
pub(crate) struct Driven<'a, Sys, F> {
    pub(crate) system: &'a Sys,
    pub(crate) forces: F,
}

impl<Sys: System, F: Forces<Sys>> VectorField for Driven<'_, Sys, F> {
    type State = Sys::State;

    fn rate(&self, t: f64, state: &Self::State, rate: &mut Self::State) -> Result<(), Fault> {
        self.system.rate(t, state, rate)?;
        self.forces.add(self.system, t, state, rate)
    }

    fn scale(&self, t: f64, state: &Self::State) -> Self::State {
        self.system.scale(t, state)
    }
}

/// Presents an integrator of a system under forces as an integrator of the system itself. It integrates its own field
/// and ignores the field passed to it.
pub(crate) struct Along<'a, F, Step> {
    pub(crate) field: &'a F,
    pub(crate) stepper: Step,
}

impl<Sys, F, Step> Stepper<Sys> for Along<'_, F, Step>
where
    Sys: VectorField,
    F: VectorField<State = Sys::State>,
    Step: Stepper<F>,
{
    fn name(&self) -> &'static str {
        self.stepper.name()
    }

    fn tolerance(&self) -> Tolerance {
        self.stepper.tolerance()
    }

    fn max_step(&self) -> f64 {
        self.stepper.max_step()
    }

    fn start(
        &mut self,
        _: &Sys,
        now: Instant,
        state: &Sys::State,
        t_end: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.stepper.start(self.field, now, state, t_end, counters)
    }

    fn restart(
        &mut self,
        _: &Sys,
        now: Instant,
        state: &Sys::State,
        limit: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.stepper
            .restart(self.field, now, state, limit, counters)
    }

    fn step(&mut self, _: &Sys, t_end: f64, counters: &mut Counters) -> Result<(), StepFailure> {
        self.stepper.step(self.field, t_end, counters)
    }

    fn error(&self) -> f64 {
        self.stepper.error()
    }

    fn fixed_step(&self) -> Option<f64> {
        self.stepper.fixed_step()
    }

    fn replace_end(
        &mut self,
        _: &Sys,
        state: &Sys::State,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.stepper.replace_end(self.field, state, counters)
    }

    fn start_time(&self) -> Instant {
        self.stepper.start_time()
    }

    fn end_time(&self) -> Instant {
        self.stepper.end_time()
    }

    fn start_state(&self) -> &Sys::State {
        self.stepper.start_state()
    }

    fn end_state(&self) -> &Sys::State {
        self.stepper.end_state()
    }

    fn end_rates(&self) -> [&Sys::State; 2] {
        self.stepper.end_rates()
    }

    fn series(&self) -> Option<Series> {
        self.stepper.series()
    }

    fn gap_coefficient(&self, k: usize) -> &[f64] {
        self.stepper.gap_coefficient(k)
    }

    fn end_gaps(&self) -> &[f64] {
        self.stepper.end_gaps()
    }

    fn dense_ready(&self) -> bool {
        self.stepper.dense_ready()
    }

    fn prepare_dense(&mut self, _: &Sys, counters: &mut Counters) -> Result<(), Fault> {
        self.stepper.prepare_dense(self.field, counters)
    }

    fn interpolate(&self, theta: f64) -> Sys::State {
        self.stepper.interpolate(theta)
    }

    fn powers(&self, coefficients: &mut [Sys::State; LENGTH]) -> usize {
        self.stepper.powers(coefficients)
    }

    fn sway(&self) -> Option<Sys::State> {
        self.stepper.sway()
    }

    fn cut(&mut self, theta: f64) -> (Instant, Sys::State) {
        self.stepper.cut(theta)
    }
}
