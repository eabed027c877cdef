//! Impact times against trajectories computed in closed form or with more than 30 digits.
//!
//! Every case runs with DOP853 at tolerance 1e-13 and with power series at 1e-15. Regular motions (straight lines, the disk on a circular table) keep their
//! accuracy over all impacts; on elliptical tables neighbouring motions separate, so only the first five are held to
//! the same bound.

use core::ops::ControlFlow;

use dalembert::law::Law;
use dalembert::{
    Constrained, Described, Dla2, Dla4, Dop853, DormandPrince5, Event, Gauss4, Gauss6, Impacting,
    Observer, Outcome, Projection, Rk4, Run, Scene, SceneEffects, Simulation, Stepper, System,
    Taylor, TaylorField, Tolerance,
};
use dalembert_models::{
    BouncingBall, ChaplyginSleigh, PointBilliard, RollingBallEuler, RollingDisk,
};
use dalembert_tests::reference::{number, numbers, read};
use serde_json::Value;

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

/// A run with a law on every surface, up to a number of impacts.
fn run<S, Step>(
    system: &S,
    state: S::State,
    law: Law,
    count: usize,
    stepper: Step,
) -> (Impacts, Run<S::State>)
where
    S: Described + Impacting + Scene,
    Step: Stepper<S>,
{
    let mut effects = system.effects();
    for surface in 0..S::DESCRIPTION.surfaces.len() {
        effects.set_law(surface, law);
    }
    effects.set_impact_budget(Some(count as u64));
    let mut impacts = Impacts::default();
    let run = Simulation::new(system, stepper, effects)
        .run(0.0, state, 1e6, &mut impacts)
        .expect("a start");
    (impacts, run)
}

fn dop853<S: dalembert::StateVector>(tol: f64) -> Dop853<S> {
    Dop853::new(Tolerance::new(tol).expect("a tolerance"))
}

fn taylor<S: TaylorField>(tol: f64) -> Taylor<S> {
    Taylor::new(Tolerance::new(tol).expect("a tolerance"))
}

/// The run of [`run`] with each of the accurate integrators, by name.
fn runs<S>(
    system: &S,
    state: S::State,
    law: Law,
    count: usize,
) -> [(&'static str, Impacts, Run<S::State>); 2]
where
    S: Described + Impacting + Scene + TaylorField,
{
    let (first, first_run) = run(system, state, law, count, dop853(1e-13));
    let (second, second_run) = run(system, state, law, count, taylor(1e-15));
    [("dop853", first, first_run), ("taylor", second, second_run)]
}

fn law_of(case: &Value) -> Law {
    Law::from_name(case["law"].as_str().expect("a law"), f64::NAN).expect("a known law")
}

/// The times of a case.
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

fn disk(case: &Value) -> (RollingDisk, <RollingDisk as dalembert::VectorField>::State) {
    let mut disk = RollingDisk::default();
    (disk.ta, disk.tb) = (
        number(&case["parameters"]["ta"]),
        number(&case["parameters"]["tb"]),
    );
    let at = |name: &str| number(&case["initial"][name]);
    let (phi, roll) = (at("phi"), at("theta_dot"));
    let qdot = [
        disk.R * phi.cos() * roll,
        disk.R * phi.sin() * roll,
        roll,
        at("phi_dot"),
    ];
    let state = disk
        .state(
            0.0,
            &[at("x"), at("y"), at("theta"), phi].into(),
            &qdot.into(),
        )
        .expect("a state");
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
                assert_eq!(
                    impact["edge"],
                    RollingDisk::DESCRIPTION.surfaces[*surface].name
                );
            }
        }
    }
}

/// The largest error of the first eight impacts of the elastic disk and sleigh on their elliptical tables, at a step.
fn errors_at<Disk: Stepper<RollingDisk>, Sleigh: Stepper<ChaplyginSleigh>>(
    disk_stepper: Disk,
    sleigh_stepper: Sleigh,
) -> f64 {
    let largest = |impacts: &Impacts, case: &Value| {
        let pairs = impacts.times.iter().zip(times(case)).take(8);
        pairs.fold(0.0, |worst: f64, (a, e)| worst.max((a - e).abs()))
    };
    let case = &read("rolling_disk_trajectories")["cases"][2];
    let (disk, state) = disk(case);
    let (impacts, _) = run(&disk, state, Law::Elastic, 8, disk_stepper);
    let of_disk = largest(&impacts, case);
    let case = &read("chaplygin_sleigh_trajectories")["billiard"][0];
    let (sleigh, state) = sleigh_state(case);
    let (impacts, _) = run(&sleigh, state, Law::Elastic, 8, sleigh_stepper);
    of_disk.max(largest(&impacts, case))
}

/// Steps of fixed size, cut at impacts and begun anew after them, keep the order of the method; measured above 1e-11,
/// the errors of locating impacts that lie close to each other.
#[test]
fn methods_of_fixed_step_meet_the_impacts_by_their_order() {
    macro_rules! check {
        ($($method:ident $steps:literal $bound:literal)*) => {$(
            let tolerance = Tolerance::new(1e-9).expect("a tolerance");
            let at = |h: f64| {
                let (first, second) = ($method::new(tolerance), $method::new(tolerance));
                errors_at(first.with_step(h), second.with_step(h))
            };
            let h = 1.0 / f64::from($steps);
            let (coarse, fine) = (at(h), at(h / 8.0));
            let slope = (coarse / fine).log2() / 3.0;
            let order = $method::<<ChaplyginSleigh as dalembert::VectorField>::State>::ORDER as f64;
            let name = Stepper::<ChaplyginSleigh>::name(&$method::new(tolerance));
            println!("{name}: {coarse:.1e}, {fine:.1e}, slope {slope:.2}");
            assert!(fine < $bound, "{name}: {fine:e}");
            assert!(slope > order - 0.3, "{name}: {coarse:e}, {fine:e}");
        )*};
    }
    check!(Rk4 80 1e-7 Gauss4 80 1e-7 Gauss6 20 1e-8 Dla2 200 1e-4 Dla4 80 1e-7);
}

/// On the circular table the nonholonomic plastic disk settles into running along the rim: the gap rate at impact
/// falls by 0.37 from one impact to the next, down to 1e-8. A gap known to `eta` gives the time of a crossing to
/// `2 eta / |gap rate|` and no better, whatever the method, and shows no crossing that goes less deep than `eta`; here that
/// is 1e-13, the error of a second of integration at tolerance 1e-13. At the 14th impact the gap would fall 4e-13 below zero,
/// at the 15th 6e-14, at the 16th 8e-15 (gap rate squared over twice its change, 8 a second): those after the 14th are
/// left out, a rounding decides whether the rim is met at all.
fn assert_grazing_times(label: &str, impacts: &Impacts, case: &Value) {
    let rate = |k: usize| number(&case["impacts"][k]["dh_minus"]).abs();
    assert_times(label, impacts, case, 10, billionth);
    assert_times(label, impacts, case, 14, |k| (2e-13 / rate(k)).max(1e-9));
}

/// The elliptical table amplifies errors; a hand-written DOP853 in velocities reaches these errors at impact 20.
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
        let (impacts, _) = run(&disk, state, Law::Elastic, 20, dop853(tol));
        let error = (impacts.times[19] - expected).abs();
        println!("tol {tol:e}: impact 20 off by {error:.2e}, by hand {by_hand:.1e}");
        assert!(
            error <= 10.0 * by_hand,
            "tol {tol:e}: {error:e} against {by_hand:e}"
        );
    }
}

fn sleigh_state(
    case: &Value,
) -> (
    ChaplyginSleigh,
    <ChaplyginSleigh as dalembert::VectorField>::State,
) {
    let sleigh = ChaplyginSleigh::default();
    let initial = numbers(&case["initial"]);
    let [x, y, theta, v, w] = initial[..] else {
        panic!("five numbers")
    };
    let qdot = [v * theta.cos(), v * theta.sin(), w];
    let state = sleigh
        .state(0.0, &[x, y, theta].into(), &qdot.into())
        .expect("a state");
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
            let run = Simulation::new(&sleigh, dop853(1e-13), ())
                .run(0.0, state, t, &mut ())
                .expect("a start");
            let expected = numbers(&checkpoint["state"]);
            for (actual, expected) in run.state.iter().zip(&expected).take(3) {
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
        let ball = RollingBallEuler::default();
        let q: [f64; 5] = numbers(&case["initial_q"]).try_into().expect("five");
        let [phi_dot, theta_dot, psi_dot] =
            numbers(&case["initial_independent_qdot(phi,theta,psi)"])[..]
        else {
            panic!("three numbers")
        };
        let named = [0.0, 0.0, 1.0, 1.0, 1.0].into();
        let given = [0.0, 0.0, phi_dot, theta_dot, psi_dot].into();
        let qdot = ball
            .complete_velocity(0.0, &q.into(), &given, &named)
            .expect("velocities");
        let state = ball.state(0.0, &q.into(), &qdot).expect("a state");
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
        let table = PointBilliard {
            ta: number(&case["ta"]),
            tb: number(&case["tb"]),
            ..PointBilliard::default()
        };
        let [x, y, vx, vy] = numbers(&case["initial"])[..] else {
            panic!("four numbers")
        };
        let state = table
            .state(0.0, &[x, y].into(), &[vx, vy].into())
            .expect("a state");
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
        let ball = BouncingBall {
            m: number(&case["m"]),
            g: number(&case["g"]),
        };
        let (x0, v0, e) = (number(&case["x0"]), number(&case["v0"]), number(&case["e"]));
        let state = ball
            .state(0.0, &[x0].into(), &[v0].into())
            .expect("a state");
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

/// The largest errors of the first eight impacts of the elastic sleigh billiards over a ladder of tolerances.
fn ladder<Step>(tolerances: &[f64], stepper: impl Fn(f64) -> Step) -> Vec<f64>
where
    Step: Stepper<ChaplyginSleigh>,
{
    let file = read("chaplygin_sleigh_trajectories");
    let worst = |tol: f64| {
        let cases = [&file["billiard"][0], &file["billiard"][2]];
        let errors = cases.into_iter().flat_map(|case| {
            let (sleigh, state) = sleigh_state(case);
            let (impacts, _) = run(&sleigh, state, Law::Elastic, 8, stepper(tol));
            let expected = times(case);
            impacts
                .times
                .into_iter()
                .zip(expected)
                .map(|(a, e)| (a - e).abs())
                .collect::<Vec<_>>()
        });
        errors.fold(0.0, f64::max)
    };
    tolerances.iter().map(|&tol| worst(tol)).collect()
}

/// The slope of log error over log tolerance, by least squares.
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

/// With error control per step an error estimate of order q makes the global error fall like tol^(p/(q + 1)): 8/8
/// for DOP853, 5/5 for Dormand-Prince 5(4). Power series change their order with the tolerance: 1 up to its rounding.
#[test]
fn errors_fall_with_the_tolerance() {
    let tolerances = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11];
    let high = ladder(&tolerances, dop853);
    let low = ladder(&tolerances, |tol| {
        DormandPrince5::new(Tolerance::new(tol).expect("a tolerance"))
    });
    let series = ladder(&tolerances, taylor);
    for (name, errors) in [("dop853", high), ("dopri5", low), ("taylor", series)] {
        let slope = slope(&tolerances, &errors);
        println!("{name}: {errors:?}, slope {slope:.2}");
        assert!(
            (0.75..1.35).contains(&slope),
            "{name}: slope {slope}, {errors:?}"
        );
    }
}

/// Free motion (surfaces left out) of a system from a reference file, against every checkpoint.
fn check_free_runs<S: Described + Constrained + TaylorField>(system: &S, bound: f64) {
    let file = read(S::DESCRIPTION.name);
    let runs = file["free_runs"].as_array().cloned();
    let runs = runs.unwrap_or_else(|| vec![file["free_run"].clone()]);
    for run in &runs {
        let vector = |key: &str| <S::Vector as dalembert::StateVector>::of(&numbers(&run[key]));
        let t0 = run.get("t_initial").map_or(0.0, number);
        let state = system
            .state(t0, &vector("q_initial"), &vector("qdot_initial"))
            .expect("a state");
        for checkpoint in run["checkpoints"].as_array().expect("checkpoints") {
            let t = number(&checkpoint["t"]);
            let projection = || (Projection::<S>::new(),);
            let mut high = Simulation::new(system, dop853(1e-13), projection());
            let mut series = Simulation::new(system, taylor(1e-15), projection());
            let ends = [
                high.run(t0, state, t, &mut ()),
                series.run(t0, state, t, &mut ()),
            ];
            for end in ends {
                let end = end.expect("a start");
                assert_eq!(end.outcome, Outcome::Done, "{}", S::DESCRIPTION.name);
                let qdot = system.velocity(t, &end.state).expect("a velocity");
                let q = system.position(&end.state);
                for (key, actual) in [("q", q), ("qdot", qdot)] {
                    let pairs = dalembert::StateVector::as_slice(&actual)
                        .iter()
                        .zip(numbers(&checkpoint[key]));
                    for (a, e) in pairs {
                        let error = (a - e).abs() / e.abs().max(1.0);
                        assert!(
                            error < bound,
                            "{} at t = {t}: {key} {a} for {e}, {error:.1e}",
                            S::DESCRIPTION.name
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
    check_free_runs(&AffineSleigh::default(), 1e-10);
    check_free_runs(&MagneticDisk::default(), 1e-10);
    check_free_runs(&DampedSleigh::default(), 1e-10);
    check_free_runs(&Rheonomic::default(), 1e-10);
    check_free_runs(&IntegrableBead::default(), 1e-8);
}
