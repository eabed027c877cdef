//! Optimal control of states with three components or more, against closed forms.

// A test may fail by panicking.
#![allow(clippy::unwrap_used)]

mod support;

use dalembert_cli::Exit;
use serde_json::Value;
use support::run_on;

/// A chain of four integrators. From rest at 0 to rest at 1 in a time of 1, the least integral of `u^2` is
/// `7!^2/(3!^2 7) = 100800`.
const CHAIN: &str = "
    Chain {
        coordinates { a; b; c; g; }
        inputs { u; }
        cost { running = u^2/2; }
        field { dot(a) = b; dot(b) = c; dot(c) = g; dot(g) = u; }
        initial { until = 1; }
    }";

/// A rod of length 1 that does not stretch, described by the angle of its tangent. Its extremals are Euler's elastica.
const ROD: &str = "
    Rod {
        coordinates { x; y; th; }
        inputs { u; }
        cost { running = u^2/2; }
        field { dot(x) = cos(th); dot(y) = sin(th); dot(th) = u; }
        initial { until = 1; }
    }";

#[test]
fn a_chain_of_integrators_is_driven_at_the_least_cost() {
    let done = run_on(CHAIN, "control - --end a=1,b=0,c=0,g=0 --json -");
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let document: Value = serde_json::from_str(&done.output).unwrap();
    let [extremal] = document["extremals"].as_array().unwrap().as_slice() else {
        panic!("{document}");
    };
    let cost = extremal["cost"].as_f64().unwrap();
    assert!((cost / 50400.0 - 1.0).abs() < 1e-11, "{cost}");
    assert_eq!(extremal["second_order"]["verdict"], "minimum");
}

/// The complete elliptic integrals K and E of a parameter, by the arithmetic-geometric mean.
fn elliptic(m: f64) -> [f64; 2] {
    let (mut a, mut b, mut sum, mut power) = (1.0, (1.0 - m).sqrt(), m / 2.0, 0.5);
    for _ in 0..12 {
        let c = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        power *= 2.0;
        sum += power * c * c;
    }
    let k = std::f64::consts::FRAC_PI_2 / a;
    [k, k * (1.0 - sum)]
}

/// A rod is clamped at both ends along its chord, which is half as long as the rod. It is one wave of an inflectional
/// elastica of parameter `m`. The length of the chord, `2 E(m)/K(m) - 1 = 1/2`, determines `m`, and the cost is
/// `32 K^2 (E/K - 1 + m)`. The rod bends to either side. All other forms cost more.
#[test]
fn a_clamped_rod_bends_to_the_first_of_eulers_elastica() {
    let (mut low, mut high) = (0.0, 0.9);
    for _ in 0..60 {
        let m = 0.5 * (low + high);
        let [k, e] = elliptic(m);
        match e / k > 0.75 {
            true => low = m,
            false => high = m,
        }
    }
    let [k, e] = elliptic(low);
    let least = 32.0 * k * k * (e / k - 1.0 + low);
    let done = run_on(ROD, "control - --end x=0.5,y=0,th=0 --json -");
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let document: Value = serde_json::from_str(&done.output).unwrap();
    let extremals = document["extremals"].as_array().unwrap();
    for extremal in &extremals[..2] {
        let cost = extremal["cost"].as_f64().unwrap();
        assert!((cost - least).abs() < 1e-10 * least, "{cost} and {least}");
        assert_eq!(extremal["second_order"]["verdict"], "minimum");
    }
    let turns = [0, 1].map(|it| extremals[it]["start"]["inputs"]["u"].as_f64().unwrap());
    assert!(
        (turns[0] + turns[1]).abs() < 1e-8 && turns[0].abs() > 1.0,
        "{turns:?}"
    );
    for extremal in &extremals[2..] {
        assert!(extremal["cost"].as_f64().unwrap() > 1.5 * least);
        assert_eq!(extremal["second_order"]["verdict"], "fails");
    }
}
