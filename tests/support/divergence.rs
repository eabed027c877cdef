//! The divergence of the motion on D with respect to `mu_C`, by finite differences in the coordinates `(q, v_ind)`.

use dalembert_codegen::claims::{Geometry, geometry_at};
use dalembert_expr::{RealPoint, SymbolId};

use crate::verdict::Decided;

/// Step `h` of the stencils, whose error is of order `h^4`.
const STEP: f64 = 1e-3;

/// The motion of a model on D, with its dependent velocities and the values of its parameters.
#[derive(Debug)]
pub struct Flow<'d> {
    decided: &'d Decided,
    parameters: Vec<(SymbolId, f64)>,
    dependent: Vec<usize>,
}

/// A state on D: time, coordinates, independent velocities.
#[derive(Debug, Clone)]
pub struct State {
    /// Time.
    pub t: f64,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Independent velocities.
    pub v: Vec<f64>,
}

impl<'d> Flow<'d> {
    /// The flow of a model.
    pub fn new(decided: &'d Decided, parameters: &[(SymbolId, f64)], dependent: &[usize]) -> Self {
        Self {
            decided,
            parameters: parameters.to_vec(),
            dependent: dependent.to_vec(),
        }
    }

    /// The flow near a state, with default parameters and with dependent velocities that are regular there.
    pub fn at(decided: &'d Decided, state: &State) -> Self {
        let mut flow = Self::new(decided, &decided.defaults(), &[]);
        flow.dependent = decided.regular_dependent(&flow.values(state));
        flow
    }

    /// The indices of the dependent velocities.
    pub fn dependent(&self) -> &[usize] {
        &self.dependent
    }

    fn independent(&self) -> impl Iterator<Item = usize> + '_ {
        let n = self.decided.model.coordinates.len();
        (0..n).filter(|i| !self.dependent.contains(i))
    }

    /// Velocities and accelerations.
    fn rates(&self, state: &State) -> (Vec<f64>, Vec<f64>) {
        let model = &self.decided.model;
        let mut point = RealPoint::new(vec![0.0; model.pool.symbol_count()]);
        for (symbol, value) in self.values(state) {
            point.set(symbol, value);
        }
        for (i, v) in self.independent().zip(&state.v) {
            point.set(model.coordinates[i].qdot, *v);
        }
        let motion = self
            .decided
            .dynamics
            .motion(&model.pool, &mut point, Some(&self.dependent))
            .expect("a regular state");
        (motion.qdot, motion.qddot)
    }

    fn values(&self, state: &State) -> Vec<(SymbolId, f64)> {
        let model = &self.decided.model;
        let mut values = self.parameters.clone();
        values.extend(
            model
                .coordinates
                .iter()
                .map(|coordinate| coordinate.q)
                .zip(state.q.iter().copied()),
        );
        values.push((model.time, state.t));
        values
    }

    /// The generator's geometry at the point.
    ///
    /// # Panics
    /// If the point is singular.
    pub fn geometry(&self, state: &State) -> Geometry {
        let Decided { model, problem, .. } = self.decided;
        geometry_at(
            &model.pool,
            problem,
            &self.values(state),
            Some(&self.dependent),
        )
        .expect("a regular point")
    }

    /// The rate of `G` along the motion, as the equations `X_i(G) = c_i` demand it.
    pub fn demand(&self, state: &State) -> f64 {
        let demands = self.geometry(state).demands;
        let drifts = demands.len() - state.v.len();
        let drift: f64 = demands[..drifts].iter().sum();
        let rest = demands[drifts..].iter().zip(&state.v).map(|(c, v)| c * v);
        drift + rest.sum::<f64>()
    }

    /// `exp(G)`
    ///
    /// # Panics
    /// If `G` was not found in closed form.
    pub fn density(&self, state: &State) -> f64 {
        let logarithm = self.decided.log_density_at(&self.values(state));
        logarithm.expect("a closed form").exp()
    }

    /// The divergence with respect to `weight mu_C`.
    pub fn divergence(&self, state: &State, weight: &dyn Fn(&Self, &State) -> f64) -> f64 {
        let volume = |state: &State| {
            let geometry = self.geometry(state);
            let volume = geometry.metric_determinant / geometry.dependent_determinant.abs();
            weight(self, state) * volume
        };
        let mut sum = 0.0;
        for i in 0..state.q.len() {
            sum += slope(
                state,
                |state| &mut state.q[i],
                |state| volume(state) * self.rates(state).0[i],
            );
        }
        for (k, i) in self.independent().enumerate() {
            sum += slope(
                state,
                |state| &mut state.v[k],
                |state| volume(state) * self.rates(state).1[i],
            );
        }
        sum += slope(state, |state| &mut state.t, volume);
        sum / volume(state)
    }
}

fn slope(
    state: &State,
    component: impl Fn(&mut State) -> &mut f64,
    f: impl Fn(&State) -> f64,
) -> f64 {
    let at = |k: f64| {
        let mut moved = state.clone();
        *component(&mut moved) += k * STEP;
        f(&moved)
    };
    let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(at);
    (a - d + 8.0 * (c - b)) / (12.0 * STEP)
}
