//! A ball that rolls on a turning table whose angular velocity changes each time the ball comes to the line `x = y`.
//!
//! Facts: between two changes the centre runs on a circle. At a change the velocity is projected onto the new affine
//! constraints, which hold until the ball comes to the line again. The ball may be thrown back to the side from which it
//! came. Source: J. Cortes and A. Vinogradov, section 6.3, in the interpretation at the end of that section.

dalembert::model_file!("src/ball_on_switching_table.dal");
