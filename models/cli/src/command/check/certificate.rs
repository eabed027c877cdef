//! The certificate of a model as JSON: the objects of its claims and the grounds of the verdicts.

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
    let entry = |own: &Report| json!({ "name": own.name, "content": value(&own.certificate) });
    let parts: Vec<Value> = match report {
        Some(report) => [report]
            .into_iter()
            .chain(&report.scenes)
            .filter(|own| own.certificate != Tree::Absent)
            .map(entry)
            .collect(),
        None => Vec::new(),
    };
    let name = report.map(|own| own.name.as_str());
    let document = json!({ "format": FORMAT, "model": name, "parts": parts });
    serde_json::to_writer_pretty(&mut *output, &document)?;
    writeln!(output)
}

fn value(tree: &Tree) -> Value {
    match tree {
        Tree::Absent => Value::Null,
        Tree::Flag(own) => Value::from(*own),
        Tree::Number(own) => number(*own),
        Tree::Integer(own) => Value::from(*own),
        Tree::Text(own) => Value::from(own.as_str()),
        Tree::List(own) => own.iter().map(value).collect(),
        Tree::Record(own) => {
            let pairs = own
                .iter()
                .map(|(name, own)| ((*name).to_owned(), value(own)));
            Value::Object(pairs.collect::<Map<_, _>>())
        }
    }
}
