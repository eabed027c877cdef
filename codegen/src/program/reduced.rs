//! The motion reduced to D as operations: velocities from quasi-velocities, the metric on D, the rates of the
//! quasi-velocities. The formulas are in [`crate::mechanics::frame`].

use dalembert_expr::{ExprId, Sign};

use super::builder::Builder;
use super::coframe::Asked;
use super::kernel::Kernel;
use super::linear::Ldlt;
use super::{Form, Input, Value};
use crate::mechanics::Frame;
use crate::mechanics::frame::{Invariant, Row};

impl<'a> Kernel<'a> {
    /// The frame. Functions in reduced form exist only if there is one.
    pub(super) fn frame(&self) -> Option<&'a Frame> {
        self.derivation.frame.as_ref().ok()
    }

    /// Number of quasi-velocities.
    pub fn quasi_velocities(&self) -> usize {
        self.frame().map_or(0, |frame| frame.quasi.len())
    }

    /// `u`
    pub fn quasi_inputs(&mut self) -> Vec<Value> {
        let inputs = 0..self.quasi_velocities();
        inputs
            .map(|i| self.builder.input(Input::Quasi(i)))
            .collect()
    }

    /// `X_0 + X_i u^i` at the given quasi-velocities.
    pub(super) fn velocity_from_quasi(&mut self) -> Vec<Value> {
        let u = self.quasi_inputs();
        self.bind_quasi(&u);
        let known = self
            .invariant()
            .map_or(&[][..], |invariant| match self.written {
                true => &invariant.written_velocity,
                false => &invariant.velocity,
            });
        let affine = self.minus_affine();
        let asked = self.all_velocities(known);
        self.solve_frame(&asked, |_, row| match row {
            Row::Quasi(i) => u[i],
            Row::Constraint(a) => affine[a],
        })
    }

    /// Binds the symbols of the quasi-velocities to values.
    fn bind_quasi(&mut self, u: &[Value]) {
        let symbols = self.invariant().map_or(&[][..], |invariant| &invariant.u);
        for (&symbol, &value) in symbols.iter().zip(u) {
            self.bind_value(symbol, value);
        }
    }

    fn all_velocities<'e>(&self, known: &'e [Option<ExprId>]) -> Asked<'e> {
        Asked {
            velocities: vec![true; self.dimension()],
            known,
        }
    }

    /// Simplified expressions that do not depend on the configuration.
    fn invariant(&self) -> Option<&'a Invariant> {
        self.frame()?.invariant.as_ref()
    }

    /// `-eta_0`
    fn minus_affine(&mut self) -> Vec<Value> {
        let constraints = self.derivation.constraints.iter();
        let affine: Vec<ExprId> = constraints.map(|constraint| constraint.affine).collect();
        let affine = self.values(&affine);
        affine
            .iter()
            .map(|&value| self.builder.neg(value))
            .collect()
    }

    /// `X_i`, N - M rows of N.
    pub fn frame_fields(&mut self) -> Vec<Vec<Value>> {
        if let Some(fields) = &self.frame_fields {
            return fields.clone();
        }
        let fields = self.frame_fields_along(&vec![true; self.dimension()]);
        self.frame_fields = Some(fields.clone());
        fields
    }

    /// Components of `X_i` along some coordinates.
    fn frame_fields_along(&mut self, coordinates: &[bool]) -> Vec<Vec<Value>> {
        let invariant = self.invariant();
        (0..self.quasi_velocities())
            .map(|i| {
                let asked = Asked {
                    velocities: coordinates.to_vec(),
                    known: invariant.map_or(&[][..], |invariant| &invariant.fields[i]),
                };
                let unit =
                    |builder: &mut Builder, row| builder.integer(i64::from(row == Row::Quasi(i)));
                self.solve_frame(&asked, unit)
            })
            .collect()
    }

    /// `X_0`
    pub fn affine_field(&mut self) -> Vec<Value> {
        let affine = self.minus_affine();
        let asked = self.all_velocities(&[]);
        self.solve_frame(&asked, |builder, row| match row {
            Row::Quasi(_) => builder.zero(),
            Row::Constraint(a) => affine[a],
        })
    }

    /// `g v`
    pub fn lower_vector(&mut self, v: &[Value]) -> Vec<Value> {
        if let Some(linkage) = &self.derivation.linkage {
            return self.lower_along(linkage, v);
        }
        (0..self.dimension())
            .map(|i| {
                let row = self.model.lagrangian.metric[i].clone();
                let mut total = self.builder.zero();
                for (&entry, &component) in row.iter().zip(v) {
                    if !self.builder.is_zero(component) && !self.model.pool.is_syntactic_zero(entry)
                    {
                        let entry = self.value(entry);
                        total = self.builder.add_product(total, entry, component);
                    }
                }
                total
            })
            .collect()
    }

    /// `X^T b`
    pub fn restrict(&mut self, b: &[Value]) -> Vec<Value> {
        let met: Vec<bool> = b
            .iter()
            .map(|&entry| !self.builder.is_zero(entry))
            .collect();
        let fields = self.frame_fields_along(&met);
        fields.iter().map(|field| self.dot(field, b)).collect()
    }

    /// `G_D = X^T g X`, lower triangle
    pub fn reduced_metric(&mut self) -> Vec<Vec<Value>> {
        let known = self.known_metric();
        let is_known = |row: &Vec<Option<ExprId>>| row.iter().all(Option::is_some);
        if let Some(known) = known.filter(|known| known.iter().all(is_known)) {
            let rows = known.iter();
            return rows
                .map(|row| {
                    row.iter()
                        .flatten()
                        .map(|&entry| self.value(entry))
                        .collect()
                })
                .collect();
        }
        let fields = self.frame_fields();
        let lowered: Vec<Vec<Value>> = fields
            .iter()
            .map(|field| self.lower_vector(field))
            .collect();
        (0..fields.len())
            .map(|i| {
                let entry = |j: usize| match known.and_then(|metric| metric[i][j]) {
                    Some(known) => self.value(known),
                    None => self.dot(&fields[i], &lowered[j]),
                };
                (0..=i).map(entry).collect()
            })
            .collect()
    }

    /// Entries of `G_D` with a simplified expression, lower triangle.
    pub(super) fn known_metric(&self) -> Option<&'a Vec<Vec<Option<ExprId>>>> {
        self.invariant().map(|invariant| &invariant.metric)
    }

    /// Calls `work` with the factors of `G_D`.
    pub fn with_reduced_ldlt<T>(&mut self, work: impl FnOnce(&mut Builder, &Ldlt) -> T) -> T {
        let ldlt = match self.reduced_ldlt.take() {
            Some(ldlt) => ldlt,
            None => {
                let metric = self.reduced_metric();
                let all_positive = self.metric_is_positive();
                let positive: Vec<bool> = (0..metric.len())
                    .map(|i| all_positive || self.is_positive_entry(i))
                    .collect();
                Ldlt::factor(&mut self.builder, &metric, &positive)
            }
        };
        let result = work(&mut self.builder, &ldlt);
        self.reduced_ldlt = Some(ldlt);
        result
    }

    /// Calls `work` with the factors of the metric, or in reduced form with those of `G_D`.
    pub fn with_state_ldlt<T>(
        &mut self,
        form: Form,
        work: impl FnOnce(&mut Builder, &Ldlt) -> T,
    ) -> T {
        match form {
            Form::Reduced => self.with_reduced_ldlt(work),
            Form::Global | Form::FirstOrder => self.with_ldlt(work),
        }
    }

    /// True if the metric is diagonal with positive entries. The diagonal entries of `G_D` are then positive too,
    /// because no `X_i` vanishes.
    fn metric_is_positive(&self) -> bool {
        let (pool, metric) = (&self.model.pool, &self.model.lagrangian.metric);
        metric.iter().enumerate().all(|(i, row)| {
            pool.sign(row[i]) == Sign::Positive
                && row[..i].iter().all(|&entry| pool.is_syntactic_zero(entry))
        })
    }

    /// True if a diagonal entry of `G_D` has a simplified expression that is known to be positive.
    fn is_positive_entry(&self, i: usize) -> bool {
        let fixed = self
            .invariant()
            .and_then(|invariant| invariant.metric[i][i]);
        fixed.is_some_and(|fixed| self.model.pool.sign(fixed) == Sign::Positive)
    }

    /// `G_D^{-1} b`
    pub fn raise_reduced(&mut self, b: &[Value]) -> Vec<Value> {
        self.with_reduced_ldlt(|builder, ldlt| ldlt.solve(builder, b))
    }

    /// `a = Xdot u + Xdot_0`, the acceleration at constant quasi-velocities
    pub fn frame_acceleration(&mut self) -> Vec<Value> {
        let Some(frame) = self.frame() else {
            return Vec::new();
        };
        let quasi: Vec<ExprId> = frame
            .quasi
            .iter()
            .map(|velocity| velocity.curvature)
            .collect();
        let constraints = self.derivation.constraints.iter();
        let constraints: Vec<ExprId> = constraints.map(|constraint| constraint.curvature).collect();
        let (quasi, constraints) = (self.values(&quasi), self.values(&constraints));
        let asked = self.all_velocities(&[]);
        self.solve_frame(&asked, |builder, row| match row {
            Row::Quasi(i) => builder.neg(quasi[i]),
            Row::Constraint(a) => builder.neg(constraints[a]),
        })
    }

    /// `X w`
    pub fn along_frame(&mut self, w: &[Value]) -> Vec<Value> {
        let fields = self.frame_fields();
        let mut total = vec![self.builder.zero(); self.dimension()];
        for (field, &weight) in fields.iter().zip(w) {
            for (entry, &component) in total.iter_mut().zip(field) {
                *entry = self.builder.add_product(*entry, weight, component);
            }
        }
        total
    }

    /// `udot`
    pub fn quasi_rate(&mut self) -> Vec<Value> {
        self.velocity();
        let right = self.quasi_force();
        let known = self
            .invariant()
            .map_or(&[][..], |invariant| &invariant.rate);
        let is_known = known.iter().any(Option::is_some) && known.iter().all(Option::is_some);
        let mut rate = match is_known {
            true => right,
            false => self.raise_reduced(&right),
        };
        for (entry, &known) in rate.iter_mut().zip(known) {
            if let Some(known) = known {
                *entry = self.value(known);
            }
        }
        if let Some(frame) = self.frame() {
            for (quasi, &value) in frame.quasi.iter().zip(&rate) {
                self.builder.name(value, format!("{}_rate", quasi.name));
            }
        }
        rate
    }

    /// `X^T (f - gdot qdot - Adot - g a)`
    fn quasi_force(&mut self) -> Vec<Value> {
        let known = self
            .invariant()
            .map_or(&[][..], |invariant| &invariant.right);
        if known.len() == self.quasi_velocities() && known.iter().all(Option::is_some) {
            return known
                .iter()
                .flatten()
                .map(|&entry| self.value(entry))
                .collect();
        }
        let free = self.force_without_drift();
        let acceleration = self.frame_acceleration();
        let inertial = self.lower_vector(&acceleration);
        let rest: Vec<Value> = free
            .iter()
            .zip(&inertial)
            .map(|(&f, &b)| self.builder.sub(f, b))
            .collect();
        let mut right = self.restrict(&rest);
        for (entry, &known) in right.iter_mut().zip(known) {
            if let Some(known) = known {
                *entry = self.value(known);
            }
        }
        right
    }

    /// `g(qdot, qdot)`, if it has a simplified expression.
    pub fn known_doubled_kinetic(&mut self) -> Option<Value> {
        let known = self.invariant()?.doubled_kinetic?;
        let u = self.quasi_inputs();
        self.bind_quasi(&u);
        Some(self.value(known))
    }

    /// `det g / |det (alpha, eta)|`, the density of `mu_C` in positions and quasi-velocities.
    pub fn density_in_frame(&mut self) -> Value {
        let pivots = self.with_ldlt(|_, ldlt| ldlt.pivots.clone());
        let mut density = self.builder.integer(1);
        for pivot in pivots {
            density = self.builder.mul(density, pivot);
        }
        let blocks = self.frame().map_or(&[][..], |frame| &frame.blocks);
        for block in blocks {
            let size = self.block_determinant(block);
            density = self.builder.div(density, size);
        }
        density
    }

    /// The solution of `G_D u = X^T (b - g X_0)`: quasi-velocities of the velocity on D that is nearest to `g^{-1} b`.
    pub fn nearest_quasi(&mut self, b: &[Value]) -> Vec<Value> {
        let affine = self.affine_field();
        let shift = self.lower_vector(&affine);
        let rest: Vec<Value> = b
            .iter()
            .zip(&shift)
            .map(|(&b, &shift)| self.builder.sub(b, shift))
            .collect();
        let right = self.restrict(&rest);
        self.raise_reduced(&right)
    }
}
