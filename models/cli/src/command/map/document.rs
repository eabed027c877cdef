//! A map as one JSON document: metadata, classes and orbits.

use std::io::{self, Write};

use serde_json::{Map, Value, json};

use super::Finished;
use crate::json::{Document, named, number};

/// Writes the document.
///
/// # Errors
/// An I/O error of the stream.
pub fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let Finished { sums, .. } = finished;
    let mut document = Document::begin(output)?;
    let kept = finished.metadata.iter();
    for (key, value) in kept.filter(|(key, _)| !["density", "shard"].contains(&key.as_str())) {
        document.field(key, value.clone())?;
    }
    let axes = finished.axes.iter();
    let axes = axes.map(|axis| {
        json!({
            "name": axis.name,
            "first": number(axis.ends[0]),
            "last": number(axis.ends[1]),
            "count": axis.count,
        })
    });
    document.rows("axes", axes)?;
    document.field("cells", sums.cells)?;
    document.field("returns", sums.returns)?;
    let classes = sums.sorted_classes().into_iter();
    let classes = classes.map(|class| {
        let (name, cells) = &sums.classes[class];
        (name.clone(), Value::from(*cells))
    });
    document.field("classes", classes.collect::<Map<_, _>>())?;
    let names = || finished.request.components.names.iter().map(String::as_str);
    let orbits = sums.orbits.all().iter().enumerate();
    let orbits = orbits.map(|(index, orbit)| {
        json!({
            "orbit": index + 1,
            "period": orbit.period,
            "cells": orbit.cells,
            "point": named(names(), &orbit.point),
        })
    });
    document.rows("orbits", orbits)?;
    document.field("refused", sums.refused)?;
    document.field("first_refused", sums.reason.clone())?;
    document.end()
}
