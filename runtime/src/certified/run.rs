//! Certified runs: smooth motion and impacts by turns.

use core::ops::ControlFlow;

use super::course::{Course, Met, Side, Sides, Surfaces};
use super::crossing::{Crossed, cross};
use super::flow::{CertifiedFlow, ORDER, Step};
use super::frame::Bounds;
use super::lost::{Lost, Reason};
use crate::contract::{Impacting, Variational};
use crate::error::Fault;
use crate::impacts::law::Law;
use crate::impacts::override_table::Overrides;
use crate::numbers::{Interval, Row};
use crate::state::StateVector;
use crate::variations::transition::Strike;

/// How far before an impact it is approached: parts of a step, each tried after the last.
const MARGINS: [f64; 4] = [
    1.0 / (1_u64 << 40) as f64,
    1.0 / (1_u64 << 32) as f64,
    1.0 / (1_u64 << 22) as f64,
    1.0 / (1_u64 << 12) as f64,
];

/// An impact that every motion of a box has.
pub struct CertifiedImpact<Sys: Variational> {
    /// The surface, by its place in the declaration.
    pub surface: usize,
    /// All times of the impact.
    pub time: Interval,
    before: Bounds<Sys::State>,
    after: Bounds<Sys::State>,
}

impl<Sys: Variational> CertifiedImpact<Sys> {
    /// All values of component `i` of the state that arrives.
    pub fn before(&self, i: usize) -> Interval {
        self.before.at(i)
    }

    /// All values of component `i` of the state after the impact, at the time of the impact.
    pub fn after(&self, i: usize) -> Interval {
        self.after.at(i)
    }
}

/// A box of states that is followed through time and impacts.
///
/// Every surface is enclosed along every step. An impact is certified if every motion of the box meets the same surface once,
/// transversally, and no other surface at about that time; then the declared law, or the one chosen for the run, is applied to all of
/// them. What cannot be proved ends the run as [`Lost`], which says what that is.
///
/// ```
/// use core::ops::ControlFlow;
///
/// use dalembert::certified::CertifiedRun;
/// use dalembert::model;
/// use dalembert::numbers::Interval;
///
/// model! {
///     /// A ball over a floor that takes half of its speed.
///     pub Ball {
///         coordinates { x; }
///         lagrangian = dot(x)^2/2 - x;
///         impacts { floor: x >= 0 => newton(1/2); }
///     }
/// }
///
/// let ball = Ball {};
/// let start = [0.5, 0.0];
/// let mut run = CertifiedRun::new(&ball, 0.0, |i| Interval::point(start[i]));
/// let mut times = [Interval::point(0.0); 2];
/// run.run(2.5, |impact| {
///     times[run_index(impact.time)] = impact.time;
///     ControlFlow::Continue(())
/// })?;
/// // It falls for the time 1, and flies for the time 1 after that.
/// assert!(times[0].contains(Interval::point(1.0)) && times[0].width() < 1e-15);
/// assert!(times[1].contains(Interval::point(2.0)) && times[1].width() < 1e-14);
/// # fn run_index(time: Interval) -> usize { usize::from(time.lo > 1.5) }
/// # Ok::<(), dalembert::certified::Lost>(())
/// ```
pub struct CertifiedRun<'a, Sys: Variational + Impacting> {
    flow: CertifiedFlow<'a, Sys>,
    laws: Overrides<<Sys as Impacting>::Gaps>,
    sides: Sides<Sys>,
    is_begun: bool,
    impacts: u64,
}

impl<'a, Sys: Variational + Impacting> CertifiedRun<'a, Sys> {
    /// Begins at the time `t` with all states whose component `i` lies in `start(i)`.
    pub fn new(system: &'a Sys, t: f64, start: impl Fn(usize) -> Interval) -> Self {
        Self {
            flow: CertifiedFlow::new(system, t, start),
            laws: Overrides::none(),
            sides: Sides::unknown(),
            is_begun: false,
            impacts: 0,
        }
    }

    /// With all values in a range for a parameter, as [`CertifiedFlow::with_parameter`] takes it.
    #[must_use]
    pub fn with_parameter(mut self, index: usize, range: Interval) -> Self {
        self.flow = self.flow.with_parameter(index, range);
        self
    }

    /// With another law that is an impulse for a surface; one past the end changes nothing.
    #[must_use]
    pub fn with_law(mut self, surface: usize, law: Law) -> Self {
        self.laws.set(surface, law);
        self
    }

    /// The time that was reached.
    pub fn t(&self) -> f64 {
        self.flow.t
    }

    /// Steps made so far.
    pub fn steps(&self) -> u64 {
        self.flow.steps()
    }

    /// Impacts so far.
    pub fn impacts(&self) -> u64 {
        self.impacts
    }

    /// All values that component `i` of the state may have now.
    pub fn component(&self, i: usize) -> Interval {
        self.flow.component(i)
    }

    /// The width of the widest component.
    pub fn width(&self) -> f64 {
        self.flow.width()
    }

    /// All positions and velocities that the state may have now, as [`CertifiedFlow::velocities`] gives them.
    ///
    /// # Errors
    /// [`Fault`] where a velocity may not exist.
    pub fn velocities(&self) -> Result<Sys::Configuration<Interval>, Fault> {
        self.flow.velocities()
    }

    /// Follows the motion to the time `t_end`, or until `observer` breaks after an impact.
    ///
    /// # Errors
    /// [`Lost`]; the box is that of the time up to which the motion is certified.
    pub fn run(
        &mut self,
        t_end: f64,
        mut observer: impl FnMut(&CertifiedImpact<Sys>) -> ControlFlow<()>,
    ) -> Result<(), Lost> {
        while let Some(impact) = self.next_impact(t_end)? {
            if observer(&impact).is_break() {
                break;
            }
        }
        Ok(())
    }

    /// Follows the motion to a time just after its next impact, or to the time `t_end` if there is none before.
    ///
    /// # Errors
    /// As [`CertifiedRun::run`].
    pub fn next_impact(&mut self, t_end: f64) -> Result<Option<CertifiedImpact<Sys>>, Lost> {
        self.begin();
        while self.flow.t < t_end {
            let step = self.flow.prepare(t_end)?;
            match self.watched(&self.flow, &step) {
                Ok(sides) => {
                    self.flow.make(&step);
                    self.sides = sides;
                }
                Err(met) => {
                    let impact = self.meet(&step, met, t_end);
                    let t = self.flow.t;
                    let impact = impact.map_err(|reason| Lost { t, reason })?;
                    if impact.is_some() {
                        return Ok(impact);
                    }
                }
            }
        }
        Ok(None)
    }

    /// At the start, surfaces at which the gap is exactly 0 are known to be left or entered.
    fn begin(&mut self) {
        if core::mem::replace(&mut self.is_begun, true) {
            return;
        }
        let (now, hull) = (Interval::point(self.flow.t), self.flow.frame.hull());
        let Some(gaps) = self.flow.field.gaps_at(now, &hull) else {
            return;
        };
        for (surface, gap) in gaps.as_slice().iter().enumerate() {
            if gap.lo >= 0.0 {
                self.sides.set(surface, Side::Above);
            } else if gap.hi <= 0.0 {
                self.sides.set(surface, Side::Below);
            }
        }
    }

    /// What may be met in a step of a flow, or the sides of all surfaces at its end.
    fn watched(&self, flow: &CertifiedFlow<'a, Sys>, step: &Step<Sys>) -> Result<Sides<Sys>, Met> {
        let (now, hull) = (Interval::point(flow.t), flow.frame.hull());
        let (tube, length) = (&step.tube, step.length);
        let course = Course::new(&flow.field, &hull, tube, now, length, ORDER);
        match course {
            Some(course) => self.surfaces(flow).passed(&course, &self.sides),
            None => Err(Met {
                surface: 0,
                reason: Reason::NoTube,
                at: 0.0,
            }),
        }
    }

    fn surfaces<'f>(&self, flow: &'f CertifiedFlow<'a, Sys>) -> Surfaces<'f, 'a, Sys> {
        let field = &flow.field;
        let mut passable = <Sys as Impacting>::Gaps::zeros();
        for (surface, entry) in passable.as_mut_slice().iter_mut().enumerate() {
            let law = self.laws.get(surface);
            let is_map = law.is_none_or(|law| law.is_map());
            let is_passable = is_map && field.system.is_passable(surface);
            *entry = f64::from(u8::from(is_passable));
        }
        Surfaces { field, passable }
    }

    /// Crosses the surface that may be met in a step; `None` where the motion was only brought nearer to it, or to `t_end`.
    fn meet(
        &mut self,
        step: &Step<Sys>,
        met: Met,
        t_end: f64,
    ) -> Result<Option<CertifiedImpact<Sys>>, Reason> {
        let mut last = met.at == 0.0;
        let mut reason = met.reason;
        let mut nearest = None;
        for margin in MARGINS {
            let part = met.at - margin * f64::max(met.at, 1.0 / 1024.0);
            let t = (Interval::point(self.t()) + step.length * Interval::point(part)).lo;
            last |= t <= self.t();
            let Some((flow, sides)) = self.brought_to(if last { self.t() } else { t }) else {
                continue;
            };
            let is_behind = matches!(met.reason, Reason::MayBeBehind { .. });
            let crossed = match is_behind {
                true => Err(met.reason),
                false => self.crossed(&flow, met.surface, &sides),
            };
            match crossed {
                Ok((surface, crossed)) => return self.take(&flow, (surface, &crossed), t_end),
                Err(found) => reason = found,
            }
            nearest.get_or_insert((flow, sides));
            if last || is_behind {
                break;
            }
        }
        if let Some((flow, sides)) = nearest {
            (self.flow, self.sides) = (flow, sides);
        }
        Err(reason)
    }

    /// The motion at a time before which nothing is met.
    fn brought_to(&self, t: f64) -> Option<(CertifiedFlow<'a, Sys>, Sides<Sys>)> {
        let (mut flow, mut sides) = (self.flow.clone(), self.sides);
        while flow.t < t {
            let step = flow.prepare(t).ok()?;
            let (now, hull) = (Interval::point(flow.t), flow.frame.hull());
            let course = Course::new(&flow.field, &hull, &step.tube, now, step.length, ORDER)?;
            sides = self.surfaces(&flow).passed(&course, &sides).ok()?;
            flow.make(&step);
        }
        Some((flow, sides))
    }

    /// The impact on a surface from the motion shortly before it, or on another that may be first.
    fn crossed(
        &self,
        flow: &CertifiedFlow<'a, Sys>,
        surface: usize,
        sides: &Sides<Sys>,
    ) -> Result<(usize, Crossed<Sys>), Reason> {
        let at = |surface: usize| {
            let strike = Strike {
                surface,
                chosen: self.chosen(surface)?,
                motion_start: flow.field.system.motion_start(&flow.frame.centre),
            };
            let surfaces = self.surfaces(flow);
            cross(&surfaces, &strike, (flow.t, &flow.frame), sides)
        };
        match at(surface) {
            Ok(crossed) => Ok((surface, crossed)),
            Err(reason @ Reason::MayMeetTogether { other, .. }) => match at(other) {
                Ok(crossed) => Ok((other, crossed)),
                Err(_) => Err(reason),
            },
            Err(reason) => Err(reason),
        }
    }

    /// The law chosen for a surface, if there is one. A map is not to be chosen.
    fn chosen(&self, surface: usize) -> Result<Option<Law>, Reason> {
        let declared = self.flow.field.system.law(surface);
        match self.laws.get(surface).filter(|law| *law != declared) {
            Some(law) if law.is_map() => Err(Reason::UnsureLaw { surface }),
            chosen => Ok(chosen),
        }
    }

    /// Goes on after an impact, if it is certainly not after `t_end`.
    fn take(
        &mut self,
        flow: &CertifiedFlow<'a, Sys>,
        (surface, crossed): (usize, &Crossed<Sys>),
        t_end: f64,
    ) -> Result<Option<CertifiedImpact<Sys>>, Reason> {
        (self.flow, self.sides) = (flow.clone(), crossed.sides_before);
        if crossed.time.lo > t_end {
            // Until then no surface is met.
            while self.flow.t < t_end {
                let step = self.flow.prepare(t_end).map_err(|lost| lost.reason)?;
                self.flow.make(&step);
            }
            return Ok(None);
        }
        if crossed.t > t_end {
            return Err(Reason::EndsAtImpact { surface });
        }
        self.flow.jump(crossed.t, crossed.frame);
        self.sides = crossed.sides;
        self.impacts += 1;
        Ok(Some(CertifiedImpact {
            surface,
            time: crossed.time,
            before: crossed.before,
            after: crossed.after,
        }))
    }
}
