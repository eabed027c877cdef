//! The step interface: all that the driver knows of an integrator.

use core::fmt;

use super::instant::Instant;
use super::stats::Counters;
use super::tolerance::Tolerance;
use crate::contract::VectorField;
use crate::error::Fault;
use crate::jet::LENGTH;
use crate::outcome::Outcome;

/// A one-step integrator with dense output, whether it chooses its steps by an error estimate or keeps a size.
///
/// After [`Stepper::start`], every [`Stepper::step`] makes one accepted step from the end of the last one. Both
/// ends of the step stay readable until the next; states between them are had from [`Stepper::interpolate`] after
/// [`Stepper::prepare_dense`].
pub trait Stepper<F: VectorField> {
    /// Name, as the command line writes it.
    fn name(&self) -> &'static str;

    /// The tolerance it was made with.
    fn tolerance(&self) -> Tolerance;

    /// The longest step it may choose; infinite without a limit, and where it keeps a size.
    fn max_step(&self) -> f64 {
        f64::INFINITY
    }

    /// Begins at `(now, state)`, heading for `t_end`: finds a first step size.
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

    /// Begins again after a jump, with the step size known so far but none larger than `limit`. An integrator that
    /// keeps a size goes back to it within a few steps. Components of the state that are those of the last cut keep what they
    /// were rounded off there.
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

    /// Makes one accepted step towards `t_end`, landing on it exactly when it is in reach. Trial steps that fail
    /// are shortened here; only what no step size cures is reported.
    ///
    /// # Errors
    /// [`StepFailure`]; the last good state is still [`Stepper::end_state`].
    fn step(&mut self, field: &F, t_end: f64, counters: &mut Counters) -> Result<(), StepFailure>;

    /// The error that the last step is estimated to have made, as a part of the tolerance; 0 where it is not estimated.
    fn error(&self) -> f64 {
        0.0
    }

    /// The size this integrator keeps in the run at hand; `None` if it chooses every step anew.
    fn fixed_step(&self) -> Option<f64> {
        None
    }

    /// Takes `state` for the end of the last step, as a projection does, and evaluates the rate there anew.
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

    /// Length of the last step, also of one that is shorter than a unit in the last place of its times.
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

    /// The power series that the last step is made of, where it is.
    fn series(&self) -> Option<Series> {
        None
    }

    /// Coefficient `k` of the power series of all gaps along the last step; nothing where there are none.
    fn gap_coefficient(&self, k: usize) -> &[f64] {
        let _ = k;
        &[]
    }

    /// The gaps at the end of the last step, where they have power series.
    fn end_gaps(&self) -> &[f64] {
        &[]
    }

    /// Whether the last step's dense output is ready.
    fn dense_ready(&self) -> bool;

    /// Makes the last step's dense output ready, with what extra stages it takes; does nothing if it is.
    ///
    /// # Errors
    /// The [`Fault`] of an extra stage.
    fn prepare_dense(&mut self, field: &F, counters: &mut Counters) -> Result<(), Fault>;

    /// The state at `t_start + theta (t_end - t_start)`, for `theta` in \[0, 1\].
    ///
    /// Meaningful only while [`Stepper::dense_ready`].
    fn interpolate(&self, theta: f64) -> F::State;

    /// Writes the coefficients of the dense output in powers of the part of the step, and returns the number of the last one. Those
    /// above it are left as they are.
    ///
    /// Meaningful only while [`Stepper::dense_ready`].
    fn powers(&self, coefficients: &mut [F::State; LENGTH]) -> usize;

    /// How far rates along the step, times its length, are from those of the cubic through its ends, as far as rates are
    /// known without dense output; `None` where none are known inside the step.
    fn sway(&self) -> Option<F::State> {
        None
    }

    /// Makes the last step again with the length at which its end has gap 0, near this part of it. `gap` gives a gap and its
    /// rate. Returns whether that is done; the step is as it was otherwise. Only methods that solve for impacts do it.
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

    /// Scales the jump from the end of the step that [`Stepper::meet`] made to `state`, so that the discrete energy of the
    /// step that arrives is that of the step that departs. Without such a step, or where the jump is no elastic impact,
    /// `state` stays as it is.
    fn rebound(
        &mut self,
        field: &F,
        rebound: &Rebound<'_, F::State>,
        state: &mut F::State,
        counters: &mut Counters,
    ) {
        let _ = (field, rebound, state, counters);
    }

    /// Time and state at a part of the step where the motion is cut; after [`Stepper::prepare_dense`], unless it is the end.
    /// [`Stepper::restart`] follows. What the state is rounded off is kept until then by integrators that carry it.
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

/// An elastic impact in a step of fixed size, and the energy that motion keeps.
pub struct Rebound<'a, S> {
    /// The longest step to go on with.
    pub limit: f64,
    /// Components of the state before those that hold its motion.
    pub motion_start: usize,
    /// The energy at a time and a state.
    pub energy: &'a EnergyAt<'a, S>,
}

/// That a step is a power series in `s`, at time `t_start + unit s`.
#[derive(Debug, Clone, Copy)]
pub struct Series {
    /// Unit of time.
    pub unit: f64,
    /// Number of the last coefficient.
    pub order: usize,
}

/// Why no step could be made.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum StepFailure {
    /// The error stays too large down to steps far shorter than the last digit of the time: a singularity of the motion.
    StepUnderflow {
        /// Where.
        t: f64,
    },
    /// The equations of an implicit step cannot be solved, not even in many small parts: the step is too long for the
    /// fastest motion of the system.
    NotConverged {
        /// Start of the step.
        t: f64,
    },
    /// The vector field does not exist in whatever short step.
    Fault(Fault),
    /// The state or its rate is not finite in whatever short step.
    NonFinite {
        /// First component concerned.
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
