//! The expansion of a few models, formatted. Read the difference before accepting it:
//! `ACCEPT=1 cargo test --release -p dalembert-tests --test golden`.

use std::path::Path;

use dalembert::Described;
use dalembert_models::{ChaplyginSleigh, DoublePendulum, RollingDisk, TwoWheelsRod};

fn expansion(source: &str) -> String {
    let tokens = dalembert_codegen::try_expand(source.parse().expect("tokens")).expect("a model");
    let text = prettyplease::unparse(&syn::parse2(tokens).expect("items"));
    // How the declaration itself is spelled depends on who turned it into tokens.
    let is_source = |line: &&str| line.trim_start().starts_with("source: ");
    text.lines()
        .filter(|line| !is_source(line))
        .map(|line| format!("{line}\n"))
        .collect()
}

fn compare<S: Described>() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join(format!("golden/{}.rs.txt", S::DESCRIPTION.name));
    let actual = expansion(S::DESCRIPTION.source);
    assert_eq!(
        actual,
        expansion(S::DESCRIPTION.source),
        "the same input gives the same output"
    );
    if std::env::var_os("ACCEPT").is_some() {
        std::fs::write(&path, &actual).expect("a writable folder");
    }
    let stored = std::fs::read_to_string(&path).expect("a stored expansion");
    if let Some((line, (a, b))) = actual
        .lines()
        .zip(stored.lines())
        .enumerate()
        .find(|(_, (a, b))| a != b)
    {
        panic!("{}:{}: now `{a}`, stored `{b}`", path.display(), line + 1);
    }
    assert_eq!(actual.len(), stored.len(), "{}", path.display());
}

#[test]
fn expansions_are_as_stored() {
    compare::<RollingDisk>();
    compare::<ChaplyginSleigh>();
    compare::<DoublePendulum>();
    compare::<TwoWheelsRod>();
}
