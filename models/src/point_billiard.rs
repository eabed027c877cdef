//! A point in an elliptical table, straight lines and specular reflection.
//!
//! Facts: the product of the angular momenta about the two foci is constant; in a circle the angular momentum
//! is, and the bounces turn by a constant angle.

dalembert::model_file!("src/point_billiard.dal");

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
