//! Ingredients of the density problem of a model: metric, constraints, and the velocity-dependence of its forces.

use dalembert_expr::{ExprId, Node, Pool, SymbolId, Verdict};

use super::contraction::{Dependence, ForceSlope, dependence};
use super::dynamics::Dynamics;
use super::locus::Locus;
use super::sample::Sample;
use super::undecided::Undecided;
use crate::mechanics::Derivation;
use crate::model::Model;

/// The data that determine whether an invariant volume exists.
///
/// Components are the coordinates in order, followed by time if `t` occurs.
#[derive(Debug, Clone)]
pub struct Problem {
    /// `g`, N rows of N.
    pub(super) metric: Vec<Vec<ExprId>>,
    /// `eta^a`, M rows of N.
    pub(super) forms: Vec<Vec<ExprId>>,
    /// `eta_0^a`, M entries. All are the zero node if the constraints are linear.
    pub(super) affine: Vec<ExprId>,
    /// Velocity-dependent part of the forces; `None` if the forces do not depend on velocities.
    pub(super) friction: Option<Friction>,
    /// Positions that satisfy the position equations.
    pub(super) positions: Locus,
    /// Symbols of the components.
    pub(super) symbols: Vec<SymbolId>,
    /// Indices of the components that occur anywhere, in order. They are the variables of all series.
    pub(super) variables: Vec<usize>,
    /// N, the number of coordinates.
    pub(super) coordinates: usize,
}

/// The part of the forces that depends on velocities.
#[derive(Debug, Clone)]
pub(super) struct Friction {
    /// `dF_i/dqdot^j` at `qdot = 0`, N rows of N.
    pub(super) at_rest: Vec<Vec<ExprId>>,
    /// `d^2F_i/dqdot^j dqdot^k` at `qdot = 0`, indexed `[i][j][k]`.
    pub(super) slope: Vec<Vec<Vec<ExprId>>>,
    /// `dF_i/dqdot^j`, entries that are not 0.
    pub(super) entries: Vec<ForceSlope>,
    /// Dependence of the divergence of the forces on velocities in D.
    pub(super) dependence: Dependence,
}

impl Problem {
    /// The problem of a model with its derivation.
    pub fn of(model: &mut Model, derivation: &Derivation) -> Self {
        let metric = model.lagrangian.metric.clone();
        let forms: Vec<_> = derivation
            .constraints
            .iter()
            .map(|constraint| constraint.form.clone())
            .collect();
        let affine: Vec<_> = derivation
            .constraints
            .iter()
            .map(|constraint| constraint.affine)
            .collect();
        let mut symbols: Vec<_> = model
            .coordinates
            .iter()
            .map(|coordinate| coordinate.q)
            .collect();
        let velocities: Vec<_> = model
            .coordinates
            .iter()
            .map(|coordinate| coordinate.qdot)
            .collect();
        let friction = friction(model, derivation, &velocities);
        let coordinates = symbols.len();
        symbols.push(model.time);
        let mut problem = Self {
            metric,
            forms,
            affine,
            friction,
            positions: Locus::of_model(model),
            symbols,
            variables: Vec::new(),
            coordinates,
        };
        problem.settle(&model.pool);
        problem.examine_forces(model, derivation);
        problem
    }

    /// Determines the velocity-dependence of the divergence for forces that are not quadratic.
    fn examine_forces(&mut self, model: &mut Model, derivation: &Derivation) {
        let is_open = |friction: &Friction| friction.dependence == Dependence::Unknown;
        if !self.friction.as_ref().is_some_and(is_open) {
            return;
        }
        let seed = model.pool.seed();
        let dynamics = Dynamics::of(model, derivation);
        let found = dependence(model, self, &dynamics, seed);
        // The derivatives at rest determine a linear force, if rest lies in D and the derivatives exist there.
        let has_rest = self
            .affine
            .iter()
            .all(|entry| model.pool.is_syntactic_zero(*entry));
        let Some(friction) = &mut self.friction else {
            return;
        };
        let velocities: Vec<_> = model
            .coordinates
            .iter()
            .map(|coordinate| coordinate.qdot)
            .collect();
        let is_known = has_rest && friction.is_smooth_at_rest(&model.pool, &velocities);
        friction.dependence = match found {
            Dependence::Linear if !is_known => Dependence::Unknown,
            other => other,
        };
    }

    /// `dF_i/dqdot^j` of all forces, entries that are not 0.
    pub(super) fn force_slopes(&self) -> impl Iterator<Item = ExprId> {
        let entries = self.friction.iter().flat_map(|friction| &friction.entries);
        entries.map(|(_, slope)| *slope)
    }

    /// The problem without forces.
    pub(super) fn without_forces(&self) -> Self {
        Self {
            friction: None,
            ..self.clone()
        }
    }

    /// The problem with parameters replaced by expressions.
    pub(super) fn substituted(&self, pool: &mut Pool, replacements: &[(SymbolId, ExprId)]) -> Self {
        let mut problem = self.clone();
        let mut replace = |ids: &mut Vec<ExprId>| *ids = pool.substitute_all(ids, replacements);
        problem.metric.iter_mut().for_each(&mut replace);
        problem.forms.iter_mut().for_each(&mut replace);
        replace(&mut problem.affine);
        if let Some(friction) = &mut problem.friction {
            friction.at_rest.iter_mut().for_each(&mut replace);
            friction.slope.iter_mut().flatten().for_each(&mut replace);
            for (_, slope) in &mut friction.entries {
                *slope = pool.substitute(*slope, replacements);
            }
        }
        problem.positions = problem.positions.substituted(pool, replacements);
        problem.settle(pool);
        problem
    }

    /// Removes time if it does not occur, and determines the variables.
    fn settle(&mut self, pool: &Pool) {
        let roots = self.roots();
        let occurs = |symbol: &SymbolId| roots.iter().any(|id| pool.depends_on(*id, *symbol));
        if !self.symbols.get(self.coordinates).is_some_and(occurs) {
            self.symbols.truncate(self.coordinates);
        }
        self.variables = (0..self.symbols.len())
            .filter(|i| occurs(&self.symbols[*i]))
            .collect();
    }

    /// Rejects forces whose divergence is not known to be linear in the velocities. The criterion does not cover them.
    ///
    /// # Errors
    /// [`Undecided::Forces`].
    pub(super) fn check_forces(&self) -> Result<(), Undecided> {
        match &self.friction {
            Some(friction) if friction.dependence != Dependence::Linear => Err(Undecided::Forces),
            _ => Ok(()),
        }
    }

    /// A state at which the divergence of the forces, at equidistant velocities on a line, is not linear in the
    /// velocities, with the values found.
    pub(super) fn curved(&self) -> Option<(&Sample, &[(String, f64)])> {
        match &self.friction.as_ref()?.dependence {
            Dependence::Curved(sample, values) => Some((sample, values)),
            Dependence::Linear | Dependence::Unknown => None,
        }
    }

    /// Indices of the parameters that occur.
    pub(super) fn parameters(&self, model: &Model) -> Vec<usize> {
        let roots = self.roots();
        let occurs = |position: &usize| {
            let symbol = model.parameters[*position].symbol;
            roots.iter().any(|id| model.pool.depends_on(*id, symbol))
        };
        (0..model.parameters.len()).filter(occurs).collect()
    }

    /// True if time occurs.
    pub(super) fn is_time_dependent(&self) -> bool {
        self.symbols.len() > self.coordinates
    }

    /// The number of components: coordinates, and time if it occurs.
    pub(super) fn components(&self) -> usize {
        self.symbols.len()
    }

    /// Symbols of the variables.
    pub(super) fn variable_symbols(&self) -> Vec<SymbolId> {
        self.variables.iter().map(|i| self.symbols[*i]).collect()
    }

    /// All expressions of the problem.
    pub(super) fn roots(&self) -> Vec<ExprId> {
        let mut roots: Vec<_> = self.metric.iter().flatten().copied().collect();
        roots.extend(self.forms.iter().flatten());
        roots.extend(&self.affine);
        if let Some(friction) = &self.friction {
            roots.extend(friction.at_rest.iter().flatten());
            roots.extend(friction.slope.iter().flatten().flatten());
        }
        roots
    }

    /// True if the motion on D or the volume has a rate at zero velocity.
    pub fn has_drift(&self, pool: &Pool) -> bool {
        self.is_time_dependent()
            || self.friction.is_some()
            || self.affine.iter().any(|id| !pool.is_syntactic_zero(*id))
    }
}

impl Friction {
    /// True if the derivatives of the forces are polynomials in the velocities.
    fn is_smooth_at_rest(&self, pool: &Pool, velocities: &[SymbolId]) -> bool {
        let is_pole = |id: &ExprId| match pool.node(*id) {
            Node::Product(factors) => factors
                .iter()
                .any(|(base, power)| power.is_negative() && pool.depends_on_any(*base, velocities)),
            _ => false,
        };
        self.entries.iter().all(|(_, slope)| {
            is_rational(pool, *slope, velocities) && !pool.reachable(&[*slope]).iter().any(is_pole)
        })
    }
}

/// True if velocities occur only in sums, products and integer powers. Forces like `abs(v)*v`, which are smooth only
/// piecewise, do not qualify.
fn is_rational(pool: &Pool, value: ExprId, velocities: &[SymbolId]) -> bool {
    let parts = pool.reachable(&[value]);
    parts.iter().all(|id| match pool.node(*id) {
        Node::Call(..) | Node::Atan2(..) => !pool.depends_on_any(*id, velocities),
        Node::Product(factors) => factors.iter().all(|(base, exponent)| {
            exponent.is_integer() || !pool.depends_on_any(*base, velocities)
        }),
        Node::Number(_) | Node::Pi | Node::Symbol(_) | Node::Sum { .. } => true,
    })
}

fn friction(
    model: &mut Model,
    derivation: &Derivation,
    velocities: &[SymbolId],
) -> Option<Friction> {
    if derivation.density.force_velocity.is_empty() {
        return None;
    }
    let (n, zero) = (velocities.len(), model.pool.zero());
    let mut at_rest = vec![vec![zero; n]; n];
    let mut slope = vec![vec![vec![zero; n]; n]; n];
    let mut is_quadratic = true;
    let rest: Vec<_> = velocities.iter().map(|qdot| (*qdot, zero)).collect();
    for entry in &derivation.density.force_velocity {
        let [i, j] = entry.index;
        is_quadratic &= is_rational(&model.pool, entry.value, velocities);
        at_rest[i][j] = model.pool.substitute(entry.value, &rest);
        for (k, qdot) in velocities.iter().enumerate() {
            let second = model.pool.diff(entry.value, *qdot);
            is_quadratic &= velocities.iter().all(|other| {
                let third = model.pool.diff(second, *other);
                model.pool.zero_test(third) == Verdict::Proved
            });
            slope[i][j][k] = model.pool.substitute(second, &rest);
        }
    }
    let entries = derivation.density.force_velocity.iter();
    Some(Friction {
        at_rest,
        slope,
        entries: entries.map(|entry| (entry.index, entry.value)).collect(),
        dependence: match is_quadratic {
            true => Dependence::Linear,
            false => Dependence::Unknown,
        },
    })
}
