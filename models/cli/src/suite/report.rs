//! Measurements of a case: errors against bounds, exact values, classes of outcome, and curves.

use std::fmt::Debug;

use dalembert::Outcome;

/// A measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// Its name.
    pub what: String,
    /// The result and the expected value, in words.
    pub words: String,
    /// The error divided by the allowed error; infinite if the error is NaN. Values up to 1 pass.
    pub share: f64,
}

impl Check {
    /// True if it passes.
    pub fn passes(&self) -> bool {
        self.share <= 1.0
    }
}

/// A curve of measurements, on logarithmic axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its name.
    pub name: String,
    /// The quantities of the axes.
    pub axes: [&'static str; 2],
    /// Its points; only positive numbers can be drawn.
    pub points: Vec<[f64; 2]>,
}

/// Results of a case in one setting.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Report {
    /// The measurements, in order.
    pub checks: Vec<Check>,
    /// Curves to draw.
    pub curves: Vec<Curve>,
    pub(super) classes: Vec<&'static str>,
}

impl Report {
    /// Adds an error that must not exceed a bound.
    pub fn error(&mut self, what: impl Into<String>, error: f64, bound: f64) {
        let share = if error == 0.0 { 0.0 } else { error / bound };
        let words = format!("{error:.2e} of {bound:.2e}");
        self.push(what, words, share);
    }

    /// Adds a number that must lie within `bound` of the correct one.
    pub fn near(&mut self, what: impl Into<String>, found: f64, right: f64, bound: f64) {
        self.error(what, (found - right).abs(), bound);
    }

    /// Adds a value that must equal the correct one exactly.
    pub fn equal<T: PartialEq + Debug>(&mut self, what: impl Into<String>, found: T, right: T) {
        let same = found == right;
        let words = match same {
            true => format!("{found:?}"),
            false => format!("{found:?} instead of {right:?}"),
        };
        self.push(what, words, if same { 0.0 } else { f64::INFINITY });
    }

    /// Adds an outcome that must be of this class.
    pub fn class(&mut self, outcome: &Outcome, right: &'static str) {
        self.one_of(outcome, &[right]);
    }

    /// Adds an outcome that must be of one of these classes, the same in every setting.
    pub fn one_of(&mut self, outcome: &Outcome, right: &[&'static str]) {
        let kind = outcome.kind();
        self.classes.push(kind);
        let same = right.contains(&kind);
        let words = match same {
            true => kind.to_owned(),
            false => format!("{kind} instead of {}", right.join(" or ")),
        };
        self.push("outcome", words, if same { 0.0 } else { f64::INFINITY });
    }

    /// Adds a curve.
    pub fn curve(
        &mut self,
        name: impl Into<String>,
        axes: [&'static str; 2],
        points: Vec<[f64; 2]>,
    ) {
        let name = name.into();
        self.curves.push(Curve { name, axes, points });
    }

    fn push(&mut self, what: impl Into<String>, words: String, share: f64) {
        let what = what.into();
        let share = if share.is_nan() { f64::INFINITY } else { share };
        self.checks.push(Check { what, words, share });
    }

    /// The check closest to failing, or the worst failure.
    pub(super) fn worst(&self) -> Option<&Check> {
        // The first of equal checks is taken, because a failure begins there.
        let checks = self.checks.iter().rev();
        checks.max_by(|a, b| a.share.total_cmp(&b.share))
    }
}
