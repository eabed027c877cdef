//! Changes of a volume `f mu_C` at surfaces. It is kept if `f+ J = f-`, where J is the Jacobian of [`super::wall`] or
//! [`super::passage`].

use std::cmp::Ordering;

use dalembert_expr::{Arithmetic, BallPoint, ExpansionPoint, ExprId, RealPoint};

use super::collision::{AtImpact, after_and_before, evidence_at_impact, with_difference};
use super::dynamics::{Dynamics, Number};
use super::evidence::{Evidence, Wording};
use super::exactness::decide;
use super::factor::{closed_form, size_text};
use super::finding::{Verdict, Witness, digits};
use super::passage::{Open, Passage};
use super::potential::factor_text;
use super::problem::Problem;
use super::side::stated_density;
use super::sliding::{Return, may_slide, slides_where_it_returns, unless_it_slides};
use super::wall::Wall;
use crate::mechanics::{Derivation, derive};
use crate::model::{Law, Model};

/// A density of a volume.
#[derive(Debug, Clone)]
pub(super) struct Density {
    /// Its value; `None` for a function of the position that is not written out.
    pub(super) value: Option<ExprId>,
    /// Its text, if the model states it.
    pub(super) written: Option<String>,
    /// True if it was derived. The density of another mode is then known only up to a factor.
    pub(super) is_found: bool,
}

/// Effect of a surface on a volume.
#[derive(Debug)]
pub(super) struct Effect {
    /// The surface.
    pub(super) surface: usize,
    /// The verdict on the claim that it keeps the volume, with a state where it does not.
    pub(super) verdict: Verdict,
    /// The effect as text.
    pub(super) text: String,
}

impl Effect {
    /// True if the volume is proved to be kept.
    pub(super) fn keeps(&self) -> bool {
        matches!(self.verdict, Verdict::Proved(_))
    }

    /// The sentence about the surface.
    pub(super) fn sentence(&self, model: &Model, derivation: &Derivation) -> String {
        let surface = &model.surfaces[self.surface];
        let (name, law) = (&surface.name.display, model.law_text(self.surface));
        let stands = (model.pool).is_syntactic_zero(derivation.surfaces[self.surface].rate);
        let moving = if stands { "" } else { ", which moves," };
        let what = match surface.law {
            Law::Transition => "the transition",
            _ => "an impact at",
        };
        format!("{what} {name}{moving} ({law}) {}", self.text)
    }
}

/// Data that questions about impacts and volumes need besides the model.
pub(super) struct Surroundings<'s> {
    pub(super) derivation: &'s Derivation,
    pub(super) dynamics: &'s Dynamics,
    /// All modes of the model, in order; empty for a model without modes.
    pub(super) others: &'s [&'s Model],
    pub(super) seed: u64,
}

/// Effects of all surfaces on a volume.
pub(super) fn effects(
    model: &mut Model,
    around: &Surroundings<'_>,
    density: &Density,
) -> Vec<Effect> {
    (model.acting_surfaces().into_iter())
        .map(|surface| effect(model, around, density, surface))
        .collect()
}

fn effect(
    model: &mut Model,
    around: &Surroundings<'_>,
    density: &Density,
    surface: usize,
) -> Effect {
    let (wall, found) = match change_at(model, around, density, surface, None) {
        Ok(found) => found,
        Err(unknown) => {
            let (verdict, text) = unknown.in_words();
            return Effect {
                surface,
                verdict,
                text,
            };
        }
    };
    let verdict = found.verdict(true, Wording::default(), around.seed);
    let before = wall.passage.as_ref().map(|passage| passage.before.density);
    let claimed = before.into_iter().collect();
    let verdict = unless_it_slides(model, around, (surface, &wall), claimed, verdict);
    let is_stated = density.written.is_some();
    let text = match (&verdict, is_stated) {
        (Verdict::Proved(_), _) => "keeps it".to_owned(),
        (Verdict::Refuted(witness), true) => changed(witness),
        (Verdict::Refuted(witness), false) => {
            let one = model.pool.one();
            let passage = wall.passage.as_ref();
            match passage.and_then(|passage| closed_form(model, passage)) {
                // The densities of the two modes differ.
                Some(factor) if factor == one => changed(witness),
                _ => factor(model, surface, &wall),
            }
        }
        (Verdict::Undecided(_), false) => {
            format!("{}, unless that factor is 1", factor(model, surface, &wall))
        }
        (Verdict::Undecided(reason), true) => format!("may change it: {reason}"),
    };
    Effect {
        surface,
        verdict,
        text,
    }
}

/// Reason for which the change of a volume is not computed.
pub(super) enum Unknown {
    /// The volume is mapped to 0: instantaneous constraints map all states of a line to the same state.
    Vanishes,
    /// The dimensions before and after differ: no volume is kept.
    Dimensions(usize, usize),
    /// The change is not known, for this reason.
    Open(String),
}

impl Unknown {
    fn in_words(self) -> (Verdict, String) {
        let refuted = |reason: String| {
            Verdict::Refuted(Witness {
                reason,
                sample: None,
                values: Vec::new(),
                help: String::new(),
            })
        };
        match self {
            Self::Vanishes => {
                let text = "maps it to 0, because of its instantaneous constraints";
                (refuted(String::new()), text.to_owned())
            }
            Self::Dimensions(before, after) => {
                let text = Open::Dimensions(before, after).text();
                (refuted(String::new()), format!("keeps no volume: {text}"))
            }
            Self::Open(reason) => (
                Verdict::Undecided(reason.clone()),
                format!("may change it: {reason}"),
            ),
        }
    }
}

/// Evidence on whether a surface multiplies a volume by a factor, 1 if none is given.
pub(super) fn change_at(
    model: &mut Model,
    around: &Surroundings<'_>,
    density: &Density,
    surface: usize,
    factor: Option<(ExprId, &str)>,
) -> Result<(Wall, Evidence), Unknown> {
    if !model.surfaces[surface].instantaneous.is_empty() {
        return Err(Unknown::Vanishes);
    }
    let mut wall = Wall::of(model, around.derivation, surface, around.others);
    let is_transition = model.surfaces[surface].law == Law::Transition;
    if let Some(passage) = &mut wall.passage {
        match passage.open {
            Some(Open::Dimensions(before, after)) => {
                return Err(Unknown::Dimensions(before, after));
            }
            Some(reason) => return Err(Unknown::Open(reason.text())),
            None => {}
        }
        if is_transition
            && density.is_found
            && !has_plain_densities(model, around, density, surface)
        {
            let text =
                "the densities of both modes are known up to factors; state them, `density = ..`";
            return Err(Unknown::Open(text.to_owned()));
        }
        match density.value {
            Some(value) => passage.weigh(model, value),
            None if passage.keeps_positions(model) && !is_transition => {}
            None => {
                let text = "the density is not written out, and positions or modes change";
                return Err(Unknown::Open(text.to_owned()));
            }
        }
    } else if is_transition {
        let text = "its effect is not examined: the mode that it leads to is not examined here";
        return Err(Unknown::Open(text.to_owned()));
    }
    let solution = wall.solution();
    if let (Some(passage), Some(solution)) = (&mut wall.passage, solution) {
        passage.restrict(&mut model.pool, solution);
    }
    let question = Change {
        wall: &wall,
        density,
        factor,
    };
    let found = evidence_at_impact(model, &wall, around.dynamics, &question, around.seed);
    Ok((wall, found))
}

/// True if the density of this mode is 1, and the other mode states a density or keeps `mu_C`.
fn has_plain_densities(
    model: &Model,
    around: &Surroundings<'_>,
    density: &Density,
    surface: usize,
) -> bool {
    let enters = model.surfaces[surface]
        .transition
        .as_ref()
        .map(|transition| transition.enters);
    let entered = enters.and_then(|enters| around.others.get(enters));
    density.value == Some(model.pool.one())
        && entered.is_some_and(|mode| keeps_mu_c(mode, around.seed))
}

/// True if a mode is of first order, states a density, or keeps `mu_C` itself.
fn keeps_mu_c(mode: &Model, seed: u64) -> bool {
    let mut mode = mode.clone();
    if mode.is_first_order() || stated_density(&mut mode).is_some() {
        return true;
    }
    if mode.is_nonlinear() {
        return false;
    }
    let derivation = derive(&mut mode);
    let problem = Problem::of(&mut mode, &derivation);
    let decision = decide(&mut mode, &problem, seed);
    let found = decision.ok().and_then(|exactness| exactness.density);
    found.is_some_and(|(potential, _)| potential.terms.is_empty())
}

/// The effect of a law on `mu_C`, as text.
pub(super) fn factor(model: &mut Model, surface: usize, wall: &Wall) -> String {
    const RHO: &str = "rho = dh(pi_D grad h)/dh(grad h)";
    const RATES: &str = "where G- and G+ are the gap rates before and after";
    let is_affine = model
        .constraints
        .iter()
        .any(|constraint| !model.pool.is_syntactic_zero(constraint.affine));
    let squared = |e: ExprId| match model.pool.as_number(e) {
        Some(number) if number.is_zero() => "maps it to 0".to_owned(),
        _ => format!("multiplies it by {}^2", factor_text(&model.pool, e)),
    };
    match model.surfaces[surface].law {
        Law::Elastic => format!("multiplies it by -G+/G-, {RATES}"),
        Law::Restitution(e) if is_affine => {
            format!(
                "multiplies it by -{}*G+/G-, {RATES}",
                factor_text(&model.pool, e)
            )
        }
        Law::Restitution(e) | Law::Newton(e) => squared(e),
        Law::NonholonomicPlastic => format!("multiplies it by (1 - 2*rho)^2, {RHO}"),
        Law::ImpactPlastic => "maps it to 0".to_owned(),
        Law::TotallyPlastic => format!("multiplies it by (1 - rho)^2, {RHO}"),
        Law::Stop => "ends the motion".to_owned(),
        Law::Transition | Law::Reset => {
            let passage = wall.passage.as_ref();
            let returns = passage.map_or(Return::Never, Passage::returns);
            let slides = returns == Return::Always;
            match passage.and_then(|passage| closed_form(model, passage)) {
                Some(factor) if slides && model.pool.sign(factor).is_nonpositive() => {
                    "holds the motion, which reaches the surface from both sides, and maps the volume to 0"
                        .to_owned()
                }
                Some(factor) if slides => {
                    format!("multiplies it by {}", factor_text(&model.pool, factor))
                }
                Some(factor) if returns == Return::Perhaps => format!(
                    "multiplies it by {}, or by 0 where the motion slides along the surface",
                    size_text(&model.pool, factor)
                ),
                Some(factor) if model.pool.is_syntactic_zero(factor) => "maps it to 0".to_owned(),
                Some(factor) => format!("multiplies it by {}", size_text(&model.pool, factor)),
                None => "multiplies it by the determinant of its augmented differential".to_owned(),
            }
        }
    }
}

fn changed(witness: &Witness) -> String {
    let values: Vec<String> = witness
        .values
        .iter()
        .map(|(name, value)| format!("{name} = {}", digits(*value)))
        .collect();
    let at = witness
        .sample
        .as_ref()
        .map_or(String::new(), |sample| format!(" at {}", sample.text()));
    match values.is_empty() {
        true => "does not keep it".to_owned(),
        false => format!("does not keep it: {}{at}", values.join(", ")),
    }
}

/// The change of a volume in an impact.
struct Change<'v> {
    wall: &'v Wall,
    density: &'v Density,
    /// The claimed factor of the volume.
    factor: Option<(ExprId, &'v str)>,
}

impl Change<'_> {
    /// The density after and before.
    fn densities<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        after: &[Number<P>],
    ) -> Option<[Number<P>; 2]> {
        let one = [point.field().integer(1); 2];
        let Some(value) = self.density.value else {
            return Some(one);
        };
        let Some(passage) = &self.wall.passage else {
            return match self.density.written {
                // A function of the position.
                None => Some(one),
                Some(_) => after_and_before(model, point, after, (value, value)),
            };
        };
        let both = (passage.after.density, passage.before.density);
        if passage.computes_velocities() {
            return after_and_before(model, point, after, both);
        }
        let values = point.values(&model.pool, &model.pool.reachable(&[both.0, both.1]))?;
        Some([values[both.0.index()], values[both.1.index()]])
    }
}

impl AtImpact for Change<'_> {
    fn roots(&self) -> Vec<ExprId> {
        let factor = self.factor.iter().map(|(value, _)| *value);
        let passage = self.wall.passage.iter().flat_map(Passage::roots);
        self.density
            .value
            .into_iter()
            .chain(factor)
            .chain(passage)
            .collect()
    }

    /// `(f+ J)^2 - (E f-)^2` with the claimed factor E. The squares are compared, because the absolute value has
    /// branches.
    fn terms<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        after: &[Number<P>],
    ) -> Option<Vec<Number<P>>> {
        let field = point.field();
        let jacobian = self.wall.jacobian(model, point, after)?;
        let [new, old] = self.densities(model, point, after)?;
        let after = field.mul(new, jacobian);
        let before = match self.factor {
            Some((factor, _)) => {
                let values = point.values(&model.pool, &model.pool.reachable(&[factor]))?;
                field.mul(old, values[factor.index()])
            }
            None => old,
        };
        let square = |volume| field.mul(volume, volume);
        Some(vec![square(after), field.neg(square(before))])
    }

    /// True if terms with a sum other than 0 prove that the volume changes. Where the motion may slide, they do if the
    /// Jacobian is positive, because the motion then crosses the surface. If it is not known whether the motion slides,
    /// they do if the volume before is not 0, because sliding maps it to 0. [`super::sliding`] examines motion that
    /// slides.
    fn is_certain(&self, model: &Model, point: &mut BallPoint) -> bool {
        if !may_slide(self.wall) {
            return true;
        }
        let Some(jacobian) = self.wall.jacobian(model, point, &[]) else {
            return false;
        };
        match jacobian.sign() {
            Some(Ordering::Greater) => true,
            Some(_) if slides_where_it_returns(self.wall) => false,
            _ => {
                let terms = self.terms(model, point, &[]);
                terms.is_some_and(|terms| terms[1].sign().is_some())
            }
        }
    }

    fn scale(&self, model: &Model, point: &mut RealPoint, after: &[f64]) -> Option<f64> {
        let terms = self.terms(model, point, after)?;
        Some(terms.iter().map(|term| term.abs()).sum())
    }

    fn shown(&self, terms: &[f64], sum: f64) -> Vec<(String, f64)> {
        let factor = self.factor.map(|(_, written)| written);
        let names = match (&self.density.written, factor) {
            (Some(written), None) => [
                format!("{written} after times the Jacobian"),
                format!("{written} before"),
            ],
            (Some(written), Some(factor)) => [
                format!("{written} after times the Jacobian"),
                format!("{factor} times {written} before"),
            ],
            (None, factor) => [
                "Jacobian".to_owned(),
                factor
                    .unwrap_or("Jacobian of a map that keeps the volume")
                    .to_owned(),
            ],
        };
        let sizes = [terms[0].abs().sqrt(), terms[1].abs().sqrt()];
        with_difference(names, sizes, sum / (sizes[0] + sizes[1]))
    }
}
