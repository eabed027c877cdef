//! Random numbers as a function of their index, independent of the order of use. The generator is Philox 4x32-10
//! (Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as easy as 1, 2, 3", 2011), with the seed as key, and
//! member and quantity as counter.

use dalembert::math;

const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
const ROUNDS: usize = 10;

fn philox(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for _ in 0..ROUNDS {
        let [first, second] = [0, 1].map(|i| u64::from(MULTIPLIERS[i]) * u64::from(counter[2 * i]));
        let high = |product: u64| (product >> 32) as u32;
        counter = [
            high(second) ^ counter[1] ^ key[0],
            second as u32,
            high(first) ^ counter[3] ^ key[1],
            first as u32,
        ];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    counter
}

/// Two independent random numbers, uniform in (0, 1), for a quantity of a member.
fn uniform_pair(seed: u64, member: u64, quantity: u32) -> [f64; 2] {
    let halves = |value: u64| [value as u32, (value >> 32) as u32];
    let [low, high] = halves(member);
    let words = philox([low, high, quantity, 0], halves(seed));
    // The midpoints of 2^52 equal intervals, so neither 0 nor 1.
    [0, 2].map(|i| {
        let bits = u64::from(words[i]) | (u64::from(words[i + 1]) << 32);
        ((bits >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    })
}

/// A number uniform in (0, 1).
pub fn uniform(seed: u64, member: u64, quantity: u32) -> f64 {
    uniform_pair(seed, member, quantity)[0]
}

/// A normally distributed number with mean 0 and standard deviation 1 (Box-Muller).
pub fn normal(seed: u64, member: u64, quantity: u32) -> f64 {
    let [radius, angle] = uniform_pair(seed, member, quantity);
    (-2.0 * math::ln(radius)).sqrt() * math::cos(core::f64::consts::TAU * angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_answers_of_the_generator() {
        let cases = [
            (
                [0; 4],
                [0; 2],
                [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8],
            ),
            (
                [u32::MAX; 4],
                [u32::MAX; 2],
                [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd],
            ),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ];
        for (counter, key, expected) in cases {
            assert_eq!(philox(counter, key), expected);
        }
    }

    #[test]
    fn draws_have_the_moments_of_their_distributions() {
        let count = 20_000;
        let moments = |draw: fn(u64, u64, u32) -> f64| {
            let draws: Vec<f64> = (0..count).map(|member| draw(3, member, 1)).collect();
            let mean = draws.iter().sum::<f64>() / count as f64;
            let square = draws.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            (mean, square / count as f64)
        };
        // Bounds of four standard errors.
        let (mean, variance) = moments(uniform);
        assert!((mean - 0.5).abs() < 0.0082 && (variance - 1.0 / 12.0).abs() < 0.0022);
        let (mean, variance) = moments(normal);
        assert!(mean.abs() < 0.029 && (variance - 1.0).abs() < 0.04);
    }
}
