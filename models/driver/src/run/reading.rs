//! The values of a run at a state: values that depend on the state alone, and outputs that are integrals along the run.

use dalembert::action::integral;
use dalembert::{Fault, Instance, Segment};

use crate::model::{Point, point};

/// The values that depend on a state alone.
pub(super) trait Reading<S> {
    /// All values; NaN for outputs that are integrals.
    fn point(&self, t: f64, state: &S) -> Point;

    /// The outputs. For an output that is an integral, its integrand.
    ///
    /// # Errors
    /// A [`Fault`] where an output does not exist.
    fn outputs(&self, t: f64, state: &S, values: &mut [f64]) -> Result<(), Fault>;
}

impl<M: Instance> Reading<M::State> for &M {
    fn point(&self, t: f64, state: &M::State) -> Point {
        point(*self, t, state)
    }

    fn outputs(&self, t: f64, state: &M::State, values: &mut [f64]) -> Result<(), Fault> {
        Instance::outputs(*self, t, state, values)
    }
}

/// The outputs of a run that are integrals, each with its value at the start of the present stretch of motion. The
/// value is NaN after the first stretch over which the integral does not exist.
pub(super) struct Integrals {
    /// The number of all outputs.
    outputs: usize,
    /// The index of each integral among the outputs, and its value.
    values: Vec<(usize, f64)>,
}

impl Integrals {
    /// The integrals at the start of a run.
    pub(super) fn of<M: Instance>(model: &M) -> Self {
        let description = model.description();
        Self {
            outputs: description.outputs.len(),
            values: description
                .integrals
                .iter()
                .map(|&index| (index, 0.0))
                .collect(),
        }
    }

    /// True if the model has integrals.
    pub(super) fn is_some(&self) -> bool {
        !self.values.is_empty()
    }

    /// Sets the integrals of a point.
    pub(super) fn put(&self, mut point: Point) -> Point {
        for &(index, value) in &self.values {
            point.outputs[index] = value;
        }
        point
    }

    /// The integrals at a time of the present stretch of motion.
    pub(super) fn at<S: Copy>(
        &self,
        t: f64,
        reading: &impl Reading<S>,
        segment: &mut Segment<'_, S>,
    ) -> Self {
        let start = segment.t_start();
        let mut outputs = match self.is_some() {
            true => vec![0.0; self.outputs],
            false => Vec::new(),
        };
        let values = self.values.iter().map(|&(index, before)| {
            if before.is_nan() {
                return (index, before);
            }
            let added = integral(segment, [start, t], &mut |t, state| {
                reading.outputs(t, state, &mut outputs)?;
                Ok(outputs[index])
            });
            (index, before + added.unwrap_or(f64::NAN))
        });
        Self {
            values: values.collect(),
            outputs: self.outputs,
        }
    }
}
