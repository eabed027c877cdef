//! A homogeneous ball that rolls on an elliptical table, orientation by Euler angles (z-x-z).
//!
//! Facts: the centre moves on straight lines, the angular velocity is constant between impacts. The chart ends
//! where `sin(theta) = 0`. Source: W. Clark and A. Bloch, section 8; J. Cortes and A. Vinogradov, section 6.

dalembert::model_file!("src/rolling_ball_euler.dal");
