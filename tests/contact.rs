//! Motion along surfaces after impacts. A surface keeps the motion at `h = 0` and releases it instead of pulling.

use core::ops::ControlFlow;

use dalembert::{
    Corner, EventLog, Fault, Hold, Instance, Law, Observer, Outcome, Penetration, Policies, Rest,
    Run, System, VectorField,
};
use dalembert_cli::Integrator;
use dalembert_cli::suite::Setting;
use dalembert_stability::course::{Course, vector};
use dalembert_stability::text::{Model, Text, value};
use dalembert_tests::numeric::assert_near;

/// A point in a vertical loop.
static LOOPING: Text = Text::new(
    "Looping {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts { wall: 1 - x^2 - y^2 >= 0 => impact_plastic; }
    }",
);

/// A point in a trough with sides of different slopes.
static TROUGH: Text = Text::new(
    "Trough {
        coordinates { x; y; }
        parameters { m > 0 = 2; left > 0 = 0.75; right > 0 = 2; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) - m*y;
        impacts {
            left_side: y + left*x >= 0;
            right_side: y - right*x >= 0;
        }
    }",
);

/// A knife edge that a force drives against a wall.
static SKATE: Text = Text::new(
    "Skate {
        coordinates { x; y; theta: angle; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(theta)^2/4)/2 - x/2;
        constraints { blade: sin(theta)*d(x) - cos(theta)*d(y) = 0; }
        impacts { wall: x + y^2/8 + sin(theta)/4 >= 0 => impact_plastic; }
    }",
);

/// Two walls at an angle of 100 degrees. A point meets them at the same time.
static WEDGE: Text = Text::new(
    "Wedge {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { floor: y >= 0; slope: x*sin(5*pi/9) - y*cos(5*pi/9) >= 0; }
    }",
);

const CONTACT: Policies = Policies {
    rest: Rest::Contact,
    penetration: Penetration::Stop,
    corner: Corner::Stop,
    split: dalembert::policy::Split::First,
};

/// Records the events at which surfaces begin or cease to hold the motion.
struct Holds<S>(Vec<Hold<S>>);

impl<M: System> Observer<M> for Holds<M::State> {
    fn hold(&mut self, hold: &Hold<M::State>) -> ControlFlow<()> {
        self.0.push(*hold);
        ControlFlow::Continue(())
    }
}

type State = <Model as VectorField>::State;

type Ran = (Run<State>, Vec<Hold<State>>);

/// A run from a state that is not checked.
fn course<'a>(model: &'a Model, q: &[f64], qdot: &[f64], until: f64) -> Course<'a, Model> {
    let state = model.state_unchecked(0.0, &vector(q), &vector(qdot));
    Course::from_state(model, state.expect("a state"), until).tol(1e-13)
}

fn ran(course: Course<'_, Model>, integrator: Integrator, policies: Policies) -> Ran {
    let mut holds = Holds(Vec::new());
    let run = course.policies(policies).observed(integrator, &mut holds);
    (run, holds.0)
}

#[test]
fn a_point_held_in_a_bowl_is_a_pendulum() -> Result<(), Fault> {
    // Period of the pendulum of length 1 and amplitude 1: four times the complete elliptic integral of modulus
    // sin(1/2), by the arithmetic-geometric mean.
    let (mut a, mut b) = (1.0_f64, 0.5_f64.cos());
    for _ in 0..6 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    let period = 2.0 * core::f64::consts::PI / a;
    let start = [1.0_f64.sin(), -(1.0_f64.cos())];
    let model = LOOPING.model();
    for &integrator in Integrator::every() {
        let course = course(&model, &start, &[0.0, 0.0], 3.0 * period);
        let (run, holds) = ran(course, integrator, CONTACT);
        let name = integrator.name();
        assert_eq!(run.outcome, Outcome::Done, "{name}");
        assert_eq!(holds.len(), 1, "{name}");
        let q = model.position(&run.state);
        assert_near(name, q.as_ref(), &start, 1e-10);
        let energy = model.energy(run.t, &run.state)?;
        assert_near(name, &[energy], &[start[1]], 1e-12);
    }
    Ok(())
}

#[test]
fn a_point_leaves_the_loop_where_it_stops_pressing() -> Result<(), Fault> {
    // The point starts at the bottom with v^2 = 3.5 and presses until v^2 = y, at the height y = (3.5 - 2)/3.
    let speed = 3.5_f64.sqrt();
    let model = LOOPING.model();
    let course = course(&model, &[0.0, -1.0], &[speed, 0.0], 20.0);
    let (run, holds) = ran(course, Integrator::Dop853, CONTACT);
    assert_eq!(run.outcome, Outcome::Done);
    let places: Vec<(bool, f64)> = holds
        .iter()
        .map(|hold| (hold.begins, model.position(&hold.state).as_ref()[1]))
        .collect();
    assert!(places[0].0 && !places[1].0 && places[2].0, "{places:?}");
    assert_near("height", &[places[1].1], &[0.5], 1e-11);
    // The point falls onto another part of the loop, loses its velocity towards it, and never leaves it again.
    assert_eq!(places.len(), 3, "{places:?}");
    let q = model.position(&run.state);
    let q = q.as_ref();
    assert_near("on the wall", &[q[0].hypot(q[1])], &[1.0], 1e-12);
    Ok(())
}

#[test]
fn a_point_comes_to_rest_between_two_surfaces_that_carry_its_weight() -> Result<(), Fault> {
    let trough = TROUGH.model();
    let mut holds = Holds(Vec::new());
    let mut course = course(&trough, &[0.1, 1.0], &[0.3, 0.0], 100.0).policies(CONTACT);
    for surface in 0..2 {
        course = course.law(surface, Law::ImpactPlastic);
    }
    let (run, effects) = course.with_effects(Integrator::Dop853, &mut holds);
    assert_eq!(run.outcome, Outcome::Done, "{:?}", holds.0);
    assert_near(
        "corner",
        trough.position(&run.state).as_ref(),
        &[0.0, 0.0],
        1e-14,
    );
    let forces = effects
        .1
        .expect("impacts")
        .contact_forces(&trough, run.t, &run.state)?
        .expect("second rates");
    let (a, b) = (forces.as_ref()[0], forces.as_ref()[1]);
    let [left, right, m] = ["left", "right", "m"].map(|name| value(&trough, name));
    assert_near("forces", &[a * left - b * right, a + b], &[0.0, m], 1e-13);
    Ok(())
}

#[test]
fn both_forms_slide_along_a_wall_alike() {
    let (q, qdot) = ([0.3, 0.2, 0.4], [0.0, 0.0, 0.8]);
    let ends = |until: f64| {
        let forms = [
            SKATE.model(),
            SKATE.model().global().expect("the global form"),
        ];
        let [(reduced, holds), (whole, others)] = forms
            .each_ref()
            .map(|form| ran(course(form, &q, &qdot, until), Integrator::Dop853, CONTACT));
        assert_eq!(reduced.outcome, Outcome::Done);
        assert!(!holds.is_empty(), "it is held");
        assert_eq!(whole.outcome, Outcome::Done);
        assert_eq!(holds.len(), others.len());
        for (one, other) in holds.iter().zip(&others) {
            assert_eq!(one.begins, other.begins);
            assert_near("time", &[one.t], &[other.t], 1e-8);
        }
        let [skate, global] = &forms;
        [
            skate.position(&reduced.state).as_ref().to_vec(),
            global.position(&whole.state).as_ref().to_vec(),
        ]
    };
    for until in [4.0, 4.5, 5.0] {
        let [reduced, global] = ends(until);
        assert_near("positions", &reduced, &global, 1e-9);
    }
}

#[test]
fn repeated_laws_end_as_plastic_impacts() -> Result<(), Fault> {
    let repeat = Policies {
        penetration: Penetration::Repeat,
        ..CONTACT
    };
    let skate = SKATE.model();
    let mut after = Vec::new();
    for law in [Law::TotallyPlastic, Law::ImpactPlastic] {
        let mut log = EventLog::<_, 4>::new();
        let run = course(&skate, &[0.3, 0.2, 0.4], &[-1.0, 0.0, 0.8], 10.0)
            .policies(repeat)
            .law(0, law)
            .impacts(1)
            .observed(Integrator::Dop853, &mut log);
        assert_eq!(run.outcome, Outcome::ImpactBudget);
        let event = log.iter().next().expect("an impact");
        after.push(skate.velocity(event.t, &event.after)?.as_ref().to_vec());
    }
    assert_near("velocity", &after[0], &after[1], 1e-12);
    Ok(())
}

#[test]
fn the_order_at_a_corner_is_asked_for_where_it_matters() -> Result<(), Fault> {
    let (sin, cos) = (0.3 * 5.0 * core::f64::consts::PI / 9.0).sin_cos();
    let wedge = WEDGE.model();
    let end = |corner| {
        let policies = Policies { corner, ..CONTACT };
        let course = course(&wedge, &[cos, sin], &[-cos, -sin], 2.0);
        ran(course, Integrator::Dop853, policies).0
    };
    let stopped = end(Corner::Stop);
    assert_eq!(stopped.outcome, Outcome::Ambiguous { surfaces: [0, 1] });
    assert_near("time", &[stopped.t], &[1.0], 1e-14);
    // Expected velocities are those of reflections at the two walls in turn.
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
        let velocity = wedge.velocity(run.t, &run.state)?;
        assert_near(
            "velocity",
            velocity.as_ref(),
            &walls([-cos, -sin], order),
            1e-12,
        );
    }
    Ok(())
}

/// A point that starts on top of a sphere with the speed `v`. It leaves the sphere at `cos(phi) = (2 + v^2)/3`.
static SPHERE: Text = Text::new(
    "Sphere {
        coordinates { r; phi; }
        lagrangian = (dot(r)^2 + r^2*dot(phi)^2)/2 - r*cos(phi);
        impacts { sphere: r >= 1; }
    }",
);

#[test]
fn a_surface_pressed_from_the_start_holds_the_motion_at_once_whatever_the_step() {
    let sphere = SPHERE.model();
    for &integrator in Integrator::every() {
        for step in [1e-1, 1e-2, 1e-3] {
            let course = Course::new(&sphere, &[1.0, 0.0], &[0.0, 0.5], 2.0);
            let mut holds = Holds(Vec::new());
            let run = course.step(step).resting().observed(integrator, &mut holds);
            let case = format!("{}, {step}: {:?}", integrator.name(), run.counters);
            assert_eq!(run.outcome, Outcome::Done, "{case}");
            assert_eq!(run.counters.impacts, 0, "{case}");
            let [begin, end] = &holds.0[..] else {
                panic!("{case}: {:?}", holds.0)
            };
            assert_eq!((begin.begins, begin.t), (true, 0.0), "{case}");
            let phi = end.state.as_ref()[1];
            assert!((phi.cos() - 0.75).abs() < 1e-3, "{case}: {phi}");
        }
    }
}

/// A weight on the ground, pulled up by a force that grows.
static WEIGHT: Text = Text::new(
    "Weight {
        coordinates { x; }
        parameters { k > 0 = 5; g > 0 = 9.81; }
        lagrangian = dot(x)^2/2 - g*x;
        forces { pull: k*t*d(x); }
        impacts { ground: x >= 0 => newton(0); }
    }",
);

/// Without the ground, the weight falls, turns at `t = 3.9` and returns at 5.9. A series reaches any of these times in one step,
/// so that rate or gap are positive at its end.
#[test]
fn a_motion_that_returns_within_the_step_is_held_from_the_start() {
    let weight = WEIGHT.model();
    let lift = 9.81 / 5.0;
    for &integrator in Integrator::every() {
        for until in [3.0, 4.0, 5.5, 6.5, 8.0] {
            let course = Course::new(&weight, &[0.0], &[0.0], until).tol(1e-12);
            let mut holds = Holds(Vec::new());
            let run = course.step(1e-2).resting().observed(integrator, &mut holds);
            let case = format!("{} until {until}: {:?}", integrator.name(), run.counters);
            assert_eq!(run.outcome, Outcome::Done, "{case}");
            let [begin, end] = &holds.0[..] else {
                panic!("{case}: {:?}", holds.0)
            };
            assert_eq!((begin.begins, begin.t), (true, 0.0), "{case}");
            assert!((end.t - lift).abs() < 1e-6, "{case}: {}", end.t);
            let right = 5.0 * (until - lift).powi(3) / 6.0;
            let x = run.state.as_ref()[0];
            assert!((x / right - 1.0).abs() < 1e-3, "{case}: {x}, not {right}");
        }
    }
}

/// A point without weight on the ground, pulled by a force that is a polynomial of time.
static PULLED: Text = Text::new(
    "Pulled {
        coordinates { x; }
        parameters { a = 0; b = 0; c = 0; }
        lagrangian = dot(x)^2/2;
        forces { pull: (a + b*t + c*t^2)*d(x); }
        impacts { ground: x >= 0 => newton(0); }
    }",
);

/// The force begins at 0 and pulls down. Without the ground, the point turns at `t = 3/2` and returns at 2.
#[test]
fn a_force_that_grows_from_nothing_holds_from_the_start() {
    let pulled = PULLED.with([("b", -1.0), ("c", 1.0)]);
    for &integrator in Integrator::every() {
        for until in [1.2, 1.7, 2.5, 5.0] {
            let course = Course::new(&pulled, &[0.0], &[0.0], until).tol(1e-12);
            let mut holds = Holds(Vec::new());
            let run = course.step(1e-2).resting().observed(integrator, &mut holds);
            let case = format!("{} until {until}: {:?}", integrator.name(), run.counters);
            assert_eq!(run.outcome, Outcome::Done, "{case}");
            let [begin, end] = &holds.0[..] else {
                panic!("{case}: {:?}", holds.0)
            };
            assert_eq!((begin.begins, begin.t), (true, 0.0), "{case}");
            assert!((end.t - 1.0).abs() < 1e-6, "{case}: {}", end.t);
            // The force is 0 at the release, and `tau + tau^2` after it.
            let tau: f64 = until - 1.0;
            let right = tau.powi(3) / 6.0 + tau.powi(4) / 12.0;
            let x = run.state.as_ref()[0];
            assert!((x / right - 1.0).abs() < 2e-3, "{case}: {x}, not {right}");
        }
    }
}

/// The force pulls up at first: the point leaves the ground, and comes back to it.
#[test]
fn a_motion_that_leaves_the_ground_at_rest_hits_it_when_it_returns() {
    for ([a, b, c], back) in [([1.0, -1.0, 0.0], 3.0), ([0.0, 1.0, -1.0], 2.0)] {
        let pulled = PULLED.with([("a", a), ("b", b), ("c", c)]);
        for &integrator in Integrator::every() {
            let course = Course::new(&pulled, &[0.0], &[0.0], back + 0.5).tol(1e-12);
            let mut holds = Holds(Vec::new());
            let run = course.step(1e-2).resting().observed(integrator, &mut holds);
            let case = format!("{}: {:?}", integrator.name(), run.counters);
            assert_eq!(run.outcome, Outcome::Done, "{case}");
            assert_eq!(run.counters.impacts, 1, "{case}");
            let [begin] = &holds.0[..] else {
                panic!("{case}: {:?}", holds.0)
            };
            assert!((begin.t - back).abs() < 1e-4, "{case}: {}", begin.t);
        }
    }
}

/// A point at the bottom of a round wall, which the force leaves free: `x = -t^3/12`, `y = t^4/48`. The gap rises like
/// `t^4/24`. One step of a power series ends far behind the wall.
static BOWL: Text = Text::new(
    "Bowl {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        forces { pull: -t/2*d(x) - dot(x)*d(y); }
        impacts { wall: 1 - x^2 - (y - 1)^2 >= 0 => impact_plastic; }
    }",
);

#[test]
fn a_motion_that_leaves_a_wall_like_a_power_of_time_is_not_held() {
    let bowl = BOWL.model();
    // t^4/24 = t^6/144 + t^8/2304
    let back = f64::sqrt((-16.0 + f64::sqrt(640.0)) / 2.0);
    for &integrator in Integrator::every() {
        for until in [1.0, 2.1, 3.0, 7.5] {
            let course = Course::new(&bowl, &[0.0; 2], &[0.0; 2], until).tol(1e-12);
            let mut holds = Holds(Vec::new());
            let run = course.step(1e-2).resting().observed(integrator, &mut holds);
            let case = format!("{} until {until}: {:?}", integrator.name(), run.counters);
            assert_eq!(run.outcome, Outcome::Done, "{case}");
            assert_eq!(run.counters.impacts, u64::from(until > back), "{case}");
            if let Some(first) = holds.0.first().filter(|first| first.begins) {
                assert!((first.t - back).abs() < 1e-4, "{case}: {}", first.t);
            }
        }
    }
}

/// The body rises from the bottom of a circle like the fifth power of time, and hits the circle at 0.36. At the end of a long step
/// it is pressed.
#[test]
fn a_long_step_from_rest_hides_no_impact() {
    let circle = Text::new(
        "Circle {
            coordinates { x; y; }
            lagrangian = (dot(x)^2 + dot(y)^2)/2;
            forces { pull: -8*t/5*d(x) + (x^2 - x)*d(y); }
            impacts { wall: 1 - x^2 - (y - 1)^2 >= 0 => newton(0.5); }
        }",
    );
    let model = circle.model();
    let mut first: Vec<f64> = Vec::new();
    for until in [1.0, 2.7, 7.5] {
        for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Dopri5] {
            let course = Course::new(&model, &[0.0; 2], &[0.0; 2], until).tol(1e-12);
            let end = course.resting().run(Setting::free(integrator));
            first.push(end.hits.first().map_or(until, |hit| hit.t));
        }
    }
    assert!(first[0] < 0.4, "{first:?}");
    let is_near = first.iter().all(|t| (t - first[0]).abs() < 1e-8);
    assert!(is_near, "{first:?}");
}

/// Two bodies that forces press to the ground, and a third one that touches them. All are at 0, so that their coordinates
/// show no size of rounding errors: those of the forces, which cancel, must not move them.
const STACK: &str = "
    Stack {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        forces { down: -t*d(x); FORCES }
        impacts { SURFACES }
    }";

#[test]
fn a_body_that_touches_a_pressed_stack_is_not_hit() {
    let surfaces = [
        "ground: x >= 0; below: y >= x; above: z >= y;",
        "above: z >= y; below: y >= x; ground: x >= 0;",
        "below: y >= x; above: z >= y; ground: x >= 0;",
    ];
    // The force on the third body is 0, or turns at t = 1.
    let forces = [
        ("press: -3*d(y);", 0.0),
        ("press: (2*t - 3)*d(y);", 0.0),
        ("press: (t - 1)*d(z);", f64::powi(0.3, 3) / 6.0),
    ];
    for surfaces in surfaces {
        for (forces, end) in forces {
            let text = STACK
                .replace("FORCES", forces)
                .replace("SURFACES", surfaces);
            let stack = Text::new(text.leak()).model();
            for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Gauss6] {
                let course = Course::new(&stack, &[0.0; 3], &[0.0; 3], 1.3).tol(1e-12);
                let run = course.step(1e-2).resting().run(Setting::free(integrator));
                let case = format!(
                    "{} {surfaces} {forces}: {:?}",
                    integrator.name(),
                    run.counters
                );
                assert_eq!(
                    (run.outcome, run.counters.impacts),
                    (Outcome::Done, 0),
                    "{case}"
                );
                // A body that is released keeps a rate of the rounding of the time.
                let [x, y, z] = run.q[..] else {
                    panic!("{case}")
                };
                assert!(x == 0.0 && y.abs() < 1e-10, "{case}: {:?}", run.q);
                assert!((z - end).abs() < 1e-8, "{case}: {:?}", run.q);
                assert!(run.counters.accepted < 500, "{case}");
            }
        }
    }
}

/// A body at rest on a wall that begins to move with an acceleration is held from the start, whatever the higher powers.
#[test]
fn a_wall_that_accelerates_holds_from_the_start() {
    for way in [
        "2*t^2",
        "2*t^2 - t^3",
        "2*t^2 + t^3",
        "3*t^2 - t^5",
        "t^2*(2 - t)",
        "1 - cos(2*t)",
    ] {
        for law in ["elastic", "newton(0)", "newton(1/2)"] {
            let text = format!(
                "Wall {{ coordinates {{ x; }} lagrangian = dot(x)^2/2; impacts {{ up: x - ({way}) >= 0 => {law}; }} }}"
            );
            let wall = Text::new(text.leak()).model();
            for &integrator in Integrator::every() {
                let course = Course::new(&wall, &[0.0], &[0.0], 0.5).tol(1e-12);
                let mut holds = Holds(Vec::new());
                let run = course.step(1e-2).resting().observed(integrator, &mut holds);
                let case = format!("{} {way} {law}: {:?}", integrator.name(), run.counters);
                assert_eq!(
                    (run.outcome, run.counters.impacts),
                    (Outcome::Done, 0),
                    "{case}"
                );
                assert_eq!((holds.0.len(), holds.0[0].t), (1, 0.0), "{case}");
            }
        }
    }
}

/// A body on a slab on a lift that begins to rise like `t^3`. The slab presses on the lift from the start, the lift on the slab
/// later in the first step. Both hold until `0.25 t^3 - 0.5 t^4` falls as fast as the body.
static LIFT: Text = Text::new(
    "Lift {
        coordinates { x; y; }
        lagrangian = dot(x)^2/2 + dot(y)^2;
        forces { weight: (-11.25 + 15.75*t - 7*t^2 + t^3)*d(y); }
        impacts { lift: x - 0.25*t^3 + 0.5*t^4 >= 0 => newton(0); slab: y - x >= 0 => newton(0); }
    }",
);

#[test]
fn a_pressure_that_begins_within_a_step_hides_no_other_surface() {
    let lift = LIFT.model();
    for &integrator in Integrator::every() {
        let course = Course::new(&lift, &[0.0; 2], &[0.0; 2], 0.6).tol(1e-12);
        let run = course.step(1e-3).resting().run(Setting::free(integrator));
        let case = format!("{}: {:?}", integrator.name(), run.counters);
        assert_eq!(
            (run.outcome, run.counters.impacts),
            (Outcome::Done, 0),
            "{case}"
        );
        let height = 0.25 * f64::powi(0.6, 3) - 0.5 * f64::powi(0.6, 4);
        assert!((run.q[0] - height).abs() < 1e-9, "{case}: {:?}", run.q);
        assert!((run.q[1] - height).abs() < 1e-9, "{case}: {:?}", run.q);
    }
}

/// A point leaves the ground slowly, and a force that grows brings it back. A long step ends far behind the ground, where
/// rounding errors are larger than the height of the throw.
#[test]
fn a_slow_throw_that_a_growing_force_ends_is_no_crossing() {
    let pulled = PULLED.with([("b", -1.0)]);
    for &integrator in Integrator::every() {
        for speed in [1e-9, 1e-7, 1e-5] {
            let course = Course::new(&pulled, &[0.0], &[speed], 1.0).tol(1e-12);
            let end = course.step(1e-2).resting().run(Setting::free(integrator));
            let case = format!("{}, {speed}: {:?}", integrator.name(), end.counters);
            assert_eq!(end.outcome, Outcome::Done, "{case}");
            assert_eq!(end.q, [0.0], "{case}");
        }
    }
}

/// The ground is a level of a function with a constant term. Near the start the gap is smaller than the rounding error of
/// that term.
static LEVEL: Text = Text::new(
    "Level {
        coordinates { x; }
        parameters { a = 0; k = 0; }
        lagrangian = dot(x)^2/2;
        forces { pull: (a - k*x)*d(x); }
        impacts { ground: sqrt(1 + x^2 + 2*x) - 1 >= 0 => newton(0); }
    }",
);

#[test]
fn a_motion_leaves_stays_or_is_held_although_rounding_hides_the_gap() {
    for (a, k, speed) in [
        (-9.81, 0.0, 0.0),
        (-9.81, 0.0, 1e-9),
        (1.5, 0.0, 0.0),
        (0.0, 1.0, 0.0),
    ] {
        let level = LEVEL.with([("a", a), ("k", k)]);
        for &integrator in Integrator::every() {
            let course = Course::new(&level, &[0.0], &[speed], 1.0).tol(1e-12);
            let end = course.step(1e-2).resting().run(Setting::free(integrator));
            let case = format!(
                "{}, {a}, {k}, {speed}: {:?}",
                integrator.name(),
                end.counters
            );
            assert_eq!(end.outcome, Outcome::Done, "{case}");
            let right = a.max(0.0) / 2.0;
            assert!((end.q[0] - right).abs() < 1e-9, "{case}: {:?}", end.q);
        }
    }
}

/// A point on top of a ball, in Cartesian coordinates.
static BALL: Text = Text::new(
    "Ball {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts { ball: x^2 + (y + 1)^2 - 1 >= 0; }
    }",
);

#[test]
fn a_point_on_top_of_a_ball_is_held_until_it_leaves_it() {
    let ball = BALL.model();
    for &integrator in Integrator::every() {
        for (speed, until) in [(0.0, 1.0), (0.5, 2.5)] {
            let course = Course::new(&ball, &[0.0, 0.0], &[speed, 0.0], until).tol(1e-12);
            let end = course.step(1e-2).resting().run(Setting::free(integrator));
            let case = format!("{}, {speed}: {:?}", integrator.name(), end.counters);
            assert_eq!(end.outcome, Outcome::Done, "{case}");
            assert_eq!(end.counters.impacts, 0, "{case}");
            assert_eq!((end.holds[0].begins, end.holds[0].t), (true, 0.0), "{case}");
            if speed == 0.0 {
                assert_eq!(end.holds.len(), 1, "{case}");
                assert_eq!(end.q, [0.0, 0.0], "{case}");
                continue;
            }
            // It leaves where cos(phi) = (2 + v^2)/3.
            let [x, y] = [end.holds[1].q[0], end.holds[1].q[1]];
            assert!((y + 1.0 - 0.75).abs() < 1e-6, "{case}: {x}, {y}");
        }
    }
}

/// A ball above a planet whose radius hides all but the first nine digits of a gap of one metre.
static PLANET: Text = Text::new(
    "Planet {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - 9.81*y;
        impacts { ground: sqrt(x^2 + (y + 6.4e6)^2) - 6.4e6 >= 0 => restitution(1/2); }
    }",
);

/// The rounding error of the gap comes from its constant term. Hops below it are impacts no longer.
#[test]
fn hops_on_a_planet_accumulate_where_rounding_hides_them() {
    let planet = PLANET.model();
    let right = 3.0 * (2.0 * 10.0_f64 / 9.81).sqrt();
    for &integrator in Integrator::every() {
        let course = Course::new(&planet, &[0.0, 10.0], &[0.0, 0.0], 10.0).tol(1e-12);
        let end = course.step(1e-2).run(Setting::free(integrator));
        let case = format!("{}: {:?}", integrator.name(), end.outcome);
        let Outcome::Zeno { t, surface: 0 } = end.outcome else {
            panic!("{case}")
        };
        // The last hops begin with about 1e-3, and the gap is known to 1e-9.
        assert!((t - right).abs() < 1e-6, "{case}, not {right}");
        let course = Course::new(&planet, &[0.0, 10.0], &[0.0, 0.0], 10.0).tol(1e-12);
        let end = course.step(1e-2).resting().run(Setting::free(integrator));
        assert_eq!((end.outcome, end.holds.len()), (Outcome::Done, 1), "{case}");
    }
}

/// A ledge that ends at `x = 1`, above a floor.
static LEDGE: Text = Text::new(
    "Ledge {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts {
            floor: y >= 0 => impact_plastic;
            ledge: y >= 1/2 when x < 1 => impact_plastic;
        }
    }",
);

/// A point slides over the ledge from the start, or after it fell on it from 9/16 at `t = 1/sqrt(8)`. It leaves the ledge
/// at its end and reaches the floor one second later.
#[test]
fn a_surface_holds_only_where_its_condition_holds() {
    let ledge = LEDGE.model();
    for &integrator in Integrator::every() {
        for height in [0.5, 0.5625] {
            let course = Course::new(&ledge, &[0.0, height], &[1.0, 0.0], 3.0).tol(1e-12);
            let end = course.step(1e-2).resting().run(Setting::free(integrator));
            let case = format!("{}, {height}: {:?}", integrator.name(), end.holds);
            assert_eq!(end.outcome, Outcome::Done, "{case}");
            let [hold, release, landing] = &end.holds[..] else {
                panic!("{case}")
            };
            assert_eq!(
                [hold, release, landing].map(|it| it.begins),
                [true, false, true]
            );
            assert_eq!([hold, release, landing].map(|it| it.surface), [1, 1, 0]);
            assert!((release.t - 1.0).abs() < 1e-9, "{case}");
            assert!((landing.t - 2.0).abs() < 1e-9, "{case}");
            assert!(
                (end.q[0] - 3.0).abs() < 1e-9 && end.q[1].abs() < 1e-9,
                "{case}: {:?}",
                end.q
            );
        }
    }
}

/// A ball with restitution 3/10, thrust along the floor.
static THRUST: Text = Text::new(
    "pub Thrust {
        coordinates { x; z; }
        lagrangian = (dot(x)^2 + dot(z)^2)/2 - z;
        forces { thrust: 0.7*d(x); }
        impacts { floor: z >= 0 => newton(0.3); }
    }",
);

/// The hops shrink and the energy grows, since the thrust does work. The ball comes to rest on the floor all the same.
#[test]
fn work_along_a_surface_does_not_make_hops_spasmodic() {
    let thrust = THRUST.model();
    let fall = 0.3 + (0.09_f64 + 1.0).sqrt();
    let right = fall + 2.0 * (fall - 0.3) * 0.3 / 0.7;
    for &integrator in Integrator::every() {
        let course = Course::new(&thrust, &[1.0, 0.5], &[0.4, 0.3], 10.0).tol(1e-11);
        let end = course.step(1e-3).resting().run(Setting::free(integrator));
        let case = format!("{}: {:?}", integrator.name(), end.outcome);
        assert_eq!((end.outcome, end.holds.len()), (Outcome::Done, 1), "{case}");
        assert!((end.holds[0].t - right).abs() < 1e-6, "{case}, not {right}");
        assert!((end.q[0] - 40.0).abs() < 1e-8, "{case}: {:?}", end.q);
    }
}

/// A road that holds the point, and a wall across it.
static BLOCKED: Text = Text::new(
    "pub Blocked {
        coordinates { x; z; }
        lagrangian = (dot(x)^2 + dot(z)^2)/2 - z + x/2;
        impacts { road: z >= sin(0.3*x) => newton(0); wall: x <= 1/3 => newton(0); }
    }",
);

/// The wall lifts the point off the road. It rises along the wall and falls back to the road.
#[test]
fn a_wall_takes_over_from_the_surface_that_held_the_motion() {
    let blocked = BLOCKED.model();
    for &integrator in Integrator::every() {
        for tol in [1e-9, 1e-11] {
            let course = Course::new(&blocked, &[0.0, 0.0], &[1.0, 0.3], 0.9).tol(tol);
            let end = course.step(1e-3).resting().run(Setting::free(integrator));
            let case = format!("{}, {tol}: {:?}", integrator.name(), end.holds);
            assert_eq!((end.outcome, end.holds.len()), (Outcome::Done, 3), "{case}");
            assert_eq!([0, 1, 2].map(|i| end.holds[i].surface), [0, 0, 1], "{case}");
            assert!((end.holds[2].t - 0.323_66).abs() < 1e-4, "{case}");
            assert!((end.q[0] - 1.0 / 3.0).abs() < 1e-9, "{case}: {:?}", end.q);
        }
    }
}

/// A ball on a floor that rises with constant acceleration. The gap rate that is left at the end of the hops is a rounding error.
#[test]
fn hops_on_a_rising_floor_end_in_a_hold_at_their_limit() {
    static PLAIN: Text = Text::new(
        "Ball { coordinates { y; } lagrangian = dot(y)^2/2 - 1.314*y;
         impacts { floor: y - 0.355*t - 0.149*t^2 >= 0 => newton(0.8); } }",
    );
    static CURVED: Text = Text::new(
        "Ball { coordinates { y; } lagrangian = dot(y)^2/2 - 1.314*y;
         impacts { floor: exp(y - 0.355*t - 0.149*t^2) - 1 >= 0 => newton(0.8); } }",
    );
    let (height, rate, g) = (1.141, -0.446 - 0.355, 1.314 + 2.0 * 0.149);
    let arrival = f64::sqrt(rate * rate + 2.0 * g * height);
    let first = (rate + arrival) / g;
    let limit = first + 2.0 * arrival / g * 0.8 / (1.0 - 0.8);
    for floor in [PLAIN.model(), CURVED.model()] {
        for &integrator in Integrator::every() {
            for tol in [1e-6, 1e-8] {
                let course = Course::new(&floor, &[height], &[-0.446], limit + 1.0).tol(tol);
                let end = course
                    .step(limit / 512.0)
                    .resting()
                    .run(Setting::free(integrator));
                let case = format!("{}, {tol:e}: {:?}", integrator.name(), end.holds);
                assert_eq!(end.outcome, Outcome::Done, "{case}");
                let [hold] = &end.holds[..] else {
                    panic!("{case}");
                };
                let found = hold.accumulation.expect("a limit");
                assert!((found - limit).abs() < 1e-10 * limit, "{case}: {limit}");
                assert!(hold.t <= limit && limit - hold.t < 1e-5, "{case}: {limit}");
            }
        }
    }
}

/// A point that a curved wall stops and lets go at once: the gap has no rate then, and rises by its curvature.
static ROUND: Text = Text::new(
    "Round {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts { w: x^2 + y^2 <= 2 => impact_plastic; }
    }",
);

/// The same above a wavy floor.
static WAVES: Text = Text::new(
    "Waves {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts { w: y >= 0.3*cos(3*x) => impact_plastic; }
    }",
);

#[test]
fn a_wall_that_was_left_without_a_rate_is_met_again() {
    // The times of both impacts are those of small fixed steps.
    for (text, q, qdot, times) in [
        (
            &ROUND,
            [0.22, 0.13],
            [0.82, 1.14],
            [1.170_863_224, 2.059_025_119],
        ),
        (
            &WAVES,
            [0.3, 0.8],
            [2.02, -0.3],
            [0.791_252_953, 2.293_918_789],
        ),
    ] {
        let model = text.model();
        for &integrator in Integrator::every() {
            let course = Course::new(&model, &q, &qdot, 2.4)
                .tol(1e-10)
                .step(1e-2)
                .resting();
            let end = course.run(Setting::free(integrator));
            let name = integrator.name();
            assert_eq!(end.outcome, Outcome::Done, "{name}");
            assert_eq!(end.hits.len(), 2, "{name}");
            for (hit, right) in end.hits.iter().zip(times) {
                assert!((hit.t - right).abs() < 1e-5, "{name}: {}", hit.t);
            }
        }
    }
}
