//! Directions that cover a sphere evenly.

use std::f64::consts::TAU;

/// The golden ratio.
const GOLDEN: f64 = 1.618_033_988_749_895;

/// Default number of directions for a number of unknowns.
pub(super) const fn default_count(unknowns: usize) -> usize {
    match unknowns {
        0 | 1 => 2,
        2 => 96,
        3 => 240,
        _ => 480,
    }
}

/// The angle of the first direction in the plane or on the spiral. It depends on the seed.
pub(super) fn turn(seed: u64) -> f64 {
    TAU * fraction(seed as f64 / GOLDEN + 0.137_035_999)
}

/// `count` unit vectors in a space of three dimensions or more.
pub(crate) fn on_sphere(dimension: usize, count: usize, seed: u64) -> Vec<Vec<f64>> {
    match dimension {
        3 => on_spiral(count, seed),
        _ => at_random(dimension, count, seed),
    }
}

/// The golden spiral on the sphere.
fn on_spiral(count: usize, seed: u64) -> Vec<Vec<f64>> {
    let at = |index: usize| {
        let height = 1.0 - (2.0 * index as f64 + 1.0) / count as f64;
        let radius = (1.0 - height * height).sqrt();
        let angle = turn(seed) + TAU * fraction(index as f64 / GOLDEN);
        vec![radius * angle.cos(), radius * angle.sin(), height]
    };
    (0..count).map(at).collect()
}

/// Random unit vectors from the normal distribution, in opposite pairs.
fn at_random(dimension: usize, count: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut state = seed ^ 0x9e37_79b9_7f4a_7c15;
    let mut next = || {
        // SplitMix64.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = state;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut directions = Vec::with_capacity(count + 1);
    while directions.len() < count {
        let normal = |_| (-2.0 * (1.0 - next()).ln()).sqrt() * (TAU * next()).cos();
        let vector: Vec<f64> = (0..dimension).map(normal).collect();
        let length = crate::linear::norm(&vector);
        if length > 0.0 {
            let unit: Vec<f64> = vector.iter().map(|value| value / length).collect();
            directions.push(unit.iter().map(|value| -value).collect());
            directions.push(unit);
        }
    }
    directions.truncate(count);
    directions
}

/// The fractional part of a nonnegative number.
fn fraction(value: f64) -> f64 {
    value - value.floor()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_unit_vectors_on_all_sides() {
        for dimension in [3, 4, 6] {
            let directions = on_sphere(dimension, 400, 1);
            assert_eq!(directions.len(), 400);
            for axis in 0..dimension {
                let sum: f64 = directions.iter().map(|it| it[axis]).sum();
                let squares: f64 = directions.iter().map(|it| it[axis] * it[axis]).sum();
                assert!((sum / 400.0).abs() < 0.01, "{sum}");
                assert!((squares / 400.0 * dimension as f64 - 1.0).abs() < 0.2);
            }
        }
        assert_ne!(on_sphere(4, 2, 1), on_sphere(4, 2, 2));
    }
}
