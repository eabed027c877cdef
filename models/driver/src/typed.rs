//! [`AnyModel`] for systems of any type.

use dalembert::declaration::Described;
use dalembert::describe::{Description, Instance, Report};
use dalembert::erased::{self, Excess, Shared};
use dalembert::law::{Contact, Law};
use dalembert::numbers::Row;
use dalembert::state::StateVector;
use dalembert::{
    Fault, Lagrangian, OrbitError, ParameterError, Scene, SceneEffects, StateError, System,
    TaylorField, VectorField,
};

use crate::accuracy::{self, Plan, Study, Verified};
use crate::certify::{Certification, Certified, Strike, Subject};
use crate::connect::{Boundary, Connected, Joiner, Stage, Unjoined};
use crate::continuation::trace::Watch as BranchWatch;
use crate::continuation::{Branch, Continuation};
use crate::control::{Controlled, Controller, Task, Unsought};
use crate::dynamic::{Landing, Leg, Unlanded, Walker};
use crate::integrator::Form;
use crate::linearisation::{Linearisation, Lineariser, Place, Unlinear};
use crate::model::{
    AnyModel, Code, Contacted, OffConstraint, Origin, Point, Rates, Runs, Start, Together, point,
};
use crate::orbit::{
    ForBranch, ForExponent, ForOrbit, ForReturn, Found, Growth, Search, Visit, Work,
};
use crate::owner::{OfForm, OfType, Owner};
use crate::refusal::Refusal;
use crate::run::{self, Control, Ending, Settings, Watch, abreast};

/// A system that can be run behind [`AnyModel`]: the traits that `model!` implements for a model with values for its
/// parameters.
pub trait Model:
    Instance<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian
{
}

impl<M> Model for M where
    M: Instance<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian
{
}

/// A model behind [`AnyModel`].
struct Typed<O> {
    owner: O,
    code: Code,
}

/// The model of a type, with its declared parameter values.
pub fn of_type<M: Model + Described + 'static>() -> Box<dyn AnyModel> {
    of_system(M::with_defaults())
}

/// The model of a system, with the values of its parameters.
pub fn of_system<M: Model + 'static>(system: M) -> Box<dyn AnyModel> {
    Box::new(Typed {
        owner: OfType(system),
        code: Code::Inlined,
    })
}

/// The model of a form, with its declared parameter values, run by an erased system of the least sufficient capacity
/// ([`erased::Form::capacity`]). A shared form is freed with its last owner.
///
/// # Errors
/// [`Excess`] if the form exceeds every capacity.
// NOTE: not generic, so that the code that runs forms is compiled once, in this crate.
pub fn of_form(form: Shared<erased::Form>, code: Code) -> Result<Box<dyn AnyModel>, Excess> {
    fn with_room<const C: usize>(
        form: &Shared<erased::Form>,
        code: Code,
    ) -> Result<Box<dyn AnyModel>, Excess> {
        let owner = OfForm::<C>::of(form)?;
        Ok(Box::new(Typed { owner, code }))
    }
    with_room::<8>(&form, code).or_else(|_| with_room::<128>(&form, code))
}

/// The given velocity, after all checks except that of the constraints. Momenta belong to the global form and need not
/// satisfy the constraints.
fn checked_velocity<M: Model>(
    model: &M,
    t: f64,
    q: &M::Vector,
    rates: &Rates,
) -> Result<M::Vector, StateError> {
    let global = model.global();
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

/// The position and the velocity of a given state, after all checks.
fn located<M: Model>(model: &M, origin: &Origin) -> Result<(M::Vector, M::Vector), StateError> {
    let state = prepare(model, model, 0.0, origin)?;
    let qdot = model.velocity(0.0, &state)?;
    Ok((model.position(&state), qdot))
}

/// The initial state of `system`, which is the reduced or the global form of `model`.
pub(crate) fn prepare<M: Model, S: System<Vector = M::Vector>>(
    model: &M,
    system: &S,
    t: f64,
    origin: &Origin,
) -> Result<S::State, StateError> {
    let mut q = vector(&system.zero_vector(), &origin.q);
    if origin.policy == OffConstraint::Project {
        q = system.complete_position(t, &q, &system.zero_vector())?;
    }
    let qdot = checked_velocity(model, t, &q, &origin.rates)?;
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
                let $model = &$typed.owner.system();
                let $state = prepare($model, $model, 0.0, $origin)?;
                $work
            }
            Form::Global => {
                let declared = &$typed.owner.system();
                let $model = &declared.global();
                let $state = prepare(declared, $model, 0.0, $origin)?;
                $work
            }
        }
    }};
}

impl<O: Owner> AnyModel for Typed<O> {
    fn code(&self) -> Code {
        self.code
    }

    fn description(&self) -> &Description {
        self.owner.description()
    }

    fn inputs(&self) -> &[&'static str] {
        self.owner.inputs()
    }

    fn parameter(&self, index: usize) -> f64 {
        self.owner.system().parameter(index)
    }

    fn set_parameter(&mut self, index: usize, value: f64) {
        self.owner.set_parameter(index, value);
    }

    fn work(&self, form: Form) -> Option<dalembert::jet::Work> {
        let model = self.owner.system();
        match form {
            Form::Reduced => TaylorField::work(&model),
            Form::Global => TaylorField::work(&model.global()),
        }
    }

    fn set_mode(&mut self, mode: usize) {
        self.owner.set_mode(mode);
    }

    fn present_mode(&self) -> Option<&'static str> {
        let (number, _) = self.owner.mode()?;
        let mode = self.owner.description().modes.get(number)?;
        Some(mode.name)
    }

    fn depends_on_time(&self) -> bool {
        System::depends_on_time(&self.owner.system())
    }

    fn mode_alone(&self) -> Option<Box<dyn AnyModel>> {
        let (_, form) = self.owner.mode()?;
        let mut alone = of_form(form, self.code).ok()?;
        let values = TaylorField::parameters(&self.owner.system());
        for (index, value) in Row::as_slice(&values).iter().enumerate() {
            alone.set_parameter(index, *value);
        }
        Some(alone)
    }

    fn check_parameters(&self) -> Result<(), ParameterError> {
        self.owner.system().check_parameters()
    }

    fn initial(&self) -> Start {
        let initial = self.owner.system().initial();
        Start {
            q: initial.q.as_slice().to_vec(),
            qdot: initial.qdot.as_slice().to_vec(),
            placed: initial.placed.as_slice().iter().map(is_marked).collect(),
            named: initial.named.as_slice().iter().map(is_marked).collect(),
            until: initial.until,
        }
    }

    fn complete_position(&self, q: &[f64], placed: &[bool]) -> Result<Vec<f64>, StateError> {
        let model = self.owner.system();
        let zero = model.zero_vector();
        let (q, placed) = (vector(&zero, q), vector(&zero, &marks(placed)));
        let completed = model.complete_position(0.0, &q, &placed)?;
        Ok(completed.as_slice().to_vec())
    }

    fn complete_velocity(
        &self,
        q: &[f64],
        qdot: &[f64],
        named: &[bool],
    ) -> Result<Vec<f64>, StateError> {
        let model = self.owner.system();
        let zero = model.zero_vector();
        let [q, qdot, named] = [q, qdot, &marks(named)].map(|values| vector(&zero, values));
        let completed = model.complete_velocity(0.0, &q, &qdot, &named)?;
        Ok(completed.as_slice().to_vec())
    }

    fn state(&self, t: f64, origin: &Origin) -> Result<Vec<f64>, StateError> {
        let model = self.owner.system();
        let state = prepare(&model, &model.global(), t, origin)?;
        Ok(state.as_slice().to_vec())
    }

    fn point(&self, origin: &Origin) -> Result<Point, StateError> {
        let model = self.owner.system();
        let global = model.global();
        let state = prepare(&model, &global, 0.0, origin)?;
        Ok(point(&global, 0.0, &state))
    }

    fn outputs(&self, t: f64, q: &[f64], qdot: &[f64]) -> Option<Vec<f64>> {
        let model = self.owner.system();
        let [q, qdot] = [q, qdot].map(|values| vector(&model.zero_vector(), values));
        let state = model.state_unchecked(t, &q, &qdot).ok()?;
        let mut outputs = vec![f64::NAN; model.description().outputs.len()];
        model.outputs(t, &state, &mut outputs).ok()?;
        for &index in model.description().integrals.iter() {
            outputs[index] = f64::NAN;
        }
        Some(outputs)
    }

    fn region(&self, t: f64, q: &[f64]) -> Option<f64> {
        let model = self.owner.system();
        model.view_region(t, &vector(&model.zero_vector(), q))
    }

    fn inspect(&self, t: f64, state: &[f64], report: &mut dyn Report) -> Result<(), Fault> {
        let model = self.owner.system();
        let global = model.global();
        let state = vector(&global.zero_state(), state);
        global.inspect(t, &state, report)?;
        if model.description().quasi_velocities.is_empty() {
            return Ok(());
        }
        let (q, qdot) = (global.position(&state), global.velocity(t, &state)?);
        let state = model.state_unchecked(t, &q, &qdot)?;
        model.inspect_frame(t, &state, report)
    }

    fn law(&self, surface: usize) -> Option<Law> {
        let model = self.owner.system();
        model.effects().law(&model, surface)
    }

    fn impact(&self, state: &[f64], contact: &Contacted, law: Law) -> Vec<f64> {
        let model = self.owner.system();
        let global = model.global();
        let contact = Contact::<<<O::System<'_> as Instance>::Global as System>::Impulse> {
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
        let model = self.owner.system();
        let global = model.global();
        let mut state = vector(&global.zero_state(), state);
        global.kick(&mut state, 1.0, &vector(&global.zero_impulse(), impulse));
        StateVector::as_slice(&state).to_vec()
    }
}

impl<O: Owner> Runs for Typed<O> {
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

    fn steer(
        &self,
        origin: &Origin,
        settings: &Settings,
        control: &Control<'_>,
        watch: &mut dyn Watch,
    ) -> Option<Result<Ending, Refusal>> {
        let values = TaylorField::parameters(&self.owner.system());
        let form = self.owner.form()?;
        run::steer(
            form,
            Row::as_slice(&values),
            origin,
            settings,
            control,
            watch,
        )
    }

    fn simulate_abreast(
        &self,
        runs: Vec<Together<'_>>,
        settings: &Settings,
        looks_inside: bool,
    ) -> Vec<Result<Ending, Refusal>> {
        let model = self.owner.system();
        match settings.form {
            Form::Reduced => abreast(&model, runs, settings, looks_inside, Clone::clone),
            Form::Global => abreast(&model, runs, settings, looks_inside, Instance::global),
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
        self.at_section(origin, search, ForOrbit)
    }

    fn branch(
        &self,
        origin: &Origin,
        search: &Search,
        request: &Continuation,
        watch: BranchWatch<'_>,
    ) -> Result<Option<Result<Branch, OrbitError>>, Refusal> {
        let request = *request;
        self.at_section(origin, search, ForBranch { request, watch })
    }

    fn returned(
        &self,
        origin: &Origin,
        search: &Search,
    ) -> Result<Option<Result<[Point; 2], OrbitError>>, Refusal> {
        self.at_section(origin, search, ForReturn)
    }

    fn exponent(
        &self,
        origin: &Origin,
        search: &Search,
        growth: Growth,
    ) -> Result<Option<Result<f64, OrbitError>>, Refusal> {
        self.at_section(origin, search, ForExponent(growth))
    }

    fn connect(
        &self,
        boundary: &Boundary,
        tell: &mut dyn FnMut(Stage),
    ) -> Result<Option<Result<Connected, Unjoined>>, Refusal> {
        let joiner = Joiner { boundary, tell };
        self.owner.varied()?.visit_variational(joiner).transpose()
    }

    fn linearise(
        &self,
        origin: &Origin,
        place: &Place,
    ) -> Result<Option<Result<Linearisation, Unlinear>>, Refusal> {
        let model = self.owner.varied()?;
        let state = prepare(&model, &model, place.t, origin)?;
        let q = model.position(&state);
        let qdot = model.velocity(place.t, &state).map_err(StateError::from)?;
        let given = [StateVector::as_slice(&q), StateVector::as_slice(&qdot)];
        let lineariser = Lineariser { given, place };
        model.visit_variational(lineariser).transpose()
    }

    fn control(
        &self,
        task: &Task,
        tell: &mut dyn FnMut(Stage),
    ) -> Result<Option<Result<Controlled, Unsought>>, Refusal> {
        let controller = Controller { task, tell };
        self.owner
            .varied()?
            .visit_variational(controller)
            .transpose()
    }

    fn legs(
        &self,
        leg: &Leg<'_>,
        from: &[[f64; 2]],
    ) -> Result<Option<Vec<Result<Landing, Unlanded>>>, Refusal> {
        let walker = Walker { leg, from };
        self.owner.varied()?.visit_variational(walker).transpose()
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
                form: self.owner.form(),
                values: values.as_slice(),
                origin,
                state: StateVector::as_slice(&state),
            };
            subject.certify(request, observer)
        })
    }
}

impl<O: Owner> Typed<O> {
    /// Makes a computation on the section of a search; `None` for a scene without variations.
    fn at_section<W: Work>(
        &self,
        origin: &Origin,
        search: &Search,
        work: W,
    ) -> Result<Option<Result<W::Output, OrbitError>>, Refusal> {
        let model = self.owner.varied()?;
        let (q, qdot) = located(&model, origin)?;
        let visit = Visit {
            search,
            q: q.as_slice(),
            qdot: qdot.as_slice(),
            work,
        };
        model.visit_variational(visit).transpose()
    }
}

/// A vector of the length of `like` with these components. Missing components are 0.
pub(crate) fn vector<V: StateVector>(like: &V, components: &[f64]) -> V {
    let mut vector = like.zeroed();
    for (component, &value) in vector.as_mut_slice().iter_mut().zip(components) {
        *component = value;
    }
    vector
}
