//! The part of a declared model that is evaluated: the model itself, or one of its modes.
//!
//! A state of a model with modes consists of the state of the present mode, zeros up to the length of the longest mode,
//! and the number of the mode. A kernel of the mode reads this state unchanged. Results per coordinate or surface are
//! moved from the numbering of the mode to that of the model.

use super::{At, Declared, Dimensions, Mode, Tables, Transition};
use crate::contract::{RankDrop, System, VectorField};
use crate::error::{Fault, StateError};
use crate::numbers::{Numbers, Row};
use crate::outcome::Outcome;
use crate::state::StateVector;

/// A part of a declared model. All kernels are called through it.
#[derive(Debug)]
pub struct Part<'s, S: Declared> {
    system: &'s S,
    /// The kernels.
    pub(crate) kernels: S::Kernels,
    /// Tables of the part: dimensions, names and other facts about it.
    pub(crate) tables: &'s Tables,
    mode: Option<(usize, &'s Mode)>,
}

/// Number of the mode of a state, stored in its last component.
#[inline(always)]
pub(crate) fn number_of<L: Numbers>(last: Option<&L>) -> usize {
    // NOTE: the conversion saturates. Rounding to the nearest number tolerates the small changes made by difference
    // quotients.
    (last.map_or(0.0, |number| number.lane(0)) + 0.5) as usize
}

/// True if a system has modes.
#[inline(always)]
pub(crate) fn has_modes<S: Declared>(system: &S) -> bool {
    S::HAS_MODES && !system.tables().modes.is_empty()
}

impl<'s, S: Declared> Part<'s, S> {
    /// The mode with this number, or the last mode if the number is too large. Without modes, the model itself.
    #[inline(always)]
    pub(crate) fn numbered(system: &'s S, number: usize) -> Self {
        if const { S::HAS_MODES } {
            let modes = &system.tables().modes;
            let number = number.min(modes.len().saturating_sub(1));
            if let Some(mode) = modes.get(number) {
                return Self {
                    system,
                    kernels: system.kernels_at(mode.kernels),
                    tables: &mode.tables,
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

    /// The mode in which new states are made.
    #[inline(always)]
    pub(crate) fn start(system: &'s S) -> Self {
        match const { S::HAS_MODES } {
            true => Self::numbered(system, system.start()),
            false => Self::numbered(system, 0),
        }
    }

    /// All modes. Without modes, the model itself.
    pub(crate) fn all(system: &'s S) -> impl Iterator<Item = Self> {
        let count = match has_modes(system) {
            true => system.tables().modes.len(),
            false => 1,
        };
        (0..count).map(|number| Self::numbered(system, number))
    }

    /// The first part that has this surface of the model, and the index of the surface in the part.
    pub(crate) fn of_surface(system: &'s S, surface: usize) -> Option<(Self, usize)> {
        if !has_modes(system) {
            return Some((Self::numbered(system, 0), surface));
        }
        let mut modes = system.tables().modes.iter().enumerate();
        let (number, local) = modes.find_map(|(number, mode)| {
            let local = mode.surfaces.iter().position(|&place| place == surface)?;
            Some((number, local))
        })?;
        Some((Self::numbered(system, number), local))
    }

    /// The mode; `None` if the part is the model itself.
    #[inline(always)]
    pub(crate) fn mode(&self) -> Option<&'s Mode> {
        self.mode.map(|(_, mode)| mode)
    }

    /// Number of the mode; 0 if the part is the model itself.
    #[inline(always)]
    pub(crate) fn number(&self) -> usize {
        self.mode.map_or(0, |(number, _)| number)
    }

    /// The same system, set to make new states in this mode.
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

    /// Dimensions of the model.
    #[inline(always)]
    pub(super) fn system_dimensions(&self) -> &'s Dimensions {
        &self.system.tables().dimensions
    }

    /// Numbers of coordinates and of momenta or quasi-velocities.
    #[inline(always)]
    pub(crate) fn lengths(&self) -> [usize; 2] {
        let dimensions = &self.tables.dimensions;
        [dimensions.coordinates, dimensions.motion]
    }

    /// Index that a surface of the model has in the part; `None` if the part does not have the surface.
    #[inline(always)]
    pub(crate) fn surface(&self, surface: usize) -> Option<usize> {
        match self.mode() {
            None => Some(surface),
            Some(mode) => mode.surfaces.iter().position(|&place| place == surface),
        }
    }

    /// Index that a surface of the model has in the part. Fails if the part does not have the surface.
    #[inline(always)]
    pub(crate) fn known(&self, surface: usize) -> Result<usize, Fault> {
        self.surface(surface)
            .ok_or(Fault::SingularSurface { surface })
    }

    /// Index that a surface of the model has in the part, and its transition; `None` if the surface does not lead to
    /// another mode.
    pub(crate) fn transition(&self, surface: usize) -> Option<(usize, Transition)> {
        let local = self.surface(surface)?;
        let transition = self.mode()?.transitions.get(local).copied().flatten()?;
        Some((local, transition))
    }

    /// Index that a coordinate of the part has in the model.
    #[inline(always)]
    pub(crate) fn coordinate(&self, local: usize) -> usize {
        self.mode().map_or(local, |mode| mode.coordinates[local])
    }

    /// Moves values per coordinate of the part, at the beginning of a vector, to the indices of these coordinates in
    /// the model. All other entries are 0.
    #[inline(always)]
    pub(crate) fn spread<V: StateVector>(&self, values: V) -> V {
        match self.mode() {
            None => values,
            Some(mode) => placed(&values, &mode.coordinates, 0.0),
        }
    }

    /// Inverse of [`Part::spread`]: moves the values of the part's coordinates to the beginning of a vector.
    #[inline(always)]
    pub(crate) fn gathered<V: StateVector>(&self, values: &V) -> V {
        match self.mode() {
            None => *values,
            Some(mode) => {
                let mut gathered = values.zeroed();
                let entries = gathered.as_mut_slice().iter_mut();
                for (entry, &place) in entries.zip(&mode.coordinates) {
                    *entry = values.as_slice()[place];
                }
                gathered
            }
        }
    }

    /// Keeps the values of the part's coordinates. All other entries are `elsewhere`.
    pub(crate) fn alone<V: StateVector>(&self, values: &V, elsewhere: f64) -> V {
        match self.mode() {
            None => *values,
            Some(mode) => placed(&self.gathered(values), &mode.coordinates, elsewhere),
        }
    }

    /// Moves values per surface of the part, at the beginning of a vector, to the indices of these surfaces in the
    /// model. All other entries are `elsewhere`.
    #[inline(always)]
    pub(crate) fn of_surfaces<V: StateVector>(&self, values: V, elsewhere: f64) -> V {
        match self.mode() {
            None => values,
            Some(mode) => placed(&values, &mode.surfaces, elsewhere),
        }
    }

    /// Same as [`Part::spread`], over any [`Numbers`].
    pub(crate) fn spread_row<L: Numbers, R: Row<L>>(&self, row: R) -> R {
        match self.mode() {
            None => row,
            Some(mode) => placed_row(&row, &mode.coordinates, L::ZERO),
        }
    }

    /// Same as [`Part::gathered`], over any [`Numbers`].
    pub(crate) fn gathered_row<L: Numbers, R: Row<L>>(&self, row: &R) -> R {
        let Some(mode) = self.mode() else {
            return *row;
        };
        let mut gathered = R::zeros(row.as_slice().len());
        let entries = gathered.as_mut_slice().iter_mut();
        for (entry, &place) in entries.zip(&mode.coordinates) {
            *entry = row.as_slice()[place];
        }
        gathered
    }

    /// Same as [`Part::of_surfaces`], over any [`Numbers`].
    pub(crate) fn row_of_surfaces<L: Numbers, R: Row<L>>(&self, row: R, elsewhere: L) -> R {
        match self.mode() {
            None => row,
            Some(mode) => placed_row(&row, &mode.surfaces, elsewhere),
        }
    }

    /// Writes the number of the mode into the last component of a state.
    #[inline(always)]
    pub(crate) fn sign<L: Numbers>(&self, state: &mut [L]) {
        if let (Some((number, _)), Some(last)) = (self.mode, state.last_mut()) {
            *last = L::of(number as f64);
        }
    }

    /// Replaces indices of the part (coordinate, surface, constraint) in a fault by those of the model.
    #[inline(always)]
    pub(crate) fn fault(&self, fault: Fault) -> Fault {
        match self.mode() {
            Some(mode) => fault.of_mode(mode),
            None => fault,
        }
    }

    /// Replaces the constraint's index in a loss of rank by that of the model.
    pub(crate) fn rank_drop(&self, drop: RankDrop) -> RankDrop {
        RankDrop {
            constraint: self.constraint(drop.constraint),
            ..drop
        }
    }

    /// Index that a constraint of the part has in the model.
    fn constraint(&self, local: usize) -> usize {
        let places = self.mode().map_or(&[][..], |mode| &mode.constraints);
        places.get(local).copied().unwrap_or(local)
    }

    /// Replaces the constraint's index in a state error by that of the model.
    pub(crate) fn refusal(&self, mut error: StateError) -> StateError {
        if let StateError::OffConstraint { constraint, .. }
        | StateError::OffPosition { constraint, .. } = &mut error
        {
            *constraint = self.constraint(*constraint);
        }
        error
    }

    /// Replaces the constraint's index in an outcome by that of the model.
    pub(crate) fn outcome(&self, mut outcome: Outcome) -> Outcome {
        if let Outcome::ProjectionFailed { constraint } = &mut outcome {
            *constraint = self.constraint(*constraint);
        }
        outcome
    }
}

/// Moves value `i` to the index `places[i]`. All other entries are `elsewhere`.
#[inline(always)]
fn placed<V: StateVector>(values: &V, places: &[usize], elsewhere: f64) -> V {
    let mut all = values.zeroed();
    all.as_mut_slice().fill(elsewhere);
    for (&place, value) in places.iter().zip(values.as_slice()) {
        all.as_mut_slice()[place] = *value;
    }
    all
}

/// Same as [`placed`], over any [`Numbers`].
#[inline(always)]
fn placed_row<L: Numbers, R: Row<L>>(row: &R, places: &[usize], elsewhere: L) -> R {
    let mut all = R::zeros(row.as_slice().len());
    all.as_mut_slice().fill(elsewhere);
    for (&place, value) in places.iter().zip(row.as_slice()) {
        all.as_mut_slice()[place] = *value;
    }
    all
}

/// Calls of kernels over `f64`, with the parameters of the system.
impl<S: Declared> Part<'_, S> {
    /// Evaluates a kernel into `values`.
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

    /// Evaluates a kernel of `count` values into the beginning of a vector of `length` entries.
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
        let entries = &mut values.as_mut_slice()[..count];
        self.write(kernel, t, places, entries)?;
        Ok(values)
    }

    /// Evaluates a kernel with one value per coordinate.
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

    /// Evaluates a kernel with a single value.
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

    /// Evaluates a kernel whose `count` values make up several quantities.
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

    /// Evaluates a kernel that gives two vectors, for example positions and velocities.
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

    /// A state with the given positions, whose momenta or quasi-velocities are computed by a kernel from the positions
    /// and a second vector. Both vectors are in the order of the part, at the beginning.
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

    /// A state of the mode from positions and from momenta or quasi-velocities, which are the first entries of `q` and
    /// `motion`.
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
