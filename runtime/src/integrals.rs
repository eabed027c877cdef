//! Outputs that are integrals along a run: `S: integral(lagrangian);`.

use core::ops::ControlFlow;

use crate::action::integral;
use crate::describe::Instance;
use crate::error::Fault;
use crate::record::{Observer, Segment};

/// Integrates the outputs that are declared as integrals along the run that it observes. `K` is the number of all
/// outputs of the model.
///
/// # Examples
///
/// ```
/// use dalembert::{Described, Dop853, Integrals, Scene, Simulation, System, Tolerance};
///
/// dalembert::model! {
///     pub Falling {
///         coordinates { y; }
///         lagrangian = dot(y)^2/2 - y;
///         impacts { floor: y >= 0; }
///         outputs { S: integral(lagrangian); squares: integral(dot(y)^2); }
///     }
/// }
///
/// let ball = Falling::default();
/// let state = ball.state(0.0, &[0.5].into(), &[0.0].into())?;
/// let mut integrals = Integrals::<_, { Falling::DESCRIPTION.outputs.len() }>::new(&ball);
/// let stepper = Dop853::new(Tolerance::new(1e-12)?);
/// Simulation::new(&ball, stepper, ball.effects()).run(0.0, state, 2.0, &mut integrals)?;
/// // The ball falls and rises again. From t = 0 to 1, L = t^2/2 - (1 - t^2)/2.
/// assert!((integrals.value(falling::output::S)? + 1.0 / 3.0).abs() < 1e-11);
/// assert!((integrals.value(falling::output::squares)? - 2.0 / 3.0).abs() < 1e-11);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Integrals<'a, Sys, const K: usize> {
    system: &'a Sys,
    values: [Result<f64, Fault>; K],
}

impl<'a, Sys: Instance, const K: usize> Integrals<'a, Sys, K> {
    /// The integrals of the next run, 0 at its start.
    pub const fn new(system: &'a Sys) -> Self {
        Self {
            system,
            values: [Ok(0.0); K],
        }
    }

    /// Value of an output that is an integral, by its index among all outputs, from the start of the run to its last
    /// state. It is 0 for other outputs.
    ///
    /// # Errors
    /// The first [`Fault`] of the output or of the dense output.
    pub fn value(&self, output: usize) -> Result<f64, Fault> {
        self.values.get(output).copied().unwrap_or(Ok(0.0))
    }
}

impl<Sys: Instance, const K: usize> Observer<Sys> for Integrals<'_, Sys, K> {
    fn step(&mut self, segment: &mut Segment<'_, Sys::State>) -> ControlFlow<()> {
        let (system, ends) = (self.system, [segment.t_start(), segment.t_end()]);
        for &index in system.description().integrals.iter() {
            let Some(Ok(value)) = self.values.get(index).copied() else {
                continue;
            };
            let added = integral(segment, ends, &mut |t, state| {
                let mut outputs = [0.0; K];
                system.outputs(t, state, &mut outputs)?;
                Ok(outputs[index])
            });
            self.values[index] = added.map(|added| value + added);
        }
        ControlFlow::Continue(())
    }
}
