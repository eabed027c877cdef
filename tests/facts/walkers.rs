//! Walkers: one whose foot slips (in two systems of units), the simplest walker, and one on spring legs.

use dalembert::{EventLog, Fault, Outcome, System, VectorField};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, declared, vector};
use dalembert_stability::text::{Model, shipped, value};

use super::{course, end};

#[test]
fn a_step_repeats_itself() {
    let walker = shipped("dimensionless_walker").model();
    let delta = value(&walker, "delta");
    let start = [delta, -0.902_057_449_429_909_7, 0.991_308_369_223_558_5];
    // The state at the time `late` after the start equals the state at the time `late` after the step.
    let late = 0.01;
    let [once, again] = [late, 1.544_965_864_061_404 + late]
        .map(|until| end(course(&walker, &start, &[0.0; 3], until).tol(1e-13)));
    assert_eq!([once.counters.impacts, again.counters.impacts], [0, 1]);
    let (once, again) = (once.state.as_ref(), again.state.as_ref());
    assert_eq!([once.len(), again.len()], [3, 3]);
    for (one, other) in once.iter().zip(again) {
        assert!((one - other).abs() < 1e-12, "{once:?} and {again:?}");
    }
}

/// The derivative of the field at a state by central differences, by rows.
fn slopes(walker: &Model, at: [f64; 3]) -> [[f64; 3]; 3] {
    const STEP: f64 = 1e-5;
    let rate = |at: [f64; 3]| {
        let mut rate = vector(&[0.0; 3]);
        walker.rate(0.0, &vector(&at), &mut rate).expect("a rate");
        [0, 1, 2].map(|i| rate.as_ref()[i])
    };
    let columns = [0, 1, 2].map(|j| {
        let moved = |step: f64| {
            let mut moved = at;
            moved[j] += step;
            rate(moved)
        };
        let (up, down) = (moved(STEP), moved(-STEP));
        [0, 1, 2].map(|i| (up[i] - down[i]) / (2.0 * STEP))
    });
    [0, 1, 2].map(|i| columns.map(|column| column[i]))
}

/// In W. Clark's thesis, the stable plane of the upright walker separates starts that walk from starts that fall.
#[test]
fn the_upright_walker_is_a_saddle_whose_plane_is_the_line_of_the_figure() {
    let walker = shipped("dimensionless_walker").model();
    let alpha = value(&walker, "alpha");
    let slopes = slopes(&walker, [alpha, 0.0, alpha.sin()]);
    let determinant = |l: f64| {
        let m = |i: usize, j: usize| slopes[i][j] - if i == j { l } else { 0.0 };
        let minor = |a: usize, b: usize| m(1, a) * m(2, b) - m(1, b) * m(2, a);
        m(0, 0) * minor(1, 2) - m(0, 1) * minor(0, 2) + m(0, 2) * minor(0, 1)
    };
    for eigenvalue in [0.688_755, -2.747_673, -0.478_938] {
        let (below, above) = (
            determinant(eigenvalue - 1e-6),
            determinant(eigenvalue + 1e-6),
        );
        assert!(below * above < 0.0, "{eigenvalue}: {below:e}, {above:e}");
    }
    // The normal of the plane is the left eigenvector of the first eigenvalue, scaled to 1 in the rate of the leg.
    let normal = [slopes[1][0] / 0.688_755, 1.0, -0.988_692];
    for j in 0..3 {
        let image: f64 = (0..3).map(|i| normal[i] * slopes[i][j]).sum();
        let missed = image - 0.688_755 * normal[j];
        assert!(missed.abs() < 1e-5, "component {j}: {missed:e}");
    }
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
    // The units are `t0 = m/b` for time, `v0 = m g/b` for velocity and `v0/lf` for angular velocity. The parameter is
    // `eps = v0 t0/lf`.
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

/// The gait on a slope of 0.009, from M. Wisse and A. L. Schwab, *First steps in passive dynamic walking* (2005).
#[test]
fn the_simplest_walker_repeats_its_step() {
    let walker = shipped("compass_walker").model();
    let (theta, omega): (f64, f64) = (0.200_310_900_544_287, -0.199_832_473_004_977);
    let psi = (1.0 - (2.0 * theta).cos()) * omega;
    let start = vector(&[theta, 2.0 * theta, omega, psi]);
    // The run ends shortly after the step.
    let run = end(Course::from_state(&walker, start, 3.8825).tol(1e-13));
    assert_eq!(run.counters.impacts, 1);
    let late = run.t - 3.882_463_752_85;
    let state = run.state.as_ref();
    assert!((state[0] - late * omega - theta).abs() < 1e-8, "{state:?}");
    assert!(
        (state[2] - late * (theta - 0.009).sin() - omega).abs() < 1e-8,
        "{state:?}"
    );
    assert!(
        (state[1] - late * psi - 2.0 * theta).abs() < 1e-8,
        "{state:?}"
    );
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
