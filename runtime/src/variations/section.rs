//! Poincare sections: states that arrive at a surface, and the map from one arrival to a later one.

use core::fmt;
use core::ops::ControlFlow;

use super::group::Group;
use super::transition::gap_rate;
use super::{Tangent, Undefined, Variations};
use crate::contract::Variational;
use crate::effects::Effect;
use crate::integrate::Stepper;
use crate::numbers::Row;
use crate::outcome::{Outcome, StartError};
use crate::record::{Event, Hold, Observer, Segment};
use crate::simulation::Simulation;

/// A surface of a system as a Poincare section of its motion, with the settings of the runs between its points.
///
/// A point of the section is a state *at* the surface *before* the transition there. The map carries it through the
/// transition and on to the requested return to the surface; other surfaces may be met on the way. For a section that
/// is not a wall, declare a surface with the law `reset { }`.
///
/// # Examples
///
/// ```
/// use dalembert::{Scene, Section, System, Taylor, Tolerance};
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
/// // From the height 1/2 the ball reaches the floor at the time 1, and again 2 units of time later.
/// let ball = Ball::default();
/// let start = ball.state(0.0, &[0.5].into(), &[0.0].into())?;
/// let integrator = Taylor::new(Tolerance::new(1e-13)?);
/// let mut section = Section::new(&ball, integrator, ball.effects(), 0, 10.0);
/// let first = section.arrive(&start, &mut [])?;
/// let second = section.next(&first.before, &mut [])?;
/// assert!((first.time - 1.0).abs() < 1e-12 && (second.time - 2.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Section<'a, Sys: Variational, Step, Effects> {
    pub(super) system: &'a Sys,
    simulation: Simulation<'a, Sys, Step, Effects>,
    pub(super) surface: usize,
    pub(super) returns: u32,
    horizon: f64,
    /// The group of symmetries, if orbits need to close only up to one of its elements.
    pub(super) group: Option<&'a dyn Group>,
    /// Relative tolerance of the integrator.
    pub(super) tolerance: f64,
}

/// An arrival at a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrival<S> {
    /// Time since the start of the run.
    pub time: f64,
    /// The point of the section: the state at the surface, before the transition there.
    pub before: S,
    /// The state after the transition.
    pub after: S,
}

impl<S: Copy> Arrival<S> {
    pub(super) fn of(time: f64, event: &Event<S>) -> Self {
        Self {
            time,
            before: event.before,
            after: event.after,
        }
    }
}

/// Reason why a section is not reached.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SectionError {
    /// The run cannot begin.
    Start(StartError),
    /// The run ended before the section; [`Outcome::Done`] means that the allowed time was over.
    Ended(Outcome),
    /// The run reaches the section, but has no derivative.
    Undefined(Undefined),
}

impl fmt::Display for SectionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start(error) => error.fmt(f),
            Self::Ended(Outcome::Done) => {
                write!(f, "the section is not met within the time allowed")
            }
            Self::Ended(outcome) => {
                write!(f, "the run ended before the section was met: {outcome}")
            }
            Self::Undefined(undefined) => undefined.fmt(f),
        }
    }
}

impl core::error::Error for SectionError {}

impl From<Undefined> for SectionError {
    fn from(undefined: Undefined) -> Self {
        Self::Undefined(undefined)
    }
}

impl<'a, Sys, Step, Effects> Section<'a, Sys, Step, Effects>
where
    Sys: Variational,
    Step: Stepper<Sys>,
    Effects: Effect<Sys>,
{
    /// The section at the surface with index `surface`. Runs use `stepper` and `effects`. One application of the map,
    /// or the way to a first arrival, may take at most the time `horizon`.
    pub fn new(
        system: &'a Sys,
        stepper: Step,
        effects: Effects,
        surface: usize,
        horizon: f64,
    ) -> Self {
        let tolerance = stepper.tolerance().relative();
        Self {
            system,
            tolerance,
            simulation: Simulation::new(system, stepper, effects),
            surface,
            returns: 1,
            horizon,
            group: None,
        }
    }

    /// Sets the number of returns, 1 or more, in one application of the map.
    #[must_use]
    pub fn with_returns(mut self, returns: u32) -> Self {
        self.returns = returns.max(1);
        self
    }

    /// Lets orbits close up to an element of a group of symmetries of the motion, of all surfaces and of their laws.
    #[must_use]
    pub fn modulo(mut self, group: &'a dyn Group) -> Self {
        self.group = Some(group);
        self
    }

    /// The first arrival from a state that need not lie on the section. `tangents`, in any directions, become the
    /// derivatives of the point of arrival.
    ///
    /// # Errors
    /// [`SectionError`] where the run cannot begin, ends before the section, or has no derivative.
    pub fn arrive(
        &mut self,
        state: &Sys::State,
        tangents: &mut [Tangent<Sys>],
    ) -> Result<Arrival<Sys::State>, SectionError> {
        let passed = self.pass(state, 0, tangents)?;
        Ok(Arrival::of(passed.time, &passed.event))
    }

    /// The image of a point of the section under the Poincare map. `tangents`, directions along the section, become
    /// their images.
    ///
    /// The images are derivatives of the map, and also lie along the section. Along parameters they are derivatives of
    /// the image of a fixed starting point.
    ///
    /// # Errors
    /// [`SectionError`] where the run cannot begin, ends before the section, or has no derivative.
    pub fn next(
        &mut self,
        point: &Sys::State,
        tangents: &mut [Tangent<Sys>],
    ) -> Result<Arrival<Sys::State>, SectionError> {
        let passed = self.pass(point, self.returns, tangents)?;
        Ok(Arrival::of(passed.time, &passed.event))
    }

    /// Runs until arrival number `returns + 1` at the surface.
    pub(super) fn pass(
        &mut self,
        state: &Sys::State,
        returns: u32,
        tangents: &mut [Tangent<Sys>],
    ) -> Result<Passed<Sys>, SectionError> {
        let mut passage = Passage {
            system: self.system,
            variations: Variations::new(self.system, tangents),
            surface: self.surface,
            left: returns,
            first: None,
            last: None,
            itinerary: Itinerary::new(),
        };
        // NOTE: the observer is a trait object, so that the driver is compiled once for all observers.
        let mut observer: &mut dyn Observer<Sys> = &mut passage;
        let run = self
            .simulation
            .run(0.0, *state, self.horizon, &mut observer)
            .map_err(SectionError::Start)?;
        let Some(last) = passage.last else {
            return Err(SectionError::Ended(run.outcome));
        };
        passage.variations.tangents()?;
        let delay = passage.first.unwrap_or(0.0);
        Ok(Passed {
            delay,
            time: last.t - delay,
            event: last,
            itinerary: passage.itinerary,
        })
    }
}

/// A run from one arrival to another.
pub(super) struct Passed<Sys: Variational> {
    /// Time of the first arrival at the surface; 0 if the first arrival is the last one.
    pub(super) delay: f64,
    /// Duration from `delay` to the last arrival.
    pub(super) time: f64,
    /// The last arrival.
    pub(super) event: Event<Sys::State>,
    pub(super) itinerary: Itinerary<Sys>,
}

/// Arrivals of a run at each surface, by its index.
pub struct Itinerary<Sys: Variational> {
    /// Number of arrivals at each surface.
    pub arrivals: Sys::Clearances<f64>,
    /// Least speed with which the gap of each surface falls at an arrival; infinite without an arrival.
    pub speeds: Sys::Clearances<f64>,
}

impl<Sys: Variational> Clone for Itinerary<Sys> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<Sys: Variational> Copy for Itinerary<Sys> {}

impl<Sys: Variational> Itinerary<Sys> {
    fn new() -> Self {
        let zeros = || Sys::Clearances::<f64>::zeros(Sys::Clearances::<f64>::CAPACITY);
        let mut speeds = zeros();
        speeds.as_mut_slice().fill(f64::INFINITY);
        Self {
            arrivals: zeros(),
            speeds,
        }
    }

    fn add(&mut self, system: &Sys, event: &Event<Sys::State>) {
        if let Some(count) = self.arrivals.as_mut_slice().get_mut(event.surface) {
            *count += 1.0;
        }
        let mut rate = system.zero_state();
        let falling = system
            .rate(event.t, &event.before, &mut rate)
            .and_then(|()| gap_rate(system, event, &rate));
        let least = self.speeds.as_mut_slice().get_mut(event.surface);
        if let (Some(least), Ok(rate)) = (least, falling) {
            *least = f64::min(*least, -rate);
        }
    }
}

/// Observes a run from one arrival to another.
struct Passage<'a, Sys: Variational> {
    system: &'a Sys,
    variations: Variations<'a, Sys>,
    surface: usize,
    /// Number of arrivals before the requested one.
    left: u32,
    /// Time of the first arrival at the surface.
    first: Option<f64>,
    last: Option<Event<Sys::State>>,
    itinerary: Itinerary<Sys>,
}

impl<Sys: Variational> Observer<Sys> for Passage<'_, Sys> {
    fn step(&mut self, segment: &mut Segment<'_, Sys::State>) -> ControlFlow<()> {
        self.variations.step(segment)
    }

    fn event(&mut self, event: &Event<Sys::State>) -> ControlFlow<()> {
        self.itinerary.add(self.system, event);
        if event.surface != self.surface {
            return self.variations.event(event);
        }
        if self.left == 0 {
            self.variations.arrive(event);
            self.last = Some(*event);
            return ControlFlow::Break(());
        }
        self.left -= 1;
        self.first.get_or_insert(event.t);
        self.variations.event(event)
    }

    fn hold(&mut self, hold: &Hold<Sys::State>) -> ControlFlow<()> {
        self.variations.hold(hold)
    }
}
