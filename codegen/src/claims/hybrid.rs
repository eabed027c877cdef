//! What impacts do to an invariant volume `f mu_C`: it is kept if `f+ J = f-`, J the Jacobian of [`super::wall`].

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, RealPoint};

use super::collision::{AtImpact, after_and_before, evidence_at_impact, with_difference};
use super::dynamics::{Dynamics, Number};
use super::evidence::Wording;
use super::finding::{Verdict, Witness};
use super::potential::factor_text;
use super::reset::ResetMap;
use super::wall::Wall;
use crate::mechanics::Derivation;
use crate::model::{Law, Model};

/// What each surface does to `f mu_C`, one sentence each; `f` is a function of the position unless a stated density is
/// given with its text.
pub(super) fn volume_remarks(
    model: &mut Model,
    derivation: &Derivation,
    dynamics: &Dynamics,
    stated: Option<(ExprId, &str)>,
    seed: u64,
) -> Vec<String> {
    let mut remarks = Vec::new();
    for surface in 0..model.surfaces.len() {
        if model.surfaces[surface].law == Law::Transition {
            let (name, law) = (
                &model.surfaces[surface].name.display,
                model.law_text(surface),
            );
            remarks.push(format!(
                "{name} ({law}) leaves this mode, and what it does to a volume is not looked at"
            ));
            continue;
        }
        if !model.surfaces[surface].instantaneous.is_empty() {
            let name = &model.surfaces[surface].name.display;
            // States on a line along the impulses of the constraints become one.
            remarks.push(format!(
                "an impact at {name} maps it to 0, as its instantaneous constraints do"
            ));
            continue;
        }
        let wall = Wall::of(model, derivation, surface);
        if let Some(reason) = wall.reset.as_ref().and_then(ResetMap::open) {
            let name = &model.surfaces[surface].name.display;
            remarks.push(format!("an impact at {name} may change it: {reason}"));
            continue;
        }
        let volume = Volume {
            wall: &wall,
            stated,
        };
        let found = evidence_at_impact(model, &wall, dynamics, &volume, seed);
        let effect = match (found.verdict(true, Wording::default(), seed), stated) {
            (Verdict::Proved(_), _) => "keeps it".to_owned(),
            (Verdict::Refuted(_), None) => factor(model, surface, &wall),
            (Verdict::Refuted(witness), Some(_)) => changed(&witness),
            (Verdict::Undecided(_), None) => {
                format!("{}, if that is not 1", factor(model, surface, &wall))
            }
            (Verdict::Undecided(reason), Some(_)) => format!("may change it: {reason}"),
        };
        let declared = &model.surfaces[surface];
        let moving = match model
            .pool
            .is_syntactic_zero(derivation.surfaces[surface].rate)
        {
            true => "",
            false => ", which moves,",
        };
        let (name, law) = (&declared.name.display, model.law_text(surface));
        remarks.push(format!("an impact at {name}{moving} ({law}) {effect}"));
    }
    remarks
}

/// The Jacobian of a law in words.
fn factor(model: &Model, surface: usize, wall: &Wall) -> String {
    const RHO: &str = "rho = dh(pi_D grad h)/dh(grad h)";
    const RATES: &str = "G the gap rate before and after";
    let is_affine = model
        .constraints
        .iter()
        .any(|own| !model.pool.is_syntactic_zero(own.affine));
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
        Law::Transition => "leaves this mode".to_owned(),
        Law::Reset => match wall
            .reset
            .as_ref()
            .and_then(|own| own.factor_text(&model.pool))
        {
            Some(factor) => format!("multiplies it by {factor}"),
            None => format!("multiplies it by |D*G+/G-|, D the determinant of its reset, {RATES}"),
        },
    }
}

fn changed(witness: &Witness) -> String {
    let values: Vec<String> = witness
        .values
        .iter()
        .map(|(name, value)| format!("{name} = {}", super::finding::digits(*value)))
        .collect();
    let at = witness
        .sample
        .as_ref()
        .map_or(String::new(), |own| format!(" at {}", own.text()));
    match values.is_empty() {
        true => "does not keep it".to_owned(),
        false => format!("does not keep it: {}{at}", values.join(", ")),
    }
}

/// The change of a volume in an impact.
struct Volume<'v> {
    wall: &'v Wall,
    stated: Option<(ExprId, &'v str)>,
}

impl AtImpact for Volume<'_> {
    fn roots(&self) -> Vec<ExprId> {
        self.stated.iter().map(|(value, _)| *value).collect()
    }

    /// `(f+ J)^2 - (f-)^2`: both are positive, and squares do not depend on the branch of an absolute value.
    fn terms<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        after: &[Number<P>],
    ) -> Option<Vec<Number<P>>> {
        let field = point.field();
        let jacobian = self.wall.jacobian(model, point, after)?;
        let [new, old] = match self.stated {
            Some((value, _)) => after_and_before(model, point, after, value)?,
            None => [field.integer(1); 2],
        };
        let after = field.mul(new, jacobian);
        Some(vec![
            field.mul(after, after),
            field.neg(field.mul(old, old)),
        ])
    }

    fn scale(&self, model: &Model, point: &mut RealPoint, after: &[f64]) -> Option<f64> {
        let terms = self.terms(model, point, after)?;
        Some(terms.iter().map(|term| term.abs()).sum())
    }

    fn shown(&self, terms: &[f64], sum: f64) -> Vec<(String, f64)> {
        let names = match self.stated {
            Some((_, written)) => [
                format!("{written} after times the Jacobian"),
                format!("{written} before"),
            ],
            None => ["Jacobian".to_owned(), "1".to_owned()],
        };
        let sizes = [terms[0].abs().sqrt(), terms[1].abs().sqrt()];
        with_difference(names, sizes, sum / (sizes[0] + sizes[1]))
    }
}
