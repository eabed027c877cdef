//! A point of mass 1 on a line, and a nonlinear motion with a closed form.

use dalembert::{Fault, ParameterError, System, VectorField, describe::Assumption};
use nalgebra::SVector;

/// A position, or a velocity.
pub type Scalar = SVector<f64, 1>;
/// A position and a velocity.
pub type Plane = SVector<f64, 2>;

/// `x'' = force(t, x, v)` on a line.
#[derive(Clone, Copy)]
pub struct Line {
    /// The force at a time, a position and a velocity.
    pub force: fn(f64, f64, f64) -> Result<f64, Fault>,
    /// The potential, where a test uses one.
    pub potential: fn(f64) -> f64,
    /// The chart ends at this position.
    pub chart: f64,
    /// A parameter that must be positive; the motion does not depend on it.
    pub mass: f64,
}

impl Line {
    /// A motion under a force alone.
    pub fn new(force: fn(f64, f64, f64) -> Result<f64, Fault>) -> Self {
        Self {
            force,
            potential: |_| 0.0,
            chart: f64::INFINITY,
            mass: 1.0,
        }
    }
}

impl VectorField for Line {
    type State = Plane;

    fn rate(&self, t: f64, state: &Plane, rate: &mut Plane) -> Result<(), Fault> {
        *rate = Plane::new(state[1], (self.force)(t, state[0], state[1])?);
        Ok(())
    }
}

impl System for Line {
    type Vector = Scalar;
    type Impulse = Scalar;

    fn position(&self, state: &Plane) -> Scalar {
        Scalar::new(state[0])
    }

    fn velocity(&self, _: f64, state: &Plane) -> Result<Scalar, Fault> {
        Ok(Scalar::new(state[1]))
    }

    fn momentum(&self, t: f64, state: &Plane) -> Result<Scalar, Fault> {
        self.velocity(t, state)
    }

    fn state_unchecked(&self, _: f64, q: &Scalar, qdot: &Scalar) -> Result<Plane, Fault> {
        Ok(Plane::new(q[0], qdot[0]))
    }

    fn state_from_momenta(&self, t: f64, q: &Scalar, p: &Scalar) -> Result<Plane, Fault> {
        self.state_unchecked(t, q, p)
    }

    fn energy(&self, _: f64, state: &Plane) -> Result<f64, Fault> {
        Ok(0.5 * state[1] * state[1] + (self.potential)(state[0]))
    }

    fn kick(&self, state: &mut Plane, size: f64, direction: &Scalar) {
        state[1] += size * direction[0];
    }

    fn check_parameters(&self) -> Result<(), ParameterError> {
        if self.mass > 0.0 {
            return Ok(());
        }
        Err(ParameterError {
            name: "mass",
            value: self.mass,
            expected: Assumption::Positive,
        })
    }

    fn outside_chart(&self, state: &Plane) -> Option<usize> {
        (state[0] >= self.chart).then_some(0)
    }
}

/// A nonlinear problem with a closed form: `x = sech(t)` solves `x'' = x - 2 x^3`.
pub fn soliton() -> Line {
    Line::new(|_, x, _| Ok(x - 2.0 * x * x * x))
}

fn sech(t: f64) -> f64 {
    1.0 / t.cosh()
}

/// The state of [`soliton`] at a time.
pub fn soliton_at(t: f64) -> Plane {
    Plane::new(sech(t), -sech(t) * t.tanh())
}
