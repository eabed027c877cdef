//! Tests of brackets. Their values are compared with finite differences of functions of `(q, p)` that are constant
//! along the constraint forces; their printed form is checked.

use dalembert_codegen::mechanics::{Bracket, bracket::derive_bracket};
use dalembert_codegen::model::{Model, Statement};
use dalembert_codegen::report::{BracketKind, bracket};
use dalembert_expr::ExprId;

use crate::derived;
use crate::systems::disk;
use crate::values::{Row, inner, matrices, moving, projected, solved, value};

const STEP: f64 = 1e-5;

/// Coordinates with a coupled metric and velocity-linear terms, and a knife edge with an affine constraint.
const DRAGGED: &str = "pub Dragged { coordinates { x; y; theta: angle; } parameters { a = 1/3; b = 3/4; v = 2/7; }
    lagrangian = (2 + x^2)*dot(x)^2/2 + dot(y)^2 + dot(theta)^2/3 + a*cos(theta)*dot(x)*dot(theta) + b*x*dot(y) - x*y;
    constraints { blade: dot(y)*cos(theta) = dot(x)*sin(theta) + v*x; } CLAIM }";

/// Two links with metric terms in both angles.
const LINKS: &str = "pub Links { coordinates { x: angle; y: angle; } parameters { b = 1/2; }
    lagrangian = dot(x)^2 + dot(y)^2 + b*dot(x)*dot(y)*cos(x - y) + cos(x) + sin(x)*dot(y); CLAIM }";

/// No choice of dependent velocities is regular everywhere.
const CURVED: &str = "pub Curved { coordinates { x; y; z; w; }
    lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2 + (1 + y^2)*dot(w)^2)/2;
    constraints { one: x*dot(y) + (y + w)*dot(z) = z*dot(w); } CLAIM }";

struct Case {
    model: Model,
    bracket: Bracket,
    functions: Vec<ExprId>,
}

fn case(declaration: &str, functions: &str) -> Case {
    let source = declaration.replace("CLAIM", &format!("claims {{ involution: {functions}; }}"));
    let (mut model, derivation) = derived(&source);
    let bracket = derive_bracket(&mut model, &derivation).expect("a bracket");
    let Statement::Involution(stated) = &model.claims[0].statement else {
        panic!("another claim");
    };
    let functions = stated.iter().map(|function| function.value).collect();
    Case {
        model,
        bracket,
        functions,
    }
}

impl Case {
    /// The velocity in D that belongs to a momentum.
    fn velocity(&self, q: &[f64], p: &[f64]) -> Row {
        let (metric, linear, ..) = matrices(&self.model, q);
        let kinetic: Row = p.iter().zip(&linear).map(|(p, a)| p - a).collect();
        projected(&self.model, q, solved(&metric, &kinetic))
    }

    fn function(&self, function: ExprId, q: &[f64], velocity: &[f64]) -> f64 {
        let (metric, linear, ..) = matrices(&self.model, q);
        let mut state = moving(&self.model, q, velocity);
        let lowered: Row = metric.iter().map(|row| inner(row, velocity)).collect();
        let potential = value(&self.model, self.model.lagrangian.potential, &state);
        let energy = inner(&lowered, velocity) / 2.0 + potential;
        state.push((self.model.derived.energy, energy));
        let momenta = self
            .model
            .derived
            .momenta
            .iter()
            .zip(lowered.iter().zip(&linear));
        state.extend(momenta.map(|(symbol, (p, a))| (*symbol, p + a)));
        value(&self.model, function, &state)
    }

    /// `f_q g_p - f_p g_q` by central differences. The functions are evaluated at the velocity in D that belongs to the
    /// momentum.
    fn by_differences(&self, [f, g]: [ExprId; 2], q: &[f64], p: &[f64]) -> f64 {
        let slope = |function: ExprId, i: usize, of_momentum: bool| {
            let [ahead, behind] = [STEP, -STEP].map(|step| {
                let (mut q, mut p) = (q.to_vec(), p.to_vec());
                match of_momentum {
                    true => p[i] += step,
                    false => q[i] += step,
                }
                self.function(function, &q, &self.velocity(&q, &p))
            });
            (ahead - behind) / (2.0 * STEP)
        };
        let term = |i: usize| {
            slope(f, i, false) * slope(g, i, true) - slope(f, i, true) * slope(g, i, false)
        };
        (0..q.len()).map(term).sum()
    }
}

#[track_caller]
fn compare(declaration: &str, functions: &str) {
    let mut case = case(declaration, functions);
    let on_d: Vec<_> = (case.functions.iter())
        .map(|function| case.bracket.on_d(&mut case.model.pool, *function))
        .collect();
    for (i, first) in on_d.iter().enumerate() {
        for (j, second) in on_d.iter().enumerate() {
            let pool = &mut case.model.pool;
            let value = case.bracket.between(pool, first, second);
            let value = case.bracket.written(pool, value);
            for sample in 0..3 {
                let number = |k: usize| (0.618 * (k * (sample + 2) + 3) as f64).sin();
                let n = case.model.coordinates.len();
                let q: Row = (0..n).map(number).collect();
                let p: Row = (n..2 * n).map(number).collect();
                let velocity = case.velocity(&q, &p);
                let derived = case.function(value, &q, &velocity);
                // The differences need a state on D.
                let (metric, linear, ..) = matrices(&case.model, &q);
                let p: Row = (0..n)
                    .map(|i| inner(&metric[i], &velocity) + linear[i])
                    .collect();
                let pair = [case.functions[i], case.functions[j]];
                let expected = case.by_differences(pair, &q, &p);
                assert!(
                    (derived - expected).abs() <= 1e-7 * (1.0 + expected.abs()),
                    "{functions}: {i}, {j}: {derived} instead of {expected}"
                );
            }
        }
    }
}

#[test]
fn brackets_are_those_of_projected_functions() {
    compare(
        &disk(""),
        "x, phi, momentum(theta), dot(y)*dot(phi), energy, momentum(x)",
    );
    compare(
        LINKS,
        "sin(x), momentum(x), dot(y), energy, dot(x)*cos(y)^2, momentum(y)",
    );
    compare(
        DRAGGED,
        "x, theta, momentum(x), dot(theta), energy, dot(x)*y, momentum(theta)*x",
    );
    compare(CURVED, "x*z, w, momentum(x), dot(w)*y, energy, momentum(z)");
}

/// The printed right side of the only formula.
fn printed(declaration: &str, functions: &str, kind: BracketKind) -> String {
    let source = declaration.replace("CLAIM", "");
    let report = bracket(&source, None, functions, kind).expect("a report");
    let text = report.text();
    let line = text
        .lines()
        .find(|line| line.contains(" = ") && line.starts_with("  "));
    line.and_then(|line| line.split_once(" = "))
        .expect("a formula")
        .1
        .to_owned()
}

#[test]
fn the_jacobiator_of_models_without_constraints_is_0() {
    for functions in [
        "momentum(x), dot(y), sin(x)*dot(x)",
        "dot(x), dot(y), sin(y)*dot(x)",
        "energy, dot(x), sin(y)*momentum(y)",
    ] {
        assert_eq!(printed(LINKS, functions, BracketKind::Jacobiator), "0");
    }
}

#[test]
fn the_jacobiator_of_a_rolling_disk_is_not_0() {
    // X_theta = (R cos phi, R sin phi, 1, 0) and X_phi = (0, 0, 0, 1) do not commute. By hand, with mu = (I + m R^2)
    // dot(theta) and nu = J dot(phi): {{x, mu}, nu} = {R cos phi, nu} = -R sin phi, and the two other terms are 0.
    let with = |functions: &str| printed(&disk(""), functions, BracketKind::Jacobiator);
    assert_eq!(with("x, (I + m*R^2)*dot(theta), J*dot(phi)"), "-R*sin(phi)");
    assert_eq!(with("x, y, momentum(theta)"), "0");
}

#[test]
fn brackets_are_printed_in_velocities() {
    let with = |functions: &str| printed(&disk(""), functions, BracketKind::Bracket);
    assert_eq!(with("x, momentum(x)"), "m*R^2*cos(phi)^2/(I + m*R^2)");
    assert_eq!(with("phi, momentum(phi)"), "1");
    assert_eq!(with("x, energy"), "R*dot(theta)*cos(phi)");
    let links = printed(LINKS, "momentum(x), energy", BracketKind::Bracket);
    assert_eq!(links, "dot(y)*cos(x) - sin(x) - b*dot(x)*dot(y)*sin(x - y)");
}

#[test]
fn refusals_name_the_mistake() {
    let refused = |source: &str, part: Option<&str>, functions: &str| {
        let source = source.replace("CLAIM", "");
        match bracket(&source, part, functions, BracketKind::Bracket) {
            Ok(report) => panic!("{}", report.text()),
            Err(error) => error.to_string(),
        }
    };
    for (functions, expected) in [
        ("x", "2 functions are needed, found 1"),
        (" ", "the list is empty"),
        ("x; y", "`;` does not separate the entries of a list"),
        ("x, y, z", "unknown name `z`"),
        ("x, x", "`x` twice"),
        ("x, momentum(y) +", "expected"),
        (
            "x, momentum(y); y",
            "`;` does not separate the entries of a list",
        ),
        ("x, }", "not a sequence of tokens"),
    ] {
        let text = refused(&disk(""), None, functions);
        assert!(text.contains(expected), "{functions}: {text}");
    }
    let field = "pub F { coordinates { x; y; } field { dot(x) = y; dot(y) = -x; } }";
    let text = refused(field, None, "x, y");
    assert!(text.contains("bracket"), "{text}");
    let bent = "pub B { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { speed: dot(x)^2 + dot(y)^2 = 1; } }";
    let text = refused(bent, None, "x, y");
    assert!(text.contains("not linear"), "{text}");
}
