//! Exact flights and their first impacts.

use crate::families::Case;

/// A start in the plane, with the downward acceleration `g`.
#[derive(Debug, Clone, Copy)]
pub struct Flight {
    pub q: [f64; 2],
    pub v: [f64; 2],
    pub g: f64,
}

impl Flight {
    pub fn at(&self, t: f64) -> [f64; 2] {
        [
            self.q[0] + self.v[0] * t,
            self.q[1] + (self.v[1] - 0.5 * self.g * t) * t,
        ]
    }

    /// Bound on the speed until a time.
    pub fn speed(&self, until: f64) -> f64 {
        self.v[0].hypot(self.v[1].abs() + self.g * until)
    }
}

/// First impact of the exact flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Exact {
    Hits {
        t: f64,
        surface: usize,
    },
    Passes,
    /// The flight touches a surface or nearly does: a run may report an impact or not.
    Grazes,
}

/// An impact counts as a graze if the gap falls slower than this fraction of the bound on its rate.
pub const SHALLOW: f64 = 1e-3;

/// The first impact, by conservative advancement.
pub fn exact(case: &Case) -> Exact {
    let scale = case.scale();
    let close = 64.0 * f64::EPSILON * scale;
    let mut t = case.after;
    let mut nearest = f64::INFINITY;
    for _ in 0..200_000 {
        let distances = case.distances(t);
        let numbered = distances.iter().copied().enumerate();
        let (surface, least) = numbered
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .expect("a surface");
        nearest = nearest.min(least);
        if least <= close {
            let later = t + 1e-6 * case.until.min(1.0);
            let rate = (case.distances(later)[surface] - least) / (later - t);
            return match rate < -SHALLOW * case.fastest {
                true => Exact::Hits { t, surface },
                false => Exact::Grazes,
            };
        }
        t += least / case.fastest;
        if t > case.until {
            return match nearest < 1e-9 * scale {
                true => Exact::Grazes,
                false => Exact::Passes,
            };
        }
    }
    // The flight stays close to a surface: only there are the steps so short.
    Exact::Grazes
}
