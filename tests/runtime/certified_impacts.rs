//! Certified motion across impacts encloses references of many digits in boxes that stay narrow.
//!
//! Stored references are in `tests/reference`. Parameters that are not doubles are given as ranges that contain them.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use core::ops::ControlFlow;
use std::time::Instant;

use dalembert::Described;
use dalembert::certified::CertifiedRun;
use dalembert::extended::{At, Extended, ExtendedSimulation, Impact};
#[cfg(feature = "every_model")]
use dalembert::math::larger;
use dalembert::numbers::{Interval, Numbers, Row};
use dalembert::{Impacting, Scene, StateVector, Variational};
use dalembert_stability::text::{Model, Text};
use dalembert_tests::certified::{WALKER, about, digits, follow, holds, state};
use dalembert_tests::reference::read;
use serde_json::Value;

dalembert::model! {
    /// A ball over a floor.
    pub Ball {
        coordinates { x; }
        parameters { g > 0 = 1; e in [0, 1] = 3/4; }
        lagrangian = dot(x)^2/2 - g*x;
        impacts { floor: x >= 0 => newton(e); }
    }
}

/// The ball, loaded from its text.
static BALL: Text = Text::new(Ball::DESCRIPTION.source.value());

dalembert::model! {
    /// A disk that rolls upright on an elliptical table (W. Clark, thesis, section 6.4).
    pub RollingDisk {
        coordinates { x; y; theta: angle; phi: angle; }
        parameters { m > 0 = 1/400; R > 0 = 1/100; I > 0 = 1/8000000; J > 0 = 1/16000000; ta > 0 = 3/20; tb > 0 = 1/5; }
        let table(u, v) = 1 - u^2/ta^2 - v^2/tb^2;
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + J/2*dot(phi)^2;
        constraints { rolling_x: d(x) - R*cos(phi)*d(theta) = 0; rolling_y: dot(y) = R*sin(phi)*dot(theta); }
        frame { roll: d(theta); turn: d(phi); }
        impacts {
            leading_edge: table(x + R*cos(phi), y + R*sin(phi)) >= 0;
            trailing_edge: table(x - R*cos(phi), y - R*sin(phi)) >= 0;
        }
    }
}

/// The disk, loaded from its text.
static ROLLING_DISK: Text = Text::new(RollingDisk::DESCRIPTION.source.value());

/// A sleigh on a blade, on an elliptical table (W. Clark, thesis, section 7.5).
static SLEIGH: Text = Text::new(
    "Sleigh {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 1; I > 0 = 1; a = 1/5; len > 0 = 1/4; ta > 0 = 2; tb > 0 = 1; }
        let table(u, v) = 1 - u^2/ta^2 - v^2/tb^2;
        let slip = -dot(x)*sin(theta) + dot(y)*cos(theta);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I + m*a^2)/2*dot(theta)^2 + a*m*dot(theta)*slip;
        constraints { blade: -sin(theta)*d(x) + cos(theta)*d(y) = 0; }
        frame { v: cos(theta)*d(x) + sin(theta)*d(y); omega: d(theta); }
        impacts {
            front_tip: table(x + len*cos(theta), y + len*sin(theta)) >= 0;
            back_tip: table(x - len*cos(theta), y - len*sin(theta)) >= 0;
        }
    }",
);

dalembert::model! {
    /// A point on a spring between a floor with restitution 2/3 and an oscillating wall.
    pub Swing {
        coordinates { x; }
        parameters { w = 1; }
        lagrangian = dot(x)^2/2 - x^2/2;
        impacts { floor: x >= -1/3 => newton(2/3); wall: x <= 1 + w*sin(t)/10; }
    }
}

/// The point on a spring, loaded from its text.
static SWING: Text = Text::new(Swing::DESCRIPTION.source.value());

#[cfg(feature = "every_model")]
dalembert::model! {
    /// Point mass that walks on spring legs (H. Geyer, A. Seyfarth and R. Blickhan 2006).
    pub SpringWalker {
        parameters { k > 0 = 17.84; alpha in [0, 1.5] = 1.2043; }
        coordinates { x; y; }
        let spring(foot) = k/2*(sqrt((x - foot)^2 + y^2) - 1)^2;
        modes {
            single {
                coordinates { foot; }
                lagrangian = (dot(x)^2 + dot(y)^2 + dot(foot)^2)/2 - y - spring(foot);
                constraints { stands: d(foot) = 0; }
            }
            double {
                coordinates { front; back; }
                lagrangian = (dot(x)^2 + dot(y)^2 + dot(front)^2 + dot(back)^2)/2 - y - spring(front) - spring(back);
                constraints { stands_in_front: d(front) = 0; stands_behind: d(back) = 0; }
            }
        }
        transitions {
            touch_down: single -> double when y <= sin(alpha) when x > foot => reset {
                front = x + cos(alpha);
                back = foot;
                dot(front) = 0;
                dot(back) = 0;
            };
            lift_off: double -> single when (x - back)^2 + y^2 >= 1 => reset { foot = front; dot(foot) = 0; };
        }
    }
}

/// References of `bouncing_ball_trajectories.json`, the first case.
fn bouncing_ball() -> Vec<Reference> {
    let impacts = &read("bouncing_ball_trajectories")["cases"][0]["impacts"];
    let after = |impact: &Value| vec!["0".to_owned(), text(&impact["v_plus"])];
    references(impacts, |_| 0, after)
}

/// References of `rolling_disk_trajectories.json`, the elastic case on an ellipse.
fn disk_on_an_ellipse() -> Vec<Reference> {
    let impacts = &read("rolling_disk_trajectories")["cases"][2]["impacts"];
    references(
        impacts,
        |impact| edge(&impact["edge"]),
        |impact| texts(&impact["q"]),
    )
}

/// References of `chaplygin_sleigh_trajectories.json`, the first elastic billiard.
fn sleigh_billiard() -> Vec<Reference> {
    let impacts = &read("chaplygin_sleigh_trajectories")["billiard"][0]["impacts"];
    let places = |impact: &Value| texts(&impact["state_minus"])[..3].to_vec();
    references(impacts, |impact| edge(&impact["surface"]), places)
}

/// References of `walker_orbits.json`, the first transient.
fn walker_transient() -> Vec<Reference> {
    let steps = &read("walker_orbits")["sets"][0]["transient"]["steps"];
    let after = |step: &Value| [vec!["0.4".to_owned()], texts(&step["after(xi,eta)"])].concat();
    references(steps, |_| 0, after)
}

/// References made of stored impacts. `surface` reads the surface of an impact, `after` the components after it.
fn references(
    impacts: &Value,
    surface: impl Fn(&Value) -> usize,
    after: impl Fn(&Value) -> Vec<String>,
) -> Vec<Reference> {
    let impacts = impacts.as_array().unwrap().iter();
    let reference = |impact: &Value| Reference {
        t: text(&impact["t"]),
        surface: surface(impact),
        after: after(impact),
    };
    impacts.map(reference).collect()
}

/// Index of the surface of an edge or a tip: 0 in front, 1 behind.
fn edge(name: &Value) -> usize {
    match name.as_str() {
        Some("leading_edge" | "front_tip") => 0,
        Some("trailing_edge" | "back_tip") => 1,
        _ => panic!("no surface {name}"),
    }
}

fn text(value: &Value) -> String {
    value.as_str().unwrap().to_owned()
}

fn texts(values: &Value) -> Vec<String> {
    values.as_array().unwrap().iter().map(text).collect()
}

fn point(value: f64) -> Interval {
    Interval::point(value)
}

/// An impact of a reference: time, surface, and components of the state after it.
struct Reference {
    t: String,
    surface: usize,
    after: Vec<String>,
}

/// Compares the impacts of a run with references. Returns the width of the widest enclosure of a time or component.
fn along(mut run: CertifiedRun<'_, Model>, references: &[Reference], name: &str) -> f64 {
    let begun = Instant::now();
    let (mut count, mut widest) = (0, 0.0_f64);
    let ended = follow(&mut run, 1e3, &mut |impact| {
        let reference = &references[count];
        count += 1;
        assert_eq!(impact.surface, reference.surface, "{name}: impact {count}");
        let after = (0..)
            .zip(&reference.after)
            .map(|(i, value)| (impact.after(i), value));
        for (range, value) in core::iter::once((impact.time, &reference.t)).chain(after) {
            assert!(
                holds(range, digits(value)),
                "{name}: impact {count}: {value} is not in {range:?}"
            );
            widest = widest.max(range.width());
        }
        match count == references.len() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    });
    let (steps, time) = (run.steps(), begun.elapsed());
    println!("{name}: width {widest:.1e} after {count} impacts and {steps} steps in {time:.1?}");
    assert_eq!(count, references.len(), "{name}: {ended:?}");
    widest
}

/// Impacts of a run in numbers of 48 digits.
fn impacts<S: Variational + Scene>(system: &S, start: &S::State, t_end: f64) -> Vec<Impact<S, 3>> {
    let mut impacts = Vec::new();
    let simulation = ExtendedSimulation::new(system, system.effects());
    let run = simulation.run(At::<S, 3>::of(0.0, start), t_end, |impact| {
        impacts.push(*impact);
        ControlFlow::Continue(())
    });
    assert!(run.unwrap().outcome.is_ok_and(|outcome| outcome.is_done()));
    impacts
}

/// Compares a certified run of a loaded model with a run of its compiled type in numbers of 48 digits. Both must have
/// `expected` impacts. Returns the width of the widest component at the end.
fn beside<S: Variational + Scene>(
    loaded: &(impl Variational + Impacting),
    system: &S,
    start: &S::State,
    (t_end, expected): (f64, usize),
    name: &str,
) -> f64 {
    let exact = impacts(system, start, t_end);
    assert_eq!(exact.len(), expected, "{name}");
    let begun = Instant::now();
    let start = start.as_slice();
    let mut run = CertifiedRun::new(loaded, 0.0, |i| point(start[i]));
    let mut count = 0;
    let mut late = 0.0_f64;
    let ended = run.run(t_end, |impact| {
        let exact = &exact[count];
        count += 1;
        assert_eq!(impact.surface, exact.surface, "{name}: impact {count}");
        assert!(
            holds(impact.time, exact.t),
            "{name}: impact {count} in {:?}",
            impact.time
        );
        late = late.max(impact.time.width());
        for i in 0..start.len() {
            let ranges = [impact.before(i), impact.after(i)];
            let values = [exact.before, exact.after].map(|row| row.as_slice()[i]);
            assert!(
                ranges
                    .into_iter()
                    .zip(values)
                    .all(|(range, value)| holds(range, value)),
                "{name}: impact {count}: component {i}"
            );
        }
        ControlFlow::Continue(())
    });
    assert!(
        ended.is_ok() && count == exact.len(),
        "{name}: {count} impacts of {}, {ended:?}",
        exact.len()
    );
    let (width, steps, time) = (run.width(), run.steps(), begun.elapsed());
    println!(
        "{name}: width {width:.1e}, of times {late:.1e}, after {count} impacts and {steps} steps in {time:.1?}"
    );
    width
}

/// Times `sqrt(2/g) (1 + 2 (e + .. + e^(n-1)))` of the impacts of a ball dropped from the height 1.
fn bounces(g: f64, e: f64, count: usize) -> Vec<Extended<3>> {
    let [fall, e] = [Extended::from(2.0) / Extended::from(g), Extended::from(e)];
    let fall = Numbers::sqrt(fall);
    let (mut flight, mut t) = (fall, Extended::from(0.0));
    let mut times = Vec::new();
    for _ in 0..count {
        t = t + flight;
        times.push(t);
        flight = match times.len() {
            1 => Extended::from(2.0) * e * fall,
            _ => e * flight,
        };
    }
    times
}

#[test]
fn a_ball_is_held_to_its_hundredth_bounce() {
    let ball = BALL.with([("g", 9.81), ("e", 0.9)]);
    let exact = bounces(9.81, 0.9, 100);
    let begun = Instant::now();
    let mut run = CertifiedRun::new(&ball, 0.0, |i| point([1.0, 0.0][i]));
    let (mut count, mut width) = (0, 0.0);
    let ended = follow(&mut run, 20.0, &mut |impact| {
        assert!(
            holds(impact.time, exact[count]),
            "{count}: {:?}",
            impact.time
        );
        (count, width) = (count + 1, impact.time.width());
        match count {
            100 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    });
    println!(
        "ball: width {width:.1e} after {count} impacts and {} steps in {:.1?}",
        run.steps(),
        begun.elapsed()
    );
    assert!(
        count == 100 && width < 1e-11,
        "{count}, {width:e}, {ended:?}"
    );
}

#[test]
fn bounces_lie_in_their_enclosures() {
    let ball = BALL.model();
    let run = CertifiedRun::new(&ball, 0.0, |i| point([1.0, 0.0][i]));
    assert!(along(run, &bouncing_ball(), "ball of 3/4") < 1e-12);
}

#[test]
fn a_ball_that_starts_at_the_floor_leaves_it() {
    let ball = Ball::default();
    assert!(
        beside(
            &BALL.model(),
            &ball,
            &state(&ball, &[0.0], &[1.0]),
            (5.0, 3),
            "thrown ball"
        ) < 1e-12
    );
}

#[test]
fn a_rolling_disk_is_held_over_twenty_impacts() {
    let disk = ROLLING_DISK.model();
    let start = [
        point(0.0),
        point(0.0),
        point(0.0),
        Interval::pi() * point(0.5),
        point(10.0),
        about("0.2"),
    ];
    let ranges = ["0.0025", "0.01", "1.25e-7", "6.25e-8", "0.15", "0.2"];
    let mut run = CertifiedRun::new(&disk, 0.0, |i| start[i]);
    for (i, range) in ranges.into_iter().enumerate() {
        run = run.with_parameter(i, about(range));
    }
    assert!(along(run, &disk_on_an_ellipse(), "disk") < 1e-4);
}

#[cfg(feature = "every_model")]
#[test]
fn a_disk_lies_beside_a_run_of_48_digits() {
    let disk = RollingDisk::default();
    let phi = core::f64::consts::FRAC_PI_2;
    let start = state(&disk, &[0.0, 0.0, 0.0, phi], &[0.0, 0.1, 10.0, 0.2]);
    assert!(
        beside(
            &ROLLING_DISK.model(),
            &disk,
            &start,
            (23.9, 20),
            "disk of doubles"
        ) < 1e-4
    );
}

#[test]
fn a_sleigh_is_held_over_twenty_impacts() {
    let sleigh = SLEIGH.model();
    let start = [0.0, 0.0, 0.5, 1.0, 0.5];
    let run = CertifiedRun::new(&sleigh, 0.0, |i| point(start[i])).with_parameter(2, about("0.2"));
    assert!(along(run, &sleigh_billiard(), "sleigh") < 1e-6);
}

#[test]
fn a_walker_is_held_over_twelve_steps() {
    let walker = WALKER.model();
    let start = ["0.4", "-1.0148146300837202625", "0.9913083699240868"];
    let mut run = CertifiedRun::new(&walker, 0.0, |i| about(start[i]));
    for i in [2, 3] {
        run = run.with_parameter(i, about("0.4"));
    }
    assert!(along(run, &walker_transient(), "walker") < 1e-11);
}

#[cfg(feature = "every_model")]
#[test]
fn a_walker_on_springs_is_held_over_six_steps() {
    let walker = SpringWalker::default();
    let start = state(
        &walker,
        &[0.0, 0.97, 0.0, 0.0, 0.0],
        &[0.351, 0.0, 0.0, 0.0, 0.0],
    );
    // A step is a touch-down and a lift-off.
    let width = beside(&walker, &walker, &start, (8.0, 12), "walker on springs");
    assert!(width < 1e-9, "{width:e}");
}

#[test]
fn a_wall_that_moves_is_met_in_its_enclosure() {
    let swing = Swing::default();
    assert!(
        beside(
            &SWING.model(),
            &swing,
            &state(&swing, &[0.5], &[1.3]),
            (20.0, 6),
            "swing"
        ) < 1e-11
    );
}

#[cfg(feature = "every_model")]
#[test]
fn every_motion_from_a_box_is_held_across_impacts() {
    const RADIUS: f64 = 1e-9;
    let disk = ROLLING_DISK.model();
    let centre = [0.01, -0.02, 0.0, 1.5, 10.0, 0.2];
    let mut run = CertifiedRun::new(&disk, 0.0, |i| point(centre[i]).widened(RADIUS));
    let mut enclosures = Vec::new();
    follow(&mut run, 7.3, &mut |impact| {
        enclosures.push((
            impact.time,
            core::array::from_fn::<_, 6, _>(|i| impact.after(i)),
        ));
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(enclosures.len() >= 3);
    let mut reached = [Interval::new(f64::INFINITY, f64::NEG_INFINITY); 6];
    for corner in 0..64 {
        let start = core::array::from_fn::<_, 6, _>(|i| {
            centre[i]
                + if corner >> i & 1 == 0 {
                    -RADIUS
                } else {
                    RADIUS
                }
        });
        let exact = impacts(&RollingDisk::default(), &start.into(), 7.3);
        assert_eq!(exact.len(), enclosures.len());
        for (exact, (time, after)) in exact.iter().zip(&enclosures) {
            assert!(holds(*time, exact.t), "{corner}: {time:?}");
            for i in 0..6 {
                assert!(
                    holds(after[i], exact.after[i]),
                    "{corner}, {i}: {:?}",
                    after[i]
                );
            }
        }
        for (range, value) in reached.iter_mut().zip(exact.last().unwrap().after) {
            *range = range.hull(point(value.nearest()));
        }
    }
    // The widest component is at most a tenth wider than the motions from the corners.
    let found = enclosures.last().unwrap().1;
    let [found, reached] = [found, reached].map(|ranges| {
        let widths = ranges.map(Interval::width);
        widths.into_iter().fold(0.0, larger)
    });
    println!("box of {RADIUS}: width {found:.1e}, of its corners {reached:.1e}");
    assert!(found < 1.1 * reached, "{found:e}, {reached:e}");
}

#[test]
fn every_parameter_of_a_range_is_held() {
    let ball = BALL.model();
    let [g, e] = [Interval::new(0.999, 1.001), Interval::new(0.749, 0.751)];
    let mut run = CertifiedRun::new(&ball, 0.0, |i| point([1.0, 0.0][i]))
        .with_parameter(0, g)
        .with_parameter(1, e);
    let mut times = Vec::new();
    follow(&mut run, 5.0, &mut |impact| {
        times.push(impact.time);
        ControlFlow::Continue(())
    })
    .unwrap();
    assert_eq!(times.len(), 2);
    println!("times {times:?}");
    for (g, e) in [
        (g.lo, e.lo),
        (g.lo, e.hi),
        (g.hi, e.lo),
        (g.hi, e.hi),
        (1.0, 0.75),
    ] {
        let ball = Ball { g, e };
        let exact = impacts(&ball, &state(&ball, &[1.0], &[0.0]), 5.0);
        assert_eq!(exact.len(), times.len(), "{g}, {e}");
        for (time, exact) in times.iter().zip(exact) {
            assert!(holds(*time, exact.t), "{g}, {e}: {time:?}");
        }
    }
    assert!(times[1].width() < 0.05, "{times:?}");
}
