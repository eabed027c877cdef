//! Projection to constraints at states where all terms of a constraint vanish.

use std::ops::ControlFlow;

use dalembert::{
    Constrained, Dla2, Dla4, Dop853, DormandPrince5, Gauss4, Gauss6, Lagrangian, Law, Observer,
    Outcome, Rk4, Scene, SceneEffects, Segment, Simulation, StateVector, Taylor, TaylorField,
    Tolerance,
};
use dalembert_models::holonomic_bead_on_ellipses::HolonomicBeadOnEllipses;
use dalembert_tests::sampling::Random;

dalembert::model! {
    /// A pendulum that hits a wall at its lowest point, where `x dot(x) + y dot(y)` has vanishing terms alone.
    pub HangingPendulum {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        constraints { rod: x^2 + y^2 = 1; }
        impacts { wall: x >= 0; }
    }
}

/// The largest residual, in parts of the largest speed before, and how far levels were left.
struct Kept<'a, M: Constrained> {
    model: &'a M,
    levels: Option<M::Levels>,
    speed: f64,
    residual: f64,
    excess: f64,
}

impl<M: Constrained> Observer<M> for Kept<'_, M> {
    fn step(&mut self, segment: &mut Segment<'_, M::State>) -> ControlFlow<()> {
        let (t, model) = (segment.t_end(), self.model);
        let (q, v) = (
            model.position(segment.end()),
            model.velocity(t, segment.end()).expect("a velocity"),
        );
        let square: f64 = v.as_slice().iter().map(|v| v * v).sum();
        self.speed = self.speed.max(square.sqrt());
        let (residuals, _) = model.residuals(t, &q, &v);
        for residual in residuals.as_slice() {
            self.residual = self.residual.max(residual.abs() / self.speed);
        }
        let levels = model.levels(t, &q);
        let first = *self.levels.get_or_insert(levels);
        for (level, first) in levels.as_slice().iter().zip(first.as_slice()) {
            self.excess = self.excess.max((level - first).abs());
        }
        ControlFlow::Continue(())
    }
}

/// Runs to 20 with every integrator and checks that the constraints are kept.
fn check<M>(model: &M, law: Option<Law>, q: [f64; 2], qdot: [f64; 2])
where
    M: Scene + Constrained + Lagrangian + TaylorField,
{
    let vector = |values: [f64; 2]| M::Vector::of(&values);
    let tolerance = Tolerance::new(1e-9).expect("a tolerance");
    macro_rules! runs {
        ($($stepper:ident)*) => {$({
            let mut effects = model.effects();
            if let Some(law) = law {
                effects.set_law(0, law);
            }
            let state = model.state_unchecked(0.0, &vector(q), &vector(qdot)).expect("a state");
            let mut kept = Kept { model, levels: None, speed: 0.0, residual: 0.0, excess: 0.0 };
            let run = Simulation::new(model, $stepper::new(tolerance), effects)
                .run(0.0, state, 20.0, &mut kept)
                .expect("a start");
            let case = format!("{} {law:?} {q:?} {qdot:?}", stringify!($stepper));
            match law {
                // NOTE: the wall is met at x = 0, where its gap has no size but that of the rounding errors of x, and nothing
                // presses or pulls: rounding decides whether it rests there.
                Some(Law::ImpactPlastic) => assert!(
                    matches!(
                        run.outcome,
                        Outcome::Done
                            | Outcome::StartsInside { .. }
                            | Outcome::BeginsBehind { .. }
                            | Outcome::Contact { .. }
                    ),
                    "{case}: {:?} at {}", run.outcome, run.t
                ),
                _ => assert_eq!(run.outcome, Outcome::Done, "{case}: {}", run.t),
            }
            assert!(kept.residual < 1e-11, "{case}: {:e}", kept.residual);
            assert!(kept.excess < 1e-11, "{case}: {:e}", kept.excess);
        })*};
    }
    runs!(Dop853 DormandPrince5 Taylor Gauss4 Gauss6 Rk4 Dla2 Dla4);
}

#[test]
fn a_bead_on_an_ellipse_meets_the_wall_where_every_term_vanishes() {
    let bead = HolonomicBeadOnEllipses::default();
    check(&bead, None, [0.0, 1.0], [1.0, 0.0]);
    let mut random = Random::new(1);
    for _ in 0..40 {
        let (angle, size) = (random.within(0.0, 3.1), random.within(0.3, 2.3));
        let speed = random.within(0.5, 1.5);
        let (sin, cos) = angle.sin_cos();
        let q = [bead.A * size * cos, bead.B * size * sin];
        let qdot = [-speed * bead.A * size * sin, speed * bead.B * size * cos];
        check(&bead, None, q, qdot);
    }
}

#[test]
fn a_pendulum_meets_a_wall_at_its_lowest_point() {
    let mut random = Random::new(2);
    for _ in 0..40 {
        let (angle, rate) = (random.within(0.0, 1.4), random.within(0.0, 1.0));
        let (sin, cos) = angle.sin_cos();
        for law in [Law::Elastic, Law::Restitution(0.5)] {
            check(
                &HangingPendulum {},
                Some(law),
                [sin, -cos],
                [rate * cos, rate * sin],
            );
        }
    }
}

#[test]
fn a_pendulum_that_comes_to_rest_keeps_its_rod() {
    // Nothing is left of its velocity but rounding.
    check(
        &HangingPendulum {},
        Some(Law::ImpactPlastic),
        [0.6, -0.8],
        [0.0, 0.0],
    );
}
