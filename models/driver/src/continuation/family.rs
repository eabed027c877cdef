//! One member of a family and its neighbours, independent of the type of the system.

use dalembert::{OrbitError, ParameterError};

use super::Member;
use super::rotated::Rotated;
use crate::linear::{add, dot, norm};

/// A family over a parameter: its members are the zeros of a map along a section.
pub(crate) trait Family {
    /// The map at the point of the section near a state.
    fn local(&mut self, state: &[f64], parameter: f64) -> Result<Local, Failure>;

    /// Prepares for members near this one. It may be far from the last member.
    fn begin(&mut self, member: &Member);
}

/// Reason why a point is not a member, or why a step fails.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Failure {
    /// The declaration of the parameter refuses its value.
    Parameter(ParameterError),
    /// The map is not defined, or has no derivative.
    Missed(OrbitError),
    /// Multipliers, or numbers computed from them, are not finite.
    NotKnown,
    /// No complex pair of multipliers is left.
    Real,
    /// Newton's method does not converge, or converges to a point that is too far away.
    Diverged,
    /// The orbit meets this surface more or less often than its predecessor.
    Itinerary(usize),
    /// The step has to be shorter.
    TooLong,
}

/// The map near a point of the section. A step has one component per direction of the section, and a last one for the
/// parameter in units of `width`.
#[derive(Debug, Clone)]
pub(crate) struct Local {
    /// The point as a member. It belongs to the family if the map is 0 there.
    pub member: Member,
    /// The units of the components of the state.
    pub scale: Vec<f64>,
    /// The directions of the section, orthonormal in these units.
    pub directions: Vec<Vec<f64>>,
    /// Change of the state per unit of the parameter that keeps it on the section.
    pub shift: Vec<f64>,
    /// The value of the map.
    pub miss: Vec<f64>,
    /// The derivative of the map along the directions, column by column.
    pub derivative: Vec<Vec<f64>>,
    /// The derivative of the map per unit of the parameter.
    pub slope: Vec<f64>,
    /// True if the map is 0 up to rounding.
    pub is_closed: bool,
    /// Number of arrivals at each surface.
    pub arrivals: Vec<f64>,
    /// Least rate at which the gap of each surface falls at an arrival.
    pub speeds: Vec<f64>,
    /// Length of the rate of the state at the point, in these units.
    pub pace: f64,
}

/// The unknowns of Newton's method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unknowns {
    /// The state and the parameter.
    All,
    /// The state alone.
    State,
}

impl Local {
    /// The derivatives with respect to all components of a step, column by column.
    pub fn columns(&self, width: f64) -> Vec<Vec<f64>> {
        let mut columns = self.derivative.clone();
        columns.push(self.slope.iter().map(|entry| width * entry).collect());
        columns
    }

    /// The Newton step; the shortest one if there are several.
    pub fn newton(&self, width: f64, unknowns: Unknowns) -> Vec<f64> {
        let mut step = match unknowns {
            Unknowns::All => Rotated::of(self.columns(width)).solve(&self.miss),
            Unknowns::State => {
                let mut step = Rotated::of(self.derivative.clone()).solve(&self.miss);
                step.push(0.0);
                step
            }
        };
        step.iter_mut().for_each(|entry| *entry = -*entry);
        step
    }

    /// State and parameter after a step.
    pub fn moved(&self, width: f64, step: &[f64]) -> (Vec<f64>, f64) {
        let (along, steps) = step.split_last().unwrap_or((&0.0, &[]));
        let mut state = self.member.state.clone();
        for (factor, direction) in steps.iter().zip(&self.directions) {
            add(&mut state, *factor, direction);
        }
        add(&mut state, along * width, &self.shift);
        (state, self.member.parameter + along * width)
    }

    /// A step as a change of state and parameter, in their units.
    pub fn change(&self, width: f64, step: &[f64]) -> Vec<f64> {
        let (state, parameter) = self.moved(width, step);
        self.change_to(width, &state, parameter)
    }

    /// The change to a state and a parameter, in their units.
    pub fn change_to(&self, width: f64, state: &[f64], parameter: f64) -> Vec<f64> {
        let pairs = state.iter().zip(&self.member.state).zip(&self.scale);
        let mut change: Vec<f64> = pairs
            .map(|((to, from), scale)| (to - from) / scale)
            .collect();
        change.push((parameter - self.member.parameter) / width);
        change
    }

    /// The step of a change: its components along the section, and in the parameter.
    pub fn step(&self, change: &[f64]) -> Vec<f64> {
        let along = |direction: &Vec<f64>| {
            let scaled = direction.iter().zip(&self.scale);
            let scaled: Vec<f64> = scaled.map(|(entry, scale)| entry / scale).collect();
            dot(&scaled, change)
        };
        let mut step: Vec<f64> = self.directions.iter().map(along).collect();
        step.extend(change.last());
        step
    }

    /// Orthonormal directions in which the map is 0 to first order.
    pub fn kernel(&self, width: f64) -> Vec<Vec<f64>> {
        let rotated = Rotated::of(self.columns(width));
        rotated.kernel().map(<[f64]>::to_vec).collect()
    }
}

/// A member with the direction of its branch.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub local: Local,
    /// The direction as a step of length 1.
    pub tangent: Vec<f64>,
    /// The direction as a change of length 1.
    pub heading: Vec<f64>,
    /// Dimension of the set of neighbouring members: 1 for a branch, 2 where branches cross, more than 1 for orbits
    /// that belong to a family at a constant parameter.
    pub dimension: usize,
    /// Distance from the preceding member.
    pub distance: f64,
}

impl Node {
    /// The member with the direction of its branch that is closest to a heading.
    pub fn new(local: Local, width: f64, heading: &[f64]) -> Self {
        let kernel = local.kernel(width);
        let wanted = local.step(heading);
        let mut tangent = vec![0.0; wanted.len()];
        for direction in &kernel {
            add(&mut tangent, dot(direction, &wanted), direction);
        }
        let length = norm(&tangent);
        match kernel.first() {
            // The heading is the direction of the parameter, and the branch is orthogonal to it: the branch turns back
            // here.
            Some(direction) if length < 1e-9 => tangent.clone_from(direction),
            _ => tangent.iter_mut().for_each(|entry| *entry /= length),
        }
        let mut heading = local.change(width, &tangent);
        let length = norm(&heading);
        heading.iter_mut().for_each(|entry| *entry /= length);
        Self {
            local,
            tangent,
            heading,
            dimension: kernel.len(),
            distance: 0.0,
        }
    }

    /// The same member in the opposite direction.
    pub fn reversed(&self) -> Self {
        let mut reversed = self.clone();
        let entries = reversed.tangent.iter_mut().chain(&mut reversed.heading);
        entries.for_each(|entry| *entry = -*entry);
        reversed
    }

    pub fn parameter(&self) -> f64 {
        self.local.member.parameter
    }

    /// The last component of the state.
    pub fn last(&self) -> f64 {
        self.local.member.state.last().copied().unwrap_or(f64::NAN)
    }

    /// The component of the direction in the parameter.
    pub fn rise(&self) -> f64 {
        self.tangent.last().copied().unwrap_or(0.0)
    }
}
