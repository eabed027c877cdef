//! A list of models of any types: each model behind one object-safe trait.
//!
//! [`Entry::of`] instantiates [`Typed`] for a model type, and with it the emitted code; everything else in this
//! crate works on slices of numbers through [`AnyModel`] and is compiled once.

use dalembert::declaration::{Described, SceneVisitor};
use dalembert::describe::{Description, Instance, Report};
use dalembert::erased::{Erased, Form as ModelForm};
use dalembert::law::{Contact, Law};
use dalembert::state::StateVector;
use dalembert::{
    Fault, Lagrangian, ParameterError, Scene, SceneEffects, StateError, System, TaylorField,
    VectorField,
};

use crate::accuracy::{self, Plan, Study, Verified};
use crate::args::{Form, OffConstraint};
use crate::driver::{self, Abreast, Ending, Settings, Watch};
use crate::error::state_text;
use crate::orbit::{Finder, Found, Missed, Search};

/// One model of the list handed to [`run`](crate::run), with its scenes.
#[derive(Clone)]
pub struct Entry {
    description: Description,
    scenes: Vec<(&'static str, Build)>,
}

/// What makes a model with declared defaults.
#[derive(Debug, Clone, Copy)]
enum Build {
    /// A form, that the systems of all forms run.
    Erased(&'static ModelForm),
    /// A type, which everything that runs a model is compiled for.
    Typed(fn() -> Box<dyn AnyModel>),
}

impl Build {
    // NOTE: evaluated while compiling, so that nothing but kernels is compiled of a type that has a form.
    const fn of<M: Model + Described>() -> Self {
        match M::FORM {
            Some(form) if !cfg!(feature = "inlined") => Self::Erased(form),
            _ => Self::Typed(typed::<M>),
        }
    }

    fn build(self) -> Box<dyn AnyModel> {
        match self {
            Self::Erased(form) => erased(form),
            Self::Typed(build) => build(),
        }
    }
}

fn typed<M: Model + Described>() -> Box<dyn AnyModel> {
    Box::new(Typed {
        model: M::with_defaults(),
        code: Code::Inlined,
    })
}

/// The system of a form, of the least capacity that it fits into.
fn erased(form: &'static ModelForm) -> Box<dyn AnyModel> {
    fn with_room<const C: usize>(form: &'static ModelForm) -> Option<Box<dyn AnyModel>> {
        let model = Erased::<C>::of(form)?;
        let code = Code::Pointers;
        Some(Box::new(Typed { model, code }))
    }
    let system = with_room::<4>(form)
        .or_else(|| with_room::<8>(form))
        .or_else(|| with_room::<16>(form))
        .or_else(|| with_room::<32>(form))
        .or_else(|| with_room::<64>(form));
    system.expect("a form that there is a capacity for")
}

impl Entry {
    /// The entry of a model type with its scenes; the model itself is the scene `all`.
    pub fn of<M: Model + Described>() -> Self {
        let mut entry = Self {
            description: M::DESCRIPTION,
            scenes: vec![("all", const { Build::of::<M>() })],
        };
        M::visit_scenes(&mut entry);
        entry
    }

    /// What the model says of itself.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// The names of the scenes, `all` first.
    pub fn scenes(&self) -> impl Iterator<Item = &'static str> + Clone {
        self.scenes.iter().map(|(name, _)| *name)
    }

    /// The model in the scene of this index, with declared defaults.
    pub(crate) fn with_defaults(&self, scene: usize) -> Box<dyn AnyModel> {
        self.scenes[scene].1.build()
    }
}

impl SceneVisitor for Entry {
    fn visit<S>(&mut self, name: &'static str)
    where
        S: Described<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian + 'static,
    {
        self.scenes.push((name, const { Build::of::<S>() }));
    }
}

/// What the command line needs of a model with values for its parameters: everything that `model!` implements.
pub trait Model:
    Instance<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian + 'static
{
}

impl<M> Model for M where
    M: Instance<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian + 'static
{
}

/// A list of models for [`run`](crate::run), by their types: `models![Pendulum, RollingDisk]`.
#[macro_export]
macro_rules! models {
    ($($model:ty),* $(,)?) => { vec![$($crate::Entry::of::<$model>()),*] };
}

/// Velocities or momenta, one per coordinate.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Rates {
    Velocities(Vec<f64>),
    Momenta(Vec<f64>),
}

/// A state as it is given.
#[derive(Debug, Clone)]
pub(crate) struct Origin {
    pub q: Vec<f64>,
    pub rates: Rates,
    /// What to do where it is off the constraints.
    pub policy: OffConstraint,
}

/// The declared initial condition.
#[derive(Debug, Clone)]
pub(crate) struct Start {
    pub q: Vec<f64>,
    pub qdot: Vec<f64>,
    /// Whether the position is given; equations of positions among the constraints may choose the others.
    pub placed: Vec<bool>,
    /// Whether the velocity is given; the constraints may choose the others.
    pub named: Vec<bool>,
    pub until: Option<f64>,
}

/// What tables and pictures show of a state; NaN where a quantity does not exist.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Point {
    /// The name of the mode, of a model with modes.
    pub mode: Option<&'static str>,
    pub q: Vec<f64>,
    pub qdot: Vec<f64>,
    pub p: Vec<f64>,
    pub energy: f64,
    pub outputs: Vec<f64>,
    pub view: Option<[f64; 2]>,
}

impl Point {
    /// A point of which nothing is known.
    pub fn undefined(description: &Description) -> Self {
        let nothing = vec![f64::NAN; description.coordinates.len()];
        Self {
            mode: None,
            q: nothing.clone(),
            qdot: nothing.clone(),
            p: nothing,
            energy: f64::NAN,
            outputs: vec![f64::NAN; description.outputs.len()],
            view: None,
        }
    }
}

/// A model with values for its parameters. States are those of its global form, positions and momenta.
pub(crate) trait AnyModel: Runs {
    fn code(&self) -> Code;
    fn description(&self) -> Description;
    /// The names of the inputs, whose values are the parameters after those of the description.
    fn inputs(&self) -> &'static [&'static str];
    fn parameter(&self, index: usize) -> f64;
    fn set_parameter(&mut self, index: usize, value: f64);
    /// The mode, by number, that states are made in.
    fn set_mode(&mut self, mode: usize);
    fn check_parameters(&self) -> Result<(), ParameterError>;
    fn initial(&self) -> Start;
    /// The positions with those that are not `placed` chosen by equations of positions among the constraints.
    fn complete_position(&self, q: &[f64], placed: &[bool]) -> Result<Vec<f64>, StateError>;
    /// The velocities with those that are not `named` chosen by the constraints.
    fn complete_velocity(
        &self,
        q: &[f64],
        qdot: &[f64],
        named: &[bool],
    ) -> Result<Vec<f64>, StateError>;
    fn state(&self, t: f64, origin: &Origin) -> Result<Vec<f64>, StateError>;
    fn region(&self, t: f64, q: &[f64]) -> Option<f64>;
    fn inspect(&self, t: f64, state: &[f64], report: &mut dyn Report) -> Result<(), Fault>;
    /// The law that a surface declares.
    fn law(&self, surface: usize) -> Option<Law>;
    /// The state after the impact of a law.
    fn impact(&self, state: &[f64], contact: &Contacted, law: Law) -> Vec<f64>;
    /// The state after an impulse on its momenta.
    fn kick(&self, state: &[f64], impulse: &[f64]) -> Vec<f64>;
}

/// The runs of a model with values for its parameters.
pub(crate) trait Runs {
    fn simulate(
        &self,
        origin: &Origin,
        settings: &Settings,
        watch: &mut dyn Watch,
    ) -> Result<Ending, String>;
    /// As [`Runs::simulate`], with Taylor series, of several runs at once; `looks_inside` where watches look at
    /// states inside steps.
    fn simulate_abreast(
        &self,
        runs: Vec<Together<'_>>,
        settings: &Settings,
        looks_inside: bool,
    ) -> Vec<Result<Ending, String>>;
    /// What accuracy costs from this state on; `tell` hears what is about to be measured.
    fn study(
        &self,
        origin: &Origin,
        base: &Settings,
        plan: &Plan,
        tell: &mut dyn FnMut(&str),
    ) -> Result<Study, String>;
    /// The measured error of a run that ended so.
    fn verify(
        &self,
        origin: &Origin,
        settings: &Settings,
        ending: &Ending,
    ) -> Result<Verified, String>;
    /// A periodic orbit near the first arrival from this state; `None` for a scene without variations.
    fn orbit(
        &self,
        origin: &Origin,
        search: &Search,
    ) -> Result<Option<Result<Found, Missed>>, String>;
}

/// One of several runs that are made at once.
pub(crate) struct Together<'w> {
    /// The values of all parameters.
    pub parameters: Vec<f64>,
    pub origin: Origin,
    pub watch: &'w mut dyn Watch,
}

/// The data of a contact as `inspect` reports them.
#[derive(Debug, Clone)]
pub(crate) struct Contacted {
    pub gap_rate: f64,
    pub constrained_rate: f64,
    pub surface_rate: f64,
    pub constrained_compliance: f64,
    pub free_compliance: f64,
    pub direction: Vec<f64>,
}

/// How the functions of a model are called, which its speed depends on and nothing else.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Code {
    /// They are inlined into what runs the model.
    Inlined,
    /// They are behind pointers.
    Pointers,
}

impl Code {
    pub fn name(self) -> &'static str {
        match self {
            Self::Inlined => "inlined",
            Self::Pointers => "behind pointers",
        }
    }
}

/// A model type behind [`AnyModel`].
struct Typed<M> {
    model: M,
    code: Code,
}

impl<M: Model> Typed<M> {
    /// The velocity that is meant, after every check but that of the constraints. Momenta are those of the global
    /// form: they may lie off the constraints.
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
            // Momenta that may be kept are kept to the last digit.
            (_, Rates::Momenta(p)) => system.state_from_momenta(t, &q, &vector(&q, p))?,
            _ => system.state_unchecked(t, &q, &qdot)?,
        })
    }
}

/// Whether a mark of [`Initial`](dalembert::describe::Initial) is set.
fn is_marked(mark: &f64) -> bool {
    *mark != 0.0
}

fn marks(marked: &[bool]) -> Vec<f64> {
    let mark = |&marked: &bool| f64::from(u8::from(marked));
    marked.iter().map(mark).collect()
}

/// What is to be done with the model in the form that the settings ask for, and the state in it.
macro_rules! in_form {
    ($typed:ident, $origin:ident, $settings:ident, |$model:ident, $state:ident| $work:expr) => {{
        let text = |error| state_text($typed.model.description(), &error);
        match $settings.form {
            Form::Reduced => {
                let $model = &$typed.model;
                let $state = $typed.prepare($model, 0.0, $origin).map_err(text)?;
                $work
            }
            Form::Global => {
                let $model = &$typed.model.global();
                let $state = $typed.prepare($model, 0.0, $origin).map_err(text)?;
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
        let [q, qdot, named] = [q, qdot, &marks(named)].map(|own| vector(&zero, own));
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
    ) -> Result<Ending, String> {
        in_form!(self, origin, settings, |model, state| driver::simulate(
            model, state, settings, watch
        ))
    }

    fn simulate_abreast(
        &self,
        runs: Vec<Together<'_>>,
        settings: &Settings,
        looks_inside: bool,
    ) -> Vec<Result<Ending, String>> {
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
    ) -> Result<Study, String> {
        in_form!(self, origin, base, |model, state| accuracy::study(
            model, &state, base, plan, tell
        ))
    }

    fn verify(
        &self,
        origin: &Origin,
        settings: &Settings,
        ending: &Ending,
    ) -> Result<Verified, String> {
        in_form!(self, origin, settings, |model, state| accuracy::verify(
            model, &state, settings, ending
        ))
    }

    fn orbit(
        &self,
        origin: &Origin,
        search: &Search,
    ) -> Result<Option<Result<Found, Missed>>, String> {
        let text = |error| state_text(self.model.description(), &error);
        let state = self.prepare(&self.model, 0.0, origin).map_err(text)?;
        let velocity = self.model.velocity(0.0, &state);
        let qdot = velocity.map_err(|fault| text(fault.into()))?;
        let q = self.model.position(&state);
        let finder = Finder {
            search,
            q: q.as_slice(),
            qdot: qdot.as_slice(),
        };
        self.model.visit_variational(finder).transpose()
    }
}

/// Makes several runs at once, in a form of the model. Runs that have no state to begin with are told why.
fn abreast<M: Model, S: Model<Vector = M::Vector>>(
    typed: &Typed<M>,
    runs: Vec<Together<'_>>,
    settings: &Settings,
    looks_inside: bool,
    form: impl Fn(&M) -> S,
) -> Vec<Result<Ending, String>> {
    let mut refused = Vec::new();
    let mut begun = Vec::new();
    for (index, run) in runs.into_iter().enumerate() {
        let mut own = Typed {
            model: typed.model.clone(),
            code: typed.code,
        };
        for (index, value) in run.parameters.iter().enumerate() {
            own.model.set_parameter(index, *value);
        }
        let model = form(&own.model);
        match own.prepare(&model, 0.0, &run.origin) {
            Ok(state) => begun.push(Abreast {
                model,
                state,
                watch: run.watch,
            }),
            Err(error) => refused.push((index, state_text(own.model.description(), &error))),
        }
    }
    let mut endings = driver::simulate_abreast(begun, settings, looks_inside);
    for (index, reason) in refused {
        endings.insert(index, Err(reason));
    }
    endings
}

/// What tables and pictures show of a state.
pub(crate) fn point<M: Instance>(model: &M, t: f64, state: &M::State) -> Point {
    let description = model.description();
    let mode = description.modes.get(model.mode(state));
    // A mode need not have all coordinates of the model.
    let has = |index: usize| mode.is_none_or(|mode| mode.coordinates.contains(&index));
    let own = |values: &[f64]| -> Vec<f64> {
        let numbered = values.iter().enumerate();
        numbered
            .map(|(index, &value)| if has(index) { value } else { f64::NAN })
            .collect()
    };
    let components = |values: Result<M::Vector, Fault>| match values {
        Ok(values) => own(values.as_slice()),
        Err(_) => vec![f64::NAN; model.coordinate_count()],
    };
    let mut outputs = vec![f64::NAN; description.outputs.len()];
    if model.outputs(t, state, &mut outputs).is_err() {
        outputs.fill(f64::NAN);
    }
    Point {
        mode: mode.map(|mode| mode.name),
        q: own(model.position(state).as_slice()),
        qdot: components(model.velocity(t, state)),
        p: components(model.momentum(t, state)),
        energy: model.energy(t, state).unwrap_or(f64::NAN),
        outputs,
        view: model.view_path(t, state),
    }
}

/// A vector like this one, of these components; missing ones are 0.
fn vector<V: StateVector>(like: &V, components: &[f64]) -> V {
    let mut vector = like.zeroed();
    for (component, &value) in vector.as_mut_slice().iter_mut().zip(components) {
        *component = value;
    }
    vector
}
