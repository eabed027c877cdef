//! Compares verdicts on invariant densities with `reference/verdicts_visible.json`, and with independent computations
//! of the criterion: as expressions, and as mean curvature by finite differences.

use dalembert_codegen::claims::exactness::decide_local_in;
use dalembert_codegen::claims::{Obstruction, Potential, Term, geometry_at};
use dalembert_declarations::visible::{declaration, visible_systems};
use dalembert_expr::{ExprId, Function, Pool, Rational, Verdict};
use dalembert_tests::curvature::Curved;
use dalembert_tests::reference::{number, numbers};
use dalembert_tests::symbolic::Geometry;
use dalembert_tests::verdict::{Decided, Existence};
use serde_json::Value;

/// Every system of the file with its declaration, decided.
fn decided() -> impl Iterator<Item = (Value, Decided)> {
    visible_systems().into_iter().map(|system| {
        let decided = Decided::of(&declaration(&system));
        (system, decided)
    })
}

#[test]
fn verdicts_hull_ranks_and_growth_agree() {
    for (system, decided) in decided() {
        let (name, verdict, local) = (
            &system["name"],
            &system["verdict"],
            &decided.exactness().local,
        );
        let global = decided.existence() == Existence::Global;
        assert_eq!(Value::Bool(local.exists), verdict["local_exists"], "{name}");
        assert_eq!(Value::Bool(global), verdict["global_exists"], "{name}");
        assert_eq!(Value::from(local.rank), verdict["hull_rank"], "{name}");
        assert_eq!(
            Value::from(local.extended_rank),
            verdict["extended_hull_rank"],
            "{name}"
        );
        assert_eq!(
            Value::from(local.growth.clone()),
            verdict["generic_growth"],
            "{name}"
        );
    }
}

#[test]
fn theta_on_the_frame_agrees() {
    for (system, decided) in decided() {
        let geometry = geometry_at(
            &decided.model.pool,
            &decided.problem,
            &decided.golden_point(&system),
            Some(&decided.golden_dependent(&system)),
        )
        .expect("a regular point");
        let expected = numbers(&system["golden"]["theta_on_frame"]);
        assert_eq!(geometry.demands.len(), expected.len());
        for (found, expected) in geometry.demands.iter().zip(expected) {
            let size = f64::max(expected.abs(), 1.0);
            assert!(
                (found - expected).abs() <= 1e-10 * size,
                "{}: {found} for {expected}",
                system["name"]
            );
        }
    }
}

/// The obstruction of a system at the point of the file, in the frame of the file.
fn golden_obstruction(system: &Value, decided: &Decided) -> Option<Obstruction> {
    let Decided { model, problem, .. } = decided;
    let dependent = decided.golden_dependent(system);
    let local = decide_local_in(&model.pool, problem, &dependent, 1).expect("a verdict");
    Obstruction::at(model, problem, &local, &decided.golden_point(system))
}

#[test]
fn obstructions_agree() {
    let mut seen = 0;
    for (system, decided) in decided() {
        let (name, expected) = (&system["name"], &system["golden"]["obstruction"]);
        let found = golden_obstruction(&system, &decided);
        assert_eq!(found.is_some(), !expected.is_null(), "{name}");
        let Some(found) = found else { continue };
        seen += 1;
        assert_eq!(found.bracket, expected["bracket"], "{name}");
        let close = |found: f64, expected: f64| {
            let size = f64::max(expected.abs(), 1.0);
            assert!(
                (found - expected).abs() <= 1e-8 * size,
                "{name}: {found} for {expected}"
            );
        };
        close(found.delta, number(&expected["delta"]));
        for (element, expected) in expected["relation"].as_object().expect("a relation") {
            let term = found.relation.iter().find(|(name, _)| name == element);
            close(
                term.map_or(0.0, |(_, coefficient)| *coefficient),
                number(expected),
            );
        }
    }
    assert!(seen >= 4);
}

/// Brackets by finite differences satisfy the relation of the obstruction: the vector fields cancel, and the demands
/// leave `delta`.
#[test]
fn obstructions_are_those_of_the_mean_curvature() {
    for (system, decided) in decided() {
        let Some(found) = golden_obstruction(&system, &decided) else {
            continue;
        };
        let dependent = decided.golden_dependent(&system);
        let (model, values) = (&decided.model, decided.golden_point(&system));
        let curved = Curved::new(model, &decided.derivation, &values, &dependent);
        let q: Vec<f64> = model
            .coordinates
            .iter()
            .map(|coordinate| {
                let found = values.iter().find(|(symbol, _)| *symbol == coordinate.q);
                found.expect("a value").1
            })
            .collect();
        let mut pair = curved.bracket(&q, &found.bracket);
        for (element, coefficient) in &found.relation {
            let other = curved.bracket(&q, element);
            pair.iter_mut()
                .zip(other)
                .for_each(|(entry, other)| *entry -= coefficient * other);
        }
        let delta = pair.pop().expect("a demand");
        let error = (delta - found.delta).abs();
        assert!(error < 1e-6 * found.scale, "{}: {delta}", system["name"]);
        assert!(
            pair.iter().all(|entry| entry.abs() < 1e-6),
            "{}: {pair:?}",
            system["name"]
        );
    }
}

/// The logarithm of a density of the file, as an expression.
fn listed_density(decided: &mut Decided, geometry: &Geometry, formula: &str) -> ExprId {
    let symbols: Vec<_> = decided
        .model
        .coordinates
        .iter()
        .map(|coordinate| coordinate.q)
        .collect();
    let pool = &mut decided.model.pool;
    let logarithm = |pool: &mut Pool, factor: Rational, of: ExprId| {
        let logarithm = pool.call(Function::Ln, of);
        pool.scale(&factor, logarithm)
    };
    match formula {
        "0" => pool.zero(),
        "(1/2)*ln(det(m))" => {
            let det = geometry.mass_determinant(pool);
            logarithm(pool, Rational::new(1, 2), det)
        }
        "(1)*ln(det(m))" => {
            let det = geometry.mass_determinant(pool);
            logarithm(pool, Rational::from(1), det)
        }
        "(1)*z + (1)*ln(x**2+4*y**2+9*z**2)" => {
            let [x, y, z] = [0, 1, 2].map(|i| pool.variable(symbols[i]));
            let square = |pool: &mut Pool, factor: i64, of: ExprId| {
                let square = pool.mul(of, of);
                pool.scale(&Rational::from(factor), square)
            };
            let squares = [(1, x), (4, y), (9, z)].map(|(factor, of)| square(pool, factor, of));
            let form = pool.sum(&squares);
            let logarithm = logarithm(pool, Rational::from(1), form);
            pool.add(z, logarithm)
        }
        // The file has k = 1/3 in place of the parameter.
        "(-1/3)*phi" => {
            let phi = pool.variable(symbols[0]);
            let k = decided.symbol("k");
            let pool = &mut decided.model.pool;
            let k = pool.variable(k);
            let product = pool.mul(k, phi);
            pool.neg(product)
        }
        other => panic!("a density of a new form: {other}"),
    }
}

#[test]
fn listed_densities_satisfy_the_criterion_in_symbols() {
    let mut seen = 0;
    for (system, mut decided) in decided() {
        let Some(formula) = system["density"]["g"].as_str() else {
            continue;
        };
        seen += 1;
        let geometry = Geometry::of(&mut decided.model, &decided.derivation);
        let density = listed_density(&mut decided, &geometry, formula);
        let dependent = decided.golden_dependent(&system);
        let pool = &mut decided.model.pool;
        for residual in geometry.residuals(pool, &dependent, density) {
            assert_eq!(
                pool.zero_test(residual),
                Verdict::Proved,
                "{}",
                system["name"]
            );
        }
        // The square of a nonconstant invariant density is not invariant.
        if !pool.is_syntactic_zero(density) {
            let twice = pool.scale(&Rational::from(2), density);
            let residuals = geometry.residuals(pool, &dependent, twice);
            let is_refuted = |residual: &ExprId| pool.zero_test(*residual) == Verdict::Refuted;
            assert!(residuals.iter().any(is_refuted), "{}", system["name"]);
        }
    }
    assert!(seen >= 15);
}

#[test]
fn densities_that_are_found_are_those_listed() {
    for (system, mut decided) in decided() {
        let Some(formula) = system["density"]["g"].as_str() else {
            continue;
        };
        // The density of the helical circle is many-valued, and its coefficient is a parameter.
        let Some((found, certified)) = decided.exactness().density.clone() else {
            assert_eq!(system["name"], "helical_circle");
            continue;
        };
        assert!(certified.error < 1e-60);
        let geometry = Geometry::of(&mut decided.model, &decided.derivation);
        let listed = listed_density(&mut decided, &geometry, formula);
        let dependent = decided.golden_dependent(&system);
        let pool = &mut decided.model.pool;
        let found = found_density(pool, &geometry, &dependent, &found);
        for residual in geometry.residuals(pool, &dependent, found) {
            assert_eq!(
                pool.zero_test(residual),
                Verdict::Proved,
                "{}",
                system["name"]
            );
        }
        // Densities are unique up to functions that are constant along D. These two differ by a constant.
        let difference = pool.sub(found, listed);
        for coordinate in &decided.model.coordinates {
            let slope = decided.model.pool.diff(difference, coordinate.q);
            assert_eq!(
                decided.model.pool.zero_test(slope),
                Verdict::Proved,
                "{}",
                system["name"]
            );
        }
    }
}

fn found_density(
    pool: &mut Pool,
    geometry: &Geometry,
    dependent: &[usize],
    found: &Potential,
) -> ExprId {
    let mut terms = Vec::new();
    for (coefficient, term) in &found.terms {
        let inside = match term {
            Term::MassDeterminant => geometry.mass_determinant(pool),
            Term::MetricDeterminant => geometry.metric_determinant(pool),
            Term::DependentDeterminant => geometry.dependent_determinant(pool, dependent),
            Term::Logarithm(f) | Term::Plain(f) => *f,
        };
        let value = match term {
            Term::Plain(_) => inside,
            _ => pool.call(Function::Ln, inside),
        };
        terms.push(pool.mul(*coefficient, value));
    }
    pool.sum(&terms)
}
