//! Integrators with a fixed step: invariants, number of rate evaluations, and behaviour where a step fails.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use core::ops::ControlFlow;

use dalembert::integrate::{ClassicalRungeKutta, FixedStep, Gauss, Method};
use dalembert::{
    Counters, Fault, Gauss4, Gauss6, Law, Observer, Outcome, Rk4, Segment, Simulation, Stepper,
    System, Tolerance,
};
use dalembert_stability::particle::{FLOOR, Log, Particle, at, run_with};
use dalembert_tests::line::{Line, Plane, soliton, soliton_at};

fn tolerance() -> Tolerance {
    Tolerance::new(1e-10).unwrap()
}

fn with_step<M: Method>(h: f64) -> FixedStep<Plane, M> {
    FixedStep::new(tolerance()).with_step(h)
}

/// A pendulum in `(angle, velocity)`; only its rate is needed.
fn pendulum() -> Line {
    Line::new(|_, x, _| Ok(-x.sin()))
}

fn end<Step: Stepper<Line>>(system: &Line, stepper: Step, state: Plane, t_end: f64) -> Plane {
    let run = Simulation::new(system, stepper, ())
        .run(0.0, state, t_end, &mut ())
        .unwrap();
    assert_eq!(run.outcome, Outcome::Done);
    run.state
}

/// The determinant of the derivative of the flow over `t_end`, by differences of fourth order.
fn jacobian<M: Method>(t_end: f64, h: f64) -> f64
where
    FixedStep<Plane, M>: Stepper<Line>,
{
    let system = pendulum();
    let at = |x: f64, v: f64| {
        end(
            &system,
            with_step::<M>(h),
            Plane::new(1.0 + x, 0.3 + v),
            t_end,
        )
    };
    let derivative = |dx: f64, dv: f64| {
        let difference =
            |size: f64| (at(size * dx, size * dv) - at(-size * dx, -size * dv)) / (2.0 * size);
        let size = 2.0_f64.powi(-10);
        (difference(size) * 4.0 - difference(2.0 * size)) / 3.0
    };
    let (a, b) = (derivative(1.0, 0.0), derivative(0.0, 1.0));
    a[0] * b[1] - a[1] * b[0]
}

#[test]
fn gauss_keeps_areas_and_the_classical_method_does_not() {
    // The steps are so long that the flow has an error of a percent. The finite differences have an error of 1e-9.
    for defect in [
        jacobian::<Gauss<2>>(20.0, 0.8),
        jacobian::<Gauss<3>>(20.0, 0.8),
    ] {
        assert!((defect - 1.0).abs() < 1e-8, "{defect}");
    }
    let defect = jacobian::<ClassicalRungeKutta>(20.0, 0.8);
    assert!((defect - 1.0).abs() > 1e-3, "{defect}");
}

#[test]
fn gauss_runs_back_along_its_way() {
    fn there_and_back<M: Method>(h: f64) -> f64
    where
        FixedStep<Plane, M>: Stepper<Line>,
    {
        let (system, start) = (pendulum(), Plane::new(1.2, 0.5));
        let there = end(&system, with_step::<M>(h), start, 40.0);
        let back = end(
            &system,
            with_step::<M>(h),
            Plane::new(there[0], -there[1]),
            40.0,
        );
        (back - Plane::new(start[0], -start[1])).amax()
    }
    assert!(there_and_back::<Gauss<2>>(0.5) < 1e-13);
    assert!(there_and_back::<Gauss<3>>(0.5) < 1e-13);
    assert!(there_and_back::<ClassicalRungeKutta>(0.5) > 1e-3);
}

#[test]
fn quadratic_invariants_hold_to_rounding() {
    // Twice the energy of the oscillator, `x^2 + v^2`, is a quadratic invariant.
    let oscillator = Line::new(|_, x, _| Ok(-x));
    for h in [0.3, 1.1] {
        let four = end(
            &oscillator,
            with_step::<Gauss<2>>(h),
            Plane::new(1.0, 0.0),
            1000.0,
        );
        let six = end(
            &oscillator,
            with_step::<Gauss<3>>(h),
            Plane::new(1.0, 0.0),
            1000.0,
        );
        for state in [four, six] {
            assert!((state.dot(&state) - 1.0).abs() < 1e-14, "{state}");
        }
    }
}

/// Counters of a run of the soliton with ten steps of 0.1.
fn work<M: Method>() -> Counters
where
    FixedStep<Plane, M>: Stepper<Line>,
{
    let system = soliton();
    Simulation::new(&system, with_step::<M>(0.1), ())
        .run(0.0, soliton_at(0.0), 1.0, &mut ())
        .unwrap()
        .counters
}

#[test]
fn work_is_as_counted() {
    let counts = [
        work::<ClassicalRungeKutta>(),
        work::<Gauss<2>>(),
        work::<Gauss<3>>(),
    ];
    for counters in counts {
        assert_eq!((counters.accepted, counters.rejected), (10, 0));
    }
    // A run begins with one evaluation. `Rk4` has four per step. A Gauss method has one per step, and one per stage in
    // every iteration. `Gauss4` takes 12.1 iterations per step and `Gauss6` takes 10.4: their first guesses have errors
    // of 1e-4 and 1e-5, and each iteration reduces the error to a tenth.
    let evaluations = counts.map(|counters| counters.rate_evaluations);
    assert_eq!(evaluations, [41, 11 + 2 * 121, 11 + 3 * 104]);
}

#[test]
fn steps_lie_on_a_grid_whose_rounding_does_not_add_up() {
    struct Ends(Vec<f64>);
    impl Observer<Line> for Ends {
        fn step(&mut self, segment: &mut Segment<'_, Plane>) -> ControlFlow<()> {
            self.0.push(segment.t_end());
            ControlFlow::Continue(())
        }
    }
    let mut ends = Ends(Vec::new());
    let system = pendulum();
    Simulation::new(&system, with_step::<ClassicalRungeKutta>(0.1), ())
        .run(0.0, Plane::new(1.0, 0.0), 1000.05, &mut ends)
        .unwrap();
    assert_eq!(ends.0.len(), 10_001);
    assert_eq!((ends.0[9_999], ends.0[10_000]), (1000.0, 1000.05));
}

#[test]
fn step_is_chosen_once_and_told() {
    let system = pendulum();
    let mut simulation = Simulation::new(&system, Gauss4::new(tolerance()), ());
    let run = simulation
        .run(0.0, Plane::new(1.0, 0.2), 10.0, &mut ())
        .unwrap();
    let step = simulation.fixed_step().unwrap();
    assert!(step > 1e-3 && step < 0.1, "{step}");
    assert_eq!(run.counters.accepted, (10.0 / step).ceil() as u64);
}

#[test]
fn a_step_too_long_to_be_solved_is_made_in_parts() {
    // The frequency is 40 and the step 0.1. The fixed-point iteration contracts for steps below about 0.05.
    let stiff = Line::new(|_, x, _| Ok(-1600.0 * x));
    let stepper = Gauss6::new(tolerance()).with_step(0.1);
    let run = Simulation::new(&stiff, stepper, ())
        .run(0.0, Plane::new(1.0, 0.0), 10.0, &mut ())
        .unwrap();
    assert_eq!((run.outcome, run.counters.accepted), (Outcome::Done, 100));
    assert!(run.counters.rejected >= 100);
    let energy = run.state[0].powi(2) + run.state[1].powi(2) / 1600.0;
    assert!((energy - 1.0).abs() < 1e-13, "{energy}");
}

#[test]
fn a_step_that_cannot_be_solved_ends_the_run_by_name() {
    // The frequency is 1e9: the iteration does not contract even at a thousandth of the step.
    let stiff = Line::new(|_, x, _| Ok(-1e18 * x));
    let run = Simulation::new(&stiff, Gauss4::new(tolerance()).with_step(0.1), ())
        .run(0.0, Plane::new(1.0, 0.0), 1.0, &mut ())
        .unwrap();
    assert_eq!(run.outcome, Outcome::NotConverged { t: 0.0 });
    assert_eq!((run.t, run.state), (0.0, Plane::new(1.0, 0.0)));
}

#[test]
fn a_fault_ahead_is_reached_before_it_is_reported() {
    let fault = Fault::MetricNotPositive {
        pivot: 0,
        value: -1.0,
    };
    let system = Line::new(|_, x, _| match x > 2.0 {
        true => Err(Fault::MetricNotPositive {
            pivot: 0,
            value: -1.0,
        }),
        false => Ok(0.0),
    });
    fn ends(system: &Line, stepper: impl Stepper<Line>) -> (Outcome, f64) {
        let run = Simulation::new(system, stepper, ())
            .run(0.0, Plane::new(0.0, 1.0), 10.0, &mut ())
            .unwrap();
        (run.outcome, run.t)
    }
    for (outcome, t) in [
        ends(&system, Rk4::new(tolerance()).with_step(0.7)),
        ends(&system, Gauss6::new(tolerance()).with_step(0.7)),
    ] {
        assert_eq!(outcome, fault.into());
        assert!((t - 2.0).abs() < 1e-12, "{t}");
    }
}

#[test]
fn steps_grow_back_after_hops_and_accumulations_are_found() {
    let ball = Particle::new([-1.0, 0.0], [FLOOR]).with_law(Law::Restitution(0.5));
    let stepper = Gauss4::new(tolerance()).with_step(0.5);
    let mut log = Log::new();
    let run = run_with(&ball, stepper, at(0.0, 0.0, 1.0, 0.0), 10.0, &mut log);
    assert!(
        matches!(run.outcome, Outcome::Zeno { t, .. } if (t - 4.0).abs() < 1e-9),
        "{}",
        run.outcome
    );
    // The ball meets the floor after 1e-4, so that the next step has at most the length 4e-4. A flight of length 60
    // follows. Steps that grow by a factor 4 reach the grid in 6 steps, and 99 whole steps lead to the end.
    let ball = Particle::new([-1.0, 0.0], [FLOOR]);
    let start = at(0.003, 0.0, -30.0, 0.0);
    let run = run_with(&ball, stepper, start, 50.0, &mut log);
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 1));
    assert!(
        (104..110).contains(&run.counters.accepted),
        "{:?}",
        run.counters
    );
    assert!((ball.energy(run.t, &run.state).unwrap() - 450.003).abs() < 1e-10);
}

#[test]
fn two_runs_agree_to_the_bit() {
    let system = pendulum();
    let run = |h: f64| {
        [
            end(
                &system,
                with_step::<ClassicalRungeKutta>(h),
                Plane::new(1.0, 0.5),
                30.0,
            ),
            end(
                &system,
                with_step::<Gauss<2>>(h),
                Plane::new(1.0, 0.5),
                30.0,
            ),
            end(
                &system,
                with_step::<Gauss<3>>(h),
                Plane::new(1.0, 0.5),
                30.0,
            ),
        ]
        .map(|state| [state[0].to_bits(), state[1].to_bits()])
    };
    assert_eq!(run(0.07), run(0.07));
}

/// Below 0 the force of the potential `ln(x)` is finite again, but the energy is NaN.
#[test]
fn a_run_ends_where_the_energy_is_no_number() {
    let system = Line {
        potential: |x| x.ln(),
        ..Line::new(|_, x, _| Ok(-1.0 / x))
    };
    fn check<M: Method>(system: &Line, h: f64)
    where
        FixedStep<Plane, M>: Stepper<Line>,
    {
        let run = Simulation::new(system, with_step::<M>(h), ())
            .run(0.0, Plane::new(1.0, -1.0), 5.0, &mut ())
            .unwrap();
        // The point reaches 0 at the time 0.65568.
        assert!(run.t <= 0.655_68 + h, "{} {h}: {}", M::NAME, run.t);
        assert_ne!(run.outcome, Outcome::Done, "{} {h}", M::NAME);
        let energy = system.energy(run.t, &run.state).unwrap();
        assert!(energy.is_finite(), "{} {h}: {energy}", M::NAME);
        if M::ORDER == 4 && !M::MEETS {
            assert_eq!(run.outcome, Outcome::LeftDomain, "{h}");
        }
    }
    for h in [0.1, 0.03125, 0.01, 0.001] {
        check::<ClassicalRungeKutta>(&system, h);
        check::<Gauss<2>>(&system, h);
        check::<Gauss<3>>(&system, h);
    }
}

/// Near the edge of the domain of the force, implicit steps are shortened like explicit ones.
#[test]
fn implicit_steps_reach_the_edge_of_the_domain_of_the_force() {
    let system = Line {
        potential: |x| x.sqrt(),
        ..Line::new(|_, x, _| Ok(-0.5 / x.sqrt()))
    };
    fn check<M: Method>(system: &Line, h: f64)
    where
        FixedStep<Plane, M>: Stepper<Line>,
    {
        let run = Simulation::new(system, with_step::<M>(h), ())
            .run(0.0, Plane::new(1.0, -1.0), 5.0, &mut ())
            .unwrap();
        assert!(
            matches!(run.outcome, Outcome::NonFinite { .. }),
            "{} {h}: {}",
            M::NAME,
            run.outcome
        );
        // The time at which the point reaches 0, in closed form from the energy.
        let edge = 0.797_434_948_472_345;
        assert!((run.t - edge).abs() < 1e-3, "{} {h}: {}", M::NAME, run.t);
        assert!(run.state[0] >= 0.0 && run.state[0] < 1e-3);
    }
    for h in [0.03125, 0.01, 0.001] {
        check::<Gauss<2>>(&system, h);
        check::<Gauss<3>>(&system, h);
    }
}
