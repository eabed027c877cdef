//! Energy balance of a run with steps of fixed size. Such steps have no error estimate, but the balance reveals large
//! errors.
//!
//! Along smooth motion, the energy changes at the rate of the power. The power is 0 unless a force does work or the
//! Lagrangian depends on time. Any other change is an error. The power is integrated by the trapezoidal rule. With equal
//! steps its leading error depends on the power at the ends of a smooth stretch, not on the number of steps.

use dalembert::{Segment, StateVector, System};

/// Relative energy error that causes a warning.
const TOLD: f64 = 1e-2;

/// Lower bound of the energy scale, as a fraction of the largest kinetic energy. It gives a scale to an energy that is
/// 0 up to rounding.
const SWING: f64 = 1e-3;

/// Fraction of a step over which the power is computed as a difference quotient of energies. Rounding adds an error of
/// `1e-11` of the energy in every step.
const PART: f64 = 1e-5;

/// The energy balance along smooth motion; impacts and motion held by a surface are left out.
#[derive(Debug, Clone, Copy)]
pub(super) struct Balance {
    /// The absolute value of the energy at the start, or the kinetic energy at the start if it is larger.
    size: f64,
    /// The largest kinetic energy.
    swing: f64,
    /// The sum of the absolute values of the work in each step.
    work: f64,
    /// The error so far.
    error: f64,
    /// The largest error, and its time.
    largest: f64,
    at: f64,
    /// Energy and power at the end of the last step, unless an event happened there.
    last: Option<Known>,
    /// Number of surfaces that hold the motion.
    holds: usize,
}

/// Energy and power.
#[derive(Debug, Clone, Copy)]
struct Known {
    energy: f64,
    power: f64,
}

impl Balance {
    /// The balance of a run that starts in this state; `None` if the energy does not exist there.
    pub(super) fn of<M: System>(model: &M, t: f64, state: &M::State) -> Option<Self> {
        let energy = model.energy(t, state).ok().filter(|it| it.is_finite())?;
        let kinetic = kinetic(model, t, state);
        Some(Self {
            size: energy.abs().max(kinetic),
            swing: kinetic,
            work: 0.0,
            error: 0.0,
            largest: 0.0,
            at: t,
            last: None,
            holds: 0,
        })
    }

    /// Adds a stretch of motion.
    pub(super) fn follow<M: System>(&mut self, model: &M, segment: &Segment<'_, M::State>) {
        if self.holds > 0 {
            return;
        }
        let (start, end) = (segment.t_start(), segment.t_end());
        let length = end - start;
        let before = self
            .last
            .unwrap_or_else(|| known(model, start, segment.start(), length));
        let after = known(model, end, segment.end(), length);
        self.last = Some(after);
        let work = 0.5 * length * (before.power + after.power);
        let error = after.energy - before.energy - work;
        // Without a finite power the step is skipped.
        if !error.is_finite() {
            return;
        }
        self.error += error;
        self.work += work.abs();
        self.swing = self.swing.max(kinetic(model, end, segment.end()));
        if self.error.abs() > self.largest {
            (self.largest, self.at) = (self.error.abs(), end);
        }
    }

    /// Records that an event changed the state.
    pub(super) fn jump(&mut self) {
        self.last = None;
    }

    /// Records that a surface begins or ceases to hold the motion.
    pub(super) fn hold(&mut self, begins: bool) {
        self.last = None;
        self.holds = match begins {
            true => self.holds + 1,
            false => self.holds.saturating_sub(1),
        };
    }

    /// The largest error, its time, and its fraction of the energy scale; `None` if that fraction is at most [`TOLD`].
    pub(super) fn told(&self) -> Option<(f64, f64, f64)> {
        let size = self.size.max(self.work).max(SWING * self.swing);
        let part = self.largest / size;
        (part > TOLD).then_some((self.largest, self.at, part))
    }
}

fn known<M: System>(model: &M, t: f64, state: &M::State, length: f64) -> Known {
    let energy = |t: f64, state: &M::State| model.energy(t, state).unwrap_or(f64::NAN);
    let mut rate = model.zero_state();
    if model.rate(t, state, &mut rate).is_err() {
        return Known {
            energy: energy(t, state),
            power: f64::NAN,
        };
    }
    let after = |time: f64| {
        let mut moved = *state;
        for (value, rate) in moved.as_mut_slice().iter_mut().zip(rate.as_slice()) {
            *value += time * rate;
        }
        energy(t + time, &moved)
    };
    let time = PART * length;
    Known {
        energy: energy(t, state),
        power: (after(time) - after(-time)) / (2.0 * time),
    }
}

/// Half the product of momentum and velocity.
fn kinetic<M: System>(model: &M, t: f64, state: &M::State) -> f64 {
    match (model.momentum(t, state), model.velocity(t, state)) {
        (Ok(p), Ok(qdot)) => {
            let products = p.as_slice().iter().zip(qdot.as_slice());
            0.5 * products.map(|(p, v)| p * v).sum::<f64>().abs()
        }
        _ => 0.0,
    }
}
