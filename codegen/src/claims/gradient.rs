//! Gradient of the logarithm of a density without closed form, as a list of arithmetic steps: the covector `beta` with
//! `beta(Z) = c` for elements `(Z, c)` of the hull whose vectors span the tangent space. The line integrals of `beta`
//! are the logarithm of the density.

use std::cell::RefCell;

use dalembert_expr::Pool;

use super::exactness::{Local, sample_points};
use super::obstruction::elements_at;
use super::problem::Problem;
use super::sample::{ATTEMPTS, sample};
use super::trace::{Step, Trace, TracedPoint};
use crate::model::Model;

/// The linear system for the gradient, valid at almost all points.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Gradient {
    /// Computation of its entries from the position.
    pub trace: Trace,
    /// N vectors that span the tangent space, N components each.
    pub vectors: Vec<Vec<Step>>,
    /// The product of the gradient with each vector.
    pub demands: Vec<Step>,
}

/// The integral of a gradient along straight lines from one configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct Integral {
    /// The gradient.
    pub gradient: Gradient,
    /// Start of the line, N coordinates: a regular configuration.
    pub reference: Vec<f64>,
}

/// Number of steps beyond which gradients are not emitted.
const STEPS: usize = 20_000;

impl Integral {
    /// The logarithm of a density that exists; `None` if it is not unique, depends on time, or is too large.
    pub(super) fn of(model: &Model, problem: &Problem, local: &Local, seed: u64) -> Option<Self> {
        let gradient = gradient(&model.pool, problem, local, seed)?;
        let reference = (0..ATTEMPTS).find_map(|attempt| {
            let sample = sample(model, attempt, |_| true);
            let is_regular = {
                let mut point = sample.point();
                let (hull, dependent) = (&local.hull, Some(local.dependent()));
                elements_at(&model.pool, problem, hull, dependent, &mut point).is_some()
            };
            let values = model
                .coordinates
                .iter()
                .map(|coordinate| sample.value(coordinate.q));
            is_regular.then(|| values.collect::<Option<Vec<f64>>>())?
        })?;
        (gradient.trace.operations.len() <= STEPS).then_some(Self {
            gradient,
            reference,
        })
    }
}

/// The gradient of the logarithm of a density that exists; `None` if it is not unique, or depends on time.
pub(super) fn gradient(
    pool: &Pool,
    problem: &Problem,
    local: &Local,
    seed: u64,
) -> Option<Gradient> {
    let n = problem.coordinates;
    if !local.exists || local.rank != n || problem.is_time_dependent() {
        return None;
    }
    let roots = problem.roots();
    let mut points = sample_points(pool, &roots, &pool.profile_of(&roots), seed).ok()?;
    let trace = RefCell::new(Trace::default());
    let (hull, dependent) = (&local.hull, local.dependent());
    let elements = points.find(pool, |point| {
        let mut traced = TracedPoint::new(point.clone(), &trace);
        elements_at(pool, problem, hull, Some(dependent), &mut traced)
    })?;
    let spanning: Vec<_> = hull
        .basis
        .iter()
        .map(|element| &elements[*element])
        .collect();
    Some(Gradient {
        vectors: spanning.iter().map(|vector| vector[..n].to_vec()).collect(),
        demands: spanning.iter().map(|vector| vector[n]).collect(),
        trace: trace.into_inner(),
    })
}
