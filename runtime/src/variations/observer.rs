//! The observer that propagates first variations along a run.

use core::ops::ControlFlow;

use super::flow::Flow;
use super::held::Holder;
use super::transition::{self, Sequence};
use super::{Tangent, Undefined};
use crate::contract::Variational;
use crate::record::{Event, Hold, Observer, Segment};

/// Propagates first variations along the run that it observes.
///
/// The caller provides any number of directions, each with variations of state and parameters. Observe one run, then
/// call [`Variations::tangents`]. Any integrator may be used: the derivatives are computed by power series from the
/// states that it gives.
///
/// # Examples
///
/// ```
/// use dalembert::{Dop853, Scene, Simulation, StateVector, System, Tolerance, Variational, Variations};
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
/// // There is a direction for each component of the initial state.
/// let ball = Ball::default();
/// let state = ball.state(0.0, &[0.5].into(), &[0.0].into())?;
/// let mut directions = Ball::tangents();
/// for (k, direction) in directions.as_mut().iter_mut().enumerate() {
///     direction.state.as_mut_slice()[k] = 1.0;
/// }
/// let mut variations = Variations::new(&ball, directions.as_mut());
/// let integrator = Dop853::new(Tolerance::new(1e-12)?);
/// Simulation::new(&ball, integrator, ball.effects()).run(0.0, state, 1.5, &mut variations)?;
///
/// // Flow and impact keep the area of phase space.
/// let tangents = variations.tangents()?;
/// let [a, b] = [tangents[0].state, tangents[1].state];
/// assert!((a[0] * b[1] - a[1] * b[0] - 1.0).abs() < 1e-10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Variations<'a, Sys: Variational> {
    system: &'a Sys,
    tangents: &'a mut [Tangent<Sys>],
    flow: Flow<Sys>,
    /// The cause of held motion; `None` while the motion is free.
    holder: Option<Holder>,
    /// Transitions at one moment, and the holder before them. The holder after them is known only when the motion goes
    /// on.
    crossing: Option<(Sequence<Sys::State>, Option<Holder>)>,
    /// The end of the last stretch of motion.
    end: Option<Sys::State>,
    undefined: Option<Undefined>,
}

impl<'a, Sys: Variational> Variations<'a, Sys> {
    /// Variations of the next run, from these directions.
    pub fn new(system: &'a Sys, tangents: &'a mut [Tangent<Sys>]) -> Self {
        Self {
            system,
            tangents,
            flow: Flow::new(system),
            holder: None,
            crossing: None,
            end: None,
            undefined: None,
        }
    }

    /// The derivatives at the end of the observed run.
    ///
    /// # Errors
    /// [`Undefined`] for the first place at which the run has no derivative.
    pub fn tangents(&mut self) -> Result<&[Tangent<Sys>], Undefined> {
        self.go_on();
        match self.undefined {
            Some(undefined) => Err(undefined),
            None => Ok(self.tangents),
        }
    }

    /// Projects the directions, which are at a fixed time, along the motion onto the surface that is met.
    pub(super) fn arrive(&mut self, event: &Event<Sys::State>) {
        self.go_on();
        if self.undefined.is_none() {
            let (flow, holder) = (&mut self.flow, self.holder);
            let arrived = transition::arrive(self.system, event, holder, flow, self.tangents);
            self.undefined = arrived.err();
        }
    }

    /// Propagates the directions across the last transitions, unless the run had no derivative at an earlier place.
    fn go_on(&mut self) {
        if let Some((sequence, before)) = self.crossing.take()
            && self.undefined.is_none()
        {
            self.undefined = self.cross(&sequence, [before, self.holder]).err();
        }
    }

    fn cross(
        &mut self,
        sequence: &Sequence<Sys::State>,
        holders: [Option<Holder>; 2],
    ) -> Result<(), Undefined> {
        let (system, last) = (self.system, sequence.last());
        let t = last.t;
        if let [Some(holder), Some(_)] = holders {
            // The result of the impact depends on the surface that holds the motion.
            return Err(holder.undefined(t));
        }
        transition::cross(system, sequence, holders, &mut self.flow, self.tangents)?;
        match holders[1] {
            Some(holder) => holder.check_along(system, t, &last.after, self.tangents),
            None => Ok(()),
        }
    }

    /// Processes the beginning or end of held motion.
    fn turn(&mut self, hold: &Hold<Sys::State>) -> Result<(), Undefined> {
        let (system, t) = (self.system, hold.t);
        let holder = Holder::of(hold);
        let held = core::mem::replace(&mut self.holder, hold.begins.then_some(holder));
        let crosses = self.crossing.is_some();
        match (held, hold.begins) {
            (None, true) if hold.accumulation.is_some() => Err(holder.undefined(t)),
            (None, true) if crosses => Ok(()),
            // The surface holds the motion from the start of the run.
            (None, true) if self.end.is_none() => {
                holder.check_along(system, t, &hold.state, self.tangents)
            }
            (Some(held), false) if held == holder => match &self.end {
                Some(end) if !crosses => {
                    let ends = [end, &hold.state];
                    self.flow.check_release(system, holder, t, ends)
                }
                _ => Ok(()),
            },
            _ => Err(holder.undefined(t)),
        }
    }
}

impl<Sys: Variational> Observer<Sys> for Variations<'_, Sys> {
    fn step(&mut self, segment: &mut Segment<'_, Sys::State>) -> ControlFlow<()> {
        self.go_on();
        if self.undefined.is_none() {
            let followed = self
                .flow
                .follow(self.system, self.holder, segment, self.tangents);
            self.undefined = followed.err();
        }
        self.end = Some(*segment.end());
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<Sys::State>) -> ControlFlow<()> {
        let follows = |(sequence, _): &mut (Sequence<_>, _)| sequence.add(event);
        if !self.crossing.as_mut().is_some_and(follows) {
            self.go_on();
            self.crossing = Some((Sequence::of(event), self.holder));
        }
        ControlFlow::Continue(())
    }

    fn hold(&mut self, hold: &Hold<Sys::State>) -> ControlFlow<()> {
        if self.undefined.is_none() {
            self.undefined = self.turn(hold).err();
        }
        ControlFlow::Continue(())
    }
}
