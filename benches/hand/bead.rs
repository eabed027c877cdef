//! The bead on an ellipse: an integrable constraint, in the global form.

use dalembert_models::HolonomicBeadOnEllipses;

use super::number::{Number, parameters};

/// Normal of the ellipse: half the gradient of `x^2/a^2 + y^2/b^2`.
#[inline(always)]
fn normal<T: Number>(bead: &HolonomicBeadOnEllipses, [x, y]: [T; 2]) -> [T; 2] {
    let [a, b] = parameters::<T, _>([bead.A, bead.B]);
    [x / (a * a), y / (b * b)]
}

/// Hamilton's equations with the normal force that keeps the bead on its ellipse.
#[inline(always)]
pub fn rate<T: Number>(bead: &HolonomicBeadOnEllipses, [x, y, p_x, p_y]: [T; 4]) -> [T; 4] {
    let [m, a, b] = parameters::<T, _>([bead.m, bead.A, bead.B]);
    let light = m.reciprocal();
    let (v_x, v_y) = (p_x * light, p_y * light);
    let (flat, steep) = ((a * a).reciprocal(), (b * b).reciprocal());
    let (n_x, n_y) = (x * flat, y * steep);
    let curving = v_x * v_x * flat + v_y * v_y * steep;
    let force = -(m * curving / (n_x * n_x + n_y * n_y));
    [v_x, v_y, force * n_x, force * n_y]
}

/// Kinetic energy.
#[inline(always)]
pub fn energy<T: Number>(bead: &HolonomicBeadOnEllipses, [_, _, p_x, p_y]: [T; 4]) -> T {
    let [m] = parameters::<T, _>([bead.m]);
    ((p_x * p_x + p_y * p_y) / m).times(0.5)
}

/// Reverses the momentum along the ellipse.
#[inline(always)]
pub fn impact<T: Number>(bead: &HolonomicBeadOnEllipses, [x, y, p_x, p_y]: [T; 4]) -> [T; 4] {
    let [n_x, n_y] = normal(bead, [x, y]);
    let eps = (p_x * n_y - p_y * n_x).times(-2.0) / (n_x * n_x + n_y * n_y);
    [x, y, p_x + eps * n_y, p_y - eps * n_x]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated;
    use crate::hand::agreement::{assert_numbers_agree, assert_states_agree};
    use crate::hand::number::numbers;

    const BEAD: HolonomicBeadOnEllipses = HolonomicBeadOnEllipses {
        m: 1.3,
        A: 1.7,
        B: 0.8,
    };

    #[test]
    fn the_bead_by_hand_is_the_generated_one() {
        assert_states_agree(&BEAD, generated::rate, |bead, state| {
            rate(bead, numbers(state)).into()
        });
        assert_numbers_agree(&BEAD, generated::energy, |bead, state| {
            energy(bead, numbers(state))
        });
        assert_states_agree(
            &BEAD,
            |bead, state| generated::impact(bead, 0, state),
            |bead, state| impact(bead, numbers(state)).into(),
        );
    }
}
