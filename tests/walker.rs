//! Compares the dimensionless walker with orbits and transients of 30 digits.

use core::ops::ControlFlow;

use dalembert::math::larger;
use dalembert::{Event, Observer, Outcome, VectorField};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, state};
use dalembert_stability::text::{Model, shipped, value};
use dalembert_tests::reference::{number, numbers, paired, read};
use serde_json::Value;

type State = <Model as VectorField>::State;

/// Times of steps with the states before and after them.
#[derive(Default)]
struct Steps(Vec<(f64, State, State)>);

impl Observer<Model> for Steps {
    fn event(&mut self, event: &Event<State>) -> ControlFlow<()> {
        self.0.push((event.t, event.before, event.after));
        ControlFlow::Continue(())
    }
}

fn walk(walker: &Model, integrator: Integrator, [xi, eta]: [f64; 2], until: f64) -> Steps {
    let mut steps = Steps::default();
    let start = state(walker, &[value(walker, "delta"), xi, eta], &[0.0; 3]);
    let run = Course::from_state(walker, start, until)
        .tol(1e-13)
        .observed(integrator, &mut steps);
    assert_eq!(run.outcome, Outcome::Done);
    steps
}

fn walker(set: &Value) -> Model {
    let names = ["mu", "eps", "alpha", "delta"];
    shipped("dimensionless_walker").with(names.map(|name| (name, number(&set[name]))))
}

fn pair(value: &Value) -> [f64; 2] {
    let values = numbers(value);
    [values[0], values[1]]
}

/// The largest difference from the stored steps of a walk.
fn error(steps: &Steps, stored: &[Value]) -> f64 {
    assert_eq!(steps.0.len(), stored.len());
    let mut largest = 0.0_f64;
    for ((t, before, after), stored) in steps.0.iter().zip(stored) {
        let mut compare =
            |found: f64, stored: f64| largest = larger(largest, (found - stored).abs());
        compare(*t, number(&stored["t"]));
        for (found, stored) in paired(before.as_ref(), &stored["before"]) {
            compare(found, stored);
        }
        for (found, stored) in paired(&after.as_ref()[1..], &stored["after(xi,eta)"]) {
            compare(found, stored);
        }
    }
    largest
}

#[test]
fn transients_are_the_stored_ones() {
    let file = read("walker_orbits");
    let sets = file["sets"].as_array().expect("sets");
    assert!(!sets.is_empty());
    for set in sets {
        let (walker, transient) = (walker(set), &set["transient"]);
        let start = pair(&transient["initial(xi,eta)"]);
        let stored = transient["steps"].as_array().expect("steps");
        let until = number(&stored[stored.len() - 1]["t"]) + 0.1;
        let of_taylor = error(&walk(&walker, Integrator::Taylor, start, until), stored);
        let of_dop853 = error(&walk(&walker, Integrator::Dop853, start, until), stored);
        assert!(
            of_taylor <= 1e-11 && of_dop853 <= 1e-11,
            "{of_taylor:e}, {of_dop853:e}"
        );
    }
}

#[test]
fn the_fixed_point_comes_back_after_a_period() {
    let file = read("walker_orbits");
    for set in file["sets"].as_array().expect("sets") {
        let (walker, period) = (walker(set), number(&set["period"]));
        let fixed = pair(&set["fixed_point_post_impact(xi,eta)"]);
        let steps = walk(&walker, Integrator::Taylor, fixed, 1.5 * period);
        let [(t, before, after)] = steps.0.as_slice() else {
            panic!("{} steps", steps.0.len());
        };
        assert!((t - period).abs() <= 1e-11, "{t} for {period}");
        for (found, stored) in paired(before.as_ref(), &set["state_before_impact"]) {
            assert!((found - stored).abs() <= 1e-11, "{found} for {stored}");
        }
        for (found, stored) in after.as_ref()[1..].iter().zip(fixed) {
            assert!((found - stored).abs() <= 1e-11, "{found} for {stored}");
        }
    }
}
