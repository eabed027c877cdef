//! Motions that approach a surface nearly tangentially. An impact that may be due to the error of the integrator is
//! flagged as a graze.

use dalembert::{EventLog, Instance, Outcome};
use dalembert_cli::Integrator;
use dalembert_stability::course::Course;
use dalembert_stability::text::{Model, Text};

/// `r' = 1 - r`, `theta' = 1` with a reset on a line that the limit circle `r = 1` touches (W. Clark, thesis, Example
/// IV.12). From inside the circle the line is never reached.
static TANGENT: Text = Text::new(
    "Tangent {
        coordinates { x; y; }
        let r = sqrt(x^2 + y^2);
        field { dot(x) = x*(1 - r)/r - y; dot(y) = y*(1 - r)/r + x; }
        impacts { line: y <= 1 => reset { y = y - 3; }; }
        initial { x = 1/2; until = 100; }
    }",
);

/// A pendulum that turns back at the angle `pi/2`, and a wall at `pi/2 - depth`.
static TURNED: Text = Text::new(
    "Turned {
        coordinates { theta; }
        parameters { depth = 0; }
        lagrangian = dot(theta)^2/2 + cos(theta);
        impacts { wall: theta <= pi/2 - depth; }
        initial { dot(theta) = sqrt(2); until = 3; }
    }",
);

/// The integrators with step-size control.
fn adaptive() -> impl Iterator<Item = Integrator> {
    let every = Integrator::every().iter().copied();
    every.filter(|integrator| integrator.is_adaptive())
}

/// Graze flags of the impacts of a run.
fn grazes(system: &Model, integrator: Integrator, tolerance: f64) -> Vec<bool> {
    let until = system.initial().until.expect("an end");
    let mut log = EventLog::<_, 64>::new();
    let run = Course::declared(system, until)
        .tol(tolerance)
        .observed(integrator, &mut log);
    assert_eq!(run.outcome, Outcome::Done);
    log.iter().map(|event| event.graze).collect()
}

#[test]
fn a_motion_that_tends_to_tangency_has_no_impact_or_a_graze_first() {
    let system = TANGENT.model();
    for exponent in 3..=14 {
        for integrator in adaptive() {
            let name = integrator.name();
            let found = grazes(&system, integrator, 10_f64.powi(-exponent));
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
        let flags = |depth: f64| {
            let system = TURNED.with([("depth", depth)]);
            let flags = adaptive().map(|integrator| grazes(&system, integrator, size));
            flags.collect::<Vec<_>>()
        };
        let (shallow, deep) = (flags(0.1 * size), flags(1e3 * size));
        println!("1e-{exponent}: {shallow:?} {deep:?}");
        for found in deep {
            assert_eq!(found.first(), Some(&false), "1e-{exponent}");
        }
        for found in shallow {
            assert!(found.first().is_none_or(|first| *first), "1e-{exponent}");
        }
    }
}
