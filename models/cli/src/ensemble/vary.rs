//! Varied quantities of members, by name, and their values.

use dalembert::describe::Description;

use super::random;
use crate::error::CliError;
use crate::{names, scalar};

/// A quantity that may be varied between members, by index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// A coordinate at the start.
    Position(usize),
    /// A velocity at the start.
    Velocity(usize),
    /// A parameter.
    Parameter(usize),
}

impl Quantity {
    /// All quantities of a model with their names: coordinates, velocities, parameters.
    pub fn all(description: &Description) -> Vec<(String, Self)> {
        let coordinates = names::coordinates(description).enumerate();
        let positions = coordinates
            .clone()
            .map(|(index, name)| (name.to_owned(), Self::Position(index)));
        let velocities =
            coordinates.map(|(index, name)| (names::velocity(name), Self::Velocity(index)));
        let parameters = description.parameters.iter().enumerate();
        let parameters = parameters.map(|(index, it)| (it.name.to_owned(), Self::Parameter(index)));
        positions.chain(velocities).chain(parameters).collect()
    }

    /// The quantity of this name.
    ///
    /// # Errors
    /// [`CliError::Unknown`] if no quantity has this name.
    pub fn find(place: &str, name: &str, description: &Description) -> Result<Self, CliError> {
        let all = Self::all(description);
        let accepted = all.iter().map(|(name, _)| name.as_str());
        let index = names::find(place, "coordinate, velocity or parameter", name, accepted)?;
        Ok(all[index].1)
    }
}

/// The values of one quantity over the members.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Equally spaced, both ends included.
    Spaced {
        /// The first and the last value.
        ends: [f64; 2],
        /// Number of values.
        count: u64,
    },
    /// Listed values.
    List(Vec<f64>),
    /// Drawn uniformly between these ends.
    Uniform([f64; 2]),
    /// Drawn from a normal distribution.
    Normal {
        /// Its mean.
        mean: f64,
        /// Its standard deviation.
        deviation: f64,
    },
}

impl Values {
    /// Number of values; 1 if every member draws its value.
    pub fn count(&self) -> u64 {
        match self {
            Self::Spaced { count, .. } => *count,
            Self::List(values) => values.len() as u64,
            Self::Uniform(_) | Self::Normal { .. } => 1,
        }
    }

    /// Both ends and the number of equally spaced values.
    pub fn spaced(&self) -> Option<([f64; 2], u64)> {
        match *self {
            Self::Spaced { ends, count } => Some((ends, count)),
            _ => None,
        }
    }

    /// The value of this index, below [`count`](Self::count); for drawn values, the value of the member.
    pub fn value(&self, index: u64, draw: Draw) -> f64 {
        let Draw {
            seed,
            member,
            quantity,
        } = draw;
        match *self {
            Self::Spaced { ends, count } => spaced(ends, index, count),
            Self::List(ref values) => values[index as usize],
            Self::Uniform([low, high]) => {
                let part = random::uniform(seed, member, quantity);
                low * (1.0 - part) + high * part
            }
            Self::Normal { mean, deviation } => {
                mean + deviation * random::normal(seed, member, quantity)
            }
        }
    }
}

/// Key of a random number.
#[derive(Debug, Clone, Copy)]
pub struct Draw {
    /// The seed of the ensemble.
    pub seed: u64,
    /// The member.
    pub member: u64,
    /// Index of the varied quantity.
    pub quantity: u32,
}

fn spaced([first, last]: [f64; 2], index: u64, count: u64) -> f64 {
    match count.saturating_sub(1) {
        0 => first,
        // The last value is exact, and a constant stays constant.
        gaps if index == gaps => last,
        gaps => first + (last - first) * (index as f64 / gaps as f64),
    }
}

/// Number of members and their kind, as given by the flags.
#[derive(Debug, Clone, Copy)]
pub struct Asked {
    /// Number of members, if given.
    pub members: Option<u64>,
    /// True if the values are drawn.
    pub random: bool,
}

const EXPECTED: &str =
    "NAME=A..B, NAME=A..B:COUNT or NAME=V,V,.. (with --random NAME=A..B or NAME=C+-S)";

/// A quantity with its name and its values.
pub type Varied = (String, Quantity, Values);

/// Parses one `--vary`.
///
/// # Errors
/// A name that the model does not have, or invalid values.
pub fn parse(text: &str, description: &Description, asked: Asked) -> Result<Varied, CliError> {
    let (name, values) = names::assignment("--vary", text, EXPECTED)?;
    let quantity = Quantity::find("--vary", name, description)?;
    let values = parse_values(name, values, asked)?;
    Ok((name.to_owned(), quantity, values))
}

fn parse_values(name: &str, text: &str, asked: Asked) -> Result<Values, CliError> {
    let place = format!("--vary {name}");
    let refuse = |expected: &str| CliError::value(&place, text, expected);
    let number = |text: &str| {
        scalar::parse(text).map_err(|expected| CliError::value(&place, text, expected))
    };
    if let Some((mean, deviation)) = text.split_once("+-") {
        if !asked.random {
            return Err(refuse("A..B, or --random SEED for values that scatter"));
        }
        let (mean, deviation) = (number(mean)?, number(deviation)?);
        return match deviation >= 0.0 {
            true => Ok(Values::Normal { mean, deviation }),
            false => Err(refuse("a standard deviation that is not negative")),
        };
    }
    let Some((first, rest)) = text.split_once("..") else {
        if asked.random {
            return Err(refuse("A..B or C+-S, as members are drawn at random"));
        }
        let list: Result<Vec<f64>, CliError> = text.split(',').map(number).collect();
        return Ok(Values::List(list?));
    };
    let (last, count) = match rest.split_once(':') {
        Some((last, count)) => (last, Some(count)),
        None => (rest, None),
    };
    let ends = [number(first)?, number(last)?];
    match (count, asked) {
        (None, Asked { random: true, .. }) => Ok(Values::Uniform(ends)),
        (Some(_), Asked { random: true, .. }) => Err(refuse(
            "A..B without a count: with --random it is --members",
        )),
        (Some(count), _) => match count.trim().parse() {
            Ok(count) if count > 0 => Ok(Values::Spaced { ends, count }),
            _ => Err(refuse("A..B:COUNT with a positive whole number")),
        },
        (
            None,
            Asked {
                members: Some(count),
                ..
            },
        ) => Ok(Values::Spaced { ends, count }),
        (None, _) => Err(refuse("A..B:COUNT, or --members N")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOBODY: Draw = Draw {
        seed: 0,
        member: 0,
        quantity: 0,
    };

    #[test]
    fn spaced_values_meet_both_ends() {
        let values = Values::Spaced {
            ends: [9.995, 10.005],
            count: 10_000,
        };
        assert_eq!(values.value(0, NOBODY), 9.995);
        assert_eq!(values.value(9999, NOBODY), 10.005);
        let middle = values.value(5000, NOBODY);
        assert!((middle - (9.995 + 0.01 * 5000.0 / 9999.0)).abs() < 1e-14);
        let one = Values::Spaced {
            ends: [2.0, 3.0],
            count: 1,
        };
        assert_eq!(one.value(0, NOBODY), 2.0);
    }

    #[test]
    fn values_as_they_are_written() {
        let grid = Asked {
            members: Some(7),
            random: false,
        };
        let drawn = Asked {
            members: Some(7),
            random: true,
        };
        let spaced = |count| Values::Spaced {
            ends: [-0.5, 2.0],
            count,
        };
        let cases = [
            ("-0.5..2", grid, Some(spaced(7))),
            ("-0.5..2:3", grid, Some(spaced(3))),
            ("1,-2e3", grid, Some(Values::List(vec![1.0, -2e3]))),
            ("-0.5..2", drawn, Some(Values::Uniform([-0.5, 2.0]))),
            (
                "0.1+-0.01",
                drawn,
                Some(Values::Normal {
                    mean: 0.1,
                    deviation: 0.01,
                }),
            ),
            ("0.1+-0.01", grid, None),
            ("0.1+--0.01", drawn, None),
            ("1,2", drawn, None),
            ("0..1:3", drawn, None),
            ("0..1:0", grid, None),
            ("0..", grid, None),
            ("", grid, None),
        ];
        for (text, asked, expected) in cases {
            assert_eq!(parse_values("x", text, asked).ok(), expected, "{text}");
        }
    }
}
