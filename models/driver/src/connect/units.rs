//! Units of the unknowns of a search, and the energies that its problem suggests.

use dalembert::contract::Variational;
use dalembert::describe::Topology;
use dalembert::{Instance, Scene, StateVector};

use super::Boundary;
use super::least_squares::norm;
use crate::typed::vector;

/// Units of the unknowns and of their size.
#[derive(Debug, Clone)]
pub(super) struct Units {
    /// The value of each unknown whose kinetic energy is 1/2.
    pub unknowns: Vec<f64>,
    /// Root of twice the kinetic energy that the problem suggests.
    pub speed: f64,
    /// Size of the coordinates of the problem.
    pub size: f64,
    /// True if the model has surfaces.
    pub has_surfaces: bool,
}

/// Number of places on a circle or a line at which the potential energy is compared.
const PLACES: usize = 32;

/// The energies that a problem suggests: of uniform motion from one configuration to the other, of the velocity that the
/// forces at the start give in the time, and of the differences of the potential about the configurations.
pub(super) fn units<S: Instance + Scene + Variational>(
    system: &S,
    boundary: &Boundary,
    rest: &S::State,
    [start, count]: [usize; 2],
) -> Units {
    let energy = |state: &S::State| system.energy(0.0, state).unwrap_or(f64::NAN);
    let with = |w: &[f64]| {
        let mut state = *rest;
        state.as_mut_slice()[start..start + count].copy_from_slice(w);
        energy(&state) - energy(rest)
    };
    let unknown = |index: usize| {
        let sides = with(&unit(count, index))
            + with(&unit(count, index).iter().map(|w| -w).collect::<Vec<_>>());
        match sides > 0.0 && sides.is_finite() {
            true => 1.0 / sides.sqrt(),
            false => 1.0,
        }
    };
    let unknowns: Vec<f64> = (0..count).map(unknown).collect();
    let speed_of = |w: &[f64]| {
        let parts: Vec<f64> = w.iter().zip(&unknowns).map(|(w, unit)| w / unit).collect();
        norm(&parts)
    };
    let mut rate = system.zero_state();
    let fallen = match system.rate(0.0, rest, &mut rate) {
        Ok(()) => {
            let rates = &rate.as_slice()[start..start + count];
            speed_of(
                &rates
                    .iter()
                    .map(|rate| rate * boundary.time)
                    .collect::<Vec<_>>(),
            )
        }
        Err(_) => 0.0,
    };
    let q = system.position(rest);
    let ways = boundary.to.iter().zip(q.as_slice());
    let ways: Vec<f64> = ways
        .map(|(to, from)| to.map_or(0.0, |to| to - from))
        .collect();
    let speed_along = |way: &[f64]| {
        let rates: Vec<f64> = way.iter().map(|way| way / boundary.time).collect();
        let state = system.state_nearest(0.0, &q, &vector(&q, &rates));
        state.map_or(0.0, |state| {
            speed_of(&state.as_slice()[start..start + count])
        })
    };
    let climbed = (2.0 * climb(system, &q, &ways)).sqrt();
    let suggested = [fallen, speed_along(&ways), climbed];
    let suggested = suggested.into_iter().filter(|it| it.is_finite());
    let mut speed = suggested.fold(0.0, f64::max);
    if speed == 0.0 {
        speed = speed_along(&vec![1.0; ways.len()]);
    }
    let coordinates = boundary.to.iter().flatten().chain(q.as_slice());
    let size = coordinates
        .chain(&ways)
        .fold(0.0_f64, |most, it| most.max(it.abs()));
    Units {
        unknowns,
        speed: if speed > 0.0 { speed } else { 1.0 },
        size: if size > 0.0 { size } else { 1.0 },
        has_surfaces: !system.description().surfaces.is_empty(),
    }
}

/// The largest rise of the potential energy above the start, on whole turns of angles and on lines through both
/// configurations.
fn climb<S: Instance + Scene + Variational>(system: &S, q: &S::Vector, ways: &[f64]) -> f64 {
    let potential = |q: &S::Vector| {
        let state = system.state_unchecked(0.0, q, &system.zero_vector());
        let state = state
            .ok()
            .filter(|state| system.outside_chart(state).is_none());
        state.and_then(|state| system.energy(0.0, &state).ok())
    };
    let Some(start) = potential(q) else {
        return 0.0;
    };
    let coordinates = system.description().coordinates.iter();
    let mut most = 0.0_f64;
    for (index, coordinate) in coordinates.enumerate() {
        let reach = match coordinate.topology {
            Topology::Circle => std::f64::consts::TAU,
            _ => 4.0 * ways[index],
        };
        for place in 0..=PLACES {
            let mut q = *q;
            let part = place as f64 / PLACES as f64 - 0.5;
            q.as_mut_slice()[index] += part * reach;
            let rise = potential(&q).map_or(0.0, |value| value - start);
            most = if rise.is_finite() {
                most.max(rise)
            } else {
                most
            };
        }
    }
    most
}

/// A unit vector.
pub(super) fn unit(length: usize, index: usize) -> Vec<f64> {
    let mut unit = vec![0.0; length];
    unit[index] = 1.0;
    unit
}
