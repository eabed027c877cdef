//! Motion of a box of states after an impact, and propagation of derivatives along it.

use super::course::{Course, Sides, Surfaces};
use super::frame::Bounds;
use super::lost::Reason;
use super::series::{Arc, Field};
use crate::contract::{Impacting, Variational};
use crate::numbers::{Interval, Rated, Row};

/// Order of the series near an impact.
pub(super) const ORDER: usize = 8;

/// Motion from an impact, at any of its possible times, to one time after it.
pub(super) struct Departure<'f, 'a, Sys: Variational + Impacting> {
    pub(super) surfaces: &'f Surfaces<'f, 'a, Sys>,
    pub(super) surface: usize,
    /// Enclosure of the time of the impact.
    pub(super) times: Interval,
    pub(super) unit: Interval,
    /// Enclosure of the time from the impact to the end of this motion, in units.
    pub(super) rest: Interval,
}

/// All motions after an impact.
pub(super) struct Departed<Sys: Variational + Impacting> {
    pub(super) tube: Bounds<Sys::State>,
    pub(super) rates: Bounds<Sys::State>,
    pub(super) sides: Sides<Sys>,
}

impl<Sys: Variational + Impacting> Departure<'_, '_, Sys> {
    /// Proves that the motion meets no surface. Returns its tube, its rates at the impact, and the sides of all
    /// surfaces.
    pub(super) fn departed(
        &self,
        after: &Bounds<Sys::State>,
        sides: &Sides<Sys>,
    ) -> Result<Departed<Sys>, Reason> {
        let (field, unit, surface) = (self.surfaces.field, self.unit, self.surface);
        let during = Interval::new(0.0, (unit * self.rest).hi);
        let times = self.times + during;
        let tube = field.tube(after, times, during).ok_or(Reason::NoTube)?;
        let course = Course::new(field, after, &tube, self.times, unit, ORDER);
        let course = course.ok_or(Reason::NoTube)?;
        let passed = self.surfaces.passed_in(course.part(self.rest), sides, None);
        let sides = passed.map_err(|(other, reason)| match other == Some(surface) {
            true => Reason::MayStay { surface },
            false => together(surface, other, reason),
        })?;
        let rates = field.rates(self.times, after).ok_or(Reason::NoTube)?;
        Ok(Departed { tube, rates, sides })
    }

    /// Derivatives of the state at the end of this motion, from its derivatives after the impact, `along`, and the
    /// derivative of the time of the impact, `delay`.
    pub(super) fn carried(
        &self,
        departed: &Departed<Sys>,
        after: &Bounds<Sys::State>,
        along: &Bounds<Sys::State>,
        delay: Interval,
    ) -> Option<Bounds<Sys::State>> {
        let along = Bounds::of(along.count(), |i| {
            along.at(i) - departed.rates.at(i) * delay
        });
        let from = [after, &departed.tube, &along];
        let (field, unit) = (self.surfaces.field, self.unit);
        carried(field, from, self.times, unit, self.rest, ORDER)
    }
}

/// Enclosure of the derivatives of the flow along directions, after `units` of time, for all motions from a box that
/// stay in a tube.
pub(super) fn carried<Sys: Variational>(
    field: &Field<'_, Sys>,
    [from, tube, along]: [&Bounds<Sys::State>; 3],
    start: Interval,
    unit: Interval,
    units: Interval,
    order: usize,
) -> Option<Bounds<Sys::State>> {
    let during = Interval::new(0.0, (unit * units).hi);
    let times = start + during;
    let tube_along = field.tube_along(tube, along, times, during)?;
    let series = field.series_along(from, along, start, unit, order)?;
    let remainder = field.series_along(tube, &tube_along, times, unit, order)?;
    let end = Arc::new(&series, &remainder, order).at(Rated::steady(units));
    let changes = Bounds::of(from.count(), |i| end.as_slice()[i].rate);
    changes.is_finite().then_some(changes)
}

/// The reason for a refusal if the motion may meet another surface near this impact.
pub(super) fn together(surface: usize, other: Option<usize>, reason: Reason) -> Reason {
    match (reason, other) {
        (Reason::UnsureCondition { .. }, _) | (_, None) => reason,
        (_, Some(other)) => Reason::MayMeetTogether { surface, other },
    }
}
