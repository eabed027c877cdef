//! The derivation as a person reads it: the expressions that are emitted, as text and LaTeX.
//!
//! What is printed is what is emitted: every expression here is lowered as it stands (after collection of
//! `cos^2 + sin^2` and common factors for the eye).

use std::fmt;

use dalembert_expr::ExprId;
use proc_macro2::{LexError, TokenStream};

use crate::claims::Finding;
use crate::diagnostics::Diagnostics;
use crate::mechanics::Derivation;
use crate::model::{self, Model, Topology};
use crate::program::{Cost, Program};
use crate::{Compiled, compile};

/// A derivation in words and formulas.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// The model's name in snake case.
    pub name: String,
    /// Its doc comment.
    pub documentation: String,
    /// The parts, in the order of the derivation.
    pub sections: Vec<Section>,
    /// The verdicts on its claims, in order.
    pub findings: Vec<Finding>,
}

/// A part of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Section {
    /// Its title.
    pub title: &'static str,
    /// The equation it is about, as text and as LaTeX; empty if there is none.
    pub equation: [&'static str; 2],
    /// Its lines.
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

/// Why a text gives no report.
#[derive(Debug)]
pub enum ReportError {
    /// It is not a sequence of Rust tokens.
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
    let tokens: TokenStream = source
        .parse()
        .map_err(|error: LexError| ReportError::Tokens(error.to_string()))?;
    let Compiled {
        mut model,
        derivation,
        findings,
        program,
    } = compile(tokens).map_err(ReportError::Declaration)?;
    let mut writer = Writer {
        model: &mut model,
        derivation: &derivation,
    };
    let mut sections = vec![
        writer.declared(),
        writer.lagrangian(),
        writer.motion(),
        writer.constraints(),
        writer.surfaces(),
        writer.declared_outputs(),
    ];
    sections.push(claims(&findings));
    sections.push(work(&model, &program));
    sections.push(notes(&model));
    sections.retain(|section| !section.items.is_empty());
    Ok(Report {
        name: model.snake_name.clone(),
        documentation: model
            .documentation
            .iter()
            .map(|line| line.trim())
            .collect::<Vec<_>>()
            .join("\n"),
        sections,
        findings,
    })
}

struct Writer<'a> {
    model: &'a mut Model,
    derivation: &'a Derivation,
}

impl Writer<'_> {
    fn print(&mut self, expression: ExprId) -> [String; 2] {
        let tidy = self.model.pool.simplify(expression);
        [self.model.pool.text(tidy), self.model.pool.latex(tidy)]
    }

    fn formula(
        &mut self,
        text: impl Into<String>,
        latex: impl Into<String>,
        right: ExprId,
    ) -> Item {
        Item::Formula {
            left: [text.into(), latex.into()],
            right: self.print(right),
        }
    }

    fn is_zero(&self, expression: ExprId) -> bool {
        self.model.pool.is_syntactic_zero(expression)
    }

    /// The coordinate's symbol as text and LaTeX.
    fn coordinate(&mut self, i: usize) -> [String; 2] {
        let symbol = self.model.coordinates[i].q;
        let expression = self.model.pool.variable(symbol);
        self.print(expression)
    }

    fn declared(&mut self) -> Section {
        let mut items = Vec::new();
        for coordinate in &self.model.coordinates {
            let name = &coordinate.name.display;
            let pool = &self.model.pool;
            items.push(Item::Words(match coordinate.topology {
                Topology::Line => format!("coordinate {name}: line"),
                Topology::Angle => format!("coordinate {name}: angle"),
                Topology::Interval { low, high } => {
                    format!(
                        "coordinate {name}: in ({}, {})",
                        pool.text(low),
                        pool.text(high)
                    )
                }
            }));
        }
        for parameter in &self.model.parameters {
            let default = parameter
                .default
                .map(|value| format!(", default {}", self.model.pool.text(value)));
            let demand = match &parameter.assumption {
                model::Assumption::Finite => String::new(),
                model::Assumption::Positive => " > 0".into(),
                model::Assumption::NonNegative => " >= 0".into(),
                model::Assumption::NonZero => " != 0".into(),
                model::Assumption::Within { low, high } => format!(" in [{low}, {high}]"),
            };
            let name = &parameter.name.display;
            items.push(Item::Words(format!(
                "parameter {name}{demand}{}",
                default.unwrap_or_default()
            )));
        }
        Section::plain("Declared", items)
    }

    fn lagrangian(&mut self) -> Section {
        let whole = self.model.lagrangian.whole;
        let mut items = vec![self.formula("L", "L", whole)];
        let metric = self.model.lagrangian.metric.clone();
        let rows = metric
            .iter()
            .map(|row| row.iter().map(|&entry| self.print(entry)).collect())
            .collect();
        items.push(Item::Matrix {
            left: ["g".into(), "g".into()],
            rows,
        });
        for (i, entry) in self.model.lagrangian.linear.clone().into_iter().enumerate() {
            if !self.is_zero(entry) {
                let [name, latex] = self.coordinate(i);
                items.push(self.formula(format!("A_{name}"), format!("A_{{{latex}}}"), entry));
            }
        }
        let potential = self.model.lagrangian.potential;
        items.push(self.formula("V", "V", potential));
        let equation = [
            "L = g(qdot, qdot)/2 + A.qdot - V",
            r"L = \tfrac12 g(\dot q, \dot q) + A \cdot \dot q - V",
        ];
        Section {
            title: "Lagrangian",
            equation,
            items,
        }
    }

    fn motion(&mut self) -> Section {
        let mut items = Vec::new();
        for i in 0..self.model.coordinates.len() {
            let [name, latex] = self.coordinate(i);
            let force = self.derivation.field.force[i];
            items.push(self.formula(format!("f_{name}"), format!("f_{{{latex}}}"), force));
        }
        for i in 0..self.model.coordinates.len() {
            let drift = self.derivation.field.drift[i];
            if !self.is_zero(drift) {
                let [name, latex] = self.coordinate(i);
                items.push(self.formula(
                    format!("drift_{name}"),
                    format!("(\\dot g\\dot q + \\dot A)_{{{latex}}}"),
                    drift,
                ));
            }
        }
        let equation = match self.derivation.constraints.is_empty() {
            true => [
                "qdot = g^-1 (p - A), pdot = f",
                r"\dot q = g^{-1}(p - A), \quad \dot p = f",
            ],
            false => [
                "qdot = g^-1 (p - A), pdot = f + lambda_a eta^a",
                r"\dot q = g^{-1}(p - A), \quad \dot p = f + \lambda_a \eta^a",
            ],
        };
        let title = "Motion";
        Section {
            title,
            equation,
            items,
        }
    }

    fn constraints(&mut self) -> Section {
        let mut items = Vec::new();
        for a in 0..self.derivation.constraints.len() {
            let name = self.model.constraints[a].name.display.clone();
            let constraint = &self.derivation.constraints[a];
            let (form, affine) = (constraint.form.clone(), constraint.affine);
            let (curvature, level) = (constraint.curvature, constraint.level);
            let row = form.iter().map(|&entry| self.print(entry)).collect();
            let label = |symbol: &str| {
                [
                    format!("{symbol}[{name}]"),
                    format!("{symbol}^{{\\text{{{}}}}}", escape(&name)),
                ]
            };
            let [text, latex] = label("eta");
            items.push(Item::Matrix {
                left: [text, format!("\\{latex}")],
                rows: vec![row],
            });
            if !self.is_zero(affine) {
                let [text, latex] = label("eta_0");
                items.push(self.formula(text, format!("\\{latex}"), affine));
            }
            let [text, latex] = label("curvature");
            items.push(self.formula(
                text,
                format!("\\text{{curvature}}{}", &latex["curvature".len()..]),
                curvature,
            ));
            if let Some(level) = level {
                let [text, latex] = label("level");
                items.push(self.formula(
                    text,
                    format!("\\text{{level}}{}", &latex["level".len()..]),
                    level,
                ));
            }
        }
        let equation = [
            "m^ab lambda_b = -[ W^a.(f - drift) + curvature_a ], W^a = g^-1 eta^a, m^ab = eta^a(W^b)",
            r"m^{ab} \lambda_b = -\left[ W^a \cdot (f - \dot g \dot q - \dot A) + \text{curvature}^a \right], \quad
              W^a = g^{-1} \eta^a, \quad m^{ab} = \eta^a(W^b)",
        ];
        Section {
            title: "Constraints",
            equation,
            items,
        }
    }

    fn surfaces(&mut self) -> Section {
        let mut items = Vec::new();
        for s in 0..self.derivation.surfaces.len() {
            let name = self.model.surfaces[s].name.display.clone();
            let law = self.model.surfaces[s].law.text(&self.model.pool);
            let surface = &self.derivation.surfaces[s];
            let (gap, form, rate) = (surface.gap, surface.form.clone(), surface.rate);
            let conditions = surface.conditions.clone();
            items.push(Item::Words(format!("surface {name}: {law}")));
            let subscript = format!("_{{\\text{{{}}}}}", escape(&name));
            items.push(self.formula(format!("h[{name}]"), format!("h{subscript}"), gap));
            let row = form.iter().map(|&entry| self.print(entry)).collect();
            items.push(Item::Matrix {
                left: [format!("dh[{name}]"), format!("dh{subscript}")],
                rows: vec![row],
            });
            if !self.is_zero(rate) {
                items.push(self.formula(
                    format!("d_t h[{name}]"),
                    format!("\\partial_t h{subscript}"),
                    rate,
                ));
            }
            for condition in conditions {
                items.push(self.formula(
                    format!("when[{name}]"),
                    format!("\\text{{when}}{subscript}"),
                    condition,
                ));
            }
        }
        Section {
            title: "Impacts",
            equation: [
                "p+ = p + eps pi_D^* dh",
                r"p^+ = p + \epsilon\, \pi_D^*\, dh",
            ],
            items,
        }
    }

    fn declared_outputs(&mut self) -> Section {
        let outputs: Vec<_> = self
            .model
            .outputs
            .iter()
            .map(|output| (output.name.display.clone(), output.value))
            .collect();
        let items = outputs
            .into_iter()
            .map(|(name, value)| {
                let latex = format!("\\text{{{}}}", escape(&name));
                self.formula(name, latex, value)
            })
            .collect();
        Section::plain("Outputs", items)
    }
}

/// Underscores as LaTeX text wants them.
fn escape(name: &str) -> String {
    name.replace('_', "\\_")
}

/// Operation counts of the emitted functions.
fn work(model: &Model, program: &Program) -> Section {
    let line = |name: &str, cost: &Cost| Item::Words(format!("{name}: {cost}"));
    let mut items = vec![
        line("rate", &program.rate.cost),
        line("energy", &program.energy.cost),
    ];
    if let Some(constrained) = &program.constrained {
        items.push(line("multipliers", &constrained.multipliers.cost));
        items.push(line("projection after a step", &constrained.restore.cost));
    }
    if let Some(impacting) = &program.impacting {
        items.push(line("all gaps", &impacting.gaps.cost));
        for (surface, contact) in model.surfaces.iter().zip(&impacting.contacts) {
            items.push(line(
                &format!("impact on {}", surface.name.display),
                &contact.cost,
            ));
        }
    }
    if let Some(volume) = &program.volume {
        items.push(line("density of the volume", &volume.log_density.cost));
    }
    Section::plain("Work of the emitted functions", items)
}

/// The verdicts on what is claimed.
fn claims(findings: &[Finding]) -> Section {
    let items = findings.iter().map(|own| Item::Words(own.note())).collect();
    Section::plain("Claims", items)
}

fn notes(model: &Model) -> Section {
    let items = model.notes.iter().cloned().map(Item::Words).collect();
    Section::plain(Section::NOTES, items)
}
