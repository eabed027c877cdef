//! Functions of the invariant volume `exp(G) mu_C = exp(G) det g / |det A_dep| dq dv_ind`.
//!
//! Logarithms of determinants are sums of logarithms over a factorisation. The terms of `ln det g` are the logarithms
//! of the pivots of `L D L^T`. The terms of `ln det m^{ab}` are the logarithms of the squared norms of the
//! orthogonalised constraint columns.

use dalembert_expr::{ExprId, Function as Elementary, Rational};

use super::gradient::gradient;
use crate::claims::{Term, Volume};
use crate::mechanics::Derivation;
use crate::model::Model;
use crate::program::kernel::{Arguments, Kernel};
use crate::program::linear::{Ldlt, Orthogonal};
use crate::program::{Guard, InvariantVolume, Value};

/// All functions of an invariant volume.
pub fn invariant_volume(
    model: &Model,
    derivation: &Derivation,
    volume: &Volume,
) -> InvariantVolume {
    let mut kernel = Kernel::new(model, derivation, Arguments::Position);
    let density = log_density(&mut kernel, volume);
    let log_density = kernel.finish(vec![density]);
    let mut kernel = Kernel::new(model, derivation, Arguments::Position);
    let total = log_volume(&mut kernel, volume);
    InvariantVolume {
        log_density,
        log_volume: kernel.finish(vec![total]),
        gradient: volume.integral.as_ref().map(|integral| {
            (
                integral.reference.clone(),
                gradient(model, derivation, integral),
            )
        }),
        independent: (0..model.coordinates.len())
            .filter(|i| !volume.dependent.contains(i))
            .collect(),
        is_single_valued: volume.is_single_valued,
    }
}

/// `G`, without the part that is an integral.
pub(super) fn log_density(kernel: &mut Kernel<'_>, volume: &Volume) -> Value {
    let mut total = kernel.builder.zero();
    for &(coefficient, term) in &volume.potential.terms {
        let coefficient = kernel.value(coefficient);
        let term = term_value(kernel, term, &volume.minor);
        total = kernel.builder.add_product(total, coefficient, term);
    }
    kernel.builder.name(total, "log_density");
    total
}

/// `G + ln det g - ln |det A_dep|`
fn log_volume(kernel: &mut Kernel<'_>, volume: &Volume) -> Value {
    let density = log_density(kernel, volume);
    let metric = log_metric_determinant(kernel);
    let minor = log_minor(kernel, &volume.dependent);
    let total = kernel.builder.add(density, metric);
    kernel.builder.sub(total, minor)
}

fn term_value(kernel: &mut Kernel<'_>, term: Term, minor: &[usize]) -> Value {
    match term {
        Term::MassDeterminant => {
            let squares = kernel.with_constraints(|_, _, factors| factors.squares().to_vec());
            sum_of_logarithms(kernel, &squares)
        }
        Term::MetricDeterminant => log_metric_determinant(kernel),
        Term::DependentDeterminant => log_minor(kernel, minor),
        Term::Logarithm(f) => log_magnitude(kernel, f),
        Term::Plain(f) => kernel.value(f),
    }
}

/// `ln det g`
fn log_metric_determinant(kernel: &mut Kernel<'_>) -> Value {
    let pivots = kernel.with_ldlt(|_, ldlt| ldlt.pivots.clone());
    sum_of_logarithms(kernel, &pivots)
}

/// `ln |f|`
fn log_magnitude(kernel: &mut Kernel<'_>, f: ExprId) -> Value {
    let is_nonnegative = kernel.model.pool.sign(f).is_nonnegative();
    let value = kernel.value(f);
    if kernel.builder.as_number(value) == Some(&Rational::from(-1)) {
        return kernel.builder.zero();
    }
    let magnitude = match is_nonnegative {
        true => value,
        false => kernel.builder.call(Elementary::Abs, value),
    };
    sum_of_logarithms(kernel, &[magnitude])
}

fn sum_of_logarithms(kernel: &mut Kernel<'_>, factors: &[Value]) -> Value {
    let mut total = kernel.builder.zero();
    for &factor in factors {
        if kernel.builder.as_number(factor) != Some(&Rational::ONE) {
            let logarithm = kernel.builder.call(Elementary::Ln, factor);
            total = kernel.builder.add(total, logarithm);
        }
    }
    total
}

/// `ln |det A|` for the columns `columns` of the constraint forms.
///
/// An entry that is the only one of its row or column is a factor of the determinant. The remaining matrix is
/// orthogonalised, because no choice of pivots is good at every state. The product of the norms is the absolute value
/// of its determinant.
fn log_minor(kernel: &mut Kernel<'_>, columns: &[usize]) -> Value {
    let mut rows: Vec<usize> = (0..kernel.constraints()).collect();
    let mut columns = columns.to_vec();
    let mut total = kernel.builder.zero();
    while let Some((a, j)) = lone_entry(kernel, &rows, &columns) {
        rows.retain(|row| *row != a);
        columns.retain(|column| *column != j);
        let logarithm = log_entry(kernel, a, j);
        total = kernel.builder.add(total, logarithm);
    }
    if rows.is_empty() {
        return total;
    }
    let squares = squared_norms(kernel, &rows, &columns);
    let doubled = sum_of_logarithms(kernel, &squares);
    let half = kernel.builder.number(Rational::HALF);
    kernel.builder.add_product(total, half, doubled)
}

/// Row and column of an entry that is the only one of its row or column, apart from structural zeros.
fn lone_entry(kernel: &Kernel<'_>, rows: &[usize], columns: &[usize]) -> Option<(usize, usize)> {
    let is_entry = |a: usize, j: usize| {
        let entry = kernel.derivation.constraints[a].form[j];
        !kernel.model.pool.is_syntactic_zero(entry)
    };
    let is_lone = |&(a, j): &(usize, usize)| {
        let in_row = columns.iter().filter(|k| is_entry(a, **k)).count();
        let in_column = rows.iter().filter(|b| is_entry(**b, j)).count();
        is_entry(a, j) && (in_row == 1 || in_column == 1)
    };
    let mut entries = rows
        .iter()
        .flat_map(|&a| columns.iter().map(move |&j| (a, j)));
    entries.find(is_lone)
}

/// `ln |eta^a_j|`, with an error where the entry is 0.
fn log_entry(kernel: &mut Kernel<'_>, a: usize, j: usize) -> Value {
    let entry = kernel.derivation.constraints[a].form[j];
    if !kernel.model.pool.sign(entry).is_nonzero() {
        let value = kernel.value(entry);
        let magnitude = kernel.builder.call(Elementary::Abs, value);
        kernel.builder.guard(Guard::Constraint {
            constraint: a,
            squared: magnitude,
            reference: None,
        });
    }
    log_magnitude(kernel, entry)
}

/// Squared norms of the rows, each without its components along the earlier ones.
fn squared_norms(kernel: &mut Kernel<'_>, rows: &[usize], columns: &[usize]) -> Vec<Value> {
    let entries = rows
        .iter()
        .map(|&a| {
            let form = &kernel.derivation.constraints[a].form;
            let row: Vec<ExprId> = columns.iter().map(|&j| form[j]).collect();
            kernel.values(&row)
        })
        .collect();
    let flat = Ldlt::identity(&mut kernel.builder, columns.len());
    let guard = |index: usize, squared, reference| Guard::Constraint {
        constraint: rows[index],
        squared,
        reference,
    };
    Orthogonal::factor(&mut kernel.builder, &flat, entries, guard).squares
}
