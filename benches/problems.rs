//! Problems with known solutions. Each problem is solved, and the error of the result is measured.
//!
//! `benches/README.md` has the definitions and the sources of the solutions.

use std::time::Duration;

use dalembert::{
    Counters, Dla2, Dla4, Dop853, DormandPrince5, Effect, Gauss4, Gauss6, Impacts, Lagrangian, Law,
    Outcome, Projection, Rk4, Run, Scene, SceneEffects, Simulation, Stepper, System, Taylor,
    TaylorField, Tolerance,
};
use dalembert_models::{BouncingBall, ChaplyginSleigh, DoublePendulum, RollingDisk};

use crate::State;
use crate::timing::timed;

/// An integrator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// [`Dop853`].
    Dop853,
    /// [`DormandPrince5`].
    DormandPrince5,
    /// [`Taylor`].
    Taylor,
    /// [`Rk4`].
    Rk4,
    /// [`Gauss4`].
    Gauss4,
    /// [`Gauss6`].
    Gauss6,
    /// [`Dla2`].
    Dla2,
    /// [`Dla4`].
    Dla4,
}

impl Method {
    /// All integrators.
    pub const ALL: [Self; 8] = [
        Self::Dop853,
        Self::DormandPrince5,
        Self::Taylor,
        Self::Rk4,
        Self::Gauss4,
        Self::Gauss6,
        Self::Dla2,
        Self::Dla4,
    ];

    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Dop853 => "dop853",
            Self::DormandPrince5 => "dopri5",
            Self::Taylor => "taylor",
            Self::Rk4 => "rk4",
            Self::Gauss4 => "gauss4",
            Self::Gauss6 => "gauss6",
            Self::Dla2 => "dla2",
            Self::Dla4 => "dla4",
        }
    }

    /// The exponent of 10 of the smallest tolerance that is tried. At smaller tolerances, an integrator with a fixed
    /// step takes too many steps.
    pub const fn finest(self) -> i32 {
        match self {
            Self::Dop853 | Self::DormandPrince5 | Self::Taylor => -13,
            Self::Gauss6 => -12,
            Self::Rk4 | Self::Gauss4 | Self::Dla4 => -9,
            Self::Dla2 => -6,
        }
    }
}

/// Settings with which a problem is solved.
#[derive(Debug, Clone, Copy)]
pub struct Manner {
    /// The integrator.
    pub method: Method,
    /// The tolerance, relative and absolute.
    pub tolerance: Tolerance,
    /// Number of repetitions; the reported time is their mean.
    pub times: u32,
}

/// Result of solving a problem.
#[derive(Debug, Clone, Copy)]
pub struct Solved {
    /// End of the run.
    pub outcome: Outcome,
    /// Time of the end.
    pub t: f64,
    /// Distance from the known solution; NaN if the run did not end with the expected outcome.
    pub error: f64,
    /// Counts of work.
    pub counters: Counters,
    /// The wall time of one run.
    pub time: Duration,
}

/// A problem: its name and its solver.
#[derive(Clone, Copy)]
pub struct Problem {
    /// Name in snake case.
    pub name: &'static str,
    /// Solves the problem.
    pub solve: fn(Manner) -> Solved,
}

/// All problems.
pub const ALL: [Problem; 5] = [
    Problem {
        name: "disk_billiard",
        solve: disk_billiard,
    },
    Problem {
        name: "sleigh",
        solve: sleigh,
    },
    Problem {
        name: "sleigh_billiard",
        solve: sleigh_billiard,
    },
    Problem {
        name: "double_pendulum",
        solve: double_pendulum,
    },
    Problem {
        name: "bouncing_ball",
        solve: bouncing_ball,
    },
];

/// Impacts after which the billiards are compared.
const IMPACTS: u64 = 20;

/// End time of the billiards, later than impact [`IMPACTS`].
const LATE: f64 = 200.0;

/// The disk on the elliptical table, up to impact 20.
fn disk_billiard(manner: Manner) -> Solved {
    let disk = RollingDisk::default();
    let phi = core::f64::consts::FRAC_PI_2;
    let qdot = [
        disk.R * phi.cos() * 10.0,
        disk.R * phi.sin() * 10.0,
        10.0,
        0.2,
    ];
    let state = disk.state(0.0, &[0.0, 0.0, 0.0, phi].into(), &qdot.into());
    let run = solve(
        &disk,
        state.expect("an admissible state"),
        billiard(&disk),
        LATE,
        manner,
    );
    solved(run, Outcome::ImpactBudget, |run| {
        (run.t - 23.767_117_735_750_162).abs()
    })
}

/// The sleigh without a table: it turns around once and slides away.
fn sleigh(manner: Manner) -> Solved {
    let sleigh = ChaplyginSleigh {
        a: 0.3,
        ..ChaplyginSleigh::default()
    };
    let state = sleigh.state(0.0, &[0.0; 3].into(), &[-1.0, 0.0, 0.2].into());
    let state = state.expect("an admissible state");
    let run = solve(&sleigh, state, Projection::new(), 1000.0, manner);
    solved(run, Outcome::Done, |run| {
        let [x, y, theta, ..]: [f64; 5] = run.state.into();
        let differences = [
            x + 711.407_841_646_589_8,
            y + 713.335_210_810_974_3,
            theta - 10.216_689_681_437_405,
        ];
        largest(&differences)
    })
}

/// The sleigh with both tips on an elliptical table, up to impact 20.
fn sleigh_billiard(manner: Manner) -> Solved {
    let sleigh = ChaplyginSleigh {
        a: 0.3,
        len: 0.5,
        ta: 3.0,
        tb: 4.0,
        ..ChaplyginSleigh::default()
    };
    let theta = 0.3_f64;
    let qdot = [theta.cos(), theta.sin(), 1.0];
    let state = sleigh.state(0.0, &[0.0, 0.0, theta].into(), &qdot.into());
    let state = state.expect("an admissible state");
    let run = solve(&sleigh, state, billiard(&sleigh), LATE, manner);
    solved(run, Outcome::ImpactBudget, |run| {
        (run.t - 56.157_098_795_242_376).abs()
    })
}

/// The double pendulum from rest with raised bobs, for ten seconds.
fn double_pendulum(manner: Manner) -> Solved {
    let pendulum = DoublePendulum::default();
    let state = pendulum.state(0.0, &[2.0, 2.5].into(), &[0.0, 0.0].into());
    let run = solve(
        &pendulum,
        state.expect("an admissible state"),
        (),
        10.0,
        manner,
    );
    solved(run, Outcome::Done, |run| {
        let [theta1, theta2, ..]: [f64; 4] = run.state.into();
        largest(&[
            theta1 + 0.753_128_874_294_911_4,
            theta2 - 1.627_933_082_053_704_1,
        ])
    })
}

/// The ball that loses a tenth of its speed at each impact, up to the accumulation of its impacts.
fn bouncing_ball(manner: Manner) -> Solved {
    let ball = BouncingBall { m: 1.0, g: 9.81 };
    let state = ball.state(0.0, &[1.0].into(), &[0.0].into());
    let effects = Impacts::declared(&ball).with_law(0, Law::Newton(0.9));
    let run = solve(
        &ball,
        state.expect("an admissible state"),
        effects,
        20.0,
        manner,
    );
    let accumulation = match run.0.outcome {
        Outcome::Zeno { t, .. } => t,
        _ => f64::NAN,
    };
    solved(run, run.0.outcome, |_| {
        (accumulation - 8.578_949_178_728_887).abs()
    })
}

/// The declared effects, with a budget of [`IMPACTS`] impacts.
fn billiard<S: Scene>(system: &S) -> S::Effects {
    let mut effects = system.effects();
    effects.set_impact_budget(Some(IMPACTS));
    effects
}

fn largest(differences: &[f64]) -> f64 {
    differences
        .iter()
        .fold(0.0, |largest, difference| largest.max(difference.abs()))
}

/// Makes the run with the integrator of `manner`, from `t = 0`.
fn solve<S: Lagrangian + TaylorField, E: Effect<S> + Clone>(
    system: &S,
    state: State<S>,
    effects: E,
    until: f64,
    manner: Manner,
) -> (Run<State<S>>, Duration) {
    macro_rules! repeat {
        ($($method:ident)*) => {
            match manner.method {
                $(Method::$method => {
                    let stepper = $method::new(manner.tolerance);
                    repeat(system, state, (stepper, effects), until, manner.times)
                })*
            }
        };
    }
    repeat!(Dop853 DormandPrince5 Taylor Rk4 Gauss4 Gauss6 Dla2 Dla4)
}

/// Makes the run `times` times; returns the last run and the mean time.
fn repeat<S: System, Step: Stepper<S> + Copy, E: Effect<S> + Clone>(
    system: &S,
    state: State<S>,
    (stepper, effects): (Step, E),
    until: f64,
    times: u32,
) -> (Run<State<S>>, Duration) {
    let once = || {
        Simulation::new(system, stepper, effects.clone())
            .run(0.0, state, until, &mut ())
            .expect("a start")
    };
    let (time, run) = timed(|| {
        for _ in 1..times {
            core::hint::black_box(once());
        }
        once()
    });
    (run, time / times)
}

/// Measures the error of a run; NaN unless the run ended with the expected outcome.
fn solved<S: Copy>(
    (run, time): (Run<S>, Duration),
    expected: Outcome,
    error: impl FnOnce(&Run<S>) -> f64,
) -> Solved {
    let as_expected = run.outcome == expected;
    Solved {
        outcome: run.outcome,
        t: run.t,
        error: if as_expected { error(&run) } else { f64::NAN },
        counters: run.counters,
        time,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the tolerance 1e-4 to the finest one of an integrator, each digit of tolerance lowers the error by at least
    /// 0.4 digits in every problem. An error below 1e-10 also passes, because billiards amplify rounding errors to
    /// about that size. A wrong digit in a stored solution would make this test fail.
    #[test]
    fn errors_fall_with_the_tolerance() {
        for problem in ALL {
            for method in Method::ALL {
                let error = |decade: i32| {
                    let value: f64 = format!("1e{decade}").parse().expect("a number");
                    let manner = Manner {
                        method,
                        tolerance: Tolerance::new(value).expect("a tolerance"),
                        times: 1,
                    };
                    (problem.solve)(manner).error
                };
                let (loose, tight) = (error(-4), error(method.finest()));
                let gained = 0.4 * f64::from(-4 - method.finest());
                let label = format!("{} {}: {loose:e}, {tight:e}", problem.name, method.name());
                println!("{label}");
                assert!(
                    tight < loose * 10_f64.powf(-gained) || tight < 1e-10,
                    "{label}"
                );
            }
        }
    }
}
