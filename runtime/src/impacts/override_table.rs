//! Laws chosen at run time, one slot per surface, without a bound on the number of surfaces.

use super::law::Law;
use crate::state::StateVector;

/// The laws a caller put in place of the declared ones. A law is kept as two numbers, its place in [`Law::NAMES`]
/// and its coefficient, because vectors of numbers are what a system has one of per surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Overrides<V> {
    places: V,
    coefficients: V,
}

/// The place of a surface whose declared law stands.
const DECLARED: f64 = -1.0;

impl<V: StateVector> Overrides<V> {
    /// Every declared law stands, of as many surfaces as there are components here.
    pub(crate) fn none(like: &V) -> Self {
        let mut places = like.zeroed();
        places.as_mut_slice().fill(DECLARED);
        Self {
            places,
            coefficients: like.zeroed(),
        }
    }

    /// Puts a law in place of the declared one; a surface past the end changes nothing.
    pub(crate) fn set(&mut self, surface: usize, law: Law) {
        let place = Law::NAMES.iter().position(|(name, _)| *name == law.name());
        if let (Some(place), true) = (place, surface < self.places.count()) {
            self.places.as_mut_slice()[surface] = place as f64;
            self.coefficients.as_mut_slice()[surface] = law.coefficient().unwrap_or(0.0);
        }
    }

    /// The law put in place of the declared one.
    pub(crate) fn get(&self, surface: usize) -> Option<Law> {
        let place = *self.places.as_slice().get(surface)?;
        let (name, _) = Law::NAMES.get(usize::try_from(place as i64).ok()?)?;
        Law::from_name(name, self.coefficients.as_slice()[surface])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_law_is_kept_as_it_was_given() {
        let mut overrides = Overrides::none(&nalgebra::SVector::<f64, 2>::zeros());
        for (name, _) in Law::NAMES {
            let law = Law::from_name(name, 0.25);
            overrides.set(1, law.unwrap_or(Law::Elastic));
            assert_eq!(overrides.get(1), law);
        }
        assert_eq!(overrides.get(0), None);
        overrides.set(2, Law::Elastic);
        assert_eq!(overrides.get(2), None);
    }
}
