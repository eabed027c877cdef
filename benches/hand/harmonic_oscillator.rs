//! A mass on a spring.

use dalembert_models::HarmonicOscillator;

use super::number::{Number, parameters};

/// Hamilton's equations.
#[inline(always)]
pub fn rate<T: Number>(oscillator: &HarmonicOscillator, [x, p]: [T; 2]) -> [T; 2] {
    let [m, k] = parameters::<T, _>([oscillator.m, oscillator.k]);
    [p / m, -(k * x)]
}

/// Kinetic and potential energy.
#[inline(always)]
pub fn energy<T: Number>(oscillator: &HarmonicOscillator, [x, p]: [T; 2]) -> T {
    let [m, k] = parameters::<T, _>([oscillator.m, oscillator.k]);
    (p * p / m + k * (x * x)).times(0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated;
    use crate::hand::agreement::{assert_numbers_agree, assert_states_agree};
    use crate::hand::number::numbers;

    const OSCILLATOR: HarmonicOscillator = HarmonicOscillator { m: 1.3, k: 0.7 };

    #[test]
    fn the_oscillator_by_hand_is_the_generated_one() {
        assert_states_agree(&OSCILLATOR, generated::rate, |oscillator, state| {
            rate(oscillator, numbers(state)).into()
        });
        assert_numbers_agree(&OSCILLATOR, generated::energy, |oscillator, state| {
            energy(oscillator, numbers(state))
        });
    }
}
