//! Section C, first part: single impacts by every law.

use dalembert::law::{Contact, Law};
use dalembert::math::larger;
use dalembert::{Constrained, Impacting, Outcome, Scene, StateVector, System, VectorField};
use dalembert_cli::suite::{Case, Report, Run, Setting, refusal};

use super::accumulation::PISTON;
use super::course::{Course, Random, U, vector};
use super::location::FALL;
use super::text::{Model, Text, shipped, value};

/// A vertical disk that rolls towards a wall. The gap is the distance of its centre from the wall.
static DISK_AT_WALL: Text = Text::new(
    "DiskAtWall {
        coordinates { x; y; theta: angle; phi: angle; }
        parameters { m > 0 = 1.5; R > 0 = 0.5; I > 0 = 0.25; J > 0 = 0.125; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + J/2*dot(phi)^2;
        constraints { along: dot(x) = R*cos(phi)*dot(theta); across: dot(y) = R*sin(phi)*dot(theta); }
        impacts { wall: x >= 0; }
    }",
);

/// The cases.
pub const CASES: &[Case] = &[
    Case {
        id: "C01",
        title: "every law at random states of four models",
        right: "gap rate times 1 - c; H+ - H- = -(c - c^2/2) G^2/dh(pi_D grad h); p+ in D*",
        bound: "1e3 u and the metric's condition: 1e-12",
        run: Run::Once(every_law),
        ..Case::QUICK
    },
    Case {
        id: "C02",
        title: "a vertical disk whose centre hits a wall",
        right: "roll rate times -1, 0 and (I + mR^2 - 2mR^2 cos^2 phi)/(I + mR^2); turn rate kept",
        bound: "16 u",
        run: Run::Once(disk_at_wall),
        ..Case::QUICK
    },
    Case {
        id: "C03",
        title: "nonholonomic plastic impact where rho <= 1/2",
        right: "still approaching, rho = mR^2 cos^2 phi/(I + mR^2); repeated, the limit is impact plastic",
        bound: "`still_penetrating`, rho to 16 u; limit to 1e-12",
        run: Run::Steps(|setting, report| {
            still_approaching(setting, report, Law::NonholonomicPlastic)
        }),
        ..Case::QUICK
    },
    Case {
        id: "C04",
        title: "totally plastic impact",
        right: "gap rate times (1 - rho)^n after n impacts; the limit is impact plastic",
        bound: "`still_penetrating`, rho to 16 u; limit to 1e-12",
        run: Run::Steps(|setting, report| still_approaching(setting, report, Law::TotallyPlastic)),
        ..Case::QUICK
    },
    Case {
        id: "C12",
        title: "the same surface declared twice",
        right: "refused while building, with both named",
        bound: "a message about the second",
        run: Run::Once(same_surface_twice),
        ..Case::QUICK
    },
    Case {
        id: "C14",
        title: "a wall that moves",
        right: "v+ = 2w - v; H+ - H- = -eps d_t h with p+ - p- = eps d_x h",
        bound: "8 u of the largest speed, and u per step",
        run: Run::Steps(moving_wall),
        ..Case::QUICK
    },
    Case {
        id: "C20",
        title: "the impact budget is used up",
        right: "stops after the third impact, at t = 6",
        bound: "`impact_budget` with the state after the impact",
        run: Run::Steps(budget),
        ..Case::QUICK
    },
];

/// All laws, each with its factor `c`: the gap rate after the impact is `1 - c` times the rate before.
fn factors<V: StateVector>(contact: &Contact<V>) -> [(Law, f64); 6] {
    let rho = contact.rho();
    [
        (Law::Elastic, 2.0),
        (Law::Restitution(0.75), 1.75),
        (Law::Newton(0.25), 1.25),
        (Law::NonholonomicPlastic, 2.0 * rho),
        (Law::ImpactPlastic, 1.0),
        (Law::TotallyPlastic, rho),
    ]
}

/// Checks the laws at 64 random states of a model with linear or no constraints, and with surfaces at rest.
fn laws_of<M: Scene + Impacting>(
    system: &M,
    name: &str,
    report: &mut Report,
    residual_of: impl Fn(&M, &M::State) -> f64,
) {
    let mut random = Random::new(7);
    let (mut rate_error, mut energy_error, mut residual) = (0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..64 {
        let mut draw = |low: f64, high: f64| {
            let values: Vec<f64> = (0..system.coordinate_count())
                .map(|_| random.between(low, high))
                .collect();
            vector::<M::Vector>(&values)
        };
        let (q, qdot) = (draw(0.2, 0.8), draw(-1.0, 1.0));
        let state = system.state_projected(0.0, &q, &qdot).expect("a state");
        let energy = system.energy(0.0, &state).expect("an energy");
        for surface in 0..system.surface_count() {
            let contact = system.contact(surface, 0.0, &state).expect("a contact");
            let g = contact.gap_rate;
            for (law, c) in factors(&contact) {
                let mut after = state;
                system.kick(&mut after, contact.impulse(law), &contact.direction);
                let rate = system.gap_rates(0.0, &after).expect("rates").as_slice()[surface];
                let lost = -(c - 0.5 * c * c) * g * g / contact.constrained_compliance;
                let found = system.energy(0.0, &after).expect("an energy") - energy;
                rate_error = larger(rate_error, (rate - (1.0 - c) * g).abs() / g.abs());
                energy_error =
                    energy_error.max((found - lost).abs() / energy.abs().max(lost.abs()));
                residual = residual.max(residual_of(system, &after));
            }
        }
    }
    report.error(format!("gap rate, {name}"), rate_error, 1e-12);
    report.error(format!("energy, {name}"), energy_error, 1e-12);
    report.error(format!("residual, {name}"), residual, 1e-12);
}

/// The largest constraint residual, relative to the sum of the absolute values of its terms.
fn residual<M: Constrained>(system: &M, state: &M::State) -> f64 {
    let (q, qdot) = (system.position(state), system.velocity(0.0, state));
    let (residuals, scales) = system.residuals(0.0, &q, &qdot.expect("a velocity"));
    let pairs = residuals.as_slice().iter().zip(scales.as_slice());
    pairs
        .map(|(residual, scale)| residual.abs() / scale)
        .fold(0.0, larger)
}

fn every_law(report: &mut Report) {
    let disk = shipped("rolling_disk").with([
        ("m", 1.0),
        ("R", 0.5),
        ("I", 0.125),
        ("J", 0.0625),
        ("ta", 3.0),
        ("tb", 2.0),
    ]);
    laws_of(&disk, "rolling disk", report, residual);
    laws_of(
        &shipped("chaplygin_sleigh").model(),
        "sleigh",
        report,
        residual,
    );
    laws_of(
        &shipped("rolling_ball_euler").large([]),
        "rolling ball",
        report,
        residual,
    );
    laws_of(
        &shipped("point_billiard").model(),
        "point",
        report,
        |_, _| 0.0,
    );
}

/// The disk at the wall with heading `phi`, rolling into the wall at rate 1 and turning at rate 1/4.
fn at_wall(system: &Model, phi: f64) -> <Model as VectorField>::State {
    let (roll, radius) = (-1.0, value(system, "R"));
    let qdot = [
        radius * phi.cos() * roll,
        radius * phi.sin() * roll,
        roll,
        0.25,
    ];
    system
        .state(0.0, &vector(&[0.0, 0.0, 0.0, phi]), &vector(&qdot))
        .expect("a state")
}

/// The rolling inertia `m R^2`, and its sum with `I`.
fn inertias(system: &Model) -> (f64, f64) {
    let [m, radius, axis] = ["m", "R", "I"].map(|name| value(system, name));
    let rolled = m * radius * radius;
    (rolled, axis + rolled)
}

/// Velocities after one impact with a law.
fn struck(system: &Model, state: &mut <Model as VectorField>::State, law: Law) -> [f64; 4] {
    let contact = system.contact(0, 0.0, state).expect("a contact");
    system.kick(state, contact.impulse(law), &contact.direction);
    let velocity = system.velocity(0.0, state).expect("a velocity");
    velocity.as_slice().try_into().expect("four components")
}

fn disk_at_wall(report: &mut Report) {
    let system = DISK_AT_WALL.model();
    let (rolled, spin) = inertias(&system);
    for phi in [0.1_f64, 0.7, 1.2] {
        let rho = rolled * phi.cos() * phi.cos() / spin;
        let laws = [
            (Law::Elastic, -1.0),
            (Law::ImpactPlastic, 0.0),
            (Law::NonholonomicPlastic, 1.0 - 2.0 * rho),
        ];
        for (law, factor) in laws {
            let after = struck(&system, &mut at_wall(&system, phi), law);
            report.near(
                format!("roll, {}, phi = {phi}", law.name()),
                after[2],
                -factor,
                16.0 * U,
            );
            report.near(
                format!("turn, {}, phi = {phi}", law.name()),
                after[3],
                0.25,
                16.0 * U,
            );
        }
    }
}

fn still_approaching(setting: Setting, report: &mut Report, law: Law) {
    let system = DISK_AT_WALL.model();
    let phi = 1.2_f64;
    let state = at_wall(&system, phi);
    let end = Course::from_state(&system, state, 1.0)
        .law(0, law)
        .run(setting);
    report.class(&end.outcome, "still_penetrating");
    let (rolled, spin) = inertias(&system);
    let exact = rolled * phi.cos() * phi.cos() / spin;
    if let Outcome::StillPenetrating { rho, .. } = end.outcome {
        report.near("rho", rho, exact, 16.0 * U);
    }
    let mut repeated = state;
    let mut velocity = [0.0; 4];
    for _ in 0..1000 {
        velocity = struck(&system, &mut repeated, law);
    }
    let limit = struck(&system, &mut at_wall(&system, phi), Law::ImpactPlastic);
    let apart = velocity.iter().zip(limit).map(|(a, b)| (a - b).abs());
    report.error("limit of repetition", apart.fold(0.0, larger), 1e-12);
}

fn same_surface_twice(report: &mut Report) {
    for second in ["2*x - 2 >= 0", "x >= 1", "1 - x >= 0"] {
        let source = format!(
            "Wall {{ coordinates {{ x; }} lagrangian = dot(x)^2/2; impacts {{ first: x - 1 >= 0; second: {second}; }} }}"
        );
        let said = refusal(&source).unwrap_or_default();
        report.equal(second, said.contains("same surface as `first`"), true);
    }
}

fn moving_wall(setting: Setting, report: &mut Report) {
    for u in [0.5, 0.01, 0.3] {
        let system = PISTON.with([("u", u)]);
        let end = Course::new(&system, &[0.5], &[1.0], 10.0)
            .impacts(1)
            .run(setting);
        report.class(&end.outcome, "impact_budget");
        let steps = end.counters.accepted as f64;
        let v = end.qdot[0];
        report.near(
            format!("v+, u = {u}"),
            v,
            -2.0 * u - 1.0,
            U * (8.0 * 3.0 + steps),
        );
        // eps = p- - p+ since d_x h = -1, and d_t h = -u.
        report.near(
            format!("energy, u = {u}"),
            end.energy - 0.5,
            (1.0 - v) * u,
            U * (8.0 * 3.0 + steps),
        );
    }
}

fn budget(setting: Setting, report: &mut Report) {
    let end = Course::new(&FALL.model(), &[0.0], &[1.0], 1e3)
        .impacts(3)
        .run(setting);
    report.class(&end.outcome, "impact_budget");
    report.equal("impacts", end.hits.len(), 3);
    report.near("t", end.t, 6.0, end.eta(12.0));
    report.near("v", end.qdot[0], 1.0, end.eta(12.0));
}
