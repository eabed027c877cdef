//! The sections of a report that contain expressions.

use dalembert_expr::ExprId;

use super::{Item, Section};
use crate::mechanics::Derivation;
use crate::model::{self, Beside, Model, Topology};

/// Writes the sections of a model.
pub(super) struct Writer<'a> {
    pub(super) model: &'a mut Model,
    pub(super) derivation: &'a Derivation,
}

impl Writer<'_> {
    pub(super) fn print(&mut self, expression: ExprId) -> [String; 2] {
        let tidy = self.model.pool.simplify(expression);
        [self.model.pool.text(tidy), self.model.pool.latex(tidy)]
    }

    pub(super) fn formula(
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

    pub(super) fn is_zero(&self, expression: ExprId) -> bool {
        self.model.pool.is_syntactic_zero(expression)
    }

    /// Symbol of a coordinate, as text and as LaTeX.
    pub(super) fn coordinate(&mut self, i: usize) -> [String; 2] {
        let symbol = self.model.coordinates[i].q;
        let expression = self.model.pool.variable(symbol);
        self.print(expression)
    }

    pub(super) fn declared(&mut self) -> Section {
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
            items.push(Item::Words(match parameter.is_input {
                true => format!("input {name}"),
                false => format!("parameter {name}{demand}{}", default.unwrap_or_default()),
            }));
        }
        Section::plain("Declared", items)
    }

    pub(super) fn lagrangian(&mut self) -> Section {
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

    /// The declared rates of a first-order system.
    pub(super) fn rates(&mut self, rates: &[ExprId]) -> Section {
        let mut items = Vec::new();
        for (i, &rate) in rates.iter().enumerate() {
            let [name, latex] = self.coordinate(i);
            items.push(self.formula(format!("dot({name})"), format!("\\dot{{{latex}}}"), rate));
        }
        Section {
            title: "Field",
            equation: ["qdot = f(t, q)", r"\dot q = f(t, q)"],
            items,
        }
    }

    pub(super) fn motion(&mut self) -> Section {
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

    pub(super) fn constraints(&mut self) -> Section {
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
            if let Some(phi) = self.model.constraints[a].nonlinear {
                let [text, latex] = label("phi");
                items.push(self.formula(text, format!("\\{latex}"), phi));
            } else if !self.is_zero(affine) {
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

    pub(super) fn surfaces(&mut self) -> Section {
        let mut items = Vec::new();
        for s in 0..self.derivation.surfaces.len() {
            let name = self.model.surfaces[s].name.display.clone();
            let law = self.model.law_text(s);
            let surface = &self.derivation.surfaces[s];
            let (gap, form, rate) = (surface.gap, surface.form.clone(), surface.rate);
            let conditions = self.model.surfaces[s].conditions.clone();
            let is_otherwise = matches!(self.model.surfaces[s].beside, Beside::Otherwise(_));
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
                    condition.margin,
                ));
            }
            if is_otherwise {
                let text = format!("{name} counts where no other surface with this gap counts");
                items.push(Item::Words(text));
            }
            items.extend(self.reset(s, &name, &subscript));
            items.extend(self.instantaneous(s));
        }
        if self.model.is_first_order() {
            return Section::plain("Impacts", items);
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

    /// Formulas of a reset: one for each value that it sets.
    fn reset(&mut self, s: usize, name: &str, subscript: &str) -> Vec<Item> {
        let Some(reset) = self.model.surfaces[s].reset.clone() else {
            return Vec::new();
        };
        let replacements = reset.replacements(&self.model.coordinates);
        let formulas = replacements.into_iter().map(|(symbol, value)| {
            let variable = self.model.pool.variable(symbol);
            let [text, latex] = self.print(variable);
            self.formula(
                format!("{text}+[{name}]"),
                format!("{{{latex}}}^+{subscript}"),
                value,
            )
        });
        formulas.collect()
    }

    /// The instantaneous constraints of a surface, which hold only at impacts on it and in contact with it.
    fn instantaneous(&mut self, s: usize) -> Vec<Item> {
        let derivation = self.derivation;
        let mut items = Vec::new();
        for b in 0..derivation.surfaces[s].instantaneous.len() {
            let name = self.model.surfaces[s].instantaneous[b].name.display.clone();
            let surface = &derivation.surfaces[s].instantaneous[b];
            let row = surface
                .form
                .iter()
                .map(|&entry| self.print(entry))
                .collect();
            let superscript = format!("^{{\\text{{{}}}}}", escape(&name));
            items.push(Item::Matrix {
                left: [format!("psi[{name}]"), format!("\\psi{superscript}")],
                rows: vec![row],
            });
            for (label, value) in [("psi_0", surface.affine), ("curvature", surface.curvature)] {
                if !self.is_zero(value) {
                    let latex = match label {
                        "psi_0" => format!("\\psi_0{superscript}"),
                        _ => format!("\\text{{curvature}}{superscript}"),
                    };
                    items.push(self.formula(format!("{label}[{name}]"), latex, value));
                }
            }
        }
        if !items.is_empty() {
            let words = "before the law: p' = p + nu_b pi_D^* psi^b with psi(qdot') + psi_0 = 0; then the law with \
                         ker(eta, psi) for D, if dh(qdot') + d_t h < 0";
            items.push(Item::Words(words.to_owned()));
        }
        items
    }

    pub(super) fn declared_outputs(&mut self) -> Section {
        let outputs: Vec<_> = self
            .model
            .outputs
            .iter()
            .map(|output| {
                (
                    output.name.display.clone(),
                    output.is_integral,
                    output.value,
                )
            })
            .collect();
        let items = outputs
            .into_iter()
            .map(|(name, is_integral, value)| {
                let latex = format!("\\text{{{}}}", escape(&name));
                match is_integral {
                    true => {
                        self.formula(format!("d/dt {name}"), format!("\\dot{{{latex}}}"), value)
                    }
                    false => self.formula(name, latex, value),
                }
            })
            .collect();
        Section::plain("Outputs", items)
    }
}

/// The name with its underscores escaped for LaTeX.
pub(super) fn escape(name: &str) -> String {
    name.replace('_', "\\_")
}
