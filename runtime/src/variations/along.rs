//! Tests, to first order, that neighbouring motions stay in contact with the surface that holds the motion.

use super::flow::{dual_parameters, dual_state};
use super::held::Holder;
use super::{DIRECTIONS, Dual, Tangent, Undefined};
use crate::contract::Variational;
use crate::error::Fault;
use crate::numbers::{Numbers, Row};

/// Allowed change of a value along a direction, relative to the sum of the absolute contributions of its arguments.
const ROUNDING: f64 = 1e-9;

/// Motions next to a motion at one moment, to first order.
pub(super) struct Neighbours<Sys: Variational> {
    pub(super) parameters: Sys::Parameters<Dual>,
    pub(super) t: Dual,
    pub(super) state: Sys::Row<Dual>,
}

impl<Sys: Variational> Clone for Neighbours<Sys> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<Sys: Variational> Copy for Neighbours<Sys> {}

impl<Sys: Variational> Neighbours<Sys> {
    /// Neighbours at one time, in some directions.
    fn at(system: &Sys, t: f64, state: &Sys::State, tangents: &[Tangent<Sys>]) -> Self {
        Self {
            parameters: dual_parameters(system, tangents),
            t: Dual::of(t),
            state: dual_state(state, tangents),
        }
    }

    /// Neighbours that all equal the motion.
    fn still(&self) -> Self {
        let mut still = *self;
        still.t = Dual::of(self.t.value);
        let rows = [still.parameters.as_mut_slice(), still.state.as_mut_slice()];
        for entry in rows.into_iter().flatten() {
            *entry = Dual::of(entry.value);
        }
        still
    }

    /// Neighbours that each differ from the motion in one argument only.
    fn parts(&self) -> impl Iterator<Item = Self> {
        let still = self.still();
        let by_time = Self { t: self.t, ..still };
        let by_state = (0..self.state.as_slice().len()).map(move |i| {
            let mut part = still;
            part.state.as_mut_slice()[i] = self.state.as_slice()[i];
            part
        });
        let by_parameters = (0..self.parameters.as_slice().len()).map(move |k| {
            let mut part = still;
            part.parameters.as_mut_slice()[k] = self.parameters.as_slice()[k];
            part
        });
        [by_time].into_iter().chain(by_state).chain(by_parameters)
    }

    /// True if a value is the same for all neighbours, to rounding.
    fn share(&self, value: impl Fn(&Self) -> Result<Dual, Fault>) -> Result<bool, Fault> {
        let (mut sums, mut sizes) = ([0.0; DIRECTIONS], [0.0; DIRECTIONS]);
        for part in self.parts() {
            let slopes = value(&part)?.slopes();
            for (slope, (sum, size)) in slopes.into_iter().zip(sums.iter_mut().zip(&mut sizes)) {
                *sum += slope;
                *size += slope.abs();
            }
        }
        let mut pairs = sums.into_iter().zip(sizes);
        Ok(pairs.all(|(sum, size): (f64, f64)| sum.abs() <= ROUNDING * size))
    }

    /// True if all neighbours lie on a surface on which the motion lies, to first order.
    pub(super) fn share_gap(&self, system: &Sys, surface: usize) -> Result<bool, Fault> {
        self.share(|dual| {
            let gaps = system.clearances(&dual.parameters, dual.t, &dual.state)?;
            Ok(gaps.as_slice()[surface])
        })
    }

    fn share_gap_rate(&self, system: &Sys, surface: usize) -> Result<bool, Fault> {
        self.share(|dual| {
            let collision = system.collision(&dual.parameters, surface, dual.t, &dual.state)?;
            Ok(collision.as_slice()[0])
        })
    }

    /// True if all neighbours satisfy the instantaneous constraints of a surface, which the motion satisfies.
    fn are_focused(&self, system: &Sys, surface: usize) -> Result<bool, Fault> {
        let Some(focused) = system.focus(&self.parameters, surface, self.t, &self.state)? else {
            return Ok(true);
        };
        let (mut errors, mut sizes) = ([0.0; DIRECTIONS], [0.0_f64; DIRECTIONS]);
        for (component, focused) in self.state.as_slice().iter().zip(focused.as_slice()) {
            let slopes = component.slopes().into_iter().zip(focused.slopes());
            for ((slope, focused), (error, size)) in slopes.zip(errors.iter_mut().zip(&mut sizes)) {
                *error += (focused - slope).abs();
                *size = size.max(slope.abs());
            }
        }
        let mut pairs = errors.into_iter().zip(sizes);
        Ok(pairs.all(|(error, size): (f64, f64)| error <= ROUNDING * size))
    }
}

impl Holder {
    /// Refuses directions that lead off the surface that holds the motion, or off the surface along which it slides:
    /// neighbours along them are not held.
    pub(super) fn check_along<Sys: Variational>(
        self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        tangents: &[Tangent<Sys>],
    ) -> Result<(), Undefined> {
        for some in tangents.chunks(DIRECTIONS) {
            let neighbours = Neighbours::at(system, t, state, some);
            let are_held = match self {
                Self::Slide { back, .. } => neighbours.share_gap(system, back)?,
                Self::Surface(surface) => {
                    neighbours.share_gap(system, surface)?
                        && neighbours.share_gap_rate(system, surface)?
                        && neighbours.are_focused(system, surface)?
                }
            };
            if !are_held {
                return Err(self.undefined(t));
            }
        }
        Ok(())
    }
}
