//! Boundary-value problems: a search for the motions that join two configurations in a given time, with given numbers
//! of impacts.
//!
//! The unknowns are the quasi-velocities of the start in the reduced form, or its momenta for a model without
//! constraints. The equations are the given coordinates of the end. [`Variations`](dalembert::Variations) computes the
//! derivatives of a motion with respect to the unknowns, across impacts.
//!
//! | file | job |
//! |---|---|
//! | `shooter.rs` | one motion from given unknowns, and the properties of a motion that was found |
//! | `aim.rs` | the interface between a search and a problem |
//! | `observers.rs` | observers of a motion: impacts, action, derivatives |
//! | `units.rs` | units of the unknowns, and the energies that a problem suggests |
//! | `scan.rs` | motions along rays of the space of unknowns, with every change of their sequence of impacts |
//! | `line.rs` | all roots along a line of starts, by brackets |
//! | `newton.rs` | a root by Newton's method within one sequence of impacts |
//! | `search.rs` | the search: rays, starts, deflation |
//! | `directions.rs` | directions that cover a sphere |
//! | `conjugate.rs` | conjugate points of a motion |

pub(crate) mod aim;
mod conjugate;
pub(crate) mod directions;
mod line;
mod newton;
pub(crate) mod observers;
mod scan;
pub(crate) mod search;
mod shooter;
pub(crate) mod units;

use dalembert::contract::Variational;
use dalembert::describe::VariationalVisitor;
use dalembert::law::Law;
use dalembert::{Fault, Instance, Policies, Scene, StateError, Tolerance, Undefined};
use thiserror::Error;

use crate::model::Point;
use crate::refusal::Refusal;
use search::{Plan, Search};
use shooter::Shooter;

/// Relative difference below which two actions count as equal.
const SAME_ACTION: f64 = 1e-9;

/// Request for all motions between two configurations.
#[derive(Debug, Clone)]
pub struct Boundary {
    /// Positions at `t = 0`, one per coordinate.
    pub from: Vec<f64>,
    /// Positions at the end, one per coordinate; `None` for a free coordinate.
    pub to: Vec<Option<f64>>,
    /// The end time; the start is at 0.
    pub time: f64,
    /// Least and largest number of impacts.
    pub impacts: [usize; 2],
    /// The tolerance of the integrator, `Taylor`.
    pub tolerance: Tolerance,
    /// Laws that replace the declared ones, by index of the surface. The last entry for a surface counts.
    pub laws: Vec<(usize, Law)>,
    /// Policies of impacts after which the law alone does not determine the motion.
    pub policies: Policies,
    /// Number of directions in which starts are scanned, for two unknowns or more. The default depends on the number of
    /// unknowns.
    pub directions: Option<usize>,
    /// Seed of the directions.
    pub seed: u64,
    /// Largest kinetic energy of a start. By default the scan continues until every start has too many impacts, or up
    /// to a large multiple of the energies that the problem suggests.
    pub kinetic: Option<f64>,
    /// Number of starts whose conjugate points are computed, in each of the two directions of the unknown. Must be 0
    /// unless there is exactly one unknown. The points lie on the envelope of all motions from the first configuration.
    pub envelope: usize,
}

/// An impact of a motion that was found.
#[derive(Debug, Clone)]
pub struct Bounce {
    /// The time.
    pub t: f64,
    /// The index of the surface.
    pub surface: usize,
    /// The state before.
    pub before: Point,
    /// The state after.
    pub after: Point,
}

/// A conjugate point: the derivative of the configuration with respect to the velocity at the start is singular there.
#[derive(Debug, Clone)]
pub struct Conjugate {
    /// The time.
    pub t: f64,
    /// The state.
    pub at: Point,
    /// Number of impacts before it.
    pub impacts: usize,
}

/// A motion that joins the configurations.
#[derive(Debug, Clone)]
pub struct Connection {
    /// The state at the start.
    pub first: Point,
    /// The state at the end.
    pub last: Point,
    /// The impacts, in order of time.
    pub bounces: Vec<Bounce>,
    /// Integral of the Lagrangian along the motion.
    pub action: f64,
    /// Largest difference between a coordinate of the end and its given value.
    pub residual: f64,
    /// Points between start and end at which the determinant of the derivative of the configuration with respect to the
    /// velocity at the start is 0.
    pub conjugate: Vec<Conjugate>,
    /// The determinant at the end, divided by its value for motion at constant velocity.
    pub determinant: f64,
    /// False if the determinant at the end is 0 up to rounding: to first order, neighbouring starts reach the end as
    /// well.
    pub is_isolated: bool,
    /// Number of motions that were found in the family that this motion represents. Motions of a family are not
    /// isolated, and have the same surfaces and the same action. 1 for an isolated motion.
    pub family: usize,
}

/// The result of a search.
#[derive(Debug, Clone)]
pub struct Connected {
    /// The motions, by number of impacts, then by time of the impacts.
    pub connections: Vec<Connection>,
    /// Conjugate points of the starts of the envelope, by number of impacts, then by time.
    pub envelope: Vec<Conjugate>,
    /// Number of unknowns.
    pub unknowns: usize,
    /// Number of directions that were scanned.
    pub directions: usize,
    /// Largest kinetic energy of a scanned start.
    pub kinetic: f64,
    /// True if, in every direction, no motion from the fastest scanned starts reaches the end time with few enough
    /// impacts, and none was given up.
    pub is_bounded: bool,
    /// Number of motions that were computed.
    pub runs: u64,
    /// Number of intervals of the scan that were not resolved.
    pub unresolved: usize,
    /// Number of starts whose motion was given up after too many steps.
    pub given_up: usize,
}

impl Plan {
    fn of(boundary: &Boundary) -> Self {
        Self {
            least: boundary.impacts[0],
            directions: boundary.directions,
            seed: boundary.seed,
            kinetic: boundary.kinetic,
            envelope: boundary.envelope,
        }
    }
}

/// Progress of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stage {
    /// Number of finished tasks: guesses, if the problem has any, then directions, then starts.
    pub done: usize,
    /// Number of all tasks.
    pub all: usize,
    /// Number of motions found.
    pub found: usize,
}

/// Reasons for which two configurations cannot be joined by a search.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum Unjoined {
    /// The model is of first order and has no free velocities at the start.
    #[error("a first-order system has no free velocities: its motion follows from its start")]
    FirstOrder,
    /// The model has constraints and no reduced form.
    #[error(
        "motions of a model with constraints are sought in its reduced form, and this one has none"
    )]
    Unreduced,
    /// The number of equations differs from the number of unknowns.
    #[error(
        "{equations} coordinates are given at the end, and the velocity at the start has {unknowns} free components"
    )]
    Count {
        /// Number of given coordinates of the end.
        equations: usize,
        /// Number of free velocities of the start.
        unknowns: usize,
    },
    /// An envelope was requested for a number of unknowns other than 1.
    #[error("envelopes are known for one free velocity, and the start has {unknowns}")]
    Envelope {
        /// Number of free velocities of the start.
        unknowns: usize,
    },
    /// A configuration lies behind a surface.
    #[error("a configuration lies behind surface {surface}: its gap is {gap:e}")]
    Behind {
        /// True for the configuration at the end.
        is_end: bool,
        /// The surface.
        surface: usize,
        /// Its gap.
        gap: f64,
    },
    /// The level of a constraint differs between the two configurations, and a motion keeps it.
    #[error("constraint {constraint} keeps a value that differs by {difference:e} there")]
    Level {
        /// The constraint.
        constraint: usize,
        /// The difference of its values at both configurations.
        difference: f64,
    },
    /// The configuration at the end is refused.
    #[error("the configuration at the end is refused: {0}")]
    End(StateError),
    /// A quantity of a motion that was found does not exist.
    #[error(transparent)]
    Fault(#[from] Fault),
    /// A motion that was found has no derivative.
    #[error(transparent)]
    Undefined(#[from] Undefined),
}

/// Visitor that searches the motions of a model of any type.
pub(crate) struct Joiner<'a, 'b> {
    pub boundary: &'a Boundary,
    pub tell: &'b mut dyn FnMut(Stage),
}

impl VariationalVisitor for Joiner<'_, '_> {
    /// The inner error says why no motion can be sought, the outer one why no run starts.
    type Output = Result<Result<Connected, Unjoined>, Refusal>;

    fn visit<S: Instance + Scene + Variational>(self, system: &S) -> Self::Output {
        let mut shooter = match Shooter::aimed(system, self.boundary)? {
            Ok(shooter) => shooter,
            Err(unjoined) => return Ok(Err(unjoined)),
        };
        let plan = Plan::of(self.boundary);
        let units = shooter.units();
        let found = Search::of(&mut shooter, &plan, units, self.tell).found();
        let connections = found.roots.iter().map(|root| shooter.connection(&root.w));
        let connections: Result<Vec<Connection>, Unjoined> = connections.collect();
        let mut envelope = Vec::new();
        for w in &found.fan {
            envelope.extend(shooter.envelope(w));
        }
        envelope.sort_by(|left, right| {
            let impacts = left.impacts.cmp(&right.impacts);
            impacts.then(left.t.total_cmp(&right.t))
        });
        let connected = connections.map(|mut connections| {
            connections.sort_by(in_order);
            Connected {
                connections: families(connections, self.boundary.time),
                envelope,
                unknowns: shooter.unknowns(),
                directions: found.directions,
                kinetic: found.kinetic,
                is_bounded: found.is_bounded,
                runs: shooter.runs(),
                unresolved: found.unresolved,
                given_up: found.given_up,
            }
        });
        Ok(connected)
    }
}

/// Keeps one motion of each family of motions that are not isolated.
fn families(connections: Vec<Connection>, time: f64) -> Vec<Connection> {
    let mut kept: Vec<Connection> = Vec::new();
    for connection in connections {
        match kept
            .iter_mut()
            .find(|it| are_one_family(it, &connection, time))
        {
            Some(first) => first.family += 1,
            None => kept.push(connection),
        }
    }
    kept
}

fn are_one_family(left: &Connection, right: &Connection, time: f64) -> bool {
    let surfaces = |it: &Connection| it.bounces.iter().map(|it| it.surface).collect::<Vec<_>>();
    let size = action_size(left, time).max(action_size(right, time));
    !left.is_isolated
        && !right.is_isolated
        && surfaces(left) == surfaces(right)
        && (left.action - right.action).abs() <= SAME_ACTION * size
}

/// The size of the terms of an action, which may cancel.
fn action_size(connection: &Connection, time: f64) -> f64 {
    let first = &connection.first;
    let terms = first.p.iter().zip(&first.qdot).map(|(p, rate)| p * rate);
    let twice_kinetic: f64 = terms.sum();
    connection.action.abs().max(twice_kinetic.abs() * time)
}

/// The order of motions: by number of impacts, then by the times of their impacts, then by their start.
fn in_order(left: &Connection, right: &Connection) -> std::cmp::Ordering {
    let key = |it: &Connection| {
        let times = it.bounces.iter().map(|bounce| bounce.t);
        let velocity = it.first.qdot.iter().copied();
        times.chain(velocity).collect::<Vec<f64>>()
    };
    let counts = left.bounces.len().cmp(&right.bounces.len());
    counts.then_with(|| {
        let (left, right) = (key(left), key(right));
        let pairs = left.iter().zip(&right);
        let mut orders = pairs.map(|(left, right)| left.total_cmp(right));
        let first = orders.find(|order| order.is_ne());
        first.unwrap_or(std::cmp::Ordering::Equal)
    })
}
