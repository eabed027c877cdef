//! Audit of a run: shows that the motion meets no surface between recorded impacts, and that recorded impacts lie on
//! their surfaces.
//!
//! An audit observes a run and does not rely on the events that the run reports. It encloses all values of every gap
//! along every step, by interval arithmetic on the dense output (`motion.rs`) and bisection (`scan.rs`). It shares no
//! code with event location except the functions of the model. A claim that it cannot prove within its budget is
//! reported as a [`Finding`], as an error is.
//!
//! Limits: where the gap of a surface may be negative, the conditions (`when`) of a system written by hand are sampled,
//! unless the system encloses them ([`Impacting::counts_along`]). A surface that holds the motion is not audited while
//! it does.
//!
//! ```
//! use dalembert::audit::{Audit, Finding};
//! use dalembert::{Dop853, Impacts, Simulation, System, Tolerance};
//!
//! dalembert::model! {
//!     /// A ball above a floor.
//!     pub Ball {
//!         coordinates { x; }
//!         lagrangian = dot(x)^2/2 - x;
//!         impacts { floor: x >= 0; }
//!     }
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let (ball, stepper) = (Ball {}, Dop853::new(Tolerance::new(1e-9)?));
//! let state = ball.state(0.0, &[0.5].into(), &[0.0].into())?;
//!
//! let mut audit = Audit::new(&ball);
//! Simulation::new(&ball, stepper, Impacts::declared(&ball)).run(0.0, state, 10.0, &mut audit)?;
//! assert_eq!(audit.finding(), None);
//!
//! // A run without impacts falls through the floor at t = 1.
//! let mut audit = Audit::new(&ball);
//! Simulation::new(&ball, stepper, ()).run(0.0, state, 10.0, &mut audit)?;
//! assert!(matches!(audit.finding(), Some(Finding::MayBeMet { surface: 0, t }) if (t - 1.0).abs() < 1e-9));
//! # Ok(())
//! # }
//! ```

mod motion;
mod scan;

use core::ops::ControlFlow;

use crate::contract::{Impacting, System};
use crate::numbers::{Bent, Interval};
use crate::per_surface::PerSurface;
use crate::record::{Event, Hold, Observer, Segment};
use crate::state::StateVector;
use motion::{Motion, ROUNDING};
use scan::Scan;

/// Tolerance of the gap at a recorded impact, in multiples of the gap's rounding error.
const NEAR: f64 = 64.0;

/// The same tolerance for simultaneous impacts, where rounding errors of earlier steps add up along the flight.
const BESIDE: f64 = 64.0 * NEAR;

/// Bound of the errors of a gap along a step, as a multiple of that which a projection corrects at its end.
const MOVED: f64 = 2.0;

/// Allowed decrease of a gap in every step along its surface, as a fraction of the gap's rounding error.
const DRIFT: f64 = 1.0 / 16.0;

/// Reason why a run is not confirmed. Only the first reason is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Finding {
    /// A surface may be met where the run has no impact: its gap is negative, or no enclosure excludes a root.
    MayBeMet {
        /// Index of the surface.
        surface: usize,
        /// Time.
        t: f64,
    },
    /// A recorded impact or contact does not lie on its surface, or the gap rises before a recorded impact.
    Misplaced {
        /// Index of the surface.
        surface: usize,
        /// Time.
        t: f64,
    },
    /// The step that begins here has no dense output.
    NoDenseOutput {
        /// Time.
        t: f64,
    },
}

/// Observes a run and reports errors in its events.
pub trait Auditor<Sys: System>: Observer<Sys> {
    /// Reason why the run is not confirmed; `None` if it is.
    fn finding(&self) -> Option<Finding>;
}

/// Audit of the surfaces of a system. It may observe a run of any system with the same states.
#[derive(Debug, Clone)]
pub struct Audit<'a, Sys: Impacting> {
    system: &'a Sys,
    /// Surfaces that allow motion on both sides; only crossings into negative gaps count there.
    passable: PerSurface<bool, Sys::Gaps>,
    /// Surfaces that hold the motion.
    held: PerSurface<bool, Sys::Gaps>,
    /// Largest size of a negative gap that rounding errors of the motion so far explain; 0 away from the surface.
    slack: Sys::Gaps,
    motion: Motion<Sys::State>,
    finding: Option<Finding>,
}

impl<'a, Sys: Impacting> Audit<'a, Sys> {
    /// An audit of a run with the declared laws.
    pub fn new(system: &'a Sys) -> Self {
        Self::passing(system, |surface| system.is_passable(surface))
    }

    /// An audit in which `is_passable` gives the surfaces that allow motion on both sides.
    pub(crate) fn passing(system: &'a Sys, is_passable: impl Fn(usize) -> bool) -> Self {
        let none = PerSurface::all(&system.zero_gaps(), false);
        let mut passable = none;
        for (surface, passable) in passable.iter_mut().enumerate() {
            *passable = is_passable(surface);
        }
        Self {
            system,
            passable,
            held: none,
            slack: system.zero_gaps(),
            motion: Motion::new(&system.zero_state()),
            finding: None,
        }
    }

    /// Reason why the run is not confirmed; `None` if it is.
    pub fn finding(&self) -> Option<Finding> {
        self.finding
    }

    fn is_passable(&self, surface: usize) -> bool {
        self.passable[surface]
    }

    /// Audits the gap of one surface along the present step, up to the fraction `part` of it and the state `end`.
    fn follow(&mut self, surface: usize, part: f64, end: &Sys::State) {
        let is_passable = self.is_passable(surface);
        // A projection that moves the end shows by how much the gaps along the step are wrong.
        let t = self.motion.time_at(part);
        let [arrived, kept] =
            [&self.motion.state(part), end].map(|state| self.system.gap(surface, t, state));
        let moved = (kept - arrived).abs();
        let slack = &mut self.slack.as_mut_slice()[surface];
        let scan = Scan {
            system: self.system,
            motion: &self.motion,
            surface,
            is_passable,
            slack: slack.max(MOVED * moved),
        };
        if !is_passable && scan.along([0.0, part]).value.lo > 0.0 {
            *slack = 0.0;
            return;
        }
        if let Err(place) = scan.exclude_falls(part) {
            self.note_met(surface, self.motion.time_at(place));
            return;
        }
        let gap = scan.at(part);
        *slack = match gap.lo > 0.0 {
            true => 0.0,
            false => {
                let floor = scan::floor(gap);
                slack.max(floor) + DRIFT * floor + moved
            }
        };
    }

    /// Records that a surface may be met, unless one that may be met earlier is recorded.
    fn note_met(&mut self, surface: usize, t: f64) {
        match self.finding {
            Some(Finding::MayBeMet { t: earlier, .. }) if earlier <= t => {}
            _ => self.finding = Some(Finding::MayBeMet { surface, t }),
        }
    }

    /// Enclosure of the gap of a surface at a state, including rounding errors of the dense output.
    fn gap_near(&self, surface: usize, t: f64, state: &Sys::State) -> Interval {
        let component = |i: usize| {
            let value = state.as_slice()[i];
            let rounding = (ROUNDING * value.abs()).max(self.motion.doubt(i));
            Bent::line(Interval::point(value).widened(rounding), 0.0)
        };
        let time = Bent::line(Interval::point(t).widened(ROUNDING * t.abs()), 0.0);
        self.system.gap_about(surface, time, &component).value
    }

    /// True if the gap of a surface is 0 at a state, within this many times its rounding.
    fn is_on(&self, surface: usize, t: f64, state: &Sys::State, roundings: f64) -> bool {
        let gap = self.gap_near(surface, t, state);
        gap.mignitude() <= roundings * gap.width() && gap.width().is_finite()
    }

    /// True if an impact lies on its surface and the motion arrives there from above.
    fn is_placed(&self, event: &Event<Sys::State>) -> bool {
        let roundings = if event.simultaneous { BESIDE } else { NEAR };
        let may_rise = event.graze || self.is_passable(event.surface);
        let falls = |rates: Sys::Gaps| rates.as_slice()[event.surface] <= 0.0;
        let rates = self.system.gap_rates(event.t, &event.before);
        self.is_on(event.surface, event.t, &event.before, roundings)
            && (may_rise || rates.is_ok_and(falls))
    }

    /// Allows the gap of a surface to be negative at a state by this many times its rounding.
    fn allow(&mut self, surface: usize, t: f64, state: &Sys::State, roundings: f64) {
        let gap = self.gap_near(surface, t, state);
        if gap.lo <= 0.0 && gap.width().is_finite() {
            let slack = &mut self.slack.as_mut_slice()[surface];
            *slack = slack.max(roundings * gap.width());
        }
    }
}

impl<Sys: Impacting, Run: System<State = Sys::State>> Observer<Run> for Audit<'_, Sys> {
    fn step(&mut self, segment: &mut Segment<'_, Sys::State>) -> ControlFlow<()> {
        if self.finding.is_some() {
            return ControlFlow::Continue(());
        }
        if self.motion.follow(segment).is_err() {
            let t = segment.t_start();
            self.finding = Some(Finding::NoDenseOutput { t });
            return ControlFlow::Continue(());
        }
        for surface in 0..self.held.count() {
            if !self.held[surface] {
                self.follow(surface, segment.part(), segment.end());
            }
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<Sys::State>) -> ControlFlow<()> {
        let (surface, t) = (event.surface, event.t);
        if self.finding.is_none() && !self.is_placed(event) {
            self.finding = Some(Finding::Misplaced { surface, t });
        }
        for surface in 0..self.held.count() {
            self.allow(surface, t, &event.after, 2.0);
        }
        ControlFlow::Continue(())
    }

    fn hold(&mut self, hold: &Hold<Sys::State>) -> ControlFlow<()> {
        let (surface, t) = (hold.surface, hold.t);
        let is_placed = hold.back.is_some() || self.is_on(surface, t, &hold.state, NEAR);
        if self.finding.is_none() && hold.begins && !is_placed {
            self.finding = Some(Finding::Misplaced { surface, t });
        }
        for surface in [Some(surface), hold.back].into_iter().flatten() {
            self.held[surface] = hold.begins;
            self.allow(surface, t, &hold.state, NEAR);
        }
        ControlFlow::Continue(())
    }
}

impl<Sys: Impacting, Run: System<State = Sys::State>> Auditor<Run> for Audit<'_, Sys> {
    fn finding(&self) -> Option<Finding> {
        self.finding
    }
}
