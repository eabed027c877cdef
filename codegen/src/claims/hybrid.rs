//! What impacts do to an invariant volume `f mu_C`: it is kept if `f+ J = f-`, J the Jacobian of [`super::wall`].

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, ModularPoint, RealPoint};

use super::dynamics::{Dynamics, Number};
use super::evidence::{Vanishing, Wording};
use super::finding::{Verdict, Witness};
use super::sample::Sample;
use super::wall::{AtImpact, Place, Wall, evidence_at_impact};
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
        let volume = Volume {
            wall: Wall::of(model, derivation, surface),
            dynamics,
            stated,
            place: Place::Anywhere,
        };
        let effect = match (volume.verdict(model, seed), stated) {
            (Verdict::Proved(_), _) => "keeps it".to_owned(),
            (Verdict::Refuted(_), None) => factor(model, surface),
            (Verdict::Refuted(witness), Some(_)) => changed(&witness),
            (Verdict::Undecided(_), None) => {
                format!("{}, if that is not 1", factor(model, surface))
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
        let (name, law) = (&declared.name.display, declared.law.text(&model.pool));
        remarks.push(format!("an impact at {name}{moving} ({law}) {effect}"));
    }
    remarks
}

/// The Jacobian of a law in words.
fn factor(model: &Model, surface: usize) -> String {
    const RHO: &str = "rho = dh(pi_D grad h)/dh(grad h)";
    const RATES: &str = "G the gap rate before and after";
    let is_affine = model
        .constraints
        .iter()
        .any(|own| !model.pool.is_syntactic_zero(own.affine));
    let squared = |e: ExprId| match model.pool.as_number(e) {
        Some(number) if number.is_zero() => "maps it to 0".to_owned(),
        _ => format!("multiplies it by ({})^2", model.pool.text(e)),
    };
    match model.surfaces[surface].law {
        Law::Elastic => format!("multiplies it by -G+/G-, {RATES}"),
        Law::Restitution(e) if is_affine => {
            format!("multiplies it by -({})*G+/G-, {RATES}", model.pool.text(e))
        }
        Law::Restitution(e) | Law::Newton(e) => squared(e),
        Law::NonholonomicPlastic => format!("multiplies it by (1 - 2*rho)^2, {RHO}"),
        Law::ImpactPlastic => "maps it to 0".to_owned(),
        Law::TotallyPlastic => format!("multiplies it by (1 - rho)^2, {RHO}"),
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
    wall: Wall,
    dynamics: &'v Dynamics,
    stated: Option<(ExprId, &'v str)>,
    place: Place,
}

impl Volume<'_> {
    fn verdict(mut self, model: &Model, seed: u64) -> Verdict {
        let wording = Wording {
            vanishes: String::new(),
            differs: String::new(),
            help: [String::new(), String::new()],
        };
        evidence_at_impact(model, &mut self, seed).verdict(true, wording, seed)
    }

    /// `f+`, `f-` and `J`
    fn parts<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<[Number<P>; 3]> {
        let after = self.wall.after(model, point)?;
        let jacobian = self.wall.jacobian(model, point, &after)?;
        let one = point.field().integer(1);
        let Some((value, _)) = self.stated else {
            return Some([one, one, jacobian]);
        };
        let old = value_at(model, point, value)?;
        let before: Vec<_> = model
            .coordinates
            .iter()
            .map(|own| point.symbol(&model.pool, own.qdot))
            .collect();
        let set = |velocities: &[Number<P>], point: &mut P| {
            for (coordinate, velocity) in model.coordinates.iter().zip(velocities) {
                point.set_symbol(coordinate.qdot, *velocity);
            }
        };
        set(&after, point);
        let new = value_at(model, point, value)?;
        set(&before, point);
        Some([new, old, jacobian])
    }
}

fn value_at<P: ExpansionPoint>(model: &Model, point: &mut P, value: ExprId) -> Option<Number<P>> {
    let values = point.values(&model.pool, &model.pool.reachable(&[value]))?;
    Some(values[value.index()])
}

impl AtImpact for Volume<'_> {
    fn place(&mut self) -> &mut Place {
        &mut self.place
    }
}

impl Vanishing for Volume<'_> {
    fn roots(&self) -> Vec<ExprId> {
        let mut roots = self.dynamics.roots();
        roots.extend(&self.wall.roots);
        roots.extend([self.wall.gap, self.wall.gap_rate]);
        roots.extend(self.stated.map(|(value, _)| value));
        roots
    }

    fn settle(&self, model: &Model, point: &mut ModularPoint) -> Option<()> {
        self.wall.settle(model, point, self.place)?;
        self.dynamics.motion(&model.pool, point, None).map(|_| ())
    }

    fn sample(&self, model: &Model, attempt: usize) -> Option<(Sample, RealPoint)> {
        self.wall
            .incoming(model, self.dynamics, attempt, self.roots())
    }

    /// `(f+ J)^2 - (f-)^2`: both are positive, and squares do not depend on the branch of an absolute value.
    fn terms<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
        let [new, old, jacobian] = self.parts(model, point)?;
        let field = point.field();
        let after = field.mul(new, jacobian);
        Some(vec![
            field.mul(after, after),
            field.neg(field.mul(old, old)),
        ])
    }

    fn scale(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        let terms = self.terms(model, point)?;
        Some(terms.iter().map(|term| term.abs()).sum())
    }

    fn shown(&self, _: &Model, terms: &[f64]) -> Vec<(String, f64)> {
        let names = match self.stated {
            Some((_, written)) => [
                format!("{written} after times the Jacobian"),
                format!("{written} before"),
            ],
            None => ["Jacobian".to_owned(), "1".to_owned()],
        };
        let sizes = [terms[0].abs().sqrt(), terms[1].abs().sqrt()];
        names.into_iter().zip(sizes).collect()
    }
}
