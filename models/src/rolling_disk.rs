//! The vertical rolling disk on an elliptical table, a billiard with both edges of the disk.
//!
//! Facts: between impacts `dot(theta)` and `dot(phi)` are constant and the point of contact runs on a circle of
//! radius `|R dot(theta)/dot(phi)|`; on a circular table they alternate between two pairs of values.
//! Source: W. Clark, thesis, section 6.4 (Figures 6.2 to 6.4: `ta = tb = 0.2` and `ta = 0.15`).

dalembert::model! {
    /// Vertical rolling disk on an elliptical table (W. Clark, thesis, section 6.4).
    pub RollingDisk {
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
            m > 0 = 0.0025;
            /// Radius.
            R > 0 = 0.01;
            /// Moment of inertia about the axis.
            I > 0 = 1.25e-7;
            /// Moment of inertia about a diameter.
            J > 0 = 6.25e-8;
            /// Half axis of the table along x.
            ta > 0 = 0.15;
            /// Half axis of the table along y.
            tb > 0 = 0.20;
        }
        let table(u, v) = 1 - u^2/ta^2 - v^2/tb^2;
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + J/2*dot(phi)^2;
        constraints {
            /// The point of contact does not slip along x.
            rolling_x: d(x) - R*cos(phi)*d(theta) = 0;
            /// The point of contact does not slip along y.
            rolling_y: dot(y) = R*sin(phi)*dot(theta);
        }
        frame { roll: d(theta); turn: d(phi); }
        impacts {
            /// The end of the disk towards `(cos phi, sin phi)` stays above the table.
            leading_edge: table(x + R*cos(phi), y + R*sin(phi)) >= 0;
            /// The opposite end stays above the table.
            trailing_edge: table(x - R*cos(phi), y - R*sin(phi)) >= 0;
        }
        scenes {
            /// An unbounded plane.
            free;
        }
        initial { phi = pi/2; dot(theta) = 10; dot(phi) = 0.2; until = 20; }
        view { path: (x, y); region: table(x, y) >= 0; }
        claims {
            density: exact;
            conserved: energy;
            conserved: dot(theta);
            conserved: dot(phi);
            conserved under leading_edge: energy;
            symmetry: partial(phi) - y*partial(x) + x*partial(y);
        }
        claims for free { conserved: dot(theta); }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Simulation, System, Tolerance};

    #[test]
    fn the_contact_point_runs_on_a_circle() {
        let disk = RollingDisk::default();
        let (roll, turn) = (10.0, 2.0);
        let qdot = [0.0, disk.R * roll, roll, turn].into();
        let start = core::f64::consts::FRAC_PI_2;
        let state = disk
            .state(0.0, &[0.0, 0.0, 0.0, start].into(), &qdot)
            .unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-13).unwrap());
        let run = Simulation::new(&disk, stepper, ())
            .run(0.0, state, 3.0, &mut ())
            .unwrap();
        let (radius, phi) = (disk.R * roll / turn, start + 3.0 * turn);
        assert!((run.state[0] - radius * (phi.sin() - start.sin())).abs() < 1e-12);
        assert!((run.state[1] + radius * (phi.cos() - start.cos())).abs() < 1e-12);
    }
}
