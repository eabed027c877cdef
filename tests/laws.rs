//! Properties of the impact laws at random states.

use dalembert::erased::Bounded;
use dalembert::law::{Blow, Law};
use dalembert::math::larger;
use dalembert::{Constrained, Impacting, Instance, StateVector, System, VectorField};
use dalembert_stability::text::{Large, Text};
use dalembert_tests::sampling::{states, system};

type State = <Large as VectorField>::State;

const LAWS: [Law; 4] = [
    Law::Elastic,
    Law::NonholonomicPlastic,
    Law::ImpactPlastic,
    Law::TotallyPlastic,
];

/// The state after an impact of a law on a surface.
fn apply(system: &Large, surface: usize, law: Law, state: &State) -> State {
    let contact = system.contact(surface, 0.0, state).expect("a contact");
    let mut after = *state;
    system.kick(&mut after, contact.impulse(law), &contact.direction);
    after
}

/// Checks the laws at walls at rest. For a law with the factor `c`, the gap rate `G` and the energy `H` satisfy
/// `G+ = (1 - c) G-` and `H+ - H- = -(c - c^2/2) G-^2 / dh(pi_D grad h)` on D. These equations are algebraic and hold
/// for positions off the surface as well.
fn check_linear(system: &Large) {
    for state in states(system, 20, 11) {
        for surface in 0..system.description().surfaces.len() {
            let contact = system.contact(surface, 0.0, &state).expect("a contact");
            let (rho, before) = (contact.rho(), contact.gap_rate);
            let energy = system.energy(0.0, &state).expect("an energy");
            for (law, c) in LAWS.into_iter().zip([2.0, 2.0 * rho, 1.0, rho]) {
                let after = apply(system, surface, law, &state);
                let rate = system.gap_rates(0.0, &after).expect("rates").as_slice()[surface];
                let scale = before.abs() + 1e-3;
                assert!(
                    (rate - (1.0 - c) * before).abs() < 1e-11 * scale,
                    "{}: {law}",
                    system.description().name
                );
                let change = system.energy(0.0, &after).expect("an energy") - energy;
                let expected =
                    -(c - c * c / 2.0) * before * before / contact.constrained_compliance;
                assert!(
                    (change - expected).abs() < 1e-11 * energy.abs(),
                    "{}: {law}",
                    system.description().name
                );
            }
            assert!(
                (0.0..=1.0 + 1e-12).contains(&rho),
                "{}: rho = {rho}",
                system.description().name
            );
        }
    }
}

#[test]
fn gap_rate_and_energy_change_as_each_law_says() {
    for name in [
        "rolling_disk",
        "chaplygin_sleigh",
        "rolling_ball_euler",
        "two_wheels_rod",
        "point_billiard",
        "damped_sleigh",
        "magnetic_disk",
    ] {
        check_linear(&system(name));
    }
}

/// Compares the function of the declared law, which computes fewer quantities than a contact, with the contact.
fn check_blows(system: &Large) {
    for state in states(system, 20, 14) {
        for surface in 0..system.description().surfaces.len() {
            let contact = system.contact(surface, 0.0, &state).expect("a contact");
            let expected = contact.blow(system.law(surface));
            let actual = system.blow(surface, 0.0, &state).expect("a blow");
            let whole = |blow: &Blow<<Large as System>::Impulse>| -> Vec<f64> {
                let direction = blow.direction.as_slice().iter();
                direction.map(|component| blow.size * component).collect()
            };
            let (expected_impulse, impulse) = (whole(&expected), whole(&actual));
            let size = expected_impulse
                .iter()
                .fold(0.0, |size: f64, value| larger(size, value.abs()));
            for (actual, expected) in impulse.iter().zip(&expected_impulse) {
                assert!(
                    (actual - expected).abs() < 1e-12 * size,
                    "{}: {actual} for {expected}",
                    system.description().name
                );
            }
            let taken = (actual.share - expected.share) * contact.gap_rate;
            assert!(
                taken.abs() < 1e-12 * (contact.gap_rate.abs() + contact.surface_rate.abs() + 1e-3),
                "{}: {} for {}",
                system.description().name,
                actual.share,
                expected.share
            );
        }
    }
}

#[test]
fn blows_are_those_of_the_contact_by_the_declared_law() {
    for name in [
        "rolling_disk",
        "chaplygin_sleigh",
        "rolling_ball_euler",
        "two_wheels_rod",
        "point_billiard",
        "holonomic_bead_on_ellipses",
        "bouncing_ball",
        "affine_sleigh",
        "damped_sleigh",
        "magnetic_disk",
        "table_wall",
    ] {
        check_blows(&system(name));
    }
    check_blows(&system("rolling_disk").global().expect("the global form"));
    check_blows(
        &system("chaplygin_sleigh")
            .global()
            .expect("the global form"),
    );
    check_blows(
        &system("rolling_ball_euler")
            .global()
            .expect("the global form"),
    );
}

/// Checks that every law keeps the constraints, including affine ones.
fn check_constraints(system: &Large) {
    for state in states(system, 20, 12) {
        for surface in 0..system.description().surfaces.len() {
            for law in LAWS
                .into_iter()
                .chain([Law::Restitution(0.3), Law::Newton(0.7)])
            {
                let after = apply(system, surface, law, &state);
                let (q, qdot) = (system.position(&after), system.velocity(0.0, &after));
                let (residuals, scales) = system.residuals(0.0, &q, &qdot.expect("a velocity"));
                for (residual, scale) in residuals.as_slice().iter().zip(scales.as_slice()) {
                    assert!(
                        residual.abs() < 1e-12 * scale.max(1e-3),
                        "{}: {law}: {residual:e}",
                        system.description().name
                    );
                }
            }
        }
    }
}

#[test]
fn impacts_stay_on_the_constraints() {
    for name in [
        "rolling_disk",
        "chaplygin_sleigh",
        "rolling_ball_euler",
        "two_wheels_rod",
        "affine_sleigh",
        "table_wall",
    ] {
        check_constraints(&system(name));
    }
}

/// The largest difference of a component.
fn distance(a: &State, b: &State) -> f64 {
    let pairs = a.as_slice().iter().zip(b.as_slice());
    pairs.fold(0.0, |largest: f64, (a, b)| larger(largest, (a - b).abs()))
}

#[test]
fn impact_plastic_is_idempotent_and_totally_plastic_is_not() {
    let disk = system("rolling_disk");
    for state in states(&disk, 10, 13) {
        let once = apply(&disk, 0, Law::ImpactPlastic, &state);
        let twice = apply(&disk, 0, Law::ImpactPlastic, &once);
        let bound = 4.0 * f64::EPSILON * distance(&state, &state.zeroed());
        assert!(
            distance(&once, &twice) < bound,
            "{:e}",
            distance(&once, &twice)
        );
        let once = apply(&disk, 0, Law::TotallyPlastic, &state);
        let twice = apply(&disk, 0, Law::TotallyPlastic, &once);
        let moved = distance(&once, &state);
        assert!(
            distance(&once, &twice) > 1e-3 * moved,
            "rho < 1 leaves something to do"
        );
    }
}

#[test]
fn newton_sets_the_gap_rate_where_elastic_does_not() {
    let sleigh = system("affine_sleigh");
    let mut differ = 0;
    for state in states(&sleigh, 20, 14) {
        let contact = sleigh.contact(0, 0.0, &state).expect("a contact");
        let newton = sleigh
            .gap_rates(0.0, &apply(&sleigh, 0, Law::Newton(0.5), &state))
            .expect("rates")
            .as_slice()[0];
        assert!((newton + 0.5 * contact.gap_rate).abs() < 1e-12);
        let elastic = apply(&sleigh, 0, Law::Elastic, &state);
        let energies =
            [&state, &elastic].map(|state| sleigh.energy(0.0, state).expect("an energy"));
        assert!(
            (energies[0] - energies[1]).abs() < 1e-12,
            "elastic keeps the energy, affine constraints or not"
        );
        let rate = sleigh.gap_rates(0.0, &elastic).expect("rates").as_slice()[0];
        differ += usize::from((rate + contact.gap_rate).abs() > 1e-3);
    }
    assert!(
        differ > 10,
        "with an affine constraint elastic does not reverse the gap rate"
    );
}

/// A ball whose restitution is an expression.
static LOSSY: Text = Text::new(
    "Lossy {
        coordinates { x; }
        parameters { m > 0 = 1; loss = 0.25; }
        lagrangian = m/2*dot(x)^2 - m*x;
        impacts { floor: x >= 0 => restitution(1 - loss); }
    }",
);

#[test]
fn a_coefficient_that_adds_energy_is_refused_when_a_state_is_made() {
    let state = |loss: f64| {
        let ball = LOSSY.with([("loss", loss)]);
        ball.state(0.0, &Bounded::of(&[1.0]), &Bounded::of(&[0.0]))
    };
    assert!(state(0.25).is_ok() && state(0.0).is_ok() && state(1.0).is_ok());
    let refused = state(-0.5).expect_err("restitution 1.5");
    assert_eq!(
        refused.to_string(),
        "parameter `restitution at floor` is 1.5, but must be in [0, 1]"
    );
}
