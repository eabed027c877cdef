//! A point mass on two massless springs for legs that walks: single and double support, with coordinates of their own.
//!
//! Facts: a leg lands and leaves at its rest length, so that nothing is lost and the energy is constant from step to step; in
//! double support two springs push. Source: H. Geyer, A. Seyfarth and R. Blickhan, *Compliant leg behaviour explains basic dynamics of
//! walking and running* (2006); W. Clark, thesis, section 2.3, for systems of this kind.

dalembert::model_file!("src/spring_mass_walker.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, EventLog, Outcome, Scene, Simulation, System, Tolerance};

    #[test]
    fn it_walks_and_keeps_its_energy() {
        let walker = SpringMassWalker::default();
        let initial = dalembert::Instance::initial(&walker);
        let state = walker.state(0.0, &initial.q, &initial.qdot).unwrap();
        let energy = walker.energy(0.0, &state).unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-12).unwrap());
        let mut changes = EventLog::<_, 32>::new();
        let run = Simulation::new(&walker, stepper, walker.effects())
            .run(0.0, state, 8.0, &mut changes)
            .unwrap();
        assert_eq!(run.outcome, Outcome::Done);
        assert!(changes.iter().count() >= 4);
        for (n, event) in changes.iter().enumerate() {
            assert_eq!(walker.mode(&event.after), 1 - n % 2);
            let after = walker.energy(event.t, &event.after).unwrap();
            assert!((after - energy).abs() < 1e-11, "{after} is not {energy}");
        }
    }
}
