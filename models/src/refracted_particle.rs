//! A particle that crosses the line `x = 0`, where mass and potential change: Snell's law.
//!
//! Facts: the momentum along the line stays, the energy stays; where there is not enough of it the particle is reflected.
//! Sources: J. Cortes and A. Vinogradov, section 4.5.2; W. Clark and A. Bloch, section 3.5.

dalembert::model_file!("src/refracted_particle.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Outcome, Scene, Simulation, System, Tolerance};

    /// Without a difference nothing happens, to the last bit.
    #[test]
    fn between_equal_media_nothing_happens() {
        let particle = RefractedParticle {
            m2: 1.0,
            ..RefractedParticle::default()
        };
        let state = particle
            .state(0.0, &[-1.0, 0.3].into(), &[0.7, 0.4].into())
            .unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-12).unwrap());
        let run = Simulation::new(&particle, stepper, particle.effects())
            .run(0.0, state, 3.0, &mut ())
            .unwrap();
        assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 1));
        let p = particle.momentum(3.0, &run.state).unwrap();
        assert_eq!((p[0], p[1]), (0.7, 0.4));
    }
}
