//! `involution: f, g, ..`: decides whether the brackets of these functions with each other vanish on D.
//!
//! The bracket is that of [`crate::mechanics::bracket`]: Poisson without constraints, almost Poisson with them. Forces
//! do not enter.

use dalembert_expr::ExprId;

use super::evidence::{Wording, evidence};
use super::finding::{Certificate, Verdict};
use super::hybrid::Surroundings;
use super::symplectic::AtStates;
use super::together::Together;
use crate::mechanics::bracket::{FunctionOnD, derive_bracket};
use crate::model::{Model, StatedFunction};

/// Largest length of the text of a bracket in a message. For a longer bracket the message gives only the value.
const READABLE: usize = 120;

/// The verdict on `involution: f, g, ..`.
pub(super) fn check_involution(
    model: &mut Model,
    around: &Surroundings<'_>,
    functions: &[StatedFunction],
) -> Verdict {
    let bracket = match derive_bracket(model, around.derivation) {
        Ok(bracket) => bracket,
        Err(reason) => return Verdict::Undecided(reason.text().to_owned()),
    };
    let on_d = functions.iter().map(|function| {
        let value = bracket.on_d(&mut model.pool, function.value);
        (value, function.written.as_str())
    });
    let on_d: Vec<(FunctionOnD, &str)> = on_d.collect();
    let names: Vec<String> = on_d.iter().map(|(_, name)| format!("`{name}`")).collect();
    let shown = match &names[..] {
        [name] => format!("{name} is in involution with itself"),
        names => format!("{} are in involution", names.join(", ")),
    };
    let mut together = Together::of(Certificate::without_chance(shown, around.seed));
    for (j, (g, second)) in on_d.iter().enumerate() {
        for (f, first) in &on_d[..j] {
            let value = bracket.between(&mut model.pool, f, g);
            let value = bracket.written(&mut model.pool, value);
            let verdict = match vanishes(model, around, value, [first, second]) {
                Verdict::Undecided(reason) => {
                    Verdict::Undecided(format!("{{{first}, {second}}}: {reason}"))
                }
                decided => decided,
            };
            if let Some(refuted) = together.add(verdict) {
                return refuted;
            }
        }
    }
    together.verdict()
}

/// Verdict on one bracket.
fn vanishes(
    model: &mut Model,
    around: &Surroundings<'_>,
    value: ExprId,
    [first, second]: [&str; 2],
) -> Verdict {
    let question = AtStates::value(around.dynamics, value, format!("{{{first}, {second}}}"));
    let text = model.pool.text(value);
    let formula = match text.len() <= READABLE {
        true => format!(": {{{first}, {second}}} = {text}"),
        false => String::new(),
    };
    let wording = Wording {
        vanishes: String::new(),
        differs: format!("`{first}` and `{second}` are not in involution{formula}"),
        help: ["leave one of them out".to_owned(), String::new()],
    };
    evidence(model, &question, around.seed).verdict(true, wording, around.seed)
}
