//! A particle that is kept at constant speed while gravity turns it.
//!
//! Facts: with the direction `(cos(a), sin(a))`, `adot = -(g/v) cos(a)`, so that `sin(a) = -tanh(g t/v + C)`: every motion ends
//! falling straight down. The constraint is not linear in the velocities; its force is a multiple of the velocity itself (Chetaev's
//! rule). Source: W. Clark, thesis, Remark V.6.

dalembert::model_file!("src/constant_speed.dal");
