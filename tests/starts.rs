//! Starts that the declaration leaves open: what `check` says of them, and how equations of positions complete them.

use dalembert::{Described, Dop853, Outcome, Scene, Simulation, StateError, System, Tolerance};
use dalembert_cli::{Exit, models};
use dalembert_tests::command::{self, Finished};

dalembert::model! {
    /// A particle that may be beyond 1 only; nothing says where it starts, which is at 0.
    pub Behind {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { wall: x >= 1; }
    }
}

dalembert::model! {
    /// The same with a wall that ends above the start.
    pub Beside {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { wall: x >= 1 when y > 1; }
    }
}

fn checked(model: &str) -> Finished {
    command::run(models![Behind, Beside], &["check", model], "")
}

#[test]
fn a_start_behind_a_wall_is_not_admissible() {
    let Finished { exit, output, .. } = checked("behind");
    assert_eq!(exit, Exit::Other, "{output}");
    let expected = "it lies behind the surface `wall`: its gap is -1";
    assert!(output.contains(expected), "{output}");
}

#[test]
fn a_start_beside_a_wall_is_admissible() {
    let Finished { exit, output, .. } = checked("beside");
    assert_eq!(exit, Exit::Reached, "{output}");
}

dalembert::model! {
    /// A pendulum in Cartesian coordinates; where it starts follows from `y`.
    pub Rod {
        coordinates { x; y; }
        parameters { l > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        constraints { rod: x^2 + y^2 = l^2; }
        initial { y = -4/5; dot(y) = 3; }
    }
}

dalembert::model! {
    /// Two links and a coupler between two fixed points at a distance of 2: a loop that closes in one way of two.
    pub FourBar {
        coordinates { a: angle; b: angle; c: angle; }
        lagrangian = (dot(a)^2 + dot(b)^2 + dot(c)^2)/2 - sin(a)/4;
        constraints {
            across: cos(a) + 2*cos(b) - 3/2*cos(c) = 2;
            up: sin(a) + 2*sin(b) - 3/2*sin(c) = 0;
        }
        initial { a = 1; dot(a) = 1/2; }
    }
}

dalembert::model! {
    /// A free particle that a ring is to catch where it is not.
    pub Caught {
        modes {
            free {
                coordinates { x; y; }
                lagrangian = (dot(x)^2 + dot(y)^2)/2;
                initial { x = -1; y = y0; dot(x) = 1; until = 3; }
            }
            ring {
                coordinates { x; y; }
                lagrangian = (dot(x)^2 + dot(y)^2)/2;
                constraints { ring: x^2 + y^2 = 1; }
            }
        }
        parameters { y0 = 1; }
        transitions { caught: free -> ring when x >= 0; }
    }
}

/// The declared start, solved for, and the same run to `end`.
fn start<S: Described + Scene>(system: &S, end: f64) -> ([S::Vector; 2], Outcome) {
    let own = system.initial();
    let q = system.complete_position(0.0, &own.q, &own.placed).unwrap();
    let qdot = system
        .complete_velocity(0.0, &q, &own.qdot, &own.named)
        .unwrap();
    let state = system.state(0.0, &q, &qdot).unwrap();
    let stepper = Dop853::new(Tolerance::new(1e-6).unwrap());
    let run = Simulation::new(system, stepper, system.effects())
        .run(0.0, state, end, &mut ())
        .unwrap();
    ([q, system.position(&run.state)], run.outcome)
}

#[test]
fn equations_of_positions_are_solved_and_kept() {
    for l in [1.0, 1.25, 7.0] {
        let rod = Rod { l };
        let ([begin, end], outcome) = start(&rod, 200.0);
        assert_eq!(outcome, Outcome::Done);
        assert_eq!(begin[1], -0.8);
        assert!(begin[0] > 0.0, "of two places the one to the right");
        for q in [begin, end] {
            assert!((q[0].hypot(q[1]) - l).abs() < 1e-12, "{q} for a rod of {l}");
        }
    }
    let bars = FourBar::with_defaults();
    let ([begin, end], outcome) = start(&bars, 200.0);
    assert_eq!(outcome, Outcome::Done);
    for q in [begin, end] {
        let across = q[0].cos() + 2.0 * q[1].cos() - 1.5 * q[2].cos();
        let up = q[0].sin() + 2.0 * q[1].sin() - 1.5 * q[2].sin();
        assert!((across - 2.0).abs() < 1e-12 && up.abs() < 1e-12, "{q}");
    }
    assert_eq!(begin[0], 1.0);
}

#[test]
fn places_off_the_equations_are_refused() {
    let rod = Rod { l: 0.5 };
    let own = rod.initial();
    let refused = Err(StateError::OffPosition {
        constraint: 0,
        residual: 0.8 * 0.8 - 0.25,
        scale: 0.8 * 0.8 + 0.25,
    });
    assert_eq!(rod.complete_position(0.0, &own.q, &own.placed), refused);
    let refused = rod.state(0.0, &[0.5, 1e-3].into(), &[0.0, 0.0].into());
    assert!(
        matches!(refused, Err(StateError::OffPosition { constraint: 0, .. })),
        "{refused:?}"
    );
    let near = rod.state_projected(0.0, &[0.5, 1e-3].into(), &[1.0, 1.0].into());
    let q = rod.position(&near.unwrap());
    assert!((q[0].hypot(q[1]) - 0.5).abs() < 1e-15 && (q[1] - 1e-3).abs() < 1e-6);
}

#[test]
fn a_mode_is_not_entered_off_its_equations() {
    let caught = Caught::with_defaults();
    assert_eq!(start(&caught, 3.0).1, Outcome::Done);
    let beside = Caught { y0: 0.5, ..caught };
    let expected = Outcome::ResetOffConstraint {
        surface: 0,
        constraint: 0,
    };
    assert_eq!(start(&beside, 3.0).1, expected);
}

#[test]
fn the_command_line_solves_for_positions_or_refuses_them() {
    let run = |line: &str| command::line(models![Rod], line, "");
    let Finished { exit, output, .. } = run("check rod");
    assert_eq!(exit, Exit::Reached, "{output}");
    let Finished { output, .. } = run("simulate rod --until 0.1 --csv - --initial y=0.6");
    assert!(output.contains("\n0.0,0.8,0.6,"), "{output}");
    let off = "simulate rod --until 1 --initial x=0.8,y=-0.8";
    let Finished { exit, errors, .. } = run(off);
    assert_ne!(exit, Exit::Reached);
    let expected = "--initial: the positions violate the constraint `rod`: its sides differ by 2.8";
    assert!(errors.contains(expected), "{errors}");
    let Finished { exit, errors, .. } = run(&format!("{off} --off-constraint project"));
    assert_eq!(exit, Exit::Reached, "{errors}");
    let Finished { exit, errors, .. } = run(&format!("{off} --off-constraint keep"));
    assert_eq!(exit, Exit::Reached, "{errors}");
    let given = "simulate rod --until 1 --q 0.8,-0.8 --qdot 1,1";
    let Finished { errors, .. } = run(given);
    assert!(errors.contains("the positions violate"), "{errors}");
}
