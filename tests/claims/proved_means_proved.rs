//! False claims that were once proved, and related ones: products of absolute values, exceptional parameters, densities
//! that are singular far from the origin, small periods, conditions of surfaces.

use dalembert_codegen::claims::{Finding, Verdict};
use dalembert_tests::claim::{Witness, verdict};

/// The finding on a claim of a declaration with this name.
fn finding(name: &str, declarations: &str, claim: &str) -> Finding {
    verdict(&format!(
        "{name} {{ {declarations} claims {{ {claim}; }} }}"
    ))
}

#[track_caller]
fn not_proved(declarations: &str, claim: &str) {
    let found = finding("Sample", declarations, claim);
    assert!(
        !matches!(found.verdict, Verdict::Proved(_)),
        "{claim} of {declarations}: {}",
        found.note()
    );
}

#[track_caller]
fn not_refuted(declarations: &str, claim: &str) {
    let found = finding("Sample", declarations, claim);
    assert!(
        !matches!(found.verdict, Verdict::Refuted(_)),
        "{claim} of {declarations}: {}",
        found.note()
    );
}

/// Drag in a box of three coordinates, a product of six ramps.
const BOX: &str = "coordinates { x; y; z; } parameters { c > 0 = 1; }
    let ramp(u) = (abs(u) + u)/2;
    let inside(u) = ramp(u - 10)*ramp(20 - u);
    lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
    forces { drag: -c*inside(x)*inside(y)*inside(z)*(dot(x)*d(x) + dot(y)*d(y) + dot(z)*d(z)); }";

#[test]
fn drag_in_a_box_is_seen_whatever_the_name_of_the_model() {
    for k in 0..12 {
        let name = format!("Sample{k}");
        for claim in [
            "conserved: energy",
            "conserved: momentum(x)",
            "density: exact",
        ] {
            let found = finding(&name, BOX, claim);
            assert!(
                !matches!(found.verdict, Verdict::Proved(_)),
                "{name}: {}",
                found.note()
            );
        }
        let found = finding(&name, BOX, "not conserved: energy");
        assert!(
            matches!(found.verdict, Verdict::Proved(_)),
            "{name}: {}",
            found.note()
        );
    }
}

/// A force that acts only in a box counts as a force.
#[test]
fn a_fan_that_blows_in_a_box_changes_the_momentum() {
    let fan = "coordinates { x; y; z; }
        let ramp(u) = (abs(u) + u)/2;
        let inside(u, a, b) = ramp(u - a)*ramp(b - u);
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        forces { fan: inside(x, 5, 6)*inside(y, 5, 6)*inside(z, 0, 1/2)*d(z); }";
    not_proved(fan, "conserved: dot(z)");
    not_refuted(fan, "not conserved: dot(z)");
}

#[test]
fn a_default_that_is_an_exception_is_no_proof() {
    let belt = |k: &str| {
        format!(
            "coordinates {{ x; y; }} parameters {{ k >= 0 = {k}; c > 0 = 1; }}
            lagrangian = (dot(x)^2 + dot(y)^2)/2;
            constraints {{ belt: dot(x) = k; }} forces {{ drag: -c*dot(y)*d(y); }}"
        )
    };
    not_proved(&belt("0"), "density: exact");
    let found = finding("Sample", &belt("1"), "density: exact");
    assert!(
        matches!(found.verdict, Verdict::Proved(_)),
        "{}",
        found.note()
    );
}

/// At a simple zero of `f` the leaf of `dx = f(x) dy` is a circle in `y`. The return map around it keeps no volume.
#[test]
fn densities_that_are_singular_far_out_are_not_proved() {
    for f in [
        "tanh(x - 40)",
        "1/(1 + exp(-20*(x - 10))) - 1/2",
        "1/(1 + (x - 50)^2) - 1/2",
        "exp(-(x - 50)^2) - 1/2",
        "1e30*exp(-x) - 1",
        "x^2 + k - 1",
        "(x - 50)^2",
        "x",
    ] {
        let rolling = format!(
            "coordinates {{ x; y: angle; }} parameters {{ k > 0 = 1000; }}
            lagrangian = (dot(x)^2 + dot(y)^2)/2; constraints {{ roll: dot(x) = ({f})*dot(y); }}"
        );
        not_proved(&rolling, "density: exact");
    }
    let regular = "coordinates { x; y: angle; } lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { roll: dot(x) = (x^4 - x^3 + 2)*dot(y); }";
    not_refuted(regular, "density: exact");
}

/// The logarithm of the growth is minus the integral of `f'` over the circle.
#[test]
fn closed_leaves_refute_with_their_multipliers() {
    let tau = std::f64::consts::TAU;
    for (f, place, growth) in [
        ("x", 0.0, -tau),
        ("tanh(x - 40)", 40.0, -tau),
        ("1/(1 + (x - 50)^2) - 1/2", 49.0, -tau / 2.0),
        ("1/(1 + exp(-20*(x - 10))) - 1/2", 10.0, -5.0 * tau),
        ("(x - 50)*(1 + x^2)", 50.0, -2501.0 * tau),
        (
            "x - 7 - 1/10*sqrt(1 + (x - 7)^2)",
            7.0 + 1.0 / 99f64.sqrt(),
            -tau * 0.99,
        ),
    ] {
        let rolling = format!(
            "coordinates {{ x; y: angle; }} lagrangian = (dot(x)^2 + dot(y)^2)/2;
            constraints {{ roll: dot(x) = ({f})*dot(y); }}"
        );
        let found = finding("Sample", &rolling, "density: exact");
        let Verdict::Refuted(witness) = found.verdict else {
            panic!("{f}: {}", found.note());
        };
        let [(name, period)] = witness.values.as_slice() else {
            panic!("{f}: {witness}");
        };
        assert_eq!(name, "period");
        assert!(
            (period - growth).abs() < 1e-9 * growth.abs(),
            "{f}: {witness}"
        );
        let (_, x) = &witness.sample.expect("a point").values[0];
        assert!((x - place).abs() < 1e-12 * (1.0 + place), "{f}: {x}");
        let local = finding("Sample", &rolling, "density: locally_exact");
        assert!(
            matches!(local.verdict, Verdict::Proved(_)),
            "{f}: {}",
            local.note()
        );
    }
}

#[test]
fn circles_without_growth_leave_the_question_open() {
    for f in ["(x - 50)^2", "(x - 50)^3", "x*(x - 1)^2*0 + x^3"] {
        let rolling = format!(
            "coordinates {{ x; y: angle; }} lagrangian = (dot(x)^2 + dot(y)^2)/2;
            constraints {{ roll: dot(x) = ({f})*dot(y); }}"
        );
        not_proved(&rolling, "density: exact");
        not_proved(&rolling, "density: locally_exact");
    }
}

#[test]
fn roots_that_do_not_vanish_far_out_are_certified() {
    let rolling = "coordinates { x; y: angle; } lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { roll: dot(x) = (sqrt(2 + (x - 40)^2) + x - 40)*dot(y); }";
    let found = finding("Sample", rolling, "density: exact");
    assert!(
        matches!(found.verdict, Verdict::Proved(_)),
        "{}",
        found.note()
    );
}

/// Forces far below the rounding errors of the other terms.
#[test]
fn small_forces_are_seen_at_a_point_of_76_digits() {
    for size in ["1e-12", "1e-18", "1e-25"] {
        let push = format!(
            "coordinates {{ x; th: angle; s; }} lagrangian = (dot(x)^2 + dot(th)^2 + dot(s)^2)/2;
            forces {{ push: {size}*sqrt(1 + sin(2*th)^2)*dot(s)*d(s) + dot(x)*d(th) - dot(th)*d(x); }}"
        );
        let found = finding("Sample", &push, "conserved: energy");
        assert!(
            matches!(found.verdict, Verdict::Refuted(_)),
            "{size}: {}",
            found.note()
        );
    }
}

/// Losses of energy far below rounding errors, at surfaces whose points have irrational coordinates.
#[test]
fn small_changes_in_impacts_are_seen_with_their_digits() {
    let energy = |wall: &str| {
        let declared = format!(
            "coordinates {{ x; y; }} lagrangian = (dot(x)^2 + dot(y)^2)/2; impacts {{ w: {wall}; }}"
        );
        finding("Sample", &declared, "conserved under w: energy")
    };
    for gap in ["sqrt(x^2 + y^2) - 1", "x^3 + y + x", "y + sin(x)"] {
        let lossy = energy(&format!("{gap} >= 0 => restitution(1 - 1e-20)"));
        assert!(
            matches!(lossy.verdict, Verdict::Refuted(_)),
            "{gap}: {}",
            lossy.note()
        );
        assert!(
            lossy.note().contains("difference = -"),
            "{gap}: {}",
            lossy.note()
        );
        let elastic = energy(&format!("{gap} >= 0"));
        assert!(
            matches!(elastic.verdict, Verdict::Proved(_)),
            "{gap}: {}",
            elastic.note()
        );
    }
}

/// The frame is `X1 = d_phi - cos(th) d_psi`, `X2 = d_th`, with the demands `X1(G) = I13/I11*sin(th)*cos(psi)` and
/// `X2(G) = -I13/I11*sin(psi)`. The bracket `[X1,[X1,X2]]` is 0, and its demand is `-I13/I11*sin(th)^2*sin(psi)`.
#[test]
fn obstructions_are_printed_with_the_digits_they_have() {
    let suslov = |i13: &str| {
        format!(
            "coordinates {{ phi: angle; th in (0, pi); psi: angle; }}
            parameters {{ I11 > 0 = 1; I22 > 0 = 2; I33 > 0 = 3; I13 = {i13}; I23 = 0; }}
            let o1 = dot(phi)*sin(th)*sin(psi) + dot(th)*cos(psi);
            let o2 = dot(phi)*sin(th)*cos(psi) - dot(th)*sin(psi);
            let o3 = dot(phi)*cos(th) + dot(psi);
            lagrangian = (I11*o1^2 + I22*o2^2 + I33*o3^2)/2 + I13*o1*o3 + I23*o2*o3;
            constraints {{ c: o3 = 0; }}"
        )
    };
    for i13 in ["1e-14", "1e-12", "1e-4"] {
        let found = finding("Sample", &suslov(i13), "density: exact");
        let Verdict::Refuted(refuted) = &found.verdict else {
            panic!("{}", found.note());
        };
        let text = refuted.to_string();
        let bracket = "[X1,[X1,X2]] = 0 as a vector field";
        assert!(text.contains(bracket), "{text}");
        let printed = Witness::of(&text).expect("numbers");
        let place = |name: &str| {
            let found = printed.at.iter().find(|(known, _)| known == name);
            found.unwrap_or_else(|| panic!("no `{name}` in {text}")).1
        };
        let slope = place("I13") / place("I11");
        let exact = -slope * place("th").sin().powi(2) * place("psi").sin();
        // Twelve digits are printed.
        let error = printed.value("delta") / exact - 1.0;
        assert!(error.abs() < 1e-11, "{error:e} in {text}");
    }
}

#[test]
fn small_and_narrow_periods_are_not_taken_for_none() {
    for slope in [
        "(1e-9 + 10*cos(th)*exp(sin(th)^3))*dot(th) + exp(-s^2)*dot(s)",
        "dot(th)*exp(-100000*(1 - cos(th)))",
    ] {
        let declared = format!(
            "coordinates {{ x; th: angle; s; }} lagrangian = (dot(x)^2 + dot(th)^2 + dot(s)^2)/2;
            forces {{ drag: -dot(x)*({slope})*d(x); }}"
        );
        not_proved(&declared, "density: exact");
        not_refuted(&declared, "density: locally_exact");
    }
}

#[test]
fn periods_count_where_an_enclosure_excludes_0() {
    let drag = |slope: &str| {
        format!(
            "coordinates {{ x; th: angle; s; }} lagrangian = (dot(x)^2 + dot(th)^2 + dot(s)^2)/2;
            forces {{ drag: -dot(x)*(({slope})*dot(th) + exp(-s^2)*dot(s))*d(x); }}"
        )
    };
    for slope in [
        "exp(sin(th)^3)",
        "1/10 + cos(th)*exp(sin(th)^3)",
        "exp(-100*(1 - cos(th)))",
    ] {
        let found = finding("Sample", &drag(slope), "density: locally_exact");
        let is_proved = matches!(found.verdict, Verdict::Proved(_));
        assert!(is_proved, "{slope}: {}", found.note());
    }
    // The printed digits are those of the period, not those of the cancelling sums.
    let small = drag("1e-7 + cos(th)*exp(sin(th)^3)");
    let found = finding("Sample", &small, "density: locally_exact");
    assert!(
        found.note().contains("exp(6.28318530718e-7)"),
        "{}",
        found.note()
    );
    let narrow = drag("1e-14 + cos(th)*exp(sin(th)^3)");
    not_proved(&narrow, "density: locally_exact");
    not_proved(&narrow, "density: exact");
}

/// The potential is infinite at a point of the circle, so that no motion makes the turn. A density that grows along the
/// turn is then single-valued.
#[test]
fn circles_that_no_motion_can_go_around_prove_nothing() {
    let charged = |potential: &str| {
        format!(
            "coordinates {{ x; y; th: angle; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(th)^2)/2 - {potential};
            forces {{ drag: -dot(y)*dot(th)*d(y); }}"
        )
    };
    for potential in ["1/sin(th)^2", "1/(1 - cos(3*th))", "ln(1 + sin(th))"] {
        not_proved(&charged(potential), "density: locally_exact");
        not_refuted(&charged(potential), "density: exact");
    }
    let found = finding(
        "Sample",
        &charged("1/(3 + sin(th))"),
        "density: locally_exact",
    );
    let is_proved = matches!(found.verdict, Verdict::Proved(_));
    assert!(is_proved, "{}", found.note());
}

/// Drags whose density may grow along a loop around a hole of Q.
#[test]
fn loops_around_what_is_left_out_are_not_forgotten() {
    for slope in [
        "(x*dot(y) - y*dot(x))/(x^2 + y^2)",
        "(x*dot(y) - y*dot(x))/((x - 3)^2 + y^2 + x^2 - (x - 3)^2)",
        "(x*dot(y) - y*dot(x))/(x^2 + y^2)*sqrt(x^2 + y^2 - 1)/sqrt(x^2 + y^2 - 1)",
    ] {
        let declared = format!(
            "coordinates {{ x; y; z; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
            forces {{ drag: -dot(z)*({slope})*d(z); }}"
        );
        not_proved(&declared, "density: exact");
        not_refuted(&declared, "density: locally_exact");
    }
    // The slope is an odd step function, written without absolute values. It is 0 between its steps. A reflection maps
    // one part of Q to another.
    let steps = "coordinates { x; z; th: angle; s; }
        lagrangian = (dot(x)^2 + dot(z)^2 + dot(th)^2 + dot(s)^2)/2;
        let step(u) = atan(u) + atan(1/u);
        forces { drag: -dot(z)*((step(x - 1) + step(x + 1))*dot(th) + exp(-s^2)*dot(s))*d(z); }";
    not_proved(steps, "density: exact");
    not_refuted(steps, "density: locally_exact");
    // A plane or a line has no hole for a loop to lead around.
    for slope in [
        "exp(-x^2)*dot(x)",
        "exp(-x^2)*dot(x)/x",
        "exp(-x^2)/(1 + x^2)*dot(x) + exp(-y^2)*dot(y)",
    ] {
        let declared = format!(
            "coordinates {{ x; y; z; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
            forces {{ drag: -dot(z)*({slope})*d(z); }}"
        );
        let found = finding("Sample", &declared, "density: exact");
        let is_proved = matches!(found.verdict, Verdict::Proved(_));
        assert!(is_proved, "{slope}: {}", found.note());
    }
}

#[test]
fn periods_that_vanish_by_symmetry_are_proved_to() {
    let declared = "coordinates { x; th: angle; s; }
        lagrangian = (dot(x)^2 + dot(th)^2 + dot(s)^2)/2;
        forces { drag: -dot(x)*(10*cos(th)*exp(sin(th)^3)*dot(th) + exp(-s^2)*dot(s))*d(x); }";
    let found = finding("Sample", declared, "density: exact");
    assert!(
        matches!(found.verdict, Verdict::Proved(_)),
        "{}",
        found.note()
    );
}

#[test]
fn parts_of_a_surface_that_do_not_count_refute_nothing() {
    let declared = "coordinates { x; } lagrangian = dot(x)^2/2;
        impacts { v: (x - 3)*(x + 3) <= 0 when x > 0; }";
    not_refuted(declared, "conserved under v: (x - 3)*dot(x)");
    not_proved(declared, "not conserved under v: (x - 3)*dot(x)");
}

/// Coordinates in separate potentials with roots and logarithms.
fn wells(count: usize) -> String {
    format!(
        "coordinates {{ x[{count}]; }}
        lagrangian = sum(i in 1..={count}: dot(x[i])^2/2 - sqrt(1 + x[i]^2) - x[i]^2*ln(2 + x[i]^2));"
    )
}

/// Bodies in the plane that attract each other, and their angular momentum.
const BODIES: &str = "const N = 5;
    coordinates { x[N]; y[N]; }
    parameters { m[N] > 0 = 1; }
    lagrangian = sum(i in 1..=N: m[i]*(dot(x[i])^2 + dot(y[i])^2)/2)
        + sum(i in 1..=N - 1: sum(j in i + 1..=N: m[i]*m[j]/sqrt((x[i] - x[j])^2 + (y[i] - y[j])^2)));
    let moment = sum(i in 1..=N: m[i]*(x[i]*dot(y[i]) - y[i]*dot(x[i])));";

/// Forces of any degree in the velocities. A density of the configuration needs a divergence that is linear in the
/// velocities. A stated density may balance a divergence of any degree.
#[test]
fn forces_of_higher_degree_are_decided() {
    let pushed = |default: &str, forces: &str| {
        format!(
            "coordinates {{ x; y; }} parameters {{ c >= 0 = {default}; }}
            lagrangian = (dot(x)^2 + dot(y)^2)/2; forces {{ push: {forces}; }}"
        )
    };
    let (cubic, lift, fluid, across) = (
        "-c*dot(x)^3*d(x)",
        "c*dot(x)^2*dot(y)*d(x) - c*dot(x)^3*d(y)",
        "-c*sqrt(dot(x)^2 + dot(y)^2)*(dot(x)*d(x) + dot(y)*d(y))",
        "c*dot(y)^3*d(x) + c*dot(x)^5*d(y)",
    );
    for (forces, claim) in [
        (cubic, "density: none"),
        (cubic, "density = 1/abs(dot(x))^3"),
        (lift, "density: none"),
        (lift, "density = 1/dot(x)^2"),
        (fluid, "density: none"),
        (fluid, "density = (dot(x)^2 + dot(y)^2)^(-3/2)"),
        (across, "density: exact"),
        (across, "density = 1"),
    ] {
        let found = finding("Sample", &pushed("1", forces), claim);
        let is_proved = matches!(found.verdict, Verdict::Proved(_));
        assert!(is_proved, "{claim} of {forces}: {}", found.note());
    }
    for (forces, claim) in [
        (cubic, "density: exact"),
        (cubic, "density = 1/abs(dot(x))^2"),
        (across, "density: none"),
        (fluid, "density = 1/(dot(x)^2 + dot(y)^2)"),
    ] {
        let found = finding("Sample", &pushed("1", forces), claim);
        let is_refuted = matches!(found.verdict, Verdict::Refuted(_));
        assert!(is_refuted, "{claim} of {forces}: {}", found.note());
    }
    // If the force vanishes at the default, there is a density.
    not_proved(&pushed("0", cubic), "density: none");
    not_refuted(&pushed("0", cubic), "density: exact");
    // On D the velocities are equal, and the cubic forces cancel.
    let wheel = "coordinates { x; th: angle; } parameters { c > 0 = 1; } lagrangian = (dot(x)^2 + dot(th)^2)/2;
        constraints { roll: dot(x) = dot(th); } forces { drag: -c*dot(x)^3*d(th) + c*dot(th)^3*d(x); }";
    let found = finding("Sample", wheel, "density: none");
    let is_proved = matches!(found.verdict, Verdict::Proved(_));
    assert!(!is_proved, "{}", found.note());
}

#[test]
fn many_roots_and_logarithms_are_no_obstacle() {
    let proved = |declared: &str, claim: &str| {
        let found = finding("Sample", declared, claim);
        // A proof with a large probability of error is not a proof.
        let is_proved = matches!(&found.verdict, Verdict::Proved(proof) if proof.error < 1e-12);
        assert!(is_proved, "{claim} of {declared}: {}", found.note());
    };
    for count in [9, 12, 30] {
        proved(&wells(count), "conserved: energy");
        proved(&wells(count), "density: exact");
        let pushed = format!("{} forces {{ push: 1e-30*d(x[1]); }}", wells(count));
        not_proved(&pushed, "conserved: energy");
    }
    proved(BODIES, "conserved: energy");
    proved(BODIES, "conserved: moment");
    not_proved(BODIES, "not conserved: moment");
    let pushed = format!("{BODIES} forces {{ push: 1e-30*d(x[1]); }}");
    not_proved(&pushed, "conserved: moment");
}
