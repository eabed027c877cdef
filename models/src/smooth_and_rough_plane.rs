//! A ball on a plane that is smooth to the left of `x = 0` and rough to the right, where rolling constraints hold.
//!
//! Facts: on the smooth side the ball slides and spins freely. When it enters the rough side, its velocity is projected
//! onto the rolling constraints, and it loses energy. If this turns the ball back, it continues on the smooth side.
//! Source: J. Cortes and A. Vinogradov, section 6.1.

dalembert::model_file!("src/smooth_and_rough_plane.dal");
