//! The Chaplygin sleigh: a metric with off-diagonal entries and one constraint.

use dalembert_models::ChaplyginSleigh;

use super::number::{Number, parameters};

/// Mass, moment of inertia, and distance of the centre of mass from the blade.
#[inline(always)]
fn body<T: Number>(sleigh: &ChaplyginSleigh) -> [T; 3] {
    parameters([sleigh.m, sleigh.I, sleigh.a])
}

/// `g^{-1} r`. Its component of theta is `(r_theta + a (r_x sin - r_y cos))/I`. `None` for `r_theta` means 0.
#[inline(always)]
fn raise<T: Number>(
    [m, i, a]: [T; 3],
    (sin, cos): (T, T),
    [r_x, r_y]: [T; 2],
    r_theta: Option<T>,
) -> [T; 3] {
    let lever = a * (r_x * sin - r_y * cos);
    let theta = r_theta.map_or(lever, |r_theta| r_theta + lever) / i;
    let (light, swing) = (m.reciprocal(), a * theta);
    [r_x * light + swing * sin, r_y * light - swing * cos, theta]
}

/// Hamilton's equations with the multiplier from `m^{11} lambda = -(W.(f - gdot qdot) + gamma)`. Here
/// `W = g^{-1} eta`, `m^{11} = eta(W)`, `f = dL/dq`, and `gamma` is the rate of `eta(qdot)` at constant velocity.
#[inline(always)]
pub fn rate<T: Number>(
    sleigh: &ChaplyginSleigh,
    [_, _, theta, p_x, p_y, p_theta]: [T; 6],
) -> [T; 6] {
    let [m, i, a] = body::<T>(sleigh);
    let (sin, cos) = theta.sin_cos();
    let [x_dot, y_dot, spin] = raise([m, i, a], (sin, cos), [p_x, p_y], Some(p_theta));
    let along = x_dot * cos + y_dot * sin;
    let lever = m * a;
    let [w_x, w_y, _] = raise([m, i, a], (sin, cos), [-sin, cos], None);
    // f - gdot qdot has no theta component: its two terms cancel.
    let inertia = lever * spin * spin * (w_x * cos + w_y * sin);
    let lambda = (spin * along - inertia) / (w_y * cos - w_x * sin);
    [
        x_dot,
        y_dot,
        spin,
        -lambda * sin,
        lambda * cos,
        -lever * spin * along,
    ]
}

/// Same as [`rate`], from the momenta along and across the blade, with the multiplier in closed form.
#[inline(always)]
pub fn rate_in_frame<T: Number>(
    sleigh: &ChaplyginSleigh,
    [_, _, theta, p_x, p_y, p_theta]: [T; 6],
) -> [T; 6] {
    let [m, i, a] = body::<T>(sleigh);
    let (sin, cos) = theta.sin_cos();
    let (along, across) = (p_x * cos + p_y * sin, p_y * cos - p_x * sin);
    let spin = (p_theta - a * across) / i;
    let light = m.reciprocal();
    let (slip, speed) = (across * light - a * spin, along * light);
    let turning = spin * along;
    let lambda = turning * i / (i + m * a * a);
    [
        speed * cos - slip * sin,
        speed * sin + slip * cos,
        spin,
        -lambda * sin,
        lambda * cos,
        -a * turning,
    ]
}

/// Kinetic energy.
#[inline(always)]
pub fn energy<T: Number>(sleigh: &ChaplyginSleigh, [_, _, theta, p_x, p_y, p_theta]: [T; 6]) -> T {
    let [m, i, a] = body::<T>(sleigh);
    let (sin, cos) = theta.sin_cos();
    let moment = p_theta + a * (p_x * sin - p_y * cos);
    ((p_x * p_x + p_y * p_y) / m + moment * moment / i).times(0.5)
}

/// The derivatives of the gap of a tip (0 front, 1 back) along the frame of D, whose fields move the sleigh along its
/// blade and turn it. Also sine and cosine of the angle.
#[inline(always)]
fn tip_gradient<T: Number>(
    sleigh: &ChaplyginSleigh,
    tip: usize,
    [x, y, theta]: [T; 3],
) -> ([T; 2], (T, T)) {
    let reach = if tip == 0 { sleigh.len } else { -sleigh.len };
    let [reach, ta, tb] = parameters::<T, _>([reach, sleigh.ta, sleigh.tb]);
    let (sin, cos) = theta.sin_cos();
    let h_x = (x + reach * cos).times(-2.0) / (ta * ta);
    let h_y = (y + reach * sin).times(-2.0) / (tb * tb);
    let (h_along, h_spin) = (h_x * cos + h_y * sin, reach * (h_y * cos - h_x * sin));
    ([h_along, h_spin], (sin, cos))
}

/// Elastic impact of a tip, by the projected gradient in the frame of D. The two fields of the frame, the motion along
/// the blade and the rotation about its point of contact, are orthogonal.
#[inline(always)]
pub fn impact<T: Number>(
    sleigh: &ChaplyginSleigh,
    tip: usize,
    [x, y, theta, p_x, p_y, p_theta]: [T; 6],
) -> [T; 6] {
    let [m, i, a] = body::<T>(sleigh);
    let ([h_along, h_spin], (sin, cos)) = tip_gradient(sleigh, tip, [x, y, theta]);
    let (n_along, n_spin) = (h_along / m, h_spin / (i + m * a * a));
    let rate = n_along * (p_x * cos + p_y * sin) + n_spin * p_theta;
    let eps = rate.times(-2.0) / (h_along * n_along + h_spin * n_spin);
    let (push, swing) = (eps * h_along, eps * m * a * n_spin);
    [
        x,
        y,
        theta,
        p_x + push * cos - swing * sin,
        p_y + push * sin + swing * cos,
        p_theta + eps * h_spin,
    ]
}

/// The rate on D, in the frame of the motion along the blade and the rotation.
#[inline(always)]
pub fn reduced_rate<T: Number>(
    sleigh: &ChaplyginSleigh,
    [_, _, theta, v, omega]: [T; 5],
) -> [T; 5] {
    let [m, i, a] = body::<T>(sleigh);
    let (sin, cos) = theta.sin_cos();
    let lever = a * omega;
    let turning = -(m * lever * v) / (i + m * a * a);
    [v * cos, v * sin, omega, lever * omega, turning]
}

/// Kinetic energy on D.
#[inline(always)]
pub fn reduced_energy<T: Number>(sleigh: &ChaplyginSleigh, [_, _, _, v, omega]: [T; 5]) -> T {
    let [m, i, a] = body::<T>(sleigh);
    (m * v * v + (i + m * a * a) * omega * omega).times(0.5)
}

/// Elastic impact of a tip on D.
#[inline(always)]
pub fn reduced_impact<T: Number>(
    sleigh: &ChaplyginSleigh,
    tip: usize,
    [x, y, theta, v, omega]: [T; 5],
) -> [T; 5] {
    let [m, i, a] = body::<T>(sleigh);
    let ([h_along, h_spin], _) = tip_gradient(sleigh, tip, [x, y, theta]);
    let (n_along, n_spin) = (h_along / m, h_spin / (i + m * a * a));
    let eps = (h_along * v + h_spin * omega).times(-2.0) / (h_along * n_along + h_spin * n_spin);
    [x, y, theta, v + eps * n_along, omega + eps * n_spin]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated;
    use crate::hand::agreement::{assert_numbers_agree, assert_states_agree};
    use crate::hand::number::numbers;
    use dalembert_models::chaplygin_sleigh::ChaplyginSleighGlobal as Global;

    const MODEL: ChaplyginSleigh = ChaplyginSleigh {
        m: 1.3,
        I: 0.7,
        a: 0.4,
        len: 0.35,
        ta: 2.0,
        tb: 1.5,
    };
    const SLEIGH: Global = Global(MODEL);

    #[test]
    fn the_sleigh_by_hand_is_the_generated_one() {
        assert_states_agree(&SLEIGH, generated::rate, |sleigh, state| {
            rate(&sleigh.0, numbers(state)).into()
        });
        assert_states_agree(&SLEIGH, generated::rate, |sleigh, state| {
            rate_in_frame(&sleigh.0, numbers(state)).into()
        });
        assert_numbers_agree(&SLEIGH, generated::energy, |sleigh, state| {
            energy(&sleigh.0, numbers(state))
        });
        for tip in 0..2 {
            assert_states_agree(
                &SLEIGH,
                |sleigh, state| generated::impact(sleigh, tip, state),
                |sleigh, state| impact(&sleigh.0, tip, numbers(state)).into(),
            );
        }
    }

    #[test]
    fn the_sleigh_on_its_constraint_by_hand_is_the_generated_one() {
        assert_states_agree(&MODEL, generated::rate, |sleigh, state| {
            reduced_rate(sleigh, numbers(state)).into()
        });
        assert_numbers_agree(&MODEL, generated::energy, |sleigh, state| {
            reduced_energy(sleigh, numbers(state))
        });
        for tip in 0..2 {
            assert_states_agree(
                &MODEL,
                |sleigh, state| generated::impact(sleigh, tip, state),
                |sleigh, state| reduced_impact(sleigh, tip, numbers(state)).into(),
            );
        }
    }
}
