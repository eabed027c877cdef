//! Exact flights of a point in the plane under constant gravity, their first impacts by conservative advancement, and
//! random starts.
//!
//! Conservative advancement moves along the flight by the distance from the nearest surface divided by a bound on the
//! rate of all distances. It never passes a surface.

use core::f64::consts::TAU;

use dalembert_stability::course::Random;

/// A flight in the plane: its start and its gravity.
#[derive(Debug, Clone, Copy)]
pub struct Flight {
    /// Position at time 0.
    pub q: [f64; 2],
    /// Velocity at time 0.
    pub v: [f64; 2],
    /// Acceleration downwards.
    pub g: f64,
}

impl Flight {
    /// The position at a time.
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

    /// Scale of the coordinates along the flight until a time.
    pub fn scale(&self, until: f64) -> f64 {
        1.0 + self.q[0].abs() + self.q[1].abs() + self.speed(until) * until
    }
}

/// First impact of the exact flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Exact {
    /// The flight meets a surface.
    Hits {
        /// Time of the impact.
        t: f64,
        /// Index of the surface.
        surface: usize,
    },
    /// The flight meets no surface.
    Passes,
    /// The flight touches a surface or nearly does: a run may report an impact or not.
    Grazes,
}

/// An impact counts as a graze if the distance falls slower than this fraction of the bound on its rate.
pub const SHALLOW: f64 = 1e-3;

/// Largest number of steps of an advancement.
const STEPS: usize = 200_000;

/// The first impact of a flight between two times. `distances` has the distances from every surface at a time,
/// `fastest` is a bound on the rate of all of them.
///
/// # Panics
/// If there is no surface.
pub fn first_impact(
    flight: &Flight,
    [from, until]: [f64; 2],
    fastest: f64,
    distances: &dyn Fn(f64) -> Vec<f64>,
) -> Exact {
    let scale = flight.scale(until);
    let close = 64.0 * f64::EPSILON * scale;
    let (mut t, mut nearest) = (from, f64::INFINITY);
    for _ in 0..STEPS {
        let numbered = distances(t).into_iter().enumerate();
        let (surface, least) = numbered
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .expect("a surface");
        nearest = f64::min(nearest, least);
        if least <= close {
            let later = t + 1e-6 * until.min(1.0);
            let rate = (distances(later)[surface] - least) / (later - t);
            return match rate < -SHALLOW * fastest {
                true => Exact::Hits { t, surface },
                false => Exact::Grazes,
            };
        }
        t += least / fastest;
        if t > until {
            return match nearest < 1e-9 * scale {
                true => Exact::Grazes,
                false => Exact::Passes,
            };
        }
    }
    // The flight stays close to a surface, because steps are so short only there.
    Exact::Grazes
}

/// A number between two bounds, uniform in its logarithm.
pub fn size(random: &mut Random, low: f64, high: f64) -> f64 {
    random.between(low.ln(), high.ln()).exp()
}

/// A velocity with this speed in any direction.
pub fn direction(random: &mut Random, speed: f64) -> [f64; 2] {
    let angle = random.between(0.0, TAU);
    [speed * angle.cos(), speed * angle.sin()]
}

/// A point of the square about the origin with sides of the length `2*size`.
pub fn point(random: &mut Random, size: f64) -> [f64; 2] {
    [(); 2].map(|()| random.between(-size, size))
}

/// A velocity with this speed from `q` towards a point.
pub fn towards([x, y]: [f64; 2], q: [f64; 2], speed: f64) -> [f64; 2] {
    let way = [x - q[0], y - q[1]];
    let length = way[0].hypot(way[1]);
    way.map(|part| speed * part / length)
}
