//! Linearised equations in a few lines of text.

use std::io::{self, Write};

use dalembert_driver::{Linearisation, Tendency};

use super::{Finished, text};
use crate::error::counted;
use crate::names;

/// Writes the summary.
pub(super) fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let model = finished.model;
    let description = model.description();
    let found = match &finished.found {
        Ok(found) => found,
        Err(reason) => return writeln!(output, "{}", text(description, reason)),
    };
    write!(output, "{}", names::titled(description, finished.scene))?;
    if let Some(mode) = finished.mode {
        write!(output, ", mode {mode}")?;
    }
    writeln!(output, ", linearised at t = {}", found.t)?;
    let state: Vec<&str> = found.components.iter().map(String::as_str).collect();
    let inputs = model.inputs();
    let outputs = &found.output_names;
    for (title, names, values) in [
        ("state", &state[..], &found.state),
        ("inputs", inputs, &found.inputs),
        ("outputs", &outputs[..], &found.outputs),
    ] {
        if !values.is_empty() {
            writeln!(output, "  {title:11} {}", assigned(names, values))?;
        }
    }
    if let Some(steps) = found.steps {
        let steps = counted(steps as usize, "step");
        writeln!(output, "  trim        {steps}")?;
    }
    writeln!(output, "  equilibrium {}", rest(found, &state))?;
    let of_rates: Vec<String> = state.iter().map(|name| format!("d/dt {name}")).collect();
    let of_rates: Vec<&str> = of_rates.iter().map(String::as_str).collect();
    for (name, rows, columns, matrix) in [
        ("A", &of_rates[..], &state[..], &found.a),
        ("B", &of_rates[..], inputs, &found.b),
        ("C", &outputs[..], &state[..], &found.c),
        ("D", &outputs[..], inputs, &found.d),
    ] {
        if !rows.is_empty() && !columns.is_empty() {
            write_matrix(output, name, [rows, columns], matrix)?;
        }
    }
    write_stability(output, found)?;
    for stride in &found.strides {
        let impacts = counted(stride.impacts as usize, "impact");
        let (t, until) = (stride.t, stride.until);
        writeln!(output, "  sample from t = {t} to t = {until}, {impacts}")?;
        writeln!(output, "    state     {}", assigned(&state, &stride.state))?;
        writeln!(output, "    next      {}", assigned(&state, &stride.next))?;
        write_matrix(output, "Phi", [&state, &state], &stride.phi)?;
        if !inputs.is_empty() {
            write_matrix(output, "Gamma", [&state, inputs], &stride.gamma)?;
        }
    }
    Ok(())
}

fn write_stability(output: &mut dyn Write, found: &Linearisation) -> io::Result<()> {
    let Some(eigenvalues) = &found.eigenvalues else {
        return writeln!(output, "  eigenvalues not found");
    };
    let eigenvalues: Vec<String> = eigenvalues.iter().map(|pair| complex(*pair)).collect();
    writeln!(output, "  eigenvalues {}", eigenvalues.join(", "))?;
    match found.tendency() {
        Some(tendency) => writeln!(output, "  stability   {}", told(tendency, found)),
        None => Ok(()),
    }
}

/// `x = 1, y = 2`
fn assigned(names: &[&str], values: &[f64]) -> String {
    let pairs = names.iter().zip(values);
    let pairs: Vec<String> = pairs
        .map(|(name, value)| format!("{name} = {value:?}"))
        .collect();
    pairs.join(", ")
}

fn rest(found: &Linearisation, state: &[&str]) -> String {
    match &found.unsteady[..] {
        [] => match found.unsteady_at {
            Some(t) => format!("no: at t = {t} the rates are not 0"),
            None => "yes".to_owned(),
        },
        unsteady => {
            let rates = unsteady.iter();
            let rates: Vec<String> = rates
                .map(|&index| format!("d/dt {} = {}", state[index], shown(found.rates[index])))
                .collect();
            format!("no: {}", rates.join(", "))
        }
    }
}

fn told(tendency: Tendency, found: &Linearisation) -> String {
    match tendency {
        Tendency::Stable => "stable: all real parts are negative".to_owned(),
        Tendency::Unstable(1) => "unstable: 1 eigenvalue has a positive real part".to_owned(),
        Tendency::Unstable(count) => {
            format!("unstable: {count} eigenvalues have positive real parts")
        }
        Tendency::Neutral(count) => format!(
            "not decided by the linearisation: {} with real part 0 up to rounding",
            counted(count, "eigenvalue")
        ),
        Tendency::OfOneTime => {
            "not decided: the equations depend on time, and eigenvalues at one time do not decide"
                .to_owned()
        }
        Tendency::Kinked => {
            let across = found
                .kinks
                .iter()
                .map(|&index| format!("`{}`", found.components[index]));
            let across: Vec<String> = across.collect();
            format!(
                "not decided by the linearisation: at this value of {}, derivatives of the rates jump or may jump",
                across.join(" and of ")
            )
        }
    }
}

/// A complex number, `-0.5 + 2i`.
fn complex([re, im]: [f64; 2]) -> String {
    let sign = if im < 0.0 { '-' } else { '+' };
    match im {
        0.0 => shown(re),
        im => format!("{} {sign} {}i", shown(re), shown(im.abs())),
    }
}

/// A number with nine decimals, or with an exponent if it is extremely large or small.
fn shown(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if (1e-4..1e6).contains(&size) => format!("{value:.9}"),
        _ => format!("{value:.6e}"),
    }
}

/// Writes a matrix with the names of its rows and columns.
fn write_matrix(
    output: &mut dyn Write,
    name: &str,
    [rows, columns]: [&[&str]; 2],
    matrix: &[Vec<f64>],
) -> io::Result<()> {
    let cells: Vec<Vec<String>> = (matrix.iter())
        .map(|row| row.iter().map(|value| shown(*value)).collect())
        .collect();
    let width = |column: usize| {
        let cells = cells.iter().map(|row| row[column].len());
        cells.chain([columns[column].len()]).max().unwrap_or(0)
    };
    let first = rows.iter().map(|row| row.len()).max().unwrap_or(0);
    write!(output, "  {name:first$}", first = first + 2)?;
    for (index, column) in columns.iter().enumerate() {
        write!(output, "  {column:>width$}", width = width(index))?;
    }
    writeln!(output)?;
    for (row, cells) in rows.iter().zip(&cells) {
        write!(output, "    {row:first$}")?;
        for (index, cell) in cells.iter().enumerate() {
            write!(output, "  {cell:>width$}", width = width(index))?;
        }
        writeln!(output)?;
    }
    Ok(())
}
