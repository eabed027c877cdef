//! The time of an isolated fall to the last bits, and poles told from falls.

use super::{Bracket, Fall, Line, Search};

/// A change of sign is a pole if the gap next to it exceeds the gap elsewhere in the step by this factor.
const PEAK: f64 = (1 << 10) as f64;

impl Line<'_> {
    /// Narrows the bracket of the fall.
    pub(super) fn narrow(
        &mut self,
        Fall {
            before,
            after,
            guess,
        }: Fall,
    ) -> Search {
        let slope = self.start.slope;
        let mut value = |theta: f64| deflated((self.gap)(theta), theta, slope);
        let [first, last] = [before, after].map(|place| deflated(place.gap, place.x, slope));
        const NEAREST: f64 = 1.0 / 64.0;
        let trial = before.x + guess.clamp(NEAREST, 1.0 - NEAREST) * (after.x - before.x);
        let at_trial = value(trial);
        // The first two points are the newest one and one on the other side of the root.
        let drop = match at_trial >= 0.0 {
            true => Drop {
                x: [trial, after.x, before.x],
                f: [at_trial, last, first],
            },
            false => Drop {
                x: [trial, before.x, after.x],
                f: [at_trial, first, last],
            },
        };
        let narrowed = narrow(drop, value);
        // Towards a pole the gap grows. It is compared with its values at the ends of the first bracket or, if that
        // bracket was narrow already, with its values elsewhere in the step.
        let size = |drop: &Drop| {
            let gap = |i: usize| {
                if slope.is_some() {
                    drop.f[i] * drop.x[i]
                } else {
                    drop.f[i]
                }
            };
            gap(0).abs().max(gap(1).abs())
        };
        let (grown, bracket) = (size(&narrowed), narrowed.bracket());
        let nearby = before.gap.abs().max(after.gap.abs());
        let mut is_peak = || {
            let inside = [0.25, 0.5, 0.75].map(|x| (self.gap)(x));
            let sizes = inside.into_iter().chain(self.ends).map(f64::abs);
            let largest = sizes.fold(0.0_f64, f64::max);
            grown > PEAK * largest && grown > PEAK * (self.rounding)(trial)
        };
        let is_infinite = nearby == f64::INFINITY;
        if is_infinite || grown > nearby || (PEAK * grown > nearby && is_peak()) {
            Search::Pole(bracket.after, after.x.max(bracket.after))
        } else {
            Search::Falls(bracket)
        }
    }
}

/// A gap divided by the fraction of the step, for a surface just left; its limit at 0 is the slope.
///
/// The division removes the root at the start and most of the curvature of a flight, which saves iterations.
fn deflated(gap: f64, theta: f64, slope: Option<f64>) -> f64 {
    match slope {
        Some(slope) if theta == 0.0 => slope,
        Some(_) => gap / theta,
        None => gap,
    }
}

/// Three points near a fall, with the values there. The newest point comes first; the first two enclose the root.
#[derive(Debug, Clone, Copy)]
struct Drop {
    x: [f64; 3],
    f: [f64; 3],
}

impl Drop {
    fn bracket(&self) -> Bracket {
        let [before, after] = if self.f[0] >= 0.0 {
            [self.x[0], self.x[1]]
        } else {
            [self.x[1], self.x[0]]
        };
        let nearest = match self.f[0].abs() <= self.f[1].abs() {
            true => self.x[0],
            false => self.x[1],
        };
        Bracket {
            before,
            after,
            nearest,
        }
    }
}

/// Chandrupatla's method: inverse quadratic interpolation where it is safe, otherwise bisection.
fn narrow(drop: Drop, mut value: impl FnMut(f64) -> f64) -> Drop {
    let Drop { mut x, mut f } = drop;
    let mut reach = 1.0;
    // Bisection alone ends within 64 halvings, except for roots next to 0.
    for _ in 0..200 {
        let best = if f[0].abs() < f[1].abs() { x[0] } else { x[1] };
        let width = (x[1] - x[0]).abs();
        let resolution = 2.0 * f64::EPSILON * best.abs();
        if width <= resolution {
            break;
        }
        // Trials keep a distance from the ends so that both ends close in on the root. A trial near an end that finds
        // no change of sign, because rounding decides there, is followed by one further away.
        let part = next_part(x, f);
        let margin = (reach * resolution / width).min(0.5);
        let mut trial = if part >= 1.0 - margin {
            x[1] - margin * (x[1] - x[0])
        } else {
            x[0] + part.max(margin) * (x[1] - x[0])
        };
        if trial == x[1] {
            // The root is so close to 0 that it cannot be told from there as a part of the bracket.
            trial = x[1] + f[1] / (f[1] - f[0]) * (x[0] - x[1]);
        }
        reach *= if part <= margin || part >= 1.0 - margin {
            4.0
        } else {
            1.0
        };
        if trial == x[0] || trial == x[1] {
            break;
        }
        let at_trial = value(trial);
        if (at_trial >= 0.0) == (f[0] >= 0.0) {
            (x[2], f[2]) = (x[0], f[0]);
        } else {
            (x[2], f[2]) = (x[1], f[1]);
            (x[1], f[1]) = (x[0], f[0]);
            reach = 1.0;
        }
        (x[0], f[0]) = (trial, at_trial);
    }
    Drop { x, f }
}

/// Place of the next trial, as a fraction of the way from `x[0]` to `x[1]`.
fn next_part(x: [f64; 3], f: [f64; 3]) -> f64 {
    let xi = (x[0] - x[1]) / (x[2] - x[1]);
    let phi = (f[0] - f[1]) / (f[2] - f[1]);
    // A third point outside the bracket occurs only at first. Interpolation is safe there if the three values are in
    // order.
    let ordered = if xi <= 1.0 {
        phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi
    } else {
        (f[0] - f[2]) * (f[1] - f[0]) > 0.0 || (f[0] - f[1]) * (f[1] - f[2]) > 0.0
    };
    if ordered {
        let part = f[0] / (f[1] - f[0]) * (f[2] / (f[1] - f[2]))
            + (x[2] - x[0]) / (x[1] - x[0]) * (f[0] / (f[2] - f[0])) * (f[1] / (f[2] - f[1]));
        if part.is_finite() {
            return part;
        }
    }
    0.5
}
