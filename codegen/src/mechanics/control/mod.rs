//! The maximum principle of a model with a cost `J = integral of l dt + g(x(T))` (thesis, chapter IX), for normal extremals.
//!
//! ```text
//! H(t, x, p, u) = p.f(t, x, u) + l(t, x, u)            u* = argmin_u H,  H* = H at u*
//! xdot = dH*/dp,  pdot = -dH*/dx                       p(T) = dg + multipliers of the given components of x(T)
//! x+ = Delta(t, x),  p+ . Delta_* = p + eps dh         H*+ - p+ . d_t Delta + eps d_t h = H*-   at h = 0
//! ```
//!
//! `p` is the gradient of the least cost, so `l` enters with the sign that it has in `J`, and `H` is minimised. `f` is
//! affine in the inputs and `l` is quadratic, so `u*` is a single expression. If the inputs do not act along the gap,
//! `H*` is linear in `eps`.
//!
//! | file | job |
//! |---|---|
//! | `system.rs` | a model as a first-order system: `x`, `f`, `Delta` |
//! | `principle.rs` | `H*`, `u*`, the field of the costate |
//! | `jump.rs` | the costate after an impact |
//! | `model.rs` | the extremals as a first-order model, for the later stages |
//! | `held.rs` | a first-order model with constant inputs, for dynamic programming |

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
    /// Name on the command line, for example `x` or `x_dot`.
    pub name: String,
    /// Symbol of the state.
    pub state: SymbolId,
    /// Symbol of the costate.
    pub costate: SymbolId,
    /// Rate of the state under the optimal input.
    pub rate: ExprId,
    /// Rate of the costate under the optimal input.
    pub costate_rate: ExprId,
}

/// State and costate after an impact.
#[derive(Debug, Clone)]
pub struct Jump {
    /// State after the impact, as a function of the state before.
    pub state: Vec<ExprId>,
    /// Symbol of the multiplier of `dh`.
    pub multiplier: SymbolId,
    /// Value of the multiplier.
    pub epsilon: ExprId,
    /// Costate after the impact. It contains the symbol of the multiplier.
    pub costate: Vec<ExprId>,
}

/// Maximum principle of a model. All expressions are functions of time, state and costate.
#[derive(Debug, Clone)]
pub struct Extremals {
    /// Components of the state, each with its costate.
    pub components: Vec<Component>,
    /// Optimal inputs, in the order of the inputs.
    pub optimal: Vec<ExprId>,
    /// `H*`
    pub hamiltonian: ExprId,
    /// Leading principal minors of the Hessian of the running cost with respect to the inputs. The optimal input is a
    /// minimum where all of them are positive.
    pub minors: Vec<ExprId>,
    /// Running cost under the optimal inputs.
    pub running: ExprId,
    /// The terminal cost.
    pub terminal: ExprId,
    /// One jump for each surface.
    pub jumps: Vec<Jump>,
}

/// Reason why no maximum principle is derived.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Uncontrolled {
    /// The declaration that prevents it; `None` for the model as a whole.
    pub item: Option<ItemId>,
    /// The message.
    pub text: String,
    /// The help line.
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

/// Derives the maximum principle of a checked model. New expressions are added to its pool.
///
/// # Errors
/// The first declaration that prevents it.
pub fn derive_extremals(model: &mut Model) -> Result<Extremals, Uncontrolled> {
    let Some(cost) = model.cost else {
        return Err(Uncontrolled::without_cost(model));
    };
    let system = system::of(model)?;
    check_names(model, &system, cost.item)?;
    let principle = principle::derive(model, &system, cost)?;
    let jumps = jump::derive(model, &system, &principle)?;
    Ok(principle.extremals(&system, cost.terminal, jumps))
}

/// Refuses two columns of the same name in the tables of extremals: state, costate, cost so far, inputs, and `H*`.
fn check_names(model: &Model, system: &system::System, cost: ItemId) -> Result<(), Uncontrolled> {
    let costates = system.names.iter().map(|name| model::costate_name(name));
    let mut names: Vec<String> = system.names.iter().cloned().chain(costates).collect();
    names.extend(model.inputs().map(|(_, input)| input.name.display.clone()));
    names.extend([model::COST, model::ENERGY].map(str::to_owned));
    let again = names
        .iter()
        .enumerate()
        .find(|(i, name)| names[..*i].contains(*name));
    match again {
        None => Ok(()),
        Some((_, name)) => {
            let text = format!("the tables of its extremals would have two columns `{name}`");
            let help = "choose another name for the coordinate or the input";
            Err(Uncontrolled::at(cost, text, help))
        }
    }
}
