//! Variations along smooth motion.

use super::{DIRECTIONS, Dual, Tangent, Undefined};
use crate::contract::Variational;
use crate::integrate::controller::least_step;
use crate::integrate::order::order;
use crate::integrate::rough::power_of_two;
use crate::integrate::taylor::expansion::Expansion;
use crate::jet::LENGTH;
use crate::numbers::{Numbers, Row};
use crate::state::StateVector;

/// How large the last two terms of a series may be beside the first ones: what rounding leaves of the sum.
const LAST: f64 = 0.25 * f64::EPSILON;

/// Terms that tell how large a series is.
const LEADING: usize = 4;

/// Factor by which a step shrinks until its last terms are small enough.
const SHRINK: f64 = 0.75;

/// Largest step in units of time of its expansion: powers up to the highest stay far from overflow.
const LONGEST: f64 = 1024.0;

/// Places in a step at which the rate of a gap is looked at: between two of them it falls and rises at most once.
const PLACES: usize = 16;

/// Rounding errors of a gap, in units of the sum of the absolute values of its terms.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Power series of the motion with their derivatives.
pub(super) struct Flow<Sys: Variational> {
    expansion: Expansion<Sys, Dual>,
    order: usize,
    unit: f64,
    scale: Sys::State,
}

impl<Sys: Variational> Flow<Sys> {
    pub(super) fn new() -> Self {
        Self {
            expansion: Expansion::new(),
            order: order(f64::EPSILON, Sys::WORK),
            unit: 1.0,
            scale: Sys::State::zeros(),
        }
    }

    /// Carries all directions from a state to the later of two times.
    pub(super) fn follow(
        &mut self,
        system: &Sys,
        t: [f64; 2],
        start: &Sys::State,
        tangents: &mut [Tangent<Sys>],
    ) -> Result<(), Undefined> {
        if t[1] <= t[0] {
            return Ok(());
        }
        self.scale = system.scale(t[0], start);
        if tangents.is_empty() {
            return self.follow_some(system, t, start, &mut []);
        }
        for some in tangents.chunks_mut(DIRECTIONS) {
            self.follow_some(system, t, start, some)?;
        }
        Ok(())
    }

    /// Carries as many directions as go side by side.
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
            let theta = self.step(&parameters, t, &state, end - t)?;
            self.look_for_grazes(system, t, theta)?;
            let [change, _] = self.expansion.change(self.order, Dual::of(theta));
            for (entry, change) in state.as_mut_slice().iter_mut().zip(change.as_slice()) {
                *entry = *entry + *change;
            }
            let length = theta * self.unit;
            t = if t + length >= end { end } else { t + length };
        }
        for (k, tangent) in tangents.iter_mut().enumerate() {
            for (own, entry) in tangent
                .state
                .as_mut_slice()
                .iter_mut()
                .zip(state.as_slice())
            {
                *own = entry.slopes()[k];
            }
        }
        Ok(())
    }

    /// Expands the motion from a state; the part of `length` that its series reach, in units of time.
    fn step(
        &mut self,
        parameters: &Sys::Parameters<Dual>,
        t: f64,
        state: &Sys::Row<Dual>,
        length: f64,
    ) -> Result<f64, Undefined> {
        self.expansion.begin(parameters, Dual::of(t), state)?;
        loop {
            self.expansion
                .advance(parameters, Dual::of(self.unit), self.order, state);
            if let Some(theta) = self.reach(length / self.unit) {
                return Ok(theta);
            }
            self.unit *= 1.0 / LONGEST;
            if self.unit < least_step(t) {
                return Err(Undefined::NotFinite { t });
            }
        }
    }

    /// The part of `wished` units of time that the series reach; `None` where they must be made in a shorter unit.
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
        let mut theta = wished.min(LONGEST);
        while (0..=DIRECTIONS).any(|k| !is_small(|j| sizes[j][k], self.order, theta)) {
            theta *= SHRINK;
            if theta < 1.0 / LONGEST {
                return None;
            }
        }
        Some(theta)
    }

    /// Refuses a step in which the gap of a surface falls to 0 within rounding, and rises.
    fn look_for_grazes(&self, system: &Sys, t: f64, theta: f64) -> Result<(), Undefined> {
        for surface in 0..Sys::Gaps::<Dual>::LEN {
            let mut falls_from = None;
            for place in 0..=PLACES {
                let part = theta * place as f64 / PLACES as f64;
                let [_, rate, _] = self.gap(surface, part);
                if rate < 0.0 {
                    falls_from = Some(part);
                } else if let Some(low) = falls_from.take()
                    && let Some(part) = self.touch(surface, [low, part])
                {
                    let t = t + part * self.unit;
                    if system.counts(surface, t, &self.state_at(part)) {
                        return Err(Undefined::Graze { t, surface });
                    }
                }
            }
        }
        Ok(())
    }

    /// Where the least gap between two parts is 0 within rounding.
    fn touch(&self, surface: usize, [mut low, mut high]: [f64; 2]) -> Option<f64> {
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            match self.gap(surface, middle)[1] < 0.0 {
                true => low = middle,
                false => high = middle,
            }
        }
        let [gap, _, size] = self.gap(surface, low);
        (gap.abs() <= ROUNDING * size).then_some(low)
    }

    /// A gap at a part, its rate, and the sum of the absolute values of its terms.
    fn gap(&self, surface: usize, part: f64) -> [f64; 3] {
        let (mut gap, mut rate, mut size) = (0.0, 0.0, 0.0);
        for row in self.expansion.gaps[..=self.order].iter().rev() {
            let term = row.as_slice()[surface].value;
            rate = rate * part + gap;
            gap = gap * part + term;
            size = size * part + term.abs();
        }
        [gap, rate, size]
    }

    fn state_at(&self, part: f64) -> Sys::State {
        let mut state = Sys::State::zeros();
        for row in self.expansion.coefficients[..=self.order].iter().rev() {
            for (sum, entry) in state.as_mut_slice().iter_mut().zip(row.as_slice()) {
                *sum = *sum * part + entry.value;
            }
        }
        state
    }
}

/// Whether the last two terms of a series are small beside its first ones.
fn is_small(size: impl Fn(usize) -> f64, order: usize, theta: f64) -> bool {
    let mut power = 1.0;
    let mut leading = 0.0;
    for j in 0..=order {
        let term = size(j) * power;
        if j < LEADING.min(order - 1) {
            leading = f64::max(leading, term);
        } else if j + 1 >= order && term > LAST * leading && leading > 0.0 {
            return false;
        }
        power *= theta;
    }
    true
}

/// A number that changes along each tangent at the rate `of` it; [`DIRECTIONS`] tangents at most.
fn along<T>(value: f64, tangents: &[T], of: impl Fn(&T) -> f64) -> Dual {
    let mut slopes = [0.0; DIRECTIONS];
    for (slope, tangent) in slopes.iter_mut().zip(tangents) {
        *slope = of(tangent);
    }
    Dual::new(value, slopes)
}

/// The parameters with their variations.
pub(super) fn dual_parameters<Sys: Variational>(
    system: &Sys,
    tangents: &[Tangent<Sys>],
) -> Sys::Parameters<Dual> {
    let mut row = Sys::Parameters::<Dual>::ZERO;
    let values = system.parameters();
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

/// A state with its variations.
pub(super) fn dual_state<Sys: Variational>(
    state: &Sys::State,
    tangents: &[Tangent<Sys>],
) -> Sys::Row<Dual> {
    let mut row = Sys::Row::<Dual>::ZERO;
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
