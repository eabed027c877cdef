//! A point mass on two massless springs for legs that walks: single and double support, with coordinates of their own.
//!
//! Facts: a leg lands and leaves at its rest length, so that nothing is lost and the energy is constant from step to step; in
//! double support two springs push. Source: H. Geyer, A. Seyfarth and R. Blickhan, *Compliant leg behaviour explains basic dynamics of
//! walking and running* (2006); W. Clark, thesis, section 2.3, for systems of this kind.

dalembert::model! {
    /// Point mass that walks on spring legs (Geyer, Seyfarth and Blickhan 2006), in units of mass, leg length and gravity.
    pub SpringMassWalker {
        parameters {
            /// Stiffness of a leg.
            k > 0 = 17.84;
            /// Angle at which a leg lands.
            alpha in [0, 1.5] = 1.2043;
        }
        /// The mass.
        coordinates { x; y; }
        let spring(foot) = k/2*(sqrt((x - foot)^2 + y^2) - 1)^2;
        modes {
            /// On one leg.
            single {
                coordinates { foot; }
                lagrangian = (dot(x)^2 + dot(y)^2 + dot(foot)^2)/2 - y - spring(foot);
                constraints { stands: d(foot) = 0; }
                initial { y = 0.97; dot(x) = 0.351; until = 8; }
            }
            /// On two: one in front, one behind.
            double {
                coordinates { front; back; }
                lagrangian = (dot(x)^2 + dot(y)^2 + dot(front)^2 + dot(back)^2)/2 - y - spring(front) - spring(back);
                constraints { stands_in_front: d(front) = 0; stands_behind: d(back) = 0; }
            }
        }
        transitions {
            touch_down: single -> double when y <= sin(alpha) when x > foot => reset {
                front = x + cos(alpha);
                back = foot;
                dot(front) = 0;
                dot(back) = 0;
            };
            lift_off: double -> single when (x - back)^2 + y^2 >= 1 => reset { foot = front; dot(foot) = 0; };
        }
        view { path: (x, y); }
        claims { conserved: energy; }
    }
}

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
