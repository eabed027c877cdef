//! Optimal control: a search for the extremals of a model with a cost, with given numbers of impacts.
//!
//! The system is the first-order model of the extremals that the generator makes: state `x`, costate `p` and the cost
//! so far. The unknowns are the costate at the start. The equations are the given components of the state at the end,
//! and `p = dg` for the other components, with the terminal cost `g`. [`Variations`](dalembert::Variations) computes
//! the derivatives of a motion across impacts; the search is the one of [`connect`](crate::connect).
//!
//! | file | job |
//! |---|---|
//! | `shooter.rs` | one extremal from a costate at the start |
//! | `multiple_shooting.rs` | additional starts of the search, by multiple shooting |
//! | `second_order.rs` | the second-order test of an extremal that was found |

mod multiple_shooting;
mod second_order;
mod shooter;

use dalembert::contract::Variational;
use dalembert::describe::VariationalVisitor;
use dalembert::{Fault, Instance, Scene, Tolerance};
use thiserror::Error;

use crate::connect::Stage;
use crate::connect::aim::COARSE;
use crate::connect::search::{Plan, Search};
use crate::refusal::Refusal;
use shooter::Shooter;

pub use second_order::SecondOrder;

/// Request for all extremals from a state.
#[derive(Debug, Clone)]
pub struct Task {
    /// The state at `t = 0`.
    pub from: Vec<f64>,
    /// The state at the end, one entry per component; `None` for a free component.
    pub to: Vec<Option<f64>>,
    /// The end time; the start is at 0.
    pub time: f64,
    /// Least and largest number of impacts.
    pub impacts: [usize; 2],
    /// The tolerance of the integrator, `Taylor`.
    pub tolerance: Tolerance,
    /// Number of directions in which starts are scanned, for two unknowns or more. The default depends on the number of
    /// unknowns.
    pub directions: Option<usize>,
    /// Seed of the directions.
    pub seed: u64,
}

/// State and costate at a time of an extremal.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// The time.
    pub t: f64,
    /// The state.
    pub state: Vec<f64>,
    /// The costate.
    pub costate: Vec<f64>,
    /// The optimal inputs.
    pub inputs: Vec<f64>,
    /// The minimised Hamiltonian `H*`.
    pub hamiltonian: f64,
}

/// An impact of an extremal.
#[derive(Debug, Clone, PartialEq)]
pub struct Kick {
    /// The index of the surface.
    pub surface: usize,
    /// State and costate before the impact.
    pub before: Moment,
    /// State and costate after the impact.
    pub after: Moment,
}

/// An extremal that was found.
#[derive(Debug, Clone)]
pub struct Extremal {
    /// The start.
    pub first: Moment,
    /// The end.
    pub last: Moment,
    /// The impacts, in order of time.
    pub kicks: Vec<Kick>,
    /// The total cost, including the terminal cost.
    pub cost: f64,
    /// The terminal cost.
    pub terminal: f64,
    /// Largest residual of an equation at the end.
    pub residual: f64,
    /// The second-order test.
    pub second_order: SecondOrder,
}

/// The result of a search.
#[derive(Debug, Clone)]
pub struct Controlled {
    /// The extremals, by cost.
    pub extremals: Vec<Extremal>,
    /// Number of directions that were scanned.
    pub directions: usize,
    /// Number of motions that were computed.
    pub runs: u64,
    /// True if the scan of every direction ended where larger costates lead to too many impacts or to motions that end
    /// early.
    pub is_bounded: bool,
    /// Number of intervals of the scan that were not resolved.
    pub unresolved: usize,
    /// Number of starts whose motion was given up after too many steps.
    pub given_up: usize,
    /// The miss of the end, relative to its size, that rounding of the costate at the start may cause. It grows
    /// exponentially with the time.
    pub rounding: f64,
}

impl Controlled {
    /// True if the end is so far away that rounding of the costate at the start hides it.
    pub fn is_out_of_reach(&self) -> bool {
        self.rounding > COARSE
    }
}

/// Reasons why no extremals are sought.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum Unsought {
    /// The model is not the model of extremals of another model.
    #[error("the model is not that of the extremals of a model with a cost")]
    Other,
    /// The second derivative of the running cost with respect to the inputs is not positive.
    #[error(
        "the running cost has no least value at the start: its second derivative with respect to the inputs is not positive there"
    )]
    Input,
    /// A state lies behind a surface.
    #[error("a state lies behind surface {surface}: its gap is {gap:e}")]
    Behind {
        /// True for the state at the end.
        is_end: bool,
        /// The surface.
        surface: usize,
        /// Its gap.
        gap: f64,
    },
    /// A quantity of an extremal that was found does not exist.
    #[error(transparent)]
    Fault(#[from] Fault),
}

/// Visitor that searches the extremals of a model of any type.
pub(crate) struct Controller<'a, 'b> {
    pub task: &'a Task,
    pub tell: &'b mut dyn FnMut(Stage),
}

impl VariationalVisitor for Controller<'_, '_> {
    /// The inner error says why no extremals can be sought, the outer one why no run starts.
    type Output = Result<Result<Controlled, Unsought>, Refusal>;

    fn visit<S: Instance + Scene + Variational>(self, system: &S) -> Self::Output {
        let mut shooter = match Shooter::aimed(system, self.task)? {
            Ok(shooter) => shooter,
            Err(unsought) => return Ok(Err(unsought)),
        };
        let plan = Plan {
            least: self.task.impacts[0],
            directions: self.task.directions,
            seed: self.task.seed,
            kinetic: None,
            envelope: 0,
        };
        let units = shooter.units();
        let found = Search::of(&mut shooter, &plan, units, self.tell).found();
        let extremals = found.roots.iter().map(|root| shooter.extremal(&root.w));
        let extremals: Result<Vec<Extremal>, Unsought> = extremals.collect();
        Ok(extremals.map(|mut extremals| {
            extremals.sort_by(|left, right| left.cost.total_cmp(&right.cost));
            Controlled {
                extremals,
                directions: found.directions,
                runs: shooter.runs(),
                is_bounded: found.is_bounded,
                unresolved: found.unresolved,
                given_up: found.given_up,
                rounding: found.rounding,
            }
        }))
    }
}
