//! Bracket of functions on D at a fixed time: Poisson without constraints, almost Poisson with constraints.
//!
//! ```text
//! {f, g} = {f o P, g o P} on D      P the projection of momenta to D along the constraint forces, p - A -> pi_D^*(p - A)
//! ```
//!
//! `A` is the one-form in `p = g qdot + A`. In a frame X_i of D with `qdot = X_0 + X_i u^i` and `mu_i = <p - A, X_i>`:
//!
//! ```text
//! {q^k, mu_j}  = X_j^k,   {q^k, q^l} = 0,   {mu_i, mu_j} = dA(X_i, X_j) - g(qdot, [X_i, X_j])
//! {f, g}       = X_j(f) g^j - X_j(g) f^j + f^i g^j S_ij,       f^i = df/dmu_i = G^{ij} df/du^j,   G = X^T g X
//! S_ij         = {mu_i, mu_j} - X_j(mu_i) + X_i(mu_j)           derivatives X_j at constant u
//! ```
//!
//! The signs are those of `{f, g} = f_q g_p - f_p g_q`. Sources: W. Clark, thesis, III.6 to III.8; J. Cortes and A. Vinogradov, 2.4
//! and 3.1: this is the bracket of their partial symplectic structure, affine constraints included.

use dalembert_expr::{Assumption, ExprId, Pool, Rational, SymbolId, Verdict};

use super::energy::total_energy;
use super::inverse::{Matrix, NoMinor, dot, independent_minor, inverse, tidy};
use super::{Derivation, Frame};
use crate::model::Model;

/// Reason why a model has no bracket.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoBracket {
    /// The rates are declared: a first-order system.
    FirstOrder,
    /// Some constraints are not linear in the velocities.
    Nonlinear,
    /// A matrix is too large to be inverted by minors.
    TooLarge,
    /// The constraints depend on each other.
    Dependent,
    /// The constraints were proved neither independent nor dependent.
    Undecided,
}

impl NoBracket {
    /// The text of the reason.
    pub fn text(self) -> &'static str {
        match self {
            Self::FirstOrder => "a system of first order has no bracket",
            Self::Nonlinear => {
                "constraints that are not linear in the velocities have no bracket here"
            }
            Self::TooLarge => {
                "the metric or the constraints couple more than four velocities: the bracket is not written out"
            }
            Self::Dependent => "constraints that depend on each other have no bracket here",
            Self::Undecided => {
                "the constraints are not known to be independent: the bracket is not written out"
            }
        }
    }
}

impl From<NoMinor> for NoBracket {
    fn from(reason: NoMinor) -> Self {
        match reason {
            NoMinor::TooLarge => Self::TooLarge,
            NoMinor::Undecided => Self::Undecided,
        }
    }
}

/// A frame of D: `qdot = X_0 + X_i u^i`.
#[derive(Debug, Clone)]
pub(crate) struct FrameOfD {
    /// `X_i`, N - M rows of N.
    pub(crate) fields: Matrix,
    /// The symbols of `u`, N - M.
    pub(crate) u: Vec<SymbolId>,
    /// Pairs of a velocity and its expression in `u`.
    pub(crate) velocity: Vec<(SymbolId, ExprId)>,
    /// Pairs of a symbol in `u` and its expression in velocities. Empty if every `u` is a velocity.
    pub(crate) quasi: Vec<(SymbolId, ExprId)>,
}

/// A function on D with its derivatives.
#[derive(Debug, Clone)]
pub struct FunctionOnD {
    /// The function, in positions and quasi-velocities.
    pub value: ExprId,
    /// `df/dmu_i`, N - M entries.
    by_momenta: Vec<ExprId>,
}

/// The bracket of a model.
#[derive(Debug, Clone)]
pub struct Bracket {
    /// The frame in which the bracket is expressed.
    pub(crate) frame: FrameOfD,
    /// Symbols of the coordinates.
    pub(crate) q: Vec<SymbolId>,
    /// `G^{-1}`, (N - M) by (N - M).
    pub(crate) inverse: Matrix,
    /// `S_ij`, (N - M) by (N - M).
    structure: Matrix,
    /// Symbols of momenta and energy, with their values as functions on D.
    named: Vec<(SymbolId, FunctionOnD)>,
}

/// Derives the bracket of a model.
///
/// # Errors
/// [`NoBracket`] with the reason.
pub fn derive_bracket(model: &mut Model, derivation: &Derivation) -> Result<Bracket, NoBracket> {
    let frame = frame_of_d(model, derivation)?;
    let q: Vec<SymbolId> = (model.coordinates.iter())
        .map(|coordinate| coordinate.q)
        .collect();
    let metric = model.lagrangian.metric.clone();
    let linear = model.lagrangian.linear.clone();
    let pool = &mut model.pool;
    let velocity: Vec<ExprId> = frame.velocity.iter().map(|(_, value)| *value).collect();
    let momentum: Vec<ExprId> = metric.iter().map(|row| dot(pool, row, &velocity)).collect();
    let lowered: Matrix = (frame.fields.iter())
        .map(|field| metric.iter().map(|row| dot(pool, row, field)).collect())
        .collect();
    let reduced: Matrix = (lowered.iter())
        .map(|form| frame.fields.iter().map(|x| dot(pool, form, x)).collect())
        .collect();
    let inverse = inverse(pool, &reduced).ok_or(NoBracket::TooLarge)?;
    let momenta: Vec<ExprId> = (frame.fields.iter())
        .map(|field| dot(pool, field, &momentum))
        .collect();
    let size = frame.fields.len();
    let mut structure = vec![vec![pool.zero(); size]; size];
    for i in 0..size {
        for j in 0..i {
            let pair = [&frame.fields[i], &frame.fields[j]];
            let bracket = commutator(pool, &q, pair);
            let inertial = dot(pool, &momentum, &bracket);
            let magnetic = exterior(pool, &q, &linear, pair);
            let [first, second] = [
                along(pool, &q, &frame.fields[j], momenta[i]),
                along(pool, &q, &frame.fields[i], momenta[j]),
            ];
            let signed = [(1, magnetic), (-1, inertial), (-1, first), (1, second)];
            let sum = pool.combine(&signed.map(|(sign, term)| (Rational::from(sign), term)));
            structure[i][j] = tidy(pool, sum);
            structure[j][i] = pool.neg(structure[i][j]);
        }
    }
    let bracket = Bracket {
        frame,
        q,
        inverse,
        structure,
        named: Vec::new(),
    };
    Ok(bracket.with_names(model))
}

impl Bracket {
    /// Adds momenta and energy as functions on D. Their derivatives with respect to `mu` are known in two cases: unit
    /// vectors for momenta without constraints, and `u` for the energy if all constraints are linear.
    fn with_names(mut self, model: &mut Model) -> Self {
        let is_free = model.constraints.is_empty();
        let is_linear = (model.constraints.iter())
            .all(|constraint| model.pool.is_syntactic_zero(constraint.affine));
        for i in 0..model.coordinates.len() {
            let symbol = model.derived.momenta[i];
            let momentum = model
                .pool
                .diff(model.lagrangian.whole, model.coordinates[i].qdot);
            let mut momentum = self.on_d(&mut model.pool, momentum);
            if is_free {
                let (zero, one) = (model.pool.zero(), model.pool.one());
                momentum.by_momenta = vec![zero; model.coordinates.len()];
                momentum.by_momenta[i] = one;
            }
            self.named.push((symbol, momentum));
        }
        let energy = total_energy(model);
        let mut energy = self.on_d(&mut model.pool, energy);
        if is_linear {
            let u = self.frame.u.iter();
            energy.by_momenta = u.map(|symbol| model.pool.variable(*symbol)).collect();
        }
        self.named.push((model.derived.energy, energy));
        self
    }

    /// A function of positions, velocities, momenta and energy, restricted to D.
    pub fn on_d(&self, pool: &mut Pool, function: ExprId) -> FunctionOnD {
        let mut values = self.frame.velocity.clone();
        let named = self.named.iter();
        values.extend(named.map(|(symbol, known)| (*symbol, known.value)));
        let value = pool.substitute(function, &values);
        // Momenta and energy are kept as symbols here; their derivatives are added below.
        let held = pool.substitute(function, &self.frame.velocity);
        let mut by_momenta = self.solved(pool, held);
        for (symbol, known) in &self.named {
            let slope = pool.diff(function, *symbol);
            for (sum, by) in by_momenta.iter_mut().zip(&known.by_momenta) {
                let term = dot(pool, &[slope], &[*by]);
                *sum = pool.add(*sum, term);
            }
        }
        let by_momenta = by_momenta.into_iter().map(|slope| {
            let slope = pool.substitute(slope, &values);
            tidy(pool, slope)
        });
        FunctionOnD {
            by_momenta: by_momenta.collect(),
            value: tidy(pool, value),
        }
    }

    /// A function of positions and quasi-velocities, expressed in velocities and simplified.
    pub fn written(&self, pool: &mut Pool, function: ExprId) -> ExprId {
        let settled = settled(pool, function);
        let written = pool.substitute(settled, &self.frame.quasi);
        let written = pool.simplify(written);
        pool.generic(written)
    }

    /// `{f, g}`, in positions and quasi-velocities.
    pub fn between(&self, pool: &mut Pool, f: &FunctionOnD, g: &FunctionOnD) -> ExprId {
        let [first, second] = [f, g].map(|function| &function.by_momenta);
        let changes = |pool: &mut Pool, function: &FunctionOnD| -> Vec<ExprId> {
            let fields = self.frame.fields.iter();
            fields
                .map(|field| along(pool, &self.q, field, function.value))
                .collect()
        };
        let [of_f, of_g] = [f, g].map(|function| changes(pool, function));
        let turned: Vec<ExprId> = (self.structure.iter())
            .map(|row| dot(pool, row, second))
            .collect();
        let terms = [
            (1, dot(pool, &of_f, second)),
            (-1, dot(pool, &of_g, first)),
            (1, dot(pool, first, &turned)),
        ];
        let sum = pool.combine(&terms.map(|(sign, term)| (Rational::from(sign), term)));
        settled(pool, sum)
    }

    /// `{{f, g}, h} + {{h, f}, g} + {{g, h}, f}`
    pub fn jacobiator(&self, pool: &mut Pool, [f, g, h]: [&FunctionOnD; 3]) -> ExprId {
        let terms = [(f, g, h), (h, f, g), (g, h, f)].map(|(a, b, c)| {
            let inner = self.between(pool, a, b);
            let inner = self.on_d(pool, inner);
            self.between(pool, &inner, c)
        });
        pool.sum(&terms)
    }

    /// `G^{ij} df/du^j`
    fn solved(&self, pool: &mut Pool, function: ExprId) -> Vec<ExprId> {
        let slopes = self
            .frame
            .u
            .iter()
            .map(|symbol| pool.diff(function, *symbol));
        let slopes: Vec<ExprId> = slopes.collect();
        self.inverse
            .iter()
            .map(|row| dot(pool, row, &slopes))
            .collect()
    }
}

/// The expression multiplied out, or 0 if it is proved to be 0.
pub(crate) fn settled(pool: &mut Pool, expression: ExprId) -> ExprId {
    match pool.zero_test(expression) {
        Verdict::Proved => pool.zero(),
        Verdict::Refuted | Verdict::Undecided => tidy(pool, expression),
    }
}

/// `X(f)`
pub(crate) fn along(pool: &mut Pool, q: &[SymbolId], field: &[ExprId], function: ExprId) -> ExprId {
    let slopes: Vec<ExprId> = q
        .iter()
        .map(|symbol| pool.diff(function, *symbol))
        .collect();
    dot(pool, field, &slopes)
}

/// `[X, Y]`
pub(crate) fn commutator(
    pool: &mut Pool,
    q: &[SymbolId],
    [x, y]: [&Vec<ExprId>; 2],
) -> Vec<ExprId> {
    let components = x.iter().zip(y);
    let components = components.map(|(&of_x, &of_y)| {
        let [first, second] = [along(pool, q, x, of_y), along(pool, q, y, of_x)];
        pool.sub(first, second)
    });
    components.collect()
}

/// `dA(X, Y)`
pub(crate) fn exterior(
    pool: &mut Pool,
    q: &[SymbolId],
    form: &[ExprId],
    [x, y]: [&Vec<ExprId>; 2],
) -> ExprId {
    let changes = |pool: &mut Pool, field: &Vec<ExprId>| -> Vec<ExprId> {
        form.iter()
            .map(|entry| along(pool, q, field, *entry))
            .collect()
    };
    let [by_x, by_y] = [changes(pool, x), changes(pool, y)];
    let [first, second] = [dot(pool, &by_x, y), dot(pool, &by_y, x)];
    pool.sub(first, second)
}

/// A frame of D: that of the reduced motion. If its expressions are not available, a frame of independent velocities
/// that is regular at almost all states, converted to the quasi-velocities of the model if possible.
pub(crate) fn frame_of_d(
    model: &mut Model,
    derivation: &Derivation,
) -> Result<FrameOfD, NoBracket> {
    if model.is_first_order() {
        return Err(NoBracket::FirstOrder);
    }
    if model.is_nonlinear() {
        return Err(NoBracket::Nonlinear);
    }
    let known = match (&derivation.frame, model.constraints.is_empty()) {
        (Ok(frame), false) => of_motion(model, frame),
        _ => None,
    };
    if let Some(frame) = known {
        return Ok(frame);
    }
    let velocities = of_velocities(model)?;
    let turned = match (&derivation.frame, model.constraints.is_empty()) {
        (Ok(frame), false) => turned(model, &velocities, frame),
        _ => None,
    };
    Ok(turned.unwrap_or(velocities))
}

/// Converts a frame of velocities to the quasi-velocities of `frame`. `None` if all of these are velocities of
/// coordinates, or if the velocities cannot be solved for.
fn turned(model: &mut Model, known: &FrameOfD, frame: &Frame) -> Option<FrameOfD> {
    if frame.quasi.iter().all(|quasi| quasi.coordinate.is_some()) {
        return None;
    }
    let velocities: Vec<SymbolId> = known.velocity.iter().map(|(symbol, _)| *symbol).collect();
    let pool = &mut model.pool;
    let matrix: Matrix = (frame.quasi.iter())
        .map(|quasi| {
            known
                .fields
                .iter()
                .map(|field| dot(pool, &quasi.form, field))
                .collect()
        })
        .collect();
    let inverse = inverse(pool, &matrix)?;
    let zero: Vec<(SymbolId, ExprId)> = known
        .u
        .iter()
        .map(|symbol| (*symbol, pool.zero()))
        .collect();
    let flows: Vec<ExprId> = known.velocity.iter().map(|(_, value)| *value).collect();
    let drift = pool.substitute_all(&flows, &zero);
    let u: Vec<SymbolId> = (frame.quasi.iter())
        .map(|quasi| pool.symbol(&quasi.name, &quasi.name, Assumption::None))
        .collect();
    let free: Vec<ExprId> = (u.iter().zip(&frame.quasi))
        .map(|(symbol, quasi)| {
            let lost = dot(pool, &quasi.form, &drift);
            let u = pool.variable(*symbol);
            pool.sub(u, lost)
        })
        .collect();
    let solved: Vec<ExprId> = inverse.iter().map(|row| dot(pool, row, &free)).collect();
    let values: Vec<(SymbolId, ExprId)> = known.u.iter().copied().zip(solved).collect();
    let velocity = pool.substitute_all(&flows, &values);
    let fields = (0..u.len()).map(|i| {
        let by: Vec<ExprId> = inverse.iter().map(|row| row[i]).collect();
        let entry = |k: usize| {
            let column: Vec<ExprId> = known.fields.iter().map(|field| field[k]).collect();
            dot(pool, &by, &column)
        };
        (0..velocities.len()).map(entry).collect()
    });
    let fields = fields.collect();
    let qdot: Vec<ExprId> = velocities
        .iter()
        .map(|symbol| pool.variable(*symbol))
        .collect();
    let quasi = u.iter().zip(&frame.quasi);
    let quasi = quasi.map(|(symbol, quasi)| (*symbol, dot(pool, &quasi.form, &qdot)));
    let quasi = quasi.collect();
    let velocity = velocity.into_iter().map(|value| tidy(pool, value));
    let velocity = velocities.into_iter().zip(velocity.collect::<Vec<_>>());
    Some(FrameOfD {
        velocity: velocity.collect(),
        fields,
        u,
        quasi,
    })
}

/// The frame of the reduced motion, if its expressions are available.
fn of_motion(model: &mut Model, frame: &Frame) -> Option<FrameOfD> {
    let invariant = frame.invariant.as_ref()?;
    let fields: Option<Matrix> = (invariant.written.iter())
        .map(|row| row.iter().copied().collect())
        .collect();
    let velocity: Option<Vec<ExprId>> = invariant.written_velocity.iter().copied().collect();
    let velocities: Vec<SymbolId> = (model.coordinates.iter())
        .map(|coordinate| coordinate.qdot)
        .collect();
    let pool = &mut model.pool;
    let qdot: Vec<ExprId> = velocities
        .iter()
        .map(|symbol| pool.variable(*symbol))
        .collect();
    let quasi = invariant.u.iter().zip(&frame.quasi);
    let quasi = quasi.map(|(symbol, quasi)| (*symbol, dot(pool, &quasi.form, &qdot)));
    Some(FrameOfD {
        quasi: quasi.collect(),
        fields: fields?,
        u: invariant.u.clone(),
        velocity: velocities.into_iter().zip(velocity?).collect(),
    })
}

/// A frame whose quasi-velocities are independent velocities.
fn of_velocities(model: &mut Model) -> Result<FrameOfD, NoBracket> {
    let n = model.coordinates.len();
    let forms: Matrix = (model.constraints.iter())
        .map(|constraint| constraint.form.clone())
        .collect();
    let affine: Vec<ExprId> = (model.constraints.iter())
        .map(|constraint| constraint.affine)
        .collect();
    let velocities: Vec<SymbolId> = (model.coordinates.iter())
        .map(|coordinate| coordinate.qdot)
        .collect();
    let pool = &mut model.pool;
    let (rows, dependent) = independent_minor(pool, &forms)?;
    if rows.len() < forms.len() {
        return Err(NoBracket::Dependent);
    }
    let select = |row: &Vec<ExprId>| dependent.iter().map(|j| row[*j]).collect();
    let minor: Matrix = forms.iter().map(select).collect();
    let solved = inverse(pool, &minor).ok_or(NoBracket::TooLarge)?;
    let independent: Vec<usize> = (0..n).filter(|i| !dependent.contains(i)).collect();
    let mut fields = vec![vec![pool.zero(); n]; independent.len()];
    let mut drift = vec![pool.zero(); n];
    for (field, i) in fields.iter_mut().zip(&independent) {
        field[*i] = pool.one();
        let column: Vec<ExprId> = forms.iter().map(|row| row[*i]).collect();
        for (j, row) in dependent.iter().zip(&solved) {
            let lost = dot(pool, row, &column);
            field[*j] = pool.neg(lost);
        }
    }
    for (j, row) in dependent.iter().zip(&solved) {
        let lost = dot(pool, row, &affine);
        drift[*j] = pool.neg(lost);
    }
    let u: Vec<SymbolId> = independent.iter().map(|i| velocities[*i]).collect();
    let free: Vec<ExprId> = u.iter().map(|symbol| pool.variable(*symbol)).collect();
    let velocity = (0..n).map(|k| {
        let column: Vec<ExprId> = fields.iter().map(|field| field[k]).collect();
        let sum = dot(pool, &column, &free);
        (velocities[k], pool.add(drift[k], sum))
    });
    Ok(FrameOfD {
        velocity: velocity.collect(),
        fields,
        u,
        quasi: Vec::new(),
    })
}
