//! Periodic orbits of sections and their Floquet multipliers, compared with references, closed forms and differences.

use dalembert::variations::{Orbit, OrbitError, SectionError};
use dalembert::{Described, Law, Outcome, Tangent, VectorField};
use dalembert_cli::Exit;
use dalembert_stability::course::{Course, state, vector};
use dalembert_stability::text::{Model, Text, shipped, value};
use dalembert_stability::varied::Returns;
use dalembert_tests::command::{self, Finished};
use dalembert_tests::reference::{number, numbers, read};
use dalembert_tests::systems::IntegrableBead;
use serde_json::Value;

/// A spring with a section at its middle, in scenes with and without variations.
static SPRING: Text = Text::new(
    "Spring {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - x^2/2 - y^2/8;
        impacts { middle: x >= 0 => reset { }; wall: y >= -3; }
        initial { x = 1; y = 0.2; until = 20; }
        scenes { bare: wall; varied: wall, middle, variations; }
    }",
);

/// A wheel with a section that it passes once per turn.
static WHEEL: Text = Text::new(
    "Wheel {
        coordinates { theta: angle; }
        lagrangian = dot(theta)^2/2;
        impacts { mark: sin(theta) <= 0 when cos(theta) > 0 => reset { }; }
    }",
);

/// A number that grows until a clock reaches `c`, where a reset maps the number.
static CLOCK: Text = Text::new(
    "Clock {
        coordinates { x; tau; }
        parameters { c = 1; a = 0.7; }
        field { dot(x) = a*x; dot(tau) = 1; }
        impacts { tick: tau <= c => reset { x = c*x*(1 - x); tau = 0; }; }
    }",
);

/// Numbers that decay towards an equilibrium, seen by a clock.
static DECAY: Text = Text::new(
    "Decay {
        coordinates { x; y; tau; }
        parameters { k = 1; }
        field { dot(x) = -0.2*x + 0.5*k; dot(y) = -2*x - 0.3*y + k; dot(tau) = 1; }
        impacts { tick: tau <= 2 => reset { tau = 0; }; }
    }",
);

/// A spiral towards the origin, far from a circle, seen by a clock.
static SPIRAL: Text = Text::new(
    "Spiral {
        coordinates { x; y; phase: angle; }
        field { dot(x) = -x/20 + 6*y; dot(y) = -y/20 - 3/200*x; dot(phase) = 1; }
        impacts { strobe: sin(phase) <= 0 => reset { }; }
        initial { x = 1; y = 1; phase = -1; until = 5; }
    }",
);

/// Largest duration of a return in these tests.
const HORIZON: f64 = 1e4;

type State = <Model as VectorField>::State;

/// The orbit near the first arrival from a state.
fn orbit(
    system: &Model,
    start: &State,
    surface: usize,
    count: u32,
) -> Result<Orbit<Model>, OrbitError> {
    let section = Returns {
        count,
        ..Returns::new(system, surface, HORIZON)
    };
    let first = section.arrive(start, &mut [])?;
    section.periodic(&first.before)
}

/// The walker with the parameters of a set of the reference.
fn walker(set: &Value) -> Model {
    let names = ["mu", "eps", "alpha", "delta"];
    shipped("dimensionless_walker").with(names.map(|name| (name, number(&set[name]))))
}

/// A table with half axes of 2 and 1.
fn table() -> Model {
    shipped("point_billiard").with([("m", 1.0), ("ta", 2.0), ("tb", 1.0)])
}

#[test]
fn the_walkers_orbits_are_those_of_the_reference() {
    let file = read("walker_orbits");
    for set in file["sets"].as_array().expect("sets") {
        let walker = walker(set);
        let delta = value(&walker, "delta");
        let fixed = numbers(&set["fixed_point_post_impact(xi,eta)"]);
        let start = vector(&[delta, 1.02 * fixed[0], 0.99 * fixed[1]]);
        let orbit = orbit(&walker, &start, 0, 1).expect("an orbit");
        let after = orbit.point.after.as_ref();
        assert!(
            (after[1] - fixed[0]).abs() < 1e-13 && (after[2] - fixed[1]).abs() < 1e-13,
            "{after:?}"
        );
        assert!(
            (orbit.point.time - number(&set["period"])).abs() < 1e-13,
            "{}",
            orbit.point.time
        );
        let expected = numbers(&set["floquet_multipliers"]);
        assert_eq!(orbit.dimension, expected.len());
        for ([re, im], expected) in orbit.multipliers.iter().zip(expected) {
            assert!(
                (re - expected).abs() < 1e-12 && im == 0.0,
                "{re} + {im} i for {expected}"
            );
        }
    }
}

#[test]
fn the_derivative_of_the_walkers_return_is_that_of_the_reference() {
    let file = read("walker_orbits");
    for set in file["sets"].as_array().expect("sets") {
        let walker = walker(set);
        let delta = value(&walker, "delta");
        // The return map takes `(xi, eta)` after a step to the values after the next step, both at theta = delta.
        let fixed = numbers(&set["fixed_point_post_impact(xi,eta)"]);
        let start = vector(&[delta, fixed[0], fixed[1]]);
        let mut columns = [Tangent::of_component(1), Tangent::of_component(2)];
        let section = Returns::new(&walker, 0, HORIZON);
        let arrival = section.arrive(&start, &mut columns).expect("an arrival");
        let reset = |xi: f64, eta: f64| {
            let (c, s) = ((2.0 * delta).cos(), delta.cos());
            [c * xi, eta + s * (1.0 - c) * xi]
        };
        let rows = set["return_map_jacobian"].as_array().expect("rows");
        for (j, column) in columns.iter().enumerate() {
            let column = column.state.as_ref();
            let image = reset(column[1], column[2]);
            for (i, row) in rows.iter().enumerate() {
                let expected = numbers(row)[j];
                assert!(
                    (image[i] - expected).abs() < 1e-12,
                    "{} for {expected}",
                    image[i]
                );
            }
        }
        assert!((arrival.before.as_ref()[0] + delta).abs() < 1e-15);
    }
}

#[test]
fn two_bounces_in_an_ellipse_have_the_traces_of_its_axes() {
    let table = table();
    let along_minor = state(&table, &[0.0, 0.0], &[0.0, 1.0]);
    let along_major = state(&table, &[0.0, 0.0], &[1.0, 0.0]);
    for (start, trace, period) in [(along_minor, -1.0, 4.0), (along_major, 194.0, 8.0)] {
        let orbit = orbit(&table, &start, 0, 2).expect("an orbit");
        assert!((orbit.point.time - period).abs() < 1e-12);
        assert_eq!(orbit.dimension, 3);
        let diagonal: f64 = (0..3).map(|i| orbit.derivative[i].as_ref()[i]).sum();
        // The energy adds a multiplier 1.
        assert!((diagonal - 1.0 - trace).abs() < 1e-10, "{diagonal}");
        let product = orbit
            .multipliers
            .iter()
            .fold([1.0, 0.0], |[a, b], [c, d]| [a * c - b * d, a * d + b * c]);
        assert!(
            (product[0] - 1.0).abs() < 1e-10 && product[1].abs() < 1e-10,
            "{product:?}"
        );
    }
}

#[test]
fn an_orbit_is_found_from_beside_it() {
    let table = table();
    let start = state(&table, &[0.05, 0.0], &[0.02, 1.0]);
    let orbit = orbit(&table, &start, 0, 2).expect("an orbit");
    let point = orbit.point.before.as_ref();
    assert!(
        point[0].abs() < 1e-12 && point[2].abs() < 1e-12,
        "{point:?}"
    );
}

/// The map is affine, so that an undamped Newton step from anywhere is exact.
#[test]
fn the_fixed_point_of_an_affine_map_is_found_from_far_away_in_any_units() {
    for k in [1e-3, 1.0, 1e3] {
        let model = DECAY.with([("k", k)]);
        for [x, y] in [
            [1.0, 5.0],
            [1.0, 40.0],
            [0.0, 0.0],
            [2.0, -10.0],
            [300.0, 7.0],
        ] {
            let found = orbit(&model, &vector(&[k * x, k * y, 0.0]), 0, 1).expect("an orbit");
            let case = format!("{k}, {x}, {y}: {} steps", found.iterations);
            assert!(found.iterations <= 12, "{case}");
            let at = found.point.before.as_ref();
            assert!((at[0] - 2.5 * k).abs() < 1e-9 * k, "{case}");
            assert!((at[1] + 40.0 / 3.0 * k).abs() < 1e-9 * k, "{case}");
            let multipliers: Vec<[f64; 2]> = found.multipliers.iter().collect();
            for (multiplier, right) in multipliers.iter().zip([-0.4_f64, -0.6]) {
                assert!((multiplier[0] - right.exp()).abs() < 1e-9, "{case}");
            }
        }
    }
}

/// The multipliers are complex, so that a single deviation grows and shrinks in turn.
#[test]
fn the_exponent_of_an_orbit_is_that_of_its_multipliers() {
    for further in [1, 2, 7] {
        let mut models = dalembert_command::all();
        models.push(SPIRAL.entry());
        let line = format!(
            "map spiral --vary x=0.4..1.2:3 --returns 150 --surface strobe --lyapunov {further} --csv -"
        );
        let finished = command::line(models, &line, "");
        assert_eq!(finished.exit, Exit::Reached, "{}", finished.errors);
        let mut lines = finished.output.lines();
        let names = lines.next().expect("names").split(',');
        let column = names.into_iter().position(|name| name == "exponent");
        let column = column.expect("exponents");
        let exponents =
            lines.map(|row| row.split(',').nth(column).expect("a value").parse::<f64>());
        let exponents: Vec<f64> = exponents.map(|value| value.expect("a number")).collect();
        let right = -core::f64::consts::PI / 10.0;
        assert_eq!(exponents.len(), 3);
        assert!(
            exponents.iter().all(|it| (it - right).abs() < 1e-9),
            "{exponents:?}"
        );
    }
}

#[test]
fn an_orbit_of_an_angle_closes_after_a_turn() {
    let wheel = WHEEL.model();
    let orbit = orbit(&wheel, &state(&wheel, &[1.0], &[2.0]), 0, 1).expect("an orbit");
    assert!((orbit.point.time - std::f64::consts::PI).abs() < 1e-14);
    let turns = orbit.point.before.as_ref()[0] / (2.0 * std::f64::consts::PI);
    assert!(
        (turns - turns.round()).abs() < 1e-14 && turns > 0.5,
        "{turns}"
    );
    let multipliers: Vec<[f64; 2]> = orbit.multipliers.iter().collect();
    assert_eq!(multipliers, [[1.0, 0.0]]);
}

/// In the global form states can leave the constraint and its level set. The directions of the section are tangent to
/// both.
#[test]
fn directions_of_a_section_keep_constraints_and_levels() {
    let bead = Text::new(IntegrableBead::DESCRIPTION.source.value()).model();
    let (x, y) = (-1.2, 0.8);
    let start = state(&bead, &[x, y], &[0.0, 0.0]);
    let orbit = orbit(&bead, &start, 0, 1).expect("an orbit");
    let point = orbit.point.before.as_ref();
    assert_eq!((point.len(), orbit.dimension), (4, 1));
    let [multiplier, imaginary] = orbit.multipliers.iter().next().expect("one");
    assert!(
        (multiplier - 1.0).abs() < 1e-10 && imaginary == 0.0,
        "{multiplier}"
    );
    let level = |q: &[f64]| q[0] * q[0] / 4.0 + q[1] * q[1] - 1.0;
    assert!(level(&point[..2]).abs() < 1e-12);
    let direction = orbit.directions[0].as_ref();
    let along = point[0] / 2.0 * direction[0] + 2.0 * point[1] * direction[1];
    assert!(along.abs() < 1e-12, "{direction:?}");
}

/// A ball on a table that a motor moves up and down. After a bounce of the duration `pi`, half a turn of the motor, the
/// table is where it was. Up and down with the speed `v = 9.81 pi/2`, and `v - c = 0.98 (v + c)` for the speed `c` of the table.
#[test]
fn a_constraint_that_is_a_clock_leaves_its_phase_free() {
    static TABLE: Text = Text::new(
        "Table {
            coordinates { x; phase: angle; }
            lagrangian = (dot(x)^2 + dot(phase)^2)/2 - 9.81*x;
            constraints { motor: dot(phase) = 2; }
            impacts { table: x - sin(phase)/10 >= 0 => newton(0.98); }
        }",
    );
    let speed = 9.81 * core::f64::consts::FRAC_PI_2;
    let right = (0.02 * speed / 1.98 / 0.2).acos();
    let table = TABLE.model();
    for phase in [0.67, 0.6, 0.8] {
        let start = state(&table, &[0.11, phase], &[15.4, 2.0]);
        let found = orbit(&table, &start, 0, 1).expect("an orbit");
        assert!((found.point.time - core::f64::consts::PI).abs() < 1e-12);
        let at = found.point.before.as_ref();
        assert!((at[1].sin() - right.sin()).abs() < 1e-10, "{at:?}");
        assert!((at[1].cos() - right.cos()).abs() < 1e-10, "{at:?}");
        let [re, im] = found.multipliers.iter().next().expect("two");
        assert!((re.hypot(im) - 0.98).abs() < 1e-9, "{re}, {im}");
    }
}

/// Each bounce is lower than the one before. In the limit the ball is at rest on the floor, which is no orbit.
#[test]
fn a_motion_that_ceases_is_no_orbit() {
    let ball = shipped("bouncing_ball").model();
    let section = Returns {
        law: Some(Law::Newton(0.5)),
        ..Returns::new(&ball, 0, HORIZON)
    };
    let first = section.arrive(&state(&ball, &[1.0], &[0.0]), &mut []);
    let missed = section.periodic(&first.expect("an arrival").before);
    assert!(matches!(
        missed.err(),
        Some(OrbitError::NotConverged { .. })
    ));
}

#[test]
fn what_is_no_orbit_is_said() {
    let walker = shipped("dimensionless_walker").model();
    let far = vector(&[value(&walker, "delta"), 5.0, 0.0]);
    let missed = orbit(&walker, &far, 0, 1).err().expect("no orbit");
    assert!(
        matches!(missed, OrbitError::Section(SectionError::Ended(_))),
        "{missed}"
    );
    let disk = shipped("moving_wall_disk").model();
    let start = *Course::new(&disk, &[0.0, 0.0, 0.0, 0.3], &[0.0, 0.0, 8.0, 0.5], 0.0).start();
    let short = Returns::new(&disk, 0, 0.1);
    let missed = short.arrive(&start, &mut []).expect_err("no arrival");
    assert_eq!(missed, SectionError::Ended(Outcome::Done));
    let moving = orbit(&disk, &start, 0, 1).err().expect("no orbit");
    assert_eq!(moving, OrbitError::DependsOnTime);
}

/// Time in a condition, in a reset on the way, in the rates of one mode, in a force that vanishes at all events.
static DRIVEN: [Text; 4] = [
    Text::new("Early { coordinates { x; y; } field { dot(x) = -1; dot(y) = -y; }
        impacts { end: x >= 0 when t <= 1.5 => reset { x = 1; }; } initial { x = 1; y = 0.1; until = 5; } }"),
    Text::new("OnTheWay { coordinates { x; y; } field { dot(x) = -1; dot(y) = -y; }
        impacts { end: x >= 0 => reset { x = 1; y = y + 0.1; }; mid: x >= 1/2 => reset { y = y*(1 + t/10); }; }
        initial { x = 1; y = 0.1; until = 5; } }"),
    Text::new("OneMode { coordinates { x; y; }
        modes { early { field { dot(x) = 1; dot(y) = -y + sin(3*t); } initial { x = 0; y = 0.1; until = 9; } }
            late { field { dot(x) = 1; dot(y) = -y; } } }
        transitions { back: late -> early when x >= 1 => reset { x = 0; }; end: early -> late when x >= 1 => reset { x = 0; }; } }"),
    Text::new("Between { coordinates { x; y; } field { dot(x) = -1; dot(y) = -y + x^2*(1 - x)^2*sin(t); }
        impacts { end: x >= 0 => reset { x = 1; }; } initial { x = 1; y = 0.1; until = 5; } }"),
];

#[test]
fn a_system_with_time_anywhere_has_no_orbit() {
    for (index, text) in DRIVEN.iter().enumerate() {
        let model = text.model();
        // The state of the model with modes ends with the number of its mode.
        let start: &[f64] = if index == 2 {
            &[0.0, 0.1, 0.0]
        } else {
            &[1.0, 0.1]
        };
        let found = orbit(&model, &vector(start), 0, 1);
        assert_eq!(found.err(), Some(OrbitError::DependsOnTime), "{index}");
    }
}

/// A command line over the models of this file.
fn run(line: &str) -> Finished {
    let mut models = dalembert_command::all();
    models.push(SPRING.entry());
    command::line(models, line, "")
}

#[test]
fn the_command_prints_the_orbit_and_its_multipliers() {
    let Finished {
        exit,
        output: text,
        errors,
    } = run("orbit dimensionless_walker --surface step");
    assert_eq!((exit, errors.as_str()), (Exit::Reached, ""));
    let multipliers = text
        .lines()
        .find(|line| line.contains("multipliers"))
        .expect("multipliers");
    assert!(
        multipliers.contains("0.52068371444893") && multipliers.contains("0.00738231665312"),
        "{text}"
    );
    let line =
        "orbit point_billiard --surface wall --period 2 --set ta=2 --q 0,0 --qdot 1,0 --json -";
    let Finished {
        exit, output: text, ..
    } = run(line);
    assert_eq!(exit, Exit::Reached);
    let document: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(document["outcome"]["kind"], "done");
    assert_eq!(
        (&document["surface"], &document["returns"]),
        (&"wall".into(), &2.into())
    );
    assert_eq!(document["before"]["q"].to_string(), "[2.0,0.0]");
    let real = document["multipliers"]
        .as_array()
        .expect("multipliers")
        .iter();
    let trace: f64 = real
        .map(|multiplier| multiplier["re"].as_f64().expect("a number"))
        .sum();
    assert!((trace - 195.0).abs() < 1e-10, "{trace}");
    let rows = document["derivative"].as_array().expect("rows");
    let directions = document["directions"].as_array().expect("directions");
    assert_eq!((rows.len(), directions.len()), (3, 3));
    assert_eq!(
        numbers(&directions[0]).len(),
        document["components"].as_array().expect("names").len()
    );
}

#[test]
fn a_section_that_is_no_wall_is_a_surface_without_effect() {
    // The periods along the axes are 2 pi and 4 pi. After two passages all states return.
    let Finished {
        exit,
        output: text,
        errors,
    } = run("orbit spring --scene varied --surface middle --period 2 --json -");
    assert_eq!((exit, errors.as_str()), (Exit::Reached, ""), "{text}");
    let document: Value = serde_json::from_str(&text).expect("JSON");
    let period = document["period"].as_f64().expect("a period");
    assert!(
        (period - 4.0 * std::f64::consts::PI).abs() < 1e-12,
        "{period}"
    );
    let rows = document["derivative"].as_array().expect("rows");
    for (i, row) in rows.iter().enumerate() {
        for (j, entry) in numbers(row).into_iter().enumerate() {
            assert!(
                (entry - f64::from(u8::from(i == j))).abs() < 1e-12,
                "{text}"
            );
        }
    }
    // After one passage the motion along y has completed half a period.
    let Finished {
        exit, output: text, ..
    } = run("orbit spring --scene varied --surface middle");
    assert_eq!(exit, Exit::Reached, "{text}");
    let multipliers = text
        .lines()
        .find(|line| line.contains("multipliers"))
        .expect("multipliers");
    assert_eq!(
        multipliers.matches("-1").count() + multipliers.matches("-0.99999").count(),
        2,
        "{text}"
    );
}

#[test]
fn the_command_says_what_it_cannot_do() {
    let refused = |line: &str, part: &str| {
        let Finished {
            exit,
            output: text,
            errors,
        } = run(line);
        assert_eq!((exit, text.as_str()), (Exit::Refused, ""), "{line}");
        assert!(errors.contains(part), "{line}: {errors}");
    };
    refused(
        "orbit spring --surface ceiling",
        "--surface: unknown surface `ceiling`",
    );
    refused(
        "orbit spring --scene bare --surface wall",
        "`bare` was declared without `variations`",
    );
    refused(
        "orbit spring --surface wall --off-constraint keep",
        "--off-constraint keep",
    );
    refused("orbit spring --surface wall --period 0", "--period");
    refused("orbit spring", "--surface");
    let Finished {
        exit, output: text, ..
    } = run(
        "orbit moving_wall_disk --surface leading_edge --q 0,0,0,0.3 --qdot 1.910672978251212,0.5910404133226791,8,0.5",
    );
    assert_eq!(exit, Exit::Other);
    assert!(text.contains("outcome      depends_on_time"), "{text}");
    let Finished {
        exit, output: text, ..
    } = run("orbit dimensionless_walker --surface step --initial xi=5 --json -");
    assert_eq!(exit, Exit::Other);
    let document: Value = serde_json::from_str(&text).expect("JSON");
    assert_ne!(document["outcome"]["kind"], "done");
    assert!(document.get("multipliers").is_none());
}

/// The point `x` has the image `e^(a c) c x (1 - x)`. The section moves with the parameter `c`.
#[test]
fn the_return_map_has_its_derivative_in_a_parameter() {
    let (x, c, a) = (0.3, 1.25, 0.7);
    let clock = CLOCK.with([("c", c)]);
    let section = Returns::new(&clock, 0, HORIZON);
    let grown = f64::exp(a * c) * x * (1.0 - x);
    for (parameter, shift, slope) in [(0, 1.0, (1.0 + a * c) * grown), (1, 0.0, c * c * grown)] {
        let image = section
            .image(&vector(&[x, c]), parameter)
            .expect("an image");
        assert_eq!((image.dimension, image.is_closed), (1, false));
        let along = image.directions[0].as_ref()[0];
        assert_eq!((along.abs(), image.directions[0].as_ref()[1]), (1.0, 0.0));
        assert!((image.image.before.as_ref()[0] - c * grown).abs() < 1e-14);
        assert!((along * image.miss.as_ref()[0] - (c * grown - x)).abs() < 1e-14);
        let expected = c * f64::exp(a * c) * (1.0 - 2.0 * x);
        assert!((image.derivative[0].as_ref()[0] - expected).abs() < 1e-14);
        assert_eq!(image.shift.as_ref()[..2], [0.0, shift]);
        let found = along * image.slope.as_ref()[0];
        assert!((found - slope).abs() < 1e-14, "{found} for {slope}");
    }
}

/// The branch of the compass walker over the slope, as a document.
fn walks(flags: &str) -> Value {
    let Finished { exit, output, .. } = run(&format!(
        "orbit compass_walker --surface heel {flags} --json -"
    ));
    assert_eq!(exit, Exit::Reached);
    serde_json::from_str(&output).expect("JSON")
}

/// Real parts of the multipliers of a point.
fn multipliers(point: &Value) -> Vec<f64> {
    let all = point["multipliers"].as_array().expect("multipliers").iter();
    all.map(|it| it["re"].as_f64().expect("a number")).collect()
}

/// The reference slope solves `1 + trace + determinant = 0` for the derivative of the return map, which was computed by
/// a Runge-Kutta method of fixed step and extrapolated central differences. It has about nine digits.
#[test]
fn the_compass_walker_doubles_its_period_where_a_multiplier_passes_minus_one() {
    const SLOPE: f64 = 0.015_088_437_7;
    let branch = walks("--continue gamma=0.001..0.019");
    let found = branch["bifurcations"].as_array().expect("bifurcations");
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0]["bifurcation"], "flip");
    let slope = found[0]["parameter"].as_f64().expect("a number");
    assert!((slope - SLOPE).abs() < 1e-9, "{slope}");
    assert!((multipliers(&found[0])[0] + 1.0).abs() < 1e-9);
    // The long gait is stable below this slope and unstable above it.
    let start = "--initial theta=0.2371,phi=0.4742,omega=-0.2319,psi=-0.0255";
    for (change, is_stable) in [(-1e-6, true), (1e-6, false)] {
        let orbit = walks(&format!("{start} --set gamma={}", slope + change));
        assert_eq!(multipliers(&orbit)[0] > -1.0, is_stable);
        assert!((multipliers(&orbit)[0] + 1.0).abs() < 1e-3);
    }
    let stable = |point: &&Value| point["stability"] == "stable";
    let points = branch["points"].as_array().expect("points");
    let slopes = points
        .iter()
        .filter(stable)
        .map(|it| it["parameter"].as_f64());
    assert!(slopes.flatten().all(|gamma| gamma < slope));
}
