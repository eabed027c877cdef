//! Taylor series with remainder for all motions that start in a box, and for their derivatives.
//!
//! A motion `y` that stays in a tube `B` for the time `h` satisfies, with the Taylor coefficients `c_k`,
//!
//! ```text
//! y(t + s) is in  sum_(k<p) s^k c_k(y(t))  +  s^p c_p(B),   0 <= s <= h
//! ```
//!
//! Over [`Rated`] numbers the same holds for the derivative along a direction. Its tube follows in the same way from
//! the variational equation.

use super::frame::Bounds;
use super::lost::Reason;
use crate::contract::Variational;
use crate::error::Fault;
use crate::integrate::taylor::expansion::Expansion;
use crate::jet::LENGTH;
use crate::numbers::{Interval, Numbers, Rated, Row};
use crate::state::StateVector;

/// Maximum number of trials for a tube, or the number of components if that is larger: in a chain at rest, each trial sets
/// one more component in motion.
const TRIALS: usize = 6;

/// Relative enlargement of a trial tube over the last one.
const ROOM: f64 = 0.1;

/// A system with an interval for each parameter.
pub(super) struct Field<'a, Sys: Variational> {
    pub(super) system: &'a Sys,
    parameters: Sys::Parameters<Interval>,
}

impl<Sys: Variational> Clone for Field<'_, Sys> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<Sys: Variational> Copy for Field<'_, Sys> {}

impl<'a, Sys: Variational> Field<'a, Sys> {
    /// The system with its own parameters.
    pub(super) fn new(system: &'a Sys) -> Self {
        let values = system.parameters();
        let mut parameters = Sys::Parameters::<Interval>::zeros(values.as_slice().len());
        for (parameter, value) in parameters.as_mut_slice().iter_mut().zip(values.as_slice()) {
            *parameter = Interval::of(*value);
        }
        Self { system, parameters }
    }

    /// Replaces a parameter by a range; an index past the end changes nothing.
    pub(super) fn set_parameter(&mut self, index: usize, range: Interval) {
        if let Some(parameter) = self.parameters.as_mut_slice().get_mut(index) {
            *parameter = range;
        }
    }

    pub(super) fn parameters(&self) -> &Sys::Parameters<Interval> {
        &self.parameters
    }

    /// The parameters as numbers with derivative 0 along every direction.
    pub(super) fn steady_parameters(&self) -> Sys::Parameters<Rated> {
        let values = self.parameters.as_slice();
        let mut parameters = Sys::Parameters::<Rated>::zeros(values.len());
        for (parameter, value) in parameters.as_mut_slice().iter_mut().zip(values) {
            *parameter = Rated::steady(*value);
        }
        parameters
    }

    /// Enclosure of the rates in a box.
    pub(super) fn rates(
        &self,
        times: Interval,
        states: &Bounds<Sys::State>,
    ) -> Option<Bounds<Sys::State>> {
        let mut firsts = Sys::Firsts::<Interval>::zeros(self.system.firsts_len());
        self.system
            .begin(&self.parameters, times, &row::<Sys>(states), &mut firsts)
            .ok()?;
        let rates = Bounds::of(states.count(), |i| firsts.as_slice()[i]);
        rates.is_finite().then_some(rates)
    }

    /// Reason why a box has no rates: they may not exist, or they are not available over intervals.
    pub(super) fn no_rates(&self, times: Interval, states: &Bounds<Sys::State>) -> Reason {
        let row = row::<Sys>(states);
        let mut firsts = Sys::Firsts::<Interval>::zeros(self.system.firsts_len());
        let of_values = self
            .system
            .begin(&self.parameters, times, &row, &mut firsts);
        let steady = rated_row::<Sys>(states, &Bounds::point(&states.lo.zeroed()));
        let (parameters, times) = (self.steady_parameters(), Rated::steady(times));
        let mut firsts = Sys::Firsts::<Rated>::zeros(self.system.firsts_len());
        let of_rates = self.system.begin(&parameters, times, &steady, &mut firsts);
        match of_values.and(of_rates) {
            Err(Fault::NotDerived) => Reason::NotDerived,
            _ => Reason::NoTube,
        }
    }

    /// Enclosure of the directional derivatives of the rates, along directions in the box `along`.
    fn changes(
        &self,
        times: Interval,
        states: &Bounds<Sys::State>,
        along: &Bounds<Sys::State>,
    ) -> Option<Bounds<Sys::State>> {
        let mut firsts = Sys::Firsts::<Rated>::zeros(self.system.firsts_len());
        let row = rated_row::<Sys>(states, along);
        let (parameters, times) = (self.steady_parameters(), Rated::steady(times));
        self.system
            .begin(&parameters, times, &row, &mut firsts)
            .ok()?;
        let changes = Bounds::of(states.count(), |i| firsts.as_slice()[i].rate);
        changes.is_finite().then_some(changes)
    }

    /// A box that contains every motion from `start` over the time `during`, and in which the rates are continuously
    /// differentiable; `None` if none is found. `times`: the whole step.
    pub(super) fn tube(
        &self,
        start: &Bounds<Sys::State>,
        times: Interval,
        during: Interval,
    ) -> Option<Bounds<Sys::State>> {
        let tube = held(start, during, |tube| self.rates(times, tube))?;
        // Rates may jump although they are finite: across the cut of `atan2` a series goes on as if there were no jump.
        let steady = Bounds::point(&tube.lo.zeroed());
        self.changes(times, &tube, &steady)?;
        Some(tube)
    }

    /// A box that contains the derivatives of all motions in `tube` over the time `during`, from the box of directions
    /// `along`.
    pub(super) fn tube_along(
        &self,
        tube: &Bounds<Sys::State>,
        along: &Bounds<Sys::State>,
        times: Interval,
        during: Interval,
    ) -> Option<Bounds<Sys::State>> {
        held(along, during, |along| self.changes(times, tube, along))
    }

    /// The Taylor series of all motions from a box, in units of `unit`, of degree `order`.
    pub(super) fn series(
        &self,
        from: &Bounds<Sys::State>,
        times: Interval,
        unit: Interval,
        order: usize,
    ) -> Option<Expansion<Sys, Interval>> {
        expanded(
            self.system,
            &self.parameters,
            times,
            &row::<Sys>(from),
            unit,
            order,
        )
    }

    /// Same as [`Field::series`], with the derivatives along directions.
    pub(super) fn series_along(
        &self,
        from: &Bounds<Sys::State>,
        along: &Bounds<Sys::State>,
        times: Interval,
        unit: Interval,
        order: usize,
    ) -> Option<Expansion<Sys, Rated>> {
        let parameters = self.steady_parameters();
        let start = rated_row::<Sys>(from, along);
        expanded(
            self.system,
            &parameters,
            Rated::steady(times),
            &start,
            unit_of(unit),
            order,
        )
    }
}

fn unit_of(unit: Interval) -> Rated {
    Rated::steady(unit)
}

fn expanded<Sys: Variational, L: Numbers>(
    system: &Sys,
    parameters: &Sys::Parameters<L>,
    t: L,
    start: &Sys::Row<L>,
    unit: L,
    order: usize,
) -> Option<Expansion<Sys, L>> {
    let mut series = Expansion::of(system);
    series.begin(system, parameters, t, start).ok()?;
    series.advance(system, parameters, unit, order, start);
    Some(series)
}

/// A box that solutions from `start` with rates in `rates(box)` do not leave during `during`, an interval that begins
/// at 0 (Picard-Lindelof); `None` if none is found.
fn held<S: StateVector>(
    start: &Bounds<S>,
    during: Interval,
    rates: impl Fn(&Bounds<S>) -> Option<Bounds<S>>,
) -> Option<Bounds<S>> {
    let n = start.count();
    let reached = |tube: &Bounds<S>| {
        let rates = rates(tube)?;
        let reached = Bounds::of(n, |i| start.at(i) + during * rates.at(i));
        reached.is_finite().then_some(reached)
    };
    let mut tube = reached(start)?;
    for _ in 0..TRIALS.max(n) {
        let wider = Bounds::of(n, |i| {
            let range = tube.at(i).hull(start.at(i));
            range.widened(ROOM * range.width() + f64::MIN_POSITIVE)
        });
        let found = reached(&wider)?;
        if (0..n).all(|i| wider.at(i).contains(found.at(i))) {
            return reached(&found);
        }
        tube = Bounds::of(n, |i| found.at(i).hull(tube.at(i)));
    }
    None
}

/// A series with its remainder.
pub(super) struct Arc<Sys: Variational, L: Numbers> {
    rows: [Sys::Row<L>; LENGTH],
    order: usize,
}

impl<Sys: Variational, L: Numbers> Arc<Sys, L> {
    /// Builds the arc from coefficients 0 to `order - 1` of a series, and coefficient `order` of the remainder.
    pub(super) fn new(
        series: &Expansion<Sys, L>,
        remainder: &Expansion<Sys, L>,
        order: usize,
    ) -> Self {
        let mut rows = series.coefficients;
        rows[order] = remainder.coefficients[order];
        Self { rows, order }
    }

    /// Enclosure of the values after `units` units of time (Horner scheme).
    pub(super) fn at(&self, units: L) -> Sys::Row<L> {
        let mut sums = self.rows[self.order];
        for row in self.rows[..self.order].iter().rev() {
            for (sum, entry) in sums.as_mut_slice().iter_mut().zip(row.as_slice()) {
                *sum = *sum * units + *entry;
            }
        }
        sums
    }
}

/// A box as a row of intervals.
pub(super) fn row<Sys: Variational>(bounds: &Bounds<Sys::State>) -> Sys::Row<Interval> {
    let mut row = Sys::Row::<Interval>::zeros(bounds.count());
    for (i, entry) in row.as_mut_slice().iter_mut().enumerate() {
        *entry = bounds.at(i);
    }
    row
}

/// A box as a row of intervals with derivatives along directions.
pub(super) fn rated_row<Sys: Variational>(
    bounds: &Bounds<Sys::State>,
    along: &Bounds<Sys::State>,
) -> Sys::Row<Rated> {
    let mut row = Sys::Row::<Rated>::zeros(bounds.count());
    for (i, entry) in row.as_mut_slice().iter_mut().enumerate() {
        *entry = Rated {
            value: bounds.at(i),
            rate: along.at(i),
        };
    }
    row
}

/// A row of intervals as a box.
pub(super) fn bounds<S: StateVector>(row: &[Interval]) -> Bounds<S> {
    Bounds::of(row.len(), |i| row[i])
}
