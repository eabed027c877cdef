//! The sampled motion: propagation of small deviations from one sample to the next, across impacts, with inputs
//! constant between samples.

use std::ops::ControlFlow;

use dalembert::contract::Variational;
use dalembert::integrate::{Chosen, Taylor};
use dalembert::law::Law;
use dalembert::{
    Event, Hold, Instance, Observer, Outcome, Policies, Scene, SceneEffects, Segment, Simulation,
    Tolerance, Variations,
};

use super::sample::Plant;
use super::{Unlinear, split};

/// Request for a sampled motion.
#[derive(Debug, Clone)]
pub struct Sampling {
    /// Time between samples.
    pub every: f64,
    /// Number of samples after the first.
    pub count: u32,
    /// The tolerance of the integrator, `Taylor`.
    pub tolerance: Tolerance,
    /// Laws that replace the declared ones, by index of the surface. The last entry for a surface counts.
    pub laws: Vec<(usize, Law)>,
    /// Policies of impacts after which the law alone does not determine the motion.
    pub policies: Policies,
}

/// The motion from one sample to the next: `y(t + T) = Phi y(t) + Gamma u` for small deviations `y` of the state and
/// `u` of the inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Stride {
    /// The time of the sample.
    pub t: f64,
    /// Time of the next sample.
    pub until: f64,
    /// The state at the sample.
    pub state: Vec<f64>,
    /// The state at the next sample.
    pub next: Vec<f64>,
    /// `Phi`, row by row.
    pub phi: Vec<Vec<f64>>,
    /// `Gamma`, row by row.
    pub gamma: Vec<Vec<f64>>,
    /// Number of impacts in between.
    pub impacts: u32,
}

/// Propagates variations along a motion and counts its impacts.
struct Counted<'a, S: Variational> {
    variations: Variations<'a, S>,
    impacts: u32,
}

impl<S: Variational> Observer<S> for Counted<'_, S> {
    fn step(&mut self, segment: &mut Segment<'_, S::State>) -> ControlFlow<()> {
        self.variations.step(segment)
    }

    fn event(&mut self, event: &Event<S::State>) -> ControlFlow<()> {
        self.impacts += 1;
        self.variations.event(event)
    }

    fn hold(&mut self, hold: &Hold<S::State>) -> ControlFlow<()> {
        self.variations.hold(hold)
    }
}

/// The strides of the motion from a state.
///
/// # Errors
/// [`Unlinear::Ended`] if the motion ends early, [`Unlinear::Undefined`] if it has no derivative, and
/// [`Unlinear::Fault`] or [`Unlinear::NotFinite`] if a state does not exist.
pub(super) fn strides<S: Instance + Scene + Variational>(
    plant: &Plant<'_, S>,
    sampling: &Sampling,
    state: &[f64],
    inputs: &[f64],
) -> Result<Vec<Stride>, Unlinear> {
    let mut strides: Vec<Stride> = Vec::new();
    let mut state = state.to_vec();
    for index in 0..sampling.count {
        let span = [index, index + 1].map(|k| plant.t + sampling.every * f64::from(k));
        let stride = stride(plant, sampling, (&state, inputs), span)?;
        state.clone_from(&stride.next);
        strides.push(stride);
    }
    Ok(strides)
}

fn stride<S: Instance + Scene + Variational>(
    plant: &Plant<'_, S>,
    sampling: &Sampling,
    (state, inputs): (&[f64], &[f64]),
    [t, until]: [f64; 2],
) -> Result<Stride, Unlinear> {
    let system = plant.system;
    let (start, mut tangents) = plant.varied(t, state, inputs)?;
    let mut effects = system.effects();
    for &(surface, law) in &sampling.laws {
        effects.set_law(surface, law);
    }
    effects.set_policies(sampling.policies);
    let mut stepper = Taylor::new(sampling.tolerance);
    let mut simulation = Simulation::new(system, Chosen::new(&mut stepper), effects);
    let mut counted = Counted {
        variations: Variations::new(system, &mut tangents),
        impacts: 0,
    };
    let mut observer: &mut dyn Observer<S> = &mut counted;
    let run = simulation.run(t, start, until, &mut observer);
    let run = run.map_err(|_| Unlinear::NotFinite)?;
    if run.outcome != Outcome::Done {
        return Err(Unlinear::Ended {
            t: run.t,
            outcome: run.outcome,
        });
    }
    let impacts = counted.impacts;
    let tangents = counted.variations.tangents()?;
    let (next, slopes) = plant.components(until, &run.state, tangents)?;
    let [phi, gamma] = split(&slopes, state.len());
    Ok(Stride {
        t,
        until,
        state: state.to_vec(),
        next,
        phi,
        gamma,
        impacts,
    })
}
