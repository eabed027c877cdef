//! Quantities that may differ between members, and their values.

use dalembert::describe::Description;

use super::random;
use crate::beginning::Component;
use crate::model::AnyModel;
use crate::names::{self, Unknown};

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

    /// The quantity of this name, with its name in tables: `x_dot` for `dot(x)`.
    ///
    /// # Errors
    /// [`Unknown`] if no quantity has this name.
    pub fn find(name: &str, description: &Description) -> Result<(String, Self), Unknown> {
        let mut all = Self::all(description);
        let accepted = all.iter().map(|(name, _)| name.as_str());
        let index = names::find("coordinate, velocity or parameter", name, accepted)?;
        Ok(all.swap_remove(index))
    }

    /// Checks that the mode in which a model starts has this quantity, whose name is given.
    ///
    /// # Errors
    /// [`Unknown`] for a coordinate or velocity that the mode lacks.
    pub fn check_present(self, model: &dyn AnyModel, name: &str) -> Result<(), Unknown> {
        match self {
            Self::Parameter(_) => Ok(()),
            Self::Position(_) | Self::Velocity(_) if model.present_mode().is_none() => Ok(()),
            Self::Position(_) | Self::Velocity(_) => Component::find(model, name).map(drop),
        }
    }
}

/// The values of one quantity over the members.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Equally spaced values, both ends included.
    Spaced {
        /// The first and the last value.
        ends: [f64; 2],
        /// Number of values.
        count: u64,
    },
    /// Listed values.
    List(Vec<f64>),
    /// Random values, uniformly distributed between these ends.
    Uniform([f64; 2]),
    /// Random values from a normal distribution.
    Normal {
        /// Its mean.
        mean: f64,
        /// Its standard deviation.
        deviation: f64,
    },
}

impl Values {
    /// Number of values; 1 for random values.
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

    /// The value at an index below [`count`](Self::count). For random values, the value of the member.
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
    let gaps = count.saturating_sub(1);
    // The last value is exact, and equal ends give equal values.
    match index {
        _ if gaps == 0 => first,
        _ if index == gaps => last,
        _ => {
            let (part, length) = (index as f64 / gaps as f64, last - first);
            match length.is_finite() {
                true => first + length * part,
                false => first * (1.0 - part) + last * part,
            }
        }
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
        let wide = Values::Spaced {
            ends: [-1e308, 1e308],
            count: 5,
        };
        let values: Vec<f64> = (0..5).map(|index| wide.value(index, NOBODY)).collect();
        assert_eq!(values, [-1e308, -5e307, 0.0, 5e307, 1e308]);
    }
}
