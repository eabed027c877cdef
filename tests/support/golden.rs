//! Comparison with stored texts. `ACCEPT=1` in the environment rewrites them.

use std::path::Path;

/// Compares with `tests/golden/NAME.rs.txt`.
///
/// # Panics
/// At the first line that differs.
pub fn compare(name: &str, actual: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("golden/{name}.rs.txt"));
    compare_file(&path, actual);
}

/// Compares with a file.
///
/// # Panics
/// At the first line that differs.
pub fn compare_file(path: &Path, actual: &str) {
    if std::env::var_os("ACCEPT").is_some() {
        std::fs::write(path, actual).expect("a writable folder");
    }
    let stored = std::fs::read_to_string(path).expect("a stored text");
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
