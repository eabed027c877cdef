//! `Constrained` of every declared model with constraints.

use super::declared::{several, vector, write};
use super::{Declared, Form, HasConstraints, Kernels};
use crate::contract::{Constrained, Level, System};
use crate::error::Fault;
use crate::numbers::Row;
use crate::state::StateVector;

/// The forms at a velocity, and their affine parts.
fn write_forms<S: Declared>(
    system: &S,
    t: f64,
    places: [&[f64]; 2],
    forms: &mut [f64],
    affine: &mut S::Multipliers,
) {
    let (n, m) = (system.coordinate_count(), affine.count());
    let kernel = (S::Kernels::forms, n * m + m);
    // Forms have no guards.
    if let Ok(both) = several(system, kernel, t, places) {
        let (own, rest) = both.as_slice()[..n * m + m].split_at(n * m);
        forms.copy_from_slice(own);
        affine.as_mut_slice().copy_from_slice(rest);
    }
}

impl<S: Declared + HasConstraints> Constrained for S {
    type Multipliers = S::Multipliers;
    type Levels = S::Levels;

    #[inline(always)]
    fn constraint_count(&self) -> usize {
        self.tables().dimensions.constraints
    }

    #[inline(always)]
    fn level_count(&self) -> usize {
        self.tables().dimensions.levels
    }

    #[inline]
    fn multipliers(&self, t: f64, state: &S::State) -> Result<S::Multipliers, Fault> {
        let kernel = (S::Kernels::multipliers, self.constraint_count());
        vector(self, kernel, t, [state.as_slice(), &[]])
    }

    #[inline]
    fn residuals(
        &self,
        t: f64,
        q: &S::Vector,
        qdot: &S::Vector,
    ) -> (S::Multipliers, S::Multipliers) {
        let m = self.constraint_count();
        let kernel = (S::Kernels::residuals, 2 * m);
        // Residuals have no guards.
        match several(self, kernel, t, [q.as_slice(), qdot.as_slice()]) {
            Ok(both) => {
                let (values, scales) = both.as_slice()[..2 * m].split_at(m);
                (S::Multipliers::of(values), S::Multipliers::of(scales))
            }
            Err(_) => (self.zero_multipliers(), self.zero_multipliers()),
        }
    }

    fn constraint_forms(
        &self,
        t: f64,
        q: &S::Vector,
        forms: &mut [f64],
        affine: &mut S::Multipliers,
    ) {
        let rest = q.zeroed();
        write_forms(self, t, [q.as_slice(), rest.as_slice()], forms, affine);
    }

    #[inline(always)]
    fn is_linear(&self) -> bool {
        self.tables().is_linear
    }

    fn linearised_forms(
        &self,
        t: f64,
        q: &S::Vector,
        qdot: &S::Vector,
        forms: &mut [f64],
        affine: &mut S::Multipliers,
    ) {
        write_forms(self, t, [q.as_slice(), qdot.as_slice()], forms, affine);
    }

    #[inline(always)]
    fn is_reduced(&self) -> bool {
        self.tables().form == Form::Reduced
    }

    #[inline]
    fn restore(&self, t: f64, state: &mut S::State) -> Result<(), Fault> {
        if self.tables().form == Form::Reduced {
            return Ok(());
        }
        let before = *state;
        let motion = &mut state.as_mut_slice()[self.coordinate_count()..];
        let restored = write(
            self,
            S::Kernels::restore,
            t,
            [before.as_slice(), &[]],
            motion,
        );
        if restored.is_err() {
            *state = before;
        }
        restored
    }

    #[inline(always)]
    fn declared_levels(&self) -> &'static [Level] {
        self.tables().levels
    }

    fn level_scales(&self, t: f64, q: &S::Vector) -> S::Levels {
        if self.tables().levels.is_empty() {
            return self.zero_levels();
        }
        let kernel = (S::Kernels::level_scales, self.level_count());
        let scales = vector(self, kernel, t, [q.as_slice(), &[]]);
        scales.unwrap_or_else(|_| self.zero_levels())
    }

    #[inline]
    fn levels(&self, t: f64, q: &S::Vector) -> S::Levels {
        let kernel = (S::Kernels::levels, self.level_count());
        let levels = vector(self, kernel, t, [q.as_slice(), &[]]);
        levels.unwrap_or_else(|_| self.zero_levels())
    }

    fn level_correction(
        &self,
        t: f64,
        q: &S::Vector,
        excess: &S::Levels,
    ) -> Result<S::Vector, Fault> {
        let kernel = (S::Kernels::level_correction, self.coordinate_count());
        vector(self, kernel, t, [q.as_slice(), excess.as_slice()])
    }
}
