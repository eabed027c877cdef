//! Inputs from a table: columns `t` and the names of inputs.
//!
//! Two rows at the same time are a jump; the later row holds from that time on. Inputs are constant before the first
//! row and after the last one.

use std::cell::Cell;
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
    /// Cubic through four rows, two on each side where they exist; rows beyond a jump are not used.
    Cubic,
    /// Line through the rows before and after.
    Linear,
    /// Values of the row before.
    Held,
}

/// Rows without a jump between them.
#[derive(Debug, Clone, Default)]
struct Piece {
    t: Vec<f64>,
    /// The inputs of each row, in the order of the columns.
    rows: Vec<Vec<f64>>,
}

/// Inputs as functions of time.
#[derive(Debug, Clone)]
pub struct InputTable {
    pieces: Vec<Piece>,
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
        let mut rows: Vec<(f64, Vec<f64>)> = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| error.to_string())?;
            let line = record.position().map_or(0, csv::Position::line);
            let number = |place: usize| -> Result<f64, String> {
                let text = record.get(place).unwrap_or_default();
                let value = scalar::parse(text).ok().filter(|value| value.is_finite());
                value.ok_or_else(|| format!("line {line}: `{text}` is no number"))
            };
            let t = number(time)?;
            if rows.last().is_some_and(|(last, _)| t < *last) {
                return Err(format!("line {line}: the time decreases to {t}"));
            }
            if rows.len() == MOST_ROWS {
                return Err(format!("there are more than {MOST_ROWS} rows"));
            }
            let values = columns.iter().map(|&(place, _)| number(place));
            rows.push((t, values.collect::<Result<_, _>>()?));
        }
        if rows.is_empty() {
            return Err("there are no rows".to_owned());
        }
        let after = model.description().parameters.len();
        let constant = (0..inputs.len()).map(|index| model.parameter(after + index));
        let mut table = Self {
            pieces: Vec::new(),
            ends: Vec::new(),
            columns: columns.into_iter().map(|(_, input)| input).collect(),
            constant: constant.collect(),
        };
        table.cut(rows, between);
        Ok(table)
    }

    /// Divides the rows into pieces: at jumps and, for linear or constant inputs, at every row.
    fn cut(&mut self, rows: Vec<(f64, Vec<f64>)>, between: Between) {
        let held = |t: f64, values: &[f64]| Piece {
            t: vec![t],
            rows: vec![values.to_vec()],
        };
        let (first, last) = (rows[0].clone(), rows[rows.len() - 1].clone());
        self.pieces.push(held(first.0, &first.1));
        self.ends.push(first.0);
        let mut open = Piece::default();
        for (t, values) in rows {
            let is_jump = open.t.last() == Some(&t);
            let is_cut = match between {
                Between::Cubic => is_jump,
                Between::Linear => open.t.len() > 1 || is_jump,
                Between::Held => !open.t.is_empty(),
            };
            if is_cut {
                let end = match between {
                    Between::Held => t,
                    _ => open.t[open.t.len() - 1],
                };
                let next = match (between, is_jump) {
                    // The line that ends at this row begins at the row before.
                    (Between::Linear, false) => {
                        let row = open.rows[open.rows.len() - 1].clone();
                        Piece {
                            t: vec![end],
                            rows: vec![row],
                        }
                    }
                    _ => Piece::default(),
                };
                self.pieces.push(std::mem::replace(&mut open, next));
                self.ends.push(end);
            }
            open.t.push(t);
            open.rows.push(values);
        }
        self.pieces.push(open);
        self.ends.push(last.0);
        self.pieces.push(held(last.0, &last.1));
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
        let (first, weights) = piece.weights(t);
        for (column, &input) in self.columns.iter().enumerate() {
            let rows = piece.rows[first..].iter().zip(&weights);
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

impl Piece {
    /// The index of the first row that is interpolated at a time, and the weights of the rows from there on (Lagrange
    /// interpolation).
    fn weights(&self, t: f64) -> (usize, Vec<f64>) {
        let count = self.t.len().min(CUBIC);
        let before = self.t.partition_point(|row| *row <= t);
        let first = before.saturating_sub(CUBIC / 2).min(self.t.len() - count);
        let nodes = &self.t[first..first + count];
        let weight = |i: usize| -> f64 {
            let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
            others
                .map(|(_, node)| (t - node) / (nodes[i] - node))
                .product()
        };
        (first, (0..count).map(weight).collect())
    }
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
