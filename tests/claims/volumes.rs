//! Invariant volumes `exp(G) mu_C`. Lowered densities are compared with listed ones and with the divergence of the
//! motion by finite differences.

use dalembert::math::larger;
use dalembert::{Described, Instance};
use dalembert_codegen::claims::{Potential, Term, Volume};
use dalembert_codegen::model::Model;
use dalembert_codegen::program::{Guard, interpret::interpret, verify::verify};
use dalembert_declarations::visible::declaration;
use dalembert_expr::Rational;
use dalembert_tests::linear::determinant;
use dalembert_tests::reference::read;
use dalembert_tests::sampling::{Random, every_system};
use dalembert_tests::systems::MixedDisk;
use dalembert_tests::volume::{WithVolume, difference};
use serde_json::Value;

/// Every system of `verdicts_visible.json`, with its declaration.
fn systems() -> Vec<(Value, String)> {
    let file = read("verdicts_visible");
    let systems = file["systems"].as_array().expect("systems");
    let with_source = |system: &Value| (system.clone(), declaration(system));
    systems.iter().map(with_source).collect()
}

/// The declaration of the system of this name.
fn source_of(name: &str) -> String {
    let found = systems()
        .into_iter()
        .find(|(system, _)| system["name"] == name);
    found.expect("a system of this name").1
}

/// The declaration with the listed `G` as an output; `det(m)` becomes a parameter.
fn with_listed(source: &str, listed: &str) -> String {
    let formula = listed
        .replace("det(m)", "mass_determinant")
        .replace("**", "^");
    let source = source.replacen(
        "parameters { ",
        "parameters { mass_determinant > 0 = 1; ",
        1,
    );
    let body = source.trim_end().strip_suffix('}').expect("a declaration");
    format!("{body} outputs {{ listed: {formula}; }} }}")
}

/// The listed `G`, evaluated as an expression with `det m^{ab}` by elimination.
fn listed(system: &WithVolume, q: &[f64]) -> f64 {
    let [_, mass] = system.determinants(0.0, q);
    let output = system.model.outputs[0].value;
    let parameter = system.model.parameters[0].symbol;
    let value = |symbol| {
        let index = system
            .model
            .coordinates
            .iter()
            .position(|coordinate| coordinate.q == symbol);
        match index {
            Some(i) => q[i],
            None if symbol == parameter => mass,
            None => f64::NAN,
        }
    };
    system.model.pool.eval(&[output], &value)[0]
}

#[test]
fn densities_are_the_listed_ones() {
    let mut compared = 0;
    for (system, source) in systems() {
        let name = &system["name"];
        let Some(formula) = system["density"]["g"].as_str() else {
            assert_eq!(
                WithVolume::declared(&source).map(|system| system.volume),
                None,
                "{name}"
            );
            continue;
        };
        let Some(interpreted) = WithVolume::declared(&with_listed(&source, formula)) else {
            assert_ne!(system["density"]["valid"], "global", "{name}");
            continue;
        };
        assert_eq!(
            interpreted.volume.is_single_valued,
            system["density"]["valid"] == "global",
            "{name}"
        );
        let mut random = Random::new(11);
        // Densities may differ by a factor that is constant along D.
        let is_unique = interpreted.exactness.local.rank == interpreted.model.coordinates.len();
        for _ in 0..5 {
            let q = interpreted.configuration(&mut random);
            let (found, expected) = if is_unique {
                let other = interpreted.configuration(&mut random);
                (
                    interpreted.log_density(0.0, &q) - interpreted.log_density(0.0, &other),
                    listed(&interpreted, &q) - listed(&interpreted, &other),
                )
            } else {
                let independent: Vec<f64> = q.iter().map(|_| random.within(-1.0, 1.0)).collect();
                let qdot = interpreted.velocities(0.0, &q, &independent);
                let along = |shift: f64| -> Vec<f64> {
                    q.iter().zip(&qdot).map(|(x, v)| x + shift * v).collect()
                };
                (
                    difference(|shift| interpreted.log_density(0.0, &along(shift))),
                    difference(|shift| listed(&interpreted, &along(shift))),
                )
            };
            assert!(
                (found - expected).abs() < 1e-10,
                "{name}: {found} for {expected}"
            );
            compared += 1;
        }
    }
    assert!(compared >= 5 * 13, "{compared}");
}

/// The largest relative divergence of the motion at random states with respect to a volume.
fn divergence(system: &WithVolume, states: usize, log_volume: impl Fn(f64, &[f64]) -> f64) -> f64 {
    let mut random = Random::new(5);
    let count = system.model.coordinates.len() - system.volume.dependent.len();
    let at = |_| {
        let mut at = system.configuration(&mut random);
        at.extend((0..count).map(|_| random.within(-1.0, 1.0)));
        let [divergence, terms] = system.divergence(0.3, &at, &log_volume);
        divergence.abs() / terms.max(1.0)
    };
    (0..states).map(at).fold(0.0, larger)
}

fn own_divergence(system: &WithVolume, states: usize) -> f64 {
    divergence(system, states, |t, at| system.log_volume(t, at))
}

/// Bound on the error of a divergence by differences of eighth order.
const KEPT: f64 = 1e-10;

#[test]
fn volumes_are_kept() {
    let mut kept = 0;
    for (system, source) in systems() {
        let Some(interpreted) = WithVolume::declared(&source) else {
            continue;
        };
        let functions = interpreted.program.volume.as_ref().expect("functions");
        assert_eq!(verify(&functions.log_density), Ok(()));
        assert_eq!(verify(&functions.log_volume), Ok(()));
        let divergence = own_divergence(&interpreted, 6);
        assert!(divergence < KEPT, "{}: {divergence:e}", system["name"]);
        kept += 1;
    }
    assert!(kept >= 13, "{kept}");
}

/// Shipped models, and systems with affine constraints, dependence on time and forces.
#[test]
fn volumes_of_models_are_kept() {
    let mut kept = Vec::new();
    for description in every_system().iter().map(Instance::description) {
        // Long chains test nothing that short ones do not.
        if description.coordinates.len() > 6 {
            continue;
        }
        if let Some(interpreted) = WithVolume::declared(&description.source) {
            let divergence = own_divergence(&interpreted, 4);
            assert!(divergence < KEPT, "{}: {divergence:e}", description.name);
            kept.push(description.name);
        }
    }
    for name in [
        "ball_on_rotating_table",
        "chain4",
        "holonomic_bead_on_ellipses",
        "magnetic_disk",
        "rolling_disk",
        "two_wheels_rod",
    ] {
        assert!(kept.contains(&name), "{name} of {kept:?}");
    }
    for name in ["chaplygin_sleigh", "damped_sleigh"] {
        assert!(!kept.contains(&name), "{name}");
    }
}

/// A particle with growing mass. Metric and constraint depend on time.
const GROWING: &str = "Growing {
    coordinates { x; y; z; }
    parameters { a = 1/3; }
    lagrangian = (2 + t^2)/2*(dot(x)^2 + dot(y)^2 + dot(z)^2);
    constraints { lifted: (1 + t^4)*(d(z) - y*d(x)) - a*t*y*d(t) = 0; }
}";

#[test]
fn volumes_that_depend_on_time_are_kept() {
    let growing = WithVolume::declared(GROWING).expect("a volume");
    assert!(own_divergence(&growing, 6) < KEPT);
    let q = [0.3, 0.7, -0.2];
    assert!((growing.log_density(0.2, &q) - growing.log_density(1.2, &q)).abs() > 0.1);
    let frozen = divergence(&growing, 6, |_, at| growing.log_volume(0.3, at));
    assert!(frozen > 1e-3, "{frozen:e}");
}

/// W. Clark's thesis has a factor n, the number of coordinates, before `theta`. The motion does not keep densities with
/// this factor.
#[test]
fn a_factor_n_is_seen() {
    let mut seen = 0;
    for (system, source) in systems() {
        let scaled = WithVolume::with(&source, |model, _, found| {
            let n = model.coordinates.len() as i64;
            let factor = model.pool.number(Rational::from(n));
            let mut volume = found?;
            for (coefficient, _) in &mut volume.potential.terms {
                *coefficient = model.pool.mul(*coefficient, factor);
            }
            Some(volume)
        });
        let Some(interpreted) =
            scaled.filter(|interpreted| !interpreted.volume.potential.terms.is_empty())
        else {
            continue;
        };
        let divergence = own_divergence(&interpreted, 6);
        assert!(divergence > 1e-3, "{}: {divergence:e}", system["name"]);
        seen += 1;
    }
    assert!(seen >= 7, "{seen}");
}

fn columns(forms: &[Vec<f64>], columns: &[usize]) -> Vec<Vec<f64>> {
    let row = |form: &Vec<f64>| columns.iter().map(|&j| form[j]).collect();
    forms.iter().map(row).collect()
}

#[test]
fn mixed_constraints_have_the_same_volume() {
    let mixed = WithVolume::declared(MixedDisk::DESCRIPTION.source.value()).expect("a volume");
    assert_eq!(mixed.volume.dependent, [1, 2]);
    assert!(own_divergence(&mixed, 6) < KEPT);
    let without_minor =
        |t: f64, at: &[f64]| mixed.log_density(t, at) + mixed.determinants(t, &at[..4])[0].ln();
    assert!(divergence(&mixed, 6, without_minor) > 1e-3);
    // mu_C is divided by the determinant of the matrix that mixes the constraints. The density of the plain disk is
    // constant.
    let mixture = |q: &[f64]| ((2.0 + q[0] * q[0]) * (1.0 + q[1] * q[1]) - q[1] * q[2].sin()).ln();
    let mut random = Random::new(8);
    let reference = mixed.configuration(&mut random);
    for _ in 0..5 {
        let q = mixed.configuration(&mut random);
        let found = mixed.log_density(0.0, &q) - mixed.log_density(0.0, &reference);
        let expected = mixture(&q) - mixture(&reference);
        assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
    }
}

/// A volume with every kind of term, which is not invariant.
fn of_all_kinds(model: &mut Model, dependent: &[usize]) -> Volume {
    let [x, y] = [0, 1].map(|i| model.pool.variable(model.coordinates[i].q));
    let radius = model.pool.variable(model.parameters[1].symbol);
    let negative = model.pool.neg(x);
    let coefficient = |model: &mut Model, n, d| model.pool.number(Rational::new(n, d));
    let terms = vec![
        (coefficient(model, 1, 2), Term::MassDeterminant),
        (coefficient(model, -3, 1), Term::MetricDeterminant),
        (coefficient(model, 2, 7), Term::DependentDeterminant),
        (radius, Term::Logarithm(negative)),
        (coefficient(model, 5, 1), Term::Plain(y)),
    ];
    Volume {
        potential: Potential { terms },
        minor: vec![1, 2],
        integral: None,
        dependent: dependent.to_vec(),
        is_single_valued: true,
    }
}

#[test]
fn every_term_is_lowered() {
    for dependent in [[0, 1], [0, 2], [1, 2]] {
        let choose = |model: &mut Model, _: &_, _| Some(of_all_kinds(model, &dependent));
        let mixed = WithVolume::with(MixedDisk::DESCRIPTION.source.value(), choose)
            .expect("the volume given");
        let mut random = Random::new(9);
        let q = mixed.configuration(&mut random);
        let [metric, mass] = mixed.determinants(0.0, &q);
        let forms = mixed.forms(0.0, &q);
        let minor = |chosen: &[usize]| determinant(&columns(&forms, chosen)).abs().ln();
        let density = 0.5 * mass.ln() - 3.0 * metric.ln()
            + 2.0 / 7.0 * minor(&[1, 2])
            + 0.5 * q[0].abs().ln()
            + 5.0 * q[1];
        let volume = density + metric.ln() - minor(&dependent);
        assert!((mixed.log_density(0.0, &q) - density).abs() < 1e-12);
        assert!((mixed.log_volume(0.0, &q) - volume).abs() < 1e-12);
    }
}

#[test]
fn a_singular_minor_is_a_fault() {
    let disk = WithVolume::declared(MixedDisk::DESCRIPTION.source.value()).expect("a volume");
    let functions = disk.program.volume.as_ref().expect("functions");
    // If the disk points along y, the constraints do not determine its rolling from its velocity along x and its spin.
    let q = [0.3, 0.4, 0.2, std::f64::consts::FRAC_PI_2];
    let at = disk.input(0.0, &q, &[], &[]);
    assert!(interpret(&functions.log_density, &at).is_ok());
    let fault = interpret(&functions.log_volume, &at);
    assert!(
        matches!(fault, Err(Guard::Constraint { constraint: 1, .. })),
        "{fault:?}"
    );
    let single = "Sample {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { slope: x*d(y) + y*d(z) = 0; }
    }";
    let particle = WithVolume::natural(single);
    assert_eq!(particle.volume.dependent, [2]);
    let functions = particle.program.volume.as_ref().expect("functions");
    let fault = interpret(
        &functions.log_volume,
        &particle.input(0.0, &[0.3, 0.0, 0.2], &[], &[]),
    );
    assert!(
        matches!(fault, Err(Guard::Constraint { constraint: 0, .. })),
        "{fault:?}"
    );
}

#[test]
fn everything_that_is_reported_includes_the_density() {
    let disk = WithVolume::declared(&source_of("falling_disk")).expect("a volume");
    let q = disk.configuration(&mut Random::new(4));
    let zero = vec![0.0; q.len()];
    let values = disk.run(&disk.program.geometry.function, 0.0, &q, &zero, &zero);
    let [density] = disk.reported("log_density", &values) else {
        panic!("no density");
    };
    assert_eq!(*density, disk.log_density(0.0, &q));
}
