//! Differential forms on the states at one time: sums of `c df_1 ^ .. ^ df_k` with functions c and f of positions,
//! velocities and time.
//!
//! `energy` and momenta are kept as symbols. Sums, products with functions, wedge products and exterior derivatives
//! preserve this shape.

use dalembert_expr::{ExprId, Pool};

/// A sum of wedge products of the same degree.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExteriorForm {
    /// The degree.
    pub degree: usize,
    /// The terms. The form 0 has none.
    pub terms: Vec<Wedge>,
}

/// `c df_1 ^ .. ^ df_k`
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wedge {
    /// `c`
    pub coefficient: ExprId,
    /// The functions f, sorted by their ids, without repetition.
    pub differentials: Vec<ExprId>,
}

impl ExteriorForm {
    /// The zero form of a degree.
    pub fn zero(degree: usize) -> Self {
        Self {
            degree,
            terms: Vec::new(),
        }
    }

    /// A function as a form of degree 0.
    pub fn function(pool: &Pool, value: ExprId) -> Self {
        let term = Wedge {
            coefficient: value,
            differentials: Vec::new(),
        };
        Self::of(pool, 0, vec![term])
    }

    /// The differential of a function.
    pub fn differential(pool: &Pool, value: ExprId) -> Self {
        let term = Wedge {
            coefficient: pool.one(),
            differentials: vec![value],
        };
        Self::of(pool, 1, vec![term])
    }

    fn of(pool: &Pool, degree: usize, mut terms: Vec<Wedge>) -> Self {
        terms.retain(|term| !pool.is_syntactic_zero(term.coefficient));
        Self { degree, terms }
    }

    /// The sum with a form of the same degree.
    pub fn plus(mut self, pool: &mut Pool, other: Self) -> Self {
        for term in other.terms {
            let known = self
                .terms
                .iter_mut()
                .find(|known| known.differentials == term.differentials);
            match known {
                Some(known) => known.coefficient = pool.add(known.coefficient, term.coefficient),
                None => self.terms.push(term),
            }
        }
        Self::of(pool, self.degree, self.terms)
    }

    /// The product with a function.
    pub fn times(mut self, pool: &mut Pool, factor: ExprId) -> Self {
        for term in &mut self.terms {
            term.coefficient = pool.mul(term.coefficient, factor);
        }
        Self::of(pool, self.degree, self.terms)
    }

    /// The wedge product.
    pub fn wedge(&self, pool: &mut Pool, other: &Self) -> Self {
        let degree = self.degree + other.degree;
        let mut product = Self::zero(degree);
        for left in &self.terms {
            for right in &other.terms {
                let both = left.differentials.iter().chain(&right.differentials);
                let coefficient = pool.mul(left.coefficient, right.coefficient);
                if let Some(term) = sorted(pool, coefficient, both.copied().collect()) {
                    let term = Self::of(pool, degree, vec![term]);
                    product = product.plus(pool, term);
                }
            }
        }
        product
    }

    /// The exterior derivative.
    pub fn exterior(&self, pool: &mut Pool) -> Self {
        let degree = self.degree + 1;
        let mut sum = Self::zero(degree);
        for term in &self.terms {
            if pool.as_number(term.coefficient).is_some() {
                continue;
            }
            let mut differentials = vec![term.coefficient];
            differentials.extend(&term.differentials);
            let one = pool.one();
            if let Some(term) = sorted(pool, one, differentials) {
                let term = Self::of(pool, degree, vec![term]);
                sum = sum.plus(pool, term);
            }
        }
        sum
    }

    /// All functions and coefficients in the form.
    pub fn expressions(&self) -> impl Iterator<Item = ExprId> + '_ {
        let of = |term: &Wedge| {
            term.differentials
                .clone()
                .into_iter()
                .chain([term.coefficient])
        };
        self.terms.iter().flat_map(of)
    }
}

/// The wedge product with its differentials sorted, and the sign of the permutation in the coefficient; `None` if a
/// differential occurs twice.
fn sorted(pool: &mut Pool, coefficient: ExprId, mut differentials: Vec<ExprId>) -> Option<Wedge> {
    let mut is_odd = false;
    for end in (1..differentials.len()).rev() {
        for place in 0..end {
            if differentials[place] > differentials[place + 1] {
                differentials.swap(place, place + 1);
                is_odd = !is_odd;
            }
        }
    }
    if differentials.windows(2).any(|pair| pair[0] == pair[1]) {
        return None;
    }
    let coefficient = match is_odd {
        true => pool.neg(coefficient),
        false => coefficient,
    };
    Some(Wedge {
        coefficient,
        differentials,
    })
}

#[cfg(test)]
mod tests {
    use dalembert_expr::Assumption;

    use super::*;

    /// The forms `d(x)` and `d(y)`, and `x`.
    fn forms(pool: &mut Pool) -> ([ExteriorForm; 2], ExprId) {
        let [x, y] = ["x", "y"].map(|name| pool.symbol(name, name, Assumption::None));
        let [x, y] = [x, y].map(|symbol| pool.variable(symbol));
        ([x, y].map(|of| ExteriorForm::differential(pool, of)), x)
    }

    #[test]
    fn products_of_one_forms_change_their_sign_with_the_order() {
        let mut pool = Pool::default();
        let ([dx, dy], _) = forms(&mut pool);
        let [one, other] = [dx.wedge(&mut pool, &dy), dy.wedge(&mut pool, &dx)];
        assert_eq!(one.plus(&mut pool, other).terms, Vec::new());
        assert_eq!(dx.wedge(&mut pool, &dx).terms, Vec::new());
        let area = dx.wedge(&mut pool, &dy);
        assert_eq!(area.wedge(&mut pool, &dx).terms, Vec::new());
    }

    #[test]
    fn the_second_exterior_derivative_is_0() {
        let mut pool = Pool::default();
        let ([_, dy], x) = forms(&mut pool);
        let form = dy.times(&mut pool, x);
        let derivative = form.exterior(&mut pool);
        assert_eq!((derivative.degree, derivative.terms.len()), (2, 1));
        assert_eq!(derivative.exterior(&mut pool).terms, Vec::new());
    }
}
