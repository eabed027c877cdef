//! Functions of all derived quantities at a state, by name: for tables, tests and the command `eval`.
//!
//! The formulas of density form and divergence are in [`crate::mechanics::density`].

pub use dalembert_numbers::kernel::Shape;

use crate::claims::Volume;
use crate::mechanics::{Derivation, Entry};
use crate::model::Model;
use crate::program::kernel::{Arguments, Kernel};
use crate::program::recipes::{impact, instantaneous, motion, volume};
use crate::program::{Form, Function, Value};

/// A named group of results: a number, vector or matrix.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// Name in the output of `eval`.
    pub name: String,
    /// Shape.
    pub shape: Shape,
}

/// A function whose results are concatenated groups.
#[derive(Debug)]
pub struct Geometry {
    /// The function. Its results are those of the groups in order.
    pub function: Function,
    /// Name and shape of each group.
    pub groups: Vec<Group>,
}

/// Results under construction.
struct Results {
    groups: Vec<Group>,
    values: Vec<Value>,
}

impl Results {
    fn scalar(&mut self, name: impl Into<String>, value: Value) {
        self.push(name.into(), Shape::Scalar, vec![value]);
    }

    fn vector(&mut self, name: impl Into<String>, values: Vec<Value>) {
        self.push(name.into(), Shape::Vector(values.len()), values);
    }

    fn matrix(&mut self, name: &str, rows: Vec<Vec<Value>>, columns: usize) {
        self.push(
            name.into(),
            Shape::Matrix(rows.len(), columns),
            rows.concat(),
        );
    }

    fn push(&mut self, name: String, shape: Shape, values: Vec<Value>) {
        self.groups.push(Group { name, shape });
        self.values.extend(values);
    }
}

/// All derived quantities as a function of `(t, q, p)`.
pub fn geometry(model: &Model, derivation: &Derivation, found: Option<&Volume>) -> Geometry {
    let mut kernel = Kernel::new(model, derivation, Arguments::Both).without_surface_guards();
    let mut results = Results {
        groups: Vec::new(),
        values: Vec::new(),
    };
    report_motion(&mut kernel, &mut results);
    report_constraints(&mut kernel, &mut results);
    // An integral is not straight-line code, so it is reported separately.
    if let Some(found) = found.filter(|volume| volume.integral.is_none()) {
        let density = volume::log_density(&mut kernel, found);
        results.scalar("log_density", density);
    }
    report_surfaces(&mut kernel, &mut results);
    Geometry {
        function: kernel.finish(results.values),
        groups: results.groups,
    }
}

/// Rates and surface quantities of a first-order system, as a function of `(t, q)`.
pub fn first_order_geometry(model: &Model, derivation: &Derivation) -> Geometry {
    let mut kernel = Kernel::new(model, derivation, Arguments::Position);
    let mut results = Results {
        groups: Vec::new(),
        values: Vec::new(),
    };
    let rates = kernel.velocity();
    results.vector("qdot", rates);
    for s in 0..derivation.surfaces.len() {
        let name = &model.surfaces[s].name.display;
        let surface = &derivation.surfaces[s];
        let [gap, rate] =
            [surface.gap, surface.gap_rate].map(|expression| kernel.value(expression));
        results.scalar(format!("impacts.{name}.gap"), gap);
        results.scalar(format!("impacts.{name}.gap_rate"), rate);
        report_reset(&mut kernel, &mut results, s);
    }
    Geometry {
        function: kernel.finish(results.values),
        groups: results.groups,
    }
}

/// Quantities derived on D, as a function of `(t, q, u)`.
pub fn reduced_geometry(model: &Model, derivation: &Derivation) -> Geometry {
    let mut kernel = Kernel::new(model, derivation, Arguments::Quasi);
    let mut results = Results {
        groups: Vec::new(),
        values: Vec::new(),
    };
    let n = kernel.dimension();
    let quasi = kernel.quasi_inputs();
    let size = quasi.len();
    results.vector("u", quasi);
    let rate = kernel.quasi_rate();
    results.vector("udot", rate);
    let affine = kernel.affine_field();
    results.vector("X_0", affine);
    let fields = kernel.frame_fields();
    results.matrix("X", fields, n);
    let lower = kernel.reduced_metric();
    let entry = |i: usize, j: usize| lower[i.max(j)][i.min(j)];
    let rows = (0..size)
        .map(|i| (0..size).map(|j| entry(i, j)).collect())
        .collect();
    results.matrix("G_D", rows, size);
    if model.extras.volume {
        let density = kernel.density_in_frame();
        results.scalar("mu_C_density_frame", density);
    }
    Geometry {
        function: kernel.finish(results.values),
        groups: results.groups,
    }
}

fn report_motion(kernel: &mut Kernel<'_>, results: &mut Results) {
    let qdot = kernel.velocity();
    results.vector("qdot", qdot);
    let rate = motion::momentum_rate(kernel);
    let drift = kernel.drift();
    let inertial: Vec<Value> = rate
        .iter()
        .zip(drift)
        .map(|(&rate, d)| kernel.builder.sub(rate, d))
        .collect();
    results.vector("pdot", rate);
    let acceleration = kernel.raise(&inertial);
    results.vector("acceleration", acceleration);
    let multipliers = if kernel.constraints() > 0 {
        kernel.multipliers()
    } else {
        Vec::new()
    };
    results.vector("multipliers", multipliers);
    let energy = motion::energy_value(kernel);
    results.scalar("energy", energy);
    let n = kernel.dimension();
    let model = kernel.model;
    let rows = model
        .lagrangian
        .metric
        .iter()
        .map(|row| kernel.values(row))
        .collect();
    results.matrix("metric", rows, n);
}

fn report_constraints(kernel: &mut Kernel<'_>, results: &mut Results) {
    let (n, m) = (kernel.dimension(), kernel.constraints());
    let frame = DualFrame::of(kernel);
    results.matrix("W", frame.dual_fields.clone(), n);
    let mass = frame.mass(kernel);
    results.matrix("constraint_mass", mass, m);
    results.matrix("constraint_mass_inverse", frame.inverse_mass.clone(), m);
    let projector = frame.projector(kernel);
    results.matrix("pi_D", projector, n);
    if !kernel.model.extras.volume {
        return;
    }
    let theta = frame.density_form(kernel);
    let divergence = frame.divergence(kernel, &theta);
    results.vector("density_form_theta", theta);
    results.scalar("divergence_mu_C", divergence);
}

fn report_surfaces(kernel: &mut Kernel<'_>, results: &mut Results) {
    for s in 0..kernel.derivation.surfaces.len() {
        let name = &kernel.model.surfaces[s].name.display;
        let gap = kernel.value(kernel.derivation.surfaces[s].gap);
        results.scalar(format!("impacts.{name}.gap"), gap);
        if kernel.model.is_nonlinear() {
            let rate = kernel.value(kernel.derivation.surfaces[s].gap_rate);
            results.scalar(format!("impacts.{name}.gap_rate"), rate);
            report_reset(kernel, results, s);
            continue;
        }
        let contact = impact::contact_values(kernel, s);
        for (quantity, value) in impact::SCALARS.iter().zip(contact.scalars) {
            results.scalar(format!("impacts.{name}.{quantity}"), value);
        }
        results.vector(format!("impacts.{name}.direction"), contact.direction);
        if let Some(impulse) = instantaneous::focus_values(kernel, Form::Global, s) {
            results.vector(format!("impacts.{name}.focus"), impulse);
        }
        report_reset(kernel, results, s);
    }
}

fn report_reset(kernel: &mut Kernel<'_>, results: &mut Results, s: usize) {
    let name = &kernel.model.surfaces[s].name.display;
    if let Some([q, qdot]) = impact::reset_values(kernel, s) {
        results.vector(format!("impacts.{name}.reset_q"), q);
        results.vector(format!("impacts.{name}.reset_qdot"), qdot);
    }
}

/// `(t, q, p) -> div`, or `(t, q, u) -> div`
pub fn divergence(model: &Model, derivation: &Derivation, form: Form) -> Function {
    let mut kernel = Kernel::new(model, derivation, form.state());
    let frame = DualFrame::of(&mut kernel);
    let theta = frame.density_form(&mut kernel);
    let divergence = frame.divergence(&mut kernel, &theta);
    kernel.finish(vec![divergence])
}

/// `(t, q) -> theta`
pub fn density_form(model: &Model, derivation: &Derivation) -> Function {
    let mut kernel = Kernel::new(model, derivation, Arguments::Position);
    let frame = DualFrame::of(&mut kernel);
    let theta = frame.density_form(&mut kernel);
    kernel.finish(theta)
}

/// `eta^a`, `W^a` and `m_ab` at a position.
struct DualFrame {
    forms: Vec<Vec<Value>>,
    dual_fields: Vec<Vec<Value>>,
    inverse_mass: Vec<Vec<Value>>,
}

impl DualFrame {
    fn of(kernel: &mut Kernel<'_>) -> Self {
        let forms = kernel.forms();
        let dual_fields = forms.iter().map(|form| kernel.raise(form)).collect();
        let inverse_mass = match forms.is_empty() {
            true => Vec::new(),
            false => kernel.with_constraints(|builder, _, factors| factors.inverse_mass(builder)),
        };
        Self {
            forms,
            dual_fields,
            inverse_mass,
        }
    }

    /// `m^{ab} = eta^a(W^b)`
    fn mass(&self, kernel: &mut Kernel<'_>) -> Vec<Vec<Value>> {
        let entry = |kernel: &mut Kernel<'_>, a: &Vec<Value>, b: &Vec<Value>| kernel.dot(a, b);
        self.forms
            .iter()
            .map(|a| {
                self.dual_fields
                    .iter()
                    .map(|b| entry(kernel, a, b))
                    .collect()
            })
            .collect()
    }

    /// `m_ab W^b`, M rows of N.
    fn inverse_fields(&self, kernel: &mut Kernel<'_>) -> Vec<Vec<Value>> {
        let n = kernel.dimension();
        self.inverse_mass
            .iter()
            .map(|row| {
                let mut total = vec![kernel.builder.zero(); n];
                for (&weight, field) in row.iter().zip(&self.dual_fields) {
                    for (entry, &component) in total.iter_mut().zip(field) {
                        *entry = kernel.builder.add_product(*entry, weight, component);
                    }
                }
                total
            })
            .collect()
    }

    /// `pi_D = 1 - W^a m_ab eta^b`, on velocities.
    fn projector(&self, kernel: &mut Kernel<'_>) -> Vec<Vec<Value>> {
        let n = kernel.dimension();
        let inverse_fields = self.inverse_fields(kernel);
        let mut rows = Vec::with_capacity(n);
        for i in 0..n {
            let mut row: Vec<Value> = (0..n)
                .map(|j| kernel.builder.integer(i64::from(i == j)))
                .collect();
            for (form, field) in self.forms.iter().zip(&inverse_fields) {
                for (entry, &component) in row.iter_mut().zip(form) {
                    *entry = kernel.builder.sub_product(*entry, field[i], component);
                }
            }
            rows.push(row);
        }
        rows
    }

    /// `theta_k = m_ab [ W^{a,j} d_j eta^b_k + W^{b,j} d_k eta^a_j - W^b.(d_k g) W^a ]`
    fn density_form(&self, kernel: &mut Kernel<'_>) -> Vec<Value> {
        let derivation = kernel.derivation;
        let inverse_fields = self.inverse_fields(kernel);
        let mut theta = vec![kernel.builder.zero(); kernel.dimension()];
        for (a, field) in inverse_fields.iter().enumerate() {
            for &Entry {
                index: [j, k],
                value,
            } in &derivation.constraints[a].form_gradient
            {
                let value = kernel.value(value);
                theta[j] = kernel.builder.add_product(theta[j], field[k], value);
                theta[k] = kernel.builder.add_product(theta[k], field[j], value);
            }
        }
        for &Entry {
            index: [i, j, k],
            value,
        } in &derivation.density.metric.by_coordinate
        {
            let value = kernel.value(value);
            let weight = self.cometric_part(kernel, &inverse_fields, i, j);
            theta[k] = kernel.builder.sub_product(theta[k], weight, value);
        }
        theta
    }

    /// `m_ab W^{a,i} W^{b,j}`, doubled for `i != j`, because an entry of the metric stands for both orders of its
    /// indices.
    fn cometric_part(
        &self,
        kernel: &mut Kernel<'_>,
        inverse_fields: &[Vec<Value>],
        i: usize,
        j: usize,
    ) -> Value {
        let mut weight = kernel.builder.zero();
        for (field, inverse) in self.dual_fields.iter().zip(inverse_fields) {
            weight = kernel.builder.add_product(weight, field[i], inverse[j]);
        }
        let multiplicity = kernel.builder.integer(if i == j { 1 } else { 2 });
        kernel.builder.mul(multiplicity, weight)
    }

    fn divergence(&self, kernel: &mut Kernel<'_>, theta: &[Value]) -> Value {
        let qdot = kernel.velocity();
        let along = kernel.dot(theta, &qdot);
        let mut total = kernel.builder.neg(along);
        total = self.add_constraint_terms(kernel, total);
        self.add_force_terms(kernel, total)
    }

    /// `- m_ab W^b(eta_0^a) - m_ab (d_t eta^a)(W^b) + m_ab (d_t g)(W^a, W^b)`
    fn add_constraint_terms(&self, kernel: &mut Kernel<'_>, mut total: Value) -> Value {
        let derivation = kernel.derivation;
        let inverse_fields = self.inverse_fields(kernel);
        for (constraint, field) in derivation.constraints.iter().zip(&inverse_fields) {
            for &Entry { index: [k], value } in constraint
                .affine_gradient
                .iter()
                .chain(&constraint.form_rate)
            {
                let value = kernel.value(value);
                total = kernel.builder.sub_product(total, field[k], value);
            }
        }
        for &Entry {
            index: [i, j],
            value,
        } in &derivation.density.metric.by_time
        {
            let value = kernel.value(value);
            let weight = self.cometric_part(kernel, &inverse_fields, i, j);
            total = kernel.builder.add_product(total, weight, value);
        }
        total
    }

    /// `tr(dF/dqdot . pi_D g^{-1})` with `pi_D g^{-1} = g^{-1} - m_ab W^a W^b`.
    fn add_force_terms(&self, kernel: &mut Kernel<'_>, mut total: Value) -> Value {
        let derivation = kernel.derivation;
        let inverse_fields = self.inverse_fields(kernel);
        for &Entry {
            index: [i, j],
            value,
        } in &derivation.density.force_velocity
        {
            let value = kernel.value(value);
            let unit: Vec<Value> = (0..kernel.dimension())
                .map(|k| kernel.builder.integer(i64::from(k == i)))
                .collect();
            let column = kernel.raise(&unit);
            let mut weight = column[j];
            for (field, inverse) in self.dual_fields.iter().zip(&inverse_fields) {
                weight = kernel.builder.sub_product(weight, field[i], inverse[j]);
            }
            total = kernel.builder.add_product(total, weight, value);
        }
        total
    }
}
