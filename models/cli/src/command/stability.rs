//! `stability`: the hard cases of the catalogue, each with its correct result, its measurement and a verdict.

mod document;
mod page;

use std::io::Write;
use std::path::Path;

use dalembert_driver::Integrator;

use crate::Streams;
use crate::args::StabilityArgs;
use crate::error::{CliError, counted};
use crate::exit::Exit;
use crate::names;
use crate::progress::Steps;
use crate::sink::{Sink, is_stdout};
use crate::suite::{self, Case, Finding, Verdict};

/// Carries out `stability`.
///
/// # Errors
/// Unknown names, a catalogue without cases, a file that cannot be written. Cases that fail are not an error but an
/// [`Exit`].
pub fn run(
    suite: &[Case],
    args: &StabilityArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let mut cases = selected(suite, args)?;
    check_outputs(args)?;
    let json = Sink::open_given("--json", args.json.as_deref())?;
    let html = Sink::open_given("--html", args.html.as_deref())?;
    let quiet = args.json.as_deref().is_some_and(is_stdout);

    if args
        .integrator
        .is_some_and(|integrator| !integrator.is_adaptive())
    {
        return Err(CliError::Usage(
            "--integrator: cases bound errors by tolerances; choose dop853, dopri5 or taylor",
        ));
    }
    let one = args.integrator.map(|integrator| [integrator]);
    let integrators: &[Integrator] = match &one {
        Some(one) => one,
        None => suite::every_integrator(),
    };
    cases.retain(|case| case.is_measured_by(integrators));
    if let (true, Some(integrator)) = (cases.is_empty(), args.integrator) {
        return Err(CliError::value(
            "--integrator",
            integrator.name(),
            "an integrator by which the cases are measured",
        ));
    }
    let mut progress = Steps::new(cases.len(), streams.terminal);
    let mut findings = Vec::with_capacity(cases.len());
    for case in cases {
        progress.begin(&format!("{} {}", case.id, case.title));
        let finding = suite::examine(case, integrators);
        if !quiet {
            progress.aside(|| write_finding(streams.output, &finding))?;
        }
        findings.push(finding);
    }
    progress.finish();
    if !quiet {
        write_totals(streams.output, &findings)?;
    }
    if let Some(sink) = json {
        sink.write(streams, |output| document::write(output, &findings))?;
    }
    if let Some(sink) = html {
        let page = page::page(&findings).map_err(|reason| CliError::Plot {
            flag: "--html",
            path: sink.path(),
            reason,
        })?;
        sink.write(streams, |output| output.write_all(page.as_bytes()))?;
    }
    let fails = findings
        .iter()
        .any(|finding| finding.verdict == Verdict::Fail);
    Ok(if fails { Exit::Other } else { Exit::Reached })
}

/// The requested cases, in the order of the suite.
fn selected<'a>(suite: &'a [Case], args: &StabilityArgs) -> Result<Vec<&'a Case>, CliError> {
    if suite.is_empty() {
        return Err(CliError::Usage(
            "stability: this command line has no cases; those of dalembert are in the package `dalembert-stability`, cases of your own are \
             set with `Catalogue::of(models![..]).with_suite(cases).run()`",
        ));
    }
    let mut sections: Vec<&str> = suite.iter().map(Case::section).collect();
    sections.dedup();
    for id in &args.case {
        names::find("--case", "case", id, suite.iter().map(|case| case.id))?;
    }
    for letter in &args.section {
        names::find("--section", "section", letter, sections.iter().copied())?;
    }
    let everything = args.case.is_empty() && args.section.is_empty();
    let is_asked_for = |case: &&Case| {
        let by_id = args.case.iter().any(|id| id == case.id);
        let by_section = everything || args.section.iter().any(|letter| letter == case.section());
        by_id || (by_section && (args.nightly || !case.nightly))
    };
    Ok(suite.iter().filter(is_asked_for).collect())
}

fn check_outputs(args: &StabilityArgs) -> Result<(), CliError> {
    let is_page = |path: &Path| {
        path.extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("html"))
    };
    match &args.html {
        Some(path) if !is_page(path) => Err(CliError::value(
            "--html",
            path.display().to_string(),
            "a file name that ends in .html",
        )),
        _ => Ok(()),
    }
}

fn write_finding(output: &mut dyn Write, finding: &Finding) -> std::io::Result<()> {
    let Case {
        id,
        title,
        right,
        bound,
        ..
    } = finding.case;
    let verdict = finding.verdict.name();
    writeln!(output, "{id:5} {verdict:8} {title}")?;
    writeln!(output, "{:14} right    {right}", "")?;
    writeln!(output, "{:14} bound    {bound}", "")?;
    let seconds = finding.elapsed.as_secs_f64();
    match finding.verdict {
        Verdict::Pending => writeln!(output, "{:14} pending  {}", "", finding.measured),
        _ => writeln!(
            output,
            "{:14} measured {}{}, {seconds:.2} s",
            "",
            finding.measured,
            setting_words(finding)
        ),
    }
}

/// The setting in parentheses, such as ` (dop853, steps of 0.25)`, if the case depends on it.
fn setting_words(finding: &Finding) -> String {
    match (finding.case.run, finding.setting) {
        (suite::Run::Once(_), _) | (_, None) => String::new(),
        (_, Some(setting)) => format!(" ({})", setting.words()),
    }
}

fn write_totals(output: &mut dyn Write, findings: &[Finding]) -> std::io::Result<()> {
    let count = |verdict| {
        findings
            .iter()
            .filter(|finding| finding.verdict == verdict)
            .count()
    };
    let seconds: f64 = findings
        .iter()
        .map(|finding| finding.elapsed.as_secs_f64())
        .sum();
    writeln!(
        output,
        "{}: {} pass, {} fail, {} pending, {seconds:.1} s",
        counted(findings.len(), "case"),
        count(Verdict::Pass),
        count(Verdict::Fail),
        count(Verdict::Pending),
    )?;
    for finding in findings
        .iter()
        .filter(|finding| finding.verdict == Verdict::Fail)
    {
        writeln!(output, "failed: {} {}", finding.case.id, finding.measured)?;
    }
    Ok(())
}
