//! What a case measures: errors against bounds, counts, classes of outcome, curves.

use std::fmt::Debug;

use dalembert::Outcome;

/// One thing that was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// What.
    pub what: String,
    /// What was found, and what was expected.
    pub words: String,
    /// The error found over the error allowed, infinite where there is no number: passes up to 1.
    pub share: f64,
}

impl Check {
    /// Whether it passes.
    pub fn passes(&self) -> bool {
        self.share <= 1.0
    }
}

/// A curve that shows what was measured, on logarithmic axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its name.
    pub name: String,
    /// What runs along the axes.
    pub axes: [&'static str; 2],
    /// Its points; only positive numbers can be drawn.
    pub points: Vec<[f64; 2]>,
}

/// What a case found in one setting.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Report {
    /// What was measured, in order.
    pub checks: Vec<Check>,
    /// Curves to draw.
    pub curves: Vec<Curve>,
    pub(super) classes: Vec<&'static str>,
}

impl Report {
    /// An error that must not exceed a bound.
    pub fn error(&mut self, what: impl Into<String>, error: f64, bound: f64) {
        let share = if error == 0.0 { 0.0 } else { error / bound };
        let words = format!("{error:.2e} of {bound:.2e}");
        self.push(what, words, share);
    }

    /// A number that must lie within `bound` of what is right.
    pub fn near(&mut self, what: impl Into<String>, found: f64, right: f64, bound: f64) {
        self.error(what, (found - right).abs(), bound);
    }

    /// Something that must be exactly what is right.
    pub fn equal<T: PartialEq + Debug>(&mut self, what: impl Into<String>, found: T, right: T) {
        let same = found == right;
        let words = match same {
            true => format!("{found:?}"),
            false => format!("{found:?} for {right:?}"),
        };
        self.push(what, words, if same { 0.0 } else { f64::INFINITY });
    }

    /// An outcome that must be of this class.
    pub fn class(&mut self, outcome: &Outcome, right: &'static str) {
        self.one_of(outcome, &[right]);
    }

    /// An outcome that must be of one of these classes, the same in every setting.
    pub fn one_of(&mut self, outcome: &Outcome, right: &[&'static str]) {
        let kind = outcome.kind();
        self.classes.push(kind);
        let same = right.contains(&kind);
        let words = match same {
            true => kind.to_owned(),
            false => format!("{kind} for {}", right.join(" or ")),
        };
        self.push("outcome", words, if same { 0.0 } else { f64::INFINITY });
    }

    /// A curve to draw.
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

    /// The check that comes closest to failing, or fails worst.
    pub(super) fn worst(&self) -> Option<&Check> {
        // Of equals the first, which is where a failure begins.
        let checks = self.checks.iter().rev();
        checks.max_by(|a, b| a.share.total_cmp(&b.share))
    }
}
