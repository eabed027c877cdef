//! Many runs of one model in SIMD lanes.

use dalembert::lanes::{Member, run_abreast};
use dalembert::simulation::STEP_BUDGET;
use dalembert::{Fault, Observer, Run, Taylor, Tolerance};

use super::{Bridge, Ending, Integrals, Settings, Solved, Watch, effects, ending};
use crate::model::{Together, point};
use crate::refusal::Refusal;
use crate::typed::{Model, prepare};

/// One of many runs: the model with its parameters, the initial state and the observer.
struct Abreast<'w, M: Model> {
    model: M,
    state: M::State,
    watch: &'w mut dyn Watch,
}

/// The integrator of all runs.
fn stepper<M: Model>(settings: &Settings) -> Result<Taylor<M>, Refusal> {
    let tolerance = Tolerance::new(settings.tol)?;
    Ok(limited!(Taylor::new(tolerance), settings))
}

fn set_parameters<M: Model>(model: &mut M, values: &[f64]) {
    for (index, value) in values.iter().enumerate() {
        model.set_parameter(index, *value);
    }
}

/// Makes several runs at once of `system`, a form of the model. A run without a valid initial state gives its [`Refusal`].
pub(crate) fn abreast<G: Model, S: Model>(
    general: &dyn Fn() -> Result<G, Fault>,
    system: &S,
    runs: Vec<Together<'_>>,
    settings: &Settings,
    looks_inside: bool,
) -> Vec<Result<Ending, Refusal>> {
    let mut refused = Vec::new();
    let mut begun = Vec::new();
    for (index, run) in runs.into_iter().enumerate() {
        let mut model = system.clone();
        set_parameters(&mut model, &run.parameters);
        let general = || {
            let mut model = general()?;
            set_parameters(&mut model, &run.parameters);
            Ok(model)
        };
        match prepare(general, &model, 0.0, &run.origin) {
            Ok(state) => begun.push(Abreast {
                model,
                state,
                watch: run.watch,
            }),
            Err(error) => refused.push((index, error)),
        }
    }
    let mut endings = simulate_abreast(begun, settings, looks_inside);
    for (index, error) in refused {
        endings.insert(index, Err(error.into()));
    }
    endings
}

/// Makes several runs at once with `Taylor`, each as [`simulate`](super::simulate) does. Returns the results in the
/// order of the runs.
fn simulate_abreast<M: Model>(
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
            reading: model,
            integrals: Integrals::of(model),
            watch,
            balance: None,
            reach: None,
        });
    }
    let looks_inside = looks_inside || bridges.iter().any(|bridge| bridge.integrals.is_some());
    let mut ended: Vec<Option<Result<Run<M::State>, Refusal>>> = Vec::new();
    ended.resize_with(models.len(), || None);
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
        ended[index] = Some(run.map_err(Refusal::from));
    });
    let endings = ended.into_iter().zip(&bridges).zip(&states);
    endings
        .map(|((ended, bridge), first)| {
            let run = ended.expect("every member ends")?;
            let (_, laws) = effects(bridge.model, settings);
            let ends = [
                Integrals::of(bridge.model).put(point(bridge.model, 0.0, first)),
                bridge.point(run.t, &run.state),
            ];
            let solved = Solved {
                run,
                step: None,
                laws,
            };
            Ok(ending(ends, solved, settings))
        })
        .collect()
}
