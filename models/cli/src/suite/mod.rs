//! Suites of hard cases, which `dalembert stability` runs. Each case has a correct result (a closed form, an exact
//! count or a class of outcome) and a bound on its measured error.
//!
//! A suite is a list of [`Case`]s for [`Catalogue::with_suite`](crate::Catalogue::with_suite). A case writes its
//! measurements into a [`Report`]. [`examine`] runs it under every [`Setting`] that its [`Run`] requests.

mod report;

use std::time::{Duration, Instant};

pub use crate::plot::logarithmic::exponent;
use dalembert_driver::Integrator;
pub use report::{Check, Curve, Report};

/// A hard case.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Its number: the letter of a section and two digits, with a suffix for a longer version.
    pub id: &'static str,
    /// Its title, one line.
    pub title: &'static str,
    /// The correct result.
    pub right: &'static str,
    /// The bound on the error.
    pub bound: &'static str,
    /// True if it takes so long that it runs only on request.
    pub nightly: bool,
    /// The reason why it cannot hold yet. If such a case holds, it is reported as a failure, so that the reason is
    /// removed.
    pub pending: Option<&'static str>,
    /// The measurement.
    pub run: Run,
}

impl Case {
    /// A quick case with empty fields, as defaults of other cases.
    pub const QUICK: Self = Self {
        id: "",
        title: "",
        right: "",
        bound: "",
        nightly: false,
        pending: None,
        run: Run::Absent,
    };

    /// A long case with empty fields, as defaults of other cases.
    pub const NIGHTLY: Self = Self {
        nightly: true,
        ..Self::QUICK
    };

    /// False if the case chooses its integrators and none of them is in this list.
    pub fn is_measured_by(&self, integrators: &[Integrator]) -> bool {
        match self.run {
            Run::Chosen(chosen, _) => chosen.iter().any(|one| integrators.contains(one)),
            _ => true,
        }
    }

    /// Its section: the letter of its number.
    pub fn section(&self) -> &'static str {
        self.id.get(..1).unwrap_or_default()
    }
}

/// Kind of measurement.
#[derive(Debug, Clone, Copy)]
pub enum Run {
    /// Not measured; [`Case::pending`] gives the reason.
    Absent,
    /// Measured once: the case integrates nothing, or chooses its integrators itself.
    Once(fn(&mut Report)),
    /// Measured by every integrator, with steps of any length.
    Integrators(fn(Setting, &mut Report)),
    /// Measured by these integrators only, otherwise like [`Run::Integrators`].
    Chosen(&'static [Integrator], fn(Setting, &mut Report)),
    /// Measured by every integrator in four settings: with steps of any length, with the dense output read in every step,
    /// and with each of [`FORCED_STEPS`] as the longest step. All settings must have the same class of outcome.
    Steps(fn(Setting, &mut Report)),
}

/// Longest steps that [`Run::Steps`] forces.
pub const FORCED_STEPS: [f64; 2] = [0.25, 1e-3];

/// Settings for the runs of a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// The integrator.
    pub integrator: Integrator,
    /// Longest allowed step.
    pub max_step: Option<f64>,
    /// True to read the dense output in every step.
    pub dense: bool,
}

impl Setting {
    /// This integrator without further settings.
    pub const fn free(integrator: Integrator) -> Self {
        Self {
            integrator,
            max_step: None,
            dense: false,
        }
    }

    /// The setting in a few words.
    pub fn words(&self) -> String {
        let step = self
            .max_step
            .map_or(String::new(), |step| format!(", steps of {step}"));
        let dense = if self.dense { ", dense" } else { "" };
        format!("{}{step}{dense}", self.integrator.name())
    }
}

impl Run {
    /// The settings under which it is measured. [`Run::Once`] gets one setting, which it ignores.
    fn settings(&self, integrators: &[Integrator]) -> Vec<Setting> {
        let free = integrators.iter().copied().map(Setting::free);
        match self {
            Self::Absent => Vec::new(),
            Self::Once(_) => free.take(1).collect(),
            Self::Integrators(_) => free.collect(),
            Self::Chosen(chosen, _) => free
                .filter(|setting| chosen.contains(&setting.integrator))
                .collect(),
            Self::Steps(_) => free.flat_map(forced).collect(),
        }
    }

    fn measure(&self, setting: Setting) -> Report {
        let mut report = Report::default();
        match self {
            Self::Absent => {}
            Self::Once(run) => run(&mut report),
            Self::Integrators(run) | Self::Chosen(_, run) | Self::Steps(run) => {
                run(setting, &mut report);
            }
        }
        report
    }
}

/// A setting, the same with the dense output read, and the same with forced steps.
fn forced(free: Setting) -> Vec<Setting> {
    let dense = Setting {
        dense: true,
        ..free
    };
    let short = FORCED_STEPS.map(|step| Setting {
        max_step: Some(step),
        ..free
    });
    [free, dense].into_iter().chain(short).collect()
}

/// Verdict on a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Every measurement keeps its bound.
    Pass,
    /// A measurement exceeds its bound.
    Fail,
    /// It has a reason in [`Case::pending`], and does not hold.
    Pending,
}

impl Verdict {
    /// The verdict as a word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "fail",
            Self::Pending => "pending",
        }
    }
}

/// Result of a case: verdict and measurements.
#[derive(Debug, Clone)]
pub struct Finding {
    /// The case.
    pub case: Case,
    /// The verdict.
    pub verdict: Verdict,
    /// The measurement that is closest to its bound or exceeds it most, or the reason why nothing was measured.
    pub measured: String,
    /// The setting of that measurement.
    pub setting: Option<Setting>,
    /// All measurements, setting by setting.
    pub reports: Vec<(Setting, Report)>,
    /// The time taken.
    pub elapsed: Duration,
}

/// Measures a case by these integrators.
pub fn examine(case: &Case, integrators: &[Integrator]) -> Finding {
    let begun = Instant::now();
    let settings = case.run.settings(integrators);
    let reports: Vec<(Setting, Report)> = settings
        .into_iter()
        .map(|setting| (setting, case.run.measure(setting)))
        .collect();
    let (holds, mut measured, setting) = judge(&reports);
    let verdict = match (case.pending, holds) {
        (None, true) => Verdict::Pass,
        (None, false) => Verdict::Fail,
        (Some(reason), false) => {
            measured = reason.to_owned();
            Verdict::Pending
        }
        (Some(reason), true) => {
            measured = format!("holds, and is not pending any more: {reason}");
            Verdict::Fail
        }
    };
    Finding {
        case: *case,
        verdict,
        measured,
        setting: setting.filter(|_| verdict != Verdict::Pending),
        reports,
        elapsed: begun.elapsed(),
    }
}

/// Judges the reports. The first value is true if every measurement keeps its bound and the classes of outcome agree.
/// The others are the worst measurement, or the classes that differ, and the setting in which it was found.
fn judge(reports: &[(Setting, Report)]) -> (bool, String, Option<Setting>) {
    let worst = reports
        .iter()
        .rev()
        .filter_map(|(setting, report)| Some((*setting, report.worst()?)))
        .max_by(|(_, a), (_, b)| a.share.total_cmp(&b.share));
    let Some((setting, check)) = worst else {
        return (false, "nothing was measured".to_owned(), None);
    };
    let holds = check.passes();
    // A setting may leave out the last values of a case. Its list is then shorter, and `zip` compares the common part.
    let first = &reports[0].1.classes;
    let changed = reports
        .iter()
        .find(|(_, report)| holds && report.classes.iter().zip(first).any(|(a, b)| a != b));
    match changed {
        Some((setting, report)) => {
            let words = format!("outcome {:?}, elsewhere {first:?}", report.classes);
            (false, words, Some(*setting))
        }
        None => (
            holds,
            format!("{}: {}", check.what, check.words),
            Some(setting),
        ),
    }
}

/// The error of the generator on a declaration that it refuses.
pub fn refusal(source: &str) -> Option<String> {
    dalembert_codegen::report::report(source)
        .err()
        .map(|error| error.to_string())
}

/// The notes of the generator on a declaration, one per line.
pub fn notes(source: &str) -> String {
    use dalembert_codegen::report::{Item, Section, report};
    let Ok(report) = report(source) else {
        return String::new();
    };
    let sections = report.sections.into_iter();
    let notes = sections.filter(|section| section.title == Section::NOTES);
    let words = notes
        .flat_map(|section| section.items)
        .filter_map(|item| match item {
            Item::Words(words) => Some(words),
            _ => None,
        });
    words.collect::<Vec<_>>().join("\n")
}

/// All adaptive integrators. The bounds of cases belong to tolerances, which fixed-step integrators do not keep.
pub fn every_integrator() -> &'static [Integrator] {
    &[Integrator::Dop853, Integrator::Dopri5, Integrator::Taylor]
}

#[cfg(test)]
mod tests {
    use dalembert::Outcome;

    use super::*;

    const ONCE: fn(fn(&mut Report)) -> Case = |run| Case {
        id: "X01",
        run: Run::Once(run),
        ..Case::QUICK
    };

    #[test]
    fn the_worst_measurement_decides() {
        let case = ONCE(|report| {
            report.error("small", 1e-3, 1.0);
            report.error("large", 2.0, 1.0);
            report.equal("count", 3, 3);
        });
        let finding = examine(&case, every_integrator());
        assert_eq!(
            (finding.verdict, finding.measured.as_str()),
            (Verdict::Fail, "large: 2.00e0 of 1.00e0")
        );
    }

    #[test]
    fn what_is_not_a_number_fails() {
        let case = ONCE(|report| report.error("lost", f64::NAN, 1.0));
        assert_eq!(examine(&case, every_integrator()).verdict, Verdict::Fail);
    }

    #[test]
    fn a_pending_case_that_holds_is_a_failure() {
        let mut case = ONCE(|report| report.equal("count", 1, 1));
        case.pending = Some("no reason");
        assert_eq!(examine(&case, every_integrator()).verdict, Verdict::Fail);
        case.run = Run::Once(|report| report.equal("count", 1, 2));
        assert_eq!(examine(&case, every_integrator()).verdict, Verdict::Pending);
        case.run = Run::Absent;
        assert_eq!(examine(&case, every_integrator()).verdict, Verdict::Pending);
    }

    #[test]
    fn a_class_that_changes_with_the_step_fails() {
        let case = Case {
            run: Run::Steps(|setting, report| {
                let outcome = match setting.max_step {
                    None => Outcome::Stopped,
                    Some(_) => Outcome::Done,
                };
                report.one_of(&outcome, &["done", "stopped"]);
            }),
            ..Case::QUICK
        };
        assert_eq!(examine(&case, every_integrator()).verdict, Verdict::Fail);
    }
}
