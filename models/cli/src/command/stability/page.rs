//! The findings as one self-contained page.

use std::fmt::Write as _;

use crate::gallery::escaped;
use crate::plot::logarithmic;
use crate::suite::{Curve, Finding, Verdict};

const STYLE: &str = "body{font:15px/1.45 sans-serif;color:#323232;max-width:1000px;margin:2em auto;padding:0 1em}\
table{border-collapse:collapse;width:100%}td,th{text-align:left;vertical-align:top;padding:.35em .6em;\
border-bottom:1px solid #e2e5e9}th{font-weight:600}.pass{color:#009e73}.fail{color:#d55e00;font-weight:700}\
.pending{color:#696969}small{color:#696969}figure{margin:1.5em 0}svg{max-width:100%;height:auto}";

/// The page.
///
/// # Errors
/// An error of the drawing library.
pub fn page(findings: &[Finding]) -> Result<String, String> {
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>dalembert stability</title>\
         <style>{STYLE}</style></head><body>\n<h1>Hard cases</h1>\n<p>{}</p>\n",
        totals(findings)
    );
    page += "<table><thead><tr><th>Case</th><th>Right result</th><th>Bound</th><th>Measured</th><th>Verdict</th></tr></thead>\n<tbody>\n";
    for finding in findings {
        page += &row(finding);
    }
    page += "</tbody></table>\n";
    for finding in findings {
        page += &figures(finding)?;
    }
    page += "</body></html>\n";
    Ok(page)
}

fn totals(findings: &[Finding]) -> String {
    let words = [Verdict::Pass, Verdict::Fail, Verdict::Pending].map(|verdict| {
        let count = findings
            .iter()
            .filter(|finding| finding.verdict == verdict)
            .count();
        format!("{count} {}", verdict.name())
    });
    words.join(", ")
}

fn row(finding: &Finding) -> String {
    let case = finding.case;
    let verdict = finding.verdict.name();
    let by = finding.setting.map_or(String::new(), |setting| {
        format!("<br><small>{}</small>", setting.words())
    });
    format!(
        "<tr><td><b>{}</b><br>{}</td><td>{}</td><td>{}</td><td>{}{by}</td><td class=\"{verdict}\">{verdict}</td></tr>\n",
        case.id,
        escaped(case.title),
        escaped(case.right),
        escaped(case.bound),
        escaped(&finding.measured),
    )
}

/// Figures of the curves. Curves with the same axes share a figure, across all settings.
fn figures(finding: &Finding) -> Result<String, String> {
    let mut groups: Vec<([&str; 2], Vec<Curve>)> = Vec::new();
    for (setting, report) in &finding.reports {
        for curve in &report.curves {
            let mut curve = curve.clone();
            if finding.reports.len() > 1 {
                let _ = write!(curve.name, ", {}", setting.words());
            }
            match groups.iter_mut().find(|(axes, _)| *axes == curve.axes) {
                Some((_, curves)) => curves.push(curve),
                None => groups.push((curve.axes, vec![curve])),
            }
        }
    }
    let mut figures = String::new();
    for (_, curves) in &groups {
        let title = format!("{} {}", finding.case.id, finding.case.title);
        let svg = logarithmic::draw(&title, finding.case.bound, curves)?;
        let _ = writeln!(figures, "<figure>{svg}</figure>");
    }
    Ok(figures)
}
