//! The metric as operations along a linkage: factorisation, products, forces. The formulas are in [`crate::mechanics::linkage`].

use std::collections::BTreeMap;

use dalembert_expr::Rational;

use super::builder::Builder;
use super::kernel::Kernel;
use super::linear::Ldlt;
use super::{Guard, Value};
use crate::mechanics::linkage::{Coefficient, Derived, Linkage, Part};

/// The steps of an elimination. Vectors of the steps have an entry for each velocity and each derived velocity.
#[derive(Debug)]
pub struct Elimination {
    /// Number of velocities, N.
    velocities: usize,
    /// Number of velocities and derived velocities.
    parts: usize,
    steps: Vec<Step>,
}

/// A step of an elimination.
#[derive(Debug)]
struct Step {
    /// The velocity or derived velocity that is eliminated.
    part: Part,
    /// The definition of a derived velocity, or the entries of the column of `L` of a velocity.
    beside: Vec<(Part, Value)>,
}

impl Elimination {
    /// `L^{-1} b`
    pub fn forward(&self, builder: &mut Builder, b: &[Value]) -> Vec<Value> {
        let mut carried = self.extended(builder, b);
        for step in &self.steps {
            step.carry(
                builder,
                step.part < self.velocities,
                carried[step.part],
                &mut carried,
            );
        }
        carried.truncate(self.velocities);
        carried
    }

    /// `L y`
    pub fn lower_times(&self, builder: &mut Builder, y: &[Value]) -> Vec<Value> {
        let mut carried = self.extended(builder, &[]);
        let mut product = y.to_vec();
        for step in &self.steps {
            let part = step.part;
            if part < self.velocities {
                product[part] = builder.sub(y[part], carried[part]);
                step.carry(builder, true, y[part], &mut carried);
            } else {
                step.carry(builder, false, carried[part], &mut carried);
            }
        }
        product
    }

    /// `L^{-T} z`
    pub fn backward(&self, builder: &mut Builder, z: &[Value]) -> Vec<Value> {
        let mut x = self.extended(builder, z);
        for step in self.steps.iter().rev() {
            let mut entry = x[step.part];
            for &(part, factor) in &step.beside {
                entry = match step.part < self.velocities {
                    true => builder.sub_product(entry, factor, x[part]),
                    false => builder.add_product(entry, factor, x[part]),
                };
            }
            x[step.part] = entry;
        }
        x.truncate(self.velocities);
        x
    }

    /// The vector with zeros for the derived velocities.
    fn extended(&self, builder: &mut Builder, b: &[Value]) -> Vec<Value> {
        let mut extended = b.to_vec();
        extended.resize(self.parts, builder.zero());
        extended
    }
}

impl Step {
    /// Hands the entry `value` of a right-hand side on to the parts that are eliminated later.
    fn carry(&self, builder: &mut Builder, is_velocity: bool, value: Value, carried: &mut [Value]) {
        for &(part, factor) in &self.beside {
            carried[part] = match is_velocity {
                true => builder.sub_product(carried[part], factor, value),
                false => builder.add_product(carried[part], factor, value),
            };
        }
    }
}

/// A quadratic form in velocities and derived velocities: entries `(a, b)` with `a <= b` of its matrix.
#[derive(Default)]
struct Quadratic(BTreeMap<(Part, Part), Value>);

impl Quadratic {
    fn add(&mut self, builder: &mut Builder, a: Part, b: Part, value: Value) {
        let entry = self.0.entry((a.min(b), a.max(b)));
        let entry = entry.or_insert_with(|| builder.zero());
        *entry = builder.add(*entry, value);
    }

    /// Takes out the diagonal entry of a part, and its other entries.
    fn take(&mut self, builder: &mut Builder, part: Part) -> (Value, Vec<(Part, Value)>) {
        let diagonal = self.0.remove(&(part, part));
        let diagonal = diagonal.unwrap_or_else(|| builder.zero());
        let (mut beside, mut rest) = (Vec::new(), BTreeMap::new());
        for ((a, b), value) in std::mem::take(&mut self.0) {
            match (a == part, b == part) {
                (true, _) => beside.push((b, value)),
                (_, true) => beside.push((a, value)),
                _ => drop(rest.insert((a, b), value)),
            }
        }
        self.0 = rest;
        (diagonal, beside)
    }

    /// Replaces a derived velocity `x = sum_p a_p x_p` by its definition. With the diagonal entry `alpha` and the other entries
    /// `beta_p` of x, the entry (p, r) grows by `alpha a_p a_r + a_p beta_r + a_r beta_p`.
    fn substitute(&mut self, builder: &mut Builder, part: Part, definition: &[(Part, Value)]) {
        let (diagonal, beside) = self.take(builder, part);
        let entries: BTreeMap<Part, Value> = beside.iter().copied().collect();
        let zero = builder.zero();
        for (place, &(a, factor)) in definition.iter().enumerate() {
            let coupling = entries.get(&a).copied().unwrap_or(zero);
            let whole = builder.add_product(coupling, diagonal, factor);
            let doubled = builder.add(whole, coupling);
            let product = builder.mul(factor, doubled);
            self.add(builder, a, a, product);
            for &(b, other) in &definition[place + 1..] {
                let product = builder.mul(other, whole);
                self.add(builder, a, b, product);
                let entry = entries.get(&b).copied().unwrap_or(zero);
                let product = builder.mul(factor, entry);
                self.add(builder, a, b, product);
            }
            for &(b, entry) in &beside {
                if !definition.iter().any(|(part, _)| *part == b) {
                    let product = builder.mul(factor, entry);
                    self.add(builder, a, b, product);
                }
            }
        }
    }

    /// Eliminates a velocity. Gives its pivot and its column of `L`.
    fn eliminate(&mut self, builder: &mut Builder, part: Part) -> (Value, Vec<(Part, Value)>) {
        let (pivot, beside) = self.take(builder, part);
        let inverse = builder.reciprocal(pivot);
        let column: Vec<(Part, Value)> = beside
            .iter()
            .map(|&(a, entry)| (a, builder.mul(entry, inverse)))
            .collect();
        for (place, &(a, factor)) in column.iter().enumerate() {
            for &(b, entry) in &beside[place..] {
                let product = builder.mul(factor, entry);
                let product = builder.neg(product);
                self.add(builder, a, b, product);
            }
        }
        (pivot, column)
    }
}

impl Kernel<'_> {
    /// Binds the symbols of the positions of derived velocities.
    pub(super) fn bind_positions(&mut self, linkage: &Linkage) {
        let mut positions = Vec::with_capacity(self.dimension() + linkage.derived.len());
        for coordinate in &self.model.coordinates {
            positions.push(Some(self.symbol(coordinate.q)));
        }
        for derived in &linkage.derived {
            let value = derived.position.and_then(|symbol| {
                let mut total = self.builder.zero();
                for term in &derived.terms {
                    let factor = self.value(term.factor.value);
                    total = self
                        .builder
                        .add_product(total, factor, positions[term.part]?);
                }
                self.bind_value(symbol, total);
                Some(total)
            });
            positions.push(value);
        }
    }

    /// The factorisation of the metric, in the order of the linkage. The operations of `L^{-1} b` stand between those of the steps,
    /// because a processor then carries out both sequences at once.
    pub(super) fn eliminate_along(&mut self, linkage: &Linkage, b: &[Value]) -> Ldlt {
        let n = self.dimension();
        let mut carried = b.to_vec();
        carried.resize(n + linkage.derived.len(), self.builder.zero());
        let mut form = Quadratic::default();
        for square in &linkage.squares {
            let weight = self.value(square.weight.value);
            form.add(&mut self.builder, square.part, square.part, weight);
        }
        let mut pivots = vec![self.builder.zero(); n];
        let mut steps = Vec::with_capacity(linkage.order.len());
        for &part in &linkage.order {
            let beside = match part.checked_sub(n) {
                Some(w) => {
                    let definition = self.definition(&linkage.derived[w]);
                    form.substitute(&mut self.builder, part, &definition);
                    definition
                }
                None => {
                    let (pivot, column) = form.eliminate(&mut self.builder, part);
                    self.builder.guard(Guard::Pivot {
                        pivot: part,
                        value: pivot,
                    });
                    pivots[part] = pivot;
                    column
                }
            };
            let step = Step { part, beside };
            step.carry(&mut self.builder, part < n, carried[part], &mut carried);
            steps.push(step);
        }
        let elimination = Elimination {
            velocities: n,
            parts: n + linkage.derived.len(),
            steps,
        };
        Ldlt::of_elimination(&mut self.builder, elimination, pivots)
    }

    /// The definition of a derived velocity.
    fn definition(&mut self, derived: &Derived) -> Vec<(Part, Value)> {
        let terms = derived.terms.iter();
        terms
            .map(|term| (term.part, self.value(term.factor.value)))
            .collect()
    }

    /// The definitions of all derived velocities.
    fn definitions(&mut self, linkage: &Linkage) -> Vec<Vec<(Part, Value)>> {
        let derived = linkage.derived.iter();
        derived.map(|derived| self.definition(derived)).collect()
    }

    /// Velocities `v`, then the derived velocities.
    fn all_velocities_of(&mut self, linkage: &Linkage, v: &[Value]) -> Vec<Value> {
        let mut x = v.to_vec();
        for terms in self.definitions(linkage) {
            let mut total = self.builder.zero();
            for (part, factor) in terms {
                total = self.builder.add_product(total, factor, x[part]);
            }
            x.push(total);
        }
        x
    }

    /// `y`, for velocities and derived velocities `x`.
    fn adjoint(&mut self, linkage: &Linkage, x: &[Value]) -> Vec<Value> {
        let n = self.dimension();
        let mut y = vec![self.builder.zero(); x.len()];
        for square in &linkage.squares {
            let weight = self.value(square.weight.value);
            y[square.part] = self.builder.mul(weight, x[square.part]);
        }
        for (w, terms) in self.definitions(linkage).into_iter().enumerate().rev() {
            for (part, factor) in terms {
                y[part] = self.builder.add_product(y[part], factor, y[n + w]);
            }
        }
        y
    }

    /// `g v`
    pub(super) fn lower_along(&mut self, linkage: &Linkage, v: &[Value]) -> Vec<Value> {
        let x = self.all_velocities_of(linkage, v);
        let mut y = self.adjoint(linkage, &x);
        y.truncate(v.len());
        y
    }

    /// `dL/dq + F`
    pub(super) fn force_along(&mut self, linkage: &Linkage) -> Vec<Value> {
        let n = self.dimension();
        let qdot = self.velocity();
        let x = self.all_velocities_of(linkage, &qdot);
        let y = self.adjoint(linkage, &x);
        // `sum_w y_w d_k a_wp` by k and p: a velocity multiplies the sum of what it multiplies.
        let mut by_velocity: BTreeMap<(Part, Part), Value> = BTreeMap::new();
        for (w, derived) in linkage.derived.iter().enumerate() {
            for term in &derived.terms {
                self.add_gradient(&mut by_velocity, term.part, y[n + w], &term.factor);
            }
        }
        let half = self.builder.number(Rational::HALF);
        for square in &linkage.squares {
            if !square.weight.gradient.is_empty() {
                let weight = self.builder.mul(half, x[square.part]);
                self.add_gradient(&mut by_velocity, square.part, weight, &square.weight);
            }
        }
        let mut force = self.values(&linkage.force);
        force.resize(x.len(), self.builder.zero());
        for &(k, derivative) in &linkage.gradient {
            let derivative = self.value(derivative);
            force[k] = self.builder.add(force[k], derivative);
        }
        for ((k, part), factor) in by_velocity {
            force[k] = self.builder.add_product(force[k], factor, x[part]);
        }
        let definitions = self.definitions(linkage);
        for (w, derived) in linkage.derived.iter().enumerate().rev() {
            if derived.position.is_some() {
                for &(part, factor) in &definitions[w] {
                    force[part] = self.builder.add_product(force[part], factor, force[n + w]);
                }
            }
        }
        force.truncate(n);
        force
    }

    fn add_gradient(
        &mut self,
        by_velocity: &mut BTreeMap<(Part, Part), Value>,
        part: Part,
        weight: Value,
        coefficient: &Coefficient,
    ) {
        for &(k, derivative) in &coefficient.gradient {
            let derivative = self.value(derivative);
            let zero = self.builder.zero();
            let sum = by_velocity.entry((k, part)).or_insert(zero);
            *sum = self.builder.add_product(*sum, derivative, weight);
        }
    }

    /// The derivative of a coefficient along the motion.
    fn rate_along(&mut self, coefficient: &Coefficient, x: &[Value]) -> Value {
        let mut rate = self.value(coefficient.by_time);
        for &(k, derivative) in &coefficient.gradient {
            let derivative = self.value(derivative);
            rate = self.builder.add_product(rate, derivative, x[k]);
        }
        rate
    }

    /// `gdot qdot + Adot`
    pub(super) fn drift_along(&mut self, linkage: &Linkage) -> Vec<Value> {
        let n = self.dimension();
        let qdot = self.velocity();
        let x = self.all_velocities_of(linkage, &qdot);
        let y = self.adjoint(linkage, &x);
        let definitions = self.definitions(linkage);
        let mut rates: Vec<Vec<Value>> = Vec::with_capacity(definitions.len());
        // The derivatives of `x` by time at fixed velocities.
        let mut moved = vec![self.builder.zero(); n];
        for (derived, definition) in linkage.derived.iter().zip(&definitions) {
            let terms = derived.terms.iter();
            let along = terms
                .map(|term| self.rate_along(&term.factor, &x))
                .collect::<Vec<_>>();
            let mut total = self.builder.zero();
            for (&(part, factor), &rate) in definition.iter().zip(&along) {
                total = self.builder.add_product(total, rate, x[part]);
                total = self.builder.add_product(total, factor, moved[part]);
            }
            moved.push(total);
            rates.push(along);
        }
        // The derivatives of `y`.
        let mut drift = vec![self.builder.zero(); x.len()];
        for square in &linkage.squares {
            let weight = self.value(square.weight.value);
            let rate = self.rate_along(&square.weight, &x);
            let steady = self.builder.mul(weight, moved[square.part]);
            drift[square.part] = self.builder.add_product(steady, rate, x[square.part]);
        }
        for (w, (definition, rates)) in definitions.iter().zip(&rates).enumerate().rev() {
            for (&(part, factor), &rate) in definition.iter().zip(rates) {
                drift[part] = self.builder.add_product(drift[part], rate, y[n + w]);
                drift[part] = self.builder.add_product(drift[part], factor, drift[n + w]);
            }
        }
        let rest = self.values(&linkage.drift);
        let pairs = drift.iter().zip(rest);
        pairs
            .map(|(&kinetic, rest)| self.builder.add(kinetic, rest))
            .collect()
    }
}
