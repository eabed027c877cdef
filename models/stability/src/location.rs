//! Section A, first part: impacts at the start, at the end and in grazes.

use dalembert_cli::suite::{Case, Report, Run, Setting};

use super::course::{Course, End, U, location};
use super::text::Text;

/// A point that falls on a floor or rises from it.
pub static FALL: Text = Text::new(
    "Fall {
        coordinates { x; }
        parameters { g = 1; e in [0, 1] = 1; }
        lagrangian = dot(x)^2/2 - g*x;
        impacts { floor: x >= 0 => restitution(e); }
    }",
);

/// The cases.
pub const CASES: &[Case] = &[
    Case {
        id: "A01",
        title: "leaving the floor at the start",
        right: "no event at 0; impacts at t = 2, 4",
        bound: "P-LOC",
        run: Run::Steps(|setting, report| thrown(setting, report, 1.0, &[2.0, 4.0])),
        ..Case::QUICK
    },
    Case {
        id: "A02",
        title: "entering the floor at the start",
        right: "one impact at t = 0, then at 2, 4",
        bound: "P-LOC",
        run: Run::Steps(|setting, report| thrown(setting, report, -1.0, &[0.0, 2.0, 4.0])),
        ..Case::QUICK
    },
    Case {
        id: "A03",
        title: "at rest on the floor",
        right: "rests for ever, no impacts, x = 0",
        bound: "x = 0 at t = 1e6",
        run: Run::Integrators(at_rest),
        ..Case::QUICK
    },
    Case {
        id: "A04",
        title: "at rest on the floor, pulled away from it",
        right: "leaves at once, x = t^2/2, no event",
        bound: "8 u, and one u per step",
        run: Run::Steps(pulled_away),
        ..Case::QUICK
    },
    Case {
        id: "A05",
        title: "near grazes: h'' = 2, h(0) = 1 - eps, h'(0) = -2, eps = 1e-2 .. 1e-12",
        right: "one impact at 1 - sqrt(eps); h(3) = 4 + 8 sqrt(eps) + 3 eps",
        bound: "P-LOC; h(3) to 4 eta/sqrt(eps) + 16 eta, the effect of the error of the impact's speed",
        run: Run::Steps(near_grazes),
        ..Case::QUICK
    },
    Case {
        id: "A06",
        title: "an exact graze",
        right: "state unchanged, h(3) = 4",
        bound: "16 sqrt(eta); at most one record, flagged as a graze",
        run: Run::Steps(|setting, report| graze(setting, report, 0.0)),
        ..Case::QUICK
    },
    Case {
        id: "A07",
        title: "a near miss by 1e-15",
        right: "no impact, h(3) = 4 + 1e-15",
        bound: "as A06",
        run: Run::Steps(|setting, report| graze(setting, report, -1e-15)),
        ..Case::QUICK
    },
    Case {
        id: "A08",
        title: "a graze by 1e-15, within rounding",
        right: "either branch, h(3) near 4",
        bound: "as A06",
        run: Run::Steps(|setting, report| graze(setting, report, 1e-15)),
        ..Case::QUICK
    },
    Case {
        id: "A15",
        title: "an impact exactly at the end time",
        right: "one record at t = 1; continuing to 2 adds none",
        bound: "exact count",
        run: Run::Steps(at_the_end),
        ..Case::QUICK
    },
    Case {
        id: "A16",
        title: "an impact exactly on a step boundary",
        right: "one record at t = 1",
        bound: "exact count",
        run: Run::Steps(on_a_boundary),
        ..Case::QUICK
    },
];

/// Checks the impact times of a point thrown up or down from the floor against `times`.
fn thrown(setting: Setting, report: &mut Report, speed: f64, times: &[f64]) {
    let end = Course::new(&FALL.model(), &[0.0], &[speed], 5.0).run(setting);
    report.class(&end.outcome, "done");
    report.equal("impacts", end.hits.len(), times.len());
    for (hit, &t) in end.hits.iter().zip(times) {
        report.near(
            format!("time {t}"),
            hit.t,
            t,
            location(t, end.eta(4.0), 1.0, 1.0),
        );
    }
}

fn at_rest(setting: Setting, report: &mut Report) {
    let end = Course::new(&FALL.model(), &[0.0], &[0.0], 1e6)
        .resting()
        .run(setting);
    report.class(&end.outcome, "done");
    report.equal("impacts", end.hits.len(), 0);
    report.equal("holds", end.holds.len(), 1);
    report.equal("x", end.q[0], 0.0);
}

fn pulled_away(setting: Setting, report: &mut Report) {
    let system = FALL.with([("g", -1.0)]);
    let end = Course::new(&system, &[0.0], &[0.0], 2.0).run(setting);
    report.class(&end.outcome, "done");
    report.equal("impacts", end.hits.len(), 0);
    let steps = end.counters.accepted as f64;
    report.near("x", end.q[0], 2.0, 2.0 * U * (8.0 + steps));
}

/// A run with `h'' = 2`, `h(0) = 1 - eps`, `h'(0) = -2` up to t = 3.
fn parabola(setting: Setting, eps: f64) -> End {
    let system = FALL.with([("g", -2.0)]);
    Course::new(&system, &[1.0 - eps], &[-2.0], 3.0).run(setting)
}

fn near_grazes(setting: Setting, report: &mut Report) {
    for eps in [1e-2, 1e-4, 1e-8, 1e-12] {
        // The start stores the rounded number 1 - eps; `held` is its exact distance from 1.
        let held: f64 = 1.0 - (1.0 - eps);
        let root = held.sqrt();
        let end = parabola(setting, eps);
        report.class(&end.outcome, "done");
        report.equal(format!("impacts, eps = {eps:e}"), end.hits.len(), 1);
        // The absolute values of the terms of the gap 1 - eps - 2 t + t^2 add up to 4 near t = 1.
        let eta = end.eta(4.0);
        for hit in &end.hits {
            let bound = location(1.0, eta, 2.0 * root, 2.0);
            report.near(format!("time, eps = {eps:e}"), hit.t, 1.0 - root, bound);
            report.equal(format!("graze, eps = {eps:e}"), hit.graze, false);
        }
        let exact = 4.0 + 8.0 * root + 3.0 * held;
        report.near(
            format!("h(3), eps = {eps:e}"),
            end.q[0],
            exact,
            4.0 * eta / root + 16.0 * eta,
        );
    }
}

fn graze(setting: Setting, report: &mut Report, eps: f64) {
    let end = parabola(setting, eps);
    report.class(&end.outcome, "done");
    report.near("h(3)", end.q[0], 4.0, 16.0 * end.eta(4.0).sqrt());
    report.error("records", end.hits.len() as f64, 1.0);
    report.equal("all flagged", end.hits.iter().all(|hit| hit.graze), true);
}

fn at_the_end(setting: Setting, report: &mut Report) {
    let system = FALL.with([("g", 0.0)]);
    let first = Course::new(&system, &[1.0], &[-1.0], 1.0).run(setting);
    report.class(&first.outcome, "done");
    report.equal("impacts up to the end", first.hits.len(), 1);
    let second = Course::new(&system, &first.q, &first.qdot, 2.0)
        .at(1.0)
        .run(setting);
    report.equal("impacts after it", second.hits.len(), 0);
    report.near("x(2)", second.q[0], 1.0, first.eta(1.0) + second.eta(1.0));
}

fn on_a_boundary(setting: Setting, report: &mut Report) {
    let system = FALL.with([("g", 0.0)]);
    let end = Course::new(&system, &[1.0], &[-1.0], 2.0).run(setting);
    report.class(&end.outcome, "done");
    report.equal("impacts", end.hits.len(), 1);
    report.near("x(2)", end.q[0], 1.0, end.eta(1.0));
}
