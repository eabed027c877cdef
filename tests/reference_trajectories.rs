//! Compares impact times with trajectories in closed form or with more than 30 digits.
//!
//! Most cases run with DOP853 at tolerance 1e-13 and with power series at 1e-15. Regular motions (straight lines, the
//! disk on a circular table) keep their accuracy over all impacts. On elliptical tables neighbouring motions separate,
//! so that the same bound applies to the first five impacts only.

use core::ops::ControlFlow;

use dalembert::law::Law;
use dalembert::math::larger;
use dalembert::{
    Described, Event, Instance, Observer, Outcome, Projection, Run, StateVector, System,
    VectorField,
};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, state, vector};
use dalembert_stability::text::{Large, Model, Text, shipped, value};
use dalembert_stability::varied::Varied;
use dalembert_tests::reference::{number, numbers, paired, read};
use serde_json::Value;

type State = <Model as VectorField>::State;

/// Times and surfaces of impacts.
#[derive(Default)]
struct Impacts {
    times: Vec<f64>,
    surfaces: Vec<usize>,
}

impl<Sys: System> Observer<Sys> for Impacts {
    fn event(&mut self, event: &Event<Sys::State>) -> ControlFlow<()> {
        self.times.push(event.t);
        self.surfaces.push(event.surface);
        ControlFlow::Continue(())
    }
}

/// Method of a run: the integrator, the tolerance, and the fixed step if there is one.
type Method = (Integrator, f64, Option<f64>);

/// A run with the same law on every surface, up to a number of impacts.
fn run<S: Varied>(
    system: &S,
    state: S::State,
    law: Law,
    count: usize,
    (integrator, tolerance, step): Method,
) -> (Impacts, Run<S::State>) {
    let mut course = Course::from_state(system, state, 1e6)
        .tol(tolerance)
        .impacts(count as u64);
    for surface in 0..system.description().surfaces.len() {
        course = course.law(surface, law);
    }
    if let Some(step) = step {
        course = course.step(step);
    }
    let mut impacts = Impacts::default();
    let run = course.observed(integrator, &mut impacts);
    (impacts, run)
}

const DOP853: Method = (Integrator::Dop853, 1e-13, None);

const TAYLOR: Method = (Integrator::Taylor, 1e-15, None);

/// Same as [`run`], with each of the accurate integrators. Each run comes with the name of its integrator.
fn runs<S: Varied>(
    system: &S,
    state: S::State,
    law: Law,
    count: usize,
) -> [(&'static str, Impacts, Run<S::State>); 2] {
    [DOP853, TAYLOR].map(|method| {
        let (impacts, end) = run(system, state, law, count, method);
        (method.0.name(), impacts, end)
    })
}

fn law_of(case: &Value) -> Law {
    Law::from_name(case["law"].as_str().expect("a law"), f64::NAN).expect("a known law")
}

/// The impact times of a case.
fn times(case: &Value) -> Vec<f64> {
    case["impacts"]
        .as_array()
        .expect("impacts")
        .iter()
        .map(|impact| number(&impact["t"]))
        .collect()
}

/// Asserts that the first impacts come at their times.
fn assert_times(
    label: &str,
    impacts: &Impacts,
    case: &Value,
    first: usize,
    bound: impl Fn(usize) -> f64,
) {
    let expected = times(case);
    assert!(
        impacts.times.len() >= first.min(expected.len()),
        "{label}: {} impacts",
        impacts.times.len()
    );
    for (k, (actual, expected)) in impacts.times.iter().zip(&expected).take(first).enumerate() {
        let error = (actual - expected).abs();
        assert!(
            error < bound(k),
            "{label}: impact {} at {actual}, not {expected}: {error:.1e}",
            k + 1
        );
    }
}

/// The bound of the regular cases and of the first five impacts of every case.
fn billionth(_: usize) -> f64 {
    1e-9
}

fn disk(case: &Value) -> (Model, State) {
    let axes = ["ta", "tb"].map(|name| (name, number(&case["parameters"][name])));
    let disk = shipped("rolling_disk").with(axes);
    let radius = value(&disk, "R");
    let at = |name: &str| number(&case["initial"][name]);
    let (phi, roll) = (at("phi"), at("theta_dot"));
    let qdot = [
        radius * phi.cos() * roll,
        radius * phi.sin() * roll,
        roll,
        at("phi_dot"),
    ];
    let state = state(&disk, &[at("x"), at("y"), at("theta"), phi], &qdot);
    (disk, state)
}

#[test]
fn the_rolling_disk_meets_its_impacts() {
    for case in read("rolling_disk_trajectories")["cases"]
        .as_array()
        .expect("cases")
    {
        let (disk, state) = disk(case);
        for (method, impacts, _) in runs(&disk, state, law_of(case), 20) {
            let label = format!("{} {} {method}", case["label"], case["law"]);
            let regular = number(&case["parameters"]["ta"]) == number(&case["parameters"]["tb"]);
            match (regular, law_of(case)) {
                (true, Law::Elastic) => assert_times(&label, &impacts, case, 20, billionth),
                (true, _) => assert_grazing_times(&label, &impacts, case),
                (false, _) => assert_times(&label, &impacts, case, 5, billionth),
            }
            for (impact, surface) in case["impacts"]
                .as_array()
                .expect("impacts")
                .iter()
                .zip(&impacts.surfaces)
                .take(5)
            {
                assert_eq!(impact["edge"], disk.description().surfaces[*surface].name);
            }
        }
    }
}

/// The largest error of the times of the first eight impacts of the elastic disk and sleigh on their elliptical tables.
fn errors_at(method: Method) -> f64 {
    let largest = |impacts: &Impacts, case: &Value| {
        assert_eq!(impacts.times.len(), 8);
        let pairs = impacts.times.iter().zip(times(case)).take(8);
        pairs.fold(0.0, |worst: f64, (a, e)| larger(worst, (a - e).abs()))
    };
    let case = &read("rolling_disk_trajectories")["cases"][2];
    let (disk, state) = disk(case);
    let (impacts, _) = run(&disk, state, Law::Elastic, 8, method);
    let of_disk = largest(&impacts, case);
    let case = &read("chaplygin_sleigh_trajectories")["billiard"][0];
    let (sleigh, state) = sleigh_state(case);
    let (impacts, _) = run(&sleigh, state, Law::Elastic, 8, method);
    of_disk.max(largest(&impacts, case))
}

/// Fixed steps that are cut at impacts and restarted after them keep the order of the method. The order is measured
/// above 1e-11, the error of the event location for impacts that are close to each other.
#[test]
fn methods_of_fixed_step_meet_the_impacts_by_their_order() {
    for &integrator in Integrator::every() {
        let (steps, bound) = match integrator {
            Integrator::Rk4 | Integrator::Gauss4 | Integrator::Dla4 => (80.0, 1e-7),
            Integrator::Gauss6 => (20.0, 1e-8),
            Integrator::Dla2 => (200.0, 1e-4),
            _ => {
                assert!(integrator.is_adaptive(), "{integrator:?}");
                continue;
            }
        };
        let at = |h: f64| errors_at((integrator, 1e-9, Some(h)));
        let h = 1.0 / steps;
        let (coarse, fine) = (at(h), at(h / 8.0));
        let slope = (coarse / fine).log2() / 3.0;
        let order = integrator.order().expect("a fixed order") as f64;
        let name = integrator.name();
        println!("{name}: {coarse:.1e}, {fine:.1e}, slope {slope:.2}");
        assert!(fine < bound, "{name}: {fine:e}");
        assert!(slope > order - 0.3, "{name}: {coarse:e}, {fine:e}");
    }
}

/// On the circular table the nonholonomic plastic disk tends to a motion along the rim. The gap rate at an impact is
/// 0.37 times that at the impact before, down to 1e-8. If the gap has the error `eta`, every method finds the time of a
/// crossing with the error `2 eta / |gap rate|`, and may miss crossings less deep than `eta`. Here `eta` is 1e-13, the
/// error of a second of integration at tolerance 1e-13. Without the impact, the gap would fall below zero by the square
/// of the gap rate over twice its second derivative, which is 8. This depth is 4e-13 at the 14th impact, 6e-14 at the
/// 15th and 8e-15 at the 16th. Impacts after the 14th are left out, since rounding errors decide if the disk meets the
/// rim.
fn assert_grazing_times(label: &str, impacts: &Impacts, case: &Value) {
    let rate = |k: usize| number(&case["impacts"][k]["dh_minus"]).abs();
    assert_times(label, impacts, case, 10, billionth);
    assert_times(label, impacts, case, 14, |k| (2e-13 / rate(k)).max(1e-9));
}

/// Tolerances, and errors of the time of impact 20 by a handwritten DOP853 in velocities. The elliptical table
/// amplifies errors.
const BY_HAND: [(f64, f64); 5] = [
    (1e-6, 9.7e-2),
    (1e-8, 5.2e-5),
    (1e-10, 1.0e-6),
    (1e-12, 6.2e-8),
    (1e-14, 6.4e-10),
];

#[test]
fn the_disk_on_the_ellipse_is_no_worse_than_ten_times_a_hand_written_integrator() {
    let file = read("rolling_disk_trajectories");
    let case = &file["cases"][2];
    assert_eq!(
        (case["law"].as_str(), number(&case["parameters"]["ta"])),
        (Some("elastic"), 0.15)
    );
    let (disk, state) = disk(case);
    let expected = times(case)[19];
    for (tol, by_hand) in BY_HAND {
        let (impacts, _) = run(
            &disk,
            state,
            Law::Elastic,
            20,
            (Integrator::Dop853, tol, None),
        );
        let error = (impacts.times[19] - expected).abs();
        println!("tol {tol:e}: impact 20 off by {error:.2e}, by hand {by_hand:.1e}");
        assert!(
            error <= 10.0 * by_hand,
            "tol {tol:e}: {error:e} against {by_hand:e}"
        );
    }
}

fn sleigh_state(case: &Value) -> (Model, State) {
    let sleigh = shipped("chaplygin_sleigh").model();
    let initial = numbers(&case["initial"]);
    let [x, y, theta, v, w] = initial[..] else {
        panic!("five numbers")
    };
    let state = state(
        &sleigh,
        &[x, y, theta],
        &[v * theta.cos(), v * theta.sin(), w],
    );
    (sleigh, state)
}

#[test]
fn the_sleigh_billiard_meets_its_impacts() {
    for case in read("chaplygin_sleigh_trajectories")["billiard"]
        .as_array()
        .expect("cases")
    {
        let (sleigh, state) = sleigh_state(case);
        let count = times(case).len();
        for (method, impacts, run) in runs(&sleigh, state, law_of(case), count) {
            let label = format!("sleigh {} {} {method}", case["law"], case["initial"]);
            assert_times(&label, &impacts, case, 5, billionth);
            let infeasible = case["stopped_because_law_infeasible"]
                .as_bool()
                .expect("a flag");
            let penetrating = matches!(run.outcome, Outcome::StillPenetrating { .. });
            assert_eq!(penetrating, infeasible, "{label}: {}", run.outcome);
        }
    }
}

#[test]
fn the_free_sleigh_passes_its_checkpoints() {
    for case in read("chaplygin_sleigh_trajectories")["free"]
        .as_array()
        .expect("cases")
    {
        let (sleigh, state) = sleigh_state(case);
        for checkpoint in case["checkpoints"].as_array().expect("checkpoints") {
            let t = number(&checkpoint["t"]);
            let run = Course::from_state(&sleigh, state, t)
                .tol(1e-13)
                .alone()
                .observed(Integrator::Dop853, &mut ());
            let expected = numbers(&checkpoint["state"]);
            for (actual, expected) in run.state.as_ref().iter().zip(&expected).take(3) {
                assert!(
                    (actual - expected).abs() < 1e-9,
                    "t = {t}: {actual} for {expected}"
                );
            }
        }
    }
}

#[test]
fn the_rolling_ball_meets_its_impacts() {
    for case in read("rolling_ball_trajectories")["cases"]
        .as_array()
        .expect("cases")
    {
        let ball: Large = shipped("rolling_ball_euler").sized();
        let q = numbers(&case["initial_q"]);
        let [phi_dot, theta_dot, psi_dot] =
            numbers(&case["initial_independent_qdot(phi,theta,psi)"])[..]
        else {
            panic!("three numbers")
        };
        let named = vector(&[0.0, 0.0, 1.0, 1.0, 1.0]);
        let given = vector(&[0.0, 0.0, phi_dot, theta_dot, psi_dot]);
        let qdot = ball
            .complete_velocity(0.0, &vector(&q), &given, &named)
            .expect("velocities");
        let state = state(&ball, &q, qdot.as_ref());
        for (method, impacts, run) in runs(&ball, state, law_of(case), 12) {
            assert_eq!(
                run.outcome,
                Outcome::ImpactBudget,
                "the chart is not left in these cases"
            );
            assert_times(
                &format!("ball {} {method}", case["law"]),
                &impacts,
                case,
                12,
                billionth,
            );
        }
    }
}

#[test]
fn the_point_billiard_meets_its_impacts() {
    for case in read("point_billiard_trajectories")["cases"]
        .as_array()
        .expect("cases")
    {
        let axes = ["ta", "tb"].map(|name| (name, number(&case[name])));
        let table = shipped("point_billiard").with(axes);
        let [x, y, vx, vy] = numbers(&case["initial"])[..] else {
            panic!("four numbers")
        };
        let state = state(&table, &[x, y], &[vx, vy]);
        for (method, impacts, _) in runs(&table, state, Law::Elastic, 25) {
            assert_times(
                &format!("point billiard {} {method}", case["ta"]),
                &impacts,
                case,
                25,
                billionth,
            );
        }
    }
}

#[test]
fn the_bouncing_ball_meets_its_impacts() {
    for case in read("bouncing_ball_trajectories")["cases"]
        .as_array()
        .expect("cases")
    {
        let values = ["m", "g"].map(|name| (name, number(&case[name])));
        let ball = shipped("bouncing_ball").with(values);
        let (x0, v0, e) = (number(&case["x0"]), number(&case["v0"]), number(&case["e"]));
        let state = state(&ball, &[x0], &[v0]);
        let count = times(case).len();
        for (method, impacts, run) in runs(&ball, state, Law::Restitution(e), count) {
            assert_times(
                &format!("ball e = {e} {method}"),
                &impacts,
                case,
                count,
                billionth,
            );
            assert_eq!(run.outcome, Outcome::ImpactBudget);
        }
    }
}

/// The largest error of the times of the first eight impacts of the elastic sleigh billiards, at each tolerance.
fn ladder(tolerances: &[f64], integrator: Integrator) -> Vec<f64> {
    let file = read("chaplygin_sleigh_trajectories");
    let worst = |tol: f64| {
        let cases = [&file["billiard"][0], &file["billiard"][2]];
        let errors = cases.into_iter().flat_map(|case| {
            let (sleigh, state) = sleigh_state(case);
            let (impacts, _) = run(&sleigh, state, Law::Elastic, 8, (integrator, tol, None));
            let expected = times(case);
            assert_eq!(impacts.times.len(), 8, "{integrator:?}, {tol:e}");
            impacts
                .times
                .into_iter()
                .zip(expected)
                .map(|(a, e)| (a - e).abs())
                .collect::<Vec<_>>()
        });
        errors.fold(0.0, larger)
    };
    tolerances.iter().map(|&tol| worst(tol)).collect()
}

/// The slope of the logarithm of the error over that of the tolerance, by least squares.
fn slope(tolerances: &[f64], errors: &[f64]) -> f64 {
    let points: Vec<(f64, f64)> = tolerances
        .iter()
        .zip(errors)
        .map(|(t, e)| (t.log10(), e.log10()))
        .collect();
    let n = points.len() as f64;
    let (mx, my) = (
        points.iter().map(|p| p.0).sum::<f64>() / n,
        points.iter().map(|p| p.1).sum::<f64>() / n,
    );
    points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum::<f64>()
        / points.iter().map(|p| (p.0 - mx).powi(2)).sum::<f64>()
}

/// For a method of order p with error control per step and an error estimate of order q, the global error falls like
/// tol^(p/(q + 1)). The exponent is 8/8 for DOP853 and 5/5 for Dormand-Prince 5(4). Power series change their order
/// with the tolerance; their exponent is about 1.
#[test]
fn errors_fall_with_the_tolerance() {
    let tolerances = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11];
    let adaptive = Integrator::every()
        .iter()
        .filter(|integrator| integrator.is_adaptive());
    for &integrator in adaptive {
        let (name, errors) = (integrator.name(), ladder(&tolerances, integrator));
        let slope = slope(&tolerances, &errors);
        println!("{name}: {errors:?}, slope {slope:.2}");
        assert!(
            (0.75..1.35).contains(&slope),
            "{name}: slope {slope}, {errors:?}"
        );
    }
}

/// Compares the motion of a system without its surfaces with every checkpoint of a reference file.
fn check_free_runs(source: &'static str, bound: f64) {
    let system = Text::new(source).model();
    let name = system.description().name;
    let file = read(name);
    let runs = file["free_runs"].as_array().cloned();
    let runs = runs.unwrap_or_else(|| vec![file["free_run"].clone()]);
    for run in &runs {
        let given = |key: &str| vector(&numbers(&run[key]));
        let t0 = run.get("t_initial").map_or(0.0, number);
        let state = system
            .state(t0, &given("q_initial"), &given("qdot_initial"))
            .expect("a state");
        for checkpoint in run["checkpoints"].as_array().expect("checkpoints") {
            let t = number(&checkpoint["t"]);
            for (integrator, tolerance, _) in [DOP853, TAYLOR] {
                let end = Course::from_state(&system, state, t)
                    .at(t0)
                    .tol(tolerance)
                    .effects((Some(Projection::new()), None, None))
                    .observed(integrator, &mut ());
                assert_eq!(end.outcome, Outcome::Done, "{name}");
                let qdot = system.velocity(t, &end.state).expect("a velocity");
                let q = system.position(&end.state);
                for (key, actual) in [("q", q), ("qdot", qdot)] {
                    for (a, e) in paired(actual.as_slice(), &checkpoint[key]) {
                        let error = (a - e).abs() / e.abs().max(1.0);
                        assert!(
                            error < bound,
                            "{name} at t = {t}: {key} {a} for {e}, {error:.1e}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn free_motions_pass_their_checkpoints() {
    use dalembert_tests::systems::{
        AffineSleigh, DampedSleigh, IntegrableBead, MagneticDisk, Rheonomic,
    };
    check_free_runs(AffineSleigh::DESCRIPTION.source.value(), 1e-10);
    check_free_runs(MagneticDisk::DESCRIPTION.source.value(), 1e-10);
    check_free_runs(DampedSleigh::DESCRIPTION.source.value(), 1e-10);
    check_free_runs(Rheonomic::DESCRIPTION.source.value(), 1e-10);
    check_free_runs(IntegrableBead::DESCRIPTION.source.value(), 1e-8);
}
