//! The findings as one JSON document.

use std::io::{self, Write};

use serde_json::{Value, json};

use crate::json::{Document, number, vector};
use crate::suite::{Finding, Report, Setting, Verdict};

/// Writes the document.
///
/// # Errors
/// An I/O error of the stream.
pub fn write(output: &mut dyn Write, findings: &[Finding]) -> io::Result<()> {
    let mut document = Document::begin(output)?;
    let passed = findings
        .iter()
        .all(|finding| finding.verdict != Verdict::Fail);
    document.field("passed", passed)?;
    document.rows("cases", findings.iter().map(finding_json))?;
    document.end()
}

fn finding_json(finding: &Finding) -> Value {
    let case = finding.case;
    json!({
        "id": case.id,
        "title": case.title,
        "right": case.right,
        "bound": case.bound,
        "nightly": case.nightly,
        "verdict": finding.verdict.name(),
        "measured": finding.measured,
        "seconds": number(finding.elapsed.as_secs_f64()),
        "settings": finding.reports.iter().map(setting_json).collect::<Vec<_>>(),
    })
}

fn setting_json((setting, report): &(Setting, Report)) -> Value {
    let checks = report.checks.iter().map(|check| {
        json!({
            "what": check.what,
            "measured": check.words,
            "share_of_bound": number(check.share),
            "passed": check.passes(),
        })
    });
    let curves = report.curves.iter().map(|curve| {
        let points: Vec<Value> = curve.points.iter().map(|point| vector(point)).collect();
        json!({ "name": curve.name, "axes": curve.axes, "points": points })
    });
    json!({
        "integrator": setting.integrator.name(),
        "max_step": setting.max_step,
        "dense": setting.dense,
        "checks": checks.collect::<Vec<_>>(),
        "curves": curves.collect::<Vec<_>>(),
    })
}
