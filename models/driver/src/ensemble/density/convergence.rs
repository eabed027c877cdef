//! Convergence test of a density, by the total variation distance (half of the sum of absolute differences) between the
//! densities of two halves of the states.

use super::counts::CLASSES;
use super::{Counts, Density};

/// Largest accepted relative excess that rounding a fraction of the states or members up to a whole number causes.
const ROUNDING: f64 = 0.05;

/// Distances between two halves of a fraction of all states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Checkpoint {
    /// The fraction: 1/16, 1/8, .. 1.
    pub part: f64,
    /// Number of states in the fraction.
    pub samples: u64,
    /// The distance between the earlier and the later half of the fraction; NaN if one of them is empty.
    pub over_time: f64,
    /// The distance between two halves of this fraction of the members; NaN if one of them is empty, or if the number of
    /// members does not allow the fraction.
    pub over_members: f64,
    /// The expected distance between halves of the same number of independent states, drawn from the density of all
    /// states.
    pub independent: f64,
}

/// The checkpoints, in increasing order of the fraction. Fractions that the number of states of a member does not allow
/// are left out: 20 states have no eighth.
pub fn convergence(counts: &Counts, density: &Density, members: u64) -> Vec<Checkpoint> {
    let total = counts.total();
    let all: u64 = total.iter().sum();
    let cells = total.len();
    (0..CLASSES - 1)
        .rev()
        .filter(|&class| divides(class, density.samples))
        .map(|class| {
            let over_time = halves(|class| &counts.of_time(class)[..cells], class);
            let over_members = halves(|class| &counts.of_members(class)[..cells], class);
            let samples = over_time.samples;
            Checkpoint {
                part: 1.0 / (1_u64 << class) as f64,
                samples,
                over_time: over_time.distance,
                over_members: match divides(class, members) {
                    true => over_members.distance,
                    false => f64::NAN,
                },
                independent: expected(&total, all, samples),
            }
        })
        .collect()
}

/// True if the fraction `1/2^class` of this many states or members is nearly a whole number. The fraction is rounded
/// up.
fn divides(class: usize, count: u64) -> bool {
    let part = 1_u64 << class;
    let rounded = count.div_ceil(part) * part;
    (rounded - count) as f64 <= ROUNDING * count as f64
}

struct Halves {
    samples: u64,
    distance: f64,
}

/// Compares the two halves of the fraction `1/2^class` of the states. The later half is this class, the earlier half
/// all following classes.
fn halves<'a>(of: impl Fn(usize) -> &'a [u64], class: usize) -> Halves {
    let later = of(class);
    let mut earlier = vec![0; later.len()];
    for class in class + 1..CLASSES {
        let counts = earlier.iter_mut().zip(of(class));
        counts.for_each(|(sum, count)| *sum += count);
    }
    let sums = [&earlier[..], later].map(|counts| counts.iter().sum::<u64>());
    let [first, second] = sums.map(|sum| sum as f64);
    let pairs = earlier.iter().zip(later);
    let differences =
        pairs.map(|(&one, &other)| (one as f64 / first - other as f64 / second).abs());
    Halves {
        samples: sums[0] + sums[1],
        distance: 0.5 * differences.sum::<f64>(),
    }
}

/// The mean distance between the densities of two samples of `samples/2` states each, drawn independently from the
/// density `total/all`: the counts of a cell are nearly Poisson.
fn expected(total: &[u64], all: u64, samples: u64) -> f64 {
    let half = 0.5 * samples as f64;
    let means = total
        .iter()
        .filter(|&&count| count > 0)
        .map(|&count| half * count as f64 / all as f64);
    0.5 * means.map(mean_difference).sum::<f64>() / half
}

/// The mean of `abs(X - Y)` for independent Poisson numbers of this mean: `z e^-z (I_0(z) + I_1(z))` with `z` twice the
/// mean and `I` the modified Bessel functions.
fn mean_difference(mean: f64) -> f64 {
    let z = 2.0 * mean;
    if z > 30.0 {
        // The sum of the asymptotic series of both functions; its error is less than 1e-6 here.
        let inverse = 1.0 / z;
        let series = 2.0 - inverse * (0.25 + inverse * (0.046_875 + inverse * 0.029_296_875));
        return z * series / (core::f64::consts::TAU * z).sqrt();
    }
    let half = 0.5 * z;
    let (mut term, mut sum) = (1.0, 0.0);
    for k in 0..200 {
        let k = f64::from(k);
        // The term (z/2)^2k/k!^2 of I_0, and its product with (z/2)/(k + 1) for I_1.
        sum += term * (1.0 + half / (k + 1.0));
        term *= (half / (k + 1.0)).powi(2);
        if term < 1e-17 * sum {
            break;
        }
    }
    z * (-z).exp() * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean by summing over both numbers.
    fn direct(mean: f64) -> f64 {
        let mut weights = vec![(-mean).exp()];
        for k in 1..200 {
            weights.push(weights[k - 1] * mean / k as f64);
        }
        let mut sum = 0.0;
        for (i, first) in weights.iter().enumerate() {
            for (j, second) in weights.iter().enumerate() {
                sum += (i as f64 - j as f64).abs() * first * second;
            }
        }
        sum
    }

    #[test]
    fn mean_differences_of_poisson_numbers() {
        for mean in [1e-3, 0.5, 3.0, 14.0, 16.0, 40.0] {
            let (got, right) = (mean_difference(mean), direct(mean));
            assert!(
                (got / right - 1.0).abs() < 2e-6,
                "{mean}: {got} instead of {right}"
            );
        }
    }

    #[test]
    fn fractions_are_those_that_the_number_of_states_allows() {
        let allowed = |count| {
            let classes = (0..CLASSES - 1).filter(|&class| divides(class, count));
            classes.map(|class| 1 << class).collect::<Vec<u64>>()
        };
        assert_eq!(allowed(20), [1, 2, 4]);
        assert_eq!(allowed(16), [1, 2, 4, 8, 16]);
        assert_eq!(allowed(199), [1, 2, 4, 8, 16]);
        assert_eq!(allowed(7), [1]);
    }

    #[test]
    fn halves_that_have_nothing_in_common_are_at_distance_1() {
        let classes = [[0, 8], [4, 0], [2, 0], [1, 0], [1, 0], [0, 0]];
        let all = halves(|class| &classes[class][..], 0);
        assert_eq!((all.samples, all.distance), (16, 1.0));
        let half = halves(|class| &classes[class][..], 1);
        assert_eq!((half.samples, half.distance), (8, 0.0));
        assert!(halves(|class| &classes[class][..], 4).distance.is_nan());
    }
}
