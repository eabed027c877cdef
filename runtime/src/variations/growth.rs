//! Growth of small deviations from return to return: the largest Lyapunov exponent of a section.

use super::Tangent;
use super::chart::{Chart, Fixed, add};
use super::orbit::OrbitError;
use super::section::Section;
use super::transition;
use crate::contract::Variational;
use crate::effects::Effect;
use crate::integrate::Stepper;
use crate::math;

/// Number of returns that turn a deviation to the direction of fastest growth before its growth counts.
const TURNING: u32 = 8;

impl<'a, Sys, Step, Effects> Section<'a, Sys, Step, Effects>
where
    Sys: Variational,
    Step: Stepper<Sys>,
    Effects: Effect<Sys>,
{
    /// The mean logarithm of the growth of a small deviation per image of the section, over `images` of them from the
    /// first arrival after a state. It tends to the largest Lyapunov exponent; of a periodic orbit that is the logarithm
    /// of the largest modulus of its multipliers. Minus infinity where deviations vanish.
    ///
    /// # Errors
    /// [`OrbitError::Section`] where the section is not met again or the way to it has no derivative,
    /// [`OrbitError::DependsOnTime`] for a system or a transition that depends on time.
    pub fn exponent(&mut self, state: &Sys::State, images: u32) -> Result<f64, OrbitError> {
        let first = self.arrive(state, &mut [])?.before;
        let fixed = Fixed::of(self.system, self.surface, 0.0, &first)?;
        let (chart, mut point) = Chart::onto(self.system, (&fixed, None), 0.0, first)?;
        // Along every direction of the section, so that hardly any orbit grows at right angles to it.
        let mut deviation = self.system.zero_state();
        for index in 0..chart.dimension() {
            let share = 1.0 / (index + 1) as f64;
            add(&mut deviation, share, &chart.direction(index));
        }
        let mut sum = 0.0;
        for made in 0..TURNING + images.max(1) {
            let (growth, image) = self.grown(&chart, &mut point, &deviation, made == 0)?;
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

    /// Moves a point to its image; returns the growth of a deviation, and its image.
    fn grown(
        &mut self,
        chart: &Chart<Sys>,
        point: &mut Sys::State,
        deviation: &Sys::State,
        is_first: bool,
    ) -> Result<(f64, Sys::State), OrbitError> {
        let length = chart.size(deviation);
        // A section of a single point has no deviations, but may depend on time.
        if length == 0.0 && !is_first {
            return Ok((0.0, *deviation));
        }
        let mut unit = self.system.zero_state();
        if length > 0.0 {
            add(&mut unit, 1.0 / length, deviation);
        }
        let mut tangents = [Tangent::of_state(unit)];
        let event = self.pass(point, self.returns, &mut tangents)?.event;
        if is_first && transition::depends_on_time(self.system, &event)? {
            return Err(OrbitError::DependsOnTime);
        }
        *point = event.before;
        let image = tangents[0].state;
        let growth = chart.size(&image);
        match growth.is_finite() {
            true => Ok((growth, image)),
            false => Err(OrbitError::NoMultipliers),
        }
    }
}
