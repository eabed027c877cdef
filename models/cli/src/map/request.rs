//! The request that a map makes of every run.

use dalembert::describe::{Description, Topology};
use dalembert_driver::{Component, Point, Search};

use crate::args::MapArgs;
use crate::error::CliError;
use crate::expression::Expression;
use crate::names;

/// Request that a map makes of every run.
pub struct Request {
    /// The requested returns, if any.
    pub returns: Option<Returns>,
    /// The components of the start that are set to expressions.
    pub starts: Vec<(Component, Watched)>,
    /// The expression that ends a run.
    pub fail: Option<Watched>,
    /// Meaning of the colours.
    pub colours: Colours,
    /// The expressions of `--output`, with their names.
    pub outputs: Vec<(String, Watched)>,
    /// The expressions of `--contour`, which are drawn as lines over the map.
    pub contours: Vec<Watched>,
    /// The columns along x and y, if the picture shows a dot for each cell.
    pub plane: Option<[String; 2]>,
    /// The components of a state.
    pub components: Components,
    /// True if a parameter is varied: every cell then has orbits of its own.
    pub is_bifurcating: bool,
}

impl Request {
    /// True if Lyapunov exponents are requested.
    pub fn has_exponent(&self) -> bool {
        let returns = self.returns.as_ref();
        returns.is_some_and(|returns| returns.exponent.is_some())
    }
}

/// Returns to a surface.
pub struct Returns {
    /// Their number.
    pub count: u64,
    /// The index of the surface.
    pub surface: usize,
    /// The longest period that is searched for, in returns.
    pub period: usize,
    /// The request of a Lyapunov exponent.
    pub exponent: Option<Search>,
}

/// An expression of a flag, which became an output of the model.
pub struct Watched {
    /// The expression.
    pub expression: Expression,
    /// The index of the output.
    pub output: usize,
}

impl Watched {
    /// Its value at a point.
    pub fn value(&self, point: &Point) -> f64 {
        point.outputs.get(self.output).copied().unwrap_or(f64::NAN)
    }

    /// True if it holds at a point.
    pub fn holds(&self, point: &Point) -> bool {
        self.expression.holds(self.value(point))
    }
}

/// Meaning of the colours of a map.
pub enum Colours {
    /// The class of the end.
    End,
    /// The number of returns.
    Returns,
    /// The Lyapunov exponent.
    Exponent,
    /// An expression at the end.
    Value(Watched),
}

impl Colours {
    /// The value at a point of the expression that the colours show; NaN if they show none.
    pub fn value(&self, point: &Point) -> f64 {
        match self {
            Self::Value(watched) => watched.value(point),
            Self::End | Self::Returns | Self::Exponent => f64::NAN,
        }
    }
}

/// The components of a state that rows hold: coordinates, and velocities unless the system is of first order.
pub struct Components {
    /// Their names.
    pub names: Vec<String>,
    /// The comparison of each component, in the same order.
    kinds: Vec<Kind>,
    /// Number of coordinates.
    coordinates: usize,
    /// Difference below which two states are the same, relative to values above 1.
    near: f64,
}

/// Comparison of a component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Number,
    Angle,
    Ignored,
}

impl Components {
    /// The components of a model. Comparisons ignore the components of `--ignore`.
    ///
    /// # Errors
    /// A name in `--ignore` that the model does not have.
    pub fn of(description: &Description, args: &MapArgs) -> Result<Self, CliError> {
        let coordinates = names::coordinates(description);
        let mut all: Vec<String> = coordinates.clone().map(str::to_owned).collect();
        let turns = description.coordinates.iter();
        let mut kinds: Vec<Kind> = turns
            .map(|coordinate| match coordinate.topology {
                Topology::Circle => Kind::Angle,
                _ => Kind::Number,
            })
            .collect();
        if !description.is_first_order {
            all.extend(coordinates.map(names::velocity));
            kinds.resize(all.len(), Kind::Number);
        }
        for name in &args.ignore {
            let accepted = all.iter().map(String::as_str);
            let index = names::find("--ignore", "coordinate or velocity", name.trim(), accepted)?;
            kinds[index] = Kind::Ignored;
        }
        Ok(Self {
            names: all,
            kinds,
            coordinates: description.coordinates.len(),
            near: args.nearness(),
        })
    }

    /// Number of coordinates, which come first.
    pub fn coordinates(&self) -> usize {
        self.coordinates
    }

    /// The components of a point.
    pub fn values(&self, point: &Point) -> Vec<f64> {
        let velocities = self.names.len() - self.coordinates;
        let rates = point.qdot.iter().take(velocities);
        point.q.iter().chain(rates).copied().collect()
    }

    /// True if two numbers differ by more than the tolerance; false if one is NaN.
    pub fn differ(&self, first: f64, second: f64) -> bool {
        let scale = f64::max(1.0, f64::max(first.abs(), second.abs()));
        (first - second).abs() > self.near * scale
    }

    /// True if no component of two states differs by more than `factor` times the tolerance.
    pub fn are_same(&self, first: &[f64], second: &[f64], factor: f64) -> bool {
        let pairs = first.iter().zip(second).zip(&self.kinds);
        pairs.into_iter().all(|((&first, &second), kind)| {
            let difference = match kind {
                Kind::Ignored => return true,
                Kind::Number => first - second,
                Kind::Angle => {
                    let turn = std::f64::consts::TAU;
                    (first - second) - turn * ((first - second) / turn).round()
                }
            };
            // A component that the mode lacks is NaN in both states.
            let scale = f64::max(1.0, f64::max(first.abs(), second.abs()));
            difference.abs() <= factor * self.near * scale || (first.is_nan() && second.is_nan())
        })
    }
}
