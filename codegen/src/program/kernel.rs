//! Quantities that several functions of a model need: velocity, factorisations, multipliers. A function computes each
//! of them at most once.

use dalembert_expr::{ExprId, Sign, SymbolId};

use super::builder::Builder;
use super::expression::Expressions;
use super::linear::{KnownRow, Ldlt};
use super::mass::ConstraintFactors;
use super::{Form, Function, Guard, Input, Value};
use crate::mechanics::Derivation;
use crate::model::Model;

/// Arguments of a function besides time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arguments {
    /// `(t, q)`
    Position,
    /// `(t, q, p)`
    Momenta,
    /// `(t, q, qdot)`
    Velocities,
    /// `(t, q, p)` and `qdot`. The caller has computed `qdot` with the velocity function, so that this function does
    /// not repeat its solve.
    Both,
    /// `(t, q, u)`
    Quasi,
}

impl Form {
    /// The arguments of a function of the state.
    pub fn state(self) -> Arguments {
        match self {
            Self::Global => Arguments::Momenta,
            Self::Reduced => Arguments::Quasi,
            Self::FirstOrder => Arguments::Position,
        }
    }

    /// Same as [`Form::state`], with velocities as arguments where the function would have to solve for them.
    pub fn state_with_velocity(self) -> Arguments {
        match self {
            Self::Global => Arguments::Both,
            Self::Reduced => Arguments::Quasi,
            Self::FirstOrder => Arguments::Position,
        }
    }
}

/// A function under construction together with the model it belongs to.
pub struct Kernel<'a> {
    pub(super) model: &'a Model,
    pub(super) derivation: &'a Derivation,
    pub(super) builder: Builder,
    expressions: Expressions<'a>,
    arguments: Arguments,
    /// True if constraint forms are divided by the common numeric factor of their components. Multipliers then differ
    /// from those of the declaration.
    pub(super) primitive: bool,
    /// True if the function returns a fault where the instantaneous constraints of a surface are dependent.
    pub(super) guards_surfaces: bool,
    /// True if velocities are explicit expressions in the quasi-velocities. Otherwise they follow from successive
    /// solves.
    pub(super) written: bool,
    ldlt: Option<Ldlt>,
    pub(super) constraint_factors: Option<ConstraintFactors>,
    qdot: Option<Vec<Value>>,
    pub(super) multipliers: Option<Vec<Value>>,
    /// `X_i`
    pub(super) frame_fields: Option<Vec<Vec<Value>>>,
    /// The factors of `G_D`.
    pub(super) reduced_ldlt: Option<Ldlt>,
}

impl<'a> Kernel<'a> {
    /// A kernel with bound positions, parameters and time; velocities are bound as well if they are arguments.
    pub fn new(model: &'a Model, derivation: &'a Derivation, arguments: Arguments) -> Self {
        let mut kernel = Self {
            model,
            derivation,
            builder: Builder::new(),
            expressions: Expressions::new(&model.pool),
            arguments,
            primitive: false,
            guards_surfaces: true,
            written: false,
            ldlt: None,
            constraint_factors: None,
            qdot: None,
            multipliers: None,
            frame_fields: None,
            reduced_ldlt: None,
        };
        kernel.bind(model.time, Input::Time);
        for (k, parameter) in model.parameters.iter().enumerate() {
            kernel.bind(parameter.symbol, Input::Parameter(k));
        }
        for (i, coordinate) in model.coordinates.iter().enumerate() {
            kernel.bind(coordinate.q, Input::Coordinate(i));
        }
        if let Some(linkage) = &derivation.linkage {
            kernel.bind_positions(linkage);
        }
        if matches!(arguments, Arguments::Velocities | Arguments::Both) {
            let inputs = (0..model.coordinates.len())
                .map(|i| kernel.builder.input(Input::Velocity(i)))
                .collect();
            kernel.bind_velocity(inputs);
        }
        kernel
    }

    /// Allows other scalings of the constraint forms, for a function whose results do not include multipliers.
    #[must_use]
    pub fn without_multipliers(self) -> Self {
        Self {
            primitive: true,
            ..self
        }
    }

    /// Omits the guards of instantaneous constraints. The function then gives NaN where these are dependent.
    #[must_use]
    pub fn without_surface_guards(self) -> Self {
        Self {
            guards_surfaces: false,
            ..self
        }
    }

    /// Uses explicit expressions of the velocities in the quasi-velocities.
    #[must_use]
    pub fn written_out(self) -> Self {
        Self {
            written: true,
            ..self
        }
    }

    fn bind(&mut self, symbol: SymbolId, input: Input) {
        let value = self.builder.input(input);
        self.expressions.bind(symbol, value);
    }

    /// Binds a symbol to its value.
    pub fn bind_value(&mut self, symbol: SymbolId, value: Value) {
        self.expressions.bind(symbol, value);
    }

    /// The value of a bound symbol; 0 if the symbol is not bound.
    pub fn symbol(&mut self, symbol: SymbolId) -> Value {
        let bound = self.expressions.bound(symbol);
        bound.unwrap_or_else(|| self.builder.zero())
    }

    fn bind_velocity(&mut self, qdot: Vec<Value>) {
        for (coordinate, &value) in self.model.coordinates.iter().zip(&qdot) {
            self.expressions.bind(coordinate.qdot, value);
        }
        self.qdot = Some(qdot);
    }

    /// Number of coordinates.
    pub fn dimension(&self) -> usize {
        self.model.coordinates.len()
    }

    /// Number of constraints.
    pub fn constraints(&self) -> usize {
        self.derivation.constraints.len()
    }

    /// True if some constraint has an affine part.
    pub fn has_affine_constraints(&self) -> bool {
        let mut constraints = self.derivation.constraints.iter();
        constraints.any(|constraint| !self.model.pool.is_syntactic_zero(constraint.affine))
    }

    /// The value of an expression of time, positions, velocities and parameters.
    pub fn value(&mut self, expression: ExprId) -> Value {
        if self.qdot.is_none() {
            let qdot: Vec<SymbolId> = self
                .model
                .coordinates
                .iter()
                .map(|coordinate| coordinate.qdot)
                .collect();
            if self.model.pool.depends_on_any(expression, &qdot) {
                self.velocity();
            }
        }
        self.expressions.lower(&mut self.builder, expression)
    }

    /// The values of several expressions.
    pub fn values(&mut self, expressions: &[ExprId]) -> Vec<Value> {
        expressions
            .iter()
            .map(|&expression| self.value(expression))
            .collect()
    }

    /// Names values after the coordinates: `x_dot` for the suffix `_dot`.
    pub fn name_by_coordinate(&mut self, values: &[Value], prefix: &str, suffix: &str) {
        for (coordinate, &value) in self.model.coordinates.iter().zip(values) {
            self.builder.name(
                value,
                format!("{prefix}{}{suffix}", coordinate.name.display),
            );
        }
    }

    fn factor_metric(&mut self) -> Ldlt {
        if let Some(linkage) = &self.derivation.linkage {
            return self.eliminate_along(linkage, &[]);
        }
        let n = self.dimension();
        let mut metric = Vec::with_capacity(n);
        let mut positive = Vec::with_capacity(n);
        for i in 0..n {
            let row: Vec<ExprId> = self.model.lagrangian.metric[i][..=i].to_vec();
            positive.push(self.model.pool.sign(row[i]) == Sign::Positive);
            metric.push(self.values(&row));
        }
        let rows = &self.derivation.factors;
        let known: Vec<Option<KnownRow>> = rows
            .iter()
            .map(|row| {
                row.as_ref().map(|row| KnownRow {
                    below: self.values(&row.below),
                    pivot: self.value(row.pivot),
                })
            })
            .collect();
        for (positive, row) in positive.iter_mut().zip(rows) {
            if let Some(row) = row {
                *positive = self.model.pool.sign(row.pivot) == Sign::Positive;
            }
        }
        let is_safe = |i: usize, value: Value| match &known[i] {
            Some(_) => positive[i],
            None => positive[i] && value == metric[i][i],
        };
        Ldlt::factor_guarded(&mut self.builder, &metric, &known, |builder, i, value| {
            if !is_safe(i, value) {
                builder.guard(Guard::Pivot { pivot: i, value });
            }
        })
    }

    /// `L^{-1} b`
    pub fn forward(&mut self, b: &[Value]) -> Vec<Value> {
        self.with_ldlt(|builder, ldlt| ldlt.forward(builder, b))
    }

    /// `g^{-1} b`
    pub fn raise(&mut self, b: &[Value]) -> Vec<Value> {
        if let (None, Some(linkage)) = (&self.ldlt, &self.derivation.linkage) {
            self.ldlt = Some(self.eliminate_along(linkage, b));
        }
        self.with_ldlt(|builder, ldlt| ldlt.solve(builder, b))
    }

    /// Calls `work` with the factors of the metric.
    pub fn with_ldlt<T>(&mut self, work: impl FnOnce(&mut Builder, &Ldlt) -> T) -> T {
        let ldlt = match self.ldlt.take() {
            Some(ldlt) => ldlt,
            None => self.factor_metric(),
        };
        let result = work(&mut self.builder, &ldlt);
        self.ldlt = Some(ldlt);
        result
    }

    /// `p - A` at the given momenta.
    fn kinetic_momenta(&mut self) -> Vec<Value> {
        let linear = self.model.lagrangian.linear.clone();
        linear
            .iter()
            .enumerate()
            .map(|(i, &a)| {
                let p = self.builder.input(Input::Momentum(i));
                let a = self.value(a);
                self.builder.sub(p, a)
            })
            .collect()
    }

    /// `qdot = g^{-1}(p - A)`, `X_0 + X u`, the declared rates, or the arguments themselves.
    pub fn velocity(&mut self) -> Vec<Value> {
        if let Some(qdot) = &self.qdot {
            return qdot.clone();
        }
        let qdot = match (&self.model.field, self.arguments) {
            (Some(rates), _) => self.values(rates),
            (None, Arguments::Quasi) => self.velocity_from_quasi(),
            (None, _) => {
                let momenta = self.kinetic_momenta();
                self.raise(&momenta)
            }
        };
        self.name_by_coordinate(&qdot, "", "_dot");
        self.bind_velocity(qdot.clone());
        qdot
    }

    /// `p - A = g qdot`.
    pub fn lowered_velocity(&mut self) -> Vec<Value> {
        if matches!(self.arguments, Arguments::Momenta | Arguments::Both) {
            return self.kinetic_momenta();
        }
        let qdot = self.velocity();
        self.lower_vector(&qdot)
    }

    /// `p = g qdot + A`
    pub fn momenta(&mut self) -> Vec<Value> {
        if matches!(self.arguments, Arguments::Momenta | Arguments::Both) {
            let inputs = 0..self.dimension();
            return inputs
                .map(|i| self.builder.input(Input::Momentum(i)))
                .collect();
        }
        let kinetic = self.lowered_velocity();
        let linear = self.model.lagrangian.linear.clone();
        let linear = self.values(&linear);
        let momenta: Vec<Value> = kinetic
            .iter()
            .zip(linear)
            .map(|(&p, a)| self.builder.add(p, a))
            .collect();
        self.name_by_coordinate(&momenta, "p_", "");
        momenta
    }

    /// `u . v`
    pub fn dot(&mut self, u: &[Value], v: &[Value]) -> Value {
        let mut total = self.builder.zero();
        for (&a, &b) in u.iter().zip(v) {
            total = self.builder.add_product(total, a, b);
        }
        total
    }

    /// `f = dL/dq + F`
    pub fn force(&mut self) -> Vec<Value> {
        match &self.derivation.linkage {
            Some(linkage) => self.force_along(linkage),
            None => self.values(&self.derivation.field.force),
        }
    }

    /// `gdot qdot + Adot`
    pub fn drift(&mut self) -> Vec<Value> {
        match &self.derivation.linkage {
            Some(linkage) => self.drift_along(linkage),
            None => self.values(&self.derivation.field.drift),
        }
    }

    /// `f - gdot qdot - Adot`
    pub fn force_without_drift(&mut self) -> Vec<Value> {
        let field = &self.derivation.field;
        let zero = self.builder.zero();
        (0..field.force.len())
            .map(|k| {
                if field.cancels[k] {
                    return zero;
                }
                let (force, drift) = (self.value(field.force[k]), self.value(field.drift[k]));
                self.builder.sub(force, drift)
            })
            .collect()
    }

    /// The finished function.
    pub fn finish(self, outputs: Vec<Value>) -> Function {
        self.builder.finish(outputs)
    }
}
