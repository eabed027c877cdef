//! First variations of runs that surfaces hold for a while, and of impacts with instantaneous constraints.

use dalembert::math::larger;
use dalembert::variations::Undefined;
use dalembert::{Law, Tangent, VectorField};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, state};
use dalembert_stability::text::{Model, Text};
use dalembert_stability::varied::Varied;
use dalembert_tests::differences::{self, Turns};

/// A point that lands on a rising hill, slides along it, and leaves it where the hill would have to pull.
static HILL: Text = Text::new(
    "Hill {
        coordinates { x; y; }
        parameters { g > 0 = 1; c > 0 = 1/50; w = 1/20; m > 0 = 2; b = 1/10; }
        lagrangian = m*(dot(x)^2 + dot(y)^2)/2 + b*x*dot(x)*dot(y) - m*g*y;
        impacts { hill: y >= -c*x^4 + w*t => impact_plastic; }
    }",
);

/// A steered ball over a bumpy slope with a running belt. The ball does not slip while it touches the slope.
static BUMPS: Text = Text::new(
    "Bumps {
        coordinates { x; y; a; z; }
        parameters { g > 0 = 1; r = 1/2; c = 3/10; e in [0, 1] = 3/5; s = 1/5; }
        lagrangian = (dot(x)^2 + dot(y)^2 + 2/5*r^2*dot(a)^2 + (1 + x^2/5)*dot(z)^2)/2 - g*y + x*z/7;
        constraints { steered: dot(z) - c*y*dot(x) = 0; }
        impacts {
            slope: y >= c*sin(x) => newton(e), instantaneous { no_slip: dot(x) + s*y*dot(y) = r*dot(a) + s; };
            lid: y <= 1;
        }
    }",
);

type State = <Model as VectorField>::State;

/// A run that may rest on surfaces. A given law replaces that of the first surface.
fn course<'a, M: Varied>(
    system: &'a M,
    start: M::State,
    law: Option<Law>,
    until: f64,
) -> Course<'a, M> {
    let course = Course::from_state(system, start, until)
        .tol(1e-15)
        .resting()
        .projection(false);
    match law {
        Some(law) => course.law(0, law),
        None => course,
    }
}

/// Numbers of contacts that begin to hold the motion of a run, and of contacts that release it.
fn turns<M: Varied>(course: Course<'_, M>) -> [usize; 2] {
    let mut seen = Turns::default();
    let run = course.observed(Integrator::Taylor, &mut seen);
    assert!(run.outcome.is_done(), "{}", run.outcome);
    seen.0
}

/// Compares derivatives with differences of runs. `expected` has the numbers of contacts that begin and end.
fn check_differences<M: Varied>(
    system: &M,
    start: M::State,
    law: Option<Law>,
    until: f64,
    expected: [usize; 2],
) {
    let name = system.description().name;
    let seen = turns(course(system, start, law, until));
    assert_eq!(seen, expected, "{name} until {until}");
    let length = system.state_len();
    let impacts = differences::check_differences(system, start, length, |system, start| {
        course(system, start, law, until)
    });
    assert!(impacts > 0, "{name}");
}

fn on_hill(q: [f64; 2], qdot: [f64; 2]) -> (Model, State) {
    let hill = HILL.model();
    (hill, state(&hill, &q, &qdot))
}

/// The ball at its start. Its state has seven components.
fn over_bumps() -> (Model, State) {
    let ball = BUMPS.model();
    let qdot = [0.7, 0.2, 1.0, 0.3 * 0.9 * 0.7];
    (ball, state(&ball, &[0.1, 0.9, 0.0, 0.2], &qdot))
}

#[test]
fn motion_along_a_surface_has_its_derivative() {
    let (hill, start) = on_hill([0.1, 0.3], [0.7, 0.2]);
    check_differences(&hill, start, None, 1.5, [1, 0]);
    check_differences(&hill, start, None, 4.0, [1, 1]);
}

#[test]
fn loose_runs_have_derivatives_as_good_as_they_are() {
    let (hill, start) = on_hill([0.1, 0.3], [0.7, 0.2]);
    let columns = |tolerance: f64| {
        let mut columns = [0, 1, 2, 3].map(Tangent::of_component);
        let course = course(&hill, start, None, 4.0).tol(tolerance);
        let (run, derived) = course.vary(Integrator::Dop853, &mut columns);
        assert!(run.outcome.is_done(), "{}", run.outcome);
        derived.expect("derivatives");
        columns.map(|column| column.state)
    };
    let sharp = columns(1e-13);
    for tolerance in [1e-5, 1e-8] {
        for (loose, sharp) in columns(tolerance).iter().zip(&sharp) {
            let size = |values: &mut dyn Iterator<Item = f64>| {
                values.fold(0.0, |worst: f64, value| larger(worst, value.abs()))
            };
            let (loose, sharp) = (loose.as_ref(), sharp.as_ref());
            let mut missed = loose.iter().zip(sharp).map(|(a, b)| a - b);
            let error = size(&mut missed) / size(&mut sharp.iter().copied());
            println!("{tolerance:e}: {error:e}");
            assert!(error <= 0.1 * tolerance, "{tolerance:e}: {error:e}");
        }
    }
}

#[test]
fn instantaneous_constraints_have_their_derivative() {
    let (ball, start) = over_bumps();
    check_differences(&ball, start, None, 2.7, [0, 0]);
    check_differences(&ball, start, Some(Law::Elastic), 2.7, [0, 0]);
    // The ball rolls along the slope, where the no-slip constraint keeps holding.
    check_differences(&ball, start, Some(Law::ImpactPlastic), 4.0, [1, 0]);
}

fn undefined(
    system: &Model,
    start: State,
    law: Option<Law>,
    direction: Tangent<Model>,
    until: f64,
) -> Option<Undefined> {
    let course = course(system, start, law, until);
    let (run, derived) = course.vary(Integrator::Taylor, &mut [direction]);
    assert!(run.outcome.is_done(), "{}", run.outcome);
    derived.err()
}

#[test]
fn neighbours_that_are_not_held_have_no_derivative() {
    // The run starts in contact with the hill. Neighbours along the hill are held; those above fall onto it later.
    let hill = HILL.with([("w", 0.0), ("b", 0.0)]);
    let start = state(&hill, &[0.0, 0.0], &[0.3, 0.0]);
    let along = |component| undefined(&hill, start, None, Tangent::of_component(component), 1.0);
    assert_eq!(
        [0, 1, 2, 3].map(|component| along(component).is_some()),
        [false, true, false, true]
    );
    assert!(matches!(
        along(1),
        Some(Undefined::Held { surface: 0, t: 0.0 })
    ));
    // With any coefficient but 0 the ball bounces.
    let (_, start) = over_bumps();
    let ball = BUMPS.with([("e", 0.0)]);
    let by = |parameter| undefined(&ball, start, None, Tangent::of_parameter(parameter), 2.0);
    assert_eq!(
        [0, 1, 2, 3, 4].map(|k| by(k).is_some()),
        [false, false, false, true, false]
    );
}

#[test]
fn what_ends_accumulating_impacts_has_no_derivative() {
    let (hill, start) = on_hill([0.1, 0.3], [0.3, 0.2]);
    let found = undefined(
        &hill,
        start,
        Some(Law::Newton(0.3)),
        Tangent::of_component(0),
        3.0,
    );
    let seen = turns(course(&hill, start, Some(Law::Newton(0.3)), 3.0));
    assert_eq!(seen, [1, 0]);
    assert!(
        matches!(found, Some(Undefined::Held { surface: 0, t }) if t > 1.0),
        "{found:?}"
    );
}
