//! The rolling disk: two constraints, whose multipliers solve two linear equations.

use dalembert_models::RollingDisk;

use super::number::{Number, parameters};

/// Hamilton's equations with the multipliers from `m lambda = -gamma` by Cramer's rule, where `m^{ab} = eta^a(W^b)` and
/// `gamma^a` is the rate of `eta^a(qdot)` at constant velocity.
#[inline(always)]
pub fn rate<T: Number>(
    disk: &RollingDisk,
    [_, _, _, phi, p_x, p_y, p_theta, p_phi]: [T; 8],
) -> [T; 8] {
    let [m, r, i, j] = parameters::<T, _>([disk.m, disk.R, disk.I, disk.J]);
    let (sin, cos) = phi.sin_cos();
    let (roll, turn) = (p_theta / i, p_phi / j);
    let (light, k) = (m.reciprocal(), r * r / i);
    let (m11, m12, m22) = (light + k * cos * cos, k * sin * cos, light + k * sin * sin);
    let speed = r * turn * roll;
    let (gamma1, gamma2) = (speed * sin, -speed * cos);
    let scale = (m11 * m22 - m12 * m12).reciprocal();
    let lambda1 = (m12 * gamma2 - m22 * gamma1) * scale;
    let lambda2 = (m12 * gamma1 - m11 * gamma2) * scale;
    let torque = -r * (cos * lambda1 + sin * lambda2);
    let none = T::of(0.0);
    [
        p_x * light,
        p_y * light,
        roll,
        turn,
        lambda1,
        lambda2,
        torque,
        none,
    ]
}

/// Same as [`rate`], with the multipliers in closed form: the constraint forces turn the velocity and leave the angular
/// velocities unchanged.
#[inline(always)]
pub fn rate_in_closed_form<T: Number>(
    disk: &RollingDisk,
    [_, _, _, phi, p_x, p_y, p_theta, p_phi]: [T; 8],
) -> [T; 8] {
    let [m, r, i, j] = parameters::<T, _>([disk.m, disk.R, disk.I, disk.J]);
    let (sin, cos) = phi.sin_cos();
    let (roll, turn) = (p_theta / i, p_phi / j);
    let light = m.reciprocal();
    let force = m * r * roll * turn;
    let none = T::of(0.0);
    [
        p_x * light,
        p_y * light,
        roll,
        turn,
        -force * sin,
        force * cos,
        none,
        none,
    ]
}

/// Kinetic energy.
#[inline(always)]
pub fn energy<T: Number>(disk: &RollingDisk, [_, _, _, _, p_x, p_y, p_theta, p_phi]: [T; 8]) -> T {
    let [m, i, j] = parameters::<T, _>([disk.m, disk.I, disk.J]);
    let slide = (p_x * p_x + p_y * p_y) / m;
    (slide + p_theta * p_theta / i + p_phi * p_phi / j).times(0.5)
}

/// The derivatives of the gap of an edge (0 leading, 1 trailing) along the frame of D, whose fields roll the disk and
/// turn it. Also sine and cosine of the direction.
#[inline(always)]
fn edge_gradient<T: Number>(
    disk: &RollingDisk,
    edge: usize,
    [x, y, phi]: [T; 3],
) -> ([T; 2], (T, T)) {
    let reach = if edge == 0 { disk.R } else { -disk.R };
    let [r, reach, a, b] = parameters::<T, _>([disk.R, reach, disk.ta, disk.tb]);
    let (sin, cos) = phi.sin_cos();
    let h_x = (x + reach * cos).times(-2.0) / (a * a);
    let h_y = (y + reach * sin).times(-2.0) / (b * b);
    let h_roll = r * (h_x * cos + h_y * sin);
    let h_turn = reach * (h_y * cos - h_x * sin);
    ([h_roll, h_turn], (sin, cos))
}

/// Elastic impact of an edge, by the projected gradient `(n_roll, n_turn)` in the frame of D. The fields of rolling and
/// turning are orthogonal.
#[inline(always)]
pub fn impact<T: Number>(
    disk: &RollingDisk,
    edge: usize,
    [x, y, theta, phi, p_x, p_y, p_theta, p_phi]: [T; 8],
) -> [T; 8] {
    let [m, r, i, j] = parameters::<T, _>([disk.m, disk.R, disk.I, disk.J]);
    let ([h_roll, h_turn], (sin, cos)) = edge_gradient(disk, edge, [x, y, phi]);
    let (n_roll, n_turn) = (h_roll / (i + m * r * r), h_turn / j);
    let rate = n_roll * (r * (p_x * cos + p_y * sin) + p_theta) + n_turn * p_phi;
    let eps = rate.times(-2.0) / (h_roll * n_roll + h_turn * n_turn);
    let push = eps * m * r * n_roll;
    [
        x,
        y,
        theta,
        phi,
        p_x + push * cos,
        p_y + push * sin,
        p_theta + eps * i * n_roll,
        p_phi + eps * h_turn,
    ]
}

/// The rate on D, where the angular velocities of rolling and turning are constant.
#[inline(always)]
pub fn reduced_rate<T: Number>(disk: &RollingDisk, [_, _, _, phi, roll, turn]: [T; 6]) -> [T; 6] {
    let [r] = parameters::<T, _>([disk.R]);
    let ((sin, cos), none) = (phi.sin_cos(), T::of(0.0));
    let speed = r * roll;
    [speed * cos, speed * sin, roll, turn, none, none]
}

/// Kinetic energy on D.
#[inline(always)]
pub fn reduced_energy<T: Number>(disk: &RollingDisk, [_, _, _, _, roll, turn]: [T; 6]) -> T {
    let [m, r, i, j] = parameters::<T, _>([disk.m, disk.R, disk.I, disk.J]);
    ((i + m * r * r) * roll * roll + j * turn * turn).times(0.5)
}

/// Elastic impact of an edge on D.
#[inline(always)]
pub fn reduced_impact<T: Number>(
    disk: &RollingDisk,
    edge: usize,
    [x, y, theta, phi, roll, turn]: [T; 6],
) -> [T; 6] {
    let [m, r, i, j] = parameters::<T, _>([disk.m, disk.R, disk.I, disk.J]);
    let ([h_roll, h_turn], _) = edge_gradient(disk, edge, [x, y, phi]);
    let (n_roll, n_turn) = (h_roll / (i + m * r * r), h_turn / j);
    let eps = (h_roll * roll + h_turn * turn).times(-2.0) / (h_roll * n_roll + h_turn * n_turn);
    [x, y, theta, phi, roll + eps * n_roll, turn + eps * n_turn]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated;
    use crate::hand::agreement::{assert_numbers_agree, assert_states_agree};
    use crate::hand::number::numbers;
    use dalembert_models::rolling_disk::RollingDiskGlobal as Global;

    const MODEL: RollingDisk = RollingDisk {
        m: 0.3,
        R: 0.4,
        I: 0.05,
        J: 0.07,
        ta: 1.5,
        tb: 2.0,
    };
    const DISK: Global = Global(MODEL);

    #[test]
    fn the_disk_by_hand_is_the_generated_one() {
        assert_states_agree(&DISK, generated::rate, |disk, state| {
            rate(&disk.0, numbers(state)).into()
        });
        assert_states_agree(&DISK, generated::rate, |disk, state| {
            rate_in_closed_form(&disk.0, numbers(state)).into()
        });
        assert_numbers_agree(&DISK, generated::energy, |disk, state| {
            energy(&disk.0, numbers(state))
        });
        for edge in 0..2 {
            assert_states_agree(
                &DISK,
                |disk, state| generated::impact(disk, edge, state),
                |disk, state| impact(&disk.0, edge, numbers(state)).into(),
            );
        }
    }

    #[test]
    fn the_disk_on_its_constraints_by_hand_is_the_generated_one() {
        assert_states_agree(&MODEL, generated::rate, |disk, state| {
            reduced_rate(disk, numbers(state)).into()
        });
        assert_numbers_agree(&MODEL, generated::energy, |disk, state| {
            reduced_energy(disk, numbers(state))
        });
        for edge in 0..2 {
            assert_states_agree(
                &MODEL,
                |disk, state| generated::impact(disk, edge, state),
                |disk, state| reduced_impact(disk, edge, numbers(state)).into(),
            );
        }
    }
}
