//! First-order expansions of expressions in positions, velocities and time; tangent vectors of D at a fixed time;
//! exterior forms on these vectors.
//!
//! ```text
//! D at one time    eta^a(qdot) + eta^a_0 = 0: positions and independent velocities are coordinates
//! c df_1 ^ .. ^ df_k on v_1, .., v_k    c det(df_i(v_j))
//! ```

use std::collections::BTreeMap;

use dalembert_expr::{
    Arithmetic, ExpansionPoint, ExprId, JetSpace, Jets, Pool, RealPoint, Reals, Series, SymbolId,
};

use super::dynamics::{Dynamics, Number};
use super::examine::explicit;
use super::frame::choose_dependent;
use super::hybrid::Surroundings;
use super::linear::{Matrix, solve};
use super::minors::determinant;
use super::sample::{ATTEMPTS, state_on_d};
use super::wall::Wall;
use crate::model::{ExteriorForm, Model};

/// Largest number of components times `2^degree` of a form that is examined.
const LARGEST: usize = 1 << 17;

/// Expressions with their derivatives by positions, velocities and time.
#[derive(Debug)]
pub(super) struct Expansions {
    variables: Vec<SymbolId>,
    /// Value and derivatives as they are evaluated, keyed by the expression before any restriction.
    entries: BTreeMap<ExprId, (ExprId, Vec<ExprId>)>,
}

impl Expansions {
    pub(super) fn of(model: &Model) -> Self {
        let positions = model.coordinates.iter().map(|coordinate| coordinate.q);
        let velocities = model.coordinates.iter().map(|coordinate| coordinate.qdot);
        Self {
            variables: positions.chain(velocities).chain([model.time]).collect(),
            entries: BTreeMap::new(),
        }
    }

    /// The number of variables.
    pub(super) fn size(&self) -> usize {
        self.variables.len()
    }

    pub(super) fn add(&mut self, pool: &mut Pool, expressions: impl IntoIterator<Item = ExprId>) {
        for id in expressions {
            if self.entries.contains_key(&id) {
                continue;
            }
            let slopes = self.variables.iter().map(|by| pool.diff(id, *by));
            let slopes = slopes.collect();
            self.entries.insert(id, (id, slopes));
        }
    }

    /// Replaces a coordinate by its value on a surface, in values and derivatives.
    pub(super) fn restrict(&mut self, pool: &mut Pool, solution: (SymbolId, ExprId)) {
        for (value, slopes) in self.entries.values_mut() {
            *value = pool.substitute(*value, &[solution]);
            *slopes = pool.substitute_all(slopes, &[solution]);
        }
    }

    /// All expressions to be evaluated.
    pub(super) fn roots(&self) -> impl Iterator<Item = ExprId> + '_ {
        let of =
            |(value, slopes): &(ExprId, Vec<ExprId>)| std::iter::once(*value).chain(slopes.clone());
        self.entries.values().flat_map(of)
    }

    /// The derivatives of an expression, as expressions.
    pub(super) fn slopes(&self, id: ExprId) -> &[ExprId] {
        &self.entries[&id].1
    }

    pub(super) fn value<S: Copy>(&self, values: &[S], id: ExprId) -> S {
        values[self.entries[&id].0.index()]
    }

    /// The derivative of an expression along a vector.
    pub(super) fn along<A: Arithmetic>(
        &self,
        field: A,
        values: &[A::Scalar],
        id: ExprId,
        vector: &[A::Scalar],
    ) -> A::Scalar {
        let slopes = self.slopes(id).iter().map(|slope| values[slope.index()]);
        inner(field, slopes, vector)
    }

    /// The series of an expression in the variables, of order 1.
    pub(super) fn series<A: Arithmetic>(
        &self,
        jets: &Jets<'_, A>,
        values: &[A::Scalar],
        id: ExprId,
    ) -> Series<A> {
        let (value, slopes) = &self.entries[&id];
        let mut series = vec![values[value.index()]];
        series.extend(slopes.iter().map(|slope| values[slope.index()]));
        jets.add(&[], &series)
    }
}

/// `sum a_i b_i`, up to the end of the shorter one.
pub(super) fn inner<A: Arithmetic>(
    field: A,
    row: impl Iterator<Item = A::Scalar>,
    vector: &[A::Scalar],
) -> A::Scalar {
    row.zip(vector).fold(field.integer(0), |sum, (a, b)| {
        field.add(sum, field.mul(a, *b))
    })
}

/// Tangent vectors of D at a fixed time, in positions and independent velocities.
#[derive(Debug, Clone)]
pub(super) struct Tangents {
    /// `eta^a(qdot) + eta^a_0`. The expansions must contain them.
    pub(super) residuals: Vec<ExprId>,
    /// Indices of the dependent velocities.
    dependent: Vec<usize>,
    /// The number of coordinates.
    coordinates: usize,
    is_first_order: bool,
    /// True if vectors are tangent to the leaves of integrable constraints: `eta^a(v) = 0` for their position part `v`.
    pub(super) is_along_leaves: bool,
}

impl Tangents {
    /// Tangent vectors of a model; `None` if no state was found at which the constraints are independent.
    pub(super) fn of(model: &mut Model, dynamics: &Dynamics) -> Option<Self> {
        let velocities: Vec<SymbolId> = (model.coordinates.iter())
            .map(|coordinate| coordinate.qdot)
            .collect();
        let mut residuals = Vec::new();
        for constraint in model.constraints.clone() {
            let mut terms = vec![constraint.affine];
            for (entry, symbol) in constraint.form.iter().zip(&velocities) {
                let velocity = model.pool.variable(*symbol);
                terms.push(model.pool.mul(*entry, velocity));
            }
            residuals.push(model.pool.sum(&terms));
        }
        let is_first_order = model.is_first_order();
        let dependent = match is_first_order || model.constraints.is_empty() {
            true => Vec::new(),
            false => (0..ATTEMPTS).find_map(|attempt| {
                let (_, mut point) = state_on_d(model, dynamics, &dynamics.roots(), attempt)?;
                dependent(model, dynamics, &mut point)
            })?,
        };
        Some(Self {
            residuals,
            dependent,
            coordinates: model.coordinates.len(),
            is_first_order,
            is_along_leaves: false,
        })
    }

    /// Tangent vectors of the states. Under position equations alone they are those along the leaves. True if there are
    /// other constraints beside position equations: some vectors then lead to positions that break the equations.
    pub(super) fn of_states(model: &mut Model, dynamics: &Dynamics) -> Option<(Self, bool)> {
        let tangents = Self::of(model, dynamics)?;
        let of_positions = model.constraints.iter().filter(|it| it.is_of_positions);
        Some(match of_positions.count() {
            0 => (tangents, false),
            count if count == model.constraints.len() => (tangents.along_leaves(), false),
            _ => (tangents, true),
        })
    }

    /// The same vectors with dependent velocities chosen at a wall, where those of the interior may be singular.
    pub(super) fn at_wall(&self, model: &Model, around: &Surroundings<'_>, wall: &Wall) -> Self {
        if self.dependent.is_empty() {
            return self.clone();
        }
        let found = (0..ATTEMPTS).find_map(|attempt| {
            let roots = around.dynamics.roots();
            let (_, mut point): (_, RealPoint) =
                wall.incoming(model, around.dynamics, attempt, roots)?;
            dependent(model, around.dynamics, &mut point)
        });
        Self {
            dependent: found.unwrap_or_else(|| self.dependent.clone()),
            ..self.clone()
        }
    }

    /// Tangent vectors of the leaves of integrable constraints: positions are dependent wherever velocities are.
    pub(super) fn along_leaves(&self) -> Self {
        Self {
            is_along_leaves: true,
            ..self.clone()
        }
    }

    /// Text after the name of a form: the states to which the vectors belong.
    pub(super) fn place(&self) -> &'static str {
        match self.is_along_leaves {
            true => " on the leaves of the constraints",
            false => "",
        }
    }

    /// Number of tangent vectors.
    pub(super) fn dimension(&self) -> usize {
        match self.is_first_order {
            true => self.coordinates,
            false => self.positions().count() + self.coordinates - self.dependent.len(),
        }
    }

    /// Index of the first vector of a velocity. Vectors of positions come first.
    pub(super) fn first_velocity(&self) -> usize {
        self.positions().count()
    }

    /// Indices of the independent positions.
    fn positions(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.coordinates).filter(|i| !self.is_along_leaves || !self.dependent.contains(i))
    }

    fn independent(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.coordinates).filter(|i| !self.is_first_order && !self.dependent.contains(i))
    }

    /// Names of the vectors.
    pub(super) fn names(&self, model: &Model) -> Vec<String> {
        let name = |i: usize| &model.coordinates[i].name.display;
        let positions = self.positions();
        let positions = positions.map(|i| format!("partial({})", name(i)));
        let velocities = self
            .independent()
            .map(|i| format!("partial(dot({}))", name(i)));
        positions.chain(velocities).collect()
    }

    /// The vectors, with components for positions, velocities and time; `None` if the dependent velocities are not
    /// determined.
    pub(super) fn vectors<A: Arithmetic>(
        &self,
        field: A,
        expansions: &Expansions,
        values: &[A::Scalar],
    ) -> Option<Vec<Vec<A::Scalar>>> {
        let n = self.coordinates;
        let mut vectors = Vec::new();
        for place in self.positions().chain(self.independent().map(|i| n + i)) {
            let mut vector = vec![field.integer(0); 2 * n + 1];
            vector[place] = field.integer(1);
            vectors.push(vector);
        }
        let residuals = self.residuals.iter();
        if self.is_along_leaves {
            let form = |residual: &ExprId, vector: &Vec<A::Scalar>| {
                let entries = expansions.slopes(*residual)[n..].iter();
                let entries = entries.map(|entry| values[entry.index()]);
                inner(field, entries, &vector[..n])
            };
            let lacking = residuals.clone().map(|residual| {
                vectors
                    .iter()
                    .map(|vector| form(residual, vector))
                    .collect()
            });
            let lacking = lacking.collect();
            self.complete(field, expansions, values, &mut vectors, 0, lacking)?;
        }
        let lacking = residuals.map(|residual| {
            let along = |vector| expansions.along(field, values, *residual, vector);
            vectors.iter().map(|vector| along(vector)).collect()
        });
        let lacking = lacking.collect();
        self.complete(field, expansions, values, &mut vectors, n, lacking)?;
        Some(vectors)
    }

    /// Sets the dependent components of vectors, at indices `first + j`, so that the residuals vanish along them.
    /// `lacking`: residuals along the vectors while these components are 0, one row per residual.
    fn complete<A: Arithmetic>(
        &self,
        field: A,
        expansions: &Expansions,
        values: &[A::Scalar],
        vectors: &mut [Vec<A::Scalar>],
        first: usize,
        lacking: Vec<Vec<A::Scalar>>,
    ) -> Option<()> {
        if self.dependent.is_empty() {
            return Some(());
        }
        let n = self.coordinates;
        let space = JetSpace::new(0, 0, 1)?;
        let jets = Jets::new(field, &space);
        let minor: Matrix<A> = (self.residuals.iter())
            .map(|residual| {
                let slopes = expansions.slopes(*residual);
                let entry = |j: &usize| jets.constant(values[slopes[n + j].index()]);
                self.dependent.iter().map(entry).collect()
            })
            .collect();
        let right = lacking.into_iter().map(|row| {
            let row = row.into_iter().map(|value| jets.constant(value));
            row.collect()
        });
        let solved = solve(&jets, minor, right.collect())?.unknowns;
        for (j, row) in self.dependent.iter().zip(&solved) {
            for (vector, entry) in vectors.iter_mut().zip(row) {
                vector[first + j] = field.neg(jets.value(entry));
            }
        }
        Some(())
    }
}

/// Indices of the dependent velocities at a real state.
fn dependent(model: &Model, dynamics: &Dynamics, point: &mut RealPoint) -> Option<Vec<usize>> {
    let [forms, _] = dynamics.equations();
    let roots: Vec<ExprId> = forms.iter().flatten().copied().collect();
    let values: Vec<f64> = RealPoint::values(point, &model.pool, &model.pool.reachable(&roots))?;
    let space = JetSpace::new(0, 0, 1)?;
    let jets = Jets::new(Reals, &space);
    let row = |row: &Vec<ExprId>| {
        let entries = row.iter().take(model.coordinates.len());
        let entries = entries.map(|id| jets.constant(values[id.index()]));
        entries.collect()
    };
    choose_dependent(&jets, &forms.iter().map(row).collect())
}

/// A form on all tangent vectors: the value of each coefficient, with the rows of its differentials.
#[derive(Debug)]
pub(super) struct Products<S> {
    products: Vec<(S, Vec<Vec<S>>)>,
}

/// Components of a form.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Part {
    /// All of them, added up with random weights of this seed.
    All(u64),
    /// The component on these tangent vectors.
    One(Vec<usize>),
}

impl<S: Copy> Products<S> {
    pub(super) fn new() -> Self {
        Self {
            products: Vec::new(),
        }
    }

    pub(super) fn push(&mut self, coefficient: S, rows: Vec<Vec<S>>) {
        self.products.push((coefficient, rows));
    }

    /// The component on the vectors with the indices `places`.
    pub(super) fn component<A: Arithmetic<Scalar = S>>(
        &self,
        field: A,
        places: &[usize],
    ) -> Option<S> {
        let mut sum = field.integer(0);
        for (coefficient, rows) in &self.products {
            let row = |row: &Vec<S>| places.iter().map(|place| row[*place]).collect();
            let minor: Vec<Vec<S>> = rows.iter().map(row).collect();
            sum = field.add(sum, field.mul(*coefficient, determinant(field, &minor)?));
        }
        Some(sum)
    }

    /// The rows of the differentials of a form that is one product.
    pub(super) fn only_rows(mut self) -> Option<Vec<Vec<S>>> {
        let (_, rows) = self.products.pop()?;
        self.products.is_empty().then_some(rows)
    }

    /// The component, or the weighted sum of components, that `part` names.
    pub(super) fn total<A: Arithmetic<Scalar = S>>(
        &self,
        field: A,
        part: &Part,
        (dimension, degree): (usize, usize),
    ) -> Option<S> {
        let seed = match part {
            Part::One(places) => return self.component(field, places),
            Part::All(seed) => *seed,
        };
        let mut sum = field.integer(0);
        for (index, places) in choices(dimension, degree).iter().enumerate() {
            let weight = field.integer(weight(seed, index as u64));
            sum = field.add(sum, field.mul(weight, self.component(field, places)?));
        }
        Some(sum)
    }
}

impl Products<f64> {
    /// Scale of the components, for comparison with rounding errors.
    pub(super) fn size(&self) -> f64 {
        let largest = |row: &Vec<f64>| {
            row.iter()
                .fold(1.0, |size: f64, entry| size.max(entry.abs()))
        };
        let each = self.products.iter().map(|(coefficient, rows)| {
            coefficient.abs() * rows.iter().map(largest).product::<f64>()
        });
        each.sum()
    }
}

/// Probability that random weights hide a component.
pub(super) const CHANCE: f64 = 1.0 / (1_u64 << 60) as f64;

/// A random weight below `2^60` (splitmix64).
pub(super) fn weight(seed: u64, index: u64) -> i64 {
    let mut z = seed.wrapping_add((index + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 4) as i64
}

/// All increasing choices of `degree` indices below `dimension`, in lexicographic order.
pub(super) fn choices(dimension: usize, degree: usize) -> Vec<Vec<usize>> {
    let mut found: Vec<Vec<usize>> = vec![Vec::new()];
    for _ in 0..degree {
        let longer = found.iter().flat_map(|start| {
            let first = start.last().map_or(0, |last| last + 1);
            (first..dimension).map(move |next| {
                let mut longer = start.clone();
                longer.push(next);
                longer
            })
        });
        found = longer.collect();
    }
    found
}

/// True if a form has too many components, or determinants too large, to be examined.
pub(super) fn is_too_large(dimension: usize, degree: usize) -> bool {
    let mut count: usize = 1;
    for step in 0..degree.min(dimension) {
        count = count.saturating_mul(dimension - step) / (step + 1);
    }
    degree > super::minors::LARGEST || count.saturating_mul(1 << degree) > LARGEST
}

/// A form with its expressions mapped by `explicit`.
pub(super) fn written_out(
    form: &ExteriorForm,
    mut explicit: impl FnMut(ExprId) -> Option<ExprId>,
) -> Option<ExteriorForm> {
    let mut form = form.clone();
    for term in &mut form.terms {
        term.coefficient = explicit(term.coefficient)?;
        for differential in &mut term.differentials {
            *differential = explicit(*differential)?;
        }
    }
    Some(form)
}

/// A form of a first-order system with velocities replaced by `rates`.
pub(super) fn with_rates(model: &mut Model, form: ExteriorForm, rates: &[ExprId]) -> ExteriorForm {
    let velocities = model.coordinates.iter().map(|coordinate| coordinate.qdot);
    let replacements: Vec<_> = velocities.zip(rates.iter().copied()).collect();
    let pool = &mut model.pool;
    let replaced = written_out(&form, |id| Some(pool.substitute(id, &replacements)));
    replaced.unwrap_or(form)
}

/// A form with energy, momenta and rates written out.
pub(super) fn explicit_form(model: &mut Model, form: &ExteriorForm) -> ExteriorForm {
    let found = written_out(form, |id| Some(explicit(model, id)));
    let found = found.unwrap_or_else(|| form.clone());
    match model.field.clone() {
        Some(rates) => with_rates(model, found, &rates),
        None => found,
    }
}

/// Accelerations from the equations of motion at the velocities of a point, as series.
pub(super) fn accelerations<A: Arithmetic>(
    jets: &Jets<'_, A>,
    equations: [&[Vec<ExprId>]; 2],
    series: &dyn Fn(ExprId) -> Series<A>,
) -> Option<Vec<Series<A>>> {
    let [forms, rows] = equations.map(|rows| -> Matrix<A> {
        let row = |row: &Vec<ExprId>| row.iter().map(|id| series(*id)).collect();
        rows.iter().map(row).collect()
    });
    let (curvature, rows) = rows.split_last()?;
    let [accelerations, _] = super::dynamics::accelerate(jets, rows.to_vec(), &forms, curvature)?;
    Some(accelerations)
}

/// Constant series of the values at a point, by expression.
pub(super) fn constants<'c, P: ExpansionPoint>(
    jets: &'c Jets<'_, P::Field>,
    values: &'c [Number<P>],
) -> impl Fn(ExprId) -> Series<P::Field> + 'c {
    |id| jets.constant(values[id.index()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_all_and_in_order() {
        assert_eq!(choices(3, 2), [[0, 1], [0, 2], [1, 2]]);
        assert_eq!(choices(4, 4), [[0, 1, 2, 3]]);
        assert_eq!(choices(2, 3), Vec::<Vec<usize>>::new());
        assert!(is_too_large(40, 10) && !is_too_large(10, 5));
    }

    #[test]
    fn components_are_determinants() {
        let mut products = Products::new();
        products.push(2.0, vec![vec![1.0, 2.0, 3.0], vec![0.0, 1.0, 4.0]]);
        products.push(-1.0, vec![vec![0.0, 1.0, 1.0], vec![1.0, 1.0, 0.0]]);
        assert_eq!(products.component(Reals, &[0, 1]), Some(2.0 + 1.0));
        assert_eq!(products.component(Reals, &[1, 2]), Some(10.0 + 1.0));
        let one = Part::One(vec![0, 2]);
        assert_eq!(products.total(Reals, &one, (3, 2)), Some(8.0 + 1.0));
        let all = products.total(Reals, &Part::All(7), (3, 2));
        assert!(all.is_some_and(|sum| sum > 1e15), "{all:?}");
    }
}
