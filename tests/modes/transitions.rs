//! Single transitions: conserved and lost quantities, independence of names and coordinates, and ends of runs at
//! transitions.

use dalembert::policy::{Policies, Split};
use dalembert::{EventLog, Impacting, Instance, Outcome, StateVector, System};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, state};
use dalembert_stability::text::{Large, Text, mode, shipped};
use dalembert_tests::command;
use serde_json::Value;

use super::{close, large};

/// With `Split::Stop` a run ends where both refraction and reflection are possible. The run continues if only one is.
#[test]
fn a_motion_that_splits_ends_where_that_is_asked_for() {
    let ends = |potential: Option<f64>| {
        let text = shipped("refracted_particle");
        let particle = match potential {
            Some(value) => text.with([("V2", value)]),
            None => text.model(),
        };
        let state = state(&particle, &[-1.0, 0.0], &[1.0, 0.5]);
        let policies = Policies {
            split: Split::Stop,
            ..Policies::default()
        };
        Course::from_state(&particle, state, 3.0)
            .policies(policies)
            .observed(Integrator::Dop853, &mut ())
    };
    let split = ends(None);
    let surfaces = [0; 2];
    assert_eq!(split.outcome, Outcome::Ambiguous { surfaces });
    close(split.t, 1.0, 1e-12, "time");
    assert_eq!(ends(Some(2.0)).outcome, Outcome::Done);
    let line = "simulate refracted_particle --split stop --json -";
    let finished = command::line(dalembert_command::all(), line, "");
    let document: Value = serde_json::from_str(&finished.output).expect("JSON");
    assert_eq!(document["outcome"]["kind"], "ambiguous");
}

/// A system made of one mode cannot enter other modes.
#[test]
fn a_mode_by_itself_ends_at_a_transition() {
    let left = mode(&shipped("refracted_particle").model(), 0);
    let state = state(&left, &[-1.0, 0.0], &[1.0, 0.5]);
    let run = Course::from_state(&left, state, 3.0).observed(Integrator::Dop853, &mut ());
    assert_eq!(run.outcome, Outcome::LeftMode { surface: 0 });
    close(run.t, 1.0, 1e-12, "time");
}

/// A point that is lifted by 0.3 into the upper half, with a round wall around both halves.
static WALLED: Text = Text::new(
    "Walled {
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
    }",
);

/// A point that moves downwards, with y = -1 - t and x = t/2, meets the wall of the lower mode at x^2 + y^2 = 4. A
/// point that moves upwards is lifted, and meets the wall of the upper mode with y = 0.3 + (t - 1).
#[test]
fn a_surface_of_several_modes_is_met_in_each() {
    let point = WALLED.model();
    // Times, surfaces and modes of the impacts.
    let met = |speed: f64, until: f64| -> Vec<(f64, usize, usize)> {
        let state = state(&point, &[0.0, -1.0], &[0.5, speed]);
        let mut impacts = EventLog::<_, 4>::new();
        Course::from_state(&point, state, until).observed(Integrator::Dop853, &mut impacts);
        let events = impacts.iter();
        events
            .map(|event| (event.t, event.surface, point.mode(&event.after)))
            .collect()
    };
    let (lower, upper) = (met(-1.0, 1.5), met(1.0, 3.0));
    let [(t, wall, 0)] = lower[..] else {
        panic!("{lower:?}");
    };
    close(t, (4.75_f64.sqrt() - 1.0) / 1.25, 1e-12, "wall below");
    let [(lifted, transition, 1), (t, wall_above, 1)] = upper[..] else {
        panic!("{upper:?}");
    };
    close(lifted, 1.0, 1e-12, "transition");
    let exact = (0.7 + (0.49_f64 + 1.25 * 3.51).sqrt()) / 1.25;
    close(t, exact, 1e-12, "wall above");
    assert!(wall_above == wall && transition != wall, "{upper:?}");
}

/// The ball of `SmoothAndRoughPlane` with other names, orders, constraints and surfaces, but the same motions.
static REWORDED: Text = Text::new(
    "Reworded {
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
    }",
);

/// Positions and velocities of the ball at the line, on its way to the rough side.
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

/// Carnot's theorem (Cortes and Vinogradov, section 5.5): linear constraints that begin to hold never add energy, and
/// take the kinetic energy of the lost velocity. They take no energy if and only if they already hold.
#[test]
fn constraints_that_begin_take_the_energy_of_what_is_lost() {
    let ball = large("smooth_and_rough_plane", []);
    let mut rolling = ball;
    rolling.set_mode(1);
    for n in 0..200 {
        let [q, qdot] = at_the_line(n);
        for rolls in [false, true] {
            let qdot = match rolls {
                true => {
                    let nearest =
                        rolling.state_projected(0.0, &StateVector::of(&q), &StateVector::of(&qdot));
                    let nearest = nearest.expect("a state");
                    rolling.velocity(0.0, &nearest).expect("a velocity")
                }
                false => StateVector::of(&qdot),
            };
            let before = state(&ball, &q, qdot.as_slice());
            let after = ball.landing(0, 0.0, &before).expect("a state").state;
            let of = |state: &_| {
                let v = ball.velocity(0.0, state).expect("a velocity");
                let p = ball.momentum(0.0, state).expect("momenta");
                let energy = ball.energy(0.0, state).expect("an energy");
                (v.as_slice().to_vec(), p.as_slice().to_vec(), energy)
            };
            let ((v, p, energy), (v_after, p_after, energy_after)) = (of(&before), of(&after));
            let parts = (0..5).map(|k| (v[k] - v_after[k]) * (p[k] - p_after[k]));
            let lost = 0.5 * parts.sum::<f64>();
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
    let (ball, other): (_, Large) = (large("smooth_and_rough_plane", []), REWORDED.sized());
    let after = |system: &Large, q: [f64; 5], qdot: [f64; 5]| {
        let before = state(system, &q, &qdot);
        let after = system.landing(0, 0.0, &before).expect("a state").state;
        let velocity = system.velocity(0.0, &after).expect("a velocity");
        <[f64; 5]>::try_from(velocity.as_slice()).expect("five")
    };
    for n in 0..100 {
        let [q, qdot] = at_the_line(n);
        let reworded = |values: [f64; 5]| [values[4], values[1], values[3], values[0], values[2]];
        let same = after(&other, reworded(q), reworded(qdot));
        let expected = reworded(after(&ball, q, qdot));
        for (found, expected) in same.iter().zip(expected) {
            close(*found, expected, 1e-13, "velocity");
        }
    }
}

/// A point that enters another medium at one plane, and gets a keel at another.
static STRAIGHT: Text = Text::new(
    "Straight {
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
    }",
);

/// The system of [`STRAIGHT`] in curvilinear coordinates.
static CROOKED: Text = Text::new(
    "Crooked {
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
    }",
);

/// Positions and velocities in Cartesian coordinates, from those in curvilinear ones.
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
    let (straight, crooked) = (STRAIGHT.model(), CROOKED.model());
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
            let before = state(&straight, &position, &velocity);
            let same = state(&crooked, &at, &rates);
            let after = straight.landing(surface, 0.0, &before);
            let after = after.expect("a state").state;
            let same = crooked.landing(surface, 0.0, &same).expect("a state").state;
            assert_eq!(straight.mode(&after), crooked.mode(&same));
            seen[surface][usize::from(straight.mode(&after) > 0)] += 1;
            let rates = crooked.velocity(0.0, &same).expect("a velocity");
            let three = |values: &[f64]| <[f64; 3]>::try_from(values).expect("three");
            let place = crooked.position(&same);
            let found = straightened(three(place.as_slice()), three(rates.as_slice()));
            let velocity = straight.velocity(0.0, &after).expect("a velocity");
            for (found, expected) in found[1].iter().zip(velocity.as_slice()) {
                close(*found, *expected, 1e-13, "velocity");
            }
            for (found, expected) in found[0].iter().zip(position) {
                close(*found, expected, 1e-15, "position");
            }
        }
    }
    let [[reflected, refracted], [_, focused]] = seen;
    assert!(reflected > 5 && refracted > 5 && focused > 50, "{seen:?}");
}

/// Two belts that run towards each other.
static TRAP: Text = Text::new(
    "Trap {
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
    }",
);

/// Each belt sends the motion back to the other where they meet.
#[test]
fn modes_that_lead_to_each_other_trap_the_motion() {
    let trap = TRAP.model();
    let run =
        Course::new(&trap, &[-0.1, 0.0], &[1.0, 0.1], 1.0).observed(Integrator::Dop853, &mut ());
    assert!(
        matches!(run.outcome, Outcome::Trapped { .. }),
        "{:?}",
        run.outcome
    );
}
