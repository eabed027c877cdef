//! The certificate of a model as JSON: the expressions of its claims and the grounds of the verdicts.

use std::io::{self, Write};

use dalembert_codegen::report::Report;
use dalembert_codegen::report::certificate::{FORMAT, Tree};
use serde_json::{Map, Value, json};

use crate::json::number;

/// Writes the certificate: the model itself, then its scenes or modes.
///
/// # Errors
/// An I/O error of the stream.
pub fn write(output: &mut dyn Write, report: Option<&Report>) -> io::Result<()> {
    let entry =
        |report: &Report| json!({ "name": report.name, "content": value(&report.certificate) });
    let parts: Vec<Value> = match report {
        Some(report) => [report]
            .into_iter()
            .chain(&report.scenes)
            .filter(|report| report.certificate != Tree::Absent)
            .map(entry)
            .collect(),
        None => Vec::new(),
    };
    let name = report.map(|report| report.name.as_str());
    let document = json!({ "format": FORMAT, "model": name, "parts": parts });
    serde_json::to_writer_pretty(&mut *output, &document)?;
    writeln!(output)
}

fn value(tree: &Tree) -> Value {
    match tree {
        Tree::Absent => Value::Null,
        Tree::Flag(flag) => Value::from(*flag),
        Tree::Number(value) => number(*value),
        Tree::Integer(integer) => Value::from(*integer),
        Tree::Text(text) => Value::from(text.as_str()),
        Tree::List(list) => list.iter().map(value).collect(),
        Tree::Record(record) => {
            let pairs = record
                .iter()
                .map(|(name, entry)| ((*name).to_owned(), value(entry)));
            Value::Object(pairs.collect::<Map<_, _>>())
        }
    }
}
