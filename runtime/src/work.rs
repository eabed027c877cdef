//! Work along a run, by cause: the terms of an energy balance.

use core::ops::ControlFlow;

use crate::contract::Powered;
use crate::error::Fault;
use crate::quadrature::NODES;
use crate::record::{Observer, Segment};
use crate::state::StateVector;

/// Observes a run and adds up the work of every cause in [`Powered::POWERS`]. Between impacts, and without surfaces in
/// contact, the energy changes by the sum of all work, up to the error of the integrator. Impacts change the energy as
/// well.
///
/// Powers are integrated over each part of the run by the Gauss-Legendre rule of 16 points on the dense output.
/// Every step must then build its dense output. To use another observer as well, pass the pair `(work, observer)` to
/// the run.
///
/// # Examples
///
/// ```
/// use dalembert::{Dop853, Simulation, System, Tolerance, Work};
///
/// dalembert::model! {
///     pub Cart {
///         coordinates { x; }
///         parameters { c > 0 = 1/2; }
///         lagrangian = dot(x)^2/2;
///         forces { drag: -c*dot(x)*d(x); }
///     }
/// }
///
/// let cart = Cart::default();
/// let state = cart.state(0.0, &[0.0].into(), &[2.0].into())?;
/// let mut work = Work::of(&cart);
/// let run = Simulation::new(&cart, Dop853::new(Tolerance::new(1e-10)?), ()).run(0.0, state, 3.0, &mut work)?;
/// let lost = cart.energy(0.0, &state)? - cart.energy(run.t, &run.state)?;
/// assert!((work.total() + lost).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Work<'a, Sys: Powered> {
    system: &'a Sys,
    done: Sys::Powers,
    fault: Option<Fault>,
}

impl<'a, Sys: Powered> Work<'a, Sys> {
    /// An observer of a system, with zero work so far.
    pub fn of(system: &'a Sys) -> Self {
        Self {
            system,
            done: StateVector::zeros(system.power_count()),
            fault: None,
        }
    }

    /// Work done so far, in the order of [`Powered::POWERS`].
    pub fn done(&self) -> &Sys::Powers {
        &self.done
    }

    /// Sum over all causes.
    pub fn total(&self) -> f64 {
        self.done.as_slice().iter().sum()
    }

    /// The fault of a power that stopped the run; `None` if there was none.
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// Adds the work along a part of the run.
    fn add(&mut self, segment: &mut Segment<'_, Sys::State>) -> Result<(), Fault> {
        let (start, length) = (segment.t_start(), segment.t_end() - segment.t_start());
        for (node, weight) in NODES {
            for part in [node, 1.0 - node] {
                let t = start + part * length;
                let powers = self.system.powers(t, &segment.at(t)?)?;
                let sums = self.done.as_mut_slice().iter_mut();
                for (sum, power) in sums.zip(powers.as_slice()) {
                    *sum += weight * length * power;
                }
            }
        }
        Ok(())
    }
}

impl<Sys: Powered> Observer<Sys> for Work<'_, Sys> {
    fn step(&mut self, segment: &mut Segment<'_, Sys::State>) -> ControlFlow<()> {
        match self.add(segment) {
            Ok(()) => ControlFlow::Continue(()),
            Err(fault) => {
                self.fault = Some(fault);
                ControlFlow::Break(())
            }
        }
    }
}
