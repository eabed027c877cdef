//! Requests for derivations about functions or fields. A request consists of claims that name the functions or fields.

use dalembert_expr::ExprId;
use proc_macro2::{Span, TokenStream};

use super::{Report, ReportError, Section, Tree, tokens};
use crate::diagnostics::{Diagnostics, Location};
use crate::mechanics::{Derivation, derive};
use crate::model::{Model, StatedFunction, Statement, check_modes, check_within};
use crate::refuse_exhausted;
use crate::spec::{self, Declaration};
use crate::tables::text_of;

/// A model or a mode, with the statements requested of it.
pub(super) struct Asked {
    pub(super) model: Model,
    pub(super) derivation: Derivation,
    pub(super) statements: Vec<Statement>,
    /// The claims as written.
    pub(super) texts: Vec<String>,
    name: String,
}

impl Asked {
    /// Reads a declaration and resolves `claims` about it instead of its own. `part` names a scene or a mode; `None` is
    /// the model itself.
    ///
    /// # Errors
    /// [`ReportError`], also for a model with modes if no mode is named.
    pub(super) fn of(
        source: &str,
        part: Option<&str>,
        claims: &[String],
    ) -> Result<Self, ReportError> {
        let declaration = super::declaration(source)?.without_claims();
        let claims = claims.iter().map(|claim| tokens(claim));
        let claims = claims.collect::<Result<Vec<TokenStream>, _>>()?;
        Self::resolved(declaration, part, claims).map_err(ReportError::Declaration)
    }

    fn resolved(
        declaration: Declaration,
        part: Option<&str>,
        claims: Vec<TokenStream>,
    ) -> Result<Self, Diagnostics> {
        let (spec, mut model, name) = match declaration {
            Declaration::Model(mut spec) => {
                add(&mut spec, claims)?;
                let model = check_within(&spec, spec::STEPS)?;
                let scene = model
                    .scenes
                    .iter()
                    .position(|scene| Some(&*scene.name) == part);
                let name = scene.map_or(&model.snake_name, |scene| &model.scenes[scene].name);
                let (name, claims) = (name.clone(), model.claims.clone());
                let model = match scene {
                    Some(scene) => model.in_scene(scene),
                    None => model,
                };
                (*spec, Model { claims, ..model }, name)
            }
            Declaration::Modes(mut modes) => {
                let named = |mode: &spec::Mode| Some(&*mode.name.text) == part;
                let Some(mode) = modes.modes.iter().position(named) else {
                    let mut mistakes = Diagnostics::new();
                    let first = &modes.modes[0];
                    mistakes
                        .error(first.spec.name.at, "each mode has equations of its own")
                        .help(format!("name a mode, such as `{}`", first.name.text));
                    return Err(mistakes);
                };
                add(&mut modes.modes[mode].spec, claims)?;
                let mut graph = check_modes(&modes)?;
                let name = modes.modes[mode].name.text.clone();
                let spec = modes.modes.swap_remove(mode).spec;
                (spec, graph.modes.swap_remove(mode).model, name)
            }
        };
        let derivation = derive(&mut model);
        refuse_exhausted(&spec, &model)?;
        model.pool.lift_budget();
        let claims = model.claims.drain(..);
        let (statements, texts) = claims.map(|claim| (claim.statement, claim.text)).unzip();
        Ok(Self {
            model,
            derivation,
            statements,
            texts,
            name,
        })
    }

    /// The functions of the claim, if it is a single claim of involution.
    pub(super) fn functions(&self) -> Vec<StatedFunction> {
        match self.statements.as_slice() {
            [Statement::Involution(functions)] => functions.clone(),
            _ => Vec::new(),
        }
    }

    /// Rejects a list that is empty or contains semicolons. `example` is a valid list for the help line.
    ///
    /// # Errors
    /// [`ReportError`] with the mistake.
    pub(super) fn check_list(list: &str, example: &str) -> Result<(), ReportError> {
        let text = match list.trim() {
            "" => "the list is empty",
            list if list.contains(';') => "`;` does not separate the entries of a list",
            _ => return Ok(()),
        };
        let help = format!("write a list with commas: `{example}`");
        Err(Self::refusal(text, &help))
    }

    /// An error about a request, with a help line unless `help` is empty.
    pub(super) fn refusal(text: impl Into<String>, help: &str) -> ReportError {
        let mut mistakes = Diagnostics::new();
        let at = Location::from(Span::call_site());
        let error = mistakes.error(at, text);
        if !help.is_empty() {
            error.help(help);
        }
        ReportError::Declaration(mistakes)
    }

    /// A report with these sections. Empty ones are left out.
    pub(super) fn report(self, mut sections: Vec<Section>) -> Report {
        sections.retain(|section| !section.items.is_empty());
        Report {
            name: self.name,
            documentation: text_of(&self.model.documentation),
            sections,
            findings: Vec::new(),
            certificate: Tree::Absent,
            scenes: Vec::new(),
            has_modes: false,
        }
    }
}

/// All modes of a model, each with the requested fields. A model without modes has one entry.
pub(super) struct Whole {
    pub(super) modes: Vec<Fielded>,
}

/// A mode with the requested fields.
pub(super) struct Fielded {
    pub(super) model: Model,
    pub(super) derivation: Derivation,
    pub(super) fields: Vec<Vec<ExprId>>,
    /// Name of the mode; `None` for a model without modes.
    pub(super) name: Option<String>,
}

impl Whole {
    /// Reads a declaration with fields in place of its claims. `fields` returns the texts of the fields on a mode,
    /// given its coordinates; `None` is the field 0.
    ///
    /// # Errors
    /// [`ReportError`] with the mistakes.
    pub(super) fn of(
        source: &str,
        part: Option<&str>,
        fields: &dyn Fn(&[String]) -> Vec<Option<String>>,
    ) -> Result<Self, ReportError> {
        let declared = match super::declaration(source)?.without_claims() {
            Declaration::Modes(modes) if part.is_none() => modes,
            Declaration::Modes(_) => {
                return Err(Asked::refusal(
                    "symmetries are proved for all modes together",
                    "leave out --scene",
                ));
            }
            Declaration::Model(_) => {
                let claims: Vec<String> = fields(&[]).into_iter().flatten().collect();
                let asked = Asked::of(source, part, &claims)?;
                let fields = asked.statements.iter().filter_map(field).collect();
                return Ok(Self {
                    modes: vec![Fielded {
                        model: asked.model,
                        derivation: asked.derivation,
                        fields,
                        name: None,
                    }],
                });
            }
        };
        Self::of_modes(declared, fields)
    }

    fn of_modes(
        mut declared: spec::Modes,
        fields: &dyn Fn(&[String]) -> Vec<Option<String>>,
    ) -> Result<Self, ReportError> {
        let graph = check_modes(&declared).map_err(ReportError::Declaration)?;
        let mut given = Vec::new();
        for (mode, checked) in declared.modes.iter_mut().zip(&graph.modes) {
            let coordinates: Vec<String> = (checked.model.coordinates.iter())
                .map(|coordinate| coordinate.name.display.clone())
                .collect();
            let claims = fields(&coordinates);
            for claim in claims.iter().flatten() {
                add(&mut mode.spec, vec![tokens(claim)?]).map_err(ReportError::Declaration)?;
            }
            given.push(claims);
        }
        let graph = check_modes(&declared).map_err(ReportError::Declaration)?;
        let mut modes = Vec::new();
        let checked = declared.modes.iter().zip(graph.modes).zip(given);
        for ((written, mode), claims) in checked {
            let mut model = mode.model;
            let derivation = derive(&mut model);
            refuse_exhausted(&written.spec, &model).map_err(ReportError::Declaration)?;
            model.pool.lift_budget();
            let zeros = vec![model.pool.zero(); model.coordinates.len()];
            let statements: Vec<Statement> = model
                .claims
                .drain(..)
                .map(|claim| claim.statement)
                .collect();
            let mut resolved = statements.iter().filter_map(field);
            let fields = claims.iter().map(|claim| {
                let stated = claim.as_ref().and_then(|_| resolved.next());
                stated.unwrap_or_else(|| zeros.clone())
            });
            modes.push(Fielded {
                fields: fields.collect(),
                model,
                derivation,
                name: Some(written.name.text.clone()),
            });
        }
        Ok(Self { modes })
    }
}

/// The vector field of a claim of symmetry.
fn field(statement: &Statement) -> Option<Vec<ExprId>> {
    match statement {
        Statement::Symmetry(field) => Some(field.clone()),
        _ => None,
    }
}

fn add(spec: &mut spec::Spec, claims: Vec<TokenStream>) -> Result<(), Diagnostics> {
    claims
        .into_iter()
        .try_for_each(|claim| spec::add_claim(spec, claim))
}
