//! Variational collision integrator: an impact is part of a step of fixed size. The method itself solves for the time
//! and position of the impact, and the step is completed to its original end.
//!
//! ```text
//! S(q0, q1) = S_h'(q0, q) + S_(h-h')(q, q1),    q on the surface,    stationary in h' and in q along the surface
//! ```
//!
//! Stationarity in `q` lets the momentum jump only along `dh`. Stationarity in `h'` makes the discrete energy
//! `-dS_h/dh` equal before and after the impact. The step across the impact therefore has a generating function and
//! is symplectic. An exact reflection would keep the energy, which differs from the discrete energy by the error of the
//! method; the step would then not be symplectic.
//!
//! # References
//! R. Fetecau, J. Marsden, M. Ortiz, M. West, *Nonsmooth Lagrangian mechanics and variational collision integrators*,
//! SIAM J. Appl. Dyn. Syst. 2 (2003).

use super::embedded::Counted;
use super::fixed::{Advance, Departure, FixedStep, Method, evaluate};
use super::precise::Precise;
use super::stats::Counters;
use super::stepper::{EnergyAt, GapAt, Rebound, Stepper};
use crate::contract::VectorField;
use crate::state::StateVector;

/// Maximum number of iterations for the length of a step, and for the size of a jump. Each iteration gains several
/// digits.
const LIMIT: u32 = 30;

/// Largest accepted difference between the solved length of a step and the length from dense output, relative to the
/// step; and between the scale of a jump and 1.
const BESIDE: f64 = 1.0 / 16.0;

/// Relative difference of the energies before and after an impact up to which it counts as elastic.
const ELASTIC: f64 = 1e-12;

/// Iterates `x -= correction(x)` while corrections decrease. Returns `None` if they do not become small relative to
/// `unit`.
fn solve(mut x: f64, unit: f64, mut correction: impl FnMut(f64) -> Option<f64>) -> Option<f64> {
    let mut last = f64::INFINITY;
    for _ in 0..LIMIT {
        let change = correction(x)?;
        if change.is_nan() {
            return None;
        }
        if change.abs() >= last {
            break;
        }
        x -= change;
        last = change.abs();
        if last == 0.0 {
            break;
        }
    }
    (last <= 1e-10 * unit).then_some(x)
}

/// See [`Stepper::meet`].
pub(super) fn meet<F: VectorField, M: Advance<F>>(
    step: &mut FixedStep<F::State, M>,
    field: &F,
    theta: f64,
    gap: &GapAt<'_, F::State>,
    counters: &mut Counters,
) -> bool {
    let whole = *step;
    let (h, end) = (whole.made, whole.ends.t[1]);
    let start = whole.ends.t[0];
    // The point of the grid that is reached by the rest of the step: its end, or the end of an earlier step that was cut.
    let target = whole.target.unwrap_or(end);
    if whole.pending != Some(target) {
        step.span = h;
    }
    let mut trial = |step: &mut FixedStep<F::State, M>, length: f64| {
        let mut field = Counted {
            field,
            counters: &mut *counters,
        };
        step.memory = M::memory(&step.ends.start.value);
        let pieces = step.arriving_pieces(length);
        step.cross_pieces(&mut field, pieces.lengths).ok()?;
        gap(start.t + length, &step.ends.end.value).ok()
    };
    let solved = (whole.parts == 1)
        .then(|| {
            solve(theta * h, h, |length| {
                let (gap, rate) = trial(step, length)?;
                Some(gap / rate)
            })
        })
        .flatten()
        .filter(|length| {
            *length > 0.0
                && (*length <= h || !whole.is_at_end)
                && (length - theta * h).abs() <= BESIDE * h
        });
    let Some(length) = solved.filter(|length| trial(step, *length).is_some()) else {
        *step = whole;
        return false;
    };
    step.ends.t[1] = start.after(length);
    step.is_crowded |= whole.pending.is_some();
    (step.made, step.dense_ready) = (length, false);
    (step.has_met, step.target) = (true, Some(target));
    step.prepare_dense(field, counters).is_ok() || {
        *step = whole;
        false
    }
}

/// A part of a step, in two pieces whose lengths add up to its length.
#[derive(Debug, Clone, Copy)]
struct Pieces {
    lengths: [f64; 2],
    /// Derivatives of both lengths with respect to their sum.
    slopes: [f64; 2],
}

impl Pieces {
    /// The part up to an impact, `length` after the start of a step of length `span`.
    fn arriving(length: f64, span: f64) -> Self {
        let beta = 1.0 - length / span;
        let cube = beta * beta * beta;
        let back = span * (beta - beta * cube);
        let slope = 4.0 * cube;
        Self {
            lengths: [length + back, -back],
            slopes: [slope, 1.0 - slope],
        }
    }

    /// The part from an impact to the end of the step, `length` later: the mirror image of [`Pieces::arriving`].
    fn departing(length: f64, span: f64) -> Self {
        let Self {
            lengths: [long, back],
            slopes: [first, last],
        } = Self::arriving(length, span);
        Self {
            lengths: [back, long],
            slopes: [last, first],
        }
    }

    /// The part between two impacts in one step, in one piece.
    fn whole(length: f64) -> Self {
        Self {
            lengths: [length, 0.0],
            slopes: [1.0, 0.0],
        }
    }

    /// Negative derivative of the action with respect to the sum of the lengths.
    fn energy<F: VectorField, M: Advance<F>>(
        &self,
        field: &mut Counted<'_, F>,
        departure: &Departure<'_, F::State>,
        energy: &EnergyAt<'_, F::State>,
    ) -> Option<f64> {
        let (mut t, mut state, mut rate) = (departure.t, *departure.state, *departure.rate);
        let (mut memory, mut sum) = (M::memory(&state.value), 0.0);
        for (length, slope) in self.lengths.into_iter().zip(self.slopes) {
            if length == 0.0 {
                sum += slope * energy(t, &state.value).ok()?;
                continue;
            }
            let from = Departure {
                t,
                state: &state,
                rate: &rate,
                units: departure.units,
            };
            let end = M::advance(field, length, &from, &mut memory).ok()?;
            sum += slope * M::mean_energy((t, length), &state, &memory, energy)?;
            (t, state) = (t + length, end);
            evaluate(field, t, &state.value, &mut rate).ok()?;
        }
        Some(sum)
    }
}

impl<S: StateVector, M: Method> FixedStep<S, M> {
    /// Lengths of the pieces of a step of this length after an impact.
    pub(super) fn departing(&self, length: f64) -> [f64; 2] {
        self.departing_pieces(length).lengths
    }

    fn departing_pieces(&self, length: f64) -> Pieces {
        let rest = self.target.map(|target| target.since(self.ends.t[0]));
        match M::KEEPS_ENERGY && rest == Some(length) {
            true => Pieces::departing(length, self.span),
            false => Pieces::whole(length),
        }
    }

    /// Pieces of the step up to an impact. After an earlier impact in the same step, the part is one piece.
    fn arriving_pieces(&self, length: f64) -> Pieces {
        match M::KEEPS_ENERGY && self.pending.is_none() {
            true => Pieces::arriving(length, self.span),
            false => Pieces::whole(length),
        }
    }
}

/// See [`Stepper::rebound`]. Returns the state after a jump along that of the law whose size keeps the discrete energy;
/// `None` if the jump of the law stands.
pub(super) fn rebound<F: VectorField, M: Advance<F>>(
    step: &FixedStep<F::State, M>,
    field: &F,
    rebound: &Rebound<'_, F::State>,
    struck: &F::State,
    counters: &mut Counters,
) -> Option<F::State> {
    let (energy, now) = (rebound.energy, step.ends.t[1]);
    if step.is_crowded {
        return None;
    }
    let arrived = step.ends.end.value;
    let jump = |scale: f64| {
        let mut state = arrived;
        for i in rebound.motion_start..state.count() {
            let change = struck.as_slice()[i] - arrived.as_slice()[i];
            state.as_mut_slice()[i] += scale * change;
        }
        state
    };
    let slope = elastic_slope(rebound, now.t, &[arrived, *struck, jump(0.5)])?;
    let mut field = Counted { field, counters };
    let arriving = Departure {
        t: step.ends.t[0].t,
        state: &step.ends.start,
        rate: &step.rates[0],
        units: &step.units,
    };
    let wanted = step
        .arriving_pieces(step.made)
        .energy::<F, M>(&mut field, &arriving, energy)?;
    let mut after = *step;
    after.ends.place(now, Precise::new(arrived));
    let (h, _) = after.aim_within_run(step.step.min(rebound.limit));
    // If the next step does not end where this one would have ended, no discrete energy has to be kept: the jump of
    // the law stands.
    if after.target.map(|target| target.since(now)) != Some(h) {
        return None;
    }
    let pieces = after.departing_pieces(h);
    let scale = solve(1.0, 1.0, |scale| {
        let state = step.ends.kept(&jump(scale));
        let mut rate = arrived.zeroed();
        evaluate(&mut field, now.t, &state.value, &mut rate).ok()?;
        let departing = Departure {
            t: now.t,
            state: &state,
            rate: &rate,
            units: &step.units,
        };
        let found = pieces.energy::<F, M>(&mut field, &departing, energy)?;
        Some((found - wanted) / slope)
    })?;
    ((scale - 1.0).abs() < BESIDE).then(|| jump(scale))
}

/// Derivative of the energy with respect to the size of a jump, at the end of the jump. `middle` is the state half way.
/// `None` if the jump has size 0, moves the positions or changes the energy.
fn elastic_slope<S: StateVector>(
    rebound: &Rebound<'_, S>,
    t: f64,
    [arrived, struck, middle]: &[S; 3],
) -> Option<f64> {
    let start = rebound.motion_start;
    let [before, after, between] =
        [arrived, struck, middle].map(|state| (rebound.energy)(t, state).ok());
    let (before, after, between) = (before?, after?, between?);
    // The energy is a parabola along the jump, and equal at both ends.
    let slope = 4.0 * (before - between);
    let least = ELASTIC * slope.abs().max(before.abs());
    let stays = arrived.as_slice()[..start] == struck.as_slice()[..start];
    (stays && (before - after).abs() <= least && slope > least).then_some(slope)
}
