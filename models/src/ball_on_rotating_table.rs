//! A ball with equal moments of inertia that rolls on a turning table: affine constraints.
//!
//! Facts: the centre runs on circles at the rate `Om k^2/(r^2 + k^2)`, for a solid ball (`k^2 = 2 r^2/5`) at `2 Om/7`.
//! The energy is not constant. Source: J. Cortes and A. Vinogradov, section 6.3.

dalembert::model_file!("src/ball_on_rotating_table.dal");
