//! First-order systems: the rate of every coordinate in place of a Lagrangian.
//!
//! Refuses declarations that belong to mechanics: constraints, forces, frames, impulses at surfaces, assignments to
//! velocities, projection and volume in scenes, and claims about energy, brackets or the existence of a density.

use dalembert_expr::{ExprId, Pool};

use super::super::Lagrangian;
use super::super::resolve::{Resolver, Scope};
use super::RATES;
use super::targets::Section;
use crate::diagnostics::{Location, listed};
use crate::spec::{
    self, AssignmentTarget, Declared, InitialTarget, ItemId, RESET, Rate, STOP, Statement,
};

const NONE: &str = "a first-order system has no";

/// The rate of every coordinate, in their order; `None` if one is missing.
pub(super) fn resolve(resolver: &mut Resolver<'_>) -> Option<Vec<ExprId>> {
    let field = resolver.spec.field.as_ref()?;
    let count = resolver.symbols.coordinates.len();
    let mut rates: Vec<Option<ExprId>> = vec![None; count];
    let mut given: Vec<Option<Location>> = vec![None; count];
    for rate in &field.rates {
        for (index, scope) in resolver.targets(&rate.declared, &Scope::default(), Section::Field) {
            let at = rate.declared.name.at;
            if let Some(first) = given[index].replace(at) {
                refuse_second(resolver, index, at, first);
            }
            rates[index] = resolver.rate(rate, scope);
            if rates[index].is_none() {
                break;
            }
        }
    }
    let errors = !resolver.diagnostics.is_empty();
    let missing = (0..count).filter(|&index| given[index].is_none());
    let missing: Vec<String> = missing
        .map(|index| resolver.symbols.coordinates[index].name.display.clone())
        .collect();
    if let (Some(first), false) = (missing.first(), errors) {
        let text = format!(
            "the rate of {} is not given",
            listed(missing.iter().map(String::as_str))
        );
        let help = format!("write `dot({first}) = ..;`");
        let at = resolver.spec.location(field.item);
        resolver.refuse::<()>(at, text, &help);
    }
    rates.into_iter().collect()
}

/// Placeholder Lagrangian with the identity as metric, because the lowering of every model needs one. It does not
/// appear in the emitted code.
pub(super) fn euclidean(pool: &mut Pool, size: usize, item: ItemId) -> Lagrangian {
    let (zero, one) = (pool.zero(), pool.one());
    let row = |i: usize| (0..size).map(|j| if i == j { one } else { zero }).collect();
    Lagrangian {
        whole: zero,
        metric: (0..size).map(row).collect(),
        linear: vec![zero; size],
        potential: zero,
        item,
    }
}

fn refuse_second(resolver: &mut Resolver<'_>, index: usize, at: Location, first: Location) {
    let name = &resolver.symbols.coordinates[index].name.display;
    let text = format!("the rate of `{name}` is given again");
    let error = resolver.diagnostics.error(at, text);
    error
        .help("keep one of the two")
        .also(first, "first given here");
}

/// Refuses declarations that a first-order system cannot have.
pub(super) fn check_alone(resolver: &mut Resolver<'_>) {
    let spec = resolver.spec;
    let Some(field) = &spec.field else {
        return;
    };
    if let Some(lagrangian) = &spec.lagrangian {
        let at = spec.location(lagrangian.item);
        let text = "a model has a `lagrangian` or a `field`, not both";
        let error = resolver.diagnostics.error(spec.location(field.item), text);
        error
            .help("keep one of the two")
            .also(at, "the Lagrangian is here");
    }
    let rates = "write its effect into the rates of `field`";
    let entries = [
        (
            "constraints",
            spec.constraints
                .first()
                .map(|constraint| &constraint.declared),
        ),
        ("forces", spec.forces.first().map(|force| &force.declared)),
        ("frame", spec.frame.first().map(|force| &force.declared)),
    ];
    for (what, declared) in entries {
        if let Some(Declared { name, .. }) = declared {
            resolver.refuse::<()>(name.at, format!("{NONE} {what}"), rates);
        }
    }
    for entry in &spec.initial {
        if entry.target == InitialTarget::Velocity {
            refuse_velocity(resolver, &entry.declared);
        }
    }
    for part in spec.scenes.iter().flat_map(|scene| &scene.parts) {
        if ["volume", "projection"].contains(&part.name.text.as_str()) {
            let text = format!("{NONE} `{}`", part.name.text);
            resolver.refuse::<()>(part.name.at, text, "leave it out");
        }
    }
    for claim in &spec.claims {
        let (what, help) = match claim.statement {
            Statement::Conserved { .. }
            | Statement::Density(_)
            | Statement::VolumeKept
            | Statement::Symmetry(_)
            | Statement::Invariant(_)
            | Statement::Factor { .. } => continue,
            Statement::Existence(_) => (
                "claim on the existence of a density",
                "state one: `density = ..;`",
            ),
            Statement::Involution(_) | Statement::Integrable(_) => {
                ("bracket", "write `conserved: ..;` for each function")
            }
            Statement::Symplectic => ("symplectic form", "write `volume: kept;`"),
            Statement::EnergyNotIncreasing(_) => ("`energy`", "leave it out"),
        };
        let at = spec.location(claim.item);
        resolver.refuse::<()>(at, format!("{NONE} {what}"), help);
    }
}

/// Refuses laws that are impulses, and resets of velocities.
pub(super) fn check_surfaces(resolver: &mut Resolver<'_>) {
    let spec = resolver.spec;
    if spec.field.is_none() {
        return;
    }
    // A transition without a reset keeps the state.
    let takes_reset = |surface: &&spec::Surface| surface.enters.is_none() || surface.law.is_some();
    for surface in spec.surfaces.iter().filter(takes_reset) {
        match &surface.law {
            Some(law) if law.name.text == STOP => {}
            Some(law) if law.name.text == RESET => {
                for entry in law.assignments.iter().flatten() {
                    if entry.target == AssignmentTarget::Velocity {
                        refuse_velocity(resolver, &entry.declared);
                    }
                }
            }
            law => {
                let at = law
                    .as_ref()
                    .map_or(surface.declared.name.at, |law| law.name.at);
                let text = format!(
                    "{NONE} impulses: `{}` takes a reset or a stop",
                    surface.declared.name.text
                );
                resolver.refuse::<()>(at, text, "write `=> reset { x = ..; }` or `=> stop`");
            }
        }
    }
}

fn refuse_velocity(resolver: &mut Resolver<'_>, declared: &Declared) {
    let name = &declared.name;
    let text = format!("the rate of `{}` follows from `field`", name.text);
    resolver.refuse::<()>(name.at, text, &format!("give `{}` itself", name.text));
}

impl Resolver<'_> {
    /// The rate of a coordinate.
    fn rate(&mut self, rate: &Rate, mut scope: Scope) -> Option<ExprId> {
        let value = self.position_expression(&rate.value, &mut scope, RATES)?;
        self.check_periodic(&[&rate.value], &scope, value);
        self.within_budget(rate.value.at).then_some(value)
    }

    /// Refuses a name of mechanics in a first-order system.
    pub(in crate::model) fn refuse_without_mechanics<T>(
        &mut self,
        at: Location,
        name: &str,
    ) -> Option<T> {
        let text = format!("{NONE} `{name}`");
        self.refuse(at, text, "write it out in coordinates")
    }
}
