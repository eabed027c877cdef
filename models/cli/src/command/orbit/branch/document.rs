//! A branch as one JSON document.

use std::io::{self, Write};

use dalembert_driver::{BranchEnd, Member};
use serde_json::{Value, json};

use super::super::document::{begin, end_missed, multiplier, state};
use super::{Followed, reason};
use crate::json::{number, vector};
use crate::names;

/// Writes the document.
///
/// # Errors
/// An I/O error of the stream.
pub fn write(output: &mut dyn Write, followed: &Followed<'_>) -> io::Result<()> {
    let mut document = begin(output, &followed.finished)?;
    if let Some(symmetries) = &followed.finished.search.modulo {
        let fields = symmetries.generators().iter();
        let fields: Vec<&str> = fields.map(|field| field.name.as_str()).collect();
        document.field("modulo", fields)?;
    }
    document.field("parameter", followed.name())?;
    let range = followed.request.extent.range.map(number);
    document.field("range", Value::from(range.to_vec()))?;
    if let (Some(name), Some(across)) = (followed.across(), &followed.request.across) {
        let range = across.range.map(number);
        document.field("across", json!({ "parameter": name, "range": range }))?;
    }
    let branch = match &followed.finished.result {
        Err(missed) => return end_missed(document, &followed.finished, missed),
        Ok(branch) => branch,
    };
    let kind = match branch.points.is_empty() {
        true => "out_of_reach",
        false => "done",
    };
    document.field("outcome", json!({ "kind": kind }))?;
    let bifurcations = branch.points.iter();
    let bifurcations = bifurcations.filter(|member| member.bifurcation.is_some());
    document.rows("bifurcations", bifurcations.map(member))?;
    document.rows(
        "ends",
        ends(followed, &branch.points, &branch.ends).into_iter(),
    )?;
    document.rows("points", branch.points.iter().map(member))?;
    if followed.request.across.is_some() {
        let curves = branch.curves.iter().map(|curve| {
            json!({
                "bifurcation": curve.bifurcation.name(),
                "ends": ends(followed, &curve.points, &curve.ends),
                "points": curve.points.iter().map(member).collect::<Vec<Value>>(),
            })
        });
        document.rows("curves", curves)?;
    }
    document.end()
}

/// Both ends of a branch, or of a curve of bifurcations.
fn ends(followed: &Followed<'_>, points: &[Member], ends: &[BranchEnd; 2]) -> [Value; 2] {
    let description = followed.finished.model.description();
    let told = |end: &BranchEnd, member: Option<&Member>| {
        let surface = match end {
            BranchEnd::Grazing { surface } => names::surfaces(description).nth(*surface),
            _ => None,
        };
        let mut told = json!({
            "kind": end.kind(),
            "parameter": member.map(|member| number(member.parameter)),
            "surface": surface,
            "reason": reason(followed, end),
        });
        if let Some(second) = member.and_then(|member| member.second) {
            told["second"] = number(second);
        }
        told
    };
    [
        told(&ends[0], points.first()),
        told(&ends[1], points.last()),
    ]
}

fn member(member: &Member) -> Value {
    let multipliers: Vec<Value> = member.multipliers.iter().map(multiplier).collect();
    let mut told = json!({
        "parameter": number(member.parameter),
        "period": number(member.period),
        "before": state(&member.before),
        "after": state(&member.after),
        "multipliers": multipliers,
        "stability": member.stability.name(),
        "bifurcation": member.bifurcation.map(|it| it.name()),
        "residual": number(member.residual),
        "advance": vector(&member.element),
    });
    if let Some(second) = member.second {
        told["second"] = number(second);
    }
    told
}
