//! Certificate of the claims for an independent checker: the declaration in coordinates, and each verdict with its
//! grounds.
//!
//! Expressions are texts of the language: `+ - * / ^`, the functions of `docs/language.md`, names of coordinates and
//! parameters, velocities `dot(x)`, `energy`, `momentum(x)` and `t`. The density that was found is the only derived
//! quantity; a checker derives the motion by itself.

use dalembert_expr::ExprId;

use crate::claims::{ClosedForm, Finding, Sample, Term, Verdict};
use crate::model::{
    Assumption, Beside, Claim, Condition, Constraint, Coordinate, Existence, Model, Parameter,
    Statement, Surface, Topology, Transition,
};

/// The version of the format.
pub const FORMAT: &str = "dalembert certificate 2";

/// A value of a certificate.
#[derive(Debug, Clone, PartialEq)]
pub enum Tree {
    /// Nothing.
    Absent,
    /// Yes or no.
    Flag(bool),
    /// A number.
    Number(f64),
    /// An integer.
    Integer(u64),
    /// Words, or an expression.
    Text(String),
    /// Several values.
    List(Vec<Tree>),
    /// Values with names.
    Record(Vec<(&'static str, Tree)>),
}

impl Tree {
    fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    fn list(values: impl Iterator<Item = Tree>) -> Self {
        Self::List(values.collect())
    }
}

/// The certificate of a model, a scene or a mode, with the verdicts on `claims` in order.
pub(super) fn certificate(model: &Model, claims: &[Claim], findings: &[Finding]) -> Tree {
    let writer = Writer { model };
    Tree::Record(vec![
        ("coordinates", writer.coordinates()),
        ("parameters", writer.parameters()),
        ("motion", writer.motion()),
        ("constraints", writer.constraints(&model.constraints)),
        ("surfaces", writer.surfaces()),
        ("density", writer.stated()),
        ("claims", writer.claims(claims, findings)),
    ])
}

/// Names and values of a state.
fn point(sample: &Sample) -> Tree {
    let pair = |(name, value): &(String, f64)| {
        Tree::List(vec![Tree::text(name.clone()), Tree::Number(*value)])
    };
    Tree::list(sample.values.iter().map(pair))
}

struct Writer<'m> {
    model: &'m Model,
}

impl Writer<'_> {
    fn expression(&self, id: ExprId) -> Tree {
        Tree::Text(self.model.pool.text(id))
    }

    fn expressions(&self, ids: &[ExprId]) -> Tree {
        Tree::list(ids.iter().map(|id| self.expression(*id)))
    }

    fn optional(&self, id: Option<ExprId>) -> Tree {
        id.map_or(Tree::Absent, |id| self.expression(id))
    }

    fn coordinates(&self) -> Tree {
        let entry = |coordinate: &Coordinate| {
            let (kind, low, high) = match coordinate.topology {
                Topology::Line => ("line", None, None),
                Topology::Angle => ("angle", None, None),
                Topology::Interval { low, high } => ("interval", Some(low), Some(high)),
            };
            Tree::Record(vec![
                (
                    "name",
                    Tree::text(self.model.pool.symbol_name(coordinate.q)),
                ),
                ("kind", Tree::text(kind)),
                ("low", self.optional(low)),
                ("high", self.optional(high)),
            ])
        };
        Tree::list(self.model.coordinates.iter().map(entry))
    }

    fn parameters(&self) -> Tree {
        let entry = |parameter: &Parameter| {
            let assumption = match &parameter.assumption {
                Assumption::Finite => Tree::text("finite"),
                Assumption::Positive => Tree::text("positive"),
                Assumption::NonNegative => Tree::text("nonnegative"),
                Assumption::NonZero => Tree::text("nonzero"),
                Assumption::Within { low, high } => Tree::List(vec![
                    Tree::text(low.to_string()),
                    Tree::text(high.to_string()),
                ]),
            };
            Tree::Record(vec![
                (
                    "name",
                    Tree::text(self.model.pool.symbol_name(parameter.symbol)),
                ),
                ("assumption", assumption),
                ("default", self.optional(parameter.default)),
                ("is_input", Tree::Flag(parameter.is_input)),
            ])
        };
        Tree::list(self.model.parameters.iter().map(entry))
    }

    /// `rates` of a first-order system; else `1/2 g(qdot, qdot) + A(qdot) - V` and the forces.
    fn motion(&self) -> Tree {
        let lagrangian = &self.model.lagrangian;
        if let Some(rates) = &self.model.field {
            return Tree::Record(vec![("rates", self.expressions(rates))]);
        }
        let forces = self
            .model
            .forces
            .iter()
            .map(|force| self.expressions(&force.form));
        Tree::Record(vec![
            (
                "metric",
                Tree::list(lagrangian.metric.iter().map(|row| self.expressions(row))),
            ),
            ("linear", self.expressions(&lagrangian.linear)),
            ("potential", self.expression(lagrangian.potential)),
            ("forces", Tree::list(forces)),
        ])
    }

    fn constraints(&self, constraints: &[Constraint]) -> Tree {
        let entry = |constraint: &Constraint| {
            Tree::Record(vec![
                ("name", Tree::text(constraint.name.display.clone())),
                ("form", self.expressions(&constraint.form)),
                ("affine", self.expression(constraint.affine)),
                ("nonlinear", self.optional(constraint.nonlinear)),
                (
                    "position",
                    self.optional(constraint.level.filter(|_| constraint.is_of_positions)),
                ),
            ])
        };
        Tree::list(constraints.iter().map(entry))
    }

    fn surfaces(&self) -> Tree {
        let entry = |surface: &Surface| {
            let symbols = self.model.coordinates.iter();
            let reset = surface.reset.as_ref().map(|reset| {
                let mut after: Vec<Tree> = Vec::new();
                for (given, symbol) in reset
                    .q
                    .iter()
                    .zip(symbols.clone().map(|coordinate| coordinate.q))
                {
                    after.push(self.after(*given, symbol));
                }
                for (given, symbol) in reset
                    .qdot
                    .iter()
                    .zip(symbols.clone().map(|coordinate| coordinate.qdot))
                {
                    after.push(self.after(*given, symbol));
                }
                Tree::List(after)
            });
            let margins = surface
                .conditions
                .iter()
                .map(|condition| self.expression(condition.margin));
            Tree::Record(vec![
                ("name", Tree::text(surface.name.display.clone())),
                ("gap", self.expression(surface.gap)),
                ("when", Tree::list(margins)),
                ("law", Tree::text(surface.law.name())),
                ("coefficient", self.optional(surface.law.coefficient())),
                ("reset", reset.unwrap_or(Tree::Absent)),
                ("instantaneous", self.constraints(&surface.instantaneous)),
                ("excluded", self.excluded(&surface.beside)),
                ("transition", self.transition(surface.transition.as_ref())),
            ])
        };
        Tree::list(self.model.surfaces.iter().map(entry))
    }

    /// Lists of functions. The surface counts only where each list contains a negative function.
    fn excluded(&self, beside: &Beside) -> Tree {
        let lists = match beside {
            Beside::Otherwise(lists) => lists.as_slice(),
            // The last of several transitions counts by its own conditions.
            Beside::Last(_) | Beside::Independent => &[],
        };
        let list = |list: &Vec<Condition>| {
            let margins = list.iter().map(|condition| condition.margin);
            self.expressions(&margins.collect::<Vec<_>>())
        };
        Tree::list(lists.iter().map(list))
    }

    /// The mode that is entered, which is another part of the document, and the declared state with which it is
    /// entered.
    fn transition(&self, transition: Option<&Transition>) -> Tree {
        let Some(transition) = transition else {
            return Tree::Absent;
        };
        let state = transition.map.as_ref().map(|map| {
            Tree::Record(vec![
                ("q", self.expressions(&map.q)),
                ("qdot", self.expressions(&map.qdot)),
            ])
        });
        Tree::Record(vec![
            ("enters", Tree::text(transition.mode.clone())),
            ("state", state.unwrap_or(Tree::Absent)),
            ("keeps_lagrangian", Tree::Flag(transition.keeps_lagrangian)),
        ])
    }

    fn after(&self, given: Option<ExprId>, symbol: dalembert_expr::SymbolId) -> Tree {
        match given {
            Some(value) => self.expression(value),
            None => Tree::text(self.model.pool.symbol_name(symbol)),
        }
    }

    fn claims(&self, claims: &[Claim], findings: &[Finding]) -> Tree {
        let entries = claims.iter().zip(findings).map(|(claim, finding)| {
            let mut entry = vec![
                ("claim", Tree::text(finding.claim.clone())),
                ("verdict", Tree::text(finding.word())),
                ("grounds", Tree::text(finding.grounds())),
            ];
            entry.extend(self.statement(&claim.statement));
            if let Verdict::Proved(proof) = &finding.verdict {
                let primes = proof.primes.iter().map(|prime| Tree::Integer(*prime));
                entry.push(("points", Tree::Integer(proof.points as u64)));
                entry.push(("primes", Tree::list(primes)));
                entry.push(("chance_of_error", Tree::Number(proof.error)));
                entry.push(("at", proof.at.as_ref().map_or(Tree::Absent, point)));
                entry.push(("seed", Tree::text(format!("{:#018x}", proof.seed))));
            }
            if let Some(density) = &finding.density {
                entry.push(("density", self.density(density)));
            }
            Tree::Record(entry)
        });
        Tree::list(entries)
    }

    fn statement(&self, statement: &Statement) -> Vec<(&'static str, Tree)> {
        match statement {
            Statement::Existence(existence) => {
                let kind = match existence {
                    Existence::Global => "exact",
                    Existence::Local => "locally_exact",
                    Existence::None => "no_density",
                };
                vec![("kind", Tree::text(kind))]
            }
            Statement::Density(value) => vec![
                ("kind", Tree::text("density")),
                ("value", self.expression(*value)),
            ],
            Statement::Conserved {
                value,
                under,
                holds,
            } => vec![
                ("kind", Tree::text("conserved")),
                ("value", self.expression(*value)),
                (
                    "under",
                    under.map_or(Tree::Absent, |index| Tree::Integer(index as u64)),
                ),
                ("holds", Tree::Flag(*holds)),
            ],
            Statement::VolumeKept => {
                vec![("kind", Tree::text("volume_kept"))]
            }
            Statement::Factor { value, under } => vec![
                ("kind", Tree::text("factor")),
                ("value", self.expression(*value)),
                ("under", Tree::Integer(*under as u64)),
            ],
            Statement::Invariant(form) => {
                let terms = form.terms.iter().map(|term| {
                    Tree::Record(vec![
                        ("coefficient", self.expression(term.coefficient)),
                        ("differentials", self.expressions(&term.differentials)),
                    ])
                });
                vec![
                    ("kind", Tree::text("invariant_form")),
                    ("terms", Tree::list(terms)),
                ]
            }
            Statement::Involution(_) => vec![
                ("kind", Tree::text("involution")),
                ("values", self.expressions(&statement.expressions())),
            ],
            Statement::Integrable(_) => vec![
                ("kind", Tree::text("integrable")),
                ("values", self.expressions(&statement.expressions())),
            ],
            Statement::Symplectic => vec![("kind", Tree::text("symplectic"))],
            Statement::EnergyNotIncreasing(under) => vec![
                ("kind", Tree::text("energy_not_increasing")),
                ("under", Tree::Integer(*under as u64)),
            ],
            Statement::Symmetry(field) => vec![
                ("kind", Tree::text("symmetry")),
                ("field", self.expressions(field)),
            ],
        }
    }

    /// The density of the first claim `density = ..` about the model or mode.
    fn stated(&self) -> Tree {
        let mut claims = self
            .model
            .claims
            .iter()
            .filter(|claim| claim.scene.is_none());
        self.optional(claims.find_map(|claim| match claim.statement {
            Statement::Density(value) => Some(value),
            _ => None,
        }))
    }

    /// The terms of G, and the columns of the determinant `det A_dep`, which a term may name.
    fn density(&self, density: &ClosedForm) -> Tree {
        let terms = density.potential.terms.iter().map(|(coefficient, term)| {
            let (kind, of) = match term {
                Term::MassDeterminant => ("mass_determinant", None),
                Term::MetricDeterminant => ("metric_determinant", None),
                Term::DependentDeterminant => ("dependent_determinant", None),
                Term::Logarithm(of) => ("logarithm", Some(*of)),
                Term::Plain(of) => ("plain", Some(*of)),
            };
            Tree::Record(vec![
                ("coefficient", self.expression(*coefficient)),
                ("kind", Tree::text(kind)),
                ("of", self.optional(of)),
            ])
        });
        let dependent = density
            .dependent
            .iter()
            .map(|index| Tree::Integer(*index as u64));
        Tree::Record(vec![
            ("terms", Tree::list(terms)),
            ("dependent", Tree::list(dependent)),
        ])
    }
}
