//! The system of a form with values for its parameters.

use core::fmt;

use super::bounded::{Bounded, Wide};
use super::form::{ARGUMENTS, Excess, Form, GEOMETRY, ROWS};
use crate::contract::{RankDrop, System, Tangent};
use crate::describe::{Instance, Report, VariationalVisitor};
use crate::error::{Fault, StateError};
use crate::generated::admit;
use crate::initial::{complete_positions, complete_velocities};
use crate::inputs::Actuated;
use crate::kernels::{
    Declared, Documentation, Documented, HasConstraints, HasDivergence, HasSurfaces, HasVariations,
    KernelTable, Part, Pointers, Tabled, Tables, nearest_of_declared,
};
use crate::numbers::Numbers;
use crate::rank::rank_drop;
use crate::state::StateVector;

/// A model known only at run time, with values for its parameters; its vectors have at most `C` components.
#[derive(Clone, Copy)]
pub struct Erased<'f, const C: usize> {
    form: &'f Form,
    values: Wide<f64, C, ARGUMENTS>,
    /// The mode in which states are made.
    mode: usize,
}

impl<'f, const C: usize> Erased<'f, C> {
    /// The model with its declared defaults; a parameter without default is NaN until it is set.
    ///
    /// # Errors
    /// [`Excess`] if the form does not [fit](Form::fits) into the capacity `C`.
    pub fn of(form: &'f Form) -> Result<Self, Excess> {
        if let Some(excess) = form.excess_over(C) {
            return Err(excess);
        }
        let mut values = Wide::all(form.tables.dimensions.parameters, 0.0);
        (form.defaults)(values.as_mut());
        Ok(Self {
            form,
            values,
            mode: 0,
        })
    }

    /// The form.
    #[inline(always)]
    pub fn form(&self) -> &'f Form {
        self.form
    }

    /// The values of the parameters.
    #[inline(always)]
    pub(super) fn values(&self) -> &Wide<f64, C, ARGUMENTS> {
        &self.values
    }

    /// Number of constraints of the form; for a model with modes, of the mode in which states are made.
    fn constraints(&self) -> usize {
        Part::start(self).tables.dimensions.constraints
    }

    /// A mode as a separate system.
    fn of_mode(&self, number: usize) -> Option<Self> {
        let mode = self.form.tables.modes.get(number)?;
        Some(Self {
            form: self.form.forms.get(mode.kernels)?,
            values: self.values,
            mode: 0,
        })
    }
}

impl<const C: usize> PartialEq for Erased<'_, C> {
    fn eq(&self, other: &Self) -> bool {
        core::ptr::eq(self.form, other.form)
            && self.values == other.values
            && self.mode == other.mode
    }
}

impl<const C: usize> fmt::Debug for Erased<'_, C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Erased")
            .field("form", self.form)
            .field("values", &self.values)
            .field("mode", &self.mode)
            .finish()
    }
}

impl Tabled for &Form {
    #[inline(always)]
    fn table<L: Numbers>(&self) -> Option<&KernelTable<L>> {
        Form::kernels(self)
    }
}

impl<'f, const C: usize> Declared for Erased<'f, C> {
    type State = Bounded<f64, C>;
    type Vector = Bounded<f64, C>;
    type Impulse = Bounded<f64, C>;
    type Gaps = Bounded<f64, C>;
    type Multipliers = Bounded<f64, C>;
    type Levels = Bounded<f64, C>;
    type Positions<L: Numbers> = Bounded<L, C>;
    type Components<L: Numbers> = Bounded<L, C>;
    type Arguments<L: Numbers> = Wide<L, C, ARGUMENTS>;
    type Room<L: Numbers> = Wide<L, C, ROWS>;
    type Values<'a>
        = &'a [f64]
    where
        Self: 'a;
    type Kernels = Pointers<&'f Form>;

    const MAY_BE_NARROW: bool = true;
    const MAY_LOSE_RANK: bool = true;

    const HAS_MODES: bool = true;

    #[inline(always)]
    fn kernels(&self) -> Pointers<&'f Form> {
        Pointers(self.form)
    }

    #[inline(always)]
    fn kernels_at(&self, place: usize) -> Pointers<&'f Form> {
        Pointers(self.form.forms.get(place).map_or(self.form, |form| form))
    }

    #[inline(always)]
    fn start(&self) -> usize {
        self.mode
    }

    fn starting_in(&self, mode: usize) -> Self {
        Self { mode, ..*self }
    }

    #[inline(always)]
    fn tables(&self) -> &Tables {
        &self.form.tables
    }

    #[inline(always)]
    fn arguments(&self) -> &[f64] {
        self.values.as_ref()
    }

    fn rank_drop_along(
        &self,
        motion: impl Fn(f64) -> (f64, Bounded<f64, C>),
        reach: f64,
    ) -> Option<RankDrop> {
        if self.form.tables.modes.is_empty() {
            let can_lose_rank = self.form.tables.can_lose_rank;
            return can_lose_rank
                .then(|| rank_drop::<Self, C, C>(self, motion, reach))
                .flatten();
        }
        let (_, state) = motion(0.0);
        let part = Part::of(self, state.as_ref());
        let mode = self.of_mode(part.number())?;
        let length = mode.form.tables.dimensions.state;
        let along = |theta: f64| {
            let (t, state) = motion(theta);
            (t, Bounded::of(&state.as_ref()[..length]))
        };
        let drop = mode.rank_drop_along(&along as &dyn Fn(f64) -> (f64, Bounded<f64, C>), reach)?;
        Some(part.rank_drop(drop))
    }

    fn admits(
        &self,
        t: f64,
        q: &Bounded<f64, C>,
        qdot: &Bounded<f64, C>,
    ) -> Result<(), StateError> {
        match self.constraints() {
            0 => Ok(()),
            _ => admit(self, t, q, qdot),
        }
    }

    fn completed_position(
        &self,
        t: f64,
        q: &Bounded<f64, C>,
        placed: &Bounded<f64, C>,
    ) -> Result<Bounded<f64, C>, StateError> {
        match &*Part::start(self).tables.levels {
            [] => Ok(*q),
            _ => complete_positions(self, t, q, placed),
        }
    }

    fn completed_velocity(
        &self,
        t: f64,
        q: &Bounded<f64, C>,
        qdot: &Bounded<f64, C>,
        named: &Bounded<f64, C>,
    ) -> Result<Bounded<f64, C>, StateError> {
        match self.constraints() {
            0 => Ok(*qdot),
            _ => complete_velocities(self, t, q, qdot, named),
        }
    }

    fn nearest_by_steps(
        &self,
        t: f64,
        q: &Bounded<f64, C>,
        qdot: &Bounded<f64, C>,
    ) -> Result<Bounded<f64, C>, Fault> {
        match self.constraints() {
            0 => self.state_unchecked(t, q, qdot),
            _ => nearest_of_declared(self, t, q, qdot),
        }
    }
}

/// Inputs come after the described parameters.
impl<const C: usize> Actuated for Erased<'_, C> {
    type Inputs = Wide<f64, C, ARGUMENTS>;

    fn set_inputs(&mut self, inputs: &Self::Inputs) {
        let first = self.form.documentation.description.parameters.len();
        let entries = self.values.as_mut().iter_mut().skip(first);
        for (entry, input) in entries.zip(inputs.as_ref()) {
            *entry = *input;
        }
    }
}

impl<const C: usize> HasConstraints for Erased<'_, C> {}

impl<const C: usize> HasSurfaces for Erased<'_, C> {}

impl<const C: usize> HasDivergence for Erased<'_, C> {}

impl<const C: usize> HasVariations for Erased<'_, C> {
    type Clearances<L: Numbers> = Bounded<L, C>;
    type Collision<L: Numbers> = Wide<L, C, 3>;
    type Deviations<L: Numbers> = Wide<L, C, 2>;
    type Columns = [Bounded<f64, C>; C];
    type Tangents = [Tangent<Self>; C];

    fn columns() -> [Bounded<f64, C>; C] {
        [StateVector::zeros(C); C]
    }

    fn tangents() -> [Tangent<Self>; C] {
        [Tangent::zero(); C]
    }
}

impl<const C: usize> Documented for Erased<'_, C> {
    type Geometry = Wide<f64, { GEOMETRY[0] }, { GEOMETRY[1] }>;
    type Global = Self;

    fn documentation(&self) -> &Documentation {
        &self.form.documentation
    }

    fn globally(&self) -> Option<Self> {
        let form = self.form.global()?;
        Some(Self { form, ..*self })
    }

    fn show_variational<Visitor: VariationalVisitor>(
        &self,
        visitor: Visitor,
    ) -> Option<Visitor::Output> {
        self.form.tables.varies.then(|| visitor.visit(self))
    }

    fn set_start(&mut self, mode: usize) {
        if mode < self.form.tables.modes.len() {
            self.mode = mode;
        }
    }

    fn inspect_mode(
        &self,
        mode: usize,
        t: f64,
        state: &[f64],
        report: &mut dyn Report,
    ) -> Result<(), Fault> {
        let part = self.of_mode(mode).ok_or(Fault::NotDerived)?;
        let state = Bounded::of(&state[..part.form.tables.dimensions.state]);
        part.inspect(t, &state, report)
    }

    fn set_argument(&mut self, index: usize, value: f64) {
        if let Some(entry) = self.values.as_mut().get_mut(index) {
            *entry = value;
        }
    }
}
