//! Walkers: a foot that slips, in two systems of units, and legs that are springs.

use dalembert::{EventLog, Fault, Outcome, System};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, declared, vector};
use dalembert_stability::text::{shipped, value};

use super::{course, end};

#[test]
fn a_step_repeats_itself() {
    let walker = shipped("dimensionless_walker").model();
    let delta = value(&walker, "delta");
    let start = [delta, -0.902_057_449_429_909_7, 0.991_308_369_223_558_5];
    // A little after the step.
    let run = end(course(&walker, &start, &[0.0; 3], 1.544_965_864_061_404).tol(1e-13));
    assert!(run.counters.impacts <= 1);
    let side = if run.counters.impacts == 0 { 1.0 } else { -1.0 };
    let angle = run.state.as_ref()[0] + delta * side;
    assert!(angle.abs() < 1e-12);
}

#[test]
fn is_the_dimensionless_walker_in_other_units() -> Result<(), Fault> {
    let [m, inertia, lf, b, g, alpha, delta] = [2.0, 0.2, 0.5, 4.0, 1.0, 0.4, 0.4];
    let walker = shipped("walker_foot_slip").with([
        ("m", m),
        ("I", inertia),
        ("lf", lf),
        ("b", b),
        ("g", g),
        ("alpha", alpha),
        ("delta", delta),
    ]);
    // Units of time `t0 = m/b`, of velocity `v0 = m g/b` and of the rate `v0/lf`: `eps = v0 t0/lf`.
    let (t0, v0) = (m / b, m * g / b);
    let other = shipped("dimensionless_walker").with([
        ("mu", m * lf * lf / inertia),
        ("eps", v0 * t0 / lf),
        ("alpha", alpha),
        ("delta", delta),
    ]);
    let (xi, eta, until) = (-1.0, 1.0, 6.0);
    let rates = [v0 * eta, v0 / lf * xi];
    let run = end(course(&walker, &[0.0, delta], &rates, until * t0));
    let qdot = walker.velocity(run.t, &run.state)?;
    let [x_dot, theta_dot] = [qdot.as_ref()[0], qdot.as_ref()[1]];
    let start = vector(&[delta, xi, eta]);
    let scaled = end(Course::from_state(&other, start, until));
    assert_eq!(run.counters.impacts, scaled.counters.impacts);
    assert!(run.counters.impacts >= 2);
    let in_its_units = [run.state.as_ref()[1], theta_dot * lf / v0, x_dot / v0];
    for (one, other) in in_its_units.iter().zip(scaled.state.as_ref()) {
        assert!((one - other).abs() < 1e-9, "{one} and {other}");
    }
    Ok(())
}

#[test]
fn it_walks_and_keeps_its_energy() -> Result<(), Fault> {
    let walker = shipped("spring_mass_walker").large([]);
    let start = declared(&walker);
    let energy = walker.energy(0.0, &start)?;
    let mut changes = EventLog::<_, 32>::new();
    let run = Course::from_state(&walker, start, 8.0).observed(Integrator::Dop853, &mut changes);
    assert_eq!(run.outcome, Outcome::Done);
    assert!(changes.iter().count() >= 4);
    for (n, event) in changes.iter().enumerate() {
        assert_eq!(walker.mode(&event.after), 1 - n % 2);
        let after = walker.energy(event.t, &event.after)?;
        assert!((after - energy).abs() < 1e-11, "{after} is not {energy}");
    }
    Ok(())
}
