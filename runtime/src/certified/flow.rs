//! Steps of certified motion.
//!
//! A step from the set `Y = y + Q r` takes a tube `B` that holds every motion from `Y` until the end of the step, since
//! `Y + [0, h] f([t, t + h], B)` lies inside `B`. Then
//!
//! ```text
//! y(t + h) is in  sum_(k<p) h^k c_k(y)  +  h^p c_p(B)  +  J(Y) (Y - y)
//! ```
//!
//! with the Taylor coefficients `c_k` of the motion over intervals, and `J` the derivative of the sum by the start, over all of `Y`.

use core::fmt;

use super::frame::{Bounds, Frame, Matrix};
use crate::contract::Variational;
use crate::error::Fault;
use crate::integrate::controller::least_step;
use crate::integrate::taylor::expansion::Expansion;
use crate::jet::LENGTH;
use crate::math;
use crate::numbers::{Interval, Numbers, Rated, Row};
use crate::state::StateVector;

/// Order of the series: remainders fall with its powers, work grows with its square.
const ORDER: usize = 18;

/// The remainder of a step is to be about this part of the state.
const REMAINDER: f64 = f64::EPSILON;

/// The same beside a box, in parts of its width.
const SHARE: f64 = 1.0 / 1024.0;

/// Trials to find a tube for one length of a step.
const TRIALS: u32 = 6;

/// Parts that a tube is made larger by than its last trial.
const ROOM: f64 = 0.1;

/// Factors between a step and the next.
const GROW: f64 = 2.0;
const SHRINK: f64 = 0.5;
const SAFETY: f64 = 0.9;

/// The centre at the end of a step.
struct Moved<S> {
    bounds: Bounds<S>,
    /// The largest remainder over what it may be.
    excess: f64,
}

/// That no box was found which holds the motion any longer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lost {
    /// The time up to which the motion is certified.
    pub t: f64,
}

impl fmt::Display for Lost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the motion is certified up to t = {} and no further",
            self.t
        )
    }
}

impl core::error::Error for Lost {}

/// A box of states that is followed through time.
pub struct CertifiedFlow<'a, Sys: Variational> {
    system: &'a Sys,
    t: f64,
    frame: Frame<Sys>,
    /// The length to try next.
    next: f64,
    steps: u64,
}

impl<'a, Sys: Variational> CertifiedFlow<'a, Sys> {
    /// Begins at the time `t` with all states whose component `i` lies in `start(i)`.
    pub fn new(system: &'a Sys, t: f64, start: impl Fn(usize) -> Interval) -> Self {
        Self {
            system,
            t,
            frame: Frame::of(&Bounds::of(start)),
            next: f64::INFINITY,
            steps: 0,
        }
    }

    /// The time that was reached.
    pub fn t(&self) -> f64 {
        self.t
    }

    /// Steps made so far.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// All values that component `i` of the state may have now.
    pub fn component(&self, i: usize) -> Interval {
        self.frame.hull().at(i)
    }

    /// The width of the widest component.
    pub fn width(&self) -> f64 {
        let hull = self.frame.hull();
        (0..Sys::State::LEN).fold(0.0, |most, i| most.max(hull.at(i).width()))
    }

    /// All positions and velocities that the state may have now: coordinate `i` and its rate.
    ///
    /// # Errors
    /// [`Fault`] where a velocity may not exist.
    pub fn velocities(&self) -> Result<Sys::Configuration<Interval>, Fault> {
        let hull = self.frame.hull();
        Sys::velocities(
            &self.parameters(),
            Interval::point(self.t),
            &row::<Sys>(&hull),
        )
    }

    /// Follows the motion to the time `t_end`.
    ///
    /// # Errors
    /// [`Lost`] where no box is found that holds it; the state is that of the time it was lost at.
    pub fn run(&mut self, t_end: f64) -> Result<(), Lost> {
        while self.t < t_end {
            self.step(t_end)?;
        }
        Ok(())
    }

    fn parameters<L: Numbers>(&self) -> Sys::Parameters<L> {
        let mut parameters = Sys::Parameters::<L>::ZERO;
        let values = self.system.parameters();
        for (parameter, value) in parameters.as_mut_slice().iter_mut().zip(values.as_slice()) {
            *parameter = L::of(*value);
        }
        parameters
    }

    /// Makes one step, no further than `t_end`.
    fn step(&mut self, t_end: f64) -> Result<(), Lost> {
        let lost = Lost { t: self.t };
        let hull = self.frame.hull();
        if !hull.is_finite() {
            return Err(lost);
        }
        let mut h = self.next.min(t_end - self.t).min(self.reach()?);
        loop {
            let later = match self.t + h >= t_end {
                true => t_end,
                false => self.t + h,
            };
            let is_ahead = later > self.t && h >= least_step(self.t);
            if !is_ahead {
                return Err(lost);
            }
            let length = Interval::point(later) - Interval::point(self.t);
            let made = self.tube(&hull, length).and_then(|tube| {
                let moved = self.moved(&tube, length)?;
                let derivative = self.derivative(&hull, length)?;
                let frame = self.frame.moved(&moved.bounds, &derivative);
                Some((frame, moved.excess))
            });
            let factor = match made {
                Some((_, excess)) => math::powf(excess, -1.0 / ORDER as f64).min(GROW),
                None => SHRINK,
            };
            match made {
                Some((frame, excess)) if excess <= 1.0 => {
                    self.frame = frame;
                    self.t = later;
                    self.steps += 1;
                    self.next = SAFETY * factor * h;
                    return Ok(());
                }
                _ => h *= (SAFETY * factor).max(SHRINK),
            }
        }
    }

    /// The length at which the remainder is small, from the coefficients at the centre.
    fn reach(&self) -> Result<f64, Lost> {
        let lost = Lost { t: self.t };
        let point = Bounds::point(&self.frame.centre);
        let series = self
            .series(&point, Interval::point(self.t), Interval::point(1.0))
            .ok_or(lost)?;
        let scale = self.system.scale(self.t, &self.frame.centre);
        let mut reach = f64::INFINITY;
        for order in [ORDER - 1, ORDER] {
            let mut largest = 0.0_f64;
            for (i, coefficient) in series.coefficients[order].as_slice().iter().enumerate() {
                let size = self.frame.centre.as_slice()[i].abs() + scale.as_slice()[i];
                largest = largest.max(coefficient.magnitude() / size);
            }
            reach = reach.min(math::powf(REMAINDER / largest, 1.0 / order as f64));
        }
        match reach > 0.0 {
            true => Ok(reach),
            false => Err(lost),
        }
    }

    /// A box that holds every motion from the hull until the end of a step.
    fn tube(&self, hull: &Bounds<Sys::State>, length: Interval) -> Option<Bounds<Sys::State>> {
        let during = Interval::new(0.0, length.hi);
        let times = Interval::point(self.t) + during;
        let reached = |tube: &Bounds<Sys::State>| {
            let rates = self.rates(tube, times)?;
            let reached = Bounds::of(|i| hull.at(i) + during * rates.as_slice()[i]);
            reached.is_finite().then_some(reached)
        };
        let mut tube = reached(hull)?;
        for _ in 0..TRIALS {
            let wider = Bounds::of(|i| {
                let range = tube.at(i).hull(hull.at(i));
                range.widened(ROOM * range.width() + f64::MIN_POSITIVE)
            });
            let found = reached(&wider)?;
            if (0..Sys::State::LEN).all(|i| wider.at(i).contains(found.at(i))) {
                return reached(&found);
            }
            tube = Bounds::of(|i| found.at(i).hull(tube.at(i)));
        }
        None
    }

    /// All rates in a box.
    fn rates(&self, tube: &Bounds<Sys::State>, times: Interval) -> Option<Sys::Row<Interval>> {
        let mut firsts = Sys::Firsts::<Interval>::ZERO;
        Sys::begin(&self.parameters(), times, &row::<Sys>(tube), &mut firsts).ok()?;
        let mut rates = Sys::Row::<Interval>::ZERO;
        let own = &firsts.as_slice()[..Sys::State::LEN];
        rates.as_mut_slice().copy_from_slice(own);
        Some(rates)
    }

    /// The series of all motions from a box, in units of `unit`.
    fn series(
        &self,
        from: &Bounds<Sys::State>,
        times: Interval,
        unit: Interval,
    ) -> Option<Expansion<Sys, Interval>> {
        let (parameters, start) = (self.parameters(), row::<Sys>(from));
        let mut series = Expansion::new();
        series.begin(&parameters, times, &start).ok()?;
        series.advance(&parameters, unit, ORDER, &start);
        Some(series)
    }

    /// Where the centre is at the end of a step, with the remainder. That may be as wide as rounding makes the state, or a small part of
    /// what the box is wide.
    fn moved(&self, tube: &Bounds<Sys::State>, length: Interval) -> Option<Moved<Sys::State>> {
        let now = Interval::point(self.t);
        let series = self.series(&Bounds::point(&self.frame.centre), now, length)?;
        let times = now + Interval::new(0.0, length.hi);
        let remainder = self.series(tube, times, length)?;
        let of = |series: &Expansion<Sys, Interval>, k: usize, i: usize| {
            series.coefficients[k].as_slice()[i]
        };
        let bounds = Bounds::of(|i| {
            let last = of(&remainder, ORDER, i);
            (0..ORDER)
                .rev()
                .fold(last, |sum, k| sum + of(&series, k, i))
        });
        let (scale, hull) = (
            self.system.scale(self.t, &self.frame.centre),
            self.frame.hull(),
        );
        let excess = (0..Sys::State::LEN).fold(0.0_f64, |most, i| {
            let size = self.frame.centre.as_slice()[i].abs() + scale.as_slice()[i];
            let allowed = REMAINDER * size + SHARE * hull.at(i).width();
            most.max(of(&remainder, ORDER, i).width() / allowed)
        });
        bounds.is_finite().then_some(Moved { bounds, excess })
    }

    /// The derivatives of the sum of a step by its start, all over the hull.
    fn derivative(&self, hull: &Bounds<Sys::State>, length: Interval) -> Option<Matrix<Sys>> {
        let parameters = self.parameters::<Rated>();
        let (now, unit) = (Rated::of(self.t), Rated::steady(length));
        let mut derivative = Matrix::zero();
        for j in 0..Sys::State::LEN {
            let mut start = Sys::Row::<Rated>::ZERO;
            for (i, entry) in start.as_mut_slice().iter_mut().enumerate() {
                *entry = Rated {
                    value: hull.at(i),
                    rate: Interval::point(if i == j { 1.0 } else { 0.0 }),
                };
            }
            let mut series = Expansion::<Sys, Rated>::new();
            series.begin(&parameters, now, &start).ok()?;
            series.advance(&parameters, unit, ORDER - 1, &start);
            for i in 0..Sys::State::LEN {
                let terms = (0..ORDER)
                    .rev()
                    .map(|k| series.coefficients[k].as_slice()[i].rate);
                derivative.set(i, j, terms.fold(Interval::ZERO, |sum, term| sum + term));
            }
        }
        Some(derivative)
    }
}

/// A box as numbers.
fn row<Sys: Variational>(bounds: &Bounds<Sys::State>) -> Sys::Row<Interval> {
    const { assert!(ORDER < LENGTH) };
    let mut row = Sys::Row::<Interval>::ZERO;
    for (i, entry) in row.as_mut_slice().iter_mut().enumerate() {
        *entry = bounds.at(i);
    }
    row
}
