//! The monomials of a truncated series, in increasing degree, and their products.

use std::cell::OnceCell;

/// The monomials up to a degree in a number of variables.
///
/// Monomial 0 is 1, monomials `1..=variables` are the variables; degrees never decrease.
#[derive(Debug)]
pub struct JetSpace {
    variables: usize,
    order: usize,
    /// The position of the first monomial of each degree, and the number of all monomials.
    starts: Vec<usize>,
    /// Exponents, `variables` for each monomial.
    exponents: Vec<u8>,
    /// The degree of each monomial.
    degrees: Vec<usize>,
    /// A monomial of one degree less, and the variable that multiplies it to give this monomial.
    parents: Vec<(u32, u32)>,
    /// `raised[i * variables + v]`: the position of monomial i times variable v, below the last degree.
    raised: Vec<u32>,
    /// `rows[i][j]`: the position of the product of monomials i and j.
    rows: Vec<OnceCell<Box<[u32]>>>,
}

impl JetSpace {
    /// The monomials of degree `0..=order`; `None` if there are more than `limit`.
    pub fn new(variables: usize, order: usize, limit: usize) -> Option<Self> {
        let mut space = Self {
            variables,
            order,
            starts: vec![0, 1],
            exponents: vec![0; variables],
            degrees: vec![0],
            parents: vec![(0, 0)],
            raised: Vec::new(),
            rows: Vec::new(),
        };
        // The highest variable of each monomial. A monomial is multiplied only by this variable and later ones, so that
        // every product comes once.
        let mut highest = vec![0];
        for degree in 1..=order {
            for i in space.starts[degree - 1]..space.starts[degree] {
                for v in highest[i]..variables {
                    if space.parents.len() == limit {
                        return None;
                    }
                    let start = i * variables;
                    space.exponents.extend_from_within(start..start + variables);
                    let last = space.parents.len() * variables + v;
                    space.exponents[last] += 1;
                    space.parents.push((i as u32, v as u32));
                    space.degrees.push(degree);
                    highest.push(v);
                }
            }
            space.starts.push(space.parents.len());
        }
        space.fill_raised(&highest);
        space.rows = (0..space.len()).map(|_| OnceCell::new()).collect();
        Some(space)
    }

    /// Tabulates monomial i times variable v. If v is not below the highest variable of i, the product was constructed.
    /// Otherwise it is the parent of i times v, times the last variable of i.
    fn fill_raised(&mut self, highest: &[usize]) {
        let below = self.starts[self.order];
        self.raised = vec![0; below * self.variables];
        for k in 1..self.len() {
            let (i, v) = self.parents[k];
            self.raised[i as usize * self.variables + v as usize] = k as u32;
        }
        for i in 1..below {
            let (parent, last) = self.parents[i];
            for v in 0..highest[i] {
                let first = self.raised[parent as usize * self.variables + v] as usize;
                self.raised[i * self.variables + v] =
                    self.raised[first * self.variables + last as usize];
            }
        }
    }

    /// The number of variables.
    pub fn variables(&self) -> usize {
        self.variables
    }

    /// The highest degree.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The number of monomials.
    pub fn len(&self) -> usize {
        self.parents.len()
    }

    /// Always false: 1 is a monomial.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The number of monomials of degree `0..=order`.
    pub fn size(&self, order: usize) -> usize {
        self.starts[order + 1]
    }

    /// The degree of monomial i.
    pub(super) fn degree(&self, i: usize) -> usize {
        self.degrees[i]
    }

    /// The positions of the monomials of a degree.
    pub(super) fn grade(&self, degree: usize) -> std::ops::Range<usize> {
        self.starts[degree]..self.starts[degree + 1]
    }

    /// The exponent of variable v in monomial i.
    pub(super) fn exponent(&self, i: usize, v: usize) -> u8 {
        self.exponents[i * self.variables + v]
    }

    /// The position of monomial i, below the last degree, times variable v.
    pub(super) fn raise(&self, i: usize, v: usize) -> usize {
        self.raised[i * self.variables + v] as usize
    }

    /// The positions of the products of monomial i with the monomials `0, 1, ..`, as far as they are in the space.
    pub(super) fn row(&self, i: usize) -> &[u32] {
        self.rows[i].get_or_init(|| {
            let length = self.size(self.order - self.degrees[i]);
            let mut row = Vec::with_capacity(length);
            row.push(i as u32);
            for (parent, v) in &self.parents[1..length] {
                let product = row[*parent as usize] as usize * self.variables + *v as usize;
                row.push(self.raised[product]);
            }
            row.into()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn monomials_are_counted_by_binomials_and_multiply_by_adding_exponents() {
        for (variables, order, count) in [(1, 5, 6), (3, 4, 35), (5, 4, 126), (0, 3, 1)] {
            let space = JetSpace::new(variables, order, 1000).unwrap();
            assert_eq!(space.len(), count);
            let exponents = |i: usize| (0..variables).map(move |v| (i, v));
            for i in 0..space.len() {
                for (j, k) in space.row(i).iter().enumerate() {
                    for ((i, v), (k, _)) in exponents(i).zip(exponents(*k as usize)) {
                        let sum = space.exponent(i, v) + space.exponent(j, v);
                        assert_eq!(space.exponent(k, v), sum);
                    }
                }
            }
        }
    }

    #[test]
    fn a_space_that_would_be_too_large_is_refused() {
        assert!(JetSpace::new(8, 8, 12_870).is_some());
        assert!(JetSpace::new(8, 8, 12_869).is_none());
    }
}
