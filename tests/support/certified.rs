//! Certified runs of models loaded from their texts, compiled here once for all tests. References of many digits are
//! compared with their enclosures.

use core::ops::ControlFlow;

use dalembert::System;
use dalembert::certified::{
    CertifiedFlow, CertifiedImpact, CertifiedOrbit, CertifiedRun, CertifiedSection, Lost, NotProved,
};
use dalembert::extended::Extended;
use dalembert::numbers::Interval;
use dalembert_stability::course::vector;
use dalembert_stability::text::{Model, Text};

/// A walker on a slope whose foot slips, in dimensionless form (W. Clark, thesis, section 4.2).
pub static WALKER: Text = Text::new(
    "Walker {
        coordinates { theta; xi; eta; }
        parameters { mu > 0 = 5/2; eps > 0 = 1/2; alpha = 2/5; delta > 0 = 2/5; }
        let foot = eta + xi*cos(theta);
        let weight = mu/(1 + mu*sin(theta)^2);
        field {
            dot(theta) = eps*xi;
            dot(xi) = weight*(sin(theta)*(cos(alpha) - eps*xi^2*cos(theta)) - cos(theta)*foot);
            dot(eta) = sin(alpha) - foot;
        }
        impacts {
            step: theta >= -delta => reset {
                theta = theta + 2*delta;
                xi = cos(2*delta)*xi;
                eta = eta + cos(delta)*(1 - cos(2*delta))*xi;
            };
        }
    }",
);

/// A number of many digits.
///
/// # Panics
/// If it cannot be read.
pub fn digits(number: &str) -> Extended<3> {
    number.parse().expect("a number")
}

/// An interval of doubles that contains a decimal number.
///
/// # Panics
/// If the number cannot be read.
pub fn about(digits: &str) -> Interval {
    let nearest: f64 = digits.parse().expect("a number");
    Interval::new(nearest.next_down(), nearest.next_up())
}

/// True if a number of many digits lies between the ends of an interval.
pub fn holds(range: Interval, number: Extended<3>) -> bool {
    let [lo, hi] = [range.lo, range.hi].map(Extended::<3>::from);
    (number - lo).nearest() >= 0.0 && (hi - number).nearest() >= 0.0
}

/// The state with these positions and velocities.
///
/// # Panics
/// If the system refuses them.
pub fn state<S: System>(system: &S, q: &[f64], qdot: &[f64]) -> S::State {
    let state = system.state_unchecked(0.0, &vector(q), &vector(qdot));
    state.expect("a state")
}

/// Follows a certified run to a time, or until `see` breaks after an impact.
///
/// # Errors
/// Those of [`CertifiedRun::run`].
pub fn follow(
    run: &mut CertifiedRun<'_, Model>,
    until: f64,
    see: &mut dyn FnMut(&CertifiedImpact<Model>) -> ControlFlow<()>,
) -> Result<(), Lost> {
    run.run(until, see)
}

/// Follows a certified motion without impacts to a time.
///
/// # Errors
/// Those of [`CertifiedFlow::run`].
pub fn flow(flow: &mut CertifiedFlow<'_, Model>, until: f64) -> Result<(), Lost> {
    flow.run(until)
}

/// Proves that a periodic orbit exists near a state.
///
/// # Errors
/// Those of [`CertifiedSection::periodic`].
pub fn periodic(
    section: &CertifiedSection<'_, Model>,
    near: &[f64],
    radius: f64,
) -> Result<CertifiedOrbit<Model>, NotProved> {
    section.periodic(&vector(near), radius)
}
