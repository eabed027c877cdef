//! Steps of certified motion.
//!
//! A step from a set `Y` with the centre `y` uses a tube `B` that contains every motion from `Y` until the end of the
//! step, because `Y + [0, h] f([t, t + h], B)` lies inside `B`. Then
//!
//! ```text
//! y(t + h) is in  sum_(k<p) h^k c_k(y)  +  h^p c_p(B)  +  J(Y) (Y - y)
//! ```
//!
//! with the Taylor coefficients `c_k` of the motion over intervals. `J(Y)` encloses, over all of `Y`, the derivative of
//! the sum with respect to the initial state.

use super::frame::{BLOCKS, Bounds, Frame, Matrix, Turned};
use super::lost::{Lost, Reason};
use super::series::{Arc, Field, bounds, row};
use crate::contract::Variational;
use crate::error::Fault;
use crate::integrate::controller::least_step;
use crate::jet::LENGTH;
use crate::math;
use crate::numbers::{Interval, Numbers, Row};
use crate::state::StateVector;

/// Order of the series. The remainder falls with `h^ORDER`, the work grows with `ORDER^2`.
pub(super) const ORDER: usize = 18;

const _: () = assert!(ORDER < LENGTH);

/// Default size of the remainder of a step, relative to the state.
const REMAINDER: f64 = f64::EPSILON;

/// Allowed size of the remainder relative to the width of the box.
const SHARE: f64 = 1.0 / 1024.0;

/// Limits of the factor between the lengths of consecutive steps, and the safety factor of the step-size control.
const GROW: f64 = 2.0;
const SHRINK: f64 = 0.5;
const SAFETY: f64 = 0.9;

/// Number of steps after which they must have led over this fraction of the time.
const HEADWAY: (u64, f64) = (4096, 1.0 / (1 << 20) as f64);

/// The image of the frame's centre at the end of a step.
struct Moved<S> {
    bounds: Bounds<S>,
    /// Largest ratio of a component's remainder to the allowed remainder.
    excess: f64,
}

/// A step that can be made.
pub(super) struct Step<Sys: Variational> {
    /// The time at its end.
    pub(super) later: f64,
    /// Its length.
    pub(super) length: Interval,
    /// A box that contains the motion during the step.
    pub(super) tube: Bounds<Sys::State>,
    frame: Frame<Sys>,
    next: f64,
}

/// Certified integration of a box of initial states: encloses the states of all motions that start in the box.
pub struct CertifiedFlow<'a, Sys: Variational> {
    pub(super) field: Field<'a, Sys>,
    pub(super) t: f64,
    pub(super) frame: Frame<Sys>,
    remainder: f64,
    /// Length of the next trial step; `None` before the first step.
    next: Option<f64>,
    steps: u64,
    /// Time and number of steps at the last check for headway.
    checked: (f64, u64),
    /// True if there was no headway at that check.
    creeps: bool,
}

impl<Sys: Variational> Clone for CertifiedFlow<'_, Sys> {
    fn clone(&self) -> Self {
        Self {
            field: self.field,
            t: self.t,
            frame: self.frame,
            remainder: self.remainder,
            next: self.next,
            steps: self.steps,
            checked: self.checked,
            creeps: self.creeps,
        }
    }
}

impl<'a, Sys: Variational> CertifiedFlow<'a, Sys> {
    /// Begins at the time `t` with all states whose component `i` lies in `start(i)`.
    pub fn new(system: &'a Sys, t: f64, start: impl Fn(usize) -> Interval) -> Self {
        Self {
            field: Field::new(system),
            t,
            frame: Frame::of(&Bounds::of(system.state_len(), start)),
            remainder: REMAINDER,
            next: None,
            steps: 0,
            checked: (t, 0),
            creeps: false,
        }
    }

    /// Sets the allowed remainder of a step, as a positive fraction of the state. Larger values give longer steps and
    /// wider enclosures.
    #[must_use]
    pub fn with_remainder(mut self, part: f64) -> Self {
        self.remainder = part;
        self
    }

    /// Sets the parameter `index`, in the order of [`TaylorField::parameters`](crate::TaylorField::parameters), to a
    /// range; an index past the end changes nothing. The box then encloses the motions for every value in the range.
    #[must_use]
    pub fn with_parameter(mut self, index: usize, range: Interval) -> Self {
        self.field.set_parameter(index, range);
        self
    }

    /// The present time.
    pub fn t(&self) -> f64 {
        self.t
    }

    /// Steps made so far.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Enclosure of component `i` of the present state.
    pub fn component(&self, i: usize) -> Interval {
        self.frame.hull().at(i)
    }

    /// The width of the widest component.
    pub fn width(&self) -> f64 {
        self.frame.hull().width()
    }

    /// Enclosures of the positions and velocities at the present time; entry `i` belongs to coordinate `i`.
    ///
    /// # Errors
    /// A [`Fault`] where a velocity may not exist.
    pub fn velocities(&self) -> Result<Sys::Configuration<Interval>, Fault> {
        let hull = self.frame.hull();
        self.field.system.velocities(
            self.field.parameters(),
            Interval::point(self.t),
            &row::<Sys>(&hull),
        )
    }

    /// Propagates the box to the time `t_end`.
    ///
    /// # Errors
    /// [`Lost`] if no box is found that contains the motion. The flow then keeps the state at the time of the loss.
    pub fn run(&mut self, t_end: f64) -> Result<(), Lost> {
        while self.t < t_end {
            let step = self.prepare(t_end)?;
            self.make(&step);
        }
        Ok(())
    }

    /// Prepares a step that ends at `t_end` or before; `t_end` is later than the present time.
    pub(super) fn prepare(&self, t_end: f64) -> Result<Step<Sys>, Lost> {
        let lost = |reason| Lost { t: self.t, reason };
        let hull = self.frame.hull();
        if !hull.is_finite() {
            return Err(lost(Reason::NotFinite));
        }
        if self.creeps {
            return Err(lost(Reason::NoHeadway));
        }
        let no_rates = || lost(self.field.no_rates(Interval::point(self.t), &hull));
        let reach = self.reach().ok_or_else(no_rates)?;
        let wished = self.next.map_or(reach, |next| next.min(reach));
        let mut h = wished.min(t_end - self.t);
        loop {
            let later = match self.t + h >= t_end {
                true => t_end,
                false => self.t + h,
            };
            let is_ahead = later > self.t && h >= least_step(self.t).min(t_end - self.t);
            if !is_ahead {
                return Err(no_rates());
            }
            let length = Interval::point(later) - Interval::point(self.t);
            let made = self.tube(&hull, length).and_then(|tube| {
                let moved = self.moved(&tube, length)?;
                let turned = self.turned(&hull, length)?;
                let frame = self.frame.moved(&moved.bounds, &turned);
                Some((tube, frame, moved.excess))
            });
            let factor = match made {
                Some((_, _, excess)) => math::powf(excess, -1.0 / ORDER as f64).min(GROW),
                None => SHRINK,
            };
            match made {
                Some((tube, frame, excess)) if excess <= 1.0 => {
                    let longest = SAFETY * factor * h;
                    let is_cut = h == t_end - self.t;
                    return Ok(Step {
                        later,
                        length,
                        tube,
                        frame,
                        // A step shortened to end at `t_end` does not limit the next one.
                        next: if is_cut { wished.max(longest) } else { longest },
                    });
                }
                _ => h *= (SAFETY * factor).max(SHRINK),
            }
        }
    }

    /// Applies a step that was prepared from the present state.
    pub(super) fn make(&mut self, step: &Step<Sys>) {
        (self.frame, self.t, self.next) = (step.frame, step.later, Some(step.next));
        self.steps += 1;
        let (time, steps) = self.checked;
        let (most, headway) = HEADWAY;
        if self.steps - steps >= most {
            self.creeps = self.t - time < headway * self.t.abs();
            self.checked = (self.t, self.steps);
        }
    }

    /// Replaces time and set of states, for example after an impact. `t` is not before the present time.
    pub(super) fn jump(&mut self, t: f64, frame: Frame<Sys>) {
        (self.frame, self.t) = (frame, t);
    }

    /// The step length at which the remainder has the allowed size, from the last two coefficients at the centre.
    fn reach(&self) -> Option<f64> {
        let point = Bounds::point(&self.frame.centre);
        let (now, unit) = (Interval::point(self.t), Interval::point(1.0));
        let series = self.field.series(&point, now, unit, ORDER)?;
        let scale = self.field.system.scale(self.t, &self.frame.centre);
        let mut reach = f64::INFINITY;
        for order in [ORDER - 1, ORDER] {
            let mut largest = 0.0_f64;
            for (i, coefficient) in series.coefficients[order].as_slice().iter().enumerate() {
                let size = self.frame.centre.as_slice()[i].abs() + scale.as_slice()[i];
                largest = largest.max(coefficient.magnitude() / size);
            }
            reach = reach.min(math::powf(self.remainder / largest, 1.0 / order as f64));
        }
        (reach > 0.0).then_some(reach)
    }

    /// A box that contains every motion that starts in the hull, until the end of a step.
    fn tube(&self, hull: &Bounds<Sys::State>, length: Interval) -> Option<Bounds<Sys::State>> {
        let during = Interval::new(0.0, length.hi);
        let times = Interval::point(self.t) + during;
        self.field.tube(hull, times, during)
    }

    /// The image of the centre at the end of a step, with the remainder. The allowed remainder is a fraction of the
    /// state ([`CertifiedFlow::with_remainder`]) plus a small fraction of the width of the box.
    fn moved(&self, tube: &Bounds<Sys::State>, length: Interval) -> Option<Moved<Sys::State>> {
        let now = Interval::point(self.t);
        let point = Bounds::point(&self.frame.centre);
        let series = self.field.series(&point, now, length, ORDER)?;
        let times = now + Interval::new(0.0, length.hi);
        let remainder = self.field.series(tube, times, length, ORDER)?;
        let end = Arc::new(&series, &remainder, ORDER).at(Interval::point(1.0));
        let bounds = bounds::<Sys::State>(end.as_slice());
        let (scale, hull) = (
            self.field.system.scale(self.t, &self.frame.centre),
            self.frame.hull(),
        );
        let last = remainder.coefficients[ORDER].as_slice();
        let excess = (0..hull.count()).fold(0.0_f64, |most, i| {
            let size = self.frame.centre.as_slice()[i].abs() + scale.as_slice()[i];
            let allowed = self.remainder * size + SHARE * hull.at(i).width();
            most.max(last[i].width() / allowed)
        });
        bounds.is_finite().then_some(Moved { bounds, excess })
    }

    /// Enclosures, over the hull, of the derivatives of a step's Taylor sum with respect to the initial state, along
    /// the axes of the frame.
    fn turned(&self, hull: &Bounds<Sys::State>, length: Interval) -> Option<Turned<Sys>> {
        let now = Interval::point(self.t);
        let n = hull.count();
        let mut turned = [Matrix::zero(n); BLOCKS];
        for (block, k, axis) in self.frame.axes() {
            let series = self
                .field
                .series_along(hull, &axis, now, length, ORDER - 1)?;
            let column = Bounds::of(n, |i| {
                let terms = (0..ORDER)
                    .rev()
                    .map(|order| series.coefficients[order].as_slice()[i].rate);
                terms.fold(Interval::ZERO, |sum, term| sum + term)
            });
            turned[block].set_column(k, &column);
        }
        Some(turned)
    }
}
