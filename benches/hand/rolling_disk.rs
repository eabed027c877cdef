//! The rolling disk: two constraints, so a system of two equations for the multipliers.

use dalembert_models::RollingDisk;
use dalembert_models::rolling_disk::RollingDiskGlobal as Global;

use crate::State;

type DiskState = State<Global>;
/// On D.
type ReducedDiskState = State<RollingDisk>;

/// `m lambda = -gamma` by Cramer's rule, with `m^{ab} = eta^a(W^b)` and `gamma^a` the rate of `eta^a(qdot)` at constant
/// velocity.
#[inline]
pub fn rate(disk: &Global, state: &DiskState) -> DiskState {
    let disk = &disk.0;
    let [_, _, _, phi, p_x, p_y, p_theta, p_phi]: [f64; 8] = (*state).into();
    let (sin, cos) = phi.sin_cos();
    let (roll, turn) = (p_theta / disk.I, p_phi / disk.J);
    let (light, k) = (1.0 / disk.m, disk.R * disk.R / disk.I);
    let (m11, m12, m22) = (light + k * cos * cos, k * sin * cos, light + k * sin * sin);
    let speed = disk.R * turn * roll;
    let (gamma1, gamma2) = (speed * sin, -speed * cos);
    let scale = 1.0 / (m11 * m22 - m12 * m12);
    let lambda1 = (m12 * gamma2 - m22 * gamma1) * scale;
    let lambda2 = (m12 * gamma1 - m11 * gamma2) * scale;
    let torque = -disk.R * (cos * lambda1 + sin * lambda2);
    let velocity = [p_x * light, p_y * light, roll, turn];
    let [x, y, theta, phi] = velocity;
    [x, y, theta, phi, lambda1, lambda2, torque, 0.0].into()
}

/// The multipliers in closed form: the forces of rolling turn the velocity and do not touch the spin.
#[inline]
pub fn rate_in_closed_form(disk: &Global, state: &DiskState) -> DiskState {
    let disk = &disk.0;
    let [_, _, _, phi, p_x, p_y, p_theta, p_phi]: [f64; 8] = (*state).into();
    let (sin, cos) = phi.sin_cos();
    let (roll, turn) = (p_theta / disk.I, p_phi / disk.J);
    let light = 1.0 / disk.m;
    let force = disk.m * disk.R * roll * turn;
    let velocity = [p_x * light, p_y * light, roll, turn];
    let [x, y, theta, phi] = velocity;
    [x, y, theta, phi, -force * sin, force * cos, 0.0, 0.0].into()
}

/// Kinetic energy.
#[inline]
pub fn energy(disk: &Global, state: &DiskState) -> f64 {
    let disk = &disk.0;
    let [_, _, _, _, p_x, p_y, p_theta, p_phi]: [f64; 8] = (*state).into();
    let slide = (p_x * p_x + p_y * p_y) / disk.m;
    0.5 * (slide + p_theta * p_theta / disk.I + p_phi * p_phi / disk.J)
}

/// Elastic impact of an edge, 0 leading, 1 trailing. The projected gradient in the frame of D: `n_roll` along rolling
/// and `n_turn` along turning, which are orthogonal.
#[inline]
pub fn impact(disk: &Global, edge: usize, state: &DiskState) -> DiskState {
    let disk = &disk.0;
    let [x, y, theta, phi, p_x, p_y, p_theta, p_phi]: [f64; 8] = (*state).into();
    let (sin, cos) = phi.sin_cos();
    let reach = if edge == 0 { disk.R } else { -disk.R };
    let h_x = -2.0 * (x + reach * cos) / (disk.ta * disk.ta);
    let h_y = -2.0 * (y + reach * sin) / (disk.tb * disk.tb);
    let h_roll = disk.R * (h_x * cos + h_y * sin);
    let h_turn = reach * (h_y * cos - h_x * sin);
    let n_roll = h_roll / (disk.I + disk.m * disk.R * disk.R);
    let n_turn = h_turn / disk.J;
    let rate = n_roll * (disk.R * (p_x * cos + p_y * sin) + p_theta) + n_turn * p_phi;
    let eps = -2.0 * rate / (h_roll * n_roll + h_turn * n_turn);
    let push = eps * disk.m * disk.R * n_roll;
    let p_theta = p_theta + eps * disk.I * n_roll;
    [
        x,
        y,
        theta,
        phi,
        p_x + push * cos,
        p_y + push * sin,
        p_theta,
        p_phi + eps * h_turn,
    ]
    .into()
}

/// On D: roll and turn keep their rates.
#[inline]
pub fn reduced_rate(disk: &RollingDisk, state: &ReducedDiskState) -> ReducedDiskState {
    let [_, _, _, phi, roll, turn]: [f64; 6] = (*state).into();
    let (sin, cos) = phi.sin_cos();
    let speed = disk.R * roll;
    [speed * cos, speed * sin, roll, turn, 0.0, 0.0].into()
}

/// Kinetic energy on D.
#[inline]
pub fn reduced_energy(disk: &RollingDisk, state: &ReducedDiskState) -> f64 {
    let [_, _, _, _, roll, turn]: [f64; 6] = (*state).into();
    0.5 * ((disk.I + disk.m * disk.R * disk.R) * roll * roll + disk.J * turn * turn)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated;
    use crate::hand::agreement::{assert_numbers_agree, assert_states_agree};

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
        assert_states_agree(&DISK, generated::rate, rate);
        assert_states_agree(&DISK, generated::rate, rate_in_closed_form);
        assert_numbers_agree(&DISK, generated::energy, energy);
        assert_states_agree(&MODEL, generated::rate, reduced_rate);
        assert_numbers_agree(&MODEL, generated::energy, reduced_energy);
        for edge in 0..2 {
            assert_states_agree(
                &DISK,
                |disk, state| generated::impact(disk, edge, state),
                |disk, state| impact(disk, edge, state),
            );
        }
    }
}
