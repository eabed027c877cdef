//! A study as one JSON document.

use std::io::{self, Write};

use dalembert_driver::accuracy::Sample;
use serde_json::{Value, json};

use super::Finished;
use crate::json::{Document, number};

/// Writes the document.
///
/// # Errors
/// An I/O error of the stream.
pub fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let study = &finished.study;

    let mut document = Document::of_model(output, finished.model, finished.scene)?;
    document.field("form", finished.settings.form.name())?;
    document.field("until", number(study.until))?;
    let reference = json!({
        "outcome": study.outcome.kind(),
        "impacts": study.impacts,
        "floor": number(study.floor),
        "confirmed": study.doubt.is_none(),
        "doubt": study.doubt,
    });
    document.field("reference", reference)?;
    document.rows("cases", study.samples.iter().map(case))?;
    let cheapest = study.cheapest();
    document.rows(
        "cheapest",
        cheapest.iter().map(|(decade, best)| chosen(*decade, best)),
    )?;
    let automatic = finished.automatic();
    document.rows(
        "automatic",
        automatic.iter().map(
            |(integrator, tol)| json!({ "tol": number(*tol), "integrator": integrator.name() }),
        ),
    )?;
    let absent = study.absent.iter();
    document.rows(
        "absent",
        absent.map(
            |(integrator, reason)| json!({ "integrator": integrator.name(), "reason": reason }),
        ),
    )?;
    if let (Some(wanted), Some(choice)) = (finished.wanted, finished.choice()) {
        let answer = match choice {
            Ok(best) => chosen(wanted, best),
            Err(reason) => json!({ "error": number(wanted), "reason": reason.to_string() }),
        };
        document.field("wanted", answer)?;
    }
    document.end()
}

fn case(sample: &Sample) -> Value {
    let counters = &sample.counters;
    json!({
        "integrator": sample.integrator.name(),
        "tol": number(sample.tol),
        "step": sample.step.map(number),
        "error": number(sample.error),
        "ends_as_reference": sample.agrees,
        "outcome": sample.outcome.kind(),
        "t": number(sample.t),
        "impacts": counters.impacts,
        "rate_evaluations": counters.rate_evaluations,
        "coefficients": counters.coefficients,
        "accepted": counters.accepted,
        "rejected": counters.rejected,
        "work": number(sample.work),
        "microseconds_per_unit": number(sample.microseconds),
    })
}

/// The fastest case that reaches an error.
fn chosen(error: f64, best: &Sample) -> Value {
    json!({
        "error": number(error),
        "integrator": best.integrator.name(),
        "tol": number(best.tol),
        "measured": number(best.error),
        "microseconds_per_unit": number(best.microseconds),
    })
}
