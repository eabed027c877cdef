//! A ball that rolls on a turning table whose angular velocity changes each time the ball comes to the line `x = y`.
//!
//! Facts: between two changes the centre runs on a circle. At a change the state is focused onto the new affine
//! constraints, which act on both sides of the line, so that the ball may be thrown back. Source: J. Cortes and A.
//! Vinogradov, section 6.3, in the interpretation at the end of that section.

dalembert::model_file!("src/ball_on_switching_table.dal");
