//! Impacts between bodies that touch: waves that pass through them in no time.

use std::ops::ControlFlow;

use dalembert::{
    Corner, Dla2, Dla4, Dop853, DormandPrince5, Event, Gauss4, Gauss6, Lagrangian, Law, Observer,
    Outcome, Policies, Rest, Rk4, Run, Scene, SceneEffects, Segment, Simulation, StateVector,
    Stepper, System, Taylor, TaylorField, Tolerance,
};

macro_rules! cradle {
    ($name:ident { $($ball:ident $mass:ident)* } $($gap:ident: $left:ident $right:ident)*) => {
        dalembert::model! {
            /// Balls of diameter 1 on a line.
            pub $name {
                coordinates { $($ball;)* }
                parameters { $($mass > 0 = 1;)* }
                lagrangian = (0 $(+ $mass*dot($ball)^2)*)/2;
                impacts { $($gap: $right - $left - 1 >= 0;)* }
            }
        }
    };
}

cradle!(Two { x1 m1 x2 m2 } g1: x1 x2);
cradle!(Three { x1 m1 x2 m2 x3 m3 } g1: x1 x2 g2: x2 x3);
cradle!(Four { x1 m1 x2 m2 x3 m3 x4 m4 } g1: x1 x2 g2: x2 x3 g3: x3 x4);
cradle!(Five { x1 m1 x2 m2 x3 m3 x4 m4 x5 m5 } g1: x1 x2 g2: x2 x3 g3: x3 x4 g4: x4 x5);
cradle!(Six { x1 m1 x2 m2 x3 m3 x4 m4 x5 m5 x6 m6 } g1: x1 x2 g2: x2 x3 g3: x3 x4 g4: x4 x5 g5: x5 x6);

dalembert::model! {
    /// A point between two walls whose distance is 0.
    pub Slab {
        coordinates { x; }
        parameters { width >= 0 = 0; }
        lagrangian = dot(x)^2/2;
        impacts { left: x >= 0; right: width - x >= 0; }
    }
}

dalembert::model! {
    /// The motion that brings a double integrator to rest with the least integral of `x^2` (Fuller): its switches accumulate.
    pub Fuller {
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
    }
}

/// Times of impacts, and of the ends of steps.
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

fn start<M: System>(model: &M, q: &[f64], qdot: &[f64]) -> M::State {
    let vector = |values: &[f64]| M::Vector::of(values);
    model
        .state_unchecked(0.0, &vector(q), &vector(qdot))
        .expect("a state")
}

fn ran<M: Scene>(
    model: &M,
    stepper: impl Stepper<M>,
    policies: Policies,
    (q, qdot): (&[f64], &[f64]),
) -> (Run<M::State>, Vec<f64>, Times) {
    let mut effects = model.effects();
    effects.set_policies(policies);
    let mut times = Times::default();
    let run = Simulation::new(model, stepper, effects)
        .run(0.0, start(model, q, qdot), 3.0, &mut times)
        .expect("a start");
    let velocity = model.velocity(run.t, &run.state).expect("a velocity");
    (run, velocity.as_slice().to_vec(), times)
}

fn tolerance() -> Tolerance {
    Tolerance::new(1e-10).expect("a tolerance")
}

/// For motions without forces, which every step follows exactly.
fn loose() -> Tolerance {
    Tolerance::new(1e-6).expect("a tolerance")
}

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

/// The first `arriving` of `count` balls come at speed 1 from the distance 1, the others touch at rest.
fn arrivals(count: usize, arriving: usize) -> (Vec<f64>, Vec<f64>) {
    let place = |i: usize| i as f64 - f64::from(u8::from(i < arriving));
    let speed = |i: usize| f64::from(u8::from(i < arriving));
    (
        (0..count).map(place).collect(),
        (0..count).map(speed).collect(),
    )
}

fn check_cradle<M>(model: &M, count: usize)
where
    M: Scene + Lagrangian + TaylorField,
{
    for arriving in 1..count.min(3) {
        let (q, qdot) = arrivals(count, arriving);
        let mirrored: Vec<f64> = qdot.iter().rev().copied().collect();
        macro_rules! check {
            ($($stepper:ident)*) => {$(for policies in [DEFAULT, CONTACT] {
                let (run, velocity, times) =
                    ran(model, $stepper::new(loose()), policies, (&q, &qdot));
                let case = format!("{} {count} {arriving}", stringify!($stepper));
                assert_eq!(run.outcome, Outcome::Done, "{case}");
                assert_eq!(velocity, mirrored, "{case}");
                assert_eq!(times.impacts.len(), arriving * (count - arriving), "{case}");
                assert!(times.impacts.iter().all(|t| *t == times.impacts[0]), "{case}: {:?}", times.impacts);
                assert!((times.impacts[0] - 1.0).abs() < 1e-14, "{case}: {:?}", times.impacts);
            })*};
        }
        check!(Dop853 DormandPrince5 Taylor Gauss4 Gauss6 Rk4 Dla2 Dla4);
    }
}

#[test]
fn as_many_balls_leave_a_cradle_as_arrive() {
    check_cradle(&Two::default(), 2);
    check_cradle(&Three::default(), 3);
    check_cradle(&Four::default(), 4);
    check_cradle(&Five::default(), 5);
    check_cradle(&Six::default(), 6);
}

/// Momentum and energy of masses.
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
    let [m1, m2, m3, m4, m5] = masses;
    let balls = Five { m1, m2, m3, m4, m5 };
    let (q, qdot) = arrivals(5, 1);
    macro_rules! check {
        ($($stepper:ident)*) => {$({
            let (run, velocity, times) =
                ran(&balls, $stepper::new(tolerance()), DEFAULT, (&q, &qdot));
            assert_eq!(run.outcome, Outcome::Done);
            assert!(times.impacts.len() > 4 && times.impacts.iter().all(|t| *t == times.impacts[0]));
            assert!(!approaching(&velocity), "{velocity:?}");
            let ([p, e], [p0, e0]) = (sums(&masses, &velocity), sums(&masses, &qdot));
            assert!((p - p0).abs() < 1e-14 && (e - e0).abs() < 1e-14, "{p} {e}");
        })*};
    }
    check!(Dop853 Taylor Gauss6 Rk4 Dla4);
}

#[test]
fn a_wave_is_the_limit_of_equal_small_gaps() {
    let balls = Four {
        m1: 1.0,
        m2: 2.0,
        m3: 1.0,
        m4: 5.0,
    };
    let (q, qdot) = arrivals(4, 1);
    let apart: Vec<f64> = (0..4).map(|i| q[i] + 1e-9 * i as f64).collect();
    let run = |q: &[f64]| ran(&balls, Dop853::new(tolerance()), DEFAULT, (q, &qdot)).1;
    let (touching, apart) = (run(&q), run(&apart));
    for (one, other) in touching.iter().zip(&apart) {
        assert!((one - other).abs() < 1e-12, "{touching:?} {apart:?}");
    }
}

#[test]
fn waves_that_meet_are_flagged_where_their_order_matters() {
    let (q, qdot) = ([-1.0, 1.0, 2.0, 3.0, 5.0], [1.0, 0.0, 0.0, 0.0, -1.0]);
    let run = |balls: &Five, corner| {
        let policies = Policies { corner, ..DEFAULT };
        ran(balls, Dop853::new(tolerance()), policies, (&q, &qdot))
    };
    // Equal masses pass their velocities on, whichever comes first.
    let (end, velocity, _) = run(&Five::default(), Corner::Stop);
    assert_eq!(end.outcome, Outcome::Done);
    assert_eq!(velocity, [-1.0, 0.0, 0.0, 0.0, 1.0]);
    // The waves meet at a middle ball: one of its two gaps is struck first.
    let balls = Five {
        m2: 2.0,
        m4: 4.0,
        ..Five::default()
    };
    let end = run(&balls, Corner::Stop).0;
    assert_eq!(end.outcome, Outcome::Ambiguous { surfaces: [1, 2] });
    for corner in [Corner::Ascending, Corner::Descending] {
        assert_eq!(run(&balls, corner).0.outcome, Outcome::Done);
    }
}

#[test]
fn a_light_ball_between_two_heavy_ones_is_struck_as_often_as_it_must_be() {
    // The velocities turn in a wedge of the angle `atan(sqrt(m (1 + m + 1)/(1 1)))`; one more impact fits for each angle in pi.
    for light in [1e-4, 1e-6] {
        let balls = Three {
            m2: light,
            ..Three::default()
        };
        let (q, qdot) = arrivals(3, 1);
        for q in [&q[..], &[q[0], q[1], q[2] + 1e-15]] {
            let (run, velocity, times) = ran(&balls, Dop853::new(tolerance()), DEFAULT, (q, &qdot));
            assert_eq!(run.outcome, Outcome::Done);
            let angle = (light * (2.0 + light)).sqrt().atan();
            let expected = (core::f64::consts::PI / angle).floor() as usize;
            assert_eq!(times.impacts.len(), expected);
            let masses = [1.0, light, 1.0];
            let ([p, e], [p0, e0]) = (sums(&masses, &velocity), sums(&masses, &qdot));
            assert!((p - p0).abs() < 1e-12 && (e - e0).abs() < 1e-12, "{p} {e}");
            assert!(!approaching(&velocity), "{velocity:?}");
        }
    }
}

#[test]
#[ignore = "nightly: two million impacts"]
fn a_very_light_ball_between_two_heavy_ones_is_no_accumulation() {
    let balls = Three {
        m2: 1e-12,
        ..Three::default()
    };
    let (q, qdot) = arrivals(3, 1);
    for q in [&q[..], &[-1.0, 1.0, 3.0]] {
        let (run, velocity, _) = ran(&balls, Dop853::new(tolerance()), DEFAULT, (q, &qdot));
        assert_eq!(run.outcome, Outcome::Done);
        assert!(run.counters.impacts.abs_diff(2_221_441) <= 1);
        assert!((velocity[2] - 1.0).abs() < 1e-12, "{velocity:?}");
    }
}

/// Balls that do not bounce off each other move on together.
#[test]
fn balls_that_stick_are_pressed_and_go_on_as_one() {
    let balls = Five::default();
    let (q, qdot) = arrivals(5, 1);
    let run = |policies| {
        let mut effects = balls.effects();
        effects.set_policies(policies);
        for surface in 0..4 {
            effects.set_law(surface, Law::ImpactPlastic);
        }
        Simulation::new(&balls, Dop853::new(tolerance()), effects)
            .run(0.0, start(&balls, &q, &qdot), 3.0, &mut ())
            .expect("a start")
    };
    assert!(matches!(run(DEFAULT).outcome, Outcome::Contact { .. }));
    let end = run(CONTACT);
    assert_eq!(end.outcome, Outcome::Done);
    let velocity = balls.velocity(end.t, &end.state).expect("a velocity");
    for v in velocity.as_slice() {
        assert!((v - 0.2).abs() < 1e-14, "{velocity:?}");
    }
}

#[test]
fn impacts_without_room_to_go_accumulate_at_once() {
    let (run, ..) = ran(
        &Slab::default(),
        Dop853::new(tolerance()),
        DEFAULT,
        (&[0.0], &[1.0]),
    );
    assert!(
        matches!(run.outcome, Outcome::Zeno { t: 0.0, .. }),
        "{:?}",
        run.outcome
    );
    assert!(run.counters.impacts < 200);
}

#[test]
fn the_switches_of_fullers_problem_accumulate_when_they_must() {
    let fuller = Fuller::default();
    // By hand: from `-1` to the first switch, then every stretch is `rho` times the one before.
    let k = fuller.k;
    let rho = ((0.5 - k) / (0.5 + k)).sqrt();
    let first = 1.0 / (0.5 + k).sqrt();
    let limit = first + first * (1.0 + rho) / (1.0 - rho);
    let initial = start(&fuller, &[-1.0, 0.0], &[0.0, 0.0]);
    macro_rules! check {
        ($($stepper:ident)*) => {$({
            let run = Simulation::new(&fuller, $stepper::new(tolerance()), fuller.effects())
                .run(0.0, initial, 20.0, &mut ())
                .expect("a start");
            let Outcome::Zeno { t, .. } = run.outcome else {
                panic!("{}: {:?} at {}", stringify!($stepper), run.outcome, run.t);
            };
            assert!((t - limit).abs() < 1e-10, "{}: {t} {limit}", stringify!($stepper));
        })*};
    }
    check!(Dop853 DormandPrince5 Taylor Gauss4 Gauss6 Rk4);
}
