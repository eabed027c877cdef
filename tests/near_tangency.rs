//! Motions that come to a surface ever more nearly tangentially: an impact that the error of the integrator may have made is
//! flagged.

use dalembert::{
    Described, Dop853, DormandPrince5, EventLog, Outcome, Scene, Simulation, Stepper, Taylor,
    Tolerance,
};

dalembert::model! {
    /// `r' = 1 - r`, `theta' = 1` with a reset on a line that the limit `r = 1` touches (W. Clark, thesis, Example IV.12): from
    /// inside of the circle the line is never reached.
    pub Tangent {
        coordinates { x; y; }
        let r = sqrt(x^2 + y^2);
        field { dot(x) = x*(1 - r)/r - y; dot(y) = y*(1 - r)/r + x; }
        impacts { line: y <= 1 => reset { y = y - 3; }; }
        initial { x = 1/2; until = 100; }
    }
}

dalembert::model! {
    /// A pendulum that swings to a wall at an angle that its energy gives it.
    pub Turned {
        coordinates { theta; }
        parameters { depth = 0; }
        lagrangian = dot(theta)^2/2 + cos(theta);
        impacts { wall: theta <= pi/2 - depth; }
        initial { dot(theta) = sqrt(2); until = 3; }
    }
}

/// Whether each impact is flagged as a graze.
fn grazes<S, Step>(system: &S, stepper: Step) -> Vec<bool>
where
    S: Described + Scene,
    Step: Stepper<S>,
{
    let start = system.initial();
    let state = system.state(0.0, &start.q, &start.qdot).expect("a state");
    let mut log = EventLog::<_, 64>::new();
    let run = Simulation::new(system, stepper, system.effects())
        .run(0.0, state, start.until.expect("an end"), &mut log)
        .expect("a run");
    assert_eq!(run.outcome, Outcome::Done);
    log.iter().map(|event| event.graze).collect()
}

#[test]
fn a_motion_that_tends_to_tangency_has_no_impact_or_a_graze_first() {
    let system = Tangent::with_defaults();
    for exponent in 3..=14 {
        let tolerance = Tolerance::new(10_f64.powi(-exponent)).expect("a tolerance");
        for (name, found) in [
            ("dop853", grazes(&system, Dop853::new(tolerance))),
            ("dopri5", grazes(&system, DormandPrince5::new(tolerance))),
            ("taylor", grazes(&system, Taylor::new(tolerance))),
        ] {
            println!("{name} 1e-{exponent}: {found:?}");
            assert!(
                found.first().is_none_or(|first| *first),
                "{name}, 1e-{exponent}: {found:?}"
            );
        }
    }
}

#[test]
fn depth_beyond_the_error_is_no_graze() {
    for exponent in 4..=12 {
        let size = 10_f64.powi(-exponent);
        let tolerance = Tolerance::new(size).expect("a tolerance");
        let shallow = Turned { depth: 0.1 * size };
        let deep = Turned { depth: 1e3 * size };
        let flags = |system: &Turned| {
            [
                grazes(system, Dop853::new(tolerance)),
                grazes(system, DormandPrince5::new(tolerance)),
                grazes(system, Taylor::new(tolerance)),
            ]
        };
        println!("1e-{exponent}: {:?} {:?}", flags(&shallow), flags(&deep));
        for found in flags(&deep) {
            assert_eq!(found.first(), Some(&false), "1e-{exponent}");
        }
        for found in flags(&shallow) {
            assert!(found.first().is_none_or(|first| *first), "1e-{exponent}");
        }
    }
}
