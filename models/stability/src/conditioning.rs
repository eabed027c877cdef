//! Section D, second part: nearly dependent constraints, degenerate metrics, inertias and stiffnesses of widely
//! different magnitude.

use dalembert::math::larger;
use dalembert::{StateError, System};
use dalembert_cli::suite::{Case, Report, Run, Setting};

use super::constrained::SKATE;
use super::course::{Course, U, vector};
use super::text::{Text, shipped, value};

/// Two forms that span the same plane for every `delta`, and nearly coincide when it is small.
static NEARLY_DEPENDENT: Text = Text::new(
    "NearlyDependent {
        coordinates { x; y; z; w; }
        parameters { delta != 0 = 1; }
        lagrangian = 1/2*(dot(x)^2 + dot(y)^2 + dot(z)^2 + dot(w)^2) - x*z;
        constraints {
            first: dot(z) - y*dot(x) = 0;
            second: dot(z) - y*dot(x) + delta*(dot(w) - x*dot(y)) = 0;
        }
    }",
);

/// Constraints whose rank drops where y = 0.
static RANK_DROPS: Text = Text::new(
    "RankDrops {
        coordinates { x; y; z; }
        lagrangian = 1/2*(dot(x)^2 + dot(y)^2 + dot(z)^2);
        constraints { first: d(x) = 0; second: d(x) + y*d(z) = 0; }
    }",
);

/// A metric that is singular at x = 1.
static FADING_MASS: Text = Text::new(
    "FadingMass {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + (1 - x)*dot(y)^2)/2;
    }",
);

/// A metric that is indefinite for |c| > 1.
static COUPLED: Text = Text::new(
    "Coupled {
        coordinates { x; y; }
        parameters { c = 0; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 + c*dot(x)*dot(y);
    }",
);

/// A stiff spring with a wall, and a soft one next to it.
static STIFF_AND_SOFT: Text = Text::new(
    "StiffAndSoft {
        coordinates { x; y; }
        parameters { k > 0 = 1e12; depth = 1/2; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - k*x^2/2 - y^2/2;
        impacts { wall: x + 1 - depth >= 0; }
    }",
);

/// The cases.
pub const CASES: &[Case] = &[
    Case {
        id: "D06",
        title: "nearly dependent constraints: eta2 = eta1 + d eta3, d = 1e-3, 1e-6, 1e-9",
        right: "the motion does not depend on d",
        bound: "1e-12/d",
        run: Run::Integrators(nearly_dependent),
        ..Case::QUICK
    },
    Case {
        id: "D08",
        title: "two forms whose rank drops at y = 0, reached at t = 1",
        right: "the constraint forces are not determined there",
        bound: "`singular_constraint` within 1e-9 of y = 0",
        run: Run::Steps(rank_drops),
        ..Case::QUICK
    },
    Case {
        id: "D10",
        title: "a skate that hits a wall nearly along it: heading pi/2 - e, e = 1e-2, 1e-6, 1e-8",
        right: "elastic: the velocity exactly reversed",
        bound: "64 u, and u per step",
        run: Run::Steps(glancing_skate),
        ..Case::QUICK
    },
    Case {
        id: "D11",
        title: "a skate exactly along a wall",
        right: "the wall cannot be reached, nor left",
        bound: "`done` without impacts, y = 0",
        run: Run::Steps(skate_along),
        ..Case::QUICK
    },
    Case {
        id: "D12",
        title: "a turning disk with mR^2/I = 1e-16, 1e-8, 1",
        right: "D02 for all",
        bound: "1e-10 of the path",
        run: Run::Integrators(|setting, report| {
            ratios_of_inertias(setting, report, [1e-16, 1e-8, 1.0])
        }),
        ..Case::QUICK
    },
    Case {
        id: "D12b",
        title: "a turning disk with mR^2/I = 1e8, 1e12, 1e16",
        right: "D02 for all",
        bound: "1e-10 of the path, in 1e5 steps",
        run: Run::Integrators(|setting, report| {
            ratios_of_inertias(setting, report, [1e8, 1e12, 1e16])
        }),
        ..Case::QUICK
    },
    Case {
        id: "D15",
        title: "a metric that becomes singular on the way, at t = 1",
        right: "no velocity belongs to the momenta there",
        bound: "`metric_not_positive` within 1e-6 of t = 1",
        run: Run::Steps(fading_mass),
        ..Case::QUICK
    },
    Case {
        id: "D16",
        title: "parameters that make the metric indefinite",
        right: "no motion",
        bound: "refused as a state, or `metric_not_positive` before the first step",
        run: Run::Steps(indefinite),
        ..Case::QUICK
    },
    Case {
        id: "D17",
        title: "a double pendulum whose lower bob has a mass of 1e-12",
        right: "the upper one is a simple pendulum: period 2 pi sqrt(l/g)/agm(1, cos(theta0/2))",
        bound: "1e-9",
        run: Run::Integrators(light_bob),
        ..Case::QUICK
    },
    Case {
        id: "D18",
        title: "a mass on a stiff spring, frequency 1e6, that bounces off a wall, and a mass on a soft spring",
        right: "impacts every 2 t1 from t1 = (pi - acos(1 - d))/W; the second mass is at cos(t)",
        bound: "exact count; 1e-10",
        run: Run::Integrators(stiff_and_soft),
        ..Case::QUICK
    },
];

fn nearly_dependent(setting: Setting, report: &mut Report) {
    let (x, y) = (0.7, -0.4);
    let end = |delta: f64| {
        let system = NEARLY_DEPENDENT.with([("delta", delta)]);
        Course::new(
            &system,
            &[x, y, 0.2, 0.1],
            &[0.3, 0.9, y * 0.3, x * 0.9],
            2.0,
        )
        .run(setting)
    };
    let reference = end(1.0);
    for delta in [1e-3, 1e-6, 1e-9] {
        let end = end(delta);
        report.class(&end.outcome, "done");
        let apart = end.q.iter().zip(&reference.q).map(|(a, b)| (a - b).abs());
        report.error(
            format!("q, d = {delta:e}"),
            apart.fold(0.0, larger),
            1e-12 / delta,
        );
    }
}

fn rank_drops(setting: Setting, report: &mut Report) {
    let end = Course::new(
        &RANK_DROPS.model(),
        &[0.0, -1.0, 0.0],
        &[0.0, 1.0, 0.0],
        2.0,
    )
    .run(setting);
    report.class(&end.outcome, "singular_constraint");
    report.near("y", end.q[1], 0.0, 1e-9);
}

fn glancing_skate(setting: Setting, report: &mut Report) {
    for e in [1e-2, 1e-6, 1e-8] {
        let system = SKATE.with([("far", 0.0)]);
        let theta = core::f64::consts::FRAC_PI_2 - e;
        let (sin, cos) = theta.sin_cos();
        let state = system
            .state(
                0.0,
                &vector(&[0.5 * cos, 0.0, theta]),
                &vector(&[-cos, -sin, 0.0]),
            )
            .expect("a state");
        let end = Course::from_state(&system, state, 1.0).run(setting);
        report.class(&end.outcome, "done");
        report.equal(format!("impacts, e = {e:e}"), end.hits.len(), 1);
        let bound = U * (64.0 + end.counters.accepted as f64);
        report.near(format!("vx, e = {e:e}"), end.qdot[0] / cos, 1.0, bound);
        report.near(format!("vy, e = {e:e}"), end.qdot[1] / sin, 1.0, bound);
        report.near(format!("turn rate, e = {e:e}"), end.qdot[2], 0.0, bound);
    }
}

fn skate_along(setting: Setting, report: &mut Report) {
    let system = SKATE.with([("low", 0.0)]);
    let end = Course::new(&system, &[0.0; 3], &[1.0, 0.0, 0.0], 10.0).run(setting);
    report.class(&end.outcome, "done");
    report.equal("impacts", end.hits.len(), 0);
    report.equal("y", end.q[1], 0.0);
}

fn ratios_of_inertias(setting: Setting, report: &mut Report, ratios: [f64; 3]) {
    for kappa in ratios {
        let disk = shipped("rolling_disk").with([
            ("m", 1.0),
            ("R", 1.0),
            ("I", 1.0 / kappa),
            ("J", 1.0),
            ("ta", 1e9),
            ("tb", 1e9),
        ]);
        let (roll, turn, phi, t) = (1.5, 0.75, 0.6_f64, 20.0);
        let end = Course::new(
            &disk,
            &[0.0, 0.0, 0.0, phi],
            &[roll * phi.cos(), roll * phi.sin(), roll, turn],
            t,
        )
        .steps(100_000)
        .run(setting);
        report.class(&end.outcome, "done");
        let (radius, after) = (roll / turn, phi + turn * t);
        let apart = (end.q[0] - radius * (after.sin() - phi.sin()))
            .hypot(end.q[1] - radius * (phi.cos() - after.cos()));
        report.error(format!("place, kappa = {kappa:e}"), apart, 1e-10 * roll * t);
    }
}

fn fading_mass(setting: Setting, report: &mut Report) {
    let end = Course::new(&FADING_MASS.model(), &[0.0, 0.0], &[1.0, 0.0], 2.0).run(setting);
    report.class(&end.outcome, "metric_not_positive");
    report.near("time", end.t, 1.0, 1e-6);
}

fn indefinite(setting: Setting, report: &mut Report) {
    let system = COUPLED.with([("c", 1.5)]);
    match system.state(0.0, &vector(&[0.0, 0.0]), &vector(&[1.0, 0.0])) {
        Err(StateError::Fault(dalembert::Fault::MetricNotPositive { .. })) => {
            report.equal("state", "refused", "refused");
        }
        Err(other) => report.equal("state", other.to_string(), "metric not positive".to_owned()),
        Ok(state) => {
            let end = Course::from_state(&system, state, 1.0).run(setting);
            report.class(&end.outcome, "metric_not_positive");
            report.equal("time", end.t, 0.0);
        }
    }
}

/// The arithmetic-geometric mean.
fn agm(mut a: f64, mut b: f64) -> f64 {
    for _ in 0..8 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

fn light_bob(setting: Setting, report: &mut Report) {
    let pendulum = shipped("double_pendulum").with([("m2", 1e-12)]);
    let [length, g] = ["l1", "g"].map(|name| value(&pendulum, name));
    let start = 1.0_f64;
    let period = 2.0 * core::f64::consts::PI * (length / g).sqrt() / agm(1.0, (0.5 * start).cos());
    let end = Course::new(&pendulum, &[start, start], &[0.0, 0.0], 5.25 * period)
        .tol(1e-13)
        .run(setting);
    report.class(&end.outcome, "done");
    // After five and a quarter periods, the pendulum passes its lowest point at this rate.
    let rate = 2.0 * (g / length).sqrt() * (0.5 * start).sin();
    report.error(
        "time of the passage over the period",
        (end.q[0] / rate / period).abs(),
        1e-9,
    );
}

fn stiff_and_soft(setting: Setting, report: &mut Report) {
    let system = STIFF_AND_SOFT.model();
    let [k, depth] = ["k", "depth"].map(|name| value(&system, name));
    let t1 = (core::f64::consts::PI - (1.0 - depth).acos()) / k.sqrt();
    let end = Course::new(&system, &[1.0, 1.0], &[0.0, 0.0], 2000.0 * t1).run(setting);
    report.class(&end.outcome, "done");
    report.equal("impacts", end.hits.len(), 1000);
    report.near("y", end.q[1], end.t.cos(), 1e-10);
}
