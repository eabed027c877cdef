//! Tests of the reduction by groups of symmetries. Reduced equations are compared with the full motion, connections and
//! jumps with their definitions.

use dalembert_codegen::claims::Dynamics;
use dalembert_codegen::mechanics::reduction::{Reduction, derive_reduction};
use dalembert_codegen::model::{Model, Statement};
use dalembert_codegen::report::group;
use dalembert_expr::{ExprId, RealPoint, SymbolId};
use dalembert_numbers::math::larger;

use crate::derived;
use crate::systems::disk;
use crate::values::{Row, at, inner, matrices, moving, projected, solved, value, values};

const PLANE: &str = "partial(x), partial(y), partial(theta) - y*partial(x) + x*partial(y)";
const ROLLING: &str =
    "partial(x), partial(y), partial(theta), partial(phi) - y*partial(x) + x*partial(y)";

/// A sleigh with its centre of mass ahead of the blade.
const SLEIGH: &str = "pub Sleigh { coordinates { x; y; theta: angle; } parameters { m > 0 = 3/2; I > 0 = 2/5; a = 1/3; }
    lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I + m*a^2)/2*dot(theta)^2 + a*m*dot(theta)*(dot(y)*cos(theta) - dot(x)*sin(theta));
    constraints { blade: dot(y)*cos(theta) = dot(x)*sin(theta); } CLAIM }";

/// A snakeboard: its rotor turns by the angle psi, and its wheels are steered by the angle phi.
const SNAKEBOARD: &str = "pub Snakeboard { coordinates { x; y; theta: angle; psi: angle; phi in (-1.5, 1.5); }
    parameters { m > 0 = 6; l > 0 = 1/5; c > 0 = 1/10; J > 0 = 1/60; K > 0 = 1/25; }
    lagrangian = m/2*(dot(x)^2 + dot(y)^2) + c/2*dot(theta)^2 + J/2*(dot(theta) + dot(psi))^2 + K*(dot(theta)^2 + dot(phi)^2);
    frame { v: cos(theta)*d(x) + sin(theta)*d(y); spin: d(psi); steer: d(phi); }
    constraints {
        side: dot(y)*cos(theta) = dot(x)*sin(theta);
        turn: l*cos(phi)*dot(theta) = sin(phi)*(dot(x)*cos(theta) + dot(y)*sin(theta));
    } CLAIM }";

/// A ball that rolls on a plane, in Euler angles.
pub(super) const BALL: &str = "pub Ball { coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; } parameters { r > 0 = 1; k > 0 = 2/3; }
    let wx = dot(theta)*cos(psi) + dot(phi)*sin(psi)*sin(theta);
    let wy = dot(theta)*sin(psi) - dot(phi)*cos(psi)*sin(theta);
    let wz = dot(psi) + dot(phi)*cos(theta);
    lagrangian = (dot(x)^2 + dot(y)^2 + k^2*(wx^2 + wy^2 + wz^2))/2;
    constraints { rolling_x: dot(x) = r*wy; rolling_y: dot(y) = -r*wx; }
    frame {
        ox: cos(psi)*d(theta) + sin(psi)*sin(theta)*d(phi); oy: sin(psi)*d(theta) - cos(psi)*sin(theta)*d(phi);
        oz: d(psi) + cos(theta)*d(phi);
    } CLAIM }";

/// A cart with a pendulum, slowed by friction.
const CART: &str = "pub Cart { coordinates { x; theta: angle; } parameters { M > 0 = 2; l > 0 = 3/4; c > 0 = 1/5; }
    lagrangian = (M + 1)/2*dot(x)^2 + l*cos(theta)*dot(x)*dot(theta) + l^2/2*dot(theta)^2 + l*cos(theta);
    forces { drag: -c*dot(x)*d(x); } CLAIM }";

struct Case {
    model: Model,
    dynamics: Dynamics,
    reduction: Reduction,
    fields: Vec<Vec<ExprId>>,
}

fn case(declaration: &str, group: &str) -> Case {
    let claims: Vec<String> = (group.split(", "))
        .map(|field| format!("symmetry: {field};"))
        .collect();
    let claims = format!("claims {{ {} }}", claims.concat());
    let (mut model, derivation) = derived(&declaration.replace("CLAIM", &claims));
    let fields: Vec<Vec<ExprId>> = (model.claims.iter())
        .filter_map(|claim| match &claim.statement {
            Statement::Symmetry(field) => Some(field.clone()),
            _ => None,
        })
        .collect();
    model.pool.lift_budget();
    let reduction = derive_reduction(&mut model, &derivation, &fields).expect("a reduction");
    let dynamics = Dynamics::of(&mut model, &derivation);
    Case {
        model,
        dynamics,
        reduction,
        fields,
    }
}

/// One step of the classical Runge-Kutta method of order 4.
fn stepped(rate: &dyn Fn(&[f64]) -> Row, start: &[f64], h: f64) -> Row {
    let moved =
        |by: &Row, h: f64| -> Row { start.iter().zip(by).map(|(x, v)| x + h * v).collect() };
    let first = rate(start);
    let second = rate(&moved(&first, h / 2.0));
    let third = rate(&moved(&second, h / 2.0));
    let last = rate(&moved(&third, h));
    let sum = |i: usize| first[i] + 2.0 * (second[i] + third[i]) + last[i];
    (0..start.len())
        .map(|i| start[i] + h / 6.0 * sum(i))
        .collect()
}

impl Case {
    /// Rates of positions and velocities, from the full equations with metric and constraints.
    fn full(&self, state: &[f64]) -> Row {
        let n = self.model.coordinates.len();
        let mut point = RealPoint::default();
        for (symbol, value) in moving(&self.model, &state[..n], &state[n..]) {
            point.set(symbol, value);
        }
        for parameter in &self.model.parameters {
            let default = parameter.default.expect("a default");
            point.set(parameter.symbol, value(&self.model, default, &[]));
        }
        let motion = self.dynamics.motion(&self.model.pool, &mut point, None);
        let motion = motion.expect("a motion");
        [state[n..].to_vec(), motion.qddot].concat()
    }

    /// Symbols of the reduced state, with their rates: positions that the group does not move, then quasi-velocities.
    fn reduced(&self) -> Vec<(SymbolId, ExprId)> {
        let reduced = self.reduction.reduced.as_ref().expect("reduced equations");
        let shape = reduced.shape.iter();
        let shape = shape.map(|(k, rate)| (self.model.coordinates[*k].q, *rate));
        let quasi = reduced.quasi.iter();
        shape.chain(quasi.map(|(u, _, rate)| (*u, *rate))).collect()
    }

    /// The reduced state that belongs to a full state.
    fn reduced_of(&self, state: &[f64]) -> Row {
        let reduced = self.reduction.reduced.as_ref().expect("reduced equations");
        let n = self.model.coordinates.len();
        let at = moving(&self.model, &state[..n], &state[n..]);
        let shape = reduced.shape.iter().map(|(k, _)| state[*k]);
        let quasi = reduced
            .quasi
            .iter()
            .map(|(_, of, _)| value(&self.model, *of, &at));
        shape.chain(quasi).collect()
    }

    /// Largest difference between the reduced states of the full and of the reduced motion up to `t = 1`.
    fn difference(&self, start: &[f64]) -> f64 {
        const STEPS: usize = 600;
        let h = 1.0 / STEPS as f64;
        let n = self.model.coordinates.len();
        let velocity = projected(&self.model, &start[..n], start[n..].to_vec());
        let mut full = [&start[..n], &velocity[..]].concat();
        let equations = self.reduced();
        let rate = |state: &[f64]| -> Row {
            let at: Vec<(SymbolId, f64)> = (equations.iter().zip(state))
                .map(|((symbol, _), value)| (*symbol, *value))
                .collect();
            let rates = equations.iter();
            rates
                .map(|(_, rate)| value(&self.model, *rate, &at))
                .collect()
        };
        let mut reduced = self.reduced_of(&full);
        let mut largest = 0.0_f64;
        for _ in 0..STEPS {
            full = stepped(&|state| self.full(state), &full, h);
            reduced = stepped(&rate, &reduced, h);
            for (one, other) in self.reduced_of(&full).iter().zip(&reduced) {
                largest = larger(largest, (one - other).abs());
            }
        }
        largest
    }
}

#[test]
fn reduced_motions_are_those_of_the_full_equations() {
    let wall = disk("");
    for (declaration, group, start) in [
        (
            wall.as_str(),
            ROLLING,
            vec![0.2, -0.1, 0.4, 0.6, 0.0, 0.0, 1.5, 0.75],
        ),
        (
            wall.as_str(),
            "partial(x), partial(y)",
            vec![0.2, -0.1, 0.4, 0.6, 0.0, 0.0, 1.5, 0.75],
        ),
        (SLEIGH, PLANE, vec![0.2, -0.1, 0.6, 1.2, 0.8, -0.9]),
        (
            BALL,
            "partial(x), partial(y), partial(phi)",
            vec![0.2, -0.1, 0.4, 1.1, 0.6, 0.0, 0.0, 0.7, -0.4, 0.5],
        ),
        (
            SNAKEBOARD,
            PLANE,
            vec![0.2, -0.1, 0.6, 0.3, 0.4, 0.5, 0.3, 0.0, 0.9, -0.6],
        ),
        (CART, "partial(x)", vec![0.2, 0.6, 0.3, -1.1]),
    ] {
        let case = case(declaration, group);
        let found = case.difference(&start);
        assert!(
            found < 1e-10,
            "{} {group}: {found:e}",
            case.model.snake_name
        );
    }
}

#[test]
fn rates_of_momenta_agree_with_differences_along_the_motion() {
    const H: f64 = 1e-4;
    for (declaration, group, start) in [
        (SLEIGH, PLANE, vec![0.2, -0.1, 0.6, 1.2, 0.8, -0.9]),
        (
            BALL,
            "partial(x), partial(y), partial(phi)",
            vec![0.2, -0.1, 0.4, 1.1, 0.6, 0.0, 0.0, 0.7, -0.4, 0.5],
        ),
        (
            SNAKEBOARD,
            PLANE,
            vec![0.2, -0.1, 0.6, 0.3, 0.4, 0.5, 0.3, 0.0, 0.9, -0.6],
        ),
        (CART, "partial(x)", vec![0.2, 0.6, 0.3, -1.1]),
    ] {
        let case = case(declaration, group);
        let n = case.model.coordinates.len();
        let velocity = projected(&case.model, &start[..n], start[n..].to_vec());
        let start = [&start[..n], &velocity[..]].concat();
        let momenta = |state: &[f64]| {
            let at = moving(&case.model, &state[..n], &state[n..]);
            values(&case.model, &case.reduction.momenta_on_d, &at)
        };
        let [ahead, behind] =
            [H, -H].map(|h| momenta(&stepped(&|state| case.full(state), &start, h)));
        let at = moving(&case.model, &start[..n], &start[n..]);
        let rates = case.reduction.rates.as_ref().expect("rates");
        assert!(!rates.is_empty(), "{group}");
        for (i, rate) in rates.iter().enumerate() {
            let expected = (ahead[i] - behind[i]) / (2.0 * H);
            let found = value(&case.model, *rate, &at);
            assert!(
                (found - expected).abs() < 1e-6,
                "{} {group}: {found} instead of {expected}",
                case.model.snake_name
            );
        }
    }
}

/// Values of fields or forms at a position.
fn rows(case: &Case, rows: &[Vec<ExprId>], q: &[f64]) -> Vec<Row> {
    let at = at(&case.model, q);
    rows.iter()
        .map(|row| values(&case.model, row, &at))
        .collect()
}

/// A velocity without its part along the group.
fn horizontal(case: &Case, q: &[f64], v: &[f64]) -> Row {
    let connection = case.reduction.connection.as_ref().expect("a connection");
    let mut v = v.to_vec();
    for (form, field) in rows(case, connection, q)
        .iter()
        .zip(rows(case, &case.fields, q))
    {
        let part: f64 = form.iter().zip(&v).map(|(a, b)| a * b).sum();
        for (entry, by) in v.iter_mut().zip(field) {
            *entry -= part * by;
        }
    }
    v
}

#[test]
fn connections_and_curvatures_satisfy_their_definitions() {
    const H: f64 = 1e-5;
    let wall = disk("");
    for (declaration, group, q) in [
        (
            wall.as_str(),
            "partial(x), partial(y)",
            vec![0.2, -0.1, 0.4, 0.6],
        ),
        (wall.as_str(), ROLLING, vec![0.2, -0.1, 0.4, 0.6]),
        (
            BALL,
            "partial(x), partial(y), partial(phi)",
            vec![0.2, -0.1, 0.4, 1.1, 0.6],
        ),
        (SNAKEBOARD, PLANE, vec![0.2, -0.1, 0.6, 0.3, 0.4]),
        (CART, "partial(x)", vec![0.2, 0.6]),
    ] {
        let case = case(declaration, group);
        let connection = case.reduction.connection.as_ref().expect("a connection");
        let forms = rows(&case, connection, &q);
        let fields = rows(&case, &case.fields, &q);
        for (a, form) in forms.iter().enumerate() {
            for (b, field) in fields.iter().enumerate() {
                let expected = f64::from(u8::from(a == b));
                assert!(
                    (inner(form, field) - expected).abs() < 1e-12,
                    "{group}: {a}, {b}"
                );
            }
        }
        let n = q.len();
        let [x, y] = [0.7, 1.9].map(|phase| {
            let v: Row = (0..n).map(|k| (phase + k as f64 * 1.3).sin()).collect();
            horizontal(&case, &q, &v)
        });
        // Horizontal velocities satisfy the constraints, and are orthogonal to the allowed directions along the group.
        let (metric, _, constraints, _) = matrices(&case.model, &q);
        for form in &constraints {
            assert!(inner(form, &x).abs() < 1e-12, "{group}");
        }
        for section in rows(&case, &case.reduction.sections, &q) {
            let lowered: Row = metric.iter().map(|row| inner(row, &section)).collect();
            assert!(inner(&lowered, &x).abs() < 1e-12, "{group}");
        }
        // dA on two horizontal velocities.
        let shifted = |k: usize, h: f64| {
            let mut q = q.clone();
            q[k] += h;
            rows(&case, connection, &q)
        };
        let state = at(&case.model, &q);
        for (a, curvature) in case.reduction.curvature.iter().enumerate() {
            let (mut expected, mut found) = (0.0, 0.0);
            for k in 0..n {
                let [ahead, behind] = [H, -H].map(|h| shifted(k, h));
                for l in 0..n {
                    let slope = (ahead[a][l] - behind[a][l]) / (2.0 * H);
                    expected += slope * (x[k] * y[l] - x[l] * y[k]);
                    found += value(&case.model, curvature[k][l], &state) * x[k] * y[l];
                }
            }
            assert!(
                (found - expected).abs() < 1e-8,
                "{} {group}: {found} instead of {expected}",
                case.model.snake_name
            );
            // The curvature is horizontal.
            for field in &fields {
                for l in 0..n {
                    let column =
                        (0..n).map(|k| field[k] * value(&case.model, curvature[k][l], &state));
                    assert!(column.sum::<f64>().abs() < 1e-12, "{group}");
                }
            }
        }
    }
}

/// An elastic impact of the disk in W. Clark's thesis, 6.4, on the elliptic table. The velocities before and after it
/// are known to 16 digits or more.
#[test]
fn jumps_of_momenta_on_an_elliptic_table_agree_with_known_velocities() {
    let source = "pub Disk { coordinates { x; y; theta: angle; phi: angle; }
        parameters { m > 0 = 1/400; R > 0 = 1/100; I > 0 = 1/8000000; J > 0 = 1/16000000; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + J/2*dot(phi)^2;
        constraints { rolling_x: dot(x) = R*cos(phi)*dot(theta); rolling_y: dot(y) = R*sin(phi)*dot(theta); }
        impacts { edge: 1 - (x + R*cos(phi))^2/0.15^2 - (y + R*sin(phi))^2/0.2^2 >= 0; } CLAIM }";
    let case = case(source, ROLLING);
    let q = [
        0.139_806_584_891_206_27,
        -0.092_773_437_5,
        0.753_906_25,
        -2.652_343_75,
    ];
    let before = [
        0.001_129_217_563_079_992_6,
        0.000_601_222_246_441_736_8,
        -0.127_929_687_5,
        2.626_953_125,
    ];
    let after = [
        -0.004_780_359_810_657_805,
        -0.002_545_177_083_789_199,
        0.541_569_629_014_945,
        -2.288_950_146_285_076,
    ];
    let [start, end] = [before, after].map(|v| {
        let at = moving(&case.model, &q, &v);
        values(&case.model, &case.reduction.momenta_on_d, &at)
    });
    let at = moving(&case.model, &q, &before);
    let jump = case.reduction.impacts[0].as_ref().expect("an impulse");
    let impulse = value(&case.model, jump.impulse.expect("its size"), &at);
    for (i, slope) in values(&case.model, &jump.slopes, &at).iter().enumerate() {
        let found = start[i] + impulse * slope;
        assert!(
            (found - end[i]).abs() < 1e-11 * end[i].abs(),
            "{found} instead of {}",
            end[i]
        );
    }
    assert_eq!(start.len(), 2);
}

/// An elastic impact at a straight wall, from `dot(theta) = 3`, `dot(phi) = -3/4`. The second momentum in (6.27) and
/// (6.28) of W. Clark's thesis is wrong. The values here come from the impulse, computed with 30 digits.
#[test]
fn jumps_of_momenta_at_a_straight_wall_agree_with_known_velocities() {
    let wall = "wall: 1 - 0.771650550527029756*(x + R*cos(phi)) - 0.301545095525314786*(y + R*sin(phi)) >= 0;";
    let case = case(&disk(wall), ROLLING);
    let (radius, inertia, inertia_phi) = (3.0 / 8.0, 2.0 / 9.0, 1.0 / 7.0);
    let q = [0.0, 0.0, 0.0, 0.6];
    let rolling = |theta: f64, phi: f64| {
        let speed = radius * theta;
        [speed * 0.6_f64.cos(), speed * 0.6_f64.sin(), theta, phi]
    };
    let before = rolling(3.0, -0.75);
    let after = rolling(
        -0.552_229_998_281_975_8 / inertia,
        0.424_960_437_215_408_2 / inertia_phi,
    );
    let momenta = |v: &[f64]| {
        let at = moving(&case.model, &q, v);
        values(&case.model, &case.reduction.momenta_on_d, &at)
    };
    let at = moving(&case.model, &q, &before);
    let jump = case.reduction.impacts[0].as_ref().expect("an impulse");
    let impulse = value(&case.model, jump.impulse.expect("its size"), &at);
    let slopes = values(&case.model, &jump.slopes, &at);
    for ((start, end), slope) in momenta(&before).iter().zip(momenta(&after)).zip(slopes) {
        let found = start + impulse * slope;
        assert!((found - end).abs() < 1e-14, "{found} instead of {end}");
    }
}

/// Factors of the gap rate: `newton(e)` multiplies it by `-e`, here -0.5, `impact_plastic` by 0 and `elastic` by -1.
#[test]
fn laws_have_their_impulses() {
    for (law, expected) in [
        ("newton(e)", -0.5),
        ("impact_plastic", 0.0),
        ("elastic", -1.0),
    ] {
        let case = case(&disk(&format!("wall: x >= 0 => {law};")), ROLLING);
        let q = [0.0, -0.1, 0.4, 0.6];
        let velocity = projected(&case.model, &q, vec![-0.6, 0.3, -1.2, 0.7]);
        let at = moving(&case.model, &q, &velocity);
        let jump = case.reduction.impacts[0].as_ref().expect("an impulse");
        let impulse = value(&case.model, jump.impulse.expect("its size"), &at);
        let (metric, ..) = matrices(&case.model, &q);
        // The velocity after p + eps dh, projected to D.
        let blow = solved(&metric, &[impulse, 0.0, 0.0, 0.0]);
        let moved: Row = velocity.iter().zip(&blow).map(|(v, by)| v + by).collect();
        let moved = projected(&case.model, &q, moved);
        assert!(
            (moved[0] - expected * velocity[0]).abs() < 1e-12,
            "{law}: {}",
            moved[0]
        );
    }
}

#[test]
fn groups_are_printed_and_refused_with_the_reason() {
    let source = disk("wall: x >= 0;").replace("CLAIM", "");
    let printed = group(&source, None, ROLLING).expect("a report");
    let text = printed.text();
    for line in [
        "  [xi_1, xi_4] = xi_2\n",
        "  JD_1 = dot(theta)*(I + m*R^2)\n",
        "  e_2 = partial(phi)\n",
        "  A_1 = d(x) + y*d(phi)\n",
        "  0: the connection is flat\n",
        "  (JD_1+ - JD_1)/eps = R*cos(phi)\n",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
    assert!(printed.latex().contains("\\xi_{1}"), "{}", printed.latex());
    let text = group(&source, None, "partial(x), partial(y)")
        .expect("a report")
        .text();
    for line in [
        "  A_1 = d(x) - R*d(theta)*cos(phi)\n",
        "  B_1(theta, phi) = -R*sin(phi)\n",
        "  the constraints allow no motion along the group\n",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
    for (fields, expected) in [
        (
            "partial(x), x*partial(y)",
            "`x*partial(y)` is no symmetry to reduce by: its flow changes the Lagrangian",
        ),
        (
            "partial(theta) - y*partial(x) + x*partial(y)",
            "its flow maps allowed velocities to velocities that are not allowed",
        ),
        (
            "partial(x), 2*partial(x)",
            "dependent at all configurations",
        ),
        (
            "partial(x), partial(phi) - y*partial(x) + x*partial(y)",
            "[partial(x), partial(phi) - y*partial(x) + x*partial(y)] is no combination of the fields",
        ),
        ("partial(x),", "expected an expression"),
        ("", "the list is empty"),
        (
            "partial(x); partial(y)",
            "`;` does not separate the entries of a list",
        ),
        ("dot(x)*partial(x)", "is not a vector field"),
    ] {
        let error = group(&source, None, fields).expect_err(fields).to_string();
        assert!(error.contains(expected), "{fields}: {error}");
    }
    let plane = "pub Plane { coordinates { x; y; } parameters { m > 0 = 1; l > 0 = 1; } lagrangian = (dot(x)^2 + dot(y)^2)/2; }";
    let fields = "partial(x), (ln(m*l) - ln(m) - ln(l))*partial(y)";
    let error = group(plane, None, fields)
        .expect_err("a zero that is not seen")
        .to_string();
    assert!(error.contains("are not known to be independent"), "{error}");
    let charged =
        "pub Charged { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2 + x*dot(y); }";
    let error = group(charged, None, "partial(x)")
        .expect_err("a gauge symmetry")
        .to_string();
    assert!(error.contains("total time derivative"), "{error}");
    let field = "pub F { coordinates { x; y; } field { dot(x) = y; dot(y) = -x; } }";
    assert!(group(field, None, "partial(x)").is_err());
}
