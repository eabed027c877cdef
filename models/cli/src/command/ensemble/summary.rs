//! An ensemble in a few lines of text.

use std::io::{self, Write};

use super::Finished;
use crate::command::simulate::summary::{on_each, relative_change};
use crate::error::counted;
use crate::names;
use crate::scalar::short;
use dalembert_driver::ensemble::density::{Axis, Checkpoint, Counts, Density};
use dalembert_driver::ensemble::exact::ExactSum;

/// Writes the summary.
///
/// # Errors
/// An I/O error of the stream.
pub fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let Finished {
        tally, settings, ..
    } = finished;
    writeln!(output, "{}", title(finished))?;
    let outcomes = tally.outcomes.iter();
    let outcomes: Vec<String> = outcomes
        .map(|(kind, count)| format!("{kind} {count}"))
        .collect();
    writeln!(output, "  outcomes    {}", outcomes.join(", "))?;
    for strayed in &tally.first_strayed {
        let reason = match strayed.reason.as_str() {
            "" => String::new(),
            reason => format!(" ({reason})"),
        };
        writeln!(
            output,
            "              member {}: {}{reason}",
            strayed.member, strayed.outcome
        )?;
    }
    let told = tally.first_strayed.len() as u64;
    if tally.strayed > told {
        writeln!(output, "              and {} more", tally.strayed - told)?;
    }
    writeln!(output, "  impacts     {}", impacts(finished))?;
    if !finished.model.description().is_first_order {
        writeln!(
            output,
            "  energy      largest change {:.1e}{}",
            tally.energy_change,
            relative_change(tally.relative_change)
        )?;
    }
    writeln!(
        output,
        "  integrator  {}, {} form, tol {:e}",
        settings.integrator.name(),
        settings.form.name(),
        settings.tol
    )?;
    writeln!(output, "  time        {}", time(finished))?;
    write_statistics(output, finished)?;
    match &finished.density {
        Some((density, counts, checkpoints)) => write_density(output, density, counts, checkpoints),
        None => Ok(()),
    }
}

/// The model, its scene and the number of members.
pub fn title(finished: &Finished<'_>) -> String {
    let name = finished.model.description().name;
    let scene = finished.metadata["scene"].as_str().unwrap_or("all");
    let members = counted(finished.tally.members as usize, "member");
    match scene {
        "all" => format!("{name}, {members}"),
        scene => format!("{name}, scene {scene}, {members}"),
    }
}

/// The caption under the title of a picture.
pub fn caption(finished: &Finished<'_>, checkpoints: &[Checkpoint]) -> String {
    let Some((density, counts, _)) = &finished.density else {
        return String::new();
    };
    let states: u64 = counts.total().iter().sum();
    let mut text = format!("{states} states, sampling interval {}", density.every);
    if density.discard > 0.0 {
        text += &format!(", after {}", density.discard);
    }
    if let Some(last) = checkpoints.last() {
        text += "; distance between halves";
        if !last.over_time.is_nan() {
            text += &format!(" of the time {:.3},", last.over_time);
        }
        if !last.over_members.is_nan() {
            text += &format!(" of the members {:.3},", last.over_members);
        }
        text += &format!(" of independent states {:.3}", last.independent);
    }
    text
}

fn impacts(finished: &Finished<'_>) -> String {
    let description = finished.model.description();
    let impacts = &finished.tally.impacts;
    if impacts.is_empty() {
        return "none: the model has no surfaces".to_owned();
    }
    on_each(names::surfaces(description), impacts.iter().copied())
}

fn time(finished: &Finished<'_>) -> String {
    let seconds = finished.elapsed.as_secs_f64();
    let ran = finished.tally.members - finished.kept;
    let mut text = format!("{seconds:.2} s");
    if ran > 0 {
        text += &format!(
            " on {}, {:.0} members per second (functions: {})",
            counted(finished.threads as usize, "thread"),
            ran as f64 / seconds,
            finished.model.code().name()
        );
    }
    if finished.kept > 0 {
        text += &format!(
            " ({} taken over)",
            counted(finished.kept as usize, "member")
        );
    }
    text
}

/// A fraction of the states in words: `1/16`, .. `1/2`, `all`.
fn part(part: f64) -> String {
    match (1.0 / part).round() {
        1.0 => "all".to_owned(),
        parts => format!("1/{parts}"),
    }
}

/// `x in [-0.2, 0.2)`, with six significant digits.
fn range(axis: &Axis) -> String {
    let [low, high] = axis
        .range
        .map(|end| format!("{end:.5e}").parse().unwrap_or(end));
    format!("{} in [{low}, {high})", axis.name)
}

/// Writes mean, standard deviation and extremes of the energy and the outputs.
fn write_statistics(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let told = finished.statistics.iter().filter(|(_, sum)| sum.count > 0);
    let told: Vec<(&str, &ExactSum)> = told.collect();
    let Some(width) = told.iter().map(|(name, _)| name.len()).max() else {
        return Ok(());
    };
    let width = width.max("at the end".len());
    writeln!(
        output,
        "  {:width$} {:>16} {:>16} {:>16} {:>16} {:>9}",
        "at the end", "mean", "deviation", "least", "greatest", "members"
    )?;
    for (name, sum) in told {
        let values = [sum.mean(), sum.deviation(), sum.least, sum.greatest].map(|value| {
            let shown = if value.is_nan() {
                "-".to_owned()
            } else {
                short(value)
            };
            format!("{shown:>16}")
        });
        writeln!(
            output,
            "  {name:width$} {} {:>9}",
            values.join(" "),
            sum.count
        )?;
    }
    Ok(())
}

fn write_density(
    output: &mut dyn Write,
    density: &Density,
    counts: &Counts,
    checkpoints: &[Checkpoint],
) -> io::Result<()> {
    let [x, y] = &density.axes;
    let states: u64 = counts.total().iter().sum();
    writeln!(
        output,
        "  density     {states} states over {} and {}, {} x {} cells",
        range(x),
        range(y),
        x.bins,
        y.bins
    )?;
    if counts.outside() > 0 {
        writeln!(
            output,
            "              {} more outside of it: give the ranges, as in --density {}=A..B,{}=A..B",
            counts.outside(),
            x.name,
            y.name
        )?;
    }
    writeln!(
        output,
        "\n  total variation distance between the densities of two halves (1 if they have nothing in common)\n  \
         {:>6} {:>12} {:>9} {:>9} {:>12}",
        "part", "states", "time", "members", "independent"
    )?;
    for it in checkpoints {
        let distance = |value: f64| match value.is_nan() {
            true => "-".to_owned(),
            false => format!("{value:.4}"),
        };
        writeln!(
            output,
            "  {:>6} {:>12} {:>9} {:>9} {:>12}",
            part(it.part),
            it.samples,
            distance(it.over_time),
            distance(it.over_members),
            distance(it.independent)
        )?;
    }
    writeln!(
        output,
        "  independent: mean distance for as many independent states; a larger distance means that the density has not \
         converged"
    )
}
