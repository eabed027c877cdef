//! Motion along a wall on which instantaneous constraints keep holding.

use core::ops::ControlFlow;

use dalembert::impacts::Impacts;
use dalembert::law::Law;
use dalembert::{Fault, Hold, Impacting, Instance, Observer, Outcome, System, VectorField};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, state, vector};
use dalembert_stability::text::{Model, value};
use dalembert_tests::numeric::assert_near;
use dalembert_tests::sampling::states;

use super::{CORNER, DEGENERATE, INCLINE, State, TIP, dot, rough_forms, struck};

/// The forces of the surfaces that hold the motion.
fn forces(impacts: &Option<Impacts<Model>>, system: &Model, (t, state): (f64, &State)) -> Vec<f64> {
    let forces = impacts
        .as_ref()
        .expect("impacts")
        .contact_forces(system, t, state);
    let forces = forces.expect("forces").expect("second rates");
    forces.as_ref().to_vec()
}

/// Outcome, force of the floor and state at the end of a run of the disk, dropped at rest from a height of 0.1.
fn rolled(disk: &Model, law: Law) -> (Outcome, f64, State) {
    let start = state(disk, &[0.0, value(disk, "r") + 0.1, 0.0], &[0.0; 3]);
    let (run, effects) = Course::from_state(disk, start, 2.0)
        .tol(1e-13)
        .law(0, law)
        .resting()
        .with_effects(Integrator::Dop853, &mut ());
    let force = forces(&effects.1, disk, (run.t, &run.state))[0];
    (run.outcome, force, run.state)
}

#[test]
fn a_disk_rolls_down_an_incline_where_it_did_not_slip_in_its_impact() {
    for belt in [0.0, 0.3] {
        let disk = INCLINE.with([("belt", belt)]);
        let of = |name| value(&disk, name);
        let [m, r, inertia, g] = ["m", "r", "I", "g"].map(of);
        let (sin, cos) = of("alpha").sin_cos();
        let fall = (0.2 / (g * cos)).sqrt();
        // The tangential impulse that stops the slip of the contact point.
        let speed = g * sin * fall;
        let inverse = 1.0 / m + r * r / inertia;
        let impulse = (belt - speed) / inverse;
        let along = speed + impulse / m;
        let rate = g * sin / (1.0 + inertia / (m * r * r));
        let rest = 2.0 - fall;
        let x = speed * fall / 2.0 + along * rest + rate * rest * rest / 2.0;
        let speed = along + rate * rest;
        let (outcome, force, state) = rolled(&disk, Law::ImpactPlastic);
        assert_eq!(outcome, Outcome::Done);
        let state = state.as_ref();
        assert_near("x, y", &state[..2], &[x, r], 1e-11);
        assert_near("speed", &[state[3] / m], &[speed], 1e-11);
        let spin = state[5] / inertia;
        assert_near("rolling", &[r * spin], &[speed - belt], 1e-11);
        assert_near("force", &[force], &[m * g * cos], 1e-11);
    }
}

#[test]
fn a_disk_that_bounces_rolls_from_its_first_impact_on() {
    let disk = INCLINE.model();
    let [m, r, inertia] = ["m", "r", "I"].map(|name| value(&disk, name));
    let (outcome, _, state) = rolled(&disk, Law::Newton(0.5));
    assert_eq!(outcome, Outcome::Done);
    let state = state.as_ref();
    let (speed, spin) = (state[3] / m, state[5] / inertia);
    assert_near("rolling", &[r * spin], &[speed], 1e-10);
    assert_near("height", &[state[1]], &[r], 1e-12);
}

#[test]
fn a_scene_takes_the_instantaneous_constraints_of_its_surfaces() {
    let disk = INCLINE.scene("dropped");
    let state = state(&disk, &[0.0, 0.5, 0.0], &[1.0, -1.0, 0.0]);
    let after = struck(&disk, Law::ImpactPlastic, state);
    let qdot = disk.velocity(0.0, &after).expect("a velocity");
    assert_near("focused", qdot.as_ref(), &[0.8, 0.0, 1.6], 1e-15);
}

/// Records the surfaces that begin to hold.
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
    let corner = CORNER.model();
    let [first, second, floor] = [0, 1, 2];
    let start = state(&corner, &[2.0, 0.0, 1.0, -1.0], &[0.0; 4]);
    let mut began = Began(Vec::new());
    let (run, effects) = Course::from_state(&corner, start, 1.0)
        .resting()
        .with_effects(Integrator::Dop853, &mut began);
    assert_eq!(run.outcome, Outcome::Done);
    began.0.sort_unstable();
    assert_eq!(began.0, [second, floor]);
    let held = &run.state.as_ref()[..4];
    assert_near("held", held, &[1.5, 0.0, 1.0, -1.0], 1e-12);
    // The force `lambda` of the floor and the multiplier `nu` of the second slip constraint satisfy
    // -1 - 2 nu + lambda = 0 and nu + lambda = 0.
    let forces = forces(&effects.1, &corner, (run.t, &run.state));
    assert_near("forces", &forces, &[0.0, 1.0, 1.0 / 3.0], 1e-12);
    // A second run uses the effects of the first.
    let again = Course::from_state(&corner, start, 3.0).effects(effects);
    let (end, _) = again.with_effects(Integrator::Dop853, &mut ());
    assert_eq!(end.outcome, Outcome::Contact { surface: first });
    assert_near("time", &[end.t], &[2.0], 1e-9);
}

#[test]
fn constraints_that_depend_on_others_somewhere_end_the_run_there() {
    let system = DEGENERATE.model();
    let start = state(&system, &[0.0, 1.0, 0.0], &[0.0, -1.0, 0.0]);
    let run = Course::from_state(&system, start, 2.0).observed(Integrator::Dop853, &mut ());
    assert_eq!(run.outcome, Outcome::SingularSurface { surface: 0 });
    let state = state(&system, &[0.0, 0.0, 0.0], &[0.5, -1.0, 0.0]);
    let contact = system.contact(0, 0.0, &state);
    assert_eq!(contact.err(), Some(Fault::SingularSurface { surface: 0 }));
}

/// Checks by differences that motion with the force of `trace` keeps the instantaneous constraints.
fn check_trace(system: &Model) {
    for state in states(system, 6, 9) {
        let mut rate = system.zero_state();
        system.rate(0.0, &state, &mut rate).expect("a rate");
        let motion = vector(&rate.as_ref()[system.coordinate_count()..]);
        let force = system
            .trace(0, 0.0, &state, &motion)
            .expect("no fault")
            .expect("a force");
        system.kick(&mut rate, 1.0, &force);
        let residuals = |step: f64| {
            let mut moved = state;
            for (component, rate) in moved.as_mut().iter_mut().zip(rate.as_ref()) {
                *component += step * rate;
            }
            let (q, qdot) = (
                system.position(&moved),
                system.velocity(0.0, &moved).expect("one"),
            );
            rough_forms(q.as_ref()).map(|form| dot(&form, qdot.as_ref()))
        };
        let (ahead, behind) = (residuals(1e-5), residuals(-1e-5));
        for (ahead, behind) in ahead.iter().zip(behind) {
            assert!((ahead - behind).abs() / 2e-5 < 1e-8, "{ahead} and {behind}");
        }
    }
}

#[test]
fn the_trace_keeps_the_instantaneous_constraints() {
    check_trace(&TIP.model());
    check_trace(&TIP.model().global().expect("the global form"));
}
