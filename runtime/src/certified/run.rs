//! Certified runs: an alternation of smooth motion and impacts.

use core::ops::ControlFlow;

use super::course::{Course, Met, Side, Sides, Surfaces};
use super::crossing::{Crossed, cross};
use super::departure::carried;
use super::flow::{CertifiedFlow, ORDER, Step};
use super::frame::{Bounds, Matrix, identity};
use super::lost::{Lost, Reason};
use super::series::Field;
use crate::contract::{Impacting, Variational};
use crate::error::Fault;
use crate::integrate::controller::least_step;
use crate::law::Law;
use crate::numbers::{Interval, Row};
use crate::per_surface::PerSurface;
use crate::variations::transition::Strike;

/// Distances before a surface at which a crossing begins, relative to the part of the step up to it. They are tried in
/// order.
const MARGINS: [f64; 4] = [
    1.0 / (1_u64 << 40) as f64,
    1.0 / (1_u64 << 32) as f64,
    1.0 / (1_u64 << 22) as f64,
    1.0 / (1_u64 << 12) as f64,
];

/// An impact of every motion of a box.
pub struct CertifiedImpact<Sys: Variational> {
    /// Index of the surface, in order of declaration.
    pub surface: usize,
    /// Enclosure of the time of the impact.
    pub time: Interval,
    pub(super) before: Bounds<Sys::State>,
    pub(super) after: Bounds<Sys::State>,
    /// Enclosure of the derivative of the state after the impact with respect to the start, if requested.
    pub(super) derivative: Option<Matrix<Sys>>,
}

impl<Sys: Variational> CertifiedImpact<Sys> {
    /// Enclosure of component `i` of the state before the impact.
    pub fn before(&self, i: usize) -> Interval {
        self.before.at(i)
    }

    /// Enclosure of component `i` of the state after the impact, at the time of the impact.
    pub fn after(&self, i: usize) -> Interval {
        self.after.at(i)
    }
}

/// A box of states that is propagated through time and impacts.
///
/// The gap of every surface is enclosed along every step. An impact is certified if every motion of the box meets the
/// same surface once, transversally, and no other surface at about the same time. The declared law, or the one chosen
/// for the run, is then applied to all motions. A condition that cannot be proved ends the run as [`Lost`], which names
/// it.
///
/// ```
/// use dalembert::certified::CertifiedRun;
/// use dalembert::model;
/// use dalembert::numbers::Interval;
///
/// model! {
///     /// A ball over a floor that halves its speed.
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
/// // It falls for the time 1, and flies for the time 1 after that.
/// for t in [1.0, 2.0] {
///     let impact = run.next_impact(2.5)?.expect("an impact");
///     assert!(impact.time.contains(Interval::point(t)) && impact.time.width() < 1e-13);
/// }
/// # Ok::<(), dalembert::certified::Lost>(())
/// ```
pub struct CertifiedRun<'a, Sys: Variational + Impacting> {
    progress: Progress<'a, Sys>,
    laws: PerSurface<Option<Law>, <Sys as Impacting>::Gaps>,
    is_begun: bool,
    impacts: u64,
}

/// The motion up to a time.
struct Progress<'a, Sys: Variational + Impacting> {
    flow: CertifiedFlow<'a, Sys>,
    sides: Sides<Sys>,
    /// Enclosure of the derivative with respect to the start, if requested.
    derivative: Option<Matrix<Sys>>,
}

impl<Sys: Variational + Impacting> Clone for Progress<'_, Sys> {
    fn clone(&self) -> Self {
        Self {
            flow: self.flow.clone(),
            sides: self.sides,
            derivative: self.derivative,
        }
    }
}

impl<Sys: Variational + Impacting> Progress<'_, Sys> {
    /// Prepares a step that ends at `t_end` or before, including the derivative if requested.
    fn prepare(&self, t_end: f64) -> Result<Prepared<Sys>, Lost> {
        let (flow, mut t_end) = (&self.flow, t_end);
        loop {
            let step = flow.prepare(t_end)?;
            let Some(derivative) = &self.derivative else {
                let derivative = None;
                return Ok(Prepared { step, derivative });
            };
            if let Some(later) = self.carried(&step, derivative) {
                let derivative = Some(later);
                return Ok(Prepared { step, derivative });
            }
            t_end = 0.5 * flow.t + 0.5 * step.later;
            if t_end - flow.t < least_step(flow.t) {
                let (t, reason) = (flow.t, Reason::NoTube);
                return Err(Lost { t, reason });
            }
        }
    }

    /// Enclosure of the derivative at the end of a step.
    fn carried(&self, step: &Step<Sys>, derivative: &Matrix<Sys>) -> Option<Matrix<Sys>> {
        let flow = &self.flow;
        let (now, hull) = (Interval::point(flow.t), flow.frame.hull());
        let (unit, end) = (step.length, Interval::point(1.0));
        let n = hull.count();
        let mut later = Matrix::zero(n);
        for k in 0..n {
            let column = derivative.column(k);
            let from = [&hull, &step.tube, &column];
            later.set_column(k, &carried(&flow.field, from, now, unit, end, ORDER)?);
        }
        Some(later)
    }

    /// Makes a step prepared from the present state; `sides` are the sides of the surfaces at its end.
    fn make(&mut self, prepared: &Prepared<Sys>, sides: Sides<Sys>) {
        self.derivative = prepared.derivative;
        self.flow.make(&prepared.step);
        self.sides = sides;
    }
}

/// A step that can be made, with the derivative at its end if requested.
struct Prepared<Sys: Variational> {
    step: Step<Sys>,
    derivative: Option<Matrix<Sys>>,
}

impl<'a, Sys: Variational + Impacting> CertifiedRun<'a, Sys> {
    /// Begins at the time `t` with all states whose component `i` lies in `start(i)`.
    pub fn new(system: &'a Sys, t: f64, start: impl Fn(usize) -> Interval) -> Self {
        let progress = Progress {
            flow: CertifiedFlow::new(system, t, start),
            sides: PerSurface::all(&system.zero_gaps(), Side::Unknown),
            derivative: None,
        };
        Self {
            progress,
            laws: PerSurface::all(&system.zero_gaps(), None),
            is_begun: false,
            impacts: 0,
        }
    }

    /// Sets a parameter to a range; see [`CertifiedFlow::with_parameter`].
    #[must_use]
    pub fn with_parameter(mut self, index: usize, range: Interval) -> Self {
        self.progress.flow.field.set_parameter(index, range);
        self
    }

    /// Sets the remainder of steps; see [`CertifiedFlow::with_remainder`].
    #[must_use]
    pub fn with_remainder(mut self, part: f64) -> Self {
        self.progress.flow = self.progress.flow.with_remainder(part);
        self
    }

    /// Replaces the law of a surface by another law that is an impulse. An index past the last surface has no effect.
    #[must_use]
    pub fn with_law(mut self, surface: usize, law: Law) -> Self {
        self.laws.set(surface, Some(law));
        self
    }

    /// The present time.
    pub fn t(&self) -> f64 {
        self.progress.flow.t
    }

    /// Steps made so far.
    pub fn steps(&self) -> u64 {
        self.progress.flow.steps()
    }

    /// Impacts so far.
    pub fn impacts(&self) -> u64 {
        self.impacts
    }

    /// Enclosure of component `i` of the present state.
    pub fn component(&self, i: usize) -> Interval {
        self.progress.flow.component(i)
    }

    /// The width of the widest component.
    pub fn width(&self) -> f64 {
        self.progress.flow.width()
    }

    /// Enclosures of the present positions and velocities; see [`CertifiedFlow::velocities`].
    ///
    /// # Errors
    /// A [`Fault`] where a velocity may not exist.
    pub fn velocities(&self) -> Result<Sys::Configuration<Interval>, Fault> {
        self.progress.flow.velocities()
    }

    /// Propagates the box to the time `t_end`, or until `observer` breaks after an impact.
    ///
    /// # Errors
    /// [`Lost`] with the condition that could not be proved. The box then encloses the states at the time up to which
    /// the motion is certified.
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

    /// Propagates the box to a time just after its next impact, or to the time `t_end` if no impact precedes it.
    ///
    /// # Errors
    /// The errors of [`CertifiedRun::run`].
    pub fn next_impact(&mut self, t_end: f64) -> Result<Option<CertifiedImpact<Sys>>, Lost> {
        self.begin()?;
        // Latest end of the next step: before `t_end` where the motion is enclosed over shorter steps only.
        let mut limit = t_end;
        while self.t() < t_end {
            let prepared = self.progress.prepare(limit)?;
            let t = self.t();
            match self.watched(&self.progress, &prepared.step) {
                Ok(sides) => {
                    self.progress.make(&prepared, sides);
                    limit = t_end;
                }
                Err(Met {
                    surface: None,
                    reason,
                    ..
                }) => {
                    limit = 0.5 * t + 0.5 * prepared.step.later;
                    if limit - t < least_step(t) {
                        return Err(Lost { t, reason });
                    }
                }
                Err(Met {
                    surface: Some(surface),
                    reason,
                    at,
                }) => {
                    let impact = self.meet(&prepared.step, surface, (reason, at), t_end);
                    let t = self.t();
                    let impact = impact.map_err(|reason| Lost { t, reason })?;
                    if impact.is_some() {
                        return Ok(impact);
                    }
                }
            }
        }
        Ok(None)
    }

    /// Also encloses the derivative of the state at [`CertifiedRun::t`] with respect to the start.
    pub(super) fn with_derivative(mut self) -> Self {
        let n = self.field().system.state_len();
        self.progress.derivative = Some(Matrix::of(&identity::<Sys>(n)));
        self
    }

    pub(super) fn field(&self) -> &Field<'a, Sys> {
        &self.progress.flow.field
    }

    pub(super) fn set_field(&mut self, field: &Field<'a, Sys>) {
        self.progress.flow.field = *field;
    }

    /// Sets the initial sides: above a surface if its gap is nowhere negative on the box, below it if the gap is
    /// nowhere positive, else unknown.
    fn begin(&mut self) -> Result<(), Lost> {
        if self.is_begun {
            return Ok(());
        }
        let Progress { flow, sides, .. } = &mut self.progress;
        let (t, hull) = (flow.t, flow.frame.hull());
        let [one, other] = [hull.lo, hull.hi].map(|corner| flow.field.system.mode(&corner));
        if one != other {
            let reason = Reason::SeveralModes;
            return Err(Lost { t, reason });
        }
        self.is_begun = true;
        let Some(gaps) = flow.field.gaps_at(Interval::point(t), &hull) else {
            return Ok(());
        };
        for (surface, gap) in gaps.as_slice().iter().enumerate() {
            if gap.lo >= 0.0 {
                sides[surface] = Side::Above;
            } else if gap.hi <= 0.0 {
                sides[surface] = Side::Below;
            }
        }
        Ok(())
    }

    /// The surface that may be met in a step, or the sides of all surfaces at its end.
    fn watched(&self, progress: &Progress<'a, Sys>, step: &Step<Sys>) -> Result<Sides<Sys>, Met> {
        let flow = &progress.flow;
        let (now, hull) = (Interval::point(flow.t), flow.frame.hull());
        let (tube, length) = (&step.tube, step.length);
        match Course::new(&flow.field, &hull, tube, now, length, ORDER) {
            Some(course) => self.surfaces(flow).passed(&course, &progress.sides),
            None => Err(Met {
                surface: None,
                reason: Reason::NoTube,
                at: 0.0,
            }),
        }
    }

    fn surfaces<'f>(&self, flow: &'f CertifiedFlow<'a, Sys>) -> Surfaces<'f, 'a, Sys> {
        let field = &flow.field;
        let mut passable = PerSurface::all(&field.system.zero_gaps(), false);
        for (surface, is_passable) in passable.iter_mut().enumerate() {
            let law = self.laws.get(surface).flatten();
            let is_map = law.is_none_or(|law| law.is_map());
            *is_passable = is_map && field.system.is_passable(surface);
        }
        Surfaces { field, passable }
    }

    /// Crosses the surface that may be met in a step. Returns `None` if the motion reaches `t_end` before it.
    fn meet(
        &mut self,
        step: &Step<Sys>,
        surface: usize,
        (mut reason, at): (Reason, f64),
        t_end: f64,
    ) -> Result<Option<CertifiedImpact<Sys>>, Reason> {
        let mut last = at == 0.0;
        let is_behind = matches!(reason, Reason::MayBeBehind { .. });
        let mut nearest = None;
        for margin in MARGINS {
            let part = at - margin * f64::max(at, 1.0 / 1024.0);
            let t = (Interval::point(self.t()) + step.length * Interval::point(part)).lo;
            last |= t <= self.t();
            let Some(near) = self.brought_to(if last { self.t() } else { t }) else {
                continue;
            };
            let crossed = match is_behind {
                true => Err(reason),
                false => self.crossed(&near, surface),
            };
            match crossed {
                Ok((surface, crossed)) => return self.take(near, surface, &crossed, t_end),
                Err(found) => reason = found,
            }
            nearest.get_or_insert(near);
            if last || is_behind {
                break;
            }
        }
        if let Some(near) = nearest {
            self.progress = near;
        }
        Err(reason)
    }

    /// The motion at the time `t`; `None` if a surface may be met before it.
    fn brought_to(&self, t: f64) -> Option<Progress<'a, Sys>> {
        let mut progress = self.progress.clone();
        while progress.flow.t < t {
            let prepared = progress.prepare(t).ok()?;
            let sides = self.watched(&progress, &prepared.step).ok()?;
            progress.make(&prepared, sides);
        }
        Some(progress)
    }

    /// The impact on a surface, from the motion shortly before it; or the impact on another surface that comes first.
    fn crossed(
        &self,
        near: &Progress<'a, Sys>,
        surface: usize,
    ) -> Result<(usize, Crossed<Sys>), Reason> {
        let flow = &near.flow;
        let at = |surface: usize| {
            let strike = Strike {
                surface,
                chosen: self.chosen(surface)?,
                motion_start: flow.field.system.motion_start(&flow.frame.centre),
            };
            if strike.law(flow.field.system, flow.field.parameters()) == Law::Stop {
                return Err(Reason::Stops { surface });
            }
            let (surfaces, start) = (self.surfaces(flow), (flow.t, &flow.frame));
            cross(
                &surfaces,
                &strike,
                start,
                &near.sides,
                near.derivative.as_ref(),
            )
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

    /// The law chosen for a surface, if there is one. A map must not be chosen.
    fn chosen(&self, surface: usize) -> Result<Option<Law>, Reason> {
        let declared = self.field().system.law(surface);
        match self
            .laws
            .get(surface)
            .flatten()
            .filter(|law| *law != declared)
        {
            Some(law) if law.is_map() => Err(Reason::UnsureLaw { surface }),
            chosen => Ok(chosen),
        }
    }

    /// Continues after an impact that certainly precedes `t_end`, or to `t_end` if the impact is certainly later.
    fn take(
        &mut self,
        near: Progress<'a, Sys>,
        surface: usize,
        crossed: &Crossed<Sys>,
        t_end: f64,
    ) -> Result<Option<CertifiedImpact<Sys>>, Reason> {
        self.progress = near;
        if crossed.time.lo > t_end {
            // No surface is met until then.
            while self.t() < t_end {
                let prepared = self.progress.prepare(t_end);
                let prepared = prepared.map_err(|lost| lost.reason)?;
                self.progress.make(&prepared, crossed.sides_before);
            }
            return Ok(None);
        }
        if crossed.t > t_end {
            return Err(Reason::EndsAtImpact { surface });
        }
        let derivatives = crossed.derivatives.as_ref();
        self.progress.flow.jump(crossed.t, crossed.frame);
        self.progress.sides = crossed.sides;
        self.progress.derivative = derivatives.map(|[_, later]| *later);
        self.impacts += 1;
        Ok(Some(CertifiedImpact {
            surface,
            time: crossed.time,
            before: crossed.before,
            after: crossed.after,
            derivative: derivatives.map(|[at_impact, _]| *at_impact),
        }))
    }
}
