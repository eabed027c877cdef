//! Conjugate points: zeros of the determinant along a motion, between impacts. An impact turns its sign, which is no
//! zero.

/// Longest step along which the determinant is compared, as a fraction of the time.
pub(super) const LONGEST: f64 = 1.0 / 128.0;

/// Time after an impact at which the determinant is first looked at, as a fraction of the time.
const AFTER: f64 = 1e-9;

/// Number of halvings of an interval with a zero.
const HALVINGS: u32 = 60;

/// The determinant at a time of a motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark {
    pub t: f64,
    pub determinant: f64,
    /// True for the side before an impact.
    pub is_cut: bool,
}

/// The times in (0, `time`) at which the determinant passes through 0. `at` computes it at any time.
pub(super) fn zeros(marks: &[Mark], time: f64, at: &mut dyn FnMut(f64) -> f64) -> Vec<f64> {
    let mut zeros = Vec::new();
    let mut last: Option<(f64, f64)> = None;
    for mark in marks {
        if let Some((from, before)) = last
            && from < mark.t
            && before * mark.determinant < 0.0
        {
            zeros.push(zero([from, mark.t], before, at));
        }
        let after = mark.t + AFTER * time;
        last = Some(match mark.is_cut {
            true => (after, at(after)),
            false => (mark.t, mark.determinant),
        });
    }
    zeros.retain(|t| *t < time * (1.0 - AFTER));
    zeros
}

/// The zero between two times of different sign; `before` is the value at the first of them.
fn zero([mut from, mut to]: [f64; 2], before: f64, at: &mut dyn FnMut(f64) -> f64) -> f64 {
    let mut before = before;
    let mut after = at(to);
    for round in 0..HALVINGS {
        // False position, and every third time the middle.
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
        // sin(t) that an impact at 1 turns; zeros at pi and 2 pi.
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
}
