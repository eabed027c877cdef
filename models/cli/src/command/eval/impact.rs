//! Effect of the impact laws of one surface on a state.

use dalembert::law::Law;
use dalembert::{Fault, StateError};
use dalembert_driver::AnyModel;
use serde_json::{Map, Value};

use super::refusal;
use super::report::Collected;
use crate::json;

/// A state, with the quantities that the model reports there.
pub struct Moment<'m> {
    pub t: f64,
    pub state: &'m [f64],
    pub collected: &'m Collected,
}

/// Evaluates gap, gap rate and laws of a surface. If the surface has instantaneous constraints, an impulse first makes
/// the state satisfy them: the result contains that state as `focused`, and the laws act on it.
pub fn evaluate(model: &dyn AnyModel, moment: &Moment<'_>, index: usize, laws: &[Law]) -> Value {
    let description = model.description();
    let surface = description.surfaces[index].name;
    let mut fields = Map::new();
    for name in ["gap", "gap_rate"] {
        let value = moment.collected.contact_scalar(surface, name);
        fields.insert(name.to_owned(), value.map_or(Value::Null, json::number));
    }
    let laws = match moment.collected.focus(surface) {
        None => evaluate_laws(model, moment, index, laws),
        Some(impulse) => {
            let singular = Fault::SingularSurface { surface: index };
            let found = match impulse.iter().all(|value| value.is_finite()) {
                true => model.kick(moment.state, impulse).and_then(|state| {
                    let collected = Collected::at(model, moment.t, &state)?;
                    Ok((state, collected))
                }),
                false => Err(singular),
            };
            match found {
                Err(fault) => refusal(description, &StateError::Fault(fault)),
                Ok((state, collected)) => {
                    let focused = Moment {
                        t: moment.t,
                        state: &state,
                        collected: &collected,
                    };
                    let laws = evaluate_laws(model, &focused, index, laws);
                    fields.insert("focused".to_owned(), struck(collected, surface).into());
                    laws
                }
            }
        }
    };
    fields.insert("laws".to_owned(), laws);
    fields.into()
}

/// Evaluates the laws of one surface: the impulsive laws, then a declared reset. Where no impulse exists (the gradient
/// of the gap may vanish away from the surface), the result contains the error in place of the laws; the state is still
/// valid.
fn evaluate_laws(model: &dyn AnyModel, moment: &Moment<'_>, surface: usize, laws: &[Law]) -> Value {
    let (t, state, collected) = (moment.t, moment.state, moment.collected);
    let description = model.description();
    let fault = |fault: &Fault| refusal(description, &StateError::Fault(*fault));
    let name = description.surfaces[surface].name;
    let is_rough = collected.focus(name).is_some();
    let mut results = Map::new();
    match collected.contact(name) {
        Some(contact) => {
            for &law in laws {
                // The instantaneous constraints alone may make the gap rate positive; then no law acts.
                let is_left = is_rough && contact.gap_rate >= 0.0;
                let after = match is_left {
                    true => Ok(state.to_vec()),
                    false => model.impact(state, &contact, law),
                };
                let result = match after.and_then(|after| Collected::at(model, t, &after)) {
                    Ok(after) => struck(after, name).into(),
                    Err(error) => fault(&error),
                };
                results.insert(law.name().to_owned(), result);
            }
        }
        None if collected.reset(name).is_none() => {
            return fault(&Fault::SingularSurface { surface });
        }
        None => {}
    }
    if let Some(reset) = collected.reset(name) {
        let after = model
            .state(t, &reset)
            .and_then(|state| Ok(Collected::at(model, t, &state)?));
        let result = match after {
            Ok(after) => {
                let mut fields = struck(after, name);
                fields.insert("q_plus".to_owned(), json::vector(&reset.q));
                fields.into()
            }
            Err(error) => refusal(description, &error),
        };
        results.insert(Law::Reset.name().to_owned(), result);
    }
    results.into()
}

/// The printed quantities of a state after an impact.
fn struck(mut after: Collected, surface: &str) -> Map<String, Value> {
    let gap_rate = after.contact_scalar(surface, "gap_rate");
    let fields = [
        ("qdot_plus", after.take("qdot")),
        ("p_plus", after.take("p")),
        ("gap_rate_plus", gap_rate.map_or(Value::Null, json::number)),
        ("energy_plus", after.take("energy")),
    ];
    fields
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}
