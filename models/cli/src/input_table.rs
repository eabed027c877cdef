//! Inputs from a table: columns `t` and the names of inputs.
//!
//! Two rows at the same time are a jump; the later row holds from that time on. Inputs are constant before the first
//! row and after the last one.

use std::cell::Cell;
use std::ops::Range;
use std::path::Path;

use clap::ValueEnum;
use dalembert_driver::{AnyModel, Changes, Control, Ending, Origin, Settings, Watch};

use crate::error::CliError;
use crate::scalar;

/// Largest number of rows.
const MOST_ROWS: usize = 10_000_000;

/// Number of rows that determine a cubic.
const CUBIC: usize = 4;

/// Interpolation of the inputs between two rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Between {
    /// Cubic through the four nearest rows, two on each side except near the ends; rows beyond a jump are not used.
    Cubic,
    /// Line through the rows before and after.
    Linear,
    /// Values of the row before.
    Held,
}

/// Inputs as functions of time.
#[derive(Debug, Clone)]
pub struct InputTable {
    t: Vec<f64>,
    /// The inputs of each row, in the order of the columns.
    rows: Vec<Vec<f64>>,
    /// The rows that are interpolated before the first time, between two times, and after the last.
    pieces: Vec<Range<usize>>,
    /// The times at which pieces meet, in order.
    ends: Vec<f64>,
    /// The index of the input of each column.
    columns: Vec<usize>,
    /// The values of all inputs; a column replaces the value of its input.
    constant: Vec<f64>,
}

impl InputTable {
    /// Reads a table.
    ///
    /// # Errors
    /// A file that cannot be read, a table without a column `t` or without a column of an input, a field that is not a
    /// number, times that decrease.
    pub fn read(path: &Path, between: Between, model: &dyn AnyModel) -> Result<Self, CliError> {
        let text = std::fs::read(path).map_err(|source| CliError::File {
            flag: "--inputs",
            path: path.to_owned(),
            source,
        })?;
        Self::parse(&text, between, model).map_err(|reason| CliError::Input {
            place: format!("--inputs {}", path.display()),
            reason,
        })
    }

    fn parse(text: &[u8], between: Between, model: &dyn AnyModel) -> Result<Self, String> {
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(text);
        let header = reader.headers().map_err(|error| error.to_string())?.clone();
        let time = header.iter().position(|name| name == "t");
        let time = time.ok_or("there is no column `t`")?;
        if header.iter().skip(time + 1).any(|name| name == "t") {
            return Err("two columns are called `t`".to_owned());
        }
        let inputs = model.inputs();
        let mut columns = Vec::new();
        for (place, name) in header.iter().enumerate() {
            let Some(input) = inputs.iter().position(|input| *input == name) else {
                continue;
            };
            if columns.iter().any(|&(_, known)| known == input) {
                return Err(format!("two columns are called `{name}`"));
            }
            columns.push((place, input));
        }
        if columns.is_empty() {
            let accepted = inputs.join(", ");
            return Err(format!("no column is an input of the model: {accepted}"));
        }
        let (mut times, mut rows) = (Vec::new(), Vec::new());
        for record in reader.records() {
            let record = record.map_err(|error| error.to_string())?;
            let line = record.position().map_or(0, csv::Position::line);
            let number = |place: usize| -> Result<f64, String> {
                let text = record.get(place).unwrap_or_default();
                let value = scalar::parse(text).ok().filter(|value| value.is_finite());
                value.ok_or_else(|| format!("line {line}: `{text}` is no number"))
            };
            let t = number(time)?;
            if times.last().is_some_and(|last| t < *last) {
                return Err(format!("line {line}: the time decreases to {t}"));
            }
            if rows.len() == MOST_ROWS {
                return Err(format!("there are more than {MOST_ROWS} rows"));
            }
            let values = columns.iter().map(|&(place, _)| number(place));
            rows.push(values.collect::<Result<_, _>>()?);
            times.push(t);
        }
        if rows.is_empty() {
            return Err("there are no rows".to_owned());
        }
        let after = model.description().parameters.len();
        let constant = (0..inputs.len()).map(|index| model.parameter(after + index));
        let (pieces, ends) = pieces(&times, between);
        Ok(Self {
            t: times,
            rows,
            pieces,
            ends,
            columns: columns.into_iter().map(|(_, input)| input).collect(),
            constant: constant.collect(),
        })
    }

    /// True if an input has a column.
    pub fn has(&self, input: usize) -> bool {
        self.columns.contains(&input)
    }

    /// The values of all inputs at a time, by the interpolation of this piece.
    fn values(&self, piece: usize, t: f64) -> Vec<f64> {
        let mut values = self.constant.clone();
        let Some(piece) = self.pieces.get(piece) else {
            return values;
        };
        let weights = weights(&self.t[piece.clone()], t);
        for (column, &input) in self.columns.iter().enumerate() {
            let rows = self.rows[piece.clone()].iter().zip(&weights);
            values[input] = rows.map(|(row, weight)| weight * row[column]).sum();
        }
        values
    }

    /// Makes a run with these inputs.
    ///
    /// # Errors
    /// A run that does not start, an integrator or a model that takes no inputs from outside.
    pub fn simulate(
        &self,
        model: &dyn AnyModel,
        origin: &Origin,
        settings: &Settings,
        watch: &mut dyn Watch,
    ) -> Result<Ending, CliError> {
        let passed = Cell::new(0);
        let inputs = |t: f64, _: &[f64], _: &[f64]| self.values(passed.get(), t);
        let control = Control {
            inputs: &inputs,
            changes: Changes::Pieces(&self.ends, &passed),
        };
        let ended = model.steer(origin, settings, &control, watch);
        let ended = ended.ok_or(CliError::Usage(
            "--inputs: inputs from a table need dop853, dopri5, rk4, gauss4 or gauss6, and a model with vectors of at most 32 \
             components",
        ))?;
        ended.map_err(|refusal| CliError::refused(model, &refusal))
    }
}

/// The rows that are interpolated before the first time, between two times, and after the last, and the times at which
/// these pieces meet. Cubics too have a kink where they meet, so that no step passes a row.
fn pieces(t: &[f64], between: Between) -> (Vec<Range<usize>>, Vec<f64>) {
    let constant = |row: usize| row..row + 1;
    let (mut pieces, mut ends) = (vec![constant(0)], vec![t[0]]);
    let mut start = 0;
    // Rows without a jump between them.
    for smooth in t.chunk_by(|before, after| before != after) {
        let end = start + smooth.len();
        let count = match between {
            Between::Cubic => CUBIC.min(smooth.len()),
            Between::Linear => 2,
            Between::Held => 1,
        };
        for after in start + 1..end {
            // As many rows on each side, if there are as many.
            let first = after.saturating_sub(count.div_ceil(2));
            let first = first.clamp(start, end - count);
            pieces.push(first..first + count);
            ends.push(t[after]);
        }
        start = end;
    }
    pieces.push(constant(t.len() - 1));
    (pieces, ends)
}

/// The weights of values at these times in the polynomial through them (Lagrange interpolation).
fn weights(nodes: &[f64], t: f64) -> Vec<f64> {
    let weight = |i: usize| -> f64 {
        let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
        others
            .map(|(_, node)| (t - node) / (nodes[i] - node))
            .product()
    };
    (0..nodes.len()).map(weight).collect()
}

/// Reads the table of `--inputs`, if the flag is given.
///
/// # Errors
/// The errors of [`InputTable::read`]; a model without inputs.
pub fn given(
    path: Option<&Path>,
    between: Between,
    model: &dyn AnyModel,
) -> Result<Option<InputTable>, CliError> {
    let Some(path) = path else {
        return Ok(None);
    };
    if model.inputs().is_empty() {
        return Err(CliError::Usage("--inputs: the model has no inputs"));
    }
    InputTable::read(path, between, model).map(Some)
}
