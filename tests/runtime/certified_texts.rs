//! A model loaded from a text has the same certified enclosures as the compiled type, to the bit.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use std::ops::ControlFlow;
use std::sync::Arc;

use dalembert::certified::{CertifiedFlow, CertifiedRun, Reason};
use dalembert::declaration::Described;
use dalembert::erased::{Erased, Form};
use dalembert::numbers::Interval;
use dalembert::state::StateVector;
use dalembert::{Impacting, Instance, Variational};

mod ball {
    dalembert::model_file!("../models/src/bouncing_ball.dal");
}

#[cfg(feature = "every_model")]
mod billiard {
    dalembert::model_file!("../models/src/point_billiard.dal");
}

#[cfg(feature = "every_model")]
mod pendulum {
    dalembert::model_file!("../models/src/double_pendulum.dal");
}

#[cfg(feature = "every_model")]
mod sleigh {
    dalembert::model_file!("../models/src/chaplygin_sleigh.dal");
}

mod walker {
    dalembert::model_file!("../models/src/spring_mass_walker.dal");
}

fn loaded<M: Described>() -> Arc<Form> {
    let models = dalembert_jit::load(M::DESCRIPTION.name, M::DESCRIPTION.source.value());
    let models = models.unwrap_or_else(|refused| panic!("{refused}"));
    Arc::clone(&models[0].form)
}

fn start<M: Instance>(model: &M) -> Vec<f64> {
    let initial = model.initial();
    let state = model.state(0.0, &initial.q, &initial.qdot).unwrap();
    state.as_slice().to_vec()
}

/// Surface, time, and states before and after each impact, then the state at the end, from a box about a state.
fn enclosures<Sys: Variational + Impacting>(
    system: &Sys,
    start: &[f64],
    radius: f64,
    (until, impacts): (f64, u64),
) -> Vec<Interval> {
    let n = start.len();
    assert_eq!(system.state_len(), n);
    let mut found = Vec::new();
    let mut count = 0;
    let mut run = CertifiedRun::new(system, 0.0, |i| Interval::point(start[i]).widened(radius));
    run.run(until, |impact| {
        found.push(Interval::point(impact.surface as f64));
        found.push(impact.time);
        found.extend((0..n).map(|i| impact.before(i)));
        found.extend((0..n).map(|i| impact.after(i)));
        count += 1;
        match count == impacts {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    })
    .unwrap();
    assert_eq!(count, impacts);
    found.extend((0..n).map(|i| run.component(i)));
    found
}

/// Runs `work` on a stack with room for the longest vectors in unoptimised code.
fn with_stack<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(16 << 20);
        thread.spawn_scoped(scope, work).unwrap().join().unwrap()
    })
}

fn bits(ranges: &[Interval]) -> Vec<[u64; 2]> {
    let bits = |range: &Interval| [range.lo, range.hi].map(f64::to_bits);
    ranges.iter().map(bits).collect()
}

/// Asserts that a model and its text have the same enclosures, for erased systems of two capacities.
fn assert_same<M>(model: &M, settings: &[(&str, f64)], radius: f64, until: (f64, u64))
where
    M: Described + Instance + Variational + Impacting,
{
    let start = start(model);
    let expected = bits(&enclosures(model, &start, radius, until));
    let form = loaded::<M>();
    let parameters = &form.documentation.description.parameters;
    let place = |name: &str| {
        parameters
            .iter()
            .position(|parameter| parameter.name == name)
            .unwrap()
    };
    macro_rules! compare {
        ($room:literal) => {
            let mut model = Erased::<$room>::of(&form).unwrap();
            for (name, value) in settings {
                model.set_parameter(place(name), *value);
            }
            let found = with_stack(|| enclosures(&model, &start, radius, until));
            assert_eq!(bits(&found), expected);
        };
    }
    compare!(32);
    if form.capacity().is_some_and(|capacity| capacity <= 8) {
        compare!(8);
    }
}

#[test]
fn a_bouncing_ball_has_the_same_enclosures() {
    let ball = ball::BouncingBall::default();
    assert_same(&ball, &[], 0.0, (20.0, 3));
    assert_same(&ball, &[], 1e-6, (20.0, 3));
}

#[cfg(feature = "every_model")]
#[test]
fn a_circular_billiard_has_the_same_enclosures() {
    let table = billiard::PointBilliard {
        ta: 1.0,
        ..billiard::PointBilliard::default()
    };
    assert_same(&table, &[("ta", 1.0)], 1e-9, (50.0, 3));
}

#[cfg(feature = "every_model")]
#[test]
fn a_sleigh_has_the_same_enclosures() {
    assert_same(&sleigh::ChaplyginSleigh::default(), &[], 0.0, (40.0, 2));
}

#[test]
fn a_walker_with_modes_has_the_same_enclosures() {
    assert_same(&walker::SpringMassWalker::default(), &[], 0.0, (3.0, 4));
}

#[cfg(feature = "every_model")]
#[test]
fn a_double_pendulum_has_the_same_enclosures() {
    fn end<Sys: Variational>(system: &Sys, start: &[f64]) -> Vec<Interval> {
        let mut flow = CertifiedFlow::new(system, 0.0, |i| Interval::point(start[i]));
        flow.run(0.5).unwrap();
        (0..start.len()).map(|i| flow.component(i)).collect()
    }
    let model = pendulum::DoublePendulum::default();
    let start = start(&model);
    let expected = bits(&end(&model, &start));
    let form = loaded::<pendulum::DoublePendulum>();
    let small = Erased::<4>::of(&form).unwrap();
    assert_eq!(bits(&end(&small, &start)), expected);
    let large = Erased::<32>::of(&form).unwrap();
    assert_eq!(bits(&with_stack(|| end(&large, &start))), expected);
}

#[test]
fn a_form_that_was_compiled_has_no_kernels_over_intervals_and_says_so() {
    let form = <ball::BouncingBall as Described>::FORM.unwrap();
    let system = Erased::<4>::of(form).unwrap();
    let mut run = CertifiedRun::new(&system, 0.0, |_| Interval::point(1.0));
    let lost = run.next_impact(1.0).err().unwrap();
    assert_eq!((lost.t, lost.reason), (0.0, Reason::NotDerived));
}

#[test]
fn motion_spreads_along_a_chain_at_rest() {
    let text = "Chain { coordinates { x[8]; }
        lagrangian = sum(i in 1..=8: dot(x[i])^2/2) - sum(i in 1..=7: (x[i+1] - x[i])^2/2); }";
    let models = dalembert_jit::load("chain", text).unwrap_or_else(|refused| panic!("{refused}"));
    let form = Arc::clone(&models[0].form);
    let until = 1.5;
    let found: Vec<Interval> = with_stack(|| {
        let chain = Erased::<16>::of(&form).unwrap();
        let start = |i: usize| Interval::point(f64::from(u8::from(i == 0)));
        let mut flow = CertifiedFlow::new(&chain, 0.0, start);
        flow.run(until).unwrap();
        (0..8).map(|i| flow.component(i)).collect()
    });
    // The modes of the chain are cosines of half-integer places.
    let mode = |k: usize, i: usize| (std::f64::consts::PI * (k * (2 * i + 1)) as f64 / 16.0).cos();
    for (i, range) in found.iter().enumerate() {
        let terms = (0..8).map(|k| {
            let square: f64 = (0..8).map(|j| mode(k, j) * mode(k, j)).sum();
            let frequency = 2.0 * (std::f64::consts::PI * k as f64 / 16.0).sin();
            mode(k, 0) * mode(k, i) / square * (frequency * until).cos()
        });
        let right: f64 = terms.sum();
        assert!(range.width() < 1e-13, "{i}: {range:?}");
        let apart = (range.middle() - right).abs();
        assert!(apart < 1e-13, "{i}: {range:?}, {right}");
    }
}
