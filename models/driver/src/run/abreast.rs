//! Many runs of one model in SIMD lanes.

use dalembert::lanes::{Member, run_abreast};
use dalembert::simulation::STEP_BUDGET;
use dalembert::{Observer, Taylor, Tolerance};

use super::{Bridge, Ending, Settings, Solved, Watch, effects, ending};
use crate::refusal::Refusal;
use crate::typed::{Model, point};

/// One of many runs: the model with its parameters, the initial state and the observer.
pub(crate) struct Abreast<'w, M: Model> {
    pub model: M,
    pub state: M::State,
    pub watch: &'w mut dyn Watch,
}

/// The integrator of all runs.
fn stepper<M: Model>(settings: &Settings) -> Result<Taylor<M>, Refusal> {
    let tolerance = Tolerance::new(settings.tol)?;
    Ok(limited!(Taylor::new(tolerance), settings))
}

/// Makes several runs as [`simulate`](super::simulate) does, at once and with Taylor series; returns the results in the
/// order of the runs.
pub(crate) fn simulate_abreast<M: Model>(
    runs: Vec<Abreast<'_, M>>,
    settings: &Settings,
    looks_inside: bool,
) -> Vec<Result<Ending, Refusal>> {
    let stepper = match stepper(settings) {
        Ok(stepper) => stepper,
        Err(refusal) => return runs.iter().map(|_| Err(refusal)).collect(),
    };
    let (models, watched): (Vec<M>, Vec<_>) = runs
        .into_iter()
        .map(
            |Abreast {
                 model,
                 state,
                 watch,
             }| (model, (state, watch)),
        )
        .unzip();
    let mut states = Vec::with_capacity(models.len());
    let mut bridges = Vec::with_capacity(models.len());
    for (model, (state, watch)) in models.iter().zip(watched) {
        states.push(state);
        bridges.push(Bridge {
            model,
            point: |t, state: &M::State| point(model, t, state),
            watch,
            balance: None,
        });
    }
    let mut endings: Vec<Option<Result<Ending, Refusal>>> = Vec::new();
    endings.resize_with(models.len(), || None);
    let members = bridges.iter_mut().enumerate().map(|(index, bridge)| {
        let model = bridge.model;
        let (effects, _) = effects(model, settings);
        let start = (0.0, states[index]);
        let observer: &mut dyn Observer<M> = bridge;
        Member::new(
            index,
            model,
            stepper,
            effects,
            observer,
            start,
            settings.until,
        )
        .with_step_budget(settings.steps.unwrap_or(STEP_BUDGET))
        .with_look_inside(looks_inside)
    });
    run_abreast(members, |index, run| {
        let model = &models[index];
        let ended = run.map_err(Refusal::from).map(|run| {
            let (_, laws) = effects(model, settings);
            let ends = [
                point(model, 0.0, &states[index]),
                point(model, run.t, &run.state),
            ];
            let solved = Solved {
                run,
                step: None,
                laws,
            };
            ending(ends, solved, settings)
        });
        endings[index] = Some(ended);
    });
    endings
        .into_iter()
        .map(|ended| ended.expect("every member ends"))
        .collect()
}
