//! Reduction by a group: fields `xi_a` whose flows preserve the Lagrangian and the constraints, with
//! `[xi_a, xi_b] = C_ab^c xi_c`.
//!
//! ```text
//! I_ab = g(xi_a, xi_b),  J_a = <p, xi_a>              locked inertia, momentum map
//! e_i = s_i^a xi_a in D                               the part of the orbits that the constraints allow: J_i = <p, e_i>, I_ij = g(e_i, e_j)
//! A^a(xi_b) = delta,  eta(X - xi_a A^a(X)) = 0,  g(e_i, X - xi_a A^a(X)) = 0
//! B^a = dA^a + 1/2 C_bc^a A^b ^ A^c                   dA^a on horizontal vectors
//! ```
//!
//! Without constraints A is the mechanical connection `I^{ab} g(xi_b, .)`, else the nonholonomic connection. It exists
//! where the orbits and D together span all directions. Sources: W. Clark, thesis, VI.24, VI.25, VI.31 to VI.37; A.
//! Bloch, P. Krishnaprasad, J. Marsden and R. Murray, Arch. Rational Mech. Anal. 136 (1996).

mod structure;

use dalembert_expr::{ExprId, Pool, Rational, SymbolId, Verdict};

use super::bracket::{Bracket, NoBracket, derive_bracket, exterior, settled};
use super::inverse::{Matrix, NoMinor, dot, independent_minor, inverse, tidy};
use super::{Derivation, SurfaceForm};
use crate::model::{Law, Model, Topology};
use structure::structure;

/// Reason why the fields give no reduction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoReduction {
    /// There is no bracket.
    NoBracket(NoBracket),
    /// The fields are dependent at all configurations.
    Dependent,
    /// The bracket of these two fields is proved to be no combination of the fields with constant coefficients.
    NotClosed(usize, usize),
    /// Undecided: the bracket of these two fields may or may not be such a combination.
    Undecided(usize, usize),
    /// Undecided: the fields, or the constraints on them, may or may not be independent.
    UndecidedRank,
    /// A matrix is too large for inversion by minors.
    TooLarge,
}

impl From<NoMinor> for NoReduction {
    fn from(reason: NoMinor) -> Self {
        match reason {
            NoMinor::TooLarge => Self::TooLarge,
            NoMinor::Undecided => Self::UndecidedRank,
        }
    }
}

/// Quantities of a reduction by a group.
#[derive(Debug)]
pub struct Reduction {
    /// `C_ab^c`
    pub structure: Vec<Matrix>,
    /// `I_ab`
    pub locked: Matrix,
    /// `J_a`
    pub momenta: Vec<ExprId>,
    /// `e_i`, N components each. Without constraints these are the fields themselves.
    pub sections: Matrix,
    /// `g(e_i, e_j)`
    pub constrained: Matrix,
    /// `<p, e_i>` on D
    pub momenta_on_d: Vec<ExprId>,
    /// Rates of `momenta_on_d` along the motion; `None` if constraints are affine, or if the metric, the terms linear
    /// in the velocities, the constraints or the fields depend on time.
    pub rates: Option<Vec<ExprId>>,
    /// Forms `A^a`; `None` unless the orbits and D together span all directions.
    pub connection: Option<Matrix>,
    /// `B^a_kl` in coordinates, an N by N matrix for each `a`; empty without a connection.
    pub curvature: Vec<Matrix>,
    /// The reduced equations; `None` unless the frame of the motion is proved to be invariant.
    pub reduced: Option<Reduced>,
    /// Jumps at surfaces; `None` for a law that is no single impulse.
    pub impacts: Vec<Option<Jump>>,
}

/// The motion on D modulo the group: coordinates that the group does not move, and quasi-velocities that it does not
/// change.
#[derive(Debug)]
pub struct Reduced {
    /// Indices and rates of the coordinates that the group does not move.
    pub shape: Vec<(usize, ExprId)>,
    /// Quasi-velocities: symbols, expressions in the velocities, and rates.
    pub quasi: Vec<(SymbolId, ExprId, ExprId)>,
    /// Indices and rates of the other coordinates.
    pub group: Vec<(usize, ExprId)>,
}

/// The jump of momenta: `J_i+ = J_i + eps dh(e_i)`.
#[derive(Debug)]
pub struct Jump {
    /// `dh(e_i)`
    pub slopes: Vec<ExprId>,
    /// `eps`; `None` if constraints are affine, or if the metric is too large to be inverted.
    pub impulse: Option<ExprId>,
}

/// Derives the quantities of a reduction by a group. `fields` must be symmetries of the Lagrangian and of the
/// constraints.
///
/// # Errors
/// [`NoReduction`].
pub fn derive_reduction(
    model: &mut Model,
    derivation: &Derivation,
    fields: &[Vec<ExprId>],
) -> Result<Reduction, NoReduction> {
    let bracket = derive_bracket(model, derivation).map_err(NoReduction::NoBracket)?;
    let structure = structure(&mut model.pool, (&bracket.q, model.time), fields)?;
    let metric = model.lagrangian.metric.clone();
    let forms: Matrix = (model.constraints.iter())
        .map(|constraint| constraint.form.clone())
        .collect();
    let (along_orbits, is_principal) = kernel(&mut model.pool, &forms, fields)?;
    let sections = simplest(&mut model.pool, &bracket, fields, along_orbits)?;
    let pool = &mut model.pool;
    let locked = products(pool, &metric, fields);
    let constrained = products(pool, &metric, &sections);
    let momenta = momenta(model, fields);
    let on_d = momenta_of(model, &bracket, &sections);
    let forces = forces_on_d(model, &bracket, fields);
    let rates = rates_of(model, &bracket, &on_d, (&sections, &forces));
    let pool = &mut model.pool;
    let connection = match is_principal {
        true => Some(connection(pool, (&metric, &forms), fields, &sections)?),
        false => None,
    };
    let curvature = match &connection {
        Some(forms) => curvature(pool, &bracket.q, forms, &structure),
        None => Vec::new(),
    };
    let reduced = reduced(model, &bracket, fields, &forces);
    let surfaces = derivation.surfaces.iter().enumerate();
    let impacts = surfaces
        .map(|(s, surface)| jump(model, &bracket, (s, surface), &sections))
        .collect();
    Ok(Reduction {
        structure,
        locked,
        momenta,
        sections,
        constrained,
        momenta_on_d: on_d
            .into_iter()
            .map(|value| bracket.written(&mut model.pool, value))
            .collect(),
        rates,
        connection,
        curvature,
        reduced,
        impacts,
    })
}

/// A basis of the combinations of fields that all forms annihilate. The second value is true if the forms are
/// independent on the span of the fields.
fn kernel(
    pool: &mut Pool,
    forms: &[Vec<ExprId>],
    fields: &[Vec<ExprId>],
) -> Result<(Matrix, bool), NoReduction> {
    let values: Matrix = (forms.iter())
        .map(|form| fields.iter().map(|field| dot(pool, form, field)).collect())
        .collect();
    let (rows, columns) = independent_minor(pool, &values)?;
    let minor: Matrix = (rows.iter())
        .map(|a| columns.iter().map(|b| values[*a][*b]).collect())
        .collect();
    let inverse = inverse(pool, &minor).ok_or(NoReduction::TooLarge)?;
    let mut sections = Vec::new();
    for (b, field) in fields.iter().enumerate() {
        if columns.contains(&b) {
            continue;
        }
        let lacking: Vec<ExprId> = rows.iter().map(|a| values[*a][b]).collect();
        let factors: Vec<ExprId> = inverse.iter().map(|row| dot(pool, row, &lacking)).collect();
        let section = (0..field.len()).map(|k| {
            let column: Vec<ExprId> = columns.iter().map(|c| fields[*c][k]).collect();
            let sum = dot(pool, &factors, &column);
            let rest = pool.sub(field[k], sum);
            settled(pool, rest)
        });
        sections.push(section.collect());
    }
    Ok((sections, rows.len() == forms.len()))
}

/// A basis of the directions of D along the orbits: combinations of the symmetries, or of the frame of D, whichever is
/// shorter.
fn simplest(
    pool: &mut Pool,
    bracket: &Bracket,
    fields: &[Vec<ExprId>],
    along_orbits: Matrix,
) -> Result<Matrix, NoReduction> {
    let frame = &bracket.frame.fields;
    let (n, count) = (bracket.q.len(), along_orbits.len());
    if count == frame.len() {
        // The orbits contain D.
        return Ok(frame.clone());
    }
    let is_fixed = |k: &usize| fields.iter().all(|field| pool.is_syntactic_zero(field[*k]));
    let fixed: Vec<usize> = (0..n).filter(is_fixed).collect();
    if fixed.len() + fields.len() != n {
        return Ok(along_orbits);
    }
    let forms: Matrix = fixed.into_iter().map(|k| axis(pool, n, k)).collect();
    let (within_d, _) = kernel(pool, &forms, frame)?;
    let size = |fields: &Matrix| pool.reachable(&fields.concat()).len();
    Ok(match size(&within_d) < size(&along_orbits) {
        true => within_d,
        false => along_orbits,
    })
}

/// Unit vector `k` of length `n`: a coordinate field, or a differential.
fn axis(pool: &Pool, n: usize, k: usize) -> Vec<ExprId> {
    let entry = |l: usize| if k == l { pool.one() } else { pool.zero() };
    (0..n).map(entry).collect()
}

/// `g(x_i, x_j)`
fn products(pool: &mut Pool, metric: &[Vec<ExprId>], fields: &[Vec<ExprId>]) -> Matrix {
    let lowered = lowered(pool, metric, fields);
    (lowered.iter())
        .map(|form| fields.iter().map(|field| dot(pool, form, field)).collect())
        .collect()
}

/// `g x_i`
fn lowered(pool: &mut Pool, metric: &[Vec<ExprId>], fields: &[Vec<ExprId>]) -> Matrix {
    (fields.iter())
        .map(|field| metric.iter().map(|row| dot(pool, row, field)).collect())
        .collect()
}

/// `<p, xi_a>` in terms of velocities.
fn momenta(model: &mut Model, fields: &[Vec<ExprId>]) -> Vec<ExprId> {
    let whole = model.lagrangian.whole;
    let velocities: Vec<SymbolId> = (model.coordinates.iter())
        .map(|coordinate| coordinate.qdot)
        .collect();
    let pool = &mut model.pool;
    let p: Vec<ExprId> = velocities
        .iter()
        .map(|symbol| pool.diff(whole, *symbol))
        .collect();
    fields.iter().map(|field| dot(pool, field, &p)).collect()
}

/// `<p, e_i>` on D, in terms of positions and quasi-velocities.
fn momenta_of(model: &mut Model, bracket: &Bracket, sections: &[Vec<ExprId>]) -> Vec<ExprId> {
    let momenta = momenta(model, sections);
    let values = momenta.into_iter();
    values
        .map(|momentum| {
            let value = model.pool.substitute(momentum, &bracket.frame.velocity);
            settled(&mut model.pool, value)
        })
        .collect()
}

/// The sum of the forces on D; `None` if constraints are affine, or if the metric, the terms linear in the velocities,
/// the constraints or the fields depend on time. The bracket does not give the motion in these cases.
fn forces_on_d(
    model: &mut Model,
    bracket: &Bracket,
    fields: &[Vec<ExprId>],
) -> Option<Vec<ExprId>> {
    let time = model.time;
    let mut parts: Vec<ExprId> = model.lagrangian.metric.iter().flatten().copied().collect();
    parts.extend(
        model
            .lagrangian
            .linear
            .iter()
            .chain(fields.iter().flatten()),
    );
    parts.extend(
        model
            .constraints
            .iter()
            .flat_map(|constraint| constraint.form.iter()),
    );
    let moves = parts.iter().any(|part| model.pool.depends_on(*part, time));
    let is_affine = (model.constraints.iter())
        .any(|constraint| !model.pool.is_syntactic_zero(constraint.affine));
    if moves || is_affine {
        return None;
    }
    let forms: Matrix = model
        .forces
        .iter()
        .map(|force| force.form.clone())
        .collect();
    let pool = &mut model.pool;
    let sums = (0..bracket.q.len()).map(|k| {
        let entries: Vec<ExprId> = forms.iter().map(|form| form[k]).collect();
        let sum = pool.sum(&entries);
        pool.substitute(sum, &bracket.frame.velocity)
    });
    Some(sums.collect())
}

/// `{J_i, H} + F(e_i)` in terms of velocities.
fn rates_of(
    model: &mut Model,
    bracket: &Bracket,
    on_d: &[ExprId],
    (sections, forces): (&[Vec<ExprId>], &Option<Vec<ExprId>>),
) -> Option<Vec<ExprId>> {
    let forces = forces.as_ref()?;
    let energy = model.pool.variable(model.derived.energy);
    let energy = bracket.on_d(&mut model.pool, energy);
    let rates = on_d.iter().zip(sections).map(|(momentum, section)| {
        let pool = &mut model.pool;
        let momentum = bracket.on_d(pool, *momentum);
        let free = bracket.between(pool, &momentum, &energy);
        let forced = dot(pool, section, forces);
        let rate = pool.add(free, forced);
        bracket.written(pool, rate)
    });
    Some(rates.collect())
}

/// `A^a`, N entries each: `(eta(xi_a); g(e_i, xi_a)) A = (eta; g e_i)`.
fn connection(
    pool: &mut Pool,
    (metric, forms): (&[Vec<ExprId>], &[Vec<ExprId>]),
    fields: &[Vec<ExprId>],
    sections: &[Vec<ExprId>],
) -> Result<Matrix, NoReduction> {
    let width = metric.len();
    let rows = match fields.len() == width {
        // No direction is horizontal.
        true => (0..width).map(|k| axis(pool, width, k)).collect(),
        false => [forms.to_vec(), lowered(pool, metric, sections)].concat(),
    };
    let vertical: Matrix = (rows.iter())
        .map(|row| fields.iter().map(|field| dot(pool, row, field)).collect())
        .collect();
    let inverse = inverse(pool, &vertical).ok_or(NoReduction::TooLarge)?;
    let entry = |pool: &mut Pool, by: &Vec<ExprId>, k: usize| {
        let column: Vec<ExprId> = rows.iter().map(|row| row[k]).collect();
        let sum = dot(pool, by, &column);
        settled(pool, sum)
    };
    Ok((inverse.iter())
        .map(|by| (0..width).map(|k| entry(pool, by, k)).collect())
        .collect())
}

/// `B^a_kl = d_k A^a_l - d_l A^a_k + C_bc^a A^b_k A^c_l`
fn curvature(
    pool: &mut Pool,
    q: &[SymbolId],
    forms: &[Vec<ExprId>],
    structure: &[Matrix],
) -> Vec<Matrix> {
    let n = q.len();
    let of = |pool: &mut Pool, a: usize, k: usize, l: usize| {
        let [x, y] = [axis(pool, n, k), axis(pool, n, l)];
        let mut terms = vec![exterior(pool, q, &forms[a], [&x, &y])];
        for (b, row) in structure.iter().enumerate() {
            for (c, factors) in row.iter().enumerate() {
                if !pool.is_syntactic_zero(factors[a]) {
                    terms.push(pool.product(&[factors[a], forms[b][k], forms[c][l]]));
                }
            }
        }
        let sum = pool.sum(&terms);
        settled(pool, sum)
    };
    (0..forms.len())
        .map(|a| {
            let mut entries = vec![vec![pool.zero(); n]; n];
            for k in 0..n {
                for l in k + 1..n {
                    entries[k][l] = of(pool, a, k, l);
                    entries[l][k] = pool.neg(entries[k][l]);
                }
            }
            entries
        })
        .collect()
}

/// The reduced equations; `None` unless the frame and the equations in it are proved to be invariant.
fn reduced(
    model: &mut Model,
    bracket: &Bracket,
    fields: &[Vec<ExprId>],
    forces: &Option<Vec<ExprId>>,
) -> Option<Reduced> {
    let forces = forces.as_ref()?;
    let frame = &bracket.frame;
    let moved: Vec<bool> = (0..bracket.q.len())
        .map(|k| {
            !fields
                .iter()
                .all(|field| model.pool.is_syntactic_zero(field[k]))
        })
        .collect();
    let quasi: Vec<ExprId> = (frame.u.iter())
        .map(|symbol| {
            let u = model.pool.variable(*symbol);
            model.pool.substitute(u, &frame.quasi)
        })
        .collect();
    let is_kept = quasi.iter().all(|u| {
        let mut fields = fields.iter();
        fields.all(|field| change_along(model, bracket, field, *u))
    });
    if !is_kept {
        return None;
    }
    let energy = model.pool.variable(model.derived.energy);
    let energy = bracket.on_d(&mut model.pool, energy);
    let mut rates = Vec::new();
    for (i, symbol) in frame.u.iter().enumerate() {
        let pool = &mut model.pool;
        let u = pool.variable(*symbol);
        let u = bracket.on_d(pool, u);
        let free = bracket.between(pool, &u, &energy);
        let pushed: Vec<ExprId> = (frame.fields.iter())
            .map(|field| dot(pool, field, forces))
            .collect();
        let forced = dot(pool, &bracket.inverse[i], &pushed);
        let rate = pool.add(free, forced);
        rates.push(without(model, &bracket.q, &moved, rate)?);
    }
    let velocities: Vec<ExprId> = frame.velocity.iter().map(|(_, value)| *value).collect();
    let mut shape = Vec::new();
    let mut group = Vec::new();
    for (k, velocity) in velocities.into_iter().enumerate() {
        match moved[k] {
            false => shape.push((k, without(model, &bracket.q, &moved, velocity)?)),
            true => group.push((k, settled(&mut model.pool, velocity))),
        }
    }
    let symbols = frame.u.iter().copied();
    let quasi = symbols.zip(quasi).zip(rates);
    Some(Reduced {
        shape,
        quasi: quasi
            .map(|((symbol, of), rate)| (symbol, of, rate))
            .collect(),
        group,
    })
}

/// True if the derivative of a function along the lift of a field is proved to vanish on D.
fn change_along(model: &mut Model, bracket: &Bracket, field: &[ExprId], function: ExprId) -> bool {
    let coordinates = model.coordinates.clone();
    let pool = &mut model.pool;
    let motion: Vec<(SymbolId, ExprId)> = (coordinates.iter())
        .map(|coordinate| (coordinate.q, pool.variable(coordinate.qdot)))
        .collect();
    let mut lift = Vec::new();
    for (coordinate, component) in coordinates.iter().zip(field) {
        lift.push((coordinate.q, *component));
        let rate = pool.derivative_along(*component, &motion);
        lift.push((coordinate.qdot, rate));
    }
    let change = pool.derivative_along(function, &lift);
    let change = pool.substitute(change, &bracket.frame.velocity);
    pool.zero_test(change) == Verdict::Proved
}

/// `value` at fixed values of the coordinates that the group moves; `None` unless it is proved independent of them.
fn without(model: &mut Model, q: &[SymbolId], moved: &[bool], value: ExprId) -> Option<ExprId> {
    let mut value = settled(&mut model.pool, value);
    for (k, symbol) in q.iter().enumerate() {
        if !moved[k] || !model.pool.depends_on(value, *symbol) {
            continue;
        }
        let slope = model.pool.diff(value, *symbol);
        if model.pool.zero_test(slope) != Verdict::Proved {
            return None;
        }
        let base = match model.coordinates[k].topology {
            Topology::Interval { low, high } => {
                let sum = model.pool.add(low, high);
                model.pool.scale(&Rational::HALF, sum)
            }
            Topology::Line | Topology::Angle => model.pool.zero(),
        };
        let fixed = model.pool.substitute(value, &[(*symbol, base)]);
        value = tidy(&mut model.pool, fixed);
    }
    Some(value)
}

/// The jump of momenta at a surface; `None` if the law is no single impulse.
fn jump(
    model: &mut Model,
    bracket: &Bracket,
    (index, surface): (usize, &SurfaceForm),
    sections: &[Vec<ExprId>],
) -> Option<Jump> {
    let law = model.surfaces[index].law;
    if matches!(law, Law::Reset | Law::Stop | Law::Transition) || !surface.instantaneous.is_empty()
    {
        return None;
    }
    let is_linear = (model.constraints.iter())
        .all(|constraint| model.pool.is_syntactic_zero(constraint.affine));
    let slopes = (sections.iter())
        .map(|section| {
            let slope = dot(&mut model.pool, &surface.form, section);
            settled(&mut model.pool, slope)
        })
        .collect();
    let impulse = is_linear.then(|| impulse(model, bracket, law, surface));
    Some(Jump {
        slopes,
        impulse: impulse.flatten(),
    })
}

/// `eps = -c (dh(qdot) + d_t h)/dh(pi_D grad h)`; `None` where the metric is not inverted by minors.
fn impulse(
    model: &mut Model,
    bracket: &Bracket,
    law: Law,
    surface: &SurfaceForm,
) -> Option<ExprId> {
    let metric = model.lagrangian.metric.clone();
    let pool = &mut model.pool;
    let on_d: Vec<ExprId> = (bracket.frame.fields.iter())
        .map(|field| dot(pool, field, &surface.form))
        .collect();
    // The sum keeps squares of long gradients as products.
    let mut squares = Vec::new();
    for (i, row) in bracket.inverse.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            squares.push(pool.product(&[on_d[i], *entry, on_d[j]]));
        }
    }
    let allowed = pool.sum(&squares);
    let rate = surface.gap_rate;
    let one = pool.one();
    let factor = match law {
        Law::Elastic => pool.int(2),
        Law::Restitution(e) | Law::Newton(e) => pool.add(one, e),
        Law::ImpactPlastic => one,
        Law::NonholonomicPlastic | Law::TotallyPlastic => {
            let cometric = inverse(pool, &metric)?;
            let gradient: Vec<ExprId> = cometric
                .iter()
                .map(|row| dot(pool, row, &surface.form))
                .collect();
            let whole = dot(pool, &surface.form, &gradient);
            let share = pool.div(allowed, whole);
            match law {
                Law::NonholonomicPlastic => pool.scale(&Rational::from(2), share),
                _ => share,
            }
        }
        Law::Reset | Law::Stop | Law::Transition => return None,
    };
    let product = pool.mul(factor, rate);
    let quotient = pool.div(product, allowed);
    Some(pool.neg(quotient))
}
