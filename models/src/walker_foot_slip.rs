//! A walker on a slope whose foot slips: a leg with a mass on top, friction at the foot, and a new leg at every step.
//!
//! `x_c` is the place of the centre of mass along the slope, `theta` the angle of the stance leg; the foot's velocity is
//! `dot(x_c) + lf dot(theta) cos(theta)`. A step, at `theta = -delta`, moves the base: the angle of the new leg is `delta`, its rate
//! `cos(2 delta)` times that of the old one, and the velocity of the foot is the same before and after.
//!
//! Facts: [`DimensionlessWalker`](crate::DimensionlessWalker) is this system in other units.
//! Source: W. Clark, thesis, section 4.2 (4.5 to 4.7); in (4.7) the centripetal term is subtracted and times `lf`.

dalembert::model_file!("src/walker_foot_slip.dal");
