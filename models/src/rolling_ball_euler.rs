//! A ball with equal moments of inertia that rolls on an elliptical table. Euler angles (z-x-z) give its orientation.
//!
//! Facts: between impacts the centre moves on a straight line and the angular velocity is constant. The chart ends
//! where `sin(theta) = 0`. Source: W. Clark and A. Bloch, section 8; J. Cortes and A. Vinogradov, section 6.

dalembert::model_file!("src/rolling_ball_euler.dal");
