//! Compares the velocities, accelerations and multipliers on D that the claims use with independent values of 50
//! digits. Constraints and energy are checked modulo a prime.

use dalembert::Instance;
use dalembert::math::larger;
use dalembert_codegen::claims::Dynamics;
use dalembert_codegen::mechanics::{self, Derivation};
use dalembert_codegen::model::{self, Model};
use dalembert_codegen::spec;
use dalembert_expr::{ExprId, RealPoint, SamplePoints, SymbolId};
use dalembert_tests::reference::{number, numbers, read};
use dalembert_tests::sampling::system;

/// Bound on the error relative to the largest component, or to 1 if that is larger. The states of the files are rounded
/// to `f64`.
const TOLERANCE: f64 = 1e-12;

/// A model, its derivation and its dynamics on D, from the source text.
fn derive(name: &str) -> (Model, Derivation, Dynamics) {
    let spec = spec::parse(system(name).description().source.parse().expect("tokens"))
        .expect("a declaration");
    let mut model = model::check(&spec).expect("a model");
    let derivation = mechanics::derive(&mut model);
    let dynamics = Dynamics::of(&mut model, &derivation);
    (model, derivation, dynamics)
}

fn check(name: &str, file: &str) {
    let (model, _, dynamics) = derive(name);
    let file = read(file);
    let states = file["states"].as_array().expect("states");
    assert!(states.len() >= 3);
    for state in states {
        let mut point = RealPoint::default();
        let mut set = |symbols: Vec<SymbolId>, key: &str| {
            for (symbol, value) in symbols.into_iter().zip(numbers(&state[key])) {
                point.set(symbol, value);
            }
        };
        set(
            model
                .coordinates
                .iter()
                .map(|coordinate| coordinate.q)
                .collect(),
            "q",
        );
        set(
            model
                .coordinates
                .iter()
                .map(|coordinate| coordinate.qdot)
                .collect(),
            "qdot",
        );
        for parameter in &model.parameters {
            let default = model
                .pool
                .eval(&[parameter.default.expect("a default")], &|_| 0.0);
            point.set(parameter.symbol, default[0]);
        }
        point.set(model.time, state.get("t").map_or(0.0, number));
        let motion = dynamics
            .motion(&model.pool, &mut point, None)
            .expect("a regular point");
        for (found, key) in [
            (&motion.qdot, "qdot"),
            (&motion.qddot, "acceleration"),
            (&motion.multipliers, "multipliers"),
        ] {
            let expected = numbers(&state[key]);
            let size = expected
                .iter()
                .fold(1.0, |size: f64, value| larger(size, value.abs()));
            assert_eq!(found.len(), expected.len(), "{name} {key}");
            for (found, expected) in found.iter().zip(&expected) {
                let error = (found - expected).abs() / size;
                assert!(error <= TOLERANCE, "{name} {key}: {found} {expected}");
            }
        }
    }
}

/// The rates of expressions on D modulo a prime.
fn rates_modulo_a_prime(model: &Model, dynamics: &Dynamics, expressions: &[ExprId]) -> Vec<u64> {
    let profile = model.pool.profile_of(expressions);
    SamplePoints::seeded(&model.pool, expressions, &profile, 7)
        .expect("points")
        .find(&model.pool, |point| {
            let motion = dynamics.motion(&model.pool, point, None)?;
            dynamics.rates(&model.pool, expressions, &motion, point)
        })
        .expect("a regular point")
}

fn check_constraints(name: &str) {
    let (model, derivation, dynamics) = derive(name);
    let residuals: Vec<_> = derivation
        .constraints
        .iter()
        .map(|constraint| constraint.residual)
        .collect();
    let rates = rates_modulo_a_prime(&model, &dynamics, &residuals);
    assert_eq!(rates, vec![0; residuals.len()], "{name}");
}

/// Checks that `dE/dt = -d_t L + F(qdot) + lambda_a eta^a(qdot)` is 0 if `is_kept`, and is not 0 otherwise. It is 0 if
/// the Lagrangian does not depend on time, no force does work, and no constraint has an affine part.
fn check_energy(name: &str, is_kept: bool) {
    let (mut model, _, dynamics) = derive(name);
    let lagrangian = model.lagrangian.whole;
    let mut terms = vec![model.pool.neg(lagrangian)];
    for coordinate in model.coordinates.clone() {
        let momentum = model.pool.diff(lagrangian, coordinate.qdot);
        let velocity = model.pool.variable(coordinate.qdot);
        terms.push(model.pool.mul(velocity, momentum));
    }
    let energy = model.pool.sum(&terms);
    let rate = rates_modulo_a_prime(&model, &dynamics, &[energy])[0];
    assert_eq!(rate == 0, is_kept, "{name}");
}

#[test]
fn constraints_are_kept_modulo_a_prime() {
    check_constraints("chaplygin_sleigh");
    check_constraints("rolling_ball_euler");
    check_constraints("affine_sleigh");
    check_constraints("rheonomic");
}

#[test]
fn energy_is_kept_modulo_a_prime_where_nothing_changes_it() {
    check_energy("chaplygin_sleigh", true);
    check_energy("rolling_ball_euler", true);
    check_energy("magnetic_disk", true);
    check_energy("affine_sleigh", false);
    check_energy("damped_sleigh", false);
    check_energy("rheonomic", false);
}

macro_rules! agrees {
    ($($test:ident $system:literal $file:literal;)*) => {$(
        #[test]
        fn $test() {
            check($system, $file);
        }
    )*};
}

agrees! {
    chaplygin_sleigh_agrees "chaplygin_sleigh" "chaplygin_sleigh";
    rolling_disk_agrees "rolling_disk" "rolling_disk";
    rolling_ball_agrees "rolling_ball_euler" "rolling_ball_euler";
    two_wheels_agree "two_wheels_rod" "cv64_two_wheels";
    affine_sleigh_agrees "affine_sleigh" "affine_sleigh";
    table_wall_agrees "table_wall" "table_wall";
    magnetic_disk_agrees "magnetic_disk" "magnetic_disk";
    damped_sleigh_agrees "damped_sleigh" "damped_sleigh";
    integrable_bead_agrees "integrable_bead" "integrable_bead";
    rheonomic_agrees "rheonomic" "rheonomic";
}
