//! Runs and analysis of models that are known only at run time.
//!
//! | file | job |
//! |---|---|
//! | `model.rs` | the trait of a model whose type is erased, and the data of its interface |
//! | `typed.rs` | the implementation of this trait for the type of a system |
//! | `run/` | one run: its settings, its observer, its end |
//! | `accuracy/` | measured errors of integrators, with work and time |
//! | `orbit.rs` | periodic orbits, Lyapunov exponents |
//! | `continuation/` | branches of periodic orbits over a parameter, with their bifurcations |
//! | `ensemble/` | many members of one scene: their starts, rows, densities and sums |
//! | `variation.rs` | derivatives of runs |
//! | `connect/` | motions between two configurations |
//! | `linearisation/` | equilibria, and linearised equations with inputs and outputs |
//! | `control/` | extremals of models with a cost |
//! | `dynamic/` | dynamic programming of models with a cost |
//! | `modulo.rs` | symmetry groups up to which orbits close |
//! | `certify.rs` | enclosures of motions and impacts |
//! | `drift.rs` | drift of a conserved quantity over a long run |
//! | `player.rs` | pages that play a motion |
//! | `course.rs` | defaults for values that the request of a run leaves open |
//! | `beginning.rs` | initial states from given components |
//! | `names.rs`, `words.rs`, `outcome.rs` | names of quantities; refusals, faults and outcomes in the names of the model |
//!
//! An erased system, compiled once in this crate, runs every model that has a form ([`of_form`]). Any other model is
//! compiled together with the code that runs it, in the crate that names its type ([`of_type`]).

#![forbid(unsafe_code)]

pub mod accuracy;
mod beginning;
mod certify;
mod connect;
mod continuation;
mod control;
pub mod course;
mod domain;
pub mod drift;
mod dynamic;
pub mod ensemble;
mod grid;
mod integrator;
mod least_squares;
mod linear;
mod linearisation;
mod model;
mod modulo;
pub mod names;
mod orbit;
pub mod outcome;
mod owner;
pub mod player;
mod refusal;
mod run;
mod typed;
mod variation;
pub mod words;

pub use beginning::{Beginning, Component};
pub use certify::{Certification, Certified, Ranges, Strike};
pub use connect::{Bounce, Boundary, Conjugate, Connected, Connection, Stage, Unjoined};
pub use continuation::{
    Bifurcation, BifurcationCurve, Branch, BranchEnd, Continuation, Extent, Member, Stability,
};
pub use control::{Controlled, Extremal, Kick, Moment, SecondOrder, Task, Unsought};
pub use dynamic::{Axis, Choice, Hit, Landing, Lattice, Layer, Leg, Move, Unlanded, choose};
pub use grid::{Grid, padded};
pub use integrator::{Form, Integrator};
pub use linearisation::{
    Linearisation, Place, Sampling, Stride, Tendency, Trim, Unlinear, components,
};
pub use model::{
    AnyModel, Code, Contacted, OffConstraint, Origin, Point, Rates, Runs, Start, Together,
};
pub use modulo::{Generator, NoGroup, Symmetries};
pub use orbit::{Found, Growth, Search};
pub use owner::MakeWhole;
pub use refusal::{Refusal, Uncertified};
pub use run::{
    Changes, Contact, Control, Ending, Impact, ImpactTally, InputFunction, Piece, Settings, Watch,
    steer,
};
pub use typed::{Model, of_compiled, of_form, of_system, of_type};
pub use variation::{Derivatives, Variable, VariationError, differentiate};
