//! Rules of the language, one file per topic.
//!
//! Every declaration is resolved and checked by itself first. Rules for several declarations (ranks, surfaces against
//! constraints) then apply to those without errors. All independent errors are therefore reported.

mod at_defaults;
mod beside;
mod cancellation;
mod claims;
mod constraints;
mod coordinates;
mod cost;
mod exterior;
mod field;
mod frame;
mod initial;
mod inputs;
mod instantaneous;
mod integrable;
mod laws;
mod names;
mod nonlinear;
mod outputs;
mod parameters;
mod passages;
mod regular;
mod resets;
mod scenes;
mod start;
mod surfaces;
mod targets;
mod transitions;

use std::collections::BTreeSet;

use dalembert_expr::{ExprId, Function, Node, Pool, SymbolId};

use super::natural;
use super::resolve::{Resolver, Scope};
use super::transition::Peer;
use super::{
    Claim, Constraint, Cost, Extras, Force, Initial, Lagrangian, Model, Output, QuasiForm, Reset,
    Scene, Surface, Transition, View,
};
use crate::diagnostics::{self, Diagnostics};
use crate::spec::{PIECEWISE, STEPS, Scalar, Spec};
use names::Names;

/// Noun for the entries of `field`. They are the only functions of the position that take inputs.
const RATES: &str = "rates";

/// The declarations besides coordinates, parameters and definitions, resolved.
struct Parts {
    lagrangian: Option<Lagrangian>,
    field: Option<Vec<ExprId>>,
    constraints: Vec<Constraint>,
    cost: Option<Cost>,
    forces: Vec<Force>,
    frame: Vec<QuasiForm>,
    surfaces: Vec<Surface>,
    initial: Initial,
    view: Option<View>,
    outputs: Vec<Output>,
    scenes: Vec<Scene>,
    claims: Vec<Claim>,
}

/// Checks a declaration and resolves every name in it.
///
/// # Errors
/// All errors, each at the smallest part of the declaration that is wrong.
pub fn check(spec: &Spec) -> Result<Model, Diagnostics> {
    check_within(spec, STEPS)
}

/// Same as [`check()`], with a budget of `steps` for the algebra of this and later stages.
pub(crate) fn check_within(spec: &Spec, steps: u64) -> Result<Model, Diagnostics> {
    check_mode(spec, &[], steps)
}

/// Same as [`check()`], for one mode of a hybrid model. `modes` has the data of all modes.
pub(in crate::model) fn check_mode(
    spec: &Spec,
    modes: &[Peer],
    steps: u64,
) -> Result<Model, Diagnostics> {
    let mut resolver = Resolver::new(spec, steps);
    resolver.modes = modes;
    resolver.constants();
    resolver.all_coordinates();
    if spec.coordinates.is_empty() {
        // NOTE: every name of a coordinate would be reported as unknown.
        return Err(resolver.diagnostics);
    }
    resolver.all_parameters();
    resolver.check_columns();
    resolver.order_symbols();
    resolver.all_definitions();
    let lagrangian = lagrangian(&mut resolver);
    resolver.lagrangian = lagrangian.as_ref().map(|lagrangian| lagrangian.whole);
    let mut parts = Parts {
        lagrangian,
        field: field::resolve(&mut resolver),
        constraints: constraints::resolve(&mut resolver),
        cost: cost::resolve(&mut resolver),
        forces: forces(&mut resolver),
        frame: frame::resolve(&mut resolver),
        surfaces: surfaces::resolve(&mut resolver),
        initial: initial::resolve(&mut resolver),
        view: outputs::view(&mut resolver),
        outputs: outputs::resolve(&mut resolver),
        scenes: Vec::new(),
        claims: Vec::new(),
    };
    parts.scenes = scenes::resolve(&mut resolver, &parts.forces, &parts.surfaces);
    parts.claims = claims::resolve(&mut resolver, &parts.surfaces, &parts.scenes);
    transitions::mark_sides(&mut resolver, &mut parts.surfaces);
    beside::resolve(&mut resolver, &mut parts.surfaces);
    together(&mut resolver, &parts);
    if let Some(at) = resolver.exhausted {
        return Err(diagnostics::too_many_steps(at));
    }
    let (Some(lagrangian), true) = (parts.lagrangian, resolver.diagnostics.is_empty()) else {
        return Err(resolver.diagnostics);
    };
    let parts = Parts {
        lagrangian: None,
        ..parts
    };
    Ok(model(resolver, lagrangian, parts))
}

/// Data of a mode for the check of other modes. Errors in the mode are reported when the mode itself is checked.
pub(in crate::model) fn peer(name: &str, spec: &Spec) -> Peer {
    let mut resolver = Resolver::new(spec, STEPS);
    resolver.constants();
    resolver.all_coordinates();
    let coordinates = resolver.symbols.coordinates.iter();
    Peer {
        name: name.to_owned(),
        coordinates: coordinates
            .map(|coordinate| (coordinate.name.clone(), coordinate.topology))
            .collect(),
        is_first_order: spec.field.is_some(),
    }
}

/// Applies the rules for several declarations.
fn together(resolver: &mut Resolver<'_>, parts: &Parts) {
    if let (Some(lagrangian), Some(written), None) = (
        &parts.lagrangian,
        &resolver.spec.lagrangian,
        &resolver.spec.field,
    ) {
        natural::check_metric(resolver, &written.value, lagrangian);
        at_defaults::check(resolver, lagrangian, &parts.constraints);
        resolver.within_budget(written.value.at);
    }
    // NOTE: the rules below tolerate missing declarations, because refused constraints are not among `parts`.
    field::check_alone(resolver);
    field::check_surfaces(resolver);
    nonlinear::check_alone(resolver, &parts.constraints);
    let acted = inputs::Acted {
        forces: &parts.forces,
        field: parts.field.as_deref().unwrap_or_default(),
    };
    inputs::check_claims(resolver, &acted, &parts.scenes);
    constraints::check_independent(resolver, &parts.constraints);
    frame::check_coframe(resolver, &parts.frame, &parts.constraints);
    surfaces::check_reachable(resolver, &parts.surfaces, &parts.constraints);
    instantaneous::check_independent(resolver, &parts.surfaces, &parts.constraints);
    surfaces::check_distinct(resolver, &parts.surfaces);
    start::check(
        resolver,
        &parts.initial,
        &parts.surfaces,
        &parts.constraints,
    );
    resolver.within_budget(resolver.spec.name.at);
}

fn model(resolver: Resolver<'_>, lagrangian: Lagrangian, parts: Parts) -> Model {
    let notes = notes(&resolver, &lagrangian, &parts);
    let Resolver {
        spec,
        pool,
        symbols,
        ..
    } = resolver;
    let nonlinear = parts
        .constraints
        .iter()
        .any(|constraint| constraint.nonlinear.is_some());
    let extras = match parts.field {
        Some(_) => Extras {
            variations: true,
            ..Extras::default()
        },
        None => Extras {
            volume: !nonlinear,
            ..Extras::ALL
        },
    };
    Model {
        pool,
        name: spec.name.text.clone(),
        snake_name: spec.snake_name.clone(),
        visibility: spec.visibility.clone(),
        documentation: spec.documentation.clone(),
        source: spec.source.clone(),
        time: symbols.time,
        coordinates: symbols.coordinates,
        parameters: symbols.parameters,
        lagrangian,
        field: parts.field,
        constraints: parts.constraints,
        cost: parts.cost,
        forces: parts.forces,
        frame: parts.frame,
        surfaces: parts.surfaces,
        initial: parts.initial,
        view: parts.view,
        outputs: parts.outputs,
        scenes: parts.scenes,
        extras,
        claims: parts.claims,
        derived: symbols.derived,
        notes,
    }
}

fn notes(resolver: &Resolver<'_>, lagrangian: &Lagrangian, parts: &Parts) -> Vec<String> {
    let mut notes = natural::notes(resolver, lagrangian);
    notes.extend(integrable::notes(resolver, &parts.constraints));
    notes.extend(nonlinear::notes(&parts.constraints));
    notes.extend(cancellation::notes(resolver, lagrangian, parts));
    notes.extend(laws::notes(resolver, &parts.surfaces, &parts.constraints));
    notes.extend(passages::notes(
        resolver,
        &parts.surfaces,
        parts.field.as_deref(),
    ));
    notes.extend(beside::notes(resolver, &parts.surfaces));
    notes.extend(initial::notes(resolver, &parts.initial));
    notes.extend(parameters::unused(
        resolver,
        &used_symbols(&resolver.pool, lagrangian, parts),
    ));
    notes
}

/// The symbols that occur in any declaration.
fn used_symbols(pool: &Pool, lagrangian: &Lagrangian, parts: &Parts) -> BTreeSet<SymbolId> {
    // NOTE: the pattern names every field, so that a new declaration cannot be forgotten here.
    let Parts {
        lagrangian: _,
        field,
        constraints,
        cost,
        forces,
        frame,
        surfaces,
        initial,
        view,
        outputs,
        scenes: _,
        claims,
    } = parts;
    let mut used: Vec<ExprId> = vec![lagrangian.whole];
    used.extend(field.iter().flatten());
    for constraint in constraints {
        used.extend(constraint.expressions());
    }
    used.extend(cost.iter().flat_map(|cost| [cost.running, cost.terminal]));
    used.extend(forces.iter().flat_map(|force| &force.form));
    used.extend(frame.iter().flat_map(|entry| &entry.form));
    for surface in surfaces {
        used.extend(
            surface
                .margins()
                .chain([surface.gap])
                .chain(surface.law.coefficient())
                .chain(surface.reset.iter().flat_map(Reset::expressions))
                .chain(surface.transition.iter().flat_map(Transition::expressions))
                .chain(
                    surface
                        .instantaneous
                        .iter()
                        .flat_map(Constraint::expressions),
                ),
        );
    }
    used.extend(
        initial
            .q
            .iter()
            .chain(&initial.qdot)
            .chain([&initial.until])
            .flatten(),
    );
    used.extend(outputs.iter().map(|output| output.value));
    used.extend(
        claims
            .iter()
            .flat_map(|claim| claim.statement.expressions()),
    );
    used.extend(
        view.iter()
            .flat_map(|view| view.path.iter().copied().chain(view.region)),
    );
    used.into_iter()
        .flat_map(|expr| pool.symbols(expr))
        .collect()
}

fn lagrangian(resolver: &mut Resolver<'_>) -> Option<Lagrangian> {
    let spec = resolver.spec;
    if let Some(field) = &spec.field {
        let size = resolver.symbols.coordinates.len();
        return Some(field::euclidean(&mut resolver.pool, size, field.item));
    }
    let Some(declared) = &spec.lagrangian else {
        return resolver.refuse(
            spec.name.at,
            "a model needs a `lagrangian`",
            "write `lagrangian = m/2*dot(x)^2;`, or `field { dot(x) = ..; }` for a first-order system",
        );
    };
    let scope = Scope::default();
    let whole = resolver.expression(&declared.value, &mut scope.clone())?;
    let differentials = resolver.symbols.all_differentials();
    let help = "velocities are written `dot(x)`";
    resolver.forbid(
        &declared.value,
        &scope,
        whole,
        &differentials,
        "a Lagrangian contains no differentials",
        help,
    )?;
    resolver.forbid_abs(&declared.value, &scope, whole, "`lagrangian`")?;
    resolver.forbid_inputs(&declared.value, &scope, whole)?;
    resolver.check_periodic(&[&declared.value], &scope, whole);
    let lagrangian = natural::split(resolver, &declared.value, whole, declared.item);
    resolver
        .within_budget(declared.value.at)
        .then_some(lagrangian?)
}

fn forces(resolver: &mut Resolver<'_>) -> Vec<Force> {
    let spec = resolver.spec;
    let mut forces = Vec::new();
    let mut names = Names::new(resolver, "force");
    for force in &spec.forces {
        for (name, mut scope) in resolver.members(&force.declared) {
            names.add(resolver, &name, &force.declared.name);
            let Some(form) = resolver.force_form(force, &mut scope) else {
                continue;
            };
            resolver.within_budget(force.value.at);
            for coefficient in &form {
                resolver.check_periodic(&[&force.value], &scope, *coefficient);
            }
            forces.push(Force {
                name,
                form,
                item: force.item,
            });
        }
    }
    names.check_families(resolver);
    forces
}

impl Resolver<'_> {
    /// Creates the variables in the usual order of a product: parameters, coordinates, velocities. Symbols that are
    /// created first are printed first.
    fn order_symbols(&mut self) {
        let (parameters, coordinates) = (&self.symbols.parameters, &self.symbols.coordinates);
        let parameters = parameters.iter().map(|parameter| parameter.symbol);
        let positions = coordinates.iter().map(|coordinate| coordinate.q);
        let velocities = coordinates.iter().map(|coordinate| coordinate.qdot);
        for symbol in parameters.chain(positions).chain(velocities) {
            self.pool.variable(symbol);
        }
    }

    /// An expression of numbers and `pi`.
    fn constant_expression(&mut self, written: &Scalar, what: &str) -> Option<ExprId> {
        let mut scope = Scope::default();
        let expr = self.expression(written, &mut scope)?;
        let symbols = self.pool.symbols(expr);
        let text = format!("{what} is a constant");
        self.forbid(
            written,
            &scope,
            expr,
            &symbols,
            &text,
            "write numbers, `pi` and constants",
        )?;
        Some(expr)
    }

    /// The value of an expression without symbols.
    fn constant_value(&self, expr: ExprId) -> f64 {
        self.pool
            .eval(&[expr], &|_| f64::NAN)
            .first()
            .copied()
            .unwrap_or(f64::NAN)
    }

    /// An expression of the parameters.
    fn parameter_expression(
        &mut self,
        written: &Scalar,
        scope: &mut Scope,
        what: &str,
    ) -> Option<ExprId> {
        let expr = self.expression(written, scope)?;
        let moving = self.symbols.moving();
        let text = format!("{what} depends on parameters only");
        self.forbid(
            written,
            scope,
            expr,
            &moving,
            &text,
            "write numbers and parameters",
        )?;
        Some(expr)
    }

    /// An expression of `(t, q)`.
    fn position_expression(
        &mut self,
        written: &Scalar,
        scope: &mut Scope,
        what: &str,
    ) -> Option<ExprId> {
        let expr = self.expression(written, scope)?;
        let mut rates = self.symbols.velocities();
        rates.extend(self.symbols.all_differentials());
        let text = format!("{what} depend on position (and time) only");
        self.forbid(written, scope, expr, &rates, &text, "")?;
        if what != RATES {
            self.forbid_inputs(written, scope, expr)?;
        }
        Some(expr)
    }

    /// Refuses `abs`, which is not differentiable.
    fn forbid_abs(
        &mut self,
        written: &Scalar,
        scope: &Scope,
        expr: ExprId,
        place: &str,
    ) -> Option<()> {
        if !contains_abs(&self.pool, expr) {
            return Some(());
        }
        let part = self.culprit(written, scope, &|pool, expr| contains_abs(pool, expr));
        let text = format!("`{part}`: `abs` is not differentiable and not allowed in {place}");
        self.refuse(part.at, text, PIECEWISE)
    }
}

fn contains_abs(pool: &Pool, expr: ExprId) -> bool {
    pool.reachable(&[expr])
        .into_iter()
        .any(|id| matches!(pool.node(id), Node::Call(Function::Abs, _)))
}
