//! A ball on a plane that is smooth to the left of `x = 0` and rough to the right: constraints that begin at a line.
//!
//! Facts: on the smooth side the ball slides and spins freely; where it comes onto the rough side it is focused on the rolling
//! constraint, and loses energy; where that turns it back it goes on on the smooth side. Source: J. Cortes and A. Vinogradov,
//! section 6.1.

dalembert::model_file!("src/smooth_and_rough_plane.dal");
