//! Projection: brings a state that has drifted off the constraints during integration back to them.
//!
//! It acts after a step if a constraint is violated by more than rounding. First it corrects positions by Newton's
//! iteration `q -= correction(f(q) - f(q_0))`, which returns the integrals `f` of integrable constraints to their
//! levels at the start of the run. (The level of a position-level constraint is 0, unless the run was allowed to start
//! off it.) Then it corrects velocities, orthogonally in the metric. In the form reduced to D only positions need
//! correction.

use crate::contract::Constrained;
use crate::effects::{Change, Effect, Moment, SceneEffects};
use crate::error::Fault;
use crate::forces::NoForces;
use crate::generated::check_positions;
use crate::math;
use crate::outcome::Outcome;
use crate::record::Observer;
use crate::state::StateVector;

/// Largest residual that counts as 0, relative to the sum of the absolute values of its terms: `2^-44 = 6e-14`.
/// Rounding in the sum is about `2^-52` per term, and projection leaves a residual of this size. With a smaller
/// threshold, projection would act after every step without effect.
const THRESHOLD: f64 = 1.0 / (1_u64 << 44) as f64;

/// Maximum number of Newton steps towards the levels. Each step doubles the number of correct digits, so four suffice
/// from a good start.
const NEWTON_STEPS: u32 = 8;

/// Effect that projects to the constraints after every step that violates them.
///
/// # Examples
///
/// ```
/// use dalembert::{Constrained, Dop853, Projection, Simulation, System, Tolerance};
///
/// dalembert::model! {
///     pub Bead {
///         coordinates { x; y; }
///         lagrangian = (dot(x)^2 + dot(y)^2)/2;
///         constraints { circle: x*dot(x) + y*dot(y) = 0; }
///     }
/// }
///
/// // No frame is regular at the origin, so the form is that on all of T*Q. Its states may violate the constraints.
/// let bead = Bead::default();
/// let state = bead.state(0.0, &[1.0, 0.0].into(), &[0.0, 1.0].into())?;
/// let integrator = Dop853::new(Tolerance::new(1e-6)?);
/// let run = Simulation::new(&bead, integrator, Projection::new()).run(0.0, state, 10.0, &mut ())?;
/// let (q, qdot) = (bead.position(&run.state), bead.velocity(run.t, &run.state)?);
/// assert!(bead.residuals(run.t, &q, &qdot).0[0].abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Projection<Sys: Constrained> {
    on: bool,
    levels: Sys::Levels,
}

impl<Sys: Constrained> Projection<Sys> {
    /// The projection, switched on for all runs.
    pub fn new() -> Self {
        Self {
            on: true,
            levels: StateVector::zeros(0),
        }
    }

    /// Corrects positions to their levels. Returns [`Change::Changed`] if the positions changed.
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
            // NOTE: a level that is 0 at the start provides no scale. Then the iteration ends when the correction is
            // below rounding.
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

    /// Deviations of the levels, and the index of the first one above the threshold.
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

    /// Corrects velocities to the constraints. Returns [`Change::Changed`] if the velocities changed.
    fn settle_velocities(&self, now: &mut Moment<'_, Sys>, cut: bool) -> Result<Change, Outcome> {
        // NOTE: at an impact, which cuts the step, even rounding errors are removed. This costs nothing, because the
        // rate is evaluated there in any case. Otherwise impact laws would accumulate the residual over many impacts.
        if now.system.is_reduced() || (!cut && violated(now)?.is_none()) {
            return Ok(Change::Kept);
        }
        let before = *now.state;
        now.system.restore(now.t, now.state)?;
        // The correction is linear. For ill-conditioned constraints a second one removes the rounding of the first.
        if violated(now)?.is_some() {
            now.system.restore(now.t, now.state)?;
        }
        match far(now, &before)? {
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

/// True if a correction is larger than the rounding error of the positions.
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
    exceeding(now, None, THRESHOLD)
}

/// The first constraint whose residual is too large after the projection of the state `before`, so that the projection
/// has failed. The bound is 1024 thresholds, about a seventeenth of the bound for admissible initial states.
///
/// The terms of a constraint provide no scale where all of them vanish. They vanish where the system rests, and where
/// the constraint forces the velocity in each remaining term to 0, such as `ydot` in `y ydot` for a hanging pendulum.
/// The terms are then rounding errors, and the residual is as large as they are. Projection leaves the rounding error
/// of the velocity that it was given. The scale is therefore computed from the largest velocities that the kinetic
/// energy of `before` allows.
fn far<Sys: Constrained>(
    now: &Moment<'_, Sys>,
    before: &Sys::State,
) -> Result<Option<usize>, Fault> {
    let threshold = 1024.0 * THRESHOLD;
    match exceeding(now, None, threshold)? {
        None => Ok(None),
        Some(_) => exceeding(now, Some(&largest_velocities(now, before)?), threshold),
    }
}

/// Largest values of single velocities at the kinetic energy of a state: `|v_i| <= sqrt(g^ii v.p)`, by the
/// Cauchy-Schwarz inequality.
fn largest_velocities<Sys: Constrained>(
    now: &Moment<'_, Sys>,
    state: &Sys::State,
) -> Result<Sys::Vector, Fault> {
    let (system, t) = (now.system, now.t);
    let (v, p) = (system.velocity(t, state)?, system.momentum(t, state)?);
    let pairs = v.as_slice().iter().zip(p.as_slice());
    // NOTE: the square roots are taken before the product, which would underflow for velocities below 1e-162.
    let speed: f64 = pairs
        .map(|(v, p)| math::sqrt(v.abs()) * math::sqrt(p.abs()))
        .sum();
    let q = system.position(state);
    let velocity = |p: &Sys::Vector| system.velocity(t, &system.state_from_momenta(t, &q, p)?);
    let at_rest = velocity(&system.zero_vector())?;
    let mut largest = system.zero_vector();
    for i in 0..system.coordinate_count() {
        let mut unit = system.zero_vector();
        unit.as_mut_slice()[i] = 1.0;
        let cometric = velocity(&unit)?.as_slice()[i] - at_rest.as_slice()[i];
        largest.as_mut_slice()[i] = math::sqrt(cometric.abs()) * speed;
    }
    Ok(largest)
}

/// The first constraint violated by more than `threshold` times the sum of its terms, or of its terms at `velocities`
/// if that sum is larger.
fn exceeding<Sys: Constrained>(
    now: &Moment<'_, Sys>,
    velocities: Option<&Sys::Vector>,
    threshold: f64,
) -> Result<Option<usize>, Fault> {
    let (q, qdot) = (
        now.system.position(now.state),
        now.system.velocity(now.t, now.state)?,
    );
    let (residuals, mut scales) = now.system.residuals(now.t, &q, &qdot);
    if let Some(velocities) = velocities {
        let (_, larger) = now.system.residuals(now.t, &q, velocities);
        let pairs = scales.as_mut_slice().iter_mut().zip(larger.as_slice());
        // Residuals that are subnormal numbers have lost digits.
        pairs.for_each(|(scale, larger)| {
            *scale = scale.max(*larger) + f64::MIN_POSITIVE / threshold
        });
    }
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
            for (value, level) in self
                .levels
                .as_mut_slice()
                .iter_mut()
                .zip(now.system.declared_levels())
            {
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
        // NOTE: this can move a state off the surface that it lies on, by the size of the integration error. The
        // projection is necessary there too: otherwise a motion whose every step is cut by an impact would never be
        // corrected. The surface just hit counts as met exactly, whatever its gap.
        let moved = if self.levels.count() > 0 {
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
