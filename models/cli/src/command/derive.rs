//! `derive`: the derivation of a model, repeated from its source by the generator.

use std::io::Write;

use dalembert_codegen::report::{
    BracketKind, Item, Report, ReportError, bracket, control, group, report, report_without_claims,
};
use serde_json::{Value, json};

use crate::Streams;
use crate::args::{DeriveArgs, DeriveFormat};
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::names;
use crate::sink::{self, Sink};
use crate::state_input::find_model;

/// Carries out `derive`.
///
/// # Errors
/// An unknown model, an error of the generator on its source, or an output that fails.
pub fn run(
    models: &[Entry],
    args: &DeriveArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let sink = Sink::open_given("--json", args.json.as_deref())?;
    let entry = find_model(models, &args.model)?;
    let scenes = entry.description().scenes.iter().copied();
    let scene = names::find("--scene", "scene", &args.scene, scenes)?;
    let report = derived(entry, args, scene).map_err(|error| {
        let flag = flag(args).map_or(String::new(), |flag| format!("{flag}: "));
        CliError::Derive(format!("{flag}{error}"))
    })?;
    let document = |output: &mut dyn Write| writeln!(output, "{:#}", json(&report));
    if sink::write_document(sink, streams, document)? {
        return Ok(Exit::Reached);
    }
    let text = match args.format {
        DeriveFormat::Text => report.text(),
        DeriveFormat::Latex => report.latex(),
        DeriveFormat::Json => format!("{:#}", json(&report)),
    };
    writeln!(streams.output, "{}", text.trim_end())?;
    Ok(Exit::Reached)
}

/// The flag that asks for another output than the equations.
fn flag(args: &DeriveArgs) -> Option<&'static str> {
    if args.control {
        return Some("--control");
    }
    let flags = [
        (&args.bracket, "--bracket"),
        (&args.jacobiator, "--jacobiator"),
        (&args.group, "--group"),
    ];
    flags
        .into_iter()
        .find_map(|(value, flag)| value.is_some().then_some(flag))
}

/// The requested derivation. Scene 0 is the model itself.
fn derived(entry: &Entry, args: &DeriveArgs, scene: usize) -> Result<Report, ReportError> {
    let source = &entry.description().source;
    let part = (scene > 0).then_some(args.scene.as_str());
    if let Some(functions) = &args.bracket {
        return bracket(source, part, functions, BracketKind::Bracket);
    }
    if let Some(functions) = &args.jacobiator {
        return bracket(source, part, functions, BracketKind::Jacobiator);
    }
    if let Some(fields) = &args.group {
        return group(source, part, fields);
    }
    if args.control {
        return control(source, part);
    }
    let mut whole = match args.claims.no_claims {
        true => report_without_claims(source)?,
        false => report(source)?,
    };
    Ok(match scene.checked_sub(1) {
        Some(scene) => whole.scenes.swap_remove(scene),
        None => whole,
    })
}

/// Indices of the two forms of every formula.
const TEXT: usize = 0;
const LATEX: usize = 1;

fn json(report: &Report) -> Value {
    let sections: Vec<Value> = report
        .sections
        .iter()
        .map(|section| json!({ "title": section.title, "equation": both(&section.equation.map(String::from)), "items": section.items.iter().map(item_json).collect::<Vec<_>>() }))
        .collect();
    let mut document = json!({ "model": report.name, "documentation": report.documentation, "sections": sections });
    if report.has_modes {
        document["modes"] = report.modes().iter().map(json).collect();
    }
    document
}

fn both(pair: &[String; 2]) -> Value {
    json!({ "text": pair[TEXT], "latex": pair[LATEX] })
}

fn item_json(item: &Item) -> Value {
    match item {
        Item::Words(words) => json!({ "words": words }),
        Item::Formula { left, right } => json!({ "left": both(left), "right": both(right) }),
        Item::Matrix { left, rows } => {
            let rows: Vec<Vec<Value>> = rows
                .iter()
                .map(|row| row.iter().map(both).collect())
                .collect();
            json!({ "left": both(left), "rows": rows })
        }
    }
}
