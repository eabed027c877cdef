//! A run in a SIMD lane has the same bits as the run alone, independent of the runs in other lanes.

use dalembert::lanes::{Member, run_abreast};
use dalembert::{Described, Run, Scene, Simulation, StartError, StateVector, Taylor, TaylorField};
use dalembert::{Tolerance, VectorField};
use dalembert_models::{BouncingBall, DoublePendulum, PointBilliard, RollingDisk};
use dalembert_tests::sampling::states;

dalembert::model! {
    /// Forces with all functions of the language but `log1p` and `asinh`, and a gap that has no series.
    pub EveryFunction {
        coordinates { x; y; }
        parameters { c = 0.3; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        forces {
            odd: (sin(x) + tan(c*x) + asin(x/4)/2 + atan(x*y) + sinh(x) + tanh(y) + sqrt(x^2 + 1) + abs(y))*d(x);
            even: (cos(y) + acos(y/4)/2 + exp(-x^2) + ln(1 + x^2) + cosh(y) + atan2(y, x + 9) + (2 + x^2)^(2/3)
                + (1 + t)/(1 + x^2*y^2) + c/(2 + x^2) + t^2*x)*d(y);
        }
        impacts { corner: 2 - abs(x) - y >= 0; }
    }
}

type Results<S> = Vec<Result<Run<<S as VectorField>::State>, StartError>>;

/// The members of an ensemble. They differ in parameters and in the lengths of their runs. Some runs have length 0, one
/// has a budget of three steps, and one starts at NaN.
struct Members<S: VectorField> {
    systems: [S; 2],
    states: Vec<S::State>,
    tolerance: Tolerance,
}

const WITHOUT_STATE: usize = 7;
const WITHOUT_STEPS: usize = 11;

impl<S: Described + Scene + TaylorField> Members<S> {
    fn new(parameter: usize, tolerance: f64) -> Self {
        let systems = [1.0, 1.25].map(|factor| {
            let mut system = S::with_defaults();
            system.set_parameter(parameter, factor * system.parameter(parameter));
            system
        });
        let mut starts = states(&systems[0], 15, 5);
        starts.extend(faster(&systems[0], 15));
        starts[WITHOUT_STATE].as_mut_slice()[0] = f64::NAN;
        Self {
            systems,
            states: starts,
            tolerance: Tolerance::new(tolerance).expect("a tolerance"),
        }
    }

    fn system(&self, index: usize) -> &S {
        &self.systems[index % 2]
    }

    fn until(index: usize) -> f64 {
        [20.0, 0.0, 0.5, 1.0, 5.0][index % 5]
    }

    fn budget(index: usize) -> u64 {
        if index == WITHOUT_STEPS { 3 } else { 1000 }
    }

    /// An integrator of variable order. Every seventh member has one of the fixed order 11.
    fn stepper(&self, index: usize) -> Taylor<S> {
        let stepper = Taylor::new(self.tolerance);
        match index % 7 {
            3 => stepper.with_order(11),
            _ => stepper,
        }
    }

    fn alone(&self) -> Results<S> {
        let indices = 0..self.states.len();
        let runs = indices.map(|index| {
            let system = self.system(index);
            Simulation::new(system, self.stepper(index), system.effects())
                .with_step_budget(Self::budget(index))
                .run(0.0, self.states[index], Self::until(index), &mut ())
        });
        runs.collect()
    }

    /// The runs in lanes. `looks_inside` changes the order of the computation, but no result.
    fn abreast(&self, looks_inside: bool) -> Results<S> {
        let mut results: Vec<Option<_>> = self.states.iter().map(|_| None).collect();
        let members = (0..self.states.len()).map(|index| {
            let system = self.system(index);
            let start = (0.0, self.states[index]);
            let (stepper, until) = (self.stepper(index), Self::until(index));
            Member::new(index, system, stepper, system.effects(), (), start, until)
                .with_step_budget(Self::budget(index))
                .with_look_inside(looks_inside)
        });
        run_abreast(members, |index, run| {
            assert!(results[index].is_none(), "member {index} ends twice");
            results[index] = Some(run);
        });
        let results = results.into_iter();
        results.map(|run| run.expect("every member ends")).collect()
    }
}

/// The declared start with velocities multiplied by growing factors.
fn faster<S: Described>(system: &S, count: usize) -> Vec<S::State> {
    let initial = system.initial();
    let states = (0..count).map(|index| {
        let mut qdot = initial.qdot;
        let factor = 1.0 + index as f64 / 8.0;
        let speeds = qdot.as_mut_slice();
        speeds.iter_mut().for_each(|speed| *speed *= factor);
        system
            .state_projected(0.0, &initial.q, &qdot)
            .expect("a state")
    });
    states.collect()
}

/// Text that is equal for runs with the same bits, NaN included.
fn told<S: StateVector>(run: &Result<Run<S>, StartError>) -> String {
    match run {
        Ok(run) => {
            let bits = run.state.as_slice().iter().map(|x| x.to_bits());
            let bits: Vec<u64> = bits.collect();
            let counters = &run.counters;
            format!("{:?} at {:?}: {bits:x?} {counters:?}", run.outcome, run.t)
        }
        Err(error) => error.to_string(),
    }
}

fn assert_same<S: Described + Scene + TaylorField>(parameter: usize) -> u64 {
    let mut impacts = 0;
    for tolerance in [1e-4, 1e-10] {
        let members = Members::<S>::new(parameter, tolerance);
        let alone = members.alone();
        for looks_inside in [false, true] {
            for (index, (single, abreast)) in
                alone.iter().zip(&members.abreast(looks_inside)).enumerate()
            {
                let name = S::DESCRIPTION.name;
                assert_eq!(told(single), told(abreast), "{name}, member {index}");
            }
        }
        let runs = alone.iter().flatten();
        impacts += runs.map(|run| run.counters.impacts).sum::<u64>();
    }
    impacts
}

#[test]
fn smooth_motions_have_the_bits_that_they_have_alone() {
    assert_same::<DoublePendulum>(0);
    #[cfg(feature = "every_model")]
    assert_same::<dalembert_models::RollingBallEuler>(0);
}

#[test]
fn motions_with_impacts_have_the_bits_that_they_have_alone() {
    let impacts = [
        assert_same::<PointBilliard>(0),
        assert_same::<RollingDisk>(0),
        #[cfg(feature = "every_model")]
        assert_same::<dalembert_models::ChaplyginSleigh>(0),
        assert_same::<BouncingBall>(1),
    ];
    assert!(impacts.iter().all(|count| *count > 10), "{impacts:?}");
}

#[test]
fn functions_and_gaps_without_series_have_the_bits_that_they_have_alone() {
    assert!(assert_same::<EveryFunction>(0) > 0);
}
