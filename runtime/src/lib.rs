//! Runtime of dalembert: runs mechanical systems with constraints and impacts, `no_std`, without allocation.
//!
//! A system defines the rate of its state ([`VectorField`]), its positions, momenta and energy ([`System`]), its
//! constraints ([`Constrained`]) and its surfaces ([`Impacting`]). The `model!` macro writes all of these from a
//! declaration; they can also be written by hand. [`Simulation`] combines a system with an integrator ([`Dop853`],
//! [`DormandPrince5`], [`Taylor`]) and effects ([`Impacts`], [`Projection`], or those of [`Scene::effects`]), and
//! runs it. A run ends in exactly one [`Outcome`], with the last good state.
//!
//! Impacts are roots of the gaps along the dense output of each step. Event location finds all of them, in order, to
//! the last bits of the time, and none twice. An event that rounding may have decided is flagged ([`Event::graze`])
//! or ends the run with its own outcome.
//!
//! A ball that bounces on the floor `x = 0`, written by hand:
//!
//! ```
//! use dalembert::{
//!     Contact, Dop853, EventLog, Fault, Impacting, Impacts, Law, Outcome, ParameterError, Simulation, System,
//!     Tolerance, VectorField,
//! };
//! use dalembert::numbers::TaylorModel;
//! use nalgebra::SVector;
//!
//! /// Mass 1, gravity 1; the state is (x, v).
//! struct Ball;
//!
//! type Height = SVector<f64, 1>;
//! type State = SVector<f64, 2>;
//!
//! impl VectorField for Ball {
//!     type State = State;
//!     fn rate(&self, _t: f64, state: &State, rate: &mut State) -> Result<(), Fault> {
//!         *rate = State::new(state[1], -1.0);
//!         Ok(())
//!     }
//! }
//!
//! impl System for Ball {
//!     type Vector = Height;
//!     type Impulse = Height;
//!     fn position(&self, state: &State) -> Height {
//!         Height::new(state[0])
//!     }
//!     fn velocity(&self, _t: f64, state: &State) -> Result<Height, Fault> {
//!         Ok(Height::new(state[1]))
//!     }
//!     fn momentum(&self, t: f64, state: &State) -> Result<Height, Fault> {
//!         self.velocity(t, state)
//!     }
//!     fn state_unchecked(&self, _t: f64, q: &Height, qdot: &Height) -> Result<State, Fault> {
//!         Ok(State::new(q[0], qdot[0]))
//!     }
//!     fn state_from_momenta(&self, t: f64, q: &Height, p: &Height) -> Result<State, Fault> {
//!         self.state_unchecked(t, q, p)
//!     }
//!     fn energy(&self, _t: f64, state: &State) -> Result<f64, Fault> {
//!         Ok(0.5 * state[1] * state[1] + state[0])
//!     }
//!     fn kick(&self, state: &mut State, size: f64, direction: &Height) {
//!         state[1] += size * direction[0];
//!     }
//!     fn check_parameters(&self) -> Result<(), ParameterError> {
//!         Ok(())
//!     }
//! }
//!
//! impl Impacting for Ball {
//!     type Gaps = Height;
//!     fn gaps(&self, _t: f64, state: &State) -> Height {
//!         Height::new(state[0])
//!     }
//!     fn gap_along(
//!         &self,
//!         _surface: usize,
//!         _t: TaylorModel,
//!         component: &dyn Fn(usize) -> TaylorModel,
//!     ) -> TaylorModel {
//!         component(0)
//!     }
//!     fn gap_rates(&self, _t: f64, state: &State) -> Result<Height, Fault> {
//!         Ok(Height::new(state[1]))
//!     }
//!     fn law(&self, _surface: usize) -> Law {
//!         Law::Elastic
//!     }
//!     fn contact(&self, _surface: usize, _t: f64, state: &State) -> Result<Contact<Height>, Fault> {
//!         Ok(Contact {
//!             gap_rate: state[1],
//!             constrained_rate: state[1],
//!             surface_rate: 0.0,
//!             constrained_compliance: 1.0,
//!             free_compliance: 1.0,
//!             direction: Height::new(1.0),
//!         })
//!     }
//! }
//!
//! let integrator = Dop853::new(Tolerance::new(1e-12)?);
//! let mut impacts = EventLog::<State, 8>::new();
//! let mut simulation = Simulation::new(&Ball, integrator, Impacts::declared(&Ball));
//!
//! // Thrown up from the floor: back after 2, and again after 4.
//! let run = simulation.run(0.0, State::new(0.0, 1.0), 5.0, &mut impacts)?;
//! assert_eq!(run.outcome, Outcome::Done);
//! let times: Vec<f64> = impacts.iter().map(|event| event.t).collect();
//! assert!((times[0] - 2.0).abs() < 1e-13 && (times[1] - 4.0).abs() < 1e-13 && times.len() == 2);
//!
//! // With a floor that takes a tenth of the speed at each impact, the impacts accumulate at t = 20.
//! let effects = Impacts::declared(&Ball).with_law(0, Law::Restitution(0.9));
//! let run = Simulation::new(&Ball, integrator, effects).run(0.0, State::new(0.0, 1.0), 30.0, &mut ())?;
//! assert!(matches!(run.outcome, Outcome::Zeno { t, .. } if (t - 20.0).abs() < 1e-9));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

pub mod action;
pub mod audit;
pub mod certified;
mod chart;
pub mod contract;
pub mod declaration;
pub mod describe;
pub mod effects;
pub mod erased;
pub mod error;
mod events;
pub mod extended;
pub mod forces;
mod generated;
pub mod impacts;
mod independence;
pub mod initial;
pub mod inputs;
pub mod integrals;
pub mod integrate;
pub mod jet;
pub mod kernels;
#[cfg(feature = "lanes")]
pub mod lanes;
pub mod law;
mod linalg;
#[doc(hidden)]
pub mod modes;
mod narrow;
mod nearest;
pub mod outcome;
mod per_surface;
pub mod policy;
pub mod projection;
mod quadrature;
mod rank;
pub mod record;
pub mod run;
pub mod simulation;
pub mod state;
pub mod variations;
pub mod work;

pub use dalembert_numbers::{math, numbers};

pub use action::Action;
pub use contract::{
    Constrained, Divergence, Impacting, InvariantVolume, Keep, Lagrangian, Level, Powered,
    RankDrop, System, Tangent, TaylorField, Variational, VectorField,
};
pub use declaration::Described;
pub use describe::Instance;
pub use effects::{Effect, Scene, SceneEffects};
pub use error::{Fault, ParameterError, StateError};
pub use forces::{Forces, NoForces};
pub use impacts::Impacts;
pub use initial::{complete_positions, complete_velocities};
pub use inputs::{Actuated, Steered};
pub use integrals::Integrals;
pub use integrate::{
    Counters, Dla2, Dla4, Dop853, DormandPrince5, Gauss4, Gauss6, MaxStepError, Rk4, Stepper,
    Taylor, Tolerance, ToleranceError,
};
pub use law::{Blow, Contact, Jump, Landing, Law};
pub use outcome::{Outcome, StartError};
pub use policy::{Corner, Penetration, Policies, Rest};
pub use projection::Projection;
pub use record::{Event, EventLog, Hold, Observer, Segment};
pub use run::Run;
pub use simulation::Simulation;
pub use state::StateVector;
pub use variations::{Orbit, OrbitError, Section, SectionError, Undefined, Variations};
pub use work::Work;

#[cfg(feature = "macros")]
pub use dalembert_macros::{model, model_file};

/// Items that generated code names besides the public ones. Not part of the interface.
#[doc(hidden)]
pub mod __private {
    pub use crate::generated::*;
    pub use crate::initial::{complete_positions, complete_velocities};
    pub use crate::kernels::{log_density, nearest_of_declared};
    pub use crate::kernels::{number, write};
    pub use crate::math;
    pub use crate::modes;
    pub use crate::nearest::nearest_by_steps;
    pub use crate::rank::rank_drop;
    pub use nalgebra::SVector;
}
