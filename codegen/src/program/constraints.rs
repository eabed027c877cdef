//! Constraint forms, their factors and the multipliers as operations.

use dalembert_expr::ExprId;

use super::Value;
use super::builder::Builder;
use super::kernel::Kernel;
use super::linear::Ldlt;
use super::mass::ConstraintFactors;
use crate::mechanics::constraint::regular_minor;

impl<'a> Kernel<'a> {
    /// `eta^a`, M rows of N.
    pub fn forms(&mut self) -> Vec<Vec<Value>> {
        (0..self.constraints())
            .map(|a| {
                let form = self.form(a);
                self.values(form)
            })
            .collect()
    }

    fn form(&self, a: usize) -> &'a [ExprId] {
        let constraint = &self.derivation.constraints[a];
        match self.primitive {
            true => &constraint.primitive.0,
            false => &constraint.form,
        }
    }

    fn curvature(&self, a: usize) -> ExprId {
        let constraint = &self.derivation.constraints[a];
        match self.primitive {
            true => constraint.primitive.1,
            false => constraint.curvature,
        }
    }

    /// Pairs of a constraint and the coordinate whose velocity it determines, in an order in which they can be solved.
    pub fn regular_minor(&self) -> Option<Vec<(usize, usize)>> {
        regular_minor(&self.model.pool, &self.derivation.constraints)
    }

    fn factor_constraints(&mut self, which: &[usize]) -> ConstraintFactors {
        let mut columns = Vec::new();
        for &a in which {
            let form = self.form(a);
            let form = self.values(form);
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

    /// A column `L^{-1} b` without its components along the constraint columns.
    pub fn without_constraints(&mut self, column: Vec<Value>) -> Vec<Value> {
        match self.constraints() {
            0 => column,
            _ => self
                .with_constraints(|builder, ldlt, factors| factors.project(builder, ldlt, column)),
        }
    }

    /// The `lambda` with `m lambda = -(eta g^{-1} b + s)`.
    pub fn constraint_solve(&mut self, b: &[Value], s: &[Value]) -> Vec<Value> {
        let y = self.forward(b);
        self.with_constraints(|builder, ldlt, factors| factors.solve(builder, ldlt, y, s))
    }

    /// Same as [`Kernel::constraint_solve`] with `b = 0`, for some of the constraints.
    pub fn partial_solve(&mut self, which: &[usize], s: &[Value]) -> Vec<Value> {
        let factors = self.factor_constraints(which);
        let zero = self.builder.zero();
        let y = vec![zero; self.dimension()];
        self.with_ldlt(|builder, ldlt| factors.solve(builder, ldlt, y, s))
    }

    /// `lambda_a`
    pub fn multipliers(&mut self) -> Vec<Value> {
        if let Some(multipliers) = &self.multipliers {
            return multipliers.clone();
        }
        let free = self.force_without_drift();
        let constraints = 0..self.constraints();
        let curvature: Vec<ExprId> = constraints.map(|a| self.curvature(a)).collect();
        let curvature = self.values(&curvature);
        let multipliers = self.constraint_solve(&free, &curvature);
        for (a, &value) in multipliers.iter().enumerate() {
            if self.form(a) == self.derivation.constraints[a].form {
                let name = &self.model.constraints[a].name.display;
                self.builder.name(value, format!("lambda_{name}"));
            }
        }
        self.multipliers = Some(multipliers.clone());
        multipliers
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
}
