//! Section C, second part: corners, chains of impacts and cusps.

use dalembert_cli::suite::{Case, Report, Run, Setting};

use super::course::{Course, End, U};
use super::text::{Model, Text};

/// A free point in a corner with angle `angle` at the origin.
static CORNER: Text = Text::new(
    "Corner {
        coordinates { x; y; }
        parameters { angle > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { first: y >= 0; second: sin(angle)*x - cos(angle)*y >= 0; }
    }",
);

/// The same corner, with its surfaces declared in the other order.
static CORNER_AGAIN: Text = Text::new(
    "CornerAgain {
        coordinates { x; y; }
        parameters { angle > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { second: sin(angle)*x - cos(angle)*y >= 0; first: y >= 0; }
    }",
);

/// Three masses on a line.
static THREE_MASSES: Text = Text::new(
    "ThreeMasses {
        coordinates { x1; x2; x3; }
        parameters { middle > 0 = 1; }
        lagrangian = (dot(x1)^2 + middle*dot(x2)^2 + dot(x3)^2)/2;
        impacts { left: x2 >= x1; right: x3 >= x2; }
    }",
);

/// A small mass between a wall and a heavy block.
static BLOCK_AND_WALL: Text = Text::new(
    "BlockAndWall {
        coordinates { u; v; }
        parameters { M > 0 = 1; }
        lagrangian = (dot(u)^2 + M*dot(v)^2)/2;
        impacts { wall: u >= 0; block: v >= u; }
    }",
);

/// A free point between two parabolas that touch.
static CUSP: Text = Text::new(
    "Cusp {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { upper: y <= x^2; lower: y >= -x^2; }
    }",
);

/// The cases.
pub const CASES: &[Case] = &[
    Case {
        id: "C05",
        title: "a right-angled corner hit exactly",
        right: "v -> -v, by two records at one time",
        bound: "exact; both flagged `simultaneous`",
        run: Run::Steps(right_angle),
        ..Case::QUICK
    },
    Case {
        id: "C06",
        title: "a right-angled corner missed by 1e-13 and 1e-16",
        right: "the same limit",
        bound: "1e-12",
        run: Run::Steps(right_angle_missed),
        ..Case::QUICK
    },
    Case {
        id: "C07",
        title: "corners of angles pi/3, pi/4, pi/5, pi/7 hit exactly",
        right: "n reflections: out at the angle it came from, mirrored at the bisector for odd n",
        bound: "16 u, in both orders of declaration",
        run: Run::Steps(dihedral),
        ..Case::QUICK
    },
    Case {
        id: "C08",
        title: "corners of angles 2 pi/5 and 100 degrees hit exactly",
        right: "the two orders differ",
        bound: "`ambiguous`",
        run: Run::Steps(other_angles),
        ..Case::QUICK
    },
    Case {
        id: "C09",
        title: "three equal masses that touch, the first moving",
        right: "(1, 0, 0) -> (0, 0, 1)",
        bound: "exact",
        run: Run::Steps(equal_masses),
        ..Case::QUICK
    },
    Case {
        id: "C10",
        title: "masses 1, 2, 1 that touch, both ends moving in",
        right: "the order matters: metric angle acos(1/3)",
        bound: "`ambiguous`",
        run: Run::Steps(unequal_masses),
        ..Case::QUICK
    },
    Case {
        id: "C11",
        title: "block and wall, mass ratios 1 to 100^4",
        right: "ceil(pi/atan(10^-N)) - 1 collisions: 3, 31, 314, 3141, 31415",
        bound: "exact counts; speeds to 1e-9; energy to 16 u sqrt(count)",
        run: Run::Integrators(|setting, report| digits_of_pi(setting, report, 0..=4)),
        ..Case::QUICK
    },
    Case {
        id: "C11b",
        title: "block and wall, mass ratios 100^5 and 100^6",
        right: "314159 and 3141592 collisions",
        bound: "as C11",
        run: Run::Integrators(|setting, report| digits_of_pi(setting, report, 5..=6)),
        ..Case::NIGHTLY
    },
    Case {
        id: "C13",
        title: "a cusp |y| <= x^2 entered at slopes 0.05, 0.01, 0.001",
        right: "left again after 5, 14, 73 reflections",
        bound: "exact counts; exit velocity to 1e-9 for 0.01",
        run: Run::Steps(cusp),
        ..Case::QUICK
    },
];

fn right_angle(setting: Setting, report: &mut Report) {
    // The surfaces are `y >= 0` and `x - cos(pi/2) y >= 0`. Up to rounding this is the corner `x >= 0`, `y >= 0`.
    let system = CORNER.with([("angle", core::f64::consts::FRAC_PI_2)]);
    let end = Course::new(&system, &[1.0, 1.0], &[-1.0, -1.0], 2.0).run(setting);
    report.class(&end.outcome, "done");
    report.equal("impacts", end.hits.len(), 2);
    report.equal(
        "all simultaneous",
        end.hits.iter().all(|hit| hit.simultaneous),
        true,
    );
    report.near("vx", end.qdot[0], 1.0, 2.0 * U);
    report.near("vy", end.qdot[1], 1.0, 2.0 * U);
}

fn right_angle_missed(setting: Setting, report: &mut Report) {
    let system = CORNER.with([("angle", core::f64::consts::FRAC_PI_2)]);
    for miss in [1e-13, -1e-13, 1e-16, -1e-16] {
        let end = Course::new(&system, &[1.0, 1.0 + miss], &[-1.0, -1.0], 2.0).run(setting);
        report.class(&end.outcome, "done");
        report.equal(format!("impacts, {miss:e}"), end.hits.len(), 2);
        for value in [end.q[0], end.q[1], end.qdot[0], end.qdot[1]] {
            report.near(format!("state, {miss:e}"), value, 1.0, 1e-12);
        }
    }
}

/// Runs a point for 2 units of time towards the vertex of a corner. It starts at the distance 1 from the vertex, at the
/// fraction `at` of the angle.
fn sent(system: &Model, angle: f64, at: f64, setting: Setting) -> End {
    let (sin, cos) = (at * angle).sin_cos();
    Course::new(system, &[cos, sin], &[-cos, -sin], 2.0).run(setting)
}

fn dihedral(setting: Setting, report: &mut Report) {
    for n in [3, 4, 5, 7] {
        let angle = core::f64::consts::PI / f64::from(n);
        for at in [0.3, 0.8] {
            let ends = [
                sent(&CORNER.with([("angle", angle)]), angle, at, setting),
                sent(&CORNER_AGAIN.with([("angle", angle)]), angle, at, setting),
            ];
            let out = if n % 2 == 0 {
                at * angle
            } else {
                angle - at * angle
            };
            for end in ends {
                let name = format!("pi/{n} at {at}");
                report.class(&end.outcome, "done");
                report.equal(format!("impacts, {name}"), end.hits.len(), n as usize);
                report.near(format!("vx, {name}"), end.qdot[0], out.cos(), 16.0 * U);
                report.near(format!("vy, {name}"), end.qdot[1], out.sin(), 16.0 * U);
            }
        }
    }
}

fn other_angles(setting: Setting, report: &mut Report) {
    for angle in [0.4 * core::f64::consts::PI, 100.0_f64.to_radians()] {
        let end = sent(&CORNER.with([("angle", angle)]), angle, 0.3, setting);
        report.equal("outcome", end.outcome.kind(), "ambiguous");
    }
}

fn equal_masses(setting: Setting, report: &mut Report) {
    let end = Course::new(&THREE_MASSES.model(), &[0.0; 3], &[1.0, 0.0, 0.0], 1.0).run(setting);
    report.class(&end.outcome, "done");
    report.equal("velocities", end.qdot, vec![0.0, 0.0, 1.0]);
}

fn unequal_masses(setting: Setting, report: &mut Report) {
    let system = THREE_MASSES.with([("middle", 2.0)]);
    let end = Course::new(&system, &[0.0; 3], &[1.0, 0.0, -1.0], 1.0).run(setting);
    report.equal("outcome", end.outcome.kind(), "ambiguous");
}

fn digits_of_pi(setting: Setting, report: &mut Report, powers: core::ops::RangeInclusive<i32>) {
    const SPEEDS: [(i32, f64); 4] = [
        (1, 0.998_857_595_563_118_4),
        (2, 0.999_998_559_562_977_7),
        (3, 0.999_999_917_460_530_9),
        (4, 0.999_999_999_973_092),
    ];
    for power in powers {
        let mass = 100.0_f64.powi(power);
        let count = (core::f64::consts::PI / 10.0_f64.powi(-power).atan()).ceil() as u64 - 1;
        // Well before this time the block has moved far away, and the small mass is slower than the block.
        let end = Course::new(
            &BLOCK_AND_WALL.with([("M", mass)]),
            &[1.0, 2.0],
            &[0.0, -1.0],
            100.0,
        )
        .follow(setting, &mut ());
        report.class(&end.outcome, "done");
        report.equal(
            format!("collisions, 100^{power}"),
            end.counters.impacts,
            count,
        );
        let drift = (end.energy / (0.5 * mass) - 1.0).abs();
        report.error(
            format!("energy, 100^{power}"),
            drift,
            16.0 * U * (count as f64).sqrt(),
        );
        if let Some((_, speed)) = SPEEDS.iter().find(|(known, _)| *known == power) {
            report.near(
                format!("block's speed, 100^{power}"),
                end.qdot[1],
                *speed,
                1e-9,
            );
        }
    }
}

fn cusp(setting: Setting, report: &mut Report) {
    for (slope, count) in [(0.05, 5), (0.01, 14), (0.001, 73)] {
        let end = Course::new(&CUSP.model(), &[1.0, 0.0], &[-1.0, slope], 3.0).run(setting);
        report.class(&end.outcome, "done");
        report.equal(format!("reflections, {slope}"), end.hits.len(), count);
        if slope == 0.01 {
            report.near("exit vx", end.qdot[0], 0.984_310_707_055, 1e-9);
            report.near("exit vy", end.qdot[1], -0.176_726_998_437, 1e-9);
        }
    }
}
