//! One value per surface of a system.

use core::ops::{Index, IndexMut};

use crate::state::{Plain, StateVector};

/// One value per surface, in order of declaration, for a system whose gaps have type `G`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PerSurface<T: Plain, G: StateVector>(G::Each<T>);

impl<T: Plain, G: StateVector> PerSurface<T, G> {
    /// The same value for every surface. `gaps` determines the number of surfaces.
    pub(crate) fn all(gaps: &G, value: T) -> Self {
        Self(G::each(gaps.count(), value))
    }

    /// The value of a surface; `None` past the last.
    pub(crate) fn get(&self, surface: usize) -> Option<T> {
        self.0.as_ref().get(surface).copied()
    }

    /// Sets the value of a surface. An index past the last surface has no effect.
    pub(crate) fn set(&mut self, surface: usize, value: T) {
        if let Some(place) = self.0.as_mut().get_mut(surface) {
            *place = value;
        }
    }

    /// Sets every value.
    pub(crate) fn fill(&mut self, value: T) {
        self.0.as_mut().fill(value);
    }

    /// The number of surfaces.
    pub(crate) fn count(&self) -> usize {
        self.0.as_ref().len()
    }

    /// The values in order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = T> + '_ {
        self.0.as_ref().iter().copied()
    }

    /// Mutable references to the values, in order.
    pub(crate) fn iter_mut(&mut self) -> impl Iterator<Item = &mut T> {
        self.0.as_mut().iter_mut()
    }
}

impl<T: Plain, G: StateVector> Index<usize> for PerSurface<T, G> {
    type Output = T;

    #[inline(always)]
    fn index(&self, surface: usize) -> &T {
        &self.0.as_ref()[surface]
    }
}

impl<T: Plain, G: StateVector> IndexMut<usize> for PerSurface<T, G> {
    #[inline(always)]
    fn index_mut(&mut self, surface: usize) -> &mut T {
        &mut self.0.as_mut()[surface]
    }
}
