//! Bounds of the second derivatives of gaps in a box. With the gaps at both ends of a step in the box, they show for
//! most steps that the step meets no surface.
//!
//! Consider a path in the box with `|x_i'| <= v w_i` and `|x_i''| <= a w_i`, with derivatives with respect to the
//! fraction `s` of the step. The gap has `|g''| <= C = v^2 B + a S`, where `S` and `B` bound its first and second
//! derivatives along all lines with `|x_i'| <= w_i`. With the values `g_0` and `g_1` at the ends, the gap is above
//! `(1 - s) g_0 + s g_1 - C s (1 - s)/2`, which has no zero inside if `(sqrt g_0 + sqrt g_1)^2 > C/2`.
//!
//! The box grows with the motion, so that a motion in a bounded region needs only a few measurements.

use core::cell::Cell;

use super::path::Path;
use super::room::{Room, place};
use crate::contract::Impacting;
use crate::math;
use crate::numbers::Bent;
use crate::state::StateVector;

/// Maximum number of steps to wait after a box that decided too few steps.
const MOST_PATIENCE: u32 = 512;

/// Number of steps that a box must decide to be worth its measurement.
const WORTH: i32 = 8;

/// Margin of a new box on every side, in multiples of the distance covered in its step.
const MARGIN: f64 = 2.0;

/// Factor per step by which the recorded distances of earlier steps decay.
const FADING: f64 = 0.98;

/// Relative rounding error of the bound.
const ROUNDING: f64 = 1.0 / (1 << 30) as f64;

/// The box and the bounds in it.
#[derive(Debug, Clone)]
pub(crate) struct Bends<S, G> {
    room: Room<S>,
    /// Distances that components, and time, cover in a step.
    ways: S,
    time: f64,
    /// The bounds `S` and `B` of every gap. `w` are the distances as they were when these bounds were computed
    /// (`measured`).
    slopes: G,
    bends: G,
    measured: S,
    measured_time: f64,
    /// The bounds `v` and `a` of the last step, in units of those distances.
    speed: f64,
    turn: f64,
    /// True if that step lies in the box.
    is_inside: bool,
    /// Number of decided steps, less a penalty for steps left undecided.
    score: i32,
    wait: u32,
    patience: u32,
}

impl<S: StateVector, G: StateVector> Bends<S, G> {
    /// Bounds without a box, for systems with this number of positions, and as many components and gaps as these
    /// vectors.
    pub(crate) fn new(positions: usize, state: &S, gaps: &G) -> Self {
        Self {
            room: Room::new(positions, state),
            ways: state.zeroed(),
            time: 0.0,
            slopes: gaps.zeroed(),
            bends: gaps.zeroed(),
            measured: state.zeroed(),
            measured_time: 0.0,
            speed: 0.0,
            turn: 0.0,
            is_inside: false,
            score: 0,
            wait: WORTH as u32,
            patience: 0,
        }
    }

    /// Discards the box, after a change of surfaces, parameters or mode.
    pub(crate) fn forget(&mut self) {
        self.room.forget();
    }

    /// Sets the step, and extends the box to contain it.
    #[inline]
    pub(crate) fn follow<Sys: Impacting<State = S, Gaps = G>>(
        &mut self,
        system: &Sys,
        path: &Path<S>,
        evaluations: &mut u64,
    ) {
        self.is_inside = self.wait == 0;
        if !self.is_inside {
            self.wait -= 1;
            return;
        }
        self.time = (FADING * self.time).max(path.length());
        for i in 0..self.room.positions() {
            let way = &mut self.ways.as_mut_slice()[i];
            *way = (FADING * *way).max(path.motion(i)[0]);
        }
        if !self.room.holds(path) {
            match self.room.is_known() {
                true => self.room.extend(path),
                false => self.room.surround(path, MARGIN),
            }
            self.measure(system, path);
            *evaluations += 1;
        }
        self.speed = path.length() / self.measured_time;
        self.turn = 0.0;
        for i in 0..self.room.positions() {
            let [speed, turn] = path.motion(i);
            if (speed, turn) == (0.0, 0.0) || !self.room.keeps(i) {
                continue;
            }
            let inverse = 1.0 / self.measured.as_slice()[i];
            let (speed, turn) = (speed * inverse, turn * inverse);
            self.speed = larger(self.speed, speed);
            self.turn = larger(self.turn, turn);
        }
    }

    /// Leaves out a step: the bounds do not apply to it.
    #[inline]
    pub(crate) fn skip(&mut self) {
        self.is_inside = false;
    }

    /// Computes the bounds in the box.
    #[cold]
    fn measure<Sys: Impacting<State = S, Gaps = G>>(&mut self, system: &Sys, path: &Path<S>) {
        (self.measured, self.measured_time) = (self.ways, self.time);
        let (room, ways) = (&self.room, &self.ways);
        let taken = Cell::new(0_u64);
        let component = |i: usize| match i < room.positions() {
            true => {
                taken.set(taken.get() | place(i));
                Bent::line(room.range(i), ways.as_slice()[i])
            }
            false => Bent::line(path.range(i), 0.0),
        };
        let time = Bent::line(room.times(), self.time);
        for surface in 0..self.slopes.count() {
            let gap = system.gap_about(surface, time, &component);
            self.slopes.as_mut_slice()[surface] = gap.rate.magnitude();
            self.bends.as_mut_slice()[surface] = gap.bend.magnitude();
        }
        self.room.keep(taken.get());
    }

    /// True if a gap with these values, of one sign, at the ends of the step has no zero inside.
    #[inline]
    pub(crate) fn tell(&self, surface: usize, [first, last]: [f64; 2]) -> bool {
        let [slope, bend] = [&self.slopes, &self.bends].map(|bound| bound.as_slice()[surface]);
        let most = 0.5 * (self.speed * self.speed * bend + self.turn * slope) * (1.0 + ROUNDING);
        let (first, last) = (first.abs(), last.abs());
        // Written so that NaN fails the comparisons. Most ends are so far away that no square root is needed.
        let is_far = first + last > most || {
            let ends = math::sqrt(first) + math::sqrt(last);
            ends * ends * (1.0 - ROUNDING) > most
        };
        self.is_inside && is_far
    }

    /// Records a step that passes no surface. `has_told` is true if the bounds decided it.
    #[inline]
    pub(crate) fn learn(&mut self, has_told: bool) {
        match has_told {
            true => {
                self.score += 1;
                if self.score >= WORTH {
                    (self.score, self.patience) = (WORTH, 0);
                }
            }
            false if self.is_inside && self.score <= 0 => {
                self.room.forget();
                self.score = 0;
                self.patience = (2 * self.patience + WORTH as u32).min(MOST_PATIENCE);
                self.wait = self.patience;
            }
            false if self.is_inside => self.score -= 2,
            false => {}
        }
    }
}

/// The larger number; NaN if one of them is NaN.
#[inline(always)]
fn larger(left: f64, right: f64) -> f64 {
    match right <= left || left.is_nan() {
        true => left,
        false => right,
    }
}
