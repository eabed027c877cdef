//! `derive`: the derivation of a model, repeated from its source by the generator.

use std::io::Write;

use dalembert_codegen::report::{Item, Report, report};
use serde_json::{Value, json};

use crate::args::{DeriveArgs, DeriveFormat};
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::names;
use crate::state_input::find_model;

/// Carries out `derive`.
///
/// # Errors
/// An unknown model, or an error of the generator on its source.
pub fn run(models: &[Entry], args: &DeriveArgs, output: &mut dyn Write) -> Result<Exit, CliError> {
    let entry = find_model(models, &args.model)?;
    let scenes = entry.description().scenes.iter().copied();
    let scene = names::find("--scene", "scene", &args.scene, scenes)?;
    let mut report =
        report(&entry.description().source).map_err(|error| CliError::Derive(error.to_string()))?;
    // The model itself is the first of its scenes.
    if let Some(scene) = scene.checked_sub(1) {
        report = report.scenes.swap_remove(scene);
    }
    let text = match args.format {
        DeriveFormat::Text => report.text(),
        DeriveFormat::Latex => report.latex(),
        DeriveFormat::Json => format!("{:#}", json(&report)),
    };
    writeln!(output, "{}", text.trim_end())?;
    Ok(Exit::Reached)
}

/// Index of the two forms of every formula.
const TEXT: usize = 0;
const LATEX: usize = 1;

fn json(report: &Report) -> Value {
    let sections: Vec<Value> = report
        .sections
        .iter()
        .map(|section| json!({ "title": section.title, "equation": both(&section.equation.map(String::from)), "items": section.items.iter().map(item_json).collect::<Vec<_>>() }))
        .collect();
    json!({ "model": report.name, "documentation": report.documentation, "sections": sections })
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
