//! Quantities of axes: time, components of a state, energies and outputs, with their names in tables.

use dalembert::describe::Description;
use dalembert_driver::Point;

use crate::error::CliError;
use crate::{names, symbols};

/// A quantity of an axis: one number at each point of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// `t`
    Time,
    /// `x`, by index.
    Position(usize),
    /// `x_dot`
    Velocity(usize),
    /// `p_x`
    Momentum(usize),
    /// `energy`
    Energy,
    /// `energy_error`: the change of the energy since the start, relative to its initial value; the absolute change if
    /// that value is 0.
    EnergyError,
    /// A declared output.
    Output(usize),
}

/// Groups of quantities; each name stands for all of its kind.
const GROUPS: [&str; 4] = ["q", "qdot", "p", "outputs"];

impl Quantity {
    /// The value of the quantity at a point; NaN if the point lacks it. `start` is the energy at the start of the run.
    pub fn value(self, t: f64, point: &Point, start: f64) -> f64 {
        let component = |values: &[f64], index: usize| values.get(index).copied();
        let value = match self {
            Self::Time => Some(t),
            Self::Position(index) => component(&point.q, index),
            Self::Velocity(index) => component(&point.qdot, index),
            Self::Momentum(index) => component(&point.p, index),
            Self::Energy => Some(point.energy),
            Self::EnergyError if start == 0.0 => Some(point.energy),
            Self::EnergyError => Some((point.energy - start) / start.abs()),
            Self::Output(index) => component(&point.outputs, index),
        };
        value.unwrap_or(f64::NAN)
    }

    /// Its name.
    pub fn name(self, description: &Description) -> String {
        let coordinate = |index: usize| description.coordinates[index].name;
        match self {
            Self::Time => "t".to_owned(),
            Self::Position(index) => coordinate(index).to_owned(),
            Self::Velocity(index) => names::velocity(coordinate(index)),
            Self::Momentum(index) => names::momentum(coordinate(index)),
            Self::Energy => "energy".to_owned(),
            Self::EnergyError => "energy_error".to_owned(),
            Self::Output(index) => description.outputs[index].to_owned(),
        }
    }

    /// Its label in pictures.
    pub fn label(self, description: &Description) -> String {
        match self {
            Self::EnergyError => "relative change of the energy".to_owned(),
            Self::Output(index) => description.outputs[index].replace('_', " "),
            _ => symbols::text(&self.name(description)),
        }
    }

    /// True if it is smooth along a motion. A conserved energy is not smooth: its changes are rounding errors.
    pub const fn is_smooth(self) -> bool {
        !matches!(self, Self::Energy | Self::EnergyError)
    }
}

/// Parses the quantities of `--axes`: the abscissa and one or more ordinates, where `q`, `qdot`, `p` and `outputs`
/// stand for all of their kind.
///
/// # Errors
/// An unknown name, or fewer than two quantities.
pub fn parse(flag: &str, text: &str, description: &Description) -> Result<Vec<Quantity>, CliError> {
    let everything = everything(description);
    let mut accepted: Vec<String> = everything
        .iter()
        .map(|quantity| quantity.name(description))
        .collect();
    accepted.extend(GROUPS.map(str::to_owned));
    let mut quantities = Vec::new();
    for name in text.split(',').map(str::trim) {
        let index = names::find(flag, "quantity", name, accepted.iter().map(String::as_str))?;
        match everything.get(index) {
            Some(&quantity) => quantities.push(quantity),
            None if quantities.is_empty() => {
                return Err(CliError::value(flag, name, "one quantity as the abscissa"));
            }
            None => quantities.extend(group(GROUPS[index - everything.len()], &everything)),
        }
    }
    match quantities.len() {
        0 | 1 => Err(CliError::value(
            flag,
            text,
            "an abscissa and at least one ordinate, such as t,energy",
        )),
        _ => Ok(quantities),
    }
}

/// Checks the quantities of `--axes`, if they are given.
///
/// # Errors
/// The errors of [`parse`].
pub fn check(flag: &str, text: Option<&str>, description: &Description) -> Result<(), CliError> {
    text.map_or(Ok(()), |text| parse(flag, text, description).map(drop))
}

/// Parses one quantity of a single state; `None` for a name among `others`, which the flag accepts as well.
///
/// # Errors
/// An unknown name.
pub fn parse_one(
    flag: &str,
    name: &str,
    others: &[&str],
    description: &Description,
) -> Result<Option<Quantity>, CliError> {
    let quantities = of_state(description);
    let names = quantities.iter().map(|quantity| quantity.name(description));
    let accepted: Vec<String> = names
        .chain(others.iter().map(|&name| name.to_owned()))
        .collect();
    let accepted = accepted.iter().map(String::as_str);
    let index = names::find(flag, "quantity", name.trim(), accepted)?;
    Ok(quantities.get(index).copied())
}

/// The quantities of a single state: all except the time and the change of the energy.
pub fn of_state(description: &Description) -> Vec<Quantity> {
    let of_runs = [Quantity::Time, Quantity::EnergyError];
    let mut quantities = everything(description);
    quantities.retain(|quantity| !of_runs.contains(quantity));
    quantities
}

/// All quantities of a model. Of two quantities with the same name the first is used.
fn everything(description: &Description) -> Vec<Quantity> {
    let n = description.coordinates.len();
    let outputs = description.outputs.len();
    let mut everything = vec![Quantity::Time];
    everything.extend((0..n).map(Quantity::Position));
    everything.extend((0..n).map(Quantity::Velocity));
    if !description.is_first_order {
        everything.extend((0..n).map(Quantity::Momentum));
        everything.extend([Quantity::Energy, Quantity::EnergyError]);
    }
    everything.extend((0..outputs).map(Quantity::Output));
    everything
}

fn group(name: &str, everything: &[Quantity]) -> Vec<Quantity> {
    let belongs = |quantity: &&Quantity| match quantity {
        Quantity::Position(_) => name == "q",
        Quantity::Velocity(_) => name == "qdot",
        Quantity::Momentum(_) => name == "p",
        Quantity::Output(_) => name == "outputs",
        Quantity::Time | Quantity::Energy | Quantity::EnergyError => false,
    };
    everything.iter().filter(belongs).copied().collect()
}
