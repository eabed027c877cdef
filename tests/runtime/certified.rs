//! Certified motion encloses the exact motion in boxes that stay narrow, and reports where the enclosure is lost.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use dalembert::Described;
use dalembert::certified::{CertifiedFlow, CertifiedRun, Reason};
use dalembert::extended::{At, ExtendedSimulation};
use dalembert::numbers::Interval;
use dalembert::{StateVector, Variational, VectorField};
use dalembert_stability::text::{Model, Text};
use dalembert_tests::certified::{self, state};

type State = <Model as VectorField>::State;

/// A point on a spring.
static OSCILLATOR: Text = Text::new(
    "Oscillator {
        coordinates { x; }
        lagrangian = dot(x)^2/2 - x^2/2;
    }",
);

dalembert::model! {
    /// Two bars of length 1 with bobs of mass 1.
    pub DoublePendulum {
        coordinates { a: angle; b: angle; }
        parameters { g > 0 = 9.81; }
        lagrangian = dot(a)^2 + dot(b)^2/2 + dot(a)*dot(b)*cos(a - b) + 2*g*cos(a) + g*cos(b);
    }
}

/// The double pendulum, loaded from its text.
static DOUBLE_PENDULUM: Text = Text::new(DoublePendulum::DESCRIPTION.source.value());

/// A motion that blows up at `t = 1`: `x = 1/(1 - t)`.
static BURST: Text = Text::new(
    "Burst {
        coordinates { x; }
        field { dot(x) = x^2; }
    }",
);

/// A force with a kink at `x = 0`.
static KINKED: Text = Text::new(
    "Kinked {
        coordinates { x; }
        lagrangian = dot(x)^2/2;
        forces { pull: -(x + abs(x)/3)*d(x); }
    }",
);

dalembert::model! {
    /// A driven oscillator whose potential contains several elementary functions.
    pub Driven {
        coordinates { x; y; }
        lagrangian = dot(x)^2/2 + dot(y)^2/2 - x^2/2 - sqrt(1 + x^2 + y^2) + sin(t)*x*exp(-y^2) - ln(2 + cos(x));
    }
}

/// The oscillator, loaded from its text.
static DRIVEN: Text = Text::new(Driven::DESCRIPTION.source.value());

fn from_point<'a>(system: &'a Model, start: &State) -> CertifiedFlow<'a, Model> {
    let start = *start;
    CertifiedFlow::new(system, 0.0, move |i| Interval::point(start.as_slice()[i]))
}

/// The state at the end of a run with 32 digits.
fn digits<S: Variational>(system: &S, start: &[f64], until: f64) -> S::State {
    let start = At::<_, 2>::of(0.0, &S::State::of(start));
    let run = ExtendedSimulation::new(system, ())
        .run(start, until, |_| core::ops::ControlFlow::Continue(()))
        .unwrap();
    assert!(run.outcome.is_ok_and(|outcome| outcome.is_done()));
    run.end.rounded()
}

#[test]
fn a_spring_is_held_for_a_thousand_units_of_time() {
    let system = OSCILLATOR.model();
    let mut flow = from_point(&system, &state(&system, &[1.0], &[0.0]));
    for t in [1.0, 10.0, 100.0, 1000.0] {
        certified::flow(&mut flow, t).unwrap();
        let [x, v] = [0, 1].map(|i| flow.component(i));
        let wide = 4.0 * f64::EPSILON;
        assert!(
            x.widened(wide).contains(Interval::point(t.cos())),
            "{t}: {x:?}"
        );
        assert!(
            v.widened(wide).contains(Interval::point(-t.sin())),
            "{t}: {v:?}"
        );
        assert!(
            flow.width() < 1e-13 * (1.0 + t),
            "{t}: {:e} after {} steps",
            flow.width(),
            flow.steps()
        );
    }
}

#[test]
fn a_double_pendulum_is_held_for_ten_seconds() {
    let system = DOUBLE_PENDULUM.model();
    let start = state(&system, &[1.0, 2.0], &[0.0, 0.0]);
    let mut flow = from_point(&system, &start);
    for t in [1.0, 5.0, 10.0] {
        certified::flow(&mut flow, t).unwrap();
        let exact = digits(&DoublePendulum::default(), start.as_slice(), t);
        for i in 0..4 {
            let (range, value) = (flow.component(i), exact.as_slice()[i]);
            assert!(
                range.contains(Interval::point(value)),
                "{t}: {i}: {range:?}, {value}"
            );
        }
        println!(
            "t = {t}: width {:e} after {} steps",
            flow.width(),
            flow.steps()
        );
    }
    assert!(flow.width() < 1e-6, "{:e}", flow.width());
}

#[test]
fn long_steps_are_held_with_their_remainders() {
    let system = DOUBLE_PENDULUM.model();
    let start = state(&system, &[1.0, 2.0], &[0.0, 0.0]);
    let [mut fine, mut coarse] =
        [f64::EPSILON, 1e-6].map(|part| from_point(&system, &start).with_remainder(part));
    let exact = digits(&DoublePendulum::default(), start.as_slice(), 1.0);
    for flow in [&mut fine, &mut coarse] {
        certified::flow(flow, 1.0).unwrap();
        for i in 0..4 {
            let (range, value) = (flow.component(i), exact.as_slice()[i]);
            assert!(
                range.contains(Interval::point(value)),
                "{i}: {range:?}, {value}"
            );
        }
        println!("width {:e} after {} steps", flow.width(), flow.steps());
    }
    assert!(coarse.steps() < fine.steps() && coarse.width() > 1e3 * fine.width());
}

#[test]
fn every_motion_from_a_box_is_held() {
    let system = DRIVEN.model();
    let centre = state(&system, &[0.3, -0.2], &[0.1, 0.4]);
    const RADIUS: f64 = 1e-3;
    let mut flow = CertifiedFlow::new(&system, 0.0, |i| {
        Interval::point(centre.as_slice()[i]).widened(RADIUS)
    });
    certified::flow(&mut flow, 5.0).unwrap();
    for corner in 0..16 {
        let mut start = centre;
        for (i, entry) in start.as_mut_slice().iter_mut().enumerate() {
            *entry += if corner >> i & 1 == 0 {
                -RADIUS
            } else {
                RADIUS
            };
        }
        let exact = digits(&Driven {}, start.as_slice(), 5.0);
        for i in 0..4 {
            let (range, value) = (flow.component(i), exact.as_slice()[i]);
            assert!(
                range.contains(Interval::point(value)),
                "{corner}, {i}: {range:?}, {value}"
            );
        }
    }
    assert!(flow.width() < 100.0 * RADIUS, "{:e}", flow.width());
}

#[test]
fn a_motion_that_ends_is_lost_before_its_end() {
    let system = BURST.model();
    let mut flow = CertifiedFlow::new(&system, 0.0, |_| Interval::point(1.0));
    let lost = certified::flow(&mut flow, 2.0).unwrap_err();
    assert!(lost.t < 1.0 && lost.t > 0.9, "{lost}");
    let (x, exact) = (flow.component(0), 1.0 / (1.0 - lost.t));
    assert!(
        x.widened(4.0 * f64::EPSILON * exact)
            .contains(Interval::point(exact)),
        "{x:?}, {exact}"
    );
}

#[test]
fn a_kink_is_not_stepped_over() {
    let system = KINKED.model();
    let mut flow = from_point(&system, &state(&system, &[1.0], &[0.0]));
    let lost = certified::flow(&mut flow, 3.0).unwrap_err();
    // The point passes 0 after a quarter of a period.
    let kink = core::f64::consts::FRAC_PI_2 / (4.0_f64 / 3.0).sqrt();
    assert!(lost.t <= kink && lost.t > 0.99 * kink, "{lost}, {kink}");
}

/// The rates are finite on both sides of what the motion reaches: the cut of `atan2`, and the end of the domain of a root.
/// Each motion reaches its place at the time `at`.
#[test]
fn a_jump_and_the_edge_of_a_domain_are_not_stepped_over() {
    static ACROSS: Text =
        Text::new("Across { coordinates { x; z; } field { dot(x) = 1; dot(z) = atan2(-x, -1); } }");
    static IN_TIME: Text = Text::new(
        "InTime { coordinates { x; z; } field { dot(x) = 1; dot(z) = atan2(sin(t + x), cos(t + x)); } }",
    );
    static ROUND: Text = Text::new(
        "Round { coordinates { x; z; } field { dot(x) = -x; dot(z) = atan2(sin(pi*t), cos(pi*t)) + x; } }",
    );
    static EMPTIED: Text =
        Text::new("Emptied { coordinates { x; z; } field { dot(x) = -2*sqrt(x); dot(z) = 1; } }");
    let pi = core::f64::consts::PI;
    for (text, x, at, until) in [
        (&ACROSS, -1.0, 1.0, 2.0),
        (&IN_TIME, 0.0, pi / 2.0, 3.0),
        (&ROUND, 1.0, 1.0, 1.5),
        (&EMPTIED, 1.0, 1.0, 1.5),
    ] {
        let system = text.model();
        let start = |i: usize| Interval::point([x, 0.0][i]);
        let mut flow = CertifiedFlow::new(&system, 0.0, start);
        let lost = certified::flow(&mut flow, until).unwrap_err();
        assert!(lost.t <= at && lost.t > 0.99 * at, "{lost}, {at}");
        let mut run = CertifiedRun::new(&system, 0.0, start);
        let lost = run
            .run(until, |_| core::ops::ControlFlow::Continue(()))
            .unwrap_err();
        assert!(lost.t <= at && lost.t > 0.99 * at, "{lost}, {at}");
        // Before that, the motion is certified.
        let mut run = CertifiedRun::new(&system, 0.0, start);
        run.run(0.99 * at, |_| core::ops::ControlFlow::Continue(()))
            .unwrap();
    }
}

/// Before `x = 0` the rate tends to -1, but its derivatives do not: steps become as short as the square of the distance.
#[test]
fn a_certification_that_makes_no_headway_ends() {
    static ESSENTIAL: Text =
        Text::new("Essential { coordinates { x; z; } field { dot(x) = 1; dot(z) = tanh(1/x); } }");
    let system = ESSENTIAL.model();
    let mut flow = CertifiedFlow::new(&system, 0.0, |i| Interval::point([-1.0, 0.0][i]));
    let lost = flow.run(2.0).unwrap_err();
    assert_eq!(lost.reason, Reason::NoHeadway);
    assert!(lost.t < 1.0 && lost.t > 0.99, "{lost}");
}
