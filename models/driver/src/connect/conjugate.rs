//! Conjugate points: zeros, of odd or even order, of the determinant of the derivative of the configuration with
//! respect to the unknowns. They are sought along a motion between impacts. A change of sign at an impact is not a zero.

/// Longest step between two evaluations of the determinant, as a fraction of the time of the motion.
pub(super) const LONGEST: f64 = 1.0 / 128.0;

/// Time between an impact and the next evaluation of the determinant, as a fraction of the time of the motion.
const AFTER: f64 = 1e-9;

/// A minimum of the absolute determinant is sought if the parabola through three values falls below this fraction of
/// the larger outer value.
const SHALLOW: f64 = 0.2;

/// Number of golden sections of an interval with a minimum.
const SECTIONS: u32 = 60;
/// Ratio of the shorter part of a golden section to the whole.
const GOLDEN: f64 = 0.381_966_011_250_105;
/// Largest minimum that counts as 0, as a fraction of the larger value at the ends of the interval.
const TOUCHING: f64 = 1e-10;

/// Maximum number of evaluations for a zero.
const HALVINGS: u32 = 60;

/// The determinant at a time of a motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark {
    pub t: f64,
    pub determinant: f64,
    /// True if an impact follows at this time.
    pub is_cut: bool,
}

/// The times in (0, `time`) at which the determinant is 0. `at` evaluates it at any time.
pub(super) fn zeros(marks: &[Mark], time: f64, at: &mut dyn FnMut(f64) -> f64) -> Vec<f64> {
    let mut zeros = Vec::new();
    // The last two times since the last impact, with their values.
    let mut before: [Option<(f64, f64)>; 2] = [None; 2];
    for mark in marks {
        let here = (mark.t, mark.determinant);
        if let [_, Some(last)] = before
            && last.0 < here.0
            && last.1 * here.1 < 0.0
        {
            zeros.push(zero([last.0, here.0], last.1, at));
        }
        if let [Some(first), Some(middle)] = before {
            zeros.extend(touched([first, middle, here], at));
        }
        before = match mark.is_cut {
            true => {
                let after = mark.t + AFTER * time;
                [None, Some((after, at(after)))]
            }
            false => [before[1], Some(here)],
        };
    }
    zeros.retain(|t| *t < time * (1.0 - AFTER));
    zeros
}

/// The zeros near the middle of three times, if the absolute determinant has its minimum there: two zeros if it changes
/// sign and changes back, one if it touches 0. It touches 0 where motions in two independent directions are conjugate
/// at once.
fn touched(three: [(f64, f64); 3], at: &mut dyn FnMut(f64) -> f64) -> Vec<f64> {
    let [(from, first), (middle, least), (to, last)] = three;
    let is_alike = first * least > 0.0 && least * last > 0.0;
    let size = f64::max(first.abs(), last.abs());
    let is_dip = least.abs() < first.abs() && least.abs() <= last.abs();
    if !is_alike || !is_dip || lowest(three) > SHALLOW * size {
        return Vec::new();
    }
    let sign = least.signum();
    let mut value = |t: f64| sign * at(t);
    let (mut low, mut high) = (from, to);
    let mut best = (middle, least.abs());
    for _ in 0..SECTIONS {
        // Golden section of the longer side.
        let is_left = best.0 - low > high - best.0;
        let t = match is_left {
            true => best.0 - GOLDEN * (best.0 - low),
            false => best.0 + GOLDEN * (high - best.0),
        };
        let there = value(t);
        if there < 0.0 {
            return vec![zero([from, t], first, at), zero([t, to], sign * there, at)];
        }
        match (there < best.1, is_left) {
            (true, true) => (high, best) = (best.0, (t, there)),
            (true, false) => (low, best) = (best.0, (t, there)),
            (false, true) => low = t,
            (false, false) => high = t,
        }
    }
    if best.1.is_nan() || best.1 > TOUCHING * size {
        return Vec::new();
    }
    // The square root of the determinant is linear on both sides of the zero.
    let mut t = best.0;
    for share in [1e-2, 1e-3] {
        let distance = share * (to - from);
        let [left, right] = [t - distance, t + distance].map(|t| value(t).abs().sqrt());
        t += distance * (left - right) / (left + right);
    }
    vec![t]
}

/// The least absolute value of the parabola through three values of one sign; 0 if it passes through 0.
fn lowest([(a, first), (b, middle), (c, last)]: [(f64, f64); 3]) -> f64 {
    let [first, middle, last] = [first, middle, last].map(f64::abs);
    let slopes = [(middle - first) / (b - a), (last - middle) / (c - b)];
    let bend = (slopes[1] - slopes[0]) / (c - a);
    let slope = slopes[0] + bend * (b - a);
    match bend > 0.0 {
        true => (middle - slope * slope / (4.0 * bend)).max(0.0),
        false => middle,
    }
}

/// The zero between two times at which the determinant has different signs. `before` is its value at the first time.
fn zero([mut from, mut to]: [f64; 2], before: f64, at: &mut dyn FnMut(f64) -> f64) -> f64 {
    let mut before = before;
    let mut after = at(to);
    for round in 0..HALVINGS {
        // Every third step is a bisection; all other steps use false position.
        let share = before / (before - after);
        let share = match round % 3 == 2 || !(share > 0.0 && share < 1.0) {
            true => 0.5,
            false => share,
        };
        let t = from + share * (to - from);
        if t <= from || t >= to {
            break;
        }
        let value = at(t);
        match value * before > 0.0 {
            true => (from, before) = (t, value),
            false => (to, after) = (t, value),
        }
        if value == 0.0 {
            return t;
        }
    }
    match before.abs() < after.abs() {
        true => from,
        false => to,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_between_impacts_count_and_turns_at_impacts_do_not() {
        // An impact at t = 1 changes the sign of sin(t). The zeros are pi and 2 pi.
        let value = |t: f64| if t <= 1.0 { t.sin() } else { -t.sin() };
        let marks: Vec<Mark> = (1..=70)
            .map(|k| 0.1 * f64::from(k))
            .map(|t| Mark {
                t,
                determinant: value(t),
                is_cut: t == 1.0,
            })
            .collect();
        let found = zeros(&marks, 7.0, &mut { value });
        let expected = [std::f64::consts::PI, std::f64::consts::TAU];
        assert_eq!(found.len(), 2, "{found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-14, "{found}");
        }
    }

    /// Marks of a function along (0, 7] without impacts.
    fn marks(value: impl Fn(f64) -> f64) -> Vec<Mark> {
        let times = (1..=70).map(|k| 0.1 * f64::from(k));
        times
            .map(|t| Mark {
                t,
                determinant: value(t),
                is_cut: false,
            })
            .collect()
    }

    #[test]
    fn zeros_of_even_order_count_and_dips_above_zero_do_not() {
        let touching = |t: f64| t.sin().powi(2) * (1.0 + 0.1 * t);
        let found = zeros(&marks(touching), 7.0, &mut { touching });
        let expected = [std::f64::consts::PI, std::f64::consts::TAU];
        assert_eq!(found.len(), 2, "{found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-8, "{found}");
        }
        // First two zeros between neighbouring marks, then a minimum above 0.
        let close = |t: f64| (t - 3.02) * (t - 3.05);
        let found = zeros(&marks(close), 7.0, &mut { close });
        assert_eq!(found.len(), 2, "{found:?}");
        assert!((found[0] - 3.02).abs() < 1e-12 && (found[1] - 3.05).abs() < 1e-12);
        let above = |t: f64| (t - 3.03).powi(2) + 1e-8;
        assert!(zeros(&marks(above), 7.0, &mut { above }).is_empty());
    }
}
