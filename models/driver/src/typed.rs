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
use crate::owner::{Inlined, LARGEST, MakeWhole, OfForm, OfType, Owner};
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

/// The model of a type, with its declared parameter values. `whole` makes the form of its declaration. It is called when
/// the global form is first needed.
pub fn of_type<M: Model + Described + 'static>(whole: MakeWhole) -> Box<dyn AnyModel> {
    Box::new(Typed {
        owner: Inlined::of(M::with_defaults(), whole),
        code: Code::Inlined,
    })
}

/// The model of a system, with the values of its parameters.
pub fn of_system<M: Model + 'static>(system: M) -> Box<dyn AnyModel> {
    Box::new(Typed {
        owner: OfType(system),
        code: Code::Inlined,
    })
}

/// The model of a loaded form, with its declared parameter values, run by an erased system of the least sufficient
/// capacity ([`erased::Form::capacity`]). A shared form is freed with its last owner.
///
/// # Errors
/// [`Excess`] if the form exceeds every capacity.
pub fn of_form(form: Shared<erased::Form>, code: Code) -> Result<Box<dyn AnyModel>, Excess> {
    erased(&form, None, code)
}

/// Same as [`of_form`], for a compiled form. `whole` makes the form of the same declaration with everything; it is called
/// when the global form or certified motion is first needed.
///
/// # Errors
/// Same as [`of_form`].
pub fn of_compiled(
    form: &'static erased::Form,
    whole: &MakeWhole,
) -> Result<Box<dyn AnyModel>, Excess> {
    erased(&Shared::Static(form), Some(whole), Code::Pointers)
}

// NOTE: not generic, so that the code that runs forms is compiled once, in this crate.
fn erased(
    form: &Shared<erased::Form>,
    whole: Option<&MakeWhole>,
    code: Code,
) -> Result<Box<dyn AnyModel>, Excess> {
    fn with_room<const C: usize>(
        form: &Shared<erased::Form>,
        whole: Option<&MakeWhole>,
        code: Code,
    ) -> Result<Box<dyn AnyModel>, Excess> {
        let owner = OfForm::<C>::of(form, whole)?;
        Ok(Box::new(Typed { owner, code }))
    }
    with_room::<8>(form, whole, code).or_else(|_| with_room::<LARGEST>(form, whole, code))
}

/// The global form of a model.
pub(crate) fn global<M: Model>(model: &M) -> Result<M::Global, Fault> {
    model.global().ok_or(Fault::NotDerived)
}

/// The velocity that belongs to given momenta, after all checks except that of the constraints. Momenta belong to the
/// global form and need not satisfy the constraints.
fn velocity_of<M: Model>(model: &M, t: f64, q: &[f64], p: &[f64]) -> Result<M::Vector, StateError> {
    let global = global(model)?;
    let zero = global.zero_vector();
    let (q, p) = (vector(&zero, q), vector(&zero, p));
    global.check_parameters()?;
    let mut components = q.as_slice().iter().chain(p.as_slice());
    if let Some(component) = components.position(|value| !value.is_finite()) {
        return Err(StateError::NotFinite { component });
    }
    let state = global.state_from_momenta(t, &q, &p)?;
    match global.outside_chart(&state) {
        Some(coordinate) => Err(StateError::OutsideChart { coordinate }),
        None => Ok(global.velocity(t, &state)?),
    }
}

/// The initial state of `system`, a form of the model. `general` gives the model with its global form, which is needed
/// for momenta.
pub(crate) fn prepare<G: Model, S: System>(
    general: impl FnOnce() -> Result<G, Fault>,
    system: &S,
    t: f64,
    origin: &Origin,
) -> Result<S::State, StateError> {
    let mut q = vector(&system.zero_vector(), &origin.q);
    if origin.policy == OffConstraint::Project {
        q = system.complete_position(t, &q, &system.zero_vector())?;
    }
    let qdot = match &origin.rates {
        Rates::Velocities(qdot) => {
            let qdot = vector(&q, qdot);
            system.checked(t, &q, &qdot)?;
            qdot
        }
        Rates::Momenta(p) => {
            let qdot = velocity_of(&general()?, t, q.as_slice(), p)?;
            vector(&q, qdot.as_slice())
        }
    };
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
        let general = || $typed.owner.general();
        match $settings.form {
            Form::Reduced => {
                let $model = &$typed.owner.system();
                let $state = prepare(general, $model, 0.0, $origin)?;
                $work
            }
            Form::Global => {
                let $model = &$typed.global().map_err(StateError::from)?;
                let $state = prepare(general, $model, 0.0, $origin)?;
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
        match form {
            Form::Reduced => TaylorField::work(&self.owner.system()),
            Form::Global => TaylorField::work(&self.global().ok()?),
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
        let state = prepare(|| self.owner.general(), &self.global()?, t, origin)?;
        Ok(state.as_slice().to_vec())
    }

    fn point(&self, origin: &Origin) -> Result<Point, StateError> {
        let global = self.global()?;
        let state = prepare(|| self.owner.general(), &global, 0.0, origin)?;
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
        let model = self.owner.general()?;
        let global = global(&model)?;
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

    fn impact(&self, state: &[f64], contact: &Contacted, law: Law) -> Result<Vec<f64>, Fault> {
        let global = self.global()?;
        let contact = Contact::<<GlobalOf<'_, O> as System>::Impulse> {
            gap_rate: contact.gap_rate,
            constrained_rate: contact.constrained_rate,
            surface_rate: contact.surface_rate,
            constrained_compliance: contact.constrained_compliance,
            free_compliance: contact.free_compliance,
            direction: vector(&global.zero_impulse(), &contact.direction),
        };
        let mut state = vector(&global.zero_state(), state);
        global.kick(&mut state, contact.impulse(law), &contact.direction);
        Ok(StateVector::as_slice(&state).to_vec())
    }

    fn kick(&self, state: &[f64], impulse: &[f64]) -> Result<Vec<f64>, Fault> {
        let global = self.global()?;
        let mut state = vector(&global.zero_state(), state);
        global.kick(&mut state, 1.0, &vector(&global.zero_impulse(), impulse));
        Ok(StateVector::as_slice(&state).to_vec())
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
        let form = self.owner.whole()?;
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
        let general = || self.owner.general();
        match settings.form {
            Form::Reduced => abreast(&general, &self.owner.system(), runs, settings, looks_inside),
            Form::Global => match self.global() {
                Ok(global) => abreast(&general, &global, runs, settings, looks_inside),
                Err(fault) => runs
                    .iter()
                    .map(|_| Err(StateError::from(fault).into()))
                    .collect(),
            },
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
        let state = prepare(|| self.owner.general(), &model, place.t, origin)?;
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
                form: self.owner.whole(),
                values: values.as_slice(),
                origin,
                state: StateVector::as_slice(&state),
            };
            subject.certify(request, observer)
        })
    }
}

/// The global form of the model of an owner.
type GlobalOf<'a, O> = <<O as Owner>::General<'a> as Instance>::Global;

impl<O: Owner> Typed<O> {
    /// The model in its global form.
    fn global(&self) -> Result<GlobalOf<'_, O>, Fault> {
        global(&self.owner.general()?)
    }

    /// Makes a computation on the section of a search; `None` for a scene without variations.
    fn at_section<W: Work>(
        &self,
        origin: &Origin,
        search: &Search,
        work: W,
    ) -> Result<Option<Result<W::Output, OrbitError>>, Refusal> {
        let model = self.owner.varied()?;
        let state = prepare(|| self.owner.general(), &model, 0.0, origin)?;
        let qdot = model.velocity(0.0, &state).map_err(StateError::from)?;
        let q = model.position(&state);
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
