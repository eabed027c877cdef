//! A homogeneous ball that rolls on a turning table: affine constraints.
//!
//! Facts: the centre runs on circles at the rate `Om k^2/(r^2 + k^2)`, for a solid ball 2/7 of the rate of the table.
//! The energy is not constant. Source: J. Cortes and A. Vinogradov, section 6.3.

dalembert::model_file!("src/ball_on_rotating_table.dal");
