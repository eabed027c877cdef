//! `control --dp`: closed forms, costs of extremals, threads, tables, and requests that are refused.

// A test may fail by panicking.
#![allow(clippy::unwrap_used)]

mod support;

use dalembert_cli::Exit;
use serde_json::Value;
use support::run_on;

/// The grid of the ball.
const GRID: &str = "--dp x=0..3:61,y=-6..6:61,u=-4..4:17";

/// A cart with a force whose cost may grow with time. From rest at 0 the least cost is `a/(1 + 2 a I)`, with
/// `I` the integral of `(T - t)^2/(1 + c t)`.
const CART: &str = "
    Cart {
        coordinates { x; }
        parameters { a = 2; c = 0; }
        inputs { u; }
        cost { running = WEIGHT*u^2/2; terminal = a*(x - 1)^2; }
        lagrangian = dot(x)^2/2;
        forces { push: u*d(x); }
        initial { until = 1; }
    }";

/// A state of two components that are not a position and its velocity, and two inputs.
const PLANE: &str = "
    Plane {
        coordinates { x; y; }
        inputs { u; w; }
        cost { running = (u^2 + w^2)/2; terminal = x^2 + y^2; }
        field { dot(x) = u; dot(y) = w; }
        initial { until = 1; }
    }";

fn document_on(input: &str, line: &str) -> Value {
    let done = run_on(input, &format!("control {line} --json -"));
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    serde_json::from_str(&done.output).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The cost of the path and the cost by the grid for a cart, with `5*fineness` intervals along each axis and in time.
fn cart(input: &str, fineness: usize, more: &str) -> [f64; 2] {
    let nodes = 5 * fineness + 1;
    let line = format!(
        "- --dp x=-0.5..1.5:{nodes},x_dot=-1..2:{nodes},u=-1..5:{nodes} --steps {} {more}",
        5 * fineness
    );
    let path = &document_on(input, &line)["paths"][0];
    [number(&path["cost"]), number(&path["by_grid"])]
}

#[test]
fn a_cart_has_the_cost_of_its_closed_form_to_second_order() {
    let input = CART.replace("WEIGHT", "1");
    let least = 2.0 / (1.0 + 4.0 / 3.0);
    let errors = [4, 8].map(|fineness| cart(&input, fineness, "").map(|cost| cost - least));
    for [of_path, by_grid] in errors {
        // A path is a motion, so its cost is not below the least cost.
        assert!(of_path > 0.0, "{errors:?}");
        assert!((of_path - by_grid).abs() < 1e-4, "{errors:?}");
    }
    let order = (errors[0][0] / errors[1][0]).log2();
    assert!((1.8..2.3).contains(&order), "{order}: {errors:?}");
    assert!(errors[1][0] < 1e-3, "{errors:?}");
}

#[test]
fn a_cost_that_grows_with_time_has_its_closed_form() {
    let input = CART.replace("WEIGHT", "(1 + c*t)");
    let integral = 4.0 * 2.0_f64.ln() - 2.5;
    let least = 2.0 / (1.0 + 4.0 * integral);
    let [of_path, by_grid] = cart(&input, 6, "--set c=1");
    assert!((of_path - least).abs() < 1e-3, "{of_path} and {least}");
    assert!((by_grid - least).abs() < 1e-3, "{by_grid} and {least}");
}

/// A double integrator on a grid that its motions must not leave, with inputs from -8 to 8.
const SLIDER: &str = "
    Slider {
        coordinates { x; v; }
        inputs { u; }
        cost { running = u^2/2; terminal = 5*(x - 1)^2; }
        field { dot(x) = v; dot(v) = u; }
        initial { until = 1; }
    }";

/// A motion stays on the grid if it can stop in time: `x + v^2/16 <= 2` if it rises, `x - v^2/16 >= -1` if it falls.
/// On the whole plane the least cost is `5 (x + v - 1)^2/(1 + 10/3)`.
#[test]
fn nodes_have_a_cost_where_a_motion_can_stay_and_none_is_too_low() {
    let lowest = [41, 81].map(|count| {
        let line = format!(
            "- --dp x=-1..2:{count},v=-2..3:{count},u=-8..8:17 --steps {} --initial x=0,v=0",
            5 * (count - 1) / 4
        );
        let mut lowest: f64 = 0.0;
        for node in document_on(SLIDER, &line)["nodes"].as_array().unwrap() {
            let [x, v] = [0, 1].map(|index| number(&node[index]));
            let brake = v * v.abs() / 16.0;
            let room = (2.0 - x - brake.max(0.0)).min(x + 1.0 + brake.min(0.0));
            // Nodes closer to the boundary than a twentieth of the step along x may be wrong.
            if room.abs() > 0.05 * 3.0 / f64::from(count - 1) {
                assert_eq!(node[2].is_number(), room > 0.0, "{x} {v}: {node}");
            }
            if let Some(cost) = node[2].as_f64() {
                let free = 5.0 * (x + v - 1.0).powi(2) / (1.0 + 10.0 / 3.0);
                lowest = lowest.min(cost - free);
            }
        }
        lowest
    });
    assert!(
        lowest[0] > -0.2 && lowest[1] > 0.6 * lowest[0],
        "{lowest:?}"
    );
}

/// The references are the costs that `control` finds: 0.2105697850 from x = 0.5 with two impacts, and 0.0363202330 from
/// x = 2 with one impact.
#[test]
fn a_ball_takes_the_impacts_that_are_cheapest() {
    let line = format!("controlled_ball {GRID} --path x=0.5 --path x=2 --impacts 0..2");
    let document = document_on("", &line);
    let references = [(0.2105697850481026, 2, 0.01), (0.0363202329902536, 1, 2e-3)];
    for (path, (least, impacts, within)) in
        document["paths"].as_array().unwrap().iter().zip(references)
    {
        assert_eq!(path["impacts"].as_array().unwrap().len(), impacts);
        let more = number(&path["cost"]) - least;
        assert!((0.0..within).contains(&more), "{more}");
        assert!((number(&path["by_grid"]) - least).abs() < 1.2 * within);
        assert!((number(&path["extremal"]["cost"]) - least).abs() < 1e-9);
        assert_eq!(path["extremal"]["impacts"], impacts);
    }
    let nodes = document["nodes"].as_array().unwrap();
    assert_eq!(nodes.len(), 61 * 61);
    let at = |x: usize, y: usize| nodes[x * 61 + y].as_array().unwrap().clone();
    // The node x = 2, y = 0 has the cost and the impacts of the second path. A ball that starts high and rises fast
    // leaves the grid with every input.
    assert!((number(&at(40, 30)[2]) - 0.0363).abs() < 3e-3);
    assert!((number(&at(40, 30)[4]) - 1.0).abs() < 0.1);
    assert!(at(59, 59)[2].is_null() && at(59, 59)[3].is_null());
}

#[test]
fn threads_change_nothing() {
    let text = |threads: usize| {
        let line = format!(
            "control controlled_ball --dp x=0..3:21,y=-6..6:21,u=-4..4:9 --steps 20 --threads {threads} --csv -"
        );
        run_on("", &line).output
    };
    let one = text(1);
    assert_eq!(one.lines().count(), 21 * 21 + 1);
    assert_eq!(one.lines().next(), Some("x,y,cost,u,impacts"));
    assert_eq!(one, text(2));
    assert_eq!(one, text(3));
}

#[test]
fn the_table_of_a_path_reaches_its_end() {
    let folder = std::env::temp_dir().join(format!("dalembert-dp-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let table = folder.join("inputs.csv");
    let coarse = "--dp x=0..3:31,y=-6..6:31,u=-4..4:9 --steps 50";
    let line = format!(
        "controlled_ball {coarse} --inputs {} --plot {}",
        table.display(),
        folder.join("map.svg").display()
    );
    let path = document_on("", &line)["paths"][0].clone();
    let line = format!(
        "simulate controlled_ball --until 5 --inputs {} --csv - --samples 2",
        table.display()
    );
    let done = run_on("", &line);
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let mut lines = done.output.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let last: Vec<&str> = lines.next_back().unwrap().split(',').collect();
    let svg = std::fs::read_to_string(folder.join("map.svg")).unwrap();
    assert!(svg.contains("least cost") && svg.contains("path of least cost"));
    std::fs::remove_dir_all(&folder).unwrap();
    for name in ["x", "y"] {
        let end = number(&path["end"][name]);
        let column = header.iter().position(|it| *it == name).unwrap();
        let reached: f64 = last[column].parse().unwrap();
        assert!((end - reached).abs() < 1e-8, "{name}: {end} and {reached}");
    }
}

#[test]
fn a_start_off_the_grid_is_said() {
    let line =
        "control controlled_ball --dp x=0..3:11,y=-6..6:11,u=-4..4:5 --steps 10 --initial x=4";
    let done = run_on("", line);
    assert_eq!(done.exit, Exit::Other, "{}", done.errors);
    let expected = "no motion from its start stays on the grid";
    assert!(done.output.contains(expected), "{}", done.output);
}

#[track_caller]
fn refused(input: &str, line: &str, message: &str) {
    let done = run_on(input, &format!("control {line}"));
    assert_eq!(done.exit, Exit::Refused, "{}", done.output);
    assert!(done.errors.contains(message), "{}", done.errors);
}

#[test]
fn requests_without_a_grid_are_refused() {
    let ball = |dp: &str| format!("controlled_ball --dp {dp}");
    refused(
        "",
        "bouncing_ball --dp x=0..1:3",
        "`BouncingBall` declares no `cost`",
    );
    refused(
        "",
        "tent_map --dp x=0..1:3",
        "a model with modes has no `cost`",
    );
    refused(
        PLANE,
        "- --dp x=0..1:3",
        "has 2 inputs, and a grid is for one",
    );
    let more = CART
        .replace("WEIGHT", "1")
        .replace("coordinates { x; }", "coordinates { x; z; }");
    let more = more.replace("= dot(x)^2/2", "= (dot(x)^2 + dot(z)^2)/2");
    refused(
        &more,
        "- --dp x=0..1:3",
        "has 4 components, and a grid is for two",
    );
    refused("", &ball("x=0..3:5,y=-1..1:5"), "there is no axis for `u`");
    refused(
        "",
        &ball("x=0..3:5,z=-1..1:5"),
        "unknown component or input `z`",
    );
    refused("", &ball("x=0..3:5,x=0..3:5"), "every name once");
    refused("", &ball("x=0..3"), "A..B:COUNT, such as 0..3:61");
    refused("", &ball("x=0..3:1"), "a count from 2 to 4000");
    refused("", &ball("x=3..0:5"), "A..B with A below B");
    let large = ball("x=0..3:4000,y=-1..1:4000,u=0..1:2");
    refused("", &large, "nodes times inputs");
    let grid = ball("x=0..3:5,y=-1..1:5,u=0..1:3");
    refused("", &format!("{grid} --steps 100000000"), "--steps");
    refused("", &format!("{grid} --at 6"), "a time from 0 to 5");
    refused("", &format!("{grid} --path z=1"), "unknown component `z`");
    refused(
        "",
        &format!("{grid} --plot no.svg --axes t,energy"),
        "unknown quantity `energy`",
    );
    refused("", &format!("{grid} --set m=-1"), "m");
}

/// The surface of a reset that changes nothing is no wall: costs are those without it, and none is negative. No node of the grid
/// is on the surface: a motion from rest there would meet it or not by the sign of the input, so that the best input is one of
/// the grid.
#[test]
fn the_surface_of_a_reset_is_crossed() {
    let crossed = |impacts: &str| {
        format!(
            "Crossed {{
                coordinates {{ x; v; }}
                inputs {{ u; }}
                cost {{ running = u^2/2; terminal = 5*(x - 2)^2; }}
                field {{ dot(x) = v; dot(v) = u; }}
                {impacts}
                initial {{ x = 0; until = 2; }}
            }}"
        )
    };
    let table = |input: &str| -> Vec<Vec<String>> {
        let line = "control - --dp x=-1..3:21,v=-3..3:21,u=-2..2:9 --steps 20 --csv -";
        let done = run_on(input, line);
        assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
        let lines = done.output.lines().skip(1);
        lines
            .map(|line| line.split(',').map(str::to_owned).collect())
            .collect()
    };
    let (free, gate) = (
        table(&crossed("")),
        table(&crossed("impacts { gate: x <= 1.05 => reset { }; }")),
    );
    assert_eq!(free.len(), gate.len());
    let mut compared = 0;
    for (free, gate) in free.iter().zip(&gate) {
        assert_eq!(free[2].is_empty(), gate[2].is_empty(), "{free:?} {gate:?}");
        if let (Ok(free), Ok(gate)) = (free[2].parse::<f64>(), gate[2].parse::<f64>()) {
            assert!(gate > -1e-6 && (free - gate).abs() < 1e-9, "{free} {gate}");
            compared += 1;
        }
    }
    assert!(compared > 300, "{compared}");
}
