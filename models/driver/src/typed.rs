//! [`AnyModel`] for the type of a system.

use dalembert::declaration::Described;
use dalembert::describe::{Description, Instance, Report};
use dalembert::erased::{self, Erased};
use dalembert::law::{Contact, Law};
use dalembert::numbers::Row;
use dalembert::state::StateVector;
use dalembert::{
    Fault, Lagrangian, OrbitError, ParameterError, Scene, SceneEffects, StateError, System,
    TaylorField, VectorField,
};

use crate::accuracy::{self, Plan, Study, Verified};
use crate::certify::{Certification, Certified, Strike, Subject};
use crate::integrator::Form;
use crate::model::{
    AnyModel, Code, Contacted, OffConstraint, Origin, Point, Rates, Runs, Start, Together,
};
use crate::orbit::{Finder, Found, Search};
use crate::refusal::Refusal;
use crate::run::{self, Abreast, Ending, Settings, Watch};
use crate::variation::{Begun, Differentiator, Variable, VariationError, Varied};

/// A system that can be run behind [`AnyModel`]: the traits that `model!` implements for a model with values for its
/// parameters.
pub trait Model:
    Instance<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian + 'static
{
}

impl<M> Model for M where
    M: Instance<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian + 'static
{
}

/// A typed model behind [`AnyModel`].
struct Typed<M> {
    model: M,
    code: Code,
    /// The form, for the system of a form.
    form: Option<&'static erased::Form>,
}

/// The model of a type, with its declared values.
pub fn of_type<M: Model + Described>() -> Box<dyn AnyModel> {
    Box::new(Typed {
        model: M::with_defaults(),
        code: Code::Inlined,
        form: None,
    })
}

/// The model of a form, with its declared values, run by the system of the least sufficient capacity
/// ([`erased::Form::capacity`]); `None` if the form exceeds every capacity.
pub fn of_form(form: &'static erased::Form, code: Code) -> Option<Box<dyn AnyModel>> {
    fn with_room<const C: usize>(
        form: &'static erased::Form,
        code: Code,
    ) -> Option<Box<dyn AnyModel>> {
        let model = Erased::<C>::of(form)?;
        Some(Box::new(Typed {
            model,
            code,
            form: Some(form),
        }))
    }
    with_room::<4>(form, code)
        .or_else(|| with_room::<8>(form, code))
        .or_else(|| with_room::<32>(form, code))
}

impl<M: Model> Typed<M> {
    /// The given velocity, after all checks except that of the constraints. Momenta belong to the global form and may
    /// lie off the constraints.
    fn checked_velocity(
        &self,
        t: f64,
        q: &M::Vector,
        rates: &Rates,
    ) -> Result<M::Vector, StateError> {
        let global = self.model.global();
        let p = match rates {
            Rates::Velocities(qdot) => {
                let qdot = vector(q, qdot);
                global.checked(t, q, &qdot)?;
                return Ok(qdot);
            }
            Rates::Momenta(p) => vector(q, p),
        };
        global.check_parameters()?;
        let mut components = q.as_slice().iter().chain(p.as_slice());
        if let Some(component) = components.position(|value| !value.is_finite()) {
            return Err(StateError::NotFinite { component });
        }
        let state = global.state_from_momenta(t, q, &p)?;
        match global.outside_chart(&state) {
            Some(coordinate) => Err(StateError::OutsideChart { coordinate }),
            None => Ok(global.velocity(t, &state)?),
        }
    }

    /// The state of a system in either form.
    fn prepare<S: System<Vector = M::Vector>>(
        &self,
        system: &S,
        t: f64,
        origin: &Origin,
    ) -> Result<S::State, StateError> {
        let mut q = vector(&system.zero_vector(), &origin.q);
        if origin.policy == OffConstraint::Project {
            q = system.complete_position(t, &q, &system.zero_vector())?;
        }
        let qdot = self.checked_velocity(t, &q, &origin.rates)?;
        if origin.policy == OffConstraint::Error {
            system.admit(t, &q, &qdot)?;
        }
        Ok(match (origin.policy, &origin.rates) {
            (OffConstraint::Project, _) => system.state_nearest(t, &q, &qdot)?,
            // Given momenta are kept to the last digit unless the policy projects them.
            (_, Rates::Momenta(p)) => system.state_from_momenta(t, &q, &vector(&q, p))?,
            _ => system.state_unchecked(t, &q, &qdot)?,
        })
    }
}

/// True if a mark of [`Initial`](dalembert::describe::Initial) is set.
fn is_marked(mark: &f64) -> bool {
    *mark != 0.0
}

fn marks(marked: &[bool]) -> Vec<f64> {
    let mark = |&marked: &bool| f64::from(u8::from(marked));
    marked.iter().map(mark).collect()
}

/// Evaluates an expression with the model in the form of the settings and its state in that form.
macro_rules! in_form {
    ($typed:ident, $origin:ident, $settings:ident, |$model:ident, $state:ident| $work:expr) => {{
        match $settings.form {
            Form::Reduced => {
                let $model = &$typed.model;
                let $state = $typed.prepare($model, 0.0, $origin)?;
                $work
            }
            Form::Global => {
                let $model = &$typed.model.global();
                let $state = $typed.prepare($model, 0.0, $origin)?;
                $work
            }
        }
    }};
}

impl<M: Model> AnyModel for Typed<M> {
    fn code(&self) -> Code {
        self.code
    }

    fn description(&self) -> Description {
        *self.model.description()
    }

    fn inputs(&self) -> &'static [&'static str] {
        self.model.inputs()
    }

    fn parameter(&self, index: usize) -> f64 {
        self.model.parameter(index)
    }

    fn set_parameter(&mut self, index: usize, value: f64) {
        self.model.set_parameter(index, value);
    }

    fn set_mode(&mut self, mode: usize) {
        self.model.set_mode(mode);
    }

    fn check_parameters(&self) -> Result<(), ParameterError> {
        self.model.check_parameters()
    }

    fn initial(&self) -> Start {
        let initial = self.model.initial();
        Start {
            q: initial.q.as_slice().to_vec(),
            qdot: initial.qdot.as_slice().to_vec(),
            placed: initial.placed.as_slice().iter().map(is_marked).collect(),
            named: initial.named.as_slice().iter().map(is_marked).collect(),
            until: initial.until,
        }
    }

    fn complete_position(&self, q: &[f64], placed: &[bool]) -> Result<Vec<f64>, StateError> {
        let zero = self.model.zero_vector();
        let (q, placed) = (vector(&zero, q), vector(&zero, &marks(placed)));
        let completed = self.model.complete_position(0.0, &q, &placed)?;
        Ok(completed.as_slice().to_vec())
    }

    fn complete_velocity(
        &self,
        q: &[f64],
        qdot: &[f64],
        named: &[bool],
    ) -> Result<Vec<f64>, StateError> {
        let zero = self.model.zero_vector();
        let [q, qdot, named] = [q, qdot, &marks(named)].map(|values| vector(&zero, values));
        let completed = self.model.complete_velocity(0.0, &q, &qdot, &named)?;
        Ok(completed.as_slice().to_vec())
    }

    fn state(&self, t: f64, origin: &Origin) -> Result<Vec<f64>, StateError> {
        let state = self.prepare(&self.model.global(), t, origin)?;
        Ok(state.as_slice().to_vec())
    }

    fn region(&self, t: f64, q: &[f64]) -> Option<f64> {
        self.model
            .view_region(t, &vector(&self.model.zero_vector(), q))
    }

    fn inspect(&self, t: f64, state: &[f64], report: &mut dyn Report) -> Result<(), Fault> {
        let global = self.model.global();
        let state = vector(&global.zero_state(), state);
        global.inspect(t, &state, report)?;
        if self.model.description().quasi_velocities.is_empty() {
            return Ok(());
        }
        let (q, qdot) = (global.position(&state), global.velocity(t, &state)?);
        let state = self.model.state_unchecked(t, &q, &qdot)?;
        self.model.inspect_frame(t, &state, report)
    }

    fn law(&self, surface: usize) -> Option<Law> {
        self.model.effects().law(&self.model, surface)
    }

    fn impact(&self, state: &[f64], contact: &Contacted, law: Law) -> Vec<f64> {
        let global = self.model.global();
        let contact = Contact::<<M::Global as System>::Impulse> {
            gap_rate: contact.gap_rate,
            constrained_rate: contact.constrained_rate,
            surface_rate: contact.surface_rate,
            constrained_compliance: contact.constrained_compliance,
            free_compliance: contact.free_compliance,
            direction: vector(&global.zero_impulse(), &contact.direction),
        };
        let mut state = vector(&global.zero_state(), state);
        global.kick(&mut state, contact.impulse(law), &contact.direction);
        StateVector::as_slice(&state).to_vec()
    }

    fn kick(&self, state: &[f64], impulse: &[f64]) -> Vec<f64> {
        let global = self.model.global();
        let mut state = vector(&global.zero_state(), state);
        global.kick(&mut state, 1.0, &vector(&global.zero_impulse(), impulse));
        StateVector::as_slice(&state).to_vec()
    }
}

impl<M: Model> Runs for Typed<M> {
    fn simulate(
        &self,
        origin: &Origin,
        settings: &Settings,
        watch: &mut dyn Watch,
    ) -> Result<Ending, Refusal> {
        in_form!(self, origin, settings, |model, state| run::simulate(
            model, state, settings, watch
        ))
    }

    fn simulate_abreast(
        &self,
        runs: Vec<Together<'_>>,
        settings: &Settings,
        looks_inside: bool,
    ) -> Vec<Result<Ending, Refusal>> {
        match settings.form {
            Form::Reduced => abreast(self, runs, settings, looks_inside, M::clone),
            Form::Global => abreast(self, runs, settings, looks_inside, M::global),
        }
    }

    fn study(
        &self,
        origin: &Origin,
        base: &Settings,
        plan: &Plan,
        tell: &mut dyn FnMut(&str),
    ) -> Result<Study, Refusal> {
        in_form!(self, origin, base, |model, state| accuracy::study(
            model, &state, base, plan, tell
        ))
    }

    fn verify(
        &self,
        origin: &Origin,
        settings: &Settings,
        ending: &Ending,
    ) -> Result<Verified, Refusal> {
        in_form!(self, origin, settings, |model, state| accuracy::verify(
            model, &state, settings, ending
        ))
    }

    fn orbit(
        &self,
        origin: &Origin,
        search: &Search,
    ) -> Result<Option<Result<Found, OrbitError>>, Refusal> {
        let state = self.prepare(&self.model, 0.0, origin)?;
        let qdot = self.model.velocity(0.0, &state).map_err(StateError::from)?;
        let q = self.model.position(&state);
        let finder = Finder {
            search,
            q: q.as_slice(),
            qdot: qdot.as_slice(),
        };
        self.model.visit_variational(finder).transpose()
    }

    fn differentiate(
        &self,
        origin: &Origin,
        settings: &Settings,
        variables: &[Variable],
        is_over: &mut dyn FnMut() -> bool,
    ) -> Varied {
        if let Some(error) = VariationError::beforehand(self.model.description(), settings) {
            return Ok(Err(error));
        }
        in_form!(self, origin, settings, |model, state| {
            let begun = Begun::of(model, &state)?;
            let values = TaylorField::parameters(model);
            let differentiator = Differentiator {
                form: self.form,
                values: values.as_slice(),
                variables,
                settings,
                state: &begun.state,
                q: &begun.q,
                qdot: &begun.qdot,
                is_over,
            };
            differentiator.run()
        })
    }

    fn certify(
        &self,
        origin: &Origin,
        request: &Certification,
        observer: &mut (dyn FnMut(&Strike) + Send),
    ) -> Result<Certified, Refusal> {
        in_form!(self, origin, request, |model, state| {
            let values = TaylorField::parameters(model);
            let subject = Subject {
                form: self.form,
                values: values.as_slice(),
                origin,
                state: StateVector::as_slice(&state),
            };
            subject.certify(request, observer)
        })
    }
}

/// Makes several runs at once, in one form of the model. A run without a valid initial state yields its [`Refusal`].
fn abreast<M: Model, S: Model<Vector = M::Vector>>(
    typed: &Typed<M>,
    runs: Vec<Together<'_>>,
    settings: &Settings,
    looks_inside: bool,
    form: impl Fn(&M) -> S,
) -> Vec<Result<Ending, Refusal>> {
    let mut refused = Vec::new();
    let mut begun = Vec::new();
    for (index, run) in runs.into_iter().enumerate() {
        let mut member = Typed {
            model: typed.model.clone(),
            code: typed.code,
            form: typed.form,
        };
        for (index, value) in run.parameters.iter().enumerate() {
            member.model.set_parameter(index, *value);
        }
        let model = form(&member.model);
        match member.prepare(&model, 0.0, &run.origin) {
            Ok(state) => begun.push(Abreast {
                model,
                state,
                watch: run.watch,
            }),
            Err(error) => refused.push((index, error)),
        }
    }
    let mut endings = run::simulate_abreast(begun, settings, looks_inside);
    for (index, error) in refused {
        endings.insert(index, Err(error.into()));
    }
    endings
}

/// Values of a state for tables and pictures.
pub(crate) fn point<M: Instance>(model: &M, t: f64, state: &M::State) -> Point {
    let description = model.description();
    let mode = description.modes.get(model.mode(state));
    // A mode may lack some coordinates of the model.
    let has = |index: usize| mode.is_none_or(|mode| mode.coordinates.contains(&index));
    let masked = |values: &[f64]| -> Vec<f64> {
        let numbered = values.iter().enumerate();
        numbered
            .map(|(index, &value)| if has(index) { value } else { f64::NAN })
            .collect()
    };
    let components = |values: Result<M::Vector, Fault>| match values {
        Ok(values) => masked(values.as_slice()),
        Err(_) => vec![f64::NAN; model.coordinate_count()],
    };
    let mut outputs = vec![f64::NAN; description.outputs.len()];
    if model.outputs(t, state, &mut outputs).is_err() {
        outputs.fill(f64::NAN);
    }
    Point {
        mode: mode.map(|mode| mode.name),
        q: masked(model.position(state).as_slice()),
        qdot: components(model.velocity(t, state)),
        p: components(model.momentum(t, state)),
        energy: model.energy(t, state).unwrap_or(f64::NAN),
        outputs,
        view: model.view_path(t, state),
    }
}

/// A vector of the same length, with these components; missing components are 0.
fn vector<V: StateVector>(like: &V, components: &[f64]) -> V {
    let mut vector = like.zeroed();
    for (component, &value) in vector.as_mut_slice().iter_mut().zip(components) {
        *component = value;
    }
    vector
}
