//! A hanging chain of N point masses on N rods, one declaration for every N.
//!
//! Facts: N = 2 is the double pendulum; the metric is `g_jk = (N + 1 - max(j, k)) m l^2 cos(theta_j - theta_k)`.

/// Declares the chain with the given number of links.
macro_rules! chain {
    ($name:ident, $links:literal) => {
        dalembert::model! {
            /// A planar chain of point masses on rods; absolute angles from the downward vertical.
            pub $name {
                const N = $links;
                coordinates { theta[N]: angle; }
                parameters {
                    /// Mass of each bob.
                    m > 0 = 1;
                    /// Length of each rod.
                    l > 0 = 1;
                    /// Acceleration of gravity.
                    g = 9.81;
                }
                let X[0] = 0;
                let X[i in 1..=N] = X[i-1] + l*sin(theta[i]);
                let Y[0] = 0;
                let Y[i in 1..=N] = Y[i-1] - l*cos(theta[i]);
                lagrangian = sum(i in 1..=N: m/2*(dot(X[i])^2 + dot(Y[i])^2) - m*g*Y[i]);
                initial { theta[1] = 1; until = 10; }
                view { path: (X[N], Y[N]); }
                claims {
                    conserved: energy;
                }
            }
        }
    };
}

chain!(Chain2, 2);
chain!(Chain3, 3);
chain!(Chain4, 4);
chain!(Chain8, 8);
chain!(Chain16, 16);

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
