//! The vertical rolling disk on an elliptical table that moves: surfaces that depend on time.
//!
//! Facts: an elastic impact turns the rate of the gap, `dh(qdot) + d_t h`, and keeps the energy only where the edge is at rest:
//! it gains `-d_t h` times the impulse. Against an edge that comes the disk becomes faster.
//! Source: W. Clark and A. Bloch, Remark 5, on the disk of W. Clark, thesis, section 6.4.

dalembert::model! {
    /// Vertical rolling disk on an elliptical table that moves with constant velocity (W. Clark and A. Bloch, Remark 5).
    pub MovingWallDisk {
        coordinates {
            /// Point of contact.
            x;
            /// Point of contact.
            y;
            /// Angle of rolling.
            theta: angle;
            /// Direction of rolling.
            phi: angle;
        }
        parameters {
            /// Mass.
            m > 0 = 3/2;
            /// Radius.
            R > 0 = 1/4;
            /// Moment of inertia about the axis.
            I > 0 = 1/5;
            /// Moment of inertia about a diameter.
            J > 0 = 1/8;
            /// Half axis of the table along x.
            ta > 0 = 2;
            /// Half axis of the table along y.
            tb > 0 = 3/2;
            /// Velocity of the table along x.
            wx = 1/2;
            /// Velocity of the table along y.
            wy = -1/4;
        }
        let table(u, v) = 1 - (u - wx*t)^2/ta^2 - (v - wy*t)^2/tb^2;
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + J/2*dot(phi)^2;
        constraints {
            /// The point of contact does not slip along x.
            rolling_x: d(x) - R*cos(phi)*d(theta) = 0;
            /// The point of contact does not slip along y.
            rolling_y: d(y) - R*sin(phi)*d(theta) = 0;
        }
        impacts {
            /// The end of the disk towards `(cos phi, sin phi)` stays above the table.
            leading_edge: table(x + R*cos(phi), y + R*sin(phi)) >= 0;
            /// The opposite end stays above the table.
            trailing_edge: table(x - R*cos(phi), y - R*sin(phi)) >= 0;
        }
        initial {
            x = -3/8;
            y = -3/16;
            phi = -9/8;
            dot(theta) = 2;
            dot(phi) = 1;
            until = 8;
        }
        view { path: (x - wx*t, y - wy*t); }
    }
}

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
