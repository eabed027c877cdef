//! The chain of N links by two methods: with the metric as a matrix, and link by link in O(N).

use dalembert::{StateVector, VectorField};
use dalembert_models::{Chain2, Chain3, Chain4, Chain8, Chain16};

use super::number::{Number, parameters};
use crate::State;

/// A shipped chain of N links.
pub trait Chain<const N: usize>: VectorField {
    /// The parameters of the chain.
    fn rods<T: Number>(&self) -> Rods<T>;
}

/// The parameters of a chain: mass of a bob, length of a rod, gravity.
#[derive(Debug, Clone, Copy)]
pub struct Rods<T> {
    m: T,
    l: T,
    g: T,
}

macro_rules! chains {
    ($($chain:ident $links:literal)*) => {$(
        impl Chain<$links> for $chain {
            #[inline(always)]
            fn rods<T: Number>(&self) -> Rods<T> {
                let [m, l, g] = parameters::<T, _>([self.m, self.l, self.g]);
                Rods { m, l, g }
            }
        }
    )*};
}

chains! { Chain2 2 Chain3 3 Chain4 4 Chain8 8 Chain16 16 }

/// Angles and momenta of a state.
#[inline(always)]
fn halves<const N: usize>(state: &impl StateVector) -> ([f64; N], [f64; N]) {
    let components = state.as_slice();
    let (mut theta, mut p) = ([0.0; N], [0.0; N]);
    theta.copy_from_slice(&components[..N]);
    p.copy_from_slice(&components[N..2 * N]);
    (theta, p)
}

/// A state or its rate, from its two halves.
#[inline(always)]
fn join<const N: usize, S: StateVector>(first: [f64; N], second: [f64; N]) -> S {
    let mut state = S::zeros(2 * N);
    let components = state.as_mut_slice();
    components[..N].copy_from_slice(&first);
    components[N..2 * N].copy_from_slice(&second);
    state
}

/// Sines and cosines of the angles.
#[inline(always)]
fn directions<T: Number, const N: usize>(theta: &[T; N]) -> ([T; N], [T; N]) {
    let (mut sin, mut cos) = (*theta, *theta);
    for i in 0..N {
        (sin[i], cos[i]) = theta[i].sin_cos();
    }
    (sin, cos)
}

/// `g^{-1} p` by LDL^T of the metric `g_jk = (N - max(j, k)) m l^2 cos(theta_j - theta_k)`, with indices from 0. The
/// rows of the upper triangle are used, so that the inner loops run through memory in order.
#[inline(always)]
fn velocities<T: Number, const N: usize>(
    rods: Rods<T>,
    sin: &[T; N],
    cos: &[T; N],
    p: [T; N],
) -> [T; N] {
    let unit = rods.m * rods.l * rods.l;
    let mut g = [[unit; N]; N];
    for j in 0..N {
        for k in j..N {
            g[j][k] = unit.times((N - k) as f64) * (cos[j] * cos[k] + sin[j] * sin[k]);
        }
    }
    let mut omega = p;
    let mut inverse_pivot = p;
    for j in 0..N {
        let pivot_row = g[j];
        inverse_pivot[j] = pivot_row[j].reciprocal();
        for i in j + 1..N {
            let factor = pivot_row[i] * inverse_pivot[j];
            for k in i..N {
                g[i][k] = g[i][k] - factor * pivot_row[k];
            }
            omega[i] = omega[i] - factor * omega[j];
        }
    }
    for i in (0..N).rev() {
        let mut rest = omega[i];
        for k in i + 1..N {
            rest = rest - g[i][k] * omega[k];
        }
        omega[i] = rest * inverse_pivot[i];
    }
    omega
}

/// `g^{-1} p`, and `dL/dtheta` as a double sum.
#[inline(always)]
pub fn motion<T: Number, const N: usize>(
    rods: Rods<T>,
    theta: [T; N],
    p: [T; N],
) -> ([T; N], [T; N]) {
    let (sin, cos) = directions(&theta);
    let omega = velocities(rods, &sin, &cos, p);
    let unit = rods.m * rods.l * rods.l;
    let weight = rods.m * rods.g * rods.l;
    let mut force = omega;
    for i in 0..N {
        force[i] = -(weight.times((N - i) as f64) * sin[i]);
    }
    for i in 0..N {
        for j in 0..i {
            let sine = sin[i] * cos[j] - cos[i] * sin[j];
            let turning = unit.times((N - i) as f64) * sine * omega[i] * omega[j];
            force[i] = force[i] - turning;
            force[j] = force[j] + turning;
        }
    }
    (omega, force)
}

/// The rate, by factorisation of the metric.
#[inline]
pub fn rate<const N: usize, S: Chain<N>>(chain: &S, state: &State<S>) -> State<S> {
    let (theta, p) = halves::<N>(state);
    let (omega, force) = motion(chain.rods(), theta, p);
    join(omega, force)
}

/// Kinetic and potential energy.
#[inline]
pub fn energy<const N: usize, S: Chain<N>>(chain: &S, state: &State<S>) -> f64 {
    let (theta, p) = halves::<N>(state);
    energy_of(chain.rods(), theta, p)
}

/// The energy in any number type.
#[inline(always)]
pub fn energy_of<T: Number, const N: usize>(rods: Rods<T>, theta: [T; N], p: [T; N]) -> T {
    let (sin, cos) = directions(&theta);
    let omega = velocities(rods, &sin, &cos, p);
    total(rods, &cos, &p, &omega)
}

/// `p.omega/2 + V`.
#[inline(always)]
fn total<T: Number, const N: usize>(rods: Rods<T>, cos: &[T; N], p: &[T; N], omega: &[T; N]) -> T {
    let (mut kinetic, mut drop) = (p[0] * omega[0], cos[0].times(N as f64));
    for i in 1..N {
        kinetic = kinetic + p[i] * omega[i];
        drop = drop + cos[i].times((N - i) as f64);
    }
    kinetic.times(0.5) - rods.m * rods.g * rods.l * drop
}

/// Angular velocities of the links, and for each link `i` the momentum `P_i` of all bobs from it down, in two passes.
///
/// `p_i = l t_i.P_i`, where `t_i = (cos theta_i, sin theta_i)` is the direction in which bob `i` moves about the bob
/// above. The pass from the last link up finds `P_i = A_i v_{i-1} + b_i`. Here `v_{i-1}` is the velocity of the bob
/// above, and the symmetric matrix `A_i` is the inertia that it feels. The pass from the first link down finds the
/// velocities one by one.
#[inline(always)]
fn link_by_link<const N: usize>(
    rods: Rods<f64>,
    sin: &[f64; N],
    cos: &[f64; N],
    p: &[f64; N],
) -> ([f64; N], [[f64; 2]; N]) {
    // For link i: B t, 1/(t.B t) and p/l - t.b, where B = m + A_{i+1} is the inertia of bob i and all links below it,
    // and b = b_{i+1}.
    let (mut carried, mut inverse, mut excess) = ([[0.0; 2]; N], [0.0; N], [0.0; N]);
    let (mut matrices, mut offsets) = ([[0.0; 3]; N], [[0.0; 2]; N]);
    let (mut a, mut b) = ([0.0; 3], [0.0; 2]);
    for i in (0..N).rev() {
        let [xx, xy, yy] = [a[0] + rods.m, a[1], a[2] + rods.m];
        let [x, y] = [xx * cos[i] + xy * sin[i], xy * cos[i] + yy * sin[i]];
        let scale = 1.0 / (cos[i] * x + sin[i] * y);
        let missing = p[i] / rods.l - (cos[i] * b[0] + sin[i] * b[1]);
        (matrices[i], offsets[i]) = ([xx, xy, yy], b);
        (carried[i], inverse[i], excess[i]) = ([x, y], scale, missing);
        a = [xx - x * x * scale, xy - x * y * scale, yy - y * y * scale];
        b = [b[0] + x * missing * scale, b[1] + y * missing * scale];
    }
    let (mut omega, mut momenta, mut v) = ([0.0; N], [[0.0; 2]; N], [0.0; 2]);
    for i in 0..N {
        let speed = (excess[i] - (carried[i][0] * v[0] + carried[i][1] * v[1])) * inverse[i];
        omega[i] = speed / rods.l;
        v = [v[0] + speed * cos[i], v[1] + speed * sin[i]];
        let ([xx, xy, yy], b) = (matrices[i], offsets[i]);
        momenta[i] = [xx * v[0] + xy * v[1] + b[0], xy * v[0] + yy * v[1] + b[1]];
    }
    (omega, momenta)
}

/// The rate by links: `dL/dtheta_i = l omega_i n_i.P_i - (N - i) m g l sin(theta_i)`, where `n_i` is `dt_i/dtheta_i`.
#[inline]
pub fn rate_by_links<const N: usize, S: Chain<N>>(chain: &S, state: &State<S>) -> State<S> {
    let rods = chain.rods();
    let (theta, p) = halves::<N>(state);
    let (sin, cos) = directions(&theta);
    let (omega, momenta) = link_by_link(rods, &sin, &cos, &p);
    let mut force = [0.0; N];
    for i in 0..N {
        let across = cos[i] * momenta[i][1] - sin[i] * momenta[i][0];
        let weight = (N - i) as f64 * rods.m * rods.g;
        force[i] = rods.l * (omega[i] * across - weight * sin[i]);
    }
    join(omega, force)
}

/// The energy with the velocities found link by link.
#[inline]
pub fn energy_by_links<const N: usize, S: Chain<N>>(chain: &S, state: &State<S>) -> f64 {
    let rods = chain.rods();
    let (theta, p) = halves::<N>(state);
    let (sin, cos) = directions(&theta);
    let (omega, _) = link_by_link(rods, &sin, &cos, &p);
    total(rods, &cos, &p, &omega)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated;
    use crate::hand::agreement::{assert_numbers_agree, assert_states_agree};
    use dalembert::Described;

    fn compare<const N: usize, S: Chain<N> + Described>(chain: S) {
        assert_states_agree(&chain, generated::rate, rate);
        assert_states_agree(&chain, generated::rate, rate_by_links);
        assert_numbers_agree(&chain, generated::energy, energy);
        assert_numbers_agree(&chain, generated::energy, energy_by_links);
    }

    #[test]
    fn the_chain_by_hand_is_the_generated_one() {
        let (m, l, g) = (1.3, 0.7, 9.81);
        compare(Chain2 { m, l, g });
        compare(Chain3 { m, l, g });
        compare(Chain4 { m, l, g });
        compare(Chain8 { m, l, g });
        compare(Chain16 { m, l, g });
    }
}
