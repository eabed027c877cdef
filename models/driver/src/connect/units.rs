//! Units of the unknowns of a search, and the energies that its problem suggests.

use dalembert::contract::Variational;
use dalembert::describe::Topology;
use dalembert::{Instance, Scene, StateVector};

use super::Boundary;
use crate::linear::norm;
use crate::typed::vector;

/// Units of the unknowns, and scales of the problem.
#[derive(Debug, Clone)]
pub(crate) struct Units {
    /// The value of each unknown at kinetic energy 1/2.
    pub unknowns: Vec<f64>,
    /// Square root of twice the kinetic energy that the problem suggests.
    pub speed: f64,
    /// Size of the coordinates of the problem.
    pub size: f64,
    /// True if the model has surfaces.
    pub has_surfaces: bool,
}

/// Number of intervals along a coordinate at whose ends the potential energy is evaluated.
const PLACES: usize = 32;

/// The units of a problem.
pub(super) fn units<S: Instance + Scene + Variational>(
    system: &S,
    boundary: &Boundary,
    rest: &S::State,
    motion: [usize; 2],
) -> Units {
    let q = system.position(rest);
    let ways = boundary.to.iter().zip(q.as_slice());
    let ways: Vec<f64> = ways
        .map(|(to, from)| to.map_or(0.0, |to| to - from))
        .collect();
    let coordinates = boundary.to.iter().flatten().chain(q.as_slice());
    let size = coordinates
        .chain(&ways)
        .fold(0.0_f64, |most, it| most.max(it.abs()));
    let problem = Problem {
        system,
        rest,
        motion,
        time: boundary.time,
    };
    let unknowns: Vec<f64> = (0..motion[1]).map(|index| problem.unit(index)).collect();
    Units {
        speed: problem.speed(&unknowns, &ways),
        unknowns,
        size: if size > 0.0 { size } else { 1.0 },
        has_surfaces: !system.description().surfaces.is_empty(),
    }
}

/// A problem, for estimates of its energies.
struct Problem<'a, S: Instance + Scene + Variational> {
    system: &'a S,
    rest: &'a S::State,
    motion: [usize; 2],
    time: f64,
}

impl<S: Instance + Scene + Variational> Problem<'_, S> {
    /// The value of an unknown at kinetic energy 1/2.
    fn unit(&self, index: usize) -> f64 {
        let [start, count] = self.motion;
        let energy = |value: f64| {
            let mut state = *self.rest;
            let unknowns = &mut state.as_mut_slice()[start..start + count];
            unknowns[index] = value;
            self.system.energy(0.0, &state).unwrap_or(f64::NAN)
        };
        let sides = energy(1.0) + energy(-1.0) - 2.0 * energy(0.0);
        match sides > 0.0 && sides.is_finite() {
            true => 1.0 / sides.sqrt(),
            false => 1.0,
        }
    }

    /// The largest of three speeds that the problem suggests: the speed of uniform motion between the configurations,
    /// the speed that the forces at the start produce in the given time, and the speed needed to climb the potential
    /// near the start.
    fn speed(&self, units: &[f64], ways: &[f64]) -> f64 {
        let [start, count] = self.motion;
        let size = |state: &S::State| {
            let unknowns = &state.as_slice()[start..start + count];
            let parts: Vec<f64> = unknowns
                .iter()
                .zip(units)
                .map(|(w, unit)| w / unit)
                .collect();
            norm(&parts)
        };
        let mut rate = self.system.zero_state();
        let fallen = match self.system.rate(0.0, self.rest, &mut rate) {
            Ok(()) => size(&rate) * self.time,
            Err(_) => 0.0,
        };
        let q = self.system.position(self.rest);
        let along = |ways: &[f64]| {
            let rates: Vec<f64> = ways.iter().map(|way| way / self.time).collect();
            let state = self.system.state_nearest(0.0, &q, &vector(&q, &rates));
            state.map_or(0.0, |state| size(&state))
        };
        let climbed = (2.0 * climb(self.system, &q, ways)).sqrt();
        let suggested = [fallen, along(ways), climbed].into_iter();
        let speed = suggested.filter(|it| it.is_finite()).fold(0.0, f64::max);
        match speed > 0.0 {
            true => speed,
            false => Some(along(&vec![1.0; ways.len()]))
                .filter(|it| *it > 0.0 && it.is_finite())
                .unwrap_or(1.0),
        }
    }
}

/// The largest rise of the potential energy above the start along each coordinate: over a whole turn of an angle, and
/// for other coordinates over twice the difference of the configurations to either side.
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

/// The unit vector of this length along the axis `index`.
pub(super) fn unit(length: usize, index: usize) -> Vec<f64> {
    let mut unit = vec![0.0; length];
    unit[index] = 1.0;
    unit
}
