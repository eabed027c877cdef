//! The observed order of every method of fixed step, on every declared system, against DOP853 at its finest.

use dalembert::{
    Described, Dla2, Dla4, Dop853, Gauss4, Gauss6, Lagrangian, Outcome, Rk4, Scene, Simulation,
    StateVector, Stepper, Tolerance,
};
use dalembert_tests::sampling::{Visitor, states, visit_all};

/// How long the motions are followed.
const TIME: f64 = 0.5;

/// Errors between which the slope is taken: below them are rounding and the reference's own error, above them steps
/// so long that the leading term does not lead.
const RANGE: [f64; 2] = [2e-11, 1e-4];

/// Positions and velocities at the end.
fn end<S: Described + Lagrangian, Step: Stepper<S>>(
    system: &S,
    stepper: Step,
    state: S::State,
) -> Option<[S::Vector; 2]> {
    let run = Simulation::new(system, stepper, ())
        .run(0.0, state, TIME, &mut ())
        .expect("a start");
    if run.outcome != Outcome::Done {
        return None;
    }
    let qdot = system.velocity(TIME, &run.state).expect("a velocity");
    Some([system.position(&run.state), qdot])
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

/// The slopes between halved steps whose errors lie in the range; empty for a method that is exact on this motion.
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
    fn check(&mut self, name: &str, method: &str, order: usize, slopes: &[f64]) {
        println!("{name:28} {method}: {slopes:.2?}");
        let Some(last) = slopes.last() else {
            return;
        };
        self.measured += 1;
        if (last - order as f64).abs() > 0.3 {
            self.wrong.push(format!("{name} {method}: {slopes:.2?}"));
        }
    }
}

impl Visitor for Orders {
    fn visit<S: Described + Scene + Lagrangian>(&mut self, system: S) {
        let tolerance = Tolerance::new(1e-14).expect("a tolerance");
        let state = states(&system, 1, 7)[0];
        let name = S::DESCRIPTION.name;
        let reference = end(&system, Dop853::new(tolerance), state).expect("an end");
        macro_rules! check {
            ($($method:ident)*) => {$(
                let error = |h: f64| {
                    let reached = end(&system, $method::new(tolerance).with_step(h), state);
                    reached.map_or(f64::NAN, |reached| difference(&reached, &reference))
                };
                let order = $method::<S::State>::ORDER;
                self.check(name, <$method<S::State> as Stepper<S>>::NAME, order, &slopes(error));
            )*};
        }
        check!(Rk4 Gauss4 Gauss6 Dla2 Dla4);
    }
}

#[test]
fn every_method_has_its_order_on_every_system() {
    let mut orders = Orders::default();
    visit_all(&mut orders);
    println!("{} measured", orders.measured);
    assert!(orders.wrong.is_empty(), "{:#?}", orders.wrong);
    assert!(orders.measured >= 120, "{}", orders.measured);
}
