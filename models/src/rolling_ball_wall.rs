//! A ball with equal moments of inertia that rolls on a table and does not slip on a wall at the moment of impact.
//!
//! Facts: at an impact, rolling on table and wall together changes the velocity along the wall to
//! `ydot+ = ((r^2 + k^2) ydot - k^2 r omega_z)/(r^2 + 2 k^2)`. An elastic impact reverses the velocity towards the
//! wall; after a plastic impact the ball moves along the wall. Source: J. Cortes and A. Vinogradov, section 6.2. The
//! point that touches the wall is `r` ahead of the centre and rests if `ydot + r omega_z = 0`; the source prints a minus
//! sign.

dalembert::model_file!("src/rolling_ball_wall.dal");
