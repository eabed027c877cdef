//! First variations: two-form and volume (section F); saltation matrices, traces and grazing impacts (section G).

use dalembert::integrate::Chosen;
use dalembert::math::larger;
use dalembert::variations::Section;
use dalembert::{
    Observer, Outcome, Run as Ran, Scene, SceneEffects, Simulation, StateVector, System, Tangent,
    Taylor, Tolerance, Undefined, Variations, VectorField,
};
use dalembert_cli::suite::{Case, Report, Run};

use super::course::{U, vector};
use super::tables::elliptic_table;
use super::text::{Model, Text, shipped, value};

/// Two fields with a switch between them at a bent line; the coordinate `s` selects the field.
static SWITCHED: Text = Text::new(
    "Switched {
        coordinates { x; y; s; }
        field {
            dot(x) = 1 + (1 - s)*y^2 + s*sin(x);
            dot(y) = (1 - s)*(1/2 - x) + s*(2 + cos(y));
            dot(s) = 0;
        }
        impacts { line: 1 - x - y^2/4 >= 0 => reset { s = 1; }; }
    }",
);

/// A ball that falls and bounces.
static DROPPED: Text = Text::new(
    "Dropped {
        coordinates { x; }
        parameters { g = 9.81; e in [0, 1] = 3/4; }
        lagrangian = dot(x)^2/2 - g*x;
        impacts { floor: x >= 0 => restitution(e); }
    }",
);

/// A free point in a corner.
static QUADRANT: Text = Text::new(
    "Quadrant {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { right: x <= 1; above: y <= 1; }
    }",
);

/// The cases.
pub const CASES: &[Case] = &[
    Case {
        id: "F12",
        title: "two-form and volume across elastic impacts",
        right: "det = 1, J^T W J = W",
        bound: "1e-11 per 100 impacts",
        run: Run::Once(symplectic),
        ..Case::QUICK
    },
    Case {
        id: "G08",
        title: "an identity reset between fields f and g",
        right: "the differential has the determinant dh(g)/dh(f)",
        bound: "64 u",
        run: Run::Once(identity_reset),
        ..Case::QUICK
    },
    Case {
        id: "G09",
        title: "two bounces along the axes of an ellipse, half axes 2 and 1",
        right: "traces -1 (minor axis) and 194 (major), determinant 1",
        bound: "1e-10",
        run: Run::Once(axes_of_an_ellipse),
        ..Case::QUICK
    },
    Case {
        id: "G10",
        title: "a dropped ball that bounces once: derivatives in e, g, height and time",
        right: "those of x(T) = e g t1 (T - t1) - g (T - t1)^2/2, t1 = sqrt(2 h0/g)",
        bound: "1e-12",
        run: Run::Once(dropped),
        ..Case::QUICK
    },
    Case {
        id: "G11",
        title: "derivatives through a graze, and near one",
        right: "undefined within rounding of a graze; the closed form at 1e-4 and 1e-8 from it",
        bound: "`graze`; 64 u over the distance",
        run: Run::Once(grazes),
        ..Case::QUICK
    },
    Case {
        id: "G12",
        title: "two impacts 5e-13 apart, within 1e-12 of the end",
        right: "the same derivatives in either order; at one time, none",
        bound: "1e-11; `corner`",
        run: Run::Once(two_at_the_end),
        ..Case::QUICK
    },
];

/// Tangents along each component of the state.
fn all_components(system: &Model) -> Vec<Tangent<Model>> {
    (0..system.state_len()).map(Tangent::of_component).collect()
}

/// A run with the derivatives of its end.
struct Varied {
    run: Ran<<Model as VectorField>::State>,
    columns: Result<Vec<Tangent<Model>>, Undefined>,
}

/// Makes a run from positions and velocities until a time or a number of impacts.
fn vary(
    system: &Model,
    (q, qdot): (&[f64], &[f64]),
    (until, impacts): (f64, Option<u64>),
    mut columns: Vec<Tangent<Model>>,
) -> Option<Varied> {
    let state = system.state(0.0, &vector(q), &vector(qdot)).ok()?;
    let mut stepper = Taylor::new(Tolerance::new(1e-15).ok()?);
    let stepper = Chosen::new(&mut stepper);
    let mut effects = system.effects();
    effects.set_impact_budget(impacts);
    let mut variations = Variations::new(system, &mut columns);
    let observer: &mut dyn Observer<Model> = &mut variations;
    let run = Simulation::new(system, stepper, effects)
        .run(0.0, state, until, &mut { observer })
        .ok()?;
    let columns = variations.tangents().map(<[_]>::to_vec);
    Some(Varied { run, columns })
}

/// A run, and the columns of the derivative of its end.
type Derived = (Ran<<Model as VectorField>::State>, Vec<Vec<f64>>);

/// The entries of a derivative, or a failure in the report.
fn matrix(report: &mut Report, varied: Option<Varied>) -> Option<Derived> {
    let varied = varied.filter(|varied| varied.columns.is_ok());
    report.equal("has derivatives", varied.is_some(), true);
    let Varied { run, columns } = varied?;
    let length = run.state.count();
    let columns = columns.ok()?.into_iter();
    let entries = columns.map(|column| column.state.as_slice()[..length].to_vec());
    let entries = entries.collect();
    Some((run, entries))
}

fn symplectic(report: &mut Report) {
    let table = shipped("point_billiard").model();
    let start: (&[f64], &[f64]) = (&[0.25, 0.1], &[0.8, 0.6]);
    let varied = vary(&table, start, (1e4, Some(100)), all_components(&table));
    let Some((run, columns)) = matrix(report, varied) else {
        return;
    };
    report.equal("outcome", run.outcome, Outcome::ImpactBudget);
    // W(a, b) = a_q b_p - a_p b_q.
    let form = |a: &[f64], b: &[f64]| a[0] * b[2] + a[1] * b[3] - a[2] * b[0] - a[3] * b[1];
    let mut worst = 0.0_f64;
    for i in 0..4 {
        for j in 0..4 {
            let right = match (i, j) {
                (0, 2) | (1, 3) => 1.0,
                (2, 0) | (3, 1) => -1.0,
                _ => 0.0,
            };
            worst = larger(worst, (form(&columns[i], &columns[j]) - right).abs());
        }
    }
    report.error("J^T W J - W", worst, 1e-11);
    report.near("det", determinant(columns), 1.0, 1e-11);
}

/// Determinant by elimination with pivoting.
fn determinant(mut columns: Vec<Vec<f64>>) -> f64 {
    let size = columns.len();
    let mut product = 1.0;
    for row in 0..size {
        let largest =
            |i: &usize, j: &usize| columns[*i][row].abs().total_cmp(&columns[*j][row].abs());
        let Some(pivot) = (row..size).max_by(largest) else {
            return product;
        };
        if pivot != row {
            columns.swap(pivot, row);
            product = -product;
        }
        product *= columns[row][row];
        for other in row + 1..size {
            let factor = columns[other][row] / columns[row][row];
            for k in row..size {
                columns[other][k] -= factor * columns[row][k];
            }
        }
    }
    product
}

fn identity_reset(report: &mut Report) {
    // The start lies on the line, so that the derivative is the saltation matrix of the reset alone.
    let (x, y) = (0.75, 1.0);
    let switched = SWITCHED.model();
    let start: (&[f64], &[f64]) = (&[x, y, 0.0], &[0.0; 3]);
    let varied = vary(&switched, start, (0.0, None), all_components(&switched));
    let Some((run, columns)) = matrix(report, varied) else {
        return;
    };
    report.equal("resets", run.counters.impacts, 1);
    let slope = |rate: [f64; 2]| -rate[0] - y / 2.0 * rate[1];
    let (before, after) = ([1.0 + y * y, 0.5 - x], [1.0 + x.sin(), 2.0 + y.cos()]);
    let right = slope(after) / slope(before);
    let found = columns[0][0] * columns[1][1] - columns[0][1] * columns[1][0];
    report.near("determinant", found, right, 64.0 * U);
}

fn axes_of_an_ellipse(report: &mut Report) {
    let table = elliptic_table(2.0, 1.0);
    let Ok(tolerance) = Tolerance::new(1e-15) else {
        return;
    };
    for (name, velocity, trace) in [("minor", [0.0, 1.0], -1.0), ("major", [1.0, 0.0], 194.0)] {
        let state = table.state(0.0, &vector(&[0.0; 2]), &vector(&velocity));
        let taylor = Taylor::new(tolerance);
        let mut section = Section::new(&table, taylor, table.effects(), 0, 100.0).with_returns(2);
        let orbit = state.ok().and_then(|state| {
            let first = section.arrive(&state, &mut []).ok()?;
            section.periodic(&first.before, 10).ok()
        });
        let Some(orbit) = orbit else {
            report.equal(format!("{name} axis has an orbit"), false, true);
            continue;
        };
        let sum: f64 = orbit.multipliers.iter().map(|[re, _]| re).sum();
        // The conserved energy adds a multiplier 1.
        report.near(format!("trace, {name} axis"), sum - 1.0, trace, 1e-10);
        let columns = orbit.derivative[..orbit.dimension].iter();
        let columns = columns.map(|column| column.as_slice()[..orbit.dimension].to_vec());
        report.near(
            format!("determinant, {name} axis"),
            determinant(columns.collect()),
            1.0,
            1e-10,
        );
    }
}

fn dropped(report: &mut Report) {
    let ball = DROPPED.model();
    let [g, e] = ["g", "e"].map(|name| value(&ball, name));
    let (height, until) = (1.3, 0.9_f64);
    let columns = vec![
        Tangent::of_parameter(1),
        Tangent::of_parameter(0),
        Tangent::of_component(0),
    ];
    let varied = vary(&ball, (&[height], &[0.0]), (until, None), columns);
    let Some((run, columns)) = matrix(report, varied) else {
        return;
    };
    let fall = (2.0 * height / g).sqrt();
    let rest = until - fall;
    // The derivative with respect to the time of the impact.
    let by_fall = e * g * rest - e * g * fall + g * rest;
    let right = [
        ("e", g * fall * rest),
        (
            "g",
            e * fall * rest - rest * rest / 2.0 - by_fall * fall / (2.0 * g),
        ),
        ("height", by_fall / (g * fall)),
    ];
    for ((name, right), column) in right.into_iter().zip(&columns) {
        report.near(
            format!("d x(T)/d {name}"),
            column[0],
            right,
            1e-12 * right.abs(),
        );
    }
    report.near(
        "d x(T)/d T",
        run.state.as_slice()[1],
        e * g * fall - g * rest,
        1e-12,
    );
}

fn grazes(report: &mut Report) {
    let ball = DROPPED.with([("g", -2.0), ("e", 1.0)]);
    let through = |start: f64| {
        let columns = vec![Tangent::of_component(0)];
        vary(&ball, (&[start], &[-2.0]), (3.0, None), columns)
    };
    for off in [0.0, 1e-15, -1e-15] {
        let undefined = through(1.0 - off).and_then(|varied| varied.columns.err());
        let kind = undefined.map_or("defined", |error| error.kind());
        report.equal(format!("derivative, {off:e} from the graze"), kind, "graze");
    }
    for off in [1e-4, 1e-8] {
        let held: f64 = 1.0 - (1.0 - off);
        let root = held.sqrt();
        let Some((_, columns)) = matrix(report, through(1.0 - off)) else {
            continue;
        };
        // x(3) = 4 + 8 sqrt(1 - x0) + 3 (1 - x0)
        let right = -4.0 / root - 3.0;
        let bound = 64.0 * U / held * right.abs();
        report.near(
            format!("derivative, {off:e} from the graze"),
            columns[0][0],
            right,
            bound,
        );
    }
    let Some((_, columns)) = matrix(report, through(1.0 + 1e-4)) else {
        return;
    };
    report.near("derivative where it passes", columns[0][0], 1.0, 64.0 * U);
}

fn two_at_the_end(report: &mut Report) {
    let (quadrant, until) = (QUADRANT.model(), 1.0 + 1e-12);
    let at = |offset: f64| {
        let start: (&[f64], &[f64]) = (&[0.0, -offset], &[1.0, 1.0]);
        vary(&quadrant, start, (until, None), all_components(&quadrant))
    };
    let mut found = Vec::new();
    for offset in [5e-13, -5e-13] {
        let Some((run, columns)) = matrix(report, at(offset)) else {
            return;
        };
        report.equal(
            format!("impacts, {offset:e} apart"),
            run.counters.impacts,
            2,
        );
        found.push(columns.concat());
    }
    let pairs = found[0].iter().zip(&found[1]);
    let apart = pairs.fold(0.0, |worst: f64, (a, b)| larger(worst, (a - b).abs()));
    report.error("derivatives in both orders", apart, 1e-11);
    report.near("dx/dx0", found[0][0], -1.0, 64.0 * U);
    let undefined = at(0.0).and_then(|varied| varied.columns.err());
    let kind = undefined.map_or("defined", |error| error.kind());
    report.equal("at one time", kind, "corner");
}
