//! Sources in which `«..»` marks the place of an error.

use dalembert_codegen::diagnostics::{Diagnostics, Location};

/// The message of each error, with the source text at its first place.
pub fn reported(source: &str, diagnostics: &Diagnostics) -> Vec<(String, String)> {
    let stretch = |at: Location| {
        let range = at.first.byte_range().start..at.last.byte_range().end;
        source.get(range).unwrap_or_default().to_owned()
    };
    diagnostics
        .iter()
        .map(|error| (error.message().to_owned(), stretch(error.places()[0].0)))
        .collect()
}

/// The source without the marks `«` and `»`, and the text between them.
pub fn unmarked(source: &str) -> (String, String) {
    let marked = source
        .split_once('«')
        .and_then(|(_, rest)| rest.split_once('»'))
        .map_or("", |(marked, _)| marked);
    (source.replace(['«', '»'], ""), marked.to_owned())
}
