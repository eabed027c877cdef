//! Systems with modes: at every time the motion is one of several, and transitions lead from one to another.
//!
//! A mode is a system of its own ([`Mode`]). The state of the whole is that of the present mode, filled up with zeros to the
//! length of the longest, and behind it the number of the mode, which no motion changes. So a run goes on through
//! transitions with the same integrator, the same search for crossings and the same effects as through impacts; a
//! transition is a surface at which the state becomes one of another mode.
//!
//! | file | job |
//! |---|---|
//! | `mod.rs` | what a mode is |
//! | `embed.rs` | the state of a mode in that of the whole, and what the whole answers by asking the mode |
//! | `series.rs` | power series of the whole, by those of the modes |
//! | `passage.rs` | the state that a mode is entered with: declared, or by the transition principle |
//! | `vary.rs` | transitions and gaps over numbers with derivatives, for first variations |
//! | `within.rs` | an effect that belongs to one mode |
//!
//! Reference: J. Cortes and A. M. Vinogradov, *Hamiltonian theory of constrained impulsive motion* (2006).

mod embed;
mod passage;
mod series;
mod vary;
mod within;

use crate::contract::{Lagrangian, System, TaylorField, VectorField};
use crate::describe::Instance;
use crate::effects::Scene;
use crate::error::Fault;

pub use embed::*;
pub use passage::{Passage, passage};
pub use series::{Shape, advance, begin, work};
pub use vary::*;
pub use within::Within;

/// A mode of a model: a system whose states are some of the model's. Implemented by `model!`.
pub trait Mode: System + TaylorField + Lagrangian + Instance + Scene {
    /// The model that it is a mode of.
    type Model: VectorField;

    /// Its number, in order of declaration.
    const INDEX: usize;

    /// Places of its coordinates among those of the model, in its own order.
    const COORDINATES: &'static [usize];

    /// Places of its surfaces among those of the model.
    const SURFACES: &'static [usize];

    /// Places of its outputs among those of the model.
    const OUTPUTS: &'static [usize];

    /// Whether its states can be off its constraints: it has some, and is run in its global form.
    const CAN_LEAVE_CONSTRAINTS: bool;

    /// The mode, at the parameters of the model.
    fn of(model: &Self::Model) -> Self;

    /// Writes the positions and velocities that another mode is entered with at this surface, in the order of that mode,
    /// where the transition declares them.
    ///
    /// # Errors
    /// [`Fault`].
    fn entry(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
        q: &mut [f64],
        qdot: &mut [f64],
    ) -> Result<(), Fault> {
        let _ = (surface, t, state, q, qdot);
        Ok(())
    }
}

/// A state of a model with modes.
pub(crate) type StateOf<M> = <<M as Mode>::Model as VectorField>::State;
