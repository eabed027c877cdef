//! Section B, first part: accumulation of impacts on one surface (Zeno), and the contact that follows.

use dalembert::Outcome;
use dalembert::math::larger;
use dalembert_cli::suite::{Case, Report, Run, Setting};

use super::course::{Course, End, U, location};
use super::location::FALL;
use super::text::{Model, Text, value};

/// A ball on an incline without friction. `s` is the distance downhill, `y` the distance from the plane.
pub static INCLINE: Text = Text::new(
    "Incline {
        coordinates { s; y; }
        parameters { g > 0 = 1; slope = 0.3; e in [0, 1] = 0.5; }
        lagrangian = (dot(s)^2 + dot(y)^2)/2 + g*sin(slope)*s - g*cos(slope)*y;
        impacts { plane: y >= 0 => restitution(e); }
    }",
);

/// A point outside a sphere, in polar coordinates.
pub static SPHERE_TOP: Text = Text::new(
    "SphereTop {
        coordinates { r; phi; }
        parameters { g > 0 = 1; }
        lagrangian = (dot(r)^2 + r^2*dot(phi)^2)/2 - g*r*cos(phi);
        impacts { sphere: r >= 1 => impact_plastic; }
    }",
);

/// Two independent balls.
static TWO_BALLS: Text = Text::new(
    "TwoBalls {
        coordinates { x; y; }
        parameters { e in [0, 1] = 0.5; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - x - y;
        impacts { first: x >= 0 => restitution(e); second: y >= 0; }
    }",
);

/// The cases of this part.
pub const CASES: &[Case] = &[
    Case {
        id: "B01",
        title: "a ball with restitution e = 0.1 .. 0.999",
        right: "t_n = (2 v0/g)(1 - e^n)/(1 - e), accumulating at 2 v0/(g (1 - e))",
        bound: "`zeno` within 1e-10 of its time; every impact to P-LOC and a relative 16 u per impact",
        run: Run::Steps(geometric),
        ..Case::QUICK
    },
    Case {
        id: "B01b",
        title: "a ball after its impacts have accumulated",
        right: "x = 0 for ever",
        bound: "`done`, x = 0 at ten times the Zeno time",
        run: Run::Steps(|setting, report| {
            // With forced steps, restitution 0.99 takes two million steps, most of them held; see `B01c`.
            let is_forced = setting.max_step.is_some();
            let restitutions = if is_forced {
                &[0.1, 0.5][..]
            } else {
                &[0.1, 0.5, 0.9, 0.99]
            };
            after_accumulation(setting, report, restitutions);
        }),
        ..Case::QUICK
    },
    Case {
        id: "B01c",
        title: "the same with restitution 0.9 and 0.99, in forced steps too",
        right: "x = 0 for ever",
        bound: "`done`, x = 0 at ten times the Zeno time",
        run: Run::Steps(|setting, report| after_accumulation(setting, report, &[0.9, 0.99])),
        ..Case::NIGHTLY
    },
    Case {
        id: "B02",
        title: "restitution 1 - 1e-6 over 1000 units of time",
        right: "not yet accumulated; floor(ln(1 - t (1 - e)/2)/ln(e)) impacts",
        bound: "`done`, exact count",
        run: Run::Steps(slow_loss),
        ..Case::QUICK
    },
    Case {
        id: "B03",
        title: "an elastic ball thrown up at 1e-8, to a height of 5e-17",
        right: "50 000 impacts in 1e-3",
        bound: "exact count",
        run: Run::Steps(tiny_hops),
        ..Case::QUICK
    },
    Case {
        id: "B04",
        title: "a ball on an incline up to the accumulation",
        right: "accumulates at 2 v0/(g cos(a)(1 - e)); s = s1 t + g sin(a) t^2/2 meanwhile",
        bound: "1e-10; P-STATE(1e3)",
        run: Run::Steps(incline),
        ..Case::QUICK
    },
    Case {
        id: "B04b",
        title: "a ball on an incline across the accumulation",
        right: "s = s1 t + g sin(a) t^2/2, y = 0",
        bound: "P-STATE(1e3) at twice the Zeno time",
        run: Run::Steps(incline_after),
        ..Case::QUICK
    },
    Case {
        id: "B05",
        title: "sliding down a sphere from its top at speed 1/2, and off it",
        right: "leaves where cos(phi) = (2 + v0^2)/3, and keeps the horizontal velocity cos(phi)^(3/2)",
        bound: "1e-10",
        run: Run::Steps(sphere),
        ..Case::QUICK
    },
    Case {
        id: "B14",
        title: "one of two balls accumulates while the other bounces elastically",
        right: "the second ball's impacts as if it were alone: 2, 4, 6, ..",
        bound: "P-LOC",
        run: Run::Steps(two_balls),
        ..Case::QUICK
    },
];

/// Checks that a run ended with an accumulation of impacts within `bound` of the time `t`.
pub fn accumulates(report: &mut Report, name: &str, end: &End, t: f64, bound: f64) {
    report.class(&end.outcome, "zeno");
    if let Outcome::Zeno { t: found, .. } = end.outcome {
        report.near(format!("accumulation, {name}"), found, t, bound);
    }
}

fn geometric(setting: Setting, report: &mut Report) {
    for e in [0.1, 0.5, 0.9, 0.99, 0.999] {
        if e > 0.99 && setting.max_step.is_some() {
            continue;
        }
        let ball = FALL.with([("e", e)]);
        let limit = 2.0 / (1.0 - e);
        let end = Course::new(&ball, &[0.0], &[1.0], 2.0 * limit).run(setting);
        accumulates(report, &format!("e = {e}"), &end, limit, 1e-10 * limit);
        let late = |(n, hit): (usize, &super::course::Hit)| {
            let power = e.powi(n as i32 + 1);
            let t = limit * (1.0 - power);
            // Relative error of every flight, and rounding error of the gap at the height of the last flight.
            let spread = 16.0 * U * t * (n as f64 + 1.0);
            let height = 0.5 * (power / e).powi(2);
            (hit.t - t).abs()
                / (location(t, U * 64.0 * height, power / e, 1.0) + spread + end.eta(1.0))
        };
        let worst = end.hits.iter().enumerate().map(late).fold(0.0, larger);
        report.error(format!("worst time over its bound, e = {e}"), worst, 1.0);
        report.error(format!("depth, e = {e}"), (-end.q[0]).max(0.0), 1e-14);
    }
}

fn after_accumulation(setting: Setting, report: &mut Report, restitutions: &[f64]) {
    for &e in restitutions {
        let ball = FALL.with([("e", e)]);
        let limit = 2.0 / (1.0 - e);
        let end = Course::new(&ball, &[0.0], &[1.0], 10.0 * limit)
            .resting()
            .run(setting);
        report.class(&end.outcome, "done");
        report.equal(format!("x, e = {e}"), end.q[0], 0.0);
        report.equal(format!("v, e = {e}"), end.qdot[0], 0.0);
        report.equal(format!("holds, e = {e}"), end.holds.len(), 1);
        for hold in end.holds {
            let found = hold.accumulation.unwrap_or(f64::NAN);
            report.near(
                format!("accumulation, e = {e}"),
                found,
                limit,
                1e-10 * limit,
            );
        }
    }
}

fn slow_loss(setting: Setting, report: &mut Report) {
    let e = 1.0 - 1e-6;
    let ball = FALL.with([("e", e)]);
    let end = Course::new(&ball, &[0.0], &[1.0], 1e3).run(setting);
    report.class(&end.outcome, "done");
    let count = ((1.0 - 500.0 * (1.0 - e)).ln() / e.ln()).floor();
    report.equal("impacts", end.hits.len(), count as usize);
}

fn tiny_hops(setting: Setting, report: &mut Report) {
    // The end time is 1e-5 of its value after impact number 50 000, and before the next impact.
    let end = Course::new(&FALL.model(), &[0.0], &[1e-8], 1.00001e-3).run(setting);
    report.class(&end.outcome, "done");
    report.equal("impacts", end.hits.len(), 50_000);
}

/// Distance along the plane after the time `t`, for the initial speed `s1`.
fn slid(system: &Model, s1: f64, t: f64) -> f64 {
    let [g, slope] = ["g", "slope"].map(|name| value(system, name));
    s1 * t + 0.5 * g * slope.sin() * t * t
}

/// Time of accumulation for hops whose first speed is 1.
fn accumulation(system: &Model) -> f64 {
    let [g, slope, e] = ["g", "slope", "e"].map(|name| value(system, name));
    2.0 / (g * slope.cos() * (1.0 - e))
}

fn incline(setting: Setting, report: &mut Report) {
    let system = INCLINE.model();
    let limit = accumulation(&system);
    let end = Course::new(&system, &[0.0, 0.0], &[0.7, 1.0], 2.0 * limit).run(setting);
    accumulates(report, "plane", &end, limit, 1e-10 * limit);
    let s = slid(&system, 0.7, end.t);
    report.near("s", end.q[0], s, 1e3 * U * s + end.eta(s));
}

fn incline_after(setting: Setting, report: &mut Report) {
    let system = INCLINE.model();
    let until = 2.0 * accumulation(&system);
    let end = Course::new(&system, &[0.0, 0.0], &[0.7, 1.0], until)
        .resting()
        .run(setting);
    report.class(&end.outcome, "done");
    let s = slid(&system, 0.7, until);
    report.near("s", end.q[0], s, 1e3 * U * s + end.eta(s));
    report.equal("y", end.q[1], 0.0);
}

fn sphere(setting: Setting, report: &mut Report) {
    let end = Course::new(&SPHERE_TOP.model(), &[1.0, 0.0], &[0.0, 0.5], 3.0)
        .resting()
        .run(setting);
    report.class(&end.outcome, "done");
    let (r, phi) = (end.q[0], end.q[1]);
    let horizontal = end.qdot[0] * phi.sin() + r * end.qdot[1] * phi.cos();
    report.near("horizontal velocity", horizontal, 0.75_f64.powf(1.5), 1e-10);
    let left: Vec<f64> = end
        .holds
        .iter()
        .filter(|hold| !hold.begins)
        .map(|hold| hold.q[1].cos())
        .collect();
    report.equal("times left", left.len(), 1);
    for cos in left {
        report.near("cosine of the angle", cos, 0.75, 1e-10);
    }
}

fn two_balls(setting: Setting, report: &mut Report) {
    let end = Course::new(&TWO_BALLS.model(), &[0.0, 0.0], &[1.0, 1.0], 21.0)
        .resting()
        .run(setting);
    report.class(&end.outcome, "done");
    let second: Vec<f64> = end
        .hits
        .iter()
        .filter(|hit| hit.surface == 1)
        .map(|hit| hit.t)
        .collect();
    report.equal("impacts of the second", second.len(), 10);
    for (k, t) in second.into_iter().enumerate() {
        let right = 2.0 * (k + 1) as f64;
        report.near(
            format!("time {right}"),
            t,
            right,
            location(t, end.eta(4.0), 1.0, 1.0) + 16.0 * U * right * (k + 1) as f64,
        );
    }
}
