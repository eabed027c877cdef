//! Gaps of all surfaces along a step of certified motion.
//!
//! A step is divided into parts. On each part the states and their rates are enclosed, and with them the values and
//! rates of every gap. A surface is certainly not met in a part in which its gap is positive, in which it does not
//! count, or in which its gap rises and is not negative at the start. A passable surface is met from above only.

use super::frame::Bounds;
use super::lost::Reason;
use super::series::{Arc, Field, bounds, rated_row, row};
use crate::contract::{Impacting, Variational};
use crate::numbers::{Interval, Rated, Row};
use crate::per_surface::PerSurface;

/// Length of the shortest part of a step that is examined, as a fraction of the step.
const SHORTEST: f64 = 1.0 / (1_u64 << 44) as f64;

/// Sides of the surfaces on which all motions are known to lie.
pub(super) type Sides<Sys> = PerSurface<Side, <Sys as Impacting>::Gaps>;

/// The side of one surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// Not known.
    Unknown,
    /// The gap is not negative.
    Above,
    /// The gap is not positive.
    Below,
    /// The gap is 0.
    On,
}

/// A surface that may be met, with a fraction of the step up to which no surface is met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Met {
    /// The surface; `None` where the motion or its gaps are not enclosed.
    pub(super) surface: Option<usize>,
    pub(super) reason: Reason,
    pub(super) at: f64,
}

/// Enclosures of states, times and their rates on a part of a step.
pub(super) struct Part<S> {
    pub(super) times: Interval,
    pub(super) states: Bounds<S>,
    pub(super) rates: Bounds<S>,
    /// Time and states in the middle of the part, and the range of times relative to the middle.
    middle: (Interval, Bounds<S>, Interval),
}

/// All motions of a box along a step.
pub(super) struct Course<'f, 'a, Sys: Variational> {
    field: &'f Field<'a, Sys>,
    arc: Arc<Sys, Interval>,
    /// Range of the times at which the motions begin.
    start: Interval,
    unit: Interval,
}

impl<'f, 'a, Sys: Variational> Course<'f, 'a, Sys> {
    /// Motions from the box `from` at the times `start`. The tube must contain them for the time `unit`. The series
    /// has degree `order`.
    pub(super) fn new(
        field: &'f Field<'a, Sys>,
        from: &Bounds<Sys::State>,
        tube: &Bounds<Sys::State>,
        start: Interval,
        unit: Interval,
        order: usize,
    ) -> Option<Self> {
        let series = field.series(from, start, unit, order)?;
        let times = start + unit * Interval::new(0.0, 1.0);
        let remainder = field.series(tube, times, unit, order)?;
        Some(Self {
            field,
            arc: Arc::new(&series, &remainder, order),
            start,
            unit,
        })
    }

    /// Enclosure of the times after `units` units of time.
    pub(super) fn times(&self, units: Interval) -> Interval {
        self.start + self.unit * units
    }

    /// Enclosure of the states after `units` units of time.
    pub(super) fn at(&self, units: Interval) -> Bounds<Sys::State> {
        bounds(self.arc.at(units).as_slice())
    }

    /// Enclosures on a part of the step.
    pub(super) fn part(&self, units: Interval) -> Option<Part<Sys::State>> {
        let times = self.times(units);
        let middle = Interval::point(units.middle());
        let from_middle = self.unit * (units - middle);
        let (crude, centre) = (self.at(units), self.at(middle));
        let rates = self.field.rates(times, &crude)?;
        let centred = Bounds::of(crude.count(), |i| centre.at(i) + from_middle * rates.at(i));
        let states = crude.within(&centred);
        Some(Part {
            times,
            rates: self.field.rates(times, &states)?,
            states,
            middle: (self.times(middle), centre, from_middle),
        })
    }
}

impl<Sys: Variational> Field<'_, Sys> {
    /// Enclosures of all gaps and their rates on a part of a step.
    pub(super) fn gaps(&self, part: &Part<Sys::State>) -> Option<Sys::Clearances<Rated>> {
        let times = Rated {
            value: part.times,
            rate: Interval::point(1.0),
        };
        let states = rated_row::<Sys>(&part.states, &part.rates);
        let mut gaps = self
            .system
            .clearances(&self.steady_parameters(), times, &states)
            .ok()?;
        let (time, states, from_middle) = &part.middle;
        let centred = self.gaps_at(*time, states)?;
        let all = gaps.as_mut_slice().iter_mut().zip(centred.as_slice());
        for (gap, centre) in all {
            let centred = *centre + gap.rate * *from_middle;
            gap.value = gap.value.intersection(centred).unwrap_or(centred);
        }
        Some(gaps)
    }

    /// Enclosures of all gaps for states at some times.
    pub(super) fn gaps_at(
        &self,
        times: Interval,
        states: &Bounds<Sys::State>,
    ) -> Option<Sys::Clearances<Interval>> {
        self.system
            .clearances(self.parameters(), times, &row::<Sys>(states))
            .ok()
    }
}

/// Surfaces, with flags for those that may be passed from above to below.
pub(super) struct Surfaces<'f, 'a, Sys: Variational + Impacting> {
    pub(super) field: &'f Field<'a, Sys>,
    pub(super) passable: PerSurface<bool, <Sys as Impacting>::Gaps>,
}

impl<Sys: Variational + Impacting> Surfaces<'_, '_, Sys> {
    pub(super) fn is_passable(&self, surface: usize) -> bool {
        self.passable[surface]
    }

    /// Sides of all surfaces after a whole step, or the first surface that may be met in it.
    pub(super) fn passed(
        &self,
        course: &Course<'_, '_, Sys>,
        sides: &Sides<Sys>,
    ) -> Result<Sides<Sys>, Met> {
        let mut sides = *sides;
        let (mut from, mut length, mut is_easy) = (0.0, 1.0, true);
        while from < 1.0 {
            let to = f64::min(from + length, 1.0);
            match self.passed_in(course.part(Interval::new(from, to)), &sides, None) {
                Ok(later) => {
                    (sides, from) = (later, to);
                    length *= if is_easy { 2.0 } else { 1.0 };
                    is_easy = true;
                }
                Err((surface, reason)) => {
                    length *= 0.5;
                    is_easy = false;
                    if length < SHORTEST || from + length == from {
                        let at = from;
                        return Err(Met {
                            surface,
                            reason,
                            at,
                        });
                    }
                }
            }
        }
        Ok(sides)
    }

    /// Sides of all surfaces after a part of a step, from those at its start; or a surface that may be met, with the
    /// reason; `None` where nothing is enclosed. The surface `except` is not examined and keeps its side.
    pub(super) fn passed_in(
        &self,
        part: Option<Part<Sys::State>>,
        sides: &Sides<Sys>,
        except: Option<usize>,
    ) -> Result<Sides<Sys>, (Option<usize>, Reason)> {
        let unknown = (None, Reason::NoTube);
        let part = part.ok_or(unknown)?;
        let gaps = self.field.gaps(&part).ok_or(unknown)?;
        let mut later = *sides;
        for (surface, gap) in gaps.as_slice().iter().enumerate() {
            if except == Some(surface) {
                continue;
            }
            let side = self.side_after(surface, gap, sides[surface], &part);
            later[surface] = side.map_err(|reason| (Some(surface), reason))?;
        }
        Ok(later)
    }

    /// The side of a surface at the end of a part in which it is certainly not met.
    fn side_after(
        &self,
        surface: usize,
        gap: &Rated,
        side: Side,
        part: &Part<Sys::State>,
    ) -> Result<Side, Reason> {
        if gap.value.lo > 0.0 {
            return Ok(Side::Unknown);
        }
        let (rises, falls) = (gap.rate.lo > 0.0, gap.rate.hi < 0.0);
        if matches!(side, Side::Above | Side::On) && rises {
            return Ok(Side::Above);
        }
        let is_behind = gap.value.hi < 0.0;
        if self.is_passable(surface) {
            match (is_behind, side) {
                (true, _) => return Ok(Side::Unknown),
                (_, Side::Below | Side::On) if falls => return Ok(Side::Below),
                _ if rises => return Ok(Side::Unknown),
                _ => {}
            }
        }
        let states = row::<Sys>(&part.states);
        match self.field.system.counts_throughout(
            self.field.parameters(),
            surface,
            part.times,
            &states,
        ) {
            Some(false) => Ok(Side::Unknown),
            None => Err(Reason::UnsureCondition { surface }),
            Some(true) if is_behind => Err(Reason::MayBeBehind { surface }),
            Some(true) => Err(Reason::MayGraze { surface }),
        }
    }
}
