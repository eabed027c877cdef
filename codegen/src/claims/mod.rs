//! Stage 3b, prove or refute: what a model's author claims about it.
//!
//! | file | job |
//! |---|---|
//! | `problem.rs` | what an invariant density depends on |
//! | `linear.rs`, `frame.rs`, `closure.rs` | the frame of D as series, and its hull under brackets |
//! | `exactness.rs` | does a local density exist? |
//! | `potential.rs`, `global.rs`, `regularity.rs` | the density in closed form; is it single-valued, and regular? |
//! | `volume.rs` | the volume with that density, as it is lowered |
//! | `momentum.rs`, `darboux.rs`, `ansatz.rs`, `elimination.rs` | densities that depend on velocities |
//! | `conditions.rs`, `exceptional.rs`, `polynomial.rs` | conditions on parameters under which a density exists |
//! | `alternatives.rs` | both of these in words |
//! | `geometry.rs`, `dynamics.rs` | frame and theta, and the motion on D, at a point |
//! | `evidence.rs`, `continuity.rs` | does something vanish at all states? may it jump all the same? |
//! | `existence.rs`, `density.rs`, `conserved.rs`, `impact.rs`, `symmetry.rs` | the verdict on each kind of claim |
//! | `wall.rs`, `hybrid.rs` | the map of an impact; what it does to a volume |
//! | `obstruction.rs`, `sample.rs` | points that a person can follow |
//! | `finding.rs`, `undecided.rs` | verdicts in words |
//!
//! Decisions are taken modulo 61-bit primes at random points; values in double precision are for witnesses, and where
//! residues alone do not decide.

mod alternatives;
mod ansatz;
mod closure;
mod conditions;
mod conserved;
mod continuity;
mod darboux;
mod density;
pub mod dynamics;
mod elimination;
mod evidence;
pub mod exactness;
mod exceptional;
mod existence;
mod finding;
mod frame;
mod geometry;
mod global;
mod hybrid;
mod impact;
mod linear;
mod momentum;
mod obstruction;
mod polynomial;
mod potential;
pub mod problem;
mod regularity;
mod sample;
mod symmetry;
mod undecided;
mod volume;
mod wall;

use dalembert_expr::{ExprId, Rational, SymbolId};

pub use conditions::{Condition, Equation, Scan, find_conditions};
pub use dynamics::{Dynamics, Motion};
pub use exactness::{Exactness, Local, decide, decide_local};
pub use existence::{Decision, potential_text};
pub use finding::{Certificate, Finding, Verdict, Witness};
pub use geometry::{Geometry, geometry_at};
pub use global::Global;
pub use momentum::{MomentumDensity, find_momentum_density};
pub use obstruction::{Obstruction, find_obstruction};
pub use potential::{Certified, Potential, Term};
pub use problem::Problem;
pub use sample::Sample;
pub use undecided::Undecided;
pub use volume::Volume;

use crate::mechanics::Derivation;
use crate::model::{Claim, Existence, Model, Statement};

/// What became of the claims of a model.
#[derive(Debug, Default)]
pub struct Examined {
    /// The verdicts, in order.
    pub findings: Vec<Finding>,
    /// The invariant volume whose density is proved and known in closed form, a stated one before one that was found;
    /// `None` if no claim is about one.
    pub volume: Option<Volume>,
}

/// The verdicts on all claims of a model; without claims nothing is done.
pub fn examine(model: &mut Model, derivation: &Derivation) -> Examined {
    if model.claims.is_empty() {
        return Examined::default();
    }
    let mut examiner = Examiner {
        seed: finding::seed_of(&model.snake_name),
        problem: Problem::of(model, derivation),
        dynamics: Dynamics::of(model, derivation),
        decision: None,
        model,
        derivation,
    };
    let claims = examiner.model.claims.clone();
    let has_states = conserved::has_states(examiner.model, &examiner.dynamics);
    let findings: Vec<Finding> = claims
        .iter()
        .map(|claim| match has_states {
            true => examiner.finding(claim),
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
    Examined { findings, volume }
}

/// A claim that nothing was found out about.
fn open(claim: &Claim, reason: Undecided) -> Finding {
    Finding {
        claim: claim.text.clone(),
        is_assumed: claim.is_assumed,
        item: claim.item,
        verdict: Verdict::Undecided(reason.to_string()),
        remarks: Vec::new(),
    }
}

/// What the verdicts on several claims share.
struct Examiner<'e> {
    model: &'e mut Model,
    derivation: &'e Derivation,
    problem: Problem,
    dynamics: Dynamics,
    decision: Option<Decision>,
    seed: u64,
}

impl Examiner<'_> {
    fn finding(&mut self, claim: &Claim) -> Finding {
        let mut remarks = Vec::new();
        let verdict = match &claim.statement {
            Statement::Existence(existence) => {
                let decision = match self.decision.take() {
                    Some(decision) => decision,
                    None => decide(self.model, &self.problem, self.seed),
                };
                let verdict = existence::check_existence(
                    self.model,
                    &self.problem,
                    &decision,
                    *existence,
                    self.seed,
                );
                if let Ok(exactness) = &decision
                    && !matches!(verdict, Verdict::Undecided(_))
                {
                    remarks = self.volume_remarks(exactness);
                }
                self.decision = Some(decision);
                verdict
            }
            Statement::Density(value) => {
                let value = self.explicit(*value);
                let written = claim.text.trim_start_matches("density = ");
                let (problem, dynamics) = (&self.problem, &self.dynamics);
                let stated = (value, written);
                let verdict =
                    density::check_density(self.model, problem, dynamics, stated, self.seed);
                if matches!(verdict, Verdict::Proved(_)) {
                    remarks = self.impacts(Some(stated));
                }
                verdict
            }
            Statement::Conserved {
                value,
                under,
                holds,
            } => {
                let value = self.explicit(*value);
                let written = claim.text.split_once(": ").map_or("", |(_, value)| value);
                let quantity = (value, written);
                match under {
                    None => conserved::check_conserved(
                        self.model,
                        &self.dynamics,
                        quantity,
                        *holds,
                        self.seed,
                    ),
                    Some(surface) => impact::check_conserved_under(
                        self.model,
                        self.derivation,
                        &self.dynamics,
                        *surface,
                        quantity,
                        *holds,
                        self.seed,
                    ),
                }
            }
            Statement::Symmetry(field) => {
                let (verdict, equation) =
                    symmetry::check_symmetry(self.model, &self.dynamics, field);
                remarks = equation;
                verdict
            }
        };
        Finding {
            claim: claim.text.clone(),
            is_assumed: claim.is_assumed,
            item: claim.item,
            verdict,
            remarks,
        }
    }

    /// What impacts do to the volume where there is one, and what there is instead where there is none.
    fn volume_remarks(&mut self, exactness: &Exactness) -> Vec<String> {
        let mut remarks = alternatives::alternatives(
            self.model,
            self.derivation,
            &self.problem,
            exactness,
            self.seed,
        );
        if exactness.global.is_some() {
            remarks.extend(self.impacts(None));
        }
        remarks
    }

    /// What impacts do to a volume.
    fn impacts(&mut self, stated: Option<(ExprId, &str)>) -> Vec<String> {
        let (derivation, dynamics) = (self.derivation, &self.dynamics);
        hybrid::volume_remarks(self.model, derivation, dynamics, stated, self.seed)
    }

    /// The volume that these statements are about.
    fn volume(&mut self, proved: &[&Statement]) -> Option<Volume> {
        for statement in proved {
            let Statement::Density(value) = statement else {
                continue;
            };
            let density = self.explicit(*value);
            let (derivation, problem) = (self.derivation, &self.problem);
            let stated = Volume::stated(self.model, derivation, problem, density, self.seed);
            if stated.is_some() {
                return stated;
            }
        }
        let exists = |own: &&&Statement| {
            matches!(
                own,
                Statement::Existence(Existence::Global | Existence::Local)
            )
        };
        proved.iter().find(exists)?;
        let exactness = self.decision.as_ref()?.as_ref().ok()?;
        Volume::found(self.model, self.derivation, exactness)
    }

    /// The expression with energy and momenta written out.
    fn explicit(&mut self, value: ExprId) -> ExprId {
        let model = &mut *self.model;
        let whole = model.lagrangian.whole;
        let mut replacements: Vec<(SymbolId, ExprId)> = Vec::new();
        for i in 0..model.coordinates.len() {
            let momentum = model.pool.diff(whole, model.coordinates[i].qdot);
            replacements.push((model.derived.momenta[i], momentum));
        }
        let energy = energy(model);
        replacements.push((model.derived.energy, energy));
        model.pool.substitute(value, &replacements)
    }
}

/// `1/2 g(qdot, qdot) + V`
fn energy(model: &mut Model) -> ExprId {
    let mut terms = vec![model.lagrangian.potential];
    for i in 0..model.coordinates.len() {
        for j in 0..=i {
            let factor = if i == j {
                Rational::new(1, 2)
            } else {
                Rational::from(1)
            };
            let [a, b] = [i, j].map(|k| model.pool.variable(model.coordinates[k].qdot));
            let product = model.pool.product(&[model.lagrangian.metric[i][j], a, b]);
            terms.push(model.pool.scale(&factor, product));
        }
    }
    model.pool.sum(&terms)
}
