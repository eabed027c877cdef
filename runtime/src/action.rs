//! Integrals along a run, in particular the action, the integral of the Lagrangian.
//!
//! The Lagrangian is evaluated as `L = <p, qdot> - H` with `H = 1/2 g(qdot, qdot) + V`. Terms of `L` that are linear in
//! the velocities are included in `p`. Impacts take no time and add nothing to an integral.

use core::ops::ControlFlow;

use crate::contract::System;
use crate::error::Fault;
use crate::quadrature::composite;
use crate::record::{Observer, Segment};
use crate::state::StateVector;

/// Maximum number of panels of one step. Their number doubles until the integral converges.
const PANELS: u32 = 64;

/// Largest change between two successive sums that counts as converged, relative to the integral of the absolute value.
const AGREEMENT: f64 = 1e-15;

/// The Lagrangian at a state.
///
/// # Errors
/// The [`Fault`] of the velocities, the momenta or the energy; [`Fault::FirstOrder`] for a first-order system.
pub fn lagrangian<Sys: System>(system: &Sys, t: f64, state: &Sys::State) -> Result<f64, Fault> {
    let (qdot, p) = (system.velocity(t, state)?, system.momentum(t, state)?);
    let pairs = p.as_slice().iter().zip(qdot.as_slice());
    let product: f64 = pairs.map(|(p, qdot)| p * qdot).sum();
    Ok(product - system.energy(t, state)?)
}

/// The integral of a function of time and state between two times of a segment of the run. It uses 16 Gauss-Legendre
/// nodes per panel, and doubles the number of panels, up to 64, until the sum settles to its last digits.
///
/// # Errors
/// A [`Fault`] of the function or of the dense output.
pub fn integral<S: Copy>(
    segment: &mut Segment<'_, S>,
    [from, to]: [f64; 2],
    function: &mut dyn FnMut(f64, &S) -> Result<f64, Fault>,
) -> Result<f64, Fault> {
    let length = to - from;
    if length == 0.0 {
        return Ok(0.0);
    }
    let mut density = |part: f64| {
        let t = from + part * length;
        function(t, &segment.at(t)?)
    };
    let mut panels = 1;
    let mut coarse = composite(&mut density, panels)?;
    while panels < PANELS {
        panels *= 2;
        let fine = composite(&mut density, panels)?;
        let change = (fine.0 - coarse.0).abs();
        coarse = fine;
        if change.is_nan() || change <= AGREEMENT * fine.1 {
            break;
        }
    }
    Ok(coarse.0 * length)
}

/// Integrates the Lagrangian along the run that it observes, by [`integral`] over the dense output of each step.
///
/// # Examples
///
/// ```
/// use dalembert::{Action, Dop853, Simulation, System, Tolerance};
///
/// dalembert::model! {
///     pub Projectile {
///         coordinates { y; }
///         lagrangian = dot(y)^2/2 - y;
///     }
/// }
///
/// // y = t - t^2/2: L = (1 - t)^2/2 - y, and the action of the flight is -1/3.
/// let projectile = Projectile::default();
/// let state = projectile.state(0.0, &[0.0].into(), &[1.0].into())?;
/// let mut action = Action::new(&projectile);
/// Simulation::new(&projectile, Dop853::new(Tolerance::new(1e-12)?), ()).run(0.0, state, 2.0, &mut action)?;
/// assert!((action.value()? + 1.0 / 3.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Action<'a, Sys> {
    system: &'a Sys,
    value: Result<f64, Fault>,
}

impl<'a, Sys: System> Action<'a, Sys> {
    /// The action of the next run, 0 at its start.
    pub const fn new(system: &'a Sys) -> Self {
        Self {
            system,
            value: Ok(0.0),
        }
    }

    /// The action from the start of the run to its last state.
    ///
    /// # Errors
    /// The first [`Fault`] of the Lagrangian or of the dense output.
    pub const fn value(&self) -> Result<f64, Fault> {
        self.value
    }
}

impl<Sys: System> Observer<Sys> for Action<'_, Sys> {
    fn step(&mut self, segment: &mut Segment<'_, Sys::State>) -> ControlFlow<()> {
        if let Ok(sum) = self.value {
            let system = self.system;
            let ends = [segment.t_start(), segment.t_end()];
            let integral = integral(segment, ends, &mut |t, state| lagrangian(system, t, state));
            self.value = integral.map(|integral| sum + integral);
        }
        ControlFlow::Continue(())
    }
}
