//! A point in an elliptical table, straight lines and specular reflection.
//!
//! Facts: the product of the angular momenta about the two foci is constant; in a circle the angular momentum
//! is, and the bounces turn by a constant angle.

dalembert::model! {
    /// A point that moves freely in an elliptical table.
    pub PointBilliard {
        coordinates { x; y; }
        parameters {
            /// Mass.
            m > 0 = 1;
            /// Half axis of the table along x.
            ta > 0 = 1.5;
            /// Half axis of the table along y.
            tb > 0 = 1;
        }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2);
        impacts { wall: 1 - x^2/ta^2 - y^2/tb^2 >= 0; }
        initial { x = 0.25; y = 0.1; dot(x) = 0.8; dot(y) = 0.6; until = 50; }
        view { path: (x, y); region: 1 - x^2/ta^2 - y^2/tb^2 >= 0; }
        outputs { angular_momentum: m*(x*dot(y) - y*dot(x)); }
        claims {
            conserved: energy;
            conserved: dot(x);
            conserved under wall: energy;
            not conserved under wall: dot(x);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::law::Law;
    use dalembert::{Impacting, System};

    #[test]
    fn a_head_on_reflection_reverses_the_velocity() {
        let table = PointBilliard::default();
        let mut state = table
            .state_unchecked(0.0, &[1.5, 0.0].into(), &[2.0, 0.0].into())
            .unwrap();
        let contact = table
            .contact(point_billiard::surface::wall, 0.0, &state)
            .unwrap();
        table.kick(
            &mut state,
            contact.impulse(Law::Elastic),
            &contact.direction,
        );
        assert!((state[2] + 2.0).abs() < 1e-14 && state[3].abs() < 1e-14);
    }
}
