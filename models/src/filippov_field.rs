//! A field that is discontinuous at a line: crossing and sliding.
//!
//! Fact: where both sides lead to the line the motion slides along it, with the combination of both fields that is tangent to
//! it; else it crosses. Source: W. Clark and A. Bloch, section 7 (discontinuous fields), with the sliding motion of Filippov.

dalembert::model_file!("src/filippov_field.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Outcome, Scene, Simulation, System, Tolerance};

    #[test]
    fn the_motion_slides_where_both_sides_lead_to_the_line() {
        let field = FilippovField::default();
        let state = field
            .state(0.0, &[1.0, 0.0].into(), &[0.0; 2].into())
            .unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-12).unwrap());
        let run = Simulation::new(&field, stepper, field.effects())
            .run(0.0, state, 3.5, &mut ())
            .unwrap();
        assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 1));
        let q = field.position(&run.state);
        assert!(
            q[0].abs() < 1e-15 && (q[1] - (0.5 - 1.0)).abs() < 1e-14,
            "{q:?}"
        );
    }
}
