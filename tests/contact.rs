//! Motion along surfaces after impacts: held at `h = 0`, left where the surface would have to pull.

use core::ops::ControlFlow;

use dalembert::impacts::Impacts;
use dalembert::{
    Corner, Dop853, Event, Fault, Gauss6, Hold, Instance, Observer, Outcome, Penetration, Policies,
    Rest, Rk4, Run, Scene, SceneEffects, Simulation, Stepper, System, Taylor, Tolerance,
};
use dalembert_tests::numeric::assert_near;

dalembert::model! {
    /// A point in a vertical loop.
    pub Looping {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts { wall: 1 - x^2 - y^2 >= 0 => impact_plastic; }
    }
}

dalembert::model! {
    /// A point in a trough with sides of different slopes.
    pub Trough {
        coordinates { x; y; }
        parameters { m > 0 = 2; left > 0 = 0.75; right > 0 = 2; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) - m*y;
        impacts {
            left_side: y + left*x >= 0;
            right_side: y - right*x >= 0;
        }
    }
}

dalembert::model! {
    /// A knife edge that is driven against a wall.
    pub Skate {
        coordinates { x; y; theta: angle; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(theta)^2/4)/2 - x/2;
        constraints { blade: sin(theta)*d(x) - cos(theta)*d(y) = 0; }
        impacts { wall: x + y^2/8 + sin(theta)/4 >= 0 => impact_plastic; }
    }
}

dalembert::model! {
    /// A point that meets two walls at an angle of 100 degrees at once.
    pub Wedge {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { floor: y >= 0; slope: x*sin(5*pi/9) - y*cos(5*pi/9) >= 0; }
    }
}

const CONTACT: Policies = Policies {
    rest: Rest::Contact,
    penetration: Penetration::Stop,
    corner: Corner::Stop,
    split: dalembert::policy::Split::First,
};

/// Keeps where surfaces begin and cease to hold the motion.
struct Holds<S>(Vec<Hold<S>>);

impl<M: System> Observer<M> for Holds<M::State> {
    fn hold(&mut self, hold: &Hold<M::State>) -> ControlFlow<()> {
        self.0.push(*hold);
        ControlFlow::Continue(())
    }
}

type Ran<S> = (Run<S>, Vec<Hold<S>>);

fn ran<M: Scene>(
    model: &M,
    stepper: impl Stepper<M>,
    policies: Policies,
    state: M::State,
    until: f64,
) -> Ran<M::State> {
    let mut effects = model.effects();
    effects.set_policies(policies);
    let mut holds = Holds(Vec::new());
    let run = Simulation::new(model, stepper, effects)
        .run(0.0, state, until, &mut holds)
        .expect("a start");
    (run, holds.0)
}

fn tolerance() -> Tolerance {
    Tolerance::new(1e-13).expect("a tolerance")
}

#[test]
fn a_point_held_in_a_bowl_is_a_pendulum() -> Result<(), Fault> {
    // Period of the pendulum of length 1 and amplitude 1: 4 K(sin(1/2)), by the mean of Gauss.
    let (mut a, mut b) = (1.0_f64, 0.5_f64.cos());
    for _ in 0..6 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    let period = 2.0 * core::f64::consts::PI / a;
    let start = [1.0_f64.sin(), -(1.0_f64.cos())];
    let state = Looping {}.state_unchecked(0.0, &start.into(), &[0.0, 0.0].into())?;
    macro_rules! check {
        ($($stepper:expr)*) => {$(
            let (run, holds) = ran(&Looping {}, $stepper, CONTACT, state, 3.0 * period);
            assert_eq!(run.outcome, Outcome::Done);
            assert_eq!(holds.len(), 1);
            let q = Looping {}.position(&run.state);
            assert_near("after three periods", q.as_slice(), &start, 1e-10);
            assert_near("energy", &[Looping {}.energy(run.t, &run.state)?], &[start[1]], 1e-12);
        )*};
    }
    check!(Dop853::new(tolerance()) Taylor::new(tolerance()) Rk4::new(tolerance()) Gauss6::new(tolerance()));
    Ok(())
}

#[test]
fn a_point_leaves_the_loop_where_it_stops_pressing() -> Result<(), Fault> {
    // From the bottom with v^2 = 3.5 it presses until v^2 = y, at the height y = (3.5 - 2)/3.
    let speed = 3.5_f64.sqrt();
    let state = Looping {}.state_unchecked(0.0, &[0.0, -1.0].into(), &[speed, 0.0].into())?;
    let (run, holds) = ran(&Looping {}, Dop853::new(tolerance()), CONTACT, state, 20.0);
    assert_eq!(run.outcome, Outcome::Done);
    let places: Vec<(bool, f64)> = holds
        .iter()
        .map(|hold| (hold.begins, Looping {}.position(&hold.state)[1]))
        .collect();
    assert!(places[0].0 && !places[1].0 && places[2].0, "{places:?}");
    assert_near("height", &[places[1].1], &[0.5], 1e-11);
    // It falls on the other side, loses the speed towards the wall, and never leaves it again.
    assert_eq!(places.len(), 3, "{places:?}");
    let q = Looping {}.position(&run.state);
    assert_near("on the wall", &[q[0].hypot(q[1])], &[1.0], 1e-12);
    Ok(())
}

#[test]
fn a_point_comes_to_rest_between_two_surfaces_that_carry_its_weight() -> Result<(), Fault> {
    let trough = Trough::default();
    let state = trough.state_unchecked(0.0, &[0.1, 1.0].into(), &[0.3, 0.0].into())?;
    let mut effects = trough.effects();
    effects.set_policies(CONTACT);
    for surface in 0..2 {
        effects.set_law(surface, dalembert::Law::ImpactPlastic);
    }
    let mut simulation = Simulation::new(&trough, Dop853::new(tolerance()), effects);
    let mut holds = Holds(Vec::new());
    let run = simulation
        .run(0.0, state, 100.0, &mut holds)
        .expect("a start");
    assert_eq!(run.outcome, Outcome::Done, "{:?}", holds.0);
    assert_near(
        "corner",
        trough.position(&run.state).as_slice(),
        &[0.0, 0.0],
        1e-14,
    );
    let impacts: &Impacts<Trough> = &simulation.effects().0;
    let forces = impacts
        .contact_forces(&trough, run.t, &run.state)?
        .expect("second rates");
    let (a, b) = (forces[0], forces[1]);
    assert_near(
        "forces",
        &[a * trough.left - b * trough.right, a + b],
        &[0.0, trough.m],
        1e-13,
    );
    Ok(())
}

#[test]
fn both_forms_slide_along_a_wall_alike() -> Result<(), Fault> {
    let (q, qdot) = ([0.3, 0.2, 0.4], [0.0, 0.0, 0.8]);
    let ends = |until: f64| -> Result<[Vec<f64>; 2], Fault> {
        let state = Skate {}.state_unchecked(0.0, &q.into(), &qdot.into())?;
        let (reduced, holds) = ran(&Skate {}, Dop853::new(tolerance()), CONTACT, state, until);
        assert_eq!(reduced.outcome, Outcome::Done);
        assert!(!holds.is_empty(), "it is held");
        let global = Skate {}.global();
        let state = global.state_unchecked(0.0, &q.into(), &qdot.into())?;
        let (run, others) = ran(&global, Dop853::new(tolerance()), CONTACT, state, until);
        assert_eq!(run.outcome, Outcome::Done);
        assert_eq!(holds.len(), others.len());
        for (one, other) in holds.iter().zip(&others) {
            assert_eq!(one.begins, other.begins);
            assert_near("time", &[one.t], &[other.t], 1e-8);
        }
        Ok([
            Skate {}.position(&reduced.state).as_slice().to_vec(),
            global.position(&run.state).as_slice().to_vec(),
        ])
    };
    for until in [4.0, 4.5, 5.0] {
        let [reduced, global] = ends(until)?;
        assert_near("positions", &reduced, &global, 1e-9);
    }
    Ok(())
}

#[test]
fn repeated_laws_end_as_plastic_impacts() -> Result<(), Fault> {
    let repeat = Policies {
        penetration: Penetration::Repeat,
        ..CONTACT
    };
    let state = Skate {}.state_unchecked(0.0, &[0.3, 0.2, 0.4].into(), &[-1.0, 0.0, 0.8].into())?;
    let mut after = Vec::new();
    for law in [
        dalembert::Law::TotallyPlastic,
        dalembert::Law::ImpactPlastic,
    ] {
        let mut effects = (Skate {}).effects();
        effects.set_policies(repeat);
        effects.set_law(0, law);
        effects.set_impact_budget(Some(1));
        let mut log = dalembert::EventLog::<_, 4>::new();
        let run = Simulation::new(&Skate {}, Dop853::new(tolerance()), effects)
            .run(0.0, state, 10.0, &mut log)
            .expect("a start");
        assert_eq!(run.outcome, Outcome::ImpactBudget);
        let event: &Event<_> = log.iter().next().expect("an impact");
        after.push(
            Skate {}
                .velocity(event.t, &event.after)?
                .as_slice()
                .to_vec(),
        );
    }
    assert_near("velocity", &after[0], &after[1], 1e-12);
    Ok(())
}

#[test]
fn the_order_at_a_corner_is_asked_for_where_it_matters() -> Result<(), Fault> {
    let (sin, cos) = (0.3 * 5.0 * core::f64::consts::PI / 9.0).sin_cos();
    let state = Wedge {}.state_unchecked(0.0, &[cos, sin].into(), &[-cos, -sin].into())?;
    let end = |corner| {
        let policies = Policies { corner, ..CONTACT };
        ran(&Wedge {}, Dop853::new(tolerance()), policies, state, 2.0).0
    };
    let stopped = end(Corner::Stop);
    assert_eq!(stopped.outcome, Outcome::Ambiguous { surfaces: [0, 1] });
    assert_near("time", &[stopped.t], &[1.0], 1e-14);
    // By mirroring at the two walls in order, by hand.
    let mirrored = |[vx, vy]: [f64; 2], [nx, ny]: [f64; 2]| {
        let normal = 2.0 * (vx * nx + vy * ny);
        [vx - normal * nx, vy - normal * ny]
    };
    let (floor, slope) = ([0.0, 1.0], {
        let (sin, cos) = (5.0 * core::f64::consts::PI / 9.0).sin_cos();
        [sin, -cos]
    });
    let walls = |mut velocity: [f64; 2], order: [[f64; 2]; 2]| {
        for wall in order.iter().cycle().take(4) {
            if velocity[0] * wall[0] + velocity[1] * wall[1] < 0.0 {
                velocity = mirrored(velocity, *wall);
            }
        }
        velocity
    };
    for (corner, order) in [
        (Corner::Ascending, [floor, slope]),
        (Corner::Descending, [slope, floor]),
    ] {
        let run = end(corner);
        assert_eq!(run.outcome, Outcome::Done);
        let velocity = Wedge {}.velocity(run.t, &run.state)?;
        assert_near(
            "velocity",
            velocity.as_slice(),
            &walls([-cos, -sin], order),
            1e-12,
        );
    }
    Ok(())
}
