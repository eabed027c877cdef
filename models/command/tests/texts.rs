//! The list of shipped texts is complete, and every text loads.

use std::collections::BTreeSet;
use std::path::Path;

use dalembert_command::{TEXTS, all};

#[test]
fn every_text_of_the_shipped_models_is_listed() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../src");
    let files = std::fs::read_dir(folder).expect("a folder");
    let paths = files.map(|file| file.expect("a file").path());
    let texts = paths.filter(|path| path.extension().is_some_and(|ending| ending == "dal"));
    let found: BTreeSet<String> = texts
        .map(|path| path.file_stem().expect("a name").to_string_lossy().into())
        .collect();
    let listed: BTreeSet<String> = TEXTS.iter().map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!(found, listed);
    assert_eq!(TEXTS.len(), listed.len());
}

#[test]
fn every_shipped_model_loads_under_its_name() {
    for entry in all() {
        assert_eq!(entry.description().name, entry.name());
    }
}
