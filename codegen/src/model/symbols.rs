//! The symbols of a model: time, coordinates, velocities, differentials, parameters; and the meaning of each name.

use std::collections::BTreeMap;

use dalembert_expr::{Assumption as Known, Pool, SymbolId};

use super::latex::{latex, latex_velocity};
use super::{Coordinate, DerivedSymbols, Name, Parameter};
use crate::diagnostics::Location;

/// Meaning of a name. The name of a family stands for all its members, which are consecutive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Meaning {
    /// `const N = 8;`
    Constant(i64),
    /// The index of a coordinate.
    Coordinate(usize),
    /// The index of the first coordinate, and how many there are.
    Coordinates(usize, usize),
    /// The index of a parameter.
    Parameter(usize),
    /// The index of the first parameter, and how many there are.
    Parameters(usize, usize),
    /// Introduced by `let`.
    Definition,
}

impl Meaning {
    /// The kind as messages name it.
    pub(super) fn noun(self) -> &'static str {
        match self {
            Self::Constant(_) => "constant",
            Self::Coordinate(_) | Self::Coordinates(..) => "coordinate",
            Self::Parameter(_) | Self::Parameters(..) => "parameter",
            Self::Definition => "definition",
        }
    }
}

/// The symbols of a model and their names.
#[derive(Debug)]
pub(super) struct Symbols {
    /// `t`
    pub(super) time: SymbolId,
    /// `d(t)`
    pub(super) time_differential: SymbolId,
    /// Coordinates, families expanded.
    pub(super) coordinates: Vec<Coordinate>,
    /// `d(x)` of every coordinate.
    pub(super) differentials: Vec<SymbolId>,
    /// Parameters, families expanded.
    pub(super) parameters: Vec<Parameter>,
    /// Quantities that are derived later.
    pub(super) derived: DerivedSymbols,
    /// Meaning and place of each declared name.
    pub(super) names: BTreeMap<String, (Meaning, Location)>,
}

impl Symbols {
    /// The symbols of a model without declarations: time and energy.
    pub(super) fn new(pool: &mut Pool) -> Self {
        let derived = DerivedSymbols {
            energy: pool.symbol("energy", "E", Known::None),
            momenta: Vec::new(),
            multipliers: Vec::new(),
        };
        Self {
            time: pool.symbol("t", "t", Known::None),
            time_differential: pool.symbol("d(t)", r"\mathrm{d}t", Known::None),
            coordinates: Vec::new(),
            differentials: Vec::new(),
            parameters: Vec::new(),
            derived,
            names: BTreeMap::new(),
        }
    }

    /// The velocities of all coordinates.
    pub(super) fn velocities(&self) -> Vec<SymbolId> {
        self.coordinates
            .iter()
            .map(|coordinate| coordinate.qdot)
            .collect()
    }

    /// The positions of all coordinates.
    pub(super) fn positions(&self) -> Vec<SymbolId> {
        self.coordinates
            .iter()
            .map(|coordinate| coordinate.q)
            .collect()
    }

    /// The differentials of all coordinates, then that of time.
    pub(super) fn all_differentials(&self) -> Vec<SymbolId> {
        let mut differentials = self.differentials.clone();
        differentials.push(self.time_differential);
        differentials
    }

    /// Symbols that change in time, differentials included; the others are parameters.
    pub(super) fn moving(&self) -> Vec<SymbolId> {
        let mut moving = self.positions();
        moving.extend(self.velocities());
        moving.extend(self.all_differentials());
        moving.extend(self.derived.momenta.iter().chain(&self.derived.multipliers));
        moving.extend([self.time, self.derived.energy]);
        moving.extend(self.inputs());
        moving
    }

    /// Symbols that the caller supplies.
    pub(super) fn inputs(&self) -> Vec<SymbolId> {
        let inputs = self
            .parameters
            .iter()
            .filter(|parameter| parameter.is_input);
        inputs.map(|input| input.symbol).collect()
    }

    /// Index of the coordinate with this symbol.
    pub(super) fn coordinate_of(&self, symbol: SymbolId) -> Option<usize> {
        self.coordinates
            .iter()
            .position(|coordinate| coordinate.q == symbol)
    }
}

/// New symbols for a coordinate: its position, velocity, differential and momentum.
pub(super) fn coordinate_symbols(pool: &mut Pool, name: &Name, known: Known) -> [SymbolId; 4] {
    let letter = latex(name);
    [
        pool.symbol(&name.display, &letter, known),
        pool.symbol(
            &format!("dot({})", name.display),
            &latex_velocity(name),
            Known::None,
        ),
        pool.symbol(
            &format!("d({})", name.display),
            &format!(r"\mathrm{{d}}{letter}"),
            Known::None,
        ),
        pool.symbol(
            &format!("momentum({})", name.display),
            &format!("p_{{{letter}}}"),
            Known::None,
        ),
    ]
}

/// A name, alone or as a member of a family.
pub(super) fn member_name(field: &str, member: Option<usize>) -> Name {
    let display = match member {
        Some(member) => format!("{field}.{member}"),
        None => field.to_owned(),
    };
    Name {
        display,
        field: field.to_owned(),
        member,
    }
}
