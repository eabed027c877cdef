//! Several surfaces of one gap: each state that comes there is taken by one of them, or the run ends with a name.

use dalembert::{
    Described, Dop853, EventLog, Gauss4, Impacting, Outcome, Rk4, Scene, Simulation, Stepper,
    System, Taylor, Tolerance,
};

dalembert::model! {
    /// The tent map, without a square for the height 1/2.
    pub OpenTent {
        coordinates { x; y; }
        field { dot(x) = 1; dot(y) = 0; }
        modes {
            first { initial { y = 1/8; until = 40; } }
            lower { }
            upper { }
        }
        transitions {
            down: first -> lower when x >= 1 when y < 1/2 => reset { x = 0; y = 2*y; };
            up: first -> upper when 2*x >= 2 when y > 1/2 => reset { x = 0; y = 2*(1 - y); };
            from_lower: lower -> first when x >= 1 => reset { x = 0; };
            from_upper: upper -> first when x >= 1 => reset { x = 0; };
        }
    }
}

dalembert::model! {
    /// The same, with all other heights led on.
    pub ClosedTent {
        coordinates { x; y; }
        field { dot(x) = 1; dot(y) = 0; }
        modes {
            first { initial { y = 1/8; until = 40; } }
            lower { }
            upper { }
        }
        transitions {
            down: first -> lower when x >= 1 when y < 1/2 when y > -3 => reset { x = 0; y = 2*y; };
            up: first -> upper when x >= 1 otherwise => reset { x = 0; y = 2*(1 - y); };
            from_lower: lower -> first when x >= 1 => reset { x = 0; };
            from_upper: upper -> first when x >= 1 => reset { x = 0; };
        }
    }
}

dalembert::model! {
    /// A wall that reflects where it is soft, loses half the speed where it is not, and swallows everything in a spot.
    pub Patched {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts {
            soft: x >= 0 when y > 0;
            spot: x >= 0 when y < -1 when y > -2 => totally_plastic;
            hard: x >= 0 otherwise => newton(1/2);
        }
        initial { x = 1; dot(x) = -1; until = 2; }
    }
}

fn run_of<S, Step>(
    system: &S,
    stepper: Step,
    q: [f64; 2],
    qdot: [f64; 2],
) -> (f64, Outcome, S::State)
where
    S: System<Vector = dalembert::__private::SVector<f64, 2>> + Described + Scene,
    Step: Stepper<S>,
{
    let until = system.initial().until.expect("an end");
    let state = system.state(0.0, &q.into(), &qdot.into()).expect("a state");
    let run = Simulation::new(system, stepper, system.effects())
        .run(0.0, state, until, &mut ())
        .expect("a run");
    (run.t, run.outcome, run.state)
}

#[test]
fn a_state_that_no_transition_takes_ends_the_run() {
    let tent = OpenTent::with_defaults();
    let tolerance = Tolerance::new(1e-10).expect("a tolerance");
    let (dop853, taylor) = (Dop853::new(tolerance), Taylor::new(tolerance));
    let untaken = Outcome::Untaken {
        surface: open_tent::surface::up,
    };
    // 1/8, 1/4, 1/2: two squares are crossed for each.
    for (t, outcome, state) in [
        run_of(&tent, dop853, [0.0, 0.125], [0.0; 2]),
        run_of(&tent, taylor, [0.0, 0.125], [0.0; 2]),
        run_of(
            &tent,
            Rk4::new(tolerance).with_step(0.0625),
            [0.0, 0.125],
            [0.0; 2],
        ),
    ] {
        assert_eq!(outcome, untaken);
        assert!((t - 5.0).abs() < 1e-12, "{t}");
        assert!((state[0] - 1.0).abs() < 1e-12, "{state:?}");
    }
    assert_eq!(untaken.kind(), "untaken");
    // 2/7 never comes to 1/2.
    assert_eq!(
        run_of(&tent, dop853, [0.0, 2.0 / 7.0], [0.0; 2]).1,
        Outcome::Done
    );
    // A mode by itself says so, too.
    let alone = open_tent::First(tent);
    let state = alone
        .state(0.0, &[0.0, 0.5].into(), &[0.0; 2].into())
        .expect("a state");
    let run = Simulation::new(&alone, Dop853::new(tolerance), alone.effects())
        .run(0.0, state, 4.0, &mut ())
        .expect("a run");
    assert!(
        matches!(run.outcome, Outcome::Untaken { .. }),
        "{:?}",
        run.outcome
    );
}

#[test]
fn otherwise_takes_what_is_left() {
    let tent = ClosedTent::with_defaults();
    let dop853 = Dop853::new(Tolerance::new(1e-10).expect("a tolerance"));
    let (_, outcome, state) = run_of(&tent, dop853, [0.0, 0.125], [0.0; 2]);
    assert_eq!(outcome, Outcome::Done);
    assert!(state[0] <= 1.0 && state[1] == 0.0, "{state:?}");
    // Below -3 as well: 2*(1 + 4) = 10, then 2*(1 - 10) = -18.
    let mut log = EventLog::<_, 8>::new();
    let state = tent
        .state(0.0, &[0.0, -4.0].into(), &[0.0; 2].into())
        .expect("a state");
    let run = Simulation::new(&tent, dop853, tent.effects())
        .run(0.0, state, 3.5, &mut log)
        .expect("a run");
    assert_eq!(run.outcome, Outcome::Done);
    let up = closed_tent::surface::up;
    assert_eq!(log.iter().filter(|event| event.surface == up).count(), 2);
    assert_eq!(run.state[1], -18.0);
}

#[test]
fn otherwise_divides_a_wall() {
    let wall = Patched::with_defaults();
    let tolerance = Tolerance::new(1e-10).expect("a tolerance");
    let dop853 = Dop853::new(tolerance);
    let cases = [
        (0.5, 1.0),
        (0.0, 0.5),
        (-1.0, 0.5),
        (-1.5, 0.0),
        (-2.0, 0.5),
        (-9.0, 0.5),
    ];
    for (y, speed) in cases {
        let (_, outcome, state) = run_of(&wall, dop853, [1.0, y], [-1.0, 0.0]);
        let gauss = run_of(
            &wall,
            Gauss4::new(tolerance).with_step(0.125),
            [1.0, y],
            [-1.0, 0.0],
        );
        if speed > 0.0 {
            assert_eq!(outcome, Outcome::Done, "y = {y}");
            assert!((gauss.2[2] - speed).abs() < 1e-12, "{gauss:?} at y = {y}");
        }
        let velocity = wall.velocity(0.0, &state).expect("a state");
        assert!(
            (velocity[0] - speed).abs() < 1e-12,
            "{velocity:?} at y = {y}"
        );
        let at = wall
            .state_unchecked(0.0, &[0.0, y].into(), &[-1.0, 0.0].into())
            .expect("a state");
        let counting = (0..3)
            .filter(|&own| wall.surface_active(own, 0.0, &at))
            .count();
        assert_eq!(counting, 1, "y = {y}");
    }
}
