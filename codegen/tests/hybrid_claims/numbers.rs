//! Numbers printed in the sources. They are compared with finite differences of motions through impacts. Claims prove
//! the formulas behind them at all states.

use dalembert_texts::TEXTS;

use crate::Expected::{False, True};
use crate::check;
use crate::differences::{Hybrid, State, assert_close, determinant, one};
use crate::systems::ball;

/// Parameters of the walker: `mu` (mass against inertia), `eps` (falling against friction), the slope `alpha`, and half
/// the angle between the legs, `delta`.
const WALKER: [f64; 4] = [2.5, 0.5, 0.4, 0.4];

/// Rates of the dimensionless walker, with the integral of their divergence as a fourth component.
fn walking(z: &[f64]) -> State {
    let [mu, eps, alpha, _] = WALKER;
    let (sin, cos) = z[0].sin_cos();
    let weight = mu / (1.0 + mu * sin * sin);
    let foot = z[2] + z[1] * cos;
    let pull = sin * (alpha.cos() - eps * z[1] * z[1] * cos) - cos * foot;
    // d(xi')/d(xi) + d(eta')/d(eta)
    let divergence = weight * (-2.0 * eps * z[1] * sin * cos - cos * cos) - 1.0;
    vec![eps * z[1], weight * pull, alpha.sin() - foot, divergence]
}

/// The state after a step and the integral of the divergence up to it.
fn step(z: &[f64]) -> State {
    let delta = WALKER[3];
    let (c, s) = ((2.0 * delta).cos(), delta.cos());
    vec![
        z[0] + 2.0 * delta,
        c * z[1],
        z[2] + s * (1.0 - c) * z[1],
        z[3],
    ]
}

/// Maps `(xi, eta)` after a step to `(xi, eta)` after the next step. The third entry is the integral of the divergence.
fn walked(xi: f64, eta: f64) -> [f64; 3] {
    let hold = |z: &[f64]| vec![0.0; z.len()];
    let stride = Hybrid {
        before: &walking,
        gap: &|z| z[0] + WALKER[3],
        map: &step,
        after: &hold,
        densities: [&one, &one],
    };
    let end = stride.end(&[WALKER[3], xi, eta, 0.0], 3.0);
    [end[1], end[2], end[3]]
}

/// The derivative of the return map at its fixed point has the determinant `cos(2 delta)^2 exp(integral of the
/// divergence)`.
#[test]
fn returns_of_the_walker_shrink_by_step_and_motion() {
    // The fixed point and its multipliers, computed with 30 digits.
    let (xi, eta) = (-0.902_057_449_429_909_7, 0.991_308_369_223_558_5);
    let multipliers = [0.520_683_714_448_936_2, 0.007_382_316_653_128_13];
    let there = walked(xi, eta);
    assert_close(there[0], xi);
    assert_close(there[1], eta);
    assert!((there[2] + 4.838_498_782).abs() < 5e-10, "{}", there[2]);
    let factor = 0.8_f64.cos().powi(2);
    assert!((factor - 0.485_400).abs() < 5e-7);
    let predicted = factor * there[2].exp();
    assert!((predicted - 0.003_843_852_06).abs() < 5e-12, "{predicted}");
    let h = 1e-4;
    let rows = [[h, 0.0], [0.0, h]].map(|[dx, de]| {
        let pairs = [1.0, -1.0, 2.0, -2.0].map(|by| walked(xi + by * dx, eta + by * de));
        let slope = |j: usize| {
            (8.0 * (pairs[0][j] - pairs[1][j]) - (pairs[2][j] - pairs[3][j])) / (12.0 * h)
        };
        vec![slope(0), slope(1)]
    });
    let found = determinant(rows.to_vec());
    assert!((found - predicted).abs() < 1e-10, "{found} for {predicted}");
    let product = multipliers[0] * multipliers[1];
    assert!((product - predicted).abs() < 1e-12, "{product}");
    let text = TEXTS
        .iter()
        .find(|(name, _)| *name == "dimensionless_walker");
    let text = text.expect("a walker").1;
    let kept = crate::shipped::claiming(text, "CLAIM").replace("claims { CLAIM }", "CLAIM");
    let claim = "density under step: factor = cos(2*delta)^2";
    check(&kept, claim, True);
    check(&kept, &format!("{claim} + 1e-9"), False("Jacobian"));
}

/// A disk whose velocity need not satisfy the constraints: a first-order system of positions and momenta. Constraint
/// forces keep `P(W^a)`, off D too. An elastic impact adds `-2 dh(pi_D qdot)/dh(pi_D grad h)` times `pi_D^* dh` to `p`.
const DISK_OFF_D: &str = "pub DiskOffD {
    coordinates { x; y; theta; phi; px; py; ptheta; pphi; }
    parameters { m > 0 = 7/5; R > 0 = 3/8; I > 0 = 2/9; J > 0 = 1/7; hx = -3/4; hy = -1/3; }
    let roll = R*(cos(phi)*px + sin(phi)*py) + ptheta;
    let slope = R*(hx*cos(phi) + hy*sin(phi));
    let turn = R*(hy*cos(phi) - hx*sin(phi));
    let mass = I + m*R^2;
    let projected = slope*roll/mass + turn*pphi/J;
    let rate = (hx*px + hy*py)/m + turn*pphi/J;
    let eps = -2*projected/(slope^2/mass + turn^2/J);
    field {
        dot(x) = px/m; dot(y) = py/m; dot(theta) = ptheta/I; dot(phi) = pphi/J;
        dot(px) = -m*R*sin(phi)*pphi/J*ptheta/I; dot(py) = m*R*cos(phi)*pphi/J*ptheta/I;
        dot(ptheta) = 0; dot(pphi) = 0;
    }
    impacts { wall: 1 + hx*(x + R*cos(phi)) + hy*(y + R*sin(phi)) >= 0 => reset {
        px = px + eps*slope*m*R*cos(phi)/mass; py = py + eps*slope*m*R*sin(phi)/mass;
        ptheta = ptheta + eps*slope*I/mass; pphi = pphi + eps*turn;
    }; } CLAIM }";

/// `(h_x, h_y)` of the disk at phi = 0.6, from two known components: the last one of grad h,
/// `R/J (h_y cos phi - h_x sin phi)`, and the second one of pi_D grad h,
/// `R^2/(2 (I + m R^2)) (h_y (1 - cos 2 phi) + h_x sin 2 phi)`.
fn gradient_of_rim() -> [f64; 2] {
    let [m, radius, inertia, j] = [7.0 / 5.0, 3.0 / 8.0, 2.0 / 9.0, 1.0 / 7.0_f64];
    let mass = inertia + m * radius * radius;
    let (sin, cos) = 0.6_f64.sin_cos();
    let turned = 0.490_430_767_595_578_5 * j / radius;
    let slope = -0.152_921_283_381_455_74 * mass / (radius * radius * sin);
    // h_x cos + h_y sin and h_y cos - h_x sin.
    [slope * cos - turned * sin, slope * sin + turned * cos]
}

/// W. Clark, thesis, (7.11): off D an elastic impact multiplies `omega^n` by
/// `(2 dh(pi_D qdot) - dh(qdot))/dh(qdot)`. On D that is 1.
///
/// The claim proves the formula for all states. Its value at one state is compared with differences of motions. The
/// gradient of `h` at this state is computed from known components.
#[test]
fn an_elastic_impact_off_d_does_not_keep_the_liouville_volume() {
    let claim = |factor: &str| format!("density under wall: factor = {factor}");
    check(DISK_OFF_D, &claim("abs(2*projected/rate - 1)"), True);
    check(
        DISK_OFF_D,
        &claim("abs((2 + 1e-9)*projected/rate - 1)"),
        False("Jacobian"),
    );
    check(DISK_OFF_D, &claim("1"), False("Jacobian"));
    check(DISK_OFF_D, "density = 1", True);
    // p = (1.2, -0.2, 0.4, 0.1) at phi = 0.6.
    let [m, radius, inertia, j] = [7.0 / 5.0, 3.0 / 8.0, 2.0 / 9.0, 1.0 / 7.0];
    let [hx, hy] = gradient_of_rim();
    let slopes = move |phi: f64| {
        let (sin, cos) = phi.sin_cos();
        [
            radius * (hx * cos + hy * sin),
            radius * (hy * cos - hx * sin),
        ]
    };
    let mass = inertia + m * radius * radius;
    let motion = move |z: &[f64]| {
        let (sin, cos) = z[3].sin_cos();
        let turned = m * radius * z[7] / j * z[6] / inertia;
        let rates = [z[4] / m, z[5] / m, z[6] / inertia, z[7] / j];
        [rates, [-turned * sin, turned * cos, 0.0, 0.0]].concat()
    };
    let gap = move |z: &[f64]| {
        let (sin, cos) = z[3].sin_cos();
        let (sin0, cos0) = 0.6_f64.sin_cos();
        hx * (z[0] + radius * (cos - cos0)) + hy * (z[1] + radius * (sin - sin0))
    };
    let map = move |z: &[f64]| {
        let (sin, cos) = z[3].sin_cos();
        let [slope, turn] = slopes(z[3]);
        let roll = radius * (cos * z[4] + sin * z[5]) + z[6];
        let eps = -2.0 * (slope * roll / mass + turn * z[7] / j)
            / (slope * slope / mass + turn * turn / j);
        let along = eps * slope / mass;
        let mut end = z.to_vec();
        end[4] += along * m * radius * cos;
        end[5] += along * m * radius * sin;
        end[6] += along * inertia;
        end[7] += eps * turn;
        end
    };
    let wall = Hybrid {
        before: &motion,
        gap: &gap,
        map: &map,
        after: &motion,
        densities: [&one, &one],
    };
    // The state a moment before the impact: the motion runs backwards in time.
    let back = |z: &[f64]| -> State { motion(z).iter().map(|rate| -rate).collect() };
    let hit = [0.0, 0.0, 0.0, 0.6, 1.2, -0.2, 0.4, 0.1];
    let early = crate::differences::run(&back, &hit, 0.1);
    assert_close(wall.factor(&early, 0.2), 0.677_466_760_267_277_6);
}

/// W. Clark, thesis, Example IX.9 with its sign corrected: `[[-1, 0], [-2 g/v, -1]]`, which is `[[-1, 0], [1, -1]]` for
/// g = 1 and v = -2.
#[test]
fn the_augmented_differential_of_a_ball() {
    let falls = |z: &[f64]| vec![z[1], -1.0];
    let floor = Hybrid {
        before: &falls,
        gap: &|z| z[0],
        map: &|z| vec![z[0], -z[1]],
        after: &falls,
        densities: [&one, &one],
    };
    // v = -2 at the floor, a quarter of a unit of time before and after.
    let early: f64 = 0.25;
    let columns = floor.columns(&[1.75 * early + early * early / 2.0, -1.75], 2.0 * early);
    // The motion takes (dx, dv) to (dx + dv t, dv).
    let moved = |[x, v]: [f64; 2], t: f64| [x + v * t, v];
    let whole = |[x, v]: [f64; 2]| {
        let end = |i: usize| columns[0][i] * x + columns[1][i] * v;
        [end(0), end(1)]
    };
    for (vector, expected) in [([1.0, 0.0], [-1.0, 1.0]), ([0.0, 1.0], [0.0, -1.0])] {
        let found = moved(whole(moved(vector, -early)), -early);
        assert_close(found[0], expected[0]);
        assert_close(found[1], expected[1]);
    }
    check(&ball("elastic"), "invariant: d(energy)", True);
}
