//! Modes: sliding and crossing between two fields, refraction at a step, mode changes together with impacts.

use dalembert_cli::suite::{Case, Report, Run, Setting};

use super::course::{Course, U};
use super::text::{Text, shipped};

/// A slider that is caught at x = 1 while a clock continues, and is thrown back when the clock shows 2.
static LATCH: Text = Text::new(
    "Latch {
        coordinates { x; clock; }
        lagrangian = (dot(x)^2 + dot(clock)^2)/2;
        modes {
            free { }
            held { constraints { hold: d(x) = 0; } }
        }
        transitions {
            catch: free -> held when x >= 1;
            release: held -> free when clock >= 2 => reset { dot(x) = -1; };
        }
    }",
);

/// Two media above a floor.
static CORNER: Text = Text::new(
    "Corner {
        coordinates { x; y; }
        parameters { m2 > 0 = 2; }
        modes {
            left {
                lagrangian = (dot(x)^2 + dot(y)^2)/2;
            }
            right { lagrangian = m2/2*(dot(x)^2 + dot(y)^2); }
        }
        impacts { floor: y >= 0; }
        transitions { cross: left -> right when x >= 0; }
    }",
);

/// A ledge that ends where the mode changes.
static BRINK: Text = Text::new(
    "Brink {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        modes {
            above { impacts { ledge: y >= 0; } }
            beyond { }
        }
        transitions { over: above -> beyond when x >= 0; }
    }",
);

/// The cases.
pub const CASES: &[Case] = &[
    Case {
        id: "B12",
        title: "sliding between the fields (-2, 1) and (1, -1)",
        right: "the sliding vector (0, -1/3) from the hit on",
        bound: "one switch, then sliding; P-STATE(1e3)",
        run: Run::Steps(sliding),
        ..Case::QUICK
    },
    Case {
        id: "B13",
        title: "crossing between the fields (-2, 1) and (-1, -1)",
        right: "crosses once",
        bound: "one record, no slide",
        run: Run::Steps(crossing),
        ..Case::QUICK
    },
    Case {
        id: "C15",
        title: "a step dV of the potential across a surface",
        right: "p_n+ = sqrt(p_n^2 - 2 m dV) where real, else reflected; p_t kept",
        bound: "8 u; a graze where p_n^2 = 2 m dV",
        run: Run::Steps(step),
        ..Case::QUICK
    },
    Case {
        id: "C16",
        title: "a step of the potential by 0",
        right: "the identity",
        bound: "bit for bit",
        run: Run::Steps(no_step),
        ..Case::QUICK
    },
    Case {
        id: "C17",
        title: "refraction between metrics n_i^2 |dx|^2",
        right: "n1 sin a1 = n2 sin a2; total reflection beyond the critical angle",
        bound: "16 u",
        run: Run::Steps(refraction),
        ..Case::QUICK
    },
    Case {
        id: "C18",
        title: "a mode that changes at a catch and back at a second surface",
        right: "x = t, then 1, then 1 - (t - 2)",
        bound: "exact sequence of modes; 64 u",
        run: Run::Steps(latch),
        ..Case::QUICK
    },
    Case {
        id: "C19",
        title: "an impact exactly where a mode changes",
        right: "the same in either order where both modes have the floor",
        bound: "the same after a shift of 1e-15; `ambiguous` where only one has it",
        run: Run::Steps(corner),
        ..Case::QUICK
    },
];

fn sliding(setting: Setting, report: &mut Report) {
    let field = shipped("filippov_field").model();
    let end = Course::new(&field, &[1.0, 0.0], &[0.0; 2], 3.5).run(setting);
    report.class(&end.outcome, "done");
    report.equal("switches", end.hits.len(), 1);
    report.equal("slides", end.holds.len(), 1);
    report.near("x", end.q[0], 0.0, 1e3 * U);
    report.near("y", end.q[1], 0.5 - 1.0, 1e3 * U);
}

fn crossing(setting: Setting, report: &mut Report) {
    let field = shipped("filippov_field").with([("gx", -1.0)]);
    let end = Course::new(&field, &[1.0, 0.0], &[0.0; 2], 3.5).run(setting);
    report.class(&end.outcome, "done");
    report.equal("switches", end.hits.len(), 1);
    report.equal("slides", end.holds.len(), 0);
    report.near("x", end.q[0], -3.0, 1e3 * U);
    report.near("y", end.q[1], 0.5 - 3.0, 1e3 * U);
}

/// Velocity after the surface, and end of the run, of a particle that enters a medium of mass `m2` from the left with
/// momenta `p`. `step`: the potential in the medium.
fn entering(setting: Setting, p: [f64; 2], m2: f64, step: f64) -> ([f64; 2], super::course::End) {
    let particle = shipped("refracted_particle").with([("m2", m2), ("V2", step)]);
    let end = Course::new(&particle, &[-1.0, 0.0], &p, 1.5 / p[0]).run(setting);
    let after = match end.hits.first() {
        Some(hit) => [hit.after[0], hit.after[1]],
        None => [f64::NAN; 2],
    };
    (after, end)
}

fn step(setting: Setting, report: &mut Report) {
    for (n, dv) in [0.3, -0.7, 0.01, 0.499_999].into_iter().enumerate() {
        let ([x, y], end) = entering(setting, [1.0, 0.75], 1.0, dv);
        report.class(&end.outcome, "done");
        // The square root halves the relative error that the difference has by cancellation.
        let right = (1.0 - 2.0 * dv).sqrt();
        report.near(format!("p_n, {n}"), x, right, 8.0 * U / right.min(1.0));
        report.near(format!("p_t, {n}"), y, 0.75, 8.0 * U);
        report.equal("no graze", end.hits[0].graze, false);
    }
    let ([x, y], end) = entering(setting, [1.0, 0.75], 1.0, 0.7);
    report.near("reflected", x, -1.0, 8.0 * U);
    report.near("p_t", y, 0.75, 8.0 * U);
    report.class(&end.outcome, "done");
    let (_, end) = entering(setting, [1.0, 0.75], 1.0, 0.5);
    report.equal("a graze", end.hits[0].graze, true);
}

fn no_step(setting: Setting, report: &mut Report) {
    for p in [[1.0, 0.75], [0.7, -1e3], [3.0, 0.1]] {
        let (after, end) = entering(setting, p, 1.0, 0.0);
        report.class(&end.outcome, "done");
        report.equal("bits", after.map(f64::to_bits), p.map(f64::to_bits));
    }
}

fn refraction(setting: Setting, report: &mut Report) {
    // The metric n^2 |dx|^2 belongs to the mass n^2. Velocities are those of light rays up to a factor.
    let ratio: f64 = 1.0 / 1.5;
    for angle in [0.1_f64, 0.5, 0.7, 0.72, 0.74, 1.2] {
        let (sine, cosine) = angle.sin_cos();
        let ([x, y], end) = entering(setting, [cosine, sine], ratio * ratio, 0.0);
        report.class(&end.outcome, "done");
        if sine > ratio {
            report.near(format!("reflected at {angle}"), x, -cosine, 16.0 * U);
            report.near(format!("kept at {angle}"), y, sine, 16.0 * U);
        } else {
            let refracted = y / x.hypot(y);
            report.near(
                format!("n sin a at {angle}"),
                ratio * refracted,
                sine,
                16.0 * U,
            );
        }
    }
}

fn latch(setting: Setting, report: &mut Report) {
    let end = Course::new(&LATCH.model(), &[0.0; 2], &[1.0; 2], 3.0).run(setting);
    report.class(&end.outcome, "done");
    let surfaces: Vec<usize> = end.hits.iter().map(|hit| hit.surface).collect();
    report.equal("sequence", surfaces, vec![0, 1]);
    for (hit, t) in end.hits.iter().zip([1.0, 2.0]) {
        report.near(format!("change at {t}"), hit.t, t, 64.0 * U);
        report.near(format!("x at {t}"), hit.q[0], 1.0, 64.0 * U);
    }
    report.near("x", end.q[0], 0.0, 64.0 * U);
    report.near("clock", end.q[1], 3.0, 64.0 * U);
}

fn corner(setting: Setting, report: &mut Report) {
    let media = CORNER.model();
    let mut ends = Vec::new();
    for off in [0.0, 1e-15, -1e-15] {
        let start = [-1.0, 1.0 + off];
        let end = Course::new(&media, &start, &[1.0, -1.0], 2.0).run(setting);
        report.class(&end.outcome, "done");
        report.equal("impact and change", end.hits.len(), 2);
        ends.push(end.q);
    }
    for end in &ends[1..] {
        report.near("x", end[0], ends[0][0], 1e-14);
        report.near("y", end[1], ends[0][1], 1e-14);
    }
    let end = Course::new(&BRINK.model(), &[-1.0, 1.0], &[1.0, -1.0], 2.0).run(setting);
    report.class(&end.outcome, "ambiguous");
}
