//! Discontinuous fields, media and metrics that change at a curve, Mathieu's equation, and a map as a system of modes.

use std::f64::consts::TAU;

use dalembert::{EventLog, Fault, Outcome, System};
use dalembert_cli::Integrator;
use dalembert_stability::text::shipped;

use super::{course, end, mode_number};

#[test]
fn the_motion_slides_where_both_sides_lead_to_the_line() {
    let field = shipped("filippov_field").model();
    let run = end(course(&field, &[1.0, 0.0], &[0.0; 2], 3.5));
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 1));
    let q = field.position(&run.state);
    let q = q.as_ref();
    assert!(
        q[0].abs() < 1e-15 && (q[1] - (0.5 - 1.0)).abs() < 1e-14,
        "{q:?}"
    );
}

/// If the media are equal, the motion is unchanged to the last bit.
#[test]
fn between_equal_media_nothing_happens() -> Result<(), Fault> {
    let particle = shipped("refracted_particle").with([("m2", 1.0)]);
    let run = end(course(&particle, &[-1.0, 0.3], &[0.7, 0.4], 3.0));
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 1));
    let p = particle.momentum(3.0, &run.state)?;
    assert_eq!(p.as_ref(), [0.7, 0.4]);
    Ok(())
}

#[test]
fn angular_momentum_and_energy_are_kept_across_the_circle() -> Result<(), Fault> {
    let point = shipped("sphere_in_plane").model();
    let course = course(&point, &[-1.0, 0.2], &[1.0, 0.1], 3.0).tol(1e-13);
    let start = *course.start();
    let run = end(course);
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 2));
    let turning = |t: f64, state: &_| -> Result<f64, Fault> {
        let (q, p) = (point.position(state), point.momentum(t, state)?);
        let (q, p) = (q.as_ref(), p.as_ref());
        Ok(q[0] * p[1] - q[1] * p[0])
    };
    assert!((turning(3.0, &run.state)? - turning(0.0, &start)?).abs() < 1e-12);
    let drift = point.energy(3.0, &run.state)? - point.energy(0.0, &start)?;
    assert!(drift.abs() < 1e-12, "{drift:e}");
    Ok(())
}

/// The trace of the map of Mathieu's equation over a period, from the two motions that start at unit vectors.
fn trace_of_mathieu(delta: f64, eps: f64) -> f64 {
    let equation = shipped("mathieu").with([("delta", delta), ("eps", eps)]);
    let component = |index: usize| {
        let mut from = [0.0; 3];
        from[index] = 1.0;
        let run = end(course(&equation, &from, &[0.0; 3], TAU).tol(1e-13));
        assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 1));
        run.state.as_ref()[index]
    };
    component(0) + component(1)
}

#[test]
fn without_amplitude_mathieu_s_equation_is_an_oscillator() {
    for delta in [0.09_f64, 0.6, 2.0] {
        let expected = 2.0 * (TAU * delta.sqrt()).cos();
        let trace = trace_of_mathieu(delta, 0.0);
        assert!((trace - expected).abs() < 1e-10, "{delta}: {trace}");
    }
}

/// Both bounds of the tongue are given by the series of 28.6(i) in the Digital Library of Mathematical Functions.
#[test]
fn the_first_tongue_of_mathieu_s_equation_lies_between_its_series() {
    for eps in [-0.1_f64, 0.1] {
        let bound = 0.25 + eps / 2.0 - eps * eps / 8.0 - eps.powi(3) / 32.0 - eps.powi(4) / 384.0;
        let trace = trace_of_mathieu(bound, eps);
        assert!((trace + 2.0).abs() < 1e-6, "{eps}: {trace}");
    }
    assert!(trace_of_mathieu(0.25, 0.1) < -2.0);
}

/// Doubling is exact in binary. Heights come to 1/2, from there to 1 and to 0, where they stay.
#[test]
fn heights_of_one_half_stay_in_the_squares() {
    let squares = shipped("tent_map").model();
    let run = end(course(&squares, &[0.0, 0.125], &[0.0; 2], 40.5).tol(1e-10));
    assert_eq!(run.outcome, Outcome::Done);
    let state = run.state.as_ref();
    assert!(state[0] <= 1.0, "{state:?}");
    assert_eq!(state[1], 0.0);
}

#[test]
fn the_return_map_is_the_tent_map() {
    let squares = shipped("tent_map").model();
    let mut y = 0.34;
    let mut log = EventLog::<_, 40>::new();
    let run = course(&squares, &[0.0, y], &[0.0; 2], 40.5)
        .tol(1e-10)
        .observed(Integrator::Dop853, &mut log);
    assert_eq!(run.outcome, Outcome::Done);
    let first = mode_number(&squares, "first");
    for pair in log.iter().collect::<Vec<_>>().chunks(2) {
        y = if y <= 0.5 { 2.0 * y } else { 2.0 * (1.0 - y) };
        assert_eq!(pair[1].after.as_ref()[1], y);
        assert_eq!(squares.mode(&pair[1].after), first);
    }
}
