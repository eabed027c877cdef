//! Growth of small deviations per return: the largest Lyapunov exponent of a section.

use super::Tangent;
use super::chart::{Chart, Fixed, add};
use super::eigenvalues::eigenvalues;
use super::orbit::OrbitError;
use super::section::Section;
use crate::contract::Variational;
use crate::describe::Instance;
use crate::effects::Effect;
use crate::integrate::Stepper;
use crate::math;

/// Number of first images whose growth is not counted. They turn the deviation to the direction of fastest growth.
const TURNING: u32 = 8;

impl<'a, Sys, Step, Effects> Section<'a, Sys, Step, Effects>
where
    Sys: Variational,
    Step: Stepper<Sys>,
    Effects: Effect<Sys>,
{
    /// The mean logarithm of the factor by which one application of the map lengthens a small deviation. The run begins
    /// at `state`. After its first arrival, 8 images turn the deviation to the direction of fastest growth; the mean is
    /// over the next `images` images, at least 1. It tends to the largest Lyapunov exponent; on a periodic orbit,
    /// [`Section::exponent_of_orbit`] has no error of a finite time. It is minus infinity if the deviation vanishes.
    ///
    /// # Errors
    /// [`OrbitError::Section`] where the section is not met or the motion to it has no derivative,
    /// [`OrbitError::DependsOnTime`] for a system that depends on time, [`OrbitError::NoMultipliers`]
    /// if the growth is not finite.
    pub fn exponent(&mut self, state: &Sys::State, images: u32) -> Result<f64, OrbitError> {
        if self.system.depends_on_time() {
            return Err(OrbitError::DependsOnTime);
        }
        let first = self.arrive(state, &mut [])?.before;
        let fixed = Fixed::of(self.system, self.surface, 0.0, &first)?;
        let (chart, mut point) = Chart::onto(self.system, (&fixed, None), 0.0, first)?;
        // The deviation has a part along every direction of the section: it is rarely orthogonal to the direction of
        // growth.
        let mut deviation = self.system.zero_state();
        for index in 0..chart.dimension() {
            let share = 1.0 / (index + 1) as f64;
            add(&mut deviation, share, &chart.direction(index));
        }
        let mut sum = 0.0;
        for made in 0..TURNING + images.max(1) {
            let (growth, image) = self.grown(&chart, &mut point, &deviation)?;
            if growth == 0.0 {
                return Ok(f64::NEG_INFINITY);
            }
            if made >= TURNING {
                sum += math::ln(growth);
            }
            deviation = image;
        }
        Ok(sum / f64::from(images.max(1)))
    }

    /// Moves a point to its image. Scales a deviation to length 1, and returns the length of its image and the image.
    fn grown(
        &mut self,
        chart: &Chart<Sys>,
        point: &mut Sys::State,
        deviation: &Sys::State,
    ) -> Result<(f64, Sys::State), OrbitError> {
        let length = chart.size(deviation);
        // A section of a single point has no deviations.
        if length == 0.0 {
            return Ok((0.0, *deviation));
        }
        let mut unit = self.system.zero_state();
        add(&mut unit, 1.0 / length, deviation);
        let mut tangents = [Tangent::of_state(unit)];
        let event = self.pass(point, self.returns, &mut tangents)?.event;
        *point = event.before;
        let image = tangents[0].state;
        let growth = chart.size(&image);
        match growth.is_finite() {
            true => Ok((growth, image)),
            false => Err(OrbitError::NoMultipliers),
        }
    }
}

impl<'a, Sys, Step, Effects> Section<'a, Sys, Step, Effects>
where
    Sys: Variational + Instance,
    Step: Stepper<Sys>,
    Effects: Effect<Sys>,
{
    /// The largest Lyapunov exponent of the periodic orbit that a state leads to, per application of the map: the
    /// logarithm of the largest modulus of its multipliers. The run begins at `state`; its first arrival must be a fixed
    /// point of the map. It is minus infinity if all multipliers vanish.
    ///
    /// # Errors
    /// Those of [`Section::exponent`].
    pub fn exponent_of_orbit(&mut self, state: &Sys::State) -> Result<f64, OrbitError> {
        if self.system.depends_on_time() {
            return Err(OrbitError::DependsOnTime);
        }
        let first = self.arrive(state, &mut [])?.before;
        let fixed = Fixed::of(self.system, self.surface, 0.0, &first)?;
        let mut trial = self.attempt(&fixed, first, None, None)?;
        let multipliers = eigenvalues(trial.derivative.as_mut(), trial.chart.dimension());
        let multipliers = multipliers.ok_or(OrbitError::NoMultipliers)?;
        let moduli = multipliers.iter().map(|[re, im]| libm::hypot(re, im));
        Ok(math::ln(moduli.fold(0.0, f64::max)))
    }
}
