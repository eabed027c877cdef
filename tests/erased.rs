//! A model behind pointers runs as the model itself does, and so does one that was loaded from its text: the same tables, bits, steps and
//! impacts.

use dalembert::declaration::{Described, SceneVisitor};
use dalembert::describe::Description;
use dalembert::erased::{Bounded, Erased, Form};
use dalembert::integrate::{Chosen, Counters};
use dalembert::{
    Dla2, Dla4, Dop853, DormandPrince5, Event, Gauss4, Gauss6, Instance, Lagrangian, Observer,
    Outcome, Rk4, Scene, Segment, Simulation, StateVector, System, Taylor, TaylorField, Tolerance,
};
use dalembert_models::{
    AppellHamel, BallOnSwitchingTable, BouncingBall, Chain4, ChaplyginSleigh, DoublePendulum,
    FilippovField, HolonomicBeadOnEllipses, MovingWallDisk, RefractedParticle, RimlessWheelFive,
    RollingBallEuler, RollingDisk, SmoothAndRoughPlane, SpasmodicHamiltonian, SphereInPlane,
    SuperElasticStrip, TwoWheelsArrested, TwoWheelsRod,
};
use std::ops::ControlFlow;

dalembert::model! {
    /// A point in a square whose sides are one surface without a power series.
    pub Folded {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { sides: 1 - abs(x) - abs(y) >= 0; }
        initial { x = 0.1; y = 0.2; dot(x) = 1; dot(y) = 0.3; until = 3; }
    }
}

/// The parts of a run that are compared.
#[derive(Debug, PartialEq)]
struct Course {
    outcome: Outcome,
    t: f64,
    state: Vec<f64>,
    counters: Counters,
    /// Times, surfaces, and states before and after.
    impacts: Vec<(f64, usize, Vec<f64>, Vec<f64>)>,
}

impl<S: System> Observer<S> for Course {
    fn step(&mut self, _: &mut Segment<'_, S::State>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<S::State>) -> ControlFlow<()> {
        let [before, after] = [&event.before, &event.after].map(|own| own.as_slice().to_vec());
        self.impacts.push((event.t, event.surface, before, after));
        ControlFlow::Continue(())
    }
}

/// A run from the declared start.
fn run<S: Instance + Scene>(system: &S, stepper: Chosen<'_, S>) -> Course {
    let initial = system.initial();
    let q = system.complete_position(0.0, &initial.q, &initial.placed);
    let q = q.expect("a position");
    let qdot = system.complete_velocity(0.0, &q, &initial.qdot, &initial.named);
    let state = system.state(0.0, &q, &qdot.expect("a velocity"));
    let mut course = Course {
        outcome: Outcome::Done,
        t: 0.0,
        state: Vec::new(),
        counters: Counters::default(),
        impacts: Vec::new(),
    };
    let until = initial.until.map_or(2.0, |until| until.min(2.0));
    let mut simulation = Simulation::new(system, stepper, system.effects());
    let run = simulation.run(0.0, state.expect("a state"), until, &mut course);
    let run = run.expect("a run");
    course.outcome = run.outcome;
    course.t = run.t;
    course.state = run.state.as_slice().to_vec();
    course.counters = run.counters;
    course
}

/// The courses of a system by every integrator.
fn courses<S>(system: &S) -> Vec<Course>
where
    S: Instance + Scene + TaylorField + Lagrangian,
{
    let tolerance = Tolerance::new(1e-9).expect("a tolerance");
    macro_rules! by {
        ($($integrator:ident),*) => {
            vec![$(run(system, Chosen::new(&mut $integrator::new(tolerance)))),*]
        };
    }
    by!(
        Dop853,
        DormandPrince5,
        Taylor,
        Rk4,
        Gauss4,
        Gauss6,
        Dla2,
        Dla4
    )
}

/// The courses of a form at the declared defaults, in the least room for it.
fn of_form(form: &'static Form) -> Vec<Course> {
    fn with_room<const C: usize>(form: &'static Form) -> Option<Vec<Course>> {
        Erased::<C>::of(form).map(|system| courses(&system))
    }
    let courses = with_room::<4>(form)
        .or_else(|| with_room::<8>(form))
        .or_else(|| with_room::<32>(form));
    courses.expect("room")
}

struct Compared(usize);

impl Compared {
    /// Compares a model, or a scene of it.
    fn compare<S>(&mut self, scene: &str)
    where
        S: Described<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian,
    {
        let (system, name) = (S::with_defaults(), S::DESCRIPTION.name);
        let form = S::FORM.expect("a form");
        let expected = courses(&system);
        assert_eq!(expected, of_form(form), "{name} {scene}");
        let loaded = loaded(&S::DESCRIPTION, scene);
        assert_same_tables(form, loaded);
        assert_eq!(expected, of_form(loaded), "{name} {scene}, loaded");
        self.0 += 1;
    }
}

/// The form of a model, or of a scene of it, from its text.
fn loaded(description: &Description, scene: &str) -> &'static Form {
    let models = dalembert_jit::load(description.name, description.source);
    let models = models.unwrap_or_else(|refused| panic!("{refused}"));
    let model = &models[0];
    let found = model.scenes.iter().find(|(name, _)| *name == scene);
    found.map_or(model.form, |(_, form)| *form)
}

fn assert_same_tables(emitted: &Form, loaded: &Form) {
    let name = emitted.documentation.description.name;
    assert_eq!(emitted.tables, loaded.tables, "{name}");
    assert_eq!(emitted.documentation, loaded.documentation, "{name}");
    assert_eq!((emitted.work)(), (loaded.work)(), "{name}");
    let lengths = |form: &Form| {
        let numbers = [form.series_gaps, form.firsts, form.room];
        (form.capacity(), numbers, form.forms.len())
    };
    assert_eq!(lengths(emitted), lengths(loaded), "{name}");
    eprintln!("{name} {} {}", emitted.firsts, loaded.firsts);
    for (emitted, loaded) in emitted.forms.iter().zip(loaded.forms) {
        assert_same_tables(emitted, loaded);
    }
}

impl SceneVisitor for Compared {
    fn visit<S>(&mut self, name: &'static str)
    where
        S: Described<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian + 'static,
    {
        self.compare::<S>(name);
    }
}

#[test]
fn a_model_behind_pointers_runs_as_the_model_itself() {
    let mut compared = Compared(0);
    macro_rules! compare {
        ($($model:ty),*) => {$(
            compared.compare::<$model>("all");
        )*};
    }
    compare!(
        AppellHamel,
        BallOnSwitchingTable,
        BouncingBall,
        Chain4,
        ChaplyginSleigh,
        DoublePendulum,
        FilippovField,
        Folded,
        HolonomicBeadOnEllipses,
        MovingWallDisk,
        RefractedParticle,
        RimlessWheelFive,
        RollingBallEuler,
        RollingDisk,
        SmoothAndRoughPlane,
        SpasmodicHamiltonian,
        SphereInPlane,
        SuperElasticStrip,
        TwoWheelsArrested,
        TwoWheelsRod
    );
    RollingDisk::visit_scenes(&mut compared);
    assert_eq!(compared.0, 20 + RollingDisk::DESCRIPTION.scenes.len() - 1);
}

#[test]
fn a_form_needs_room_for_its_vectors() {
    let form = Chain4::FORM.expect("a form");
    assert_eq!(form.capacity(), Some(8));
    assert_eq!(Erased::<4>::of(form), None);
    let chain = Erased::<16>::of(form).expect("room");
    assert_eq!(chain.description().name, "chain4");
    let zeros: Bounded<f64, 16> = chain.zero_vector();
    assert_eq!(zeros.as_ref(), [0.0; 4]);
}
