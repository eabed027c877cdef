//! Compares the formatted expansion of some models with stored files. Read a difference before you accept it with
//! `ACCEPT=1 cargo test --release -p dalembert-tests --test golden`.

use dalembert::Described;
use dalembert_models::{
    ChaplyginSleigh, DoublePendulum, RollingDisk, TwoWheelsArrested, TwoWheelsRod,
};
use dalembert_tests::golden;

fn expansion(source: &str) -> String {
    let tokens = dalembert_emit::try_expand(source.parse().expect("tokens")).expect("a model");
    let text = prettyplease::unparse(&syn::parse2(tokens).expect("items"));
    // The text of the declaration depends on the tokeniser, so it is not compared.
    let mut is_source = false;
    let kept = text.lines().filter(|line| {
        is_source |= line.trim_start().starts_with("source: ");
        let is_kept = !is_source;
        is_source &= !line.ends_with("),");
        is_kept
    });
    kept.map(|line| format!("{line}\n")).collect()
}

fn compare<S: Described>() {
    let actual = expansion(S::DESCRIPTION.source.value());
    assert_eq!(
        actual,
        expansion(S::DESCRIPTION.source.value()),
        "the same input gives the same output"
    );
    golden::compare(S::DESCRIPTION.name, &actual);
}

#[test]
fn expansions_are_as_stored() {
    compare::<RollingDisk>();
    compare::<ChaplyginSleigh>();
    compare::<DoublePendulum>();
    compare::<TwoWheelsRod>();
    compare::<TwoWheelsArrested>();
}
