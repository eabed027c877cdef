//! A hanging chain of N point masses on N rods, one declaration for every N that differ in that number alone.
//!
//! Facts: N = 2 is the double pendulum; the metric is `g_jk = (N + 1 - max(j, k)) m l^2 cos(theta_j - theta_k)`.

dalembert::model_file!("src/chain2.dal");
dalembert::model_file!("src/chain3.dal");
dalembert::model_file!("src/chain4.dal");
dalembert::model_file!("src/chain8.dal");
dalembert::model_file!("src/chain16.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::double_pendulum::DoublePendulum;
    use dalembert::{System, VectorField};

    #[test]
    fn two_links_are_the_double_pendulum() {
        let (chain, pendulum) = (Chain2::default(), DoublePendulum::default());
        let (q, qdot) = ([0.3, -1.1].into(), [0.7, 0.2].into());
        let state = chain.state(0.0, &q, &qdot).unwrap();
        let (mut rate, mut expected) = (state, state);
        chain.rate(0.0, &state, &mut rate).unwrap();
        pendulum
            .rate(0.0, &pendulum.state(0.0, &q, &qdot).unwrap(), &mut expected)
            .unwrap();
        assert!((rate - expected).amax() < 1e-13);
    }
}
