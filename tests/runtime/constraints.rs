//! Projection onto constraints, and initial velocities that the constraints complete.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use dalembert::{
    Constrained, Counters, DormandPrince5, Effect, Fault, Outcome, ParameterError, Projection,
    SceneEffects, Simulation, StateError, System, Tolerance, VectorField, complete_velocities,
    effects::Moment,
};
use nalgebra::SVector;

type One = SVector<f64, 1>;
type Vector = SVector<f64, 2>;
type State = SVector<f64, 4>;

/// A point of mass 1 on a circle, with the constraint `x dx + y dy = 0`.
struct Circle {
    /// Fraction of the radial velocity that `restore` leaves.
    left: f64,
}

const CIRCLE: Circle = Circle { left: 0.0 };

impl VectorField for Circle {
    type State = State;

    fn rate(&self, _: f64, s: &State, rate: &mut State) -> Result<(), Fault> {
        let pull = (s[2] * s[2] + s[3] * s[3]) / (s[0] * s[0] + s[1] * s[1]);
        *rate = State::new(s[2], s[3], -pull * s[0], -pull * s[1]);
        Ok(())
    }
}

impl System for Circle {
    type Vector = Vector;
    type Impulse = Vector;

    fn position(&self, s: &State) -> Vector {
        Vector::new(s[0], s[1])
    }

    fn velocity(&self, _: f64, s: &State) -> Result<Vector, Fault> {
        Ok(Vector::new(s[2], s[3]))
    }

    fn momentum(&self, t: f64, s: &State) -> Result<Vector, Fault> {
        self.velocity(t, s)
    }

    fn state_unchecked(&self, _: f64, q: &Vector, qdot: &Vector) -> Result<State, Fault> {
        Ok(State::new(q[0], q[1], qdot[0], qdot[1]))
    }

    fn state_from_momenta(&self, t: f64, q: &Vector, p: &Vector) -> Result<State, Fault> {
        self.state_unchecked(t, q, p)
    }

    fn energy(&self, _: f64, s: &State) -> Result<f64, Fault> {
        Ok(0.5 * (s[2] * s[2] + s[3] * s[3]))
    }

    fn kick(&self, s: &mut State, size: f64, direction: &Vector) {
        s[2] += size * direction[0];
        s[3] += size * direction[1];
    }

    fn check_parameters(&self) -> Result<(), ParameterError> {
        Ok(())
    }

    fn state_nearest(&self, _: f64, q: &Vector, qdot: &Vector) -> Result<State, Fault> {
        let velocity = qdot - q.dot(qdot) / q.dot(q) * q;
        Ok(State::new(q[0], q[1], velocity[0], velocity[1]))
    }
}

impl Constrained for Circle {
    type Multipliers = One;
    type Levels = One;
    fn is_reduced(&self) -> bool {
        false
    }

    fn multipliers(&self, _: f64, _: &State) -> Result<One, Fault> {
        Ok(One::new(0.0))
    }

    fn residuals(&self, _: f64, q: &Vector, qdot: &Vector) -> (One, One) {
        let terms = [q[0] * qdot[0], q[1] * qdot[1]];
        (
            One::new(terms[0] + terms[1]),
            One::new(terms[0].abs() + terms[1].abs()),
        )
    }

    fn restore(&self, t: f64, s: &mut State) -> Result<(), Fault> {
        let near = self.state_nearest(t, &self.position(s), &self.velocity(t, s)?)?;
        *s = near + self.left * (*s - near);
        Ok(())
    }

    fn constraint_forms(&self, _: f64, q: &Vector, forms: &mut [f64], affine: &mut One) {
        forms.copy_from_slice(q.as_slice());
        affine[0] = 0.0;
    }

    fn levels(&self, _: f64, q: &Vector) -> One {
        One::new(0.5 * (q[0] * q[0] + q[1] * q[1]))
    }

    fn level_correction(&self, _: f64, q: &Vector, excess: &One) -> Result<Vector, Fault> {
        Ok(-excess[0] / (q[0] * q[0] + q[1] * q[1]) * q)
    }
}

/// Error of the radius and residual after a long run, and the number of projections.
fn drift(effects: impl Effect<Circle>) -> (f64, f64, u64) {
    let stepper = DormandPrince5::new(Tolerance::new(1e-6).unwrap());
    let state = State::new(2.0, 0.0, 0.0, 1.0);
    let run = Simulation::new(&CIRCLE, stepper, effects)
        .run(0.0, state, 1e3, &mut ())
        .unwrap();
    assert_eq!(run.outcome, Outcome::Done);
    let s = run.state;
    (
        (s[0] * s[0] + s[1] * s[1]).sqrt() - 2.0,
        s[0] * s[2] + s[1] * s[3],
        run.counters.projections,
    )
}

#[test]
fn projection_keeps_levels_and_velocities() {
    let (radius, residual, projections) = drift((Projection::<Circle>::new(),));
    assert!(
        radius.abs() < 1e-12 && residual.abs() < 1e-12,
        "{radius:e} {residual:e}"
    );
    assert!(projections > 100);
    let (radius, _, projections) = drift(());
    assert!(radius.abs() > 1e-9 && projections == 0, "{radius:e}");
}

#[test]
fn projection_can_be_switched_off() {
    let mut effects = (Projection::<Circle>::new(), ());
    SceneEffects::<Circle>::set_projection(&mut effects, false);
    assert_eq!(drift(effects), drift(()));
}

#[test]
fn open_velocities_are_completed_and_contradictions_refused() {
    let q = Vector::new(2.0, 1.0);
    let complete = |qdot: [f64; 2], named: [f64; 2]| {
        complete_velocities(&CIRCLE, 0.0, &q, &Vector::from(qdot), &Vector::from(named))
    };
    let completed = complete([0.0, 4.0], [0.0, 1.0]).unwrap();
    assert!((completed - Vector::new(-2.0, 4.0)).amax() < 1e-15);
    assert_eq!(complete([7.0, 7.0], [0.0, 0.0]), Ok(Vector::zeros()));
    assert!(matches!(
        complete([1.0, 1.0], [1.0, 1.0]),
        Err(StateError::OffConstraint { constraint: 0, .. })
    ));
    assert_eq!(
        complete([0.0, f64::NAN], [0.0, 1.0]),
        Err(StateError::NotFinite { component: 3 })
    );
    assert_eq!(complete([f64::NAN, 4.0], [0.0, 1.0]), Ok(completed));
}

/// State after the projection at the end of a step that was cut.
fn settled(left: f64, mut state: State) -> Result<State, Outcome> {
    let mut counters = Counters::default();
    let mut now = Moment {
        system: &Circle { left },
        t: 0.0,
        state: &mut state,
        counters: &mut counters,
    };
    let mut projection = Projection::<Circle>::new();
    projection.begin(&mut now, &mut ())?;
    projection.settle(&mut now, true)?;
    Ok(state)
}

#[test]
fn a_residual_of_vanishing_terms_is_no_failure() {
    // At the lowest point the residual consists only of `y ydot`, and `restore` leaves its rounding error.
    let rounding = f64::EPSILON;
    for velocity in [[-1.0, 1e-11], [1e-9, 1e-5], [0.0, 1e-30], [0.0, 1e-300]] {
        let state = State::new(0.0, -1.0, velocity[0], velocity[1]);
        let after = settled(rounding, state).unwrap();
        assert!(
            after[2] == velocity[0] && after[3].abs() <= 1e-30 * velocity[1],
            "{after:?}"
        );
    }
}

#[test]
fn a_projection_that_does_not_reach_the_constraint_fails() {
    for (left, velocity) in [
        (1.0, [-1.0, 1e-3]),
        (0.01, [1.0, 1e-3]),
        (1.0, [0.0, 1e-30]),
    ] {
        let state = State::new(0.0, -1.0, velocity[0], velocity[1]);
        assert_eq!(
            settled(left, state),
            Err(Outcome::ProjectionFailed { constraint: 0 })
        );
    }
}
