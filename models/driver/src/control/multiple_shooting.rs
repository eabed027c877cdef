//! Multiple shooting: an extremal as a chain of motions, each from its own state and costate.
//!
//! ```text
//! z_{k+1} = Phi_k(z_k),  k = 0 .. M - 2,      the equations of the end hold for Phi_{M-1}(z_{M-1})
//! ```
//!
//! `z = (x, p)`, and `Phi_k` is the motion from one node to the next. The unknowns are the costate at the start, and
//! state and costate at the further nodes. Errors grow over a single stretch only. Newton's method, damped by the
//! natural monotonicity test (Deuflhard 2004, section 3.3), therefore converges from rough guesses, where single
//! shooting from a guess of the costate at the start fails.

use std::f64::consts::{PI, TAU};

use dalembert::contract::Variational;
use dalembert::{Instance, Scene, StateVector};

use super::shooter::Shooter;
use crate::connect::directions::on_sphere;
use crate::least_squares::solve;
use crate::linear::norm;

/// Number of stretches.
const STRETCHES: usize = 12;

/// Number of guesses.
pub(super) const GUESSES: usize = 24;

/// Deviations of the guesses from a straight line, in multiples of the size of the state.
const HEIGHTS: [f64; 3] = [0.25, 1.0, 2.0];

/// Maximum number of Newton steps.
const STEPS: usize = 60;

/// Length of a Newton step, in units of the unknowns, below which the equations count as solved.
const SOLVED: f64 = 1e-8;

/// Least unit of a costate.
const SMALL: f64 = 1e-3;

/// First and least damping factor of a Newton step.
const SHARES: [f64; 2] = [0.25, 1e-3];

/// Residuals and their derivatives, one column per unknown.
struct Equations {
    residuals: Vec<f64>,
    columns: Vec<Vec<f64>>,
}

/// A chain of motions of a problem.
pub(super) struct Chain<'s, 'a, S: Instance + Scene + Variational> {
    shooter: &'s mut Shooter<'a, S>,
    /// Number of components of the state.
    n: usize,
}

impl<'s, 'a, S: Instance + Scene + Variational> Chain<'s, 'a, S> {
    pub fn new(shooter: &'s mut Shooter<'a, S>) -> Self {
        Self {
            n: shooter.state_count(),
            shooter,
        }
    }

    /// The costate at the start of the extremal to which Newton's method converges from a guess.
    pub fn solve(&mut self, guess: usize) -> Option<Vec<f64>> {
        let mut unknowns = self.guess(guess);
        let mut equations = self.equations(&unknowns)?;
        let [mut share, least] = SHARES;
        for _ in 0..STEPS {
            let units = self.units(&unknowns);
            let length = |change: &[f64]| {
                let scaled = change
                    .iter()
                    .zip(&units)
                    .map(|(change, unit)| change / unit);
                norm(&scaled.collect::<Vec<_>>())
            };
            let step = solve(&equations.columns, &equations.residuals)?;
            let size = length(&step);
            if size < SOLVED {
                return Some(unknowns[..self.n].to_vec());
            }
            (unknowns, equations) = loop {
                if share < least {
                    return None;
                }
                let next = unknowns.iter().zip(&step);
                let next: Vec<f64> = next.map(|(value, step)| value - share * step).collect();
                // The simplified Newton step at `next`, with the derivatives at `unknowns`, must be shorter.
                if let Some(there) = self.equations(&next)
                    && let Some(again) = solve(&equations.columns, &there.residuals)
                    && length(&again) <= (1.0 - 0.25 * share) * size
                {
                    share = f64::min(1.0, 2.0 * share);
                    break (next, there);
                }
                share *= 0.5;
            };
        }
        None
    }

    /// The units of the unknowns: the largest absolute values of the components at the nodes, for a state at least the
    /// size of the component, for a costate at least [`SMALL`].
    fn units(&self, unknowns: &[f64]) -> Vec<f64> {
        let n = self.n;
        let (_, _, sizes) = self.shooter.ends();
        let mut units = [sizes, &vec![SMALL; n]].concat();
        for k in 0..STRETCHES {
            for (unit, value) in units.iter_mut().zip(self.node(unknowns, k)) {
                *unit = unit.max(value.abs());
            }
        }
        let nodes = (1..STRETCHES).flat_map(|_| units.iter().copied());
        units[n..].iter().copied().chain(nodes).collect()
    }

    /// A guess. The first one has states on a line from start to end; the others add a half wave and a full wave. All
    /// costates are 0.
    fn guess(&self, index: usize) -> Vec<f64> {
        let n = self.n;
        let (from, to, sizes) = self.shooter.ends();
        let waves = match index.checked_sub(1) {
            None => vec![0.0; 2 * n],
            Some(index) => {
                let direction = &on_sphere(2 * n, GUESSES, self.shooter.seed())[index];
                let height = HEIGHTS[index % HEIGHTS.len()] * (n as f64).sqrt();
                let sizes = sizes.iter().chain(sizes);
                let parts = direction.iter().zip(sizes);
                parts.map(|(part, size)| height * part * size).collect()
            }
        };
        let mut unknowns = vec![0.0; n];
        for node in 1..STRETCHES {
            let share = place(node);
            let (once, twice) = ((PI * share).sin(), (TAU * share).sin());
            let state = (0..n).map(|i| {
                let end = to[i].unwrap_or(from[i]);
                from[i] + share * (end - from[i]) + once * waves[i] + twice * waves[n + i]
            });
            unknowns.extend(state);
            unknowns.extend(vec![0.0; n]);
        }
        unknowns
    }

    fn equations(&mut self, unknowns: &[f64]) -> Option<Equations> {
        let n = self.n;
        let rows = 2 * n * (STRETCHES - 1) + n;
        let mut residuals = vec![0.0; rows];
        let mut columns = vec![vec![0.0; rows]; unknowns.len()];
        for k in 0..STRETCHES {
            let z = self.node(unknowns, k);
            // The state of the first node is fixed, and its costate comes first among the unknowns.
            let (first, fixed) = match k {
                0 => (0, n),
                k => (n + 2 * n * (k - 1), 0),
            };
            let row = 2 * n * k;
            let stretch = self.shooter.stretch([k, k + 1].map(place), &z)?;
            if k + 1 == STRETCHES {
                let (misses, slopes) = self.shooter.arrival(&stretch)?;
                residuals[row..].copy_from_slice(&misses);
                for (column, slopes) in columns[first..].iter_mut().zip(&slopes[fixed..]) {
                    column[row..].copy_from_slice(slopes);
                }
                break;
            }
            let next = self.node(unknowns, k + 1);
            for i in 0..2 * n {
                residuals[row + i] = stretch.end.as_slice()[i] - next[i];
                columns[n + 2 * n * k + i][row + i] = -1.0;
            }
            for (column, slopes) in columns[first..].iter_mut().zip(&stretch.columns[fixed..]) {
                column[row..row + 2 * n].copy_from_slice(slopes);
            }
        }
        let mut values = residuals.iter().chain(columns.iter().flatten());
        let is_finite = values.all(|value| value.is_finite());
        is_finite.then_some(Equations { residuals, columns })
    }

    fn node(&self, unknowns: &[f64], k: usize) -> Vec<f64> {
        let n = self.n;
        match k {
            0 => [self.shooter.ends().0, &unknowns[..n]].concat(),
            k => {
                let first = n + 2 * n * (k - 1);
                unknowns[first..first + 2 * n].to_vec()
            }
        }
    }
}

/// The fraction of the time at a node.
fn place(node: usize) -> f64 {
    node as f64 / STRETCHES as f64
}
