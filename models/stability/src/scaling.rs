//! Section E: scaling, reflection, extreme numbers, arithmetic of generated code.

use dalembert::System;
use dalembert::math::larger;
use dalembert_cli::suite::{Case, Report, Run, Setting};

use super::course::{Course, End, location, vector};
use super::location::FALL;
use super::tables::elliptic_table;
use super::text::{Text, shipped, value};
use super::zeno::{INCLINE, SPHERE_TOP};

/// A point mass on a hardening spring above a floor.
pub static HOPPER: Text = Text::new(
    "Hopper {
        coordinates { x; }
        parameters { g = 1; c = 1/2; }
        lagrangian = dot(x)^2/2 - g*x - c*x^4/4;
        impacts { floor: x >= 0; }
    }",
);

/// The same model, upside down.
static HOPPER_MIRRORED: Text = Text::new(
    "HopperMirrored {
        coordinates { x; }
        parameters { g = 1; c = 1/2; }
        lagrangian = dot(x)^2/2 + g*x - c*x^4/4;
        impacts { ceiling: x <= 0; }
    }",
);

/// The rolling disk with other names, declared in another order.
static DISK_RENAMED: Text = Text::new(
    "DiskRenamed {
        coordinates { heading: angle; roll: angle; north; east; }
        parameters { side = 0.2; front = 0.2; turning > 0 = 6.25e-8; rolling > 0 = 1.25e-7; radius > 0 = 0.01; mass > 0 = 0.0025; }
        let h(u, v) = 1 - v^2/side^2 - u^2/front^2;
        lagrangian = turning/2*dot(heading)^2 + mass/2*(dot(north)^2 + dot(east)^2) + rolling/2*dot(roll)^2;
        constraints {
            second: dot(north) = radius*sin(heading)*dot(roll);
            first: dot(east) = radius*cos(heading)*dot(roll);
        }
        impacts {
            back: h(north - radius*sin(heading), east - radius*cos(heading)) >= 0;
            front: h(north + radius*sin(heading), east + radius*cos(heading)) >= 0;
        }
    }",
);

/// The cases of this section.
pub const CASES: &[Case] = &[
    Case {
        id: "E01",
        title: "lengths scaled by 2^k and times by 2^j, k and j of -40, -10, 10, 40",
        right: "the same run in other units",
        bound: "bit for bit",
        run: Run::Integrators(|setting, report| scaled(setting, report, 2.0, 0.0)),
        ..Case::QUICK
    },
    Case {
        id: "E02",
        title: "lengths and times scaled by 10^12 and 10^-12",
        right: "the same run in other units",
        bound: "1e-11; the same number of impacts",
        run: Run::Integrators(|setting, report| scaled(setting, report, 10.0, 1e-11)),
        ..Case::QUICK
    },
    Case {
        id: "E03",
        title: "a model and its mirror image",
        right: "mirrored runs",
        bound: "bit for bit",
        run: Run::Steps(mirrored),
        ..Case::QUICK
    },
    Case {
        id: "E04",
        title: "the rolling disk with other names in another order",
        right: "the same run",
        bound: "1e-11 after ten impacts, which amplify rounding errors",
        run: Run::Integrators(renamed),
        ..Case::QUICK
    },
    Case {
        id: "E05",
        title: "states and parameters of 1e-310",
        right: "the same class of outcome as at 2^200 times the size",
        bound: "the same outcome and number of impacts",
        run: Run::Integrators(denormal),
        ..Case::QUICK
    },
    Case {
        id: "E06",
        title: "a velocity of 1e160, whose square overflows",
        right: "the motion cannot be represented in doubles",
        bound: "`non_finite` with a finite state",
        run: Run::Steps(overflow),
        ..Case::QUICK
    },
    Case {
        id: "E08",
        title: "a ball of period 1e-3 from t = 1e9 on",
        right: "flights of 1e-3, measured by a coordinate that grows at rate 1",
        bound: "1e-12 relative",
        run: Run::Integrators(late_start),
        ..Case::QUICK
    },
    Case {
        id: "E09",
        title: "a circle of radius 1e8 with a gap of one unit in the last place",
        right: "an impact as soon as the gap exceeds its rounding error",
        bound: "P-LOC for a gap whose terms add up to 2",
        run: Run::Steps(large_circle),
        ..Case::QUICK
    },
];

/// A run of the hopper from height 1 to t = 20, with lengths scaled by `length` and times by `time`. The absolute
/// tolerance is negligible, because a single number cannot scale like a length and like a speed.
fn hopper(setting: Setting, length: f64, time: f64) -> End {
    let rate = length / time;
    let system = HOPPER.with([
        ("g", rate / time),
        ("c", 0.5 / (time * length) / (time * length)),
    ]);
    Course::new(&system, &[length], &[0.3 * rate], 20.0 * time)
        .tols(1e-11, 1e-300)
        .run(setting)
}

fn scaled(setting: Setting, report: &mut Report, base: f64, bound: f64) {
    let reference = hopper(setting, 1.0, 1.0);
    report.class(&reference.outcome, "done");
    let powers: &[i32] = if base == 2.0 {
        &[-40, -10, 10, 40]
    } else {
        &[-12, 12]
    };
    for (k, j) in powers
        .iter()
        .flat_map(|&k| powers.iter().map(move |&j| (k, j)))
    {
        let (length, time) = (base.powi(k), base.powi(j));
        let end = hopper(setting, length, time);
        report.class(&end.outcome, "done");
        report.equal(
            format!("impacts, {base}^({k}, {j})"),
            end.hits.len(),
            reference.hits.len(),
        );
        let last = |end: &End| end.hits.last().map_or(f64::NAN, |hit| hit.t);
        let values = [
            ("x", end.q[0] / length, reference.q[0]),
            ("v", end.qdot[0] / (length / time), reference.qdot[0]),
            ("last impact", last(&end) / time, last(&reference)),
        ];
        for (name, found, right) in values {
            let name = format!("{name}, {base}^({k}, {j})");
            match bound {
                0.0 => report.equal(name, found, right),
                // The error of a position is proportional to the speed.
                bound => report.near(name, found, right, bound * right.abs().max(1.0)),
            }
        }
    }
}

fn mirrored(setting: Setting, report: &mut Report) {
    let one = Course::new(&HOPPER.model(), &[1.0], &[0.3], 20.0).run(setting);
    let other = Course::new(&HOPPER_MIRRORED.model(), &[-1.0], &[-0.3], 20.0).run(setting);
    report.class(&one.outcome, "done");
    report.class(&other.outcome, "done");
    report.equal("times", other.times(), one.times());
    report.equal("x", -other.q[0], one.q[0]);
    report.equal("v", -other.qdot[0], one.qdot[0]);
}

fn renamed(setting: Setting, report: &mut Report) {
    let disk = shipped("rolling_disk").with([("ta", 0.2), ("tb", 0.2)]);
    let (phi, roll, turn) = (1.2_f64, 10.0, 0.2);
    let radius = value(&disk, "R");
    let [vx, vy] = [radius * phi.cos() * roll, radius * phi.sin() * roll];
    let one = Course::new(&disk, &[0.0, 0.0, 0.0, phi], &[vx, vy, roll, turn], 1e3)
        .impacts(10)
        .run(setting);
    let again = DISK_RENAMED.model();
    let other = Course::new(&again, &[phi, 0.0, 0.0, 0.0], &[turn, roll, vy, vx], 1e3)
        .impacts(10)
        .run(setting);
    report.class(&one.outcome, "impact_budget");
    report.class(&other.outcome, "impact_budget");
    report.near("time", other.t, one.t, 1e-11 * one.t);
    for (i, k) in [(0, 3), (1, 2), (2, 1), (3, 0)] {
        let size = one.q[i].abs().max(1.0);
        report.near(
            format!("coordinate {i}"),
            other.q[k],
            one.q[i],
            1e-11 * size,
        );
    }
}

fn denormal(setting: Setting, report: &mut Report) {
    let run = |size: f64| {
        let system = FALL.with([("g", size)]);
        Course::new(&system, &[size], &[0.0], 5.0)
            .tols(1e-10, 1e-10)
            .run(setting)
    };
    let (small, large) = (run(1e-310), run(1e-310 * 2.0_f64.powi(200)));
    report.equal("outcome", small.outcome.kind(), large.outcome.kind());
    report.equal("impacts", small.hits.len(), large.hits.len());
    report.equal("finite", small.q[0].is_finite() && small.q[0] >= 0.0, true);
}

fn overflow(setting: Setting, report: &mut Report) {
    let system = SPHERE_TOP.model();
    let state = system
        .state_unchecked(0.0, &vector(&[2.0, 0.0]), &vector(&[0.0, 1e160]))
        .expect("a state");
    let end = Course::from_state(&system, state, 1.0).run(setting);
    report.class(&end.outcome, "non_finite");
    report.equal(
        "state finite",
        end.q.iter().all(|value| value.is_finite()),
        true,
    );
}

fn late_start(setting: Setting, report: &mut Report) {
    // On a level incline `s` moves at rate 1, so that its value is the time since the start.
    let system = INCLINE.with([("g", 1.0), ("slope", 0.0), ("e", 1.0)]);
    let end = Course::new(&system, &[0.0, 0.0], &[1.0, 5e-4], 1e9 + 0.1005)
        .at(1e9)
        .run(setting);
    report.class(&end.outcome, "done");
    report.equal("impacts", end.hits.len(), 100);
    let flights = end
        .hits
        .windows(2)
        .map(|pair| (pair[1].q[0] - pair[0].q[0]) / 1e-3 - 1.0);
    report.error("flights", flights.map(f64::abs).fold(0.0, larger), 1e-12);
}

fn large_circle(setting: Setting, report: &mut Report) {
    let radius = 1e8;
    let table = elliptic_table(radius, radius);
    let gap = radius * f64::EPSILON;
    let end = Course::new(&table, &[radius - gap, 0.0], &[1.0, 0.0], 1.0).run(setting);
    report.class(&end.outcome, "done");
    report.equal("impacts", end.hits.len(), 1);
    // The gap is declared divided by R^2: its terms add up to 2, its rate is 2/R.
    let t = radius - (radius - gap);
    for hit in &end.hits {
        report.near(
            "time",
            hit.t,
            t,
            location(t, end.eta(2.0), 2.0 / radius, 0.0),
        );
    }
}
