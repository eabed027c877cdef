//! The command `errata`: every computed value differs from the printed one and equals a value computed by hand.

mod support;

use std::f64::consts::PI;

use dalembert_cli::Exit;
use serde_json::Value;
use support::run_on;

fn run(words: &[&str]) -> (Exit, String) {
    let done = run_on("", &["errata", &words.join(" ")].join(" "));
    assert!(done.errors.is_empty(), "{}", done.errors);
    (done.exit, done.output)
}

/// Printed and right values, computed by hand, in the order of the list. The page Errata has the right formulas.
fn by_hand() -> Vec<[f64; 2]> {
    // d(ln p_theta)/dt = -m a v/(I + m a^2) of the sleigh; its divergence is the same.
    let sleigh = -1.5 * 0.5 * 1.5 / (0.4 + 1.5 * 0.25);
    // The invariant density of the bead is |d(x^2/4 + y^2)|^2 = x^2/4 + 4 y^2, up to a factor.
    let (x, y, vx, vy) = (1.0, 0.5, 1.0, -0.5);
    let bead = -(x * vx / 2.0 + 8.0 * y * vy) / (x * x / 4.0 + 4.0 * y * y);
    // h_x, h_y at the leading end (0.875, 0.25), and I + m R^2, of the disk.
    let (h_x, h_y, inertia) = (-0.4375, -0.5, 0.2 + 1.5 * 0.375 * 0.375);
    let roll = 0.375 * h_x / inertia;
    let sideways = 0.375 * 0.375 / (2.0 * inertia) * (h_y + h_x);
    // Radii l_3, l_4 of the wheel, the distance of their feet, and the angle at the second foot.
    let (l3, l4, delta) = (1.6226_f64, 1.5025_f64, 0.1766_f64);
    let s = (l3 * l3 + l4 * l4 - 2.0 * l3 * l4 * (2.0 * delta).cos()).sqrt();
    let asin = (l3 * (2.0 * delta).sin() / s).asin();
    vec![
        [3.0 * sleigh, sleigh],
        [2.0 * bead, bead],
        [-2.0 * sleigh, 0.0],
        [0.375 / 0.2 * h_y / roll, 0.375 / 0.1 * h_y / roll],
        [sideways / roll, 0.0],
        [0.2, 0.2 + 1.5 * 0.375 * 0.375],
        [1.459_140_429_597_651, -0.086_881_591_239_643],
        [0.464_803_926_879_362_6, -0.043_440_795_619_821_5],
        [1.5354, PI - asin],
        [19.62, -19.62],
        [1.0 - 0.0625 / 0.921_875, 1.0 + 0.0625 / 0.921_875],
    ]
}

#[test]
fn every_computed_value_differs_from_the_printed_one_and_is_right() {
    let (exit, output) = run(&["--json", "-"]);
    assert_eq!(exit, Exit::Reached, "{output}");
    let document: Value = serde_json::from_str(&output).expect("a document");
    let expected = by_hand();
    assert_eq!(document["checks"], expected.len());
    assert_eq!(document["shown"], expected.len());
    let errata = document["errata"].as_array().expect("errata");
    assert!(errata.len() > expected.len());
    for (erratum, expected) in errata.iter().zip(expected) {
        let check = &erratum["check"];
        let values = ["printed", "right"].map(|name| check[name].as_f64().expect("a number"));
        for (value, expected) in values.into_iter().zip(expected) {
            let size = expected.abs().max(1.0);
            assert!(
                (value - expected).abs() < 1e-9 * size,
                "{value} is not {expected}: {erratum}"
            );
        }
        assert_eq!(check["differs"], true, "{erratum}");
    }
    assert!(errata.last().expect("errata")["check"].is_null());
}

#[test]
fn the_text_has_places_values_and_commands() {
    let (exit, output) = run(&[]);
    assert_eq!(exit, Exit::Reached, "{output}");
    for part in [
        "[C] (4.7)\n",
        "  value     angular acceleration: printed 1.45914042959765",
        " | dalembert eval walker_foot_slip\n",
        "\n11 of 11 computed values differ from the printed ones",
    ] {
        assert!(output.contains(part), "{part}: {output}");
    }
}

#[test]
fn every_erratum_is_on_the_page() {
    let page = include_str!("../../../docs/theory/errata.md");
    for erratum in dalembert_command::errata::ERRATA {
        for source in ["[C] ", "[CB] ", "[CV] "] {
            if let Some((_, place)) = erratum.place.split_once(source) {
                let place = place.split([',', ';']).next().unwrap_or_default();
                assert!(page.contains(place), "{place} is missing");
            }
        }
    }
}
