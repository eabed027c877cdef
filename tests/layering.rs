//! Allowed dependencies: the rules of `docs/architecture.md`, checked in the sources.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Every Rust file below a folder, with its text.
fn sources(folder: &str) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    let mut pending = vec![root().join(folder)];
    while let Some(path) = pending.pop() {
        if path.is_dir() {
            let entries = std::fs::read_dir(&path).expect("a folder");
            pending.extend(entries.map(|entry| entry.expect("an entry").path()));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = std::fs::read_to_string(&path).expect("text");
            found.push((path, text));
        }
    }
    assert!(!found.is_empty(), "{folder} holds no sources");
    found.sort();
    found
}

/// True if a source lies in a folder `tests` below `src`.
fn is_inside_tests(path: &Path) -> bool {
    let parts: Vec<_> = path.iter().collect();
    let source = parts.iter().rposition(|part| *part == "src");
    source.is_some_and(|source| parts[source..].iter().any(|part| *part == "tests"))
}

/// True if a line contains a text that does not continue a longer name: `ArrayVec<` does not contain `Vec<`.
fn has_word(line: &str, word: &str) -> bool {
    line.match_indices(word).any(|(place, _)| {
        let before = line[..place].chars().next_back();
        !before.is_some_and(|c| c.is_alphanumeric() || c == '_')
    })
}

/// The file of the runtime that may own values on the heap, with the feature `std`.
const OWNERS: &str = "numbers/src/held.rs";

/// The type of an owner on the heap.
const OWNER: &[&str] = &["Box<"];

/// Asserts that no code in a folder contains these texts. Comments may, and [`OWNERS`] may contain an [`OWNER`].
fn assert_absent(folder: &str, forbidden: &[&str]) {
    for (path, text) in sources(folder) {
        // Tests of a stage may run later stages.
        let may_own = path.ends_with(OWNERS) && forbidden == OWNER;
        if path.ends_with("tests.rs") || is_inside_tests(&path) || may_own {
            continue;
        }
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            for word in forbidden {
                assert!(
                    !has_word(code, word),
                    "{}:{}: `{word}`",
                    path.display(),
                    number + 1
                );
            }
        }
    }
}

#[test]
fn the_audit_of_events_shares_no_code_with_their_search() {
    assert_absent("runtime/src/audit", &["events::", "impacts::", "StepView"]);
}

#[test]
fn expressions_know_no_tokens_and_no_mechanics() {
    assert_absent(
        "codegen/expr/src",
        &[
            "proc_macro2",
            "syn::",
            "quote::",
            "lagrangian",
            "constraint",
        ],
    );
}

#[test]
fn mathematics_knows_no_tokens() {
    for folder in [
        "codegen/src/mechanics",
        "codegen/src/claims",
        "codegen/src/program",
    ] {
        assert_absent(
            folder,
            &["proc_macro2", "syn::", "quote::", "quote!", "Span"],
        );
    }
}

#[test]
fn a_stage_uses_only_those_to_its_left() {
    let stages = ["spec", "model", "mechanics", "claims", "program", "tables"];
    for (k, stage) in stages.iter().enumerate() {
        let later: Vec<String> = stages[k + 1..]
            .iter()
            .map(|later| format!("crate::{later}::"))
            .collect();
        let later: Vec<&str> = later.iter().map(String::as_str).collect();
        assert_absent(&format!("codegen/src/{stage}"), &later);
    }
}

/// The modules of the runtime, each after the modules that it uses.
const RUNTIME: [&str; 40] = [
    "error",
    "state",
    "per_surface",
    "jet",
    "linalg",
    "policy",
    "quadrature",
    "law",
    "outcome",
    "contract",
    "nearest",
    "rank",
    "record",
    "action",
    "audit",
    "work",
    "integrate",
    "run",
    "forces",
    "effects",
    "events",
    "narrow",
    "chart",
    "independence",
    "simulation",
    "impacts",
    "inputs",
    "describe",
    "integrals",
    "generated",
    "initial",
    "projection",
    "kernels",
    "variations",
    "modes",
    "erased",
    "declaration",
    "extended",
    "lanes",
    "certified",
];

#[test]
fn a_module_of_the_runtime_uses_only_those_before_it() {
    let entries = std::fs::read_dir(root().join("runtime/src")).expect("a folder");
    let names = entries.map(|entry| entry.expect("an entry").path());
    let mut names: Vec<String> = names
        .map(|path| {
            path.file_stem()
                .expect("a name")
                .to_string_lossy()
                .into_owned()
        })
        .filter(|name| name != "lib")
        .collect();
    names.sort();
    let mut listed = RUNTIME;
    listed.sort_unstable();
    assert_eq!(names, listed);
    for (k, module) in RUNTIME.iter().enumerate() {
        let later: Vec<String> = RUNTIME[k + 1..]
            .iter()
            .map(|later| format!("crate::{later}"))
            .collect();
        for (path, text) in sources("runtime/src") {
            let inside = path
                .strip_prefix(root().join("runtime/src"))
                .expect("inside");
            let top = inside.iter().next().expect("a name").to_string_lossy();
            if top.trim_end_matches(".rs") != *module {
                continue;
            }
            let code = without_tests(&text);
            assert!(!code.contains("use crate::{"), "{}", path.display());
            for later in &later {
                let ends = |(place, found): (usize, &str)| {
                    let next = code[place + found.len()..].chars().next();
                    !next.is_some_and(|c| c.is_alphanumeric() || c == '_')
                };
                assert!(
                    !code.match_indices(later.as_str()).any(ends),
                    "{}: `{later}`",
                    path.display()
                );
            }
        }
    }
}

/// A source without its comments and without the module of its tests.
fn without_tests(text: &str) -> String {
    let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let lines = code.lines();
    let lines = lines.map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn the_runtime_is_bare() {
    for folder in ["runtime/src", "runtime/numbers/src"] {
        assert_absent(
            folder,
            &[
                "extern crate alloc",
                "alloc::",
                "Vec<",
                "String",
                "unsafe {",
            ],
        );
        assert_absent(folder, OWNER);
        assert_absent(folder, &["Box::"]);
        let text = std::fs::read_to_string(root().join(folder).join("lib.rs")).expect("text");
        assert!(text.contains("#![forbid(unsafe_code)]"));
        assert!(text.contains("no_std"));
    }
}

#[test]
fn only_calls_of_machine_code_are_unchecked() {
    for folder in ["codegen", "macros/src", "models", "benches", "python/src"] {
        assert_absent(folder, &["unsafe {", "unsafe extern"]);
    }
    for (path, text) in sources("jit/src") {
        let is_native = path.components().any(|part| part.as_os_str() == "native");
        let is_unchecked = text.contains("unsafe {") || text.contains("allow(unsafe_code)");
        assert!(is_native || !is_unchecked, "{}", path.display());
    }
}

#[test]
fn the_macro_does_nothing_but_expand() {
    let text = std::fs::read_to_string(root().join("macros/src/lib.rs")).expect("text");
    let code = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .collect::<Vec<_>>()
        .join("\n");
    assert!(code.contains("dalembert_emit::expand"));
    assert!(code.lines().count() < 20, "{code}");
}

#[test]
fn the_project_stands_alone() {
    let place = root().canonicalize().expect("the checkout");
    let place = place.to_str().expect("a path in Unicode");
    for folder in [
        "codegen",
        "jit",
        "macros/src",
        "runtime",
        "models",
        "tests",
        "benches",
        "examples",
        "python/src",
    ] {
        for (path, text) in sources(folder) {
            if path.ends_with("layering.rs") {
                continue;
            }
            // Paths of neighbours of the checkout, and of the checkout itself, are forbidden.
            for outside in ["../shared", "/home/", place] {
                assert!(!text.contains(outside), "{}: {outside}", path.display());
            }
        }
    }
}

/// Generated functions hide constants with the names of their arguments. The generator lists these names, and the
/// runtime has a function for each.
#[test]
fn the_arguments_of_generated_functions_have_one_list() {
    let read = |path| std::fs::read_to_string(root().join(path)).expect("text");
    let (names, runtime) = (
        read("codegen/emit/src/names.rs"),
        read("runtime/src/generated.rs"),
    );
    let part = |text: &str, begin, end| {
        let (_, rest) = text.split_once(begin).expect("its begin");
        rest.split_once(end).expect("its end").0.to_string()
    };
    let used = part(&names, "const ARGUMENTS", "];");
    let used: Vec<&str> = used.split('"').skip(1).step_by(2).collect();
    let hidden = part(&runtime, "pub mod arguments {", "\n}");
    let hidden: Vec<&str> = hidden.split("pub fn ").skip(1).collect();
    let hidden: Vec<&str> = hidden
        .iter()
        .map(|it| it.split('(').next().expect("a name"))
        .collect();
    assert!(used.len() > 20, "{used:?}");
    assert_eq!(used, hidden);
}

/// Names that a crate exports at its root.
fn names_at_root(path: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join(path)).expect("a crate");
    let uses = text.split("pub use ").skip(1);
    let listed = uses.flat_map(|rest| {
        let names = rest.split(';').next().unwrap_or_default();
        names.split(|c: char| !c.is_alphanumeric() && c != '_')
    });
    listed.map(str::to_owned).collect()
}

/// The name of a public trait that a line declares.
fn declared_trait(line: &str) -> Option<&str> {
    let name = line.strip_prefix("pub trait ")?;
    name.split(|c: char| !c.is_alphanumeric()).next()
}

#[test]
fn every_trait_that_users_meet_has_an_example() {
    let crates = [
        ("runtime/src", "runtime/src/lib.rs"),
        ("runtime/numbers/src", "runtime/numbers/src/lib.rs"),
    ];
    let mut found = 0;
    for (folder, root) in crates {
        let names = names_at_root(root);
        for (path, text) in sources(folder) {
            let lines: Vec<&str> = text.lines().collect();
            for (k, line) in lines.iter().enumerate() {
                let Some(name) =
                    declared_trait(line).filter(|name| names.iter().any(|it| it == name))
                else {
                    continue;
                };
                let above = lines[..k].iter().rev();
                let documentation = above.take_while(|line| !line.is_empty());
                let has_example = documentation.clone().any(|line| *line == "/// # Examples");
                assert!(has_example, "{}: `{name}` has no example", path.display());
                found += 1;
            }
        }
    }
    assert!(found > 20, "{found} traits");
}
