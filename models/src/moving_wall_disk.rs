//! The vertical rolling disk on an elliptical table that moves: surfaces that depend on time.
//!
//! Facts: an elastic impact turns the rate of the gap, `dh(qdot) + d_t h`, and keeps the energy only where the edge is at rest:
//! it gains `-d_t h` times the impulse. Against an edge that comes the disk becomes faster.
//! Source: W. Clark and A. Bloch, Remark 5, on the disk of W. Clark, thesis, section 6.4.

dalembert::model_file!("src/moving_wall_disk.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{EventLog, Impacting, Scene, Simulation, System, Taylor, Tolerance};

    #[test]
    fn an_impact_turns_the_gap_rate_and_gains_what_the_edge_gives() {
        let disk = MovingWallDisk::default();
        let (phi, roll) = (-1.125_f64, 2.0);
        let qdot = [
            disk.R * phi.cos() * roll,
            disk.R * phi.sin() * roll,
            roll,
            1.0,
        ];
        let state = disk
            .state(0.0, &[-0.375, -0.1875, 0.0, phi].into(), &qdot.into())
            .unwrap();
        let stepper = Taylor::new(Tolerance::new(1e-13).unwrap());
        let mut log = EventLog::<_, 8>::new();
        Simulation::new(&disk, stepper, disk.effects())
            .run(0.0, state, 8.0, &mut log)
            .unwrap();
        assert_eq!(log.iter().count(), 8);
        for event in log.iter() {
            let (t, surface) = (event.t, event.surface);
            let [before, after] = [event.before, event.after].map(|state| {
                let rate = disk.gap_rates(t, &state).unwrap()[surface];
                (rate, disk.energy(t, &state).unwrap())
            });
            assert!((after.0 + before.0).abs() < 1e-12 * before.0.abs());
            // An impulse `P dh` gains `P (dh(qdot-) + dh(qdot+))/2`, and what the gap rate turns by is `P` times a positive number:
            // elastic, with `dh(qdot) = rate - d_t h`, it gains `-P d_t h`. At rest the gap rate is `d_t h`.
            let q = disk.position(&event.after);
            let still = disk.state(t, &q, &[0.0; 4].into()).unwrap();
            let own = disk.gap_rates(t, &still).unwrap()[surface];
            assert!((after.1 - before.1) * -own > 0.0);
        }
    }
}
