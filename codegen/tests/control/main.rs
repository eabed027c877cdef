//! Tests of the maximum principle across impacts. Its equations are compared with finite differences of the model and
//! with values computed by hand; its error messages are checked.

#![allow(clippy::unwrap_used, clippy::expect_used)] // a test may stop at the first surprise

mod refusals;

use std::collections::BTreeMap;

use dalembert_codegen::claims::{self, Verdict};
use dalembert_codegen::mechanics::control::{Extremals, derive_extremals, extremal_model};
use dalembert_codegen::mechanics::derive;
use dalembert_codegen::model::{Claim, Model, Statement, Topology, check};
use dalembert_codegen::{compile_control, compile_held, spec};
use dalembert_expr::{ExprId, SymbolId};
use dalembert_numbers::math::larger;

const BALL: &str = "Ball {
    coordinates { x; y; }
    parameters { m > 0 = 2; g > 0 = 1; e > 0 = 1; a > 0 = 10; }
    inputs { u; }
    cost { running = u^2/2; terminal = a*(x - 1)^2; }
    field { dot(x) = y/m; dot(y) = -m*g + u; }
    impacts { floor: x >= 0 => reset { y = -e*y; }; }
}";

/// The same ball, declared by its Lagrangian: the velocity replaces the momentum as a component of the state.
const BALL_OF_LAGRANGE: &str = "Ball {
    coordinates { x; }
    parameters { m > 0 = 2; g > 0 = 1; e > 0 = 1; a > 0 = 10; }
    inputs { u; }
    cost { running = u^2/2; terminal = a*(x - 1)^2; }
    lagrangian = m/2*dot(x)^2 - m*g*x;
    forces { push: u*d(x); }
    impacts { floor: x >= 0 => newton(e); }
}";

/// A metric that depends on the position, a curved moving wall, and two inputs coupled by the cost.
const CURVED: &str = "Curved {
    coordinates { r in (1/10, 10); phi: angle; }
    parameters { m > 0 = 3/2; e > 0 = 3/5; k = 2/3; }
    inputs { u; w; }
    cost { running = u^2 + u*w/2 + (2 + r^2)*w^2 + k*u*phi + r^2*dot(r)/3; terminal = r*dot(phi); }
    lagrangian = m/2*(dot(r)^2 + r^2*dot(phi)^2) + k*r^2*dot(phi) - m*r*cos(phi);
    forces { push: u*d(r) + r*w*d(phi); drag: -k*dot(r)*d(phi); }
    impacts { wall: 3 + t/5 - r*(1 + cos(phi)/4) >= 0 => LAW; }
}";

/// A first-order system with a reset that also changes the position.
const HOP: &str = "Hop {
    coordinates { x; v; z; }
    inputs { u; }
    cost { running = u^2*(1 + x^2)/2 + x*u + z^2; terminal = z; }
    field { dot(x) = v; dot(v) = -sin(x) - v/4 + u; dot(z) = x*v; }
    impacts { jump: 1 - x + t/7 >= 0 => reset { x = x - 2 + t/3; v = v*(1 + z^2)/2; z = z + v^2; }; }
}";

/// Families, angles, a condition and scenes.
const CHAIN: &str = "Chain {
    const N = 2;
    coordinates { q[N]: angle; }
    parameters { m[N] > 0 = [1, 2]; }
    inputs { u[N]; }
    cost { running = sum(i in 1..=N: m[i]*u[i]^2)/2; terminal = sum(i in 1..=N: (q[i] - 3)^2 + dot(q[i])^2); }
    lagrangian = sum(i in 1..=N: m[i]*dot(q[i])^2)/2 + cos(q[1] - q[2])*dot(q[1])*dot(q[2])/2 + cos(q[1]);
    forces { motor[i in 1..=N]: u[i]*d(q[i]); }
    impacts { stop: 2 - sin(q[1]) - sin(q[2]) >= 0 when cos(q[1]) > 0; }
    scenes { free: motor[1]; }
}";

/// A model with its maximum principle, and the values of its symbols.
struct Derived {
    model: Model,
    extremals: Extremals,
    values: BTreeMap<SymbolId, f64>,
}

impl Derived {
    fn of(source: &str, set: &[(&str, f64)], state: &[f64], costate: &[f64], t: f64) -> Self {
        let spec = spec::parse(source.parse().unwrap()).unwrap();
        let mut model = check(&spec).unwrap_or_else(|errors| panic!("{errors:?}"));
        let extremals = derive_extremals(&mut model).unwrap();
        let mut values = BTreeMap::from([(model.time, t)]);
        for parameter in model.parameters.iter().filter(|it| !it.is_input) {
            let named = set.iter().find(|(name, _)| *name == parameter.name.display);
            let default = parameter
                .default
                .map(|it| model.pool.eval(&[it], &|_| 0.0)[0]);
            values.insert(
                parameter.symbol,
                named.map_or(default.unwrap(), |(_, value)| *value),
            );
        }
        for (index, component) in extremals.components.iter().enumerate() {
            values.insert(component.state, state[index]);
            values.insert(component.costate, costate[index]);
        }
        Self {
            model,
            extremals,
            values,
        }
    }

    fn at(&self, values: &BTreeMap<SymbolId, f64>, expressions: &[ExprId]) -> Vec<f64> {
        let value = |symbol: SymbolId| values.get(&symbol).copied().unwrap_or(f64::NAN);
        self.model.pool.eval(expressions, &value)
    }

    /// Central difference of expressions with respect to a symbol.
    fn slope(&self, expressions: &[ExprId], symbol: SymbolId) -> Vec<f64> {
        let step = 1e-5;
        let beside = |side: f64| {
            let mut values = self.values.clone();
            *values.get_mut(&symbol).unwrap() += side * step;
            self.at(&values, expressions)
        };
        let (right, left) = (beside(1.0), beside(-1.0));
        let pairs = right.iter().zip(&left);
        pairs
            .map(|(right, left)| (right - left) / (2.0 * step))
            .collect()
    }

    /// Costate after the impact on a surface.
    fn costate_after(&self, surface: usize) -> Vec<f64> {
        let jump = &self.extremals.jumps[surface];
        let mut values = self.values.clone();
        values.insert(jump.multiplier, self.at(&values, &[jump.epsilon])[0]);
        self.at(&values, &jump.costate)
    }

    /// Residuals of `p+.Delta_* = p + eps dh` and of `H*+ - p+.d_t Delta + eps d_t h = H*`.
    fn residuals(&self, surface: usize) -> Vec<f64> {
        let jump = &self.extremals.jumps[surface];
        let gap = self.model.surfaces[surface].gap;
        let epsilon = self.at(&self.values, &[jump.epsilon])[0];
        let costate = self.costate_after(surface);
        let product = |slopes: &[f64]| -> f64 {
            slopes
                .iter()
                .zip(&costate)
                .map(|(slope, p)| slope * p)
                .sum()
        };
        let mut residuals = Vec::new();
        for component in &self.extremals.components {
            let slopes = self.slope(&jump.state, component.state);
            let form = self.slope(&[gap], component.state)[0];
            let before = self.values[&component.costate];
            residuals.push(product(&slopes) - before - epsilon * form);
        }
        let mut after = self.values.clone();
        let state = self.at(&self.values, &jump.state);
        for (index, component) in self.extremals.components.iter().enumerate() {
            after.insert(component.state, state[index]);
            after.insert(component.costate, costate[index]);
        }
        let energy = |values| self.at(values, &[self.extremals.hamiltonian])[0];
        let moved = product(&self.slope(&jump.state, self.model.time));
        let rate = self.slope(&[gap], self.model.time)[0];
        residuals.push(energy(&after) - moved + epsilon * rate - energy(&self.values));
        residuals
    }

    /// Residuals of `xdot = dH*/dp` and `pdot = -dH*/dx`.
    fn canonical(&self) -> Vec<f64> {
        let energy = [self.extremals.hamiltonian];
        let mut residuals = Vec::new();
        for component in &self.extremals.components {
            let rates = [component.rate, component.costate_rate];
            let rates = self.at(&self.values, &rates);
            residuals.push(rates[0] - self.slope(&energy, component.costate)[0]);
            residuals.push(rates[1] + self.slope(&energy, component.state)[0]);
        }
        residuals
    }
}

#[track_caller]
fn assert_small(residuals: &[f64], what: &str) {
    let most = residuals
        .iter()
        .fold(0.0_f64, |most, it| larger(most, it.abs()));
    assert!(
        most < 1e-7 && residuals.iter().all(|it| it.is_finite()),
        "{what}: {residuals:?}"
    );
}

/// `p_y+ = -p_y/e`, and `p_x+` by hand from the equality of `H* = -p_y^2/2 + p_x y/m - m g p_y` before and after.
#[test]
fn the_costate_of_the_ball_jumps_as_worked_out_by_hand() {
    // Columns: y, p_x, p_y, e; then y+, p_x+, p_y+.
    let cases = [
        ([-1.5, 0.5, 0.25, 1.0], [1.5, -11.0 / 6.0, -0.25]),
        ([-2.0, -1.0, 0.75, 0.5], [1.0, -5.3125, -1.5]),
        ([-0.25, 2.0, -1.0, 0.8], [0.2, 45.3125, 1.25]),
    ];
    for ([y, p_x, p_y, e], expected) in cases {
        let set = [("e", e)];
        let ball = Derived::of(BALL, &set, &[0.0, y], &[p_x, p_y], 0.0);
        let state = ball.at(&ball.values, &ball.extremals.jumps[0].state);
        let costate = ball.costate_after(0);
        let found = [state[1], costate[0], costate[1]];
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found - expected).abs() < 1e-13 * expected.abs().max(1.0),
                "{found} {expected}"
            );
        }
        // As v = y/m, the costate of the velocity is m p_y.
        let ball = Derived::of(
            BALL_OF_LAGRANGE,
            &set,
            &[0.0, y / 2.0],
            &[p_x, 2.0 * p_y],
            0.0,
        );
        let costate = ball.costate_after(0);
        for (found, expected) in costate.iter().zip([expected[1], 2.0 * expected[2]]) {
            assert!(
                (found - expected).abs() < 1e-12 * expected.abs().max(1.0),
                "{found} {expected}"
            );
        }
    }
}

#[test]
fn the_optimal_input_of_the_ball_is_minus_its_costate() {
    let ball = Derived::of(BALL, &[], &[0.7, -0.4], &[0.3, -1.1], 0.0);
    let optimal = ball.at(&ball.values, &ball.extremals.optimal);
    assert!((optimal[0] - 1.1).abs() < 1e-15, "{optimal:?}");
    let energy = ball.at(&ball.values, &[ball.extremals.hamiltonian])[0];
    let by_hand = -1.1_f64.powi(2) / 2.0 + 0.3 * -0.4 / 2.0 + 2.0 * 1.1;
    assert!((energy - by_hand).abs() < 1e-15, "{energy} {by_hand}");
}

#[test]
fn extremals_are_canonical_and_satisfy_the_jump_conditions() {
    for law in ["elastic", "restitution(e)", "newton(e)"] {
        let source = CURVED.replace("LAW", law);
        let (state, costate) = ([2.1, 0.6, 0.4, -0.7], [0.3, -0.8, 1.2, 0.5]);
        let curved = Derived::of(&source, &[], &state, &costate, 0.7);
        assert_small(&curved.canonical(), law);
        assert_small(&curved.residuals(0), law);
    }
    let hop = Derived::of(HOP, &[], &[1.1, 0.8, -0.4], &[0.6, -0.9, 1.3], 0.35);
    assert_small(&hop.canonical(), "hop");
    assert_small(&hop.residuals(0), "hop");
}

/// The optimal input minimises `H`: at another input `u`, `H - H*` is a positive quadratic form of `u - u*`.
#[test]
fn other_inputs_have_a_larger_hamiltonian() {
    let source = CURVED.replace("LAW", "elastic");
    let (state, costate) = ([2.1, 0.6, 0.4, -0.7], [0.3, -0.8, 1.2, 0.5]);
    let mut curved = Derived::of(&source, &[], &state, &costate, 0.7);
    let derivation = derive(&mut curved.model);
    let optimal = curved.at(&curved.values, &curved.extremals.optimal);
    let least = curved.at(&curved.values, &[curved.extremals.hamiltonian])[0];
    let inputs: Vec<SymbolId> = curved.model.inputs().map(|(_, it)| it.symbol).collect();
    for change in [
        [0.1, 0.0],
        [-0.1, 0.0],
        [0.0, 0.1],
        [0.0, -0.1],
        [0.1, -0.1],
    ] {
        let mut values = curved.values.clone();
        for ((input, optimal), change) in inputs.iter().zip(&optimal).zip(change) {
            values.insert(*input, optimal + change);
        }
        // The metric is diag(m, m r^2).
        let difference = |k: usize| {
            let field = &derivation.field;
            let pair = curved.at(&values, &[field.force[k], field.drift[k]]);
            pair[0] - pair[1]
        };
        let rates = [
            state[2],
            state[3],
            difference(0) / 1.5,
            difference(1) / (1.5 * 2.1 * 2.1),
        ];
        let work: f64 = rates.iter().zip(&costate).map(|(rate, p)| rate * p).sum();
        let running = curved.at(&values, &[curved.model.cost.unwrap().running])[0];
        assert!(
            work + running > least + 1e-3,
            "{change:?}: {} {least}",
            work + running
        );
    }
}

/// The claims prove that `H*` is conserved along extremals and at impacts.
#[test]
fn the_hamiltonian_is_proved_to_be_conserved() {
    let spec = spec::parse(BALL.parse().unwrap()).unwrap();
    let mut model = check(&spec).unwrap();
    let extremals = derive_extremals(&mut model).unwrap();
    let item = model.cost.unwrap().item;
    let mut model = extremal_model(model, &extremals);
    let claim = |under| Claim {
        statement: Statement::Conserved {
            value: extremals.hamiltonian,
            under,
            holds: true,
        },
        text: "conserved".to_owned(),
        is_assumed: false,
        scene: None,
        item,
    };
    model.claims = vec![claim(None), claim(Some(0))];
    let derivation = derive(&mut model);
    let findings = claims::examine(&mut model, &derivation).findings;
    assert_eq!(findings.len(), 2);
    for finding in findings {
        assert!(matches!(finding.verdict, Verdict::Proved(_)), "{finding:?}");
    }
}

#[test]
fn the_model_of_extremals_passes_every_stage() {
    for source in [
        BALL,
        BALL_OF_LAGRANGE,
        HOP,
        &CURVED.replace("LAW", "elastic"),
    ] {
        let spec = spec::parse(source.parse().unwrap()).unwrap();
        let compiled = compile_control(&spec, None).unwrap_or_else(|errors| panic!("{errors:?}"));
        let model = &compiled.model;
        let names: Vec<&str> = model
            .coordinates
            .iter()
            .map(|it| &*it.name.display)
            .collect();
        assert_eq!(names.len() % 2, 1, "{names:?}");
        assert_eq!(*names.last().unwrap(), "cost");
        assert_eq!(model.inputs().count(), 0);
    }
}

#[test]
fn held_inputs_are_components_between_the_state_and_the_cost() {
    let held = |source: &str| {
        let spec = spec::parse(source.parse().unwrap()).unwrap();
        compile_held(&spec, None).unwrap_or_else(|errors| panic!("{errors:?}"))
    };
    let ball = held(BALL_OF_LAGRANGE);
    let model = &ball.compiled.model;
    let names = model.coordinates.iter().map(|it| &*it.name.display);
    assert_eq!(names.collect::<Vec<_>>(), ["x", "x_dot", "u", "cost"]);
    assert_eq!((ball.inputs, ball.is_autonomous), (1, true));
    assert_eq!((model.outputs.len(), model.inputs().count()), (1, 0));
    // The law changes only the velocity.
    let reset = model.surfaces[0].reset.as_ref().unwrap();
    let changed: Vec<bool> = reset.q.iter().map(Option::is_some).collect();
    assert_eq!(changed, [false, true, false, false]);
    let of_time = [
        BALL_OF_LAGRANGE.replace("u^2/2", "(1 + t)*u^2/2"),
        BALL_OF_LAGRANGE.replace("x >= 0", "x - t >= 0"),
    ];
    for source in of_time {
        assert!(!held(&source).is_autonomous, "{source}");
    }
}

#[test]
fn families_angles_and_scenes_are_kept() {
    let spec = spec::parse(CHAIN.parse().unwrap()).unwrap();
    let model = compile_control(&spec, None)
        .unwrap_or_else(|errors| panic!("{errors:?}"))
        .model;
    let names: Vec<&str> = model
        .coordinates
        .iter()
        .map(|it| &*it.name.display)
        .collect();
    let states = ["q.1", "q.2", "q_dot.1", "q_dot.2"];
    assert_eq!(names[..4], states);
    assert_eq!(names[4], "costate_q.1");
    assert_eq!(model.coordinates[0].topology, Topology::Angle);
    assert_eq!(model.coordinates[2].topology, Topology::Line);
    assert_eq!(model.surfaces[0].conditions.len(), 1);
    assert_eq!(model.outputs[0].name.display, "u.1");
    let free = compile_control(&spec, Some("free")).unwrap().model;
    assert!(free.surfaces.is_empty());
    let unknown = compile_control(&spec, Some("fre")).expect_err("an unknown scene");
    let error = unknown.iter().next().expect("an error");
    assert!(
        error.message().starts_with("unknown scene `fre`"),
        "{}",
        error.message()
    );
    let chain = Derived::of(
        CHAIN,
        &[("m.2", 2.0), ("m.1", 1.0)],
        &[0.4, 0.9, -0.3, 0.8],
        &[0.2, -0.7, 1.1, 0.4],
        0.0,
    );
    assert_small(&chain.canonical(), "chain");
    assert_small(&chain.residuals(0), "chain");
}

#[test]
fn a_cost_changes_nothing_of_the_model() {
    let without = BALL.replace(
        "cost { running = u^2/2; terminal = a*(x - 1)^2; }",
        "outputs { o: a; }",
    );
    let with = BALL.replace("field", "outputs { o: a; } field");
    let program = |source: &str| {
        let compiled = dalembert_codegen::compile(source.parse().unwrap()).unwrap();
        format!("{:?}", compiled.programs.main.rate)
    };
    assert_eq!(program(&without), program(&with));
}

/// The printed equations of the ball are (9.13) and (9.14) of W. Clark's thesis, extended by a coefficient of
/// restitution.
#[test]
fn the_maximum_principle_is_printed() {
    let report = dalembert_codegen::report::control(BALL, None)
        .unwrap()
        .text();
    for line in [
        "u* = -p_y",
        "H* = (2*y*p_x/m - p_y^2 - 2*m*g*p_y)/2",
        "dot(y) = -m*g - p_y",
        "dot(p_y) = -p_x/m",
        "y+[floor] = -e*y",
        "p_x+[floor] = p_x + eps",
        "p_y+[floor] = -p_y/e",
        "p_x(T) = 2*a*(x - 1)",
    ] {
        assert!(report.contains(line), "{line}: {report}");
    }
}
