//! A homogeneous ball that rolls on a table and does not slip on a wall in the moment it hits it.
//!
//! Facts: in the moment of an impact the velocity along the wall becomes what rolling on table and wall together leaves of
//! it, `ydot+ = ((r^2 + k^2) ydot - k^2 r omega_z)/(r^2 + 2 k^2)`; at an elastic impact the velocity towards the wall is turned
//! round, at a plastic one the ball goes on along the wall. Source: J. Cortes and A. Vinogradov, section 6.2. The point
//! that touches the wall is `r` ahead of the centre, so that it rests where `ydot + r omega_z = 0`; the source has a minus.

dalembert::model_file!("src/rolling_ball_wall.dal");
