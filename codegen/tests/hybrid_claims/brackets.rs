//! Brackets by differences of functions of `(q, p)` that are made constant along the constraint forces, and what is printed of them.

use dalembert_codegen::mechanics::{Bracket, bracket::derive_bracket, derive};
use dalembert_codegen::model::{Model, Statement, check};
use dalembert_codegen::report::{BracketKind, bracket};
use dalembert_codegen::{read, spec};
use dalembert_expr::{ExprId, SymbolId};

use crate::systems::disk;

const STEP: f64 = 1e-5;

/// Coordinates in a plane that turns and is charged, with a knife edge that is dragged along.
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
    let spec::Declaration::Model(spec) = read(source.parse().expect("tokens")).expect("syntax")
    else {
        panic!("no model in one piece");
    };
    let mut model = check(&spec).expect("a model");
    let derivation = derive(&mut model);
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

type Row = Vec<f64>;

impl Case {
    fn value(&self, id: ExprId, state: &[(SymbolId, f64)]) -> f64 {
        let known = |symbol: SymbolId| {
            let given = state.iter().find(|(key, _)| *key == symbol);
            let parameter = || {
                let mut parameters = self.model.parameters.iter();
                let default = parameters.find(|own| own.symbol == symbol)?.default?;
                Some(self.model.pool.eval(&[default], &|_| f64::NAN)[0])
            };
            given
                .map(|(_, value)| *value)
                .or_else(parameter)
                .unwrap_or(f64::NAN)
        };
        self.model.pool.eval(&[id], &known)[0]
    }

    fn at(&self, q: &[f64]) -> Vec<(SymbolId, f64)> {
        let symbols = self.model.coordinates.iter().map(|own| own.q);
        symbols.zip(q.iter().copied()).collect()
    }

    /// Metric, `A`, constraint forms and their affine parts.
    fn matrices(&self, q: &[f64]) -> (Vec<Row>, Row, Vec<Row>, Row) {
        let at = self.at(q);
        let row = |row: &Vec<ExprId>| row.iter().map(|id| self.value(*id, &at)).collect::<Row>();
        let lagrangian = &self.model.lagrangian;
        let constraints = &self.model.constraints;
        (
            lagrangian.metric.iter().map(row).collect(),
            row(&lagrangian.linear),
            constraints.iter().map(|own| row(&own.form)).collect(),
            constraints
                .iter()
                .map(|own| self.value(own.affine, &at))
                .collect(),
        )
    }

    /// The velocity in D of a momentum: that of `g^{-1}(p - A)` projected along the constraint forces.
    fn velocity(&self, q: &[f64], p: &[f64]) -> Row {
        let (metric, linear, forms, affine) = self.matrices(q);
        let kinetic: Row = p.iter().zip(&linear).map(|(p, a)| p - a).collect();
        let mut v = solved(&metric, &kinetic);
        let duals: Vec<Row> = forms.iter().map(|form| solved(&metric, form)).collect();
        let mass: Vec<Row> = (forms.iter())
            .map(|form| duals.iter().map(|dual| inner(form, dual)).collect())
            .collect();
        let lost: Row = (forms.iter().zip(&affine))
            .map(|(form, affine)| inner(form, &v) + affine)
            .collect();
        let factors = solved(&mass, &lost);
        for (factor, dual) in factors.iter().zip(&duals) {
            for (entry, by) in v.iter_mut().zip(dual) {
                *entry -= factor * by;
            }
        }
        v
    }

    /// The function at the state in D that belongs to a momentum.
    fn projected(&self, function: ExprId, q: &[f64], p: &[f64]) -> f64 {
        let velocity = self.velocity(q, p);
        self.function(function, q, &velocity)
    }

    fn function(&self, function: ExprId, q: &[f64], velocity: &[f64]) -> f64 {
        let (metric, linear, ..) = self.matrices(q);
        let mut state = self.at(q);
        let symbols = self.model.coordinates.iter().map(|own| own.qdot);
        state.extend(symbols.zip(velocity.iter().copied()));
        let kinetic: f64 = metric
            .iter()
            .zip(velocity)
            .map(|(row, v)| v * inner(row, velocity))
            .sum();
        let potential = self.value(self.model.lagrangian.potential, &state);
        state.push((self.model.derived.energy, kinetic / 2.0 + potential));
        for (i, symbol) in self.model.derived.momenta.iter().enumerate() {
            state.push((*symbol, inner(&metric[i], velocity) + linear[i]));
        }
        self.value(function, &state)
    }

    /// `f_q g_p - f_p g_q` by central differences.
    fn by_differences(&self, [f, g]: [ExprId; 2], q: &[f64], p: &[f64]) -> f64 {
        let slope = |function: ExprId, i: usize, of_momentum: bool| {
            let [ahead, behind] = [STEP, -STEP].map(|step| {
                let (mut q, mut p) = (q.to_vec(), p.to_vec());
                if of_momentum {
                    p[i] += step
                } else {
                    q[i] += step
                }
                self.projected(function, &q, &p)
            });
            (ahead - behind) / (2.0 * STEP)
        };
        let term = |i: usize| {
            slope(f, i, false) * slope(g, i, true) - slope(f, i, true) * slope(g, i, false)
        };
        (0..q.len()).map(term).sum()
    }
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `matrix^{-1} right` of a positive matrix.
fn solved(matrix: &[Row], right: &[f64]) -> Row {
    let n = right.len();
    let mut rows: Vec<Row> = matrix
        .iter()
        .zip(right)
        .map(|(row, b)| [&row[..], &[*b]].concat())
        .collect();
    for i in 0..n {
        let pivot: Row = rows[i].iter().map(|entry| entry / rows[i][i]).collect();
        for (j, row) in rows.iter_mut().enumerate() {
            let factor = row[i];
            for (entry, by) in row.iter_mut().zip(&pivot) {
                if j != i {
                    *entry -= factor * by
                }
            }
        }
        rows[i] = pivot;
    }
    rows.iter().map(|row| row[n]).collect()
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
                // Differences are taken at a state on D.
                let (metric, linear, ..) = case.matrices(&q);
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
    // X_theta = (R cos phi, R sin phi, 1, 0) and X_phi = (0, 0, 0, 1) do not commute: by hand, with mu = (I + m R^2) dot(theta) and
    // nu = J dot(phi), {{x, mu}, nu} = {R cos phi, nu} = -R sin phi, and the two other terms are 0.
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
fn refusals_name_what_is_missing() {
    let refused = |source: &str, part: Option<&str>, functions: &str| {
        let source = source.replace("CLAIM", "");
        match bracket(&source, part, functions, BracketKind::Bracket) {
            Ok(report) => panic!("{}", report.text()),
            Err(error) => error.to_string(),
        }
    };
    for (functions, expected) in [
        ("x", "2 functions are needed, found 1"),
        ("x, y, z", "unknown name `z`"),
        ("x, x", "`x` twice"),
        ("x, momentum(y) +", "expected"),
        ("x, momentum(y); y", "expected"),
        ("x; }", "not a sequence of tokens"),
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
