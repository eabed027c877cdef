//! The observed order of every method on every declared system, with DOP853 at the finest tolerance as the reference.
//! Methods with step-size control run at a step limit and a tolerance so loose that it does not act.

use dalembert::integrate::Chosen;
use dalembert::math::larger;
use dalembert::{
    Dla2, Dla4, Dop853, DormandPrince5, Gauss4, Gauss6, Instance, Outcome, Rk4, Simulation,
    StateVector, Stepper, System, Taylor, Tolerance, VectorField,
};
use dalembert_stability::text::Large;
use dalembert_tests::sampling::{every_system, states};

type State = <Large as VectorField>::State;

/// Duration of the motions.
const TIME: f64 = 0.5;

/// Errors between which the slope is measured. Below are rounding errors and the error of the reference. Above, steps
/// are so long that the leading term does not dominate.
const RANGE: [f64; 2] = [2e-11, 1e-4];

/// Order of the power series, chosen so that the leading term dominates within the range.
const TAYLOR_ORDER: usize = 5;

/// Positions and velocities at the end, and the number of steps; the outcome if the run ends early.
fn end(
    system: &Large,
    mut stepper: impl Stepper<Large>,
    state: State,
) -> Result<([State; 2], u64), Outcome> {
    let run = Simulation::new(system, Chosen::new(&mut stepper), ())
        .run(0.0, state, TIME, &mut ())
        .expect("a start");
    if run.outcome != Outcome::Done {
        return Err(run.outcome);
    }
    let qdot = system.velocity(TIME, &run.state).expect("a velocity");
    Ok(([system.position(&run.state), qdot], run.counters.accepted))
}

fn difference<V: StateVector>(a: &[V; 2], b: &[V; 2]) -> f64 {
    let components = |of: &[V; 2]| {
        let of = *of;
        of.into_iter().flat_map(|part| part.as_slice().to_vec())
    };
    let size = components(b).fold(1.0, |size: f64, value| larger(size, value.abs()));
    components(a)
        .zip(components(b))
        .fold(0.0, |worst: f64, (a, b)| larger(worst, (a - b).abs()))
        / size
}

/// Errors at successively halved steps, down to the first error below the range; NaN for runs that end early or do not
/// count. An error if the method does not apply to the system.
fn errors(error: impl Fn(f64) -> Result<f64, Outcome>) -> Result<Vec<f64>, Outcome> {
    let mut errors = Vec::new();
    for halvings in 0..12 {
        match error(TIME / f64::from(1 << halvings)) {
            Err(Outcome::NonlinearConstraints) => return Err(Outcome::NonlinearConstraints),
            Err(_) => errors.push(f64::NAN),
            Ok(error) => errors.push(error),
        }
        if errors.last().is_some_and(|&error| error < RANGE[0]) {
            break;
        }
    }
    Ok(errors)
}

/// The slopes between steps whose errors lie in the range.
fn slopes(errors: &[f64]) -> Vec<f64> {
    let in_range = |error: &f64| (RANGE[0]..RANGE[1]).contains(error);
    errors
        .windows(2)
        .filter(|pair| pair.iter().all(in_range))
        .map(|pair| (pair[0] / pair[1]).log2())
        .collect()
}

#[derive(Default)]
struct Orders {
    measured: u32,
    wrong: Vec<String>,
}

impl Orders {
    fn check(
        &mut self,
        name: &str,
        (method, order): (&str, usize),
        errors: Result<Vec<f64>, Outcome>,
        is_exact: bool,
    ) {
        let errors = match errors {
            Ok(errors) => errors,
            // The discrete principle needs constraints that are linear in the velocities.
            Err(_) if method.starts_with("dla") => return,
            Err(outcome) => {
                self.wrong.push(format!("{name} {method}: {outcome}"));
                return;
            }
        };
        let slopes = slopes(&errors);
        println!("{name:28} {method}: {slopes:.2?}");
        let Some(last) = slopes.last() else {
            // The method is exact for this motion, or its errors pass the range in one halving.
            let finest = errors[errors.len() - 1];
            if finest.is_nan() || finest > RANGE[0] {
                self.wrong.push(format!("{name} {method}: {errors:?}"));
            }
            return;
        };
        self.measured += 1;
        // The errors of high-order methods may fall faster: they reach the rounding errors before their leading term
        // dominates.
        let ceiling = if is_exact {
            order as f64 + 0.3
        } else {
            f64::INFINITY
        };
        let floor = order as f64 - if is_exact { 0.3 } else { 0.1 * order as f64 };
        if *last < floor || *last > ceiling {
            self.wrong.push(format!("{name} {method}: {slopes:.2?}"));
        }
    }
}

/// A start of a system and the exact end of its motion.
struct Motion<'s> {
    system: &'s Large,
    start: State,
    reference: [State; 2],
}

impl<'s> Motion<'s> {
    fn of(system: &'s Large) -> Self {
        let tolerance = Tolerance::new(1e-14).expect("a tolerance");
        let start = states(system, 1, 7)[0];
        let (reference, _) = end(system, Dop853::new(tolerance), start).expect("an end");
        Self {
            system,
            start,
            reference,
        }
    }

    fn name(&self) -> &'static str {
        self.system.description().name
    }

    /// Relative error of a run, and the number of its steps.
    fn error(&self, stepper: impl Stepper<Large>) -> Result<(f64, u64), Outcome> {
        let (reached, steps) = end(self.system, stepper, self.start)?;
        Ok((difference(&reached, &self.reference), steps))
    }
}

impl Orders {
    fn measure_fixed_steps(&mut self, motion: &Motion) {
        let tolerance = Tolerance::new(1e-14).expect("a tolerance");
        macro_rules! check {
            ($($method:ident)*) => {$(
                let error = |h: f64| {
                    motion.error($method::new(tolerance).with_step(h)).map(|(error, _)| error)
                };
                let order = $method::<State>::ORDER;
                let method = (Stepper::<Large>::name(&$method::new(tolerance)), order);
                self.check(motion.name(), method, errors(error), true);
            )*};
        }
        check!(Rk4 Gauss4 Gauss6 Dla2 Dla4);
    }

    fn measure_controlled_steps(&mut self, motion: &Motion) {
        let [loose, coarse] = [1e3, 1e-3].map(|tol| Tolerance::new(tol).expect("a tolerance"));
        macro_rules! check {
            ($method:ident, $order:expr, $limited:expr) => {{
                let error = |h: f64| {
                    // Runs with steps that the tolerance shortened do not count.
                    motion.error($limited(h)).map(|(error, steps)| {
                        match steps == (TIME / h).round() as u64 {
                            true => error,
                            false => f64::NAN,
                        }
                    })
                };
                let method = (Stepper::<Large>::name(&<$method>::new(loose)), $order);
                self.check(motion.name(), method, errors(error), false);
            }};
        }
        type Eight = Dop853<State>;
        type Five = DormandPrince5<State>;
        type Series = Taylor<Large>;
        check!(Eight, 8, |h| Eight::new(loose)
            .with_max_step(h)
            .expect("a positive step")
            .with_first_step(h));
        check!(Five, 5, |h| Five::new(loose)
            .with_max_step(h)
            .expect("a positive step")
            .with_first_step(h));
        check!(Series, TAYLOR_ORDER, |h| Series::new(coarse)
            .with_order(TAYLOR_ORDER)
            .with_max_step(h)
            .expect("a positive step"));
    }
}

/// Measures orders on every system, and asserts that they are right, and at least so many.
fn assert_orders(least: u32, measure: impl Fn(&mut Orders, &Motion)) {
    let mut orders = Orders::default();
    for system in every_system() {
        measure(&mut orders, &Motion::of(system));
    }
    println!("{} measured", orders.measured);
    assert!(orders.wrong.is_empty(), "{:#?}", orders.wrong);
    assert!(orders.measured >= least, "{}", orders.measured);
}

#[test]
fn every_method_of_fixed_steps_has_its_order_on_every_system() {
    assert_orders(120, Orders::measure_fixed_steps);
}

#[test]
fn every_method_of_controlled_steps_has_its_order_on_every_system() {
    assert_orders(60, Orders::measure_controlled_steps);
}
