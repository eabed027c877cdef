//! Motion along a wall whose instantaneous constraints go on holding.

use core::ops::ControlFlow;

use dalembert::law::Law;
use dalembert::{
    Described, Dop853, Fault, Hold, Impacting, Instance, Observer, Outcome, Policies, Rest, Scene,
    SceneEffects, Simulation, StateVector, System, Tolerance,
};
use dalembert_tests::numeric::assert_near;
use dalembert_tests::sampling::states;

use super::{Corner, Degenerate, Incline, Tip, corner, dot, incline, rough_forms, struck};

/// The disk dropped on its floor from a height of 0.1, at rest.
fn rolled(disk: &Incline, law: Law) -> (Outcome, f64, <Incline as dalembert::VectorField>::State) {
    let mut effects = disk.effects();
    effects.set_law(0, law);
    effects.set_policies(Policies {
        rest: Rest::Contact,
        ..Policies::default()
    });
    let stepper = Dop853::new(Tolerance::new(1e-13).expect("a tolerance"));
    let mut simulation = Simulation::new(disk, stepper, effects);
    let start = disk.state(0.0, &[0.0, disk.r + 0.1, 0.0].into(), &[0.0; 3].into());
    let run = simulation
        .run(0.0, start.expect("a state"), 2.0, &mut ())
        .expect("a run");
    let forces = simulation
        .effects()
        .0
        .contact_forces(disk, run.t, &run.state);
    let force = forces.expect("forces").expect("second rates")[0];
    (run.outcome, force, run.state)
}

#[test]
fn a_disk_rolls_down_an_incline_where_it_did_not_slip_in_its_impact() {
    for belt in [0.0, 0.3] {
        let disk = Incline {
            belt,
            ..Incline::default()
        };
        let (sin, cos) = disk.alpha.sin_cos();
        let fall = (0.2 / (disk.g * cos)).sqrt();
        // The impulse that stops the slip of what touches the floor.
        let speed = disk.g * sin * fall;
        let inverse = 1.0 / disk.m + disk.r * disk.r / disk.I;
        let impulse = (belt - speed) / inverse;
        let along = speed + impulse / disk.m;
        let rate = disk.g * sin / (1.0 + disk.I / (disk.m * disk.r * disk.r));
        let rest = 2.0 - fall;
        let x = speed * fall / 2.0 + along * rest + rate * rest * rest / 2.0;
        let speed = along + rate * rest;
        let (outcome, force, state) = rolled(&disk, Law::ImpactPlastic);
        assert_eq!(outcome, Outcome::Done);
        assert_near("x, y", &state.as_slice()[..2], &[x, disk.r], 1e-11);
        assert_near("speed", &[state[3] / disk.m], &[speed], 1e-11);
        let spin = state[5] / disk.I;
        assert_near("rolling", &[disk.r * spin], &[speed - belt], 1e-11);
        assert_near("force", &[force], &[disk.m * disk.g * cos], 1e-11);
    }
}

#[test]
fn a_disk_that_bounces_rolls_from_its_first_impact_on() {
    let disk = Incline::default();
    let (outcome, _, state) = rolled(&disk, Law::Newton(0.5));
    assert_eq!(outcome, Outcome::Done);
    let (speed, spin) = (state[3] / disk.m, state[5] / disk.I);
    assert_near("rolling", &[disk.r * spin], &[speed], 1e-10);
    assert_near("height", &[state[1]], &[disk.r], 1e-12);
}

#[test]
fn a_scene_takes_the_instantaneous_constraints_of_its_surfaces() {
    let disk = incline::Dropped(Incline::default());
    let state = disk.state(0.0, &[0.0, 0.5, 0.0].into(), &[1.0, -1.0, 0.0].into());
    let after = struck(&disk, Law::ImpactPlastic, state.expect("a state"));
    let qdot = disk.velocity(0.0, &after).expect("a velocity");
    assert_near("focused", qdot.as_slice(), &[0.8, 0.0, 1.6], 1e-15);
}

/// Keeps the surfaces that begin to hold.
struct Began(Vec<usize>);

impl<M: System> Observer<M> for Began {
    fn hold(&mut self, hold: &Hold<M::State>) -> ControlFlow<()> {
        if hold.begins {
            self.0.push(hold.surface);
        }
        ControlFlow::Continue(())
    }
}

#[test]
fn a_wall_that_is_stuck_to_and_one_that_is_not_hold_together_and_two_that_are_do_not() {
    let corner = Corner::default();
    let mut effects = corner.effects();
    effects.set_policies(Policies {
        rest: Rest::Contact,
        ..Policies::default()
    });
    let stepper = Dop853::new(Tolerance::new(1e-12).expect("a tolerance"));
    let mut simulation = Simulation::new(&corner, stepper, effects);
    let start = corner.state(0.0, &[2.0, 0.0, 1.0, -1.0].into(), &[0.0; 4].into());
    let mut began = Began(Vec::new());
    let run = simulation
        .run(0.0, start.expect("a state"), 1.0, &mut began)
        .expect("a run");
    assert_eq!(run.outcome, Outcome::Done);
    began.0.sort_unstable();
    assert_eq!(began.0, [corner::surface::wall[1], corner::surface::floor]);
    assert_near(
        "held",
        &run.state.as_slice()[..4],
        &[1.5, 0.0, 1.0, -1.0],
        1e-12,
    );
    // -1 - 2 nu + lambda = 0 and nu + lambda = 0.
    let forces = simulation
        .effects()
        .0
        .contact_forces(&corner, run.t, &run.state);
    let forces = forces.expect("forces").expect("second rates");
    assert_near("forces", forces.as_slice(), &[0.0, 1.0, 1.0 / 3.0], 1e-12);
    let run = simulation
        .run(0.0, start.expect("a state"), 3.0, &mut ())
        .expect("a run");
    let surface = corner::surface::wall[0];
    assert_eq!(run.outcome, Outcome::Contact { surface });
    assert_near("time", &[run.t], &[2.0], 1e-9);
}

#[test]
fn constraints_that_depend_on_others_somewhere_end_the_run_there() {
    let system = Degenerate::default();
    let effects = system.effects();
    let stepper = Dop853::new(Tolerance::new(1e-12).expect("a tolerance"));
    let state = system.state(0.0, &[0.0, 1.0, 0.0].into(), &[0.0, -1.0, 0.0].into());
    let run =
        Simulation::new(&system, stepper, effects).run(0.0, state.expect("a state"), 2.0, &mut ());
    let outcome = run.expect("a run").outcome;
    assert_eq!(outcome, Outcome::SingularSurface { surface: 0 });
    let state = system.state(0.0, &[0.0, 0.0, 0.0].into(), &[0.5, -1.0, 0.0].into());
    let contact = system.contact(0, 0.0, &state.expect("a state"));
    assert_eq!(contact.err(), Some(Fault::SingularSurface { surface: 0 }));
}

/// The force of the trace against differences of the constraints along the motion.
fn check_trace<S: Described + Impacting>(system: &S, forms: impl Fn(&[f64]) -> [[f64; 4]; 2]) {
    for state in states(system, 6, 9) {
        let mut rate = S::State::zeros(S::State::CAPACITY);
        system.rate(0.0, &state, &mut rate).expect("a rate");
        let mut motion = S::Impulse::zeros(S::Impulse::CAPACITY);
        let parts = &rate.as_slice()[S::Vector::CAPACITY..];
        motion.as_mut_slice().copy_from_slice(parts);
        let force = system
            .trace(0, 0.0, &state, &motion)
            .expect("no fault")
            .expect("a force");
        system.kick(&mut rate, 1.0, &force);
        let residuals = |step: f64| {
            let mut moved = state;
            for (own, rate) in moved.as_mut_slice().iter_mut().zip(rate.as_slice()) {
                *own += step * rate;
            }
            let (q, qdot) = (
                system.position(&moved),
                system.velocity(0.0, &moved).expect("one"),
            );
            forms(q.as_slice()).map(|form| dot(&form, qdot.as_slice()))
        };
        let (ahead, behind) = (residuals(1e-5), residuals(-1e-5));
        for (ahead, behind) in ahead.iter().zip(behind) {
            assert!((ahead - behind).abs() / 2e-5 < 1e-8, "{ahead} and {behind}");
        }
    }
}

#[test]
fn the_trace_keeps_the_instantaneous_constraints() {
    check_trace(&Tip::default(), rough_forms);
    check_trace(&Tip::default().global(), rough_forms);
}
