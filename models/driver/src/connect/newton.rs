//! Newton's method for a root within one sequence of impacts: steps that change the sequence are shortened.
//!
//! Known roots `y_i` are divided out (deflation): the miss at `y` is multiplied by
//! `M = prod(1 + |y_i|^2/|y - y_i|^2)`, which multiplies the step by `1/(1 - dM(step)/M)`.

use super::aim::{Aim, Course, Shot};
use crate::least_squares::solve;
use crate::linear::norm;

/// Maximum number of steps.
const STEPS: u32 = 60;

/// Maximum number of trial lengths of a step, each half of the last.
const HALVINGS: u32 = 14;

/// Least relative decrease of the miss in a step, as a multiple of the fraction of the whole step that is made.
const DECREASE: f64 = 1e-4;

/// Result of Newton's method.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Arrival {
    /// A new root: the unknowns, each divided by its unit.
    Root(Vec<f64>),
    /// A known root.
    Known,
    /// No root.
    Nowhere,
}

/// Parameters of Newton's method.
pub(super) struct Newton<'a> {
    pub aim: &'a mut dyn Aim,
    /// The value of each unknown at speed 1.
    pub units: &'a [f64],
    pub course: &'a Course,
    /// Largest speed.
    pub most: f64,
    /// Largest miss of a root.
    pub near: f64,
    /// A typical speed of the problem.
    pub least: f64,
    /// Largest [`Shot::rounding`] so far.
    pub rounding: f64,
}

impl Newton<'_> {
    /// Searches from a start, given by the unknowns divided by their units. Roots of `known` are recognised, and divided
    /// out if `deflated`.
    pub fn search(&mut self, start: &[f64], known: &[Vec<f64>], deflated: bool) -> Arrival {
        let mut y = start.to_vec();
        let mut shot = self.varied(&y);
        for _ in 0..STEPS {
            if shot.course != *self.course || shot.slopes.is_empty() {
                return Arrival::Nowhere;
            }
            let Some(step) = self.step(&shot) else { break };
            if self.is_settled(&y, &step) && self.is_hit(&shot) {
                return self.finish(y, &step, &shot, known);
            }
            if !deflated && known.iter().any(|root| is_captured(&y, &step, root)) {
                return Arrival::Known;
            }
            let step = match deflated {
                true => deflate(&y, step, known),
                false => step,
            };
            let Some(next) = self.advance(&y, &step, &shot, if deflated { known } else { &[] })
            else {
                break;
            };
            y = next;
            shot = self.varied(&y);
        }
        match self.is_hit(&shot) && shot.course == *self.course {
            true => self.named(y, known),
            false => Arrival::Nowhere,
        }
    }

    /// Makes the last step unless it increases the miss.
    fn finish(&mut self, y: Vec<f64>, step: &[f64], shot: &Shot, known: &[Vec<f64>]) -> Arrival {
        let next = moved(&y, step, 1.0);
        let last = self.shoot(&next, false);
        match last.course == *self.course && norm(&last.misses) <= norm(&shot.misses) {
            true => self.named(next, known),
            false => self.named(y, known),
        }
    }

    /// Result for a root, which may be known.
    fn named(&self, y: Vec<f64>, known: &[Vec<f64>]) -> Arrival {
        match known.iter().any(|root| is_same(&y, root, self.least)) {
            true => Arrival::Known,
            false => Arrival::Root(y),
        }
    }

    /// A motion with its derivatives.
    fn varied(&mut self, y: &[f64]) -> Shot {
        let shot = self.shoot(y, true);
        self.rounding = self.rounding.max(shot.rounding);
        shot
    }

    fn shoot(&mut self, y: &[f64], with_slopes: bool) -> Shot {
        let w: Vec<f64> = y.iter().zip(self.units).map(|(y, unit)| y * unit).collect();
        self.aim.shoot(&w, with_slopes)
    }

    /// The length of the whole Newton step; 0 if there is none.
    pub fn length(&self, shot: &Shot) -> f64 {
        let length = self.whole_step(shot).map_or(0.0, |step| norm(&step));
        if length.is_finite() { length } else { 0.0 }
    }

    fn whole_step(&self, shot: &Shot) -> Option<Vec<f64>> {
        let scaled =
            |(column, unit): (&Vec<f64>, &f64)| column.iter().map(|it| it * unit).collect();
        let columns: Vec<Vec<f64>> = shot.slopes.iter().zip(self.units).map(scaled).collect();
        let wanted: Vec<f64> = shot.misses.iter().map(|miss| -miss).collect();
        solve(&columns, &wanted)
    }

    /// The Newton step, at most as long as the largest speed.
    fn step(&self, shot: &Shot) -> Option<Vec<f64>> {
        let step = self.whole_step(shot)?;
        let longest = (self.most / norm(&step)).min(1.0);
        Some(step.iter().map(|it| it * longest).collect())
    }

    /// True if the motion ends as given, apart from rounding.
    fn is_hit(&self, shot: &Shot) -> bool {
        norm(&shot.misses) <= shot.near(self.near)
    }

    fn is_settled(&self, y: &[f64], step: &[f64]) -> bool {
        norm(step) <= 1e-9 * norm(y).max(1e-6 * self.most)
    }

    /// The start after the longest fraction of a step that keeps the sequence of impacts and decreases the miss.
    fn advance(
        &mut self,
        y: &[f64],
        step: &[f64],
        shot: &Shot,
        known: &[Vec<f64>],
    ) -> Option<Vec<f64>> {
        let before = norm(&shot.misses) * factor(y, known);
        let mut part = 1.0;
        for _ in 0..HALVINGS {
            let next = moved(y, step, part);
            let there = self.shoot(&next, false);
            let after = norm(&there.misses) * factor(&next, known);
            if there.course == *self.course && after < (1.0 - DECREASE * part) * before {
                return Some(next);
            }
            part *= 0.5;
        }
        None
    }
}

/// True for two approximations of one root. `speed` is a typical speed of the problem.
pub(super) fn is_same(left: &[f64], right: &[f64], speed: f64) -> bool {
    let size = norm(left).max(norm(right)).max(1e-3 * speed);
    norm(&difference(left, right)) <= 1e-6 * size
}

/// True if `y` is near a root and the step leads much closer to it.
fn is_captured(y: &[f64], step: &[f64], root: &[f64]) -> bool {
    let away = norm(&difference(root, y));
    away <= 0.05 * norm(root) && norm(&difference(root, &moved(y, step, 1.0))) <= 0.05 * away
}

/// The factor by which deflation multiplies the miss. It is infinite at known roots.
fn factor(y: &[f64], known: &[Vec<f64>]) -> f64 {
    let near =
        |root: &Vec<f64>| (norm(&difference(y, root)) / norm(root).max(f64::MIN_POSITIVE)).powi(-2);
    known.iter().map(|root| 1.0 + near(root)).product()
}

/// The Newton step of the deflated miss, from the Newton step of the miss.
fn deflate(y: &[f64], step: Vec<f64>, known: &[Vec<f64>]) -> Vec<f64> {
    let mut growth = 0.0;
    for root in known {
        let size = norm(root).max(f64::MIN_POSITIVE);
        let away: Vec<f64> = difference(y, root).iter().map(|it| it / size).collect();
        let square = norm(&away).powi(2);
        let along: f64 = away
            .iter()
            .zip(&step)
            .map(|(away, step)| away * step / size)
            .sum();
        growth += -2.0 * along / square.powi(2) / (1.0 + 1.0 / square);
    }
    let length = 1.0 / (1.0 - growth);
    match length.is_finite() {
        true => step.iter().map(|it| it * length).collect(),
        false => step,
    }
}

fn moved(y: &[f64], step: &[f64], part: f64) -> Vec<f64> {
    y.iter()
        .zip(step)
        .map(|(y, step)| y + part * step)
        .collect()
}

fn difference(left: &[f64], right: &[f64]) -> Vec<f64> {
    left.iter()
        .zip(right)
        .map(|(left, right)| left - right)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle and a hyperbola with four intersections.
    struct Curves;

    impl Aim for Curves {
        fn steps(&self) -> u64 {
            0
        }

        fn shoot(&mut self, w: &[f64], _with_slopes: bool) -> Shot {
            let (x, y) = (w[0], w[1]);
            Shot {
                course: Course::Reached(Vec::new()),
                misses: vec![x * x + y * y - 5.0, x * y - 2.0],
                slopes: vec![vec![2.0 * x, y], vec![2.0 * y, x]],
                rounding: 0.0,
            }
        }
    }

    #[test]
    fn deflation_finds_every_root_from_one_start() {
        let mut aim = Curves;
        let course = Course::Reached(Vec::new());
        let mut newton = Newton {
            aim: &mut aim,
            units: &[1.0, 1.0],
            course: &course,
            most: 10.0,
            near: 1e-9,
            least: 1.0,
            rounding: 0.0,
        };
        let mut known: Vec<Vec<f64>> = Vec::new();
        while let Arrival::Root(root) = newton.search(&[2.2, 0.4], &known, !known.is_empty()) {
            known.push(root);
            assert!(known.len() <= 4, "{known:?}");
        }
        assert!(known.len() >= 2, "{known:?}");
        for root in &known {
            let size = [root[0].abs(), root[1].abs()];
            assert!(
                (size[0] * size[1] - 2.0).abs() < 1e-12 && (size[0] + size[1] - 3.0).abs() < 1e-12
            );
        }
        assert_eq!(newton.search(&[2.1, 0.9], &known, false), Arrival::Known);
    }
}
