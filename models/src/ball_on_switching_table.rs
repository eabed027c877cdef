//! A ball that rolls on a turning table whose angular velocity changes each time the ball comes to the line `x = y`.
//!
//! Facts: between two changes the centre runs on a circle; at a change the ball is focused on the new affine constraints,
//! which act on both sides of the line, so that it may be thrown back. Source: J. Cortes and A. Vinogradov, section 6.3, with the
//! reading the section ends with.

dalembert::model_file!("src/ball_on_switching_table.dal");
