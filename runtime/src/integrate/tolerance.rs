//! Tolerances of a step: relative, and absolute in units of the system's scale.

use core::fmt;

/// Error allowed in a step: `absolute * scale_i + relative * |y_i|` in each component `i`, where `scale` is
/// [`VectorField::scale`](crate::VectorField::scale).
///
/// # Examples
///
/// ```
/// use dalembert::Tolerance;
///
/// assert!(Tolerance::new(1e-10).is_ok());
/// assert!(Tolerance::of(1e-10, 1e-14).is_ok());
/// assert!(Tolerance::new(0.0).is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    relative: f64,
    absolute: f64,
}

impl Tolerance {
    /// Smallest tolerance for doubles.
    pub(crate) const LEAST: Self = Self {
        relative: f64::EPSILON,
        absolute: f64::EPSILON,
    };

    /// The same number as relative and absolute tolerance.
    ///
    /// # Errors
    /// [`ToleranceError`] if it is not positive and finite.
    pub fn new(tolerance: f64) -> Result<Self, ToleranceError> {
        Self::of(tolerance, tolerance)
    }

    /// A relative and an absolute tolerance.
    ///
    /// # Errors
    /// [`ToleranceError`] if either is not positive and finite.
    pub fn of(relative: f64, absolute: f64) -> Result<Self, ToleranceError> {
        for value in [relative, absolute] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(ToleranceError { value });
            }
        }
        Ok(Self { relative, absolute })
    }

    /// The relative tolerance.
    pub const fn relative(&self) -> f64 {
        self.relative
    }

    /// The absolute tolerance, in units of the system's scale.
    pub const fn absolute(&self) -> f64 {
        self.absolute
    }
}

/// Error for a tolerance that is not a positive finite number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToleranceError {
    /// The refused value.
    pub value: f64,
}

impl fmt::Display for ToleranceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "a tolerance must be a positive finite number, not {}",
            self.value
        )
    }
}

impl core::error::Error for ToleranceError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_positive_finite_tolerances_are_taken() {
        for value in [0.0, -1e-6, f64::NAN, f64::INFINITY] {
            assert!(Tolerance::new(value).is_err());
            assert!(Tolerance::of(1e-6, value).is_err());
        }
        assert_eq!(
            Tolerance::of(1e-6, 1e-9).map(|tolerance| tolerance.absolute()),
            Ok(1e-9)
        );
    }
}
