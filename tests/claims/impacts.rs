//! Effect of impacts on an invariant volume: the remarks on each law, and the hybrid Jacobian by finite differences of
//! the emitted impact map on D*. The Jacobian is the determinant of the map in a fibre times the ratio of the fluxes
//! through the surface.

use dalembert::{Described, Impacting, StateVector, System};
use dalembert_models::ChaplyginSleigh;
use dalembert_tests::claim::Declaration;
use dalembert_tests::linear::determinant;
use dalembert_tests::numeric::slope;
use dalembert_tests::sampling::Random;
use dalembert_tests::witness;

dalembert::model! {
    /// A rolling disk between walls with every law that is an impulse.
    pub WalledDisk {
        coordinates { x; y; theta: angle; phi: angle; }
        parameters { m > 0 = 7/5; R > 0 = 3/8; I > 0 = 2/9; J > 0 = 1/7; e in [0, 1] = 0.7; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + J/2*dot(phi)^2;
        constraints {
            rolling_x: dot(x) = R*cos(phi)*dot(theta);
            rolling_y: dot(y) = R*sin(phi)*dot(theta);
        }
        impacts {
            kept: 1 - x - R*cos(phi) >= 0;
            restored: 2 - x - R*cos(phi) >= 0 => restitution(e);
            complete: 3 - x - R*cos(phi) >= 0 => restitution(1);
            dead: 4 - x - R*cos(phi) >= 0 => restitution(0);
            slowed: 5 - x - R*cos(phi) >= 0 => newton(1/3);
            slippery: 6 - x - R*cos(phi) >= 0 => nonholonomic_plastic;
            sticky: 7 - x - R*cos(phi) >= 0 => impact_plastic;
            soft: 8 - x - R*cos(phi) >= 0 => totally_plastic;
            straight: 9 - x >= 0 => nonholonomic_plastic;
        }
        claims {
            density: exact;
            conserved under kept: energy;
            conserved under complete: energy;
            not conserved under restored: energy;
            not conserved under slowed: energy;
            not conserved under slippery: energy;
            not conserved under sticky: energy;
            not conserved under soft: energy;
            conserved under sticky: R*cos(phi)*dot(theta) - dot(x);
        }
    }
}

dalembert::model! {
    /// A ball on a rotating table (affine constraints) between walls with several laws.
    pub WalledTable {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters { r > 0 = 1; k > 0 = 2/3; Om = 1/2; }
        lagrangian = 1/2*(dot(x)^2 + dot(y)^2)
            + k^2/2*(dot(phi)^2 + 2*dot(phi)*dot(psi)*cos(theta) + dot(psi)^2 + dot(theta)^2);
        constraints {
            rolling_x: dot(x) + r*sin(theta)*cos(psi)*dot(phi) - r*sin(psi)*dot(theta) = -Om*y;
            rolling_y: dot(y) + r*sin(psi)*sin(theta)*dot(phi) + r*cos(psi)*dot(theta) = Om*x;
        }
        impacts {
            kept: 1 - x >= 0;
            restored: 2 - x >= 0 => restitution(1/2);
            reversed: 3 - x >= 0 => newton(1);
            slowed: 4 - x >= 0 => newton(1/3);
            sticky: 5 - x >= 0 => impact_plastic;
        }
        claims {
            density: exact;
            conserved under kept: energy;
            not conserved under reversed: energy;
        }
    }
}

/// Positions or velocities.
type Four = <WalledDisk as System>::Vector;
type Five = <WalledTable as System>::Vector;

/// Remarks on each surface of a model with `density: exact`, in order.
fn remarks<S: Described>() -> Vec<String> {
    let declaration = Declaration::of(S::DESCRIPTION.source.value());
    let found = declaration.verdict("density: exact");
    assert!(found.is_accepted(), "{}", found.note());
    let about = |remark: &String| remark.starts_with("an impact at ");
    found.remarks.into_iter().filter(about).collect()
}

#[test]
fn what_each_law_does_to_the_volume_is_said() {
    let rho = "rho = dh(pi_D grad h)/dh(grad h)";
    assert_eq!(
        remarks::<WalledDisk>(),
        [
            "an impact at kept (elastic) keeps it".to_owned(),
            "an impact at restored (restitution(e)) multiplies it by e^2".to_owned(),
            "an impact at complete (restitution(1)) keeps it".to_owned(),
            "an impact at dead (restitution(0)) maps it to 0".to_owned(),
            "an impact at slowed (newton(1/3)) multiplies it by (1/3)^2".to_owned(),
            format!(
                "an impact at slippery (nonholonomic_plastic) multiplies it by (1 - 2*rho)^2, {rho}"
            ),
            "an impact at sticky (impact_plastic) maps it to 0".to_owned(),
            format!("an impact at soft (totally_plastic) multiplies it by (1 - rho)^2, {rho}"),
            format!(
                "an impact at straight (nonholonomic_plastic) multiplies it by (1 - 2*rho)^2, {rho}"
            ),
        ]
    );
    let rates = "where G- and G+ are the gap rates before and after";
    assert_eq!(
        remarks::<WalledTable>(),
        [
            format!("an impact at kept (elastic) multiplies it by -G+/G-, {rates}"),
            format!(
                "an impact at restored (restitution(1/2)) multiplies it by -(1/2)*G+/G-, {rates}"
            ),
            "an impact at reversed (newton(1)) keeps it".to_owned(),
            "an impact at slowed (newton(1/3)) multiplies it by (1/3)^2".to_owned(),
            "an impact at sticky (impact_plastic) maps it to 0".to_owned(),
        ]
    );
}

/// The hybrid Jacobian at a position, `rho`, and the gap rates `[G-, G+]`. `velocity` maps independent velocities `u`
/// to velocities on D, whose components with the indices `free` are `u`.
fn jacobian<S: Impacting>(
    system: &S,
    surface: usize,
    q: &S::Vector,
    velocity: &dyn Fn(&[f64]) -> S::Vector,
    free: &[usize],
    u: &[f64],
) -> (f64, f64, [f64; 2]) {
    let impact = |u: &[f64]| {
        let mut state = system.state(0.0, q, &velocity(u)).expect("a state on D");
        let contact = system.contact(surface, 0.0, &state).expect("a contact");
        let size = contact.impulse(system.law(surface));
        system.kick(&mut state, size, &contact.direction);
        (state, contact)
    };
    let after = |u: &[f64], i: usize| {
        let qdot = system.velocity(0.0, &impact(u).0).expect("a velocity");
        qdot.as_slice()[free[i]]
    };
    let columns: Vec<Vec<f64>> = (0..free.len())
        .map(|i| {
            let column = (0..free.len()).map(|j| {
                slope(&mut |s| {
                    let mut moved = u.to_vec();
                    moved[i] += s;
                    after(&moved, j)
                })
            });
            column.collect()
        })
        .collect();
    let (state, contact) = impact(u);
    let rates = system.gap_rates(0.0, &state).expect("gap rates");
    let rates = [contact.gap_rate, rates.as_slice()[surface]];
    let value = determinant(&columns) * rates[1] / rates[0];
    (value, contact.rho(), rates)
}

/// Impact maps are affine in the velocities, so that differences are exact up to rounding errors.
const EXACT: f64 = 1e-9;

#[test]
fn the_jacobian_of_each_law_is_what_is_said_of_it() {
    let disk = WalledDisk::default();
    let mut random = Random::new(51);
    let mut far = 0;
    for _ in 0..20 {
        let q: Four = random.vector(-1.0, 1.0);
        let phi = q[3];
        let velocity = |u: &[f64]| -> Four {
            [
                disk.R * phi.cos() * u[0],
                disk.R * phi.sin() * u[0],
                u[0],
                u[1],
            ]
            .into()
        };
        let u = [random.within(0.2, 2.0), random.within(0.2, 2.0)];
        for surface in 0..9 {
            // A position on the wall, whose gap is linear in x.
            let mut q = q;
            q[0] = (surface + 1) as f64 - if surface < 8 { disk.R * phi.cos() } else { 0.0 };
            let (value, rho, rates) = jacobian(&disk, surface, &q, &velocity, &[2, 3], &u);
            let expected = match surface {
                0 | 2 => 1.0,
                1 => disk.e * disk.e,
                3 | 6 => 0.0,
                4 => 1.0 / 9.0,
                5 | 8 => (1.0 - 2.0 * rho).powi(2),
                _ => (1.0 - rho).powi(2),
            };
            assert!(
                (value - expected).abs() < EXACT,
                "{surface}: {value} for {expected}, {rates:?}"
            );
            far += usize::from(rho < 0.9 && rates[0].abs() > 0.01);
        }
    }
    assert!(far > 100, "constraints turn the gradient at {far} states");
}

#[test]
fn with_affine_constraints_elastic_impacts_keep_the_energy_but_not_the_volume() {
    let table = WalledTable::default();
    let mut random = Random::new(52);
    let mut changed = 0;
    for _ in 0..20 {
        let q: Five = random.vector(0.3, 1.3);
        for surface in 0..5 {
            let mut q = q;
            q[0] = (surface + 1) as f64;
            let velocity = |u: &[f64]| -> Five {
                let (theta, psi) = (q[3], q[4]);
                let x = -table.Om * q[1] - table.r * theta.sin() * psi.cos() * u[0]
                    + table.r * psi.sin() * u[1];
                let y = table.Om * q[0]
                    - table.r * theta.sin() * psi.sin() * u[0]
                    - table.r * psi.cos() * u[1];
                [x, y, u[0], u[1], u[2]].into()
            };
            let u = [
                random.within(-2.0, 2.0),
                random.within(-2.0, 2.0),
                random.within(-2.0, 2.0),
            ];
            let (value, _, [before, after]) =
                jacobian(&table, surface, &q, &velocity, &[2, 3, 4], &u);
            let expected = match surface {
                0 => -after / before,
                1 => -0.5 * after / before,
                2 => 1.0,
                3 => 1.0 / 9.0,
                _ => 0.0,
            };
            assert!(
                (value - expected).abs() < EXACT * (1.0 + expected.abs()),
                "{surface}: {value} for {expected}"
            );
            changed += usize::from(surface == 0 && (value - 1.0).abs() > 1e-3);
        }
    }
    assert!(changed > 10, "{changed} elastic impacts change the volume");
}

#[test]
fn the_density_of_the_sleigh_does_not_survive_an_elastic_impact() {
    let declaration = Declaration::of(ChaplyginSleigh::DESCRIPTION.source.value());
    let found = declaration.verdict("density = 1/abs(dot(theta))");
    assert!(found.is_accepted(), "{}", found.note());
    assert_eq!(found.remarks.len(), 2, "{:?}", found.remarks);
    for (surface, remark) in ["front_tip", "back_tip"].iter().zip(&found.remarks) {
        let start = format!("an impact at {surface} (elastic) does not keep it: ");
        let numbers = remark.strip_prefix(&start).expect(remark);
        // The remark becomes the refutation of a claim under the surface. The Jacobian of an elastic impact is 1.
        let (values, place) = numbers.split_once(" at ").expect(remark);
        let values = values
            .replace(" times the Jacobian", "")
            .replace(", ", "\n");
        let message = format!("{start}\n{values}\nat {place}");
        let claim = format!("conserved under {surface}: 1/abs(dot(theta))");
        witness::check(&mut ChaplyginSleigh::default(), &claim, &message);
    }
}
