//! Claims at the declared defaults of parameters. A claim that holds for indeterminate parameters may fail at special
//! values.
//!
//! A default is an exact number. The decision is repeated with it, because the claim is about the model as declared.
//! Other special values are not examined.

use dalembert_expr::{ExprId, Pool, SymbolId};

use super::contraction::{Dependence, dependence};
use super::dynamics::Dynamics;
use super::exactness::{Exactness, decide, sample_points, screen};
use super::existence::{Decision, check_existence};
use super::finding::{Certificate, Verdict, Witness};
use super::fit::certify;
use super::potential::Potential;
use super::problem::Problem;
use crate::model::{Existence, Model};

/// Number of singular points after which a search for a regular one ends.
const ATTEMPTS: usize = 128;

/// Parameters and their declared values.
#[derive(Debug, Clone, Default)]
pub(super) struct Defaults {
    values: Vec<(SymbolId, ExprId)>,
    text: String,
}

impl Defaults {
    /// Defaults of those parameters on which `roots` depend. Inputs are left out.
    pub(super) fn of(model: &Model, roots: &[ExprId]) -> Self {
        let mut values = Vec::new();
        let mut texts = Vec::new();
        for parameter in model
            .parameters
            .iter()
            .filter(|parameter| !parameter.is_input)
        {
            let occurs = |id: &ExprId| model.pool.depends_on(*id, parameter.symbol);
            let Some(value) = parameter.default.filter(|_| roots.iter().any(occurs)) else {
                continue;
            };
            texts.push(format!(
                "{} = {}",
                parameter.name.display,
                model.pool.text(value)
            ));
            values.push((parameter.symbol, value));
        }
        Self {
            values,
            text: texts.join(", "),
        }
    }

    /// True if `roots` depend on no parameter with a default.
    pub(super) fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Symbols of the parameters and their values.
    pub(super) fn replacements(&self) -> &[(SymbolId, ExprId)] {
        &self.values
    }

    /// `generic`, the verdict that a quantity changes for indeterminate parameters, with the remark that the quantity is
    /// conserved at the defaults.
    pub(super) fn without_change(&self, generic: Verdict) -> Verdict {
        let place = format!("conserved at the declared defaults {}", self.text);
        let remedy = "write these numbers in place of the parameters";
        match generic {
            Verdict::Refuted(witness) => Verdict::Refuted(Witness {
                help: format!("it is {place}: {remedy} to claim that"),
                ..witness
            }),
            Verdict::Proved(certificate) => Verdict::Proved(Certificate {
                shown: format!("{}; it is {place}", certificate.shown),
                ..certificate
            }),
            undecided => undecided,
        }
    }

    /// The verdict on a claim that is proved for indeterminate parameters. `declared`: the verdict at the defaults.
    pub(super) fn confirmed(&self, generic: Verdict, declared: Verdict) -> Verdict {
        let place = format!(
            "it holds for indeterminate parameters; at the declared defaults {},",
            self.text
        );
        match declared {
            Verdict::Proved(_) => generic,
            Verdict::Refuted(mut witness) => {
                witness.reason = format!("{place} {}", witness.reason);
                Verdict::Refuted(witness)
            }
            Verdict::Undecided(reason) => Verdict::Undecided(format!("{place} {reason}")),
        }
    }
}

/// The verdict on a claim of existence, or on `density: none`, that is proved for indeterminate parameters.
pub(super) fn existence_at_defaults(
    model: &mut Model,
    problem: &Problem,
    exactness: &Exactness,
    (claimed, generic): (Existence, Verdict),
    seed: u64,
) -> Verdict {
    let defaults = Defaults::of(model, &problem.roots());
    if defaults.is_empty() {
        return generic;
    }
    let declared = problem.substituted(&mut model.pool, defaults.replacements());
    if is_evident(model, &declared, exactness, (claimed, &defaults), seed) {
        return generic;
    }
    let decision: Decision = decide(model, &declared, seed);
    let verdict = check_existence(model, &declared, &decision, claimed, seed);
    defaults.confirmed(generic, verdict)
}

/// The verdict on `density: none` where a density exists for indeterminate parameters: open if none exists at the defaults.
pub(super) fn absence_at_defaults(
    model: &mut Model,
    problem: &Problem,
    generic: Verdict,
    seed: u64,
) -> Verdict {
    let defaults = Defaults::of(model, &problem.roots());
    if defaults.is_empty() {
        return generic;
    }
    let declared = problem.substituted(&mut model.pool, defaults.replacements());
    if !is_obstructed(&model.pool, &declared, seed) {
        return generic;
    }
    Verdict::Undecided(format!(
        "there is none at the declared defaults {}, and one for almost all other values; write these numbers in place of the \
         parameters to claim that there is none",
        defaults.text
    ))
}

/// The verdict that no density exists because the divergence of the forces is not linear in the velocities. It is
/// undecided unless the divergence is not linear at the defaults, too.
pub(super) fn curvature_at_defaults(
    model: &mut Model,
    problem: &Problem,
    dynamics: &Dynamics,
    generic: Verdict,
    seed: u64,
) -> Verdict {
    let mut roots = dynamics.roots();
    roots.extend(problem.force_slopes());
    let defaults = Defaults::of(model, &roots);
    if defaults.is_empty() {
        return generic;
    }
    let declared = problem.substituted(&mut model.pool, defaults.replacements());
    let dynamics = dynamics.substituted(&mut model.pool, defaults.replacements());
    match dependence(model, &declared, &dynamics, seed) {
        Dependence::Curved(..) => generic,
        Dependence::Linear | Dependence::Unknown => Verdict::Undecided(format!(
            "the forces change volumes at a rate that is not linear in the velocities for almost all parameters, which was not \
             seen at the declared defaults {}; write these numbers in place of the parameters",
            defaults.text
        )),
    }
}

/// True if the claim is easily seen to hold at the defaults: an obstruction remains there, or the closed form is a
/// density there as well.
fn is_evident(
    model: &mut Model,
    declared: &Problem,
    exactness: &Exactness,
    (claimed, defaults): (Existence, &Defaults),
    seed: u64,
) -> bool {
    match (claimed, &exactness.density) {
        (Existence::None, _) => is_obstructed(&model.pool, declared, seed),
        (Existence::Global, Some((potential, _))) => {
            let potential = at(&mut model.pool, potential, defaults);
            certify(&model.pool, declared, &potential, seed)
                .is_ok_and(|certified| certified.is_some())
        }
        _ => false,
    }
}

fn is_obstructed(pool: &Pool, declared: &Problem, seed: u64) -> bool {
    let roots = declared.roots();
    let profile = pool.profile_of(&roots);
    let Ok(mut points) = sample_points(pool, &roots, &profile, seed) else {
        return false;
    };
    screen(pool, declared, &mut points, ATTEMPTS, &[]) == Some(false)
}

/// A closed form with the defaults in its coefficients and terms.
fn at(pool: &mut Pool, potential: &Potential, defaults: &Defaults) -> Potential {
    let terms = potential.terms.iter().map(|(coefficient, term)| {
        let coefficient = pool.substitute(*coefficient, defaults.replacements());
        (coefficient, term.substituted(pool, defaults.replacements()))
    });
    Potential {
        terms: terms.collect(),
    }
}
