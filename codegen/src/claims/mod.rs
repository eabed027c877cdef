//! Stage 3b, prove or refute: the claims of a model.
//!
//! | file | job |
//! |---|---|
//! | `problem.rs`, `contraction.rs` | the input of the search for a density; the divergence that forces add |
//! | `linear.rs`, `frame.rs`, `closure.rs` | the frame of D as series, and its hull under brackets |
//! | `exactness.rs` | existence of a local density |
//! | `potential.rs`, `fit.rs`, `global.rs`, `growth.rs`, `reflection.rs`, `regularity.rs`, `smoothness.rs`, `leaf.rs` | the density in closed form; its periods and its regularity |
//! | `volume.rs`, `gradient.rs`, `trace.rs` | the volume as it is lowered, with a density in closed form or as an integral |
//! | `momentum.rs`, `darboux.rs`, `ansatz.rs`, `elimination.rs` | densities that depend on velocities |
//! | `conditions.rs`, `exceptional.rs`, `hypersurfaces.rs`, `polynomial.rs` | conditions on parameters under which a density exists |
//! | `alternatives.rs` | conditions, and densities that depend on velocities, as text |
//! | `defaults.rs` | claims at the declared values of parameters |
//! | `geometry.rs`, `dynamics.rs`, `branches.rs` | frame and theta, and the motion on D, at a point |
//! | `locus.rs` | positions that satisfy the position equations and lie on a surface |
//! | `evidence.rs`, `residues.rs`, `continuity.rs` | evidence that a quantity vanishes at all states; places where a quantity may jump |
//! | `existence.rs`, `density.rs`, `conserved.rs`, `impact.rs`, `symmetry.rs` | the verdict on each kind of claim |
//! | `equivariance.rs` | symmetries of motion, surfaces and their maps together |
//! | `gauge.rs` | total derivatives that a symmetry may add to the Lagrangian |
//! | `wall.rs`, `impulse.rs`, `focusing.rs`, `passage.rs`, `refraction.rs`, `side.rs` | the map of an impact, of a reset, of a transition; the modes on both sides of it |
//! | `collision.rs`, `hybrid.rs`, `factor.rs`, `minors.rs`, `sliding.rs`, `landing.rs` | evidence at impacts; the change of a volume, also in closed form and with sliding; resets that keep the constraints |
//! | `abrupt.rs` | equations of motion that may jump, and the claims that they leave open |
//! | `kept.rs`, `symplectic.rs`, `energy.rs`, `bounds.rs`, `definite.rs`, `jumps.rs` | motion and impacts together: volumes, the symplectic form, energy, momenta; certified signs, positive metrics |
//! | `expansion.rs`, `lie.rs`, `carried.rs`, `contact.rs`, `invariant.rs`, `leaves.rs` | forms on vectors of constant time: along the motion, across surfaces, with motion held behind them, on leaves of integrable constraints |
//! | `involution.rs`, `integrable.rs` | brackets of functions; as many conserved functions in involution as D has dimensions |
//! | `together.rs` | several proofs that are needed together |
//! | `corollaries.rs` | consequences of an invariant volume |
//! | `obstruction.rs`, `sample.rs` | points for a check by hand |
//! | `examine.rs`, `finding.rs`, `undecided.rs` | all claims of a model in turn; verdicts as text |
//!
//! Decisions are taken modulo 61-bit primes at random points. A search in double precision finds points that may prove
//! a statement. Such a point counts only if an enclosure confirms it.

mod abrupt;
mod admissible;
mod alternatives;
mod ansatz;
mod barriers;
mod bounds;
mod branches;
mod carried;
mod closure;
mod collision;
mod conditions;
mod conserved;
mod contact;
mod continuity;
mod contraction;
mod corollaries;
mod darboux;
mod defaults;
mod definite;
mod density;
pub mod dynamics;
mod elimination;
mod energy;
mod equivariance;
mod evidence;
pub mod exactness;
mod examine;
mod exceptional;
mod existence;
mod expansion;
mod factor;
mod finding;
mod fit;
mod focusing;
mod frame;
mod gauge;
mod geometry;
mod global;
mod gradient;
mod growth;
mod hybrid;
mod hypersurfaces;
mod impact;
mod impulse;
mod integrable;
mod invariant;
mod involution;
mod jumps;
mod kept;
mod landing;
mod leaf;
mod leaves;
mod lie;
mod linear;
mod locus;
mod minors;
mod momentum;
mod obstruction;
mod passage;
mod polynomial;
mod potential;
pub mod problem;
mod reflection;
mod refraction;
mod regularity;
mod residues;
mod sample;
mod side;
mod sliding;
mod smoothness;
mod symmetry;
mod symplectic;
mod together;
mod trace;
mod undecided;
mod volume;
mod wall;

pub use conditions::{Condition, Equation, Scan, find_conditions};
pub use dynamics::{Dynamics, Motion};
pub(crate) use equivariance::{Fields, check_equivariance};
pub use exactness::{Exactness, Local, decide, decide_local};
pub use examine::{Examined, examine, examine_mode, examine_scene, examine_volume};
pub use existence::Decision;
pub(crate) use finding::digits;
pub use finding::{Certificate, ClosedForm, Finding, Verdict, Witness};
pub use fit::Certified;
pub use geometry::{Geometry, geometry_at};
pub use global::Global;
pub use gradient::{Gradient, Integral};
pub use landing::check_landings;
pub use momentum::{MomentumDensity, find_momentum_density};
pub use obstruction::{Obstruction, find_obstruction};
pub use potential::{Potential, Term, potential_text};
pub use problem::Problem;
pub use sample::Sample;
pub(crate) use symmetry::{check_symmetry, keeps_lagrangian};
pub use trace::{Operation, Step, Trace};
pub use undecided::Undecided;
pub use volume::Volume;

/// For tests: a model and its derived equations.
#[cfg(test)]
fn derived(declaration: &str) -> (crate::model::Model, crate::mechanics::Derivation) {
    let spec = crate::spec::parse(declaration.parse().expect("tokens")).expect("a declaration");
    let mut model = crate::model::check(&spec).expect("a model");
    let derivation = crate::mechanics::derive(&mut model);
    (model, derivation)
}
