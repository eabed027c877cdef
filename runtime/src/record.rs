//! Observation of a run: its smooth segments, and the impacts between them.

use core::ops::ControlFlow;

use crate::contract::System;
use crate::error::Fault;
use crate::jet::LENGTH;
use crate::law::Law;

/// An impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event<S> {
    /// Time of the impact.
    pub t: f64,
    /// Index of the surface.
    pub surface: usize,
    /// The law that was applied.
    pub law: Law,
    /// State just before the impact.
    pub before: S,
    /// State just after the impact.
    pub after: S,
    /// True if another surface was hit at the same time. Simultaneous impacts are recorded one by one, in the order in
    /// which they act.
    pub simultaneous: bool,
    /// True for a grazing impact, which may be decided by rounding, or by the local error if the integrator estimates
    /// it.
    pub graze: bool,
}

/// The state comes to rest on a surface or leaves it, or sliding between two modes begins or ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold<S> {
    /// Time.
    pub t: f64,
    /// Index of the surface. For sliding between two modes: index of the transition that was taken.
    pub surface: usize,
    /// For sliding between two modes: the transition that leads back. The state belongs to the mode that this
    /// transition leaves.
    pub back: Option<usize>,
    /// The state, on the surface.
    pub state: S,
    /// True if the surface holds the motion from this time on, false if it releases the motion.
    pub begins: bool,
    /// Time at which impacts on the surface accumulate, extrapolated from the last hops; `None` if no accumulation led
    /// to this hold.
    pub accumulation: Option<f64>,
}

/// A segment of smooth motion, from the start of a step to its end or to the impact that cuts it.
pub struct Segment<'a, S> {
    pub(crate) t: [f64; 2],
    pub(crate) end: &'a S,
    /// Length of the whole step, and the fraction of it that the segment covers.
    pub(crate) step: f64,
    pub(crate) part: f64,
    pub(crate) source: &'a mut dyn Interpolant<S>,
}

/// Dense output of the step of a segment.
pub(crate) trait Interpolant<S> {
    /// The state at the start of the step.
    fn start(&self) -> &S;

    /// State at a fraction `theta` of the step.
    fn at(&mut self, theta: f64) -> Result<S, Fault>;

    /// Writes the coefficients of the dense output in powers of the fraction of the step. Returns the degree.
    fn powers(&mut self, coefficients: &mut [S; LENGTH]) -> Result<usize, Fault>;
}

impl<S: Copy> Segment<'_, S> {
    /// Time at the start.
    pub fn t_start(&self) -> f64 {
        self.t[0]
    }

    /// Time at the end.
    pub fn t_end(&self) -> f64 {
        self.t[1]
    }

    /// State at the start. After an impact this is the post-impact state.
    pub fn start(&self) -> &S {
        self.source.start()
    }

    /// State at the end. At an impact this is the pre-impact state.
    pub fn end(&self) -> &S {
        self.end
    }

    /// State at time `t`, from the dense output of the integrator. Times outside of the segment are replaced by its
    /// nearer end.
    ///
    /// The first call with a time strictly inside a step computes the dense output of the step.
    ///
    /// # Errors
    /// The [`Fault`] of an extra stage of the dense output.
    pub fn at(&mut self, t: f64) -> Result<S, Fault> {
        if t >= self.t[1] {
            return Ok(*self.end);
        }
        if t > self.t[0] {
            return self.source.at((t - self.t[0]) / self.step);
        }
        Ok(*self.source.start())
    }

    /// Length of the step that the segment belongs to.
    pub(crate) fn step_length(&self) -> f64 {
        self.step
    }

    /// Fraction of the step that the segment covers, in full precision.
    pub(crate) fn part(&self) -> f64 {
        self.part
    }

    /// Writes the coefficients of the dense output in powers of the fraction of the step. Returns the degree.
    pub(crate) fn powers(&mut self, coefficients: &mut [S; LENGTH]) -> Result<usize, Fault> {
        self.source.powers(coefficients)
    }
}

/// Observer of a run. Every method may stop the run by returning [`ControlFlow::Break`]. The run then ends with
/// [`Outcome::Stopped`](crate::Outcome::Stopped).
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
///
/// use dalembert::{Dop853, Event, Observer, Outcome, Scene, Simulation, System, Tolerance, VectorField};
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
/// /// Stops the run at its third impact.
/// #[derive(Default)]
/// struct Third(u32);
///
/// impl Observer<Ball> for Third {
///     fn event(&mut self, _event: &Event<<Ball as VectorField>::State>) -> ControlFlow<()> {
///         self.0 += 1;
///         match self.0 {
///             3 => ControlFlow::Break(()),
///             _ => ControlFlow::Continue(()),
///         }
///     }
/// }
///
/// // The fall from 1/2 takes the time 1.
/// let ball = Ball::default();
/// let state = ball.state(0.0, &[0.5].into(), &[0.0].into())?;
/// let mut simulation = Simulation::new(&ball, Dop853::new(Tolerance::new(1e-12)?), ball.effects());
/// let run = simulation.run(0.0, state, 100.0, &mut Third::default())?;
/// assert_eq!(run.outcome, Outcome::Stopped);
/// assert!((run.t - 5.0).abs() < 1e-10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Observer<Sys: System> {
    /// Called after each segment of smooth motion. Segments follow each other without gaps; impacts take place between
    /// them.
    fn step(&mut self, segment: &mut Segment<'_, Sys::State>) -> ControlFlow<()> {
        let _ = segment;
        ControlFlow::Continue(())
    }

    /// Called after an impact.
    fn event(&mut self, event: &Event<Sys::State>) -> ControlFlow<()> {
        let _ = event;
        ControlFlow::Continue(())
    }

    /// Called when a surface begins or ceases to hold the motion.
    fn hold(&mut self, hold: &Hold<Sys::State>) -> ControlFlow<()> {
        let _ = hold;
        ControlFlow::Continue(())
    }
}

/// The empty observer.
impl<Sys: System> Observer<Sys> for () {}

impl<Sys: System, O: Observer<Sys> + ?Sized> Observer<Sys> for &mut O {
    fn step(&mut self, segment: &mut Segment<'_, Sys::State>) -> ControlFlow<()> {
        (**self).step(segment)
    }

    fn event(&mut self, event: &Event<Sys::State>) -> ControlFlow<()> {
        (**self).event(event)
    }

    fn hold(&mut self, hold: &Hold<Sys::State>) -> ControlFlow<()> {
        (**self).hold(hold)
    }
}

/// Two observers, called one after the other. Each may stop the run; the second is not called then.
impl<Sys: System, A: Observer<Sys>, B: Observer<Sys>> Observer<Sys> for (A, B) {
    fn step(&mut self, segment: &mut Segment<'_, Sys::State>) -> ControlFlow<()> {
        self.0.step(segment)?;
        self.1.step(segment)
    }

    fn event(&mut self, event: &Event<Sys::State>) -> ControlFlow<()> {
        self.0.event(event)?;
        self.1.event(event)
    }

    fn hold(&mut self, hold: &Hold<Sys::State>) -> ControlFlow<()> {
        self.0.hold(hold)?;
        self.1.hold(hold)
    }
}

/// Observer that keeps the first `CAP` impacts of a run and counts all of them.
///
/// # Examples
///
/// ```
/// use dalembert::{Dop853, EventLog, Scene, Simulation, System, Tolerance};
///
/// # dalembert::model! {
/// #     pub Ball {
/// #         coordinates { x; }
/// #         lagrangian = dot(x)^2/2 - x;
/// #         impacts { floor: x >= 0; }
/// #         initial { x = 1; }
/// #     }
/// # }
///
/// let ball = Ball::default();
/// let state = ball.state(0.0, &[0.5].into(), &[0.0].into())?;
/// let mut log = EventLog::<_, 2>::new();
/// let integrator = Dop853::new(Tolerance::new(1e-12)?);
/// Simulation::new(&ball, integrator, ball.effects()).run(0.0, state, 6.0, &mut log)?;
/// assert_eq!((log.iter().count(), log.seen()), (2, 3));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct EventLog<S, const CAP: usize> {
    events: [Option<Event<S>>; CAP],
    seen: usize,
}

impl<S: Copy, const CAP: usize> EventLog<S, CAP> {
    /// An empty log.
    pub const fn new() -> Self {
        Self {
            events: [None; CAP],
            seen: 0,
        }
    }

    /// The recorded impacts, in order of time.
    pub fn iter(&self) -> impl Iterator<Item = &Event<S>> {
        self.events.iter().flatten()
    }

    /// Number of impacts in the run.
    pub const fn seen(&self) -> usize {
        self.seen
    }

    /// Number of impacts that were not recorded because the log was full.
    pub const fn dropped(&self) -> usize {
        self.seen.saturating_sub(CAP)
    }
}

impl<S: Copy, const CAP: usize> Default for EventLog<S, CAP> {
    fn default() -> Self {
        Self::new()
    }
}

impl<Sys: System, const CAP: usize> Observer<Sys> for EventLog<Sys::State, CAP> {
    fn event(&mut self, event: &Event<Sys::State>) -> ControlFlow<()> {
        if let Some(slot) = self.events.get_mut(self.seen) {
            *slot = Some(*event);
        }
        self.seen += 1;
        ControlFlow::Continue(())
    }
}
