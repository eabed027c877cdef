//! The arguments of a run, as settings and state of the driver.

use std::sync::Arc;

use dalembert::law::Law;
use dalembert::policy::{Corner, Penetration, Policies, Rest, Split};
use dalembert_driver::course::IntegratorChoice;
use dalembert_driver::ensemble::runner::End;
use dalembert_driver::{
    AnyModel, Beginning, Component, Form, Integrator, OffConstraint, Origin, Rates, Settings,
    course, names,
};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

use crate::error::{self, refused};
use crate::events::{Calls, Wanted};
use crate::model::NativeModel;

/// The arguments of `Model.simulate`, as `dalembert/_model.py` hands them on.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Request<'py> {
    until: Option<f64>,
    pub(crate) impacts: Option<u64>,
    start: Given,
    off_constraint: String,
    pub(crate) times: Option<PyReadonlyArray1<'py, f64>>,
    pub(crate) samples: u64,
    tol: f64,
    integrator: String,
    step: Option<f64>,
    max_step: Option<f64>,
    steps: Option<u64>,
    laws: Vec<(Option<String>, String, Option<f64>)>,
    form: Option<String>,
    projection: Option<bool>,
    rest: String,
    penetration: String,
    corner: String,
    split: String,
    pub(crate) events: Vec<Wanted>,
    /// The model whose last outputs are the expressions of events.
    pub(crate) watched: Option<Py<NativeModel>>,
    on_step: Option<Py<PyAny>>,
    on_event: Option<Py<PyAny>>,
    on_progress: Option<Py<PyAny>>,
    /// All inputs as a function of `t`, `q` and `qdot`.
    control: Option<Py<PyAny>>,
    /// Time for which the values of that function are held.
    period: Option<f64>,
}

/// The start of a request, in part or as a whole.
#[derive(Clone, FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Given {
    state: Vec<(String, f64)>,
    q: Option<Vec<f64>>,
    qdot: Option<Vec<f64>>,
    p: Option<Vec<f64>>,
}

/// A run that can be repeated with the same result.
#[derive(Clone)]
pub(crate) struct Course {
    pub origin: Origin,
    pub settings: Settings,
    /// True if an end time was given.
    pub has_end: bool,
    /// Inputs that are functions.
    pub steering: Option<Arc<Steering>>,
}

/// All inputs as a function of the user, and the time for which its values are held.
pub(crate) struct Steering {
    pub function: Py<PyAny>,
    pub period: Option<f64>,
}

impl Request<'_> {
    /// The functions to call during the run.
    pub(crate) fn calls(&mut self) -> Calls {
        Calls {
            step: self.on_step.take(),
            event: self.on_event.take(),
            progress: self.on_progress.take(),
        }
    }

    /// The requested run of a model.
    pub(crate) fn course(&mut self, model: &dyn AnyModel) -> PyResult<Course> {
        let policy = self.off_constraint()?;
        let origin = self.start.beginning(model)?.settle(model, policy);
        let origin = origin.map_err(|reason| error::state(model.description(), &reason))?;
        Ok(Course {
            origin,
            settings: self.settings(model, policy)?,
            has_end: self.until.is_some(),
            steering: self.steering()?,
        })
    }

    /// Where the members of an ensemble end.
    pub(crate) fn end(&self) -> End {
        End::of(self.until, self.impacts)
    }

    /// The given start.
    pub(crate) fn start(&self) -> Given {
        self.start.clone()
    }

    /// The policy for starts that violate constraints.
    pub(crate) fn off_constraint(&self) -> PyResult<OffConstraint> {
        choice("off_constraint", &self.off_constraint, &policies())
    }

    fn steering(&mut self) -> PyResult<Option<Arc<Steering>>> {
        let (function, period) = (self.control.take(), self.period);
        let Some(function) = function else {
            return match period {
                None => Ok(None),
                Some(_) => Err(refused(
                    "period: it belongs to inputs that are functions, and there are none",
                )),
            };
        };
        if let Some(period) = period.filter(|period| !(period.is_finite() && *period > 0.0)) {
            return Err(refused(format!(
                "period: {period} is not accepted; expected a positive number"
            )));
        }
        if matches!(self.integrator.as_str(), "taylor" | "dla2" | "dla4") {
            return Err(refused(
                "integrator: inputs that are functions need dop853, dopri5, rk4, gauss4 or gauss6",
            ));
        }
        Ok(Some(Arc::new(Steering { function, period })))
    }

    pub(crate) fn settings(
        &self,
        model: &dyn AnyModel,
        policy: OffConstraint,
    ) -> PyResult<Settings> {
        let integrator = choice("integrator", &self.integrator, &integrators())?;
        self.check(model, integrator)?;
        let wanted = self.form.as_deref();
        let wanted = wanted
            .map(|form| choice("form", form, &forms()))
            .transpose()?;
        let needs_global = policy == OffConstraint::Keep || self.projection.is_some();
        let form = Form::choose(model.description(), wanted, needs_global);
        let form = form.map_err(|reason| refused(format!("form: {reason}")))?;
        let until = course::horizon(model, self.until, self.impacts).ok_or_else(|| {
            refused("the model declares no usable `until`; give an end with until= or impacts=")
        })?;
        Ok(Settings {
            form,
            integrator: self.settled(integrator, model, form)?,
            tol: self.tol,
            step: self.step,
            max_step: self.max_step,
            steps: self.steps,
            until,
            impacts: self.impacts,
            laws: self.laws(model)?,
            policies: self.policies()?,
            projection: policy.projection(self.projection),
        })
    }

    /// The integrator of the run.
    fn settled(
        &self,
        wanted: IntegratorChoice,
        model: &dyn AnyModel,
        form: Form,
    ) -> PyResult<Integrator> {
        let wanted = match self.control {
            Some(_) => wanted.with_changing_inputs(),
            None => wanted,
        };
        let integrator = wanted.settle(model, form, self.tol);
        integrator.map_err(|error| refused(format!("tol: {error}")))
    }

    /// Refuses values out of range, and arguments that do not go together.
    fn check(&self, model: &dyn AnyModel, integrator: IntegratorChoice) -> PyResult<()> {
        if !(1e-15..=0.1).contains(&self.tol) {
            let tol = self.tol;
            return Err(refused(format!(
                "tol: {tol} is not accepted; expected a number from 1e-15 to 0.1"
            )));
        }
        for (name, value) in [
            ("until", self.until),
            ("step", self.step),
            ("max_step", self.max_step),
        ] {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                return Err(refused(format!(
                    "{name}: {value} is not accepted; expected a positive number"
                )));
            }
        }
        for (name, count) in [("impacts", self.impacts), ("steps", self.steps)] {
            if count == Some(0) {
                return Err(refused(format!(
                    "{name}: 0 is not accepted; expected a positive number"
                )));
            }
        }
        if self.step.is_some() && integrator.is_adaptive() {
            return Err(refused(
                "step: dop853, dopri5 and taylor choose their steps by tol; a step needs rk4, gauss4, gauss6, dla2 or dla4",
            ));
        }
        if self.max_step.is_some() && !integrator.is_adaptive() {
            return Err(refused(
                "max_step: rk4, gauss4, gauss6, dla2 and dla4 keep one step, which step= sets; a largest step needs dop853, \
                 dopri5 or taylor",
            ));
        }
        if self.impacts.is_some() && model.description().surfaces.is_empty() {
            return Err(refused("impacts: the model has no impact surfaces"));
        }
        Ok(())
    }

    fn laws(&self, model: &dyn AnyModel) -> PyResult<Vec<(usize, Law)>> {
        let description = model.description();
        let mut laws = Vec::new();
        for (surface, name, coefficient) in &self.laws {
            let law = law(name, *coefficient)?;
            let surface = surface.as_deref();
            let surface =
                surface.map(|name| names::find("surface", name, names::surfaces(description)));
            let surface = surface.transpose();
            let surface = surface.map_err(|unknown| refused(format!("law: {unknown}")))?;
            let added = course::add_law(&mut laws, model, surface, law);
            added.map_err(|reason| refused(format!("law: {reason}")))?;
        }
        Ok(laws)
    }

    fn policies(&self) -> PyResult<Policies> {
        const CONTACT: &str = "contact";
        let rest = choice(
            "rest",
            &self.rest,
            &[("stop", Rest::Stop), (CONTACT, Rest::Contact)],
        )?;
        let penetration = [
            ("stop", Penetration::Stop),
            ("repeat", Penetration::Repeat),
            (CONTACT, Penetration::Repeat),
        ];
        let corner = [
            ("stop", Corner::Stop),
            ("ascending", Corner::Ascending),
            ("descending", Corner::Descending),
        ];
        let split = [("first", Split::First), ("stop", Split::Stop)];
        Ok(Policies {
            // After repeated impacts that end in a contact, the motion continues along the surface.
            rest: match self.penetration == CONTACT {
                true => Rest::Contact,
                false => rest,
            },
            penetration: choice("penetration", &self.penetration, &penetration)?,
            corner: choice("corner", &self.corner, &corner)?,
            split: choice("split", &self.split, &split)?,
        })
    }
}

impl Given {
    /// The state before its checks.
    pub(crate) fn beginning(&self, model: &dyn AnyModel) -> PyResult<Beginning> {
        let rates = match (&self.q, &self.qdot, &self.p) {
            (None, None, None) => return self.changed(model),
            _ if !self.state.is_empty() => {
                return Err(refused(
                    "state: it changes the declared initial state, and q= gives another one; leave out one of them",
                ));
            }
            (Some(q), None, None) if model.description().is_first_order => {
                Rates::Velocities(vec![0.0; q.len()])
            }
            (Some(_), Some(qdot), None) => Rates::Velocities(vector(model, "qdot", qdot)?),
            (Some(_), None, Some(p)) => Rates::Momenta(vector(model, "p", p)?),
            (Some(_), ..) => return Err(refused("q needs either qdot or p")),
            (None, ..) => return Err(refused("qdot and p need q")),
        };
        let q = self.q.as_deref().unwrap_or_default();
        let q = vector(model, "q", q)?;
        Ok(Beginning::Given { q, rates })
    }

    /// The declared initial state with changes.
    fn changed(&self, model: &dyn AnyModel) -> PyResult<Beginning> {
        let mut beginning = Beginning::Named(model.initial());
        for (name, value) in &self.state {
            let component = Component::find(model, name);
            let component = component.map_err(|unknown| refused(format!("state: {unknown}")))?;
            beginning.set(component, *value);
        }
        Ok(beginning)
    }
}

/// One number per coordinate.
pub(crate) fn vector(model: &dyn AnyModel, place: &str, given: &[f64]) -> PyResult<Vec<f64>> {
    let names: Vec<&str> = names::coordinates(model.description()).collect();
    match given.len() == names.len() {
        true => Ok(given.to_vec()),
        false => Err(refused(format!(
            "{place}: expected {} numbers ({}), got {}",
            names.len(),
            names.join(", "),
            given.len()
        ))),
    }
}

/// The value of this name.
fn choice<T: Copy>(place: &'static str, given: &str, values: &[(&'static str, T)]) -> PyResult<T> {
    let index = names::find(place, given, values.iter().map(|(name, _)| *name));
    Ok(values[index.map_err(refused)?].1)
}

fn integrators() -> Vec<(&'static str, IntegratorChoice)> {
    IntegratorChoice::every()
        .map(|choice| (choice.name(), choice))
        .collect()
}

fn forms() -> Vec<(&'static str, Form)> {
    Form::every()
        .iter()
        .map(|form| (form.name(), *form))
        .collect()
}

pub(crate) fn policies() -> Vec<(&'static str, OffConstraint)> {
    let every = OffConstraint::every().iter();
    every.map(|policy| (policy.name(), *policy)).collect()
}

/// The law of this name, with its coefficient if it takes one.
fn law(name: &str, coefficient: Option<f64>) -> PyResult<Law> {
    let accepted = Law::NAMES.iter().map(|(name, _)| *name);
    let index = names::find("law", name, accepted).map_err(refused)?;
    let expected = match (Law::NAMES[index].1, coefficient) {
        (true, Some(e)) if (0.0..=1.0).contains(&e) => None,
        (true, _) => Some(format!("\"{name}:E\" with E a number from 0 to 1")),
        (false, Some(_)) => Some(format!("\"{name}\" without a coefficient")),
        (false, None) => None,
    };
    let found = Law::from_name(name, coefficient.unwrap_or_default());
    match (expected, found) {
        (None, Some(law)) => Ok(law),
        (expected, _) => Err(refused(format!(
            "law: `{name}` is not accepted in this form; expected {}",
            expected.unwrap_or_default()
        ))),
    }
}
