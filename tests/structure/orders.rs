//! The observed order of every method on every declared system, with DOP853 at the finest tolerance as the reference.
//! Methods with step-size control run at a step limit and a tolerance so loose that it does not act.

use dalembert::integrate::Chosen;
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

/// Positions and velocities at the end, and the number of steps; `None` if the run ends early.
fn end(
    system: &Large,
    mut stepper: impl Stepper<Large>,
    state: State,
) -> Option<([State; 2], u64)> {
    let run = Simulation::new(system, Chosen::new(&mut stepper), ())
        .run(0.0, state, TIME, &mut ())
        .expect("a start");
    if run.outcome != Outcome::Done {
        return None;
    }
    let qdot = system.velocity(TIME, &run.state).expect("a velocity");
    Some(([system.position(&run.state), qdot], run.counters.accepted))
}

fn difference<V: StateVector>(a: &[V; 2], b: &[V; 2]) -> f64 {
    let components = |of: &[V; 2]| {
        let of = *of;
        of.into_iter().flat_map(|part| part.as_slice().to_vec())
    };
    let size = components(b).fold(1.0, |size: f64, value| size.max(value.abs()));
    components(a)
        .zip(components(b))
        .fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()))
        / size
}

/// The slopes between halved steps whose errors lie in the range; empty if the method is exact for this motion.
fn slopes(error: impl Fn(f64) -> f64) -> Vec<f64> {
    let errors: Vec<f64> = (0..12).map(|k| error(TIME / f64::from(1 << k))).collect();
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
        slopes: &[f64],
        is_exact: bool,
    ) {
        println!("{name:28} {method}: {slopes:.2?}");
        let Some(last) = slopes.last() else {
            return;
        };
        self.measured += 1;
        // Errors of methods of high order reach rounding errors before their leading term dominates, and fall faster.
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

impl Orders {
    fn measure(&mut self, system: &Large) {
        let tolerance = Tolerance::new(1e-14).expect("a tolerance");
        let state = states(system, 1, 7)[0];
        let name = system.description().name;
        let (reference, _) = end(system, Dop853::new(tolerance), state).expect("an end");
        macro_rules! check {
            ($($method:ident)*) => {$(
                let error = |h: f64| {
                    let reached = end(system, $method::new(tolerance).with_step(h), state);
                    reached.map_or(f64::NAN, |(reached, _)| difference(&reached, &reference))
                };
                let order = $method::<State>::ORDER;
                let method = (Stepper::<Large>::name(&$method::new(tolerance)), order);
                self.check(name, method, &slopes(error), true);
            )*};
        }
        check!(Rk4 Gauss4 Gauss6 Dla2 Dla4);
        let loose = Tolerance::new(1e3).expect("a tolerance");
        macro_rules! check_limited {
            ($method:ident, $order:expr, $limited:expr) => {{
                let error = |h: f64| {
                    // Runs with steps that the tolerance shortened do not count.
                    let reached = end(system, $limited(h), state);
                    let reached = reached.filter(|(_, steps)| *steps == (TIME / h).round() as u64);
                    reached.map_or(f64::NAN, |(reached, _)| difference(&reached, &reference))
                };
                let method = (Stepper::<Large>::name(&<$method>::new(tolerance)), $order);
                self.check(name, method, &slopes(error), false);
            }};
        }
        type Eight = Dop853<State>;
        type Five = DormandPrince5<State>;
        type Series = Taylor<Large>;
        check_limited!(Eight, 8, |h| Eight::new(loose)
            .with_max_step(h)
            .expect("a positive step")
            .with_first_step(h));
        check_limited!(Five, 5, |h| Five::new(loose)
            .with_max_step(h)
            .expect("a positive step")
            .with_first_step(h));
        let coarse = Tolerance::new(1e-3).expect("a tolerance");
        check_limited!(Series, TAYLOR_ORDER, |h| Series::new(coarse)
            .with_order(TAYLOR_ORDER)
            .with_max_step(h)
            .expect("a positive step"));
    }
}

#[test]
fn every_method_has_its_order_on_every_system() {
    let mut orders = Orders::default();
    for system in every_system() {
        orders.measure(system);
    }
    println!("{} measured", orders.measured);
    assert!(orders.wrong.is_empty(), "{:#?}", orders.wrong);
    assert!(orders.measured >= 120, "{}", orders.measured);
}
