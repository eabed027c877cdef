//! W3b: the right-hand side of the chain of N links, by angles and by the positions of its masses.

use std::hint::black_box;

use dalembert::{Described, StateVector, System};
use serde_json::json;

use crate::chains::*;
use crate::timing::timed;
use crate::{Plan, State};

/// Number of states that are evaluated in turn.
const STATES: usize = 64;

/// Product of the number of evaluations in one timing and the number of links.
const EVALUATIONS: usize = 1 << 17;

const GRAVITY: f64 = 9.81;

/// Measures both declarations of the chain at every size.
pub fn chains(plan: &Plan) {
    angles(&Angles2::default(), plan);
    angles(&Angles4::default(), plan);
    angles(&Angles8::default(), plan);
    angles(&Angles16::default(), plan);
    angles(&Angles32::default(), plan);
    rods(&Rods2::default(), plan);
    rods(&Rods4::default(), plan);
    rods(&Rods8::default(), plan);
    rods(&Rods16::default(), plan);
    rods(&Rods32::default(), plan);
}

/// Random angles and angular velocities, from a fixed seed.
fn motions(links: usize) -> Vec<(Vec<f64>, Vec<f64>)> {
    let mut seed = links as u64;
    let mut random = |size: f64| {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        size * ((seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    };
    let mut vector = |size: f64| (0..links).map(|_| random(size)).collect();
    (0..STATES).map(|_| (vector(2.0), vector(1.0))).collect()
}

/// `sum_j (N - max(i, j)) (cos(theta_i - theta_j) a_j + sin(theta_i - theta_j) omega_j^2) + (N - i) g sin(theta_i)`
/// with indices from 0, and the sum of the absolute values of its terms. The first sum vanishes if `a` are the angular
/// accelerations.
fn residual(theta: &[f64], omega: &[f64], a: &[f64], i: usize) -> (f64, f64) {
    let weight = (theta.len() - i) as f64 * GRAVITY * theta[i].sin();
    let (mut sum, mut size) = (weight, weight.abs());
    for j in 0..theta.len() {
        let carried = (theta.len() - i.max(j)) as f64;
        let (sin, cos) = (theta[i] - theta[j]).sin_cos();
        for term in [carried * cos * a[j], carried * sin * omega[j] * omega[j]] {
            sum += term;
            size += term.abs();
        }
    }
    (sum, size)
}

/// Measures the chain by angles. The rate must return `qdot`, and `pdot = dL/dtheta`.
fn angles<S: System + Described>(chain: &S, plan: &Plan) {
    let mut error = 0.0_f64;
    let mut states = Vec::new();
    for (theta, omega) in motions(dimension::<S>()) {
        let state = state(chain, &theta, &omega);
        let rate = rate(chain, &state);
        let (qdot, pdot) = rate.as_slice().split_at(theta.len());
        for i in 0..theta.len() {
            error = error.max((qdot[i] - omega[i]).abs());
            let (difference, size) = torque(&theta, &omega, pdot[i], i);
            error = error.max((difference / size).abs());
        }
        states.push(state);
    }
    report("dalembert-angles", chain, &states, error, plan);
}

/// `pdot_i - dL/dtheta_i`, and the sum of the absolute values of its terms.
fn torque(theta: &[f64], omega: &[f64], pdot: f64, i: usize) -> (f64, f64) {
    let weight = (theta.len() - i) as f64 * GRAVITY * theta[i].sin();
    let (mut sum, mut size) = (pdot + weight, pdot.abs() + weight.abs());
    for j in 0..theta.len() {
        let carried = (theta.len() - i.max(j)) as f64;
        let term = carried * (theta[i] - theta[j]).sin() * omega[i] * omega[j];
        sum += term;
        size += term.abs();
    }
    (sum, size)
}

/// Measures the chain by positions. An angular acceleration is the component across the rod of the difference of the
/// accelerations of neighbouring masses.
fn rods<S: System + Described>(chain: &S, plan: &Plan) {
    let mut error = 0.0_f64;
    let mut states = Vec::new();
    for (theta, omega) in motions(dimension::<S>() / 2) {
        let state = state(chain, &places(&theta), &velocities(&theta, &omega));
        let rate = rate(chain, &state);
        let accelerations = &rate.as_slice()[2 * theta.len()..];
        let a = across(&theta, accelerations);
        for i in 0..theta.len() {
            let (sum, size) = residual(&theta, &omega, &a, i);
            error = error.max((sum / size).abs());
        }
        states.push(state);
    }
    report("dalembert-rods", chain, &states, error, plan);
}

fn dimension<S: Described>() -> usize {
    S::DESCRIPTION.coordinates.len()
}

/// Positions of the masses: all `x`, then all `y`.
fn places(theta: &[f64]) -> Vec<f64> {
    let x = sums(theta.iter().map(|theta| theta.sin()));
    let y = sums(theta.iter().map(|theta| -theta.cos()));
    [x, y].concat()
}

fn velocities(theta: &[f64], omega: &[f64]) -> Vec<f64> {
    let x = sums(
        theta
            .iter()
            .zip(omega)
            .map(|(theta, omega)| omega * theta.cos()),
    );
    let y = sums(
        theta
            .iter()
            .zip(omega)
            .map(|(theta, omega)| omega * theta.sin()),
    );
    [x, y].concat()
}

/// Partial sums.
fn sums(terms: impl Iterator<Item = f64>) -> Vec<f64> {
    terms
        .scan(0.0, |sum, term| {
            *sum += term;
            Some(*sum)
        })
        .collect()
}

fn across(theta: &[f64], accelerations: &[f64]) -> Vec<f64> {
    let (x, y) = accelerations.split_at(theta.len());
    let step = |values: &[f64], i: usize| values[i] - if i == 0 { 0.0 } else { values[i - 1] };
    (0..theta.len())
        .map(|i| step(x, i) * theta[i].cos() + step(y, i) * theta[i].sin())
        .collect()
}

fn state<S: System>(chain: &S, q: &[f64], qdot: &[f64]) -> State<S> {
    let (mut place, mut velocity) = (S::Vector::zeros(S::Vector::CAPACITY), S::Vector::zeros(S::Vector::CAPACITY));
    place.as_mut_slice().copy_from_slice(q);
    velocity.as_mut_slice().copy_from_slice(qdot);
    chain
        .state_unchecked(0.0, &place, &velocity)
        .expect("a state")
}

fn rate<S: System>(chain: &S, state: &State<S>) -> State<S> {
    let mut rate = chain.zero_state();
    chain.rate(0.0, state, &mut rate).expect("a rate");
    rate
}

fn report<S: System + Described>(
    peer: &str,
    chain: &S,
    states: &[State<S>],
    error: f64,
    plan: &Plan,
) {
    let links = states[0].as_slice().len() / if peer == "dalembert-rods" { 4 } else { 2 };
    let rounds = (EVALUATIONS / links / STATES).max(1);
    let times = (0..plan.repetitions).map(|_| {
        let (time, ()) = timed(|| {
            for _ in 0..rounds {
                for state in states {
                    black_box(rate(chain, black_box(state)));
                }
            }
        });
        time.as_secs_f64() * 1e9 / (rounds * STATES) as f64
    });
    let time = times.fold(f64::INFINITY, f64::min);
    println!(
        "{}",
        json!({ "peer": peer, "work": "W3b", "n": links, "ns": time, "relerr": error })
    );
}
