//! Test functions: numbers along a branch that change their sign at bifurcations.

use super::family::Node;
use super::{Bifurcation, Stability};
use crate::linear::determinant;

/// Distance from the unit circle at which multipliers count as lying on it.
const ON_CIRCLE: f64 = 1e-6;

/// Factors of test functions below this at both ends of a step are 0 all along it, such as those of conserved quantities.
const ALWAYS: f64 = 1e-9;

/// The same between the ends, where a factor that passes 0 is as small.
const WITHIN: f64 = 1e-13;

/// Distance of the multipliers, and of the direction, of a located bifurcation from their values there.
const NEAR: f64 = 1e-4;

/// A test function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Test {
    /// The component of the direction in the parameter.
    Rise,
    /// Determinant of the derivative together with the direction.
    Crossing,
    /// Product of `m + 1` over all multipliers `m`.
    Flip,
    /// Product of `m n - 1` over all pairs of multipliers.
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

    /// Most multipliers that pass the unit circle at a zero.
    pub const fn passing(self) -> usize {
        match self {
            Self::Circle => 2,
            Self::Rise | Self::Crossing | Self::Flip => 1,
        }
    }

    /// The values at both ends of a step, if a bifurcation lies between them.
    pub fn change(self, ends: [&Node; 2], width: f64) -> Option<[f64; 2]> {
        // Where orbits are a family at a constant parameter the determinant is 0 everywhere.
        if self == Self::Crossing && ends.iter().all(|node| node.dimension > 1) {
            return None;
        }
        let values = ends.map(|node| self.value_above(ALWAYS, node, width));
        (values[0].is_sign_negative() != values[1].is_sign_negative()).then_some(values)
    }

    /// The value at a member between those ends.
    pub fn value(self, node: &Node, width: f64) -> f64 {
        self.value_above(WITHIN, node, width)
    }

    /// The value at a member, without factors below a bound.
    fn value_above(self, least: f64, node: &Node, width: f64) -> f64 {
        let multipliers = &node.local.member.multipliers;
        match self {
            Self::Rise => node.rise(),
            Self::Crossing => {
                let mut columns = node.local.columns(width);
                for (column, entry) in columns.iter_mut().zip(&node.tangent) {
                    column.push(*entry);
                }
                determinant(columns)
            }
            Self::Flip => signed(least, multipliers.iter().map(|&[re, im]| [re + 1.0, im])),
            Self::Circle => {
                let products =
                    pairs(multipliers).map(|[[a, b], [c, d]]| [a * c - b * d - 1.0, a * d + b * c]);
                signed(least, products)
            }
        }
    }

    /// True if a member is that of the bifurcation. The product of two real multipliers may pass 1 too, and beside a crossing
    /// a member of the other branch has another direction.
    pub fn is_met(self, node: &Node) -> bool {
        let mut multipliers = node.local.member.multipliers.iter();
        match self {
            Self::Rise => node.rise().abs() < NEAR,
            Self::Crossing => true,
            Self::Flip => multipliers.any(|&[re, im]| f64::hypot(re + 1.0, im) < NEAR),
            Self::Circle => multipliers
                .any(|&[re, im]| im > ON_CIRCLE && (f64::hypot(re, im) - 1.0).abs() < NEAR),
        }
    }
}

/// True if a member is a bifurcation up to rounding, or lies among a family.
pub(super) fn is_degenerate(node: &Node, width: f64) -> bool {
    let is_zero = |test: &Test| test.value(node, width).abs() < ON_CIRCLE && test.is_met(node);
    node.dimension > 1 || Test::ALL.iter().any(is_zero)
}

/// Pairs of different multipliers.
fn pairs(multipliers: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
    let numbered = multipliers.iter().enumerate();
    numbered.flat_map(|(index, one)| {
        multipliers[index + 1..]
            .iter()
            .map(move |other| [*one, *other])
    })
}

/// The sign of a product of complex numbers that are real or come in conjugate pairs, times the least modulus above a bound.
fn signed(least: f64, factors: impl Iterator<Item = [f64; 2]>) -> f64 {
    factors.fold(f64::INFINITY, |value, [re, im]| {
        let modulus = f64::hypot(re, im);
        if modulus < least {
            return value;
        }
        let sign = if im == 0.0 && re < 0.0 { -1.0 } else { 1.0 };
        sign * value.signum() * f64::min(value.abs(), modulus)
    })
}

/// Number of multipliers outside the unit circle.
pub(super) fn outside(multipliers: &[[f64; 2]]) -> usize {
    let moduli = multipliers.iter().map(|&[re, im]| f64::hypot(re, im));
    moduli.filter(|modulus| *modulus > 1.0 + ON_CIRCLE).count()
}

/// The stability by the multipliers.
pub(super) fn stability(multipliers: &[[f64; 2]]) -> Stability {
    let moduli = multipliers.iter().map(|&[re, im]| f64::hypot(re, im));
    match moduli.fold(0.0, f64::max) - 1.0 {
        excess if excess < -ON_CIRCLE => Stability::Stable,
        excess if excess <= ON_CIRCLE => Stability::Neutral,
        _ => Stability::Unstable,
    }
}
