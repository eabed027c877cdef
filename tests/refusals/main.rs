//! Checks the message of every mistake in a declaration, word for word, and the place it points at.
//!
//! Each file in `ui/TOPIC/` has one mistake. Every stored message is compared with the one that the generator gives,
//! without a compiler. The messages were stored with the compiler version in `ui/RUSTC`. In `.ci/run` that version also
//! compiles the first file of each topic, and nightly all of them; other versions are not compared. To store the
//! messages anew, run the nightly test with `TRYBUILD=overwrite`, read the difference, and write the new version into
//! `ui/RUSTC`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use dalembert_refusals as refusal;

/// Cases that need a compiler, and the reason. The compiler adds errors or warnings after the errors of the generator.
const COMPILED: [(&str, &str); 1] = [(
    "names/greek_lookalike",
    "`rustc` warns of letters that look alike",
)];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("ui")
}

/// Every case as `TOPIC/NAME`, with a source, a stored message or both.
fn cases() -> BTreeSet<String> {
    let names = |path: &Path| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(path).expect("a folder");
        entries
            .map(|entry| entry.expect("an entry").path())
            .collect()
    };
    let mut cases = BTreeSet::new();
    for topic in names(&folder()).iter().filter(|path| path.is_dir()) {
        for file in names(topic) {
            let case = file.strip_prefix(folder()).expect("a case");
            cases.insert(case.with_extension("").display().to_string());
        }
    }
    cases
}

fn is_compiled(case: &str) -> bool {
    COMPILED.iter().any(|(name, _)| *name == case)
}

/// The first case of each topic among those that need no compiler, and all cases that need one.
fn representatives() -> BTreeSet<String> {
    let (compiled, compared): (BTreeSet<String>, BTreeSet<String>) =
        cases().into_iter().partition(|case| is_compiled(case));
    let mut first = BTreeMap::new();
    for case in compared {
        let (topic, _) = case.split_once('/').expect("a topic");
        first.entry(topic.to_owned()).or_insert(case);
    }
    first.into_values().chain(compiled).collect()
}

/// Source and stored message of a case; for a file that cannot be read, the reason.
fn texts(case: &str) -> [String; 2] {
    ["rs", "stderr"].map(|kind| {
        let text = std::fs::read_to_string(folder().join(format!("{case}.{kind}")));
        text.unwrap_or_else(|error| format!("ui/{case}.{kind}: {error}"))
    })
}

/// The difference between the stored message of a case and the message of its source.
fn difference(case: &str, source: &str, stored: &str) -> Option<String> {
    let rendered = refusal::rendered(&format!("ui/{case}.rs"), source);
    let expected = refusal::with_whole_lines(stored, source);
    let fault = match (is_compiled(case), &rendered) {
        (true, Ok(text)) if *text == expected => "needs no compiler and is listed in `COMPILED`",
        (true, Ok(text)) if !expected.starts_with(text) => "begins otherwise",
        (true, _) => return None,
        (false, Ok(text)) if *text == expected => return None,
        (false, Ok(_)) => "differs",
        (false, Err(_)) => "needs a compiler and is not listed in `COMPILED`",
    };
    let text = rendered.unwrap_or_else(|reason| reason);
    Some(format!(
        "ui/{case}.stderr {fault}; stored is\n{stored}\nand the generator gives\n{text}\n"
    ))
}

#[test]
fn every_mistake_has_its_message_at_its_place() {
    let cases = cases();
    assert!(cases.len() >= 240, "{} cases", cases.len());
    for (case, _) in COMPILED {
        assert!(cases.contains(case), "ui/{case}.rs is listed and missing");
    }
    let differences: Vec<String> = cases
        .iter()
        .filter_map(|case| {
            let [source, stored] = texts(case);
            difference(case, &source, &stored)
        })
        .collect();
    assert!(
        differences.is_empty(),
        "{} differences:\n\n{}",
        differences.len(),
        differences.join("\n")
    );
}

#[test]
fn a_wrong_message_is_noticed() {
    let case = "declarations/two_models";
    let [source, stored] = texts(case);
    assert_eq!(difference(case, &source, &stored), None);
    for (right, wrong) in [
        ("error: expected", "error: found"),
        ("help: declare", "help: define"),
        (":3:5", ":4:5"),
        (":3:5", ":3:6"),
        ("    ^", "     ^"),
        ("^^^^^^", "^^^^^"),
    ] {
        let changed = stored.replacen(right, wrong, 1);
        let text = difference(case, &source, &changed).expect(wrong);
        assert!(text.starts_with("ui/declarations/two_models.stderr differs"));
        assert!(text.contains(&changed) && text.contains(&stored), "{text}");
    }
    assert!(difference(case, "fn main() {}", &stored).is_some());
}

#[test]
fn an_error_that_needs_a_compiler_is_listed() {
    let case = "constraints/dependent";
    let [source, stored] = texts(case);
    let two_lines = source.replace("2*d(x) -", "2*d(x)\n-");
    for source in ["\"", "model! {}", &two_lines] {
        let text = difference(case, source, &stored).expect(source);
        assert!(text.contains("is not listed in `COMPILED`"), "{text}");
    }
}

#[test]
fn a_line_that_the_compiler_cuts_is_compared_too() {
    let case = "limits/nesting";
    let [source, stored] = texts(case);
    for (right, wrong) in [
        ("...(", "...(("),
        (")...", ")"),
        (" ^", "  ^"),
        ("x)", "y)"),
    ] {
        let changed = stored.replacen(right, wrong, 1);
        assert_ne!(changed, stored);
        assert!(difference(case, &source, &changed).is_some(), "{changed}");
    }
}

#[test]
fn a_wrong_list_is_noticed() {
    let (case, _) = COMPILED[0];
    let [source, stored] = texts(case);
    assert_eq!(difference(case, &source, &stored), None);
    let (generated, _) = stored.split_once("\nwarning").expect("a warning");
    let needless = difference(case, &source, generated).expect("needless");
    assert!(needless.contains("needs no compiler"), "{needless}");
    let wrong = difference(case, &source, &stored[1..]).expect("wrong");
    assert!(wrong.contains("begins otherwise"), "{wrong}");
}

/// Compiles cases and compares the printed messages, if the compiler is the version in `ui/RUSTC`.
fn compile(cases: BTreeSet<String>) {
    let stored = std::fs::read_to_string(folder().join("RUSTC")).expect("ui/RUSTC");
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let version = Command::new(rustc)
        .arg("--version")
        .output()
        .expect("rustc");
    if String::from_utf8_lossy(&version.stdout).trim() != stored.trim() {
        println!(
            "nothing is compiled: messages were stored with {}",
            stored.trim()
        );
        return;
    }
    let compiler = trybuild::TestCases::new();
    for case in cases {
        compiler.compile_fail(format!("ui/{case}.rs"));
    }
}

#[test]
#[ignore = "builds the macro once more: `.ci/run` runs it"]
fn the_compiler_prints_the_messages_of_one_mistake_per_topic() {
    compile(representatives());
}

#[test]
#[ignore = "nightly: the compiler runs for every mistake"]
fn the_compiler_prints_every_message() {
    compile(cases());
}
