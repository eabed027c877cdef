//! The systems of `reference/verdicts_visible.json` as a user writes them, each with true claims, which are proved when
//! the text is loaded. `tests/claims/visible.rs` shows that these are the systems of the file.

use std::sync::OnceLock;

use dalembert_jit::Loaded;
use dalembert_stability::text::Large;

use crate::numeric::Numeric;

static LOADED: OnceLock<Vec<Loaded>> = OnceLock::new();

/// The models with their names, in the order of the file.
///
/// # Panics
/// If a claim is not proved.
pub fn systems() -> Vec<(&'static str, Box<dyn Numeric>)> {
    let text = include_str!("visible_models.dal");
    let loaded = LOADED.get_or_init(|| {
        let models = dalembert_jit::load("visible_models", text);
        models.unwrap_or_else(|refused| panic!("{refused}"))
    });
    let named = loaded.iter().map(|model| {
        let system = Large::of(&model.form).expect("vectors of no more components");
        let name = model.form.documentation.description.name;
        (name, Box::new(system) as Box<dyn Numeric>)
    });
    named.collect()
}
