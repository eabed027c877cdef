//! Independent computation of the numbers in messages about claims, by finite differences along the emitted motion.

use dalembert::law::Law;
use dalembert::math::larger;

use crate::claim::Witness;
use crate::formula::{Scope, definitions, value};
use crate::numeric::{Numeric, Snapshot, moved, slope, slopes};
use crate::obstruction::Criterion;

/// Relative and absolute tolerances. Differences of sixth order with steps of 3/1000 over states of order 1 have errors
/// of about 1e-12. Nested three times, as in brackets, they have errors of about 1e-7.
const ONCE: [f64; 2] = [1e-7, 1e-10];
const NESTED: [f64; 2] = [1e-5, 1e-6];

/// The value of an expression of a claim at a state of a system. In a vector field, `partial` selects the component.
pub fn at(system: &dyn Numeric, text: &str, state: &Snapshot, partial: Option<usize>) -> f64 {
    let coordinates: Vec<&str> = system
        .description()
        .coordinates
        .iter()
        .map(|coordinate| coordinate.name)
        .collect();
    let names = system
        .description()
        .parameters
        .iter()
        .map(|parameter| parameter.name);
    let parameters: Vec<(&str, f64)> = names
        .enumerate()
        .map(|(index, name)| (name, system.get(index)))
        .collect();
    let scope = Scope {
        coordinates: &coordinates,
        parameters: &parameters,
        definitions: &definitions(&system.description().source),
        state,
        partial,
    };
    value(text, &scope)
}

/// The rate of an expression along the emitted motion.
pub fn rate(system: &dyn Numeric, text: &str, t: f64, state: &[f64]) -> f64 {
    let direction = system.rate(t, state);
    slope(&mut |s| {
        let state = system.snapshot(t + s, &moved(state, s, &direction));
        at(system, text, &state, None)
    })
}

/// The rate along the emitted motion of a potential as messages write it, with `det m` for the determinant of
/// `m^{ab}` and bars for absolute values.
///
/// # Panics
/// If the text does not have this form.
pub fn rate_of_potential(system: &dyn Numeric, text: &str, t: f64, state: &[f64]) -> f64 {
    let text = text.replace("ln(det m)", "mass");
    let direction = system.rate(t, state);
    let text = text.replace("ln|", "ln(abs(").replace('|', "))");
    slope(&mut |s| {
        let moved = moved(state, s, &direction);
        let report = system.report(t + s, &moved);
        let determinant = determinant(&report.0["constraint_mass"]).ln();
        let text = text.replace("mass", &format!("({determinant:.17})"));
        at(system, &text, &system.snapshot(t + s, &moved), None)
    })
}

/// The determinant of a matrix of one or two rows.
fn determinant(rows: &[f64]) -> f64 {
    match rows {
        [only] => *only,
        [a, b, c, d] => a * d - b * c,
        _ => panic!("{} entries", rows.len()),
    }
}

/// Compares every number of the message about `claim` with a number computed in this file.
///
/// # Panics
/// If one differs, is unknown, or does not contradict the claim.
pub fn check(system: &mut dyn Numeric, claim: &str, message: &str) {
    let witness = Witness::of(message).unwrap_or_else(|| panic!("no witness: {message}"));
    let (t, q, qdot) = witness.place(system);
    let system = &*system;
    let state = system.state(t, &q, &qdot);
    assert!(!witness.values.is_empty(), "{message}");
    for (name, printed) in &witness.values {
        let (found, tolerance) = match name.as_str() {
            "delta" => (delta(system, message, &q), NESTED),
            "period" => (period(system, message, &q), NESTED),
            _ => (computed(system, claim, name, t, &state), ONCE),
        };
        let error = (found - printed).abs();
        assert!(
            error <= tolerance[0] * printed.abs() + tolerance[1],
            "{name}: {found} here, in the message {message}"
        );
    }
    let [expected, found] = opposites(&witness);
    let size = expected.abs() + found.abs();
    assert!(
        (expected - found).abs() > 1e-6 * size,
        "nothing is wrong: {message}"
    );
}

/// Compares the example of a message with numbers computed in this file. The example is a state at which the terms of a
/// rate cancel, or at which two values agree; `claim` is the true claim.
///
/// # Panics
/// If the terms do not cancel, the rate is not 0 there, or a value differs.
pub fn check_example(system: &mut dyn Numeric, claim: &str, example: &Witness) {
    let (t, q, qdot) = example.place(system);
    let system = &*system;
    let state = system.state(t, &q, &qdot);
    let is_part = |(name, _): &&(String, f64)| name.starts_with("part by ");
    let parts: Vec<f64> = example
        .values
        .iter()
        .filter(is_part)
        .map(|it| it.1)
        .collect();
    let size = parts
        .iter()
        .fold(0.0, |size: f64, part| larger(size, part.abs()));
    if !parts.is_empty() {
        let sum: f64 = parts.iter().sum();
        assert!(sum.abs() <= 1e-9 * size, "{claim}: {example:?}");
        let (_, quantity) = claim.split_once(':').expect("a quantity");
        let rate = rate(system, quantity, t, &state);
        assert!(
            rate.abs() <= ONCE[0] * size + ONCE[1],
            "{claim}: {rate}, {example:?}"
        );
    }
    let is_side = |name: &str| name.ends_with(" after") || name.ends_with(" before");
    for (name, printed) in example.values.iter().filter(|(name, _)| is_side(name)) {
        let found = computed(system, claim, name, t, &state);
        let error = (found - printed).abs();
        assert!(
            error <= ONCE[0] * printed.abs() + ONCE[1],
            "{claim}: {found}, {example:?}"
        );
    }
}

/// Two numbers that would agree if the claim were true.
fn opposites(witness: &Witness) -> [f64; 2] {
    match witness.values.as_slice() {
        [(_, only)] => [*only, 0.0],
        [(_, rate), (name, divergence)] if name == "divergence" => [*rate, -divergence],
        [(_, after), (_, before)] => [*after, *before],
        other => panic!("{other:?}"),
    }
}

fn computed(system: &dyn Numeric, claim: &str, name: &str, t: f64, state: &[f64]) -> f64 {
    let inner = |start: &str, end: &str| name.strip_prefix(start)?.strip_suffix(end);
    if let Some(density) = inner("d/dt(ln(", "))") {
        return rate(system, &format!("ln(abs({density}))"), t, state);
    }
    if let Some(quantity) = inner("d/dt(", ")") {
        return rate(system, quantity, t, state);
    }
    if name == "divergence" {
        return system.report(t, state).number("divergence_mu_C");
    }
    if let Some(quantity) = name.strip_suffix(" before") {
        return at(system, quantity, &system.snapshot(t, state), None);
    }
    if let Some(quantity) = name.strip_suffix(" after") {
        let (_, rest) = claim.split_once("under ").expect("a surface");
        let (surface, _) = rest.split_once(':').expect("a claim");
        let after = system.impact(surface.trim(), Law::Elastic, t, state);
        return at(system, quantity, &system.snapshot(t, &after), None);
    }
    let field = claim.strip_prefix("symmetry:").expect("a symmetry");
    if let Some(pair) = inner("second derivative of this rate in dot(", ")") {
        let (first, second) = pair.split_once(") and dot(").expect("two velocities");
        let [i, j] = [first, second].map(|name| position(system, name));
        return twice(system, field, t, state, [i, j]);
    }
    if let Some(coordinate) = name.strip_prefix("Euler-Lagrange expression of this rate for ") {
        return euler_lagrange(system, field, t, state, position(system, coordinate));
    }
    let constraint = inner("rate of the left side of ", " along its flow").expect("a known number");
    let names = system.description().constraints.iter();
    let a = names
        .map(|name| name.name)
        .position(|name| name == constraint);
    let a = a.expect("a constraint");
    flow(system, field, t, state, &|place| {
        // eta^a(qdot) = g(W^a, qdot); for linear constraints that is the left side.
        let report = system.report(t, &system.state(t, &place.q, &place.qdot));
        let n = place.q.len();
        let lowered = report.0["metric"]
            .chunks(n)
            .map(|row| product(row, &place.qdot));
        let lowered: Vec<f64> = lowered.collect();
        product(&report.0["W"][a * n..(a + 1) * n], &lowered)
    })
}

/// The position of a coordinate.
fn position(system: &dyn Numeric, name: &str) -> usize {
    let mut names = system.description().coordinates.iter();
    names
        .position(|coordinate| coordinate.name == name)
        .expect("a coordinate")
}

/// The rate of the Lagrangian along a field at a state with other positions and velocities.
fn rate_of_lagrangian(system: &dyn Numeric, field: &str, t: f64, q: &[f64], qdot: &[f64]) -> f64 {
    let state = system.state(t, q, qdot);
    // L = 2 T + A.qdot - (T + V)
    flow(system, field, t, &state, &|place| {
        let report = system.report(t, &system.state(t, &place.q, &place.qdot));
        let n = place.q.len();
        let lowered = report.0["metric"]
            .chunks(n)
            .map(|row| product(row, &place.qdot));
        let lowered: Vec<f64> = lowered.collect();
        let linear = product(&place.p, &place.qdot) - product(&lowered, &place.qdot);
        product(&lowered, &place.qdot) + linear - place.energy
    })
}

/// The second derivative of the rate of the Lagrangian in two velocities. The rate is a polynomial of degree 2 in them.
fn twice(system: &dyn Numeric, field: &str, t: f64, state: &[f64], pair: [usize; 2]) -> f64 {
    let here = system.snapshot(t, state);
    let at = |[a, b]: [f64; 2]| {
        let mut qdot = here.qdot.clone();
        qdot[pair[0]] += a;
        qdot[pair[1]] += b;
        rate_of_lagrangian(system, field, t, &here.q, &qdot)
    };
    let corners = [[0.5, 0.5], [0.5, -0.5], [-0.5, 0.5], [-0.5, -0.5]].map(at);
    corners[0] - corners[1] - corners[2] + corners[3]
}

/// `(qdot^j d_j + d_t) dR/dqdot^i - dR/dq^i` for the rate `R` of the Lagrangian.
fn euler_lagrange(system: &dyn Numeric, field: &str, t: f64, state: &[f64], i: usize) -> f64 {
    let here = system.snapshot(t, state);
    let along = slope(&mut |s| {
        let q = moved(&here.q, s, &here.qdot);
        let [after, before] = [0.5, -0.5].map(|shift| {
            let mut qdot = here.qdot.clone();
            qdot[i] += shift;
            rate_of_lagrangian(system, field, t + s, &q, &qdot)
        });
        after - before
    });
    let gradient = slope(&mut |s| {
        let mut q = here.q.clone();
        q[i] += s;
        rate_of_lagrangian(system, field, t, &q, &here.qdot)
    });
    along - gradient
}

/// The rate of a function of position and velocity along the lift of a field to velocities.
fn flow(
    system: &dyn Numeric,
    field: &str,
    t: f64,
    state: &[f64],
    function: &dyn Fn(&Snapshot) -> f64,
) -> f64 {
    let start = system.snapshot(t, state);
    let n = start.q.len();
    let components = |q: &[f64]| -> Vec<f64> {
        let here = system.snapshot(t, &system.state(t, q, &start.qdot));
        (0..n).map(|i| at(system, field, &here, Some(i))).collect()
    };
    let shift = components(&start.q);
    let turn: Vec<f64> = (0..n)
        .map(|i| slope(&mut |s| components(&moved(&start.q, s, &start.qdot))[i]))
        .collect();
    slope(&mut |s| {
        let (q, qdot) = (moved(&start.q, s, &shift), moved(&start.qdot, s, &turn));
        function(&system.snapshot(t, &system.state(t, &q, &qdot)))
    })
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Demand of the bracket in a message minus the demand of the combination of fields that equals the bracket.
fn delta(system: &dyn Numeric, message: &str, q: &[f64]) -> f64 {
    let names: Vec<&str> = system
        .description()
        .coordinates
        .iter()
        .map(|coordinate| coordinate.name)
        .collect();
    let line = |part: &str| {
        let found = message.lines().find(|line| line.contains(part));
        found.unwrap_or_else(|| panic!("no `{part}` in {message}"))
    };
    let fields = line("frame of D there: ").trim_start_matches("frame of D there: ");
    let frame: Vec<Vec<f64>> = fields
        .split(", ")
        .map(|field| vector(field.split_once(" = ").expect("a field").1, &names))
        .collect();
    let criterion = Criterion::new(system, q, &frame).expect("the frame of the message");
    let (left, _) = line(" as a vector field")
        .split_once(" as a vector field")
        .expect("a relation");
    let (bracket, combination) = left.split_once(" = ").expect("a relation");
    let mut rest = criterion.element(bracket, q);
    for term in combination.split(" + ").filter(|term| *term != "0") {
        let (coefficient, name) = term.split_once('*').expect("a term");
        let coefficient: f64 = coefficient.parse().expect("a number");
        rest = moved(&rest, -coefficient, &criterion.element(name, q));
    }
    let delta = rest.pop().expect("a demand");
    let largest = rest
        .iter()
        .fold(0.0, |size: f64, value| larger(size, value.abs()));
    assert!(largest < NESTED[1], "no relation: {rest:?}, {message}");
    delta
}

/// Growth of G over the turn of an angle that a message names, by the trapezoidal rule.
fn period(system: &dyn Numeric, message: &str, q: &[f64]) -> f64 {
    const POINTS: u32 = 32;
    let (_, turn) = message.split_once("by `period` when ").expect("a turn");
    let (angle, _) = turn.split_once(" makes a turn").expect("one turn");
    let mut names = system
        .description()
        .coordinates
        .iter()
        .map(|coordinate| coordinate.name);
    let i = names.position(|name| name == angle).expect("a coordinate");
    let step = std::f64::consts::TAU / f64::from(POINTS);
    let slopes = (0..POINTS).map(|k| {
        let mut q = q.to_vec();
        q[i] = step * f64::from(k);
        let criterion = Criterion::regular(system, &q).expect("a regular position");
        criterion.differential(&q).expect("a closed form")[i]
    });
    step * slopes.sum::<f64>()
}

/// The largest `|d_i b_j - d_j b_i|` of the form `b` that the demands determine; `b = dG` if G exists.
///
/// # Panics
/// If the frame of D and the brackets of its pairs do not span all directions.
pub fn curl(system: &dyn Numeric, q: &[f64]) -> f64 {
    let criterion = Criterion::regular(system, q).expect("a regular position");
    let rows: Vec<Vec<f64>> = (0..q.len())
        .map(|i| {
            slopes(&|s| {
                let mut q = q.to_vec();
                q[i] += s;
                criterion.differential(&q).expect("a frame that spans")
            })
        })
        .collect();
    let pairs = (0..q.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    pairs.fold(0.0, |largest: f64, (i, j)| {
        larger(largest, (rows[i][j] - rows[j][i]).abs())
    })
}

/// Components of a field such as `d_x + 0.41*d_y`.
fn vector(text: &str, names: &[&str]) -> Vec<f64> {
    let mut components = vec![0.0; names.len()];
    let text = text.replace(" - ", " + -");
    for term in text.split(" + ") {
        let (coefficient, direction) = match term.rsplit_once('*') {
            Some((number, direction)) => (number.parse().expect("a number"), direction),
            None => match term.strip_prefix('-') {
                Some(direction) => (-1.0, direction),
                None => (1.0, term),
            },
        };
        let name = direction.strip_prefix("d_").expect("a direction");
        let i = names
            .iter()
            .position(|known| *known == name)
            .expect("a coordinate");
        components[i] = coefficient;
    }
    components
}
