//! Variations along smooth motion.

use super::graze::Seen;
use super::held::Holder;
use super::{DIRECTIONS, Dual, Tangent, Undefined};
use crate::contract::Variational;
use crate::integrate::controller::least_step;
use crate::integrate::order::order;
use crate::integrate::rough::power_of_two;
use crate::integrate::taylor::expansion::Expansion;
use crate::integrate::taylor::reach::{LONGEST, reach};
use crate::jet::LENGTH;
use crate::numbers::{Numbers, Row};
use crate::record::Segment;
use crate::state::StateVector;

/// Allowed size of the last two terms of a series relative to the first ones. It is below the rounding of the sum.
const LAST: f64 = 0.25 * f64::EPSILON;

/// Power series of the motion and of its derivatives.
pub(super) struct Flow<Sys: Variational> {
    pub(super) expansion: Expansion<Sys, Dual>,
    order: usize,
    unit: f64,
    pub(super) scale: Sys::State,
}

impl<Sys: Variational> Flow<Sys> {
    pub(super) fn new(system: &Sys) -> Self {
        Self {
            expansion: Expansion::of(system),
            order: order(f64::EPSILON, system.work()),
            unit: 1.0,
            scale: system.zero_state(),
        }
    }

    /// Propagates all directions along a segment of free or held motion.
    pub(super) fn follow(
        &mut self,
        system: &Sys,
        holder: Option<Holder>,
        segment: &Segment<'_, Sys::State>,
        tangents: &mut [Tangent<Sys>],
    ) -> Result<(), Undefined> {
        let t = [segment.t_start(), segment.t_end()];
        if t[1] <= t[0] {
            return Ok(());
        }
        let ends = [segment.start(), segment.end()];
        self.scale = system.scale(t[0], ends[0]);
        let mut follow_some = |some: &mut [Tangent<Sys>]| match holder {
            None => self.follow_some(system, t, ends[0], some),
            Some(holder) => self.follow_held(system, holder, t, ends, some),
        };
        if tangents.is_empty() {
            return follow_some(&mut []);
        }
        tangents.chunks_mut(DIRECTIONS).try_for_each(follow_some)
    }

    /// Propagates up to [`DIRECTIONS`] directions together along free motion.
    fn follow_some(
        &mut self,
        system: &Sys,
        [mut t, end]: [f64; 2],
        start: &Sys::State,
        tangents: &mut [Tangent<Sys>],
    ) -> Result<(), Undefined> {
        let parameters = dual_parameters(system, tangents);
        let mut state = dual_state(start, tangents);
        self.unit = power_of_two(end - t);
        while t < end {
            let theta = self.step(system, &parameters, t, &state, end - t)?;
            let seen = Seen {
                system,
                expansion: &self.expansion,
                order: self.order,
                unit: self.unit,
            };
            seen.look_for_grazes(t, theta)?;
            let [change, _] = self.expansion.change(self.order, Dual::of(theta));
            for (entry, change) in state.as_mut_slice().iter_mut().zip(change.as_slice()) {
                *entry = *entry + *change;
            }
            let later = t + theta * self.unit;
            if later <= t {
                return Err(Undefined::NotFinite { t });
            }
            t = later.min(end);
        }
        take_slopes(&state, tangents);
        Ok(())
    }

    /// Expands the motion from a state. Returns the step that the series allow, at most `length`, in units of
    /// `self.unit`.
    fn step(
        &mut self,
        system: &Sys,
        parameters: &Sys::Parameters<Dual>,
        t: f64,
        state: &Sys::Row<Dual>,
        length: f64,
    ) -> Result<f64, Undefined> {
        self.expansion
            .begin(system, parameters, Dual::of(t), state)?;
        loop {
            self.expansion
                .advance(system, parameters, Dual::of(self.unit), self.order, state);
            if let Some(theta) = self.reach(length / self.unit) {
                return Ok(theta);
            }
            self.unit *= 1.0 / LONGEST;
            if self.unit < least_step(t) {
                return Err(Undefined::NotFinite { t });
            }
        }
    }

    /// The step that the series allow, at most `wished` units of time; `None` if they must be computed in a shorter
    /// unit.
    fn reach(&self, wished: f64) -> Option<f64> {
        let mut sizes = [[0.0; DIRECTIONS + 1]; LENGTH];
        for (sizes, row) in sizes
            .iter_mut()
            .zip(&self.expansion.coefficients[..=self.order])
        {
            for (entry, scale) in row.as_slice().iter().zip(self.scale.as_slice()) {
                let values = entry.slopes().into_iter().chain([entry.value]);
                for (size, value) in sizes.iter_mut().zip(values) {
                    if !value.is_finite() {
                        return None;
                    }
                    *size = f64::max(*size, (value / scale).abs());
                }
            }
        }
        reach(&sizes, self.order, wished, LAST)
    }
}

/// A dual number whose derivative along each tangent is `of(tangent)`, for at most [`DIRECTIONS`] tangents.
fn along<T>(value: f64, tangents: &[T], of: impl Fn(&T) -> f64) -> Dual {
    let mut slopes = [0.0; DIRECTIONS];
    for (slope, tangent) in slopes.iter_mut().zip(tangents) {
        *slope = of(tangent);
    }
    Dual::new(value, slopes)
}

/// The parameters as dual numbers, with their variations.
pub(super) fn dual_parameters<Sys: Variational>(
    system: &Sys,
    tangents: &[Tangent<Sys>],
) -> Sys::Parameters<Dual> {
    let values = system.parameters();
    let mut row = Sys::Parameters::<Dual>::zeros(values.as_slice().len());
    for (i, (entry, value)) in row
        .as_mut_slice()
        .iter_mut()
        .zip(values.as_slice())
        .enumerate()
    {
        *entry = along(*value, tangents, |tangent| tangent.parameters.as_slice()[i]);
    }
    row
}

/// A state as dual numbers, with its variations.
pub(super) fn dual_state<Sys: Variational>(
    state: &Sys::State,
    tangents: &[Tangent<Sys>],
) -> Sys::Row<Dual> {
    let mut row = Sys::Row::<Dual>::zeros(state.count());
    for (i, (entry, value)) in row
        .as_mut_slice()
        .iter_mut()
        .zip(state.as_slice())
        .enumerate()
    {
        *entry = along(*value, tangents, |tangent| tangent.state.as_slice()[i]);
    }
    row
}

/// Stores the derivatives of a state in the directions along which it was varied.
pub(super) fn take_slopes<Sys: Variational>(state: &Sys::Row<Dual>, tangents: &mut [Tangent<Sys>]) {
    for (k, tangent) in tangents.iter_mut().enumerate() {
        let entries = state.as_slice().iter();
        for (component, entry) in tangent.state.as_mut_slice().iter_mut().zip(entries) {
            *component = entry.slopes()[k];
        }
    }
}
