//! Quantities of the density criterion as numbers at a point, for checks of the criterion.

use dalembert_expr::{JetSpace, Jets, Pool, RealPoint, SymbolId};

use super::frame::frame;
use super::problem::Problem;

/// Values at a real point of the ingredients of `X_i(G) = c_i`; see `frame.rs` for the formulas.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// The dependent velocities, one for each constraint.
    pub dependent: Vec<usize>,
    /// The frame of D, the drift first if there is one: N components each, and one for time if the model depends on it.
    pub frame: Vec<Vec<f64>>,
    /// Derivatives of the logarithm of an invariant density along each of the vectors.
    pub demands: Vec<f64>,
    /// `theta`, N components.
    pub theta: Vec<f64>,
    /// `det g`
    pub metric_determinant: f64,
    /// `det m^{ab}`
    pub mass_determinant: f64,
    /// `det A_dep`, with the dependent columns in order.
    pub dependent_determinant: f64,
}

/// The geometry at these values of coordinates and parameters; `None` if the point is singular. `dependent`: indices of
/// the dependent velocities; `None` chooses them.
pub fn geometry_at(
    pool: &Pool,
    problem: &Problem,
    values: &[(SymbolId, f64)],
    dependent: Option<&[usize]>,
) -> Option<Geometry> {
    let mut point = RealPoint::default();
    for (symbol, value) in values {
        point.set(*symbol, *value);
    }
    let space = JetSpace::new(problem.variables.len(), 1, usize::MAX)?;
    let jets = Jets::new(dalembert_expr::Reals, &space);
    let found = frame(pool, problem, &jets, &mut point, dependent)?;
    let width = problem.components();
    let numbers = |series: &[Vec<f64>]| series.iter().map(|entry| jets.value(entry)).collect();
    Some(Geometry {
        dependent: found.dependent,
        frame: found
            .demands
            .iter()
            .map(|row| numbers(&row[..width]))
            .collect(),
        demands: found
            .demands
            .iter()
            .map(|row| jets.value(&row[width]))
            .collect(),
        theta: numbers(&found.theta),
        metric_determinant: jets.value(&found.metric_determinant),
        mass_determinant: jets.value(&found.mass_determinant),
        dependent_determinant: jets.value(&found.dependent_determinant),
    })
}
