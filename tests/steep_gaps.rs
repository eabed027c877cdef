//! Impacts on surfaces whose gaps say little elsewhere: steep far away, saturated, with a kink along the whole motion, or on
//! the cut of `atan2`. The times of first impacts and the numbers of later ones are known.

use dalembert::{Outcome, System};
use dalembert_cli::Integrator;
use dalembert_stability::course::Course;
use dalembert_stability::text::Text;

/// A point that moves freely up to its surface.
macro_rules! point {
    ($gap:literal) => {
        Text::new(concat!(
            "Point { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2; impacts { wall: ",
            $gap,
            "; } }"
        ))
    };
}

/// A motion to a surface that ends it, and its time.
struct Flight {
    point: Text,
    start: [f64; 2],
    velocity: [f64; 2],
    time: f64,
}

/// The motion along the `y` axis from `y = from` at speed 1, to a surface at this distance from the origin.
const fn fall(point: Text, from: f64, to: f64) -> Flight {
    Flight {
        point,
        start: [0.0, from],
        velocity: [0.0, -1.0],
        time: from - to,
    }
}

/// The motion along the `x` axis from `x = -2` at speed 1, to a surface at this time.
const fn along_the_cut(point: Text, time: f64) -> Flight {
    Flight {
        point,
        start: [-2.0, 0.0],
        velocity: [1.0, 0.0],
        time,
    }
}

fn reaches_in_time(flights: &[Flight], until: f64) {
    for (index, flight) in flights.iter().enumerate() {
        let point = flight.point.model();
        for &integrator in Integrator::every() {
            for (tol, step) in [(1e-10, until / 64.0), (1e-5, until / 7.0)] {
                let course = Course::new(&point, &flight.start, &flight.velocity, until);
                let run = course.tol(tol).step(step).observed(integrator, &mut ());
                let case = format!("{index}, {}, {tol:e}", integrator.name());
                let stopped = matches!(run.outcome, Outcome::StoppedAt { .. });
                assert!(stopped, "{case}: {:?} at {}", run.outcome, run.t);
                let error = (run.t - flight.time).abs();
                assert!(
                    error < 1e-12 * flight.time,
                    "{case}: {} for {}",
                    run.t,
                    flight.time
                );
            }
        }
    }
}

/// Far away, rounding errors of the gap exceed its values behind the surface.
#[test]
fn rounding_far_away_hides_no_surface() {
    let powers = [
        fall(point!("x^12 + y^12 >= 1 => stop"), 20.0, 1.0),
        fall(point!("y^12 >= 1 => stop"), 30.0, 1.0),
        fall(point!("y^8 >= 1 => stop"), 1e4, 1.0),
        fall(point!("y^10 >= 1 => stop"), 50.0, 1.0),
    ];
    for flight in powers {
        let until = 2.0 * flight.start[1] + 1.0;
        reaches_in_time(&[flight], until);
    }
    let exponentials = [
        fall(point!("exp(100*(y - 0.3)) >= 1 => stop"), 2.0, 0.3),
        fall(point!("exp(40*y) >= 1 => stop"), 2.0, 0.0),
        // Behind these surfaces the gap is below the range of numbers.
        fall(point!("1 - exp(-1000*(y - 0.3)) >= 0 => stop"), 2.0, 0.3),
        fall(
            point!("1 - exp(-1000*(abs(y) - 0.3)) >= 0 => stop"),
            2.0,
            0.3,
        ),
    ];
    reaches_in_time(&exponentials, 5.0);
}

/// One step goes far behind the surface: to a height of `-5e17`, from 1.
#[test]
fn a_step_that_goes_far_hides_no_surface() {
    static BALL: Text = Text::new(
        "Ball {
            coordinates { y; }
            lagrangian = dot(y)^2/2 - 1e-6*y;
            impacts { floor: y >= 0 => stop; }
        }",
    );
    let ball = BALL.model();
    for &integrator in Integrator::every() {
        for until in [1e6, 1e9, 1e12] {
            let course = Course::new(&ball, &[1.0], &[0.0], until);
            let run = course.step(until).observed(integrator, &mut ());
            let case = format!("{}, {until:e}", integrator.name());
            let stopped = matches!(run.outcome, Outcome::StoppedAt { .. });
            assert!(stopped, "{case}: {:?} at {}", run.outcome, run.t);
            let right = 2e6_f64.sqrt();
            assert!((run.t - right).abs() < 1e-12 * right, "{case}: {}", run.t);
        }
    }
}

/// The gap has a kink along the whole motion, where it has no derivative.
#[test]
fn a_kink_along_the_motion_hides_no_surface() {
    let root = 0.3_f64.sqrt();
    let kinks = [
        fall(point!("abs(x) + y^2 >= 0.3 => stop"), 2.0, root),
        fall(point!("sqrt(x^2) + y^2 >= 0.3 => stop"), 2.0, root),
        fall(
            point!("(abs(x) + abs(y) + abs(abs(x) - abs(y)))/2 >= 0.3 => stop"),
            2.0,
            0.3,
        ),
        Flight {
            point: point!("abs(x - y) + abs(x + y) >= 0.6 => stop"),
            start: [-2.0, 2.0],
            velocity: [1.0, -1.0],
            time: 1.7,
        },
    ];
    reaches_in_time(&kinks, 5.0);
}

/// A law with an impulse has no direction there, and says so.
#[test]
fn an_impulse_at_a_kink_has_no_direction() {
    static CORNER: Text = point!("abs(x) + y^2 >= 0.3");
    let corner = CORNER.model();
    for &integrator in Integrator::every() {
        let course = Course::new(&corner, &[0.0, 2.0], &[0.0, -1.0], 5.0);
        let run = course.step(0.1).observed(integrator, &mut ());
        let outcome = run.outcome;
        let name = integrator.name();
        assert!(
            matches!(outcome, Outcome::SingularSurface { .. }),
            "{name}: {outcome:?}"
        );
        assert!(
            (run.t - (2.0 - 0.3_f64.sqrt())).abs() < 1e-12,
            "{name}: {}",
            run.t
        );
    }
}

/// On the negative `x` axis the angle jumps; a motion along it stays on one side.
#[test]
fn motion_along_the_cut_of_an_angle_meets_its_surface() {
    let root = 0.3_f64.sqrt();
    let cuts = [
        along_the_cut(
            point!("x^2 + y^2 >= 0.3*(2 + cos(atan2(y, x))) => stop"),
            2.0 - root,
        ),
        along_the_cut(
            point!("x^2 - 0.3 + 0.1*sin(atan2(y, x)) >= 0 => stop"),
            2.0 - root,
        ),
        along_the_cut(
            point!("exp(sqrt(x^2 + y^2) - (2 + cos(5*atan2(y, x)))/3) >= 1 => stop"),
            5.0 / 3.0,
        ),
    ];
    reaches_in_time(&cuts, 10.0);
}

/// The derivative of the gap is rounded to 0 where it falls.
#[test]
fn a_saturated_gap_shows_its_fall_by_its_values() {
    // The line from (-2, 0) along (1, 1/4) enters the disk of radius 1/10 about (0, 1/2).
    let time = 2.0 - 0.1 / 1.0625_f64.sqrt();
    let start = Flight {
        point: point!("tanh(1e20*(x^2 + (y - 0.5)^2 - 0.01)) >= 0 => stop"),
        start: [-2.0, 0.0],
        velocity: [1.0, 0.25],
        time,
    };
    reaches_in_time(&[start], 10.0);
}

/// A point above a floor under the gravity 10, from the height 1 at rest. It bounces at `sqrt(0.2) (1 + 2 k)`.
macro_rules! bouncing {
    ($gap:literal) => {
        Text::new(concat!(
            "Bouncing { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2 - 10*y; impacts { floor: ",
            $gap,
            "; } }"
        ))
    };
}

/// Every elastic motion ends with its energy, after this number of impacts, with and without contact.
fn bounces(text: &Text, start: [[f64; 2]; 2], until: f64, impacts: u64) {
    let point = text.model();
    for &integrator in Integrator::every() {
        for rests in [false, true] {
            let course = Course::new(&point, &start[0], &start[1], until).step(1e-3);
            let course = if rests { course.resting() } else { course };
            let first = point.energy(0.0, course.start()).expect("an energy");
            let run = course.observed(integrator, &mut ());
            let case = format!("{}, {rests}: {:?}", integrator.name(), run.outcome);
            assert_eq!(
                (run.outcome, run.counters.impacts),
                (Outcome::Done, impacts),
                "{case}"
            );
            let last = point.energy(run.t, &run.state).expect("an energy");
            assert!(
                (last - first).abs() < 1e-5 * first,
                "{case}: {first} to {last}"
            );
        }
    }
}

/// Gap rates far from an impact, or at another place of the surface, are larger by many powers of ten.
#[test]
fn impacts_on_steep_surfaces_are_neither_grazes_nor_hops() {
    let floors = [
        bouncing!("exp(-y) <= 1"),
        bouncing!("sinh(9*y) >= 0"),
        bouncing!("y*exp(-9*y) >= 0"),
        bouncing!("(y + 2)^21 >= 2^21"),
        bouncing!("asinh(1e3*y) >= 0 when x > -1"),
        bouncing!("atan(1e6*y) >= 0 when x > -1"),
        bouncing!("0.01/(y + 0.01) <= 1 when x > -1"),
    ];
    for floor in &floors {
        bounces(floor, [[0.0, 1.0], [0.7, 0.0]], 4.0, 4);
    }
    let between = [
        point!("(1 - y^2)*exp(20*y) >= 0"),
        point!("(1 - y)*(1 + y)*exp(17*y) >= 0"),
    ];
    for walls in &between {
        bounces(walls, [[0.0, 0.0], [0.0, 1.0]], 8.5, 4);
    }
    static POWER: Text = point!("x^8 + y^8 <= 1");
    bounces(&POWER, [[-0.3, 0.0], [0.9758, 0.2187]], 30.0, 18);
}

/// A gap that jumps by -2 pi at the cut of `atan2`, which the motion does not reach because it meets a wall.
#[test]
fn nothing_happens_before_a_gap_jumps() {
    static FIRST: Text = Text::new(
        "First {
            coordinates { x; y; }
            lagrangian = (dot(x)^2 + dot(y)^2)/2;
            impacts { cut: atan2(y, x) >= -2; wall: y >= 1/2 => stop; }
        }",
    );
    static LAST: Text = Text::new(
        "Last {
            coordinates { x; y; }
            lagrangian = (dot(x)^2 + dot(y)^2)/2;
            impacts { wall: y >= 1/2 => stop; cut: atan2(y, x) >= -2; }
        }",
    );
    for (text, wall) in [(&FIRST, 1), (&LAST, 0)] {
        let model = text.model();
        for &integrator in Integrator::every() {
            let course = Course::new(&model, &[-1.0, 1.0], &[0.1, -1.0], 3.0).step(0.01);
            let run = course.observed(integrator, &mut ());
            let case = format!("{wall}, {}", integrator.name());
            let stopped =
                matches!(run.outcome, Outcome::StoppedAt { surface, .. } if surface == wall);
            assert!(stopped, "{case}: {:?} at {}", run.outcome, run.t);
            assert!((run.t - 0.5).abs() < 1e-12, "{case}: {}", run.t);
        }
    }
}
