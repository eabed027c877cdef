//! Orders of the integrators and of their dense output, and outcomes of runs without impacts.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use core::ops::ControlFlow;

use dalembert::integrate::{
    ClassicalRungeKutta, Dop853Scheme, DormandPrince5Scheme, Embedded, FixedStep, Gauss,
};
use dalembert::{
    Dop853, DormandPrince5, Fault, Gauss4, Observer, Outcome, Rk4, Segment, Simulation, StartError,
    Stepper, Tolerance,
};
use dalembert_tests::line::{Line, Plane, soliton, soliton_at};

/// Largest error at the ends of `count` equal steps, and largest error inside them.
fn errors<Step: Stepper<Line>>(count: u32, stepper: impl Fn(f64) -> Step) -> [f64; 2] {
    struct Watch([f64; 2]);
    impl Observer<Line> for Watch {
        fn step(&mut self, segment: &mut Segment<'_, Plane>) -> ControlFlow<()> {
            let (start, end) = (segment.t_start(), segment.t_end());
            self.0[0] = self.0[0].max((segment.end() - soliton_at(end)).amax());
            for part in [0.2, 0.4, 0.6, 0.8] {
                let t = start + part * (end - start);
                self.0[1] = self.0[1].max((segment.at(t).unwrap() - soliton_at(t)).amax());
            }
            ControlFlow::Continue(())
        }
    }
    let mut watch = Watch([0.0; 2]);
    let system = soliton();
    let run = Simulation::new(&system, stepper(2.0 / f64::from(count)), ())
        .run(-1.0, soliton_at(-1.0), 1.0, &mut watch)
        .unwrap();
    assert_eq!(run.counters.accepted, u64::from(count));
    watch.0
}

/// Asserts that errors at the ends of steps have the order of the integrator. Errors inside steps have that order or
/// the order of the dense output plus one, whichever is lower.
fn assert_orders<Step: Stepper<Line>>(
    count: u32,
    [order, dense_order]: [usize; 2],
    stepper: impl Fn(f64) -> Step,
) {
    let (coarse, fine) = (errors(count, &stepper), errors(2 * count, &stepper));
    let name = stepper(1.0).name();
    let observed = [0, 1].map(|i| (coarse[i] / fine[i]).log2());
    let inside = order.min(dense_order + 1);
    for (observed, nominal) in observed.into_iter().zip([order, inside]) {
        println!("{name}: order {observed:.3}, nominal {nominal}");
        assert!(
            (observed - nominal as f64).abs() <= 0.1 * nominal as f64,
            "{name}: order {observed} instead of {nominal}"
        );
    }
}

/// An embedded pair with so loose a tolerance that only the step limit sets the step.
fn limited<M: dalembert::integrate::Scheme>(h: f64) -> Embedded<Plane, M> {
    Embedded::new(Tolerance::new(1e3).unwrap())
        .with_max_step(h)
        .unwrap()
        .with_first_step(h)
}

fn fixed<M: dalembert::integrate::Method>(h: f64) -> FixedStep<Plane, M> {
    FixedStep::new(Tolerance::new(1e-9).unwrap()).with_step(h)
}

#[test]
fn embedded_pairs_converge_at_their_orders() {
    assert_orders(20, [5, 4], limited::<DormandPrince5Scheme>);
    assert_orders(8, [8, 7], limited::<Dop853Scheme>);
}

#[test]
fn no_step_is_longer_than_the_largest() {
    struct Longest(f64, u32);
    impl Observer<Line> for Longest {
        fn step(&mut self, segment: &mut Segment<'_, Plane>) -> ControlFlow<()> {
            self.0 = self.0.max(segment.t_end() - segment.t_start());
            self.1 += 1;
            ControlFlow::Continue(())
        }
    }
    let system = soliton();
    let tolerance = Tolerance::new(1e3).unwrap();
    // One step more is taken where the last step would have to be slightly longer than the limit.
    for (t_end, steps) in [(0.1, 10), (0.10009, 11)] {
        let stepper = Dop853::new(tolerance).with_max_step(0.01).unwrap();
        let mut longest = Longest(0.0, 0);
        Simulation::new(&system, stepper.with_first_step(1.0), ())
            .run(0.0, soliton_at(0.0), t_end, &mut longest)
            .unwrap();
        assert!(longest.0 <= 0.01 * (1.0 + 1e-9), "{}", longest.0);
        assert_eq!(longest.1, steps);
    }
}

#[test]
fn a_largest_step_is_positive() {
    let stepper = Dop853::<Plane>::new(Tolerance::new(1e-9).unwrap());
    for value in [0.0, -1.0, f64::NAN, f64::NEG_INFINITY] {
        let refused = stepper.with_max_step(value).unwrap_err();
        assert!(refused.to_string().contains("positive"), "{refused}");
    }
    assert!(stepper.with_max_step(f64::INFINITY).is_ok());
}

#[test]
fn methods_of_fixed_step_converge_at_their_orders() {
    assert_orders(40, [4, 4], fixed::<ClassicalRungeKutta>);
    assert_orders(20, [4, 4], fixed::<Gauss<2>>);
    assert_orders(16, [6, 5], fixed::<Gauss<3>>);
}

#[test]
fn time_reaches_every_stage() {
    // `x'' = 30 t^4` has the solution `x = t^6`.
    let system = Line::new(|t, _, _| Ok(30.0 * t * t * t * t));
    fn end(system: &Line, stepper: impl Stepper<Line>) -> f64 {
        Simulation::new(system, stepper, ())
            .run(0.0, Plane::zeros(), 1.0, &mut ())
            .unwrap()
            .state[0]
    }
    let tolerance = Tolerance::new(1e-9).unwrap();
    assert!((end(&system, Dop853::new(tolerance)) - 1.0).abs() < 1e-9);
    assert!((end(&system, DormandPrince5::new(tolerance)) - 1.0).abs() < 1e-9);
    assert!((end(&system, Rk4::new(tolerance).with_step(1e-3)) - 1.0).abs() < 1e-9);
    assert!((end(&system, Gauss4::new(tolerance).with_step(1e-3)) - 1.0).abs() < 1e-9);
}

fn run(system: &Line, state: [f64; 2], t_end: f64) -> dalembert::Run<Plane> {
    let stepper = Dop853::new(Tolerance::new(1e-10).unwrap());
    Simulation::new(system, stepper, ())
        .run(0.0, Plane::from(state), t_end, &mut ())
        .unwrap()
}

#[test]
fn a21_collapse_is_a_step_underflow_where_it_happens() {
    let system = Line::new(|_, x, _| Ok(-1.0 / (x * x)));
    let run = run(&system, [1.0, 0.0], 2.0);
    assert!(
        matches!(
            run.outcome,
            Outcome::StepUnderflow { .. } | Outcome::NonFinite { .. }
        ),
        "{}",
        run.outcome
    );
    assert!((run.t - 1.110_720_734_539_592).abs() <= 1e-8, "{}", run.t);
    assert!(run.state[0].is_finite() && run.state[1].is_finite());
}

#[test]
fn a22_blow_up_ends_just_before_it() {
    let system = Line::new(|_, x, _| Ok(2.0 * x * x * x));
    let run = run(&system, [1.0, 1.0], 2.0);
    assert!(
        matches!(
            run.outcome,
            Outcome::StepUnderflow { .. } | Outcome::NonFinite { .. }
        ),
        "{}",
        run.outcome
    );
    assert!(run.t > 1.0 - 1e-6 && run.t <= 1.0 + 1e-9, "{}", run.t);
    assert!(run.state[0].is_finite() && run.state[1].is_finite());
}

#[test]
fn a_fault_ahead_is_reached_before_it_is_reported() {
    let fault = Fault::MetricNotPositive {
        pivot: 0,
        value: -1.0,
    };
    let system = Line::new(|_, x, _| {
        if x > 2.0 {
            Err(Fault::MetricNotPositive {
                pivot: 0,
                value: -1.0,
            })
        } else {
            Ok(0.0)
        }
    });
    let run = run(&system, [0.0, 1.0], 10.0);
    assert_eq!(run.outcome, fault.into());
    assert!((run.t - 2.0).abs() < 1e-12, "{}", run.t);
}

#[test]
fn a_chart_is_left_at_its_end() {
    let mut system = Line::new(|_, _, _| Ok(0.0));
    system.chart = 2.0;
    let run = run(&system, [0.0, 1.0], 10.0);
    assert_eq!(run.outcome, Outcome::LeftChart { coordinate: 0 });
    assert!(
        (run.t - 2.0).abs() < 1e-14 && run.state[0] < 2.0,
        "{}",
        run.t
    );
}

#[test]
fn bad_requests_are_refused() {
    let mut system = soliton();
    let start = |system: &Line, t0: f64, t_end: f64, x: f64| {
        let stepper = Dop853::new(Tolerance::new(1e-10).unwrap());
        Simulation::new(system, stepper, ()).run(t0, Plane::new(x, 0.0), t_end, &mut ())
    };
    for (t0, t_end) in [
        (1.0, 0.0),
        (f64::NAN, 1.0),
        (0.0, f64::NAN),
        (0.0, f64::INFINITY),
    ] {
        assert!(matches!(
            start(&system, t0, t_end, 1.0),
            Err(StartError::Times { .. })
        ));
    }
    assert_eq!(
        start(&system, 0.0, 1.0, f64::NAN).unwrap().outcome,
        Outcome::NonFinite { component: 0 }
    );
    assert_eq!(
        start(&system, 1.0, 1.0, 1.0).unwrap().outcome,
        Outcome::Done
    );
    system.mass = -1.0;
    assert!(matches!(
        start(&system, 0.0, 1.0, 1.0),
        Err(StartError::Parameter(_))
    ));
}

#[test]
fn budgets_and_observers_stop_a_run() {
    struct Stop(u32);
    impl Observer<Line> for Stop {
        fn step(&mut self, _: &mut Segment<'_, Plane>) -> ControlFlow<()> {
            self.0 -= 1;
            if self.0 == 0 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        }
    }
    let system = soliton();
    let stepper = Dop853::new(Tolerance::new(1e-10).unwrap());
    let mut simulation = Simulation::new(&system, stepper, ()).with_step_budget(4);
    let run = simulation
        .run(0.0, soliton_at(0.0), 100.0, &mut ())
        .unwrap();
    assert_eq!(
        (run.outcome, run.counters.accepted),
        (Outcome::StepBudget, 4)
    );
    assert!((run.state - soliton_at(run.t)).amax() < 1e-9);
    let run = simulation
        .run(0.0, soliton_at(0.0), 100.0, &mut Stop(3))
        .unwrap();
    assert_eq!((run.outcome, run.counters.accepted), (Outcome::Stopped, 3));
}

#[test]
fn dense_output_is_paid_for_only_where_it_is_read() {
    struct Read(f64);
    impl Observer<Line> for Read {
        fn step(&mut self, segment: &mut Segment<'_, Plane>) -> ControlFlow<()> {
            if segment.t_start() < self.0 && self.0 <= segment.t_end() {
                assert!((segment.at(self.0).unwrap() - soliton_at(self.0)).amax() < 1e-9);
            }
            ControlFlow::Continue(())
        }
    }
    let system = soliton();
    let stepper = Dop853::new(Tolerance::new(1e-10).unwrap());
    let mut simulation = Simulation::new(&system, stepper, ());
    let run = simulation
        .run(0.0, soliton_at(0.0), 2.0, &mut Read(1.0))
        .unwrap();
    assert_eq!(run.counters.dense_constructions, 1);
    let run = simulation
        .run(0.0, soliton_at(0.0), 2.0, &mut Read(2.0))
        .unwrap();
    assert_eq!(run.counters.dense_constructions, 0);
    assert_eq!(run.t, 2.0);
}
