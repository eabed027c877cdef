//! Certified runs end before an event that they cannot decide, and report the reason.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use core::ops::ControlFlow;

use dalembert::certified::{CertifiedRun, Lost, Reason};
use dalembert::law::Law;
use dalembert::numbers::Interval;
use dalembert_stability::text::{Model, Text};
use dalembert_tests::certified::follow;

/// A point with constant acceleration away from a floor at `x = -depth`.
static SKIMMER: Text = Text::new(
    "Skimmer {
        coordinates { x; }
        parameters { depth = 0; }
        lagrangian = dot(x)^2/2 + x;
        impacts { floor: x >= -depth; }
    }",
);

/// A point between two walls.
static CORNER: Text = Text::new(
    "Corner {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { right: x <= 1; upper: y <= 1; }
    }",
);

/// A ball over a ledge that ends at `x = 1`, and a floor.
static LEDGE: Text = Text::new(
    "Ledge {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts {
            ledge: y >= 0 when x <= 1;
            floor: y >= -1;
        }
    }",
);

/// A ball over a floor.
static BALL: Text = Text::new(
    "Ball {
        coordinates { x; }
        lagrangian = dot(x)^2/2 - x;
        impacts { floor: x >= 0 => newton(1/2); }
    }",
);

/// A point on a spring with a reset at `x = 1` that leads back to `x = 1`.
static SECTION: Text = Text::new(
    "Section {
        coordinates { x; }
        lagrangian = dot(x)^2/2 - x^2/2;
        impacts { stop: x <= 1 => reset { x = 2 - x; }; }
    }",
);

/// A line whose right half has the potential energy 1/2.
static HALVES: Text = Text::new(
    "Halves {
        coordinates { x; }
        modes {
            left { lagrangian = dot(x)^2/2; }
            right { lagrangian = dot(x)^2/2 - 1/2; }
        }
        transitions {
            to_right: left -> right when x >= 0;
            to_left: right -> left when x <= -1/2;
        }
    }",
);

/// A point with velocity 1 below 0 and velocity `speed` above 0.
static RELAY: Text = Text::new(
    "Relay {
        parameters { speed = 2; }
        coordinates { x; }
        modes {
            below { field { dot(x) = 1; } }
            above { field { dot(x) = speed; } }
        }
        transitions {
            up: below -> above when x >= 0;
            down: above -> below when x <= 0;
        }
    }",
);

/// A point below a wall at `y = 1`, with a reset at `x = 1` to `(-1, -1)`.
static TREADMILL: Text = Text::new(
    "Treadmill {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { end: x <= 1 => reset { x = -1; y = -1; }; upper: y <= 1; }
    }",
);

/// The surfaces of the impacts, and the result of the run.
fn run(system: &Model, start: &[Interval], t_end: f64) -> (Vec<usize>, Result<(), Lost>) {
    let mut surfaces = Vec::new();
    let mut run = CertifiedRun::new(system, 0.0, |i| start[i]);
    let ended = follow(&mut run, t_end, &mut |impact| {
        surfaces.push(impact.surface);
        ControlFlow::Continue(())
    });
    if let Err(lost) = ended {
        assert_eq!(run.t(), lost.t);
    }
    (surfaces, ended)
}

fn points<const D: usize>(values: [f64; D]) -> [Interval; D] {
    values.map(Interval::point)
}

fn lost(ended: Result<(), Lost>) -> Lost {
    let lost = ended.unwrap_err();
    println!("{lost}");
    lost
}

#[test]
fn a_graze_is_refused_before_it_comes() {
    // `x = (1 - t)^2/2` touches 0 at the time 1.
    let start = points([0.5, -1.0]);
    let (surfaces, ended) = run(&SKIMMER.with([("depth", 0.0)]), &start, 3.0);
    let lost = lost(ended);
    assert_eq!(lost.reason, Reason::MayGraze { surface: 0 });
    assert!(
        surfaces.is_empty() && lost.t <= 1.0 && lost.t > 0.99,
        "{lost}"
    );
    // The point misses a floor that is slightly lower and meets one that is slightly higher.
    let (surfaces, ended) = run(&SKIMMER.with([("depth", 1e-9)]), &start, 3.0);
    assert!(surfaces.is_empty() && ended.is_ok(), "{ended:?}");
    let (surfaces, _) = run(&SKIMMER.with([("depth", -1e-9)]), &start, 1.0);
    assert_eq!(surfaces, [0]);
}

#[test]
fn a_box_of_which_a_part_misses_is_refused() {
    let start = [Interval::new(0.49, 0.51), Interval::point(-1.0)];
    let (surfaces, ended) = run(&SKIMMER.with([("depth", 0.0)]), &start, 3.0);
    let lost = lost(ended);
    assert_eq!(lost.reason, Reason::MayGraze { surface: 0 });
    assert!(surfaces.is_empty() && lost.t < 1.0, "{lost}");
}

#[test]
fn two_walls_at_one_time_are_refused() {
    let start = points([0.0, 0.0, 1.0, 1.0]);
    let (surfaces, ended) = run(&CORNER.model(), &start, 3.0);
    let lost = lost(ended);
    assert!(
        matches!(lost.reason, Reason::MayMeetTogether { .. }),
        "{lost}"
    );
    assert!(surfaces.is_empty() && lost.t <= 1.0, "{lost}");
    // The walls are met one after the other, in either order.
    for (place, order) in [(1e-9, [0, 1]), (-1e-9, [1, 0])] {
        let (surfaces, ended) = run(&CORNER.model(), &points([place, 0.0, 1.0, 1.0]), 2.5);
        assert!(
            surfaces == order && ended.is_ok(),
            "{surfaces:?}, {ended:?}"
        );
    }
    // From a wider box, either wall may be met first.
    let start = [
        Interval::new(-1e-3, 2e-3),
        Interval::point(0.0),
        Interval::point(1.0),
        Interval::point(1.0),
    ];
    assert!(run(&CORNER.model(), &start, 2.5).1.is_err());
}

#[test]
fn a_surface_that_may_be_met_before_a_reset_is_not_forgotten() {
    let (surfaces, ended) = run(&TREADMILL.model(), &points([0.0, 0.0, 1.0, 1.0]), 2.0);
    let lost = lost(ended);
    assert!(surfaces.is_empty() && lost.t <= 1.0, "{surfaces:?}, {lost}");
    assert!(
        matches!(lost.reason, Reason::MayMeetTogether { .. }),
        "{lost}"
    );
    let (surfaces, ended) = run(&TREADMILL.model(), &points([1e-9, 0.0, 1.0, 1.0]), 2.0);
    assert!(surfaces == [0] && ended.is_ok(), "{surfaces:?}, {ended:?}");
}

#[test]
fn a_condition_that_is_not_certain_is_refused() {
    // The ball falls to the height of the ledge in the time sqrt(2) and moves by sqrt(2)/2 meanwhile.
    let falling = |x: f64, radius: f64| {
        let x = Interval::point(x).widened(radius);
        [
            x,
            Interval::point(1.0),
            Interval::point(0.5),
            Interval::point(0.0),
        ]
    };
    let edge = 1.0 - core::f64::consts::SQRT_2 / 2.0;
    let (surfaces, ended) = run(&LEDGE.model(), &falling(edge, 1e-6), 1.5);
    let lost = lost(ended);
    assert_eq!(lost.reason, Reason::UnsureCondition { surface: 0 });
    assert!(
        surfaces.is_empty() && lost.t < core::f64::consts::SQRT_2,
        "{lost}"
    );
    let (surfaces, ended) = run(&LEDGE.model(), &falling(edge - 2e-6, 1e-6), 1.5);
    assert!(surfaces == [0] && ended.is_ok(), "{surfaces:?}, {ended:?}");
    let (surfaces, ended) = run(&LEDGE.model(), &falling(edge + 2e-6, 1e-6), 2.1);
    assert!(surfaces == [1] && ended.is_ok(), "{surfaces:?}, {ended:?}");
}

#[test]
fn motion_behind_a_surface_that_begins_to_count_is_refused() {
    // The ball starts lower than the ledge, beyond its end, and moves towards it. At the time 1 the ledge begins to
    // count, and the ball is at y = -3/4. It would reach the floor at the time 1.28.
    let start = points([2.0, -0.5, -1.0, 0.25]);
    let (surfaces, ended) = run(&LEDGE.model(), &start, 5.0);
    let lost = lost(ended);
    assert_eq!(lost.reason, Reason::MayBeBehind { surface: 0 });
    assert!(
        surfaces.is_empty() && lost.t > 0.99 && lost.t <= 1.0,
        "{surfaces:?}, {lost}"
    );
    let (surfaces, ended) = run(&LEDGE.model(), &start, 0.9999);
    assert!(surfaces.is_empty() && ended.is_ok(), "{ended:?}");
}

#[test]
fn a_start_inside_a_wall_is_refused() {
    let (_, ended) = run(&BALL.model(), &points([-0.1, 1.0]), 1.0);
    assert_eq!(
        lost(ended),
        Lost {
            t: 0.0,
            reason: Reason::MayBeBehind { surface: 0 }
        }
    );
    let (_, ended) = run(&BALL.model(), &points([0.0, -1.0]), 1.0);
    assert_eq!(lost(ended).t, 0.0);
    let (_, ended) = run(&BALL.model(), &[Interval::WHOLE, Interval::point(0.0)], 1.0);
    assert_eq!(
        lost(ended),
        Lost {
            t: 0.0,
            reason: Reason::NotFinite
        }
    );
}

#[test]
fn impacts_that_accumulate_are_followed_until_they_cannot_be_told() {
    let (surfaces, ended) = run(&BALL.model(), &points([0.5, 0.0]), 4.0);
    let lost = lost(ended);
    assert!(
        surfaces.len() > 20 && lost.t < 3.0 && lost.t > 2.9999,
        "{lost}"
    );
}

#[test]
fn a_law_that_leaves_the_motion_at_the_surface_is_refused() {
    let ball = BALL.model();
    for law in [Law::ImpactPlastic, Law::Newton(0.0)] {
        let start = points([0.5, 0.0]);
        let mut run = CertifiedRun::new(&ball, 0.0, |i| start[i]).with_law(0, law);
        let lost = lost(run.next_impact(2.0).map(|_| ()));
        assert_eq!(lost.reason, Reason::MayStay { surface: 0 });
        assert!(lost.t <= 1.0, "{lost}");
    }
    let start = points([0.5, 0.0]);
    let mut run = CertifiedRun::new(&ball, 0.0, |i| start[i]).with_law(0, Law::Elastic);
    let impact = run.next_impact(2.0).unwrap().unwrap();
    let after = impact.after(1);
    assert!(
        after.contains(Interval::point(1.0)) && after.width() < 1e-13,
        "{after:?}"
    );
    let mut run = CertifiedRun::new(&ball, 0.0, |i| start[i]).with_law(0, Law::Reset);
    let lost = lost(run.next_impact(2.0).map(|_| ()));
    assert_eq!(lost.reason, Reason::UnsureLaw { surface: 0 });
}

#[test]
fn a_stop_ends_certified_motion_with_its_name() {
    let ball = BALL.model();
    let start = points([0.5, 0.0]);
    let run = || CertifiedRun::new(&ball, 0.0, |i| start[i]).with_law(0, Law::Stop);
    let lost = lost(run().next_impact(2.0).map(|_| ()));
    assert_eq!(lost.reason, Reason::Stops { surface: 0 });
    assert!(lost.t > 0.9 && lost.t <= 1.0, "{lost}");
    assert!(matches!(run().next_impact(0.75), Ok(None)));
}

#[test]
fn an_end_within_the_times_of_an_impact_is_refused() {
    let start = [Interval::new(0.45, 0.55), Interval::point(0.0)];
    let (surfaces, ended) = run(&BALL.model(), &start, 1.0);
    let lost = lost(ended);
    assert_eq!(lost.reason, Reason::EndsAtImpact { surface: 0 });
    assert!(surfaces.is_empty() && lost.t < 0.95, "{lost}");
    let (surfaces, ended) = run(&BALL.model(), &start, 0.94);
    assert!(surfaces.is_empty() && ended.is_ok(), "{ended:?}");
    let (surfaces, ended) = run(&BALL.model(), &start, 1.06);
    assert!(surfaces == [0] && ended.is_ok(), "{ended:?}");
}

#[test]
fn a_reset_that_stays_at_its_surface_is_refused() {
    let (_, ended) = run(&SECTION.model(), &points([0.0, 2.0]), 3.0);
    let lost = lost(ended);
    assert!(lost.t < core::f64::consts::FRAC_PI_6, "{lost}");
}

#[test]
fn refraction_and_reflection_are_told_apart() {
    // The energies of the two modes are enclosed separately, so the ranges of speeds are narrow compared with the
    // difference of the energies.
    let mode = |speed: Interval| {
        let start = [Interval::point(-1.0), speed, Interval::point(0.0)];
        let halves = HALVES.model();
        let mut run = CertifiedRun::new(&halves, 0.0, |i| start[i]);
        let impact = run.next_impact(3.0).map_err(|lost| lost.reason)?;
        Ok(impact.map(|_| run.component(2).middle().round()))
    };
    assert_eq!(mode(Interval::new(1.01, 1.0101)), Ok(Some(1.0)));
    assert_eq!(mode(Interval::new(0.9899, 0.99)), Ok(Some(0.0)));
    assert_eq!(
        mode(Interval::new(0.99, 1.01)),
        Err(Reason::UnsureLaw { surface: 0 })
    );
}

#[test]
fn modes_that_meet_are_passed_and_sliding_is_refused() {
    let start = points([-1.0, 0.0]);
    let relay = RELAY.model();
    let mut run = CertifiedRun::new(&relay, 0.0, |i| start[i]);
    follow(&mut run, 2.0, &mut |_| ControlFlow::Continue(())).unwrap();
    let x = run.component(0);
    assert!(
        run.impacts() == 1 && x.contains(Interval::point(2.0)) && x.width() < 1e-14,
        "{x:?}"
    );
    let relay = RELAY.with([("speed", -1.0)]);
    let mut run = CertifiedRun::new(&relay, 0.0, |i| start[i]);
    let lost = lost(follow(&mut run, 2.0, &mut |_| ControlFlow::Continue(())));
    assert!(
        matches!(lost.reason, Reason::MayMeetTogether { .. }) && lost.t <= 1.0,
        "{lost}"
    );
}
