//! Section A, second part: walls that are thin, wavy, flat or permeable, and motions that end.

use core::ops::ControlFlow;

use dalembert::math::larger;
use dalembert::numbers::{Numbers, TaylorModel};
use dalembert::{Event, Observer, VectorField};
use dalembert_cli::suite::{Case, Report, Run, Setting, refusal};

use super::by_hand::{Gap, Point};
use super::course::{Course, Hit, U, location};
use super::text::{Model, Text, value};

/// A free point in the plane, with a wall that it may cross with gap rate 0.
static FLAT_CROSSING: Text = Text::new(
    "FlatCrossing {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { wall: y - x^3 >= 0; }
    }",
);

/// A free rotor. Its surfaces lie where cos(theta) = 0, and their events are counted.
static ROTOR: Text = Text::new(
    "Rotor {
        coordinates { theta: angle; }
        lagrangian = dot(theta)^2/2;
        impacts {
            setting: cos(theta) >= 0 => reset { };
            rising: cos(theta) <= 0 => reset { };
        }
    }",
);

/// A thin slab at x = 1.
static SLAB: Text = Text::new(
    "Slab {
        coordinates { x; }
        parameters { w > 0 = 1e-10; }
        lagrangian = dot(x)^2/2;
        impacts {
            near: x <= 1 when x < 1 + w/2;
            far: x >= 1 + w when x > 1 + w/2;
        }
    }",
);

/// A channel of width 1.
static CHANNEL: Text = Text::new(
    "Channel {
        coordinates { x; }
        lagrangian = dot(x)^2/2;
        impacts { left: x >= 0; right: x <= 1; }
    }",
);

/// A free point over a corrugated wall.
static CORRUGATED: Text = Text::new(
    "Corrugated {
        coordinates { x; y; }
        parameters { A = 0.05; w = 200; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { wall: y >= A*sin(w*x); }
    }",
);

/// An oscillator with a wall just inside its amplitude.
pub static OSCILLATOR: Text = Text::new(
    "Oscillator {
        coordinates { x; }
        parameters { W > 0 = 1; depth = 1e-12; }
        lagrangian = dot(x)^2/2 - W^2*x^2/2;
        impacts { wall: x + 1 - depth >= 0; }
    }",
);

/// A point that is thrown at one wall against a force and drifts towards another.
static TWO_WALLS: Text = Text::new(
    "TwoWalls {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 + 2*x;
        impacts { end: y <= 1.05; dip: x >= 0; }
    }",
);

/// A gap that changes sign through a pole.
static POLE: Text = Text::new(
    "Pole {
        coordinates { x; }
        lagrangian = dot(x)^2/2;
        impacts { pole: x/(x - 1) >= 0; }
    }",
);

/// Attraction by 1/x^2.
static COLLAPSE: Text = Text::new(
    "Collapse {
        coordinates { x; }
        lagrangian = dot(x)^2/2 + 1/x;
    }",
);

/// Repulsion by 2 x^3.
static BLOW_UP: Text = Text::new(
    "BlowUp {
        coordinates { x; }
        lagrangian = dot(x)^2/2 + x^4/2;
    }",
);

/// The cases.
pub const CASES: &[Case] = &[
    Case {
        id: "A09",
        title: "y = x^3 crossed along y = 0, where gap rate and its derivative vanish",
        right: "the motion crosses at t = 1",
        bound: "`tangential_crossing`, near t = 1",
        run: Run::Steps(flat_crossing),
        ..Case::QUICK
    },
    Case {
        id: "A10",
        title: "surfaces with dh = 0: (x - 1)^2 and (x - 1)^3",
        right: "refused while building; written by hand, no impact can be carried out",
        bound: "a message about the surface; `singular_surface` or `tangential_crossing`",
        run: Run::Steps(irregular_surfaces),
        ..Case::QUICK
    },
    Case {
        id: "A11",
        title: "a slab of thickness 1e-10 at speed 1e6",
        right: "one impact at t = 1e-6; x(1e-5) = -8",
        bound: "P-STATE(64); never behind the slab's face",
        run: Run::Steps(slab),
        ..Case::QUICK
    },
    Case {
        id: "A12",
        title: "a unit channel at speed 1e4 for one unit of time",
        right: "10 000 impacts at k/1e4",
        bound: "exact count; P-LOC",
        run: Run::Steps(channel),
        ..Case::QUICK
    },
    Case {
        id: "A13",
        title: "a corrugated wall crossed seven times",
        right: "first impact at 0.95006902375471799797",
        bound: "P-LOC",
        run: Run::Steps(|setting, report| {
            corrugated(setting, report, 0.05, 200.0, 0.950_069_023_754_718)
        }),
        ..Case::QUICK
    },
    Case {
        id: "A14",
        title: "a corrugated wall crossed nearly along a tangent",
        right: "first impact at 0.99952332841188449327",
        bound: "P-LOC",
        run: Run::Steps(|setting, report| {
            corrugated(setting, report, 1e-3, 1000.0, 0.999_523_328_411_884_5)
        }),
        ..Case::QUICK
    },
    Case {
        id: "A17",
        title: "an oscillator whose wall lies 1e-12 inside its amplitude, at rates 1 and 1e6",
        right: "impact k at (2k + 1) t1, t1 = (pi - 2 asin(sqrt(d/2)))/W",
        bound: "1000 impacts, 100 by integrators of order less than 8; P-LOC with the error of the integration",
        run: Run::Integrators(oscillator),
        ..Case::QUICK
    },
    Case {
        id: "A18",
        title: "a free rotor that passes cos(theta) = 0, to t = 1e6",
        right: "floor(1e6/pi + 1/2) = 318310 events",
        bound: "exact count; times to 4 u t",
        run: Run::Integrators(|setting, report| rotor(setting, report, 1e6, 318_310)),
        ..Case::NIGHTLY
    },
    Case {
        id: "A18b",
        title: "the same to t = 1e3",
        right: "floor(1e3/pi + 1/2) = 318 events",
        bound: "exact count; times to 4 u t",
        run: Run::Steps(|setting, report| rotor(setting, report, 1e3, 318)),
        ..Case::QUICK
    },
    Case {
        id: "A19",
        title: "two surfaces in one step, the second of which is hit first",
        right: "surface 1 at t = 0.9, then surface 0 at 1.05",
        bound: "P-LOC; in order",
        run: Run::Steps(two_walls),
        ..Case::QUICK
    },
    Case {
        id: "A20",
        title: "a gap that changes its sign through a pole",
        right: "no impact",
        bound: "no record; `starts_inside` behind the pole, or `non_finite`",
        run: Run::Steps(pole),
        ..Case::QUICK
    },
    Case {
        id: "A21",
        title: "collapse x'' = -1/x^2 from rest at 1",
        right: "x = 0 at pi/(2 sqrt(2))",
        bound: "`step_underflow` within 1e-8",
        run: Run::Steps(collapse),
        ..Case::QUICK
    },
    Case {
        id: "A22",
        title: "blow-up x'' = 2 x^3, x = 1/(1 - t)",
        right: "infinite at t = 1",
        bound: "`non_finite` or `step_underflow` in (1 - 1e-6, 1]; a finite last state",
        run: Run::Steps(blow_up),
        ..Case::QUICK
    },
];

fn flat_crossing(setting: Setting, report: &mut Report) {
    let end = Course::new(&FLAT_CROSSING.model(), &[-1.0, 0.0], &[1.0, 0.0], 2.0).run(setting);
    report.class(&end.outcome, "tangential_crossing");
    report.equal("impacts", end.hits.len(), 0);
    // Near the impact, the cube of the distance is below the rounding error of the gap.
    report.near("time", end.t, 1.0, 1e-4);
}

fn irregular_surfaces(setting: Setting, report: &mut Report) {
    for surface in ["(x - 1)^2", "(x - 1)^3", "x^2 - 2*x + 1"] {
        let source = format!(
            "Wall {{ coordinates {{ x; }} lagrangian = dot(x)^2/2; impacts {{ w: {surface} >= 0; }} }}"
        );
        let said = refusal(&source).unwrap_or_default();
        report.equal(surface, said.contains("not regular"), true);
    }
    let cube = Gap {
        at: |[x, _]| ((1.0 - x).powi(3), [-3.0 * (1.0 - x) * (1.0 - x), 0.0]),
        along: |[x, _]| {
            let way = TaylorModel::of(1.0) - x;
            way * way.square()
        },
    };
    let point = Point {
        acceleration: [0.0; 2],
        surfaces: [(cube, |[vx, vy]| [-vx, vy])],
    };
    let end = Course::new(&point, &[0.0, 0.0], &[1.0, 0.0], 3.0).run(setting);
    report.one_of(&end.outcome, &["singular_surface", "tangential_crossing"]);
}

fn slab(setting: Setting, report: &mut Report) {
    let end = Course::new(&SLAB.model(), &[0.0], &[1e6], 1e-5).run(setting);
    report.class(&end.outcome, "done");
    report.equal("impacts", end.hits.len(), 1);
    report.near("x", end.q[0], -8.0, 64.0 * U * 8.0);
    for hit in &end.hits {
        report.near("time", hit.t, 1e-6, location(1e-6, end.eta(2.0), 1e6, 0.0));
        report.error("x at the face", hit.q[0] - 1.0, 64.0 * U);
    }
}

fn channel(setting: Setting, report: &mut Report) {
    let end = Course::new(&CHANNEL.model(), &[0.0], &[1e4], 1.0).run(setting);
    report.class(&end.outcome, "done");
    report.equal("impacts", end.hits.len(), 10_000);
    let late = |(k, hit): (usize, &Hit)| {
        let t = (k + 1) as f64 / 1e4;
        (hit.t - t).abs() / location(t, end.eta(2.0), 1e4, 0.0)
    };
    let worst = end.hits.iter().enumerate().map(late).fold(0.0, larger);
    report.error("worst time over its bound", worst, 1.0);
}

fn corrugated(setting: Setting, report: &mut Report, depth: f64, w: f64, t: f64) {
    let wall = CORRUGATED.with([("A", depth), ("w", w)]);
    let end = Course::new(&wall, &[0.0, 1.0], &[1.0, -1.0], 1.0)
        .impacts(1)
        .run(setting);
    report.class(&end.outcome, "impact_budget");
    let phase = w * t;
    let (rate, bend) = (-1.0 - depth * w * phase.cos(), depth * w * w * phase.sin());
    // The phase is rounded to a unit in its last place. The slope of the gap in x carries this error to the gap.
    let terms = 1.0 + depth + depth * w * t;
    for hit in &end.hits {
        report.near("time", hit.t, t, location(t, end.eta(terms), rate, bend));
    }
}

fn oscillator(setting: Setting, report: &mut Report) {
    // Truncation errors reduce the amplitude in each period, so that the oscillator soon misses the wall.
    let count = if setting.integrator.order().is_some_and(|order| order < 8) {
        100
    } else {
        1000
    };
    for rate in [1.0, 1e6] {
        let system = OSCILLATOR.with([("W", rate)]);
        let turn = 2.0 * (0.5 * value(&system, "depth")).sqrt().asin();
        let first = (core::f64::consts::PI - turn) / rate;
        let end = Course::new(&system, &[1.0], &[0.0], (2 * count) as f64 * first)
            .tol(1e-15)
            .run(setting);
        report.class(&end.outcome, "done");
        report.equal(format!("impacts, W = {rate:e}"), end.hits.len(), count);
        let late = |(k, hit): (usize, &Hit)| {
            let t = (2 * k + 1) as f64 * first;
            // Each flight adds 256 u to the error of the amplitude. The delays that earlier flights have accumulated
            // add 8 u k^2.
            let k = k as f64;
            let amplitude = 16.0 * U * (16.0 + 16.0 * k + 0.5 * k * k);
            (hit.t - t).abs() / (2.0 * amplitude / (rate * turn) + 4.0 * U * t)
        };
        let errors = end.hits.iter().enumerate().map(|(k, hit)| {
            let t = (2 * k + 1) as f64 * first;
            [(k + 1) as f64, (hit.t - t).abs() * rate]
        });
        report.curve(
            format!("W = {rate:e}"),
            ["impact", "error of the phase"],
            errors.collect(),
        );
        let worst = end.hits.iter().enumerate().map(late).fold(0.0, larger);
        report.error(
            format!("worst time over its bound, W = {rate:e}"),
            worst,
            1.0,
        );
    }
}

/// Counts events, and records the largest ratio of the error of an event time to its bound.
struct Passages {
    count: usize,
    worst: f64,
}

impl Observer<Model> for Passages {
    fn event(&mut self, event: &Event<<Model as VectorField>::State>) -> ControlFlow<()> {
        let t = core::f64::consts::PI * (self.count as f64 + 0.5);
        self.worst = larger(self.worst, (event.t - t).abs() / (4.0 * U * t));
        self.count += 1;
        ControlFlow::Continue(())
    }
}

fn rotor(setting: Setting, report: &mut Report, until: f64, events: usize) {
    let mut passages = Passages {
        count: 0,
        worst: 0.0,
    };
    let end = Course::new(&ROTOR.model(), &[0.0], &[1.0], until).follow(setting, &mut passages);
    report.class(&end.outcome, "done");
    report.equal("events", passages.count, events);
    report.error("worst time over its bound", passages.worst, 1.0);
}

fn two_walls(setting: Setting, report: &mut Report) {
    let end = Course::new(&TWO_WALLS.model(), &[0.99, 0.0], &[-2.0, 1.0], 1.5).run(setting);
    report.class(&end.outcome, "done");
    let surfaces: Vec<usize> = end.hits.iter().map(|hit| hit.surface).collect();
    report.equal("surfaces", surfaces, vec![1, 0]);
    for (hit, (t, rate)) in end.hits.iter().zip([(0.9, 0.2), (1.05, 1.0)]) {
        report.near(
            format!("time {t}"),
            hit.t,
            t,
            location(t, end.eta(4.0), rate, 2.0),
        );
    }
}

fn pole(setting: Setting, report: &mut Report) {
    let end = Course::new(&POLE.model(), &[3.0], &[-1.1], 2.5).run(setting);
    report.one_of(&end.outcome, &["starts_inside", "non_finite"]);
    report.equal("impacts", end.hits.len(), 0);
}

fn collapse(setting: Setting, report: &mut Report) {
    let end = Course::new(&COLLAPSE.model(), &[1.0], &[0.0], 2.0).run(setting);
    report.class(&end.outcome, "step_underflow");
    report.near("time", end.t, core::f64::consts::PI / 8.0_f64.sqrt(), 1e-8);
    report.equal(
        "state finite",
        end.q[0].is_finite() && end.qdot[0].is_finite(),
        true,
    );
}

fn blow_up(setting: Setting, report: &mut Report) {
    let end = Course::new(&BLOW_UP.model(), &[1.0], &[1.0], 2.0).run(setting);
    report.one_of(&end.outcome, &["non_finite", "step_underflow"]);
    report.near("time", end.t, 1.0, 1e-6);
    report.equal(
        "state finite",
        end.q[0].is_finite() && end.qdot[0].is_finite(),
        true,
    );
}
