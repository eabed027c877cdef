//! `volume: kept` and `density under s: factor = e`: preservation of one volume by the motion and at all surfaces, and
//! the factor by which a surface multiplies it.
//!
//! The volume is `f mu_C`, or `f dq` of a first-order system, with the density `f` that the claims state
//! (`density = f`). Without a stated density, `volume: kept` takes the density found for the motion, and a factor
//! refers to `mu_C`.

use std::cmp::Ordering;

use dalembert_expr::{BallPoint, ExpansionPoint, ExprId, Pool, RealPoint, Verdict as Zero};

use super::bounds::is_never_negative;
use super::collision::{AtImpact, evidence_at_impact};
use super::conserved::magnitude;
use super::corollaries::corollaries;
use super::dynamics::Number;
use super::evidence::Wording;
use super::finding::{Certificate, Verdict, Witness};
use super::hybrid::{Density, Effect, Surroundings, Unknown, change_at, effects, factor};
use super::potential::{Potential, Term};
use super::side::stated_density;
use super::sliding::{may_slide, unless_it_slides};
use super::wall::Wall;
use crate::model::{Law, Model};

/// The density that the claims state, else 1, the density of `mu_C`.
pub(super) fn stated_or_one(model: &mut Model) -> Density {
    match stated_density(model) {
        Some((value, written)) => Density {
            value: Some(value),
            written: Some(written),
            is_found: false,
        },
        None => Density {
            value: Some(model.pool.one()),
            written: None,
            is_found: false,
        },
    }
}

/// The density `exp(G)` of a potential `G`, without a value if `exp(G)` is not written out.
pub(super) fn of_potential(pool: &mut Pool, potential: Option<&Potential>) -> Density {
    let written = potential.and_then(|potential| exponential(pool, potential));
    Density {
        value: written,
        written: None,
        is_found: true,
    }
}

/// `exp(G)`; `None` if a term is a determinant, or a logarithm whose coefficient is no number.
fn exponential(pool: &mut Pool, potential: &Potential) -> Option<ExprId> {
    let mut factors = Vec::new();
    for (coefficient, term) in &potential.terms {
        factors.push(match term {
            Term::Plain(value) => {
                let exponent = pool.mul(*coefficient, *value);
                pool.call(dalembert_expr::Function::Exp, exponent)
            }
            Term::Logarithm(value) => {
                let exponent = pool.as_number(*coefficient)?.clone();
                let size = pool.call(dalembert_expr::Function::Abs, *value);
                pool.pow(size, exponent)
            }
            Term::MassDeterminant | Term::MetricDeterminant | Term::DependentDeterminant => {
                return None;
            }
        });
    }
    Some(pool.product(&factors))
}

/// The verdict on `volume: kept`, with remarks: consequences of a proof, or the effects of the other surfaces. `flow`
/// is the verdict on the density of the motion between impacts.
pub(super) fn check_kept(
    model: &mut Model,
    around: &Surroundings<'_>,
    density: &Density,
    flow: Verdict,
) -> (Verdict, Vec<String>) {
    let flow = match flow {
        Verdict::Proved(certificate) => certificate,
        Verdict::Refuted(witness) => {
            return (Verdict::Refuted(of_the_motion(witness)), Vec::new());
        }
        Verdict::Undecided(reason) => {
            let text = format!("it is not known whether the motion keeps it: {reason}");
            return (Verdict::Undecided(text), Vec::new());
        }
    };
    let effects = effects(model, around, density);
    let sentences = effects
        .iter()
        .map(|effect| effect.sentence(model, around.derivation));
    let sentences: Vec<String> = sentences.collect();
    let with_sentences = || effects.iter().zip(&sentences);
    let refuted =
        with_sentences().find(|(effect, _)| matches!(effect.verdict, Verdict::Refuted(_)));
    if let Some((effect, sentence)) = refuted {
        let verdict = Verdict::Refuted(of_a_surface(model, effect, sentence.clone()));
        return (verdict, others(with_sentences(), effect));
    }
    let open = with_sentences().find(|(effect, _)| !effect.keeps());
    if let Some((effect, sentence)) = open {
        return (
            Verdict::Undecided(sentence.clone()),
            others(with_sentences(), effect),
        );
    }
    let kept = match sentences.is_empty() {
        true => "there are no impacts".to_owned(),
        false => format!("{} keep it too", names(model, &effects)),
    };
    let mut together = Certificate {
        shown: format!("{}; {kept}", flow.shown),
        ..flow
    };
    for effect in &effects {
        if let Verdict::Proved(certificate) = &effect.verdict {
            together.rest_on(certificate);
        }
    }
    let remarks = corollaries(model, around, density);
    (Verdict::Proved(together), remarks)
}

/// Surfaces and transitions by name: `impacts at floor, wall, transitions up`.
fn names(model: &Model, effects: &[Effect]) -> String {
    let of = |is_transition: bool, what: &str| -> Option<String> {
        let surfaces = effects.iter().map(|effect| &model.surfaces[effect.surface]);
        let surfaces = surfaces.filter(|surface| (surface.law == Law::Transition) == is_transition);
        let names: Vec<&str> = surfaces
            .map(|surface| surface.name.display.as_str())
            .collect();
        (!names.is_empty()).then(|| format!("{what} {}", names.join(", ")))
    };
    let parts = [of(false, "impacts at"), of(true, "transitions")];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    parts.join(", ")
}

fn others<'e>(all: impl Iterator<Item = (&'e Effect, &'e String)>, shown: &Effect) -> Vec<String> {
    let rest = all.filter(|(effect, _)| effect.surface != shown.surface);
    rest.map(|(_, sentence)| sentence.clone()).collect()
}

fn of_the_motion(witness: Witness) -> Witness {
    Witness {
        reason: format!("the motion does not keep it: {}", witness.reason),
        ..witness
    }
}

fn of_a_surface(model: &Model, effect: &Effect, sentence: String) -> Witness {
    let name = &model.surfaces[effect.surface].name.display;
    let (sample, values) = match &effect.verdict {
        Verdict::Refuted(witness) => (witness.sample.clone(), witness.values.clone()),
        _ => (None, Vec::new()),
    };
    let help = match model.surfaces[effect.surface].law {
        Law::Transition => format!(
            "write `density under {name}: factor = ..;`, or state in each mode a density that cancels this factor"
        ),
        _ => format!("write `density under {name}: factor = ..;`"),
    };
    Witness {
        reason: sentence,
        sample,
        values,
        help,
    }
}

/// The verdict on `density under s: factor = value`.
pub(super) fn check_factor(
    model: &mut Model,
    around: &Surroundings<'_>,
    surface: usize,
    (value, written): (ExprId, &str),
) -> Verdict {
    let density = stated_or_one(model);
    let name = model.surfaces[surface].name.display.clone();
    let (wall, found) = match change_at(model, around, &density, surface, Some((value, written))) {
        Ok(found) => found,
        Err(unknown) => return without_map(model, unknown, &name, (value, written)),
    };
    let volume = match &density.written {
        Some(stated) => format!("the volume of density {stated}"),
        None => "the volume".to_owned(),
    };
    let help = match density.written {
        None => format!("`{name}` {}", factor(model, surface, &wall)),
        Some(_) => "write the factor of the volume with the stated density".to_owned(),
    };
    let wording = Wording {
        vanishes: format!("`{name}` multiplies {volume} by {written}"),
        differs: format!("`{name}` does not multiply {volume} by {written}"),
        help: [help, String::new()],
    };
    let verdict = found.verdict(true, wording, around.seed);
    let before = wall.passage.as_ref().map(|passage| passage.before.density);
    let claimed = before.into_iter().chain([value]).collect();
    let verdict = unless_it_slides(model, around, (surface, &wall), claimed, verdict);
    let is_proof = matches!(verdict, Verdict::Proved(_));
    match is_proof && !is_never_negative(model, value) {
        true => up_to_its_sign(model, around, &wall, &[&name, &volume], (value, written)),
        false => verdict,
    }
}

/// The verdict on a factor with the right absolute value that may be negative. At a transition between first-order modes
/// the sign of the factor is known too, and a state shows that the claimed factor is negative.
fn up_to_its_sign(
    model: &Model,
    around: &Surroundings<'_>,
    wall: &Wall,
    [name, volume]: &[&str; 2],
    (value, written): (ExprId, &str),
) -> Verdict {
    let open = Verdict::Undecided(format!(
        "`{name}` multiplies {volume} by {written} up to its sign, and `{written}` may be negative; write its absolute value, `abs(..)`"
    ));
    if !may_slide(wall) {
        return open;
    }
    let question = Negative { value, written };
    let found = evidence_at_impact(model, wall, around.dynamics, &question, around.seed);
    let wording = Wording {
        differs: format!(
            "`{written}` is negative, and `{name}` multiplies volumes by its absolute value"
        ),
        help: [
            "write its absolute value, `abs(..)`".to_owned(),
            String::new(),
        ],
        ..Wording::default()
    };
    match found.verdict(true, wording, around.seed) {
        refuted @ Verdict::Refuted(_) => refuted,
        _ => open,
    }
}

/// The question whether a function is negative at a state on a wall.
struct Negative<'n> {
    value: ExprId,
    written: &'n str,
}

impl AtImpact for Negative<'_> {
    fn roots(&self) -> Vec<ExprId> {
        vec![self.value]
    }

    fn terms<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        _: &[Number<P>],
    ) -> Option<Vec<Number<P>>> {
        let values = point.values(&model.pool, &model.pool.reachable(&[self.value]))?;
        Some(vec![values[self.value.index()]])
    }

    fn wants(&self, terms: &[f64]) -> bool {
        terms[0] < 0.0
    }

    fn is_certain(&self, model: &Model, point: &mut BallPoint) -> bool {
        let terms = self.terms(model, point, &[]);
        terms.is_some_and(|terms| terms[0].sign() == Some(Ordering::Less))
    }

    fn scale(&self, model: &Model, point: &mut RealPoint, _: &[f64]) -> Option<f64> {
        Some(magnitude(model, point, self.value))
    }

    fn shown(&self, terms: &[f64], _: f64) -> Vec<(String, f64)> {
        vec![(self.written.to_owned(), terms[0])]
    }
}

/// The verdict where no map relates volumes of the same dimension.
fn without_map(
    model: &mut Model,
    unknown: Unknown,
    name: &str,
    (value, written): (ExprId, &str),
) -> Verdict {
    let refuted = |reason: String, help: &str| {
        Verdict::Refuted(Witness {
            reason,
            sample: None,
            values: Vec::new(),
            help: help.to_owned(),
        })
    };
    match unknown {
        Unknown::Vanishes if model.pool.is_syntactic_zero(value) => {
            Verdict::Proved(Certificate::without_chance(
                format!(
                    "the instantaneous constraints of `{name}` map all states on a line to the same state: volumes become 0"
                ),
                0,
            ))
        }
        Unknown::Vanishes if model.pool.zero_test(value) != Zero::Refuted => {
            Verdict::Undecided(format!(
                "volumes become 0, and {written} is not known to be different from 0; write `density under {name}: factor = 0;`"
            ))
        }
        Unknown::Vanishes => refuted(
            format!(
                "the instantaneous constraints of `{name}` map all states on a line to the same state: volumes become 0, and are not multiplied by {written}"
            ),
            &format!("write `density under {name}: factor = 0;`"),
        ),
        Unknown::Dimensions(before, after) => refuted(
            format!(
                "`{name}` leads from states of {before} dimensions to states of {after}: no volume is multiplied"
            ),
            "leave it out",
        ),
        Unknown::Open(reason) => Verdict::Undecided(reason),
    }
}

/// The certificate of a density. If surfaces do not keep its volume, its text is restricted to the motion between
/// impacts.
pub(super) fn qualified(
    model: &Model,
    certificate: Certificate,
    effects: &[Effect],
) -> Certificate {
    let texts = |wanted: fn(&Verdict) -> bool| -> String {
        let found = effects.iter().filter(|effect| wanted(&effect.verdict));
        let texts = found.map(|effect| {
            format!(
                "{} {}",
                model.surfaces[effect.surface].name.display, effect.text
            )
        });
        texts.collect::<Vec<_>>().join(", ")
    };
    let failing = texts(|verdict| matches!(verdict, Verdict::Refuted(_)));
    let open = texts(|verdict| matches!(verdict, Verdict::Undecided(_)));
    let because = match (failing.is_empty(), open.is_empty()) {
        (true, true) => return certificate,
        (false, true) => format!("impacts do not keep the volume: {failing}"),
        (true, false) => format!("impacts are not known to keep the volume: {open}"),
        (false, false) => {
            format!("impacts do not keep the volume: {failing}; of others it is not known: {open}")
        }
    };
    Certificate {
        shown: format!(
            "for the motion between impacts only ({because}): {}",
            certificate.shown
        ),
        ..certificate
    }
}
