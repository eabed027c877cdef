//! Result of a run.

use crate::integrate::Counters;
use crate::outcome::Outcome;

/// A finished run: the reason, time and state of its end, and the work done.
///
/// # Examples
///
/// ```
/// use dalembert::{Dop853, Outcome, Scene, Simulation, System, Tolerance};
///
/// # dalembert::model! {
/// #     pub Ball {
/// #         coordinates { x; }
/// #         lagrangian = dot(x)^2/2 - x;
/// #         impacts { floor: x >= 0; }
/// #         initial { x = 1; }
/// #     }
/// # }
///
/// // The ball makes ever smaller hops. The run ends where they accumulate, at t = 3.
/// # use dalembert::{Law, SceneEffects};
/// let ball = Ball::default();
/// let mut effects = ball.effects();
/// effects.set_law(0, Law::Restitution(0.5));
/// let state = ball.state(0.0, &[0.5].into(), &[0.0].into())?;
/// let run = Simulation::new(&ball, Dop853::new(Tolerance::new(1e-12)?), effects).run(0.0, state, 9.0, &mut ())?;
/// assert!(matches!(run.outcome, Outcome::Zeno { .. }));
/// assert!((run.t - 3.0).abs() < 1e-9 && run.counters.accepted > 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run<S> {
    /// Reason for the end.
    pub outcome: Outcome,
    /// Time at the end.
    pub t: f64,
    /// The last good state, at `t`; after an impact at `t`, the state after it.
    pub state: S,
    /// Work done.
    pub counters: Counters,
}
