//! Models that are accepted, and the remarks on them.

use dalembert_codegen::diagnostics::Diagnostics;
use dalembert_codegen::model::{Assumption, Law, Model, Topology, check};
use dalembert_codegen::spec;
use dalembert_expr::{ExprId, Pool, SymbolId};

const DISK: &str = "
    /// Vertical rolling disk on an elliptical table.
    pub RollingDisk {
        coordinates { x; y; theta: angle; phi: angle; }
        parameters  { m > 0 = 0.0025; R > 0 = 0.01; I > 0 = 1.25e-7; J > 0 = 6.25e-8; ta > 0 = 0.15; tb > 0 = 0.20; }
        let table(u, v) = 1 - u^2/ta^2 - v^2/tb^2;
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + J/2*dot(phi)^2;
        constraints {
            rolling_x: d(x) - R*cos(phi)*d(theta) = 0;
            rolling_y: dot(y) = R*sin(phi)*dot(theta);
        }
        impacts {
            leading_edge:  table(x + R*cos(phi), y + R*sin(phi)) >= 0;
            trailing_edge: table(x - R*cos(phi), y - R*sin(phi)) >= 0;
        }
        initial { phi = pi/2; dot(theta) = 10; dot(phi) = 0.2; until = 20; }
        view    { path: (x, y); region: table(x, y) >= 0; }
        outputs { load: multiplier(rolling_x); e: energy; p: momentum(theta); }
    }";

const BALL: &str = "
    BallOnRotatingTable {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters { m > 0 = 1; r > 0 = 1; I > 0 = 0.4; Om = 2; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2)
            + I/2*(dot(theta)^2 + dot(psi)^2 + dot(phi)^2 + 2*dot(psi)*dot(phi)*cos(theta));
        constraints {
            roll_x: dot(x) + r*sin(theta)*cos(psi)*dot(phi) - r*sin(psi)*dot(theta) = -Om*y;
            roll_y: dot(y) + r*sin(theta)*sin(psi)*dot(phi) + r*cos(psi)*dot(theta) = Om*x;
        }
    }";

fn chain(links: usize) -> String {
    format!(
        "Chain {{
            const N = {links};
            coordinates {{ theta[N]: angle; }}
            parameters {{ m[N] > 0 = 1; l > 0 = 0.5; g > 0 = 9.81; }}
            let X[0] = 0;
            let Y[0] = 0;
            let X[i in 1..=N] = X[i-1] + l*sin(theta[i]);
            let Y[i in 1..=N] = Y[i-1] - l*cos(theta[i]);
            lagrangian = sum(i in 1..=N: m[i]/2*(dot(X[i])^2 + dot(Y[i])^2) - m[i]*g*Y[i]);
            initial {{ theta[i in 1..=N] = 0.1*i; }}
            outputs {{ tip: X[N]; }}
        }}"
    )
}

fn read(source: &str) -> Result<Model, Diagnostics> {
    let spec = spec::parse(source.parse().unwrap())?;
    check(&spec)
}

fn model(source: &str) -> Model {
    read(source).unwrap_or_else(|diagnostics| panic!("{}", all_messages(&diagnostics)))
}

fn all_messages(diagnostics: &Diagnostics) -> String {
    diagnostics
        .iter()
        .map(|error| format!("{}\n", error.message()))
        .collect()
}

fn text(pool: &Pool, exprs: &[dalembert_expr::ExprId]) -> Vec<String> {
    exprs.iter().map(|expr| pool.text(*expr)).collect()
}

#[test]
fn the_rolling_disk_is_taken_apart() {
    let model = model(DISK);
    assert_eq!(
        (model.name.as_str(), model.snake_name.as_str()),
        ("RollingDisk", "rolling_disk")
    );
    assert_eq!(model.visibility, "pub");
    assert_eq!(
        model.documentation,
        ["Vertical rolling disk on an elliptical table."]
    );
    assert_eq!(model.coordinates[2].topology, Topology::Angle);
    assert_eq!(model.parameters[0].assumption, Assumption::Positive);
    let pool = &model.pool;
    assert_eq!(
        text(pool, &model.lagrangian.metric[0]),
        ["m", "0", "0", "0"]
    );
    assert_eq!(
        text(pool, &model.lagrangian.metric[3]),
        ["0", "0", "0", "J"]
    );
    assert_eq!(
        text(pool, &model.constraints[0].form),
        ["1", "0", "-R*cos(phi)", "0"]
    );
    assert_eq!(
        text(pool, &model.constraints[1].form),
        ["0", "1", "-R*sin(phi)", "0"]
    );
    assert!(
        model
            .constraints
            .iter()
            .all(|constraint| constraint.level.is_none())
    );
    assert_eq!(model.surfaces.len(), 2);
    assert_eq!(model.surfaces[0].law, Law::Elastic);
    assert_eq!(
        model
            .initial
            .q
            .iter()
            .filter(|value| value.is_some())
            .count(),
        1
    );
    assert!(model.initial.until.is_some());
    let view = model.view.unwrap();
    assert_eq!(view.plane, Some([0, 1]));
    assert_eq!(view.labels, ["x", "y"]);
    assert_eq!(
        text(pool, &[model.outputs[0].value]),
        ["multiplier(rolling_x)"]
    );
    assert_eq!(model.notes, Vec::<String>::new());
}

#[test]
fn the_text_of_a_model_declares_the_same_model() {
    let first = model(DISK);
    assert!(
        first
            .source
            .contains("let table(u, v) = 1 - u^2/ta^2 - v^2/tb^2;"),
        "{}",
        first.source
    );
    assert_eq!(model(&first.source).source, first.source);
}

#[test]
fn affine_constraints_keep_their_affine_part() {
    let model = model(BALL);
    let values = |symbol: SymbolId| 2.0 + symbol.index() as f64;
    let rate = values(model.parameters[3].symbol);
    let [x, y] = [0, 1].map(|index: usize| values(model.coordinates[index].q));
    let affine = model.pool.eval(
        &[model.constraints[0].affine, model.constraints[1].affine],
        &values,
    );
    assert_eq!(affine, [rate * y, -rate * x]);
    assert!(
        model
            .constraints
            .iter()
            .all(|constraint| constraint.level.is_none())
    );
    assert_eq!(
        text(&model.pool, &model.lagrangian.metric[2]),
        ["0", "0", "I", "0", "I*cos(theta)"]
    );
}

#[test]
fn a_chain_is_written_out() {
    let model = model(&chain(3));
    let names: Vec<&str> = model
        .coordinates
        .iter()
        .map(|coordinate| coordinate.name.display.as_str())
        .collect();
    assert_eq!(names, ["theta.1", "theta.2", "theta.3"]);
    assert_eq!(model.parameters.len(), 5);
    assert_eq!(text(&model.pool, &[model.initial.q[1].unwrap()]), ["1/5"]);
}

#[test]
fn a_chain_of_sixteen_links_is_checked_fast() {
    let started = std::time::Instant::now();
    let model = model(&chain(16));
    println!("{:?}, {} nodes", started.elapsed(), model.pool.len());
    assert!(model.pool.len() < 60_000, "{} nodes", model.pool.len());
}

/// A particle in space with one constraint.
fn constrained(constraint: &str) -> Model {
    model(&format!(
        "P {{ coordinates {{ x; y; z; }} parameters {{ m > 0 = 1; v; l > 0 = 1; }}
            let circle = x^2 + y^2;
            lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(z)^2);
            constraints {{ c: {constraint}; }}
            outputs {{ o: v + l; }} }}"
    ))
}

#[test]
fn constraints_written_as_a_derivative_keep_their_level() {
    let level = |constraint: &str| {
        let model = constrained(constraint);
        let values = |symbol: SymbolId| 2.0 + symbol.index() as f64;
        let [x, y, _] = [0, 1, 2].map(|index: usize| values(model.coordinates[index].q));
        let [v, l] = [1, 2].map(|index: usize| values(model.parameters[index].symbol));
        let level = model.constraints[0]
            .level
            .map(|level| model.pool.eval(&[level], &values)[0]);
        (level, [x, y, v, l, values(model.time)])
    };
    let (value, [x, y, ..]) = level("d(circle) = 0");
    assert_eq!(value, Some(x * x + y * y));
    let (value, [x, y, _, l, _]) = level("d(x) - l*d(y) = 0");
    assert_eq!(value, Some(x - l * y));
    let (value, [x, _, v, _, t]) = level("dot(x) = v");
    assert_eq!(value, Some(x - v * t));
    let (value, [x, _, v, _, t]) = level("d(x)/2 = v*d(t)");
    assert_eq!(value, Some(x / 2.0 - v * t));
    assert_eq!(level("x*dot(x) + y*dot(y) = 0").0, None);
}

#[test]
fn equations_of_positions_are_constraints() {
    let model = constrained("circle + t = l^2");
    let constraint = &model.constraints[0];
    let values = |symbol: SymbolId| 2.0 + symbol.index() as f64;
    let at = |id: ExprId| model.pool.eval(&[id], &values)[0];
    let [x, y, _] = [0, 1, 2].map(|index: usize| values(model.coordinates[index].q));
    let (l, t) = (values(model.parameters[2].symbol), values(model.time));
    assert!(constraint.is_of_positions);
    assert_eq!(constraint.level.map(at), Some(x * x + y * y + t - l * l));
    assert_eq!(
        constraint
            .form
            .iter()
            .map(|entry| at(*entry))
            .collect::<Vec<_>>(),
        [2.0 * x, 2.0 * y, 0.0]
    );
    assert_eq!(at(constraint.affine), 1.0);
    assert!(!constrained("d(circle) = 0").constraints[0].is_of_positions);
}

#[test]
fn integrable_constraints_are_noted() {
    let note = |constraint: &str| constrained(constraint).notes.join("; ");
    assert!(
        note("x*dot(x) + y*dot(y) = 0").starts_with("`c` is integrable: write it as `d(f) = 0`")
    );
    assert!(note("d(x)/x + d(y)/x = 0").starts_with("`c` is integrable with a factor"));
    assert_eq!(note("d(z) - y*d(x) = 0"), "");
    assert_eq!(note("d(x) = 0"), "");
}

#[test]
fn differences_that_lose_their_digits_are_noted() {
    let notes = |potential: &str| {
        let source = format!(
            "P {{ coordinates {{ x; theta: angle; }} parameters {{ k > 0; s; }}
                lagrangian = (dot(x)^2 + dot(theta)^2)/2 - s*x - ({potential}); }}"
        );
        let notes = model(&source).notes.into_iter();
        let notes = notes.filter(|note| note.contains("loses its digits"));
        notes.collect::<Vec<_>>().join("; ")
    };
    for (potential, note) in [
        (
            "k*(1 - cos(theta))",
            "`1 - cos(theta)` in `lagrangian` loses its digits near `theta = 0`: write `2*sin(theta/2)^2`",
        ),
        (
            "k - k*cos(2*theta)",
            "`1 - cos(2*theta)` in `lagrangian` loses its digits near `2*theta = 0`: write `2*sin(theta)^2`",
        ),
        (
            "cosh(x) - 1",
            "`cosh(x) - 1` in `lagrangian` loses its digits near `x = 0`: write `2*sinh(x/2)^2`",
        ),
        (
            "k*exp(-x) - k",
            "`exp(-x) - 1` in `lagrangian` loses its digits near `-x = 0`: write `-2*exp(-x/2)*sinh(x/2)`",
        ),
        (
            "3*sqrt(1 + x) - 3",
            "`sqrt(x + 1) - 1` in `lagrangian` loses its digits near `x = 0`: write `x/(sqrt(x + 1) + 1)`",
        ),
        (
            "(sqrt(k^2 + x^2) - k)^2",
            "`sqrt(k^2 + x^2) - k` in `lagrangian` loses its digits near `x^2 = 0`: write `x^2/(k + sqrt(k^2 + x^2))`",
        ),
        ("2*sin(theta/2)^2 + 1 + cos(theta)", ""),
        ("2 - cos(theta)", ""),
        ("sqrt(2 + x) - 1", ""),
        ("sqrt(k^2 + x^2) + k", ""),
        ("k*(1 - cos(s))", ""),
        ("exp(1 + x^2) - 1", ""),
    ] {
        assert_eq!(notes(potential), note, "{potential}");
    }
}

#[test]
fn remarks_name_likely_mistakes() {
    let model = model(
        "P { coordinates { x; y; } parameters { m; k; }
            lagrangian = m/2*(dot(x)^2 + dot(y)^2) + x*dot(y);
            constraints { c: d(x) - y*d(y) = 0; }
            impacts { w: y >= 1 => totally_plastic; } }",
    );
    let notes = model.notes.join("\n");
    assert!(
        notes.contains("terms linear in the velocities of `y`"),
        "{notes}"
    );
    assert!(
        notes.contains("positive only where `m > 0` (entry (x, x))"),
        "{notes}"
    );
    assert!(
        notes.contains("`totally_plastic` multiplies the gap rate of `w` by 1 - rho, rho = "),
        "{notes}"
    );
    assert!(notes.contains("the parameter `k` is not used"), "{notes}");
}

#[test]
fn angles_may_be_used_in_disguise() {
    model(
        "P { coordinates { a: angle; b: angle; } parameters { w; }
            lagrangian = dot(a)^2 + dot(b)^2 + sin(a/2)^2 + cos(2*a - b + w*t) + tan(a)^2;
            impacts { h: cos(a - pi/3) >= 1/2 when sin(b) > 0; }
            outputs { turns: a/(2*pi); } }",
    );
}

#[test]
fn a_chain_of_sixty_lets_doubles_nothing() {
    let mut source = String::from("P { coordinates { x; } let a0 = x; let f(u) = u + u^2;");
    for level in 1..60 {
        source.push_str(&format!("let a{level} = f(a{0})*a{0};", level - 1));
    }
    source.push_str("lagrangian = dot(x)^2 - a59; }");
    assert!(model(&source).pool.len() < 5_000);
}

#[test]
fn plastic_laws_report_where_the_state_still_approaches() {
    let notes = |law: &str, constraint: &str| {
        let model = model(&format!(
            "P {{ coordinates {{ x; y; z; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
                constraints {{ {constraint} }} impacts {{ w: x >= 0 => {law}; }} }}"
        ));
        model.notes.join("\n")
    };
    let rolling = "c: d(x) - z*d(y) = 0;";
    let half = notes("nonholonomic_plastic", rolling);
    assert!(half.contains("by 1 - 2 rho"), "{half}");
    assert!(
        half.contains("where rho < 1/2 the state still approaches"),
        "{half}"
    );
    let whole = notes("totally_plastic", rolling);
    assert!(
        whole.contains("where rho < 1 the state still approaches"),
        "{whole}"
    );
    assert_eq!(notes("impact_plastic", rolling), "");
    assert_eq!(notes("totally_plastic", ""), "");
}

#[test]
fn resets_after_which_the_motion_passes_are_noted() {
    let notes = |motion: &str, reset: &str| {
        let model = model(&format!(
            "P {{ coordinates {{ x; y; z; }} {motion} impacts {{ w: x - z*t >= 0 => reset {{ {reset} }}; }} }}"
        ));
        model.notes.join("\n")
    };
    let free = "lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;";
    let passes = "the reset of `w` leaves its gap and the gap rate as they are";
    for reset in ["dot(y) = -dot(y);", "y = 0;", "z = z + 0; dot(y) = 1;"] {
        assert!(notes(free, reset).contains(passes), "{reset}");
    }
    for reset in [
        "",
        "dot(x) = -dot(x);",
        "dot(z) = 0;",
        "x = x + 1;",
        "z = 0; dot(y) = 1;",
    ] {
        assert_eq!(notes(free, reset), "", "{reset}");
    }
    let field = "field { dot(x) = y; dot(y) = -x; dot(z) = 0; }";
    assert!(notes(field, "x = z*t + (x - z*t);").contains(passes));
    assert_eq!(notes(field, "y = -y;"), "");
}

#[test]
fn coefficients_that_may_leave_the_unit_interval_are_noted() {
    let notes = |parameter: &str, coefficient: &str| {
        let model = model(&format!(
            "P {{ coordinates {{ x; }} parameters {{ {parameter}; }} lagrangian = dot(x)^2/2;
                impacts {{ w: x >= 0 => newton({coefficient}); }} }}"
        ));
        model.notes.join("\n")
    };
    assert_eq!(
        notes("e > 0 = 0.5", "e"),
        "the coefficient `e` of `w` is not known to lie in [0, 1] and checked when a state is made; declare `e in [0, 1]`"
    );
    assert!(notes("e > 0", "e/2").ends_with("checked when a state is made"));
    assert!(notes("e in [0, 2]", "1 - e").contains("`w`"));
    for inside in ["e", "1 - e", "e^2/2", "sqrt(e)", "exp(-e)", "abs(sin(7*e))"] {
        assert_eq!(notes("e in [0, 1]", inside), "", "{inside}");
    }
    assert_eq!(notes("e >= 0", "1/(1 + e)"), "");
}

#[test]
fn members_of_a_family_may_stand_anywhere_in_a_section() {
    let model = model(
        "P { coordinates { x; y; } lagrangian = dot(x)^2 + dot(y)^2;
            impacts { side[2]: x <= 1; floor: y >= 0; side[1]: x >= -1; side[3]: x + y <= 3; } }",
    );
    let names: Vec<&str> = model
        .surfaces
        .iter()
        .map(|surface| surface.name.display.as_str())
        .collect();
    assert_eq!(names, ["side.2", "floor", "side.1", "side.3"]);
}

#[test]
fn terms_that_cancel_are_dropped() {
    let model = model(
        "P { coordinates { x; y; } parameters { m > 0; }
            let one = sin(x)^2 + cos(x)^2;
            lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (one - 1)*(dot(x)*dot(y) + dot(x) - y)
                + x*dot(x) - dot(x)*x;
            constraints { c: one*dot(x) = y*dot(y) + (x + 1)^2 - x^2 - 2*x - one; } }",
    );
    let lagrangian = &model.lagrangian;
    assert_eq!(text(&model.pool, &lagrangian.linear), ["0", "0"]);
    assert_eq!(text(&model.pool, &lagrangian.metric[0]), ["m", "0"]);
    assert_eq!(text(&model.pool, &[lagrangian.potential]), ["0"]);
    assert_eq!(text(&model.pool, &[model.constraints[0].affine]), ["0"]);
    let says_linear = |note: &String| note.contains("terms linear in the velocities");
    assert!(!model.notes.iter().any(says_linear), "{:?}", model.notes);
}

#[test]
fn regular_gaps_are_accepted() {
    let gaps = [
        "1 - x^2/k^2 - y^2/m^2",
        "x*y",
        "x^2 - y^2",
        "abs(x) - 1",
        "k^2*x^2 - 2*k*x + m",
        // The repeated factor is never zero, or zero outside of the chart only.
        "(x^2 + 1)^2*(x - 1)",
        "(u - 2)^2*(u - 1/2)",
        "(u - 2)^2*(y - u)",
        "(y - t)*(y - t - 1)",
    ];
    for gap in gaps {
        model(&format!(
            "P {{ coordinates {{ x; y; u in (0, 1); }} parameters {{ m > 0; k > 0; }}
                lagrangian = dot(x)^2 + dot(y)^2 + dot(u)^2; impacts {{ w: {gap} >= 0; }} }}"
        ));
    }
}

#[test]
fn a_coefficient_that_is_zero_wherever_the_others_have_values_makes_no_constraint_affine() {
    let source = "Ellipse { coordinates { x; y; z; } parameters { a > 0 = 1; b > 0 = 2; }
        let s = sqrt(a^2*sin(z)^2 + b^2*cos(z)^2);
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { c: dot(x) = dot(z)*s + dot(y)*sin(z)*cos(z)/s; } }";
    let spec = spec::parse(source.parse().unwrap()).unwrap();
    let model = check(&spec).unwrap();
    assert!(model.pool.is_syntactic_zero(model.constraints[0].affine));
}
