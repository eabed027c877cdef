//! `errata`: lists misprints in the sources of the models, and computes the printed and the right values again.

use std::io::{self, Write};

use serde_json::{Value, json};

use crate::args::ErrataArgs;
use crate::catalogue::Catalogue;
use crate::errata::{Check, Erratum};
use crate::error::CliError;
use crate::exit::Exit;
use crate::json::{Document, number};
use crate::sink::{Sink, is_stdout};
use crate::{Streams, json as parser};

/// Relative difference below which a printed value counts as right.
const ALIKE: f64 = 1e-6;

/// Result of a check: the printed value and the right value, or the reason why they are missing.
type Computed = Result<[f64; 2], String>;

/// Carries out `errata`.
///
/// # Errors
/// A catalogue without errata, a file that cannot be written. A value that cannot be computed is not an error but an
/// [`Exit`].
pub fn run(
    catalogue: &Catalogue,
    args: &ErrataArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let errata = catalogue.errata();
    if errata.is_empty() {
        return Err(CliError::Usage(
            "errata: this command line has no errata; set them with `Catalogue::of(models![..]).with_errata(errata)`",
        ));
    }
    let json = Sink::open_given("--json", args.json.as_deref())?;
    let computed: Vec<Option<Computed>> = errata
        .iter()
        .map(|erratum| Some(compute(catalogue, erratum.check.as_ref()?)))
        .collect();
    if let Some(sink) = json {
        sink.write(streams, |output| write_json(output, errata, &computed))?;
    }
    if !args.json.as_deref().is_some_and(is_stdout) {
        write_text(streams.output, errata, &computed)?;
    }
    let are_shown = computed.iter().flatten().all(is_shown);
    Ok(if are_shown {
        Exit::Reached
    } else {
        Exit::Other
    })
}

/// Runs the command line of a check and reads both values from its output.
fn compute(catalogue: &Catalogue, check: &Check) -> Computed {
    let (mut output, mut errors) = (Vec::new(), Vec::new());
    let words = ["dalembert"].into_iter().chain(check.command.split(' '));
    let exit = catalogue.run_with(
        words,
        &mut Streams {
            input: &mut check.input.as_bytes(),
            output: &mut output,
            errors: &mut errors,
            terminal: false,
        },
    );
    if exit != Exit::Reached {
        let text = String::from_utf8_lossy(&errors);
        return Err(format!("the command fails: {}", text.trim_end()));
    }
    let document = parser::parse(&output).map_err(|error| error.to_string())?;
    let values = (check.values)(&document);
    values
        // Adding 0 turns a negative zero into a positive one.
        .map(|values| values.map(|value| value + 0.0))
        .filter(|values| values.iter().all(|value| value.is_finite()))
        .ok_or_else(|| "the output of the command lacks the value".to_owned())
}

/// True if both values are known and differ.
fn is_shown(computed: &Computed) -> bool {
    match computed {
        Ok([printed, right]) => (printed - right).abs() > ALIKE * printed.abs().max(right.abs()),
        Err(_) => false,
    }
}

/// Writes a paragraph for each erratum.
fn write_text(
    output: &mut dyn Write,
    errata: &[Erratum],
    computed: &[Option<Computed>],
) -> io::Result<()> {
    for (index, (erratum, computed)) in errata.iter().zip(computed).enumerate() {
        if index > 0 {
            writeln!(output)?;
        }
        writeln!(output, "{}", erratum.place)?;
        writeln!(output, "  printed   {}", erratum.printed)?;
        writeln!(output, "  right     {}", erratum.right)?;
        if let (Some(check), Some(computed)) = (&erratum.check, computed) {
            write_check(output, check, computed)?;
        }
    }
    let [checks, shown] = counts(computed);
    writeln!(
        output,
        "\n{shown} of {checks} computed values differ from the printed ones; {} errata are listed without a computation",
        errata.len() - checks
    )
}

fn write_check(output: &mut dyn Write, check: &Check, computed: &Computed) -> io::Result<()> {
    match computed {
        Ok([printed, right]) => {
            let verdict = match is_shown(computed) {
                true => "",
                false => "; they agree",
            };
            writeln!(
                output,
                "  value     {}: printed {printed:?}, right {right:?}{verdict}",
                check.quantity
            )?;
        }
        Err(reason) => writeln!(output, "  value     {}: {reason}", check.quantity)?,
    }
    writeln!(output, "  computed  {}", check.how)?;
    writeln!(output, "            {}", check.line())
}

/// Number of checks, and number of checks whose values differ.
fn counts(computed: &[Option<Computed>]) -> [usize; 2] {
    let checks = computed.iter().flatten();
    [
        checks.clone().count(),
        checks.filter(|computed| is_shown(computed)).count(),
    ]
}

/// Writes the document.
fn write_json(
    output: &mut dyn Write,
    errata: &[Erratum],
    computed: &[Option<Computed>],
) -> io::Result<()> {
    let [checks, shown] = counts(computed);
    let mut document = Document::begin(output)?;
    document.field("checks", checks)?;
    document.field("shown", shown)?;
    let rows = errata.iter().zip(computed).map(|(erratum, computed)| {
        let check = erratum.check.as_ref().zip(computed.as_ref());
        json!({
            "place": erratum.place,
            "printed": erratum.printed,
            "right": erratum.right,
            "check": check.map(|(check, computed)| check_json(check, computed)),
        })
    });
    document.rows("errata", rows)?;
    document.end()
}

fn check_json(check: &Check, computed: &Computed) -> Value {
    let value = |index: usize| computed.as_ref().ok().map(|values| number(values[index]));
    json!({
        "quantity": check.quantity,
        "printed": value(0),
        "right": value(1),
        "differs": is_shown(computed),
        "failure": computed.as_ref().err(),
        "how": check.how,
        "command": check.line(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_agree_or_are_missing_are_not_shown() {
        for (computed, shown) in [
            (Ok([1.0, 2.0]), true),
            (Ok([0.0, 1e-3]), true),
            (Ok([1.0, 1.0 + 1e-9]), false),
            (Ok([0.0, 0.0]), false),
            (Err("no value".to_owned()), false),
        ] {
            assert_eq!(is_shown(&computed), shown, "{computed:?}");
        }
    }
}
