//! A form of a model as data.

use core::any::Any;
use core::fmt;

use dalembert_numbers::{Held, Shared};

use super::series::SeriesTable;
use crate::jet::Work;
use crate::kernels::{Documentation, KernelTable, Tables};
use crate::numbers::Numbers;

/// Capacities for which erased systems are compiled.
pub const CAPACITIES: [usize; 2] = [8, 128];

/// Storage for parameters, inputs included, as a multiple of the capacity.
pub(super) const ARGUMENTS: usize = 2;

/// Storage for the values of kernels that give several quantities at once, as a multiple of the capacity.
pub(super) const ROWS: usize = 8;

/// Storage for the initial values of a series, as a multiple of the capacity.
pub(super) const FIRSTS: usize = 18;

/// Maximum number of initial values of a series of an erased system.
pub const MOST_FIRSTS: usize = FIRSTS * CAPACITIES[CAPACITIES.len() - 1];

/// Numbers of columns and rows of the storage for all geometric quantities at a state.
pub(super) const GEOMETRY: [usize; 2] = [64, 256];

/// Maximum number of entries of all geometric quantities at a state.
const ENTRIES: usize = GEOMETRY[0] * GEOMETRY[1];

/// Tables over other numbers than `f64`, each with its own type.
pub type Kinds = [Option<Held<dyn Any + Send + Sync>>; 7];

/// A function that writes values of parameters.
pub type Defaults = dyn Fn(&mut [f64]) + Send + Sync;

/// The place of the global form that belongs to a form.
pub enum Global {
    /// The form is the global one.
    Itself,
    /// The global form was not asked for.
    NotWritten,
    /// The form of a type.
    // NOTE: this is a function, because the constant of a type cannot refer to itself.
    OfType(fn() -> Option<&'static Form>),
    /// A separate form.
    Another(Shared<Form>),
}

/// A form of a model, or of a scene: tables, and pointers to its functions.
pub struct Form {
    /// Facts about the form apart from its kernels.
    pub tables: Held<Tables>,
    /// Documentation of the form.
    pub documentation: Held<Documentation>,
    /// The kernels.
    pub kernels: KernelTable<f64>,
    /// Tables of kernels over other numbers ([`KernelTable`]).
    pub kernels_over: Kinds,
    /// The power series of the motion.
    pub series: SeriesTable<f64>,
    /// The power series over other numbers ([`SeriesTable`]).
    pub series_over: Kinds,
    /// Work of an expansion, if known.
    pub work: Held<dyn Fn() -> Option<Work> + Send + Sync>,
    /// Number of gaps that have a series: all of them, or none.
    pub series_gaps: usize,
    /// Number of initial values of a series.
    pub firsts: usize,
    /// Writes the declared values of the parameters, and NaN for a parameter without one.
    pub defaults: Held<Defaults>,
    /// The global form.
    pub global: Global,
    /// For a model with modes, the forms of the modes and their global forms, in the order of the kernels
    /// ([`Mode::kernels`](crate::kernels::Mode::kernels)).
    pub forms: Held<[Shared<Form>]>,
    /// Number of values of the largest kernel that gives several quantities at once.
    pub room: usize,
}

/// A number that is too large for an erased system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Excess {
    /// Name of the counted things, in the plural.
    pub what: &'static str,
    /// The number.
    pub count: usize,
    /// The largest number for which there is room.
    pub most: usize,
}

impl Excess {
    const fn of(what: &'static str, count: usize, most: usize) -> Self {
        Self { what, count, most }
    }
}

impl core::error::Error for Excess {}

impl fmt::Display for Excess {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, count, most } = self;
        write!(f, "{count} {what}, and there is room for {most}")
    }
}

impl fmt::Debug for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Form")
            .field("name", &self.documentation.description.name)
            .field("form", &self.tables.form)
            .finish_non_exhaustive()
    }
}

impl Form {
    /// The least of [`CAPACITIES`] in which the form [fits](Form::fits); `None` if it is too large for each.
    pub const fn capacity(&self) -> Option<usize> {
        let mut k = 0;
        while k < CAPACITIES.len() {
            if self.fits(CAPACITIES[k]) {
                return Some(CAPACITIES[k]);
            }
            k += 1;
        }
        None
    }

    /// True if a system of this capacity has room for the vectors, parameters, kernels and series of the form, and for the
    /// states of the global form.
    pub const fn fits(&self, capacity: usize) -> bool {
        self.excess_over(capacity).is_none()
    }

    /// The first number that is too large for the largest of [`CAPACITIES`]; `None` if the form fits.
    pub const fn excess(&self) -> Option<Excess> {
        self.excess_over(CAPACITIES[CAPACITIES.len() - 1])
    }

    /// The first number that is too large for a system of this capacity; `None` if the form [fits](Form::fits).
    pub const fn excess_over(&self, capacity: usize) -> Option<Excess> {
        let dimensions = &self.tables.value().dimensions;
        let counts = [
            Excess::of("components of a state", dimensions.state, capacity),
            Excess::of(
                "positions and velocities (rates of a first-order system)",
                2 * dimensions.coordinates,
                capacity,
            ),
            Excess::of("surfaces", dimensions.surfaces, capacity),
            Excess::of(
                "parameters and inputs",
                dimensions.parameters,
                ARGUMENTS * capacity,
            ),
            Excess::of("derived quantities", self.room, ROWS * capacity),
            Excess::of("kept power series", self.firsts, FIRSTS * capacity),
            Excess::of(
                "entries of all quantities at a state",
                self.entries(),
                ENTRIES,
            ),
        ];
        let mut k = 0;
        while k < counts.len() {
            if counts[k].count > counts[k].most {
                return Some(counts[k]);
            }
            k += 1;
        }
        None
    }

    /// Number of entries of all geometric quantities at a state.
    const fn entries(&self) -> usize {
        let quantities = self.documentation.value().geometry.value();
        let mut count = 0;
        let mut k = 0;
        while k < quantities.len() {
            count += quantities[k].shape.count();
            k += 1;
        }
        count
    }

    /// The global form; the form itself if it is global. `None` if it was not asked for.
    pub fn global(&self) -> Option<&Self> {
        match &self.global {
            Global::Itself => Some(self),
            Global::NotWritten => None,
            Global::OfType(form) => form(),
            Global::Another(form) => Some(form),
        }
    }

    /// The kernels over these numbers, if the form has any.
    #[inline(always)]
    pub fn kernels<L: Numbers>(&self) -> Option<&KernelTable<L>> {
        found(&self.kernels, &self.kernels_over)
    }

    /// The series over these numbers, if the form has any.
    #[inline(always)]
    pub fn series<L: Numbers>(&self) -> Option<&SeriesTable<L>> {
        found(&self.series, &self.series_over)
    }
}

/// The table of type `T` among all tables of a form.
#[inline(always)]
fn found<'f, T: Any>(first: &'f dyn Any, others: &'f Kinds) -> Option<&'f T> {
    match first.downcast_ref() {
        Some(first) => Some(first),
        None => others
            .iter()
            .flatten()
            .find_map(|table| table.downcast_ref()),
    }
}
