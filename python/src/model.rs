//! Models: texts to forms, values of parameters, descriptions.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError, Weak};

use dalembert::describe::{Description, Topology};
use dalembert::erased::Form;
use dalembert_driver::{AnyModel, Code, names, of_form};
use dalembert_jit::{FeedbackError, Loaded};
use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::evaluate::{self, At};
use crate::request::Request;
use crate::run::NativeRun;
use crate::{error, recorder};

/// A model in one of its scenes, with values for its parameters and inputs.
#[pyclass(frozen, module = "dalembert._native")]
#[derive(Clone)]
pub struct NativeModel {
    /// The models of the text.
    models: Arc<[Loaded]>,
    /// Index of this model among them.
    place: usize,
    pub(crate) form: Arc<Form>,
    pub(crate) values: Vec<f64>,
    pub(crate) mode: usize,
}

/// Positions, velocities, marks of the declared positions and of the declared velocities, and the end time.
type Initial = (Vec<f64>, Vec<f64>, Vec<bool>, Vec<bool>, Option<f64>);

/// Texts whose models are in use, without and with claims.
static LOADED: [Mutex<BTreeMap<String, Weak<[Loaded]>>>; 2] =
    [const { Mutex::new(BTreeMap::new()) }; 2];

/// The models of a text. `shown` is its name in messages.
#[pyfunction]
pub fn load(py: Python<'_>, text: &str, shown: &str, claims: bool) -> PyResult<Vec<NativeModel>> {
    let known = &LOADED[usize::from(claims)];
    let find = || {
        let known = known.lock().unwrap_or_else(PoisonError::into_inner);
        known.get(text)?.upgrade()
    };
    let models = match find() {
        Some(models) => models,
        None => {
            let load = match claims {
                true => dalembert_jit::load,
                false => dalembert_jit::load_without_claims,
            };
            let models = py.detach(|| load(shown, text));
            let models = models.map_err(|refused| error::model_error(py, &refused))?;
            let models: Arc<[Loaded]> = models.into();
            let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
            known.retain(|_, models| models.strong_count() > 0);
            known.insert(text.to_owned(), Arc::downgrade(&models));
            models
        }
    };
    (0..models.len())
        .map(|place| NativeModel::of(&models, place))
        .collect()
}

/// The text with inputs of its model replaced by feedback laws. `shown` is its name in messages.
#[pyfunction]
pub fn close(
    py: Python<'_>,
    text: &str,
    shown: &str,
    laws: Vec<(String, String)>,
) -> PyResult<String> {
    let laws: Vec<(&str, &str)> = laws.iter().map(|(input, law)| (&**input, &**law)).collect();
    dalembert_jit::close(shown, text, &laws).map_err(|error| match error {
        FeedbackError::Text(refused) => error::model_error(py, &refused),
        error => error::refused(error),
    })
}

/// The shipped models: name and text.
#[pyfunction]
pub fn shipped() -> Vec<(&'static str, &'static str)> {
    dalembert_texts::TEXTS.to_vec()
}

impl NativeModel {
    fn of(models: &Arc<[Loaded]>, place: usize) -> PyResult<Self> {
        Self::of_form(models, place, &models[place].form)
    }

    /// The model of a form, with declared values.
    fn of_form(models: &Arc<[Loaded]>, place: usize, form: &Arc<Form>) -> PyResult<Self> {
        let model = of_form(Arc::clone(form).into(), Code::Loaded).map_err(|excess| {
            error::refused(format!(
                "`{}` has {excess}; compile it in a crate of Rust with `dalembert::model!`",
                form.documentation.description.name
            ))
        })?;
        let count = model.description().parameters.len() + model.inputs().len();
        Ok(Self {
            models: Arc::clone(models),
            place,
            form: Arc::clone(form),
            values: (0..count).map(|index| model.parameter(index)).collect(),
            mode: 0,
        })
    }

    pub(crate) fn describe(&self) -> &Description {
        &self.form.documentation.description
    }

    /// The model for the driver.
    pub(crate) fn build(&self) -> Box<dyn AnyModel> {
        let mut model = of_form(Arc::clone(&self.form).into(), Code::Loaded)
            .expect("the form fits, as it did when it was loaded");
        for (index, value) in self.values.iter().enumerate() {
            model.set_parameter(index, *value);
        }
        model.set_mode(self.mode);
        model
    }

    fn set(&mut self, name: &str, value: f64) -> PyResult<()> {
        let parameters = &self.describe().parameters;
        let accepted = parameters.iter().map(|parameter| parameter.name);
        let index = names::find("parameter", name, accepted).map_err(error::refused)?;
        let assumption = parameters[index].assumption;
        if !assumption.holds(value) {
            return Err(error::refused(format!(
                "{name}: {value} is not accepted; expected a value {assumption}"
            )));
        }
        self.values[index] = value;
        Ok(())
    }

    fn set_input(&mut self, name: &str, value: f64) -> PyResult<()> {
        let accepted = self.form.documentation.inputs.iter().copied();
        let index = names::find("input", name, accepted).map_err(error::refused)?;
        if !value.is_finite() {
            return Err(error::refused(format!(
                "{name}: {value} is not accepted; expected a finite number"
            )));
        }
        let after = self.describe().parameters.len();
        self.values[after + index] = value;
        Ok(())
    }

    fn set_mode(&mut self, name: &str) -> PyResult<()> {
        let modes = self.describe().modes.iter().map(|mode| mode.name);
        self.mode = names::find("mode", name, modes).map_err(error::refused)?;
        Ok(())
    }
}

#[pymethods]
impl NativeModel {
    /// The same model with other values for some parameters.
    fn with_parameters(&self, values: Vec<(String, f64)>) -> PyResult<Self> {
        let mut changed = self.clone();
        for (name, value) in values {
            changed.set(&name, value)?;
        }
        Ok(changed)
    }

    /// The same model with constant values for some inputs.
    fn with_inputs(&self, values: Vec<(String, f64)>) -> PyResult<Self> {
        let mut changed = self.clone();
        for (name, value) in values {
            changed.set_input(&name, value)?;
        }
        Ok(changed)
    }

    /// The same model, beginning in a mode.
    fn with_mode(&self, name: &str) -> PyResult<Self> {
        let mut changed = self.clone();
        changed.set_mode(name)?;
        Ok(changed)
    }

    /// A scene of the model, with the values of this one.
    fn in_scene(&self, name: &str) -> PyResult<Self> {
        let loaded = &self.models[self.place];
        let scenes = loaded.scenes.iter().map(|(name, _)| name.as_str());
        let accepted = core::iter::once("all").chain(scenes);
        let index = names::find("scene", name, accepted).map_err(error::refused)?;
        let form = match index.checked_sub(1) {
            None => &loaded.form,
            Some(scene) => &loaded.scenes[scene].1,
        };
        let mut scene = Self::of_form(&self.models, self.place, form)?;
        scene.values.clone_from(&self.values);
        Ok(scene)
    }

    /// Values of parameters, then of inputs.
    fn values(&self) -> Vec<f64> {
        self.values.clone()
    }

    /// Names, shapes and documentation of the declared quantities.
    fn description<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let description = self.describe();
        let dict = PyDict::new(py);
        dict.set_item("name", description.name)?;
        dict.set_item("type_name", description.type_name)?;
        dict.set_item("documentation", &*description.documentation)?;
        dict.set_item("source", &*description.source)?;
        dict.set_item("is_first_order", description.is_first_order)?;
        let coordinates: Vec<&str> = names::coordinates(description).collect();
        let velocities: Vec<String> = coordinates
            .iter()
            .map(|coordinate| names::velocity(coordinate))
            .collect();
        let momenta: Vec<String> = coordinates
            .iter()
            .map(|coordinate| names::momentum(coordinate))
            .collect();
        dict.set_item("coordinates", coordinates)?;
        dict.set_item("velocities", velocities)?;
        dict.set_item("momenta", momenta)?;
        let topologies: Vec<_> = description
            .coordinates
            .iter()
            .map(|it| ends(it.topology))
            .collect();
        dict.set_item("topologies", topologies)?;
        dict.set_item("quasi_velocities", &*description.quasi_velocities)?;
        let parameters = description.parameters.iter();
        let parameters = parameters.map(|it| (it.name, it.assumption.to_string(), it.default));
        dict.set_item(
            "parameters",
            PyList::new(py, parameters.collect::<Vec<_>>())?,
        )?;
        dict.set_item("inputs", &*self.form.documentation.inputs)?;
        let constraints: Vec<&str> = description.constraints.iter().map(|it| it.name).collect();
        dict.set_item("constraints", constraints)?;
        let surfaces: Vec<_> = description
            .surfaces
            .iter()
            .map(|it| (it.name, &*it.law))
            .collect();
        dict.set_item("surfaces", surfaces)?;
        dict.set_item("outputs", &*description.outputs)?;
        dict.set_item("scenes", &*description.scenes)?;
        let modes: Vec<_> = description
            .modes
            .iter()
            .map(|it| (it.name, &*it.coordinates))
            .collect();
        dict.set_item("modes", modes)?;
        let view = description.view.as_ref().map(|view| {
            let labels = view.labels.each_ref().map(|label| &**label);
            (labels, view.plane, view.region)
        });
        dict.set_item("view", view)?;
        Ok(dict)
    }

    /// The declared initial state and end.
    fn initial(&self) -> Initial {
        let start = self.build().initial();
        (start.q, start.qdot, start.placed, start.named, start.until)
    }

    /// Runs the model.
    fn simulate(&self, py: Python<'_>, request: Request) -> PyResult<NativeRun> {
        recorder::simulate(py, self, request)
    }

    /// All derived quantities at a state.
    fn evaluate<'py>(&self, py: Python<'py>, at: At) -> PyResult<Bound<'py, PyDict>> {
        evaluate::evaluate(py, self, &at)
    }

    /// Values of the function of the declared region, one per row of positions; NaN without a region.
    fn region<'py>(
        &self,
        py: Python<'py>,
        t: f64,
        q: PyReadonlyArray2<'py, f64>,
    ) -> Bound<'py, PyArray1<f64>> {
        let model = self.build();
        let rows = q.as_array();
        let values = rows
            .rows()
            .into_iter()
            .map(|row| model.region(t, &row.to_vec()).unwrap_or(f64::NAN));
        PyArray1::from_iter(py, values)
    }
}

/// `None` for a line, the period of a circle, or the ends of an interval.
fn ends(topology: Topology) -> Option<Vec<f64>> {
    match topology {
        Topology::Line => None,
        Topology::Circle => Some(vec![core::f64::consts::TAU]),
        Topology::Interval { low, high } => Some(vec![low, high]),
    }
}
