//! Motion held by several surfaces. Where they close on each other, the run ends if no motion follows all of them. Otherwise it
//! goes on: a body is driven out, lies in a groove, stands on more legs than it needs, or is thrown by impacts without end.

use dalembert::Outcome;
use dalembert_cli::Integrator;
use dalembert_cli::suite::Setting;
use dalembert_stability::course::{Course, End};
use dalembert_stability::text::{Model, Text, set};

/// A body on a floor, and a press that reaches the floor at the time `sqrt(5)/2`. With a `tilt` it is a wedge, which drives the
/// body out to `y = (t^2 - 5/4)/tilt`.
static PRESS: Text = Text::new(
    "Press {
        coordinates { x; y; }
        parameters { tilt = 0; e in [0, 1] = 0; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - 9.81*x;
        impacts {
            floor: x >= 0 => newton(e);
            press: x <= 5/4 - t^2 + tilt*y => impact_plastic;
        }
    }",
);

/// A bead on a circle between a wall and one that comes up to it.
static BEAD: Text = Text::new(
    "Bead {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { c: x^2 + y^2 = 1; }
        impacts {
            l: x >= 1/10 => impact_plastic;
            r: y <= -3/5 - t/4 => impact_plastic;
        }
    }",
);

/// A run with contact from positions and velocities, with a tolerance or the length of fixed steps.
fn held(
    integrator: Integrator,
    model: &Model,
    [q, qdot]: [&[f64]; 2],
    until: f64,
    [tol, step]: [f64; 2],
) -> End {
    let course = Course::new(model, q, qdot, until).tol(tol).step(step);
    course.resting().run(Setting::free(integrator))
}

#[test]
fn a_press_that_meets_the_floor_ends_the_run() {
    let close = 1.25_f64.sqrt();
    for e in [0.0, 0.5] {
        for &integrator in Integrator::every() {
            let mut press = PRESS.model();
            set(&mut press, "e", e);
            let end = held(
                integrator,
                &press,
                [&[0.5, 0.0], &[0.0, 1.0]],
                3.0,
                [1e-9, 1e-2],
            );
            let name = integrator.name();
            assert!(
                matches!(end.outcome, Outcome::Squeezed { .. }),
                "{name}, {e}: {:?}",
                end.outcome
            );
            assert!((end.t - close).abs() < 1e-9, "{name}, {e}: {}", end.t);
            assert!(
                (end.q[0]).abs() < 1e-9 && (end.qdot[1] - 1.0).abs() < 1e-9,
                "{name}: {:?}",
                end.q
            );
        }
    }
}

#[test]
fn a_wedge_that_meets_the_floor_drives_the_body_out() {
    for &integrator in Integrator::every() {
        let mut press = PRESS.model();
        set(&mut press, "tilt", 0.5);
        let end = held(
            integrator,
            &press,
            [&[0.5, 0.0], &[0.0, 0.0]],
            3.0,
            [1e-9, 1e-2],
        );
        let name = integrator.name();
        assert_eq!(end.outcome, Outcome::Done, "{name}");
        let right = [0.0, 2.0 * (9.0 - 1.25), 0.0, 4.0 * 3.0];
        for (found, right) in end.q.iter().chain(&end.qdot).zip(right) {
            assert!(
                (found - right).abs() < 1e-6,
                "{name}: {:?} {:?}",
                end.q,
                end.qdot
            );
        }
    }
}

#[test]
fn a_bead_between_walls_that_meet_ends_the_run() {
    let bead = BEAD.model();
    for &integrator in Integrator::every() {
        let end = held(
            integrator,
            &bead,
            [&[0.5, -0.75_f64.sqrt()], &[0.0; 2]],
            3.0,
            [1e-9, 1e-2],
        );
        let name = integrator.name();
        assert!(
            matches!(end.outcome, Outcome::Squeezed { .. }),
            "{name}: {:?}",
            end.outcome
        );
        let close = 4.0 * (0.99_f64.sqrt() - 0.6);
        assert!((end.t - close).abs() < 1e-8, "{name}: {}", end.t);
    }
}

/// A light body on a piston that slows down, and a heavy body that it throws.
static THROW: Text = Text::new(
    "Throw {
        coordinates { x; y; }
        parameters { M = 30; e in [0, 1] = 0; }
        lagrangian = (dot(x)^2 + M*dot(y)^2)/2 - x;
        impacts {
            piston: x >= t - t^2/10 => newton(e);
            hit: y >= x + 1 => newton(e);
        }
    }",
);

/// The light body is struck by the piston and the heavy body in turn, without end, until all have the speed of the piston. Then
/// the heavy body flies freely.
#[test]
fn impacts_without_end_lead_to_their_limit() {
    let meets = 5.0 - (25.0_f64 - 4.5).sqrt();
    let speed = 1.0 - meets / 5.0;
    let right = 1.45 + speed * (2.0 - meets);
    for (mass, e) in [
        (3.0, 0.0),
        (10.0, 0.0),
        (300.0, 0.0),
        (10.0, 0.1),
        (30.0, 0.1),
    ] {
        let mut model = THROW.model();
        set(&mut model, "M", mass);
        set(&mut model, "e", e);
        for &integrator in Integrator::every() {
            let end = held(
                integrator,
                &model,
                [&[0.0, 1.45], &[1.0, 0.0]],
                2.0,
                [1e-10, 1e-2],
            );
            let name = integrator.name();
            assert_eq!(end.outcome, Outcome::Done, "{name}, {mass}, {e}");
            assert!(
                (end.q[1] - right).abs() < 1e-9 && (end.qdot[1] - speed).abs() < 1e-9,
                "{name}, {mass}, {e}: {:?} is not {right}",
                end.q
            );
        }
    }
}

/// A point that falls into a groove.
static GROOVE: Text = Text::new(
    "Groove {
        coordinates { x; y; }
        parameters { a = 1; b = 2; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts {
            l: y >= a*x => impact_plastic;
            r: y >= -b*x => impact_plastic;
        }
    }",
);

#[test]
fn a_point_lies_in_a_groove() {
    for b in [0.5, 0.7, 1.5, 2.0, 3.0] {
        let mut model = GROOVE.model();
        set(&mut model, "b", b);
        for &integrator in Integrator::every() {
            for [x, y] in [[0.0, 0.0], [0.1, 1.0]] {
                let end = held(
                    integrator,
                    &model,
                    [&[x, y], &[0.0, 0.0]],
                    25.0,
                    [1e-9, 1e-2],
                );
                let name = integrator.name();
                assert_eq!(end.outcome, Outcome::Done, "{name}, {b}, {y}");
                let is_at_rest = end.q.iter().chain(&end.qdot).all(|it| it.abs() < 1e-12);
                assert!(is_at_rest, "{name}, {b}, {y}: {:?} {:?}", end.q, end.qdot);
            }
        }
    }
}

/// A table on a lift, with a load that moves between its four legs. Three would do.
static TABLE: Text = Text::new(
    "Table {
        coordinates { z; a; b; }
        parameters { c = 1; p = 0.7; w = 2.76; h = 4.09; r = 0.94; u = 2.64; }
        lagrangian = (dot(z)^2 + dot(a)^2 + dot(b)^2)/2;
        forces { load: -9*(d(z) + p*sin(w*t + h)*d(a) + r*cos(u*t)*d(b)); }
        impacts {
            s1: z + a + b >= c*t => impact_plastic;
            s2: z - a + b >= c*t => impact_plastic;
            s3: z - a - b >= c*t => impact_plastic;
            s4: z + a - b >= c*t => impact_plastic;
        }
    }",
);

#[test]
fn a_table_stands_on_four_legs() {
    for (c, p, r) in [
        (1.0, 0.7, 0.94),
        (0.0, 0.3, 0.3),
        (0.0, 0.9, 0.9),
        (0.25, 0.24, 0.05),
    ] {
        let mut model = TABLE.model();
        for (name, value) in [("c", c), ("p", p), ("r", r)] {
            set(&mut model, name, value);
        }
        for &integrator in Integrator::every() {
            let end = held(
                integrator,
                &model,
                [&[0.0; 3], &[c, 0.0, 0.0]],
                6.0,
                [1e-9, 2e-2],
            );
            let name = integrator.name();
            assert_eq!(end.outcome, Outcome::Done, "{name}, {c}, {p}");
            let right = [6.0 * c, 0.0, 0.0];
            for (found, right) in end.q.iter().zip(right) {
                assert!((found - right).abs() < 1e-9, "{name}: {:?}", end.q);
            }
        }
    }
}

/// A point in a corner, and a floor that rises faster than the corner. The floor that lifts it is declared last.
static LIFTED: Text = Text::new(
    "Lifted {
        coordinates { x; y; }
        parameters { k = 0.1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts {
            l: y - 0.3*t >= x => impact_plastic;
            r: y - 0.3*t >= -2*x => impact_plastic;
            c: y - 0.3*t >= k*t^2 => impact_plastic;
        }
    }",
);

/// A point on a floor from which a parabola rises.
static RAMP: Text = Text::new(
    "Ramp {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts {
            a: y >= 0 => impact_plastic;
            b: y >= x^2/5 => impact_plastic;
        }
    }",
);

#[test]
fn the_surfaces_that_push_hold_the_motion_in_any_order() {
    for &integrator in Integrator::every() {
        let name = integrator.name();
        for k in [0.1, 0.01, 0.001] {
            let mut model = LIFTED.model();
            set(&mut model, "k", k);
            let end = held(
                integrator,
                &model,
                [&[0.0; 2], &[0.0, 0.3]],
                1.5,
                [1e-10, 1e-2],
            );
            assert_eq!(end.outcome, Outcome::Done, "{name}, {k}");
            let right = 0.45 + k * 2.25;
            assert!((end.q[1] - right).abs() < 1e-9, "{name}: {:?}", end.q);
        }
        let model = RAMP.model();
        let end = held(
            integrator,
            &model,
            [&[0.0; 2], &[1.0, 0.0]],
            1.5,
            [1e-10, 1e-3],
        );
        assert_eq!(end.outcome, Outcome::Done, "{name}");
        assert!(
            (end.q[1] - end.q[0] * end.q[0] / 5.0).abs() < 1e-12 && end.q[0] > 1.0,
            "{name}: {:?}",
            end.q
        );
        assert!((end.energy - 0.5).abs() < 1e-5, "{name}: {}", end.energy);
    }
}

/// Surfaces that a body meets at gap rate 0 and with the acceleration of the floor that it lies on: a lift, and a road that bends up.
static TAKEN_OVER: Text = Text::new(
    "TakenOver {
        coordinates { x; y; }
        parameters { k = 0.2; v = 0; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts {
            floor: y >= v*t => impact_plastic;
            lift: y >= v*t + k*(t - 1)^3 => impact_plastic;
        }
    }",
);
static ROAD: Text = Text::new(
    "Road {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts {
            floor: y >= 0 => impact_plastic;
            road: y >= x^3/5 => impact_plastic;
        }
    }",
);

#[test]
fn a_surface_that_is_met_without_a_rate_takes_over() {
    for &integrator in Integrator::every() {
        let name = integrator.name();
        for v in [0.0, 0.3] {
            let mut model = TAKEN_OVER.model();
            set(&mut model, "v", v);
            let end = held(
                integrator,
                &model,
                [&[0.0; 2], &[0.5, v]],
                2.0,
                [1e-10, 1e-2],
            );
            assert_eq!(end.outcome, Outcome::Done, "{name}, {v}");
            let right = [1.0, 2.0 * v + 0.2, 0.5, v + 0.6];
            for (found, right) in end.q.iter().chain(&end.qdot).zip(right) {
                assert!(
                    (found - right).abs() < 1e-8,
                    "{name}, {v}: {:?} {:?}",
                    end.q,
                    end.qdot
                );
            }
        }
    }
}

#[test]
fn a_road_that_bends_up_without_a_rate_takes_over() {
    let model = ROAD.model();
    for &integrator in Integrator::every() {
        let name = integrator.name();
        let end = held(
            integrator,
            &model,
            [&[-1.0, 0.0], &[1.0, 0.0]],
            1.5,
            [1e-10, 1e-3],
        );
        assert_eq!(end.outcome, Outcome::Done, "{name}");
        let [x, y] = [end.q[0], end.q[1]];
        assert!(
            x > 0.4 && (y - x * x * x / 5.0).abs() < 1e-10,
            "{name}: {x}, {y}"
        );
        assert!((end.energy - 0.5).abs() < 1e-5, "{name}: {}", end.energy);
    }
}

/// Walls between which a point rests in the corner, until the corner vanishes: the parabola then touches the other wall.
static VANISHING: Text = Text::new(
    "Vanishing {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts {
            bowl: 3/10*x^2 - 7/10*x + y/5 - 4/5*t + 1/2 >= 0 => restitution(0.6);
            lid: 2/5*x - 3/10*y - t/5 + 2/5 - x*y/5 >= 0 => newton(0.8);
        }
    }",
);

#[test]
fn a_corner_that_vanishes_ends_the_run() {
    let model = VANISHING.model();
    for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Dopri5] {
        let end = held(
            integrator,
            &model,
            [&[0.0; 2], &[-0.8, -0.3]],
            3.0,
            [1e-10, 1e-3],
        );
        let name = integrator.name();
        let ends = matches!(
            end.outcome,
            Outcome::Squeezed { .. } | Outcome::Contact { .. }
        );
        assert!(ends, "{name}: {:?}", end.outcome);
        assert!((end.t - 1.27035).abs() < 1e-5, "{name}: {}", end.t);
    }
}

/// A point between a wall and one that comes closer with the speed 1/2. The speed after the wall at rest tends to
/// `e/(2 (1 - e))`.
static CLOSING: Text = Text::new(
    "Closing {
        coordinates { x; }
        parameters { e in [0, 1] = 1/2; }
        lagrangian = dot(x)^2/2;
        impacts { left: x >= 0 => newton(e); right: x <= 1 - t/2 => newton(e); }
    }",
);

/// Each impact keeps a part of the gap rate, while `dot(x) = (dot(y) - 3/10)/x` grows without limit, as `x` reaches 0 where `y`
/// reaches the wall.
static DRIVEN_UP: Text = Text::new(
    "DrivenUp {
        coordinates { x; y; }
        parameters { e in [0, 1] = 9/10; }
        lagrangian = dot(x)^2 + dot(y)^2;
        constraints { k: dot(y) = x*dot(x) + 3/10; }
        impacts { wall: y <= 3/5 => newton(e); }
        initial { x = 1/5; }
    }",
);

#[test]
fn impacts_that_accumulate_end_as_zeno_if_the_energy_has_a_limit() {
    for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Dopri5] {
        let name = integrator.name();
        for (e, speeds) in [
            (0.5, [2.0, 1.0, 0.6, 0.4, 0.1]),
            (0.95, [20.0, 9.5, 5.0, 1.0, 0.6]),
        ] {
            let mut closing = CLOSING.model();
            set(&mut closing, "e", e);
            for speed in speeds {
                let course = Course::new(&closing, &[0.5], &[speed], 5.0);
                let end = course.run(Setting::free(integrator));
                let case = format!("{name}, {e}, {speed}: {:?}", end.outcome);
                assert!(matches!(end.outcome, Outcome::Zeno { .. }), "{case}");
                assert!((end.t - 2.0).abs() < 1e-9, "{case}");
            }
        }
    }
}

/// Without loss the walls are met two million times.
fn assert_elastic_walls_are_spasmodic(integrator: Integrator) {
    let mut elastic = CLOSING.model();
    set(&mut elastic, "e", 1.0);
    let end = Course::new(&elastic, &[0.5], &[1.0], 5.0).run(Setting::free(integrator));
    assert!(
        matches!(end.outcome, Outcome::Spasmodic { .. }),
        "{}: {:?}",
        integrator.name(),
        end.outcome
    );
}

#[test]
fn elastic_impacts_between_closing_walls_are_spasmodic() {
    assert_elastic_walls_are_spasmodic(Integrator::Taylor);
}

#[test]
#[ignore = "nightly: millions of impacts"]
fn elastic_impacts_between_closing_walls_are_spasmodic_with_every_integrator() {
    assert_elastic_walls_are_spasmodic(Integrator::Dop853);
    assert_elastic_walls_are_spasmodic(Integrator::Dopri5);
}

#[test]
fn impacts_that_accumulate_are_spasmodic_if_the_energy_has_no_limit() {
    for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Dopri5] {
        let name = integrator.name();
        for (e, speed) in [(0.9, -0.1), (0.9, -0.7), (0.9, -1.3), (1.0, -0.5)] {
            let driven = DRIVEN_UP.with([("e", e)]);
            let start = [&[0.2, 0.0][..], &[speed, 0.2 * speed + 0.3]];
            let course = Course::new(&driven, start[0], start[1], 10.0);
            let end = course.run(Setting::free(integrator));
            let case = format!("{name}, {e}, {speed}: {:?} {}", end.outcome, end.energy);
            assert!(matches!(end.outcome, Outcome::Spasmodic { .. }), "{case}");
            assert!((end.t - 31.0 / 15.0).abs() < 1e-6, "{case}");
        }
    }
}
