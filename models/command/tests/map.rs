//! Maps of the walker against its known boundary, gait and multiplier.

// A test may fail by panicking.
#![allow(clippy::unwrap_used)]

mod support;

use dalembert_cli::Exit;
use support::run_on;

/// The rows of a map of the walker.
fn rows(flags: &[&str]) -> Vec<Vec<String>> {
    let walk = "map dimensionless_walker --returns 50 --fail theta>pi/2 --csv -";
    let quoted = flags.iter().map(|flag| format!(" '{flag}'"));
    let done = run_on("", &format!("{walk}{}", quoted.collect::<String>()));
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    done.output
        .lines()
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect()
}

/// The column of this name.
fn column<'t>(table: &'t [Vec<String>], name: &str) -> Vec<&'t str> {
    let place = table[0].iter().position(|it| it == name).unwrap();
    table[1..].iter().map(|row| row[place].as_str()).collect()
}

fn numbers(table: &[Vec<String>], name: &str) -> Vec<f64> {
    let texts = column(table, name).into_iter();
    texts.map(|text| text.parse().unwrap()).collect()
}

/// The boundary between starts that walk and starts that fall, in a column of the map of 400 x 400 cells.
fn boundary(eta: &str) -> [f64; 2] {
    let start = format!("eta={eta}");
    let table = rows(&[
        "--initial",
        &start,
        "--vary",
        "xi=-3..1:400",
        "--threads",
        "2",
    ]);
    let classes = column(&table, "class");
    let walks = |class: &&str| *class == "orbit 1 (period 1)";
    let falls = |class: &&str| *class == "failed at once";
    let first = classes.iter().position(falls).unwrap();
    assert!(classes[..first].iter().all(walks), "{classes:?}");
    assert!(classes[first..].iter().all(falls), "{classes:?}");
    let starts = numbers(&table, "in.xi");
    [starts[first - 1], starts[first]]
}

#[test]
fn the_walker_falls_beyond_a_known_boundary() {
    for (eta, expected) in [("0.03", -0.36), ("-2", -2.75)] {
        let [below, above] = boundary(eta);
        let cell = above - below;
        assert!(
            below - cell <= expected && expected <= above + cell,
            "{expected} is not near {below}..{above}"
        );
    }
}

#[test]
fn all_walks_tend_to_the_known_gait() {
    let table = rows(&[
        "--vary",
        "eta=-2..2:9",
        "--vary",
        "xi=-3..1:9",
        "--lyapunov",
        "12",
        "--threads",
        "2",
    ]);
    let (xi, eta) = (numbers(&table, "end.xi"), numbers(&table, "end.eta"));
    let exponents = numbers(&table, "exponent");
    let mut walks = 0;
    for (k, class) in column(&table, "class").into_iter().enumerate() {
        if class != "orbit 1 (period 1)" {
            assert_eq!(class, "failed at once");
            assert!(exponents[k].is_nan());
            continue;
        }
        walks += 1;
        assert!((xi[k] + 0.902_057_449_429_909_7).abs() < 1e-8, "{}", xi[k]);
        assert!(
            (eta[k] - 0.991_308_369_223_558_5).abs() < 1e-8,
            "{}",
            eta[k]
        );
        let multiplier = exponents[k].exp();
        assert!(
            (multiplier - 0.520_683_714_448_936_2).abs() < 1e-8,
            "{multiplier}"
        );
    }
    assert!(walks > 30, "{walks}");
}

#[test]
fn a_start_may_be_an_expression_of_what_is_varied() {
    let table = rows(&[
        "--vary",
        "alpha=0.3..0.5:3",
        "--start",
        "xi = -2*sin(alpha)",
        "--start",
        "eta = cos(delta)",
        "--contour",
        "xi",
        "--contour",
        "eta",
    ]);
    for (alpha, line) in numbers(&table, "in.alpha")
        .into_iter()
        .zip(numbers(&table, "contour.1"))
    {
        assert!((line + 2.0 * alpha.sin()).abs() < 1e-14, "{line}");
    }
    for line in numbers(&table, "contour.2") {
        assert!((line - 0.4_f64.cos()).abs() < 1e-14, "{line}");
    }
    assert_eq!(column(&table, "class"), ["period 1"; 3]);
}
