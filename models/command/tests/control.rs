//! Optimal control across impacts: reference values, closed forms, differences, and requests that are refused.

// A test may fail by panicking.
#![allow(clippy::unwrap_used)]

mod support;

use dalembert_cli::Exit;
use serde_json::Value;
use support::run_on;

/// The model `controlled_ball`, declared by its Lagrangian.
const BALL: &str = "
    Ball {
        coordinates { x; }
        parameters { m > 0 = 2; g > 0 = 1; e > 0 = 1; alpha > 0 = 10; }
        inputs { u; }
        cost { running = u^2/2; terminal = alpha*(x - 1)^2; }
        lagrangian = m/2*dot(x)^2 - m*g*x;
        forces { push: u*d(x); }
        impacts { floor: x >= 0 => newton(e); }
        initial { x = 1/2; until = 5; }
    }";

/// Two coupled masses on which only the inputs act, with the metric `M = (2, 1; 1, 3)`. From rest to rest over the
/// displacement `d` the input is `M d (6 - 12 s)/T^2` with `s = t/T`, and the cost is `6 |M d|^2/T^3`.
const MASSES: &str = "
    Masses {
        coordinates { x; y; }
        inputs { u; w; }
        cost { running = (u^2 + w^2)/2; }
        lagrangian = dot(x)^2 + dot(x)*dot(y) + 3/2*dot(y)^2;
        forces { first: u*d(x); second: w*d(y); }
        initial { until = 2; }
    }";

/// A free particle above a wall that may move. Without an impact the cost from rest to rest over the displacement
/// `(a, b)` is `6 (a^2 + b^2)/T^3`. With an impact on the wall at rest, the cost is that of the motion to the mirror
/// image of the end.
const MIRROR: &str = "
    Mirror {
        coordinates { x; y; }
        parameters { c = 0; }
        inputs { u; w; }
        cost { running = (u^2 + w^2)/2; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        forces { first: u*d(x); second: w*d(y); }
        impacts { wall: y - c*t >= 0; }
        initial { y = 1; until = 2; }
    }";

/// Extremals satisfy `x'' = -x`; they are minima as long as the time is less than pi.
const SPRING: &str = "
    Spring {
        coordinates { x; }
        inputs { u; }
        cost { running = u^2/2 - x^2/2; }
        field { dot(x) = u; }
        initial { x = 1; }
    }";

/// The running cost is convex only for `k > -1`.
const WEIGHTED: &str = "
    Weighted {
        coordinates { x; }
        parameters { k = 1; }
        inputs { u; }
        cost { running = (1 + k)*u^2/2; terminal = x^2; }
        field { dot(x) = u; }
        initial { x = 1; until = 1; }
    }";

/// Linear equations with a quadratic cost, which have one extremal. In the scalar one it is `p = P x` with
/// `P = tanh(w t)/(w - a tanh(w t))`, `w^2 = a^2 + 1`, and the time `t` that is left; the cost is `P x^2/2`.
const SCALAR: &str = "
    Scalar {
        coordinates { x; }
        parameters { a = 1; }
        inputs { u; }
        cost { running = (x^2 + u^2)/2; }
        field { dot(x) = a*x + u; }
        initial { x = 1; }
    }";

/// A cart that an input pushes.
const CART: &str = "
    Cart {
        coordinates { x; v; }
        inputs { u; }
        cost { running = (x^2 + u^2)/2; }
        field { dot(x) = v; dot(v) = u; }
        initial { x = 1; v = 1/2; }
    }";

/// The extremals of a document, by cost.
fn extremals_on(input: &str, line: &str) -> Vec<Value> {
    let done = run_on(input, &format!("control {line} --json -"));
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let document: Value = serde_json::from_str(&done.output).unwrap();
    let extremals = document["extremals"].as_array().unwrap().clone();
    for extremal in &extremals {
        assert!(number(&extremal["residual"]) < 1e-9, "{extremal}");
        check_energy(extremal);
    }
    extremals
}

/// The minimised Hamiltonian `H*` is the same at both ends and on both sides of every impact, because the model does
/// not depend on time.
fn check_energy(extremal: &Value) {
    let first = number(&extremal["start"]["hamiltonian"]);
    let impacts = extremal["impacts"].as_array().unwrap().iter();
    let sides = impacts.clone().flat_map(|it| [&it["before"], &it["after"]]);
    for side in sides.chain([&extremal["end"]]) {
        assert_near(
            number(&side["hamiltonian"]),
            first,
            1e-9 * first.abs().max(1.0),
        );
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn count(extremal: &Value) -> usize {
    extremal["impacts"].as_array().unwrap().len()
}

fn verdict(extremal: &Value) -> &str {
    extremal["second_order"]["verdict"].as_str().unwrap()
}

#[track_caller]
fn assert_near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{found} and {expected}");
}

/// A reference: number of impacts, cost, costate at the start, state at the end, times of the impacts.
struct Reference {
    impacts: usize,
    cost: f64,
    costate: [f64; 2],
    end: [f64; 2],
    times: &'static [f64],
}

/// Checks that every reference is among the extremals exactly once.
#[track_caller]
fn assert_found(extremals: &[Value], references: &[Reference]) {
    for reference in references {
        let is_it = |it: &&Value| {
            count(it) == reference.impacts
                && (number(&it["cost"]) - reference.cost).abs() < 1e-10
                && (number(&it["start"]["costate"]["x"]) - reference.costate[0]).abs() < 1e-9
        };
        let mut found = extremals.iter().filter(is_it);
        let extremal = found
            .next()
            .unwrap_or_else(|| panic!("{} is missing", reference.cost));
        assert!(found.next().is_none(), "{} twice", reference.cost);
        assert_near(
            number(&extremal["start"]["costate"]["y"]),
            reference.costate[1],
            1e-9,
        );
        for (name, expected) in ["x", "y"].iter().zip(reference.end) {
            assert_near(number(&extremal["end"]["state"][name]), expected, 1e-9);
        }
        let impacts = extremal["impacts"].as_array().unwrap();
        for (impact, t) in impacts.iter().zip(reference.times) {
            assert_near(number(&impact["t"]), *t, 1e-9);
        }
    }
}

#[test]
fn the_extremals_of_a_ball_with_a_free_end_are_the_references() {
    let extremals = extremals_on("", "controlled_ball --impacts 0..2");
    let references = [
        Reference {
            impacts: 0,
            cost: 8.073248407643312,
            costate: [-1.2420382165605095, -3.105095541401274],
            end: [0.9378980891719745, -2.2372611464968153],
            times: &[],
        },
        Reference {
            impacts: 1,
            cost: 1.9530584410888775,
            costate: [-4.400027296542856, -0.5648549392476628],
            end: [0.9613233606479138, -2.5084375053044895],
            times: &[0.9659448683239102],
        },
        Reference {
            impacts: 2,
            cost: 0.2105697850481026,
            costate: [-1.2263860173513595, -0.0354905790759868],
            end: [0.9722943224577573, -0.2539240104961689],
            times: &[0.9619967733679686, 3.4077339491248453],
        },
    ];
    assert_found(&extremals, &references);
    assert_eq!(extremals.len(), 3);
    assert!(extremals.iter().all(|it| verdict(it) == "minimum"));
    let costs: Vec<f64> = extremals.iter().map(|it| number(&it["cost"])).collect();
    assert!(costs.is_sorted(), "{costs:?}");
    // The optimal input is minus the costate of the momentum, and 0 at a free end.
    for extremal in &extremals {
        let start = &extremal["start"];
        assert_near(
            number(&start["inputs"]["u"]),
            -number(&start["costate"]["y"]),
            1e-15,
        );
        assert_near(number(&extremal["end"]["inputs"]["u"]), 0.0, 1e-12);
    }
}

#[test]
fn the_extremals_of_a_ball_from_above_are_the_references() {
    let extremals = extremals_on("", "controlled_ball --initial x=2 --impacts 0..2");
    let references = [
        Reference {
            impacts: 0,
            cost: 6.317675159235669,
            costate: [-1.0987261146496815, -2.7468152866242038],
            end: [0.9450636942675159, -3.1329617834394905],
            times: &[],
        },
        Reference {
            impacts: 1,
            cost: 0.0363202329902536,
            costate: [0.3033953192290383, 0.0865569890336508],
            end: [1.0072842268472524, -2.4279863594486907],
            times: &[2.0075197103542744],
        },
        Reference {
            impacts: 2,
            cost: 1.3016062628651303,
            costate: [2.0192427649036086, 0.8359644832488176],
            end: [0.9107402307191314, 2.2645669951979243],
            times: &[1.9098725167402616, 4.359537260708189],
        },
    ];
    assert_found(&extremals, &references);
}

#[test]
fn the_extremals_of_a_ball_with_a_fixed_end_are_the_references() {
    let line = "controlled_ball --initial x=1 --end x=1,y=0";
    let elastic = extremals_on("", &format!("{line} --impacts 0..1"));
    let reference = |impacts, cost, costate, times| Reference {
        impacts,
        cost,
        costate,
        end: [1.0, 0.0],
        times,
    };
    let references = [
        reference(0, 10.0, [0.0, -2.0], &[]),
        reference(
            1,
            3.466699139518846,
            [-1.5910544673048883, -2.2267878888070656],
            &[2.79128784747792],
        ),
        reference(
            1,
            3.466699139518846,
            [-1.611305029798731, -1.7732121111929344],
            &[2.20871215252208],
        ),
        reference(1, 3.468, [-1.632, -2.04], &[2.5]),
    ];
    assert_found(&elastic, &references);
    assert_eq!(elastic.len(), 4);
    // Between two minima that are mirror images in time lies an extremal that is not a minimum.
    let symmetric = elastic
        .iter()
        .find(|it| (number(&it["cost"]) - 3.468).abs() < 1e-9);
    assert_eq!(verdict(symmetric.unwrap()), "fails");
    let minima = elastic.iter().filter(|it| verdict(it) == "minimum");
    assert_eq!(minima.count(), 3);

    let lossy = extremals_on("", &format!("{line} --impacts 1 --set e=0.8"));
    let references = [
        reference(
            1,
            3.5840520919982643,
            [-2.045096165648918, -2.3603703840088969],
            &[2.6850457622337503],
        ),
        reference(
            1,
            3.5857331597731605,
            [-2.1210185139506654, -1.981285564026453],
            &[2.227521910019629],
        ),
    ];
    assert_found(&lossy, &references);
    assert!(lossy.iter().all(|it| count(it) == 1));
}

/// Without an input the ball has two impacts. Small costates do not change this number, so the search must go on to large
/// costates. The cost of holding the ball is `T (m g)^2/2`. The cost with one impact grows as the restitution decreases.
#[test]
fn motions_with_fewer_impacts_than_without_an_input_are_found() {
    let mut last = 3.466699139518846;
    for e in ["0.95", "0.9", "0.89", "0.85"] {
        let line = format!("controlled_ball --initial x=1 --end x=1,y=0 --set e={e}");
        let found = extremals_on("", &format!("{line} --impacts 0..1"));
        let (held, struck): (Vec<&Value>, Vec<&Value>) =
            found.iter().partition(|it| count(it) == 0);
        assert_eq!(held.len(), 1, "e = {e}");
        assert_near(number(&held[0]["cost"]), 10.0, 1e-12);
        let cheapest = number(&struck[0]["cost"]);
        assert!(
            last < cheapest && cheapest < 3.5840520919982643,
            "e = {e}: {cheapest}"
        );
        last = cheapest;
    }
}

/// The costate of the velocity is `m` times that of the momentum.
#[test]
fn a_lagrangian_and_a_field_have_the_same_extremals() {
    let found = extremals_on(BALL, "- --impacts 1");
    assert_eq!(found.len(), 1);
    assert_near(number(&found[0]["cost"]), 1.9530584410888775, 1e-10);
    let costate = &found[0]["start"]["costate"];
    assert_near(number(&costate["x"]), -4.400027296542856, 1e-9);
    assert_near(number(&costate["x_dot"]), 2.0 * -0.5648549392476628, 1e-9);
    let end = &found[0]["end"]["state"];
    assert_near(number(&end["x_dot"]), -2.5084375053044895 / 2.0, 1e-9);
}

#[test]
fn coupled_masses_take_the_cubic() {
    let line = "- --end x=1,y=-2,x_dot=0,y_dot=0 --starts 8";
    let found = extremals_on(MASSES, line);
    assert_eq!(found.len(), 1);
    // M d = (2 - 2, 1 - 6), T = 2.
    assert_near(number(&found[0]["cost"]), 6.0 * 25.0 / 8.0, 1e-11);
    let inputs = &found[0]["start"]["inputs"];
    assert_near(number(&inputs["u"]), 0.0, 1e-11);
    assert_near(number(&inputs["w"]), 6.0 * -5.0 / 4.0, 1e-11);
    assert_eq!(verdict(&found[0]), "minimum");
}

#[test]
fn an_impact_on_a_wall_is_a_motion_to_the_mirror_image() {
    let line = "- --end x=1,y=1,x_dot=0,y_dot=0 --impacts 0..1 --starts 40";
    let found = extremals_on(MIRROR, line);
    let cost = |impacts: usize| {
        let mut with = found.iter().filter(|it| count(it) == impacts);
        let cost = number(&with.next().unwrap()["cost"]);
        assert!(with.next().is_none(), "{impacts} impacts twice");
        cost
    };
    assert_near(cost(0), 6.0 * 1.0 / 8.0, 1e-11);
    // From (0, 1) to (1, -1).
    assert_near(cost(1), 6.0 * (1.0 + 4.0) / 8.0, 1e-11);
}

/// In a frame that moves with the wall, the wall is at rest: the inputs and the cost are the same.
#[test]
fn a_wall_that_moves_is_a_wall_at_rest_for_its_passenger() {
    let document = |line: &str| {
        let done = run_on(
            MIRROR,
            &format!("control - {line} --impacts 1 --starts 40 --json -"),
        );
        let document: Value = serde_json::from_str(&done.output).unwrap();
        document["extremals"].as_array().unwrap().clone()
    };
    let still = document("--end x=1,y=1,x_dot=0,y_dot=0");
    let moving = document("--set c=0.25 --initial y_dot=0.25 --end x=1,y=1.5,x_dot=0,y_dot=0.25");
    assert_eq!([still.len(), moving.len()], [1, 1]);
    for key in ["cost", "terminal"] {
        assert_near(number(&moving[0][key]), number(&still[0][key]), 1e-10);
    }
    let costates = |extremal: &Value, end: &str| {
        let costate = extremal[end]["costate"].as_object().unwrap().clone();
        costate.values().map(number).collect::<Vec<f64>>()
    };
    for end in ["start", "end"] {
        let pairs = costates(&still[0], end)
            .into_iter()
            .zip(costates(&moving[0], end));
        pairs.for_each(|(still, moving)| assert_near(moving, still, 1e-9));
    }
    let time = |extremal: &Value| number(&extremal["impacts"][0]["t"]);
    assert_near(time(&moving[0]), time(&still[0]), 1e-10);
}

/// The cost of `x = cos(t) + b sin(t)` is the change of `x x'/2` between its ends.
#[test]
fn an_extremal_behind_its_conjugate_point_fails() {
    for (time, expected) in [(3.0_f64, "minimum"), (4.0, "fails")] {
        let found = extremals_on(SPRING, &format!("- --until {time} --end x=2"));
        assert_eq!(found.len(), 1, "{time}");
        let b = (2.0 - time.cos()) / time.sin();
        let rate = -time.sin() + b * time.cos();
        assert_near(number(&found[0]["cost"]), (2.0 * rate - b) / 2.0, 1e-10);
        assert_near(number(&found[0]["start"]["costate"]["x"]), -b, 1e-10);
        assert_eq!(verdict(&found[0]), expected, "{time}");
        assert_eq!(
            found[0]["second_order"]["t"].is_null(),
            expected == "minimum"
        );
    }
}

/// The costate at the start is the derivative of the least cost with respect to the start.
#[test]
fn the_costate_is_the_gradient_of_the_cost() {
    let solved = |x: f64, y: f64| {
        let line = format!("controlled_ball --initial x={x},y={y} --impacts 1 --starts 24");
        let found = extremals_on("", &line);
        assert_eq!(found.len(), 1);
        found[0].clone()
    };
    let cost = |x, y| number(&solved(x, y)["cost"]);
    let costate = solved(0.5, 0.0)["start"]["costate"].clone();
    let step = 2e-3;
    let slope = |along: &dyn Fn(f64) -> f64| {
        let central = |h: f64| (along(h) - along(-h)) / (2.0 * h);
        // Extrapolation from two steps makes the error of fourth order.
        (4.0 * central(step / 2.0) - central(step)) / 3.0
    };
    let slopes = [slope(&|h| cost(0.5 + h, 0.0)), slope(&|h| cost(0.5, h))];
    for (name, slope) in ["x", "y"].iter().zip(slopes) {
        let costate = number(&costate[name]);
        assert_near(slope, costate, 1e-8 * costate.abs().max(1.0));
    }
}

/// With the inputs of the table, linear in time between rows, the ball reaches the end of the extremal.
#[test]
fn the_table_of_inputs_reaches_the_end() {
    let done = run_on(
        "",
        "control controlled_ball --impacts 1 --starts 24 --inputs - --samples 26",
    );
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let mut lines = done.output.lines();
    assert_eq!(
        lines.next(),
        Some("t,x,y,costate_x,costate_y,cost,u,hamiltonian")
    );
    let row = |line: &str| {
        line.split(',')
            .map(|it| it.parse().unwrap())
            .collect::<Vec<f64>>()
    };
    let rows: Vec<Vec<f64>> = lines.map(row).collect();
    assert_eq!(rows.len(), 28, "26 times and both sides of an impact");
    let (mut x, mut y, mut cost) = (0.5, 0.0, 0.0);
    for pair in rows.windows(2) {
        let [from, to] = [&pair[0], &pair[1]];
        let step = to[0] - from[0];
        if step == 0.0 {
            assert_near(x, 0.0, 1e-12);
            y = -y;
            continue;
        }
        // m = 2, g = 1: y' = u - 2, x' = y/2.
        let (u, slope) = (from[6], (to[6] - from[6]) / step);
        x += (y * step + (u - 2.0) * step.powi(2) / 2.0 + slope * step.powi(3) / 6.0) / 2.0;
        y += (u - 2.0) * step + slope * step.powi(2) / 2.0;
        cost +=
            (u * u * step + u * slope * step.powi(2) + slope.powi(2) * step.powi(3) / 3.0) / 2.0;
        assert_near(cost, to[5], 1e-12);
    }
    assert_near(x, 0.9613233606479138, 1e-9);
    assert_near(y, -2.5084375053044895, 1e-9);
    assert_near(cost + 10.0 * (x - 1.0).powi(2), 1.9530584410888775, 1e-9);
}

#[test]
fn tables_and_pictures_are_written() {
    let done = run_on(
        "",
        "control controlled_ball --impacts 2 --starts 24 --csv -",
    );
    let lines: Vec<&str> = done.output.lines().collect();
    assert_eq!(lines.len(), 2, "{}", done.output);
    let header = "impacts,cost,terminal,costate.x,costate.y,end.x,end.y,end.costate.x,end.costate.y,hamiltonian,residual,second_order,times,surfaces";
    assert_eq!(lines[0], header);
    assert!(
        lines[1].starts_with("2,0.2105697850") && lines[1].ends_with("floor floor"),
        "{}",
        lines[1]
    );
    let path = std::env::temp_dir().join(format!("dalembert-control-{}.svg", std::process::id()));
    let line = format!(
        "control controlled_ball --impacts 2 --starts 24 --plot {}",
        path.display()
    );
    let done = run_on("", &line);
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    assert!(done.output.contains("second    minimum"), "{}", done.output);
    let svg = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert!(svg.contains("controlled_ball") && svg.contains("2 impacts"));
}

#[test]
fn linear_equations_with_a_quadratic_cost_have_one_extremal() {
    for time in [1e-6, 1e-3, 0.1, 1.0, 5.0] {
        for a in [-2.0_f64, 0.5, 1.0] {
            let found = extremals_on(SCALAR, &format!("- --set a={a} --until {time}"));
            assert_eq!(found.len(), 1, "a = {a}, t = {time}");
            let w = a.hypot(1.0);
            let p = (w * time).tanh() / (w - a * (w * time).tanh());
            assert_near(number(&found[0]["cost"]), p / 2.0, 1e-10 * p);
            assert_near(number(&found[0]["start"]["costate"]["x"]), p, 1e-10 * p);
        }
        let found = extremals_on(CART, &format!("- --until {time}"));
        assert_eq!(found.len(), 1, "t = {time}");
    }
    // Rounding of the costate grows by exp(20 sqrt(2)) for the first, and by exp(20/sqrt(2)) for the second.
    let far = run_on(SCALAR, "control - --until 20");
    assert!(far.output.contains("no extremal") && far.output.contains("use a shorter --until"));
    assert_eq!(extremals_on(CART, "- --until 20").len(), 1);
}

#[test]
fn nothing_found_is_no_error() {
    let done = run_on("", "control controlled_ball --impacts 7 --starts 4");
    assert_eq!(done.exit, Exit::Other, "{}", done.errors);
    assert!(
        done.output.contains("found       no extremal"),
        "{}",
        done.output
    );
}

#[track_caller]
fn refused(input: &str, line: &str, message: &str) {
    let done = run_on(input, &format!("control {line}"));
    assert_eq!(done.exit, Exit::Refused, "{}", done.output);
    assert!(done.errors.contains(message), "{}", done.errors);
}

#[test]
fn requests_without_an_answer_are_refused() {
    refused("", "bouncing_ball", "`BouncingBall` declares no `cost`");
    refused("", "tent_map", "a model with modes has no `cost`");
    refused(
        "",
        "controlled_ball --initial x=-1",
        "--initial: the state lies behind `floor`: its gap is -1",
    );
    refused(
        "",
        "controlled_ball --end x=-1,y=0",
        "--end: the state lies behind `floor`",
    );
    refused("", "controlled_ball --end z=1", "unknown component `z`");
    refused("", "controlled_ball --end x=1,x=2", "every component once");
    refused("", "controlled_ball --impacts 2..1", "--impacts");
    refused(MASSES, "- --impacts 1", "the model has no impact surfaces");
    refused(SPRING, "-", "--until is needed");
    refused(WEIGHTED, "- --set k=-1", "no least value at the start");
    let bounded = BALL.replace("inputs { u; }", "inputs { u in [-1, 1]; }");
    refused(&bounded, "-", "bounds on inputs are not supported");
    let plastic = BALL.replace("newton(e)", "impact_plastic");
    refused(&plastic, "-", "the law of `floor` is not invertible");
    refused(
        "",
        "controlled_ball --csv a.csv --inputs a.csv",
        "need different files",
    );
}

#[test]
fn the_second_derivative_of_the_running_cost_has_to_be_positive() {
    refused(WEIGHTED, "- --set k=-2", "no least value at the start");
    let found = extremals_on(WEIGHTED, "-");
    // u = -p/2, p = 2 x(1): x(1) = 1/2, cost 1/4 + 1/4.
    assert_near(number(&found[0]["cost"]), 0.5, 1e-12);
}

/// A motion crosses the surface of a reset that changes nothing: it costs what it costs without the surface, and both
/// sides are allowed.
#[test]
fn the_surface_of_a_reset_is_no_wall() {
    const CROSSED: &str = "
        Crossed {
            coordinates { x; v; }
            inputs { u; }
            cost { running = u^2/2; terminal = 5*(x - 2)^2; }
            field { dot(x) = v; dot(v) = u; }
            impacts { gate: x <= 1 => reset { }; }
            initial { x = 0; until = 2; }
        }";
    let document = |line: &str| -> Value {
        let done = run_on(CROSSED, &format!("control - {line} --json -"));
        assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
        serde_json::from_str(&done.output).unwrap()
    };
    // From (x, v) the least cost over the time 2 is 5 (2 - x - 2 v)^2/(1 + 80/3).
    let least = |x: f64| 5.0 * (2.0 - x).powi(2) / (1.0 + 80.0 / 3.0);
    for (start, impacts) in [(0.0, 1), (1.5, 0)] {
        let found = document(&format!("--impacts 0..1 --initial x={start}"));
        let extremal = &found["extremals"][0];
        let cost = extremal["cost"].as_f64().unwrap();
        assert!((cost - least(start)).abs() < 1e-10, "{cost} from {start}");
        assert_eq!(
            extremal["impacts"].as_array().map(Vec::len),
            Some(impacts),
            "{extremal}"
        );
    }
}
