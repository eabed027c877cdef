//! Closure of the demands under brackets: the rank of the distribution's hull, with and without the demands.
//!
//! A demand is a pair `(X, c)`: a density `exp(G)` must satisfy `X(G) = c`. The bracket of two demands is
//! `[(X, c), (Y, d)] = ([X, Y], X(d) - Y(c))`. A local density exists iff the closed set of pairs has the rank of its
//! vector parts: the demands are then those of a function on every leaf (Frobenius). Only brackets of generators with
//! elements that raised the rank of the pairs in the previous step can be new.

use dalembert_expr::{Arithmetic, Jets, Modulus};

use super::frame::Demand;

/// Origin of an element of the hull.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    /// A generator.
    Generator(usize),
    /// The bracket of a generator with an element.
    Bracket(usize, usize),
}

/// The hull of a set of generators at a point.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Hull {
    /// The rank of the vector parts at each depth of brackets, beginning with the generators alone.
    pub(super) growth: Vec<usize>,
    /// The rank of the vector parts.
    pub(super) rank: usize,
    /// The rank of the pairs.
    pub(super) extended_rank: usize,
    /// The elements that are independent as pairs.
    pub(super) elements: Vec<Origin>,
    /// The elements whose vector parts are independent.
    pub(super) basis: Vec<usize>,
    /// The first element that is independent as a pair but not as a vector.
    pub(super) obstruction: Option<usize>,
    /// True if no bracket leads out of the hull, or if an obstruction ended the closure (see [`Until`]). False if the
    /// order of the series was too small to finish.
    pub(super) is_closed: bool,
}

/// Elimination, one row at a time.
struct Echelon {
    field: Modulus,
    width: usize,
    /// Reduced rows with their pivot columns.
    rows: Vec<(usize, Vec<u64>)>,
}

impl Echelon {
    fn new(field: Modulus, width: usize) -> Self {
        Self {
            field,
            width,
            rows: Vec::new(),
        }
    }

    /// Keeps a row that is independent of the rows before it; false if it depends on them.
    fn push(&mut self, row: &[u64]) -> bool {
        let mut row = row[..self.width].to_vec();
        for (pivot, known) in &self.rows {
            let factor = row[*pivot];
            if factor != 0 {
                for (entry, known) in row.iter_mut().zip(known) {
                    *entry = self.field.sub(*entry, self.field.mul(factor, *known));
                }
            }
        }
        let Some(pivot) = row.iter().position(|entry| *entry != 0) else {
            return false;
        };
        let Some(inverse) = self.field.inv(row[pivot]) else {
            return false;
        };
        row.iter_mut()
            .for_each(|entry| *entry = self.field.mul(inverse, *entry));
        self.rows.push((pivot, row));
        true
    }
}

/// Condition that ends the closure of a hull.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Until {
    /// No bracket leads out of the hull.
    Closed,
    /// An obstruction was found. The ranks may then be too small, but they differ.
    Obstructed,
}

/// Closes generators whose series have the order of `jets`.
pub(super) fn close(
    mut jets: Jets<'_, Modulus>,
    variables: &[usize],
    generators: &[Demand<Modulus>],
    until: Until,
) -> Hull {
    let width = generators.first().map_or(1, Vec::len);
    let mut vectors = Echelon::new(jets.field, width - 1);
    let mut pairs = Echelon::new(jets.field, width);
    let mut hull = Hull {
        growth: Vec::new(),
        rank: 0,
        extended_rank: 0,
        elements: Vec::new(),
        basis: Vec::new(),
        obstruction: None,
        is_closed: false,
    };
    let mut add = |hull: &mut Hull, origin: Origin, values: &[u64]| {
        if !pairs.push(values) {
            return false;
        }
        let position = hull.elements.len();
        hull.elements.push(origin);
        if vectors.push(values) {
            hull.basis.push(position);
        } else {
            hull.obstruction.get_or_insert(position);
        }
        true
    };
    let mut new: Vec<(usize, Demand<Modulus>)> = Vec::new();
    for (i, generator) in generators.iter().enumerate() {
        if add(&mut hull, Origin::Generator(i), &values(&jets, generator)) {
            new.push((hull.elements.len() - 1, generator.clone()));
        }
    }
    hull.growth.push(hull.basis.len());
    let is_done = |hull: &Hull| until == Until::Obstructed && hull.obstruction.is_some();
    while !new.is_empty() && hull.elements.len() < width && !is_done(&hull) {
        if jets.order() == 0 {
            hull.rank = hull.basis.len();
            hull.extended_rank = hull.elements.len();
            return hull;
        }
        let candidates = std::mem::take(&mut new);
        for (i, generator) in generators.iter().enumerate() {
            for (position, element) in &candidates {
                let bracket = bracket(&jets, variables, generator, element);
                let origin = Origin::Bracket(i, *position);
                if add(&mut hull, origin, &values(&jets, &bracket)) {
                    new.push((hull.elements.len() - 1, bracket));
                }
            }
        }
        jets = jets.lower();
        hull.growth.push(hull.basis.len());
    }
    hull.rank = hull.basis.len();
    hull.extended_rank = hull.elements.len();
    hull.is_closed = true;
    hull
}

fn values<A: Arithmetic>(jets: &Jets<'_, A>, element: &Demand<A>) -> Vec<A::Scalar> {
    element.iter().map(|series| jets.value(series)).collect()
}

/// `([X, Y], X(d) - Y(c))`, one order below that of `jets`. `variables` are the components that series depend on.
pub(super) fn bracket<A: Arithmetic>(
    jets: &Jets<'_, A>,
    variables: &[usize],
    x: &Demand<A>,
    y: &Demand<A>,
) -> Demand<A> {
    let lower = jets.lower();
    (0..x.len())
        .map(|i| {
            let mut slopes = Vec::with_capacity(2 * variables.len());
            for (v, k) in variables.iter().enumerate() {
                let minus = jets.field.integer(-1);
                slopes.push((&x[*k], jets.derivative(&y[i], v)));
                slopes.push((&y[*k], jets.scale(minus, &jets.derivative(&x[i], v))));
            }
            lower.dot(slopes.iter().map(|(a, b)| (a.as_slice(), b.as_slice())))
        })
        .collect()
}
