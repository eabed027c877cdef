//! Starts along a line, for one unknown. A change of sign of the miss brackets a root. An extremum of the miss near 0
//! is bracketed by the signs of its derivative.

use super::aim::{Aim, Course};
use super::scan::Sample;

/// Least number of intervals into which a stretch is divided.
const INTERVALS: f64 = 16.0;

/// Maximum number of steps in a bracket.
const STEPS: u32 = 200;

/// A start on the line, with the miss and its derivative with respect to the unknown.
#[derive(Debug, Clone, Copy)]
struct Place {
    w: f64,
    miss: f64,
    slope: f64,
    /// Largest miss of a root.
    near: f64,
}

/// Finds the starts with miss 0 in one equation, on a stretch of starts with one sequence of impacts. `unit` is the
/// value of the unknown at speed 1. An extremum of the miss counts as a root if its absolute value is at most `near`.
/// Also returns the number of intervals that were not resolved.
pub(super) fn roots(
    aim: &mut dyn Aim,
    window: &[Sample],
    unit: f64,
    near: f64,
    equation: usize,
) -> (Vec<f64>, usize) {
    let course = &window[0].shot.course;
    let mut line = Line {
        aim,
        course,
        near,
        equation,
        roots: Vec::new(),
        unresolved: 0,
    };
    let ends = [&window[0], &window[window.len() - 1]].map(|sample| sample.speed);
    let mut last = line.follow(None, ends[0] * unit);
    for pair in window.windows(2) {
        let [from, to] = [pair[0].speed, pair[1].speed];
        let parts = (INTERVALS * (to - from) / (ends[1] - ends[0]))
            .ceil()
            .max(1.0);
        for part in 1..=parts as usize {
            let speed = from + (to - from) * (part as f64 / parts);
            last = line.follow(last, speed * unit).or(last);
        }
    }
    (line.roots, line.unresolved)
}

struct Line<'a> {
    aim: &'a mut dyn Aim,
    course: &'a Course,
    near: f64,
    equation: usize,
    roots: Vec<f64>,
    unresolved: usize,
}

impl Line<'_> {
    /// Adds the roots between the last start and the next one, `w`.
    fn follow(&mut self, last: Option<Place>, w: f64) -> Option<Place> {
        let place = self.place(w)?;
        match last {
            Some(last) => self.between(last, place),
            None if place.miss == 0.0 => self.roots.push(w),
            None => {}
        }
        Some(place)
    }

    /// The miss at a start; `None` if it has another sequence of impacts or no derivative.
    fn place(&mut self, w: f64) -> Option<Place> {
        let shot = self.aim.shoot(&[w], true);
        let miss = *shot.misses.get(self.equation)?;
        let slope = *shot.slopes.first()?.get(self.equation)?;
        let is_usable = shot.course == *self.course && miss.is_finite() && slope.is_finite();
        is_usable.then_some(Place {
            w,
            miss,
            slope,
            near: shot.near(self.near),
        })
    }

    /// Adds the roots after `left` up to `right`.
    fn between(&mut self, left: Place, right: Place) {
        if right.miss == 0.0 {
            self.roots.push(right.w);
        } else if left.miss * right.miss < 0.0 {
            self.bracket(left, right);
        } else if self.turns(left, right) {
            self.fold(left, right);
        }
    }

    /// True if the absolute miss decreases from both ends into the interval.
    fn turns(&self, left: Place, right: Place) -> bool {
        let span = right.w - left.w;
        left.miss * left.slope * span < 0.0 && right.miss * right.slope * span > 0.0
    }

    /// Newton's method, with bisection if it leaves the bracket or converges slowly.
    fn bracket(&mut self, mut left: Place, mut right: Place) {
        let mut best = if left.miss.abs() < right.miss.abs() {
            left
        } else {
            right
        };
        let mut width = right.w - left.w;
        for _ in 0..STEPS {
            let newton = best.w - best.miss / best.slope;
            let middle = 0.5 * (left.w + right.w);
            let is_inside = (newton - left.w) * (newton - right.w) < 0.0;
            let is_slow = (right.w - left.w).abs() > 0.5 * width.abs();
            width = right.w - left.w;
            let w = if is_inside && !(is_slow && (newton - best.w).abs() > 0.25 * width.abs()) {
                newton
            } else {
                middle
            };
            if w == best.w || w == left.w || w == right.w {
                break;
            }
            let Some(place) = self.place(w) else {
                self.unresolved += 1;
                return;
            };
            match place.miss * left.miss > 0.0 {
                true => left = place,
                false => right = place,
            }
            let is_better = place.miss.abs() < best.miss.abs();
            if !is_better && (place.w - best.w).abs() <= 4.0 * f64::EPSILON * best.w.abs() {
                break;
            }
            // Newton's method continues from the new start if its miss is smaller, else from the better end of the
            // bracket.
            best = if is_better {
                place
            } else {
                nearer(left, right)
            };
            if best.miss == 0.0 {
                break;
            }
        }
        self.keep(best);
    }

    /// Bisects to the extremum of the miss, and brackets the roots on both sides if the miss changes sign.
    fn fold(&mut self, mut left: Place, mut right: Place) {
        for _ in 0..STEPS {
            let w = 0.5 * (left.w + right.w);
            if w == left.w || w == right.w {
                break;
            }
            let Some(place) = self.place(w) else {
                self.unresolved += 1;
                return;
            };
            if place.miss * left.miss <= 0.0 {
                self.bracket(left, place);
                self.bracket(place, right);
                return;
            }
            match place.slope * left.slope > 0.0 {
                true => left = place,
                false => right = place,
            }
            let is_flat =
                |at: Place| (at.slope * (right.w - left.w)).abs() < f64::EPSILON * at.miss.abs();
            if is_flat(left) && is_flat(right) {
                break;
            }
        }
        self.keep(nearer(left, right));
    }

    fn keep(&mut self, place: Place) {
        if place.miss.abs() <= place.near {
            self.roots.push(place.w);
        }
    }
}

fn nearer(left: Place, right: Place) -> Place {
    if left.miss.abs() < right.miss.abs() {
        left
    } else {
        right
    }
}

#[cfg(test)]
mod tests {
    use super::super::aim::Shot;
    use super::*;

    /// A miss as a function of one unknown, with its derivative.
    struct Curve(fn(f64) -> [f64; 2]);

    impl Aim for Curve {
        fn steps(&self) -> u64 {
            0
        }

        fn shoot(&mut self, w: &[f64], _with_slopes: bool) -> Shot {
            let [miss, slope] = (self.0)(w[0]);
            Shot {
                course: Course::Reached(Vec::new()),
                misses: vec![miss],
                slopes: vec![vec![slope]],
                rounding: 0.0,
            }
        }
    }

    fn found(curve: fn(f64) -> [f64; 2], speeds: [f64; 3]) -> Vec<f64> {
        let mut curve = Curve(curve);
        let samples: Vec<Sample> = speeds
            .into_iter()
            .map(|speed| Sample {
                speed,
                shot: curve.shoot(&[speed], true),
            })
            .collect();
        roots(&mut curve, &samples, 1.0, 1e-12, 0).0
    }

    #[test]
    fn roots_on_both_sides_of_a_turn_are_found() {
        let found = found(
            |w| [(w - 1.5).powi(2) - 1e-8, 2.0 * (w - 1.5)],
            [0.0, 1.0, 3.0],
        );
        assert_eq!(found.len(), 2, "{found:?}");
        assert!((found[0] - 1.4999).abs() < 1e-12 && (found[1] - 1.5001).abs() < 1e-12);
    }

    #[test]
    fn a_miss_that_stays_away_from_zero_has_no_root() {
        assert!(
            found(
                |w| [(w - 1.5).powi(2) + 1e-8, 2.0 * (w - 1.5)],
                [0.0, 1.0, 3.0]
            )
            .is_empty()
        );
    }

    #[test]
    fn steep_and_flat_roots_are_found() {
        let flat = found(
            |w| [(w - 1.0).powi(5), 5.0 * (w - 1.0).powi(4)],
            [0.0, 0.3, 4.0],
        );
        assert!(flat.len() == 1 && (flat[0] - 1.0).abs() < 1e-2, "{flat:?}");
        let steep = found(
            |w| [(w - 1.2).atan() * 1e6, 1e6 / (1.0 + (w - 1.2).powi(2))],
            [-900.0, 1.0, 700.0],
        );
        assert!(
            steep.len() == 1 && (steep[0] - 1.2).abs() < 1e-14,
            "{steep:?}"
        );
    }
}
