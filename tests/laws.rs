//! Properties of the impact laws at random states on random surfaces.

use dalembert::law::{Blow, Law};
use dalembert::{Constrained, Described, Impacting, StateVector, System};
use dalembert_models::chaplygin_sleigh::ChaplyginSleighGlobal;
use dalembert_models::rolling_ball_euler::RollingBallEulerGlobal;
use dalembert_models::rolling_disk::RollingDiskGlobal;
use dalembert_models::{
    BouncingBall, ChaplyginSleigh, HolonomicBeadOnEllipses, PointBilliard, RollingBallEuler,
    RollingDisk, TwoWheelsRod,
};
use dalembert_tests::sampling::states;
use dalembert_tests::systems::{AffineSleigh, DampedSleigh, MagneticDisk, TableWall};

const LAWS: [Law; 4] = [
    Law::Elastic,
    Law::NonholonomicPlastic,
    Law::ImpactPlastic,
    Law::TotallyPlastic,
];

/// The state after an impact of a law on a surface.
fn apply<S: Impacting>(system: &S, surface: usize, law: Law, state: &S::State) -> S::State {
    let contact = system.contact(surface, 0.0, state).expect("a contact");
    let mut after = *state;
    system.kick(&mut after, contact.impulse(law), &contact.direction);
    after
}

/// With `c` the law's factor, `G+ = (1 - c) G-` and `H+ - H- = -(c - c^2/2) G-^2 / dh(pi_D grad h)` on D at rest
/// walls; no position needs to lie on the surface for these algebraic facts.
fn check_linear<S: Described + Impacting>(system: &S) {
    for state in states(system, 20, 11) {
        for surface in 0..S::DESCRIPTION.surfaces.len() {
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
                    S::DESCRIPTION.name
                );
                let change = system.energy(0.0, &after).expect("an energy") - energy;
                let expected =
                    -(c - c * c / 2.0) * before * before / contact.constrained_compliance;
                assert!(
                    (change - expected).abs() < 1e-11 * energy.abs(),
                    "{}: {law}",
                    S::DESCRIPTION.name
                );
            }
            assert!(
                (0.0..=1.0 + 1e-12).contains(&rho),
                "{}: rho = {rho}",
                S::DESCRIPTION.name
            );
        }
    }
}

#[test]
fn gap_rate_and_energy_change_as_each_law_says() {
    check_linear(&RollingDisk::default());
    check_linear(&ChaplyginSleigh::default());
    check_linear(&RollingBallEuler::default());
    check_linear(&TwoWheelsRod::default());
    check_linear(&PointBilliard::default());
    check_linear(&DampedSleigh::default());
    check_linear(&MagneticDisk::default());
}

/// The declared law has a function of its own, in which most of a contact is left out.
fn check_blows<S: Described + Impacting>(system: &S) {
    for state in states(system, 20, 14) {
        for surface in 0..S::DESCRIPTION.surfaces.len() {
            let contact = system.contact(surface, 0.0, &state).expect("a contact");
            let expected = contact.blow(system.law(surface));
            let actual = system.blow(surface, 0.0, &state).expect("a blow");
            let whole = |blow: &Blow<S::Impulse>| -> Vec<f64> {
                let direction = blow.direction.as_slice().iter();
                direction.map(|own| blow.size * own).collect()
            };
            let (expected_impulse, impulse) = (whole(&expected), whole(&actual));
            let size = expected_impulse
                .iter()
                .fold(0.0, |size: f64, own| size.max(own.abs()));
            for (actual, expected) in impulse.iter().zip(&expected_impulse) {
                assert!(
                    (actual - expected).abs() < 1e-12 * size,
                    "{}: {actual} for {expected}",
                    S::DESCRIPTION.name
                );
            }
            let taken = (actual.share - expected.share) * contact.gap_rate;
            assert!(
                taken.abs() < 1e-12 * (contact.gap_rate.abs() + contact.surface_rate.abs() + 1e-3),
                "{}: {} for {}",
                S::DESCRIPTION.name,
                actual.share,
                expected.share
            );
        }
    }
}

#[test]
fn blows_are_those_of_the_contact_by_the_declared_law() {
    check_blows(&RollingDisk::default());
    check_blows(&RollingDiskGlobal(RollingDisk::default()));
    check_blows(&ChaplyginSleigh::default());
    check_blows(&ChaplyginSleighGlobal(ChaplyginSleigh::default()));
    check_blows(&RollingBallEuler::default());
    check_blows(&RollingBallEulerGlobal(RollingBallEuler::default()));
    check_blows(&TwoWheelsRod::default());
    check_blows(&PointBilliard::default());
    check_blows(&HolonomicBeadOnEllipses::default());
    check_blows(&BouncingBall::default());
    check_blows(&AffineSleigh::default());
    check_blows(&DampedSleigh::default());
    check_blows(&MagneticDisk::default());
    check_blows(&TableWall::default());
}

/// No law leaves the constraints, affine ones included.
fn check_constraints<S: Described + Impacting + Constrained>(system: &S) {
    for state in states(system, 20, 12) {
        for surface in 0..S::DESCRIPTION.surfaces.len() {
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
                        S::DESCRIPTION.name
                    );
                }
            }
        }
    }
}

#[test]
fn impacts_stay_on_the_constraints() {
    check_constraints(&RollingDisk::default());
    check_constraints(&ChaplyginSleigh::default());
    check_constraints(&RollingBallEuler::default());
    check_constraints(&TwoWheelsRod::default());
    check_constraints(&AffineSleigh::default());
    check_constraints(&TableWall::default());
}

#[test]
fn impact_plastic_is_idempotent_and_totally_plastic_is_not() {
    let disk = RollingDisk::default();
    for state in states(&disk, 10, 13) {
        let once = apply(&disk, 0, Law::ImpactPlastic, &state);
        let twice = apply(&disk, 0, Law::ImpactPlastic, &once);
        let bound = 4.0 * f64::EPSILON * state.amax();
        assert!((once - twice).amax() < bound, "{:e}", (once - twice).amax());
        let once = apply(&disk, 0, Law::TotallyPlastic, &state);
        let twice = apply(&disk, 0, Law::TotallyPlastic, &once);
        let moved = (once - state).amax();
        assert!(
            (once - twice).amax() > 1e-3 * moved,
            "rho < 1 leaves something to do"
        );
    }
}

#[test]
fn newton_sets_the_gap_rate_where_elastic_does_not() {
    let sleigh = AffineSleigh::default();
    let mut differ = 0;
    for state in states(&sleigh, 20, 14) {
        let contact = sleigh.contact(0, 0.0, &state).expect("a contact");
        let newton = sleigh
            .gap_rates(0.0, &apply(&sleigh, 0, Law::Newton(0.5), &state))
            .expect("rates")[0];
        assert!((newton + 0.5 * contact.gap_rate).abs() < 1e-12);
        let elastic = apply(&sleigh, 0, Law::Elastic, &state);
        let energies =
            [&state, &elastic].map(|state| sleigh.energy(0.0, state).expect("an energy"));
        assert!(
            (energies[0] - energies[1]).abs() < 1e-12,
            "elastic keeps the energy, affine constraints or not"
        );
        let rate = sleigh.gap_rates(0.0, &elastic).expect("rates")[0];
        differ += usize::from((rate + contact.gap_rate).abs() > 1e-3);
    }
    assert!(
        differ > 10,
        "with an affine constraint elastic does not reverse the gap rate"
    );
}

dalembert::model! {
    /// A ball whose restitution is an expression.
    pub Lossy {
        coordinates { x; }
        parameters { m > 0 = 1; loss = 0.25; }
        lagrangian = m/2*dot(x)^2 - m*x;
        impacts { floor: x >= 0 => restitution(1 - loss); }
    }
}

#[test]
fn a_coefficient_that_adds_energy_is_refused_when_a_state_is_made() {
    let state = |loss: f64| {
        Lossy {
            loss,
            ..Lossy::default()
        }
        .state(0.0, &[1.0].into(), &[0.0].into())
    };
    assert!(state(0.25).is_ok() && state(0.0).is_ok() && state(1.0).is_ok());
    let refused = state(-0.5).expect_err("restitution 1.5");
    assert_eq!(
        refused.to_string(),
        "parameter `restitution at floor` is 1.5, but must be in [0, 1]"
    );
}
