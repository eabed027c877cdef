//! Test functions: numbers along a branch that change sign at bifurcations.

use super::family::{Failure, Node};
use super::{Bifurcation, Stability};
use crate::linear::determinant;
use dalembert::math::larger;

/// Distances below which numbers along a branch count as equal. They depend on the tolerance of the integrator: the
/// error of a simple multiplier is about the tolerance, the error of a double multiplier about the square root of the
/// tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Precision {
    /// Distance from the unit circle at which multipliers count as lying on it.
    on_circle: f64,
    /// Bound for the ends of a step. Smaller factors of test functions count as 0 along the whole step and are left
    /// out, for example factors of conserved quantities.
    always: f64,
    /// Bound for a single member, where a factor that changes sign along the branch may be small.
    within: f64,
    /// Largest distance of a multiplier or of the direction from its exact value, at an accepted bifurcation.
    near: f64,
}

impl Precision {
    /// Largest value that counts as 0, for a test function of slope 1.
    pub const fn zero(&self) -> f64 {
        1e-3 * self.on_circle
    }

    /// A narrow and a wide margin of the unit circle, beyond which multipliers count as outside.
    pub const fn margins(&self) -> [f64; 2] {
        [self.always, self.on_circle]
    }

    /// The distances for a tolerance. They do not decrease below a tolerance of 1e-14.
    pub fn of(tolerance: f64) -> Self {
        let on_circle = f64::max(1e-6, 10.0 * tolerance.sqrt());
        Self {
            on_circle,
            always: f64::max(1e-9, 1e5 * tolerance),
            within: f64::max(1e-13, 10.0 * tolerance),
            near: f64::max(1e-4, on_circle),
        }
    }
}

/// A test function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Test {
    /// The component of the direction along the parameter.
    Rise,
    /// The determinant of the derivative bordered by the direction.
    Crossing,
    /// The product of `m + 1` over all multipliers `m`.
    Flip,
    /// The product of `m n - 1` over all pairs of multipliers.
    Circle,
}

impl Test {
    /// All test functions.
    pub const ALL: [Self; 4] = [Self::Rise, Self::Crossing, Self::Flip, Self::Circle];

    /// The bifurcation at a zero.
    pub const fn bifurcation(self) -> Bifurcation {
        match self {
            Self::Rise => Bifurcation::Fold,
            Self::Crossing => Bifurcation::BranchPoint,
            Self::Flip => Bifurcation::Flip,
            Self::Circle => Bifurcation::NeimarkSacker,
        }
    }

    /// Largest number of multipliers that cross the unit circle at a zero.
    pub const fn passing(self) -> usize {
        match self {
            Self::Circle => 2,
            Self::Rise | Self::Crossing | Self::Flip => 1,
        }
    }

    /// The values at both ends of a step, if a bifurcation lies between them.
    ///
    /// # Errors
    /// [`Failure::NotKnown`] if one of them is NaN.
    pub fn change(
        self,
        ends: [&Node; 2],
        width: f64,
        precision: Precision,
    ) -> Result<Option<[f64; 2]>, Failure> {
        // If orbits form a family at a constant parameter, the determinant is 0 everywhere.
        if self == Self::Crossing && ends.iter().all(|node| node.dimension > 1) {
            return Ok(None);
        }
        let values = ends.map(|node| self.value_above(precision.always, node, width));
        if values.iter().any(|value| value.is_nan()) {
            return Err(Failure::NotKnown);
        }
        let changes = values[0].is_sign_negative() != values[1].is_sign_negative();
        Ok(changes.then_some(values))
    }

    /// Number of factors that are 0 along the whole step, for example those of conserved quantities.
    pub fn constant(self, ends: [&Node; 2], precision: Precision) -> usize {
        let is_zero = |factor: &[f64; 2]| modulus(factor) < precision.always;
        let counts = ends.map(|node| self.factors(node).iter().filter(|it| is_zero(it)).count());
        counts[0].min(counts[1])
    }

    /// The value at a member between the ends of a step, without this number of its smallest factors.
    pub fn value(self, node: &Node, width: f64, constant: usize) -> f64 {
        self.value_of(node, width, |factors| {
            factors.sort_by(|one, other| modulus(one).total_cmp(&modulus(other)));
            factors.drain(..constant.min(factors.len()));
        })
    }

    /// The value at a member, without factors below `least`.
    fn value_above(self, least: f64, node: &Node, width: f64) -> f64 {
        self.value_of(node, width, |factors| {
            let is_small = |factor: &[f64; 2]| modulus(factor) < least;
            factors.retain(|factor| !is_small(factor));
        })
    }

    /// The value at a member, with the factors that `choose` leaves.
    fn value_of(self, node: &Node, width: f64, choose: impl Fn(&mut Vec<[f64; 2]>)) -> f64 {
        match self {
            Self::Rise => node.rise(),
            Self::Crossing => {
                let mut columns = node.local.columns(width);
                for (column, entry) in columns.iter_mut().zip(&node.tangent) {
                    column.push(*entry);
                }
                determinant(columns)
            }
            Self::Flip | Self::Circle => {
                let mut factors = self.factors(node);
                choose(&mut factors);
                signed(&factors)
            }
        }
    }

    /// The factors of a product over multipliers.
    fn factors(self, node: &Node) -> Vec<[f64; 2]> {
        let multipliers = &node.local.member.multipliers;
        match self {
            Self::Rise | Self::Crossing => Vec::new(),
            Self::Flip => multipliers.iter().map(|&[re, im]| [re + 1.0, im]).collect(),
            Self::Circle => pairs(multipliers)
                .map(|[[a, b], [c, d]]| [a * c - b * d - 1.0, a * d + b * c])
                .collect(),
        }
    }

    /// True if a member at a zero is the bifurcation. Other causes of a zero: the product of two real multipliers
    /// passes 1, or near a crossing the member lies on the other branch and has another direction.
    pub fn is_met(self, node: &Node, precision: Precision) -> bool {
        let (near, on_circle) = (precision.near, precision.on_circle);
        let mut multipliers = node.local.member.multipliers.iter();
        match self {
            Self::Rise => node.rise().abs() < near,
            Self::Crossing => true,
            Self::Flip => multipliers.any(|&[re, im]| f64::hypot(re + 1.0, im) < near),
            Self::Circle => multipliers
                .any(|&[re, im]| im > on_circle && (f64::hypot(re, im) - 1.0).abs() < near),
        }
    }
}

/// True if a member counts as a bifurcation, or belongs to a family at a constant parameter.
pub(super) fn is_degenerate(node: &Node, tests: &[Test], width: f64, precision: Precision) -> bool {
    let is_zero = |test: &Test| {
        let value = test.value_above(precision.within, node, width);
        value.abs() < precision.on_circle && test.is_met(node, precision)
    };
    node.dimension > 1 || tests.iter().any(is_zero)
}

/// All pairs of multipliers with different indices.
fn pairs(multipliers: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
    let numbered = multipliers.iter().enumerate();
    numbered.flat_map(|(index, one)| {
        multipliers[index + 1..]
            .iter()
            .map(move |other| [*one, *other])
    })
}

/// The sign of the product of the factors, times their least modulus. The factors are real or come in conjugate pairs.
fn signed(factors: &[[f64; 2]]) -> f64 {
    factors.iter().fold(f64::INFINITY, |value, factor| {
        let [re, im] = *factor;
        let sign = if im == 0.0 && re < 0.0 { -1.0 } else { 1.0 };
        sign * value.signum() * -larger(-value.abs(), -modulus(factor))
    })
}

fn modulus(&[re, im]: &[f64; 2]) -> f64 {
    f64::hypot(re, im)
}

/// Number of multipliers outside the unit circle by more than a margin.
pub(super) fn outside(multipliers: &[[f64; 2]], margin: f64) -> usize {
    let moduli = multipliers.iter().map(|&[re, im]| f64::hypot(re, im));
    moduli.filter(|modulus| *modulus > 1.0 + margin).count()
}

/// The bifurcation that the multipliers near the unit circle indicate: the one farthest from 1 decides.
pub(super) fn passing(multipliers: &[[f64; 2]], precision: Precision) -> Option<Bifurcation> {
    let on_circle = multipliers
        .iter()
        .filter(|&&[re, im]| (f64::hypot(re, im) - 1.0).abs() < precision.near);
    let farthest = on_circle.min_by(|one, other| one[0].total_cmp(&other[0]))?;
    Some(match *farthest {
        [re, im] if im.abs() < precision.near && re < 0.0 => Bifurcation::Flip,
        [_, im] if im.abs() < precision.near => Bifurcation::BranchPoint,
        _ => Bifurcation::NeimarkSacker,
    })
}

/// The stability that follows from the multipliers; `None` if one of them is NaN.
pub(super) fn stability(multipliers: &[[f64; 2]], precision: Precision) -> Option<Stability> {
    if multipliers.iter().flatten().any(|part| part.is_nan()) {
        return None;
    }
    let moduli = multipliers.iter().map(|&[re, im]| f64::hypot(re, im));
    Some(match moduli.fold(0.0, larger) - 1.0 {
        excess if excess < -precision.on_circle => Stability::Stable,
        excess if excess <= precision.on_circle => Stability::Neutral,
        _ => Stability::Unstable,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_multiplier_that_is_no_number_leaves_the_stability_open() {
        let precision = Precision::of(1e-14);
        let known = |multipliers: &[[f64; 2]]| stability(multipliers, precision);
        assert_eq!(known(&[]), Some(Stability::Stable));
        assert_eq!(known(&[[0.5, 0.0], [0.1, 0.2]]), Some(Stability::Stable));
        assert_eq!(known(&[[1.0, 0.0], [0.1, 0.2]]), Some(Stability::Neutral));
        assert_eq!(known(&[[0.5, 0.0], [-1.5, 0.0]]), Some(Stability::Unstable));
        for place in 0..3 {
            let mut multipliers = [[0.5, 0.0]; 3];
            multipliers[place] = [f64::NAN, 0.0];
            assert_eq!(known(&multipliers), None);
            multipliers[place] = [0.0, f64::NAN];
            assert_eq!(known(&multipliers), None);
        }
    }

    #[test]
    fn distances_follow_the_tolerance() {
        let multipliers = [[1.0 + 1e-5, 0.0]];
        let at = |tolerance| stability(&multipliers, Precision::of(tolerance));
        assert_eq!(at(1e-14), Some(Stability::Unstable));
        assert_eq!(at(1e-10), Some(Stability::Neutral));
        assert_eq!(Precision::of(0.0), Precision::of(1e-14));
    }
}
