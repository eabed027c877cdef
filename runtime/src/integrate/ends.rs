//! The two ends of a step and its cut: the data of a step that integrators keep besides its stages.

use super::instant::Instant;
use super::precise::Precise;
use crate::state::StateVector;

/// Start and end of the last step.
#[derive(Debug, Clone, Copy)]
pub struct Ends<S> {
    pub(super) t: [Instant; 2],
    pub(super) start: Precise<S>,
    pub(super) end: Precise<S>,
    /// State at the last cut of a step, until the integration restarts.
    cut: Option<Precise<S>>,
}

impl<S: StateVector> Ends<S> {
    /// Ends before the first step; [`Ends::place`] sets the states.
    pub(super) fn new() -> Self {
        let zeros = Precise::new(S::zeros(0));
        Self {
            t: [Instant::default(); 2],
            start: zeros,
            end: zeros,
            cut: None,
        }
    }

    /// Sets a step of length 0.
    #[inline(always)]
    pub(super) fn place(&mut self, now: Instant, precise: Precise<S>) {
        *self = Self {
            t: [now; 2],
            start: precise,
            end: precise,
            cut: None,
        };
    }

    /// The end of the last step becomes the start of the next.
    #[inline(always)]
    pub(super) fn move_on(&mut self) {
        self.t[0] = self.t[1];
        self.start = self.end;
    }

    /// Restores the last good state after a failure.
    #[inline(always)]
    pub(super) fn retract(&mut self) {
        self.t[1] = self.t[0];
        self.end = self.start;
    }

    #[inline(always)]
    pub(super) fn length(&self) -> f64 {
        self.t[1].since(self.t[0])
    }

    /// The state from which the integration restarts. Components equal to those of the last cut keep their rounding
    /// errors.
    #[inline(always)]
    pub(super) fn kept(&self, state: &S) -> Precise<S> {
        self.cut.as_ref().unwrap_or(&self.end).kept(state)
    }

    /// Cuts a step of this length at the fraction `theta`. `inside` gives the state there if it is not the end.
    #[inline(always)]
    pub(super) fn cut(
        &mut self,
        theta: f64,
        length: f64,
        inside: impl FnOnce() -> Precise<S>,
    ) -> (Instant, S) {
        let (now, state) = match theta >= 1.0 {
            true => (self.t[1], self.end),
            false => (self.t[0].after(theta * length), inside()),
        };
        self.cut = Some(state);
        (now, state.value)
    }
}
