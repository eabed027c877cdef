//! The part of a declared model that answers: the model itself, or one of its modes.
//!
//! The state of a model with modes is that of the present mode, zeros up to the length of the longest, and the number of the mode. So a
//! kernel of the mode reads the state as it is; what it gives of coordinates and surfaces is put to their places among those of the model.

use super::{At, Declared, Dimensions, Mode, Tables, Transition};
use crate::contract::{RankDrop, System, VectorField};
use crate::error::{Fault, StateError};
use crate::numbers::{Numbers, Row};
use crate::outcome::Outcome;
use crate::state::StateVector;

/// A part of a declared model. Kernels are asked through it.
#[derive(Debug)]
pub struct Part<'s, S: Declared> {
    system: &'s S,
    /// The kernels.
    pub(crate) kernels: S::Kernels,
    /// What is known of it.
    pub(crate) tables: &'static Tables,
    mode: Option<(usize, &'static Mode)>,
}

/// The number of the mode of a state, which is its last component.
#[inline(always)]
pub(crate) fn number_of<L: Numbers>(last: Option<&L>) -> usize {
    // NOTE: the conversion saturates. A step that estimates derivatives may move every component a little.
    (last.map_or(0.0, |number| number.lane(0)) + 0.5) as usize
}

/// Whether a system has modes.
#[inline(always)]
pub(crate) fn has_modes<S: Declared>(system: &S) -> bool {
    S::HAS_MODES && !system.tables().modes.is_empty()
}

impl<'s, S: Declared> Part<'s, S> {
    /// The mode of this number, the last one past the end; the model itself where there are no modes.
    #[inline(always)]
    pub(crate) fn numbered(system: &'s S, number: usize) -> Self {
        if const { S::HAS_MODES } {
            let modes = system.tables().modes;
            let number = number.min(modes.len().saturating_sub(1));
            if let Some(mode) = modes.get(number) {
                return Self {
                    system,
                    kernels: system.kernels_at(mode.kernels),
                    tables: mode.tables,
                    mode: Some((number, mode)),
                };
            }
        }
        Self {
            system,
            kernels: system.kernels(),
            tables: system.tables(),
            mode: None,
        }
    }

    /// The mode of a state.
    #[inline(always)]
    pub(crate) fn of<L: Numbers>(system: &'s S, state: &[L]) -> Self {
        match has_modes(system) {
            true => Self::numbered(system, number_of(state.last())),
            false => Self::numbered(system, 0),
        }
    }

    /// The mode that states are made in.
    #[inline(always)]
    pub(crate) fn start(system: &'s S) -> Self {
        match const { S::HAS_MODES } {
            true => Self::numbered(system, system.start()),
            false => Self::numbered(system, 0),
        }
    }

    /// The part that a surface of the model belongs to first, and its place in it.
    pub(crate) fn of_surface(system: &'s S, surface: usize) -> Option<(Self, usize)> {
        if !has_modes(system) {
            return Some((Self::numbered(system, 0), surface));
        }
        let mut modes = system.tables().modes.iter().enumerate();
        let (number, own) = modes.find_map(|(number, mode)| {
            let own = mode.surfaces.iter().position(|&place| place == surface)?;
            Some((number, own))
        })?;
        Some((Self::numbered(system, number), own))
    }

    /// The mode; `None` where the model answers itself.
    #[inline(always)]
    pub(crate) fn mode(&self) -> Option<&'static Mode> {
        self.mode.map(|(_, mode)| mode)
    }

    /// The number of the mode; 0 where the model answers itself.
    #[inline(always)]
    pub(crate) fn number(&self) -> usize {
        self.mode.map_or(0, |(number, _)| number)
    }

    /// The system with this mode as the one that states are made in.
    pub(crate) fn starting_here(&self) -> S {
        match self.mode {
            Some((number, _)) => self.system.starting_in(number),
            None => *self.system,
        }
    }

    /// The part with the kernels of its global form.
    pub(crate) fn globally(self) -> Self {
        match self.mode {
            Some((_, mode)) => Self {
                kernels: self.system.kernels_at(mode.global),
                ..self
            },
            None => self,
        }
    }

    /// Another mode of the same model.
    pub(super) fn other(&self, number: usize) -> Self {
        Self::numbered(self.system, number)
    }

    /// Numbers of things of the model.
    #[inline(always)]
    pub(super) fn system_dimensions(&self) -> &'static Dimensions {
        &self.system.tables().dimensions
    }

    /// Numbers of coordinates and of momenta or quasi-velocities.
    #[inline(always)]
    pub(crate) fn lengths(&self) -> [usize; 2] {
        let dimensions = &self.tables.dimensions;
        [dimensions.coordinates, dimensions.motion]
    }

    /// The place of a surface of the model.
    #[inline(always)]
    pub(crate) fn surface(&self, surface: usize) -> Option<usize> {
        match self.mode() {
            None => Some(surface),
            Some(mode) => mode.surfaces.iter().position(|&place| place == surface),
        }
    }

    /// The place of a surface that must be one of the part.
    #[inline(always)]
    pub(crate) fn known(&self, surface: usize) -> Result<usize, Fault> {
        self.surface(surface)
            .ok_or(Fault::SingularSurface { surface })
    }

    /// Where a surface of the model leads, if to another mode.
    pub(crate) fn transition(&self, surface: usize) -> Option<(usize, Transition)> {
        let own = self.surface(surface)?;
        let transition = self.mode()?.transitions.get(own).copied().flatten()?;
        Some((own, transition))
    }

    /// The place of a coordinate of the part among those of the model.
    #[inline(always)]
    pub(crate) fn coordinate(&self, own: usize) -> usize {
        self.mode().map_or(own, |mode| mode.coordinates[own])
    }

    /// Values at the beginning of a vector, one per coordinate of the part, at their places among those of the model; 0 elsewhere.
    #[inline(always)]
    pub(crate) fn spread<V: StateVector>(&self, values: V) -> V {
        match self.mode() {
            None => values,
            Some(mode) => placed(&values, mode.coordinates, 0.0),
        }
    }

    /// The values of the part's coordinates, at the beginning of a vector.
    #[inline(always)]
    pub(crate) fn gathered<V: StateVector>(&self, values: &V) -> V {
        match self.mode() {
            None => *values,
            Some(mode) => {
                let mut gathered = values.zeroed();
                let entries = gathered.as_mut_slice().iter_mut();
                for (entry, &place) in entries.zip(mode.coordinates) {
                    *entry = values.as_slice()[place];
                }
                gathered
            }
        }
    }

    /// Values of the model's coordinates, and this number for those that the part does not have.
    pub(crate) fn alone<V: StateVector>(&self, values: &V, elsewhere: f64) -> V {
        match self.mode() {
            None => *values,
            Some(mode) => placed(&self.gathered(values), mode.coordinates, elsewhere),
        }
    }

    /// Values at the beginning of a vector, one per surface of the part, at their places; this number elsewhere.
    #[inline(always)]
    pub(crate) fn of_surfaces<V: StateVector>(&self, values: V, elsewhere: f64) -> V {
        match self.mode() {
            None => values,
            Some(mode) => placed(&values, mode.surfaces, elsewhere),
        }
    }

    /// As [`Part::spread`], over numbers.
    pub(crate) fn spread_row<L: Numbers, R: Row<L>>(&self, row: R) -> R {
        match self.mode() {
            None => row,
            Some(mode) => placed_row(&row, mode.coordinates, L::ZERO),
        }
    }

    /// As [`Part::of_surfaces`], over numbers.
    pub(crate) fn row_of_surfaces<L: Numbers, R: Row<L>>(&self, row: R, elsewhere: L) -> R {
        match self.mode() {
            None => row,
            Some(mode) => placed_row(&row, mode.surfaces, elsewhere),
        }
    }

    /// Writes the number of the mode behind a state of it.
    #[inline(always)]
    pub(crate) fn sign<L: Numbers>(&self, state: &mut [L]) {
        if let (Some((number, _)), Some(last)) = (self.mode, state.last_mut()) {
            *last = L::of(number as f64);
        }
    }

    /// The fault with surface and constraint as the model numbers them.
    #[inline(always)]
    pub(crate) fn fault(&self, fault: Fault) -> Fault {
        let Some(mode) = self.mode() else {
            return fault;
        };
        match fault {
            Fault::SingularSurface { surface } => Fault::SingularSurface {
                surface: mode.surfaces.get(surface).copied().unwrap_or(surface),
            },
            Fault::SingularConstraint {
                constraint,
                condition,
            } => Fault::SingularConstraint {
                constraint: self.constraint(constraint),
                condition,
            },
            Fault::ProjectionFailed { constraint } => Fault::ProjectionFailed {
                constraint: self.constraint(constraint),
            },
            fault => fault,
        }
    }

    /// The place of dependent forms with the constraint as the model numbers it.
    pub(crate) fn rank_drop(&self, drop: RankDrop) -> RankDrop {
        RankDrop {
            constraint: self.constraint(drop.constraint),
            ..drop
        }
    }

    /// The place of a constraint of the part among those of the model.
    fn constraint(&self, own: usize) -> usize {
        let places = self.mode().map_or(&[][..], |mode| mode.constraints);
        places.get(own).copied().unwrap_or(own)
    }

    /// The refusal with the constraint as the model numbers it.
    pub(crate) fn refusal(&self, mut error: StateError) -> StateError {
        if let StateError::OffConstraint { constraint, .. }
        | StateError::OffPosition { constraint, .. } = &mut error
        {
            *constraint = self.constraint(*constraint);
        }
        error
    }

    /// The outcome with the constraint as the model numbers it.
    pub(crate) fn outcome(&self, mut outcome: Outcome) -> Outcome {
        if let Outcome::ProjectionFailed { constraint } = &mut outcome {
            *constraint = self.constraint(*constraint);
        }
        outcome
    }
}

/// Values at these places, and a number elsewhere.
#[inline(always)]
fn placed<V: StateVector>(values: &V, places: &[usize], elsewhere: f64) -> V {
    let mut all = values.zeroed();
    all.as_mut_slice().fill(elsewhere);
    for (&place, value) in places.iter().zip(values.as_slice()) {
        all.as_mut_slice()[place] = *value;
    }
    all
}

/// The same over numbers.
#[inline(always)]
fn placed_row<L: Numbers, R: Row<L>>(row: &R, places: &[usize], elsewhere: L) -> R {
    let mut all = R::zeros(row.as_slice().len());
    all.as_mut_slice().fill(elsewhere);
    for (&place, value) in places.iter().zip(row.as_slice()) {
        all.as_mut_slice()[place] = *value;
    }
    all
}

/// Values of kernels over `f64`, at the parameters of the system.
impl<S: Declared> Part<'_, S> {
    /// Writes the values of a kernel.
    #[inline(always)]
    pub(crate) fn write(
        &self,
        kernel: impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
        t: f64,
        [first, second]: [&[f64]; 2],
        values: &mut [f64],
    ) -> Result<(), Fault> {
        let arguments = self.system.arguments();
        let at = At {
            parameters: arguments.as_ref(),
            t,
            first,
            second,
        };
        let written = kernel(&self.kernels, at, values);
        match const { S::HAS_MODES } {
            true => written.map_err(|fault| self.fault(fault)),
            false => written,
        }
    }

    /// So many values of a kernel at the beginning of a vector of this length.
    #[inline(always)]
    pub(super) fn vector<V: StateVector>(
        &self,
        (kernel, [length, count]): (
            impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
            [usize; 2],
        ),
        t: f64,
        places: [&[f64]; 2],
    ) -> Result<V, Fault> {
        let mut values = V::zeros(length);
        let own = &mut values.as_mut_slice()[..count];
        self.write(kernel, t, places, own)?;
        Ok(values)
    }

    /// The values of a kernel, one per coordinate.
    #[inline(always)]
    pub(super) fn coordinates(
        &self,
        kernel: impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
        t: f64,
        places: [&[f64]; 2],
    ) -> Result<S::Vector, Fault> {
        let counts = [self.system.coordinate_count(), self.lengths()[0]];
        let values = self.vector((kernel, counts), t, places)?;
        Ok(self.spread(values))
    }

    /// The only value of a kernel.
    #[inline(always)]
    pub(super) fn number_by(
        &self,
        kernel: impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
        t: f64,
        places: [&[f64]; 2],
    ) -> Result<f64, Fault> {
        let mut value = [0.0];
        self.write(kernel, t, places, &mut value)?;
        Ok(value[0])
    }

    /// The values of a kernel that gives several things at once.
    #[inline(always)]
    pub(super) fn several(
        &self,
        (kernel, count): (
            impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
            usize,
        ),
        t: f64,
        places: [&[f64]; 2],
    ) -> Result<S::Room<f64>, Fault> {
        let mut room = S::Room::<f64>::zeros(count);
        self.write(kernel, t, places, &mut room.as_mut_slice()[..count])?;
        Ok(room)
    }

    /// Two vectors that a kernel gives: positions and velocities.
    pub(super) fn pair(
        &self,
        kernel: impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
        t: f64,
        places: [&[f64]; 2],
    ) -> Result<[S::Vector; 2], Fault> {
        let n = self.lengths()[0];
        let both = self.several((kernel, 2 * n), t, places)?;
        let (first, second) = both.as_slice()[..2 * n].split_at(n);
        Ok([first, second].map(|values| {
            let mut vector = self.system.zero_vector();
            vector.as_mut_slice()[..n].copy_from_slice(values);
            self.spread(vector)
        }))
    }

    /// A state whose motion is given by a kernel of positions and something else, both at the beginning of vectors.
    #[inline(always)]
    pub(super) fn state_by(
        &self,
        kernel: impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
        t: f64,
        q: &S::Vector,
        other: &S::Vector,
    ) -> Result<S::State, Fault> {
        let [n, k] = self.lengths();
        let mut state = self.system.zero_state();
        let (positions, motion) = state.as_mut_slice().split_at_mut(n);
        positions.copy_from_slice(&q.as_slice()[..n]);
        let places = [q.as_slice(), other.as_slice()];
        self.write(kernel, t, places, &mut motion[..k])?;
        self.sign(state.as_mut_slice());
        Ok(state)
    }

    /// Positions and what a state holds of the motion, at the beginning of vectors, as one state.
    #[inline(always)]
    pub(super) fn joined(&self, q: &[f64], motion: &[f64]) -> S::State {
        let [n, k] = self.lengths();
        let mut state = self.system.zero_state();
        let (positions, rest) = state.as_mut_slice().split_at_mut(n);
        positions.copy_from_slice(&q[..n]);
        rest[..k].copy_from_slice(&motion[..k]);
        self.sign(state.as_mut_slice());
        state
    }
}
