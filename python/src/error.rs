//! Exceptions. Their classes are defined in Python, in `dalembert/_errors.py`.

use std::fmt::Display;

use dalembert::describe::Description;
use dalembert::{StateError, Undefined};
use dalembert_driver::words::{self, Advice};
use dalembert_driver::{AnyModel, Refusal, VariationError, names};
use dalembert_jit::{Mistake, Refused};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Advice about states that violate the constraints.
pub(crate) const ADVICE: Advice = Advice {
    off_constraint: "correct the velocities, or use off_constraint=\"project\" (nearest allowed velocity) or \
         off_constraint=\"keep\" (as it is)",
    off_position: "leave one of the positions out of `state` or `initial` (it is then solved for), or use \
         off_constraint=\"project\" (allowed positions near by) or off_constraint=\"keep\" (as it is)",
};

/// The exception of this name in `dalembert._errors`, with these arguments.
fn exception<'py>(
    py: Python<'py>,
    name: &str,
    arguments: impl pyo3::call::PyCallArgs<'py>,
) -> PyErr {
    let made = py
        .import("dalembert._errors")
        .and_then(|module| module.getattr(name))
        .and_then(|class| class.call1(arguments));
    match made {
        Ok(value) => PyErr::from_value(value),
        Err(error) => error,
    }
}

/// The exception for a refused parameter, state or run.
pub(crate) fn refused(text: impl Display) -> PyErr {
    Python::attach(|py| exception(py, "RequestError", (text.to_string(),)))
}

/// The exception for a refused text.
pub(crate) fn model_error(py: Python<'_>, refused: &Refused) -> PyErr {
    let mistakes: PyResult<Vec<_>> = refused
        .mistakes()
        .iter()
        .map(|it| mistake(py, it))
        .collect();
    match mistakes {
        Ok(mistakes) => exception(py, "ModelError", (refused.to_string(), mistakes)),
        Err(error) => error,
    }
}

/// The arguments of `Mistake`.
fn mistake<'py>(py: Python<'py>, mistake: &Mistake) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("message", &mistake.message)?;
    dict.set_item("line", mistake.line)?;
    dict.set_item("column", mistake.column)?;
    dict.set_item("width", mistake.width)?;
    if let Some(counterexample) = &mistake.counterexample {
        dict.set_item("counterexample", named(py, &counterexample.at)?)?;
        dict.set_item("values", named(py, &counterexample.values)?)?;
    }
    Ok(dict)
}

/// Names and values as a dictionary.
pub(crate) fn named<'py>(py: Python<'py>, pairs: &[(String, f64)]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    pairs
        .iter()
        .try_for_each(|(name, value)| dict.set_item(name, value))?;
    Ok(dict)
}

/// The exception for a refused state, with the reason.
pub(crate) fn state(description: &Description, error: &StateError) -> PyErr {
    let StateError::Parameter(error) = error else {
        return refused(words::state_text(description, error, &ADVICE));
    };
    let (name, value, expected) = (error.name, error.value, error.expected);
    refused(match value.is_nan() {
        true => format!(
            "parameter `{name}` has no default; give it by with_parameters({name}=..) (must be {expected})"
        ),
        false => format!("parameter `{name}` is {value}, but must be {expected}"),
    })
}

/// The exception for a run without derivatives, with the reason.
pub(crate) fn variation(description: &Description, error: &VariationError) -> PyErr {
    let surface = |index: usize| names::surfaces(description).nth(index).unwrap_or_default();
    let text = match *error {
        VariationError::Dependent { coordinate } => {
            let name = names::coordinates(description).nth(coordinate);
            let velocity = names::velocity(name.unwrap_or_default());
            let free = description.quasi_velocities.join(", ");
            format!("`{velocity}` follows from other velocities by the constraints; vary {free}")
        }
        VariationError::Absent { coordinate } => {
            let name = names::coordinates(description).nth(coordinate);
            let name = name.unwrap_or_default();
            format!("the mode in which the run begins has no coordinate `{name}`")
        }
        VariationError::Undefined(undefined) => match undefined {
            Undefined::Graze { t, surface: index }
            | Undefined::Corner { t, surface: index }
            | Undefined::Held { t, surface: index }
            | Undefined::Unlawful { t, surface: index } => {
                let (kind, name) = (undefined.kind(), surface(index));
                format!(
                    "the run has no derivative after t = {t}: {kind} at surface `{name}`; {undefined}"
                )
            }
            other => other.to_string(),
        },
        ref other => other.to_string(),
    };
    refused(format!("jacobian: {text}"))
}

/// The exception for a run that does not begin, with the reason.
pub(crate) fn run(model: &dyn AnyModel, refusal: &Refusal) -> PyErr {
    match refusal {
        Refusal::State(error) => state(model.description(), error),
        other => refused(words::refusal_text(model.description(), other, &ADVICE)),
    }
}
