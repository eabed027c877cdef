//! No impact is missed, and none is invented. After every impact of a run, the next one is computed independently in
//! closed form from the state of the run. The run must find this impact next.

use core::ops::ControlFlow;

use dalembert::math::larger;
use dalembert::{Event, Observer, Outcome, StateVector, System, VectorField};
use dalembert_cli::Integrator;
use dalembert_cli::suite::{Setting, every_integrator};
use dalembert_stability::course::{Course, Random, state};
use dalembert_stability::tables::{RECTANGLE, STADIUM, elliptic_table};
use dalembert_stability::text::{Model, Text, value};

/// Allowed rounding error of a time, in units of `2^-52` divided by the gap rate.
const UNITS: f64 = 256.0;

/// The next impact: the time until the impact, its surface, and its gap rate.
#[derive(Debug, Clone, Copy)]
struct Next {
    after: f64,
    surface: usize,
    rate: f64,
}

/// The next impact in a table in closed form, from a point inside or from one on the wall that moves inwards.
type Ahead = fn(&Model, [f64; 2], [f64; 2]) -> Next;

/// The larger root of `c + 2 b s + a s^2` with `a < 0`, computed without cancellation: the time at which a line leaves
/// the conic on or inside which it starts.
fn leaves(a: f64, b: f64, c: f64) -> f64 {
    let root = (b * b - a * c.max(0.0)).sqrt();
    if b >= 0.0 {
        -(b + root) / a
    } else {
        c.max(0.0) / (root - b)
    }
}

fn in_ellipse(table: &Model, [x, y]: [f64; 2], [u, v]: [f64; 2]) -> Next {
    let [p, q] = ["ta", "tb"].map(|name| value(table, name).powi(2));
    let (a, b) = (-(u * u / p + v * v / q), -(x * u / p + y * v / q));
    let c = 1.0 - x * x / p - y * y / q;
    let after = leaves(a, b, c);
    Next {
        after,
        surface: 0,
        rate: 2.0 * (b + a * after),
    }
}

fn in_rectangle(table: &Model, q: [f64; 2], v: [f64; 2]) -> Next {
    let mut first = Next {
        after: f64::INFINITY,
        surface: 0,
        rate: 0.0,
    };
    let lengths = ["a", "b"].map(|name| value(table, name));
    for (i, length) in lengths.into_iter().enumerate() {
        let (surface, way) = if v[i] > 0.0 {
            (2 * i + 1, length - q[i])
        } else {
            (2 * i, q[i])
        };
        let after = way / v[i].abs();
        if after < first.after {
            first = Next {
                after,
                surface,
                rate: -v[i].abs(),
            };
        }
    }
    first
}

fn in_stadium(_: &Model, [x, y]: [f64; 2], [u, v]: [f64; 2]) -> Next {
    // The straight walls count between the half disks.
    if v != 0.0 {
        let after = (if v > 0.0 { 1.0 - y } else { 1.0 + y }) / v.abs();
        if (x + u * after).abs() < 1.0 && after > 0.0 {
            return Next {
                after,
                surface: usize::from(v > 0.0),
                rate: -v.abs(),
            };
        }
    }
    // The half disks count where the line leaves their circles beyond the straight walls.
    for (surface, side) in [(2, -1.0), (3, 1.0)] {
        let from = x - side;
        let (a, b) = (-(u * u + v * v), -(from * u + y * v));
        let c = 1.0 - from * from - y * y;
        let root = (b * b - a * c).sqrt();
        let after = if b >= 0.0 {
            -(b + root) / a
        } else {
            c / (root - b)
        };
        if after > 0.0 && side * (x + u * after) > 1.0 {
            return Next {
                after,
                surface,
                rate: 2.0 * (b + a * after),
            };
        }
    }
    panic!("no wall is ahead of {x}, {y} at {u}, {v}");
}

/// Compares every impact with the expected one.
struct Watch<'a> {
    table: &'a Model,
    ahead: Ahead,
    label: String,
    expected: Next,
    last: f64,
    seen: u64,
    worst: f64,
}

fn pair(values: &[f64]) -> [f64; 2] {
    [values[0], values[1]]
}

impl Observer<Model> for Watch<'_> {
    fn event(&mut self, event: &Event<<Model as VectorField>::State>) -> ControlFlow<()> {
        self.seen += 1;
        let q = pair(self.table.position(&event.after).as_slice());
        let v = pair(
            self.table
                .velocity(event.t, &event.after)
                .expect("a velocity")
                .as_slice(),
        );
        let Next {
            after,
            surface,
            rate,
        } = self.expected;
        let late = event.t - self.last - after;
        let allowed = UNITS * f64::EPSILON / rate.abs() + 4.0 * f64::EPSILON * event.t;
        self.worst = larger(self.worst, late.abs() / allowed);
        assert!(
            late.abs() <= allowed && event.surface == surface,
            "{}: impact {} on {} after {}, not on {surface} after {after}; {} at {v:?}, allowed {allowed:e}",
            self.label,
            self.seen,
            event.surface,
            event.t - self.last,
            format_args!("{q:?}"),
        );
        self.expected = (self.ahead)(self.table, q, v);
        self.last = event.t;
        ControlFlow::Continue(())
    }
}

fn follow(
    label: &str,
    (table, ahead): (&Model, Ahead),
    q: [f64; 2],
    v: [f64; 2],
    impacts: u64,
    setting: Setting,
) {
    let mut watch = Watch {
        table,
        ahead,
        label: format!("{label}, {}", setting.words()),
        expected: ahead(table, q, v),
        last: 0.0,
        seen: 0,
        worst: 0.0,
    };
    let end = Course::new(table, &q, &v, 1e12)
        .impacts(impacts)
        .follow(setting, &mut watch);
    assert_eq!(
        (end.outcome.kind(), watch.seen),
        ("impact_budget", impacts),
        "{}",
        watch.label
    );
    println!(
        "{}: {impacts} impacts, worst time {:.2} of its bound",
        watch.label, watch.worst
    );
}

/// Follows every table and kind of start with every integrator, an equal number of impacts each.
fn follow_all(impacts: u64) {
    let mut random = Random::new(2026);
    let [circle, ellipse] = [1.0, 2.0].map(|ta| elliptic_table(ta, 1.0));
    let channel = RECTANGLE.with([("a", 1.0), ("b", 1e-9)]);
    let stadium = STADIUM.model();
    let share = impacts / (12 * every_integrator().len() as u64);
    for setting in every_integrator().iter().copied().map(Setting::free) {
        for angle in [0.3, 1e-2, 1e-4] {
            let v = [-f64::sin(angle), f64::cos(angle)];
            follow(
                &format!("circle at {angle}"),
                (&circle, in_ellipse),
                [1.0, 0.0],
                v,
                share,
                setting,
            );
            follow(
                &format!("ellipse at {angle}"),
                (&ellipse, in_ellipse),
                [2.0, 0.0],
                v,
                share,
                setting,
            );
        }
        for _ in 0..2 {
            let (q, angle) = (
                [random.between(-0.9, 0.9), random.between(-0.9, 0.9)],
                random.between(0.0, 6.0),
            );
            follow(
                "stadium",
                (&stadium, in_stadium),
                q,
                [angle.cos(), angle.sin()],
                share,
                setting,
            );
            let q = [0.5 * q[0], 0.5 * q[1]];
            follow(
                "ellipse",
                (&ellipse, in_ellipse),
                q,
                [angle.cos(), angle.sin()],
                share,
                setting,
            );
            let q = [0.5 + 0.5 * q[0], 0.5e-9];
            follow(
                "thin channel, fast",
                (&channel, in_rectangle),
                q,
                [1e6 * angle.cos(), 1e6 * angle.sin()],
                share,
                setting,
            );
        }
    }
}

#[test]
fn none_of_ten_thousand_impacts_is_missed() {
    follow_all(10_000);
}

#[test]
#[ignore = "nightly: ten million impacts"]
fn none_of_ten_million_impacts_is_missed() {
    follow_all(10_000_000);
}

/// A point in a corner meets both walls shortly before the end of a step, at times whose distance from it is smaller than
/// what is joined to the next step. The motion is along straight lines.
#[test]
fn two_impacts_at_the_end_of_a_step_lose_no_time() {
    static CORNER: Text = Text::new(
        "Corner {
            coordinates { x; y; }
            lagrangian = (dot(x)^2 + dot(y)^2)/2;
            impacts { one: x <= 0; other: y <= 0; }
        }",
    );
    let corner = CORNER.model();
    let distances = [4e-7, 1e-8, 2e-9, 1e-9, 3e-12];
    for &integrator in Integrator::every() {
        for h in [0.05, 0.25] {
            for [first, second] in distances
                .map(|one| distances.map(|other| [one, other]))
                .concat()
            {
                let start = [h * first - 1.0, h * second - 1.0];
                let state = state(&corner, &start, &[1.0; 2]);
                let course = Course::from_state(&corner, state, 2.0).step(h);
                let run = course.observed(integrator, &mut ());
                let name = integrator.name();
                assert_eq!(
                    (run.outcome, run.counters.impacts),
                    (Outcome::Done, 2),
                    "{name}"
                );
                let q = corner.position(&run.state);
                for (q, start) in q.as_slice().iter().zip(start) {
                    let right = -2.0 - start;
                    assert!(
                        (q - right).abs() < 1e-12,
                        "{name}, {h}, {first:e}, {second:e}: {q}, {right}"
                    );
                }
            }
        }
    }
}
