//! A loaded model is freed with its last owner, and may be used from several threads.
#![cfg(target_os = "linux")]
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::thread;

use dalembert::erased::{Erased, Form, Global, Shared};
use dalembert::state::StateVector;
use dalembert::{Impacting, Instance, System, VectorField};

/// Number of models that are loaded and dropped before memory is measured.
const FIRST: usize = 50;

/// Least memory of a leaked model, in bytes: that of the smallest form.
const LEAST: usize = 20 << 10;

/// Lock of the tests, which must run one at a time: memory is measured for the whole process.
static ALONE: Mutex<()> = Mutex::new(());

/// A small model. The name of its parameter and its numbers differ from those of all other models.
fn text(number: usize) -> String {
    format!(
        "Ball {{
            coordinates {{ x; y; }}
            parameters {{ g_{number} > 0 = 9.{number}; }}
            lagrangian = (dot(x)^2 + dot(y)^2)/2 - g_{number}*y - {number}.5*x^2;
            impacts {{ floor: y >= 0 => restitution(1/2); }}
            outputs {{ height: {number}.5*y; }}
            initial {{ y = 1; }}
        }}"
    )
}

/// Loads, evaluates and drops a model.
fn load(number: usize) {
    let models = dalembert_jit::load("ball.dal", &text(number)).unwrap();
    let ball = Erased::<4>::of(&models[0].form).unwrap();
    let start = ball.initial();
    let state = ball.state(0.0, &start.q, &start.qdot).unwrap();
    let mut rate = ball.zero_state();
    ball.rate(0.0, &state, &mut rate).unwrap();
    ball.energy(0.0, &state).unwrap();
}

/// Resident memory of the process, in bytes.
fn resident() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kilobytes = line.unwrap().trim().trim_end_matches(" kB");
    kilobytes.parse::<usize>().unwrap() << 10
}

/// Growth of memory while models are loaded and dropped, after the first ones.
fn growth(count: usize) -> usize {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    (0..FIRST).for_each(load);
    let before = resident();
    (FIRST..FIRST + count).for_each(load);
    resident().saturating_sub(before)
}

#[test]
fn models_are_freed() {
    let count = 300;
    let growth = growth(count);
    println!("{growth} bytes for {count} models");
    assert!(growth < count * LEAST / 4, "{growth} bytes");
}

#[test]
#[ignore = "nightly: ten thousand models"]
fn memory_stays_while_ten_thousand_models_are_loaded_and_dropped() {
    let growth = growth(10_000);
    assert!(growth < 4 << 20, "{growth} bytes");
}

/// Bits of the ball's gap, gap rate and energy along a motion in many small steps.
fn motion(form: &Form) -> Vec<u64> {
    let ball = Erased::<4>::of(form).unwrap();
    let start = ball.initial();
    let mut state = ball.state(0.0, &start.q, &start.qdot).unwrap();
    let mut rate = ball.zero_state();
    let mut bits = Vec::new();
    for _ in 0..10_000 {
        ball.rate(0.0, &state, &mut rate).unwrap();
        for (value, rate) in state.as_mut_slice().iter_mut().zip(rate.as_slice()) {
            *value += 1e-4 * rate;
        }
        let gap = ball.gaps(0.0, &state).as_slice()[0];
        let gap_rate = ball.gap_rates(0.0, &state).unwrap().as_slice()[0];
        let energy = ball.energy(0.0, &state).unwrap();
        bits.extend([gap, gap_rate, energy].map(f64::to_bits));
    }
    bits
}

#[test]
fn threads_share_a_model_whose_loading_handle_is_dropped() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let models = dalembert_jit::load("ball.dal", &text(0)).unwrap();
    let expected = motion(&models[0].form);
    let forms: [Arc<Form>; 4] = core::array::from_fn(|_| Arc::clone(&models[0].form));
    let left = Arc::downgrade(&models[0].form);
    drop(models);
    let found = forms.map(|form| thread::spawn(move || motion(&form)));
    for found in found.map(|thread| thread.join().unwrap()) {
        assert!(found == expected, "bits differ");
    }
    assert!(left.upgrade().is_none(), "the form has an owner");
}

#[test]
fn forms_of_scenes_modes_and_reduced_systems_are_freed() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    for text in [
        include_str!("../../models/src/rolling_disk.dal"),
        include_str!("../../models/src/spring_mass_walker.dal"),
        include_str!("../../models/src/rolling_ball_wall.dal"),
    ] {
        let models = dalembert_jit::load("shipped", text).unwrap();
        let mut forms: Vec<Weak<Form>> = Vec::new();
        for model in &models {
            forms.push(Arc::downgrade(&model.form));
            forms.extend(model.scenes.iter().map(|(_, form)| Arc::downgrade(form)));
        }
        let others = models.iter().flat_map(|model| {
            let global = match &model.form.global {
                Global::Another(Shared::Counted(form)) => Some(form),
                _ => None,
            };
            let modes = model.form.forms.iter().filter_map(|form| match form {
                Shared::Counted(form) => Some(form),
                Shared::Static(_) => None,
            });
            modes.chain(global)
        });
        forms.extend(others.map(Arc::downgrade));
        assert!(forms.len() > 1, "a form with others");
        drop(models);
        assert!(forms.iter().all(|form| form.strong_count() == 0));
    }
}
