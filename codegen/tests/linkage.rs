//! Kinetic energies whose velocities follow from one another: every function agrees with the one that factorises the metric, and
//! the operations grow with the number of links.

use dalembert_codegen::mechanics;
use dalembert_codegen::model::{self, Model};
use dalembert_codegen::program::{self, Function, Input, Program, interpret::interpret};
use dalembert_codegen::spec;

/// Rods whose angles are absolute.
fn absolute(links: usize, more: &str) -> String {
    format!(
        "Chain {{ const N = {links}; coordinates {{ theta[N]: angle; }}
        parameters {{ m > 0 = 1; l > 0 = 1; g = 9.81; }}
        let X[0] = 0; let X[i in 1..=N] = X[i-1] + l*sin(theta[i]);
        let Y[0] = 0; let Y[i in 1..=N] = Y[i-1] - l*cos(theta[i]);
        lagrangian = sum(i in 1..=N: m/2*(dot(X[i])^2 + dot(Y[i])^2) - m*g*Y[i]); {more} }}"
    )
}

/// Bodies with a moment of inertia, whose joints measure angles from the body before.
fn joints(links: usize, more: &str) -> String {
    format!(
        "Arm {{ const N = {links}; coordinates {{ q[N]: angle; }}
        parameters {{ m > 0 = 1.3; J > 0 = 0.2; l > 0 = 0.7; g = 9.81; }}
        let A[0] = 0; let A[i in 1..=N] = A[i-1] + q[i];
        let X[0] = 0; let X[i in 1..=N] = X[i-1] + l*sin(A[i]);
        let Y[0] = 0; let Y[i in 1..=N] = Y[i-1] - l*cos(A[i]);
        lagrangian = sum(i in 1..=N: m/2*(dot(X[i])^2 + dot(Y[i])^2) + J/2*dot(A[i])^2 - m*g*Y[i]); {more} }}"
    )
}

/// A cart with two arms, a mass that depends on its place, springs between the rods and a magnetic term.
const TREE: &str = "Tree { const N = 7; coordinates { s; a[N]: angle; b[N]: angle; }
    parameters { m > 0 = 1.1; M > 0 = 2; l > 0 = 0.9; k = 0.4; g = 9.81; }
    let X[0] = s; let X[i in 1..=N] = X[i-1] + l*sin(a[i]);
    let Y[0] = 0; let Y[i in 1..=N] = Y[i-1] - l*cos(a[i]);
    let U[0] = s; let U[i in 1..=N] = U[i-1] + l*sin(b[i]);
    let V[0] = 0; let V[i in 1..=N] = V[i-1] - l*cos(b[i]);
    lagrangian = M*(2 + sin(s))/2*dot(s)^2 + sum(i in 1..=N: m/2*(dot(X[i])^2 + dot(Y[i])^2) - m*g*Y[i])
        + sum(i in 1..=N: m*(1 + t^2)/2*(dot(U[i])^2 + dot(V[i])^2) - m*g*V[i]) + k*s^2*dot(a[1]);
    forces { drag: -k*dot(s)*d(s) - k*dot(b[2])*d(b[2]); }
    impacts { wall: 40 + X[N] + Y[N]/3 >= 0; } }";

fn checked(text: &str) -> Model {
    let spec = spec::parse(text.parse().expect("tokens")).expect("a declaration");
    model::check(&spec).unwrap_or_else(|error| panic!("{error:?}"))
}

/// The program along the linkage, and the one that factorises the metric.
fn both(text: &str) -> (Program, Program) {
    let mut model = checked(text);
    let mut derivation = mechanics::derive(&mut model);
    assert!(derivation.linkage.is_some(), "no linkage: {text}");
    let linked = program::lower(&model, &derivation, None).main;
    derivation.linkage = None;
    (linked, program::lower(&model, &derivation, None).main)
}

/// A number in `[-1, 1)` for an argument.
fn sampled(input: Input, seed: u64) -> f64 {
    let mut state = seed ^ 0x9e37_79b9_7f4a_7c15;
    for byte in format!("{input:?}").bytes() {
        state = (state ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
    state ^= state >> 29;
    state = state.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// The largest difference of the results, relative to the largest of them. Velocities that a function takes as arguments are those
/// of the momenta.
fn difference(ours: &Function, theirs: &Function, seed: u64, velocity: &Function) -> f64 {
    let plain = |input| match input {
        Input::Parameter(_) => 1.5 + sampled(input, seed) / 2.0,
        _ => sampled(input, seed),
    };
    let velocities = interpret(velocity, &plain).expect("regular");
    let input = |input| match input {
        Input::Velocity(i) => velocities[i],
        _ => plain(input),
    };
    let ours = interpret(ours, &input).expect("regular");
    let theirs = interpret(theirs, &input).expect("regular");
    assert_eq!(ours.len(), theirs.len());
    let size = theirs
        .iter()
        .fold(1.0, |size: f64, value| size.max(value.abs()));
    let pairs = ours.iter().zip(&theirs);
    pairs.fold(0.0, |worst: f64, (a, b)| {
        assert!(a.is_finite() && b.is_finite());
        worst.max((a - b).abs() / size)
    })
}

fn agrees(text: &str) {
    let (linked, dense) = both(text);
    for ((name, ours), (_, theirs)) in linked.kernels().iter().zip(dense.kernels()) {
        for seed in 0..20 {
            let worst = difference(ours, theirs, seed, &dense.velocity);
            assert!(worst < 2e-12, "{name:?}: {worst:e}");
        }
    }
    for seed in 0..20 {
        let worst = difference(&linked.momentum, &dense.momentum, seed, &dense.velocity);
        assert!(worst < 2e-12, "momentum: {worst:e}");
    }
}

#[test]
fn chains_agree_with_the_metric() {
    agrees(&absolute(
        9,
        "impacts { wall: 3 - X[N] >= 0; floor: 20 + Y[4] >= 0; }",
    ));
    agrees(&joints(
        9,
        "impacts { wall: 3 - X[N] >= 0; floor: 20 + Y[4] >= 0; }",
    ));
}

#[test]
fn a_tree_agrees_with_the_metric() {
    agrees(TREE);
}

/// The sum of the angles is defined by a velocity whose coefficients change, which has no position.
const MIXED: &str = "Mixed { const N = 9; coordinates { q[N]: angle; } parameters { m > 0 = 1; l > 0 = 0.8; g = 9.81; }
    let X[0] = 0; let X[i in 1..=N] = X[i-1] + l*sin(q[i]);
    let Y[0] = 0; let Y[i in 1..=N] = Y[i-1] - l*cos(q[i]);
    let Z = sum(i in 1..=N: q[i]);
    lagrangian = sum(i in 1..=N: m/2*(dot(X[i])^2 + dot(Y[i])^2)) + m/2*(dot(Z) + dot(q[1])*cos(q[2]))^2 + m/2*dot(Z)^2
        + m*g*cos(Z); }";

#[test]
fn velocities_that_follow_from_others_without_positions_agree_with_the_metric() {
    agrees(MIXED);
}

/// Operations of the rate.
fn rate(text: &str) -> usize {
    let mut model = checked(text);
    let derivation = mechanics::derive(&mut model);
    program::lower(&model, &derivation, None)
        .main
        .rate
        .cost
        .total()
}

#[test]
fn operations_grow_with_the_number_of_links() {
    for (chain, at_most) in [(absolute as fn(usize, &str) -> String, 53), (joints, 73)] {
        let [short, long] = [16, 32].map(|links| rate(&chain(links, "")));
        assert!(long - short <= 16 * at_most, "{short} {long}");
    }
}

/// Short chains, sparse metrics, energies that are no sums of squares, and systems whose rates are enclosed along each step keep
/// the factorisation of the metric.
#[test]
fn the_metric_is_factorised_where_that_is_shorter() {
    let products = "Pair { const N = 6; coordinates { x[N]; } parameters { m > 0 = 1; k = 0.1; }
        lagrangian = sum(i in 1..=N: m/2*dot(x[i])^2) + k*sum(i in 2..=N: dot(x[i-1])*dot(x[i])); }";
    let places =
        "Places { const N = 8; coordinates { x[N]; y[N]; } parameters { m > 0 = 1; g = 9.81; }
        lagrangian = sum(i in 1..=N: m/2*(dot(x[i])^2 + dot(y[i])^2) - m*g*y[i]); }";
    let root = absolute(8, "forces { spring: -sqrt(1 + X[2]^2)*d(theta[2]); }");
    for text in [&absolute(4, ""), products, places, &root] {
        assert!(
            mechanics::derive(&mut checked(text)).linkage.is_none(),
            "{text}"
        );
    }
}
