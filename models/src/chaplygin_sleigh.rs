//! The Chaplygin sleigh on an elliptical table, a billiard with both tips of the blade.
//!
//! Facts: with `K = I + m a^2` the free sleigh has `v = V tanh(s t + c)`, `omega = sqrt(2E/K) sech(s t + c)`,
//! `V = sqrt(2E/m)`, `s = a m V/K`: it always ends with its centre of mass ahead.
//! Source: W. Clark, thesis, section 7.5; W. Clark and A. Bloch, section 8.1.

dalembert::model! {
    /// Chaplygin sleigh: a knife edge at (x, y), the centre of mass a distance `a` ahead of it.
    pub ChaplyginSleigh {
        coordinates { x; y; theta: angle; }
        parameters {
            /// Mass.
            m > 0 = 1;
            /// Moment of inertia about the centre of mass.
            I > 0 = 1;
            /// Signed distance from the knife edge to the centre of mass.
            a = 0.2;
            /// Distance from the knife edge to either tip.
            len > 0 = 0.25;
            /// Half axis of the table along x.
            ta > 0 = 2;
            /// Half axis of the table along y.
            tb > 0 = 1;
        }
        let table(u, v) = 1 - u^2/ta^2 - v^2/tb^2;
        let slip = -dot(x)*sin(theta) + dot(y)*cos(theta);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I + m*a^2)/2*dot(theta)^2 + a*m*dot(theta)*slip;
        constraints { blade: -sin(theta)*d(x) + cos(theta)*d(y) = 0; }
        frame { v: cos(theta)*d(x) + sin(theta)*d(y); omega: d(theta); }
        impacts {
            front_tip: table(x + len*cos(theta), y + len*sin(theta)) >= 0;
            back_tip: table(x - len*cos(theta), y - len*sin(theta)) >= 0;
        }
        initial { theta = 0.5; dot(x) = 0.8775825618903728; dot(y) = 0.479425538604203; dot(theta) = 0.5; until = 40; }
        view { path: (x, y); region: table(x, y) >= 0; }
        outputs { forward_speed: dot(x)*cos(theta) + dot(y)*sin(theta); side_force: multiplier(blade); }
        claims {
            density: none;
            density = 1/abs(dot(theta));
            conserved: energy;
            conserved under front_tip: energy;
            not conserved under front_tip: dot(theta);
            symmetry: partial(theta) - y*partial(x) + x*partial(y);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Simulation, System, Tolerance};

    #[test]
    fn the_free_sleigh_follows_tanh_and_sech() {
        let sleigh = ChaplyginSleigh {
            m: 1.3,
            I: 0.7,
            a: 0.4,
            ..ChaplyginSleigh::default()
        };
        let (v0, w0) = (-1.0, 0.5);
        let state = sleigh
            .state(0.0, &[0.0; 3].into(), &[v0, 0.0, w0].into())
            .unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-13).unwrap());
        let run = Simulation::new(&sleigh, stepper, ())
            .run(0.0, state, 20.0, &mut ())
            .unwrap();
        let qdot = sleigh.velocity(20.0, &run.state).unwrap();
        let theta = run.state[2];
        let speed = qdot[0] * theta.cos() + qdot[1] * theta.sin();
        assert!((speed - 1.0837967441759566).abs() < 1e-10, "{speed}");
        assert!((qdot[2] - 5.255241495e-05).abs() < 1e-12, "{}", qdot[2]);
    }
}
