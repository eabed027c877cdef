//! `derive`: the derivation of a model, made again from its source by the generator.

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
/// An unknown model, or whatever the generator says of its source.
pub fn run(models: &[Entry], args: &DeriveArgs, output: &mut dyn Write) -> Result<Exit, CliError> {
    let entry = find_model(models, &args.model)?;
    let scenes = entry.description().scenes.iter().copied();
    let scene = names::find("--scene", "scene", &args.scene, scenes)?;
    let mut report =
        report(entry.description().source).map_err(|error| CliError::Derive(error.to_string()))?;
    // The model itself is the first of its scenes.
    if let Some(scene) = scene.checked_sub(1) {
        report = report.scenes.swap_remove(scene);
    }
    let text = match args.format {
        DeriveFormat::Text => text(&report),
        DeriveFormat::Latex => latex(&report),
        DeriveFormat::Json => format!("{:#}", json(&report)),
    };
    writeln!(output, "{}", text.trim_end())?;
    Ok(Exit::Reached)
}

/// Index of the two forms of every formula.
const TEXT: usize = 0;
const LATEX: usize = 1;

fn text(report: &Report) -> String {
    let mut out = format!("{}\n{}\n", report.name, report.documentation);
    for section in &report.sections {
        let [equation, _] = section.equation;
        let colon = if equation.is_empty() { "" } else { ": " };
        out += &format!("\n{}{colon}{equation}\n", section.title);
        for item in &section.items {
            out += &match item {
                Item::Words(words) => format!("  {words}\n"),
                Item::Formula { left, right } => format!("  {} = {}\n", left[TEXT], right[TEXT]),
                Item::Matrix { left, rows } => text_matrix(&left[TEXT], rows),
            };
        }
    }
    out
}

/// A matrix with its columns aligned; a single row on one line.
fn text_matrix(left: &str, rows: &[Vec<[String; 2]>]) -> String {
    let width = |j: usize| {
        rows.iter()
            .map(|row| row[j][TEXT].chars().count())
            .max()
            .unwrap_or(0)
    };
    let mut out = String::new();
    for (i, row) in rows.iter().enumerate() {
        let entries: Vec<String> = row
            .iter()
            .enumerate()
            .map(|(j, entry)| format!("{:>1$}", entry[TEXT], width(j)))
            .collect();
        let head = if i == 0 {
            format!("{left} = ")
        } else {
            " ".repeat(left.chars().count() + 3)
        };
        out += &format!("  {head}[ {} ]\n", entries.join(", "));
    }
    out
}

/// A document that compiles as it is.
fn latex(report: &Report) -> String {
    let mut out =
        String::from("\\documentclass{article}\n\\usepackage{amsmath}\n\\begin{document}\n");
    out += &format!(
        "\\section*{{{}}}\n{}\n",
        escape(&report.name),
        escape(&report.documentation)
    );
    for section in &report.sections {
        out += &format!("\n\\subsection*{{{}}}\n", escape(section.title));
        let [_, equation] = section.equation;
        if !equation.is_empty() {
            out += &format!("\\[ {equation} \\]\n");
        }
        for item in &section.items {
            out += &match item {
                Item::Words(words) => format!("\\noindent {}\\par\n", escape(words)),
                Item::Formula { left, right } => {
                    format!("\\[ {} = {} \\]\n", left[LATEX], right[LATEX])
                }
                Item::Matrix { left, rows } => {
                    let row = |row: &Vec<[String; 2]>| {
                        row.iter()
                            .map(|e| e[LATEX].as_str())
                            .collect::<Vec<_>>()
                            .join(" & ")
                    };
                    let rows: Vec<String> = rows.iter().map(row).collect();
                    format!(
                        "\\[ {} = \\begin{{pmatrix}} {} \\end{{pmatrix}} \\]\n",
                        left[LATEX],
                        rows.join(" \\\\ ")
                    )
                }
            };
        }
    }
    out + "\\end{document}\n"
}

/// Words as LaTeX text wants them.
fn escape(words: &str) -> String {
    let mut out = String::new();
    for c in words.chars() {
        match c {
            '_' | '&' | '%' | '#' | '$' | '{' | '}' => out.extend(['\\', c]),
            '^' => out += "\\^{}",
            '~' => out += "\\~{}",
            '\\' => out += "\\textbackslash{}",
            '<' | '>' | '*' => out += &format!("${c}$"),
            _ => out.push(c),
        }
    }
    out
}

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
