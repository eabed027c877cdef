//! Energy over a million steps: bounded where the theory says so, growing where it does not. The numbers measured are those
//! of the documentation.
//!
//! `cargo test --release -p dalembert-tests --test structure -- --ignored`

use dalembert::{
    Constrained, Described, Dla2, Dla4, Effect, Gauss4, Gauss6, Lagrangian, Outcome, Projection,
    Rk4, StateVector, Stepper, Tolerance,
};
use dalembert_cli::drift::{Request, Series, follow};
use dalembert_models::{DoublePendulum, HarmonicOscillator, RollingDisk};

dalembert::model! {
    /// A knife edge in a quadratic potential, steered by a pendulum; `c` couples the steering to the place, `b` is a magnetic
    /// field.
    pub SteeredEdge {
        coordinates { x; y; phi: angle; }
        parameters { k > 0 = 2; s = 0.4; c = 0; b = 0; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(phi)^2)/2 + b*(x*dot(y) - y*dot(x))/2
            - (x^2 + k*y^2)/2 + s*cos(phi) + c*x*sin(phi);
        constraints { edge: sin(phi)*d(x) - cos(phi)*d(y) = 0; }
    }
}

dalembert::model! {
    /// The nonholonomic particle in a potential that does not separate.
    pub HeldParticle {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 - (x^2 + y^2 + z^2 + x^2*z^2)/2;
        constraints { contact: d(z) - y*d(x) = 0; }
    }
}

const STEPS: f64 = 1e6;

/// The energy over a million steps of `h`, in a hundred windows.
fn energy<S: Described + Lagrangian, Step: Stepper<S>, E: Effect<S>>(
    system: &S,
    (q, qdot): (&[f64], &[f64]),
    h: f64,
    (stepper, effects): (Step, E),
) -> Series {
    let vector = |values: &[f64]| {
        let mut vector = S::Vector::zeros();
        vector.as_mut_slice().copy_from_slice(values);
        vector
    };
    let state = system
        .state_projected(0.0, &vector(q), &vector(qdot))
        .expect("a state");
    let request = Request {
        until: STEPS * h,
        windows: 100,
        quantity: |t: f64, state: &S::State| system.energy(t, state).expect("an energy"),
    };
    let series = follow(system, state, (stepper, effects), request).expect("a start");
    println!(
        "{:20} {:6} h {h}: H {:.3}, largest {:.1e}, drift {:.1e}, exponent {:.2}",
        S::DESCRIPTION.name,
        Step::NAME,
        series.start,
        series.largest(),
        series.drift(),
        series.exponent()
    );
    assert_eq!(
        (series.outcome, series.steps),
        (Outcome::Done, STEPS as u64)
    );
    series
}

macro_rules! energy {
    ($method:ident, $h:expr, $system:expr, $start:expr) => {
        energy!($method, $h, $system, $start, ())
    };
    ($method:ident, $h:expr, $system:expr, $start:expr, $effects:expr) => {{
        let stepper = $method::new(Tolerance::new(1e-9).expect("a tolerance")).with_step($h);
        energy(&$system, $start, $h, (stepper, $effects))
    }};
}

/// Bounded, and without drift beyond a part of the bound.
fn assert_bounded(series: &Series, largest: f64, drift: f64) {
    assert!(series.largest() < largest, "{:e}", series.largest());
    assert!(series.drift().abs() < drift, "{:e}", series.drift());
    assert!(series.exponent() < 0.1, "{}", series.exponent());
}

#[test]
#[ignore = "nightly: twelve runs of a million steps"]
fn gauss_keeps_the_energy_of_regular_motion() {
    let oscillator = HarmonicOscillator::default();
    let start: (&[f64], &[f64]) = (&[1.0], &[0.0]);
    // A quadratic invariant: nothing but a random walk of rounding errors, 1e-16 each.
    assert!(energy!(Gauss4, 0.1, oscillator, start).largest() < 2e-14);
    assert!(energy!(Gauss6, 0.1, oscillator, start).largest() < 2e-14);
    let classical = energy!(Rk4, 0.1, oscillator, start);
    assert!(classical.largest() > 5e-3 && (classical.exponent() - 1.0).abs() < 0.05);

    let pendulum = DoublePendulum::default();
    let start: (&[f64], &[f64]) = (&[0.4, 0.3], &[0.0, 0.0]);
    assert_bounded(&energy!(Gauss4, 0.02, pendulum, start), 4e-8, 4e-12);
    assert_bounded(&energy!(Gauss6, 0.02, pendulum, start), 2e-11, 1e-14);
    // At a quarter of the step the error of the method is that of rounding.
    assert!(energy!(Gauss6, 0.005, pendulum, start).largest() < 4e-14);
    assert_bounded(&energy!(Dla2, 0.02, pendulum, start), 1e-4, 5e-8);
    assert_bounded(&energy!(Dla4, 0.02, pendulum, start), 2e-8, 4e-12);
    let classical = energy!(Rk4, 0.02, pendulum, start);
    assert!(classical.largest() > 4e-3 && (classical.exponent() - 1.0).abs() < 0.05);
}

#[test]
#[ignore = "nightly: nine runs of a million steps"]
fn the_principle_keeps_the_energy_of_regular_reversible_motion() {
    let disk = RollingDisk::default();
    let start: (&[f64], &[f64]) = (&[0.0, 0.0, 0.0, 0.3], &[0.0, 0.0, 10.0, 0.7]);
    let free = energy!(Dla2, 0.02, disk, start);
    assert!(free.largest() < 1e-11 * free.start);

    let edge = SteeredEdge::default();
    let start: (&[f64], &[f64]) = (&[1.0, 0.2, 0.3], &[0.5, 0.0, 0.7]);
    assert_bounded(&energy!(Dla2, 0.05, edge, start), 5e-4, 2e-7);
    assert_bounded(&energy!(Dla4, 0.05, edge, start), 4e-8, 2e-11);
    let particle = HeldParticle::default();
    let start: (&[f64], &[f64]) = (&[1.0, 0.2, 0.3], &[0.5, 0.4, 0.0]);
    assert_bounded(&energy!(Dla2, 0.05, particle, start), 6e-4, 2e-6);
    assert_bounded(&energy!(Dla4, 0.05, particle, start), 2e-8, 2e-11);
}

fn projection<S: Constrained>(_: &S) -> Projection<S> {
    Projection::new()
}

#[test]
#[ignore = "nightly: four runs of a million steps"]
fn energy_grows_where_nothing_holds_it() {
    let start: (&[f64], &[f64]) = (&[1.0, 0.2, 0.3], &[0.5, 0.0, 0.7]);
    // Coupled to the place and in a magnetic field the motion is chaotic and not reversible: the energy walks.
    let wild = SteeredEdge {
        c: 0.5,
        b: 0.8,
        ..SteeredEdge::default()
    };
    let second = energy!(Dla2, 0.05, wild, start);
    assert!(second.exponent() > 0.3 && second.largest() > 2e-3);
    let fourth = energy!(Dla4, 0.05, wild, start);
    assert!(fourth.exponent() > 0.2, "{}", fourth.exponent());
    // In global form Gauss's method leaves D, and the energy goes with it; the effect that returns to D is not symmetric.
    // The form reduced to D needs no return.
    let reduced = SteeredEdge::default();
    let edge = reduced.global();
    let leaving = energy!(Gauss4, 0.05, edge, start);
    assert!(leaving.exponent() > 1.5, "{}", leaving.exponent());
    let returned = energy!(Gauss4, 0.05, edge, start, projection(&edge));
    assert!(returned.largest() < 1e-5 && returned.exponent() > 0.8);
    assert_bounded(&energy!(Gauss4, 0.05, reduced, start), 1e-6, 1e-9);
}
