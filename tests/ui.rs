//! Every mistake in a declaration: the compiler's message, word for word, and the place it points at.
//!
//! One mistake per file in `ui/TOPIC/`. The messages were stored with the compiler named in `ui/RUSTC`; under any
//! other compiler only the refusal itself is checked. To store them anew, run this test with
//! `TRYBUILD=overwrite`, read the difference, and write the new version into `ui/RUSTC`.

use std::path::{Path, PathBuf};
use std::process::Command;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("ui")
}

/// Every case, in order.
fn cases() -> Vec<PathBuf> {
    let mut found = Vec::new();
    for topic in std::fs::read_dir(folder())
        .expect("ui")
        .map(|entry| entry.expect("an entry").path())
    {
        if topic.is_dir() {
            let files = std::fs::read_dir(topic)
                .expect("a topic")
                .map(|entry| entry.expect("an entry").path());
            found.extend(
                files.filter(|file| file.extension().is_some_and(|extension| extension == "rs")),
            );
        }
    }
    found.sort();
    found
}

/// The declaration inside `dalembert::model! { .. }`.
fn declaration(text: &str) -> &str {
    let (_, after) = text.split_once("dalembert::model! {").expect("a model");
    let end = after.rfind("fn main").expect("a main function");
    after[..end]
        .trim_end()
        .strip_suffix('}')
        .expect("a closing brace")
}

#[test]
fn every_mistake_is_refused() {
    let cases = cases();
    assert!(cases.len() >= 100, "{} cases", cases.len());
    for case in cases {
        let text = std::fs::read_to_string(&case).expect("text");
        let Ok(tokens) = declaration(&text).parse() else {
            continue;
        };
        let refused = dalembert_codegen::try_expand(tokens);
        assert!(refused.is_err(), "{} is accepted", case.display());
    }
}

#[test]
fn every_mistake_has_its_message_at_its_place() {
    let stored = std::fs::read_to_string(folder().join("RUSTC")).expect("ui/RUSTC");
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let version = Command::new(rustc)
        .arg("--version")
        .output()
        .expect("rustc");
    if String::from_utf8_lossy(&version.stdout).trim() != stored.trim() {
        println!(
            "messages were stored with {}; only refusals are checked",
            stored.trim()
        );
        return;
    }
    trybuild::TestCases::new().compile_fail("ui/*/*.rs");
}
