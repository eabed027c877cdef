//! Hypotheses of the Poincare-Bendixson theorem: rimless wheels against closed forms, and systems that violate a
//! hypothesis.

use std::f64::consts::PI;

use dalembert_codegen::report::planar::{Cascade, Decided, Planar, planar};

/// A wheel by the formulas of the thesis: `R`, `P` and `K` of each spoke, (4.14) and (4.15) with m = g = 1.
fn wheel(alpha: f64, delta: &[f64], l: &[f64]) -> Vec<[f64; 3]> {
    let n = l.len();
    let angle = |i: usize| {
        let next = (i + 1) % n;
        let square =
            l[i] * l[i] + l[next] * l[next] - 2.0 * l[i] * l[next] * (2.0 * delta[i]).cos();
        let s = square.sqrt();
        ((l[next] * l[next] + square - l[i] * l[i]) / (2.0 * l[next] * s)).acos()
    };
    let energies = |i: usize| {
        let entry = PI / 2.0 - angle((i + n - 1) % n) - alpha;
        let exit = PI / 2.0 - angle(i) - 2.0 * delta[i] - alpha;
        let highest = if exit < 0.0 && entry > 0.0 {
            1.0
        } else {
            entry.cos().max(exit.cos())
        };
        let kept = (2.0 * delta[i]).cos().powi(2);
        [
            l[i] * (highest - entry.cos()),
            l[i] * (entry.cos() - exit.cos()),
            kept,
        ]
    };
    (0..n).map(energies).collect()
}

const FIVE: (f64, [f64; 5], [f64; 5]) = (
    0.5062,
    [0.6516, 0.7124, 0.6410, 0.5639, 0.5728],
    [1.7184, 1.8985, 1.6416, 1.5872, 1.6217],
);

/// A wheel of equal spokes, six to a turn.
fn even(slope: f64) -> Planar {
    let text = "Wheel { coordinates { x; } parameters { alpha = 0.1; }
        lagrangian = dot(x)^2/2 - cos(x);
        impacts { step: x >= -pi/6 - alpha => reset { x = x + pi/3; dot(x) = dot(x)/2; }; } }";
    decided(text, &[("alpha", slope)])
}

fn decided(text: &str, parameters: &[(&str, f64)]) -> Planar {
    planar(text, parameters).unwrap_or_else(|error| panic!("{error}"))
}

fn shipped(name: &str) -> &'static str {
    let text = dalembert_texts::TEXTS
        .iter()
        .find(|(known, _)| *known == name);
    text.expect("a shipped text").1
}

/// The shipped wheel with five spokes on a slope.
fn five(slope: f64) -> Planar {
    let (_, delta, l) = FIVE;
    let named = |name: &str, values: &[f64]| -> Vec<(String, f64)> {
        let numbered = values.iter().enumerate();
        numbered
            .map(|(i, value)| (format!("{name}.{}", i + 1), *value))
            .collect()
    };
    let mut values = vec![("alpha".to_owned(), slope), ("g".to_owned(), 1.0)];
    values.extend(named("delta", &delta));
    values.extend(named("l", &l));
    let values: Vec<(&str, f64)> = values
        .iter()
        .map(|(name, value)| (name.as_str(), *value))
        .collect();
    decided(shipped("rimless_wheel_five"), &values)
}

#[track_caller]
fn verdicts(planar: &Planar) -> Vec<Decided> {
    planar
        .hypotheses
        .iter()
        .map(|it| it.decided.clone())
        .collect()
}

#[track_caller]
fn cascade(planar: &Planar) -> &Cascade {
    planar.cascade.as_ref().expect("a cascade")
}

#[test]
fn a_wheel_of_five_spokes_has_a_gait_and_its_energies_are_those_of_the_thesis() {
    let (alpha, delta, l) = FIVE;
    let found = five(alpha);
    assert!(found.concludes(), "{found:?}");
    let energies = wheel(alpha, &delta, &l);
    let largest = |(a, b): (&usize, &usize)| energies[*a][0].total_cmp(&energies[*b][0]);
    let first = (0..5).max_by(|a, b| largest((a, b))).unwrap_or(0);
    let mut energy = energies[first][0];
    for (index, step) in cascade(&found).steps.iter().enumerate() {
        assert_eq!(step.mode, (first + index) % 5);
        let [needed, gained, kept] = energies[step.mode];
        energy = kept * (energy + gained);
        let pairs = [
            (step.needed, needed),
            (step.gained, gained),
            (step.kept, kept),
            (step.reached, energy),
        ];
        for (interval, value) in pairs {
            assert!(
                interval.lo <= value + 1e-12 && value <= interval.hi + 1e-12,
                "{interval:?} {value}"
            );
            assert!(interval.hi - interval.lo < 1e-8, "{interval:?}");
        }
        assert_eq!(step.holds(), Some(true));
    }
    let product: f64 = energies.iter().map(|[_, _, kept]| kept).product();
    let multiplier = cascade(&found).multiplier;
    assert!((multiplier.lo - product).abs() < 1e-12 && multiplier.hi - multiplier.lo < 1e-12);
    // A round maps the energy of the orbit to itself.
    let orbit = cascade(&found).energy.expect("an energy");
    let round = (0..5).fold(orbit.lo, |energy, index| {
        let [_, gained, kept] = energies[(first + index) % 5];
        kept * (energy + gained)
    });
    assert!((round - orbit.lo).abs() < 1e-9, "{round} {orbit:?}");
}

#[test]
fn a_flat_slope_leaves_the_wheel_without_an_invariant_set() {
    let found = five(0.05);
    assert!(!found.concludes());
    assert_eq!(verdicts(&found)[2], Decided::Open);
    assert!(
        found.hypotheses[2].reason.contains("(4.13) fails"),
        "{found:?}"
    );
}

#[test]
fn the_inequality_is_decided_on_both_sides_of_its_boundary() {
    // The condition eta(R) > R, for one mode with K = 1/4, P = sin(alpha) and R = 1 - cos(pi/6 - alpha).
    let excess = |alpha: f64| alpha.sin() - 3.0 * (1.0 - (PI / 6.0 - alpha).cos());
    let (mut low, mut high) = (0.0, 0.5);
    while high - low > 1e-15 {
        let middle = 0.5 * (low + high);
        *(if excess(middle) > 0.0 {
            &mut high
        } else {
            &mut low
        }) = middle;
    }
    assert!(even(high + 1e-8).concludes(), "{:?}", even(high + 1e-8));
    let below = even(high - 1e-8);
    assert!(!below.concludes());
    assert!(
        below.hypotheses[2].reason.contains("(4.13) fails"),
        "{below:?}"
    );
    assert_eq!(cascade(&below).steps[0].holds(), Some(false));
}

/// The verdicts on a declaration with these parts.
fn ball(parts: &str) -> Planar {
    decided(&format!("Ball {{ {parts} }}"), &[])
}

#[test]
fn hypotheses_that_are_not_shown_have_reasons() {
    let lagrangian = "lagrangian = dot(x)^2/2 - x;";
    let floor = "impacts { floor: x >= 0 => newton(1/2); }";
    let line = format!("coordinates {{ x; }} {lagrangian}");
    let cases = [
        (format!("{line} {floor}"), 2, Decided::Open, "is no reset"),
        (
            "coordinates { x: angle; } lagrangian = dot(x)^2/2 + cos(x); impacts { w: cos(x) <= 1/2 => reset { dot(x) = -dot(x); }; }"
                .to_owned(),
            0,
            Decided::Fails,
            "is an angle",
        ),
        (
            "coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2; impacts { w: x >= 0; }"
                .to_owned(),
            0,
            Decided::Fails,
            "4 dimensions",
        ),
        (
            format!("{line} impacts {{ floor: x >= sin(t); }}"),
            0,
            Decided::Fails,
            "depends on time",
        ),
        (
            format!("{line} impacts {{ floor: x >= 0 => impact_plastic; }}"),
            1,
            Decided::Fails,
            "to a single point",
        ),
        (
            format!("{line} impacts {{ floor: x >= 0 => reset {{ x = 1; dot(x) = 0; }}; }}"),
            1,
            Decided::Fails,
            "to a single point",
        ),
        (
            format!("{line} impacts {{ floor: x >= 0 => reset {{ x = 1; dot(x) = dot(x)^2; }}; }}"),
            1,
            Decided::Open,
            "monotone along the surface",
        ),
        (
            format!("{line} impacts {{ floor: x >= 0; top: x <= 1; }}"),
            3,
            Decided::Open,
            "left through 2 surfaces",
        ),
        (
            format!(
                "{line} forces {{ drag: -dot(x)*d(x); }} impacts {{ floor: x >= 0 => reset {{ x = 1; dot(x) = dot(x)/2; }}; }}"
            ),
            2,
            Decided::Open,
            "forces act",
        ),
        (
            format!(
                "{line} impacts {{ floor: x >= 0 => reset {{ x = 1; dot(x) = -dot(x)/2; }}; }}"
            ),
            2,
            Decided::Open,
            "leads away",
        ),
        (
            format!(
                "{line} impacts {{ floor: x >= 0 when x > -1 => reset {{ x = 1; dot(x) = dot(x)/2; }}; }}"
            ),
            2,
            Decided::Open,
            "has conditions",
        ),
    ];
    for (parts, place, decided, reason) in cases {
        let found = ball(&parts);
        assert!(!found.concludes(), "{parts}");
        let hypothesis = &found.hypotheses[place];
        assert_eq!(hypothesis.decided, decided, "{parts}: {hypothesis:?}");
        assert!(
            hypothesis.reason.contains(reason),
            "{parts}: {hypothesis:?}"
        );
    }
}

#[test]
fn maps_are_injective_by_any_component_of_their_image() {
    let line = "coordinates { x; } lagrangian = dot(x)^2/2 - x;";
    for impacts in [
        "floor: x >= 0 => nonholonomic_plastic;",
        "floor: x >= 0 => reset { x = 1 - dot(x); dot(x) = -1; };",
    ] {
        let found = ball(&format!("{line} impacts {{ {impacts} }}"));
        assert_eq!(verdicts(&found)[1], Decided::Holds, "{impacts}: {found:?}");
    }
}

#[test]
fn the_mirrored_ball_is_decided_like_the_ball() {
    let found = ball(
        "coordinates { x; } lagrangian = dot(x)^2/2 + x;
        impacts { floor: x <= 0 => reset { x = -1; dot(x) = dot(x)/2; }; far: x >= -2 => stop; }",
    );
    assert!(found.concludes(), "{found:?}");
}

#[test]
fn a_ball_that_is_lifted_after_every_fall_has_one_orbit() {
    // The ball is lifted from 0 to 1 with half its speed: E -> (E + 1)/4, with the fixed point E = 1/3.
    let found = ball(
        "coordinates { x; } lagrangian = dot(x)^2/2 - x;
        impacts { floor: x >= 0 => reset { x = 1; dot(x) = dot(x)/2; }; }",
    );
    assert!(found.concludes(), "{found:?}");
    let cascade = cascade(&found);
    let energy = cascade.energy.expect("an energy");
    assert!(energy.lo <= 1.0 / 3.0 && 1.0 / 3.0 <= energy.hi && energy.hi - energy.lo < 1e-12);
    assert!(cascade.multiplier.lo <= 0.25 && 0.25 <= cascade.multiplier.hi);
    // Without a loss the energy grows.
    let growing = ball(
        "coordinates { x; } lagrangian = dot(x)^2/2 - x;
        impacts { floor: x >= 0 => reset { x = 1; }; }",
    );
    assert!(
        growing.hypotheses[2].reason.contains("not bounded"),
        "{growing:?}"
    );
}

#[test]
fn first_order_maps_are_injective_along_lines() {
    let field = |map: &str| {
        ball(&format!(
            "coordinates {{ x; y; }} field {{ dot(x) = 1; dot(y) = -y; }}
            impacts {{ tick: x <= 1 => reset {{ x = 0; {map} }}; }}"
        ))
    };
    assert_eq!(verdicts(&field("y = 2*y + 1;"))[1], Decided::Holds);
    assert_eq!(verdicts(&field("y = y^2;"))[1], Decided::Open);
    assert_eq!(verdicts(&field("y = y + sin(y)/2;"))[1], Decided::Holds);
}
