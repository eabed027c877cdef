//! Members that are periodic orbits: fixed points of the return map of a section.

use dalembert::contract::Variational;
use dalembert::integrate::Taylor;
use dalembert::numbers::Row;
use dalembert::variations::{Anchor, Image};
use dalembert::{Instance, OrbitError, Scene, StateVector};

use super::Member;
use super::family::{Failure, Family, Local};
use super::indicator::{Precision, stability};
use crate::linear::norm;
use crate::model::point;
use crate::orbit::{Search, section};

/// Longest return, in units of the period of the last orbit.
const PATIENCE: f64 = 4.0;

/// Allowed time before the first arrival, in units of the period.
const DELAY: f64 = 1e-9;

/// Periodic orbits of a section over a parameter.
pub(crate) struct Orbits<'a, S: Variational> {
    system: S,
    anchor: Anchor<S>,
    search: &'a Search,
    parameter: usize,
    /// Longest time of a return.
    horizon: f64,
}

impl<'a, S: Instance + Scene + Variational> Orbits<'a, S> {
    /// The family that contains this orbit, over the parameter of this index.
    pub fn new(
        system: &S,
        search: &'a Search,
        parameter: usize,
        orbit: &dalembert::variations::Orbit<S>,
    ) -> Result<Self, OrbitError> {
        let mut stepper = Taylor::new(search.tolerance);
        let section = section(system, search, search.horizon, &mut stepper);
        let anchor = section.anchor(&orbit.point.before)?;
        drop(section);
        Ok(Self {
            system: system.clone(),
            anchor,
            search,
            parameter,
            horizon: f64::min(search.horizon, PATIENCE * orbit.point.time),
        })
    }
}

impl<S: Instance + Scene + Variational> Family for Orbits<'_, S> {
    fn local(&mut self, state: &[f64], parameter: f64) -> Result<Local, Failure> {
        self.along(state, self.parameter, parameter)
    }

    fn begin(&mut self, member: &Member) {
        self.expect(member.period);
    }
}

impl<S: Instance + Scene + Variational> Orbits<'_, S> {
    /// Sets a parameter, which keeps this value.
    pub fn hold(&mut self, parameter: usize, value: f64) {
        self.system.set_parameter(parameter, value);
    }

    /// Limits the time of a return to a multiple of this period.
    fn expect(&mut self, period: f64) {
        self.horizon = f64::min(self.search.horizon, PATIENCE * period);
    }

    /// The return map near a state at a value of a parameter, with its derivative with respect to that parameter.
    pub fn along(&mut self, state: &[f64], parameter: usize, value: f64) -> Result<Local, Failure> {
        self.hold(parameter, value);
        self.system.check_parameters().map_err(Failure::Parameter)?;
        let mut near = self.system.zero_state();
        near.as_mut_slice().copy_from_slice(state);
        let mut stepper = Taylor::new(self.search.tolerance);
        let mut section = section(&self.system, self.search, self.horizon, &mut stepper)
            .with_returns(self.search.returns);
        let image = section.image(&self.anchor, &near, parameter);
        drop(section);
        let image = image.map_err(Failure::Missed)?;
        let precision = Precision::of(self.search.tolerance.relative());
        let mut local = local(&self.system, &image, value, precision)?;
        local.member.element = self.search.factors(&image.element);
        if local.is_closed {
            self.expect(local.member.period);
        }
        Ok(local)
    }
}

fn local<S: Instance + Variational>(
    system: &S,
    image: &Image<S>,
    parameter: f64,
    precision: Precision,
) -> Result<Local, Failure> {
    if image.delay > DELAY * image.image.time {
        // The motion from the point leaves the surface and arrives at it later. The map is not smooth here: motions from
        // neighbouring points on the other side of the surface arrive at once.
        return Err(Failure::TooLong);
    }
    let multipliers = image.multipliers.as_ref();
    let multipliers = multipliers.ok_or(Failure::NotKnown)?;
    let multipliers: Vec<[f64; 2]> = multipliers.iter().collect();
    let n = image.dimension;
    let leading = |vector: &S::State| StateVector::as_slice(vector)[..n].to_vec();
    let mut derivative: Vec<Vec<f64>> =
        image.derivative.as_ref()[..n].iter().map(leading).collect();
    for (index, column) in derivative.iter_mut().enumerate() {
        column[index] -= 1.0;
    }
    let all = |vector: &S::State| StateVector::as_slice(vector).to_vec();
    let mut rate = system.zero_state();
    let moves = system.rate(0.0, &image.point, &mut rate);
    let parts = rate.as_slice().iter().zip(image.scale.as_slice());
    let pace = norm(
        &parts
            .map(|(rate, scale)| rate / scale)
            .collect::<Vec<f64>>(),
    );
    Ok(Local {
        member: Member {
            parameter,
            second: None,
            period: image.image.time,
            before: point(system, 0.0, &image.point),
            after: point(system, 0.0, &image.image.after),
            residual: image.residual,
            element: Vec::new(),
            stability: stability(&multipliers, precision).ok_or(Failure::NotKnown)?,
            multipliers,
            bifurcation: None,
            state: all(&image.point),
        },
        scale: all(&image.scale),
        directions: image.directions.as_ref()[..n].iter().map(all).collect(),
        shift: all(&image.shift),
        miss: leading(&image.miss),
        derivative,
        slope: leading(&image.slope),
        is_closed: image.is_closed,
        arrivals: image.itinerary.arrivals.as_slice().to_vec(),
        speeds: image.itinerary.speeds.as_slice().to_vec(),
        pace: moves.map_or(f64::NAN, |()| pace),
    })
}
