//! The map of a box of states across an impact, to a common time after it.
//!
//! From a time `t_0` shortly before the impact, all motions of a box `Y` are continued across the surface to a time
//! `t_1`. If the gap is positive at `t_0`, negative at `t_1` and decreasing in between, each motion meets the surface
//! once. Interval Newton iteration encloses the times of the impacts in `[t_a, t_b]`. With the impact time `tau(y)` of
//! the motion from `y`, the flow `phi` before the impact, the flow `psi` after it and the law `R`:
//!
//! ```text
//! P(y) = psi_(t_b - tau) R(tau, phi_tau(y))   is in   P(y_c) + DP(Y) (Y - y_c)
//! DP q = Dpsi (DR (v + f^- tau') + d_t R tau' - f^+ tau'),   v = Dphi q,   tau' = -dh(v) / (dh(f^-) + d_t h)
//! ```
//!
//! along each axis `q` of the frame: the saltation matrix between the derivatives of the two flows. The centre `y_c` is
//! mapped separately; the enclosure of its image is as narrow as rounding allows.
//!
//! Reference: M. A. Aizerman, F. R. Gantmakher, *Determination of stability by linear approximation of a periodic
//! solution of a system of differential equations with discontinuous right-hand sides*, Quarterly Journal of Mechanics
//! and Applied Mathematics 11 (1958).

use super::course::{Course, Part, Side, Sides, Surfaces};
use super::departure::{Departure, ORDER, carried, together};
use super::frame::{BLOCKS, Bounds, Frame, Matrix, Slopes, Turned};
use super::lost::Reason;
use super::series::{Field, bounds, rated_row, row};
use crate::contract::{Impacting, Variational};
use crate::numbers::{Interval, Numbers, Rated, Row};
use crate::outcome::Outcome;
use crate::state::StateVector;
use crate::variations::transition::Strike;

/// Maximum number of trial lengths of time, each twice the last.
const TRIALS: u32 = 8;

/// Maximum number of Newton steps.
const STEPS: u32 = 6;

/// Least length of the motion across a surface, in rounding errors of the time.
const UNITS: f64 = 32.0;

/// Enclosures of the states at an impact, and of the motion after it.
pub(super) struct Crossed<Sys: Variational + Impacting> {
    /// Enclosure of the time of the impact.
    pub(super) time: Interval,
    pub(super) before: Bounds<Sys::State>,
    pub(super) after: Bounds<Sys::State>,
    /// A time after all impacts, and the states at that time.
    pub(super) t: f64,
    pub(super) frame: Frame<Sys>,
    pub(super) sides: Sides<Sys>,
    /// The sides before the impact.
    pub(super) sides_before: Sides<Sys>,
    /// The given derivatives, propagated to the surface and to the later time.
    pub(super) derivatives: Option<[Matrix<Sys>; 2]>,
}

/// Motion from `t_0` across a surface.
struct Approach<'s, 'f, 'a, Sys: Variational + Impacting> {
    surfaces: &'s Surfaces<'f, 'a, Sys>,
    surface: usize,
    frame: &'s Frame<Sys>,
    t: f64,
    unit: Interval,
    tube: Bounds<Sys::State>,
    /// The motion of the box, and the motion of the centre.
    all: Course<'f, 'a, Sys>,
    centre: Course<'f, 'a, Sys>,
    /// Enclosures of the derivatives of states and gap along each axis, at any time until `t_1`.
    turned: Turned<Sys>,
    slopes: Slopes<Sys>,
    /// Enclosures of all motions until `t_1`, and of the rate of the gap per unit of time.
    whole: Part<Sys::State>,
    rate: Interval,
}

/// An impact of all motions: times in units from `t_0`, and derivatives along the axes.
struct Meeting<Sys: Variational> {
    units: Interval,
    centre_units: Interval,
    before: Bounds<Sys::State>,
    rates_before: Bounds<Sys::State>,
    /// Derivatives of the time of the impact along each axis.
    delays: Slopes<Sys>,
    /// Enclosure of the rate of the gap per unit of time during the impact.
    rate: Interval,
}

/// The impact of the centre.
struct Centre<S> {
    time: Interval,
    before: Bounds<S>,
    after: Bounds<S>,
    /// The state at the time after all impacts.
    moved: Bounds<S>,
}

/// Maps the states of a frame, and the columns of a derivative, across the impact on a surface whose gap is positive
/// and falls at the time `t`.
///
/// # Errors
/// The [`Reason`]: the condition that could not be proved.
pub(super) fn cross<Sys: Variational + Impacting>(
    surfaces: &Surfaces<'_, '_, Sys>,
    strike: &Strike,
    (t, frame): (f64, &Frame<Sys>),
    sides: &Sides<Sys>,
    derivative: Option<&Matrix<Sys>>,
) -> Result<Crossed<Sys>, Reason> {
    let surface = strike.surface;
    let approach = Approach::new(surfaces, surface, (t, frame))?;
    let meeting = approach.meeting()?;
    let sides_before = approach.pass_others(&meeting, sides)?;
    approach.struck(strike, &meeting, &sides_before, derivative)
}

impl<'s, 'f, 'a, Sys: Variational + Impacting> Approach<'s, 'f, 'a, Sys> {
    /// Motion for a length of time after which all motions have certainly passed the surface.
    fn new(
        surfaces: &'s Surfaces<'f, 'a, Sys>,
        surface: usize,
        (t, frame): (f64, &'s Frame<Sys>),
    ) -> Result<Self, Reason> {
        let hull = frame.hull();
        let [gap, rate] = gap_now(surfaces, surface, t, &hull).ok_or(Reason::NoTube)?;
        let graze = Reason::MayGraze { surface };
        if rate.hi >= 0.0 {
            return Err(graze);
        }
        if gap.hi <= 0.0 {
            return Err(Reason::MayBeBehind { surface });
        }
        let least = UNITS * f64::EPSILON * t.abs() + f64::MIN_POSITIVE;
        let mut length = 1.5 * gap.hi / rate.hi.abs() + least;
        for _ in 0..TRIALS {
            let later = t + length;
            let unit = Interval::point(later) - Interval::point(t);
            let approach = Self::over(surfaces, surface, (t, frame), unit);
            let approach = approach.ok_or(Reason::NoTube)?;
            if approach.rate.hi >= 0.0 {
                return Err(graze);
            }
            if approach.gap(Interval::point(1.0)).ok_or(graze)?.hi < 0.0 {
                return match approach.gap(Interval::ZERO).ok_or(graze)?.lo > 0.0 {
                    true => Ok(approach),
                    false => Err(graze),
                };
            }
            length *= 2.0;
        }
        Err(graze)
    }

    /// Motion from `t` for the time `unit`.
    fn over(
        surfaces: &'s Surfaces<'f, 'a, Sys>,
        surface: usize,
        (t, frame): (f64, &'s Frame<Sys>),
        unit: Interval,
    ) -> Option<Self> {
        let field = surfaces.field;
        let (hull, now) = (frame.hull(), Interval::point(t));
        let during = Interval::new(0.0, unit.hi);
        let tube = field.tube(&hull, now + during, during)?;
        let all = Course::new(field, &hull, &tube, now, unit, ORDER)?;
        let point = Bounds::point(&frame.centre);
        let centre = Course::new(field, &point, &tube, now, unit, ORDER)?;
        let whole = all.part(Interval::new(0.0, 1.0))?;
        let rate = field.gaps(&whole)?.as_slice()[surface].rate * unit;
        let mut approach = Self {
            surfaces,
            surface,
            frame,
            t,
            unit,
            tube,
            all,
            centre,
            turned: [Matrix::zero(hull.count()); BLOCKS],
            slopes: [Bounds::point(&hull.lo.zeroed()); BLOCKS],
            whole,
            rate,
        };
        for (block, k, axis) in frame.axes() {
            let (column, slope) = approach.swept(&axis)?;
            approach.slopes[block].set(k, slope);
            approach.turned[block].set_column(k, &column);
        }
        Some(approach)
    }

    /// `Dphi q`: enclosures of the derivatives of the states and of the gap along a direction, at any time until `t_1`.
    fn swept(&self, direction: &Bounds<Sys::State>) -> Option<(Bounds<Sys::State>, Interval)> {
        let (field, whole) = (self.surfaces.field, &self.whole);
        let hull = self.frame.hull();
        let from = [&hull, &self.tube, direction];
        let (now, units) = (Interval::point(self.t), Interval::new(0.0, 1.0));
        let column = carried(field, from, now, self.unit, units, ORDER)?;
        let states = rated_row::<Sys>(&whole.states, &column);
        let steady = Rated::steady(whole.times);
        let gaps = field
            .system
            .clearances(&field.steady_parameters(), steady, &states)
            .ok()?;
        Some((column, gaps.as_slice()[self.surface].rate))
    }

    /// Enclosure of the gap of all motions after these units of time.
    fn gap(&self, units: Interval) -> Option<Interval> {
        let of_all = self.gap_of(&self.all, units)?;
        let of_centre = self.gap_of(&self.centre, units)?;
        let gap = of_centre + self.frame.along(|block, k| self.slopes[block].at(k));
        Some(gap.intersection(of_all).unwrap_or(of_all))
    }

    fn gap_of(&self, course: &Course<'_, '_, Sys>, units: Interval) -> Option<Interval> {
        let (times, states) = (course.times(units), course.at(units));
        let gaps = self.surfaces.field.gaps_at(times, &states)?;
        let gap = gaps.as_slice()[self.surface];
        (!gap.is_whole()).then_some(gap)
    }

    /// Enclosure of the rate of the gap during `units`.
    fn rate_in(&self, units: Interval) -> Option<Interval> {
        let part = self.all.part(units)?;
        let rate = self.surfaces.field.gaps(&part)?.as_slice()[self.surface].rate * self.unit;
        rate.intersection(self.rate)
    }

    /// Narrows the units of time in which a gap vanishes (interval Newton iteration).
    fn narrowed(
        &self,
        mut units: Interval,
        gap: impl Fn(Interval) -> Option<Interval>,
    ) -> Option<Interval> {
        for _ in 0..STEPS {
            let middle = Interval::point(units.middle());
            let newton = middle - gap(middle)? / self.rate_in(units)?;
            let narrower = units.intersection(newton)?;
            let is_last = narrower.width() > 0.75 * units.width();
            units = narrower;
            if is_last {
                break;
            }
        }
        Some(units)
    }

    /// Enclosures of the times and states at which the motions meet the surface.
    fn meeting(&self) -> Result<Meeting<Sys>, Reason> {
        let surface = self.surface;
        let meeting = self.find_meeting();
        let meeting = meeting.ok_or(Reason::MayGraze { surface })?;
        let (field, times) = (self.surfaces.field, self.all.times(meeting.units));
        let states = row::<Sys>(&meeting.before);
        match field
            .system
            .counts_throughout(field.parameters(), surface, times, &states)
        {
            Some(true) => Ok(meeting),
            _ => Err(Reason::UnsureCondition { surface }),
        }
    }

    fn find_meeting(&self) -> Option<Meeting<Sys>> {
        let units = self.narrowed(Interval::new(0.0, 1.0), |units| self.gap(units))?;
        let centre_units = self.narrowed(units, |units| self.gap_of(&self.centre, units))?;
        let part = self.all.part(units)?;
        let rate = self.rate_in(units)?;
        let n = part.states.count();
        let delays = [0, 1]
            .map(|block: usize| Bounds::of(n, |k| -(self.slopes[block].at(k) / rate) * self.unit));
        Some(Meeting {
            units,
            centre_units,
            before: part.states,
            rates_before: part.rates,
            delays,
            rate,
        })
    }

    /// Proves that no motion meets another surface before the last motion meets this one. Returns the sides of all
    /// surfaces.
    fn pass_others(
        &self,
        meeting: &Meeting<Sys>,
        sides: &Sides<Sys>,
    ) -> Result<Sides<Sys>, Reason> {
        let surface = self.surface;
        let part = self.all.part(Interval::new(0.0, meeting.units.hi));
        let passed = self.surfaces.passed_in(part, sides, Some(surface));
        passed.map_err(|(other, reason)| together(surface, other, reason))
    }

    /// Applies the law, and continues to a time after all impacts.
    fn struck(
        &self,
        strike: &Strike,
        meeting: &Meeting<Sys>,
        sides_before: &Sides<Sys>,
        derivative: Option<&Matrix<Sys>>,
    ) -> Result<Crossed<Sys>, Reason> {
        let surface = self.surface;
        let unsure = Reason::UnsureLaw { surface };
        let is_map = self.check_map(strike, meeting)?;
        let times = self.all.times(meeting.units);
        let later = times.hi;
        let rest = (Interval::point(later) - Interval::point(self.t)) / self.unit;
        let centre = self.struck_centre(strike, meeting, rest).ok_or(unsure)?;
        let n = centre.after.count();
        let mut changes = [Matrix::<Sys>::zero(n); BLOCKS];
        let mut after = self.applied(strike, times, &meeting.before).ok_or(unsure)?;
        for (block, k, _) in self.frame.axes() {
            let along = self.met_along(meeting, &self.turned[block], &meeting.delays[block], k);
            let delay = meeting.delays[block].at(k);
            let met = (times, &meeting.before);
            let column = applied_along(self.surfaces.field, strike, met, &along, delay);
            changes[block].set_column(k, &column.ok_or(unsure)?);
        }
        let centred = Bounds::of(n, |i| {
            centre.after.at(i) + self.frame.along(|block, k| changes[block].at(i, k))
        });
        after = after.within(&centred);
        let before = Bounds::of(n, |i| {
            let along = |block: usize, k: usize| {
                self.met_along(meeting, &self.turned[block], &meeting.delays[block], k)
                    .at(i)
            };
            centre.before.at(i) + self.frame.along(along)
        });
        let time = centre.time + self.frame.along(|block, k| meeting.delays[block].at(k));
        let sides = self.sides_after(is_map, sides_before);
        let departure = Departure {
            surfaces: self.surfaces,
            surface,
            times,
            unit: self.unit,
            rest: Interval::new(0.0, ahead(rest, meeting.units).hi),
        };
        let departed = departure.departed(&after, &sides)?;
        let column = |along: &Bounds<Sys::State>, delay: Interval| {
            let column = departure.carried(&departed, &after, along, delay);
            column.ok_or(Reason::NoTube)
        };
        let mut turned = [Matrix::<Sys>::zero(n); BLOCKS];
        for (block, k, _) in self.frame.axes() {
            let along = changes[block].column(k);
            let later = column(&along, meeting.delays[block].at(k))?;
            turned[block].set_column(k, &later);
        }
        let mut derivatives = None;
        if let Some(derivative) = derivative {
            let mut both = [Matrix::<Sys>::zero(n); BLOCKS];
            for k in 0..n {
                let struck = self.struck_along(strike, meeting, &derivative.column(k));
                let (along, delay) = struck.ok_or(unsure)?;
                both[0].set_column(k, &along);
                both[1].set_column(k, &column(&along, delay)?);
            }
            derivatives = Some(both);
        }
        Ok(Crossed {
            time: time.intersection(times).unwrap_or(times),
            before: meeting.before.within(&before),
            after,
            t: later,
            frame: self.frame.moved(&centre.moved, &turned),
            sides: departed.sides,
            sides_before: *sides_before,
            derivatives,
        })
    }

    /// The sides of all surfaces just after the law.
    fn sides_after(&self, is_map: bool, before: &Sides<Sys>) -> Sides<Sys> {
        let (system, mut sides) = (self.surfaces.field.system, *before);
        if !is_map {
            sides[self.surface] = Side::Above;
            return sides;
        }
        for (other, side) in sides.iter_mut().enumerate() {
            *side = match system.lands_on(self.surface, other) {
                true => Side::On,
                false => Side::Unknown,
            };
        }
        sides
    }

    /// Derivatives of the state after the impact and of the impact time, along a direction at `t_0`.
    fn struck_along(
        &self,
        strike: &Strike,
        meeting: &Meeting<Sys>,
        direction: &Bounds<Sys::State>,
    ) -> Option<(Bounds<Sys::State>, Interval)> {
        let (column, slope) = self.swept(direction)?;
        let delay = -(slope / meeting.rate) * self.unit;
        let along = Bounds::of(column.count(), |i| {
            column.at(i) + meeting.rates_before.at(i) * delay
        });
        let met = (self.all.times(meeting.units), &meeting.before);
        let after = applied_along(self.surfaces.field, strike, met, &along, delay)?;
        Some((after, delay))
    }

    /// The impact of the centre, and its state `rest` units of time after `t_0`.
    ///
    /// The result is a function of the time `tau` of the impact and of the state `x` at that time. It is evaluated at
    /// one time and one state. Its derivatives with respect to both enclose the difference at other times and states.
    fn struck_centre(
        &self,
        strike: &Strike,
        meeting: &Meeting<Sys>,
        rest: Interval,
    ) -> Option<Centre<Sys::State>> {
        let (field, course, units) = (self.surfaces.field, &self.centre, meeting.centre_units);
        let middle = Interval::point(units.middle());
        let (time, time_in_middle) = (course.times(units), course.times(middle));
        let late = (units - middle) * self.unit;
        let near = course.at(middle);
        let arriving = course.at(units);
        let n = near.count();
        let before = Bounds::of(n, |i| arriving.at(i).hull(near.at(i)));
        let all_after = self.applied(strike, time, &before)?;
        let point = Bounds::point(&near.middle());
        let after_in_middle = self.applied(strike, time_in_middle, &point)?;
        let [rates_before, rates_after] = [&before, &all_after].map(|at| field.rates(time, at));
        let (rates_before, rates_after) = (rates_before?, rates_after?);
        let offset = Bounds::of(n, |i| near.at(i) - point.at(i));
        let along = |along: &Bounds<Sys::State>, delay: f64| {
            applied_along(
                field,
                strike,
                (time, &before),
                along,
                Interval::point(delay),
            )
        };
        let (by_offset, by_time) = (along(&offset, 0.0)?, along(&rates_before, 1.0)?);
        let after = Bounds::of(n, |i| {
            after_in_middle.at(i) + by_offset.at(i) + by_time.at(i) * late
        });
        let ahead_of = |units: Interval| ahead(rest, units);
        let during = Interval::new(0.0, (self.unit * ahead_of(units)).hi);
        let tube = field.tube(&all_after, time + during, during)?;
        let from = Course::new(
            field,
            &after_in_middle,
            &tube,
            time_in_middle,
            self.unit,
            ORDER,
        )?;
        let end = from.at(ahead_of(middle));
        let shift = Bounds::of(n, |i| by_time.at(i) - rates_after.at(i));
        let carried = |along: &Bounds<Sys::State>| {
            let from = [&all_after, &tube, along];
            carried(field, from, time, self.unit, ahead_of(units), ORDER)
        };
        let (by_offset, by_time) = (carried(&by_offset)?, carried(&shift)?);
        let moved = Bounds::of(n, |i| end.at(i) + by_offset.at(i) + by_time.at(i) * late);
        moved.is_finite().then_some(Centre {
            time,
            before: arriving,
            after,
            moved,
        })
    }

    /// Returns true if the law is a map. Refuses a map that a run in doubles refuses at the centre.
    fn check_map(&self, strike: &Strike, meeting: &Meeting<Sys>) -> Result<bool, Reason> {
        let (surface, field) = (self.surface, self.surfaces.field);
        let is_map = strike.law(field.system, field.parameters()).is_map();
        if is_map {
            let t = self.centre.times(meeting.centre_units).middle();
            let centre = self.centre.at(meeting.centre_units).middle();
            let landing = Impacting::landing(field.system, surface, t, &centre);
            landing.map_err(|outcome| match outcome {
                Outcome::ResetOffConstraint { .. } => Reason::OffConstraint { surface },
                _ => Reason::UnsureLaw { surface },
            })?;
        }
        Ok(is_map)
    }

    /// Enclosure of the states that the law gives for a box of states.
    fn applied(
        &self,
        strike: &Strike,
        times: Interval,
        states: &Bounds<Sys::State>,
    ) -> Option<Bounds<Sys::State>> {
        let field = self.surfaces.field;
        let after = strike.applied(field.system, field.parameters(), times, &row::<Sys>(states));
        let after = bounds::<Sys::State>(after.ok()??.as_slice());
        after.is_finite().then_some(after)
    }

    /// Derivatives of the state at the surface along an axis.
    fn met_along(
        &self,
        meeting: &Meeting<Sys>,
        turned: &Matrix<Sys>,
        delays: &Bounds<Sys::State>,
        k: usize,
    ) -> Bounds<Sys::State> {
        Bounds::of(turned.count(), |i| {
            turned.at(i, k) + meeting.rates_before.at(i) * delays.at(k)
        })
    }
}

/// Directional derivative of the law: change of the state after it for the change `along` of the state before it and
/// the change `delay` of the time.
fn applied_along<Sys: Variational + Impacting>(
    field: &Field<'_, Sys>,
    strike: &Strike,
    (times, states): (Interval, &Bounds<Sys::State>),
    along: &Bounds<Sys::State>,
    delay: Interval,
) -> Option<Bounds<Sys::State>> {
    let times = Rated {
        value: times,
        rate: delay,
    };
    let states = rated_row::<Sys>(states, along);
    let after = strike.applied(field.system, &field.steady_parameters(), times, &states);
    let after = after.ok()??;
    let changes = Bounds::of(along.count(), |i| after.as_slice()[i].rate);
    changes.is_finite().then_some(changes)
}

/// The difference `rest - units`, with negative values cut off at 0.
fn ahead(rest: Interval, units: Interval) -> Interval {
    let rest = rest - units;
    Interval::new(rest.lo.max(0.0), rest.hi.max(0.0))
}

/// Enclosures of the gap of a surface and of its rate at a time.
fn gap_now<Sys: Variational + Impacting>(
    surfaces: &Surfaces<'_, '_, Sys>,
    surface: usize,
    t: f64,
    states: &Bounds<Sys::State>,
) -> Option<[Interval; 2]> {
    let (field, now) = (surfaces.field, Interval::point(t));
    let rates = field.rates(now, states)?;
    let times = Rated {
        value: now,
        rate: Interval::point(1.0),
    };
    let states = rated_row::<Sys>(states, &rates);
    let gaps = field
        .system
        .clearances(&field.steady_parameters(), times, &states)
        .ok()?;
    let gap = gaps.as_slice()[surface];
    Some([gap.value, gap.rate])
}
