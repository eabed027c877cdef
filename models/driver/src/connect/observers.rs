//! Observers of the motions of a search.

use std::ops::ControlFlow;

use dalembert::contract::Variational;
use dalembert::variations::Tangent;
use dalembert::{Action, Event, Hold, Instance, Observer, Segment, StateVector, Variations};

use super::Bounce;
use crate::model::point;

/// Records the impacts of a run, and propagates variations on request.
pub(crate) struct Marksman<'a, S: Variational> {
    pub variations: Option<Variations<'a, S>>,
    pub hits: Vec<(f64, usize)>,
}

impl<S: Variational> Observer<S> for Marksman<'_, S> {
    fn step(&mut self, segment: &mut Segment<'_, S::State>) -> ControlFlow<()> {
        match &mut self.variations {
            Some(variations) => variations.step(segment),
            None => ControlFlow::Continue(()),
        }
    }

    fn event(&mut self, event: &Event<S::State>) -> ControlFlow<()> {
        self.hits.push((event.t, event.surface));
        match &mut self.variations {
            Some(variations) => variations.event(event),
            None => ControlFlow::Continue(()),
        }
    }

    fn hold(&mut self, hold: &Hold<S::State>) -> ControlFlow<()> {
        match &mut self.variations {
            Some(variations) => variations.hold(hold),
            None => ControlFlow::Continue(()),
        }
    }
}

/// Records the action and the impacts of a run.
pub(super) struct Film<'a, S> {
    pub system: &'a S,
    pub action: Action<'a, S>,
    pub bounces: Vec<Bounce>,
}

impl<S: Instance> Observer<S> for Film<'_, S> {
    fn step(&mut self, segment: &mut Segment<'_, S::State>) -> ControlFlow<()> {
        self.action.step(segment)
    }

    fn event(&mut self, event: &Event<S::State>) -> ControlFlow<()> {
        self.bounces.push(Bounce {
            t: event.t,
            surface: event.surface,
            before: point(self.system, event.t, &event.before),
            after: point(self.system, event.t, &event.after),
        });
        ControlFlow::Continue(())
    }
}

/// The end of a step: time, state, and the derivatives of the state with respect to the unknowns.
pub(crate) struct Stand<S> {
    pub t: f64,
    pub state: S,
    pub columns: Vec<Vec<f64>>,
    /// True if an impact follows.
    pub is_cut: bool,
}

/// Records the state and its derivatives at the end of every step.
pub(crate) struct Determinants<'a, S: Variational> {
    pub variations: Variations<'a, S>,
    pub states: Vec<Stand<S::State>>,
}

impl<S: Variational> Observer<S> for Determinants<'_, S> {
    fn step(&mut self, segment: &mut Segment<'_, S::State>) -> ControlFlow<()> {
        self.variations.step(segment)?;
        let (t, state) = (segment.t_end(), *segment.end());
        match self.variations.tangents() {
            Ok(tangents) => {
                let column = |tangent: &Tangent<S>| tangent.state.as_slice().to_vec();
                self.states.push(Stand {
                    t,
                    state,
                    columns: tangents.iter().map(column).collect(),
                    is_cut: false,
                });
                ControlFlow::Continue(())
            }
            Err(_) => ControlFlow::Break(()),
        }
    }

    fn event(&mut self, event: &Event<S::State>) -> ControlFlow<()> {
        if let Some(stand) = self.states.last_mut() {
            stand.is_cut = true;
        }
        self.variations.event(event)
    }

    fn hold(&mut self, hold: &Hold<S::State>) -> ControlFlow<()> {
        self.variations.hold(hold)
    }
}
