//! Impacts between touching bodies, through which waves pass instantly.

use std::fmt::Write;
use std::ops::ControlFlow;

use dalembert::{
    Corner, Event, Law, Observer, Outcome, Policies, Rest, Run, Segment, StateVector, System,
};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, Driven, is_discrete, vector};
use dalembert_stability::text::{Large, Text, set, value};

/// Balls of diameter 1 on a line, with these masses.
fn balls(masses: &[f64]) -> Large {
    let count = masses.len();
    let mut parts = [const { String::new() }; 4];
    let [coordinates, parameters, energy, impacts] = &mut parts;
    for i in 1..=count {
        let _ = write!(coordinates, "x{i}; ");
        let _ = write!(parameters, "m{i} > 0 = 1; ");
        let _ = write!(energy, " + m{i}*dot(x{i})^2");
    }
    for i in 1..count {
        let _ = write!(impacts, "g{i}: x{} - x{i} - 1 >= 0; ", i + 1);
    }
    let text = format!(
        "Balls {{
            coordinates {{ {coordinates} }}
            parameters {{ {parameters} }}
            lagrangian = (0{energy})/2;
            impacts {{ {impacts} }}
        }}"
    );
    let mut model = Text::new(text.leak()).sized();
    for (i, mass) in masses.iter().enumerate() {
        set(&mut model, &format!("m{}", i + 1), *mass);
    }
    model
}

/// A point between two walls whose distance is 0.
static SLAB: Text = Text::new(
    "Slab {
        coordinates { x; }
        parameters { width >= 0 = 0; }
        lagrangian = dot(x)^2/2;
        impacts { left: x >= 0; right: width - x >= 0; }
    }",
);

/// Fuller's problem: a double integrator comes to rest with the least integral of `x^2`. Its switches accumulate.
static FULLER: Text = Text::new(
    "Fuller {
        coordinates { x; v; }
        parameters { k > 0 = 0.4446235601; }
        modes {
            pushed { field { dot(x) = v; dot(v) = 1; } initial { x = -1; until = 20; } }
            pulled { field { dot(x) = v; dot(v) = -1; } }
        }
        transitions {
            pull: pushed -> pulled when x + k*v*abs(v) >= 0;
            push: pulled -> pushed when x + k*v*abs(v) <= 0;
        }
    }",
);

/// Times of impacts and of the ends of steps.
#[derive(Default)]
struct Times {
    impacts: Vec<f64>,
    steps: Vec<f64>,
}

impl<M: System> Observer<M> for Times {
    fn event(&mut self, event: &Event<M::State>) -> ControlFlow<()> {
        self.impacts.push(event.t);
        ControlFlow::Continue(())
    }

    fn step(&mut self, segment: &mut Segment<'_, M::State>) -> ControlFlow<()> {
        self.steps.push(segment.t_end());
        ControlFlow::Continue(())
    }
}

fn start<'a, M: Driven>(model: &'a M, q: &[f64], qdot: &[f64]) -> Course<'a, M> {
    let state = model.state_unchecked(0.0, &vector(q), &vector(qdot));
    Course::from_state(model, state.expect("a state"), 3.0)
}

fn ran<M: Driven>(
    model: &M,
    (integrator, tolerance): (Integrator, f64),
    policies: Policies,
    (q, qdot): (&[f64], &[f64]),
) -> (Run<M::State>, Vec<f64>, Times) {
    let mut times = Times::default();
    let run = start(model, q, qdot)
        .tol(tolerance)
        .policies(policies)
        .observed(integrator, &mut times);
    let velocity = model.velocity(run.t, &run.state).expect("a velocity");
    (run, velocity.as_slice().to_vec(), times)
}

const TOLERANCE: f64 = 1e-10;

/// Tolerance for motions without forces, which every step follows exactly.
const LOOSE: f64 = 1e-6;

const BY_STEPS: (Integrator, f64) = (Integrator::Dop853, TOLERANCE);

const CONTACT: Policies = Policies {
    rest: Rest::Contact,
    ..DEFAULT
};

const DEFAULT: Policies = Policies {
    rest: Rest::Stop,
    penetration: dalembert::Penetration::Stop,
    corner: dalembert::Corner::Stop,
    split: dalembert::policy::Split::First,
};

/// Positions and velocities of `count` balls. The first `arriving` come with the speed 1 from the distance 1; the
/// others touch at rest.
fn arrivals(count: usize, arriving: usize) -> (Vec<f64>, Vec<f64>) {
    let place = |i: usize| i as f64 - f64::from(u8::from(i < arriving));
    let speed = |i: usize| f64::from(u8::from(i < arriving));
    (
        (0..count).map(place).collect(),
        (0..count).map(speed).collect(),
    )
}

fn check_cradle(count: usize) {
    let model = balls(&vec![1.0; count]);
    for arriving in 1..count.min(3) {
        let (q, qdot) = arrivals(count, arriving);
        let mirrored: Vec<f64> = qdot.iter().rev().copied().collect();
        for &integrator in Integrator::every() {
            for policies in [DEFAULT, CONTACT] {
                let (run, velocity, times) =
                    ran(&model, (integrator, LOOSE), policies, (&q, &qdot));
                let case = format!("{} {count} {arriving}", integrator.name());
                assert_eq!(run.outcome, Outcome::Done, "{case}");
                assert_eq!(velocity, mirrored, "{case}");
                let impacts = times.impacts;
                assert_eq!(impacts.len(), arriving * (count - arriving), "{case}");
                assert!(
                    impacts.iter().all(|t| *t == impacts[0]),
                    "{case}: {impacts:?}"
                );
                assert!((impacts[0] - 1.0).abs() < 1e-14, "{case}: {impacts:?}");
            }
        }
    }
}

#[test]
fn as_many_balls_leave_a_cradle_as_arrive() {
    for count in 2..=6 {
        check_cradle(count);
    }
}

/// Total momentum and kinetic energy.
fn sums(masses: &[f64], velocity: &[f64]) -> [f64; 2] {
    let pairs = || masses.iter().zip(velocity);
    [
        pairs().map(|(m, v)| m * v).sum(),
        pairs().map(|(m, v)| 0.5 * m * v * v).sum(),
    ]
}

fn approaching(velocity: &[f64]) -> bool {
    velocity.windows(2).any(|pair| pair[1] - pair[0] < -1e-15)
}

#[test]
fn a_wave_through_unequal_masses_keeps_momentum_and_energy() {
    let masses = [3.0, 0.5, 1.7, 0.9, 2.2];
    let balls = balls(&masses);
    let (q, qdot) = arrivals(5, 1);
    for &integrator in Integrator::every() {
        let (run, velocity, times) = ran(&balls, (integrator, TOLERANCE), DEFAULT, (&q, &qdot));
        let (name, impacts) = (integrator.name(), times.impacts);
        assert_eq!(run.outcome, Outcome::Done, "{name}");
        assert!(
            impacts.len() > 4 && impacts.iter().all(|t| *t == impacts[0]),
            "{name}: {impacts:?}"
        );
        assert!(!approaching(&velocity), "{name}: {velocity:?}");
        let ([p, e], [p0, e0]) = (sums(&masses, &velocity), sums(&masses, &qdot));
        assert!(
            (p - p0).abs() < 1e-14 && (e - e0).abs() < 1e-14,
            "{name}: {p} {e}"
        );
    }
}

#[test]
fn a_wave_is_the_limit_of_equal_small_gaps() {
    let balls = balls(&[1.0, 2.0, 1.0, 5.0]);
    let (q, qdot) = arrivals(4, 1);
    let apart: Vec<f64> = (0..4).map(|i| q[i] + 1e-9 * i as f64).collect();
    let run = |q: &[f64]| ran(&balls, BY_STEPS, DEFAULT, (q, &qdot)).1;
    let (touching, apart) = (run(&q), run(&apart));
    for (one, other) in touching.iter().zip(&apart) {
        assert!((one - other).abs() < 1e-12, "{touching:?} {apart:?}");
    }
}

#[test]
fn waves_that_meet_are_flagged_where_their_order_matters() {
    let (q, qdot) = ([-1.0, 1.0, 2.0, 3.0, 5.0], [1.0, 0.0, 0.0, 0.0, -1.0]);
    let run = |masses: [f64; 5], corner| {
        let policies = Policies { corner, ..DEFAULT };
        ran(&balls(&masses), BY_STEPS, policies, (&q, &qdot))
    };
    // Equal masses exchange their velocities, in either order.
    let (end, velocity, _) = run([1.0; 5], Corner::Stop);
    assert_eq!(end.outcome, Outcome::Done);
    assert_eq!(velocity, [-1.0, 0.0, 0.0, 0.0, 1.0]);
    // The waves meet at a middle ball, and the order of its two impacts matters.
    let masses = [1.0, 2.0, 1.0, 4.0, 1.0];
    let end = run(masses, Corner::Stop).0;
    assert_eq!(end.outcome, Outcome::Ambiguous { surfaces: [1, 2] });
    for corner in [Corner::Ascending, Corner::Descending] {
        assert_eq!(run(masses, corner).0.outcome, Outcome::Done);
    }
}

#[test]
fn a_light_ball_between_two_heavy_ones_is_struck_as_often_as_it_must_be() {
    // Impacts are reflections in a wedge of the angle `a = atan(sqrt(m (2 + m)))`. Their number is `floor(pi/a)`.
    for light in [1e-4, 1e-6] {
        let masses = [1.0, light, 1.0];
        let balls = balls(&masses);
        let (q, qdot) = arrivals(3, 1);
        for q in [&q[..], &[q[0], q[1], q[2] + 1e-15]] {
            let (run, velocity, times) = ran(&balls, BY_STEPS, DEFAULT, (q, &qdot));
            assert_eq!(run.outcome, Outcome::Done);
            let angle = (light * (2.0 + light)).sqrt().atan();
            let expected = (core::f64::consts::PI / angle).floor() as usize;
            assert_eq!(times.impacts.len(), expected);
            let ([p, e], [p0, e0]) = (sums(&masses, &velocity), sums(&masses, &qdot));
            assert!((p - p0).abs() < 1e-12 && (e - e0).abs() < 1e-12, "{p} {e}");
            assert!(!approaching(&velocity), "{velocity:?}");
        }
    }
}

#[test]
#[ignore = "nightly: two million impacts"]
fn a_very_light_ball_between_two_heavy_ones_is_no_accumulation() {
    let balls = balls(&[1.0, 1e-12, 1.0]);
    let (q, qdot) = arrivals(3, 1);
    for q in [&q[..], &[-1.0, 1.0, 3.0]] {
        let (run, velocity, _) = ran(&balls, BY_STEPS, DEFAULT, (q, &qdot));
        assert_eq!(run.outcome, Outcome::Done);
        assert!(run.counters.impacts.abs_diff(2_221_441) <= 1);
        assert!((velocity[2] - 1.0).abs() < 1e-12, "{velocity:?}");
    }
}

/// Balls with plastic impacts continue together.
#[test]
fn balls_that_stick_go_on_as_one() {
    let balls = balls(&[1.0; 5]);
    let (q, qdot) = arrivals(5, 1);
    let run = |policies| {
        let mut course = start(&balls, &q, &qdot).tol(TOLERANCE).policies(policies);
        for surface in 0..4 {
            course = course.law(surface, Law::ImpactPlastic);
        }
        course.observed(Integrator::Dop853, &mut ())
    };
    for policies in [DEFAULT, CONTACT] {
        let end = run(policies);
        assert_eq!(end.outcome, Outcome::Done);
        let velocity = balls.velocity(end.t, &end.state).expect("a velocity");
        for v in velocity.as_slice() {
            assert!((v - 0.2).abs() < 1e-14, "{velocity:?}");
        }
    }
}

#[test]
fn impacts_without_room_to_go_accumulate_at_once() {
    let (run, ..) = ran(&SLAB.model(), BY_STEPS, DEFAULT, (&[0.0], &[1.0]));
    assert!(
        matches!(run.outcome, Outcome::Zeno { t: 0.0, .. }),
        "{:?}",
        run.outcome
    );
    assert!(run.counters.impacts < 200);
}

#[test]
fn the_switches_of_fullers_problem_accumulate_when_they_must() {
    let fuller = FULLER.model();
    // The first switch comes at `first`. Every interval between switches is `rho` times the one before.
    let k = value(&fuller, "k");
    let rho = ((0.5 - k) / (0.5 + k)).sqrt();
    let first = 1.0 / (0.5 + k).sqrt();
    let limit = first + first * (1.0 + rho) / (1.0 - rho);
    for &integrator in Integrator::every() {
        if is_discrete(integrator) {
            continue;
        }
        let run = Course::new(&fuller, &[-1.0, 0.0], &[0.0, 0.0], 20.0)
            .tol(TOLERANCE)
            .observed(integrator, &mut ());
        let name = integrator.name();
        let Outcome::Zeno { t, .. } = run.outcome else {
            panic!("{name}: {:?} at {}", run.outcome, run.t);
        };
        assert!((t - limit).abs() < 1e-10, "{name}: {t} {limit}");
    }
}
