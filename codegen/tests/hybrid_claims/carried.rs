//! Tests of invariant forms by finite differences. Vectors at the start of a motion are carried through an impact by
//! central differences of the motion's end (see `differences.rs`), and the form is evaluated on them at both ends.
//!
//! Only the verdict comes from the generator.

use crate::Expected::{False, Shown, True};
use crate::check;
use crate::differences::{Hybrid, State, assert_close, one};
use crate::systems::{ball, crossing, media, particle, spokes};
use dalembert_numbers::math::larger;

/// A form of degree 2, as a function of two vectors.
type Form<'f> = &'f dyn Fn(&[f64], &[f64]) -> f64;

/// `sum over i of dp_i ^ dq_i` for states `(q.., v..)` with the metric `m` times the identity.
fn symplectic(m: f64) -> impl Fn(&[f64], &[f64]) -> f64 {
    move |v, w| {
        let n = v.len() / 2;
        (0..n)
            .map(|i| m * (v[n + i] * w[i] - w[n + i] * v[i]))
            .sum()
    }
}

/// Largest change of a form of degree 2 over all pairs of basis vectors.
fn largest_change(
    hybrid: &Hybrid<'_>,
    start: &[f64],
    time: f64,
    [before, after]: [Form<'_>; 2],
) -> f64 {
    let columns = hybrid.columns(start, time);
    let axis = |i: usize| -> State { (0..start.len()).map(|k| f64::from(k == i)).collect() };
    let mut largest: f64 = 0.0;
    for (i, first) in columns.iter().enumerate() {
        for (j, second) in columns.iter().enumerate() {
            let change = after(first, second) - before(&axis(i), &axis(j));
            largest = larger(largest, change.abs());
        }
    }
    largest
}

const PLANE: &str = "invariant: d(momentum(x))^d(x) + d(momentum(y))^d(y)";

#[test]
fn a_refraction_carries_the_symplectic_form() {
    let free = |z: &[f64]| vec![z[2], z[3], 0.0, 0.0];
    let (m1, m2, v) = (1.0, 2.0, 0.2);
    let glass = Hybrid {
        before: &free,
        gap: &|z| -z[0],
        map: &|z| {
            let py = m1 * z[3];
            let energy = m1 / 2.0 * (z[2] * z[2] + z[3] * z[3]);
            let normal: f64 = 2.0 * m2 * (energy - v) - py * py;
            vec![z[0], z[1], normal.sqrt() / m2, py / m2]
        },
        after: &free,
        densities: [&one, &one],
    };
    let forms: [Form<'_>; 2] = [&symplectic(m1), &symplectic(m2)];
    let change = largest_change(&glass, &[-0.5, 0.2, 1.1, 0.4], 1.0, forms);
    assert!(change < 1e-9, "{change:e}");
    let other: [Form<'_>; 2] = [&symplectic(m1), &symplectic(m1)];
    assert!(largest_change(&glass, &[-0.5, 0.2, 1.1, 0.4], 1.0, other) > 0.1);
    let model = media(
        "m1/2*(dot(x)^2 + dot(y)^2)",
        "m2/2*(dot(x)^2 + dot(y)^2) - V",
    );
    check(&model, PLANE, True);
    check(
        &model,
        "invariant: d(dot(x))^d(x) + d(dot(y))^d(y)",
        False("`rightward` changes"),
    );
}

/// The wall at `x = 3` adds `2 y` to the velocity along the wall. At the state that the verdict shows, the form on
/// `partial(x), partial(y)` becomes 7.24.
#[test]
fn a_push_along_a_wall_changes_the_symplectic_form() {
    let falls = |z: &[f64]| vec![z[2], z[3], 0.0, -1.0];
    let wall = Hybrid {
        before: &falls,
        gap: &|z| 3.0 - z[0],
        map: &|z| vec![z[0], z[1], -z[2], z[3] + 2.0 * z[1]],
        after: &falls,
        densities: [&one, &one],
    };
    // The state (3, -0.53) with the velocity (1/2, -3/4), a quarter of a time unit earlier.
    let early: f64 = 0.25;
    let start = [
        3.0 - 0.5 * early,
        -0.53 + 0.75 * early - 0.5 * early * early,
        0.5,
        -0.75 + early,
    ];
    let columns = wall.columns(&start, 0.5);
    assert_close(symplectic(1.0)(&columns[0], &columns[1]) / 7.24, 1.0);
    let declared = particle("left: x <= 3 => reset { dot(x) = -dot(x); dot(y) = dot(y) + 2*y; };")
        .replace("(dot(x)^2 + dot(y)^2)/2", "(dot(x)^2 + dot(y)^2)/2 - y");
    check(
        &declared,
        PLANE,
        Shown("the form on partial(x), partial(y) after", 7.24),
    );
}

/// W. Clark, thesis, Example IX.9 with corrected sign: `dv+ = -dv - (2 g/v-) dx`.
#[test]
fn a_ball_that_falls_earlier_is_slower_for_longer() {
    let falls = |z: &[f64]| vec![z[1], -1.0];
    let floor = Hybrid {
        before: &falls,
        gap: &|z| z[0],
        map: &|z| vec![z[0], -z[1]],
        after: &falls,
        densities: [&one, &one],
    };
    // The ball meets the floor at the velocity -3/4.
    let start = [0.25 * (0.75 + 0.5) / 2.0, -0.5];
    let columns = floor.columns(&start, 0.5);
    assert_close(columns[0][1], 2.0 / 0.75);
    check(
        &ball("elastic"),
        "invariant: d(dot(x))",
        Shown("the form on partial(x) after", 2.0 / 0.75),
    );
}

#[test]
fn a_field_that_turns_carries_one_of_two_forms() {
    let turned = Hybrid {
        before: &|_| vec![-2.0, 1.0],
        gap: &|z| z[0],
        map: &|z| z.to_vec(),
        after: &|_| vec![-2.0, -1.0],
        densities: [&one, &one],
    };
    let columns = turned.columns(&[1.0, 0.0], 1.0);
    let expected = [[1.0, 1.0], [0.0, 1.0]];
    for (column, expected) in columns.iter().zip(expected) {
        assert_close(column[0], expected[0]);
        assert_close(column[1], expected[1]);
    }
    let declared = crossing(["-2", "1"], ["-2", "-1"], "1");
    check(&declared, "invariant: d(x)", True);
    check(
        &declared,
        "invariant: d(y)",
        Shown("the form on partial(x) after", 1.0),
    );
}

/// A step multiplies `dp ^ dx` by `cos(2 h)^2`.
#[test]
fn a_wheel_that_changes_its_spoke_shrinks_the_symplectic_form() {
    let (l1, l2, h) = (1.7, 1.9, 0.65_f64);
    let pendulum = |l: f64| move |z: &[f64]| vec![z[1], z[0].sin() / l];
    let (first, second) = (pendulum(l1), pendulum(l2));
    let wheel = Hybrid {
        before: &first,
        gap: &|z| z[0] + h,
        map: &|z| vec![z[0] + 2.0 * h, l1 / l2 * (2.0 * h).cos() * z[1]],
        after: &second,
        densities: [&one, &one],
    };
    let columns = wheel.columns(&[-0.6, -0.5], 0.3);
    let ratio = symplectic(l2 * l2)(&columns[0], &columns[1])
        / symplectic(l1 * l1)(&[1.0, 0.0], &[0.0, 1.0]);
    assert_close(ratio, (2.0 * h).cos().powi(2));
    check(
        &spokes("l1/l2*cos(2*h)*dot(x)"),
        "invariant: d(momentum(x))^d(x)",
        Shown(
            "the form on partial(x), partial(dot(x)) after",
            -l1 * l1 * (2.0 * h).cos().powi(2),
        ),
    );
}
