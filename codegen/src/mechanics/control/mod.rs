//! The maximum principle of a model with a cost `J = integral of l dt + g(x(T))` (thesis, chapter IX), for normal extremals.
//!
//! ```text
//! H(t, x, p, u) = p.f(t, x, u) + l(t, x, u)            u* = argmin_u H,  H* = H at u*
//! xdot = dH*/dp,  pdot = -dH*/dx                       p(T) = dg + multipliers of the given components of x(T)
//! x+ = Delta(t, x),  p+ . Delta_* = p + eps dh         H*+ - p+ . d_t Delta + eps d_t h = H*-   at h = 0
//! ```
//!
//! `p` is the differential of the least cost, so that a minimum belongs to `l` with the sign that it has in `J`. `f` is affine
//! in the inputs and `l` quadratic, so `u*` is one expression. Where inputs do not act along the gap, `H*` is linear in `eps`.
//!
//! | file | job |
//! |---|---|
//! | `system.rs` | a model as a first-order system: `x`, `f`, `Delta` |
//! | `principle.rs` | `H*`, `u*`, the field of the costate |
//! | `jump.rs` | the costate after an impact |
//! | `model.rs` | all of it as a first-order model, for the ordinary stages |
//! | `held.rs` | a first-order model with inputs that stay, for dynamic programming |

mod held;
mod jump;
mod model;
mod principle;
mod system;

use dalembert_expr::{ExprId, SymbolId};

use crate::model::Model;
use crate::spec::ItemId;

pub use held::{Held, held_model};
pub use model::{ENERGY, TERMINAL, extremal_model};

/// A component of the state with its costate.
#[derive(Debug, Clone)]
pub struct Component {
    /// Name on the command line: `x`, `x_dot`.
    pub name: String,
    /// Symbol of the state.
    pub state: SymbolId,
    /// Symbol of the costate.
    pub costate: SymbolId,
    /// Rate of the state with the optimal input.
    pub rate: ExprId,
    /// Rate of the costate with the optimal input.
    pub costate_rate: ExprId,
}

/// State and costate after an impact.
#[derive(Debug, Clone)]
pub struct Jump {
    /// State after the impact.
    pub state: Vec<ExprId>,
    /// Symbol of the multiplier of `dh`.
    pub multiplier: SymbolId,
    /// Value of the multiplier.
    pub epsilon: ExprId,
    /// Costate after the impact, with the symbol of the multiplier.
    pub costate: Vec<ExprId>,
}

/// The maximum principle of a model: functions of time, state and costate.
#[derive(Debug, Clone)]
pub struct Extremals {
    /// State and costate.
    pub components: Vec<Component>,
    /// Optimal inputs, in the order of the inputs.
    pub optimal: Vec<ExprId>,
    /// `H*`
    pub hamiltonian: ExprId,
    /// Leading minors of the second derivative of the running cost by the inputs: all of them are positive where the optimal input
    /// is one.
    pub minors: Vec<ExprId>,
    /// The running cost with the optimal inputs.
    pub running: ExprId,
    /// The terminal cost.
    pub terminal: ExprId,
    /// One for each surface.
    pub jumps: Vec<Jump>,
}

/// Reason for which no maximum principle is derived.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Uncontrolled {
    /// Place of the declaration that is in the way; the model itself if there is none.
    pub item: Option<ItemId>,
    /// Text.
    pub text: String,
    /// Advice.
    pub help: String,
}

impl Uncontrolled {
    fn without_cost(model: &Model) -> Self {
        Self {
            item: None,
            text: format!("`{}` declares no `cost`", model.name),
            help: "write `cost { running = u^2/2; terminal = (x - 1)^2; }`".to_owned(),
        }
    }

    fn at(item: ItemId, text: impl Into<String>, help: &str) -> Self {
        Self {
            item: Some(item),
            text: text.into(),
            help: help.to_owned(),
        }
    }
}

/// Derives the maximum principle of a checked model; new expressions are added to its pool.
///
/// # Errors
/// The first declaration that is in the way.
pub fn derive_extremals(model: &mut Model) -> Result<Extremals, Uncontrolled> {
    let Some(cost) = model.cost else {
        return Err(Uncontrolled::without_cost(model));
    };
    let system = system::of(model)?;
    let principle = principle::derive(model, &system, cost)?;
    let jumps = jump::derive(model, &system, &principle)?;
    Ok(principle.extremals(&system, cost.terminal, jumps))
}
