//! `check`: what a model declares, and whether its defaults and its initial state hold up.

use std::io::Write;

use dalembert::describe::{Description, Report, Topology};
use dalembert_codegen::report::{Item, Section, report};
use serde_json::{Value, json};

use crate::args::{CheckArgs, Format, OffConstraint};
use crate::entry::{AnyModel, Entry};
use crate::error::{CliError, fault_text};
use crate::exit::Exit;
use crate::json::{Document, number};
use crate::names;
use crate::state_input::{find_model, named_state};

/// One thing that was looked at: what, and what is wrong with it.
struct Finding {
    subject: &'static str,
    failure: Option<String>,
}

/// Carries out `check`.
///
/// # Errors
/// An unknown model, or an output that fails.
pub fn run(models: &[Entry], args: &CheckArgs, output: &mut dyn Write) -> Result<Exit, CliError> {
    let model = find_model(models, &args.model)?.with_defaults(0);
    let findings = findings(model.as_ref());
    let notes = notes(model.as_ref());
    match args.format {
        Format::Text => write_text(output, model.as_ref(), &findings, &notes)?,
        Format::Json => write_json(output, model.as_ref(), &findings, &notes)?,
    }
    let passed = findings.iter().all(|finding| finding.failure.is_none());
    Ok(if passed { Exit::Reached } else { Exit::Other })
}

/// Defaults against assumptions, then the initial state, as far as the defaults allow.
fn findings(model: &dyn AnyModel) -> Vec<Finding> {
    let description = model.description();
    let refused = defaults_against_assumptions(model);
    let mut findings = vec![Finding {
        subject: "declared defaults satisfy their assumptions",
        failure: refused,
    }];
    // Without a default there is nothing to form the initial state with.
    if model.check_parameters().is_err() {
        return findings;
    }
    let initial = named_state(model, &[], OffConstraint::Error);
    let failure = initial.as_ref().err().map(CliError::to_string);
    findings.push(Finding {
        subject: "the initial state is admissible",
        failure,
    });
    if let Ok(state) = initial {
        let inspected = model.inspect(0.0, &state, &mut Silent);
        let failure = inspected
            .err()
            .map(|fault| fault_text(&description, &fault));
        findings.push(Finding {
            subject: "the equations of motion exist at the initial state",
            failure,
        });
    }
    findings
}

fn defaults_against_assumptions(model: &dyn AnyModel) -> Option<String> {
    let parameters = model.description().parameters.iter();
    let bad: Vec<String> = parameters
        .filter_map(|parameter| {
            let value = parameter
                .default
                .filter(|&value| !parameter.assumption.holds(value))?;
            Some(format!(
                "`{}` is {value}, but must be {}",
                parameter.name, parameter.assumption
            ))
        })
        .collect();
    (!bad.is_empty()).then(|| bad.join("; "))
}

/// Remarks a person should see.
fn notes(model: &dyn AnyModel) -> Vec<String> {
    let description = model.description();
    let mut notes = Vec::new();
    for parameter in description
        .parameters
        .iter()
        .filter(|parameter| parameter.default.is_none())
    {
        notes.push(format!(
            "parameter `{0}` has no default: runs need --set {0}=VALUE",
            parameter.name
        ));
    }
    for constraint in description.constraints {
        if constraint.affine {
            notes.push(format!(
                "constraint `{}` is affine in the velocities",
                constraint.name
            ));
        }
        if constraint.level.is_some() {
            notes.push(format!(
                "constraint `{}` is integrable: it keeps a function of position",
                constraint.name
            ));
        }
    }
    if model.initial().until.is_none() {
        notes.push("no `until` is declared: runs need --until T or --impacts N".to_owned());
    }
    notes.extend(remarks(description.source));
    notes.push("claims are not checked yet by this version".to_owned());
    notes
}

/// What the generator remarks on the declaration: velocity-linear terms, integrable constraints, unused parameters.
fn remarks(source: &str) -> Vec<String> {
    let sections = report(source)
        .map(|report| report.sections)
        .unwrap_or_default();
    let remarks = sections
        .into_iter()
        .filter(|section| section.title == Section::NOTES);
    let items = remarks.flat_map(|section| section.items);
    items
        .filter_map(|item| match item {
            Item::Words(words) => Some(words),
            _ => None,
        })
        .collect()
}

fn write_text(
    output: &mut dyn Write,
    model: &dyn AnyModel,
    findings: &[Finding],
    notes: &[String],
) -> Result<(), CliError> {
    let description = model.description();
    writeln!(
        output,
        "{}: {}",
        description.name,
        or_none(names::summary(&description))
    )?;
    for (title, entries) in declarations(&description) {
        writeln!(output, "  {title:12} {}", or_none(&entries.join(", ")))?;
    }
    writeln!(output, "parameters")?;
    for parameter in description.parameters {
        let default = parameter
            .default
            .map_or("no default".to_owned(), |value| format!("= {value}"));
        writeln!(
            output,
            "  {} {default}, {}",
            parameter.name, parameter.assumption
        )?;
    }
    writeln!(output, "checks")?;
    for Finding { subject, failure } in findings {
        match failure {
            None => writeln!(output, "  ok    {subject}")?,
            Some(failure) => writeln!(output, "  FAIL  {subject}: {failure}")?,
        }
    }
    writeln!(output, "notes")?;
    for note in notes {
        writeln!(output, "  {note}")?;
    }
    Ok(())
}

/// What is declared besides parameters: a title and the entries under it.
fn declarations(description: &Description) -> [(&'static str, Vec<String>); 6] {
    let owned = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
    let coordinates = description.coordinates.iter();
    let surfaces = description.surfaces.iter();
    [
        (
            "coordinates",
            coordinates
                .map(|it| format!("{}{}", it.name, topology(it.topology)))
                .collect(),
        ),
        (
            "constraints",
            description
                .constraints
                .iter()
                .map(|it| it.name.to_owned())
                .collect(),
        ),
        ("forces", owned(description.forces)),
        (
            "surfaces",
            surfaces
                .map(|it| format!("{} ({})", it.name, it.law))
                .collect(),
        ),
        ("outputs", owned(description.outputs)),
        ("scenes", owned(description.scenes)),
    ]
}

fn topology(topology: Topology) -> String {
    match topology {
        Topology::Line => String::new(),
        Topology::Circle => " (angle)".to_owned(),
        Topology::Interval { low, high } => format!(" in ({low}, {high})"),
    }
}

fn or_none(text: &str) -> &str {
    if text.is_empty() { "none" } else { text }
}

fn write_json(
    output: &mut dyn Write,
    model: &dyn AnyModel,
    findings: &[Finding],
    notes: &[String],
) -> Result<(), CliError> {
    let description = model.description();
    let mut document = Document::begin(output)?;
    document.field("model", description.name)?;
    document.field("documentation", description.documentation)?;
    document.rows(
        "coordinates",
        description
            .coordinates
            .iter()
            .map(|it| json!({ "name": it.name, "topology": topology_json(it.topology) })),
    )?;
    document.rows("parameters", description.parameters.iter().map(|it| {
        let holds = it.default.map(|value| it.assumption.holds(value));
        json!({ "name": it.name, "default": it.default, "assumption": it.assumption.to_string(), "holds": holds })
    }))?;
    document.rows(
        "constraints",
        description.constraints.iter().map(
            |it| json!({ "name": it.name, "affine": it.affine, "integrable": it.level.is_some() }),
        ),
    )?;
    document.field("forces", description.forces.to_vec())?;
    document.rows(
        "surfaces",
        description
            .surfaces
            .iter()
            .map(|it| json!({ "name": it.name, "law": it.law })),
    )?;
    document.field("outputs", description.outputs.to_vec())?;
    document.field("scenes", description.scenes.to_vec())?;
    document.rows("checks", findings.iter().map(|finding| {
        json!({ "check": finding.subject, "passed": finding.failure.is_none(), "failure": finding.failure })
    }))?;
    document.field("claims", json!({ "checked": false }))?;
    document.field("notes", notes.to_vec())?;
    Ok(document.end()?)
}

fn topology_json(topology: Topology) -> Value {
    match topology {
        Topology::Line => json!("line"),
        Topology::Circle => json!("circle"),
        Topology::Interval { low, high } => json!([number(low), number(high)]),
    }
}

/// Takes a report without keeping anything: only whether it could be made matters.
struct Silent;

impl Report for Silent {
    fn scalar(&mut self, _name: &str, _value: f64) {}
    fn vector(&mut self, _name: &str, _values: &[f64]) {}
    fn matrix(&mut self, _name: &str, _rows: usize, _columns: usize, _values: &[f64]) {}
}
