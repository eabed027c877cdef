//! Transitions one by one: what they keep, what they take, what they do not depend on, and how they end a run.

use dalembert::policy::{Policies, Split};
use dalembert::{
    Dop853, EventLog, Impacting, Outcome, Scene, SceneEffects, Simulation, System, Tolerance,
};
use dalembert_models::refracted_particle::refracted_particle;
use dalembert_models::smooth_and_rough_plane::smooth_and_rough_plane;
use dalembert_models::{RefractedParticle, SmoothAndRoughPlane};
use dalembert_tests::command;
use serde_json::Value;

use super::close;

/// Where the particle can go on refracted or reflected a run ends if that is asked for; where it cannot it goes on.
#[test]
fn a_motion_that_splits_ends_where_that_is_asked_for() {
    let ends = |particle: RefractedParticle| {
        let mut effects = particle.effects();
        effects.set_policies(Policies {
            split: Split::Stop,
            ..Policies::default()
        });
        let state = particle
            .state(0.0, &[-1.0, 0.0].into(), &[1.0, 0.5].into())
            .expect("a state");
        let stepper = Dop853::new(Tolerance::new(1e-12).expect("a tolerance"));
        Simulation::new(&particle, stepper, effects)
            .run(0.0, state, 3.0, &mut ())
            .expect("a start")
    };
    let split = ends(RefractedParticle::default());
    let surfaces = [0; 2];
    assert_eq!(split.outcome, Outcome::Ambiguous { surfaces });
    close(split.t, 1.0, 1e-12, "time");
    let reflected = RefractedParticle {
        V2: 2.0,
        ..RefractedParticle::default()
    };
    assert_eq!(ends(reflected).outcome, Outcome::Done);
    let line = "simulate refracted_particle --split stop --json -";
    let finished = command::line(dalembert_command::all(), line, "");
    let document: Value = serde_json::from_str(&finished.output).expect("JSON");
    assert_eq!(document["outcome"]["kind"], "ambiguous");
}

/// A mode by itself knows no other.
#[test]
fn a_mode_by_itself_ends_at_a_transition() {
    let left = refracted_particle::Left(RefractedParticle::default());
    let state = left
        .state(0.0, &[-1.0, 0.0].into(), &[1.0, 0.5].into())
        .expect("a state");
    let stepper = Dop853::new(Tolerance::new(1e-12).expect("a tolerance"));
    let run = Simulation::new(&left, stepper, left.effects())
        .run(0.0, state, 3.0, &mut ())
        .expect("a start");
    assert_eq!(run.outcome, Outcome::LeftMode { surface: 0 });
    close(run.t, 1.0, 1e-12, "time");
}

dalembert::model! {
    /// A point that is lifted by 0.3 into the upper half, with one round wall about both.
    Walled {
        coordinates { x; y; }
        modes {
            lower {
                lagrangian = (dot(x)^2 + dot(y)^2)/2;
                impacts { wall: 2 - sqrt(x^2 + y^2) >= 0; }
            }
            upper {
                lagrangian = (dot(x)^2 + dot(y)^2)/2;
                impacts { wall: 2 - sqrt(x^2 + y^2) >= 0; }
            }
        }
        transitions { lifted: lower -> upper when y >= 0 => reset { y = y + 0.3; }; }
    }
}

/// A surface that several modes have is met in each of them: at y = 0.3 + (t - 1), x = t/2, the wall is reached where their squares add up
/// to 4.
#[test]
fn a_surface_of_several_modes_is_met_in_each() {
    let point = Walled::default();
    let state = point.state(0.0, &[0.0, -1.0].into(), &[0.5, 1.0].into());
    let stepper = Dop853::new(Tolerance::new(1e-12).expect("a tolerance"));
    let mut impacts = EventLog::<_, 4>::new();
    Simulation::new(&point, stepper, point.effects())
        .run(0.0, state.expect("a state"), 4.0, &mut impacts)
        .expect("a start");
    let times: Vec<f64> = impacts.iter().map(|event| event.t).collect();
    let met = (0.7 + (0.49_f64 + 1.25 * 3.51).sqrt()) / 1.25;
    close(times[0], 1.0, 1e-12, "transition");
    close(times[1], met, 1e-12, "wall");
}

dalembert::model! {
    /// The ball of `SmoothAndRoughPlane` in other words: names, orders, constraints and surfaces are others, motions are not.
    Reworded {
        parameters { k > 0 = 2/3; r > 0 = 1; }
        coordinates { b: angle; v; a in (0, pi); u; c: angle; }
        let w1 = cos(b)*dot(a) + sin(b)*sin(a)*dot(c);
        let w2 = sin(b)*dot(a) - cos(b)*sin(a)*dot(c);
        lagrangian = k^2/2*(dot(c)^2 + dot(b)^2 + 2*cos(a)*dot(c)*dot(b) + dot(a)^2) + 1/2*(dot(v)^2 + dot(u)^2);
        modes {
            slippery { }
            sticky {
                constraints {
                    one: (2 + v^2)*(dot(v) + r*w1) = 0;
                    other: 3*(dot(u) - r*w2) - (dot(v) + r*w1)/2 = 0;
                }
            }
        }
        transitions {
            onto: slippery -> sticky when 3*u*(1 + v^2) >= 0;
            off: sticky -> slippery when u <= 0;
        }
    }
}

/// A state of the ball on the smooth side of the line, and the same of the reworded one.
fn at_the_line(n: u32) -> [[f64; 5]; 2] {
    let part = |k: f64| 2.0 * (f64::from(n) * k + 0.37 * k).fract() - 1.0;
    let q = [
        0.0,
        part(0.618),
        part(0.414),
        1.5 + part(0.732),
        part(0.236),
    ];
    let qdot = [
        0.05 + part(0.5479).abs(),
        part(0.3166),
        part(0.6457),
        part(0.8284),
        part(0.1962),
    ];
    [q, qdot]
}

/// Carnot's theorem (Cortes and Vinogradov, section 5.5): linear constraints that begin never add energy, and take that of
/// the velocity that is lost; nothing is lost exactly where the constraints hold already.
#[test]
fn constraints_that_begin_take_the_energy_of_what_is_lost() {
    let ball = SmoothAndRoughPlane::default();
    let rolling = smooth_and_rough_plane::Rough(ball);
    for n in 0..200 {
        let [q, qdot] = at_the_line(n).map(Into::into);
        for rolls in [false, true] {
            let qdot = match rolls {
                true => {
                    let nearest = rolling.state_projected(0.0, &q, &qdot).expect("a state");
                    rolling.velocity(0.0, &nearest).expect("a velocity")
                }
                false => qdot,
            };
            let before = ball.state(0.0, &q, &qdot).expect("a state");
            let after = ball.landing(0, 0.0, &before).expect("a state").state;
            let of = |state: &_| {
                let v = ball.velocity(0.0, state).expect("a velocity");
                let p = ball.momentum(0.0, state).expect("momenta");
                (v, p, ball.energy(0.0, state).expect("an energy"))
            };
            let ((v, p, energy), (v_after, p_after, energy_after)) = (of(&before), of(&after));
            let lost = 0.5 * (v - v_after).dot(&(p - p_after));
            close(
                energy_after - energy,
                -lost,
                1e-14,
                "the energy of the loss",
            );
            assert_eq!(lost < 1e-28, rolls, "{lost:e}");
        }
    }
}

#[test]
fn transitions_do_not_depend_on_words_and_factors() {
    let (ball, other) = (SmoothAndRoughPlane::default(), Reworded::default());
    for n in 0..100 {
        let [q, qdot] = at_the_line(n);
        let reworded = |own: [f64; 5]| [own[4], own[1], own[3], own[0], own[2]];
        let state = ball.state(0.0, &q.into(), &qdot.into()).expect("a state");
        let same = other
            .state(0.0, &reworded(q).into(), &reworded(qdot).into())
            .expect("a state");
        let [after, same] = [
            ball.landing(0, 0.0, &state)
                .map(|own| ball.velocity(0.0, &own.state)),
            other
                .landing(0, 0.0, &same)
                .map(|own| other.velocity(0.0, &own.state)),
        ];
        let after = after.expect("a state").expect("a velocity");
        let same = same.expect("a state").expect("a velocity");
        let after: Vec<f64> = after.iter().copied().collect();
        let expected = reworded([after[0], after[1], after[2], after[3], after[4]]);
        for (own, expected) in same.iter().zip(expected) {
            close(*own, expected, 1e-13, "velocity");
        }
    }
}

dalembert::model! {
    /// A point that comes into another medium at one plane, and on a keel at another.
    Straight {
        coordinates { x; y; z; }
        parameters { m > 0 = 1/2; k = 1/3; }
        modes {
            thin { lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2; }
            thick { lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(z)^2) + k*y; }
            keeled {
                lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
                constraints { keel: dot(z) = y*dot(x); }
            }
        }
        transitions {
            refracted: thin -> thick when x >= 0;
            focused: thin -> keeled when z >= 1;
        }
    }
}

dalembert::model! {
    /// The same in coordinates that are bent.
    Crooked {
        coordinates { u; v; w; }
        parameters { m > 0 = 1/2; k = 1/3; }
        let X = u + v^2/3;
        let Y = v + u/5;
        let Z = w + u*v/2;
        modes {
            thin { lagrangian = (dot(X)^2 + dot(Y)^2 + dot(Z)^2)/2; }
            thick { lagrangian = m/2*(dot(X)^2 + dot(Y)^2 + dot(Z)^2) + k*Y; }
            keeled {
                lagrangian = (dot(X)^2 + dot(Y)^2 + dot(Z)^2)/2;
                constraints { keel: dot(Z) = Y*dot(X); }
            }
        }
        transitions {
            refracted: thin -> thick when X >= 0;
            focused: thin -> keeled when Z >= 1;
        }
    }
}

/// Positions and velocities in straight coordinates, of those in bent ones.
fn straightened([u, v, w]: [f64; 3], [du, dv, dw]: [f64; 3]) -> [[f64; 3]; 2] {
    [
        [u + v * v / 3.0, v + u / 5.0, w + u * v / 2.0],
        [
            du + 2.0 * v * dv / 3.0,
            dv + du / 5.0,
            dw + (u * dv + v * du) / 2.0,
        ],
    ]
}

/// Refracted, reflected and focused states are the same in all coordinates.
#[test]
fn transitions_do_not_depend_on_coordinates() {
    let (straight, crooked) = (Straight::default(), Crooked::default());
    let mut seen = [[0, 0]; 2];
    for n in 0..200 {
        let [q, qdot] = at_the_line(n);
        let (v, w) = (q[1], q[2]);
        let u = -v * v / 3.0;
        for (surface, at) in [[u, v, w], [u, v, 1.0 - u * v / 2.0]]
            .into_iter()
            .enumerate()
        {
            let rates = [2.0 * qdot[1], qdot[2], qdot[3]];
            let [position, velocity] = straightened(at, rates);
            if velocity[2 * surface] <= 0.0 {
                continue;
            }
            let state = straight
                .state(0.0, &position.into(), &velocity.into())
                .expect("a state");
            let same = crooked
                .state(0.0, &at.into(), &rates.into())
                .expect("a state");
            let after = straight
                .landing(surface, 0.0, &state)
                .expect("a state")
                .state;
            let same = crooked.landing(surface, 0.0, &same).expect("a state").state;
            assert_eq!(straight.mode(&after), crooked.mode(&same));
            seen[surface][usize::from(straight.mode(&after) > 0)] += 1;
            let rates = crooked.velocity(0.0, &same).expect("a velocity");
            let found = straightened(crooked.position(&same).into(), rates.into());
            let velocity = straight.velocity(0.0, &after).expect("a velocity");
            for (own, expected) in found[1].iter().zip(&velocity) {
                close(*own, *expected, 1e-13, "velocity");
            }
            for (own, expected) in found[0].iter().zip(position) {
                close(*own, expected, 1e-15, "position");
            }
        }
    }
    let [[reflected, refracted], [_, focused]] = seen;
    assert!(reflected > 5 && refracted > 5 && focused > 50, "{seen:?}");
}

dalembert::model! {
    /// Two belts that run towards each other.
    Trap {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        modes {
            left { constraints { belt: dot(x) = 1; } }
            right { constraints { belt: dot(x) = -1; } }
        }
        transitions {
            rightward: left -> right when x >= 0;
            leftward: right -> left when x <= 0;
        }
    }
}

/// Where the belts meet each sends the motion back to the other.
#[test]
fn modes_that_lead_to_each_other_trap_the_motion() {
    let trap = Trap::default();
    let state = trap
        .state_projected(0.0, &[-0.1, 0.0].into(), &[1.0, 0.1].into())
        .expect("a state");
    let tolerance = Tolerance::new(1e-12).expect("a tolerance");
    let run = Simulation::new(&trap, Dop853::new(tolerance), trap.effects())
        .run(0.0, state, 1.0, &mut ())
        .expect("a start");
    assert!(
        matches!(run.outcome, Outcome::Trapped { .. }),
        "{:?}",
        run.outcome
    );
}
