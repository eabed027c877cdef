//! Runs in more than double precision: comparison with closed forms and digits of other programs, and ends of runs.

use core::ops::ControlFlow;

use dalembert::contract::Variational;
use dalembert::extended::{At, Extended, ExtendedRun, ExtendedSimulation, Impact};
use dalembert::law::Law;
use dalembert::numbers::Numbers;
use dalembert::{
    Outcome, Policies, Rest, Scene, SceneEffects, StateError, StateVector, System, Undefined,
};
use dalembert_stability::tables::Sinai;

dalembert::model! {
    /// A pendulum and a point in a common potential, with constants that are not doubles and many functions.
    pub Magnet {
        coordinates { a: angle; x; }
        parameters { g > 0 = 9.81; }
        lagrangian = dot(a)^2/6 + dot(x)^2/2 + g/10*cos(a) - (1 + x^2)^(1/3) - exp(x/7)/3 + sin(x - a)*atan(x)/5
            - pi*x^2/9 + ln(2 + cos(a))/3 - tanh(sin(a)/3)*sinh(x/10);
    }
}

dalembert::model! {
    /// A point on a spring between a floor with restitution 2/3 and an oscillating wall.
    pub Swing {
        coordinates { x; }
        parameters { w = 1; }
        lagrangian = dot(x)^2/2 - x^2/2;
        impacts { floor: x >= -1/3 => newton(2/3); wall: x <= 1 + w*sin(t)/10; }
    }
}

dalembert::model! {
    /// A point under a force with a kink.
    pub Kinked {
        coordinates { x; }
        lagrangian = dot(x)^2/2;
        forces { pull: -(x + abs(x)/3)*d(x); }
    }
}

dalembert::model! {
    /// A ball that bounces off a floor without losses.
    pub Elastic {
        coordinates { x; }
        lagrangian = dot(x)^2/2 - x;
        impacts { floor: x >= 0; }
    }
}

fn start<Sys: System>(system: &Sys, q: &[f64], v: &[f64]) -> Result<Sys::State, StateError> {
    let vector = |values: &[f64]| Sys::Vector::of(values);
    system.state(0.0, &vector(q), &vector(v))
}

/// A run with the declared effects, and the impacts of the run.
fn run<Sys, const P: usize>(
    system: &Sys,
    [q, v]: [&[f64]; 2],
    t_end: f64,
) -> (ExtendedRun<Sys, P>, Vec<Impact<Sys, P>>)
where
    Sys: Scene + Variational,
{
    let state = start(system, q, v).expect("a state");
    let mut impacts = Vec::new();
    let run = ExtendedSimulation::new(system, system.effects())
        .with_step_budget(20_000)
        .run(At::of(0.0, &state), t_end, |impact| {
            impacts.push(*impact);
            ControlFlow::Continue(())
        })
        .expect("a start");
    (run, impacts)
}

fn decimal<const P: usize>(text: &str) -> Extended<P> {
    text.parse().expect("a decimal number")
}

fn assert_near<const P: usize>(name: &str, found: Extended<P>, expected: Extended<P>, bound: f64) {
    let error = (found - expected).nearest().abs();
    assert!(
        error <= bound,
        "{name}: {found}, not {expected}: {error:e} of {bound:e}"
    );
}

/// The energy of `Magnet` in extended numbers.
fn energy<const P: usize>(state: &[Extended<P>]) -> Extended<P> {
    let [a, x, p, y]: [Extended<P>; 4] = state.try_into().expect("a state");
    let of = Extended::<P>::from;
    let third = of(1.0) / of(3.0);
    let g = of(9.81) / of(10.0);
    let pi = Extended::constant(dalembert::numbers::PI);
    let kinetic = p * p * of(1.5) + y * y / of(2.0);
    let root = Numbers::exp(third * Numbers::ln(of(1.0) + x * x));
    let swing = Numbers::sin(x - a) * Numbers::atan(x) / of(5.0);
    let depth = Numbers::ln(of(2.0) + Numbers::cos(a)) * third;
    let pull = Numbers::tanh(Numbers::sin(a) * third) * Numbers::sinh(x / of(10.0));
    kinetic - g * Numbers::cos(a) + root + third * Numbers::exp(x / of(7.0)) - swing
        + pi * x * x / of(9.0)
        - depth
        + pull
}

fn check_energy<const P: usize>(bound: f64) {
    let system = Magnet { g: 9.81 };
    let begun = At::<Magnet, P>::of(
        0.0,
        &start(&system, &[2.0, 0.3], &[0.5, -0.2]).expect("a state"),
    );
    let (run, _) = run::<_, P>(&system, [&[2.0, 0.3], &[0.5, -0.2]], 1.0);
    assert_eq!(run.outcome, Ok(Outcome::Done));
    assert_eq!(run.end.t, Extended::from(1.0));
    let [before, after] = [&begun, &run.end].map(|at| energy(at.state.as_slice()));
    assert_near("energy", after, before, bound);
}

#[test]
fn the_energy_stays_to_the_last_digits() {
    check_energy::<1>(1e-14);
    check_energy::<2>(1e-29);
    check_energy::<3>(1e-45);
    check_energy::<4>(1e-60);
}

#[test]
fn fewer_parts_are_as_far_off_as_their_rounding() {
    let system = Magnet { g: 9.81 };
    let at: [&[f64]; 2] = [&[2.0, 0.3], &[0.5, -0.2]];
    let truth = run::<_, 4>(&system, at, 1.0).0.end.state;
    let two = run::<_, 2>(&system, at, 1.0).0.end.state;
    let three = run::<_, 3>(&system, at, 1.0).0.end.state;
    for i in 0..4 {
        let of_two =
            truth[i] - Extended::of_parts([two[i].parts()[0], two[i].parts()[1], 0.0, 0.0]);
        let [a, b, c] = three[i].parts();
        let of_three = truth[i] - Extended::of_parts([a, b, c, 0.0]);
        let sizes = [of_two, of_three].map(|error| error.nearest().abs());
        assert!(sizes[0] > 1e-36 && sizes[0] < 1e-29, "{sizes:?}");
        assert!(sizes[1] > 1e-52 && sizes[1] < 1e-45, "{sizes:?}");
    }
}

/// Number, time and position of bounces, computed by `mpmath` 1.3 with 200 digits from the doubles of the start.
#[rustfmt::skip]
const SINAI: &[(usize, &str, &str, &str)] = &[
    (1, "0.50000000000000009251858538542971512584476236", "1.0", "0.50000000000000010177044392397268971991714962"),
    (3, "1.8101020514433643380323938957502360112411604", "0.21393876913398148178182413622917313816326586", "0.45191835884530844363829078292792223296352265"),
    (10, "9.4154297861657950813719234973828677077641492", "-0.17626130966418601468860368215374047864732921", "-1.0"),
    (20, "17.885708026778517096504259508227972427405906", "1.0", "0.37622075411757706234411247681614033992909344"),
    (30, "30.31508031197768120036706356907030426267951", "-1.0", "0.93659742741457842058135342775251294367584829"),
    (45, "49.99523587280018213849828891510248102033961", "-0.27863651384183567348392330728939811662634275", "1.0"),
];

/// Bounces of a point in a square around a disk of radius 1/2.
#[test]
fn bounces_of_a_sinai_billiard_are_those_of_a_run_with_200_digits() {
    let (end, impacts) = run::<_, 3>(&Sinai {}, [&[0.7, 0.1], &[0.6, 0.8]], 51.0);
    assert_eq!(end.outcome, Ok(Outcome::Done));
    for (number, t, x, y) in SINAI {
        let impact = &impacts[number - 1];
        // An error of 1e-47 may grow by a factor 6 in every bounce. The bound is at least 1e-36.
        let bound = 1e-36_f64.max(1e-47 * 6.0_f64.powf(*number as f64));
        assert_near("time", impact.t, decimal(t), bound);
        assert_near("x", impact.before[0], decimal(x), bound);
        assert_near("y", impact.before[1], decimal(y), bound);
    }
}

#[test]
fn a_law_with_a_constant_acts_with_all_digits() {
    let (end, impacts) = run::<_, 4>(&Swing { w: 0.0 }, [&[0.5], &[0.0]], 20.0);
    assert_eq!(end.outcome, Ok(Outcome::Done));
    assert!(impacts.len() >= 3);
    let of = Extended::<4>::from;
    let third = of(1.0) / of(3.0);
    // The first time at which cos(t)/2 is -1/3.
    let mut t = Numbers::acos(of(-2.0) * third);
    let mut speed = Numbers::sqrt(of(0.25) - third * third);
    for impact in &impacts {
        assert_eq!(impact.surface, 0);
        assert_near("time", impact.t, t, 1e-60);
        assert_near("place", impact.before[0], -third, 1e-62);
        assert_near("before", impact.before[1], -speed, 1e-60);
        speed = of(2.0) * third * speed;
        assert_near("after", impact.after[1], speed, 1e-60);
        // Until the next impact the phase turns by twice the angle to the largest displacement.
        t = t + of(2.0) * Numbers::atan2(speed, -third);
    }
}

#[test]
fn a_wall_that_moves_is_met_at_its_time() {
    let (end, impacts) = run::<_, 3>(&Swing { w: 1.0 }, [&[0.0], &[3.0]], 1.0);
    assert_eq!(end.outcome, Ok(Outcome::Done));
    let impact = &impacts[0];
    assert_eq!((impact.surface, impact.law), (1, Law::Elastic));
    let of = Extended::<3>::from;
    // The motion 3 sin(t) meets the wall 1 + sin(t)/10.
    let sine = of(1.0) / (of(3.0) - of(1.0) / of(10.0));
    assert_near("time", impact.t, Numbers::asin(sine), 1e-45);
    let cosine = Numbers::sqrt(of(1.0) - sine * sine);
    // The elastic law reverses the velocity relative to the wall.
    let before = of(3.0) * cosine;
    assert_near("before", impact.before[1], before, 1e-45);
    let wall = cosine / of(10.0);
    assert_near("after", impact.after[1], wall + wall - before, 1e-45);
}

#[test]
fn a_run_goes_on_from_its_end() {
    let table = Sinai {};
    let at: [&[f64]; 2] = [&[0.7, 0.1], &[0.6, 0.8]];
    let (whole, _) = run::<_, 3>(&table, at, 12.0);
    let (half, _) = run::<_, 3>(&table, at, 5.5);
    let rest = ExtendedSimulation::new(&table, table.effects())
        .run(half.end, 12.0, |_| ControlFlow::Continue(()));
    let rest = rest.expect("a start");
    for (one, other) in rest.end.state.iter().zip(&whole.end.state) {
        assert_near("state", *one, *other, 1e-40);
    }
}

#[test]
fn what_rounding_decides_ends_a_run() {
    let table = Sinai {};
    // The point passes the disk within the rounding error of its gap.
    let (end, _) = run::<_, 3>(&table, [&[0.5, -0.9], &[0.0, 1.0]], 1.5);
    assert!(
        matches!(end.outcome, Err(Undefined::Graze { surface: 4, .. })),
        "{:?}",
        end.outcome
    );
    // The step with the graze is not made.
    assert!(end.end.t.nearest() < 0.9, "{}", end.end.t);
    // The point runs into a corner.
    let (end, impacts) = run::<_, 3>(&table, [&[0.75, 0.75], &[1.0, 1.0]], 3.0);
    assert!(
        matches!(end.outcome, Err(Undefined::Corner { .. })),
        "{:?}",
        end.outcome
    );
    assert!(impacts.is_empty());
    let rounded = end.end.rounded();
    assert_eq!([rounded[0], rounded[1]], [0.75, 0.75]);
}

#[test]
fn what_has_no_series_ends_a_run() {
    let (end, _) = run::<_, 3>(&Kinked {}, [&[-1.0], &[1.5]], 3.0);
    assert!(
        matches!(end.outcome, Ok(Outcome::StepUnderflow { .. })),
        "{:?}",
        end.outcome
    );
    assert!(end.end.t.nearest() < 1.0 && end.end.state[0].nearest() <= 1e-9);
    // On one side of the kink the run reaches its end.
    let (end, _) = run::<_, 3>(&Kinked {}, [&[1.0], &[1.5]], 0.5);
    assert_eq!(end.outcome, Ok(Outcome::Done));
}

#[test]
fn a_surface_that_holds_the_motion_ends_a_run() {
    let ball = Elastic {};
    let state = start(&ball, &[1.0], &[0.0]).expect("a state");
    let mut effects = ball.effects();
    effects.set_law(0, Law::ImpactPlastic);
    let end = |effects: <Elastic as Scene>::Effects| {
        ExtendedSimulation::<_, _, 3>::new(&ball, effects)
            .run(At::of(0.0, &state), 3.0, |_| ControlFlow::Continue(()))
            .expect("a start")
    };
    let pressed = end(effects.clone());
    assert_eq!(pressed.outcome, Ok(Outcome::Contact { surface: 0 }));
    assert_near(
        "time",
        pressed.end.t,
        Numbers::sqrt(Extended::from(2.0)),
        1e-45,
    );
    effects.set_policies(Policies {
        rest: Rest::Contact,
        ..Policies::default()
    });
    assert!(matches!(
        end(effects).outcome,
        Err(Undefined::Held { surface: 0, .. })
    ));
}

#[test]
fn the_caller_and_budgets_end_a_run_with_its_last_impact() {
    let ball = Elastic {};
    let state = start(&ball, &[0.5], &[0.0]).expect("a state");
    let mut seen = 0;
    let stopped = ExtendedSimulation::<_, _, 3>::new(&ball, ball.effects())
        .run(At::of(0.0, &state), 100.0, |_| {
            seen += 1;
            if seen == 3 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        })
        .expect("a start");
    assert_eq!(stopped.outcome, Ok(Outcome::Stopped));
    let mut effects = ball.effects();
    effects.set_impact_budget(Some(3));
    let spent = ExtendedSimulation::<_, _, 3>::new(&ball, effects)
        .run(At::of(0.0, &state), 100.0, |_| ControlFlow::Continue(()))
        .expect("a start");
    assert_eq!(spent.outcome, Ok(Outcome::ImpactBudget));
    for run in [stopped, spent] {
        assert_near("time", run.end.t, Extended::from(5.0), 1e-44);
        assert_near("speed", run.end.state[1], Extended::from(1.0), 1e-44);
    }
    // The run ends at the double nearest to the time of an impact, and still meets it.
    let t_end = core::f64::consts::SQRT_2;
    let (met, impacts) = run::<_, 3>(&ball, [&[1.0], &[0.0]], t_end);
    assert_eq!(
        (met.outcome, met.end.t),
        (Ok(Outcome::Done), Extended::from(t_end))
    );
    assert_eq!(impacts.len(), 1);
    let backwards = ExtendedSimulation::<_, _, 3>::new(&ball, ball.effects()).run(
        At::of(1.0, &state),
        0.0,
        |_| ControlFlow::Continue(()),
    );
    assert!(backwards.is_err());
}
