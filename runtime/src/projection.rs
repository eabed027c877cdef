//! Projection: brings the state back to the constraints that integration has drifted from.
//!
//! After a step, if a constraint is violated by more than rounding: positions first, by Newton's iteration
//! `q -= correction(f(q) - f(q_0))` towards the levels at the start of the run (integrable constraints; 0 where the
//! constraint is an equation of positions, unless the run was made to start off it), then
//! velocities, orthogonally in the metric. A state reduced to D has nothing but positions to bring back.

use crate::contract::Constrained;
use crate::effects::{Change, Effect, Moment, SceneEffects};
use crate::error::Fault;
use crate::forces::NoForces;
use crate::generated::check_positions;
use crate::outcome::Outcome;
use crate::record::Observer;
use crate::state::StateVector;

/// Part of the sum of a residual's absolute terms that is let pass: `2^-44 = 6e-14`. Forming the sum rounds by about
/// `2^-52` per term and projecting leaves as much, so a smaller one would project after every step for nothing.
const THRESHOLD: f64 = 1.0 / (1_u64 << 44) as f64;

/// Newton steps towards the levels; each doubles the digits, so that four make a full number of a good start.
const NEWTON_STEPS: u32 = 8;

/// Projects to the constraints after every step that needs it.
#[derive(Debug, Clone)]
pub struct Projection<Sys: Constrained> {
    on: bool,
    levels: Sys::Levels,
}

impl<Sys: Constrained> Projection<Sys> {
    /// The projection, switched on.
    pub fn new() -> Self {
        Self {
            on: true,
            levels: Sys::Levels::zeros(),
        }
    }

    /// Brings positions back to their levels. Returns whether they had to move.
    fn settle_levels(&self, now: &mut Moment<'_, Sys>) -> Result<Change, Outcome> {
        let mut q = now.system.position(now.state);
        let (mut excess, mut worst) = self.excess(now, &q);
        if worst.is_none() {
            return Ok(Change::Kept);
        }
        let qdot = now.system.velocity(now.t, now.state)?;
        for _ in 0..NEWTON_STEPS {
            let correction = now.system.level_correction(now.t, &q, &excess)?;
            for (q, correction) in q.as_mut_slice().iter_mut().zip(correction.as_slice()) {
                *q += correction;
            }
            // NOTE: a level that vanishes at the start has no scale of its own; there Newton's steps themselves
            // tell when no digit moves any more.
            let moved = is_visible(&q, &correction);
            (excess, worst) = self.excess(now, &q);
            if worst.is_none() || !moved {
                *now.state = now.system.state_unchecked(now.t, &q, &qdot)?;
                return Ok(Change::Changed);
            }
        }
        Err(Outcome::ProjectionFailed {
            constraint: worst.unwrap_or(0),
        })
    }

    /// How far the levels are off, and the first that is off by more than the threshold.
    fn excess(&self, now: &Moment<'_, Sys>, q: &Sys::Vector) -> (Sys::Levels, Option<usize>) {
        let mut excess = now.system.levels(now.t, q);
        let sizes = now.system.level_scales(now.t, q);
        let mut worst = None;
        let kept = self.levels.as_slice().iter().zip(sizes.as_slice());
        for (k, (value, (level, size))) in excess.as_mut_slice().iter_mut().zip(kept).enumerate() {
            let scale = value.abs().max(level.abs()).max(*size);
            *value -= level;
            let holds = value.abs() <= THRESHOLD * scale;
            if worst.is_none() && !holds {
                worst = Some(k);
            }
        }
        (excess, worst)
    }

    /// Brings velocities back to the constraints. Returns whether they had to change.
    fn settle_velocities(&self, now: &mut Moment<'_, Sys>, cut: bool) -> Result<Change, Outcome> {
        // NOTE: where the step was cut for an impact even rounding is mended: it costs nothing there, as the rate is
        // evaluated anew anyway, and what an impact law makes of a residual adds up over many impacts.
        if Sys::IS_REDUCED || (!cut && violated(now)?.is_none()) {
            return Ok(Change::Kept);
        }
        now.system.restore(now.t, now.state)?;
        // Restoring is linear; a second time mends the rounding of the first where constraints are ill-conditioned.
        if violated(now)?.is_some() {
            now.system.restore(now.t, now.state)?;
        }
        match far(now)? {
            Some(constraint) => Err(Outcome::ProjectionFailed { constraint }),
            None => Ok(Change::Changed),
        }
    }
}

impl<Sys: Constrained> Default for Projection<Sys> {
    fn default() -> Self {
        Self::new()
    }
}

/// Whether a correction changes any digit of the positions.
fn is_visible<V: StateVector>(q: &V, correction: &V) -> bool {
    let largest = |values: &V| {
        values
            .as_slice()
            .iter()
            .fold(0.0_f64, |largest, value| largest.max(value.abs()))
    };
    largest(correction) > f64::EPSILON * largest(q)
}

/// The first constraint violated by more than the threshold.
fn violated<Sys: Constrained>(now: &Moment<'_, Sys>) -> Result<Option<usize>, Fault> {
    exceeding(now, THRESHOLD)
}

/// The first constraint still violated so much that projection cannot be said to have worked: a thousand
/// thresholds, the bound at which states are refused divided by twenty.
fn far<Sys: Constrained>(now: &Moment<'_, Sys>) -> Result<Option<usize>, Fault> {
    exceeding(now, 1024.0 * THRESHOLD)
}

fn exceeding<Sys: Constrained>(
    now: &Moment<'_, Sys>,
    threshold: f64,
) -> Result<Option<usize>, Fault> {
    let (q, qdot) = (
        now.system.position(now.state),
        now.system.velocity(now.t, now.state)?,
    );
    let (residuals, scales) = now.system.residuals(now.t, &q, &qdot);
    let mut pairs = residuals.as_slice().iter().zip(scales.as_slice());
    let holds = |(residual, scale): (&f64, &f64)| residual.abs() <= threshold * scale;
    Ok(pairs.position(|pair| !holds(pair)))
}

impl<Sys: Constrained> Effect<Sys> for Projection<Sys> {
    type Forces = NoForces;

    fn begin<O: Observer<Sys>>(
        &mut self,
        now: &mut Moment<'_, Sys>,
        _: &mut O,
    ) -> Result<(), Outcome> {
        let q = now.system.position(now.state);
        self.levels = now.system.levels(now.t, &q);
        if check_positions(now.system, now.t, &q).is_ok() {
            for (value, level) in self.levels.as_mut_slice().iter_mut().zip(Sys::LEVELS) {
                if level.is_zero {
                    *value = 0.0;
                }
            }
        }
        Ok(())
    }

    #[inline]
    fn settle(&mut self, now: &mut Moment<'_, Sys>, cut: bool) -> Result<Change, Outcome> {
        if !self.on {
            return Ok(Change::Kept);
        }
        // NOTE: this moves a state that lies on a surface off it by as much as integration erred. It has to be done
        // there too, or a motion of which every step is cut would never be mended; the surface just hit counts as met
        // exactly, whatever its gap.
        let moved = if Sys::Levels::LEN > 0 {
            self.settle_levels(now)?
        } else {
            Change::Kept
        };
        let change = moved.or(self.settle_velocities(now, cut)?);
        if change == Change::Changed {
            now.counters.projections += 1;
        }
        Ok(change)
    }
}

impl<Sys: Constrained> SceneEffects<Sys> for Projection<Sys> {
    fn set_projection(&mut self, on: bool) {
        self.on = on;
    }
}
