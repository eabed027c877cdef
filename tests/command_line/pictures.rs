use super::*;

/// Runs `simulate` with `--plot` and returns the picture.
fn picture(name: &str, flags: &str) -> String {
    let file = format!("dalembert-picture-{name}-{}.svg", std::process::id());
    let path = std::env::temp_dir().join(file);
    let done = run(&format!("simulate {flags} --plot {}", path.display()));
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let svg = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    svg
}

/// The polyline of a picture that has the most points, in units of the picture.
fn longest(svg: &str) -> Vec<[f64; 2]> {
    let lines = svg.split("points=\"").skip(1).map(|rest| {
        let points = rest.split('"').next().unwrap();
        points
            .split_whitespace()
            .map(|point| {
                let (x, y) = point.split_once(',').unwrap();
                [x.parse().unwrap(), y.parse().unwrap()]
            })
            .collect()
    });
    lines.max_by_key(Vec::<[f64; 2]>::len).unwrap()
}

#[test]
fn a_phase_portrait_of_an_oscillator_is_an_ellipse() {
    // Coordinate and velocity are cos(t) and -sin(t).
    let svg = picture(
        "ellipse",
        "oscillator --set k=4 --until 6.5 --axes x.1,x_dot.1",
    );
    let points = longest(&svg);
    assert!((40..250).contains(&points.len()), "{}", points.len());
    let middle_and_half = |axis: usize| {
        let values = points.iter().map(|point| point[axis]);
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        (0.5 * (low + high), 0.5 * (high - low))
    };
    let axes = [middle_and_half(0), middle_and_half(1)];
    for point in &points {
        let [x, y] = [0, 1].map(|axis| (point[axis] - axes[axis].0) / axes[axis].1);
        assert!((x.hypot(y) - 1.0).abs() < 2e-3, "{x} {y}");
    }
    assert!(svg.contains("\nx₁\n") && svg.contains("\nx\u{307}₁\n"));
}

#[test]
fn quantities_are_drawn_over_time_with_their_groups() {
    let svg = picture(
        "momenta",
        "oscillator --set k=4 --axes t,p,outputs,energy_error",
    );
    for name in ["p_x₁", "p_x₂", "radius", "relative change of the energy"] {
        assert!(svg.contains(&format!("\n{name}\n")), "{name}");
    }
    let svg = picture("bounces", "bouncing_ball --until 10 --axes t,x_dot");
    assert!(svg.contains("impact: floor (4)"));
    assert!(svg.contains("<svg width=\"900\""));
}

#[test]
fn a_picture_is_as_wide_as_it_is_asked_to_be() {
    for flags in [
        "oscillator --set k=4",
        "oscillator --set k=4 --axes x.1,energy",
        "bouncing_ball --until 10",
    ] {
        let svg = picture("narrow", &format!("{flags} --plot-width 480"));
        assert!(svg.starts_with("<svg width=\"480\""), "{flags}");
    }
}

#[test]
fn axes_that_do_not_exist_are_refused_by_name() {
    let refused = |axes: &str| {
        let done = run(&format!(
            "simulate bouncing_ball --until 1 --plot never.svg {axes}"
        ));
        assert_eq!(done.exit, Exit::Refused, "{axes}: {}", done.output);
        done.errors
    };
    let error = refused("--axes x,speed");
    assert!(
        error.contains("--axes: unknown quantity `speed`"),
        "{error}"
    );
    assert!(
        error.contains("t, x, x_dot, p_x, energy, energy_error, q, qdot, p, outputs"),
        "{error}"
    );
    for axes in ["--axes x", "--axes t,outputs"] {
        assert!(refused(axes).contains("an abscissa and at least one ordinate"));
    }
    assert!(refused("--axes q,t").contains("one quantity as the abscissa"));
    let done = run("simulate bouncing_ball --until 1 --axes t,x");
    assert_eq!(done.exit, Exit::Refused);
    assert!(done.errors.contains("--plot"), "{}", done.errors);
}
