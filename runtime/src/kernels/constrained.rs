//! `Constrained` for every declared model with constraints. In a model with modes, functions of a state evaluate the
//! constraints of the mode of the state; the other functions those of the mode in which states are made.

use super::{At, Declared, Form, HasConstraints, Kernels, Part};
use crate::contract::{Constrained, Level, System};
use crate::error::Fault;
use crate::numbers::Row;
use crate::state::StateVector;

/// Writes the forms at a velocity, and their affine parts.
fn write_forms<S: Declared>(
    system: &S,
    t: f64,
    [q, qdot]: [&S::Vector; 2],
    forms: &mut [f64],
    affine: &mut S::Multipliers,
) {
    let part = Part::start(system);
    let (all, [n, _]) = (system.coordinate_count(), part.lengths());
    let m = part.tables.dimensions.constraints;
    let kernel = (S::Kernels::forms, n * m + m);
    let [q, qdot] = [part.gathered(q), part.gathered(qdot)];
    // The kernel of the forms has no guards, so it does not fail.
    let Ok(both) = part.several(kernel, t, [q.as_slice(), qdot.as_slice()]) else {
        return;
    };
    let (entries, rest) = both.as_slice()[..n * m + m].split_at(n * m);
    affine.as_mut_slice()[..m].copy_from_slice(rest);
    if part.mode().is_none() {
        forms.copy_from_slice(entries);
        return;
    }
    forms.fill(0.0);
    for (row, form) in forms.chunks_exact_mut(all).zip(entries.chunks_exact(n)) {
        for (i, entry) in form.iter().enumerate() {
            row[part.coordinate(i)] = *entry;
        }
    }
}

impl<S: Declared + HasConstraints> Constrained for S {
    type Multipliers = S::Multipliers;
    type Levels = S::Levels;

    #[inline(always)]
    fn constraint_count(&self) -> usize {
        Part::start(self).tables.dimensions.constraints
    }

    #[inline(always)]
    fn level_count(&self) -> usize {
        Part::start(self).tables.dimensions.levels
    }

    #[inline]
    fn multipliers(&self, t: f64, state: &S::State) -> Result<S::Multipliers, Fault> {
        let part = Part::of(self, state.as_slice());
        let m = part.tables.dimensions.constraints;
        let kernel = (S::Kernels::multipliers, [m; 2]);
        part.vector(kernel, t, [state.as_slice(), &[]])
    }

    #[inline]
    fn residuals(
        &self,
        t: f64,
        q: &S::Vector,
        qdot: &S::Vector,
    ) -> (S::Multipliers, S::Multipliers) {
        let part = Part::start(self);
        let m = part.tables.dimensions.constraints;
        let (mut residuals, mut scales) = (self.zero_multipliers(), self.zero_multipliers());
        let [q, qdot] = [part.gathered(q), part.gathered(qdot)];
        let kernel = (S::Kernels::residuals, 2 * m);
        // The kernel of the residuals has no guards, so it does not fail.
        if let Ok(both) = part.several(kernel, t, [q.as_slice(), qdot.as_slice()]) {
            let (values, sizes) = both.as_slice()[..2 * m].split_at(m);
            residuals.as_mut_slice()[..m].copy_from_slice(values);
            scales.as_mut_slice()[..m].copy_from_slice(sizes);
        }
        (residuals, scales)
    }

    fn constraint_forms(
        &self,
        t: f64,
        q: &S::Vector,
        forms: &mut [f64],
        affine: &mut S::Multipliers,
    ) {
        write_forms(self, t, [q, &q.zeroed()], forms, affine);
    }

    #[inline(always)]
    fn is_linear(&self) -> bool {
        Part::start(self).tables.is_linear
    }

    fn linearised_forms(
        &self,
        t: f64,
        q: &S::Vector,
        qdot: &S::Vector,
        forms: &mut [f64],
        affine: &mut S::Multipliers,
    ) {
        write_forms(self, t, [q, qdot], forms, affine);
    }

    #[inline(always)]
    fn is_reduced(&self) -> bool {
        Part::start(self).tables.form == Form::Reduced
    }

    #[inline]
    fn restore(&self, t: f64, state: &mut S::State) -> Result<(), Fault> {
        let before = *state;
        let part = Part::of(self, before.as_slice());
        if part.tables.form == Form::Reduced || part.tables.dimensions.constraints == 0 {
            return Ok(());
        }
        let [n, k] = part.lengths();
        let motion = &mut state.as_mut_slice()[n..n + k];
        let restored = part.write(S::Kernels::restore, t, [before.as_slice(), &[]], motion);
        if restored.is_err() {
            *state = before;
        }
        restored
    }

    #[inline(always)]
    fn declared_levels(&self) -> &[Level] {
        &Part::start(self).tables.levels
    }

    fn level_scales(&self, t: f64, q: &S::Vector) -> S::Levels {
        let part = Part::start(self);
        if part.tables.levels.is_empty() {
            return self.zero_levels();
        }
        levels_by(&part, S::Kernels::level_scales, t, q)
    }

    #[inline]
    fn levels(&self, t: f64, q: &S::Vector) -> S::Levels {
        levels_by(&Part::start(self), S::Kernels::levels, t, q)
    }

    fn level_correction(
        &self,
        t: f64,
        q: &S::Vector,
        excess: &S::Levels,
    ) -> Result<S::Vector, Fault> {
        let part = Part::start(self);
        let q = part.gathered(q);
        let places = [q.as_slice(), excess.as_slice()];
        part.coordinates(S::Kernels::level_correction, t, places)
    }
}

/// One number per level, from a kernel of the positions.
#[inline(always)]
fn levels_by<S: Declared>(
    part: &Part<'_, S>,
    kernel: impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
    t: f64,
    q: &S::Vector,
) -> S::Levels {
    let count = part.tables.dimensions.levels;
    let q = part.gathered(q);
    let levels = part.vector((kernel, [count; 2]), t, [q.as_slice(), &[]]);
    levels.unwrap_or_else(|_| StateVector::zeros(count))
}
