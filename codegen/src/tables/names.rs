//! Names, of which the program keeps one copy each. The copies are never freed. They take the memory of the distinct
//! names of all loaded models: a model that is loaded again, or with other numbers, adds none.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// The copy of a name that the program keeps.
pub(super) fn name(name: impl AsRef<str>) -> &'static str {
    static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let name = name.as_ref();
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = names.get(name) {
        return known;
    }
    let kept: &'static str = Box::leak(Box::from(name));
    names.insert(kept);
    kept
}

#[cfg(test)]
mod tests {
    use super::name;

    #[test]
    fn a_name_is_kept_once() {
        let [first, second] = [String::from("theta"), String::from("theta")].map(name);
        assert!(core::ptr::eq(first, second));
        assert_ne!(first, name("phi"));
    }
}
