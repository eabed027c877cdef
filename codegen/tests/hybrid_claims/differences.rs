//! Volume factors by finite differences. A Runge-Kutta method follows a motion through an impact. Central differences
//! give the derivative of the motion's end with respect to its start. The factor is the absolute value of the
//! determinant of this derivative, times the density at the end over the density at the start.
//!
//! The generator is used for the verdict only.

use crate::Expected::True;
use crate::check;
use crate::systems::{crossing, grooves, media, particle, spokes, walker};

pub(super) type State = Vec<f64>;
type Density<'h> = &'h dyn Fn(&[f64]) -> f64;

/// Vector fields before and after an impact, with the gap of the surface and the map of the impact.
pub(super) struct Hybrid<'h> {
    pub(super) before: &'h dyn Fn(&[f64]) -> State,
    pub(super) gap: &'h dyn Fn(&[f64]) -> f64,
    pub(super) map: &'h dyn Fn(&[f64]) -> State,
    pub(super) after: &'h dyn Fn(&[f64]) -> State,
    /// Densities of the volumes before and after the impact, in the coordinates of the state.
    pub(super) densities: [Density<'h>; 2],
}

const STEPS: usize = 400;

fn step(rate: &dyn Fn(&[f64]) -> State, z: &[f64], h: f64) -> State {
    let moved = |k: &State, s: f64| -> State { z.iter().zip(k).map(|(z, k)| z + s * k).collect() };
    let k1 = rate(z);
    let k2 = rate(&moved(&k1, h / 2.0));
    let k3 = rate(&moved(&k2, h / 2.0));
    let k4 = rate(&moved(&k3, h));
    let sum = (0..z.len()).map(|i| z[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    sum.collect()
}

pub(super) fn run(rate: &dyn Fn(&[f64]) -> State, z: &[f64], time: f64) -> State {
    let h = time / STEPS as f64;
    (0..STEPS).fold(z.to_vec(), |z, _| step(rate, &z, h))
}

impl Hybrid<'_> {
    /// The state at a time, for a motion with one impact before that time.
    pub(super) fn end(&self, start: &[f64], time: f64) -> State {
        // The secant method finds the time of the impact.
        let gap_at = |t: f64| (self.gap)(&run(self.before, start, t));
        let (mut t0, mut t1) = (0.0, time / 2.0);
        for _ in 0..40 {
            let (g0, g1) = (gap_at(t0), gap_at(t1));
            if (g1 - g0).abs() < 1e-300 || (t1 - t0).abs() < 1e-15 {
                break;
            }
            (t0, t1) = (t1, t1 - g1 * (t1 - t0) / (g1 - g0));
        }
        assert!(t1 > 0.0 && t1 < time, "an impact at {t1}");
        let hit = run(self.before, start, t1);
        run(self.after, &(self.map)(&hit), time - t1)
    }

    /// Derivatives of the motion's end with respect to the components of its start.
    pub(super) fn columns(&self, start: &[f64], time: f64) -> Vec<State> {
        let n = start.len();
        (0..n)
            .map(|i| {
                let h = 1e-4;
                let moved = |h: f64| {
                    let mut z = start.to_vec();
                    z[i] += h;
                    self.end(&z, time)
                };
                let pairs = [moved(h), moved(-h), moved(2.0 * h), moved(-2.0 * h)];
                let slope = |j: usize| {
                    (8.0 * (pairs[0][j] - pairs[1][j]) - (pairs[2][j] - pairs[3][j])) / (12.0 * h)
                };
                (0..n).map(slope).collect()
            })
            .collect()
    }

    /// Factor by which the motion multiplies the volume.
    pub(super) fn factor(&self, start: &[f64], time: f64) -> f64 {
        let [before, after] = self.densities;
        determinant(self.columns(start, time)).abs() * after(&self.end(start, time)) / before(start)
    }
}

pub(super) fn determinant(mut rows: Vec<State>) -> f64 {
    let n = rows.len();
    let mut product = 1.0;
    for k in 0..n {
        let pivot = (k..n).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs()));
        let pivot = pivot.expect("a row");
        if pivot != k {
            rows.swap(pivot, k);
            product = -product;
        }
        product *= rows[k][k];
        for i in k + 1..n {
            let factor = rows[i][k] / rows[k][k];
            for j in k..n {
                let entry = rows[k][j];
                rows[i][j] -= factor * entry;
            }
        }
    }
    product
}

#[track_caller]
pub(super) fn assert_close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9, "{found} for {expected}");
}

pub(super) fn one(_: &[f64]) -> f64 {
    1.0
}

#[test]
fn a_strip_that_multiplies_velocities() {
    let free = |z: &[f64]| vec![z[2], z[3], 0.0, 0.0];
    let strip = Hybrid {
        before: &free,
        gap: &|z| z[0],
        map: &|z| vec![z[0], z[1], -1.25 * z[2], 0.5 * z[3]],
        after: &free,
        densities: [&one, &one],
    };
    assert_close(strip.factor(&[1.0, 0.3, -0.8, 0.4], 2.0), 1.25 * 1.25 * 0.5);
    let surface = "left: x >= 0 => reset { dot(x) = -a*dot(x); dot(y) = dot(y)/2; };";
    check(
        &particle(surface),
        "density under left: factor = a^2/2",
        True,
    );
}

/// The reset stretches positions by `3 + 3 x^2` and multiplies the normal velocity by 0.7. So the flux through the
/// surface is multiplied by 0.7, too.
#[test]
fn a_reset_that_moves_the_position() {
    let free = |z: &[f64]| vec![z[2], z[3], 0.0, -1.0];
    let floor = Hybrid {
        before: &free,
        gap: &|z| z[1],
        map: &|z| {
            vec![
                3.0 * z[0] * (1.0 + z[0] * z[0] / 3.0),
                z[1],
                z[2] + z[0],
                -0.7 * z[3],
            ]
        },
        after: &free,
        densities: [&one, &one],
    };
    let (x, time) = (0.2, 1.0);
    let start = [x, 0.1, 0.5, -0.4];
    // The particle falls from the height 0.1 to the floor in the time (-0.4 + sqrt(0.36))/1.
    let hit = x + 0.5 * (-0.4 + 0.36_f64.sqrt());
    assert_close(floor.factor(&start, time), 3.0 * (1.0 + hit * hit) * 0.49);
    let declared =
        "low: y >= 0 => reset { x = 3*x + x^3; dot(x) = dot(x) + x; dot(y) = -0.7*dot(y); };";
    check(
        &particle(declared),
        "density under low: factor = 3*(1 + x^2)*0.49",
        True,
    );
}

#[test]
fn the_step_of_a_walker() {
    let (lf, inertia, g, alpha, delta) = (0.5, 0.25, 1.0, 0.1, 0.3_f64);
    let mass = move |theta: f64| inertia + lf * lf * theta.sin().powi(2);
    let rate = move |z: &[f64]| {
        let (theta, omega) = (z[1], z[3]);
        let torque = g * lf * f64::cos(alpha) * theta.sin()
            - lf * lf * omega * omega * theta.sin() * theta.cos();
        vec![z[2], omega, g * f64::sin(alpha), torque / mass(theta)]
    };
    let density = move |z: &[f64]| mass(z[1]);
    let step = Hybrid {
        before: &rate,
        gap: &|z| z[1] + delta,
        map: &|z| {
            let c = (2.0 * delta).cos();
            vec![
                z[0],
                z[1] + 2.0 * delta,
                z[2] + lf * delta.cos() * (1.0 - c) * z[3],
                c * z[3],
            ]
        },
        after: &rate,
        densities: [&density, &density],
    };
    let factor = step.factor(&[0.0, -0.2, 0.4, -1.1], 0.3);
    assert_close(factor, 0.6_f64.cos().powi(2));
    check(
        &walker("cos(2*delta)*dot(theta)"),
        "density under step: factor = cos(2*delta)^2",
        True,
    );
}

#[test]
fn a_wheel_that_changes_its_spoke() {
    let (l1, l2, h) = (1.7, 1.9, 0.65_f64);
    let pendulum = |l: f64| move |z: &[f64]| vec![z[1], z[0].sin() / l];
    let (first, second) = (pendulum(l1), pendulum(l2));
    let wheel = Hybrid {
        before: &first,
        gap: &|z| z[0] + h,
        map: &|z| vec![z[0] + 2.0 * h, l1 / l2 * (2.0 * h).cos() * z[1]],
        after: &second,
        densities: [&|_| l1 * l1, &|_| l2 * l2],
    };
    assert_close(wheel.factor(&[-0.6, -0.5], 0.3), (2.0 * h).cos().powi(2));
    check(
        &spokes("l1/l2*cos(2*h)*dot(x)"),
        "density under step: factor = cos(2*h)^2",
        True,
    );
}

#[test]
fn a_refraction() {
    let free = |z: &[f64]| vec![z[2], z[3], 0.0, 0.0];
    let (m1, m2, v) = (1.0, 2.0, 0.2);
    let glass = Hybrid {
        before: &free,
        gap: &|z| -z[0],
        map: &|z| {
            let py = m1 * z[3];
            let energy = m1 / 2.0 * (z[2] * z[2] + z[3] * z[3]);
            let normal: f64 = 2.0 * m2 * (energy - v) - py * py;
            vec![z[0], z[1], normal.sqrt() / m2, py / m2]
        },
        after: &free,
        densities: [&|_| m1 * m1, &|_| m2 * m2],
    };
    assert_close(glass.factor(&[-0.5, 0.2, 1.1, 0.4], 1.0), 1.0);
    let model = media(
        "m1/2*(dot(x)^2 + dot(y)^2)",
        "m2/2*(dot(x)^2 + dot(y)^2) - V",
    );
    check(&model, "density under rightward: factor = 1", True);
}

/// A velocity along `(1, a)` becomes the nearest velocity along `(1, b)`: its x component is multiplied by
/// `(1 + a b)/(1 + b^2)`.
#[test]
fn a_groove_that_turns() {
    let groove = |slope: f64| move |z: &[f64]| vec![z[2], slope * z[2], 0.0];
    let (left, right) = (groove(0.5), groove(2.0));
    let ratio = (1.0 + 0.5 * 2.0) / (1.0 + 2.0 * 2.0);
    let grooves_of = Hybrid {
        before: &left,
        gap: &|z| -z[0],
        map: &|z| vec![z[0], z[1], ratio * z[2]],
        after: &right,
        densities: [&one, &one],
    };
    let factor = grooves_of.factor(&[-0.5, 0.2, 1.1], 1.0);
    assert_close(factor, ratio * ratio);
    check(
        &grooves("dot(y) = dot(x)/2", "dot(y) = 2*dot(x)"),
        "density under rightward: factor = 4/25",
        True,
    );
}

#[test]
fn a_field_that_jumps() {
    let crossed = Hybrid {
        before: &|_| vec![-2.0, 1.0],
        gap: &|z| z[0],
        map: &|z| z.to_vec(),
        after: &|_| vec![-1.0, -1.0],
        densities: [&one, &one],
    };
    assert_close(crossed.factor(&[1.0, 0.0], 1.0), 0.5);
    check(
        &crossing(["-2", "1"], ["-1", "-1"], "1"),
        "density under leftward: factor = 1/2",
        True,
    );
}
