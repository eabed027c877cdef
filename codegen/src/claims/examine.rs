//! Verdicts on all claims of a model, in order.

use dalembert_expr::{ExprId, SymbolId};

use super::defaults::{
    Defaults, absence_at_defaults, curvature_at_defaults, existence_at_defaults,
};
use super::dynamics::Dynamics;
use super::exactness::{Exactness, decide};
use super::existence::{self, Decision};
use super::finding::{ClosedForm, Finding, Verdict};
use super::global::Global;
use super::hybrid::{self, Density, Effect, Surroundings};
use super::invariant::Stated;
use super::problem::Problem;
use super::undecided::Undecided;
use super::volume::Volume;
use super::{
    abrupt, alternatives, conserved, corollaries, density, energy, equivariance, impact,
    integrable, invariant, involution, jumps, kept, symmetry, symplectic,
};
use crate::mechanics::Derivation;
use crate::mechanics::energy::total_energy;
use crate::model::{Claim, Existence, Model, Statement};

/// Results for the claims of a model.
#[derive(Debug, Default)]
pub struct Examined {
    /// The findings, in the order of the claims.
    pub findings: Vec<Finding>,
    /// Invariant volume with a proved density that can be emitted. A stated density takes precedence over one that was
    /// found. `None` if no claim about a volume is proved, or if its density cannot be emitted.
    pub volume: Option<Volume>,
}

/// Examines all claims about the model itself (not about a scene). Without claims nothing is computed.
pub fn examine(model: &mut Model, derivation: &Derivation) -> Examined {
    examine_mode(model, derivation, &[])
}

/// Same as [`examine()`], for one mode of a model. `others` are all modes in order, this one included.
pub fn examine_mode(model: &mut Model, derivation: &Derivation, others: &[&Model]) -> Examined {
    let claims = model.own_claims();
    if claims.is_empty() {
        return Examined::default();
    }
    if model.is_nonlinear() {
        return Examined {
            findings: examine_nonlinear(model, derivation, &claims),
            volume: None,
        };
    }
    let mut examiner = Examiner::of(model, derivation, others);
    let has_states = conserved::has_states(examiner.model, &examiner.dynamics);
    let mut findings: Vec<Finding> = claims
        .iter()
        .map(|claim| match has_states {
            true => examiner.confirmed(claim),
            false => open(claim, Undecided::Stateless),
        })
        .collect();
    let proved: Vec<&Statement> = claims
        .iter()
        .zip(&findings)
        .filter(|(_, finding)| matches!(finding.verdict, Verdict::Proved(_)))
        .map(|(claim, _)| &claim.statement)
        .collect();
    let volume = examiner.volume(&proved);
    if let Some(remark) = examiner.numeric(volume.as_ref()) {
        let existence = |finding: &&mut Finding| {
            finding.claim.starts_with("density: ") && matches!(finding.verdict, Verdict::Proved(_))
        };
        if let Some(finding) = findings.iter_mut().find(existence) {
            finding.remarks.insert(0, remark);
        }
    }
    Examined { findings, volume }
}

/// Verdicts for a model with constraints that are nonlinear in the velocities. Only conserved quantities and forms are
/// examined.
fn examine_nonlinear(model: &mut Model, derivation: &Derivation, claims: &[Claim]) -> Vec<Finding> {
    let seed = model.pool.seed();
    let whole = Dynamics::of(model, derivation);
    let parts = whole.clone().on_branches(model, derivation);
    let parts = parts.unwrap_or_default();
    let verdict = |claim: &Claim| match &claim.statement {
        Statement::Conserved {
            value,
            under: None,
            holds,
        } => {
            let written = claim.text.split_once(": ").map_or("", |(_, value)| value);
            let value = explicit(model, *value);
            conserved::check_conserved(model, &parts, (value, written), *holds, seed)
        }
        Statement::Symplectic | Statement::Invariant(_) => {
            // Other modes are not examined.
            let around = Surroundings {
                derivation,
                dynamics: &whole,
                others: &[],
                seed,
            };
            let (symplectic, name) = symplectic::symplectic_form(model);
            let stated = match &claim.statement {
                Statement::Invariant(form) => {
                    let written = claim.text.trim_start_matches("invariant: ");
                    Stated::named(form, written)
                }
                _ => symplectic::stated(&symplectic, &name),
            };
            invariant::check_on_parts(model, &around, &parts, stated)
        }
        _ => Verdict::Undecided(Undecided::Nonlinear.to_string()),
    };
    let verdicts: Vec<Verdict> = claims.iter().map(verdict).collect();
    let verdicts = verdicts.into_iter().zip(claims).map(|(verdict, claim)| {
        abrupt::unless_abrupt(model, derivation, &parts, claim, verdict, seed)
    });
    let verdicts: Vec<Verdict> = verdicts.collect();
    let findings = claims.iter().zip(verdicts);
    findings
        .map(|(claim, verdict)| Finding {
            verdict,
            ..open(claim, Undecided::Nonlinear)
        })
        .collect()
}

/// Same as [`examine()`], for a scene. If the scene asks for a volume and no claim provides one, a density is sought.
pub fn examine_scene(model: &mut Model, derivation: &Derivation) -> Examined {
    let mut examined = examine(model, derivation);
    if model.extras.volume && examined.volume.is_none() {
        let (verdict, remarks, volume) = examine_volume(model, derivation);
        let found = match verdict {
            Verdict::Proved(certificate) => certificate.to_string(),
            Verdict::Refuted(witness) => witness.to_string(),
            Verdict::Undecided(reason) => format!("undecided: {reason}"),
        };
        let found = [vec![found], remarks].concat().join("; ");
        model.notes.push(format!("density of the scene: {found}"));
        examined.volume = volume;
    }
    examined
}

/// Verdict on `density: exact`, whether claimed or not, with remarks, and the volume if it can be emitted.
pub fn examine_volume(
    model: &mut Model,
    derivation: &Derivation,
) -> (Verdict, Vec<String>, Option<Volume>) {
    if model.is_nonlinear() {
        let reason = Undecided::Nonlinear.to_string();
        return (Verdict::Undecided(reason), Vec::new(), None);
    }
    let mut examiner = Examiner::of(model, derivation, &[]);
    if !conserved::has_states(examiner.model, &examiner.dynamics) {
        let reason = Undecided::Stateless.to_string();
        return (Verdict::Undecided(reason), Vec::new(), None);
    }
    let (verdict, remarks) = examiner.existence(Existence::Global);
    if matches!(verdict, Verdict::Proved(_)) {
        let (model, around) = examiner.around();
        let jump = abrupt::breaks_volume(model, derivation, around.dynamics, around.seed);
        if let Some(jump) = jump {
            return (Verdict::Undecided(abrupt::reason(&jump)), Vec::new(), None);
        }
    }
    // A density found only for indeterminate parameters is not a density at the declared values.
    let is_special = |exactness: &Exactness| {
        !matches!(verdict, Verdict::Proved(_)) && exactness.global == Some(Global::Exists)
    };
    let volume = match &examiner.decision {
        Some(Ok(exactness)) if !is_special(exactness) => Volume::found(
            examiner.model,
            derivation,
            &examiner.problem,
            exactness,
            examiner.seed,
        ),
        _ => None,
    };
    (verdict, remarks, volume)
}

/// The finding on a claim that stays open for a reason.
fn open(claim: &Claim, reason: Undecided) -> Finding {
    Finding {
        claim: claim.text.clone(),
        is_assumed: claim.is_assumed,
        item: claim.item,
        verdict: Verdict::Undecided(reason.to_string()),
        remarks: Vec::new(),
        density: None,
    }
}

/// Data shared by the verdicts on all claims.
struct Examiner<'e> {
    model: &'e mut Model,
    derivation: &'e Derivation,
    others: &'e [&'e Model],
    problem: Problem,
    dynamics: Dynamics,
    decision: Option<Decision>,
    seed: u64,
}

impl<'e> Examiner<'e> {
    fn of(model: &'e mut Model, derivation: &'e Derivation, others: &'e [&'e Model]) -> Self {
        Self {
            others,
            seed: model.pool.seed(),
            problem: Problem::of(model, derivation),
            dynamics: Dynamics::of(model, derivation),
            decision: None,
            model,
            derivation,
        }
    }

    /// The finding on a claim, left open if the equations of motion may jump.
    fn confirmed(&mut self, claim: &Claim) -> Finding {
        let found = self.finding(claim);
        let (model, around) = self.around();
        let is_closed = !matches!(found.verdict, Verdict::Undecided(_));
        let parts = std::slice::from_ref(around.dynamics);
        let verdict = abrupt::unless_abrupt(
            model,
            around.derivation,
            parts,
            claim,
            found.verdict,
            around.seed,
        );
        match (is_closed, &verdict) {
            (true, Verdict::Undecided(_)) => Finding {
                verdict,
                remarks: Vec::new(),
                density: None,
                ..found
            },
            _ => Finding { verdict, ..found },
        }
    }

    fn finding(&mut self, claim: &Claim) -> Finding {
        let (verdict, remarks) = match &claim.statement {
            Statement::Existence(existence) => self.existence(*existence),
            Statement::Density(value) => {
                let written = claim.text.trim_start_matches("density = ");
                self.density(*value, written)
            }
            Statement::Conserved {
                value,
                under,
                holds,
            } => {
                let written = claim.text.split_once(": ").map_or("", |(_, value)| value);
                (
                    self.conserved((*value, written), *under, *holds),
                    Vec::new(),
                )
            }
            Statement::Symmetry(field) => self.symmetry(field),
            Statement::Invariant(form) => {
                let written = claim.text.trim_start_matches("invariant: ");
                let (model, around) = self.around();
                let verdict = invariant::check_invariant(model, &around, form, written);
                (verdict, Vec::new())
            }
            Statement::Involution(functions) => {
                let (model, around) = self.around();
                let verdict = involution::check_involution(model, &around, functions);
                (verdict, Vec::new())
            }
            Statement::Integrable(functions) => {
                let (model, around) = self.around();
                let verdict = integrable::check_integrable(model, &around, functions);
                (verdict, Vec::new())
            }
            Statement::VolumeKept => self.volume_kept(),
            Statement::Factor { value, under } => {
                let written = claim
                    .text
                    .split_once("factor = ")
                    .map_or("", |(_, text)| text);
                let value = explicit(self.model, *value);
                let (model, around) = self.around();
                let verdict = kept::check_factor(model, &around, *under, (value, written));
                let remarks = corollaries::of_factor(model, &verdict, value);
                (verdict, remarks)
            }
            Statement::Symplectic => {
                let (model, around) = self.around();
                (symplectic::check_symplectic(model, &around), Vec::new())
            }
            Statement::EnergyNotIncreasing(surface) => {
                let (model, around) = self.around();
                let verdict = energy::check_not_increasing(model, &around, *surface);
                (verdict, Vec::new())
            }
        };
        Finding {
            claim: claim.text.clone(),
            is_assumed: claim.is_assumed,
            item: claim.item,
            density: self.closed_form(&claim.statement, &verdict),
            verdict,
            remarks,
        }
    }

    /// Verdict on a symmetry. The remarks give the change of its momentum along the motion and at surfaces.
    fn symmetry(&mut self, field: &[ExprId]) -> (Verdict, Vec<String>) {
        let (verdict, mut remarks) =
            symmetry::check_symmetry(self.model, &self.dynamics, field, self.seed);
        if matches!(verdict, Verdict::Proved(_)) {
            let (model, around) = self.around();
            remarks.extend(match model.is_first_order() {
                true => equivariance::symmetry_at_surfaces(model, &around, field),
                false => jumps::momentum_at_surfaces(model, &around, field),
            });
        }
        (verdict, remarks)
    }

    /// The closed form of the density whose existence was proved, if there is one.
    fn closed_form(&self, statement: &Statement, verdict: &Verdict) -> Option<ClosedForm> {
        let is_found = match statement {
            Statement::Existence(Existence::Global | Existence::Local) => true,
            Statement::VolumeKept => stated_density_is_absent(self.model),
            _ => false,
        };
        if !is_found || !matches!(verdict, Verdict::Proved(_)) {
            return None;
        }
        let exactness = self.decision.as_ref()?.as_ref().ok()?;
        let (potential, _) = exactness.density.as_ref()?;
        Some(ClosedForm {
            potential: potential.clone(),
            dependent: exactness.local.dependent.clone(),
        })
    }

    /// Verdict on a density for the motion between impacts.
    fn existence_of_the_motion(&mut self, existence: Existence) -> Verdict {
        let decision = match self.decision.take() {
            Some(decision) => decision,
            None => decide(self.model, &self.problem, self.seed),
        };
        let (problem, seed) = (&self.problem, self.seed);
        let generic = existence::check_existence(self.model, problem, &decision, existence, seed);
        let is_generic = matches!(generic, Verdict::Proved(_));
        let verdict = match (&decision, existence) {
            // NOTE: `locally_exact` stays proved even if the periods happen to vanish at the defaults.
            (Ok(_), Existence::Local) => generic,
            (Err(_), _) if problem.curved().is_some() => {
                curvature_at_defaults(self.model, problem, &self.dynamics, generic, seed)
            }
            (Err(_), _) => generic,
            (Ok(exactness), _) if is_generic => {
                let claim = (existence, generic);
                existence_at_defaults(self.model, problem, exactness, claim, seed)
            }
            (Ok(_), Existence::None) if matches!(generic, Verdict::Refuted(_)) => {
                absence_at_defaults(self.model, problem, generic, seed)
            }
            _ => generic,
        };
        self.decision = Some(decision);
        verdict
    }

    /// Verdict on a claim of existence. The remarks give the effects of impacts on the volume.
    fn existence(&mut self, existence: Existence) -> (Verdict, Vec<String>) {
        let verdict = self.existence_of_the_motion(existence);
        let is_none = existence == Existence::None;
        let Some(Ok(exactness)) = self.decision.take() else {
            return (verdict, Vec::new());
        };
        // A density found only for indeterminate parameters is not a density at the declared values.
        let is_special = match &verdict {
            Verdict::Proved(_) => false,
            Verdict::Undecided(_) => true,
            Verdict::Refuted(_) => !is_none && exactness.global == Some(Global::Exists),
        };
        let mut remarks = Vec::new();
        let mut effects = Vec::new();
        if !is_special {
            remarks = self.alternatives(&exactness);
            if exactness.global.is_some() {
                let density = self.found_density(&exactness);
                effects = self.effects(&density);
            }
            remarks.extend(self.sentences(&effects));
            remarks.extend(corollaries::of_effects(self.model, &effects));
        }
        self.decision = Some(Ok(exactness));
        (self.qualified(verdict, &effects), remarks)
    }

    /// The verdict on a density of the motion, qualified by the surfaces that do not preserve its volume.
    fn qualified(&self, verdict: Verdict, effects: &[Effect]) -> Verdict {
        match verdict {
            Verdict::Proved(proof) => Verdict::Proved(kept::qualified(self.model, proof, effects)),
            other => other,
        }
    }

    fn density(&mut self, value: ExprId, written: &str) -> (Verdict, Vec<String>) {
        let value = explicit(self.model, value);
        let verdict = self.density_of_the_motion((value, written));
        let effects = match verdict {
            Verdict::Proved(_) => self.effects(&Density {
                value: Some(value),
                written: Some(written.to_owned()),
                is_found: false,
            }),
            _ => Vec::new(),
        };
        (self.qualified(verdict, &effects), self.sentences(&effects))
    }

    /// Verdict on a stated density, for the motion between impacts.
    fn density_of_the_motion(&mut self, stated: (ExprId, &str)) -> Verdict {
        let (problem, dynamics) = (&self.problem, &self.dynamics);
        if let Some(rates) = self.model.field.clone() {
            return density::check_rates(self.model, dynamics, &rates, stated, self.seed);
        }
        let generic = density::check_density(self.model, problem, dynamics, stated, self.seed);
        self.stated_at_defaults(stated, generic)
    }

    /// Verdict on one volume that all modes and surfaces preserve.
    fn volume_kept(&mut self) -> (Verdict, Vec<String>) {
        let stated = kept::stated_or_one(self.model);
        let is_looked_for = stated.written.is_none() && self.model.field.is_none();
        let (density, flow) = match is_looked_for {
            true => {
                let flow = self.existence_of_the_motion(Existence::Global);
                let density = match &self.decision {
                    Some(Ok(exactness)) => {
                        let potential = exactness
                            .density
                            .as_ref()
                            .map(|(density, _)| density.clone());
                        kept::of_potential(&mut self.model.pool, potential.as_ref())
                    }
                    _ => stated,
                };
                (density, flow)
            }
            false => {
                let value = stated.value.unwrap_or_else(|| self.model.pool.one());
                let written = stated.written.clone().unwrap_or_else(|| "1".to_owned());
                let flow = self.density_of_the_motion((value, &written));
                (stated, flow)
            }
        };
        let (model, around) = self.around();
        kept::check_kept(model, &around, &density, flow)
    }

    fn conserved(
        &mut self,
        (value, written): (ExprId, &str),
        under: Option<usize>,
        holds: bool,
    ) -> Verdict {
        let Some(surface) = under else {
            let quantity = (explicit(self.model, value), written);
            let parts = std::slice::from_ref(&self.dynamics);
            return conserved::check_conserved(self.model, parts, quantity, holds, self.seed);
        };
        let (model, around) = self.around();
        impact::check_conserved_under(model, &around, surface, (value, written), holds)
    }

    /// Verdict on a stated density at the default parameters, given the verdict for indeterminate parameters.
    fn stated_at_defaults(
        &mut self,
        (value, written): (ExprId, &str),
        generic: Verdict,
    ) -> Verdict {
        let Some((defaults, value, dynamics)) = self.at_defaults(value, &generic) else {
            return generic;
        };
        let pool = &mut self.model.pool;
        let problem = self.problem.substituted(pool, defaults.replacements());
        let stated = (value, written);
        let declared = density::check_balance(self.model, &problem, &dynamics, stated, self.seed);
        defaults.confirmed(generic, declared)
    }

    /// The defaults, with the expression and the motion at the defaults. `None` if there are no defaults, or if
    /// `generic` is not a proof.
    fn at_defaults(
        &mut self,
        value: ExprId,
        generic: &Verdict,
    ) -> Option<(Defaults, ExprId, Dynamics)> {
        let mut roots = self.dynamics.roots();
        roots.push(value);
        let defaults = Defaults::of(self.model, &roots);
        if defaults.is_empty() || !matches!(generic, Verdict::Proved(_)) {
            return None;
        }
        let pool = &mut self.model.pool;
        let value = pool.substitute(value, defaults.replacements());
        let dynamics = self.dynamics.substituted(pool, defaults.replacements());
        Some((defaults, value, dynamics))
    }

    /// Suggestions for a model without a density, as text.
    fn alternatives(&mut self, exactness: &Exactness) -> Vec<String> {
        alternatives::alternatives(
            self.model,
            self.derivation,
            &self.problem,
            exactness,
            self.seed,
        )
    }

    /// The density that was found, written out as far as possible.
    fn found_density(&mut self, exactness: &Exactness) -> Density {
        let potential = exactness.density.as_ref().map(|(density, _)| density);
        kept::of_potential(&mut self.model.pool, potential)
    }

    /// Effects of all surfaces on the volume of a density.
    fn effects(&mut self, density: &Density) -> Vec<Effect> {
        let (model, around) = self.around();
        hybrid::effects(model, &around, density)
    }

    fn sentences(&self, effects: &[Effect]) -> Vec<String> {
        let sentence = |effect: &Effect| effect.sentence(self.model, self.derivation);
        effects.iter().map(sentence).collect()
    }

    /// The model, with the data for the examination of its surfaces.
    fn around(&mut self) -> (&mut Model, Surroundings<'_>) {
        let around = Surroundings {
            derivation: self.derivation,
            dynamics: &self.dynamics,
            others: self.others,
            seed: self.seed,
        };
        (self.model, around)
    }

    /// Remark on the emission of a density without closed form.
    fn numeric(&self, volume: Option<&Volume>) -> Option<String> {
        let exactness = self.decision.as_ref()?.as_ref().ok()?;
        if exactness.global.is_none() || exactness.density.is_some() {
            return None;
        }
        let spans = exactness.local.rank == self.problem.coordinates;
        let reason = match volume.map(|volume| volume.integral.is_some()) {
            Some(true) => return Some("G is emitted as an integral, by quadrature".to_owned()),
            Some(false) => return None,
            None if self.problem.is_time_dependent() => "G depends on time",
            None if !spans => {
                "brackets of D do not span, so that G is not determined up to a constant"
            }
            None => "its gradient takes too many operations",
        };
        Some(format!("`InvariantVolume` is not implemented: {reason}"))
    }

    /// The volume of the proved statements.
    fn volume(&mut self, proved: &[&Statement]) -> Option<Volume> {
        if self.model.is_first_order() {
            return None;
        }
        for statement in proved {
            let Statement::Density(value) = statement else {
                continue;
            };
            let density = explicit(self.model, *value);
            let (derivation, problem) = (self.derivation, &self.problem);
            let stated = Volume::stated(self.model, derivation, problem, density, self.seed);
            if stated.is_some() {
                return stated;
            }
        }
        let exists = |statement: &&&Statement| {
            matches!(
                statement,
                Statement::Existence(Existence::Global | Existence::Local)
            )
        };
        proved.iter().find(exists)?;
        let exactness = self.decision.as_ref()?.as_ref().ok()?;
        Volume::found(
            self.model,
            self.derivation,
            &self.problem,
            exactness,
            self.seed,
        )
    }
}

/// True if no claim states a density.
fn stated_density_is_absent(model: &Model) -> bool {
    let mut claims = model.claims.iter().filter(|claim| claim.scene.is_none());
    claims.all(|claim| !matches!(claim.statement, Statement::Density(_)))
}

/// The expression with energy and momenta replaced by their definitions.
pub(super) fn explicit(model: &mut Model, value: ExprId) -> ExprId {
    let whole = model.lagrangian.whole;
    let mut replacements: Vec<(SymbolId, ExprId)> = Vec::new();
    for i in 0..model.coordinates.len() {
        let momentum = model.pool.diff(whole, model.coordinates[i].qdot);
        replacements.push((model.derived.momenta[i], momentum));
    }
    let total = total_energy(model);
    replacements.push((model.derived.energy, total));
    model.pool.substitute(value, &replacements)
}
