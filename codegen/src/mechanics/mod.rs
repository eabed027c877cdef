//! Stage 3, derive: from a checked model to the expressions of its equations. It knows neither tokens nor spans.
//!
//! With `L = 1/2 qdot^T g qdot + A.qdot - V`, constraints `eta^a(qdot) + eta^a_0 = 0` and forces `F`:
//!
//! ```text
//! qdot = g^{-1}(p - A)                                    pdot = f + lambda_a eta^a
//! f_k  = d_k L + F_k                                      drift = gdot qdot + Adot
//! m^{ab} lambda_b = -[ W^a.(f - drift) + curvature_a ]    W^a = g^{-1} eta^a,  m^{ab} = eta^a(W^b)
//! curvature_a = (d_i eta^a_j) qdot^i qdot^j + (d_i eta^a_0) qdot^i + (d_t eta^a_j) qdot^j + d_t eta^a_0
//! ```
//!
//! Emitted functions need derivatives only: `g^{-1}` and `m_ab` are not formed. The program stage factorises (see
//! [`crate::program::linear`]), except for factors that are known as expressions ([`factors`], [`frame::Invariant`]).
//! Brackets, reductions and the maximum principle write out the inverses of small matrices.
//! Sources: W. Clark, thesis, chapters III and V, with signs as in docs/conventions.md.

pub mod bracket;
mod common_factor;
pub mod constraint;
pub mod control;
pub mod density;
pub(crate) mod energy;
pub mod factors;
pub mod field;
pub mod frame;
pub mod impact;
pub(crate) mod inverse;
pub mod linkage;
pub mod metric;
mod narrow;
mod rank;
pub mod reduction;

use dalembert_expr::{ExprId, SymbolId};

use crate::model::Model;

pub use bracket::{Bracket, NoBracket};
pub use constraint::ConstraintForm;
pub use density::DensityTerms;
pub use factors::FactorRow;
pub use field::FieldTerms;
pub use frame::{Frame, Unreduced};
pub use impact::{SurfaceForm, kinks};
pub use linkage::Linkage;
pub use metric::MetricDerivatives;

/// The expressions from which every emitted function is built, in the pool of the model.
#[derive(Debug)]
pub struct Derivation {
    /// Rows of the factorisation of the metric that are known as expressions.
    pub factors: Vec<Option<FactorRow>>,
    /// The kinetic energy as squares of velocities that follow from one another, if this takes fewer operations.
    pub linkage: Option<Linkage>,
    /// Momenta, forces and drift.
    pub field: FieldTerms,
    /// Constraint forms with their curvature terms.
    pub constraints: Vec<ConstraintForm>,
    /// True if all constraints are linear in the velocities, and were not proved to stay independent along a motion.
    pub can_lose_rank: bool,
    /// True if the rates may have features that are narrow compared with the length of a step.
    pub can_be_narrow: bool,
    /// Impact surfaces with their differentials.
    pub surfaces: Vec<SurfaceForm>,
    /// Derivatives for the density form and the divergence.
    pub density: DensityTerms,
    /// The motion reduced to D, or the reason why it is left in its global form.
    pub frame: Result<Frame, Unreduced>,
}

impl Derivation {
    /// Indices of the constraints that are integrable with a known function.
    pub fn levelled(&self) -> impl Iterator<Item = usize> {
        self.constraints
            .iter()
            .enumerate()
            .filter(|(_, constraint)| constraint.level.is_some())
            .map(|(a, _)| a)
    }
}

/// A component of a sparse array with its indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry<const RANK: usize> {
    /// The indices.
    pub index: [usize; RANK],
    /// The component. It is never the zero node.
    pub value: ExprId,
}

/// Derives everything that is emitted from a checked model; new expressions are added to the model's pool.
pub fn derive(model: &mut Model) -> Derivation {
    let coordinates = Coordinates::of(model);
    let metric = metric::derive_metric(model, &coordinates);
    let constraints = constraint::derive_constraints(model, &coordinates);
    let density = density::derive_density(model, &coordinates, metric);
    let field = field::derive_field(model, &coordinates);
    let frame = frame::derive_frame(model, &coordinates, &constraints, &field);
    let surfaces = impact::derive_surfaces(model, &coordinates, frame.as_ref().ok());
    let metric_rows = model.lagrangian.metric.clone();
    let mut varying = [&coordinates.q[..], &coordinates.qdot].concat();
    varying.push(coordinates.time);
    let rates = model.field.as_ref().unwrap_or(&field.force);
    let can_be_narrow = narrow::can_be_narrow(&model.pool, rates, &varying);
    Derivation {
        can_lose_rank: !model.is_nonlinear()
            && !rank::is_constant(&model.pool, &coordinates.q, &constraints),
        can_be_narrow,
        factors: factors::derive_factors(&mut model.pool, &metric_rows),
        linkage: match can_be_narrow {
            // NOTE: rates along a step are then enclosed. Intervals grow along the links more than in the metric.
            true => None,
            false => linkage::derive_linkage(model, &coordinates, &field.force),
        },
        field,
        constraints,
        surfaces,
        density,
        frame,
    }
}

/// The symbols by which expressions are differentiated.
#[derive(Debug, Clone)]
pub struct Coordinates {
    /// Coordinates, in order.
    pub q: Vec<SymbolId>,
    /// Velocities, in order.
    pub qdot: Vec<SymbolId>,
    /// Time.
    pub time: SymbolId,
}

impl Coordinates {
    fn of(model: &Model) -> Self {
        Self {
            q: model
                .coordinates
                .iter()
                .map(|coordinate| coordinate.q)
                .collect(),
            qdot: model
                .coordinates
                .iter()
                .map(|coordinate| coordinate.qdot)
                .collect(),
            time: model.time,
        }
    }

    /// The direction of the motion in `(q, t)`: `qdot` for q, 1 for t.
    fn motion(&self, model: &mut Model) -> Vec<(SymbolId, ExprId)> {
        let mut direction: Vec<_> = self
            .q
            .iter()
            .zip(&self.qdot)
            .map(|(&q, &qdot)| (q, model.pool.variable(qdot)))
            .collect();
        direction.push((self.time, model.pool.one()));
        direction
    }
}

/// The derivatives of `expression` with respect to the symbols, without those that are the zero node.
fn gradient(model: &mut Model, expression: ExprId, symbols: &[SymbolId]) -> Vec<Entry<1>> {
    let mut entries = Vec::new();
    for (k, &symbol) in symbols.iter().enumerate() {
        if !model.pool.depends_on(expression, symbol) {
            continue;
        }
        let value = model.pool.diff(expression, symbol);
        if !model.pool.is_syntactic_zero(value) {
            entries.push(Entry { index: [k], value });
        }
    }
    entries
}
