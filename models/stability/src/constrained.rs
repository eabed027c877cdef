//! Section D, first part: constrained motions, compared with solutions in closed form.

use dalembert_cli::suite::{Case, Report, Run, Setting, refusal};

use super::course::Course;
use super::text::{Large, Model, Text, shipped, value};

/// A skate on an incline, downhill along x. By default the walls at x = -far and y = -low are out of reach.
pub static SKATE: Text = Text::new(
    "Skate {
        coordinates { x; y; theta: angle; }
        parameters { pull = 0; far = 1e9; low = 1e9; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(theta)^2)/2 + pull*x;
        constraints { edge: sin(theta)*d(x) - cos(theta)*d(y) = 0; }
        impacts { wall: x + far >= 0; floor: y + low >= 0; }
    }",
);

/// A bead on a circle about the origin.
static BEAD_ON_CIRCLE: Text = Text::new(
    "BeadOnCircle {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { circle: d(x^2 + y^2) = 0; }
    }",
);

/// The cases of this part.
pub const CASES: &[Case] = &[
    Case {
        id: "D01",
        title: "a skate on an incline, turning, from rest, 100 turns",
        right: "x = (g sin a/2w^2) sin^2 wt, y = (g sin a/2w^2)(wt - sin(2wt)/2)",
        bound: "1e-11 of the largest distance",
        run: Run::Integrators(skate_on_incline),
        ..Case::QUICK
    },
    Case {
        id: "D02",
        title: "a vertical disk, free, over 100 turns",
        right: "x - x0 = (R roll/turn)(sin phi - sin phi0), likewise y; rates constant",
        bound: "1e-12 of the path's length",
        run: Run::Integrators(free_disk),
        ..Case::QUICK
    },
    Case {
        id: "D03",
        title: "the Chaplygin sleigh, free",
        right: "v = V tanh(s t + c), omega = sqrt(2E/K) sech(s t + c), and the angle their Gudermannian",
        bound: "1e-11",
        run: Run::Integrators(free_sleigh),
        ..Case::QUICK
    },
    Case {
        id: "D04",
        title: "a rolling ball whose Euler angle passes its pole at 1e-2",
        right: "a straight line at constant velocity",
        bound: "1e-8",
        run: Run::Integrators(|setting, report| past_the_pole(setting, report, 1e-2)),
        ..Case::QUICK
    },
    Case {
        id: "D04b",
        title: "a rolling ball whose Euler angle passes its pole at 1e-6 and 1e-12",
        right: "a straight line at constant velocity",
        bound: "1e-8",
        run: Run::Integrators(|setting, report| {
            past_the_pole(setting, report, 1e-6);
            past_the_pole(setting, report, 1e-12);
        }),
        ..Case::QUICK
    },
    Case {
        id: "D04c",
        title: "a rolling ball whose Euler angle goes through its pole",
        right: "the chart ends there",
        bound: "`left_chart`, `metric_not_positive` or `singular_constraint`; a finite state",
        run: Run::Integrators(through_the_pole),
        ..Case::QUICK
    },
    Case {
        id: "D05",
        title: "a homogeneous ball on a turntable of rate W",
        right: "the centre runs on a circle at rate 2W/7: back after 7 pi/W",
        bound: "1e-11",
        run: Run::Integrators(turntable),
        ..Case::QUICK
    },
    Case {
        id: "D09",
        title: "a bead on a circle, by an integrable constraint, 1000 turns",
        right: "the radius stays the same",
        bound: "1e-12; without projection at most 1e-8",
        run: Run::Integrators(bead),
        ..Case::QUICK
    },
    Case {
        id: "D07",
        title: "a constraint form that is twice another",
        right: "refused while building",
        bound: "a message that names both",
        run: Run::Once(dependent_forms),
        ..Case::QUICK
    },
];

fn skate_on_incline(setting: Setting, report: &mut Report) {
    let (pull, w) = (9.81 * 0.1_f64.sin(), 2.0);
    let system = SKATE.with([("pull", pull)]);
    let t = 200.0 * core::f64::consts::PI / w;
    let end = Course::new(&system, &[0.0; 3], &[0.0, 0.0, w], t)
        .tol(1e-13)
        .run(setting);
    report.class(&end.outcome, "done");
    let size = pull / (2.0 * w * w);
    let y = size * (w * t - 0.5 * (2.0 * w * t).sin());
    report.near("x", end.q[0], size * (w * t).sin().powi(2), 1e-11 * y);
    report.near("y", end.q[1], y, 1e-11 * y);
}

/// The radius of [`wide_disk`].
pub const RADIUS: f64 = 0.5;

/// A vertical disk on a table whose edge is out of reach.
pub fn wide_disk() -> Model {
    shipped("rolling_disk").with([
        ("m", 1.0),
        ("R", RADIUS),
        ("I", 0.125),
        ("J", 0.0625),
        ("ta", 1e9),
        ("tb", 1e9),
    ])
}

/// Position and path length at time `t` of a [`wide_disk`] that starts at the origin. The first argument holds the
/// rolling rate, the turning rate and the initial heading.
pub fn disk_at([roll, turn, phi]: [f64; 3], t: f64) -> [f64; 3] {
    let radius = RADIUS * roll / turn;
    let after = phi + turn * t;
    [
        radius * (after.sin() - phi.sin()),
        radius * (phi.cos() - after.cos()),
        (RADIUS * roll * t).abs(),
    ]
}

fn free_disk(setting: Setting, report: &mut Report) {
    let (disk, start) = (wide_disk(), [3.0, 0.7, 0.4_f64]);
    let [roll, turn, phi] = start;
    let t = 200.0 * core::f64::consts::PI / turn;
    let end = Course::new(
        &disk,
        &[0.0, 0.0, 0.0, phi],
        &[
            RADIUS * phi.cos() * roll,
            RADIUS * phi.sin() * roll,
            roll,
            turn,
        ],
        t,
    )
    .tol(1e-13)
    .run(setting);
    report.class(&end.outcome, "done");
    let [x, y, path] = disk_at(start, t);
    report.near("x", end.q[0], x, 1e-12 * path);
    report.near("y", end.q[1], y, 1e-12 * path);
    report.near("roll rate", end.qdot[2], roll, 1e-12);
    report.near("turn rate", end.qdot[3], turn, 1e-12);
}

fn free_sleigh(setting: Setting, report: &mut Report) {
    let [m, central, a] = [1.3, 0.7, 0.4];
    let values = [("m", m), ("I", central), ("a", a), ("ta", 1e6), ("tb", 1e6)];
    let sleigh = shipped("chaplygin_sleigh").with(values);
    let (v0, w0, t) = (-1.0, 0.5, 20.0);
    let inertia = central + m * a * a;
    let energy = 0.5 * (m * v0 * v0 + inertia * w0 * w0);
    let (speed, spin) = ((2.0 * energy / m).sqrt(), (2.0 * energy / inertia).sqrt());
    let s = a * m * speed / inertia;
    let c = (v0 / speed).atanh();
    let angle = |x: f64| 2.0 * (0.5 * x).tanh().atan();
    let turned = spin / s * (angle(s * t + c) - angle(c));
    let end = Course::new(&sleigh, &[0.0; 3], &[v0, 0.0, w0], t)
        .tol(1e-13)
        .run(setting);
    report.class(&end.outcome, "done");
    let theta = end.q[2];
    report.near(
        "v",
        end.qdot[0] * theta.cos() + end.qdot[1] * theta.sin(),
        speed * (s * t + c).tanh(),
        1e-11,
    );
    report.near(
        "v against 50 digits",
        speed * (s * t + c).tanh(),
        1.083_796_744_175_956_6,
        1e-14,
    );
    report.near("omega", end.qdot[2], spin / (s * t + c).cosh(), 1e-11);
    report.near("angle", theta, turned, 1e-11);
}

/// Euler angle rates of a body with its axis at `theta` that rotates about a horizontal axis at rate 1. The axis passes
/// the vertical at the smallest angle `least`.
fn towards_the_pole(theta: f64, least: f64) -> [f64; 3] {
    let phi = least.sin() / theta.sin().powi(2);
    let tilt = -(1.0 - (theta.sin() * phi).powi(2)).sqrt();
    [phi, tilt, -phi * theta.cos()]
}

/// Velocities of the rolling ball with the Euler angle rates `[phi, theta, psi]` at the angles `at = [theta, psi]`.
fn rolling(ball: &Large, [phi, theta, psi]: [f64; 3], at: [f64; 2]) -> [f64; 5] {
    let (sin, cos) = at[1].sin_cos();
    let omega = [
        cos * theta + sin * at[0].sin() * phi,
        sin * theta - cos * at[0].sin() * phi,
    ];
    let r = value(ball, "r");
    [r * omega[1], -r * omega[0], phi, theta, psi]
}

fn past_the_pole(setting: Setting, report: &mut Report, least: f64) {
    let ball = shipped("rolling_ball_euler").large([("ta", 1e6), ("tb", 1e6)]);
    let (theta, psi) = (1.0, 0.3);
    let velocity = rolling(&ball, towards_the_pole(theta, least), [theta, psi]);
    let end = Course::new(&ball, &[0.0, 0.0, 0.2, theta, psi], &velocity, 2.0)
        .tol(1e-13)
        .steps(10_000)
        .run(setting);
    report.class(&end.outcome, "done");
    report.near(
        format!("x, least angle {least:e}"),
        end.q[0],
        2.0 * velocity[0],
        1e-8,
    );
    report.near(
        format!("y, least angle {least:e}"),
        end.q[1],
        2.0 * velocity[1],
        1e-8,
    );
}

fn through_the_pole(setting: Setting, report: &mut Report) {
    let ball = shipped("rolling_ball_euler").large([("ta", 1e6), ("tb", 1e6)]);
    let velocity = rolling(&ball, [0.0, -1.0, 0.0], [1.0, 0.0]);
    let end = Course::new(&ball, &[0.0, 0.0, 0.2, 1.0, 0.0], &velocity, 2.0).run(setting);
    report.one_of(
        &end.outcome,
        &["left_chart", "metric_not_positive", "singular_constraint"],
    );
    report.error("time", (end.t - 1.0).max(0.0), 1e-9);
    report.equal(
        "state finite",
        end.q.iter().all(|value| value.is_finite()),
        true,
    );
}

fn turntable(setting: Setting, report: &mut Report) {
    let rate = 2.0;
    let ball =
        shipped("ball_on_rotating_table").large([("r", 1.0), ("k", 0.4_f64.sqrt()), ("Om", rate)]);
    let t = 7.0 * core::f64::consts::PI / rate;
    let q = [0.05, 0.02, 0.2, 1.2, 0.4];
    let end = Course::new(&ball, &q, &[0.0, 0.0, 0.02, 0.01, -0.02], t)
        .tol(1e-13)
        .run(setting);
    report.class(&end.outcome, "done");
    report.near("x", end.q[0], q[0], 1e-11);
    report.near("y", end.q[1], q[1], 1e-11);
}

fn bead(setting: Setting, report: &mut Report) {
    let t = 2000.0 * core::f64::consts::PI;
    for (projection, bound) in [(true, 1e-12), (false, 1e-8)] {
        let end = Course::new(&BEAD_ON_CIRCLE.model(), &[1.0, 0.0], &[0.0, 1.0], t)
            .projection(projection)
            .run(setting);
        report.class(&end.outcome, "done");
        let name = if projection {
            "radius"
        } else {
            "radius, without projection"
        };
        report.near(name, end.q[0].hypot(end.q[1]), 1.0, bound);
    }
}

fn dependent_forms(report: &mut Report) {
    let source = "Pair { coordinates { x; y; z; } lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2; \
                  constraints { first: d(x) - z*d(y) = 0; second: 2*d(x) - 2*z*d(y) = 0; } }";
    let said = refusal(source).unwrap_or_default();
    report.equal(
        "message",
        said.contains("`second` is dependent on `first`"),
        true,
    );
}
