//! Parser of `--density X[=A..B],Y[=A..B][:BINS[xBINS]]`.

use dalembert::describe::Description;
use dalembert_driver::ensemble::density::{Axis, MOST_BINS};

use crate::error::CliError;
use crate::scalar;

/// Default number of cells along an axis.
const BINS: usize = 100;

const EXPECTED: &str = "two names, such as x,y or x=-1..1,theta:200 or x,y:200x50";

/// Parses the flag to the two axes. A range that is not given is NaN.
///
/// # Errors
/// A name that the model does not have, an invalid range, or an invalid number.
pub fn parse(text: &str, description: &Description) -> Result<[Axis; 2], CliError> {
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
        false => Ok(axes),
    }
}

fn parse_bins(text: &str) -> Result<[usize; 2], CliError> {
    let (x, y) = text.split_once('x').unwrap_or((text, text));
    let number = |text: &str| {
        let number = text.trim().parse().ok();
        number
            .filter(|bins| (1..=MOST_BINS).contains(bins))
            .ok_or_else(|| {
                CliError::value(
                    "--density",
                    text,
                    format!("a number of cells from 1 to {MOST_BINS}"),
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
    Axis::named(name, range, bins, description).map_err(|unknown| CliError::Unknown {
        place: "--density".to_owned(),
        unknown,
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
