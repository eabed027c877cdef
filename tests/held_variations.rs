//! First variations of runs that surfaces hold for a while, and of impacts with instantaneous constraints.

use dalembert::contract::Variational;
use dalembert::variations::Undefined;
use dalembert::{
    Described, Dop853, Law, Observer, Policies, Rest, Scene, SceneEffects, Simulation, StateVector,
    Stepper, System, Tangent, Taylor, Tolerance, Variations,
};
use dalembert_tests::differences::{self, Turns};

dalembert::model! {
    /// A point that lands on a hill which rises, slides along it, and leaves it where it would have to pull.
    Hill {
        coordinates { x; y; }
        parameters { g > 0 = 1; c > 0 = 1/50; w = 1/20; m > 0 = 2; b = 1/10; }
        lagrangian = m*(dot(x)^2 + dot(y)^2)/2 + b*x*dot(x)*dot(y) - m*g*y;
        impacts { hill: y >= -c*x^4 + w*t => impact_plastic; }
    }
}

dalembert::model! {
    /// A ball that is steered, on a bumpy slope that it does not slip on while it touches it; the slope is a belt that runs.
    Bumps {
        coordinates { x; y; a; z; }
        parameters { g > 0 = 1; r = 1/2; c = 3/10; e in [0, 1] = 3/5; s = 1/5; }
        lagrangian = (dot(x)^2 + dot(y)^2 + 2/5*r^2*dot(a)^2 + (1 + x^2/5)*dot(z)^2)/2 - g*y + x*z/7;
        constraints { steered: dot(z) - c*y*dot(x) = 0; }
        impacts {
            slope: y >= c*sin(x) => newton(e), instantaneous { no_slip: dot(x) + s*y*dot(y) = r*dot(a) + s; };
            lid: y <= 1;
        }
    }
}

/// The end of a run that may rest on surfaces, all with this law if one is given, and how many impacts there were.
fn end<S: Scene + System + dalembert::TaylorField>(
    system: &S,
    start: &S::State,
    law: Option<Law>,
    until: f64,
    seen: &mut impl Observer<S>,
) -> (S::State, u64) {
    let stepper = Taylor::new(Tolerance::new(1e-15).expect("a tolerance"));
    end_of(system, start, stepper, law, until, seen)
}

fn end_of<S: Scene + System>(
    system: &S,
    start: &S::State,
    stepper: impl Stepper<S>,
    law: Option<Law>,
    until: f64,
    seen: &mut impl Observer<S>,
) -> (S::State, u64) {
    let mut effects = system.effects();
    effects.set_projection(false);
    effects.set_policies(Policies {
        rest: Rest::Contact,
        ..Policies::default()
    });
    if let Some(law) = law {
        effects.set_law(0, law);
    }
    let run = Simulation::new(system, stepper, effects)
        .run(0.0, *start, until, seen)
        .expect("a start");
    assert!(run.outcome.is_done(), "{}", run.outcome);
    (run.state, run.counters.impacts)
}

/// Derivatives against differences of runs in which motion begins to be held, and ceases to be, so often.
fn check_differences<S>(system: S, start: S::State, law: Option<Law>, until: f64, turns: [usize; 2])
where
    S: Described + Scene + Variational,
{
    let mut seen = Turns::default();
    end(&system, &start, law, until, &mut seen);
    assert_eq!(seen.0, turns, "{} until {until}", S::DESCRIPTION.name);
    let run = |system: &S, start: &S::State, mut seen: &mut dyn Observer<S>| {
        end(system, start, law, until, &mut seen)
    };
    let impacts = differences::check_differences(system, start, S::State::CAPACITY, run);
    assert!(impacts > 0, "{}", S::DESCRIPTION.name);
}

fn on_hill(q: [f64; 2], qdot: [f64; 2]) -> (Hill, <Hill as dalembert::VectorField>::State) {
    let hill = Hill::default();
    (
        hill,
        hill.state(0.0, &q.into(), &qdot.into()).expect("a state"),
    )
}

fn over_bumps() -> (Bumps, <Bumps as dalembert::VectorField>::State) {
    let ball = Bumps::default();
    let qdot = [0.7, 0.2, 1.0, 0.3 * 0.9 * 0.7];
    let state = ball.state(0.0, &[0.1, 0.9, 0.0, 0.2].into(), &qdot.into());
    (ball, state.expect("a state"))
}

#[test]
fn motion_along_a_surface_has_its_derivative() {
    let (hill, start) = on_hill([0.1, 0.3], [0.7, 0.2]);
    check_differences(hill, start, None, 1.5, [1, 0]);
    check_differences(hill, start, None, 4.0, [1, 1]);
}

#[test]
fn loose_runs_have_derivatives_as_good_as_they_are() {
    let (hill, start) = on_hill([0.1, 0.3], [0.7, 0.2]);
    let columns = |tolerance: f64| {
        let mut columns = [0, 1, 2, 3].map(Tangent::of_component);
        let mut variations = Variations::new(&hill, &mut columns);
        let stepper = Dop853::new(Tolerance::new(tolerance).expect("a tolerance"));
        end_of(&hill, &start, stepper, None, 4.0, &mut variations);
        variations.tangents().expect("derivatives");
        columns.map(|column| column.state)
    };
    let sharp = columns(1e-13);
    for tolerance in [1e-5, 1e-8] {
        for (loose, sharp) in columns(tolerance).iter().zip(&sharp) {
            let error = (loose - sharp).amax() / sharp.amax();
            println!("{tolerance:e}: {error:e}");
            assert!(error <= 0.1 * tolerance, "{tolerance:e}: {error:e}");
        }
    }
}

#[test]
fn instantaneous_constraints_have_their_derivative() {
    let (ball, start) = over_bumps();
    check_differences(ball, start, None, 2.7, [0, 0]);
    check_differences(ball, start, Some(Law::Elastic), 2.7, [0, 0]);
    // It rolls along the slope, and its constraint goes on holding.
    check_differences(ball, start, Some(Law::ImpactPlastic), 4.0, [1, 0]);
}

fn undefined<S: Scene + System + Variational>(
    system: &S,
    start: &S::State,
    law: Option<Law>,
    direction: Tangent<S>,
    until: f64,
) -> Option<Undefined> {
    let mut columns = [direction];
    let mut variations = Variations::new(system, &mut columns);
    end(system, start, law, until, &mut variations);
    variations.tangents().err()
}

#[test]
fn neighbours_that_are_not_held_have_no_derivative() {
    // At rest on the hill at the start: neighbours along it are held, those above fall onto it later.
    let hill = Hill {
        w: 0.0,
        b: 0.0,
        ..Hill::default()
    };
    let at =
        |q: [f64; 2], qdot: [f64; 2]| hill.state(0.0, &q.into(), &qdot.into()).expect("a state");
    let start = at([0.0, 0.0], [0.3, 0.0]);
    let along = |component| undefined(&hill, &start, None, Tangent::of_component(component), 1.0);
    assert_eq!(
        [0, 1, 2, 3].map(|component| along(component).is_some()),
        [false, true, false, true]
    );
    assert!(matches!(
        along(1),
        Some(Undefined::Held { surface: 0, t: 0.0 })
    ));
    // Any coefficient but 0 lets it bounce.
    let (ball, start) = over_bumps();
    let ball = Bumps { e: 0.0, ..ball };
    let by = |parameter| undefined(&ball, &start, None, Tangent::of_parameter(parameter), 2.0);
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
        &start,
        Some(Law::Newton(0.3)),
        Tangent::of_component(0),
        3.0,
    );
    let mut seen = Turns::default();
    end(&hill, &start, Some(Law::Newton(0.3)), 3.0, &mut seen);
    assert_eq!(seen.0, [1, 0]);
    assert!(
        matches!(found, Some(Undefined::Held { surface: 0, t }) if t > 1.0),
        "{found:?}"
    );
}
