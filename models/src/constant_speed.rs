//! A particle that is kept at constant speed while gravity turns it.
//!
//! Facts: the direction `(cos(a), sin(a))` obeys `adot = -(g/v) cos(a)`, so that `sin(a) = -tanh(g t/v + C)`. Every
//! motion tends to a vertical fall. The constraint is nonlinear in the velocities; its force is a multiple of the
//! velocity (Chetaev's rule). Source: W. Clark, thesis, Remark V.6.

dalembert::model_file!("src/constant_speed.dal");
