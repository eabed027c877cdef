//! Stage 3b, prove or refute: what a model's author claims about it.
//!
//! | file | job |
//! |---|---|
//! | `problem.rs`, `contraction.rs` | what an invariant density depends on; what forces do to volumes |
//! | `linear.rs`, `frame.rs`, `closure.rs` | the frame of D as series, and its hull under brackets |
//! | `exactness.rs` | does a local density exist? |
//! | `potential.rs`, `fit.rs`, `global.rs`, `growth.rs`, `reflection.rs`, `regularity.rs`, `smoothness.rs`, `leaf.rs` | the density in closed form; is it single-valued, and regular? |
//! | `volume.rs`, `gradient.rs`, `trace.rs` | the volume with that density, or with an integral for it, as it is lowered |
//! | `momentum.rs`, `darboux.rs`, `ansatz.rs`, `elimination.rs` | densities that depend on velocities |
//! | `conditions.rs`, `exceptional.rs`, `hypersurfaces.rs`, `polynomial.rs` | conditions on parameters under which a density exists |
//! | `alternatives.rs` | both of these in words |
//! | `defaults.rs` | claims at the declared values of parameters |
//! | `geometry.rs`, `dynamics.rs`, `branches.rs` | frame and theta, and the motion on D, at a point |
//! | `evidence.rs`, `continuity.rs` | does something vanish at all states? may it jump all the same? |
//! | `existence.rs`, `density.rs`, `conserved.rs`, `impact.rs`, `symmetry.rs` | the verdict on each kind of claim |
//! | `equivariance.rs` | symmetries of motion, surfaces and their maps together |
//! | `gauge.rs` | total derivatives that a symmetry may add to the Lagrangian |
//! | `wall.rs`, `impulse.rs`, `focusing.rs`, `passage.rs`, `refraction.rs`, `side.rs` | the map of an impact, of a reset, of a transition; the modes on both sides of it |
//! | `collision.rs`, `hybrid.rs`, `factor.rs`, `minors.rs`, `sliding.rs`, `landing.rs` | what vanishes at impacts; what they do to a volume, in closed form too, and where it slides; do resets keep the constraints? |
//! | `kept.rs`, `symplectic.rs`, `energy.rs`, `bounds.rs`, `jumps.rs` | motion and impacts together: volumes, the symplectic form, energy, momenta |
//! | `expansion.rs`, `lie.rs`, `carried.rs`, `contact.rs`, `invariant.rs`, `leaves.rs` | forms on vectors of one time, along the motion and through surfaces, where it may be held behind them; on leaves of integrable constraints |
//! | `involution.rs`, `integrable.rs` | brackets of functions; conserved functions that are enough of them |
//! | `together.rs` | several proofs that are needed together |
//! | `corollaries.rs` | consequences of a volume that is kept |
//! | `obstruction.rs`, `sample.rs` | points that a person can follow |
//! | `examine.rs`, `finding.rs`, `undecided.rs` | all claims of a model in turn; verdicts in words |
//!
//! Decisions are taken modulo 61-bit primes at random points. Values in double precision say where to look for a point that shows something;
//! it counts once it is enclosed.

mod alternatives;
mod ansatz;
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
