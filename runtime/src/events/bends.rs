//! How much gaps can bend in a box: what tells of most steps in it that they pass a surface, from the gaps at their ends.
//!
//! Along a path in the box with `|x_i'| <= v w_i` and `|x_i''| <= a w_i`, by the part of the step, the gap has
//! `|g''| <= C = v^2 B + a S`, where `S` and `B` bound its rates and bends along all lines with `|x_i'| <= w_i`. Between
//! its ends it is then above `(1 - s) g_0 + s g_1 - C s (1 - s)/2`, which has no zero inside where `(sqrt g_0 + sqrt g_1)^2 > C/2`.
//!
//! The box grows with what motion visits, so that a motion in a bounded room is measured a few times and no more.

use core::cell::Cell;

use super::path::Path;
use super::room::{Room, place};
use crate::contract::Impacting;
use crate::math;
use crate::numbers::Bent;
use crate::state::StateVector;

/// Steps to wait after a box that told less than it should, at most.
const MOST_PATIENCE: u32 = 512;

/// Steps that a box is to tell of, to be worth its measuring.
const WORTH: i32 = 8;

/// A new box has so many times the way of its step on every side.
const MARGIN: f64 = 2.0;

/// What is left in a step of how far components went in those before.
const FADING: f64 = 0.98;

/// Rounding of the bound, in parts of it.
const ROUNDING: f64 = 1.0 / (1 << 30) as f64;

/// The box and the bounds in it.
#[derive(Debug, Clone)]
pub(crate) struct Bends<S, G> {
    room: Room<S>,
    /// How far components, and time, go in a step.
    ways: S,
    time: f64,
    /// Bounds along lines that go as far as steps did when the box was measured.
    slopes: G,
    bends: G,
    measured: S,
    measured_time: f64,
    /// How fast the last step moves, and how much it bends, in parts of those ways.
    speed: f64,
    turn: f64,
    /// Whether that step lies in the box.
    is_inside: bool,
    /// Steps that the box has told of, less those it should have.
    score: i32,
    wait: u32,
    patience: u32,
}

impl<S: StateVector, G: StateVector> Bends<S, G> {
    /// No box yet, for systems with so many positions, and as many components and gaps as these have.
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

    /// Forgets the box: surfaces, parameters or the mode are others.
    pub(crate) fn forget(&mut self) {
        self.room.forget();
    }

    /// Takes in a step, which the box is made to hold.
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
            let motion = path.motion(i);
            if motion == [0.0, 0.0] || !self.room.keeps(i) {
                continue;
            }
            let inverse = 1.0 / self.measured.as_slice()[i];
            let [speed, turn] = motion.map(|motion| motion * inverse);
            // Not what drops NaN.
            self.speed = if speed <= self.speed {
                self.speed
            } else {
                speed
            };
            self.turn = if turn <= self.turn { self.turn } else { turn };
        }
    }

    /// The bounds in the box.
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

    /// Whether a gap with these values at the ends of the step has no zero inside.
    #[inline]
    pub(crate) fn tell(&self, surface: usize, [first, last]: [f64; 2]) -> bool {
        let [slope, bend] = [&self.slopes, &self.bends].map(|bound| bound.as_slice()[surface]);
        let most = 0.5 * (self.speed * self.speed * bend + self.turn * slope) * (1.0 + ROUNDING);
        let (first, last) = (first.abs(), last.abs());
        // Not comparisons that NaN passes. Most ends are so far that no root needs to be taken.
        let is_far = first + last > most || {
            let ends = math::sqrt(first) + math::sqrt(last);
            ends * ends * (1.0 - ROUNDING) > most
        };
        self.is_inside && is_far
    }

    /// Takes in whether the bounds told of a step that it passes the surfaces that it does pass.
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
