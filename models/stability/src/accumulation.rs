//! Section B, second part: accumulations of impacts that are elastic, super-elastic, algebraic, or end in a blow-up.

use core::ops::ControlFlow;

use dalembert::math::larger;
use dalembert::numbers::Numbers;
use dalembert::{Event, Observer, Outcome, StateVector, System, VectorField};
use dalembert_cli::Integrator;
use dalembert_cli::suite::{Case, Report, Run, Setting};

use super::by_hand::{Gap, Point};
use super::course::{Course, U, location};
use super::text::{Model, Text, shipped};
use super::zeno::accumulates;

/// A point mass between a fixed wall and a piston that approaches the wall.
pub static PISTON: Text = Text::new(
    "Piston {
        coordinates { x; }
        parameters { L > 0 = 1; u > 0 = 1/2; }
        lagrangian = dot(x)^2/2;
        impacts { end: x >= 0; piston: x <= L - u*t; }
    }",
);

/// Index of the piston's surface.
const STROKE: usize = 1;

/// A point mass that is thrown over treads along the curve `y = a^2 x (sqrt(2) v0 - a^2 x)`. Each tread is horizontal.
static TREADS: Text = Text::new(
    "Treads {
        coordinates { x; y; }
        parameters { a > 0 = 1/2; v0 > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts { tread: y >= a^2*x*(sqrt(2)*v0 - a^2*x) => reset { dot(y) = -dot(y); }; }
        claims { conserved under tread: energy; }
    }",
);

/// The cases.
pub const CASES: &[Case] = &[
    Case {
        id: "B06",
        title: "elastic accumulation on rising treads, a = 0.5 .. 0.84",
        right: "x_n = (v0/k)(1 - r^n), v_n = v0 r^n, k = sqrt(2) a^2, r = (1 - k)/(1 + k); accumulates at v0/k",
        bound: "`zeno` within 1e-10, 1e-6 for a = 0.84, where hops after two impacts are 7e-16 high; energy to 8 u per impact",
        run: Run::Steps(treads),
        ..Case::QUICK
    },
    Case {
        id: "B07",
        title: "rising treads with a = 0.85: k > 1, so that the motion passes below the curve at once",
        right: "nothing accumulates: the parabola meets the curve from below at x = 2 v0/(1 + k) = 0.989232550505",
        bound: "`still_penetrating` at the start, one record",
        run: Run::Steps(below_the_treads),
        ..Case::QUICK
    },
    Case {
        id: "B08",
        title: "super-elastic walls, factor 1.25",
        right: "t_n = (1/v0) sum of 1.25^-k, accumulating at al/(v0 (al - 1)) = 5, speed unbounded",
        bound: "`spasmodic` within 1e-8; no infinite number",
        run: Run::Steps(|setting, report| super_elastic(setting, report, 1.0)),
        ..Case::QUICK
    },
    Case {
        id: "B09",
        title: "super-elastic strip whose tangential factor keeps the volume",
        right: "times as B08; al^2 be = 1",
        bound: "as B08",
        run: Run::Steps(|setting, report| super_elastic(setting, report, AL.powi(-2))),
        ..Case::QUICK
    },
    Case {
        id: "B08b",
        title: "super-elastic walls, the impacts before the accumulation",
        right: "t_n and speeds 1.25^n as in B08",
        bound: "1e-13 for the first 40 impacts",
        run: Run::Steps(super_elastic_impacts),
        ..Case::QUICK
    },
    Case {
        id: "B10",
        title: "an elastic point between a wall and an approaching piston",
        right: "X_n (v_n - u) constant: X = 4.9999750001249995e-06 after 1e5 impacts on the piston",
        bound: "1e-8 relative",
        run: Run::Integrators(piston),
        ..Case::QUICK
    },
    Case {
        id: "B10b",
        title: "an approaching piston that reaches the wall",
        right: "accumulates algebraically at t = L/u = 2",
        bound: "`spasmodic`, never `zeno`",
        run: Run::Integrators(piston_to_the_end),
        ..Case::NIGHTLY
    },
    Case {
        id: "B11",
        title: "H = p_x (1 + x^2) + p_y^2 x/2 with p_y -> -p_y at y = 0, 1",
        right: "x = tan t; n-th impact at acos(exp(-(n - y0)/|p_y|)); blow-up at pi/2",
        bound: "1e-12 until the spacing is below 4 ulp, then `spasmodic`",
        run: Run::Chosen(&[Integrator::Taylor], escape),
        ..Case::QUICK
    },
];

/// Elastic treads along `y = a^2 x (sqrt(2) - a^2 x)`, with horizontal speed 1 and initial vertical speed `v0 = 1`.
fn treads(setting: Setting, report: &mut Report) {
    for a in [0.5, 0.7, 0.8, 0.84] {
        let k = 2.0_f64.sqrt() * a * a;
        let r = (1.0 - k) / (1.0 + k);
        let system = TREADS.with([("a", a)]);
        let end = Course::new(&system, &[0.0, 0.0], &[1.0, 1.0], 5.0 / k).run(setting);
        let bound = if a > 0.8 { 1e-6 } else { 1e-10 };
        accumulates(report, &format!("a = {a}"), &end, 1.0 / k, bound);
        let late = |(n, hit): (usize, &super::course::Hit)| {
            let speed = r.powi(n as i32 + 1);
            // With gravity 1, an error of the time causes an equal error of the speed. Errors add up over flights.
            let bound = location(hit.t, end.eta(2.0), (1.0 + k) * speed, 1.0) * (n + 1) as f64;
            (hit.after[1] - speed).abs() / bound
        };
        let worst = end.hits.iter().enumerate().map(late).fold(0.0, larger);
        report.error(format!("worst speed over P-LOC, a = {a}"), worst, 1.0);
        let impacts = end.hits.len() as f64;
        report.near(
            format!("energy, a = {a}"),
            end.energy,
            1.0,
            U * (8.0 * impacts + end.counters.accepted as f64),
        );
    }
}

fn below_the_treads(setting: Setting, report: &mut Report) {
    let curve = Gap {
        at: |at| {
            let [x, _] = at;
            let b = 0.85 * 0.85;
            (
                rising(0.85, at),
                [2.0 * b * b * x - b * 2.0_f64.sqrt(), 1.0],
            )
        },
        along: |at| rising(0.85, at),
    };
    let system = Point {
        acceleration: [0.0, -1.0],
        surfaces: [(curve, |[vx, vy]| [vx, -vy])],
    };
    let end = Course::new(&system, &[0.0, 0.0], &[1.0, 1.0], 5.0).run(setting);
    report.class(&end.outcome, "still_penetrating");
    report.equal("impacts", end.hits.len(), 1);
    report.equal("time", end.t, 0.0);
    let x = 2.0 / (1.0 + 2.0_f64.sqrt() * 0.85 * 0.85);
    report.near(
        "root of the parabola",
        rising(0.85, [x, x - 0.5 * x * x]),
        0.0,
        4.0 * U,
    );
}

/// Height above the curve of B06 for `v0 = 1`.
fn rising<L: Numbers>(a: f64, [x, y]: [L; 2]) -> L {
    let b = L::of(a * a);
    y - b * x * (L::of(2.0_f64.sqrt()) - b * x)
}

/// Normal factor of B08.
const AL: f64 = 1.25;

/// The strip with this tangential factor.
fn strip(be: f64) -> Model {
    shipped("super_elastic_strip").with([("al", AL), ("be", be)])
}

fn super_elastic(setting: Setting, report: &mut Report, be: f64) {
    let end = Course::new(&strip(be), &[0.0, 0.0], &[1.0, 1.0], 10.0).run(setting);
    report.class(&end.outcome, "spasmodic");
    report.near("time", limit(&end.outcome), AL / (AL - 1.0), 1e-8 * 5.0);
    report.equal(
        "state finite",
        end.q.iter().chain(&end.qdot).all(|value| value.is_finite()),
        true,
    );
}

fn super_elastic_impacts(setting: Setting, report: &mut Report) {
    let end = Course::new(&strip(1.0), &[0.0, 0.0], &[1.0, 1.0], 10.0)
        .impacts(40)
        .run(setting);
    report.class(&end.outcome, "impact_budget");
    let mut t = 0.0;
    for (n, hit) in end.hits.iter().enumerate() {
        t += AL.powi(-(n as i32));
        let speed = AL.powi(n as i32 + 1);
        report.near(format!("time of impact {}", n + 1), hit.t, t, 1e-13);
        report.near(
            format!("speed after impact {}", n + 1),
            hit.after[0].abs(),
            speed,
            1e-13 * speed,
        );
    }
}

/// Spasmodic motion `x = tan t` between walls at 0 and 1.
fn escape(setting: Setting, report: &mut Report) {
    let system = shipped("spasmodic_hamiltonian").model();
    let end = Course::new(&system, &[0.0, 0.5, 1.0, 1.0], &[0.0; 4], 2.0).run(setting);
    report.class(&end.outcome, "spasmodic");
    report.equal("impacts", end.hits.len() >= 36, true);
    for (n, hit) in end.hits.iter().enumerate() {
        let t = (-(n as f64 + 0.5)).exp().acos();
        report.near(format!("time of impact {}", n + 1), hit.t, t, 1e-12);
    }
}

/// Observer that counts impacts on the piston down to 0, and then ends the run. It stores the position at the last one.
struct Strokes<'a> {
    system: &'a Model,
    left: u64,
    x: f64,
}

impl Observer<Model> for Strokes<'_> {
    fn event(&mut self, event: &Event<<Model as VectorField>::State>) -> ControlFlow<()> {
        if event.surface == STROKE {
            self.left -= 1;
            self.x = self.system.position(&event.after).as_slice()[0];
        }
        if self.left == 0 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

fn piston(setting: Setting, report: &mut Report) {
    let system = PISTON.model();
    let mut strokes = Strokes {
        system: &system,
        left: 100_000,
        x: f64::NAN,
    };
    let end = Course::new(&system, &[1.0], &[-1.0], 2.0).follow(setting, &mut strokes);
    report.class(&end.outcome, "stopped");
    let right = 4.999_975_000_124_999_5e-6;
    report.near("X", strokes.x, right, 1e-8 * right);
}

fn piston_to_the_end(setting: Setting, report: &mut Report) {
    let end = Course::new(&PISTON.model(), &[1.0], &[-1.0], 3.0).follow(setting, &mut ());
    report.class(&end.outcome, "spasmodic");
    report.near("time", limit(&end.outcome), 2.0, 1e-8);
}

/// The time at which impacts accumulate.
fn limit(outcome: &Outcome) -> f64 {
    match outcome {
        Outcome::Spasmodic { t, .. } => *t,
        _ => f64::NAN,
    }
}
