//! Reports of a derivation: the emitted expressions, as text and LaTeX.
//!
//! A report prints the emitted code: every expression here is lowered as it stands, after collection of `cos^2 + sin^2`
//! and common factors. The density form, brackets and reductions are written out for the reader only.
//!
//! | file | job |
//! |---|---|
//! | `mod.rs` | the types of a report, and its order |
//! | `equations.rs` | declaration, Lagrangian, motion, constraints, surfaces, outputs |
//! | `frame.rs` | the motion reduced to D |
//! | `request.rs`, `bracket.rs`, `group.rs` | requests in the syntax of claims: brackets of functions, reduction by a group |
//! | `control.rs` | the maximum principle of a model with a cost |
//! | `modulo.rs` | symmetries for orbits that close up to a group |
//! | `planar` | hypotheses of the Poincare-Bendixson theorem |
//! | `certificate.rs` | declaration and grounds of the claims, for an independent checker |
//! | `print.rs` | a report as text and as a LaTeX document |
//! | `volume.rs`, `density_form.rs` | the invariant volume; the density form written out |

mod bracket;
pub mod certificate;
mod control;
mod density_form;
mod equations;
mod frame;
mod group;
mod modulo;
pub mod planar;
mod print;
mod request;
mod volume;

use std::fmt;

use proc_macro2::{LexError, TokenStream};

pub use bracket::{BracketKind, bracket};
pub use control::control;
pub use density_form::density_form;
pub use group::group;
pub use modulo::{Symmetry, symmetries};

use certificate::Tree;
use equations::Writer;

use crate::claims::Finding;
use crate::diagnostics::Diagnostics;
use crate::model::{Beside, Mode, ModeGraph, Model};
use crate::program::{Cost, Program};
use crate::spec::{self, Declaration, Modes};
use crate::tables::text_of;
use crate::{Compiled, CompiledModes, compile_modes, compile_spec, read};

/// A derivation as lines of text and formulas.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// The name in snake case, of the model or of the scene.
    pub name: String,
    /// Doc comment.
    pub documentation: String,
    /// The parts, in the order of the derivation.
    pub sections: Vec<Section>,
    /// The verdicts on the claims of the model, in order.
    pub findings: Vec<Finding>,
    /// Certificate of the claims, with the grounds of their verdicts.
    pub certificate: Tree,
    /// Reports of the scenes or modes, in order.
    pub scenes: Vec<Report>,
    /// True if `scenes` are modes, which are then parts of the report as text and as a document.
    pub has_modes: bool,
}

impl Report {
    /// The reports of the modes; none for a model without modes.
    pub fn modes(&self) -> &[Self] {
        match self.has_modes {
            true => &self.scenes,
            false => &[],
        }
    }
}

/// A part of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Section {
    /// Title.
    pub title: &'static str,
    /// The equation of the section, as text and as LaTeX; empty if there is none.
    pub equation: [&'static str; 2],
    /// Lines.
    pub items: Vec<Item>,
}

impl Section {
    /// The title of the section with the model's remarks.
    pub const NOTES: &'static str = "Notes";

    /// A section without an equation of its own.
    fn plain(title: &'static str, items: Vec<Item>) -> Self {
        let equation = ["", ""];
        Self {
            title,
            equation,
            items,
        }
    }
}

/// A line of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Item {
    /// Words.
    Words(String),
    /// `left = right`
    Formula {
        /// The left side as text and as LaTeX.
        left: [String; 2],
        /// The right side as text and as LaTeX.
        right: [String; 2],
    },
    /// `left = (rows)`; every entry as text and as LaTeX.
    Matrix {
        /// The left side as text and as LaTeX.
        left: [String; 2],
        /// The entries.
        rows: Vec<Vec<[String; 2]>>,
    },
}

/// Reason for which a text gives no report.
#[derive(Debug)]
pub enum ReportError {
    /// The text is not a sequence of Rust tokens.
    Tokens(String),
    /// The macro would refuse the declaration.
    Declaration(Diagnostics),
}

impl fmt::Display for ReportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tokens(error) => write!(f, "not a sequence of tokens: {error}"),
            Self::Declaration(diagnostics) => {
                let messages: Vec<&str> = diagnostics
                    .iter()
                    .map(|diagnostic| diagnostic.message())
                    .collect();
                f.write_str(&messages.join("\n"))
            }
        }
    }
}

impl std::error::Error for ReportError {}

/// Derives a model from its declaration as text: the body of a `model!`.
///
/// # Errors
/// [`ReportError`].
pub fn report(source: &str) -> Result<Report, ReportError> {
    report_of_declaration(declaration(source)?)
}

/// Same as [`report`], without the claims of the model.
///
/// # Errors
/// [`ReportError`].
pub fn report_without_claims(source: &str) -> Result<Report, ReportError> {
    report_of_declaration(declaration(source)?.without_claims())
}

/// The declaration of a text.
pub(crate) fn declaration(source: &str) -> Result<Declaration, ReportError> {
    read(tokens(source)?).map_err(ReportError::Declaration)
}

fn tokens(text: &str) -> Result<TokenStream, ReportError> {
    text.parse()
        .map_err(|error: LexError| ReportError::Tokens(error.to_string()))
}

fn report_of_declaration(declaration: Declaration) -> Result<Report, ReportError> {
    let spec = match declaration {
        Declaration::Model(spec) => spec,
        Declaration::Modes(declared) => return report_of_modes(&declared),
    };
    let mut compiled = compile_spec(&spec, spec::STEPS).map_err(ReportError::Declaration)?;
    let names: Vec<String> = (compiled.model.scenes.iter())
        .map(|scene| scene.name.clone())
        .collect();
    let scenes = std::mem::take(&mut compiled.scenes);
    let scenes = scenes.into_iter().zip(names);
    let scenes = scenes.map(|(scene, name)| report_of(scene, name));
    let scenes = scenes.collect();
    let name = compiled.model.snake_name.clone();
    Ok(Report {
        scenes,
        ..report_of(compiled, name)
    })
}

/// The report of a model with modes: its modes and transitions, and the report of each mode as a scene.
fn report_of_modes(declared: &Modes) -> Result<Report, ReportError> {
    let compiled = compile_modes(declared).map_err(ReportError::Declaration)?;
    let CompiledModes { graph, modes } = compiled;
    let model = &graph.modes[0].model;
    let coordinates = |mode: &Mode| {
        let names = mode.model.coordinates.iter();
        let names: Vec<&str> = names.map(|name| name.name.display.as_str()).collect();
        names.join(", ")
    };
    let lines = graph.modes.iter().map(|mode| {
        let documentation = text_of(&mode.scene.documentation).replace('\n', " ");
        let line = format!(
            "{}: {}. {documentation}",
            mode.scene.name,
            coordinates(mode)
        );
        Item::Words(line.trim_end().to_owned())
    });
    let sections = [
        Section::plain("Modes", lines.collect()),
        Section::plain("Transitions", transitions(&graph)),
    ];
    let (name, documentation) = (model.snake_name.clone(), text_of(&model.documentation));
    let scenes = graph.modes.iter().zip(modes);
    let scenes = scenes.map(|(mode, scene)| report_of(scene, mode.scene.name.clone()));
    Ok(Report {
        name,
        documentation,
        sections: sections.into(),
        findings: Vec::new(),
        certificate: Tree::Absent,
        scenes: scenes.collect(),
        has_modes: true,
    })
}

/// Target, condition and entry state of each transition.
fn transitions(graph: &ModeGraph) -> Vec<Item> {
    let mut items = Vec::new();
    for mode in &graph.modes {
        for (index, surface) in mode.model.surfaces.iter().enumerate() {
            let Some(transition) = &surface.transition else {
                continue;
            };
            let kind = match (&transition.map, mode.model.is_first_order()) {
                (Some(_), _) => "with the declared state",
                (None, true) => "with the same position",
                (None, false) if transition.keeps_lagrangian => {
                    "with the nearest velocity that its constraints allow"
                }
                (None, false) => "refracted, or reflected where there is not enough energy",
            };
            let conditions = surface.conditions.iter();
            let conditions = conditions.map(|condition| {
                let sign = if condition.is_closed { ">=" } else { ">" };
                format!(" when {} {sign} 0", mode.model.pool.text(condition.margin))
            });
            items.push(Item::Words(format!(
                "{}: {} {} when {} <= 0{}, {kind}",
                surface.name.display,
                mode.scene.name,
                mode.model.law_text(index),
                mode.model.pool.text(surface.gap),
                match surface.beside {
                    Beside::Otherwise(_) => " otherwise".to_owned(),
                    _ => conditions.collect::<String>(),
                },
            )));
        }
    }
    items
}

/// The report of a model or a scene.
fn report_of(compiled: Compiled, name: String) -> Report {
    let Compiled {
        mut model,
        derivation,
        findings,
        programs,
        scenes: _,
    } = compiled;
    let mut writer = Writer {
        model: &mut model,
        derivation: &derivation,
    };
    let mut sections = vec![writer.declared()];
    match writer.model.field.clone() {
        Some(rates) => sections.push(writer.rates(&rates)),
        None => sections.extend([
            writer.lagrangian(),
            writer.motion(),
            writer.constraints(),
            writer.frame(),
        ]),
    }
    sections.extend([writer.surfaces(), writer.declared_outputs()]);
    if writer.model.extras.volume {
        sections.push(writer.volume());
    }
    sections.push(scenes(&model));
    sections.push(claims(&findings));
    sections.push(work(&model, &programs.main));
    sections.push(notes(&model));
    sections.retain(|section| !section.items.is_empty());
    let certificate = certificate::certificate(&model, &model.own_claims(), &findings);
    Report {
        name,
        documentation: text_of(&model.documentation),
        sections,
        findings,
        certificate,
        scenes: Vec::new(),
        has_modes: false,
    }
}

/// Forces, surfaces and extras of each scene.
fn scenes(model: &Model) -> Section {
    let items = model.scenes.iter().map(|scene| {
        let used = model.used(&scene.parts);
        Item::Words(format!("{}: {used}", scene.name))
    });
    Section::plain("Scenes", items.collect())
}

/// Operation counts of the emitted functions.
fn work(model: &Model, program: &Program) -> Section {
    let line = |name: &str, cost: &Cost| Item::Words(format!("{name}: {cost}"));
    let mut items = vec![line("rate", &program.rate.cost)];
    if !model.is_first_order() {
        items.push(line("energy", &program.energy.cost));
    }
    if let Some(constrained) = &program.constrained {
        items.push(line("multipliers", &constrained.multipliers.cost));
        if let Some(back) = &constrained.return_to_constraints {
            items.push(line(
                "return to the constraints after a step",
                &back.restore.cost,
            ));
        }
    }
    if let Some(impacting) = &program.impacting {
        items.push(line("all gaps", &impacting.gaps.cost));
        for (surface, blow) in model.surfaces.iter().zip(&impacting.blows) {
            if let Some(blow) = blow {
                let name = format!("impact on {}", surface.name.display);
                items.push(line(&name, &blow.cost));
            }
        }
    }
    if let Some(volume) = &program.volume {
        items.push(line("density of the volume", &volume.log_density.cost));
    }
    Section::plain("Work of the emitted functions", items)
}

/// The verdicts on the claims.
fn claims(findings: &[Finding]) -> Section {
    let items = findings
        .iter()
        .map(|finding| Item::Words(finding.note()))
        .collect();
    Section::plain("Claims", items)
}

fn notes(model: &Model) -> Section {
    let items = model.notes.iter().cloned().map(Item::Words).collect();
    Section::plain(Section::NOTES, items)
}
