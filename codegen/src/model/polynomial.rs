//! Polynomials in one variable with rational coefficients: repeated factors by Euclid's algorithm, real roots by
//! Sturm's theorem.

use dalembert_expr::Rational;

/// The coefficients, lowest degree first. The last one is not 0; the polynomial 0 has none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Polynomial(Vec<Rational>);

impl Polynomial {
    fn new(mut coefficients: Vec<Rational>) -> Self {
        while coefficients.last().is_some_and(Rational::is_zero) {
            coefficients.pop();
        }
        Self(coefficients)
    }

    /// The polynomial of least degree with these values at 0, 1, 2, ..: the sum of `delta^k f(0) * binomial(s, k)`.
    pub(super) fn through(values: &[Rational]) -> Self {
        let mut differences = values.to_vec();
        let mut binomial = vec![Rational::ONE];
        let mut sum = vec![Rational::ZERO; values.len()];
        for k in 0..values.len() {
            for (entry, factor) in sum.iter_mut().zip(&binomial) {
                *entry = &*entry + &(&differences[0] * factor);
            }
            differences = differences
                .windows(2)
                .map(|pair| &pair[1] - &pair[0])
                .collect();
            binomial = next_binomial(&binomial, k);
        }
        Self::new(sum)
    }

    /// The degree; 0 for constants.
    pub(super) fn degree(&self) -> usize {
        self.0.len().saturating_sub(1)
    }

    /// The greatest common divisor with the derivative. Its roots are the multiple roots.
    pub(super) fn repeated_factor(&self) -> Self {
        self.common_factor(self.derivative())
    }

    fn common_factor(&self, other: Self) -> Self {
        let (mut left, mut right) = (self.clone(), other);
        while !right.0.is_empty() {
            let (_, rest) = left.divided_by(&right);
            left = right;
            right = rest.monic();
        }
        left
    }

    /// True if there is a real root strictly between `low` and `high`. A missing end is infinite.
    pub(super) fn has_root_between(&self, low: Option<&Rational>, high: Option<&Rational>) -> bool {
        if self.degree() == 0 {
            return false;
        }
        let (simple, _) = self.divided_by(&self.repeated_factor());
        let chain = simple.sturm_chain();
        // Sturm counts the roots in `(low, high]`.
        let count = sign_changes(&chain, low, -1) - sign_changes(&chain, high, 1);
        let at_end = high.is_some_and(|high| simple.value(high).is_zero());
        count - i64::from(at_end) > 0
    }

    fn sturm_chain(&self) -> Vec<Self> {
        let mut chain = vec![self.clone(), self.derivative()];
        while let [.., before, last] = chain.as_slice() {
            if last.degree() == 0 {
                break;
            }
            let (_, rest) = before.divided_by(last);
            // A positive factor changes no sign, and keeps the numbers short.
            chain.push(rest.negated_monic());
        }
        chain
    }

    fn derivative(&self) -> Self {
        let powers = (1_i64..).zip(self.0.iter().skip(1));
        Self::new(
            powers
                .map(|(power, factor)| factor * &Rational::from(power))
                .collect(),
        )
    }

    fn value(&self, at: &Rational) -> Rational {
        let horner = |sum: Rational, factor: &Rational| &(&sum * at) + factor;
        self.0.iter().rev().fold(Rational::ZERO, horner)
    }

    /// Quotient and remainder. The divisor is not 0.
    fn divided_by(&self, divisor: &Self) -> (Self, Self) {
        let mut rest = self.0.clone();
        let mut quotient = Vec::new();
        let leading = divisor.0.last().and_then(Rational::recip);
        let Some(leading) = leading else {
            return (Self::new(quotient), self.clone());
        };
        while rest.len() >= divisor.0.len() {
            let offset = rest.len() - divisor.0.len();
            let factor = rest.last().map_or(Rational::ZERO, |last| last * &leading);
            for (entry, other) in rest[offset..].iter_mut().zip(&divisor.0) {
                *entry = &*entry - &(&factor * other);
            }
            rest.pop();
            quotient.push(factor);
        }
        quotient.reverse();
        (Self::new(quotient), Self::new(rest))
    }

    fn scaled(&self, factor: &Rational) -> Self {
        Self::new(self.0.iter().map(|entry| entry * factor).collect())
    }

    fn monic(&self) -> Self {
        let leading = self.0.last().and_then(Rational::recip);
        leading.map_or_else(|| self.clone(), |leading| self.scaled(&leading))
    }

    /// Minus this polynomial, divided by the absolute value of its leading coefficient.
    fn negated_monic(&self) -> Self {
        let leading = self
            .0
            .last()
            .map(Rational::abs)
            .and_then(|size| size.recip());
        leading.map_or_else(|| self.clone(), |leading| self.scaled(&-leading))
    }

    /// The sign at `at`; without a number, at infinity with the sign of `beyond`.
    fn sign_at(&self, at: Option<&Rational>, beyond: i64) -> i64 {
        let value = match at {
            Some(at) => self.value(at),
            None => {
                let leading = self.0.last().cloned().unwrap_or(Rational::ZERO);
                let turned = beyond < 0 && self.degree() % 2 == 1;
                if turned { -leading } else { leading }
            }
        };
        i64::from(value.is_positive()) - i64::from(value.is_negative())
    }
}

/// `binomial(s, k + 1)` from `binomial(s, k)`: times `(s - k)/(k + 1)`.
fn next_binomial(binomial: &[Rational], k: usize) -> Vec<Rational> {
    let k = i64::try_from(k).unwrap_or(i64::MAX - 1);
    let scale = Rational::new(1, k + 1);
    let mut next = vec![Rational::ZERO; binomial.len() + 1];
    for (power, factor) in binomial.iter().enumerate() {
        next[power + 1] = &next[power + 1] + &(factor * &scale);
        next[power] = &next[power] - &(&(factor * &scale) * &Rational::from(k));
    }
    next
}

fn sign_changes(chain: &[Polynomial], at: Option<&Rational>, beyond: i64) -> i64 {
    let signs: Vec<i64> = chain
        .iter()
        .map(|polynomial| polynomial.sign_at(at, beyond))
        .filter(|sign| *sign != 0)
        .collect();
    let changes = signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
    i64::try_from(changes).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(coefficients: &[i64]) -> Polynomial {
        Polynomial::new(coefficients.iter().map(|c| Rational::from(*c)).collect())
    }

    #[test]
    fn values_determine_the_polynomial() {
        let cubic = polynomial(&[3, -1, 0, 2]);
        let values: Vec<Rational> = (0..6).map(|s| cubic.value(&Rational::from(s))).collect();
        assert_eq!(Polynomial::through(&values), cubic);
        assert_eq!(Polynomial::through(&values[..0]), polynomial(&[]));
    }

    #[test]
    fn repeated_factors_are_found() {
        // (s - 1)^2 (s + 2)
        let repeated = polynomial(&[2, -3, 0, 1]).repeated_factor();
        assert_eq!(repeated.monic(), polynomial(&[-1, 1]));
        assert_eq!(polynomial(&[-1, 0, 1]).repeated_factor().degree(), 0);
        // (s^2 + 1)^2
        let square = polynomial(&[1, 0, 2, 0, 1]).repeated_factor();
        assert_eq!(square.monic(), polynomial(&[1, 0, 1]));
    }

    #[test]
    fn real_roots_are_counted_between_ends() {
        let [zero, one, two] = [0, 1, 2].map(Rational::from);
        let root_of_two = polynomial(&[-2, 0, 1]);
        assert!(root_of_two.has_root_between(None, None));
        assert!(root_of_two.has_root_between(Some(&one), Some(&two)));
        assert!(!root_of_two.has_root_between(Some(&zero), Some(&one)));
        assert!(!polynomial(&[1, 1, 1]).has_root_between(None, None));
        // s^2 (s - 1)^2: the ends do not count.
        let square = polynomial(&[0, 0, 1, -2, 1]);
        assert!(!square.has_root_between(Some(&zero), Some(&one)));
        assert!(square.has_root_between(Some(&zero), Some(&two)));
        assert!(square.has_root_between(None, Some(&one)));
        assert!(!polynomial(&[5]).has_root_between(None, None));
    }
}
