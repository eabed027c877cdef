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

#[cfg(test)]
mod tests {
    use crate::compile;

    const PARTICLE: &str = "pub Particle {
        coordinates { x; y; }
        parameters { k >= 0 = DEFAULT; c > 0 = 1; }
        lagrangian = dot(x)^2/2 + dot(y)^2/2;
        constraints { belt: dot(x) = k; }
        forces { drag: -c*dot(y)*d(y); }
        claims { CLAIM; }
    }";

    /// The messages of a declaration that is refused; empty if it is accepted.
    fn messages(declaration: &str) -> String {
        let Err(refused) = compile(declaration.parse().expect("tokens")) else {
            return String::new();
        };
        refused
            .iter()
            .map(|refusal| refusal.message().to_owned())
            .collect()
    }

    fn particle(default: &str, claim: &str) -> String {
        let declaration = PARTICLE.replace("DEFAULT", default);
        messages(&declaration.replace("CLAIM", claim))
    }

    #[test]
    fn a_density_that_has_a_pole_at_the_default_is_refused() {
        assert_eq!(particle("1/3", "density: exact"), "");
        let message = particle("0", "density: exact");
        assert!(message.contains("`density: exact` is refuted"), "{message}");
        assert!(message.contains("at the declared defaults"), "{message}");
        assert!(message.contains("k = 0"), "{message}");
        assert!(message.contains("delta"), "{message}");
    }

    /// A bead on a hoop that turns at the rate w: the energy in the frame at rest is conserved if w = 0.
    #[test]
    fn verdicts_name_defaults_at_which_a_quantity_is_conserved() {
        let bead = |default: &str, claim: &str| {
            format!(
                "pub Bead {{
                    coordinates {{ theta: angle; }}
                    parameters {{ w = {default}; g > 0 = 9.81; }}
                    lagrangian = (dot(theta)^2 + w^2*sin(theta)^2)/2 + g*cos(theta);
                    let lab = (dot(theta)^2 + w^2*sin(theta)^2)/2 - g*cos(theta);
                    claims {{ {claim}; }}
                }}"
            )
        };
        let kept = "conserved at the declared defaults w = 0";
        let shown = |default: &str| {
            let text = bead(default, "not conserved: lab");
            let compiled = compile(text.parse().expect("tokens")).expect("a model");
            compiled.findings[0].note()
        };
        assert!(shown("0").contains(kept), "{}", shown("0"));
        assert!(
            !shown("1/2").contains("declared defaults"),
            "{}",
            shown("1/2")
        );
        let message = messages(&bead("0", "conserved: lab"));
        assert!(message.contains("`conserved: lab` is refuted"), "{message}");
        assert!(message.contains(kept), "{message}");
        let message = messages(&bead("1/2", "conserved: lab"));
        assert!(!message.contains("declared defaults"), "{message}");
    }

    #[test]
    fn a_stated_density_without_value_at_the_default_is_no_theorem() {
        assert_eq!(particle("1/3", "density = exp(c*x/k)"), "");
        let message = particle("0", "density = exp(c*x/k)");
        assert!(message.contains("at the declared defaults"), "{message}");
    }

    #[test]
    fn that_there_is_none_at_the_defaults_alone_is_not_refuted() {
        let message = particle("0", "density: none");
        assert!(
            message.contains("`density: none` is undecided"),
            "{message}"
        );
        assert!(message.contains("k = 0"), "{message}");
        let message = particle("1/3", "density: none");
        assert!(message.contains("`density: none` is refuted"), "{message}");
    }

    #[test]
    fn an_obstruction_that_vanishes_at_the_defaults_is_refused() {
        let sleigh = "pub Sleigh {
            coordinates { x; y; theta: angle; }
            parameters { m > 0 = 1; I > 0 = 1; a = 1/2; b = DEFAULT; }
            let slip = -dot(x)*sin(theta) + dot(y)*cos(theta);
            lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I + m*(a+b)^2)/2*dot(theta)^2 + (a+b)*m*dot(theta)*slip;
            constraints { blade: slip = 0; }
            claims { density: none; }
        }";
        assert_eq!(messages(&sleigh.replace("DEFAULT", "1/3")), "");
        let message = messages(&sleigh.replace("DEFAULT", "-1/2"));
        assert!(message.contains("`density: none` is refuted"), "{message}");
        assert!(message.contains("a = 1/2, b = -1/2"), "{message}");
    }
}
