//! Motion along surfaces whose gaps have kinks: roads that turn uphill or downhill, from one place or one time on.

use dalembert::Outcome;
use dalembert_cli::Integrator;
use dalembert_cli::suite::Setting;
use dalembert_stability::course::Course;
use dalembert_stability::text::{Model, Text, set};

static FALLING_ROAD: Text = Text::new(
    "/// A point on a level road that goes on downhill from `x = 1`.
    pub FallingRoad {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts { road: y >= (1 - x - abs(x - 1))/2 => newton(0); }
    }",
);

static RISING_ROAD: Text = Text::new(
    "/// A point on a level road that goes on uphill from `x = 1`.
    pub RisingRoad {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts { road: y >= (x - 1 + abs(x - 1))/2 => newton(0); }
    }",
);

/// The point flies off where the road turns downhill, lands on the slope at `t = 3` and slides down.
#[test]
fn a_held_motion_leaves_at_a_kink_where_the_road_falls_away() {
    let road = FALLING_ROAD.model();
    for &integrator in Integrator::every() {
        let course = Course::new(&road, &[0.0, 0.0], &[1.0, 0.0], 4.0).tol(1e-12);
        let end = course.step(1e-2).resting().run(Setting::free(integrator));
        let case = format!("{}: {:?}", integrator.name(), end.holds);
        assert_eq!(end.outcome, Outcome::Done, "{case}");
        let begins: Vec<bool> = end.holds.iter().map(|hold| hold.begins).collect();
        assert_eq!(begins, [true, false, true], "{case}");
        let times = [end.holds[1].t - 1.0, end.holds[2].t - 3.0];
        assert!(times.iter().all(|error| error.abs() < 1e-9), "{case}");
        let errors = [end.q[0] - 4.75, end.q[1] + 3.75];
        assert!(errors.iter().all(|error| error.abs() < 1e-9), "{case}");
    }
}

/// The point hits the slope at `t = 1`, slides up, comes back to the level road at `t = 3` and hits it.
#[test]
fn a_held_motion_hits_the_surface_at_a_kink_where_the_road_rises() {
    let road = RISING_ROAD.model();
    for &integrator in Integrator::every() {
        let course = Course::new(&road, &[0.0, 0.0], &[1.0, 0.0], 4.0).tol(1e-12);
        let end = course.step(1e-2).resting().run(Setting::free(integrator));
        let case = format!("{}: {:?} {:?}", integrator.name(), end.holds, end.q);
        assert_eq!(end.outcome, Outcome::Done, "{case}");
        let errors = [end.q[0] - 0.5, end.q[1], end.qdot[0] + 0.5, end.qdot[1]];
        assert!(errors.iter().all(|error| error.abs() < 1e-9), "{case}");
    }
}

/// A point slides into a crease with walls at a right angle, which takes all of its velocity.
#[test]
fn a_held_motion_ends_in_a_crease() {
    static CREASE: Text = Text::new(
        "pub Crease {
            coordinates { x; y; }
            lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
            impacts { walls: y >= abs(x) => newton(0); }
        }",
    );
    let crease = CREASE.model();
    for &integrator in Integrator::every() {
        let course = Course::new(&crease, &[0.5, 0.5], &[0.0, 0.0], 3.0).tol(1e-10);
        let end = course.step(1e-2).resting().run(Setting::free(integrator));
        let case = format!("{}: {:?}", integrator.name(), end.outcome);
        assert!(end.outcome != Outcome::Done, "{case}");
        assert!((end.t - 2.0_f64.sqrt()).abs() < 1e-6, "{case}");
    }
}

/// A road that turns uphill at `x = 0` and then falls away, so that the gap is positive again within the step.
static HUMP: Text = Text::new(
    "pub Hump {
        coordinates { x; z; }
        lagrangian = (dot(x)^2 + dot(z)^2)/2 - z;
        impacts { road: z >= abs(x)/2 - (x + abs(x))^2/2 => newton(0); }
    }",
);

/// The point slides down, is hit by the slope uphill with the velocity along it and flies off the hump behind it.
#[test]
fn a_held_motion_hits_a_slope_that_falls_away_within_the_step() {
    // From x = -1 with the speed 1.1 along x and the acceleration 2/5.
    let hit = ((1.21_f64 + 0.8).sqrt() - 1.1) / 0.4;
    let fast = 1.1 + 0.4 * hit;
    // The projection of (1, -1/2) to (1, 1/2) is (3/5, 3/10).
    let flight = 1.5 - hit;
    let (x_rate, z_rate) = (0.6 * fast, 0.3 * fast);
    let right = [
        x_rate * flight,
        (z_rate - flight / 2.0) * flight,
        x_rate,
        z_rate - flight,
    ];
    let hump = HUMP.model();
    for &integrator in Integrator::every() {
        let course = Course::new(&hump, &[-1.0, 0.5], &[1.0, -0.75], 1.5).tol(1e-12);
        let end = course.step(1e-2).resting().run(Setting::free(integrator));
        let case = format!("{}: {:?} {:?}", integrator.name(), end.holds, end.q);
        assert_eq!(end.outcome, Outcome::Done, "{case}");
        for (value, right) in end.q.iter().chain(&end.qdot).zip(right) {
            assert!((value - right).abs() < 1e-9, "{case}, not {right}");
        }
    }
}

/// A curved road that falls away at `x = 1`, where its slope has no value.
static RAMP: Text = Text::new(
    "pub Ramp {
        coordinates { x; z; }
        lagrangian = (dot(x)^2 + dot(z)^2)/2 - z;
        impacts { road: z >= -x*abs(x - 1)/3 => newton(0); }
    }",
);

/// The point slides through the trough `z = -x (1 - x)/3` and flies off with the velocity along the slope 1/3.
#[test]
fn a_held_motion_leaves_a_curved_road_at_a_kink() {
    let ramp = RAMP.model();
    for &integrator in Integrator::every() {
        let course = Course::new(&ramp, &[0.0, 0.0], &[1.53, -0.51], 1.5).tol(1e-12);
        let end = course.step(1e-2).resting().run(Setting::free(integrator));
        let case = format!("{}: {:?} {:?}", integrator.name(), end.holds, end.q);
        assert_eq!(end.outcome, Outcome::Done, "{case}");
        assert_eq!(end.holds.len(), 2, "{case}");
        let flight = end.t - end.holds[1].t;
        // At x = 1 the height is that of x = 0, and so is the speed.
        let right = [
            1.0 + 1.53 * flight,
            (0.51 - flight / 2.0) * flight,
            1.53,
            0.51 - flight,
        ];
        for (value, right) in end.q.iter().chain(&end.qdot).zip(right) {
            assert!((value - right).abs() < 1e-9, "{case}, not {right}");
        }
    }
}

/// A roof whose ridge is written as the root of a square.
static ROOF: Text = Text::new(
    "pub Roof {
        coordinates { x; z; }
        lagrangian = (dot(x)^2 + dot(z)^2)/2 - z;
        impacts { roof: z >= -sqrt(x^2)/2 => newton(0); }
    }",
);

/// The point slides up to the ridge and flies off.
#[test]
fn a_held_motion_leaves_at_a_kink_that_is_written_as_a_root() {
    // From x = -1 with the speed 2 along x and the acceleration -2/5.
    let ridge = 5.0 - 20.0_f64.sqrt();
    let (rate, flight) = (3.2_f64.sqrt(), 1.0 - ridge);
    let right = [rate * flight, (rate - flight) * flight / 2.0];
    let roof = ROOF.model();
    for &integrator in Integrator::every() {
        let course = Course::new(&roof, &[-1.0, -0.5], &[2.0, 1.0], 1.0).tol(1e-12);
        let end = course.step(1e-2).resting().run(Setting::free(integrator));
        let case = format!("{}: {:?} {:?}", integrator.name(), end.holds, end.q);
        assert_eq!(end.outcome, Outcome::Done, "{case}");
        assert_eq!(end.holds.len(), 2, "{case}");
        assert!((end.holds[1].t - ridge).abs() < 1e-9, "{case}, not {ridge}");
        for (value, right) in end.q.iter().zip(right) {
            assert!((value - right).abs() < 1e-9, "{case}, not {right}");
        }
    }
}

/// A wedge that a kink in time pushes up from `t = 1`, with another kink at `x = 0`.
static WEDGE: Text = Text::new(
    "pub Wedge {
        coordinates { x; z; }
        lagrangian = (dot(x)^2 + dot(z)^2)/2 - z;
        impacts { road: z >= abs(x)*abs(t - 1)/2 => newton(0); }
    }",
);

/// At `t = 1` the force on the point passes through 0. It is hit there all the same, flies off and lands behind `x = 0`.
#[test]
fn a_held_motion_is_hit_at_a_kink_in_time() {
    let wedge = WEDGE.model();
    for &integrator in Integrator::every() {
        let course = Course::new(&wedge, &[-2.0, 1.0], &[1.04, -1.52], 1.8).tol(1e-12);
        let end = course.step(1e-2).resting().run(Setting::free(integrator));
        let case = format!("{}: {:?}", integrator.name(), end.holds);
        assert_eq!(end.outcome, Outcome::Done, "{case}");
        let [_, release, landing] = &end.holds[..] else {
            panic!("{case}")
        };
        assert!((release.t - 1.0).abs() < 1e-9, "{case}");
        assert!(!release.begins && landing.begins, "{case}");
        assert!((landing.t - 1.498_350_740_46).abs() < 1e-8, "{case}");
    }
}

/// An even slope, whose gap rate is rounding for a motion along it.
static SLOPE: Text = Text::new(
    "pub Slope {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts { road: y >= 0.3*x => newton(0); }
    }",
);

#[test]
fn rounding_of_a_gap_rate_penetrates_no_surface() {
    let slope = SLOPE.model();
    for &integrator in Integrator::every() {
        for (x, rate) in [(0.7, 0.1), (0.9, -0.7), (1.3, 1.1), (-0.7, 0.3)] {
            let course = Course::new(&slope, &[x, 0.3 * x], &[rate, 0.3 * rate], 1.0).tol(1e-12);
            let end = course.step(1e-2).resting().run(Setting::free(integrator));
            let case = format!("{}, {x}: {:?}", integrator.name(), end.holds);
            assert_eq!(end.outcome, Outcome::Done, "{case}");
            assert_eq!(end.holds.len(), 1, "{case}");
            let acceleration = -0.3 / 1.09;
            let right = x + rate + acceleration / 2.0;
            assert!((end.q[0] - right).abs() < 1e-9, "{case}: {:?}", end.q);
            assert!((end.q[1] - 0.3 * right).abs() < 1e-9, "{case}: {:?}", end.q);
        }
    }
}

/// A crease away from the origin, whose sides are crossed with 3/5 of the last speed.
static VALLEY: Text = Text::new(
    "pub Valley {
        coordinates { x; z; }
        lagrangian = (dot(x)^2 + dot(z)^2)/2 - z;
        impacts { road: z >= abs(x - 1)/2 => newton(0); }
    }",
);

#[test]
fn crossings_of_a_crease_accumulate() {
    // Reaches the crease with the speed v along x. Each crossing lasts 2 v/(2/5), with v falling by 3/5.
    let first = ((1.0_f64 + 0.8).sqrt() - 1.0) / 0.4;
    let speed = 0.6 * (1.0 + 0.4 * first);
    let right = first + 5.0 * speed / (1.0 - 0.6);
    let valley = VALLEY.model();
    for &integrator in Integrator::every() {
        for tol in [1e-7, 1e-11] {
            let course = Course::new(&valley, &[0.0, 0.5], &[1.0, -0.5], 60.0).tol(tol);
            let end = course.step(1e-2).resting().run(Setting::free(integrator));
            let case = format!("{}, {tol}: {:?}", integrator.name(), end.outcome);
            assert!(matches!(end.outcome, Outcome::Zeno { .. }), "{case}");
            assert!((end.t - right).abs() < 3e-4, "{case}, not {right}");
        }
    }
}

/// A road that counts only before its kink.
static PIER: Text = Text::new(
    "pub Pier {
        coordinates { x; z; }
        lagrangian = (dot(x)^2 + dot(z)^2)/2 - z;
        impacts { road: z >= -0.4*x + 0.5*abs(x - 1) when x < 1 => newton(0); }
    }",
);

#[test]
fn a_surface_that_ends_at_its_kink_hits_nothing_there() {
    let pier = PIER.model();
    for &integrator in Integrator::every() {
        let course = Course::new(&pier, &[-1.0, 1.4], &[1.0, -0.9], 2.0).tol(1e-12);
        let end = course.step(1e-2).resting().run(Setting::free(integrator));
        let case = format!("{}: {:?}", integrator.name(), end.holds);
        assert_eq!((end.outcome, end.holds.len()), (Outcome::Done, 2), "{case}");
        let flight = end.t - end.holds[1].t;
        let rate = (1.0 + 2.0 * 2.0 * 0.9 / 1.81_f64).sqrt();
        assert!((end.q[0] - 1.0 - rate * flight).abs() < 1e-9, "{case}");
        let height = -0.4 - (0.9 * rate + flight / 2.0) * flight;
        assert!((end.q[1] - height).abs() < 1e-9, "{case}: {:?}", end.q);
    }
}

/// A road whose slope has no jump at `x = 0`, and that counts up to `x = 2/3`.
static BEND: Text = Text::new(
    "pub Bend {
        coordinates { x; z; }
        lagrangian = (dot(x)^2 + dot(z)^2)/2 - z;
        impacts { road: z >= x*abs(x)/30 when x < 2/3 => impact_plastic; }
    }",
);

/// The errors of a motion at loose tolerances are no jump of the gap rate.
#[test]
fn a_kink_of_the_curvature_changes_nothing() {
    let bend = BEND.model();
    for &integrator in Integrator::every() {
        for tol in [1e-7, 1e-9, 1e-12] {
            let velocity = [1.0, 1.0 / 30.0];
            let course = Course::new(&bend, &[-0.5, -1.0 / 120.0], &velocity, 1.1).tol(tol);
            let end = course.step(1e-3).resting().run(Setting::free(integrator));
            let case = format!("{}, {tol}: {:?}", integrator.name(), end.holds);
            assert_eq!((end.outcome, end.holds.len()), (Outcome::Done, 1), "{case}");
            assert!((end.q[0] - 0.590_22).abs() < 1e-5, "{case}: {:?}", end.q);
        }
    }
}

/// A road that hits the point at a kink in `x`, from which it flies off with a gap rate of 0.
static SPINE: Text = Text::new(
    "pub Spine {
        coordinates { x; z; }
        lagrangian = (dot(x)^2 + dot(z)^2)/2 - z;
        impacts { road: z >= -abs(t - 11/10)/2 + abs(x^2 - 1/5)/4 => impact_plastic; }
    }",
);

#[test]
fn a_motion_rises_from_a_kink_by_its_acceleration() {
    let spine = SPINE.model();
    let velocity = [10.0 / 7.0, -4.0 / 7.0];
    for &integrator in Integrator::every() {
        for tol in [1e-9, 1e-11, 1e-12] {
            let course = Course::new(&spine, &[-1.5, 13.0 / 80.0], &velocity, 2.9).tol(tol);
            let end = course.step(1e-3).resting().run(Setting::free(integrator));
            let case = format!("{}, {tol}: {:?}", integrator.name(), end.holds);
            assert_eq!((end.outcome, end.holds.len()), (Outcome::Done, 3), "{case}");
            let times = [0.444_949_2, 0.670_249_1, 1.769_402_3];
            for (hold, right) in end.holds.iter().zip(times) {
                assert!((hold.t - right).abs() < 1e-6, "{case}");
            }
        }
    }
}

/// A point on a line, with a wall at 0.
macro_rules! wall {
    ($gap:literal) => {
        Text::new(concat!(
            "Wall { coordinates { x; } lagrangian = dot(x)^2/2; impacts { wall: ",
            $gap,
            " >= 0; } }"
        ))
    };
}

/// The gap has no derivative in numbers where it vanishes. Its limits from the side of the motion give the impact.
#[test]
fn a_kink_on_the_surface_hides_no_impact() {
    let walls = [
        wall!("x + abs(x^3)"),
        wall!("x*(1 + abs(x))"),
        wall!("x + abs(x)^(3/2)"),
        wall!("tanh(x)*(1 + abs(x))"),
        wall!("x + sqrt(x^4)"),
        wall!("2*x + abs(x)"),
        wall!("3*x - abs(x)"),
    ];
    for (index, wall) in walls.iter().enumerate() {
        let wall = wall.model();
        for &integrator in Integrator::every() {
            for (from, speed) in [(1.0, 0.7), (1.0, 1.0), (0.123, 0.3), (0.0, 1.0)] {
                let course = Course::new(&wall, &[from], &[-speed], 3.0).step(1.0 / 16.0);
                let end = course.run(Setting::free(integrator));
                let case = format!("{index}, {}, {from}: {:?}", integrator.name(), end.outcome);
                assert_eq!(
                    (end.outcome, end.counters.impacts),
                    (Outcome::Done, 1),
                    "{case}"
                );
                let errors = [end.q[0] - (3.0 * speed - from), end.qdot[0] - speed];
                assert!(
                    errors.iter().all(|error| error.abs() < 1e-12),
                    "{case}: {errors:?}"
                );
            }
        }
    }
}

#[test]
fn a_kink_on_a_round_surface_hides_no_impact() {
    static DISK: Text = Text::new(
        "Disk { coordinates { x; y; } let h = x^2 + y^2 - 1; lagrangian = (dot(x)^2 + dot(y)^2)/2;
         impacts { disk: h*(1 + abs(h)) >= 0; } }",
    );
    let disk = DISK.model();
    let depth = f64::sqrt(0.91);
    for &integrator in Integrator::every() {
        let course = Course::new(&disk, &[2.0, 0.3], &[-1.0, 0.0], 5.0).tol(1e-6);
        let end = course.step(1.0 / 16.0).run(Setting::free(integrator));
        let case = format!("{}: {:?}", integrator.name(), end.outcome);
        assert_eq!(
            (end.outcome, end.counters.impacts),
            (Outcome::Done, 1),
            "{case}"
        );
        // The velocity after it is `v - 2 (v.n) n` with the normal `n = (sqrt(0.91), 0.3)`.
        let errors = [end.qdot[0] + 1.0 - 2.0 * 0.91, end.qdot[1] - 0.6 * depth];
        assert!(
            errors.iter().all(|error| error.abs() < 1e-12),
            "{case}: {errors:?}"
        );
    }
}

/// A point in balance on a floor, and a force that presses from the time `c` on, or a floor that rises from then on.
#[test]
fn a_point_in_balance_on_a_floor_stays_on_it_from_a_kink_on() {
    static PRESSED: Text = Text::new(
        "Pressed {
            coordinates { x; }
            parameters { c = 1; k = 1; e in [0, 1] = 1; }
            lagrangian = dot(x)^2/2;
            forces { press: -k*(abs(t - c) + t - c)*d(x); }
            impacts { floor: x >= 0 => newton(e); }
        }",
    );
    static LIFTED: Text = Text::new(
        "Lifted {
            coordinates { x; }
            parameters { k = 0; e in [0, 1] = 1; }
            let s = (abs(t - 1) + t - 1)/2;
            lagrangian = dot(x)^2/2 - k*x;
            impacts { floor: x >= s^2*(1 - k + k*s) => newton(e); }
        }",
    );
    for &integrator in Integrator::every() {
        for e in [0.5, 1.0] {
            let end = |mut model: Model, values: [(&str, f64); 2]| {
                for (name, value) in values.into_iter().chain([("e", e)]) {
                    set(&mut model, name, value);
                }
                let course = Course::new(&model, &[0.0], &[0.0], 3.0).tol(1e-10);
                let end = course.step(1e-2).resting().run(Setting::free(integrator));
                let case = format!("{}, e = {e}: {:?}", integrator.name(), end.outcome);
                assert_eq!(end.outcome, Outcome::Done, "{case}");
                assert_eq!(end.counters.impacts, 0, "{case}");
                ([end.q[0], end.qdot[0]], case)
            };
            for values in [(1.0, 1.0), (0.7, 1.0), (2.0, 100.0)] {
                let (state, case) = end(PRESSED.model(), [("c", values.0), ("k", values.1)]);
                assert_eq!(state, [0.0; 2], "{case}");
            }
            for (k, [x, v]) in [(0.0, [4.0; 2]), (1.0, [8.0, 12.0])] {
                let (state, case) = end(LIFTED.model(), [("k", k), ("e", e)]);
                let errors = [state[0] - x, state[1] - v];
                assert!(
                    errors.iter().all(|error| error.abs() < 1e-9),
                    "{case}: {state:?}"
                );
            }
        }
    }
}
