//! Certified motion in a few lines of text. If the certification ends early, the text gives the reason in the model's
//! names.

use std::io::{self, Write};

use dalembert::certified::{Lost, Reason};
use dalembert::describe::Description;
use dalembert::numbers::Interval;

use super::Enclosed;
use crate::error::counted;
use crate::names;

/// Writes the report.
pub(super) fn write(output: &mut dyn Write, enclosed: &Enclosed<'_>) -> io::Result<()> {
    let Enclosed {
        model,
        scene,
        request,
        strikes,
        certified,
        ..
    } = enclosed;
    let description = model.description();
    writeln!(output, "{}", names::titled(description, scene))?;
    let rows = rows(enclosed);
    let names = rows.iter().map(|(name, _)| name.chars().count());
    let width = names.max().unwrap_or_default().max(10) + 2;
    for (number, strike) in strikes.iter().enumerate() {
        let mut surface = surface(description, strike.surface).to_owned();
        if let (Some(before), Some(after)) = (strike.before.mode, strike.after.mode) {
            surface += &format!(", {before} to {after}");
        }
        let (name, time) = (format!("impact {}", number + 1), range(strike.time));
        writeln!(output, "  {name:<width$}t in {time}, {surface}")?;
    }
    let t = certified.t;
    match &certified.lost {
        None => writeln!(output, "  {:<width$}up to t = {t}", "certified")?,
        Some(lost) => {
            let lost = text(description, lost);
            writeln!(output, "  {:<width$}{lost}", "lost")?;
            writeln!(output, "  {:<width$}{NARROWER}", "try")?;
        }
    }
    let others = match (&*description.surfaces, certified.impacts) {
        ([], _) => "the model has no surfaces".to_owned(),
        (_, 0) => format!("there are none until t = {t}"),
        (_, count) => format!("{count}; there are no others until t = {t}"),
    };
    writeln!(output, "  {:<width$}{others}", "impacts")?;
    if let Some(mode) = certified.last.mode {
        writeln!(output, "  {:<width$}{mode}", "mode")?;
    }
    for (name, value) in rows {
        writeln!(output, "  {name:<width$}{}", range(value))?;
    }
    let (form, steps) = (request.form.name(), counted_steps(certified.steps));
    writeln!(output, "  {:<width$}{steps}, {form} form", "steps")
}

fn counted_steps(steps: u64) -> String {
    counted(usize::try_from(steps).unwrap_or(usize::MAX), "step")
}

/// Positions and velocities at the end, by name.
fn rows(enclosed: &Enclosed<'_>) -> Vec<(String, Interval)> {
    let description = enclosed.model.description();
    let last = &enclosed.certified.last;
    let coordinates = names::coordinates(description);
    let velocities = coordinates.clone().map(names::velocity);
    let positions = coordinates.map(str::to_owned).zip(last.q.iter().copied());
    // A mode may lack some coordinates.
    positions
        .chain(velocities.zip(last.qdot.iter().copied()))
        .filter(|(_, range)| !range.lo.is_nan())
        .collect()
}

/// Both ends of a range, written so that they parse to the same doubles, and its width.
fn range(range: Interval) -> String {
    let Interval { lo, hi } = range;
    format!("[{lo:?}, {hi:?}] (width {:.1e})", range.width())
}

/// Remedy against the early end of a certification.
const NARROWER: &str =
    "a smaller --until, narrower ranges of --certify-within, or a start away from the event";

/// The time up to which the motion is certified, and the reason why the certification ends there.
pub(super) fn text(description: &Description, lost: &Lost) -> String {
    let reason = reason(description, lost.reason);
    format!("certified up to t = {} and no further: {reason}", lost.t)
}

/// A reason in the model's names.
pub(super) fn reason(description: &Description, reason: Reason) -> String {
    let name = |index| surface(description, index);
    match reason {
        Reason::NoTube => {
            "no box contains the motion over the shortest step: the motion may end there, or the box is too wide"
                .to_owned()
        }
        Reason::NotFinite => "the box became infinite".to_owned(),
        Reason::MayGraze { surface } => format!("the motion may graze surface `{}`", name(surface)),
        Reason::MayMeetTogether { surface, other } => format!(
            "the motion may hit surfaces `{}` and `{}` at one time, or in either order",
            name(surface),
            name(other)
        ),
        Reason::UnsureCondition { surface } => {
            format!("the conditions of surface `{}` are not decided", name(surface))
        }
        Reason::MayBeBehind { surface } => {
            format!("the motion may be behind surface `{}`", name(surface))
        }
        Reason::MayStay { surface } => {
            format!("the motion may stay on surface `{}`", name(surface))
        }
        Reason::UnsureLaw { surface } => format!(
            "the law of surface `{}` may not give one finite state",
            name(surface)
        ),
        Reason::Stops { surface } => {
            format!("the motion may end at surface `{}`", name(surface))
        }
        Reason::OffConstraint { surface } => format!(
            "the reset of surface `{}` leads off the constraints",
            name(surface)
        ),
        Reason::EndsAtImpact { surface } => format!(
            "the end time may lie before or after the impact on surface `{}`: choose another --until",
            name(surface)
        ),
        other => other.to_string(),
    }
}

/// The kind of a reason as a word, and its surface.
pub(super) fn kind(reason: Reason) -> (&'static str, Option<usize>) {
    match reason {
        Reason::NoTube => ("no_tube", None),
        Reason::NoHeadway => ("no_headway", None),
        Reason::NotDerived => ("not_derived", None),
        Reason::NotFinite => ("not_finite", None),
        Reason::MayGraze { surface } => ("may_graze", Some(surface)),
        Reason::MayMeetTogether { surface, .. } => ("may_meet_together", Some(surface)),
        Reason::UnsureCondition { surface } => ("unsure_condition", Some(surface)),
        Reason::MayBeBehind { surface } => ("may_be_behind", Some(surface)),
        Reason::MayStay { surface } => ("may_stay", Some(surface)),
        Reason::UnsureLaw { surface } => ("unsure_law", Some(surface)),
        Reason::OffConstraint { surface } => ("off_constraint", Some(surface)),
        Reason::EndsAtImpact { surface } => ("ends_at_impact", Some(surface)),
        _ => ("other", None),
    }
}

/// The name of a surface.
pub(super) fn surface(description: &Description, index: usize) -> &'static str {
    names::surfaces(description).nth(index).unwrap_or("?")
}
