//! Check that the declared start lies in front of every wall and on the constraints.

use dalembert_expr::{ExprId, Pool, SymbolId};

use super::super::resolve::Resolver;
use super::super::{Condition, Constraint, Initial, Law, Surface};
use crate::diagnostics::Location;
use crate::spec::InitialTarget;

/// Relative size below which a sum may be rounding.
const MARGIN: f64 = 1e-9;

/// Refuses a start behind a wall or off the constraints, at the defaults of the parameters. It passes over gaps and
/// residuals whose values depend on parameters without defaults, or on values that are known at run time only.
pub(super) fn check(
    resolver: &mut Resolver<'_>,
    initial: &Initial,
    surfaces: &[Surface],
    constraints: &[Constraint],
) {
    if resolver.spec.initial.is_empty() {
        return;
    }
    let mut start = Start::new(resolver, initial, constraints);
    let mut refused = start.behind_walls(surfaces);
    refused.extend(start.off_constraints(constraints));
    for Refused { at, text, help } in refused {
        resolver.refuse::<()>(at, text, help);
    }
}

/// An error to be reported.
struct Refused {
    at: Location,
    text: String,
    help: &'static str,
}

/// The declared start, as far as it is known at build time.
struct Start<'a, 'b> {
    resolver: &'a Resolver<'b>,
    /// Residuals of constraints are computed in a copy of the pool: the check adds nothing to the model.
    pool: Pool,
    initial: &'a Initial,
    /// Coordinates without a declared value that an equation of positions determines at run time.
    solved_for: Vec<SymbolId>,
}

impl<'a, 'b> Start<'a, 'b> {
    fn new(resolver: &'a Resolver<'b>, initial: &'a Initial, constraints: &[Constraint]) -> Self {
        let equations = constraints
            .iter()
            .filter(|constraint| constraint.is_of_positions);
        let involved: Vec<SymbolId> = equations
            .filter_map(|constraint| constraint.level)
            .flat_map(|level| resolver.pool.symbols(level))
            .collect();
        let coordinates = resolver.symbols.coordinates.iter().zip(&initial.q);
        let open = coordinates
            .filter(|(coordinate, value)| value.is_none() && involved.contains(&coordinate.q));
        Self {
            resolver,
            pool: resolver.pool.clone(),
            initial,
            solved_for: open.map(|(coordinate, _)| coordinate.q).collect(),
        }
    }

    /// Walls whose gap depends on a declared position and is negative.
    fn behind_walls(&self, surfaces: &[Surface]) -> Vec<Refused> {
        let walls = surfaces
            .iter()
            .filter(|surface| !matches!(surface.law, Law::Reset | Law::Transition));
        let behind = walls.filter_map(|surface| {
            let at = self.declared_at(surface.gap)?;
            if !self.counts(surface) || self.clear_sign(surface.gap) != Some(-1.0) {
                return None;
            }
            let (name, gap) = (&surface.name.display, self.shown(surface.gap));
            Some(Refused {
                at,
                text: format!("the start lies behind the surface `{name}`: its gap is {gap}"),
                help: "a motion starts where every gap is 0 or more",
            })
        });
        behind.collect()
    }

    /// True if a surface clearly counts at the start.
    fn counts(&self, surface: &Surface) -> bool {
        let has_sign =
            |condition: &Condition, sign: f64| self.clear_sign(condition.margin) == Some(sign);
        let mut conditions = surface.conditions.iter();
        conditions.all(|condition| has_sign(condition, 1.0))
            && surface
                .beside
                .others()
                .iter()
                .all(|other| other.iter().any(|condition| has_sign(condition, -1.0)))
    }

    /// Constraints that the declared positions and velocities violate.
    fn off_constraints(&mut self, constraints: &[Constraint]) -> Vec<Refused> {
        let off = constraints.iter().filter_map(|constraint| {
            let residual = self.residual(constraint)?;
            let at = self.declared_at(residual)?;
            self.clear_sign(residual)?;
            let (name, value) = (&constraint.name.display, self.shown(residual));
            let text = format!(
                "the start is off the constraint `{name}`: left side minus right side is {value}"
            );
            Some(Refused {
                at,
                text,
                help: "leave one of these values out of `initial`; it is then solved for",
            })
        });
        off.collect()
    }

    /// The expression that vanishes on the constraint.
    fn residual(&mut self, constraint: &Constraint) -> Option<ExprId> {
        if constraint.is_of_positions {
            return constraint.level;
        }
        if constraint.nonlinear.is_some() {
            return constraint.nonlinear;
        }
        let mut terms = vec![constraint.affine];
        for (entry, velocity) in constraint
            .form
            .iter()
            .zip(self.resolver.symbols.velocities())
        {
            let velocity = self.pool.variable(velocity);
            terms.push(self.pool.mul(*entry, velocity));
        }
        Some(self.pool.sum(&terms))
    }

    /// The last entry of `initial` that an expression depends on.
    fn declared_at(&self, id: ExprId) -> Option<Location> {
        let symbols = self.pool.symbols(id);
        let coordinates = self.resolver.symbols.coordinates.iter();
        let values = coordinates.zip(self.initial.q.iter().zip(&self.initial.qdot));
        let mut named: Vec<(InitialTarget, &str)> = Vec::new();
        for (coordinate, (q, qdot)) in values {
            let field = coordinate.name.field.as_str();
            if q.is_some() && symbols.contains(&coordinate.q) {
                named.push((InitialTarget::Position, field));
            }
            if qdot.is_some() && symbols.contains(&coordinate.qdot) {
                named.push((InitialTarget::Velocity, field));
            }
        }
        let mut entries = self.resolver.spec.initial.iter().rev();
        let entry = entries
            .find(|entry| named.contains(&(entry.target, entry.declared.name.text.as_str())))?;
        Some(entry.value.at)
    }

    /// The value of an expression, rounded to twelve digits.
    fn shown(&self, id: ExprId) -> String {
        let value = self.pool.eval(&[id], &|symbol| self.at(symbol))[0];
        let rounded = format!("{value:.11e}").parse::<f64>();
        rounded.unwrap_or(value).to_string()
    }

    /// The sign, 1 or -1; `None` if it may be due to rounding.
    fn clear_sign(&self, id: ExprId) -> Option<f64> {
        let (value, magnitude) = self.pool.eval_magnitude(id, &|symbol| self.at(symbol));
        (value.abs() > MARGIN * magnitude).then(|| value.signum())
    }

    /// The value of a symbol at the start; NaN if it is known at run time only.
    fn at(&self, symbol: SymbolId) -> f64 {
        let coordinates = &self.resolver.symbols.coordinates;
        if self.solved_for.contains(&symbol) {
            return f64::NAN;
        }
        if symbol == self.resolver.symbols.time {
            return 0.0;
        }
        if let Some(index) = coordinates
            .iter()
            .position(|coordinate| coordinate.q == symbol)
        {
            return self.initial.q[index].map_or(0.0, |value| self.of_parameters(value));
        }
        if let Some(index) = coordinates
            .iter()
            .position(|coordinate| coordinate.qdot == symbol)
        {
            return self.initial.qdot[index].map_or(f64::NAN, |value| self.of_parameters(value));
        }
        self.default(symbol)
    }

    fn of_parameters(&self, value: ExprId) -> f64 {
        let default = |symbol: SymbolId| self.default(symbol);
        self.resolver.pool.eval(&[value], &default)[0]
    }

    fn default(&self, symbol: SymbolId) -> f64 {
        let mut parameters = self.resolver.symbols.parameters.iter();
        let found = parameters.find(|parameter| parameter.symbol == symbol);
        let value = found.and_then(|parameter| parameter.default);
        value.map_or(f64::NAN, |value| self.resolver.constant_value(value))
    }
}
