//! Parser of `--density X[=A..B],Y[=A..B][:BINS[xBINS]]`.

use std::f64::consts::PI;

use dalembert::describe::{Description, Topology};

use super::{Axis, Shown};
use crate::error::CliError;
use crate::{names, scalar};

/// Default number of cells along an axis.
const BINS: usize = 100;

/// Largest number of cells along an axis.
const MOST: usize = 1000;

const EXPECTED: &str = "two names, such as x,y or x=-1..1,theta:200 or x,y:200x50";

/// A grid whose ranges may still be unknown.
#[derive(Debug, Clone, PartialEq)]
pub struct Wish {
    /// The axes; an unknown range is NaN.
    pub axes: [Axis; 2],
}

impl Wish {
    /// Parses the flag.
    ///
    /// # Errors
    /// A name that the model does not have, an invalid range, or an invalid number.
    pub fn parse(text: &str, description: &Description) -> Result<Self, CliError> {
        let refuse = || CliError::value("--density", text, EXPECTED);
        let (axes, bins) = match text.rsplit_once(':') {
            Some((axes, bins)) => (axes, parse_bins(bins)?),
            None => (text, [BINS; 2]),
        };
        let (x, y) = axes.split_once(',').ok_or_else(refuse)?;
        let axes = [
            parse_axis(x, bins[0], description)?,
            parse_axis(y, bins[1], description)?,
        ];
        match axes[0].shown == axes[1].shown {
            true => Err(refuse()),
            false => Ok(Self { axes }),
        }
    }
}

fn parse_bins(text: &str) -> Result<[usize; 2], CliError> {
    let (x, y) = text.split_once('x').unwrap_or((text, text));
    let number = |text: &str| {
        let number = text.trim().parse().ok();
        number
            .filter(|bins| (1..=MOST).contains(bins))
            .ok_or_else(|| {
                CliError::value(
                    "--density",
                    text,
                    format!("a number of cells from 1 to {MOST}"),
                )
            })
    };
    Ok([number(x)?, number(y)?])
}

fn parse_axis(text: &str, bins: usize, description: &Description) -> Result<Axis, CliError> {
    let (name, range) = match text.split_once('=') {
        Some((name, range)) => (name.trim(), Some(parse_range(range)?)),
        None => (text.trim(), None),
    };
    let all = shown(description);
    let accepted = all.iter().map(|(name, _)| name.as_str());
    let index = names::find(
        "--density",
        "coordinate, velocity or output",
        name,
        accepted,
    )?;
    let shown = all[index].1;
    let topology = match shown {
        Shown::Position(index) => description.coordinates[index].topology,
        _ => Topology::Line,
    };
    let known = match topology {
        Topology::Circle => [-PI, PI],
        Topology::Interval { low, high } if low.is_finite() && high.is_finite() => [low, high],
        _ => [f64::NAN; 2],
    };
    Ok(Axis {
        name: name.to_owned(),
        shown,
        is_circle: topology == Topology::Circle,
        range: range.unwrap_or(known),
        bins,
    })
}

fn parse_range(text: &str) -> Result<[f64; 2], CliError> {
    let refuse = || CliError::value("--density", text, "a range A..B with A below B");
    let (low, high) = text.split_once("..").ok_or_else(refuse)?;
    let number = |text: &str| scalar::parse(text).map_err(|_| refuse());
    let range = [number(low)?, number(high)?];
    match range[0] < range[1] {
        true => Ok(range),
        false => Err(refuse()),
    }
}

/// Quantities of axes, by name. Of two quantities with the same name the first is used.
fn shown(description: &Description) -> Vec<(String, Shown)> {
    let coordinates = names::coordinates(description).enumerate();
    let positions = coordinates
        .clone()
        .map(|(index, name)| (name.to_owned(), Shown::Position(index)));
    let velocities =
        coordinates.map(|(index, name)| (names::velocity(name), Shown::Velocity(index)));
    let outputs = description.outputs.iter().enumerate();
    let outputs = outputs.map(|(index, name)| ((*name).to_owned(), Shown::Output(index)));
    positions
        .chain(velocities)
        .chain(outputs)
        .chain([("energy".to_owned(), Shown::Energy)])
        .collect()
}
