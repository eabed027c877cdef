//! Real points with short coordinates, which can be checked by hand.

use dalembert_expr::{
    Assumption as Known, Domain, ExprId, Function, Interval, Node, Pool, RealPoint, SymbolId,
};

use super::dynamics::Dynamics;
use crate::model::{Assumption, Model, Topology};

/// A real point, with values of parameters and coordinates that are short to type.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sample {
    /// Names and values. Coordinates come first.
    pub values: Vec<(String, f64)>,
    symbols: Vec<SymbolId>,
}

impl Sample {
    /// The point at which expressions are expanded.
    pub(super) fn point(&self) -> RealPoint {
        let mut point = RealPoint::default();
        for (symbol, (_, value)) in self.symbols.iter().zip(&self.values) {
            point.set(*symbol, *value);
        }
        point
    }

    /// Pairs of symbol and value.
    pub(super) fn point_values(&self) -> Vec<(SymbolId, f64)> {
        let values = self.values.iter().map(|(_, value)| *value);
        self.symbols.iter().copied().zip(values).collect()
    }

    /// Intervals of one unit in the last place around the values. They contain the printed values and the exact
    /// defaults.
    pub(super) fn ranges(&self) -> Domain {
        let near = |value: f64| Interval::new(value.next_down(), value.next_up());
        let values = self.point_values().into_iter();
        values
            .map(|(symbol, value)| (symbol, near(value)))
            .collect()
    }

    /// The value of a symbol.
    pub(super) fn value(&self, symbol: SymbolId) -> Option<f64> {
        let position = self.symbols.iter().position(|known| *known == symbol)?;
        Some(self.values[position].1)
    }

    /// Sets the value of a symbol of the sample; no effect for other symbols.
    pub(super) fn set(&mut self, symbol: SymbolId, value: f64) {
        if let Some(position) = self.symbols.iter().position(|known| *known == symbol) {
            self.values[position].1 = value;
        }
    }

    /// True if all coordinates lie in their declared sets, up to rounding, because a surface may lie at an end of an
    /// interval.
    pub(super) fn is_allowed(&self, model: &Model) -> bool {
        let is_above = |value: f64, end: f64| value >= end - ROUNDING * (1.0 + end.abs());
        model.coordinates.iter().all(|coordinate| {
            let Some(value) = self.value(coordinate.q) else {
                return true;
            };
            let is_inside = match coordinate.topology {
                Topology::Interval { low, high } => {
                    let ends = model.pool.eval(&[low, high], &|_| 0.0);
                    is_above(value, ends[0]) && is_above(-value, -ends[1])
                }
                _ => true,
            };
            let is_signed = match model.pool.symbol_assumption(coordinate.q) {
                Known::Positive | Known::NonNegative => is_above(value, 0.0),
                _ => true,
            };
            is_inside && is_signed
        })
    }

    /// Adds a symbol with its name and value.
    pub(super) fn push(&mut self, name: String, symbol: SymbolId, value: f64) {
        self.values.push((name, value));
        self.symbols.push(symbol);
    }

    /// Text such as `x = 0.36, y = -0.53, m = 2`.
    pub fn text(&self) -> String {
        let entries: Vec<String> = self
            .values
            .iter()
            .map(|(name, value)| match value.abs() {
                tiny if tiny > 0.0 && tiny < 1e-9 => format!("{name} = {value:e}"),
                _ => format!("{name} = {value}"),
            })
            .collect();
        entries.join(", ")
    }
}

/// Hundredths of values in `(-1, 1)` that are not near 0, in an irregular order.
const HUNDREDTHS: [i32; 16] = [
    36, -53, 39, 81, -28, 67, -74, 45, 92, -17, 58, -86, 23, 71, -42, 64,
];

/// Allowed relative error of a root computed in doubles.
const ROUNDING: f64 = 1e-12;

/// Number of attempts in which parameters have their declared defaults. A default of 0 is used in the first attempt
/// only.
const DECLARED: usize = 8;
/// Number of attempts with coordinates between -1 and 1. Later attempts multiply coordinates on lines by one of the
/// scales, because roots and logarithms may be defined only far from 0.
const NEAR: usize = 16;
const SCALES: [f64; 4] = [1.0, 8.0, 64.0, 1.0 / 8.0];
/// Number of samples without a real state after which the search ends.
pub(super) const ATTEMPTS: usize = 64;

/// Sample number `attempt` for the symbols that `uses` accepts, time included. In the first [`DECLARED`] samples,
/// parameters have their declared defaults.
pub(super) fn sample(model: &Model, attempt: usize, uses: impl Fn(SymbolId) -> bool) -> Sample {
    let mut sample = Sample::default();
    let mut drawn = attempt * 5;
    let mut next = || {
        drawn += 1;
        f64::from(HUNDREDTHS[(drawn - 1) % HUNDREDTHS.len()]) / 100.0
    };
    for coordinate in &model.coordinates {
        let unit = next();
        let value = match coordinate.topology {
            Topology::Interval { low, high } => {
                let ends = model.pool.eval(&[low, high], &|_| 0.0);
                between(ends[0], ends[1], unit)
            }
            _ => match model.pool.symbol_assumption(coordinate.q) {
                Known::Positive | Known::NonNegative => unit.abs(),
                _ if attempt < NEAR || coordinate.topology == Topology::Angle => unit,
                _ => round(SCALES[attempt % SCALES.len()] * unit),
            },
        };
        if uses(coordinate.q) {
            sample.push(coordinate.name.display.clone(), coordinate.q, value);
        }
    }
    if uses(model.time) {
        sample.push("t".to_owned(), model.time, next().abs());
    }
    for parameter in &model.parameters {
        let unit = next();
        let default = parameter
            .default
            .map(|default| model.pool.eval(&[default], &|_| 0.0)[0]);
        // A default may hide the effect of a parameter, and the default 0 always does.
        let value = match (&parameter.assumption, default) {
            (_, Some(default)) if attempt == 0 || (default != 0.0 && attempt < DECLARED) => default,
            (Assumption::Positive | Assumption::NonNegative, _) => round(1.0 + unit.abs()),
            (Assumption::Within { low, high }, _) => {
                let (low, high) = (low.to_f64(), high.to_f64());
                between(low, high, unit)
            }
            (Assumption::Finite | Assumption::NonZero, _) => unit,
        };
        if uses(parameter.symbol) {
            sample.push(parameter.name.display.clone(), parameter.symbol, value);
        }
    }
    sample
}

/// Moves coordinates between the zeros of arguments of absolute values, to another interval in each attempt. The first
/// attempts are left unchanged.
pub(super) fn move_between_knots(
    model: &Model,
    roots: &[ExprId],
    attempt: usize,
    sample: &mut Sample,
) {
    let parts = model.pool.reachable(roots);
    let arguments: Vec<ExprId> = parts
        .iter()
        .filter_map(|id| match model.pool.node(*id) {
            Node::Call(Function::Abs, argument) => Some(*argument),
            _ => None,
        })
        .collect();
    if arguments.is_empty() || attempt < DECLARED {
        return;
    }
    for (i, coordinate) in model.coordinates.iter().enumerate() {
        let knots = knots(model, &arguments, coordinate.q, sample);
        let (Some(first), Some(last)) = (knots.first(), knots.last()) else {
            continue;
        };
        let middles = knots.windows(2).map(|pair| f64::midpoint(pair[0], pair[1]));
        let mut places: Vec<f64> = middles.collect();
        places.extend([first - 0.5, last + 0.5]);
        // The stride differs between coordinates and shifts with the attempts, so that places are combined in many ways.
        let place = places[(attempt * (2 * i + 1) + attempt / (7 + i)) % places.len()];
        sample.set(coordinate.q, place);
    }
}

/// The sorted values of a coordinate at which arguments that are linear in it vanish.
fn knots(model: &Model, arguments: &[ExprId], symbol: SymbolId, sample: &Sample) -> Vec<f64> {
    let at = |argument: ExprId, place: f64| {
        let value = |asked| match asked == symbol {
            true => place,
            false => sample.value(asked).unwrap_or(0.0),
        };
        model.pool.eval(&[argument], &value)[0]
    };
    let mut knots: Vec<f64> = arguments
        .iter()
        .filter(|argument| model.pool.depends_on(**argument, symbol))
        .filter_map(|argument| {
            let [start, middle, end] = [0.0, 1.0, 2.0].map(|place| at(*argument, place));
            let slope = middle - start;
            let is_linear = (end - middle - slope).abs() <= 1e-9 * (start.abs() + slope.abs());
            (is_linear && slope != 0.0).then(|| -start / slope)
        })
        .filter(|knot| knot.is_finite())
        .collect();
    knots.sort_by(f64::total_cmp);
    knots.dedup();
    knots
}

/// A number inside an interval. It is rounded to hundredths if the result lies in the interval.
fn between(low: f64, high: f64, unit: f64) -> f64 {
    let value = low + (high - low) * (0.5 + 0.4 * unit);
    let short = round(value);
    match low < short && short < high {
        true => short,
        false => value,
    }
}

/// Rounds to hundredths, unless this leaves too few digits.
fn round(value: f64) -> f64 {
    if value.abs() > 0.1 && value.abs() < 1e6 {
        (value * 100.0).round() / 100.0
    } else {
        value
    }
}

/// True if any expression below `roots` contains a symbol.
pub(super) fn uses<'a>(pool: &'a Pool, roots: &'a [ExprId]) -> impl Fn(SymbolId) -> bool + 'a {
    move |symbol| roots.iter().any(|root| pool.depends_on(*root, symbol))
}

/// Independent velocities of the states.
const VELOCITIES: [f64; 7] = [0.5, -0.75, 1.25, 0.25, -1.5, 1.75, -0.25];

/// A real state on D with short independent velocities. Its printed values include all velocities.
pub(super) fn state_on_d(
    model: &Model,
    dynamics: &Dynamics,
    roots: &[ExprId],
    attempt: usize,
) -> Option<(Sample, RealPoint)> {
    let mut roots = roots.to_vec();
    roots.extend(dynamics.positions().roots());
    let mut sample = sample(model, attempt, uses(&model.pool, &roots));
    move_between_knots(model, &roots, attempt, &mut sample);
    dynamics.positions().settle_sample(model, &mut sample)?;
    with_velocities(model, dynamics, sample, attempt)
}

/// The sample extended by velocities on D, and its point.
pub(super) fn with_velocities(
    model: &Model,
    dynamics: &Dynamics,
    mut sample: Sample,
    attempt: usize,
) -> Option<(Sample, RealPoint)> {
    let mut point = sample.point();
    // The stride changes with the attempt, so that all pairs of signs occur.
    let step = 1 + attempt / VELOCITIES.len() % (VELOCITIES.len() - 1);
    for (i, coordinate) in model.coordinates.iter().enumerate() {
        let velocity = VELOCITIES[(i * step + attempt) % VELOCITIES.len()];
        point.set(coordinate.qdot, velocity);
    }
    let motion = dynamics.motion(&model.pool, &mut point, None)?;
    for (coordinate, value) in model.coordinates.iter().zip(&motion.qdot) {
        let name = format!("dot({})", coordinate.name.display);
        sample.push(name, coordinate.qdot, *value);
    }
    Some((sample, point))
}
