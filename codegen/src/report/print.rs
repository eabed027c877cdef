//! Reports as text and as a LaTeX document.

use super::{Item, Report};

/// Indices of the two notations of a formula.
const TEXT: usize = 0;
const LATEX: usize = 1;

impl Report {
    /// The report for a terminal.
    pub fn text(&self) -> String {
        text(self)
    }

    /// A complete LaTeX document.
    pub fn latex(&self) -> String {
        latex(self)
    }
}

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
    for mode in report.modes() {
        out += &format!("\nMode {}", text(mode));
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

fn latex(report: &Report) -> String {
    format!(
        "\\documentclass{{article}}\n\\usepackage[T1]{{fontenc}}\n\\usepackage{{amsmath}}\n\\begin{{document}}\n{}\\end{{document}}\n",
        latex_section("", report)
    )
}

fn latex_section(kind: &str, report: &Report) -> String {
    let mut out = format!(
        "\\section*{{{kind}{}}}\n{}\n",
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
    for mode in report.modes() {
        out += &format!("\n{}", latex_section("Mode ", mode));
    }
    out
}

/// Words with the special characters of LaTeX escaped.
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
