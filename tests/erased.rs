//! A model behind pointers runs as the model itself does: the same bits, the same steps, the same impacts.

use dalembert::declaration::{Described, SceneVisitor};
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
    fn compare<S>(&mut self, name: &str)
    where
        S: Described<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian,
    {
        let system = S::with_defaults();
        let form = S::FORM.expect("a form");
        assert_eq!(courses(&system), of_form(form), "{name}");
        self.0 += 1;
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
            compared.compare::<$model>(<$model>::DESCRIPTION.name);
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
    assert_eq!(compared.0, 19 + RollingDisk::DESCRIPTION.scenes.len() - 1);
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
