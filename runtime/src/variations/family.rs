//! Families of periodic orbits over a parameter: the Poincare map at a point, with its derivatives with respect to the
//! state and to the parameter.

use super::OrbitError;
use super::chart::{Fixed, columns};
use super::eigenvalues::{Multipliers, eigenvalues};
use super::group::Element;
use super::orbit::Trial;
use super::section::{Arrival, Itinerary, Section};
use crate::contract::Variational;
use crate::describe::Instance;
use crate::effects::Effect;
use crate::integrate::Stepper;

/// A fixed section, shared by all members of a family. The deviations from the constraints, levels included, are the
/// same for all members.
pub struct Anchor<Sys: Variational>(Fixed<Sys>);

/// A point of a section and its image under the Poincare map. Vectors along the section have their components in the
/// first `dimension` entries.
pub struct Image<Sys: Variational> {
    /// The point of the section next to the given one.
    pub point: Sys::State,
    /// The image: the states before and after the transition there. Its time is the duration of the motion to it.
    pub image: Arrival<Sys::State>,
    /// Time before the first arrival; 0 up to rounding, unless the point leaves the surface.
    pub delay: f64,
    /// Dimension of the section.
    pub dimension: usize,
    /// The first `dimension` columns are an orthonormal basis of the section, in units of the components.
    pub directions: Sys::Columns,
    /// Units of the components of the state.
    pub scale: Sys::State,
    /// Difference between the image and the point, along the directions.
    pub miss: Sys::State,
    /// Distance between the point and its image, in units of the components.
    pub residual: f64,
    /// True if the residual is 0 up to rounding.
    pub is_closed: bool,
    /// Derivative of the map along the directions: a `dimension` by `dimension` matrix, by columns.
    pub derivative: Sys::Columns,
    /// Eigenvalues of this derivative (Floquet multipliers); `None` if they are not finite.
    pub multipliers: Option<Multipliers<Sys::State>>,
    /// Smallest change of the point per unit of the parameter that keeps it on the section.
    pub shift: Sys::State,
    /// Derivative of `miss` with respect to the parameter, while the point changes by `shift`.
    pub slope: Sys::State,
    /// The symmetry up to which the image is compared with the point.
    pub element: Element,
    /// The sequence of surfaces between the point and its image.
    pub itinerary: Itinerary<Sys>,
}

impl<'a, Sys, Step, Effects> Section<'a, Sys, Step, Effects>
where
    Sys: Variational + Instance,
    Step: Stepper<Sys>,
    Effects: Effect<Sys>,
{
    /// The section through a point, fixed for all values of the parameters.
    ///
    /// # Errors
    /// [`OrbitError::Section`] where the equations of the section have no derivative.
    pub fn anchor(&self, point: &Sys::State) -> Result<Anchor<Sys>, OrbitError> {
        Ok(Anchor(Fixed::of(self.system, self.surface, 0.0, point)?))
    }

    /// Maps the point of the section next to `point`, and computes the derivatives of the map with respect to the state
    /// and to the parameter with index `parameter`. The derivatives are those of [`Variations`](super::Variations),
    /// exact to rounding.
    ///
    /// # Errors
    /// [`OrbitError::Section`] if the point has no image or the map has no derivative there,
    /// [`OrbitError::DependsOnTime`] for a system that depends on time.
    pub fn image(
        &mut self,
        anchor: &Anchor<Sys>,
        point: &Sys::State,
        parameter: usize,
    ) -> Result<Image<Sys>, OrbitError> {
        if self.system.depends_on_time() {
            return Err(OrbitError::DependsOnTime);
        }
        let trial = self.attempt(&anchor.0, *point, Some(parameter), None)?;
        let is_closed = self.is_closed(&trial)?;
        Ok(image(self.system, &trial, is_closed))
    }
}

fn image<Sys: Variational>(system: &Sys, trial: &Trial<Sys>, is_closed: bool) -> Image<Sys> {
    let dimension = trial.chart.dimension();
    let mut directions = columns(system);
    for (index, direction) in directions.as_mut()[..dimension].iter_mut().enumerate() {
        *direction = trial.chart.direction(index);
    }
    let mut work = trial.derivative;
    Image {
        point: trial.point,
        image: Arrival::of(trial.passed.time, &trial.passed.event),
        delay: trial.passed.delay,
        dimension,
        directions,
        scale: *trial.chart.scale(),
        miss: trial.miss,
        residual: trial.residual,
        is_closed,
        derivative: trial.derivative,
        multipliers: eigenvalues(work.as_mut(), dimension),
        shift: trial.shift,
        slope: trial.slope,
        element: trial.element,
        itinerary: trial.passed.itinerary,
    }
}
