//! A walker on a slope whose foot slips, in dimensionless form: a first-order system.
//!
//! `theta` is the angle of the stance leg, `xi` its scaled rate, `eta` the scaled velocity of the hip along the slope.
//! Friction at the foot is proportional to its velocity. When the other foot lands, at `theta = -delta`, the legs
//! change roles.
//!
//! Facts: for the declared parameters there is a periodic orbit of one step, with the period 1.54496586406140337. After
//! a step it has `(xi, eta) = (-0.902057449429909745, 0.991308369223558489)`. Source: W. Clark, thesis, section 4.2,
//! equations (4.8) to (4.11); in (4.11) `eps xi^2 cos(theta)` is subtracted.

dalembert::model_file!("src/dimensionless_walker.dal");
