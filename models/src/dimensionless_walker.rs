//! A walker on a slope whose foot slips, in dimensionless form: a first-order system.
//!
//! `theta` is the angle of the stance leg, `xi` its scaled rate, `eta` the scaled velocity of the hip along the slope; friction
//! at the foot is proportional to its velocity. When the other foot comes down, at `theta = -delta`, legs change their parts.
//!
//! Facts: for the declared parameters one step repeats itself after 1.54496586406140337, from
//! `(xi, eta) = (-0.902057449429909745, 0.991308369223558489)` after a step.
//! Source: W. Clark, thesis, section 4.2, equations (4.8) to (4.11); in (4.11) `eps xi^2 cos(theta)` is subtracted.

dalembert::model_file!("src/dimensionless_walker.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Scene, Simulation, System, Tolerance};

    #[test]
    fn a_step_repeats_itself() {
        let walker = DimensionlessWalker::default();
        let start = [
            walker.delta,
            -0.902_057_449_429_909_7,
            0.991_308_369_223_558_5,
        ];
        let stepper = Dop853::new(Tolerance::new(1e-13).unwrap());
        let state = walker.state(0.0, &start.into(), &[0.0; 3].into()).unwrap();
        // A little after the step.
        let run = Simulation::new(&walker, stepper, walker.effects())
            .run(0.0, state, 1.544_965_864_061_404, &mut ())
            .unwrap();
        assert!(run.counters.impacts <= 1);
        let angle =
            run.state[0] + walker.delta * if run.counters.impacts == 0 { 1.0 } else { -1.0 };
        assert!(angle.abs() < 1e-12);
    }
}
