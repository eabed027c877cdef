//! `invariant: FORM`: the motion and all events at surfaces keep a differential form on D.
//!
//! Forms are evaluated on vectors of constant time: `L_X w = 0` along the motion ([`super::lie`]), and `w+ = w` on
//! vectors that are transported across a surface ([`super::carried`]).

use dalembert_expr::{ExprId, RealPoint};

use super::carried::Carried;
use super::collision::evidence_at_impact;
use super::conserved::jump;
use super::contact::{Contact, loses_volumes};
use super::dynamics::Dynamics;
use super::evidence::{Evidence, Vanishing, Wording, evidence};
use super::expansion::{CHANCE, Part, Tangents, choices, explicit_form, is_too_large};
use super::finding::{Certificate, Verdict, Witness};
use super::focusing::{TURNED, leaves_gap_rate};
use super::hybrid::Surroundings;
use super::lie::Lie;
use super::passage::{Open, Passage};
use super::sliding::{MAY_SLIDE, always_goes_on, may_slide};
use super::together::Together;
use super::undecided::Undecided;
use super::wall::Wall;
use crate::model::{ExteriorForm, Model};

/// Number of real states at which the largest components are sought.
const STATES: usize = 12;
/// Largest number of components that are examined one by one.
const COMPONENTS: usize = 32;

/// Reason for an open verdict on surfaces of a model with nonlinear constraints.
const AT_NONLINEAR: &str =
    "resets beside constraints that are not linear in the velocities are not examined";

/// A form as stated; it may name momenta.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stated<'f> {
    pub(super) form: &'f ExteriorForm,
    pub(super) written: &'f str,
    /// True if the form of another mode is the symplectic form of that mode, not the form with the same names.
    pub(super) is_symplectic: bool,
}

impl<'f> Stated<'f> {
    pub(super) fn named(form: &'f ExteriorForm, written: &'f str) -> Self {
        Self {
            form,
            written,
            is_symplectic: false,
        }
    }
}

/// Reason that keeps a question about tangent vectors open under position equations beside other constraints.
pub(super) const ACROSS: &str =
    "the vectors tried may lead to positions that break the position equations";

/// The verdict on `invariant: form`.
pub(super) fn check_invariant(
    model: &mut Model,
    around: &Surroundings<'_>,
    form: &ExteriorForm,
    written: &str,
) -> Verdict {
    let Some((tangents, leads_across)) = Tangents::of_states(model, around.dynamics) else {
        return Verdict::Undecided(Undecided::Degenerate.to_string());
    };
    match check_on(model, around, &tangents, Stated::named(form, written)) {
        Verdict::Refuted(_) if leads_across => Verdict::Undecided(ACROSS.to_owned()),
        verdict => verdict,
    }
}

/// The verdict for constraints that are not linear in the velocities, on each part of D.
pub(super) fn check_on_parts(
    model: &mut Model,
    around: &Surroundings<'_>,
    parts: &[Dynamics],
    stated: Stated<'_>,
) -> Verdict {
    let Stated { form, written, .. } = stated;
    if parts.is_empty() {
        return Verdict::Undecided(Undecided::Nonlinear.to_string());
    }
    let explicit = explicit_form(model, form);
    let shown = format!("the motion keeps `{written}`");
    let mut together = Together::of(Certificate::without_chance(shown, around.seed));
    let mut nothing = Vec::new();
    for dynamics in parts {
        let around = Surroundings {
            dynamics,
            ..*around
        };
        let Some((tangents, leads_across)) = Tangents::of_states(model, dynamics) else {
            return Verdict::Undecided(Undecided::Degenerate.to_string());
        };
        if let Some(open) = too_large(&tangents, form) {
            return open;
        }
        nothing.extend(vanishes(model, &around, &tangents, (&explicit, written)));
        let kept = match check_kept(model, &around, &tangents, stated) {
            Verdict::Refuted(_) if leads_across => Verdict::Undecided(ACROSS.to_owned()),
            verdict => verdict,
        };
        if let Some(refuted) = together.add(kept) {
            return refuted;
        }
    }
    // A claim on a form that is 0 on some parts of D still states something about the other parts.
    match nothing.len() == parts.len() {
        true => nothing.swap_remove(0),
        false => together.verdict(),
    }
}

/// The verdict on a form with too many components.
fn too_large(tangents: &Tangents, form: &ExteriorForm) -> Option<Verdict> {
    let (dimension, degree) = (tangents.dimension(), form.degree);
    is_too_large(dimension, degree).then(|| {
        Verdict::Undecided(format!(
            "a form of degree {degree} on states of {dimension} dimensions has more components than are examined",
        ))
    })
}

/// The verdict on a form, evaluated on the given tangent vectors.
pub(super) fn check_on(
    model: &mut Model,
    around: &Surroundings<'_>,
    tangents: &Tangents,
    stated: Stated<'_>,
) -> Verdict {
    let Stated { form, written, .. } = stated;
    if let Some(open) = too_large(tangents, form) {
        return open;
    }
    let explicit = explicit_form(model, form);
    match vanishes(model, around, tangents, (&explicit, written)) {
        Some(verdict) => verdict,
        None => check_kept(model, around, tangents, stated),
    }
}

/// The verdict on the effects of motion and surfaces on a form. The form may be 0 at all states.
fn check_kept(
    model: &mut Model,
    around: &Surroundings<'_>,
    tangents: &Tangents,
    stated: Stated<'_>,
) -> Verdict {
    let Stated { form, written, .. } = stated;
    let explicit = explicit_form(model, form);
    let motion = kept_by_motion(model, around, tangents, (&explicit, written));
    let mut together = match motion {
        Verdict::Proved(certificate) => Together::of(certificate),
        other => return other,
    };
    for surface in model.acting_surfaces() {
        let name = model.surfaces[surface].name.display.clone();
        if model.is_nonlinear() {
            let text = format!("the effect of `{name}` is not known: {AT_NONLINEAR}");
            return Verdict::Undecided(text);
        }
        let verdict = match kept_at_surface(model, around, tangents, stated, surface) {
            Verdict::Undecided(reason) => {
                Verdict::Undecided(format!("the effect of `{name}` is not known: {reason}"))
            }
            decided => decided,
        };
        if let Some(refuted) = together.add(verdict) {
            return refuted;
        }
        together.all.shown += &format!("; `{name}` keeps it");
    }
    together.verdict()
}

/// Refutes a claim on a form that is 0 at all states: it claims nothing. `None` for other forms.
fn vanishes(
    model: &mut Model,
    around: &Surroundings<'_>,
    tangents: &Tangents,
    (form, written): (&ExteriorForm, &str),
) -> Option<Verdict> {
    let refuted = |reason: String| {
        Some(Verdict::Refuted(Witness {
            reason,
            sample: None,
            values: Vec::new(),
            help: "leave it out".to_owned(),
        }))
    };
    if form.degree > tangents.dimension() {
        return refuted(format!(
            "`{written}` is of degree {}, and states have {} dimensions: it is 0, and the claim says nothing",
            form.degree,
            tangents.dimension()
        ));
    }
    let mut question = Lie::of(model, around.dynamics, tangents, form).of_form();
    question.part = Part::All(around.seed);
    match evidence(model, &question, around.seed).shows_that_it_vanishes() {
        true => refuted(format!(
            "`{written}` is 0 at all states, and the claim says nothing"
        )),
        false => None,
    }
}

/// The verdict on the motion between surfaces.
pub(super) fn kept_by_motion(
    model: &mut Model,
    around: &Surroundings<'_>,
    tangents: &Tangents,
    (form, written): (&ExteriorForm, &str),
) -> Verdict {
    let names = tangents.names(model);
    let mut question = Lie::of(model, around.dynamics, tangents, form);
    let place = tangents.place();
    let wording = || Wording {
        vanishes: format!("the motion keeps `{written}`{place}"),
        differs: format!("the motion changes `{written}`{place}"),
        help: ["leave it out".to_owned(), String::new()],
    };
    let ranked = ranked_at_states(model, &question);
    let verdict = decided(around.seed, ranked, &mut |part| {
        question.shown = format!("rate of the form on {}", on(&names, part));
        question.part = part.clone();
        (evidence(model, &question, around.seed), wording())
    });
    if matches!(verdict, Verdict::Proved(_)) {
        let places = discontinuities(model, around, form);
        if let Some(place) = places {
            let text = format!("its rate is 0 wherever it exists, but it may jump {place}");
            return Verdict::Undecided(text);
        }
    }
    verdict
}

/// A place where the form may jump along a motion, as text.
fn discontinuities(
    model: &mut Model,
    around: &Surroundings<'_>,
    form: &ExteriorForm,
) -> Option<String> {
    let mut symbols: Vec<_> = model
        .coordinates
        .iter()
        .map(|coordinate| coordinate.q)
        .collect();
    symbols.extend(model.coordinates.iter().map(|coordinate| coordinate.qdot));
    let mut parts: Vec<ExprId> = form.terms.iter().map(|term| term.coefficient).collect();
    for id in form.terms.iter().flat_map(|term| &term.differentials) {
        parts.extend(symbols.iter().map(|by| model.pool.diff(*id, *by)));
    }
    parts
        .into_iter()
        .find_map(|part| jump(model, around.dynamics, part, around.seed))
}

/// The verdict on the map at a surface.
pub(super) fn kept_at_surface(
    model: &mut Model,
    around: &Surroundings<'_>,
    tangents: &Tangents,
    stated: Stated<'_>,
    surface: usize,
) -> Verdict {
    let declared = &model.surfaces[surface];
    let enters = declared
        .transition
        .as_ref()
        .map(|transition| transition.enters);
    let entered = enters.and_then(|enters| around.others.get(enters)).copied();
    let wall = Wall::of(model, around.derivation, surface, around.others);
    if !leaves_gap_rate(model, around, surface, &wall) {
        return Verdict::Undecided(TURNED.to_owned());
    }
    match &wall.passage {
        None if enters.is_some() => {
            return Verdict::Undecided("the mode that it leads to is not examined here".to_owned());
        }
        Some(passage) if passage.open == Some(Open::Refraction) => {
            return Verdict::Undecided(Open::Refraction.text());
        }
        _ => {}
    }
    let tangents = &tangents.at_wall(model, around, &wall);
    let mut verdict = kept_at_wall(model, around, tangents, stated, (surface, &wall, entered));
    let is_refracted = wall.passage.as_ref().is_some_and(Passage::is_refracted);
    if let (true, Verdict::Proved(all)) = (is_refracted, &mut verdict) {
        let wall = Wall::reflecting(model, around.derivation, surface);
        match kept_at_wall(model, around, tangents, stated, (surface, &wall, None)) {
            Verdict::Proved(part) => all.rest_on(&part),
            Verdict::Undecided(reason) => return Verdict::Undecided(reason),
            // The states at which the motion is reflected are not known.
            Verdict::Refuted(_) => {
                let text = "a reflection there would change it";
                return Verdict::Undecided(text.to_owned());
            }
        }
    }
    let contacts = Contact::all(model, surface, &wall);
    if !contacts.is_empty() {
        let is_volume = stated.form.degree == tangents.dimension();
        return match verdict {
            // States of fewer dimensions have no volume, whatever the motion does afterwards.
            Verdict::Refuted(_) if is_volume && loses_volumes(model, surface) => verdict,
            _ => behind_contacts(model, around, tangents, stated, (surface, &wall), contacts),
        };
    }
    let is_proof = matches!(verdict, Verdict::Proved(_));
    if is_proof && may_slide(&wall) && !always_goes_on(model, &wall) {
        return Verdict::Undecided(MAY_SLIDE.to_owned());
    }
    verdict
}

/// The verdict on a surface behind which the motion may be held or go on freely. A witness names the motion.
fn behind_contacts(
    model: &mut Model,
    around: &Surroundings<'_>,
    tangents: &Tangents,
    stated: Stated<'_>,
    (surface, wall): (usize, &Wall),
    contacts: Vec<Contact>,
) -> Verdict {
    let is_stopped = contacts.iter().any(|contact| contact.is_stopped);
    let motions = contacts.into_iter().map(After::Contact);
    for after in [After::Any].into_iter().chain(motions) {
        let text = match &after {
            After::Contact(contact) => contact.text(),
            _ => "",
        };
        let at = (surface, wall, None);
        let found = kept_behind(model, around, tangents, stated, at, after);
        if let Verdict::Refuted(mut witness) = found {
            witness.reason += text;
            return Verdict::Refuted(witness);
        }
    }
    let text = match is_stopped {
        true => {
            "no state was found that shows a change, and a proof needs the sign of the acceleration of its gap at all states behind it: the motion may go on freely or be held"
        }
        false => {
            "no state was found that shows a change, and a proof needs a law that reverses the rate of its gap at all states: the motion behind it may still approach it"
        }
    };
    Verdict::Undecided(text.to_owned())
}

/// The verdict on the map of a wall, with the motion behind it that the law gives.
fn kept_at_wall(
    model: &mut Model,
    around: &Surroundings<'_>,
    tangents: &Tangents,
    stated: Stated<'_>,
    at: (usize, &Wall, Option<&Model>),
) -> Verdict {
    kept_behind(model, around, tangents, stated, at, After::Law)
}

/// The motion behind a wall.
enum After {
    /// The motion that the law gives.
    Law,
    /// Free or held motion.
    Contact(Contact),
    /// Either motion. The form is evaluated only on vectors of velocities: they are tangent to the wall, so that their
    /// images depend on the law but not on the motion.
    Any,
}

fn kept_behind(
    model: &mut Model,
    around: &Surroundings<'_>,
    tangents: &Tangents,
    stated: Stated<'_>,
    (surface, wall, entered): (usize, &Wall, Option<&Model>),
    after: After,
) -> Verdict {
    let name = model.surfaces[surface].name.display.clone();
    let Stated { form, written, .. } = stated;
    let explicit = explicit_form(model, form);
    let forms = (&explicit, stated);
    let mut question = match Carried::of(model, around, forms, tangents, (wall, entered)) {
        Ok(question) => question,
        Err(reason) => return Verdict::Undecided(reason),
    };
    let is_any = matches!(after, After::Any);
    if let After::Contact(contact) = after {
        question = question.with_contact(model, contact);
    }
    let names = tangents.names(model);
    let place = tangents.place();
    let wording = || Wording {
        vanishes: format!("`{name}` keeps `{written}`{place}"),
        differs: format!("`{name}` changes `{written}`{place}"),
        help: ["leave it out".to_owned(), String::new()],
    };
    let sizes = (tangents.dimension(), form.degree);
    let ranked = {
        let model = &*model;
        let roots = super::collision::AtImpact::roots(&question);
        ranked(sizes, |attempt| {
            let found = wall.incoming(model, around.dynamics, attempt, roots.clone());
            let (_, mut point): (_, RealPoint) = found?;
            question.components(model, &mut point)
        })
    };
    let first = if is_any { tangents.first_velocity() } else { 0 };
    let ranked = ranked
        .into_iter()
        .filter(|places| places.iter().all(|place| *place >= first))
        .collect();
    decided(around.seed, ranked, &mut |part| {
        question.shown = format!("the form on {}", on(&names, part));
        question.part = part.clone();
        let found = evidence_at_impact(model, wall, around.dynamics, &question, around.seed);
        (found, wording())
    })
}

/// Names of the vectors of a part.
fn on(names: &[String], part: &Part) -> String {
    match part {
        Part::All(_) => String::new(),
        Part::One(places) => {
            let names: Vec<&str> = places.iter().map(|place| names[*place].as_str()).collect();
            names.join(", ")
        }
    }
}

/// Components of a form or of its derivative, the largest at real states first.
pub(super) fn ranked_at_states(model: &Model, question: &Lie<'_>) -> Vec<Vec<usize>> {
    let (dimension, degree) = question.sizes();
    let each = choices(dimension, degree);
    ranked((dimension, degree), |attempt| {
        let (_, mut point) = question.sample(model, attempt)?;
        let products = question.products(model, &mut point)?;
        let field = dalembert_expr::Reals;
        let each = each.iter().map(|places| products.component(field, places));
        Some((each.collect::<Option<Vec<f64>>>()?, products.size()))
    })
}

/// Components, the largest at real states first.
fn ranked(
    (dimension, degree): (usize, usize),
    mut at: impl FnMut(usize) -> Option<(Vec<f64>, f64)>,
) -> Vec<Vec<usize>> {
    let all = choices(dimension, degree);
    let mut sizes = vec![0.0_f64; all.len()];
    for (components, size) in (0..STATES).filter_map(&mut at) {
        for (largest, component) in sizes.iter_mut().zip(components) {
            *largest = largest.max(component.abs() / size);
        }
    }
    let mut places: Vec<usize> = (0..all.len()).collect();
    places.sort_by(|a, b| sizes[*b].total_cmp(&sizes[*a]));
    places.truncate(COMPONENTS);
    places.into_iter().map(|place| all[place].clone()).collect()
}

/// The verdict on all components: proved together, refuted by one.
fn decided(
    seed: u64,
    components: Vec<Vec<usize>>,
    ask: &mut dyn FnMut(&Part) -> (Evidence, Wording),
) -> Verdict {
    let (all, wording) = ask(&Part::All(seed));
    let open = all.open.to_string();
    match all.verdict(true, wording, seed) {
        Verdict::Proved(certificate) => {
            return Verdict::Proved(Certificate {
                error: certificate.error + CHANCE,
                ..certificate
            });
        }
        undecided @ Verdict::Undecided(_) if components.is_empty() => return undecided,
        _ => {}
    }
    for places in components {
        let (one, wording) = ask(&Part::One(places));
        if let refuted @ Verdict::Refuted(_) = one.verdict(true, wording, seed) {
            return refuted;
        }
    }
    Verdict::Undecided(open)
}
