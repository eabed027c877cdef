//! A walker on a slope whose foot slips: a leg with a mass on top, friction at the foot, and a new leg at every step.
//!
//! `x_c` is the place of the centre of mass along the slope, `theta` the angle of the stance leg; the foot's velocity is
//! `dot(x_c) + lf dot(theta) cos(theta)`. A step, at `theta = -delta`, moves the base: the angle of the new leg is `delta`, its rate
//! `cos(2 delta)` times that of the old one, and the velocity of the foot is the same before and after.
//!
//! Facts: [`DimensionlessWalker`](crate::DimensionlessWalker) is this system in other units.
//! Source: W. Clark, thesis, section 4.2 (4.5 to 4.7); in (4.7) the centripetal term is subtracted and times `lf`.

dalembert::model_file!("src/walker_foot_slip.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DimensionlessWalker;
    use dalembert::{Dop853, Scene, Simulation, System, Tolerance};

    #[test]
    fn is_the_dimensionless_walker_in_other_units() {
        // Units of time `t0 = m/b`, of velocity `v0 = m g/b` and of the rate `v0/lf`: `eps = v0 t0/lf`.
        let walker = WalkerFootSlip {
            m: 2.0,
            I: 0.2,
            lf: 0.5,
            b: 4.0,
            g: 1.0,
            alpha: 0.4,
            delta: 0.4,
        };
        let (t0, v0) = (walker.m / walker.b, walker.m * walker.g / walker.b);
        let other = DimensionlessWalker {
            mu: walker.m * walker.lf * walker.lf / walker.I,
            eps: v0 * t0 / walker.lf,
            alpha: walker.alpha,
            delta: walker.delta,
        };
        let (xi, eta, until) = (-1.0, 1.0, 6.0);
        let tolerance = Tolerance::new(1e-12).unwrap();
        let start = [0.0, walker.delta];
        let rates = [v0 * eta, v0 / walker.lf * xi];
        let state = walker.state(0.0, &start.into(), &rates.into()).unwrap();
        let run = Simulation::new(&walker, Dop853::new(tolerance), walker.effects())
            .run(0.0, state, until * t0, &mut ())
            .unwrap();
        let [x_dot, theta_dot] = walker.velocity(run.t, &run.state).unwrap().into();
        let scaled = Simulation::new(&other, Dop853::new(tolerance), other.effects())
            .run(0.0, [other.delta, xi, eta].into(), until, &mut ())
            .unwrap();
        assert_eq!(run.counters.impacts, scaled.counters.impacts);
        assert!(run.counters.impacts >= 2);
        let own = [run.state[1], theta_dot * walker.lf / v0, x_dot / v0];
        for (own, other) in own.iter().zip(scaled.state.as_slice()) {
            assert!((own - other).abs() < 1e-9, "{own} and {other}");
        }
    }
}
