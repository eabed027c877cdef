//! The two ends of a step, and where it is cut: what integrators keep of a step besides its stages.

use super::instant::Instant;
use super::precise::Precise;
use crate::state::StateVector;

/// Start and end of the last step.
#[derive(Debug, Clone, Copy)]
pub struct Ends<S> {
    pub(super) t: [Instant; 2],
    pub(super) start: Precise<S>,
    pub(super) end: Precise<S>,
    /// Where the step was cut, until the next begins.
    cut: Option<Precise<S>>,
}

impl<S: StateVector> Ends<S> {
    /// No step yet, of states that [`Ends::place`] brings.
    pub(super) fn new() -> Self {
        let zeros = Precise::new(S::zeros(0));
        Self {
            t: [Instant::default(); 2],
            start: zeros,
            end: zeros,
            cut: None,
        }
    }

    /// A step of no length.
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

    /// Puts the last good state back in place after a failure.
    #[inline(always)]
    pub(super) fn retract(&mut self) {
        self.t[1] = self.t[0];
        self.end = self.start;
    }

    #[inline(always)]
    pub(super) fn length(&self) -> f64 {
        self.t[1].since(self.t[0])
    }

    /// A state to begin again with, and what the components that it shares with the last cut were rounded off there.
    #[inline(always)]
    pub(super) fn kept(&self, state: &S) -> Precise<S> {
        self.cut.as_ref().unwrap_or(&self.end).kept(state)
    }

    /// Cuts a step of this length at a part of it, where the state is `inside` unless it is the end.
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
