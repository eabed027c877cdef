//! A map in a few lines of text.

use std::io::{self, Write};

use super::Finished;
use crate::error::counted;
use crate::map::Orbit;
use crate::names;
use crate::scalar::full;

/// Largest number of orbits that are listed.
const TOLD: usize = 8;

/// Writes the summary.
///
/// # Errors
/// An I/O error of the stream.
pub fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let Finished { sums, settings, .. } = finished;
    writeln!(output, "{}", title(finished))?;
    for (index, class) in sums.sorted_classes().into_iter().enumerate() {
        let (name, cells) = &sums.classes[class];
        let head = if index == 0 { "classes" } else { "" };
        let share = 100.0 * *cells as f64 / sums.cells.max(1) as f64;
        writeln!(output, "  {head:<11} {name}: {cells} ({share:.1} %)")?;
    }
    for (index, orbit) in sums.orbits.all().iter().take(TOLD).enumerate() {
        let head = format!("orbit {}", index + 1);
        writeln!(output, "  {head:<11} {}", point(finished, orbit))?;
    }
    let more = sums.orbits.all().len().saturating_sub(TOLD);
    if more > 0 {
        writeln!(output, "              and {more} more")?;
    }
    if !sums.orbits.all().is_empty() && finished.model.depends_on_time() {
        let note = "the motion depends on time: orbits repeat as far as the runs go";
        writeln!(output, "  note        {note}")?;
    }
    if let Some(reason) = &sums.reason {
        writeln!(
            output,
            "  refused     {}, the first: {reason}",
            counted(sums.refused as usize, "cell")
        )?;
    }
    writeln!(
        output,
        "  integrator  {}, {} form, tol {:e}",
        settings.integrator.name(),
        settings.form.name(),
        settings.tol
    )?;
    writeln!(output, "  time        {}", time(finished))
}

/// The model, its scene and the size of the grid.
pub fn title(finished: &Finished<'_>) -> String {
    let scene = finished.metadata["scene"].as_str().unwrap_or("all");
    let model = names::titled(finished.model.description(), scene);
    let counts = finished.axes.iter().map(|axis| axis.count.to_string());
    let grid = counts.collect::<Vec<_>>().join(" x ");
    format!("{model}, {grid} cells")
}

/// The caption under the title of a picture.
pub fn caption(finished: &Finished<'_>) -> String {
    let Finished {
        request, settings, ..
    } = finished;
    let mut parts = Vec::new();
    if request.plane.is_some() {
        parts.push(format!("ends of the runs until {}", settings.until));
    } else if let Some(returns) = &request.returns {
        let description = finished.model.description();
        let surface = names::surfaces(description).nth(returns.surface);
        parts.push(format!(
            "{} to {}",
            counted(returns.count as usize, "return"),
            surface.unwrap_or_default()
        ));
    } else {
        parts.push(format!("until {}", settings.until));
    }
    if let Some(fail) = &request.fail {
        parts.push(format!("failed where {}", fail.expression.text()));
    }
    parts.join("; ")
}

/// The classes with their numbers of cells.
pub fn classes(finished: &Finished<'_>) -> String {
    let sums = &finished.sums;
    let sorted = sums.sorted_classes().into_iter();
    let told = sorted.map(|class| {
        let (name, cells) = &sums.classes[class];
        format!("{name}: {cells}")
    });
    told.collect::<Vec<_>>().join("; ")
}

/// `period 1, back at xi = .., eta = ..`
fn point(finished: &Finished<'_>, orbit: &Orbit) -> String {
    let names = finished.request.components.names.iter();
    let values = names.zip(&orbit.point);
    let values: Vec<String> = values
        .map(|(name, value)| format!("{name} = {}", full(*value)))
        .collect();
    format!("period {}, back at {}", orbit.period, values.join(", "))
}

fn time(finished: &Finished<'_>) -> String {
    let seconds = finished.elapsed.as_secs_f64();
    let ran = finished.sums.cells - finished.kept;
    let mut text = format!("{seconds:.2} s");
    if ran > 0 {
        text += &format!(
            " on {}, {:.0} cells per second",
            counted(finished.threads as usize, "thread"),
            ran as f64 / seconds
        );
    }
    text += &format!(
        ", {} in all",
        counted(finished.sums.returns as usize, "return")
    );
    if finished.kept > 0 {
        text += &format!(" ({} taken over)", counted(finished.kept as usize, "cell"));
    }
    text
}
