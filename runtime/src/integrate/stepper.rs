//! The step interface: the only view that the driver has of an integrator.

use core::fmt;

use super::instant::Instant;
use super::stats::Counters;
use super::tolerance::Tolerance;
use crate::contract::VectorField;
use crate::error::Fault;
use crate::jet::LENGTH;
use crate::outcome::Outcome;

/// A one-step integrator with dense output, with step-size control or a fixed step.
///
/// After [`Stepper::start`], every [`Stepper::step`] makes one accepted step from the end of the last one. Both ends
/// of the step stay readable until the next. [`Stepper::interpolate`] gives states between them, after
/// [`Stepper::prepare_dense`].
///
/// # Examples
///
/// ```
/// use dalembert::integrate::{Counters, Instant};
/// use dalembert::{Dop853, Gauss4, Stepper, System, Tolerance, VectorField};
/// # dalembert::model! {
/// #     pub Pendulum {
/// #         coordinates { theta: angle; }
/// #         lagrangian = dot(theta)^2/2 + cos(theta);
/// #     }
/// # }
///
/// type State = <Pendulum as VectorField>::State;
///
/// /// The state after a time of 1.
/// fn after_one(pendulum: &Pendulum, mut stepper: impl Stepper<Pendulum>, start: &State) -> State {
///     let mut counters = Counters::default();
///     stepper.start(pendulum, Instant::new(0.0), start, 1.0, &mut counters).expect("a rate");
///     while stepper.t_end() < 1.0 {
///         stepper.step(pendulum, 1.0, &mut counters).expect("a step");
///     }
///     *stepper.end_state()
/// }
///
/// let pendulum = Pendulum::default();
/// let start = pendulum.state(0.0, &[0.5].into(), &[0.0].into())?;
/// let tolerance = Tolerance::new(1e-10)?;
/// let explicit = after_one(&pendulum, Dop853::new(tolerance), &start);
/// let implicit = after_one(&pendulum, Gauss4::new(tolerance), &start);
/// assert!((explicit[0] - implicit[0]).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Stepper<F: VectorField> {
    /// Name on the command line.
    fn name(&self) -> &'static str;

    /// The tolerance of the integrator.
    fn tolerance(&self) -> Tolerance;

    /// The longest step that step-size control may choose; infinite without a limit, and for a fixed step.
    fn max_step(&self) -> f64 {
        f64::INFINITY
    }

    /// Begins at `(now, state)` towards `t_end`, and finds a first step size.
    ///
    /// # Errors
    /// [`StepFailure`] where the vector field does not exist at the start.
    fn start(
        &mut self,
        field: &F,
        now: Instant,
        state: &F::State,
        t_end: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure>;

    /// Restarts after a jump, with the last step size but at most `limit`. With a fixed step size, the first step is at
    /// most `limit`, and the full step size is reached again within a few steps. Components of the state that equal
    /// those at the last cut keep the rounding errors recorded there.
    ///
    /// # Errors
    /// [`StepFailure`] where the vector field does not exist at the new state.
    fn restart(
        &mut self,
        field: &F,
        now: Instant,
        state: &F::State,
        limit: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure>;

    /// Makes one accepted step towards `t_end`, landing on it exactly when it is within reach. Failed trial steps are
    /// shortened here; only failures that persist at every step size are reported.
    ///
    /// # Errors
    /// [`StepFailure`]; the last good state is still [`Stepper::end_state`].
    fn step(&mut self, field: &F, t_end: f64, counters: &mut Counters) -> Result<(), StepFailure>;

    /// Estimated error of the last step divided by the tolerance; 0 without an estimate.
    fn error(&self) -> f64 {
        0.0
    }

    /// The fixed step of the present run; `None` with step-size control.
    fn fixed_step(&self) -> Option<f64> {
        None
    }

    /// Replaces the end of the last step by `state`, for a projection, and evaluates the rate there.
    ///
    /// # Errors
    /// [`StepFailure`] where the vector field does not exist at `state`.
    fn replace_end(
        &mut self,
        field: &F,
        state: &F::State,
        counters: &mut Counters,
    ) -> Result<(), StepFailure>;

    /// Time at the start of the last step.
    fn start_time(&self) -> Instant;

    /// Time at the end of the last step.
    fn end_time(&self) -> Instant;

    /// Time at the start of the last step, rounded.
    #[inline(always)]
    fn t_start(&self) -> f64 {
        self.start_time().t
    }

    /// Time at the end of the last step, rounded.
    #[inline(always)]
    fn t_end(&self) -> f64 {
        self.end_time().t
    }

    /// Length of the last step, correct even if it is shorter than a unit in the last place of its times.
    #[inline(always)]
    fn length(&self) -> f64 {
        self.end_time().since(self.start_time())
    }

    /// State at the start of the last step.
    fn start_state(&self) -> &F::State;

    /// State at the end of the last step.
    fn end_state(&self) -> &F::State;

    /// Rates at the start and at the end of the last step.
    fn end_rates(&self) -> [&F::State; 2];

    /// The power series of the last step; `None` if the step is no power series.
    fn series(&self) -> Option<Series> {
        None
    }

    /// Coefficient `k` of the power series of all gaps along the last step; empty without such series.
    fn gap_coefficient(&self, k: usize) -> &[f64] {
        let _ = k;
        &[]
    }

    /// The gaps at the end of the last step; empty if they have no power series.
    fn end_gaps(&self) -> &[f64] {
        &[]
    }

    /// True if the last step's dense output is ready.
    fn dense_ready(&self) -> bool;

    /// Prepares the last step's dense output, with its extra stages. Does nothing if it is ready.
    ///
    /// # Errors
    /// The [`Fault`] of an extra stage.
    fn prepare_dense(&mut self, field: &F, counters: &mut Counters) -> Result<(), Fault>;

    /// The state at `t_start + theta (t_end - t_start)`, for `theta` in \[0, 1\].
    ///
    /// Meaningful only while [`Stepper::dense_ready`].
    fn interpolate(&self, theta: f64) -> F::State;

    /// Writes the coefficients of the dense output in powers of the fraction of the step, and returns the degree.
    /// Coefficients above the degree are unchanged.
    ///
    /// Meaningful only while [`Stepper::dense_ready`].
    fn powers(&self, coefficients: &mut [F::State; LENGTH]) -> usize;

    /// For each component, the largest known difference between a rate inside the step and the rate of the cubic
    /// through its ends, times the length of the step. Dense output is not needed. `None` if no rates inside the step
    /// are known.
    fn sway(&self) -> Option<F::State> {
        None
    }

    /// Repeats the last step with a new length, close to `theta` times the present one, such that the gap at the end of
    /// the step is 0. `gap` returns a gap and its rate. True on success; otherwise the step is unchanged. Only methods
    /// whose dense output is less accurate than their steps, or that solve for impacts, succeed.
    fn meet(
        &mut self,
        field: &F,
        theta: f64,
        gap: &GapAt<'_, F::State>,
        counters: &mut Counters,
    ) -> bool {
        let _ = (field, theta, gap, counters);
        false
    }

    /// Changes `state`, the state after an elastic impact at the end of a step that [`Stepper::meet`] made: scales the
    /// jump of the law so that the discrete energies of the steps before and after the impact are equal. Without such a
    /// step, or if the jump is not an elastic impact, `state` is unchanged.
    fn rebound(
        &mut self,
        field: &F,
        rebound: &Rebound<'_, F::State>,
        state: &mut F::State,
        counters: &mut Counters,
    ) {
        let _ = (field, rebound, state, counters);
    }

    /// Time and state at the fraction of the step where the motion is cut. Call [`Stepper::prepare_dense`] first,
    /// unless `theta` is 1. Call [`Stepper::restart`] afterwards; integrators with compensated sums keep the rounding
    /// error of the state until then.
    fn cut(&mut self, theta: f64) -> (Instant, F::State) {
        match theta >= 1.0 {
            true => (self.end_time(), *self.end_state()),
            false => (
                self.start_time().after(theta * self.length()),
                self.interpolate(theta),
            ),
        }
    }
}

/// A gap and its rate at a time and a state.
pub type GapAt<'a, S> = dyn Fn(f64, &S) -> Result<(f64, f64), Fault> + 'a;

/// The energy at a time and a state.
pub type EnergyAt<'a, S> = dyn Fn(f64, &S) -> Result<f64, Fault> + 'a;

/// Data of the system and of the next step that [`Stepper::rebound`] needs.
pub struct Rebound<'a, S> {
    /// The longest step with which to continue.
    pub limit: f64,
    /// Number of components of the state before those of its velocities, momenta or quasi-velocities.
    pub motion_start: usize,
    /// The energy at a time and a state.
    pub energy: &'a EnergyAt<'a, S>,
}

/// A step as a power series in `s`, at time `t_start + unit s`.
#[derive(Debug, Clone, Copy)]
pub struct Series {
    /// Unit of time.
    pub unit: f64,
    /// Degree of the series.
    pub order: usize,
}

/// Reason why no step could be made.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum StepFailure {
    /// The error stays too large down to steps far shorter than the last digit of the time: a singularity of the
    /// motion.
    StepUnderflow {
        /// Time of the failure.
        t: f64,
    },
    /// The equations of an implicit step cannot be solved, not even in many small parts: the step is too long for the
    /// fastest motion of the system.
    NotConverged {
        /// Start of the step.
        t: f64,
    },
    /// The vector field does not exist, however short the step.
    Fault(Fault),
    /// The state or its rate is not finite, however short the step.
    NonFinite {
        /// First component that is not finite.
        component: usize,
    },
}

impl From<StepFailure> for Outcome {
    fn from(failure: StepFailure) -> Self {
        match failure {
            StepFailure::StepUnderflow { t } => Self::StepUnderflow { t },
            StepFailure::NotConverged { t } => Self::NotConverged { t },
            StepFailure::Fault(fault) => fault.into(),
            StepFailure::NonFinite { component } => Self::NonFinite { component },
        }
    }
}

impl fmt::Display for StepFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Outcome::from(*self).fmt(f)
    }
}

impl core::error::Error for StepFailure {}

impl From<Fault> for StepFailure {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}
