//! The Chaplygin sleigh: a metric with off-diagonal entries and one constraint.

use dalembert_models::ChaplyginSleigh;
use dalembert_models::chaplygin_sleigh::ChaplyginSleighGlobal as Global;

use crate::State;

type SleighState = State<Global>;
/// On D.
type ReducedSleighState = State<ChaplyginSleigh>;

/// `g^{-1} r`, from `theta = (r_theta + a (r_x sin - r_y cos))/I`.
#[inline(always)]
fn raise(
    sleigh: &ChaplyginSleigh,
    (sin, cos): (f64, f64),
    [r_x, r_y, r_theta]: [f64; 3],
) -> [f64; 3] {
    let theta = (r_theta + sleigh.a * (r_x * sin - r_y * cos)) / sleigh.I;
    let light = 1.0 / sleigh.m;
    [
        r_x * light + sleigh.a * theta * sin,
        r_y * light - sleigh.a * theta * cos,
        theta,
    ]
}

/// The one multiplier from `m^{11} lambda = -(W.(f - gdot qdot) + gamma)`.
#[inline]
pub fn rate(sleigh: &Global, state: &SleighState) -> SleighState {
    let sleigh = &sleigh.0;
    let [_, _, theta, p_x, p_y, p_theta]: [f64; 6] = (*state).into();
    let (sin, cos) = theta.sin_cos();
    let [x_dot, y_dot, spin] = raise(sleigh, (sin, cos), [p_x, p_y, p_theta]);
    let along = x_dot * cos + y_dot * sin;
    let lever = sleigh.m * sleigh.a;
    let [w_x, w_y, _] = raise(sleigh, (sin, cos), [-sin, cos, 0.0]);
    // f - gdot qdot has no component along theta: the two terms there cancel.
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
    .into()
}

/// In the frame of the blade: momenta along and across it, and the multiplier in closed form.
#[inline]
pub fn rate_in_frame(sleigh: &Global, state: &SleighState) -> SleighState {
    let sleigh = &sleigh.0;
    let [_, _, theta, p_x, p_y, p_theta]: [f64; 6] = (*state).into();
    let (sin, cos) = theta.sin_cos();
    let (along, across) = (p_x * cos + p_y * sin, p_y * cos - p_x * sin);
    let spin = (p_theta - sleigh.a * across) / sleigh.I;
    let light = 1.0 / sleigh.m;
    let slip = across * light - sleigh.a * spin;
    let speed = along * light;
    let turning = spin * along;
    let lambda = turning * sleigh.I / (sleigh.I + sleigh.m * sleigh.a * sleigh.a);
    [
        speed * cos - slip * sin,
        speed * sin + slip * cos,
        spin,
        -lambda * sin,
        lambda * cos,
        -sleigh.a * turning,
    ]
    .into()
}

/// Kinetic energy.
#[inline]
pub fn energy(sleigh: &Global, state: &SleighState) -> f64 {
    let sleigh = &sleigh.0;
    let [_, _, theta, p_x, p_y, p_theta]: [f64; 6] = (*state).into();
    let (sin, cos) = theta.sin_cos();
    let moment = p_theta + sleigh.a * (p_x * sin - p_y * cos);
    0.5 * ((p_x * p_x + p_y * p_y) / sleigh.m + moment * moment / sleigh.I)
}

/// Elastic impact of a tip, 0 front, 1 back. The projected gradient in the frame of D: along the blade and turning,
/// which are orthogonal.
#[inline]
pub fn impact(sleigh: &Global, tip: usize, state: &SleighState) -> SleighState {
    let sleigh = &sleigh.0;
    let [x, y, theta, p_x, p_y, p_theta]: [f64; 6] = (*state).into();
    let (sin, cos) = theta.sin_cos();
    let reach = if tip == 0 { sleigh.len } else { -sleigh.len };
    let h_x = -2.0 * (x + reach * cos) / (sleigh.ta * sleigh.ta);
    let h_y = -2.0 * (y + reach * sin) / (sleigh.tb * sleigh.tb);
    let h_along = h_x * cos + h_y * sin;
    let h_spin = reach * (h_y * cos - h_x * sin);
    let inertia = sleigh.I + sleigh.m * sleigh.a * sleigh.a;
    let (n_along, n_spin) = (h_along / sleigh.m, h_spin / inertia);
    let rate = n_along * (p_x * cos + p_y * sin) + n_spin * p_theta;
    let eps = -2.0 * rate / (h_along * n_along + h_spin * n_spin);
    let (push, swing) = (eps * h_along, eps * sleigh.m * sleigh.a * n_spin);
    [
        x,
        y,
        theta,
        p_x + push * cos - swing * sin,
        p_y + push * sin + swing * cos,
        p_theta + eps * h_spin,
    ]
    .into()
}

/// On D, in the frame along the blade and turning.
#[inline]
pub fn reduced_rate(sleigh: &ChaplyginSleigh, state: &ReducedSleighState) -> ReducedSleighState {
    let [_, _, theta, v, omega]: [f64; 5] = (*state).into();
    let (sin, cos) = theta.sin_cos();
    let (m, a) = (sleigh.m, sleigh.a);
    [
        v * cos,
        v * sin,
        omega,
        a * omega * omega,
        -m * a * v * omega / (sleigh.I + m * a * a),
    ]
    .into()
}

/// Kinetic energy on D.
#[inline]
pub fn reduced_energy(sleigh: &ChaplyginSleigh, state: &ReducedSleighState) -> f64 {
    let [_, _, _, v, omega]: [f64; 5] = (*state).into();
    0.5 * (sleigh.m * v * v + (sleigh.I + sleigh.m * sleigh.a * sleigh.a) * omega * omega)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated;
    use crate::hand::agreement::{assert_numbers_agree, assert_states_agree};

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
        assert_states_agree(&SLEIGH, generated::rate, rate);
        assert_states_agree(&SLEIGH, generated::rate, rate_in_frame);
        assert_numbers_agree(&SLEIGH, generated::energy, energy);
        assert_states_agree(&MODEL, generated::rate, reduced_rate);
        assert_numbers_agree(&MODEL, generated::energy, reduced_energy);
        for tip in 0..2 {
            assert_states_agree(
                &SLEIGH,
                |sleigh, state| generated::impact(sleigh, tip, state),
                |sleigh, state| impact(sleigh, tip, state),
            );
        }
    }
}
