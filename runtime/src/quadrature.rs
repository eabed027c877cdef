//! Integrals by Gauss-Legendre rules: line integrals of a gradient, for the logarithm of a density without closed form,
//! and integrals over steps.

use crate::error::Fault;
use crate::state::StateVector;

/// Nodes in `(0, 1)` below the midpoint and weights of the Gauss-Legendre rule of 16 points. The other nodes mirror
/// them.
pub(crate) const NODES: [(f64, f64); 8] = [
    (0.005_299_532_504_175_031, 0.013_576_229_705_877_047),
    (0.027_712_488_463_383_7, 0.031_126_761_969_323_95),
    (0.067_184_398_806_084_13, 0.047_579_255_841_246_39),
    (0.122_297_795_822_498_5, 0.062_314_485_627_766_94),
    (0.191_061_877_798_678_1, 0.074_797_994_408_288_37),
    (0.270_991_611_171_386_3, 0.084_578_259_697_501_27),
    (0.359_198_224_610_370_55, 0.091_301_707_522_461_79),
    (0.452_493_745_081_181_3, 0.094_725_305_227_534_25),
];

/// Maximum number of panels of the line. Their number doubles until the integral converges.
const PANELS: u32 = 256;
/// Largest change of the integral that counts as converged, relative to the integral of the absolute value.
const AGREEMENT: f64 = 1e-14;
/// Largest relative change of the integral of the absolute value: across a pole the integral itself may cancel.
const GROWTH: f64 = 1e-6;

/// The integral of `gradient` along the line from `from` to `to`.
///
/// # Errors
/// The [`Fault`] of the gradient; [`Fault::SingularConstraint`] if the integral does not converge, for example across
/// a pole.
pub fn line_integral<V: StateVector>(
    from: &[f64],
    to: &V,
    gradient: impl Fn(&V) -> Result<V, Fault>,
) -> Result<f64, Fault> {
    let mut slope = |s: f64| -> Result<f64, Fault> {
        let mut place = to.zeroed();
        let ends = from.iter().zip(to.as_slice());
        for (entry, (from, to)) in place.as_mut_slice().iter_mut().zip(ends) {
            *entry = from + (to - from) * s;
        }
        let gradient = gradient(&place)?;
        let ends = from.iter().zip(to.as_slice());
        let products = gradient.as_slice().iter().zip(ends);
        Ok(products
            .map(|(component, (from, to))| component * (to - from))
            .sum())
    };
    let mut panels = 1;
    let mut coarse = composite(&mut slope, panels)?;
    while panels < PANELS {
        panels *= 2;
        let fine = composite(&mut slope, panels)?;
        let is_settled = (fine.0 - coarse.0).abs() <= AGREEMENT * fine.1;
        if is_settled && (fine.1 - coarse.1).abs() <= GROWTH * fine.1 {
            return Ok(fine.0);
        }
        coarse = fine;
    }
    Err(Fault::SingularConstraint {
        constraint: 0,
        condition: f64::INFINITY,
    })
}

/// The integrals of a function and of its absolute value over (0, 1), in `panels` equal panels.
pub(crate) fn composite(
    function: &mut impl FnMut(f64) -> Result<f64, Fault>,
    panels: u32,
) -> Result<(f64, f64), Fault> {
    let width = 1.0 / f64::from(panels);
    let (mut sum, mut size) = (0.0, 0.0);
    for panel in 0..panels {
        let start = f64::from(panel) * width;
        for (node, weight) in NODES {
            for value in [
                function(start + node * width)?,
                function(start + (1.0 - node) * width)?,
            ] {
                sum += weight * width * value;
                size += weight * width * value.abs();
            }
        }
    }
    Ok((sum, size))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SVector;

    fn integral(to: [f64; 2], gradient: impl Fn(f64, f64) -> [f64; 2]) -> Result<f64, Fault> {
        let to = SVector::<f64, 2>::from(to);
        line_integral(&[0.0, 1.0], &to, |q| Ok(gradient(q[0], q[1]).into()))
    }

    #[test]
    #[cfg_attr(miri, ignore = "minutes of arithmetic")]
    fn gradients_give_their_functions() {
        // f = atan(x) + x exp(y)
        let gradient = |x: f64, y: f64| [1.0 / (1.0 + x * x) + y.exp(), x * y.exp()];
        for [x, y] in [[0.5, 1.5], [-2.0, 0.0], [30.0, -3.0], [0.0, 1.0]] {
            let found = integral([x, y], gradient).expect("a value");
            let expected = x.atan() + x * y.exp();
            assert!(
                (found - expected).abs() <= 1e-14 * (1.0 + expected.abs()),
                "{x} {y}"
            );
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "minutes of arithmetic")]
    fn poles_on_the_line_are_faults() {
        for power in [1, 2] {
            for y in [-1.0, -0.7] {
                let found = integral([1.0, y], |_, y| [0.0, y.powi(-power)]);
                assert!(
                    matches!(found, Err(Fault::SingularConstraint { .. })),
                    "{found:?}"
                );
            }
        }
    }
}
