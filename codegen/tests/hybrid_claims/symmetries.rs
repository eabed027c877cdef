//! Tests of symmetries of motion, surfaces and their maps together, as used for orbits modulo a group; and of
//! symmetries of first-order systems.

use dalembert_codegen::report::{Symmetry, symmetries};

use super::Expected::{False, True};
use super::check;

/// The symmetries in a list of fields with all parameters at 1 (`e` at 1/2), or the error message.
fn found(source: &str, fields: &str) -> Result<Vec<Symmetry>, String> {
    let parameters = [("a", 1.0), ("e", 0.5), ("k", 1.0)];
    symmetries(source, None, fields, &parameters).map_err(|error| error.to_string())
}

#[track_caller]
fn accept(source: &str, fields: &str) -> Vec<Symmetry> {
    found(source, fields).unwrap_or_else(|error| panic!("{error}\n{source}"))
}

#[track_caller]
fn refuse(source: &str, fields: &str, reasons: &[&str]) {
    let error = found(source, fields).expect_err(source);
    for reason in reasons {
        assert!(error.contains(reason), "{reason} is not in {error}");
    }
}

/// A particle above a floor, with further declarations.
fn particle(parts: &str) -> String {
    format!(
        "Particle {{
            coordinates {{ x; y; }}
            parameters {{ a = 1; e in [0, 1] = 1/2; k = 1; }}
            {parts}
        }}"
    )
}

const FREE: &str = "lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;";

#[test]
fn translations_along_a_floor_are_symmetries_with_their_momentum() {
    let text = particle(&format!("{FREE} impacts {{ floor: y >= 0 => newton(e); }}"));
    let [along] = accept(&text, "partial(x)").try_into().expect("one");
    assert_eq!(along.coordinates, ["x", "y"]);
    assert_eq!(
        (along.constant, along.linear),
        (vec![1.0, 0.0], vec![vec![0.0; 2]; 2])
    );
    assert!(along.keeps_momentum && along.parameters.is_empty());
    // A vertical translation changes the Lagrangian by a constant only, but it moves the floor.
    refuse(
        &text,
        "partial(y)",
        &[
            "`partial(y)` is not a proved symmetry: surface `floor`",
            "rate of the gap along its flow = 1",
        ],
    );
    refuse(
        &text,
        "x*partial(x)",
        &[
            "the motion",
            "second derivative of this rate in dot(x) and dot(x) = 2",
        ],
    );
    // An inclined floor.
    let text = particle(&format!(
        "{FREE} impacts {{ floor: y - k*x/1000000000 >= 0 => elastic; }}"
    ));
    refuse(
        &text,
        "partial(x)",
        &[
            "surface `floor`",
            "rate of the gap along its flow = -1.00000000000e-9",
        ],
    );
    accept(&text, "partial(x) + k/1000000000*partial(y)");
}

#[test]
fn coefficients_and_conditions_of_surfaces_are_kept() {
    let floor = |rest: &str| particle(&format!("{FREE} impacts {{ floor: y >= 0 {rest}; }}"));
    accept(&floor("when e > 1/4 => newton(e)"), "partial(x)");
    refuse(
        &floor("when x > 0 => newton(e)"),
        "partial(x)",
        &["surface `floor`", "rate of a condition along its flow = 1"],
    );
    // A flow that moves states, but not across the condition.
    let line = |margin: &str| {
        format!(
            "Line {{ coordinates {{ x; y; }} field {{ dot(x) = 1; dot(y) = 0; }}
                impacts {{ wall: x <= 1 when {margin} > 0 => reset {{ x = 0; }}; }} }}"
        )
    };
    accept(&line("y"), "y*partial(y)");
    refuse(
        &line("y - y^2"),
        "y*partial(y)",
        &["surface `wall`", "may change whether a condition holds"],
    );
}

#[test]
fn forces_are_kept() {
    let with = |force: &str| particle(&format!("{FREE} forces {{ drag: {force}; }}"));
    let [drag] = accept(&with("-k*dot(x)*d(x)"), "partial(x)")
        .try_into()
        .expect("one");
    assert!(!drag.keeps_momentum);
    refuse(
        &with("-k*(1 + x)*dot(x)*d(x)"),
        "partial(x)",
        &["the motion", "its flow changes the forces"],
    );
    let turn = "x*partial(y) - y*partial(x)";
    let round = |force: &str| {
        let lagrangian = "lagrangian = (dot(x)^2 + dot(y)^2)/2 - (x^2 + y^2)^2;";
        particle(&format!("{lagrangian} forces {{ drag: {force}; }}"))
    };
    let [turned] = accept(&round("-k*dot(x)*d(x) - k*dot(y)*d(y)"), turn)
        .try_into()
        .expect("one");
    assert_eq!(turned.linear, [[0.0, -1.0], [1.0, 0.0]]);
    refuse(
        &round("-k*dot(x)*d(x) - 2*k*dot(y)*d(y)"),
        turn,
        &["its flow changes the forces"],
    );
}

#[test]
fn resets_are_kept_with_positions_and_velocities() {
    let reset = |map: &str| {
        particle(&format!(
            "{FREE} impacts {{ floor: y >= 0 => reset {{ {map} }}; }}"
        ))
    };
    accept(
        &reset("x = x + k*dot(y); dot(y) = -e*dot(y); dot(x) = 2*dot(x);"),
        "partial(x)",
    );
    refuse(
        &reset("dot(y) = -e*dot(y); x = 2*x;"),
        "partial(x)",
        &["surface `floor`", "mismatch in x behind it = 1"],
    );
    refuse(
        &reset("dot(y) = -e*dot(y) + x;"),
        "partial(x)",
        &["mismatch in dot(y) behind it = 1"],
    );
    // Multiplying both components by -2 commutes with rotations; multiplying them by -2 and -3 does not.
    let round = |map: &str| {
        let lagrangian = "lagrangian = (dot(x)^2 + dot(y)^2)/2;";
        particle(&format!(
            "{lagrangian} impacts {{ rim: 1 - x^2 - y^2 >= 0 => reset {{ {map} }}; }}"
        ))
    };
    let turn = "x*partial(y) - y*partial(x)";
    accept(&round("dot(x) = -2*dot(x); dot(y) = -2*dot(y);"), turn);
    refuse(
        &round("dot(x) = -2*dot(x); dot(y) = -3*dot(y);"),
        turn,
        &["surface `rim`", "mismatch in dot("],
    );
}

/// A hopper in two modes: in the air, and with its foot on the ground.
const HOPPER: &str = "Hopper {
    parameters { k = 1; }
    coordinates { x; y; }
    modes {
        air { lagrangian = (dot(x)^2 + dot(y)^2)/2 - y; initial { y = 2; } }
        ground {
            coordinates { foot; }
            lagrangian = (dot(x)^2 + dot(y)^2 + dot(foot)^2)/2 - y - k*((x - foot)^2 + (y - 1)^2);
            constraints { stands: d(foot) = 0; }
        }
    }
    transitions {
        down: air -> ground when y <= 1 => reset { foot = FOOT; dot(foot) = 0; };
        up: ground -> air when y >= 1 => reset { };
    }
}";

#[test]
fn modes_take_the_terms_of_their_coordinates() {
    let text = HOPPER.replace("FOOT", "x + k");
    let [along] = accept(&text, "partial(x) + partial(foot)")
        .try_into()
        .expect("one");
    assert_eq!(along.coordinates, ["x", "y", "foot"]);
    assert_eq!(along.constant, [1.0, 0.0, 1.0]);
    refuse(
        &text,
        "partial(x)",
        &[
            "mode `air`, surface `down`",
            "mismatch in foot behind it = 1",
        ],
    );
    refuse(
        &text,
        "partial(foot)",
        &[
            "mode `air`, surface `down`",
            "mismatch in foot behind it = -1",
        ],
    );
    refuse(
        &text,
        "partial(x) + 2*partial(foot)",
        &[
            "mode `air`, surface `down`",
            "mismatch in foot behind it = -1",
        ],
    );
    refuse(
        &text,
        "partial(x) + partial(food)",
        &["`food` is not a coordinate of any mode"],
    );
    let text = HOPPER.replace("FOOT", "2*x");
    refuse(
        &text,
        "partial(x) + partial(foot)",
        &["surface `down`", "mismatch in foot behind it = 1"],
    );
}

#[test]
fn instantaneous_constraints_are_kept() {
    let roller = |psi: &str| {
        format!(
            "Roller {{ coordinates {{ x; y; theta; }} parameters {{ k = 1; }}
            lagrangian = (dot(x)^2 + dot(y)^2 + k*dot(theta)^2)/2;
            impacts {{ wall: x >= 0 => elastic, instantaneous {{ no_slip: {psi}; }}; }} }}"
        )
    };
    let [along, turned] = accept(&roller("dot(y) = dot(theta)"), "partial(y), partial(theta)")
        .try_into()
        .expect("two");
    // The impulse along the wall changes the momentum along it, and the angular momentum.
    assert!(!along.keeps_momentum && !turned.keeps_momentum);
    let [rolled] = accept(
        &roller("dot(y) = dot(theta)"),
        "partial(y) + partial(theta)",
    )
    .try_into()
    .expect("one");
    assert!(rolled.keeps_momentum);
    let belt = roller("dot(y) = dot(theta) + k*y/10^9");
    refuse(
        &belt,
        "partial(y)",
        &["surface `wall`", "instantaneous constraints"],
    );
    accept(&belt, "partial(theta)");
}

/// A disk of another medium, entered and left by refraction.
fn lens(outside: &str, inside: &str, radius: &str) -> String {
    format!(
        "Lens {{ coordinates {{ x; y; }} parameters {{ k = 1; }} let kinetic = (dot(x)^2 + dot(y)^2)/2;
        modes {{ air {{ lagrangian = {outside}; }} glass {{ lagrangian = {inside}; }} }}
        transitions {{ enter: air -> glass when {radius} <= 1; leave: glass -> air when {radius} >= 1; }} }}"
    )
}

#[test]
fn refractions_are_kept_where_both_lagrangians_are() {
    let turn = "x*partial(y) - y*partial(x)";
    let round = lens("kinetic", "2*kinetic + k", "x^2 + y^2");
    let [found] = accept(&round, turn).try_into().expect("one");
    assert!(found.keeps_momentum);
    let oval = lens("kinetic", "2*kinetic + k", "x^2 + (1 + 1/10^9)*y^2");
    refuse(
        &oval,
        turn,
        &["surface `enter`", "rate of the gap along its flow"],
    );
    refuse(
        &round,
        "partial(x)",
        &["surface `enter`", "rate of the gap along its flow"],
    );
    let graded = lens("kinetic", "kinetic + k*x/10^9", "x^2 + y^2");
    refuse(
        &graded,
        turn,
        &["surface `enter`", "one of its Lagrangians changes"],
    );
    // Both Lagrangians are invariant under rotation, the second one only up to a total derivative.
    let charged = lens("kinetic", "2*kinetic + k*x*dot(y)", "x^2 + y^2");
    refuse(
        &charged,
        turn,
        &["surface `enter`", "if only by a total derivative"],
    );
    let charged = lens(
        "kinetic",
        "2*kinetic + k*(x*dot(y) - y*dot(x))",
        "x^2 + y^2",
    );
    accept(&charged, turn);
}

#[test]
fn flows_that_are_not_affine_are_refused() {
    let text = "Curved { coordinates { r; s; } lagrangian = (dot(r)^2 + cosh(r)^2*dot(s)^2)/2; }";
    accept(text, "partial(s)");
    refuse(text, "sin(s)*partial(s)", &["not a proved symmetry"]);
    let text = "Curved { coordinates { r; s; } field { dot(r) = r; dot(s) = 0; } }";
    refuse(
        text,
        "sin(s)*partial(s)",
        &[
            "its flow is not affine in the coordinates",
            "the factor of `partial(s)`",
        ],
    );
}

#[test]
fn symmetries_of_first_order_systems_are_decided() {
    let system = "System {
        coordinates { x; y; }
        parameters { k = 1; }
        field { dot(x) = -k*y + x*(1 - x^2 - y^2); dot(y) = k*x + y*(1 - x^2 - y^2); }
        CLAIM
    }";
    let turn = "symmetry: x*partial(y) - y*partial(x)";
    check(system, turn, True);
    check(system, "symmetry: 3*x*partial(y) - 3*y*partial(x)", True);
    check(
        system,
        "symmetry: partial(x)",
        False("rate of dot(x) along its flow"),
    );
    check(
        system,
        "symmetry: x*partial(y) - 1.000000001*y*partial(x)",
        False("its flow changes the rates"),
    );
    let drift = "Drift { coordinates { x; s; } field { dot(x) = 1 + cos(s); dot(s) = 2; } CLAIM }";
    check(drift, "symmetry: partial(x)", True);
    check(
        drift,
        "symmetry: (1 + cos(s))*partial(x) + 2*partial(s)",
        True,
    );
    check(
        drift,
        "symmetry: x*partial(x)",
        False("rate of dot(x) along its flow"),
    );
    check(
        drift,
        "symmetry: partial(s)",
        False("rate of dot(x) along its flow"),
    );
}
