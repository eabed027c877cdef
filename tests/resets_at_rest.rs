//! Resets of surfaces on which the motion is at rest: they act once it is pressed into them, and not before.

use dalembert::Outcome;
use dalembert_cli::Integrator;
use dalembert_cli::suite::Setting;
use dalembert_stability::course::{Course, End};
use dalembert_stability::text::{Model, Text};

/// A run by an integrator, with this length of fixed steps.
fn run(integrator: Integrator, model: &Model, q: &[f64], until: f64, step: f64) -> End {
    let qdot = vec![0.0; q.len()];
    let course = Course::new(model, q, &qdot, until).tol(1e-10);
    let course = match integrator.is_adaptive() {
        true => course,
        false => course.step(step),
    };
    course.run(Setting::free(integrator))
}

fn assert_times(text: &Text, q: &[f64], until: f64, right: &[f64]) {
    let model = text.model();
    for &integrator in Integrator::every() {
        let end = run(integrator, &model, q, until, 1e-2);
        let times: Vec<f64> = end.hits.iter().map(|hit| hit.t).collect();
        let case = format!("{}: {:?} {times:?}", integrator.name(), end.outcome);
        assert_eq!(end.outcome, Outcome::Done, "{case}");
        assert_eq!(times.len(), right.len(), "{case}");
        let mut errors = times.iter().zip(right).map(|(t, right)| (t - right).abs());
        assert!(errors.all(|error| error < 1e-8), "{case}");
    }
}

static LIFTED: Text = Text::new(
    "Lifted {
        coordinates { x; }
        lagrangian = dot(x)^2/2 - x;
        impacts { floor: x >= 0 => reset { x = 1; dot(x) = 0; }; }
    }",
);

static KICKED: Text = Text::new(
    "Kicked {
        coordinates { x; }
        lagrangian = dot(x)^2/2 - x;
        impacts { floor: x >= 0 => reset { dot(x) = 2; }; }
    }",
);

#[test]
fn a_body_that_starts_at_rest_on_a_floor_is_reset_at_once() {
    let fall = 2.0_f64.sqrt();
    assert_times(&LIFTED, &[0.0], 5.0, &[0.0, fall, 2.0 * fall, 3.0 * fall]);
    assert_times(&KICKED, &[0.0], 5.0, &[0.0, 4.0]);
}

static COUNTED: Text = Text::new(
    "Counted {
        coordinates { x; n; m; }
        parameters { g = 1; k = 0; }
        lagrangian = (dot(x)^2 + dot(n)^2 + dot(m)^2)/2 - g*x - k*x^2/2;
        impacts {
            one: x >= 0 => reset { n = n + 1; };
            ten: 2*x + x^3 >= 0 => reset { n = n + 10; };
            last: x + m/10 >= 0 => reset { m = m + 1; };
        }
    }",
);

#[test]
fn surfaces_that_are_touched_together_act_once_each() {
    for &integrator in Integrator::every() {
        let end = run(integrator, &COUNTED.model(), &[0.0; 3], 0.4, 1e-2);
        assert_eq!(end.outcome, Outcome::Done, "{}", integrator.name());
        assert_eq!(end.q[1..], [11.0, 1.0], "{}", integrator.name());
    }
}

#[test]
fn a_body_that_stays_or_rises_is_not_reset() {
    for (g, k) in [(0.0, 0.0), (0.0, 1.0), (-1.0, 0.0)] {
        let model = COUNTED.with([("g", g), ("k", k)]);
        for &integrator in Integrator::every() {
            let end = run(integrator, &model, &[0.0; 3], 0.4, 1e-2);
            assert_eq!(end.outcome, Outcome::Done, "{}", integrator.name());
            assert!(end.hits.is_empty(), "{}, {g}, {k}", integrator.name());
        }
    }
}

/// A platform that a reset puts the body on has acted before, and was left since, by a surface above or below it.
#[test]
fn a_surface_acts_again_after_it_was_left() {
    let shelf = Text::new(
        "Shelf {
            coordinates { x; n; }
            lagrangian = (dot(x)^2 + dot(n)^2)/2 - x;
            impacts {
                floor: x >= 0 => reset { x = 1; dot(x) = 0; };
                shelf: x >= 1 => reset { n = n + 1; };
            }
        }",
    );
    let fall = 2.0_f64.sqrt();
    let right = [1.0, 1.0, 1.0 + fall, 1.0 + fall];
    assert_times(&shelf, &[0.5, 0.0], 3.0, &right);
}

/// One surface is passed at the start, the other touched.
#[test]
fn a_surface_that_has_acted_is_not_met_again_by_the_reset_of_another() {
    let pair = Text::new(
        "Pair {
            coordinates { x; y; n; m; }
            lagrangian = (dot(x)^2 + dot(y)^2 + dot(n)^2 + dot(m)^2)/2 - x;
            impacts {
                rest: x >= 0 => reset { n = n + 1; };
                met: y >= 0 => reset { m = m + 1; };
            }
        }",
    );
    let model = pair.model();
    for &integrator in Integrator::every() {
        let course = Course::new(&model, &[0.0; 4], &[0.0, -1.0, 0.0, 0.0], 0.5);
        let end = course.tol(1e-10).step(1e-2).run(Setting::free(integrator));
        assert_eq!(end.outcome, Outcome::Done, "{}", integrator.name());
        assert_eq!(end.q[2..], [1.0, 1.0], "{}", integrator.name());
    }
}

/// The surface leaves the body behind; it acts once.
#[test]
fn a_surface_that_moves_off_from_rest_acts_once() {
    for text in [
        "Rising { coordinates { y; m; } lagrangian = (dot(y)^2 + dot(m)^2)/2; impacts { s: y >= t^2/4 => reset { m = m + 1; }; } }",
        "Rising { coordinates { y; m; } lagrangian = (dot(y)^2 + dot(m)^2)/2; impacts { s: y >= t^4 => reset { m = m + 1; }; } }",
    ] {
        assert_times(&Text::new(text), &[0.0; 2], 2.0, &[0.0]);
    }
}

/// A wall that holds the motion is found first.
#[test]
fn a_wall_that_is_touched_too_hides_no_reset() {
    let corner = Text::new(
        "Corner {
            coordinates { x; y; n; }
            lagrangian = (dot(x)^2 + dot(y)^2 + dot(n)^2)/2 - x - y;
            impacts { wall: y >= 0 => newton(1); rest: x >= 0 => reset { n = n + 1; }; }
        }",
    );
    let model = corner.model();
    for &integrator in Integrator::every() {
        let course = Course::new(&model, &[0.0; 3], &[0.0; 3], 0.5).resting();
        let end = course.tol(1e-10).step(1e-2).run(Setting::free(integrator));
        assert_eq!(end.outcome, Outcome::Done, "{}", integrator.name());
        assert_eq!(end.q[2], 1.0, "{}", integrator.name());
        // Where nothing holds the motion, the reset may still lead it off.
        let course = Course::new(&model, &[0.0; 3], &[0.0; 3], 0.5);
        let end = course.step(1e-2).run(Setting::free(integrator));
        let is_contact = matches!(end.outcome, Outcome::Contact { surface: 0 });
        assert!(is_contact && end.q[2] == 1.0, "{}", integrator.name());
    }
}

/// The gap rate after the first reset is 0 but for rounding, and the gap then falls.
#[test]
fn a_reset_that_stops_the_gap_is_not_repeated() {
    let stopped = Text::new(
        "Stopped {
            coordinates { x; y; n; }
            lagrangian = (dot(x)^2 + dot(y)^2 + dot(n)^2)/2 - x - y;
            impacts { s: x + y >= -t/2 => reset { n = n + 1; dot(x) = 0; }; }
        }",
    );
    for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Dopri5] {
        let end = run(integrator, &stopped.model(), &[0.0; 3], 3.0, 1e-2);
        assert_eq!(end.outcome, Outcome::Done, "{}", integrator.name());
        assert_eq!(end.q[2], 1.0, "{}", integrator.name());
    }
}

/// Modes that lead to each other, the motion at rest on the surface of each transition.
#[test]
fn a_circle_of_modes_at_rest_is_trapped() {
    let circle = Text::new(
        "Circle {
            coordinates { x; }
            modes {
                a { lagrangian = dot(x)^2/2 - x; initial { x = 0; } }
                b { lagrangian = dot(x)^2/2 - x; }
                c { lagrangian = dot(x)^2/2 - x; }
            }
            transitions {
                one: a -> b when x <= 0 => reset { x = 1; };
                two: b -> c when x <= 1 => reset { x = 2; };
                three: c -> a when x <= 2 => reset { x = 0; };
            }
        }",
    );
    let model = circle.model();
    for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Rk4] {
        let course = Course::new(&model, &[0.0], &[0.0], 1.0).resting();
        let end = course.step(1e-2).run(Setting::free(integrator));
        let is_trapped = matches!(end.outcome, Outcome::Trapped { .. });
        assert!(is_trapped, "{}: {:?}", integrator.name(), end.outcome);
    }
}

/// A force that grows from 0 like a power of time, and one that begins later.
#[test]
fn a_force_that_grows_from_0_presses_from_then_on() {
    let grows = Text::new(
        "Grows {
            coordinates { x; n; }
            lagrangian = (dot(x)^2 + dot(n)^2)/2;
            forces { f: -t^5*d(x); }
            impacts { floor: x >= 0 => reset { n = n + 1; }; }
        }",
    );
    for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Dopri5] {
        let end = run(integrator, &grows.model(), &[0.0; 2], 3.0, 1e-2);
        let times: Vec<f64> = end.hits.iter().map(|hit| hit.t).collect();
        assert_eq!(times, [0.0], "{}", integrator.name());
    }
    let hidden = Text::new(
        "Hidden {
            coordinates { x; n; }
            lagrangian = (dot(x)^2 + dot(n)^2)/2;
            forces { f: -t*d(x); }
            impacts { floor: x >= 1000 => reset { n = n + 1; }; }
        }",
    );
    for &integrator in Integrator::every() {
        let end = run(integrator, &hidden.model(), &[1000.0, 0.0], 2.0, 1e-2);
        assert_eq!(end.q[1], 1.0, "{}", integrator.name());
    }
    let begins = Text::new(
        "Begins {
            coordinates { x; n; }
            lagrangian = (dot(x)^2 + dot(n)^2)/2;
            forces { f: -(abs(t - 1) + t - 1)*d(x); }
            impacts { floor: x >= 0 => reset { n = n + 1; }; }
        }",
    );
    for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Dopri5] {
        let end = run(integrator, &begins.model(), &[0.0; 2], 3.0, 1e-2);
        let times: Vec<f64> = end.hits.iter().map(|hit| hit.t).collect();
        let case = format!("{}: {times:?}", integrator.name());
        // Across the kink of the force, errors of a step below the tolerance may pass through the surface too.
        let is_near = times.iter().all(|t| (t - 1.0).abs() < 1e-3);
        assert!(!times.is_empty() && is_near, "{case}");
    }
}

/// The gap of a start on a circle has a rounding error of either sign.
#[test]
fn a_start_within_rounding_of_a_disk_is_on_it() {
    let disk = Text::new(
        "Disk {
            coordinates { x; y; n; }
            parameters { r > 0 = 1; c = 0; }
            lagrangian = (dot(x)^2 + dot(y)^2 + dot(n)^2)/2 - y;
            impacts { disk: sqrt((x - c)^2 + y^2) >= r => reset { n = n + 1; }; }
        }",
    );
    for (r, c) in [(0.3, 0.0), (1.1, 1.7), (1e-2, -13.3), (0.3, 1e3)] {
        let model = disk.with([("r", r), ("c", c)]);
        for angle in (0..12).map(|k| 0.3 + 0.21 * f64::from(k)) {
            let start = [c + r * angle.cos(), r * angle.sin(), 0.0];
            let until = 0.3 * r.sqrt();
            for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Gauss6] {
                let end = run(integrator, &model, &start, until, 0.1 * until);
                let case = format!("{}, {r}, {c}, {angle}", integrator.name());
                assert_eq!(end.outcome, Outcome::Done, "{case}");
                assert_eq!(end.q[2], 1.0, "{case}");
            }
        }
    }
}

/// Each surface sets the body to rest on the other, into which it is pressed.
#[test]
fn resets_that_lead_to_each_other_at_rest_are_an_accumulation() {
    let rounds = Text::new(
        "Rounds {
            coordinates { x; }
            lagrangian = (dot(x)^2 + (x - 1/2)^2)/2;
            impacts {
                low: x >= 0 => reset { x = 1; dot(x) = 0; };
                high: x <= 1 => reset { x = 0; dot(x) = 0; };
            }
        }",
    );
    for &integrator in Integrator::every() {
        let end = run(integrator, &rounds.model(), &[0.0], 1.0, 1e-2);
        let is_zeno = matches!(end.outcome, Outcome::Zeno { t: 0.0, .. });
        assert!(is_zeno, "{}: {:?}", integrator.name(), end.outcome);
    }
}

/// The mode is entered at rest on a surface, into which the motion is pressed.
#[test]
fn a_mode_that_is_entered_at_rest_begins_with_its_reset() {
    let entry = Text::new(
        "Entry {
            coordinates { x; }
            modes {
                up { lagrangian = dot(x)^2/2 + x; initial { x = 0; } }
                down { lagrangian = dot(x)^2/2 - x; impacts { floor: x >= 1 => reset { x = 2; }; } }
            }
            transitions { turn: up -> down when x >= 3/2 => reset { x = 1; dot(x) = 0; }; }
        }",
    );
    let turn = 3.0_f64.sqrt();
    let model = entry.model();
    for integrator in [
        Integrator::Taylor,
        Integrator::Dop853,
        Integrator::Dopri5,
        Integrator::Rk4,
    ] {
        let end = run(integrator, &model, &[0.0], 3.0, 1e-2);
        assert_eq!(end.outcome, Outcome::Done, "{}", integrator.name());
        let times: Vec<f64> = end.hits.iter().map(|hit| hit.t).collect();
        assert_eq!(times.len(), 2, "{}: {times:?}", integrator.name());
        assert!(
            times.iter().all(|t| (t - turn).abs() < 1e-8),
            "{}: {times:?}",
            integrator.name()
        );
    }
}
