//! What several functions of a model share, computed at most once per function: velocity, factorisations,
//! multipliers.

use dalembert_expr::{ExprId, Sign, SymbolId};

use super::builder::Builder;
use super::expression::Expressions;
use super::linear::Ldlt;
use super::mass::ConstraintFactors;
use super::{Form, Function, Input, Value};
use crate::mechanics::Derivation;
use crate::mechanics::constraint::regular_minor;
use crate::model::Model;

/// What the second half of a function's arguments is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arguments {
    /// `(t, q)`
    Position,
    /// `(t, q, p)`
    Momenta,
    /// `(t, q, qdot)`
    Velocities,
    /// `(t, q, p)` with `qdot` computed beforehand: for functions that would repeat the solve of a function that
    /// exists anyway.
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
        }
    }

    /// The same for a function that would repeat the solve for the velocities.
    pub fn state_with_velocity(self) -> Arguments {
        match self {
            Self::Global => Arguments::Both,
            Self::Reduced => Arguments::Quasi,
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
    ldlt: Option<Ldlt>,
    constraint_factors: Option<ConstraintFactors>,
    qdot: Option<Vec<Value>>,
    multipliers: Option<Vec<Value>>,
    /// `X_i`
    pub(super) frame_fields: Option<Vec<Vec<Value>>>,
    /// The factors of `G_D`.
    pub(super) reduced_ldlt: Option<Ldlt>,
}

impl<'a> Kernel<'a> {
    /// A kernel whose positions, parameters and time are bound, and velocities too if they are arguments.
    pub fn new(model: &'a Model, derivation: &'a Derivation, arguments: Arguments) -> Self {
        let mut kernel = Self {
            model,
            derivation,
            builder: Builder::new(),
            expressions: Expressions::new(&model.pool),
            arguments,
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
        if matches!(arguments, Arguments::Velocities | Arguments::Both) {
            let inputs = (0..model.coordinates.len())
                .map(|i| kernel.builder.input(Input::Velocity(i)))
                .collect();
            kernel.bind_velocity(inputs);
        }
        kernel
    }

    fn bind(&mut self, symbol: SymbolId, input: Input) {
        let value = self.builder.input(input);
        self.expressions.bind(symbol, value);
    }

    /// Says what a symbol's value is.
    pub fn bind_value(&mut self, symbol: SymbolId, value: Value) {
        self.expressions.bind(symbol, value);
    }

    /// The value of a symbol that is bound; 0 if it is not.
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

    /// Whether some constraint has an affine part.
    pub fn has_affine_constraints(&self) -> bool {
        let mut constraints = self.derivation.constraints.iter();
        constraints.any(|own| !self.model.pool.is_syntactic_zero(own.affine))
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
        let n = self.dimension();
        let mut metric = Vec::with_capacity(n);
        let mut positive = Vec::with_capacity(n);
        for i in 0..n {
            let row: Vec<ExprId> = self.model.lagrangian.metric[i][..=i].to_vec();
            positive.push(self.model.pool.sign(row[i]) == Sign::Positive);
            metric.push(self.values(&row));
        }
        Ldlt::factor(&mut self.builder, &metric, &positive)
    }

    /// `L^{-1} b`
    pub fn forward(&mut self, b: &[Value]) -> Vec<Value> {
        self.with_ldlt(|builder, ldlt| ldlt.forward(builder, b))
    }

    /// `g^{-1} b`
    pub fn raise(&mut self, b: &[Value]) -> Vec<Value> {
        self.with_ldlt(|builder, ldlt| ldlt.solve(builder, b))
    }

    /// Runs `work` with the metric's factors.
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

    /// `qdot = g^{-1}(p - A)`, `X_0 + X u`, or the arguments themselves.
    pub fn velocity(&mut self) -> Vec<Value> {
        if let Some(qdot) = &self.qdot {
            return qdot.clone();
        }
        let qdot = match self.arguments {
            Arguments::Quasi => self.velocity_from_quasi(),
            _ => {
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

    /// `eta^a`, M rows of N.
    pub fn forms(&mut self) -> Vec<Vec<Value>> {
        (0..self.constraints())
            .map(|a| {
                let form = self.derivation.constraints[a].form.clone();
                self.values(&form)
            })
            .collect()
    }

    /// Pairs of constraint and coordinate whose velocity follows from it, in an order to solve for them.
    pub fn regular_minor(&self) -> Option<Vec<(usize, usize)>> {
        regular_minor(&self.model.pool, &self.derivation.constraints)
    }

    fn factor_constraints(&mut self, which: &[usize]) -> ConstraintFactors {
        let mut columns = Vec::new();
        for &a in which {
            let form = self.derivation.constraints[a].form.clone();
            let form = self.values(&form);
            columns.push(self.forward(&form));
        }
        let independent = self.regular_minor().is_some();
        self.with_ldlt(|builder, ldlt| {
            ConstraintFactors::factor(builder, ldlt, columns, which, independent)
        })
    }

    /// Runs `work` with the factors of all constraint forms.
    pub fn with_constraints<T>(
        &mut self,
        work: impl FnOnce(&mut Builder, &Ldlt, &ConstraintFactors) -> T,
    ) -> T {
        let factors = match self.constraint_factors.take() {
            Some(factors) => factors,
            None => self.factor_constraints(&(0..self.constraints()).collect::<Vec<_>>()),
        };
        let result = self.with_ldlt(|builder, ldlt| work(builder, ldlt, &factors));
        self.constraint_factors = Some(factors);
        result
    }

    /// The `lambda` with `m lambda = -(eta g^{-1} b + s)`.
    pub fn constraint_solve(&mut self, b: &[Value], s: &[Value]) -> Vec<Value> {
        let y = self.forward(b);
        self.with_constraints(|builder, ldlt, factors| factors.solve(builder, ldlt, y, s))
    }

    /// As [`Kernel::constraint_solve`] with `b = 0`, for some of the constraints only.
    pub fn partial_solve(&mut self, which: &[usize], s: &[Value]) -> Vec<Value> {
        let factors = self.factor_constraints(which);
        let zero = self.builder.zero();
        let y = vec![zero; self.dimension()];
        self.with_ldlt(|builder, ldlt| factors.solve(builder, ldlt, y, s))
    }

    /// `f = dL/dq + F`
    pub fn force(&mut self) -> Vec<Value> {
        let force = self.derivation.field.force.clone();
        self.values(&force)
    }

    /// `lambda_a`
    pub fn multipliers(&mut self) -> Vec<Value> {
        if let Some(multipliers) = &self.multipliers {
            return multipliers.clone();
        }
        let free = self.force_without_drift();
        let curvature: Vec<ExprId> = self
            .derivation
            .constraints
            .iter()
            .map(|c| c.curvature)
            .collect();
        let curvature = self.values(&curvature);
        let multipliers = self.constraint_solve(&free, &curvature);
        for (constraint, &value) in self.model.constraints.iter().zip(&multipliers) {
            self.builder
                .name(value, format!("lambda_{}", constraint.name.display));
        }
        self.multipliers = Some(multipliers.clone());
        multipliers
    }

    /// `f - gdot qdot - Adot`
    pub fn force_without_drift(&mut self) -> Vec<Value> {
        let force = self.force();
        let drift = self.derivation.field.drift.clone();
        let drift = self.values(&drift);
        force
            .iter()
            .zip(drift)
            .map(|(&f, d)| self.builder.sub(f, d))
            .collect()
    }

    /// `covector + lambda_a eta^a`
    pub fn add_constraint_force(
        &mut self,
        covector: &[Value],
        multipliers: &[Value],
    ) -> Vec<Value> {
        let forms = self.forms();
        let mut total = covector.to_vec();
        for (form, &multiplier) in forms.iter().zip(multipliers) {
            for (entry, &component) in total.iter_mut().zip(form) {
                *entry = self.builder.add_product(*entry, multiplier, component);
            }
        }
        total
    }

    /// The finished function.
    pub fn finish(self, outputs: Vec<Value>) -> Function {
        self.builder.finish(outputs)
    }
}
