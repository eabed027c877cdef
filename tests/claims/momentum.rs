//! Densities that depend on velocities, compared with `reference/verdicts_visible.json`.

use std::time::Instant;

use dalembert_codegen::claims::{
    Dynamics, Exactness, Global, Problem, decide, find_momentum_density,
};
use dalembert_codegen::mechanics::{self, Derivation};
use dalembert_codegen::model::{self, Model};
use dalembert_codegen::spec;
use dalembert_declarations::visible::declaration;
use dalembert_expr::{RealPoint, SymbolId};
use dalembert_tests::reference::read;
use serde_json::Value;

/// Reads `|l|^(s) * det(m)^(k)` as `(l, s, k)`.
fn parts(formula: &str) -> (String, f64, f64) {
    let exponent = |text: &str| {
        let text = text.trim_start_matches('^').trim_matches(['(', ')']);
        match text.split_once('/') {
            Some((n, d)) => {
                n.parse::<f64>().expect("a number") / d.parse::<f64>().expect("a number")
            }
            None => text.parse().expect("a number"),
        }
    };
    let (_, rest) = formula.split_once('|').expect("a factor");
    let (factor, rest) = rest.split_once('|').expect("a factor");
    let (power, mass) = match rest.split_once(" * det(m)") {
        Some((power, mass)) => (power, exponent(mass)),
        None => (rest, 0.0),
    };
    (factor.to_owned(), exponent(power), mass)
}

/// Values of all symbols, spread between 0.35 and 1.28.
fn real_point(symbols: usize, attempt: usize) -> RealPoint {
    let value = |i: usize| 0.35 + ((i * 7 + attempt * 5) % 11) as f64 * 0.093;
    RealPoint::new((0..symbols).map(value).collect())
}

/// A model with the verdict on its density.
fn decided(source: &str) -> (Model, Derivation, Problem, Exactness) {
    let spec = spec::parse(source.parse().expect("tokens")).expect(source);
    let mut model = model::check(&spec).expect(source);
    let derivation = mechanics::derive(&mut model);
    let problem = Problem::of(&mut model, &derivation);
    let exactness = decide(&mut model, &problem, 1).expect("a verdict");
    (model, derivation, problem, exactness)
}

/// The number of expressions that a search for a density adds to the model. Asserts that the search finds a density if
/// and only if `is_found`.
fn expressions_of_search(source: &str, is_found: bool) -> usize {
    let (mut model, derivation, problem, exactness) = decided(source);
    let is_exact = exactness.global == Some(Global::Exists);
    assert_eq!(is_exact, !is_found, "{source}");
    let before = model.pool.len();
    let found = find_momentum_density(&mut model, &derivation, &problem, &exactness, 1);
    assert_eq!(found.expect("points").is_some(), is_found, "{source}");
    model.pool.len() - before
}

/// The density found for a model, as text.
fn found(source: &str) -> Option<String> {
    let (mut model, derivation, problem, exactness) = decided(source);
    let clock = Instant::now();
    let found = find_momentum_density(&mut model, &derivation, &problem, &exactness, 1);
    let text = found
        .expect("points")
        .map(|density| density.text(&model.pool));
    println!("{} {text:?} {:?}", model.name, clock.elapsed());
    text
}

fn check(system: &Value) {
    let name = &system["name"];
    let (factor, exponent, mass_exponent) =
        parts(system["momentum_density"]["f"].as_str().expect("a formula"));
    let mut factor = factor.clone();
    for coordinate in system["coordinates"].as_array().expect("coordinates") {
        let q = coordinate["name"].as_str().expect("a name");
        factor = factor.replace(&format!("{q}_dot"), &format!("dot({q})"));
    }
    let source = declaration(system);
    let source = format!(
        "{} outputs {{ factor: {factor}; }} }}",
        source.strip_suffix('}').expect("a body")
    );
    let (mut model, derivation, problem, exactness) = decided(&source);
    let clock = Instant::now();
    let found = find_momentum_density(&mut model, &derivation, &problem, &exactness, 1)
        .expect("points")
        .unwrap_or_else(|| panic!("{name}: nothing found"));
    println!("{name} {} {:?}", found.text(&model.pool), clock.elapsed());
    assert_eq!(found.exponent.to_f64(), exponent, "{name}");
    assert_eq!(found.mass_exponent.to_f64(), mass_exponent, "{name}");
    assert!(found.certified.error < 1e-60);
    // On D the found and the listed factor have a constant ratio.
    let dynamics = Dynamics::of(&mut model, &derivation);
    let ratio = |attempt| {
        let mut point = real_point(model.pool.symbol_count(), attempt);
        for parameter in &model.parameters {
            let default = parameter.default.expect("a default");
            point.set(parameter.symbol, model.pool.eval(&[default], &|_| 0.0)[0]);
        }
        dynamics
            .motion(&model.pool, &mut point, None)
            .expect("a regular point");
        let value = |symbol: SymbolId| point.value(symbol);
        let values = model
            .pool
            .eval(&[found.factor, model.outputs[0].value], &value);
        values[0] / values[1]
    };
    for attempt in 1..5 {
        assert!((ratio(attempt) / ratio(0) - 1.0).abs() < 1e-12, "{name}");
    }
}

#[test]
fn every_known_density_is_found_up_to_a_constant() {
    let file = read("verdicts_visible");
    let systems = file["systems"].as_array().expect("systems");
    let known: Vec<_> = systems
        .iter()
        .filter(|system| system.get("momentum_density").is_some())
        .collect();
    assert!(known.len() >= 4);
    known.into_iter().for_each(check);
}

/// A search adds expressions to the model, whether it finds a density or not.
#[test]
fn systems_with_a_density_of_the_configuration_are_not_searched() {
    let file = read("verdicts_visible");
    let systems = file["systems"].as_array().expect("systems").iter();
    let exact: Vec<_> = systems
        .clone()
        .filter(|system| system["verdict"]["global_exists"] == Value::Bool(true))
        .collect();
    assert!(exact.len() >= 10);
    for system in exact {
        let added = expressions_of_search(&declaration(system), false);
        assert_eq!(added, 0, "{}", system["name"]);
    }
    let mut systems = systems;
    let sleigh = systems.find(|system| system["name"] == "chaplygin_sleigh");
    let added = expressions_of_search(&declaration(sleigh.expect("a system")), true);
    assert!(added > 0);
}

/// A body with a blade at its origin, and a trailer with its axle at `(x1, y1)`.
fn trailer(inertia: &str) -> String {
    format!(
        "Trailer {{
            coordinates {{ x; y; theta0: angle; theta1: angle; }}
            parameters {{ m > 0 = 2; m1 > 0 = 1; I0 > 0 = 1; I1 > 0 = 1/2; l1 = 1/3; }}
            let x1 = x - l1*cos(theta1);
            let y1 = y - l1*sin(theta1);
            lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I0/2*dot(theta0)^2 + {inertia};
            constraints {{
                blade: -sin(theta0)*d(x) + cos(theta0)*d(y) = 0;
                trailer: -sin(theta1)*d(x1) + cos(theta1)*d(y1) = 0;
            }}
        }}"
    )
}

#[test]
fn the_rate_of_the_hitch_angle_is_the_factor() {
    let expected = Some("sqrt(det m)/abs(dot(theta0) - dot(theta1))".to_owned());
    assert_eq!(found(&trailer("I1/2*dot(theta1)^2")), expected);
    let massive = "m1/2*(dot(x1)^2 + dot(y1)^2) + I1/2*dot(theta1)^2";
    assert_eq!(found(&trailer(massive)), expected);
}

/// Engel's distribution with the flat metric. On D the factor is `(1 + y^2) xdot - z ydot`.
#[test]
fn coefficients_that_depend_on_coordinates_are_found() {
    let engel = "Engel {
        coordinates { x; y; z; w; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2 + dot(w)^2)/2;
        constraints { first: d(z) - y*d(x) = 0; second: d(w) - z*d(x) = 0; }
    }";
    let expected = "sqrt(det m)/abs(dot(x) + y*dot(z) - z*dot(y))";
    assert_eq!(found(engel).as_deref(), Some(expected));
}

/// For `dz = s dx` with `s` linear in x and y, the factor is the rate of `s`.
#[test]
fn coefficients_that_depend_on_parameters_are_found() {
    let particle = "Particle {
        coordinates { x; y; z; }
        parameters { k = 1/3; b = 2; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { blade: d(z) - (k*x + (1 + k*b)*y)*d(x) = 0; }
    }";
    let expected = "sqrt(det m)/abs(k*dot(x) + dot(y)*(k*b + 1))";
    assert_eq!(found(particle).as_deref(), Some(expected));
}

/// A wheeled robot with its centre of mass off the axle. Its density of the configuration is many-valued in the angles
/// of the wheels.
#[test]
fn a_density_on_the_covering_space_does_not_end_the_search() {
    let robot = "Robot {
        coordinates { x; y; theta: angle; psi1: angle; psi2: angle; }
        parameters { m > 0 = 2; I > 0 = 3; J > 0 = 1/2; a = 3/4; b > 0 = 1; r > 0 = 1/2; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I + m*a^2)/2*dot(theta)^2
            + a*m*dot(theta)*(-dot(x)*sin(theta) + dot(y)*cos(theta)) + J/2*(dot(psi1)^2 + dot(psi2)^2);
        constraints {
            blade: -sin(theta)*d(x) + cos(theta)*d(y) = 0;
            right: cos(theta)*d(x) + sin(theta)*d(y) + b*d(theta) - r*d(psi1) = 0;
            left: cos(theta)*d(x) + sin(theta)*d(y) - b*d(theta) - r*d(psi2) = 0;
        }
    }";
    assert_eq!(found(robot).as_deref(), Some("1/abs(dot(theta))"));
}

/// The torque of gravity leaves no power of `|thetadot|` as an invariant density. Friction contracts volumes.
#[test]
fn nothing_is_found_where_torque_or_friction_breaks_the_factor() {
    let sleigh = |potential: &str, forces: &str| {
        format!(
            "Sleigh {{
                coordinates {{ x; y; theta: angle; }}
                parameters {{ m > 0 = 2; I > 0 = 3; a = 3/4; g = 1; c > 0 = 1; }}
                lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I + m*a^2)/2*dot(theta)^2
                    + a*m*dot(theta)*(-dot(x)*sin(theta) + dot(y)*cos(theta)){potential};
                constraints {{ blade: -sin(theta)*d(x) + cos(theta)*d(y) = 0; }}
                {forces}
            }}"
        )
    };
    assert_eq!(found(&sleigh("", "")).as_deref(), Some("1/abs(dot(theta))"));
    assert_eq!(found(&sleigh(" - m*g*(x + a*cos(theta))", "")), None);
    let drag = "forces { drag: -c*(dot(x)*d(x) + dot(y)*d(y)); }";
    assert_eq!(found(&sleigh("", drag)), None);
}
