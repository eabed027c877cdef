//! Parser of the varied quantities in flags.

use dalembert::describe::Description;
use dalembert_driver::ensemble::{Quantity, Values};

use crate::error::CliError;
use crate::{names, scalar};

/// The quantity of this name, with its name in tables.
///
/// # Errors
/// [`CliError::Unknown`] if no quantity has this name.
pub fn find(
    place: &str,
    name: &str,
    description: &Description,
) -> Result<(String, Quantity), CliError> {
    Quantity::find(name, description).map_err(|unknown| CliError::Unknown {
        place: place.to_owned(),
        unknown,
    })
}

/// The flags `--members` and `--random`, which hold for all varied quantities.
#[derive(Debug, Clone, Copy)]
pub struct Asked {
    /// Number of members, if given.
    pub members: Option<u64>,
    /// True if the values are drawn at random.
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
    let (name, quantity) = find("--vary", name, description)?;
    let values = parse_values(&name, values, asked)?;
    Ok((name, quantity, values))
}

fn parse_values(name: &str, text: &str, asked: Asked) -> Result<Values, CliError> {
    let place = format!("--vary {name}");
    let refuse = |expected: &str| CliError::value(&place, text, expected);
    let number = |text: &str| {
        scalar::parse(text).map_err(|expected| CliError::value(&place, text, expected))
    };
    if let Some((mean, deviation)) = text.split_once("+-") {
        if !asked.random {
            return Err(refuse("A..B, or --random SEED for a normal distribution"));
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
